//! Every row accepts its range and no other values.

use super::super::*;
use super::parameters;

/// Returns the next number up, or down.
fn beyond(number: f64, up: bool) -> f64 {
    if up { number.next_up() } else { number.next_down() }
}

/// Returns values that a row must accept, and values that it must refuse.
fn good_and_bad(row: &Row) -> (Vec<Value>, Vec<Value>) {
    let (mut good, mut bad) = (Vec::new(), Vec::new());
    match row.range {
        Range::Int(low, high) => {
            good.extend([low, low + (high - low) / 2, high].map(Value::Int));
            bad.extend([low - 1, high + 1, i64::MIN, i64::MAX].map(Value::Int));
        }
        Range::Among(ranges) => {
            good.extend(ranges.iter().flat_map(|(low, high)| [Value::Int(*low), Value::Int(*high)]));
            bad.extend([ranges[0].0 - 1, ranges[ranges.len() - 1].1 + 1].map(Value::Int));
            let gaps = ranges.windows(2).filter(|pair| pair[0].1 + 1 < pair[1].0);
            bad.extend(gaps.flat_map(|pair| [Value::Int(pair[0].1 + 1), Value::Int(pair[1].0 - 1)]));
        }
        Range::PositiveUpTo(high) => {
            good.extend([f64::MIN_POSITIVE, high / 2.0, high].map(Value::Real));
            bad.extend([0.0, -0.0, -f64::MIN_POSITIVE, beyond(high, true)].map(Value::Real));
        }
        Range::Real(low, high) => {
            good.extend([low, low + (high - low) / 2.0, high].map(Value::Real));
            bad.extend([beyond(low, false), beyond(high, true)].map(Value::Real));
        }
    }
    // Values of the other type, and values that no range contains.
    if matches!(row.range, Range::Int(..) | Range::Among(_)) {
        bad.extend([Value::Real(1.0), Value::Real(f64::NAN)]);
    } else {
        bad.extend([Value::Int(1), Value::Real(f64::NAN), Value::Real(f64::INFINITY), Value::Real(f64::NEG_INFINITY)]);
    }
    if row.default != Value::Unset || row.required {
        bad.push(Value::Unset);
    }
    // The default is allowed even outside the range (D02).
    bad.retain(|value| *value != row.default);
    (good, bad)
}

#[test]
fn every_default_lies_in_its_range_and_reads_back() {
    let bare = parameters();
    for row in ROWS {
        if !row.required {
            assert_eq!(row.check(row.default), Ok(()), "{}", row.key);
        }
        if !row.required && row.is_stored() {
            assert_eq!(row.value(&bare), row.default, "{}", row.key);
        }
        assert_eq!(
            row.default == Value::Unset && !row.required,
            !row.default_text.is_empty() || is_read(row),
            "{}",
            row.key
        );
    }
    assert_eq!(bare.check(), Ok(()));
    assert!(bare.is_sound());
}

/// Returns true if the row is read-only.
fn is_read(row: &Row) -> bool {
    row.storage == Storage::Derived
}

#[test]
fn every_row_holds_its_range_and_changes_nothing_when_it_refuses() {
    let mut tried = 0;
    for row in ROWS.iter().filter(|row| !row.is_read_only() && row.applies != Applies::Machine) {
        let before = parameters();
        let mut after = before;
        let (good, bad) = good_and_bad(row);
        tried += good.len() + bad.len();
        for value in bad {
            assert!(row.assign(&mut after, value).is_err(), "{} takes {value:?}", row.key);
            assert!(row.change(&mut after, value).is_err(), "{} takes {value:?}", row.key);
            assert_eq!(after, before, "{} refused {value:?}", row.key);
        }
        for value in good {
            if row.missing.is_empty() || value == row.default {
                assert_eq!(row.change(&mut after, value), Ok(()), "{} {value:?}", row.key);
                assert!(row.value(&after) == value, "{} {value:?} reads {:?}", row.key, row.value(&after));
            } else {
                assert_eq!(row.assign(&mut after, value), Err(Refused::NotBuilt), "{} takes {value:?}", row.key);
                assert_eq!((row.value(&after), after), (row.default, before), "{}", row.key);
            }
        }
    }
    // Hundreds of ranges of REVERS alone.
    assert!(tried > 5000, "{tried}");
}

/// The same for the machine.
#[test]
fn every_row_of_the_machine_holds_its_range_and_changes_nothing_when_it_refuses() {
    for row in ROWS.iter().filter(|row| row.applies == Applies::Machine) {
        let before = MachineParameters::default();
        let mut after = before;
        let (good, bad) = good_and_bad(row);
        for value in bad {
            assert!(row.assign_to_machine(&mut after, value).is_err(), "{} takes {value:?}", row.key);
            assert_eq!(after, before, "{} refused {value:?}", row.key);
        }
        for value in good {
            let works = row.missing.is_empty() || value == row.default;
            let expected = if works { Ok(()) } else { Err(Refused::NotBuilt) };
            assert_eq!(row.assign_to_machine(&mut after, value), expected, "{} {value:?}", row.key);
            let shown = if works { value } else { row.default };
            assert_eq!(row.machine_value(&after), shown, "{} {value:?}", row.key);
        }
    }
}

#[test]
fn only_cell_sets_structure_and_derived_rows_are_read_only() {
    for row in ROWS.iter().filter(|row| row.is_read_only()) {
        let before = parameters();
        let mut after = before;
        for value in [Value::Int(1), Value::Real(1.0), Value::Unset, row.default] {
            assert_eq!(row.change(&mut after, value), Err(Refused::ReadOnly), "{}", row.key);
            if row.storage != Storage::Cell {
                assert_eq!(row.assign(&mut after, value), Err(Refused::ReadOnly), "{}", row.key);
            }
        }
        assert_eq!(after, before, "{}", row.key);
    }
}

#[test]
fn gaps_are_no_values() {
    let refused = |key: &str, value| {
        let row = Row::find(key).map(|(_, row)| row).unwrap_or_else(|| panic!("{key}"));
        row.check(Value::Int(value)) == Err(Refused::OutOfRange)
    };
    // rule 0 to 2, output 0 to 9, node 0 to 127; negative values only in tens.
    for (value, is_refused) in
        [(20, false), (12_792, false), (3, true), (12_793, true), (-10, false), (-15, true), (-100, true)]
    {
        assert_eq!(refused("revers", value), is_refused, "{value}");
    }
    // D05
    for (value, is_refused) in [(0, false), (9, true), (57, false), (59, true), (88, false), (89, true)] {
        assert_eq!(refused("canbaud", value), is_refused, "{value}");
    }
    // MACS-DIR-01
    for (value, is_refused) in [(0, true), (3, true), (-21, false), (13, true), (22, false), (-22, false)] {
        assert_eq!(refused("posdrct", value), is_refused, "{value}");
    }
    // O-51
    for (value, is_refused) in [(42, false), (-203, false), (103, false), (4, true), (-3, true)] {
        assert_eq!(refused("syncmtypm", value), is_refused, "{value}");
    }
}

#[test]
fn a_row_without_its_function_says_what_is_missing_and_keeps_its_default() {
    let missing: Vec<_> = ROWS.iter().filter(|row| !row.missing.is_empty()).collect();
    assert!(missing.len() > 9, "{}", missing.len());
    for row in missing {
        assert!(!row.is_stored() && !row.is_view() && row.default != Value::Unset, "{}", row.key);
        assert_eq!(row.value(&parameters()), row.default, "{}", row.key);
    }
}

//! Tests that all interfaces accept the same values, as defined by the catalogue: a cell, a scenario, an import,
//! `~/vocabulary`, the machine itself.

use super::rig::{DRIVES, Interface, Rig};
use lineshaft_core::config::{max_of_row, max_velocity_of_cycle};
use lineshaft_core::parameter::{Applies, Change, MACHINE, Measure, ROWS, Range, Row, Storage, Value};
use lineshaft_core::text::{allowed_text, value_text};
use lineshaft_core::unit::Scale;

const TEXT_DOORS: [Interface; 4] = [Interface::Cell, Interface::Scenario, Interface::Import, Interface::Vocabulary];

/// It is 0 when a machine starts, so a cell cannot set it.
const TRIGGER: &str = "amc.reference_select_trigger";

/// Returns an object that has the row; one with two drives only if no other has it.
fn object(row: &Row, rig: &Rig) -> &'static str {
    let axes = DRIVES.iter().zip(&rig.config().axes);
    let axis = axes
        .map(|((name, _), axis)| (*name, axis))
        .rfind(|(name, axis)| row.applies.to(axis) && (*name != "g" || row.applies == Applies::Gantry));
    axis.map_or("machine", |(name, _)| name)
}

/// Returns a value in the exact format of a file.
fn written(row: &Row, value: Value) -> String {
    let unit = match row.measure {
        Measure::Position | Measure::Distance => " inc",
        Measure::Velocity => " inc/s",
        Measure::Acceleration => " inc/s^2",
        Measure::Jerk => " inc/s^3",
        Measure::Time => " ns",
        Measure::Integer | Measure::Number | Measure::Choice(_) => "",
    };
    match value {
        Value::Unset => "~".to_owned(),
        Value::Int(number) => format!("{number}{unit}"),
        Value::Real(number) => format!("{number}{unit}"),
    }
}

/// Returns both ends of the range, and the default.
fn legal(row: &Row) -> Vec<Value> {
    let mut values = match row.range {
        Range::Int(low, high) => vec![Value::Int(low), Value::Int(high)],
        Range::Among(ranges) => {
            let some = ranges.iter().take(3).chain(ranges.last());
            some.flat_map(|(low, high)| [Value::Int(*low), Value::Int(*high)]).collect()
        }
        Range::PositiveUpTo(high) => vec![Value::Real(1e-9), Value::Real(1.0), Value::Real(high)],
        Range::Real(low, high) => vec![Value::Real(low), Value::Real(high)],
    };
    if !row.required && row.default != Value::Unset {
        values.push(row.default);
    }
    values
}

/// Returns one value beyond each end of the range.
fn beyond(row: &Row) -> Vec<Value> {
    let values = match row.range {
        Range::Int(low, high) => vec![Value::Int(low - 1), Value::Int(high + 1)],
        Range::Among(ranges) => {
            let ends = [ranges[0].0 - 1, ranges[ranges.len() - 1].1 + 1];
            let gap = ranges.windows(2).map(|pair| pair[0].1 + 1).find(|value| row.check(Value::Int(*value)).is_err());
            ends.into_iter().chain(gap).map(Value::Int).collect()
        }
        Range::PositiveUpTo(high) => vec![Value::Real(0.0), Value::Real(-1.0), Value::Real(high * 1.5)],
        Range::Real(low, high) => vec![Value::Real(low - low.abs().max(1.0)), Value::Real(high * 1.5 + 1.0)],
    };
    // A default may be outside of the range (D02).
    values.into_iter().filter(|value| *value != row.default).collect()
}

/// Returns texts that no row of that measure accepts.
fn invalid_values(row: &Row) -> Vec<&'static str> {
    let mut texts = vec!["banana", ".nan", "nan", ".inf", "inf", "-inf", "[1, 2]", "{a: 1}", "5 kg", "1 2"];
    texts.extend(match row.measure {
        Measure::Position | Measure::Distance => ["5 s", "5 mm/s", "5 deg"].iter(),
        Measure::Velocity => ["5 s", "5 mm", "5 rad/s"].iter(),
        Measure::Acceleration => ["5 mm/s", "5 mm/s^3", "5 rad/s^2"].iter(),
        Measure::Jerk => ["5 mm/s", "5 mm/s^2", "5 rad/s^3"].iter(),
        Measure::Time => ["5 mm", "5 Hz", "1/2"].iter(),
        Measure::Integer => ["1.5", "\"7\"", "5 mm"].iter(),
        Measure::Number => ["\"7\"", "5 mm", "1/2"].iter(),
        Measure::Choice(_) => ["1.5", "5 mm", "99"].iter(),
    });
    texts
}

/// Whether the catalogue accepts a value for an axis that has just started.
fn law(row: &Row, rig: &Rig, object: &str, value: Value) -> bool {
    let Some(axis) = rig.config().axes.iter().find(|axis| axis.name == object) else {
        return row.check(value).is_ok();
    };
    let mut parameters = axis.parameters;
    row.change(&mut parameters, value).is_ok()
        && parameters.check().is_ok()
        && parameters.max_velocity <= max_velocity_of_cycle(rig.config().cycle_ns)
}

fn change(rig: &Rig, object: &str, row: &Row, value: Value) -> Change {
    let axis = rig.config().axes.iter().position(|axis| axis.name == object).map_or(MACHINE, |axis| axis as u16);
    Change { axis, row: Row::find(row.key).expect("it is a row").0, value }
}

/// Whether an interface has this row. A cell has no keys of the machine, and its structure is no parameter there.
fn has(door: Interface, row: &Row) -> bool {
    door != Interface::Cell || row.applies != Applies::Machine && row.storage != Storage::Cell
}

#[test]
fn every_row_takes_the_same_values_at_every_door() {
    let rig = Rig::new();
    let mut taken = 0;
    for row in ROWS.iter().filter(|row| !row.is_read_only() && row.key != TRIGGER) {
        let object = object(row, &rig);
        for value in legal(row) {
            let machine = rig.give_change(object, change(&rig, object, row, value));
            // Values of the reference selector also depend on its wiring; for them the interfaces must agree with the
            // machine.
            let is_selector = row.key.starts_with("amc.");
            // So do inputs and outputs by number: this cell has none.
            let names_io = row.key.starts_with("i_") || row.key.starts_with("o_") || row.key == "revers";
            // The source of the virtual master and its start depend on its axes and its ramp.
            let is_virtual = matches!(row.key, "vmenctyp" | "vmencmtyp" | "pulsvel");
            // Two of the four modes need a power stage, five of the seven motors one that commutates; the velocity loop
            // can read only the encoder of its own drive.
            let is_mode = matches!(row.key, "ampmode" | "ampcommtype" | "ampencno");
            // A current loop needs the torque constant.
            let is_mode = is_mode || row.key == "torque_constant";
            let expected = if is_selector || names_io || is_virtual || is_mode {
                machine.is_ok()
            } else {
                law(row, &rig, object, value)
            };
            assert_eq!(machine.is_ok(), expected, "{}: machine: {value:?}: {machine:?}", row.key);
            let text = written(row, value);
            for door in TEXT_DOORS.into_iter().filter(|door| has(*door, row)) {
                let outcome = rig.give_text(door, object, row.key, &text);
                // A file starts no motion.
                let expected =
                    expected && (door != Interface::Import || !row.moves_virtual_master() || value == Value::Int(0));
                assert_eq!(outcome.is_ok(), expected, "{}: {door:?}: {text}: {outcome:?}", row.key);
                if let Ok(Some(parameters)) = outcome {
                    assert_eq!(row.value(&parameters), value, "{}: {door:?}: {text}", row.key);
                }
                taken += usize::from(expected);
            }
        }
        if row.default != Value::Unset {
            assert!(law(row, &rig, object, row.default), "{}: the default is taken", row.key);
        }
    }
    assert!(taken > 4 * ROWS.len(), "{taken} values were taken");
}

/// A refusal names the parameter, the value and the permitted values, and changes nothing.
#[test]
fn every_row_refuses_what_lies_beyond_its_range_at_every_door() {
    let rig = Rig::new();
    for row in ROWS.iter().filter(|row| !row.is_read_only()) {
        let object = object(row, &rig);
        let scale =
            rig.config().axes.iter().find(|axis| axis.name == object).map_or(Scale::increments(), |axis| axis.scale);
        let text = |value| value_text(row, value, &scale);
        for value in beyond(row) {
            let said = rig.give_change(object, change(&rig, object, row, value)).expect_err(row.key);
            let range = allowed_text(row, &scale, max_of_row(row, rig.config().cycle_ns));
            assert_eq!(said, format!("{object}: {} is {}; {range} is allowed", row.key, text(value)));
            let written = written(row, value);
            for door in TEXT_DOORS.into_iter().filter(|door| has(*door, row)) {
                let said = rig.give_text(door, object, row.key, &written).expect_err(row.key);
                assert!(said.contains(row.key), "{}: {door:?}: {said}", row.key);
                let tells = ["allowed", "expected", "2^62"].iter().any(|word| said.contains(word));
                assert!(tells, "{}: {door:?}: {said}", row.key);
                let is_named = said.contains(&text(value)) || said.contains(&written) || said.contains(&range);
                assert!(is_named, "{}: {door:?}: {said}", row.key);
            }
        }
    }
}

#[test]
fn no_row_takes_what_is_none_of_its_type_at_any_door() {
    let rig = Rig::new();
    for row in ROWS.iter().filter(|row| !matches!(row.storage, Storage::Cell)) {
        let object = object(row, &rig);
        for text in invalid_values(row) {
            for door in TEXT_DOORS.into_iter().filter(|door| has(*door, row)) {
                let said = rig.give_text(door, object, row.key, text).expect_err(row.key);
                assert!(said.contains(row.key), "{}: {door:?}: {text}: {said}", row.key);
            }
        }
        let others = match row.default {
            _ if matches!(row.range, Range::Int(..) | Range::Among(_)) => {
                [Value::Real(1.0), Value::Real(f64::NAN), Value::Real(f64::INFINITY)]
            }
            _ => [Value::Int(1), Value::Real(f64::NAN), Value::Real(f64::NEG_INFINITY)],
        };
        for value in others {
            let said = rig.give_change(object, change(&rig, object, row, value)).expect_err(row.key);
            assert!(said.contains(row.key), "{said}");
        }
    }
}

/// A parameter that describes how a value is calculated, or that is part of the structure, is read-only at every
/// interface.
///
/// Proves: MACS-STO-08
#[test]
fn read_only_rows_are_refused_at_every_interface() {
    let rig = Rig::new();
    let mut count = 0;
    for row in ROWS.iter().filter(|row| row.is_read_only()) {
        let object = object(row, &rig);
        let value = legal(row)[0];
        let said = rig.give_change(object, change(&rig, object, row, value)).expect_err(row.key);
        assert!(said.starts_with(&format!("{object}: {} is ", row.key)), "{said}");
        for door in TEXT_DOORS.into_iter().filter(|door| has(*door, row)) {
            let same = rig.give_text(door, object, row.key, &written(row, value)).expect_err(row.key);
            let (_, sentence) = said.split_once(": ").expect("the axis");
            assert!(same.contains(sentence), "{door:?}: {same}, not {said}");
        }
        count += 1;
    }
    assert!(count >= 8, "velmaxqc, accmaxqc and six factors at least");
}

#[test]
fn unimplemented_parameter_accepts_only_its_default() {
    let rig = Rig::new();
    for row in ROWS.iter().filter(|row| !row.missing.is_empty() && !row.is_read_only()) {
        let object = object(row, &rig);
        for value in legal(row).into_iter().filter(|value| *value != row.default) {
            let expected = format!("{}; only {} is allowed", row.missing_text(), written(row, row.default));
            let machine = rig.give_change(object, change(&rig, object, row, value)).expect_err(row.key);
            for door in TEXT_DOORS.into_iter().filter(|door| has(*door, row)) {
                let said = rig.give_text(door, object, row.key, &written(row, value)).expect_err(row.key);
                for said in [&said, &machine] {
                    assert!(said.contains(row.key) && said.contains(row.missing), "{said}");
                    let is_plain = matches!(row.measure, Measure::Integer | Measure::Number);
                    assert!(!is_plain || said.contains(&expected), "{said}, not {expected}");
                }
            }
        }
    }
}

/// Parameters of axes need an axis, those of the machine have none.
///
/// Proves: MACS-STO-01
#[test]
fn a_row_is_there_only_where_it_applies() {
    let rig = Rig::new();
    let mut count = 0;
    for row in ROWS.iter().filter(|row| row.storage != Storage::Cell) {
        let text = written(row, legal(row)[0]);
        for axis in rig.config().axes.iter().filter(|axis| !row.applies.to(axis)) {
            for door in TEXT_DOORS {
                let said = rig.give_text(door, &axis.name, row.key, &text).expect_err(row.key);
                let expected = format!("is for {}", row.applies.text());
                assert!(said.contains(row.key) && said.contains(&expected), "{}: {door:?}: {said}", row.key);
            }
            count += 1;
        }
        if row.applies != Applies::Machine {
            for door in [Interface::Scenario, Interface::Import] {
                let said = rig.give_text(door, "machine", row.key, &text).expect_err(row.key);
                assert!(said.contains(row.key) && said.contains("is for"), "{}: {door:?}: {said}", row.key);
            }
        }
    }
    assert!(count > ROWS.len() / 2, "{count}");
}

/// Units of the sources: MACS uses increments for limits, windows and errors, whatever the unit of the axis is.
///
/// Proves: MACS-UNIT-03
#[test]
fn limits_of_macs_are_in_increments_at_every_door() {
    let rig = Rig::new();
    for door in TEXT_DOORS {
        for (key, native) in [("poserr", "max_following_error"), ("testwin", "in_position_window")] {
            let value = |key, text| match rig.give_text(door, "x", key, text) {
                Ok(Some(parameters)) => Some(Row::find(native).expect("a row").1.value(&parameters)),
                Ok(None) => None,
                Err(said) => panic!("{said}"),
            };
            // 1000 inc are one millimetre.
            assert_eq!(value(key, "2000"), value(native, "2 mm"), "{door:?}");
            assert!(rig.give_text(door, "x", key, "2 mm").is_err(), "{door:?}");
        }
    }
}

//! The rows of MACS against the master table of the specification.

use super::super::*;
use super::spec::{MACS, cells, table};
use crate::unit::MLONG;

/// One line of the table.
struct Line {
    name: &'static str,
    number: &'static str,
    group: &'static str,
    unit: &'static str,
    range: &'static str,
    init: &'static str,
    delta: &'static str,
}

fn lines() -> Vec<Line> {
    let axis = table(MACS, "### Axis parameters").into_iter().map(|line| match cells(line)[..] {
        [name, number, group, unit, range, init, _, _, delta] => {
            Line { name, number, group: group.split(' ').next().unwrap_or(""), unit, range, init, delta }
        }
        _ => panic!("{line}"),
    });
    let global = table(MACS, "### Global parameters").into_iter().map(|line| match cells(line)[..] {
        [name, number, unit, range, init, _, _, delta] => Line { name, number, group: "GL", unit, range, init, delta },
        _ => panic!("{line}"),
    });
    axis.chain(global).collect()
}

fn row(line: &Line) -> &'static Row {
    let is_global = line.group == "GL";
    ROWS.iter()
        .find(|row| {
            row.system == System::Macs && row.mnemonic == line.name && (row.group == Group::Global) == is_global
        })
        .unwrap_or_else(|| panic!("no row {}", line.name))
}

fn number(text: &str) -> Option<i64> {
    let text = text.trim();
    if let Some((factor, rest)) = text.split_once('·') {
        return Some(number(factor)? * number(rest)?);
    }
    if let Some((all, part)) = text.split_once('/') {
        return Some(number(all)? / number(part)?);
    }
    match text {
        "MLONG" => Some(MLONG),
        _ => text.parse().ok(),
    }
}

/// Parses `1..5, 9`, `±7`: ascending, without gaps between neighbours.
fn ranges(text: &str) -> Option<Vec<(i64, i64)>> {
    // The rest is a remark.
    let text = text.split([';', '(']).next()?.split(" or ").next()?.split(", read only").next()?;
    let mut ranges = Vec::new();
    for part in text.split(',') {
        let part = part.trim();
        let range = match part.split_once("..") {
            Some((low, high)) => (number(low)?, number(high)?),
            None if part.starts_with('±') => number(part.trim_start_matches('±')).map(|end| (-end, end))?,
            None => (number(part)?, number(part)?),
        };
        ranges.push(range);
    }
    Some(merge(ranges))
}

fn merge(ranges: Vec<(i64, i64)>) -> Vec<(i64, i64)> {
    let mut merged: Vec<(i64, i64)> = Vec::new();
    for (low, high) in ranges {
        match merged.last_mut() {
            Some(last) if last.1 + 1 == low => last.1 = high,
            _ => merged.push((low, high)),
        }
    }
    merged
}

/// Differences of the rows from the printed range, with the reasons.
fn exception(name: &str) -> Option<Vec<(i64, i64)>> {
    let mask = |bits: i64| merge((0..=bits).filter(|value| value & !bits == 0).map(|value| (value, value)).collect());
    let digits = |tens: std::ops::RangeInclusive<i64>, most: i64| tens.map(move |tens| (10 * tens, 10 * tens + most));
    Some(match name {
        // D09: 110 is used, so that +-100 added is part of it.
        "DRIVETYPE" => vec![(-194, 194)],
        // The values computed from max_velocity are not limited to MLONG.
        "VELMAXQC" | "ACCMAXQC" => vec![(-((1 << 62) - 1), (1 << 62) - 1)],
        // VELRES itself may be up to 10000; the check of the set compares them with it.
        "HOME_VEL" => vec![(-10_000, 10_000)],
        "DFLTVEL" | "DFLTACC" | "HOME_RAMP" => vec![(1, 10_000)],
        // The printed limits depend on other values.
        "POSFACT_Z" | "SYNCFACTS" => vec![(1, MLONG)],
        "SYNCPOSOFFS" => vec![(-MLONG, MLONG)],
        "SYNCMPULSM" => vec![(0, 2 * MLONG)],
        // 0 is allowed, and means not set.
        "TESTVAL" => vec![(0, 10_000)],
        // a distance of marks may be any value above 0; the check of the set handles a clock rate.
        "ENCODERFREQ" => vec![(1, MLONG)],
        // MACS-DIR-01: other values are refused.
        "POSDRCT" => vec![(-22, -21), (-12, -11), (-2, -1), (1, 2), (11, 12), (21, 22)],
        // 255 is the value of a controller that has homed.
        "HOME_FORCE" => vec![(0, 1), (255, 255)],
        // Any sum of the bits.
        "SYNCMFPAR" => mask(1 + 2 + 4 + 16 + 64),
        // MACS-SYNC-05: bit 0 is unused.
        "SYNCTYPE" => mask(2 + 4),
        // MACS-MARK-05, MACS-MARK-06: ones digit 0 to 3.
        "SYNCMTYPM" => {
            let negative = digits(10..=99, 3).map(|(low, high)| (-high, -low)).rev();
            negative.chain(digits(0..=99, 3)).collect()
        }
        "SYNCMTYPS" => digits(0..=9, 3).collect(),
        //
        "REVERS" => (1..=9).rev().map(|tens| (-10 * tens, -10 * tens)).chain(digits(0..=1279, 2)).collect(),
        // A-48, and MACS-LIM-07: any input.
        "I_REFSWITCH" | "I_POSLIMITSW" | "I_NEGLIMITSW" => vec![(-MLONG, MLONG)],
        // D07: no range is printed.
        "CURFTIME" => vec![(0, MLONG)],
        // The list has no upper end; -1 is the default outside it.
        "AMPENCNO" => vec![(1, MLONG)],
        // D23: the nodes of CANopen; the others are reserved.
        "CANNR" => vec![(0, 127), (9999, 9999)],
        // D05: each digit 0 to 8.
        "CANBAUD" => digits(0..=8, 8).collect(),
        // MACS-VM-07: the index, or an edge of an input.
        "VMENCMTYP" => std::iter::once((0, 1)).chain((1..=9).map(|tens| (10 * tens + 2, 10 * tens + 3))).collect(),
        // With the optional 1000.
        "PRGPAR" => vec![(-1, 127), (999, 1127)],
        _ => return None,
    })
}

fn of_row(row: &Row) -> Vec<(i64, i64)> {
    let unit = if row.measure == Measure::Time { 1_000_000 } else { 1 };
    match row.range {
        Range::Int(low, high) => vec![(low / unit, high / unit)],
        Range::Among(ranges) => merge(ranges.to_vec()),
        Range::Real(low, high) => vec![(low as i64, high as i64)],
        Range::PositiveUpTo(_) => panic!("{} is no row of MACS", row.key),
    }
}

/// Proves: MACS-STO-01
#[test]
fn all_120_parameters_stand_once_in_their_space() {
    let lines = lines();
    let global = lines.iter().filter(|line| line.group == "GL").count();
    assert_eq!((lines.len() - global, global), (106, 14));
    assert_eq!(ROWS.iter().filter(|row| row.system == System::Macs).count(), 120);
    for line in &lines {
        let row = row(line);
        assert_eq!(row.key, line.name.to_lowercase());
        assert_eq!(row.number, line.number, "{}", line.name);
        assert_eq!(row.applies == Applies::Machine, line.group == "GL", "{}", line.name);
    }
    // The same number in both groups is two parameters.
    let both = lines.iter().filter(|line| line.group == "GL" && line.number == "114").count();
    assert_eq!((both, Row::find("posencqc").map(|(_, row)| row.number)), (1, Some("114")));
}

/// Proves: MACS-STO-01
#[test]
fn groups_are_those_of_the_table() {
    for line in lines() {
        // D01, D07: AXA is correct.
        let group = if line.name.starts_with("AMPENC") || line.name == "CURFTIME" { "AXA" } else { line.group };
        assert!(row(&line).group.text().ends_with(&format!("({group})")), "{}", line.name);
    }
}

#[test]
fn units_are_those_of_the_table() {
    for line in lines() {
        let expected = match (line.name, line.unit) {
            // printed as kHz, but the values are Hz.
            ("ENCODERFREQ", _) => "Hz",
            // D21: a factor.
            ("FEEDREV", _) => "",
            // D10, A-25
            ("FFACC", _) => "1/1000",
            ("AINFTIME", _) => "samples",
            (_, "-" | "bits") => "",
            (_, unit) => {
                let unit = unit.split(" (").next().unwrap_or("");
                &unit
                    .replace("qc", "inc")
                    .replace("RPM", "rpm")
                    .replace('µ', "u")
                    .replace('²', "^2")
                    .replace("/st", "/ms")
            }
        };
        let row = row(&line);
        let unit = if row.measure == Measure::Time { "ms" } else { row.unit };
        assert_eq!(unit, expected, "{}", line.name);
        assert!(row.measure != Measure::Time || row.bare == Bare::Milliseconds, "{}", line.name);
    }
}

#[test]
fn ranges_are_those_of_the_table() {
    for line in lines() {
        let printed = ranges(line.range);
        let expected = exception(line.name);
        assert!(expected.is_none() || expected != printed, "{} is no exception", line.name);
        let expected = expected.or(printed).unwrap_or_else(|| panic!("{}: {}", line.name, line.range));
        assert_eq!(of_row(row(&line)), expected, "{}", line.name);
    }
}

#[test]
fn defaults_are_those_of_the_table() {
    for line in lines() {
        let row = row(&line);
        let printed = line.init.split(" (").next().and_then(number);
        // it is not set at the start, so that in_position_time alone applies.
        let printed = if line.name == "TESTVAL" { Some(0) } else { printed };
        let unit = if row.measure == Measure::Time { 1_000_000 } else { 1 };
        match (row.default, printed) {
            (Value::Int(value), Some(printed)) => assert_eq!(value, printed * unit, "{}", line.name),
            (Value::Real(value), Some(printed)) => assert_eq!(value, printed as f64, "{}", line.name),
            (Value::Unset, None) => assert_eq!(row.storage, Storage::Derived, "{}", line.name),
            other => panic!("{}: {other:?}", line.name),
        }
    }
}

/// Where the overview and the details of the manual disagree, a row names the one that is used, and its values follow
/// it.
#[test]
fn row_documents_each_disagreement_of_manual() {
    for line in lines() {
        for delta in line.delta.split_whitespace() {
            assert!(row(&line).note.contains(delta), "{} says nothing of {delta}", line.name);
        }
    }
    let find = |key: &str| Row::find(key).map(|(_, row)| row).unwrap_or_else(|| panic!("{key}"));
    let uses = table(MACS, "### 1.1 Overview table");
    assert_eq!(uses.len(), 23);
    for line in uses {
        let [delta, _, _, used] = cells(line)[..] else { panic!("{line}") };
        let is = match delta {
            "D01" => ["ampencno", "ampencres", "ampencrpm"].iter().all(|key| find(key).group == Group::Amplifier),
            "D02" => [("ampencres", -1), ("ampencrpm", 0)].iter().all(|(key, init)| {
                let row = find(key);
                row.check(Value::Int(*init)) == Ok(()) && row.default == Value::Int(*init)
            }),
            "D03" => find("amppwmfreq").mnemonic == "AMPPWMFREQ" && find("amppwmfreq").unit == "Hz",
            "D04" => find("bandwidth").unit == "1/10 %",
            "D05" => [57, 88, 5].iter().all(|code| takes("canbaud", *code)) && !takes("canbaud", 9),
            "D06" => find("cansynctimer").default == Value::Int(1),
            "D07" => takes("curftime", MLONG) && find("curftime").group == Group::Amplifier,
            "D08" => find("curkint").group == Group::Amplifier,
            "D09" => takes("drivetype", -194) && takes("drivetype", 194) && !takes("drivetype", 195),
            "D10" => find("ffvel").unit == "1/1000",
            "D11" => ["dfltvel", "dfltacc", "home_ramp"].iter().all(|key| find(key).unit == "1/VELRES"),
            "D12" => ["jerkmin", "jerkmin2", "jerkmin3", "jerkmin4"].iter().all(|key| Row::find(key).is_some()),
            "D13" => find("kder").default == Value::Int(0),
            "D14" => find("kilim").default == Value::Int(1000),
            "D15" => find("poserr").default == Value::Int(1000),
            "D16" => find("proftime").default == Value::Int(1) && find("proftime").unit == "ms",
            "D17" => find("syncready").default == Value::Int(1),
            "D18" => find("syncmarks").default == Value::Int(1),
            "D19" => find("syncsftime").unit == "ms",
            // The names are those of the table, which the numbers have found.
            "D20" => used == "canonical names",
            "D21" => find("feedrev").unit.is_empty(),
            "D22" => find("posencqc").group == Group::Encoder && find("posencqc").mnemonic == "POSENCQC",
            "D23" => takes("cannr", 127) && takes("cannr", 9999) && !takes("cannr", 128),
            _ => panic!("{delta}"),
        };
        assert!(is, "{delta}: {used}");
    }
}

/// Returns true if the value is within the range, whether or not it is implemented.
fn takes(key: &str, value: i64) -> bool {
    let row = Row::find(key).map(|(_, row)| row).unwrap_or_else(|| panic!("{key}"));
    row.check(Value::Int(value)) != Err(Refused::OutOfRange)
}

/// Proves: MACS-STO-09
#[test]
fn moments_of_effect_are_those_of_the_source() {
    for (effect, keys) in [
        (Effect::AtOnce, &["syncmwinm", "syncmwins", "syncposoffs", "proftime"][..]),
        (Effect::NextSynchronize, &["syncaccuracy"]),
        (Effect::NextMotion, &["jerkmin", "jerkmin2", "jerkmin3", "jerkmin4"]),
        (Effect::NextVirtualMaster, &["vmenctyp"]),
        (Effect::Disabled, &["drivetype", "encodertype", "mencodertype"]),
    ] {
        for key in keys {
            assert_eq!(Row::find(key).map(|(_, row)| row.effect), Some(effect), "{key}");
        }
    }
}

/// Limits of a set refer to the direction of rotation at the end of the set.
#[test]
fn direction_of_rotation_is_applied_first() {
    let place = |key: &str| Row::find(key).unwrap().0;
    assert_eq!(place("posdrct"), rows::SENSE_ROW);
    let change = |key: &str| Change { axis: 0, row: place(key), value: Value::Int(1) };
    let set = ["max_position", "posdrct", "min_position"].map(change);
    let order: Vec<_> = in_order(&set).map(|change| change.row).collect();
    assert_eq!(order, ["posdrct", "max_position", "min_position"].map(place));
}

//! The rows of the other sources against their tables, and the source references of all rows.

use super::super::*;
use super::spec::{AMC, MACS, SAIA, SET_ASIDE, WF, requirements};

fn of(system: System, number: &str) -> Option<&'static Row> {
    ROWS.iter().find(|row| row.system == system && row.number == number)
}

/// Proves: AMC-PAR-01, AMC-PAR-02, AMC-PAR-03, AMC-PAR-05, AMC-PAR-06, AMC-PAR-07, AMC-PAR-08, AMC-PAR-09
#[test]
fn menu_34_is_complete() {
    let lines = requirements(AMC, "AMC-PAR-");
    assert_eq!(lines.len(), 8);
    for line in lines {
        let [id, name, range, default, _, _, attributes] = line[..] else { panic!("{line:?}") };
        let (number, name) = name.split_once(' ').unwrap();
        let row = of(System::Amc, number).unwrap_or_else(|| panic!("no row {number}"));
        assert_eq!(row.mnemonic, name);
        assert!(row.source.contains(id), "{id}");
        // `0..3: meaning`.
        let whole = range.split([':', ' ']).next().and_then(|range| range.split_once(".."));
        if let Some((low, high)) = whole {
            let (low, high) = (low.parse().unwrap(), high.parse().unwrap());
            assert_eq!(row.range, Range::Int(low, high), "{name}");
        }
        if default != "none" {
            let zero = if row.measure == Measure::Velocity { Value::Real(0.0) } else { Value::Int(0) };
            assert_eq!((default.starts_with('0'), row.default), (true, zero), "{name}");
        }
        assert_eq!(row.is_read_only(), attributes.contains("RO"), "{name}");
        let is_volatile = !matches!(row.storage, Storage::User);
        assert_eq!(is_volatile, attributes.contains("volatile"), "{name}");
    }
    // 34.008 has three values, written as names.
    assert_eq!(of(System::Amc, "34.008").map(|row| row.range), Some(Range::Int(0, 2)));
    // Values of other menus that the selector uses have a row if they are parameters.
    assert!(of(System::Amc, "41.007").is_some() && of(System::Amc, "41.024").is_some());
}

/// Proves: SAIA-REG-00, SAIA-REG-01, SAIA-REG-02, SAIA-REG-03, SAIA-REG-04, SAIA-REG-05, SAIA-REG-06, SAIA-REG-07,
/// SAIA-REG-08, SAIA-REG-09, SAIA-REG-10, SAIA-REG-11, SAIA-REG-12, SAIA-REG-13, SAIA-REG-14, SAIA-REG-15, SAIA-REG-16,
/// SAIA-REG-17, SAIA-REG-18, SAIA-REG-19
#[test]
fn the_registers_are_complete() {
    let lines = requirements(SAIA, "SAIA-REG-");
    assert_eq!(lines.len(), 20);
    for line in lines {
        let [id, number, name, kind, way, _] = line[..] else { panic!("{line:?}") };
        let row = of(System::Saia, number).unwrap_or_else(|| panic!("no row {number}"));
        assert_eq!((row.mnemonic, row.source), (name, id));
        assert_eq!(row.key, format!("saia.{}", name.to_lowercase()));
        assert_eq!(row.is_read_only(), way == "out", "{name}");
        let unit = if number == "6" { "counts" } else { kind.split_once(", ").map_or("", |(_, unit)| unit) };
        assert!(number == "5" || row.unit == unit, "{name}: {unit}");
        if let Storage::Signal(signal) = row.storage {
            assert_eq!(signal, row.key);
        }
    }
}

/// Machine data that are a part of the cell instead of a row, and their keys.
const IN_THE_CELL: [(&str, &str); 3] = [("18", "type, modulo"), ("19", "scale"), ("20", "scale")];

/// Proves: WF-MD-01, WF-MD-02, WF-MD-14, WF-MD-15, WF-MD-19, WF-MD-20
#[test]
fn the_machine_data_are_complete() {
    let lines = requirements(WF, "WF-MD-");
    assert_eq!(lines.len(), 22);
    for line in lines {
        let [id, numbers, ..] = line[..] else { panic!("{line:?}") };
        if numbers == "no number given" {
            assert!(ROWS.iter().filter(|row| row.source.contains(id)).count() >= 7);
            continue;
        }
        for number in numbers.split(", ") {
            let is_set_aside = SET_ASIDE.contains(&format!("- {id}: "));
            let is_in_the_cell = IN_THE_CELL.iter().any(|(known, _)| *known == number);
            let row = of(System::Wf, number);
            assert!(row.is_some() != (is_set_aside || is_in_the_cell), "{id} MD{number}");
            assert!(row.is_none_or(|row| row.source.contains(id) && row.key == format!("wf.md{number}")), "{id}");
        }
    }
}

/// A register that is shown is a signal of the axis.
#[test]
fn every_signal_that_a_row_names_exists() {
    let mut directory = crate::signal::Directory::default();
    crate::vocabulary::saia::SaiaSignal::add_all(&mut directory, "x");
    crate::vocabulary::amc::AmcSignal::add_all(&mut directory, "x");
    let mut count = 0;
    for row in ROWS {
        if let Storage::Signal(signal) = row.storage {
            assert!(directory.find(&format!("x.{signal}")).is_some(), "{signal}");
            assert_eq!((row.get)(&AxisParameters::new(1.0, 1.0)), Value::Unset);
            assert_eq!(row.assign(&mut AxisParameters::new(1.0, 1.0), Value::Unset), Err(Refused::ReadOnly));
            count += 1;
        }
    }
    assert_eq!(count, 8);
}

#[test]
fn every_row_names_requirements_that_exist() {
    let specs = [MACS, AMC, SAIA, WF].concat();
    for row in ROWS {
        assert!(!row.description.is_empty() && row.description.ends_with('.'), "{}", row.key);
        assert!(!row.source.is_empty(), "{}", row.key);
        let mut prefix = "";
        for id in row.source.split([',', ' ']).filter(|id| !id.is_empty()) {
            // `AMC-STP-02..06` is a range; `contract section 7` is no requirement.
            let id = id.split("..").next().unwrap_or(id);
            if id.contains('-') {
                let is_there =
                    [format!("**{id}**"), format!("| {id} "), format!("- {id} ")].iter().any(|one| specs.contains(one));
                assert!(is_there, "{} names {id}", row.key);
            }
            prefix = if prefix.is_empty() { id } else { prefix };
        }
        assert_eq!(row.system == System::Macs, prefix.starts_with("MACS") && !row.mnemonic.is_empty(), "{}", row.key);
        // A view applies to the same axes as its native row.
        if row.is_view() {
            let native = Row::find(row.view_of).map(|(_, row)| row.applies);
            assert_eq!(native, Some(row.applies), "{}", row.key);
        }
    }
}

/// Texts are complete sentences.
#[test]
fn descriptions_and_notes_read_well() {
    for row in ROWS {
        for text in [row.description, row.note].into_iter().filter(|text| !text.is_empty()) {
            assert!(
                text.starts_with(|c: char| c.is_uppercase() || c.is_ascii_digit() || c == '-'),
                "{}: {text}",
                row.key
            );
            assert!(text.ends_with('.') && !text.contains("  "), "{}: {text}", row.key);
        }
    }
}

//! Tests the description of the catalogue.

use crate::cell::Cell;
use crate::parameters::{Filter, details, listing, markdown, meant, values};
use lineshaft_core::parameter::{ROWS, Row, System};

fn filter(pattern: &str) -> Filter {
    Filter::new(Some(pattern), None).expect("a good pattern")
}

/// docs/parameters.md must be the generated page. After a change of a row:
/// `lineshaft params --markdown > docs/parameters.md`.
#[test]
fn the_page_in_docs_is_the_one_that_the_program_makes() {
    let page = include_str!("../../../../docs/parameters.md");
    let same = page.lines().zip(markdown().lines().map(str::to_owned)).find(|(there, made)| there != made);
    assert_eq!(same, None, "write it anew: lineshaft params --markdown > docs/parameters.md");
    assert_eq!(page, markdown(), "write it anew: lineshaft params --markdown > docs/parameters.md");
}

#[test]
fn every_row_has_a_line_with_as_many_cells_as_its_head() {
    let page = markdown();
    for row in ROWS {
        let line = format!("| `{}` |", row.key);
        let lines: Vec<_> = page.lines().filter(|given| given.starts_with(&line)).collect();
        assert_eq!(lines.len(), 1, "{}", row.key);
        assert_eq!(lines[0].replace("\\|", "").matches('|').count(), 10, "{}", lines[0]);
        assert!(lines[0].contains(row.source) && lines[0].contains(row.note), "{}", lines[0]);
    }
}

#[test]
fn a_pattern_finds_keys_and_names_of_the_source_in_any_letters() {
    let keys = |pattern: &str| filter(pattern).rows().iter().map(|row| row.key).collect::<Vec<_>>();
    assert_eq!(keys("KPROP"), ["kprop", "saia.kprop"]);
    assert_eq!(keys("Position Reference"), ["amc.position_reference"]);
    assert_eq!(keys("max_v*"), ["max_velocity"]);
    assert!(keys("*").len() == ROWS.len());
    assert_eq!(Filter::new(Some("["), None).unwrap_err(), "`[` is no pattern: unclosed character class; missing ']'");
    let macs = Filter::new(None, Some(System::Macs)).unwrap();
    assert_eq!(macs.rows().len(), ROWS.iter().filter(|row| row.system == System::Macs).count());
    assert_eq!(meant("MAX_VELOCTY").as_deref(), Some("max_velocity"));
    assert_eq!(meant("Max_Vel").as_deref(), Some("*max_vel*"));
    assert_eq!(meant("banana"), None);
}

#[test]
fn a_table_keeps_to_its_width_and_has_every_row() {
    let rows: Vec<&Row> = ROWS.iter().collect();
    for width in [80, 120, 200] {
        let text = listing(&rows, width);
        for row in ROWS {
            assert!(text.lines().any(|line| line.split(' ').next() == Some(row.key)), "{}", row.key);
        }
        // A word that is longer than its column is not split.
        let longest = text.lines().map(|line| line.chars().count()).max().unwrap();
        assert!(longest <= width.max(110), "{longest} at {width}");
    }
    let text = listing(&filter("jerkmin*").rows(), 120);
    let first = text.lines().nth(1).unwrap();
    assert!(first.starts_with("jerkmin   ms"), "{text}");
    assert!(
        first.contains("0 ms") && first.contains("next motion") && first.contains("Time from acceleration 0"),
        "{text}"
    );
}

#[test]
fn details_show_all_data_of_a_row() {
    let (_, row) = Row::find("velmax").unwrap();
    let text = details(row, 100);
    for part in ["velmax\n", "VELMAX, no. 1", "another view of", "rpm", "1 to 65535", "1000", "saved", "MACS-PROF-02"] {
        let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.contains(part.trim_end()), "{part} is not in\n{text}");
    }
    let (_, row) = Row::find("revers").unwrap();
    assert!(details(row, 100).contains("-90, -80, .. -10, 0 to 2, 10 to 12, .. 12790 to 12792"));
    assert!(details(row, 100).contains("only 0 is taken") || row.missing.is_empty());
    let (_, row) = Row::find("max_velocity").unwrap();
    let text = details(row, 100);
    assert!(
        text.contains("views         velmax") && text.contains("required") && text.contains("2^31 inc per cycle"),
        "{text}"
    );
}

#[test]
fn values_are_shown_in_the_axis_unit_and_differences_are_marked() {
    let cell = Cell::demo();
    let parameters: Vec<_> = cell.machine.axes.iter().map(|axis| axis.parameters).collect();
    let lines = |pattern: &str, changed| {
        let text = values(&cell.machine, &parameters, &filter(pattern), changed);
        text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect::<Vec<_>>()
    };
    assert_eq!(
        lines("max_velocity", false),
        [
            "line.max_velocity * 3 m/s required",
            "x.max_velocity * 1200 mm/s required",
            "y.max_velocity * 1000 mm/s required",
            "turret.max_velocity * 90 deg/s required"
        ]
    );
    assert_eq!(lines("x.velmax", false), ["x.velmax 3774873.6 rpm view of max_velocity"]);
    assert_eq!(lines("x.setpoint_timeout", false), ["x.setpoint_timeout 100 ms default"]);
    assert_eq!(lines("x.in_position_window", true), ["x.in_position_window * 0.01 mm (1049 inc) default 0 inc"]);
    assert!(lines("x.setpoint_timeout", true).is_empty() && lines("x.velmax", true).is_empty());
    // Parameters that an axis does not have are not listed.
    assert!(lines("line.poserr", false).is_empty());
}

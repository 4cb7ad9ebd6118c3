//! Tests the descriptions of types.

use super::{details, listing, markdown, renewed};
use lineshaft_core::function::{Kind, TYPES};
use std::path::Path;

/// The blocks of docs/functions.md must be the generated ones.
/// `LINESHAFT_RENEW=1 cargo test -p lineshaft --lib functions` regenerates them.
#[test]
fn the_page_in_docs_holds_what_the_program_makes() {
    crate::page::check("functions.md", "functions", |page| renewed(page).unwrap());
}

#[test]
fn a_page_without_a_block_is_told_which_one() {
    let page = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/functions.md")).unwrap();
    let error = renewed(&page.replace("<!-- end imes -->", "")).unwrap_err();
    assert!(error.contains("begin imes"), "{error}");
}

#[test]
fn each_type_has_its_line_and_its_section_in_the_page() {
    let page = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/functions.md")).unwrap();
    for row in TYPES {
        let lines = listing(120);
        assert!(lines.lines().any(|line| line.starts_with(row.name) && line.ends_with(row.help)), "{lines}");
        assert!(page.contains(&format!("\n### {}\n", row.name)), "{}", row.name);
    }
}

#[test]
fn every_field_is_shown_with_all_that_is_said_of_it() {
    for row in TYPES {
        let (text, page) = (details(row, 400), markdown());
        for field in row.fields {
            let shown = format!("{} to {}", field.min, field.max);
            let is_shown =
                |text: &str| text.contains(field.name) && text.contains(&shown) && text.contains(field.source);
            assert!(is_shown(&text) && is_shown(&page), "{} {}", row.name, field.name);
            assert!(text.contains(&format!("{} [{}]", field.help, field.source)), "{text}");
        }
    }
}

#[test]
fn a_type_tells_what_it_reads_and_writes() {
    let text = |kind: Kind| details(kind.description(), 200);
    let digdreh = text(Kind::Digdreh);
    for line in [
        "digdreh: switches a speed on and off by inputs",
        "  source    none",
        "  sink      a speed (0.0001 rpm): an axis, a memory cell of numbers, an ao or none",
        "  inputs    E1 to E3",
        "  outputs   A1; RESET makes A1 1",
        "  tables    none",
        "  VALUE_NEW is refused",
        "  speed  -2147483648 to 2147483647 (0.0001 rpm), left out: 0, from START on",
    ] {
        assert!(digdreh.lines().any(|there| there == line), "{line}\n{digdreh}");
    }
    let binea = text(Kind::Binea);
    for line in [
        "  sink      none",
        "  tables    1, which keeps its numbers while the function runs",
        "  word      mw_offset_addr names the signal that is read in each call as well as the source",
        "  VALUE_NEW takes the live fields",
        "  dead_time  0 to 32000 (0.5 ms), left out: 0, live",
        "  tracks  1 to 8, must be given, from START on",
        "  mode[0..7]  0 to 63 (bits), left out: 0, from START on",
    ] {
        assert!(binea.lines().any(|there| there == line), "{line}\n{binea}");
    }
    assert!(
        text(Kind::Varsync)
            .contains("  shows     sak_share, what compensation of the following error adds to its sink (inc)\n")
    );
    let fgen = text(Kind::Fgen);
    for line in [
        "  word      override_addr names the signal that is read in each call as well as the source",
        "  shows     feedback1 to feedback8, actual position of the axis with that number, since it was zeroed (inc)",
        "  pos_limit[0..6]  0 to 2147483647 (inc), left out: 0, live",
    ] {
        assert!(fgen.lines().any(|there| there == line), "{line}\n{fgen}");
    }
    // A value without unit is printed without one.
    assert!(text(Kind::Apsf).contains("  shows     fuel, instructions that the last call of its program took\n"));
    assert!(text(Kind::Dfkt).contains("  shows     limit.ratio_max, ratio_max limits the output; limit.ratio_min, "));
    assert_eq!(text(Kind::Regl).matches("  word      src").count(), 2);
    assert!(text(Kind::Epos).contains("  goals     orders that end, by ~/run_function\n") && !fgen.contains("  goals"));
    for (kind, chooses) in [(Kind::Dcopy, true), (Kind::Ecopy, true), (Kind::Apsf, true), (Kind::Varsync, false)] {
        let line = "\n  quantity  position, or speed (0.0001 rpm) where the cell says so\n";
        assert_eq!(text(kind).contains(line), chooses, "{kind:?}");
    }
    assert!(text(Kind::Dcopy).contains("an axis, a memory cell of numbers, an ao or none; it must be given\n"));
    assert!(text(Kind::Fipw).contains("  tables    up to 8, which keep their numbers while the function runs\n"));
    assert!(text(Kind::Cam).contains("  tables    1, which may get new numbers while the function runs\n"));
}

#[test]
fn a_narrow_terminal_gets_more_lines() {
    for row in TYPES {
        let text = details(row, 60);
        assert!(
            text.lines().filter(|line| line.starts_with("      ")).all(|line| line.chars().count() <= 60),
            "{text}"
        );
    }
}

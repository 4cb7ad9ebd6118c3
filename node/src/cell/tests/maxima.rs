//! Tests the table of maxima in docs/contract.md.

use crate::document::{MAX_BYTES, MAX_VALUES};
use lineshaft_core::config::{MAX_MASTERS, MAX_MEMBERS, MAX_SLOTS};
use lineshaft_core::drive::MAX_LATCHES;
use lineshaft_core::machine::MAX_COMMANDS;
use lineshaft_core::object::MAX_AXES;
use lineshaft_core::table::MAX_NUMBERS;
use lineshaft_core::trajectory::{MAX_KNOTS, MAX_POINTS};

#[test]
fn contract_lists_the_maxima_of_the_program() {
    let page = include_str!("../../../../docs/contract.md");
    let mebibytes = MAX_BYTES >> 20;
    for row in [
        format!("| axes | {MAX_AXES} |"),
        format!("| encoders, io, memory cells, tables | {} of each |", u16::MAX),
        format!("| functions (slots 0 to {}), programs | {MAX_SLOTS} of each |", MAX_SLOTS - 1),
        format!("| masters; members of one | {MAX_MASTERS}; {MAX_MEMBERS} |"),
        format!("| points of a table | {MAX_NUMBERS}; "),
        format!("| text of a cell or scenario | {mebibytes} MiB, {MAX_VALUES} values |"),
        format!("| points of a trajectory; points times axes | {MAX_POINTS}; {MAX_KNOTS} |"),
        format!("| commands of a cycle; latches of a cycle | {MAX_COMMANDS}; {MAX_LATCHES} |"),
    ] {
        assert!(page.contains(&row), "{row}");
    }
}

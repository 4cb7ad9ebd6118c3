//! Tests the drawings of docs/homing.md: every homing method, as simulated with launch-configs/homing.yaml.

use crate::drawing::{Figure, Fixtures, Panel, Scheme};

/// Limit switches at the ends; the index of the axis `ends`.
const ENDS: Fixtures = Fixtures { axis: "ends", home: None, limits: true, index: (300, 800) };
const RIGHT: Fixtures = Fixtures { axis: "right", home: Some((1000, 4000)), limits: false, index: (300, 800) };
const LEFT: Fixtures = Fixtures { axis: "left", home: Some((-4000, -1000)), limits: false, index: (300, 800) };
const MIDDLE: Fixtures = Fixtures { axis: "middle", home: Some((-200, 600)), limits: true, index: (30, 300) };
const MACS: Fixtures = Fixtures { axis: "macs", home: Some((1000, 1400)), limits: false, index: (300, 800) };

/// Left of the switch, on it, and right of it.
const AROUND: &[i64] = &[-1500, 200, 1500];

fn cia402(fixtures: Fixtures, number: i8, starts: &'static [i64], reference: i64) -> Panel {
    Panel { fixtures, scheme: Scheme::Cia402, number, starts, reference: Some(reference) }
}

fn macs(number: i8, reference: i64) -> Panel {
    Panel { fixtures: MACS, scheme: Scheme::Macs, number, starts: &[-1500], reference: Some(reference) }
}

#[test]
fn ends_of_the_way_and_the_next_index() {
    let here = |number| Panel { reference: None, ..cia402(ENDS, number, &[-700, 1500], 0) };
    Figure {
        name: "homing_ends",
        panels: vec![
            cia402(ENDS, 1, &[500], -2900),
            cia402(ENDS, 2, &[500], 2700),
            cia402(ENDS, 17, &[500], -3000),
            cia402(ENDS, 18, &[500], 3000),
            cia402(ENDS, 33, &[500], 300),
            cia402(ENDS, 34, &[500], 1100),
            here(35),
            here(37),
        ],
    }
    .is_in_docs();
}

#[test]
fn a_reference_switch_at_one_end() {
    let (right, left): (&[i64], &[i64]) = (&[-500, 2200], &[500, -2200]);
    Figure {
        name: "homing_side",
        panels: vec![
            cia402(RIGHT, 3, right, 300),
            cia402(RIGHT, 4, right, 1100),
            cia402(RIGHT, 19, right, 1000),
            cia402(RIGHT, 20, right, 1000),
            cia402(LEFT, 5, left, -500),
            cia402(LEFT, 6, left, -1300),
            cia402(LEFT, 21, left, -1000),
            cia402(LEFT, 22, left, -1000),
        ],
    }
    .is_in_docs();
}

#[test]
fn a_reference_switch_in_the_middle_with_the_index() {
    let references = [(7, -270), (8, 30), (9, 330), (10, 630), (11, 630), (12, 330), (13, 30), (14, -270)];
    let panels = references.map(|(number, reference)| cia402(MIDDLE, number, AROUND, reference)).to_vec();
    Figure { name: "homing_middle", panels }.is_in_docs();
}

#[test]
fn a_reference_switch_in_the_middle_without_the_index() {
    let references = [(23, -200), (24, -200), (25, 600), (26, 600), (27, 600), (28, 600), (29, -200), (30, -200)];
    let panels = references.map(|(number, reference)| cia402(MIDDLE, number, AROUND, reference)).to_vec();
    Figure { name: "homing_edges", panels }.is_in_docs();
}

#[test]
fn the_sequences_of_macs() {
    let panels = vec![macs(0, 300), macs(1, 1000), macs(2, 1900), macs(3, 1400)];
    Figure { name: "homing_macs", panels }.is_in_docs();
}

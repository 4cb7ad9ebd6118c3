//! Matrix of every method from every kind of start position, with and without the index. The expected values were taken
//! from the standard (CiA 402-2, figures of the methods) and MACS-HOME-03 before any test was run.

use super::{FAR, LEFT_END, RIGHT_END, cell, home, homed_events, place, rig, rig_with, run_to_end, travel_range, zero};
use crate::code::Code;
use crate::event::Number;
use crate::sim::{Model, SecondOrder};

/// Actuated from here to the right end, for methods 3, 4 and similar ones.
const TO_THE_RIGHT: (i64, i64) = (5_000, FAR);
/// Actuated from the left end to here.
const TO_THE_LEFT: (i64, i64) = (-FAR, -5_000);
/// Actuated on a part of the travel range.
const PART: (i64, i64) = (4_000, 7_000);
/// Actuated on a width of 12 increments.
const NARROW: (i64, i64) = (4_000, 4_011);

/// Left, right, on and between: the ends, the edges of all switches and the positions next to them.
const STARTS: [i64; 16] = [
    -20_500, -20_000, -19_999, -12_000, -5_001, -5_000, -1, 3_999, 4_000, 5_000, 5_500, 7_000, 7_001, 12_000, 19_999,
    20_500,
];

/// Method, its switch, the position of its reference.
const EXPECTED: [(i64, (i64, i64), i64); 32] = [
    // The first pulse right of the position where the negative limit switch is released, and left of the positive one.
    (1, PART, -19_700),
    (2, PART, 18_300),
    // The first pulse left and right of the edge of the reference switch.
    (3, TO_THE_RIGHT, 4_300),
    (4, TO_THE_RIGHT, 6_300),
    (5, TO_THE_LEFT, -3_700),
    (6, TO_THE_LEFT, -5_700),
    // Left of the left edge, right of it, left of the right edge, right of it.
    (7, PART, 2_300),
    (8, PART, 4_300),
    (9, PART, 6_300),
    (10, PART, 8_300),
    // Right of the right edge, left of it, right of the left edge, left of it.
    (11, PART, 8_300),
    (12, PART, 6_300),
    (13, PART, 4_300),
    (14, PART, 2_300),
    // The same edges themselves: the outermost position at which the switch is actuated.
    (17, PART, LEFT_END),
    (18, PART, RIGHT_END),
    (19, TO_THE_RIGHT, 5_000),
    (20, TO_THE_RIGHT, 5_000),
    (21, TO_THE_LEFT, -5_000),
    (22, TO_THE_LEFT, -5_000),
    (23, PART, 4_000),
    (24, PART, 4_000),
    (25, PART, 7_000),
    (26, PART, 7_000),
    (27, PART, 7_000),
    (28, PART, 7_000),
    (29, PART, 4_000),
    (30, PART, 4_000),
    // HOME_TYPE 0: back off the switch, then to the index; 1: its edge.
    (-1, TO_THE_RIGHT, 4_300),
    (-2, TO_THE_RIGHT, 5_000),
    // 2: across the switch, then to the index; 3: its far edge.
    (-3, PART, 8_300),
    (-4, PART, 7_000),
];

/// A sequence of MACS always moves in the same direction: from a start beyond the switch it never finds it.
fn never_finds(method: i64, switch: (i64, i64), start: i64) -> bool {
    matches!(method, -4 | -3) && start > switch.1
}

/// Proves: MACS-HOME-03, MACS-HOME-04, MACS-HOME-07, MACS-CMD-01
#[test]
fn every_method_finds_the_place_of_the_standard_from_everywhere() {
    for (method, switch, expected) in EXPECTED {
        for start in STARTS {
            let mut rig = rig(travel_range(start, switch));
            let sequence = home(&mut rig, method);
            assert!(rig.was_accepted(sequence));
            assert_eq!(rig.state("x"), "HOMING");
            let done = run_to_end(&mut rig, sequence);
            let what = format!("method {method} from {start}");
            if never_finds(method, switch, start) {
                assert_eq!((done.code, rig.int("x.homed")), (Code::HOMING_AT_LIMIT, 0), "{what}");
                assert!(place(&rig, start) < RIGHT_END + 1_000, "{what} stopped at {}", place(&rig, start));
                continue;
            }
            assert_eq!(done.code, Code::NONE, "{what}");
            assert_eq!(zero(&rig, start), expected, "{what}");
            // The new zero in the previous coordinate, which was 0 at the start.
            let shift = Number::Position(expected - start);
            assert_eq!((done.asked, homed_events(&rig)), (shift, vec![shift]), "{what}");
            assert_eq!((rig.int("x.homed"), rig.int("x.error"), rig.int("x.homing.phase")), (1, 0, 0), "{what}");
            assert_eq!(rig.state("x"), "STANDSTILL");
            if method < 0 {
                assert_eq!(rig.int("x.command.position"), 0, "{what} ends at its zero");
            }
        }
    }
}

/// ENCODER 500: an error after more than 2000 qc.
///
/// Proves: MACS-O-19, MACS-HOME-05
#[test]
fn without_the_index_every_method_that_needs_it_ends_in_its_error_within_a_revolution() {
    for (method, switch, _) in EXPECTED {
        let needs_index = matches!(method, 1..=14 | -1 | -3);
        for start in STARTS {
            let mut rig = rig(travel_range(start, switch));
            rig.plant.drive(0).unwrap().lose_index();
            let sequence = home(&mut rig, method);
            let mut from = None;
            while rig.done(sequence).is_empty() {
                rig.run(1);
                if rig.int("x.homing.phase") == 3 {
                    from.get_or_insert(place(&rig, start));
                }
            }
            let done = rig.done(sequence)[0];
            let what = format!("method {method} from {start}");
            let expected = match method {
                _ if never_finds(method, switch, start) => Code::HOMING_AT_LIMIT,
                _ if needs_index => Code::HOMING_INDEX_MISSED,
                _ => Code::NONE,
            };
            assert_eq!(done.code, expected, "{what}");
            if expected == Code::HOMING_INDEX_MISSED {
                // More than a revolution, by at most one cycle.
                let gone = (place(&rig, start) - from.unwrap()).abs();
                assert_eq!(gone, 2_001, "{what}");
                assert_eq!((rig.state("x"), rig.int("x.homed")), ("ERROR_STOP", 0), "{what}");
                assert_eq!(rig.int("x.error"), i64::from(Code::HOMING_INDEX_MISSED.0));
            }
        }
    }
}

#[test]
fn the_next_index_to_either_side() {
    // In the direction into a limit switch there is no index.
    let mut into_limit = rig(travel_range(LEFT_END, PART));
    let sequence = home(&mut into_limit, 33);
    assert_eq!(run_to_end(&mut into_limit, sequence).code, Code::HOMING_AT_LIMIT);
    for start in [-12_345, -1_701, -1_700, -1_699, 299, 300, 301, 12_345] {
        // Pulses at 300 + 2000 n; the pulse at the start position has passed.
        let left = (start - 301_i64).div_euclid(2_000) * 2_000 + 300;
        let right = (start - 300_i64).div_euclid(2_000) * 2_000 + 2_300;
        for (method, expected) in [(33, left), (34, right)] {
            let mut rig = rig(travel_range(start, PART));
            let sequence = home(&mut rig, method);
            assert_eq!(run_to_end(&mut rig, sequence).code, Code::NONE, "method {method} from {start}");
            assert_eq!(zero(&rig, start), expected, "method {method} from {start}");
        }
        for method in [35, 37] {
            let mut rig = rig(travel_range(start, PART));
            let sequence = home(&mut rig, method);
            assert_eq!(run_to_end(&mut rig, sequence).code, Code::NONE);
            assert_eq!(zero(&rig, start), start);
        }
        let mut rig = rig(travel_range(start, PART));
        rig.plant.drive(0).unwrap().lose_index();
        let sequence = home(&mut rig, 34);
        assert_eq!(run_to_end(&mut rig, sequence).code, Code::HOMING_INDEX_MISSED);
    }
}

/// A drive with its own dynamics, and inputs that arrive late.
#[test]
fn a_drive_that_lags_finds_the_same_places() {
    let law = SecondOrder::new(60.0, 0.8, 1_000_000).unwrap();
    for (method, switch, expected) in EXPECTED {
        for start in [-12_000, 5_500, 12_000] {
            let mut rig = rig_with(cell(2), Model::SecondOrder(law), travel_range(start, switch));
            let sequence = home(&mut rig, method);
            let done = run_to_end(&mut rig, sequence);
            if never_finds(method, switch, start) {
                continue;
            }
            assert_eq!(done.code, Code::NONE, "method {method} from {start}");
            assert_eq!(zero(&rig, start), expected, "method {method} from {start}");
        }
    }
}

/// The axis cannot stop on a switch that is narrower than its stopping distance: 500 inc, while the switch has 12.
#[test]
fn a_switch_that_is_passed_while_stopping_is_found_again() {
    // Pulses on both sides of the switch and none within it.
    let expected =
        [(23, 4_000), (24, 4_000), (25, 4_011), (26, 4_011), (27, 4_011), (28, 4_011), (29, 4_000), (30, 4_000)];
    for (method, expected) in expected.into_iter().chain([(7, 2_300), (10, 4_300), (11, 4_300), (14, 2_300)]) {
        for start in [-12_000, 3_999, 4_005, 4_012, 12_000] {
            let mut rig = rig(travel_range(start, NARROW));
            let sequence = home(&mut rig, method);
            assert_eq!(run_to_end(&mut rig, sequence).code, Code::NONE, "method {method} from {start}");
            assert_eq!(zero(&rig, start), expected, "method {method} from {start}");
        }
    }
}

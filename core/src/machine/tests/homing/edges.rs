//! Homing from next to an edge, and edges that a simulated switch latches with its input.

use super::super::rig::X;
use super::{assign, cell, home, rig_with, run_to_end, zero};
use crate::code::Code;
use crate::drive::{Interface, inputs};
use crate::event::Kind;
use crate::parameter::Value;
use crate::sim::{Fixtures, Index, Mechanics, Model, SwitchWiring, VelocityLag};

const L: i64 = 200;
const R: i64 = 1_200;

/// Returns the switch of a method, and the position of its reference with pulses at 100 + 300 n, derived by hand from
/// the figures of CiA 402-2.
fn expected(method: i64) -> ((i64, i64), i64) {
    let (to_right, to_left, part) = ((L, 9_000), (-9_000, R), (L, R));
    match method {
        3 => (to_right, 100),
        4 => (to_right, 400),
        19 | 20 => (to_right, L),
        5 => (to_left, 1_300),
        6 => (to_left, 1_000),
        21 | 22 => (to_left, R),
        7 | 14 => (part, 100),
        8 | 13 => (part, 400),
        9 | 12 => (part, 1_000),
        10 | 11 => (part, 1_300),
        23 | 24 | 29 | 30 => (part, L),
        _ => (part, R),
    }
}

/// The core closes the loop, so the position of the axis oscillates at rest: across the edge of a switch from next to
/// it, in the middle of a phase that reverses there. Each phase finds its edge, and the zero is the same as for any
/// other start.
#[test]
fn axis_oscillating_across_switch_edge_finds_its_zero() {
    for method in (3..=14).chain(19..=30) {
        let (home_switch, reference) = expected(method);
        for edge in [L, R] {
            for beside in -1..=1 {
                for fast in [2_000.0, 6_000.0, 9_700.0] {
                    let start = edge + beside;
                    let mut config = cell(0);
                    let axis = &mut config.axes[usize::from(X)];
                    axis.interface = Interface::Velocity;
                    let p = &mut axis.parameters;
                    assign(p, "max_velocity", Value::Real(20_000.0));
                    assign(p, "max_acceleration", Value::Real(200_000.0));
                    assign(p, "homing.acceleration", Value::Real(50_000.0));
                    assign(p, "homing.velocity", Value::Real(fast));
                    // The steps vary, but never exceed one increment per cycle.
                    assign(p, "homing.index_velocity", Value::Real(500.0));
                    assign(p, "wf.md22", Value::Real(1.0));
                    let index = Some(Index { every: 300, at: 100 });
                    let fixtures = Fixtures {
                        start,
                        index,
                        home: Some(home_switch),
                        negative: Some(-3_000),
                        positive: Some(3_000),
                    };
                    let model = Model::Velocity(VelocityLag::new(0, 1_000_000).unwrap());
                    let mut rig = rig_with(config, model, fixtures);
                    rig.run(20);
                    let sequence = home(&mut rig, method);
                    let what = format!("method {method} from {start} with {fast} inc/s");
                    assert_eq!(run_to_end(&mut rig, sequence).code, Code::NONE, "{what}");
                    assert_eq!((rig.int("x.homed"), zero(&rig, start)), (1, reference), "{what}");
                }
            }
        }
    }
}

/// A simulated switch that is wired to an input with `latch: true`: the zero is its edge at any constant velocity, from
/// either side, with either contact type.
#[test]
fn a_simulated_switch_lets_its_input_latch() {
    for (method, reference) in
        [(17, -3_000), (18, 3_000), (19, L), (20, L), (21, R), (22, R), (24, L), (26, R), (-2, L)]
    {
        for normally_closed in [false, true] {
            for slow in [700.0, 7_000.0, 6_130.0] {
                let mut config = cell(0);
                let p = &mut config.axes[usize::from(X)].parameters;
                // The axis has reached its velocity when it passes the edge.
                assign(p, "homing.acceleration", Value::Real(500_000.0));
                assign(p, "homing.index_velocity", Value::Real(slow));
                let number = Value::Int(if normally_closed { -1 } else { 1 });
                assign(p, "i_refswitch", Value::Int(0));
                let switch = match method {
                    17 => inputs::NEGATIVE_LIMIT,
                    18 => inputs::POSITIVE_LIMIT,
                    _ => inputs::HOME,
                };
                assign(p, ["", "i_neglimitsw", "i_poslimitsw", "", "i_refswitch"][switch as usize], number);
                let fixtures = Fixtures {
                    home: Some(expected(method).0).filter(|_| method > 18).or(Some((L, 9_000))),
                    negative: Some(-3_000),
                    positive: Some(3_000),
                    ..Fixtures::default()
                };
                let wire = Some(SwitchWiring { switch, input: 0, normally_closed });
                let mut rig = rig_with(config, Model::Ideal, fixtures);
                rig.plant
                    .attach_mechanics(0, &Mechanics { fixtures, wires: [wire, None, None], ..Mechanics::default() });
                rig.run(5);
                let sequence = home(&mut rig, method);
                let what = format!("method {method}, {slow} inc/s, normally closed: {normally_closed}");
                assert_eq!(run_to_end(&mut rig, sequence).code, Code::NONE, "{what}");
                assert_eq!((rig.int("x.homed"), zero(&rig, 0)), (1, reference), "{what}");
                assert!(rig.events.iter().any(|event| event.kind == Kind::Latch), "{what}");
            }
        }
    }
}

//! The removal of power from an axis at rest closes its brake first.

use super::super::rig::{LINE, Rig, X, at, cases, couple, to};
use super::brake::vertical_of;
use super::{set, with_io};
use crate::axis::Safety;
use crate::command::{Action, HomeAxis, HomingMethod};
use crate::drive::inputs;
use crate::object::{AxisSet, Leader};
use crate::sim::{Model, SecondOrder};
use proptest::prelude::*;

/// Returns a rig with a hanging load that falls with 9.81 m/s^2; its brake needs 30 ms to close and has 35 ms. Input a
/// is the emergency stop.
fn guarded(model: Model) -> Rig {
    let mut cell = with_io();
    cell.safety = Safety { estop: Some(0), interlock: None };
    let mut rig = vertical_of(cell, 50_000_000, 35_000_000, model);
    rig.plant.set_digital(0, true);
    rig.give(Action::Enable(AxisSet::one(X)));
    rig.run_until("x.state", 1);
    rig
}

fn second_order() -> Model {
    Model::SecondOrder(SecondOrder::new(60.0, 0.8, 1_000_000).unwrap())
}

/// Returns the distance that the axis loses, and the number of cycles until its power is removed, from the cycle in
/// which the brake starts to close.
fn load_loss(rig: &mut Rig) -> (i64, u64) {
    rig.run_until("x.brake", 1);
    assert_eq!((rig.int("r"), rig.int("x.output.control")), (0, 0x0F), "it holds while the brake closes");
    let stopped = rig.int("x.command.position");
    let held = rig.run_until("x.output.control", 0);
    rig.run(300);
    (rig.int("x.actual.position") - stopped, held)
}

/// An emergency stop, at rest and in motion, upwards and downwards.
///
/// Proves: MACS-ERR-02
#[test]
fn a_hanging_load_does_not_sag_in_an_emergency_stop() {
    for model in [Model::Ideal, second_order()] {
        for velocity in [0.0, 50_000.0, -50_000.0] {
            let mut rig = guarded(model);
            if velocity != 0.0 {
                rig.give(Action::Move(at(X, velocity)));
                rig.run(200);
            }
            rig.plant.set_digital(0, false);
            rig.run(1);
            assert_eq!((rig.state("x"), rig.int("x.error")), ("ERROR_STOP", 10_225), "in the same cycle");
            let stopping = rig.run_until("x.brake", 1);
            // 50 mm/s with 1 m/s^2: 50 ms, and the last step of the drive; some more with a drive of 60 Hz.
            let lags = if model == Model::Ideal { 0 } else { 15 };
            assert!(if velocity == 0.0 { stopping == 0 } else { (48..=52 + lags).contains(&stopping) }, "{stopping}");
            assert_eq!(load_loss(&mut rig), (0, 35), "{velocity}");
            rig.plant.set_digital(0, true);
            rig.give(Action::ResetErrors(AxisSet::one(X)));
            rig.run(2);
            assert_eq!((rig.state("x"), rig.int("x.brake"), rig.int("x.output.control")), ("DISABLED", 1, 0));
        }
    }
}

/// A software limit stops at the limit; then error_reaction removes the power after the brake has closed.
#[test]
fn a_hanging_load_does_not_sag_after_a_stop_that_an_error_asked_for() {
    for reaction in [0, 1] {
        let mut rig = guarded(second_order());
        rig.give(set(X, "error_reaction", reaction));
        rig.give(set(X, "max_position", 10_000));
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run_until("x.state", 7);
        assert_eq!((rig.int("x.brake"), rig.int("x.output.control")), (0, 0x0F), "it stops first");
        assert_eq!(load_loss(&mut rig), (0, 35), "{reaction}");
        assert_eq!(rig.int("x.actual.position"), 10_000);
    }
}

/// Commands while the brake closes after an error neither remove the power earlier nor release the axis.
#[test]
fn commands_while_the_brake_closes_after_an_error() {
    let commands = [
        Action::ResetErrors(AxisSet::one(X)),
        Action::Disable(AxisSet::one(X)),
        Action::QuickStop(AxisSet::one(X)),
        Action::Halt(AxisSet::one(X)),
        Action::Abort,
        Action::Deactivate,
        Action::Move(to(X, 1_000)),
        Action::Enable(AxisSet::one(X)),
    ];
    for (place, command) in commands.into_iter().enumerate() {
        let mut rig = guarded(Model::Ideal);
        rig.plant.set_digital(0, false);
        rig.run(10);
        rig.plant.set_digital(0, true);
        rig.run(5);
        assert_eq!((rig.int("x.brake"), rig.int("x.output.control")), (1, 0x0F));
        rig.mirror();
        let sequence = rig.give(command);
        assert_ne!(rig.state("x"), "STANDSTILL", "command {place}");
        // The brake closed in the first of 10 + 5 + 1 cycles.
        assert_eq!(rig.run_until("x.output.control", 0), 20, "command {place}");
        rig.run(300);
        assert_eq!(rig.int("x.actual.position"), 0, "command {place}");
        let state = if place == 0 { "DISABLED" } else { "ERROR_STOP" };
        assert_eq!(rig.state("x"), state, "command {place}");
        if place < 2 {
            assert_eq!((rig.done(sequence).len(), rig.done(sequence)[0].code.0), (1, 0), "command {place}");
        }
    }
}

/// The brake that error_reaction 3 has closed also has its time if the emergency stop follows a moment later.
#[test]
fn a_brake_that_has_just_begun_to_close_has_its_time() {
    for (wait, held) in [(1, 34), (20, 15), (34, 1), (35, 0), (100, 0)] {
        let mut rig = guarded(Model::Ideal);
        rig.give(set(X, "error_reaction", 3));
        rig.plant.drive(0).unwrap().set_stuck_inputs(inputs::POSITIVE_LIMIT, inputs::POSITIVE_LIMIT);
        rig.run_until("x.brake", 1);
        rig.run(wait - 1);
        rig.plant.set_digital(0, false);
        rig.run(1);
        assert_eq!(rig.run_until("x.output.control", 0), held, "{wait}");
        rig.run(100);
        assert_eq!(rig.int("x.actual.position"), 0, "{wait}");
    }
}

/// A drive that stops by itself (error_reaction 4) keeps its power until it is at rest and the brake is closed: neither
/// the emergency stop nor a reset removes it earlier.
#[test]
fn a_drive_that_stops_by_itself_keeps_its_power_until_the_brake_is_closed() {
    for resets in [false, true] {
        let mut rig = guarded(Model::Ideal);
        rig.give(set(X, "error_reaction", 4));
        rig.plant.drive(0).unwrap().set_stuck_inputs(inputs::POSITIVE_LIMIT, inputs::POSITIVE_LIMIT);
        rig.run(1);
        assert_eq!((rig.state("x"), rig.int("x.output.control")), ("ERROR_STOP", 2));
        rig.plant.drive(0).unwrap().set_stuck_inputs(0, 0);
        let sequence = if resets {
            rig.give(Action::ResetErrors(AxisSet::one(X)))
        } else {
            rig.plant.set_digital(0, false);
            rig.run(1);
            0
        };
        rig.run_until("x.brake", 1);
        let held = rig.run_until("x.output.control", 0);
        // The state of the drive counts from the cycle in which it can have received the stop.
        assert!((34..=36).contains(&held), "{held}");
        rig.run(100);
        assert_eq!(rig.int("x.actual.position"), 0);
        assert_eq!(rig.done(sequence).len(), usize::from(resets));
    }
}

/// Applies an event to the axis.
fn apply_event(rig: &mut Rig, what: u8, much: i64) {
    let x = AxisSet::one(X);
    let action = match what {
        0 | 1 => Action::Enable(x),
        2 => Action::Disable(x),
        3 => Action::Halt(x),
        4 => Action::QuickStop(x),
        5 | 6 => Action::ResetErrors(x),
        7 => Action::Abort,
        8 => Action::Move(to(X, much)),
        9 => Action::Move(at(X, much as f64)),
        10 => Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)),
        11 => Action::Move(at(LINE, much as f64)),
        12 => Action::HomeAxis(HomeAxis { axis: X, method: HomingMethod::Cia402(33) }),
        13 => set(X, "error_reaction", 2 + much.rem_euclid(3)),
        14 => set(X, "max_position", much.abs()),
        15 | 16 => {
            rig.plant.set_digital(0, what == 15);
            return;
        }
        _ => {
            let limits = inputs::POSITIVE_LIMIT | inputs::NEGATIVE_LIMIT;
            rig.plant.drive(0).unwrap().set_stuck_inputs(limits, much.rem_euclid(4) as u32 & limits);
            return;
        }
    };
    rig.give(action);
}

proptest! {
    #![proptest_config(cases(150))]

    /// With any events, as long as the drive has no fault and no reaction removes the power of a moving axis: without
    /// power the load does not move by one increment.
    #[test]
    fn without_power_the_load_never_moves(
        steps in prop::collection::vec((0_u8..18, -60_000_i64..60_000, 1_u64..80), 1..60)
    ) {
        let mut rig = guarded(Model::Ideal);
        for (what, much, cycles) in steps {
            apply_event(&mut rig, what, much);
            for _ in 0..cycles {
                let (control, before) = (rig.int("x.output.control"), rig.int("x.actual.count"));
                rig.run(1);
                let moved = rig.int("x.actual.count") - before;
                prop_assert!(control & 0x0F == 0x0F || moved == 0, "{moved} inc with {control:#x}, {}", rig.state("x"));
            }
        }
    }
}

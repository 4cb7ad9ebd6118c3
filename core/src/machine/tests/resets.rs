//! Resets: their wait conditions, errors that return, and events that end them.

use super::rig::{LINE, Rig, X, at, config, saia_verb};
use crate::axis::BrakeConfig;
use crate::code::Code;
use crate::command::Action;
use crate::config::{IoConfig, IoKind, MachineConfig};
use crate::drive::{Interface, inputs};
use crate::event::Kind;
use crate::object::AxisSet;
use crate::parameter::{Change, Row, Value};
use crate::sim::{Mechanics, Model, SimBrake, VelocityLag};
use crate::vocabulary::saia;

const MS: i64 = 1_000_000;

fn x() -> AxisSet {
    AxisSet::one(X)
}

fn reset(rig: &mut Rig) -> u64 {
    rig.give(Action::ResetErrors(x()))
}

fn set(rig: &mut Rig, key: &str, value: i64) {
    let (row, _) = Row::find(key).unwrap();
    rig.give(Action::SetParameters([Change { axis: X, row, value: Value::Int(value) }].into()));
}

fn codes(rig: &Rig, sequence: u64) -> Vec<Code> {
    rig.done(sequence).iter().map(|done| done.code).collect()
}

fn of_reaction(reaction: i64) -> MachineConfig {
    let mut config = config(0);
    config.axes[1].parameters.error_reaction = reaction;
    config
}

/// Returns a rig with x at 50 mm/s, with a motor that takes 50 ms to 37 % of its velocity without drive.
fn coaster(reaction: i64) -> Rig {
    let mut config = of_reaction(reaction);
    config.axes[1].interface = Interface::Velocity;
    config.axes[1].parameters.max_following_error = 50_000;
    let motor = Model::Velocity(VelocityLag::new(50 * MS, 1_000_000).unwrap());
    let mut rig = Rig::with(config, [motor, Model::Ideal]);
    rig.enable();
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(500);
    rig
}

/// Runs until the reset is answered. Returns the number of cycles, and the distance that the motor moves then.
fn wait_for(rig: &mut Rig, sequence: u64) -> (u64, i64) {
    let mut cycles = 0;
    while rig.done(sequence).is_empty() {
        assert!(rig.events.iter().all(|event| event.kind != Kind::Reset), "it is not reset before");
        rig.run(1);
        cycles += 1;
        assert!(cycles < 10_000);
    }
    assert_eq!((codes(rig, sequence), rig.state("x")), (vec![Code::NONE], "DISABLED"));
    let here = rig.int("x.actual.position");
    rig.run(1_000);
    (cycles, (rig.int("x.actual.position") - here).abs())
}

/// 50 mm/s with 50 ms are a distance of 2.5 mm. At rest means at most 2 inc in 5 ms; 3 inc are 600 inc/s. This
/// velocity, with 30 inc remaining, is reached after 50 ms * ln(2500 / 30) = 221 ms.
#[test]
fn a_reset_waits_for_a_motor_that_coasts() {
    for (reaction, fails) in [(0, false), (1, false), (2, true)] {
        let mut rig = coaster(reaction);
        if fails {
            rig.plant.drive(0).unwrap().inject_fault(0x8611);
        } else {
            rig.plant.drive(0).unwrap().jump(-60_000);
        }
        rig.run(1);
        assert_eq!((rig.state("x"), rig.int("x.enabled")), ("ERROR_STOP", 0));
        rig.events.clear();
        let sequence = reset(&mut rig);
        rig.mirror();
        rig.run(10);
        let enable = rig.give(Action::Enable(x()));
        assert!(!rig.refusal(enable).is_empty(), "no power for a motor that turns");
        let (cycles, way) = wait_for(&mut rig, sequence);
        assert!((215..=235).contains(&cycles), "{reaction}: {cycles}");
        assert!(way <= 30, "{reaction}: {way}");
    }
}

/// If the power is removed while the axis stops for an error, the axis coasts: its reset waits for that.
#[test]
fn a_reset_that_waits_goes_on_waiting_where_the_power_goes() {
    use saia::Command::{Initialise, MotorOff};
    for command in [MotorOff, Initialise] {
        let mut rig = coaster(2);
        rig.plant.drive(0).unwrap().jump(-60_000);
        rig.run(1);
        assert_eq!((rig.state("x"), rig.int("x.enabled")), ("ERROR_STOP", 1));
        rig.events.clear();
        let sequence = reset(&mut rig);
        rig.give(saia_verb(&[command]));
        rig.run(1);
        assert_eq!((rig.int("x.output.control"), rig.done(sequence).len()), (0, 0), "{command:?}");
        let (cycles, way) = wait_for(&mut rig, sequence);
        assert!(cycles > 200 && way <= 30, "{command:?}: {cycles}, {way}");
    }
}

/// An encoder that jitters by one count counts as at rest; one that is turned continuously is waited for 5 s, and no
/// longer.
#[test]
fn axis_that_never_comes_to_rest_is_reset_after_timeout() {
    let mut rig = Rig::of(of_reaction(0));
    rig.enable();
    rig.modify_inputs = |inputs| inputs.drive[0].count += (inputs.cycle & 1) as i64;
    rig.plant.drive(0).unwrap().inject_fault(0x8611);
    rig.run(1_000);
    let sequence = reset(&mut rig);
    rig.run(10);
    assert_eq!((rig.state("x"), codes(&rig, sequence)), ("DISABLED", vec![Code::NONE]), "the drive leaves its fault");
    let mut rig = Rig::of(of_reaction(0));
    rig.enable();
    rig.plant.drive(0).unwrap().jump(5_000);
    rig.run(10);
    assert_eq!(rig.int("x.error"), 10_201);
    rig.modify_inputs = |inputs| inputs.drive[0].count += 7 * inputs.cycle as i64;
    rig.run(100);
    let sequence = reset(&mut rig);
    rig.run(4_990);
    assert_eq!(rig.done(sequence).len(), 0);
    rig.run(20);
    assert_eq!((rig.state("x"), codes(&rig, sequence)), ("DISABLED", vec![Code::NONE]));
}

/// A drive without new data in a cycle may still turn: it is checked again.
#[test]
fn reset_waits_for_new_data_of_drive() {
    let mut rig = Rig::of(of_reaction(0));
    rig.enable();
    rig.plant.drive(0).unwrap().jump(5_000);
    rig.run(100);
    assert_eq!((rig.int("x.error"), rig.int("x.enabled")), (10_201, 0));
    rig.modify_inputs = |inputs| inputs.drive[0].fresh = inputs.cycle % 8 == 0;
    rig.run(8 - rig.machine.next_cycle() % 8 + 1);
    let sequence = reset(&mut rig);
    rig.run(6);
    assert_eq!(rig.done(sequence).len(), 0);
    rig.run(1);
    assert_eq!((rig.state("x"), codes(&rig, sequence)), ("DISABLED", vec![Code::NONE]));
}

/// The axis had power when the stop came: a removal of power in the same cycle, before or after it, does not let the
/// reset succeed.
#[test]
fn a_stop_ends_a_reset_though_the_power_goes_in_its_cycle() {
    use saia::Command::{Initialise, MotorOff};
    for (stop, code) in [(Action::QuickStop(x()), Code::QUICK_STOP), (Action::Abort, Code::ABORTED)] {
        for command in [MotorOff, Initialise] {
            for first in [false, true] {
                let mut rig = Rig::of(of_reaction(2));
                rig.enable();
                rig.give(Action::Move(at(X, 50_000.0)));
                rig.run(150);
                rig.plant.drive(0).unwrap().set_stuck_inputs(inputs::POSITIVE_LIMIT, inputs::POSITIVE_LIMIT);
                rig.run(1);
                let sequence = reset(&mut rig);
                rig.run(10);
                rig.mirror();
                let off = saia_verb(&[command]);
                rig.give_all(if first { vec![stop.clone(), off] } else { vec![off, stop.clone()] });
                rig.run(500);
                assert_eq!(
                    (rig.state("x"), rig.int("x.output.control"), codes(&rig, sequence)),
                    ("ERROR_STOP", 0, vec![code]),
                    "{code:?} {command:?} {first}"
                );
                let enable = rig.give(Action::Enable(x()));
                assert!(!rig.refusal(enable).is_empty());
                let again = reset(&mut rig);
                rig.run(5);
                assert_eq!((rig.state("x"), codes(&rig, again)), ("DISABLED", vec![Code::NONE]));
            }
        }
    }
}

/// 6 mm of error with a limit of 1 mm, as long as this is active.
fn push_away(rig: &mut Rig) {
    rig.modify_inputs = |inputs| inputs.drive[0].count -= 6_000;
}

/// An error with a persistent cause returns after each clear, and the reset ends with it.
///
/// Proves: MACS-ERR-04
#[test]
fn a_following_error_that_lasts_comes_back_with_the_reset() {
    for reaction in [2, 3, 5] {
        for (check, time) in [(0, 0), (0, 100), (1, 100)] {
            let mut config = of_reaction(reaction);
            let p = &mut config.axes[1].parameters;
            (p.supervision.following_error_check, p.following_error_time) = (check, time * MS);
            let mut rig = Rig::of(config);
            rig.enable();
            push_away(&mut rig);
            rig.run(500);
            let held = if reaction == 5 { "STANDSTILL" } else { "ERROR_STOP" };
            for _ in 0..2 {
                rig.events.clear();
                let sequence = reset(&mut rig);
                assert_eq!(codes(&rig, sequence), [Code::FOLLOWING_ERROR], "{reaction} {check} {time}");
                let told = rig.events.iter().filter(|event| matches!(event.kind, Kind::Reset | Kind::Error));
                assert_eq!(told.map(|event| event.kind).collect::<Vec<_>>(), [Kind::Reset, Kind::Error]);
                rig.run(5);
                assert_eq!((rig.state("x"), rig.int("x.error"), rig.int("x.enabled")), (held, 10_201, 1));
            }
            rig.modify_inputs = |_| {};
            rig.run(100);
            let sequence = reset(&mut rig);
            rig.run(200);
            let is = (codes(&rig, sequence), rig.state("x"), rig.int("x.error"));
            assert_eq!(is, (vec![Code::NONE], "STANDSTILL", 0), "{reaction} {check} {time}");
        }
    }
}

/// A brake holds the axis away from its command: after the reset the axis starts from its present position, as with
/// enable.
#[test]
fn a_brake_that_holds_a_following_error_opens_with_the_reset() {
    let mut config = of_reaction(3);
    config.io = vec![IoConfig { name: "b".into(), kind: IoKind::DigitalOutput, latch: false }];
    let (release_ns, engage_ns) = (20_000_000, 20_000_000);
    config.axes[1].brake = Some(BrakeConfig { output: 0, closes_with_one: false, release_ns, engage_ns });
    let mut rig = Rig::of(config);
    let brake = SimBrake { output: 0, closes_with_one: false, opens_ns: 10_000_000, closes_ns: 0 };
    rig.plant.attach_mechanics(0, &Mechanics { brake: Some(brake), ..Mechanics::default() });
    rig.give(Action::Enable(x()));
    rig.run(100);
    rig.plant.drive(0).unwrap().jump(-6_000);
    rig.run(100);
    let shown = ["x.error", "x.brake", "x.actual.position", "x.command.position"].map(|signal| rig.int(signal));
    assert_eq!((rig.state("x"), shown), ("ERROR_STOP", [10_201, 1, -6_000, 0]));
    rig.mirror();
    let sequence = reset(&mut rig);
    rig.run(100);
    assert_eq!((rig.state("x"), codes(&rig, sequence)), ("STANDSTILL", vec![Code::NONE]));
    let shown = ["x.error", "x.brake", "x.actual.position", "x.command.position"].map(|signal| rig.int(signal));
    assert_eq!(shown, [0, 0, -6_000, -6_000]);
}

/// Set back from 5, error_reaction applies to new errors, and to errors that persist.
///
/// Proves: MACS-ERR-02
#[test]
fn error_reaction_set_back_from_five_acts() {
    for (reaction, on) in [(0, 0), (2, 1)] {
        for lasts in [false, true] {
            let mut rig = Rig::of(of_reaction(5));
            rig.enable();
            rig.give(Action::Move(at(X, 20_000.0)));
            rig.run(100);
            rig.plant.drive(0).unwrap().jump(-6_000);
            if lasts {
                push_away(&mut rig);
            }
            rig.run(200);
            assert_eq!((rig.state("x"), rig.int("x.error")), ("CONTINUOUS_MOTION", 10_201));
            rig.events.clear();
            set(&mut rig, "error_reaction", reaction);
            if !lasts {
                rig.run(100);
                assert_eq!(rig.state("x"), "CONTINUOUS_MOTION", "what is over stops nothing");
                rig.plant.drive(0).unwrap().jump(-6_000);
                rig.run(1);
            }
            rig.run(1);
            let told = rig.events.iter().filter(|event| event.kind == Kind::Error).map(|event| event.code);
            assert_eq!(told.collect::<Vec<_>>(), [Code::FOLLOWING_ERROR], "{reaction} {lasts}");
            assert_eq!((rig.state("x"), rig.int("x.enabled")), ("ERROR_STOP", on), "{reaction} {lasts}");
            rig.run(100);
            assert_eq!(rig.real("x.command.velocity"), 0.0);
        }
    }
}

/// I_CONTINUE waits for rest like I_ERRCLR; a new stop of the axis ends the wait.
///
/// Proves: MACS-IO-09
#[test]
fn a_continue_waits_for_rest() {
    for (ends, state) in
        [("", "STANDSTILL"), ("quick stop", "STOPPING"), ("break", "STOPPING"), ("error", "ERROR_STOP")]
    {
        let mut config = config(0);
        for name in ["a", "b"] {
            config.io.push(IoConfig { name: name.into(), kind: IoKind::DigitalInput, latch: false });
        }
        (config.global.parameters.i_break, config.global.parameters.i_continue) = (1, 2);
        let mut rig = Rig::of(config);
        rig.enable();
        for axis in [X, LINE] {
            rig.give(Action::Move(at(axis, 50_000.0)));
        }
        rig.run(150);
        rig.plant.set_digital(0, true);
        rig.run(10);
        rig.plant.set_digital(1, true);
        rig.plant.set_digital(0, false);
        rig.run(10);
        assert_eq!((rig.state("x"), rig.state("line")), ("STOPPING", "STOPPING"), "they still stop");
        rig.mirror();
        match ends {
            "quick stop" => _ = rig.give(Action::QuickStop(x())),
            "break" => rig.plant.set_digital(0, true),
            "error" => rig.plant.drive(0).unwrap().jump(-6_000),
            _ => {}
        }
        // 50 mm/s with 1 m/s^2: at rest 50 ms after the edge.
        rig.run(28);
        assert_eq!(rig.state("line"), "STOPPING", "{ends}");
        rig.run(5);
        let line = if ends == "break" { "STOPPING" } else { "STANDSTILL" };
        assert_eq!((rig.state("x"), rig.state("line")), (state, line), "{ends}");
        rig.run(200);
        assert_eq!(rig.state("x"), state, "{ends}");
    }
}

//! Position loop of interface velocity.

mod analog;
mod dual;
mod edges;
mod integer;
mod out_an;
mod pid;
mod runaway;
mod torque;
mod voltage;

use super::rig::{Rig, X, Y, at, config, to};
use crate::code::Code;
use crate::command::Action;
use crate::config::MachineConfig;
use crate::drive::{Backend, Capabilities, Inputs, Interface, Outputs};
use crate::machine::Machine;
use crate::object::AxisSet;
use crate::parameter::{Change, Row, Value};
use crate::sim::{Model, SecondOrder, VelocityLag};

const MS: u64 = 1_000_000;

/// The loop of x is closed in the core, that of y in its drive.
fn velocity_config(delay: u32) -> MachineConfig {
    let mut config = config(delay);
    config.axes[1].interface = Interface::Velocity;
    config.axes[1].parameters.max_following_error = 20_000;
    config
}

fn enabled(delay: u32, model: Model) -> Rig {
    let mut rig = Rig::with(velocity_config(delay), [model, Model::Ideal]);
    rig.enable();
    rig
}

fn lag(ms: i64) -> Model {
    Model::Velocity(VelocityLag::new(ms * 1_000_000, MS).unwrap())
}

/// 6 m/min are 100 mm/s: 6 mm behind at kv 1, 3 mm at kv 2, for any lag of the drive, and by either name of kv.
///
/// Proves: WF-ORA-06, WF-CLC-03, WF-CLC-04, WF-MD-14
#[test]
fn at_constant_speed_the_axis_is_v_by_kv_behind() {
    for model in [Model::Ideal, lag(5), Model::SecondOrder(SecondOrder::new(60.0, 0.8, MS).unwrap())] {
        for (key, kv, behind) in
            [("wf.md22", 1.0, 6_000), ("wf.md22", 2.0, 3_000), ("position_loop.kv", 1000.0 / 30.0, 3_000)]
        {
            let mut rig = enabled(0, model);
            let row = Row::find(key).unwrap().0;
            rig.give(Action::SetParameters(Box::new([Change { axis: X, row, value: Value::Real(kv) }])));
            rig.give(Action::Move(at(X, 99_990.0)));
            rig.run(2_000);
            let error = rig.int("x.regulator.error");
            assert!((error - behind).abs() <= 2, "{model:?}: {error}");
            // Relative to the command of the previous cycle, 100 inc less.
            assert!((rig.int("x.following_error") - (behind - 100)).abs() <= 2);
            assert!((rig.real("x.actual.velocity") - 99_990.0).abs() < 40.0);
            let output = rig.real("x.output.velocity");
            assert_eq!(rig.real("x.regulator.output"), output / 100_000.0);
            assert!((output - 99_990.0).abs() < 40.0, "{output}");
            assert_eq!(rig.int("x.mode_of_operation"), 9);
            assert_eq!(rig.int("y.mode_of_operation"), 8);
        }
    }
}

#[test]
fn a_move_lands_exactly_and_the_loop_is_quiet_then() {
    for (delay, model) in [(0, Model::Ideal), (0, lag(5)), (2, lag(20)), (5, Model::Ideal)] {
        let mut rig = enabled(delay, model);
        let move_ = rig.give(Action::Move(to(X, 50_000)));
        rig.run(2_500);
        assert_eq!(rig.done(move_).len(), 1);
        assert_eq!((rig.int("x.actual.position"), rig.int("x.regulator.error")), (50_000, 0));
        assert_eq!((rig.real("x.output.velocity"), rig.real("x.regulator.output")), (0.0, 0.0));
        assert_eq!(rig.state("x"), "STANDSTILL");
    }
}

/// A slip of 15 mm requires 250 mm/s, and the axis has 100 mm/s.
#[test]
fn the_output_stays_within_max_velocity() {
    let mut rig = enabled(0, Model::Ideal);
    for (by, full) in [(-15_000, 1.0), (15_000, -1.0)] {
        rig.plant.drive(0).unwrap().jump(by);
        rig.run(1);
        assert_eq!((rig.real("x.output.velocity"), rig.real("x.regulator.output")), (full * 100_000.0, full));
        rig.run(1_000);
        assert_eq!(rig.int("x.actual.position"), 0);
        assert_eq!(rig.real("x.output.velocity"), 0.0);
    }
    assert_eq!(rig.int("x.error"), 0);
}

/// The following error is supervised as with any other drive, and reaction 2 stops with the loop closed.
#[test]
fn following_error_stops_with_loop_closed() {
    let mut rig = enabled(0, lag(5));
    rig.plant.drive(0).unwrap().jump(-20_001);
    rig.run(1);
    assert_eq!(rig.int("x.error"), i64::from(Code::FOLLOWING_ERROR.0));
    rig.run(2_000);
    assert_eq!((rig.state("x"), rig.int("x.actual.position")), ("ERROR_STOP", 0));
}

#[test]
fn drive_that_is_off_or_in_fault_gets_zero_commands() {
    let mut rig = enabled(0, lag(5));
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(200);
    rig.plant.drive(0).unwrap().inject_fault(0x8611);
    rig.run(1);
    assert_eq!(
        (rig.state("x"), rig.real("x.output.velocity"), rig.real("x.regulator.output")),
        ("ERROR_STOP", 0.0, 0.0)
    );
    rig.run(200);
    assert_eq!(rig.real("x.actual.velocity"), 0.0);
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    rig.run(50);
    rig.give(Action::Enable(AxisSet::one(X)));
    rig.run(50);
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(200);
    let disable = rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(500);
    assert_eq!((rig.done(disable).len(), rig.state("x")), (1, "DISABLED"));
    assert_eq!((rig.real("x.output.velocity"), rig.real("x.actual.velocity")), (0.0, 0.0));
}

#[test]
fn a_restored_machine_closes_the_same_loop() {
    let mut rig = enabled(1, lag(5));
    rig.give(Action::Move(to(X, 30_000)));
    rig.run(150);
    rig.mirror();
    rig.give(Action::Move(to(X, -3)));
    rig.run(1_500);
    assert_eq!(rig.int("x.actual.position"), -3);
}

/// A backend with one drive.
struct One(usize, Capabilities);

impl Backend for One {
    fn capabilities(&self, drive: usize) -> Option<Capabilities> {
        (drive == self.0).then_some(self.1)
    }

    fn read(&mut self, _: &mut Inputs) {}

    fn write(&mut self, _: &Outputs) {}
}

#[test]
fn a_drive_must_offer_the_interface_of_its_axis() {
    let positions = Capabilities { position: true, ..Capabilities::default() };
    for (interface, name) in [(Interface::Velocity, "velocity"), (Interface::OpenLoop, "open_loop")] {
        let mut config = config(0);
        config.axes[1].interface = interface;
        assert_eq!(config.check(), Ok(()));
        config.axes[1].drive = Some(positions);
        let sentence = format!("drive of x: interface is {name}, which its backend does not offer");
        assert_eq!(Machine::new(config).unwrap_err().to_string(), sentence);
    }
}

#[test]
fn each_drive_has_one_backend_and_that_offers_what_the_cell_says() {
    let config = config(2);
    let all = Capabilities::all;
    let check = |backends: &[&dyn Backend]| config.check_backends(backends).map_err(|error| error.to_string());
    let (x, y) = (One(0, all(2)), One(1, all(0)));
    assert_eq!(check(&[&y, &x]), Ok(()));
    assert_eq!(check(&[&x]), Err("drive of y: no backend serves it".to_owned()));
    assert_eq!(check(&[&x, &y, &y]), Err("drive of y: two backends serve it".to_owned()));
    let sentence = "drive of x: its backend offers something else than the cell was read for";
    assert_eq!(check(&[&One(0, all(1)), &y]), Err(sentence.to_owned()));
}

#[test]
fn a_drive_that_cannot_home_is_not_asked_to_at_the_start_or_later() {
    let mut config = config(0);
    config.axes[1].drive = Some(Capabilities { homes: false, ..Capabilities::all(0) });
    let mut rig = Rig::of(config.clone());
    let row = Row::find("homing.in_drive").unwrap().0;
    let set = |axis, value| Action::SetParameters(Box::new([Change { axis, row, value: Value::Int(value) }]));
    let sequence = rig.give(set(X, 1));
    assert_eq!(rig.refusal(sequence), "x: homing.in_drive may not be true: the drive cannot home by itself");
    let sequence = rig.give(set(X, 0));
    assert!(rig.was_accepted(sequence));
    let sequence = rig.give(set(Y, 1));
    assert!(rig.was_accepted(sequence));
    config.axes[1].parameters.homing.in_drive = true;
    let sentence = "drive of x: homing.in_drive is true, and its backend offers no homing";
    assert_eq!(Machine::new(config).unwrap_err().to_string(), sentence);
}

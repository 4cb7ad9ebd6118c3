//! Backends that fail, drives that use another mode or setpoint than commanded, and messages that drives send by
//! themselves.

use super::rig::{Rig, X, Y, config, to};
use crate::code::Code;
use crate::command::Action;
use crate::config::{IoConfig, IoKind, MachineConfig};
use crate::drive::{
    BackendObject, BusState, DriveState, Edge, Emergency, Inputs, Latch, ObjectAddress, Objects, control,
};
use crate::event::{Event, Kind, Severity};
use crate::object::{AxisSet, Object};
use crate::sim::{Mechanics, Model, Plant, SimBrake};

fn io(name: &str, kind: IoKind) -> IoConfig {
    IoConfig { name: name.into(), kind, latch: kind == IoKind::DigitalInput }
}

/// x, the encoder and the first input and output are on a slow bus, y and the second input and output on a fast one.
fn two_buses() -> Rig {
    use IoKind::{DigitalInput, DigitalOutput};
    let io = vec![io("a", DigitalInput), io("b", DigitalInput), io("c", DigitalOutput), io("d", DigitalOutput)];
    let config = MachineConfig { io, ..config(3) };
    let at = |place| vec![BackendObject { place, address: ObjectAddress::default() }];
    let bus = |place| Objects {
        digital_inputs: at(place),
        digital_outputs: at(place),
        drives: at(place),
        ..Objects::default()
    };
    let buses = vec![Objects { encoders: at(0), ..bus(0) }, bus(1)];
    let plant = Plant::with_buses(&config, &[Some(Model::Ideal); 2], buses);
    let mut rig = Rig::of(config);
    rig.plant = plant;
    rig.plant.set_digital(0, true);
    rig.plant.set_digital(1, true);
    rig
}

fn reported_events(rig: &Rig, code: Code) -> Vec<&Event> {
    rig.events.iter().filter(|event| event.code == code).collect()
}

/// Each drive answers after the delay of its own bus.
#[test]
fn two_buses_of_different_delay_share_a_machine() {
    let mut rig = two_buses();
    rig.enable();
    for axis in [X, Y] {
        rig.give(Action::Move(to(axis, 50_000)));
    }
    for _ in 0..100 {
        let before = (rig.int("x.command.position"), rig.int("y.command.position"));
        rig.run(1);
        assert_eq!(rig.int("y.actual.position"), before.1);
        rig.run(3);
        assert_eq!(rig.int("x.actual.position"), before.0);
    }
    assert_eq!((rig.int("a"), rig.int("b"), rig.int("belt.error")), (1, 1, 0));
}

/// The bus of x is switched off in motion: x has error 89 and no power in that cycle, and no device on that bus reports
/// anything. Devices on the other bus continue.
///
/// Proves: MACS-ERR-01
#[test]
fn bus_off_is_an_error_of_its_own_axes_only() {
    let mut rig = two_buses();
    rig.enable();
    let moves = [X, Y].map(|axis| rig.give(Action::Move(to(axis, 50_000))));
    rig.run(100);
    assert!(rig.plant.switch_off_bus(0));
    assert!(!rig.plant.switch_off_bus(2));
    rig.run(1);
    assert_eq!((rig.state("x"), rig.int("x.error"), rig.int("x.output.control")), ("ERROR_STOP", 89, 0));
    assert_eq!(rig.done(moves[0])[0].code, Code::BUS_ERROR);
    let invalid = i64::from(Code::ENCODER_INVALID.0);
    assert_eq!((rig.int("a"), rig.int("b"), rig.int("belt.error")), (0, 1, invalid));
    assert_eq!((rig.state("y"), rig.int("y.error")), ("DISCRETE_MOTION", 0));
    let latch = |place| Latch { object: Object::Io(place), edge: Edge::Rising, age_ns: Some(0), position: None };
    assert!(!rig.plant.add_latch(latch(0)) && rig.plant.add_latch(latch(1)));
    rig.run(2_000);
    assert_eq!((rig.int("y.actual.position"), rig.done(moves[1])[0].code), (50_000, Code::NONE));
    // The drive has no voltage, as if its own supervision had detected the loss of communication.
    let place = rig.int("x.actual.position");
    rig.run(100);
    assert_eq!(rig.int("x.actual.position"), place);
    // While the bus stays off the reset fails; y needs no reset.
    let reset = rig.give(Action::ResetErrors(AxisSet::one(X)));
    rig.run(5_100);
    assert_eq!((rig.done(reset)[0].code, rig.int("x.error")), (Code::RESET_FAILED, 89));
    assert_eq!(reported_events(&rig, Code::BUS_ERROR).iter().filter(|event| event.kind == Kind::Error).count(), 1);
}

/// The output that opens the brake of y is on the bus that is switched off: without voltage the brake closes.
#[test]
fn outputs_of_a_bus_that_is_off_have_no_voltage() {
    let mut rig = two_buses();
    let brake = SimBrake { output: 0, closes_with_one: false, opens_ns: 0, closes_ns: 0 };
    rig.plant.attach_mechanics(1, &Mechanics { brake: Some(brake), ..Mechanics::default() });
    rig.give(Action::set_output(2, 1.0));
    rig.enable();
    rig.give(Action::Move(to(Y, 50_000)));
    rig.run(100);
    let before = rig.int("y.actual.position");
    rig.run(1);
    assert_ne!(rig.int("y.actual.position"), before);
    rig.plant.switch_off_bus(0);
    rig.run(2);
    let place = rig.int("y.actual.position");
    rig.run(5);
    assert_eq!(rig.int("y.actual.position"), place);
}

/// A bus in error passive state still transmits.
#[test]
fn a_bus_with_many_errors_stops_nothing() {
    let mut rig = Rig::enabled();
    let sequence = rig.give(Action::Move(to(X, 10_000)));
    rig.run(50);
    rig.modify_inputs = |inputs| inputs.drive[0].bus = BusState::Degraded;
    rig.run(1_000);
    assert_eq!((rig.done(sequence)[0].code, rig.int("x.error")), (Code::NONE, 0));
}

/// Operation enabled in another mode does not count as switched on: the drive would interpret a position as another
/// quantity.
#[test]
fn power_is_on_once_the_drive_shows_the_mode_that_was_asked_for() {
    let mut rig = Rig::new();
    rig.modify_inputs = |inputs| inputs.drive[0].mode = 3;
    let sequence = rig.give(Action::Enable(AxisSet::one(X)));
    rig.run(1_000);
    assert_eq!((rig.int("x.enabled"), rig.done(sequence).len(), rig.state("x")), (0, 0, "DISABLED"));
    rig.modify_inputs = |_| {};
    rig.run(2);
    assert_eq!((rig.int("x.enabled"), rig.done(sequence)[0].code, rig.state("x")), (1, Code::NONE, "STANDSTILL"));
    let mut rig = Rig::new();
    rig.modify_inputs = |inputs| inputs.drive[0].mode = 3;
    let sequence = rig.give(Action::Enable(AxisSet::one(X)));
    rig.run(5_010);
    assert_eq!((rig.done(sequence)[0].code, rig.int("x.enabled")), (Code::ENABLE_TIMEOUT, 0));
    let needed = "6061h shows mode 3, mode 8 is needed";
    assert_eq!(
        not_enabled(&rig),
        format!("x: the drive is in operation enabled, but in another mode after 5000 ms: {needed}")
    );
}

/// Returns the message of the first error that a drive was not enabled in time.
fn not_enabled(rig: &Rig) -> String {
    let is_error = |event: &&Event| event.kind == Kind::Error && event.code == Code::ENABLE_TIMEOUT;
    let error = rig.events.iter().find(is_error).expect("it is an error");
    crate::text::message(error, rig.machine.config())
}

/// A drive without supply stays in switch on disabled. Its mode is also reported if it differs.
#[test]
fn enable_timeout_reports_state_and_mode_of_drive() {
    let late = "the drive is not in operation enabled after 5000 ms: 6041h shows switch on disabled";
    let said = |tamper: fn(&mut Inputs)| {
        let mut rig = Rig::new();
        rig.modify_inputs = tamper;
        rig.give(Action::Enable(AxisSet::one(X)));
        rig.run(5_010);
        not_enabled(&rig)
    };
    assert_eq!(said(|inputs| inputs.drive[0].status = DriveState::SwitchOnDisabled.status()), format!("x: {late}"));
    let both = said(|inputs| {
        (inputs.drive[0].status, inputs.drive[0].mode) = (DriveState::SwitchOnDisabled.status(), 0);
    });
    assert_eq!(both, format!("x: {late}; 6061h shows mode 0, mode 8 is needed"));
}

/// In mode pp (1) the axis sees 8 for 1, and 1 for 8: the message contains the numbers of the drive.
#[test]
fn mode_is_reported_with_numbers_of_drive() {
    let mut config = config(0);
    config.axes[usize::from(X)].drive_mode = Some(1);
    let mut rig = Rig::of(config);
    rig.modify_inputs = |inputs| inputs.drive[0].mode = 1;
    rig.give(Action::Enable(AxisSet::one(X)));
    rig.run(5_010);
    assert!(not_enabled(&rig).ends_with(" after 5000 ms: 6061h shows mode 8, mode 1 is needed"));
}

/// The drive stays at an old setpoint, independent of the commands of the axis: power is removed.
#[test]
fn unacknowledged_setpoint_removes_power() {
    for moves in [false, true] {
        let mut rig = Rig::enabled();
        if moves {
            rig.give(Action::Move(to(X, 50_000)));
        }
        rig.run(20);
        rig.modify_inputs = |inputs| inputs.drive[0].unacknowledged = true;
        rig.run(1);
        let errors = reported_events(&rig, Code::SETPOINT_NOT_ACKNOWLEDGED);
        assert!(errors.iter().any(|event| event.kind == Kind::Error), "{moves}");
        assert_eq!((rig.state("x"), rig.outputs().drive[0].control), ("ERROR_STOP", control::DISABLE_VOLTAGE));
        // Without power no setpoint is handed over.
        rig.modify_inputs = |_| {};
        rig.run(300);
        let sequence = rig.give(Action::ResetErrors(AxisSet::one(X)));
        rig.run(10);
        assert_eq!((rig.done(sequence)[0].code, rig.state("x")), (Code::NONE, "DISABLED"));
    }
}

/// 200 cycles of 1 ms, and 10 s.
#[test]
fn a_drive_has_the_time_of_its_cell_to_be_enabled() {
    for (timeout_ns, cycles) in [(200_000_000, 200), (10_000_000_000, 10_000)] {
        let mut config = config(0);
        config.axes[usize::from(X)].enable_timeout_ns = timeout_ns;
        let mut rig = Rig::of(config);
        rig.modify_inputs = |inputs| inputs.drive[0].mode = 0;
        let sequence = rig.give(Action::Enable(AxisSet::one(X)));
        rig.run(cycles);
        assert_eq!(rig.done(sequence).len(), 0, "{timeout_ns}");
        rig.run(5);
        assert_eq!(rig.done(sequence)[0].code, Code::ENABLE_TIMEOUT, "{timeout_ns}");
    }
}

/// In every cycle, at rest and in motion: the same message is reported once a second, a different one at once.
#[test]
fn emergency_message_is_reported_with_all_bytes_and_rate_limited() {
    let mut rig = Rig::enabled();
    rig.modify_inputs = |inputs| {
        inputs.drive[0].emergency = Some(Emergency { code: 0x8130, register: 0x11, data: [0xDE, 0xAD, 0, 0xBE, 0xEF] });
    };
    let sequence = rig.give(Action::Move(to(X, 50_000)));
    rig.run(2_500);
    assert_eq!((rig.done(sequence)[0].code, rig.int("x.error")), (Code::NONE, 0));
    let events = reported_events(&rig, Code::EMERGENCY);
    assert_eq!(events.len(), 3);
    assert!(events.iter().all(|event| (event.severity, event.kind) == (Severity::Warn, Kind::Warning)));
    let sentence = crate::text::message(events[0], rig.machine.config());
    assert_eq!(
        sentence,
        "x: the drive sends emergency 8130h (life guard or heartbeat), register 11h (generic, communication), data DE AD 00 BE EF"
    );
    rig.modify_inputs = |inputs| inputs.drive[0].emergency = Some(Emergency { code: 0, register: 0, data: [0; 5] });
    rig.run(1);
    let events = reported_events(&rig, Code::EMERGENCY);
    assert_eq!((events.len(), events[3].severity), (4, Severity::Info), "an error that is over");
}

/// Of nine errors within a second eight are reported. Their end is still reported, once.
#[test]
fn end_of_emergency_is_reported_once_despite_rate_limit() {
    let mut rig = Rig::enabled();
    rig.modify_inputs = |inputs| {
        let code = 0x8100 + (inputs.cycle % 9) as u16;
        inputs.drive[0].emergency = Some(Emergency { code, register: 1, data: [0; 5] });
    };
    rig.run(20);
    assert_eq!(reported_events(&rig, Code::EMERGENCY).len(), 8);
    rig.modify_inputs = |inputs| inputs.drive[0].emergency = Some(Emergency { code: 0, register: 0, data: [0; 5] });
    rig.run(20);
    let events = reported_events(&rig, Code::EMERGENCY);
    assert_eq!((events.len(), events[8].severity), (9, Severity::Info));
}

/// A drive that sends another message in each cycle: eight of them are reported per second, in the three seconds
/// covered here.
#[test]
fn emergency_messages_of_many_kinds_are_rate_limited() {
    let mut rig = Rig::enabled();
    rig.modify_inputs = |inputs| {
        let code = 0x8100 + (inputs.cycle % 3) as u16;
        inputs.drive[0].emergency = Some(Emergency { code, register: 1, data: [0; 5] });
    };
    rig.run(2_900);
    assert_eq!(reported_events(&rig, Code::EMERGENCY).len(), 24);
}

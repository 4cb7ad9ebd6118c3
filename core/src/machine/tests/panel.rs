//! Inputs and outputs with a function, brakes, parameters of the machine.

mod abort;
mod brake;
mod brake_first;
mod brake_meets;
mod functions;
mod one_cycle;
mod virtual_inputs;

use super::rig::{LINE, Rig, X, Y, at, config, to};
use crate::axis::BrakeConfig;
use crate::command::{Action, OutputValue};
use crate::config::{FilterConfig, FullScale, IoConfig, IoKind, MachineConfig};
use crate::event::Kind;
use crate::object::AxisSet;
use crate::parameter::{Change, Layer, MACHINE, Row, Value};
use crate::sim::{Mechanics, Model};

/// Digital inputs a, b, c (1 to 3), outputs p, q, r (1 to 3), analog input level, analog output speed.
fn with_io() -> MachineConfig {
    let io = |name: &str, kind| IoConfig { name: name.into(), kind, latch: false };
    let mut config = config(0);
    config.io = vec![
        io("a", IoKind::DigitalInput),
        io("p", IoKind::DigitalOutput),
        io("b", IoKind::DigitalInput),
        io("q", IoKind::DigitalOutput),
        io("c", IoKind::DigitalInput),
        io("r", IoKind::DigitalOutput),
        io("level", IoKind::AnalogInput),
        io("speed", IoKind::AnalogOutput),
    ];
    config
}

/// Indices in section `io`.
const P: u16 = 1;
const Q: u16 = 3;
const R: u16 = 5;

fn set(axis: u16, key: &str, value: i64) -> Action {
    let (row, _) = Row::find(key).unwrap();
    Action::SetParameters([Change { axis, row, value: Value::Int(value) }].into())
}

fn ready(config: MachineConfig) -> Rig {
    let mut rig = Rig::of(config);
    rig.enable();
    rig
}

/// O_ERROR, with both signs: high or low during an error; I_ERRCLR clears with its edge, like ERRCLR.
///
/// Proves: MACS-IO-01, MACS-IO-07, MACS-IO-10, MACS-ERR-04
#[test]
fn an_error_shows_and_an_edge_clears_it() {
    for (output, input, shown) in [(1, 2, 1), (-1, -2, 0)] {
        let mut cell = with_io();
        (cell.global.parameters.o_error, cell.global.parameters.i_errclr) = (output, input);
        let mut rig = Rig::of(cell);
        let idle = input < 0;
        rig.plant.set_digital(1, idle);
        rig.enable();
        rig.mirror();
        assert_eq!(rig.int("p"), 1 - shown, "no error yet");
        rig.plant.drive(0).unwrap().inject_fault(0x8611);
        rig.run(3);
        assert_eq!((rig.int("p"), rig.state("x")), (shown, "ERROR_STOP"));
        assert_eq!(rig.outputs().digital(0), shown == 1);
        // The wrong edge has no effect: the input already had the level before.
        rig.run(50);
        assert_eq!(rig.state("x"), "ERROR_STOP");
        rig.plant.set_digital(1, !idle);
        rig.run(10);
        assert_eq!((rig.int("p"), rig.state("x")), (1 - shown, "DISABLED"), "{output} {input}");
        // The level alone clears nothing: the next error remains.
        rig.plant.drive(0).unwrap().inject_fault(0x8611);
        rig.give(Action::Enable(AxisSet::first(3)));
        rig.run(50);
        assert_eq!((rig.int("p"), rig.state("x")), (shown, "ERROR_STOP"), "{output} {input}");
        rig.plant.set_digital(1, idle);
        rig.run(50);
        assert_eq!(rig.state("x"), "ERROR_STOP", "the other edge");
    }
}

/// An error with a persistent cause returns: the drive is missing.
///
/// Proves: MACS-IO-10
#[test]
fn edge_cannot_clear_persistent_error() {
    let mut cell = with_io();
    cell.global.parameters.i_errclr = 1;
    let mut rig = ready(cell);
    rig.plant.drive(0).unwrap().disconnect();
    rig.run(5);
    rig.plant.set_digital(0, true);
    rig.run(7_000);
    assert_eq!((rig.state("x"), rig.int("x.error")), ("ERROR_STOP", 88));
    assert_eq!(rig.state("y"), "STANDSTILL", "nothing was wrong with it");
}

/// The output shows the command, not the motor: it is on while the axis has a motion command.
///
/// Proves: MACS-IO-06
#[test]
fn a_motion_command_shows() {
    for (output, on) in [(2, 1), (-2, 0)] {
        let mut cell = with_io();
        cell.axes[1].parameters.outputs.axmove = output;
        let mut rig = ready(cell);
        assert_eq!(rig.int("q"), 1 - on);
        rig.give(Action::Move(to(X, 5_000)));
        assert_eq!((rig.int("q"), rig.real("x.actual.velocity")), (on, 0.0), "commanded, and not yet moving");
        rig.run_until("x.state", 1);
        assert_eq!(rig.int("q"), 1 - on);
        rig.give(Action::Move(at(X, 1_000.0)));
        rig.run(500);
        assert_eq!(rig.int("q"), on);
        rig.give(Action::Halt(AxisSet::first(3)));
        rig.run(500);
        assert_eq!(rig.int("q"), 1 - on);
        // Motion of another axis is not shown.
        rig.give(Action::Move(to(Y, 5_000)));
        assert_eq!(rig.int("q"), 1 - on);
    }
}

/// An error closes the brake with ERRCOND 1 and 3 only; ERRCLR does not open it, OUT does.
///
/// Proves: MACS-IO-03, MACS-IO-04, MACS-IO-05
#[test]
fn only_a_program_opens_the_brake() {
    for (output, closed) in [(3, 1), (-3, 0)] {
        for (reaction, closes) in [(0, false), (1, true), (2, false), (3, true), (4, false)] {
            let mut cell = with_io();
            cell.axes[1].parameters.outputs.brake = output;
            cell.axes[1].parameters.error_reaction = reaction;
            let mut rig = Rig::of(cell);
            rig.give(Action::set_output(R, f64::from(1 - closed as u8)));
            rig.enable();
            assert_eq!((rig.int("r"), rig.int("x.brake")), (i64::from(1 - closed), 0), "enable leaves it alone");
            rig.plant.drive(0).unwrap().jump(500_000);
            rig.run(2_000);
            assert_eq!(rig.state("x"), "ERROR_STOP");
            let expected = i64::from(if closes { closed } else { 1 - closed });
            assert_eq!((rig.int("r"), rig.int("x.brake")), (expected, i64::from(closes)), "{output} {reaction}");
            rig.give(Action::ResetErrors(AxisSet::first(3)));
            rig.run(50);
            assert_eq!((rig.int("x.error"), rig.int("r")), (0, expected), "never by itself");
            rig.give(Action::set_output(R, f64::from(1 - closed as u8)));
            assert_eq!((rig.int("r"), rig.int("x.brake")), (i64::from(1 - closed), 0));
        }
    }
}

/// I_BREAK ends all motion and locks the axes; I_CONTINUE allows goals again, and so does reset_errors.
///
/// Proves: MACS-IO-08, MACS-IO-09
#[test]
fn a_break_stops_all_until_continue() {
    let mut cell = with_io();
    (cell.global.parameters.i_break, cell.global.parameters.i_continue) = (1, -2);
    let mut rig = Rig::of(cell);
    rig.plant.set_digital(1, true);
    rig.enable();
    let goal = rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(1_000);
    rig.give(Action::Move(at(LINE, 20_000.0)));
    rig.run(200);
    rig.mirror();
    rig.plant.set_digital(0, true);
    rig.run(1);
    assert_eq!((rig.state("x"), rig.state("line"), rig.state("y")), ("STOPPING", "STOPPING", "STOPPING"));
    let ended = rig.done(goal);
    assert_eq!((ended.len(), ended[0].code.0), (1, 10_341));
    // 50 mm/s with 1 m/s^2: at most 50 ms.
    rig.run(51);
    assert_eq!(rig.real("x.command.velocity"), 0.0);
    let refused = rig.give(Action::Move(to(X, 0)));
    assert_eq!(rig.refusal(refused), "x: i_break has stopped the axis; i_continue or reset_errors lets it go on");
    rig.plant.set_digital(0, false);
    rig.run(50);
    assert_eq!(rig.state("x"), "STOPPING", "letting go is no continue");
    rig.plant.set_digital(1, false);
    rig.run(2);
    assert_eq!((rig.state("x"), rig.state("line")), ("STANDSTILL", "STANDSTILL"));
    let again = rig.give(Action::Move(to(X, 0)));
    assert!(rig.was_accepted(again));
    // A quick stop is not released by I_CONTINUE.
    rig.give(Action::QuickStop(AxisSet::first(3)));
    rig.run(500);
    rig.plant.set_digital(1, true);
    rig.run(2);
    rig.plant.set_digital(1, false);
    rig.run(2);
    assert_eq!(rig.state("x"), "STOPPING");
    // A quick stop after a break is not released, either.
    rig.give(Action::ResetErrors(AxisSet::first(3)));
    rig.run(5);
    rig.plant.set_digital(0, true);
    rig.run(5);
    rig.give(Action::QuickStop(AxisSet::first(3)));
    rig.plant.set_digital(1, true);
    rig.run(2);
    rig.plant.set_digital(1, false);
    rig.run(2);
    assert_eq!(rig.state("x"), "STOPPING");
    rig.plant.set_digital(0, false);
    // reset_errors ends a break, too.
    rig.give(Action::ResetErrors(AxisSet::first(3)));
    rig.run(5);
    rig.plant.set_digital(0, true);
    rig.run(5);
    assert_eq!(rig.state("x"), "STOPPING");
    rig.give(Action::ResetErrors(AxisSet::first(3)));
    rig.run(5);
    assert_eq!(rig.state("x"), "STANDSTILL");
}

/// The selector has no reference from the cycle of the edge on, as after a quick stop: the next cycle refuses every
/// selection, including the previous one.
///
/// Proves: MACS-IO-08
#[test]
fn break_clears_selector_reference_in_its_cycle() {
    let mut cell = with_io();
    cell.global.parameters.i_break = 1;
    let mut rig = ready(cell);
    for axis in [LINE, X] {
        let selected = rig.give(set(axis, "amc.reference_select", 2));
        assert!(rig.was_accepted(selected));
    }
    rig.run(10);
    rig.plant.set_digital(0, true);
    rig.run(1);
    for axis in [LINE, X] {
        let name = if axis == X { "x" } else { "line" };
        assert_eq!((rig.state(name), rig.int(&format!("{name}.amc.select"))), ("STOPPING", 0));
        assert_eq!(rig.machine.parameters(axis).unwrap().vocabularies.amc.reference_select, 0, "{name}");
    }
    let x = rig.give_all(vec![set(LINE, "amc.reference_select", 2), set(X, "amc.reference_select", 2)]);
    let why = "i_break has stopped the axis; i_continue or reset_errors lets it go on";
    assert_eq!((rig.refusal(x - 1), rig.refusal(x)), (format!("line: {why}"), format!("x: {why}")));
}

/// A quick stop keeps its lock: I_CONTINUE cannot release a break after a quick stop.
///
/// Proves: MACS-IO-08, MACS-IO-09
#[test]
fn a_break_on_a_quick_stop_unlocks_nothing() {
    let mut cell = with_io();
    (cell.global.parameters.i_break, cell.global.parameters.i_continue) = (1, 2);
    let mut rig = ready(cell);
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(200);
    rig.give(Action::QuickStop(AxisSet::one(X)));
    rig.plant.set_digital(0, true);
    rig.run(100);
    rig.plant.set_digital(1, true);
    rig.run(5);
    assert_eq!((rig.state("x"), rig.state("y")), ("STOPPING", "STANDSTILL"));
    let refused = rig.give(Action::Move(to(X, 0)));
    assert_eq!(rig.refusal(refused), "x: quick_stop has locked the axis; reset_errors first");
}

/// A level that exists when the machine starts, or when a parameter selects the input, is not an edge.
///
/// Proves: MACS-IO-01
#[test]
fn a_level_is_no_edge() {
    let mut cell = with_io();
    cell.global.parameters.i_break = 1;
    let mut rig = Rig::of(cell);
    rig.plant.set_digital(0, true);
    rig.plant.set_digital(1, true);
    rig.enable();
    rig.run(5);
    assert_eq!(rig.state("x"), "STANDSTILL");
    rig.give(set(MACHINE, "i_break", 2));
    rig.run(5);
    assert_eq!(rig.state("x"), "STANDSTILL");
    rig.plant.set_digital(1, false);
    rig.run(2);
    rig.plant.set_digital(1, true);
    rig.run(2);
    assert_eq!(rig.state("x"), "STOPPING");
}

/// filt += (reading - filt) / n every ms, in cycles of any length; with 0 the reading is unmodified. The second input
/// is never smoothed.
///
/// Proves: MACS-IO-14
#[test]
fn analog_input_1_is_smoothed() {
    for cycle_ns in [125_000, 1_000_000, 4_000_000_u64] {
        let mut cell = with_io();
        cell.cycle_ns = cycle_ns;
        cell.io.push(IoConfig { name: "other".into(), kind: IoKind::AnalogInput, latch: false });
        cell.global.parameters.ainftime = 10;
        let mut rig = Rig::of(cell);
        rig.plant.set_analog(0, 2.0);
        rig.run(3);
        assert_eq!(rig.real("level"), 2.0, "it begins at the first reading");
        rig.mirror();
        rig.plant.set_analog(0, 10.0);
        rig.plant.set_analog(1, 10.0);
        // Up to a whole number of ms, including any previous fraction.
        let cycles = 20_000_000 / cycle_ns;
        rig.run(cycles);
        let after = |readings: usize| 10.0 - (0..readings).fold(8.0, |left, _| left * 0.9);
        let level = rig.real("level");
        assert!((level - after(20)).abs() < 1e-9, "{cycle_ns}: {level}, not {}", after(20));
        assert_eq!(rig.real("other"), 10.0);
        // A value applies in the cycle in which it is set: half of the remaining difference, and then all of it.
        if cycle_ns == 1_000_000 {
            rig.give(set(MACHINE, "ainftime", 2));
            let level = rig.real("level");
            assert!((level - (after(20) + 10.0) / 2.0).abs() < 1e-9, "{level}");
        }
        rig.give(set(MACHINE, "ainftime", 0));
        assert_eq!(rig.real("level"), 10.0);
    }
}

/// A filtered input takes a level that was stable for the filter time, to the cycle; shorter pulses are ignored.
#[test]
fn a_filter_keeps_short_pulses_out() {
    let mut cell = with_io();
    cell.global.filters = vec![FilterConfig { input: 1, time_ns: 5_000_000 }];
    cell.axes[1].parameters.assigned.refswitch = 2;
    let mut rig = Rig::of(cell);
    rig.run(3);
    rig.mirror();
    for length in 1..=5 {
        rig.plant.set_digital(1, true);
        rig.run(length);
        assert_eq!((rig.int("b"), rig.int("x.reference_switch")), (0, 0), "{length}");
        rig.plant.set_digital(1, false);
        rig.run(3);
        assert_eq!(rig.int("b"), 0, "{length}");
    }
    rig.plant.set_digital(1, true);
    rig.plant.set_digital(0, true);
    rig.run(5);
    assert_eq!((rig.int("a"), rig.int("b")), (1, 0), "the other one has no filter");
    rig.run(1);
    assert_eq!((rig.int("b"), rig.int("x.reference_switch")), (1, 1));
    rig.plant.set_digital(1, false);
    rig.run(5);
    assert_eq!(rig.int("b"), 1);
    rig.run(1);
    assert_eq!(rig.int("b"), 0);
}

/// OUT and OUTAN set every output except those that an axis switches itself, and nothing else.
///
/// Proves: MACS-IO-03
#[test]
fn outputs_are_set_and_stay() {
    let mut cell = with_io();
    cell.axes[1].brake = Some(BrakeConfig { output: R, closes_with_one: false, release_ns: 0, engage_ns: 0 });
    cell.global.parameters.o_error = 1;
    let mut rig = Rig::of(cell);
    rig.run(1);
    rig.mirror();
    let given = [(Q, 1.0), (7, -2.5), (P, 1.0)].map(|(index, value)| Action::set_output(index, value));
    rig.give_all(given.to_vec());
    rig.run(20);
    assert_eq!((rig.int("q"), rig.real("speed"), rig.int("p")), (1, -2.5, 1), "one with a function, too");
    assert_eq!((rig.outputs().digital(1), rig.outputs().analog[0]), (true, -2.5));
    for (index, value, sentence) in [
        (Q, 2.0, "q: 2 is no value of this output; 0 and 1 of a do, -10 V to 10 V of an ao are"),
        (7, f64::INFINITY, "speed: inf is no value of this output; 0 and 1 of a do, -10 V to 10 V of an ao are"),
        (7, 12.0, "speed: 12 is no value of this output; 0 and 1 of a do, -10 V to 10 V of an ao are"),
        (7, -10.001, "speed: -10.001 is no value of this output; 0 and 1 of a do, -10 V to 10 V of an ao are"),
        (0, 1.0, "a: this is no output; a do or an ao may be set"),
        (6, 1.0, "level: this is no output; a do or an ao may be set"),
        (R, 1.0, "r: 1 may not be set, nor any value: x switches this output by itself"),
    ] {
        let sequence = rig.give(Action::set_output(index, value));
        assert_eq!(rig.refusal(sequence), sentence);
    }
    // All of them, or none.
    let pair = |index, value| [OutputValue { index: Q, value: 0.0 }, OutputValue { index, value }].into();
    let mixed = rig.give(Action::SetOutputs(pair(7, f64::NAN)));
    assert_eq!(
        rig.refusal(mixed),
        "speed: NaN is no value of this output; 0 and 1 of a do, -10 V to 10 V of an ao are"
    );
    assert_eq!((rig.int("q"), rig.real("speed")), (1, -2.5));
    let both = rig.give(Action::SetOutputs(pair(7, 1.5)));
    assert!(rig.was_accepted(both));
    assert_eq!((rig.int("q"), rig.real("speed")), (0, 1.5));
    rig.give(Action::SetOutputs(pair(7, -2.5)));
    rig.give(Action::set_output(Q, 1.0));
    let missing = rig.give(Action::set_output(99, 1.0));
    assert!(rig.refusal(missing).ends_with("this is no output; a do or an ao may be set"));
    assert_eq!((rig.int("q"), rig.real("speed")), (1, -2.5));
}

/// The full scale of an analog output on CAN may be below or above 10 V.
#[test]
fn an_analog_output_takes_its_full_scale_and_no_more() {
    let mut config = with_io();
    config.global.full_scales = vec![FullScale { entry: 7, volts: 24.0 }];
    let mut rig = ready(config);
    let most = rig.give(Action::set_output(7, -24.0));
    assert!(rig.was_accepted(most));
    let beyond = rig.give(Action::set_output(7, 24.5));
    let sentence = "speed: 24.5 is no value of this output; 0 and 1 of a do, -24 V to 24 V of an ao are";
    assert_eq!(rig.refusal(beyond), sentence);
    assert_eq!(rig.real("speed"), -24.0);
}

/// Numbers of inputs and outputs that the cell does not have are refused, when the machine is created and at run time.
///
/// Proves: MACS-IO-01
#[test]
fn numbers_of_inputs_and_outputs_must_be_there() {
    for (key, axis, count, what) in [
        ("i_refswitch", X, 3, "inputs"),
        ("i_poslimitsw", X, 3, "inputs"),
        ("i_neglimitsw", X, 3, "inputs"),
        ("o_brake", X, 3, "outputs"),
        ("o_axmove", X, 3, "outputs"),
        ("i_break", MACHINE, 3, "inputs"),
        ("i_continue", MACHINE, 3, "inputs"),
        ("i_errclr", MACHINE, 3, "inputs"),
        ("o_error", MACHINE, 3, "outputs"),
    ] {
        let mut rig = Rig::of(with_io());
        let object = if axis == MACHINE { "machine" } else { "x" };
        for number in [count, -count] {
            let sequence = rig.give(set(axis, key, number));
            assert!(rig.was_accepted(sequence), "{key} {number}");
        }
        for number in [count + 1, -(count + 1)] {
            let sequence = rig.give(set(axis, key, number));
            let expected = format!("{object}: {key} is {number}; the cell has {count} digital {what}");
            assert_eq!(rig.refusal(sequence), expected);
        }
        let mut cell = with_io();
        let (_, row) = Row::find(key).unwrap();
        if axis == MACHINE {
            row.assign_to_machine(&mut cell.global.parameters, Value::Int(-4)).unwrap();
        } else {
            row.assign(&mut cell.axes[1].parameters, Value::Int(-4)).unwrap();
        }
        let error = crate::machine::Machine::new(cell).unwrap_err().to_string();
        assert_eq!(error, format!("{object}: {key} is -4; the cell has 3 digital {what}"));
    }
}

/// Parameters of the machine have layers like those of axes: set, saved with all axes, restored, deleted; a power cycle
/// restores the saved values and switches the outputs off.
///
/// Proves: MACS-STO-02, MACS-STO-04, MACS-STO-05
#[test]
fn parameters_of_the_machine_have_layers() {
    let mut cell = with_io();
    cell.global.parameters.o_error = 1;
    let mut rig = Rig::of(cell);
    let error = |rig: &Rig| rig.machine.parameter_image().machine.map(|machine| machine.o_error);
    assert_eq!(error(&rig), [1, 1]);
    rig.give(set(MACHINE, "o_error", 2));
    assert_eq!(error(&rig), [2, 1]);
    let told = rig.events.iter().filter(|event| event.kind == Kind::Parameter).count();
    assert_eq!(told, 1);
    rig.give(Action::SaveParameters([X].into_iter().collect()));
    assert_eq!(error(&rig), [2, 1], "one axis alone is not all");
    rig.give(Action::SaveParameters(AxisSet::first(3)));
    assert_eq!(error(&rig), [2, 2]);
    rig.give(set(MACHINE, "o_error", -3));
    rig.give(Action::ResetParameters { axes: AxisSet::first(3), layer: Layer::User });
    assert_eq!(error(&rig), [2, 2]);
    rig.give(Action::set_output(P, 1.0));
    rig.give(set(MACHINE, "o_error", 0));
    rig.give(Action::PowerCycle);
    rig.run(2);
    assert_eq!((error(&rig), rig.int("p")), ([2, 2], 0));
    rig.mirror();
    rig.give(Action::DeleteParameters(AxisSet::first(3)));
    assert_eq!(error(&rig), [1, 1]);
    let (row, _) = Row::find("o_error").unwrap();
    let twice = [1, 2].map(|value| Change { axis: MACHINE, row, value: Value::Int(value) });
    let sequence = rig.give(Action::SetParameters(twice.into()));
    assert!(rig.refusal(sequence).starts_with("machine: o_error"), "{}", rig.refusal(sequence));
    assert_eq!(error(&rig), [1, 1]);
}

/// A drive without a sign in its reference: it gets the amount, and one output the direction, or two outputs the
/// enables; with the motor off both are 0. The axis moves like one with a signed reference, also if POSDRCT inverts its
/// motor.
///
/// Proves: MACS-DIR-08, MACS-DIR-09
#[test]
fn outputs_show_sign_of_unipolar_reference() {
    use crate::drive::Interface;
    use crate::sim::{SignOutputs, VelocityLag};
    for posdrct in [1, 2, -1] {
        for (revers, sign) in [(20, SignOutputs::Direction(1)), (-20, SignOutputs::Enables(1, 2))] {
            let mut cell = with_io();
            cell.axes[1].interface = Interface::Velocity;
            (cell.axes[1].parameters.macs.posdrct, cell.axes[1].parameters.macs.revers) = (posdrct, revers);
            cell.axes[1].parameters.max_following_error = 5_000;
            // The lag is that of the loop: v / Kv.
            let model = Model::Velocity(VelocityLag::new(5_000_000, 1_000_000).unwrap()).wired(posdrct.abs() == 2);
            let mut rig = Rig::with(cell, [model, Model::Ideal]);
            rig.plant.attach_mechanics(0, &Mechanics { sign: Some(sign), ..Mechanics::default() });
            rig.run(10);
            assert_eq!((rig.int("q"), rig.int("r")), (0, 0), "off");
            rig.enable();
            let enables = revers < 0;
            assert_eq!((rig.int("q"), rig.int("r")), (i64::from(enables), 0), "0 counts as forwards");
            for target in [20_000, -20_000, 0] {
                let goal = rig.give(Action::Move(to(X, target)));
                let mut seen = [false; 2];
                for _ in 0..3_000 {
                    rig.run(1);
                    assert!(rig.real("x.output.velocity") >= 0.0, "{revers}: no sign");
                    let (first, second) = (rig.int("q") == 1, rig.int("r") == 1);
                    if enables {
                        assert!(first != second, "{revers}: one of both");
                    }
                    if rig.real("x.output.velocity") > 10_000.0 {
                        seen[usize::from(if enables { second } else { first })] = true;
                    }
                }
                assert_eq!(rig.done(goal).len(), 1, "{posdrct} {revers}: {}", rig.state("x"));
                assert!((rig.int("x.actual.position") - target).abs() <= 2, "{posdrct} {revers} {target}");
                // Both directions at once would mean that the outputs work against each other.
                assert_ne!(seen[0], seen[1], "{posdrct} {revers} {target}");
            }
            rig.give(Action::Disable(AxisSet::first(3)));
            rig.run(20);
            if enables {
                assert_eq!((rig.int("q"), rig.int("r")), (0, 0), "motor off");
            }
        }
    }
}

//! Function slots in the cycle: their order, their effect on axes, commands, tables.

use super::rig::{LINE, Rig, X, Y, at, config, couple, parameters, to};
use crate::code::Code;
use crate::command::{Action, CommandFunction};
use crate::config::{
    AxisConfig, IoConfig, IoKind, Line, MachineConfig, MemoryConfig, MemoryKind, SinkConfig, SlotConfig, SourceConfig,
    TableConfig,
};
use crate::drive::Capabilities;
use crate::event::Kind;
use crate::function::{Kind as Type, OnAxisError, Order, Width};
use crate::object::{AxisSet, Leader, Object};
use crate::parameter::{Change, Row, Value};
use crate::position::Length;
use crate::table::{Form, Table};
use crate::unit::{Fraction, Quantity, Scale, Unit};
use std::sync::Arc;

mod copies;
mod events;
mod generator;
mod goals;
mod integers;
mod interpolators;
mod links;
mod positions;
mod programs;
mod random;
pub(super) mod speeds;

/// A rotary axis: 36000 inc per revolution, 90 rpm.
const DISC: u16 = 3;

/// Cell with line, x, y and a disc; in and lamp; words of 16, 32 and 64 bits, a real, a bit; a table.
fn cell(slots: Vec<SlotConfig>) -> MachineConfig {
    let io = |name: &str, kind| IoConfig { name: name.into(), kind, latch: false };
    let memory = |name: &str, kind| MemoryConfig { name: name.into(), kind, initial: 0.0 };
    let mut config = config(0);
    config.io = vec![
        io("e1", IoKind::DigitalInput),
        io("lamp", IoKind::DigitalOutput),
        io("aa", IoKind::AnalogOutput),
        io("e2", IoKind::DigitalInput),
        io("u", IoKind::AnalogInput),
    ];
    config.memory = vec![
        memory("w", MemoryKind::I16),
        memory("d", MemoryKind::I32),
        memory("l", MemoryKind::I64),
        memory("r", MemoryKind::F64),
        memory("bit", MemoryKind::Bit),
    ];
    let per = Quantity::new(Fraction::from_integer(360), Unit::DEGREE);
    let scale = Scale::new(Fraction::from_integer(36_000), per).expect("a legal scale");
    let p = crate::parameter::AxisParameters { max_velocity: 54_000.0, ..parameters() };
    config.axes.push(AxisConfig::new("disc".into(), scale, Some(Capabilities::all(0)), p));
    let words = [3, 0, 0, 0, 100, 0, 1, 0, 200, 0, 0, 0];
    let table = Table::new(Form::Words, &[], &words).expect("words");
    config.tables = vec![TableConfig { name: "t".into(), table: Arc::new(table) }];
    config.slots = slots;
    config
}

fn slot(name: &str, number: u16, kind: Type) -> SlotConfig {
    SlotConfig::new(name.into(), number, kind)
}

/// Returns a gear from a leader to an axis, with ratio 1.
fn gear(name: &str, number: u16, source: Leader, axis: u16) -> SlotConfig {
    let mut slot = SlotConfig {
        source: SourceConfig::Lead(source),
        sink: SinkConfig::Axis(axis),
        ..slot(name, number, Type::Varsync)
    };
    slot.values[3] = 10_000;
    slot.inputs[0] = Some(Line { object: Object::Io(0), inverted: false });
    slot
}

fn copy(name: &str, number: u16, source: SourceConfig, sink: SinkConfig) -> SlotConfig {
    SlotConfig { source, sink, ..slot(name, number, Type::Dcopy) }
}

pub(super) fn order(slot: u16, order: Order) -> Action {
    with(slot, order, &[])
}

fn with(slot: u16, order: Order, values: &[(u16, i64)]) -> Action {
    Action::CommandFunction(CommandFunction { slot, order, values: values.into() })
}

/// Returns the index of a field in its set.
fn field(kind: Type, name: &str) -> u16 {
    kind.description().find(name).expect("a field").1 as u16
}

/// Returns a machine with one gear from line to x, both on, line at 20 mm/s (20 inc per cycle).
pub(super) fn geared() -> Rig {
    let mut rig = Rig::of(cell(vec![gear("g", 5, Leader::AxisCommand(LINE), X)]));
    rig.enable();
    rig.give(Action::Move(at(LINE, 20_000.0)));
    rig.run_to("line.command.velocity", 20_000.0);
    rig
}

/// Proves: AMK-VARSYNC-10, AMK-CMD-08
#[test]
fn an_axis_follows_from_the_cycle_behind_start_without_a_jump() {
    let mut rig = geared();
    let before = rig.int("x.command.position");
    let started = rig.give(order(0, Order::Start));
    assert!(rig.was_accepted(started));
    assert_eq!((rig.int("x.command.position"), rig.state("x")), (before, "SYNCHRONIZED_MOTION"));
    assert_eq!((rig.int("x.reference"), rig.int("g.active"), rig.int("g.sink")), (8, 1, before));
    // The slot reads the command of the line of the last cycle; the line moves 20 inc per cycle.
    rig.run(1);
    assert_eq!((rig.int("x.command.position"), rig.real("x.command.velocity")), (before + 20, 20_000.0));
    rig.run(99);
    assert_eq!((rig.int("x.command.position"), rig.int("g.sink")), (before + 2000, before + 2000));
    assert_eq!(rig.int("x.in_sync"), 1);
}

/// Proves: AMK-CMD-13
#[test]
fn reset_holds_what_the_sink_has_at_once_and_releases_the_axis() {
    let mut rig = geared();
    rig.give(order(0, Order::Start));
    rig.run(50);
    let held = rig.int("x.command.position");
    rig.give(order(0, Order::Reset));
    assert_eq!((rig.int("x.command.position"), rig.int("g.sink"), rig.int("g.active")), (held, held, 0));
    rig.run(30);
    assert_eq!((rig.int("x.command.position"), rig.state("x"), rig.int("x.reference")), (held, "STANDSTILL", 0));
    // The axis is free for other commands after the sink.
    let moved = rig.give(Action::Move(to(X, held + 500)));
    assert!(rig.was_accepted(moved));
    rig.run(400);
    let started = rig.give(order(0, Order::Start));
    assert!(rig.was_accepted(started));
    assert_eq!(rig.int("g.sink"), held + 500, "it begins where the axis is now");
}

/// Proves: AMK-GEN-11, AMK-BCOM-07, AMK-CTX-05
#[test]
fn a_function_runs_on_without_its_axis_which_follows_again_once_it_is_on() {
    let mut rig = Rig::of(cell(vec![gear("g", 0, Leader::AxisCommand(LINE), X)]));
    rig.give(Action::Move(at(LINE, 20_000.0)));
    let started = rig.give(order(0, Order::Start));
    assert!(rig.was_accepted(started), "an axis that is off is waited for");
    assert_eq!((rig.state("x"), rig.int("x.reference")), ("DISABLED", 8));
    rig.run(100);
    assert_eq!(rig.int("x.command.position"), 0);
    let sink = rig.int("g.sink");
    assert!(sink > 1000);
    rig.enable();
    assert_eq!(rig.state("x"), "SYNCHRONIZED_MOTION");
    let (there, sink) = (rig.int("x.command.position"), rig.int("g.sink"));
    rig.run(10);
    assert_eq!(rig.int("x.command.position") - there, rig.int("g.sink") - sink, "changes, not the value");
    // The same after switching off and on again.
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(200);
    assert_eq!((rig.state("x"), rig.int("x.reference"), rig.int("g.active")), ("DISABLED", 8, 1));
    rig.enable();
    assert_eq!(rig.state("x"), "SYNCHRONIZED_MOTION");
}

#[test]
fn other_motion_or_stop_takes_axis_from_function_until_next_start() {
    for taking in [
        Action::Move(to(X, 90_000)),
        Action::Halt(AxisSet::one(X)),
        Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 2)),
    ] {
        let mut rig = geared();
        rig.give(order(0, Order::Start));
        rig.run(20);
        let velocity = rig.real("x.command.velocity");
        let given = rig.give(taking.clone());
        assert!(rig.was_accepted(given), "{taking:?}");
        rig.run(1);
        let after = rig.real("x.command.velocity");
        assert!((after - velocity).abs() <= 1000.0 + 1e-6, "{taking:?}: from {velocity} to {after}");
        assert_eq!(rig.int("g.active"), 1, "the function runs on");
        rig.give(Action::Halt(AxisSet::one(X)));
        rig.run(500);
        assert_eq!(rig.state("x"), "STANDSTILL", "{taking:?}: nothing moves it again");
        let refused = rig.give(order(0, Order::Start));
        assert_eq!(rig.answer(refused).expect_err("it is active").code, Code::FUNCTION_ACTIVE);
        rig.give_all(vec![order(0, Order::Reset), order(0, Order::Start)]);
        assert_eq!(rig.state("x"), "SYNCHRONIZED_MOTION");
    }
}

#[test]
fn a_moving_axis_comes_to_the_velocity_of_the_sink_within_its_limits() {
    let mut rig = geared();
    rig.give(Action::Move(at(X, 60_000.0)));
    rig.run_to("x.command.velocity", 60_000.0);
    rig.give(order(0, Order::Start));
    let mut before = rig.real("x.command.velocity");
    for _ in 0..200 {
        rig.run(1);
        let now = rig.real("x.command.velocity");
        // Half of max_acceleration, and one count because the sink is in whole counts.
        assert!((now - before).abs() <= 500.0 + 1000.0 + 1e-6, "{before} {now}");
        before = now;
    }
    assert_eq!((before, rig.int("x.in_sync")), (20_000.0, 1));
    let (there, sink) = (rig.int("x.command.position"), rig.int("g.sink"));
    rig.run(100);
    assert_eq!(rig.int("x.command.position") - there, rig.int("g.sink") - sink);
}

#[test]
fn a_sink_that_is_too_fast_is_an_error_of_its_axis() {
    let mut slot = gear("g", 0, Leader::AxisCommand(LINE), X);
    slot.on_axis_error = OnAxisError::Reset;
    slot.values[4] = 30_000;
    let mut rig = Rig::of(cell(vec![slot]));
    rig.enable();
    rig.give(Action::Move(at(LINE, 50_000.0)));
    rig.run_to("line.command.velocity", 50_000.0);
    rig.give(order(0, Order::Start));
    rig.run(10);
    assert_eq!((rig.state("x"), rig.real("x.command.velocity")), ("SYNCHRONIZED_MOTION", 50_000.0));
    // E1 selects ratio 3: 150 mm/s, while the maximum is 100 mm/s.
    rig.modify_inputs = |inputs| inputs.digital[0] = 1;
    rig.run(1);
    assert_eq!((rig.state("x"), rig.int("x.error")), ("ERROR_STOP", Code::FUNCTION_TOO_FAST.0.into()));
    let told = rig.events.iter().find(|event| event.kind == Kind::Error).expect("the error");
    assert_eq!(
        crate::text::message(told, rig.machine.config()),
        "x: its function asks for 150 mm/s; max_velocity is 100 mm/s"
    );
    // The axis starts its cycle after the slots: they see its error in the next one.
    rig.run(1);
    assert_eq!(rig.int("g.active"), 0);
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    rig.run(300);
    assert_eq!(rig.state("x"), "STANDSTILL");
}

#[test]
fn error_takes_axis_while_function_continues() {
    let mut rig = geared();
    rig.give(order(0, Order::Start));
    rig.run(20);
    rig.plant.drive(0).expect("the drive of x").inject_fault(0x7500);
    rig.run(5);
    assert_eq!((rig.state("x"), rig.int("g.active")), ("ERROR_STOP", 1));
    rig.run(400);
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    rig.run(50);
    rig.enable();
    assert_eq!(rig.state("x"), "STANDSTILL", "only START gives it back");
    let refused = rig.give_all(vec![order(0, Order::Reset), order(0, Order::Start)]);
    assert!(rig.answer(refused).is_ok());
}

#[test]
fn an_error_that_lets_the_axis_go_on_ends_a_function_all_the_same_where_it_is_to() {
    let mut slot = gear("g", 0, Leader::AxisCommand(LINE), X);
    slot.on_axis_error = OnAxisError::Reset;
    let mut config = cell(vec![slot]);
    config.axes[1].parameters.error_reaction = 5;
    config.axes[1].parameters.max_following_error = 100;
    let mut rig = Rig::of(config);
    rig.enable();
    rig.give(Action::Move(at(LINE, 20_000.0)));
    rig.give(order(0, Order::Start));
    rig.run(50);
    assert_eq!(rig.state("x"), "SYNCHRONIZED_MOTION");
    // The drive does not move: a following error, which is reported while the axis continues.
    rig.modify_inputs = |inputs| inputs.drive[0].count = 0;
    rig.run(60);
    assert!(rig.events.iter().any(|event| event.code == Code::FOLLOWING_ERROR));
    assert_eq!((rig.int("g.active"), rig.state("x"), rig.real("x.command.velocity")), (0, "STANDSTILL", 0.0));
}

#[test]
fn start_overridden_by_stop_of_its_cycle_is_reported() {
    let mut rig = geared();
    rig.give_all(vec![Action::QuickStop(AxisSet::one(X)), order(0, Order::Start)]);
    assert_eq!((rig.int("g.active"), rig.state("x")), (1, "STOPPING"));
    let told = rig.events.iter().any(|event| event.kind == Kind::Warning && event.code == Code::QUICK_STOPPED);
    assert!(told, "the axis does not follow, and says why");
}

#[test]
fn an_axis_that_cannot_move_refuses_start() {
    let mut rig = geared();
    rig.give(Action::QuickStop(AxisSet::one(X)));
    let refused = rig.give(order(0, Order::Start));
    assert_eq!(rig.answer(refused).expect_err("locked").code, Code::QUICK_STOPPED);
    assert_eq!((rig.int("g.active"), rig.int("g.error")), (0, 0));
    // A coupling that would close a loop: x follows a function of y, and y follows x.
    let mut rig = Rig::of(cell(vec![gear("g", 0, Leader::AxisCommand(Y), X)]));
    rig.enable();
    let coupled = rig.give(Action::Synchronize(couple(Y, Leader::AxisCommand(X), 1, 1)));
    assert_eq!(rig.answer(coupled).expect_err("x may follow y").code, Code::LEADER_LOOP);
}

/// Proves: AMK-DIGDREH-02, AMK-DIGDREH-04, AMK-DIGDREH-06, AMK-DIGDREH-07, AMK-DIGDREH-08, AMK-GEN-18
#[test]
fn a_speed_runs_a_rotary_axis_on_its_ramp() {
    let mut slot = slot("turn", 0, Type::Digdreh);
    slot.sink = SinkConfig::Axis(DISC);
    let line = |place| Some(Line { object: Object::Io(place), inverted: false });
    (slot.inputs[1], slot.inputs[0], slot.inputs[2]) =
        (line(0), Some(Line { object: Object::Io(3), inverted: true }), None);
    slot.outputs[0] = line(1);
    let mut rig = Rig::of(cell(vec![slot]));
    rig.enable();
    // 60 rpm: one revolution of 36000 inc per second.
    let started = rig.give(with(0, Order::Start, &[(field(Type::Digdreh, "speed"), 600_000)]));
    assert!(rig.was_accepted(started), "{:?}", rig.answer(started));
    rig.run(1);
    assert_eq!((rig.int("turn.sink"), rig.int("lamp"), rig.state("disc")), (0, 1, "STANDSTILL"));
    assert_eq!(rig.int("disc.reference"), 8);
    rig.modify_inputs = |inputs| inputs.digital[0] = 1;
    rig.run(1);
    assert_eq!((rig.int("turn.sink"), rig.int("lamp")), (600_000, 0));
    rig.run(10);
    // Half of max_acceleration, 1e6 inc/s^2, is 500 inc/s per cycle.
    assert_eq!(rig.real("disc.command.velocity"), 5_000.0);
    rig.run(80);
    assert_eq!((rig.real("disc.command.velocity"), rig.int("disc.in_velocity")), (36_000.0, 1));
    // Loss of the enable stops the axis, during the ramp, too.
    rig.modify_inputs = |inputs| inputs.digital[0] = 0b11;
    rig.run(1);
    assert_eq!((rig.int("turn.sink"), rig.int("lamp")), (0, 1));
    rig.run(90);
    assert_eq!(rig.real("disc.command.velocity"), 0.0);
    rig.modify_inputs = |inputs| inputs.digital[0] = 0;
    rig.run(2);
    rig.modify_inputs = |inputs| inputs.digital[0] = 1;
    rig.run(90);
    assert_eq!(rig.real("disc.command.velocity"), 36_000.0);
    rig.give(order(0, Order::Reset));
    assert_eq!((rig.int("turn.sink"), rig.int("lamp")), (0, 1), "a speed is 0 and A1 stands for rest");
    rig.run(100);
    assert_eq!(rig.state("disc"), "STANDSTILL");
}

#[test]
fn a_follower_of_a_sink_follows_it_and_counts_on_where_it_begins_anew() {
    let slots = vec![copy("c", 3, SourceConfig::Signal("l".into()), SinkConfig::None)];
    let mut rig = Rig::of(cell(slots));
    rig.enable();
    let coupled = rig.give(Action::Synchronize(couple(X, Leader::Sink(0), 1, 1)));
    assert!(rig.was_accepted(coupled));
    rig.give(Action::set_memory(2, 5000.0));
    rig.run(20);
    rig.give(order(0, Order::Start));
    rig.run(5);
    assert_eq!((rig.int("c.sink"), rig.int("x.command.position")), (5000, 0), "START is no motion");
    for step in 1..=30 {
        rig.give(Action::set_memory(2, 5000.0 + f64::from(step)));
    }
    rig.run(30);
    assert_eq!((rig.int("x.command.position"), rig.int("x.sync.master")), (30, 5030));
}

#[test]
fn new_coordinate_of_source_is_no_travel() {
    let slots = vec![gear("g", 0, Leader::AxisActual(Y), X)];
    let mut rig = Rig::of(cell(slots));
    rig.enable();
    rig.give(order(0, Order::Start));
    let set = rig.give(Action::SetPosition(crate::command::SetPosition { axis: Y, position: Length::whole(7000) }));
    assert!(rig.was_accepted(set));
    rig.run(10);
    assert_eq!((rig.int("y.command.position"), rig.int("x.command.position")), (7000, 0));
    rig.give(Action::Move(to(Y, 7100)));
    rig.run(400);
    assert_eq!((rig.int("y.command.position"), rig.int("x.command.position")), (7100, 100));
}

/// Proves: AMK-CMD-01, AMK-CMD-02, AMK-CMD-03, AMK-CMD-04, AMK-CMD-05, AMK-CMD-06, AMK-CMD-07, AMK-CTX-07, AMK-CTX-08, AMK-CMD-09, AMK-CMD-10, AMK-CMD-11, AMK-CMD-12, AMK-CMD-14, AMK-ECOPY-05, AMK-BCOM-32, AMK-BCOM-33, AMK-BCOM-34, AMK-BCOM-35, AMK-BCOM-36, AMK-BCOM-37, AMK-BCOM-38, AMK-BCOM-39, AMK-BCOM-40
#[test]
fn orders_are_taken_by_the_states_and_a_set_is_taken_as_a_whole() {
    let mut slot = slot("e", 0, Type::Ecopy);
    slot.sink = SinkConfig::Memory(1);
    let mut rig = Rig::of(cell(vec![slot]));
    let (mode, value) = (0, 1);
    let early = rig.give(with(0, Order::ValueNew, &[(value, 5)]));
    assert_eq!(rig.refusal(early), "e: it is in RESET; VALUE_NEW needs a function that is started");
    let fault = rig.give(with(0, Order::Start, &[(value, 5), (mode, 9)]));
    assert_eq!(rig.refusal(fault), "e: mode is 9; 0 to 3 is allowed");
    assert_eq!((rig.int("e.active"), rig.int("e.error")), (0, 3004));
    assert_eq!(rig.machine.slots()[0].staged(), [0, 0, 0], "nothing of the set was taken");
    let started = rig.give(with(0, Order::Start, &[(mode, 1), (value, 70_000)]));
    assert!(rig.was_accepted(started));
    assert_eq!((rig.int("d"), rig.int("e.active"), rig.int("e.error")), (70_000, 1, 0));
    let again = rig.give(order(0, Order::Start));
    assert_eq!(rig.answer(again).expect_err("active").code, Code::FUNCTION_ACTIVE);
    // Staged values apply once they are commanded.
    rig.give(with(0, Order::Stage, &[(value, 3)]));
    rig.run(3);
    assert_eq!(rig.int("d"), 70_000);
    let bad = rig.give(with(0, Order::ValueNew, &[(value, 4), (value + 1, 1 << 40)]));
    assert_eq!(rig.answer(bad).expect_err("beyond i32").code, Code::FUNCTION_RANGE);
    rig.run(1);
    assert_eq!((rig.int("d"), rig.machine.slots()[0].staged()), (70_000, &[1, 3, 0][..]));
    // The mode remains as at the start (A-12).
    rig.give(with(0, Order::ValueNew, &[(mode, 0)]));
    assert_eq!((rig.int("d"), rig.machine.slots()[0].active()), (3, &[1, 3, 0][..]));
    let read = rig.give(order(0, Order::ReadValue));
    assert!(rig.was_accepted(read));
    rig.give(order(0, Order::Reset));
    rig.give(Action::set_memory(1, 8.0));
    rig.run(2);
    assert_eq!((rig.int("d"), rig.int("e.sink")), (8, 3), "released");
    let unknown = rig.give(order(9, Order::Start));
    assert_eq!(rig.answer(unknown).expect_err("no such slot").code, Code::BAD_REQUEST);
}

/// Proves: AMK-GEN-13
#[test]
fn table_in_use_is_locked_and_editable_table_applies_at_once() {
    let mut binea = slot("b", 0, Type::Binea);
    binea.tables[0] = Some(0);
    let mut rig = Rig::of(cell(vec![binea]));
    let table = |words: &[i64]| Arc::new(Table::new(Form::Words, &[], words).expect("words"));
    let load = |table: &Arc<Table>| Action::LoadTable { index: 0, table: Arc::clone(table) };
    let given = rig.give(with(0, Order::Start, &[(4, 2)]));
    assert!(rig.was_accepted(given), "{}", rig.refusal(given));
    let other = table(&[2, 0, 0, 0, 300, 0, 1, 0]);
    let refused = rig.give(load(&other));
    assert_eq!(
        rig.refusal(refused),
        "t: function b is started and reads it; type binea takes no new numbers before RESET"
    );
    rig.give(order(0, Order::Reset));
    let taken = rig.give(load(&other));
    assert!(rig.was_accepted(taken));
    assert_eq!(rig.machine.tables()[0], other);
    let y = Arc::new(Table::new(Form::Y, &[], &[0, 1]).expect("points"));
    let refused = rig.give(load(&y));
    assert_eq!(rig.refusal(refused), "t: the numbers are of form y; the table has form words");
    let unknown = rig.give(Action::LoadTable { index: 3, table: other });
    assert_eq!(rig.answer(unknown).expect_err("no such table").code, Code::BAD_REQUEST);
}

/// Proves: AMK-BCOM-06, AMK-SNK-03, AMK-SNK-07, AMK-ECOPY-01, AMK-ECOPY-04, AMK-ECOPY-O1
#[test]
fn outputs_of_a_function_are_its_own_and_an_ao_takes_mv() {
    let mut slot = slot("e", 0, Type::Ecopy);
    slot.sink = SinkConfig::Output(2);
    slot.inputs[0] = Some(Line { object: Object::Memory(4), inverted: false });
    slot.outputs[0] = Some(Line { object: Object::Io(1), inverted: false });
    let mut rig = Rig::of(cell(vec![slot]));
    rig.give(with(0, Order::Start, &[(0, 3), (1, 10_000), (2, 5000)]));
    assert_eq!((rig.outputs().analog[0], rig.outputs().digital(0)), (10.0, false));
    rig.give(Action::set_memory(4, 1.0));
    assert_eq!(
        (rig.outputs().analog[0], rig.outputs().digital(0), rig.real("aa"), rig.int("e.out1")),
        (5.0, true, 5.0, 1)
    );
    for (entry, sentence) in [
        (1, "lamp: 1 may not be set, nor any value: function e writes it"),
        (2, "aa: 1 may not be set, nor any value: function e writes it"),
    ] {
        let refused = rig.give(Action::set_output(entry, 1.0));
        assert_eq!(rig.refusal(refused), sentence);
    }
    rig.give(order(0, Order::Reset));
    assert_eq!(
        (rig.outputs().analog[0], rig.outputs().digital(0)),
        (5.0, false),
        "A1 is 0 after RESET, the value is held"
    );
}

/// The full scale of an output is 10 V: a commanded value above it is refused, a value from a source is limited to it.
#[test]
fn an_ao_as_sink_gets_no_more_than_its_full_scale() {
    let mut slot = slot("e", 0, Type::Ecopy);
    (slot.source, slot.sink) = (SourceConfig::Signal("d".into()), SinkConfig::Output(2));
    let mut rig = Rig::of(cell(vec![slot]));
    let range = "mV exceeds the full scale of the analog output; -10000 to 10000 mV is allowed";
    for (place, key, value, bit) in [(1, "value_e1_0", 12_000, 1), (2, "value_e1_1", -10_001, 2)] {
        for mode in [bit, 3] {
            let refused = rig.give(with(0, Order::Start, &[(0, mode), (place, value)]));
            assert_eq!(rig.refusal(refused), format!("e: {key}: {value} {range}"));
        }
    }
    let started = rig.give(with(0, Order::Start, &[(1, 10_000), (2, -10_000)]));
    assert!(rig.was_accepted(started), "{:?}", rig.answer(started));
    for (value, volts) in [(9_999.0, 9.999), (12_000.0, 10.0), (-2e9, -10.0), (5_000.0, 5.0)] {
        rig.give(Action::set_memory(1, value));
        rig.run(1);
        assert_eq!((rig.outputs().analog[0], rig.real("aa"), rig.int("e.sink")), (volts, volts, value as i64));
    }
}

/// Bits 0 and 1 of the mode select the values for E1 = 0 and E1 = 1; without its bit a value has no effect.
///
/// Proves: AMK-ECOPY-03
#[test]
fn value_that_the_mode_of_ecopy_does_not_use_may_exceed_the_full_scale() {
    let range = "mV exceeds the full scale of the analog output; -10000 to 10000 mV is allowed";
    for (mode, unused, used) in [(2, 1, 2), (1, 2, 1)] {
        let mut slot = slot("e", 0, Type::Ecopy);
        (slot.source, slot.sink) = (SourceConfig::Signal("d".into()), SinkConfig::Output(2));
        let mut rig = Rig::of(cell(vec![slot]));
        let commands = [
            (Order::Stage, vec![(unused, 12_000)]),
            (Order::Start, vec![(0, mode), (unused, 12_000)]),
            (Order::ValueNew, vec![(unused, -12_000)]),
            (Order::ValueNew, vec![(used, 10_000)]),
        ];
        for (command, values) in commands {
            let given = rig.give(with(0, command, &values));
            assert!(rig.was_accepted(given), "{mode} {command:?}: {:?}", rig.answer(given));
        }
        // The mode in force applies: the command contains none.
        let refused = rig.give(with(0, Order::ValueNew, &[(used, 10_001)]));
        assert_eq!(rig.refusal(refused), format!("e: value_e1_{}: 10001 {range}", used - 1));
        rig.give(order(0, Order::Reset));
        let refused = rig.give(with(0, Order::Start, &[(0, 3)]));
        assert_eq!(rig.refusal(refused), format!("e: value_e1_{}: -12000 {range}", unused - 1));
    }
}

/// Proves: AMK-GEN-01, AMK-BCOM-01, AMK-INIT-04, AMK-BCOM-11, AMK-CTX-11
#[test]
fn a_slot_is_called_in_each_nth_cycle_from_its_start_on() {
    let mut slot = copy("c", 0, SourceConfig::Signal("l".into()), SinkConfig::Memory(1));
    slot.factor = 3;
    let mut rig = Rig::of(cell(vec![slot]));
    rig.run(1);
    let mut seen = Vec::new();
    for cycle in 0..8 {
        let mut actions = vec![Action::set_memory(2, f64::from(cycle + 1))];
        actions.extend((cycle == 0).then(|| order(0, Order::Start)));
        rig.give_all(actions);
        seen.push(rig.int("d"));
    }
    assert_eq!(seen, [1, 1, 1, 4, 4, 4, 7, 7]);
}

/// Proves: AMK-SNK-01, AMK-SNK-04, AMK-SNK-05
#[test]
fn widths_cut_and_extend() {
    let word = |name: &str| SourceConfig::Signal(name.into());
    let mut slots = vec![
        copy("a", 0, word("l"), SinkConfig::Memory(0)),
        copy("b", 1, word("w"), SinkConfig::Memory(1)),
        copy("c", 2, word("l"), SinkConfig::Memory(3)),
    ];
    slots[2].sink_width = Width::W32;
    let mut rig = Rig::of(cell(slots));
    rig.give_all((0..3).map(|slot| order(slot, Order::Start)).collect());
    rig.give(Action::set_memory(2, f64::from(0x1_8001_u32)));
    // 32768 + 1 is negative in 16 bits, and stays negative in 32.
    assert_eq!((rig.int("w"), rig.int("d"), rig.real("r")), (-32_767, -32_767, 98_305.0));
    rig.give(Action::set_memory(2, 3_000_000_000.0));
    assert_eq!((rig.int("w"), rig.real("r")), (24_064, -1_294_967_296.0));
}

#[test]
fn parameters_of_axes_hold_as_they_were_while_a_function_leads() {
    let mut rig = geared();
    rig.give(order(0, Order::Start));
    rig.run(10);
    let (row, _) = Row::find("max_velocity").expect("a key of the catalogue");
    let set = rig.give(Action::SetParameters([Change { axis: X, row, value: Value::Real(10_000.0) }].into()));
    assert!(rig.answer(set).is_ok());
    rig.run(5);
    assert_eq!(rig.int("x.error"), Code::FUNCTION_TOO_FAST.0.into(), "a limit counts at once");
}

/// Each kind of data source by its name: counters of 16 bits, commands and actual positions of axes in 16 and 32 bits,
/// words, sinks.
///
/// Proves: AMK-SRC-01, AMK-SRC-03, AMK-SRC-04, AMK-SRC-07, AMK-BCOM-17, AMK-BCOM-19, AMK-BCOM-20, AMK-BCOM-21, AMK-BCOM-22, AMK-BCOM-23, AMK-BCOM-26, AMK-BCOM-27,
/// AMK-BCOM-30, AMK-BCOM-31, AMK-CTX-12, AMK-CTX-13, AMK-CTX-14, AMK-CTX-16, AMK-CTX-17, AMK-CTX-19, AMK-CTX-22
#[test]
fn sources_are_signals_by_their_names() {
    let lead = SourceConfig::Lead;
    let word = |name: &str| SourceConfig::Signal(name.into());
    let sources = [
        (lead(Leader::Encoder(0)), Width::W16, -32_736),
        (lead(Leader::AxisCommand(Y)), Width::W64, 70_000),
        (lead(Leader::AxisActual(Y)), Width::W16, 4464),
        (lead(Leader::AxisActual(Y)), Width::W32, 70_000),
        (word("d"), Width::W64, -5),
        (word("u"), Width::W64, -1235),
        (word("y.command.velocity"), Width::W64, 0),
        (word("e1"), Width::W64, 1),
        (lead(Leader::Sink(4)), Width::W64, -5),
        (SourceConfig::None, Width::W64, 0),
    ];
    let slots = sources.iter().enumerate().map(|(place, (source, width, _))| {
        let copy = copy(&format!("f{place}"), place as u16, source.clone(), SinkConfig::None);
        let slot = SlotConfig { source_width: *width, ..copy };
        if *source == SourceConfig::None {
            SlotConfig { kind: Type::Ecopy, values: [0; 3].into(), ..slot }
        } else {
            slot
        }
    });
    let mut rig = Rig::of(cell(slots.collect()));
    rig.enable();
    rig.give(Action::Move(to(Y, 70_000)));
    rig.run(2000);
    rig.modify_inputs = |inputs| {
        // Half a mV away from zero.
        (inputs.analog[0], inputs.digital[0]) = (-1.2345, 1);
        inputs.encoder[0].count = 32_800;
    };
    rig.give(Action::set_memory(1, -5.0));
    rig.give_all((0..10).map(|slot| order(slot, Order::Start)).collect());
    rig.run(2);
    for (place, (source, _, expected)) in sources.iter().enumerate() {
        assert_eq!(rig.int(&format!("f{place}.sink")), *expected, "{source:?}");
    }
}

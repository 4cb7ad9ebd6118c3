//! Copies onto an axis in speed control: 36000 inc per revolution, so 1 rpm is 600 inc/s; the velocity changes by 500
//! inc/s per cycle.

use super::*;
use crate::function::Quantity as Carries;

/// Returns a copy that runs the disc at a speed.
fn runs(kind: Type, source: SourceConfig) -> SlotConfig {
    SlotConfig { source, sink: SinkConfig::Axis(DISC), quantity: Carries::Speed, ..slot("c", 1, kind) }
}

/// 30 rpm are 18000 inc/s, 18 inc per cycle; 15 rpm backwards are -9000 inc/s.
///
/// Proves: AMK-GEN-18, AMK-ECOPY-04, AMK-ECOPY-05
#[test]
fn ecopy_in_speed_control_runs_an_axis_on_its_ramp() {
    let mut copy = runs(Type::Ecopy, SourceConfig::None);
    let live = field(Type::Ecopy, "value_e1_1");
    for (name, value) in [("mode", 3), ("value_e1_1", 300_000)] {
        copy.values[usize::from(field(Type::Ecopy, name))] = value;
    }
    copy.inputs[0] = Some(Line { object: Object::Io(0), inverted: false });
    copy.outputs[0] = Some(Line { object: Object::Io(1), inverted: false });
    let mut rig = Rig::of(cell(vec![copy]));
    rig.enable();
    let started = rig.give(order(0, Order::Start));
    assert!(rig.was_accepted(started), "{:?}", rig.answer(started));
    rig.run(1);
    assert_eq!((rig.int("c.sink"), rig.state("disc"), rig.int("disc.reference")), (0, "STANDSTILL", 8));
    rig.modify_inputs = |inputs| inputs.digital[0] = 1;
    rig.run(1);
    assert_eq!((rig.int("c.sink"), rig.int("lamp")), (300_000, 1));
    rig.run(10);
    assert_eq!(rig.real("disc.command.velocity"), 5_000.0);
    rig.run(80);
    assert_eq!((rig.real("disc.command.velocity"), rig.int("disc.in_velocity")), (18_000.0, 1));
    let before = rig.int("disc.command.position");
    rig.run(100);
    let way = rig.int("disc.command.position") - before;
    assert!((1799..=1801).contains(&way), "{way}");
    // A machine restored from here gives the same results.
    rig.mirror();
    rig.give(with(0, Order::ValueNew, &[(live, -150_000)]));
    rig.run(80);
    assert_eq!((rig.int("c.sink"), rig.real("disc.command.velocity")), (-150_000, -9_000.0));
    rig.modify_inputs = |inputs| inputs.digital[0] = 0;
    rig.run(60);
    assert_eq!((rig.int("c.sink"), rig.real("disc.command.velocity")), (0, 0.0));
    rig.modify_inputs = |inputs| inputs.digital[0] = 1;
    rig.run(60);
    assert_eq!(rig.real("disc.command.velocity"), -9_000.0);
    rig.give(order(0, Order::Reset));
    assert_eq!((rig.int("c.sink"), rig.int("lamp")), (0, 0), "RESET makes a speed 0 (A-11)");
    rig.run(60);
    assert_eq!((rig.state("disc"), rig.real("disc.command.velocity")), ("STANDSTILL", 0.0));
}

/// Speed from a memory cell: 15 rpm are 9000 inc/s.
///
/// Proves: AMK-GEN-18, AMK-DCOPY-02
#[test]
fn dcopy_in_speed_control_runs_an_axis_at_the_speed_of_a_memory_cell() {
    let mut rig = Rig::of(cell(vec![runs(Type::Dcopy, SourceConfig::Signal("d".into()))]));
    rig.enable();
    rig.give(Action::set_memory(1, 150_000.0));
    let started = rig.give(order(0, Order::Start));
    assert!(rig.was_accepted(started), "{:?}", rig.answer(started));
    assert_eq!(rig.int("c.sink"), 150_000);
    rig.run(60);
    assert_eq!((rig.real("disc.command.velocity"), rig.int("disc.in_velocity")), (9_000.0, 1));
    rig.give(order(0, Order::Reset));
    assert_eq!((rig.int("c.sink"), rig.int("d")), (0, 150_000));
    rig.run(60);
    assert_eq!((rig.state("disc"), rig.real("disc.command.velocity")), ("STANDSTILL", 0.0));
}

/// The same speed for several drives: a digdreh without a sink of its own, and a copy of it. 60 rpm are 36000 inc/s.
///
/// Proves: AMK-GEN-18, AMK-DCOPY-02
#[test]
fn dcopy_in_speed_control_runs_an_axis_at_the_speed_of_another_function() {
    let mut turn = slot("turn", 0, Type::Digdreh);
    turn.inputs[0] = Some(Line { object: Object::Io(3), inverted: true });
    turn.inputs[1] = Some(Line { object: Object::Io(0), inverted: false });
    let copy = runs(Type::Dcopy, SourceConfig::Lead(Leader::Sink(0)));
    let mut rig = Rig::of(cell(vec![turn, copy]));
    rig.enable();
    let start = with(0, Order::Start, &[(field(Type::Digdreh, "speed"), 600_000)]);
    let started = rig.give_all(vec![start, order(1, Order::Start)]);
    assert!(rig.was_accepted(started), "{:?}", rig.answer(started));
    rig.run(1);
    rig.modify_inputs = |inputs| inputs.digital[0] = 1;
    rig.run(1);
    assert_eq!((rig.int("turn.sink"), rig.int("c.sink")), (600_000, 600_000), "in the same cycle");
    rig.run(90);
    assert_eq!(rig.real("disc.command.velocity"), 36_000.0);
    rig.give(order(0, Order::Reset));
    assert_eq!((rig.int("turn.sink"), rig.int("c.sink")), (0, 0));
    rig.run(100);
    assert_eq!(rig.real("disc.command.velocity"), 0.0);
}

/// Proves: AMK-GEN-18
#[test]
fn copy_of_a_speed_needs_a_rotary_axis_and_other_types_have_one_quantity() {
    let refused = |slot| crate::machine::Machine::new(cell(vec![slot])).err().map(|error| error.to_string());
    for kind in [Type::Dcopy, Type::Ecopy] {
        let copy = runs(kind, SourceConfig::Signal("d".into()));
        let linear = SlotConfig { sink: SinkConfig::Axis(X), ..copy.clone() };
        assert!(refused(linear).expect("a linear axis").contains("is no rotary axis"));
        assert_eq!(refused(copy), None);
    }
    let gear = SlotConfig { quantity: Carries::Speed, ..gear("g", 0, Leader::AxisCommand(LINE), DISC) };
    assert!(refused(gear).expect("a position").contains("quantity is nothing that it can use"));
}

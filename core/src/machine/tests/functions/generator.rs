//! A generator that moves and watches axes, and a regulator that moves one.

use super::*;

/// Moves x from 500 on at 10 inc per cycle while e1 is 1, with ramps of 1 inc per cycle, and watches x: A1 is the lamp,
/// A2 a bit.
fn generates() -> Rig {
    let mut slot = slot("gen", 0, Type::Fgen);
    slot.sink = SinkConfig::Axis(X);
    slot.inputs[0] = Some(Line { object: Object::Io(0), inverted: false });
    slot.outputs[0] = Some(Line { object: Object::Io(1), inverted: false });
    slot.outputs[1] = Some(Line { object: Object::Memory(4), inverted: false });
    slot.words[0] = Some("w".into());
    for (name, value) in [
        ("fct", 7),
        ("cycle_time", 4000),
        ("sf_cycle_time", 2),
        ("cycle_increments", 20_000),
        ("accel", 1_000_000),
        // x is the second axis of the cell.
        ("aw_mask", 2),
        ("pos_limit", 40),
    ] {
        slot.values[usize::from(field(Type::Fgen, name))] = value;
    }
    let mut rig = Rig::of(cell(vec![slot]));
    rig.enable();
    rig.give(Action::set_memory(0, 1024.0));
    rig.give(Action::Move(to(X, 500)));
    rig.run(400);
    rig
}

/// Proves: AMK-FGEN-01, AMK-FGEN-02, AMK-FGEN-12, AMK-FGEN-13, AMK-FGEN-24, AMK-FGEN-32, AMK-FGEN-40, AMK-FGEN-41, AMK-BCOM-07, AMK-BCOM-37
#[test]
fn an_axis_goes_as_a_generator_does_and_its_position_is_zeroed_and_watched() {
    let mut rig = generates();
    let started = rig.give(order(0, Order::Start));
    assert!(rig.was_accepted(started), "{:?}", rig.answer(started));
    assert_eq!((rig.int("gen.sink"), rig.int("x.reference"), rig.int("lamp")), (500, 8, 1));
    rig.run(3);
    assert_eq!((rig.int("gen.feedback2"), rig.int("bit")), (500, 1), "as it is before the first edge");
    rig.modify_inputs = |inputs| inputs.digital[0] = 1;
    rig.run(1);
    assert_eq!((rig.int("x.command.position"), rig.int("gen.feedback2"), rig.int("bit")), (501, 0, 0));
    assert_eq!((rig.int("lamp"), rig.int("gen.out1")), (0, 0));
    rig.run(9);
    // The drive reports the command of the last cycle: 45 of 55.
    assert_eq!((rig.int("x.command.position"), rig.int("gen.feedback2"), rig.int("bit")), (555, 45, 1));
    assert_eq!(rig.int("gen.out2"), 1);
    rig.run(100);
    assert_eq!((rig.int("x.command.position"), rig.real("x.command.velocity")), (1555, 10_000.0));
    // A machine restored from here gives the same results.
    rig.mirror();
    rig.give(Action::set_memory(0, -1024.0));
    rig.run(19);
    assert_eq!((rig.int("gen.sink"), rig.int("x.command.position")), (1545, 1545), "9 + .. + 1, and 1 + .. + 10 back");
    rig.modify_inputs = |inputs| inputs.digital[0] = 0;
    rig.run(9);
    assert_eq!((rig.int("gen.sink"), rig.int("lamp")), (1500, 0));
    rig.run(1);
    assert_eq!((rig.int("gen.sink"), rig.int("lamp")), (1500, 1));
    rig.modify_inputs = |inputs| inputs.digital[0] = 1;
    rig.run(1);
    rig.give(order(0, Order::Reset));
    assert_eq!((rig.int("gen.sink"), rig.int("gen.active"), rig.int("lamp"), rig.int("bit")), (1499, 0, 1, 0));
    assert_eq!((rig.int("gen.feedback2"), rig.int("gen.out2")), (0, 0));
    rig.run(30);
    assert_eq!((rig.int("x.command.position"), rig.state("x")), (1499, "STANDSTILL"));
}

/// Only the image is set to zero (G8).
///
/// Proves: AMK-FGEN-40
#[test]
fn zeroing_leaves_the_axis_its_zero() {
    let mut rig = generates();
    rig.give(order(0, Order::Start));
    rig.modify_inputs = |inputs| inputs.digital[0] = 1;
    rig.run(2);
    assert_eq!((rig.int("gen.feedback2"), rig.int("x.actual.position")), (1, 501));
}

/// Proves: AMK-FGEN-22, AMK-BCOM-26
#[test]
fn it_counts_round_in_a_sink_of_16_bits() {
    let mut config = generates().machine.config().clone();
    (config.slots[0].sink, config.slots[0].sink_width) = (SinkConfig::Memory(1), Width::W16);
    config.slots[0].values[usize::from(field(Type::Fgen, "ba"))] = 2;
    let mut rig = Rig::of(config);
    rig.give(Action::set_memory(0, 1024.0));
    rig.give(Action::set_memory(1, 32_760.0));
    rig.give(order(0, Order::Start));
    rig.modify_inputs = |inputs| inputs.digital[0] = 1;
    rig.run(1);
    assert_eq!((rig.int("gen.sink"), rig.int("d")), (-32_766, -32_766));
    rig.run(1999);
    assert_eq!((rig.int("d"), rig.int("lamp")), (-12_776, 1), "20000 behind 32760, round");
}

/// Proves: AMK-FGEN-31, AMK-BCOM-35, AMK-BCOM-36
#[test]
fn value_new_takes_the_sequence_and_no_other_bit() {
    let mut rig = generates();
    rig.give(order(0, Order::Start));
    let ba = field(Type::Fgen, "ba");
    let refused = rig.give(with(0, Order::ValueNew, &[(ba, 3)]));
    assert_eq!(rig.answer(refused).expect_err("bit 0").code, Code::AMK_BA_KEPT);
    assert!(rig.refusal(refused).ends_with("3 changes bits that count from START on; 2 would change none of them"));
    let taken = rig.give(with(0, Order::ValueNew, &[(ba, 2)]));
    assert!(rig.was_accepted(taken), "{:?}", rig.answer(taken));
    rig.modify_inputs = |inputs| inputs.digital[0] = 1;
    rig.run(1);
    assert_eq!(rig.int("gen.sink"), 510, "a sequence begins with its velocity");
    let refused = rig.give(with(0, Order::ValueNew, &[(field(Type::Fgen, "cycle_time"), 2)]));
    assert!(
        rig.refusal(refused).ends_with("a call would go 40000 inc at the largest override; up to 32767 is possible")
    );
    let refused = rig.give(with(0, Order::ValueNew, &[(field(Type::Fgen, "cycle_time"), 0)]));
    assert!(rig.refusal(refused).ends_with("0 is no value of it in this `ba`; 1 to 32767 is possible"));
}

/// Its state can also be restored before any START.
///
/// Proves: AMK-BCOM-35, AMK-BCOM-40
#[test]
fn value_new_in_the_cycle_of_start_is_part_of_the_set_that_starts() {
    let mut rig = generates();
    rig.mirror();
    let ba = field(Type::Fgen, "ba");
    let last = rig.give_all(vec![order(0, Order::Start), with(0, Order::ValueNew, &[(ba, 2)])]);
    assert!(rig.was_accepted(last), "{:?}", rig.answer(last));
    rig.modify_inputs = |inputs| inputs.digital[0] = 1;
    rig.run(1);
    assert_eq!(rig.int("gen.sink"), 510, "a sequence begins with its velocity");
    rig.run(1999);
    assert_eq!((rig.int("gen.sink"), rig.int("lamp")), (20_500, 1));
}

/// Proves: AMK-REGL-02, AMK-REGL-03, AMK-REGL-39, AMK-BCOM-37
#[test]
fn a_regulator_runs_a_rotary_axis_and_reset_ends_it() {
    let mut held = slot("held", 0, Type::Regl);
    (held.source, held.sink) = (SourceConfig::Signal("w".into()), SinkConfig::Axis(DISC));
    held.outputs[0] = Some(Line { object: Object::Io(1), inverted: false });
    held.words[1] = Some("d".into());
    for (name, value) in [("switch_mask", 7), ("source_assess", 2), ("kp", 256), ("gain_v", -1000), ("y_max", 400_000)]
    {
        held.values[usize::from(field(Type::Regl, name))] = value;
    }
    let mut rig = Rig::of(cell(vec![held]));
    rig.enable();
    let started = rig.give(order(0, Order::Start));
    assert!(rig.was_accepted(started), "{:?}", rig.answer(started));
    // x is 100 and e is -100, so 100000 of 0.0001 rpm, and the same from w2: 20 rpm of 600 inc/s each.
    rig.give(Action::set_memory(0, 100.0));
    rig.give(Action::set_memory(1, 100_000.0));
    assert_eq!(rig.int("held.sink"), 200_000);
    rig.run(60);
    assert_eq!((rig.real("disc.command.velocity"), rig.int("lamp")), (12_000.0, 0));
    // 500 would be 50 rpm; it is limited to 40, and w2 is added.
    rig.give(Action::set_memory(0, 500.0));
    rig.run(100);
    assert_eq!((rig.int("held.sink"), rig.int("lamp"), rig.real("disc.command.velocity")), (500_000, 1, 30_000.0));
    rig.mirror();
    rig.run(3);
    let refused = rig.give(with(0, Order::ValueNew, &[(field(Type::Regl, "gain_v"), 0)]));
    assert!(
        rig.refusal(refused).ends_with("a gain of 0 lets nothing through; -32768 to -1 and 1 to 32767 are possible")
    );
    rig.give(with(0, Order::ValueNew, &[(field(Type::Regl, "switch_mask"), 4)]));
    assert_eq!((rig.int("held.sink"), rig.int("lamp")), (100_000, 0), "w2 alone");
    rig.give(order(0, Order::Reset));
    assert_eq!((rig.int("held.sink"), rig.int("held.active")), (0, 0));
    rig.run(100);
    assert_eq!((rig.real("disc.command.velocity"), rig.state("disc")), (0.0, "STANDSTILL"));
}

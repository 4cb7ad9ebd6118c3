//! Cycle of the values that slots and axes read from each other.

use super::{Line, Order, SinkConfig, SourceConfig, Type, cell, copy, field, gear, order, slot, with};
use crate::code::Code;
use crate::command::Action;
use crate::machine::tests::rig::{LINE, Rig, X, Y, at};
use crate::object::{Leader, Object};
use crate::table::{Form, Table};
use std::sync::Arc;

fn word(name: &str) -> SourceConfig {
    SourceConfig::Signal(name.into())
}

/// Returns the values that a step of the word `w` causes in `d`, in its cycle and in the next.
fn step(slots: Vec<super::SlotConfig>) -> [i64; 2] {
    let count = slots.len() as u16;
    let mut rig = Rig::of(cell(slots));
    rig.give_all((0..count).map(|slot| order(slot, Order::Start)).collect());
    rig.run(3);
    rig.give(Action::set_memory(0, 7.0));
    let first = rig.int("d");
    rig.run(1);
    [first, rig.int("d")]
}

/// Proves: AMK-GEN-05, AMK-GEN-10, AMK-GEN-O1, AMK-SRC-10, AMK-SNK-06, AMK-CTX-04, AMK-BCOM-08
#[test]
fn a_lower_slot_gives_this_cycles_value_and_a_higher_one_the_last() {
    let first = || copy("a", 0, word("w"), SinkConfig::None);
    let sink = |slot| SourceConfig::Lead(Leader::Sink(slot));
    assert_eq!(step(vec![first(), copy("b", 1, sink(0), SinkConfig::Memory(1))]), [7, 7]);
    // Swapped.
    let last = copy("b", 9, word("w"), SinkConfig::None);
    assert_eq!(step(vec![copy("a", 0, sink(1), SinkConfig::Memory(1)), last]), [0, 7]);
}

/// Proves: AMK-GEN-06, AMK-BCOM-03, AMK-CTX-01
#[test]
fn the_same_holds_through_memory() {
    let write = |slot| copy("a", slot, word("w"), SinkConfig::Memory(2));
    let read = |slot| copy("b", slot, word("l"), SinkConfig::Memory(1));
    assert_eq!(step(vec![write(0), read(1)]), [7, 7]);
    assert_eq!(step(vec![read(0), write(1)]), [0, 7]);
}

/// Proves: AMK-DCOPY-02, AMK-DCOPY-O3
#[test]
fn a_copy_is_of_this_cycle() {
    assert_eq!(step(vec![copy("a", 3, word("w"), SinkConfig::Memory(1))]), [7, 7]);
}

/// Proves: AMK-IMES-21, AMK-INIT-03, AMK-BCOM-10
#[test]
fn a_bit_that_a_lower_slot_writes_is_an_input_of_a_higher_one_in_that_cycle() {
    let bit = |object| Some(Line { object, inverted: false });
    let chained = |first, second| {
        let (mut from, mut to) = (slot("a", first, Type::Ecopy), slot("b", second, Type::Ecopy));
        (from.inputs[0], from.outputs[0]) = (bit(Object::Io(0)), bit(Object::Memory(4)));
        (to.inputs[0], to.sink) = (bit(Object::Memory(4)), SinkConfig::Memory(1));
        to.values = [3, 100, 200].into();
        let mut slots = vec![from, to];
        slots.sort_by_key(|slot| slot.number);
        let mut rig = Rig::of(cell(slots));
        rig.give_all((0..2).map(|slot| order(slot, Order::Start)).collect());
        rig.run(2);
        assert_eq!(rig.int("d"), 100);
        rig.modify_inputs = |inputs| inputs.digital[0] = 1;
        rig.run(1);
        rig.int("d")
    };
    assert_eq!([chained(1, 2), chained(2, 1)], [200, 100]);
}

/// Proves: AMK-SRC-05
#[test]
fn an_actual_position_is_this_cycles_and_a_command_the_last_cycles() {
    let watch = |name, slot, leader, sink| copy(name, slot, SourceConfig::Lead(leader), SinkConfig::Memory(sink));
    let actual = watch("a", 0, Leader::AxisActual(X), 1);
    let command = watch("c", 1, Leader::AxisCommand(X), 2);
    let mut rig = Rig::of(cell(vec![actual, command, gear("g", 2, Leader::AxisActual(X), Y)]));
    rig.enable();
    rig.give(Action::Move(at(X, 20_000.0)));
    rig.run_to("x.command.velocity", 20_000.0);
    rig.run(3);
    rig.give_all((0..3).map(|slot| order(slot, Order::Start)).collect());
    for _ in 0..3 {
        let before = ["x.actual.position", "x.command.position", "y.command.position"].map(|name| rig.int(name));
        rig.run(1);
        let way = rig.int("x.actual.position") - before[0];
        assert_eq!((way, rig.int("d"), rig.int("l")), (20, before[0] + way, before[1]));
        assert_eq!(rig.int("y.command.position"), before[2] + way);
    }
    // A disturbance of the drive is visible in that cycle.
    rig.modify_inputs = |inputs| inputs.drive[0].count += 7;
    let before = rig.int("d");
    rig.run(1);
    assert_eq!((rig.int("d"), rig.int("d") - before), (rig.int("x.actual.position"), 27));
}

/// The position of an axis without a drive is its command, which is calculated after the slots.
#[test]
fn the_actual_position_of_a_virtual_axis_is_the_last_cycles() {
    let watch = copy("a", 0, SourceConfig::Lead(Leader::AxisActual(LINE)), SinkConfig::Memory(1));
    let mut rig = Rig::of(cell(vec![watch]));
    rig.give(Action::Move(at(LINE, 20_000.0)));
    rig.run_to("line.command.velocity", 20_000.0);
    rig.give(order(0, Order::Start));
    let before = rig.int("line.actual.position");
    rig.run(1);
    assert_eq!((rig.int("d"), rig.int("line.actual.position")), (before, before + 20));
}

/// The drive of x lags by the travel of one cycle; compensation makes the command lead by the same amount, or by more.
///
/// Proves: AMK-SIDIFF-12
#[test]
fn compensation_is_not_counted_as_drive_difference() {
    let shown = |sak: i64, [moves, watches]: [u16; 2]| {
        let mut gear = gear("g", moves, Leader::AxisCommand(LINE), X);
        gear.values[usize::from(field(Type::Varsync, "sak"))] = sak;
        let mut watch = slot("s", watches, Type::Sidiff);
        watch.sink = SinkConfig::Memory(1);
        let mut slots = vec![gear, watch];
        slots.sort_by_key(|slot| slot.number);
        let mut rig = Rig::of(cell(slots));
        rig.enable();
        // The second axis of the cell, each value as it is.
        let values =
            [("aw_mask", 2), ("display_aw", 2), ("mean_n", 1)].map(|(name, value)| (field(Type::Sidiff, name), value));
        let (gear, watch) = if moves < watches { (0, 1) } else { (1, 0) };
        rig.give_all(vec![order(gear, Order::Start), with(watch, Order::Start, &values)]);
        rig.give(Action::Move(at(LINE, 20_000.0)));
        rig.run_to("line.command.velocity", 20_000.0);
        rig.run(50);
        let offset = rig.int("g.sink") - rig.int("g.sak_share") - rig.int("x.actual.position");
        assert_eq!((rig.int("x.regulator.error"), rig.int("d")), (20, offset), "sak {sak}");
        // The drive is pushed ahead by 7 inc in addition.
        rig.modify_inputs = |inputs| inputs.drive[0].count += 7;
        rig.run(2);
        assert_eq!(rig.int("d"), offset - 7);
        offset
    };
    for numbers in [[0, 1], [1, 0]] {
        assert_eq!([0, 128, 256].map(|sak| shown(sak, numbers)), [20, 0, -20]);
    }
}

/// AWn is the n-th axis of the cell, which has four here.
#[test]
fn masks_and_numbers_of_axes_that_the_cell_does_not_have_are_refused_in_every_order() {
    let mut rig = Rig::of(cell(vec![slot("s", 0, Type::Sidiff), slot("g", 1, Type::Fgen)]));
    let (mask, shown) = (field(Type::Sidiff, "aw_mask"), field(Type::Sidiff, "display_aw"));
    let started = rig.give(with(0, Order::Start, &[(mask, 15), (shown, 4)]));
    assert!(rig.was_accepted(started), "{:?}", rig.answer(started));
    for order in [Order::ValueNew, Order::Stage] {
        let refused = rig.give(with(0, order, &[(mask, 17)]));
        assert_eq!(rig.answer(refused).expect_err("no fifth axis").code, Code::AMK_NO_AXIS);
        assert_eq!(rig.refusal(refused), "s: aw_mask: 17 has bit 4 for axis 5; the cell has 4 axes");
        let refused = rig.give(with(0, order, &[(shown, 5)]));
        assert_eq!(rig.refusal(refused), "s: display_aw: 5 exceeds the maximum 4");
    }
    assert_eq!(rig.machine.slots()[0].active()[usize::from(mask)], 15);
    assert_eq!(rig.machine.slots()[0].staged()[usize::from(shown)], 4);
    let refused = rig.give(with(1, Order::Stage, &[(field(Type::Fgen, "aw_mask"), 32)]));
    assert_eq!(rig.refusal(refused), "g: aw_mask: 32 has bit 5 for axis 6; the cell has 4 axes");
}

/// The second axis of the cell lags by 20 inc. A loaded table has no effect before VALUE_NEW, and one that the set
/// cannot use is refused.
///
/// Proves: AMK-SIDIFF-07, AMK-CMD-11, AMK-CMD-14
#[test]
fn sidiff_reads_a_loaded_table_again_at_value_new() {
    let table = |words: &[i64]| Arc::new(Table::new(Form::Words, &[], words).expect("words"));
    let limit = |threshold: i64| table(&[0, 0, 0, 0, 0, 0, threshold, 0, 0, 0, 0, 0]);
    let load = |table: Arc<Table>| Action::LoadTable { index: 0, table };
    let mut watch = slot("s", 1, Type::Sidiff);
    watch.tables[0] = Some(0);
    for (name, value) in [("aw_mask", 2), ("mean_n", 1), ("agreements", 1)] {
        watch.values[usize::from(field(Type::Sidiff, name))] = value;
    }
    let mut config = cell(vec![gear("g", 0, Leader::AxisCommand(LINE), X), watch]);
    config.tables[0].table = limit(50);
    let mut rig = Rig::of(config);
    rig.enable();
    rig.give_all(vec![order(0, Order::Start), order(1, Order::Start)]);
    rig.give(Action::Move(at(LINE, 20_000.0)));
    rig.run_to("line.command.velocity", 20_000.0);
    rig.run(50);
    assert_eq!((rig.int("x.regulator.error"), rig.int("s.out2")), (20, 0), "20 is not above 50");
    let loaded = rig.give(load(limit(19)));
    assert!(rig.was_accepted(loaded), "{:?}", rig.answer(loaded));
    rig.run(20);
    assert_eq!(rig.int("s.out2"), 0, "the threshold is still 50");
    // A machine restored from here has the same threshold.
    rig.mirror();
    rig.give(order(1, Order::ValueNew));
    assert_eq!(rig.int("s.out2"), 1, "20 is above 19");
    let refused = rig.give(load(limit(32_768)));
    assert_eq!(rig.answer(refused).expect_err("no threshold").code, Code::AMK_THRESHOLD);
    let refused = rig.give(load(table(&[0; 6])));
    assert_eq!(rig.answer(refused).expect_err("no words for drive 2").code, Code::AMK_TABLE_SHORT);
    assert_eq!(rig.machine.tables()[0], limit(19), "refused changes nothing");
    // In one cycle.
    rig.give_all(vec![load(limit(20)), order(1, Order::ValueNew)]);
    assert_eq!(rig.int("s.out2"), 0, "20 is not above 20");
}

/// A RESET of a speed changes the sink once, and not in the following cycles.
#[test]
fn follower_of_sink_at_rest_stands_still() {
    let mut turn = slot("t", 0, Type::Digdreh);
    turn.inputs[0] = Some(Line { object: Object::Io(0), inverted: true });
    turn.inputs[1] = Some(Line { object: Object::Io(3), inverted: false });
    let mut follow = slot("f", 1, Type::Varsync);
    (follow.source, follow.sink) = (SourceConfig::Lead(Leader::Sink(0)), SinkConfig::Memory(2));
    follow.values[usize::from(field(Type::Varsync, "m1"))] = 10_000;
    let mut rig = Rig::of(cell(vec![turn, follow]));
    rig.give_all(vec![with(0, Order::Start, &[(field(Type::Digdreh, "speed"), 700)]), order(1, Order::Start)]);
    rig.run(1);
    rig.modify_inputs = |inputs| inputs.digital[0] = 1 << 1;
    rig.run(3);
    assert_eq!((rig.int("t.sink"), rig.int("l")), (700, 700));
    rig.give(order(0, Order::Reset));
    assert_eq!((rig.int("t.sink"), rig.int("l")), (0, 0));
    rig.run(3);
    assert_eq!(rig.int("l"), 0);
}

#[test]
fn a_slot_at_rest_shows_its_inputs() {
    let mut idle = slot("e", 0, Type::Ecopy);
    idle.inputs[0] = Some(Line { object: Object::Io(0), inverted: false });
    let mut rig = Rig::of(cell(vec![idle]));
    let mut shown = |bit| {
        rig.plant.set_digital(0, bit);
        rig.run(2);
        rig.int("e.in1")
    };
    assert_eq!([false, true, true, false].map(&mut shown), [0, 1, 1, 0]);
}

#[test]
fn a_function_whose_source_is_lost_is_lost_to_the_axis_that_it_moves() {
    let mut rig = Rig::of(cell(vec![gear("g", 0, Leader::Encoder(0), X)]));
    rig.enable();
    rig.give(order(0, Order::Start));
    rig.run(3);
    assert_eq!(rig.state("x"), "SYNCHRONIZED_MOTION");
    rig.modify_inputs = |inputs| inputs.encoder[0].valid = false;
    rig.run(20);
    assert_eq!((rig.state("x"), rig.int("g.active")), ("ERROR_STOP", 1));
}

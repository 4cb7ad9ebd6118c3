//! Interpolators in slots.

use super::{Line, Order, SinkConfig, SourceConfig, TableConfig, Type, cell, field, order, slot, with};
use crate::code::Code;
use crate::command::Action;
use crate::event::{Event, Kind};
use crate::machine::tests::rig::{LINE, Rig, at};
use crate::object::{Leader, Object};
use crate::table::{Form, Table};
use crate::text::message;
use std::sync::Arc;

fn curve(points: &[i64]) -> Arc<Table> {
    Arc::new(Table::new(Form::Y, &[], points).expect("points"))
}

/// Returns a function that reads one curve of 1000, over the travel of `line`, into the double word.
fn machine(kind: Type, values: &[(&str, i64)]) -> Rig {
    let mut function = slot("f", 0, kind);
    function.source = SourceConfig::Lead(Leader::AxisCommand(LINE));
    if kind == Type::Fipz {
        function.source = SourceConfig::None;
    }
    function.sink = SinkConfig::Memory(1);
    function.inputs[0] = Some(Line { object: Object::Memory(4), inverted: false });
    function.outputs[0] = Some(Line { object: Object::Io(1), inverted: false });
    function.tables[0] = Some(1);
    for (name, value) in values {
        function.values[usize::from(field(kind, name))] = *value;
    }
    let mut config = cell(vec![function]);
    config.tables.push(TableConfig { name: "c".into(), table: curve(&[0, 1000]) });
    Rig::of(config)
}

const FIPW: [(&str, i64); 4] = [("mode", 26), ("mult", 1), ("table_count", 1), ("increments_per_rev", 2000)];
const XFIPW: [(&str, i64); 4] = [("ba", 26), ("mult", 1), ("tables_total", 1), ("incr_per_rev", 2000)];
const FIPZ: [(&str, i64); 4] = [("mode", 16), ("mult", 1), ("table_count", 1), ("cycle_time", 200)];

/// Proves: AMK-FIPW-53, AMK-FIPZ-20, AMK-XFIPW-54
#[test]
fn reset_holds_a_movement_where_it_is() {
    for (kind, values) in [(Type::Fipw, FIPW), (Type::Xfipw, XFIPW), (Type::Fipz, FIPZ)] {
        let mut rig = machine(kind, &values);
        rig.give(Action::Move(at(LINE, 20_000.0)));
        rig.run_to("line.command.velocity", 20_000.0);
        rig.give(order(0, Order::Start));
        assert_eq!((rig.int("d"), rig.int("f.out1")), (0, 1));
        rig.give(Action::set_memory(4, 1.0));
        rig.run(50);
        // 20 inc per cycle of 2000, or 1 ms of 100 ms.
        assert_eq!((rig.int("d"), rig.int("f.out1")), (500, 0), "{kind:?}");
        rig.give(order(0, Order::Reset));
        let held = rig.int("d");
        assert_eq!((held, rig.int("f.active"), rig.int("lamp")), (500, 0, 1), "{kind:?}");
        rig.run(20);
        assert_eq!(rig.int("d"), held);
        // It continues from there.
        rig.give(Action::set_memory(4, 0.0));
        rig.give(order(0, Order::Start));
        rig.give(Action::set_memory(4, 1.0));
        rig.run(100);
        assert_eq!(rig.int("d"), held + 1000);
    }
}

/// Proves: AMK-XFIPW-55, AMK-XFIPW-86, AMK-XFIPW-119
#[test]
fn read_value_finds_a_place_at_rest_alone() {
    let mut rig = machine(Type::Xfipw, &XFIPW);
    let offset = field(Type::Xfipw, "master_offset");
    let found = |rig: &Rig| rig.machine.slots()[0].active()[usize::from(field(Type::Xfipw, "output_value"))];
    let ba = field(Type::Xfipw, "ba");
    let read = rig.give(with(0, Order::ReadValue, &[(offset, 500), (ba, 2)]));
    assert!(rig.was_accepted(read));
    assert_eq!(found(&rig), 250);
    let read = rig.give(with(0, Order::ReadValue, &[(offset, -500)]));
    assert!(rig.was_accepted(read));
    assert_eq!(found(&rig), -250);
    // An invalid set finds nothing, and is not stored.
    let read = rig.give(with(0, Order::ReadValue, &[(ba, 1)]));
    assert_eq!(rig.answer(read).expect_err("no mode").code, Code::AMK_NO_MODE);
    let modes = "2, 3, 4, 5, 26, 27, 82, 83, 84, 85, 98, 99, 100, 101, 132, 133 are allowed";
    assert_eq!(rig.refusal(read), format!("f: ba: no mode has number 1; {modes}"));
    assert_eq!(rig.machine.slots()[0].staged()[usize::from(ba)], 2);
    let started = rig.give(with(0, Order::Start, &[(offset, 0)]));
    assert!(rig.was_accepted(started));
    for order in [Order::ReadValue, Order::Start] {
        let again = rig.give(with(0, order, &[]));
        assert_eq!(rig.answer(again).expect_err("it is started").code, Code::FUNCTION_ACTIVE);
    }
}

/// 1000 over 2000 inc: half of master_offset. The signal shows the last answer, independent of later function calls.
/// Proves: AMK-XFIPW-44, AMK-XFIPW-88, AMK-XFIPW-119
#[test]
fn answer_of_read_value_is_a_signal_and_an_event() {
    let mut rig = machine(Type::Xfipw, &[("ba", 2), ("mult", 1), ("tables_total", 1), ("incr_per_rev", 2000)]);
    let offset = field(Type::Xfipw, "master_offset");
    let answers = |rig: &Rig, sequence: u64| {
        let of_it = |event: &&Event| event.kind == Kind::Parameter && event.command == sequence;
        let told = rig.events.iter().filter(of_it);
        let told = told.map(|event| (event.position.floor(), message(event, rig.machine.config())));
        told.collect::<Vec<_>>()
    };
    assert_eq!(rig.int("f.output_value"), 0);
    for (place, value) in [(500, 250), (-500, -250)] {
        let read = rig.give(with(0, Order::ReadValue, &[(offset, place)]));
        assert_eq!(rig.int("f.output_value"), value);
        assert_eq!(answers(&rig, read), [(value, format!("f: READ_VALUE: output_value is {value} inc"))]);
    }
    let odd = rig.give(with(0, Order::ReadValue, &[(field(Type::Xfipw, "ba"), 1)]));
    assert!(rig.answer(odd).is_err() && answers(&rig, odd).is_empty());
    assert_eq!((rig.int("f.output_value"), rig.int("f.error")), (-250, i64::from(Code::AMK_NO_MODE.0)));
    rig.give(with(0, Order::Start, &[(offset, 0)]));
    rig.run(3);
    assert_eq!((rig.int("f.active"), rig.int("f.output_value")), (1, -250));
    rig.mirror();
    rig.give(order(0, Order::Reset));
    rig.run(3);
    assert_eq!((rig.int("f.active"), rig.int("f.output_value")), (0, -250));
    // With other types READ_VALUE finds nothing.
    let mut rig = machine(Type::Fipw, &FIPW);
    let read = rig.give(order(0, Order::ReadValue));
    assert!(rig.was_accepted(read) && answers(&rig, read).is_empty());
    assert!(rig.machine.directory().find("f.output_value").is_none());
}

/// AMK-FIPW-01: a table lasts 50 to 32767 inc.
#[test]
fn out_of_range_value_is_reported_with_its_bound() {
    let mut rig = machine(Type::Fipw, &FIPW);
    let rev = field(Type::Fipw, "increments_per_rev");
    let refused = rig.give(with(0, Order::Start, &[(rev, 49)]));
    assert_eq!(rig.answer(refused).expect_err("too few").code, Code::AMK_BEYOND);
    assert_eq!(rig.refusal(refused), "f: increments_per_rev: 49 is below the minimum 50");
    let mut rig = machine(Type::Xfipw, &[("ba", 2), ("mult", 1), ("tables_total", 1), ("incr_per_rev", 100)]);
    let offset = field(Type::Xfipw, "master_offset");
    let refused = rig.give(with(0, Order::Start, &[(offset, 100)]));
    assert_eq!(rig.refusal(refused), "f: master_offset: 100 exceeds the maximum 99");
    let refused = rig.give(with(0, Order::Start, &[(offset, -100)]));
    assert_eq!(rig.refusal(refused), "f: master_offset: -100 is below the minimum -99");
}

#[test]
fn unknown_mode_is_reported_with_allowed_modes() {
    let mut rig = machine(Type::Fipw, &FIPW);
    let refused = rig.give(with(0, Order::Start, &[(field(Type::Fipw, "mode"), 3)]));
    assert_eq!(rig.refusal(refused), "f: mode: no mode has number 3; 2, 4, 26, 82, 84, 98, 100, 132 are allowed");
}

/// Proves: AMK-XFIPW-06, AMK-XFIPW-14, AMK-XFIPW-15
#[test]
fn a_table_that_is_in_use_stays_and_the_next_start_takes_the_new_one() {
    let mut rig = machine(Type::Xfipw, &[("ba", 2), ("mult", 1), ("tables_total", 1), ("incr_per_rev", 100)]);
    let load = || Action::LoadTable { index: 1, table: curve(&[0, 300]) };
    rig.give(Action::Move(at(LINE, 20_000.0)));
    rig.run_to("line.command.velocity", 20_000.0);
    rig.give(order(0, Order::Start));
    rig.run(5);
    assert_eq!(rig.int("d"), 1000, "20 inc a cycle: five cycles are a turn");
    let refused = rig.give(load());
    assert_eq!(rig.answer(refused).expect_err("in use").code, Code::FUNCTION_USES_TABLE);
    rig.give(order(0, Order::Reset));
    let (held, loaded) = (rig.int("d"), rig.give(load()));
    assert!(rig.was_accepted(loaded));
    rig.give(order(0, Order::Start));
    rig.run(5);
    assert_eq!(rig.int("d"), held + 300);
    // A table without a curve can be loaded, but START refuses it.
    rig.give(order(0, Order::Reset));
    let odd = rig.give(Action::LoadTable { index: 1, table: curve(&[7, 300]) });
    assert!(rig.was_accepted(odd));
    let started = rig.give(order(0, Order::Start));
    assert_eq!(rig.answer(started).expect_err("no curve").code, Code::AMK_CURVE_FIRST);
}

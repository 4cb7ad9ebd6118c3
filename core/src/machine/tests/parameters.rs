use super::rig::{Rig, X, config, to};
use crate::code::Code;
use crate::command::{Action, Move};
use crate::config::{IoConfig, IoKind, MemoryConfig, MemoryKind};
use crate::drive::{Edge, ForeignEmergency, Latch, NodeChange, NodeNotice};
use crate::event::{Kind, Number, Severity};
use crate::object::Object;
use crate::parameter::{Change, Row, Value};
use crate::position::Position;

fn change(key: &str, value: Value) -> Change {
    Change { axis: X, row: Row::find(key).unwrap().0, value }
}

fn set(rig: &mut Rig, changes: &[Change]) -> u64 {
    rig.give(Action::SetParameters(changes.into()))
}

#[test]
fn a_set_is_checked_whole_and_changes_all_or_nothing() {
    let mut rig = Rig::enabled();
    let before = *rig.machine.parameters(X).unwrap();
    let bad = set(&mut rig, &[change("max_velocity", Value::Real(5e4)), change("error_reaction", Value::Int(6))]);
    assert_eq!(rig.refusal(bad), "x: error_reaction is 6; 0 to 5 is allowed");
    let contradiction =
        set(&mut rig, &[change("min_position", Value::Int(10)), change("max_position", Value::Int(10))]);
    assert_eq!(rig.refusal(contradiction), "x: min_position 0.01 mm must be below max_position 0.01 mm");
    assert_eq!(rig.machine.parameters(X), Some(&before));
    // Each alone would conflict with the previous value of the other: as a set they agree.
    let good = set(&mut rig, &[change("min_position", Value::Int(100)), change("max_position", Value::Int(200))]);
    assert!(rig.was_accepted(good));
    let again = set(&mut rig, &[change("min_position", Value::Int(300)), change("max_position", Value::Int(400))]);
    assert!(rig.was_accepted(again));
    let told = rig.events.iter().filter(|event| event.kind == Kind::Parameter && event.command == again).count();
    assert_eq!(told, 2);
    let unset = set(&mut rig, &[change("min_position", Value::Unset)]);
    assert!(rig.was_accepted(unset));
    assert_eq!(rig.machine.parameters(X).unwrap().min_position, None);
}

#[test]
fn a_running_motion_keeps_its_velocity_and_the_next_one_takes_the_new() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(Move { velocity: 80_000.0, ..to(X, 100_000) }));
    rig.run(300);
    set(&mut rig, &[change("max_velocity", Value::Real(10_000.0))]);
    rig.run(10);
    assert_eq!(rig.real("x.command.velocity"), 80_000.0);
    let again = rig.give(Action::Move(Move { velocity: 80_000.0, ..to(X, 0) }));
    assert!(rig.refusal(again).contains("max_velocity 10 mm/s"));
}

#[test]
fn limits_that_would_leave_out_the_active_target_are_refused() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(to(X, 50_000)));
    let refused = set(&mut rig, &[change("max_position", Value::Int(40_000))]);
    assert_eq!(rig.refusal(refused), "x: max_position 40 mm would leave out 50 mm, which the motion under way reaches");
}

#[test]
fn memory_saturates_at_its_type() {
    let mut config = config(0);
    let cell = |name: &str, kind, initial| MemoryConfig { name: name.into(), kind, initial };
    config.memory =
        vec![cell("a", MemoryKind::I16, 500.0), cell("b", MemoryKind::Bit, 0.0), cell("c", MemoryKind::F64, 0.5)];
    let mut rig = Rig::of(config);
    assert_eq!((rig.int("a"), rig.real("c")), (500, 0.5));
    rig.give_all(vec![Action::set_memory(0, -1e9), Action::set_memory(1, 7.0), Action::set_memory(2, -2.25)]);
    assert_eq!((rig.int("a"), rig.int("b"), rig.real("c")), (-32_768, 1, -2.25));
    let bad = rig.give(Action::set_memory(2, f64::NAN));
    assert!(rig.refusal(bad).contains("NaN"));
}

#[test]
fn a_latch_of_an_axis_lies_on_the_line_between_two_cycles() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(super::rig::at(X, 50_000.0)));
    rig.run(300);
    let latch = Latch { object: Object::Axis(X), edge: Edge::Rising, age_ns: Some(250_000), position: None };
    assert!(rig.plant.add_latch(latch));
    rig.run(1);
    // 50 inc per cycle: a quarter of a cycle is 12.5 inc.
    let expected = Position::whole(rig.int("x.actual.position")) - Position::from_f64(12.5);
    assert_eq!((rig.int("x.latch.position"), rig.int("x.latch.count")), (expected.floor(), 1));
    assert_eq!(rig.real("x.latch.fraction"), 0.5);
    let event = rig.events.iter().find(|event| event.kind == Kind::Latch).unwrap();
    assert_eq!((event.age_ns, event.position), (250_000, expected));
}

#[test]
fn lost_latches_are_reported() {
    let mut rig = Rig::new();
    let latch = Latch { object: Object::Axis(X), edge: Edge::Falling, age_ns: Some(0), position: None };
    let taken = (0..20).filter(|_| rig.plant.add_latch(latch)).count();
    assert_eq!(taken, 16);
    let mut inputs = rig.machine.inputs();
    inputs.latches_lost = 4;
    let mut outputs = rig.machine.outputs();
    rig.machine.cycle(&inputs, Default::default(), &mut outputs);
    let event = rig.machine.events().iter().find(|event| event.kind == Kind::Warning).unwrap();
    let sentence = crate::text::message(event, rig.machine.config());
    assert_eq!(sentence, "machine: 4 latches of this cycle had no room");
}

#[test]
fn a_note_is_answered_by_its_warning_alone() {
    let mut rig = Rig::new();
    for (code, number, severity) in [
        (Code::RECORD_LOST, 12, Severity::Warn),
        (Code::RECORD_FAILED, 28, Severity::Error),
        (Code::FLIGHT_FAILED, 2, Severity::Error),
        (Code::CLOCK_STEPPED, -3_600_000_000_001, Severity::Warn),
    ] {
        let sequence = rig.give(Action::Note { code, number });
        let answers: Vec<_> = rig.events.iter().filter(|event| event.command == sequence).collect();
        assert_eq!(answers.len(), 1, "{answers:?}");
        let told = (answers[0].kind, answers[0].severity, answers[0].code, answers[0].asked, answers[0].source);
        assert_eq!(told, (Kind::Warning, severity, code, Number::Count(number), Object::Machine));
    }
}

#[test]
fn a_note_of_a_bus_names_axis_and_node_and_says_how_much_it_matters() {
    let mut rig = Rig::new();
    let changed = |axis, change| {
        let notice = NodeNotice { axis, node: 3, change };
        Action::Note { code: Code::NODE_CHANGED, number: notice.to_number() }
    };
    let foreign = |code, register| {
        let message = ForeignEmergency { node: 9, code, register };
        Action::Note { code: Code::FOREIGN_EMERGENCY, number: message.to_number() }
    };
    for (note, severity, sentence) in [
        (changed(Some(X), NodeChange::Booted), Severity::Warn, "x: node 3: it has booted"),
        (changed(Some(X), NodeChange::Ready), Severity::Info, "x: node 3: it is configured and operational"),
        (changed(Some(99), NodeChange::Silent), Severity::Warn, "machine: node 3: it is silent: no sign of life"),
        (
            changed(Some(X), NodeChange::Unwatched),
            Severity::Warn,
            "x: node 3: it sends no heartbeat (1017h), so that nothing watches it",
        ),
        (changed(None, NodeChange::Back), Severity::Warn, "machine: node 3: it was silent, and is back"),
        (
            foreign(0x8130, 0x11),
            Severity::Warn,
            "machine: node 9, no drive of the cell, sends emergency 8130h (life guard or heartbeat), register 11h (generic, communication)",
        ),
        (
            foreign(0, 0),
            Severity::Info,
            "machine: node 9, no drive of the cell, sends emergency 0000h (no error), register 00h",
        ),
    ] {
        let sequence = rig.give(note);
        let answers: Vec<_> = rig.events.iter().filter(|event| event.command == sequence).collect();
        let told: Vec<_> = answers.iter().map(|event| crate::text::message(event, rig.machine.config())).collect();
        assert_eq!((told, answers[0].severity), (vec![sentence.to_owned()], severity));
    }
}

#[test]
fn inputs_show_on_the_board() {
    let mut config = config(0);
    let input = |name: &str, kind| IoConfig { name: name.into(), kind, latch: false };
    config.io = vec![
        input("start", IoKind::DigitalInput),
        input("lamp", IoKind::DigitalOutput),
        input("stop", IoKind::DigitalInput),
        input("feed", IoKind::AnalogInput),
    ];
    let mut rig = Rig::of(config);
    rig.plant.set_digital(1, true);
    rig.plant.set_analog(0, -2.5);
    rig.run(1);
    assert_eq!((rig.int("start"), rig.int("stop"), rig.int("lamp"), rig.real("feed")), (0, 1, 0, -2.5));
}

/// in a set the direction polarity is applied first, in any order.
#[test]
fn set_is_independent_of_position_of_posdrct() {
    let int = |key, value| change(key, Value::Int(value));
    let changes = [int("max_position", 9_000), int("posdrct", -1), int("neglimit", -7_000), int("swneglimact", 1)];
    let [native, sense, limit, switch] = changes;
    for set_of in [[sense, limit, switch], [limit, sense, switch], [limit, switch, sense], [switch, limit, sense]] {
        let mut rig = Rig::new();
        let sequence = set(&mut rig, &set_of);
        assert!(rig.was_accepted(sequence));
        let now = rig.machine.parameters(X).unwrap();
        assert_eq!((now.min_position, now.max_position), (None, Some(7_000)));
    }
    for set_of in [[sense, native], [native, sense]] {
        let mut rig = Rig::new();
        set(&mut rig, &set_of);
        assert_eq!(rig.machine.parameters(X).unwrap().max_position, Some(9_000));
    }
}

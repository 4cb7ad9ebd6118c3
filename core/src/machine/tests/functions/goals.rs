//! Goals of functions: an order from its acceptance to its end.

use super::positions::{E1, E2, indexer, input};
use super::*;
use crate::command::RunFunction;
use crate::event::Event;

fn run(slot: u16, values: &[(u16, i64)]) -> Action {
    Action::RunFunction(RunFunction { slot, values: values.into() })
}

fn travel(by: i64) -> (u16, i64) {
    (field(Type::Epos, "travel"), by)
}

/// Returns a rig with the indexer of x, which is on.
fn indexed(values: &[(&str, i64)]) -> Rig {
    let mut rig = Rig::of(cell(vec![indexer(values)]));
    rig.enable();
    rig
}

/// Returns the end of a goal, which must occur once.
#[track_caller]
fn end(rig: &Rig, goal: u64) -> Event {
    let done = rig.done(goal);
    assert_eq!(done.len(), 1, "{done:?}");
    done[0]
}

#[track_caller]
fn sentence(rig: &Rig, event: &Event) -> String {
    crate::text::message(event, rig.machine.config())
}

/// 64 inc are 4 + 8 + 12 + 16 + 12 + 8 + 4, starting in the cycle after START.
#[test]
fn a_goal_starts_its_function_and_succeeds_where_its_order_ends() {
    let mut rig = indexed(&[]);
    let goal = rig.give(run(0, &[travel(64)]));
    assert!(rig.was_accepted(goal), "{:?}", rig.answer(goal));
    assert_eq!((rig.int("pos.active"), rig.int("pos.sink"), rig.int("lamp")), (1, 0, 1));
    rig.run(1);
    assert_eq!((rig.int("pos.sink"), rig.int("lamp"), rig.int("pos.in1")), (4, 0, 0), "the line keeps its level");
    rig.run(2);
    // A machine restored from here gives the same results.
    rig.mirror();
    rig.run(3);
    assert_eq!((rig.done(goal).len(), rig.int("lamp")), (0, 0));
    rig.run(1);
    let done = end(&rig, goal);
    assert_eq!((done.code, done.source, done.position.floor()), (Code::NONE, Object::Function(0), 64));
    assert_eq!((rig.int("lamp"), rig.int("x.command.position")), (1, 64));
    // The next goal is a VALUE_NEW of a started function, and starts in its cycle.
    let goal = rig.give(run(0, &[travel(-64)]));
    assert_eq!((rig.int("pos.sink"), rig.int("lamp")), (60, 0));
    rig.run(6);
    assert_eq!((end(&rig, goal).code, rig.int("x.command.position")), (Code::NONE, 0));
    // Without values it repeats the last set; a line that is constantly 1 does not prevent the start of a goal.
    rig.modify_inputs = input(E2);
    rig.run(1);
    let goal = rig.give(run(0, &[]));
    rig.run(6);
    assert_eq!((end(&rig, goal).code, rig.int("x.command.position")), (Code::NONE, -64));
}

#[test]
fn invalid_goal_is_refused_and_changes_nothing() {
    let copied = copy("c", 1, SourceConfig::Signal("l".into()), SinkConfig::None);
    let mut rig = Rig::of(cell(vec![indexer(&[]), copied]));
    let refused = |rig: &mut Rig, action: Action, code: Code, end: &str| {
        let given = rig.give(action);
        assert_eq!(rig.answer(given).expect_err("refused").code, code);
        let told = rig.refusal(given);
        assert!(told.ends_with(end), "{told}");
    };
    refused(&mut rig, run(0, &[]), Code::NOT_ENABLED, "x: the axis is not enabled; enable it first");
    rig.enable();
    refused(
        &mut rig,
        run(1, &[]),
        Code::FUNCTION_NO_GOALS,
        "c: run_function gives an order that ends; its type has none",
    );
    refused(&mut rig, run(7, &[]), Code::BAD_REQUEST, "");
    let staged = rig.machine.slots()[0].staged().to_vec();
    let bad = [travel(9), (field(Type::Epos, "acceleration"), 0)];
    refused(
        &mut rig,
        run(0, &bad),
        Code::FUNCTION_RANGE,
        "acceleration is 0; 1 to 100000000 is allowed (unit: 0.001 rev/s^2)",
    );
    assert_eq!((rig.machine.slots()[0].staged(), rig.int("pos.active")), (&staged[..], 0));
    let goal = rig.give(run(0, &[]));
    rig.run(20);
    let busy = "an order is under way; it has to end first, or its goal to be cancelled";
    refused(&mut rig, run(0, &[travel(5)]), Code::FUNCTION_BUSY, busy);
    rig.run(700);
    assert_eq!((end(&rig, goal).code, rig.int("pos.sink")), (Code::NONE, 20_000));
    // An order of its input.
    rig.modify_inputs = input(E1);
    rig.run(20);
    refused(&mut rig, run(0, &[]), Code::FUNCTION_BUSY, busy);
    // Another command controls the axis.
    rig.run(700);
    rig.give(Action::Move(to(X, 100)));
    rig.run(2);
    let left = "something else moves or stops its axis, or has switched it off; RESET and START give it back";
    refused(&mut rig, run(0, &[]), Code::FUNCTION_LEFT, left);
}

/// From 33.333 inc: 17.3, 1.3, rest. The remaining travel is dropped.
#[test]
fn a_cancelled_goal_stops_and_the_next_one_is_a_new_order() {
    let mut rig = indexed(&[]);
    let goal = rig.give(run(0, &[]));
    rig.run(100);
    let before = rig.int("pos.sink");
    let cancel = rig.give(Action::Cancel { goal });
    assert!(rig.was_accepted(cancel));
    rig.mirror();
    rig.run(2);
    assert_eq!(rig.done(goal).len(), 0);
    rig.run(1);
    assert_eq!((end(&rig, goal).code, rig.int("lamp"), rig.int("pos.remaining")), (Code::CANCELLED, 1, 0));
    let here = rig.int("pos.sink");
    // The cycle of the command still moved.
    assert!((before + 33 + 18..=before + 34 + 20).contains(&here), "{before} {here}");
    let goal = rig.give(run(0, &[travel(64)]));
    rig.run(10);
    assert_eq!((end(&rig, goal).code, rig.int("x.command.position")), (Code::NONE, here + 64));
    let unknown = rig.give(Action::Cancel { goal });
    assert_eq!(rig.answer(unknown).expect_err("it has ended").code, Code::UNKNOWN_GOAL);
}

/// Cancelled in its own cycle, before its first call.
#[test]
fn a_goal_that_is_cancelled_in_its_cycle_moves_nothing() {
    let mut rig = indexed(&[]);
    let first = rig.give(order(0, Order::Start));
    let last = rig.give_all(vec![order(0, Order::Reset), run(0, &[travel(9)]), Action::Cancel { goal: first + 2 }]);
    assert!(rig.was_accepted(last) && rig.was_accepted(last - 1));
    rig.run(20);
    assert_eq!((end(&rig, last - 1).code, rig.int("pos.sink"), rig.int("lamp")), (Code::CANCELLED, 0, 1));
}

#[test]
fn an_input_that_stops_an_order_ends_its_goal_with_what_is_left() {
    let mut rig = indexed(&[]);
    let goal = rig.give(run(0, &[]));
    rig.run(100);
    rig.modify_inputs = input(E2);
    rig.run(3);
    let stopped = end(&rig, goal);
    let here = rig.int("pos.sink");
    assert_eq!(stopped.code, Code::FUNCTION_STOPPED);
    assert_eq!(sentence(&rig, &stopped), format!("pos: E2 has stopped its order, with {} inc left", 20_000 - here));
    // The order itself may be continued by its input.
    assert_eq!(rig.int("pos.remaining"), 20_000 - here);
    rig.modify_inputs = input(E1);
    rig.run(700);
    assert_eq!(rig.int("pos.sink"), 20_000);
}

#[test]
fn reset_error_or_takeover_of_axis_ends_goal() {
    let mut rig = indexed(&[]);
    let goal = rig.give(run(0, &[]));
    rig.run(50);
    rig.give(order(0, Order::Reset));
    let reset = end(&rig, goal);
    assert_eq!((reset.code, rig.int("pos.active")), (Code::FUNCTION_RESET, 0));
    let left = 20_000 - rig.int("pos.sink");
    assert_eq!(sentence(&rig, &reset), format!("pos: it was reset, with {left} inc left"));
    for (take, code) in [
        (Action::Halt(AxisSet::one(X)), Code::FUNCTION_LEFT),
        (Action::Move(to(X, 0)), Code::FUNCTION_LEFT),
        (Action::Disable(AxisSet::one(X)), Code::FUNCTION_LEFT),
        (Action::Deactivate, Code::FUNCTION_LEFT),
    ] {
        let mut rig = indexed(&[]);
        let goal = rig.give(run(0, &[]));
        rig.run(50);
        rig.give(take.clone());
        rig.run(1);
        assert_eq!(end(&rig, goal).code, code, "{take:?}");
        // The order ends with the goal.
        let here = rig.int("pos.sink");
        rig.run(50);
        assert_eq!((rig.int("pos.sink"), rig.int("pos.active"), rig.int("lamp")), (here, 1, 1));
    }
    for reaction in [OnAxisError::Run, OnAxisError::Reset] {
        let slot = SlotConfig { on_axis_error: reaction, ..indexer(&[]) };
        let mut rig = Rig::of(cell(vec![slot]));
        rig.enable();
        let goal = rig.give(run(0, &[]));
        rig.run(50);
        rig.plant.drive(0).expect("the drive of x").inject_fault(0x7500);
        rig.run(5);
        let failed = end(&rig, goal);
        assert_eq!(rig.state("x"), "ERROR_STOP");
        match reaction {
            OnAxisError::Run => {
                assert_eq!(i64::from(failed.code.0), rig.int("x.error"));
                assert!(sentence(&rig, &failed).starts_with(&format!("pos: its axis has error {}: ", failed.code.0)));
            }
            OnAxisError::Reset => assert_eq!(failed.code, Code::FUNCTION_RESET),
        }
    }
}

/// A goal over multiples runs until it is cancelled, like an order by a constant E1.
#[test]
fn a_goal_over_multiples_runs_until_it_is_cancelled() {
    let mut rig = indexed(&[("ba", 16), ("travel", 1000)]);
    let goal = rig.give(run(0, &[]));
    rig.run(1000);
    assert_eq!((rig.int("bit"), rig.done(goal).len()), (1, 0));
    assert!(rig.int("pos.sink") > 30_000);
    rig.give(Action::Cancel { goal });
    rig.run(4);
    assert_eq!(end(&rig, goal).code, Code::CANCELLED);
}

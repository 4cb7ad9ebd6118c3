use super::*;

const KEEP: Duration = Duration::from_secs(10);
const NONE: i8 = 0;
const UNKNOWN_GOAL: i8 = 2;
const TERMINATED: i8 = 3;

/// Results are texts, result requests are numbers.
type Tested = Goals<&'static str, u32>;

fn id(n: u8) -> GoalId {
    GoalId([n; 16])
}

fn at(sec: i32, nanosec: u32) -> Stamp {
    Stamp { sec, nanosec }
}

/// Returns the origin of a request that was written and received at `ns`.
fn sent(ns: u64) -> Origin {
    Origin::of(1, Some(ns), ns)
}

fn goals() -> (Tested, Instant) {
    (Goals::new(KEEP, 4), Instant::now())
}

/// Returns goals of which goal n was accepted at n seconds and is executing.
fn executing(ns: &[u8]) -> (Tested, Instant) {
    let (mut goals, now) = goals();
    for n in ns {
        assert!(goals.offer(id(*n), sent(0), now));
        goals.accept(id(*n), at(i32::from(*n), 0));
        assert!(goals.execute(id(*n)));
    }
    (goals, now)
}

fn status(goals: &Tested, n: u8) -> Option<Status> {
    goals.shown().find(|shown| shown.id == id(n)).map(|shown| shown.status)
}

fn selected(goals: &mut Tested, goal: GoalId, stamp: Stamp, now: Instant) -> (i8, Vec<GoalId>) {
    let selection = goals.select(goal, stamp, sent(1), now);
    (selection.code, selection.open)
}

#[test]
fn numbers_are_those_of_action_msgs() {
    // action_msgs/msg/GoalStatus
    let all =
        [Status::Accepted, Status::Executing, Status::Canceling, Status::Succeeded, Status::Canceled, Status::Aborted];
    assert_eq!(all.map(|status| status as i8), [1, 2, 3, 4, 5, 6]);
    assert_eq!(GoalId(std::array::from_fn(|i| i as u8)).to_string(), "00010203-0405-0607-0809-0a0b0c0d0e0f");
}

#[test]
fn a_goal_goes_from_accepted_to_succeeded() {
    let (mut goals, now) = goals();
    assert!(goals.offer(id(1), sent(0), now));
    let canceled = goals.accept(id(1), at(5, 6));
    assert_eq!(
        goals.shown().collect::<Vec<_>>(),
        [GoalStatusEntry { id: id(1), stamp: at(5, 6), status: Status::Accepted }]
    );
    assert!(goals.execute(id(1)));
    assert!(!goals.execute(id(1)), "it is being done already");
    assert_eq!(goals.request_result(id(1), 70, now), ResultAnswer::Waits);
    assert_eq!(goals.request_result(id(1), 71, now), ResultAnswer::Waits);
    assert_eq!(goals.end(id(1), End::Succeeded, "there", now), Some((Status::Succeeded, vec![70, 71])));
    assert_eq!(goals.end(id(1), End::Aborted, "again", now), None, "it ends once");
    assert_eq!(goals.request_result(id(1), 72, now), ResultAnswer::Ended(72, Status::Succeeded, "there"));
    assert_eq!(goals.request_result(id(1), 73, now), ResultAnswer::Ended(73, Status::Succeeded, "there"));
    assert!(!*canceled.borrow());
}

#[test]
fn an_id_is_used_once() {
    let (mut goals, now) = goals();
    assert!(goals.offer(id(1), sent(0), now));
    assert!(!goals.offer(id(1), sent(0), now), "while it is being decided");
    goals.withdraw(id(1));
    assert_eq!(goals.request_result(id(1), 1, now), ResultAnswer::Unknown(1), "a rejected goal is not known");
    assert!(goals.offer(id(1), sent(0), now), "a rejected goal may be sent again");
    goals.accept(id(1), at(1, 0));
    assert!(!goals.offer(id(1), sent(0), now), "while it is there");
    goals.end(id(1), End::Aborted, "", now);
    assert!(!goals.offer(id(1), sent(0), now), "after its end");
    assert!(goals.offer(id(1), sent(0), now + KEEP), "until it is forgotten");
}

#[test]
fn results_expire_after_timeout() {
    let (mut goals, now) = executing(&[1, 2]);
    goals.end(id(1), End::Succeeded, "one", now);
    let before = now + KEEP - Duration::from_nanos(1);
    assert_eq!(goals.request_result(id(1), 1, before), ResultAnswer::Ended(1, Status::Succeeded, "one"));
    assert_eq!(goals.request_result(id(1), 2, now + KEEP), ResultAnswer::Unknown(2));
    assert_eq!(
        goals.request_result(id(2), 3, now + KEEP * 1000),
        ResultAnswer::Waits,
        "what has not ended is never forgotten"
    );
    assert_eq!(goals.shown().count(), 1);
}

#[test]
fn oldest_ended_goal_is_removed_above_maximum() {
    let (mut goals, now) = executing(&[1, 2, 3, 4, 5, 6]);
    let later = |s| now + Duration::from_secs(s);
    for (after, n) in [2u8, 1, 3, 4].iter().enumerate() {
        goals.end(id(*n), End::Succeeded, "", later(after as u64));
    }
    assert_eq!(goals.shown().count(), 6, "four may be kept");
    goals.end(id(5), End::Succeeded, "", later(5));
    assert_eq!(status(&goals, 2), None);
    assert_eq!((status(&goals, 1), status(&goals, 6)), (Some(Status::Succeeded), Some(Status::Executing)));
}

#[test]
fn a_canceled_goal_may_still_end_in_any_way() {
    let ways =
        [(End::Canceled, Status::Canceled), (End::Succeeded, Status::Succeeded), (End::Aborted, Status::Aborted)];
    for (end, ended) in ways {
        let (mut goals, now) = goals();
        goals.offer(id(1), sent(0), now);
        let canceled = goals.accept(id(1), at(1, 0));
        let canceling = goals.cancel(&[id(1)]);
        assert_eq!(canceling, [GoalStatusEntry { id: id(1), stamp: at(1, 0), status: Status::Canceling }]);
        assert!(*canceled.borrow());
        assert!(!goals.execute(id(1)), "it does not go back");
        assert_eq!(goals.end(id(1), end, "", now), Some((ended, vec![])));
    }
}

#[test]
fn goal_without_cancel_request_does_not_end_canceled() {
    let (mut goals, now) = executing(&[1]);
    assert_eq!(goals.end(id(1), End::Canceled, "", now), Some((Status::Aborted, vec![])));
    assert_eq!(goals.cancel(&[id(1)]), [], "and an ended goal is not canceled");
}

#[test]
fn cancel_by_id() {
    let (mut goals, now) = executing(&[1, 2, 3]);
    goals.end(id(3), End::Succeeded, "", now);
    assert_eq!(selected(&mut goals, id(2), Stamp::default(), now), (NONE, vec![id(2)]));
    assert_eq!(selected(&mut goals, id(9), Stamp::default(), now), (UNKNOWN_GOAL, vec![]));
    assert_eq!(selected(&mut goals, id(3), Stamp::default(), now), (TERMINATED, vec![]));
    assert_eq!(selected(&mut goals, id(3), Stamp::default(), now + KEEP), (UNKNOWN_GOAL, vec![]));
    goals.cancel(&[id(2)]);
    let again = goals.select(id(2), Stamp::default(), sent(1), now);
    assert_eq!(again, Selection { code: NONE, open: vec![], canceling: vec![id(2)] });
}

#[test]
fn cancel_by_time_includes_the_time_itself() {
    let (mut goals, now) = executing(&[1, 2, 3]);
    let none = GoalId::default();
    assert_eq!(selected(&mut goals, none, at(2, 0), now), (NONE, vec![id(1), id(2)]));
    assert_eq!(selected(&mut goals, none, at(1, 999_999_999), now), (NONE, vec![id(1)]));
    assert_eq!(selected(&mut goals, none, at(0, 1), now), (NONE, vec![]));
}

#[test]
fn cancel_by_id_and_time_selects_that_goal_and_older_ones() {
    let (mut goals, now) = executing(&[1, 2, 3, 4]);
    goals.end(id(1), End::Succeeded, "", now);
    assert_eq!(selected(&mut goals, id(4), at(2, 0), now), (NONE, vec![id(2), id(4)]));
    assert_eq!(selected(&mut goals, id(9), at(2, 0), now), (NONE, vec![id(2)]));
}

#[test]
fn oldest_result_request_is_dropped_above_maximum() {
    let (mut goals, now) = executing(&[1]);
    for asker in 0..1000 {
        assert_eq!(goals.request_result(id(1), asker, now), ResultAnswer::Waits);
    }
    let (_, waiting) = goals.end(id(1), End::Succeeded, "", now).unwrap();
    assert_eq!(waiting, (744..1000).collect::<Vec<u32>>());
}

#[test]
fn cancel_all() {
    let (mut goals, now) = executing(&[1, 2, 3]);
    goals.end(id(2), End::Succeeded, "", now);
    assert_eq!(selected(&mut goals, GoalId::default(), Stamp::default(), now), (NONE, vec![id(1), id(3)]));
    let (mut none, now) = executing(&[]);
    assert_eq!(selected(&mut none, GoalId::default(), Stamp::default(), now), (NONE, vec![]));
}

/// The goals were sent at 10 and 30 ns, the cancel request at 20 ns; the second goal was accepted before the cancel request.
#[test]
fn cancel_of_all_goals_means_those_that_were_sent_before_it() {
    let (mut goals, now) = goals();
    for (n, ns) in [(3, 30), (1, 10)] {
        assert!(goals.offer(id(n), sent(ns), now));
        goals.accept(id(n), at(i32::from(n), 0));
    }
    let selection = goals.select(GoalId::default(), Stamp::default(), sent(20), now);
    assert_eq!(selection, Selection { code: NONE, open: vec![id(1)], canceling: vec![] });
    // Selected by its ID, the later goal is canceled too.
    assert_eq!(goals.select(id(3), Stamp::default(), sent(20), now).open, [id(3)]);
}

#[test]
fn goal_that_is_canceled_while_it_is_decided_begins_with_canceling() {
    for by in [GoalId::default(), id(1)] {
        let (mut goals, now) = goals();
        assert!(goals.offer(id(1), sent(10), now) && goals.offer(id(2), sent(30), now));
        let selection = goals.select(by, Stamp::default(), sent(20), now);
        assert_eq!(selection, Selection { code: NONE, open: vec![id(1)], canceling: vec![] });
        let canceling = goals.cancel(&selection.open);
        assert_eq!(canceling.iter().map(|shown| shown.id).collect::<Vec<_>>(), [id(1)]);
        assert_eq!(goals.select(by, Stamp::default(), sent(20), now).canceling, [id(1)], "it is canceling already");
        let (canceled, other) = (goals.accept(id(1), at(1, 0)), goals.accept(id(2), at(2, 0)));
        assert!(*canceled.borrow() && !*other.borrow());
        assert_eq!((status(&goals, 1), status(&goals, 2)), (Some(Status::Canceling), Some(Status::Accepted)));
        assert!(!goals.execute(id(1)));
        assert_eq!(goals.end(id(1), End::Canceled, "", now), Some((Status::Canceled, vec![])));
    }
}

#[test]
fn goal_is_known_from_its_offer_on() {
    let (mut goals, now) = goals();
    assert!(!goals.knows(id(1)));
    goals.offer(id(1), sent(0), now);
    assert!(goals.knows(id(1)));
    goals.accept(id(1), at(1, 0));
    assert!(goals.knows(id(1)));
}

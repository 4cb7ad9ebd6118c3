use super::*;
use crate::cell::Cell;
use crate::recording::test_bags::{TestBag, axes, header, joints};
use lineshaft_core::machine::Machine;
use lineshaft_core::signal::Directory;
use lineshaft_msgs::msg::AxisState;
use tempfile::TempDir;

const MS: u64 = 1_000_000;

struct Loaded {
    _folder: TempDir,
    run: Run,
}

fn open(bag: TestBag) -> Loaded {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    std::fs::write(&path, bag.finish()).unwrap();
    Loaded { run: Run::open(&path).unwrap(), _folder: folder }
}

fn patterns(patterns: &[&str]) -> Vec<String> {
    patterns.iter().map(|pattern| (*pattern).to_owned()).collect()
}

#[track_caller]
fn loaded(bag: TestBag, select: &[&str]) -> Recorded {
    load(&mut open(bag).run, &patterns(select)).unwrap()
}

#[track_caller]
fn refused(bag: TestBag, select: &[&str]) -> String {
    load(&mut open(bag).run, &patterns(select)).unwrap_err().to_string()
}

fn names(recorded: &Recorded) -> Vec<&str> {
    recorded.series.iter().map(|series| series.name.as_str()).collect()
}

#[track_caller]
fn find<'r>(recorded: &'r Recorded, name: &str) -> &'r Series {
    recorded.series.iter().find(|series| series.name == name).unwrap_or_else(|| panic!("{name}"))
}

fn directory() -> Directory {
    Machine::new(Cell::demo().machine).unwrap().directory().clone()
}

/// Adds ~/signals of a cycle; all other signals are 0 in the first message.
fn signals(bag: &mut TestBag, directory: &Directory, cycle: u64, changed: &[(&str, u64)]) {
    let place = |name: &str| directory.find(name).unwrap().index() as u32;
    let mut message = Signals { cycle, ..Signals::default() };
    if cycle == 0 {
        message.index = (0..directory.len() as u32).collect();
        message.word = vec![0; directory.len()];
    }
    for (name, word) in changed {
        if cycle == 0 {
            message.word[place(name) as usize] = *word;
        } else {
            message.index.push(place(name));
            message.word.push(*word);
        }
    }
    bag.message("/lineshaft/signals", 1_000 * MS + cycle * MS, &message);
}

fn demo_bag() -> TestBag {
    let mut bag = TestBag::new();
    bag.attach("cell.yaml", Cell::demo().text.as_bytes());
    bag
}

#[test]
fn a_board_gives_every_signal_with_its_changes_and_what_held_before_them() {
    let directory = directory();
    let mut bag = demo_bag();
    let increments = 1_048_576; // 10 mm of x
    signals(&mut bag, &directory, 0, &[("x.state", 1)]);
    signals(&mut bag, &directory, 1, &[]);
    signals(&mut bag, &directory, 2, &[]);
    signals(&mut bag, &directory, 3, &[("x.command.position", increments), ("x.state", 2)]);
    signals(&mut bag, &directory, 4, &[("x.command.velocity", (1_048_576.0_f64).to_bits())]);
    signals(&mut bag, &directory, 5, &[]);
    // The same value sent again by a recorder is no change.
    signals(&mut bag, &directory, 6, &[("x.state", 2), ("x.command.position", (-1_i64).cast_unsigned())]);
    bag.message("/joint_states", 0, &joints(0, &[("x", 99.0)]));
    let recorded = loaded(bag, &[]);
    assert_eq!(recorded.series.len(), directory.len());
    assert_eq!((recorded.start_ns, recorded.end_ns), (1_000 * MS, 1_006 * MS));
    let position = find(&recorded, "x.command.position");
    let unit = 10.0 / 1_048_576.0;
    let points = [(0.0, 0.0), (0.002, 0.0), (0.003, 10.0), (0.005, 10.0), (0.006, -unit)];
    assert_eq!((position.unit.as_str(), &position.points[..]), ("mm", &points[..]));
    assert_eq!(position.topic, "/lineshaft/signals");
    let velocity = find(&recorded, "x.command.velocity");
    let points = [(0.0, 0.0), (0.003, 0.0), (0.004, 10.0), (0.006, 10.0)];
    assert_eq!((velocity.unit.as_str(), &velocity.points[..]), ("mm/s", &points[..]));
    let state = find(&recorded, "x.state");
    assert_eq!(state.points, [(0.0, 1.0), (0.002, 1.0), (0.003, 2.0), (0.006, 2.0)]);
    let Kind::Enum(names) = &state.kind else { panic!("{:?}", state.kind) };
    assert_eq!(names[2], "DISCRETE_MOTION");
    // The master position is in increments of the leader.
    assert_eq!(find(&recorded, "x.sync.master").unit, "inc");
    assert_eq!(find(&recorded, "turret.command.velocity").unit, "deg/s");
    assert_eq!(find(&recorded, "x.error").kind, Kind::Code);
    assert_eq!(find(&recorded, "machine.error").kind, Kind::Code);
    assert_eq!(find(&recorded, "x.sync.error").kind, Kind::Int);
}

#[test]
fn patterns_choose_and_one_without_a_match_is_refused() {
    let directory = directory();
    let bag = || {
        let mut bag = demo_bag();
        signals(&mut bag, &directory, 0, &[]);
        bag
    };
    assert_eq!(names(&loaded(bag(), &["x.command.v*", "x.state"])), ["x.state", "x.command.velocity"]);
    assert_eq!(
        refused(bag(), &["x.stat"]),
        "no signal matches `x.stat`, did you mean `x.state`? `lineshaft signals CELL` lists all names"
    );
    assert_eq!(
        refused(bag(), &["x.state", "zzzzzzzz"]),
        "no signal matches `zzzzzzzz`; `lineshaft signals CELL` lists all names"
    );
    let said = refused(bag(), &["turret.actual.pos"]);
    assert!(said.contains("did you mean `turret.actual.position`?"), "{said}");
    assert_eq!(refused(bag(), &["x.["]), "`x.[` is no pattern: unclosed character class; missing ']'");
}

#[test]
fn raw_counts_stay_counts() {
    let directory = directory();
    let mut bag = demo_bag();
    signals(&mut bag, &directory, 0, &[("x.actual.count", 1_000), ("x.latch.count", 3), ("x.output.position", 7)]);
    let recorded = loaded(bag, &["x.*"]);
    let told = |name: &str| {
        let series = find(&recorded, name);
        (series.unit.as_str(), series.points[0].1)
    };
    assert_eq!(told("x.actual.count"), ("inc", 1_000.0));
    assert_eq!(told("x.output.position"), ("inc", 7.0));
    assert_eq!(told("x.latch.count"), ("", 3.0));
}

#[test]
fn fields_of_messages_are_names_too() {
    let directory = directory();
    let mut bag = demo_bag();
    signals(&mut bag, &directory, 0, &[]);
    assert_eq!(names(&loaded(bag, &["x.position", "x.vel*"])), ["x.actual.position", "x.actual.velocity"]);
    let mut bag = TestBag::new();
    bag.message("/joint_states", 0, &joints(0, &[("x", 0.0), ("y", 0.0)]));
    assert_eq!(names(&loaded(bag, &["y.position"])), ["y.actual.position"]);
    let mut bag = TestBag::new();
    bag.message("/joint_states", 0, &joints(0, &[("x", 0.0), ("y", 0.0)]));
    let said = refused(bag, &["torque"]);
    assert_eq!(said, "no signal matches `torque`; the run has x.actual.position, y.actual.position");
}

#[test]
fn after_lost_cycles_values_are_unknown_until_recorded_again() {
    let directory = directory();
    let mut bag = demo_bag();
    signals(&mut bag, &directory, 0, &[("x.state", 1), ("x.homed", 1)]);
    signals(&mut bag, &directory, 1, &[]);
    // Cycles 2 to 4 are lost; x.state is sent immediately after them, x.homed later, x.enabled never.
    signals(&mut bag, &directory, 5, &[("x.state", 1)]);
    signals(&mut bag, &directory, 6, &[("x.homed", 0)]);
    signals(&mut bag, &directory, 7, &[]);
    let recorded = loaded(bag, &[]);
    let told = |name: &str| {
        let series = find(&recorded, name);
        (series.gaps.clone(), series.points.clone())
    };
    assert_eq!(told("x.state"), (vec![(0.001, 0.005)], vec![(0.0, 1.0), (0.001, 1.0), (0.005, 1.0), (0.007, 1.0)]));
    assert_eq!(told("x.homed"), (vec![(0.001, 0.006)], vec![(0.0, 1.0), (0.001, 1.0), (0.006, 0.0), (0.007, 0.0)]));
    assert_eq!(told("x.enabled"), (vec![(0.001, 0.007)], vec![(0.0, 0.0), (0.001, 0.0)]));
}

#[test]
fn samples_that_stay_away_are_a_gap() {
    let mut bag = TestBag::new();
    for n in (0..20).chain(40..60_u64) {
        bag.message("/joint_states", 0, &joints(n * 10 * MS, &[("x", 0.5), ("y", n as f64)]));
    }
    let recorded = loaded(bag, &[]);
    let still = find(&recorded, "x.actual.position");
    assert_eq!(still.gaps, [(0.19, 0.4)]);
    assert_eq!(still.points, [(0.0, 0.5), (0.19, 0.5), (0.4, 0.5), (0.59, 0.5)]);
    let moving = find(&recorded, "y.actual.position");
    assert_eq!((moving.gaps.as_slice(), moving.points.len()), (&[(0.19, 0.4)][..], 40));
}

#[test]
fn decreasing_stamps_are_reported_for_each_topic() {
    let mut bag = TestBag::new();
    for time in [10, 20, 15, 12, 30] {
        bag.message("/joint_states", 0, &joints(time * MS, &[("x", time as f64), ("y", 0.0)]));
        bag.message("/good/joint_states", 0, &joints(time.max(20) * MS, &[("z", 0.0)]));
    }
    let late = loaded(bag, &[]).late;
    assert_eq!(late, [LateMessages { topic: "/joint_states".to_owned(), messages: 2, are_left_out: true }]);
    let said = late[0].to_string();
    assert_eq!(said, "/joint_states: 2 messages have an earlier stamp than a message before and are left out");
    let mut bag = demo_bag();
    bag.message("/s", 5, &Signals { cycle: 0, ..Signals::default() });
    bag.message("/s", 3, &Signals { cycle: 1, ..Signals::default() });
    let late = loaded(bag, &[]).late;
    let said =
        "/s: 1 message has an earlier stamp than a message before and is shown at the time of the message before";
    assert_eq!(late[0].to_string(), said);
}

#[test]
fn bags_of_any_recorder_give_the_fields_of_their_topics() {
    let mut bag = TestBag::new();
    for (time, position) in [(10, 0.0), (20, 0.5), (30, 0.5), (40, 0.5), (50, 1.0)] {
        let axis = AxisState { name: "x".to_owned(), state: 2, position, error_code: 10_001, ..AxisState::default() };
        bag.message("/ls/axis_states", 5_000 * MS + time * MS, &axes(time * MS, vec![axis]));
        bag.message("/joint_states", 5_000 * MS + time * MS, &joints(time * MS, &[("x", position), ("arm", 7.0)]));
        bag.raw("/rosout", "rcl_interfaces/msg/Log", "cdr", time, b"what other nodes say");
    }
    let recorded = loaded(bag, &[]);
    let position = find(&recorded, "x.actual.position");
    let points = [(0.0, 0.0), (0.010, 0.5), (0.030, 0.5), (0.040, 1.0)];
    assert_eq!((position.topic.as_str(), position.unit.as_str()), ("/ls/axis_states", "SI"));
    assert_eq!(position.points, points);
    assert_eq!(find(&recorded, "x.error").points, [(0.0, 10_001.0), (0.040, 10_001.0)]);
    assert_eq!(find(&recorded, "arm.actual.position").topic, "/joint_states");
    // axis_states has it already, and a joint without velocities has none.
    assert_eq!(names(&recorded).iter().filter(|name| **name == "x.actual.position").count(), 1);
    assert!(!names(&recorded).contains(&"arm.actual.velocity"));
    assert_eq!(recorded.start_ns, 10 * MS);
}

#[test]
fn events_are_marks_on_the_same_clock() {
    let mut bag = TestBag::new();
    bag.message("/joint_states", 0, &joints(2_000 * MS, &[("x", 0.0)]));
    let event = Event {
        header: header(2_250 * MS),
        severity: 1,
        kind: "refused".to_owned(),
        source: "x".to_owned(),
        text: "no".to_owned(),
        ..Event::default()
    };
    bag.message("/ls/events", 0, &event);
    let early = Event { header: header(1_999 * MS), severity: 77, ..event };
    bag.message("/ls/events", 0, &early);
    let marks = loaded(bag, &[]).marks;
    let told: Vec<_> = marks.iter().map(|m| (m.time, m.severity, m.kind.as_str(), m.source.as_str())).collect();
    assert_eq!(told, [(0.25, 1, "refused", "x"), (-0.001, 2, "refused", "x")]);
}

#[test]
fn what_does_not_decode_is_named_with_topic_and_time() {
    let mut bag = TestBag::new();
    bag.raw("/joint_states", "sensor_msgs/msg/JointState", "cdr", 1_500_000_000, &[0, 1, 0, 0, 1]);
    let said = refused(bag, &[]);
    assert!(said.contains("run.mcap: message on /joint_states at 1.500000000 s: sensor_msgs/msg/JointState"), "{said}");
    let mut bag = TestBag::new();
    let mut uneven = joints(0, &[("x", 1.0), ("y", 2.0)]);
    uneven.velocity = vec![1.0];
    bag.message("/joint_states", 0, &uneven);
    let said = refused(bag, &[]);
    assert!(said.ends_with("velocity has 1 values for 2 joints; none, or one each, is allowed"), "{said}");
    let mut bag = TestBag::new();
    let mut early = joints(0, &[("x", 1.0)]);
    early.header.stamp.sec = -1;
    bag.message("/joint_states", 0, &early);
    assert!(refused(bag, &[]).ends_with("the stamp is -1 s; 0 and above is allowed"));
    let mut bag = demo_bag();
    bag.message("/s", 0, &Signals { index: vec![100_000], word: vec![0], ..Signals::default() });
    let said = refused(bag, &[]);
    assert!(said.contains("/s at 0.000000000 s: place 100000 of "), "{said}");
    let mut bag = demo_bag();
    bag.message("/s", 0, &Signals { index: vec![1], ..Signals::default() });
    assert!(refused(bag, &[]).ends_with("index has 1 places, word has 0"));
    let mut bag = TestBag::new();
    bag.attach("cell.yaml", b"lineshaft: 7\n");
    bag.message("/s", 0, &Signals::default());
    assert!(refused(bag, &[]).contains("cell.yaml:1:12: lineshaft is `7`; format version 1 is allowed"));
    let mut bag = TestBag::new();
    bag.raw("/other", "std_msgs/msg/String", "cdr", 0, &[]);
    let said = refused(bag, &[]);
    assert!(
        said.ends_with("the run holds neither ~/signals with the cell, nor joint_states, nor axis_states"),
        "{said}"
    );
}

#[test]
fn a_sample_out_of_order_is_left_out_and_counted() {
    let mut budget = Budget::default();
    let mut track = Track::new("x".to_owned(), String::new(), Type::Real, "/t".to_owned());
    for (time, value) in [(10, 1.0), (30, 2.0), (20, 9.0), (30, 3.0)] {
        track.sample(time, value, &mut budget).unwrap();
    }
    assert_eq!((track.samples, track.late), (3, 1));
    assert_eq!(track.points, [(10, 1.0), (30, 2.0), (30, 3.0)]);
}

#[test]
fn more_points_than_memory_should_hold_are_refused() {
    let mut budget = Budget::default();
    assert!(budget.spend(track::MAX_POINTS).is_some());
    let mut track = Track::new("x".to_owned(), String::new(), Type::Real, "/t".to_owned());
    assert_eq!(track.sample(0, 1.0, &mut budget), Err(Refusal::TooMany));
    assert!(SeriesError::TooMany.to_string().contains("50000000 points; choose fewer"));
}

//! Passive touch probes: the position of an axis at a latch, recorded with any motion of the axis, or at rest.

use super::rig::{LINE, Rig, X, Y, at, config, couple, to};
use crate::code::Code;
use crate::command::{
    AbortTrigger, Action, HomeAxis, HomingMethod, Move, MoveMode, ProbeEdge, Synchronize, TouchProbe,
};
use crate::config::{IoConfig, IoKind, MachineConfig};
use crate::drive::{Capabilities, Edge, Latch};
use crate::event::{Event, Kind};
use crate::modulo::Modulo;
use crate::object::{AxisSet, Leader, Object};
use crate::position::{Length, Position};
use crate::sim::Index;
use crate::sync::SyncMode;
use crate::trajectory::{Knot, Track, Trajectory};
use proptest::prelude::*;
use std::sync::Arc;

const MARK: Object = Object::Io(0);
const OTHER: Object = Object::Io(1);

fn cell() -> MachineConfig {
    let input = |name: &str| IoConfig { name: name.into(), kind: IoKind::DigitalInput, latch: true };
    MachineConfig { io: ["mark", "other", "third", "fourth"].map(input).into(), ..config(0) }
}

/// Returns a rig with x and y switched on, and inputs that latch.
fn rig() -> Rig {
    let mut rig = Rig::of(cell());
    rig.enable();
    rig
}

fn once(source: Object) -> TouchProbe {
    TouchProbe { axis: X, source, edge: ProbeEdge::Rising, continuous: false, window: None }
}

fn each(source: Object) -> TouchProbe {
    TouchProbe { continuous: true, ..once(source) }
}

fn between(first: i64, last: i64) -> TouchProbe {
    TouchProbe { window: Some([first, last].map(Length::whole)), ..each(MARK) }
}

#[track_caller]
fn arm(rig: &mut Rig, request: TouchProbe) -> u64 {
    let sequence = rig.give(Action::TouchProbe(request));
    assert!(rig.was_accepted(sequence), "{request:?}");
    sequence
}

fn abort(rig: &mut Rig, source: Option<Object>) -> u64 {
    rig.give(Action::AbortTrigger(AbortTrigger { axis: X, source }))
}

fn latch(rig: &mut Rig, object: Object, edge: Edge, age_ns: u32) {
    assert!(rig.plant.add_latch(Latch { object, edge, age_ns: Some(age_ns), position: None }));
}

fn records(rig: &Rig, sequence: u64) -> Vec<Event> {
    rig.events.iter().filter(|event| event.kind == Kind::Latch && event.command == sequence).copied().collect()
}

/// Returns the recorded positions of a touch probe (inc).
fn places(rig: &Rig, sequence: u64) -> Vec<f64> {
    records(rig, sequence).iter().map(|event| event.position.to_f64()).collect()
}

fn ends(rig: &Rig, sequence: u64) -> Vec<Code> {
    rig.done(sequence).iter().map(|event| event.code).collect()
}

fn sentence(rig: &Rig, event: &Event) -> String {
    crate::text::message(event, rig.machine.config())
}

/// Moves x at 50 mm/s with 1 m/s^2: from 51 ms on its actual position in cycle k is 50 inc (k - 1) - 1250 inc, and it
/// moves 50 inc per cycle.
fn go(rig: &mut Rig) {
    let goal = rig.give(Action::Move(Move { velocity: 50_000.0, acceleration: 1e6, ..to(X, 100_000) }));
    assert!(rig.was_accepted(goal));
    rig.run(100);
}

/// 101 cycles after its command the axis is at 3750 inc; 350 us earlier it was 17.5 inc less.
#[test]
fn the_first_latch_is_recorded_at_its_instant_and_ends_the_touch_probe() {
    let mut rig = rig();
    let probe = arm(&mut rig, once(MARK));
    go(&mut rig);
    latch(&mut rig, MARK, Edge::Rising, 350_000);
    rig.mirror();
    rig.run(1);
    assert_eq!(rig.int("x.actual.position"), 3_750);
    let record = records(&rig, probe);
    assert_eq!((record.len(), record[0].position, record[0].age_ns), (1, Position::from_f64(3_732.5), 350_000));
    assert_eq!((record[0].source, record[0].severity as u8), (Object::Axis(X), 0));
    assert_eq!(sentence(&rig, &record[0]), "x: touch probe: rising edge of mark at 3.732 mm, 350 us before the cycle");
    let done = rig.done(probe);
    assert_eq!((done.len(), done[0].code, done[0].position), (1, Code::NONE, Position::from_f64(3_732.5)));
    let shown = |rig: &Rig| (rig.int("x.latch.position"), rig.real("x.latch.fraction"), rig.int("x.latch.count"));
    assert_eq!(shown(&rig), (3_732, 0.5, 1));
    latch(&mut rig, MARK, Edge::Rising, 0);
    rig.run(1);
    assert_eq!((records(&rig, probe).len(), shown(&rig)), (1, (3_732, 0.5, 1)), "it is over");
    let refused = abort(&mut rig, Some(MARK));
    assert_eq!(rig.refusal(refused), "x: no touch probe is armed for mark; arm one with touch_probe");
}

/// Bit for bit: an armed and recording touch probe affects no motion.
#[test]
fn a_touch_probe_changes_no_motion() {
    let [mut with, mut without] = [rig(), rig()];
    let probes = [MARK, OTHER, Object::Axis(X), Object::Encoder(0)].map(|source| {
        without.run(1);
        arm(&mut with, each(source))
    });
    for rig in [&mut with, &mut without] {
        go(rig);
    }
    for cycle in 0..2_500 {
        for rig in [&mut with, &mut without] {
            if cycle % 7 == 0 {
                latch(rig, MARK, Edge::Rising, 123_456);
                latch(rig, Object::Axis(X), Edge::Rising, 1);
            }
            rig.run(1);
        }
        for name in ["x.command.position", "x.actual.position", "x.output.position", "x.state"] {
            assert_eq!(with.int(name), without.int(name), "{name} in cycle {cycle}");
        }
        assert_eq!(with.real("x.command.fraction").to_bits(), without.real("x.command.fraction").to_bits());
    }
    assert_eq!(with.state("x"), "STANDSTILL");
    assert!(records(&with, probes[0]).len() > 100);
}

/// Half a cycle before a cycle the axis was half-way between its positions in this cycle and in the previous one, with
/// any source of motion.
#[test]
fn latched_position_is_recorded_with_any_source_of_motion() {
    let knot = Knot { position: Position::whole(10_000), velocity: Some(0.0), acceleration: None };
    let track = Track { axis: X, knots: [knot].into(), ..Track::default() };
    let trajectory = Trajectory::new(0, [400_000_000].into(), [track].into(), None).expect("a sound one");
    let line = Action::Move(Move { acceleration: 1e6, ..at(LINE, 30_000.0) });
    let gear = |mode| Action::Synchronize(Synchronize { mode, ..couple(X, Leader::AxisCommand(LINE), 355, 113) });
    let home = Action::HomeAxis(HomeAxis { axis: X, method: HomingMethod::Cia402(34) });
    for actions in [
        vec![Action::Trajectory(Arc::new(trajectory))],
        vec![line.clone(), gear(SyncMode::Position)],
        vec![line, gear(SyncMode::Velocity)],
        vec![Action::Move(at(X, -40_000.0))],
        vec![Action::Move(to(X, 9_000)), Action::Halt(AxisSet::one(X))],
        vec![home],
        vec![],
    ] {
        let mut rig = rig();
        let probe = arm(&mut rig, each(MARK));
        let last = actions.len();
        for (nth, action) in actions.iter().enumerate() {
            let sequence = rig.give(action.clone());
            assert!(rig.was_accepted(sequence));
            rig.run(if nth + 1 == last { 20 } else { 60 });
        }
        for _ in 0..20 {
            let before = rig.int("x.actual.position");
            latch(&mut rig, MARK, Edge::Rising, 500_000);
            if actions.is_empty() {
                rig.stream(X, 20_000.0);
            } else {
                rig.run(1);
            }
            let expected = (before + rig.int("x.actual.position")) as f64 / 2.0;
            assert_eq!(places(&rig, probe).last(), Some(&expected), "{actions:?}");
        }
        assert_ne!(places(&rig, probe)[0], places(&rig, probe)[19], "it moves: {actions:?}");
    }
}

/// Moved by hand: 10 inc in each cycle.
#[test]
fn an_axis_that_is_off_is_recorded_too() {
    let mut rig = Rig::of(cell());
    rig.modify_inputs = |inputs| inputs.drive[0].count = 10 * inputs.cycle.cast_signed();
    let probe = arm(&mut rig, once(MARK));
    rig.run(20);
    assert_eq!(rig.state("x"), "DISABLED");
    latch(&mut rig, MARK, Edge::Rising, 500_000);
    rig.run(1);
    let now = rig.int("x.actual.position");
    assert_eq!(places(&rig, probe), [now as f64 - 5.0]);
}

#[test]
fn a_virtual_axis_records_its_command_and_a_stopped_one_where_it_stands() {
    let mut rig = rig();
    let probes =
        [arm(&mut rig, TouchProbe { axis: LINE, ..once(MARK) }), arm(&mut rig, TouchProbe { axis: Y, ..once(MARK) })];
    let goal = rig.give(Action::Move(Move { axis: LINE, velocity: 50_000.0, acceleration: 1e6, ..to(X, 100_000) }));
    assert!(rig.was_accepted(goal));
    rig.run(100);
    latch(&mut rig, MARK, Edge::Rising, 340_000);
    rig.run(1);
    // 3800 - 0.34 * 50
    assert_eq!(places(&rig, probes[0]), [3_783.0]);
    assert_eq!(places(&rig, probes[1]), [0.0]);
}

/// Of the edges of one cycle the oldest comes first, in any order of the inputs.
#[test]
fn a_continuous_touch_probe_records_every_latch_of_its_edge_until_it_is_aborted() {
    let mut rig = rig();
    let rising = arm(&mut rig, each(MARK));
    let both = arm(&mut rig, TouchProbe { edge: ProbeEdge::Both, ..each(OTHER) });
    let falling = arm(&mut rig, TouchProbe { edge: ProbeEdge::Falling, ..each(Object::Io(2)) });
    go(&mut rig);
    for object in [MARK, OTHER, Object::Io(2)] {
        latch(&mut rig, object, Edge::Rising, 200_000);
        latch(&mut rig, object, Edge::Falling, 400_000);
        latch(&mut rig, object, Edge::Rising, 600_000);
    }
    rig.run(1);
    assert_eq!(places(&rig, rising), [3_720.0, 3_740.0]);
    assert_eq!(places(&rig, both), [3_720.0, 3_730.0, 3_740.0]);
    assert_eq!(places(&rig, falling), [3_730.0]);
    let edges: Vec<_> = records(&rig, both).iter().map(|event| sentence(&rig, event)).collect();
    assert!(edges[0].contains("rising edge of other") && edges[1].contains("falling edge of other"), "{edges:?}");
    assert_eq!(
        (rig.int("x.latch.count"), rig.int("x.latch.position")),
        (6, 3_730),
        "the last touch probe of the cycle"
    );

    latch(&mut rig, MARK, Edge::Rising, 0);
    let aborted = abort(&mut rig, Some(MARK));
    assert!(rig.was_accepted(aborted));
    assert_eq!(
        (records(&rig, rising).len(), ends(&rig, rising)),
        (3, vec![Code::CANCELLED]),
        "latches come before commands"
    );
    latch(&mut rig, MARK, Edge::Rising, 0);
    latch(&mut rig, OTHER, Edge::Rising, 0);
    rig.run(1);
    assert_eq!((records(&rig, rising).len(), records(&rig, both).len()), (3, 4));
    let aborted = abort(&mut rig, None);
    assert!(rig.was_accepted(aborted));
    assert_eq!([both, falling].map(|probe| ends(&rig, probe)), [vec![Code::CANCELLED], vec![Code::CANCELLED]]);
    let refused = abort(&mut rig, None);
    assert_eq!(rig.refusal(refused), "x: no touch probe is armed; arm one with touch_probe");
}

#[test]
fn a_latch_in_the_cycle_in_which_it_is_armed_was_before() {
    let mut rig = rig();
    latch(&mut rig, MARK, Edge::Rising, 1);
    let probe = arm(&mut rig, once(MARK));
    rig.run(1);
    assert!(records(&rig, probe).is_empty());
    latch(&mut rig, MARK, Edge::Rising, 1);
    rig.run(1);
    assert_eq!(ends(&rig, probe), [Code::NONE]);
}

/// In the cycle at 3750 inc; a latch at the first or the last position is within the window.
#[test]
fn a_window_includes_its_ends_and_the_first_latch_within_it_counts() {
    for (first, last, counts) in [
        (3_750, 3_750, true),
        (3_000, 3_750, true),
        (3_750, 4_000, true),
        (3_751, 4_000, false),
        (3_000, 3_749, false),
        (-5_000, -1, false),
    ] {
        let mut rig = rig();
        let probe = arm(&mut rig, between(first, last));
        go(&mut rig);
        latch(&mut rig, MARK, Edge::Rising, 0);
        rig.run(1);
        assert_eq!(records(&rig, probe).len(), usize::from(counts), "{first} to {last}");
    }
    let mut rig = rig();
    let probe = arm(&mut rig, TouchProbe { continuous: false, ..between(3_745, 9_000) });
    go(&mut rig);
    for age in [0, 150_000, 80_000] {
        latch(&mut rig, MARK, Edge::Rising, age);
    }
    rig.run(1);
    // 3742.5, 3746 and 3750: the second is the first within the window.
    assert_eq!((places(&rig, probe), ends(&rig, probe)), (vec![3_746.0], vec![Code::NONE]));
}

#[test]
fn a_window_that_ends_before_it_begins_needs_a_turn() {
    let mut rig = rig();
    let refused = rig.give(Action::TouchProbe(between(10, 9)));
    let remedy = "only an axis with a modulo has a window across the end of its turn";
    assert_eq!(rig.refusal(refused), format!("x: first_position 0.01 mm exceeds last_position 0.009 mm; {remedy}"));
    let beyond = rig.give(Action::TouchProbe(between(0, i64::MAX)));
    assert_eq!(rig.answer(beyond).unwrap_err().code, Code::POSITION_OUT_OF_RANGE);

    // A revolution of 1000 inc: 3750 inc is shown as 750.
    for (first, last, counts) in [
        (700, 800, true),
        (800, 700, false),
        (900, 750, true),
        (750, 100, true),
        (-300, -200, true),
        (1_700, 1_800, true),
        (-250, 749, true),
        (0, 5_000, true),
        (751, 1_749, false),
        (751, 1_750, true),
    ] {
        let mut cell = cell();
        cell.axes[usize::from(X)].modulo = Modulo::new(1_000, 1);
        let mut rig = Rig::of(cell);
        rig.enable();
        let probe = arm(&mut rig, between(first, last));
        let relative = Move { mode: MoveMode::Relative, velocity: 50_000.0, acceleration: 1e6, ..to(X, 100_000) };
        let goal = rig.give(Action::Move(relative));
        assert!(rig.was_accepted(goal));
        rig.run(100);
        latch(&mut rig, MARK, Edge::Rising, 0);
        rig.run(1);
        assert_eq!(places(&rig, probe), if counts { vec![3_750.0] } else { vec![] }, "{first} to {last}");
    }
}

#[test]
fn a_new_touch_probe_takes_the_place_of_that_of_the_same_trigger_and_a_fifth_has_none() {
    let mut rig = rig();
    let first = arm(&mut rig, each(MARK));
    let second = arm(&mut rig, TouchProbe { edge: ProbeEdge::Falling, ..once(MARK) });
    assert_eq!(ends(&rig, first), [Code::REPLACED]);
    for source in [OTHER, Object::Io(2), Object::Axis(X)] {
        arm(&mut rig, each(source));
    }
    let fifth = rig.give(Action::TouchProbe(once(Object::Encoder(0))));
    assert_eq!(rig.refusal(fifth), "x: 4 touch probes are armed, allowed 4; abort one with abort_trigger");
    let of_y = rig.give(Action::TouchProbe(TouchProbe { axis: Y, ..once(Object::Encoder(0)) }));
    assert!(rig.was_accepted(of_y), "each axis has its own");
    latch(&mut rig, MARK, Edge::Falling, 0);
    rig.run(1);
    assert_eq!((ends(&rig, second), records(&rig, first).len()), (vec![Code::NONE], 0));
    arm(&mut rig, once(Object::Encoder(0)));
}

/// These apply to motion; a touch probe is not a motion.
#[test]
fn stops_errors_and_power_leave_a_touch_probe_armed() {
    let mut rig = rig();
    let probe = arm(&mut rig, each(MARK));
    let mut count = 0;
    for action in [
        Action::Halt(AxisSet::one(X)),
        Action::QuickStop(AxisSet::one(X)),
        Action::Disable(AxisSet::one(X)),
        Action::Abort,
        Action::Deactivate,
        Action::Activate,
        Action::ResetErrors(AxisSet::first(3)),
        Action::Enable(AxisSet::one(X)),
        Action::Move(to(X, 5_000)),
    ] {
        rig.give(action.clone());
        rig.run(60);
        latch(&mut rig, MARK, Edge::Rising, 0);
        rig.run(1);
        count += 1;
        assert_eq!((records(&rig, probe).len(), ends(&rig, probe).len()), (count, 0), "{action:?}");
    }
    rig.plant.drive(0).unwrap().inject_fault(0x8611);
    rig.run(60);
    assert_eq!(rig.state("x"), "ERROR_STOP");
    latch(&mut rig, MARK, Edge::Rising, 0);
    rig.run(1);
    assert_eq!(records(&rig, probe).len(), count + 1);
}

#[test]
fn a_new_coordinate_ends_a_touch_probe_with_a_window() {
    let mut rig = rig();
    go(&mut rig);
    rig.give(Action::Halt(AxisSet::one(X)));
    rig.run(200);
    let within = arm(&mut rig, between(0, 100_000));
    let anywhere = arm(&mut rig, each(OTHER));
    let home = rig.give(Action::HomeAxis(HomeAxis { axis: X, method: HomingMethod::Cia402(35) }));
    assert!(rig.was_accepted(home));
    rig.run(1);
    let code = Code::COORDINATE_CHANGED;
    assert_eq!((ends(&rig, within), ends(&rig, anywhere)), (vec![code], vec![]));
    assert!(sentence(&rig, &rig.done(within)[0]).contains("the window of the touch probe is not valid any more"));
    latch(&mut rig, MARK, Edge::Rising, 0);
    latch(&mut rig, OTHER, Edge::Rising, 0);
    rig.run(1);
    assert_eq!((places(&rig, within), places(&rig, anywhere)), (vec![], vec![0.0]));
}

/// A touch probe that is armed in the cycle of the new coordinate refers to the new coordinate.
#[test]
fn a_window_of_the_new_coordinate_stays() {
    let mut rig = rig();
    let before = arm(&mut rig, TouchProbe { source: OTHER, ..between(0, 100_000) });
    let home = Action::HomeAxis(HomeAxis { axis: X, method: HomingMethod::Cia402(35) });
    let after = rig.give_all(vec![home, Action::TouchProbe(between(0, 100_000))]);
    rig.run(1);
    assert_eq!((ends(&rig, before), ends(&rig, after)), (vec![Code::COORDINATE_CHANGED], vec![]));
    latch(&mut rig, MARK, Edge::Rising, 0);
    rig.run(1);
    assert_eq!(places(&rig, after), [0.0]);
}

#[test]
fn latch_without_position_is_reported_and_not_recorded() {
    let mut rig = rig();
    let probe = arm(&mut rig, once(MARK));
    rig.modify_inputs = |inputs| inputs.drive[0].online = false;
    latch(&mut rig, MARK, Edge::Rising, 0);
    rig.run(1);
    let told = |rig: &Rig| rig.events.iter().filter(|event| event.code == Code::TOUCH_PROBE_NO_POSITION).count();
    assert_eq!((told(&rig), records(&rig, probe).len(), ends(&rig, probe).len()), (1, 0, 0));
    rig.modify_inputs = |_| {};
    latch(&mut rig, MARK, Edge::Rising, 0);
    rig.run(1);
    assert_eq!((told(&rig), ends(&rig, probe)), (1, vec![Code::NONE]));
}

/// One pulse at each 1000 inc: at 50 inc per cycle the pulse at 4000 is passed in the cycle that ends there.
#[test]
fn index_pulses_are_recorded_where_the_encoder_caught_them() {
    let mut rig = rig();
    let fixtures = crate::sim::Fixtures { index: Some(Index { every: 1_000, at: 30 }), ..Default::default() };
    rig.plant.drive(0).unwrap().install_fixtures(fixtures);
    let probe = arm(&mut rig, TouchProbe { edge: ProbeEdge::Index, ..each(Object::Axis(X)) });
    go(&mut rig);
    assert_eq!(places(&rig, probe), [30.0, 1_030.0, 2_030.0, 3_030.0]);
    let text = sentence(&rig, &records(&rig, probe)[1]);
    assert!(text.starts_with("x: touch probe: index pulse of x at 1.03 mm, "), "{text}");
    // 50 inc are a cycle of 1 ms: the cycles that pass 2030 and 3030 end at 2050 and 3050, 0.4 ms later.
    let ages: Vec<_> = records(&rig, probe).iter().map(|event| event.age_ns).collect();
    assert_eq!(ages[2..], [400_000; 2]);
}

/// A position captured by its own device is exact, independent of the age; such a latch counts once in the signals.
#[test]
fn a_position_that_the_own_device_caught_is_taken_as_it_is() {
    let mut rig = rig();
    let probe = arm(&mut rig, each(Object::Axis(X)));
    go(&mut rig);
    let caught = Latch { object: Object::Axis(X), edge: Edge::Rising, age_ns: None, position: Some(3_704) };
    assert!(rig.plant.add_latch(caught));
    rig.run(1);
    assert_eq!((places(&rig, probe), rig.int("x.latch.count")), (vec![3_704.0], 1));
}

#[test]
fn a_drive_that_latches_nothing_and_an_axis_that_is_none_are_refused() {
    let mut cell = cell();
    cell.axes[1].drive = Some(Capabilities { latches: false, ..Capabilities::all(0) });
    let mut rig = Rig::of(cell);
    let refused = rig.give(Action::TouchProbe(once(Object::Axis(X))));
    assert!(rig.refusal(refused).starts_with("x: the drive of x latches nothing"));
    let nowhere = rig.give(Action::TouchProbe(TouchProbe { axis: 77, ..once(MARK) }));
    assert!(rig.refusal(nowhere).ends_with("the request is not understood"));
    let nowhere = rig.give(Action::AbortTrigger(AbortTrigger { axis: 77, source: None }));
    assert!(rig.refusal(nowhere).ends_with("the request is not understood"));
}

#[test]
fn a_power_cycle_ends_what_is_armed() {
    let mut rig = Rig::of(cell());
    let probe = arm(&mut rig, each(MARK));
    let cycled = rig.give(Action::PowerCycle);
    assert!(rig.was_accepted(cycled));
    assert_eq!(ends(&rig, probe), [Code::DISABLED]);
    latch(&mut rig, MARK, Edge::Rising, 0);
    rig.run(1);
    assert!(records(&rig, probe).is_empty());
}

proptest! {
    /// By definition: upwards from the first position, the position is reached not later than the last one.
    #[test]
    fn a_place_is_between_two_others_by_the_way_up(
        turn in 1_i64..5_000, first in -20_000_i64..20_000, last in -20_000_i64..20_000, place in -20_000_i64..20_000,
    ) {
        let width = if last >= first { last - first } else { (last - first).rem_euclid(turn) };
        let expected = (0..=width.min(turn)).any(|way| (first + way - place).rem_euclid(turn) == 0);
        let [first, last, place] = [first, last, place].map(Position::whole);
        prop_assert_eq!(Modulo::new(turn, 1).unwrap().is_between(first, last, place), expected);
    }

    /// Also if a revolution is not a multiple of 2^-32 inc: additional whole revolutions show the same position.
    #[test]
    fn whole_turns_more_are_the_same_place(
        numerator in 1_000_i64..1_000_000, denominator in 1_i64..1_000, turns in -1_000_i64..1_000, offset in 0_i64..1_000,
    ) {
        prop_assume!(numerator >= denominator);
        let turn = Modulo::new(numerator, denominator).unwrap();
        let whole = Position::from_raw(((i128::from(numerator) * i128::from(turns)) << 32) / i128::from(denominator));
        let first = Position::whole(offset);
        prop_assert!(turn.is_between(first, first, first + whole));
    }
}

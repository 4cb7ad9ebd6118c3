//! Compensation of backlash and pitch error between motor and load: the load is at the commanded position.

mod load;
mod meetings;

use super::rig::{LINE, Rig, X, Y, at, cases, config, couple, to};
use crate::axis::Wired;
use crate::code::Code;
use crate::command::{Action, HomeAxis, HomingMethod, SetPosition};
use crate::config::{ConfigError, IoConfig, IoKind, MachineConfig, PitchProblem, TableConfig};
use crate::drive::{Capabilities, Interface};
use crate::encoder::{Absolute, Form as Words};
use crate::modulo::Modulo;
use crate::object::{AxisSet, Leader};
use crate::parameter::{Change, Row, Value};
use crate::position::Length;
use crate::sim::Model;
use crate::table::{Form, PitchError, Table};
use proptest::prelude::*;
use std::collections::VecDeque;
use std::sync::Arc;

fn xy(points: &[(i64, i64)]) -> Table {
    let (x, y): (Vec<_>, Vec<_>) = points.iter().copied().unzip();
    Table::new(Form::Xy, &x, &y).expect("points")
}

/// A screw that is 60 inc too long at 20 mm, correct again at 50 mm, and too short after that.
const PITCH: [(i64, i64); 4] = [(0, 0), (20_000, 60), (50_000, 0), (70_000, -25)];
/// 0.04 mm.
const BACKLASH: i64 = 40;

/// Returns a cell in which x has this backlash and pitch error, if given.
fn cell(delay: u32, backlash: i64, pitch: Option<&[(i64, i64)]>) -> MachineConfig {
    let mut config = config(delay);
    config.io = vec![IoConfig { name: "mark".into(), kind: IoKind::DigitalInput, latch: true }];
    if let Some(points) = pitch {
        config.tables = vec![TableConfig { name: "screw".into(), table: Arc::new(xy(points)) }];
        config.axes[1].pitch_error = Some(0);
    }
    let p = &mut config.axes[1].parameters;
    p.compensation.backlash = backlash;
    p.homing.velocity = Some(10_000.0);
    p.homing.index_velocity = Some(1_000.0);
    p.homing.max_distance = Some(60_000);
    p.assigned.refswitch = 1;
    config
}

fn home(rig: &mut Rig, method: i8) {
    let goal = rig.give(Action::HomeAxis(HomeAxis { axis: X, method: HomingMethod::Cia402(method) }));
    for _ in 0..60_000 {
        if let [done] = rig.done(goal)[..] {
            assert_eq!((done.code, rig.int("x.homed")), (Code::NONE, 1), "{method}");
            return;
        }
        rig.run(1);
    }
    panic!("homing by {method} never ended");
}

/// Returns a rig whose x has its zero at its present position.
fn homed(config: MachineConfig) -> Rig {
    let mut rig = Rig::of(config);
    rig.enable();
    home(&mut rig, 35);
    rig
}

fn set(rig: &mut Rig, key: &str, value: Value) {
    let (row, _) = Row::find(key).expect("a row");
    let sequence = rig.give(Action::SetParameters(Box::new([Change { axis: X, row, value }])));
    assert!(rig.was_accepted(sequence), "{key}");
}

/// Gives x an absolute encoder.
fn absolute(mut config: MachineConfig) -> MachineConfig {
    let axis = &mut config.axes[1];
    axis.wired = Wired::Drive(Words::Absolute(Absolute { turns: 4096, ..Absolute::single_turn(8192) }));
    axis.parameters.encoder.encodertype = 2;
    config.set_absolute_sources();
    config
}

/// Moves to a target and waits until the axis is at rest.
fn go(rig: &mut Rig, target: i64) {
    let goal = rig.give(Action::Move(to(X, target)));
    for _ in 0..20_000 {
        if rig.done(goal).len() == 1 {
            // The last compensation is complete.
            rig.run(60);
            assert_eq!(rig.int("x.command.position"), target);
            return;
        }
        rig.run(1);
    }
    panic!("{target} was never reached");
}

fn compensation(rig: &Rig) -> i64 {
    rig.int("x.compensation")
}

/// Calculated by hand: 60 inc on 20 mm are 3 for each mm, then 2 less for each mm; downwards 40 less. Half an increment
/// is rounded up.
#[test]
fn motor_leads_load_by_pitch_error_and_backlash() {
    let mut rig = homed(cell(0, BACKLASH, Some(&PITCH)));
    for (target, expected) in [
        (1_000, 3),
        (10_000, 30),
        (20_000, 60),
        (35_000, 30),
        (80_000, -25),
        (60_000, -12 - 40),
        (35_000, 30 - 40),
        (0, -40),
        (-5_000, -40),
        (10_000, 30),
        (9_999, 30),
        (9_000, 27 - 40),
        (9_001, 27 - 40),
        (9_003, 27),
    ] {
        go(&mut rig, target);
        assert_eq!(compensation(&rig), expected, "{target}");
        assert_eq!((rig.int("x.actual.position"), rig.int("x.actual.count")), (target, target + expected), "{target}");
    }
}

/// 25 mm/s against 10 mm/s: 25 of 40 inc in the first cycle, then 15. The axis itself does not move, and there is no
/// following error.
#[test]
fn compensation_is_no_motion_of_the_axis() {
    for delay in [0, 1, 7] {
        let mut config = cell(delay, BACKLASH, None);
        config.axes[1].parameters.compensation.velocity = Some(25_000.0);
        config.axes[1].parameters.max_following_error = 1;
        let mut rig = homed(config);
        go(&mut rig, 30_000);
        rig.mirror();
        rig.give(Action::Move(to(X, 10_000)));
        let mut asked = vec![compensation(&rig)];
        let mut last = rig.int("x.actual.position");
        for _ in 0..2_500 {
            rig.run(1);
            let here = rig.int("x.actual.position");
            assert_eq!((rig.int("x.following_error"), rig.int("x.error")), (0, 0));
            assert!(here <= last && last - here <= 100, "delay {delay}: {last} to {here}");
            // At rest and at constant velocity the velocity of the drive equals that of the axis.
            assert!((rig.real("x.actual.velocity") - (here - last) as f64 * 1_000.0).abs() <= 1_000.0);
            last = here;
            let now = compensation(&rig);
            if asked.last() != Some(&now) {
                asked.push(now);
            }
        }
        assert_eq!(asked, [0, -25, -40], "delay {delay}");
        assert_eq!((last, rig.int("x.actual.count"), rig.state("x")), (10_000, 9_960, "STANDSTILL"));
    }
}

/// Without a given rate it is a tenth of 100 mm/s: 10 inc per cycle.
#[test]
fn the_rate_is_a_tenth_of_the_highest_velocity_unless_it_is_given() {
    for (given, cycles) in [(None, 4), (Some(1_000.0), 40), (Some(500.0), 80), (Some(40_000.0), 1)] {
        let mut config = cell(0, BACKLASH, None);
        config.axes[1].parameters.compensation.velocity = given;
        let mut rig = homed(config);
        go(&mut rig, 1_000);
        rig.give(Action::Move(to(X, -20_000)));
        let begin = (0..200).find(|_| {
            rig.run(1);
            compensation(&rig) != 0
        });
        assert!(begin.is_some());
        let mut took = 1;
        while compensation(&rig) != -BACKLASH {
            rig.run(1);
            took += 1;
        }
        // Half an increment per cycle is visible from the second cycle.
        let late = if given == Some(500.0) { 1 } else { 0 };
        assert_eq!(took + late, cycles, "{given:?}");
    }
}

/// Without a zero the position on the screw is unknown. With a zero the compensation is applied at its rate, and it is
/// removed together with the zero.
#[test]
fn compensation_needs_a_zero() {
    let mut config = cell(2, BACKLASH, Some(&[(0, 500), (100_000, 500)]));
    config.axes[1].parameters.compensation.velocity = Some(20_000.0);
    let mut rig = Rig::of(config);
    rig.enable();
    go(&mut rig, 5_000);
    go(&mut rig, -5_000);
    assert_eq!((compensation(&rig), rig.int("x.actual.count")), (0, -5_000));
    rig.give(Action::HomeAxis(HomeAxis { axis: X, method: HomingMethod::Cia402(35) }));
    let mut last = compensation(&rig);
    assert_eq!((last, rig.int("x.homed")), (20, 1), "its first cycle");
    for _ in 0..30 {
        rig.run(1);
        let now = compensation(&rig);
        assert!((0..=20).contains(&(now - last)), "{last} to {now}");
        assert_eq!((rig.int("x.actual.position"), rig.int("x.following_error")), (0, 0));
        last = now;
    }
    assert_eq!((last, rig.int("x.actual.count")), (500, -4_500));
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(20);
    rig.plant.drive(0).unwrap().restart_counts();
    rig.run(60);
    assert_eq!((rig.int("x.homed"), compensation(&rig)), (0, 0));
}

/// The position on the screw refers to the zero of the axis itself, in any user coordinate.
#[test]
fn another_coordinate_is_no_other_place_on_the_screw() {
    let mut rig = homed(cell(0, BACKLASH, Some(&PITCH)));
    go(&mut rig, 20_000);
    rig.mirror();
    for position in [0, -1_000_000, 123_456] {
        rig.give(Action::SetPosition(SetPosition { axis: X, position: Length::whole(position) }));
        rig.run(20);
        assert_eq!(
            (compensation(&rig), rig.int("x.actual.position"), rig.int("x.actual.count")),
            (60, position, 20_060)
        );
    }
    go(&mut rig, 123_456 + 15_000);
    assert_eq!(compensation(&rig), 30);
    go(&mut rig, 123_456);
    assert_eq!((compensation(&rig), rig.int("x.actual.count")), (20, 20_020));
}

/// A parameter change affects the command only at the compensation rate, at rest and in motion.
#[test]
fn a_parameter_makes_no_jump() {
    for moves in [false, true] {
        let mut rig = homed(cell(1, 0, Some(&PITCH)));
        go(&mut rig, 30_000);
        rig.mirror();
        if moves {
            rig.give(Action::Move(at(X, -10_000.0)));
            rig.run(100);
        }
        set(&mut rig, "compensation.velocity", Value::Real(5_000.0));
        for backlash in [1 << 20, 0, 3, 40] {
            set(&mut rig, "compensation.backlash", Value::Int(backlash));
            let mut last = compensation(&rig);
            for _ in 0..40 {
                rig.run(1);
                let now = compensation(&rig);
                assert!((now - last).abs() <= 6, "{last} to {now}");
                assert_eq!(rig.int("x.following_error"), 0);
                last = now;
            }
        }
        rig.give(Action::Halt(AxisSet::one(X)));
        rig.run(500);
        assert_eq!(rig.int("x.actual.position"), rig.int("x.command.position"));
    }
}

/// The direction of earlier motion is unknown: a backlash that is set at rest applies from the next motion, in its
/// direction.
#[test]
fn a_backlash_that_is_set_at_rest_begins_with_the_next_motion() {
    for (place, on, expected) in [(-50_000, -51_000, -40), (-50_000, -49_000, 0), (50_000, 49_000, -40)] {
        let mut rig = homed(cell(0, 0, None));
        go(&mut rig, place);
        set(&mut rig, "compensation.backlash", Value::Int(BACKLASH));
        rig.run(20);
        assert_eq!((compensation(&rig), rig.int("x.actual.count")), (0, place));
        go(&mut rig, on);
        assert_eq!((compensation(&rig), rig.int("x.actual.count")), (expected, on + expected));
    }
}

/// Revolution of 10 mm: the table starts again with each revolution.
#[test]
fn pitch_table_of_rotary_axis_restarts_each_revolution() {
    let mut config = cell(0, 0, Some(&[(1_000, 20), (6_000, -20)]));
    config.axes[1].modulo = Modulo::new(10_000, 1);
    let mut rig = homed(config);
    // From 6 mm to 11 mm it rises by 40 inc: 8 inc for each mm. The axis is at 0 of its revolution then.
    for (target, expected) in [(1_000, 20), (3_500, 0), (6_000, -20), (8_500, 0), (0, 12)] {
        rig.give(Action::Move(to(X, target)));
        rig.run(1_000);
        assert_eq!((rig.int("x.modulo.position"), compensation(&rig)), (target, expected));
    }
    assert_eq!((rig.int("x.turns"), rig.int("x.actual.count")), (1, 10_012));
    rig.give(Action::Move(at(X, 100_000.0)));
    rig.run(1_000);
    let mut most: i64 = 0;
    for _ in 0..1_000 {
        let last = compensation(&rig);
        rig.run(1);
        most = most.max((compensation(&rig) - last).abs());
        assert_eq!(rig.int("x.following_error"), 0);
    }
    // 0.008 of 100 inc per cycle.
    assert_eq!(most, 1);
}

/// A cycle at rest is skipped with and without compensation; a motion with compensation does not use the fast path. A
/// homed zero keeps vocabularies active, so the zero comes from an absolute encoder here.
#[test]
fn cycles_at_rest_are_skipped_with_compensation() {
    use crate::axis::Pace;
    let pace = |rig: &Rig| rig.machine.state.axes[usize::from(X)].pace();
    let absolute = |backlash, pitch| {
        let mut rig = Rig::of(absolute(cell(3, backlash, pitch)));
        rig.enable();
        rig
    };
    let mut rig = absolute(BACKLASH, Some(&PITCH[..]));
    go(&mut rig, 20_000);
    go(&mut rig, 19_000);
    assert_eq!((pace(&rig), compensation(&rig)), (Pace::Skipped, 17));
    rig.give(Action::Move(to(X, 50_000)));
    rig.run(100);
    assert_eq!(pace(&rig), Pace::Full);
    let mut rig = absolute(0, None);
    rig.give(Action::Move(to(X, 50_000)));
    rig.run(100);
    assert_eq!(pace(&rig), Pace::Reduced);
    // Set in motion, the backlash ends the fast path and is compensated.
    set(&mut rig, "compensation.backlash", Value::Int(BACKLASH));
    rig.run(20);
    assert_eq!(pace(&rig), Pace::Full);
    go(&mut rig, 1_000);
    assert_eq!((compensation(&rig), pace(&rig)), (-BACKLASH, Pace::Skipped));
    set(&mut rig, "compensation.backlash", Value::Int(0));
    rig.run(50);
    rig.give(Action::Move(to(X, 50_000)));
    rig.run(100);
    assert_eq!((compensation(&rig), pace(&rig)), (0, Pace::Reduced));
}

#[test]
fn new_numbers_of_its_table_come_in_by_the_rate_and_wrong_ones_are_refused() {
    let mut rig = homed(cell(0, 0, Some(&PITCH)));
    go(&mut rig, 20_000);
    let load =
        |rig: &mut Rig, points: &[(i64, i64)]| rig.give(Action::LoadTable { table: Arc::new(xy(points)), index: 0 });
    let wrong = load(&mut rig, &[(0, 0), (100, 50), (200, 0)]);
    assert_eq!(
        rig.refusal(wrong),
        "screw: the numbers are no pitch error, as which an axis reads the table, by point 2 (0: by all of it)"
    );
    let few = load(&mut rig, &[(0, 0)]);
    assert!(rig.refusal(few).contains("by point 0"));
    rig.run(10);
    assert_eq!(compensation(&rig), 60);
    let good = load(&mut rig, &[(0, 0), (20_000, -30)]);
    assert!(rig.was_accepted(good));
    assert_eq!(compensation(&rig), 50);
    rig.run(20);
    assert_eq!((compensation(&rig), rig.int("x.actual.position"), rig.int("x.actual.count")), (-30, 20_000, 19_970));
}

#[test]
fn what_cannot_have_a_pitch_error_is_refused() {
    let refused = |change: fn(&mut MachineConfig)| {
        let mut config = cell(0, 0, Some(&PITCH));
        change(&mut config);
        config.check().expect_err("a refusal")
    };
    let of = |axis: &str, problem| ConfigError::Pitch { axis: axis.into(), problem };
    assert_eq!(refused(|config| config.axes[0].pitch_error = Some(0)), of("line", PitchProblem::Interface));
    assert_eq!(
        refused(|config| config.axes[1].interface = Interface::OpenLoop).to_string(),
        "pitch_error of x: it is for axes with interface position, velocity, torque or voltage"
    );
    assert_eq!(refused(|config| config.axes[1].pitch_error = Some(1)), of("x", PitchProblem::Table(1)));
    let steep = refused(|config| config.tables[0].table = Arc::new(xy(&[(0, 0), (9, 1)])));
    assert_eq!(steep, of("x", PitchProblem::Points(PitchError::Steep { point: 2, change: 1, way: 9 })));
    let beyond = refused(|config| config.axes[1].modulo = Modulo::new(60_000, 1));
    let turn = PitchError::Turn { point: 4, x: 70_000, turn: 60_000 };
    assert_eq!(beyond, of("x", PitchProblem::Points(turn)));
}

/// Returns the points of a random table.
fn table() -> impl Strategy<Value = Vec<(i64, i64)>> {
    prop::collection::vec((10_i64..20_000, -1.0..=1.0_f64), 1..12).prop_map(|steps| {
        let mut points = vec![(-30_000, 17)];
        for (way, share) in steps {
            let (x, y) = *points.last().expect("a first one");
            points.push((x + way, y + (way as f64 / 10.0 * share) as i64));
        }
        points
    })
}

proptest! {
    #![proptest_config(cases(24))]

    /// In each cycle the actual position is counts - c, with the c commanded one delay earlier. An ideal drive has no
    /// following error, c never changes faster than its rate, and a restored machine gives the same results.
    #[test]
    fn actual_position_is_counts_minus_commanded_compensation(
        points in table(),
        backlash in 0_i64..2_000,
        rate in prop_oneof![Just(None), (50.0..100_000.0_f64).prop_map(Some)],
        delay in 0_u32..=8,
        moves in prop::collection::vec((-60_000_i64..60_000, 1_000.0..100_000.0_f64, 1_u64..700), 1..8),
        zero in prop::option::of(-50_000_i64..50_000),
        is_rotary in any::<bool>(),
    ) {
        let mut config = cell(delay, backlash, Some(&points));
        let axis = &mut config.axes[1];
        axis.parameters.compensation.velocity = rate;
        axis.parameters.max_following_error = 1;
        if is_rotary {
            axis.modulo = Modulo::new(1 << 40, 1);
        }
        let points = if is_rotary { vec![(0, 5), (20_000, -700)] } else { points };
        config.tables[0].table = Arc::new(xy(&points));
        let mut rig = Rig::of(config);
        rig.enable();
        home(&mut rig, 35);
        let step = rate.unwrap_or(10_000.0) / 1_000.0;
        // The zero was set in this cycle: its command is not answered yet.
        let origin = rig.int("x.actual.count") - rig.int("x.actual.position");
        let mut past: VecDeque<i64> = std::iter::repeat_n(0, delay as usize).collect();
        past.push_back(compensation(&rig));
        let mut shift = 0;
        for (place, (target, velocity, cycles)) in moves.iter().enumerate() {
            if place == moves.len() / 2 {
                rig.mirror();
            }
            let goal = crate::command::Move { velocity: *velocity, ..to(X, *target) };
            rig.give(Action::Move(goal));
            for cycle in 0..*cycles {
                if cycle > 0 {
                    rig.run(1);
                }
                let now = compensation(&rig);
                let before = *past.back().expect("one");
                prop_assert!((now - before).abs() as f64 <= step + 1.0, "{} to {} by {}", before, now, step);
                let answered = past.pop_front().expect("one");
                past.push_back(now);
                let (actual, count) = (rig.int("x.actual.position"), rig.int("x.actual.count"));
                prop_assert_eq!(actual - shift, count - origin - answered);
                prop_assert_eq!((rig.int("x.following_error"), rig.int("x.error")), (0, 0));
            }
            if let Some(zero) = zero.filter(|_| rig.state("x") == "STANDSTILL") {
                let before = rig.int("x.command.position");
                rig.give(Action::SetPosition(SetPosition { axis: X, position: Length::whole(zero) }));
                shift += zero - before;
                past.pop_front();
                past.push_back(compensation(&rig));
            }
        }
    }
}

/// 400 inc at 4000 inc/s take 100 ms, and the move back by 10 inc only a few ms. The goal is done when the load is at
/// the target, not when counts minus commanded compensation are.
#[test]
fn goal_is_done_once_backlash_is_compensated() {
    let mut config = cell(2, 400, None);
    config.axes[1].parameters.compensation.velocity = Some(4_000.0);
    let mut rig = homed(config);
    go(&mut rig, 10_000);
    let goal = rig.give(Action::Move(to(X, 9_990)));
    let mut cycles = 0;
    while rig.done(goal).is_empty() {
        assert_eq!(rig.int("x.in_position"), 0, "after {cycles} ms");
        rig.run(1);
        cycles += 1;
    }
    assert_eq!((compensation(&rig), rig.int("x.actual.count")), (-400, 9_990 - 400));
    assert!((100..150).contains(&cycles), "{cycles}");
}

/// A backlash larger than max_following_error is not detected as a blocked encoder: the counts move while the axis does
/// not.
#[test]
fn compensating_motor_does_not_count_as_blocked_encoder() {
    let mut config = cell(0, 3_000, None);
    let axis = &mut config.axes[1];
    axis.interface = Interface::Velocity;
    axis.parameters.max_following_error = 500;
    axis.parameters.position_loop.kv = 100.0;
    let mut rig = homed(config);
    go(&mut rig, 2_000);
    go(&mut rig, 1_000);
    assert_eq!((rig.int("x.error"), compensation(&rig)), (0, -3_000));
}

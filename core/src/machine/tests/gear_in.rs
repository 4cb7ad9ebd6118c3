//! Gears that wait for a pair of positions (MC_GearInPos), and the approach to it.

use super::rig::{LINE, Rig, X, Y, at, cases, config, couple, to};
use crate::code::Code;
use crate::command::{Action, Engage, Move, Phase, PhaseShift, PhaseSide, Synchronize};
use crate::config::{AxisConfig, IoConfig, IoKind, MachineConfig};
use crate::event::Kind;
use crate::modulo::Modulo;
use crate::object::Leader;
use crate::position::{Length, Position};
use crate::sync::{Disengage, SyncMode};
use proptest::prelude::*;

mod latches;
mod refusals;

const TO_LINE: Leader = Leader::AxisCommand(LINE);
/// Velocity limit of an axis of the rig (inc/cycle), and its acceleration limit (inc/cycle^2); half of both without
/// explicit values.
const FASTEST: f64 = 100.0;
const RATE: f64 = 1.0;

fn rig() -> Rig {
    rig_of(|_| {})
}

fn rig_of(with: fn(&mut AxisConfig)) -> Rig {
    let input = |name: &str| IoConfig { name: name.into(), kind: IoKind::DigitalInput, latch: true };
    let mut config = MachineConfig { io: vec![input("mark"), input("other")], ..config(0) };
    with(&mut config.axes[usize::from(X)]);
    let mut rig = Rig::of(config);
    rig.enable();
    rig
}

fn pair(position: i64, slave: i64, distance: i64) -> Engage {
    Engage::InPosition { position, turn: None, slave, distance }
}

/// Returns the coupling of x to the line.
fn geared(numerator: i64, denominator: i64, engage: Engage) -> Action {
    Action::Synchronize(Synchronize { engage, ..couple(X, TO_LINE, numerator, denominator) })
}

/// Moves the line to a position, at this many inc per cycle, with 1 inc/cycle^2.
fn line(to_place: i64, speed: f64) -> Action {
    let (velocity, acceleration) = (speed * 1e3, 1e6);
    Action::Move(Move { velocity, acceleration, deceleration: acceleration, ..to(LINE, to_place) })
}

fn place(rig: &Rig, axis: u16) -> Position {
    rig.machine.state.leads.get(Leader::AxisCommand(axis)).position
}

fn real(rig: &Rig, axis: u16) -> f64 {
    place(rig, axis).to_f64()
}

/// Runs cycles and checks in each that x keeps its limits, within the resolution of its grid; `look` sees each cycle.
fn watch(rig: &mut Rig, cycles: usize, mut look: impl FnMut(&Rig)) {
    for _ in 0..cycles {
        let (from, before) = (real(rig, X), rig.real("x.command.velocity") / 1e3);
        rig.run(1);
        let step = real(rig, X) - from;
        assert!(step.abs() <= FASTEST + 1e-6, "{step}");
        assert!((step - before).abs() <= RATE + 1e-6, "{before} {step}");
        look(rig);
    }
}

fn warnings(rig: &Rig) -> usize {
    rig.events.iter().filter(|event| matches!(event.kind, Kind::Warning | Kind::Error)).count()
}

/// Position of x for the pair 10000, 3000 at 1 : 1 from rest at 1000, over 4000 inc of the line: y'' = (6 s - 6 s^2) /
/// 4000, so that y = 4000 (s^3 - s^4 / 2).
fn straight_curve(line: f64) -> f64 {
    let s = ((line - 6_000.0) / 4_000.0).clamp(0.0, 1.0);
    1_000.0 + 4_000.0 * (s * s * s - s * s * s * s / 2.0)
}

/// Sets x to 1000, waiting for the pair 10000, 3000 over 4000 at 1 : 1.
fn waiting(rig: &mut Rig) -> u64 {
    rig.give(Action::Move(to(X, 1_000)));
    rig.run(500);
    let goal = rig.give(geared(1, 1, pair(10_000, 3_000, 4_000)));
    assert!(rig.was_accepted(goal));
    rig.run(3);
    assert_eq!((rig.int("x.sync.waiting"), rig.state("x")), (goal as i64, "STANDSTILL"));
    goal
}

#[test]
fn from_rest_it_goes_the_curve_and_is_exact_behind_the_pair() {
    let mut rig = rig();
    let goal = waiting(&mut rig);
    rig.give(line(30_000, 19.7));
    let mut seen = [0; 3];
    watch(&mut rig, 1_000, |rig| {
        let now = real(rig, LINE);
        let state = (rig.state("x"), rig.int("x.sync.waiting"), rig.int("x.in_sync"));
        match () {
            () if now < 6_000.0 => {
                seen[0] += 1;
                assert_eq!((real(rig, X), state), (1_000.0, ("STANDSTILL", goal as i64, 0)));
            }
            // It is engaged in the cycle that passes its start, and on the curve from the next cycle.
            () if now < 10_000.0 => {
                seen[1] += 1;
                assert_eq!(state, ("SYNCHRONIZED_MOTION", 0, 0));
                assert!((real(rig, X) - straight_curve(now)).abs() < if seen[1] == 1 { 1e-3 } else { 1e-6 }, "{now}");
                assert_eq!(rig.int("x.reference"), 4);
            }
            () => {
                seen[2] += 1;
                assert_eq!(state, ("SYNCHRONIZED_MOTION", 0, 1));
                assert_eq!(place(rig, X) - place(rig, LINE), Position::whole(3_000 - 10_000));
            }
        }
    });
    // 4000 inc at 19.7 inc each.
    assert!(seen[0] > 300 && (202..=204).contains(&seen[1]) && seen[2] > 300, "{seen:?}");
    assert_eq!((warnings(&rig), rig.done(goal).len()), (0, 0));
}

/// 1.5 : 1 from 0.5 : 1, which is the ratio of 10 inc per cycle to the 20 inc of the line: the ratio changes by 1 in
/// 4000 inc, by at most 1.5 / 4000 per inc, times 400.
#[test]
fn a_slave_that_moves_goes_on_from_its_velocity() {
    let mut rig = rig();
    rig.give(line(60_000, 20.0));
    rig.give(Action::Move(at(X, 10_000.0)));
    rig.run(100);
    // From now on it moves half the travel of the line; then 4000 inc at the mean of 0.5 and 1.5.
    let way = (16_000.0 - real(&rig, LINE)) / 2.0;
    let slave = (real(&rig, X) + way).round() as i64 + 4_000;
    let goal = rig.give(geared(3, 2, pair(20_000, slave, 4_000)));
    let mut before = 10.0;
    let mut passed = 0;
    watch(&mut rig, 1_500, |rig| {
        let speed = rig.real("x.command.velocity") / 1e3;
        assert!((speed - before).abs() <= 1.5 / 4_000.0 * 400.0 + 1e-3, "{before} {speed}");
        before = speed;
        if real(rig, LINE) >= 20_000.0 {
            passed += 1;
            let way = (place(rig, LINE) - Position::whole(20_000)).raw() * 3;
            assert_eq!(place(rig, X).raw(), (i128::from(slave) << 32) + way.div_euclid(2));
        }
    });
    assert!(passed > 300 && rig.done(goal).is_empty() && warnings(&rig) == 0);
}

/// x accelerates by 1 inc/cycle^2, its maximum, and its start is 19/20 of a cycle before the event. A velocity from v
/// to 60 over 200 cycles, with an acceleration from 1 to 0, is a polynomial of 3rd order with a mean of (v + 60) / 2 +
/// 200 / 12; its acceleration never exceeds that at its start.
#[test]
fn a_slave_that_speeds_up_goes_on_from_its_velocity_at_the_start() {
    let mut rig = rig();
    rig.give(line(100_000, 20.0));
    rig.run(300);
    rig.give(Action::Move(Move { acceleration: 1e6, ..at(X, 90_000.0) }));
    let velocity = rig.real("x.command.velocity") / 1e3;
    let stands = real(&rig, X) + velocity * 28.0 + 28.0 * 28.0 / 2.0;
    let start = real(&rig, LINE).floor() as i64 + 541;
    let slave = stands + 200.0 * ((velocity + 28.0 + 60.0) / 2.0 + 200.0 / 12.0);
    let engage = pair(start + 4_000, slave.round() as i64, 4_000);
    // In the middle it is faster than at the end.
    let goal = rig.give(Action::Synchronize(Synchronize { engage, velocity: 1e5, ..couple(X, TO_LINE, 3, 1) }));
    watch(&mut rig, 26, |_| {});
    assert_eq!(rig.int("x.sync.waiting"), goal as i64);
    watch(&mut rig, 1, |_| {});
    assert_eq!((rig.int("x.sync.waiting"), rig.state("x")), (0, "SYNCHRONIZED_MOTION"));
    watch(&mut rig, 300, |_| {});
    assert_eq!((warnings(&rig), rig.done(goal).len(), rig.int("x.in_sync")), (0, 0, 1));
    let way = place(&rig, LINE) - Position::whole(start + 4_000);
    assert_eq!(place(&rig, X).raw(), (i128::from(slave.round() as i64) << 32) + way.raw() * 3);
}

/// With a lead of 10 cycles by the previous gear and by that of the pair: at the pair and after it the slave is at the
/// position of the pair plus the lead for its velocity.
///
/// Proves: MACS-SYNC-15
#[test]
fn a_pair_that_is_taken_over_is_one_of_places_without_the_lead() {
    for (numerator, slave, distance, lead) in [(3, 12_000, 4_000, 300.0), (1, 10_000, 0, 100.0)] {
        let mut rig = rig_of(|axis| axis.parameters.sync.feed_forward = 10_000);
        rig.give(Action::Synchronize(couple(X, TO_LINE, 1, 2)));
        rig.give(line(60_000, 20.0));
        rig.run(300);
        assert_eq!(rig.int("x.in_sync"), 1);
        assert!((real(&rig, X) - real(&rig, LINE) / 2.0 - 100.0).abs() < 1e-6);
        rig.give(geared(numerator, 2, pair(20_000, slave, distance)));
        rig.run(1_200);
        assert_eq!((rig.int("x.sync.waiting"), rig.int("x.in_sync")), (0, 1));
        let geared = slave as f64 + (real(&rig, LINE) - 20_000.0) * numerator as f64 / 2.0;
        assert!((real(&rig, X) - geared - lead).abs() < 1e-6, "{}", real(&rig, X) - geared);
        rig.run(3_000);
        assert_eq!(place(&rig, X), Position::whole(slave + 20_000 * numerator));
    }
}

/// The offset at the start is included in the pair; a new offset shifts the slave by the difference.
///
/// Proves: MACS-SYNC-14
#[test]
fn previous_offset_is_included_in_pair() {
    let mut rig = rig_of(|axis| axis.parameters.sync.offset = 500);
    waiting(&mut rig);
    rig.give(line(30_000, 19.7));
    watch(&mut rig, 700, |rig| {
        let now = real(rig, LINE);
        assert!(now >= 10_000.0 || (real(rig, X) - straight_curve(now)).abs() < 1e-3, "{now}");
    });
    assert_eq!((warnings(&rig), place(&rig, X) - place(&rig, LINE)), (0, Position::whole(-7_000)));
    let given = super::direction::set(&mut rig, &[("syncposoffs", 700)]);
    assert!(rig.was_accepted(given));
    watch(&mut rig, 400, |_| {});
    assert_eq!((rig.int("x.in_sync"), place(&rig, X) - place(&rig, LINE)), (1, Position::whole(-6_800)));
}

/// From a gear of 1 : 2 to the line it changes to 3 : 2 without a velocity step.
#[test]
fn a_gear_of_the_same_leader_passes_into_the_pair() {
    let mut rig = rig();
    let first = rig.give(Action::Synchronize(couple(X, TO_LINE, 1, 2)));
    rig.give(line(60_000, 20.0));
    // At 16000 it is at 8000.
    let goal = rig.give(geared(3, 2, pair(20_000, 12_000, 4_000)));
    rig.mirror();
    rig.run(100);
    let mut before = 10.0;
    watch(&mut rig, 1_500, |rig| {
        let speed = rig.real("x.command.velocity") / 1e3;
        assert!((speed - before).abs() <= 0.15 + 1e-3, "{before} {speed}");
        before = speed;
    });
    assert_eq!((rig.done(first)[0].code, rig.done(goal).len(), warnings(&rig)), (Code::REPLACED, 0, 0));
    assert_eq!(rig.int("x.in_sync"), 1);
    let way = (place(&rig, LINE) - Position::whole(20_000)).raw() * 3;
    assert_eq!(place(&rig, X).raw(), (12_000_i128 << 32) + way.div_euclid(2));
}

/// The leader stops during the approach, moves back before the start and returns: the curve is always the same.
#[test]
fn curve_depends_on_leader_position_only() {
    let mut rig = rig();
    let goal = waiting(&mut rig);
    rig.mirror();
    for stop in [8_000, 7_000, 9_500, 5_000, 5_500, 9_000, 6_000] {
        rig.give(line(stop, 17.3));
        let mut engaged = rig.int("x.sync.waiting") == 0;
        watch(&mut rig, 700, |rig| {
            let is_first = !engaged && rig.int("x.sync.waiting") == 0;
            engaged |= is_first;
            assert!((real(rig, X) - straight_curve(real(rig, LINE))).abs() < if is_first { 1e-3 } else { 1e-6 });
        });
        assert_eq!((rig.int("line.command.position"), rig.int("x.in_sync")), (stop, 0));
    }
    assert_eq!(place(&rig, X), Position::whole(1_000));
    rig.give(line(12_000, 17.3));
    watch(&mut rig, 600, |_| {});
    // After the pair it is a gear: back before the pair there is no curve any more.
    assert_eq!((place(&rig, X), rig.int("x.in_sync")), (Position::whole(5_000), 1));
    rig.give(line(7_000, 17.3));
    watch(&mut rig, 600, |_| {});
    assert_eq!((place(&rig, X), rig.int("x.sync.error")), (Position::whole(0), 0));
    assert_eq!((warnings(&rig), rig.done(goal).len()), (0, 0));
}

/// Twice as fast in the middle, and then too fast for x: x lags within its limits, reports this, and still reaches the
/// gear of the pair.
#[test]
fn a_leader_that_runs_faster_never_drives_the_slave_beyond_its_limits() {
    let mut rig = rig();
    waiting(&mut rig);
    rig.give(line(60_000, 20.0));
    rig.run_to("line.command.position", 7_000.0);
    rig.give(line(60_000, 90.0));
    watch(&mut rig, 1_500, |_| {});
    assert_eq!((place(&rig, X), rig.int("x.in_sync")), (Position::whole(53_000), 1));
}

/// 1000 is passed at 1000 + n * 4000: from 0 the start, 2000 before it, is at 3000.
#[test]
fn a_pair_in_the_turn_of_the_leader_is_the_next_one_that_leaves_the_way() {
    let engage = Engage::InPosition { position: 1_000, turn: Modulo::new(4_000, 1), slave: 1_100, distance: 2_000 };
    let mut rig = rig();
    rig.give(geared(1, 1, engage));
    rig.give(line(9_000, 10.0));
    rig.run_to("line.command.position", 2_980.0);
    assert!(rig.int("x.sync.waiting") != 0);
    watch(&mut rig, 1_000, |_| {});
    assert_eq!(place(&rig, X), Position::whole(1_100 + 9_000 - 5_000));
    // The slave has a revolution of its own: of 1100 + n * 3600 the value nearest to 7000 + 2000 / 2 applies.
    let mut rig = rig_of(|axis| axis.modulo = Modulo::new(3_600, 1));
    rig.give(Action::Move(Move { mode: crate::command::MoveMode::Relative, ..to(X, 7_000) }));
    rig.run(1_000);
    rig.give(geared(1, 1, engage));
    rig.give(line(9_000, 10.0));
    watch(&mut rig, 1_400, |_| {});
    assert_eq!(place(&rig, X), Position::whole(7_200 + 1_100 + 4_000));
}

/// From above: the start is above the position.
#[test]
fn a_leader_from_above_starts_above() {
    let mut rig = rig();
    rig.give(line(20_000, 90.0));
    rig.run(400);
    // From 0 down by 2000.
    let goal = rig.give(geared(1, 1, pair(10_000, -2_000, 4_000)));
    rig.give(line(5_000, 20.0));
    rig.run_until("x.sync.waiting", 0);
    assert!((13_980..=14_000).contains(&rig.int("line.command.position")));
    watch(&mut rig, 800, |_| {});
    assert_eq!((place(&rig, X), rig.done(goal).len(), warnings(&rig)), (Position::whole(-7_000), 0, 0));
}

/// A leader with whole counts, at 7.3 inc per cycle: its curve is followed with a resolution of one count, and the pair
/// is exact.
#[test]
fn a_counted_leader_leads_along_the_curve() {
    let mut rig = rig();
    rig.give(Action::Move(to(X, 1_000)));
    rig.run(500);
    let engage = pair(10_000, 3_000, 4_000);
    rig.give(Action::Synchronize(Synchronize { engage, ..couple(X, Leader::Encoder(0), 1, 1) }));
    let mut counted = 0;
    for k in 0..2_000_i64 {
        let next = 73 * k / 10;
        rig.plant.jump_encoder(0, next - counted);
        counted = next;
        let before = (real(&rig, X), rig.real("x.command.velocity") / 1e3);
        rig.run(1);
        let belt = rig.int("belt.position");
        let step = real(&rig, X) - before.0;
        // One count more or less is not an acceleration.
        assert!((step - before.1).abs() <= RATE + 1.0 + 1e-6, "{step}");
        if belt > 6_010 && belt < 10_000 {
            assert!((real(&rig, X) - straight_curve(belt as f64)).abs() < 1e-6);
        } else if belt >= 10_000 {
            assert_eq!((place(&rig, X), rig.int("x.in_sync")), (Position::whole(belt - 7_000), 1));
        }
    }
    assert_eq!((rig.int("belt.position") > 14_000, warnings(&rig)), (true, 0));
}

/// 3 counts in 10 cycles, at 100 : 1 over 100: 150 * 0.3^2 / 100 is less than half of the limit of x; for one count per
/// cycle it would be three times the limit.
#[test]
fn a_counted_leader_is_judged_by_its_speed_and_not_by_a_count() {
    let mut rig = rig();
    let belt = Leader::Encoder(0);
    let mut goal = 0;
    for cycle in 0..600 {
        let counts = i64::from(matches!(cycle % 10, 0 | 3 | 6));
        rig.plant.jump_encoder(0, counts);
        if cycle == 100 {
            assert_eq!(counts, 1);
            // 30 cycles before its start.
            let engage = pair(rig.int("belt.position") + 110, 5_000, 100);
            goal = rig.give(Action::Synchronize(Synchronize { engage, ..couple(X, belt, 100, 1) }));
            assert_eq!(rig.answer(goal), Ok(()));
        } else {
            rig.run(1);
        }
        if cycle == 120 {
            assert_eq!(rig.int("x.sync.waiting"), goal as i64);
        }
    }
    assert_eq!((rig.int("x.sync.waiting"), rig.state("x"), rig.done(goal).len()), (0, "SYNCHRONIZED_MOTION", 0));
}

/// Without a start distance it starts at the position, and catches up the distance.
#[test]
fn without_a_distance_the_pair_is_caught_up() {
    let mut rig = rig();
    let goal = rig.give(geared(3, 7, pair(5_000, 500, 0)));
    rig.give(line(40_000, 21.3));
    while real(&rig, LINE) < 5_000.0 {
        assert_eq!((place(&rig, X), rig.int("x.sync.waiting")), (Position::ZERO, goal as i64));
        rig.run(1);
    }
    assert_eq!((rig.int("x.sync.waiting"), rig.int("x.in_sync")), (0, 0));
    watch(&mut rig, 300, |_| {});
    assert_eq!((rig.int("x.in_sync"), rig.int("x.sync.error"), rig.done(goal).len()), (1, 0, 0));
    let way = (place(&rig, LINE) - Position::whole(5_000)).raw() * 3;
    assert_eq!(place(&rig, X).raw(), (500_i128 << 32) + way.div_euclid(7));
}

/// In mode VELOCITY there is no pair: it starts when the leader reaches the position, from either side.
#[test]
fn by_velocity_it_begins_at_the_place() {
    for (from, end) in [(0, 9_000), (9_000, 0)] {
        let mut rig = rig();
        rig.give(line(from, 90.0));
        rig.run(400);
        let engage = Engage::AtPosition { position: 5_000, turn: None };
        let coupling = couple(X, TO_LINE, 1, 2);
        rig.give(Action::Synchronize(Synchronize { engage, mode: SyncMode::Velocity, ..coupling }));
        rig.give(line(end, 20.0));
        let mut was = 0;
        while rig.int("x.sync.waiting") != 0 {
            assert_eq!(place(&rig, X), Position::ZERO);
            was = rig.int("line.command.position");
            rig.run(1);
        }
        let now = rig.int("line.command.position");
        assert!(was.min(now) <= 5_000 && was.max(now) >= 5_000, "{was} {now}");
        rig.run(100);
        let sign = if end > from { 10_000.0 } else { -10_000.0 };
        assert_eq!((rig.real("x.command.velocity"), rig.int("x.sync.error")), (sign, 0));
    }
}

/// Phase shifts in the approach: a slave shift in addition to the curve, a master shift along it; earlier shifts do not
/// count for a pair.
#[test]
fn shifts_in_the_approach_shift_it() {
    let mut rig = rig();
    rig.give(Action::Synchronize(couple(X, TO_LINE, 1, 2)));
    let shift = |shift| PhaseShift { shift: Length::whole(shift), velocity: 1_000.0, acceleration: 1e5 };
    let of_slave = |by| Action::Phase(Phase { axis: X, side: PhaseSide::Slave(shift(by)) });
    rig.give(geared(1, 1, pair(10_000, 7_000, 4_000)));
    rig.give(line(30_000, 20.0));
    rig.run(200);
    let before = rig.give(of_slave(5_000));
    rig.run_until("x.sync.waiting", 0);
    assert_eq!(rig.done(before)[0].code, Code::REPLACED);
    let during = rig.give(of_slave(100));
    assert!(rig.was_accepted(during));
    rig.run(600);
    assert_eq!(rig.done(during)[0].code, Code::NONE);
    assert_eq!(place(&rig, X) - place(&rig, LINE), Position::whole(7_000 - 10_000 + 100));
}

proptest! {
    #![proptest_config(cases(48))]

    /// With any motion of the leader in the approach, the slave keeps its limits, and after the pair it is exact.
    #[test]
    fn an_approach_keeps_the_limits(
        (numerator, denominator) in (prop::sample::select(vec![-3_i64, -1, 1, 2, 7]), 1_i64..6),
        (distance, share) in (1_000_i64..8_000, 0.2..0.8_f64),
        speed in 1.0..40.0_f64,
        moves in prop::collection::vec((5_000_i64..12_000, 1.0..60.0_f64, 1_usize..400), 0..6),
        moving in prop::option::of(-20.0..20.0_f64),
    ) {
        let mut rig = rig();
        if let Some(velocity) = moving {
            rig.give(Action::Move(at(X, velocity * 1e3)));
        }
        let slave = (numerator as f64 / denominator as f64 * distance as f64 * share) as i64;
        let goal = rig.give(geared(numerator, denominator, pair(10_000, slave, distance)));
        prop_assert_eq!(rig.answer(goal), Ok(()));
        rig.give(line(9_999, speed));
        watch(&mut rig, 10, |_| {});
        for (stop, speed, cycles) in moves {
            rig.give(line(stop, speed));
            watch(&mut rig, cycles, |_| {});
        }
        rig.give(line(40_000, speed));
        watch(&mut rig, (40_000.0 / speed) as usize + 1_000, |_| {});
        if let Some(done) = rig.done(goal).first() {
            let codes = [Code::ENGAGE_TOO_SHORT, Code::ENGAGE_PASSED, Code::VELOCITY_TOO_HIGH];
            prop_assert!(codes.contains(&done.code), "{:?}", done);
        } else {
            prop_assert_eq!(rig.int("x.in_sync"), 1);
            let way = (place(&rig, LINE) - Position::whole(10_000)).raw() * i128::from(numerator);
            prop_assert_eq!(place(&rig, X).raw(), (i128::from(slave) << 32) + way.div_euclid(denominator.into()));
        }
    }
}

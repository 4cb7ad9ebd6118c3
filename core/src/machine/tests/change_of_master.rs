//! Changes of master, ratio or mode while an axis is coupled and moves.

use super::direction::set;
use super::rig::{LINE, Rig, X, Y, at, cam, cases, config, couple, to};
use crate::code::Code;
use crate::command::{Action, Engage, Move, Phase, PhaseShift, PhaseSide, Synchronize};
use crate::config::{IoConfig, IoKind, SumConfig, TableConfig};
use crate::drive::{Edge, Latch};
use crate::object::{Leader, Object};
use crate::parameter::{Change, MACHINE, Row, Value};
use crate::position::{Length, Position};
use crate::sync::{CamStart, SyncMode};
use crate::table::{CamSetting, Form, Table};
use proptest::prelude::*;
use std::sync::Arc;

const MARK: Object = Object::Io(0);
const MASTERS: [Leader; 4] = [Leader::AxisCommand(LINE), Leader::AxisCommand(Y), Leader::Virtual, Leader::Sum(0)];
/// Tables with a constant slope, 3/4 and -1/2.
const SLOPES: [(i64, i64); 2] = [(3, 4), (-1, 2)];

/// The line runs at 20 inc per cycle, y at 12, the virtual master at 9, and there is a sum of line and y; x is at rest.
fn rig() -> Rig {
    let mut config = config(0);
    let input = |name: &str| IoConfig { name: name.into(), kind: IoKind::DigitalInput, latch: true };
    config.io = vec![input("mark"), input("label")];
    config.masters = vec![SumConfig {
        name: "both".into(),
        add: vec![Leader::AxisCommand(LINE)],
        subtract: vec![Leader::AxisCommand(Y)],
    }];
    config.tables = (SLOPES.iter().zip(["rising", "falling"]))
        .map(|((rise, length), name)| {
            let table = Table::new(Form::Xy, &[0, length * 4_000], &[0, rise * 4_000]).expect("points");
            TableConfig { name: name.into(), table: Arc::new(table.with_cam(CamSetting::default())) }
        })
        .collect();
    let mut rig = Rig::of(config);
    rig.enable();
    let marks = [("syncmtypm", 12), ("syncmtyps", 22), ("syncmpulsm", 1_000), ("syncmpulss", 1_000)];
    let given = set(&mut rig, &marks);
    assert!(rig.was_accepted(given));
    let change = |(key, value): (&str, i64)| {
        let row = Row::find(key).expect("a row").0;
        Change { axis: MACHINE, row, value: Value::Int(value) }
    };
    let given = rig.give(Action::SetParameters([("pulsacc", 1_000_000), ("pulsvel", 9_000)].map(change).into()));
    assert!(rig.was_accepted(given));
    rig.give(Action::Move(at(LINE, 20_000.0)));
    rig.give(Action::Move(at(Y, 12_000.0)));
    rig.run(100);
    rig
}

fn lead(rig: &Rig, leader: Leader) -> Position {
    rig.machine.state.leads.get(leader).position
}

fn place(rig: &Rig, axis: u16) -> Position {
    lead(rig, Leader::AxisCommand(axis))
}

/// Next coupling of x.
#[derive(Clone, Copy, Debug)]
struct CouplingRequest {
    master: usize,
    /// 0 VELOCITY, 1 POSITION, 2 MARKER, 3 and 4 CAM.
    mode: usize,
    ratio: (i64, i64),
    /// 0 IMMEDIATELY, 1 AT_POSITION, 2 ON_EVENT.
    engage: usize,
    /// Acceleration of the goal (inc/s^2).
    acceleration: f64,
    /// Cycles until the next coupling.
    cycles: u64,
}

impl CouplingRequest {
    fn leader(&self) -> Leader {
        MASTERS[self.master]
    }

    fn is_cam(&self) -> bool {
        self.mode >= 3
    }

    /// Returns the goal for the present position of its master: AT_POSITION is reached in about 40 cycles.
    fn goal(&self, rig: &Rig) -> Synchronize {
        let leader = self.leader();
        let now = rig.machine.state.leads.get(leader);
        let place = now.position.nearest() + (now.change.to_f64() * 40.0) as i64;
        let is_position = self.mode == 1;
        let engage = match self.engage {
            1 if self.mode == 2 => Engage::Immediately,
            1 if is_position => {
                let slave = self::place(rig, X).nearest();
                Engage::InPosition { position: place, turn: None, slave, distance: 0 }
            }
            1 => Engage::AtPosition { position: place, turn: None },
            2 if self.mode != 2 => Engage::OnEvent(MARK),
            _ => Engage::Immediately,
        };
        let mode = [SyncMode::Velocity, SyncMode::Position, SyncMode::Marker, SyncMode::Position, SyncMode::Position];
        let (numerator, denominator) = if self.is_cam() { (0, 0) } else { self.ratio };
        let cam = self.is_cam().then(|| cam((self.mode - 3) as u16, CamStart::Relative));
        Synchronize {
            mode: mode[self.mode],
            engage,
            acceleration: self.acceleration,
            cam,
            ..couple(X, leader, numerator, denominator)
        }
    }

    /// Returns the slave travel per increment of the master, as a fraction.
    fn slope(&self) -> (i64, i64) {
        if self.is_cam() { SLOPES[self.mode - 3] } else { self.ratio }
    }
}

fn coupling_request() -> impl Strategy<Value = CouplingRequest> {
    let ratio = (prop::sample::select(vec![-2_i64, -1, 1, 2, 3, 7, 113]), prop::sample::select(vec![1_i64, 3, 7, 355]))
        .prop_map(|(part, of)| (part, of.max(part.abs() / 2)));
    (0_usize..4, 0_usize..5, ratio, 0_usize..3, 1e5..1e6_f64, 60_u64..400).prop_map(
        |(master, mode, ratio, engage, acceleration, cycles)| CouplingRequest {
            master,
            mode,
            ratio,
            engage,
            acceleration,
            cycles,
        },
    )
}

fn latch(rig: &mut Rig) {
    assert!(rig.plant.add_latch(Latch { object: MARK, edge: Edge::Rising, age_ns: Some(400_000), position: None }));
}

/// Gives a goal and runs for its cycles; `seen` checks each cycle with the velocity before and after it.
fn follow(rig: &mut Rig, wish: &CouplingRequest, mut seen: impl FnMut(&Rig, f64, f64)) -> u64 {
    let goal = rig.give(Action::Synchronize(wish.goal(rig)));
    let mut before = rig.real("x.command.velocity");
    for cycle in 0..wish.cycles {
        if cycle == 30 && wish.engage == 2 {
            latch(rig);
        }
        rig.run(1);
        let now = rig.real("x.command.velocity");
        seen(rig, before, now);
        before = now;
    }
    goal
}

proptest! {
    #![proptest_config(cases(120))]

    /// From any coupling to any other, immediately, at a position or at a latch: a velocity step never exceeds the
    /// acceleration of the goals. For a cam, which starts in place with any slope, it never exceeds the limit of the
    /// axis. A follower of x keeps its gear ratio in each cycle.
    ///
    /// Proves: MACS-SYNC-04
    #[test]
    fn no_change_is_a_step_of_velocity(wishes in prop::collection::vec(coupling_request(), 2..5), restored in any::<bool>()) {
        let mut rig = rig();
        if restored {
            rig.mirror();
        }
        let mut before: Option<CouplingRequest> = None;
        for wish in &wishes {
            // A cam that starts exactly at its event reaches its slope at once, within the limits of the axis.
            let is_cam = wish.is_cam() || before.is_some_and(|before| before.is_cam());
            let asked = wish.acceleration.max(before.map_or(0.0, |before| before.acceleration));
            let most = if is_cam { 1e6 } else { asked } / 1e3 + 0.01;
            let mut steps = vec![];
            let goal = follow(&mut rig, wish, |rig, before, now| {
                if (now - before).abs() > most {
                    steps.push((rig.machine.next_cycle(), before, now));
                }
            });
            prop_assert_eq!(rig.answer(goal), Ok(()), "{:?}", wish);
            prop_assert!(steps.is_empty(), "{:?} after {:?}: {:?} beyond {}", wish, before, steps, most);
            prop_assert_eq!((rig.state("x"), rig.int("x.sync.waiting")), ("SYNCHRONIZED_MOTION", 0), "{:?}", wish);
            before = Some(*wish);
        }
    }

    /// With further influences: a velocity lead, offsets, a filter, an active shift, counts of an encoder.
    #[test]
    fn change_of_coupling_with_other_influences_is_no_velocity_step(
        wishes in prop::collection::vec((coupling_request(), any::<bool>(), any::<bool>()), 2..5),
        (ahead, offset, time) in (prop::sample::select(vec![0_i64, 3_000, 20_000]), -400_i64..400, prop::sample::select(vec![0_i64, 150, 600])),
        filter in prop::sample::select(vec![0_i64, -20_000, 30_000]),
    ) {
        let mut rig = rig();
        let changes = [("syncffvel", ahead), ("syncposoffs", offset), ("syncofftime", time), ("syncvftime", filter)];
        let given = set(&mut rig, &changes);
        prop_assert!(rig.was_accepted(given));
        // The belt runs before any axis follows it.
        for _ in 0..100 {
            rig.plant.jump_encoder(0, 15);
            rig.run(1);
        }
        let mut slopes = 0.0_f64;
        for (wish, by_counts, shifts) in &wishes {
            let goal = Synchronize { leader: Some(if *by_counts { Leader::Encoder(0) } else { wish.leader() }), ..wish.goal(&rig) };
            let engage = if *by_counts && wish.engage == 1 { Engage::Immediately } else { goal.engage };
            let mut before = rig.real("x.command.velocity");
            rig.plant.jump_encoder(0, 15);
            let goal = rig.give(Action::Synchronize(Synchronize { engage, ..goal }));
            prop_assert_eq!(rig.answer(goal), Ok(()), "{:?}", wish);
            let slope = (wish.slope().0 as f64 / wish.slope().1 as f64).abs();
            // One count more or less, of the previous coupling or of this one, geared and with velocity lead, is not an
            // acceleration.
            let counts = slopes.max(slope) * 1_000.0 * (1.0 + 2.0 * ahead as f64 / 1e3);
            slopes = slope;
            prop_assert!((rig.real("x.command.velocity") - before).abs() <= 1_000.0 + counts + 0.01);
            before = rig.real("x.command.velocity");
            for cycle in 0..wish.cycles {
                if cycle == 30 && wish.engage == 2 {
                    latch(&mut rig);
                }
                let mut actions = vec![];
                if cycle == wish.cycles - 60 && *shifts {
                    let shift = PhaseShift { shift: Length::whole(5_000), velocity: 4_000.0, acceleration: 100_000.0 };
                    actions.push(Action::Phase(Phase { axis: X, side: PhaseSide::Slave(shift) }));
                }
                rig.plant.jump_encoder(0, 15);
                rig.give_all(actions);
                let now = rig.real("x.command.velocity");
                let most = 1_000.0 + counts + 0.01;
                prop_assert!((now - before).abs() <= most, "{:?}: {} to {} in {}", wish, before, now, cycle);
                before = now;
            }
        }
    }

    /// A goal that waits for its event changes nothing until then: the present coupling continues as if it were not to
    /// be replaced.
    #[test]
    fn previous_coupling_holds_until_next_engages(first in coupling_request(), next in coupling_request()) {
        // MARKER does not wait.
        let (engage, mode) = (if next.engage == 0 { 2 } else { next.engage }, if next.mode == 2 { 1 } else { next.mode });
        let next = CouplingRequest { engage, mode, ..next };
        let (mut changed, mut kept) = (rig(), rig());
        for rig in [&mut changed, &mut kept] {
            follow(rig, &CouplingRequest { engage: 0, ..first }, |_, _, _| {});
        }
        let wanted = Action::Synchronize(next.goal(&changed));
        let goal = changed.give(wanted);
        kept.run(1);
        prop_assert_eq!(changed.answer(goal), Ok(()));
        let mut waited = 0;
        while changed.int("x.sync.waiting") != 0 {
            for name in ["velocity", "acceleration"] {
                let signal = format!("x.command.{name}");
                prop_assert_eq!(changed.real(&signal), kept.real(&signal), "{}", signal);
            }
            prop_assert_eq!(place(&changed, X), place(&kept, X));
            prop_assert_eq!(changed.int("x.sync.error"), kept.int("x.sync.error"));
            waited += 1;
            prop_assert!(waited < 200);
            if waited == 30 && next.engage == 2 {
                latch(&mut changed);
                latch(&mut kept);
            }
            changed.run(1);
            kept.run(1);
        }
        // Also in the cycle in which it starts.
        prop_assert_eq!(place(&changed, X), place(&kept, X));
        prop_assert!(waited > 25);
    }

    /// From gears and cams to others, with any masters and ratios, only the rounding of the remainder to 2^-32 inc is
    /// lost: once in sync, x is at its position at that moment + slope * (travel of the master since then).
    ///
    /// Proves: MACS-SYNC-02
    #[test]
    fn no_fraction_is_lost(wishes in prop::collection::vec(coupling_request(), 1..6)) {
        let mut rig = rig();
        for wish in &wishes {
            let mode = [1, 1, 1, 3, 4][wish.mode];
            let wish = CouplingRequest { mode, engage: 0, acceleration: 1e6, cycles: 400, ..*wish };
            let goal = rig.give(Action::Synchronize(wish.goal(&rig)));
            prop_assert_eq!(rig.answer(goal), Ok(()));
            // In the cycle of the command all axes still move as before.
            let (slave, master) = (place(&rig, X), lead(&rig, wish.leader()));
            rig.run_until("x.in_sync", 1);
            let (rise, length) = wish.slope();
            for _ in 0..wish.cycles {
                rig.run(1);
                let way = (lead(&rig, wish.leader()) - master).raw() * i128::from(rise);
                let off = (place(&rig, X) - slave).raw() - way.div_euclid(length.into());
                prop_assert!((0..=1).contains(&off), "{} units", off);
            }
        }
    }

    /// In a chain the middle axis changes its master in motion, and the last axis keeps its gear ratio to it in each
    /// cycle.
    #[test]
    fn a_master_that_changes_its_own_master_keeps_its_followers(
        wishes in prop::collection::vec(coupling_request(), 1..4), ratio in prop::sample::select(vec![(1_i64, 2_i64), (-1, 1), (2, 3), (355, 452)]),
    ) {
        let mut rig = rig();
        // y follows x, so it cannot be a master of x.
        rig.give(Action::Synchronize(couple(X, MASTERS[0], 1, 3)));
        rig.give(Action::Synchronize(couple(Y, Leader::AxisCommand(X), ratio.0, ratio.1)));
        rig.run(600);
        prop_assert_eq!((rig.int("x.in_sync"), rig.int("y.in_sync")), (1, 1));
        let (x, y) = (place(&rig, X), place(&rig, Y));
        for wish in &wishes {
            let wish = CouplingRequest { master: if wish.master % 2 == 0 { 0 } else { 2 }, acceleration: 9e5, ..*wish };
            let mut off = vec![];
            let goal = follow(&mut rig, &wish, |rig, _, _| {
                let way = ((place(rig, X) - x).raw() * i128::from(ratio.0)).div_euclid(ratio.1.into());
                off.push(((place(rig, Y) - y).raw() - way).abs());
            });
            prop_assert_eq!(rig.answer(goal), Ok(()));
            let most = off.iter().max().copied().unwrap_or_default();
            prop_assert!(most <= 1, "{:?}: {} units", wish, most);
        }
    }

    /// A refused goal, and one that fails at its event, leave the coupling unchanged, to the last bit of its remainder.
    #[test]
    fn a_refused_goal_leaves_the_coupling_as_it_was(first in coupling_request(), which in 0_usize..8, after in 1_u64..200) {
        let (mut refused, mut kept) = (rig(), rig());
        for rig in [&mut refused, &mut kept] {
            follow(rig, &CouplingRequest { engage: 0, cycles: after, ..first }, |_, _, _| {});
        }
        let gear = couple(X, MASTERS[0], 1, 1);
        let away = crate::command::CamIn { slave_offset: Length::whole(50_000), ..cam(0, CamStart::Absolute) };
        let bad = match which {
            0 => Synchronize { numerator: 1, denominator: 0, ..gear },
            1 => Synchronize { velocity: 200_000.0, ..gear },
            2 => Synchronize { acceleration: 2e6, ..gear },
            3 => couple(X, Leader::AxisCommand(X), 1, 1),
            4 => Synchronize { cam: Some(away), ..couple(X, MASTERS[2], 0, 0) },
            5 => Synchronize { cam: Some(cam(0, CamStart::Relative)), engage: Engage::AtEnd, ..couple(X, MASTERS[2], 0, 0) },
            6 => Synchronize { cam: Some(cam(7, CamStart::Relative)), ..couple(X, MASTERS[1], 0, 0) },
            _ => {
                let position = place(&refused, LINE).nearest() + 500;
                let engage = Engage::InPosition { position, turn: None, slave: 0, distance: 5_000 };
                Synchronize { engage, ..gear }
            }
        };
        // An active cam of the virtual master has an end that can be waited for.
        prop_assume!(which != 5 || first.master != 2 || !first.is_cam());
        let goal = refused.give(Action::Synchronize(bad));
        kept.run(1);
        prop_assert!(refused.answer(goal).is_err(), "{:?}", bad);
        for _ in 0..300 {
            prop_assert_eq!(place(&refused, X), place(&kept, X));
            for signal in ["x.command.velocity", "x.command.acceleration"] {
                prop_assert_eq!(refused.real(signal), kept.real(signal));
            }
            for signal in ["x.sync.error", "x.in_sync", "x.sync.waiting", "x.state", "x.reference"] {
                prop_assert_eq!(refused.int(signal), kept.int(signal), "{}", signal);
            }
            refused.run(1);
            kept.run(1);
        }
    }
}

/// Two axes exchange leader and follower in one cycle, in motion: the order of the axes changes, and neither loses a
/// cycle.
#[test]
fn exchange_of_leader_and_follower_in_motion_loses_nothing() {
    let mut rig = rig();
    rig.give(Action::Synchronize(couple(Y, MASTERS[0], 1, 2)));
    rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(Y), 1, 1)));
    rig.run(500);
    assert_eq!((rig.int("x.in_sync"), rig.int("y.in_sync")), (1, 1));
    // y cannot follow x while x follows y.
    let loops = rig.give(Action::Synchronize(couple(Y, Leader::AxisCommand(X), 1, 1)));
    assert_eq!(rig.answer(loops).expect_err("a loop").code, Code::LEADER_LOOP);
    // The line accelerates continuously, so an axis that is a cycle late is not at the position of its gear.
    rig.give(Action::Move(Move { acceleration: 20_000.0, ..at(LINE, 50_000.0) }));
    for turn in 0..4 {
        let (first, second) = if turn % 2 == 0 { (X, Y) } else { (Y, X) };
        rig.give_all(vec![
            Action::Synchronize(couple(first, MASTERS[0], 1, 2)),
            Action::Synchronize(couple(second, Leader::AxisCommand(first), 1, 1)),
        ]);
        let (line, leads, follows) = (place(&rig, LINE), place(&rig, first), place(&rig, second));
        for _ in 0..200 {
            rig.run(1);
            // The new follower already has the velocity: neither axis has anything to catch up.
            let half = (place(&rig, LINE) - line).raw().div_euclid(2);
            assert!(((place(&rig, first) - leads).raw() - half).abs() <= 1, "turn {turn}");
            // A remainder of half an increment of the line from the previous gear is rounded once.
            let off = (place(&rig, second) - follows - (place(&rig, first) - leads)).raw();
            assert!(off.abs() <= 1, "turn {turn}: {off} units");
            assert_eq!((rig.int("x.in_sync"), rig.int("y.in_sync")), (1, 1), "turn {turn}");
        }
    }
}

/// A move replaces a coupling from its present velocity: to rest at a position, on at a velocity, or back.
#[test]
fn a_move_takes_a_coupling_over_at_its_velocity() {
    for (what, request) in
        [("place", to(X, 60_000)), ("speed", at(X, 5_000.0)), ("back", at(X, -5_000.0)), ("rest", at(X, 0.0))]
    {
        let mut rig = rig();
        let goal = rig.give(Action::Synchronize(couple(X, MASTERS[0], 1, 2)));
        rig.run(400);
        let before = rig.real("x.command.velocity");
        assert!((before - 10_000.0).abs() < 1e-3);
        let moves = rig.give(Action::Move(Move { acceleration: 200_000.0, deceleration: 200_000.0, ..request }));
        assert_eq!((rig.answer(moves), rig.done(goal)[0].code), (Ok(()), Code::REPLACED), "{what}");
        let (mut before, mut most) = (before, 0.0_f64);
        for _ in 0..8_000 {
            rig.run(1);
            let now = rig.real("x.command.velocity");
            most = most.max((now - before).abs());
            before = now;
        }
        assert!(most <= 200.0 + 1e-6, "{what}: {most}");
        let ends = (rig.state("x"), rig.int("x.command.position") == 60_000, before);
        let expected = match what {
            "place" => ("STANDSTILL", true, 0.0),
            "speed" => ("CONTINUOUS_MOTION", false, 5_000.0),
            "back" => ("CONTINUOUS_MOTION", false, -5_000.0),
            _ => ("STANDSTILL", false, 0.0),
        };
        assert_eq!(ends, expected, "{what}");
    }
}

/// At 20 inc per cycle and 1 : 2 with a lead of 10 cycles, x is 100 inc ahead of its gear. The same goal again, another
/// ratio or another master of the same velocity leave x where its drive is: with the lead applied once, not twice.
///
/// Proves: MACS-SYNC-15
#[test]
fn velocity_lead_is_applied_once_after_a_change() {
    let mut rig = rig();
    let given = set(&mut rig, &[("syncffvel", 10_000)]);
    assert!(rig.was_accepted(given));
    rig.give(Action::Synchronize(couple(X, MASTERS[0], 1, 2)));
    rig.run(600);
    let line_at = |rig: &Rig| Position::from_raw(place(rig, LINE).raw() / 2);
    let ahead = |rig: &Rig| (place(rig, X) - line_at(rig)).raw();
    let off = ahead(&rig);
    for engage in [Engage::Immediately, Engage::Immediately, Engage::OnEvent(MARK)] {
        rig.give(Action::Synchronize(Synchronize { engage, ..couple(X, MASTERS[0], 1, 2) }));
        rig.run(5);
        if engage != Engage::Immediately {
            latch(&mut rig);
        }
        rig.run(2);
        assert_eq!(rig.int("x.in_sync"), 1, "{engage:?}");
        assert!((ahead(&rig) - off).abs() <= 4, "{engage:?}: {} units", ahead(&rig) - off);
    }
    // A cam with slope 3/4, and back: the lead changes from 100 to 150 inc, relative to the position in the table and
    // to the start position.
    let from = (place(&rig, X).to_f64() - 100.0, place(&rig, LINE).to_f64());
    rig.give(Action::Synchronize(Synchronize { cam: Some(cam(0, CamStart::Relative)), ..couple(X, MASTERS[0], 0, 0) }));
    let began = (from.0 + 10.0, from.1 + 20.0);
    rig.run(600);
    let way = place(&rig, X).to_f64() - began.0 - 0.75 * (place(&rig, LINE).to_f64() - began.1);
    assert!((way - 150.0).abs() < 1e-6, "{way}");
    // Mode VELOCITY has no position, so it has no lead.
    let velocity = rig.real("x.command.velocity");
    rig.give(Action::Synchronize(Synchronize { mode: SyncMode::Velocity, ..couple(X, MASTERS[0], 3, 4) }));
    for _ in 0..50 {
        rig.run(1);
        assert!((rig.real("x.command.velocity") - velocity).abs() < 1e-3);
    }
}

//! Cams that wait for an event: the end of the active cam, a position of the leader.

use super::rig::{LINE, Rig, X, Y, at, cam, cases, config, couple, to};
use crate::code::Code;
use crate::command::{
    Action, CamIn, Engage, MasterPosition, Move, Phase, PhaseShift, PhaseSide, SetMasterPosition, Synchronize,
};
use crate::config::{AxisConfig, TableConfig};
use crate::event::Kind;
use crate::modulo::Modulo;
use crate::object::{AxisSet, Leader, Object};
use crate::position::{Length, Position};
use crate::request::Amount;
use crate::sync::CamStart;
use crate::sync::gear::Ratio;
use crate::table::{CamSetting, Form, Table};
use proptest::prelude::*;
use std::sync::Arc;

const TO_LINE: Leader = Leader::AxisCommand(LINE);

/// Indices of the tables.
const KNIFE: u16 = 0;
const FEED: u16 = 1;
const ONCE: u16 = 2;
const AWAY: u16 = 3;

/// Points of the tables; slopes and values need no rounding to 2^-32.
fn points(table: u16) -> &'static [(i64, i64)] {
    match table {
        // Ends at its start value.
        KNIFE => &[(0, 0), (1024, 512), (3072, 512), (4096, 0)],
        // 768 further in each period.
        FEED => &[(0, 0), (2048, 512), (3072, 768)],
        ONCE => &[(0, 100), (2048, 1124)],
        _ => &[(0, 5000), (2048, 5512), (4096, 5000)],
    }
}

fn rig() -> Rig {
    rig_of(|_| {})
}

fn rig_of(with: fn(&mut AxisConfig)) -> Rig {
    let names = ["knife", "feed", "once", "away"];
    let mut config = config(0);
    config.tables = (0..4)
        .zip(names)
        .map(|(table, name)| {
            let (x, y): (Vec<_>, Vec<_>) = points(table).iter().copied().unzip();
            let setting = CamSetting { is_cyclic: table != ONCE, ..CamSetting::default() };
            let table = Table::new(Form::Xy, &x, &y).expect("points").with_cam(setting);
            TableConfig { name: name.into(), table: Arc::new(table) }
        })
        .collect();
    for axis in &mut config.axes {
        axis.parameters.sync_accuracy = 10;
        with(axis);
    }
    let mut rig = Rig::of(config);
    rig.enable();
    rig
}

fn on(table: u16, start: CamStart, engage: Engage) -> Synchronize {
    let cam = cam(table, start);
    Synchronize { cam: Some(cam), engage, ..couple(X, TO_LINE, 0, 0) }
}

fn at_position(position: i64) -> Engage {
    Engage::AtPosition { position, turn: None }
}

fn place(rig: &Rig, axis: u16) -> Position {
    rig.machine.state.leads.get(Leader::AxisCommand(axis)).position
}

/// Returns the travel in the table from its start, over any number of periods, in units of 2^-32 inc.
fn way(table: u16, x: i128) -> i128 {
    let points = points(table);
    let ((first_x, first), (length, last)) = (points[0], points[points.len() - 1]);
    assert_eq!(first_x, 0);
    let one = |whole: i64| i128::from(whole) << 32;
    let (periods, x) = match table {
        ONCE => (0, x.clamp(0, one(length))),
        _ => (x.div_euclid(one(length)), x.rem_euclid(one(length))),
    };
    let i = points.iter().rposition(|(at, _)| one(*at) <= x).expect("from 0 on").min(points.len() - 2);
    let ((x0, y0), (x1, y1)) = (points[i], points[i + 1]);
    let rise = ((x - one(x0)) * i128::from(y1 - y0)).div_euclid(i128::from(x1 - x0));
    periods * one(last - first) + one(y0 - first) + rise
}

/// Moves the line at 0.7 inc per cycle, so that no point of the tables coincides with a cycle.
fn run_line(rig: &mut Rig, to_place: i64) {
    rig.give(Action::Move(Move { velocity: 700.0, acceleration: 1e4, deceleration: 1e4, ..to(LINE, to_place) }));
}

/// A slave with a lead of 10 cycles, first by a gear and then by a table, is at the position of the table once its
/// leader is at rest.
///
/// Proves: MACS-SYNC-15
#[test]
fn a_table_that_is_absolute_is_one_of_places_without_the_lead() {
    let mut rig = rig_of(|axis| axis.parameters.sync.feed_forward = 10_000);
    rig.give(Action::Synchronize(couple(X, TO_LINE, 1, 4)));
    run_line(&mut rig, 2_000);
    rig.run(1_000);
    // A quarter of 0.7 inc in each of 10 cycles.
    let lead = place(&rig, X).to_f64() - place(&rig, LINE).to_f64() / 4.0;
    assert!((lead - 1.75).abs() < 1e-6, "{lead}");
    rig.give(Action::Synchronize(on(FEED, CamStart::Absolute, at_position(1_000))));
    rig.run(3_000);
    assert_eq!((rig.int("x.sync.waiting"), rig.int("x.in_sync"), rig.int("line.command.position")), (0, 1, 2_000));
    assert_eq!(place(&rig, X).raw(), way(FEED, 2_000 << 32));
}

#[test]
fn at_the_end_the_next_table_begins_between_two_cycles() {
    let mut rig = rig();
    let first = rig.give(Action::Synchronize(on(KNIFE, CamStart::Relative, Engage::Immediately)));
    run_line(&mut rig, 9_000);
    rig.run(1_000);
    let next = rig.give(Action::Synchronize(on(FEED, CamStart::Relative, Engage::AtEnd)));
    assert!(rig.was_accepted(next));
    rig.run(1);
    assert_eq!((rig.int("x.sync.waiting"), rig.int("x.reference")), (next as i64, 3));
    let end = 4096_i128 << 32;
    while place(&rig, LINE).raw() < end {
        assert!(rig.done(first).is_empty() && rig.int("x.sync.waiting") == next as i64);
        assert_eq!(place(&rig, X).raw(), way(KNIFE, place(&rig, LINE).raw()));
        rig.run(1);
    }
    // The goal ends in the cycle in which the end is passed, and the next cycle belongs entirely to the next table.
    let done = rig.done(first)[0];
    assert_eq!((done.code, done.cycle, rig.int("x.sync.waiting")), (Code::NONE, rig.machine.next_cycle() - 1, 0));
    assert!(place(&rig, LINE).fraction() != 0.0);
    for _ in 0..7_200 {
        rig.run(1);
        assert_eq!(place(&rig, X).raw(), way(FEED, place(&rig, LINE).raw() - end));
    }
    // 9000 - 4096 = 4904: a period of 3072, and 1832 of its first 2048.
    assert_eq!((rig.int("line.command.position"), rig.int("x.command.position")), (9_000, 768 + 458));
    assert_eq!((rig.done(next).len(), rig.state("x")), (0, "SYNCHRONIZED_MOTION"));
    assert!(!rig.events.iter().any(|event| event.kind == Kind::Warning));
}

#[test]
fn backwards_the_next_table_begins_at_its_end() {
    let mut rig = rig();
    rig.give(Action::Synchronize(on(KNIFE, CamStart::Relative, Engage::Immediately)));
    run_line(&mut rig, 300);
    rig.run(1_500);
    rig.give(Action::Synchronize(on(FEED, CamStart::Relative, Engage::AtEnd)));
    run_line(&mut rig, -4_000);
    rig.run(8_000);
    // From 0 on the feed runs back: a period of 768, and 928 of the last 1024 increments with slope 1/4.
    assert_eq!((rig.int("line.command.position"), rig.int("x.command.position")), (-4_000, -768 - 232));
    assert_eq!(place(&rig, X).raw(), way(FEED, place(&rig, LINE).raw()));
}

#[test]
fn at_a_place_the_next_table_begins_there_from_either_side() {
    for (from, to_place, engage) in [(0, 3_000, 1_234), (3_000, 0, 1_234)] {
        let mut rig = rig();
        rig.give(Action::Move(to(LINE, from)));
        rig.run(1_000);
        let first = rig.give(Action::Synchronize(on(KNIFE, CamStart::Relative, Engage::Immediately)));
        let next = rig.give(Action::Synchronize(on(FEED, CamStart::Relative, at_position(engage))));
        run_line(&mut rig, to_place);
        rig.run(5_500);
        assert_eq!((rig.done(first)[0].code, rig.done(next).len()), (Code::REPLACED, 0));
        let exact = way(KNIFE, i128::from(engage - from) << 32) + way(FEED, i128::from(to_place - engage) << 32);
        assert_eq!(place(&rig, X).raw(), exact, "from {from}");
    }
}

/// An axis at rest starts when the leader passes the position, and catches up the distance that it loses during
/// acceleration.
#[test]
fn an_axis_at_rest_waits_for_its_leader() {
    let mut rig = rig();
    let next = rig.give(Action::Synchronize(on(FEED, CamStart::Relative, at_position(500))));
    rig.run(10);
    assert_eq!((rig.state("x"), rig.int("x.sync.waiting")), ("STANDSTILL", next as i64));
    // 7 inc per cycle.
    rig.give(Action::Move(Move { velocity: 7_000.0, acceleration: 1e6, deceleration: 1e6, ..to(LINE, 2_000) }));
    while rig.int("line.command.position") < 500 {
        assert_eq!((rig.int("x.command.position"), rig.state("x")), (0, "STANDSTILL"));
        rig.run(1);
    }
    assert_eq!((rig.state("x"), rig.int("x.sync.waiting")), ("SYNCHRONIZED_MOTION", 0));
    rig.run(400);
    assert_eq!((rig.int("x.command.position"), rig.int("x.sync.error")), (1_500 / 4, 0));
    assert_eq!(place(&rig, X).raw(), way(FEED, 1_500 << 32));
}

/// If the leader is already at the position, the cam starts at once; a table with an offset starts at the offset.
#[test]
fn leader_already_at_position_engages_at_once() {
    let mut rig = rig();
    let cam = CamIn {
        master_offset: Length::whole(2_048),
        ..on(FEED, CamStart::Relative, at_position(0)).cam.expect("a cam")
    };
    rig.give(Action::Synchronize(Synchronize { cam: Some(cam), ..on(FEED, CamStart::Relative, at_position(0)) }));
    assert_eq!(rig.state("x"), "SYNCHRONIZED_MOTION");
    run_line(&mut rig, 1_024);
    rig.run(3_000);
    assert_eq!(rig.int("x.command.position"), 256);
}

/// 2048.5 inc per revolution; position 100 is passed at 100 and, one revolution later, at 2148.5.
#[test]
fn a_place_in_the_turn_of_the_leader_is_its_next_pass() {
    let turn = Modulo::new(4_097, 2);
    let mut rig = rig();
    rig.give(Action::Move(to(LINE, 1_000)));
    rig.run(1_000);
    let engage = Engage::AtPosition { position: 100, turn };
    rig.give(Action::Synchronize(on(FEED, CamStart::Relative, engage)));
    run_line(&mut rig, 2_548);
    rig.run(4_000);
    // 2548 - 2148.5 = 399.5, and a quarter of it.
    assert_eq!(place(&rig, X), Position::from_f64(399.5 / 4.0));
    let turn = turn.expect("a turn");
    let at = Position::whole;
    let half = Position::from_f64(-1_948.5);
    for (now, change, expected) in [
        (3_000, 1, Position::from_f64(2_148.5)),
        (3_000, -1, Position::from_f64(4_197.0)),
        (0, 1, half),
        (100, 0, at(100)),
    ] {
        assert_eq!(turn.last_reached(at(100), at(now), at(change)), expected, "{now} {change}");
    }
}

/// A latch 0.25 ms before its cycle, at 0.7 inc per cycle: from a cam of the line to the next one, and for an axis at
/// rest. An absolute start is compared at the end of that cycle, as at a position.
#[test]
fn at_a_latch_the_next_table_begins_there() {
    use crate::drive::{Edge, Latch};
    for is_coupled in [true, false] {
        let mut rig = rig();
        if is_coupled {
            rig.give(Action::Synchronize(on(KNIFE, CamStart::Relative, Engage::Immediately)));
        }
        let next = rig.give(Action::Synchronize(on(FEED, CamStart::Relative, Engage::OnEvent(Object::Encoder(0)))));
        run_line(&mut rig, 3_000);
        rig.run(900);
        assert_eq!(rig.int("x.sync.waiting"), next as i64);
        let was = place(&rig, LINE).raw();
        let latch = Latch { object: Object::Encoder(0), edge: Edge::Rising, age_ns: Some(250_000), position: None };
        assert!(rig.plant.add_latch(latch));
        rig.run(1);
        let change = place(&rig, LINE).raw() - was;
        let moment = was + change - (change * 250_000).div_euclid(1_000_000);
        let from = if is_coupled { way(KNIFE, moment) } else { place(&rig, X).raw() };
        for cycle in 0..1_000 {
            rig.run(1);
            if is_coupled || cycle > 10 {
                assert_eq!(place(&rig, X).raw(), from + way(FEED, place(&rig, LINE).raw() - moment));
            }
        }
        let away = rig.give(Action::Synchronize(on(AWAY, CamStart::Absolute, Engage::OnEvent(Object::Encoder(0)))));
        rig.run(3);
        assert!(rig.plant.add_latch(latch));
        rig.run(1);
        assert_eq!((rig.done(away)[0].code, rig.done(next).len()), (Code::CAM_AWAY, 0));
    }
}

/// The command comes in the cycle in which the leader is exactly at 498: this position has been passed, so the goal
/// waits for the next revolution.
#[test]
fn a_place_that_was_just_passed_is_not_passed_again() {
    let mut rig = rig();
    let engage = Engage::AtPosition { position: 498, turn: Modulo::new(4_000, 1) };
    rig.give(Action::Synchronize(on(KNIFE, CamStart::Relative, Engage::Immediately)));
    rig.give(Action::Move(Move { acceleration: 1e6, ..at(LINE, 2_000.0) }));
    while rig.int("line.command.position") < 498 {
        rig.run(1);
    }
    assert_eq!(place(&rig, LINE), Position::whole(498));
    let next = rig.give(Action::Synchronize(on(FEED, CamStart::Relative, engage)));
    rig.run(100);
    assert_eq!(rig.int("x.sync.waiting"), next as i64);
    rig.run(2_000);
    assert_eq!((rig.int("x.sync.waiting"), rig.state("x")), (0, "SYNCHRONIZED_MOTION"));
}

/// Out of the previous table backwards, by a negative scale, and into the new one forwards, which has an end: from its
/// start.
#[test]
fn the_new_cam_begins_where_it_runs_from() {
    let mut rig = rig();
    let turned = |of: Synchronize| {
        let cam = of.cam.map(|cam| CamIn { master_scale: Ratio::new(-1, 1).expect("a ratio"), ..cam });
        Synchronize { cam, ..of }
    };
    rig.give(Action::Synchronize(turned(on(KNIFE, CamStart::Relative, Engage::Immediately))));
    let next = rig.give(Action::Synchronize(on(ONCE, CamStart::Relative, Engage::AtEnd)));
    run_line(&mut rig, 1_000);
    rig.run(1_000);
    assert_eq!((rig.done(next).len(), rig.int("x.sync.waiting")), (0, 0));
    rig.run(1_000);
    // Half of the travel from 0 on, in the direction of the line.
    assert_eq!(rig.int("x.command.position"), 500);
    // An offset does not start the cam after its end.
    let back = Synchronize {
        cam: on(ONCE, CamStart::Relative, Engage::AtEnd)
            .cam
            .map(|cam| CamIn { master_offset: Length::whole(500), ..cam }),
        ..on(ONCE, CamStart::Relative, Engage::AtEnd)
    };
    rig.give(Action::Synchronize(on(KNIFE, CamStart::Relative, Engage::Immediately)));
    let goal = rig.give(Action::Synchronize(back));
    run_line(&mut rig, -1_000);
    rig.run(4_000);
    assert_eq!((rig.done(goal).len(), rig.int("x.command.position")), (0, 500 - 1_000));
}

/// The end is met exactly, and the new cam, which has an end, runs back from its end.
#[test]
fn end_met_exactly_counts() {
    let mut rig = rig();
    rig.give(Action::Synchronize(on(KNIFE, CamStart::Relative, Engage::Immediately)));
    let turned = on(ONCE, CamStart::Relative, Engage::AtEnd);
    let cam = turned.cam.map(|cam| CamIn { master_scale: Ratio::new(-1, 1).expect("a ratio"), ..cam });
    let next = rig.give(Action::Synchronize(Synchronize { cam, ..turned }));
    // 2 inc per cycle, starting from 2: 4096 is one of these positions.
    rig.give(Action::Move(Move { acceleration: 1e6, ..at(LINE, 2_000.0) }));
    rig.run_until("x.sync.waiting", 0);
    assert_eq!(place(&rig, LINE), Position::whole(4_096));
    rig.run(512);
    assert_eq!((rig.int("x.command.position"), rig.done(next).len()), (-512, 0));
}

/// The leading encoder is set to the position in motion, after the axes: the previous cycle ended elsewhere.
#[test]
fn a_place_that_the_leader_is_set_to_counts() {
    let mut rig = rig_of(|axis| axis.parameters.encoder.mencodertype = 10);
    let waiting = Synchronize { leader: Some(Leader::Encoder(0)), ..on(FEED, CamStart::Relative, at_position(0)) };
    rig.plant.jump_encoder(0, 200);
    rig.run(2);
    rig.give(Action::Synchronize(waiting));
    for _ in 0..10 {
        rig.plant.jump_encoder(0, 2);
        rig.run(1);
    }
    assert!(rig.int("x.sync.waiting") != 0);
    rig.plant.jump_encoder(0, 2);
    let position = MasterPosition::Increments(Length::whole(0));
    let set = rig.give(Action::SetMasterPosition(SetMasterPosition { axis: X, position }));
    assert!(rig.was_accepted(set));
    for _ in 0..5 {
        rig.plant.jump_encoder(0, 2);
        rig.run(1);
    }
    assert_eq!((rig.int("x.sync.waiting"), rig.state("x")), (0, "SYNCHRONIZED_MOTION"));
}

/// With revers 1 the correction at a transition into a dwell is no reversal of the leader: the slave stands still, and
/// does not move back.
#[test]
fn a_correction_is_no_reverse_of_the_leader() {
    let mut rig = rig_of(|axis| (axis.parameters.macs.revers, axis.parameters.max_acceleration) = (1, 1e9));
    rig.give(Action::Synchronize(on(FEED, CamStart::Relative, Engage::Immediately)));
    rig.give(Action::Move(Move { acceleration: 1e6, ..at(LINE, 29_000.0) }));
    rig.run(60);
    let dwell = on(KNIFE, CamStart::Relative, Engage::AtEnd);
    let cam = dwell.cam.map(|cam| CamIn { master_offset: Length::whole(1_024), ..cam });
    rig.give(Action::Synchronize(Synchronize { cam, ..dwell }));
    let mut last = place(&rig, X);
    while rig.int("x.sync.waiting") != 0 {
        rig.run(1);
        last = place(&rig, X);
    }
    for _ in 0..40 {
        rig.run(1);
        assert!(place(&rig, X) >= last, "{last:?}");
        last = place(&rig, X);
    }
}

/// The table after the end is three times as steep: in the next cycle the slave follows it, within the limits of its
/// axis.
#[test]
fn a_change_of_slope_is_made_at_once_within_the_limits() {
    let mut rig = rig();
    let steep = |of: Synchronize| {
        let cam = of.cam.map(|cam| CamIn { slave_scale: Ratio::new(3, 1).expect("a ratio"), ..cam });
        Synchronize { cam, acceleration: 100.0, ..of }
    };
    rig.give(Action::Synchronize(on(FEED, CamStart::Relative, Engage::Immediately)));
    run_line(&mut rig, 5_000);
    rig.run(500);
    rig.give(Action::Synchronize(steep(on(FEED, CamStart::Relative, Engage::AtEnd))));
    rig.run_until("x.sync.waiting", 0);
    assert_eq!(rig.int("x.in_sync"), 1);
    rig.run(1);
    // 0.35 inc per cycle more, where 1 is possible and 0.0001 was commanded for catching up.
    let exact = way(FEED, 3_072 << 32) + 3 * way(FEED, place(&rig, LINE).raw() - (3_072 << 32));
    assert_eq!((place(&rig, X).raw(), rig.int("x.in_sync")), (exact, 1));
    assert!(!rig.events.iter().any(|event| event.kind == Kind::Warning));
}

/// A shift continues from cam to cam of one leader, and ends once.
#[test]
fn shifts_go_on_from_cam_to_cam() {
    let mut rig = rig();
    rig.give(Action::Synchronize(on(FEED, CamStart::Relative, Engage::Immediately)));
    run_line(&mut rig, 6_144);
    rig.run(4_000);
    rig.give(Action::Synchronize(on(KNIFE, CamStart::Relative, Engage::AtEnd)));
    let shift = PhaseShift { shift: Length::whole(300), velocity: 300.0, acceleration: 3_000.0 };
    let slave = rig.give(Action::Phase(Phase { axis: X, side: PhaseSide::Slave(shift) }));
    let by_scale = [(super::rig::scale(), shift)].into();
    let side = PhaseSide::Master { given: [Amount::default(); 3], by_scale };
    let master = rig.give(Action::Phase(Phase { axis: X, side }));
    rig.run_until("x.sync.waiting", 0);
    assert!(rig.real("x.phase.slave") > 0.1 && rig.real("x.phase.master") > 0.1 && rig.done(slave).is_empty());
    rig.run(6_000);
    assert_eq!((rig.done(slave)[0].code, rig.done(master)[0].code), (Code::NONE, Code::NONE));
    // 6144 - 3072 = 3072 of the knife, 300 by the shift, and 300 of the slave itself.
    let exact = way(FEED, 3_072 << 32) + way(KNIFE, 3_372 << 32) + (300 << 32);
    assert_eq!((place(&rig, X).raw(), rig.int("x.sync.error")), (exact, 0));
}

/// Streamed setpoints control the axis: a waiting goal does not replace them.
#[test]
fn a_stream_ends_the_wait() {
    let mut rig = rig();
    let goal = rig.give(Action::Synchronize(on(FEED, CamStart::Relative, at_position(500))));
    rig.stream(X, 1_000.0);
    rig.run(5);
    assert_eq!((rig.done(goal)[0].code, rig.int("x.sync.waiting"), rig.int("x.reference")), (Code::REPLACED, 0, 9));
}

/// An invalid state is not restored.
#[test]
fn invalid_waiting_state_is_refused() {
    let sound = Modulo::new(10, 1).expect("a turn");
    let mut bytes = postcard::to_allocvec(&sound).expect("bytes");
    bytes[0] = 0;
    let none: Modulo = postcard::from_bytes(&bytes).expect("numbers");
    assert_eq!((sound.is_sound(), none.is_sound()), (true, false));
    let mut bytes = postcard::to_allocvec(&Ratio::ONE).expect("bytes");
    *bytes.last_mut().expect("bytes") = 0;
    let none: Ratio = postcard::from_bytes(&bytes).expect("numbers");
    let cam = CamIn { slave_scale: none, ..on(FEED, CamStart::Relative, Engage::AtEnd).cam.expect("a cam") };
    assert_eq!((Ratio::ONE.is_sound(), cam.is_sound()), (true, false));
}

/// The slave does not decelerate for an end if a waiting goal continues the motion; without the waiting goal it
/// decelerates.
#[test]
fn a_cam_with_an_end_passes_into_the_next_one() {
    for waits in [true, false] {
        let mut rig = rig();
        let first = rig.give(Action::Synchronize(on(ONCE, CamStart::Relative, Engage::Immediately)));
        let next = rig.give(Action::Synchronize(on(FEED, CamStart::Relative, Engage::AtEnd)));
        if !waits {
            rig.give(Action::Cancel { goal: next });
            assert_eq!(rig.done(next)[0].code, Code::CANCELLED);
        }
        rig.give(Action::Move(Move { velocity: 20_000.0, acceleration: 1e5, deceleration: 1e5, ..to(LINE, 4_096) }));
        rig.run(1_000);
        assert_eq!(rig.done(first)[0].code, Code::NONE);
        // 1024 of the first cam, and 2048 inc at slope 1/4.
        let expected = if waits { (1_024 + 512, "SYNCHRONIZED_MOTION") } else { (1_024, "STANDSTILL") };
        assert_eq!((rig.int("x.command.position"), rig.state("x")), expected);
    }
}

#[test]
fn absolute_at_its_moment_is_refused_where_the_slave_is_elsewhere_and_the_cam_goes_on() {
    let mut rig = rig();
    let first = rig.give(Action::Synchronize(on(KNIFE, CamStart::Absolute, Engage::Immediately)));
    let next = rig.give(Action::Synchronize(on(AWAY, CamStart::Absolute, Engage::AtEnd)));
    assert!(rig.was_accepted(next));
    run_line(&mut rig, 5_120);
    rig.run(9_000);
    let done = rig.done(next)[0];
    assert_eq!((done.code, rig.done(first).len()), (Code::CAM_AWAY, 0));
    let sentence = crate::text::message(&done, rig.machine.config());
    assert!(sentence.contains("the cam asks for a place that is 5 mm away"), "{sentence}");
    // The knife is 1024 inc after its end.
    assert_eq!((rig.int("x.command.position"), rig.state("x")), (512, "SYNCHRONIZED_MOTION"));
    let led = rig.give(Action::Synchronize(on(AWAY, CamStart::RampIn, Engage::AtEnd)));
    run_line(&mut rig, 9_216);
    rig.run(9_000);
    assert_eq!((rig.done(first)[0].code, rig.done(led).len()), (Code::NONE, 0));
    assert_eq!((rig.int("x.command.position"), rig.int("x.sync.error")), (5_256, 0));
    // If both are at the same position, only the master moves.
    let same = rig.give(Action::Synchronize(on(AWAY, CamStart::Absolute, at_position(9_728))));
    run_line(&mut rig, 10_240);
    rig.run(3_000);
    assert_eq!(
        (rig.done(led)[0].code, rig.done(same).len(), rig.int("x.command.position")),
        (Code::REPLACED, 0, 5_512)
    );
    assert_eq!(place(&rig, X).raw(), (5_000_i128 << 32) + way(AWAY, place(&rig, LINE).raw()));
}

/// Every stop and every takeover of the axis ends the wait, once.
#[test]
fn every_stop_ends_the_wait() {
    let waiting = on(FEED, CamStart::Relative, at_position(1_000_000));
    for (action, code) in [
        (Action::Halt(AxisSet::one(X)), Code::HALTED),
        (Action::QuickStop(AxisSet::one(X)), Code::QUICK_STOP),
        (Action::Disable(AxisSet::one(X)), Code::DISABLED),
        (Action::Abort, Code::ABORTED),
        (Action::Deactivate, Code::DISABLED),
        (Action::Move(to(X, 100)), Code::REPLACED),
        (Action::Synchronize(couple(X, TO_LINE, 1, 1)), Code::REPLACED),
        (Action::Synchronize(waiting), Code::REPLACED),
        (Action::Cancel { goal: 2 }, Code::CANCELLED),
    ] {
        for is_coupled in [false, true] {
            let mut rig = rig();
            let goal = rig.give(Action::Synchronize(waiting));
            if is_coupled {
                // A previous coupling, which is not ended by it.
                rig.give(Action::Cancel { goal });
                rig.give(Action::Synchronize(on(KNIFE, CamStart::Relative, Engage::Immediately)));
                if matches!(action, Action::Cancel { .. }) {
                    continue;
                }
            }
            let goal = if is_coupled { rig.give(Action::Synchronize(waiting)) } else { goal };
            rig.run(5);
            rig.give(action.clone());
            rig.run(300);
            let codes: Vec<_> = rig.done(goal).iter().map(|done| done.code).collect();
            assert_eq!(codes, [code], "{action:?} {is_coupled}");
            assert!(rig.int("x.sync.waiting") == 0 || matches!(action, Action::Synchronize(_)));
        }
    }
}

/// Cancelling the active cam also ends the waiting goal; cancelling the waiting goal does not end the cam.
#[test]
fn cancel_ends_one_of_both() {
    let mut rig = rig();
    let first = rig.give(Action::Synchronize(on(KNIFE, CamStart::Relative, Engage::Immediately)));
    let next = rig.give(Action::Synchronize(on(FEED, CamStart::Relative, Engage::AtEnd)));
    rig.give(Action::Cancel { goal: next });
    rig.run(5);
    assert_eq!((rig.done(next)[0].code, rig.done(first).len()), (Code::CANCELLED, 0));
    let next = rig.give(Action::Synchronize(on(FEED, CamStart::Relative, Engage::AtEnd)));
    rig.give(Action::Cancel { goal: first });
    rig.run(5);
    assert_eq!((rig.done(next)[0].code, rig.done(first)[0].code), (Code::NOT_REACHED, Code::CANCELLED));
}

#[test]
fn an_end_that_is_not_there_is_refused_and_loops_are() {
    let mut rig = rig();
    let no_cam = "x: the axis is on no cam of that leader whose end could be waited for";
    let at_end = on(FEED, CamStart::Relative, Engage::AtEnd);
    let alone = rig.give(Action::Synchronize(at_end));
    assert_eq!(rig.refusal(alone), no_cam);
    rig.give(Action::Synchronize(couple(X, TO_LINE, 1, 1)));
    let geared = rig.give(Action::Synchronize(at_end));
    assert_eq!(rig.refusal(geared), no_cam);
    rig.give(Action::Synchronize(on(KNIFE, CamStart::Relative, Engage::Immediately)));
    let other = rig.give(Action::Synchronize(Synchronize { leader: Some(Leader::Encoder(0)), ..at_end }));
    assert_eq!(rig.refusal(other), no_cam);
    let fast = rig.give(Action::Synchronize(Synchronize { velocity: 1e9, ..at_end }));
    assert!(rig.refusal(fast).contains("max_velocity"));
    // A waiting goal counts as if it followed already.
    let waits = rig.give(Action::Synchronize(Synchronize {
        leader: Some(Leader::AxisCommand(Y)),
        ..on(FEED, CamStart::Relative, at_position(9))
    }));
    assert!(rig.was_accepted(waits));
    let loops = rig.give(Action::Synchronize(couple(Y, Leader::AxisCommand(X), 1, 1)));
    assert_eq!(rig.answer(loops).expect_err("refused").code, Code::LEADER_LOOP);
}

/// An axis whose leader is lost while it waits stays in place.
#[test]
fn a_leader_that_is_lost_ends_the_wait() {
    let mut rig = rig();
    let waiting = Synchronize { leader: Some(Leader::AxisActual(Y)), ..on(FEED, CamStart::Relative, at_position(100)) };
    let goal = rig.give(Action::Synchronize(waiting));
    rig.modify_inputs = |inputs| inputs.drive[1].online = false;
    rig.run(100);
    assert_eq!((rig.done(goal)[0].code, rig.state("x")), (Code::LEADER_LOST, "STANDSTILL"));
}

proptest! {
    #![proptest_config(cases(24))]

    /// Tables are changed at ends and at positions while the leader moves randomly. After each change the slave is at
    /// the final position of the previous table plus the travel in the new one, to the last bit of the grid, except for
    /// the scale of the slave.
    #[test]
    fn cam_changes_lose_no_distance(
        changes in prop::collection::vec((0_u16..2, any::<bool>(), -3_000_i64..3_000, -6_000_i64..6_000), 1..6),
        scale in prop::sample::select(vec![(1, 1), (3, 4), (-1, 2)]),
    ) {
        let mut rig = rig();
        let with_scale = |table, engage| {
            let of = on(table, CamStart::Relative, engage);
            let slave_scale = Ratio::new(scale.0, scale.1).expect("not 0");
            Synchronize { cam: of.cam.map(|cam| CamIn { slave_scale, ..cam }), ..of }
        };
        rig.give(Action::Synchronize(with_scale(KNIFE, Engage::Immediately)));
        let exact = |raw: i128| (raw * i128::from(scale.0)).div_euclid(i128::from(scale.1));
        // The table, the line position of its start, and the previous travel.
        let (mut table, mut origin, mut before) = (KNIFE, 0_i128, 0_i128);
        for (next, at_end, distance, target) in changes {
            let now = place(&rig, LINE).raw();
            let position = rig.int("line.command.position") + distance;
            let engage = if at_end { Engage::AtEnd } else { at_position(position) };
            let goal = rig.give(Action::Synchronize(with_scale(next, engage)));
            prop_assert_eq!(rig.answer(goal), Ok(()));
            run_line(&mut rig, target);
            let period = i128::from(points(table)[points(table).len() - 1].0) << 32;
            // Expected start: the next end ahead, or the position.
            let into = (now - origin).rem_euclid(period);
            for _ in 0..30_000 {
                if rig.int("x.sync.waiting") == 0 || rig.state("line") == "STANDSTILL" { break }
                rig.run(1);
            }
            rig.run(10);
            let line = place(&rig, LINE).raw();
            if rig.int("x.sync.waiting") == 0 {
                let moment = if !at_end {
                    i128::from(position) << 32
                } else if line >= now {
                    now - into + period
                } else {
                    now - into
                };
                before += way(table, moment - origin);
                (table, origin) = (next, moment);
            } else {
                rig.give(Action::Cancel { goal });
            }
            let line = place(&rig, LINE).raw();
            prop_assert_eq!(place(&rig, X).raw(), exact(before + way(table, line - origin)), "{} {}", table, at_end);
        }
    }
}

#[test]
fn a_move_under_way_is_taken_over_at_the_place() {
    let mut rig = rig();
    let moving = rig.give(Action::Move(at(X, 100.0)));
    let next = rig.give(Action::Synchronize(on(FEED, CamStart::Relative, at_position(200))));
    run_line(&mut rig, 1_224);
    rig.run(3_000);
    assert_eq!((rig.done(moving)[0].code, rig.done(next).len()), (Code::REPLACED, 0));
    assert_eq!(
        (rig.state("x"), rig.int("x.sync.error"), rig.real("x.command.velocity")),
        ("SYNCHRONIZED_MOTION", 0, 0.0)
    );
}

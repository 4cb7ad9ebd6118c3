//! Cams with marks: a cam follows products on a belt, or feeds labels on a roll.
//!
//! The cam feeds 2000 inc in 1000 inc of the belt: 900 in the first half, 1100 in the second one.

use super::direction::set;
use super::marks::BeltAndRoll;
use super::rig::{X, cam, couple};
use crate::code::Code;
use crate::command::{Action, CamIn, Synchronize};
use crate::config::TableConfig;
use crate::event::{Event, Kind, Number};
use crate::object::Leader;
use crate::sync::gear::Ratio;
use crate::sync::{CamStart, Disengage, SyncMode};
use crate::table::{CamSetting, Form, Table};
use proptest::prelude::*;
use std::sync::Arc;

const TO_BELT: Leader = Leader::Encoder(0);
const SPEED: i64 = 2;
const FEED: u16 = 0;
const BACK: u16 = 1;
const ONCE: u16 = 2;

fn tables() -> Vec<TableConfig> {
    let once = CamSetting { is_cyclic: false, ..CamSetting::default() };
    let xy = |y: [i64; 3]| Table::new(Form::Xy, &[0, 500, 1_000], &y).expect("points");
    let tables =
        [("feed", xy([0, 900, 2_000])), ("back", xy([0, 50, 0])), ("once", xy([0, 900, 2_000]).with_cam(once))];
    tables.map(|(name, table)| TableConfig { name: name.into(), table: Arc::new(table) }).into()
}

/// Products every 1000 inc from 500 on.
fn world(changes: &[(&str, i64)]) -> BeltAndRoll {
    BeltAndRoll::with_tables(tables(), 500.0, changes)
}

fn request(mode: SyncMode, cam: CamIn) -> Synchronize {
    Synchronize { mode, cam: Some(cam), ..couple(X, TO_BELT, 0, 0) }
}

fn start(world: &mut BeltAndRoll, mode: SyncMode) -> u64 {
    let goal = world.rig.give(Action::Synchronize(request(mode, cam(FEED, CamStart::Relative))));
    assert!(world.rig.was_accepted(goal), "{}", world.rig.refusal(goal));
    world.record_position();
    goal
}

/// Returns the slave position of the cam at a master position, over all periods.
fn fed(place: f64) -> f64 {
    let (periods, x) = (place.div_euclid(1_000.0), place.rem_euclid(1_000.0));
    2_000.0 * periods + if x < 500.0 { 1.8 * x } else { 900.0 + 2.2 * (x - 500.0) }
}

/// Returns the distance of the command from the slave position of a cam whose master is shifted by `shift` (inc).
fn off(world: &BeltAndRoll, shift: f64) -> f64 {
    world.rig.int("x.command.position") as f64 - fed(world.belt as f64 + shift)
}

/// The sensor detects a product 300 inc before its working position, where the cam must have 300 inc left to its start.
/// The cam has 500 inc left, so it is shifted 200 inc ahead. With any kind of correction, each product finally meets
/// the start, and the slave is exactly at the position of the table.
/// Proves: MACS-CMD-14, MACS-SYNC-01, MACS-MARK-03
#[test]
fn products_meet_the_start_of_the_cam() {
    let ways: [&[(&str, i64)]; 4] =
        [&[], &[("syncofftime", 400)], &[("syncmftime", 1_000)], &[("syncmftime", 1_000), ("syncofftime", 800)]];
    for changes in ways {
        let mut world = world(&[&[("syncmpulsm", 300)], changes].concat());
        start(&mut world, SyncMode::MasterMarker);
        world.run(200, SPEED);
        assert_eq!((world.rig.int("x.in_sync"), off(&world, 0.0).abs() <= 1.0), (0, true), "no mark yet");
        world.run(12_000, SPEED);
        assert!(off(&world, 200.0).abs() <= 1.0, "{changes:?}: {}", off(&world, 200.0));
        assert_eq!(world.rig.int("x.in_sync"), 1);
        assert!(world.rig.real("x.marker.error").abs() < 0.1);
        let way = world.rig.int("x.marker.master");
        assert_eq!((way - 500).rem_euclid(1_000), 0, "MIPOS");
    }
}

/// Returns the master position of the cam for a slave position.
fn place_of(slave: f64) -> f64 {
    let (periods, y) = (slave.div_euclid(2_000.0), slave.rem_euclid(2_000.0));
    1_000.0 * periods + if y < 900.0 { y / 1.8 } else { 500.0 + (y - 900.0) / 2.2 }
}

/// During a correction the next pair of marks reports the remaining distance: the correction between the mark of the
/// cam and that of the belt counts.
/// Proves: MACS-MARK-13
#[test]
fn pair_during_correction_reports_remaining_error() {
    // At a product, the cam has 300 inc left once it is 200 inc ahead, or 700 inc once it is 200 inc behind: in the
    // latter case its own mark precedes that of the belt.
    for (distance, shift) in [(300, 200.0), (700, -200.0)] {
        let mut world = world(&[("syncmpulsm", distance), ("syncofftime", 4_000)]);
        start(&mut world, SyncMode::MasterMarker);
        while world.rig.events.iter().filter(|event| event.kind == Kind::Mark).count() < 2 {
            world.cycle(SPEED);
        }
        let left = shift - (place_of(world.rig.int("x.command.position") as f64) - world.belt as f64);
        let pair = world.rig.events.iter().filter(|event| event.kind == Kind::Mark).nth(1).expect("a pair");
        let Number::Real(error) = pair.asked else { panic!("{pair:?}") };
        assert!(left.abs() > 60.0 && left.abs() < 180.0, "under way: {left}");
        // The correction of this cycle, and an increment of the slave.
        assert!((error - left).abs() < 2.0, "{distance}: {error} of {left}");
    }
}

/// From a distance of 2300 inc the sensor reports a product two periods early: its mark corrects only within 300 inc.
/// Proves: MACS-MARK-03
#[test]
fn marks_of_a_sensor_far_away_wait_for_their_period() {
    let mut world = world(&[("syncmpulsm", 2_300)]);
    start(&mut world, SyncMode::MasterMarker);
    // Products at 500, 1500, 2500; from 3500 on they are 60 inc late.
    for product in world.products.iter_mut().skip(3) {
        *product += 60.0;
    }
    let marks = |world: &BeltAndRoll| -> Vec<Event> {
        world.rig.events.iter().filter(|event| event.kind == Kind::Mark).cloned().collect()
    };
    while world.belt < 2_480 {
        world.cycle(SPEED);
    }
    assert_eq!(marks(&world).len(), 0);
    while world.belt < 4_400 {
        world.cycle(SPEED);
    }
    assert_eq!(marks(&world).len(), 2);
    // The product at 3560 was detected, and nothing is corrected for it before 5560.
    while world.belt < 5_540 {
        world.cycle(SPEED);
    }
    assert!(off(&world, 200.0).abs() <= 1.0, "{}", off(&world, 200.0));
    world.run(300, SPEED);
    assert!(off(&world, 140.0).abs() <= 1.0, "{}", off(&world, 140.0));
}

/// With a window a missed product corrects nothing, and is reported once; an additional one corrects nothing, either. A
/// correction keeps its bound.
/// Proves: MACS-MARK-07, MACS-MARK-18
#[test]
fn windows_and_bounds_hold_for_cams() {
    let mut world = world(&[("syncmpulsm", 300), ("syncmwinm", 100), ("syncmmaxcorr", 30)]);
    start(&mut world, SyncMode::MasterMarker);
    world.run(6_000, SPEED);
    assert!(off(&world, 200.0).abs() <= 1.0);
    let corrections = world.rig.events.iter().filter(|event| event.kind == Kind::Mark);
    assert!(corrections.map(|event| event.limit).all(|limit| match limit {
        Number::Real(correction) => correction.abs() <= 30.0,
        _ => false,
    }));
    let first = world.products[0];
    world.products.remove(1);
    world.products.insert(1, first + 400.0);
    world.run(3_000, SPEED);
    assert_eq!((world.events(Code::MARK_MISSED), world.events(Code::MARK_EXTRA)), (1, 1));
    assert!(off(&world, 200.0).abs() <= 1.0);
}

/// Backwards, and with a master that runs through the table in the opposite direction.
/// Proves: MACS-CMD-14
#[test]
fn marks_of_cams_follow_the_direction_of_the_cam() {
    for (speed, scale) in [(-SPEED, 1), (SPEED, -1), (-SPEED, -1)] {
        let mut world = world(&[("syncmpulsm", 300)]);
        world.sense = ((speed / SPEED) as f64, 1.0);
        let turned = CamIn { master_scale: Ratio::new(scale, 1).unwrap(), ..cam(FEED, CamStart::Relative) };
        let goal = world.rig.give(Action::Synchronize(request(SyncMode::MasterMarker, turned)));
        assert!(world.rig.was_accepted(goal), "{}", world.rig.refusal(goal));
        world.record_position();
        world.run(9_000, speed);
        // Products are at 500 and every 1000 inc after it; there the cam has 300 inc left in its direction.
        let sense = scale as f64;
        let at_product = world.rig.int("x.command.position") as f64;
        let shifts = [200.0, -200.0, 800.0, -800.0];
        let of = |shift: f64| at_product - fed(sense * world.belt as f64 + shift);
        assert!(shifts.iter().any(|shift| of(*shift).abs() <= 1.0), "{speed} {scale}: {:?}", shifts.map(of));
        let product = speed.signum() as f64 * 500.0;
        let place = |shift: f64| (sense * product + shift).rem_euclid(1_000.0);
        let met = shifts.iter().filter(|shift| of(**shift).abs() <= 1.0).all(|shift| place(*shift) == 700.0);
        assert!(met, "{speed} {scale}");
    }
}

/// The sensor of the labels is 500 inc before the start of a slave period. The roll is shifted by 800 inc, plus the lag
/// of the drive, until the cam is at 1500 at a label.
/// Proves: MACS-CMD-14, MACS-MARK-04
#[test]
fn labels_meet_the_period_of_the_slave() {
    for changes in [&[][..], &[("syncofftime", 400)]] {
        let mut world = world(&[&[("syncmpulss", 500), ("syncaccuracy", 20)], changes].concat());
        start(&mut world, SyncMode::SlaveMarker);
        world.run(8_000, SPEED);
        let off = off(&world, 0.0).rem_euclid(2_000.0);
        assert!((off - 804.0).abs() <= 2.0, "{off}");
        assert!(world.rig.real("x.marker.error").abs() < 0.5);
        assert_eq!((world.rig.int("x.in_sync"), world.rig.int("x.sync.status") & 0b10), (1, 0b10));
    }
}

/// With syncmstart 2000 the master counts from its first mark, where the remaining travel of the cam equals the
/// distance of the sensor.
/// Proves: MACS-MARK-14, MACS-CMD-13
#[test]
fn a_cam_begins_at_the_first_mark() {
    let mut world = world(&[("syncmpulsm", 300), ("syncmstart", 2_000)]);
    start(&mut world, SyncMode::MasterMarker);
    world.run(240, SPEED);
    assert_eq!((world.rig.int("x.command.position"), world.rig.state("x")), (0, "SYNCHRONIZED_MOTION"));
    world.run(4_000, SPEED);
    let expected = fed(world.belt as f64 + 200.0) - fed(700.0);
    assert!((world.rig.int("x.command.position") as f64 - expected).abs() <= 1.0);
    // There is nothing to correct.
    assert!(world.rig.real("x.marker.error").abs() < 0.1 && world.rig.int("x.in_sync") == 1);
}

#[test]
fn invalid_marks_of_cams_are_refused() {
    let third = CamIn { master_scale: Ratio::new(3, 1).unwrap(), ..cam(FEED, CamStart::Relative) };
    let relative = |table| cam(table, CamStart::Relative);
    let of = |mode, cam| Action::Synchronize(request(mode, cam));
    let (master, slave) = (SyncMode::MasterMarker, SyncMode::SlaveMarker);
    for (changes, action, sentence) in [
        (("syncmarkm", 1), of(master, relative(ONCE)), "x: marks of a cam need a cyclic table"),
        (("syncmarkm", 1), of(master, third), "x: marks of a cam need a cyclic table"),
        (("syncmarkm", 1), of(slave, relative(BACK)), "x: marks of the slave need a cam that feeds"),
        (
            ("syncmpulsm", 8_001),
            of(master, relative(FEED)),
            "x: the sensor of the marks is 8001 inc away; at most 8000 inc",
        ),
        (
            ("syncmpulss", 16_001),
            of(slave, relative(FEED)),
            "x: the sensor of the marks is 16001 inc away; at most 16000",
        ),
        (("syncmstart", 2_000), of(slave, relative(FEED)), "x: syncmstart 2000 begins a cam at the first mark"),
        (("syncmstart", 2_000), of(master, cam(FEED, CamStart::RampIn)), "x: syncmstart 2000 begins a cam"),
        (("syncmtypm", 1), of(master, relative(FEED)), "x: syncmtypm 1 asks for an index pulse that there is not"),
        (("syncmtyps", 33), of(slave, relative(FEED)), "x: syncmtyps names digital input 3"),
    ] {
        let mut world = world(&[changes]);
        let goal = world.rig.give(action);
        let refusal = world.rig.refusal(goal);
        assert!(refusal.starts_with(sentence), "{refusal}");
        assert_eq!(world.rig.state("x"), "STANDSTILL");
    }
    // The other side needs no marks.
    let mut world = world(&[("syncmtyps", 33)]);
    start(&mut world, master);
}

/// A machine restored from any point of a recording gives the same results, also with waiting marks.
#[test]
fn cams_with_marks_are_restored() {
    for (mode, changes) in [
        (SyncMode::MasterMarker, [("syncmpulsm", 2_300), ("syncofftime", 400)]),
        (SyncMode::SlaveMarker, [("syncmpulss", 4_300), ("syncmftime", 1_000)]),
    ] {
        let mut world = world(&changes);
        start(&mut world, mode);
        world.run(1_333, SPEED);
        world.rig.mirror();
        world.run(2_000, SPEED);
    }
}

/// A phase shift or a superimposed move would be corrected away.
#[test]
fn nothing_else_shifts_a_cam_with_marks() {
    let mut world = world(&[("syncmpulsm", 300)]);
    start(&mut world, SyncMode::MasterMarker);
    let shift =
        crate::command::PhaseShift { shift: crate::position::Length::whole(10), velocity: 1.0, acceleration: 1.0 };
    let side = crate::command::PhaseSide::Slave(shift);
    let goal = world.rig.give(Action::Phase(crate::command::Phase { axis: X, side }));
    assert!(world.rig.refusal(goal).contains("coupled by marks"), "{}", world.rig.refusal(goal));
    set(&mut world.rig, &[("syncmpulsm", 400)]);
    world.record_position();
    world.run(3_000, SPEED);
    // It acts at once: the product is detected 400 inc before its position.
    assert!(off(&world, 100.0).abs() <= 1.0);
}

/// A scale of 1 : 3 causes distances that are rounded in each cycle. A mark of the cam still occurs in each of its
/// periods of 3000 inc, also at the end of a cycle.
/// Proves: MACS-CMD-14
#[test]
fn rounded_distances_lose_no_period() {
    for speed in [1, 2, 5] {
        let mut world = world(&[("syncmpulsm", 300)]);
        world.products = (0..40).map(|place| 500.0 + 3_000.0 * f64::from(place)).collect();
        let slow = CamIn { master_scale: Ratio::new(1, 3).unwrap(), ..cam(FEED, CamStart::Relative) };
        let goal = world.rig.give(Action::Synchronize(request(SyncMode::MasterMarker, slow)));
        assert!(world.rig.was_accepted(goal), "{}", world.rig.refusal(goal));
        world.record_position();
        world.run(20_000 / speed as usize, speed);
        // 500 inc and a shift are 300 inc before 3000.
        let off = [-800.0, 2_200.0]
            .map(|shift| world.rig.int("x.command.position") as f64 - fed((world.belt as f64 + shift) / 3.0));
        assert!(off.iter().any(|off| off.abs() <= 1.5), "{speed}: {off:?}");
        assert!(world.rig.events.iter().filter(|event| event.kind == Kind::Mark).count() >= 6);
    }
}

/// Waiting marks of a sensor that is moved nearer are discarded, and do not return when the sensor is moved away again.
/// Proves: MACS-MARK-03
#[test]
fn moving_the_sensor_discards_waiting_marks() {
    let mut world = world(&[("syncmpulsm", 2_300)]);
    start(&mut world, SyncMode::MasterMarker);
    world.run(4_000, SPEED);
    for distance in [300, 2_300] {
        set(&mut world.rig, &[("syncmpulsm", distance)]);
        world.record_position();
        world.run(250, SPEED);
    }
    world.run(5_000, SPEED);
    assert!(off(&world, 200.0).abs() <= 1.0, "{}", off(&world, 200.0));
    assert!(world.rig.real("x.marker.error").abs() < 0.1);
}

/// A correction added to the master is not a motion of it: an axis that is released and moves on keeps the velocity of
/// the belt.
/// Proves: MACS-CMD-14
#[test]
fn axis_released_after_correction_keeps_velocity_of_belt() {
    let mut world = world(&[("syncmpulsm", 300)]);
    let request = request(SyncMode::MasterMarker, cam(FEED, CamStart::Relative));
    let goal = world.rig.give(Action::Synchronize(Synchronize { disengage: Disengage::KeepVelocity, ..request }));
    world.record_position();
    while world.rig.events.iter().all(|event| event.kind != Kind::Mark) {
        world.cycle(SPEED);
    }
    world.run(30, SPEED);
    world.rig.give(Action::Cancel { goal });
    world.rig.run(200);
    let velocity = world.rig.real("x.command.velocity");
    assert!((3_500.0..=4_500.0).contains(&velocity), "{velocity}");
}

/// A table without a period is refused while marks refer to the period.
#[test]
fn a_table_without_a_period_for_its_marks_is_refused() {
    let mut world = world(&[("syncmpulss", 500)]);
    start(&mut world, SyncMode::SlaveMarker);
    let back = Table::new(Form::Xy, &[0, 500, 1_000], &[0, 50, 0]).expect("points");
    let goal = world.rig.give(Action::LoadTable { index: FEED, table: Arc::new(back) });
    assert!(world.rig.refusal(goal).contains("need a cam that feeds"), "{}", world.rig.refusal(goal));
}

proptest! {
    #![proptest_config(super::rig::cases(24))]
    /// For any sensor distance and any product positions, with any history: finally each product meets the start of the
    /// cam, by the shortest correction.
    /// Proves: MACS-CMD-14
    #[test]
    fn each_product_meets_the_start(
        distance in 250_i64..8_000,
        first in 1.0..1_000.0_f64,
        jitter in prop::collection::vec(-90.0..90.0_f64, 6),
        time in prop_oneof![Just(0_i64), Just(300)],
        speed in 1_i64..4,
    ) {
        let mut world = BeltAndRoll::with_tables(tables(), first, &[("syncmpulsm", distance), ("syncofftime", time), ("syncmwinm", 250)]);
        for (product, by) in world.products.iter_mut().zip(&jitter) {
            *product += by;
        }
        start(&mut world, SyncMode::MasterMarker);
        world.run(25_000 / speed as usize, speed);
        let shift = (-distance as f64 - first).rem_euclid(1_000.0);
        let off = [shift, shift - 1_000.0, shift + 1_000.0].map(|shift| off(&world, shift));
        prop_assert!(off.iter().any(|off| off.abs() <= 1.5), "{off:?}");
        prop_assert_eq!(world.rig.int("x.in_sync"), 1);
    }
}

use super::super::cam::Cam;
use super::super::gear::{Gear, Ratio};
use super::*;
use crate::table::{Form, Table};
use proptest::prelude::*;

const T: f64 = 0.001;
const BOUNDS: Bounds =
    Bounds { velocity: 5e4, acceleration: 1e5, max_velocity: 1e5, max_acceleration: 4e5, max_deceleration: 4e5 };

fn follower(numerator: i64, denominator: i64, mode: SyncMode) -> Follower {
    let ratio = Ratio::new(numerator, denominator).unwrap();
    Follower::new(1.0, gear(ratio), mode, Motion::default(), Position::ZERO, BOUNDS)
}

fn gear(ratio: Ratio) -> Transmission {
    Transmission::Gear(Gear::new(ratio))
}

fn lead(change: i64) -> Lead {
    Lead { change: Position::whole(change), uneven: 1.0, valid: true, ..Lead::default() }
}

/// A lead calculated from another one may vary by more than a count from cycle to cycle. With that unevenness the
/// variation is no acceleration.
#[test]
fn unevenness_of_the_lead_is_no_acceleration() {
    let lost = |uneven: f64| {
        let bounds = Bounds { max_acceleration: 1e3, max_deceleration: 1e3, acceleration: 1e3, ..BOUNDS };
        let mut follower =
            Follower::new(uneven, gear(Ratio::ONE), SyncMode::Position, Motion::default(), Position::ZERO, bounds);
        let mut slave = Motion::default();
        (0..4000)
            .filter(|cycle| {
                // Twice the counts of an encoder: 14, 16, 14, 16.
                let lead = Lead { uneven, ..lead(14 + 2 * (cycle % 2)) };
                slave = follower.step(slave, (lead, &[]), T, Reserve::default(), ReversingRule::Always);
                *cycle >= 3000 && follower.phase() != Phase::Synchronized
            })
            .count()
    };
    assert_eq!(lost(2.0), 0);
    assert!(lost(1.0) > 900, "1e3 inc/s^2 is 0.001 inc in a cycle");
}

/// Proves: MACS-SYNC-04, MACS-SYNC-06
#[test]
fn on_the_run_the_slave_catches_up_what_it_lost_while_it_sped_up() {
    let mut follower = follower(1, 1, SyncMode::Position);
    let mut slave = Motion::default();
    let mut master = 0;
    for k in 0..2000 {
        master += 20;
        let before = slave;
        slave = follower.step(slave, (lead(20), &[]), T, Reserve::default(), ReversingRule::Always);
        assert!(slave.velocity <= 5e4 + 1e-6 && slave.velocity >= 0.0, "cycle {k}: {}", slave.velocity);
        // 1e5 inc/s^2; only the start of the leader itself, in the first cycle, may add a count.
        let uneven = if k == 0 { 1.0 / T } else { 0.0 };
        assert!((slave.velocity - before.velocity).abs() <= 1e5 * T + uneven + 1e-6, "cycle {k}");
    }
    assert_eq!(follower.phase(), Phase::Synchronized);
    assert_eq!(slave.position, Position::whole(master));
    assert_eq!(slave.velocity, 2e4);
}

/// Proves: MACS-SYNC-07
#[test]
fn in_velocity_mode_what_is_lost_stays_lost() {
    let mut follower = follower(1, 1, SyncMode::Velocity);
    let mut slave = Motion::default();
    let (mut master, mut behind) = (0, None);
    for _ in 0..1000 {
        master += 20;
        slave = follower.step(slave, (lead(20), &[]), T, Reserve::default(), ReversingRule::Always);
        if follower.phase() == Phase::Synchronized {
            let now = Position::whole(master) - slave.position;
            assert_eq!(*behind.get_or_insert(now), now);
        }
    }
    assert!(behind.unwrap() > Position::ZERO);
}

/// Proves: MACS-SYNC-02
#[test]
fn a_slave_at_rest_is_coupled_at_once_and_follows_every_fraction() {
    let mut follower = follower(355, 113, SyncMode::Position);
    let mut slave = Motion::default();
    let mut master = 0_i64;
    for k in 0..5000_i64 {
        // Up to 30 inc per cycle and back through zero, one more or less every ten cycles.
        let step = (k / 10 + 30).rem_euclid(120);
        let step = (step - 60).abs() - 30;
        master += step;
        slave = follower.step(slave, (lead(step), &[]), T, Reserve::default(), ReversingRule::Always);
        assert_eq!(slave.position.floor(), (master * 355).div_euclid(113), "cycle {k}");
        assert_eq!(follower.phase(), Phase::Synchronized);
    }
}

#[test]
fn a_leader_that_is_too_fast_is_left_and_caught_again() {
    let mut follower = follower(1, 1, SyncMode::Position);
    let mut slave = Motion::default();
    let mut master = 0;
    let mut phases = Vec::new();
    for k in 0..5000 {
        let step = if (1000..1200).contains(&k) { 150 } else { 10 };
        master += step;
        slave = follower.step(slave, (lead(step), &[]), T, Reserve::default(), ReversingRule::Always);
        assert!(slave.velocity.abs() <= 1e5 + 1e-6);
        if phases.last() != Some(&follower.phase()) {
            phases.push(follower.phase());
        }
    }
    use Phase::*;
    assert_eq!(phases, [CatchingUp, Synchronized, CatchingUp, Synchronized]);
    assert_eq!(slave.position, Position::whole(master));
}

#[test]
fn offset_is_removed_and_stays_removed() {
    let ratio = Ratio::new(1, 1).unwrap();
    let offset = Position::whole(-777);
    let mut follower = Follower::new(1.0, gear(ratio), SyncMode::Position, Motion::default(), offset, BOUNDS);
    let mut slave = Motion::default();
    for _ in 0..1000 {
        slave = follower.step(slave, (lead(3), &[]), T, Reserve::default(), ReversingRule::Always);
    }
    assert_eq!(slave.position, Position::whole(3000 - 777));
}

/// The fast path, if it is possible.
fn shortly(
    follower: &Follower,
    slave: Motion,
    (lead, tables): (Lead, &[Arc<Table>]),
    rule: ReversingRule,
) -> Option<(Motion, Follower)> {
    let mut other = *follower;
    let following = match *follower.transmission() {
        Transmission::Gear(gear) => {
            let (change, behind) = gear.stepped(lead.change)?;
            let following = follower.follow(slave, (lead, change), &behind, T, rule)?;
            other.keep(&following, behind);
            following
        }
        Transmission::Cam(cam) => {
            let (change, behind) = cam.stepped(lead.change, tables)?;
            let following = follower.follow(slave, (lead, change), &behind, T, rule)?;
            other.keep(&following, behind);
            following
        }
        Transmission::Approach(_) => return None,
    };
    Some((following.motion, other))
}

proptest! {
    /// For any motion of the leader within the limits of the slave: once the leader is steady the slave arrives
    /// exactly, and it never exceeds its velocity or acceleration while it catches up.
    #[test]
    fn the_slave_arrives_exactly(
        start_velocity in -4e4..4e4_f64,
        leader_step in -30_i64..30,
        numerator in prop_oneof![-500_i64..-100, 100_i64..500],
        offset in -5000_i64..5000,
    ) {
        let ratio = Ratio::new(numerator, 500).unwrap();
        let start = Motion { velocity: start_velocity, ..Motion::default() };
        let offset = Position::whole(offset);
        let mut follower = Follower::new(1.0, gear(ratio), SyncMode::Position, start, offset, BOUNDS);
        let mut slave = start;
        let mut uneven = numerator.abs() as f64 / 500.0 / T;
        for _ in 0..3000 {
            let before = slave.velocity;
            slave = follower.step(slave, (lead(leader_step), &[]), T, Reserve::default(), ReversingRule::Always);
            prop_assert!(slave.velocity.abs() <= BOUNDS.velocity + 1e-3);
            prop_assert!((slave.velocity - before).abs() <= BOUNDS.acceleration * T + uneven + 1e-3);
            // The speed of the leader is constant: it is uneven only in its first cycle.
            uneven = 0.0;
        }
        prop_assert_eq!(follower.phase(), Phase::Synchronized);
        let total = Position::whole(3000 * leader_step);
        prop_assert_eq!(slave.position, offset + Gear::new(ratio).step(total));
    }

    /// The fast path gives the same slave and follower as the full step, bit by bit, and a slave that follows uses it.
    #[test]
    fn fast_path_equals_the_full_step(
        numerator in prop_oneof![-1000_i64..-1, 1_i64..1000],
        denominator in 1_i64..1000,
        speed in -90_i64..90,
        leaps in prop::collection::vec(-3_i64..=3, 100),
        uneven in prop_oneof![Just(0.0), Just(1.0), 0.1..4.0_f64],
        rule in prop_oneof![Just(ReversingRule::Always), Just(ReversingRule::WithMaster), Just(ReversingRule::Never)],
        slow in 1_i64..50,
        is_cam in any::<bool>(),
    ) {
        let gear = Gear::new(Ratio::new(numerator, denominator).unwrap());
        let step = gear.ratio().to_f64() * speed as f64 / 3.0;
        let mut slave = Motion { velocity: step / T, ..Motion::default() };
        let tables = [Arc::new(Table::new(Form::Xy, &[0, 211, 700], &[0, 180, 400]).expect("points"))];
        let cam = || Cam::new(0, (gear.ratio(), Ratio::ONE), Position::ZERO, &tables).expect("a cam");
        let transmission = if is_cam { Transmission::Cam(cam()) } else { Transmission::Gear(gear) };
        let step = if is_cam { step * 180.0 / 211.0 } else { step };
        slave.velocity = step / T;
        let mode = SyncMode::Position;
        let mut follower = Follower::new(uneven, transmission, mode, slave, Position::ZERO, BOUNDS).at_once();
        let mut steady = 0;
        for (cycle, leap) in (0..).zip(&leaps) {
            let change = Position::from_f64((speed + leap * i64::from(cycle % slow == slow - 1)) as f64 / 3.0);
            let lead = Lead { change, uneven, valid: true, ..Lead::default() };
            let short = shortly(&follower, slave, (lead, &tables), rule);
            slave = follower.step(slave, (lead, &tables), T, Reserve::default(), rule);
            if let Some((motion, other)) = short {
                prop_assert_eq!(format!("{motion:?}"), format!("{slave:?}"));
                prop_assert_eq!(format!("{other:?}"), format!("{follower:?}"));
                steady += 1;
            }
        }
        // At corners of a cam it may not be able to follow.
        let may_follow = !is_cam && step.abs() < 90.0 && (rule != ReversingRule::Never || step >= 0.0);
        prop_assert!(steady > 0 || slow == 1 || !may_follow, "it never followed");
    }
}

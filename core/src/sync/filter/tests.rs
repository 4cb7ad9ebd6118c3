//! The filter of a master compared with its law.

use super::*;
use proptest::prelude::*;

const MS: f64 = 1_000.0;

fn keeping(tau: f64) -> Filtering {
    Filtering { tau, keeps: Keeps::Position, limit: 0.0 }
}

/// cmd = old + (act - old) / tau per ms: with 4 ms a quarter of the difference per ms.
///
/// Proves: MACS-SYNC-07, MACS-SYNC-08
#[test]
fn a_velocity_comes_by_its_share_each_ms() {
    let filtering = Filtering { keeps: Keeps::Velocity, ..keeping(4_000.0) };
    let mut filter = MasterFilter::default();
    let given = [(); 3].map(|_| filter.step(Position::whole(64), &filtering, MS).to_f64());
    assert_eq!(given, [16.0, 28.0, 37.0]);
    // In half the time half of it: tau is a time, not a number of cycles.
    let mut filter = MasterFilter::default();
    assert_eq!(filter.step(Position::whole(32), &filtering, MS / 2.0).to_f64(), 4.0);
    // A tau below a cycle does not filter.
    let mut filter = MasterFilter::default();
    assert_eq!(filter.step(Position::whole(64), &keeping(400.0), MS).to_f64(), 64.0);
}

/// |tau| 100000 us gives back 1/1000 of the error per ms, 50000 us 2/1000.
///
/// Proves: MACS-SYNC-09, MACS-O-37
#[test]
fn lag_distance_returns_in_ten_tau() {
    for (tau, per_ms) in [(100_000.0, 0.001), (50_000.0, 0.002)] {
        let mut filter =
            MasterFilter { lag: Lag { velocity: 0.0, owed: Position::whole(1_000_000) }, ..Default::default() };
        let back = filter.step(Position::ZERO, &keeping(tau), MS);
        assert_eq!(back.to_f64(), 1_000_000.0 * per_ms);
        assert_eq!(filter.lag_distance() + back, Position::whole(1_000_000));
    }
}

/// Calculated by hand, tau 10 ms, 100 inc in a ms from rest: 10 are given, 90 are owed, of which 1/100 is given at
/// once.
///
/// Proves: MACS-SYNC-09
#[test]
fn the_first_step_of_a_filter_that_keeps() {
    let mut filter = MasterFilter::default();
    assert_eq!(filter.step(Position::whole(100), &keeping(10_000.0), MS), Position::from_f64(10.9));
    assert!((filter.lag_distance().to_f64() - 89.1).abs() < 1e-8);
}

/// Proves: MACS-SYNC-11
#[test]
fn beyond_its_limit_it_becomes_faster_and_comes_back() {
    let filtering = Filtering { limit: 50.0, ..keeping(20_000.0) };
    let mut filter = MasterFilter::default();
    // From rest 100 inc per ms: 95 are owed, 0.475 of that is given.
    filter.step(Position::whole(100), &filtering, MS);
    assert!(filter.lag_distance().to_f64() > 50.0);
    assert_eq!(filter.tau(&filtering), 19_000.0);
    for _ in 0..13 {
        filter.step(Position::whole(100), &filtering, MS);
    }
    assert_eq!(filter.tau(&filtering), 6_000.0);
    for _ in 0..10 {
        filter.step(Position::whole(100), &filtering, MS);
    }
    // Not below 5 ms.
    assert_eq!(filter.tau(&filtering), 5_000.0);
    // A filter with constant 20 ms owes at most 100 * 19, and gives it back in 200 ms: below 10 its tau increases.
    let mut cycles = 0;
    while filter.tau(&filtering) == 5_000.0 {
        filter.step(Position::whole(100), &filtering, MS);
        cycles += 1;
        assert!(cycles < 5_000);
    }
    assert!(filter.kept.owed.to_f64() < 10.0);
    for expected in 7..=20 {
        filter.step(Position::whole(100), &filtering, MS);
        assert_eq!(filter.tau(&filtering), f64::from(expected) * MS);
    }
    filter.step(Position::whole(100), &filtering, MS);
    assert_eq!(filter.tau(&filtering), 20_000.0);
}

/// By marks nothing is owed: 100 inc per ms at 20 ms hold back 1900 in total, and beyond 50 the filter becomes faster.
/// The sum starts again every 20 ms, and after 20 ms below the limit tau increases.
///
/// Proves: MACS-SYNC-11
#[test]
fn limit_of_marks_is_checked_every_tau() {
    let filtering = Filtering { keeps: Keeps::Marks, limit: 50.0, ..keeping(20_000.0) };
    let mut filter = MasterFilter::default();
    let mut given = Position::ZERO;
    for _ in 0..20 {
        given += filter.step(Position::whole(100), &filtering, MS);
    }
    assert_eq!((filter.lag_distance(), filter.tau(&filtering)), (Position::ZERO, 5_000.0));
    assert!(given < Position::whole(2_000));
    // It has settled about at the end of the next tau: from then on tau increases by 1 ms per ms.
    let mut taus = vec![];
    for _ in 0..80 {
        filter.step(Position::whole(100), &filtering, MS);
        taus.push(filter.tau(&filtering));
    }
    let first = taus.iter().position(|tau| *tau > 5_000.0).expect("it comes back");
    assert!(first % 20 == 0 && first >= 20, "{first}");
    assert_eq!(taus[first..first + 15], (6..=20).map(|ms| f64::from(ms) * MS).collect::<Vec<_>>());
}

/// A tau below 5 ms is not reduced.
///
/// Proves: MACS-SYNC-11
#[test]
fn a_short_tau_stays() {
    let filtering = Filtering { limit: 1.0, ..keeping(3_000.0) };
    let mut filter = MasterFilter::default();
    filter.step(Position::whole(1_000), &filtering, MS);
    assert_eq!(filter.tau(&filtering), 3_000.0);
}

proptest! {
    /// In any motion the given and the owed distance add up to that of the master, to 2^-32 inc; once it is at rest,
    /// all of it is given.
    ///
    /// Proves: MACS-SYNC-09
    #[test]
    fn nothing_is_lost(
        changes in prop::collection::vec(-(1_i128 << 50)..(1_i128 << 50), 1..400),
        tau in 1.0..300_000.0_f64,
        limit in prop_oneof![Just(0.0), 1.0..1e6_f64],
        cycle in prop_oneof![Just(250.0), Just(MS), Just(4_000.0)],
    ) {
        let filtering = Filtering { limit, ..keeping(tau) };
        let mut filter = MasterFilter::default();
        let (mut way, mut given) = (Position::ZERO, Position::ZERO);
        for change in changes {
            let change = Position::from_raw(change);
            way += change;
            given += filter.step(change, &filtering, cycle);
            prop_assert_eq!(given + filter.lag_distance(), way);
            prop_assert!(filter.is_sound());
        }
    }

    /// At constant velocity of the master nothing is owed in the end.
    #[test]
    fn all_of_it_comes_in_time(change in -(1_i128 << 44)..(1_i128 << 44), tau in 1_000.0..20_000.0_f64) {
        let mut filter = MasterFilter::default();
        let (change, filtering) = (Position::from_raw(change), keeping(tau));
        for _ in 0..12_000 {
            filter.step(change, &filtering, MS);
        }
        prop_assert_eq!(filter.lag_distance(), Position::ZERO);
        prop_assert_eq!(filter.step(change, &filtering, MS), change);
    }
}

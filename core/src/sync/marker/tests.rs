//! Pairs of marks and their corrections.

use super::*;
use crate::parameter::Synchronization;

const T: u64 = 1_000_000;

/// A master with a mark every 500 inc, and a slave at 2 : 1.
struct Bench {
    marker: Marker,
    sync: Synchronization,
    marks: Marks,
    now: u64,
    under_way: f64,
    runs: bool,
    ratio: f64,
    sense: f64,
}

impl Bench {
    fn new(start: i64) -> Self {
        let sync = Synchronization { mark_distance: 500, ..Synchronization::default() };
        let marks = Marks { start, ready: 2, fault: 1, ..Marks::default() };
        Self { marker: Marker::default(), sync, marks, now: 0, under_way: 0.0, runs: true, ratio: 2.0, sense: 1.0 }
    }

    fn situation(&self) -> Situation<'_> {
        let asked = LawInputs { sync: &self.sync, marks: &self.marks, speed: 10.0, ratio: self.ratio };
        Situation { asked, offset: 0.0, under_way: self.under_way, runs: self.runs, sense: self.sense }
    }

    /// Moves the master by `way`, and the slave by twice that; the marks of `of` come at the end.
    fn pass(&mut self, way: i64, of: &[MarkSide]) -> Option<Pair> {
        self.now += T;
        let mut marker = self.marker;
        marker.advance(Position::whole(way), Position::from_f64(self.ratio * way as f64));
        for of in of {
            marker.take(*of, (Position::ZERO, self.now), &self.situation().asked);
        }
        let pair = marker.pair(&self.situation(), 10);
        self.marker = marker;
        pair
    }

    /// Returns the error of the first pair of these marks, each with the travel of the master before it.
    fn first(start: i64, marks: &[(i64, MarkSide)]) -> Option<f64> {
        let mut bench = Self::new(start);
        marks.iter().find_map(|(way, of)| bench.pass(*way, &[*of])).map(|pair| pair.error)
    }
}

/// Master, 100 later slave, 400 later master, slave, ..: the slave is 100 inc of the master late, or 400 early; 200 or
/// 800 of its own.
///
/// Proves: MACS-MARK-14, MACS-MARK-12
#[test]
fn the_start_chooses_the_first_pair() {
    use MarkSide::{Master, Slave};
    let marks = [(0, Master), (100, Slave), (400, Master), (100, Slave), (400, Master)];
    for (start, expected) in
        [(0, 200.0), (1, -800.0), (2, 200.0), (3, 200.0), (4, -800.0), (5, 200.0), (6, 200.0), (1_000, 200.0)]
    {
        assert_eq!(Bench::first(start, &marks), Some(expected), "{start}");
    }
    // The slave comes first, 100 inc before the master.
    let marks = [(0, Slave), (100, Master), (400, Slave), (100, Master)];
    for (start, expected) in [(0, 800.0), (1, -200.0), (2, -200.0), (3, 800.0), (4, -200.0), (5, -200.0), (6, -200.0)] {
        assert_eq!(Bench::first(start, &marks), Some(expected), "{start}");
    }
}

/// Forward is the direction of the slave with its master: counting down, the same marks are in the opposite order.
///
/// Proves: MACS-MARK-14
#[test]
fn forwards_is_where_the_slave_runs() {
    use MarkSide::{Master, Slave};
    for (ratio, sign) in [(2.0, 1), (-2.0, 1), (2.0, -1), (-2.0, -1)] {
        let sense = ratio / 2.0 * f64::from(sign);
        for (start, expected) in [(3, 200.0), (4, -800.0), (5, 200.0)] {
            let mut bench = Bench { ratio, sense, ..Bench::new(start) };
            let first = bench.pass(0, &[Master]).or(bench.pass(100 * i64::from(sign), &[Slave]));
            assert_eq!(first.map(|pair| pair.error), Some(expected * sense), "{ratio} {sign} {start}");
        }
    }
}

/// If a start cannot be corrected at once, the rest is expected, and its partners remain.
///
/// Proves: MACS-MARK-18, MACS-MARK-14
#[test]
fn start_beyond_the_bound_keeps_its_distance() {
    let mut bench = Bench::new(3);
    bench.marks.largest = 50;
    let mut error = bench.pass(0, &[MarkSide::Slave]).or(bench.pass(170, &[MarkSide::Master])).map(|pair| pair.error);
    // 170 of the master behind: 340 back, or 660 forward.
    assert_eq!(error, Some(660.0));
    for k in 1..=13 {
        // 50 inc are moved by the next pair, whose mark of the slave comes earlier by half of that.
        bench.marker.advance(Position::ZERO, Position::whole(50));
        let pair = bench.pass(330 - 25 * k, &[MarkSide::Slave]).or(bench.pass(170 + 25 * k, &[MarkSide::Master]));
        error = pair.map(|pair| pair.error);
    }
    assert_eq!(error, Some(660.0 - 13.0 * 50.0));
}

/// Marks that slip by more than half of a distance find new partners.
///
/// Proves: MACS-MARK-02
#[test]
fn marks_that_have_slipped_find_partners_again() {
    let mut bench = Bench::new(6);
    assert!(bench.pass(500, &[MarkSide::Master, MarkSide::Slave]).is_some());
    // The distance is set to 500 but is 2000: an error of 600 is more than half of the set distance.
    let errors: Vec<_> =
        (0..6).filter_map(|_| bench.pass(600, &[MarkSide::Slave]).or(bench.pass(1_400, &[MarkSide::Master]))).collect();
    assert!(!errors.is_empty(), "they never meet");
}

/// Starts 2 to 5 use no mark from before the slave has the velocity of its master.
///
/// Proves: MACS-MARK-14
#[test]
fn some_starts_wait_for_the_velocity() {
    for (start, waits) in [(0, false), (1, false), (2, true), (3, true), (4, true), (5, true), (6, false)] {
        let mut bench = Bench { runs: false, ..Bench::new(start) };
        let early = [MarkSide::Slave, MarkSide::Master, MarkSide::Slave].map(|of| bench.pass(250, &[of]).is_some());
        assert_eq!(early.contains(&true), !waits, "{start}");
        bench.runs = true;
        assert!(bench.pass(100, &[MarkSide::Master, MarkSide::Slave]).is_some(), "{start}");
    }
}

/// Every second mark of the master, and every third of the slave.
///
/// Proves: MACS-MARK-01, MACS-MARK-02
#[test]
fn only_the_last_of_each_group_is_evaluated() {
    let mut bench = Bench::new(6);
    (bench.marks.per_master, bench.marks.per_slave) = (2, 3);
    let marks = [MarkSide::Master, MarkSide::Slave, MarkSide::Slave, MarkSide::Master, MarkSide::Slave];
    let pairs = marks.map(|of| bench.pass(10, &[of]));
    assert_eq!(pairs.map(|pair| pair.is_some()), [false, false, false, false, true]);
    assert_eq!(pairs[4].map(|pair| pair.error), Some(20.0));
}

/// A mark without partner makes no pair, and the next one does.
///
/// Proves: MACS-MARK-07
#[test]
fn without_a_partner_a_mark_corrects_nothing() {
    let mut bench = Bench::new(6);
    assert!(bench.pass(500, &[MarkSide::Master, MarkSide::Slave]).is_some());
    assert_eq!(bench.pass(500, &[MarkSide::Master]), None);
    let pair = bench.pass(500, &[MarkSide::Master, MarkSide::Slave]);
    assert_eq!(pair, Some(Pair { error: 0.0, correction: 0.0 }));
    assert_eq!(bench.pass(500, &[MarkSide::Slave]), None);
    // The mark of the axis comes 3 inc of the master after that of the master.
    assert_eq!(bench.pass(503, &[MarkSide::Master]), None);
    assert_eq!(bench.pass(3, &[MarkSide::Slave]).map(|pair| pair.error), Some(6.0));
}

/// A correction that is commanded but not moved yet is commanded once.
///
/// Proves: MACS-MARK-13
#[test]
fn pending_correction_is_no_error() {
    let mut bench = Bench::new(6);
    let first = bench.pass(0, &[MarkSide::Master]).or(bench.pass(50, &[MarkSide::Slave]));
    assert_eq!(first, Some(Pair { error: 100.0, correction: 100.0 }));
    bench.under_way = 60.0;
    let next = bench.pass(450, &[MarkSide::Master]).or(bench.pass(50, &[MarkSide::Slave]));
    // They are 100 inc apart, and for 60 of that no new correction is commanded.
    assert_eq!(next, Some(Pair { error: 100.0, correction: 40.0 }));
}

/// Successive pairs: ready with the second accurate one, a fault with the second inaccurate one if one is tolerated.
///
/// Proves: MACS-MARK-20, MACS-MARK-21
#[test]
fn pairs_in_a_row_make_ready_and_fault() {
    let mut bench = Bench::new(6);
    let mut flags = vec![];
    // 10 inc are accurate, 12 are not.
    for late in [0, 5, 5, 6, 6, 6, 5] {
        bench.pass(500, &[MarkSide::Master]);
        bench.pass(late, &[MarkSide::Slave]);
        bench.pass(-late, &[]);
        flags.push((bench.marker.is_ready(&bench.marks), bench.marker.is_faulty(&bench.marks)));
    }
    let (no, ready, fault) = ((false, false), (true, false), (false, true));
    assert_eq!(flags, [no, ready, ready, no, fault, fault, no]);
    let none = Marks { ready: 0, fault: 0, ..bench.marks };
    assert_eq!((bench.marker.is_ready(&none), bench.marker.is_faulty(&none)), ready);
}

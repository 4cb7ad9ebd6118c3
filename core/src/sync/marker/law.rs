//! Corrections at a pair of marks: filters of distances and corrections, and the correction of the start.
//!
//! Law      of MACS-MARK-09 to -13 and -18, as interpreted in. PT1 is state + (value - state) / tau, with
//!          tau in marks. Distances of the master are averaged; their difference from the nominal one corrects the
//!          gear. The deviation of a single mark from the average is subtracted from the error; the rest is filtered.
//!          The error of the start is split separately
//! Reads    parameters, the velocity of the master, errors in increments of the slave
//! Writes   the correction of a pair; the correction of the gear
//! Refuses  nothing: corrections are limited to SYNCMMAXCORR
//! Source   MACS-MARK-03, -08 to -13, -18, -19

use crate::parameter::{Marks, Synchronization};
use serde::{Deserialize, Serialize};

/// Bits of SYNCMFPAR.
mod option {
    /// A filter that does not depend on the velocity.
    pub(super) const CONSTANT: i64 = 1;
    /// No correction of the gear.
    pub(super) const NO_GEAR: i64 = 2;
    /// Corrections are filtered like distances.
    pub(super) const OWN_FILTER: i64 = 4;
    /// No average, and no deviation from it.
    pub(super) const NO_AVERAGE: i64 = 16;
}

/// Least number of marks over which distances are averaged.
const LEAST_AVERAGE: f64 = 100.0;
/// Share of the nominal distance by which a measured one may differ from it.
const MOST_OFF: f64 = 0.5;
/// Multiple of its tau after which a PT1 has settled.
const SETTLED: f64 = 3.0;
/// Divisor of SYNCMFTIME for a constant filter.
const CONSTANT_DIVISOR: f64 = 300.0;

/// Inputs of the law.
#[derive(Clone, Copy, Debug)]
pub struct LawInputs<'p> {
    /// Parameters of synchronization of the axis.
    pub sync: &'p Synchronization,
    /// Parameters of marks of the axis.
    pub marks: &'p Marks,
    /// Filtered velocity of the master (inc per ms), without sign.
    pub speed: f64,
    /// Increments of the slave per increment of the master.
    pub ratio: f64,
}

impl LawInputs<'_> {
    fn has(&self, option: i64) -> bool {
        self.marks.options & option != 0
    }

    /// Returns the nominal distance between marks of the master (inc); none if unknown.
    fn distance(&self) -> Option<f64> {
        Some(self.sync.mark_distance as f64).filter(|distance| *distance > 0.0)
    }

    /// Returns SYNCMFTIME (ms), if set.
    pub fn filter_time(&self) -> Option<f64> {
        self.distance().and(Some(self.marks.filter_time as f64)).filter(|time| *time > 0.0)
    }

    /// Returns the number of marks that pass in a time (ms), at least 1.
    fn marks_in(&self, time: f64) -> f64 {
        self.distance().map_or(1.0, |distance| (self.speed * time / distance).max(1.0))
    }

    /// Returns the number of marks that pass in SYNCOFFTIME.
    fn marks_in_offset_time(&self) -> f64 {
        self.marks_in(self.sync.offset_time as f64)
    }

    /// Returns MARKERFILTER: tau of a filter that settles in `time` (ms).
    fn tau_of(&self, time: f64) -> f64 {
        let tau = if self.has(option::CONSTANT) { time / CONSTANT_DIVISOR } else { self.marks_in(time) / SETTLED };
        tau.max(1.0)
    }

    /// Whether the gear is corrected.
    fn corrects_gear(&self) -> bool {
        let corrects = self.marks.largest >= 0 && !self.has(option::NO_GEAR) && !self.has(option::NO_AVERAGE);
        self.filter_time().is_some() && corrects
    }

    /// Returns the distance of the master over which a correction is spread (inc), if corrections are filtered.
    pub fn spread(&self) -> Option<f64> {
        self.filter_time().and(self.distance())
    }

    /// Returns a correction limited to SYNCMMAXCORR.
    pub fn bound(&self, correction: f64) -> f64 {
        let most = self.marks.largest as f64;
        match self.marks.largest {
            0 => correction,
            ..0 => 0.0,
            _ => correction.max(-most).min(most),
        }
    }
}

fn pt1(state: f64, value: f64, tau: f64) -> f64 {
    state + (value - state) / tau
}

/// Average distance between marks of a side, and deviation of its marks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Average {
    /// Average distance (inc); 0: not known yet.
    distance: f64,
    /// Sum of the deviations (inc of the slave).
    sum: f64,
    /// Filtered sum of the deviations (inc of the slave).
    slow: f64,
}

impl Average {
    fn is_sound(&self) -> bool {
        [self.distance, self.sum, self.slow].iter().all(|value| value.is_finite())
    }

    fn begin(&mut self, nominal: f64) {
        if self.distance == 0.0 {
            self.distance = nominal;
        }
    }

    /// Adds a measured distance, negative for a side that moved backward, with the tau of the filter of marks.
    /// `reference`: distance for comparison, none: the average. A distance that differs too much from the nominal one
    /// is not between successive marks and does not count.
    fn take(&mut self, measured: f64, (tau, nominal): (f64, f64), reference: Option<f64>, scale: f64) {
        let (measured, scale) = (measured.abs(), scale * measured.signum());
        // NaN fails the comparison.
        let is_near = (measured - nominal).abs() <= nominal * MOST_OFF;
        if !is_near {
            return;
        }
        self.sum += scale * (reference.unwrap_or(self.distance) - measured);
        let marks = (SETTLED * tau).max(LEAST_AVERAGE);
        self.distance = pt1(self.distance, measured, marks / SETTLED);
    }

    /// Returns the deviation of the last marks.
    fn jitter(&mut self, tau: f64) -> f64 {
        self.slow = pt1(self.slow, self.sum, tau);
        self.sum - self.slow
    }
}

/// State of the law.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Law {
    master: Average,
    slave: Average,
    /// KORREKTUR, without the correction of the start (inc of the slave).
    correction: f64,
    /// STARTKORRREST.
    start_left: f64,
    /// STARTKORRVAL.
    start_step: f64,
    /// MARKERFILTER of the last mark (marks), KORRTAU of the last pair (pairs); 0 without a filter.
    filters: (f64, f64),
}

impl Law {
    /// Whether the state is possible.
    pub fn is_sound(&self) -> bool {
        let values = [self.correction, self.start_left, self.start_step, self.filters.0, self.filters.1];
        self.master.is_sound() && self.slave.is_sound() && values.iter().all(|value| value.is_finite())
    }

    /// Returns MMarkerDist: average distance between marks of the master (inc); the nominal one before the first mark.
    pub fn distance(&self, asked: &LawInputs<'_>) -> f64 {
        if self.master.distance > 0.0 { self.master.distance } else { asked.distance().unwrap_or_default() }
    }

    /// Returns MARKERFILTER: tau of the filter of marks at the last mark (marks); 0 without a filter.
    pub fn filter(&self) -> f64 {
        self.filters.0
    }

    /// Returns KORRTAU: tau of the filter of corrections at the last pair (pairs of marks); 0 without a filter.
    pub fn correction_filter(&self) -> f64 {
        self.filters.1
    }

    /// Returns STARTKORRREST: remaining start correction (inc of the slave).
    pub fn remaining_start_correction(&self) -> f64 {
        self.start_left
    }

    /// Returns MMARKERR: filtered sum of the errors of the distances of the master (inc of the slave); 0 without a
    /// filter.
    pub fn distance_error(&self) -> f64 {
        if self.filters.0 > 0.0 { self.master.slow } else { 0.0 }
    }

    /// Returns MMarkCorr: correction of the gear as a share of the velocity of the master.
    pub fn gear_correction(&self, asked: &LawInputs<'_>) -> f64 {
        match asked.distance().filter(|_| asked.corrects_gear() && self.master.distance > 0.0) {
            Some(nominal) => (nominal - self.master.distance) / self.master.distance,
            None => 0.0,
        }
    }

    /// Adds a mark of the master at that distance from the one before (inc).
    pub fn take_master(&mut self, measured: f64, asked: &LawInputs<'_>) {
        let (Some(nominal), Some(time)) = (asked.distance(), asked.filter_time()) else { return };
        self.master.begin(nominal);
        let reference = (!asked.corrects_gear()).then_some(nominal);
        let tau = asked.tau_of(time);
        self.filters.0 = tau;
        self.master.take(measured, (tau, nominal), reference, asked.ratio);
    }

    /// Adds a mark of the slave at that distance from the one before (inc).
    pub fn take_slave(&mut self, measured: f64, asked: &LawInputs<'_>) {
        let (time, nominal) = (asked.marks.slave_filter_time as f64, asked.marks.slave_distance as f64);
        if time > 0.0 && nominal > 0.0 && asked.distance().is_some() {
            self.slave.begin(nominal);
            self.slave.take(measured, (asked.tau_of(time), nominal), None, 1.0);
        }
    }

    /// Sets the start condition: its whole error (inc of the slave), which is split over SYNCOFFTIME. Without a filter
    /// it is included in the normal correction.
    pub fn start(&mut self, total: f64, asked: &LawInputs<'_>) {
        let total = if asked.filter_time().is_some() { asked.bound(total) } else { 0.0 };
        (self.start_left, self.start_step) = (total, total / asked.marks_in_offset_time());
    }

    /// Returns KORREKTUR of a pair with error `error` (inc of the slave), without corrections that are commanded but
    /// not moved yet.
    pub fn correct(&mut self, error: f64, asked: &LawInputs<'_>) -> f64 {
        let slave_tau = asked.tau_of(asked.marks.slave_filter_time as f64);
        let slave_jitter = if asked.marks.slave_filter_time > 0 { self.slave.jitter(slave_tau) } else { 0.0 };
        let Some(time) = asked.filter_time() else {
            // A filter that was switched off keeps no state.
            (self.correction, self.start_left, self.start_step) = (0.0, 0.0, 0.0);
            self.filters = (0.0, 0.0);
            return asked.bound(error + slave_jitter);
        };
        let tau = asked.tau_of(time);
        let jitter = self.master.jitter(tau);
        let jitter = if asked.has(option::NO_AVERAGE) { 0.0 } else { jitter };
        let error = asked.bound(error - self.start_left - jitter + slave_jitter);
        let slowness = if asked.has(option::OWN_FILTER) { tau } else { asked.marks_in_offset_time() };
        self.filters = (tau, slowness);
        self.correction = pt1(self.correction, error, slowness);
        // The last step is the rest.
        let step = if self.start_step.abs() >= self.start_left.abs() { self.start_left } else { self.start_step };
        self.start_left -= step;
        asked.bound(self.correction + step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Marks every 500 inc at 10 inc per ms, filtered over 2000 ms, corrected in 1000 ms.
    fn sync() -> Synchronization {
        Synchronization { mark_distance: 500, offset_time: 1_000, ..Synchronization::default() }
    }

    fn marks() -> Marks {
        Marks { filter_time: 2_000, ..Marks::default() }
    }

    fn asked<'p>(sync: &'p Synchronization, marks: &'p Marks) -> LawInputs<'p> {
        LawInputs { sync, marks, speed: 10.0, ratio: 1.0 }
    }

    fn near(value: f64, expected: f64) {
        assert!((value - expected).abs() <= expected.abs() * 1e-6 + 1e-9, "{value} is not {expected}");
    }

    /// 10 * 2000 / 1500; constant 2000 / 300; never below 1.
    ///
    /// Proves: MACS-MARK-09
    #[test]
    fn the_filter_of_marks() {
        let (sync, dynamic, constant) = (sync(), marks(), Marks { options: 1, ..marks() });
        near(asked(&sync, &dynamic).tau_of(2_000.0), 13.333_333_333);
        near(asked(&sync, &constant).tau_of(2_000.0), 6.666_666_667);
        near(LawInputs { speed: 0.01, ..asked(&sync, &dynamic) }.tau_of(2_000.0), 1.0);
        near(asked(&sync, &constant).tau_of(150.0), 1.0);
    }

    /// Start 500, marks at 506: tau 100 / 3.
    ///
    /// Proves: MACS-MARK-10, MACS-MARK-11, MACS-O-45
    #[test]
    fn distances_are_averaged_over_a_hundred_marks_at_least() {
        let (sync, marks) = (sync(), marks());
        let asked = asked(&sync, &marks);
        let mut law = Law::default();
        near(law.distance(&asked), 500.0);
        law.take_master(506.0, &asked);
        near(law.distance(&asked), 500.18);
        near(law.gear_correction(&asked), -0.000_359_870_5);
        law.take_master(506.0, &asked);
        near(law.distance(&asked), 500.3546);
        near(law.gear_correction(&asked), -0.000_708_697_4);
    }

    /// Proves: MACS-MARK-11, MACS-MARK-08, MACS-O-46
    #[test]
    fn the_gear_is_corrected_by_the_average() {
        let sync = sync();
        for (distance, expected) in [(505.0, -0.009_900_990_1), (495.0, 0.010_101_010_1)] {
            let law = Law { master: Average { distance, ..Average::default() }, ..Law::default() };
            near(law.gear_correction(&asked(&sync, &marks())), expected);
            for off in
                [Marks { options: 2, ..marks() }, Marks { options: 16, ..marks() }, Marks { filter_time: 0, ..marks() }]
            {
                assert_eq!(law.gear_correction(&asked(&sync, &off)), 0.0);
            }
        }
    }

    /// 20 marks pass in 1000 ms: 200 inc are 10 per mark, and the last one gets the rest.
    ///
    /// Proves: MACS-MARK-12
    #[test]
    fn the_start_is_split() {
        let (sync, marks) = (sync(), marks());
        let asked = asked(&sync, &marks);
        let mut law = Law::default();
        law.start(205.0, &asked);
        let mut left = 205.0;
        for _ in 0..20 {
            // Only the start has an error.
            near(law.correct(left, &asked), 10.25);
            left -= 10.25;
        }
        near(law.correct(0.0, &asked), 0.0);
        // Without a time all of it is corrected at once.
        let at_once = Synchronization { offset_time: 0, ..sync };
        law.start(205.0, &LawInputs { sync: &at_once, ..asked });
        near(law.correct(205.0, &LawInputs { sync: &at_once, ..asked }), 205.0);
    }

    /// Proves: MACS-MARK-13, MACS-MARK-08, MACS-O-48
    #[test]
    fn an_error_is_filtered() {
        let sync = sync();
        near(Law::default().correct(50.0, &asked(&sync, &marks())), 2.5);
        near(Law::default().correct(50.0, &asked(&sync, &Marks { options: 4, ..marks() })), 3.75);
        // Without a filter the error is corrected unchanged.
        near(Law::default().correct(50.0, &asked(&sync, &Marks { filter_time: 0, ..marks() })), 50.0);
        near(Law::default().correct(50.0, &asked(&sync, &Marks { filter_time: -5, ..marks() })), 50.0);
    }

    /// A mark that is 15 inc late makes the pair appear 15 inc wrong; the filter of marks leaves 15 / tau of it.
    ///
    /// Proves: MACS-MARK-13, MACS-MARK-08
    #[test]
    fn jitter_of_one_mark_is_no_error() {
        let sync = sync();
        let (dynamic, raw) = (marks(), Marks { options: 16, ..marks() });
        for (marks, error) in [(&dynamic, -15.0 / 13.333_333_333), (&raw, -15.0)] {
            let asked = asked(&sync, marks);
            let mut law = Law::default();
            law.take_master(515.0, &asked);
            near(law.correct(-15.0, &asked), error / 20.0);
        }
    }

    /// The same for master and slave that count down, and for a negative ratio: there a late mark of the master leaves
    /// 15 inc more.
    ///
    /// Proves: MACS-MARK-13
    #[test]
    fn a_side_that_goes_backwards_trembles_the_other_way_round() {
        let (sync, marks) = (sync(), marks());
        for (ratio, distance, error) in [(1.0, -515.0, 15.0), (-1.0, 515.0, 15.0), (-1.0, -515.0, -15.0)] {
            let asked = LawInputs { ratio, ..asked(&sync, &marks) };
            let mut law = Law::default();
            law.take_master(distance, &asked);
            near(law.correct(error, &asked), error / 13.333_333_333 / 20.0);
        }
    }

    /// 13.33 and 20 marks of a filter; 15 inc too far are -15 inc, of which the filter takes 1 / 13.33; of the start 20
    /// parts in 20 pairs.
    ///
    /// Proves: MACS-MARK-09, MACS-MARK-12, MACS-MARK-13
    #[test]
    fn values_of_the_filters_are_those_of_the_last_mark_and_pair() {
        let (sync, marks) = (sync(), marks());
        let asked = asked(&sync, &marks);
        let shown =
            |law: &Law| [law.filter(), law.correction_filter(), law.remaining_start_correction(), law.distance_error()];
        let mut law = Law::default();
        assert_eq!(shown(&law), [0.0; 4]);
        law.take_master(515.0, &asked);
        near(law.filter(), 13.333_333_333);
        law.start(205.0, &asked);
        near(law.remaining_start_correction(), 205.0);
        law.correct(205.0, &asked);
        for (value, expected) in
            shown(&law).into_iter().zip([13.333_333_333, 20.0, 205.0 * 0.95, -15.0 / 13.333_333_333])
        {
            near(value, expected);
        }
        let own = Marks { options: 4, ..marks };
        law.correct(0.0, &LawInputs { marks: &own, ..asked });
        near(law.correction_filter(), 13.333_333_333);
        // A filter that was switched off keeps no state.
        let off = Marks { filter_time: 0, ..marks };
        law.correct(0.0, &LawInputs { marks: &off, ..asked });
        assert_eq!(shown(&law), [0.0; 4]);
    }

    /// Bouncing edges, and distances over missed marks, are not between successive marks.
    ///
    /// Proves: MACS-MARK-10
    #[test]
    fn invalid_distance_is_not_averaged() {
        let (sync, marks) = (sync(), marks());
        let asked = asked(&sync, &marks);
        let mut law = Law::default();
        for distance in [1.0, 0.0, 1_000.0, 249.0, 751.0, f64::NAN] {
            law.take_master(distance, &asked);
        }
        near(law.distance(&asked), 500.0);
        law.take_master(749.0, &asked);
        assert!(law.distance(&asked) > 500.0);
    }

    /// The same for a mark of the slave, with opposite sign.
    ///
    /// Proves: MACS-MARK-19
    #[test]
    fn jitter_of_a_slave_mark_is_no_error() {
        let sync = sync();
        let marks = Marks { slave_distance: 300, slave_filter_time: 2_000, filter_time: 0, ..Marks::default() };
        let asked = asked(&sync, &marks);
        let mut law = Law::default();
        law.take_slave(315.0, &asked);
        near(law.correct(15.0, &asked), 15.0 / 13.333_333_333);
        let none = Marks { slave_filter_time: 0, ..marks };
        let mut law = Law::default();
        law.take_slave(315.0, &LawInputs { marks: &none, ..asked });
        near(law.correct(15.0, &LawInputs { marks: &none, ..asked }), 15.0);
    }

    /// Proves: MACS-MARK-18, MACS-O-50
    #[test]
    fn corrections_have_a_bound() {
        let sync = sync();
        for (largest, expected) in [(20, [20.0, -20.0]), (0, [50.0, -50.0]), (-1, [0.0, 0.0])] {
            let marks = Marks { largest, ..Marks::default() };
            let corrected = [50.0, -50.0].map(|error| Law::default().correct(error, &asked(&sync, &marks)));
            assert_eq!(corrected, expected, "{largest}");
        }
        // The total of the start, too: the rest is a normal error, with the same bound before its filter.
        let marks = Marks { largest: 40, ..marks() };
        let asked = asked(&sync, &marks);
        let mut law = Law::default();
        law.start(-200.0, &asked);
        near(law.correct(-200.0, &asked), -2.0 - 40.0 / 20.0);
        // The sum of both, too.
        let at_once = Synchronization { offset_time: 0, ..sync };
        let asked = LawInputs { sync: &at_once, ..asked };
        let mut law = Law::default();
        law.start(-200.0, &asked);
        near(law.correct(-200.0, &asked), -40.0);
        let none = Marks { largest: -1, ..marks };
        let law = Law { master: Average { distance: 505.0, ..Average::default() }, ..Law::default() };
        assert_eq!(law.gear_correction(&LawInputs { marks: &none, ..asked }), 0.0);
    }

    /// With a distance of 0 there is neither a filter nor a time.
    ///
    /// Proves: MACS-MARK-03
    #[test]
    fn without_a_distance_there_is_no_time() {
        let sync = Synchronization { mark_distance: 0, ..sync() };
        let marks = marks();
        let asked = asked(&sync, &marks);
        let mut law = Law::default();
        law.take_master(506.0, &asked);
        law.start(50.0, &asked);
        assert_eq!((law.correct(50.0, &asked), law.gear_correction(&asked)), (50.0, 0.0));
    }
}

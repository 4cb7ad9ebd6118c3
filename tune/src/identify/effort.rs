//! Identification of a drive with effort interface: acceleration, frictions, load, delay, and a resonance if there is
//! one.

use super::fit::{Fit, InitialState, Stretches, minimize};
use super::{Deviation, Identified, MAX_RESONANCE_RATIO, Refusal, Squares};
use crate::discrete::Delayed;
use crate::model::{Dynamics, Model, Resonance, first_order, second_order};
use crate::record::Record;
use core::f64::consts::TAU;
use core::ops::Range;

/// Maximum length of a stretch (s): the position depends on its initial state for at most that time.
const STRETCH: f64 = 0.2;

/// Minimum length of a stretch (cycles).
const LEAST_STRETCH: usize = 24;

/// Half of the window in which the direction of motion is evaluated (s), and its minimum (cycles).
const SENSE: (f64, usize) = (0.01, 4);

/// Distance in that window from which on the direction is known (inc).
const DIRECTION_DISTANCE: f64 = 3.0;

/// Distance in two cycles from which on hesitation is detected (inc), and the fraction of it below which an axis
/// hesitates.
const HESITATES: (f64, f64) = (4.0, 0.25);

/// Maximum delay of the search (cycles).
const MOST_DELAY: f64 = 20.0;

/// Initial dampings of the search for a resonance.
const DAMPINGS: [f64; 2] = [0.02, 0.1];

/// Initial frequencies of that search, per octave.
const PER_OCTAVE: f64 = 8.0;

struct Search<'a> {
    record: &'a Record,
    way: Vec<f64>,
    /// Stretches without a resonance.
    stretches: Stretches,
    /// Columns of viscous friction, Coulomb friction and the load.
    resisting: [Vec<f64>; 3],
}

/// Returns the direction of motion in each cycle; 0 if it is unknown.
fn directions(record: &Record, way: &[f64]) -> Vec<f64> {
    let reach = ((SENSE.0 / record.cycle) as usize).max(SENSE.1);
    let sense = |k: usize| {
        let (Some(before), Some(after)) = (k.checked_sub(reach).and_then(|k| way.get(k)), way.get(k + reach)) else {
            return 0.0;
        };
        let moved = after - before;
        // A motor on a spring may rest for a moment, or reverse, while the whole axis continues.
        let (Some(last), Some(next)) = (k.checked_sub(1).and_then(|k| way.get(k)), way.get(k + 1)) else { return 0.0 };
        let (usual, here) = (moved.abs() / reach as f64, moved.signum() * (next - last));
        let hesitates = usual >= HESITATES.0 && here < HESITATES.1 * usual;
        if moved.abs() < DIRECTION_DISTANCE || hesitates { 0.0 } else { moved.signum() }
    };
    let rough: Vec<f64> = (0..way.len()).map(sense).collect();
    // Near a reversal the window contains both directions.
    let is_sure = |k: usize| {
        let from = k.saturating_sub(reach);
        rough.get(from..=k + reach).is_some_and(|near| near.iter().all(|s| *s == rough[k]))
    };
    (0..way.len()).map(|k| if is_sure(k) { rough[k] } else { 0.0 }).collect()
}

/// Returns stretches with one known direction, none longer than `longest`.
fn stretches_of_one_direction(senses: &[f64], longest: usize) -> Vec<Range<usize>> {
    let mut ranges = Vec::new();
    let mut from = 0;
    for k in 0..=senses.len() {
        let goes_on = k < senses.len() && senses[k] == senses[from] && k - from < longest;
        if goes_on {
            continue;
        }
        if senses.get(from).is_some_and(|s| *s != 0.0) && k - from >= LEAST_STRETCH {
            ranges.push(from..k);
        }
        from = k;
    }
    ranges
}

impl<'a> Search<'a> {
    fn new(record: &'a Record) -> Self {
        let (cycle, way) = (record.cycle, record.relative_positions());
        let mut senses = directions(record, &way);
        let longest =
            ((STRETCH / cycle) as usize).clamp(2 * LEAST_STRETCH, record.positions.len().max(2 * LEAST_STRETCH));
        let mut ranges = stretches_of_one_direction(&senses, longest);
        if ranges.is_empty() {
            // The motion is too short for its friction: only its reaction and direction can be checked.
            ranges.push(0..record.positions.len());
            senses.fill(0.0);
        }
        let stretches = Stretches::new(ranges, InitialState::Motion, &way);
        let mean = way.iter().sum::<f64>() / way.len() as f64;
        let mut sum = 0.0;
        let passed: Vec<f64> = way
            .windows(2)
            .map(|pair| {
                sum += 0.5 * (pair[0] + pair[1] - 2.0 * mean) * cycle;
                -sum
            })
            .collect();
        let passed: Vec<f64> = core::iter::once(0.0).chain(passed).collect();
        // A constant that acts over a whole stretch: the time at which it began is part of the initial state of the
        // stretch.
        let square = |k: usize| -0.5 * (k as f64 * cycle) * (k as f64 * cycle);
        let load: Vec<f64> = (0..way.len()).map(square).collect();
        let coulomb: Vec<f64> = load.iter().zip(&senses).map(|(x, s)| x * s).collect();
        let resisting = [passed, coulomb, load];
        Self { record, way, stretches, resisting }
    }

    fn delay(&self, at: f64) -> f64 {
        at.abs().min(MOST_DELAY) * self.record.cycle
    }

    /// Returns frequency (rad/s) and damping of a search point, which contains their logarithms.
    fn resonance(&self, at: &[f64]) -> (f64, f64) {
        let most = 0.95 * core::f64::consts::PI / self.record.cycle;
        (libm::exp(at[1]).min(most), libm::exp(at[2]).clamp(1e-4, 0.9))
    }

    /// Returns the columns of acceleration, viscous and Coulomb friction, load, and with three coordinates of the
    /// resonance.
    fn columns(&self, at: &[f64]) -> Vec<Vec<f64>> {
        let of = |system| Delayed::of(&system, self.record.cycle, self.delay(at[0])).response(self.record.inputs());
        let mut columns = vec![of(first_order(1.0, 0.0))];
        columns.extend(self.resisting.iter().cloned());
        if at.len() > 1 {
            let (omega, damping) = self.resonance(at);
            columns.push(of(second_order(omega, damping)));
        }
        columns
    }

    /// Returns stretches whose initial state includes an oscillation.
    fn stretches(&self, at: &[f64]) -> Stretches {
        let beginning = if at.len() > 1 {
            let (omega, damping) = self.resonance(at);
            InitialState::Oscillation(omega * self.record.cycle, damping)
        } else {
            InitialState::Motion
        };
        self.stretches.beginning_with(beginning, &self.way)
    }

    fn fit(&self, at: &[f64]) -> Fit {
        if at.len() > 1 {
            Self::fitted(&self.stretches(at), &self.columns(at))
        } else {
            Self::fitted(&self.stretches, &self.columns(at))
        }
    }

    fn fitted(stretches: &Stretches, columns: &[Vec<f64>]) -> Fit {
        stretches.fit(&columns.iter().map(|column| stretches.reduced(column)).collect::<Vec<_>>())
    }

    fn without_resonance(&self) -> (Vec<f64>, f64) {
        let mut best = (vec![0.0], f64::INFINITY);
        for half in 0..(2.0 * MOST_DELAY) as u32 {
            let at = vec![0.5 * f64::from(half)];
            let left = self.fit(&at).residual_squares;
            if left < best.1 {
                best = (at, left);
            }
        }
        minimize(&best.0, &[0.3], 25, |at| self.fit(at).residual_squares)
    }

    /// Searches from the delay of a rigid axis: half of a resonance may appear as delay.
    fn with_resonance(&self, delay: f64) -> (Vec<f64>, f64) {
        let cycle = self.record.cycle;
        let (low, high) = (4.0 / STRETCH.min(self.stretches.len() as f64 * cycle), 0.4 / cycle);
        let steps = (libm::log2(high / low).max(0.0) * PER_OCTAVE) as u32;
        let mut best = (vec![delay, 0.0, 0.0], f64::INFINITY);
        for step in 0..=steps {
            let omega = libm::log(TAU * low * libm::exp2(f64::from(step) / PER_OCTAVE));
            for damping in DAMPINGS {
                let at = vec![delay, omega, libm::log(damping)];
                let left = self.fit(&at).residual_squares;
                if left < best.1 {
                    best = (at, left);
                }
            }
        }
        // Twice, because a simplex may collapse before it reaches the minimum.
        let (at, _) = minimize(&best.0, &[0.3, 0.05, 0.5], 70, |at| self.fit(at).residual_squares);
        minimize(&at, &[-0.2, 0.02, 0.2], 50, |at| self.fit(at).residual_squares)
    }

    /// Returns the change of the residual per coordinate of the search: delay (s), frequency (Hz), damping.
    fn slopes(&self, at: &[f64], fit: &Fit) -> Vec<Vec<f64>> {
        let step = 1e-3;
        let predicted = |at: &[f64]| {
            let mut sum = vec![0.0; self.way.len()];
            for (column, figure) in self.columns(at).iter().zip(&fit.figures) {
                sum.iter_mut().zip(column).for_each(|(sum, x)| *sum += figure * x);
            }
            sum
        };
        let here = predicted(at);
        let (omega, damping) = if at.len() > 1 { self.resonance(at) } else { (1.0, 1.0) };
        let per = [self.record.cycle, omega / TAU, damping];
        (0..at.len())
            .map(|place| {
                let mut far = at.to_vec();
                // The delay is a magnitude.
                far[place] = if place == 0 { far[place].abs() } else { far[place] } + step;
                predicted(&far).iter().zip(&here).map(|(f, h)| (f - h) / (step * per[place])).collect()
            })
            .collect()
    }
}

pub(super) fn identify(record: &Record) -> Result<Identified, Refusal> {
    let search = Search::new(record);
    let (rigid, rigid_left) = search.without_resonance();
    let mut at = rigid;
    let (swinging, left) = search.with_resonance(at[0]);
    let found = search.fit(&swinging);
    let ratio = found.figures[4] / found.figures[0];
    // A ratio outside this range does not come from two masses.
    let has_resonance =
        left < MAX_RESONANCE_RATIO * rigid_left && found.figures[0] > 0.0 && (0.02..1000.0).contains(&ratio);
    if has_resonance {
        at = swinging;
    }
    let fit = search.fit(&at);
    let acceleration = fit.figures[0];
    let stretches = search.stretches(&at);
    let without = Search::fitted(&stretches, &search.resisting).residual_squares;
    let squares = Squares { whole: stretches.whole(), without, left: fit.residual_squares };
    let (explained, nrmse) = squares.judge(acceleration, "inc/s^2")?;
    let mut columns = search.columns(&at);
    columns.extend(search.slopes(&at, &fit));
    let columns: Vec<_> = columns.iter().map(|column| stretches.reduced(column)).collect();
    let sd = stretches.deviations(&columns, &fit);
    let of = |column: usize| sd.get(column).copied().unwrap_or(0.0);
    let resonance = has_resonance.then(|| {
        let (omega, damping) = search.resonance(&at);
        Resonance { frequency: omega / TAU, damping, inertia_ratio: ratio }
    });
    let nothing_below = |figure: f64| figure.max(0.0);
    let dynamics = Dynamics::Effort {
        acceleration,
        viscous: nothing_below(fit.figures[1]),
        coulomb: nothing_below(fit.figures[2]),
        load: fit.figures[3],
        resonance,
    };
    let model = Model { cycle: record.cycle, delay: search.delay(at[0]), dynamics };
    model.check()?;
    let mut deviation = Deviation {
        gain: of(0),
        viscous: of(1),
        coulomb: of(2),
        load: of(3),
        delay: of(if has_resonance { 5 } else { 4 }),
        ..Deviation::default()
    };
    if has_resonance {
        deviation.frequency = of(6);
        deviation.damping = of(7);
        deviation.inertia_ratio = (of(4) / acceleration).max(ratio * of(0) / acceleration);
    }
    Ok(Identified { model, deviation, explained, nrmse })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Takes;

    fn record(way: impl Fn(f64) -> f64) -> Record {
        let mut record = Record::with_capacity(1e-3, Takes::Effort, 400);
        for k in 0..400 {
            record.push(0.1, way(f64::from(k)).floor() as i64);
        }
        record
    }

    fn of(way: impl Fn(f64) -> f64) -> Vec<f64> {
        let record = record(way);
        directions(&record, &record.relative_positions())
    }

    /// Up to 200, then down; 20 cycles around the reversal and at both ends are unknown.
    #[test]
    fn a_sense_is_known_away_from_its_turns() {
        let senses = of(|k| 20.0 * k.min(400.0 - k));
        for (k, sense) in senses.iter().enumerate() {
            match k {
                22..=170 => assert_eq!(*sense, 1.0, "{k}"),
                230..=376 => assert_eq!(*sense, -1.0, "{k}"),
                190..=210 => assert_eq!(*sense, 0.0, "{k}"),
                _ => {}
            }
        }
        assert_eq!(
            stretches_of_one_direction(&senses, 100)
                .iter()
                .map(|range| range.len().min(99))
                .filter(|n| *n == 99)
                .count(),
            2
        );
        assert!(of(|_| 0.0).iter().all(|sense| *sense == 0.0));
    }

    /// A coarse encoder counts only once in many cycles, but the motion continues.
    #[test]
    fn a_coarse_encoder_does_not_hesitate() {
        assert!(of(|k| 0.3 * k)[30..370].iter().all(|sense| *sense == 1.0));
    }

    /// The axis moves at 20 inc per cycle, but the motor oscillates with the same amplitude and rests for a moment in
    /// each period.
    #[test]
    fn a_motor_that_swings_hesitates() {
        let senses = of(|k| 20.0 * k + 60.0 * libm::sin(k / 3.0));
        assert!(senses[30..370].contains(&0.0));
        // An oscillation of half that amplitude never rests.
        assert!(of(|k| 20.0 * k + 25.0 * libm::sin(k / 3.0))[30..370].iter().all(|sense| *sense == 1.0));
    }
}

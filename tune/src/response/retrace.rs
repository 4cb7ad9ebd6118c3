//! A record as its model would have moved.
//!
//! Law      stretch by stretch the model gets what acted on the axis; place and velocity at the beginning of a stretch are those with which
//!          it comes nearest to what was measured, by least squares
//! Reads    a model, a record
//! Writes   a position for each cycle of the record (inc)
//! Refuses  models and records that are none; a model that is too far from its record ([`check_fit`])
//!
//! A stretch is short: what friction does at a turn, and what pushes from elsewhere, adds up in a position without an end.

use super::time::Plant;
use crate::identify::Refusal;
use crate::model::{Model, Takes};
use crate::record::Record;
use core::ops::Range;

/// Longest stretch (s), shortest one (cycles).
const STRETCH: (f64, usize) = (0.5, 32);

/// Steps towards the nearest beginning.
const STEPS: u32 = 4;

/// Positions of the model for each cycle of a record, since its first position (inc).
///
/// # Errors
/// A model or a record that is none.
pub fn retrace(model: &Model, record: &Record) -> Result<Vec<f64>, Refusal> {
    record.check()?;
    model.check()?;
    let trial = Trial { model, inputs: record.inputs(), way: record.way() };
    let longest = ((STRETCH.0 / record.cycle) as usize).max(STRETCH.1);
    let count = trial.way.len();
    let mut found = Vec::with_capacity(count);
    let mut from = 0;
    while from < count {
        // A rest that is too short for a stretch of its own belongs to the one before it.
        let to = if count - from < longest + STRETCH.1 { count } else { from + longest };
        found.extend(trial.nearest(from..to));
        from = to;
    }
    Ok(found)
}

/// What may be left at the median: of the way from the lowest to the highest position, and inc.
///
/// An encoder that rounds leaves a quarter of an increment. Play leaves its own size around the turns of the motor, more often than turns are:
/// within it the motor is alone, and ahead of a model that carries the load. A drive of velocities carries its motor through play by its own
/// loop, which is of more than the first order: ten times as much is left of it.
const LEFT: (f64, f64) = (1e-4, 1.0);
const LEFT_OF_VELOCITY: f64 = 1e-3;

/// Is the model near enough to the record for gains that follow from it?
///
/// What is explained of a motion of many turns says little of some increments, which are all that a loop sees at rest. The median counts:
/// a stiction that is no Coulomb friction shows at turns alone.
///
/// # Errors
/// [`Refusal::Misfit`]; a model or a record that is none.
pub fn check_fit(model: &Model, record: &Record) -> Result<(), Refusal> {
    let (found, way) = (retrace(model, record)?, record.way());
    let mut left: Vec<f64> = way.iter().zip(&found).map(|(way, found)| (way - found).abs()).collect();
    left.sort_by(f64::total_cmp);
    let left = left.get(left.len() / 2).copied().unwrap_or(0.0);
    let (low, high) = way.iter().fold((0.0_f64, 0.0_f64), |(low, high), way| (low.min(*way), high.max(*way)));
    let part = if model.takes() == Takes::Velocity { LEFT_OF_VELOCITY } else { LEFT.0 };
    let most = (part * (high - low)).max(LEFT.1);
    if left <= most { Ok(()) } else { Err(Refusal::Misfit { left, most }) }
}

struct Trial<'a> {
    model: &'a Model,
    inputs: &'a [f64],
    way: Vec<f64>,
}

impl Trial<'_> {
    fn nearest(&self, range: Range<usize>) -> Vec<f64> {
        let way = self.way.get(range.clone()).unwrap_or_default();
        let cycle = self.model.cycle;
        let reach = 4.min(way.len().saturating_sub(1));
        let mut place = way.first().copied().unwrap_or(0.0);
        let mut velocity =
            if reach == 0 || range.start == 0 { 0.0 } else { (way[reach] - place) / (reach as f64 * cycle) };
        let mut best = self.run(range.clone(), place, velocity);
        let mut left = squares(way, &best);
        // One increment in a cycle.
        let nudge = 1.0 / cycle;
        for _ in 0..STEPS {
            let other = self.run(range.clone(), place, velocity + nudge);
            let (by_place, by_velocity) = correction(way, &best, &other);
            let (place_then, velocity_then) = (place + by_place, velocity + by_velocity * nudge);
            let then = self.run(range.clone(), place_then, velocity_then);
            let left_then = squares(way, &then);
            // Friction has corners, at which a step may lead astray.
            if left_then >= left {
                break;
            }
            (place, velocity, best, left) = (place_then, velocity_then, then, left_then);
        }
        best
    }

    /// The model from there on.
    fn run(&self, range: Range<usize>, place: f64, velocity: f64) -> Vec<f64> {
        let mut plant = Plant::new(self.model);
        let before = |back: usize| range.start.checked_sub(back + 1).and_then(|at| self.inputs.get(at)).copied();
        for (back, past) in plant.past.iter_mut().enumerate() {
            *past = before(back).unwrap_or(0.0);
        }
        plant.state[0] = place;
        // Of the motor, and of a load behind a spring.
        for of in [1, 3] {
            if let Some(state) = plant.state.get_mut(of) {
                *state = velocity;
            }
        }
        let inputs = self.inputs.get(range).unwrap_or_default();
        inputs
            .iter()
            .map(|input| {
                let position = plant.state[0];
                plant.cycle(*input);
                position
            })
            .collect()
    }
}

fn squares(way: &[f64], found: &[f64]) -> f64 {
    way.iter().zip(found).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// By how much place and velocity (in nudges) are to change; `other` is `found` with one nudge more.
fn correction(way: &[f64], found: &[f64], other: &[f64]) -> (f64, f64) {
    let (mut n, mut s, mut ss, mut e, mut es) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for ((way, found), other) in way.iter().zip(found).zip(other) {
        let (slope, error) = (other - found, way - found);
        n += 1.0;
        s += slope;
        ss += slope * slope;
        e += error;
        es += error * slope;
    }
    let whole = n * ss - s * s;
    // A model without a velocity of its own has one place to choose.
    if whole <= 1e-9 * n * ss || ss == 0.0 {
        return (e / n, 0.0);
    }
    ((e * ss - es * s) / whole, (n * es - s * e) / whole)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::Delayed;
    use crate::model::{Dynamics, Takes};

    fn model(gain: f64) -> Model {
        let dynamics = Dynamics::Velocity { gain, time_constant: 0.006, offset: 0.0 };
        Model { cycle: 1e-3, delay: 1.4e-3, dynamics }
    }

    /// Counted positions of the exact system, for commands that change every 40 cycles.
    fn record() -> Record {
        let mut record = Record::with_capacity(1e-3, Takes::Velocity, 2000);
        let commands: Vec<f64> = (0..2000).map(|k| if (k / 40 * 7) % 5 < 2 { 0.4 } else { -0.3 }).collect();
        let places = Delayed::of(&model(5e4).continuous(), 1e-3, 1.4e-3).response(&commands);
        for (command, place) in commands.iter().zip(places) {
            record.push(*command, 1_000_000 + place.floor() as i64);
        }
        record
    }

    #[test]
    fn the_true_model_is_within_the_rounding_everywhere() {
        let record = record();
        let found = retrace(&model(5e4), &record).unwrap();
        assert_eq!(found.len(), 2000);
        for (k, (found, way)) in found.iter().zip(record.way()).enumerate() {
            assert!((found - way).abs() < 1.0, "{k}: {found} {way}");
        }
    }

    /// A gain that is a fifth too large leaves what it adds within a stretch.
    #[test]
    fn a_wrong_model_shows() {
        let record = record();
        let found = retrace(&model(6e4), &record).unwrap();
        let most = found.iter().zip(record.way()).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        assert!((50.0..2000.0).contains(&most), "{most}");
        assert_eq!(check_fit(&model(5e4), &record), Ok(()));
        assert!(matches!(check_fit(&model(6e4), &record), Err(Refusal::Misfit { .. })));
    }

    #[test]
    fn a_record_that_is_none_is_refused() {
        let mut record = record();
        record.positions.pop();
        assert!(matches!(retrace(&model(5e4), &record), Err(Refusal::Uneven { .. })));
        let record = Record::with_capacity(1e-3, Takes::Velocity, 0);
        assert!(matches!(retrace(&model(5e4), &record), Err(Refusal::Short { cycles: 0, .. })));
    }
}

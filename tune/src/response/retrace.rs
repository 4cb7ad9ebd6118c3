//! Motion of a model for the inputs of a record.
//!
//! Law      the model gets the inputs of the axis in one stretch after the other; its position and velocity at the
//!          beginning of a stretch are those of the best fit to the measurement, by least squares
//! Reads    a model, a record
//! Writes   a position for each cycle of the record (inc)
//! Refuses  invalid models and records; a model that deviates too far from its record ([`check_fit`])
//!
//! A stretch is short, because friction at a reversal and external forces accumulate in a position without limit.

use super::time::Plant;
use crate::identify::Refusal;
use crate::model::{Model, Takes};
use crate::record::Record;
use core::ops::Range;

/// Maximum length of a stretch (s), minimum length (cycles).
const STRETCH: (f64, usize) = (0.5, 32);

/// Iterations towards the best initial state.
const STEPS: u32 = 4;

/// Returns the positions of the model for each cycle of a record, relative to its first position (inc).
///
/// # Errors
/// An invalid model or record.
pub fn retrace(model: &Model, record: &Record) -> Result<Vec<f64>, Refusal> {
    record.check()?;
    model.check()?;
    let trial = Trial { model, inputs: record.inputs(), way: record.relative_positions() };
    let longest = ((STRETCH.0 / record.cycle) as usize).max(STRETCH.1);
    let count = trial.way.len();
    let mut found = Vec::with_capacity(count);
    let mut from = 0;
    while from < count {
        // A remainder that is too short for a stretch belongs to the previous one.
        let to = if count - from < longest + STRETCH.1 { count } else { from + longest };
        found.extend(trial.nearest(from..to));
        from = to;
    }
    Ok(found)
}

/// Maximum median of the deviation: relative to the distance from the lowest to the highest position, and in inc.
///
/// Rounding of the encoder causes a quarter of an increment. Backlash causes its own size around the reversals of the
/// motor, and more often than there are reversals: within it the motor turns alone, and ahead of a model that moves the
/// load. A velocity drive moves its motor through backlash by its own loop, which is of higher than first order: its
/// deviation is ten times as large.
const MAX_MEDIAN: (f64, f64) = (1e-4, 1.0);
const LEFT_OF_VELOCITY: f64 = 1e-3;

/// Checks that the model fits the record well enough for the design of gains.
///
/// The explained part of a motion of many turns says little about single increments, which matter for a loop at rest.
/// The median is used: static friction that differs from Coulomb friction appears at reversals only.
///
/// # Errors
/// [`Refusal::Misfit`]; an invalid model or record.
pub fn check_fit(model: &Model, record: &Record) -> Result<(), Refusal> {
    let (found, way) = (retrace(model, record)?, record.relative_positions());
    let mut left: Vec<f64> = way.iter().zip(&found).map(|(way, found)| (way - found).abs()).collect();
    left.sort_by(f64::total_cmp);
    let left = left.get(left.len() / 2).copied().unwrap_or(0.0);
    let (low, high) = way.iter().fold((0.0_f64, 0.0_f64), |(low, high), way| (low.min(*way), high.max(*way)));
    let part = if model.takes() == Takes::Velocity { LEFT_OF_VELOCITY } else { MAX_MEDIAN.0 };
    let most = (part * (high - low)).max(MAX_MEDIAN.1);
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
        // One increment per cycle.
        let nudge = 1.0 / cycle;
        for _ in 0..STEPS {
            let other = self.run(range.clone(), place, velocity + nudge);
            let (by_place, by_velocity) = correction(way, &best, &other);
            let (place_then, velocity_then) = (place + by_place, velocity + by_velocity * nudge);
            let then = self.run(range.clone(), place_then, velocity_then);
            let left_then = squares(way, &then);
            // Friction has corners, at which a step may increase the deviation.
            if left_then >= left {
                break;
            }
            (place, velocity, best, left) = (place_then, velocity_then, then, left_then);
        }
        best
    }

    /// Runs the model over a stretch from that position and velocity.
    fn run(&self, range: Range<usize>, place: f64, velocity: f64) -> Vec<f64> {
        let mut plant = Plant::new(self.model);
        let before = |back: usize| range.start.checked_sub(back + 1).and_then(|at| self.inputs.get(at)).copied();
        for (back, past) in plant.past.iter_mut().enumerate() {
            *past = before(back).unwrap_or(0.0);
        }
        plant.state[0] = place;
        // Velocity of the motor, and of a load on a spring.
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

/// Returns the changes of position and velocity (in nudges); `other` is `found` with one nudge more.
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
    // For a model without a velocity state only the position can be chosen.
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
        for (k, (found, way)) in found.iter().zip(record.relative_positions()).enumerate() {
            assert!((found - way).abs() < 1.0, "{k}: {found} {way}");
        }
    }

    /// A gain that is a fifth too large causes its deviation within a stretch.
    #[test]
    fn a_wrong_model_shows() {
        let record = record();
        let found = retrace(&model(6e4), &record).unwrap();
        let most = found.iter().zip(record.relative_positions()).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        assert!((50.0..2000.0).contains(&most), "{most}");
        assert_eq!(check_fit(&model(5e4), &record), Ok(()));
        assert!(matches!(check_fit(&model(6e4), &record), Err(Refusal::Misfit { .. })));
    }

    #[test]
    fn invalid_record_is_refused() {
        let mut record = record();
        record.positions.pop();
        assert!(matches!(retrace(&model(5e4), &record), Err(Refusal::Uneven { .. })));
        let record = Record::with_capacity(1e-3, Takes::Velocity, 0);
        assert!(matches!(retrace(&model(5e4), &record), Err(Refusal::Short { cycles: 0, .. })));
    }
}

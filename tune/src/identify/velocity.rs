//! Identification of a velocity drive: gain, offset, time constant, delay.

use super::fit::{Fit, InitialState, Stretches, minimize};
use super::{Deviation, Identified, Refusal, Squares};
use crate::discrete::Delayed;
use crate::model::{Dynamics, Model, first_order};
use crate::record::Record;

/// Maximum length of a stretch (s): deviations of a drive from its model accumulate in the position for at most that
/// time.
const STRETCH: f64 = 0.5;

/// Maximum delay of the search (cycles).
const MOST_DELAY: f64 = 20.0;

struct Search<'a> {
    record: &'a Record,
    stretches: Stretches,
    time: Vec<f64>,
}

impl Search<'_> {
    /// Returns time constant and delay (s) of a search point, which has both in cycles; neither is below 0.
    fn figures(&self, at: &[f64]) -> (f64, f64) {
        let cycle = self.record.cycle;
        (at[0].abs().max(0.02) * cycle, at[1].abs().min(MOST_DELAY) * cycle)
    }

    fn column(&self, at: &[f64]) -> Vec<f64> {
        let (lag, delay) = self.figures(at);
        let unit = Delayed::of(&first_order(1.0 / lag, 1.0 / lag), self.record.cycle, delay);
        self.stretches.reduced(&unit.response(self.record.inputs()))
    }

    fn fit(&self, at: &[f64]) -> Fit {
        self.stretches.fit(&[self.column(at), self.time.clone()])
    }
}

pub(super) fn identify(record: &Record) -> Result<Identified, Refusal> {
    let cycle = record.cycle;
    let longest = ((STRETCH / cycle) as usize).clamp(32, record.positions.len() / 2);
    let count = record.positions.len();
    let ranges = (0..count / longest).map(|i| i * longest..(i + 1) * longest).collect();
    let stretches = Stretches::new(ranges, InitialState::Place, &record.relative_positions());
    let time: Vec<f64> = (0..count).map(|k| k as f64 * cycle).collect();
    let time = stretches.reduced(&time);
    let search = Search { record, stretches, time };
    // Coarse points first: the squares have several local minima.
    let mut best = (vec![1.0, 0.0], f64::INFINITY);
    for lag in [0.1, 1.0, 3.0, 10.0, 30.0, 100.0] {
        for delay in [0.0, 1.0, 2.0, 4.0, 7.0, 11.0, 16.0] {
            let at = vec![lag, delay];
            let left = search.fit(&at).residual_squares;
            if left < best.1 {
                best = (at, left);
            }
        }
    }
    let step = [0.3 * best.0[0], 0.7];
    let (at, _) = minimize(&best.0, &step, 80, |at| search.fit(at).residual_squares);
    let fit = search.fit(&at);
    let squares = Squares {
        whole: search.stretches.whole(),
        without: search.stretches.fit(core::slice::from_ref(&search.time)).residual_squares,
        left: fit.residual_squares,
    };
    let (gain, offset) = (fit.figures[0], fit.figures[1]);
    let (explained, nrmse) = squares.judge(gain, "inc/s")?;
    let (time_constant, delay) = search.figures(&at);
    let slope = |by: [f64; 2]| {
        let (up, down) = ([at[0] + by[0], at[1].abs() + by[1]], [at[0] - by[0], at[1].abs() - by[1]]);
        let reach = 2.0 * (by[0] + by[1]) * cycle;
        let (up, down) = (search.column(&up), search.column(&down));
        up.iter().zip(&down).map(|(u, d)| gain * (u - d) / reach).collect::<Vec<f64>>()
    };
    // A delay near 0 has no values on the other side.
    let columns = [search.column(&at), search.time.clone(), slope([0.01, 0.0]), {
        let (near, far) = (search.column(&at), search.column(&[at[0], at[1].abs() + 0.01]));
        far.iter().zip(&near).map(|(f, n)| gain * (f - n) / (0.01 * cycle)).collect()
    }];
    let sd = search.stretches.deviations(&columns, &fit);
    let model = Model { cycle, delay, dynamics: Dynamics::Velocity { gain, time_constant, offset } };
    model.check()?;
    let deviation =
        Deviation { gain: sd[0], offset: sd[1], time_constant: sd[2], delay: sd[3], ..Deviation::default() };
    Ok(Identified { model, deviation, explained, nrmse })
}

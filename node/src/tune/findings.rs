//! Findings of tuning: the loops of an axis before and after.
//!
//! Law      both sets of loops are evaluated with the identified model: margins from its frequency response; overshoot,
//!          settling and following error from a step and a move that are simulated with the loops of the core
//! Reads    a model, the present loops, the designed loops
//! Writes   figures, curves and gains; nothing that causes motion
//! Refuses  a record without a model ([`Refusal`]). Loops that cannot be evaluated, and missing gains, are messages in
//!          the findings
//!
//! With an inertia ratio, an axis has its whole inertia in contact and only that of its motor within the backlash: the
//! margins are the worse ones of both, while curves, step and move are those in contact.
//!
//! Gains that a design does not determine (BANDWIDTH, KILIMTIME, REGWMIN, REGWMAX) are kept and included in the
//! evaluation.

use lineshaft_core::config::AxisConfig;
use lineshaft_core::parameter::{AxisParameters, Range, Row};
use lineshaft_core::regulator::PidGains;
use lineshaft_tune::{
    Bode, Design, DesignError, DesignSpec, Identified, LoopError, Loops, Margins, Model, Move, PositionLaw, Record,
    Refusal, Trace, bode, check_fit, design, identify, regimes, simulate, velocity_bode,
};
use serde::Serialize;

/// An axis, and the motion with which it is evaluated.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Subject {
    /// Name in the cell.
    pub axis: String,
    /// Name of the axis unit.
    pub unit: String,
    /// Increments per axis unit.
    pub increments: f64,
    /// Distance to the target within which it counts as reached, in inc.
    pub window: f64,
    /// Velocity of the move, in inc/s.
    pub velocity: f64,
    /// Acceleration of the move, in inc/s^2.
    pub acceleration: f64,
}

/// Minimum window, in inc.
const LEAST_WINDOW: f64 = 3.0;

impl Subject {
    /// Returns an axis of a cell, moved like a goal without given rates; its window is `in_position_window`, at least 3
    /// inc.
    pub fn of(axis: &AxisConfig, parameters: &AxisParameters) -> Self {
        Self {
            axis: axis.name.clone(),
            unit: axis.scale.unit().to_string(),
            increments: 1.0 / axis.scale.rate_to_unit(1.0),
            window: (parameters.in_position_window as f64).max(LEAST_WINDOW),
            velocity: parameters.default_velocity.unwrap_or(0.5 * parameters.max_velocity),
            acceleration: parameters.default_acceleration.unwrap_or(0.5 * parameters.max_acceleration),
        }
    }
}

impl Subject {
    /// Returns the distance to the target of a step within which it counts as reached, in inc.
    pub fn step_window(&self, step: &Move) -> f64 {
        self.window.min((STEP_WINDOW * step.distance()).max(1.0))
    }
}

/// A gain, with the key of its parameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Gain {
    /// Key, as in cells, ROS and docs/parameters.md.
    pub key: &'static str,
    /// Present value; `None` if the present loops have no such gain.
    pub old: Option<f64>,
    /// New value.
    pub new: f64,
}

impl Gain {
    /// Returns true if the value changes.
    pub fn changes(&self) -> bool {
        self.old != Some(self.new)
    }

    /// Returns the new value in the format of cells.
    pub fn written(&self) -> String {
        self.new.to_string()
    }
}

/// Behaviour of the axis with given loops.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// The loops.
    pub loops: Loops,
    /// Response of the open and the closed position loop.
    pub position: Bode,
    /// Response of the velocity loop, if there is one.
    pub velocity: Option<Bode>,
    /// Margins of the position loop, the worst of all regimes.
    pub margins: Margins,
    /// Margins of the velocity loop, the worst of all regimes.
    pub velocity_margins: Option<Margins>,
    /// Response to a step of the command.
    pub step: Trace,
    /// Response to a move.
    pub moved: Trace,
}

impl Answer {
    /// Returns true if all loops are stable.
    pub fn is_stable(&self) -> bool {
        self.margins.is_stable() && self.velocity_margins.is_none_or(|margins| margins.is_stable())
    }
}

/// Result of tuning.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Findings {
    /// Axis.
    pub subject: Subject,
    /// Model with its deviations and quality.
    pub identified: Identified,
    /// Whether the record has backlash or another effect that the model lacks.
    pub is_misfit: bool,
    /// Requirements of the design.
    pub wish: DesignSpec,
    /// Step of both responses.
    pub step: Move,
    /// Move of both responses.
    pub to: Move,
    /// Behaviour with the present gains, or the reason why it cannot be evaluated.
    pub before: Result<Answer, String>,
    /// Behaviour with the new gains, or the reason why there are none.
    pub after: Result<Answer, String>,
    /// Gains in the order of the loops, from the position inwards; empty if there are none.
    pub gains: Vec<Gain>,
}

/// Fraction of the full output that a step may require by its proportional gain.
const STEP_OUTPUT: f64 = 0.3;

/// Minimum and maximum step, in inc.
const STEPS: (f64, f64) = (10.0, 1e9);

/// Fraction of a step within which it counts as settled, if `window` is wider.
const STEP_WINDOW: f64 = 0.2;

/// Duration of a step in periods of the crossover, and its limits in s.
const STEP_TIME: (f64, f64, f64) = (15.0, 0.05, 3.0);

/// Time after a move, in s.
const REST: f64 = 0.5;

/// Maximum number of cycles of a move.
const MOST_CYCLES: f64 = 60_000.0;

impl Findings {
    /// Identifies the model of a record and designs gains for it; `before` are the present loops. There are no gains
    /// for a model that deviates too much from its record.
    ///
    /// # Errors
    /// Returns the reason why there is no model.
    pub fn find(subject: Subject, record: &Record, wish: &DesignSpec, before: &Loops) -> Result<Self, Refusal> {
        let identified = identify(record)?;
        let designed = design(&identified.for_design(wish.inertia_ratio), wish);
        let mut found = Self::of(subject, identified, wish, before, designed);
        let misfit = check_fit(&identified.model, record).err();
        found.is_misfit = misfit.is_some();
        // A given inertia ratio describes the backlash between motor and load, so a misfit is expected.
        if let Some(refusal) = misfit.filter(|_| wish.inertia_ratio == 0.0) {
            (found.after, found.gains) = (Err(refusal.to_string()), Vec::new());
        }
        Ok(found)
    }

    /// Creates findings from an existing model and design.
    pub fn of(
        subject: Subject,
        identified: Identified,
        wish: &DesignSpec,
        before: &Loops,
        designed: Result<Design, DesignError>,
    ) -> Self {
        let after = designed.map_err(|error| error.to_string()).and_then(|found| as_set(&found.loops, before));
        let model = identified.for_design(wish.inertia_ratio);
        let trials = Trials::new(&subject, model, wish.inertia_ratio, before, after.as_ref().ok());
        let answer = |loops: &Loops| trials.answer(loops).map_err(|error| error.to_string());
        let gains = after.as_ref().map_or_else(|_| Vec::new(), |after| gains(before, after));
        Self {
            wish: *wish,
            step: trials.step,
            to: trials.to,
            before: answer(before),
            after: after.and_then(|after| answer(&after)),
            gains,
            subject,
            identified,
            is_misfit: false,
        }
    }

    /// Returns the gains that change.
    pub fn changes(&self) -> Vec<Gain> {
        self.gains.iter().filter(|gain| gain.changes()).copied().collect()
    }
}

/// Returns designed loops with the values of parameters: undetermined values are kept, kv has four digits.
fn as_set(designed: &Loops, before: &Loops) -> Result<Loops, String> {
    let position = match (designed.position, before.position) {
        (PositionLaw::Proportional { kv }, _) => PositionLaw::Proportional { kv: servo_gain(kv)? },
        (PositionLaw::Pid { gains, cycles }, PositionLaw::Pid { gains: old, .. }) => {
            let PidGains { limit_time, bandwidth, window, .. } = old;
            PositionLaw::Pid { gains: PidGains { limit_time, bandwidth, window, ..gains }, cycles }
        }
        (position, _) => position,
    };
    Ok(Loops { position, ..*designed })
}

const KV: &str = "position_loop.kv";

/// Rounds down, so that margins only increase, and limits the value to the range of its parameter.
fn servo_gain(kv: f64) -> Result<f64, String> {
    let Some((_, Row { range: Range::Real(least, most), .. })) = Row::find(KV) else { return Ok(kv) };
    let kv = four_digits_down(kv.min(*most));
    if kv >= *least { Ok(kv) } else { Err(format!("{KV} would be {kv} 1/s; {least:.4} to {most:.1} 1/s is permitted")) }
}

fn four_digits_down(value: f64) -> f64 {
    if value <= 0.0 || !value.is_finite() {
        return value;
    }
    let digits = (3 - value.log10().floor() as i32).clamp(0, 9);
    let shift = 10_f64.powi(digits);
    (value * shift * (1.0 + f64::EPSILON)).floor() / shift
}

/// Returns the gains of loops, by the keys of their parameters.
fn values(loops: &Loops) -> Vec<(&'static str, f64)> {
    let mut values = match loops.position {
        PositionLaw::Proportional { kv } => vec![(KV, kv)],
        PositionLaw::Pid { gains, .. } => vec![
            ("kprop", gains.proportional as f64),
            ("kder", gains.derivative as f64),
            ("kint", gains.integral as f64),
            ("kilim", gains.limit as f64),
            ("ffvel", gains.velocity as f64),
            ("ffacc", gains.acceleration as f64),
            ("timer", gains.period_ms as f64),
        ],
    };
    if let Some(inner) = loops.velocity {
        values.extend([
            ("velkprop", f64::from(inner.gains.proportional)),
            ("velkint", f64::from(inner.gains.integral)),
            ("velkilim", f64::from(inner.gains.limit)),
        ]);
    }
    values
}

fn gains(before: &Loops, after: &Loops) -> Vec<Gain> {
    let old = values(before);
    let find = |key: &str| old.iter().find(|(known, _)| *known == key).map(|(_, value)| *value);
    values(after).into_iter().map(|(key, new)| Gain { key, old: find(key), new }).collect()
}

/// Motions with which both sets of loops are evaluated.
struct Trials {
    model: Model,
    inertia_ratio: f64,
    window: f64,
    step_window: f64,
    step: Move,
    step_time: f64,
    to: Move,
}

impl Trials {
    fn new(subject: &Subject, model: Model, inertia_ratio: f64, before: &Loops, after: Option<&Loops>) -> Self {
        let distance = round_down((STEP_OUTPUT / stiffness(after.unwrap_or(before))).clamp(STEPS.0, STEPS.1));
        let crossover = bode(&model, after.unwrap_or(before)).map_or(0.0, |bode| bode.margins.crossover);
        let (periods, least, most) = STEP_TIME;
        let (least, most) = (least.max(100.0 * model.cycle), most.max(200.0 * model.cycle));
        let step_time = (periods / crossover).clamp(least, most);
        // Constant velocity for as long as the acceleration takes.
        let longest = MOST_CYCLES * model.cycle * subject.acceleration / 3.0;
        let velocity = subject.velocity.min(longest);
        let way = 2.0 * velocity * velocity / subject.acceleration;
        let to = Move::Trapezoid { distance: way.max(1.0), velocity, acceleration: subject.acceleration };
        let (step, window) = (Move::Step { distance }, subject.window);
        Self { model, inertia_ratio, window, step_window: subject.step_window(&step), step, step_time, to }
    }

    fn answer(&self, loops: &Loops) -> Result<Answer, LoopError> {
        let model = &self.model;
        let move_time = self.to.duration() + REST.max(100.0 * model.cycle);
        let (position, velocity) = (bode(model, loops)?, velocity_bode(model, loops)?);
        let (mut margins, mut velocity_margins) = (position.margins, velocity.as_ref().map(|bode| bode.margins));
        for other in regimes(model, self.inertia_ratio)?.iter().skip(1) {
            margins = margins.worse(&bode(other, loops)?.margins);
            let inner = velocity_bode(other, loops)?;
            velocity_margins = velocity_margins.zip(inner).map(|(margins, inner)| margins.worse(&inner.margins));
        }
        Ok(Answer {
            loops: *loops,
            position,
            velocity,
            margins,
            velocity_margins,
            step: simulate(model, loops, &self.step, self.step_time, self.step_window)?,
            moved: simulate(model, loops, &self.to, move_time, self.window)?,
        })
    }
}

/// Returns the output for a constant error of one increment, by the proportional gains.
pub(super) fn stiffness(loops: &Loops) -> f64 {
    use lineshaft_core::regulator::{K_OUT, VELOCITY_GAIN};
    let position = match loops.position {
        PositionLaw::Proportional { kv } => kv / loops.max_velocity,
        PositionLaw::Pid { gains, .. } => gains.proportional as f64 / K_OUT,
    };
    position * loops.velocity.map_or(1.0, |inner| f64::from(inner.gains.proportional.abs()) * VELOCITY_GAIN)
}

/// Rounds down to 1, 2 or 5 times a power of ten.
fn round_down(value: f64) -> f64 {
    let power = 10_f64.powi(value.log10().floor() as i32);
    let part = value / power;
    power
        * if part >= 5.0 {
            5.0
        } else if part >= 2.0 {
            2.0
        } else {
            1.0
        }
}

#[cfg(test)]
mod tests;

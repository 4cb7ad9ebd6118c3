//! What tuning has found of an axis, before and after.
//!
//! Law      each side is shown on the model that was found: margins from its frequency response, overshoot, settling and following error from
//!          a step and a move that are simulated with the loops of the core
//! Reads    a model, loops as they are, loops that were designed
//! Writes   figures, curves and gains; nothing that moves
//! Refuses  a record without a model ([`Refusal`]). Loops that cannot be shown, and gains that do not exist, are sentences of the findings
//!
//! With a ratio of inertias an axis has the whole inertia in contact and that of its motor within the play: margins are the worse ones of both,
//! curves, step and move those in contact.
//!
//! What a designed loop says nothing of (BANDWIDTH, KILIMTIME, REGWMIN, REGWMAX) stays as it is, and is part of what is shown.

use lineshaft_core::config::AxisConfig;
use lineshaft_core::parameter::{AxisParameters, Range, Row};
use lineshaft_core::regulator::PidGains;
use lineshaft_tune::{
    Bode, Design, DesignError, Identified, LoopError, Loops, Margins, Model, Move, PositionLaw, Record, Refusal, Trace,
    DesignSpec, bode, check_fit, design, identify, regimes, simulate, velocity_bode,
};
use serde::Serialize;

/// An axis, and what it is moved by to be shown.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Subject {
    /// Its name in the cell.
    pub axis: String,
    /// Name of its unit.
    pub unit: String,
    /// Increments in one of it.
    pub increments: f64,
    /// Way around the target in which it counts as reached (inc).
    pub window: f64,
    /// Of the move (inc/s).
    pub velocity: f64,
    /// Of the move (inc/s^2).
    pub acceleration: f64,
}

/// Least window (inc).
const LEAST_WINDOW: f64 = 3.0;

impl Subject {
    /// An axis of a cell, moved as a goal moves it that gives no rates; its window is `in_position_window`, 3 inc at least.
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
    /// Way around the target of a step in which that counts as reached (inc).
    pub fn step_window(&self, step: &Move) -> f64 {
        self.window.min((STEP_WINDOW * step.distance()).max(1.0))
    }
}

/// A gain, by the key of its parameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Gain {
    /// As cells, ROS and docs/parameters.md have it.
    pub key: &'static str,
    /// As it is; none where the loops that are have no such gain.
    pub old: Option<f64>,
    /// As it was found.
    pub new: f64,
}

impl Gain {
    /// Would it be another one?
    pub fn changes(&self) -> bool {
        self.old != Some(self.new)
    }

    /// The new value as cells write it.
    pub fn written(&self) -> String {
        self.new.to_string()
    }
}

/// How the axis answers with given loops.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// The loops.
    pub loops: Loops,
    /// Response of the open and the closed position loop.
    pub position: Bode,
    /// Of the velocity loop; none where there is none.
    pub velocity: Option<Bode>,
    /// Of the position loop, the worse ones of all regimes.
    pub margins: Margins,
    /// Of the velocity loop, likewise.
    pub velocity_margins: Option<Margins>,
    /// A step of the command.
    pub step: Trace,
    /// A move.
    pub moved: Trace,
}

impl Answer {
    /// Are all loops stable?
    pub fn is_stable(&self) -> bool {
        self.margins.is_stable() && self.velocity_margins.is_none_or(|margins| margins.is_stable())
    }
}

/// What was found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Findings {
    /// Of which axis.
    pub subject: Subject,
    /// The model, its deviations, how much it explains.
    pub identified: Identified,
    /// The record is that of an axis with play, or of another one that the model does not know.
    pub is_misfit: bool,
    /// What was wished.
    pub wish: DesignSpec,
    /// The step of both answers.
    pub step: Move,
    /// The move of both answers.
    pub to: Move,
    /// With the gains as they are, or why that cannot be shown.
    pub before: Result<Answer, String>,
    /// With those that were found, or why there are none.
    pub after: Result<Answer, String>,
    /// In the order of the loops, from the position inwards; empty where there are none.
    pub gains: Vec<Gain>,
}

/// Part of the full output that a step may ask for by its proportional gain.
const STEP_OUTPUT: f64 = 0.3;

/// Least and largest step (inc).
const STEPS: (f64, f64) = (10.0, 1e9);

/// A step counts as settled within this part of it, where `window` is wider.
const STEP_WINDOW: f64 = 0.2;

/// Time of a step in periods of the crossover, and its bounds (s).
const STEP_TIME: (f64, f64, f64) = (15.0, 0.05, 3.0);

/// Time behind a move (s).
const REST: f64 = 0.5;

/// Most cycles of a move.
const MOST_CYCLES: f64 = 60_000.0;

impl Findings {
    /// Finds the model of a record and gains for it; `before` are the loops as they are. There are none for a model that is too far from
    /// its record.
    ///
    /// # Errors
    /// Why there is no model.
    pub fn find(subject: Subject, record: &Record, wish: &DesignSpec, before: &Loops) -> Result<Self, Refusal> {
        let identified = identify(record)?;
        let designed = design(&identified.for_design(wish.inertia_ratio), wish);
        let mut found = Self::of(subject, identified, wish, before, designed);
        let misfit = check_fit(&identified.model, record).err();
        found.is_misfit = misfit.is_some();
        // Whoever tells the ratio says what is between motor and load.
        if let Some(refusal) = misfit.filter(|_| wish.inertia_ratio == 0.0) {
            (found.after, found.gains) = (Err(refusal.to_string()), Vec::new());
        }
        Ok(found)
    }

    /// Of a model and a design that are there.
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

    /// Gains that would be others.
    pub fn changes(&self) -> Vec<Gain> {
        self.gains.iter().filter(|gain| gain.changes()).copied().collect()
    }
}

/// Loops that were designed as the parameters of an axis have them: what the design leaves open stays, kv has four digits.
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

/// Rounded down, so that margins only grow, and within the range of its parameter.
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

/// The gains of loops, by the keys of their parameters.
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

/// What both sides are shown by.
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
        // As long at constant velocity as it takes to get there.
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

/// Output of a lasting error of one increment, by the proportional gains.
pub(super) fn stiffness(loops: &Loops) -> f64 {
    use lineshaft_core::regulator::{K_OUT, VELOCITY_GAIN};
    let position = match loops.position {
        PositionLaw::Proportional { kv } => kv / loops.max_velocity,
        PositionLaw::Pid { gains, .. } => gains.proportional as f64 / K_OUT,
    };
    position * loops.velocity.map_or(1.0, |inner| f64::from(inner.gains.proportional.abs()) * VELOCITY_GAIN)
}

/// To 1, 2 or 5 times a power of ten.
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

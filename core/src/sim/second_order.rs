//! Drive whose position, or velocity, follows its setpoint as a damped second-order system.
//!
//! Law      y'' = w^2 (r - y) - 2 d w y', w = 2 pi bandwidth; r is linear between the position setpoints of two cycles,
//!          and held for a velocity; solved exactly over a cycle, not approximated, so that no bandwidth makes it
//!          unstable. Without power v' = -v / coast with a time constant, otherwise it stops at once
//! Reads    the setpoint (inc), or (inc/s)
//! Writes   position, whole and nearest (inc), and velocity (inc/s); or the mean velocity over the cycle (inc/s)
//! Refuses  bandwidth or damping that is not above 0 and finite, a time constant outside its range

use super::motor::{Lag, check_lag, negligible};
use libm::{cos, cosh, exp, sin, sinh};
use std::f64::consts::TAU;

/// Error of a model.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// Bandwidth (Hz).
    #[error("bandwidth is {0} Hz; more than 0 Hz up to 100000 Hz is allowed")]
    Bandwidth(f64),
    /// Damping ratio.
    #[error("damping is {0}; 0.01 to 100 is allowed")]
    Damping(f64),
    /// Time constant (ns).
    #[error("time_constant is {} ms; 0 ms to 10000 ms is allowed", *.0 as f64 / 1e6)]
    TimeConstant(i64),
    /// Time constant of coasting (ns).
    #[error("coast is {} ms; 0 ms to 10000 ms is allowed", *.0 as f64 / 1e6)]
    Coast(i64),
    /// Dead time (ns).
    #[error("dead_time is {} ms; 0 ms to 1000 ms is allowed", *.0 as f64 / 1e6)]
    DeadTime(i64),
    /// Time constant of the torque (ns).
    #[error("torque_lag is {} ms; 0 ms to 1000 ms is allowed", *.0 as f64 / 1e6)]
    TorqueLag(i64),
    /// A value of a motor.
    #[error("{name} is {value} {unit}; {least} {unit} to {most} {unit} is allowed")]
    Motor {
        /// Its key in a cell.
        name: &'static str,
        /// The given value.
        value: f64,
        /// Unit of all three numbers.
        unit: &'static str,
        /// Minimum.
        least: f64,
        /// Maximum.
        most: f64,
    },
}

/// The law over one cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondOrder {
    cycle_s: f64,
    /// 2 damping / w: lag of the position at a steady setpoint (s).
    lag_s: f64,
    /// 1 / w^2 (s^2).
    softness: f64,
    /// Free motion over a cycle: new [position, velocity] from old ones.
    free: [[f64; 2]; 2],
    /// Decay of the velocity without power; `None`: it stops at once.
    coast: Option<Lag>,
}

/// State of the simulated motor: position relative to the last setpoint, and velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct State {
    setpoint: i64,
    ahead: f64,
    velocity: f64,
}

impl State {
    pub(super) fn rest_at(&mut self, position: i64) {
        *self = Self { setpoint: position, ahead: 0.0, velocity: 0.0 };
    }

    pub(super) fn shift(&mut self, by: i64) {
        self.ahead += by as f64;
    }

    pub(super) fn position(&self) -> i64 {
        // The cast saturates.
        self.setpoint.saturating_add(self.ahead.round() as i64)
    }

    pub(super) fn velocity(&self) -> f64 {
        self.velocity
    }
}

impl SecondOrder {
    /// Creates a model with that bandwidth (Hz) and damping ratio, stepped once per cycle.
    ///
    /// # Errors
    /// Values outside their range.
    pub fn new(bandwidth: f64, damping: f64, cycle_ns: u64) -> Result<Self, ModelError> {
        if !(bandwidth > 0.0 && bandwidth <= 1e5) {
            return Err(ModelError::Bandwidth(bandwidth));
        }
        if !(0.01..=100.0).contains(&damping) {
            return Err(ModelError::Damping(damping));
        }
        let cycle_s = cycle_ns as f64 / 1e9;
        let w = TAU * bandwidth;
        Ok(Self {
            cycle_s,
            lag_s: 2.0 * damping / w,
            softness: 1.0 / (w * w),
            free: free_motion(w, damping, cycle_s),
            coast: None,
        })
    }

    /// Returns the same drive with a velocity that decays with that time constant (ns) without power.
    ///
    /// # Errors
    /// A time outside its range.
    pub fn coasting(self, time_constant_ns: i64, cycle_ns: u64) -> Result<Self, ModelError> {
        check_lag(time_constant_ns, ModelError::Coast)?;
        Ok(Self { coast: Some(Lag::new(time_constant_ns, cycle_ns)), ..self })
    }

    /// Returns the decay of its velocity without power; `None`: it stops at once.
    pub(super) fn coast(&self) -> Option<Lag> {
        self.coast
    }

    pub(super) fn step(&self, state: &mut State, setpoint: i64) {
        let change = setpoint.wrapping_sub(state.setpoint) as f64;
        let slope = change / self.cycle_s;
        // At a constant velocity of the setpoint the position lags by `lag`, and moves freely around that.
        let lag = self.lag_s * slope;
        let (position, velocity) = (state.ahead + lag, state.velocity - slope);
        let [[a, b], [c, d]] = self.free;
        state.ahead = a * position + b * velocity - lag;
        state.velocity = c * position + d * velocity + slope;
        state.setpoint = setpoint;
    }

    /// Executes one cycle of a velocity that follows its setpoint. Returns the mean velocity (inc/s).
    pub(super) fn step_velocity(&self, velocity: &mut f64, acceleration: &mut f64, setpoint: f64) -> f64 {
        let (before, rate) = (*velocity - setpoint, *acceleration);
        let [[a, b], [c, d]] = self.free;
        let (after, new_rate) = (a * before + b * rate, c * before + d * rate);
        // Integral of the law itself: e = -(e'' + 2 d w e') / w^2.
        let further = (rate - new_rate) * self.softness + (before - after) * self.lag_s;
        let left = after.abs() * self.lag_s + new_rate.abs() * self.softness;
        (*velocity, *acceleration) =
            if left <= negligible(setpoint) { (setpoint, 0.0) } else { (setpoint + after, new_rate) };
        setpoint + further / self.cycle_s
    }
}

/// Returns the exact solution of y'' = -w^2 y - 2 d w y' after a time.
fn free_motion(w: f64, damping: f64, time: f64) -> [[f64; 2]; 2] {
    let decay = damping * w;
    let discriminant = damping * damping - 1.0;
    let root = w * discriminant.abs().sqrt();
    // s = sin(root t) / root, c = cos(root t), or their limits at and beyond critical damping; both times e^-decay t.
    let (c, s) = if root * time < 1e-9 {
        (exp(-decay * time), time * exp(-decay * time))
    } else if discriminant < 0.0 {
        (exp(-decay * time) * cos(root * time), exp(-decay * time) * sin(root * time) / root)
    } else if root * time > 300.0 {
        // cosh would overflow: only the slow part is left.
        let slow = exp((root - decay) * time) / 2.0;
        (slow, slow / root)
    } else {
        (exp(-decay * time) * cosh(root * time), exp(-decay * time) * sinh(root * time) / root)
    };
    [[c + decay * s, s], [-w * w * s, c - decay * s]]
}

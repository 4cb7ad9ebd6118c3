//! Loops of an axis as linear systems, for small errors.
//!
//! Law      position loop: kv/max_velocity, or (KPROP + KDER (1 - 1/z) + KINT z/(z - 1)) / K_OUT each TIMER. Velocity
//!          loop, each cycle: (VELKPROP + VELKINT T z/(z - 1)) / 100 on the setpoint minus the estimated velocity, as
//!          fractions of max_velocity
//! Reads    gains, a model
//! Writes   the chain of the open loop, cut at its error
//! Refuses  loops that do not suit the drive

use crate::discrete::Discrete;
use crate::model::{Model, ModelError, Takes, judge};
use lineshaft_core::regulator::{EstimatorError, K_OUT, PidGains, VELOCITY_GAIN, VelocityGains, VelocityMethod};
use nalgebra::{DMatrix, DVector, RowDVector};
use serde::{Deserialize, Serialize};

/// Law of the position loop.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum PositionLaw {
    /// Proportional, with kv (1/s).
    Proportional {
        /// Gain (1/s), above 0.
        kv: f64,
    },
    /// PID of MACS.
    Pid {
        /// Its parameters.
        gains: PidGains,
        /// TIMER in cycles of the machine.
        cycles: u32,
    },
}

/// Velocity loop inside the position loop.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Inner {
    /// Its parameters.
    pub gains: VelocityGains,
    /// Method of finding the velocity.
    pub method: VelocityMethod,
}

/// All loops of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Loops {
    /// Position loop.
    pub position: PositionLaw,
    /// Velocity loop; `None` if the position loop commands the drive (AMPMODE 2, or a velocity drive).
    pub velocity: Option<Inner>,
    /// VELMAX (inc/s): the velocity of output 1 of the position loop, if that is a velocity; reference of FFVEL.
    pub max_velocity: f64,
    /// Reference of FFACC (inc/s^2).
    pub max_acceleration: f64,
}

/// Error of invalid loops.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LoopError {
    /// A value outside its range.
    #[error(transparent)]
    Value(#[from] ModelError),
    /// An invalid estimator.
    #[error(transparent)]
    Estimator(#[from] EstimatorError),
    /// A velocity loop for a drive that has its own.
    #[error("the drive takes velocities; a velocity loop suits one that takes efforts")]
    TwoVelocityLoops,
    /// No damping for an effort.
    #[error(
        "the drive takes efforts; a proportional position loop suits one that takes velocities, or a velocity loop below it"
    )]
    NoDamping,
}

impl Loops {
    /// Returns the cycles of the machine between two samples of the position loop.
    pub fn cycles(&self) -> u32 {
        match self.position {
            PositionLaw::Proportional { .. } => 1,
            PositionLaw::Pid { cycles, .. } => cycles.max(1),
        }
    }

    pub(crate) fn check(&self, model: &Model) -> Result<(), LoopError> {
        model.check()?;
        judge("max_velocity", self.max_velocity, "inc/s", 1e-3, 1e12)?;
        judge("max_acceleration", self.max_acceleration, "inc/s^2", 1e-3, 1e15)?;
        judge("TIMER", f64::from(self.cycles()), "cycles", 1.0, 10_000.0)?;
        if let PositionLaw::Proportional { kv } = self.position {
            judge("kv", kv, "1/s", 0.0, 1e5)?;
        }
        match (model.takes(), self.velocity, self.position) {
            (Takes::Velocity, Some(_), _) => Err(LoopError::TwoVelocityLoops),
            (Takes::Effort, None, PositionLaw::Proportional { .. }) => Err(LoopError::NoDamping),
            _ => Ok(()),
        }
    }

    /// Returns the system from the output of the position loop to the position, sampled with the position loop.
    pub(crate) fn axis(&self, model: &Model) -> Result<Discrete, LoopError> {
        let axis = Discrete::of(model);
        let axis = match &self.velocity {
            None => axis,
            Some(inner) => inner.closed(&axis, model.cycle, self.max_velocity)?,
        };
        Ok(axis.held_for(self.cycles()))
    }

    /// Returns the open position loop.
    pub(crate) fn position_chain(&self, axis: &Discrete) -> Discrete {
        self.position.law(self.max_velocity).connect(axis)
    }
}

impl PositionLaw {
    /// Returns the system from the error (inc) to the output.
    pub(crate) fn law(&self, max_velocity: f64) -> Discrete {
        match self {
            Self::Proportional { kv } => gain(kv / max_velocity),
            Self::Pid { gains, .. } => {
                let part = |gain: i64| gain as f64 / K_OUT;
                // KILIM 0 means no integral term.
                let integral = if gains.limit == 0 { 0.0 } else { part(gains.integral) };
                pid(part(gains.proportional), part(gains.derivative), integral)
            }
        }
    }
}

impl Inner {
    /// Returns the system from the error (fraction of max_velocity) to the output.
    pub(crate) fn law(&self) -> Discrete {
        let (proportional, integral) = self.weights();
        pi(proportional, integral)
    }

    /// Returns the output per full speed, and per full speed and cycle.
    pub(crate) fn weights(&self) -> (f64, f64) {
        let gains = &self.gains;
        // VELKILIM 0 means no integral term.
        let integral = if gains.limit == 0 { 0.0 } else { f64::from(gains.integral) * gains.cycle * VELOCITY_GAIN };
        (f64::from(gains.proportional) * VELOCITY_GAIN, integral)
    }

    /// Returns the open velocity loop: law, axis, estimator.
    pub(crate) fn chain(&self, axis: &Discrete, cycle: f64, max_velocity: f64) -> Result<Discrete, LoopError> {
        let seen = Discrete::estimator(self.method, cycle)?.scaled(1.0 / max_velocity);
        Ok(self.law().connect(axis).connect(&seen))
    }

    /// Returns the closed velocity loop, from setpoint to position.
    fn closed(&self, axis: &Discrete, cycle: f64, max_velocity: f64) -> Result<Discrete, LoopError> {
        let chain = self.chain(axis, cycle, max_velocity)?;
        let law = self.law().a.nrows();
        let mut c = RowDVector::zeros(chain.a.nrows());
        c.columns_mut(law, axis.a.nrows()).copy_from(&axis.c);
        Ok(Discrete { a: chain.closed(), b: chain.b, c, d: 0.0 })
    }
}

/// Returns a factor, as a system without states.
pub(crate) fn gain(factor: f64) -> Discrete {
    Discrete { a: DMatrix::zeros(0, 0), b: DVector::zeros(0), c: RowDVector::zeros(0), d: factor }
}

/// Returns a PID law. States: the sum; the error of the previous sample. The sum includes the error of the present
/// sample.
pub(crate) fn pid(proportional: f64, derivative: f64, integral: f64) -> Discrete {
    let direct = proportional + derivative + integral;
    if integral == 0.0 {
        let (a, b) = (DMatrix::zeros(1, 1), DVector::from_vec(vec![1.0]));
        return Discrete { a, b, c: RowDVector::from_vec(vec![-derivative]), d: direct };
    }
    let a = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, 0.0]);
    let b = DVector::from_vec(vec![1.0, 1.0]);
    Discrete { a, b, c: RowDVector::from_vec(vec![integral, -derivative]), d: direct }
}

pub(crate) fn pi(proportional: f64, integral: f64) -> Discrete {
    if integral == 0.0 {
        return gain(proportional);
    }
    let (a, b) = (DMatrix::identity(1, 1), DVector::from_vec(vec![1.0]));
    Discrete { a, b, c: RowDVector::from_vec(vec![integral]), d: proportional + integral }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_core::regulator::{Pid, PidInput, VelocityLoop};

    /// Errors that stay within the limits of the laws.
    fn errors() -> impl Iterator<Item = f64> {
        (0..200).map(|k| f64::from((k * k * 31) % 101 - 50))
    }

    fn same(system: &Discrete, mut law: impl FnMut(f64) -> f64, scale: f64) {
        let mut x = DVector::zeros(system.a.nrows());
        let mut before = None;
        for error in errors().map(|error| error * scale) {
            let expected = law(error);
            // The law uses its first error also as the previous one.
            if before.is_none() && system.a.nrows() > 0 && system.c[system.a.nrows() - 1] < 0.0 {
                x[system.a.nrows() - 1] = error;
            }
            before = Some(error);
            let y = (&system.c * &x).iter().sum::<f64>() + system.d * error;
            assert!((y - expected).abs() < 1e-9, "{y} {expected}");
            x = &system.a * x + &system.b * error;
        }
    }

    #[test]
    fn the_law_of_the_pid_is_that_of_the_core() {
        for (proportional, derivative, integral) in [(30, 0, 0), (40, 90, 0), (20, 0, 3), (25, 70, 2)] {
            let gains = PidGains {
                proportional,
                derivative,
                integral,
                limit: 65_000,
                bandwidth: 1000,
                period_ms: 1,
                ..PidGains::default()
            };
            let mut core = Pid::default();
            let law = PositionLaw::Pid { gains, cycles: 1 }.law(1e5);
            same(&law, |error| core.step(&gains, 1, PidInput { error, ..PidInput::default() }), 1.0);
        }
    }

    #[test]
    fn the_law_of_the_velocity_loop_is_that_of_the_core() {
        for (proportional, integral, limit, cycle) in [(200, 0, 1000, 1.0), (150, 5, 32_767, 0.25), (150, 5, 0, 1.0)] {
            let gains = VelocityGains { proportional, integral, limit, cycle };
            let mut core = VelocityLoop::default();
            let law = Inner { gains, method: VelocityMethod::Difference }.law();
            same(&law, |error| core.step(&gains, error), 1e-3);
        }
    }

    #[test]
    fn a_velocity_loop_without_a_drive_of_efforts_is_refused() {
        use crate::model::Dynamics;
        let model = Model {
            cycle: 1e-3,
            delay: 0.0,
            dynamics: Dynamics::Velocity { gain: 1e5, time_constant: 0.0, offset: 0.0 },
        };
        let gains = VelocityGains { proportional: 200, integral: 5, limit: 1000, cycle: 1.0 };
        let velocity = Some(Inner { gains, method: VelocityMethod::Difference });
        let position = PositionLaw::Proportional { kv: 10.0 };
        let loops = Loops { position, velocity, max_velocity: 1e5, max_acceleration: 1e6 };
        assert_eq!(loops.check(&model), Err(LoopError::TwoVelocityLoops));
        let wrong = Loops { velocity: None, max_velocity: f64::NAN, ..loops };
        assert_eq!(
            wrong.check(&model).unwrap_err().to_string(),
            "max_velocity is NaN inc/s; 0.001 to 1000000000000 inc/s is permitted"
        );
    }
}

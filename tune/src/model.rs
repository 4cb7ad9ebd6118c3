//! Model of an axis for the design of gains.
//!
//! Law      velocity drive: v' = (gain u - v) / time_constant, with an offset of the velocity at u = 0. Effort drive:
//!          v' = acceleration u - viscous v - coulomb sign(v) - load; with a resonance the load is connected by a
//!          spring, and friction acts on the motor. u takes effect after `delay`, and is held for a cycle
//! Reads    u, the command as a fraction of full command, -1 to 1
//! Writes   position of the encoder, at the motor (inc)
//! Refuses  figures outside their range ([`ModelError`])
//!
//! The modes of two masses add up: acceleration (1/s^2 + R / (s^2 + 2 z w s + w^2)), with R the inertia of the load
//! relative to that of the motor.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// Interface of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Takes {
    /// Velocity: 1 is the full velocity.
    Velocity,
    /// Effort, that is current or torque: 1 is the full effort.
    Effort,
}

/// The first resonance of a motor and a load on a spring.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Resonance {
    /// Frequency with a free motor (Hz).
    pub frequency: f64,
    /// Damping of the whole oscillation, relative to the critical one, including the viscous friction of the motor.
    pub damping: f64,
    /// Inertia of the load relative to that of the motor.
    pub inertia_ratio: f64,
}

/// Dynamics of the axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Dynamics {
    /// With a drive that closes the velocity loop.
    Velocity {
        /// Velocity at command 1 (inc/s).
        gain: f64,
        /// Time constant of the first-order lag (s).
        time_constant: f64,
        /// Velocity at command 0 (inc/s).
        offset: f64,
    },
    /// With a drive that has an effort interface.
    Effort {
        /// Acceleration at command 1, of the whole inertia (inc/s^2).
        acceleration: f64,
        /// Viscous friction relative to the whole inertia (1/s).
        viscous: f64,
        /// Coulomb friction relative to the whole inertia (inc/s^2).
        coulomb: f64,
        /// A constant load such as gravity, in negative direction (inc/s^2).
        load: f64,
        /// Resonance, if there is one.
        resonance: Option<Resonance>,
    },
}

/// A model of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Model {
    /// Cycle time (s).
    pub cycle: f64,
    /// Delay from the output of a cycle to its effect, in addition to the cycle itself (s). It includes lags of an
    /// amplifier with effort interface.
    pub delay: f64,
    /// Dynamics.
    pub dynamics: Dynamics,
}

/// Error of a figure of a model.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{name} is {value} {unit}; {least} to {most} {unit} is permitted")]
pub struct ModelError {
    /// Name of the figure.
    pub name: &'static str,
    /// The given value.
    pub value: f64,
    /// Unit of all three values.
    pub unit: &'static str,
    /// Minimum.
    pub least: f64,
    /// Maximum.
    pub most: f64,
}

/// Maximum delay (cycles).
pub(crate) const MOST_DELAY: f64 = 50.0;

/// A lag below this part of a cycle is neglected.
const LEAST_LAG: f64 = 0.01;

pub(crate) fn judge(
    name: &'static str,
    value: f64,
    unit: &'static str,
    least: f64,
    most: f64,
) -> Result<(), ModelError> {
    let error = ModelError { name, value, unit, least, most };
    if (least..=most).contains(&value) { Ok(()) } else { Err(error) }
}

/// x' = A x + B u; the position is `x[0]`, the velocity of a motor with friction `x[1]`.
pub(crate) struct Continuous {
    pub(crate) a: DMatrix<f64>,
    pub(crate) b: DVector<f64>,
}

impl Model {
    /// Returns the interface of its drive.
    pub fn takes(&self) -> Takes {
        match self.dynamics {
            Dynamics::Velocity { .. } => Takes::Velocity,
            Dynamics::Effort { .. } => Takes::Effort,
        }
    }

    /// Checks that each figure is within its range.
    ///
    /// # Errors
    /// The first figure outside its range.
    pub fn check(&self) -> Result<(), ModelError> {
        judge("cycle", self.cycle, "s", 1e-5, 1.0)?;
        judge("delay", self.delay, "s", 0.0, MOST_DELAY * self.cycle)?;
        match self.dynamics {
            Dynamics::Velocity { gain, time_constant, offset } => {
                judge("gain", gain, "inc/s", 1e-3, 1e12)?;
                judge("time_constant", time_constant, "s", 0.0, 100.0)?;
                judge("offset", offset, "inc/s", -gain, gain)
            }
            Dynamics::Effort { acceleration, viscous, coulomb, load, resonance } => {
                judge("acceleration", acceleration, "inc/s^2", 1e-3, 1e15)?;
                judge("viscous", viscous, "1/s", 0.0, 1e4)?;
                judge("coulomb", coulomb, "inc/s^2", 0.0, acceleration)?;
                judge("load", load, "inc/s^2", -acceleration, acceleration)?;
                resonance.map_or(Ok(()), |r| {
                    judge("frequency", r.frequency, "Hz", 1e-3, 0.5 / self.cycle)?;
                    judge("damping", r.damping, "", 0.0, 1.0)?;
                    judge("inertia_ratio", r.inertia_ratio, "", 1e-3, 1e3)
                })
            }
        }
    }

    /// Returns its linear part.
    pub(crate) fn continuous(&self) -> Continuous {
        match self.dynamics {
            Dynamics::Velocity { gain, time_constant, .. } => {
                if time_constant < LEAST_LAG * self.cycle {
                    return Continuous { a: DMatrix::zeros(1, 1), b: DVector::from_vec(vec![gain]) };
                }
                first_order(gain / time_constant, 1.0 / time_constant)
            }
            Dynamics::Effort { acceleration, viscous, resonance: None, .. } => first_order(acceleration, viscous),
            Dynamics::Effort { acceleration, viscous, resonance: Some(r), .. } => {
                let omega = core::f64::consts::TAU * r.frequency;
                let stiffness = omega * omega;
                // Friction of the motor damps the oscillation as well; the rest is the damping of the spring.
                let damping = (2.0 * r.damping * omega - viscous * r.inertia_ratio).max(0.0);
                let (motor, load) = (r.inertia_ratio / (1.0 + r.inertia_ratio), 1.0 / (1.0 + r.inertia_ratio));
                // Position and velocity of the motor, twist, velocity of the load.
                #[rustfmt::skip]
                let a = DMatrix::from_row_slice(4, 4, &[
                    0.0, 1.0, 0.0, 0.0,
                    0.0, -damping * motor - viscous * (1.0 + r.inertia_ratio), -stiffness * motor, damping * motor,
                    0.0, 1.0, 0.0, -1.0,
                    0.0, damping * load, stiffness * load, -damping * load,
                ]);
                Continuous { a, b: DVector::from_vec(vec![0.0, acceleration * (1.0 + r.inertia_ratio), 0.0, 0.0]) }
            }
        }
    }
}

/// Returns the system p'' = gain u - rate p'.
pub(crate) fn first_order(gain: f64, rate: f64) -> Continuous {
    Continuous { a: DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, -rate]), b: DVector::from_vec(vec![0.0, gain]) }
}

/// Returns the system p'' = u - 2 z w p' - w^2 p.
pub(crate) fn second_order(omega: f64, damping: f64) -> Continuous {
    let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -omega * omega, -2.0 * damping * omega]);
    Continuous { a, b: DVector::from_vec(vec![0.0, 1.0]) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::{magnitude, poles};

    fn elastic(viscous: f64) -> Model {
        let resonance = Some(Resonance { frequency: 50.0, damping: 0.05, inertia_ratio: 4.0 });
        let dynamics = Dynamics::Effort { acceleration: 1e6, viscous, coulomb: 0.0, load: 0.0, resonance };
        Model { cycle: 1e-3, delay: 0.0, dynamics }
    }

    /// The oscillation of both masses has the frequency and the damping of the model, including friction of the motor;
    /// the other poles are the position and the velocity of the whole axis.
    #[test]
    fn two_masses_swing_as_the_model_says() {
        for viscous in [0.0, 2.0] {
            let poles = poles(&elastic(viscous).continuous().a);
            let swing = poles.iter().find(|pole| pole.im > 1.0).copied().unwrap();
            let omega = core::f64::consts::TAU * 50.0;
            assert!((magnitude(swing) / omega - 1.0).abs() < 0.005, "{viscous}: {swing}");
            // -re/|s|, accurate to the square of terms that are small relative to the oscillation.
            assert!((-swing.re / magnitude(swing) - 0.05).abs() < 0.001, "{viscous}: {swing}");
            let whole = poles.iter().map(|pole| pole.re).fold(0.0, |sum, re| sum + re) - 2.0 * swing.re;
            assert!((whole + viscous).abs() < 0.1, "{viscous}: {whole}");
        }
    }

    #[test]
    fn figures_beyond_their_range_are_refused() {
        let model = elastic(0.0);
        assert_eq!(model.check(), Ok(()));
        let Dynamics::Effort { acceleration, viscous, coulomb, load, resonance } = model.dynamics else { panic!() };
        let said = |dynamics| Model { dynamics, ..model }.check().unwrap_err().to_string();
        let with = |load| Dynamics::Effort { acceleration, viscous, coulomb, load, resonance };
        assert_eq!(said(with(-2e6)), "load is -2000000 inc/s^2; -1000000 to 1000000 inc/s^2 is permitted");
        assert_eq!(said(with(f64::NAN)), "load is NaN inc/s^2; -1000000 to 1000000 inc/s^2 is permitted");
        let velocity = Dynamics::Velocity { gain: -1.0, time_constant: 0.0, offset: 0.0 };
        assert_eq!(said(velocity), "gain is -1 inc/s; 0.001 to 1000000000000 inc/s is permitted");
        let resonance = resonance.map(|resonance| Resonance { frequency: 501.0, ..resonance });
        let fast = Dynamics::Effort { acceleration, viscous, coulomb, load, resonance };
        assert_eq!(said(fast), "frequency is 501 Hz; 0.001 to 500 Hz is permitted");
    }
}

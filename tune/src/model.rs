//! What is known of an axis: the model that gains are designed for.
//!
//! Law      drive of velocities: v' = (gain u - v) / time_constant, with an offset of the velocity at u = 0.
//!          drive of efforts: v' = acceleration u - viscous v - coulomb sign(v) - load; with a resonance the load hangs on a spring,
//!          and friction is the motor's. u acts `delay` late, and is held for a cycle
//! Reads    u, the command in parts of the full one, -1 to 1
//! Writes   position of the encoder, at the motor (inc)
//! Refuses  figures beyond their range ([`ModelError`])
//!
//! The modes of two masses add: acceleration (1/s^2 + R / (s^2 + 2 z w s + w^2)), R the inertia of the load in parts of the motor's.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// What a drive takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Takes {
    /// Velocities: 1 is the full one.
    Velocity,
    /// Efforts, currents or torques: 1 is the full one.
    Effort,
}

/// The first resonance of a motor and a load behind a spring.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Resonance {
    /// Hz, with a motor that is free.
    pub frequency: f64,
    /// Of the whole swing, in parts of the critical one: with what viscous friction of the motor makes of it.
    pub damping: f64,
    /// Inertia of the load in parts of that of the motor.
    pub inertia_ratio: f64,
}

/// How the axis moves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Dynamics {
    /// Behind a drive that closes its velocity loop.
    Velocity {
        /// Velocity at the command 1 (inc/s).
        gain: f64,
        /// Of the lag of first order (s).
        time_constant: f64,
        /// Velocity at the command 0 (inc/s).
        offset: f64,
    },
    /// Behind a drive that gives efforts.
    Effort {
        /// At the command 1, of the whole inertia (inc/s^2).
        acceleration: f64,
        /// Viscous friction in parts of the whole inertia (1/s).
        viscous: f64,
        /// Coulomb friction, likewise (inc/s^2).
        coulomb: f64,
        /// A constant load such as gravity, against the positive sense (inc/s^2).
        load: f64,
        /// Where there is one.
        resonance: Option<Resonance>,
    },
}

/// A model of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Model {
    /// Of the machine (s).
    pub cycle: f64,
    /// From the output of a cycle, beyond the cycle itself, to what it does (s). Lags of an amplifier of efforts are in it.
    pub delay: f64,
    /// How it moves.
    pub dynamics: Dynamics,
}

/// A figure of a model that is none.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{name} is {value} {unit}; {least} to {most} {unit} is permitted")]
pub struct ModelError {
    /// Which.
    pub name: &'static str,
    /// What was given.
    pub value: f64,
    /// Of all three.
    pub unit: &'static str,
    /// Smallest that is permitted.
    pub least: f64,
    /// Largest that is permitted.
    pub most: f64,
}

/// Longest delay (cycles).
pub(crate) const MOST_DELAY: f64 = 50.0;

/// A lag below this part of a cycle is none.
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

/// x' = A x + B u; the position is x[0], the velocity of a motor that has friction x[1].
pub(crate) struct Continuous {
    pub(crate) a: DMatrix<f64>,
    pub(crate) b: DVector<f64>,
}

impl Model {
    /// What its drive takes.
    pub fn takes(&self) -> Takes {
        match self.dynamics {
            Dynamics::Velocity { .. } => Takes::Velocity,
            Dynamics::Effort { .. } => Takes::Effort,
        }
    }

    /// Is each figure within its range?
    ///
    /// # Errors
    /// The first one that is not.
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

    /// Its linear part.
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
                // Friction of the motor damps the swing as well; the rest is the spring's.
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

/// p'' = gain u - rate p'.
pub(crate) fn first_order(gain: f64, rate: f64) -> Continuous {
    Continuous { a: DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, -rate]), b: DVector::from_vec(vec![0.0, gain]) }
}

/// p'' = u - 2 z w p' - w^2 p.
pub(crate) fn second_order(omega: f64, damping: f64) -> Continuous {
    let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -omega * omega, -2.0 * damping * omega]);
    Continuous { a, b: DVector::from_vec(vec![0.0, 1.0]) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::{poles, size};

    fn elastic(viscous: f64) -> Model {
        let resonance = Some(Resonance { frequency: 50.0, damping: 0.05, inertia_ratio: 4.0 });
        let dynamics = Dynamics::Effort { acceleration: 1e6, viscous, coulomb: 0.0, load: 0.0, resonance };
        Model { cycle: 1e-3, delay: 0.0, dynamics }
    }

    /// The swing of both masses has the frequency and the damping of the model, friction of the motor included; what is left of its poles
    /// are a place and the velocity of all of it.
    #[test]
    fn two_masses_swing_as_the_model_says() {
        for viscous in [0.0, 2.0] {
            let poles = poles(&elastic(viscous).continuous().a);
            let swing = poles.iter().find(|pole| pole.im > 1.0).copied().unwrap();
            let omega = core::f64::consts::TAU * 50.0;
            assert!((size(swing) / omega - 1.0).abs() < 0.005, "{viscous}: {swing}");
            // -re/|s|, to the square of what is small beside the swing.
            assert!((-swing.re / size(swing) - 0.05).abs() < 0.001, "{viscous}: {swing}");
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

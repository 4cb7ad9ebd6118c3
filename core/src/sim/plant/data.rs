//! Data of a simulated motor and its load.
//!
//! Law      all values refer to the motor shaft: a load behind a gear of ratio i has its inertia, friction and
//!          stiffness divided by i^2, its torque and Coulomb friction by i
//! Refuses  values outside their ranges, with name, value and range
//! Source   contract section 3

use crate::sim::ModelError;
use std::f64::consts::TAU;

/// Friction of a rotating body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Friction {
    /// Viscous friction (N m s/rad), 0 to 1e6.
    pub viscous: f64,
    /// Coulomb friction, against the direction of motion (N m), 0 to 1e6.
    pub coulomb: f64,
    /// Static friction (N m), `coulomb` to 1e6.
    pub holding: f64,
}

/// Load of the motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// Inertia (kg m^2), 0 to 1e6; with a coupling 1e-9 to 1e6.
    pub inertia: f64,
    /// Friction of its bearings and guides.
    pub friction: Friction,
    /// Constant torque, such as a weight (N m), -1e6 to 1e6; positive in positive direction.
    pub torque: f64,
}

/// Elastic coupling between motor and load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    /// Stiffness (N m/rad), 1e-6 to 1e12.
    pub stiffness: f64,
    /// Damping (N m s/rad), 0 to 1e9.
    pub damping: f64,
    /// Backlash from one flank to the other (rad), 0 to one turn.
    pub backlash: f64,
}

/// Torque stage: conversion of the setpoint to torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stage {
    /// A drive with a current loop: the torque follows its setpoint with a lag.
    Torque {
        /// Torque of setpoint 1 (N m), 1e-6 to 1e6.
        rated: f64,
        /// Time constant of the current loop (ns), 0 to 1 s.
        lag_ns: i64,
    },
    /// An amplifier of voltage at a winding: L i' = u - R i - ke w, torque = kt i.
    Winding {
        /// Voltage of setpoint 1 (V), 1e-3 to 1e6.
        voltage: f64,
        /// Resistance R (Ohm), 1e-6 to 1e6.
        resistance: f64,
        /// Inductance L (H), 0 to 1e3.
        inductance: f64,
        /// Torque constant kt (N m/A), 1e-9 to 1e6.
        torque_constant: f64,
        /// Voltage constant ke (V s/rad), 0 to 1e6.
        back_emf: f64,
    },
}

impl Stage {
    /// Returns the steady torque of setpoint 1 at rest (N m).
    pub(super) fn full(&self) -> f64 {
        match *self {
            Self::Torque { rated, .. } => rated,
            Self::Winding { voltage, resistance, torque_constant, .. } => torque_constant * voltage / resistance,
        }
    }

    /// Returns the time constant between setpoint and torque (s).
    pub(super) fn lag_s(&self) -> f64 {
        match *self {
            Self::Torque { lag_ns, .. } => lag_ns as f64 / 1e9,
            Self::Winding { resistance, inductance, .. } => inductance / resistance,
        }
    }

    /// Returns the loss of torque per velocity (N m s/rad).
    pub(super) fn drag(&self) -> f64 {
        match *self {
            Self::Torque { .. } => 0.0,
            Self::Winding { resistance, torque_constant, back_emf, .. } => torque_constant * back_emf / resistance,
        }
    }
}

/// Amplifier: from the setpoint of a drive to the torque of its motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Amplifier {
    /// Torque stage.
    pub stage: Stage,
    /// Limit of the setpoint, as a multiple of the rated torque or of the voltage, 1e-3 to 1000.
    pub limit: f64,
    /// Dead time of a setpoint (ns), 0 to 1 s; need not be whole cycles.
    pub dead_time_ns: i64,
}

/// Encoder on the shaft of the motor, and that of the load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Counts per turn of the motor, 1 to 2^32.
    pub counts_per_turn: f64,
    /// Standard deviation of a reading (counts), 0 to 1e6; limited to 3.5 times that.
    pub noise: f64,
    /// Seed of the noise.
    pub seed: u64,
    /// Whether the second encoder, which the axis reads, is at the load.
    pub at_load: bool,
}

/// A motor with its amplifier, its load and its encoder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorData {
    /// Inertia of the rotor (kg m^2), 1e-9 to 1e6.
    pub inertia: f64,
    /// Friction of the bearings of the motor.
    pub friction: Friction,
    /// Load of the motor.
    pub load: Load,
    /// Coupling between motor and load; without one both turn as one body.
    pub coupling: Option<Coupling>,
    /// From setpoint to torque.
    pub amplifier: Amplifier,
    /// From angle to counts.
    pub reading: Reading,
}

/// A motor with checked data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    pub(super) data: MotorData,
    /// Whether it turns against its setpoint.
    pub(in crate::sim) inverted: bool,
}

impl Motor {
    /// Creates a motor with those data.
    ///
    /// # Errors
    /// The first value outside its range.
    pub fn new(data: MotorData) -> Result<Self, ModelError> {
        data.problems().into_iter().next().map_or(Ok(Self { data, inverted: false }), Err)
    }

    /// Returns true if its setpoint is the voltage of a winding.
    pub(in crate::sim) fn has_winding(&self) -> bool {
        matches!(self.data.amplifier.stage, Stage::Winding { .. })
    }
}

/// Maximum lag and dead time (ns).
const SECOND: i64 = 1_000_000_000;
/// Minimum inertia (kg m^2).
const LIGHTEST: f64 = 1e-9;
/// Maximum torque, inertia and friction.
const MOST: f64 = 1e6;

/// Returns the error of a value outside its range.
fn beyond(name: &'static str, value: f64, unit: &'static str, least: f64, most: f64) -> Option<ModelError> {
    let is_good = (least..=most).contains(&value);
    (!is_good).then_some(ModelError::Motor { name, value, unit, least, most })
}

impl Friction {
    /// Returns true if it has static friction.
    pub(super) fn is_dry(&self) -> bool {
        self.holding > 0.0
    }

    fn problems(&self, [viscous, coulomb, holding]: [&'static str; 3]) -> [Option<ModelError>; 3] {
        // An invalid value is no lower limit of another one.
        let least = if (0.0..=MOST).contains(&self.coulomb) { self.coulomb } else { 0.0 };
        [
            beyond(viscous, self.viscous, "Nm*s/rad", 0.0, MOST),
            beyond(coulomb, self.coulomb, "Nm", 0.0, MOST),
            beyond(holding, self.holding, "Nm", least, MOST),
        ]
    }
}

impl MotorData {
    /// Returns an error for every value outside its range.
    pub fn problems(&self) -> Vec<ModelError> {
        let lightest = if self.coupling.is_some() { LIGHTEST } else { 0.0 };
        let coupling = self.coupling.map(|Coupling { stiffness, damping, backlash }| {
            [
                beyond("stiffness", stiffness, "Nm/rad", 1e-6, 1e12),
                beyond("coupling_damping", damping, "Nm*s/rad", 0.0, 1e9),
                beyond("backlash", backlash, "rad", 0.0, TAU),
            ]
        });
        let own = self.friction.problems(["viscous_friction", "coulomb_friction", "static_friction"]);
        let of_load = ["load_viscous_friction", "load_coulomb_friction", "load_static_friction"];
        let bodies = [
            beyond("inertia", self.inertia, "kg*m^2", LIGHTEST, MOST),
            beyond("load_inertia", self.load.inertia, "kg*m^2", lightest, MOST),
            beyond("load_torque", self.load.torque, "Nm", -MOST, MOST),
            beyond("counts_per_turn", self.reading.counts_per_turn, "inc", 1.0, 4_294_967_296.0),
            beyond("noise", self.reading.noise, "inc", 0.0, MOST),
        ];
        let frictions = own.into_iter().chain(self.load.friction.problems(of_load));
        let all = bodies.into_iter().chain(frictions).chain(coupling.into_iter().flatten());
        all.chain(self.amplifier.problems()).flatten().collect()
    }
}

impl Amplifier {
    fn problems(&self) -> [Option<ModelError>; 7] {
        let dead_time = self.dead_time_ns;
        let around = [
            beyond("max_torque", self.limit, "times rated_torque", 1e-3, 1e3),
            (!(0..=SECOND).contains(&dead_time)).then_some(ModelError::DeadTime(dead_time)),
        ];
        let stage = match self.stage {
            Stage::Torque { rated, lag_ns } => [
                beyond("rated_torque", rated, "Nm", 1e-6, MOST),
                (!(0..=SECOND).contains(&lag_ns)).then_some(ModelError::TorqueLag(lag_ns)),
                None,
                None,
                None,
            ],
            Stage::Winding { voltage, resistance, inductance, torque_constant, back_emf } => [
                beyond("voltage", voltage, "V", 1e-3, MOST),
                beyond("resistance", resistance, "Ohm", 1e-6, MOST),
                beyond("inductance", inductance, "H", 0.0, 1e3),
                beyond("torque_constant", torque_constant, "Nm/A", 1e-9, MOST),
                beyond("back_emf", back_emf, "V*s/rad", 0.0, MOST),
            ],
        };
        let ([limit, dead_time], [a, b, c, d, e]) = (around, stage);
        [limit, dead_time, a, b, c, d, e]
    }
}

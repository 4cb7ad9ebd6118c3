//! Linear regions of a drive train, and its exact steps in each.
//!
//! Law      with the travel x, the velocities w and v of motor and load, their twist d and the acceleration a that the
//!          stage gives the motor: x' = w; w' = a - (spring d + damping d') - viscous w + held input; d' = w - v; v'
//!          likewise, driven by the coupling; a' = (u - a - drag w) / lag. A body at rest has velocity 0; an open
//!          coupling has neither spring nor damping. A step is the exponential of that system with its held inputs.
//!          Repeated halves of a step have steps of their own
//! Reads    the data of a motor
//! Writes   steps, by region and length
//! Refuses  nothing: the data have been checked

use super::data::{Coupling, MotorData};
use super::exponential::{Square, WIDTH, exponential};
use nalgebra::{SMatrix, SVector};

/// Number of states of a drive train.
pub(super) const STATES: usize = 5;
/// Angle of the motor in this cycle (rad).
pub(super) const TRAVEL: usize = 0;
/// Velocity of the motor (rad/s).
pub(super) const MOTOR: usize = 1;
/// Angle of the motor relative to the load, in units of 1 / pace (rad/s): so its equation has coefficients of the same
/// size as the others.
pub(super) const TWIST: usize = 2;
/// Velocity of the load (rad/s).
pub(super) const LOAD: usize = 3;
/// Torque of the stage divided by the inertia that it turns (rad/s^2).
pub(super) const DRIVE: usize = 4;
/// First of the inputs held over a step: setpoint of the stage, other effects on the motor and on the load (rad/s^2).
const ASKED: usize = 5;

/// Matrix from state and held inputs before a step to the state after it.
type Step = SMatrix<f64, STATES, WIDTH>;
/// The state.
pub(super) type Vector = SVector<f64, STATES>;
/// Held inputs: of the stage, of the motor, of the load (rad/s^2).
pub(super) type Held = SVector<f64, 3>;

/// Halvings of a step to find an event: 2^-30 of it is 1 ps of 1 ms.
const HALVINGS: u32 = 30;
/// Maximum angle of a vibration between two checks for events (rad).
const MAX_ANGLE_PER_CHECK: f64 = 0.5;
/// Maximum halvings of a cycle for that: 1024 checks.
const MAX_CHECK_HALVINGS: u32 = 10;

/// A region in which the equations are linear.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Region {
    /// Whether the coupling transmits.
    pub pressed: bool,
    /// Whether the motor is at rest.
    pub motor_stands: bool,
    /// Whether the load is at rest.
    pub load_stands: bool,
}

impl Region {
    const ALL: [Self; 8] = {
        let mut all = [Self { pressed: false, motor_stands: false, load_stands: false }; 8];
        let mut place = 0;
        while place < 8 {
            all[place] = Self { pressed: place & 1 != 0, motor_stands: place & 2 != 0, load_stands: place & 4 != 0 };
            place += 1;
        }
        all
    };

    fn place(self) -> usize {
        usize::from(self.pressed) | usize::from(self.motor_stands) << 1 | usize::from(self.load_stands) << 2
    }
}

/// Coefficients of the equations, divided by the inertia of motor and load.
#[derive(Clone, Copy, Debug)]
pub(super) struct Equations {
    /// Inertia that the stage turns (kg m^2).
    pub inertia: f64,
    /// Whether there is a load with a coupling.
    pub is_elastic: bool,
    /// Spring coefficients of motor and load (1/s^2).
    pub spring: [f64; 2],
    /// Damping coefficients of motor and load (1/s).
    pub damping: [f64; 2],
    /// Viscous friction of motor and load (1/s).
    pub viscous: [f64; 2],
    /// Frequency of the two masses against each other (rad/s); 1 without a coupling.
    pub pace: f64,
    /// Half the backlash (rad).
    pub half_gap: f64,
    /// Time constant of the stage (s).
    pub lag_s: f64,
    /// Loss of torque of the stage per velocity (1/s).
    pub drag: f64,
}

impl Equations {
    pub(super) fn new(data: &MotorData) -> Self {
        let (motor, load) = (data.inertia, data.load.inertia);
        let (friction, of_load) = (data.friction.viscous, data.load.friction.viscous);
        let is_elastic = data.coupling.is_some();
        let coupling = data.coupling.unwrap_or(Coupling { stiffness: 0.0, damping: 0.0, backlash: 0.0 });
        let inertia = if is_elastic { motor } else { motor + load };
        let over = |value: f64| if is_elastic { [value / motor, value / load] } else { [0.0; 2] };
        let spring = over(coupling.stiffness);
        Self {
            inertia,
            is_elastic,
            spring,
            damping: over(coupling.damping),
            viscous: if is_elastic {
                [friction / motor, of_load / load]
            } else {
                [(friction + of_load) / inertia, 0.0]
            },
            pace: if is_elastic { (spring[0] + spring[1]).sqrt() } else { 1.0 },
            half_gap: coupling.backlash / 2.0,
            lag_s: data.amplifier.stage.lag_s(),
            drag: data.amplifier.stage.drag() / inertia,
        }
    }

    /// Returns the fastest possible vibration (rad/s).
    fn fastest(&self) -> f64 {
        let electric = if self.lag_s > 0.0 { (self.drag / self.lag_s).sqrt() } else { 0.0 };
        electric.max(if self.is_elastic { self.pace } else { 0.0 })
    }

    /// Returns the matrix of the system with its held inputs.
    fn matrix(&self, region: Region) -> Square {
        let mut a = Square::zeros();
        if !region.motor_stands {
            a[(TRAVEL, MOTOR)] = 1.0;
            a[(MOTOR, MOTOR)] = -self.viscous[0];
            a[(MOTOR, ASKED + 1)] = 1.0;
            if self.lag_s > 0.0 {
                a[(MOTOR, DRIVE)] = 1.0;
            } else {
                a[(MOTOR, ASKED)] = 1.0;
                a[(MOTOR, MOTOR)] -= self.drag;
            }
        }
        if self.lag_s > 0.0 {
            a[(DRIVE, DRIVE)] = -1.0 / self.lag_s;
            a[(DRIVE, ASKED)] = 1.0 / self.lag_s;
            a[(DRIVE, MOTOR)] = -self.drag / self.lag_s;
        }
        if self.is_elastic {
            (a[(TWIST, MOTOR)], a[(TWIST, LOAD)]) = (self.pace, -self.pace);
            let [motor, load] = if region.pressed { [0, 1] } else { [2, 2] }.map(|body: usize| {
                [self.spring.get(body), self.damping.get(body)].map(|value| value.copied().unwrap_or(0.0))
            });
            if !region.motor_stands {
                a[(MOTOR, TWIST)] = -motor[0] / self.pace;
                a[(MOTOR, MOTOR)] -= motor[1];
                a[(MOTOR, LOAD)] = motor[1];
            }
            if !region.load_stands {
                a[(LOAD, TWIST)] = load[0] / self.pace;
                a[(LOAD, MOTOR)] = load[1];
                a[(LOAD, LOAD)] = -self.viscous[1] - load[1];
                a[(LOAD, ASKED + 2)] = 1.0;
            }
        }
        a
    }
}

/// Exact steps over a part of a cycle, by region: the part in equal pieces, and repeated halves of a piece.
#[derive(Clone, Debug)]
pub(super) struct RegionSteps {
    /// Steps by region; the shortest first, each twice as long as the previous one. Empty for a region that is never
    /// entered.
    steps: [Vec<Step>; 8],
    /// Number of pieces in the part.
    pub pieces: u32,
    /// Number of shortest steps per piece, a power of two.
    pub ticks: u32,
}

impl RegionSteps {
    /// Creates the steps over `duration_s` in the regions that are entered; halved if an event may happen within.
    pub(super) fn new(
        equations: &Equations,
        duration_s: f64,
        has_events: bool,
        enters: impl Fn(Region) -> bool,
    ) -> Self {
        let mut looks = 0;
        while has_events
            && looks < MAX_CHECK_HALVINGS
            && equations.fastest() * duration_s > MAX_ANGLE_PER_CHECK * f64::from(1 << looks)
        {
            looks += 1;
        }
        let (pieces, halvings) = (1_u32 << looks, if has_events { HALVINGS } else { 0 });
        let piece_s = duration_s / f64::from(pieces);
        let steps = Region::ALL.map(|region| {
            if duration_s <= 0.0 || !enters(region) {
                return Vec::new();
            }
            let matrix = equations.matrix(region);
            let over = |time: f64| exponential(&matrix, time).fixed_view::<STATES, WIDTH>(0, 0).into_owned();
            (0..=halvings).rev().map(|halved| over(piece_s / f64::from(1_u32 << halved))).collect()
        });
        Self { steps, pieces: if duration_s > 0.0 { pieces } else { 0 }, ticks: 1 << halvings }
    }

    /// Returns the state 2^`level` ticks later; unchanged if there is no such step.
    pub(super) fn step(&self, region: Region, level: u32, state: &Vector, held: &Held) -> Vector {
        let step = self.steps.get(region.place()).and_then(|steps| steps.get(level as usize));
        step.map_or(*state, |step| {
            step.fixed_columns::<STATES>(0) * state + step.fixed_columns::<{ WIDTH - STATES }>(STATES) * held
        })
    }
}

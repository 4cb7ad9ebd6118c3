//! The axes, with their true figures and the expected results of their loops.

use super::coupled::RandomAxis;
use super::simulator::{Axis, Mechanics};
use lineshaft_core::regulator::VelocityMethod;
use lineshaft_tune::{Dynamics, Law, Model, Resonance};
use std::f64::consts::TAU;

/// An axis and the loops to be tried on it.
pub(crate) struct TestAxis {
    pub(crate) name: &'static str,
    pub(crate) axis: Axis,
    pub(crate) loops: Vec<LoopCase>,
    /// Acceleration of its move (turns/s^2).
    pub(crate) acceleration: f64,
}

/// Loops, and the limits of their results.
pub(crate) struct LoopCase {
    pub(crate) law: Law,
    pub(crate) velocity: Option<VelocityMethod>,
    /// Overshoot of a step (%), settling time after a step and after a move (s).
    pub(crate) overshoot: f64,
    pub(crate) settling: f64,
}

/// Inertia of the motor (kg m^2).
const MOTOR: f64 = 2e-4;

/// Viscous friction (Nm s/rad).
const VISCOUS: f64 = 2e-3;

/// Static friction of a motor relative to its Coulomb friction.
const STICTION: f64 = 1.1;

/// Torque at full command (Nm).
const FULL: f64 = 2.0;

fn torque(ratio: f64, coulomb: f64, gravity: f64, spring: Option<(f64, f64)>) -> Mechanics {
    let (motor, load) = (MOTOR, ratio * MOTOR);
    Mechanics::Torque {
        full: FULL,
        motor,
        load,
        viscous: VISCOUS,
        coulomb,
        stiction: STICTION * coulomb,
        gravity,
        spring,
        play: 0.0,
        dragged: 0.0,
    }
}

fn axis(mechanics: Mechanics, encoder: f64, delay: f64) -> Axis {
    Axis { mechanics, encoder, cycle: 1e-3, delay, wired: 1.0, sees_load: false }
}

/// Returns stiffness and damping of a spring on which a motor and a load of that ratio oscillate with that frequency
/// and damping, without friction.
fn spring(ratio: f64, hz: f64, damping: f64) -> Option<(f64, f64)> {
    let reduced = MOTOR * ratio / (1.0 + ratio);
    let omega = TAU * hz;
    Some((reduced * omega * omega, 2.0 * damping * omega * reduced))
}

fn pid(timer: u32, overshoot: f64, settling: f64) -> LoopCase {
    LoopCase { law: Law::Pid { timer }, velocity: None, overshoot, settling }
}

fn cascade(law: Law, time: f64, overshoot: f64, settling: f64) -> LoopCase {
    LoopCase { law, velocity: Some(VelocityMethod::Filtered { time }), overshoot, settling }
}

pub(crate) fn all() -> Vec<TestAxis> {
    let rigid = |ratio, coulomb, gravity| axis(torque(ratio, coulomb, gravity, None), 8192.0, 2.5e-4);
    let usual = || {
        vec![
            pid(1, 20.0, 0.2),
            cascade(Law::Proportional, 0.001, 8.0, 0.1),
            cascade(Law::Pid { timer: 1 }, 0.001, 22.0, 0.12),
        ]
    };
    vec![
        TestAxis { name: "1:1", axis: rigid(1.0, 0.06, 0.0), loops: usual(), acceleration: 200.0 },
        TestAxis { name: "1:5", axis: rigid(5.0, 0.06, 0.0), loops: usual(), acceleration: 130.0 },
        TestAxis {
            name: "1:30",
            axis: rigid(30.0, 0.06, 0.0),
            loops: vec![pid(2, 30.0, 0.4), cascade(Law::Proportional, 0.003, 10.0, 0.2)],
            acceleration: 20.0,
        },
        TestAxis { name: "friction", axis: rigid(5.0, 0.5, 0.0), loops: usual(), acceleration: 100.0 },
        TestAxis { name: "vertical", axis: rigid(5.0, 0.06, 0.2), loops: usual(), acceleration: 100.0 },
        TestAxis {
            name: "elastic",
            axis: axis(torque(3.0, 0.06, 0.0, spring(3.0, 60.0, 0.03)), 8192.0, 2.5e-4),
            loops: vec![cascade(Law::Proportional, 0.01, 8.0, 0.6)],
            acceleration: 40.0,
        },
        TestAxis {
            name: "coarse",
            axis: axis(torque(5.0, 0.06, 0.0, None), 500.0, 2.5e-4),
            loops: vec![pid(4, 10.0, 0.15), cascade(Law::Proportional, 0.005, 10.0, 0.2)],
            acceleration: 100.0,
        },
        TestAxis {
            name: "velocity",
            axis: axis(Mechanics::Velocity { full: 300.0, lag: 6e-3 }, 2000.0, 1.5e-3),
            loops: vec![
                LoopCase { law: Law::Proportional, velocity: None, overshoot: 10.0, settling: 0.06 },
                pid(1, 20.0, 0.1),
                pid(4, 20.0, 0.1),
            ],
            acceleration: 200.0,
        },
    ]
}

/// Returns a motor and a load of that ratio on a coupling with half a degree of backlash, stiff beyond its flanks.
pub(crate) fn with_play(ratio: f64) -> Axis {
    let Mechanics::Torque { full, motor, load, viscous, coulomb, stiction, gravity, .. } =
        torque(ratio, 0.06, 0.0, None)
    else {
        unreachable!("torque makes a torque")
    };
    let (spring, play) = (spring(ratio, 150.0, 0.03), 0.5_f64.to_radians());
    let mechanics =
        Mechanics::Torque { full, motor, load, viscous, coulomb, stiction, gravity, spring, play, dragged: 0.0 };
    axis(mechanics, 8192.0, 2.5e-4)
}

/// Returns a motor and a load on a coupling with backlash, with random figures.
pub(crate) fn coupled(drawn: &RandomAxis) -> Axis {
    let mut axis = with_play(drawn.ratio);
    let inc = axis.encoder / TAU;
    axis.delay = drawn.delay * axis.cycle;
    let (hz, by) = drawn.coupling;
    if let Mechanics::Torque { coulomb, stiction, dragged, spring: flank, play, .. } = &mut axis.mechanics {
        (*coulomb, *stiction, *dragged) =
            (FULL * drawn.friction.0, STICTION * FULL * drawn.friction.0, FULL * drawn.friction.1);
        (*flank, *play) = (spring(drawn.ratio, hz, by), drawn.play / inc);
    }
    axis
}

impl Axis {
    /// Returns the true model, which has to be identified.
    pub(crate) fn truth(&self) -> Model {
        let inc = self.encoder / TAU;
        let dynamics = match self.mechanics {
            Mechanics::Velocity { full, lag } => {
                Dynamics::Velocity { gain: full * inc, time_constant: lag, offset: 0.0 }
            }
            Mechanics::Torque { full, motor, load, viscous, coulomb, gravity, spring, .. } => {
                let whole = motor + load;
                let resonance = spring.map(|(stiffness, damping)| {
                    let reduced = motor * load / whole;
                    let omega = (stiffness / reduced).sqrt();
                    // The motor has load/whole of the oscillation, squared by its inertia.
                    let of_motor = viscous / motor * load / whole;
                    let damping = (damping / reduced + of_motor) / (2.0 * omega);
                    Resonance { frequency: omega / TAU, damping, inertia_ratio: load / motor }
                });
                Dynamics::Effort {
                    acceleration: full / whole * inc,
                    viscous: viscous / whole,
                    coulomb: coulomb / whole * inc,
                    load: gravity / whole * inc,
                    resonance,
                }
            }
        };
        Model { cycle: self.cycle, delay: self.delay, dynamics }
    }
}

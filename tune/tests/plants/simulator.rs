//! Axes to be tuned, simulated independently of the crate: Runge-Kutta of fourth order in steps of 1/40 of a cycle.
//!
//! Inertias, torques and angles are those of a data sheet (kg m^2, Nm, rad); the encoder rounds down. Static friction
//! holds a body at rest until the torque exceeds it.

use lineshaft_core::position::Position;
use lineshaft_core::regulator::{Pid, PidInput, Proportional, VelocityEstimator, VelocityLoop};
use lineshaft_tune::{Excitation, ExcitationOutput, Loops, Permitted, PositionLaw, Record, Takes};
use std::f64::consts::TAU;

pub(crate) const STEPS: u32 = 40;

/// Mechanics of an axis.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Mechanics {
    /// A drive that follows velocities (rad/s at command 1) with a first-order lag (s).
    Velocity { full: f64, lag: f64 },
    /// A motor and its load.
    Torque {
        /// Torque at command 1 (Nm).
        full: f64,
        /// Inertia of the motor and of the load (kg m^2).
        motor: f64,
        load: f64,
        /// Viscous friction (Nm s/rad).
        viscous: f64,
        /// Coulomb friction, static friction and gravity (Nm).
        coulomb: f64,
        stiction: f64,
        gravity: f64,
        /// Stiffness (Nm/rad) and damping (Nm s/rad) between both; `None`: rigid.
        spring: Option<(f64, f64)>,
        /// Backlash of the spring, from flank to flank (rad).
        play: f64,
        /// Coulomb friction of the load on a spring (Nm).
        dragged: f64,
    },
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Axis {
    pub(crate) mechanics: Mechanics,
    /// Encoder increments per turn.
    pub(crate) encoder: f64,
    pub(crate) cycle: f64,
    /// Delay (s).
    pub(crate) delay: f64,
    /// 1, or -1 for inverted wiring; 0: commands have no effect.
    pub(crate) wired: f64,
    /// Whether the encoder is at the load on a spring, instead of the motor.
    pub(crate) sees_load: bool,
}

/// Coulomb friction of the load in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Drag {
    /// Torque against its motion (Nm).
    torque: f64,
    /// Whether it holds the load.
    holds: bool,
}

pub(crate) struct Simulator {
    pub(crate) axis: Axis,
    /// Angle and speed of the motor, angle and speed of the load.
    state: [f64; 4],
    commands: Vec<f64>,
    /// External torque (Nm).
    pub(crate) disturbance: f64,
}

impl Simulator {
    pub(crate) fn new(axis: Axis) -> Self {
        Self { axis, state: [0.0; 4], commands: Vec::new(), disturbance: 0.0 }
    }

    fn seen(&self) -> usize {
        if self.axis.sees_load { 2 } else { 0 }
    }

    /// Returns the position (inc), not rounded.
    pub(crate) fn place(&self) -> f64 {
        self.state[self.seen()] / TAU * self.axis.encoder
    }

    pub(crate) fn position(&self) -> i64 {
        self.place().floor() as i64
    }

    /// Returns the velocity (inc/s).
    pub(crate) fn velocity(&self) -> f64 {
        self.state[self.seen() + 1] / TAU * self.axis.encoder
    }

    fn command_at(&self, time: f64) -> f64 {
        let cycle = ((time - self.axis.delay) / self.axis.cycle + 1e-6).floor();
        if cycle < 0.0 { 0.0 } else { self.axis.wired * self.commands.get(cycle as usize).copied().unwrap_or(0.0) }
    }

    pub(crate) fn cycle(&mut self, command: f64) {
        let from = self.commands.len() as f64 * self.axis.cycle;
        self.commands.push(command);
        let h = self.axis.cycle / f64::from(STEPS);
        for step in 0..STEPS {
            // Commands change between two steps.
            let u = self.command_at(from + (f64::from(step) + 0.5) * h);
            self.step(u, h);
        }
    }

    fn step(&mut self, u: f64, h: f64) {
        let add = |a: [f64; 4], b: [f64; 4], by: f64| [0, 1, 2, 3].map(|i| a[i] + by * b[i]);
        // In a step friction has one direction, that at its beginning, or that of the torque.
        let pull = self.pull(self.state, u);
        let sense = if self.state[1] == 0.0 { pull.signum() } else { self.state[1].signum() };
        if self.state[1] == 0.0 && pull.abs() <= self.stiction() {
            let Mechanics::Torque { spring: Some(_), .. } = self.axis.mechanics else { return };
        }
        let held = self.state[1] == 0.0 && pull.abs() <= self.stiction();
        let load = self.drag(self.state);
        let slope = |x: [f64; 4]| self.slope(x, u, (sense, held), load);
        let a = slope(self.state);
        let b = slope(add(self.state, a, h / 2.0));
        let c = slope(add(self.state, b, h / 2.0));
        let d = slope(add(self.state, c, h));
        let sum = add(add(add(a, b, 2.0), c, 2.0), d, 1.0);
        let before = [self.state[1], self.state[3]];
        self.state = add(self.state, sum, h / 6.0);
        let turns = |before: f64, now: f64| before != 0.0 && before.signum() != now.signum();
        if self.stiction() > 0.0 && turns(before[0], self.state[1]) {
            self.state[1] = 0.0;
        }
        if load != Drag::default() && turns(before[1], self.state[3]) {
            self.state[3] = 0.0;
        }
    }

    /// Returns the Coulomb friction of the load, which has one direction in a step as well.
    fn drag(&self, x: [f64; 4]) -> Drag {
        let Mechanics::Torque { spring: Some(spring), play, dragged, .. } = self.axis.mechanics else {
            return Drag::default();
        };
        let pull = Self::twist(x, spring, play);
        let sense = if x[3] == 0.0 { pull.signum() } else { x[3].signum() };
        Drag { torque: dragged * sense, holds: dragged > 0.0 && x[3] == 0.0 && pull.abs() <= dragged }
    }

    fn stiction(&self) -> f64 {
        match self.axis.mechanics {
            Mechanics::Velocity { .. } => -1.0,
            Mechanics::Torque { stiction, .. } => stiction,
        }
    }

    /// Returns the torque of a spring with backlash for the angles and speeds of motor and load (Nm): zero between its
    /// flanks, and a flank can only push.
    fn twist(x: [f64; 4], spring: (f64, f64), play: f64) -> f64 {
        let twisted = x[0] - x[2];
        let beyond = twisted - twisted.clamp(-play / 2.0, play / 2.0);
        if play > 0.0 && beyond == 0.0 {
            return 0.0;
        }
        let torque = spring.0 * beyond + spring.1 * (x[1] - x[3]);
        if play > 0.0 && torque * beyond < 0.0 { 0.0 } else { torque }
    }

    /// Returns the torque on the motor without its Coulomb friction (Nm).
    fn pull(&self, x: [f64; 4], u: f64) -> f64 {
        match self.axis.mechanics {
            Mechanics::Velocity { .. } => u,
            Mechanics::Torque { full, viscous, gravity, spring, play, .. } => {
                let twist = spring.map_or(0.0, |spring| Self::twist(x, spring, play));
                full * u - viscous * x[1] - gravity - twist + self.disturbance
            }
        }
    }

    fn slope(&self, x: [f64; 4], u: f64, (sense, held): (f64, bool), drag: Drag) -> [f64; 4] {
        match self.axis.mechanics {
            Mechanics::Velocity { full, lag } => [x[1], (full * u - x[1]) / lag, 0.0, 0.0],
            Mechanics::Torque { motor, load, coulomb, spring, play, .. } => {
                let torque = self.pull(x, u) - coulomb * sense;
                let inertia = if spring.is_some() { motor } else { motor + load };
                let acceleration = if held { 0.0 } else { torque / inertia };
                let twist = spring.filter(|_| !drag.holds).map(|spring| Self::twist(x, spring, play));
                let other = twist.map_or(0.0, |twist| (twist - drag.torque) / load);
                [x[1], acceleration, x[3], other]
            }
        }
    }
}

/// Result of an excitation.
pub(crate) struct Excited {
    pub(crate) record: Record,
    pub(crate) end: ExcitationOutput,
    /// Largest position (inc) and velocity (inc/s).
    pub(crate) farthest: f64,
    pub(crate) fastest: f64,
    pub(crate) last: f64,
}

/// Excites an axis until the end; `disturbance` is the external torque in each cycle (Nm).
pub(crate) fn excite(axis: Axis, permitted: Permitted, disturbance: impl Fn(usize) -> f64) -> Excited {
    let mut simulator = Simulator::new(axis);
    let mut excitation = Excitation::new(permitted).expect("within the ranges");
    let mut record = Record::with_capacity(axis.cycle, permitted.takes, 20_000);
    let (mut farthest, mut fastest) = (0.0_f64, 0.0_f64);
    let (mut before, mut velocity) = (simulator.position(), 0.0);
    for k in 0..200_000 {
        let position = simulator.position();
        // The velocity as in a machine: from counts, and smoothed over some cycles.
        velocity += 0.3 * ((position - before) as f64 / axis.cycle - velocity);
        before = position;
        let drive = excitation.next(position as f64, velocity);
        let ExcitationOutput::Command(command) = drive else {
            return Excited { record, end: drive, farthest, fastest, last: simulator.place() };
        };
        assert!(command.abs() <= permitted.command + 1e-12, "{command}");
        record.push(command, position);
        simulator.disturbance = disturbance(k);
        simulator.cycle(command);
        farthest = farthest.max(simulator.place().abs());
        fastest = fastest.max(simulator.velocity().abs());
    }
    panic!("an excitation ends");
}

/// Two turns in both directions, 5 turns/s, half of the full command.
pub(crate) fn permitted(axis: &Axis) -> Permitted {
    let takes = match axis.mechanics {
        Mechanics::Velocity { .. } => Takes::Velocity,
        Mechanics::Torque { .. } => Takes::Effort,
    };
    Permitted {
        cycle: axis.cycle,
        takes,
        travel: 2.0 * axis.encoder,
        margin: 0.5 * axis.encoder,
        velocity: 5.0 * axis.encoder,
        command: 0.5,
        ramp: 1.0,
        duration: 6.0,
        seed: 1,
    }
}

/// Command position, its velocity and its acceleration (inc, s).
pub(crate) type Command = (f64, f64, f64);

/// Returns command and position (inc) of each cycle of an axis with the laws of the core.
pub(crate) fn run(axis: Axis, loops: &Loops, seconds: f64, command: impl Fn(f64) -> Command) -> Vec<(f64, f64)> {
    run_until(axis, loops, seconds, command, |_| false)
}

/// Returns the same until `is_over`, which is called once per second.
pub(crate) fn run_until(
    axis: Axis,
    loops: &Loops,
    seconds: f64,
    command: impl Fn(f64) -> Command,
    is_over: impl Fn(&[(f64, f64)]) -> bool,
) -> Vec<(f64, f64)> {
    let second = (1.0 / axis.cycle).round() as usize;
    let mut simulator = Simulator::new(axis);
    let (mut pid, mut inner) = (Pid::default(), VelocityLoop::default());
    let mut estimator =
        loops.velocity.map(|inner| VelocityEstimator::new(inner.method, axis.cycle).expect("as it was designed"));
    let mut way = Vec::new();
    for k in 0..(seconds / axis.cycle) as u32 {
        let (place, velocity, acceleration) = command(f64::from(k) * axis.cycle);
        let actual = simulator.position();
        way.push((place, simulator.place()));
        if way.len() % second == 0 && is_over(&way) {
            break;
        }
        let error = Position::from_f64(place) - Position::whole(actual);
        let asked = match loops.position {
            PositionLaw::Proportional { kv } => {
                let law = Proportional { gain: kv, max_velocity: loops.max_velocity };
                law.velocity(Position::from_f64(place), Position::whole(actual)) / loops.max_velocity
            }
            PositionLaw::Pid { gains, cycles } => {
                let velocity = velocity / loops.max_velocity;
                let acceleration = acceleration / loops.max_acceleration;
                pid.step(&gains, cycles, PidInput { error: error.to_f64(), velocity, acceleration })
            }
        };
        let output = match (loops.velocity, &mut estimator) {
            (Some(law), Some(estimator)) => {
                let seen = estimator.step(actual) / loops.max_velocity;
                inner.step(&law.gains, asked - seen)
            }
            _ => asked,
        };
        simulator.cycle(output);
    }
    way
}

/// A move with a trapezoid of the velocity, from 0.1 s on.
pub(crate) fn trapezoid(distance: f64, fastest: f64, acceleration: f64) -> impl Fn(f64) -> Command {
    let rising = fastest / acceleration;
    let end = rising + distance / fastest;
    move |time| {
        let t = (time - 0.1).clamp(0.0, end);
        let velocity = if time < 0.1 || t >= end {
            (0.0, 0.0)
        } else if t < rising {
            (acceleration * t, acceleration)
        } else if end - t < rising {
            (acceleration * (end - t), -acceleration)
        } else {
            (fastest, 0.0)
        };
        // The integral of the velocity.
        let up = t.min(rising);
        let down = (t - (end - rising)).max(0.0);
        let level = (t - rising).min(end - 2.0 * rising).max(0.0);
        let place = acceleration * up * up / 2.0 + fastest * level + fastest * down - acceleration * down * down / 2.0;
        (place, velocity.0, velocity.1)
    }
}

/// Returns overshoot (% of the distance), settling time after `end` (s), largest following error from 0.1 s on (inc).
pub(crate) fn figures(way: &[(f64, f64)], distance: f64, end: f64, window: f64, cycle: f64) -> (f64, Option<f64>, f64) {
    let most = way.iter().fold(0.0_f64, |most, (_, place)| most.max(*place));
    let last_out = way.iter().rposition(|(_, place)| (place - distance).abs() > window);
    let settled = last_out.filter(|last| last + 1 < way.len()).map(|last| ((last + 1) as f64 * cycle - end).max(0.0));
    let error = way.iter().skip((0.1 / cycle) as usize).fold(0.0_f64, |most, (c, p)| most.max((c - p).abs()));
    (100.0 * (most / distance - 1.0).max(0.0), settled, error)
}

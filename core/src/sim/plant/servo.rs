//! Motor as seen by its drive: from setpoints to counts.
//!
//! Law      a setpoint u as a fraction of the rated torque is limited, acts after its dead time, and turns the train;
//!          the encoder reads floor(angle * counts_per_turn / 2 pi + noise). The drive closes the loop of a velocity w*
//!          on the true velocity w of the motor, because its sampling is finer than a cycle: acceleration = b (w* - w +
//!          b' / 5 * sum of (w* - w) T), with b = 1 / (4 (1.5 T + dead time + lag)) for the inertia of the motor, b' =
//!          b times that over all inertia; the sum is held while it would only increase a limited setpoint
//! Reads    setpoints, velocities (inc/s)
//! Writes   counts, torque (per mille of the rated torque)
//! Refuses  nothing: the data have been checked, and a setpoint of NaN is 0
//! Source   contract section 3

use super::data::{Load, Motor, MotorData, Reading};
use super::train::{State, Train};
use crate::sim::marks::mix;
use crate::sim::motor::MAX_VELOCITY;
use std::collections::VecDeque;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Time constant of the loop of the drive, in dead times: 76 of 90 degrees of phase are left.
const LOOP_TIME_CONSTANT: f64 = 4.0;
/// Dead time of the loop in cycles: half a cycle for holding the setpoint, and one for its transfer.
const CYCLES: f64 = 1.5;
/// Ratio of the time constant of the integral to that of the loop: it costs 11 degrees.
const INTEGRAL_RATIO: f64 = 5.0;
/// Standard deviation of the mean of four numbers that are uniform in 0..1.
const DEVIATION: f64 = 0.144_337_567_297_406_43;

/// Conversion of the angle to counts.
#[derive(Clone, Copy, Debug)]
struct Encoder {
    reading: Reading,
    /// Fraction of a count after the last whole one, 0 to 1; 1 is a fraction that rounding has made whole.
    part: f64,
    /// Number of readings.
    readings: u64,
}

impl Encoder {
    fn counts(&self, angle: f64) -> f64 {
        angle * (self.reading.counts_per_turn / TAU)
    }

    /// Turns by an angle (rad). Returns the change in whole counts.
    fn turn(&mut self, angle: f64) -> i64 {
        let total = self.part + self.counts(angle);
        let whole = total.floor();
        self.part = total - whole;
        // The cast saturates.
        whole as i64
    }

    /// Returns the whole count at an angle from the present one, relative to the last whole count.
    fn at(&self, angle: f64) -> i64 {
        (self.part + self.counts(angle)).floor() as i64
    }

    /// Returns the deviation of the next reading from the whole count.
    fn read(&mut self) -> i64 {
        self.readings = self.readings.wrapping_add(1);
        if self.reading.noise == 0.0 {
            return 0;
        }
        let bits = mix(mix(self.reading.seed) ^ self.readings);
        let sum: u64 = [0, 16, 32, 48].map(|shift| bits >> shift & 0xFFFF).iter().sum();
        let mean = sum as f64 / (4.0 * 65_535.0);
        (self.part + self.reading.noise * (mean - 0.5) / DEVIATION).floor() as i64
    }
}

/// State of a motor.
#[derive(Clone, Debug)]
pub(in crate::sim) struct Servo {
    data: MotorData,
    inverted: bool,
    train: Arc<Train>,
    state: State,
    /// Setpoints in their dead time, oldest first; their number is constant.
    delayed_setpoints: VecDeque<f64>,
    encoder: Encoder,
    /// Integral of the loop of the drive (rad).
    sum: f64,
    cycle_ns: u64,
}

impl Servo {
    /// Creates a motor at rest.
    pub(in crate::sim) fn new(motor: Motor, cycle_ns: u64) -> Self {
        Self::with_weight(motor, 0.0, cycle_ns)
    }

    /// Creates a motor with an additional constant torque (N m).
    fn with_weight(Motor { data, inverted }: Motor, weight: f64, cycle_ns: u64) -> Self {
        let (cycle_ns, dead_ns) = (cycle_ns.max(1), data.amplifier.dead_time_ns.unsigned_abs());
        let load = Load { torque: data.load.torque + weight, ..data.load };
        let train = Train::new(&MotorData { load, ..data }, dead_ns % cycle_ns, cycle_ns);
        // The newest, those of whole cycles, and the previous one, which acts until the dead time has elapsed in the
        // cycle.
        let cycles = (dead_ns / cycle_ns) as usize + 2;
        // Room for one more setpoint during a step.
        let mut on_the_way = VecDeque::with_capacity(cycles + 1);
        on_the_way.resize(cycles, 0.0);
        let encoder = Encoder { reading: data.reading, part: 0.0, readings: 0 };
        Self {
            state: train.rest(),
            data,
            inverted,
            train: Arc::new(train),
            delayed_setpoints: on_the_way,
            encoder,
            sum: 0.0,
            cycle_ns,
        }
    }

    /// Attaches a weight at rest, with which the whole train falls with an acceleration (inc/s^2), and no other weight;
    /// not for use in the cycle.
    pub(in crate::sim) fn attach_weight(&mut self, acceleration: f64) {
        let Self { data, inverted, cycle_ns, .. } = *self;
        let weight = acceleration * TAU / data.reading.counts_per_turn * (data.inertia + data.load.inertia);
        *self = Self::with_weight(Motor { data, inverted }, weight, cycle_ns);
    }

    /// Stops at the present position.
    pub(in crate::sim) fn rest(&mut self) {
        self.state = self.train.rest();
        self.sum = 0.0;
        self.delayed_setpoints.iter_mut().for_each(|setpoint| *setpoint = 0.0);
    }

    /// Returns true if it turns against its setpoint.
    pub(in crate::sim) fn is_inverted(&self) -> bool {
        self.inverted
    }

    /// Returns true if the second encoder, which the axis reads, is at the load.
    pub(in crate::sim) fn reads_load(&self) -> bool {
        self.data.reading.at_load
    }

    /// Returns the acceleration of setpoint 1 (rad/s^2).
    fn full(&self) -> f64 {
        self.data.amplifier.stage.full() / self.train.inertia()
    }

    /// Executes one cycle with a setpoint. Returns the counts of the motor in it. A held shaft does not turn.
    pub(in crate::sim) fn step(&mut self, setpoint: f64, held: bool) -> i64 {
        let limit = self.data.amplifier.limit;
        let setpoint = if setpoint.is_finite() { setpoint.clamp(-limit, limit) } else { 0.0 };
        self.delayed_setpoints.push_back(setpoint);
        self.delayed_setpoints.pop_front();
        let old = self.delayed_setpoints.front().copied().unwrap_or(setpoint);
        let new = self.delayed_setpoints.get(1).copied().unwrap_or(setpoint);
        let full = self.full();
        let angle = self.train.cycle(&mut self.state, [old * full, new * full], held);
        self.encoder.turn(angle)
    }

    /// Returns the setpoint of the loop of the drive for a velocity (inc/s).
    pub(in crate::sim) fn velocity_setpoint(&mut self, velocity: f64) -> f64 {
        let (inertia, all) = (self.train.inertia(), self.data.inertia + self.data.load.inertia);
        let (cycle_s, amplifier) = (self.cycle_ns as f64 / 1e9, self.data.amplifier);
        let late = CYCLES * cycle_s + amplifier.dead_time_ns as f64 / 1e9 + amplifier.stage.lag_s();
        let bandwidth = 1.0 / (LOOP_TIME_CONSTANT * late);
        let slow = bandwidth * inertia / all / INTEGRAL_RATIO;
        let velocity = if velocity.is_finite() { velocity.clamp(-MAX_VELOCITY, MAX_VELOCITY) } else { 0.0 };
        let asked = velocity * TAU / self.data.reading.counts_per_turn;
        let error = asked - self.train.velocity(&self.state);
        let sum = self.sum + error * cycle_s;
        let setpoint = bandwidth * (error + slow * sum) / self.full();
        // The integral of a limited setpoint may only decrease.
        if setpoint.abs() <= amplifier.limit || error * setpoint < 0.0 {
            self.sum = sum;
        }
        setpoint
    }

    /// Resets the loop of the drive.
    pub(in crate::sim) fn reset_loop(&mut self) {
        self.sum = 0.0;
    }

    /// Returns the torque, per mille of the rated one; for a winding, of that of its voltage at rest.
    pub(in crate::sim) fn effort(&self) -> f64 {
        let asked = self.delayed_setpoints.get(1).copied().unwrap_or_default() * self.full();
        1000.0 * self.train.drive(&self.state, asked) / self.full()
    }

    /// Returns the present deviation of the encoder reading from the counts.
    pub(in crate::sim) fn read(&mut self) -> i64 {
        self.encoder.read()
    }

    /// Returns the position of an encoder at the load, relative to the whole count of the motor (inc of the motor).
    pub(in crate::sim) fn load(&self) -> i64 {
        self.encoder.at(-self.train.twist(&self.state))
    }
}

#[cfg(test)]
mod tests;

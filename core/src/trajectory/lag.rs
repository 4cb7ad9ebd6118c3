//! Lag of an axis behind straight segments, calculated from its limits before it moves.
//!
//! Law      e is the trajectory minus the command, v the velocity of the command, u that of the trajectory, a the
//!          largest acceleration, V the largest velocity while catching up. The axis accelerates by +a or -a to
//!          v = u + sign(e) sqrt(2 a |e|), within +-V, and stays on that until e = 0 and v = u. Before the end of a
//!          trajectory that ends with a straight segment it decelerates by a, so that it stops there. Time is
//!          continuous: the motion in whole cycles differs from this by a cycle or two

use super::{Begin, Trajectory};
use serde::{Deserialize, Serialize};

/// Steps in which a curved segment is approximated while an axis lags.
const STEPS: u32 = 8;
/// Largest number of times that an axis reaches the end: it may pass it and return.
const MOST_TURNS: u32 = 4;
/// Lags up to this value are rounding (inc).
const NEGLIGIBLE: f64 = 0.5;

/// Limits of a lagging axis.
#[derive(Clone, Copy, Debug)]
pub struct LagLimits {
    /// Largest velocity while catching up (inc/s).
    pub velocity: f64,
    /// Largest acceleration and deceleration (inc/s^2).
    pub acceleration: f64,
    /// Length of a cycle, in the time of the trajectory (s).
    pub cycle_s: f64,
}

impl LagLimits {
    /// Returns the limits in the time of a trajectory that is stretched by a factor.
    pub fn stretched(self, factor: f64) -> Self {
        Self {
            velocity: self.velocity * factor,
            acceleration: self.acceleration * factor * factor,
            cycle_s: self.cycle_s / factor,
        }
    }
}

/// A simulated axis on its track, at the end of the last evaluated segment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lag {
    /// Trajectory minus command (inc).
    lag: f64,
    /// Velocity of the command (inc/s).
    velocity: f64,
    /// Largest |lag| so far (inc).
    largest: f64,
    /// The point at which the segment with the largest lag ends.
    point: u32,
    /// The point at which the last moving segment ends.
    last: u32,
    /// Time after the last moving segment until the axis rests (s); none before that segment.
    late_s: Option<f64>,
}

impl Lag {
    /// Returns an axis at the start of a track.
    pub fn new(trajectory: &Trajectory, track: usize, begin: &Begin) -> Self {
        let stands = trajectory.demand(track).map_or(0, |demand| demand.stands);
        let last = stands.max(trajectory.point_ahead(begin.time_ns));
        Self { lag: 0.0, velocity: begin.motion.velocity, largest: 0.0, point: 0, last, late_s: None }
    }

    /// Returns the largest lag so far (inc), and the next point at that lag.
    pub fn largest(&self) -> (f64, u32) {
        (self.largest, self.point)
    }

    /// Returns the time from the last point of the trajectory until the axis rests there, in the time of the trajectory
    /// (s).
    pub fn time_after_end_s(&self, trajectory: &Trajectory) -> f64 {
        let holds =
            trajectory.times_ns.get(self.last as usize).map_or(0, |time| trajectory.end_ns().saturating_sub(*time));
        (self.late_s.unwrap_or(0.0) - holds as f64 / 1e9).max(0.0)
    }

    /// Follows a track through the segment that ends at a point. Returns the number of steps; none if nothing moves any
    /// more.
    pub fn follow(
        &mut self,
        trajectory: &Trajectory,
        (track, begin): (usize, &Begin),
        point: usize,
        limits: &LagLimits,
    ) -> Option<u32> {
        if point > self.last as usize {
            return None;
        }
        let (spline, since) = trajectory.segment(track, begin, point)?;
        let duration_ns = trajectory.times_ns.get(point).map_or(0, |time| time.saturating_sub(since));
        let seconds = duration_ns as f64 / 1e9;
        let (first, last) = spline.end_velocities();
        let is_last = point == self.last as usize;
        let before = self.largest;
        let mut steps = 1;
        let step = limits.acceleration * limits.cycle_s;
        let follows = self.lag.abs() <= NEGLIGIBLE && (first - self.velocity).abs() <= step;
        if spline.is_straight() && is_last && first.abs() > step {
            self.late_s = Some(self.arrive(first, seconds, limits));
        } else if follows {
            (self.lag, self.velocity) = (0.0, last);
        } else {
            steps = if spline.is_straight() { 1 } else { STEPS };
            let mut place = spline.at(0.0).position;
            for step in 1..=steps {
                let next = spline.at(duration_ns as f64 * f64::from(step) / f64::from(steps)).position;
                let seconds = seconds / f64::from(steps);
                self.catch_up((next - place).to_f64() / seconds, seconds, limits);
                place = next;
            }
        }
        if is_last && self.late_s.is_none() {
            self.late_s = Some(self.catch_up(0.0, f64::INFINITY, limits));
        }
        if self.largest > before {
            self.point = point as u32;
        }
        Some(steps)
    }

    /// Returns the velocity with which it closes its lag.
    fn closing(&self, limits: &LagLimits) -> f64 {
        libm::sqrt(2.0 * limits.acceleration * self.lag.abs()).copysign(self.lag)
    }

    /// Returns the accelerations with which the axis reaches a trajectory with velocity `u`, each with its duration.
    fn phases(&self, u: f64, limits: &LagLimits) -> [(f64, f64); 3] {
        let (a, top) = (limits.acceleration, limits.velocity);
        // Not `clamp`, which panics if an invalid state contains NaN.
        let sign = if self.velocity < (u + self.closing(limits)).max(-top).min(top) { 1.0 } else { -1.0 };
        // Signs are changed so that the axis has to accelerate.
        let (lag, u, from) = (self.lag * sign, u * sign, (self.velocity - u) * sign);
        let peak = libm::sqrt(((from * from + 2.0 * a * lag) / 2.0).max(0.0));
        let most = peak.min(top - u).max(from).max(0.0);
        let speeds_up = (most - from) / a;
        // Rest of the lag after acceleration and deceleration.
        let left = lag - (most * most - from * from) / (2.0 * a) - most * most / (2.0 * a);
        let cruises = if peak <= most || left <= 0.0 { 0.0 } else { left / most };
        [(a * sign, speeds_up), (0.0, cruises), (-a * sign, most / a)]
    }

    /// Follows a trajectory with velocity `u` (inc/s) for a time. Returns the time until the axis has caught up.
    fn catch_up(&mut self, u: f64, seconds: f64, limits: &LagLimits) -> f64 {
        let mut left = seconds;
        let phases = self.phases(u, limits);
        for (acceleration, time) in phases {
            let time = time.min(left);
            self.moves(u, acceleration, time);
            left -= time;
        }
        if left > 0.0 {
            (self.lag, self.velocity) = (0.0, u);
        }
        phases.iter().map(|(_, time)| time).sum()
    }

    /// Follows a trajectory with velocity `u` for a time, after which the trajectory stops abruptly. Returns the time
    /// from then until the axis rests there.
    fn arrive(&mut self, u: f64, seconds: f64, limits: &LagLimits) -> f64 {
        let (a, mut left) = (limits.acceleration, seconds);
        // An axis that reaches the end before the trajectory moves on to meet it.
        for _ in 0..MOST_TURNS {
            let passes = self.catch_up_to_end(u, &mut left, limits);
            let until = left.min(passes.unwrap_or((self.velocity / a).abs()));
            self.moves(u, -a.copysign(self.velocity), until);
            left -= until;
            if left <= 0.0 {
                break;
            }
        }
        self.catch_up(0.0, f64::INFINITY, limits)
    }

    /// Follows a trajectory with velocity `u` that stops abruptly after a time, until the axis has to decelerate for
    /// that. Returns the time until it passes the end, if it is too fast to stop there.
    fn catch_up_to_end(&mut self, u: f64, left: &mut f64, limits: &LagLimits) -> Option<f64> {
        let a = limits.acceleration;
        let rest = a * limits.cycle_s;
        let way = u * *left + self.lag;
        let sign = if way.abs() > NEGLIGIBLE {
            1.0_f64.copysign(way)
        } else {
            // At the end it moves away from it.
            let heading = if self.velocity.abs() > rest { self.velocity } else { u + self.closing(limits) };
            -1.0_f64.copysign(heading)
        };
        for (acceleration, time) in self.phases(u, limits).into_iter().chain([(0.0, f64::INFINITY)]) {
            let (speed, way) = (self.velocity * sign, (u * *left + self.lag) * sign);
            // Distance to the end beyond the stopping distance.
            let spare = way - speed * speed.abs() / (2.0 * a);
            if spare <= 0.0 && speed > rest {
                let passes = || (speed - libm::sqrt((speed * speed - 2.0 * a * way).max(0.0))) / a;
                return (spare < -NEGLIGIBLE).then(passes);
            }
            let spare = spare.max(0.0);
            let slows_down = match acceleration * sign {
                along if along > 0.0 => (libm::sqrt(speed.max(0.0) * speed.max(0.0) + a * spare) - speed) / a,
                along if along < 0.0 || speed <= 0.0 => f64::INFINITY,
                _ => spare / speed,
            };
            let time = time.min(slows_down).min(*left);
            self.moves(u, acceleration, time);
            *left -= time;
            if time == slows_down || *left <= 0.0 {
                break;
            }
        }
        None
    }

    /// Moves with an acceleration for a time, while the trajectory has velocity `u`.
    fn moves(&mut self, u: f64, acceleration: f64, seconds: f64) {
        let parts = u - self.velocity;
        let turn = parts / acceleration;
        if turn > 0.0 && turn < seconds {
            self.note(self.lag + parts * turn / 2.0);
        }
        self.lag += parts * seconds - acceleration * seconds * seconds / 2.0;
        self.velocity += acceleration * seconds;
        self.note(self.lag);
    }

    fn note(&mut self, lag: f64) {
        self.largest = self.largest.max(lag.abs());
    }
}

//! Checks of a trajectory for an axis before it begins: refusals, and rates that exceed the limits.
//!
//! Refuses  knots, paths, velocities, accelerations, steps of velocity and stops after the end beyond the limits of the
//!          axis, as for moves; a start too far away; a trajectory without time that ends elsewhere
//! Source   GRP-TRAJ-10, GRP-TRAJ-11

use crate::axis::state::planned_motion::ROUNDING;
use crate::axis::state::run::{Run, place};
use crate::axis::state::{Axis, Excess};
use crate::code::Code;
use crate::event::{Number, Refusal, TrajectoryPlace};
use crate::parameter::Row;
use crate::position::Position;
use crate::profile::{self, Motion};
use crate::trajectory::{Begin, Peaks, Reach, Trajectory};

/// Share by which rounding may put a rate beyond its limit.
const SLACK: f64 = 1e-9;

impl Axis {
    /// Checks whether the axis may follow that track of a trajectory, from its motion in the cycle of the begin,
    /// without its rates.
    ///
    /// # Errors
    /// Its state or its limits do not allow it.
    pub fn check_track(&self, from: Motion, run: &Run, track: usize) -> Result<(), Refusal> {
        self.check_closed_loop()?;
        self.check_free()?;
        self.check_ends_here(from, run, track)?;
        let trajectory = &run.trajectory;
        let refuse = || Refusal::new(Code::BAD_REQUEST, self.object());
        let demand = trajectory.demand(track).ok_or_else(refuse)?;
        let shift = self.shift(from, run, track);
        self.check_start(from.position - shift, run, track)?;
        for (knot, point) in [(demand.lowest, demand.peaks.lowest), (demand.highest, demand.peaks.highest)] {
            let at_point = |refusal| Refusal { place: Some(place(trajectory, point)), ..refusal };
            self.check_target(knot + shift, &self.parameters).map_err(at_point)?;
        }
        let begin = self.takes_over(from, run, track).position + shift;
        for (reach, peaks) in self.reaches(from, run, track).into_iter().flatten() {
            self.check_track_positions(trajectory, (&reach, &peaks), begin)?;
        }
        Ok(())
    }

    /// Returns the rates of that track that exceed their limits by more than the margin.
    pub fn track_excesses(&self, from: Motion, run: &Run, track: usize) -> impl Iterator<Item = Excess> {
        let reaches = self.reaches(from, run, track).into_iter().flatten();
        reaches.flat_map(|(reach, peaks)| self.excesses(run, &run.stretch.real_reach(reach), &peaks)).flatten()
    }

    /// Returns the largest step of velocity of that track if it exceeds that of the axis in a cycle: the least lag of
    /// the axis (inc), and the refusal for a trajectory that must not lag.
    pub fn track_step(&self, from: Motion, run: &Run, track: usize) -> Option<(f64, Refusal)> {
        let trajectory = &run.trajectory;
        // Points within the first cycle may be in the past, too.
        let is_ahead = |step: &(f64, u32)| step.1 >= trajectory.point_ahead(run.begin_ns);
        let steps = self.steps(from, run, track)?.into_iter().filter(is_ahead);
        let (step, point) = steps.max_by(|one, other| one.0.total_cmp(&other.0))?;
        let (most, rate) = self.most_step();
        // Differences of rounded velocities are not steps.
        if step.is_nan() || step <= most {
            return None;
        }
        let refusal = Refusal::new(Code::TRAJECTORY_STEP, self.object());
        let refusal = refusal.with(Number::Velocity(step), Number::Velocity(most));
        Some((step * step / (2.0 * rate), Refusal { place: Some(place(trajectory, point)), ..refusal }))
    }

    /// Whether no future step of that track exceeds that of the axis in a cycle.
    pub(in crate::axis) fn is_smooth(&self, from: Motion, run: &Run, track: usize) -> bool {
        let most = self.most_step().0;
        self.steps(from, run, track).is_some_and(|steps| steps.iter().all(|(step, _)| *step <= most))
    }

    /// Returns the largest change of velocity in a cycle (inc/s), and in a second (inc/s^2).
    pub(super) fn most_step(&self) -> (f64, f64) {
        let rate = self.parameters.max_acceleration.min(self.parameters.deceleration_limit());
        (rate * self.cycle_s(), rate)
    }

    /// Returns the steps of velocity at the begin of that track, at the first future point, and the largest one of the
    /// points after that (inc/s), with their points.
    fn steps(&self, from: Motion, run: &Run, track: usize) -> Option<[(f64, u32); 3]> {
        let trajectory = &run.trajectory;
        let demand = trajectory.demand(track)?;
        let motion = self.takes_over(from, run, track);
        let begin = Begin { motion, time_ns: run.begin_ns, shift: Position::ZERO };
        let first = trajectory
            .first_spline(track, &begin)
            .map_or((motion.velocity, motion.velocity), |spline| spline.end_velocities());
        let point = trajectory.point_ahead(run.begin_ns);
        let time_ns = trajectory.times_ns().get(point as usize).copied().unwrap_or(0);
        // After the last point it rests, or continues with the velocity of that point.
        let next = trajectory.given(track, time_ns).map_or(trajectory.end_velocity(track), |motion| motion.velocity);
        let (before, after) = ((first.0 - motion.velocity).abs(), (next - first.1).abs());
        let steps = [(before, point), (after, point), (demand.step, demand.peaks.step)];
        Some(steps.map(|(step, point)| (step / run.stretch.factor(), point)))
    }

    /// Returns the demands of that track in the time of the trajectory: from its first point on, and from the axis to
    /// the first future point.
    fn reaches(&self, from: Motion, run: &Run, track: usize) -> [Option<(Reach, Peaks)>; 2] {
        let shift = self.shift(from, run, track);
        let begin = Begin { motion: self.takes_over(from, run, track), time_ns: run.begin_ns, shift };
        let first = run.trajectory.first_spline(track, &begin).map(|spline| {
            let point = run.trajectory.point_ahead(run.begin_ns);
            (spline.reach().moved(shift), Peaks::at(point))
        });
        [run.trajectory.demand(track).map(|demand| (demand.way.moved(shift), demand.peaks)), first]
    }

    /// Returns the shift of that track: the whole turns that bring its first future point nearest to the axis
    /// (GRP-TRAJ-10).
    pub(in crate::axis) fn shift(&self, from: Motion, run: &Run, track: usize) -> Position {
        run.trajectory.shift(track, run.begin_ns, from.position, self.setup.modulo)
    }

    /// Checks that a track with a first point at time 0 begins near the command (GRP-TRAJ-11).
    fn check_start(&self, from: Position, run: &Run, track: usize) -> Result<(), Refusal> {
        let trajectory = &run.trajectory;
        let Some(of) = trajectory.tracks().get(track).filter(|_| trajectory.times_ns().first() == Some(&0)) else {
            return Ok(());
        };
        let Some((most, knot)) = of.start.zip(of.knots.first()) else { return Ok(()) };
        let off = (knot.position - from).to_f64().abs();
        if off <= most {
            return Ok(());
        }
        let number = |value: f64| Number::Position(value as i64);
        Err(Refusal::new(Code::TRAJECTORY_START, self.object()).with(number(off.ceil()), number(most.floor())))
    }

    /// Returns the motion with which that track takes over the axis, in the time of the trajectory and without its
    /// shift: that of its points if the axis is near it. The axis then removes the difference, such as the rounding of
    /// a measured position, during the motion. Otherwise the spline from the axis to the first future point would be
    /// checked, which is not part of the plan.
    pub(super) fn takes_over(&self, from: Motion, run: &Run, track: usize) -> Motion {
        self.takes_over_at(Motion { position: from.position - self.shift(from, run, track), ..from }, run, track)
    }

    /// As [`takes_over`](Self::takes_over), from a motion without the shift.
    pub(super) fn takes_over_at(&self, motion: Motion, run: &Run, track: usize) -> Motion {
        let is_near = |given: &Motion| {
            (given.position - motion.position).to_f64().abs() <= self.position_tolerance()
                && (run.stretch.real(*given).velocity - motion.velocity).abs() <= self.most_step().0
        };
        run.trajectory.given(track, run.begin_ns).filter(is_near).unwrap_or_else(|| run.stretch.planned(motion))
    }

    /// Returns the distance within which two positions count as the same (inc).
    pub(super) fn position_tolerance(&self) -> f64 {
        self.parameters.in_position_window.max(1) as f64
    }

    /// Checks that a trajectory without remaining time ends at the axis.
    fn check_ends_here(&self, from: Motion, run: &Run, track: usize) -> Result<(), Refusal> {
        let shift = self.shift(from, run, track);
        let Some(end) = run.trajectory.end(track, shift).filter(|_| run.trajectory.end_ns() <= run.begin_ns) else {
            return Ok(());
        };
        if !self.rests() {
            return Err(self.not_at_standstill());
        }
        if run.trajectory.end_velocity(track) != 0.0 {
            let number = |ns: u64| Number::Time(i64::try_from(ns).unwrap_or(i64::MAX));
            let refusal = Refusal::new(Code::TRAJECTORY_IN_THE_PAST, self.object());
            return Err(refusal.with(number(run.trajectory.end_ns()), number(run.begin_ns)));
        }
        let goal = run.trajectory.tracks().get(track).and_then(|track| track.goal.position);
        let most = goal.unwrap_or(self.position_tolerance());
        let off = |from: Position| (end - from).to_f64().abs();
        // A client that requests the present position may mean the commanded or the actual one.
        let off = off(self.command.position()).min(off(self.feedback.position()));
        if off > most {
            let number = |value: f64| Number::Position(value as i64);
            let refusal = Refusal::new(Code::TRAJECTORY_WITHOUT_TIME, self.object());
            return Err(refusal.with(number(off.ceil()), number(most.floor())));
        }
        Ok(())
    }

    /// Checks the positions of a track, and that it does not move backward if that is not allowed.
    fn check_track_positions(
        &self,
        trajectory: &Trajectory,
        (reach, peaks): (&Reach, &Peaks),
        from: Position,
    ) -> Result<(), Refusal> {
        let rounding = Position::from_f64(ROUNDING);
        let (low, high) = (Position::whole(self.limit(false)), Position::whole(self.limit(true)));
        let refuse = |code, asked, limit, point| {
            let refusal = Refusal::new(code, self.object()).with(Number::Position(asked), Number::Position(limit));
            Err(Refusal { place: Some(place(trajectory, point)), ..refusal })
        };
        if reach.high > high.max(from) + rounding {
            return refuse(Code::TRAJECTORY_ABOVE_MAX_POSITION, reach.high.ceil(), high.floor(), peaks.high);
        }
        if reach.low < low.min(from) - rounding {
            return refuse(Code::TRAJECTORY_BELOW_MIN_POSITION, reach.low.floor(), low.floor(), peaks.low);
        }
        if reach.slowest < -SLACK * self.parameters.max_velocity {
            self.check_forward(reach.slowest)?;
        }
        Ok(())
    }

    /// Returns the position at which an axis comes to rest after a track that ends with a velocity; none if the track
    /// ends at rest.
    pub(super) fn rest_after_end(&self, run: &Run, track: usize, shift: Position) -> Option<Position> {
        let trajectory = &run.trajectory;
        let (ends_with, slope) = (trajectory.end_velocity(track), trajectory.last_slope(track));
        let planned = if slope.abs() > ends_with.abs() { slope } else { ends_with };
        let velocity = planned / run.stretch.factor();
        let last = trajectory.tracks().get(track)?.knots.last()?.position + shift;
        // The stop begins in the first cycle that is not before the end.
        let cycle_ns = run.cycle_ns.max(1);
        let passed = velocity * ((cycle_ns - run.duration_ns() % cycle_ns) % cycle_ns) as f64 / 1e9;
        let stop = profile::stopping_distance(
            Motion { velocity, ..Motion::default() },
            &self.parameters.default_goal_limits(),
        );
        (ends_with != 0.0).then(|| last + Position::from_f64(passed + stop))
    }

    /// Checks that an axis whose track ends with a velocity can stop within its limits.
    ///
    /// # Errors
    /// It would stop beyond a limit.
    pub fn check_stop_after_end(&self, from: Motion, run: &Run, track: usize) -> Result<(), Refusal> {
        let Some(rest) = self.rest_after_end(run, track, self.shift(from, run, track)) else { return Ok(()) };
        let rounding = Position::from_f64(ROUNDING);
        let (low, high) = (self.limit(false), self.limit(true));
        let beyond = if rest > Position::whole(high) + rounding {
            Some((rest.ceil(), high))
        } else if rest < Position::whole(low) - rounding {
            Some((rest.floor(), low))
        } else {
            None
        };
        let refusal = Refusal::new(Code::TRAJECTORY_STOP_BEYOND_LIMIT, self.object());
        beyond.map_or(Ok(()), |(rest, limit)| Err(refusal.with(Number::Position(rest), Number::Position(limit))))
    }

    /// Returns velocity, acceleration and deceleration if they exceed their limits by more than the margin.
    fn excesses(&self, run: &Run, reach: &Reach, peaks: &Peaks) -> [Option<Excess>; 3] {
        const VELOCITY: u16 = Row::place("max_velocity");
        const ACCELERATION: u16 = Row::place("max_acceleration");
        const DECELERATION: u16 = Row::place("max_deceleration");
        let p = &self.parameters;
        let limits = run.trajectory.limits();
        let (speed, up, down) = (reach.speed(), reach.acceleration, reach.deceleration);
        let rates = [
            (Code::VELOCITY_TOO_HIGH, VELOCITY, (speed, p.max_velocity), peaks.speed),
            (Code::ACCELERATION_TOO_HIGH, ACCELERATION, (up, p.max_acceleration), peaks.acceleration),
            (Code::DECELERATION_TOO_HIGH, DECELERATION, (down, p.deceleration_limit()), peaks.deceleration),
        ];
        let excess = |(code, row, (asked, most), point): (Code, u16, (f64, f64), u32)| {
            if asked <= most * (1.0 + limits.margin.max(SLACK)) {
                return None;
            }
            let is_velocity = code == Code::VELOCITY_TOO_HIGH;
            let number = if is_velocity { Number::Velocity } else { Number::Acceleration };
            let factor = if is_velocity { asked / most } else { libm::sqrt(asked / most) };
            // NaN exceeds every limit.
            let factor = if factor.is_nan() { f64::INFINITY } else { factor };
            let place = TrajectoryPlace {
                stretch: factor * run.stretch.factor(),
                max_stretch: limits.most(),
                ..place(&run.trajectory, point)
            };
            let refusal = Refusal::new(code, self.object()).with(number(asked), number(most));
            Some(Excess { factor, refusal: Refusal { parameter: Some(row), place: Some(place), ..refusal } })
        };
        rates.map(excess)
    }
}

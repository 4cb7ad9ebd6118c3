//! The motion of a trajectory on an axis at any time (`query_state` of joint_trajectory_controller).
//!
//! Law      t = time of the machine - time of the cycle in which the trajectory begins, on the trajectory that covers
//!          it: its own, or the one that the axis follows until that begins. An axis at rest without trajectory returns
//!          its present position
//! Refuses  a time before the begin or after the last point; an axis in another motion, or during a stop
//! Source   joint_trajectory_controller of ros2_controllers (Jazzy)

use crate::axis::state::run::{Run, place};
use crate::axis::state::{Axis, Context};
use crate::code::Code;
use crate::event::{Event, Kind, Number, Refusal, Severity, TrajectoryPlace};
use crate::profile::Motion;

impl Axis {
    /// Answers a query for a time of the machine, which is the number of the cycle times its length.
    pub(in crate::axis) fn query_trajectory(
        &self,
        cx: &mut Context<'_>,
        sequence: u64,
        at_ns: u64,
    ) -> Result<(), Refusal> {
        let (motion, place) = self.trajectory_at(cx.runs, at_ns)?;
        let event = Event::new(Severity::Info, Kind::Accepted, self.object(), Code::NONE).of_command(sequence);
        let rates = (Number::Velocity(motion.velocity), Number::Acceleration(motion.acceleration));
        cx.events.push(Event { position: motion.position, place, ..event.with(rates.0, rates.1) });
        Ok(())
    }

    /// Returns its motion at that time, and the next point if it follows a trajectory then.
    fn trajectory_at(&self, runs: &[Option<Run>], at_ns: u64) -> Result<(Motion, Option<TrajectoryPlace>), Refusal> {
        if !self.has_track() || self.is_cancelled() {
            let stands = self.rests() && !self.has_track();
            let refusal = || self.refuse(Code::NO_TRAJECTORY);
            return stands.then(|| (self.resting(self.command.position()), None)).ok_or_else(refusal);
        }
        let mut outside = self.refuse(Code::NO_TRAJECTORY);
        // Its own trajectory comes first: the axis follows the one before only until that begins.
        for tracker in self.trackers() {
            let Some(run) = tracker.run(runs) else { continue };
            let elapsed = i128::from(at_ns) - i128::from(run.begins) * i128::from(run.cycle_ns);
            let lasts = run.duration_ns();
            if let Some(elapsed) = u64::try_from(elapsed).ok().filter(|elapsed| *elapsed <= lasts) {
                let ahead = run.trajectory.point_ahead(run.time_after(elapsed).ns);
                return Ok((tracker.motion_after(run, elapsed), Some(place(&run.trajectory, ahead))));
            }
            let ns = |time: i128| Number::Time(time.clamp(i64::MIN.into(), i64::MAX.into()) as i64);
            // From time 0 of the trajectory, which is up to a cycle before the cycle in which it begins.
            let since_start = i128::from(run.begin_ns);
            let (asked, last) = (ns(since_start + elapsed), ns(since_start + i128::from(lasts)));
            outside = self.refuse(Code::TRAJECTORY_OTHER_TIME).with(asked, last);
        }
        Err(outside)
    }
}

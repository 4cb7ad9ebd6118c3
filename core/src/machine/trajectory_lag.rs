//! Expected lag of the axes of a trajectory with straight segments, and expected delay of its end.
//!
//! Law      computed from the cycle in which the trajectory is accepted, with [`STEPS_PER_CYCLE`] steps per cycle for
//!          all trajectories together. Reported once: the largest lag of all axes, compared by the time that each axis
//!          needs for it at max_velocity, and the latest end

use super::Machine;
use crate::axis::{Axis, LagEstimate, LargestLag, Run, trajectory_place};
use crate::code::Code;
use crate::event::{Event, Kind, Number, Severity};
use crate::object::Object;
use crate::trajectory::Lag;

/// Number of segments, or of steps of curved segments, that are processed in one cycle.
pub(super) const STEPS_PER_CYCLE: u32 = 64;

/// Largest lag that is not reported (inc).
const NO_LAG: f64 = 0.5;

impl Machine {
    /// Continues the lag computation of a run, with the remaining steps of this cycle, and reports the result once it
    /// is complete.
    pub(super) fn estimate_lag(&mut self, slot: usize, left: &mut u32) {
        let Some(run) = self.state.runs.get_mut(slot).and_then(Option::as_mut) else { return };
        let Some(mut estimate) = run.lag.take() else { return };
        while *left > 0 {
            let Some(track) = run.trajectory.tracks().get(usize::from(estimate.track)) else {
                let event = event(run, &estimate);
                return event.into_iter().for_each(|event| self.events.push(event));
            };
            // The run ends because the axis has left it.
            let Some(axis) = self.state.axes.get(usize::from(track.axis)) else { return };
            let Some(more) = step(&mut estimate, axis, track.axis, run) else { return };
            *left = left.saturating_sub(more);
        }
        run.lag = Some(estimate);
    }
}

/// Processes the next segment of a track. Returns the number of steps used; `None` if the axis has left the run.
fn step(estimate: &mut LagEstimate, axis: &Axis, number: u16, run: &Run) -> Option<u32> {
    let (begin, limits) = axis.lag_of(run)?;
    let (trajectory, track) = (&run.trajectory, usize::from(estimate.track));
    let at_begin = || (Lag::new(trajectory, track, &begin), trajectory.point_ahead(run.begin_ns));
    let (mut lag, point) = estimate.at.unwrap_or_else(at_begin);
    if let Some(steps) = lag.follow(trajectory, (track, &begin), point as usize, &limits) {
        estimate.at = Some((lag, point.saturating_add(1)));
        return Some(steps);
    }
    let (largest, point) = lag.largest();
    let seconds = largest / limits.velocity;
    if largest > NO_LAG && estimate.largest.is_none_or(|other| seconds > other.seconds) {
        estimate.largest = Some(LargestLag { axis: number, lag: largest, seconds, point });
    }
    estimate.late_s = estimate.late_s.max(lag.time_after_end_s(trajectory));
    (estimate.track, estimate.at) = (estimate.track.saturating_add(1), None);
    Some(1)
}

/// Returns the report of a run whose tracks are all processed; `None` if no axis will lag.
fn event(run: &Run, estimate: &LagEstimate) -> Option<Event> {
    let LargestLag { axis, lag, point, .. } = estimate.largest?;
    // Rounded to whole microseconds.
    let late_ns = libm::round(estimate.late_s * run.stretch.factor() * 1e6) * 1e3;
    let event = Event::new(Severity::Info, Kind::Warning, Object::Axis(axis), Code::TRAJECTORY_LAG);
    let event =
        event.of_command(run.sequence).with(Number::Position(libm::round(lag) as i64), Number::Time(late_ns as i64));
    Some(Event { place: Some(trajectory_place(&run.trajectory, point)), ..event })
}

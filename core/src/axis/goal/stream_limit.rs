//! Streams of setpoints at a software limit.
//!
//! Law      with `jog_at_limit: stop` a stream that leads into a software limit ends at it, without an error. One event
//!          reports that, and no other one follows until the axis has left the limit, or a setpoint has led away from
//!          it; until then a setpoint that leads further into the limit has no effect
//! Reads    the setpoint and its refusal, the active plan, the limit that has stopped the axis
//! Writes   whether a stream has been reported at that limit
//! Source   contract section 3

use crate::axis::state::{Aim, Axis, Generator, PlannedMotion, planned_motion};
use crate::code::Code;
use crate::event::{Number, Refusal};
use crate::position::Position;
use crate::profile::{Limits, Motion};

impl Axis {
    /// Whether a software limit stops a stream without an error.
    pub(in crate::axis) fn stops_streams(&self) -> bool {
        self.parameters.supervision.jog_at_limit == 0
    }

    /// Whether a setpoint leads further into the software limit that has ended its stream. A setpoint that leads away
    /// clears that state.
    pub(super) fn is_held_at_limit(&mut self, velocity: f64, checked: &Result<bool, Refusal>) -> bool {
        let Some(up) = self.travel.at_limits().reported_stream().filter(|_| self.stops_streams()) else { return false };
        let is_away = if up { velocity < 0.0 } else { velocity > 0.0 };
        match checked {
            Ok(true) if is_away => {
                self.travel.at_limits_mut().forget_stream();
                false
            }
            Ok(true) if velocity == 0.0 => false,
            Ok(true) if self.streams() => self.ends_at_limit(up, velocity),
            Ok(true) => self.room(up, self.command.position()) <= self.rest_tolerance(),
            Ok(false) => false,
            Err(refusal) => is_software_limit(refusal) && !is_away,
        }
    }

    /// Notes that a setpoint is refused and reported: further setpoints into the same software limit are not reported.
    pub(super) fn note_refused_at_limit(&mut self, velocity: f64, refusal: &Refusal) {
        if self.stops_streams() && is_software_limit(refusal) {
            let up = velocity > 0.0;
            let room = self.room(up, self.command.position());
            self.travel.at_limits_mut().report_stream(up, room);
        }
    }

    /// Returns the motion of a stream that ends at a limit, with the requested velocity; none if another motion is
    /// active, or the motion would pass the limit.
    pub(in crate::axis) fn stream_to_limit(&self, cycle: u64, before: Motion, up: bool) -> Option<PlannedMotion> {
        let Generator::Plan(PlannedMotion { aim: Aim::Velocity(asked), limits, .. }) = self.motion.generator() else {
            return None;
        };
        let is_towards = if up { *asked > 0.0 } else { *asked < 0.0 };
        if !is_towards || !self.streams() || !self.stops_streams() || self.coupling.overlay().is_some() {
            return None;
        }
        let limit = Position::whole(self.limit(up));
        let limits = Limits { velocity: asked.abs(), acceleration: limits.acceleration, ..self.stop_limits() };
        let course = self.course(cycle, before, Aim::Target(limit), limits);
        let (low, high) = course.extent_from(before.position);
        let end = if up { high } else { low };
        ((end - limit).to_f64().abs() <= planned_motion::ROUNDING).then_some(course)
    }

    /// Whether the active motion ends at a limit, either with any velocity (inc/s) of the stream, or with this one.
    fn ends_at_limit(&self, up: bool, asked: f64) -> bool {
        let Generator::Plan(course) = self.motion.generator() else { return false };
        let is_asked = course.aim == Aim::Stop || course.limits.velocity == asked.abs();
        is_asked
            && course.end_velocity() == 0.0
            && self.room(up, course.end()) <= Position::from_f64(planned_motion::ROUNDING)
    }
}

/// Whether a velocity leads further into a software limit. A limit switch has no position.
fn is_software_limit(refusal: &Refusal) -> bool {
    refusal.code == Code::LIMIT_VIOLATION && refusal.limit != Number::None
}

//! State of an axis at its software limits.

use crate::position::Position;
use serde::{Deserialize, Serialize};

/// State of a following axis that is beyond a software limit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct Beyond {
    /// Cycle in which it was last found there.
    pub(in crate::axis) cycle: u64,
    /// Whether it is beyond the upper limit.
    pub(in crate::axis) up: bool,
    /// Position nearest to the limit since it has been beyond it without interruption.
    pub(in crate::axis) inmost: Position,
}

/// The software limit that has stopped an axis, until the axis leaves it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct Stopped {
    /// Whether it is the upper limit.
    pub(in crate::axis) up: bool,
    /// Distance from the end of the stop to the limit. At a larger distance the axis has left the limit.
    pub(in crate::axis) room: Position,
    /// Whether the stop was an error: a new attempt is error 98.
    pub(in crate::axis) is_error: bool,
    /// Whether an event has reported that a stream ends here.
    pub(in crate::axis) is_told: bool,
}

/// State of an axis at the software limits, until it leaves them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct AtLimits {
    /// Set while a following axis is beyond a limit.
    pub(in crate::axis) beyond: Option<Beyond>,
    /// The limit that has stopped the axis.
    pub(in crate::axis) stopped: Option<Stopped>,
}

impl AtLimits {
    /// Whether the axis is not known to be beyond a limit.
    #[inline]
    pub(in crate::axis) fn is_within(&self) -> bool {
        self.beyond.is_none()
    }

    /// Whether no limit has stopped it.
    #[inline]
    pub(in crate::axis) fn is_free(&self) -> bool {
        self.stopped.is_none()
    }

    /// Increases all positions by `by`, those of the limits, too.
    pub(in crate::axis) fn shift(&mut self, by: Position) {
        self.beyond = self.beyond.map(|beyond| Beyond { inmost: beyond.inmost + by, ..beyond });
    }

    /// Notes that the axis is within the limits in this cycle.
    #[inline]
    pub(in crate::axis) fn note_within(&mut self) {
        self.beyond = None;
    }

    /// Returns the limit that has stopped it in a direction.
    pub(in crate::axis) fn stopped_at(&self, up: bool) -> Option<Stopped> {
        self.stopped.filter(|stopped| stopped.up == up)
    }

    /// Returns the limit at which an event has reported that a stream ends: true for the upper one.
    pub(in crate::axis) fn reported_stream(&self) -> Option<bool> {
        self.stopped.filter(|stopped| stopped.is_told).map(|stopped| stopped.up)
    }

    /// Notes that an event reports that a stream ends at this limit, with the axis `room` away from it. An error at the
    /// limit remains one.
    pub(in crate::axis) fn report_stream(&mut self, up: bool, room: Position) {
        let new = Stopped { up, room, is_error: false, is_told: true };
        self.stopped = Some(self.stopped_at(up).map_or(new, |stopped| Stopped { is_told: true, ..stopped }));
    }

    /// Notes that a stream leads away from the limit: the next stream into it is reported again.
    pub(in crate::axis) fn forget_stream(&mut self) {
        self.stopped =
            self.stopped.filter(|stopped| stopped.is_error).map(|stopped| Stopped { is_told: false, ..stopped });
    }
}

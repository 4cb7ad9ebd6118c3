//! State of the drive of an axis in this cycle.
//!
//! Law      a drive that is offline counts as not ready to switch on; one without new data for longer than its setup
//!          allows fails
//! Reads    the inputs of the drive
//! Source   CiA 402 (statusword, modes of operation display)

use crate::code::Code;
use crate::drive::{BusState, DriveInput, DriveState, STATUS_WARNING};
use serde::{Deserialize, Serialize};

/// Tolerated cycles without new data from a drive, if not configured.
pub const MISSED_CYCLES: u32 = 10;

/// State of the drive.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) struct DriveShown {
    state: DriveState,
    /// Status bit 7.
    warning: bool,
    /// Mode of operation.
    mode: i8,
    stale_cycles: u32,
    /// Effort in the direction of the axis.
    effort: f64,
}

impl DriveShown {
    /// Returns the state before the first reading. The drive of a virtual axis is always enabled.
    pub(in crate::axis) fn new(is_virtual: bool) -> Self {
        let state = if is_virtual { DriveState::Enabled } else { DriveState::NotReady };
        Self { state, warning: false, mode: 0, stale_cycles: 0, effort: 0.0 }
    }

    /// Reads the drive; `effort` is that of the inputs in the direction of the axis.
    pub(in crate::axis) fn read(&mut self, input: &DriveInput, effort: f64) {
        *self = Self {
            state: if input.online { DriveState::from_status(input.status) } else { DriveState::NotReady },
            warning: input.online && input.status & STATUS_WARNING != 0,
            mode: input.mode,
            stale_cycles: if input.fresh { 0 } else { self.stale_cycles.saturating_add(1) },
            effort,
        };
    }

    /// As [`read`](Self::read), if only the effort can have changed.
    #[inline]
    pub(in crate::axis) fn read_effort(&mut self, effort: f64) {
        self.effort = effort;
    }

    #[inline]
    pub(in crate::axis) fn state(&self) -> DriveState {
        self.state
    }

    pub(in crate::axis) fn warns(&self) -> bool {
        self.warning
    }

    pub(in crate::axis) fn mode(&self) -> i8 {
        self.mode
    }

    #[inline]
    pub(in crate::axis) fn effort(&self) -> f64 {
        self.effort
    }

    /// Whether it has new data in this cycle.
    pub(in crate::axis) fn is_fresh(&self) -> bool {
        self.stale_cycles == 0
    }

    /// Whether it has no new data in this cycle, but not for more than `missed_cycles` cycles.
    pub(in crate::axis) fn is_awaited(&self, missed_cycles: u32) -> bool {
        (1..=missed_cycles).contains(&self.stale_cycles)
    }

    pub(in crate::axis) fn is_in_fault(&self) -> bool {
        matches!(self.state, DriveState::Fault | DriveState::FaultReaction)
    }

    /// Whether its motor may have power.
    pub(in crate::axis) fn may_run(&self) -> bool {
        matches!(self.state, DriveState::Enabled | DriveState::QuickStop | DriveState::FaultReaction)
    }

    /// Returns the code of the failure that prevents motion, by the inputs of this cycle and the tolerated cycles
    /// without new data.
    pub(in crate::axis) fn failure(&self, input: &DriveInput, missed_cycles: u32) -> Option<Code> {
        match () {
            () if input.bus == BusState::Off => Some(Code::BUS_ERROR),
            () if !input.online => Some(Code::DRIVE_LOST),
            () if self.stale_cycles > missed_cycles => Some(Code::DRIVE_STALE),
            () if self.is_in_fault() => Some(Code::drive_fault(input.fault)),
            () => input.unacknowledged.then_some(Code::SETPOINT_NOT_ACKNOWLEDGED),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_is_awaited_for_some_cycles_and_fails_in_the_next_one() {
        for missed in [1, 10, 100] {
            fails_after(missed);
        }
    }

    fn fails_after(missed: u32) {
        let mut shown = DriveShown::new(false);
        let mut input = DriveInput { online: true, fresh: true, ..DriveInput::default() };
        shown.read(&input, 0.0);
        assert!(shown.is_fresh() && !shown.is_awaited(missed));
        input.fresh = false;
        for cycle in 1..=missed + 1 {
            shown.read(&input, 0.0);
            let failure = (cycle > missed).then_some(Code::DRIVE_STALE);
            assert_eq!(
                (shown.failure(&input, missed), shown.is_awaited(missed)),
                (failure, cycle <= missed),
                "{cycle}"
            );
        }
        input.fresh = true;
        shown.read(&input, 0.0);
        assert_eq!((shown.failure(&input, missed), shown.is_fresh()), (None, true));
    }
}

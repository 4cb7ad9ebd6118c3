//! What the drive of an axis shows in this cycle.
//!
//! Law      a drive that is not there shows that it is not ready; one that has told nothing new for longer than
//!          its setup allows fails
//! Reads    the inputs of the drive
//! Source   CiA 402 (statusword, modes of operation display)

use crate::code::Code;
use crate::drive::{BusState, DriveInput, DriveState, STATUS_WARNING};
use serde::{Deserialize, Serialize};

/// Cycles without new data from a drive that are waited for, where nobody says how many.
pub const MISSED_CYCLES: u32 = 10;

/// What the drive shows.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct DriveShown {
    state: DriveState,
    /// Status bit 7.
    warning: bool,
    /// Mode of operation.
    mode: i8,
    stale_cycles: u32,
    /// In the user's sense.
    effort: f64,
}

impl DriveShown {
    /// Before anything was read; a virtual axis has a drive that is always on.
    pub(super) fn new(is_virtual: bool) -> Self {
        let state = if is_virtual { DriveState::Enabled } else { DriveState::NotReady };
        Self { state, warning: false, mode: 0, stale_cycles: 0, effort: 0.0 }
    }

    /// Reads the drive; `effort` is that of the inputs in the user's sense.
    pub(super) fn read(&mut self, input: &DriveInput, effort: f64) {
        *self = Self {
            state: if input.online { DriveState::from_status(input.status) } else { DriveState::NotReady },
            warning: input.online && input.status & STATUS_WARNING != 0,
            mode: input.mode,
            stale_cycles: if input.fresh { 0 } else { self.stale_cycles.saturating_add(1) },
            effort,
        };
    }

    /// As [`read`](Self::read), where nothing but the effort can be another one.
    #[inline]
    pub(super) fn read_effort(&mut self, effort: f64) {
        self.effort = effort;
    }

    #[inline]
    pub(super) fn state(&self) -> DriveState {
        self.state
    }

    pub(super) fn warns(&self) -> bool {
        self.warning
    }

    pub(super) fn mode(&self) -> i8 {
        self.mode
    }

    #[inline]
    pub(super) fn effort(&self) -> f64 {
        self.effort
    }

    /// Has it told something new in this cycle?
    pub(super) fn is_fresh(&self) -> bool {
        self.stale_cycles == 0
    }

    /// Has it told nothing new in this cycle, and does it still count as there, for so many cycles?
    pub(super) fn is_awaited(&self, missed_cycles: u32) -> bool {
        (1..=missed_cycles).contains(&self.stale_cycles)
    }

    pub(super) fn is_in_fault(&self) -> bool {
        matches!(self.state, DriveState::Fault | DriveState::FaultReaction)
    }

    /// May its motor have voltage?
    pub(super) fn may_run(&self) -> bool {
        matches!(self.state, DriveState::Enabled | DriveState::QuickStop | DriveState::FaultReaction)
    }

    /// What of it keeps an axis from moving, by these inputs of this cycle; so many cycles without new data are waited for.
    pub(super) fn failure(&self, input: &DriveInput, missed_cycles: u32) -> Option<Code> {
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
            fails_behind(missed);
        }
    }

    fn fails_behind(missed: u32) {
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

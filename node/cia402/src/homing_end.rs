//! End of homing in a drive whose mode of operation is written by SDO.
//!
//! Law      with 6060h in a PDO the drive leaves mode homing in the cycle in which the axis commands its own mode again. By SDO this takes
//!          several cycles. The axis could already move in these cycles, and the drive would then jump to its position. Therefore the drive
//!          is first returned to its cyclic mode, and only then homing attained is reported to the axis. The axis commands no motion before
//!          that
//! Reads    whether the drive has attained a new zero, the status word
//! Writes   the mode to be commanded; mode and status word as the axis sees them
//! Refuses  a drive that does not return to its cyclic mode: a homing error is reported
//! Source   CiA 402-2 (mode homing, bits 10, 12, 13 of 6041h)

use lineshaft_core::drive::{MODE_HOMING, STATUS_HOMING_ATTAINED, STATUS_HOMING_ERROR, STATUS_TARGET_REACHED};

/// Bits that together report a successful homing.
const HOMED: u16 = STATUS_HOMING_ATTAINED | STATUS_TARGET_REACHED;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Stage {
    /// There is no new zero.
    #[default]
    None,
    /// The drive has a new zero and may still move.
    Attained,
    /// The drive has stopped and is being returned to its cyclic mode; number of cycles since then.
    Returns(u32),
    /// The drive is in its cyclic mode.
    Over,
    /// The drive did not return to its cyclic mode.
    Failed,
}

/// State of the end of homing.
#[derive(Clone, Copy, Debug)]
pub struct HomingEnd {
    is_used: bool,
    most_cycles: u32,
    /// Number of cycles after which a homing method without motion has set its zero.
    method_without_motion_cycles: u32,
    /// Number of cycles since such a method was started; 0: none was started.
    instant: u32,
    stage: Stage,
}

impl HomingEnd {
    /// Creates the state without homing. `is_used`: the mode is written by SDO. The drive has `most_cycles` to return to its cyclic mode. A
    /// method without motion has set its zero after `instant_cycles`.
    pub fn new(is_used: bool, most_cycles: u32, instant_cycles: u32) -> Self {
        Self { is_used, most_cycles, method_without_motion_cycles: instant_cycles, instant: 0, stage: Stage::None }
    }

    /// Returns true if the mode is written by SDO, so that a drive in a mode other than that of the axis could jump.
    pub fn is_used(&self) -> bool {
        self.is_used
    }

    /// Clears the state of a homing.
    pub fn clear(&mut self) {
        (self.stage, self.instant) = (Stage::None, 0);
    }

    /// Counts a cycle in which a method without motion (35, 37) is started. The drive may still report the bits of an earlier homing. They
    /// are hidden at first and count after `instant_cycles`.
    pub fn count_method_without_motion(&mut self) {
        if self.is_used && self.stage == Stage::None {
            self.instant = self.instant.saturating_add(1);
            if self.instant > self.method_without_motion_cycles {
                self.stage = Stage::Attained;
            }
        }
    }

    /// Records that the drive reports a new zero while homing is commanded.
    pub fn record_zero(&mut self) {
        if self.is_used && self.stage == Stage::None {
            self.stage = Stage::Attained;
        }
    }

    /// Returns the mode to be commanded: the cyclic mode instead of homing, once the drive has stopped at its zero. `starts`: the axis
    /// commands homing, with the start bit.
    pub fn command(&mut self, mode: i8, cyclic: i8, starts: bool) -> i8 {
        if !starts {
            self.clear();
        }
        if self.is_pending() { cyclic } else { mode }
    }

    /// Updates the return to the cyclic mode in this cycle.
    pub fn update_return(&mut self, is_settled: bool, is_refused: bool) {
        let Stage::Returns(cycles) = self.stage else { return };
        self.stage = match () {
            () if is_refused || cycles >= self.most_cycles => Stage::Failed,
            () if is_settled => Stage::Over,
            () => Stage::Returns(cycles.saturating_add(1)),
        };
    }

    /// Returns true if homing is finished in the drive, but not yet reported to the axis.
    pub fn is_pending(&self) -> bool {
        matches!(self.stage, Stage::Returns(_) | Stage::Over | Stage::Failed)
    }

    /// Returns mode (as the axis numbers it) and status word as the axis sees them.
    pub fn reported_state(&mut self, mode: i8, status: u16) -> (i8, u16) {
        if self.stage == Stage::Attained && status & HOMED == HOMED {
            self.stage = Stage::Returns(0);
        }
        let bare = status & !(HOMED | STATUS_HOMING_ERROR);
        match self.stage {
            Stage::None if self.instant > 0 => (mode, status & !HOMED),
            Stage::None | Stage::Attained => (mode, status),
            Stage::Returns(_) => (MODE_HOMING, bare),
            Stage::Over => (MODE_HOMING, bare | HOMED),
            Stage::Failed => (MODE_HOMING, bare | STATUS_HOMING_ERROR),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bits 10 and 12 are reported once the drive is in mode 8 again. Before that they are hidden, whatever they mean in that mode.
    #[test]
    fn homing_attained_is_reported_after_return_to_cyclic_mode() {
        let mut end = HomingEnd::new(true, 5, 3);
        assert_eq!((end.command(6, 8, true), end.reported_state(6, 0x0237)), (6, (6, 0x0237)));
        end.record_zero();
        assert_eq!((end.reported_state(6, 0x1237), end.command(6, 8, true)), ((6, 0x1237), 6), "it moves to its zero");
        assert_eq!((end.reported_state(6, 0x1637), end.command(6, 8, true)), ((6, 0x0237), 8));
        end.update_return(false, false);
        assert_eq!(end.reported_state(0, 0x1637), (6, 0x0237));
        end.update_return(true, false);
        assert_eq!((end.reported_state(8, 0x3237), end.command(6, 8, true)), ((6, 0x1637), 8));
        // The axis has its zero and commands its own mode.
        assert_eq!((end.command(8, 8, false), end.reported_state(8, 0x1237)), (8, (8, 0x1237)));
    }

    /// Bits 10 and 12 are still set from an earlier homing.
    #[test]
    fn method_without_motion_ends_in_cyclic_mode() {
        let mut end = HomingEnd::new(true, 5, 3);
        for cycle in 0..3 {
            end.count_method_without_motion();
            assert_eq!((end.command(6, 8, true), end.reported_state(6, 0x1637)), (6, (6, 0x0237)), "{cycle}");
        }
        end.count_method_without_motion();
        assert_eq!((end.reported_state(6, 0x1637), end.command(6, 8, true)), ((6, 0x0237), 8));
        end.update_return(true, false);
        assert_eq!(end.reported_state(8, 0x3237), (6, 0x1637));
    }

    #[test]
    fn drive_that_does_not_return_to_cyclic_mode_reports_homing_error() {
        for (cycles, is_refused) in [(1, true), (6, false)] {
            let mut end = HomingEnd::new(true, 5, 3);
            end.record_zero();
            for cycle in 0..cycles {
                assert_eq!(end.reported_state(6, 0x1637), (6, 0x0237), "{cycle}");
                end.update_return(false, is_refused);
            }
            assert_eq!((end.reported_state(6, 0x1637), end.command(6, 8, true)), ((6, 0x2237), 8));
            assert_eq!(end.command(6, 8, false), 6, "the next homing begins");
        }
    }

    /// 6060h in a PDO: the drive is in the mode of the axis at once.
    #[test]
    fn drive_with_mapped_mode_is_reported_without_delay() {
        let mut end = HomingEnd::new(false, 5, 3);
        end.record_zero();
        assert_eq!((end.reported_state(6, 0x1637), end.command(6, 8, true)), ((6, 0x1637), 6));
    }
}

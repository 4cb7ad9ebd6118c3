//! Homing that the drive executes itself.
//!
//! Law      mode 6 is commanded; once the drive has shown it for 50 ms, during which bit 4 is 0, bit 4 starts homing
//!          with the number of the method. In mode 6 the command follows the actual position, before and after it the
//!          command does not change. With bits 10 and 12 the zero of the drive is the reference; its counts start again
//!          (a new epoch). Bits of an earlier homing count only after the drive has cleared one of them, which it may
//!          do late, or has set its counts again. Only methods 35 and 37 take no time, and may leave the bits set. The
//!          axis is homed once the drive shows the mode of the axis again, so that it cannot jump after an axis that
//!          moves off at once. With interface torque, whose command follows the actual position, the axis is homed at
//!          once
//! Refuses  bit 13, mode 6 or the mode of the axis not shown in time, bits of an earlier homing not cleared in time, or
//!          a travel of more than homing.max_distance: an error. A drive that moves has begun and is not stopped by a
//!          timeout. Any other end of homing takes over the axis from its motion, in its own mode, and stops it
//! Source   CiA 402-2, homing mode: control word bit 4, status word bits 10, 12, 13

use super::super::{Axis, Context};
use super::{Run, Stage};
use crate::code::Code;
use crate::drive::{
    DriveOutput, HomingOrder, Interface, MODE_HOMING, Mode, STATUS_HOMING_ATTAINED, STATUS_HOMING_ERROR,
    STATUS_TARGET_REACHED, control, level_cycles,
};
use crate::event::Number;
use crate::position::Position;
use crate::profile::Motion;
use serde::{Deserialize, Serialize};

/// Time within which the drive must show mode 6, and then that homing has begun (ns).
const TIMEOUT_NS: u64 = 5_000_000_000;
/// Time after which a method without motion has finished (ns): bits that are still set then count.
const INSTANT_NS: u64 = 50_000_000;

/// Progress of homing in the drive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct InDrive {
    /// Cycle in which mode 6 was commanded, or bit 4 set.
    since: u64,
    /// Cycle since which the drive shows mode 6.
    shown_since: Option<u64>,
    /// Whether bit 4 is set.
    started: bool,
    /// Whether the drive has shown after that that it has begun.
    begun: bool,
    /// Status word of the cycle before.
    shown: u16,
    /// Epoch of its counts before the start.
    epoch: u32,
    /// Whether bit 13 has been set since before the start: it belongs to an earlier homing.
    old_error: bool,
    /// Cycle since which the drive has its reference and the mode of the axis is commanded again.
    returns: Option<u64>,
    /// Position of the axis at the start of homing.
    from: Position,
}

/// State of homing as shown by the drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shown {
    /// Homing is active.
    UnderWay,
    /// The reference is found, and the axis is at rest there.
    Done,
    /// Homing has failed.
    Failed,
    /// The drive does not show a start, and the time has elapsed.
    NoBegin,
}

/// Time since bit 4 was set, and how to read the status word.
#[derive(Clone, Copy, Debug)]
struct Since {
    /// Time since bit 4 was set (ns).
    time_ns: u64,
    /// Whether the process data of the drive may already respond to it.
    answers: bool,
    /// Whether the method takes no time.
    is_instant: bool,
}

impl InDrive {
    pub(super) fn since(cycle: u64, from: Position) -> Self {
        Self {
            since: cycle,
            shown_since: None,
            started: false,
            begun: false,
            shown: 0,
            epoch: 0,
            old_error: false,
            returns: None,
            from,
        }
    }

    /// Sets bit 4 from this cycle on.
    fn start(self, cycle: u64, (status, epoch): (u16, u32)) -> Self {
        let old_error = status & STATUS_HOMING_ERROR != 0;
        // If bit 12 is 0 now, it belongs to this homing once it is 1.
        let begun = status & STATUS_HOMING_ATTAINED == 0;
        Self { since: cycle, started: true, begun, shown: status, epoch, old_error, ..self }
    }

    /// Evaluates status word and epoch of a cycle after [`start`](Self::start).
    fn take(&mut self, (status, epoch): (u16, u32), since: Since) -> Shown {
        let shows = |bit: u16| status & bit != 0;
        let leaves_target = self.shown & STATUS_TARGET_REACHED != 0 && !shows(STATUS_TARGET_REACHED);
        self.begun |= !shows(STATUS_HOMING_ATTAINED) || since.answers && leaves_target || epoch != self.epoch;
        self.old_error &= shows(STATUS_HOMING_ERROR);
        self.shown = status;
        let is_late = since.time_ns > TIMEOUT_NS;
        if !since.answers {
            return Shown::UnderWay;
        }
        if shows(STATUS_HOMING_ERROR) {
            // It may fail at once, for the same reason as before.
            return if self.old_error && !is_late { Shown::UnderWay } else { Shown::Failed };
        }
        let counts = self.begun || since.is_instant && since.time_ns > INSTANT_NS;
        match shows(STATUS_HOMING_ATTAINED) && shows(STATUS_TARGET_REACHED) {
            true if counts => Shown::Done,
            _ if !self.begun && is_late => Shown::NoBegin,
            _ => Shown::UnderWay,
        }
    }
}

impl Axis {
    /// Sets the motion of a cycle in which the drive moves the axis: the position at which the outputs of this cycle
    /// reach it, so that it can be taken over from there.
    pub(in super::super) fn follow_drive(&mut self) {
        let is_returning =
            matches!(self.homing.run, Some(Run { stage: Stage::InDrive(drive), .. }) if drive.returns.is_some());
        if is_returning || self.drive_data.shown().mode() != MODE_HOMING {
            // In the mode of the axis the drive moves to its command: a command that followed the actual position would
            // keep it moving.
            self.command.rest_at(self.command.position());
        } else {
            let ahead = self.feedback.velocity() * self.cycle_s() * (self.delay() as f64 + 1.0);
            let place = Position::whole((self.feedback.position() + Position::from_f64(ahead)).nearest());
            self.command.execute(Motion { velocity: self.feedback.velocity(), ..Motion::at_rest(place) });
        }
        // The drive follows its own motion, so the following error is 0, also in the cycles until it follows the axis
        // again.
        self.supervision.follow(self.feedback.position().floor(), self.feedback.velocity() * self.cycle_s());
    }

    pub(super) fn watch_drive(&mut self, cx: &mut Context<'_>) {
        let Some((mut run, mut drive)) = self.homing.run.and_then(|run| match run.stage {
            Stage::InDrive(drive) => Some((run, drive)),
            _ => None,
        }) else {
            return;
        };
        let Some(input) = cx.input else { return };
        let gone = (self.feedback.position() - drive.from).nearest().saturating_abs();
        if let Some(most) = self.longest_search().filter(|most| gone > *most) {
            return self.fail_homing(cx, Code::HOMING_SWITCH_MISSED, Number::Position(gone), Number::Position(most));
        }
        if let Some(since) = drive.returns {
            if input.mode == self.setup.interface.mode().number() {
                return self.take_zero_of_drive(cx, input.count, run.offset);
            }
            if cx.cycle.saturating_sub(since).saturating_mul(self.setup.cycle_ns) > TIMEOUT_NS {
                self.fail_homing(cx, Code::HOMING_IN_DRIVE_TIMEOUT, Number::None, Number::None);
            }
            return;
        }
        let elapsed = cx.cycle.saturating_sub(drive.since);
        let time = elapsed.saturating_mul(self.setup.cycle_ns);
        if input.mode != MODE_HOMING {
            if time > TIMEOUT_NS || drive.started && elapsed > self.delay().saturating_add(1) {
                return self.fail_homing(cx, Code::HOMING_IN_DRIVE_TIMEOUT, Number::None, Number::None);
            }
            drive.shown_since = None;
            run.stage = Stage::InDrive(drive);
            self.homing.run = Some(run);
            return;
        }
        let shown_since = *drive.shown_since.get_or_insert(cx.cycle);
        let told = (input.status, input.epoch);
        if drive.started {
            let answers = elapsed > self.delay().saturating_add(1);
            match drive.take(told, Since { time_ns: time, answers, is_instant: matches!(run.method, 35 | 37) }) {
                Shown::Done if self.setup.interface == Interface::Torque => {
                    return self.take_zero_of_drive(cx, input.count, run.offset);
                }
                Shown::Done => {
                    drive.returns = Some(cx.cycle);
                    self.command.rest_at(self.command.position());
                }
                Shown::Failed => {
                    return self.fail_homing(cx, Code::HOMING_IN_DRIVE_FAILED, Number::None, Number::None);
                }
                Shown::NoBegin if !self.moves() => {
                    return self.fail_homing(cx, Code::HOMING_NOT_BEGUN, Number::None, Number::None);
                }
                Shown::NoBegin | Shown::UnderWay => {}
            }
        } else if cx.cycle.saturating_sub(shown_since) >= level_cycles(self.setup.cycle_ns) {
            // In mode 6 the drive has read bit 4 as 0, whatever it was in the mode before.
            drive = drive.start(cx.cycle, told);
        }
        run.stage = Stage::InDrive(drive);
        self.homing.run = Some(run);
    }

    /// Sets the zero where the drive counts 0, plus `offset`.
    fn take_zero_of_drive(&mut self, cx: &mut Context<'_>, count: i64, offset: i64) {
        let reference = self.feedback.position() - Position::whole(self.turn_counts(count));
        let zero = reference + Position::whole(offset);
        if !zero.is_legal() {
            let asked = Number::Position(zero.nearest());
            return self.fail_homing(cx, Code::POSITION_OUT_OF_RANGE, asked, Number::None);
        }
        self.take_zero(cx, zero);
    }

    /// Replaces the output to the drive during homing in the drive.
    pub(in super::super) fn ask_for_homing(&self, output: DriveOutput) -> DriveOutput {
        let Some(Run { method, speeds: [fast, _, slow], limits, stage: Stage::InDrive(drive), .. }) = self.homing.run
        else {
            return output;
        };
        if drive.returns.is_some() {
            return output;
        }
        let start = if drive.started { control::START_HOMING } else { 0 };
        let order = HomingOrder {
            // Numbers beyond those of CiA 402 are refused when homing begins.
            method: i8::try_from(method).unwrap_or(0),
            search_velocity: fast,
            zero_velocity: slow,
            acceleration: limits.acceleration,
        };
        DriveOutput {
            velocity: fast,
            acceleration: 0.0,
            control: output.control | start,
            mode: Mode::Homing(order),
            ..output
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ATTAINED: u16 = STATUS_HOMING_ATTAINED;
    const REACHED: u16 = STATUS_TARGET_REACHED;
    const ERROR: u16 = STATUS_HOMING_ERROR;

    /// Returns the result of status words, each from a time on (ms), the first one before bit 4 is set, and its time.
    fn homed(method: i64, words: &[(u64, u16)]) -> (Shown, u64) {
        let status = |ms: u64| words.iter().rev().find(|(from, _)| *from <= ms).map_or(0, |(_, status)| *status);
        let mut drive = InDrive::since(0, Position::ZERO).start(0, (status(0), 0));
        for ms in 1..20_000 {
            let since = Since { time_ns: ms * 1_000_000, answers: ms > 1, is_instant: matches!(method, 35 | 37) };
            let shown = drive.take((status(ms), 0), since);
            if shown != Shown::UnderWay {
                return (shown, ms);
            }
        }
        (Shown::UnderWay, 20_000)
    }

    /// CiA 402-2, homing mode: bits 12 and 10 are 0 during homing, and both 1 at its end.
    #[test]
    fn first_homing_ends_with_both_bits() {
        assert_eq!(homed(1, &[(0, REACHED), (3, 0), (900, ATTAINED), (950, ATTAINED | REACHED)]), (Shown::Done, 950));
        assert_eq!(homed(1, &[(0, REACHED), (3, 0), (900, ERROR)]), (Shown::Failed, 900));
    }

    /// Bits of the homing before stay set for 200 ms, or for 4 s: they do not count for this one.
    #[test]
    fn bits_that_are_cleared_late_are_not_the_end() {
        let both = ATTAINED | REACHED;
        for clears in [3, 200, 4_000] {
            assert_eq!(homed(1, &[(0, both), (clears, 0), (9_000, both)]), (Shown::Done, 9_000));
            assert_eq!(homed(1, &[(0, both), (clears, ATTAINED), (9_000, both)]), (Shown::Done, 9_000), "bit 10 alone");
            assert_eq!(homed(1, &[(0, both), (clears, REACHED), (9_000, both)]), (Shown::Done, 9_000), "bit 12 alone");
            assert_eq!(homed(1, &[(0, ERROR), (clears, 0), (9_000, both)]), (Shown::Done, 9_000), "the old error");
            assert_eq!(homed(1, &[(0, ERROR), (clears, 0), (9_000, ERROR)]), (Shown::Failed, 9_000));
        }
    }

    /// After the counts were set again, the bits belong to this homing, even if a change of the bits was not seen.
    #[test]
    fn constant_bits_count_after_the_counts_were_reset() {
        let both = ATTAINED | REACHED;
        let mut drive = InDrive::since(0, Position::ZERO).start(0, (both, 3));
        let since = |time_ns| Since { time_ns, answers: true, is_instant: false };
        assert_eq!(drive.take((both, 3), since(100_000_000)), Shown::UnderWay);
        assert_eq!(drive.take((both, 4), since(200_000_000)), Shown::Done);
    }

    /// Methods 35 and 37 need no motion: bits that stay set count after 50 ms. All others must have begun within 5 s.
    #[test]
    fn constant_bits_end_only_methods_without_motion() {
        let both = ATTAINED | REACHED;
        for method in [35, 37] {
            assert_eq!(homed(method, &[(0, both)]), (Shown::Done, 51));
        }
        for method in [1, 17, 33, 34] {
            assert_eq!(homed(method, &[(0, both)]), (Shown::NoBegin, 5_001));
        }
        assert_eq!(homed(1, &[(0, ERROR)]), (Shown::Failed, 5_001));
        // Bit 10 that is not set yet at the rising edge of bit 4 is no end, either.
        assert_eq!(homed(1, &[(0, ATTAINED), (30, both), (200, ATTAINED), (900, both)]), (Shown::Done, 900));
    }
}

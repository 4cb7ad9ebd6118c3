//! Homing that the drive runs by itself.
//!
//! Law      mode 6 is asked for; once the drive has shown it for 50 ms, in which bit 4 is low, bit 4 starts homing with the number of the
//!          method. In mode 6 the command is where the axis is, before and after it stays as it is. With bits 10 and 12 the zero of the drive is the reference; its counts begin
//!          anew (a new epoch). Bits of an earlier homing count once the drive has cleared one of them, which it may do late, or has set its counts
//!          anew. Methods 35 and 37 alone need no time, and may leave them as they are. The axis is homed once the drive shows the
//!          mode of the axis again, so that it cannot jump after an axis that moves off at once; with interface torque, which follows where the
//!          drive is, at once
//! Refuses  bit 13, mode 6 or the mode of the axis not shown in time, bits of an earlier homing that are not cleared in time, or a way of more than
//!          homing.max_distance: an error. A drive that moves has begun, and is not taken out of mode 6 for the time. Whatever else ends
//!          homing takes the axis over from its motion, in its own mode, and brakes it
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

/// How long a drive may take to show mode 6, and then to show that it has begun (ns).
const TIMEOUT_NS: u64 = 5_000_000_000;
/// A method that needs no way has had its effect within that long (ns): old bits are the new ones.
const INSTANT_NS: u64 = 50_000_000;

/// How far the drive is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct InDrive {
    /// Cycle in which mode 6 was asked for, or bit 4 set.
    since: u64,
    /// The cycle since which the drive shows mode 6.
    shown_since: Option<u64>,
    /// Bit 4 is set.
    started: bool,
    /// The drive has shown that it began, after that.
    begun: bool,
    /// The bits that it showed in the cycle before.
    shown: u16,
    /// How often its counts were set anew before it was started.
    epoch: u32,
    /// Bit 13 stands since before it began: it is that of another homing.
    old_error: bool,
    /// The cycle since which it has its zero, and is asked for the mode of the axis again.
    returns: Option<u64>,
    /// Where the axis was when homing began.
    from: Position,
}

/// What a drive shows of its homing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shown {
    /// It is under way.
    UnderWay,
    /// The zero is known, and the axis stands there.
    Done,
    /// It has failed.
    Failed,
    /// It shows no begin, and the time is over.
    NoBegin,
}

/// How long bit 4 is set, and what that lets one see.
#[derive(Clone, Copy, Debug)]
struct Since {
    /// (ns)
    time_ns: u64,
    /// The words of the drive may answer it.
    answers: bool,
    /// The method takes no time.
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

    /// Bit 4 is set from this cycle on.
    fn start(self, cycle: u64, (status, epoch): (u16, u32)) -> Self {
        let old_error = status & STATUS_HOMING_ERROR != 0;
        // Where no zero is known yet, one that is known is new.
        let begun = status & STATUS_HOMING_ATTAINED == 0;
        Self { since: cycle, started: true, begun, shown: status, epoch, old_error, ..self }
    }

    /// Takes status word and epoch of a cycle after [`start`](Self::start).
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
    /// The motion of a cycle in which the drive moves the axis: where it will be when the outputs of this cycle reach it, so
    /// that it can be taken over from there.
    pub(in super::super) fn follow_drive(&mut self) {
        let is_returning =
            matches!(self.homing.run, Some(Run { stage: Stage::InDrive(drive), .. }) if drive.returns.is_some());
        if is_returning || self.shown.mode() != MODE_HOMING {
            // In the mode of the axis the drive goes where it is asked to: a command that followed it would drive it on.
            self.command = Motion::at_rest(self.command.position);
        } else {
            let ahead = self.actual.velocity * self.cycle_s() * (self.delay() as f64 + 1.0);
            let place = Position::whole((self.actual.position + Position::from_f64(ahead)).nearest());
            self.command = Motion { velocity: self.actual.velocity, ..Motion::at_rest(place) };
        }
        // The drive answers to itself: what it shows is what was asked, also in the cycles until it answers to the axis again.
        self.judge.follow(self.actual.position.floor(), self.actual.velocity * self.cycle_s());
    }

    pub(super) fn watch_drive(&mut self, cx: &mut Context<'_>) {
        let Some((mut run, mut drive)) = self.homing.run.and_then(|run| match run.stage {
            Stage::InDrive(drive) => Some((run, drive)),
            _ => None,
        }) else {
            return;
        };
        let Some(input) = cx.input else { return };
        let gone = (self.actual.position - drive.from).nearest().saturating_abs();
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
                    self.command = Motion::at_rest(self.command.position);
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
            // In mode 6 the drive has seen bit 4 low, whatever that was in the mode before.
            drive = drive.start(cx.cycle, told);
        }
        run.stage = Stage::InDrive(drive);
        self.homing.run = Some(run);
    }

    /// The drive has its zero where it counts 0; `offset` is added to that.
    fn take_zero_of_drive(&mut self, cx: &mut Context<'_>, count: i64, offset: i64) {
        let reference = self.actual.position - Position::whole(self.turn_counts(count));
        let zero = reference + Position::whole(offset);
        if !zero.is_legal() {
            let asked = Number::Position(zero.nearest());
            return self.fail_homing(cx, Code::POSITION_OUT_OF_RANGE, asked, Number::None);
        }
        self.take_zero(cx, zero);
    }

    /// What the drive is asked for while it homes; nothing else is asked of it then.
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

    /// What comes of status words, each from a time on (ms), the first one before bit 4 is set; and when.
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

    /// CiA 402-2, homing mode: bits 12 and 10 are 0 while it runs, and both 1 once it is over.
    #[test]
    fn a_first_homing_is_over_with_both_bits() {
        assert_eq!(homed(1, &[(0, REACHED), (3, 0), (900, ATTAINED), (950, ATTAINED | REACHED)]), (Shown::Done, 950));
        assert_eq!(homed(1, &[(0, REACHED), (3, 0), (900, ERROR)]), (Shown::Failed, 900));
    }

    /// Bits of the homing before stand for 200 ms, or for 4 s: they are none of this one.
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

    /// Counts that were set anew are of this homing, whatever its bits showed between two looks.
    #[test]
    fn bits_that_stay_count_once_the_counts_were_set_anew() {
        let both = ATTAINED | REACHED;
        let mut drive = InDrive::since(0, Position::ZERO).start(0, (both, 3));
        let since = |time_ns| Since { time_ns, answers: true, is_instant: false };
        assert_eq!(drive.take((both, 3), since(100_000_000)), Shown::UnderWay);
        assert_eq!(drive.take((both, 4), since(200_000_000)), Shown::Done);
    }

    /// Methods 35 and 37 need no way: old bits hold after 50 ms. All others have begun within 5 s.
    #[test]
    fn bits_that_stay_end_nothing_but_methods_without_a_way() {
        let both = ATTAINED | REACHED;
        for method in [35, 37] {
            assert_eq!(homed(method, &[(0, both)]), (Shown::Done, 51));
        }
        for method in [1, 17, 33, 34] {
            assert_eq!(homed(method, &[(0, both)]), (Shown::NoBegin, 5_001));
        }
        assert_eq!(homed(1, &[(0, ERROR)]), (Shown::Failed, 5_001));
        // Bit 10 that is not yet there when bit 4 rises is no end, either.
        assert_eq!(homed(1, &[(0, ATTAINED), (30, both), (200, ATTAINED), (900, both)]), (Shown::Done, 900));
    }
}

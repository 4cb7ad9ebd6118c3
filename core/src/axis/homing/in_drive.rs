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

use crate::axis::state::homing::Run;
use crate::axis::state::homing::in_drive::{Shown, Since, TIMEOUT_NS};
use crate::axis::state::{Axis, Context, Stage};
use crate::code::Code;
use crate::drive::{DriveOutput, HomingOrder, Interface, MODE_HOMING, Mode, control, level_cycles};
use crate::event::Number;
use crate::position::Position;
use crate::profile::Motion;

impl Axis {
    /// Sets the motion of a cycle in which the drive moves the axis: the position at which the outputs of this cycle
    /// reach it, so that it can be taken over from there.
    pub(in crate::axis) fn follow_drive(&mut self) {
        let is_returning =
            matches!(self.homing.run(), Some(Run { stage: Stage::InDrive(drive), .. }) if drive.returns.is_some());
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
        let Some((mut run, mut drive)) = self.homing.run().and_then(|run| match run.stage {
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
            self.homing.continue_run(run);
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
        self.homing.continue_run(run);
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
    pub(in crate::axis) fn ask_for_homing(&self, output: DriveOutput) -> DriveOutput {
        let Some(Run { method, speeds: [fast, _, slow], limits, stage: Stage::InDrive(drive), .. }) = self.homing.run()
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

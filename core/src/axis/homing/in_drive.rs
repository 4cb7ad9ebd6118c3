//! Homing that the drive runs by itself.
//!
//! Law      mode 6 is asked for; once the drive shows it, bit 4 starts homing with the number of the method. Meanwhile the command is
//!          where the axis is. With bits 10 and 12 the zero of the drive is the reference; its counts begin anew (a new epoch)
//! Refuses  bit 13, mode 6 not shown in time, or a way of more than homing.max_distance: an error. Whatever else ends homing takes the axis over from its motion, in its
//!          own mode, and brakes it
//! Source   CiA 402-2, homing mode: control word bit 4, status word bits 10, 12, 13

use super::super::{Axis, Context};
use super::{Run, Stage};
use crate::code::Code;
use crate::drive::{
    DriveOutput, HomingOrder, MODE_HOMING, Mode, STATUS_HOMING_ATTAINED, STATUS_HOMING_ERROR, STATUS_TARGET_REACHED,
    control,
};
use crate::event::Number;
use crate::position::Position;
use crate::profile::Motion;
use serde::{Deserialize, Serialize};

/// How long a drive may take to show mode 6, and then to show that it has begun (ns).
const TIMEOUT_NS: u64 = 5_000_000_000;
/// One that shows no begin within that long had nothing to do (ns): its old bits are the new ones.
const INSTANT_NS: u64 = 50_000_000;

/// How far the drive is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct InDrive {
    /// Cycle in which mode 6 was asked for, or bit 4 set.
    since: u64,
    /// Bit 4 is set.
    started: bool,
    /// Bit 12 was seen to be 0 after that.
    begun: bool,
    /// Where the axis was when homing began.
    from: Position,
}

impl InDrive {
    pub(super) fn since(cycle: u64, from: Position) -> Self {
        Self { since: cycle, started: false, begun: false, from }
    }
}

impl Axis {
    /// The motion of a cycle in which the drive moves the axis: where it will be when the outputs of this cycle reach it, so
    /// that it can be taken over from there.
    pub(in super::super) fn follow_drive(&mut self) {
        let ahead = self.actual.velocity * self.cycle_s() * (self.delay() as f64 + 1.0);
        let place = Position::whole((self.actual.position + Position::from_f64(ahead)).nearest());
        self.command = Motion { velocity: self.actual.velocity, ..Motion::at_rest(place) };
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
        let elapsed = cx.cycle.saturating_sub(drive.since);
        let time = elapsed.saturating_mul(self.setup.cycle_ns);
        if input.mode != MODE_HOMING {
            if time > TIMEOUT_NS || drive.started && elapsed > self.delay().saturating_add(1) {
                self.fail_homing(cx, Code::HOMING_IN_DRIVE_TIMEOUT, Number::None, Number::None);
            }
            return;
        }
        if !drive.started {
            drive = InDrive { since: cx.cycle, started: true, ..drive };
        } else if elapsed > self.delay().saturating_add(1) {
            let shows = |bit: u16| input.status & bit != 0;
            drive.begun |= !shows(STATUS_HOMING_ATTAINED);
            let over = drive.begun || time > INSTANT_NS;
            if over && shows(STATUS_HOMING_ERROR) {
                return self.fail_homing(cx, Code::HOMING_IN_DRIVE_FAILED, Number::None, Number::None);
            }
            if over && shows(STATUS_HOMING_ATTAINED) && shows(STATUS_TARGET_REACHED) {
                let reference = self.actual.position - Position::whole(self.turn_counts(input.count));
                let zero = reference + Position::whole(run.offset);
                if !zero.is_legal() {
                    let asked = Number::Position(zero.nearest());
                    return self.fail_homing(cx, Code::POSITION_OUT_OF_RANGE, asked, Number::None);
                }
                return self.take_zero(cx, zero);
            }
        }
        run.stage = Stage::InDrive(drive);
        self.homing.run = Some(run);
    }

    /// What the drive is asked for while it homes; nothing else is asked of it then.
    pub(in super::super) fn ask_for_homing(&self, output: DriveOutput) -> DriveOutput {
        let Some(Run { method, speeds: [fast, _, slow], limits, stage: Stage::InDrive(drive), .. }) = self.homing.run
        else {
            return output;
        };
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

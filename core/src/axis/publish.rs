//! Writing an axis' signals.

use super::course::Aim;
use super::{Axis, AxisState, Generator, Pace};
use crate::position::Position;
use crate::signal::Board;
use crate::signal::axis::AxisSignal;
use crate::sync::follower::Phase;
use crate::sync::{Leads, status};

/// What the axis shows of its coupling.
#[derive(Clone, Copy, Debug, Default)]
struct Coupling {
    master: i64,
    error: i64,
    accurate: bool,
    in_sync: bool,
}

impl Axis {
    fn coupling(&self, leads: &Leads) -> Coupling {
        if let Some(error) = self.track_error_position() {
            return Coupling { error: error.nearest(), ..Coupling::default() };
        }
        let Generator::Follow(follower) = &self.generator else { return Coupling::default() };
        let error = follower.error(self.command.position).floor();
        let window = follower.accuracy();
        // MACS-SYNC-16: a positive window shows the error without its sign.
        let shown = if window >= 0 { error.saturating_abs() } else { error };
        Coupling {
            master: leads.get(follower.leader).position.floor(),
            error: shown,
            accurate: error.unsigned_abs() <= window.unsigned_abs(),
            in_sync: follower.phase() == Phase::Synchronized,
        }
    }

    /// REG_NORMTRACKERR: the tracking error in parts of the command velocity per ms (%); 0 at rest (MACS-SYS-03).
    fn track_error(&self) -> f64 {
        let per_ms = self.command.velocity / 1000.0;
        let error = (self.command.position - self.actual.position).to_f64();
        let share = 100.0 * error / per_ms;
        // Of next to no velocity any error is beyond all numbers.
        if per_ms == 0.0 || !share.is_finite() || !self.is_on() { 0.0 } else { share }
    }

    /// Writes all signals of this cycle.
    pub fn publish(&mut self, board: &mut Board, leads: &Leads) {
        let is_calm = self.pace() == Pace::Calm;
        let master = self.watch_master(leads);
        let command = self.command;
        let position = command.position.floor();
        let (turns, within) = match self.setup.modulo {
            Some(modulo) => {
                let (turns, within) = modulo.split(command.position);
                (turns, within.floor())
            }
            None => (0, position),
        };
        let target = self.course_end().unwrap_or(command.position).floor();
        let in_velocity = matches!(&self.generator, Generator::Plan(course)
            if matches!(course.aim, Aim::Velocity(velocity) if command.velocity == velocity)
                && command.acceleration == 0.0);
        let actual = self.actual.position.floor();
        let asked = if self.turned().units { self.asked() } else { position };
        let p = &self.parameters;

        // One look at the length, and none at each signal.
        let block = board.block(self.signals, AxisSignal::COUNT);
        let Ok(words) = <&mut [u64; AxisSignal::COUNT]>::try_from(block) else { return };
        let mut set = |signal: AxisSignal, word: u64| words[signal as usize] = word;
        let int = i64::cast_unsigned;
        let bit = u64::from;
        let real = f64::to_bits;
        use AxisSignal::*;
        set(CommandPosition, int(position));
        set(CommandFraction, real(command.position.fraction()));
        set(CommandVelocity, real(command.velocity));
        set(CommandAcceleration, real(command.acceleration));
        set(CommandJerk, real(command.jerk));
        set(TargetPosition, int(target));
        set(ActualCount, int(self.sensor.raw));
        set(ActualPosition, int(actual));
        set(ActualVelocity, real(self.actual.velocity));
        set(ActualEffort, real(self.effort));
        set(FollowingError, int(self.judge.following_error));
        set(RegulatorError, int(if self.is_on() { asked.saturating_sub(actual) } else { 0 }));
        set(RegulatorOutput, real(self.regulator_output()));
        set(ModuloPosition, int(within));
        set(Turns, int(turns));
        set(InVelocity, bit(in_velocity));
        set(LimitSoftwarePositive, bit(p.max_position.is_some_and(|limit| position >= limit)));
        set(LimitSoftwareNegative, bit(p.min_position.is_some_and(|limit| position <= limit)));
        set(OutputPosition, int(self.output.position));
        set(OutputVelocity, real(self.output.velocity));
        set(TrackError, real(self.track_error()));
        if let Some(master) = master {
            set(MasterPosition, real(master.position));
            set(MasterVelocity, real(master.velocity));
        }
        if !is_calm || !matches!(self.generator, Generator::Plan(_)) {
            let coupling = self.coupling(leads);
            set(InSync, bit(coupling.in_sync));
            set(SyncMaster, int(coupling.master));
            set(SyncError, int(coupling.error));
            set(SyncStatus, if coupling.accurate { status::ACCURATE } else { 0 });
        }
        if is_calm {
            // A motion changes nothing else.
            return;
        }
        if master.is_none() {
            set(MasterPosition, 0);
            set(MasterVelocity, 0);
        }
        set(InPosition, bit(self.judge.in_position));
        set(OutputEffort, real(self.output.effort));
        set(OutputControl, u64::from(self.output.control));
        set(State, self.state as u64);
        set(DriveState, self.drive_state as u64);
        set(Reference, self.reference as u64);
        // Taken off again while its brake opened, it never was.
        set(Enabled, bit(self.is_on() && !self.is_opening() && self.state != AxisState::Disabled));
        set(ModeOfOperation, int(self.mode.into()));
        set(Homed, bit(self.knows_zero()));
        set(Warning, bit(self.warning));
        set(Brake, bit(self.is_braked()));
        set(Error, u64::from(self.error.0));
        set(LimitPositive, bit(self.switches.positive));
        set(LimitNegative, bit(self.switches.negative));
        set(ReferenceSwitch, bit(self.switches.home));
        set(IndexCount, u64::from(self.index.0));
        set(IndexPosition, int(self.index.1.floor()));
        set(HomingPhase, self.homing.phase() as u64);
        let fault = self.fault();
        set(FaultCode, u64::from(fault.code.0));
        set(FaultCycle, fault.cycle);
        set(FaultCommand, int(fault.command.floor()));
        set(FaultVelocity, real(fault.velocity));
        set(FaultActual, int(fault.actual));
        set(FaultFollowingError, int(fault.following_error));
        set(EncoderErrors, self.encoder_errors());
        self.publish_vocabularies(board, leads);
    }

    /// Shows a latched position.
    pub fn publish_latch(&self, board: &mut Board, position: Position) {
        let count = AxisSignal::LatchCount.of(self.signals);
        board.set_int(AxisSignal::LatchPosition.of(self.signals), position.floor());
        board.set_real(AxisSignal::LatchFraction.of(self.signals), position.fraction());
        board.set_int(count, board.int(count).wrapping_add(1));
    }
}

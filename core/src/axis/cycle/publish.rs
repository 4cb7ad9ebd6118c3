//! Writes the signals of an axis.

use crate::axis::state::{Aim, Axis, Coupling, Generator};
use crate::position::Position;
use crate::signal::axis::AxisSignal;
use crate::signal::{Board, Signal};
use crate::state::AxisState;
use crate::sync::{Leads, status};

/// The signals of an axis.
type Words = [u64; AxisSignal::COUNT];

/// Returns the signals of one axis on the board. The length is checked once here, and not for each signal.
#[inline]
fn words(board: &mut Board, first: Signal) -> Option<&mut Words> {
    board.block(first, AxisSignal::COUNT).try_into().ok()
}

#[inline]
fn show_coupling(words: &mut Words, coupling: Shown) {
    let mut set = |signal: AxisSignal, word: u64| words[signal as usize] = word;
    set(AxisSignal::InSync, u64::from(coupling.in_sync));
    set(AxisSignal::SyncMaster, coupling.master.cast_unsigned());
    set(AxisSignal::SyncError, coupling.error.cast_unsigned());
    set(AxisSignal::SyncStatus, coupling.status);
}

/// Displayed values of the coupling of an axis.
#[derive(Clone, Copy, Debug, Default)]
struct Shown {
    master: i64,
    error: i64,
    status: u64,
    in_sync: bool,
}

/// Returns the displayed values of a coupling with that error of the slave.
#[inline]
fn displayed_values(coupling: &Coupling, leads: &Leads, error: Position) -> Shown {
    let (error, window) = (error.floor(), coupling.accuracy);
    Shown {
        master: leads.get(coupling.leader).position.floor(),
        // MACS-SYNC-16: a positive window shows the error without its sign.
        error: if window >= 0 { error.saturating_abs() } else { error },
        status: if error.unsigned_abs() <= window.unsigned_abs() { status::ACCURATE } else { 0 },
        in_sync: coupling.follower.is_in_sync(),
    }
}

impl Axis {
    fn shown_coupling(&self, leads: &Leads) -> Shown {
        if let Some(error) = self.track_error_position() {
            return Shown { error: error.nearest(), ..Shown::default() };
        }
        let Some(coupling) = self.coupling() else { return Shown::default() };
        let shown = displayed_values(
            coupling,
            leads,
            coupling.follower.error(self.command.position()) + self.missing_distance(),
        );
        Shown {
            status: shown.status | self.status_of_marks(),
            in_sync: shown.in_sync && !self.is_late() && self.has_marks(),
            ..shown
        }
    }

    /// Returns REG_NORMTRACKERR: tracking error as a share of the command velocity per ms (%); 0 at rest (MACS-SYS-03).
    fn track_error(&self) -> f64 {
        let per_ms = self.command.velocity() / 1000.0;
        let error = (self.command.position() - self.feedback.position()).to_f64();
        let share = 100.0 * error / per_ms;
        // At almost no velocity the share is infinite.
        if per_ms == 0.0 || !share.is_finite() || !self.is_on() { 0.0 } else { share }
    }

    /// Writes all signals of this cycle.
    pub fn publish(&mut self, board: &mut Board, leads: &Leads) {
        let Some(words) = words(board, self.cycle.signals()) else { return };
        let shows_a_master = self.show_motion(words, leads);
        let mut set = |signal: AxisSignal, word: u64| words[signal as usize] = word;
        let int = i64::cast_unsigned;
        let bit = u64::from;
        let real = f64::to_bits;
        use AxisSignal::*;
        let target = self.course_end().unwrap_or(self.command.position());
        set(TargetPosition, int(target.floor()));
        if !shows_a_master {
            set(MasterPosition, 0);
            set(MasterVelocity, 0);
        }
        set(InPosition, bit(self.supervision.is_in_position()));
        set(OutputEffort, real(self.drive_data.output().effort));
        set(OutputControl, u64::from(self.drive_data.output().control));
        set(State, self.status.state() as u64);
        set(DriveState, self.drive_data.shown().state() as u64);
        set(Reference, self.status.reference() as u64);
        // An axis that is switched off again while its brake opens was never enabled.
        set(Enabled, bit(self.is_on() && !self.is_opening() && self.status.state() != AxisState::Disabled));
        set(ModeOfOperation, int(self.drive_data.shown().mode().into()));
        set(Homed, bit(self.is_referenced()));
        set(Warning, bit(self.drive_data.shown().warns()));
        set(Brake, bit(self.is_braked()));
        set(Error, u64::from(self.alarm.code().0));
        set(LimitPositive, bit(self.observed.switches().positive));
        set(LimitNegative, bit(self.observed.switches().negative));
        set(ReferenceSwitch, bit(self.observed.switches().home));
        set(IndexCount, u64::from(self.observed.index_count()));
        set(IndexPosition, int(self.observed.index_position().floor()));
        set(HomingPhase, self.homing.phase() as u64);
        set(Compensation, int(self.compensated()));
        let fault = self.fault();
        set(FaultCode, u64::from(fault.code.0));
        set(FaultCycle, fault.cycle);
        set(FaultCommand, int(fault.command.floor()));
        set(FaultVelocity, real(fault.velocity));
        set(FaultActual, int(fault.actual));
        set(FaultFollowingError, int(fault.following_error));
        set(EncoderErrors, self.encoder_errors());
        let (slave, master) = self.phase_left();
        set(SyncWaiting, self.engaging());
        set(SyncLeaving, self.leaving());
        let (backward, owed) = self.stored_of_master();
        let marks = self.shown_marks();
        set(MarkerError, real(marks.error));
        set(MarkerCorrection, real(marks.correction));
        set(MarkerDistance, real(marks.distance));
        set(MarkerMissed, marks.missed);
        set(MarkerExtra, marks.extra);
        let (at_mark, master_at_mark) = self.positions_of_marks(leads);
        set(MarkerPosition, int(at_mark.floor()));
        set(MarkerFraction, real(at_mark.fraction()));
        set(MarkerMaster, int(master_at_mark.floor()));
        set(MarkerMasterFraction, real(master_at_mark.fraction()));
        set(MarkerFilter, real(marks.filter));
        set(MarkerCorrectionFilter, real(marks.correction_filter));
        set(MarkerStartLeft, real(marks.start_left));
        set(MarkerDistanceError, real(marks.distance_error));
        set(SyncFilterTau, real(self.filter_tau()));
        set(SyncBuffer, int(backward.floor()));
        set(SyncFilterError, real(owed.to_f64()));
        set(PhaseSlave, real(slave));
        set(PhaseMaster, real(master));
        show_coupling(words, self.shown_coupling(leads));
        self.publish_records(board);
        self.publish_vocabularies(board, leads);
    }

    /// Writes the signals that change while the axis only moves.
    #[inline]
    pub fn publish_motion(&mut self, board: &mut Board, leads: &Leads) {
        let Some(words) = words(board, self.cycle.signals()) else { return };
        self.show_motion(words, leads);
        // The target of a plan does not change; a motion without end shows its present position.
        let is_led = matches!(self.motion.generator(), Generator::Follow(_));
        if is_led
            || matches!(self.motion.generator(), Generator::Plan(course) if matches!(course.aim, Aim::Velocity(_)))
        {
            words[AxisSignal::TargetPosition as usize] = self.command.position().floor().cast_unsigned();
        }
        // An axis in a reduced cycle has no processing of the master motion.
        if let Some(coupling) = self.coupling() {
            show_coupling(words, displayed_values(coupling, leads, coupling.follower.error(self.command.position())));
        }
    }

    /// Writes the signals of the motion of this cycle, and of its master. Returns true if there is a master.
    #[inline]
    fn show_motion(&mut self, words: &mut Words, leads: &Leads) -> bool {
        let master = self.watch_master(leads);
        let command = self.command.motion();
        let position = command.position.floor();
        let (turns, within) = match self.setup.modulo {
            Some(modulo) => {
                let (turns, within) = modulo.split(command.position);
                (turns, within.floor())
            }
            None => (0, position),
        };
        let in_velocity = matches!(self.motion.generator(), Generator::Plan(course)
            if matches!(course.aim, Aim::Velocity(velocity) if command.velocity == velocity)
                && command.acceleration == 0.0);
        let actual = self.feedback.position().floor();
        let asked = if self.direction().units { self.commanded_increment() } else { position };
        let p = &self.parameters;

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
        set(ActualCount, int(self.sources.sensor().raw));
        set(ActualPosition, int(actual));
        set(ActualVelocity, real(self.feedback.velocity()));
        set(ActualEffort, real(self.drive_data.shown().effort()));
        set(FollowingError, int(self.supervision.following_error()));
        set(RegulatorError, int(if self.is_on() { asked.saturating_sub(actual) } else { 0 }));
        set(RegulatorOutput, real(self.regulator_output()));
        if self.closes_loop_here() {
            set(RegulatorSum, real(self.error_sum()));
        }
        if self.has_effort_command() {
            set(RegulatorVelocity, real(self.estimated_velocity()));
            set(RegulatorEffort, real(self.effort_output()));
            let (current, heat) = self.shown_current();
            set(RegulatorCurrent, real(current));
            set(RegulatorHeat, real(heat));
            set(RegulatorSetpoint, real(self.current_setpoint()));
            set(OutputEffort, real(self.drive_data.output().effort));
        }
        set(ModuloPosition, int(within));
        set(Turns, int(turns));
        set(InVelocity, bit(in_velocity));
        set(LimitSoftwarePositive, bit(p.max_position.is_some_and(|limit| position >= limit)));
        set(LimitSoftwareNegative, bit(p.min_position.is_some_and(|limit| position <= limit)));
        set(OutputPosition, int(self.drive_data.output().position));
        set(OutputVelocity, real(self.drive_data.output().velocity));
        set(TrackError, real(self.track_error()));
        if let Some(master) = master {
            set(MasterPosition, real(master.position));
            set(MasterVelocity, real(master.velocity));
        }
        master.is_some()
    }

    /// Writes a latched position.
    pub fn publish_latch(&self, board: &mut Board, position: Position) {
        self.publish_latches(board, position, 1);
    }

    /// Writes the last latched position, and adds `more` to their number.
    pub(in crate::axis) fn publish_latches(&self, board: &mut Board, position: Position, more: u32) {
        let count = AxisSignal::LatchCount.of(self.cycle.signals());
        board.set_int(AxisSignal::LatchPosition.of(self.cycle.signals()), position.floor());
        board.set_real(AxisSignal::LatchFraction.of(self.cycle.signals()), position.fraction());
        board.set_int(count, board.int(count).wrapping_add(more.into()));
    }
}

//! The steps of a cycle of an axis, and its commands.

use crate::axis::state::{Axis, Context, Generator, Power};
use crate::command::{Action, Command, Level};
use crate::drive::{DriveInput, EncoderInput};
use crate::encoder::{Encoder, Lead};
use crate::event::Event;
use crate::position::Position;
use crate::profile::Motion;
use crate::state::AxisState;

impl Axis {
    /// Whether the axis is off or, if it cannot be switched off, at rest without a goal.
    pub fn is_idle(&self) -> bool {
        match self.status.state() {
            AxisState::Disabled | AxisState::Stopping => self.status.power() == Power::Off && !self.is_virtual(),
            AxisState::Standstill => self.is_virtual(),
            _ => false,
        }
    }

    /// Whether the power may be removed now without ending a motion or a command.
    pub fn may_lose_power(&self) -> bool {
        let is_off = match self.status.state() {
            AxisState::Disabled | AxisState::ErrorStop => self.status.power() == Power::Off || self.is_virtual(),
            AxisState::Stopping => self.status.power() == Power::Off && !self.is_virtual(),
            AxisState::Standstill => self.is_virtual(),
            _ => false,
        };
        is_off
            && self.task.goal().is_none()
            && self.coupling.engagement().is_none()
            && self.pending.waiting().is_empty()
    }

    /// Executes the part of a cycle before its commands.
    pub fn begin_step(&mut self, cx: &mut Context<'_>) {
        self.take_shifts(cx);
        self.supervise_source(cx);
        self.alarm.let_others_continue();
        self.brake.begin_cycle(self.is_on());
        self.watch_contacts(cx);
        self.read_second(cx);
        self.supervise(cx);
        self.supervise_gantry(cx);
        self.supervise_current(cx);
        self.report_switches(cx);
        self.advance(cx);
        self.record_latches(cx);
        self.use_latch(cx);
        self.step_homing(cx);
        self.check_errors(cx);
        self.supervise_encoders(cx);
        self.supervise_recovery(cx);
        self.show_virtual(Position::ZERO);
    }

    /// Executes the part of a cycle after its commands.
    pub fn end_step(&mut self, cx: &mut Context<'_>) {
        self.follow_override(cx);
        self.leave_velocity(cx);
        self.step_vocabularies(cx);
        self.follow_stream(cx);
        self.follow_function(cx);
        self.engage(cx);
        self.leave(cx);
        self.end_cam(cx);
        self.execute_inputs(cx);
        self.apply_stop_priority(cx);
        self.check_arrival(cx);
        self.settle_step(cx);
        // Shows the effect of commands on the position since it was advanced.
        self.show_virtual(self.feedback.change());
    }

    /// Executes the part after everything that may stop or end a motion.
    pub(in crate::axis) fn settle_step(&mut self, cx: &mut Context<'_>) {
        self.settle_vocabularies(cx);
        self.settle_phase(cx);
        self.settle_leaving(cx);
        self.settle_conditioning();
        self.switch_drive(cx);
        if self.brake.had_power() && !self.travel.at_limits().is_free() && !self.is_on() {
            self.note_stop_given_up();
        }
        self.command_brake(cx.cycle);
        self.settle_waiting(cx);
    }

    /// Sets the actual position of a virtual axis, or of a simulated encoder, to the command; `moved`: change of this
    /// cycle so far.
    #[inline]
    pub(super) fn show_virtual(&mut self, moved: Position) {
        if self.is_virtual() || self.is_simulated() && self.is_on() {
            let change = moved + (self.command.position() - self.feedback.position());
            let Motion { position, velocity, .. } = self.command.motion();
            self.feedback.show(Lead { position, change, velocity, uneven: 0.0, valid: true });
        }
    }

    /// Executes a command on this axis, and answers a command for this axis alone. Commands for several axes were
    /// admitted for all of them before.
    pub fn take(&mut self, cx: &mut Context<'_>, command: &Command) {
        let sequence = command.sequence;
        let result = match &command.action {
            Action::Enable(_) => return self.enable(cx, sequence),
            Action::Disable(_) => return self.disable(cx, sequence),
            Action::Halt(_) => return self.halt(cx, sequence),
            Action::Deactivate => return self.begin_disable(cx),
            Action::Abort => {
                self.stop_simulated_master(cx);
                return self.abort(cx, sequence);
            }
            Action::QuickStop(_) => return self.quick_stop(cx, sequence),
            Action::ResetErrors(_) => return self.reset(cx, sequence),
            Action::Move(request) => self.start_move(cx, sequence, request),
            Action::Probe(request) => self.start_probe(cx, sequence, request),
            Action::TouchProbe(request) => self.arm_touch_probe(cx, sequence, request),
            Action::AbortTrigger(request) => self.abort_trigger(cx, sequence, request),
            Action::QueryTrajectory(request) => self.query_trajectory(cx, sequence, request.at_ns),
            Action::HomeAxis(request) => self.start_homing(cx, sequence, request.method),
            Action::OutAn(request) => self.start_out_an(cx, sequence, *request),
            Action::SetPosition(request) => self.set_position(cx, sequence, request.position),
            Action::ShiftPosition(request) => self.shift_position(cx, sequence, request.distance),
            Action::SetMasterPosition(request) => self.set_master_position(cx, sequence, request.position),
            Action::Synchronize(request) => self.start_synchronize(cx, sequence, request),
            Action::Vocabulary(request) => self.run_request(cx, sequence, request),
            _ => return,
        };
        if let Err(refusal) = result {
            cx.events.push(Event { position: self.command.position(), ..refusal.event(sequence) });
        }
    }

    /// Whether its state is possible; a state from outside may contain any values.
    pub fn is_sound(&self) -> bool {
        let searches = self.task.goal().and_then(|goal| goal.search).is_none_or(|search| search.is_sound());
        let waits = self.pending.buffer().is_sound()
            && self.coupling.overlay().is_none_or(|overlay| overlay.is_sound())
            && self.coupling.phasing().is_none_or(|phasing| phasing.is_sound() && self.coupling().is_some())
            && self.coupling.conditioning().is_sound()
            && self.coupling.engagement().is_none_or(|engagement| engagement.is_sound())
            && self.coupling.leaving().is_none_or(|leaving| leaving.is_sound() && self.coupling().is_some());
        let fits = match *self.motion.generator() {
            Generator::Rest => true,
            Generator::Open { .. } | Generator::Coast { .. } => self.is_open_loop(),
            Generator::OutAn { level, .. } => {
                let is_one = self.closes_loop_here() && self.gantry().is_none() && self.task.goal().is_none();
                let runs = self.status.power() == Power::On && self.status.state() == AxisState::ContinuousMotion;
                is_one && runs && (level == Level::Setpoint || self.has_effort_command())
            }
            Generator::Plan(_) | Generator::Follow(_) => !self.is_open_loop(),
            Generator::Track(_) => !self.is_open_loop() && self.tracker().is_some(),
        };
        let tracks = self.trackers().all(|tracker| tracker.is_sound()) && self.task.left().is_none();
        let is_moved = self.task.function().is_none_or(|by| by.is_sound());
        fits && tracks
            && is_moved
            && self.is_sensor_sound()
            && self.motion.generator().is_sound()
            && self.homing.is_sound()
            && self.homing.is_running() == (self.status.state() == AxisState::Homing)
            && (!self.homing.is_running() || self.is_on() && !self.is_virtual())
            && self.parameters.is_sound()
            && self.loops.compensation().is_sound()
            && self.loops.position().is_sound()
            && self.loops.effort().is_sound(&self.parameters.amplifier, self.setup.cycle_ns)
            && self.loops.velocity_feedback().is_sound()
            && self.can_close_loop()
            && self.may_be_analog_with(&self.parameters).is_ok()
            && self.loops.recovery().is_sound()
            && self.vocabularies.is_sound()
            && self.pending.touch_probes().are_sound()
            && searches
            && waits
            && self.command.motion().is_sound()
            && self.observed.override_seen().is_finite()
            && self.fault().is_sound()
    }

    /// Returns the position of raw counts near those of this cycle (inc).
    pub fn locate(&self, count: i64, encoders: &[Encoder]) -> i64 {
        self.turn_counts(self.locate_raw(count, encoders))
    }

    /// Reads the drive and the source of the position. The inputs of all axes are read before any axis moves.
    pub fn sense(&mut self, input: Option<&DriveInput>, encoders: &[Encoder], raw: &[EncoderInput]) {
        let Some(input) = input else { return };
        let effort = self.reported_effort(input.effort);
        self.drive_data.shown_mut().read(input, effort);
        self.read_source(input, encoders, raw);
        self.read_velocity_encoder(input);
    }
}

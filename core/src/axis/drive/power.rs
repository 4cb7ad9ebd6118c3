//! Switches a drive on and off (CiA 402 state machine, on the side of the master).

use crate::axis::state::failure::closes_brake;
use crate::axis::state::waiting::Until;
use crate::axis::state::{Axis, Context, Failure, Power};
use crate::code::{Class, Code};
use crate::drive::{DriveInput, DriveState, Emergency, Interface, NotEnabled, control, level_cycles};
use crate::event::{Event, Kind, Number, Severity};
use crate::state::AxisState;

/// Time within which a drive must switch on, if its cell has no value (ns).
pub const ENABLE_TIMEOUT_NS: u64 = 5_000_000_000;

/// Time within which a drive must leave its fault, and an axis must come to rest before its power is removed (ns).
const SWITCH_TIMEOUT_NS: u64 = 5_000_000_000;

/// Time between two warnings of a drive that fails while its axis is off (ns).
const TELL_AGAIN_NS: u64 = 1_000_000_000;

/// Largest number of emergency messages of a drive that are reported within that time.
const MOST_EMERGENCIES: u8 = 8;

impl Axis {
    /// Whether the axis itself generates the command position. Otherwise it is the actual position.
    #[inline]
    pub(in crate::axis) fn is_on(&self) -> bool {
        self.status.is_on()
    }

    /// Whether the axis waits for its brake to open.
    pub(in crate::axis) fn is_opening(&self) -> bool {
        matches!(self.status.power(), Power::Opening { .. })
    }

    /// Returns the cycles until the drive can respond, in addition to the one that every drive needs.
    pub(in crate::axis) fn delay(&self) -> u64 {
        self.setup.drive.map_or(0, |(_, offers)| offers.delay.into())
    }

    /// Sets whether the machine is active.
    pub fn set_active(&mut self, active: bool) {
        self.observed.set_active(active);
    }

    /// Whether the axis may be switched on and moved.
    pub fn is_active(&self) -> bool {
        self.observed.is_active()
    }

    /// Whether the axis is without power, as far as its drive shows. A virtual axis only has to be at rest.
    pub fn is_off(&self) -> bool {
        if self.is_virtual() {
            return self.rests();
        }
        self.status.power() == Power::Off && !self.drive_data.shown().may_run()
    }

    #[inline]
    pub(in crate::axis) fn is_virtual(&self) -> bool {
        self.setup.drive.is_none()
    }

    /// Stops the axis in the same cycle if its drive fails, is lost or sends no data.
    pub(in crate::axis) fn supervise(&mut self, cx: &mut Context<'_>) {
        let Some(input) = cx.input else { return };
        if let Some(emergency) = input.emergency {
            self.report_emergency(cx, emergency);
        }
        let failure = self.failure(input);
        self.watch_idle_drive(cx, failure);
        match self.status.power() {
            Power::On | Power::SwitchingOff | Power::Opening { .. } | Power::Closing { .. } => {
                if let Some(code) = failure {
                    self.raise(cx, Failure::of(code).before_motion());
                } else if self.drive_data.shown().state() != DriveState::Enabled {
                    self.raise(cx, Failure::of(Code::DRIVE_DISABLED).before_motion());
                } else {
                    self.follow_brake(cx);
                }
            }
            Power::SwitchingOn { since } => {
                if let Some(code) = failure {
                    self.raise(cx, Failure::of(code).before_motion());
                } else if self.is_enabled_as_asked(input) && cx.cycle > since.saturating_add(self.delay()) {
                    if let Some(failure) = self.switch_on_failure(cx) {
                        return self.raise(cx, failure);
                    }
                    let power = self.power_is_on(cx.cycle);
                    self.status.set_power(power);
                    self.command.rest_at(self.feedback.position());
                    self.supervision.fill(self.commanded_increment());
                    if self.status.power() == Power::On {
                        self.set_state(cx, AxisState::Standstill);
                    }
                } else if self.has_taken(cx.cycle, since, self.setup.enable_timeout_ns) {
                    let failure = self.not_enabled(input);
                    self.raise(cx, failure);
                }
            }
            Power::Resetting { since } => {
                if failure.is_none() {
                    self.status.set_power(Power::Off);
                    self.clear_error(cx);
                } else if self.has_timed_out(cx.cycle, since) {
                    self.status.set_power(Power::Off);
                    self.pending.waiting_mut().fail(cx.events, self.setup.index, Code::RESET_FAILED, Until::Healthy);
                }
            }
            Power::DriveStops { then_off, .. } => {
                if let Some(code) = failure.filter(|code| code.class() != Some(Class::Feedback)) {
                    // It is unknown whether the drive still stops.
                    self.raise(cx, Failure::of(code).before_motion());
                } else if then_off && self.has_stopped_by_itself(cx.cycle) {
                    let reaction = self.supervision.take_after_stop();
                    // An output that controls a brake closes it with the power; no other signal would do that.
                    let has_brake = self.creeps() && self.parameters.outputs.brake != 0;
                    self.request_brake(closes_brake(reaction) || has_brake);
                    self.switch_off(cx);
                }
            }
            Power::Off => {}
        }
    }

    /// Whether the drive is enabled in the commanded mode. In another mode it would interpret the command differently.
    fn is_enabled_as_asked(&self, input: &DriveInput) -> bool {
        let is_asked = self.drive_data.shown().state() == DriveState::Enabled
            && input.mode == self.setup.interface.mode().number();
        // Two drives are held at their positions of the same cycle.
        is_asked && (input.fresh || self.gantry().is_none())
    }

    /// Returns the error of a drive that was not enabled in time, with the state and the mode that it shows instead.
    fn not_enabled(&self, input: &DriveInput) -> Failure {
        let shown = NotEnabled { state: self.drive_data.shown().state(), mode: input.mode };
        let limit = i64::try_from(self.setup.enable_timeout_ns).unwrap_or(i64::MAX);
        let failure = Failure::of(Code::ENABLE_TIMEOUT).before_motion();
        failure.with(Number::Count(shown.to_number()), Number::Time(limit))
    }

    /// Reports an emergency message. The same code is reported once a second, different codes at most eight times a
    /// second. Code 0 after a reported code is always reported.
    fn report_emergency(&mut self, cx: &mut Context<'_>, emergency: Emergency) {
        let Emergency { code, register, data: [a, b, c, d, e] } = emergency;
        let last = self.observed.watch().emergency;
        let ends = code == 0 && last.is_some_and(|(last, _)| last != 0);
        if last.is_some_and(|(last, cycle)| last == code && !self.is_report_due(cx.cycle, cycle)) {
            return;
        }
        let (since, count) = self.observed.watch().emergencies;
        let (since, count) = if self.is_report_due(cx.cycle, since) { (cx.cycle, 0) } else { (since, count) };
        if !ends && count >= MOST_EMERGENCIES {
            return;
        }
        let count = if ends { count } else { count.saturating_add(1) };
        let watch = self.observed.watch_mut();
        (watch.emergency, watch.emergencies) = (Some((code, cx.cycle)), (since, count));
        let told = Number::Count(i64::from(code) | i64::from(register) << 16);
        let data = Number::Count(i64::from_le_bytes([a, b, c, d, e, 0, 0, 0]));
        // Code 0 means that an error has ended.
        let severity = if code == 0 { Severity::Info } else { Severity::Warn };
        let event = Event::new(severity, Kind::Warning, self.object(), Code::EMERGENCY).with(told, data);
        cx.events.push(Event { position: self.feedback.position(), ..event });
    }

    fn is_report_due(&self, cycle: u64, told: u64) -> bool {
        cycle.saturating_sub(told).saturating_mul(self.setup.cycle_ns) >= TELL_AGAIN_NS
    }

    /// Reports a drive that fails while its axis is off: this is only a warning. A drive that has not been online yet
    /// does not fail.
    fn watch_idle_drive(&mut self, cx: &mut Context<'_>, failure: Option<Code>) {
        let failure = failure.filter(|code| code.class() != Some(Class::Feedback));
        let Some(code) = failure else {
            let watch = self.observed.watch_mut();
            (watch.was_well, watch.is_told) = (true, false);
            return;
        };
        let watch = *self.observed.watch();
        // While the axis is on, the same failure is an error.
        let is_idle = self.status.power() == Power::Off && self.alarm.is_none();
        let may_tell = watch.told.is_none_or(|told| self.is_report_due(cx.cycle, told));
        if is_idle && watch.was_well && !watch.is_told && may_tell {
            let watch = self.observed.watch_mut();
            (watch.told, watch.is_told) = (Some(cx.cycle), true);
            let event = Event::new(Severity::Warn, Kind::Warning, self.object(), code);
            cx.events.push(Event { position: self.feedback.position(), ..event });
        }
        self.observed.watch_mut().is_told |= !is_idle;
    }

    /// Ends the opening or closing time of the brake: the axis may move, or its power is removed.
    fn follow_brake(&mut self, cx: &mut Context<'_>) {
        match self.status.power() {
            Power::Opening { since } if self.has_brake_time_elapsed(cx.cycle, since, |brake| brake.release_ns) => {
                self.status.set_power(Power::On);
                // A quick stop or an error in the meantime has locked it.
                if self.status.state() == AxisState::Disabled {
                    self.set_state(cx, AxisState::Standstill);
                }
            }
            Power::Closing { since } if self.has_brake_time_elapsed(cx.cycle, since, |brake| brake.engage_ns) => {
                self.switch_off(cx);
            }
            _ => {}
        }
    }

    pub(super) fn has_timed_out(&self, cycle: u64, since: u64) -> bool {
        self.has_taken(cycle, since, SWITCH_TIMEOUT_NS)
    }

    /// Whether more than that time (ns) has passed since a cycle.
    fn has_taken(&self, cycle: u64, since: u64, most_ns: u64) -> bool {
        cycle.saturating_sub(since).saturating_mul(self.setup.cycle_ns) > most_ns
    }

    pub(in crate::axis) fn failure(&self, input: &DriveInput) -> Option<Code> {
        self.drive_data.shown().failure(input, self.setup.missed_cycles).or_else(|| self.source_failure())
    }

    /// Switches the axis off at once.
    pub(in crate::axis) fn switch_off(&mut self, cx: &mut Context<'_>) {
        self.status.set_power(Power::Off);
        self.motion.rest();
        // Switching off and on unlocks nothing.
        if !matches!(self.status.state(), AxisState::ErrorStop | AxisState::Stopping) {
            self.set_state(cx, AxisState::Disabled);
        }
    }

    /// Selects the control word and sets the outputs to the drive.
    pub(in crate::axis) fn switch_drive(&mut self, cx: &mut Context<'_>) {
        if self.status.power() == Power::SwitchingOff && self.rests() && self.has_settled_or_timed_out(cx.cycle) {
            self.switch_off_after_brake(cx.cycle);
            if self.status.power() == Power::Off {
                self.switch_off(cx);
            }
        }
        let word = match self.status.power() {
            Power::Off => control::DISABLE_VOLTAGE,
            Power::DriveStops { .. } => control::QUICK_STOP,
            Power::On | Power::SwitchingOff | Power::Opening { .. } | Power::Closing { .. } => control::ENABLE,
            Power::Resetting { since } => reset_word(cx.cycle.saturating_sub(since), self.setup.cycle_ns),
            Power::SwitchingOn { .. } => match self.drive_data.shown().state() {
                DriveState::SwitchOnDisabled => control::SHUTDOWN,
                DriveState::Ready => control::SWITCH_ON,
                DriveState::SwitchedOn | DriveState::Enabled => control::ENABLE,
                _ => control::DISABLE_VOLTAGE,
            },
        };
        if !self.note_compensated() {
            self.compensate(cx.tables);
        }
        self.command_drive(self.commanded_increment(), word);
        if self.homing.is_in_drive() {
            self.drive_data.set_output(self.ask_for_homing(*self.drive_data.output()));
        }
    }

    /// Sets the outputs to the drive: the increment `asked`, in the direction of the axis, and the control word.
    fn command_drive(&mut self, asked: i64, word: u16) {
        let mode = self.setup.interface.mode();
        self.drive_data.set_control(word, mode);
        self.set_drive_outputs(asked);
        self.drive_data.add_position(self.loops.compensation().ahead());
    }

    /// Sets the outputs to the drive that change during motion.
    #[inline]
    pub(in crate::axis) fn set_drive_outputs(&mut self, asked: i64) {
        let (velocity, effort) = self.drive_reference();
        let (velocity, effort) = (self.reference_across(velocity), self.reference_across(effort));
        self.status.set_backwards(velocity < 0.0);
        let position = self.turn_counts(asked).wrapping_sub(self.feedback.origin());
        let is_position = self.setup.interface == Interface::Position;
        let acceleration = if is_position { self.convert_direction(self.command.acceleration()) } else { 0.0 };
        self.drive_data.set_motion(position, self.unipolar(velocity), effort, acceleration);
    }

    /// Returns velocity (inc/s) and effort (in its unit) for the drive in the direction of the axis: as command, or as
    /// feedforward of the position.
    #[inline]
    fn drive_reference(&mut self) -> (f64, f64) {
        match self.setup.interface {
            Interface::Position => (self.command.velocity(), 0.0),
            Interface::Velocity => (self.close_loop().0, 0.0),
            Interface::OpenLoop => (self.speed(), 0.0),
            Interface::Torque | Interface::Voltage => {
                let (_, is_done) = self.close_loop();
                (0.0, self.close_effort(self.regulator_output(), is_done))
            }
        }
    }
}

/// Returns the control word of a reset, `elapsed` cycles after its start. The reset needs a rising edge: bit 7 was 0
/// before and is 0 in the first cycle, and then alternates between 1 and 0 until the drive leaves its fault, or the
/// time has elapsed.
fn reset_word(elapsed: u64, cycle_ns: u64) -> u16 {
    match elapsed.checked_sub(1) {
        Some(passed) if (passed / level_cycles(cycle_ns)).is_multiple_of(2) => control::FAULT_RESET,
        _ => control::DISABLE_VOLTAGE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CYCLES: [u64; 6] = [125_000, 341_333, 1_000_000, 4_000_000, 20_000_000, 100_000_000];

    /// 50 ms are 400 cycles of 125 us and 50 of 1 ms; of 20 ms they are 3, and the minimum is 5.
    #[test]
    fn each_level_of_the_reset_stands_for_50_ms_and_five_cycles() {
        for (cycle_ns, level) in CYCLES.into_iter().zip([400, 147, 50, 13, 5, 5]) {
            let high = |elapsed| reset_word(elapsed, cycle_ns) == control::FAULT_RESET;
            assert!(!high(0));
            for elapsed in 0..6 * level {
                assert_eq!(high(elapsed + 1), (elapsed / level).is_multiple_of(2), "{cycle_ns} ns, {elapsed}");
            }
        }
    }

    /// Drives that read their control word in every nth cycle see the edge, from any first cycle.
    #[test]
    fn drive_that_reads_seldom_leaves_its_fault() {
        for cycle_ns in CYCLES {
            for (every, first) in (1..=5_u64).flat_map(|every| (0..every).map(move |first| (every, first))) {
                let (mut state, mut last, mut elapsed) = (DriveState::Fault, control::DISABLE_VOLTAGE, first);
                while state == DriveState::Fault {
                    let word = reset_word(elapsed, cycle_ns);
                    (state, last) = (state.next(word, last), word);
                    elapsed += every;
                    assert!(elapsed <= 12, "every {every} from {first} at {cycle_ns} ns");
                }
            }
        }
    }
}

//! Adapter between the process data of a drive and the inputs and outputs of a machine cycle.
//!
//! Law      process data is fresh in the cycle that receives it; otherwise the last values stay. Homing starts a new
//!          coordinate system (another epoch)
//! Reads    values that the drive reports, emergency messages, answers of SDO requests
//! Writes   its part of the inputs; the values that are commanded; SDO requests for homing and for the mode of operation
//! Source   CiA 402-2, contract section 8

use crate::config::{DriveConfig, MissingDataBehaviour, VelocityFactor};
use crate::counter::PositionCounter;
use crate::homing::HomingSetup;
use crate::homing_end::HomingEnd;
use crate::mapping::{CommandedValue, DriveMapping, ReportedValue};
use crate::mode::Commander;
use crate::mode_exchange::ModeExchange;
use crate::object::Object;
use crate::probe::{self, CaptureCounter, Probes, SlotMeaning};
use crate::sdo::{SdoError, SdoRequest, Transfer};
use lineshaft_core::drive::{
    BusState, DriveInput, DriveOutput, DriveState, Emergency, Inputs, Interface, Latch, MODE_HOMING, Mode,
    STATUS_HOMING_ATTAINED, control, level_cycles,
};
use lineshaft_core::object::Object as MachineObject;

/// Factor by which the apparent velocity of homing may exceed the commanded one in a cycle: process data may arrive at uneven
/// times, and the drive may overshoot.
const HOMING_VELOCITY_FACTOR: f64 = 4.0;
/// Additional tolerance for a drive that homes, in counts.
const HOMING_TOLERANCE: f64 = 100.0;
/// Time for a drive whose mode is written by SDO to leave mode homing, in s.
const RETURN_S: f64 = 5.0;

/// Values that the drive reports.
#[derive(Clone, Copy, Debug, Default)]
struct ReportedValues {
    status: u16,
    /// Mode of operation. If it is read by SDO: the last known one, or 0.
    mode: i8,
    inputs: u32,
    fault: u16,
    /// Torque, in thousandths of rated torque.
    torque: i16,
    /// Velocity calculated from the counts, in counts/s.
    velocity: f64,
}

/// Result of an SDO transfer that has ended.
#[derive(Debug, PartialEq, Eq)]
pub enum SdoOutcome {
    /// The transfer belonged to the drive and needs no report.
    Handled,
    /// The drive refuses an object of the homing setup.
    HomingRefused(SdoError),
    /// The mode of operation can be neither written nor read.
    ModeRefused(SdoError),
    /// The transfer belongs to another client.
    Other(Transfer),
}

/// Drive in the cycles.
#[derive(Debug)]
pub struct DriveAdapter {
    /// Place among the drives of the machine.
    place: usize,
    factor: VelocityFactor,
    cycle_s: f64,
    counter: PositionCounter,
    words: ReportedValues,
    /// Whether the drive has reported its position since its start.
    is_heard: bool,
    is_fresh: bool,
    /// Number of cycles since the counts were fresh.
    stale: u32,
    missed: MissingDataBehaviour,
    /// Effort per thousandth of rated torque; 1 with interface torque, whose efforts are in thousandths.
    effort_unit: f64,
    emergency: Option<Emergency>,
    object: MachineObject,
    probes: Probes,
    catches: [CaptureCounter; 4],
    /// Last commanded mode, as the axis numbers it.
    mode: i8,
    commander: Commander,
    /// Length of the target velocity, in bits.
    target_bits: u32,
    /// Whether the mode is in no PDO, because it was set during configuration.
    is_mode_fixed: bool,
    /// Whether the drive is shut down where its voltage would be disabled.
    is_shut_down: bool,
    /// Control word and position of this cycle.
    asked: (u16, i64),
    /// Higher velocity of the last homing command, in counts/s; 0 before the first one.
    homing_velocity: f64,
    /// Whether a jump since the start of homing has started a new coordinate system.
    has_jumped: bool,
    homing: HomingSetup,
    homing_end: HomingEnd,
    /// Exchange of the mode by SDO, if an object of it is in no PDO.
    modes: ModeExchange,
    /// Whether the axis commands that the operation is enabled.
    is_enabling: bool,
    /// Whether the drive was commanded to home, and may not be back in its cyclic mode yet.
    leaves_homing: bool,
}

impl DriveAdapter {
    /// Creates the adapter of a drive that has reported nothing yet, with the objects of its process data and the cycle time, in ns.
    pub fn new(config: &DriveConfig, mapping: &DriveMapping, cycle_ns: u64) -> Self {
        let mut told = mapping.reported.iter().chain(&mapping.on_change);
        let position = told.clone().find(|field| field.word == ReportedValue::Position);
        let target = mapping.commanded.iter().find(|field| field.word == CommandedValue::Velocity);
        Self {
            place: config.place,
            factor: config.velocity,
            cycle_s: cycle_ns as f64 * 1e-9,
            counter: position.map_or_else(PositionCounter::default, |field| PositionCounter::of_bits(field.bits)),
            words: ReportedValues::default(),
            is_heard: false,
            is_fresh: false,
            stale: 0,
            missed: config.missed,
            effort_unit: match config.mode.interface() {
                Interface::Torque => 1.0,
                _ => config.rated_effort.unwrap_or_default() / 1000.0,
            },
            emergency: None,
            object: MachineObject::Axis(config.object),
            probes: config.probes,
            catches: Default::default(),
            mode: 0,
            commander: Commander::new(config.mode, cycle_ns),
            target_bits: target.map_or(32, |field| field.bits),
            is_mode_fixed: !mapping.mode_by_sdo.reads && !told.any(|field| field.word == ReportedValue::Mode),
            is_shut_down: config.drive_type.is_some(),
            asked: (0, 0),
            homing_velocity: 0.0,
            has_jumped: false,
            homing: HomingSetup::new(config.velocity),
            // The loops of an axis with interface torque follow the position of the drive: it cannot jump, and must not be without torque.
            homing_end: HomingEnd::new(
                mapping.mode_by_sdo.writes && config.mode.interface() != Interface::Torque,
                // The conversion saturates.
                (RETURN_S * 1e9 / cycle_ns as f64) as u32,
                u32::try_from(level_cycles(cycle_ns)).unwrap_or(u32::MAX),
            ),
            modes: ModeExchange::new(mapping.mode_by_sdo),
            is_enabling: false,
            leaves_homing: false,
        }
    }

    /// Returns the place among the drives of the machine.
    pub fn place(&self) -> usize {
        self.place
    }

    /// Returns true if the drive has reported its position and is not silent since.
    pub fn is_heard(&self) -> bool {
        self.is_heard && self.stale <= self.missed.cycles
    }

    /// Returns the counts, and the epoch of their coordinate system.
    pub fn counts(&self) -> (i64, u32) {
        (self.counter.count(), self.counter.epoch())
    }

    /// Starts reception before the drive is started, with its digital inputs. `counts_on`: the drive was only offline.
    pub fn listen(&mut self, inputs: u32, counts_on: bool) {
        // The counts include motion while the drive was offline. A drive that was homing may have a new zero.
        if !counts_on || self.words.mode == MODE_HOMING {
            self.counter.start_epoch();
        }
        let mode = if self.is_mode_fixed { self.commander.mode().number() } else { 0 };
        self.words = ReportedValues { inputs, mode, ..ReportedValues::default() };
        (self.is_heard, self.is_fresh, self.stale) = (false, false, 0);
        self.catches = Default::default();
        self.modes.reset();
        self.homing_end.clear();
        (self.is_enabling, self.leaves_homing) = (false, false);
    }

    /// Records that the drive was started; `fault` is its error code.
    pub fn begin(&mut self, fault: u16) {
        if self.words.fault == 0 {
            self.words.fault = fault;
        }
    }

    /// Handles received values. `is_cyclic`: they are sent in each cycle, not on change.
    pub fn take(&mut self, told: impl Iterator<Item = (ReportedValue, i64)>, is_cyclic: bool) {
        let (was, mut word, mut captured, mut has_status) = (self.words, None, 0, false);
        let words = &mut self.words;
        for (what, value) in told {
            match what {
                ReportedValue::Status => (words.status, has_status) = (value as u16, true),
                ReportedValue::Mode => words.mode = value as i8,
                ReportedValue::Inputs => words.inputs = value as u32,
                ReportedValue::Fault => words.fault = value as u16,
                ReportedValue::Torque => words.torque = value as i16,
                ReportedValue::Position => word = Some(value as i32),
                ReportedValue::Captured(_) => captured = value as i32,
                ReportedValue::Captures(slot) => {
                    if let Some(caught) = self.catches.get_mut(usize::from(slot)) {
                        caught.update(captured, value as u16);
                    }
                }
                ReportedValue::Digital(_)
                | ReportedValue::Analog(_)
                | ReportedValue::Encoder
                | ReportedValue::Nothing => {}
            }
        }
        let now = *words;
        let has_zero = |words: ReportedValues| words.mode == MODE_HOMING && words.status & STATUS_HOMING_ATTAINED != 0;
        let is_homing = now.mode == MODE_HOMING && was.mode == MODE_HOMING;
        let finds_zero = has_zero(now) && !has_zero(was);
        let is_started = self.asked.0 & control::START_HOMING != 0;
        // The first jump is the zero. If the position continues to jump, the drive is too fast, and its travel counts as motion.
        let may_jump = is_homing && is_started && !self.has_jumped;
        let jumps = may_jump && word.is_some_and(|word| self.is_beyond_homing(word));
        self.has_jumped |= jumps;
        if is_homing && finds_zero || jumps {
            self.counter.start_epoch();
            if is_started {
                self.homing_end.record_zero();
            }
        }
        if let Some(word) = word {
            let change = self.counter.update(word);
            let cycles = f64::from(self.stale.saturating_add(1));
            // After an absence the duration of the travel is unknown.
            self.words.velocity = if self.is_heard { change as f64 / (cycles * self.cycle_s) } else { 0.0 };
            (self.is_heard, self.stale) = (true, 0);
        }
        // The position is sent in each cycle.
        self.is_fresh |= is_cyclic && word.is_some();
        if has_status && let Some(mode) = self.modes.record_status_word() {
            self.words.mode = mode;
        }
    }

    /// Returns true if a position is further away than homing can move the drive, which means that the coordinate system was changed. Bit
    /// 12 does not always show that: it may still be set from the previous homing, or rise in a later cycle.
    fn is_beyond_homing(&self, word: i32) -> bool {
        let Some(count) = self.counter.count_at(word) else { return false };
        let cycles = f64::from(self.stale.saturating_add(1));
        let most = HOMING_VELOCITY_FACTOR * self.homing_velocity * self.cycle_s * cycles + HOMING_TOLERANCE;
        self.homing_velocity > 0.0 && self.counter.count().abs_diff(count) as f64 > most
    }

    /// Handles an emergency message.
    pub fn take_emergency(&mut self, emergency: Emergency) {
        self.emergency = Some(emergency);
        if emergency.code != 0 {
            self.words.fault = emergency.code;
        }
    }

    /// Writes the inputs of this cycle. `is_there`: the drive takes part in the cycles.
    pub fn read(&mut self, inputs: &mut Inputs, is_there: bool, bus: BusState) {
        let index = self.read_probes(inputs);
        let Some(input) = inputs.drive.get_mut(self.place) else { return };
        let is_online = is_there && self.is_heard;
        let ReportedValues { status, mode, inputs, fault, torque, velocity } = self.words;
        let mode = if self.modes.by_sdo().reads { self.modes.known().unwrap_or_default() } else { mode };
        let (mode, status) = self.homing_end.reported_state(self.commander.mode().convert_number(mode), status);
        let is_fresh = std::mem::take(&mut self.is_fresh) && is_online;
        self.stale = if is_fresh { 0 } else { self.stale.saturating_add(1) };
        let is_in_fault = matches!(DriveState::from_status(status), DriveState::Fault | DriveState::FaultReaction);
        *input = DriveInput {
            count: self.counter.count().wrapping_add(self.extrapolated_travel(velocity)),
            epoch: self.counter.epoch(),
            velocity,
            effort: f64::from(torque) * self.effort_unit,
            status,
            mode,
            // Without a fault the stored error code is not reported.
            fault: if is_in_fault { fault } else { 0 },
            online: is_online,
            fresh: is_fresh,
            bus,
            emergency: self.emergency.take(),
            inputs,
            index,
            unacknowledged: is_online && self.commander.is_unacknowledged(),
        };
    }

    /// Returns the extrapolated travel since process data is missing; 0 without extrapolation.
    fn extrapolated_travel(&self, velocity: f64) -> i64 {
        let cycles = if self.missed.extrapolates { self.stale.min(self.missed.cycles) } else { 0 };
        // The conversion saturates.
        (velocity * self.cycle_s * f64::from(cycles)).round() as i64
    }

    /// Adds latches of the axis, and returns the last index pulse.
    fn read_probes(&mut self, inputs: &mut Inputs) -> Option<i64> {
        let mut index = None;
        for (slot, caught) in (0..).zip(&mut self.catches) {
            let Some((word, lost)) = caught.drain() else { continue };
            let position = self.counter.count_at(word);
            match probe::meaning(self.probes, slot) {
                SlotMeaning::Index => index = position,
                SlotMeaning::Edge(edge) => {
                    inputs.add_latch(Latch { object: self.object, edge, age_ns: None, position });
                    inputs.latches_lost = inputs.latches_lost.saturating_add(lost.into());
                }
            }
        }
        index
    }

    /// Handles the commands of a cycle.
    pub fn ask(&mut self, output: &DriveOutput) {
        self.mode = self.homing.allowed_mode(output.mode, self.mode);
        if let Mode::Homing(order) = output.mode {
            self.homing_velocity = order.search_velocity.abs().max(order.zero_velocity.abs());
        }
        self.has_jumped &= output.control & control::START_HOMING != 0;
        let mode = self.commander.mode();
        let command = self.command_mode(output);
        let is_in_mode = mode.convert_number(self.mode) == mode.number() && self.words.mode == mode.number();
        let control = match command {
            control::DISABLE_VOLTAGE if self.is_shut_down => control::SHUTDOWN,
            other => other,
        };
        self.asked = self.commander.command(control, output.position, self.words.status, is_in_mode);
    }

    /// Commands the mode of a drive that cannot map it to a PDO. Returns the control word: the drive is not enabled before it is in that
    /// mode, nor while it returns from an aborted homing.
    fn command_mode(&mut self, output: &DriveOutput) -> u16 {
        if !self.modes.is_used() {
            return output.control;
        }
        let mode = self.commander.mode();
        let method = if let Mode::Homing(order) = output.mode { Some(order.method) } else { None };
        let starts = method.is_some() && output.control & control::START_HOMING != 0;
        if starts && matches!(method, Some(35 | 37)) {
            self.homing_end.count_method_without_motion();
        }
        let commanded = self.homing_end.command(mode.convert_number(self.mode), mode.number(), starts);
        self.modes.command(commanded);
        let enables = output.control & control::ENABLE == control::ENABLE;
        let is_enabled = DriveState::from_status(self.words.status) == DriveState::Enabled;
        let was_enabling = std::mem::replace(&mut self.is_enabling, enables);
        if enables && !was_enabling && !is_enabled {
            // Another client may have changed the mode since it was read.
            self.modes.invalidate();
        }
        self.forget_mode();
        let is_settled = self.modes.is_settled(self.words.mode);
        self.homing_end.update_return(is_settled, self.modes.is_refused());
        // If a homing is aborted before its zero, a drive back in its cyclic mode would jump to the present position of the axis.
        self.leaves_homing = self.homing_end.is_used() && (method.is_some() || self.leaves_homing && !is_settled);
        let is_left = self.leaves_homing && method.is_none();
        match output.control {
            _ if enables && !is_settled && (!is_enabled || is_left) => control::SWITCH_ON,
            other if self.homing_end.is_pending() => other & !control::START_HOMING,
            other => other,
        }
    }

    /// Clears the mode while it is unknown by SDO: the status word belongs to another one.
    fn forget_mode(&mut self) {
        // A homing that is aborted may still find its zero until the drive has left its mode. A finished homing has it.
        let may_find_zero = self.words.mode == MODE_HOMING && self.words.status & STATUS_HOMING_ATTAINED == 0;
        if self.modes.by_sdo().reads && self.modes.known().is_none() && !may_find_zero {
            self.words.mode = 0;
        }
    }

    /// Returns the next SDO request, if one is due: for the homing setup, or for the mode. One request is pending at a time.
    pub fn next_request(&mut self, now_ns: u64) -> Option<SdoRequest> {
        if let Some((object, data)) = self.homing.next_object() {
            return Some(SdoRequest { object, data, writes: true });
        }
        let request = self.modes.next_request(now_ns);
        self.forget_mode();
        request
    }

    /// Returns the data of a request that could not be sent; it is repeated.
    pub fn return_buffer(&mut self, object: Object, data: Vec<u8>) {
        if self.homing.is_pending(object) {
            self.homing.return_buffer(data);
        } else {
            self.modes.return_buffer(data);
        }
    }

    /// Handles the end of any transfer with the drive.
    pub fn handle_transfer(&mut self, done: Transfer, now_ns: u64) -> SdoOutcome {
        if self.homing.is_pending(done.object) {
            self.homing.handle_answer(done.object, done.data, done.result.is_ok());
            return done.result.map_or_else(SdoOutcome::HomingRefused, |()| SdoOutcome::Handled);
        }
        if self.modes.is_pending(done.object) {
            return self.modes.handle_answer(done, now_ns).map_or(SdoOutcome::Handled, SdoOutcome::ModeRefused);
        }
        if let Err(error) = &done.result {
            self.modes.record_failure(done.object, error);
        }
        SdoOutcome::Other(done)
    }

    /// Returns the value of a commanded field.
    pub fn value(&self, word: CommandedValue, output: &DriveOutput) -> i64 {
        match word {
            CommandedValue::Control => i64::from(self.asked.0),
            // Positions wrap, like those of the drive.
            CommandedValue::Position => self.asked.1,
            // A drive that homes has its speeds from 6099h. Until it is in mode homing it follows this target; the axis is at rest.
            CommandedValue::Velocity if matches!(output.mode, Mode::Homing(_)) => 0,
            CommandedValue::Velocity => {
                let most = (1_i64 << (self.target_bits.clamp(2, 63) - 1)) - 1;
                self.factor.to_drive(output.velocity).clamp(-most, most)
            }
            // The conversion saturates; NaN becomes 0.
            CommandedValue::Torque => i64::from(output.effort.round() as i16),
            CommandedValue::Mode => i64::from(self.commander.mode().convert_number(self.mode)),
            CommandedValue::Outputs
            | CommandedValue::Digital(_)
            | CommandedValue::Analog(_)
            | CommandedValue::Nothing => 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;
    use crate::mapping::{Extras, MappingRequirements};
    use crate::mode::DriveMode;

    /// All reported values in one image of 13 bytes, which no CAN frame has: 6041h, 6064h, 6061h, 6077h, 60FDh. Commanded are 6040h, 607Ah,
    /// 6060h.
    #[test]
    fn drive_is_read_and_commanded_without_frames() {
        let config = DriveConfig { rated_effort: Some(20.0), ..DriveConfig::plain(0) };
        let extras = Extras { torque: true, ..Extras::default() };
        let requirements = MappingRequirements { mode: DriveMode::Csp, extras, has_inputs: true, has_outputs: false };
        let mapping = DriveMapping::plan(requirements, None).unwrap();
        let mut drive = DriveAdapter::new(&config, &mapping, 1_000_000);
        drive.listen(0, false);
        drive.begin(0);
        let mut image = Image::of(&mapping.reported);
        assert!(image.update(&[0x37, 0x02, 0xFE, 0xFF, 0xFF, 0xFF, 8, 0xF4, 0x01, 1, 0, 0, 0]));
        drive.take(image.values(), true);
        let mut inputs = Inputs { drive: vec![DriveInput::default()], ..Inputs::default() };
        drive.read(&mut inputs, true, BusState::Active);
        let read = inputs.drive[0];
        assert_eq!((read.count, read.status, read.mode, read.effort, read.inputs), (-2, 0x0237, 8, 10.0, 1));
        assert!(read.online && read.fresh);
        let output =
            DriveOutput { control: control::ENABLE, mode: Mode::Position, position: 5, ..DriveOutput::default() };
        drive.ask(&output);
        let mut bytes = [0; 7];
        Image::of(&mapping.commanded).pack(|word| drive.value(word, &output), &mut bytes);
        assert_eq!(bytes, [0x0F, 0, 5, 0, 0, 0, 8]);
        assert_eq!(drive.next_request(0), None, "no object is exchanged by SDO");
    }
}

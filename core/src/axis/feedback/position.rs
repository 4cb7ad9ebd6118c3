//! The actual position of an axis and its source.
//!
//! Law      position(k) = position(k-1) + change of the source. The first value of a source is the position itself,
//!          unless the change to it is soft. An encoder of section `encoders` is one physical device with several
//!          users: each has its own offset to it
//! Reads    the process data of the drive, the encoders in this cycle, ENCODERTYPE, ENCCONTROL, MD4, MD5, MD34, MD41
//! Writes   actual position, change, velocity; the last index pulse; the findings of supervision
//! Refuses  another source while the axis is on
//! Source   MACS-ENC-01, -04, -07, -08, -11, -12, -13; WF-ABS, WF-MON-01, -02; contract section 8

use crate::axis::state::{Axis, Claim, Context, Failure, Found, Sensor, Source};
use crate::code::Code;
use crate::drive::{DriveInput, EncoderInput};
use crate::encoder::{COUNT, Encoder, Form, Lead, PulseCheck, Pulses};
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::object::Object;
use crate::parameter::{AxisParameters, Row};
use crate::position::Position;
use crate::vocabulary::Notice;

impl Axis {
    /// Selects the source of the parameters.
    fn choose_source(&mut self) {
        if !self.parameters.take_written() {
            // The source depends only on the parameters and the cell.
            return;
        }
        let chosen = Source::of(self.setup.wired, self.setup.encoders, &self.parameters);
        let Ok(source) = chosen else { return };
        if source.reads_as(self.sources.sensor().source) {
            self.sources.sensor_mut().source = source;
            self.feedback.counter_mut().set_check_form(source.form());
            return;
        }
        let soft = self.parameters.encoder.enccontrol & 1 == 1;
        *self.sources.sensor_mut() = Sensor {
            source,
            starts: Some(soft.then_some(self.feedback.counter().position())),
            index_known: false,
            pulses: Pulses::default(),
            ..*self.sources.sensor()
        };
        *self.feedback.counter_mut() = self.sources.sensor().reader();
        if !soft {
            self.homing.forget();
            self.loops.compensation_mut().forget_counts();
        }
    }

    /// Checks whether the axis may have these parameters now.
    ///
    /// # Errors
    /// ENCODER, the size of an absolute encoder, would change the source of an axis that is on, which would lose
    /// its position. Other parameters that select a source are refused by their rows.
    pub fn admits_source(&self, candidate: &AxisParameters) -> Result<(), Refusal> {
        let source = |p| Source::of(self.setup.wired, self.setup.encoders, p);
        let stays = match (source(&self.parameters), source(candidate)) {
            (Ok(before), Ok(after)) => after.reads_as(before),
            _ => true,
        };
        if stays || self.is_virtual() || self.is_idle() {
            return Ok(());
        }
        let asked = Number::Count(candidate.macs.encoder);
        let refusal = self.refuse(Code::NOT_DISABLED).with(asked, Number::None);
        Err(Refusal { parameter: Some(const { Row::place("encoder") }), ..refusal })
    }

    /// Reads the source. The inputs of all axes are read before any axis moves.
    pub(in crate::axis) fn read_source(&mut self, input: &DriveInput, encoders: &[Encoder], raw: &[EncoderInput]) {
        let beside = self.subtract_compensation();
        let before = self.feedback.counter().position();
        self.choose_source();
        let index;
        let mut lead = Lead { uneven: COUNT, ..Lead::default() };
        let mut changed;
        match self.sources.sensor().source {
            Source::Drive(_) | Source::Simulated => {
                (changed, lead) = self.read_drive(input);
                index = if self.shows_command() {
                    self.simulated_mark().map(|place| self.turn_counts(place))
                } else {
                    input.index.filter(|_| input.online).map(|count| self.feedback.counter().locate(count))
                };
            }
            Source::Encoder(place) => {
                let place = usize::from(place);
                let (encoder, word) = (encoders.get(place), raw.get(place).copied().unwrap_or_default());
                let of = encoder.map(Encoder::lead).unwrap_or_default();
                self.sources.sensor_mut().raw = word.count;
                if encoder.is_some_and(Encoder::is_restarted) {
                    self.note_new_coordinate();
                }
                (changed, lead.valid, lead.velocity) = (of.change.floor(), of.valid, of.velocity);
                self.feedback.counter_mut().advance(changed);
                if self.sources.sensor().starts.is_some() && of.valid {
                    changed = 0;
                    let counter = self.feedback.counter_mut();
                    counter.shift(of.position.floor().wrapping_sub(counter.position()));
                }
                let offset = self.feedback.counter().position().wrapping_sub(of.position.floor());
                let mark = word.index.filter(|_| of.valid).zip(encoder);
                index = mark.map(|(count, encoder)| encoder.locate(count).wrapping_add(offset));
            }
        }
        if let Some(kept) = self.sources.sensor().starts.filter(|_| lead.valid) {
            self.sources.sensor_mut().starts = None;
            match kept {
                Some(kept) => {
                    let counter = self.feedback.counter_mut();
                    counter.shift(kept.wrapping_sub(counter.position()));
                }
                None => {
                    let way = self.turn_counts(self.feedback.counter().position().wrapping_sub(before));
                    self.sources.sensor_mut().moved += Position::whole(way);
                }
            }
        }
        self.take_actual(changed, lead, input.count, index);
        self.add_load_motion(beside);
    }

    /// As [`read_source`](Self::read_source) for a drive that is online, with neither new coordinate nor index pulse.
    /// Returns false if its value was invalid.
    #[inline]
    pub(in crate::axis) fn read_counts(&mut self, input: &DriveInput) -> bool {
        if !matches!(self.feedback.counter().form(), Form::Incremental(_)) {
            let (changed, lead) = self.read_drive(input);
            self.take_actual(changed, lead, input.count, None);
            return lead.valid && self.feedback.counter().is_good();
        }
        // Every count of an incremental encoder is valid.
        let change = self.feedback.counter_mut().take(input.count, input.epoch, true).change;
        let sense = self.direction();
        let position = sense.invert(self.feedback.counter().position());
        self.feedback.set_origin_at(input.count);
        let sensor = self.sources.sensor_mut();
        (sensor.raw, sensor.seen) = (input.count, position);
        self.feedback.show(Lead {
            position: Position::whole(position),
            change: Position::whole(sense.invert(change)),
            velocity: sense.invert_real(input.velocity),
            uneven: COUNT,
            valid: true,
        });
        true
    }

    /// Reads the value of the drive and returns the change of its counts and the position data known so far.
    fn read_drive(&mut self, input: &DriveInput) -> (i64, Lead) {
        let mut lead = Lead { uneven: COUNT, ..Lead::default() };
        let mut changed = 0;
        self.sources.sensor_mut().raw = input.count;
        if input.online {
            if self.feedback.counter().epoch().is_some_and(|epoch| epoch != input.epoch) {
                self.note_new_coordinate();
            }
            let reading = self.feedback.counter_mut().take(input.count, input.epoch, true);
            changed = reading.change;
            lead.valid = reading.valid;
            if reading.substituted && self.feedback.counter().bad_in_a_row() == 1 {
                self.sources.sensor_mut().found = Some(Found::Substituted);
            }
            if reading.restarted {
                self.sources.sensor_mut().pulses = Pulses::default();
            }
        }
        let told = matches!(self.feedback.counter().form(), Form::Incremental(_));
        lead.velocity = if told { input.velocity } else { changed as f64 / self.cycle_s() };
        (changed, lead)
    }

    /// Sets the actual position from the counter.
    fn take_actual(&mut self, changed: i64, lead: Lead, raw: i64, index: Option<i64>) {
        let count = self.feedback.counter().count().unwrap_or(raw);
        self.feedback.set_origin_at(count);
        self.sources.sensor_mut().marked = index.is_some();
        if let Some(mark) = index {
            self.observed.note_index(Position::whole(self.turn_counts(mark)));
            self.sources.sensor_mut().index_known = true;
        }
        self.check_pulses(changed, index);
        self.feedback.show(Lead {
            position: Position::whole(self.turn_counts(self.feedback.counter().position())),
            change: Position::whole(self.turn_counts(changed)),
            velocity: self.convert_direction(lead.velocity),
            ..lead
        });
        if !self.shows_command() {
            self.sources.sensor_mut().seen = self.feedback.position().floor();
        }
    }

    /// Whether supervision has found something to report.
    pub(in crate::axis) fn has_supervision_report(&self) -> bool {
        self.sources.sensor().found.is_some() || self.jump().is_some()
    }

    /// Returns the last simulated index pulse that the command of the cycle before has passed, if any. There is one at
    /// each multiple of ENCODERFREQ (MACS-ENC-13). It is read one cycle later, as inputs are.
    fn simulated_mark(&mut self) -> Option<i64> {
        let every = self.parameters.encoder.encoderfreq.max(1);
        let here = self.feedback.position().floor();
        let from = std::mem::replace(&mut self.sources.sensor_mut().seen, here);
        // Forward, a pulse is passed when its position is reached; backward, when it is left.
        let behind = here.div_euclid(every).saturating_mul(every);
        let ahead = from.div_euclid(every).saturating_mul(every);
        match here.cmp(&from) {
            std::cmp::Ordering::Greater => (behind > from).then_some(behind),
            std::cmp::Ordering::Less => (ahead > here).then_some(behind.saturating_add(every)),
            std::cmp::Ordering::Equal => None,
        }
    }

    /// Returns the position of the last index pulse if it is still valid.
    pub(in crate::axis) fn known_index(&self) -> Option<Position> {
        self.sources.sensor().index_known.then_some(self.observed.index_position())
    }

    /// Returns the position of the index pulse of this cycle, of the encoder in use.
    pub(in crate::axis) fn index_of_cycle(&self) -> Option<Position> {
        self.sources.sensor().marked.then_some(self.observed.index_position())
    }

    /// Returns the source of the index pulses: the entry of section `encoders` that the axis reads, or else its drive,
    /// named by the axis.
    pub fn index_source(&self) -> Object {
        match self.sources.sensor().source {
            Source::Encoder(place) => Object::Encoder(place),
            Source::Drive(_) | Source::Simulated => Object::Axis(self.setup.index),
        }
    }

    /// If monitoring is selected (MD41), the index pulses check the counts (WF-MON-02).
    fn check_pulses(&mut self, change: i64, mark: Option<i64>) {
        let p = &self.parameters;
        let is_counted = matches!(self.sources.sensor().source, Source::Drive(Form::Incremental(_)));
        if !is_counted || p.encoder.monitored == 0 || p.encoder.pulses_or_step == 0 {
            return;
        }
        // Counts of 1 ms at the highest speed, plus 4 (W12). The cast saturates.
        let tolerance = ((p.max_velocity / 1000.0) as i64).saturating_add(4);
        let check = PulseCheck { every: p.encoder.pulses_or_step.saturating_mul(4), tolerance };
        if let Some(by) =
            self.sources.sensor_mut().pulses.step(&check, self.feedback.counter().position(), change, mark)
        {
            self.sources.sensor_mut().found = Some(Found::Pulses { by: self.turn_counts(by), tolerance });
        }
    }

    /// Shifts all stored counts by `by` (in the direction of the drive).
    pub(in crate::axis) fn shift_pulses(&mut self, by: i64) {
        self.sources.sensor_mut().pulses.shift(by);
        self.sources.sensor_mut().seen = self.sources.sensor().seen.wrapping_add(self.turn_counts(by));
    }

    /// Reports the findings of the encoder supervision.
    pub(in crate::axis) fn supervise_source(&mut self, cx: &mut Context<'_>) {
        if let Some((found, allowed)) = self.jump() {
            // It is unknown which counts are right, so the axis is no longer referenced.
            self.homing.forget();
            if !self.is_on() {
                let event = Event::new(Severity::Warn, Kind::Warning, self.object(), Code::ENCODER_JUMP);
                cx.events.push(Event { position: self.feedback.position(), ..event.with(found, allowed) });
            }
        }
        match self.sources.sensor_mut().found.take() {
            None => {}
            Some(Found::Substituted) => {
                let event = Event::new(Severity::Warn, Kind::Warning, self.object(), Code::ENCODER_SUBSTITUTED);
                let errors = Number::Count(self.feedback.counter().errors().min(i64::MAX as u64).cast_signed());
                cx.events.push(Event { position: self.feedback.position(), ..event.with(errors, Number::None) });
            }
            Some(Found::Pulses { by, tolerance }) => {
                let (found, allowed) = (Number::Position(by), Number::Position(tolerance));
                if self.is_on() {
                    self.raise(cx, Failure::of(Code::WF_PULSES).with(found, allowed).before_motion());
                } else {
                    let event = Event::new(Severity::Warn, Kind::Warning, self.object(), Code::WF_PULSES);
                    cx.events.push(Event { position: self.feedback.position(), ..event.with(found, allowed) });
                }
            }
        }
    }

    /// Returns the reason why the axis has no position although its drive responds.
    pub(in crate::axis) fn source_failure(&self) -> Option<Code> {
        let code = if self.parameters.encoder.monitored == 1 { Code::WF_ENCODER_CABLE } else { Code::ENCODER_INVALID };
        (!self.feedback.is_valid() || self.has_lost_velocity()).then_some(code)
    }

    /// Moves the coordinate as other users of the encoder have done. Also reports the move by a new source.
    pub(in crate::axis) fn take_shifts(&mut self, cx: &mut Context<'_>) {
        let pending = std::mem::take(&mut self.sources.sensor_mut().pending);
        if pending != 0 {
            let by = self.turn_counts(pending);
            self.move_coordinate(by);
            self.shift_limits(cx, by);
            self.leave_vocabulary();
        }
        let moved = std::mem::take(&mut self.sources.sensor_mut().moved);
        if moved != Position::ZERO {
            self.vocabularies.notice(Notice::Displaced { by: moved.floor() });
            self.pending.touch_probes_mut().note_new_coordinate();
            self.observed.note_moved(moved);
        }
    }

    /// Applies a new zero: the encoder itself is moved for all its users, unless the zero is soft (MACS-ENC-11).
    pub(in crate::axis) fn share_shift(&mut self, sequence: u64, by: i64) {
        if matches!(self.sources.sensor().source, Source::Encoder(_)) {
            let claim = Claim { sequence, by: self.turn_counts(by), is_soft: self.shares().is_none() };
            self.sources.sensor_mut().claim = Some(claim.after(self.sources.sensor().claim));
        }
    }

    /// Returns the encoder that a new zero would move.
    pub fn shares(&self) -> Option<u16> {
        match self.sources.sensor().source {
            Source::Encoder(place) if self.parameters.encoder.enccontrol & 2 == 0 => Some(place),
            _ => None,
        }
    }

    /// Whether the axis reads that entry of section `encoders`.
    pub fn reads(&self, encoder: u16) -> bool {
        self.sources.sensor().source == Source::Encoder(encoder)
    }

    /// Returns the new zeros of this cycle for an encoder: that of the axis, and that of its master.
    pub fn zero_claims(&self, encoder: u16) -> [Option<Claim>; 2] {
        [self.sources.sensor().claim.filter(|_| self.reads(encoder)), self.master_claim(encoder)]
    }

    /// Clears the new zeros after they are applied.
    pub fn forget_claims(&mut self) {
        self.sources.sensor_mut().claim = None;
        self.forget_master_claim();
    }

    /// Returns the remaining move of the coordinate if the encoder of the axis moves by `by` for the command `last`
    /// (inc, in the direction of the encoder).
    pub fn remaining_shift(&self, by: i64, last: u64) -> i64 {
        match self.sources.sensor().claim {
            Some(claim) if !claim.is_soft => by.saturating_sub(claim.by),
            Some(claim) if claim.sequence > last => 0,
            _ => by,
        }
    }

    /// Whether position and limits can move with the encoder (inc, in its direction).
    pub fn follows_encoder(&self, by: i64) -> bool {
        let by = self.turn_counts(by);
        (self.command.position() + Position::whole(by)).is_legal() && self.limit_out_of_range(by).is_none()
    }

    /// Notes that another user has moved the encoder: the coordinate follows in the next cycle.
    pub fn shift_with_encoder(&mut self, by: i64) {
        self.sources.sensor_mut().pending = self.sources.sensor().pending.wrapping_add(by);
    }

    /// Whether ENCODERTYPE selects an absolute encoder, whose zero no command moves (MACS-ENC-10).
    pub(in crate::axis) fn has_fixed_zero(&self) -> bool {
        !self.is_virtual() && self.parameters.derived.is_absolute
    }

    /// Returns an error if the zero is fixed.
    pub(in crate::axis) fn check_zero_moves(&self) -> Result<(), Refusal> {
        if self.has_fixed_zero() {
            let chosen = Number::Count(self.parameters.encoder.encodertype);
            return Err(self.refuse(Code::ABSOLUTE_ZERO_STANDS).with(chosen, Number::None));
        }
        Ok(())
    }

    /// Whether the axis is referenced: by homing, or by an absolute encoder.
    pub(in crate::axis) fn is_referenced(&self) -> bool {
        self.homing.is_homed() || self.has_fixed_zero() && self.feedback.is_valid()
    }

    /// Whether the axis is at rest without any task.
    pub fn is_idle_at_rest(&self) -> bool {
        (self.rests() || !self.is_on()) && self.task.goal().is_none() && !self.homing.is_running()
    }

    /// Whether the displayed position is the command.
    #[inline]
    pub fn shows_command(&self) -> bool {
        self.is_virtual() || self.is_simulated() && self.is_on()
    }

    /// Returns the change of the encoder in this cycle, and the largest one allowed, if it exceeds that.
    fn jump(&self) -> Option<(Number, Number)> {
        let allowed = self.parameters.encoder.max_jump.filter(|_| !self.is_simulated())?;
        let change = self.feedback.change().floor();
        let is_jump = change.unsigned_abs() > allowed.unsigned_abs();
        is_jump.then_some((Number::Position(change), Number::Position(allowed)))
    }

    /// Stops an axis that is on in the cycle of a jump, regardless of the time allowed for following errors.
    pub(in crate::axis) fn judge_jump(&mut self, cx: &mut Context<'_>) {
        let Some((found, allowed)) = self.jump().filter(|_| !self.is_virtual()) else { return };
        self.raise(cx, Failure::of(Code::ENCODER_JUMP).with(found, allowed));
    }

    /// Whether the actual position is the command (MACS-ENC-13).
    #[inline]
    pub(in crate::axis) fn is_simulated(&self) -> bool {
        self.sources.sensor().is_simulated() && !self.is_virtual()
    }

    /// Returns the number of invalid values so far (SYSVAR 16).
    pub(in crate::axis) fn encoder_errors(&self) -> u64 {
        self.feedback.counter().errors()
    }

    /// Returns the position of raw counts near those of this cycle, in the direction of the drive (inc).
    pub(in crate::axis) fn locate_raw(&self, count: i64, encoders: &[Encoder]) -> i64 {
        match self.sources.sensor().source {
            Source::Drive(_) | Source::Simulated => self.feedback.counter().locate(count),
            Source::Encoder(place) => {
                let Some(encoder) = encoders.get(usize::from(place)) else { return self.feedback.counter().position() };
                let offset = self.feedback.counter().position().wrapping_sub(encoder.lead().position.floor());
                encoder.locate(count).wrapping_add(offset)
            }
        }
    }

    /// Whether the state is possible.
    pub(in crate::axis) fn is_sensor_sound(&self) -> bool {
        let chosen = Source::of(self.setup.wired, self.setup.encoders, &self.parameters);
        let fits = self.is_virtual() || chosen.is_ok();
        fits && self.feedback.counter().is_sound()
            && self.feedback.counter().form() == self.sources.sensor().source.form()
    }
}

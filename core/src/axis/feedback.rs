//! Where the actual position of an axis comes from.
//!
//! Law      position(k) = position(k-1) + change of the source; the first value of a source is the position itself, unless the
//!          change to it is soft. An encoder of section `encoders` is one physical thing with many users: each has its own
//!          offset to it
//! Reads    the drive's words, the encoders as they stand in this cycle, ENCODERTYPE, ENCCONTROL, MD4, MD5, MD34, MD41
//! Writes   actual position, change, velocity; the last index pulse; what supervision has found
//! Refuses  another source while the axis is on
//! Source   MACS-ENC-01, -04, -07, -08, -11, -12, -13; WF-ABS, WF-MON-01, -02; contract section 8

use super::reaction::Failure;
use super::source::{Source, Wired};
use super::{Axis, Context};
use crate::code::Code;
use crate::drive::{DriveInput, EncoderInput};
use crate::encoder::{COUNT, Encoder, Form, Lead, PulseCheck, Pulses, Reader};
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::object::Object;
use crate::parameter::{AxisParameters, Row};
use crate::position::Position;
use crate::vocabulary::Notice;
use serde::{Deserialize, Serialize};

/// What an axis remembers of its source.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Sensor {
    source: Source,
    /// The source is new: its first value is the position, or the position stays this (inc, in the sense of the drive).
    starts: Option<Option<i64>>,
    /// Raw count of this cycle.
    pub raw: i64,
    /// An index pulse came in this cycle.
    marked: bool,
    /// Where the last one was holds in the coordinate of the axis.
    pub index_known: bool,
    /// Where the axis was when it was read last (inc).
    seen: i64,
    pulses: Pulses,
    /// What supervision has found in this cycle.
    found: Option<Found>,
    /// By how much a new source has moved the coordinate.
    moved: Position,
    /// Others who share the encoder have moved its value by so much (inc, in the sense of the drive).
    pending: i64,
    /// The new zero of this cycle.
    claim: Option<Claim>,
}

/// A new zero of one cycle: of an encoder, or of a master that is one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Claim {
    /// Number of the command that has set it: of several of one encoder the last one stands.
    pub sequence: u64,
    /// By how much its axis has moved what it shows (inc, in the sense of the encoder).
    pub by: i64,
    /// It is one of the axis alone (MACS-ENC-11).
    pub is_soft: bool,
}

impl Claim {
    /// The same behind one of the same cycle, if there is one.
    pub fn after(self, before: Option<Self>) -> Self {
        Self { by: before.map_or(0, |before| before.by).saturating_add(self.by), ..self }
    }
}

/// What supervision finds, to be told when events may be.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
enum Found {
    Substituted,
    Pulses { by: i64, tolerance: i64 },
}

impl Sensor {
    pub(super) fn new(wired: Wired, encoders: usize, parameters: &AxisParameters) -> Self {
        // What cannot be read was refused before.
        let source = Source::of(wired, encoders, parameters).unwrap_or(Source::Drive(Form::Incremental(64)));
        Self {
            source,
            starts: matches!(source, Source::Encoder(_)).then_some(None),
            raw: 0,
            marked: false,
            index_known: false,
            seen: 0,
            pulses: Pulses::default(),
            found: None,
            moved: Position::ZERO,
            pending: 0,
            claim: None,
        }
    }

    /// Reads the drive's words.
    pub(super) fn reader(&self) -> Reader {
        Reader::new(self.source.form())
    }

    pub(super) fn is_simulated(&self) -> bool {
        self.source == Source::Simulated
    }

    /// Is there no other user, nothing to take over and nothing to tell?
    pub(super) fn is_settled(&self) -> bool {
        let is_own = !matches!(self.source, Source::Encoder(_));
        let begins = self.starts.is_some() || self.marked || self.pending != 0 || self.moved != Position::ZERO;
        is_own && !begins && self.found.is_none() && self.claim.is_none()
    }
}

impl Axis {
    /// Takes over the source that its parameters name.
    fn choose_source(&mut self) {
        if !self.parameters.take_new() {
            // It follows from them and from the cell alone.
            return;
        }
        let chosen = Source::of(self.setup.wired, self.setup.encoders, &self.parameters);
        let Ok(source) = chosen else { return };
        if source.reads_as(self.sensor.source) {
            self.sensor.source = source;
            self.counter.judge_by(source.form());
            return;
        }
        let soft = self.parameters.encoder.enccontrol & 1 == 1;
        self.sensor = Sensor {
            source,
            starts: Some(soft.then_some(self.counter.position())),
            index_known: false,
            pulses: Pulses::default(),
            ..self.sensor
        };
        self.counter = self.sensor.reader();
        if !soft {
            self.homing.forget();
            self.compensation.forget_counts();
        }
    }

    /// May it have these parameters now?
    ///
    /// # Errors
    /// They would make another source of ENCODER, which is the size of an absolute encoder: an axis that is on loses its place.
    /// What else chooses a source is refused by its row.
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

    /// Reads its source. Inputs of all axes are read before any axis moves.
    pub(super) fn read_source(&mut self, input: &DriveInput, encoders: &[Encoder], raw: &[EncoderInput]) {
        let beside = self.take_compensation();
        let before = self.counter.position();
        self.choose_source();
        let index;
        let mut lead = Lead { uneven: COUNT, ..Lead::default() };
        let mut changed;
        match self.sensor.source {
            Source::Drive(_) | Source::Simulated => {
                (changed, lead) = self.read_drive(input);
                index = if self.shows_command() {
                    self.simulated_mark().map(|place| self.turn_counts(place))
                } else {
                    input.index.filter(|_| input.online).map(|count| self.counter.locate(count))
                };
            }
            Source::Encoder(place) => {
                let place = usize::from(place);
                let (encoder, word) = (encoders.get(place), raw.get(place).copied().unwrap_or_default());
                let of = encoder.map(Encoder::lead).unwrap_or_default();
                self.sensor.raw = word.count;
                if encoder.is_some_and(Encoder::is_anew) {
                    self.note_new_coordinate();
                }
                (changed, lead.valid, lead.velocity) = (of.change.floor(), of.valid, of.velocity);
                self.counter.advance(changed);
                if self.sensor.starts.is_some() && of.valid {
                    changed = 0;
                    self.counter.shift(of.position.floor().wrapping_sub(self.counter.position()));
                }
                let offset = self.counter.position().wrapping_sub(of.position.floor());
                let mark = word.index.filter(|_| of.valid).zip(encoder);
                index = mark.map(|(count, encoder)| encoder.locate(count).wrapping_add(offset));
            }
        }
        if let Some(kept) = self.sensor.starts.filter(|_| lead.valid) {
            self.sensor.starts = None;
            match kept {
                Some(kept) => self.counter.shift(kept.wrapping_sub(self.counter.position())),
                None => {
                    let way = self.turn_counts(self.counter.position().wrapping_sub(before));
                    self.sensor.moved += Position::whole(way);
                }
            }
        }
        self.take_actual(changed, lead, input.count, index);
        self.move_beside_counts(beside);
    }

    /// As [`read_source`](Self::read_source) of a drive that is online, has no new coordinate and no index pulse; false where its word
    /// was no good one.
    #[inline]
    pub(super) fn read_counts(&mut self, input: &DriveInput) -> bool {
        if !matches!(self.counter.form(), Form::Incremental(_)) {
            let (changed, lead) = self.read_drive(input);
            self.take_actual(changed, lead, input.count, None);
            return lead.valid && self.counter.is_good();
        }
        // Every count is a good one.
        let change = self.counter.take(input.count, input.epoch, true).change;
        let sense = self.turned();
        let position = sense.turn(self.counter.position());
        self.origin = self.counter.position().wrapping_sub(input.count);
        (self.sensor.raw, self.sensor.seen) = (input.count, position);
        self.actual = Lead {
            position: Position::whole(position),
            change: Position::whole(sense.turn(change)),
            velocity: sense.turn_real(input.velocity),
            uneven: COUNT,
            valid: true,
        };
        true
    }

    /// Takes the word of the drive: the change of its counts, and what they say so far.
    pub(super) fn read_drive(&mut self, input: &DriveInput) -> (i64, Lead) {
        let mut lead = Lead { uneven: COUNT, ..Lead::default() };
        let mut changed = 0;
        self.sensor.raw = input.count;
        if input.online {
            if self.counter.epoch().is_some_and(|epoch| epoch != input.epoch) {
                self.note_new_coordinate();
            }
            let reading = self.counter.take(input.count, input.epoch, true);
            changed = reading.change;
            lead.valid = reading.valid;
            if reading.substituted && self.counter.bad_in_a_row() == 1 {
                self.sensor.found = Some(Found::Substituted);
            }
            if reading.restarted {
                self.sensor.pulses = Pulses::default();
            }
        }
        let told = matches!(self.counter.form(), Form::Incremental(_));
        lead.velocity = if told { input.velocity } else { changed as f64 / self.cycle_s() };
        (changed, lead)
    }

    /// The actual position by what the counter has counted.
    pub(super) fn take_actual(&mut self, changed: i64, lead: Lead, raw: i64, index: Option<i64>) {
        let count = self.counter.count().unwrap_or(raw);
        self.origin = self.counter.position().wrapping_sub(count);
        self.sensor.marked = index.is_some();
        if let Some(mark) = index {
            self.index = (self.index.0.wrapping_add(1), Position::whole(self.turn_counts(mark)));
            self.sensor.index_known = true;
        }
        self.check_pulses(changed, index);
        self.actual = Lead {
            position: Position::whole(self.turn_counts(self.counter.position())),
            change: Position::whole(self.turn_counts(changed)),
            velocity: self.across(lead.velocity),
            ..lead
        };
        if !self.shows_command() {
            self.sensor.seen = self.actual.position.floor();
        }
    }

    /// Has supervision found something that it is to tell?
    pub(super) fn supervision_tells(&self) -> bool {
        self.sensor.found.is_some() || self.jump().is_some()
    }

    /// The last simulated mark that the command of the cycle before has passed, if any: one lies at each multiple of ENCODERFREQ
    /// (MACS-ENC-13). They are seen in the cycle after, as inputs are.
    fn simulated_mark(&mut self) -> Option<i64> {
        let every = self.parameters.encoder.encoderfreq.max(1);
        let here = self.actual.position.floor();
        let from = std::mem::replace(&mut self.sensor.seen, here);
        // Forwards a mark is passed where it is reached; backwards, where it is left behind.
        let behind = here.div_euclid(every).saturating_mul(every);
        let ahead = from.div_euclid(every).saturating_mul(every);
        match here.cmp(&from) {
            std::cmp::Ordering::Greater => (behind > from).then_some(behind),
            std::cmp::Ordering::Less => (ahead > here).then_some(behind.saturating_add(every)),
            std::cmp::Ordering::Equal => None,
        }
    }

    /// The place of its last index pulse, where that still holds.
    pub(super) fn known_index(&self) -> Option<Position> {
        self.sensor.index_known.then_some(self.index.1)
    }

    /// The place of the index pulse of this cycle, of whatever encoder it reads.
    pub(super) fn index_of_cycle(&self) -> Option<Position> {
        self.sensor.marked.then_some(self.index.1)
    }

    /// What gives its index pulses: the entry of section `encoders` that it reads, or else its drive, by the axis.
    pub fn index_source(&self) -> Object {
        match self.sensor.source {
            Source::Encoder(place) => Object::Encoder(place),
            Source::Drive(_) | Source::Simulated => Object::Axis(self.setup.index),
        }
    }

    /// Where monitoring is selected (MD41), the index watches the pulses (WF-MON-02).
    fn check_pulses(&mut self, change: i64, mark: Option<i64>) {
        let p = &self.parameters;
        let is_counted = matches!(self.sensor.source, Source::Drive(Form::Incremental(_)));
        if !is_counted || p.encoder.monitored == 0 || p.encoder.pulses_or_step == 0 {
            return;
        }
        // Counts of 1 ms at the highest speed, and 4 (W12); the cast saturates.
        let tolerance = ((p.max_velocity / 1000.0) as i64).saturating_add(4);
        let check = PulseCheck { every: p.encoder.pulses_or_step.saturating_mul(4), tolerance };
        if let Some(by) = self.sensor.pulses.step(&check, self.counter.position(), change, mark) {
            self.sensor.found = Some(Found::Pulses { by: self.turn_counts(by), tolerance });
        }
    }

    /// Every count of its coordinate is `by` more from now on (in the sense of the drive).
    pub(super) fn shift_pulses(&mut self, by: i64) {
        self.sensor.pulses.shift(by);
        self.sensor.seen = self.sensor.seen.wrapping_add(self.turn_counts(by));
    }

    /// Tells what supervision of the encoder has found.
    pub(super) fn supervise_source(&mut self, cx: &mut Context<'_>) {
        if let Some((found, allowed)) = self.jump() {
            // Whichever of its counts are right, those of its zero are not known any more.
            self.homing.forget();
            if !self.is_on() {
                let event = Event::new(Severity::Warn, Kind::Warning, self.object(), Code::ENCODER_JUMP);
                cx.events.push(Event { position: self.actual.position, ..event.with(found, allowed) });
            }
        }
        match self.sensor.found.take() {
            None => {}
            Some(Found::Substituted) => {
                let event = Event::new(Severity::Warn, Kind::Warning, self.object(), Code::ENCODER_SUBSTITUTED);
                let errors = Number::Count(self.counter.errors().min(i64::MAX as u64).cast_signed());
                cx.events.push(Event { position: self.actual.position, ..event.with(errors, Number::None) });
            }
            Some(Found::Pulses { by, tolerance }) => {
                let (found, allowed) = (Number::Position(by), Number::Position(tolerance));
                if self.is_on() {
                    self.raise(cx, Failure::of(Code::WF_PULSES).with(found, allowed).before_motion());
                } else {
                    let event = Event::new(Severity::Warn, Kind::Warning, self.object(), Code::WF_PULSES);
                    cx.events.push(Event { position: self.actual.position, ..event.with(found, allowed) });
                }
            }
        }
    }

    /// Why the axis has no position, if it has none although its drive answers.
    pub(super) fn source_failure(&self) -> Option<Code> {
        let code = if self.parameters.encoder.monitored == 1 { Code::WF_ENCODER_CABLE } else { Code::ENCODER_INVALID };
        (!self.actual.valid || self.has_lost_velocity()).then_some(code)
    }

    /// Moves the coordinate as others have done who share the encoder; what a new source has moved is told as well.
    pub(super) fn take_shifts(&mut self, cx: &mut Context<'_>) {
        let pending = std::mem::take(&mut self.sensor.pending);
        if pending != 0 {
            let by = self.turn_counts(pending);
            self.move_coordinate(by);
            self.shift_limits(cx, by);
            self.leave_vocabulary();
        }
        let moved = std::mem::take(&mut self.sensor.moved);
        if moved != Position::ZERO {
            self.vocabularies.notice(Notice::Displaced { by: moved.floor() });
            self.touch_probes.note_new_coordinate();
            self.moved += moved;
        }
    }

    /// A new zero: the encoder itself is moved for all of its users, unless the zero is soft (MACS-ENC-11).
    pub(super) fn share_shift(&mut self, sequence: u64, by: i64) {
        if matches!(self.sensor.source, Source::Encoder(_)) {
            let claim = Claim { sequence, by: self.turn_counts(by), is_soft: self.shares().is_none() };
            self.sensor.claim = Some(claim.after(self.sensor.claim));
        }
    }

    /// The encoder that it would move with a new zero.
    pub fn shares(&self) -> Option<u16> {
        match self.sensor.source {
            Source::Encoder(place) if self.parameters.encoder.enccontrol & 2 == 0 => Some(place),
            _ => None,
        }
    }

    /// Does it read that entry of section `encoders`?
    pub fn reads(&self, encoder: u16) -> bool {
        self.sensor.source == Source::Encoder(encoder)
    }

    /// The new zeros of this cycle that concern an encoder: that of its own position, and that of its master.
    pub fn claims(&self, encoder: u16) -> [Option<Claim>; 2] {
        [self.sensor.claim.filter(|_| self.reads(encoder)), self.master_claim(encoder)]
    }

    /// They are done.
    pub fn forget_claims(&mut self) {
        self.sensor.claim = None;
        self.forget_master_claim();
    }

    /// By how much its coordinate is to move yet, where the encoder that it reads moves by so much for the command `last` (inc, in
    /// the sense of the encoder).
    pub fn left_of_shift(&self, by: i64, last: u64) -> i64 {
        match self.sensor.claim {
            Some(claim) if !claim.is_soft => by.saturating_sub(claim.by),
            Some(claim) if claim.sequence > last => 0,
            _ => by,
        }
    }

    /// Can its position and its limits go with the encoder (inc, in its sense)?
    pub fn follows_encoder(&self, by: i64) -> bool {
        let by = self.turn_counts(by);
        (self.command.position + Position::whole(by)).is_legal() && self.limit_out_of_range(by).is_none()
    }

    /// The encoder that it reads was moved by someone else: its coordinate follows in the next cycle.
    pub fn shift_with_encoder(&mut self, by: i64) {
        self.sensor.pending = self.sensor.pending.wrapping_add(by);
    }

    /// Has it an absolute encoder by ENCODERTYPE, whose zero no command moves (MACS-ENC-10)?
    pub(super) fn has_fixed_zero(&self) -> bool {
        !self.is_virtual() && self.parameters.derived.is_absolute
    }

    /// Refuses to move a zero that stands.
    pub(super) fn check_zero_moves(&self) -> Result<(), Refusal> {
        if self.has_fixed_zero() {
            let chosen = Number::Count(self.parameters.encoder.encodertype);
            return Err(self.refuse(Code::ABSOLUTE_ZERO_STANDS).with(chosen, Number::None));
        }
        Ok(())
    }

    /// Does it know where it is: by homing, or because an absolute encoder tells it?
    pub(super) fn knows_zero(&self) -> bool {
        self.homing.is_homed() || self.has_fixed_zero() && self.actual.valid
    }

    /// Does it stand still, with nothing to do?
    pub fn stands_idle(&self) -> bool {
        (self.rests() || !self.is_on()) && self.goal.is_none() && !self.homing.is_running()
    }

    /// Is what others see of its position its command?
    #[inline]
    pub fn shows_command(&self) -> bool {
        self.is_virtual() || self.is_simulated() && self.is_on()
    }

    /// How far the encoder has moved in this cycle, if that is further than its axis can.
    fn jump(&self) -> Option<(Number, Number)> {
        let allowed = self.parameters.encoder.max_jump.filter(|_| !self.is_simulated())?;
        let change = self.actual.change.floor();
        let is_jump = change.unsigned_abs() > allowed.unsigned_abs();
        is_jump.then_some((Number::Position(change), Number::Position(allowed)))
    }

    /// A jump stops an axis that is on in its cycle, whatever time a following error may take.
    pub(super) fn judge_jump(&mut self, cx: &mut Context<'_>) {
        let Some((found, allowed)) = self.jump().filter(|_| !self.is_virtual()) else { return };
        self.raise(cx, Failure::of(Code::ENCODER_JUMP).with(found, allowed));
    }

    /// Is its actual position its command (MACS-ENC-13)?
    #[inline]
    pub(super) fn is_simulated(&self) -> bool {
        self.sensor.is_simulated() && !self.is_virtual()
    }

    /// Bad words so far (SYSVAR 16).
    pub(super) fn encoder_errors(&self) -> u64 {
        self.counter.errors()
    }

    /// The position of raw counts near those of this cycle, in the sense of the drive (inc).
    pub(super) fn locate_raw(&self, count: i64, encoders: &[Encoder]) -> i64 {
        match self.sensor.source {
            Source::Drive(_) | Source::Simulated => self.counter.locate(count),
            Source::Encoder(place) => {
                let Some(encoder) = encoders.get(usize::from(place)) else { return self.counter.position() };
                let offset = self.counter.position().wrapping_sub(encoder.lead().position.floor());
                encoder.locate(count).wrapping_add(offset)
            }
        }
    }

    /// Could its state have come about?
    pub(super) fn is_sensor_sound(&self) -> bool {
        let chosen = Source::of(self.setup.wired, self.setup.encoders, &self.parameters);
        let fits = self.is_virtual() || chosen.is_ok();
        fits && self.counter.is_sound() && self.counter.form() == self.sensor.source.form()
    }
}

//! Registration marks of an axis and of its master, from the inputs of the machine to the motion of the axis (SYNCM).
//!
//! Law      the position of a latch is interpolated linearly within the cycle; that of an index pulse is the one of its
//!          encoder. The correction of a pair of marks is added to the gear: with SYNCOFFTIME as its trapezoid,
//!          otherwise with SYNCMFTIME evenly over one distance between marks, otherwise with a negative SYNCVFTIME over
//!          a hundredth of it, in ms, otherwise at once. The offset acts from the first pair on, or after its
//!          correction
//! Reads    index pulses, latches, levels of conditions, parameters
//! Writes   the added motion; an event for each pair, one when marks are first missed, and one when extra marks first
//!          appear
//! Refuses  nothing: the sources of marks were checked when the axis was coupled
//! Source   MACS-MARK-01, -05, -06, -11 to -14, -20, -21, A-33, A-39

use crate::axis::state::conditioning::shift;
use crate::axis::state::{Axis, Context, MarkPath, Seen};
use crate::code::Code;
use crate::encoder::Lead;
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::object::{Leader, Object};
use crate::parameter::{MarkSignal, Marks, OffsetRates, Synchronization};
use crate::position::Position;
use crate::sync::marker::{Found, LawInputs, MarkSide, Situation};
use crate::sync::{Leads, SyncMode, Transmission, status};

/// From this value of SYNCMSTART on, the offset waits for the first correction.
const OFFSET_LATER: i64 = 1_000;

/// Time over which the speed of a counted master is smoothed if there is no filter (ms).
const MEAN_TIME: f64 = 64.0;

/// Divisor of SYNCVFTIME that gives the time over which a correction is spread.
const SPREAD_SHARE: f64 = 100.0;

/// Result of marks in a cycle.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::axis) struct MarkStep {
    /// Correction of the gear, as a share of the change of the master.
    pub gear: f64,
    /// Motion added to the slave.
    pub way: Position,
    /// Motion added to the master of a cam; its whole motion while the cam waits for its first mark.
    pub master: Position,
    /// Whether the cam waits for its first mark.
    pub holds: bool,
}

/// Displayed values of the marks of a coupling.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::axis) struct ShownMarks {
    /// Error of the last pair (inc of the slave).
    pub error: f64,
    /// Correction of the last pair (inc of the slave).
    pub correction: f64,
    /// Average distance between marks (inc of the master).
    pub distance: f64,
    /// Missed marks of both sides.
    pub missed: u64,
    /// Extra marks of both sides.
    pub extra: u64,
    /// MARKERFILTER (marks).
    pub filter: f64,
    /// KORRTAU (pairs of marks).
    pub correction_filter: f64,
    /// STARTKORRREST (inc of the slave).
    pub start_left: f64,
    /// MMARKERR (inc of the slave).
    pub distance_error: f64,
}

/// Both sides in a cycle, master first, with the parameters to check their marks.
pub(in crate::axis) struct Sides {
    pub seen: [Seen; 2],
    pub changes: [Position; 2],
    /// Marks that found no room while waiting.
    pub lost: [u32; 2],
    pub sync: Synchronization,
    pub marks: Marks,
    /// Increments of the second side per increment of the first one.
    pub ratio: f64,
}

/// Returns the number of the input for marks, from 1. If the type names no input, it is that of the encoder, or 0 if
/// the encoder has no number either.
fn input_of(signal: MarkSignal, encoder: Option<u16>) -> Option<u16> {
    let own = encoder.map_or(0, |encoder| encoder.saturating_add(1));
    signal.input.map(|input| if input == 0 { own } else { input })
}

/// Returns the number of a leader by which its input is found; the virtual master has none.
fn number_of(leader: Leader) -> Option<u16> {
    match leader {
        Leader::AxisCommand(place) | Leader::AxisActual(place) | Leader::Simulated(place) => Some(place),
        Leader::Encoder(place) | Leader::Sink(place) | Leader::Sum(place) => Some(place),
        Leader::Virtual => None,
    }
}

impl Axis {
    /// Checks whether the sources of marks exist. `has_index`: whether the leader, and the encoder of the axis, have an
    /// index pulse. `latches`: whether an input, by its number, latches; none if it does not exist.
    ///
    /// # Errors
    /// The missing source.
    pub fn check_marks(
        &self,
        (mode, leader, slave_factor): (SyncMode, Leader, i64),
        has_index: [bool; 2],
        latches: impl Fn(u16) -> Option<bool>,
    ) -> Result<(), Refusal> {
        let marks = &self.parameters.marks;
        if mode == SyncMode::Marker {
            self.check_marks_of_gear(slave_factor)?;
        }
        let [leads_index, own_index] = has_index;
        let own_index = own_index && !self.is_virtual() && self.check_zero_moves().is_ok();
        let own = Some(self.setup.index);
        let sides = [(marks.master_type, number_of(leader), leads_index, 0), (marks.slave_type, own, own_index, 1)];
        for (number, encoder, has_index, side) in sides {
            // The other side of a cam is the cam itself.
            if mode == SyncMode::MasterMarker && side == 1 || mode == SyncMode::SlaveMarker && side == 0 {
                continue;
            }
            let signal = MarkSignal::decode(number);
            let refuse = |code, asked: i64| Err(self.refuse(code).with(Number::Count(asked), Number::Count(side)));
            match input_of(signal, encoder) {
                Some(input) if latches(input) != Some(true) => return refuse(Code::MARK_NO_INPUT, input.into()),
                None if !has_index || !signal.rising => return refuse(Code::MARK_NO_INDEX, number),
                _ => {}
            }
            if let Some((input, _)) = signal.condition.filter(|(input, _)| latches(*input).is_none()) {
                return refuse(Code::MARK_NO_INPUT, input.into());
            }
        }
        Ok(())
    }

    /// Checks the start and the distance between marks of a gear.
    fn check_marks_of_gear(&self, slave_factor: i64) -> Result<(), Refusal> {
        let marks = &self.parameters.marks;
        if !matches!(marks.start, 0..=7 | 1_000..=1_007) {
            return Err(self.refuse(Code::MARK_START).with(Number::Count(marks.start), Number::None));
        }
        // One mark may be between master and slave; with more of them the largest distance would be smaller (O-42).
        let (distance, most) =
            (self.parameters.sync.mark_distance, self.parameters.largest_mark_distance(slave_factor, 1));
        if distance > most {
            return Err(self.refuse(Code::MARK_DISTANCE).with(Number::Count(distance), Number::Count(most)));
        }
        if matches!(marks.start % OFFSET_LATER, 3..=5 | 7) && distance == 0 {
            return Err(self.refuse(Code::MARK_NO_DISTANCE).with(Number::Count(marks.start), Number::None));
        }
        Ok(())
    }

    /// Returns the marks of a side in this cycle.
    fn seen(
        &self,
        cx: &Context<'_>,
        signal: MarkSignal,
        (encoder, lead): (Option<u16>, Lead),
        index: Option<Position>,
    ) -> Seen {
        let mut seen = Seen::new();
        let level = |number: u16| cx.inputs.digital(usize::from(number).saturating_sub(1));
        if signal.condition.is_some_and(|(number, high)| level(number) != high) {
            return seen;
        }
        let cycle_ns = self.setup.cycle_ns;
        let now = cx.cycle.saturating_mul(cycle_ns);
        let change = lead.change.to_f64();
        let Some(number) = input_of(signal, encoder) else {
            if let Some(place) = index {
                let before = lead.position - place;
                let share = if change == 0.0 { 0.0 } else { (before.to_f64() / change).clamp(0.0, 1.0) };
                seen.push(before, now.saturating_sub((share * cycle_ns as f64) as u64));
            }
            return seen;
        };
        let Some(io) = usize::from(number).checked_sub(1).and_then(|place| cx.digital_inputs.get(place)) else {
            return seen;
        };
        for latch in cx.latches {
            if latch.object == Object::Io(*io) && latch.rising == signal.rising {
                let before = Position::from_f64(change * (f64::from(latch.age_ns) / cycle_ns as f64));
                seen.push(before, now.saturating_sub(latch.age_ns.into()));
            }
        }
        seen
    }

    /// Returns the marks of master and axis in this cycle.
    fn seen_of_both(
        &self,
        cx: &Context<'_>,
        [master, slave]: [MarkSignal; 2],
        (leader, lead): (Leader, Lead),
    ) -> [Seen; 2] {
        let index = match leader {
            Leader::Encoder(place) => index_of(cx, place),
            Leader::Virtual => cx.leads.virtual_mark,
            _ => None,
        };
        let of_master = self.seen(cx, master, (number_of(leader), lead), index);
        [of_master, self.seen(cx, slave, (Some(self.setup.index), self.feedback.lead()), self.index_of_cycle())]
    }

    /// Returns the distances of master and axis since their last marks of this cycle.
    pub(super) fn marks_of_cycle(
        &self,
        cx: &Context<'_>,
        signals: [MarkSignal; 2],
        leads: (Leader, Lead),
    ) -> [Option<Position>; 2] {
        self.seen_of_both(cx, signals, leads).map(|mut seen| seen.sorted().last().map(|(before, _)| *before))
    }

    /// Processes the marks of this cycle and returns the result. None: no coupling by marks. A spread correction is at
    /// most `most` (inc) in a cycle.
    pub(super) fn step_marks(
        &mut self,
        cx: &mut Context<'_>,
        (lead, passed_on): (Lead, Position),
        tau: Option<f64>,
        most: f64,
    ) -> Option<MarkStep> {
        let mut path = self.coupling.conditioning().marks?;
        let coupling = self.coupling()?;
        let (runs, accuracy) = (coupling.follower.is_in_sync(), coupling.accuracy);
        let cycle_ms = self.cycle_s() * 1e3;
        let seen = self.seen_of_both(cx, [path.master, path.slave], (coupling.leader, lead));
        if path.cam.holds {
            let [mut of_master, _] = seen;
            let since = of_master.sorted().first().map(|(before, _)| *before);
            path.cam.holds = since.is_none();
            self.coupling.conditioning_mut().marks = Some(path);
            return Some(MarkStep { holds: true, master: since.unwrap_or_default(), ..MarkStep::default() });
        }
        let Some(sides) = self.sides_of_cycle(cx, &mut path, seen, (lead, passed_on)) else {
            path.cam.forget();
            self.coupling.conditioning_mut().marks = Some(path);
            return None;
        };
        let Sides { mut seen, changes, lost, sync, marks, ratio } = sides;
        let change = changes[0].to_f64();
        if path.curve.is_some() {
            self.supervise_curve(cx, &mut path, change);
        }
        let share = match tau {
            Some(tau) => (cycle_ms * 1e3 / tau).min(1.0),
            None if lead.uneven > 0.0 => (cycle_ms / MEAN_TIME).min(1.0),
            None => 1.0,
        };
        path.velocity += (change - path.velocity) * share;
        let asked = LawInputs { sync: &sync, marks: &marks, speed: (path.velocity / cycle_ms).abs(), ratio };
        path.marker.advance(changes[0], changes[1]);
        self.take_marks(cx, &mut path, (&mut seen, lost), &asked);
        let at_once = self.correct_by_pairs(cx, &mut path, &asked, (tau, runs, accuracy));
        let gear = path.marker.law().gear_correction(&asked);
        let way = at_once + path.spread.step(change, most);
        let (way, master) =
            if path.mode == SyncMode::MasterMarker { (Position::ZERO, way) } else { (way, Position::ZERO) };
        let step = MarkStep { gear, way, master, holds: false };
        let done = path.ordered - (self.ordered_of(&path) + path.remaining_corrections());
        let is_done = if path.first < Position::ZERO { done <= path.first } else { done >= path.first };
        if path.marker.has_begun() && is_done {
            path.offset_waits = false;
        }
        self.coupling.conditioning_mut().marks = Some(path);
        Some(step)
    }

    /// Returns both sides of the coupling in this cycle; none if a cam cannot be matched.
    fn sides_of_cycle(
        &self,
        cx: &Context<'_>,
        path: &mut MarkPath,
        seen: [Seen; 2],
        (lead, passed_on): (Lead, Position),
    ) -> Option<Sides> {
        if path.mode != SyncMode::Marker {
            return self.sides_of_cam(cx, path, seen, (lead, passed_on));
        }
        // During an approach the ratio of the gear after it applies.
        let ratio = match self.coupling()?.follower.transmission() {
            Transmission::Approach(approach) => approach.ratio().to_f64(),
            gear => gear.signed_slope(),
        };
        let marks = Marks { start: path.start, ..self.parameters.marks };
        let changes = [lead.change, self.feedback.change()];
        Some(Sides { seen, changes, lost: [0; 2], sync: self.parameters.sync, marks, ratio })
    }

    /// Takes the marks of this cycle. Reports when extra marks first appear, and when marks are first missed.
    fn take_marks(
        &self,
        cx: &mut Context<'_>,
        path: &mut MarkPath,
        ([of_master, of_slave], lost): (&mut [Seen; 2], [u32; 2]),
        asked: &LawInputs<'_>,
    ) {
        for (of, seen, extra) in [(MarkSide::Master, of_master, 0), (MarkSide::Slave, of_slave, 1)] {
            let before = *path.marker.side(of);
            if let Some(lost) = lost.get(extra).filter(|lost| **lost > 0) {
                path.marker.count_extra(of, *lost);
                if let Some(flag) = path.extra.get_mut(extra).filter(|told| !**told) {
                    *flag = true;
                    self.report_marks(cx, Code::MARK_EXTRA, of);
                }
            }
            for mark in seen.sorted() {
                let is_extra = path.marker.take(of, *mark, asked) == Found::Extra;
                let told = path.extra.get(extra) == Some(&true);
                if is_extra && !told {
                    self.report_marks(cx, Code::MARK_EXTRA, of);
                }
                if let Some(flag) = path.extra.get_mut(extra) {
                    *flag = is_extra;
                }
            }
            path.marker.check_missed(of, asked);
            if path.marker.side(of).counts().0 != before.counts().0 && !before.is_missed() {
                self.report_marks(cx, Code::MARK_MISSED, of);
            }
        }
    }

    /// Commands the correction of each new pair of marks, and returns the sum of those that are moved at once. `runs`:
    /// whether the slave is synchronized; `accuracy`: its accuracy (inc).
    fn correct_by_pairs(
        &mut self,
        cx: &mut Context<'_>,
        path: &mut MarkPath,
        asked: &LawInputs<'_>,
        (tau, runs, accuracy): (Option<f64>, bool, i64),
    ) -> Position {
        let LawInputs { sync, marks, ratio, .. } = *asked;
        let cycle_ms = self.cycle_s() * 1e3;
        let mut at_once = Position::ZERO;
        loop {
            let under_way = (self.ordered_of(path) + path.remaining_corrections() + at_once).to_f64();
            let offset = self.coupling.conditioning().offset_given() as f64;
            let sense = if path.velocity * ratio < 0.0 { -1.0 } else { 1.0 };
            let situation = Situation { asked: *asked, offset, under_way, runs, sense };
            let had_begun = path.marker.has_begun();
            let was_faulty = path.marker.is_faulty(marks);
            let Some(pair) = path.marker.pair(&situation, accuracy) else { return at_once };
            if !had_begun && marks.start < OFFSET_LATER {
                path.offset_waits = false;
            }
            let correction = Position::from_f64(pair.correction);
            if !had_begun {
                path.first = correction;
            }
            path.ordered += correction;
            if let Some(rates) = sync.offset_rates() {
                if path.mode == SyncMode::MasterMarker {
                    self.coupling.conditioning_mut().shift_master(correction, rates, cycle_ms / 1e3);
                } else {
                    self.add_late(correction, rates, ratio.abs());
                }
            } else if let Some((over, is_time)) = spread_over(asked, tau, cycle_ms) {
                path.spread.add(correction, over, is_time);
            } else {
                at_once += correction;
            }
            let event = Event::new(Severity::Info, Kind::Mark, self.object(), Code::NONE);
            let event = Event { position: self.feedback.position(), ..event };
            cx.events.push(event.with(Number::Real(pair.error), Number::Real(pair.correction)));
            if path.marker.is_faulty(marks) && !was_faulty {
                let event = Event::new(Severity::Warn, Kind::Warning, self.object(), Code::MARK_FAULT);
                cx.events.push(event.with(Number::Real(pair.error), Number::Count(accuracy.saturating_abs())));
            }
        }
    }

    /// Returns the commanded distance of the corrected side that has not been moved yet, without spread corrections.
    fn ordered_of(&self, path: &MarkPath) -> Position {
        if path.mode == SyncMode::MasterMarker {
            self.coupling.conditioning().shift_left()
        } else {
            self.pending_distance()
        }
    }

    /// Checks that nothing but marks may shift the axis against its leader; marks would remove the shift again.
    ///
    /// # Errors
    /// The axis is coupled by marks.
    pub(in crate::axis) fn check_no_marks(&self) -> Result<(), Refusal> {
        let by_marks = self.coupling().is_some_and(|coupling| coupling.follower.mode().has_marks());
        if by_marks { Err(self.refuse(Code::MARKS_SHIFT)) } else { Ok(()) }
    }

    /// Returns the bits of SYNCSTAT that depend on marks.
    pub(in crate::axis) fn status_of_marks(&self) -> u64 {
        let Some(path) = &self.coupling.conditioning().marks else { return 0 };
        let (marker, marks) = (&path.marker, &self.parameters.marks);
        let bits = [
            (marker.is_ready(marks), status::READY),
            (marker.is_faulty(marks), status::FAULT),
            (marker.side(MarkSide::Master).is_missed(), status::MASTER_MARKER_MISSED),
            (marker.side(MarkSide::Slave).is_missed(), status::SLAVE_MARKER_MISSED),
        ];
        bits.into_iter().filter(|(is_set, _)| *is_set).fold(0, |all, (_, bit)| all | bit)
    }

    /// Whether the first pair of marks was corrected, or the axis is not coupled by marks.
    pub(in crate::axis) fn has_marks(&self) -> bool {
        self.coupling.conditioning().marks.as_ref().is_none_or(|path| path.marker.has_begun())
    }

    /// Returns the displayed values of its marks.
    pub(in crate::axis) fn shown_marks(&self) -> ShownMarks {
        let Some(MarkPath { marker, .. }) = &self.coupling.conditioning().marks else { return ShownMarks::default() };
        let (error, correction) = marker.last();
        let [master, slave] = [MarkSide::Master, MarkSide::Slave].map(|of| marker.side(of).counts());
        let asked = LawInputs { sync: &self.parameters.sync, marks: &self.parameters.marks, speed: 0.0, ratio: 1.0 };
        let law = marker.law();
        // The next pair clears the values of a filter that was switched off, but it may never come.
        let filtered = |value: f64| if asked.filter_time().is_some() { value } else { 0.0 };
        ShownMarks {
            error,
            correction,
            distance: law.distance(&asked),
            missed: master.0.saturating_add(slave.0),
            extra: master.1.saturating_add(slave.1),
            filter: filtered(law.filter()),
            correction_filter: filtered(law.correction_filter()),
            start_left: filtered(law.remaining_start_correction()),
            distance_error: filtered(law.distance_error()),
        }
    }

    /// Returns the positions of the axis and its leader at their last marks (inc); 0 before the first mark, and without
    /// a coupling by marks.
    pub(in crate::axis) fn positions_of_marks(&self, leads: &Leads) -> (Position, Position) {
        let (Some(path), Some(coupling)) = (&self.coupling.conditioning().marks, self.coupling()) else {
            return (Position::ZERO, Position::ZERO);
        };
        let place = |of, now: Position| path.marker.side(of).since_mark().map_or(Position::ZERO, |since| now - since);
        let leader = leads.get(coupling.leader).position;
        (place(MarkSide::Slave, self.feedback.position()), place(MarkSide::Master, leader))
    }

    fn report_marks(&self, cx: &mut Context<'_>, code: Code, of: MarkSide) {
        let event = Event::new(Severity::Warn, Kind::Warning, self.object(), code);
        let side = Number::Count(i64::from(of == MarkSide::Slave));
        cx.events.push(Event { position: self.command.position(), ..event.with(side, Number::None) });
    }

    /// Adds a correction that is moved like an offset (MACS-SYNC-14).
    fn add_late(&mut self, way: Position, rates: OffsetRates, slope: f64) {
        let cycle_s = self.cycle_s();
        let rates = OffsetRates { velocity: rates.velocity * slope, acceleration: rates.acceleration * slope };
        let state = self.coupling.conditioning_mut();
        let whole = state.late.map_or(Position::ZERO, |late| late.left()) + way;
        if way != Position::ZERO {
            state.late = Some(shift(whole, rates, cycle_s, state.late.as_ref()));
            state.late_slope = slope;
        }
    }
}

/// Returns the position of the index pulse of an encoder in this cycle.
fn index_of(cx: &Context<'_>, place: u16) -> Option<Position> {
    let input = cx.inputs.encoder.get(usize::from(place)).filter(|input| input.valid)?;
    let encoder = cx.encoders.get(usize::from(place))?;
    input.index.map(|count| Position::whole(encoder.locate(count)))
}

/// Returns the distance (inc) or time (cycles) over which a correction is spread, and whether it is a time. None: at
/// once.
fn spread_over(asked: &LawInputs<'_>, tau: Option<f64>, cycle_ms: f64) -> Option<(f64, bool)> {
    let way = asked.spread().map(|way| (way, false));
    way.or_else(|| tau.map(|tau| ((tau / SPREAD_SHARE).max(1.0) / cycle_ms, true)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tau 100000 us: over 1000 ms, 50000 us: over 500 ms; with SYNCMFTIME over the distance of the marks, otherwise at
    /// once.
    ///
    /// Proves: MACS-SYNC-10, MACS-MARK-13, MACS-O-37
    #[test]
    fn a_correction_is_spread_as_slowly_as_the_filter_gives_back() {
        let sync = Synchronization { mark_distance: 500, ..Synchronization::default() };
        let marks = [Marks::default(), Marks { filter_time: 1_000, ..Marks::default() }];
        let over = |marks: &Marks, tau, cycle_ms| {
            spread_over(&LawInputs { sync: &sync, marks, speed: 10.0, ratio: 1.0 }, tau, cycle_ms)
        };
        let [plain, filtered] = marks.each_ref();
        assert_eq!(over(plain, Some(100_000.0), 1.0), Some((1_000.0, true)));
        assert_eq!(over(plain, Some(50_000.0), 1.0), Some((500.0, true)));
        assert_eq!(over(plain, Some(50_000.0), 4.0), Some((125.0, true)));
        assert_eq!(over(plain, Some(50.0), 1.0), Some((1.0, true)));
        assert_eq!(over(filtered, Some(50_000.0), 1.0), Some((500.0, false)));
        assert_eq!(over(plain, None, 1.0), None);
    }
}

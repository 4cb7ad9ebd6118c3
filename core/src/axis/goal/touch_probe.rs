//! Touch probe without a motion: records the position of the axis at a latch, in any motion (MC_TouchProbe,
//! MC_AbortTrigger).
//!
//! Law      recorded = position of the axis at the latch, linear within the change of its cycle. A touch probe without
//!          window records every latch of its edge; with a window, those whose position is between the first and the
//!          last position, both included, within the turn of an axis with modulo. It ends with the first record, or
//!          records until it is aborted
//! Reads    the latches of the cycle, its index pulse, the actual position
//! Writes   an event `latch` for each record, the signals of the last one, `done` at the end; moves nothing
//! Refuses  more touch probes than there is room for; a window that ends before it begins, on an axis without modulo
//! Source   PLCopen part 1 (MC_TouchProbe, MC_AbortTrigger)

use super::probe::is_awaited;
use crate::axis::state::touch_probes::{MAX_TOUCH_PROBES, Window};
use crate::axis::state::{Armed, Axis, Context};
use crate::code::Code;
use crate::command::{AbortTrigger, ProbeEdge, TouchProbe};
use crate::drive::MAX_LATCHES;
use crate::event::{Event, EventQueue, Kind, Number, Refusal, Severity};
use crate::position::Position;
use crate::signal::Board;
use std::cmp::Reverse;

/// Largest number of events of the touch probes of one axis in a cycle: each latch is recorded by one of them, and each
/// may record the index and end.
pub(crate) const MOST_RECORDS: usize = MAX_LATCHES + 2 * MAX_TOUCH_PROBES;

/// Number of an index pulse in events in which an edge has 0 (falling) or 1 (rising).
pub(crate) const INDEX: i64 = 2;

impl Axis {
    /// Arms a touch probe. It replaces one for the same trigger.
    pub(in crate::axis) fn arm_touch_probe(
        &mut self,
        cx: &mut Context<'_>,
        sequence: u64,
        request: &TouchProbe,
    ) -> Result<(), Refusal> {
        let TouchProbe { source, edge, continuous, window, .. } = *request;
        self.end_outdated(cx);
        if edge == ProbeEdge::Index {
            // An absolute encoder has none (MACS-ENC-10).
            self.check_zero_moves()?;
        }
        let window = match window {
            Some([first, last]) => Some(self.check_window(first.exact(), last.exact())?),
            None => None,
        };
        let armed = &self.pending.touch_probes().armed;
        let same = armed.iter().position(|armed| armed.is_some_and(|armed| armed.source == source));
        let free = || armed.iter().position(Option::is_none);
        let Some(place) = same.or_else(free) else {
            let most = Number::Count(MAX_TOUCH_PROBES as i64);
            return Err(self.refuse(Code::TOO_MANY_TOUCH_PROBES).with(Number::None, most));
        };
        self.accepted(cx, sequence);
        self.end_touch_probe(cx.events, place, Code::REPLACED, self.command.position());
        self.pending.touch_probes_mut().put(place, Some(Armed { sequence, source, edge, continuous, window }));
        Ok(())
    }

    fn check_window(&self, first: Position, last: Position) -> Result<Window, Refusal> {
        if let Some(beyond) = [first, last].into_iter().find(|place| !place.is_legal()) {
            let asked = Number::Position(beyond.nearest());
            return Err(self.refuse(Code::POSITION_OUT_OF_RANGE).with(asked, Number::None));
        }
        if first > last && self.setup.modulo.is_none() {
            let (first, last) = (Number::Position(first.nearest()), Number::Position(last.nearest()));
            return Err(self.refuse(Code::TOUCH_PROBE_WINDOW).with(first, last));
        }
        Ok(Window { first, last })
    }

    /// Disarms the touch probes of a trigger, or all of them.
    pub(in crate::axis) fn abort_trigger(
        &mut self,
        cx: &mut Context<'_>,
        sequence: u64,
        request: &AbortTrigger,
    ) -> Result<(), Refusal> {
        let is_meant = |armed: &Armed| request.source.is_none_or(|source| armed.source == source);
        if !self.pending.touch_probes().armed.iter().flatten().any(is_meant) {
            let source = request.source.map_or(Number::None, |source| Number::Count(source.to_number()));
            return Err(self.refuse(Code::TOUCH_PROBE_NOT_ARMED).with(source, Number::None));
        }
        self.accepted(cx, sequence);
        for place in 0..MAX_TOUCH_PROBES {
            if self.armed_at(place).is_some_and(|armed| is_meant(&armed)) {
                self.end_touch_probe(cx.events, place, Code::CANCELLED, self.command.position());
            }
        }
        Ok(())
    }

    /// Ends touch probes with windows in a coordinate that is no longer that of the axis.
    fn end_outdated(&mut self, cx: &mut Context<'_>) {
        if !std::mem::take(&mut self.pending.touch_probes_mut().is_outdated) {
            return;
        }
        for place in 0..MAX_TOUCH_PROBES {
            if self.armed_at(place).is_some_and(|armed| armed.window.is_some()) {
                self.end_touch_probe(cx.events, place, Code::COORDINATE_CHANGED, self.command.position());
            }
        }
    }

    /// Ends all touch probes when the power of the machine is removed.
    pub fn lose_touch_probes(&mut self, events: &mut EventQueue) {
        for place in 0..MAX_TOUCH_PROBES {
            self.end_touch_probe(events, place, Code::DISABLED, self.command.position());
        }
    }

    fn armed_at(&self, place: usize) -> Option<Armed> {
        self.pending.touch_probes().armed.get(place).copied().flatten()
    }

    fn end_touch_probe(&mut self, events: &mut EventQueue, place: usize, code: Code, position: Position) {
        if let Some(armed) = self.pending.touch_probes_mut().put(place, None) {
            events.push(Event::done(self.object(), armed.sequence, code, position));
        }
    }

    /// Records the latches of this cycle for which touch probes wait. Called before the commands of the cycle, so that
    /// a touch probe never records a latch that was there before it.
    pub(in crate::axis) fn record_latches(&mut self, cx: &mut Context<'_>) {
        if self.pending.touch_probes().count == 0 {
            return;
        }
        self.end_outdated(cx);
        for place in 0..MAX_TOUCH_PROBES {
            let Some(armed) = self.armed_at(place) else { continue };
            if armed.edge == ProbeEdge::Index {
                if let Some(mark) = self.index_of_cycle() {
                    self.record_latch(cx, place, &armed, (mark, self.age_of(mark), INDEX));
                }
            } else {
                self.record_edges(cx, place, &armed);
            }
        }
    }

    /// Records the edges of one touch probe, the oldest first, until it ends.
    fn record_edges(&mut self, cx: &mut Context<'_>, place: usize, armed: &Armed) {
        let latches = cx.latches;
        let mut order: [usize; MAX_LATCHES] = std::array::from_fn(|nth| nth);
        order.sort_unstable_by_key(|nth| (Reverse(latches.get(*nth).map(|latch| latch.age_ns)), *nth));
        for nth in order {
            let Some(latch) = latches.get(nth).filter(|latch| is_awaited(latch, armed.source, armed.edge)) else {
                continue;
            };
            if self.record_latch(cx, place, armed, (self.position_at(latch), latch.age_ns, latch.rising.into())) {
                return;
            }
        }
    }

    /// Records one latch if it is within the window. Returns true if that ends the touch probe.
    fn record_latch(
        &mut self,
        cx: &mut Context<'_>,
        place: usize,
        armed: &Armed,
        (position, age_ns, edge): (Position, u32, i64),
    ) -> bool {
        let source = Number::Count(armed.source.to_number());
        if !self.feedback.is_valid() {
            let code = Code::TOUCH_PROBE_NO_POSITION;
            let warning = Event::new(Severity::Warn, Kind::Warning, self.object(), code);
            cx.events.push(Event { age_ns, ..warning.with(source, Number::None) });
            return false;
        }
        if armed.window.is_some_and(|window| !window.holds(position, self.setup.modulo)) {
            return false;
        }
        let latch = Event::new(Severity::Info, Kind::Latch, self.object(), Code::NONE).of_command(armed.sequence);
        cx.events.push(Event { age_ns, position, ..latch.with(Number::Count(edge), source) });
        // Latches of its own device are already published.
        if armed.source != self.object() || armed.edge == ProbeEdge::Index {
            let recorded = &mut self.pending.touch_probes_mut().recorded;
            *recorded = (recorded.0.saturating_add(1), position);
        }
        if !armed.continuous {
            self.end_touch_probe(cx.events, place, Code::NONE, position);
        }
        !armed.continuous
    }

    /// Publishes the last record of the cycle.
    pub(in crate::axis) fn publish_records(&mut self, board: &mut Board) {
        let (count, position) = self.pending.touch_probes().recorded;
        if count > 0 {
            self.pending.touch_probes_mut().recorded = Default::default();
            self.publish_latches(board, position, count);
        }
    }
}

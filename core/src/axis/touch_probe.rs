//! Passive touch probe: records where the axis is when something latches, whatever moves it (MC_TouchProbe, MC_AbortTrigger).
//!
//! Law      recorded = position of the axis at the latch, on the straight line of the change of its cycle. A touch probe without a
//!          window records every latch of its edge; with one, those whose position lies between the first and the last place, both
//!          included, within the turn of an axis that has one. It is over with the first record, or records until it is aborted
//! Reads    the latches of the cycle, its index pulse, the actual position
//! Writes   an event `latch` of each record, the signals of the last one, `done` at the end; moves nothing
//! Refuses  more touch probes than there is room for; a window that ends before it begins, of an axis without turn
//! Source   PLCopen part 1 (MC_TouchProbe, MC_AbortTrigger)

use super::probe::is_awaited;
use super::{Axis, Context};
use crate::code::Code;
use crate::command::{AbortTrigger, ProbeEdge, TouchProbe};
use crate::drive::MAX_LATCHES;
use crate::event::{Event, EventQueue, Kind, Number, Refusal, Severity};
use crate::modulo::Modulo;
use crate::object::Object;
use crate::position::Position;
use crate::signal::Board;
use serde::{Deserialize, Serialize};
use std::cmp::Reverse;

/// Touch probes of one axis that may be armed at the same time, each for another trigger.
pub(super) const MAX_TOUCH_PROBES: usize = 4;

/// Events of one axis in a cycle that its touch probes make: each latch is recorded by one of them, and each may record the index and end.
pub(crate) const MOST_RECORDS: usize = MAX_LATCHES + 2 * MAX_TOUCH_PROBES;

/// The number of an index pulse where an edge has 0 (falling) or 1 (rising).
pub(crate) const INDEX: i64 = 2;

/// Places between which a touch probe records, both included.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Window {
    first: Position,
    last: Position,
}

impl Window {
    fn holds(&self, place: Position, turn: Option<Modulo>) -> bool {
        match turn {
            None => (self.first..=self.last).contains(&place),
            Some(turn) => turn.is_between(self.first, self.last, place),
        }
    }
}

/// A touch probe that is armed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Armed {
    /// Number of its command.
    sequence: u64,
    source: Object,
    edge: ProbeEdge,
    /// Records until it is aborted; else the first record ends it.
    continuous: bool,
    window: Option<Window>,
}

/// The touch probes of an axis.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct TouchProbes {
    /// How many are armed: what each full cycle looks at.
    count: u8,
    armed: [Option<Armed>; MAX_TOUCH_PROBES],
    /// The coordinate in which the windows were given is that of the axis no more.
    is_outdated: bool,
    /// Records of this cycle that are not shown yet, and the last of them.
    #[serde(skip)]
    recorded: (u32, Position),
}

impl TouchProbes {
    fn put(&mut self, place: usize, armed: Option<Armed>) -> Option<Armed> {
        let slot = self.armed.get_mut(place)?;
        let before = std::mem::replace(slot, armed);
        self.count = self.armed.iter().flatten().count() as u8;
        before
    }

    /// Returns true if one with a window is armed.
    pub(super) fn have_window(&self) -> bool {
        self.armed.iter().flatten().any(|armed| armed.window.is_some())
    }

    /// Whether nothing is left to end or to show.
    pub(super) fn are_settled(&self) -> bool {
        !self.is_outdated && self.recorded.0 == 0
    }

    /// The places of all windows are meant in another coordinate than that of the axis from now on.
    pub(super) fn note_new_coordinate(&mut self) {
        self.is_outdated |= self.have_window();
    }

    /// Could it have come about? One that was read from outside may hold anything.
    pub(super) fn are_sound(&self) -> bool {
        let is_legal = |window: Window| window.first.is_legal() && window.last.is_legal();
        let is_counted = usize::from(self.count) == self.armed.iter().flatten().count();
        is_counted && self.armed.iter().flatten().all(|armed| armed.window.is_none_or(is_legal))
    }
}

impl Axis {
    /// Arms a touch probe; one that is armed for the same trigger gives way to it.
    pub(super) fn arm_touch_probe(
        &mut self,
        cx: &mut Context<'_>,
        sequence: u64,
        request: &TouchProbe,
    ) -> Result<(), Refusal> {
        let TouchProbe { source, edge, continuous, window, .. } = *request;
        self.end_outdated(cx);
        if edge == ProbeEdge::Index {
            // Of an absolute encoder there is none (MACS-ENC-10).
            self.check_zero_moves()?;
        }
        let window = match window {
            Some([first, last]) => Some(self.check_window(first.exact(), last.exact())?),
            None => None,
        };
        let armed = &self.touch_probes.armed;
        let same = armed.iter().position(|armed| armed.is_some_and(|armed| armed.source == source));
        let free = || armed.iter().position(Option::is_none);
        let Some(place) = same.or_else(free) else {
            let most = Number::Count(MAX_TOUCH_PROBES as i64);
            return Err(self.refuse(Code::TOO_MANY_TOUCH_PROBES).with(Number::None, most));
        };
        self.accepted(cx, sequence);
        self.end_touch_probe(cx.events, place, Code::REPLACED, self.command.position);
        self.touch_probes.put(place, Some(Armed { sequence, source, edge, continuous, window }));
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
    pub(super) fn abort_trigger(
        &mut self,
        cx: &mut Context<'_>,
        sequence: u64,
        request: &AbortTrigger,
    ) -> Result<(), Refusal> {
        let is_meant = |armed: &Armed| request.source.is_none_or(|source| armed.source == source);
        if !self.touch_probes.armed.iter().flatten().any(is_meant) {
            let source = request.source.map_or(Number::None, |source| Number::Count(source.to_number()));
            return Err(self.refuse(Code::TOUCH_PROBE_NOT_ARMED).with(source, Number::None));
        }
        self.accepted(cx, sequence);
        for place in 0..MAX_TOUCH_PROBES {
            if self.armed_at(place).is_some_and(|armed| is_meant(&armed)) {
                self.end_touch_probe(cx.events, place, Code::CANCELLED, self.command.position);
            }
        }
        Ok(())
    }

    /// Ends touch probes whose windows were given in a coordinate that is not that of the axis any more.
    fn end_outdated(&mut self, cx: &mut Context<'_>) {
        if !std::mem::take(&mut self.touch_probes.is_outdated) {
            return;
        }
        for place in 0..MAX_TOUCH_PROBES {
            if self.armed_at(place).is_some_and(|armed| armed.window.is_some()) {
                self.end_touch_probe(cx.events, place, Code::COORDINATE_CHANGED, self.command.position);
            }
        }
    }

    /// The power of the machine goes: nothing is armed any more.
    pub fn lose_touch_probes(&mut self, events: &mut EventQueue) {
        for place in 0..MAX_TOUCH_PROBES {
            self.end_touch_probe(events, place, Code::DISABLED, self.command.position);
        }
    }

    fn armed_at(&self, place: usize) -> Option<Armed> {
        self.touch_probes.armed.get(place).copied().flatten()
    }

    fn end_touch_probe(&mut self, events: &mut EventQueue, place: usize, code: Code, position: Position) {
        if let Some(armed) = self.touch_probes.put(place, None) {
            events.push(Event::done(self.object(), armed.sequence, code, position));
        }
    }

    /// Records the latches of this cycle that touch probes wait for. Before the commands of the cycle, so that none takes a latch that
    /// was there before it.
    pub(super) fn record_latches(&mut self, cx: &mut Context<'_>) {
        if self.touch_probes.count == 0 {
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

    /// Records the edges of one touch probe, the oldest first, until it is over.
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

    /// Records one latch, if it is within the window; true where that ends the touch probe.
    fn record_latch(
        &mut self,
        cx: &mut Context<'_>,
        place: usize,
        armed: &Armed,
        (position, age_ns, edge): (Position, u32, i64),
    ) -> bool {
        let source = Number::Count(armed.source.to_number());
        if !self.actual.valid {
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
        // What its own device latches is shown already.
        if armed.source != self.object() || armed.edge == ProbeEdge::Index {
            self.touch_probes.recorded = (self.touch_probes.recorded.0.saturating_add(1), position);
        }
        if !armed.continuous {
            self.end_touch_probe(cx.events, place, Code::NONE, position);
        }
        !armed.continuous
    }

    /// Shows the last record of the cycle.
    pub(super) fn publish_records(&mut self, board: &mut Board) {
        let (count, position) = self.touch_probes.recorded;
        if count > 0 {
            self.touch_probes.recorded = Default::default();
            self.publish_latches(board, position, count);
        }
    }
}

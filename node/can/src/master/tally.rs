//! Frame counters and state of a bus, for diagnostics.
//!
//! Law      the cycle thread counts and the service reads, without locks. A rate is that of the last whole second
//! Reads    frames that the transport sends and receives, the state of the controller, states of nodes
//! Writes   text for diagnostics

use crate::load::{self, Load};
use crate::{Frame, NmtState};
use lineshaft_core::drive::BusState;
use std::sync::atomic::{AtomicU8, AtomicU16, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Period over which a rate is measured.
const SECOND: Duration = Duration::from_secs(1);

/// Counters of a bus since its creation.
#[derive(Debug)]
pub(crate) struct BusCounters {
    sent: AtomicU64,
    received: AtomicU64,
    bits: AtomicU64,
    missed: AtomicU64,
    /// Bus state, 0 to 2, as in [`BusState`].
    state: AtomicU8,
    /// Whether the controller has error counters; the next field contains them: transmit, receive.
    has_errors: AtomicU8,
    errors: AtomicU16,
    /// NMT state of each device; 0: none was received, or the device is lost.
    nodes: Box<[AtomicU8]>,
}

impl BusCounters {
    pub(super) fn new(drives: usize) -> Self {
        Self {
            sent: AtomicU64::new(0),
            received: AtomicU64::new(0),
            bits: AtomicU64::new(0),
            missed: AtomicU64::new(0),
            state: AtomicU8::new(BusState::Off as u8),
            has_errors: AtomicU8::new(0),
            errors: AtomicU16::new(0),
            nodes: (0..drives).map(|_| AtomicU8::new(0)).collect(),
        }
    }

    /// Counts a frame.
    pub(super) fn count(&self, frame: &Frame, is_sent: bool) {
        let of = if is_sent { &self.sent } else { &self.received };
        of.fetch_add(1, Ordering::Relaxed);
        self.bits.fetch_add(load::bits(frame), Ordering::Relaxed);
    }

    /// Counts a frame that had no room in the recording.
    pub(super) fn count_unrecorded(&self) {
        self.missed.fetch_add(1, Ordering::Relaxed);
    }

    /// Returns the number of frames that had no room in the recording.
    pub(super) fn missed(&self) -> u64 {
        self.missed.load(Ordering::Relaxed)
    }

    /// Stores state and error counters of the controller.
    pub(super) fn set_controller_state(&self, state: BusState, errors: Option<(u8, u8)>) {
        self.state.store(state as u8, Ordering::Relaxed);
        if let Some((transmit, receive)) = errors {
            self.errors.store(u16::from_be_bytes([transmit, receive]), Ordering::Relaxed);
        }
        self.has_errors.store(errors.is_some().into(), Ordering::Relaxed);
    }

    /// Stores the NMT state of the device at this place of the bus.
    pub(super) fn set_node_state(&self, place: usize, state: Option<NmtState>) {
        if let Some(node) = self.nodes.get(place) {
            node.store(state.map_or(0, |state| 1 + state as u8), Ordering::Relaxed);
        }
    }

    fn counts(&self) -> Counts {
        let of = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        Counts { sent: of(&self.sent), received: of(&self.received), bits: of(&self.bits) }
    }

    /// Returns the last NMT state of a device; `None` if it has reported none, or is lost.
    pub(super) fn node(&self, place: usize) -> Option<NmtState> {
        let states = [NmtState::BootUp, NmtState::Stopped, NmtState::Operational, NmtState::PreOperational];
        let word = self.nodes.get(place)?.load(Ordering::Relaxed);
        states.into_iter().find(|state| 1 + *state as u8 == word)
    }

    /// Returns the state of the controller as text, with its error counters if it has any.
    pub(super) fn controller(&self) -> String {
        let state = match self.state.load(Ordering::Relaxed) {
            state if state == BusState::Active as u8 => "active",
            state if state == BusState::Degraded as u8 => "passive: many errors",
            _ => "off",
        };
        if self.has_errors.load(Ordering::Relaxed) == 0 {
            return state.to_owned();
        }
        let [transmit, receive] = self.errors.load(Ordering::Relaxed).to_be_bytes();
        format!(
            "{state}; when it told them last, its error counters were {transmit} (transmit) and {receive} (receive)"
        )
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    sent: u64,
    received: u64,
    bits: u64,
}

/// Measurement of the present bus load.
#[derive(Debug)]
pub(crate) struct BusLoadMeter {
    since: Instant,
    last: Counts,
    /// Rates of the last whole second, each per second: frames sent, frames received, bits.
    rates: Option<[f64; 3]>,
}

impl BusLoadMeter {
    pub(super) fn new() -> Self {
        Self { since: Instant::now(), last: Counts::default(), rates: None }
    }

    /// Restarts the measurement after a pause.
    pub(super) fn restart(&mut self, tally: &BusCounters, now: Instant) {
        *self = Self { since: now, last: tally.counts(), rates: None };
    }

    /// Returns the present bus load as text, next to the calculated one.
    pub(super) fn look(
        &mut self,
        tally: &BusCounters,
        now: Instant,
        rate: Option<u32>,
        load: Option<Load>,
    ) -> [(&'static str, String); 3] {
        let time = now.saturating_duration_since(self.since);
        if time >= SECOND {
            let (counts, last, s) = (tally.counts(), self.last, time.as_secs_f64());
            let per_s = |now: u64, then: u64| now.saturating_sub(then) as f64 / s;
            let rates = [(counts.sent, last.sent), (counts.received, last.received), (counts.bits, last.bits)];
            (self.rates, self.last, self.since) = (Some(rates.map(|(now, then)| per_s(now, then))), counts, now);
        }
        let unknown = || "not known yet".to_owned();
        let measured = self.rates.map_or_else(unknown, |[.., bits]| match rate {
            Some(rate) => format!("{:.1} % of {rate} bit/s", bits * 100.0 / f64::from(rate)),
            None => format!("{bits:.0} bit/s"),
        });
        let frames = self.rates.map_or_else(unknown, |[sent, received, _]| {
            format!("{:.0} /s: {sent:.0} sent, {received:.0} received", sent + received)
        });
        let computed = |load: Load| format!("{:.1} % at most, the frames of each cycle alone", load.share() * 100.0);
        let computed = load.map_or_else(|| "none: the cell gives no bit rate".to_owned(), computed);
        [("load, measured", measured), ("load, computed", computed), ("frames", frames)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Id;

    /// 100 frames of 53 bits within 2 s at 10 kbit/s; then none.
    #[test]
    fn a_rate_is_that_of_the_last_whole_second() {
        let (tally, begin) = (BusCounters::new(0), Instant::now());
        let frame = Frame::data(Id::NMT, &[]).unwrap();
        let mut meter = BusLoadMeter::new();
        meter.restart(&tally, begin);
        (0..100).for_each(|at| tally.count(&frame, at < 40));
        let load = Load { frames: 2, bits: 5, rate: 10_000, cycle_us: 1000.0 };
        let mut look =
            |ms, rate| meter.look(&tally, begin + Duration::from_millis(ms), rate, Some(load)).map(|(_, value)| value);
        assert_eq!(look(999, Some(10_000))[0], "not known yet");
        let computed = "50.0 % at most, the frames of each cycle alone";
        assert_eq!(look(2000, Some(10_000)), ["26.5 % of 10000 bit/s", computed, "50 /s: 20 sent, 30 received"]);
        assert_eq!(look(2999, None)[0], "2650 bit/s");
        assert_eq!(look(3000, Some(10_000))[0], "0.0 % of 10000 bit/s");
    }

    #[test]
    fn controller_and_node_states_are_reported_as_stored() {
        let tally = BusCounters::new(2);
        assert_eq!(tally.controller(), "off");
        tally.set_controller_state(BusState::Degraded, Some((128, 3)));
        let told =
            "passive: many errors; when it told them last, its error counters were 128 (transmit) and 3 (receive)";
        assert_eq!(tally.controller(), told);
        tally.set_controller_state(BusState::Active, None);
        assert_eq!(tally.controller(), "active");
        for state in [NmtState::BootUp, NmtState::Stopped, NmtState::Operational, NmtState::PreOperational] {
            tally.set_node_state(1, Some(state));
            assert_eq!((tally.node(0), tally.node(1)), (None, Some(state)));
        }
        tally.set_node_state(1, None);
        assert_eq!(tally.node(1), None);
    }
}

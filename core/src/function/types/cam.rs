//! Cam controller (CAM).
//!
//! Law      per track: x + offset + lead -> cams, combined -> pulse -> logic with the input -> output; the offset of a
//!          track is the sum of all changes of its word, starting at 0
//! Reads    the source; E1.. per track; Tab0, which may change between calls: a cam that changes restarts
//! Writes   A1.. of the tracks with cams that are not disabled; the sink: the offset of the track that the table
//!          selects
//! Refuses  a modulo of 0 in a mode with wrap, more cams than there is room for, errors of [`check_table`]
//! Source   AMK-CAM-01 to -48, A-54 to -61

mod hysteresis;
mod master;
mod table;

use crate::code::Code;
use crate::function::guest::*;
use crate::function::time;
use crate::function::track::{self, Track};
use crate::function::window::Window;
use hysteresis::{HysteresisState, Ring, TrackPosition, is_inside};
use master::Master;
use serde::{Deserialize, Serialize};
use table::CamTable;

pub(super) use table::check_table;

/// Maximum number of cams of all tracks together.
pub(super) const MOST_CAMS: usize = 1024;
/// Number of cams that there is always room for.
const USUAL_CAMS: usize = 56;

/// The parameter set.
pub(super) const FIELDS: &[Field] = &[
    Field::new("ba", 0, 2, "", "operating mode: 0 absolute, 1 incremental, 2 time", "AMK-CAM-30"),
    Field::new("sf_cycle", 0, 131, "0.5 ms", "time between two calls; 0: the slot's own", "AMK-CAM-31"),
    Field::new("dead_time_mean", 0, 30_000, "calls", "over how many the velocity is averaged; 0: 20", "AMK-CAM-32"),
    Field::new("cams", 0, 1000, "", "cams of each track; 0: unused", "AMK-CAM-33").list(LINES),
    Field::new("mode", 0, 63, "bits", "logic of each track", "AMK-CAM-34").list(LINES),
    Field::new("modulo", 0, (1 << 30) - 1, "inc", "where x begins again in ba 1 and 2", "AMK-CAM-35"),
    Field::new("hysteresis", 0, 65_535, "100 inc", "hysteresis of each track; 0: none", "AMK-CAM-36").list(LINES),
];

const BA: usize = place(FIELDS, "ba");
const SF_CYCLE: usize = place(FIELDS, "sf_cycle");
const DEAD_TIME_MEAN: usize = place(FIELDS, "dead_time_mean");
const CAMS: usize = place(FIELDS, "cams");
const MODE: usize = place(FIELDS, "mode");
const MODULO: usize = place(FIELDS, "modulo");
const HYSTERESIS: usize = place(FIELDS, "hysteresis");

/// One track.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct CamTrack {
    track: Track,
    /// Number of cams.
    count: u16,
    /// Hysteresis, in increments; 0: none.
    hysteresis: i64,
    /// Sum of the changes of the offset word, in increments.
    offset: i64,
    /// Position of the track at the last call.
    x: i64,
}

impl CamTrack {
    /// Returns true if one of the cams of the track is on at x.
    fn bit(
        &mut self,
        cams: impl Iterator<Item = (i32, i32)>,
        overruns: &mut [HysteresisState],
        (ring, x): (Ring, i64),
        is_first: bool,
    ) -> bool {
        let before = std::mem::replace(&mut self.x, x);
        if self.hysteresis == 0 {
            return cams.fold(false, |is_on, (on, off)| is_on | is_inside(on, off, x));
        }
        let at = TrackPosition { ring, x, way: ring.travel(before, x), hysteresis: self.hysteresis };
        // Every cam has to be stepped: no short circuit.
        cams.zip(overruns).fold(false, |is_on, (cam, overrun)| is_on | overrun.step(cam, at, is_first))
    }
}

/// The whole state without the heap memory.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct RunState {
    master: Master,
    /// Offset words at the last call.
    words: [i16; LINES],
    lanes: [CamTrack; LINES],
}

/// State of the function.
#[derive(Debug, Serialize, Deserialize)]
pub(in crate::function) struct Cam {
    /// `None` before the first START.
    course: Option<RunState>,
    window: Window,
    /// State of all cams in the order of the table; unused for tracks without hysteresis.
    overruns: Box<[HysteresisState]>,
}

impl Cam {
    /// Returns an error for a mean over more calls than there is room for.
    fn check_mean(&self, words: Words<'_>) -> Result<(), Fault> {
        time::check_mean(&self.window, words.get(DEAD_TIME_MEAN), number(FIELDS, "dead_time_mean"))
    }

    /// Evaluates all tracks at the position of this call.
    fn evaluate(&mut self, seen: &CallInputs<'_>, is_first: bool) -> Outcome {
        let mut outcome = Outcome { sink: seen.sink, ..Outcome::default() };
        let (Some(course), Some(table)) = (&mut self.course, track::words(seen).map(CamTable::new)) else {
            return outcome;
        };
        let RunState { master, words, lanes } = course;
        let ring = master.ring();
        if !is_first {
            master.advance(table.cycle_time(), &mut self.window, seen);
        }
        let before = std::mem::replace(words, table.offsets());
        if before != *words {
            for ((lane, word), before) in lanes.iter_mut().zip(words).zip(before) {
                lane.offset = master.changed_offset(lane.offset, word.wrapping_sub(before));
            }
        }
        if let Some(lane) = lanes.get(usize::from(table.track_select())) {
            outcome.sink = lane.offset;
        }
        let mut first = 0;
        for (number, lane) in lanes.iter_mut().enumerate() {
            let count = usize::from(lane.count);
            if count == 0 {
                continue;
            }
            let x = master.place(lane.offset, table.dead_time(number), &self.window, seen.call_ns);
            let overruns = self.overruns.get_mut(first..).unwrap_or_default();
            let bit = lane.bit(table.cams(first, count), overruns, (ring, x), is_first);
            first += count;
            let mask = 1 << number;
            let input = seen.inputs & mask != 0;
            let is_on = if is_first {
                lane.track.start(bit, input)
            } else {
                lane.track.step(bit, table.monoflop(number), input, seen.call_ns)
            };
            if lane.track.is_written() {
                outcome.writes |= mask;
                outcome.outputs |= if is_on { mask } else { 0 };
            }
        }
        outcome
    }
}

/// Returns the hysteresis of a track, in increments.
fn hysteresis_inc(field: i64) -> i64 {
    // At most 65535 * 100.
    field.saturating_mul(100)
}

impl SlotType for Cam {
    const DESCRIPTION: Description = Description {
        inputs: 8,
        outputs: 8,
        tables: 1,
        edits_tables: true,
        amk: AmkLimits { sets_call_time: true, sink_widths: &[Width::W32], ..AmkLimits::USUAL },
        ..Description::of(Kind::Cam, "cam", "switches outputs by cams, ahead of time where they are slow", FIELDS)
    };

    fn new(setup: &SlotSetup<'_>) -> Self {
        let overruns = vec![HysteresisState::default(); setup.room.cams.clamp(USUAL_CAMS, MOST_CAMS)].into();
        Self { course: None, window: Window::new(setup.room.mean), overruns }
    }

    fn is_set_up_as(&self, other: &Self) -> bool {
        (self.window.capacity(), self.overruns.len()) == (other.window.capacity(), other.overruns.len())
    }

    fn check(&self, words: Words<'_>, setting: &Setting<'_>) -> Result<(), Fault> {
        self.check_mean(words)?;
        time::check_cycle(words.get(SF_CYCLE), number(FIELDS, "sf_cycle"), setting)?;
        for track in 0..LINES {
            track::check_mode(words.get(MODE + track), number(FIELDS, "mode"))?;
        }
        if words.get(BA) != 0 && words.get(MODULO) == 0 {
            return Err(Fault::new(Code::AMK_NO_MODULO).of(number(FIELDS, "modulo")).with(0, 1));
        }
        // The sum of eight fields of at most 1000.
        let sum = (0..LINES).map(|track| words.get(CAMS + track)).sum::<i64>();
        let most = self.overruns.len() as i64;
        if sum > most {
            return Err(Fault::new(Code::AMK_CAM_COUNT).of(number(FIELDS, "cams")).with(sum, most));
        }
        check_table(words, setting)
    }

    fn start(&mut self, words: Words<'_>, seen: &CallInputs<'_>) -> Outcome {
        let cycle_time = track::words(seen).map_or(0, |table| CamTable::new(table).cycle_time());
        let mut lanes = [CamTrack::default(); LINES];
        for (number, lane) in lanes.iter_mut().enumerate() {
            lane.track = Track::new(words.get(MODE + number));
            lane.count = words.get(CAMS + number) as u16;
            lane.hysteresis = hysteresis_inc(words.get(HYSTERESIS + number));
        }
        let master = Master::new(words.get(BA), words.get(MODULO), cycle_time, seen);
        self.course = Some(RunState { master, words: [0; LINES], lanes });
        time::restart(&mut self.window, words.get(DEAD_TIME_MEAN));
        self.evaluate(seen, true)
    }

    fn step(&mut self, seen: &CallInputs<'_>) -> Outcome {
        self.evaluate(seen, false)
    }

    fn is_valid_state(&self) -> bool {
        let is_sound = |course: &RunState| {
            let RunState { master, lanes, .. } = course;
            let cams = lanes.iter().map(|lane| usize::from(lane.count)).sum::<usize>();
            let fits = |lane: &CamTrack| {
                (0..=6_553_500).contains(&lane.hysteresis) && master.has(lane.offset) && master.has(lane.x)
            };
            master.is_sound() && cams <= self.overruns.len() && lanes.iter().all(fits)
        };
        self.overruns.iter().all(HysteresisState::is_sound)
            && self.course.as_ref().is_none_or(is_sound)
            && self.window.is_sound()
    }
}

impl Clone for Cam {
    fn clone(&self) -> Self {
        Self { course: self.course, window: self.window.clone(), overruns: self.overruns.clone() }
    }

    /// Does not allocate if both functions belong to the same machine.
    fn clone_from(&mut self, other: &Self) {
        self.course = other.course;
        self.window.clone_from(&other.window);
        self.overruns.clone_from(&other.overruns);
    }
}

#[cfg(test)]
mod tests;

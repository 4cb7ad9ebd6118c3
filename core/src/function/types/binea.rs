//! Binary outputs by a table (BINEA).
//!
//! Law      x = source + offset (ba 0); (sum of differences + offset) mod M (ba 1); time since START mod M (ba 2), M = last point;
//!          k: point(k-1) <= x + lead < point(k); bits = a_value(k); lead = mean(dx) * dead_time / call (ba 1)
//! Reads    the source; E1.. per track; Tab0: points + 1 in DW0, from DW4 on 4 words per point: point, A-value, A time;
//!          the word of the offset, if any
//! Writes   A1.. of the tracks in use that are not disabled; no sink
//! Refuses  points that do not rise, a modulo below 1, times beyond 32767, a dead time that is not compensated
//! Source   AMK-BINEA-01 to -35, B1 to B10

use crate::code::Code;
use crate::function::guest::*;
use crate::function::time::{self, HALF_MS, wrapped};
use crate::function::track::{self, Track};
use crate::function::window::Window;
use crate::table::{Table, double};
use serde::{Deserialize, Serialize};

/// The parameter set.
pub(super) const FIELDS: &[Field] = &[
    Field::new("fct", 0, 1, "", "1 compensates the dead time (ba 1 only)", "AMK-BINEA-07"),
    Field::new("ba", 0, 2, "", "operating mode: 0 absolute, 1 incremental, 2 time", "AMK-BINEA-09"),
    Field::new("dead_time", 0, 32_000, "0.5 ms", "dead time of what is switched; 0: none", "AMK-BINEA-10").live(),
    Field::new("sf_cycle_time", 0, 131, "0.5 ms", "time between two calls; 0: the slot's own", "AMK-BINEA-11"),
    Field::new("tracks", 1, 8, "", "tracks in use, from the first one on", "AMK-BINEA-12"),
    Field::new("feedback_offset", -32_768, 32_767, "inc", "what is added to the source", "AMK-BINEA-14").live(),
    Field::new("mode", 0, 63, "bits", "logic of each track", "AMK-BINEA-15").list(LINES),
    Field::new("mean_factor", 0, 30_000, "calls", "over how many the velocity is averaged; 0: 20", "AMK-BINEA-16"),
];

const FCT: usize = place(FIELDS, "fct");
const BA: usize = place(FIELDS, "ba");
const DEAD_TIME: usize = place(FIELDS, "dead_time");
const SF_CYCLE_TIME: usize = place(FIELDS, "sf_cycle_time");
const TRACKS: usize = place(FIELDS, "tracks");
const FEEDBACK_OFFSET: usize = place(FIELDS, "feedback_offset");
const MODE: usize = place(FIELDS, "mode");
const MEAN_FACTOR: usize = place(FIELDS, "mean_factor");

/// Maximum points of a table.
const MOST_POINTS: usize = 63;
/// Maximum time in a table, in half milliseconds.
const LONGEST: u16 = 32_767;

/// The quantity that x measures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Base {
    Absolute,
    Incremental,
    Time,
}

impl Base {
    fn new(ba: i64) -> Self {
        match ba {
            0 => Self::Absolute,
            1 => Self::Incremental,
            _ => Self::Time,
        }
    }
}

/// Values taken at START and VALUE_NEW, and the current x.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct RunState {
    base: Base,
    compensates: bool,
    dead_time: i64,
    offset: i64,
    tracks: [Track; LINES],
    count: u8,
    /// x without offset, within the modulo: in increments, or in nanoseconds in time mode; unused in absolute mode.
    x: i64,
    /// Travel of the source at the last call.
    travel: i64,
}

/// State of the function.
#[derive(Debug, Serialize, Deserialize)]
pub(in crate::function) struct Binea {
    /// Whether the cell names a word that holds the offset.
    has_offset_word: bool,
    course: RunState,
    window: Window,
}

impl Binea {
    /// Returns an error for a mean over more calls than there is room for.
    fn check_mean(&self, words: Words<'_>) -> Result<(), Fault> {
        if words.get(FCT) == 0 {
            return Ok(());
        }
        time::check_mean(&self.window, words.get(MEAN_FACTOR), number(FIELDS, "mean_factor"))
    }

    /// Returns the position at which the table is looked up.
    fn lookup_position(&self, points: Points<'_>, seen: &CallInputs<'_>) -> i64 {
        let offset = if self.has_offset_word { seen.words[0] } else { self.course.offset };
        match self.course.base {
            // A saturated sum is far beyond every point.
            Base::Absolute => seen.source.value.saturating_add(offset),
            Base::Incremental => {
                let lead = if self.course.compensates && self.course.dead_time != 0 {
                    time::lead(self.window.mean(), self.course.dead_time, seen.call_ns)
                } else {
                    0
                };
                // Offset and lead are far below 2^62 unless the source has jumped unreasonably far.
                wrapped(self.course.x.saturating_add(offset).saturating_add(lead), points.modulo())
            }
            Base::Time => self.course.x / HALF_MS,
        }
    }

    /// Adds the travel or the time since the last call to x.
    fn advance(&mut self, points: Points<'_>, seen: &CallInputs<'_>) {
        match self.course.base {
            Base::Absolute => {}
            Base::Incremental => {
                let travel = seen.source.travel;
                let change = travel.wrapping_sub(std::mem::replace(&mut self.course.travel, travel));
                // Both terms are within the modulo, which is below 2^31.
                self.course.x = wrapped(self.course.x.wrapping_add(change % points.modulo()), points.modulo());
                if self.course.compensates {
                    self.window.push(change);
                }
            }
            Base::Time => {
                // The modulo is below 2^31 half milliseconds, 2^50 ns.
                let turn = points.modulo().wrapping_mul(HALF_MS);
                let call = (seen.call_ns % turn.unsigned_abs()).cast_signed();
                self.course.x = wrapped(self.course.x.wrapping_add(call), turn);
            }
        }
    }

    /// Returns the outputs of a segment.
    fn write(&mut self, seen: &CallInputs<'_>, output: impl Fn(&mut Track, u8, bool) -> bool) -> Outcome {
        let mut outcome = Outcome { sink: seen.sink, ..Outcome::default() };
        for (track, bit) in self.course.tracks.iter_mut().zip(0..self.course.count.min(LINES as u8)) {
            let mask = 1 << bit;
            let is_on = output(track, mask, seen.inputs & mask != 0);
            if track.is_written() {
                outcome.writes |= mask;
                outcome.outputs |= if is_on { mask } else { 0 };
            }
        }
        outcome
    }
}

impl SlotType for Binea {
    const DESCRIPTION: Description = Description {
        sink: Requirement::Never,
        inputs: 8,
        outputs: 8,
        tables: 1,
        words: &["mw_offset_addr"],
        amk: AmkLimits { sets_call_time: true, ..AmkLimits::USUAL },
        ..Description::of(Kind::Binea, "binea", "switches outputs by the segments of a table", FIELDS)
    };

    fn new(setup: &SlotSetup<'_>) -> Self {
        let [has_offset_word, _] = setup.has_words;
        let course = RunState {
            base: Base::Absolute,
            compensates: false,
            dead_time: 0,
            offset: 0,
            tracks: [Track::default(); LINES],
            count: 0,
            x: 0,
            travel: 0,
        };
        Self { has_offset_word, course, window: Window::new(setup.room.mean) }
    }

    fn is_set_up_as(&self, other: &Self) -> bool {
        (self.has_offset_word, self.window.capacity()) == (other.has_offset_word, other.window.capacity())
    }

    fn check(&self, words: Words<'_>, setting: &Setting<'_>) -> Result<(), Fault> {
        let base = Base::new(words.get(BA));
        self.check_mean(words)?;
        time::check_cycle(words.get(SF_CYCLE_TIME), number(FIELDS, "sf_cycle_time"), setting)?;
        if words.get(FCT) != 0 && base != Base::Incremental {
            return Err(Fault::new(Code::AMK_DEAD_TIME_MODE).of(number(FIELDS, "fct")).with(words.get(BA), 1));
        }
        // BINEA-32: START and VALUE_NEW reject a dead time that is not compensated.
        if words.get(DEAD_TIME) != 0 && words.get(FCT) == 0 {
            let fault = Fault::new(Code::AMK_DEAD_TIME_UNUSED).of(number(FIELDS, "dead_time"));
            return Err(fault.with(words.get(DEAD_TIME), 0));
        }
        for track in 0..LINES {
            track::check_mode(words.get(MODE + track), number(FIELDS, "mode"))?;
        }
        let modes = (0..LINES).take(words.get(TRACKS) as usize).map(|track| Track::new(words.get(MODE + track)));
        check_table(track::check_words(setting)?, base, modes.into_iter().any(Track::has_pulse))
    }

    fn start(&mut self, words: Words<'_>, seen: &CallInputs<'_>) -> Outcome {
        self.course.base = Base::new(words.get(BA));
        self.course.compensates = words.get(FCT) != 0;
        for (place, track) in self.course.tracks.iter_mut().enumerate() {
            *track = Track::new(words.get(MODE + place));
        }
        // The range of the field is 1 to 8.
        self.course.count = words.get(TRACKS) as u8;
        time::restart(&mut self.window, words.get(MEAN_FACTOR));
        (self.course.x, self.course.travel) = (0, seen.source.travel);
        self.apply_values(words);
        let Some(points) = Points::seen(seen) else { return Outcome { sink: seen.sink, ..Outcome::default() } };
        let (_, bits, _) = points.get(points.segment_at(self.lookup_position(points, seen)));
        self.write(seen, |track, mask, input| track.start(bits & mask != 0, input))
    }

    fn apply_values(&mut self, words: Words<'_>) {
        (self.course.dead_time, self.course.offset) = (words.get(DEAD_TIME), words.get(FEEDBACK_OFFSET));
    }

    fn step(&mut self, seen: &CallInputs<'_>) -> Outcome {
        let Some(points) = Points::seen(seen) else { return Outcome { sink: seen.sink, ..Outcome::default() } };
        self.advance(points, seen);
        let (_, bits, time) = points.get(points.segment_at(self.lookup_position(points, seen)));
        self.write(seen, |track, mask, input| track.step(bits & mask != 0, time, input, seen.call_ns))
    }

    fn is_valid_state(&self) -> bool {
        usize::from(self.course.count) <= LINES && (0..1 << 50).contains(&self.course.x) && self.window.is_sound()
    }
}

impl Clone for Binea {
    fn clone(&self) -> Self {
        Self { window: self.window.clone(), ..*self }
    }

    /// Does not allocate if both functions belong to the same machine.
    fn clone_from(&mut self, other: &Self) {
        (self.has_offset_word, self.course) = (other.has_offset_word, other.course);
        self.window.clone_from(&other.window);
    }
}

/// The points of a table.
#[derive(Clone, Copy)]
struct Points<'a>(&'a [[i64; STRIDE]]);

/// Words before the first point, and words per point.
const HEAD: usize = 4;
const STRIDE: usize = 4;

impl<'a> Points<'a> {
    /// Returns the points of a table, at most as many as its first word says.
    fn new(table: &'a Table) -> Self {
        let count = usize::from(table.word(0)).saturating_sub(1).min(MOST_POINTS);
        let points = table.y().get(HEAD..).unwrap_or_default().as_chunks().0;
        Self(points.get(..count).unwrap_or(points))
    }

    fn seen(seen: &CallInputs<'a>) -> Option<Self> {
        track::words(seen).map(Self::new)
    }

    /// Returns position, bits and time of a segment; all 0 after the last one.
    fn get(self, number: usize) -> (i64, u8, u16) {
        let [low, high, bits, time] = self.0.get(number).copied().unwrap_or_default();
        // Words are within 16 bits: the casts keep the low bits.
        (double(low, high).into(), bits as u8, time as u16)
    }

    fn point(self, number: usize) -> i64 {
        self.get(number).0
    }

    /// Returns the last point, at which x wraps to 0; at least 1 in a checked table.
    fn modulo(self) -> i64 {
        self.point(self.0.len().saturating_sub(1)).max(1)
    }

    /// Returns the segment that contains x; beyond the last point it is the last one (B5).
    fn segment_at(self, x: i64) -> usize {
        let below = self.0.partition_point(|[low, high, ..]| i64::from(double(*low, *high)) <= x);
        below.min(self.0.len().saturating_sub(1))
    }
}

fn check_table(table: &Table, base: Base, has_pulses: bool) -> Result<(), Fault> {
    let count = usize::from(table.word(0));
    if !(2..=MOST_POINTS + 1).contains(&count) {
        return Err(Fault::new(Code::AMK_POINTS).with(count as i64, MOST_POINTS as i64 + 1));
    }
    track::check_length(table, HEAD + STRIDE * (count - 1))?;
    let points = Points::new(table);
    // Indices of words are below 2^16.
    let word = |number: usize, part: usize| (HEAD + STRIDE * number + part) as i64;
    if base != Base::Absolute && points.point(0) < 0 {
        return Err(Fault::new(Code::AMK_POINT_NEGATIVE).with(points.point(0), 0));
    }
    for number in 1..points.0.len() {
        let (before, point) = (points.point(number - 1), points.point(number));
        if point <= before {
            return Err(Fault::new(Code::AMK_POINT_ORDER).with(word(number, 0), before));
        }
    }
    let last = points.point(count - 2);
    if base != Base::Absolute && last < 1 {
        return Err(Fault::new(Code::AMK_NO_MODULO).with(last, 1));
    }
    match (0..points.0.len()).find(|number| has_pulses && points.get(*number).2 > LONGEST) {
        Some(number) => Err(Fault::new(Code::AMK_TIME_LONG).with(word(number, 3), LONGEST.into())),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests;

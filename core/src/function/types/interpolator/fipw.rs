//! Table over the travel of a master, or over time (FIPW).
//!
//! Law      as for the interpolator; in modes 98 and 100 E1 = 1 is enough to clock in again after its first edge
//! Refuses  modes that are not listed, fields that a mode does not use, tables of other than 2 to 127 points at equal
//!          distances
//! Source   AMK-FIPW-01 to -55, AMK-SYNC-01 to -04; A-21 to -31

use super::Interpolator;
use super::check::{self, AllowedTables, check_tables, needs, within};
use super::register::{BEFORE_SAK, MARKS, Marks};
use super::setup::{Movement, Setup};
use crate::cam::Scale;
use crate::code::Code;
use crate::function::guest::*;
use crate::function::time::{HALF_MS, check_cycle};
use serde::{Deserialize, Serialize};

/// The parameter set.
pub(in super::super) const FIELDS: &[Field] = &[
    Field::new(
        "function",
        0,
        7,
        "bits",
        "bit 0: printing mark control, modes 2 and 98; 1: its correction stands before the compensation; 2: x begins at the zero pulse of the \
         master behind START",
        "AMK-FIPW-10",
    ),
    Field::new(
        "mode",
        0,
        132,
        "",
        "2, 4 cyclic; 26, 132 at once with E1; 82, 84 at a zero with E1; 98, 100 in with E1 = 1, out with E1 = 0; \
         2, 26, 82, 98 by way, 4, 132, 84, 100 by time",
        "AMK-FIPW-12",
    ),
    Field::new("sak", 0, 32_767, "1/128 calls", "compensation of the following error", "AMK-FIPW-13"),
    Field::new("sf_cycle", 0, 32_767, "0.5 ms", "the slot's cycle; 0: not compared", "AMK-FIPW-14"),
    Field::new("table_count", 1, 8, "", "tables of a movement", "AMK-FIPW-15"),
    Field::new("start_tables", 0, 7, "", "how many of them clock in", "AMK-FIPW-16"),
    Field::new("div_exp", 0, 15, "", "the output is divided by 2 to the power of it", "AMK-FIPW-17"),
    Field::new("sync_md_addr", 0, 0, "", "not used: the source has its zero pulse", "AMK-FIPW-18"),
    Field::new("mult", -32_768, 32_767, "", "the output is multiplied by it", "AMK-FIPW-19")
        .idle("its sink never moves"),
    Field::new("increments_per_rev", 0, 32_767, "inc", "length of each table by way, 50 at least", "AMK-FIPW-20"),
    Field::new("cycle_time", 0, 32_767 * 32_767, "0.5 ms", "length of each table by time", "AMK-FIPW-21"),
    Field::new("master_offset", 0, MOST, "inc, 0.5 ms", "x at START, or at the zero pulse", "AMK-FIPW-22"),
    Field::new("start_angle", 0, MOST, "inc, 0.5 ms", "so far behind its zero x may clock in", "AMK-FIPW-23"),
    Field::new("stop_angle", 0, MOST, "inc, 0.5 ms", "so far behind its zero x may clock out", "AMK-FIPW-24"),
    Field::new(
        "format_length",
        0,
        32_767,
        "user",
        "FL: the user's units in the travel of the working table",
        "AMK-PMC-10",
    ),
    Field::new(
        "sensor_distance",
        0,
        i32::MAX as i64,
        "user",
        "D: from the sensor to the zero of the working table",
        "AMK-PMC-11",
    ),
    Field::new("sync_shift", 0, 32_766, "user", "V: moves that zero towards the sensor", "AMK-PMC-12"),
    Field::new("valid_range", 0, 16_383, "user", "W: a mark counts so far from its place; 0: everywhere", "AMK-PMC-13"),
    Field::new("corr_start", 0, 32_767, "inc", "SK: x from which a correction is put out", "AMK-PMC-14"),
    Field::new("corr_length", 0, 32_767, "inc", "LK: over so much of x; both 0: from 3/4 on over 1/8", "AMK-PMC-15"),
    Field::new("corr_md_addr", 0, 0, "", "not used: copy the signal `deviation`", "AMK-PMC-17"),
    Field::new("weight", 0, 255, "", "k: 1/2^k of it is corrected; 32 nothing; 128 more the other way", "AMK-PMC-19"),
    Field::new("count_n", 0, 255, "", "every so many valid marks one is corrected", "AMK-PMC-20"),
];

const MOST: i64 = 32_767 * 32_767 - 1;

/// Modes, with their movement and whether they run by time.
pub(super) const MODES: [(i64, Movement, bool); 8] = [
    (2, Movement::Cyclic, false),
    (26, Movement::Immediate, false),
    (82, Movement::Sequence, false),
    (98, Movement::Coupled, false),
    (4, Movement::Cyclic, true),
    (132, Movement::Immediate, true),
    (84, Movement::Sequence, true),
    (100, Movement::Coupled, true),
];

const TAKES: AllowedTables = AllowedTables { y: 127, xy: 0, length: (0, 0) };

/// Fields of printing mark control: FL, D, V, W, SK, LK, k and n.
const REGISTER: [&str; 8] =
    ["format_length", "sensor_distance", "sync_shift", "valid_range", "corr_start", "corr_length", "weight", "count_n"];

const ZERO_PULSE: i64 = 1 << 2;

const fn at(name: &'static str) -> usize {
    place(FIELDS, name)
}

/// State of the function.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(in crate::function) struct Fipw(Interpolator);

/// Converts a parameter set with a valid mode.
fn setup(words: Words<'_>, call_ns: u64) -> Setup {
    let get = |name: usize| words.get(name);
    let mode = get(at("mode"));
    let (_, movement, by_time) = MODES.into_iter().find(|row| row.0 == mode).unwrap_or(MODES[0]);
    let (parts, call) = if by_time { check::time(call_ns) } else { (1, 0) };
    let length = if by_time { get(at("cycle_time")) } else { get(at("increments_per_rev")) };
    Setup {
        movement,
        step: by_time.then_some(call),
        length: length.saturating_mul(parts),
        parts,
        scale: Scale { mult: get(at("mult")), div_exp: get(at("div_exp")) as u32 },
        tables: get(at("table_count")) as u8,
        working: get(at("start_tables")) as u8,
        passes: 1,
        offset: get(at("master_offset")).saturating_mul(parts),
        start_angle: get(at("start_angle")).saturating_mul(parts),
        stop_angle: get(at("stop_angle")).saturating_mul(parts),
        sak: get(at("sak")),
        waits_for_zero: get(at("function")) & ZERO_PULSE != 0,
        by_level: true,
        marks: marks(words),
        ..Setup::default()
    }
}

/// Returns the settings of printing mark control; empty if it is off.
fn marks(words: Words<'_>) -> Marks {
    let get = |name| words.get(place(FIELDS, name));
    Marks::of(get("function"), REGISTER.map(get))
}

impl SlotType for Fipw {
    const DESCRIPTION: Description = Description {
        moves_axes: true,
        inputs: 1,
        outputs: 1,
        tables: 8,
        shows: OF_MARKS,
        marks: MarkSource::Encoder,
        example: &[("mode", 4), ("mult", 1), ("table_count", 1), ("cycle_time", 9)],
        ..Description::of(Kind::Fipw, "fipw", "runs through tables by the travel of its source, or by time", FIELDS)
    };

    fn new(_: &SlotSetup<'_>) -> Self {
        Self::default()
    }

    fn check(&self, words: Words<'_>, setting: &Setting<'_>) -> Result<(), Fault> {
        let field = |name| number(FIELDS, name);
        let get = |name: usize| words.get(name);
        let (mode, function) = (get(at("mode")), get(at("function")));
        let Some((_, movement, by_time)) = MODES.into_iter().find(|row| row.0 == mode) else {
            return Err(Fault::new(Code::AMK_NO_MODE).of(field("mode")).with(mode, 0));
        };
        // A source has one type of pulse, and the side of a correction needs a correction.
        let controls = function & MARKS != 0;
        let may_control = matches!(movement, Movement::Cyclic | Movement::Coupled) && !by_time;
        let is_alone = function & ZERO_PULSE == 0 && may_control;
        if controls && !is_alone || !controls && function & BEFORE_SAK != 0 {
            return Err(Fault::new(Code::AMK_MODE_FIELD).of(field("function")).with(function, mode));
        }
        check_cycle(get(at("sf_cycle")), field("sf_cycle"), setting)?;
        let (tables, starts) = (get(at("table_count")), get(at("start_tables")));
        if matches!(movement, Movement::Cyclic | Movement::Immediate) {
            needs(field("table_count"), tables, 1, mode)?;
        }
        if movement == Movement::Coupled {
            within(field("start_tables"), starts, (0, tables - 1))?;
        } else {
            needs(field("start_tables"), starts, 0, mode)?;
        }
        let (way, time) = (get(at("increments_per_rev")), get(at("cycle_time")));
        if by_time {
            needs(field("increments_per_rev"), way, 0, mode)?;
            // A call that is shorter than half a millisecond counts as one.
            let call = (i64::try_from(setting.call_ns).unwrap_or(i64::MAX) / HALF_MS).max(1);
            within(field("cycle_time"), time, (1, call.saturating_mul(32_767)))?;
            check::check_time(field("cycle_time"), time, setting.call_ns)?;
        } else {
            check::check_source(setting, mode, field("mode"))?;
            needs(field("cycle_time"), time, 0, mode)?;
            within(field("increments_per_rev"), way, (50, 32_767))?;
        }
        let last = if by_time { time - 1 } else { way - 1 };
        let [offset, start, stop] = ["master_offset", "start_angle", "stop_angle"].map(field);
        let (x, begin, end) = (get(at("master_offset")), get(at("start_angle")), get(at("stop_angle")));
        let at_once = movement == Movement::Immediate || by_time && movement == Movement::Cyclic;
        for (field, asked, is_used) in
            [(offset, x, !at_once), (start, begin, !at_once), (stop, end, movement == Movement::Coupled)]
        {
            if is_used { within(field, asked, (0, last))? } else { needs(field, asked, 0, mode)? }
        }
        if function & ZERO_PULSE != 0 && (by_time || movement == Movement::Immediate) {
            return Err(Fault::new(Code::AMK_MODE_FIELD).of(field("function")).with(function, mode));
        }
        if function & (ZERO_PULSE | MARKS) != 0 {
            check::check_zero_pulse(setting, function, field("function"))?;
        }
        if controls {
            check::check_marks(&marks(words), REGISTER.map(field), way)?;
        }
        check_tables(setting, tables as usize, &TAKES, &setup(words, setting.call_ns))
    }

    fn start(&mut self, words: Words<'_>, seen: &CallInputs<'_>) -> Outcome {
        self.0.start(setup(words, seen.call_ns), seen)
    }

    #[inline]
    fn step(&mut self, seen: &CallInputs<'_>) -> Outcome {
        self.0.step(seen)
    }

    fn rests(&self, _: u8) -> u8 {
        self.0.rests()
    }

    fn runs_with(&self, words: Words<'_>, call_ns: u64) -> bool {
        self.0.is_set(&setup(words, call_ns))
    }

    fn is_valid_state(&self) -> bool {
        self.0.is_sound()
    }

    fn modes() -> Vec<i64> {
        super::modes(false)
    }
}

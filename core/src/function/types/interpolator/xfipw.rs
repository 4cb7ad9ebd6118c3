//! Extended interpolator (XFIPW): larger tables, tables with positions, sets of tables that inputs select, several
//! passes, a start at the position of the slave.
//!
//! Law      as for the interpolator; a movement always needs a rising E1, or one that was stored during the previous
//!          movement
//! Reads    in odd modes E_SUEn and E_SU0 to 2 after E1, which select one of the sets
//! Writes   in odd modes A_SUK: the selected set is active
//! Refuses  modes that are not listed, fields that a mode does not use, tables of more than 2000 points, or 1000 with
//!          positions
//! Source   AMK-XFIPW-01 to -68, -86 to -126; A-04 to -22, A-29, A-31

use super::check::{self, AllowedTables, check_tables, count_tables, needs, within};
use super::register::{BEFORE_SAK, MARKS, Marks};
use super::setup::{Movement, Setup};
use super::{Interpolator, fipw, value_at};
use crate::cam::{Curve, Scale};
use crate::code::Code;
use crate::function::guest::*;
use crate::function::time::check_cycle;
use crate::table::Form;
use serde::{Deserialize, Serialize};

/// The parameter set.
pub(in super::super) const FIELDS: &[Field] = &[
    Field::new(
        "function",
        0,
        63,
        "bits",
        "bit 0: printing mark control, ba 2, 26, 82 and 98; 1: its correction stands before the compensation; \
         2: x begins at the zero pulse of the master; 3: the slave is where x is at START; 4: an edge of E1 in a movement counts at its end; \
 5: sets are switched at each end of a table",
        "AMK-XFIPW-92",
    ),
    Field::new(
        "ba",
        0,
        133,
        "",
        "the modes of fipw; one more each: with sets of tables that inputs select",
        "AMK-XFIPW-97",
    ),
    Field::new("sak_factor", 0, 32_767, "1/128 calls", "compensation of the following error", "AMK-XFIPW-98"),
    Field::new("sf_cycle", 0, 32_767, "0.5 ms", "the slot's cycle; 0: not compared", "AMK-XFIPW-99"),
    Field::new("tables_total", 1, 8, "", "tables of a movement, of each set", "AMK-XFIPW-100"),
    Field::new(
        "tables_start",
        0,
        7,
        "",
        "how many of them clock in; the next one is the working table",
        "AMK-XFIPW-101",
    ),
    Field::new("div_exp", 0, 15, "", "the output is divided by 2 to the power of it", "AMK-XFIPW-102"),
    Field::new("ext_sync_md", 0, 0, "", "not used: the source has its zero pulse", "AMK-XFIPW-103"),
    Field::new(
        "work_cycles",
        0,
        255,
        "",
        "passes of the working table, where a movement ends by itself; 0 is 1",
        "AMK-XFIPW-104",
    ),
    Field::new("mult", -32_768, 32_767, "", "the output is multiplied by it", "AMK-XFIPW-105")
        .idle("its sink never moves"),
    Field::new("incr_per_rev", 0, 32_767, "inc", "length of tables of form y by way, 50 at least", "AMK-XFIPW-106"),
    Field::new("cycle_time", 0, 32_767, "0.5 ms", "length of tables of form y by time", "AMK-XFIPW-106"),
    Field::new(
        "master_offset",
        -32_767,
        32_767,
        "inc, 0.5 ms",
        "x at START, or at the zero pulse; READ_VALUE: where",
        "AMK-XFIPW-107",
    ),
    Field::new("start_angle", 0, 32_767, "inc, 0.5 ms", "so far behind its zero x may clock in", "AMK-XFIPW-108"),
    Field::new("stop_angle", 0, 32_767, "inc, 0.5 ms", "so far behind its zero x may clock out", "AMK-XFIPW-109"),
    live("format_length", 32_767, "user", "FL: the user's units in the travel of the working table", "AMK-XFIPW-110"),
    live(
        "sensor_distance",
        i32::MAX as i64,
        "user",
        "D: from the sensor to the zero of the working table",
        "AMK-XFIPW-111",
    ),
    live("sync_shift", 32_766, "user", "V: moves that zero towards the sensor", "AMK-XFIPW-112"),
    live("valid_range", 16_383, "user", "W: a mark counts so far from its place; 0: everywhere", "AMK-XFIPW-113"),
    live("corr_start", 32_767, "inc", "SK: x from which a correction is put out", "AMK-XFIPW-114"),
    live("corr_len", 32_767, "inc", "LK: over so much of x; both 0: from 3/4 on over 1/8", "AMK-XFIPW-115"),
    live("corr_md", 0, "", "not used: copy the signal `deviation`", "AMK-XFIPW-116"),
    live("corr_weight", 255, "", "k: 1/2^k of it is corrected; 32 nothing; 128 more the other way", "AMK-XFIPW-117"),
    live("corr_every", 255, "", "every so many valid marks one is corrected", "AMK-XFIPW-118"),
    Field::new(
        "output_value",
        i32::MIN as i64,
        i32::MAX as i64,
        "inc",
        "what READ_VALUE at rest finds at master_offset",
        "AMK-XFIPW-119",
    ),
];

/// Returns a field of printing mark control, which VALUE_NEW changes.
const fn live(name: &'static str, max: i64, unit: &'static str, help: &'static str, source: &'static str) -> Field {
    Field::new(name, 0, max, unit, help, source).live()
}

const TAKES: AllowedTables = AllowedTables { y: 2000, xy: 1000, length: (50, 32_767) };

/// Fields of printing mark control: FL, D, V, W, SK, LK, k and n.
const REGISTER: [&str; 8] = [
    "format_length",
    "sensor_distance",
    "sync_shift",
    "valid_range",
    "corr_start",
    "corr_len",
    "corr_weight",
    "corr_every",
];

const ZERO_PULSE: i64 = 1 << 2;
const SET_ON: i64 = 1 << 3;
const RETRIGGER: i64 = 1 << 4;
const EVERYWHERE: i64 = 1 << 5;

const fn at(name: &'static str) -> usize {
    place(FIELDS, name)
}

/// State of the function.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(in crate::function) struct Xfipw(Interpolator);

/// Returns the movement of a mode, whether it runs by time, and whether it selects sets.
fn mode_of(ba: i64) -> Option<(Movement, bool, bool)> {
    let row = fipw::MODES.into_iter().find(|row| row.0 == ba & !1)?;
    Some((row.1, row.2, ba & 1 == 1))
}

/// Converts a parameter set with a valid mode.
fn setup(words: Words<'_>, call_ns: u64) -> Setup {
    let get = |name: usize| words.get(name);
    let (movement, by_time, switches_sets) = mode_of(get(at("ba"))).unwrap_or_default();
    let (parts, call) = if by_time { check::time(call_ns) } else { (1, 0) };
    let length = if by_time { get(at("cycle_time")) } else { get(at("incr_per_rev")) };
    let has = |bit: i64| get(at("function")) & bit != 0;
    Setup {
        movement,
        step: by_time.then_some(call),
        length: length.saturating_mul(parts),
        parts,
        scale: Scale { mult: get(at("mult")), div_exp: get(at("div_exp")) as u32 },
        tables: get(at("tables_total")) as u8,
        working: get(at("tables_start")) as u8,
        passes: get(at("work_cycles")).max(1),
        offset: get(at("master_offset")).saturating_mul(parts),
        start_angle: get(at("start_angle")).saturating_mul(parts),
        stop_angle: get(at("stop_angle")).saturating_mul(parts),
        sak: get(at("sak_factor")),
        waits_for_zero: has(ZERO_PULSE),
        sets_on: has(SET_ON),
        by_level: false,
        retriggers: has(RETRIGGER),
        switches_sets,
        switches_everywhere: has(EVERYWHERE),
        shows_marks: has(MARKS),
        marks: marks(words),
    }
}

/// Returns the settings of printing mark control; empty if it is off.
fn marks(words: Words<'_>) -> Marks {
    let get = |name| words.get(place(FIELDS, name));
    Marks::of(get("function"), REGISTER.map(get))
}

/// Returns the number of tables that a set needs: those of one movement, or all tables of the slot.
fn tables_of(setting: &Setting<'_>, total: i64, switches_sets: bool) -> Result<usize, Fault> {
    let (there, total) = (count_tables(setting), total as usize);
    if !switches_sets || there < total {
        return Ok(total);
    }
    if there.checked_rem(total) == Some(0) {
        return Ok(there);
    }
    let field = number(FIELDS, "tables_total");
    Err(Fault::new(Code::AMK_TABLE_SETS).of(field).with(there as i64, total as i64))
}

impl Xfipw {
    /// Checks the fields against each other, except the offset, which READ_VALUE accepts in all modes.
    fn check_set(words: Words<'_>, setting: &Setting<'_>) -> Result<(), Fault> {
        let field = |name| number(FIELDS, name);
        let get = |name: usize| words.get(name);
        let (ba, function) = (get(at("ba")), get(at("function")));
        let Some((movement, by_time, switches_sets)) = mode_of(ba) else {
            return Err(Fault::new(Code::AMK_NO_MODE).of(field("ba")).with(ba, 0));
        };
        let cycles = movement == Movement::Cyclic;
        // A bit is rejected in modes in which it has no effect.
        let controls = function & MARKS != 0;
        let unused = [
            (MARKS, by_time || switches_sets),
            (BEFORE_SAK, !controls),
            // A source has one type of pulse.
            (ZERO_PULSE, by_time || controls),
            (SET_ON, !cycles),
            (RETRIGGER, cycles),
            (EVERYWHERE, !switches_sets),
        ];
        let is_unused = |(bit, is_unused): (i64, bool)| is_unused && function & bit != 0;
        if unused.into_iter().any(is_unused) {
            return Err(Fault::new(Code::AMK_MODE_FIELD).of(field("function")).with(function, ba));
        }
        check_cycle(get(at("sf_cycle")), field("sf_cycle"), setting)?;
        let (total, starts) = (get(at("tables_total")), get(at("tables_start")));
        if matches!(movement, Movement::Cyclic | Movement::Immediate) {
            needs(field("tables_total"), total, 1, ba)?;
        }
        if matches!(movement, Movement::Coupled | Movement::Sequence) {
            within(field("tables_start"), starts, (0, total - 1))?;
        } else {
            needs(field("tables_start"), starts, 0, ba)?;
        }
        if matches!(movement, Movement::Coupled | Movement::Cyclic) {
            // 1 is the same as 0 (AMK-XFIPW-37).
            needs(field("work_cycles"), get(at("work_cycles")).max(1), 1, ba)?;
        }
        let count = tables_of(setting, total, switches_sets)?;
        let has_y = setting.tables.iter().take(count).flatten().any(|table| table.form() == Form::Y);
        let (way, time) = (get(at("incr_per_rev")), get(at("cycle_time")));
        if by_time {
            needs(field("incr_per_rev"), way, 0, ba)?;
            if has_y {
                within(field("cycle_time"), time, (1, 32_767))?;
                check::check_time(field("cycle_time"), time, setting.call_ns)?;
            }
        } else {
            check::check_source(setting, ba, field("ba"))?;
            needs(field("cycle_time"), time, 0, ba)?;
            if has_y {
                within(field("incr_per_rev"), way, (50, 32_767))?;
            }
        }
        if function & (ZERO_PULSE | MARKS) != 0 {
            check::check_zero_pulse(setting, function, field("function"))?;
        }
        let length = if by_time { (1, check::longest(setting.call_ns).min(32_767)) } else { TAKES.length };
        check_tables(setting, count, &AllowedTables { length, ..TAKES }, &setup(words, setting.call_ns))
    }

    /// Checks the offset and the windows, which depend on the mode.
    fn check_places(words: Words<'_>, setting: &Setting<'_>) -> Result<(), Fault> {
        let get = |name: usize| words.get(name);
        let ba = get(at("ba"));
        let (movement, by_time, _) = mode_of(ba).unwrap_or_default();
        let setup = setup(words, setting.call_ns);
        let last = |place: usize| {
            let table = setting.tables.get(place).copied().flatten();
            Curve::new(table, setup.length, setup.parts).length() / setup.parts.max(1) - 1
        };
        let at_once = movement == Movement::Immediate || by_time && movement == Movement::Cyclic;
        let least = if by_time { 0 } else { -last(0) };
        let marks = setup.marks;
        if setup.shows_marks {
            let fields = REGISTER.map(|name| number(FIELDS, name));
            check::check_marks(&marks, fields, last(usize::from(setup.working)) + 1)?;
        }
        let rows = [
            ("master_offset", !at_once, (least, last(0))),
            ("start_angle", !at_once, (0, last(0))),
            ("stop_angle", movement == Movement::Coupled, (0, last(usize::from(setup.working)))),
        ];
        rows.into_iter().try_for_each(|(name, is_used, range)| {
            let (field, asked) = (number(FIELDS, name), get(place(FIELDS, name)));
            if is_used { within(field, asked, range) } else { needs(field, asked, 0, ba) }
        })
    }
}

impl SlotType for Xfipw {
    const DESCRIPTION: Description = Description {
        moves_axes: true,
        inputs: 5,
        outputs: 2,
        tables: 8,
        shows: OF_MARKS_AND_ANSWER,
        reads_at_rest: true,
        marks: MarkSource::Encoder,
        example: &[("ba", 4), ("mult", 1), ("tables_total", 1), ("cycle_time", 9)],
        ..Description::of(
            Kind::Xfipw,
            "xfipw",
            "runs through large tables and sets of them by the travel of its source, or by time",
            FIELDS,
        )
    };

    fn new(_: &SlotSetup<'_>) -> Self {
        Self::default()
    }

    fn check(&self, words: Words<'_>, setting: &Setting<'_>) -> Result<(), Fault> {
        Self::check_set(words, setting)?;
        Self::check_places(words, setting)
    }

    fn start(&mut self, words: Words<'_>, seen: &CallInputs<'_>) -> Outcome {
        self.0.start(setup(words, seen.call_ns), seen)
    }

    fn apply_values(&mut self, words: Words<'_>) {
        self.0.renew(marks(words));
    }

    #[inline]
    fn step(&mut self, seen: &CallInputs<'_>) -> Outcome {
        self.0.step(seen)
    }

    /// Returns the position of the slave at `master_offset`, relative to the zero of the first table.
    fn read(&self, words: Words<'_>, setting: &Setting<'_>) -> Result<Option<(u16, i64)>, Fault> {
        Self::check_set(words, setting)?;
        let setup = setup(words, setting.call_ns);
        let [table, ..] = setting.tables;
        let value = value_at(&Curve::new(table, setup.length, setup.parts), setup.offset, &setup);
        if i32::try_from(value).is_err() {
            let bound = if value < 0 { i32::MIN } else { i32::MAX };
            return Err(check::out_of_range(number(FIELDS, "output_value"), value, bound.into()));
        }
        Ok(Some((at("output_value") as u16, value)))
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
        super::modes(true)
    }
}

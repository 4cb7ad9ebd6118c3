//! Speed that follows another speed through a table.
//!
//! Law      n is the source, or the speed of its travel per call; T = table(n), linear between points at equal
//!          distances from 0 to in_final, n itself without a table; y = T * mult / div, with bit 2 of ba also divided
//!          by the last point over in_final; then y is limited to n * ratio_min / ratio_div and n * ratio_max /
//!          ratio_div, so that it is 0 where n is 0, and then to out_min and out_max. The calculation is exact and
//!          rounded towards 0 once: a table that is mirrored at 0 mirrors each unit
//! Reads    the source; with bit 1 of ba, E1 = 1 runs, and a rising E2 activates the table that E3 to E5 select and the
//!          waiting ratio
//! Writes   the sink (0.0001 rpm); with bit 1 of ba A1 = 1 while it is stopped, A2 = 1 from an accepted strobe until E2
//!          falls; signals of the limits that changed the output of the last call, and of the active ratio and table,
//!          instead of the output table of the source
//! Refuses  an eighth table, tables that do not hold speeds, ratio limits that exclude each other, an active table that
//!          is missing, a ratio related to 0; new numbers for the active table
//! Source   AMK-DFKT-01 to -50 and -52 to -54 with D1 to D11

mod points;

use crate::code::Code;
use crate::function::guest::*;
use crate::function::time::check_cycle;
use points::{Points, check_tables};
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;

/// The parameter set.
pub(super) const FIELDS: &[Field] = &[
    Field::new(
        "ba",
        0,
        7,
        "bits",
        "bit 0: the input is the travel of the source, not a speed; bit 1: inputs run it and choose its table; \
         bit 2: mult / div is the ratio of the whole table",
        "AMK-DFKT-08",
    ),
    Field::new(
        "sf_cycle_time",
        0,
        WORD,
        "0.5 ms",
        "the slot's cycle; 0: not compared; with bit 0 of ba",
        "AMK-DFKT-09",
    ),
    Field::new("table_count", 0, 7, "", "tables that may be active", "AMK-DFKT-10"),
    Field::new("active_table", 0, 7, "", "1 to 7: Tab0 to Tab6; 0: none", "AMK-DFKT-11").live(),
    Field::new("div", 1, WORD, "", "the output is divided by it", "AMK-DFKT-12").live(),
    Field::new("mult", -WORD, WORD, "", "the output is multiplied by it", "AMK-DFKT-13")
        .live()
        .idle("the function gives no speed"),
    Field::new("in_resolution", 0, 65_535, "inc/rev", "one turn of the master; with bit 0 of ba", "AMK-DFKT-14").live(),
    Field::new("in_final", 1, WORD, "rpm", "the input at the last point", "AMK-DFKT-15").live(),
    Field::new("out_max", 0, WORD, "rpm", "largest output", "AMK-DFKT-16")
        .live()
        .idle("the function gives no speed above 0"),
    Field::new("out_min", -WORD, 0, "rpm", "least output", "AMK-DFKT-17")
        .live()
        .idle("the function gives no speed below 0"),
    Field::new("ratio_max", -WORD, WORD, "1/ratio_div", "largest output per input", "AMK-DFKT-18").live(),
    Field::new("ratio_min", -WORD, WORD, "1/ratio_div", "least output per input", "AMK-DFKT-19").live(),
    Field::new("ratio_div", 1, WORD, "", "unit of both limits", "AMK-DFKT-20").live(),
    Field::new("cont_low", 0, 2, "", "an input below 0: 0 holds the first point, 2 mirrors the table", "AMK-DFKT-21")
        .live(),
    Field::new("cont_high", 0, 1, "", "beyond in_final: 0 holds the last point, 1 goes straight on", "AMK-DFKT-22")
        .live(),
];

/// Largest value of a signed word; the smallest one is its negative.
const WORD: i64 = 32_767;
/// One revolution per minute, in units of source and sink.
const RPM: i64 = 10_000;
/// One increment per nanosecond as a speed in units of source and sink, for turns of one increment.
const PER_NS: i64 = 60 * 1_000_000_000 * RPM;
/// Upper bound of the time between calls (ns), far above any cycle.
const CALL_BOUND: i64 = 1 << 40;

const BA: usize = place(FIELDS, "ba");
const ACTIVE_TABLE: usize = place(FIELDS, "active_table");
const TABLE_COUNT: usize = place(FIELDS, "table_count");
const MULT: usize = place(FIELDS, "mult");
const IN_RESOLUTION: usize = place(FIELDS, "in_resolution");
const IN_FINAL: usize = place(FIELDS, "in_final");
const SF_CYCLE_TIME: usize = place(FIELDS, "sf_cycle_time");
const DIV: usize = place(FIELDS, "div");
const OUT_MAX: usize = place(FIELDS, "out_max");
const OUT_MIN: usize = place(FIELDS, "out_min");
const RATIO_MAX: usize = place(FIELDS, "ratio_max");
const RATIO_MIN: usize = place(FIELDS, "ratio_min");
const RATIO_DIV: usize = place(FIELDS, "ratio_div");
const CONT_LOW: usize = place(FIELDS, "cont_low");
const CONT_HIGH: usize = place(FIELDS, "cont_high");

const RUN: u8 = 1 << 0;
const STROBE: u8 = 1 << 1;

const A1: u8 = 1 << 0;
const A2: u8 = 1 << 1;

/// Bits of the status (AMK-DFKT-52): the limits that changed the output, and the side of the table on which the input
/// is.
mod status {
    pub(super) const RATIO_MAX: u8 = 1 << 0;
    pub(super) const RATIO_MIN: u8 = 1 << 1;
    pub(super) const OUT_MAX: u8 = 1 << 2;
    pub(super) const OUT_MIN: u8 = 1 << 3;
    pub(super) const TABLE_HIGH: u8 = 1 << 4;
    pub(super) const TABLE_LOW: u8 = 1 << 5;
    /// Number of bits.
    pub(super) const BITS: usize = 6;
}

/// The signals, in the order of the output table; the active table is an addition of ours.
pub(super) const SHOWS: &[Shown; status::BITS + 3] = &[
    Shown::bit("limit.ratio_max", "ratio_max limits the output"),
    Shown::bit("limit.ratio_min", "ratio_min limits the output"),
    Shown::bit("limit.out_max", "out_max limits the output"),
    Shown::bit("limit.out_min", "out_min limits the output"),
    Shown::bit("limit.table_high", "the input exceeds in_final, the end of the table in force"),
    Shown::bit("limit.table_low", "the input is below 0, the start of the table in force"),
    Shown::number("ratio.mult", "numerator of the ratio in force"),
    Shown::number("ratio.div", "denominator of the ratio in force"),
    Shown::number("table", "table in force (1 to 7: Tab0 to Tab6, 0: none)"),
];

/// Values that only START takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Mode {
    by_way: bool,
    by_inputs: bool,
    /// Whether the ratio is relative to that of the last point to in_final.
    is_relative: bool,
    tables: u8,
}

impl Mode {
    fn of(words: Words<'_>) -> Self {
        let (ba, tables) = (words.get(BA), words.get(TABLE_COUNT).clamp(0, LINES as i64 - 1) as u8);
        Self { by_way: ba & 1 != 0, by_inputs: ba & 2 != 0, is_relative: ba & 4 != 0, tables }
    }
}

/// The ratio V.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Ratio {
    mult: i64,
    div: i64,
}

/// Values that VALUE_NEW takes at once.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct LiveValues {
    /// Speed of one increment per call, as a reduced fraction.
    of_way: (i64, i64),
    in_final: i64,
    /// Minimum and maximum output (rpm).
    outputs: (i64, i64),
    ratios: (i64, i64),
    ratio_div: i64,
    mirrors: bool,
    extends: bool,
}

impl LiveValues {
    fn of(words: Words<'_>, call_ns: i64) -> Self {
        let get = |name| words.get(name);
        let (turn, call) = (get(IN_RESOLUTION).clamp(1, 65_535), call_ns.clamp(1, CALL_BOUND));
        Self {
            of_way: reduced(PER_NS, turn * call),
            in_final: get(IN_FINAL),
            outputs: (get(OUT_MIN), get(OUT_MAX)),
            ratios: (get(RATIO_MIN), get(RATIO_MAX)),
            ratio_div: get(RATIO_DIV),
            mirrors: get(CONT_LOW) == 2,
            extends: get(CONT_HIGH) == 1,
        }
    }

    /// Returns true if no result of these values can exceed 128 bits.
    fn is_sound(&self) -> bool {
        let is_word = |value: i64| (-WORD..=WORD).contains(&value);
        let is_divisor = |value: i64| (1..=WORD).contains(&value);
        let words = [self.outputs.0, self.outputs.1, self.ratios.0, self.ratios.1];
        (1..=PER_NS).contains(&self.of_way.0)
            && (1..=65_535 * CALL_BOUND).contains(&self.of_way.1)
            && is_divisor(self.in_final)
            && is_divisor(self.ratio_div)
            && words.into_iter().all(is_word)
    }
}

/// State of the function.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in crate::function) struct Dfkt {
    mode: Mode,
    live: LiveValues,
    ratio: Ratio,
    /// Ratio that the next strobe activates.
    waiting: Ratio,
    /// Active table: 1 to 7 for Tab0 to Tab6; 0: none.
    table: u8,
    /// Time between two calls (ns).
    call_ns: i64,
    /// Travel of the source at the last call.
    travel: i64,
    /// Inputs of the last call.
    before: u8,
    /// Output A2.
    is_taken: bool,
    /// Interval of the table in the last call.
    near: u8,
    /// Values of [`SHOWS`].
    shown: [i64; SHOWS.len()],
}

/// The input: `n / unit` in 0.0001 rpm.
#[derive(Clone, Copy)]
struct Input {
    n: i128,
    unit: i128,
}

impl Dfkt {
    /// Publishes the status of a call and the active ratio and table.
    #[inline]
    fn show(&mut self, status: u8) {
        let bit = |nth: u8| i64::from(status >> nth & 1);
        let Ratio { mult, div } = self.ratio;
        self.shown = [bit(0), bit(1), bit(2), bit(3), bit(4), bit(5), mult, div, self.table.into()];
    }

    /// Returns the speed of the source.
    #[inline]
    fn input(&mut self, seen: &CallInputs<'_>) -> Input {
        let way = seen.source.travel.wrapping_sub(std::mem::replace(&mut self.travel, seen.source.travel));
        if !self.mode.by_way {
            return Input { n: seen.source.value.into(), unit: 1 };
        }
        // No encoder travels further in a call.
        let way = way.clamp(i32::MIN.into(), i32::MAX.into());
        let (n, unit) = self.live.of_way;
        Input { n: i128::from(way) * i128::from(n), unit: unit.into() }
    }

    /// A rising E2 activates the selected table, if it exists, and the waiting ratio.
    fn choose(&mut self, seen: &CallInputs<'_>) {
        let rising = seen.inputs & !std::mem::replace(&mut self.before, seen.inputs);
        if rising & STROBE != 0 {
            // With three tables or fewer E5 is not used.
            let lines = if self.mode.tables <= 3 { 0b011 } else { 0b111 };
            let table = seen.inputs >> 2 & lines;
            if self.may_choose(table, seen) {
                (self.table, self.ratio, self.is_taken) = (table, self.waiting, true);
            }
        }
        self.is_taken &= seen.inputs & STROBE != 0;
    }

    fn may_choose(&self, table: u8, seen: &CallInputs<'_>) -> bool {
        if table == 0 {
            return true;
        }
        let points = points(table, seen);
        table <= self.mode.tables && points.is_some_and(|points| !self.mode.is_relative || points.last() != 0)
    }

    /// Returns the output for an input, and its status. n is below 2^31 * 2^50 for travel, and below 2^63 with unit 1
    /// for a speed; unit is below 2^57. Points and words have 15 bits, in_final 29 in units: the largest product, n *
    /// 126 * a rise * mult, stays below 2^81 * 2^7 * 2^16 * 2^15.
    #[inline]
    fn output(&mut self, input: Input, seen: &CallInputs<'_>) -> (i64, u8) {
        let (t, divisor, beyond) = match points(self.table, seen) {
            Some(points) => {
                let t = self.look_up(input, points);
                let base = if self.mode.is_relative { points.last() } else { self.live.in_final };
                let divisor = i128::from(base.unsigned_abs()) * input.unit;
                (if base < 0 { -t } else { t }, divisor, self.beyond(input))
            }
            None => (input.n, input.unit, 0),
        };
        let Ratio { mult, div } = self.ratio;
        let y = truncated(t * i128::from(mult), divisor * i128::from(div));
        // Rounding is monotonic: limiting the rounded value by rounded limits equals a single rounding.
        let of_input =
            |ratio: i64| truncated(input.n * i128::from(ratio), input.unit * i128::from(self.live.ratio_div));
        let (a, b) = (of_input(self.live.ratios.0), of_input(self.live.ratios.1));
        let geared = y.max(a.min(b)).min(a.max(b));
        let sink = geared.max(self.live.outputs.0 * RPM).min(self.live.outputs.1 * RPM);
        // For an input below 0 the ratio is too large if the output is too small.
        let is_ratio_over = if input.n < 0 { geared > y } else { geared < y };
        let by_ratio = if geared == y {
            0
        } else if is_ratio_over {
            status::RATIO_MAX
        } else {
            status::RATIO_MIN
        };
        let by_output = match sink.cmp(&geared) {
            Ordering::Less => status::OUT_MAX,
            Ordering::Equal => 0,
            Ordering::Greater => status::OUT_MIN,
        };
        (sink, by_ratio | by_output | beyond)
    }

    /// Returns the side of the table on which an input is, regardless of the continuation of the table.
    #[inline]
    fn beyond(&self, Input { n, unit }: Input) -> u8 {
        if n < 0 {
            status::TABLE_LOW
        } else if n > i128::from(self.live.in_final * RPM) * unit {
            status::TABLE_HIGH
        } else {
            0
        }
    }

    /// Returns the table at an input: T * in_final * unit, T in 0.0001 rpm.
    #[inline]
    fn look_up(&mut self, Input { n, unit }: Input, points: Points<'_>) -> i128 {
        let end = i128::from(self.live.in_final * RPM) * unit;
        let is_mirrored = n < 0 && self.live.mirrors;
        let x = if is_mirrored { -n } else { n };
        let t = if x < 0 {
            i128::from(points.first()) * end
        } else if x > end && !self.live.extends {
            i128::from(points.last()) * end
        } else {
            let (i, part) = self.interval(x, end, points.intervals());
            let value = |i: usize| i128::from(points.get(i));
            value(i) * end + (value(i + 1) - value(i)) * part
        };
        if is_mirrored { -t } else { t }
    }

    /// Returns the interval i of x, and (x - i * step) / step in parts of `end`. Beyond the end it is the last
    /// interval.
    #[inline]
    fn interval(&mut self, x: i128, end: i128, intervals: usize) -> (usize, i128) {
        let (scaled, near) = (x * intervals as i128, usize::from(self.near));
        let part = scaled - i128::from(self.near) * end;
        // Most calls stay in their interval: a division takes as long as the rest of the call.
        if near < intervals && (0..end).contains(&part) {
            return (near, part);
        }
        let i = truncated(scaled, end).clamp(0, intervals as i64 - 1);
        self.near = i as u8;
        (i as usize, scaled - i128::from(i) * end)
    }

    /// Returns the outcome of a call.
    fn outcome(&self, sink: i64, runs: bool) -> Outcome {
        let a1 = if runs { 0 } else { A1 };
        let a2 = if self.is_taken { A2 } else { 0 };
        let (outputs, writes) = if self.mode.by_inputs { (a1 | a2, A1 | A2) } else { (0, 0) };
        Outcome { sink, outputs, writes, ..Outcome::default() }
    }

    /// Returns the table for the check of a parameter set: the one that inputs selected, otherwise that of the set.
    fn active_table(&self, words: Words<'_>, setting: &Setting<'_>) -> i64 {
        let is_chosen = setting.runs && Mode::of(words).by_inputs;
        if is_chosen { self.table.into() } else { words.get(ACTIVE_TABLE) }
    }

    /// Returns an error if the active table is missing, gives no ratio, or gets new numbers.
    fn check_active(&self, words: Words<'_>, setting: &Setting<'_>) -> Result<(), Fault> {
        let (active, mode) = (self.active_table(words, setting), Mode::of(words));
        let field = number(FIELDS, "active_table");
        let Ok(place) = usize::try_from(active - 1) else { return Ok(()) };
        if active > mode.tables.into() {
            return Err(Fault::new(Code::AMK_BEYOND).of(field).with(active, mode.tables.into()));
        }
        let Some(table) = setting.tables.get(place).copied().flatten() else {
            return Err(Fault::new(Code::AMK_TABLE_NONE).of(field).with(active, place as i64));
        };
        if let Occasion::Edit(edited) = setting.occasion
            && edited >> place & 1 == 1
        {
            return Err(Fault::new(Code::AMK_TABLE_IN_USE).with(place as i64, 0));
        }
        let Some(points) = Points::of(table).filter(|_| mode.is_relative) else { return Ok(()) };
        if points.last() == 0 {
            return Err(Fault::new(Code::AMK_LAST_POINT).with(place as i64, 0));
        }
        // A strobe may have activated another table for a running set: the product is too large then, but harmless.
        let (mult, most) = (words.get(MULT), WORD * words.get(IN_FINAL));
        if setting.occasion == Occasion::Order && (mult * points.last()).abs() > most {
            let limit = most / points.last().abs().max(1) * mult.signum();
            return Err(Fault::new(Code::AMK_BEYOND).of(number(FIELDS, "mult")).with(mult, limit));
        }
        Ok(())
    }
}

impl SlotType for Dfkt {
    const DESCRIPTION: Description = Description {
        source: Requirement::Must,
        quantity: Quantity::Speed,
        moves_axes: true,
        inputs: 5,
        outputs: 2,
        rests: 1,
        tables: 8,
        edits_tables: true,
        shows: SHOWS,
        example: &[
            ("table_count", 1),
            ("active_table", 1),
            ("div", 1),
            ("mult", 1),
            ("in_resolution", 1),
            ("in_final", 1),
            ("ratio_max", 1),
            ("ratio_div", 1),
        ],
        ..Description::of(Kind::Dfkt, "dfkt", "follows a speed through a table, within limits", FIELDS)
    };

    fn new(_: &SlotSetup<'_>) -> Self {
        let live = LiveValues {
            of_way: (1, 1),
            in_final: 1,
            outputs: (0, 0),
            ratios: (0, 0),
            ratio_div: 1,
            mirrors: false,
            extends: false,
        };
        let ratio = Ratio { mult: 0, div: 1 };
        let mode = Mode::default();
        Self {
            mode,
            live,
            ratio,
            waiting: ratio,
            table: 0,
            call_ns: 1,
            travel: 0,
            before: 0,
            is_taken: false,
            near: 0,
            shown: [0; SHOWS.len()],
        }
    }

    fn check(&self, words: Words<'_>, setting: &Setting<'_>) -> Result<(), Fault> {
        let get = |name| words.get(name);
        let mode = Mode::of(words);
        if mode.by_way {
            check_cycle(get(SF_CYCLE_TIME), number(FIELDS, "sf_cycle_time"), setting)?;
            if get(IN_RESOLUTION) < 1 {
                let fault = Fault::new(Code::AMK_NO_RESOLUTION).of(number(FIELDS, "in_resolution"));
                return Err(fault.with(get(IN_RESOLUTION), 65_535));
            }
        }
        let (least, most) = (get(RATIO_MIN), get(RATIO_MAX));
        if least >= most {
            return Err(Fault::new(Code::AMK_RATIO_LIMITS).of(number(FIELDS, "ratio_min")).with(least, most));
        }
        if get(CONT_LOW) == 1 {
            return Err(Fault::new(Code::AMK_CONTINUATION).of(number(FIELDS, "cont_low")).with(1, 2));
        }
        check_tables(setting, mode.tables.into())?;
        self.check_active(words, setting)
    }

    fn start(&mut self, words: Words<'_>, seen: &CallInputs<'_>) -> Outcome {
        *self = Self {
            mode: Mode::of(words),
            call_ns: i64::try_from(seen.call_ns).unwrap_or(i64::MAX),
            travel: seen.source.travel,
            before: seen.inputs,
            ..Self::new(&SlotSetup::default())
        };
        self.apply_values(words);
        (self.ratio, self.table) = (self.waiting, words.get(ACTIVE_TABLE).clamp(0, self.mode.tables.into()) as u8);
        self.step(seen)
    }

    fn apply_values(&mut self, words: Words<'_>) {
        self.live = LiveValues::of(words, self.call_ns);
        self.waiting = Ratio { mult: words.get(MULT), div: words.get(DIV) };
        if !self.mode.by_inputs {
            (self.ratio, self.table) = (self.waiting, words.get(ACTIVE_TABLE).clamp(0, self.mode.tables.into()) as u8);
        }
    }

    #[inline]
    fn step(&mut self, seen: &CallInputs<'_>) -> Outcome {
        let input = self.input(seen);
        if self.mode.by_inputs {
            self.choose(seen);
        }
        let runs = !self.mode.by_inputs || seen.inputs & RUN != 0;
        let (sink, status) = if runs { self.output(input, seen) } else { (0, 0) };
        self.show(status);
        self.outcome(sink, runs)
    }

    fn is_valid_state(&self) -> bool {
        let is_sound = |ratio: Ratio| (-WORD..=WORD).contains(&ratio.mult) && (1..=WORD).contains(&ratio.div);
        let tables = 0..=LINES as u8 - 1;
        self.live.is_sound()
            && is_sound(self.ratio)
            && is_sound(self.waiting)
            && tables.contains(&self.mode.tables)
            && tables.contains(&self.table)
            && self.shown.iter().take(status::BITS).all(|bit| (0..=1).contains(bit))
    }

    #[inline]
    fn shown(&self) -> &[i64] {
        &self.shown
    }
}

/// Returns the points of Tab0 to Tab6, counted from 1; `None` for table 0.
#[inline]
fn points<'a>(table: u8, seen: &CallInputs<'a>) -> Option<Points<'a>> {
    seen.tables.get(usize::from(table).checked_sub(1)?).and_then(Points::of)
}

/// Returns a quotient, rounded towards 0 and saturated; the divisor is above 0.
#[inline]
fn truncated(dividend: i128, divisor: i128) -> i64 {
    match (i64::try_from(dividend), i64::try_from(divisor)) {
        // A division of 64 bits takes a fraction of the time.
        (Ok(dividend), Ok(divisor)) if divisor > 0 => dividend / divisor,
        _ => {
            let quotient = dividend / divisor.max(1);
            i64::try_from(quotient).unwrap_or(if quotient < 0 { i64::MIN } else { i64::MAX })
        }
    }
}

/// Returns a fraction in lowest terms; both parts are above 0.
fn reduced(numerator: i64, denominator: i64) -> (i64, i64) {
    let (mut a, mut b) = (numerator, denominator);
    while b != 0 {
        (a, b) = (b, a % b);
    }
    (numerator / a.max(1), denominator / a.max(1))
}

#[cfg(test)]
mod tests;

//! One of several tables over time, selected by inputs (FIPZ).
//!
//! Law      a rising E(j+1), or E1 with the number j at E2 to E4, starts table j at once, at t = 0; it lasts
//!          `cycle_time[j]` and ends with its last value; time beyond its end is dropped. Edges while it runs are
//!          ignored; of several edges the lowest input counts
//! Reads    E1 to E8, the time of the calls, up to eight tables
//! Writes   the sink, A1 = 1 at rest
//! Source   AMK-FIPZ-01 to -20, A-36, A-37

use super::check::{self, AllowedTables, check_tables};
use super::setup::Setup;
use crate::cam::{Curve, Scale, Total};
use crate::function::guest::*;
use crate::function::sak::Sak;
use crate::function::time::check_cycle;
use serde::{Deserialize, Serialize};

/// The parameter set.
pub(in super::super) const FIELDS: &[Field] = &[
    Field::new(
        "mode",
        16,
        17,
        "",
        "16: E1 to E8 start tables 0 to 7; 17: E1 starts the table of E2 to E4",
        "AMK-FIPZ-08",
    ),
    Field::new("sak", 0, 32_767, "1/128 calls", "compensation of the following error", "AMK-FIPZ-09"),
    Field::new("sf_cycle", 0, 32_767, "0.5 ms", "the slot's cycle; 0: not compared", "AMK-FIPZ-10"),
    Field::new("table_count", 1, 8, "", "tables that inputs start", "AMK-FIPZ-11"),
    Field::new("div_exp", 0, 15, "", "the output is divided by 2 to the power of it", "AMK-FIPZ-12"),
    Field::new("mult", 1, 32_767, "", "the output is multiplied by it", "AMK-FIPZ-13"),
    Field::new("cycle_time", 0, 32_767, "0.5 ms", "how long each table lasts; one of 0 is not started", "AMK-FIPZ-14")
        .list(LINES),
];

const TAKES: AllowedTables = AllowedTables { y: 127, xy: 0, length: (0, 0) };

const fn at(name: &'static str) -> usize {
    place(FIELDS, name)
}

/// Mode in which each table has its own input.
const EACH: i64 = 16;

/// State of the function.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(in crate::function) struct Fipz {
    is_coded: bool,
    tables: u8,
    /// Duration of each table, in the parts of a call.
    times: [i64; LINES],
    scale: Scale,
    step: i64,
    /// The table that runs, and its time.
    run: Option<(u8, i64)>,
    near: u32,
    total: Total,
    origin: i64,
    before: u8,
    sak: Sak,
}

impl Fipz {
    /// Returns a function with that set, before its first call.
    fn of(words: Words<'_>, call_ns: u64) -> Self {
        let (parts, step) = check::time(call_ns);
        Self {
            is_coded: words.get(at("mode")) != EACH,
            tables: words.get(at("table_count")) as u8,
            times: std::array::from_fn(|place| words.get(at("cycle_time") + place).saturating_mul(parts)),
            scale: Scale { mult: words.get(at("mult")), div_exp: words.get(at("div_exp")) as u32 },
            step,
            ..Self::default()
        }
    }

    /// Returns the table that an edge starts; `None` if that table does not exist.
    fn chosen(&self, rising: u8, inputs: u8) -> Option<u8> {
        // Most calls have no edge.
        if rising == 0 {
            return None;
        }
        let is_there =
            |table: &u8| *table < self.tables && self.times.get(usize::from(*table)).is_some_and(|time| *time > 0);
        if self.is_coded {
            return (rising & 1 == 1).then_some(inputs >> 1 & 0b111).filter(is_there);
        }
        (0..LINES as u8).filter(|table| rising >> table & 1 == 1).find(is_there)
    }

    fn told(&self, sink: i64, sak_share: i64) -> Outcome {
        Outcome { sink, outputs: self.run.is_none().into(), writes: 1, sak_share, ..Outcome::default() }
    }
}

impl SlotType for Fipz {
    const DESCRIPTION: Description = Description {
        source: Requirement::Never,
        moves_axes: true,
        inputs: 8,
        outputs: 1,
        rests: 1,
        tables: 8,
        shows: OF_SAK,
        example: &[("mode", 16), ("mult", 1), ("table_count", 1), ("cycle_time", 9)],
        ..Description::of(Kind::Fipz, "fipz", "runs through one of several tables by time, as inputs choose", FIELDS)
    };

    fn new(_: &SlotSetup<'_>) -> Self {
        Self::default()
    }

    fn check(&self, words: Words<'_>, setting: &Setting<'_>) -> Result<(), Fault> {
        check_cycle(words.get(at("sf_cycle")), number(FIELDS, "sf_cycle"), setting)?;
        for place in 0..LINES {
            check::check_time(number(FIELDS, "cycle_time"), words.get(at("cycle_time") + place), setting.call_ns)?;
        }
        let scale = Scale { mult: words.get(at("mult")), div_exp: words.get(at("div_exp")) as u32 };
        let count = words.get(at("table_count")) as usize;
        check_tables(setting, count, &TAKES, &Setup { scale, ..Setup::default() })
    }

    fn start(&mut self, words: Words<'_>, seen: &CallInputs<'_>) -> Outcome {
        *self = Self {
            origin: seen.sink,
            before: seen.inputs,
            sak: Sak::new(words.get(at("sak")), seen.sink),
            ..Self::of(words, seen.call_ns)
        };
        self.told(seen.sink, 0)
    }

    fn step(&mut self, seen: &CallInputs<'_>) -> Outcome {
        let rising = seen.inputs & !std::mem::replace(&mut self.before, seen.inputs);
        let mut total = self.total.at_end();
        match self.run {
            None => self.run = self.chosen(rising, seen.inputs).map(|table| (table, 0)),
            Some((table, time)) => {
                let place = usize::from(table);
                let length = self.times.get(place).copied().unwrap_or(0);
                let curve = Curve::new(seen.tables.get(place), length, 1);
                let time = time.saturating_add(self.step);
                self.run = Some((table, time)).filter(|_| time < length);
                if self.run.is_some() {
                    total = self.total.at(curve.at(time, &mut self.near), self.scale);
                } else {
                    self.total.pass(curve.end(), 1, self.scale);
                    (total, self.near) = (self.total.at_end(), 0);
                }
            }
        }
        let y = self.origin.wrapping_add(total);
        let share = self.sak.share(y);
        self.told(y.wrapping_add(share), share)
    }

    fn runs_with(&self, words: Words<'_>, call_ns: u64) -> bool {
        let set = |one: &Self| (one.is_coded, one.tables, one.times, one.scale, one.step);
        set(self) == set(&Self::of(words, call_ns))
    }

    fn is_valid_state(&self) -> bool {
        self.total.is_sound() && self.scale.div_exp < 16
    }
}

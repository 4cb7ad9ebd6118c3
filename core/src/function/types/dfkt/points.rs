//! Tables of speeds: points in rpm at equal distances.
//!
//! Law      form y: each number is a point; form words: DW0 = points + 1, point i from 1 on is the low word of DD 2i,
//!          whose high word is ignored
//! Refuses  form xy, fewer than 2 points or more than 127, points beyond -32767 to 32767, words that end before the
//!          last point
//! Source   AMK-DFKT-23, AMK-DFKT-24, D9

use super::WORD;
use crate::code::Code;
use crate::function::program::{Fault, Setting};
use crate::table::{Form, Table};

/// Allowed number of points.
const COUNT: std::ops::RangeInclusive<usize> = 2..=127;

/// The points of a checked table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Points<'a> {
    numbers: &'a [i64],
    /// Index of the first point, and distance to the next one.
    stride: (usize, usize),
    count: usize,
}

impl<'a> Points<'a> {
    /// Returns the points of a table; `None` for a table of positions, or with too few points.
    #[inline]
    pub(super) fn of(table: &'a Table) -> Option<Self> {
        let (stride, count) = match table.form() {
            Form::Y => ((0, 1), table.len()),
            Form::Words => ((2, 2), usize::from(table.word(0)).saturating_sub(1)),
            Form::Xy => return None,
        };
        COUNT.contains(&count).then_some(Self { numbers: table.y(), stride, count })
    }

    /// Returns point `i` (rpm), counted from 0; 0 after the end.
    #[inline]
    pub(super) fn get(self, i: usize) -> i64 {
        // Points and words are within 16 bits: the cast keeps their bits.
        self.numbers.get(self.stride.0 + i * self.stride.1).map_or(0, |number| i64::from(*number as i16))
    }

    #[inline]
    pub(super) fn first(self) -> i64 {
        self.get(0)
    }

    #[inline]
    pub(super) fn last(self) -> i64 {
        self.get(self.count - 1)
    }

    /// Returns the number of intervals, at least 1.
    #[inline]
    pub(super) fn intervals(self) -> usize {
        self.count - 1
    }
}

/// Returns an error for tables that do not hold speeds, and for a table to write. A missing table is an error only when
/// it is activated.
pub(super) fn check_tables(setting: &Setting<'_>, count: usize) -> Result<(), Fault> {
    if setting.tables.last().is_some_and(Option::is_some) {
        return Err(Fault::new(Code::AMK_OUTPUT_TABLE));
    }
    let tables = setting.tables.iter().take(count).enumerate();
    for (place, table) in tables.filter_map(|(place, table)| Some((place, (*table)?))) {
        check_table(table).map_err(|(code, limit)| Fault::new(code).with(place as i64, limit))?;
    }
    Ok(())
}

fn check_table(table: &Table) -> Result<(), (Code, i64)> {
    // Tables are shorter than 2^17.
    let length = table.len() as i64;
    let Some(points) = Points::of(table) else {
        return Err(match table.form() {
            Form::Y => (Code::AMK_CURVE_POINTS, length),
            Form::Words => (Code::AMK_SPEED_POINTS, table.word(0).into()),
            Form::Xy => (Code::AMK_CURVE_FORM, 0),
        });
    };
    if table.form() == Form::Words && table.len() <= 2 * points.count {
        return Err((Code::AMK_SPEED_WORDS, length));
    }
    let is_beyond = |i: &usize| match table.form() {
        // Words that are given as unsigned count as signed.
        Form::Words => points.get(*i) < -WORD,
        _ => table.y().get(*i).is_none_or(|point| !(-WORD..=WORD).contains(point)),
    };
    // Points are counted from 1, as in the source.
    (0..points.count).find(is_beyond).map_or(Ok(()), |i| Err((Code::AMK_SPEED_POINT, i as i64 + 1)))
}

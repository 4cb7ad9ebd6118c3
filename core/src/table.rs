//! Tables: numbers for functions and cams, created outside the cycle and passed by pointer.
//!
//! Law      a table never changes: a new one replaces it as a whole
//! Refuses  lists of different lengths, words beyond 16 bits, points beyond 32 bits, more numbers than [`MAX_NUMBERS`]
//! Source   contract section 10, AMK-INIT-09

mod cam;
mod pitch;
mod shape;

pub use cam::{CamError, CamSetting, CamShape, Interpolation, MAX_LENGTH, MAX_VALUE};
pub use pitch::{MAX_SLOPE_DIVISOR, PitchError};
pub use shape::{CurveError, CurveShape};

use crate::law::Spline;
use serde::{Deserialize, Serialize};

/// Maximum points or words of one table.
pub const MAX_NUMBERS: usize = 1_000_000;

/// Meaning of the numbers of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Form {
    /// Values at equal distances of the master.
    Y,
    /// Values, each with its position of the master.
    Xy,
    /// 16-bit words of a data block, in its order.
    Words,
}

impl Form {
    /// All forms with their names.
    pub const ALL: [(Form, &'static str); 3] = [(Form::Y, "y"), (Form::Xy, "xy"), (Form::Words, "words")];

    /// Returns the name in cells and in the interface.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(form, _)| *form == self).map_or("", |(_, name)| name)
    }
}

/// Error of numbers that form no table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TableError {
    /// No numbers, or too many.
    #[error("a table has {0} numbers; 1 to {MAX_NUMBERS} are possible")]
    Count(usize),
    /// Two lists of different lengths.
    #[error("a table of form xy has {x} places and {y} values; as many of both are needed")]
    Lengths {
        /// Number of positions of the master.
        x: usize,
        /// Number of values.
        y: usize,
    },
    /// Positions that the form does not use.
    #[error("a table of form {} has {count} places in x; it takes none", form.name())]
    Places {
        /// Form of the table.
        form: Form,
        /// Number of positions.
        count: usize,
    },
    /// A word beyond 16 bits.
    #[error("word {place} is {value}; -32768 to 65535 is possible")]
    Word {
        /// Index, from 0.
        place: usize,
        /// Its value.
        value: i64,
    },
    /// A number of a point beyond 32 bits.
    #[error("{list}[{place}] is {value}; {} to {} is possible", i32::MIN, i32::MAX)]
    Wide {
        /// `x` or `y`.
        list: &'static str,
        /// Index, from 0.
        place: usize,
        /// Its value.
        value: i64,
    },
}

/// A table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Numbers")]
pub struct Table {
    form: Form,
    x: Box<[i64]>,
    y: Box<[i64]>,
    #[serde(skip_serializing)]
    shape: Result<CurveShape, CurveError>,
    setting: CamSetting,
    #[serde(skip_serializing)]
    cam: Result<CamShape, CamError>,
    #[serde(skip_serializing)]
    pitch: Result<(), PitchError>,
    /// Spline between the points of a cam.
    #[serde(skip_serializing)]
    spline: Option<Spline>,
}

/// A table as it is stored; derived values are computed again.
#[derive(Deserialize)]
struct Numbers {
    form: Form,
    x: Box<[i64]>,
    y: Box<[i64]>,
    setting: CamSetting,
}

impl TryFrom<Numbers> for Table {
    type Error = TableError;

    fn try_from(Numbers { form, x, y, setting }: Numbers) -> Result<Self, TableError> {
        Self::new(form, &x, &y).map(|table| table.with_cam(setting))
    }
}

/// Returns the index, from 0, of the first position that does not exceed the previous one, and the message of the cell
/// and of requests.
pub fn first_non_rising(x: &[i64]) -> Option<(usize, String)> {
    let mut pairs = x.iter().zip(x.iter().skip(1)).zip(1..);
    let ((before, place), number) = pairs.find(|((before, place), _)| before >= place)?;
    Some((number, format!("place {place} is not after {before}, the one before it; places rise")))
}

impl Table {
    /// Creates a table of numbers; `x` is empty except for form xy.
    ///
    /// # Errors
    /// The first problem of the numbers.
    pub fn new(form: Form, x: &[i64], y: &[i64]) -> Result<Self, TableError> {
        if y.is_empty() || y.len() > MAX_NUMBERS {
            return Err(TableError::Count(y.len()));
        }
        match form {
            Form::Xy if x.len() != y.len() => return Err(TableError::Lengths { x: x.len(), y: y.len() }),
            Form::Y | Form::Words if !x.is_empty() => return Err(TableError::Places { form, count: x.len() }),
            _ => {}
        }
        let is_word = |value: &i64| (i64::from(i16::MIN)..=u16::MAX.into()).contains(value);
        if form == Form::Words
            && let Some(place) = y.iter().position(|value| !is_word(value))
        {
            return Err(TableError::Word { place, value: y.get(place).copied().unwrap_or_default() });
        }
        for (list, numbers) in [("x", x), ("y", y)] {
            if let Some((place, &value)) = numbers.iter().enumerate().find(|(_, value)| i32::try_from(**value).is_err())
            {
                return Err(TableError::Wide { list, place, value });
            }
        }
        let (shape, setting) = (CurveShape::of(form, x, y), CamSetting::default());
        let cam = CamShape::of(form, x, y, setting);
        let pitch = pitch::check(form, x, y);
        Ok(Self { form, x: x.into(), y: y.into(), shape, setting, cam, pitch, spline: None })
    }

    /// Returns the same numbers with their settings as a cam.
    #[must_use]
    pub fn with_cam(mut self, setting: CamSetting) -> Self {
        let (x, y) = (&self.x, &self.y);
        let cam = CamShape::of(self.form, x, y, setting);
        let spline = cam.and_then(|shape| setting.interpolation.spline(x, y, shape));
        self.cam = spline.as_ref().map_err(|error| *error).and(cam);
        (self.setting, self.spline) = (setting, spline.unwrap_or(None));
        self
    }

    /// Returns the meaning of its numbers.
    pub fn form(&self) -> Form {
        self.form
    }

    /// Returns the positions of the master; empty except for form xy.
    pub fn x(&self) -> &[i64] {
        &self.x
    }

    /// Returns the values, or the words as they were given.
    pub fn y(&self) -> &[i64] {
        &self.y
    }

    /// Returns the number of values or words.
    pub fn len(&self) -> usize {
        self.y.len()
    }

    /// Returns false: a table has numbers.
    pub fn is_empty(&self) -> bool {
        self.y.is_empty()
    }

    /// Returns DW of a data block, unsigned; 0 after its end.
    #[inline]
    pub fn word(&self, place: usize) -> u16 {
        // Words are within 16 bits: the cast keeps their bits.
        self.y.get(place).map_or(0, |word| *word as u16)
    }

    /// Returns DD of a data block, low word first; 0 after its end.
    #[inline]
    pub fn double(&self, place: usize) -> i32 {
        double(self.word(place).into(), self.word(place.saturating_add(1)).into())
    }

    /// Returns its points as a curve.
    ///
    /// # Errors
    /// The problem of the points.
    pub fn shape(&self) -> Result<CurveShape, CurveError> {
        self.shape
    }

    /// Returns its settings as a cam.
    pub fn cam_setting(&self) -> CamSetting {
        self.setting
    }

    /// Returns its points as a cam.
    ///
    /// # Errors
    /// The problem of the points.
    #[inline]
    pub fn cam(&self) -> Result<CamShape, CamError> {
        self.cam
    }

    /// Returns the spline between the points of a cam; `None` for straight lines.
    #[inline]
    pub fn spline(&self) -> Option<&Spline> {
        self.spline.as_ref()
    }
}

/// Returns the interval that begins at the last passed point, of those up to `last`; point 0 counts as passed. While a
/// master runs it is the one at `near` or next to it; after a jump it is searched, which takes the same few steps for
/// any interval.
#[inline]
pub(crate) fn interval(near: usize, last: usize, passed: impl Fn(usize) -> bool) -> usize {
    let near = near.min(last);
    let is_in = |i: usize| (i == 0 || passed(i)) && (i >= last || !passed(i + 1));
    if is_in(near) {
        return near;
    }
    if near < last && is_in(near + 1) {
        return near + 1;
    }
    let (mut low, mut high) = (0, last);
    while low < high {
        let middle = high - (high - low) / 2;
        if passed(middle) { low = middle } else { high = middle - 1 }
    }
    low
}

/// Returns the DD of two words, low word first.
#[inline]
pub(crate) fn double(low: i64, high: i64) -> i32 {
    // Words are within 16 bits: the casts keep their bits.
    (u32::from(low as u16) | u32::from(high as u16) << 16).cast_signed()
}

/// Shared tables for serde.
pub(crate) mod shared {
    use super::Table;
    use serde::{Deserialize, Deserializer, Serializer};
    use std::sync::Arc;

    pub(crate) fn serialize<S: Serializer>(tables: &[Arc<Table>], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(tables.iter().map(|table| &**table))
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Arc<Table>>, D::Error> {
        Ok(Vec::<Table>::deserialize(deserializer)?.into_iter().map(Arc::new).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_read_as_a_data_block() {
        let table = Table::new(Form::Words, &[], &[-1, 65_535, 0x1234, 1]).unwrap();
        assert_eq!((table.word(0), table.word(1), table.word(9)), (0xFFFF, 0xFFFF, 0));
        assert_eq!((table.double(0), table.double(2), table.double(3)), (-1, 0x1_1234, 1));
    }

    #[test]
    fn invalid_table_is_refused_with_number() {
        let refused = |form, x: &[i64], y: &[i64]| Table::new(form, x, y).unwrap_err().to_string();
        assert_eq!(refused(Form::Words, &[], &[0, 65_536]), "word 1 is 65536; -32768 to 65535 is possible");
        assert_eq!(refused(Form::Y, &[], &[]), "a table has 0 numbers; 1 to 1000000 are possible");
        assert_eq!(refused(Form::Y, &[1], &[1]), "a table of form y has 1 places in x; it takes none");
        assert!(refused(Form::Xy, &[1], &[1, 2]).contains("1 places and 2 values"));
        let wide = "x[1] is 2147483648; -2147483648 to 2147483647 is possible";
        assert_eq!(refused(Form::Xy, &[0, 1 << 31], &[0, 0]), wide);
        assert!(refused(Form::Y, &[], &[0, i64::MIN]).starts_with("y[1] is -9223372036854775808;"));
    }

    #[test]
    fn an_interval_is_found_in_few_steps_wherever_it_is() {
        let places: Vec<i64> = (0..1_000_000).map(|i| 3 * i).collect();
        for (near, x) in
            [(0, 0), (0, 2_999_996), (999_998, 0), (17, 52), (17, 53), (17, 54), (500_000, 17), (usize::MAX, 1_499_999)]
        {
            let steps = std::cell::Cell::new(0);
            let passed = |i: usize| {
                steps.set(steps.get() + 1);
                places[i] <= x
            };
            assert_eq!(interval(near, 999_998, passed), (x / 3).min(999_998) as usize, "{near} {x}");
            assert!(steps.get() <= 24, "{near} {x}: {} steps", steps.get());
        }
    }

    #[test]
    fn a_million_points_are_a_table_and_one_more_is_none() {
        let y: Vec<i64> = (0..1_000_001).map(|place| place % 3).collect();
        assert_eq!(Table::new(Form::Y, &[], &y[..1_000_000]).map(|table| table.len()), Ok(1_000_000));
        let sentence = Table::new(Form::Y, &[], &y).unwrap_err().to_string();
        assert_eq!(sentence, "a table has 1000001 numbers; 1 to 1000000 are possible");
    }

    /// Derived values are not stored but computed again; numbers that form no table cannot be restored.
    #[test]
    fn a_table_that_was_kept_is_the_same_again() {
        let setting = CamSetting { length: Some(90), interpolation: Interpolation::Quintic, ..CamSetting::default() };
        let table = Table::new(Form::Y, &[], &[0, 40, 10, 0]).unwrap().with_cam(setting);
        let bytes = postcard::to_stdvec(&table).unwrap();
        assert_eq!(postcard::from_bytes::<Table>(&bytes), Ok(table));
        // A form, no positions, four values of a byte each and their number, length, cyclic flag, interpolation: no
        // coefficients.
        assert!(bytes.len() < 16, "{} bytes", bytes.len());
        let none = postcard::to_stdvec(&(Form::Y, [0_i64; 0].as_slice(), [0_i64; 0].as_slice(), setting)).unwrap();
        assert!(postcard::from_bytes::<Table>(&none).is_err());
    }
}

//! Fields of parameter sets. The keys of cells, the checks, the ROS parameters and the documentation are generated from
//! their rows.

use crate::unit::{Quantity, Unit, parse_decimal};
use num_traits::{CheckedDiv, ToPrimitive};

/// One field of the parameter set of a function type.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Name in the spec.
    pub name: &'static str,
    /// Number of values: 1, or the length of the list in the spec.
    pub count: usize,
    /// Minimum.
    pub min: i64,
    /// Maximum.
    pub max: i64,
    /// Default; a default outside the range means that the value must be given before START.
    pub default: i64,
    /// Unit of the value, such as `0.1 N`; empty without one.
    pub unit: &'static str,
    /// Whether VALUE_NEW changes it; otherwise it takes effect at the next START.
    pub live: bool,
    /// Description.
    pub help: &'static str,
    /// Requirement of the spec.
    pub source: &'static str,
    /// Reason why the function has no effect with the default.
    pub idle: Option<&'static str>,
    /// Limit that depends on the cell.
    pub(super) bound: Option<CellBound>,
}

/// Property of the cell that limits a field.
#[derive(Clone, Copy, Debug)]
pub(super) enum CellBound {
    /// A mask of axes, all of which must exist.
    AxisMask,
    /// The number of an existing axis; 0: none.
    AxisNumber,
    /// Full scale of the analog output that is the sink; applies only if the set has this bit of `mode`.
    FullScale(i64),
}

impl Field {
    /// Returns a field of one value within a range, which takes effect at the next START.
    pub(super) const fn new(
        name: &'static str,
        min: i64,
        max: i64,
        unit: &'static str,
        help: &'static str,
        source: &'static str,
    ) -> Self {
        Self { name, count: 1, min, max, default: 0, unit, live: false, help, source, idle: None, bound: None }
    }

    /// Returns the field as a list of `count` values.
    pub(super) const fn list(self, count: usize) -> Self {
        Self { count, ..self }
    }

    /// Returns the field as one that VALUE_NEW changes.
    pub(super) const fn live(self) -> Self {
        Self { live: true, ..self }
    }

    /// Returns the field with another default than 0.
    pub(super) const fn or(self, default: i64) -> Self {
        Self { default, ..self }
    }

    /// Returns the field as one whose default has no effect, for this reason.
    pub(super) const fn idle(self, reason: &'static str) -> Self {
        Self { idle: Some(reason), ..self }
    }

    /// Returns the field as one that the cell limits.
    pub(super) const fn within(self, bound: CellBound) -> Self {
        Self { bound: Some(bound), ..self }
    }

    /// Returns one of its unit; `None` without a physical unit.
    pub fn one(&self) -> Option<Quantity> {
        let (number, unit) = self.unit.split_once(' ').unwrap_or(("1", self.unit));
        Some(Quantity::new(parse_decimal(number).ok()?, Unit::parse(unit)?))
    }

    /// Converts a quantity such as `12.5 N` to a number in its unit. Returns `None` for any other text, another
    /// dimension, and a quantity that is no multiple of the unit.
    pub fn convert(&self, text: &str) -> Option<i64> {
        let one = self.one()?;
        let quantity = Quantity::parse(text, &[one.unit().dimension()]).ok()?;
        let has_unit = text.trim().contains([' ', '\t']);
        let multiple = quantity.exact()?.checked_div(&one.exact()?)?;
        if has_unit && multiple.is_integer() { multiple.to_integer().to_i64() } else { None }
    }

    /// Returns true if the full scale of an analog output limits it.
    pub(crate) fn is_within_full_scale(&self) -> bool {
        matches!(self.bound, Some(CellBound::FullScale(_)))
    }
}

/// Returns true if VALUE_NEW changes a field.
pub(super) const fn has_live(fields: &[Field]) -> bool {
    let mut field = 0;
    while field < fields.len() {
        if fields[field].live {
            return true;
        }
        field += 1;
    }
    false
}

/// Returns the number of values of a set.
pub(super) const fn width(fields: &[Field]) -> usize {
    let (mut place, mut field) = (0, 0);
    while field < fields.len() {
        place += fields[field].count;
        field += 1;
    }
    place
}

/// Returns the index of the first value of a field in its set; an unknown name does not compile.
pub(super) const fn place(fields: &[Field], name: &str) -> usize {
    let (mut place, mut field) = (0, 0);
    while field < fields.len() {
        if is_same(fields[field].name, name) {
            return place;
        }
        place += fields[field].count;
        field += 1;
    }
    panic!("no field has that name")
}

/// Returns the number of a field, counted from 0; an unknown name does not compile.
pub(super) const fn number(fields: &[Field], name: &str) -> u16 {
    let mut field = 0;
    while field < fields.len() {
        if is_same(fields[field].name, name) {
            return field as u16;
        }
        field += 1;
    }
    panic!("no field has that name")
}

const fn is_same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut place = 0;
    while place < a.len() && place < b.len() && a[place] == b[place] {
        place += 1;
    }
    place == a.len() && place == b.len()
}

/// The values of a set, in the order of its fields.
#[derive(Clone, Copy, Debug)]
pub(super) struct Words<'a>(pub &'a [i64]);

impl Words<'_> {
    /// Returns a value by its index; 0 after the end.
    #[inline]
    pub(super) fn get(self, place: usize) -> i64 {
        self.0.get(place).copied().unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn of(unit: &'static str) -> Field {
        Field::new("field", 0, 1000, unit, "", "")
    }

    #[test]
    fn quantity_is_a_multiple_of_the_unit_of_its_field() {
        assert_eq!(of("0.1 N").convert("12.5 N"), Some(125));
        assert_eq!(of("mm/s").convert("0.25 m/s"), Some(250));
        assert_eq!(of("0.0001 rpm").convert("-1000 rpm"), Some(-10_000_000));
        assert_eq!(of("0.5 ms").convert("0.002 s"), Some(4));
        assert_eq!(of("Nm").convert("3 Nm"), Some(3));
    }

    #[test]
    fn other_texts_are_no_quantity_of_a_field() {
        for (unit, text) in [("0.1 N", "12"), ("0.1 N", "0.05 N"), ("0.1 N", "1 Nm"), ("bits", "1 bits"), ("", "1 mm")]
        {
            assert_eq!(of(unit).convert(text), None, "{text} in {unit}");
        }
    }
}

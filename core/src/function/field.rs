//! Fields of a parameter set: one row each, of which the keys of cells, checks, ROS parameters and the pages are made.

/// One field of a type's parameter set.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Its name in the spec.
    pub name: &'static str,
    /// How many values it has: 1, or as many as the list of the spec.
    pub count: usize,
    /// Least value.
    pub min: i64,
    /// Largest value.
    pub max: i64,
    /// Where it is left out; beyond the range where it must be given before START.
    pub default: i64,
    /// Unit of the value; empty without one.
    pub unit: &'static str,
    /// VALUE_NEW changes it; else it counts from the next START on.
    pub live: bool,
    /// What it is.
    pub help: &'static str,
    /// Requirement it stems from.
    pub source: &'static str,
}

impl Field {
    /// A field of one value within a range, which counts from START on.
    pub(super) const fn new(
        name: &'static str,
        min: i64,
        max: i64,
        unit: &'static str,
        help: &'static str,
        source: &'static str,
    ) -> Self {
        Self { name, count: 1, min, max, default: 0, unit, live: false, help, source }
    }

    /// The same as a list.
    pub(super) const fn list(self, count: usize) -> Self {
        Self { count, ..self }
    }

    /// The same where VALUE_NEW changes it.
    pub(super) const fn live(self) -> Self {
        Self { live: true, ..self }
    }

    /// The same with another default than 0.
    pub(super) const fn or(self, default: i64) -> Self {
        Self { default, ..self }
    }
}

/// How many values a set has.
pub(super) const fn width(fields: &[Field]) -> usize {
    let (mut place, mut field) = (0, 0);
    while field < fields.len() {
        place += fields[field].count;
        field += 1;
    }
    place
}

/// Where the values of a field begin in its set; a name that no field has does not compile.
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

/// Which field a name is, counted from 0; a name that no field has does not compile.
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
    /// A value by its place; 0 behind the end.
    #[inline]
    pub(super) fn get(self, place: usize) -> i64 {
        self.0.get(place).copied().unwrap_or(0)
    }
}

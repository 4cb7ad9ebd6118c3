//! Handles of the objects of a cell; they are fixed by the cell.

use serde::{Deserialize, Serialize};

/// Maximum number of axes of one machine.
pub const MAX_AXES: usize = 512;

/// An object of a cell by its index in its section, in file order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
pub enum Object {
    /// The machine as a whole.
    Machine,
    /// An entry of `io`.
    Io(u16),
    /// An entry of `memory`.
    Memory(u16),
    /// An entry of `encoders`.
    Encoder(u16),
    /// An entry of `axes`.
    Axis(u16),
    /// An entry of `functions`, by its index among the slots.
    Function(u16),
    /// An entry of `tables`.
    Table(u16),
    /// An entry of `programs`.
    Program(u16),
}

impl Object {
    /// Number of objects per section, in the numbers of events.
    const SECTION: i64 = 1 << 16;

    /// Returns the number of an input, encoder or axis in an event; -1 for other objects.
    pub(crate) fn to_number(self) -> i64 {
        match self {
            Self::Io(index) => index.into(),
            Self::Encoder(index) => Self::SECTION + i64::from(index),
            Self::Axis(index) => 2 * Self::SECTION + i64::from(index),
            Self::Machine | Self::Memory(_) | Self::Function(_) | Self::Table(_) | Self::Program(_) => -1,
        }
    }

    /// Returns the object of such a number.
    pub(crate) fn from_number(number: i64) -> Option<Self> {
        // The remainder is within 16 bits.
        let index = number.rem_euclid(Self::SECTION) as u16;
        match number.div_euclid(Self::SECTION) {
            0 => Some(Self::Io(index)),
            1 => Some(Self::Encoder(index)),
            2 => Some(Self::Axis(index)),
            _ => None,
        }
    }
}

/// Name of [`Leader::Virtual`]; no object has the name `machine`.
pub const VIRTUAL_MASTER: &str = "machine.vmaster";

/// A leader that an axis can follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Leader {
    /// The command position of an axis (`line`, `line.command`).
    AxisCommand(u16),
    /// The actual position of an axis (`x.actual`).
    AxisActual(u16),
    /// An encoder (`belt`).
    Encoder(u16),
    /// The simulated master of an axis, selected by its `mencodertype` 6.
    Simulated(u16),
    /// The sink of a function (`ratio.sink`), by its index among the slots.
    Sink(u16),
    /// An entry of `masters`: a sum of other leaders.
    Sum(u16),
    /// The virtual master of the machine (`machine.vmaster`).
    Virtual,
}

/// A set of axes, without heap memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AxisSet([u64; MAX_AXES / 64]);

impl AxisSet {
    /// The empty set.
    pub const EMPTY: Self = Self([0; MAX_AXES / 64]);

    /// Returns a set of one axis.
    pub fn one(axis: u16) -> Self {
        let mut set = Self::EMPTY;
        set.insert(axis);
        set
    }

    /// Returns the first `count` axes.
    pub fn first(count: usize) -> Self {
        (0..count.min(MAX_AXES)).map(|axis| axis as u16).collect()
    }

    /// Adds an axis; has no effect beyond [`MAX_AXES`], because no machine has such an axis.
    pub fn insert(&mut self, axis: u16) {
        if let Some(word) = self.0.get_mut(usize::from(axis) / 64) {
            *word |= 1 << (axis % 64);
        }
    }

    /// Removes and returns the first axis.
    pub fn pop(&mut self) -> Option<u16> {
        let place = self.0.iter().position(|word| *word != 0)?;
        let word = self.0.get_mut(place)?;
        let bit = word.trailing_zeros();
        *word &= *word - 1;
        Some((place * 64) as u16 + bit as u16)
    }

    /// Returns the union of both sets.
    pub fn union(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|word| self.word(word) | other.word(word)))
    }

    /// Returns the axes that are not in the other set.
    pub fn difference(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|word| self.word(word) & !other.word(word)))
    }

    fn word(&self, place: usize) -> u64 {
        self.0.get(place).copied().unwrap_or_default()
    }

    /// Returns true if the axis is in the set.
    pub fn contains(&self, axis: u16) -> bool {
        self.0.get(usize::from(axis) / 64).is_some_and(|word| word >> (axis % 64) & 1 == 1)
    }

    /// Returns the axes in ascending order.
    pub fn iter(&self) -> impl Iterator<Item = u16> + '_ {
        (0..MAX_AXES as u16).filter(|&axis| self.contains(axis))
    }

    /// Returns the number of axes.
    pub fn len(&self) -> usize {
        self.0.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Returns true without any axis.
    pub fn is_empty(&self) -> bool {
        self.0 == [0; MAX_AXES / 64]
    }
}

impl FromIterator<u16> for AxisSet {
    fn from_iter<I: IntoIterator<Item = u16>>(axes: I) -> Self {
        let mut set = Self::EMPTY;
        axes.into_iter().for_each(|axis| set.insert(axis));
        set
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn latching_objects_have_unique_numbers() {
        for object in [Object::Io(0), Object::Io(u16::MAX), Object::Encoder(0), Object::Axis(7), Object::Axis(u16::MAX)]
        {
            assert_eq!(Object::from_number(object.to_number()), Some(object));
        }
        assert_eq!([-1, 3 << 16, i64::MIN, i64::MAX].map(Object::from_number), [None; 4]);
        assert_eq!(Object::from_number(Object::Machine.to_number()), None);
    }

    #[test]
    fn a_set_holds_what_was_put_in() {
        let set: AxisSet = [0, 63, 64, 511].into_iter().collect();
        assert_eq!(set.iter().collect::<Vec<_>>(), [0, 63, 64, 511]);
        assert_eq!((set.len(), set.contains(1), set.contains(600)), (4, false, false));
        assert_eq!(AxisSet::first(600).len(), MAX_AXES);
        let (low, other) = (AxisSet::first(64), AxisSet::one(511));
        assert_eq!(set.difference(&low).iter().collect::<Vec<_>>(), [64, 511]);
        assert_eq!(set.union(&AxisSet::one(7)).difference(&other).iter().collect::<Vec<_>>(), [0, 7, 63, 64]);
        let mut rest = set;
        assert_eq!(std::iter::from_fn(|| rest.pop()).collect::<Vec<_>>(), [0, 63, 64, 511]);
        assert!(rest.is_empty());
    }
}

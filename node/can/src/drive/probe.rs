//! Touch probes of a drive: what they catch, and what of it is new.
//!
//! Law      a probe catches without end (60B8h, continuous); the drive counts what it has caught. A count that has grown is a new position,
//!          the last one; those before it are counted as lost
//! Reads    60BAh to 60BDh, 60D5h to 60D8h
//! Source   CiA 402-2, touch probe functionality

use super::objects;
use crate::sdo::Object;
use lineshaft_core::drive::Edge;

/// What a probe catches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Probe {
    /// Rising edges of its input.
    Rising,
    /// Falling edges of its input.
    Falling,
    /// Both.
    Both,
    /// The zero pulse of the encoder.
    Index,
}

/// Both probes of a drive.
pub type Probes = [Option<Probe>; 2];

/// A place for what is caught: probe 1 rising and falling, probe 2 rising and falling.
pub type Slot = u8;

impl Probe {
    /// Bits of 60B8h, of probe 1: enabled, continuous, zero pulse, rising, falling.
    fn bits(self) -> u16 {
        match self {
            Self::Rising => 0x13,
            Self::Falling => 0x23,
            Self::Both => 0x33,
            Self::Index => 0x17,
        }
    }
}

/// The word for 60B8h.
pub fn function(probes: Probes) -> u16 {
    let bits = probes.map(|probe| probe.map_or(0, Probe::bits));
    bits[0] | bits[1] << 8
}

/// The slots that probes fill.
pub fn slots(probes: Probes) -> impl Iterator<Item = Slot> {
    let fills = [0x10, 0x20, 0x1000, 0x2000].map(|bit| function(probes) & bit != 0);
    (0..4).filter(move |slot| fills[usize::from(*slot)])
}

/// The position that is caught in a slot, and the count of what was.
pub fn objects_of(slot: Slot) -> [Object; 2] {
    let slot = u16::from(slot.min(3));
    [objects::TOUCH_PROBE_POSITION, objects::TOUCH_PROBE_COUNT]
        .map(|first| Object { index: first.index + slot, ..first })
}

/// What a slot means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Caught {
    /// The zero pulse.
    Index,
    /// An edge.
    Edge(Edge),
}

/// The meaning of a slot.
pub fn meaning(probes: Probes, slot: Slot) -> Caught {
    let edge = if slot.is_multiple_of(2) { Edge::Rising } else { Edge::Falling };
    match probes.get(usize::from(slot / 2)) {
        Some(Some(Probe::Index)) => Caught::Index,
        _ => Caught::Edge(edge),
    }
}

/// What has come of a slot.
#[derive(Clone, Copy, Debug, Default)]
pub struct Catch {
    count: Option<u16>,
    /// New ones since they were taken.
    new: u16,
    position: i32,
}

impl Catch {
    /// A word of the drive came.
    pub fn take(&mut self, position: i32, count: u16) {
        // What was caught before anybody looked is nobody's.
        let new = self.count.replace(count).map_or(0, |before| count.wrapping_sub(before));
        self.new = self.new.saturating_add(new);
        self.position = position;
    }

    /// The last position that is new, and how many before it were lost.
    pub fn drain(&mut self) -> Option<(i32, u16)> {
        let new = std::mem::take(&mut self.new);
        new.checked_sub(1).map(|lost| (self.position, lost))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bits of CiA 402: 0 enable, 1 continuous, 2 zero pulse, 4 rising, 5 falling; those of probe 2 are 8 higher.
    #[test]
    fn the_function_says_what_is_caught() {
        assert_eq!(function([Some(Probe::Both), None]), 0x0033);
        assert_eq!(function([Some(Probe::Rising), Some(Probe::Index)]), 0x1713);
        assert_eq!(slots([Some(Probe::Falling), Some(Probe::Index)]).collect::<Vec<_>>(), [1, 2]);
        let indices = |slot| objects_of(slot).map(|object| object.index);
        assert_eq!([indices(0), indices(3)], [[0x60BA, 0x60D5], [0x60BD, 0x60D8]]);
        let probes = [Some(Probe::Falling), Some(Probe::Index)];
        assert_eq!((meaning(probes, 1), meaning(probes, 2)), (Caught::Edge(Edge::Falling), Caught::Index));
    }

    #[test]
    fn what_is_new_is_told_once_and_what_was_between_is_lost() {
        let mut caught = Catch::default();
        caught.take(5, 65_534);
        assert_eq!(caught.drain(), None, "caught before");
        caught.take(5, 65_535);
        assert_eq!((caught.drain(), caught.drain()), (Some((5, 0)), None));
        caught.take(-9, 2);
        assert_eq!(caught.drain(), Some((-9, 2)), "the count wraps");
    }
}

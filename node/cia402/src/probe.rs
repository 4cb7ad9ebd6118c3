//! Touch probes of a drive: captured edges and positions.
//!
//! Law      a probe captures continuously (60B8h), and the drive counts the captures. A count that has increased reports a new position,
//!          that of the last capture; the captures before it are counted as lost
//! Reads    60BAh to 60BDh, 60D5h to 60D8h
//! Source   CiA 402-2, touch probe functionality

use crate::object::Object;
use crate::objects;
use lineshaft_core::drive::Edge;

/// Source that triggers a probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Probe {
    /// Rising edges of its input.
    Rising,
    /// Falling edges of its input.
    Falling,
    /// Both edges of its input.
    Both,
    /// The zero pulse of the encoder.
    Index,
}

/// Configuration of both probes of a drive.
pub type Probes = [Option<Probe>; 2];

/// Place of a captured value: 0 and 1 are probe 1 rising and falling, 2 and 3 are probe 2 rising and falling.
pub type Slot = u8;

impl Probe {
    /// Returns the bits of 60B8h for probe 1: enabled, continuous, zero pulse, rising, falling.
    fn bits(self) -> u16 {
        match self {
            Self::Rising => 0x13,
            Self::Falling => 0x23,
            Self::Both => 0x33,
            Self::Index => 0x17,
        }
    }
}

/// Returns the value of 60B8h.
pub fn function(probes: Probes) -> u16 {
    let bits = probes.map(|probe| probe.map_or(0, Probe::bits));
    bits[0] | bits[1] << 8
}

/// Returns the slots that the probes use.
pub fn slots(probes: Probes) -> impl Iterator<Item = Slot> {
    let fills = [0x10, 0x20, 0x1000, 0x2000].map(|bit| function(probes) & bit != 0);
    (0..4).filter(move |slot| fills[usize::from(*slot)])
}

/// Returns the objects of a slot: captured position and number of captures.
pub fn objects_of(slot: Slot) -> [Object; 2] {
    let slot = u16::from(slot.min(3));
    [objects::TOUCH_PROBE_POSITION, objects::TOUCH_PROBE_COUNT]
        .map(|first| Object { index: first.index + slot, ..first })
}

/// Meaning of a slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlotMeaning {
    /// Zero pulse of the encoder.
    Index,
    /// Edge of the probe input.
    Edge(Edge),
}

/// Returns the meaning of a slot.
pub fn meaning(probes: Probes, slot: Slot) -> SlotMeaning {
    let edge = if slot.is_multiple_of(2) { Edge::Rising } else { Edge::Falling };
    match probes.get(usize::from(slot / 2)) {
        Some(Some(Probe::Index)) => SlotMeaning::Index,
        _ => SlotMeaning::Edge(edge),
    }
}

/// Captures of a slot.
#[derive(Clone, Copy, Debug, Default)]
pub struct CaptureCounter {
    count: Option<u16>,
    /// Number of captures since the last [`drain`](Self::drain).
    new: u16,
    position: i32,
}

impl CaptureCounter {
    /// Updates the slot with position and count of the drive.
    pub fn update(&mut self, position: i32, count: u16) {
        // Captures before the first update are ignored.
        let new = self.count.replace(count).map_or(0, |before| count.wrapping_sub(before));
        self.new = self.new.saturating_add(new);
        self.position = position;
    }

    /// Returns the last new position and the number of captures before it that were lost.
    pub fn drain(&mut self) -> Option<(i32, u16)> {
        let new = std::mem::take(&mut self.new);
        new.checked_sub(1).map(|lost| (self.position, lost))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bits of CiA 402: 0 enable, 1 continuous, 2 zero pulse, 4 rising, 5 falling; those of probe 2 are 8 higher.
    #[test]
    fn touch_probe_function_has_bits_of_cia_402() {
        assert_eq!(function([Some(Probe::Both), None]), 0x0033);
        assert_eq!(function([Some(Probe::Rising), Some(Probe::Index)]), 0x1713);
        assert_eq!(slots([Some(Probe::Falling), Some(Probe::Index)]).collect::<Vec<_>>(), [1, 2]);
        let indices = |slot| objects_of(slot).map(|object| object.index);
        assert_eq!([indices(0), indices(3)], [[0x60BA, 0x60D5], [0x60BD, 0x60D8]]);
        let probes = [Some(Probe::Falling), Some(Probe::Index)];
        assert_eq!((meaning(probes, 1), meaning(probes, 2)), (SlotMeaning::Edge(Edge::Falling), SlotMeaning::Index));
    }

    #[test]
    fn new_capture_is_reported_once_and_missed_ones_are_counted() {
        let mut caught = CaptureCounter::default();
        caught.update(5, 65_534);
        assert_eq!(caught.drain(), None, "caught before");
        caught.update(5, 65_535);
        assert_eq!((caught.drain(), caught.drain()), (Some((5, 0)), None));
        caught.update(-9, 2);
        assert_eq!(caught.drain(), Some((-9, 2)), "the count wraps");
    }
}

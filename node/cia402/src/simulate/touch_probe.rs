//! Touch probes of a simulated drive.
//!
//! Law      an edge of a probe input stores the position of its cycle, the zero pulse stores its own position. Bits of 60B8h for each
//!          probe: 0 enabled, 1 continuous (otherwise only the first event), 2 and 3 the source, 4 rising edge, 5 falling edge. The zero
//!          pulse is a rising edge
//! Reads    60B8h, the levels of the inputs in 2000h (bit 0: probe 1, bit 1: probe 2), the zero pulse of the encoder
//! Writes   60B9h, 60BAh to 60BDh, 60D5h to 60D8h
//! Refuses  sources of 60D0h: they store nothing
//! Source   CiA 402-2, touch probe functionality

use super::objects as simulated;
use super::table::ObjectTable;
use crate::{objects, probe};
use lineshaft_core::drive::DriveInput;

const ENABLED: u32 = 0x01;
const CONTINUOUS: u32 = 0x02;
/// Bits 2 and 3: source, the input of the probe or the zero pulse.
const SOURCE: u32 = 0x0C;
const ZERO_PULSE: u32 = 0x04;
/// Rising edge; the bit of the falling edge follows.
const EDGE: u32 = 0x10;
/// Bit of 60B9h: position of a rising edge is stored; the bit of the falling edge follows.
const STORED: u32 = 0x02;

/// Both touch probes of a drive.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TouchProbes {
    /// Levels of the inputs in the last cycle.
    levels: u32,
}

impl TouchProbes {
    /// Runs one cycle.
    pub(super) fn step(&mut self, table: &mut ObjectTable, drive: &DriveInput) {
        let levels = table.probe_levels();
        let changed = levels ^ std::mem::replace(&mut self.levels, levels);
        for number in 0..2_u8 {
            let input = |word: u32| word >> number & 1 == 1;
            let edge = input(changed).then_some((u8::from(!input(levels)), drive.count));
            step(table, number, edge, drive.index);
        }
    }
}

/// Runs one cycle of a probe, 0 or 1. `edge`: edge of its input (0 rising, 1 falling) with its position; `zero_pulse`: position of the zero
/// pulse.
fn step(table: &mut ObjectTable, number: u8, edge: Option<(u8, i64)>, zero_pulse: Option<i64>) {
    let shift = 8 * u32::from(number);
    let function = table.get(objects::TOUCH_PROBE_FUNCTION) >> shift;
    let status = table.get(simulated::TOUCH_PROBE_STATUS);
    if function & ENABLED == 0 {
        table.set(simulated::TOUCH_PROBE_STATUS, status & !(0x07 << shift));
        return;
    }
    let mut status = status | ENABLED << shift;
    let event = match function & SOURCE {
        0 => edge,
        ZERO_PULSE => zero_pulse.map(|position| (0, position)),
        _ => None,
    };
    if let Some((edge, position)) = event {
        let stored = STORED << edge << shift;
        let is_open = function & CONTINUOUS != 0 || status & stored == 0;
        if is_open && function & (EDGE << edge) != 0 {
            status |= stored;
            let [place, count] = probe::objects_of(2 * number + edge);
            // The position wraps in 32 bits, the count in 16 bits.
            table.set(place, position as u32);
            let events = table.get(count).wrapping_add(1);
            table.set(count, events);
        }
    }
    table.set(simulated::TOUCH_PROBE_STATUS, status);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drive with this probe function.
    struct Rig(ObjectTable, TouchProbes);

    impl Rig {
        fn new(function: u32) -> Self {
            let mut table = ObjectTable::plain();
            table.set(objects::TOUCH_PROBE_FUNCTION, function);
            Self(table, TouchProbes::default())
        }

        /// Runs one cycle. Returns 60B9h after it.
        fn step(&mut self, levels: u32, count: i64, index: Option<i64>) -> u32 {
            self.0.set(simulated::PROBE_INPUTS, levels);
            self.1.step(&mut self.0, &DriveInput { count, index, ..DriveInput::default() });
            self.0.get(simulated::TOUCH_PROBE_STATUS)
        }

        /// Returns position and count of a slot: probe 1 rising and falling, probe 2 rising and falling.
        fn slot(&self, slot: u8) -> (i32, u32) {
            let [place, count] = probe::objects_of(slot);
            (self.0.signed(place), self.0.get(count))
        }
    }

    /// 60B8h 0033h: probe 1, continuous, both edges of its input. 60B9h: 1 enabled, 2 rising stored, 4 falling stored.
    #[test]
    fn edges_of_an_input_store_their_positions() {
        let mut rig = Rig::new(0x0033);
        assert_eq!([rig.step(0, 5, None), rig.step(1, 10, None), rig.step(1, 15, None)], [1, 3, 3]);
        assert_eq!((rig.slot(0), rig.slot(1)), ((10, 1), (0, 0)));
        assert_eq!([rig.step(2, -20, Some(7)), rig.step(3, -25, None)], [7, 7]);
        assert_eq!((rig.slot(0), rig.slot(1), rig.slot(2)), ((-25, 2), (-20, 1), (0, 0)));
    }

    /// 60B8h 1100h: probe 2, rising edge, first event only. A new rising edge of bit 0 starts it again.
    #[test]
    fn first_event_is_kept_until_the_probe_is_enabled_again() {
        let mut rig = Rig::new(0x1100);
        for (levels, count) in [(2, 10), (0, 20), (2, 30)] {
            rig.step(levels, count, None);
        }
        assert_eq!(rig.slot(2), (10, 1));
        rig.0.set(objects::TOUCH_PROBE_FUNCTION, 0);
        assert_eq!(rig.step(0, 40, None), 0);
        rig.0.set(objects::TOUCH_PROBE_FUNCTION, 0x1100);
        assert_eq!(rig.step(2, 50, None), 0x0300);
        assert_eq!(rig.slot(2), (50, 2));
    }

    /// 60B8h 0017h: probe 1, continuous, zero pulse.
    #[test]
    fn zero_pulse_stores_its_own_position() {
        let mut rig = Rig::new(0x0017);
        rig.step(1, 10, None);
        assert_eq!(rig.slot(0), (0, 0), "an edge of the input");
        assert_eq!(rig.step(1, 12, Some(11)), 3);
        assert_eq!(rig.slot(0), (11, 1));
    }
}

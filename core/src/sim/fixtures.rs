//! Switches and encoder index along the travel of a simulated axis.
//!
//! Law      position = raw counts + position of the axis at count 0; a switch is actuated by the position alone, and
//!          each passage of `at` + n `every` gives an index pulse
//! Source   contract section 8, WF-INC-01

use crate::drive::inputs;

/// The index of an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Index {
    /// Increments between two pulses, above 0.
    pub every: i64,
    /// Position of one of the pulses.
    pub at: i64,
}

/// Switches and index of an axis, by position (inc).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fixtures {
    /// Position of the axis at the start, where its counts are 0.
    pub start: i64,
    /// Index pulses.
    pub index: Option<Index>,
    /// Range of the actuated reference switch, both ends included.
    pub home: Option<(i64, i64)>,
    /// Upper end of the range of the actuated negative limit switch.
    pub negative: Option<i64>,
    /// Lower end of the range of the actuated positive limit switch.
    pub positive: Option<i64>,
}

impl Fixtures {
    /// Returns the digital inputs of the drive (60FDh) at a position.
    pub(super) fn inputs(&self, place: i64) -> u32 {
        let bit = |bit: u32| match self.range(bit) {
            Some((from, to)) if (from..=to).contains(&place) => bit,
            _ => 0,
        };
        bit(inputs::NEGATIVE_LIMIT) | bit(inputs::POSITIVE_LIMIT) | bit(inputs::HOME)
    }

    /// Returns the range in which a switch (a bit of those inputs) is actuated, both ends included.
    fn range(&self, switch: u32) -> Option<(i64, i64)> {
        match switch {
            inputs::NEGATIVE_LIMIT => self.negative.map(|end| (i64::MIN, end)),
            inputs::POSITIVE_LIMIT => self.positive.map(|end| (end, i64::MAX)),
            inputs::HOME => self.home,
            _ => None,
        }
    }

    /// Returns the edges of a switch between two positions, in their order: the outermost position at which it is
    /// actuated, and whether it is actuated afterwards.
    pub(super) fn edges_passed(&self, switch: u32, from: i64, to: i64) -> [Option<(i64, bool)>; 2] {
        let Some((low, high)) = self.range(switch).filter(|(low, high)| low <= high) else { return [None; 2] };
        let (near, far) = if to > from { (low, high) } else { (high, low) };
        let enters = if to > from { from < near && near <= to } else { from > near && near >= to };
        let leaves = if to > from { from <= far && far < to } else { from >= far && far > to };
        [enters.then_some((near, true)), leaves.then_some((far, false))]
    }

    /// Returns the last index pulse between two positions; the first position is excluded, the second one included.
    pub(super) fn index_passed(&self, from: i64, to: i64) -> Option<i64> {
        let Index { every, at } = self.index.filter(|index| index.every > 0)?;
        // Positions beyond the range of machines wrap, like the counts.
        let after = to.wrapping_sub(at).rem_euclid(every);
        if to > from {
            Some(to.wrapping_sub(after)).filter(|pulse| *pulse > from)
        } else {
            let pulse = if after == 0 { to } else { to.wrapping_add(every - after) };
            Some(pulse).filter(|pulse| *pulse < from)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pulse_comes_once_with_each_passage() {
        let fixtures = Fixtures { index: Some(Index { every: 100, at: 30 }), ..Fixtures::default() };
        let passed = [(0, 29), (0, 30), (30, 31), (31, 30), (30, 29), (0, 230), (130, -70), (29, 31), (31, 29), (5, 5)];
        let expected = [None, Some(30), None, Some(30), None, Some(230), Some(-70), Some(30), Some(30), None];
        assert_eq!(passed.map(|(from, to)| fixtures.index_passed(from, to)), expected);
    }

    #[test]
    fn an_edge_lies_at_the_outermost_place_that_is_actuated() {
        let fixtures = Fixtures { home: Some((10, 20)), negative: Some(-5), positive: Some(50), ..Fixtures::default() };
        let (on, off) = (|place| Some((place, true)), |place| Some((place, false)));
        for (switch, from, to, expected) in [
            (inputs::HOME, 9, 10, [on(10), None]),
            (inputs::HOME, 10, 20, [None, None]),
            (inputs::HOME, 20, 21, [None, off(20)]),
            (inputs::HOME, 0, 30, [on(10), off(20)]),
            (inputs::HOME, 30, 0, [on(20), off(10)]),
            (inputs::HOME, 15, 9, [None, off(10)]),
            (inputs::HOME, 15, 15, [None, None]),
            (inputs::NEGATIVE_LIMIT, -9, -2, [None, off(-5)]),
            (inputs::NEGATIVE_LIMIT, -2, -9, [on(-5), None]),
            (inputs::POSITIVE_LIMIT, 40, 60, [on(50), None]),
            (inputs::POSITIVE_LIMIT, 60, 40, [None, off(50)]),
        ] {
            assert_eq!(fixtures.edges_passed(switch, from, to), expected, "{switch}: {from} to {to}");
        }
        assert_eq!(Fixtures::default().edges_passed(inputs::HOME, 0, 30), [None; 2]);
    }

    #[test]
    fn switches_are_actuated_by_the_place() {
        let fixtures = Fixtures { home: Some((10, 20)), negative: Some(-5), positive: Some(50), ..Fixtures::default() };
        let seen = [-6, -5, -4, 9, 10, 20, 21, 49, 50].map(|place| fixtures.inputs(place));
        assert_eq!(seen, [1, 1, 0, 0, 4, 4, 0, 0, 2]);
    }
}

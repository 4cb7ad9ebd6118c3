//! The methods of homing, each a list of legs.
//!
//! Law      a leg moves in one direction until a switch changes or an index pulse comes; the next leg begins in that
//!          cycle. The search for a switch uses homing.velocity; the last approach to its edge and the motion to the
//!          index are slow
//! Source   CiA 402-2, homing methods 1 to 14, 17 to 30, 33, 34; MACS-HOME-03; WF-REF-01

use crate::parameter::Assigned;

/// The switch of a leg, in the direction of the counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Switch {
    /// Reference switch.
    Home,
    /// Limit switch at the end of rising counts.
    Positive,
    /// Limit switch at the end of falling counts.
    Negative,
}

/// The end of a leg.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Until {
    /// The switch becomes active.
    On(Switch),
    /// The switch becomes inactive.
    Off(Switch),
    /// An index pulse.
    Index,
}

/// The velocity of a leg.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Speed {
    /// Velocity of the search for a switch.
    Fast = 0,
    /// Velocity across the cam of reference travel.
    Reduced = 1,
    /// Velocity of the last approach, or of the motion to the index.
    Slow = 2,
}

/// A motion in one direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Leg {
    /// Direction, 1 or -1: of the counts; in a sequence of MACS, of its velocity.
    pub way: i8,
    pub until: Until,
    pub speed: Speed,
    /// Whether the limit switch ahead reverses it, once.
    pub turns: bool,
}

use Switch::{Home, Negative, Positive};

use Until::{Index, Off, On};

/// Right: rising counts, to the positive end.
const R: i8 = 1;

/// Left: falling counts, to the negative end.
const L: i8 = -1;

const fn fast(way: i8, until: Until) -> Leg {
    Leg { way, until, speed: Speed::Fast, turns: false }
}

const fn slow(way: i8, until: Until) -> Leg {
    Leg { way, until, speed: Speed::Slow, turns: false }
}

const fn reduced(way: i8, until: Until) -> Leg {
    Leg { way, until, speed: Speed::Reduced, turns: false }
}

/// Returns a leg that a limit switch ahead reverses.
const fn turn(way: i8, until: Until) -> Leg {
    Leg { way, until, speed: Speed::Fast, turns: true }
}

/// Legs by the numbers of parameter `homing.method`. Methods 17 to 30 are 1 to 14 without the index; if the last leg
/// then ends at an edge, the edge is the reference.
const METHODS: &[(i64, &[Leg])] = &[
    // Off the limit switch, then to the index.
    (1, &[fast(L, On(Negative)), slow(R, Off(Negative)), slow(R, Index)]),
    (2, &[fast(R, On(Positive)), slow(L, Off(Positive)), slow(L, Index)]),
    // The reference switch is active from its edge to the positive end: index on its inactive side, then on its active
    // side.
    (3, &[fast(R, On(Home)), fast(L, Off(Home)), fast(R, On(Home)), slow(L, Off(Home)), slow(L, Index)]),
    (4, &[fast(R, On(Home)), fast(L, Off(Home)), slow(R, On(Home)), slow(R, Index)]),
    // The same towards the negative end.
    (5, &[fast(L, On(Home)), fast(R, Off(Home)), fast(L, On(Home)), slow(R, Off(Home)), slow(R, Index)]),
    (6, &[fast(L, On(Home)), fast(R, Off(Home)), slow(L, On(Home)), slow(L, Index)]),
    // The reference switch is active on a part of the travel. To the right first: left of its left edge, right of it,
    // left of its right edge, right of it.
    (7, &[turn(R, On(Home)), fast(L, Off(Home)), fast(R, On(Home)), slow(L, Off(Home)), slow(L, Index)]),
    (8, &[turn(R, On(Home)), fast(L, Off(Home)), slow(R, On(Home)), slow(R, Index)]),
    (9, &[turn(R, On(Home)), fast(R, Off(Home)), slow(L, On(Home)), slow(L, Index)]),
    (10, &[turn(R, On(Home)), fast(R, Off(Home)), fast(L, On(Home)), slow(R, Off(Home)), slow(R, Index)]),
    // To the left first: right of its right edge, left of it, right of its left edge, left of it.
    (11, &[turn(L, On(Home)), fast(R, Off(Home)), fast(L, On(Home)), slow(R, Off(Home)), slow(R, Index)]),
    (12, &[turn(L, On(Home)), fast(R, Off(Home)), slow(L, On(Home)), slow(L, Index)]),
    (13, &[turn(L, On(Home)), fast(L, Off(Home)), slow(R, On(Home)), slow(R, Index)]),
    (14, &[turn(L, On(Home)), fast(L, Off(Home)), fast(R, On(Home)), slow(L, Off(Home)), slow(L, Index)]),
    // The next index.
    (33, &[slow(L, Index)]),
    (34, &[slow(R, Index)]),
    // HOME_TYPE 0 to 3: back off the switch, or across it; with and without the index.
    (-1, &[fast(R, On(Home)), slow(L, Off(Home)), slow(L, Index)]),
    (-2, &[fast(R, On(Home)), slow(L, Off(Home))]),
    (-3, &[fast(R, On(Home)), slow(R, Off(Home)), slow(R, Index)]),
    (-4, &[fast(R, On(Home)), slow(R, Off(Home))]),
    // Reference travel of the positioning modules: across the cam, to the zero mark.
    (REFERENCE_TRAVEL, &[fast(R, On(Home)), reduced(R, Off(Home)), slow(R, Index)]),
    // The same, back to the side from which it came.
    (REFERENCE_TRAVEL_BACK, &[fast(R, On(Home)), reduced(L, Off(Home)), slow(L, Index)]),
];

/// Reference travel; no parameter selects it.
pub(crate) const REFERENCE_TRAVEL: i64 = -5;

/// Reference travel that reverses on the cam.
pub(crate) const REFERENCE_TRAVEL_BACK: i64 = -6;

/// Returns the legs of a method; none if it needs no motion or does not exist.
pub(crate) fn legs(method: i64) -> &'static [Leg] {
    let (number, has_index) = if (17..=30).contains(&method) { (method - 16, false) } else { (method, true) };
    let Some((_, legs)) = METHODS.iter().find(|(known, _)| *known == number) else { return &[] };
    if has_index { legs } else { legs.split_last().map_or(&[], |(_, legs)| legs) }
}

/// Whether the method searches for a switch.
pub(crate) fn seeks_switch(method: i64) -> bool {
    legs(method).iter().any(|leg| leg.until != Index)
}

/// Name of each switch and the parameter that assigns a digital input to it, in the order of [`Switch`].
pub(crate) const SWITCHES: [(&str, &str); 3] = [
    ("reference switch", "i_refswitch"),
    ("positive limit switch", "i_poslimitsw"),
    ("negative limit switch", "i_neglimitsw"),
];

/// Returns the first switch of a method without an assigned digital input, which only the drive reads (60FDh).
pub(crate) fn without_input(method: i64, assigned: &Assigned) -> Option<Switch> {
    let number = |switch: Switch| match switch {
        Home => assigned.refswitch,
        Positive => assigned.poslimitsw,
        Negative => assigned.neglimitsw,
    };
    let mut sought = legs(method).iter().filter_map(|leg| match leg.until {
        On(switch) | Off(switch) => Some(switch),
        Index => None,
    });
    sought.find(|switch| number(*switch) == 0)
}

/// Whether the method squares an axis with two drives by the reference switch of each, or sets the zero at the present
/// position.
pub(crate) fn squares(method: i64) -> bool {
    let ends_at = legs(method).iter().rev().find(|leg| leg.until != Index);
    let has_switch = ends_at.is_some_and(|leg| matches!(leg.until, On(Home) | Off(Home)));
    matches!(method, 35 | 37) || has_switch && !is_travel(method)
}

/// Whether it is reference travel of the positioning modules.
pub(crate) fn is_travel(method: i64) -> bool {
    matches!(method, REFERENCE_TRAVEL | REFERENCE_TRAVEL_BACK)
}

/// Whether it is a sequence of MACS.
pub(crate) fn is_macs(method: i64) -> bool {
    (-4..0).contains(&method)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_ends_with_a_slow_leg_and_only_its_first_one_may_turn() {
        for method in (-6..0).chain(1..=14).chain(17..=30).chain([33, 34]) {
            let legs = legs(method);
            assert!(legs.last().is_some_and(|leg| leg.speed == Speed::Slow), "{method}");
            assert!(legs.iter().skip(1).all(|leg| !leg.turns), "{method}");
            assert!(legs.iter().rev().skip(1).all(|leg| leg.until != Until::Index), "{method}");
        }
        for method in [0, 15, 16, 31, 32, 35, 36, 37, -7, i64::MAX, i64::MIN] {
            assert!(legs(method).is_empty(), "{method}");
        }
    }

    /// Methods by limit switches, by the reference switch, by the index alone and at the present position (CiA 402-2);
    /// HOME_TYPE 0.
    #[test]
    fn switch_without_an_input_is_the_first_one_that_a_method_looks_for() {
        let none = Assigned::default();
        for (method, switch) in [
            (1, Some(Negative)),
            (2, Some(Positive)),
            (17, Some(Negative)),
            (18, Some(Positive)),
            (3, Some(Home)),
            (7, Some(Home)),
            (30, Some(Home)),
            (-1, Some(Home)),
            (33, None),
            (34, None),
            (35, None),
            (0, None),
        ] {
            assert_eq!(without_input(method, &none), switch, "{method}");
        }
        assert_eq!(without_input(1, &Assigned { neglimitsw: -2, ..none }), None);
        assert_eq!(without_input(1, &Assigned { poslimitsw: 2, refswitch: 1, ..none }), Some(Negative));
        for (switch, (name, key)) in [(Home, SWITCHES[0]), (Positive, SWITCHES[1]), (Negative, SWITCHES[2])] {
            assert_eq!(SWITCHES[switch as usize], (name, key));
            assert!(key.starts_with("i_"), "{name}");
        }
    }

    #[test]
    fn without_the_index_the_same_edge_is_the_reference() {
        for method in 17..=30 {
            let with = legs(method - 16);
            assert_eq!(legs(method), &with[..with.len() - 1], "{method}");
        }
    }
}

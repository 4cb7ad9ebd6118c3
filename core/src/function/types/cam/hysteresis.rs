//! Hysteresis of one cam: the side from which it was reached, and the travel beyond it after which the other side
//! applies.
//!
//! Law      AMK-CAM-17 to -26 along the shorter path between two positions; a call may include several transitions
//! Source   AMK-CAM-15 to -27, A-57
//!
//! The ring of a track is its modulo. The absolute mode uses a ring that is longer than any travel of 32 bits. In this
//! mode a cam whose end is below its start is on at both ends of the travel, as A-56 requires.

use crate::function::time::wrapped;
use serde::{Deserialize, Serialize};

/// Range of positions: `length` increments, starting at `low`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Ring {
    low: i64,
    length: i64,
}

impl Ring {
    /// The ring of the absolute mode.
    pub(super) const LINE: Self = Self { low: -(1 << 39), length: 1 << 40 };

    /// Returns the ring of a modulo above 0.
    pub(super) fn of(modulo: i64) -> Self {
        Self { low: 0, length: modulo }
    }

    /// Returns the distance in positive direction from one position to another, within one turn.
    fn ahead(self, from: i64, to: i64) -> i64 {
        wrapped(to.wrapping_sub(from), self.length)
    }

    /// Returns the shorter signed distance; positive if both are equal.
    pub(super) fn travel(self, from: i64, to: i64) -> i64 {
        let ahead = self.ahead(from, to);
        if ahead > self.length - ahead { ahead - self.length } else { ahead }
    }

    /// Returns the arc of a cam, clipped to the range of positions.
    pub(super) fn arc(self, on: i32, off: i32) -> Arc {
        let place = |x: i32| i64::from(x).clamp(self.low, self.low.saturating_add(self.length));
        let (start, end) = (place(on), place(off));
        let length = match on.cmp(&off) {
            std::cmp::Ordering::Less => end - start,
            std::cmp::Ordering::Equal => 0,
            std::cmp::Ordering::Greater => self.length - (start - end),
        };
        Arc { ring: self, start, length }
    }
}

/// The range in which a cam is on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arc {
    ring: Ring,
    start: i64,
    length: i64,
}

impl Arc {
    /// Returns the distance from the end of the cam to its start; a hysteresis must be shorter. `None` for a cam that
    /// is never on.
    pub(super) fn gap(self) -> Option<i64> {
        (self.length > 0).then_some(self.ring.length - self.length)
    }
}

/// Basic cam: on from `on` to `off`, across the wrap if `off` is below `on`, never if both are equal.
#[inline]
pub(super) fn is_inside(on: i32, off: i32, x: i64) -> bool {
    let (on, off) = (i64::from(on), i64::from(off));
    if on < off { on <= x && x < off } else { on > off && (on <= x || x < off) }
}

/// Direction from which the cam was reached, and whether it has been passed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
enum State {
    #[default]
    Free,
    PositiveOn,
    PositivePast,
    NegativeOn,
    NegativePast,
}

/// A cam with hysteresis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct HysteresisState {
    /// On and off positions, as read from the table.
    cam: (i32, i32),
    state: State,
    /// Position relative to the start of the cam, in the turn in which the cam was reached.
    u: i64,
}

impl HysteresisState {
    /// Maximum transitions in half a turn: the cam is left on either side, reached from the other one and left again.
    const MAX_TRANSITIONS: usize = 8;

    /// Returns the state at START and after an edit of the table.
    fn begin(cam: (i32, i32), arc: Arc, x: i64) -> Self {
        let u = arc.ring.ahead(arc.start, x);
        Self { cam, state: if u < arc.length { State::PositiveOn } else { State::Free }, u }
    }

    /// Moves to x. Returns true if the cam is on there.
    pub(super) fn step(&mut self, cam: (i32, i32), at: TrackPosition, is_first: bool) -> bool {
        let arc = at.ring.arc(cam.0, cam.1);
        if is_first || cam != self.cam {
            *self = Self::begin(cam, arc, at.x);
        } else {
            // Both values are below a turn; a restored state may have any value, so the sum wraps.
            self.u = self.u.wrapping_add(at.way);
            self.settle(arc, at.hysteresis);
        }
        arc.length > 0 && matches!(self.state, State::PositiveOn | State::NegativeOn)
    }

    fn settle(&mut self, arc: Arc, hysteresis: i64) {
        let (end, turn) = (arc.length, arc.ring.length);
        let behind = end + hysteresis;
        for _ in 0..Self::MAX_TRANSITIONS {
            let u = self.u;
            let (state, shift) = match self.state {
                State::PositiveOn if u < -hysteresis => (State::Free, turn),
                State::PositiveOn if u >= end => (State::PositivePast, 0),
                State::PositivePast if u >= behind => (State::Free, 0),
                State::PositivePast if u < end - hysteresis => (State::PositiveOn, 0),
                State::NegativeOn if u >= behind => (State::Free, 0),
                State::NegativeOn if u < 0 => (State::NegativePast, 0),
                State::NegativePast if u < -hysteresis => (State::Free, turn),
                State::NegativePast if u >= hysteresis => (State::NegativeOn, 0),
                // Outside the cam, u is between the end of the cam and its next start.
                State::Free if u >= turn => (State::PositiveOn, -turn),
                State::Free if u < end => (State::NegativeOn, 0),
                _ => return,
            };
            (self.state, self.u) = (state, u.wrapping_add(shift));
        }
    }

    /// Returns true if a restored state is valid.
    pub(super) fn is_sound(&self) -> bool {
        self.u.unsigned_abs() <= Ring::LINE.length.unsigned_abs() * 2
    }
}

/// Position of a track, and the travel since the last call.
#[derive(Clone, Copy, Debug)]
pub(super) struct TrackPosition {
    pub ring: Ring,
    pub x: i64,
    pub way: i64,
    pub hysteresis: i64,
}

#[cfg(test)]
impl HysteresisState {
    /// A state at any position.
    pub(super) fn at(u: i64) -> Self {
        Self { u, ..Self::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TURN: i64 = 20_000;

    /// Returns whether the cam is on at each of the positions, which the track visits in their order.
    fn run(ring: Ring, cam: (i32, i32), hysteresis: i64, places: &[i64]) -> String {
        let mut overrun = HysteresisState::default();
        let mut last = None;
        let outputs = places.iter().map(|x| {
            let way = ring.travel(last.unwrap_or(*x), *x);
            let at = TrackPosition { ring, x: *x, way, hysteresis };
            let is_on = overrun.step(cam, at, last.replace(*x).is_none());
            assert!(overrun.is_sound());
            if is_on { '1' } else { '0' }
        });
        outputs.collect()
    }

    /// Each transition of the state machine, one increment before its limit and at it.
    /// Proves: AMK-CAM-17, AMK-CAM-18, AMK-CAM-19, AMK-CAM-20, AMK-CAM-21, AMK-CAM-22, AMK-CAM-23, AMK-CAM-24, AMK-CAM-25,
    /// AMK-CAM-26, AMK-CAM-27
    #[test]
    fn a_cam_switches_at_the_increments_of_its_table() {
        let cam = (10_000, 11_000);
        for ring in [Ring::of(TURN), Ring::LINE] {
            let run = |places: &[i64]| run(ring, cam, 100, places);
            // 17, 19: on at its start, off again only below 9900.
            assert_eq!(run(&[9_999, 10_000, 9_999, 9_900, 9_899, 9_999, 10_000]), "0111001");
            // 20, 21: off at its end, on again only below 10900.
            assert_eq!(run(&[9_999, 10_500, 10_999, 11_000, 10_999, 10_900, 10_899]), "0110001");
            // 22: passed by 100, the cam is reached from the other side: on immediately below its end. With one
            // increment less it is not.
            assert_eq!(run(&[10_500, 11_000, 11_100, 11_000, 10_999]), "10001");
            assert_eq!(run(&[10_500, 11_000, 11_099, 11_000, 10_999]), "10000");
            // 18, 23: reached in negative direction, it stays on up to 11099.
            assert_eq!(run(&[11_000, 10_999, 11_000, 11_099, 11_100, 11_099, 10_999]), "0111001");
            // 24, 25: off below its start, on again only from 10100 on.
            assert_eq!(run(&[11_000, 10_500, 10_000, 9_999, 10_000, 10_099, 10_100]), "0110001");
            // 26: passed by 101 in negative direction, it is reached from below again. With one increment less it is
            // not.
            assert_eq!(run(&[11_000, 10_500, 9_999, 9_899, 9_999, 10_000]), "010001");
            assert_eq!(run(&[11_000, 10_500, 9_999, 9_900, 9_999, 10_000]), "010000");
        }
    }

    #[test]
    fn a_cam_that_is_passed_within_one_call_leaves_the_right_side_behind() {
        let run = |places: &[i64]| run(Ring::of(TURN), (10_000, 11_000), 100, places);
        // Past the cam and beyond the hysteresis: free, so that the cam is on immediately in the other direction.
        assert_eq!(run(&[9_000, 12_000, 10_999]), "001");
        // Past the cam by less than the hysteresis: in the other direction it switches late.
        assert_eq!(run(&[9_000, 11_050, 10_999, 10_899]), "0001");
        // The same in negative direction.
        assert_eq!(run(&[12_000, 9_000, 10_000]), "001");
        assert_eq!(run(&[12_000, 9_950, 10_050, 10_100]), "0001");
    }

    /// Proves: AMK-CAM-16, AMK-CAM-22, AMK-CAM-26
    #[test]
    fn a_cam_over_the_wrap_is_one_cam() {
        let run = |cam, places: &[i64]| run(Ring::of(TURN), cam, 300, places);
        // On from 19800 over 0 up to 200.
        assert_eq!(run((19_800, 200), &[19_000, 19_800, 0, 199, 200, 499, 200, 199]), "01110000");
        assert_eq!(
            run((19_800, 200), &[19_000, 19_800, 100, 500, 199, 19_800, 19_799, 19_500, 19_799, 100]),
            "0110110001"
        );
        // The hysteresis crosses the wrap: on up to 200 after the start at 100.
        assert_eq!(run((100, 5_000), &[50, 100, 19_900, 19_800, 19_799, 99, 100]), "0111001");
        // Around the whole turn, repeatedly.
        let laps = (0..12).map(|k| k * 7_000 % TURN).collect::<Vec<_>>();
        assert_eq!(run((0, 7_000), &laps), "100100100100");
    }

    #[test]
    fn the_absolute_line_has_two_ends() {
        let (first, last) = (i64::from(i32::MIN), i64::from(i32::MAX));
        // On outside of -100 .. 100.
        assert_eq!(
            run(Ring::LINE, (100, -100), 10, &[first, -101, -100, -91, -90, 0, 99, 100, 90, last, first]),
            "11000001111"
        );
        assert_eq!(run(Ring::LINE, (i32::MIN, 0), 10, &[first, -1, 0, 9, -1, last, -1, first]), "11000011");
    }

    #[test]
    fn unreachable_part_of_cam_is_clipped() {
        let rest = |on, off| Ring::of(TURN).arc(on, off).gap();
        assert_eq!(rest(19_000, 25_000), Some(19_000));
        assert_eq!(rest(-5, 10), Some(19_990));
        assert_eq!(rest(10, -5), Some(10));
        assert_eq!(rest(25_000, 5_000), Some(15_000));
        assert_eq!((rest(5, 5), rest(25_000, 30_000), rest(-9, -5)), (None, None, None));
        // Always on.
        assert_eq!((rest(0, 20_000), rest(0, -5), rest(30_000, 25_000)), (Some(0), Some(0), Some(0)));
    }

    #[test]
    fn the_shorter_way_is_taken_and_up_at_the_half() {
        let ring = Ring::of(10);
        assert_eq!(
            [(0, 4), (0, 5), (0, 6), (9, 0), (0, 9), (3, 3)].map(|(from, to)| ring.travel(from, to)),
            [4, 5, -4, 1, -1, 0]
        );
        assert_eq!(Ring::LINE.travel(i32::MIN.into(), i32::MAX.into()), u32::MAX.into());
    }

    /// The state machine as the spec prints it, one increment at a time along an endless line of cams; `n` is the turn
    /// of the current cam.
    struct Walk {
        state: State,
        x: i64,
        n: i64,
    }

    impl Walk {
        fn walk(&mut self, way: i64, (on, off): (i64, i64), h: i64, turn: i64) {
            for _ in 0..way.abs() {
                let before = self.x;
                self.x += way.signum();
                let x = self.x;
                let (x_on, x_off) = (on + self.n * turn, off + self.n * turn);
                let starts = (x - on).rem_euclid(turn) == 0 && x > before;
                let ends = (before - off).rem_euclid(turn) == 0 && x < before;
                self.state = match self.state {
                    State::Free if starts => {
                        self.n = (x - on).div_euclid(turn);
                        State::PositiveOn
                    }
                    State::Free if ends => {
                        self.n = (before - off).div_euclid(turn);
                        State::NegativeOn
                    }
                    State::PositiveOn if x < x_on - h => State::Free,
                    State::PositiveOn if x >= x_off => State::PositivePast,
                    State::PositivePast if x < x_off - h => State::PositiveOn,
                    State::PositivePast if x >= x_off + h => State::Free,
                    State::NegativeOn if x >= x_off + h => State::Free,
                    State::NegativeOn if x < x_on => State::NegativePast,
                    State::NegativePast if x >= x_on + h => State::NegativeOn,
                    State::NegativePast if x < x_on - h => State::Free,
                    state => state,
                };
            }
        }
    }

    proptest! {
        #[test]
        fn a_call_does_what_its_increments_do_one_by_one(
            turn in 4_i64..120,
            start in 0_i64..120,
            length in 1_i64..119,
            hysteresis in 1_i64..119,
            first in 0_i64..120,
            ways in proptest::collection::vec(-60_i64..61, 1..60),
        ) {
            let length = length.min(turn - 2);
            let hysteresis = hysteresis.min(turn - length - 1);
            let (start, first) = (start % turn, first % turn);
            let ring = Ring::of(turn);
            // An end across the wrap is below the start; an end at the wrap equals the turn.
            let end = if start + length > turn { start + length - turn } else { start + length };
            let cam = (start as i32, end as i32);
            let is_inside = (first - start).rem_euclid(turn) < length;
            let state = if is_inside { State::PositiveOn } else { State::Free };
            let mut walk = Walk { state, x: first, n: (first - start).div_euclid(turn) };
            let mut overrun = HysteresisState::default();
            overrun.step(cam, TrackPosition { ring, x: first, way: 0, hysteresis }, true);
            for way in ways {
                let way = way.clamp(-(turn - 1) / 2, turn / 2);
                let from = walk.x.rem_euclid(turn);
                walk.walk(way, (start, start + length), hysteresis, turn);
                let x = walk.x.rem_euclid(turn);
                prop_assert_eq!(ring.travel(from, x), way);
                let is_on = overrun.step(cam, TrackPosition { ring, x, way, hysteresis }, false);
                prop_assert_eq!(is_on, matches!(walk.state, State::PositiveOn | State::NegativeOn));
                prop_assert_eq!(overrun.state, walk.state);
            }
        }
    }
}

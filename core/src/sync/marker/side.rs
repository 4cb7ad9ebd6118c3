//! The marks of one side of a coupling: which of them count, and their positions.
//!
//! Law      position of a mark = travel of the side until then, in its increments, from the start of the coupling. With
//!          a window a mark counts from distance - window to distance + window after the one before. An earlier mark is
//!          extra. If none has come by then, one is missed, and its nominal position is used. Only the last mark of
//!          each group matters. Monitoring begins with the first mark
//! Reads    the changes of the side, and its marks in their order
//! Refuses  nothing: unused groups are dropped, the oldest first
//! Source   MACS-MARK-02, MACS-MARK-03, MACS-MARK-07, A-35

use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Largest number of groups that wait for the other side.
pub(super) const MOST_GROUPS: usize = 8;
/// Number of successive missed marks after which monitoring starts again with the next mark.
const MOST_MISSED: u32 = 16;

/// Parameters for checking marks of a side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// Distance between marks (inc); 0: unknown.
    pub distance: i64,
    /// Tolerance around that distance (inc); 0: no check.
    pub window: i64,
    /// Number of marks in a group.
    pub group: i64,
}

impl Judged {
    /// Whether a mark at that distance from the one before (inc) counts.
    pub(super) fn accepts(&self, way: f64) -> bool {
        let off = way.abs() - self.distance as f64;
        !self.is_watched() || off.abs() <= self.window as f64
    }

    /// Whether the distance is beyond the window.
    fn is_beyond_window(&self, way: f64) -> bool {
        self.is_watched() && way.abs() > (self.distance.saturating_add(self.window)) as f64
    }

    fn is_watched(&self) -> bool {
        self.window > 0 && self.distance > 0
    }
}

/// Result of a mark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Found {
    /// The mark counts.
    Mark {
        /// Distance from the one before, if that was found, too (inc); negative if the side moved backward.
        distance: Option<f64>,
    },
    /// An extra mark, outside the window.
    Extra,
}

/// The last mark of a group.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Group {
    /// Travel of the side until then.
    pub place: Position,
    /// Time of the mark (ns).
    pub instant_ns: u64,
}

/// Marks of one side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Side {
    /// Travel since the start of the coupling.
    way: Position,
    /// Position of the last mark, or its nominal position if it was missed.
    last: Option<Position>,
    /// Whether the last mark was found.
    is_found: bool,
    /// Position of the last mark that was found.
    seen: Option<Position>,
    /// Number of marks of the present group.
    count: i64,
    /// The last marks of groups that the other side has not used, the oldest first.
    groups: [Group; MOST_GROUPS],
    waiting: u8,
    /// Whether a mark was missed since the last one that counts.
    is_missed: bool,
    /// Number of missed marks.
    missed: u64,
    /// Number of extra marks.
    extra: u64,
}

impl Side {
    /// Whether the state is possible.
    pub fn is_sound(&self) -> bool {
        usize::from(self.waiting) <= MOST_GROUPS && self.count >= 0
    }

    /// Returns its travel until now.
    pub fn travel(&self) -> Position {
        self.way
    }

    /// Returns its travel since the last mark that was found.
    pub fn since_mark(&self) -> Option<Position> {
        self.seen.map(|place| self.way - place)
    }

    /// Whether a mark was missed since the last one that counts.
    pub fn is_missed(&self) -> bool {
        self.is_missed
    }

    /// Returns the numbers of missed and of extra marks.
    pub fn counts(&self) -> (u64, u64) {
        (self.missed, self.extra)
    }

    /// Advances by the change of a cycle.
    pub fn advance(&mut self, change: Position) {
        self.way += change;
    }

    /// Sets the travel since the last mark of a group (inc).
    pub fn set_travel(&mut self, since: Position) {
        let place = Some(self.way - since);
        (self.last, self.seen, self.is_found, self.count) = (place, place, true, 0);
    }

    /// Adds a mark with its distance to the present position (inc) and its time.
    pub fn take(&mut self, before: Position, instant_ns: u64, judged: &Judged) -> Found {
        let place = self.way - before;
        self.pass(place, judged);
        let way = self.last.map(|last| (place - last).to_f64());
        if way.is_some_and(|way| !judged.accepts(way)) {
            self.extra = self.extra.saturating_add(1);
            return Found::Extra;
        }
        let distance = way.filter(|_| self.is_found);
        (self.last, self.seen, self.is_found, self.is_missed) = (Some(place), Some(place), true, false);
        self.complete(Some(Group { place, instant_ns }), judged);
        Found::Mark { distance }
    }

    /// Counts extra marks.
    pub(super) fn count_extra(&mut self, count: u32) {
        self.extra = self.extra.saturating_add(count.into());
    }

    /// Checks at the end of a cycle whether a mark was missed; returns true if so.
    pub fn check_missed(&mut self, judged: &Judged) -> bool {
        self.pass(self.way, judged)
    }

    /// Counts the marks that should have come before `place`.
    fn pass(&mut self, place: Position, judged: &Judged) -> bool {
        let mut passed = 0;
        while let Some(last) = self.last {
            let way = (place - last).to_f64();
            if !judged.is_beyond_window(way) {
                break;
            }
            passed += 1;
            (self.missed, self.is_missed, self.is_found) = (self.missed.saturating_add(1), true, false);
            if passed > MOST_MISSED {
                // The positions of the marks are unknown.
                self.last = None;
                break;
            }
            let distance = Position::whole(if way < 0.0 { judged.distance.saturating_neg() } else { judged.distance });
            self.last = Some(last + distance);
            self.complete(None, judged);
        }
        passed > 0
    }

    /// Counts a mark of a group; the last one of the group is stored, if it was found.
    fn complete(&mut self, group: Option<Group>, judged: &Judged) {
        self.count = self.count.saturating_add(1);
        if self.count < judged.group.max(1) {
            return;
        }
        self.count = 0;
        let Some(group) = group else { return };
        if usize::from(self.waiting) == MOST_GROUPS {
            self.forget(0);
        }
        if let Some(free) = self.groups.get_mut(usize::from(self.waiting)) {
            *free = group;
            self.waiting += 1;
        }
    }

    /// Returns the waiting groups, the oldest first.
    pub fn groups(&self) -> &[Group] {
        self.groups.get(..usize::from(self.waiting)).unwrap_or(&[])
    }

    /// Drops the groups up to that one.
    pub fn forget(&mut self, last: usize) {
        let gone = (last + 1).min(usize::from(self.waiting));
        self.groups.rotate_left(gone.min(MOST_GROUPS));
        self.waiting = self.waiting.saturating_sub(gone as u8);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const EACH: Judged = Judged { distance: 30_000, window: 1_000, group: 1 };

    fn at(place: i64, judged: &Judged) -> (Side, Found) {
        let mut side = Side::default();
        side.take(Position::ZERO, 0, judged);
        side.advance(Position::whole(place));
        let found = side.take(Position::ZERO, 0, judged);
        (side, found)
    }

    fn places(side: &Side) -> Vec<i64> {
        side.groups().iter().map(|group| group.place.floor()).collect()
    }

    /// Proves: MACS-MARK-07, MACS-O-43
    #[test]
    fn window_accepts_marks_inside() {
        for place in [29_000, 30_000, 31_000, -29_000, -31_000] {
            assert_eq!(at(place, &EACH).1, Found::Mark { distance: Some(f64::from(place as i32)) }, "{place}");
        }
        assert_eq!(at(28_999, &EACH).1, Found::Extra);
        let (side, found) = at(31_001, &EACH);
        // It is before the nominal position of the second one.
        assert_eq!((found, side.is_missed(), side.counts()), (Found::Extra, true, (1, 1)));
        // Without a window all marks count.
        let (side, found) = at(28_999, &Judged { window: 0, ..EACH });
        assert_eq!((found, side.counts()), (Found::Mark { distance: Some(28_999.0) }, (0, 0)));
    }

    /// After a missed mark the next one is expected at its nominal position, and its distance does not count.
    ///
    /// Proves: MACS-MARK-07
    #[test]
    fn the_next_pair_goes_on_after_a_missed_mark() {
        let mut side = Side::default();
        side.take(Position::ZERO, 0, &EACH);
        side.advance(Position::whole(31_000));
        assert!(!side.check_missed(&EACH));
        side.advance(Position::whole(1));
        assert!(side.check_missed(&EACH) && side.is_missed() && !side.check_missed(&EACH));
        side.advance(Position::whole(60_900 - 31_001));
        assert_eq!(side.take(Position::ZERO, 0, &EACH), Found::Mark { distance: None });
        assert_eq!((side.is_missed(), side.counts(), side.groups().len()), (false, (1, 0), 2));
    }

    /// Of three marks only the last matters; a missed mark is counted, too, and a group whose last mark was missed is
    /// dropped.
    ///
    /// Proves: MACS-MARK-02
    #[test]
    fn groups_are_counted() {
        let judged = Judged { group: 3, ..EACH };
        let mut side = Side::default();
        for place in 1..=9 {
            side.advance(Position::whole(30_000));
            // The second and the sixth are missing.
            if place != 2 && place != 6 {
                side.take(Position::ZERO, 0, &judged);
            }
        }
        assert_eq!(places(&side), [90_000, 270_000]);
        side.forget(0);
        assert_eq!(places(&side), [270_000]);
    }

    /// A value of 0 counts as 1.
    #[test]
    fn a_group_has_at_least_one_mark() {
        let (side, _) = at(30_000, &Judged { group: 0, ..EACH });
        assert_eq!(side.groups().len(), 2);
    }

    #[test]
    fn unused_marks_are_dropped() {
        let mut side = Side::default();
        for _ in 0..20 {
            side.advance(Position::whole(10));
            side.take(Position::ZERO, 0, &Judged { distance: 0, window: 0, group: 1 });
        }
        assert_eq!(side.groups().len(), MOST_GROUPS);
        assert_eq!(places(&side).first(), Some(&130));
    }

    proptest! {
        /// With any input and distance in a cycle: the groups stay within their number and order, and missed marks end.
        #[test]
        fn it_survives_anything(
            steps in prop::collection::vec((-(1_i64 << 33)..(1_i64 << 33), prop::option::of(0_i64..1_000)), 1..100),
            distance in 0_i64..100_000,
            window in 0_i64..100_000,
            group in 0_i64..5,
        ) {
            let judged = Judged { distance, window, group };
            let mut side = Side::default();
            for (change, mark) in steps {
                side.advance(Position::whole(change));
                if let Some(before) = mark {
                    side.take(Position::whole(before), 0, &judged);
                }
                side.check_missed(&judged);
                prop_assert!(side.is_sound() && side.groups().len() <= MOST_GROUPS);
            }
        }
    }
}

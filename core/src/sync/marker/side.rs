//! The marks of one side of a coupling: which of them count, and where they were.
//!
//! Law      place of a mark = way of the side until then, in its increments, from where the coupling began. With a window a mark counts from the distance
//!          less the window to the distance and the window behind the one before; what comes earlier is extra, and where none came by then, one
//!          is missed, and counts at its place. Only the last of each group matters. Monitoring begins with the first mark
//! Reads    the changes of the side, and its marks in their order
//! Refuses  nothing: groups that nobody takes are forgotten, the oldest first
//! Source   MACS-MARK-02, MACS-MARK-03, MACS-MARK-07, A-35

use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Groups that may wait for the other side.
pub(super) const MOST_GROUPS: usize = 8;
/// Marks that may be missed in a row before the next one found begins anew.
const MOST_MISSED: u32 = 16;

/// What marks of a side are judged by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// From mark to mark (inc); 0: unknown.
    pub distance: i64,
    /// How far from there they count (inc); 0: anywhere.
    pub window: i64,
    /// Marks of a group.
    pub group: i64,
}

impl Judged {
    /// Is a mark so far from the one before (inc) one that counts?
    pub(super) fn accepts(&self, way: f64) -> bool {
        let off = way.abs() - self.distance as f64;
        !self.is_watched() || off.abs() <= self.window as f64
    }

    /// Is it behind the window?
    fn is_behind(&self, way: f64) -> bool {
        self.is_watched() && way.abs() > (self.distance.saturating_add(self.window)) as f64
    }

    fn is_watched(&self) -> bool {
        self.window > 0 && self.distance > 0
    }
}

/// What became of a mark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Found {
    /// It counts.
    Mark {
        /// From the one before, if that was found, too (inc); below 0 where the side went backwards.
        distance: Option<f64>,
    },
    /// It came where none should.
    Extra,
}

/// The last mark of a group.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Group {
    /// Way of the side until then.
    pub place: Position,
    /// When it came (ns).
    pub instant_ns: u64,
}

/// One side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Side {
    /// From where the coupling began.
    way: Position,
    /// The last mark, or where it should have been.
    last: Option<Position>,
    /// The last mark was found.
    is_found: bool,
    /// Where one was found last.
    seen: Option<Position>,
    /// Marks of the group under way.
    count: i64,
    /// The last marks of groups that the other side has not taken, the oldest first.
    groups: [Group; MOST_GROUPS],
    waiting: u8,
    /// One was missed since the last one that counts.
    is_missed: bool,
    /// So far.
    missed: u64,
    /// So far.
    extra: u64,
}

impl Side {
    /// Could it have come about?
    pub fn is_sound(&self) -> bool {
        usize::from(self.waiting) <= MOST_GROUPS && self.count >= 0
    }

    /// Its way until now.
    pub fn way(&self) -> Position {
        self.way
    }

    /// Its way since the last mark that was found.
    pub fn since_mark(&self) -> Option<Position> {
        self.seen.map(|place| self.way - place)
    }

    /// Was one missed since the last one that counts?
    pub fn is_missed(&self) -> bool {
        self.is_missed
    }

    /// Marks that were missed, and that came where none should.
    pub fn counts(&self) -> (u64, u64) {
        (self.missed, self.extra)
    }

    /// Moves on by the change of a cycle.
    pub fn advance(&mut self, change: Position) {
        self.way += change;
    }

    /// The last mark of a group was passed so far (inc) before.
    pub fn know(&mut self, since: Position) {
        let place = Some(self.way - since);
        (self.last, self.seen, self.is_found, self.count) = (place, place, true, 0);
    }

    /// A mark, so far (inc) before where the side is now, and when it came.
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

    /// So many marks are extra.
    pub(super) fn lose(&mut self, count: u32) {
        self.extra = self.extra.saturating_add(count.into());
    }

    /// Looks at the end of a cycle whether a mark has stayed away; true where one has.
    pub fn look(&mut self, judged: &Judged) -> bool {
        self.pass(self.way, judged)
    }

    /// Notes the marks that should have come before `place`.
    fn pass(&mut self, place: Position, judged: &Judged) -> bool {
        let mut passed = 0;
        while let Some(last) = self.last {
            let way = (place - last).to_f64();
            if !judged.is_behind(way) {
                break;
            }
            passed += 1;
            (self.missed, self.is_missed, self.is_found) = (self.missed.saturating_add(1), true, false);
            if passed > MOST_MISSED {
                // Nobody knows where they are.
                self.last = None;
                break;
            }
            let distance = Position::whole(if way < 0.0 { judged.distance.saturating_neg() } else { judged.distance });
            self.last = Some(last + distance);
            self.complete(None, judged);
        }
        passed > 0
    }

    /// One more of a group; its last one is kept, if it was found.
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

    /// The groups that wait, the oldest first.
    pub fn groups(&self) -> &[Group] {
        self.groups.get(..usize::from(self.waiting)).unwrap_or(&[])
    }

    /// Forgets the groups up to that one.
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
    fn a_window_takes_what_lies_in_it() {
        for place in [29_000, 30_000, 31_000, -29_000, -31_000] {
            assert_eq!(at(place, &EACH).1, Found::Mark { distance: Some(f64::from(place as i32)) }, "{place}");
        }
        assert_eq!(at(28_999, &EACH).1, Found::Extra);
        let (side, found) = at(31_001, &EACH);
        // It is before the place of the second one.
        assert_eq!((found, side.is_missed(), side.counts()), (Found::Extra, true, (1, 1)));
        // Without a window all count.
        let (side, found) = at(28_999, &Judged { window: 0, ..EACH });
        assert_eq!((found, side.counts()), (Found::Mark { distance: Some(28_999.0) }, (0, 0)));
    }

    /// After one that stayed away the next is looked for where it would be, and its distance says nothing.
    /// Proves: MACS-MARK-07
    #[test]
    fn the_next_pair_goes_on_after_a_missed_mark() {
        let mut side = Side::default();
        side.take(Position::ZERO, 0, &EACH);
        side.advance(Position::whole(31_000));
        assert!(!side.look(&EACH));
        side.advance(Position::whole(1));
        assert!(side.look(&EACH) && side.is_missed() && !side.look(&EACH));
        side.advance(Position::whole(60_900 - 31_001));
        assert_eq!(side.take(Position::ZERO, 0, &EACH), Found::Mark { distance: None });
        assert_eq!((side.is_missed(), side.counts(), side.groups().len()), (false, (1, 0), 2));
    }

    /// Of three only the last matters, one that was missed counts among them, and a group whose last one was missed is none.
    /// Proves: MACS-MARK-02
    #[test]
    fn groups_are_counted() {
        let judged = Judged { group: 3, ..EACH };
        let mut side = Side::default();
        for place in 1..=9 {
            side.advance(Position::whole(30_000));
            // The second and the sixth stay away.
            if place != 2 && place != 6 {
                side.take(Position::ZERO, 0, &judged);
            }
        }
        assert_eq!(places(&side), [90_000, 270_000]);
        side.forget(0);
        assert_eq!(places(&side), [270_000]);
    }

    /// A value of 0 is 1.
    #[test]
    fn a_group_has_at_least_one_mark() {
        let (side, _) = at(30_000, &Judged { group: 0, ..EACH });
        assert_eq!(side.groups().len(), 2);
    }

    #[test]
    fn marks_that_nobody_takes_are_forgotten() {
        let mut side = Side::default();
        for _ in 0..20 {
            side.advance(Position::whole(10));
            side.take(Position::ZERO, 0, &Judged { distance: 0, window: 0, group: 1 });
        }
        assert_eq!(side.groups().len(), MOST_GROUPS);
        assert_eq!(places(&side).first(), Some(&130));
    }

    proptest! {
        /// Whatever comes, however far in a cycle: no more groups than there is room for, in their order, and missed marks end.
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
                side.look(&judged);
                prop_assert!(side.is_sound() && side.groups().len() <= MOST_GROUPS);
            }
        }
    }
}

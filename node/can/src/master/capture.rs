//! What goes over a bus, for whoever keeps it.
//!
//! Law      the cycle puts frames into a ring that was made before, and waits for nobody: what has no room is counted. A mark stands before
//!          what is done in each cycle, so that a frame has its place there
//! Reads    frames as the transport takes and gives them
//! Writes   frames of a cycle, with their time from its beginning on

use super::tally::Tally;
use crate::Frame;
use rtrb::{Consumer, Producer, RingBuffer};
use std::sync::Arc;

/// Frames and cycles that may wait: 1.5 s of a bus of 1 Mbit/s full of the shortest frames; 1 MB.
const ROOM: usize = 1 << 15;

/// What has happened.
#[derive(Clone, Copy, Debug)]
enum What {
    /// A cycle begins.
    Cycle(u64),
    Frame {
        frame: Frame,
        is_sent: bool,
    },
}

#[derive(Clone, Copy, Debug)]
struct Mark {
    /// By the clock of the bus (ns).
    at_ns: u64,
    what: What,
}

/// What the bus has: each frame that goes over it is counted, and kept where somebody keeps them.
#[derive(Debug)]
pub(super) struct Tap {
    tally: Arc<Tally>,
    ring: Option<Producer<Mark>>,
    now_ns: u64,
}

impl Tap {
    pub(super) fn new(drives: usize) -> Self {
        Self { tally: Arc::new(Tally::new(drives)), ring: None, now_ns: 0 }
    }

    pub(super) fn tally(&self) -> &Arc<Tally> {
        &self.tally
    }

    /// From now on somebody keeps them.
    pub(super) fn keep(&mut self) -> Frames {
        let (ring, marks) = RingBuffer::new(ROOM);
        self.ring = Some(ring);
        Frames { marks, before: Vec::new(), begin: None }
    }

    /// The time of what comes next.
    pub(super) fn set_time(&mut self, now_ns: u64) {
        self.now_ns = now_ns;
    }

    /// A cycle begins.
    pub(super) fn begin(&mut self, cycle: u64) {
        self.push(What::Cycle(cycle));
    }

    /// A frame goes over the bus.
    pub(super) fn take(&mut self, frame: &Frame, is_sent: bool) {
        self.tally.count(frame, is_sent);
        self.push(What::Frame { frame: *frame, is_sent });
    }

    fn push(&mut self, what: What) {
        if let Some(ring) = &mut self.ring
            && ring.push(Mark { at_ns: self.now_ns, what }).is_err()
        {
            self.tally.miss();
        }
    }
}

/// The frames of a bus, for whoever keeps them.
#[derive(Debug)]
pub struct Frames {
    marks: Consumer<Mark>,
    /// What went before the cycle that comes.
    before: Vec<(u64, Frame, bool)>,
    /// The newest cycle that has begun, and when (ns).
    begin: Option<(u64, u64)>,
}

impl Frames {
    /// The frames up to the end of this cycle that were not taken yet: how long behind its beginning they went (ns; before it: negative), and
    /// whether they were sent. Those of a cycle whose beginning had no room in the ring went at its beginning.
    pub fn take(&mut self, cycle: u64, mut keep: impl FnMut(i64, &Frame, bool)) {
        while let Ok(Mark { at_ns, what }) = self.marks.peek().copied() {
            match what {
                What::Cycle(next) if next > cycle => break,
                What::Cycle(begun) => self.begin = Some((begun, at_ns)),
                What::Frame { frame, is_sent } => self.before.push((at_ns, frame, is_sent)),
            }
            let _ = self.marks.pop();
        }
        let begin = self.begin.filter(|(begun, _)| *begun == cycle);
        for (at_ns, frame, is_sent) in self.before.drain(..) {
            let offset = begin.map_or(0, |(_, begin_ns)| at_ns.cast_signed().wrapping_sub(begin_ns.cast_signed()));
            keep(offset, &frame, is_sent);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Id;

    fn frame(byte: u8) -> Frame {
        Frame::data(Id::SYNC, &[byte]).expect("a byte")
    }

    fn taken(frames: &mut Frames, cycle: u64) -> Vec<(i64, u8, bool)> {
        let mut taken = Vec::new();
        frames.take(cycle, |offset, frame, is_sent| taken.push((offset, frame.bytes()[0], is_sent)));
        taken
    }

    #[test]
    fn frames_have_their_place_in_a_cycle() {
        let mut tap = Tap::new(0);
        tap.take(&frame(9), true);
        let mut frames = tap.keep();
        let mut at = |now_ns, byte, is_sent| {
            tap.set_time(now_ns);
            tap.take(&frame(byte), is_sent);
        };
        at(50, 1, true);
        at(100, 2, false);
        tap.set_time(300);
        tap.begin(7);
        tap.take(&frame(3), false);
        tap.set_time(340);
        tap.take(&frame(4), true);
        tap.set_time(1300);
        tap.begin(8);
        tap.take(&frame(5), false);
        assert_eq!(taken(&mut frames, 7), [(-250, 1, true), (-200, 2, false), (0, 3, false), (40, 4, true)]);
        assert_eq!(taken(&mut frames, 7), []);
        assert_eq!(taken(&mut frames, 8), [(0, 5, false)]);
        assert_eq!(tap.tally().missed(), 0, "the one before was for nobody");
    }

    /// A recorder that stands still costs frames, which are counted; those behind them come, at the beginning of their cycle where it is not
    /// known.
    #[test]
    fn what_has_no_room_is_counted() {
        let mut tap = Tap::new(0);
        let mut frames = tap.keep();
        tap.begin(0);
        (0..ROOM).for_each(|_| tap.take(&frame(1), true));
        tap.set_time(1000);
        tap.begin(1);
        assert_eq!(tap.tally().missed(), 2);
        assert_eq!(taken(&mut frames, 0).len(), ROOM - 1);
        tap.set_time(1500);
        tap.take(&frame(2), false);
        assert_eq!(taken(&mut frames, 1), [(0, 2, false)]);
    }
}

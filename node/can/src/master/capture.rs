//! Recording of the frames of a bus.
//!
//! Law      the cycle thread puts frames into a preallocated ring and never waits; frames without room are counted as lost. A mark at the
//!          beginning of each cycle assigns the frames to cycles
//! Reads    frames that the transport sends and receives
//! Writes   frames of a cycle, with the time since its beginning

use super::tally::BusCounters;
use crate::{CAPTURE, Frame};
use lineshaft_core::drive::{FrameKind, FrameSource, RecordedFrame};
use rtrb::{Consumer, Producer, RingBuffer};
use std::sync::Arc;

/// Maximum number of waiting frames and cycle marks: 1.5 s of a bus with 1 Mbit/s full of the shortest frames; 1 MB.
const ROOM: usize = 1 << 15;

/// Recorded event.
#[derive(Clone, Copy, Debug)]
enum What {
    /// Beginning of a cycle.
    Cycle(u64),
    Frame {
        frame: Frame,
        is_sent: bool,
    },
}

#[derive(Clone, Copy, Debug)]
struct Mark {
    /// Time by the clock of the bus, in ns.
    at_ns: u64,
    what: What,
}

/// Counts each frame of the bus, and records it if recording was started.
#[derive(Debug)]
pub(super) struct FrameRecorder {
    tally: Arc<BusCounters>,
    ring: Option<Producer<Mark>>,
    now_ns: u64,
}

impl FrameRecorder {
    pub(super) fn new(drives: usize) -> Self {
        Self { tally: Arc::new(BusCounters::new(drives)), ring: None, now_ns: 0 }
    }

    pub(super) fn tally(&self) -> &Arc<BusCounters> {
        &self.tally
    }

    /// Starts to record frames.
    pub(super) fn start_recording(&mut self) -> RecordedFrames {
        let (ring, marks) = RingBuffer::new(ROOM);
        self.ring = Some(ring);
        RecordedFrames { marks, before: Vec::new(), begin: None }
    }

    /// Sets the time of the next events.
    pub(super) fn set_time(&mut self, now_ns: u64) {
        self.now_ns = now_ns;
    }

    /// Records the beginning of a cycle.
    pub(super) fn begin(&mut self, cycle: u64) {
        self.push(What::Cycle(cycle));
    }

    /// Counts and records a frame.
    pub(super) fn take(&mut self, frame: &Frame, is_sent: bool) {
        self.tally.count(frame, is_sent);
        self.push(What::Frame { frame: *frame, is_sent });
    }

    fn push(&mut self, what: What) {
        if let Some(ring) = &mut self.ring
            && ring.push(Mark { at_ns: self.now_ns, what }).is_err()
        {
            self.tally.count_unrecorded();
        }
    }
}

/// Receiving end of the recorded frames.
#[derive(Debug)]
pub struct RecordedFrames {
    marks: Consumer<Mark>,
    /// Frames before the next cycle mark.
    before: Vec<(u64, Frame, bool)>,
    /// Number of the newest cycle that has begun, and the time of its beginning, in ns.
    begin: Option<(u64, u64)>,
}

impl FrameSource for RecordedFrames {
    fn kind(&self) -> FrameKind {
        CAPTURE
    }

    fn take(&mut self, cycle: u64, keep: &mut dyn FnMut(RecordedFrame<'_>)) {
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
            let offset_ns = begin.map_or(0, |(_, begin_ns)| at_ns.cast_signed().wrapping_sub(begin_ns.cast_signed()));
            keep(RecordedFrame { is_sent, offset_ns, bytes: &frame.to_capture() });
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

    fn taken(frames: &mut RecordedFrames, cycle: u64) -> Vec<(i64, u8, bool)> {
        let mut taken = Vec::new();
        frames.take(cycle, &mut |frame| taken.push((frame.offset_ns, frame.bytes[8], frame.is_sent)));
        taken
    }

    #[test]
    fn recorded_frames_are_assigned_to_cycles() {
        let mut tap = FrameRecorder::new(0);
        tap.take(&frame(9), true);
        let mut frames = tap.start_recording();
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

    /// Frames are lost and counted while the recorder is blocked. The frames after them have the beginning of their cycle as time if its
    /// mark was lost.
    #[test]
    fn what_has_no_room_is_counted() {
        let mut tap = FrameRecorder::new(0);
        let mut frames = tap.start_recording();
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

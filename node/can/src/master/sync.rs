//! SYNC message with its counter.
//!
//! Law      without an overflow value SYNC has no data; with one it counts from 1 to that value, and starts again at 1
//! Source   CiA 301, object 1019h

use crate::{Frame, Id};

/// Counter of SYNC messages.
#[derive(Clone, Copy, Debug)]
pub(super) struct SyncCounter {
    overflow: Option<u8>,
    counter: u8,
}

impl SyncCounter {
    pub(super) fn new(overflow: Option<u8>) -> Self {
        Self { overflow, counter: 0 }
    }

    /// Returns the next SYNC.
    pub(super) fn next(&mut self) -> Frame {
        let Some(overflow) = self.overflow else { return sync(&[]) };
        self.counter = if self.counter >= overflow { 1 } else { self.counter + 1 };
        sync(&[self.counter])
    }
}

fn sync(bytes: &[u8]) -> Frame {
    // SYNC has at most one byte.
    Frame::data(Id::SYNC, bytes).unwrap_or(Frame::of(Id::SYNC, [0; 8]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_counts_from_1_to_the_overflow_value() {
        let mut counter = SyncCounter::new(Some(3));
        let counted: Vec<_> = (0..5).map(|_| counter.next().bytes().to_vec()).collect();
        assert_eq!(counted, [[1], [2], [3], [1], [2]]);
        assert_eq!(SyncCounter::new(None).next(), Frame::data(Id::SYNC, &[]).unwrap());
    }
}

//! Send queue of a transport.
//!
//! Law      first in, first out; memory for a fixed number of elements is allocated at creation
//! Refuses  elements for which there is no room

use super::TransportError;
use std::collections::VecDeque;

/// Maximum number of queued frames.
pub(super) const ROOM: usize = 256;

/// Queue of a fixed size.
#[derive(Debug)]
pub(super) struct SendQueue<T>(VecDeque<T>);

impl<T> SendQueue<T> {
    pub(super) fn new() -> Self {
        Self(VecDeque::with_capacity(ROOM))
    }

    pub(super) fn push(&mut self, item: T) -> Result<(), TransportError> {
        if self.0.len() >= ROOM {
            return Err(TransportError::Full(self.0.len()));
        }
        self.0.push_back(item);
        Ok(())
    }

    pub(super) fn first(&self) -> Option<&T> {
        self.0.front()
    }

    pub(super) fn drop_first(&mut self) {
        self.0.pop_front();
    }

    pub(super) fn drop_all(&mut self) {
        self.0.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_queue_refuses_keeps_what_it_has_and_takes_no_memory() {
        let mut waiting = SendQueue::new();
        let room = waiting.0.capacity();
        for round in 0..3 {
            for number in 0..ROOM {
                waiting.push(number).unwrap();
            }
            let error = waiting.push(ROOM).unwrap_err();
            assert_eq!(error.to_string(), "the bus takes no more frames: 256 of them wait");
            for number in 0..ROOM {
                assert_eq!(waiting.first(), Some(&number), "round {round}");
                waiting.drop_first();
            }
        }
        assert_eq!((waiting.first(), waiting.0.capacity()), (None, room));
    }
}

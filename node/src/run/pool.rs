//! Objects that circulate between the cycle thread and another thread.
//!
//! All of them are created before the first cycle. The cycle thread fills a free one and sends it; the other thread
//! reads it and returns it. If none is free, the data is dropped and counted, so that the cycle thread neither waits
//! nor allocates.

use rtrb::{Consumer, Producer, RingBuffer};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Maximum number of objects that wait for the other thread:
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    /// those of this time, in ns,
    pub time_ns: u64,
    /// with at most this memory, in bytes,
    pub bytes: usize,
    /// but at least this number.
    pub least: usize,
}

impl Room {
    /// Returns the number for objects of this size, one per cycle.
    pub(super) fn count(self, cycle_ns: u64, bytes: usize) -> usize {
        let wanted = usize::try_from(self.time_ns / cycle_ns.max(1)).unwrap_or(usize::MAX);
        wanted.min(self.bytes / bytes.max(1)).max(self.least)
    }
}

/// End in the cycle thread.
#[derive(Debug)]
pub(super) struct PoolSender<T> {
    free: Consumer<Box<T>>,
    full: Producer<Box<T>>,
    lost: Arc<AtomicU64>,
}

/// End in the other thread.
#[derive(Debug)]
pub(super) struct PoolReceiver<T> {
    full: Consumer<Box<T>>,
    free: Producer<Box<T>>,
    lost: Arc<AtomicU64>,
}

/// Creates `count` objects that circulate.
pub(super) fn pool<T>(count: usize, make: impl Fn() -> T) -> (PoolSender<T>, PoolReceiver<T>) {
    let (mut free_in, free) = RingBuffer::new(count);
    (0..count).for_each(|_| drop(free_in.push(Box::new(make()))));
    let (full, full_out) = RingBuffer::new(count);
    let lost = Arc::<AtomicU64>::default();
    (PoolSender { free, full, lost: Arc::clone(&lost) }, PoolReceiver { full: full_out, free: free_in, lost })
}

impl<T> PoolSender<T> {
    /// Fills a free object and sends it.
    pub(super) fn send(&mut self, fill: impl FnOnce(&mut T)) {
        let Ok(mut thing) = self.free.pop() else { return self.leave_out() };
        fill(&mut thing);
        // There are no more objects than places, so it always fits.
        drop(self.full.push(thing));
    }

    /// Counts an object that is not sent.
    pub(super) fn leave_out(&mut self) {
        self.lost.fetch_add(1, Ordering::Relaxed);
    }
}

impl<T> PoolReceiver<T> {
    /// Returns the next object.
    pub(super) fn take(&mut self) -> Option<Box<T>> {
        self.full.pop().ok()
    }

    /// Returns an object for reuse.
    pub(super) fn give_back(&mut self, thing: Box<T>) {
        drop(self.free.push(thing));
    }

    /// Returns the number of dropped objects so far.
    pub(super) fn lost(&self) -> u64 {
        self.lost.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lost_items_are_counted_and_returned_items_are_reused() {
        let (mut filler, mut emptier) = pool(3, || 0);
        (1..=5).for_each(|number| filler.send(|thing| *thing = number));
        filler.leave_out();
        assert_eq!(emptier.lost(), 3);
        for round in 0..10 {
            let first = emptier.take().unwrap();
            assert_eq!(*first, if round < 3 { round + 1 } else { 10 + round - 3 });
            emptier.give_back(first);
            filler.send(|thing| *thing = 10 + round);
        }
        assert_eq!(emptier.lost(), 3);
        (0..3).for_each(|_| drop(emptier.take().unwrap()));
        assert!(emptier.take().is_none());
    }

    #[test]
    fn as_many_wait_as_the_time_has_cycles_within_the_memory_and_some_always() {
        let room = Room { time_ns: 1_000, bytes: 400, least: 8 };
        assert_eq!((room.count(10, 1), room.count(10, 10), room.count(10, 100)), (100, 40, 8));
        assert_eq!((room.count(1_000, 1), room.count(0, 0)), (8, 400));
    }
}

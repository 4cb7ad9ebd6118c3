//! A latched value: transient local with depth 1, so that whoever comes later gets the newest value and nothing else.
//!
//! The DDS library keeps old samples of a transient local writer for seconds, or for good when nobody reads it, and
//! sends all of them to a reader that comes later. So a writer that has written several is replaced, once the value
//! rests, by a new one that knows only the newest. Readers that are there already get that one twice.

use std::time::Duration;

use bytes::Bytes;
use tokio::runtime::Handle;
use tokio::sync::mpsc::{self, UnboundedReceiver, UnboundedSender};
use tokio::time::{sleep, timeout};

use super::dds::{WriteFailure, Writer};
use super::endpoint::Registered;

/// A value that has not changed for so long rests: the readers that were there have the samples before it.
const REST: Duration = Duration::from_millis(200);
/// Most samples of one writer, when the value never rests.
const MOST: usize = 16;
/// Between two tries to write, and the number of tries.
const AGAIN: Duration = Duration::from_millis(10);
const TRIES: usize = 200;

/// What a latched value is written with.
pub(super) trait Target: Send + Sync + 'static {
    fn write(&self, value: &Bytes) -> Result<(), WriteFailure>;
}

impl Target for Writer {
    fn write(&self, value: &Bytes) -> Result<(), WriteFailure> {
        Writer::write(self, value.clone())
    }
}

impl Target for Registered<Writer> {
    fn write(&self, value: &Bytes) -> Result<(), WriteFailure> {
        Writer::write(self, value.clone())
    }
}

/// Where to set the value. The writer goes when this goes.
pub(super) struct Latched {
    values: UnboundedSender<Bytes>,
}

impl Latched {
    /// Writes with `first`, and later with what `make` makes; `None`: there is no participant any more.
    /// Values that come within `gather` of each other are one; zero: each is written.
    pub(super) fn start<T: Target>(
        runtime: &Handle,
        gather: Duration,
        first: T,
        make: impl Fn() -> Option<T> + Send + 'static,
    ) -> Self {
        let (values, receiver) = mpsc::unbounded_channel();
        runtime.spawn(run(receiver, gather, first, make));
        Self { values }
    }

    /// Sets the value; never blocks.
    pub(super) fn set(&self, value: impl Into<Bytes>) {
        // The task ends only after this sender, or with the runtime.
        let _ = self.values.send(value.into());
    }
}

async fn run<T: Target>(
    mut values: UnboundedReceiver<Bytes>,
    gather: Duration,
    first: T,
    make: impl Fn() -> Option<T> + Send + 'static,
) {
    let (mut target, mut written, mut newest) = (first, 0, Bytes::new());
    loop {
        let rests = written > 1;
        let wait = if rests { REST } else { Duration::MAX };
        match timeout(wait, values.recv()).await {
            Ok(None) => return,
            Ok(Some(value)) => {
                newest = gathered(value, &mut values, gather).await;
                written += 1;
                write(&target, &newest).await;
                if written < MOST {
                    continue;
                }
            }
            Err(_) => {}
        }
        match make() {
            // Made before the old one goes, so that there is a publisher at any time.
            Some(fresh) => (target, written) = (fresh, 1),
            None => return,
        }
        write(&target, &newest).await;
    }
}

/// The newest of the values that come together.
async fn gathered(first: Bytes, values: &mut UnboundedReceiver<Bytes>, gather: Duration) -> Bytes {
    let mut newest = first;
    if !gather.is_zero() {
        sleep(gather).await;
        while let Ok(value) = values.try_recv() {
            newest = value;
        }
    }
    newest
}

async fn write<T: Target>(target: &T, value: &Bytes) {
    for _ in 0..TRIES {
        match target.write(value) {
            Ok(()) => return,
            Err(WriteFailure::Full) => sleep(AGAIN).await,
            Err(WriteFailure::Broken(reason)) => return tracing::error!("a latched value was not published: {reason}"),
        }
    }
    tracing::error!("a latched value was not published: no room for {:?}", AGAIN * TRIES as u32);
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, Mutex};

    use super::*;

    /// What each writer wrote, in the order in which they were made; and how many are there.
    #[derive(Clone, Default)]
    struct Log(Arc<Mutex<(Vec<Vec<u8>>, usize)>>);

    struct Fake {
        log: Log,
        index: usize,
    }

    impl Log {
        fn make(&self) -> Fake {
            let mut log = self.0.lock().unwrap();
            log.0.push(Vec::new());
            log.1 += 1;
            Fake { log: self.clone(), index: log.0.len() - 1 }
        }
    }

    impl Target for Fake {
        fn write(&self, value: &Bytes) -> Result<(), WriteFailure> {
            self.log.0.lock().unwrap().0[self.index].push(value[0]);
            Ok(())
        }
    }

    impl Drop for Fake {
        fn drop(&mut self) {
            self.log.0.lock().unwrap().1 -= 1;
        }
    }

    fn start(gather: Duration) -> (Latched, Log) {
        let log = Log::default();
        let make = log.clone();
        (Latched::start(&Handle::current(), gather, log.make(), move || Some(make.make())), log)
    }

    #[tokio::test(start_paused = true)]
    async fn once_it_rests_a_new_writer_knows_only_the_newest() {
        let (latched, log) = start(Duration::ZERO);
        for value in [1, 2, 3] {
            latched.set(vec![value]);
        }
        sleep(REST * 3).await;
        assert_eq!(*log.0.lock().unwrap(), (vec![vec![1, 2, 3], vec![3]], 1));
        latched.set(vec![4]);
        sleep(REST * 3).await;
        assert_eq!(*log.0.lock().unwrap(), (vec![vec![1, 2, 3], vec![3, 4], vec![4]], 1));
    }

    #[tokio::test(start_paused = true)]
    async fn values_that_come_together_are_one() {
        let (latched, log) = start(Duration::from_millis(10));
        latched.set(vec![1]);
        latched.set(vec![2]);
        sleep(REST * 3).await;
        assert_eq!(log.0.lock().unwrap().0, [vec![2]], "and a single value needs no new writer");
    }

    #[tokio::test(start_paused = true)]
    async fn a_restless_value_gets_a_new_writer_too_and_all_end_with_the_owner() {
        let (latched, log) = start(Duration::ZERO);
        for _ in 0..=MOST {
            latched.set(vec![7]);
        }
        sleep(AGAIN).await;
        assert_eq!(log.0.lock().unwrap().0.iter().map(Vec::len).collect::<Vec<_>>(), [MOST, 2]);
        drop(latched);
        sleep(AGAIN).await;
        assert_eq!(log.0.lock().unwrap().1, 0);
    }
}

//! Writes a bag in its own thread, so that a slow disk delays nothing else.

use super::spawn;
use crate::recording::Encoded;
use crate::recording::bag::{Bag, BagError, BagOptions, Subject, Summary};
use lineshaft_msgs::srv::RecordResponse;
use lineshaft_ros::layer::TappedMessage;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use tokio::sync::oneshot;

/// Maximum number of bytes that wait for the disk.
const MOST_WAITING: usize = 256 << 20;

#[derive(Debug)]
enum Job {
    Cycle(Arc<Encoded>),
    Lost(u64),
    Late(Vec<TappedMessage>),
}

/// Reason why a bag is incomplete.
#[derive(Debug)]
pub enum Failure {
    /// The bag was never begun; the client got the reason.
    NotBegun(String),
    /// The bag could not be completed.
    Broken(BagError),
}

/// Status of a bag while it is written.
#[derive(Debug, Default)]
struct Progress {
    waiting: AtomicUsize,
    size: AtomicU64,
}

/// A bag that is being written.
#[derive(Debug)]
pub struct Writer {
    jobs: Sender<Job>,
    thread: JoinHandle<Result<Summary, Failure>>,
    progress: Arc<Progress>,
    /// Name of the bag.
    pub path: String,
    /// Number of cycles passed to it.
    pub cycles: u64,
    /// Number of cycles missing in it.
    pub lost: u64,
    /// Maximum number of bytes that wait for the disk.
    room: usize,
    /// Whether it waits for a cycle with all signals, because cycles were dropped.
    waits_for_key: bool,
}

impl Writer {
    /// Continues with an existing bag.
    pub fn of(bag: Bag) -> Self {
        let path = bag.path().display().to_string();
        Self::start(path, move || Ok(bag))
    }

    /// Creates a bag that begins with cycle `first`; the answer reports whether it was created.
    pub fn begin(options: BagOptions, subject: Subject, first: u64, answer: oneshot::Sender<RecordResponse>) -> Self {
        let path = options.path.display().to_string();
        let of_answer = path.clone();
        Self::start(path, move || {
            let made = Bag::create(&options, subject).map_err(|error| error.to_string());
            let (success, message) = match &made {
                Ok(_) => (true, format!("recording from cycle {first} on")),
                Err(sentence) => (false, sentence.clone()),
            };
            tracing::info!("{message}: {of_answer}");
            let (recording, replayable) = (success, success);
            let path = of_answer;
            let response =
                RecordResponse { success, message, recording, path, replayable, ..RecordResponse::default() };
            // The caller may have gone.
            let _ = answer.send(response);
            made.map_err(Failure::NotBegun)
        })
    }

    fn start(path: String, make: impl FnOnce() -> Result<Bag, Failure> + Send + 'static) -> Self {
        let (jobs, todo) = channel();
        let progress = Arc::new(Progress::default());
        let of_thread = Arc::clone(&progress);
        let thread = spawn("bag", move || write(make()?, &todo, &of_thread).map_err(Failure::Broken));
        Self { jobs, thread, progress, path, cycles: 0, lost: 0, room: MOST_WAITING, waits_for_key: false }
    }

    /// Passes on a cycle; returns false if it was dropped because the disk is too slow.
    pub fn push(&mut self, cycle: &Arc<Encoded>) -> bool {
        let waiting = self.progress.waiting.load(Ordering::Relaxed);
        if waiting + cycle.memory() > self.room || (self.waits_for_key && !cycle.is_key) {
            self.waits_for_key = true;
            self.lose(1);
            return false;
        }
        self.waits_for_key = false;
        self.progress.waiting.fetch_add(cycle.memory(), Ordering::Relaxed);
        self.cycles += 1;
        // A thread that has failed is detected by `is_over`.
        let _ = self.jobs.send(Job::Cycle(Arc::clone(cycle)));
        true
    }

    /// Reports cycles that never arrived.
    pub fn lose(&mut self, cycles: u64) {
        self.lost += cycles;
        let _ = self.jobs.send(Job::Lost(cycles));
    }

    /// Passes on messages that the node published after the last cycle.
    pub fn push_late(&self, messages: Vec<TappedMessage>) {
        let _ = self.jobs.send(Job::Late(messages));
    }

    /// Returns the number of bytes on the disk so far.
    pub fn size(&self) -> u64 {
        self.progress.size.load(Ordering::Relaxed)
    }

    /// Returns true if the writer has ended by itself, because of an error.
    pub fn is_over(&self) -> bool {
        self.thread.is_finished()
    }

    /// Finishes the bag; waits for the disk.
    ///
    /// # Errors
    /// Returns the reason why it could not be completed.
    pub fn finish(self) -> Result<Summary, Failure> {
        drop(self.jobs);
        match self.thread.join() {
            Ok(result) => result,
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }
}

fn write(mut bag: Bag, todo: &Receiver<Job>, progress: &Progress) -> Result<Summary, BagError> {
    for job in todo {
        match job {
            Job::Cycle(cycle) => {
                bag.write(&cycle)?;
                progress.waiting.fetch_sub(cycle.memory(), Ordering::Relaxed);
                progress.size.store(bag.size(), Ordering::Relaxed);
            }
            Job::Lost(cycles) => bag.note_lost(cycles),
            Job::Late(messages) => bag.add_late(messages),
        }
    }
    bag.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::Cell;
    use crate::recording::rig;

    /// Cycles after dropped ones contain only changes relative to them, so they are useless until the next key cycle.
    #[test]
    fn after_a_slow_disk_the_bag_continues_with_a_key_cycle() {
        let folder = tempfile::tempdir().unwrap();
        let cell = Cell::demo();
        let options = BagOptions { path: folder.path().join("a.mcap"), ..BagOptions::default() };
        let bag = Bag::create(&options, Subject::new(&cell, &cell.ros.node_name())).unwrap();
        let mut writer = Writer::of(bag);
        let cycles: Vec<_> = rig::record(&cell, rig::MOVING, 2100, 0).encoded.into_iter().map(Arc::new).collect();
        let push = |writer: &mut Writer, range: std::ops::Range<usize>| {
            cycles[range].iter().filter(|cycle| writer.push(cycle)).map(|cycle| cycle.cycle).collect::<Vec<_>>()
        };
        assert_eq!(push(&mut writer, 0..500).len(), 500);
        writer.room = 0;
        assert!(push(&mut writer, 500..600).is_empty());
        writer.room = MOST_WAITING;
        assert_eq!(push(&mut writer, 600..2100).first(), Some(&1000));
        assert_eq!((writer.cycles, writer.lost), (1600, 500));
        let summary = writer.finish().unwrap();
        assert_eq!((summary.cycles, summary.lost, summary.replayable), (1600, 500, false));
    }
}

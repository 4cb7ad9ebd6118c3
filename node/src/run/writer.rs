//! A bag that is being written, on a thread of its own: a disk that stands still for seconds holds up nothing but it.

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

/// Bytes that may wait for the disk.
const MOST_WAITING: usize = 256 << 20;

#[derive(Debug)]
enum Job {
    Cycle(Arc<Encoded>),
    Lost(u64),
    Late(Vec<TappedMessage>),
}

/// Why a bag has no good end.
#[derive(Debug)]
pub enum Failure {
    /// The bag was never begun; whoever asked for it was told why.
    NotBegun(String),
    /// The bag could not be written to its end.
    Broken(BagError),
}

/// What is known of a bag while it is written.
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
    /// Cycles that were given to it.
    pub cycles: u64,
    /// Cycles that are missing in it.
    pub lost: u64,
    /// Bytes that may wait for the disk.
    room: usize,
    /// After cycles were left out it goes on with a cycle that holds all signals.
    waits_for_key: bool,
}

impl Writer {
    /// Goes on with a bag that was made.
    pub fn of(bag: Bag) -> Self {
        let path = bag.path().display().to_string();
        Self::start(path, move || Ok(bag))
    }

    /// Makes a bag that begins with cycle `first`, and answers whether it could be made.
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
            // Whoever asked may have gone.
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

    /// Gives it a cycle; false when it was left out because the disk does not keep up.
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
        // A thread that has failed is noticed by `is_over`.
        let _ = self.jobs.send(Job::Cycle(Arc::clone(cycle)));
        true
    }

    /// Tells it of cycles that never arrived.
    pub fn lose(&mut self, cycles: u64) {
        self.lost += cycles;
        let _ = self.jobs.send(Job::Lost(cycles));
    }

    /// Gives it the messages that the node has published after the last cycle.
    pub fn push_late(&self, messages: Vec<TappedMessage>) {
        let _ = self.jobs.send(Job::Late(messages));
    }

    /// Bytes on the disk so far.
    pub fn size(&self) -> u64 {
        self.progress.size.load(Ordering::Relaxed)
    }

    /// Has the writer ended by itself? Then it has failed.
    pub fn is_over(&self) -> bool {
        self.thread.is_finished()
    }

    /// Ends the bag; waits for the disk.
    ///
    /// # Errors
    /// Why it could not be written to its end.
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

    /// What comes after cycles that were left out is told by changes against them: it is of use only from a whole set on.
    #[test]
    fn after_a_disk_that_did_not_keep_up_it_goes_on_with_a_key_cycle() {
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

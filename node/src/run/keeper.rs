//! Writes layer User of the parameters into the store, in a separate thread. Only clients that request a confirmation
//! wait for it.

use crate::store::{Store, StoreError};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::parameter::ParameterImage;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use tokio::sync::oneshot;

/// Receiver of the result, if any.
type Answer = Option<oneshot::Sender<Result<(), String>>>;

enum Order {
    Keep(Arc<ParameterImage>, Answer),
    End,
}

/// Sends requests to the keeper. It never blocks.
#[derive(Debug)]
pub struct StoreRequests(Sender<Order>);

impl StoreRequests {
    /// Requests that layer User of these parameters is written, unless newer ones are waiting already. The answer comes
    /// when these or newer ones are on the disk, or with the reason why they are not.
    pub fn keep(&self, image: Arc<ParameterImage>, answer: Answer) {
        // If the keeper has ended, it drops the answer, which the caller sees as an error.
        let _ = self.0.send(Order::Keep(image, answer));
    }

    /// Ends the keeper after it has written its pending data.
    pub fn end(&self) {
        let _ = self.0.send(Order::End);
    }
}

/// The thread of the keeper.
pub struct StoreWriter {
    store: Store,
    config: MachineConfig,
    orders: Receiver<Order>,
    newest: Option<Arc<ParameterImage>>,
    /// Message of the last failure: one cause is logged once.
    told: Option<String>,
}

impl StoreWriter {
    /// Creates a keeper and its request queue. `config` is that of the machine.
    pub fn new(store: Store, config: MachineConfig) -> (StoreRequests, Self) {
        let (send, orders) = channel();
        (StoreRequests(send), Self { store, config, orders, newest: None, told: None })
    }

    /// Runs until [`StoreRequests::end`], or until all senders are gone.
    pub fn run(mut self) {
        let mut goes_on = true;
        while goes_on {
            let Ok(first) = self.orders.recv() else { break };
            // Requests that came in between are written together, because only the newest set counts.
            let orders: Vec<_> = std::iter::once(first).chain(self.orders.try_iter()).collect();
            let mut answers = Vec::new();
            for order in orders {
                match order {
                    Order::Keep(image, answer) => {
                        self.take(image);
                        answers.extend(answer);
                    }
                    Order::End => goes_on = false,
                }
            }
            let kept = self.write();
            for answer in answers {
                // The caller may have gone.
                let _ = answer.send(kept.clone());
            }
        }
    }

    fn take(&mut self, image: Arc<ParameterImage>) {
        let is_newer = |known: &Arc<ParameterImage>| image.version.wrapping_sub(known.version).cast_signed() >= 0;
        if self.newest.as_ref().is_none_or(is_newer) {
            self.newest = Some(image);
        }
    }

    fn write(&mut self) -> Result<(), String> {
        let Some(image) = &self.newest else { return Ok(()) };
        let kept = self.store.keep_all(&self.config, &image.user, &image.machine[1]);
        match &kept {
            Ok(is_new) => {
                if *is_new {
                    let (path, generation) = (self.store.path().display(), self.store.generation());
                    tracing::info!("{path}: parameters are saved; generation {generation}");
                }
                self.told = None;
            }
            Err(error) => self.tell(error),
        }
        kept.map(drop).map_err(|error| error.to_string())
    }

    fn tell(&mut self, error: &StoreError) {
        let sentence = error.to_string();
        if self.told.as_ref() != Some(&sentence) {
            tracing::error!("{sentence}");
            self.told = Some(sentence);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::Cell;
    use std::path::Path;
    use tempfile::TempDir;

    /// A running keeper, and the data that a machine would send.
    struct Rig {
        folder: TempDir,
        orders: StoreRequests,
        thread: std::thread::JoinHandle<()>,
        image: ParameterImage,
    }

    impl Rig {
        fn new() -> Self {
            let folder = tempfile::tempdir().expect("a folder");
            let config = Cell::demo().machine;
            let image = lineshaft_core::machine::Machine::new(config.clone()).expect("the demo").parameter_image();
            let store = Store::open(&folder.path().join("p.yaml")).expect("a new store");
            let (orders, keeper) = StoreWriter::new(store, config);
            Self { folder, orders, thread: std::thread::spawn(move || keeper.run()), image }
        }

        fn save(&mut self, time: i64) -> Arc<ParameterImage> {
            self.image.version += 1;
            self.image.user[1].following_error_time = time;
            Arc::new(self.image.clone())
        }

        fn ask(&self, image: Arc<ParameterImage>) -> Result<(), String> {
            let (answer, answered) = oneshot::channel();
            self.orders.keep(image, Some(answer));
            answered.blocking_recv().expect("the keeper runs")
        }

        fn path(&self) -> std::path::PathBuf {
            self.folder.path().join("p.yaml")
        }
    }

    fn saved(path: &Path) -> Option<i64> {
        let mut config = Cell::demo().machine;
        Store::open_read_only_if_used(path).and_then(|store| store.load(&mut config)).expect("a good store");
        config.axes[1].saved.map(|saved| saved.following_error_time)
    }

    /// Proves: MACS-STO-06
    #[test]
    fn answer_is_sent_after_the_set_is_on_the_disk() {
        let mut rig = Rig::new();
        let image = rig.save(5_000_000);
        assert_eq!(rig.ask(image), Ok(()));
        assert_eq!(saved(&rig.path()), Some(5_000_000));
    }

    #[test]
    fn an_older_set_never_takes_the_place_of_a_newer_one() {
        let mut rig = Rig::new();
        let (old, new) = (rig.save(1_000_000), rig.save(2_000_000));
        assert_eq!((rig.ask(new), rig.ask(old)), (Ok(()), Ok(())));
        assert_eq!(saved(&rig.path()), Some(2_000_000));
    }

    #[test]
    fn end_follows_all_requests() {
        let mut rig = Rig::new();
        for time in 1..=50 {
            let image = rig.save(time * 1_000_000);
            rig.orders.keep(image, None);
        }
        rig.orders.end();
        rig.thread.join().unwrap();
        assert_eq!(saved(&rig.folder.path().join("p.yaml")), Some(50_000_000));
        // A request after the end gets an error.
        let (answer, answered) = oneshot::channel();
        rig.orders.keep(Arc::new(rig.image), Some(answer));
        assert!(answered.blocking_recv().is_err());
    }

    #[test]
    fn what_could_not_be_written_is_answered_and_written_later() {
        let mut rig = Rig::new();
        let image = rig.save(1_000_000);
        assert_eq!(rig.ask(image), Ok(()));
        // A folder blocks the temporary file of the new text.
        let way = rig.folder.path().join(".p.yaml.new");
        std::fs::create_dir(&way).unwrap();
        let image = rig.save(2_000_000);
        let sentence = rig.ask(image).unwrap_err();
        assert!(sentence.contains("p.yaml: parameters cannot be written: "), "{sentence}");
        assert_eq!(saved(&rig.path()), Some(1_000_000));
        std::fs::remove_dir(&way).unwrap();
        rig.orders.end();
        rig.thread.join().unwrap();
        assert_eq!(saved(&rig.folder.path().join("p.yaml")), Some(2_000_000));
    }
}

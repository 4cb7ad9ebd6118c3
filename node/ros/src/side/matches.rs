//! Matches between remote readers and our writers.

use std::collections::HashSet;
use std::sync::{Mutex, MutexGuard, PoisonError};

use tokio::sync::watch;

use super::dds::Discovery;
use super::guid::Guid;

/// Pairs of one of our writers and a remote reader.
type Pairs = HashSet<(Guid, Guid)>;

/// All matches of the participant.
pub(super) struct Matches {
    pairs: watch::Sender<Pairs>,
    /// Matched best-effort readers, which send no acknowledgements.
    best_effort: Mutex<HashSet<Guid>>,
}

impl Matches {
    pub(super) fn new() -> Self {
        Self { pairs: watch::Sender::new(Pairs::new()), best_effort: Mutex::default() }
    }

    fn all_best_effort(&self) -> MutexGuard<'_, HashSet<Guid>> {
        self.best_effort.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Records that a reader is best-effort, and sends no acknowledgements.
    pub(super) fn note_best_effort(&self, reader: Guid) {
        self.all_best_effort().insert(reader);
    }

    /// Returns the best-effort readers of this writer, which send no acknowledgements.
    pub(super) fn best_effort(&self, writer: Guid) -> Vec<Guid> {
        let all = self.all_best_effort();
        self.pairs
            .borrow()
            .iter()
            .filter(|(one, reader)| *one == writer && all.contains(reader))
            .map(|pair| pair.1)
            .collect()
    }

    /// Records a change of the discovery.
    pub(super) fn note(&self, change: Discovery) {
        match change {
            Discovery::Lost { reader } => drop(self.all_best_effort().remove(&reader)),
            Discovery::Gone { participant, .. } => {
                self.all_best_effort().retain(|reader| reader.prefix() != participant);
            }
            _ => {}
        }
        self.pairs.send_modify(|pairs| match change {
            Discovery::Matched { writer, reader } => {
                pairs.insert((writer, reader));
            }
            Discovery::Lost { reader } => pairs.retain(|pair| pair.1 != reader),
            Discovery::Gone { participant, .. } => pairs.retain(|pair| pair.1.prefix() != participant),
            Discovery::Heard { .. } | Discovery::Silent { .. } | Discovery::Found { .. } => {}
        });
    }

    /// Removes a writer that was dropped.
    pub(super) fn forget(&self, writer: Guid) {
        self.pairs.send_modify(|pairs| pairs.retain(|pair| pair.0 != writer));
    }

    /// Returns the number of readers that are matched with this writer now.
    pub(super) fn count(&self, writer: Guid) -> usize {
        self.pairs.borrow().iter().filter(|pair| pair.0 == writer).count()
    }

    /// Returns the readers that are matched with this writer now.
    pub(super) fn readers(&self, writer: Guid) -> HashSet<Guid> {
        self.pairs.borrow().iter().filter(|pair| pair.0 == writer).map(|pair| pair.1).collect()
    }

    /// Whether the two are matched now.
    pub(super) fn contains(&self, writer: Guid, reader: Guid) -> bool {
        self.pairs.borrow().contains(&(writer, reader))
    }

    /// Whether this reader is matched now.
    pub(super) fn has(&self, reader: Guid) -> bool {
        self.pairs.borrow().iter().any(|pair| pair.1 == reader)
    }

    /// Subscribes to the changes from now on.
    pub(super) fn changes(&self) -> watch::Receiver<Pairs> {
        self.pairs.subscribe()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matches_end_with_the_reader_its_participant_or_our_writer() {
        let guid = |participant, endpoint| {
            let mut bytes = [participant; 16];
            bytes[12..].copy_from_slice(&[0, 0, endpoint, 4]);
            Guid(bytes)
        };
        let (writer, other) = (guid(1, 1), guid(1, 2));
        let readers = [guid(7, 1), guid(7, 2), guid(8, 1)];
        let matches = Matches::new();
        for reader in readers {
            matches.note(Discovery::Matched { writer, reader });
            matches.note(Discovery::Matched { writer: other, reader });
        }
        assert_eq!(matches.count(writer), 3);
        matches.note_best_effort(readers[0]);
        matches.note_best_effort(readers[2]);
        assert_eq!(HashSet::from_iter(matches.best_effort(writer)), HashSet::from([readers[0], readers[2]]));
        matches.note(Discovery::Lost { reader: readers[0] });
        assert!(!matches.contains(writer, readers[0]) && matches.contains(writer, readers[1]));
        assert_eq!(matches.best_effort(writer), [readers[2]]);
        matches.note(Discovery::Gone { participant: readers[1].prefix(), is_silent: true });
        assert_eq!(matches.count(writer), 1);
        matches.forget(writer);
        assert_eq!((matches.count(writer), matches.count(other)), (0, 1));
    }
}

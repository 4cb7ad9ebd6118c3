//! Replies, each to the one reader that waits for it.

use std::collections::HashMap;
use std::future::Future;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use bytes::Bytes;
use tokio::time::{Instant, sleep_until, timeout_at};

use super::ReplyError;
use super::caller::{Caller, Place};
use crate::layer::dds::{Address, WriteFailure, Writer};
use crate::layer::endpoint::{Context, Registered};
use crate::layer::guid::Guid;
use crate::layer::limiter::{Limiter, more};
use crate::layer::name::FullName;

/// Longest time for which a reply waits for its reader to be matched, and then for room.
const PATIENCE: Duration = Duration::from_secs(1);
/// Between two tries to write.
const AGAIN: Duration = Duration::from_millis(5);
/// Clients whose readers are remembered; more are looked up again.
const KNOWN: usize = 256;

/// Writes the replies of one service.
pub(super) struct Replies {
    writer: Registered<Writer>,
    service: FullName,
    topic: String,
    context: Context,
    /// The reader of a client that writes with this writer, where a search has found exactly one.
    known: Mutex<HashMap<Guid, Guid>>,
    failed: Mutex<Limiter>,
}

impl Replies {
    pub(super) fn new(context: &Context, writer: Registered<Writer>, service: FullName) -> Self {
        Self {
            writer,
            topic: service.reply(),
            service,
            context: context.clone(),
            known: Mutex::default(),
            failed: Mutex::default(),
        }
    }

    pub(super) fn service(&self) -> &FullName {
        &self.service
    }

    pub(super) fn spawn(&self, task: impl Future<Output = ()> + Send + 'static) {
        self.context.runtime.spawn(task);
    }

    /// Writes a reply as soon as its reader is matched: one that is written before is lost. What fails is logged: a client that
    /// waits for ever does not say why.
    pub(super) async fn send(&self, caller: &Caller, bytes: Vec<u8>) -> Result<(), ReplyError> {
        let (bytes, deadline) = (Bytes::from(bytes), Instant::now() + PATIENCE);
        let mut changes = self.context.matches.changes();
        let readers = loop {
            changes.mark_unchanged();
            let found = self.readers(caller.place);
            if found.complete {
                break found.matched;
            }
            let change = timeout_at(deadline, changes.changed()).await;
            if !matches!(change, Ok(Ok(()))) {
                break found.matched;
            }
        };
        if readers.is_empty() {
            let error = ReplyError::NoReader { service: self.service.clone() };
            // A client that has gone waits for nothing.
            tracing::debug!("{error}");
            return Err(error);
        }
        for reader in readers {
            let written = self.write(&bytes, Address { reader, answers: caller.identity() }).await;
            written.inspect_err(|error| self.tell(error, reader))?;
        }
        Ok(())
    }

    async fn write(&self, bytes: &Bytes, address: Address) -> Result<(), ReplyError> {
        if address.answers.is_some() && bytes.len() > self.writer.longest_identified() {
            let (service, length) = (self.service.clone(), bytes.len());
            return Err(ReplyError::TooLong { service, length, longest: self.writer.longest_identified() });
        }
        let deadline = Instant::now() + PATIENCE;
        let service = || self.service.clone();
        loop {
            match self.writer.write_to(bytes.clone(), address) {
                Ok(()) => return Ok(()),
                Err(WriteFailure::Broken(reason)) => return Err(ReplyError::Dds { service: service(), reason }),
                Err(WriteFailure::Full) if Instant::now() >= deadline => {
                    return Err(ReplyError::Full { service: service() });
                }
                Err(WriteFailure::Full) => sleep_until(Instant::now() + AGAIN).await,
            }
        }
    }

    /// A line for the operator, few of them about one client.
    fn tell(&self, error: &ReplyError, reader: Guid) {
        let from = reader.prefix();
        let said = self.failed.lock().unwrap_or_else(PoisonError::into_inner).say(from, std::time::Instant::now());
        if let Some(before) = said {
            tracing::warn!("{error} (participant {from}){}", more(before));
        }
    }

    fn is_matched(&self, reader: Guid) -> bool {
        self.context.matches.contains(self.writer.guid(), reader)
    }

    fn readers(&self, place: Place) -> Found {
        let client = match place {
            Place::Reader(reader) => return Found::of(vec![reader], |reader| self.is_matched(reader)),
            Place::Beside(client) => client,
        };
        let known = |find: &dyn Fn(&mut HashMap<Guid, Guid>) -> Option<Guid>| {
            find(&mut self.known.lock().unwrap_or_else(PoisonError::into_inner))
        };
        if let Some(reader) = known(&|known| known.get(&client).copied()).filter(|reader| self.is_matched(*reader)) {
            return Found { matched: vec![reader], complete: true };
        }
        let Some(participant) = self.context.participant.upgrade() else {
            return Found { matched: Vec::new(), complete: true };
        };
        let found = Found::of(participant.readers_beside(client, &self.topic), |reader| self.is_matched(reader));
        if let (true, [reader]) = (found.complete, found.matched.as_slice()) {
            known(&|known| {
                if known.len() >= KNOWN {
                    known.retain(|_, reader| self.is_matched(*reader));
                }
                if known.len() < KNOWN { known.insert(client, *reader) } else { None }
            });
        }
        found
    }
}

/// Readers that may be the client's.
struct Found {
    matched: Vec<Guid>,
    /// There are some, and all are matched.
    complete: bool,
}

impl Found {
    fn of(candidates: Vec<Guid>, is_matched: impl Fn(Guid) -> bool) -> Self {
        let count = candidates.len();
        let matched: Vec<_> = candidates.into_iter().filter(|reader| is_matched(*reader)).collect();
        Self { complete: count > 0 && matched.len() == count, matched }
    }
}

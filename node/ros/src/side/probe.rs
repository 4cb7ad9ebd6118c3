//! Does the DDS library still work?
//!
//! Law      its event loop takes a sample and sends it (`Barrier`), at each probe; and every few seconds a participant that we play
//!          announces itself on its socket of discovery, which both of its threads have to see before it is reported, and says
//!          good-bye again; both are said three times where they are not seen, as a datagram may get lost. A process of its own
//!          looks at each probe whether the threads are there at all

use std::sync::Mutex;
use std::sync::PoisonError;
use std::time::{Duration, Instant};

use tokio::sync::watch;

use super::dds::{Barrier, DdsError, Participant};
use super::member::Shared;
use super::spdp::{self, BARE, Played};
use crate::link::guid::Prefix;

/// Between two announcements: each makes the library announce itself to all.
const ANNOUNCEMENTS: Duration = Duration::from_secs(5);
/// How long an announcement may take until it is said again, and how often it is said.
const PATIENCE: Duration = Duration::from_millis(100);
const TRIES: u32 = 3;
/// Of the participant that we play; longer than it ever lives.
const LEASE_S: i32 = 600;

/// Probes of one participant.
pub(super) struct Probe {
    barrier: Barrier,
    /// The participant that we play.
    player: Prefix,
    /// How often it was found, and how often it was lost.
    seen: watch::Sender<(u64, u64)>,
    turn: Mutex<Turn>,
}

struct Turn {
    next: Instant,
    sequence: i64,
}

impl Probe {
    pub(super) fn new(participant: &Participant) -> Result<Self, DdsError> {
        let own = participant.guid().prefix();
        let mut player = own;
        // Of the same vendor; of nobody else.
        player.0[2..].iter_mut().for_each(|byte| *byte ^= 0x5a);
        let turn = Mutex::new(Turn { next: Instant::now(), sequence: 1 });
        Ok(Self { barrier: participant.barrier()?, player, seen: watch::Sender::default(), turn })
    }

    /// The library has found a participant.
    pub(super) fn found(&self, participant: Prefix) {
        if participant == self.player {
            self.seen.send_modify(|(found, _)| *found += 1);
        }
    }

    /// The library has lost one.
    pub(super) fn gone(&self, participant: Prefix) {
        if participant == self.player {
            self.seen.send_modify(|(_, lost)| *lost += 1);
        }
    }

    /// Tries; what does not work otherwise.
    pub(super) async fn try_it(&self, shared: &Shared) -> Result<(), &'static str> {
        if !self.barrier.pass().await {
            return Err("the event loop of its DDS library takes nothing");
        }
        if !self.discovers(shared).await {
            return Err("the discovery of its DDS library does not see who comes and goes");
        }
        Ok(())
    }

    async fn discovers(&self, shared: &Shared) -> bool {
        let mut sequence = {
            let mut turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
            if Instant::now() < turn.next {
                return true;
            }
            turn.next = Instant::now() + ANNOUNCEMENTS;
            turn.sequence += 2 * i64::from(TRIES);
            turn.sequence
        };
        let (socket, to) = (&shared.socket, shared.participant.discovery_address());
        let before = *self.seen.borrow();
        let addresses = [socket.address()];
        let player = Played { who: self.player, addresses: &addresses, builtin: BARE, lease_s: LEASE_S };
        for _ in 0..TRIES {
            socket.send(&player.announced(sequence), to);
            let is_found = self.comes(|(found, _)| found > before.0).await;
            socket.send(&spdp::disposal(self.player, None, sequence + 1), to);
            if self.comes(|(_, lost)| lost > before.1).await && is_found {
                return true;
            }
            sequence += 2;
        }
        false
    }

    async fn comes(&self, is_it: impl Fn((u64, u64)) -> bool) -> bool {
        let mut changes = self.seen.subscribe();
        let comes = changes.wait_for(|seen| is_it(*seen));
        matches!(tokio::time::timeout(PATIENCE, comes).await, Ok(Ok(_)))
    }
}

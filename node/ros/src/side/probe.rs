//! Does the DDS library still work?
//!
//! Law      its event loop takes a sample and sends it (`Barrier`), at each probe; and every few seconds a participant that we play
//!          announces itself on its socket of discovery, which both of its threads have to see before it is reported, and says
//!          good-bye again. A process of its own looks at each probe whether the threads are there at all

use std::sync::Mutex;
use std::sync::PoisonError;
use std::time::{Duration, Instant};

use tokio::sync::watch;

use super::dds::{Barrier, DdsError, Participant};
use super::member::Shared;
use super::spdp;
use crate::link::guid::Prefix;

/// Between two announcements: each makes the library announce itself to all.
const ANNOUNCEMENTS: Duration = Duration::from_secs(5);
/// How long an announcement may take until it is reported.
const PATIENCE: Duration = Duration::from_millis(800);
/// Of the participant that we play; longer than it ever lives.
const LEASE_S: i32 = 600;

/// Probes of one participant.
pub(super) struct Probe {
    barrier: Barrier,
    /// The participant that we play.
    player: Prefix,
    /// Whether it is known now.
    is_known: watch::Sender<bool>,
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
        Ok(Self { barrier: participant.barrier()?, player, is_known: watch::Sender::new(false), turn })
    }

    /// The library has found a participant.
    pub(super) fn found(&self, participant: Prefix) {
        if participant == self.player {
            self.is_known.send_replace(true);
        }
    }

    /// The library has lost one.
    pub(super) fn gone(&self, participant: Prefix) {
        if participant == self.player {
            self.is_known.send_replace(false);
        }
    }

    /// Tries.
    pub(super) async fn works(&self, shared: &Shared) -> bool {
        self.barrier.pass().await && self.discovers(shared).await
    }

    async fn discovers(&self, shared: &Shared) -> bool {
        let sequence = {
            let mut turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
            if Instant::now() < turn.next {
                return true;
            }
            turn.next = Instant::now() + ANNOUNCEMENTS;
            turn.sequence += 2;
            turn.sequence
        };
        let (beside, to) = (&shared.beside, shared.participant.discovery_address());
        beside.send(&spdp::announced(self.player, beside.address(), sequence, LEASE_S), to);
        let is_found = self.comes(true).await;
        beside.send(&spdp::farewell(self.player, sequence + 1), to);
        is_found && self.comes(false).await
    }

    async fn comes(&self, wanted: bool) -> bool {
        let mut changes = self.is_known.subscribe();
        let comes = changes.wait_for(|is_known| *is_known == wanted);
        matches!(tokio::time::timeout(PATIENCE, comes).await, Ok(Ok(_)))
    }
}

//! Checks whether the DDS library still works.
//!
//! Law      at each probe, its event loop must take a sample and send it (`Barrier`). Every 5 s a simulated participant announces itself on
//!          the discovery socket of the library, and is disposed again. Both threads of the library have to handle an announcement before
//!          the library reports it. While the library cannot handle announcements, because the system clock was set back, they are left
//!          out: for as long as it was set back, or for at most [`SUCCESSION`] if another side is about to take over. If the library does
//!          not report them, both datagrams are sent up to three times, because a datagram may get lost

use std::sync::Mutex;
use std::sync::PoisonError;
use std::time::{Duration, Instant};

use tokio::sync::watch;

use super::dds::{Barrier, DdsError, Participant};
use super::guid::Prefix;
use super::member::Shared;
use super::spdp::{self, BARE, SimulatedParticipant};
use crate::offset::{SET_BACK_NS, SetBack};

/// Time between two announcements. At each of them the library announces itself to all participants.
const ANNOUNCEMENTS: Duration = Duration::from_secs(5);
/// Time after which an announcement is repeated, and the maximum number of attempts.
const PATIENCE: Duration = Duration::from_millis(100);
const TRIES: u32 = 3;
/// Maximum time for which the library may discover no participants after the system clock was set back.
const SUCCESSION: Duration = Duration::from_secs(30);
/// A smaller step back, in ns, does not stop the discovery of the library.
const SMALL_STEP_NS: i64 = 10_000_000;
/// Lease of the simulated participant in seconds; longer than it ever exists.
const LEASE_S: i32 = 600;

/// Probes of one participant.
pub(super) struct Probe {
    barrier: Barrier,
    /// Prefix of the simulated participant.
    simulated_participant: Prefix,
    /// How often the library has discovered it, and how often the library has lost it.
    seen: watch::Sender<(u64, u64)>,
    turn: Mutex<Turn>,
}

struct Turn {
    next: Instant,
    sequence: i64,
    set_back: SetBack,
    /// Time when a step back of the clock was detected, and its size in ns.
    deaf: Option<(Instant, i64)>,
}

impl Turn {
    /// Returns true if the library discovers nothing because the clock was set back, and is still allowed to.
    fn is_failure_expected(&mut self) -> bool {
        let by_ns = self.set_back.by_ns();
        if self.deaf.map_or(0, |(_, before)| before).saturating_add(SMALL_STEP_NS) < by_ns {
            self.deaf = Some((Instant::now(), by_ns));
        }
        // Up to `SET_BACK_NS` the library discovers nothing until the clock reaches the earlier time again.
        let most = if by_ns > SET_BACK_NS { SUCCESSION } else { Duration::from_nanos(by_ns.unsigned_abs()) };
        self.deaf.is_some_and(|(since, _)| since.elapsed() < most)
    }
}

impl Probe {
    pub(super) fn new(participant: &Participant) -> Result<Self, DdsError> {
        let own = participant.guid().prefix();
        let mut player = own;
        // The same vendor ID; no other participant has this prefix.
        player.0[2..].iter_mut().for_each(|byte| *byte ^= 0x5a);
        let turn = Mutex::new(Turn { next: Instant::now(), sequence: 1, set_back: SetBack::new(), deaf: None });
        Ok(Self {
            barrier: participant.barrier()?,
            simulated_participant: player,
            seen: watch::Sender::default(),
            turn,
        })
    }

    /// Records that the library has discovered a participant.
    pub(super) fn found(&self, participant: Prefix) {
        if participant == self.simulated_participant {
            self.seen.send_modify(|(found, _)| *found += 1);
        }
    }

    /// Records that the library has lost a participant.
    pub(super) fn gone(&self, participant: Prefix) {
        if participant == self.simulated_participant {
            self.seen.send_modify(|(_, lost)| *lost += 1);
        }
    }

    /// Probes the library. Returns the part that does not work as an error.
    pub(super) async fn check(&self, shared: &Shared) -> Result<(), &'static str> {
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
            if Instant::now() < turn.next || turn.is_failure_expected() {
                return true;
            }
            turn.next = Instant::now() + ANNOUNCEMENTS;
            turn.sequence += 2 * i64::from(TRIES);
            turn.sequence
        };
        let (socket, to) = (&shared.socket, shared.participant.discovery_address());
        let before = *self.seen.borrow();
        let addresses = [socket.address()];
        let player = SimulatedParticipant {
            who: self.simulated_participant,
            addresses: &addresses,
            builtin: BARE,
            lease_s: LEASE_S,
        };
        for _ in 0..TRIES {
            socket.send(&player.announced(sequence), to);
            let is_found = self.comes(|(found, _)| found > before.0).await;
            socket.send(&spdp::disposal(self.simulated_participant, None, sequence + 1), to);
            if self.comes(|(_, lost)| lost > before.1).await && is_found {
                return true;
            }
            sequence += 2;
        }
        // Tried again at the next probe.
        self.turn.lock().unwrap_or_else(PoisonError::into_inner).next = Instant::now();
        false
    }

    async fn comes(&self, is_it: impl Fn((u64, u64)) -> bool) -> bool {
        let mut changes = self.seen.subscribe();
        let comes = changes.wait_for(|seen| is_it(*seen));
        matches!(tokio::time::timeout(PATIENCE, comes).await, Ok(Ok(_)))
    }
}

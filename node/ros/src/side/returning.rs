//! Participants that were silent beyond their lease and speak again: stopped in a debugger, suspended, cut off.
//!
//! The DDS library (0.15.1) would never speak to them again: it takes their later announcements, and those of their endpoints, for the
//! ones that it knows.
//!
//! Law       what was lost by its lease (`presence`) is asked every 2 s who it is: participants answer one that they do not know. Nothing
//!           that it has written before it spoke again is carried out (`age`)
//! Sequence  when it is heard:
//!           1. a good-bye to it, in the name of our participant: it forgets all counts and numbers of ours, and what it still has
//!              for us. Not to one of the library, which would not find us again. A second for that
//!           2. its announcement under a number that the library does not know: it is a participant again, and its endpoints are in the
//!              library's tables again, but not matched
//!           3. a participant that we play, seen by nobody but our library, announces those endpoints, and is gone

use std::io;
use std::net::{Ipv4Addr, SocketAddrV4};
use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::{Duration, Instant};

use tokio::net::UdpSocket;
use tokio::runtime::Handle;
use tokio::task::JoinHandle;
use tokio::time::sleep;

use super::dds::Discovery;
use super::listeners;
use super::member::Shared;
use super::presence::{Heard, Presence};
use super::sedp::Endpoint;
use super::socket::OwnSocket;
use super::spdp::{self, ANNOUNCER, Announcement, BARE, LATE, Played};
use crate::link::guid::Prefix;

/// Between two rounds of questions.
const ROUND: Duration = Duration::from_secs(2);
/// Of who asks: one that did not hear us, or whose answer was lost, takes the next question for a new participant's.
const ASKING_S: i32 = 1;
/// Of who announces endpoints; it is gone much sooner.
const ANNOUNCING_S: i32 = 60;
/// What a participant needs to forget ours.
const FORGETTING: Duration = Duration::from_secs(1);
/// What our library needs to know a participant, and then its endpoints.
const KNOWING: Duration = Duration::from_millis(200);
const MATCHING: Duration = Duration::from_millis(500);
/// Larger than any number that a participant gives its own announcements.
const UNKNOWN: i64 = 1 << 40;
/// Endpoints that are announced together, and the pause behind them: what a socket's buffer holds.
const TOGETHER: usize = 32;
const PAUSE: Duration = Duration::from_millis(5);
/// Vendor of the library, as its GUIDs begin.
const LIBRARY: [u8; 2] = [0x01, 0x12];
/// Networks that a question names; each makes its answer one more datagram.
const NETWORKS: usize = 4;
/// After an error of an listener.
const DEAF: Duration = Duration::from_millis(100);
/// Longest datagram.
const DATAGRAM: usize = 1 << 16;

/// Listens next to the library.
pub(super) struct Returning {
    own: Prefix,
    networks: Vec<Ipv4Addr>,
    presence: Mutex<Presence>,
    /// Hears the answers to what it asks, too.
    socket: OwnSocket,
    /// Numbers, each given once: to questions, announcements said again, participants that we play.
    given: AtomicI64,
}

impl Returning {
    /// OwnSocket the participant `own`, which was made on these networks.
    pub(super) fn new(own: Prefix, networks: Vec<Ipv4Addr>) -> io::Result<Self> {
        let is_here = networks.iter().all(Ipv4Addr::is_loopback);
        let socket = if is_here { OwnSocket::on(Ipv4Addr::LOCALHOST)? } else { OwnSocket::new()? };
        Ok(Self { own, networks, presence: Mutex::default(), socket, given: AtomicI64::new(1) })
    }

    /// The tasks that listen and ask.
    pub(super) fn start(shared: &Arc<Shared>, domain: u16, runtime: &Handle) -> io::Result<Vec<JoinHandle<()>>> {
        let this = &shared.returning;
        let mut sockets = listeners::open(domain, &this.networks)?;
        sockets.push(this.socket.listener()?);
        let mut tasks = vec![runtime.spawn(ask(Arc::downgrade(shared)))];
        for listener in sockets {
            let listener = UdpSocket::from_std(listener)?;
            tasks.push(runtime.spawn(listen(listener, Arc::downgrade(shared), runtime.clone())));
        }
        Ok(tasks)
    }

    /// What discovery says of others.
    pub(super) fn note(&self, change: Discovery) {
        match change {
            Discovery::Found { participant } => self.presence().found(participant),
            Discovery::Gone { participant, is_silent: true } => self.presence().lost(participant, Instant::now()),
            Discovery::Gone { participant, is_silent: false } => self.presence().forget(participant),
            Discovery::Matched { .. } | Discovery::Heard { .. } | Discovery::Lost { .. } | Discovery::Silent { .. } => {
            }
        }
    }

    /// When a participant spoke again, where it was ever lost.
    pub(super) fn since(&self, who: Prefix) -> Option<Instant> {
        self.presence().since(who)
    }

    /// A panic elsewhere leaves it whole: each change is one call.
    fn presence(&self) -> MutexGuard<'_, Presence> {
        self.presence.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn number(&self) -> i64 {
        self.given.fetch_add(1, Ordering::Relaxed)
    }

    /// Asks those that are lost who they are.
    fn ask(&self) {
        let lost = self.presence().ask(Instant::now());
        let (who, port) = (played(self.own, 0), self.socket.address().port());
        for address in lost {
            // Where the answer has to go.
            let near = self.networks.iter().filter(|network| network.is_loopback() == address.ip().is_loopback());
            let mut here: Vec<_> = near.map(|network| SocketAddrV4::new(*network, port)).take(NETWORKS).collect();
            if here.is_empty() {
                here.push(self.socket.address());
            }
            let asking = Played { who, addresses: &here, builtin: BARE, lease_s: ASKING_S };
            self.socket.send(&asking.announced(LATE + self.number()), address);
        }
    }
}

/// The prefix of a participant that we play: of the same vendor; of nobody else.
fn played(own: Prefix, which: i64) -> Prefix {
    let mut prefix = own;
    for (byte, other) in prefix.0[2..].iter_mut().zip((which ^ 0x5a5a_5a5a_5a5a_5a5a).to_le_bytes()) {
        *byte ^= other;
    }
    prefix
}

async fn ask(shared: Weak<Shared>) {
    loop {
        sleep(ROUND).await;
        let Some(shared) = shared.upgrade() else { return };
        shared.returning.ask();
    }
}

async fn listen(listener: UdpSocket, shared: Weak<Shared>, runtime: Handle) {
    let mut buffer = vec![0; DATAGRAM];
    loop {
        let Ok(length) = listener.recv(&mut buffer).await else {
            // A closed port was written to. An listener that fails for good must not take all the time.
            sleep(DEAF).await;
            continue;
        };
        let Some(said) = Announcement::read(&buffer[..length]) else { continue };
        let Some(shared) = shared.upgrade() else { return };
        let this = &shared.returning;
        if said.who == this.own {
            continue;
        }
        let heard = this.presence().heard(&said, Instant::now());
        match heard {
            Heard::Known => {}
            Heard::Coming => drop(runtime.spawn(introduce(Arc::downgrade(&shared), said))),
            Heard::Changed => {
                this.socket.send(&said.again(UNKNOWN + this.number()), shared.participant.discovery_address());
            }
        }
    }
}

/// Makes a participant that was lost, and speaks again, known to the library; what cannot be done is done when it is heard next.
async fn introduce(shared: Weak<Shared>, said: Announcement) {
    if forget_us(&shared, &said).is_none() {
        return;
    }
    sleep(FORGETTING).await;
    let Some(player) = announce(&shared, &said) else { return };
    sleep(KNOWING).await;
    let Some(datagrams) = endpoints(&shared, &said, player) else { return };
    // Twice, as one that gets lost would hold up all that follow; the library takes each once.
    for some in datagrams.chunks(TOGETHER).chain(datagrams.chunks(TOGETHER)) {
        if tell(&shared, some).is_none() {
            return;
        }
        sleep(PAUSE).await;
    }
    sleep(MATCHING).await;
    let Some(shared) = shared.upgrade() else { return };
    tell_all(&shared, &[spdp::disposal(player, None, 2)]);
    if shared.returning.presence().told(said.who, Instant::now()) {
        // As loud as its loss.
        tracing::warn!("DDS participant {} speaks again, and is answered", said.who);
    }
}

/// Step 1.
fn forget_us(shared: &Weak<Shared>, said: &Announcement) -> Option<()> {
    let shared = shared.upgrade()?;
    let this = &shared.returning;
    for address in &said.addresses {
        // Who has asked leaves, too.
        this.socket.send(&spdp::disposal(played(this.own, 0), Some(said.who), LATE + this.number()), *address);
        if said.who.0[..2] != LIBRARY {
            this.socket.send(&spdp::disposal(this.own, Some(said.who), LATE + this.number()), *address);
        }
    }
    Some(())
}

/// Step 2; and who announces endpoints.
fn announce(shared: &Weak<Shared>, said: &Announcement) -> Option<Prefix> {
    let shared = shared.upgrade()?;
    let this = &shared.returning;
    let number = this.number();
    let player = Played {
        who: played(this.own, number),
        addresses: &[this.socket.address()],
        builtin: ANNOUNCER,
        lease_s: ANNOUNCING_S,
    };
    tell_all(&shared, &[said.again(UNKNOWN + number), player.announced(1)]);
    Some(player.who)
}

/// Step 3.
fn endpoints(shared: &Weak<Shared>, said: &Announcement, player: Prefix) -> Option<Vec<Vec<u8>>> {
    let shared = shared.upgrade()?;
    // What it has made since then the library has found by itself.
    let mut endpoints = shared.participant.endpoints_of(said.who);
    endpoints.retain(|endpoint| !shared.is_matched(endpoint.guid));
    let (readers, writers): (Vec<_>, Vec<_>) = endpoints.iter().partition(|endpoint| endpoint.guid.is_reader());
    // Readers and writers are announced by a writer each, without a gap in its numbers.
    let announced = |endpoints: Vec<&Endpoint>| {
        let mut all = Vec::new();
        for endpoint in endpoints {
            all.extend(endpoint.announced(player, all.len() as i64 + 1));
        }
        all
    };
    Some([announced(readers), announced(writers)].concat())
}

fn tell(shared: &Weak<Shared>, datagrams: &[Vec<u8>]) -> Option<()> {
    let shared = shared.upgrade()?;
    tell_all(&shared, datagrams);
    Some(())
}

/// Tells our library.
fn tell_all(shared: &Shared, datagrams: &[Vec<u8>]) {
    let inside = shared.participant.discovery_address();
    datagrams.iter().for_each(|datagram| shared.returning.socket.send(datagram, inside));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nobody_is_played_twice() {
        let own = Prefix([7; 12]);
        let all: Vec<_> = (0..300).map(|which| played(own, which)).collect();
        assert!(all.iter().enumerate().all(|(place, who)| *who != own && !all[..place].contains(who)));
        assert!(all.iter().all(|who| who.0[..2] == own.0[..2]));
    }
}

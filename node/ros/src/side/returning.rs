//! Restores participants that are heard again after their lease has expired: stopped in a debugger, suspended, or disconnected.
//!
//! The DDS library (0.15.1) would never communicate with them again: it treats their later announcements, and those of their endpoints,
//! as known.
//!
//! Law       a participant whose lease has expired (`presence`) is asked every 2 s to announce itself: participants answer the
//!           announcement of an unknown participant. Samples that it wrote before it was heard again are not executed (`age`)
//! Sequence  when the participant is heard again:
//!           1. send it a disposal in the name of our participant. It then forgets all our counts and sequence numbers, and the
//!              samples that it still has for us. A participant of the same library gets none, because it would not find us again.
//!              Wait 1 s
//!           2. send its announcement to our library, with a sequence number that the library does not know. The library then has the
//!              participant and its endpoints in its tables again, but the endpoints are not matched
//!           3. announce those endpoints to our library in the name of a simulated participant, which only our library sees; then
//!              dispose the simulated participant

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
use super::guid::Prefix;
use super::member::Shared;
use super::presence::{Heard, Presence};
use super::sedp::Endpoint;
use super::socket::OwnSocket;
use super::spdp::{self, ANNOUNCER, Announcement, BARE, LATE, SimulatedParticipant};
use super::{hashes, listeners};

/// Period of the rounds in which lost participants are asked.
const ROUND: Duration = Duration::from_secs(2);
/// Lease of the simulated participant that asks, in seconds. If a question or its answer was lost, the next question counts as that of
/// a new participant.
const ASKING_S: i32 = 1;
/// Lease of the simulated participant that announces endpoints, in seconds; it is disposed much sooner.
const ANNOUNCING_S: i32 = 60;
/// Time that a participant needs to forget ours.
const FORGETTING: Duration = Duration::from_secs(1);
/// Time that our library needs to discover a participant, and then to match its endpoints.
const KNOWING: Duration = Duration::from_millis(200);
const MATCHING: Duration = Duration::from_millis(500);
/// Larger than any sequence number that a participant gives to its own announcements.
const UNKNOWN: i64 = 1 << 40;
/// Number of endpoints that are announced together, and the pause after them. A socket's buffer can hold this number.
const TOGETHER: usize = 32;
const PAUSE: Duration = Duration::from_millis(5);
/// Vendor ID of the library; its GUIDs start with it.
pub(super) const LIBRARY: [u8; 2] = [0x01, 0x12];
/// Maximum number of networks in a question; each one adds a datagram to the answer.
const NETWORKS: usize = 4;
/// Pause after an error of a listener.
const DEAF: Duration = Duration::from_millis(100);
/// Maximum length of a datagram in bytes.
const DATAGRAM: usize = 1 << 16;

/// Listens to announcements in addition to the library, and asks lost participants.
pub(super) struct Returning {
    own: Prefix,
    networks: Vec<Ipv4Addr>,
    presence: Mutex<Presence>,
    /// Sends the questions, and also receives their answers.
    socket: OwnSocket,
    /// Next number. Each is used once: for a question, a repeated announcement, or a simulated participant.
    given: AtomicI64,
}

impl Returning {
    /// Creates it for the participant `own`, which was created on these networks.
    pub(super) fn new(own: Prefix, networks: Vec<Ipv4Addr>) -> io::Result<Self> {
        let is_here = networks.iter().all(Ipv4Addr::is_loopback);
        let socket = if is_here { OwnSocket::on(Ipv4Addr::LOCALHOST)? } else { OwnSocket::new()? };
        Ok(Self { own, networks, presence: Mutex::default(), socket, given: AtomicI64::new(1) })
    }

    /// Starts the tasks that listen and ask.
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

    /// Records a discovery event of the library.
    pub(super) fn note(&self, change: Discovery) {
        match change {
            Discovery::Found { participant } => self.presence().found(participant),
            Discovery::Gone { participant, is_silent: true } => self.presence().lost(participant, Instant::now()),
            Discovery::Gone { participant, is_silent: false } => self.presence().forget(participant),
            Discovery::Matched { .. } | Discovery::Heard { .. } | Discovery::Lost { .. } | Discovery::Silent { .. } => {
            }
        }
    }

    /// Returns the time at which a participant was heard again, or `None` if it was never lost or is still lost.
    pub(super) fn since(&self, who: Prefix) -> Option<Instant> {
        self.presence().since(who)
    }

    /// Locks the presence. It is consistent even after a panic elsewhere, because each change is one call.
    fn presence(&self) -> MutexGuard<'_, Presence> {
        self.presence.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn number(&self) -> i64 {
        self.given.fetch_add(1, Ordering::Relaxed)
    }

    /// Asks lost participants to announce themselves.
    fn ask(&self) {
        let lost = self.presence().ask(Instant::now());
        let (who, port) = (played(self.own, 0), self.socket.address().port());
        for address in lost {
            // Addresses to which the answer has to be sent.
            let near = self.networks.iter().filter(|network| network.is_loopback() == address.ip().is_loopback());
            let mut here: Vec<_> = near.map(|network| SocketAddrV4::new(*network, port)).take(NETWORKS).collect();
            if here.is_empty() {
                here.push(self.socket.address());
            }
            let asking = SimulatedParticipant { who, addresses: &here, builtin: BARE, lease_s: ASKING_S };
            self.socket.send(&asking.announced(LATE + self.number()), address);
        }
    }
}

/// Returns the prefix of a simulated participant: it has the same vendor ID, and no other participant has it.
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
            // A datagram was sent to a closed port. The pause limits the load if the listener fails permanently.
            sleep(DEAF).await;
            continue;
        };
        let Some(said) = Announcement::read(&buffer[..length]) else { continue };
        let Some(shared) = shared.upgrade() else { return };
        let this = &shared.returning;
        if said.who == this.own {
            continue;
        }
        hashes::heard(&shared, &said, &runtime);
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

/// Makes a lost participant that is heard again known to the library. If that fails, it is tried again when the participant is heard
/// next.
async fn introduce(shared: Weak<Shared>, said: Announcement) {
    if forget_us(&shared, &said).is_none() {
        return;
    }
    sleep(FORGETTING).await;
    let Some(player) = announce(&shared, &said) else { return };
    sleep(KNOWING).await;
    let Some(datagrams) = endpoints(&shared, &said, player) else { return };
    // Twice, because a lost datagram would block all that follow. The library handles each one once.
    for some in datagrams.chunks(TOGETHER).chain(datagrams.chunks(TOGETHER)) {
        if tell(&shared, some).is_none() {
            return;
        }
        sleep(PAUSE).await;
    }
    sleep(MATCHING).await;
    let Some(shared) = shared.upgrade() else { return };
    tell_all(&shared, &[spdp::disposal(player, None, 2)]);
    if shared.returning.presence().announcements_sent(said.who, Instant::now()) {
        // With the same severity as its loss.
        tracing::warn!("DDS participant {} speaks again, and is answered", said.who);
    }
}

/// Step 1.
fn forget_us(shared: &Weak<Shared>, said: &Announcement) -> Option<()> {
    let shared = shared.upgrade()?;
    let this = &shared.returning;
    for address in &said.addresses {
        // Also dispose the simulated participant that has asked.
        this.socket.send(&spdp::disposal(played(this.own, 0), Some(said.who), LATE + this.number()), *address);
        if said.who.0[..2] != LIBRARY {
            this.socket.send(&spdp::disposal(this.own, Some(said.who), LATE + this.number()), *address);
        }
    }
    Some(())
}

/// Step 2; also announces the simulated participant that announces endpoints.
fn announce(shared: &Weak<Shared>, said: &Announcement) -> Option<Prefix> {
    let shared = shared.upgrade()?;
    let this = &shared.returning;
    let number = this.number();
    let player = SimulatedParticipant {
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
    // The library has matched newer endpoints itself.
    let mut endpoints = shared.participant.endpoints_of(said.who);
    endpoints.retain(|endpoint| !shared.is_matched(endpoint.guid));
    let (readers, writers): (Vec<_>, Vec<_>) = endpoints.iter().partition(|endpoint| endpoint.guid.is_reader());
    // Readers and writers are announced by separate writers. The sequence numbers of each must have no gap.
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

/// Sends datagrams to our library.
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

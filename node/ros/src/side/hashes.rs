//! Announces the type hashes of our endpoints to other participants.
//!
//! ROS 2 Jazzy and later read the hash of a type from the USER_DATA of its endpoint, which the DDS library (0.15.1) cannot send. So a
//! new participant gets the announcements of the library from us first, with the hash.
//!
//! Law       a simulated participant, which only our library sees, reads the announcements of our endpoints (SEDP). A participant that
//!           is heard for the first time is sent the announcement of our participant and those of our endpoints, with USER_DATA. The
//!           library announces itself 10 ms after it has heard a participant, and its endpoints later, all under the same sequence
//!           numbers: a receiver ignores what it has already. If a datagram is lost, the receiver gets that announcement from the
//!           library, without a hash
//! Waits     until the library knows the participant: a participant that knows us announces its endpoints at once, and the library
//!           ignores announcements of an unknown participant. Fast DDS repeats them after 3 s, too late for a request
//! Refuses   participants that were there before our endpoints: the library has announced those to them at once. Participants of the
//!           same library, which has no use for hashes
//! Source    rmw_dds_common: `typehash=RIHS01_..;`. For a request or a response it is the hash of that part of the service

use std::collections::{BTreeMap, HashMap, HashSet, VecDeque};
use std::io;
use std::net::{Ipv4Addr, SocketAddrV4};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::{Duration, Instant};

use tokio::net::UdpSocket;
use tokio::runtime::Handle;
use tokio::task::{JoinHandle, yield_now};
use tokio::time::sleep;

use super::guid::{Guid, Prefix};
use super::member::Shared;
use super::returning::LIBRARY;
use super::rtps::{ACKNACK, DATA, FINAL, GAP, HEARTBEAT, Message, SENTINEL, number, parameter};
use super::socket::OwnSocket;
use super::spdp::{Announcement, SimulatedParticipant, parameters, u16_at};

/// Built-in endpoints of a participant that reads the announcements of participants, writers and readers.
const READER: u32 = 0x2b;
/// Lease of the simulated participant in seconds: it never ends.
const LEASE_S: i32 = i32::MAX;
/// Maximum length of a datagram to another participant in bytes: every network transmits it in one piece.
const LONGEST: usize = 1200;
/// Pauses before our participant is announced again and before its endpoints are: a participant needs a moment until it knows ours, and
/// ignores announcements of endpoints before that.
const AGAIN: Duration = Duration::from_millis(2);
const ENDPOINTS: Duration = Duration::from_millis(2);
/// Pause after the endpoints. It limits the load if many participants are forged.
const REST: Duration = Duration::from_millis(200);
/// Number of datagrams after which other tasks may run.
const TOGETHER: usize = 8;
/// Maximum number of participants that are introduced at the same time, and maximum number that are stored.
const INTRODUCED: usize = 8;
const MOST_PARTICIPANTS: usize = 256;
/// Maximum number of samples that are stored: more than the library keeps, which is 8193 of writers and as many of readers, and some
/// more for a while. With fewer, the library would repeat the others for ever.
const MOST_SAMPLES: usize = 4 * 8192;
/// Number of samples that are requested at a time.
const REQUESTED: i64 = 32;
/// Maximum length of a datagram of the library in bytes.
const DATAGRAM: usize = 1 << 16;
/// Pause between two looks at the announcements.
const POLL_INTERVAL: Duration = Duration::from_millis(1);
/// Pause after an error of the socket.
const DEAF: Duration = Duration::from_millis(100);
/// Parameters of an announcement.
const PID_ENDPOINT_GUID: u16 = 0x5a;
const PID_USER_DATA: u16 = 0x2c;

/// The announcements of our participant and its endpoints, as the library sends them, and the hashes of the endpoints' types.
pub(super) struct Hashes {
    own: Prefix,
    /// Prefix of the simulated participant.
    player: Prefix,
    /// Socket of the simulated participant.
    socket: OwnSocket,
    announced: Mutex<Announced>,
    /// Number of participants that are being introduced.
    introduced: AtomicUsize,
}

/// Writer of announcements and sequence number. The writer is 3 for those of writers, 4 for those of readers.
type Place = (u8, i64);
const READERS: u8 = 4;

/// Announcement of an endpoint.
struct Listed {
    endpoint: Guid,
    /// Parameter list with its encapsulation.
    list: Vec<u8>,
}

impl Listed {
    fn read(list: &[u8]) -> Option<Self> {
        let (all, _) = parameters(list.get(4..)?, is_little_endian(list))?;
        let (_, guid) = all.iter().find(|(id, _)| *id == PID_ENDPOINT_GUID)?;
        Some(Self { endpoint: Guid(guid.get(..16)?.try_into().ok()?), list: list.to_vec() })
    }
}

fn is_little_endian(list: &[u8]) -> bool {
    list.starts_with(&[0, 3])
}

/// A participant that we introduce ourselves to once.
struct Newcomer {
    who: Prefix,
    /// Addresses in its announcement; `None`: it was not heard yet.
    addresses: Option<Vec<SocketAddrV4>>,
    /// Whether the library knows it.
    is_found: bool,
    is_introduced: bool,
}

#[derive(Default)]
struct Announced {
    /// Announcement of our participant; empty if the library has sent none yet.
    participant: Vec<u8>,
    /// Announcements of endpoints. `None`: a sample that announces no endpoint, or one that was closed.
    endpoints: BTreeMap<Place, Option<Listed>>,
    types: HashMap<Guid, String>,
    /// Endpoints that were closed before the library has sent us their announcements.
    closed: HashSet<Guid>,
    /// Number of ACKNACKs so far.
    acknowledged: i32,
    /// Participants that were heard or found, the newest last.
    newcomers: VecDeque<Newcomer>,
    /// Whether a successor replaces our participant, or it has left. It is not announced any more then.
    has_ended: bool,
}

impl Hashes {
    /// Creates it for the participant `own`.
    pub(super) fn new(own: Prefix) -> io::Result<Self> {
        let mut player = own;
        // The same vendor ID; no other participant has this prefix.
        player.0[2..].iter_mut().for_each(|byte| *byte ^= 0x33);
        let socket = OwnSocket::on(Ipv4Addr::LOCALHOST)?;
        Ok(Self { own, player, socket, announced: Mutex::default(), introduced: AtomicUsize::new(0) })
    }

    /// Starts the task that reads the announcements of our library.
    pub(super) fn start(shared: &Arc<Shared>, runtime: &Handle) -> io::Result<JoinHandle<()>> {
        let this = &shared.hashes;
        let listener = UdpSocket::from_std(this.socket.listener()?)?;
        this.play(shared.participant.discovery_address());
        Ok(runtime.spawn(listen(listener, Arc::downgrade(shared))))
    }

    /// Records the type hash of an endpoint.
    pub(super) fn add(&self, endpoint: Guid, hash: &str) {
        self.announced().types.insert(endpoint, hash.to_owned());
    }

    /// Records that an endpoint was closed. It is not announced any more.
    pub(super) fn remove(&self, endpoint: Guid) {
        self.announced().close(endpoint);
    }

    /// Waits until the library has announced all readers and their ends before this sequence number, so that the number is the next one.
    /// Returns false if that takes longer than `patience`.
    pub(super) fn are_readers_announced_before(&self, number: i64, patience: Duration) -> bool {
        let deadline = Instant::now() + patience;
        while self.announced().last_of_readers() != number - 1 {
            if Instant::now() >= deadline {
                return false;
            }
            std::thread::sleep(POLL_INTERVAL);
        }
        true
    }

    /// Records that a participant was lost. It is introduced again if it returns, because it has forgotten our endpoints.
    pub(super) fn forget(&self, who: Prefix) {
        self.announced().newcomers.retain(|newcomer| newcomer.who != who);
    }

    /// Records that a successor replaces our participant.
    pub(super) fn end(&self) {
        self.announced().has_ended = true;
    }

    /// Locks the announcements. They are consistent even after a panic elsewhere, because each change is one step.
    fn announced(&self) -> MutexGuard<'_, Announced> {
        self.announced.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Announces the simulated participant to our library, which ignores a repetition.
    fn play(&self, library: SocketAddrV4) {
        let addresses = [self.socket.address()];
        let player =
            SimulatedParticipant { who: self.player, addresses: &addresses, builtin: READER, lease_s: LEASE_S };
        self.socket.send(&player.announced(1), library);
    }

    /// Takes a datagram of our library. Returns the answers to it.
    fn take(&self, datagram: &[u8]) -> Vec<Vec<u8>> {
        if datagram.get(8..20) != Some(self.own.0.as_slice()) {
            return Vec::new();
        }
        let mut announced = self.announced();
        match Announcement::read(datagram) {
            Some(said) if said.is_gone => announced.has_ended = true,
            Some(_) => announced.participant = datagram.to_vec(),
            None => {}
        }
        let mut answers = Vec::new();
        for (kind, flags, body) in submessages(datagram) {
            // The library is on this host: it sends nothing that cannot be read.
            match kind {
                DATA => {
                    announced.keep(flags, body);
                }
                GAP => {
                    announced.skip(body);
                }
                HEARTBEAT => answers.extend(announced.answer(self.own, self.player, body)),
                _ => {}
            }
        }
        answers
    }

    /// Returns the datagrams that introduce us to a participant, and its addresses, once it was heard and the library knows it. `None`
    /// if it gets none. The sender of the datagrams lowers the number of introductions afterwards.
    fn introduction(&self, who: Prefix, news: News<'_>) -> Option<(Vec<Vec<u8>>, Vec<SocketAddrV4>)> {
        let mut announced = self.announced();
        let is_known = !announced.participant.is_empty() && !announced.has_ended;
        let newcomer = announced.newcomer(who);
        match news {
            News::Heard(addresses) => newcomer.addresses = Some(addresses.to_vec()),
            News::Found => newcomer.is_found = true,
        }
        if !is_known || !newcomer.is_found || newcomer.is_introduced {
            return None;
        }
        let addresses = newcomer.addresses.clone()?;
        newcomer.is_introduced = true;
        // Before the datagrams are made, which costs much more than to forge a participant.
        if self.introduced.fetch_add(1, Ordering::Relaxed) >= INTRODUCED {
            self.introduced.fetch_sub(1, Ordering::Relaxed);
            return None;
        }
        Some((announced.datagrams(self.own, who), addresses))
    }
}

/// What is new about a participant.
enum News<'a> {
    /// It has announced itself, with these addresses.
    Heard(&'a [SocketAddrV4]),
    /// The library knows it.
    Found,
}

impl Announced {
    /// Returns what is stored of a participant. A new one replaces the oldest.
    fn newcomer(&mut self, who: Prefix) -> &mut Newcomer {
        let at = self.newcomers.iter().position(|newcomer| newcomer.who == who).unwrap_or_else(|| {
            if self.newcomers.len() >= MOST_PARTICIPANTS {
                self.newcomers.pop_front();
            }
            self.newcomers.push_back(Newcomer { who, addresses: None, is_found: false, is_introduced: false });
            self.newcomers.len() - 1
        });
        &mut self.newcomers[at]
    }

    /// Returns the sequence number of the last sample that announces a reader or its end, or 0.
    fn last_of_readers(&self) -> i64 {
        self.endpoints.range((READERS, i64::MIN)..).next_back().map_or(0, |((_, number), _)| *number)
    }

    /// Keeps the announcement in a DATA submessage.
    fn keep(&mut self, flags: u8, body: &[u8]) -> Option<()> {
        let place = (announcer(body.get(8..12)?)?, number_at(body, 12)?);
        let payload = body.get(4 + usize::from(u16_at(body, 2, true)?)..)?;
        // Inline QoS, or a key alone, is in a sample that disposes an endpoint.
        let listed = if flags & 0b1110 == 0b100 { Listed::read(payload) } else { None };
        let listed = listed.filter(|listed| !self.closed.remove(&listed.endpoint));
        if self.endpoints.len() < MOST_SAMPLES {
            // A sample that the library repeats does not bring an endpoint back that was closed meanwhile.
            self.endpoints.entry(place).or_insert(listed);
        }
        Some(())
    }

    /// Drops an endpoint.
    fn close(&mut self, endpoint: Guid) {
        self.types.remove(&endpoint);
        let mut is_announced = false;
        for listed in self.endpoints.values_mut() {
            if listed.as_ref().is_some_and(|listed| listed.endpoint == endpoint) {
                *listed = None;
                is_announced = true;
            }
        }
        if !is_announced && self.closed.len() < MOST_SAMPLES {
            self.closed.insert(endpoint);
        }
    }

    /// Keeps in mind that the samples in a GAP are not sent any more.
    fn skip(&mut self, body: &[u8]) -> Option<()> {
        let announcer = announcer(body.get(4..8)?)?;
        let (first, before) = (number_at(body, 8)?, number_at(body, 16)?);
        let bits = i64::from(u32::from_le_bytes(body.get(24..28)?.try_into().ok()?).min(256));
        let is_in_set = |bit: i64| {
            let word = body.get(28 + 4 * (bit as usize / 32)..)?.first_chunk::<4>()?;
            Some(u32::from_le_bytes(*word) & (1 << (31 - bit % 32)) != 0)
        };
        let most = MOST_SAMPLES as i64;
        let range = first.max(1)..before.min(first.saturating_add(most));
        let set = (0..bits).filter(|bit| is_in_set(*bit) == Some(true)).map(|bit| before.saturating_add(bit));
        for number in range.chain(set) {
            if self.endpoints.len() < MOST_SAMPLES {
                self.endpoints.entry((announcer, number)).or_insert(None);
            }
        }
        Some(())
    }

    /// Returns the ACKNACK that answers a HEARTBEAT: it requests what is missing.
    fn answer(&mut self, own: Prefix, player: Prefix, body: &[u8]) -> Option<Vec<u8>> {
        let announcer = announcer(body.get(4..8)?)?;
        let (first, last) = (number_at(body, 8)?, number_at(body, 16)?);
        // The library has dropped what is older. Otherwise there would be no room for new samples some day.
        self.endpoints.retain(|(writer, number), _| *writer != announcer || *number >= first);
        let missing = (first.max(1)..=last).find(|number| !self.endpoints.contains_key(&(announcer, *number)));
        self.acknowledged = self.acknowledged.wrapping_add(1);
        let mut set = number(missing.unwrap_or(last.saturating_add(1))).to_vec();
        match missing.map(|missing| (last - missing).min(REQUESTED - 1) as u32 + 1) {
            Some(count) => {
                set.extend(count.to_le_bytes());
                set.extend((u32::MAX << (32 - count)).to_le_bytes());
            }
            None => set.extend([0; 4]),
        }
        let mut message = Message::from(player);
        let ends = [[0, 0, announcer, 0xc7], [0, 0, announcer, 0xc2]].concat();
        let acknack = [ends.as_slice(), set.as_slice(), &self.acknowledged.to_le_bytes()].concat();
        message.to(own).submessage(ACKNACK, FINAL, &acknack);
        Some(message.bytes())
    }

    /// Returns the datagrams that announce us to a participant.
    fn datagrams(&self, own: Prefix, to: Prefix) -> Vec<Vec<u8>> {
        let begun = || {
            let mut message = Message::from(own);
            message.to(to);
            message
        };
        let mut datagrams = vec![self.participant.clone()];
        let mut message = begun();
        for ((announcer, number), list) in &self.endpoints {
            let Some(list) = list.as_ref().map(|listed| self.with_hash(listed)) else { continue };
            if message.length() + list.len() > LONGEST {
                datagrams.push(std::mem::replace(&mut message, begun()).bytes());
            }
            message.data([0, 0, *announcer, 0xc7], [0, 0, *announcer, 0xc2], *number, &list);
        }
        datagrams.push(message.bytes());
        datagrams
    }

    /// Returns the announcement of an endpoint with the hash of its type. An endpoint without a hash is announced as the library does
    /// it.
    fn with_hash(&self, Listed { endpoint, list }: &Listed) -> Vec<u8> {
        let (Some(hash), Some(begin), true) =
            (self.types.get(endpoint), list.strip_suffix(&SENTINEL), is_little_endian(list))
        else {
            return list.clone();
        };
        let user_data = format!("typehash={hash};");
        let mut list = begin.to_vec();
        let length = (user_data.len() as u32).to_le_bytes();
        parameter(&mut list, PID_USER_DATA, &[length.as_slice(), user_data.as_bytes()].concat());
        list.extend(SENTINEL);
        list
    }
}

/// Returns the third byte of the entity ID of a built-in writer that announces writers (3) or readers (4).
fn announcer(entity: &[u8]) -> Option<u8> {
    match *entity {
        [0, 0, announcer @ (3 | 4), 0xc2] => Some(announcer),
        _ => None,
    }
}

fn number_at(bytes: &[u8], at: usize) -> Option<i64> {
    let bytes: [u8; 8] = bytes.get(at..at + 8)?.try_into().ok()?;
    let [a, b, c, d, e, f, g, h] = bytes;
    let (high, low) = (i32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h]));
    Some((i64::from(high) << 32) | i64::from(low))
}

/// Returns kind, flags and body of each submessage of a little-endian message.
fn submessages(datagram: &[u8]) -> Vec<(u8, u8, &[u8])> {
    let (mut all, mut rest) = (Vec::new(), datagram.get(20..).unwrap_or_default());
    while let [kind, flags, low, high, ref after @ ..] = *rest {
        let length = usize::from(u16::from_le_bytes([low, high]));
        // The last submessage may have length 0: it extends to the end of the message.
        let length = if length == 0 { after.len() } else { length };
        let (Some(body), Some(next), 1) = (after.get(..length), after.get(length..), flags & 1) else { break };
        all.push((kind, flags, body));
        rest = next;
    }
    all
}

/// Reads the announcements of our library.
async fn listen(listener: UdpSocket, shared: Weak<Shared>) {
    let mut buffer = vec![0; DATAGRAM];
    loop {
        let Ok(length) = listener.recv(&mut buffer).await else {
            // A datagram was sent to a closed port. The pause limits the load if the socket fails permanently.
            sleep(DEAF).await;
            continue;
        };
        let Some(shared) = shared.upgrade() else { return };
        let (this, library) = (&shared.hashes, shared.participant.discovery_address());
        for answer in this.take(&buffer[..length]) {
            this.socket.send(&answer, library);
        }
    }
}

/// Records that a participant has announced itself.
pub(super) fn heard(shared: &Arc<Shared>, said: &Announcement, runtime: &Handle) {
    let this = &shared.hashes;
    if said.is_gone {
        return;
    }
    if this.announced().participant.is_empty() {
        // The announcement of the simulated participant was lost, or is not handled yet.
        this.play(shared.participant.discovery_address());
    }
    introduce(shared, said.who, News::Heard(&said.addresses), runtime);
}

/// Records that the library knows a participant and answers it.
pub(super) fn found(shared: &Arc<Shared>, participant: Prefix, runtime: &Handle) {
    introduce(shared, participant, News::Found, runtime);
}

/// Introduces us to a participant, if it is time for that.
fn introduce(shared: &Arc<Shared>, who: Prefix, news: News<'_>, runtime: &Handle) {
    if who.0.starts_with(&LIBRARY) {
        return;
    }
    if let Some((datagrams, addresses)) = shared.hashes.introduction(who, news) {
        runtime.spawn(send(Arc::downgrade(shared), datagrams, addresses));
    }
}

/// Sends the datagrams: the first one, of our participant, twice, then those of the endpoints.
///
/// These once: a socket has space for about 90 datagrams (Linux: 212,992 bytes, of which each takes 2,304). If a second round fills it,
/// an acknowledgement of the library is lost, and Fast DDS repeats its own announcements after 1 s or 3 s only.
async fn send(shared: Weak<Shared>, datagrams: Vec<Vec<u8>>, addresses: Vec<SocketAddrV4>) {
    let say = |some: &[Vec<u8>]| {
        let shared = shared.upgrade()?;
        addresses.iter().for_each(|address| some.iter().for_each(|datagram| shared.socket.send(datagram, *address)));
        Some(())
    };
    let (participant, endpoints) = datagrams.split_at(1);
    say(participant);
    sleep(AGAIN).await;
    say(participant);
    sleep(ENDPOINTS).await;
    for some in endpoints.chunks(TOGETHER) {
        if say(some).is_none() {
            return;
        }
        yield_now().await;
    }
    sleep(REST).await;
    if let Some(shared) = shared.upgrade() {
        shared.hashes.introduced.fetch_sub(1, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests;

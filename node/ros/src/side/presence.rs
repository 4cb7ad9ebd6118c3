//! State of all remote participants: present, lost, or back after a loss.
//!
//! Law      a participant is lost when its lease has expired in the DDS library. When an announcement of it is received again, it is
//!          coming. It is back when the library has discovered it again; otherwise it is lost again. A participant that is disposed is
//!          removed. A lost participant is requested to announce itself, for one hour
//! Refuses  more than [`MOST`] participants: the one with the oldest announcement is removed

use std::collections::{HashMap, HashSet};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::net::SocketAddrV4;
use std::time::{Duration, Instant};

use super::guid::Prefix;
use super::spdp::Announcement;

/// Maximum number of participants that are stored: more than a host and its network have.
const MOST: usize = 256;
/// Maximum number of lost participants that are requested to announce themselves in one round, in turn.
const ASKED: usize = 16;
/// Time after its loss for which a participant is requested to announce itself. Later it is back only when it announces itself.
const REQUEST_PERIOD: Duration = Duration::from_secs(3600);

/// Effect of an announcement on the DDS library. The library treats the announcements of a lost participant, and all later ones, as
/// known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Heard {
    /// The library handles the announcement itself.
    Known,
    /// An announcement of a lost participant was received.
    Coming,
    /// A participant that is back announces a change, or disposes itself.
    Changed,
}

/// All participants except our own.
#[derive(Default)]
pub(super) struct Presence {
    all: HashMap<Prefix, Participant>,
}

struct Participant {
    addresses: Vec<SocketAddrV4>,
    heard: Instant,
    state: State,
}

enum State {
    There,
    Lost {
        since: Instant,
        asked: Option<Instant>,
        /// Whether the library has discovered it since then.
        is_found: bool,
    },
    Coming {
        since: Instant,
        said: u64,
        is_found: bool,
    },
    Back {
        since: Instant,
        said: u64,
    },
}

impl Presence {
    /// Records that its lease has expired in the library.
    pub(super) fn lost(&mut self, who: Prefix, now: Instant) {
        let participant = self.participant(who, now);
        match &mut participant.state {
            State::Coming { is_found, .. } => *is_found = false,
            state => *state = State::Lost { since: now, asked: None, is_found: false },
        }
    }

    /// Records that the library has discovered it.
    pub(super) fn found(&mut self, who: Prefix) {
        let found = self.all.get_mut(&who).map(|participant| &mut participant.state);
        if let Some(State::Lost { is_found, .. } | State::Coming { is_found, .. }) = found {
            *is_found = true;
        }
    }

    /// Removes a participant that was disposed.
    pub(super) fn forget(&mut self, who: Prefix) {
        self.all.remove(&who);
    }

    /// Handles an announcement.
    pub(super) fn heard(&mut self, said: &Announcement, now: Instant) -> Heard {
        if said.is_gone {
            let gone = self.all.remove(&said.who);
            return match gone.map(|participant| participant.state) {
                Some(State::Coming { .. } | State::Back { .. }) => Heard::Changed,
                Some(State::There | State::Lost { .. }) | None => Heard::Known,
            };
        }
        let digest = digest(said);
        let participant = self.participant(said.who, now);
        participant.heard = now;
        participant.addresses.clone_from(&said.addresses);
        match &mut participant.state {
            State::There | State::Coming { .. } => Heard::Known,
            State::Lost { is_found, .. } => {
                participant.state = State::Coming { since: now, said: digest, is_found: *is_found };
                Heard::Coming
            }
            State::Back { said, .. } if *said == digest => Heard::Known,
            State::Back { said, .. } => {
                *said = digest;
                Heard::Changed
            }
        }
    }

    /// Handles that all announcements of a coming participant were sent to the library. It is back if the library has discovered it.
    /// Returns whether that is so.
    pub(super) fn announcements_sent(&mut self, who: Prefix, now: Instant) -> bool {
        let Some(participant) = self.all.get_mut(&who) else { return false };
        let State::Coming { since, said, is_found } = participant.state else { return false };
        participant.state = match is_found {
            true => State::Back { since, said },
            false => State::Lost { since: now, asked: None, is_found: false },
        };
        is_found
    }

    /// Returns the time at which its first announcement after a loss was received, or `None` if it was never lost or is still lost.
    pub(super) fn since(&self, who: Prefix) -> Option<Instant> {
        match self.all.get(&who)?.state {
            State::There | State::Lost { .. } => None,
            State::Coming { since, .. } | State::Back { since, .. } => Some(since),
        }
    }

    /// Returns the addresses of the lost participants that are requested in this round.
    pub(super) fn ask(&mut self, now: Instant) -> Vec<SocketAddrV4> {
        // Another participant may use the address of a killed one, which is not requested then.
        let live = self.all.values().filter(|participant| !matches!(participant.state, State::Lost { .. }));
        let taken: HashSet<_> = live.flat_map(|participant| participant.addresses.clone()).collect();
        let mut lost = Vec::new();
        for participant in self.all.values_mut() {
            if let State::Lost { since, asked, .. } = &mut participant.state
                && now.duration_since(*since) < REQUEST_PERIOD
                && !participant.addresses.iter().any(|address| taken.contains(address))
            {
                lost.push((asked, &participant.addresses));
            }
        }
        lost.sort_by_key(|(asked, _)| **asked);
        lost.truncate(ASKED);
        lost.into_iter()
            .flat_map(|(asked, addresses)| {
                *asked = Some(now);
                addresses.clone()
            })
            .collect()
    }

    fn participant(&mut self, who: Prefix, now: Instant) -> &mut Participant {
        if self.all.len() >= MOST && !self.all.contains_key(&who) {
            let oldest = self.all.iter().min_by_key(|(_, participant)| participant.heard).map(|(who, _)| *who);
            oldest.map(|who| self.all.remove(&who));
        }
        self.all.entry(who).or_insert(Participant { addresses: Vec::new(), heard: now, state: State::There })
    }
}

/// Returns a hash that distinguishes different announcements.
fn digest(said: &Announcement) -> u64 {
    let mut hasher = DefaultHasher::new();
    said.hash(&mut hasher);
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use std::net::Ipv4Addr;

    use super::super::spdp::{BARE, SimulatedParticipant, disposal};
    use super::*;

    fn who(number: u16) -> Prefix {
        let mut prefix = [1; 12];
        prefix[..2].copy_from_slice(&number.to_be_bytes());
        Prefix(prefix)
    }

    fn address(number: u16) -> SocketAddrV4 {
        SocketAddrV4::new(Ipv4Addr::LOCALHOST, number)
    }

    fn announced(number: u16, lease_s: i32) -> Announcement {
        let addresses = [address(number)];
        let played = SimulatedParticipant { who: who(number), addresses: &addresses, builtin: BARE, lease_s };
        Announcement::read(&played.announced(1)).unwrap()
    }

    fn gone(number: u16) -> Announcement {
        Announcement::read(&disposal(who(number), None, 2)).unwrap()
    }

    #[test]
    fn only_one_that_was_lost_comes_back_and_as_often_as_it_was_lost() {
        let (mut presence, now) = (Presence::default(), Instant::now());
        assert_eq!(presence.heard(&announced(1, 10), now), Heard::Known);
        presence.found(who(1));
        assert_eq!((presence.ask(now), presence.since(who(1))), (vec![], None));
        for second in [100, 200] {
            let now = now + Duration::from_secs(second);
            presence.lost(who(1), now);
            assert_eq!((presence.ask(now), presence.since(who(1))), (vec![address(1)], None));
            assert_eq!(presence.heard(&announced(1, 10), now), Heard::Coming);
            assert_eq!(presence.ask(now), [], "it has answered");
            assert_eq!(presence.heard(&announced(1, 10), now), Heard::Known, "once");
            presence.found(who(1));
            assert!(presence.announcements_sent(who(1), now));
            assert_eq!(presence.since(who(1)), Some(now));
        }
    }

    #[test]
    fn one_that_the_library_did_not_find_is_asked_again() {
        let (mut presence, now) = (Presence::default(), Instant::now());
        presence.lost(who(1), now);
        assert_eq!(presence.heard(&announced(1, 10), now), Heard::Coming);
        assert!(!presence.announcements_sent(who(1), now));
        assert_eq!(presence.ask(now), [address(1)]);
        assert_eq!(presence.heard(&announced(1, 10), now), Heard::Coming);
        presence.found(who(1));
        presence.lost(who(1), now);
        assert!(!presence.announcements_sent(who(1), now), "lost again meanwhile");
        // The announcement has a sequence number that the library did not know; the endpoints stay unknown.
        presence.found(who(1));
        assert_eq!(presence.heard(&announced(1, 10), now), Heard::Coming);
        assert!(presence.announcements_sent(who(1), now));
    }

    #[test]
    fn address_of_killed_participant_in_use_is_not_requested() {
        let (mut presence, now) = (Presence::default(), Instant::now());
        presence.heard(&announced(1, 10), now);
        let mut other = announced(1, 10);
        other.who = who(2);
        presence.heard(&other, now);
        presence.lost(who(1), now);
        assert_eq!(presence.ask(now), []);
        presence.lost(who(2), now);
        assert_eq!(presence.ask(now), [address(1); 2], "a process that was frozen has both");
    }

    #[test]
    fn what_one_that_is_back_says_is_passed_on_where_it_is_new() {
        let (mut presence, now) = (Presence::default(), Instant::now());
        presence.lost(who(1), now);
        presence.heard(&announced(1, 10), now);
        presence.found(who(1));
        presence.announcements_sent(who(1), now);
        assert_eq!(presence.heard(&announced(1, 10), now), Heard::Known);
        assert_eq!(presence.heard(&announced(1, 20), now), Heard::Changed);
        assert_eq!(presence.heard(&announced(1, 20), now), Heard::Known);
        assert_eq!(presence.heard(&gone(1), now), Heard::Changed);
        assert_eq!(presence.heard(&gone(1), now), Heard::Known);
        assert_eq!(presence.heard(&gone(2), now), Heard::Known, "the library hears it itself");
    }

    #[test]
    fn unknown_participants_are_limited() {
        let (mut presence, now) = (Presence::default(), Instant::now());
        let later = |second| now + Duration::from_secs(second);
        for number in 1..=1000 {
            presence.heard(&announced(number, 10), later(number.into()));
            presence.lost(who(number), later(number.into()));
        }
        assert_eq!(presence.all.len(), MOST);
        assert_eq!(presence.heard(&announced(1000, 10), later(1000)), Heard::Coming);
        assert_eq!(presence.heard(&announced(1, 10), later(1000)), Heard::Known, "forgotten");
        let (first, second) = (presence.ask(later(1000)), presence.ask(later(1002)));
        assert_eq!((first.len(), second.len()), (ASKED, ASKED));
        assert!(first.iter().all(|address| !second.contains(address)), "each in its turn");
        assert_eq!(presence.ask(later(1000) + REQUEST_PERIOD), [], "not for ever");
    }
}

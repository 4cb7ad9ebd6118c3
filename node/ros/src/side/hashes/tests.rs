//! Tests of the announcements with type hashes.

use super::*;

const OWN: Prefix = Prefix([1; 12]);
const OTHER: Prefix = Prefix([2; 12]);

/// An announcement of a writer of our participant, as the library sends it: GUID and topic.
fn announcement(entity: [u8; 4]) -> Vec<u8> {
    let mut list = vec![0, 3, 0, 0];
    parameter(&mut list, PID_ENDPOINT_GUID, &OWN.endpoint(entity).0);
    parameter(&mut list, 0x05, b"\x05\0\0\0rt/x\0");
    list.extend(SENTINEL);
    list
}

fn from_library(fill: impl FnOnce(&mut Message)) -> Vec<u8> {
    let mut message = Message::from(OWN);
    fill(&mut message);
    message.bytes()
}

fn data(sequence: i64, list: &[u8]) -> Vec<u8> {
    from_library(|message| {
        message.data([0, 0, 3, 0xc7], [0, 0, 3, 0xc2], sequence, list);
    })
}

fn heartbeat(first: i64, last: i64) -> Vec<u8> {
    let body = [&[0, 0, 3, 0xc7, 0, 0, 3, 0xc2][..], &number(first), &number(last), &[1, 0, 0, 0]].concat();
    from_library(|message| {
        message.submessage(HEARTBEAT, 0, &body);
    })
}

/// Base, number of bits and first word of the set in an ACKNACK of the simulated participant.
fn requested(answers: &[Vec<u8>]) -> (i64, u32, Option<u32>) {
    let [answer] = answers else { panic!("{answers:?}") };
    // Header, INFO_DST, header of the ACKNACK, its reader and writer.
    let set = &answer[20 + 16 + 4 + 8..];
    let word = |at: usize| u32::from_le_bytes(set[at..at + 4].try_into().unwrap());
    (number_at(set, 0).unwrap(), word(8), (set.len() > 16).then(|| word(12)))
}

#[test]
fn simulated_participant_requests_missing_announcements_and_acknowledges_the_others() {
    let hashes = Hashes::new(OWN).unwrap();
    assert_eq!(requested(&hashes.take(&heartbeat(1, 2))), (1, 2, Some(0xc000_0000)));
    for sequence in [1, 3] {
        assert!(hashes.take(&data(sequence, &announcement([0, 0, sequence as u8, 3]))).is_empty());
    }
    assert_eq!(requested(&hashes.take(&heartbeat(1, 100))), (2, 32, Some(u32::MAX)));
    // Sample 2 is not sent any more.
    let gap = from_library(|message| {
        message.gap([0, 0, 3, 0xc7], [0, 0, 3, 0xc2], 2, 3);
    });
    assert!(hashes.take(&gap).is_empty());
    assert_eq!(requested(&hashes.take(&heartbeat(1, 3))), (4, 0, None));
    let mut forged = heartbeat(1, 9);
    forged[8..20].fill(7);
    assert!(hashes.take(&forged).is_empty(), "only of our own participant");
}

#[test]
fn number_of_an_end_is_certain_once_all_readers_before_it_are_announced() {
    let hashes = Hashes::new(OWN).unwrap();
    let is_certain = |number| hashes.are_readers_announced_before(number, Duration::ZERO);
    assert!(is_certain(1) && !is_certain(2));
    let of_readers = |sequence: i64| {
        from_library(|message| {
            message.data([0, 0, 4, 0xc7], [0, 0, 4, 0xc2], sequence, &announcement([0, 0, sequence as u8, 4]));
        })
    };
    for sequence in [1, 2] {
        hashes.take(&of_readers(sequence));
        // The announcement of a writer changes nothing.
        hashes.take(&data(sequence + 7, &announcement([0, 0, 9, 3])));
    }
    assert!(is_certain(3) && !is_certain(2) && !is_certain(4));
}

#[test]
fn new_participant_gets_announcements_of_the_library_with_the_type_hash() {
    let hashes = Hashes::new(OWN).unwrap();
    let with_hash = OWN.endpoint([0, 0, 1, 3]);
    hashes.add(with_hash, "RIHS01_ab");
    hashes.remove(OWN.endpoint([0, 0, 3, 3]));
    for number in 1..=3 {
        hashes.take(&data(number, &announcement([0, 0, number as u8, 3])));
    }
    let datagrams = hashes.announced().datagrams(OWN, OTHER);
    let [_, endpoints] = datagrams.as_slice() else { panic!("{datagrams:?}") };
    let all = submessages(endpoints);
    let [_, first, second] = all.as_slice() else { panic!("the closed endpoint is left out: {all:?}") };
    // Written by hand: USER_DATA (0x2c) of 24 bytes with 19 characters before the end of the list.
    let mut expected = announcement([0, 0, 1, 3]);
    expected.truncate(expected.len() - 4);
    expected.extend(b"\x2c\0\x18\0\x13\0\0\0typehash=RIHS01_ab;\0");
    expected.extend([1, 0, 0, 0]);
    assert_eq!(first.2[12..20], number(1));
    assert_eq!(first.2[20..], expected);
    assert_eq!(second.2[12..20], number(2));
    assert_eq!(second.2[20..], announcement([0, 0, 2, 3]), "as the library sends it");
}

/// Sequence numbers of the endpoints that are announced to a new participant.
fn told(hashes: &Hashes) -> Vec<i64> {
    let datagrams = hashes.announced().datagrams(OWN, OTHER);
    let all = datagrams.iter().flat_map(|datagram| submessages(datagram));
    all.filter(|(kind, ..)| *kind == DATA).map(|(_, _, body)| number_at(body, 12).unwrap()).collect()
}

#[test]
fn closed_endpoint_is_not_announced_again_by_a_repetition_of_the_library() {
    let hashes = Hashes::new(OWN).unwrap();
    let sample = |number: u8| data(number.into(), &announcement([0, 0, number, 3]));
    hashes.take(&sample(1));
    hashes.take(&sample(2));
    hashes.remove(OWN.endpoint([0, 0, 1, 3]));
    assert_eq!(told(&hashes), [2]);
    assert!(hashes.announced().closed.is_empty(), "nothing is kept of it");
    hashes.take(&sample(1));
    assert_eq!(told(&hashes), [2]);
    // This one is closed before its announcement comes.
    hashes.remove(OWN.endpoint([0, 0, 3, 3]));
    hashes.take(&sample(3));
    hashes.take(&sample(3));
    assert_eq!(told(&hashes), [2]);
    assert!(hashes.announced().closed.is_empty());
}

/// A node whose endpoints come and go.
#[test]
fn samples_that_the_library_has_dropped_make_room_for_new_ones() {
    let hashes = Hashes::new(OWN).unwrap();
    let newest = MOST_SAMPLES as i64 + 1;
    for number in 1..=newest {
        hashes.take(&data(number, &announcement([0, 0, 1, 3])));
    }
    assert_eq!(requested(&hashes.take(&heartbeat(2, newest))), (newest, 1, Some(1 << 31)));
    hashes.take(&data(newest, &announcement([0, 0, 1, 3])));
    assert_eq!(requested(&hashes.take(&heartbeat(2, newest))), (newest + 1, 0, None));
    assert_eq!(hashes.announced().endpoints.len(), MOST_SAMPLES);
}

/// Hashes of a participant that the library has announced.
fn hashes() -> Hashes {
    let hashes = Hashes::new(OWN).unwrap();
    let participant = SimulatedParticipant { who: OWN, addresses: &[], builtin: READER, lease_s: 1 };
    hashes.take(&participant.announced(1));
    hashes
}

/// Whether a participant that is heard and found is introduced.
fn is_introduced(hashes: &Hashes, who: Prefix) -> bool {
    let at_once = hashes.introduction(who, News::Found);
    assert_eq!(at_once, None, "its addresses are unknown");
    hashes.introduction(who, News::Heard(&[])).is_some()
}

#[test]
fn participant_is_introduced_once_the_library_knows_it() {
    let (hashes, address) = (hashes(), SocketAddrV4::new(Ipv4Addr::LOCALHOST, 7410));
    assert_eq!(hashes.introduction(OTHER, News::Heard(&[address])), None);
    assert_eq!(hashes.introduction(OTHER, News::Heard(&[address])), None, "heard again");
    let (_, addresses) = hashes.introduction(OTHER, News::Found).unwrap();
    assert_eq!(addresses, [address]);
    assert_eq!(hashes.introduction(OTHER, News::Heard(&[address])), None, "once");
}

#[test]
fn participant_that_was_lost_is_introduced_again_when_it_returns() {
    let hashes = hashes();
    assert!(is_introduced(&hashes, OTHER));
    hashes.forget(OTHER);
    assert!(is_introduced(&hashes, OTHER));
}

#[test]
fn nobody_is_introduced_before_the_library_has_announced_our_participant() {
    let hashes = Hashes::new(OWN).unwrap();
    assert!(!is_introduced(&hashes, OTHER));
    let participant = SimulatedParticipant { who: OWN, addresses: &[], builtin: READER, lease_s: 1 };
    hashes.take(&participant.announced(1));
    assert!(hashes.introduction(OTHER, News::Heard(&[])).is_some(), "when it is heard next");
}

#[test]
fn flood_of_participants_gets_few_introductions() {
    let hashes = hashes();
    let introduced = (3..203).filter(|who| is_introduced(&hashes, Prefix([*who; 12]))).count();
    assert_eq!((introduced, hashes.introduced.load(Ordering::Relaxed)), (INTRODUCED, INTRODUCED));
}

#[test]
fn participant_that_has_left_is_not_announced() {
    let hashes = hashes();
    hashes.take(&crate::side::spdp::disposal(OWN, None, 2));
    assert!(!is_introduced(&hashes, OTHER));
}

#[test]
fn participant_is_not_introduced_after_a_successor_took_over() {
    let hashes = hashes();
    hashes.end();
    assert!(!is_introduced(&hashes, OTHER));
}

#[test]
fn datagrams_are_as_short_as_every_network_allows() {
    let hashes = Hashes::new(OWN).unwrap();
    for number in 1..=100 {
        hashes.add(OWN.endpoint([0, 0, number, 3]), &format!("RIHS01_{}", "a".repeat(64)));
        hashes.take(&data(i64::from(number), &announcement([0, 0, number, 3])));
    }
    let datagrams = hashes.announced().datagrams(OWN, OTHER);
    let announced: usize = datagrams.iter().map(|datagram| submessages(datagram).len().saturating_sub(1)).sum();
    assert_eq!(announced, 100);
    assert!(datagrams.iter().all(|datagram| datagram.len() <= LONGEST + 24), "{datagrams:?}");
}

#[test]
fn damaged_datagrams_are_ignored() {
    let hashes = Hashes::new(OWN).unwrap();
    let gap = from_library(|message| {
        message.gap([0, 0, 3, 0xc7], [0, 0, 3, 0xc2], 2, 3);
    });
    for whole in [data(1, &announcement([0, 0, 1, 3])), heartbeat(1, 2), gap] {
        for length in 0..whole.len() {
            hashes.take(&whole[..length]);
        }
        for at in 0..whole.len() {
            for bit in 0..8 {
                let mut bent = whole.clone();
                bent[at] ^= 1 << bit;
                hashes.take(&bent);
            }
        }
    }
    hashes.announced().datagrams(OWN, OTHER);
}

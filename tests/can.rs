//! Reads and writes objects of independent CANopen drives over slcan, as with an adapter of a user.

use crate::support::can::{Bus, CanDrives};
use lineshaft_can::{NmtCommand, NmtState, NodeId};
use lineshaft_cia402::object::Object;

const NAME: Object = Object { index: 0x1008, sub: 0 };
const ECHO: Object = Object { index: 0x2001, sub: 0 };
const HEARTBEAT: Object = Object { index: 0x1017, sub: 0 };

/// Lengths around one segment, one block, and several.
const LENGTHS: [usize; 8] = [5, 7, 8, 32, 49, 889, 890, 2000];

fn text(length: usize) -> Vec<u8> {
    (b'a'..=b'z').cycle().take(length).collect()
}

/// Checks each server: numbers in one frame, texts in segments and in blocks, both directions; refusals with their
/// texts, after which the next transfer works. `reads`: result of reading a text of this length in blocks, if it is not
/// the text.
fn conforms(bus: &mut Bus, name: &str, reads: impl Fn(usize) -> Option<&'static str>) {
    for in_blocks in [false, true] {
        assert_eq!(bus.read(NAME, in_blocks), Ok(name.into()));
        assert_eq!(bus.read(Object { index: 0x1018, sub: 2 }, in_blocks), Ok(0x4020_0001_u32.to_le_bytes().to_vec()));
    }
    assert_eq!(bus.write(HEARTBEAT, &100_u16.to_le_bytes(), true), Ok(()));
    assert_eq!(bus.read(HEARTBEAT, false), Ok(vec![100, 0]));
    for length in LENGTHS {
        for in_blocks in [false, true] {
            bus.write(ECHO, b"something else", false).expect("in segments");
            assert_eq!(bus.write(ECHO, &text(length), in_blocks), Ok(()), "{name}: {length} bytes, blocks {in_blocks}");
            assert_eq!(bus.read(ECHO, false), Ok(text(length)), "{name}: {length} bytes, blocks {in_blocks}");
        }
        let read = reads(length).map_or(Ok(text(length)), |error| Err(error.to_owned()));
        assert_eq!(bus.read(ECHO, true), read, "{name}: {length} bytes in blocks");
    }
    let refused = |object: &str, why: &str| Err::<(), _>(format!("{object}: the device refuses: {why}"));
    for in_blocks in [false, true] {
        let none = bus.read(Object { index: 0x5FFF, sub: 0 }, in_blocks).map(drop);
        assert_eq!(none, refused("5FFFh:00", "the object does not exist (06020000h)"), "{name}");
        let none = bus.read(Object { index: 0x1018, sub: 9 }, in_blocks).map(drop);
        assert_eq!(none, refused("1018h:09", "the subindex does not exist (06090011h)"), "{name}");
        let written = bus.write(Object { index: 0x1018, sub: 1 }, &[0; 4], in_blocks);
        assert_eq!(written, refused("1018h:01", "the object can only be read (06010002h)"), "{name}");
        let written = bus.write(NAME, &text(40), in_blocks);
        assert_eq!(written, refused("1008h:00", "the object can only be read (06010002h)"), "{name}");
        assert!(
            bus.write(HEARTBEAT, &text(5), in_blocks)
                .expect_err("too long")
                .starts_with("1017h:00: the device refuses: ")
        );
        assert_eq!(bus.read(HEARTBEAT, in_blocks), Ok(vec![100, 0]), "{name}");
    }
}

#[test]
fn two_servers_that_share_nothing_conform() {
    let drives = CanDrives::boot("1");
    conforms(&mut Bus::open(&drives, 1), "cia402-sim", |_| None);
    let device = CanDrives::boot_device(7);
    // If the last segment is full, durand 0.5.0 reports all of its 7 bytes as unused; the checksum detects it.
    let wrong = "2001h:00: the device answers wrongly: the check sum does not fit (05040004h)";
    conforms(&mut Bus::open(&device, 7), "durand device", |length| (length % 7 == 0).then_some(wrong));
}

/// A device without block transfer, and lost segments of blocks.
#[test]
fn texts_pass_without_blocks_and_with_lost_segments() {
    let mut drives = CanDrives::boot("1-2");
    let mut bus = Bus::open(&drives, 1);
    for length in LENGTHS {
        for (knows_blocks, lost) in [(0, 0), (1, 3)] {
            drives.tell(&format!("sdo_block 1 {knows_blocks}"));
            drives.tell(&format!("sdo_block_drop 1 {lost}"));
            bus.write(ECHO, b"something else", false).unwrap();
            let case = format!("{length} bytes, known {knows_blocks}, lost {lost}");
            assert_eq!(bus.write(ECHO, &text(length), true), Ok(()), "{case}");
            drives.tell("sdo_block_drop 1 0");
            assert_eq!(bus.read(ECHO, true), Ok(text(length)), "{case}");
        }
    }
}

/// Refusals of a drive in its present state, with their texts, and a silent drive: the next transfer works.
#[test]
fn a_drive_refuses_or_is_silent_and_the_next_transfer_works() {
    let mut drives = CanDrives::boot("3");
    let mut bus = Bus::open(&drives, 3);
    drives.tell("sdo_abort 3 0x1008 0 0x08000022");
    let refused = "the data cannot be stored in the present state of the device (08000022h)";
    assert!(bus.read(NAME, false).unwrap_err().ends_with(refused));
    drives.tell("sdo_abort 3 0x1008 0 0");
    drives.tell("sdo_mute 3 1");
    assert_eq!(bus.read(NAME, false), Err("1008h:00: the device has not answered for 500 ms".to_owned()));
    drives.tell("sdo_mute 3 0");
    assert_eq!(bus.read(NAME, true), Ok(b"cia402-sim".to_vec()));
}

/// A drive that is reset boots, reports it, and is pre-operational; after a start it is operational.
#[test]
fn a_drive_that_is_reset_boots() {
    let drives = CanDrives::boot("5");
    let mut bus = Bus::open(&drives, 5);
    let node = NodeId::new(5).unwrap();
    bus.send(&NmtCommand::ResetNode.frame(Some(node)));
    assert_eq!(bus.next_state(), NmtState::BootUp);
    bus.write(Object { index: 0x1017, sub: 0 }, &20_u16.to_le_bytes(), false).unwrap();
    assert_eq!(bus.next_state(), NmtState::PreOperational);
    bus.send(&NmtCommand::Start.frame(None));
    while bus.next_state() != NmtState::Operational {}
}

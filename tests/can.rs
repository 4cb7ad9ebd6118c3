//! Objects of CANopen drives that somebody else has written: read and written over slcan, as a user's adapter does it.

mod support;

use lineshaft_can::sdo::Object;
use lineshaft_can::{NmtCommand, NmtState, NodeId};
use support::can::{Bus, CanDrives};

const NAME: Object = Object { index: 0x1008, sub: 0 };
const ECHO: Object = Object { index: 0x2001, sub: 0 };

/// Numbers in one frame, texts in segments and in blocks, both ways; a device that knows no blocks; segments that get lost.
#[test]
fn objects_are_read_and_written() {
    let mut drives = CanDrives::boot("1-2");
    let mut bus = Bus::open(&drives, 1);
    for in_blocks in [false, true] {
        assert_eq!(bus.read(NAME, in_blocks), Ok(b"cia402-sim".to_vec()));
        assert_eq!(bus.read(Object { index: 0x1018, sub: 2 }, in_blocks), Ok(0x4020_0001_u32.to_le_bytes().to_vec()));
    }
    assert_eq!(bus.write(Object { index: 0x1017, sub: 0 }, &100_u16.to_le_bytes(), true), Ok(()));
    assert_eq!(bus.read(Object { index: 0x1017, sub: 0 }, false), Ok(vec![100, 0]));
    // Lengths about one segment, one block, and several.
    for length in [5, 7, 8, 32, 49, 889, 890, 2000] {
        let text: Vec<u8> = (b'a'..=b'z').cycle().take(length).collect();
        for (in_blocks, knows_blocks, lost) in [(false, 1, 0), (true, 1, 0), (true, 0, 0), (true, 1, 3)] {
            drives.tell(&format!("sdo_block 1 {knows_blocks}"));
            drives.tell(&format!("sdo_block_drop 1 {lost}"));
            bus.write(ECHO, b"something else", false).unwrap();
            let case = format!("{length} bytes, blocks {in_blocks}, known {knows_blocks}, lost {lost}");
            assert_eq!(bus.write(ECHO, &text, in_blocks), Ok(()), "{case}");
            drives.tell("sdo_block_drop 1 0");
            assert_eq!(bus.read(ECHO, in_blocks), Ok(text.clone()), "{case}");
        }
    }
}

/// What a drive refuses, in words, and one that is silent: the next transfer works.
#[test]
fn a_drive_refuses_or_is_silent_and_the_next_transfer_works() {
    let mut drives = CanDrives::boot("3");
    let mut bus = Bus::open(&drives, 3);
    let refused = "5FFFh:00: the device refuses: the object does not exist (06020000h)";
    assert_eq!(bus.read(Object { index: 0x5FFF, sub: 0 }, false), Err(refused.to_owned()));
    let refused = "1008h:00: the device refuses: the object can only be read (06010002h)";
    assert_eq!(bus.write(NAME, b"another name", false), Err(refused.to_owned()));
    drives.tell("sdo_abort 3 0x1008 0 0x08000022");
    let refused = "the data cannot be stored in the present state of the device (08000022h)";
    assert!(bus.read(NAME, false).unwrap_err().ends_with(refused));
    drives.tell("sdo_abort 3 0x1008 0 0");
    drives.tell("sdo_mute 3 1");
    assert_eq!(bus.read(NAME, false), Err("1008h:00: the device has not answered for 500 ms".to_owned()));
    drives.tell("sdo_mute 3 0");
    assert_eq!(bus.read(NAME, true), Ok(b"cia402-sim".to_vec()));
}

/// A drive that is reset boots, tells it, and is pre-operational; started, it is operational.
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

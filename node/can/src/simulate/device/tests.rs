//! Tests of a simulated drive as a CANopen device.

use super::*;
use crate::{Monitoring, NmtCommand};
use lineshaft_cia402::object::Object;
use lineshaft_cia402::objects;
use lineshaft_core::drive::{DriveInput, DriveOutput, Mode};

const MASTER: NodeId = NodeId::new(127).expect("a node");

fn node() -> NodeId {
    NodeId::new(3).unwrap()
}

/// Returns a drive that has booted.
fn device() -> Device {
    let mut device = Device::new(&DeviceConfig::plain_drive(0, node(), Monitoring::None), ms(2)).unwrap();
    let mut out = Vec::new();
    device.boot(&mut out);
    assert_eq!(out, [Frame::data(node().heartbeat(), &[0]).unwrap()]);
    device
}

fn ms(number: u64) -> Duration {
    Duration::from_millis(number)
}

/// Writes an object of 1, 2 or 4 bytes.
fn write(device: &mut Device, object: Object, data: &[u8], now: Duration) {
    let [low, high] = object.index.to_le_bytes();
    let mut request = [0x23 | (4 - data.len() as u8) << 2, low, high, object.sub, 0, 0, 0, 0];
    request[4..4 + data.len()].copy_from_slice(data);
    let mut out = Vec::new();
    device.take(&Frame::of(node().sdo_request(), request), now, &mut out);
    assert_eq!(out, [Frame::of(node().sdo_response(), [0x60, low, high, object.sub, 0, 0, 0, 0])]);
}

fn ticked(device: &mut Device, now: Duration) -> Vec<Vec<u8>> {
    let mut out = Vec::new();
    device.tick(now, &mut out);
    out.iter().map(|frame| frame.bytes().to_vec()).collect()
}

#[test]
fn the_heartbeat_has_the_time_of_1017h_and_shows_the_state() {
    let mut device = device();
    assert_eq!(ticked(&mut device, ms(1_000)), [[0_u8; 0]; 0]);
    write(&mut device, can_objects::PRODUCER_HEARTBEAT, &100_u16.to_le_bytes(), ms(1_000));
    assert_eq!(ticked(&mut device, ms(1_099)), [[0_u8; 0]; 0]);
    assert_eq!(ticked(&mut device, ms(1_100)), [[0x7F]]);
    device.take(&NmtCommand::Start.frame(Some(node())), ms(1_150), &mut Vec::new());
    assert_eq!(ticked(&mut device, ms(1_200)), [[0x05]]);
    device.take(&NmtCommand::Stop.frame(None), ms(1_250), &mut Vec::new());
    assert_eq!(ticked(&mut device, ms(1_300)), [[0x04]]);
}

/// The toggle bit starts at 0 (CiA 301).
#[test]
fn guarding_is_answered_with_a_toggle_bit() {
    let mut device = device();
    let mut out = Vec::new();
    for _ in 0..3 {
        device.take(&Frame::remote(node().heartbeat(), 1).unwrap(), ms(0), &mut out);
    }
    let states: Vec<_> = out.iter().map(|frame| frame.bytes().to_vec()).collect();
    assert_eq!(states, [[0x7F], [0xFF], [0x7F]]);
}

#[test]
fn another_node_is_not_reset_and_a_reset_boots() {
    let mut device = device();
    let mut out = Vec::new();
    device.take(&NmtCommand::ResetNode.frame(NodeId::new(4)), ms(0), &mut out);
    assert!(out.is_empty());
    write(&mut device, objects::CONTROL_WORD, &0x0F_u16.to_le_bytes(), ms(0));
    device.take(&NmtCommand::ResetNode.frame(Some(node())), ms(0), &mut out);
    assert_eq!(out, [Frame::data(node().heartbeat(), &[0]).unwrap()]);
    assert_eq!(device.drive.table.get(objects::CONTROL_WORD), 0);
}

/// Drives that are enabled and off: 300 ms without the heartbeat of the master.
#[test]
fn enabled_drive_detects_loss_of_master() {
    for (status, is_lost) in [(0x0037_u16, true), (0x0040, false)] {
        let mut device = device();
        device.drive.table.set(objects::STATUS_WORD, status.into());
        write(&mut device, can_objects::CONSUMER_HEARTBEAT, &0x007F_012C_u32.to_le_bytes(), ms(0));
        device.tick(ms(500), &mut Vec::new());
        assert!(!device.take_master_loss(), "it is watched from its first heartbeat on");
        device.take(&Frame::data(MASTER.heartbeat(), &[0x05]).unwrap(), ms(1_000), &mut Vec::new());
        device.tick(ms(1_299), &mut Vec::new());
        assert!(!device.take_master_loss());
        device.tick(ms(1_300), &mut Vec::new());
        assert_eq!((device.take_master_loss(), device.take_master_loss()), (is_lost, false));
    }
}

/// 6041h and 6064h are sent with each SYNC; 6040h and 607Ah apply with the SYNC after their reception.
#[test]
fn pdos_go_with_sync_and_apply_with_sync() {
    let mut device = device();
    let (tpdo, rpdo) = (node().tpdo(1).unwrap(), node().rpdo(1).unwrap());
    let at = |index, sub| Object { index, sub };
    let pdos = [(0x1400, rpdo, [0x6040_0010_u32, 0x607A_0020]), (0x1800, tpdo, [0x6041_0010, 0x6064_0020])];
    for (communication, id, entries) in pdos {
        for (sub, entry) in (1..).zip(entries) {
            write(&mut device, at(communication + 0x200, sub), &entry.to_le_bytes(), ms(0));
        }
        write(&mut device, at(communication + 0x200, 0), &[2], ms(0));
        write(&mut device, at(communication, 2), &[1], ms(0));
        write(&mut device, at(communication, 1), &u32::from(id.get()).to_le_bytes(), ms(0));
    }
    let setpoint = Frame::data(rpdo, &[0x0F, 0x00, 0x18, 0xFC, 0xFF, 0xFF]).unwrap();
    device.take(&setpoint, ms(0), &mut Vec::new());
    device.take(&NmtCommand::Start.frame(Some(node())), ms(0), &mut Vec::new());
    let mut out = Vec::new();
    device.synchronize(&mut out);
    assert_eq!(device.drive.table.get(objects::CONTROL_WORD), 0, "it was not operational");

    device.take(&setpoint, ms(0), &mut Vec::new());
    assert_eq!(device.drive.table.get(objects::CONTROL_WORD), 0, "it waits for SYNC");
    let drive = DriveInput { count: -2, status: 0x0040, ..DriveInput::default() };
    let inputs = Inputs { drive: vec![drive], ..Inputs::default() };
    device.update_objects(&inputs, &mut out);
    out.clear();
    device.synchronize(&mut out);
    // 0240h: switch on disabled, remote.
    assert_eq!(out, [Frame::data(tpdo, &[0x40, 0x02, 0xFE, 0xFF, 0xFF, 0xFF]).unwrap()]);
    assert_eq!(
        (device.drive.table.get(objects::CONTROL_WORD), device.drive.table.signed(objects::TARGET_POSITION)),
        (0x0F, -1_000)
    );
}

/// A 32-bit target wraps to the value nearest to the present position.
#[test]
fn targets_follow_counts_beyond_32_bits() {
    let mut device = device();
    let count = (1_i64 << 32) - 10;
    let inputs = Inputs { drive: vec![DriveInput { count, ..DriveInput::default() }], ..Inputs::default() };
    let mut outputs = Outputs { drive: vec![DriveOutput::default()], ..Outputs::default() };
    device.drive.table.set(objects::MODE, 8);
    device.drive.table.set(objects::TARGET_POSITION, 5);
    device.run_mode(&inputs, &mut outputs);
    assert_eq!((outputs.drive[0].position, outputs.drive[0].mode), ((1 << 32) + 5, Mode::Position));
    device.drive.table.set(objects::MODE, 0);
    device.run_mode(&inputs, &mut outputs);
    assert_eq!((outputs.drive[0].position, outputs.drive[0].mode), (count, Mode::None));
}

#[test]
fn fault_and_its_end_send_emergency_messages() {
    let mut device = device();
    let show = |device: &mut Device, fault| {
        let drive = DriveInput { fault, ..DriveInput::default() };
        let mut out = Vec::new();
        device.update_objects(&Inputs { drive: vec![drive], ..Inputs::default() }, &mut out);
        out.iter().map(|frame| (frame.id(), frame.bytes().to_vec())).collect::<Vec<_>>()
    };
    assert!(show(&mut device, 0).is_empty());
    assert_eq!(show(&mut device, 0x8611), [(node().emergency(), vec![0x11, 0x86, 0x01, 0, 0, 0, 0, 0])]);
    assert!(show(&mut device, 0x8611).is_empty());
    assert_eq!(device.drive.table.get(objects::ERROR_CODE), 0x8611);
    assert_eq!(show(&mut device, 0), [(node().emergency(), vec![0; 8])]);
}

fn master_beats(device: &mut Device, now: Duration) -> Vec<Frame> {
    let mut out = Vec::new();
    device.take(&Frame::data(MASTER.heartbeat(), &[0x05]).unwrap(), now, &mut out);
    out
}

/// 6007h: 0 no action, 1 fault, 2 disable voltage (control word 0), 3 quick stop (control word 2).
#[test]
fn drive_does_what_6007h_says_when_it_is_stopped_by_nmt() {
    for (option, has_fault, control) in [(0_u16, false, 0x0F), (1, true, 0x0F), (2, false, 0x00), (3, false, 0x02)] {
        let mut device = device();
        device.drive.table.set(objects::STATUS_WORD, 0x0237);
        write(&mut device, objects::CONTROL_WORD, &0x0F_u16.to_le_bytes(), ms(0));
        write(&mut device, simulated::ABORT_CONNECTION, &option.to_le_bytes(), ms(0));
        device.take(&NmtCommand::Stop.frame(None), ms(0), &mut Vec::new());
        assert_eq!(
            (device.take_master_loss(), device.drive.table.get(objects::CONTROL_WORD)),
            (has_fault, control),
            "{option}"
        );
    }
}

/// Guard time 100 ms, life time factor 3: 300 ms without guarding, counted from the first guarding request. EMCY 8130h; error register:
/// generic error, communication error.
#[test]
fn master_that_guards_no_longer_is_lost_after_the_life_time() {
    let mut device = device();
    device.drive.table.set(objects::STATUS_WORD, 0x0237);
    write(&mut device, can_objects::GUARD_TIME, &100_u16.to_le_bytes(), ms(0));
    write(&mut device, can_objects::LIFE_TIME_FACTOR, &[3], ms(0));
    assert_eq!(ticked(&mut device, ms(5_000)), [[0_u8; 0]; 0]);
    device.take(&Frame::remote(node().heartbeat(), 1).unwrap(), ms(5_000), &mut Vec::new());
    assert_eq!(ticked(&mut device, ms(5_299)), [[0_u8; 0]; 0]);
    assert_eq!(ticked(&mut device, ms(5_300)), [[0x30, 0x81, 0x11, 0, 0, 0, 0, 0]]);
    assert!(device.take_master_loss());
    assert_eq!(ticked(&mut device, ms(9_000)), [[0_u8; 0]; 0], "it is reported once");
}

/// 1029h:01: 0 pre-operational, 1 no change, 2 stopped.
#[test]
fn device_without_its_master_changes_its_state_by_1029h() {
    let states = [(0, NmtState::PreOperational), (1, NmtState::Operational), (2, NmtState::Stopped)];
    for (behaviour, state) in states {
        let mut device = device();
        write(&mut device, can_objects::ERROR_BEHAVIOUR, &[behaviour], ms(0));
        write(&mut device, can_objects::CONSUMER_HEARTBEAT, &0x007F_0064_u32.to_le_bytes(), ms(0));
        device.take(&NmtCommand::Start.frame(None), ms(0), &mut Vec::new());
        assert!(master_beats(&mut device, ms(0)).is_empty());
        device.tick(ms(100), &mut Vec::new());
        assert_eq!(device.state, state);
    }
}

/// The drive is off, so it has no fault. EMCY 8130h, and 0000h when the master returns.
#[test]
fn error_of_communication_ends_when_the_master_is_back() {
    let mut device = device();
    write(&mut device, can_objects::CONSUMER_HEARTBEAT, &0x007F_0064_u32.to_le_bytes(), ms(0));
    master_beats(&mut device, ms(0));
    assert_eq!(ticked(&mut device, ms(100)), [[0x30, 0x81, 0x11, 0, 0, 0, 0, 0]]);
    assert_eq!((device.take_master_loss(), device.drive.table.get(simulated::ERROR_REGISTER)), (false, 0x11));
    assert_eq!(master_beats(&mut device, ms(200)), [Frame::of(node().emergency(), [0; 8])]);
    assert_eq!(device.drive.table.get(simulated::ERROR_REGISTER), 0);
    assert!(master_beats(&mut device, ms(250)).is_empty());
}

/// Reset communication: only objects 1000h to 1FFFh are reset; the device boots.
#[test]
fn reset_of_communication_keeps_the_objects_of_the_drive() {
    let mut device = device();
    write(&mut device, objects::CONTROL_WORD, &0x06_u16.to_le_bytes(), ms(0));
    write(&mut device, can_objects::PRODUCER_HEARTBEAT, &100_u16.to_le_bytes(), ms(0));
    device.take(&NmtCommand::Start.frame(None), ms(0), &mut Vec::new());
    let mut out = Vec::new();
    device.take(&NmtCommand::ResetCommunication.frame(None), ms(0), &mut out);
    assert_eq!(out, [Frame::data(node().heartbeat(), &[0]).unwrap()]);
    let kept = [objects::CONTROL_WORD, can_objects::PRODUCER_HEARTBEAT].map(|object| device.drive.table.get(object));
    assert_eq!((kept, device.state), ([0x06, 0], NmtState::PreOperational));
    assert_eq!(ticked(&mut device, ms(500)), [[0_u8; 0]; 0]);
}

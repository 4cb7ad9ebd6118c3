use super::super::bus::Bus;
use super::super::fixtures;
use super::*;
use crate::config::Master;
use crate::eds;
use crate::layout::Layout;
use crate::transport::{Transport, TransportError};
use crate::{Frame, Id};
use lineshaft_cia402::config::Identity;
use lineshaft_cia402::drive_type::DriveType;
use lineshaft_cia402::mapping::Extras;
use lineshaft_cia402::mode::DriveMode;
use lineshaft_core::drive::BusState;
use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex};

/// Simulated device with an object dictionary of numbers, as strict as the standard: a PDO can be mapped only while it is disabled and has
/// no entries.
#[derive(Debug, Default)]
struct Device {
    objects: BTreeMap<(u16, u8), Vec<u8>>,
    /// Writes in their order.
    written: Vec<(u16, u8, u32)>,
    nmt: Vec<u8>,
    comes: VecDeque<Frame>,
    answers: usize,
    refuses: Option<(u16, u8)>,
    /// Values that the device refuses, by object.
    denies: Vec<(u16, u8, u32)>,
    /// Whether the device accepts entries of an enabled PDO.
    maps_while_on: bool,
}

const RESPONSE: u16 = 0x583;

fn number(data: &[u8]) -> u32 {
    data.iter().rev().fold(0, |number, byte| number << 8 | u32::from(*byte))
}

impl Device {
    fn drive() -> Self {
        let mut device = Self { answers: 1, ..Self::default() };
        let mut set = |index: u16, sub: u8, data: &[u8]| device.objects.insert((index, sub), data.to_vec());
        set(0x1000, 0, &0x0002_0192_u32.to_le_bytes());
        set(0x1005, 0, &0x80_u32.to_le_bytes());
        set(0x1006, 0, &0_u32.to_le_bytes());
        set(0x1016, 1, &0_u32.to_le_bytes());
        set(0x1017, 0, &0_u16.to_le_bytes());
        for (sub, value) in [(1, 0x1234_u32), (2, 0x5678), (3, 1), (4, 99)] {
            set(0x1018, sub, &value.to_le_bytes());
        }
        set(0x2080, 1, &0_u16.to_le_bytes());
        set(0x603F, 0, &0_u16.to_le_bytes());
        set(0x6040, 0, &0_u16.to_le_bytes());
        set(0x6041, 0, &0x0250_u16.to_le_bytes());
        set(0x60C2, 1, &[1]);
        set(0x60C2, 2, &[0xFD]);
        set(0x6502, 0, &(1_u32 << 7 | 1 << 5).to_le_bytes());
        for number in 0..2_u16 {
            for (communication, mapping, id) in [(0x1400, 0x1600, 0x203_u32), (0x1800, 0x1A00, 0x183)] {
                set(communication + number, 1, &(id + 0x100 * u32::from(number)).to_le_bytes());
                set(communication + number, 2, &[255]);
                set(mapping + number, 0, &[1]);
                (1..=4).for_each(|sub| drop(set(mapping + number, sub, &0x6040_0010_u32.to_le_bytes())));
            }
        }
        device
    }

    fn get(&self, index: u16, sub: u8) -> u32 {
        number(&self.objects[&(index, sub)])
    }

    /// Returns the abort code if an object must not be written now.
    fn refusal(&self, index: u16, sub: u8, value: u32) -> Option<u32> {
        let present = self.objects.get(&(index, sub));
        let Some(_) = present else { return Some(0x0602_0000) };
        if self.refuses == Some((index, sub)) || self.denies.contains(&(index, sub, value)) {
            return Some(0x0800_0022);
        }
        let is_mapping = (0x1600..0x1800).contains(&index) || (0x1A00..0x1C00).contains(&index);
        if is_mapping {
            let is_on = self.get(index - 0x200, 1) & 0x8000_0000 == 0;
            let has_objects = sub != 0 && self.get(index, 0) != 0;
            return (is_on && !self.maps_while_on || has_objects).then_some(0x0800_0022);
        }
        // CiA 301: only while the period is 0.
        (index == 0x1019 && self.get(0x1006, 0) != 0 && value != self.get(0x1019, 0)).then_some(0x0800_0022)
    }

    fn take(&mut self, frame: &Frame) {
        if frame.id() == Id::NMT {
            self.nmt.extend(frame.bytes().first());
        }
        let (0x603, &[command, low, high, sub, a, b, c, d]) = (frame.id().get(), frame.bytes()) else { return };
        let index = u16::from_le_bytes([low, high]);
        let abort = |code: u32| {
            let [a, b, c, d] = code.to_le_bytes();
            [0x80, low, high, sub, a, b, c, d]
        };
        let answer = match command {
            0x40 => match self.objects.get(&(index, sub)) {
                None => abort(0x0602_0000),
                Some(data) => {
                    let mut bytes = [0x43 | (4 - data.len() as u8) << 2, low, high, sub, 0, 0, 0, 0];
                    bytes[4..4 + data.len()].copy_from_slice(data);
                    bytes
                }
            },
            0x23 | 0x27 | 0x2B | 0x2F => {
                let data = &[a, b, c, d][..4 - usize::from(command >> 2 & 3)];
                match self.refusal(index, sub, number(data)) {
                    Some(code) => abort(code),
                    None => {
                        self.objects.insert((index, sub), data.to_vec());
                        self.written.push((index, sub, number(data)));
                        // The drive finishes a quick stop at once.
                        if index == 0x6040 {
                            self.objects.insert((0x6041, 0), 0x0250_u16.to_le_bytes().to_vec());
                        }
                        [0x60, low, high, sub, 0, 0, 0, 0]
                    }
                }
            }
            _ => return,
        };
        let answer = Frame::of(Id::new(RESPONSE).expect("11 bits"), answer);
        (0..self.answers).for_each(|_| self.comes.push_back(answer));
    }
}

#[derive(Debug)]
struct Way(Arc<Mutex<Device>>);

impl Transport for Way {
    fn send(&mut self, frame: &Frame) -> Result<(), TransportError> {
        self.0.lock().expect("one thread").take(frame);
        Ok(())
    }

    fn flush(&mut self) -> Result<(), TransportError> {
        Ok(())
    }

    fn receive(&mut self) -> Result<Option<Frame>, TransportError> {
        Ok(self.0.lock().expect("one thread").comes.pop_front())
    }

    fn state(&self) -> BusState {
        BusState::Active
    }
}

fn config() -> BusConfig {
    let node = NodeId::new(3).expect("1 to 127");
    let mut drive = DeviceConfig::plain_drive(0, node, Monitoring::Heartbeat { time_ns: 300_000_000 });
    drive.startup = vec![Write { object: Object { index: 0x2080, sub: 1 }, data: vec![5, 0] }];
    BusConfig {
        name: "bus0".to_owned(),
        transport: "socketcan:can0".parse().expect("it is an address"),
        bit_rate: None,
        serial_baudrate: None,
        cycle_ns: 4_000_000,
        sync_overflow: None,
        sdo_timeout_ns: 30_000_000,
        time_ns: None,
        master: Some(Master { node: NodeId::new(127).expect("1 to 127"), heartbeat_ns: 100_000_000 }),
        devices: vec![drive],
    }
}

/// Configures the device and returns the result.
fn run(device: &Arc<Mutex<Device>>, config: &BusConfig) -> Result<usize, String> {
    let mut port = Port::new(|(orders, reports)| Bus::new(config, orders, reports));
    port.lock().open(Box::new(Way(Arc::clone(device))));
    device.lock().expect("one thread").written.clear();
    let done = configure(&mut port, 0, config, &config.devices[0]);
    done.map(|configured| configured.written).map_err(|refusal| refusal.to_string())
}

fn device(change: impl FnOnce(&mut Device)) -> Arc<Mutex<Device>> {
    let mut device = Device::drive();
    change(&mut device);
    Arc::new(Mutex::new(device))
}

/// Values of the cell, according to CiA 301 and 402: heartbeat of 100 ms, 300 ms for node 127, period of 4 ms, RPDO 1 and TPDO 1 with SYNC,
/// the other PDOs disabled.
#[test]
fn drive_receives_startup_monitoring_and_pdo_configuration() {
    let (device, config) = (device(|_| ()), config());
    assert!(run(&device, &config).is_ok());
    let found = device.lock().unwrap();
    let expected = [
        (0x2080, 1, 5),
        (0x1017, 0, 100),
        (0x1016, 1, 127 << 16 | 300),
        (0x1006, 0, 4000),
        (0x60C2, 1, 4),
        (0x1400, 1, 0x203),
        (0x1400, 2, 1),
        (0x1600, 0, 3),
        (0x1600, 1, 0x6040_0010),
        (0x1600, 2, 0x607A_0020),
        (0x1600, 3, 0x6060_0008),
        (0x1800, 1, 0x183),
        (0x1A00, 1, 0x6041_0010),
        (0x1A00, 2, 0x6064_0020),
        (0x1A00, 3, 0x6061_0008),
        (0x1401, 1, 0x8000_0303),
        (0x1801, 1, 0x8000_0283),
    ];
    for (index, sub, value) in expected {
        assert_eq!(found.get(index, sub), value, "{index:04X}h:{sub:02X}");
    }
    assert_eq!(found.nmt, [0x80, 0x01], "pre-operational, then operational");
}

#[test]
fn configured_drive_is_only_disabled() {
    let (device, config) = (device(|_| ()), config());
    assert!(run(&device, &config).is_ok_and(|written| written > 0));
    assert_eq!(run(&device, &config), Ok(0));
    assert_eq!(device.lock().unwrap().written, [(0x6040, 0, 0)]);
}

/// With 1020h, the match with the last configuration replaces the comparison of all other values.
#[test]
fn a_drive_that_verifies_its_configuration_is_not_compared() {
    let (device, config) = (
        device(|device| {
            (1..=2).for_each(|sub| drop(device.objects.insert((0x1020, sub), vec![0; 4])));
        }),
        config(),
    );
    assert!(run(&device, &config).is_ok_and(|written| written > 2));
    // A value is changed while 1020h stays, which real devices do not do: the value is not corrected.
    device.lock().unwrap().objects.insert((0x2080, 1), vec![9, 0]);
    assert_eq!((run(&device, &config), device.lock().unwrap().get(0x2080, 1)), (Ok(0), 9));
    // A device clears 1020h with each change.
    device.lock().unwrap().objects.insert((0x1020, 1), vec![0; 4]);
    assert_eq!(run(&device, &config), Ok(3));
    assert_eq!(device.lock().unwrap().get(0x2080, 1), 5);
    let other = BusConfig { cycle_ns: 2_000_000, ..config };
    assert!(run(&device, &other).is_ok_and(|written| written > 2), "another cycle is another configuration");
}

/// Quick stop first, then disable voltage, and only then other writes.
#[test]
fn enabled_drive_is_stopped_before_configuration() {
    let (device, config) = (device(|device| drop(device.objects.insert((0x6041, 0), vec![0x37, 0x02]))), config());
    assert!(run(&device, &config).is_ok());
    assert_eq!(device.lock().unwrap().written[..2], [(0x6040, 0, 2), (0x6040, 0, 0)]);
}

/// The overflow value can be changed only while the period is 0 (CiA 301).
#[test]
fn the_sync_counter_is_set_while_the_period_is_0() {
    let (device, config) = (
        device(|device| {
            device.objects.insert((0x1019, 0), vec![0]);
            device.objects.insert((0x1006, 0), 1000_u32.to_le_bytes().to_vec());
        }),
        BusConfig { sync_overflow: Some(10), ..config() },
    );
    assert!(run(&device, &config).is_ok());
    let written: Vec<_> = device.lock().unwrap().written.clone();
    let sync: Vec<_> = written.into_iter().filter(|(index, ..)| matches!(index, 0x1006 | 0x1019)).collect();
    assert_eq!(sync, [(0x1006, 0, 0), (0x1019, 0, 10), (0x1006, 0, 4000)]);
}

#[test]
fn mismatch_with_cell_is_refused_with_both_values() {
    let identity = |identity| {
        let mut config = config();
        config.devices[0].identity = identity;
        run(&device(|_| ()), &config).unwrap_err()
    };
    let id = Identity::default();
    assert_eq!(
        identity(Identity { vendor: Some(7), ..id }),
        "its vendor (1018h:01) is 00001234h; 00000007h is expected"
    );
    assert!(identity(Identity { product: Some(7), ..id }).starts_with("its product code (1018h:02) is 00005678h"));
    assert!(identity(Identity { revision: Some(7), ..id }).starts_with("its revision number (1018h:03) is 00000001h"));
    assert!(identity(Identity { serial: Some(7), ..id }).starts_with("its serial number (1018h:04) is 00000063h"));
    let with = |change: fn(&mut Device)| run(&device(change), &config()).unwrap_err();
    assert_eq!(
        with(|device| drop(device.objects.insert((0x1000, 0), 0x0003_0191_u32.to_le_bytes().to_vec()))),
        "its device type (1000h) is 00030191h, profile 401; profile 402 (drive) is expected"
    );
    assert_eq!(
        with(|device| drop(device.objects.insert((0x6502, 0), vec![0x25, 0, 0, 0]))),
        "it does not offer mode 8 (csp; 6502h is 00000025h: pp, pv, hm); key mode chooses another"
    );
    assert_eq!(
        with(|device| device.refuses = Some((0x2080, 1))),
        "2080h:01: the device refuses: the data cannot be stored in the present state of the device (08000022h)"
    );
    assert_eq!(
        with(|device| device.answers = 2),
        "each request has two answers: another device has the node id 3 as well"
    );
    assert_eq!(with(|device| device.answers = 0), "it is not there: 1000h:00: the device has not answered for 30 ms");
    assert_eq!(
        with(|device| drop(device.objects.remove(&(0x1800, 1)))),
        "1800h:01 does not exist: the device has no PDO 1"
    );
}

/// 10,000 increments per motor revolution and 3 motor revolutions per 2 shaft revolutions are 15,000 increments per shaft revolution.
#[test]
fn a_scale_that_contradicts_the_factors_of_the_drive_is_refused_by_both_numbers() {
    let with = |counts: (u64, u64), objects: &[(u16, u8, u32)]| {
        let mut config = config();
        fixtures::as_drive(&mut config.devices[0]).counts_per_shaft_revolution = Some(counts);
        let add = |device: &mut Device| {
            for (index, sub, value) in objects {
                device.objects.insert((*index, *sub), value.to_le_bytes().to_vec());
            }
        };
        run(&device(add), &config).map(drop)
    };
    let encoder = [(0x608F, 1, 10_000), (0x608F, 2, 1), (0x6091, 1, 3), (0x6091, 2, 2)];
    let feed = [encoder.as_slice(), &[(0x6092, 1, 360_000), (0x6092, 2, 7)]].concat();
    assert_eq!(with((15_000, 1), &encoder), Ok(()));
    assert_eq!(with((360_000, 7), &feed), Ok(()), "the feed constant counts before the others");
    let sentence = "the drive counts 15000 inc per revolution of its shaft (608Fh, 6091h); by scale and feed of the cell it is 4000 inc";
    assert_eq!(with((4000, 1), &encoder).unwrap_err(), sentence);
    assert!(with((15_000, 1), &feed).unwrap_err().contains("360000/7 inc per revolution of its shaft (6092h)"));
    assert!(with((1, 1), &[]).unwrap_err().contains("neither 6092h nor 608Fh"));
    assert!(with((1, 1), &[(0x608F, 1, 1), (0x608F, 2, 0)]).is_err(), "no revolution at all");
}

/// PDO 1 of a drive that the user has mapped is not changed if its fields have the lengths of the drive type; otherwise its data would be
/// misinterpreted.
///
/// Proves: MACS-CAN-11
#[test]
fn user_mapping_with_wrong_lengths_is_refused() {
    let mut config = config();
    let of_type = DriveType::decode(-11).unwrap();
    config.devices[0].layout = Layout::of_drive_type(config.devices[0].node, of_type).unwrap();
    let mapped = |index, entries: &[u32]| {
        let of = |(sub, entry): (u8, &u32)| ((index, sub), entry.to_le_bytes().to_vec());
        let count = ((index, 0), vec![entries.len() as u8]);
        (1..).zip(entries).map(of).chain([count]).collect::<Vec<_>>()
    };
    let with = |asked: &[u32]| {
        device(|device| {
            device.objects.extend(mapped(0x1600, asked));
            device.objects.extend(mapped(0x1A00, &[0x6041_0010, 0x6064_0020]));
            // The mode is in no PDO, so it is written.
            device.objects.insert((0x6060, 0), vec![0]);
        })
    };
    let good = with(&[0x6040_0010, 0x3001_0120]);
    assert_eq!(run(&good, &config).map(drop), Ok(()));
    assert!(good.lock().unwrap().written.iter().all(|(index, ..)| !matches!(index, 0x1600 | 0x1A00)), "left alone");
    let sentence = "1600h maps 2, 1 bytes; 2, 4 bytes are expected, mapped before the drive is used here";
    assert_eq!(run(&with(&[0x6040_0010, 0x6060_0008]), &config).unwrap_err(), sentence);
}

/// The identifier of a PDO that the device keeps enabled does no harm, unless it is that of other process data: its frames would be
/// misinterpreted.
#[test]
fn pdo_not_needed_with_read_only_cob_id_stays_on_unless_its_identifier_is_used() {
    for index in [0x1401, 0x1801] {
        let device = device(|device| device.refuses = Some((index, 1)));
        assert!(run(&device, &config()).is_ok(), "{index:04X}h");
        let found = device.lock().unwrap();
        assert_eq!(found.get(index, 1) & 0x8000_0000, 0, "{index:04X}h is still on");
        assert_eq!((found.get(0x1400, 1), found.get(0x1800, 1), found.nmt.last()), (0x203, 0x183, Some(&1)));
    }
    // 183h is TPDO 1 of the drive itself, 185h that of another drive on the bus.
    for (index, id) in [(0x1401, 0x183_u32), (0x1801, 0x183), (0x1401, 0x185), (0x1801, 0x185)] {
        let device = device(|device| {
            device.refuses = Some((index, 1));
            device.objects.insert((index, 1), id.to_le_bytes().to_vec());
        });
        let mut config = config();
        config.devices.push(DeviceConfig::plain_drive(1, NodeId::new(5).expect("1 to 127"), Monitoring::None));
        let refused = run(&device, &config).unwrap_err();
        assert!(refused.starts_with(&format!("{index:04X}h:01: the device refuses")), "{refused}");
        assert!(refused.ends_with(&format!("its identifier {id:03X}h is that of other process data")), "{refused}");
    }
}

/// Returns a drive with digital inputs and error code in TPDO 2, on change; `keep`: only these objects of it.
fn config_with_extras(keep: &[u16]) -> BusConfig {
    let known = eds::parse(include_bytes!("../../../../../launch-configs/can/cia402_sim.eds"), Some(3)).unwrap();
    let mut config = config();
    let drive = &mut config.devices[0];
    drive.layout = Layout::plan(drive.node, DriveMode::Csp, Extras::default(), &drive.terminals, Some(&known)).unwrap();
    drive.layout.told[1].fields.retain(|field| keep.contains(&field.object.index));
    config
}

/// Type 255, then 254, then 1 (with each SYNC). Data that no cycle needs is left out; the switches of the drive are not.
#[test]
fn optional_pdo_of_a_refused_transmission_type_has_another_one_or_is_left_out() {
    let refuses =
        |types: &[u32]| device(|device| device.denies = types.iter().map(|kind| (0x1801, 2, *kind)).collect());
    let both = config_with_extras(&[0x60FD, 0x603F]);
    let cases: [(&[u32], u32); 3] = [(&[], 255), (&[255], 254), (&[255, 254], 1)];
    for (refused, used) in cases {
        let device = refuses(refused);
        assert!(run(&device, &both).is_ok(), "{refused:?}");
        let found = device.lock().unwrap();
        assert_eq!((found.get(0x1801, 1), found.get(0x1801, 2), found.get(0x1A01, 0)), (0x283, used, 2), "{refused:?}");
        assert_eq!((found.get(0x1A01, 1), found.get(0x1A01, 2)), (0x60FD_0020, 0x603F_0010));
    }
    let none = refuses(&[255, 254, 1]);
    let refused = run(&none, &both).unwrap_err();
    assert!(refused.starts_with("1801h:02: the device refuses"), "{refused}");
    assert!(run(&none, &config_with_extras(&[0x603F])).is_ok());
    assert_eq!(none.lock().unwrap().get(0x1801, 1), 0x8000_0283, "off");
}

/// 203h, 183h and 283h are the default identifiers of node 3 (CiA 301). A device that is pre-operational sends no PDOs.
#[test]
fn pdo_with_its_identifier_in_a_read_only_cob_id_is_mapped_while_it_is_on() {
    let expected: [(u16, u32, u16, &[u32]); 3] = [
        (0x1400, 0x203, 0x1600, &[3, 0x6040_0010, 0x607A_0020, 0x6060_0008]),
        (0x1800, 0x183, 0x1A00, &[3, 0x6041_0010, 0x6064_0020, 0x6061_0008]),
        (0x1801, 0x283, 0x1A01, &[1, 0x603F_0010]),
    ];
    for (communication, id, mapping, entries) in expected {
        let device = device(|device| {
            device.refuses = Some((communication, 1));
            device.maps_while_on = true;
        });
        assert_eq!(run(&device, &config_with_extras(&[0x603F])).map(drop), Ok(()), "{communication:04X}h");
        let found = device.lock().unwrap();
        assert_eq!(found.get(communication, 1), id);
        for (sub, entry) in (0..).zip(entries) {
            assert_eq!(found.get(mapping, sub), *entry, "{mapping:04X}h:{sub:02X}");
        }
        assert_eq!(found.get(communication, 2), if communication == 0x1801 { 255 } else { 1 });
        assert_eq!(found.nmt, [0x80, 0x01], "mapped in pre-operational");
    }
}

/// The data of such a PDO would be interpreted as the planned objects. It cannot be left out, and its own identifier does not count as that
/// of another PDO.
#[test]
fn pdo_with_its_identifier_that_can_neither_be_switched_off_nor_mapped_is_refused_by_its_cob_id() {
    for (communication, number) in [(0x1400, 1), (0x1800, 1), (0x1801, 2)] {
        let stuck = device(|device| device.refuses = Some((communication, 1)));
        let refused = run(&stuck, &config_with_extras(&[0x603F])).unwrap_err();
        let sentence = format!("PDO {number} cannot be mapped: {communication:04X}h:01 is read-only; ");
        let mapping = communication + 0x200;
        assert!(refused.starts_with(&format!("{sentence}{mapping:04X}h:00: the device refuses: ")), "{refused}");
        assert!(!refused.contains("not needed"), "{refused}");
    }
    let of_another_type = device(|device| {
        device.refuses = Some((0x1800, 1));
        device.denies = vec![(0x1800, 2, 1)];
        device.maps_while_on = true;
    });
    let refused = run(&of_another_type, &config()).unwrap_err();
    let sentence = "PDO 1 cannot be mapped: 1800h:01 is read-only; 1800h:02: the device refuses: ";
    assert!(refused.starts_with(sentence), "{refused}");
    // A PDO with another identifier is left out, and stays enabled.
    let other = device(|device| {
        device.refuses = Some((0x1801, 1));
        device.objects.insert((0x1801, 1), 0x2C3_u32.to_le_bytes().to_vec());
    });
    assert_eq!(run(&other, &config_with_extras(&[0x603F])).map(drop), Ok(()));
    assert_eq!(other.lock().unwrap().get(0x1801, 1), 0x2C3);
}

/// Process data of each cycle requires transmission type 1.
#[test]
fn cyclic_pdo_requires_transmission_type_1() {
    let device = device(|device| device.denies = vec![(0x1800, 2, 1)]);
    let refused = run(&device, &config()).unwrap_err();
    assert!(refused.starts_with("1800h:02: the device refuses"), "{refused}");
}

/// 6060h and 6061h are in no PDO, and are not written before the cycles run: they are exchanged by SDO during cycles.
#[test]
fn drive_that_cannot_map_its_mode_is_configured_without_it() {
    let mut config = config();
    let known = fixtures::dictionary_without(&["6060", "6061"]);
    let drive = &mut config.devices[0];
    drive.layout = Layout::plan(drive.node, DriveMode::Csp, Extras::default(), &drive.terminals, Some(&known)).unwrap();
    let device = device(|_| ());
    assert!(run(&device, &config).is_ok());
    let found = device.lock().unwrap();
    let entries = [(0x1600, 0), (0x1600, 1), (0x1600, 2), (0x1A00, 0), (0x1A00, 1), (0x1A00, 2)];
    let values = entries.map(|(index, sub)| found.get(index, sub));
    assert_eq!(values, [2, 0x6040_0010, 0x607A_0020, 2, 0x6041_0010, 0x6064_0020]);
    assert!(found.written.iter().all(|(index, ..)| *index != 0x6060));
}

/// Without a dictionary the drive itself reports which object it cannot map.
#[test]
fn object_that_a_drive_does_not_map_is_named() {
    let refused = run(&device(|device| device.refuses = Some((0x1A00, 3))), &config()).unwrap_err();
    assert!(refused.starts_with("6061h:00 cannot be mapped to a PDO: 1A00h:03: the device refuses: "), "{refused}");
    assert!(
        refused.ends_with("it goes by SDO if the EDS of the drive (key eds) says that it cannot be mapped"),
        "{refused}"
    );
    let refused = run(&device(|device| device.refuses = Some((0x1600, 2))), &config()).unwrap_err();
    assert!(refused.starts_with("607Ah:00 cannot be mapped to a PDO: 1600h:02: the device refuses: "), "{refused}");
    assert!(!refused.contains("SDO"), "{refused}");
}

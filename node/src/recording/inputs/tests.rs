//! Any inputs can be written and read back; a message that does not fit is refused with an error message.

use super::*;
use crate::cell::Cell;
use lineshaft_core::machine::Machine;
use lineshaft_msgs::{Message as _, cdr};
use proptest::prelude::*;

const CELL: &str = "
lineshaft: 1
cycle: 1 ms
backends: {plant: {type: sim}}
io:
  start: {type: di, backend: plant, address: 0}
  gap: {type: ai, backend: plant, address: 0}
  lamp: {type: do, backend: plant, address: 0}
  mark: {type: di, backend: plant, address: 1, latch: true}
memory: {feed: {type: i16, initial: 0}}
encoders:
  belt: {backend: plant, address: 0, bits: 16, type: linear, scale: {increments: 4000, per: 100 mm}}
  drum: {backend: plant, address: 1, bits: 32, type: linear, scale: {increments: 4000, per: 100 mm}}
axes:
  line: {type: linear, drive: virtual, scale: {increments: 1000, per: 1 mm}, max_velocity: 3 m/s, max_acceleration: 5 m/s^2}
  x: {type: linear, scale: {increments: 1000, per: 1 mm}, max_velocity: 3 m/s, max_acceleration: 5 m/s^2,
      drive: {backend: plant, address: 0, interface: position}}
  y: {type: linear, scale: {increments: 1000, per: 1 mm}, max_velocity: 3 m/s, max_acceleration: 5 m/s^2,
      drive: {backend: plant, address: 1, interface: position}}
";

fn inputs_message(inputs: &Inputs, config: &MachineConfig) -> CycleInputs {
    let mut message = CycleInputs::default();
    fill(&mut message, inputs, config);
    message
}

fn cell() -> Cell {
    Cell::parse("cell.yaml", CELL).unwrap_or_else(|problems| panic!("{problems}"))
}

/// Any bits, including NaN.
fn real() -> impl Strategy<Value = f64> {
    any::<u64>().prop_map(f64::from_bits)
}

fn drive_input() -> impl Strategy<Value = DriveInput> {
    let numbers = (any::<i64>(), any::<u32>(), real(), real(), any::<u16>(), any::<i8>(), any::<u16>());
    let flags = (any::<bool>(), any::<bool>(), any::<bool>());
    let switches = (any::<u32>(), any::<Option<i64>>());
    let bus = prop::sample::select(vec![BusState::Active, BusState::Degraded, BusState::Off]);
    let bus = (bus, any::<Option<[u8; 8]>>().prop_map(|sent| sent.map(Emergency::from_bytes)));
    (numbers, flags, switches, bus).prop_map(
        |(
            (count, epoch, velocity, effort, status, mode, fault),
            (online, fresh, unacknowledged),
            (inputs, index),
            (bus, emergency),
        )| {
            DriveInput {
                bus,
                emergency,
                count,
                epoch,
                velocity,
                effort,
                status,
                mode,
                fault,
                online,
                fresh,
                inputs,
                index,
                unacknowledged,
            }
        },
    )
}

fn any_latch() -> impl Strategy<Value = Latch> {
    let objects =
        [0, 3].map(Object::Io).into_iter().chain([0, 1].map(Object::Encoder)).chain([0, 1, 2].map(Object::Axis));
    let object = prop::sample::select(objects.collect::<Vec<_>>());
    let edge = prop::sample::select(vec![Edge::Rising, Edge::Falling]);
    let age = prop::option::of(0..1_000_000_u32);
    (object, edge, age, prop::option::of(any::<i64>())).prop_filter_map(
        "nothing known",
        |(object, edge, age_ns, position)| {
            (age_ns.is_some() || position.is_some()).then_some(Latch { object, edge, age_ns, position })
        },
    )
}

fn any_inputs() -> impl Strategy<Value = Inputs> {
    let parts = (any::<i64>(), any::<u32>(), any::<bool>(), any::<Option<i64>>());
    let encoder = parts.prop_map(|(count, epoch, valid, index)| EncoderInput { count, epoch, valid, index });
    let arrays = (
        prop::collection::vec(any::<u64>(), 1),
        prop::collection::vec(real(), 1),
        prop::collection::vec(encoder, 2),
        prop::collection::vec(drive_input(), 2),
        prop::collection::vec(any_latch(), 0..=MAX_LATCHES),
    );
    (any::<u64>(), any::<u32>(), any::<u32>(), arrays).prop_map(
        |(cycle, missed, latches_lost, (digital, analog, encoder, drive, latch))| Inputs {
            cycle,
            missed,
            digital,
            analog,
            encoder,
            drive,
            latch,
            latches_lost,
        },
    )
}

/// Recordings made before drives reported their bus state end with the number of lost latches.
#[test]
fn inputs_of_before_have_buses_that_transmit() {
    let config = cell().machine;
    let mut inputs = Machine::new(config.clone()).unwrap().inputs();
    inputs.drive[1].count = 77;
    let mut message = inputs_message(&inputs, &config);
    message.drive_bus.clear();
    message.drive_has_emergency.clear();
    message.drive_emergency.clear();
    let mut data = cdr::encode_with_header(&message);
    data.truncate(data.len() - 16);
    let of = |data: &'static [u8]| Message {
        topic: "/inputs",
        kind: CycleInputs::NAME,
        encoding: "cdr",
        log_time: 0,
        publish_time: 0,
        sequence: 0,
        data,
        file: 0,
    };
    let data: &[u8] = data.leak();
    let read = decode(&of(data)).unwrap();
    let mut again = inputs.clone();
    again.drive[0].bus = BusState::Off;
    assert_eq!(read_inputs(&read, &config, &mut again), Ok(()));
    assert_eq!(again, inputs);
    let cut = decode(&of(&data[..data.len() - 4])).unwrap_err();
    assert!(!cut.is_empty(), "{cut}");
    for (bus, sentence) in [
        (vec![1], "drive_bus has 1 elements; 2 are needed"),
        (vec![1, 3], "drive_has_emergency has 0 elements; 2 are needed"),
    ] {
        message.drive_bus = bus;
        assert_eq!(read_inputs(&message, &config, &mut again), Err(sentence.to_owned()));
    }
    (message.drive_has_emergency, message.drive_emergency) = (vec![false, false], vec![0, 9]);
    let sentence = "drive_bus[1] is 3; 0 (active), 1 (passive) and 2 (off) are allowed";
    assert_eq!(read_inputs(&message, &config, &mut again), Err(sentence.to_owned()));
    message.drive_bus = vec![0, 2];
    let sentence = "drive_emergency[1] is not 0, though drive_has_emergency is false";
    assert_eq!(read_inputs(&message, &config, &mut again), Err(sentence.to_owned()));
}

/// Recordings made before setpoints were acknowledged end with the emergency messages.
#[test]
fn inputs_of_before_have_no_setpoint_that_was_not_acknowledged() {
    let config = cell().machine;
    let mut inputs = Machine::new(config.clone()).unwrap().inputs();
    inputs.drive[1].bus = BusState::Degraded;
    let message = inputs_message(&inputs, &config);
    assert!(message.drive_unacknowledged.is_empty(), "none has missed one");
    let mut data = cdr::encode_with_header(&message);
    data.truncate(data.len() - 4);
    let data: &'static [u8] = data.leak();
    let of = Message {
        topic: "/inputs",
        kind: CycleInputs::NAME,
        encoding: "cdr",
        log_time: 0,
        publish_time: 0,
        sequence: 0,
        data,
        file: 0,
    };
    let mut again = inputs.clone();
    again.drive[0].unacknowledged = true;
    assert_eq!(read_inputs(&decode(&of).unwrap(), &config, &mut again), Ok(()));
    assert_eq!(again, inputs);
    let message = CycleInputs { drive_unacknowledged: vec![true], ..message };
    let sentence = "drive_unacknowledged has 1 elements; 2 are needed";
    assert_eq!(read_inputs(&message, &config, &mut again), Err(sentence.to_owned()));
}

proptest! {
    #[test]
    fn what_is_written_is_read(inputs in any_inputs(), before in any_inputs()) {
        let config = cell().machine;
        let message = inputs_message(&inputs, &config);
        let bytes = cdr::encode_with_header(&message);
        let read: CycleInputs = cdr::decode_with_header(&bytes).unwrap();
        // Memory that was used for other inputs.
        let mut again = before;
        prop_assert_eq!(read_inputs(&read, &config, &mut again), Ok(()));
        // NaN is not equal to itself, so the bits are compared.
        prop_assert_eq!(cdr::encode_with_header(&inputs_message(&again, &config)), bytes);
        prop_assert_eq!(format!("{again:?}"), format!("{inputs:?}"));
        let bits = |inputs: &Inputs| -> Vec<u64> {
            let drives = inputs.drive.iter().flat_map(|drive| [drive.velocity, drive.effort]);
            inputs.analog.iter().copied().chain(drives).map(f64::to_bits).collect()
        };
        prop_assert_eq!(bits(&again), bits(&inputs));
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let config = cell().machine;
        let mut inputs = Inputs::default();
        if let Ok(message) = cdr::decode::<CycleInputs>(&bytes, cdr::Endian::Little) {
            let _ = read_inputs(&message, &config, &mut inputs);
        }
    }
}

fn good() -> CycleInputs {
    let cell = cell();
    let machine = Machine::new(cell.machine.clone()).unwrap();
    let mut inputs = machine.inputs();
    let latch = Latch { object: Object::Io(3), edge: Edge::Rising, age_ns: Some(350_000), position: None };
    inputs.add_latch(latch);
    inputs.add_latch(Latch { object: Object::Axis(1), edge: Edge::Falling, age_ns: None, position: Some(-7) });
    inputs_message(&inputs, &cell.machine)
}

#[test]
fn inputs_of_the_machine_fit_and_a_message_holds_the_names() {
    let mut inputs = Inputs::default();
    assert_eq!(read_inputs(&good(), &cell().machine, &mut inputs), Ok(()));
    assert_eq!(good().latch_object, ["mark", "x"]);
    assert_eq!(inputs.latch[0].age_ns, Some(350_000));
    assert_eq!(inputs.latch[1].position, Some(-7));
}

#[test]
fn every_array_of_another_length_is_refused_by_its_name() {
    type Change = fn(&mut CycleInputs);
    let changes: [(Change, &str); 19] = [
        (|m| m.digital.clear(), "digital has 0 elements; 1 are needed"),
        (|m| m.analog.push(0.0), "analog has 2 elements; 1 are needed"),
        (|m| m.encoder_count.clear(), "encoder_count has 0 elements; 2 are needed"),
        (|m| m.encoder_epoch.push(0), "encoder_epoch has 3 elements; 2 are needed"),
        (|m| m.encoder_valid.clear(), "encoder_valid has 0 elements; 2 are needed"),
        (|m| m.drive_count.push(0), "drive_count has 3 elements; 2 are needed"),
        (|m| m.drive_epoch.clear(), "drive_epoch has 0 elements; 2 are needed"),
        (|m| m.drive_velocity.clear(), "drive_velocity has 0 elements; 2 are needed"),
        (|m| m.drive_effort.clear(), "drive_effort has 0 elements; 2 are needed"),
        (|m| m.drive_status.clear(), "drive_status has 0 elements; 2 are needed"),
        (|m| m.drive_mode.clear(), "drive_mode has 0 elements; 2 are needed"),
        (|m| m.drive_fault.clear(), "drive_fault has 0 elements; 2 are needed"),
        (|m| m.drive_online.clear(), "drive_online has 0 elements; 2 are needed"),
        (|m| m.drive_fresh.clear(), "drive_fresh has 0 elements; 2 are needed"),
        (|m| m.latch_edge.clear(), "latch_edge has 0 elements; 2 are needed"),
        (|m| m.latch_has_age.clear(), "latch_has_age has 0 elements; 2 are needed"),
        (|m| m.latch_age_ns.push(0), "latch_age_ns has 3 elements; 2 are needed"),
        (|m| m.latch_has_position.clear(), "latch_has_position has 0 elements; 2 are needed"),
        (|m| m.latch_position.clear(), "latch_position has 0 elements; 2 are needed"),
    ];
    for (change, sentence) in changes {
        assert_refused(change, sentence);
    }
}

#[track_caller]
fn assert_refused(change: impl Fn(&mut CycleInputs), sentence: &str) {
    let mut message = good();
    change(&mut message);
    let refused = read_inputs(&message, &cell().machine, &mut Inputs::default());
    assert_eq!(refused, Err(sentence.to_owned()));
}

#[test]
fn a_latch_that_cannot_be_is_refused() {
    let unknown = "the cell has no input, encoder or axis of that name";
    assert_refused(|m| m.latch_object[0] = "nobody".into(), &format!("latch_object is `nobody`; {unknown}"));
    assert_refused(|m| m.latch_object[0] = "feed".into(), &format!("latch_object is `feed`; {unknown}"));
    assert_refused(|m| m.latch_object[0] = "machine".into(), &format!("latch_object is `machine`; {unknown}"));
    assert_refused(|m| m.latch_edge[1] = 2, "latch_edge of x is 2; 0 (falling) and 1 (rising) are allowed");
    assert_refused(|m| m.latch_age_ns[0] = 1_000_000, "latch_age_ns of mark is 1000000; 0 to 999999 is allowed");
    assert_refused(|m| m.latch_has_age[0] = false, "latch_age_ns of mark is not 0, though latch_has_age is false");
    assert_refused(|m| m.latch_position[0] = 1, "latch_position of mark is not 0, though latch_has_position is false");
    assert_refused(
        |m| (m.latch_has_position[1], m.latch_position[1]) = (false, 0),
        "the latch of x has neither age nor position",
    );
}

#[test]
fn the_seventeenth_latch_is_refused() {
    let more = |m: &mut CycleInputs| {
        m.latch_object = vec!["mark".into(); 17];
        m.latch_edge = vec![0; 17];
        m.latch_has_age = vec![true; 17];
        m.latch_age_ns = vec![0; 17];
        m.latch_has_position = vec![false; 17];
        m.latch_position = vec![0; 17];
    };
    assert_refused(more, "latch_object has 17 elements; at most 16 are allowed");
}

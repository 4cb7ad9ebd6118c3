use super::*;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::machine::Machine;
use proptest::prelude::*;

fn machine() -> Machine {
    Machine::new(crate::cell::Cell::demo().machine).unwrap()
}

/// Few words change, often by a small amount.
fn change() -> impl Strategy<Value = u64> {
    prop_oneof![6 => Just(0), 2 => 0..300_u64, 1 => any::<u64>(), 1 => any::<f64>().prop_map(f64::to_bits)]
}

prop_compose! {
    fn drive_input()(
        count: i64, epoch: u32, velocity in any::<u64>(), effort in any::<u64>(), status: u16, mode: i8, fault: u16, online: bool,
        (fresh, unacknowledged) in any::<(bool, bool)>(), bus in prop_oneof![Just(BusState::Active), Just(BusState::Degraded), Just(BusState::Off)],
        emergency in prop::option::of(any::<[u8; 8]>()), (inputs, index) in (any::<u32>(), any::<Option<i64>>()),
    ) -> DriveInput {
        let (velocity, effort) = (f64::from_bits(velocity), f64::from_bits(effort));
        let emergency = emergency.map(Emergency::from_bytes);
        DriveInput {
            count, epoch, velocity, effort, status, mode, fault, online, fresh, bus, emergency, inputs, index, unacknowledged,
        }
    }
}

fn encoder_input() -> impl Strategy<Value = EncoderInput> {
    let parts = (any::<i64>(), any::<u32>(), any::<bool>(), any::<Option<i64>>());
    parts.prop_map(|(count, epoch, valid, index)| EncoderInput { count, epoch, valid, index })
}

/// Words of a cycle: constant, in steps, along parabolas, or random.
fn next(word: u64, cycle: u64, change: u64) -> u64 {
    match change % 4 {
        0 => word,
        1 => word.wrapping_add(change),
        2 => (change as f64 + (cycle * cycle) as f64 / 7.0).to_bits(),
        _ => word ^ change,
    }
}

proptest! {
    #[test]
    fn words_come_back(changes in prop::collection::vec(prop::collection::vec(change(), 300), 1..12), key in 1..9_usize) {
        let mut values = vec![0_u64; 300];
        let (mut words, mut unpacked) = (vec![History::default(); 300], vec![History::default(); 300]);
        let mut unpacked_values = values.clone();
        for (cycle, changes) in changes.iter().enumerate() {
            values.iter_mut().zip(changes).for_each(|(word, change)| *word = next(*word, cycle as u64, *change));
            if cycle.is_multiple_of(key) {
                words.fill(History::default());
                unpacked.fill(History::default());
            }
            let mut bytes = Vec::new();
            pack_words(&mut words, &values, 0, &mut bytes);
            prop_assert!(bytes.len() <= MOST * values.len());
            unpack_words(&mut unpacked, &mut unpacked_values, &bytes);
            prop_assert_eq!(&unpacked_values, &values);
        }
    }

    /// Compares bit by bit, including NaN.
    #[test]
    fn drives_and_encoders_come_back(drive_input in drive_input(), encoder_input in encoder_input()) {
        let words = drive_words(&drive_input);
        prop_assert_eq!(drive_words(&drive(words)), words);
        let same = DriveInput { velocity: 0.0, effort: 0.0, ..drive_input };
        prop_assert_eq!(drive(drive_words(&same)), same);
        prop_assert_eq!(encoder(encoder_words(&encoder_input)), encoder_input);
    }
}

/// A parabola takes no bytes from its fourth cycle on; a constant takes no bytes at all.
#[test]
fn only_what_is_not_as_predicted_takes_bytes() {
    let packed = |of: &dyn Fn(u64) -> u64| -> Vec<usize> {
        let mut words = [History::default(); 2];
        let length = |cycle| {
            let mut bytes = Vec::new();
            pack_words(&mut words, &[of(cycle), 0], 0, &mut bytes);
            bytes.len()
        };
        (0..7).map(length).collect()
    };
    // 100, 103, 112, 127, ...: the two changes 100 and 3 predict 103 + 2 * 3 - 100 = 9 for 112.
    assert_eq!(packed(&|cycle| 100 + 3 * cycle * cycle), [3, 3, 3, 0, 0, 0, 0]);
    // A step takes bytes only for its change.
    assert_eq!(packed(&|cycle| u64::from(cycle >= 3)), [0, 0, 0, 3, 0, 0, 0]);
    // Negative values: -1, -2, -3, ...
    assert_eq!(packed(&|cycle| cycle.wrapping_neg()), [0, 3, 3, 0, 0, 0, 0]);
}

/// A key cycle needs no cycle before it; the others follow it.
#[test]
fn cycles_come_back_from_a_key_cycle_on() {
    let mut machine = machine();
    let MachineConfig { cycle_ns, .. } = machine.config();
    let key_cycles = super::super::key_cycles(*cycle_ns);
    let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let mut packer = Packer::new(&inputs, machine.board());
    let mut unpackers = [Unpacker::new(&inputs, machine.board()), Unpacker::new(&inputs, machine.board())];
    for cycle in 0..3 * key_cycles {
        inputs.begin(cycle, (cycle % 7) as u32);
        inputs.digital.iter_mut().for_each(|word| *word = cycle / 3);
        inputs.analog.iter_mut().for_each(|volts| *volts = cycle as f64 / 10.0);
        inputs.drive.iter_mut().for_each(|drive| drive.count = 1 - cycle as i64);
        machine.cycle(&inputs, Default::default(), &mut outputs);
        let bytes = packer.pack(&inputs, machine.board(), cycle.is_multiple_of(key_cycles));
        for (unpacker, first) in unpackers.iter_mut().zip([0, key_cycles]).filter(|(_, first)| cycle >= *first) {
            unpacker.unpack(cycle, bytes, cycle.is_multiple_of(key_cycles));
            assert_eq!((&unpacker.inputs, &unpacker.board), (&inputs, machine.board()), "cycle {cycle}, from {first}");
        }
    }
}

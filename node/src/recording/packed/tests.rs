use super::*;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::machine::Machine;
use proptest::prelude::*;

fn machine() -> Machine {
    Machine::new(crate::cell::Cell::demo().machine).unwrap()
}

/// Few words change, and often by little.
fn change() -> impl Strategy<Value = u64> {
    prop_oneof![6 => Just(0), 2 => 0..300_u64, 1 => any::<u64>(), 1 => any::<f64>().prop_map(f64::to_bits)]
}

prop_compose! {
    fn drive_input()(
        count: i64, epoch: u32, velocity in any::<u64>(), effort in any::<u64>(), status: u16, mode: i8, fault: u16, online: bool,
        fresh: bool, bus in prop_oneof![Just(BusState::Active), Just(BusState::Passive), Just(BusState::Off)],
        emergency in prop::option::of(any::<[u8; 8]>()), (inputs, index) in (any::<u32>(), any::<Option<i64>>()),
    ) -> DriveInput {
        let (velocity, effort) = (f64::from_bits(velocity), f64::from_bits(effort));
        let emergency = emergency.map(Emergency::from_bytes);
        DriveInput { count, epoch, velocity, effort, status, mode, fault, online, fresh, bus, emergency, inputs, index }
    }
}

fn encoder_input() -> impl Strategy<Value = EncoderInput> {
    let parts = (any::<i64>(), any::<u32>(), any::<bool>(), any::<Option<i64>>());
    parts.prop_map(|(count, epoch, valid, index)| EncoderInput { count, epoch, valid, index })
}

proptest! {
    #[test]
    fn words_come_back(changes in prop::collection::vec(prop::collection::vec(change(), 300), 1..12), key in 1..4_usize) {
        let mut words = vec![0_u64; 300];
        let (mut before, mut unpacked) = (words.clone(), words.clone());
        for (cycle, changes) in changes.iter().enumerate() {
            words.iter_mut().zip(changes).for_each(|(word, change)| *word ^= change);
            if cycle.is_multiple_of(key) {
                before.fill(0);
                unpacked.fill(0);
            }
            let mut bytes = Vec::new();
            pack_words(&mut before, &words, 0, &mut bytes);
            prop_assert!(bytes.len() <= MOST * words.len());
            let (mut rest, mut place) = (bytes.as_slice(), 0);
            while let Some((same, change)) = take_number(&mut rest).zip(take_change(&mut rest)) {
                place += same;
                unpacked[place] ^= change;
                place += 1;
            }
            prop_assert_eq!(&unpacked, &words);
        }
    }

    /// Bit by bit, NaN among them.
    #[test]
    fn drives_and_encoders_come_back(drive_input in drive_input(), encoder_input in encoder_input()) {
        let words = drive_words(&drive_input);
        prop_assert_eq!(drive_words(&drive(words)), words);
        let same = DriveInput { velocity: 0.0, effort: 0.0, ..drive_input };
        prop_assert_eq!(drive(drive_words(&same)), same);
        prop_assert_eq!(encoder(encoder_words(&encoder_input)), encoder_input);
    }
}

/// A key cycle needs none before it, and the others follow.
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

//! Tests the messages of a cycle, and the cycles that have them.

use super::super::CycleTime;
use super::super::rig::{self, MOVING};
use super::*;
use lineshaft_core::command::{Command, Source};
use lineshaft_core::event::{Kind, Severity};
use lineshaft_core::machine::Machine;
use lineshaft_core::object::Object;
use lineshaft_core::signal::Board;
use lineshaft_msgs::cdr::decode_with_header;
use lineshaft_msgs::foreign::sensor_msgs::msg::JointState;
use lineshaft_msgs::msg::{AxisStates, Event as EventMessage};
use num_rational::Ratio;
use proptest::prelude::*;
use serde::de::DeserializeOwned;

fn of<T: DeserializeOwned>(encoded: &Encoded, topic: Topic) -> Vec<T> {
    let messages = encoded.messages().filter(|(of, _)| *of == topic);
    messages.map(|(_, bytes)| decode_with_header(bytes).unwrap_or_else(|error| panic!("{error}"))).collect()
}

fn only<T: DeserializeOwned>(encoded: &Encoded, topic: Topic) -> T {
    let mut all = of(encoded, topic);
    assert_eq!(all.len(), 1);
    all.remove(0)
}

#[test]
fn messages_have_the_order_of_their_topics_and_the_same_cycle() {
    let run = rig::record(&Cell::demo(), MOVING, 1200, 5_000_000_000);
    for (number, encoded) in run.encoded.iter().enumerate() {
        assert!(encoded.messages().map(|(topic, _)| topic).is_sorted());
        assert_eq!((encoded.cycle, encoded.time.stamp_ns), (number as u64, 5_000_000_000 + number as u64 * 1_000_000));
        let inputs: CycleInputs = only(encoded, Topic::Inputs);
        let mut read = run.inputs[number].clone();
        read.drive.clear();
        inputs::read_inputs(&inputs, &Cell::demo().machine, &mut read).unwrap();
        assert_eq!(read, run.inputs[number]);
        let signals: Signals = only(encoded, Topic::Signals);
        assert_eq!(signals.cycle, number as u64);
        let (_, bytes) = encoded.messages().find(|(topic, _)| *topic == Topic::Inputs).unwrap();
        assert_eq!(signals.inputs_crc, crc32fast::hash(bytes));
        let events: Vec<EventMessage> = of(encoded, Topic::Events);
        assert_eq!(
            events.iter().map(|event| event.sequence).collect::<Vec<_>>(),
            run.events[number].iter().map(|event| event.sequence).collect::<Vec<_>>()
        );
    }
    let commands: Vec<AppliedCommand> = run.encoded.iter().flat_map(|encoded| of(encoded, Topic::Commands)).collect();
    assert_eq!(commands.iter().map(|command| command.sequence).collect::<Vec<_>>(), (1..=10).collect::<Vec<_>>());
    assert_eq!(
        (commands[0].cycle, &*commands[0].source, &*commands[0].command),
        (0, "scenario", "{\"enable\":{\"axes\":[\"line\",\"x\",\"y\",\"turret\"]}}")
    );
    let refused: Vec<EventMessage> = run
        .encoded
        .iter()
        .flat_map(|encoded| of::<EventMessage>(encoded, Topic::Events))
        .filter(|event| event.kind == "refused")
        .collect();
    assert_eq!(refused.len(), 1);
    assert_eq!(refused[0].text, "x: target 9000 mm exceeds max_position 850 mm");
    assert_eq!(refused[0].header.stamp.sec, 5);
}

/// The sum of the changes gives the board of every cycle.
#[test]
fn changes_add_up_to_the_board_and_unchanged_values_are_omitted() {
    let cell = Cell::demo();
    let machine = Machine::new(cell.machine.clone()).unwrap();
    let run = rig::record(&cell, MOVING, 2100, 0);
    let board_words =
        |board: &Board| machine.directory().iter().map(|(signal, _)| board.word(signal)).collect::<Vec<_>>();
    let mut words = vec![0; machine.directory().len()];
    let mut told = 0;
    for (encoded, board) in run.encoded.iter().zip(&run.boards) {
        let signals: Signals = only(encoded, Topic::Signals);
        assert_eq!(signals.index.len(), signals.word.len());
        assert!(signals.index.is_sorted_by(|a, b| a < b));
        if encoded.is_key {
            assert_eq!(signals.index.len(), words.len());
        }
        for (&place, &word) in signals.index.iter().zip(&signals.word) {
            assert!(encoded.is_key || words[place as usize] != word);
            words[place as usize] = word;
        }
        told += signals.index.len();
        assert_eq!(words, board_words(board), "cycle {}", encoded.cycle);
    }
    assert!(told < words.len() * 2100 / 3, "{told} words in 2100 cycles of {}", words.len());
}

#[test]
fn first_cycle_that_is_no_key_contains_all_signals() {
    let cell = Cell::demo();
    let machine = Machine::new(cell.machine.clone()).unwrap();
    let mut encoder = Encoder::new(&cell, machine.config(), machine.directory());
    let mut inputs = machine.inputs();
    inputs.cycle = 1;
    let cycle = Cycle {
        time: CycleTime::default(),
        inputs: &inputs,
        commands: &[],
        stream: None,
        events: &[],
        board: machine.board(),
    };
    let signals: Signals = only(&encoder.encode(&cycle), Topic::Signals);
    assert_eq!(signals.index.len(), machine.directory().len());
    let signals: Signals = only(&encoder.encode(&cycle), Topic::Signals);
    assert_eq!(signals.index, [0_u32; 0]);
}

#[test]
fn message_of_an_invalid_request_comes_from_its_command() {
    let cell = Cell::demo();
    let machine = Machine::new(cell.machine.clone()).unwrap();
    let mut encoder = Encoder::new(&cell, machine.config(), machine.directory());
    let inputs = machine.inputs();
    let event =
        |sequence| Event::new(Severity::Warn, Kind::Refused, Object::Machine, Code::BAD_REQUEST).of_command(sequence);
    let commands = [Command { sequence: 8, source: Source::Ros, action: Action::Refuse("not like this".into()) }];
    let events = [event(8), event(9)];
    let cycle = Cycle {
        time: CycleTime::default(),
        inputs: &inputs,
        commands: &commands,
        stream: None,
        events: &events,
        board: machine.board(),
    };
    let encoded = encoder.encode(&cycle);
    let texts: Vec<String> = of::<EventMessage>(&encoded, Topic::Events).into_iter().map(|event| event.text).collect();
    assert_eq!(texts, ["not like this", "machine: the request is not understood"]);
    assert_eq!(of::<AppliedCommand>(&encoded, Topic::Commands)[0].source, "ros");
}

#[test]
fn joint_states_have_the_joint_names_of_the_cell_and_everything_else_the_object_names() {
    let text = Cell::demo().text.replacen("\n  x:\n", "\n  x:\n    joint: left/arm_1\n", 1);
    let run = rig::record(&Cell::parse("demo.yaml", text).unwrap(), MOVING, 1200, 0);
    let mut joints = run.encoded.iter().flat_map(|encoded| of::<JointState>(encoded, Topic::JointStates));
    assert!(joints.all(|joints| joints.name == ["left/arm_1", "y", "turret"]));
    let plain = rig::record(&Cell::demo(), MOVING, 1200, 0);
    for (encoded, plain) in run.encoded.iter().zip(&plain.encoded) {
        let others = |encoded: &Encoded| {
            let others = encoded.messages().filter(|(topic, _)| *topic != Topic::JointStates);
            others.map(|(topic, bytes)| (topic, bytes.to_vec())).collect::<Vec<_>>()
        };
        assert_eq!(others(encoded), others(plain));
    }
}

#[test]
fn state_topics_come_at_their_rates() {
    let text = Cell::demo().text.replace("joint_states_rate: 100 ", "joint_states_rate: 33.3 ");
    let cell = Cell::parse("demo.yaml", text.replace("axis_states_rate: 100\n", "axis_states_rate: 1000\n")).unwrap();
    let run = rig::record(&cell, MOVING, 3001, 0);
    let cycles = |topic| {
        let has = |encoded: &&Encoded| encoded.messages().any(|(of, _)| of == topic);
        run.encoded.iter().filter(has).map(|encoded| encoded.cycle).collect::<Vec<_>>()
    };
    assert_eq!(cycles(Topic::AxisStates), (0..=3000).collect::<Vec<_>>());
    // Rate 33.3 1/s: after 3 s the 100th message, counting the one of cycle 0; step 99 is reached at 99 / 33.3 s.
    let joints = cycles(Topic::JointStates);
    assert_eq!(&joints[..4], [0, 31, 61, 91]);
    assert_eq!((joints.len(), joints[joints.len() - 1]), (100, 2973));
    let states: AxisStates = only(&run.encoded[500], Topic::AxisStates);
    assert_eq!((states.cycle, states.axes.len(), &*states.axes[1].name), (500, 4, "x"));
    let joints: JointState = only(&run.encoded[61], Topic::JointStates);
    assert_eq!(joints.name, ["x", "y", "turret"]);
    assert_eq!(joints.header.stamp.nanosec, 61_000_000);
}

proptest! {
    /// The exact fraction determines when floor(k T rate) increases.
    #[test]
    fn a_cadence_steps_with_the_exact_fraction(
        milli in 1_000_u32..=1_000_000,
        cycle_ns in 125_000_u64..=20_000_000,
        cycle in prop_oneof![0..10_000_u64, 0..1_u64 << 50],
    ) {
        let mut cadence = Cadence::new(f64::from(milli) / 1e3, cycle_ns);
        let rate = Ratio::new(i128::from(milli) * i128::from(cycle_ns), 1_000_000_000_000_i128);
        let floor = |cycle: u64| (Ratio::from_integer(i128::from(cycle)) * rate).floor();
        let steps = |cycle: u64| cycle == 0 || floor(cycle) != floor(cycle - 1);
        // One after the other, then again from the first one, and with skipped cycles.
        for cycle in (cycle..cycle + 100).chain(cycle..cycle + 5).chain((cycle..cycle + 100).step_by(7)) {
            prop_assert_eq!(cadence.is_due(cycle), steps(cycle));
        }
    }

    #[test]
    fn no_cycle_and_no_rate_is_too_large(rate in any::<f64>(), cycle in any::<u64>(), cycle_ns in any::<u64>()) {
        let _ = Cadence::new(rate, cycle_ns).is_due(cycle);
    }
}

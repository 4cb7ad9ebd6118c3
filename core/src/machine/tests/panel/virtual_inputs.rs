//! Inputs without a terminal: they read an output of the machine.

use super::{P, Q, R, ready, set, with_io};
use crate::axis::BrakeConfig;
use crate::code::Code;
use crate::command::Action;
use crate::config::{FilterConfig, MachineConfig, VirtualInput};
use crate::event::Kind;
use crate::machine::Machine;
use crate::machine::tests::rig::{Rig, X, at};
use crate::object::AxisSet;

/// Returns a cell in which input c (3) reads output p.
fn virtual_c() -> MachineConfig {
    let mut cell = with_io();
    cell.global.virtual_inputs = vec![VirtualInput { input: 2, output: P }];
    cell
}

/// Input 3 reads output 1: x runs, then the output is set in cycle k. The input shows it in k + 1, and x stops in that
/// cycle.
///
/// Proves: MACS-LIM-07
#[test]
fn a_limit_switch_may_be_an_output_of_the_machine_and_comes_a_cycle_later() {
    for (number, inactive, active) in [(3, 0.0, 1.0), (-3, 1.0, 0.0)] {
        let mut cell = virtual_c();
        cell.axes[1].parameters.assigned.poslimitsw = number;
        cell.axes[1].parameters.supervision.endswmod = 1;
        let mut rig = Rig::of(cell);
        rig.give(Action::set_output(P, inactive));
        rig.enable();
        rig.mirror();
        rig.give(Action::Move(at(X, 1_000.0)));
        rig.run(50);
        let before = rig.machine.next_cycle();
        rig.give(Action::set_output(P, active));
        let shown = |rig: &Rig| (rig.int("c"), rig.int("x.limit.positive"), rig.state("x"));
        let [old, new] = [inactive, active].map(|level| level as i64);
        assert_eq!(shown(&rig), (old, 0, "CONTINUOUS_MOTION"), "{number}: the cycle of the command");
        rig.run(1);
        assert_eq!(shown(&rig), (new, 1, "ERROR_STOP"), "{number}: the next one");
        let event = rig.events.iter().find(|event| event.kind == Kind::Error).unwrap();
        assert_eq!((event.cycle, event.code), (before + 1, Code::HARDWARE_LIMIT_POSITIVE));
        // The level blocks the direction until the output is reset.
        rig.run(50);
        rig.give(Action::ResetErrors(AxisSet::one(X)));
        rig.run(5);
        let further = rig.give(Action::Move(at(X, 1_000.0)));
        assert_eq!(rig.refusal(further), "x: the positive limit switch is actuated; only the way back is open");
        rig.give(Action::set_output(P, inactive));
        rig.run(1);
        let again = rig.give(Action::Move(at(X, 1_000.0)));
        assert!(rig.was_accepted(again));
    }
}

/// Outputs with a function are read like others: the error of y stops x, one cycle later; also a brake that an axis
/// closes itself.
///
/// Proves: MACS-LIM-07
#[test]
fn an_output_with_a_function_is_read_too() {
    let mut cell = virtual_c();
    cell.global.parameters.o_error = 1;
    cell.axes[1].parameters.assigned.neglimitsw = 3;
    let mut rig = ready(cell);
    rig.give(Action::Move(at(X, -1_000.0)));
    rig.run(20);
    rig.plant.drive(1).unwrap().inject_fault(0x8611);
    while rig.int("p") == 0 {
        assert_eq!(rig.state("x"), "CONTINUOUS_MOTION");
        rig.run(1);
    }
    assert_eq!((rig.int("c"), rig.state("x")), (0, "CONTINUOUS_MOTION"));
    rig.run(1);
    assert_eq!((rig.int("c"), rig.int("x.error")), (1, i64::from(Code::HARDWARE_LIMIT_NEGATIVE.0)));

    let mut cell = virtual_c();
    cell.global.virtual_inputs[0].output = R;
    cell.axes[1].brake = Some(BrakeConfig { output: R, closes_with_one: false, release_ns: 0, engage_ns: 0 });
    let mut rig = Rig::of(cell);
    rig.run(3);
    assert_eq!((rig.int("r"), rig.int("c")), (0, 0));
    rig.enable();
    assert_eq!((rig.int("r"), rig.int("c")), (1, 1), "open");
}

/// A filter counts from the level that the input would have had without it; the value of a backend for the input has no
/// effect.
#[test]
fn virtual_input_may_be_filtered_and_ignores_backend() {
    let mut cell = virtual_c();
    cell.global.filters = vec![FilterConfig { input: 2, time_ns: 5_000_000 }];
    let mut rig = ready(cell);
    rig.plant.set_digital(2, true);
    rig.run(20);
    assert_eq!(rig.int("c"), 0);
    rig.give(Action::set_output(P, 1.0));
    // Without the filter the level would show in the next cycle; it applies 5 ms later.
    rig.run(5);
    assert_eq!(rig.int("c"), 0);
    rig.run(1);
    assert_eq!(rig.int("c"), 1);
}

/// Every input function accepts a virtual input: the edge of an output clears errors with i_errclr.
#[test]
fn other_functions_take_virtual_inputs_as_well() {
    let mut cell = virtual_c();
    cell.global.parameters.i_break = 3;
    let mut rig = ready(cell);
    rig.give(Action::Move(at(X, 1_000.0)));
    rig.run(5);
    rig.give(Action::set_output(P, 1.0));
    rig.run(1);
    assert_eq!(rig.state("x"), "STOPPING");
    let assigned = rig.give(set(X, "i_refswitch", 3));
    assert!(rig.was_accepted(assigned));
}

/// After a power cycle outputs are 0, and so are the inputs that read them.
#[test]
fn a_power_cycle_takes_the_level_with_the_output() {
    let mut rig = Rig::of(virtual_c());
    rig.give(Action::set_output(P, 1.0));
    rig.run(2);
    assert_eq!((rig.int("p"), rig.int("c")), (1, 1));
    rig.give(Action::PowerCycle);
    rig.run(1);
    assert_eq!((rig.int("p"), rig.int("c")), (0, 0));
}

#[test]
fn what_is_read_has_to_be_a_digital_output_and_what_reads_it_an_input_with_no_contact() {
    let refused = |change: &dyn Fn(&mut MachineConfig)| {
        let mut cell = virtual_c();
        change(&mut cell);
        Machine::new(cell).map(|_| ()).map_err(|error| error.to_string())
    };
    assert_eq!(refused(&|_| ()), Ok(()));
    assert_eq!(refused(&|cell| cell.global.virtual_inputs[0].output = Q), Ok(()));
    for (change, sentence) in [
        (
            (|cell| cell.global.virtual_inputs[0].output = 0) as fn(&mut MachineConfig),
            "digital input 3 of 3 is to read entry 0 of io; one of them and a do are expected",
        ),
        (
            |cell| cell.global.virtual_inputs[0].output = 99,
            "digital input 3 of 3 is to read entry 99 of io; one of them and a do are expected",
        ),
        (
            |cell| cell.global.virtual_inputs[0].input = 3,
            "digital input 4 of 3 is to read entry 1 of io; one of them and a do are expected",
        ),
        (
            |cell| cell.safety.estop = Some(2),
            "safety: estop is digital input 2 (from 0), which reads an output of the machine itself",
        ),
    ] {
        assert_eq!(refused(&change), Err(sentence.to_owned()));
    }
}

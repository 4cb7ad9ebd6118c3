//! A machine goes on from the state of another one, or says why it does not.

use super::rig::{Rig, X, Y, config, couple, to};
use crate::command::Action;
use crate::config::MachineConfig;
use crate::machine::{Machine, State, StateError};
use crate::object::Leader;
use proptest::prelude::*;

/// The state of a machine of that config after some cycles.
fn state(config: MachineConfig, cycles: u64) -> State {
    let mut rig = Rig::of(config);
    rig.run(cycles);
    rig.machine.state().clone()
}

#[test]
fn a_restored_machine_ends_the_move_and_the_coupling_that_were_under_way() {
    let mut rig = Rig::enabled();
    let goal = rig.give(Action::Move(to(X, 20_000)));
    rig.give(Action::Synchronize(couple(Y, Leader::AxisCommand(X), 1, 1)));
    rig.run(100);
    assert_eq!(rig.state("x"), "DISCRETE_MOTION");
    // From here on every cycle of both is compared.
    rig.mirror();
    rig.run(2_000);
    assert_eq!(
        (rig.done(goal).len(), rig.int("x.command.position"), rig.state("y")),
        (1, 20_000, "SYNCHRONIZED_MOTION")
    );
}

#[test]
fn a_state_tells_its_cycle_and_the_parameters_in_force() {
    let state = state(config(0), 7);
    assert_eq!(state.cycle(), 7);
    let limits: Vec<f64> = state.parameters().map(|parameters| parameters.max_velocity).collect();
    assert_eq!(limits, [100_000.0; 3]);
    let machine = Machine::restore(config(0), state).unwrap();
    assert_eq!(machine.next_cycle(), 7);
}

#[test]
fn a_state_of_another_cell_is_refused() {
    let of = |change: fn(&mut MachineConfig)| {
        let mut other = config(0);
        change(&mut other);
        Machine::restore(other, state(config(0), 3)).map(drop).unwrap_err()
    };
    let fewer = of(|config| drop(config.axes.pop()));
    assert_eq!(fewer.to_string(), "the state holds 136 signals; the cell has 93");
    let slower = of(|config| config.axes[1].drive = Some(3));
    assert_eq!(slower, StateError::Setup { axis: "x".to_owned() });
    assert_eq!(slower.to_string(), "the state holds another set-up of axis x than the cell");
    let longer = of(|config| config.cycle_ns = 2_000_000);
    assert_eq!(longer, StateError::Setup { axis: "line".to_owned() });
    let bad = of(|config| config.cycle_ns = 1);
    assert_eq!(bad.to_string(), "cycle is 1 ns; 125000 ns to 20000000 ns is allowed");
}

proptest! {
    /// Bytes that no machine wrote are refused, or make a machine that runs: nothing panics.
    #[test]
    fn no_state_that_was_changed_makes_a_cycle_panic(changes in prop::collection::vec((any::<usize>(), any::<u8>()), 1..4)) {
        let mut rig = Rig::enabled();
        rig.give(Action::Move(to(X, 20_000)));
        rig.give(Action::Synchronize(couple(Y, Leader::AxisCommand(X), 3, 7)));
        rig.run(50);
        let mut bytes = postcard::to_allocvec(rig.machine.state()).unwrap();
        for (place, byte) in changes {
            let place = place % bytes.len();
            bytes[place] = byte;
        }
        if let Ok(state) = postcard::from_bytes(&bytes)
            && let Ok(machine) = Machine::restore(config(0), state)
        {
            rig.machine = machine;
            rig.run(200);
        }
    }
}

#[test]
fn an_order_that_is_none_is_refused() {
    for order in [vec![0, 0, 1], vec![0, 1, 3], vec![0, 1]] {
        let state = State { order, ..state(config(0), 1) };
        assert_eq!(Machine::restore(config(0), state).map(drop).unwrap_err(), StateError::Order);
    }
}

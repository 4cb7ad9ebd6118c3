//! A machine continues from the state of another one, or reports why it cannot.

use super::rig::{Rig, X, Y, cases, config, couple, to};
use crate::command::{Action, BufferMode, Move, MoveMode};
use crate::config::MachineConfig;
use crate::drive::{Capabilities, Interface};
use crate::machine::{Machine, State, StateError};
use crate::modulo::Modulo;
use crate::object::{AxisSet, Leader};
use crate::vocabulary::Order;
use proptest::prelude::*;

/// Returns the state of a machine with this config after some cycles.
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
    // From here on every cycle of both machines is compared.
    rig.mirror();
    rig.run(2_000);
    assert_eq!(
        (rig.done(goal).len(), rig.int("x.command.position"), rig.state("y")),
        (1, 20_000, "SYNCHRONIZED_MOTION")
    );
}

#[test]
fn state_reports_cycle_and_parameters_in_force() {
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
    let (axes, others) = (config(0).axes.len(), 12);
    let all = Machine::new(config(0)).unwrap().directory().len();
    let one = (all - others) / axes;
    assert_eq!(fewer.to_string(), format!("the state holds {all} signals; the cell has {}", all - one));
    let slower = of(|config| config.axes[1].drive = Some(Capabilities::all(3)));
    assert_eq!(slower, StateError::Setup { axis: "x".to_owned() });
    assert_eq!(slower.to_string(), "the state holds another set-up of axis x than the cell");
    let longer = of(|config| config.cycle_ns = 2_000_000);
    assert_eq!(longer, StateError::Setup { axis: "line".to_owned() });
    let bad = of(|config| config.cycle_ns = 1);
    assert_eq!(bad.to_string(), "cycle is 1 ns; 125000 ns to 20000000 ns is allowed");
}

fn interface() -> impl Strategy<Value = Interface> {
    prop::sample::select(&[Interface::Position, Interface::Velocity, Interface::OpenLoop][..])
}

/// Single bytes, and numbers that are invalid or too large.
fn changes() -> impl Strategy<Value = Vec<(usize, Vec<u8>)>> {
    let numbers = [f64::NAN, f64::INFINITY, f64::MAX, -f64::MAX, 1e-300, -1.0, 0.0];
    let numbers = prop::sample::select(numbers.map(|number| number.to_le_bytes().to_vec()).to_vec());
    let change = prop_oneof![any::<u8>().prop_map(|byte| vec![byte]), numbers, Just(vec![0xFF; 18])];
    prop::collection::vec((any::<usize>(), change), 1..4)
}

proptest! {
    #![proptest_config(cases(500))]

    /// Bytes that no machine has written are refused, or give a machine that runs: nothing panics.
    #[test]
    fn no_state_that_was_changed_makes_a_cycle_panic(
        interfaces in (interface(), interface()), profile in 0_i64..3, follows in any::<bool>(), changes in changes(),
    ) {
        let mut config = config(0);
        (config.axes[1].interface, config.axes[2].interface) = interfaces;
        config.axes[1].modulo = Modulo::new((1 << 40) + 1, (1 << 31) - 1);
        for axis in &mut config.axes {
            (axis.parameters.profile, axis.parameters.max_jerk) = (profile, Some(2e7));
        }
        let mut rig = Rig::of(config.clone());
        rig.enable();
        rig.give(Action::Move(Move { velocity: 20_000.0, ..to(X, 300) }));
        for (mode, buffer_mode) in [
            (MoveMode::Relative, BufferMode::BlendingHigh),
            (MoveMode::Absolute, BufferMode::BlendingNext),
            (MoveMode::Additive, BufferMode::Buffered),
        ] {
            rig.give(Action::Move(Move { mode, buffer_mode, velocity: 20_000.0, ..to(X, 120) }));
        }
        rig.give(Action::Move(Move { mode: MoveMode::Superimposed, ..to(X, 2_000) }));
        rig.give(Action::Synchronize(couple(Y, Leader::AxisCommand(X), 3, 7)));
        // Refused if the axis closes a position loop.
        let _ = rig.order(Y, Order::Speed { velocity: 1_000.0 });
        rig.run(50);
        let mut bytes = postcard::to_allocvec(rig.machine.state()).unwrap();
        for (place, change) in changes {
            let place = place % bytes.len();
            for (byte, new) in bytes[place..].iter_mut().zip(change) {
                *byte = new;
            }
        }
        if let Ok(state) = postcard::from_bytes(&bytes)
            && let Ok(machine) = Machine::restore(config, state)
        {
            (rig.machine, rig.full_cycle_machine) = (machine, None);
            rig.run(20);
            if follows {
                rig.give(Action::Synchronize(couple(X, Leader::AxisActual(Y), 1, 1)));
            } else {
                rig.give(Action::Halt(AxisSet::one(X)));
            }
            rig.run(100);
            rig.give(Action::Move(to(X, 100)));
            rig.run(80);
        }
    }
}

#[test]
fn invalid_axis_order_is_refused() {
    for order in [vec![0, 0, 1], vec![0, 1, 3], vec![0, 1]] {
        let state = State { order, ..state(config(0), 1) };
        assert_eq!(Machine::restore(config(0), state).map(drop).unwrap_err(), StateError::Order);
    }
}

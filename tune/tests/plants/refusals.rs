//! Axes that cannot be identified, with the reasons.

use super::catalogue::all;
use super::simulator::{Axis, Mechanics, Simulator, excite, permitted};
use lineshaft_tune::{Abort, ExcitationOutput, Record, Refusal, Takes, identify};

fn torque() -> Axis {
    all().into_iter().find(|named| named.name == "1:5").expect("it is there").axis
}

fn velocity() -> Axis {
    all().into_iter().find(|named| named.name == "velocity").expect("it is there").axis
}

#[test]
fn an_axis_that_is_stuck() {
    let mut axis = torque();
    let Mechanics::Torque { coulomb, stiction, .. } = &mut axis.mechanics else { panic!() };
    (*coulomb, *stiction) = (1.2, 1.2);
    let excited = excite(axis, permitted(&axis), |_| 0.0);
    assert_eq!(excited.end, ExcitationOutput::Aborted(Abort::Stuck { command: 0.5 }));
    let refusal = identify(&excited.record).unwrap_err();
    assert_eq!(
        refusal.to_string(),
        "the axis is stuck: it moved 0 inc at a command of up to 0.500; at least 3 inc are expected"
    );
}

#[test]
fn an_axis_with_no_room_beside_its_friction() {
    let mut axis = torque();
    let Mechanics::Torque { coulomb, stiction, .. } = &mut axis.mechanics else { panic!() };
    (*coulomb, *stiction) = (0.91, 0.92);
    let excited = excite(axis, permitted(&axis), |_| 0.0);
    assert!(matches!(excited.end, ExcitationOutput::Aborted(Abort::NoRoom { .. })), "{:?}", excited.end);
}

#[test]
fn an_axis_that_is_wired_the_other_way_round() {
    for axis in [torque(), velocity()] {
        let axis = Axis { wired: -1.0, ..axis };
        let excited = excite(axis, permitted(&axis), |_| 0.0);
        assert!(matches!(excited.end, ExcitationOutput::Aborted(Abort::Against { .. })), "{:?}", excited.end);
        assert!(excited.farthest < 2.5 * axis.encoder);
        let refusal = identify(&excited.record).unwrap_err();
        assert!(matches!(refusal, Refusal::Reversed { figure, .. } if figure < 0.0), "{refusal}");
        assert!(refusal.to_string().starts_with("the axis moves against the command: -"), "{refusal}");
    }
}

/// A phase is open, and an external force moves the axis.
#[test]
fn axis_that_moves_without_command_is_refused() {
    let axis = torque();
    let open = Axis { wired: 0.0, ..axis };
    for takes in [Takes::Effort, Takes::Velocity] {
        let mut commands = Record::with_capacity(1e-3, takes, 6000);
        let mut simulator = Simulator::new(open);
        let driven = excite(axis, permitted(&axis), |_| 0.0).record;
        for (k, &command) in driven.commands.iter().enumerate() {
            commands.push(command, simulator.position());
            simulator.disturbance = if k / 137 % 2 == 0 { 0.25 } else { -0.25 };
            simulator.cycle(command);
        }
        let refusal = identify(&commands).unwrap_err();
        assert!(matches!(refusal, Refusal::NoReaction { percent, .. } if percent < 25.0), "{refusal}");
    }
}

#[test]
fn too_coarse_encoder_is_refused() {
    let axis = Axis { encoder: 20.0, ..torque() };
    let excited = excite(axis, permitted(&axis), |_| 0.0);
    let refusal = identify(&excited.record).unwrap_err();
    let Refusal::Little { increments, least: 100 } = refusal else { panic!("{refusal}") };
    assert_eq!(
        refusal.to_string(),
        format!("the axis moved {increments} inc; for this encoder at least 100 inc are expected")
    );
}

/// The command moves the axis, and an external force as much.
#[test]
fn axis_with_strong_external_force_is_refused() {
    let axis = torque();
    let excited = excite(axis, permitted(&axis), |_| 0.0);
    let mut record = Record::with_capacity(1e-3, Takes::Effort, 8000);
    let mut simulator = Simulator::new(axis);
    for (k, &command) in excited.record.commands.iter().enumerate() {
        record.push(command, simulator.position());
        simulator.disturbance = 0.4 * ((k as f64) * 0.08).sin();
        simulator.cycle(command);
    }
    let refusal = identify(&record).unwrap_err();
    assert!(matches!(refusal, Refusal::PoorFit { percent, least: 80.0 } if percent < 80.0), "{refusal}");
}

#[test]
fn invalid_records_are_refused() {
    let record = |commands: usize, positions: usize| Record {
        cycle: 1e-3,
        takes: Takes::Effort,
        commands: vec![0.1; commands],
        positions: (0..positions as i64).collect(),
        efforts: Vec::new(),
    };
    let said = |record: &Record| identify(record).unwrap_err().to_string();
    assert_eq!(
        said(&record(100, 99)),
        "the record has 100 commands, 99 positions and 0 efforts; as many of each are expected, or no effort"
    );
    assert_eq!(said(&record(63, 63)), "the record has 63 cycles; at least 64 are expected");
    let mut wrong = record(100, 100);
    wrong.commands[7] = f64::NAN;
    assert_eq!(said(&wrong), "command is NaN ; -1 to 1  is permitted");
    wrong.commands[7] = 1.5;
    assert_eq!(said(&wrong), "command is 1.5 ; -1 to 1  is permitted");
    let mut idle = record(100, 100);
    idle.commands.fill(0.0);
    assert_eq!(said(&idle), "the largest command is 0; above 0 is expected");
    let slow = Record { cycle: 0.0, ..record(100, 100) };
    assert_eq!(said(&slow), "cycle is 0 s; 0.00001 to 1 s is permitted");
}

/// Positions at both ends of their range: nothing overflows.
#[test]
fn positions_at_the_end_of_the_numbers() {
    let mut record = Record::with_capacity(1e-3, Takes::Velocity, 200);
    for k in 0..200 {
        record.push(if k % 2 == 0 { 1.0 } else { -1.0 }, if k % 2 == 0 { i64::MAX } else { i64::MIN });
    }
    assert!(identify(&record).is_err());
}

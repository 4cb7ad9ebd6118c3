//! Recorded run of the demo cell, for tests.

use super::encoder::Encoder;
use super::{Cycle, CycleTime, Encoded};
use crate::cell::Cell;
use crate::scenario::{Player, Scenario};
use lineshaft_core::drive::{Backend, Inputs};
use lineshaft_core::event::Event;
use lineshaft_core::machine::{MAX_COMMANDS, Machine};
use lineshaft_core::signal::Board;

/// All axes are switched on; x, y and the turret move back and forth; one request is refused.
pub(crate) const MOVING: &str = "
scenario: moving
cycles: CYCLES
steps:
  - {at: 0, do: {enable: {}}}
  - {at: 100, every: 900, do: {move_axis: {axis: x, position: 600 mm, velocity: 1 m/s}}}
  - {at: 150, every: 900, do: {move_axis: {axis: y, position: 400 mm}}}
  - {at: 120, do: {move_axis: {axis: turret, mode: velocity, velocity: 45 deg/s}}}
  - {at: 130, do: {move_axis: {axis: line, mode: velocity, velocity: 0.7 m/s}}}
  - {at: 550, every: 900, do: {move_axis: {axis: x, position: 10.001 mm, velocity: 1.1 m/s}}}
  - {at: 620, every: 900, do: {move_axis: {axis: y, position: 0.5 mm}}}
  - {at: 200, do: {move_axis: {axis: x, position: 9 m}}, refused: max_position}
";

/// Results of a run, cycle by cycle.
#[derive(Default)]
pub(crate) struct Recorded {
    pub encoded: Vec<Encoded>,
    pub inputs: Vec<Inputs>,
    pub boards: Vec<Board>,
    pub events: Vec<Vec<Event>>,
}

/// Runs `scenario` on `cell`; there is one key cycle per second, with a state. Cycle 0 is at `start_ns`.
pub(crate) fn record(cell: &Cell, scenario: &str, cycles: u64, start_ns: u64) -> Recorded {
    let scenario = scenario.replace("CYCLES", &cycles.to_string());
    let scenario = Scenario::parse("rig.yaml", &scenario, cell).unwrap_or_else(|problems| panic!("{problems}"));
    let mut machine = Machine::new(cell.machine.clone()).unwrap_or_else(|error| panic!("{error}"));
    let mut plant = cell.plant();
    let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let mut player = Player::new(&scenario);
    let mut encoder = Encoder::new(cell, machine.config(), machine.directory());
    let mut recorded = Recorded::default();
    let mut sequence = 0;
    let key = 1_000_000_000 / cell.machine.cycle_ns;
    for cycle in 0..cycles {
        player.before(cycle, &mut sequence, Some(&mut plant), MAX_COMMANDS);
        inputs.begin(cycle, 0);
        plant.read(&mut inputs);
        player.override_inputs(&mut inputs);
        let is_key = cycle.is_multiple_of(key);
        let state = is_key.then(|| format!("state before {cycle}").into_bytes());
        machine.cycle(&inputs, player.commands(), &mut outputs);
        plant.write(&outputs);
        player.after(&machine);
        let commands: Vec<_> = player.commands().iter().cloned().collect();
        let time = CycleTime::same(start_ns + cycle * cell.machine.cycle_ns);
        let (events, board) = (machine.events(), machine.board());
        let what =
            Cycle { time, inputs: &inputs, commands: &commands, stream: player.commands().stream, events, board };
        let parameters = (is_key && cycle > 0).then(|| format!("parameters before {cycle}"));
        recorded.encoded.push(Encoded { state, parameters, ..encoder.encode(&what) });
        recorded.inputs.push(inputs.clone());
        recorded.boards.push(machine.board().clone());
        recorded.events.push(machine.events().to_vec());
    }
    recorded
}

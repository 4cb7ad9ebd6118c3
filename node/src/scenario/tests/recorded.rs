//! Recorded commands must have the same effect as the steps that gave them.

use super::*;
use crate::recording::verb::{setpoints_to_json, to_json};
use crate::scenario::Trace;
use lineshaft_core::code::Code;
use lineshaft_core::command::{Action, Command, Setpoints};
use lineshaft_core::drive::Inputs;
use lineshaft_core::event::{Event, Kind};
use std::collections::BTreeSet;
use std::fmt::Write;

/// Inputs and results of a run of a scenario.
struct Played {
    inputs: Vec<Inputs>,
    commands: Vec<Vec<Command>>,
    streams: Vec<Option<Setpoints>>,
    events: Vec<Event>,
    csv: String,
    report: Report,
}

/// Plays a scenario with all signals traced, on a simulated plant or with the inputs of another run.
fn play(cell: &Cell, scenario: &Scenario, recorded: Option<&[Inputs]>) -> Played {
    let everything = format!("{{scenario: all signals, cycles: {}}}", scenario.cycles());
    let everything = Scenario::parse("all.yaml", &everything, cell).unwrap();
    let mut machine = Machine::new(cell.machine.clone()).unwrap();
    let mut plant = cell.plant();
    let mut trace = Trace::new(Vec::new(), &everything, machine.directory()).unwrap();
    let mut player = Player::new(scenario);
    let (mut inputs, mut outputs, mut sequence) = (machine.inputs(), machine.outputs(), 0);
    let (mut all_inputs, mut commands, mut streams, mut events) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for cycle in 0..scenario.cycles() {
        player.before(cycle, &mut sequence, Some(&mut plant).filter(|_| recorded.is_none()), MAX_COMMANDS);
        match recorded {
            Some(recorded) => inputs = recorded[cycle as usize].clone(),
            None => {
                inputs.begin(cycle, 0);
                plant.read(&mut inputs);
                player.override_inputs(&mut inputs);
            }
        }
        machine.cycle(&inputs, player.commands(), &mut outputs);
        plant.write(&outputs);
        player.after(&machine);
        trace.write(cycle, machine.board()).unwrap();
        events.extend_from_slice(machine.events());
        all_inputs.push(inputs.clone());
        let mut given: Vec<Command> = player.commands().iter().cloned().collect();
        given.sort_by_key(|command| command.sequence);
        commands.push(given);
        streams.push(player.commands().stream.cloned());
    }
    let csv = String::from_utf8(trace.finish().unwrap()).unwrap();
    Played { inputs: all_inputs, commands, streams, events, csv, report: player.finish() }
}

/// Returns a scenario of only the recorded commands, each in its cycle.
fn generated(played: &Played, cell: &Cell) -> String {
    let mut text = format!("scenario: generated\ncycles: {}\nsteps:\n", played.commands.len());
    let (mut carried, mut named) = (BTreeSet::new(), BTreeSet::new());
    for (cycle, command) in played.commands.iter().enumerate().flat_map(|(k, c)| c.iter().map(move |c| (k, c))) {
        let verb = match &command.action {
            // No verb of a scenario gives a request that never became a command; any refused request replaces it.
            Action::Refuse(_) => "{move_axis: {axis: nothing, position: 0}}".to_owned(),
            _ => to_json(command, &cell.machine),
        };
        let refusal = played.events.iter().find(|e| e.command == command.sequence && e.kind == Kind::Refused);
        let code = refusal.and_then(|event| Code::rows().find(|row| row.code == event.code));
        let refused = match code {
            Some(row) if row.code == Code::BAD_REQUEST => ", refused: no axis is called".to_owned(),
            Some(row) => format!(", refused: {}", row.name),
            None => String::new(),
        };
        writeln!(text, "- {{at: {cycle}, do: {verb}{refused}}}").unwrap();
        match command.action {
            Action::Move(_) | Action::Probe(_) | Action::Synchronize(_) | Action::Phase(_) | Action::Trajectory(_) => {
                carried.insert(command.sequence)
            }
            Action::Cancel { goal } => named.insert(goal),
            _ => false,
        };
    }
    for (cycle, set) in played.streams.iter().enumerate() {
        if let Some(set) = set {
            writeln!(text, "- {{at: {cycle}, do: {}}}", setpoints_to_json(set, &cell.machine)).unwrap();
        }
    }
    // An ID that no command had when it was cancelled: a step that never fires gets it.
    for goal in named.difference(&carried) {
        let axis = &cell.machine.axes[0].name;
        let never = "optional: true, when: {signal: machine.overruns, min: 1}";
        writeln!(text, "- {{{never}, do: {{move_axis: {{id: \"{goal}\", axis: {axis}, position: 0}}}}}}").unwrap();
    }
    text
}

/// Plays a scenario as written, then with each command as JSON; returns the number of commands.
#[track_caller]
pub(super) fn plays_the_same_as_json(cell: &Cell, scenario: &Scenario) -> usize {
    let original = play(cell, scenario, None);
    let text = generated(&original, cell);
    let again = Scenario::parse("generated.yaml", &text, cell).unwrap_or_else(|problems| panic!("{problems}\n{text}"));
    let same = |played: &Played, inputs: &str| {
        let mut lines = original.csv.lines().zip(played.csv.lines()).enumerate();
        if let Some((line, (before, after))) = lines.find(|(_, (before, after))| before != after) {
            panic!("{inputs}, line {}:\n{before}\n{after}\n{text}", line + 1);
        }
        assert_eq!(original.csv.len(), played.csv.len(), "{inputs}");
        assert_eq!(format!("{:?}", original.events), format!("{:?}", played.events), "{inputs}");
        let is_lost = original.events.iter().any(|event| event.code == Code::EVENTS_LOST);
        assert!(played.report.passed() || is_lost, "{inputs}: {}\n{text}", played.report);
    };
    same(&play(cell, &again, Some(&original.inputs)), "recorded inputs");
    if scenario.needs_simulation().is_none() {
        same(&play(cell, &again, None), "the plant");
    }
    original.commands.iter().map(Vec::len).sum()
}

/// Every verb, driven memory cells of each type, an ID given as a number, and values without a short decimal.
const ALL_KINDS: &str = "
scenario: all of them
cycles: 3000
drive:
- {signal: feed, at: 5, ramp: {from: -40000, per_cycle: 33.3, until: 40000, wrap: 16}}
- {signal: gain, sine: {mean: 1e-3, amplitude: 1e300, period: 333}}
- {signal: flag, at: 9, values: [1, 0], then: repeat}
steps:
- {at: 0, do: {cancel: {id: 17}}, refused: UNKNOWN_GOAL}
- {at: 1, do: {move_axis: {axis: nothing, position: 0}}, refused: no axis is called}
- {at: 1, do: {enable: {}}}
- {at: 90, do: {set_parameters: {x.max_jerk: 1e3 m/s^3, x.profile: trapezoid, x.in_position_time: 3 ms, x.max_position: 9 m,
    x.error_reaction: 2, turret.max_velocity: 1.2345 rad/s}}}
- {at: 91, do: {set_parameters: {x.max_jerk: null, x.max_position: ~}}}
- {at: 100, do: {move_axis: {id: 17, axis: x, position: 33.3337 mm, velocity: 12.3456789 mm/s}}}
- {at: 200, do: {move_axis: {axis: turret, mode: relative, position: 1 rad, direction: current}}}
- {at: 900, do: {cancel: {id: \"17\"}}}
- {at: 1200, do: [{move_axis: {axis: line, mode: velocity, velocity: 0.1}}, {synchronize: {id: \"3\", axis: turret,
    master: line, mode: position, numerator: 355, denominator: 113, offset: 1.7 rad}}]}
- {at: 2000, do: [{cancel: {id: 3}}, {halt: {axes: [line]}}, {quick_stop: {axes: [x]}}]}
- {at: 2500, do: [{reset_errors: {axes: [x]}}, {disable: {axes: [turret]}}, {set_memory: {gain: -0.0, feed: 0x10}}]}
";

#[test]
fn every_verb_is_among_what_plays_the_same() {
    let (cell, scenario) = (cell(), scenario(ALL_KINDS));
    let played = play(&cell, &scenario, None);
    assert!(played.report.passed(), "{}", played.report);
    let commands = played.commands.iter().flatten();
    let verbs: BTreeSet<String> =
        commands.map(|command| to_json(command, &cell.machine).split('"').nth(1).unwrap().to_owned()).collect();
    let all =
        "cancel disable enable halt move_axis quick_stop refuse reset_errors set_memory set_parameters synchronize";
    assert_eq!(verbs.into_iter().collect::<Vec<_>>().join(" "), all);
    assert!(plays_the_same_as_json(&cell, &scenario) > 3000);
}

//! Tests scenarios with many errors, and players that are not played to the end.

use super::*;

#[test]
fn all_errors_are_told_at_once_with_their_places() {
    let text = "\
scenario: many errors
for: 3 mm
trace: [x.*, nothing.*]
drive:
  - {signal: x.state, values: [1]}
steps:
  - {at: 0, do: {enable: {axes: [z]}}}
  - {when: {signal: x.stat, is: 1}, do: {load_table: {axis: x}}}
  - {at: 1, doo: {}}
expect:
  - {signal: x.command.position, at: 0.5, is: 5 deg}
  - {event: {kind: party}, count: many}
expcet: []
";
    let expected = "\
2:6: for: `3 mm` is a length; a time such as `3 s` is expected
3:14: no signal matches `nothing.*`
5:14: x.state cannot be driven; inputs, memory cells, ENCODER.count, and of axes with a drive AXIS.actual.count and its switches can
7:33: no axis is called `z`; there are line, x, turret
8:21: no signal is called `x.stat`, did you mean `x.state`?
8:54: missing key `points` in load_table
8:54: missing key `table` in load_table
8:55: unknown key `axis` in load_table, known are table, points
9:13: unknown key `doo` in a step, did you mean `do`?
11:38: at is 0.5; a whole number of cycles, or a time with its unit is allowed, write `0.5 s`
11:47: x.command.position: `5 deg` is an angle; a length such as `5 mm` is expected
12:20: kind is `party`; one of accepted, refused, done, state, error, reset, latch, mark, limit, homed, parameter, overrun, warning is allowed
12:35: count is `many`; a whole number 0..9223372036854775807 is allowed
13:1: unknown key `expcet` in the scenario, known are scenario, cell, for, cycles, trace, every, drive, steps, expect
";
    assert_eq!(problems(text), expected);
}

#[test]
fn wrong_place_is_reported_at_its_location() {
    for (marked, sentence) in [
        ("set_position: {axis: x, position: ^5 deg}", "`5 deg` is an angle"),
        ("set_position: {axis: x, position: ^1e300}", "1e300"),
        ("set_position: {axis: ^z, position: 0}", "no axis is called `z`"),
        ("set_position: {axis: ^z.master, position: 0}", "no axis is called `z`"),
        ("home_axis: {axis: ^z}", "no axis is called `z`"),
    ] {
        let line = format!("steps: [{{at: 1, do: {{{marked}}}}}]");
        let col = line.find('^').map_or(0, |before| before + 1);
        let said = problems(&format!("scenario: s\ncycles: 9\n{}", line.replace('^', "")));
        assert!(said.starts_with(&format!("3:{col}: ")) && said.contains(sentence), "{marked}: {said}");
    }
}

#[test]
fn file_that_is_no_scenario_is_reported() {
    assert_eq!(
        problems(""),
        "1:1: a scenario has no length; `for: 3 s` or `cycles: 3000` is expected\n\
         1:1: missing key `scenario` in the scenario\n"
    );
    assert_eq!(problems("[1, 2]"), "1:1: the scenario is a list; a mapping is expected\n");
    assert!(problems("scenario: [").contains(": this is not YAML: "), "{}", problems("scenario: ["));
    assert_eq!(
        problems("# a cell\nlineshaft: 1\ncycle: 1 ms\naxes: {}\n"),
        "2:1: this looks like a cell; a scenario is expected, check it with `lineshaft check FILE`\n"
    );
    let missing = Scenario::load(Path::new("no/such.yaml"), &cell()).unwrap_err().to_string();
    assert!(missing.starts_with("no/such.yaml:1:1: cannot read the file: "), "{missing}");
    let broken = Cell { machine: Default::default(), ..cell() };
    let said = Scenario::parse("s.yaml", "scenario: s\ncycles: 1", &broken).unwrap_err().to_string();
    assert_eq!(said, "s.yaml:1:1: the cell makes no machine: cycle is 0 ns; 125000 ns to 20000000 ns is allowed\n");
}

#[test]
fn step_that_needs_a_simulation_is_reported_with_its_place() {
    let needs = |text: &str| scenario(&format!("scenario: s\ncycles: 9\n{text}")).needs_simulation();
    assert_eq!(needs("steps: [{at: 1, do: {halt: {}}}]"), None);
    assert_eq!(
        needs("steps: [{at: 1, do: [{halt: {}}, {inject: {input: {start: 1}}}]}]").as_deref(),
        Some("s.yaml:3:35: inject needs a simulated plant, run with --sim")
    );
    assert_eq!(
        needs("drive: [{signal: feed, values: [1]}]").as_deref(),
        Some("s.yaml:3:9: drive needs a simulated plant, run with --sim")
    );
}

/// Plays some cycles like a program that runs the cycle itself.
fn play(text: &str, cycles: u64) -> Report {
    let (cell, scenario) = (cell(), scenario(text));
    let mut machine = Machine::new(cell.machine.clone()).unwrap();
    let mut plant = cell.plant();
    let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let mut player = Player::new(&scenario);
    // The machine has run before the scenario starts, and other clients have sent commands.
    let mut sequence = 17;
    for _ in 0..100 {
        inputs.begin(0, 0);
        plant.read(&mut inputs);
        machine.cycle(&inputs, Default::default(), &mut outputs);
        plant.write(&outputs);
    }
    for cycle in 0..cycles {
        assert!(!player.is_over());
        player.before(cycle, &mut sequence, Some(&mut plant), MAX_COMMANDS);
        inputs.begin(0, 0);
        plant.read(&mut inputs);
        player.override_inputs(&mut inputs);
        machine.cycle(&inputs, player.commands(), &mut outputs);
        plant.write(&outputs);
        player.after(&machine);
    }
    player.finish()
}

const PLAYED: &str = "scenario: played\ncycles: 1000\ndrive: [{signal: start, values: [1, 0]}]\nsteps:\n\
    - {at: 0, do: {enable: {axes: [x]}}}\n\
    - {name: go, when: {signal: x.state, is: STANDSTILL}, do: {move_axis: {axis: x, position: 10 mm}}}\n\
    - {at: 990, do: {disable: {}}}\n\
    expect:\n\
    - {signal: start, values: [1, 0, 0]}\n\
    - {signal: x.command.position, since: go, at: 300, is: 10 mm}\n\
    - {signal: x.enabled, at: end, is: 0}\n\
    - {event: {kind: refused}, count: 0}\n";

#[test]
fn a_scenario_counts_from_its_own_start() {
    let report = play(PLAYED, 1000);
    assert_eq!(
        report.to_string(),
        "scenario `played`: PASSED\n  1000 cycles, 1 s\n  4 expectations, 3 of 3 steps fired\n"
    );
}

#[test]
fn interrupted_scenario_fails_without_reporting_pending_expectations() {
    let report = play(PLAYED, 200);
    assert_eq!(
        report.to_string(),
        "scenario `played`: FAILED\n  200 cycles, 0.2 s\n  4 expectations, 2 of 3 steps fired\n  failures:\n    \
         s.yaml:1:1: the run ended after 200 of 1000 cycles\n"
    );
    let wrong = play(&PLAYED.replace("[1, 0, 0]", "[1, 1, 0]"), 200);
    assert_eq!(wrong.failures.len(), 2, "{wrong}");
}

#[test]
fn without_a_plant_nothing_can_be_injected() {
    let scenario = scenario("scenario: s\ncycles: 1\nsteps: [{at: 0, do: {inject: {input: {start: 1}}}}]");
    let mut machine = Machine::new(cell().machine).unwrap();
    let (inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let mut player = Player::new(&scenario);
    player.before(0, &mut 0, None, MAX_COMMANDS);
    machine.cycle(&inputs, player.commands(), &mut outputs);
    player.after(&machine);
    assert_eq!(player.finish().failures.len(), 1);
}

/// A cycle accepts 64 commands; the others wait for the next cycles, in their order.
#[test]
fn commands_that_a_cycle_has_no_room_for_wait_for_the_next_one() {
    let sets = "{set_memory: {feed: 5}}, ".repeat(130);
    let text = format!(
        "scenario: s\ncycles: 10\nsteps: [{{at: 2, do: [{sets} {{set_memory: {{feed: 6}}}}, {{halt: {{}}}}]}}]"
    );
    let scenario = scenario(&text);
    let mut player = Player::new(&scenario);
    let mut sequence = 0;
    let mut given = Vec::new();
    for cycle in 0..10 {
        player.before(cycle, &mut sequence, None, MAX_COMMANDS);
        let of = player.commands();
        given.push((of.stop.len(), of.queue.len()));
        assert!(of.queue.iter().map(|command| command.sequence).is_sorted());
    }
    assert_eq!(given[..6], [(0, 0), (0, 0), (1, 63), (0, 64), (0, 4), (0, 0)]);
    let report = play(&text, 10);
    assert!(report.passed(), "{report}");
}

/// Commands that would wait beyond the end of the scenario, and commands beyond 4096 waiting ones, are reported.
#[test]
fn too_many_commands_are_reported() {
    let halts = |count: usize| "{halt: {}}, ".repeat(count);
    assert_eq!(
        failure(&format!("steps: [{{at: 0, do: [{}]}}]", halts(64 + 4096 + 1))),
        "halt was not given: 4096 commands wait for a cycle already; in cycle 0 (0 s)"
    );
    let text = format!("scenario: s\ncycles: 2\nsteps: [{{at: 1, do: [{}]}}]", halts(65));
    let report = play(&text, 2).to_string();
    assert!(report.contains("halt was not answered"), "{report}");
}

#[test]
fn key_cell_is_a_file() {
    assert_eq!(problems("scenario: s\ncycles: 1\ncell: []\n"), "3:7: cell is a list; a text is expected\n");
    assert_eq!(problems("scenario: s\ncycles: 1\ncell: ' '\n"), "3:7: cell is empty; the file of a cell is expected\n");
    // The file was selected before the scenario is read, so that any other cell may run it.
    assert_eq!(scenario("scenario: s\ncycles: 1\ncell: none.yaml\n").cycles(), 1);
}

#[test]
fn player_knows_the_step_that_fired_last() {
    let scenario = scenario(
        "scenario: s\ncycles: 10\nsteps:\n  - {at: 4, do: {set_memory: {feed: 1}}}\n  - {name: go, at: 2, do: {set_memory: {feed: 2}}}\n",
    );
    let mut player = Player::new(&scenario);
    let mut last = Vec::new();
    for cycle in 0..6 {
        player.before(cycle, &mut 0, None, MAX_COMMANDS);
        last.push(player.last_step());
    }
    let go = Some("step `go`".to_owned());
    assert_eq!(last, [None, None, go.clone(), go, Some("step 1".to_owned()), Some("step 1".to_owned())]);
}

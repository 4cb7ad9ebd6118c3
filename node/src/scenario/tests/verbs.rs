//! Tests the effect and the refusals of verbs.

use super::*;

/// Returns a scenario that enables x, then runs these steps as `go`, then the rest.
fn enabled(steps: &str) -> String {
    format!(
        "scenario: s\ncycles: 1000\nsteps:\n\
         - {{at: 0, do: {{enable: {{axes: [x, turret]}}}}}}\n\
         - {{name: go, when: {{all: [{{signal: x.state, is: STANDSTILL}}, {{signal: turret.state, is: STANDSTILL}}]}},\n   {steps}"
    )
}

#[test]
fn axes_are_switched_on_and_off() {
    passes(
        "scenario: s\ncycles: 100\nsteps:\n- {at: 0, do: {enable: {}}}\n- {at: 50, do: {disable: {axes: [x]}}}\n\
         expect:\n- {signal: x.enabled, at: 49, is: 1}\n- {signal: x.enabled, at: end, is: 0}\n\
         - {signal: turret.enabled, at: end, is: 1}\n- {signal: x.drive_state, at: 49, is: OPERATION_ENABLED}\n",
    );
}

/// 10 mm at 50 mm/s and 500 mm/s^2: 2.5 mm of acceleration, 5 mm, 2.5 mm of deceleration in 300 ms.
#[test]
fn a_move_takes_its_fields_by_ros_name_and_its_defaults() {
    passes(&enabled(
        "do: {move_axis: {axis: x, position: 10 mm}}}\nexpect:\n\
         - {signal: x.command.position, since: go, at: 0, is: 0}\n\
         - {signal: x.command.velocity, since: go, at: 150, is: 50 mm/s}\n\
         - {signal: x.command.position, since: go, at: 150, is: 5 mm}\n\
         - {signal: x.command.position, since: go, at: 300, is: 10 mm}\n\
         - {signal: x.command.position, since: go, at: 299, not: 10 mm}\n\
         - {signal: x.reference, since: go, at: 5, is: POSITION_ABSOLUTE}\n",
    ));
    let ends = |fields: &str, end: &str, at: u64| {
        passes(&enabled(&format!(
            "do: [{{move_axis: {{axis: x, {fields}}}}}]}}\nexpect:\n\
             - {{signal: x.target.position, since: go, at: 0, is: {end}}}\n\
             - {{signal: x.command.position, since: go, at: {at}, is: {end}}}\n\
             - {{signal: x.command.velocity, since: go, at: {}, not: 0}}\n",
            at - 1
        )));
    };
    // 20 mm/s at 200 mm/s^2: 100 ms and 1 mm each of acceleration and deceleration, 8 mm at constant speed in 400 ms.
    ends("position: 0.01, velocity: 0.02, acceleration: 0.2, deceleration: 0.2", "10 mm", 600);
    ends("units: axis_unit, position: 10, velocity: 20, acceleration: 200, deceleration: 200, mode: 1", "10 mm", 600);
    ends(
        "units: increments, position: 10000, velocity: 20000, acceleration: 200 mm/s^2, deceleration: 2e5",
        "10 mm",
        600,
    );
    ends(
        "units: 2, mode: relative, position: -10000, buffer_mode: aborting, velocity: 2 cm/s, acceleration: 0.2 m/s^2, deceleration: 2e5",
        "-10 mm",
        600,
    );
    ends("mode: additive, position: 10 mm, jerk: 5", "10 mm", 300);
}

#[test]
fn modulo_axis_moves_in_the_requested_direction() {
    for (direction, end) in [("shortest", -9000), ("positive", 27_000), ("negative", -9000), ("current", -9000)] {
        passes(&enabled(&format!(
            "do: {{move_axis: {{axis: turret, position: 270 deg, direction: {direction}}}}}}}\nexpect:\n\
             - {{signal: turret.target.position, since: go, at: 0, is: {end}}}\n"
        )));
    }
}

/// At standstill, the direction of motion is that of the last motion.
#[test]
fn current_at_rest_is_the_way_of_the_last_motion() {
    for (first, place, then, end) in [("negative", 350, 20, -34_000), ("positive", 10, 0, 36_000)] {
        passes(&enabled(&format!(
            "do: {{move_axis: {{axis: turret, position: {place} deg, direction: {first}}}}}}}\n\
             - {{name: again, at: 900, do: {{move_axis: {{axis: turret, position: {then} deg, direction: current}}}}}}\nexpect:\n\
             - {{signal: turret.command.velocity, since: again, at: -1, is: 0}}\n\
             - {{signal: turret.target.position, since: again, at: 0, is: {end}}}\n"
        )));
    }
}

#[test]
fn velocity_goals_halts_and_quick_stops() {
    // 20 mm/s after 40 ms at 500 mm/s^2; halt at 500 mm/s^2 takes 40 ms, quick_stop at 1 m/s^2 20 ms.
    for (verb, cycles, state) in [("halt", 40, "STANDSTILL"), ("quick_stop", 20, "STOPPING")] {
        let text = enabled(&format!(
            "do: {{move_axis: {{axis: x, mode: velocity, velocity: 20 mm/s}}}}}}\n\
             - {{name: stop, when: {{signal: x.in_velocity, is: 1}}, after: 100, do: {{{verb}: {{axes: [x]}}}}}}\n\
             expect:\n\
             - {{signal: x.command.velocity, since: go, at: 40, is: 20 mm/s}}\n\
             - {{signal: x.command.velocity, since: stop, at: 0, is: 20 mm/s}}\n\
             - {{signal: x.command.velocity, since: stop, at: {}, min: 0.1 mm/s}}\n\
             - {{signal: x.command.velocity, since: stop, from: {cycles}, to: end, is: 0, within: 0.01 mm/s}}\n\
             - {{signal: x.state, since: stop, at: {}, is: {state}}}\n",
            cycles - 1,
            cycles + 10
        ));
        passes(&text);
        passes(&text.replace(
            "expect:",
            "- {at: 900, do: {reset_errors: {axes: [x]}}}\nexpect:\n- {signal: x.state, at: end, is: STANDSTILL}",
        ));
    }
}

#[test]
fn stops_go_into_the_lane_that_is_drained_first() {
    let scenario = scenario(
        "scenario: s\ncycles: 9\nsteps: [{at: 0, do: [{enable: {}}, {halt: {}}, {quick_stop: {}}, {disable: {axes: [x]}}, {set_memory: {feed: 1}}]}]",
    );
    let mut player = Player::new(&scenario);
    let mut sequence = 40;
    player.before(0, &mut sequence, None, MAX_COMMANDS);
    let numbers = |lane: &[lineshaft_core::command::Command]| lane.iter().map(|c| c.sequence).collect::<Vec<_>>();
    assert_eq!((numbers(player.commands().stop), numbers(player.commands().queue)), (vec![42, 43, 44], vec![41, 45]));
    assert_eq!(sequence, 45);
    player.before(1, &mut sequence, None, MAX_COMMANDS);
    assert_eq!((player.commands().iter().count(), sequence), (0, 45));
}

#[test]
fn a_synchronized_axis_follows_and_cancel_uncouples_it() {
    passes(&enabled(
        "do: {synchronize: {id: gear, axis: turret, master: line, mode: position, numerator: 1, denominator: 100}}}\n\
         - {name: run, when: {signal: turret.in_sync, is: 1}, do: {move_axis: {axis: line, position: 100 mm, velocity: 0.5 m/s}}}\n\
         - {name: off, when: {signal: line.command.position, is: 100 mm}, do: {cancel: {id: gear}}}\n\
         expect:\n\
         - {signal: turret.state, since: run, from: 0, to: 100, is: SYNCHRONIZED_MOTION}\n\
         - {signal: turret.command.position, since: off, at: 0, is: 1000}\n\
         - {signal: turret.state, since: off, at: 1, is: STANDSTILL}\n\
         - {event: {kind: done, source: turret, code: CANCELLED}, since: off, from: 0, to: 1, count: 1}\n",
    ));
}

#[test]
fn a_phase_shifts_a_coupled_axis_and_its_leader() {
    passes(&enabled(
        "do: {synchronize: {axis: turret, master: line, mode: position, numerator: 1, denominator: 100}}}\n\
         - {name: s, at: 50, do: {phase: {id: s, axis: turret, side: slave, shift: 5 deg, velocity: 10 deg/s, acceleration: 100 deg/s^2}}}\n\
         - {name: m, at: 700, do: {phase: {axis: turret, side: master, shift: -10 mm, velocity: 100 mm/s, acceleration: 1 m/s^2}}}\n\
         - {at: 700, do: {phase: {axis: x, shift: 1 mm}}, refused: not coupled by position}\n\
         expect:\n\
         - {signal: turret.phase.slave, since: s, from: 1, to: 590, min: 0.0001, max: 1}\n\
         - {signal: turret.command.position, at: 690, is: 500}\n\
         - {event: {kind: done, source: turret, code: 0}, since: s, from: 590, to: 610, count: 1}\n\
         - {event: {kind: done, source: turret, code: 0}, since: m, from: 190, to: 210, count: 1}\n\
         - {signal: turret.command.position, at: end, is: 400}\n",
    ));
    assert_eq!(
        bad("{phase: ^{axis: x, shift: 90 deg}}"),
        "shift: `90 deg` is an angle; a length such as `90 mm` is expected"
    );
    assert_eq!(bad("{phase: {axis: x, side: ^both, shift: 1 mm}}"), "side is `both`; one of slave, master is allowed");
}

/// At 5 inc per cycle and half of 360 deg/s^2, 18 inc/s per cycle, the turret needs about 694 inc to stop; with
/// continued motion it keeps its 5.
#[test]
fn a_coupling_is_left_at_a_place() {
    for (arguments, code, expected) in [
        ("at: master_position, increments: 60000", "GEARED_OUT", "{signal: turret.state, at: end, is: STANDSTILL}"),
        ("at: position, increments: 600", "GEARED_OUT", "{signal: turret.command.velocity, at: end, is: 0}"),
        ("at: now, disengage: keep_velocity", "GEARED_OUT", "{signal: turret.state, at: end, is: CONTINUOUS_MOTION}"),
        (
            "at: 1, increments: 60000, disengage: as_goal",
            "GEARED_OUT",
            "{signal: turret.state, at: end, is: STANDSTILL}",
        ),
    ] {
        passes(&enabled(&format!(
            "do: {{synchronize: {{id: gear, axis: turret, master: line, mode: position, numerator: 1, denominator: 100}}}}}}\n\
             - {{name: run, when: {{signal: turret.in_sync, is: 1}}, do: {{move_axis: {{axis: line, position: 900 mm, velocity: 0.5 m/s}}}}}}\n\
             - {{name: out, when: {{signal: line.command.position, min: 20 mm}}, do: {{gear_out: {{axis: turret, {arguments}}}}}}}\n\
             - {{name: left, when: {{signal: turret.sync.leaving, is: 0}}, do: {{gear_out: {{axis: turret}}}}, refused: no goal of synchronize}}\n\
             expect:\n\
             - {{signal: turret.state, since: run, from: 0, to: 40, is: SYNCHRONIZED_MOTION}}\n\
             - {expected}\n\
             - {{event: {{kind: done, source: turret, code: {code}}}, since: out, from: 0, to: end, count: 1}}\n"
        )));
    }
    assert_eq!(
        bad("{gear_out: {axis: turret, at: ^later}}"),
        "at is `later`; one of now, master_position, position is allowed"
    );
    assert_eq!(
        bad("{gear_out: ^{axis: turret, increments: 5}}"),
        "increments is 5; 0 is allowed with at NOW, which waits for no place"
    );
}

#[test]
fn a_value_for_the_lower_loops_is_a_part_of_what_is_full() {
    passes(&enabled("do: {out_an: {axis: x, value: 0.5}}, refused: no loop below its position loop is closed here}\n"));
    assert_eq!(bad("{out_an: {axis: x, value: ^1.5}}"), "value is 1.5; -1..1 is allowed");
    assert_eq!(
        bad("{out_an: {axis: x, value: 0, level: ^volt}}"),
        "level is `volt`; one of setpoint, effort is allowed"
    );
    assert!(bad("{out_an: ^{axis: q, value: 0}}").starts_with("no axis is called `q`"));
}

#[test]
fn an_id_names_the_last_command_that_carried_it_and_a_goal_that_is_none_cannot_be_cancelled() {
    passes(&enabled(
        "do: {cancel: {id: m}}, refused: is not active}\n\
         - {at: 50, every: 50, count: 2, do: {move_axis: {id: m, axis: x, mode: relative, position: 50 mm}}}\n\
         - {name: off, at: 150, do: {cancel: {id: m}}}\n\
         expect:\n\
         - {event: {kind: done, source: x, code: REPLACED}, from: 100, to: 100, count: 1}\n\
         - {event: {kind: done, source: x, code: 10103}, since: off, count: 1}\n",
    ));
}

/// The run assigns the number of a goal; the author of the scenario has only its ID.
#[test]
fn late_cancel_is_reported_with_the_id() {
    let steps = enabled(
        "do: {move_axis: {id: h, axis: x, mode: relative, position: 1 mm}}}\n\
         - {at: 800, do: {cancel: {id: h}}, refused: goal `h` is not active}\n\
         - {at: 801, do: {cancel: {id: h}}}\n",
    );
    let report = run(&steps);
    let said: Vec<_> = report.failures.iter().map(|failure| failure.sentence.as_str()).collect();
    assert_eq!(said, ["cancel was refused: machine: goal `h` is not active; in cycle 801 (0.801 s)"]);
    let said: Vec<_> = report.refused.iter().map(|failure| failure.sentence.as_str()).collect();
    assert_eq!(said, ["cancel: machine: goal `h` is not active; in cycle 800 (0.8 s)"]);
}

#[test]
fn parameters_are_set_with_units_by_the_rule_of_every_door() {
    passes(&enabled(
        "do: {set_parameters: {x.max_velocity: 0.02 m/s, x.error_reaction: 3, x.profile: trapezoid, x.in_position_time: 0.005, \
         turret.max_acceleration: 1 rev/s^2}}}\n\
         - {at: 100, do: {move_axis: {axis: x, position: 1, velocity: 20.1 mm/s}}, refused: max_velocity 20 mm/s}\n\
         expect:\n\
         - {event: {kind: parameter, source: x, text: in_position_time is 5 ms}, count: 1}\n\
         - {event: {kind: parameter, source: turret, text: 360 deg/s^2}, count: 1}\n\
         - {event: {kind: parameter, source: x}, count: 4}\n",
    ));
}

#[test]
fn the_plant_is_made_to_fail() {
    let inject = |what: &str, expect: &str| {
        passes(&enabled(&format!("do: {{inject: {what}}}}}\nexpect:\n- {{{expect}}}\n")));
    };
    inject("{fault: {axis: x, code: 0x8611}}", "signal: x.error, since: go, at: 1, is: 99857"); // 0x10000 + 0x8611
    inject("{fault: {axis: x, code: 1}}", "event: {kind: error, source: x, code: 0x10001}, since: go, at: 0, count: 1");
    inject("{drive_lost: {axis: x}}", "signal: x.error, since: go, at: 0, is: DRIVE_LOST");
    inject("{drive_lost: {axis: x}}", "signal: turret.error, is: 0");
    inject("{bus_lost: {backend: plant}}", "signal: turret.error, since: go, at: 0, is: BUS_ERROR");
    inject(
        "{emergency: {axis: x, code: 0x8130, data: [1, 2, 3, 4, 255]}}",
        "event: {kind: warning, source: x, text: \"8130h (life guard or heartbeat), register 00h, data 01 02 03 04 FF\"}, since: go, at: 0, count: 1",
    );
    inject("{encoder_jump: {axis: x, by: 3 mm}}", "signal: x.actual.position, since: go, at: 0, is: 3 mm");
    inject("{encoder_jump: {axis: x, by: 11000}}", "signal: x.error, since: go, at: 0, is: FOLLOWING_ERROR");
    inject("{encoder_jump: {axis: belt, by: -80}}", "signal: belt.position, since: go, from: 0, to: end, is: -2 mm");
    inject("{input: {start: 1}}", "signal: start, since: go, from: 0, to: end, is: 1");
    inject("{input: {level: -1500 mV}}", "signal: level, since: go, from: 0, to: end, is: -1.5");
    inject(
        "{latch: {input: mark, age: 350 us, edge: falling}}",
        "event: {kind: latch, source: mark, age_ns: 350000, text: falling}, since: go, at: 0, count: 1",
    );
    let stuck = "since: go, from: 0, to: end";
    inject("{stuck_switch: {axis: x, home: 1}}", &format!("signal: x.reference_switch, {stuck}, is: 1"));
    inject("{stuck_switch: {axis: x, positive: 1, home: 0}}", &format!("signal: x.limit.positive, {stuck}, is: 1"));
    inject("{stuck_switch: {axis: x, negative: 1}}", &format!("signal: x.limit.negative, {stuck}, is: 1"));
    inject("{jam: {axis: x}}", "signal: x.actual.position, since: go, from: 1, to: 20, is: 0, within: 20 mm");
    inject("{latch: {input: x}}", "signal: x.latch.count, since: go, from: 0, to: end, is: 1");
    inject("{latch: {input: belt}}", "event: {kind: latch, source: belt, increments: 0 mm, age_ns: 0}, count: 1");
}

#[test]
fn too_many_latches_in_a_cycle_are_reported() {
    let latches = "{inject: {latch: {input: mark}}}, ".repeat(17);
    assert_eq!(
        failure(&format!("steps: [{{at: 1, do: [{latches}]}}]")),
        "inject had no effect: the plant has no such drive, its bus is off, or there is no room for another latch; in cycle 1 (0.001 s)"
    );
}

#[test]
fn a_refusal_fails_the_scenario_unless_it_is_expected() {
    let step = |rest: &str| format!("steps: [{{at: 10, do: {{move_axis: {{axis: x, position: 5 mm}}}}{rest}}}]");
    let sentence = "move_axis was refused: x: the axis is not enabled; enable it first";
    assert_eq!(failure(&step("")), format!("{sentence}; in cycle 10 (0.01 s)"));
    for text in [
        "not enabled",
        "NOT_ENABLED",
        "'x: the axis is not enabled; enable it first'",
        "'X: The Axis Is Not Enabled'",
        "not_enabled",
        "{code: 10007}",
        "{code: NOT_ENABLED}",
        "{code: NOT_ENABLED, text: Enable it}",
        "any",
    ] {
        passes(&format!("scenario: s\ncycles: 20\n{}", step(&format!(", refused: {text}"))));
    }
    assert_eq!(
        failure(&step(", refused: max_position")),
        format!("{sentence}; a refusal with `max_position` was expected; in cycle 10 (0.01 s)")
    );
    assert_eq!(
        failure("steps: [{at: 10, do: {enable: {}}, refused: max_position}]"),
        "enable was accepted; a refusal with `max_position` was expected; in cycle 10 (0.01 s)"
    );
    assert_eq!(
        failure(&step(", refused: {code: 98}")),
        format!("{sentence}; a refusal with code 98 was expected; in cycle 10 (0.01 s)")
    );
    assert_eq!(
        failure(&step(", refused: {code: NOT_ENABLED, text: max_position}")),
        format!("{sentence}; a refusal with code 10007 and `max_position` was expected; in cycle 10 (0.01 s)")
    );
    assert_eq!(
        failure("steps: [{at: 10, do: {enable: {}}, refused: {code: 98}}]"),
        "enable was accepted; a refusal with code 98 was expected; in cycle 10 (0.01 s)"
    );
    assert_eq!(
        failure("steps: [{at: 10, do: {enable: {}}, refused: any}]"),
        "enable was accepted; a refusal with any sentence was expected; in cycle 10 (0.01 s)"
    );
    // As a part of the message it is ordinary text: "enable it first" does not contain it.
    assert_eq!(
        failure(&step(", refused: {text: any}")),
        format!("{sentence}; a refusal with `any` was expected; in cycle 10 (0.01 s)")
    );
    let part = "a part of the sentence, a code or `any` is expected";
    assert_eq!(
        problem("steps", "{at: 1, do: {enable: {}}, refused: ^true}"),
        format!("refused is true; {part}, write `refused: any`")
    );
    assert_eq!(
        problem("steps", "{at: 1, do: {enable: {}}, refused: ^false}"),
        format!("refused is false; {part}, leave `refused` out")
    );
    assert_eq!(
        problem("steps", "{at: 1, do: {enable: {}}, refused: ^{}}"),
        "refused asks for nothing; code, text or both are expected"
    );
    assert_eq!(
        problem("steps", "{at: 1, do: {enable: {}}, refused: {code: ^NOT_ENABLD}}"),
        "no code is called `NOT_ENABLD`; a number or a name is expected, did you mean `NOT_ENABLED`?"
    );
    assert_eq!(
        problem("steps", "{at: 1, do: {enable: {}}, refused: {code: ^above_max_position}}"),
        "no code is called `above_max_position`; a number or a name is expected, did you mean `ABOVE_MAX_POSITION`?"
    );
    assert_eq!(
        problem("steps", "{at: 1, do: {enable: {}}, refused: ^10007}"),
        format!("refused is 10007; {part}, write `refused: {{code: 10007}}`")
    );
    for (given, hint) in [("yes", "write `refused: any`"), ("Off", "leave `refused` out")] {
        assert_eq!(
            problem("steps", &format!("{{at: 1, do: {{enable: {{}}}}, refused: ^{given}}}")),
            format!("refused is {given}; {part}, {hint}")
        );
    }
    assert_eq!(
        failure(&step(", refused: '10007'")),
        format!(
            "{sentence}; a refusal with the text `10007` (a code is written `{{code: 10007}}`) was expected; in cycle 10 (0.01 s)"
        )
    );
    assert_eq!(failure(&step(", every: 100, count: 3")), format!("{sentence}; in cycle 10 (0.01 s), and 2 times more"));
    assert_eq!(failure(&step(", every: 100, count: 2")), format!("{sentence}; in cycle 10 (0.01 s), and once more"));
}

/// The same range is reported whether a number exceeds the row, the cycle or the integer range.
#[test]
fn every_large_velocity_is_refused_with_one_range() {
    for (given, shown) in
        [("3e9 mm/s", "3000000000 mm/s"), ("2e12 mm/s", "2000000000000 mm/s"), ("2147483650 mm/s", "2147483650 mm/s")]
    {
        let steps = format!("steps: [{{at: 10, do: {{set_parameters: {{x.max_velocity: {given}}}}}}}]");
        let sentence = format!("x: max_velocity is {shown}; more than 0 up to 2147483648 mm/s is allowed");
        assert_eq!(failure(&steps), format!("set_parameters was refused: {sentence}; in cycle 10 (0.01 s)"), "{given}");
    }
    for (given, shown) in [("^1e37", "1e37 m/s"), ("^-1e37", "-1e37 m/s"), ("^1e37 mm/s", "1e37 mm/s")] {
        let said = bad(&format!("{{set_parameters: {{x.max_velocity: {given}}}}}"));
        let sentence = format!("x.max_velocity is `{shown}`; more than 0 up to 2147483648 mm/s is expected");
        assert_eq!(said, sentence, "{given}");
    }
}

#[test]
fn what_is_no_request_counts_as_refused_where_that_is_expected() {
    passes(
        "{scenario: s, cycles: 9, steps: [{at: 1, do: {move_axis: {axis: z, position: 0}}, refused: {code: BAD_REQUEST, text: NO axis}}]}",
    );
    let report = run("scenario: s\ncycles: 20\nsteps:\n\
         - {at: 1, do: {move_axis: {axis: z, position: 5 mm}}, refused: no axis is called}\n\
         - {at: 2, do: {synchronize: {axis: x, master: line, mode: marker, offset: 1 mm}}, refused: mode MARKER}\n\
         - {at: 3, do: {set_parameters: {x.max_velocity: 1 m/s, x.encoderclock: 0}}, refused: encoderclock}\n\
         expect: [{event: {kind: refused, code: BAD_REQUEST, source: machine}, count: 2},\n\
         {event: {kind: refused, code: NOT_BUILT, source: x}, count: 1}]");
    assert_eq!(
        report.to_string(),
        "scenario `s`: PASSED\n  20 cycles, 0.02 s\n  2 expectations, 3 of 3 steps fired\n  refused as expected:\n    \
         s.yaml:4:16: move_axis: no axis is called `z`; there are line, x, turret; in cycle 1 (0.001 s)\n    \
         s.yaml:5:16: synchronize: offset is `1 mm`; 0 is allowed with mode MARKER, where parameter syncposoffs shifts the axis against the marks; in cycle 2 (0.002 s)\n    \
         s.yaml:6:16: set_parameters: x: encoderclock is 0: a serial interface whose clock could be left to another one does not exist yet; only 1 is allowed; in cycle 3 (0.003 s)\n"
    );
}

#[test]
fn verbs_that_are_not_built_are_refused_by_name() {
    assert!(
        bad("{synchronize: ^{axis: x, master: line, mode: marker, offset: 1 mm}}")
            .contains("0 is allowed with mode MARKER")
    );
}

/// 1000000 increments are one metre of the line, 36000 one revolution of the turret.
#[test]
fn places_of_a_gear_may_have_units() {
    let acts = |master: &str, slave: &str, distance: &str| {
        let goal = format!(
            "axis: turret, master: line, mode: position, engage: at_position, numerator: 36, denominator: 100, \
             master_increments: {master}, slave_increments: {slave}, start_distance_increments: {distance}"
        );
        let text = format!("scenario: s\ncycles: 10\nsteps: [{{at: 0, do: {{synchronize: {{{goal}}}}}}}]\n");
        format!("{:?}", scenario(&text).0.acts)
    };
    let expected = acts("500000", "4000", "100000");
    assert_eq!(acts("500 mm", "40 deg", "0.1 m"), expected);
    assert_eq!(acts("500000 inc", "4000 inc", "100000 inc"), expected);
    assert_ne!(acts("501 mm", "40 deg", "0.1 m"), expected);
}

/// Returns the problem of a verb.
fn bad(verb: &str) -> String {
    problem("steps", &format!("{{at: 1, do: {verb}}}"))
}

#[test]
fn method_of_homing_without_its_scheme_is_refused_with_the_scheme() {
    assert_eq!(
        bad("{home_axis: ^{axis: x, method: 35}}"),
        "method is 35; 0 is allowed with scheme CONFIGURED; CIA402 and MACS take a number, write `scheme: cia402`"
    );
}

#[test]
fn errors_of_a_verb_are_reported() {
    assert_eq!(bad("{^mov_axis: {axis: x}}"), "there is no verb `mov_axis`, did you mean `move_axis`?");
    assert!(bad("{^jump: {}}").starts_with("there is no verb `jump`, known are enable, disable, "));
    // Commands of the program, and function blocks of PLCopen.
    for (name, verbs) in [
        ("home", "`home_axis`"),
        ("reset", "`reset_errors`"),
        ("stop", "`halt` or `quick_stop`"),
        ("jog", "`setpoints`"),
        ("move", "`move_axis`"),
        ("MC_MoveAbsolute", "`move_axis`"),
        ("move_absolute", "`move_axis`"),
        ("gear_in", "`synchronize`"),
        ("touchprobe", "`touch_probe`"),
    ] {
        assert_eq!(bad(&format!("{{^{name}: {{}}}}")), format!("there is no verb `{name}`, did you mean {verbs}?"));
    }
    assert_eq!(bad("{enable: {axes: ^[x, z]}}"), "no axis is called `z`; there are line, x, turret");
    assert_eq!(bad("{enable: {axes: ^x}}"), "axes is `x`; a list is expected");
    assert_eq!(bad("{halt: {^axis: [x]}}"), "unknown key `axis` in halt, did you mean `axes`?");
    assert_eq!(bad("{move_axis: ^{position: 5 mm}}"), "missing key `axis` in move_axis");
    for mode in ["absolute", "relative", "2", "superimposed"] {
        let said = bad(&format!("{{move_axis: ^{{axis: x, mode: {mode}, velocity: 5 mm/s}}}}"));
        assert_eq!(said, "missing key `position` in move_axis", "{mode}");
    }
    assert_eq!(bad("{move_axis: ^{axis: x}}"), "missing key `position` in move_axis");
    assert_eq!(
        bad("{move_axis: ^{axis: x, position: 90 deg}}"),
        "position: `90 deg` is an angle; a length such as `90 mm` is expected"
    );
    assert_eq!(
        bad("{move_axis: {axis: x, position: ^9mm}}"),
        "position: `9mm` has no blank between number and unit, write `9 mm`"
    );
    assert_eq!(
        bad("{move_axis: {axis: x, position: 0, velocity: ^9 furlong}}"),
        "velocity: `furlong` in `9 furlong` is not a unit; a velocity has nm/s, um/s, mm/s, cm/s, m/s"
    );
    assert_eq!(
        bad("{move_axis: {axis: x, mode: ^absolut}}"),
        "mode is `absolut`; one of absolute, relative, additive, velocity, superimposed is allowed, did you mean `absolute`?"
    );
    assert_eq!(
        bad("{move_axis: ^{axis: x, mode: 9}}"),
        "mode is 9; 0 ABSOLUTE, 1 RELATIVE, 2 ADDITIVE, 3 VELOCITY, 4 SUPERIMPOSED are allowed"
    );
    assert_eq!(
        bad("{move_axis: ^{axis: x, position: 0, units: 3}}"),
        "units is 3; 0 SI, 1 AXIS_UNIT, 2 INCREMENTS are allowed"
    );
    assert_eq!(bad("{move_axis: {axis: x, mode: ^300}}"), "mode is 300; 0..255 is allowed");
    assert_eq!(
        bad("{synchronize: ^{axis: x, master: mark}}"),
        "`mark` cannot lead; line, line.actual, x, x.actual, turret, turret.actual, belt, machine.vmaster can"
    );
    assert_eq!(
        bad("{synchronize: {axis: x, master: line, master_increments: ^5}}"),
        "master_increments belongs to `engage: at_position`"
    );
    assert_eq!(bad("{synchronize: {axis: x, master: line, event: ^mark}}"), "event belongs to `engage: on_event`");
    assert_eq!(
        bad(
            "{synchronize: ^{axis: x, master: line, mode: position, engage: at_position, start_distance_increments: -1}}"
        ),
        "start_distance_increments is -1; 0 to 2147483648 is allowed"
    );
    // 9 : 0 is no gear.
    assert_eq!(
        bad("{synchronize: ^{axis: x, master: line, mode: position, numerator: 9}}"),
        "missing key `denominator` in synchronize"
    );
    assert_eq!(
        bad("{synchronize: ^{axis: x, master: line, denominator: 125}}"),
        "missing key `numerator` in synchronize"
    );
    assert_eq!(
        bad("{synchronize: {axis: x, master: line, numerator: 9, ^denominater: 125}}"),
        "unknown key `denominater` in synchronize, did you mean `denominator`?"
    );
    let at = |key: &str| {
        bad(&format!("{{synchronize: {{axis: turret, master: line, mode: position, engage: at_position, {key}}}}}"))
    };
    assert_eq!(
        at("master_increments: ^90 deg"),
        "master_increments: `90 deg` is an angle; a length such as `90 m` is expected"
    );
    assert_eq!(
        at("slave_increments: ^5 mm"),
        "slave_increments: `5 mm` is a length; an angle such as `5 deg` is expected"
    );
    assert!(at("master_increments: ^0.5").starts_with("master_increments is `0.5`; a whole number "));
    let unknown = bad("{synchronize: ^{axis: x, master: line, engage: on_event, event: lamp}}");
    assert!(unknown.starts_with("`lamp` does not latch; "), "{unknown}");
    assert_eq!(
        bad("{synchronize: ^{axis: x, master: line, mode: velocity, offset: 5 mm}}"),
        "offset is `5 mm`; 0 is allowed with mode VELOCITY, which keeps no position"
    );
    assert_eq!(
        bad("{move_axis: ^{axis: x, position: 5 mm, direction: positive}}"),
        "direction is 1; 0 SHORTEST is allowed, as the axis has no modulo"
    );
    assert_eq!(bad("{cancel: {id: ^m}}"), "no command has the id `m`");
    assert_eq!(
        bad("[{move_axis: {id: m, axis: x, position: 0}}, {move_axis: {id: ^m, axis: x, position: 0}}]"),
        "id `m` stands twice"
    );
    assert_eq!(bad("{set_parameters: ^{}}"), "set_parameters is empty; `axis.key: value` is expected");
    assert_eq!(
        bad("{set_parameters: {x.max_velocity: ^5 mm}}"),
        "x.max_velocity: `5 mm` is a length; a velocity such as `5 mm/s` is expected"
    );
    assert_eq!(
        bad("{set_parameters: {x.profile: ^round}}"),
        "x.profile is `round`; one of trapezoid, s_ramp, jerk is expected"
    );
    assert_eq!(
        bad("{set_parameters: {max_velocity: ^5}}"),
        "no parameter is called `max_velocity`; parameters are written axis.key"
    );
    assert_eq!(bad("{set_memory: {^fed: 5}}"), "no memory cell is called `fed`, did you mean `feed`?");
    assert_eq!(bad("{set_memory: {feed: ^0.5}}"), "feed is `0.5`; a whole number -32768..32767 is allowed");
    for beyond in ["40000", "32768", "-32769", "9007199254740993"] {
        let said = bad(&format!("{{set_memory: {{feed: ^{beyond}}}}}"));
        assert_eq!(said, format!("feed is {beyond}; -32768..32767 is allowed"));
    }
    assert_eq!(
        bad("{set_parameters: {x.max_velocity: ^null}}"),
        "x.max_velocity is `null`; a velocity such as 0.5 m/s is expected"
    );
    assert_eq!(bad("{set_memory: {flag: ^2}}"), "flag is 2; 0..1 is allowed");
    assert_eq!(bad("{set_memory: ^{}}"), "set_memory is empty; `cell: value` is expected");
    assert_eq!(bad("{inject: {latch: {input: ^start}}}"), "start does not latch, give it `latch: true` in the cell");
    assert_eq!(
        bad("{inject: {latch: {input: ^line}}}"),
        "line has no drive; an input with `latch: true`, an encoder or an axis with a drive latches"
    );
    assert_eq!(
        bad("{inject: {latch: {input: mark, age: ^1 ms}}}"),
        "age is 1000000 ns; less than a cycle of 1000000 ns is allowed"
    );
    assert_eq!(bad("{inject: {input: {^lamp: 1}}}"), "lamp is no input");
    assert_eq!(bad("{inject: {fault: {axis: ^line, code: 5}}}"), "line is virtual: it has no drive");
    assert_eq!(bad("{inject: {fault: {axis: x, code: ^0}}}"), "code is 0; 1..65535 is allowed");
    assert_eq!(bad("{inject: {drive_lost: {axis: ^q}}}"), "no axis is called `q`; there are line, x, turret");
    assert_eq!(
        bad("{inject: {bus_lost: {backend: ^plnt}}}"),
        "no backend is called `plnt` in the cell, did you mean `plant`?"
    );
    let short = "data has 2 bytes; 5 are expected";
    assert_eq!(bad("{inject: {emergency: {axis: x, code: 0x8130, data: ^[1, 2]}}}"), short);
    assert_eq!(bad("{inject: {emergency: {axis: x, code: 1, register: ^256}}}"), "register is 256; 0..255 is allowed");
    assert_eq!(bad("{inject: {index_lost: {axis: ^line}}}"), "line is virtual: it has no drive");
    assert_eq!(bad("{inject: {stuck_switch: {axis: ^line, home: 1}}}"), "line is virtual: it has no drive");
    assert_eq!(bad("{inject: {stuck_switch: {axis: x, home: ^2}}}"), "home is 2; 0..1 is allowed");
    assert_eq!(bad("{inject: {stuck_switch: ^{home: 1}}}"), "missing key `axis` in stuck_switch");
    assert_eq!(bad("{inject: {jam: {axis: ^line}}}"), "line is virtual: it has no drive");
    assert_eq!(bad("{inject: {jam: {axis: x, drive: ^2}}}"), "drive is 2; x has one drive, leave it out");
    assert_eq!(bad("{inject: {drive_lost: {axis: x, drive: ^3}}}"), "drive is 3; 1..2 is allowed");
    assert_eq!(
        bad("{inject: {encoder_jump: {axis: belt, drive: ^1, by: 3}}}"),
        "drive is for an axis; this is an entry of encoders, leave it out"
    );
    assert_eq!(
        bad("{inject: {^explode: {}}}"),
        "`explode` cannot be injected; latch, input, fault, emergency, drive_lost, bus_lost, encoder_jump, encoder_bits, \
         encoder_cut, encoder_dead, encoder_slip, index_lost, jam, stuck_switch, power_cycle can"
    );
    assert_eq!(
        bad("{inject: ^{}}"),
        "inject does one thing: one of latch, input, fault, emergency, drive_lost, bus_lost, encoder_jump, encoder_bits, \
         encoder_cut, encoder_dead, encoder_slip, index_lost, jam, stuck_switch, power_cycle"
    );
    let refused = problem("steps", "{at: 1, refused: x, do: {inject: ^{latch: {input: mark}}}}");
    assert_eq!(refused, "inject is never refused; leave `refused` out of this step");
    let other = problem("steps", "{at: 1, refused: max_position, do: {halt: {axes: ^[z]}}}");
    assert_eq!(
        other,
        "no axis is called `z`; there are line, x, turret, `refused` asks for `max_position`; this has code 10022"
    );
}

/// Registers are set, then the command flags are executed; several axes of one step start in the same cycle.
#[test]
fn saia_sets_registers_and_runs_commands() {
    let verb = |axis: &str, rest: &str| format!("{{saia: {{axis: {axis}, {rest}}}}}");
    let init = "set: {veloc: 50000, accel: 500000, mcw: 41BH, mcfac: 1.0}, commands: [axinit]";
    let (x, line) = (verb("x", init), verb("line", init));
    let go = "set: {destp: 10000}, commands: [fstart, fldda]";
    let (go_x, go_line) = (verb("x", go), verb("line", go));
    passes(&format!(
        "scenario: s\ncycles: 600\nsteps:\n- {{at: 5, do: [{x}, {line}]}}\n\
         - {{at: 20, do: {{saia: {{axis: x, commands: [fldda, fstart]}}}}}}\n- {{at: 100, do: [{go_x}, {go_line}]}}\n\
         - {{at: 50, refused: saia.poser is 40000, do: {{saia: {{axis: x, set: {{poser: 40000}}, commands: [fsetpe]}}}}}}\n\
         - {{at: 60, refused: a whole number, do: {{saia: {{axis: x, set: {{poser: 4e12}}}}}}}}\n\
         expect:\n- {{signal: x.saia.state, at: 99, is: HOLD}}\n\
         - {{signal: x.command.position, minus: line.command.position, from: 100, to: end, is: 0}}\n\
         - {{signal: x.command.position, at: end, is: 10000}}\n- {{signal: x.saia.ondest, at: end, is: 1}}\n"
    ));
}

#[test]
fn saia_verb_reports_unknown_names_and_lists_known_ones() {
    let known = "there are kprop, kint, kder, intl, sampi, mcfac, poser, destp, brkp, veloc, accel, stafrr, mcw";
    assert_eq!(bad("{saia: {axis: x, set: {^destq: 1}}}"), format!("no register is called `destq`; {known}"));
    let said = bad("{saia: {axis: x, commands: [fldda, ^fstrat]}}");
    assert!(said.starts_with("no command is called `fstrat`; there are axinit, fselom, fsetpe, flddr"), "{said}");
    assert_eq!(bad("{saia: {axis: ^z}}"), "no axis is called `z`; there are line, x, turret");
    assert_eq!(
        bad("{saia: {axis: x, set: {destp: ^1.5}}}"),
        "destp is `1.5`; a whole number -2147483648..2147483647 is expected"
    );
    assert_eq!(bad("{saia: {axis: x, set: {mcfac: ^-1}}}"), "mcfac is `-1`; a number 0..9.223371e18 is expected");
    for bad_number in [".nan", "1e400", "-.inf"] {
        let said = bad(&format!("{{saia: {{axis: x, set: {{mcfac: ^{bad_number}}}}}}}"));
        assert!(said.starts_with("mcfac") && said.contains(bad_number), "{said}");
    }
    assert_eq!(bad("{saia: {axis: x, commands: [fldda, ^fldda]}}"), "fldda stands twice; a flag is set once");
    assert_eq!(bad("{saia: {axis: x, commands: ^fldda}}"), "commands is `fldda`; a list is expected");
    assert_eq!(bad("{saia: {axis: x, ^command: [fldda]}}"), "unknown key `command` in saia, did you mean `commands`?");
}

#[test]
fn setpoints_move_an_axis_while_streamed_or_for_their_duration() {
    // 20 mm/s after 40 ms at 500 mm/s^2. The axis stops 100 ms after the last setpoint, that of cycle 250.
    passes(&enabled(
        "every: 50, count: 5, do: {setpoints: {axes: {x: 20 mm/s, turret: {velocity: 10 deg/s, duration: 60 ms}}}}}\nexpect:\n\
         - {signal: x.reference, since: go, at: 0, is: STREAM}\n\
         - {signal: x.command.velocity, since: go, from: 40, to: 300, is: 20 mm/s}\n\
         - {signal: x.command.velocity, since: go, at: 302, not: 20 mm/s}\n\
         - {signal: x.state, since: go, at: 400, is: STANDSTILL}\n\
         - {signal: turret.command.velocity, since: go, from: 60, to: 260, is: 10 deg/s}\n\
         - {signal: turret.state, since: go, at: 330, is: STANDSTILL}\n",
    ));
    let bad = |arguments: &str| problems(&enabled(&format!("do: {{setpoints: {arguments}}}}}")));
    for (arguments, sentence) in [
        ("{axes: {w: 1 mm/s}}", "no axis is called `w`; there are line, x, turret"),
        ("{axes: {}}", "no axis is named; one or more, each with a velocity, are expected"),
        ("{axes: {x: 1 mm}}", "velocity of x"),
        ("{axes: {x: 1 mm/s}, duration: 1}", "duration"),
        ("{}", "axes"),
    ] {
        assert!(bad(arguments).contains(sentence), "{}", bad(arguments));
    }
}

/// An output that is set appears one cycle later at the input that reads it, where it acts as a limit switch.
///
/// Proves: MACS-LIM-07
#[test]
fn an_input_that_reads_an_output_follows_set_output_and_nothing_else() {
    let text = CELL.replace("  level:", "  stop: {type: di, output: lamp}\n  level:");
    let text = text.replace("max_following_error: 10 mm", "endswmod: 1, i_poslimitsw: 3, max_following_error: 10 mm");
    let cell = Cell::parse("cell.yaml", text).unwrap_or_else(|problems| panic!("{problems}"));
    let scenario = "scenario: s\ncycles: 1000\nsteps:\n- {at: 0, do: {enable: {axes: [x]}}}\n\
                    - {at: 100, do: {move_axis: {axis: x, mode: velocity, velocity: 10 mm/s}}}\n\
                    - {at: 500, do: {set_output: {lamp: 1}}}\nexpect:\n\
                    - {signal: lamp, at: 500, is: 1}\n- {signal: stop, at: 500, is: 0}\n- {signal: stop, at: 501, is: 1}\n\
                    - {signal: x.state, at: 500, is: CONTINUOUS_MOTION}\n- {signal: x.error, at: 501, is: 10221}\n";
    let scenario = Scenario::parse("s.yaml", scenario, &cell).unwrap_or_else(|problems| panic!("{problems}"));
    let report = simulate(&cell, &scenario, &Options::default()).unwrap();
    assert!(report.passed(), "{report}");
    for (section, item, sentence) in [
        (
            "steps",
            "{at: 0, do: {inject: {input: {stop: 1}}}}",
            "stop reads an output of the machine; an input with a terminal is allowed, set that output",
        ),
        ("drive", "{signal: stop, values: [1]}", "stop reads an output of the machine and cannot be driven; inputs,"),
    ] {
        let text = format!("{{scenario: s, cycles: 9, {section}: [{item}]}}");
        let problems = Scenario::parse("s.yaml", &text, &cell).expect_err("it cannot be set").to_string();
        assert!(problems.contains(sentence), "{problems}");
    }
}

/// A refused field has its own number, which is also the number of some parameter of an axis.
#[test]
fn refusal_of_a_function_has_no_axis_parameter() {
    let cell = format!("{CELL}functions:\n  choose: {{slot: 0, type: ecopy, sink: feed}}\n");
    let cell = Cell::parse("cell.yaml", cell).unwrap_or_else(|problems| panic!("{problems}"));
    let passes = |refused: &str| {
        let start = "command_function: {function: choose, command: start, parameters: {mode: 9}}";
        let text = format!("scenario: s\ncycles: 5\nsteps: [{{at: 1, do: {{{start}}}, refused: {refused}}}]");
        let scenario = Scenario::parse("s.yaml", &text, &cell).unwrap_or_else(|problems| panic!("{problems}"));
        simulate(&cell, &scenario, &Options::default()).unwrap().passed()
    };
    assert!(passes("mode is 9") && passes("FUNCTION_RANGE"));
    // `mode` is field 0 of ecopy.
    assert!(!passes(lineshaft_core::parameter::ROWS[0].key));
}

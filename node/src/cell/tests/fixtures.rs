//! Tests the fixtures along a simulated axis.

use super::*;
use lineshaft_core::drive::{Backend as _, inputs};
use lineshaft_core::sim::{Fixtures, Index, Mechanics, SwitchWiring};

const IO: &str = "io:\n  lamp: {type: do, backend: p, address: 0}\n  a: {type: di, backend: p, address: 0}\n  b: {type: di, backend: p, address: 1}\n";

fn cell(sim: &str) -> String {
    format!(
        "lineshaft: 1\ncycle: 1 ms\nbackends:\n  p: {{type: sim}}\n{IO}axes:\n  x:\n    type: linear\n    \
         scale: {{increments: 1000, per: 1 mm}}\n    drive: {{backend: p, address: 0}}\n    max_velocity: 1 m/s\n    \
         max_acceleration: 1 m/s^2\n    sim: {sim}\n"
    )
}

#[test]
fn switches_and_their_wires() {
    let sim = "{model: ideal, start: -2.5 mm, index: {every: 4 mm, at: 1 mm}, home_switch: {from: 10 mm, to: 12 mm, input: b}, \
               positive_limit_switch: {at: 100 mm, input: a, normally_closed: true}, negative_limit_switch: {at: -5000 inc}}";
    let read = Cell::parse("c.yaml", cell(sim)).unwrap();
    let expected = Mechanics {
        fixtures: Fixtures {
            start: -2500,
            index: Some(Index { every: 4000, at: 1000 }),
            home: Some((10_000, 12_000)),
            negative: Some(-5000),
            positive: Some(100_000),
        },
        wires: [
            Some(SwitchWiring { switch: inputs::HOME, input: 1, normally_closed: false }),
            None,
            Some(SwitchWiring { switch: inputs::POSITIVE_LIMIT, input: 0, normally_closed: true }),
        ],
        ..Mechanics::default()
    };
    assert_eq!(read.mechanics, [expected]);
}

/// A switch acts at the input to which it is wired, and only there.
#[test]
fn a_wired_switch_reads_at_its_input() {
    for (start, a, b, drive) in [
        ("0 mm", true, false, 0),
        ("11 mm", true, true, 0),
        ("100 mm", false, false, 0),
        ("-5 mm", true, false, inputs::NEGATIVE_LIMIT),
    ] {
        let sim = format!(
            "{{model: ideal, start: {start}, home_switch: {{from: 10 mm, to: 12 mm, input: b}}, positive_limit_switch: \
             {{at: 100 mm, input: a, normally_closed: true}}, negative_limit_switch: {{at: -5 mm}}}}"
        );
        let read = Cell::parse("c.yaml", cell(&sim)).unwrap();
        let mut plant = read.plant();
        let mut inputs = lineshaft_core::machine::Machine::new(read.machine.clone()).unwrap().inputs();
        inputs.begin(0, 0);
        plant.read(&mut inputs);
        assert_eq!((inputs.digital(0), inputs.digital(1), inputs.drive[0].inputs), (a, b, drive), "{start}");
        // Set by hand: the switch has no effect any more.
        plant.set_digital(0, !a);
        inputs.begin(0, 0);
        plant.read(&mut inputs);
        assert_eq!(inputs.digital(0), !a, "{start}");
    }
}

#[test]
fn what_cannot_stand_along_a_way() {
    for (sim, expected) in [
        ("{model: ideal, start: 3 deg}", "16:32: start: `3 deg` is an angle; a length such as `3 m` is expected"),
        ("{model: ideal, index: {every: 0 mm}}", "16:40: every is `0 mm`; a value above 0 is allowed"),
        ("{model: ideal, index: {at: 0 mm}}", "16:32: missing key `every` in index"),
        (
            "{model: ideal, home_switch: {from: 2 mm, to: 1 mm}}",
            "16:55: to is `1 mm`; from, `2 mm`, and above is allowed",
        ),
        (
            "{model: ideal, home_switch: {from: 1 mm, to: 2 mm, input: lamp}}",
            "16:68: input is `lamp`, which is no di; a di is allowed",
        ),
        (
            "{model: ideal, positive_limit_switch: {at: 1 mm, normally_closed: true}}",
            "16:76: normally_closed is for a switch with an input; the drive shows in 60FDh that one is actuated, leave it out",
        ),
        (
            "{model: ideal, positive_limit_switch: {at: 1 mm, input: a}, negative_limit_switch: {at: 0 mm, input: a}}",
            "16:66: input `a` is taken already, at 16:111",
        ),
    ] {
        let problems = Cell::parse("c.yaml", cell(sim)).unwrap_err().to_string();
        assert_eq!(problems.trim_end().replace("c.yaml:", ""), expected, "{sim}");
    }
}

/// Returns the axis of [`cell`] with other keys instead of `sim`, and a section `machine`.
fn with(keys: &str, machine: &str) -> String {
    cell("{model: ideal}").replace("    sim: {model: ideal}\n", &format!("{keys}machine: {machine}\n"))
}

#[test]
fn a_brake_and_what_hangs_on_it() {
    use lineshaft_core::axis::BrakeConfig;
    use lineshaft_core::sim::{SignOutputs, SimBrake};
    let sim = "    sim: {model: ideal, hanging_load: -9.81 m/s^2, brake_opens: 50 ms, brake_closes: 40 ms}\n";
    let brake = "    brake: {output: lamp, release_delay: 60 ms, engage_delay: 50 ms, inverted: true}\n";
    let read = good(&with(&format!("{brake}{sim}"), "{}"));
    let expected = BrakeConfig { output: 0, closes_with_one: true, release_ns: 60_000_000, engage_ns: 50_000_000 };
    assert_eq!(read.machine.axes[0].brake, Some(expected));
    let hangs = SimBrake { output: 0, closes_with_one: true, opens_ns: 50_000_000, closes_ns: 40_000_000 };
    assert_eq!((read.mechanics[0].brake, read.mechanics[0].load), (Some(hangs), -9_810_000.0));
    // Without its own brake: that of O_BRAKE, by its number.
    let read = good(&with(&format!("    o_brake: -1\n{sim}"), "{}"));
    assert_eq!(read.mechanics[0].brake, Some(SimBrake { closes_with_one: false, ..hangs }));
    let bare = "    sim: {model: ideal, hanging_load: -9.81 m/s^2}\n";
    assert_eq!(good(&with(bare, "{}")).mechanics[0].brake, None);
    let sentence =
        |key| format!("{key} is for an axis with a brake; this one has neither brake nor o_brake, leave it out");
    let [opens, closes] = ["brake_opens", "brake_closes"].map(sentence);
    assert_eq!(said(&with(sim, "{}")), format!("16:65: {opens}\n16:86: {closes}"));
    // The outputs select the direction of a drive without a signed reference.
    let velocity =
        with("    revers: 10\n", "{}").replace("address: 0}\n    max", "address: 0, interface: velocity}\n    max");
    assert_eq!(good(&velocity).mechanics[0].sign, Some(SignOutputs::Direction(0)));
    for (keys, expected) in [
        ("    brake: {}\n", "16:12: missing key `output` in brake"),
        ("    brake: {output: a}\n", "16:21: output is `a`, which is a di; a do is allowed"),
        ("    brake: {output: lamp, release_delay: 11 s}\n", "16:42: release_delay is `11 s`; 0 s to 10 s is allowed"),
        (
            "    sim: {model: ideal, hanging_load: 1 m/s}\n",
            "16:39: hanging_load: `1 m/s` is a velocity; an acceleration",
        ),
        ("    o_axmove: 2\n", "16:15: o_axmove is 2; the cell has 1 digital output"),
        ("    i_refswitch: -3\n", "16:18: i_refswitch is -3; the cell has 2 digital inputs"),
        ("    revers: 10\n", "16:13: revers 10 asks for outputs, which tell the sign of a velocity"),
    ] {
        let problems = said(&with(keys, "{}"));
        assert!(problems.starts_with(expected), "{problems}");
    }
    let virtual_axis =
        with("    brake: {output: lamp}\n", "{}").replace("{backend: p, address: 0}\n    max", "virtual\n    max");
    assert_eq!(said(&virtual_axis), "16:12: brake is for axes with a drive; this one is virtual, leave it out");
}

#[test]
fn the_machine_has_a_section_of_its_own() {
    let read = good(&with("", "{i_errclr: 1, i_break: -2, o_error: -1, ainftime: 5}"));
    let parameters = read.machine.global.parameters;
    assert_eq!((parameters.i_errclr, parameters.i_break, parameters.i_continue), (1, -2, 0));
    assert_eq!((parameters.o_error, parameters.ainftime), (-1, 5));
    let read = good(&with("", "{vmenctyp: 100100, vmencres: 7, vmencmtyp: 22, pulsacc: 500}"));
    let parameters = read.machine.global.parameters;
    assert_eq!((parameters.virtual_source(), parameters.vmencres, parameters.pulsacc), (Some(0), 7, 500));
    for (machine, expected) in [
        ("{i_errclr: 9}", "16:21: i_errclr is `9`; -8 to 8 is allowed"),
        ("{i_errclr: 3}", "16:21: i_errclr is 3; the cell has 2 digital inputs"),
        ("{o_error: 2}", "16:20: o_error is 2; the cell has 1 digital output"),
        ("{ainftime: 1.5}", "16:21: ainftime is `1.5`; "),
        ("{prgpar: 3}", "16:19: prgpar"),
        ("{vmencmtyp: 32}", "16:22: vmencmtyp needs input 3; the cell has 2 digital inputs"),
        (
            "{vmenctyp: 1200}",
            "16:21: vmenctyp 1200 is not allowed; 100 n is, and 100000 more, with n 0 for pulsvel, 1 to ",
        ),
        ("{vmenctyp: 5}", "16:21: vmenctyp 5 has an encoder of type 5 in the place of the virtual master"),
        ("{pulsvel: 100}", "16:20: pulsvel is 100; 0 is allowed at the start, as no machine begins with a virtual "),
        ("{setsys_15: 1}", "16:22: setsys_15 is 1; 0 is allowed at the start"),
        ("{o_eror: 1}", "16:11: unknown key `o_eror` in machine, did you mean `o_error`?"),
    ] {
        let problems = said(&with("", machine));
        assert!(problems.starts_with(expected), "{problems}");
    }
}

/// An output of a brake has no second function of another axis, and none of the same axis.
#[test]
fn an_output_has_one_function() {
    for (keys, machine, expected) in [
        (
            "    brake: {output: lamp}\n",
            "{o_error: 1}",
            "o_error names output 1, `lamp`, which has another function, at 16:",
        ),
        (
            "    brake: {output: lamp}\n    o_brake: 1\n",
            "{}",
            "o_brake names output 1, `lamp`, which has another function, at 16:",
        ),
        ("    o_axmove: -1\n", "{o_error: -1}", "o_axmove names output 1, `lamp`, which has another function, at 17:"),
        (
            "    o_axmove: 1\n    o_brake: 1\n",
            "{}",
            "o_axmove names output 1, `lamp`, which has another function, at 17:",
        ),
    ] {
        let problems = said(&with(keys, machine));
        assert_eq!(problems.matches("another function").count(), 1, "{problems}");
        assert!(problems.contains(expected), "{problems}");
    }
    good(&with("    o_axmove: 1\n", "{}"));
}

/// A simulated switch has a wire, and an input that reads an output has no terminal for it.
#[test]
fn no_switch_is_wired_to_an_input_that_reads_an_output() {
    let io = cell("{model: ideal, home_switch: {from: 0 mm, to: 1 mm, input: b}}").replace(
        "  b: {type: di, backend: p, address: 1}\n",
        "  b: {type: di, output: q}\n  q: {type: do, backend: p, address: 9}\n",
    );
    let sentence = "input is `b`, which reads an output of the machine; a di with a backend and an address is allowed";
    assert!(said(&io).ends_with(sentence), "{}", said(&io));
}

#[test]
fn digital_inputs_may_be_filtered() {
    use lineshaft_core::config::FilterConfig;
    let io = |io: &str| cell("{model: ideal}").replace("  b: {type: di, backend: p, address: 1}\n", io);
    let read = good(&io("  b: {type: di, backend: p, address: 1, filter: 2.5 ms}\n"));
    assert_eq!(read.machine.global.filters, [FilterConfig { input: 1, time_ns: 2_500_000 }]);
    let problems = said(&io("  b: {type: do, backend: p, address: 1, filter: 2 ms}\n"));
    assert_eq!(problems, "8:49: filter is for type di; this one is do, leave it out");
}

//! Tests the error messages of texts that are refused, and texts of actions that no interface creates.

use super::*;

#[test]
fn what_is_wrong_is_one_sentence() {
    let desk = Desk::new();
    for (json, sentence) in [
        ("", "the command has 0 verbs; one is expected"),
        ("{}", "the command has 0 verbs; one is expected"),
        ("[]", "the command is a list; a mapping is expected"),
        ("\"halt\"", "the command is `halt`; a mapping is expected"),
        ("{\"halt\":", "this is not YAML: "),
        (r#"{"jump":{}}"#, "there is no verb `jump`, known are enable, "),
        (r#"{"home_axis":{"id":"17"}}"#, "missing key `axis` in home_axis"),
        (r#"{"home_axis":{"id":"h","axis":"x"}}"#, "id is `h`; the sequence number of a command is expected"),
        (r#"{"home_axis":{"id":"17","axis":"x","scheme":3}}"#, "scheme is 3; 0 CONFIGURED, 1 CIA402, 2 MACS are"),
        (r#"{"home_axis":{"id":"17","axis":"x","method":128}}"#, "method is 128; -128..127 is allowed"),
        (r#"{"set_position":{"axis":"q"}}"#, "no axis is called `q`"),
        (r#"{"set_position":{"axis":"x","position":"1 s"}}"#, "position: `1 s` is a time"),
        (r#"{"load_table":{}}"#, "missing key `points` in load_table"),
        (r#"{"halt":{"axes":["?"]}}"#, "no axis is called `?`; there are x, turret, odd, fine, coarse"),
        (r#"{"halt":{"axes":[]},"enable":{}}"#, "the command has 2 verbs; one is expected"),
        (r#"{"move_axis":{"id":"17","axis":"q"}}"#, "no axis is called `q`"),
        (r#"{"probe_axis":{"id":"17","axis":"x"}}"#, "missing key `event` in probe_axis"),
        (r#"{"probe_axis":{"id":"17","axis":"x","event":"start"}}"#, "`start` does not latch; mark, belt can"),
        (r#"{"probe_axis":{"id":"17","axis":"x","event":"mark","mode":4}}"#, "mode is 4; 0 ABSOLUTE, 1 RELATIVE are"),
        (r#"{"probe_axis":{"id":"17","axis":"x","event":"mark","edge":4}}"#, "edge is 4; 0 RISING, 1 FALLING, 2 BOTH"),
        (r#"{"probe_axis":{"id":"17","axis":"x","event":"mark","distance":"1 s"}}"#, "distance: `1 s` is a time"),
        (r#"{"touch_probe":{"axis":"x"}}"#, "missing key `event` in touch_probe"),
        (r#"{"touch_probe":{"axis":"x","event":"start"}}"#, "`start` does not latch; mark, belt can"),
        (r#"{"touch_probe":{"axis":"x","event":"mark","first_position":"1 s"}}"#, "first_position: `1 s` is a time"),
        (r#"{"abort_trigger":{"axis":"x","event":"start"}}"#, "`start` does not latch; mark, belt can"),
        (r#"{"set_position":{"axis":"belt","relative":true}}"#, "no axis is called `belt`"),
        (r#"{"move_axis":{"id":"m","axis":"x"}}"#, "id is `m`; the sequence number of a command is expected"),
        (r#"{"cancel":{"id":"-1"}}"#, "id is `-1`; the sequence number of a command is expected"),
        (r#"{"cancel":{"id":"18446744073709551616"}}"#, "id is `18446744073709551616`; the sequence number"),
        (r#"{"cancel":{}}"#, "missing key `id` in cancel"),
        (r#"{"set_memory":{}}"#, "set_memory is empty; `cell: value` is expected"),
        (r#"{"set_memory":{"gain":null}}"#, "gain has no value; a number is expected"),
        (
            r#"{"set_memory":{"big":9007199254740993}}"#,
            "big is 9007199254740993; beyond +-2^53 only what an f64 holds can be set, the nearest is 9007199254740992",
        ),
        // The nearest f64 is 2^63, which exceeds the memory cell.
        (
            r#"{"set_memory":{"big":9223372036854775807}}"#,
            "big is 9223372036854775807; beyond +-2^53 only what an f64 holds can be set",
        ),
        (r#"{"set_memory":{"big":9223372036854775808}}"#, "big is 9223372036854775808; -9223372036854775808..92"),
        (r#"{"set_memory":{"feed":40000}}"#, "feed is 40000; -32768..32767 is allowed"),
        (
            r#"{"set_parameters":{"x.max_velocity":null}}"#,
            "x.max_velocity is `null`; a velocity such as 0.5 m/s is expected",
        ),
        (r#"{"set_parameters":{"x.profile":null}}"#, "x.profile is `null`; one of trapezoid, s_ramp, jerk is expected"),
        (r#"{"set_parameters":{"x.?":"1 inc/s"}}"#, "no parameter is called `x.?`"),
        (r#"{"inject":{"input":{"feed":1}}}"#, "feed is no input"),
        (r#"{"inject":{"drive_lost":{"axis":"x"}}}"#, "x is virtual: it has no drive"),
        (r#"{"refuse":{}}"#, "missing key `text` in refuse"),
        (r#"{"refuse":{"text":["a"]}}"#, "text is a list; a text is expected"),
        (r#"{"note":{"code":10001,"number":1}}"#, "code is 10001; notes are 10216, 10217, 10218, 10370, 10371, 10372"),
        (r#"{"note":{"code":10216}}"#, "missing key `number` in note"),
        (r#"{"note":{"code":-1,"number":1.5}}"#, "code is -1; 0..4294967295 is allowed"),
    ] {
        let told = desk.read(json).expect_err(json);
        assert!(told.starts_with(sentence), "{json}: {told}");
        assert!(!told.contains('\n'), "{json}: {told}");
    }
    let deep = "[".repeat(100_000);
    assert_eq!(desk.read(&deep).unwrap_err(), "lists and mappings are nested deeper than 64 levels");
    let wide = format!("{{\"halt\":{{\"axes\":[{}\"x\"]}}}}", "\"x\",".repeat(4_100_000));
    assert_eq!(desk.read(&wide).unwrap_err(), "the file has more than 4000000 values");
}

#[test]
fn an_injection_is_no_command() {
    let cell = CELL.replace(
        "drive: virtual, max_velocity: 1 m/s",
        "drive: {backend: plant, address: 0, interface: position}, max_velocity: 1 m/s",
    );
    let cell = Cell::parse("cell.yaml", cell).unwrap();
    let machine = Machine::new(cell.machine.clone()).unwrap();
    let told = from_json(r#"{"inject":{"drive_lost":{"axis":"x"}}}"#, &cell.machine, machine.directory());
    assert_eq!(told.unwrap_err(), "inject is no command of the machine");
}

#[test]
fn what_no_door_makes_is_written_so_that_it_does_not_read_back() {
    let desk = Desk::new();
    for action in [
        Action::Halt(AxisSet::EMPTY),
        Action::Halt(AxisSet::one(400)),
        Action::Move(to(9, Length::default())),
        Action::Probe(search(Object::Machine)),
        Action::Probe(search(Object::Memory(0))),
        Action::Probe(search(Object::Io(1))),
        Action::Probe(search(Object::Io(99))),
        Action::Probe(search(Object::Axis(0))),
        Action::AbortTrigger(AbortTrigger { axis: 0, source: Some(Object::Machine) }),
        Action::set_memory(99, 1.0),
        Action::set_memory(2, f64::NAN),
        Action::set_memory(2, f64::INFINITY),
        Action::set_memory(0, 0.5),
        Action::set_memory(0, 32_768.0),
        Action::set_memory(1, 9_223_372_036_854_775_808.0),
        Action::set_memory(3, 2.0),
        Action::SetMemory([].into()),
        Action::SetMemory([MemoryValue { index: 2, value: 1.0 }; 2].into()),
        Action::SetOutputs([].into()),
        Action::SetOutputs([OutputValue { index: 2, value: 1.0 }; 2].into()),
        Action::set_output(99, 1.0),
        Action::set_output(0, 1.0),
        Action::set_output(2, 0.5),
        Action::set_output(3, f64::NAN),
        Action::SetParameters([Change { axis: 0, row: 999, value: Set::Int(1) }].into()),
        Action::SetParameters([Change { axis: 9, row: 0, value: Set::Int(1) }].into()),
        Action::SetParameters([set(0, "max_velocity", Set::Real(f64::NAN))].into()),
        Action::Note { code: Code::NONE, number: 1 },
    ] {
        let json = desk.write(&action);
        assert!(desk.read(&json).is_err(), "{json}");
    }
}

//! Tests each problem of the sections other than axes.

use super::{HEAD, RosOptions, assert_said, good, said, said_of};
use crate::cell::{OnLoss, RecordTopics};
use lineshaft_core::config::{IoKind, MemoryKind};
use lineshaft_core::encoder::Form;
use lineshaft_core::trajectory::{OnExcess, TrajectoryLimits};
use lineshaft_ros::surface::{Group, TrajectorySettings};
use std::time::Duration;

#[test]
fn contacts_are_digital_inputs_by_their_place_among_them() {
    let cell = |safety: &str| {
        format!(
            "lineshaft: 1\ncycle: 1 ms\nbackends: {{plant: {{type: sim}}}}\nio:\n  level: {{type: ai, backend: plant, address: 0}}\n  \
             start: {{type: di, backend: plant, address: 0}}\n  stop: {{type: di, backend: plant, address: 1}}\nsafety: {safety}\n"
        )
    };
    let read = |safety: &str| {
        crate::cell::Cell::parse("c", cell(safety))
            .map(|cell| cell.machine.safety)
            .map_err(|problems| problems.to_string())
    };
    let safety = read("{estop: stop, interlock: start}").unwrap();
    assert_eq!((safety.estop, safety.interlock), (Some(1), Some(0)));
    assert_eq!(read("{interlock: stop}").unwrap().estop, None);
    for (text, sentence) in [
        (
            "{estop: level}",
            "c:8:17: estop is `level`, which is no di; a di is allowed, which reads 1 while all is well\n",
        ),
        ("{estop: stopp}", "c:8:17: estop is `stopp`; no input or output has that name, did you mean `stop`?\n"),
        ("{}", "c:8:9: safety names no input; estop, interlock or both are expected\n"),
        ("{estop: stop, guard: stop}", "c:8:23: unknown key `guard` in safety, known are estop, interlock\n"),
    ] {
        let error = read(text).unwrap_err();
        assert!(error.starts_with(sentence), "{text}: {error}");
    }
}

#[test]
fn scenario_instead_of_a_cell_is_reported_in_one_sentence() {
    let sentence =
        "this looks like a scenario; a cell is expected, check it with `lineshaft check CELL --scenario FILE`";
    assert_eq!(said("# first\nscenario: s\nfor: 1 s\nexpect: []\n"), format!("2:1: {sentence}"));
    assert_eq!(said("steps: []\n"), format!("1:1: {sentence}"));
    // A cell with a key of a scenario is still a cell.
    assert!(said("lineshaft: 1\nscenario: s\n").contains("unknown key `scenario` in the cell"));
}

#[test]
fn format_and_cycle() {
    for (format, cycle, sentence) in [
        ("^0", "1 ms", "lineshaft is `0`; format version 1 is allowed"),
        ("^one", "1 ms", "lineshaft is `one`; format version 1 is allowed"),
        ("1", "^124999 ns", "cycle is `124999 ns`; 125 us..20 ms is allowed"),
        ("1", "^1", "cycle is `1`; 125 us..20 ms is allowed, a number without a unit is in s"),
        ("1", "^-1 ms", "cycle is `-1 ms`; 125 us..20 ms is allowed"),
        ("1", "^1 mm", "cycle: `1 mm` is a length; a time such as `1 s` is expected"),
        (
            "1",
            "^0.5000001 ms",
            "cycle: `0.5000001 ms` is not a whole number of nanoseconds; times are whole nanoseconds up to 292 years",
        ),
    ] {
        assert_said(&format!("lineshaft: {format}\ncycle: {cycle}\n"), sentence);
    }
    assert_said("lineshaft^:\ncycle: 1 ms\n", "lineshaft has no value; a text is expected");
    assert_said("lineshaft: 1\ncycle: 1 ms\n^axis: {}", "unknown key `axis` in the cell, did you mean `axes`?");
    for cycle in ["125 us", "20 ms", "0.001", "333333 ns"] {
        good(&format!("lineshaft: 1\ncycle: {cycle}\n"));
    }
}

#[test]
fn ros_options() {
    let text = "ros: {name: Press_2, namespace: /cell_1/left, joint_states_rate: 1, axis_states_rate: 1 kHz,\n  \
                shaft_rate: 50 Hz, autostart: false, robot_description: a/r.urdf, interfaces: [lo, 192.168.0.1],\n  \
                controller_manager: /cell_1/left/Press_2/controller_manager,\n  \
                on_loss: none, loss_timeout: 1500 ms, request_timeout: 500 ms,\n  \
                record_topics: [~/errors, /rosout]}\n";
    assert_eq!(
        good(&format!("{HEAD}{text}")).ros,
        RosOptions {
            name: "Press_2".into(),
            namespace: "/cell_1/left".into(),
            joint_states_rate: 1.0,
            axis_states_rate: 1000.0,
            shaft_rate: Some(50.0),
            autostart: false,
            robot_description: Some("a/r.urdf".into()),
            controller_manager: Some("/cell_1/left/Press_2/controller_manager".into()),
            interfaces: vec!["lo".into(), "192.168.0.1".into()],
            on_loss: OnLoss::None,
            loss_timeout: Duration::from_millis(1500),
            request_timeout: Duration::from_millis(500),
            record_topics: RecordTopics::Only(vec!["~/errors".into(), "/rosout".into()]),
        }
    );
    assert_eq!(good(&format!("{HEAD}ros:\n")).ros, RosOptions::default());
    assert_eq!(RosOptions::default().shaft_rate, Some(100.0));
    for (given, topics) in [("all", RecordTopics::All), ("none", RecordTopics::Only(Vec::new()))] {
        assert_eq!(good(&format!("{HEAD}ros: {{record_topics: {given}}}\n")).ros.record_topics, topics, "{given}");
    }
    for (topic, sentence) in [
        ("/tf", "is `/tf`; one of ~/shaft, ~/functions, ~/errors, "),
        ("/clock", "is `/clock`; one of ~/shaft, "),
        ("~/events", "is `~/events`, which is always recorded; one of ~/shaft, "),
        ("joint_states", "is `joint_states`, which is always recorded; one of ~/shaft, "),
        ("~/inputs", "is `~/inputs`, which is always recorded; one of ~/shaft, "),
    ] {
        let said = said(&format!("{HEAD}ros: {{record_topics: [/rosout, {topic}]}}\n"));
        assert!(said.contains(sentence), "{said}");
    }
    assert_eq!(RosOptions::default().controller_manager, None);
    for off in ["0", "0 Hz", "0.0"] {
        assert_eq!(good(&format!("{HEAD}ros: {{shaft_rate: {off}}}\n")).ros.shaft_rate, None, "{off}");
    }
    let manager = "an absolute name of at most 222 characters, such as /controller_manager or \
                   /lineshaft/controller_manager, is allowed";
    let long = format!("/{}", "n".repeat(222));
    let namespace = "/ or names that each follow a /, such as /cell_1/press, is allowed";
    for (text, sentence) in [
        ("name: ^2nd", "name is `2nd`; a letter or _, then letters, digits and _, is allowed"),
        ("namespace: ^cell_1/", &format!("namespace is `cell_1/`; {namespace}, write `/cell_1`")),
        ("namespace: ^//a", &format!("namespace is `//a`; {namespace}, write `/a`")),
        ("namespace: ^/a-b", &format!("namespace is `/a-b`; {namespace}")),
        ("axis_states_rate: ^1001 Hz", "axis_states_rate is `1001 Hz`; 1 Hz..1000 Hz is allowed"),
        ("axis_states_rate: ^10 ms", "axis_states_rate: `10 ms` is a time; a frequency such as `10 Hz` is expected"),
        ("shaft_rate: ^0.5", "shaft_rate is `0.5`; 0, or 1 Hz..1000 Hz, is allowed"),
        ("shaft_rate: ^-1 Hz", "shaft_rate is `-1 Hz`; 0, or 1 Hz..1000 Hz, is allowed"),
        ("shaft_rate: ^1001", "shaft_rate is `1001`; 0, or 1 Hz..1000 Hz, is allowed"),
        ("on_loss: ^stop", "on_loss is `stop`; halt or none is allowed"),
        ("loss_timeout: ^0.4 s", "loss_timeout is `0.4 s`; 0.5 s..5 s is allowed"),
        ("loss_timeout: ^6", "loss_timeout is `6`; 0.5 s..5 s is allowed, a number without a unit is in s"),
        ("request_timeout: ^99 ms", "request_timeout is `99 ms`; 0.1 s..3600 s is allowed"),
        (
            "request_timeout: ^3601",
            "request_timeout is `3601`; 0.1 s..3600 s is allowed, a number without a unit is in s",
        ),
        ("autostart: ^yes", "autostart is `yes`; true or false is allowed, write `true`"),
        ("robot_description: ^''", "robot_description is ``; the name of a URDF file is expected"),
        (
            "controller_manager: ^controller_manager",
            &format!("controller_manager is `controller_manager`; {manager}, write `/controller_manager`"),
        ),
        (
            "controller_manager: ^/ns/controller_manager/",
            &format!("controller_manager is `/ns/controller_manager/`; {manager}, write `/ns/controller_manager`"),
        ),
        ("controller_manager: ^~/cm", &format!("controller_manager is `~/cm`; {manager}")),
        ("controller_manager: ^/", &format!("controller_manager is `/`; {manager}")),
        ("controller_manager: ^''", &format!("controller_manager is ``; {manager}")),
        ("controller_manager: ^/a-b", &format!("controller_manager is `/a-b`; {manager}")),
        ("controller_manager: ^/2nd", &format!("controller_manager is `/2nd`; {manager}")),
        ("controller_manager: ^true", &format!("controller_manager is `true`; {manager}, write `/controller_manager`")),
        (&format!("controller_manager: ^{long}"), &format!("controller_manager is `{}..`; {manager}", &long[..60])),
        ("interfaces: [^'', lo]", "interfaces[0] is ``; a network interface such as eth0 or its address is allowed"),
        ("^domain: 3", "unknown key `domain` in ros"),
    ] {
        assert_said(&format!("{HEAD}ros: {{{text}}}"), sentence);
    }
}

#[test]
fn backends() {
    for (text, sentence) in [
        ("{type: ^simm}", "type is `simm`; one of sim, can is allowed, did you mean `sim`?"),
        ("^{}", "missing key `type` in backend `p`"),
        ("{type: sim, seed: ^-1}", "seed is -1; 0..18446744073709551615 is allowed"),
        ("{type: sim, delay: ^40}", "delay is 40; 0..32 is allowed"),
        ("{type: sim, ^bitrate: 5}", "unknown key `bitrate` in backend `p`, known are type, seed, delay"),
        ("^{type: can}", "missing key `transport` in backend `p`"),
        (
            "{type: can, transport: ^can0}",
            "transport: 'can0' is no CAN bus; allowed are slcan:/dev/ttyACM0, slcan-tcp:HOST:PORT, socketcan:can0, \
             udp:239.74.163.2:43113",
        ),
        ("{type: can, transport: 'socketcan:can0', bitrate: ^125}", "bitrate is 125; 10000..1000000 is allowed"),
    ] {
        assert_said(&format!("lineshaft: 1\ncycle: 1 ms\nbackends:\n  p: {text}\n"), sentence);
    }
    let backends = good(HEAD).backends;
    let real: Vec<_> = backends.iter().filter(|backend| !backend.is_simulated()).map(|backend| &backend.name).collect();
    assert_eq!(real, ["bus0"]);
}

#[test]
fn inputs_and_outputs() {
    for (text, sentence) in [
        ("{type: ^dx, backend: plant, address: 0}", "type is `dx`; one of di, do, ai, ao is allowed"),
        ("{type: di, backend: ^x, address: 1}", "backend is `x`; no backend has that name, there are plant, bus0"),
        ("{type: di, backend: ^a, address: 1}", "backend is `a`, which is an input or output; backend is allowed"),
        ("{type: di, backend: plant, address: ^0}", "di address 0 of backend `plant` is taken already, at 7:42"),
        ("^{type: di, backend: plant}", "missing key `address` in io `b`"),
        ("{type: di, backend: plant, address: ^65536}", "address is 65536; 0..65535 is allowed"),
        (
            "{type: do, backend: plant, address: 0, latch: ^true}",
            "latch is true for type do; only the edges of a di are latched",
        ),
        ("{type: di, backend: bus0, node: ^128, address: 0}", "node is 128; 1..127 is allowed"),
        ("{type: di, backend: bus0, node: 127, address: ^64}", "address is 64; 0..63 is allowed"),
        ("^{type: di, backend: bus0, address: 3}", "missing key `node` in io `b`"),
        (
            "{type: di, backend: bus0, node: 3, address: 0, latch: ^true}",
            "latch is true for an input on CAN, which reports no edges; the touch probes of a drive do",
        ),
        (
            "{type: ai, backend: plant, address: 0, full_scale: ^5 V}",
            "full_scale is for an ai or ao on CAN, leave it out",
        ),
        (
            "{type: ai, backend: bus0, node: 3, address: 0, full_scale: ^0 V}",
            "full_scale is `0 V`; a value above 0 is allowed",
        ),
        ("{type: do, backend: plant, address: 0, ^lach: true}", "unknown key `lach` in io `b`, did you mean `latch`?"),
    ] {
        assert_said(&format!("{HEAD}io:\n  a: {{type: di, backend: plant, address: 0}}\n  b: {text}\n"), sentence);
    }
    let no_backend = "lineshaft: 1\ncycle: 1 ms\nio: {a: {type: di, backend: ^plant, address: 0}}";
    assert_said(no_backend, "backend is `plant`; no backend has that name, there is none");
    let cell = good(&format!(
        "{HEAD}io:\n  a: {{type: di, backend: plant, address: 0, latch: true}}\n  b: {{type: do, backend: plant, address: 0}}\n  \
         c: {{type: di, backend: bus0, node: 9, address: 0}}\n"
    ));
    let read: Vec<_> = cell.machine.io.iter().map(|io| (io.name.as_str(), io.kind, io.latch)).collect();
    assert_eq!(
        read,
        [("a", IoKind::DigitalInput, true), ("b", IoKind::DigitalOutput, false), ("c", IoKind::DigitalInput, false)]
    );
}

/// Proves: MACS-LIM-07
#[test]
fn an_input_may_read_an_output_instead_of_a_terminal() {
    use lineshaft_core::config::{FilterConfig, VirtualInput};
    let io = |text: &str| {
        format!(
            "{HEAD}io:\n  a: {{type: di, backend: plant, address: 0}}\n  b: {text}\n  c: {{type: do, backend: plant, address: 0}}\n  \
             d: {{type: ao, backend: plant, address: 0}}\n"
        )
    };
    let cell = good(&io("{type: di, output: c, filter: 2 ms}"));
    assert_eq!(cell.machine.global.virtual_inputs, [VirtualInput { input: 1, output: 2 }]);
    assert_eq!(cell.machine.global.filters, [FilterConfig { input: 1, time_ns: 2_000_000 }]);
    let wired = "is for an input with a terminal; this one reads an output, leave it out";
    for (text, sentence) in [
        ("{type: di, output: ^a}", "output is `a`, which is a di; a do is allowed"),
        ("{type: di, output: ^b}", "output is `b`, which is a di; a do is allowed"),
        ("{type: di, output: ^d}", "output is `d`, which is an ao; a do is allowed"),
        ("{type: di, output: ^plant}", "output is `plant`, which is a backend; input or output is allowed"),
        ("{type: di, output: ^cc}", "output is `cc`; no input or output has that name, there are a, b, c, d"),
        ("{type: do, output: ^c}", "output is for type di; this one is do, leave it out"),
        ("{type: di, output: c, backend: ^plant}", &format!("backend {wired}")),
        ("{type: di, output: c, address: ^1}", &format!("address {wired}")),
        (
            "{type: di, output: c, latch: ^true}",
            "latch is true for an input that reads an output; only the edges at a terminal are latched",
        ),
    ] {
        assert_said(&io(text), sentence);
    }
    let contact = format!("{}safety: {{estop: ^b}}\n", io("{type: di, output: c}"));
    let sentence =
        "estop is `b`, which reads an output of the machine itself; a di with a backend and an address is allowed";
    assert_said(&contact, sentence);
}

#[test]
fn memory_holds_what_its_type_does() {
    for (text, sentence) in [
        ("{type: i16, initial: ^32768}", "initial is 32768; -32768..32767 is allowed"),
        ("{type: i32, initial: ^-2147483649}", "initial is -2147483649; -2147483648..2147483647 is allowed"),
        (
            "{type: i64, initial: ^9007199254740993}",
            "initial is 9007199254740993; -9007199254740992..9007199254740992 is allowed",
        ),
        ("{type: i16, initial: ^0.5}", "initial is `0.5`; a whole number -32768..32767 is allowed"),
        ("{type: f64, initial: ^nan}", "initial is `nan`; a finite number is expected"),
        ("{type: bit, initial: ^2}", "initial is 2; 0..1 is allowed"),
        ("{type: ^u8}", "type is `u8`; one of i16, i32, i64, f64, bit is allowed"),
        ("^{initial: 1}", "missing key `type` in memory `m`"),
    ] {
        assert_said(&format!("{HEAD}memory:\n  m: {text}\n"), sentence);
    }
    let memory = "{a: {type: f64, initial: 0.1}, b: {type: i16, initial: -32768}, c: {type: bit}}";
    let cell = good(&format!("{HEAD}memory: {memory}\n"));
    let read: Vec<_> = cell.machine.memory.iter().map(|memory| (memory.kind, memory.initial)).collect();
    assert_eq!(read, [(MemoryKind::F64, 0.1), (MemoryKind::I16, -32768.0), (MemoryKind::Bit, 0.0)]);
}

#[test]
fn encoders() {
    let scale = "scale: {increments: 4000, per: 100 mm}";
    let first = format!("{{backend: plant, address: 1, type: linear, {scale}}}");
    for (text, sentence) in [
        (
            &format!("{{backend: plant, address: 0, bits: ^65, type: linear, {scale}}}")[..],
            "bits is 65; 1..64 is allowed",
        ),
        (&format!("{{backend: plant, address: 0, bits: ^0, type: linear, {scale}}}"), "bits is 0; 1..64 is allowed"),
        (
            &format!("{{backend: plant, address: ^1, type: linear, {scale}}}"),
            "encoder address 1 of backend `plant` is taken already, at 7:32",
        ),
        (
            "{backend: plant, address: 0, type: rotary, scale: {increments: 4000, per: ^100 mm}}",
            "per: `100 mm` is a length; an angle such as `100 deg` is expected",
        ),
        ("^{backend: plant, address: 0, type: linear}", "missing key `scale` in encoder `e`"),
    ] {
        assert_said(&format!("{HEAD}encoders:\n  a: {first}\n  e: {text}\n"), sentence);
    }
    let cell = good(&format!("{HEAD}encoders: {{e: {first}}}\n"));
    assert_eq!(cell.machine.encoders[0].form, Form::Incremental(32));
}

#[test]
fn names_are_unique_in_a_cell() {
    assert_eq!(
        said_of(
            "memory:\n  x: {type: bit}\n  plant: {type: bit}\n  x: {type: i16}\n\
             io:\n  x: {type: di, backend: plant, address: 0}\n"
        ),
        "8:3: `plant` is a backend already, at 4:3; a name stands once\n\
         9:3: duplicate key `x`; it is first at 7:3\n\
         11:3: `x` is a memory cell already, at 7:3; a name stands once"
    );
    assert_eq!(
        said_of("memory:\n  ros: {type: bit}\n  a.b: {type: bit}\n"),
        "7:3: `ros` is taken; machine, end and ros name no object\n\
         8:3: `a.b` is no name; a letter a..z, then a..z, 0..9 and _, at most 32 characters, is allowed, write `a_b`"
    );
    // An invalid name causes one problem, also if it is referred to, and the message stays on one line.
    let cell = HEAD.replace("plant:", "\"Pla\\nnt\":");
    let io = "{type: di, backend: \"Pla\\nnt\", address: 0}";
    let rule = "a letter a..z, then a..z, 0..9 and _, at most 32 characters, is allowed";
    assert_eq!(
        said(&format!("{cell}io:\n  a: {io}\n  b: {io}\n")),
        format!(
            "4:3: `Pla\\nnt` is no name; {rule}\n8:46: di address 0 of backend `Pla\\nnt` is taken already, at 7:46"
        )
    );
    // The second one is the one further down, whatever the order in which sections are read.
    assert_said(
        &three_axes("groups: {g: [x]}\nmemory: {^g: {type: bit}}\n"),
        "`g` is a group already, at 10:10; a name stands once",
    );
}

/// Returns a cell with two axes with drives and a virtual one.
pub(super) fn three_axes(more: &str) -> String {
    let axis = |name: &str, drive: &str| {
        format!(
            "  {name}: {{type: linear, drive: {drive}, scale: {{increments: 1, per: 1 mm}}, max_velocity: 1, max_acceleration: 1}}\n"
        )
    };
    let drive = |address: u8| format!("{{backend: plant, address: {address}}}");
    format!("{HEAD}axes:\n{}{}{}{more}", axis("line", "virtual"), axis("x", &drive(0)), axis("turret", &drive(1)))
}

#[test]
fn groups() {
    let usual = TrajectorySettings::default();
    let limits = TrajectoryLimits { margin: 0.02, on_excess: OnExcess::Refuse, max_stretch: 3.0 };
    let all = TrajectorySettings { limits, angle_wraparound: true, max_duration: 30.0, state_rate: 20.0 };
    let group = |name: &str, axes: &[u16], trajectories| Group {
        name: name.to_owned(),
        axes: axes.to_vec(),
        trajectories,
        gripper: None,
    };
    let map = "a: {axes: [turret, x], angle_wraparound: true, max_duration: 30 s, controller_state_rate: 20, \
               trajectory_limits: {margin: 0.02, on_excess: refuse, max_stretch: 3}}";
    assert_eq!(
        good(&three_axes(&format!("groups: {{b: [turret], {map}, c: {{axes: [x]}}}}\n"))).groups,
        [group("b", &[2], usual), group("a", &[2, 1], all), group("c", &[1], usual)]
    );
    let grippers =
        good(&three_axes("groups: {a: {axes: [x], gripper: {}}, b: {axes: [x], gripper: {allow_stalling: true}}}\n"))
            .groups;
    let settings: Vec<_> = grippers.iter().map(|group| group.gripper.map(|gripper| gripper.allow_stalling)).collect();
    assert_eq!(settings, [Some(false), Some(true)]);
    for (text, sentence) in [
        ("[x, ^x]", "axis `x` is taken already, at 10:14"),
        ("[x, ^line]", "axis `line` is virtual; a group has axes with a drive"),
        ("[^turet]", "g[0] is `turet`; no axis has that name, did you mean `turret`?"),
        ("[^plant]", "g[0] is `plant`, which is a backend; axis is allowed"),
        ("^[]", "group `g` is empty; the names of one axis or more are expected"),
        ("^x", "g is `x`; a list is expected"),
        ("^{}", "missing key `axes` in group `g`"),
        ("{axes: [x], max_duration: ^1441 min}", "max_duration is `1441 min`; 0 s to 86400 s is allowed"),
        (
            "{axes: [x], ^kinematics: {type: scara}}",
            "unknown key `kinematics` in group `g`, known are axes, trajectory_limits, angle_wraparound, max_duration, controller_state_rate, gripper",
        ),
        ("{axes: [x, turret], gripper: ^{}}", "group `g` has 2 axes; a gripper has one"),
        ("{axes: [x], gripper: {^stall: true}}", "unknown key `stall` in gripper, known are allow_stalling"),
        ("{axes: [x], trajectory_limits: {margin: ^0.2}}", "margin is 0.2; 0..0.1 is allowed"),
        ("{axes: [x], trajectory_limits: {max_stretch: ^0.9}}", "max_stretch is 0.9; 1..10 is allowed"),
        (
            "{axes: [x], trajectory_limits: {on_excess: ^ignore}}",
            "on_excess is `ignore`; one of scale, refuse is allowed",
        ),
    ] {
        assert_said(&three_axes(&format!("groups: {{g: {text}}}\n")), sentence);
    }
}

//! Tests ROS 2 parameters: the six parameter services, /parameter_events, layers, export and import, with the built-in
//! demo.

use std::thread;
use std::time::Duration;

use crate::support::{domain::Domain, peer::Peer, program::Program};
use serde_json::{Value, json};

/// A running demo and its client.
struct Bench {
    cyclone: Peer,
    _program: Program,
    domain: Domain,
}

impl Bench {
    fn start() -> Self {
        let domain = Domain::take();
        let mut cyclone = Peer::cyclone(&domain);
        let program = Program::start(&["run"], &domain);
        cyclone.run("axis-states /lineshaft");
        Self { cyclone, _program: program, domain }
    }

    fn get(&mut self, name: &str) -> Value {
        self.cyclone.run(&format!("params /lineshaft get {name}"))["get"][0].clone()
    }

    /// Returns the results of setting each parameter separately.
    fn set(&mut self, values: &str) -> Vec<Value> {
        let seen = self.cyclone.run(&format!("params /lineshaft set {values}"));
        seen["set"]["results"].as_array().expect("results").clone()
    }

    /// Returns the result of setting them together.
    fn set_together(&mut self, values: &str) -> Value {
        self.cyclone.run(&format!("params /lineshaft set_atomically {values}"))["set_atomically"]["result"].clone()
    }

    /// Returns the reason for which a single set is refused.
    #[track_caller]
    fn refused(&mut self, value: &str) -> String {
        let result = self.set(value).swap_remove(0);
        assert_eq!(result["successful"], false, "{value}");
        result["reason"].as_str().expect("a sentence").to_owned()
    }
}

#[test]
fn every_parameter_is_listed_described_and_read() {
    let mut bench = Bench::start();
    let seen = bench.cyclone.run("described-parameters /lineshaft");
    // 120 of MACS, and those of the others; three axes with a drive and one without.
    assert!(seen["parameters"].as_u64().unwrap() > 400, "{seen:?}");

    let listed =
        |bench: &mut Bench, words: &str| bench.cyclone.run(&format!("params /lineshaft list {words}"))["list"].clone();
    let of_x = listed(&mut bench, "x.saia --depth 1");
    assert_eq!(of_x["prefixes"], json!(["x.saia"]));
    let names = of_x["names"].as_array().unwrap();
    assert!(names.len() > 10 && names.iter().all(|name| name.as_str().unwrap().starts_with("x.saia.")), "{names:?}");
    assert_eq!(listed(&mut bench, "x.nothing")["names"], json!([]));
    assert_eq!(listed(&mut bench, "x.max_velocity --depth 1")["names"], json!(["x.max_velocity"]));

    let described = bench.cyclone.run("params /lineshaft describe x.max_velocity x.velmaxqc x.error_reaction");
    let [velocity, computed, reaction] = described["describe"].as_array().unwrap().as_slice() else {
        panic!("three descriptors: {described:?}")
    };
    assert_eq!((&velocity["type"], &velocity["read_only"]), (&json!(3), &json!(false)));
    assert!(velocity["description"].as_str().unwrap().contains("Unit: m/s."), "{velocity}");
    assert_eq!(computed["read_only"], true);
    assert_eq!(reaction["integer_range"], json!([{"from_value": 0, "to_value": 5, "step": 1}]));
}

/// Each settable parameter accepts its own value and another one; a value outside of its range, of another type, or no
/// number is refused with a message at both interfaces and changes nothing.
#[test]
fn every_parameter_is_checked_at_its_interfaces() {
    let mut bench = Bench::start();
    for object in ["x", "turret", "line", "machine"] {
        let seen = bench.cyclone.run(&format!("parameter-doors /lineshaft --object {object}"));
        let last = seen.all().last().expect("what was counted");
        let counted = |name: &str| last[name].as_u64().unwrap();
        assert_eq!(counted("settable") + counted("read_only"), counted("parameters"), "{last}");
        // Few parameters of the machine have an effect.
        assert_eq!(counted("other_values") > 100, object != "machine", "{last}");
        assert!(counted("bad_values") > 5 * counted("settable"), "{last}");
    }
}

#[test]
fn malformed_requests_change_nothing() {
    let mut bench = Bench::start();
    bench.cyclone.run("bad-parameter-requests /lineshaft");
}

/// Proves: MACS-STO-11
#[test]
fn a_set_is_done_each_by_itself_or_all_or_none() {
    let mut bench = Bench::start();
    let mixture = "x.max_velocity=0.5 x.max_acceleration=-1.0 x.profile=jerk x.no_such_key=1 x.max_position=0.4";
    let results = bench.set(mixture);
    let done: Vec<bool> = results.iter().map(|result| result["successful"].as_bool().unwrap()).collect();
    assert_eq!(done, [true, false, true, false, true], "{results:?}");
    let reason = results[1]["reason"].as_str().unwrap();
    assert!(reason.starts_with("x: max_acceleration is -1000 mm/s^2; more than 0 up to 953674316"), "{reason}");
    assert!(reason.ends_with(" mm/s^2 is allowed"), "{reason}");
    assert_eq!(results[3]["reason"], "parameter `x.no_such_key` has not been declared");
    for (name, value) in
        [("x.max_velocity", json!(0.5)), ("x.max_acceleration", json!(8.0)), ("x.profile", json!("jerk"))]
    {
        assert_eq!(bench.get(name), value, "{name}");
    }

    assert_eq!(bench.get("y.max_velocity"), 1.0, "only the axes that are named");

    for bad in ["x.max_acceleration=-1.0", "x.no_such_key=1", "x.profile=1", "x.velmaxqc=1", "y.max_position=-1.0"] {
        let result = bench.set_together(&format!("x.max_velocity=0.25 turret.max_velocity=1 {bad}"));
        assert_eq!(result["successful"], false, "{bad}");
        assert_eq!(bench.get("x.max_velocity"), 0.5, "{bad}: {result}");
    }
    // Together they are consistent; one after the other they would not be.
    let result = bench.set_together("x.min_position=0.5 x.max_position=0.6");
    assert_eq!((&result["successful"], &result["reason"]), (&json!(true), &json!("")));
    assert_eq!((bench.get("x.min_position"), bench.get("x.max_position")), (json!(0.5), json!(0.6)));
    let reason = bench.refused("x.min_position=0.7");
    assert_eq!(reason, "x: min_position 700 mm must be below max_position 600 mm");
    assert_eq!(bench.set_together("")["successful"], false, "an empty set");
}

#[test]
fn numbers_are_in_the_unit_of_the_row_and_what_may_be_left_out_has_no_value() {
    let mut bench = Bench::start();
    for (name, value) in [
        // 1048576 inc are 10 mm, the axis unit is mm.
        ("x.max_velocity", json!(1.2)),
        ("x.min_position", json!(-0.05)),
        ("x.max_following_error", json!(0.01)),
        // 10 um are 1048.576 inc.
        ("x.in_position_window", json!(1.000_404_357_910_16e-5)),
        ("x.amc.position_reference", json!(0.0)),
        // 125 829 120 inc/s at 2000 inc per revolution.
        ("x.velmax", json!(3_774_873.6)),
        ("x.max_jerk", Value::Null),
        ("x.error_reaction", json!(2)),
        ("x.profile", json!("trapezoid")),
        ("x.saia.clamp_sum", json!(false)),
        ("machine.canbaud", json!(5)),
    ] {
        assert_eq!(bench.get(name), value, "{name}");
    }
    for set in ["x.max_jerk=50", "x.amc.position_reference=60", "x.rampmin=400", "x.max_velocity=0.3"] {
        assert_eq!(bench.set(set)[0]["successful"], true, "{set}");
    }
    assert_eq!((bench.get("x.max_jerk"), bench.get("x.amc.position_reference")), (json!(50.0), json!(60.0)));
    // A value given as a time is still a time: 0.3 m/s in 0.4 s.
    assert_eq!(bench.get("x.max_acceleration"), 0.75);
    assert_eq!(bench.set("x.max_jerk=null x.max_position=null")[0]["successful"], true);
    assert_eq!((bench.get("x.max_jerk"), bench.get("x.max_position")), (Value::Null, Value::Null));
    let types = bench.cyclone.run("params /lineshaft types x.max_jerk x.max_velocity x.profile x.saia.clamp_sum");
    assert_eq!(types["types"], json!([0, 3, 4, 1]));
    let reason = bench.refused("x.max_velocity=null");
    assert_eq!(reason, "x.max_velocity cannot be without a value; a number is needed");
    for (value, reason) in [
        ("x.max_velocity=NaN", "x.max_velocity: "),
        ("x.max_velocity=Infinity", "x.max_velocity: "),
        ("x.error_reaction=2.0", "x.error_reaction cannot be a double; an integer is needed"),
        ("x.error_reaction=6", "x: error_reaction is 6; 0 to 5 is allowed"),
        ("x.profile=round", "x.profile is `round`; one of trapezoid, s_ramp, jerk is expected"),
        ("x.posfact_z=1", "x.posfact_z is read-only: part of the cell: changes with the file and a new start"),
        ("x.synctype=3", "x: synctype is 3; 0, 2, 4, 6 is allowed"),
        (
            "x.encoderclock=0",
            "x: encoderclock is 0: a serial interface whose clock could be left to another one does not exist yet; only 1 is allowed",
        ),
    ] {
        let said = bench.refused(value);
        assert!(said.starts_with(reason), "{value}: {said}");
    }
}

/// The ROS services, the verbs of other controllers and the layers act on the same values, and are reported in the same
/// way.
///
/// Proves: MACS-STO-07, MACS-STO-08
#[test]
fn changes_from_any_source_are_published() {
    let mut bench = Bench::start();
    let changed = |bench: &mut Bench, until: &str| -> Value {
        let seen = bench.cyclone.run(&format!("parameter-events /lineshaft --until {until}"));
        let events = seen["events"].as_array().unwrap().clone();
        assert!(events.iter().all(|event| event["deleted"] == 0), "a declaration is never deleted: {events:?}");
        let last = events.iter().rev().find(|event| event["changed"].get(until).is_some()).expect("the change");
        last["changed"].clone()
    };
    // Matched before the first change.
    bench.cyclone.run("parameter-events /lineshaft");
    bench.set("x.max_velocity=0.6");
    let seen = changed(&mut bench, "x.max_velocity");
    assert_eq!(seen["x.max_velocity"], 0.6);
    // Other views of it.
    assert_eq!(seen["x.velmax"], json!(1_887_436.8));
    assert_eq!(seen["x.rampmin"], json!(75.0));
    // 0.6 m/s are 62 914 560 inc/s: times 65.536, truncated.
    assert_eq!(seen["x.velmaxqc"], json!(4_123_168_604_i64));
    assert!(seen.get("x.max_acceleration").is_none() && seen.get("y.max_velocity").is_none(), "{seen}");
    bench.set("x.max_acceleration=4");
    // 419 430 400 inc/s^2 times 0.065536.
    assert_eq!(changed(&mut bench, "x.max_acceleration")["x.accmaxqc"], json!(27_487_790));
    for computed in ["x.velmaxqc", "x.accmaxqc"] {
        let reason = bench.refused(&format!("{computed}=1"));
        assert_eq!(reason, format!("{computed} is read-only: computed from other parameters"));
    }

    bench.cyclone.run("vocabulary /lineshaft y set_parameters max_velocity: 0.2 m/s");
    assert_eq!(changed(&mut bench, "y.max_velocity")["y.max_velocity"], 0.2);
    bench.cyclone.run("layers /lineshaft reset x --layer init");
    assert_eq!(changed(&mut bench, "x.max_velocity")["x.max_velocity"], 1.2);
    bench.set("x.max_position=null");
    assert_eq!(changed(&mut bench, "x.max_position")["x.max_position"], Value::Null);
    // A refused or equal value is no change.
    bench.set("x.max_velocity=1.2 x.max_velocity=-1.0");
    thread::sleep(Duration::from_millis(200));
    assert_eq!(bench.cyclone.run("parameter-events /lineshaft")["events"], json!([]));
}

/// Parameters of the machine have the same services, events and layers as all others.
#[test]
fn parameters_of_the_machine_are_set_read_and_brought_back() {
    let mut bench = Bench::start();
    assert_eq!(bench.get("machine.ainftime"), 0);
    bench.cyclone.run("parameter-events /lineshaft");
    assert_eq!(bench.set("machine.ainftime=7")[0]["successful"], true);
    assert_eq!(bench.get("machine.ainftime"), 7);
    let seen = bench.cyclone.run("parameter-events /lineshaft --until machine.ainftime");
    let events = seen["events"].as_array().expect("a list");
    assert!(events.iter().any(|event| event["changed"] == json!({"machine.ainftime": 7})), "{events:?}");
    // The demo has no outputs; nothing changes, and none of a set with one wrong value is accepted.
    let reason = bench.refused("machine.o_error=5");
    assert!(reason.ends_with("o_error is 5; the cell has 0 digital outputs"), "{reason}");
    let result = bench.set_together("machine.ainftime=9 machine.o_error=5");
    assert_eq!(result["successful"], false, "{result}");
    assert_eq!((bench.get("machine.ainftime"), bench.get("machine.o_error")), (json!(7), json!(0)));
    let reason = bench.refused("machine.ainftime=-1");
    assert_eq!(reason, "machine: ainftime is -1; 0 to 1073741823 is allowed");
    bench.cyclone.run("layers /lineshaft reset");
    assert_eq!(bench.get("machine.ainftime"), 0);
}

#[test]
fn what_is_exported_is_imported_without_any_change() {
    let mut bench = Bench::start();
    bench.cyclone.run("import-of-export /lineshaft");
    // Numbers with many digits, values that MACS gives, and unset values.
    bench.set(
        "x.max_velocity=0.3333333333333333 x.rampmin=77 x.max_position=null y.max_jerk=31.4159 turret.velmax=123.456",
    );
    bench.cyclone.run("import-of-export /lineshaft");

    let seen = bench.cyclone.run("export /lineshaft x --which not_cell");
    let text = seen["text"].as_str().unwrap();
    let mut keys: Vec<&str> = text.lines().map(|line| line.split(':').next().unwrap()).collect();
    keys.sort_unstable();
    assert_eq!(keys, ["x.max_position", "x.max_velocity", "x.rampmin"], "{text}");
    bench.cyclone.run("layers /lineshaft reset --layer init");
    bench.cyclone.run(&format!("import /lineshaft {}", text.trim().replace('\n', ";")));
    assert_eq!(bench.get("x.rampmin"), 77.0);
    assert_eq!(bench.cyclone.run("export /lineshaft x --which not_cell")["text"].as_str(), Some(text));
    assert_eq!(bench.cyclone.run("export /lineshaft y --which not_cell")["text"], "");

    for (wrong, sentence) in [
        ("x.max_velocity: 0.1 m/s;x.error_reaction: 9", "error_reaction is 9; 0 to 5 is allowed"),
        ("x.max_velocity: 0.1 m/s;x.max_speed: 1", "no parameter is called `x.max_speed`"),
        ("x.max_velocity: 0.1 kg", "parameters:1:17"),
        ("x.max_velocity: [", "this is not YAML"),
        ("x.max_velocity: 0.1 m/s --pad 1100000", "bytes long; 1048576 are allowed"),
    ] {
        let error = bench.cyclone.fails(&format!("import /lineshaft {wrong}"));
        assert!(error.contains(sentence), "{wrong}: {error}");
        assert_eq!(bench.get("x.max_velocity"), 0.3333333333333333, "{wrong}: all or none");
    }
    for (wrong, sentence) in [("q", "no axis is called `q`"), ("--which 4", "which is 4; 0 ALL")] {
        let error = bench.cyclone.fails(&format!("export /lineshaft {wrong}"));
        assert!(error.starts_with(sentence), "{wrong}: {error}");
    }
}

#[test]
fn layers_are_brought_back_for_the_axes_that_are_named() {
    let mut bench = Bench::start();
    bench.set("x.max_velocity=0.5 y.max_velocity=0.5");
    let seen = bench.cyclone.run("layers /lineshaft reset x --layer user");
    assert_eq!(seen["message"], "parameters of 1 axis reset");
    assert_eq!((bench.get("x.max_velocity"), bench.get("y.max_velocity")), (json!(1.2), json!(0.5)));
    let seen = bench.cyclone.run("layers /lineshaft reset --layer init");
    assert_eq!(seen["message"], "parameters of 4 axes reset");
    assert_eq!(bench.get("y.max_velocity"), 1.0);

    for (wrong, sentence) in [
        ("reset --layer 7", "layer is 7; 0 USER, 1 INIT are allowed"),
        ("reset q", "no axis is called `q`; there are line, x, y, turret"),
        ("save q", "no axis is called `q`; there are line, x, y, turret"),
        ("delete x q", "no axis is called `q`; there are line, x, y, turret"),
    ] {
        let error = bench.cyclone.fails(&format!("layers /lineshaft {wrong}"));
        assert_eq!(error, sentence, "{wrong}");
    }
}

#[test]
fn a_client_on_rmw_fastrtps_gets_sets_and_describes() {
    let bench = Bench::start();
    let mut fastdds = Peer::fastdds(&bench.domain);
    let seen =
        fastdds.run("params /lineshaft get x.max_velocity x.max_jerk x.profile x.error_reaction x.saia.clamp_sum");
    assert_eq!(seen["get"], json!([1.2, null, "trapezoid", 2, false]));
    let seen = fastdds.run("params /lineshaft set x.max_velocity=0.4 x.max_velocity=-1.0 x.no_such_key=1.0");
    let results = seen["set"]["results"].as_array().expect("results");
    let done: Vec<&Value> = results.iter().map(|result| &result["successful"]).collect();
    assert_eq!(done, [true, false, false]);
    assert_eq!(fastdds.run("params /lineshaft get x.max_velocity")["get"], json!([0.4]));
    assert_eq!(fastdds.run("params /lineshaft get x.max_velocity x.no_such_key")["get"], json!([]));
    let seen = fastdds.run("params /lineshaft describe x.min_position x.error_reaction");
    let [count, low, reaction] = seen.all() else { panic!("{seen:?}") };
    assert_eq!((&count["count"], &low["type"], &low["dynamic_typing"]), (&json!(2), &json!(3), &json!(true)));
    assert!(low["description"].as_str().unwrap().starts_with("Lowest position"), "{low}");
    assert_eq!((&reaction["low"], &reaction["high"], &reaction["step"]), (&json!(0), &json!(5), &json!(1)));
}

/// Longer than a datagram of any network, and than the 65,000 bytes of one on the loopback.
#[test]
fn long_replies_reach_clients_of_rmw_fastrtps() {
    let bench = Bench::start();
    let mut fastdds = Peer::fastdds(&bench.domain);
    for count in [20, 400] {
        let names = " x.max_velocity".repeat(count);
        for _ in 0..3 {
            fastdds.run(&format!("params /lineshaft describe{names}"));
        }
        assert_eq!(fastdds.run("params /lineshaft get x.max_velocity")["get"][0], 1.2);
    }
}

/// A client that outlives two nodes still sends its requests to the second one, although the first one never
/// acknowledged them.
#[test]
fn request_to_dead_node_is_not_executed_by_its_successor() {
    let domain = Domain::take();
    let mut old = Peer::cyclone(&domain);
    let start = || Program::start(&["run", "--store", "none"], &domain);
    let known = |peer: &mut Peer| {
        // The first node is still discovered, too; only the arrival of values shows that the new one is discovered.
        peer.run("axis-states /lineshaft");
        thread::sleep(Duration::from_secs(1));
        peer.run("params /lineshaft get x.max_velocity")["get"][0].clone()
    };
    let first = start();
    assert_eq!(known(&mut old), 1.2);
    first.kill_both();
    let second = start();
    assert_eq!(known(&mut old), 1.2);
    let set = old.run("params /lineshaft set x.max_velocity=0.5");
    assert_eq!(set["set"]["results"][0]["successful"], true);
    // The old node does not announce its end: only the time stamp of the request shows that it was for the old node.
    second.kill_both();
    let third = start();
    assert_eq!(known(&mut old), 1.2, "{}", third.log());
    assert!(third.log().contains("it was written before this node was there"), "{}", third.log());
}

/// `ros2 param dump` and `ros2 param load`, and the dump as `--params-file`: every value is the same afterwards,
/// including values that are unset, read-only, long, short, or look like another type.
#[test]
fn a_dump_can_be_loaded_and_given_at_the_start() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("dump.yaml");
    let path = file.to_str().expect("a name of this test");
    let mut bench = Bench::start();
    let values = |bench: &mut Bench| bench.cyclone.run("param-values /lineshaft")["values"].clone();
    // Shortest texts without a decimal point, integers for doubles, limits that are set and removed, names.
    let chosen = "x.in_position_window=1e-05 x.max_velocity=0.3 x.max_jerk=1 x.profile=jerk y.min_position=-0.123456789 \
                  turret.max_velocity=3 x.error_reaction=3 x.saia.clamp_sum=true use_sim_time=false \
                  line.max_jerk=1e+08 constraints.x.goal=1e-06 turret.velmax=1000";
    for result in bench.set(chosen) {
        assert_eq!(result["successful"], true, "{result}");
    }
    let dumped = bench.cyclone.run(&format!("param-dump /lineshaft {path}"))["values"].clone();
    assert_eq!(dumped["y.max_jerk"], Value::Null, "something has no value");
    assert!(dumped.as_object().expect("values").len() > 400);

    let other = "x.max_velocity=0.2 x.max_jerk=null y.max_jerk=5.0 y.min_position=null x.profile=trapezoid turret.max_velocity=1 \
                 x.in_position_window=0.001 x.error_reaction=2 x.saia.clamp_sum=false constraints.x.goal=0.5";
    for result in bench.set(other) {
        assert_eq!(result["successful"], true, "{result}");
    }
    assert_ne!(values(&mut bench), dumped);
    let loaded = bench.cyclone.run(&format!("param-load /lineshaft {path}"));
    assert_eq!(loaded["failed"], json!({}), "of {}", loaded["set"]);
    same_values(&values(&mut bench), &dumped);
    drop(bench);

    let text = std::fs::read_to_string(&file).expect("what was dumped");
    for (node, arguments, key) in [
        ("/lineshaft", "", "/lineshaft"),
        ("/press/lineshaft", "-r __ns:=/press", "/*/lineshaft"),
        ("/arm", "-r __node:=arm", "/**"),
    ] {
        std::fs::write(&file, text.replacen("/lineshaft:", &format!("{key}:"), 1)).expect("a folder of this test");
        let domain = Domain::take();
        let mut peer = Peer::cyclone(&domain);
        let line = format!("run --ros-args --params-file {path} {arguments}");
        let program = Program::start(&line.split_whitespace().collect::<Vec<_>>(), &domain);
        peer.run(&format!("axis-states {node}"));
        // Names of topics are among those of QoS: they belong to one node.
        let named = |values: &Value| {
            let all =
                values.as_object().expect("values").iter().filter(|(name, _)| !name.starts_with("qos_overrides."));
            Value::Object(all.map(|(name, value)| (name.clone(), value.clone())).collect())
        };
        same_values(&named(&peer.run(&format!("param-values {node}"))["values"]), &named(&dumped));
        let log = program.log();
        assert!(!log.contains("is left out"), "{log}");
    }
}

/// A part of the cell that the dump of another cell has with other values ends the program; so does a value that the
/// cell requires.
#[test]
fn a_dump_of_another_cell_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("dump.yaml");
    let path = file.to_str().expect("a name of this test");
    for (line, sentence) in [
        ("x.posfact_z: 7", "dump.yaml:3:5: x.posfact_z is read-only: part of the cell"),
        ("x.max_velocity: null", "dump.yaml:3:5: x.max_velocity cannot be without a value; a number is needed"),
    ] {
        std::fs::write(&file, format!("lineshaft:\n  ros__parameters:\n    {line}\n")).expect("a folder of this test");
        let domain = Domain::take();
        let mut program = Program::start(&["run", "--ros-args", "--params-file", path], &domain);
        let status = program.wait_exit(std::time::Duration::from_secs(20));
        assert_eq!(status.code(), Some(2), "{line}");
        assert!(program.log().contains(sentence), "{}", program.log());
    }
}

/// Compares by name, so that a failure shows the differences.
#[track_caller]
fn same_values(found: &Value, expected: &Value) {
    let (found, expected) = (found.as_object().expect("values"), expected.as_object().expect("values"));
    let names: std::collections::BTreeSet<_> = found.keys().chain(expected.keys()).collect();
    // A number may have been converted between two units.
    let is_near = |a: &Value, b: &Value| matches!((a.as_f64(), b.as_f64()), (Some(a), Some(b)) if (a - b).abs() <= 1e-9 * b.abs());
    let differs = |name: &&&String| match (found.get(name.as_str()), expected.get(name.as_str())) {
        (Some(found), Some(expected)) => found != expected && !is_near(found, expected),
        _ => true,
    };
    let wrong: Vec<_> = names
        .iter()
        .filter(differs)
        .map(|name| (*name, found.get(name.as_str()), expected.get(name.as_str())))
        .collect();
    assert!(wrong.is_empty(), "name, found, expected: {wrong:?}");
}

//! Tests function slots and tables from a client on Cyclone DDS, with launch-configs/functions.yaml.

use std::path::Path;

use crate::support::{
    domain::Domain,
    peer::{Observations, Peer},
    program::Program,
};
use serde_json::{Value, json};

const OUT_OF_RANGE: u32 = 3004;

struct Bench {
    cyclone: Peer,
    _program: Program,
}

impl Bench {
    fn start(more: &[&str]) -> Self {
        Self::of("functions.yaml", more)
    }

    fn of(cell: &str, more: &[&str]) -> Self {
        let cell = Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs").join(cell);
        let cell = cell.to_str().expect("a path of text");
        let domain = Domain::take();
        let mut cyclone = Peer::cyclone(&domain);
        let args = ["run", cell, "--store", "none", "--flight-recorder", "0"];
        let program = Program::start(&[&args[..], more].concat(), &domain);
        cyclone.run("axis-states /lineshaft");
        Self { cyclone, _program: program }
    }

    /// Returns the values in force after a command.
    #[track_caller]
    fn function(&mut self, command: &str) -> Value {
        self.cyclone.run(&format!("function /lineshaft {command}"))["active"].clone()
    }

    #[track_caller]
    fn refused(&mut self, command: &str) -> String {
        self.cyclone.fails(command)
    }

    /// Returns the state of a function in the next message.
    fn state(&mut self, function: &str) -> Value {
        self.cyclone.run("functions /lineshaft")["functions"][function].clone()
    }

    fn axis(&mut self, field: &str) -> Value {
        self.cyclone.run("axis-states /lineshaft")["axes"]["table"][field].clone()
    }

    fn get(&mut self, name: &str) -> Value {
        self.cyclone.run(&format!("params /lineshaft get {name}"))["get"][0].clone()
    }

    fn set(&mut self, how: &str, values: &str) -> Value {
        self.cyclone.run(&format!("params /lineshaft {how} {values}"))[how].clone()
    }
}

/// Proves: AMK-CMD-03, AMK-CMD-06
#[test]
fn a_function_is_started_renewed_read_and_ended() {
    let mut bench = Bench::start(&[]);
    let seen = bench.cyclone.run("functions /lineshaft --count 15");
    assert_eq!(seen["order"], json!(["ratio", "choose", "cams", "watch"]));
    let steps: Vec<f64> = seen["steps"].as_array().expect("steps").iter().filter_map(Value::as_f64).collect();
    // The stamps are those of cycles; a message may be sent one poll later.
    let mean = steps.iter().sum::<f64>() / steps.len() as f64;
    assert!((0.09..0.13).contains(&mean), "ten times a second: {steps:?}");
    let at_rest = json!({"name": "ratio", "type": "varsync", "slot": 0, "active": false, "error_code": 0, "sink": 0,
                         "inputs": 0, "outputs": 0, "sak_share": 0});
    assert_eq!(seen["functions"]["ratio"], at_rest);

    bench.cyclone.run("axes /lineshaft enable table");
    let bad = "function /lineshaft ratio start m1=5000 m2=40000";
    let range = "ratio: m2 is 40000; -32768 to 32767 is allowed (unit: 0.0001)";
    assert_eq!(bench.refused(bad), range);
    let state = bench.state("ratio");
    assert_eq!((&state["active"], &state["error_code"]), (&json!(false), &json!(OUT_OF_RANGE)));
    for (command, sentence) in [
        ("ratio start m1=0.5", "ratio: m1 is 0.5; a whole number of 64 bits is needed"),
        ("ratio start m1=fast", "ratio: m1 cannot be a string; an integer or a list of integers is needed"),
        ("ratio 255", "command is 255; 0 (RESET), 1 (START), 5 (VALUE_NEW) or 6 (READ_VALUE) is expected"),
        ("gear start", "no function is called `gear`; ratio, choose, cams, watch are known"),
        ("choose value_new value_e1_0=1", "choose: it is in RESET; VALUE_NEW needs a function that is started"),
    ] {
        assert_eq!(bench.refused(&format!("function /lineshaft {command}")), sentence, "{command}");
    }
    let unchanged = bench.function("ratio read_value");
    assert_eq!((&unchanged["m1"], &unchanged["m2"]), (&json!(10_000), &json!(5_000)), "nothing was taken");

    // Half a revolution per metre: the values and the START are one command.
    let active = bench.function("ratio start m1=5000");
    assert_eq!((&active["m1"], &active["m2"], &active["mode"]), (&json!(5_000), &json!(5_000), &json!(0)));
    assert_eq!(bench.axis("reference"), 8);
    bench.cyclone.run("move /lineshaft --axis line --position 1 --velocity 1 --wait");
    bench.cyclone.until_axis("table", "at its place", |table| table["command_increments"] == 18_000);
    let state = bench.state("ratio");
    assert_eq!((&state["active"], &state["sink"], &state["error_code"]), (&json!(true), &json!(18_000), &json!(0)));

    // In VALUE_NEW live fields take effect, the others at the next START.
    bench.function("choose start");
    assert_eq!(bench.state("choose")["sink"], 100);
    let active = bench.function("choose value_new value_e1_0=-7 mode=0");
    assert_eq!((&active["value_e1_0"], &active["mode"]), (&json!(-7), &json!(3)));
    assert_eq!(bench.state("choose")["sink"], -7);
    assert_eq!(bench.function("choose read_value"), active);
    for function in ["ratio", "choose"] {
        bench.function(&format!("{function} reset"));
        assert_eq!(bench.state(function)["active"], false, "{function}");
    }

    // Doubles are accepted if they are integers.
    let active = bench.function("ratio start m1=20000.0");
    assert_eq!((&active["m1"], &active["m2"]), (&json!(20_000), &json!(5_000)));
    let sentence = "ratio: it is started already; RESET comes first";
    assert_eq!(bench.refused("function /lineshaft ratio start m2=40000"), sentence);
}

#[test]
fn tables_are_loaded_and_read() {
    let mut bench = Bench::start(&[]);
    let table = |bench: &mut Bench, name: &str| {
        let seen = bench.cyclone.run(&format!("get-table /lineshaft {name}"));
        (seen["form"].clone(), seen["x"].clone(), seen["y"].clone())
    };
    let limits = json!([100, 0, 0, 1, 0, 1, 500, 0, 0, 1, 0, 1]);
    assert_eq!(table(&mut bench, "limits"), (json!("words"), json!([]), limits.clone()));
    bench.function("watch start");
    let load = "load-table /lineshaft limits --y 100,0,0,1,0,1,600,0,0,1,0,1";
    bench.cyclone.run(load);
    assert_eq!(table(&mut bench, "limits").2[6], 600, "watch reads it again at VALUE_NEW");
    let beyond = bench.refused("load-table /lineshaft limits --y 100,0,0,1,0,1,40000,0,0,1,0,1");
    assert!(beyond.ends_with("the first table has a threshold of 40000; 0 to 32767 is possible"), "{beyond}");
    bench.function("watch value_new");
    bench.function("watch reset");
    assert_eq!(table(&mut bench, "limits").2[6], 600);
    for (request, sentence) in [
        ("limit --y 1", "no table is called `limit`; nose, limits are known"),
        ("limits", "limits: a table has 0 numbers; 1 to 1000000 are possible"),
        ("limits --y 70000", "limits: word 0 is 70000; -32768 to 65535 is possible"),
        ("limits --x 1 --y 1", "limits: a table of form words has 1 places in x; it takes none"),
    ] {
        assert_eq!(bench.refused(&format!("load-table /lineshaft {request}")), sentence, "{request}");
    }
    assert_eq!(bench.refused("get-table /lineshaft limit"), "no table is called `limit`; nose, limits are known");
    // Longer than a few datagrams, in both directions.
    assert_eq!(bench.cyclone.run("load-long-table /lineshaft limits")["count"], 65_536);
    // The maximum length of a table, and longer.
    let load = |count: usize| format!("load-table /lineshaft limits --y {}", vec!["7"; count].join(","));
    bench.cyclone.run(&load(1_000_000));
    assert_eq!(bench.refused(&load(1_000_001)), "limits: a table has 1000001 numbers; 1 to 1000000 are possible");
}

#[test]
fn fields_are_parameters_that_stage() {
    let mut bench = Bench::start(&["--ros-args", "-p", "ratio.m8:=8", "-p", "cams.cams:=[1, 0]"]);
    assert_eq!((bench.get("ratio.m8"), bench.get("cams.cams")), (json!(8), json!([1, 0, 0, 0, 0, 0, 0, 0])));
    let structure = ["slot", "type", "source", "sink", "cycle_factor"].map(|key| bench.get(&format!("cams.{key}")));
    assert_eq!(structure, [json!(2), json!("cam"), json!("table.actual.position"), json!("none"), json!(1)]);
    bench.cyclone.run("parameter-events /lineshaft");
    let result = |seen: Value| (seen["result"]["successful"].clone(), seen["result"]["reason"].clone());
    let together = |bench: &mut Bench, values: &str| result(bench.set("set_atomically", values));
    assert_eq!(together(&mut bench, "ratio.m1=1 ratio.m2=2").0, true);
    let seen = bench.cyclone.run("parameter-events /lineshaft --until ratio.m2");
    assert_eq!(seen["events"][0]["changed"], json!({"ratio.m1": 1, "ratio.m2": 2}), "{seen:?}");
    assert_eq!(bench.function("ratio read_value")["m1"], 10_000, "staged alone");
    for (values, sentence) in [
        (
            "ratio.m1=3 table.max_velocity=1.0",
            "ratio.m1 and table.max_velocity cannot be set together; a function's values are a set of their own",
        ),
        (
            "ratio.m1=3 choose.mode=1",
            "ratio.m1 and choose.mode cannot be set together; a function's values are a set of their own",
        ),
        ("ratio.m1=3 ratio.m2=32768", "ratio: m2 is 32768; -32768 to 32767 is allowed (unit: 0.0001)"),
        ("ratio.m1=3 ratio.m9=3", "parameter `ratio.m9` has not been declared"),
        ("ratio.slot=3", "ratio.slot is read-only: part of the cell: changes with the file and a new start"),
    ] {
        assert_eq!(together(&mut bench, values), (json!(false), json!(sentence)), "{values}");
    }
    assert_eq!((bench.get("ratio.m1"), bench.get("ratio.m2")), (json!(1), json!(2)));
    let each = bench.set("set", "ratio.m1=4 ratio.m2=70000 table.max_velocity=1.0 choose.mode=1");
    let done: Vec<_> =
        each["results"].as_array().expect("results").iter().map(|one| one["successful"].clone()).collect();
    assert_eq!(done, [true, false, true, true].map(Value::from));
    assert_eq!(bench.function("ratio start")["m1"], 4);
    bench.cyclone.run("described-parameters /lineshaft");
    // Structural values repeated in a dump are no error.
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("dump.yaml");
    let file = file.to_str().expect("a path of text");
    bench.cyclone.run(&format!("param-dump /lineshaft {file}"));
    bench.set("set", "ratio.m8=-9");
    assert_eq!(bench.cyclone.run(&format!("param-load /lineshaft {file}"))["failed"], json!({}));
    assert_eq!(bench.get("ratio.m8"), 8);
    drop(bench);
    let mut bench = Bench::start(&["--ros-args", "--params-file", file]);
    assert_eq!(
        (bench.get("ratio.m1"), bench.get("ratio.m8"), bench.get("choose.mode")),
        (json!(4), json!(8), json!(1))
    );
}

#[test]
fn memory_cells_are_set_from_outside_and_outputs_of_functions_are_events() {
    let mut bench = Bench::of("functions/04_feed.yaml", &[]);
    for (request, sentence) in [
        ("", "no memory cell is named; one or more, each with a value, are expected"),
        ("fed=1", "no memory cell is called `fed`; there are feed"),
        ("feed=32768", "feed is `32768`; a whole number from -32768 to 32767 is expected"),
        ("feed=1.5", "feed is `1.5`; a whole number from -32768 to 32767 is expected"),
        ("feed=nan", "feed is `NaN`; a whole number from -32768 to 32767 is expected"),
        ("feed=1 feed=2", "memory cell `feed` stands twice; once is allowed"),
        ("feed", "cells holds 1, values 0; as many of both are needed"),
    ] {
        assert_eq!(bench.refused(&format!("set-memory /lineshaft {request}")), sentence, "{request}");
    }
    bench.cyclone.run("axes /lineshaft enable");
    bench.cyclone.run("events /lineshaft --seconds 0.3");
    bench.function("copy start");
    let told = bench.cyclone.run("events /lineshaft --seconds 0.3");
    let is_started = |seen: &Value| seen["message"]["text"] == "copy: active, no output set";
    assert!(told.all().iter().any(is_started), "{told:?}");
    // The cell begins at 32700: 67 inc further, then 68 more across the wrap.
    for (feed, position) in [(32_767, 67), (-32_701, 135)] {
        bench.cyclone.run(&format!("set-memory /lineshaft feed={feed}"));
        let seen = || bench.cyclone.run("axis-states /lineshaft")["axes"]["x"]["command_increments"].clone();
        let positions: Vec<_> = std::iter::repeat_with(seen).take(3).collect();
        assert_eq!(positions.last(), Some(&json!(position)), "{positions:?}");
    }
}

/// The dial of launch-configs/functions/16_indexer.yaml: 20 inc per cycle, a stop within 20 + 16 + 12 + 8 + 4.
#[test]
fn an_order_of_a_function_is_a_goal() {
    let mut bench = Bench::of("functions/16_indexer.yaml", &[]);
    let result = |seen: &Observations| (seen["result"]["code"].clone(), seen["result"]["message"].clone());
    let off = bench.cyclone.run("run-function /lineshaft index --expect ABORTED");
    assert_eq!(result(&off), (json!(10_007), json!("dial: the axis is not enabled; enable it first")));
    bench.cyclone.run("axes /lineshaft enable dial");
    let rejected = bench.refused("run-function /lineshaft dial");
    assert_eq!(rejected, "the goal was rejected");
    let done = bench.cyclone.run("run-function /lineshaft index travel=2500 --expect SUCCEEDED");
    assert_eq!((&done["result"]["code"], &done["result"]["sink"]), (&json!(0), &json!(2500)));
    assert_eq!(done["statuses"].as_array().and_then(|all| all.last()), Some(&json!("SUCCEEDED")));
    // 144 cycles, and a message every 50 ms.
    assert!(done["feedback"]["count"].as_u64() >= Some(1), "{done:?}");
    let position = |bench: &mut Bench| {
        bench.cyclone.run("axis-states /lineshaft")["axes"]["dial"]["command_increments"].as_i64().expect("a number")
    };
    assert_eq!(position(&mut bench), 2500);

    let canceled =
        bench.cyclone.run("run-function /lineshaft index travel=2000000 --cancel-after 0.3 --expect CANCELED");
    assert_eq!(canceled["result"]["code"], json!(10_103));
    let here = position(&mut bench);
    assert!((2500 + 1000..2500 + 60_000).contains(&here), "{here}");
    assert_eq!(canceled["result"]["sink"], json!(here));

    // The rest of it was dropped: the next one is a complete order.
    let goal = bench.cyclone.run("run-function /lineshaft index travel=40000");
    let goal = goal["goal"].as_str().expect("an identity").to_owned();
    let busy = bench.cyclone.run("run-function /lineshaft index travel=1 --expect ABORTED");
    let sentence = "index: an order is under way; it has to end first, or its goal to be cancelled";
    assert_eq!(result(&busy), (json!(3086), json!(sentence)));
    let moved = bench.cyclone.run(&format!("result /lineshaft run_function {goal}"));
    assert_eq!(moved["result"]["sink"], json!(here + 40_000));

    let goal = bench.cyclone.run("run-function /lineshaft index travel=2000000");
    let goal = goal["goal"].as_str().expect("an identity").to_owned();
    bench.function("index reset");
    let reset = bench.cyclone.run(&format!("result /lineshaft run_function {goal} --expect ABORTED"));
    assert_eq!(reset["result"]["code"], json!(3089));
    let range = bench.cyclone.run("run-function /lineshaft index acceleration=0 --expect ABORTED");
    let sentence = "index: acceleration is 0; 1 to 100000000 is allowed (unit: 0.001 rev/s^2)";
    assert_eq!(result(&range), (json!(3004), json!(sentence)));
}

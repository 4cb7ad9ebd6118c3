//! Tests the output for CI pipelines: `--json`, `--junit` and `sim --all`.

use crate::support::machine::share;
use roxmltree::{Document, Node};
use serde_json::{Value, json};
use std::path::Path;
use std::process::Command;

const CELL: &str = "\
lineshaft: 1
cycle: 2 ms
backends: {plant: {type: sim}}
io:
  start: {type: di, backend: plant, address: 0}
  lamp: {type: do, backend: plant, address: 0}
memory: {feed: {type: i16, initial: 7}}
axes:
  line: {type: linear, drive: virtual, scale: {increments: 1000, per: 1 mm}, max_velocity: 3 m/s, max_acceleration: 5 m/s^2}
  x: {type: linear, joint: Feeder, scale: {increments: 1000, per: 1 mm}, drive: {backend: plant, address: 0, interface: position},
      max_velocity: 100 mm/s, max_acceleration: 1 m/s^2, sim: {model: ideal}}
";

/// x holds 0 inc: `is` determines whether the scenario passes.
fn scenario(head: &str, is: &str) -> String {
    format!("scenario: {is}\n{head}cycles: 50\nexpect:\n  - {{signal: x.command.position, at: end, is: {is}}}\n")
}

/// Folder in which the program runs.
struct Bench(tempfile::TempDir);

struct Said {
    code: i32,
    out: String,
    errors: String,
}

impl Bench {
    fn new(files: &[(&str, &str)]) -> Self {
        let bench = Self(tempfile::tempdir().expect("a folder"));
        files.iter().for_each(|(name, text)| bench.write(name, text));
        bench
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn write(&self, name: &str, text: &str) {
        let path = self.path().join(name);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("room");
        std::fs::write(path, text).expect("room");
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path().join(name)).expect("a file")
    }

    fn run(&self, arguments: &[&str]) -> Said {
        let _machine = share();
        let program = Command::new(env!("CARGO_BIN_EXE_lineshaft")).args(arguments).current_dir(self.path()).output();
        let output = program.expect("the program starts");
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
        let code = output.status.code().expect("it ended by itself");
        Said { code, out: text(output.stdout), errors: text(output.stderr) }
    }

    /// Returns the object that a command prints: one line, and nothing else.
    #[track_caller]
    fn object(&self, arguments: &[&str], code: i32) -> Value {
        let said = self.run(&[arguments, &["--json"]].concat());
        assert_eq!((said.code, said.errors.as_str()), (code, ""), "{arguments:?}: {}", said.out);
        assert_eq!(said.out.matches('\n').count(), 1, "{}", said.out);
        let object: Value = serde_json::from_str(&said.out).unwrap_or_else(|error| panic!("{error}: {}", said.out));
        assert_eq!((&object["format"], &object["exit_code"]), (&json!(1), &json!(code)));
        object
    }
}

/// One scenario that passes with the cell next to it, one that fails with the cell that it names.
fn two() -> Bench {
    let named = scenario("cell: a/ok.yaml\n", "7 mm");
    Bench::new(&[
        ("a/ok.yaml", CELL),
        ("a/ok.scenario.yaml", scenario("", "0 mm").as_str()),
        ("b.scenario.yaml", named.as_str()),
    ])
}

#[test]
fn sim_all_plays_scenarios_in_order_and_ends_with_the_worst_result() {
    let bench = two();
    let said = bench.run(&["sim", "--all", "a"]);
    assert_eq!((said.code, said.errors.as_str()), (0, ""));
    assert_eq!(said.out, "PASSED a/ok.scenario.yaml\n1 passed, 0 failed\n");

    let said = bench.run(&["sim", "--all", "."]);
    assert_eq!((said.code, said.errors.as_str()), (1, ""), "{}", said.out);
    let lines: Vec<&str> = said.out.lines().collect();
    assert_eq!(lines[..2], ["PASSED ./a/ok.scenario.yaml", "FAILED ./b.scenario.yaml"]);
    assert_eq!(lines.last(), Some(&"1 passed, 1 failed"));
    assert!(said.out.contains("./b.scenario.yaml:5:5: x.command.position is 0 "), "{}", said.out);

    bench.write("c.scenario.yaml", &scenario("", "0 mm"));
    bench.write("d.scenario.yaml", &scenario("cell: a/ok.yaml\n", "0 mmm"));
    bench.write("e.scenario.yaml", &scenario("cell: none.yaml\n", "0 mm"));
    let said = bench.run(&["sim", "--all", "."]);
    assert_eq!(said.code, 2);
    assert!(said.out.ends_with("\n1 passed, 1 failed, 3 with errors\n"), "{}", said.out);
    let order: Vec<&str> = said.out.lines().filter_map(|line| line.strip_prefix("ERROR  ")).collect();
    assert_eq!(order, ["./c.scenario.yaml", "./d.scenario.yaml", "./e.scenario.yaml"]);
    let errors: Vec<&str> = said.errors.lines().collect();
    assert_eq!(
        errors[0],
        "./c.scenario.yaml:1:1: the scenario has no cell; name it by the key `cell: FILE`, or put NAME.yaml next to \
         NAME.scenario.yaml"
    );
    assert!(errors[1].starts_with("./d.scenario.yaml:5:"), "{}", errors[1]);
    assert_eq!(errors[2], "./e.scenario.yaml:2:7: cell: there is no file ./none.yaml");
    assert_eq!(errors.len(), 3);

    let empty = Bench::new(&[]);
    let said = empty.run(&["sim", "--all", "."]);
    assert_eq!((said.code, said.errors.as_str()), (2, "error: --all .: there is no file NAME.scenario.yaml\n"));
    let said = empty.run(&["sim", "--all", "none"]);
    assert!(
        said.code == 2 && said.errors.starts_with("error: --all none: cannot read the folder none: "),
        "{}",
        said.errors
    );
}

/// Returns the text without the values of an attribute.
fn without(text: &str, begin: &str, end: char) -> String {
    let mut parts = text.split(begin);
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| text + part.split_once(end).map_or("", |(_, rest)| rest))
}

#[test]
fn sim_all_gives_the_same_for_any_number_of_jobs() {
    let bench = Bench::new(&[("cell.yaml", CELL)]);
    for place in 0..12 {
        let is = if place % 3 == 1 { "7 mm" } else { "0 mm" };
        // The first ones take longest.
        let text = scenario("cell: cell.yaml\n", is).replace("cycles: 50", &format!("cycles: {}", 6000 - place * 500));
        bench.write(&format!("{place:02}.scenario.yaml"), &text);
    }
    let all = |jobs: &str| {
        let said = bench.run(&["sim", "--all", ".", "--jobs", jobs, "--junit", "report.xml"]);
        assert_eq!((said.code, said.errors.as_str()), (1, ""));
        let object = bench.run(&["sim", "--all", ".", "--jobs", jobs, "--json"]).out;
        (said.out, without(&object, "\"wall_seconds\":", ','), without(&bench.read("report.xml"), " time=\"", '"'))
    };
    let one = all("1");
    assert!(one.0.ends_with("\n8 passed, 4 failed\n"), "{}", one.0);
    for jobs in ["2", "5", "64"] {
        assert_eq!(all(jobs), one, "{jobs} jobs");
    }
    let said = bench.run(&["sim", "--all", ".", "--jobs", "0"]);
    assert!(said.code == 2 && said.errors.contains("0 is not in 1..=256"), "{}", said.errors);
}

#[test]
fn cell_of_the_command_line_has_priority_over_the_scenario() {
    let bench = two();
    bench.write("other.yaml", CELL);
    bench.write("empty.scenario.yaml", &scenario("cell: ''\n", "0 mm"));
    let said = bench.run(&["sim", "--scenario", "b.scenario.yaml"]);
    assert_eq!((said.code, said.errors.as_str()), (1, ""), "{}", said.out);
    let said = bench.run(&["sim", "a/ok.yaml", "--scenario", "b.scenario.yaml"]);
    assert_eq!((said.code, said.errors.as_str()), (1, ""), "the same cell");
    let note = "note: b.scenario.yaml:2:7: the scenario names the cell a/ok.yaml; other.yaml is used\n";
    for command in ["sim", "check"] {
        let said = bench.run(&[command, "other.yaml", "--scenario", "b.scenario.yaml"]);
        assert_eq!(said.errors, note, "{command}");
    }
    let object = bench.object(&["sim", "other.yaml", "--scenario", "b.scenario.yaml"], 1);
    assert_eq!(object["scenarios"][0]["cell_file"], "other.yaml");
    assert_eq!(object["scenarios"][0]["notes"].as_array().map(Vec::len), Some(1));
    // A scenario without the key uses the cell next to it.
    assert_eq!(bench.run(&["sim", "--scenario", "a/ok.scenario.yaml"]).code, 0);
    // The same without the option: the name or a key identifies a scenario.
    assert_eq!(bench.run(&["sim", "a/ok.scenario.yaml"]).code, 0);
    bench.write("named.yaml", &scenario("cell: a/ok.yaml\n", "0 mm"));
    let said = bench.run(&["sim", "named.yaml"]);
    assert_eq!((said.code, said.errors.as_str()), (0, ""), "{}", said.out);
    let said = bench.run(&["sim", "a/ok.yaml"]);
    assert_eq!(
        (said.code, said.errors.as_str()),
        (2, "error: a/ok.yaml is no scenario; `lineshaft sim a/ok.scenario.yaml` plays the one next to it\n")
    );
    let said = bench.run(&["sim", "other.yaml"]);
    assert_eq!(
        (said.code, said.errors.as_str()),
        (
            2,
            "error: other.yaml is no scenario; `lineshaft sim other.yaml --scenario FILE` plays one, `lineshaft new FILE` writes an example\n"
        )
    );
    let said = bench.run(&["sim", "a"]);
    assert_eq!(
        (said.code, said.errors.as_str()),
        (2, "error: a is a folder; `lineshaft sim --all a` plays its scenarios\n")
    );
    let object = bench.object(&["sim", "other.yaml"], 2);
    assert_eq!(object["errors"].as_array().map(Vec::len), Some(1));
    let said = bench.run(&["sim", "--scenario", "empty.scenario.yaml"]);
    assert_eq!(said.errors, "empty.scenario.yaml:2:7: cell is empty; the file of a cell is expected\n");
    assert_eq!(said.code, 2);
}

#[test]
fn arguments_that_exclude_each_other_are_refused_by_name() {
    let bench = two();
    for (more, name) in [
        (&["--record", "run.mcap"][..], "--record <PATH>"),
        (&["--max-bag-size", "5"][..], "--max-bag-size <BYTES>"),
        (&["--csv", "a.csv"][..], "--csv <FILE>"),
        (&["--events"][..], "--events"),
        (&["--store", "s.yaml"][..], "--store <FILE|none>"),
        (&["--scenario", "b.scenario.yaml"][..], "--scenario <FILE>"),
        (&["a/ok.yaml"][..], "[CELL]"),
    ] {
        let said = bench.run(&[&["sim", "--all", "."], more].concat());
        assert_eq!((said.code, said.out.as_str()), (2, ""), "{more:?}");
        assert!(said.errors.contains("--all <DIR>") && said.errors.contains(name), "{more:?}: {}", said.errors);
    }
    let said = bench.run(&["sim", "--scenario", "b.scenario.yaml", "--jobs", "2"]);
    assert!(said.code == 2 && said.errors.contains("--jobs <N>"), "{}", said.errors);
    let said = bench.run(&["sim", "--scenario", "b.scenario.yaml", "--json", "--events"]);
    assert!(said.code == 2 && said.errors.contains("--json") && said.errors.contains("--events"), "{}", said.errors);
}

/// After a path by mistake, the file that would be lost is kept.
#[test]
fn reports_and_traces_do_not_replace_cells_tables_and_bags() {
    let bench = two();
    bench.write("run.mcap", "a bag");
    let play = ["sim", "--scenario", "a/ok.scenario.yaml"];
    for (option, file, ending) in [
        ("--junit", "a/ok.yaml", "yaml"),
        ("--csv", "a/ok.yaml", "yaml"),
        ("--csv", "run.mcap", "mcap"),
        ("--junit", "run.mcap", "mcap"),
    ] {
        let before = bench.read(file);
        let said = bench.run(&[&play[..], &[option, file]].concat());
        assert_eq!(said.code, 2, "{option} {file}");
        let sentence = format!("never replaces a .{ending} file; name another file");
        assert!(said.errors.contains(file) && said.errors.contains(&sentence), "{}", said.errors);
        assert_eq!(bench.read(file), before);
    }
    let said = bench.run(&["validate", "run.mcap", "--against", "run.mcap", "--junit", "run.mcap"]);
    assert_eq!((said.code, bench.read("run.mcap").as_str()), (2, "a bag"), "{}", said.errors);
    // A trace may replace an older one, but no table of the cell.
    bench.write("a/ok.yaml", &format!("{CELL}tables: {{curve: {{form: y, csv: curve.csv}}}}\n"));
    bench.write("a/curve.csv", "0\n1\n0\n");
    bench.write("a/trace.csv", "old\n");
    let said = bench.run(&[&play[..], &["--csv", "a/curve.csv"]].concat());
    let sentence = "cannot write the trace a/curve.csv: a/ok.yaml reads it; name another file";
    assert!(said.code == 2 && said.errors.contains(sentence), "{}", said.errors);
    assert_eq!(bench.read("a/curve.csv"), "0\n1\n0\n");
    assert_eq!(bench.run(&[&play[..], &["--csv", "a/trace.csv"]].concat()).code, 0);
    assert_ne!(bench.read("a/trace.csv"), "old\n");
}

#[test]
fn sim_json_has_verdicts_counts_and_problems() {
    let bench = two();
    let object = bench.object(&["sim", "--all", "."], 1);
    assert_eq!((&object["command"], &object["problems"]), (&json!("sim"), &json!([])));
    let counts = ["passed", "failed", "with_errors"].map(|field| object[field].as_u64());
    assert_eq!(counts, [Some(1), Some(1), Some(0)]);
    let [good, bad] = [&object["scenarios"][0], &object["scenarios"][1]];
    assert_eq!((&good["verdict"], &bad["verdict"]), (&json!("passed"), &json!("failed")));
    assert_eq!((&good["cell_file"], &bad["cell_file"]), (&json!("./a/ok.yaml"), &json!("./a/ok.yaml")));
    assert_eq!((&good["cycles"], &good["cycle_ns"], &good["name"]), (&json!(50), &json!(2_000_000), &json!("0 mm")));
    let failure = &bad["failures"][0];
    assert_eq!(
        (&failure["file"], &failure["line"], &failure["column"]),
        (&json!("./b.scenario.yaml"), &json!(5), &json!(5))
    );

    bench.write("a/ok.yaml", &CELL.replace("max_velocity: 100 mm/s", "max_velocty: 100 mm/s"));
    let object = bench.object(&["sim", "--scenario", "b.scenario.yaml"], 2);
    assert_eq!((&object["with_errors"], &object["scenarios"][0]["verdict"]), (&json!(1), &json!("error")));
    let problem = &object["problems"][0];
    assert_eq!((&problem["file"], &problem["line"], &problem["column"]), (&json!("a/ok.yaml"), &json!(11), &json!(7)));
    assert_eq!(problem["hint"], "did you mean `max_velocity`?");
    assert!(
        problem["message"].as_str().is_some_and(|text| text.starts_with("unknown key `max_velocty` in ")),
        "{problem}"
    );
    assert_eq!(object["scenarios"][0]["problems"][0], *problem);
}

#[test]
fn check_json_lists_the_parts_of_a_cell() {
    let bench = two();
    let object = bench.object(&["check", "a/ok.yaml", "--scenario", "a/ok.scenario.yaml"], 0);
    let cell = json!({
        "file": "a/ok.yaml", "cycle_ns": 2_000_000, "axes": 2, "encoders": 0, "inputs_and_outputs": 2, "memory_cells": 1,
        "functions": 0, "masters": 0, "tables": 0, "joint_names": {"x": "Feeder"}
    });
    assert_eq!((&object["command"], &object["cell"], &object["graph"]), (&json!("check"), &cell, &Value::Null));
    assert_eq!(object["scenario"], json!({"file": "a/ok.scenario.yaml", "name": "0 mm", "cycles": 50}));
    assert_eq!((&object["problems"], &object["errors"]), (&json!([]), &json!([])));
    let object = bench.object(&["check", "none.yaml"], 2);
    let problem = &object["problems"][0];
    assert_eq!((&problem["file"], &problem["line"], &object["cell"]), (&json!("none.yaml"), &json!(1), &Value::Null));
}

#[test]
fn recordings_are_described_replayed_and_compared_in_json() {
    let bench = two();
    let record = |name: &str| {
        let said = bench.run(&["sim", "--scenario", "a/ok.scenario.yaml", "--record", name]);
        assert_eq!(said.code, 0, "{}{}", said.out, said.errors);
    };
    record("run.mcap");
    record("expected.mcap");
    let bytes = bench.path().join("run.mcap").metadata().unwrap().len();
    let info = bench.object(&["bag", "info", "run.mcap"], 0);
    assert_eq!(
        (&info["command"], &info["run"], &info["bytes"]),
        (&json!("bag info"), &json!("run.mcap"), &json!(bytes))
    );
    assert_eq!(info["files"], json!([{"file": "run.mcap", "bytes": bytes}]));
    // Cycle 49 of 2 ms is at 98 ms.
    assert_eq!((&info["start_ns"], &info["end_ns"]), (&json!(0), &json!(98_000_000)));
    assert_eq!(info["cycles"], json!({"first": 0, "last": 49, "lost": 0}));
    assert_eq!(
        (&info["replayable"], &info["not_replayable_because"], &info["finished"]),
        (&json!(true), &Value::Null, &json!(true))
    );
    assert_eq!((&info["profile"], &info["cuts"]), (&json!("ros2"), &json!([])));
    let topics = info["topics"].as_array().unwrap();
    let joints = topics.iter().find(|topic| topic["topic"] == "/joint_states").unwrap();
    assert_eq!((&joints["type"], &joints["encoding"]), (&json!("sensor_msgs/msg/JointState"), &json!("cdr")));
    let sum: u64 = topics.iter().filter_map(|topic| topic["messages"].as_u64()).sum();
    assert_eq!(info["messages"], json!(sum));
    let cell = info["attachments"].as_array().unwrap().iter().find(|attachment| attachment["name"] == "cell.yaml");
    assert_eq!(cell.map(|cell| &cell["bytes"]), Some(&json!(CELL.len())));

    let replay = bench.object(&["replay", "run.mcap"], 0);
    assert_eq!(
        (&replay["verdict"], &replay["first_cycle"], &replay["cycles"]),
        (&json!("same"), &json!(0), &json!(50))
    );
    assert_eq!((&replay["difference"], &replay["gap"]), (&Value::Null, &Value::Null));
    assert!(replay["values"].as_u64().is_some_and(|values| values >= 50), "{replay}");

    let same = bench.object(&["validate", "run.mcap", "--against", "expected.mcap", "--junit", "v.xml"], 0);
    assert_eq!(
        (&same["passed"], &same["run"], &same["expected"]),
        (&json!(true), &json!("run.mcap"), &json!("expected.mcap"))
    );
    let signals = same["signals"].as_array().unwrap();
    let feeder = signals.iter().find(|signal| signal["signal"] == "Feeder.actual.position").unwrap();
    assert_eq!((&feeder["passed"], &feeder["deviation"], &feeder["failures"]), (&json!(true), &json!(0.0), &json!([])));
    let text = bench.read("v.xml");
    let report = Document::parse(&text).unwrap();
    let suite = report.root_element().first_element_child().unwrap();
    assert_eq!(suite.attribute("tests"), Some(signals.len().to_string().as_str()));
    assert_eq!(
        (suite.attribute("failures"), suite.attribute("name")),
        (Some("0"), Some("run.mcap against expected.mcap"))
    );

    for (arguments, command) in [
        (&["replay", "none.mcap"][..], "replay"),
        (&["bag", "info", "none.mcap"][..], "bag info"),
        (&["validate", "none.mcap", "--against", "x"][..], "validate"),
    ] {
        let object = bench.object(arguments, 2);
        assert_eq!(object["command"], command);
        assert_eq!(object["errors"], json!(["none.mcap: No such file or directory (os error 2)"]));
    }
}

#[test]
fn junit_has_a_suite_for_each_scenario_and_a_case_for_each_expectation() {
    let bench = two();
    bench.write("c.scenario.yaml", &scenario("", "0 mm"));
    let said = bench.run(&["sim", "--all", ".", "--junit", "out.xml"]);
    assert_eq!(said.code, 2);
    let text = bench.read("out.xml");
    let report = Document::parse(&text).unwrap_or_else(|error| panic!("{error}: {text}"));
    let root = report.root_element();
    let attributes = ["tests", "failures", "errors"].map(|name| root.attribute(name).unwrap());
    // Two scenarios have a case for their steps and one for their expectation; the third one has no cell.
    assert_eq!(attributes, ["5", "1", "1"]);
    let suites: Vec<Node<'_, '_>> = root.children().filter(|node| node.has_tag_name("testsuite")).collect();
    let names: Vec<_> = suites.iter().map(|suite| suite.attribute("name").unwrap()).collect();
    assert_eq!(names, ["./a/ok.scenario.yaml", "./b.scenario.yaml", "./c.scenario.yaml"]);
    let source = |suite: &Node<'_, '_>, place: usize| {
        let cases: Vec<_> = suite.children().filter(|node| node.has_tag_name("testcase")).collect();
        ["file", "line"].map(|name| cases[place].attribute(name).map(str::to_owned))
    };
    let at = |file: &str, line: Option<&str>| [Some(file.to_owned()), line.map(str::to_owned)];
    assert_eq!(source(&suites[0], 0), at("./a/ok.scenario.yaml", None));
    assert_eq!(source(&suites[1], 1), at("./b.scenario.yaml", Some("5")));
    assert_eq!(source(&suites[2], 0), at("./c.scenario.yaml", Some("1")));
    let failure = suites[1].descendants().find(|node| node.has_tag_name("failure")).unwrap();
    assert!(failure.text().unwrap().starts_with("./b.scenario.yaml:5:5: x.command.position is 0 "), "{text}");
    let error = suites[2].descendants().find(|node| node.has_tag_name("error")).unwrap();
    assert!(error.text().unwrap().starts_with("./c.scenario.yaml:1:1: the scenario has no cell"), "{text}");

    // A report that cannot be written is a failure.
    let said = bench.run(&["sim", "--all", "a", "--junit", "none/out.xml"]);
    assert!(said.code == 1 && said.errors.starts_with("error: --junit: "), "{}", said.errors);
}

/// Collects the names of all fields of an object, except those of `joint_names` and `lineshaft`, which are names of the
/// user and of the recorder.
fn fields(object: &Value, into: &mut std::collections::BTreeSet<String>) {
    match object {
        Value::Object(entries) => {
            for (name, value) in entries {
                into.insert(name.clone());
                if name != "joint_names" && name != "lineshaft" {
                    fields(value, into);
                }
            }
        }
        Value::Array(values) => values.iter().for_each(|value| fields(value, into)),
        _ => {}
    }
}

#[test]
fn every_field_is_in_the_page() {
    let bench = two();
    bench.write("bad.yaml", "lineshaft: 1\n");
    let recorded = bench.run(&["sim", "--scenario", "a/ok.scenario.yaml", "--record", "run.mcap"]);
    assert_eq!(recorded.code, 0, "{}", recorded.errors);
    let mut all = std::collections::BTreeSet::new();
    for (arguments, code) in [
        (&["check", "a/ok.yaml", "--scenario", "b.scenario.yaml"][..], 0),
        (&["check", "bad.yaml"][..], 2),
        (&["sim", "--all", "."][..], 1),
        (&["validate", "run.mcap", "--against", "run.mcap"][..], 0),
        (&["replay", "run.mcap"][..], 0),
        (&["bag", "info", "run.mcap"][..], 0),
    ] {
        fields(&bench.object(arguments, code), &mut all);
    }
    assert!(all.len() > 60, "{all:?}");
    let page = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/json.md")).unwrap();
    let is_in_page = |name: &String| page.contains(&format!("`{name}`")) || page.contains(&format!(".{name}`"));
    let missing: Vec<_> = all.iter().filter(|name| !is_in_page(name)).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn no_bar_is_drawn_in_a_pipe() {
    let bench = Bench::new(&[("cell.yaml", CELL)]);
    // Some seconds of calculation.
    let long = scenario("cell: cell.yaml\n", "0 mm").replace("cycles: 50", "cycles: 1500000");
    bench.write("long.yaml", &long);
    let said = bench.run(&["sim", "--scenario", "long.yaml"]);
    assert_eq!((said.code, said.errors.as_str()), (0, ""));
}

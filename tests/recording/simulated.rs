//! Tests `lineshaft sim --record`: the bag has the same contents as the CSV file of the same run.

use std::{
    env, fs,
    path::Path,
    process::{Command, Output},
};

use serde_json::{Value, json};

use super::bench::{Bench, CYCLES, count, demo, reads_in_time_order, root};
use crate::support::{
    bag_check::{bag_check, bag_check_fails},
    setup::python,
};

/// Data of the test cell for `against-csv`: the scales of its axes, and its inputs.
const CELL: [&str; 14] = [
    "--scale",
    "line=1/1000000",
    "--scale",
    "x=1/104857600",
    "--scale",
    "turret=2pi/36000",
    "--encoder",
    "belt",
    "--digital",
    "start",
    "--digital",
    "mark",
    "--analog",
    "tension",
];

#[track_caller]
fn compare(bench: &Bench, bag: &str) -> Value {
    let csv = bench.path("run.csv");
    bag_check(["against-csv", bag, &csv].into_iter().chain(CELL))
}

#[test]
fn every_value_of_a_file_is_that_of_the_csv() {
    let bench = Bench::new();
    let seen = compare(&bench, &bench.record("run.mcap"));
    assert_eq!(count(&seen, &["messages", "CycleInputs"]), CYCLES);
    assert_eq!(count(&seen, &["messages", "Signals"]), CYCLES);
    // 100 per second.
    assert_eq!(count(&seen, &["messages", "AxisStates"]), CYCLES / 10);
    assert_eq!(count(&seen, &["messages", "JointState"]), CYCLES / 10);
    // Injected events change the plant; each other step is a command, and each command has its response.
    assert_eq!(count(&seen, &["messages", "AppliedCommand"]), 12);
    assert!(count(&seen, &["messages", "Event"]) > 12, "{seen}");
    // Three axes of 43 signals each, three inputs, an encoder, the machine.
    assert!(count(&seen, &["compared", "Signals"]) > CYCLES * 130, "{seen}");
}

#[test]
fn every_value_of_a_folder_is_that_of_the_csv() {
    let bench = Bench::new();
    let bag = bench.record("bag");
    let seen = compare(&bench, &bag);
    assert_eq!(count(&seen, &["messages", "Signals"]), CYCLES);
    let files = bench.list("bag");
    assert_eq!(files.len(), 2, "one file and metadata.yaml: {files:?}");
}

/// Tests the comparison itself: it finds a wrong bit.
#[test]
fn comparison_finds_a_wrong_bit() {
    let bench = Bench::new();
    let bag = bench.record("run.mcap");
    let wrong = bench.path("wrong.mcap");
    bag_check([
        "flip",
        &bag,
        &wrong,
        "--topic",
        "/lineshaft/signals",
        "--cycle",
        "777",
        "--field",
        "word[0]",
        "--bit",
        "0",
    ]);
    let csv = bench.path("run.csv");
    let error = bag_check_fails(["against-csv", &wrong, &csv].into_iter().chain(CELL));
    assert!(error.contains("777"), "{error}");
}

#[test]
fn rosbags_reads_every_message_by_the_metadata() {
    let bench = Bench::new();
    let folder = bench.record("bag");
    bench.record("run.mcap");
    // A recording as a single file has a metadata.yaml in the same folder, too.
    for folder in [folder, bench.path("")] {
        let seen = bag_check(["rosbags", &folder]);
        let topics = [
            "/joint_states",
            "/lineshaft/axis_states",
            "/lineshaft/events",
            "/lineshaft/commands",
            "/lineshaft/inputs",
            "/lineshaft/signals",
        ];
        for topic in topics {
            assert!(count(&seen, &["counts", topic]) > 0, "{topic}");
        }
        assert_eq!(seen["start_ns"], 0);
        assert_eq!(count(&seen, &["end_ns"]), (CYCLES - 1) * 1_000_000);
    }
}

#[test]
fn rosbag2_reads_every_file_in_the_order_of_time() {
    let bench = Bench::new();
    let whole = reads_in_time_order([bench.record("run.mcap")]);
    let bag = bench.path("bag");
    let (cell, scenario) = (root("tests/recording/cell.yaml"), root("tests/recording/scenario.yaml"));
    bench
        .lineshaft(&["sim", &cell, "--scenario", &scenario, "--record", &bag, "--max-bag-duration", "1"])
        .expect_code(0);
    let files = bench.bag_files("bag");
    assert_eq!((files.len(), reads_in_time_order(&files)), (3, whole));
}

#[test]
fn mcap_ros2_support_reads_messages_attachments_and_records() {
    let bench = Bench::new();
    let seen = bag_check(["mcap", &bench.record("run.mcap")]);
    assert_eq!(seen["profile"], "ros2");
    assert_eq!(seen["schema_encoding"], json!(["ros2msg"]));
    assert_eq!(seen["message_encoding"], json!(["cdr"]));
    assert_eq!(seen["compression"], json!(["zstd"]));
    assert_eq!(seen["in_order"], true);
    assert_eq!(count(&seen, &["counts", "/lineshaft/inputs"]), CYCLES);

    let record = |name: &str| {
        let records = seen["records"].as_array().unwrap();
        records.iter().find(|record| record["record"] == name).unwrap_or_else(|| panic!("no record {name} in {seen}"))
    };
    assert_eq!(record("lineshaft")["cycle_ns"], "1000000");
    assert_eq!(record("lineshaft")["node"], "/lineshaft");
    assert_eq!(record("lineshaft")["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(record("lineshaft_end")["replayable"], "true");
    assert_eq!(record("lineshaft_end")["lost"], "0");

    let attachment = |name: &str| {
        let attachments = seen["attachments"].as_array().unwrap();
        attachments.iter().find(|one| one["name"] == name).cloned()
    };
    let cell = attachment("cell.yaml").expect("the cell is attached");
    assert_eq!(cell["sha256"], record("lineshaft")["cell_sha256"]);
    assert_eq!(count(&cell, &["size"]), fs::metadata(root("tests/recording/cell.yaml")).unwrap().len());
    assert!(count(&attachment("parameters.yaml").expect("the parameters are attached"), &["size"]) > 0);
    assert_eq!(attachment("machine_state"), None, "it begins at cycle 0");
}

#[test]
fn the_same_run_gives_the_same_bytes() {
    let (one, other) = (Bench::new(), Bench::new());
    for bag in ["run.mcap", "bag"] {
        one.record(bag);
        other.record(bag);
    }
    for name in ["run.mcap", "metadata.yaml", "bag/metadata.yaml"] {
        let read = |bench: &Bench| fs::read(bench.path(name)).unwrap();
        assert!(read(&one) == read(&other), "{name} differs");
    }
    let read =
        |bench: &Bench| bench.bag_files("bag").into_iter().map(|path| fs::read(path).unwrap()).collect::<Vec<_>>();
    assert!(read(&one) == read(&other), "the files of the folders differ");
}

#[test]
fn a_bag_is_never_written_over() {
    let bench = Bench::new();
    let bag = bench.record("bag");
    let before = fs::read(&bench.bag_files("bag")[0]).unwrap();
    let (cell, scenario) = (root("tests/recording/cell.yaml"), root("tests/recording/scenario.yaml"));
    bench.lineshaft(&["sim", &cell, "--scenario", &scenario, "--record", &bag]).expect_code(2).expect_text(&[&bag]);
    assert!(fs::read(&bench.bag_files("bag")[0]).unwrap() == before);
}

#[test]
fn a_place_that_cannot_be_written_is_one_sentence() {
    let bench = Bench::new();
    let file = bench.write("file", "");
    let (cell, scenario) = (root("tests/recording/cell.yaml"), root("tests/recording/scenario.yaml"));
    for place in [format!("{file}/bag"), format!("{file}/run.mcap"), bench.path("no/such/folder/run.mcap")] {
        let ended = bench.lineshaft(&["sim", &cell, "--scenario", &scenario, "--record", &place]);
        assert_eq!(ended.code, Some(2), "{place}: {}", ended.text);
        assert!(ended.text.contains(&bench.path("")), "{place}: {}", ended.text);
    }
}

#[test]
fn info_shows_the_contents_of_a_bag() {
    let bench = Bench::new();
    let bag = bench.record_scenario(&demo(), &root("launch-configs/scenarios/first_move.yaml"), "run.mcap");
    bench.lineshaft(&["bag", "info", &bag]).expect_code(0).expect_text(&[
        "/joint_states",
        "lineshaft_msgs/msg/CycleInputs",
        "7000",
    ]);
}

/// Tests the example of docs/recording.md, which reads ~/signals with rosbags.
#[test]
fn the_example_in_the_docs_reads_signals() {
    let bench = Bench::new();
    bench.record("run");
    fs::copy(root("tests/recording/cell.yaml"), bench.path("cell.yaml")).unwrap();
    let docs = fs::read_to_string(root("docs/recording.md")).unwrap();
    let example = docs.split("```python\n").nth(1).and_then(|rest| rest.split("```").next()).expect("an example");
    let script = bench.write("example.py", example);

    let program = Path::new(env!("CARGO_BIN_EXE_lineshaft")).parent().expect("a program is in a folder");
    let path = format!("{}:{}", program.display(), env::var("PATH").unwrap_or_default());
    let output = Command::new(python()).arg("-B").arg(script).env("PATH", path).current_dir(bench.path("")).output();
    let Output { status, stdout, stderr } = output.unwrap();
    assert!(status.success(), "{}", String::from_utf8_lossy(&stderr));

    let csv = fs::read_to_string(bench.path("run.csv")).unwrap();
    let (head, rows) = csv.split_once('\n').unwrap();
    let column = |name: &str| head.split(',').position(|column| column == name).unwrap();
    let columns = [0, column("x.command.position"), column("x.command.velocity")];
    let printed = String::from_utf8(stdout).unwrap();
    assert_eq!(printed.lines().count() as u64, CYCLES);
    for (line, row) in printed.lines().zip(rows.lines()) {
        let fields: Vec<_> = row.split(',').collect();
        let numbers = |texts: [&str; 3]| texts.map(|text| text.parse::<f64>().unwrap());
        let told: Vec<_> = line.split(' ').collect();
        assert_eq!(numbers([told[0], told[1], told[2]]), numbers(columns.map(|place| fields[place])), "{line}");
    }
}

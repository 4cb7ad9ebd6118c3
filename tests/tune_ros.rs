//! Tests `~/tune` with a client on Cyclone DDS, and `lineshaft tune` of a drive on a bus.

use crate::support::can::CanDrives;
use crate::support::can_cell::{CanCell, axis};
use crate::support::domain::Domain;
use crate::support::peer::Peer;
use crate::support::program::Program;
use serde_json::{Value, json};
use std::thread;
use std::time::{Duration, Instant};

const CELL: &str = include_str!("../launch-configs/torque.yaml");

const NOT_TUNED: u32 = 10248;
const CANCELLED: u32 = 10103;
const PARAMETERS: &str = "x.kprop x.kder x.kint x.ffvel x.ffacc x.velkprop x.velkint x.velkilim";

/// A node with the cell, and its client.
struct Node {
    cyclone: Peer,
    program: Program,
    folder: tempfile::TempDir,
}

impl Node {
    fn start() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name).to_str().expect("a path of text").to_owned();
        let virtual_axis = "  y: {type: rotary, drive: virtual, scale: {increments: 1000, per: 1 rev}, max_velocity: 1 rev/s, \
                            max_acceleration: 1 rev/s^2}\n";
        let cell = CELL.replace("backends:", "ros: {autostart: true}\nbackends:") + virtual_axis;
        std::fs::write(path("cell.yaml"), cell).expect("room for a file");
        let domain = Domain::take();
        let mut cyclone = Peer::cyclone(&domain);
        let args =
            ["run", &path("cell.yaml"), "--flight-recorder", "0", "--store", "none", "--record", &path("bag.mcap")];
        let program = Program::start(&args, &domain);
        // Returns when the service exists.
        cyclone.run("lifecycle /lineshaft state");
        cyclone.run("axis-states /lineshaft");
        Self { cyclone, program, folder }
    }

    fn state(&mut self) -> Value {
        self.cyclone.run("axis-states /lineshaft")["axes"]["x"]["state"].clone()
    }

    fn values(&mut self) -> Value {
        self.cyclone.run(&format!("params /lineshaft get {PARAMETERS}"))["get"].clone()
    }
}

/// A goal finds gains and sets them on request; its feedback reports the phases in their order, and the run replays.
#[test]
fn goal_finds_gains_and_sets_them_on_request() {
    let mut node = Node::start();
    let before = node.values();
    let line = "tune /lineshaft --axis x --units axis_unit --travel 2 --velocity 8 --effort 0.25 --duration 3";
    let found = node.cyclone.run(line);
    assert_eq!((&found["code"], &found["message"], &found["applied"]), (&json!(0), &json!(""), &json!(false)));
    // Enabling and disabling may be shorter than the interval of two messages.
    let phases: Vec<_> = found["phases"].as_array().expect("a list").iter().filter_map(Value::as_str).collect();
    let mut all = ["enabling", "exciting", "disabling", "designing"].into_iter();
    assert!(phases.iter().all(|phase| all.any(|next| next == *phase)), "each once, in their order: {phases:?}");
    assert!(phases.contains(&"exciting") && phases.contains(&"designing"), "{phases:?}");
    let numbers = |key: &str| -> Vec<f64> {
        found[key].as_array().expect("a list").iter().map(|number| number.as_f64().expect("a number")).collect()
    };
    let (progress, positions, velocities) = (numbers("progress"), numbers("positions"), numbers("velocities"));
    assert!(progress.is_sorted() && progress.last() == Some(&1.0), "{progress:?}");
    // Two turns plus a quarter of that distance, from the start; 8 rev/s plus the increase of a fifth of a second.
    let turn = std::f64::consts::TAU;
    let way = positions.iter().map(|position| (position - positions[0]).abs()).fold(0.0, f64::max);
    assert!(way > 0.2 * turn && way < 2.5 * turn, "{way} rad");
    let fastest = velocities.iter().copied().map(f64::abs).fold(0.0, f64::max);
    assert!(fastest > turn && fastest < 10.0 * turn, "{fastest} rad/s");
    let report = found["report"].as_str().expect("a text");
    assert!(report.contains("axis x, 65536 inc in 1 rev") && report.contains("phase margin"), "{report}");
    assert_eq!(node.state(), "DISABLED");
    assert_eq!(node.values(), before, "nothing is set unasked");

    let found = node.cyclone.run(&format!("{line} --apply"));
    assert_eq!((&found["code"], &found["applied"]), (&json!(0), &json!(true)));
    let set = node.values();
    assert_ne!(set, before);
    let gains = found["parameters"].as_object().expect("gains by their names");
    for (name, value) in gains {
        let read = node.cyclone.run(&format!("params /lineshaft get {name}"));
        assert_eq!(&read["get"][0], value, "{name}");
    }
    // With these gains the axis moves.
    node.cyclone.run("axes /lineshaft enable x");
    node.cyclone.run("move /lineshaft --axis x --mode relative --position 3 --velocity 20 --acceleration 50 --wait");
    node.program.end();
    let bag = node.folder.path().join("bag.mcap");
    let replayed = std::process::Command::new(env!("CARGO_BIN_EXE_lineshaft")).arg("replay").arg(bag).output();
    assert_eq!(replayed.expect("the program starts").status.code(), Some(0));
}

/// One goal at a time; cancel and halt end it with the axis disabled; an invalid goal is rejected before any motion.
#[test]
fn goals_are_rejected_cancelled_and_ended_by_a_halt() {
    let mut node = Node::start();
    // A separate thread writes the log: a line may be written after the answer.
    let log = |node: &Node, part: &str| {
        let begin = Instant::now();
        while !node.program.log().contains(part) {
            assert!(begin.elapsed() < Duration::from_secs(10), "{part}: {}", node.program.log());
            thread::sleep(Duration::from_millis(10));
        }
    };
    for (more, part) in [
        ("--axis z", "no axis is called `z`; there are x, y"),
        ("--axis y", "y: no loop of it is closed here (the axis is virtual)"),
        ("--axis x --travel nan", "travel"),
        ("--axis x --travel -1", "x: travel is -"),
        ("--axis x --velocity 400", "x: velocity is "),
        ("--axis x --effort 2", "x: effort is 2 of the largest effort; 0.01 to 1"),
        ("--axis x --duration 61", "x: duration is 61 s; 1 to 60"),
        ("--axis x --units 7", "units"),
    ] {
        node.cyclone.fails(&format!("tune /lineshaft {more}"));
        log(&node, part);
    }
    assert_eq!(node.state(), "DISABLED");

    node.cyclone.run("tune /lineshaft --axis x --until exciting --progress 0.05 --leave");
    node.cyclone.fails("tune /lineshaft --axis x");
    log(&node, "x is being tuned; one axis at a time");
    node.cyclone.run("move /lineshaft --axis x --mode relative --position 1 --wait --expect ABORTED");
    node.cyclone.run("axes /lineshaft halt x");
    node.cyclone.until_axis("x", "a halt ends it, and its end switches the axis off", |x| x["state"] == "DISABLED");

    let ended =
        node.cyclone.run("tune /lineshaft --axis x --until exciting --progress 0.05 --cancel --expect CANCELED");
    assert_eq!((&ended["code"], &ended["parameters"]), (&json!(CANCELLED), &json!({})));
    assert_eq!(ended["message"], "x: it was stopped before its end");
    assert_eq!(node.state(), "DISABLED");

    // An effort below the friction: nothing is found.
    let stuck = node.cyclone.run("tune /lineshaft --axis x --effort 0.01 --velocity 0.5 --expect ABORTED");
    assert_eq!(stuck["code"], json!(NOT_TUNED));
    assert!(stuck["message"].as_str().expect("a sentence").starts_with("x: "), "{stuck:?}");
    assert_eq!(node.state(), "DISABLED");
    node.program.end();
}

/// A drive of an independent implementation on a bus: it is tuned only with permission, its gains are found, and Ctrl-C
/// stops it.
#[test]
fn real_drive_is_tuned_only_with_permission() {
    let mut drives = CanDrives::boot("1");
    let keys = ", min_position: -1 m, max_position: 1 m";
    let cell = CanCell::new(&drives.address().to_string(), "4 ms", &axis("v", 1, ", interface: velocity", keys));
    let file = cell.path("cell.yaml");
    let tune = |more: &[&str]| {
        let line = [&["tune", &file, "v", "--travel", "60 mm", "--velocity", "50 mm/s"], more].concat();
        Program::start(&line, &Domain::take())
    };
    let before = drives.shown(1).position;
    let mut refused = tune(&[]);
    assert_eq!(refused.wait_exit(Duration::from_secs(30)).code(), Some(2), "{}", refused.log());
    let sentence = "v hangs on a real drive, or runs beside one: tuning shakes it with about 0.05 m/s, and stops it 0.075 m either side of where it stands, by its \
                    drive; no loop holds it meanwhile, and a load that hangs falls; --real permits that";
    assert!(refused.log().contains(sentence), "{}", refused.log());
    assert_eq!(drives.shown(1).position, before);

    let mut effort = tune(&["--real", "--effort", "0.1"]);
    assert_eq!(effort.wait_exit(Duration::from_secs(30)).code(), Some(2), "{}", effort.log());
    assert!(effort.log().contains("v: effort bounds a drive that takes efforts"), "{}", effort.log());

    let mut found = tune(&["--real"]);
    assert_eq!(found.wait_exit(Duration::from_secs(120)).code(), Some(0), "{}", found.log());
    let report = found.log();
    assert!(report.contains("position_loop.kv") && report.contains("phase margin"), "{report}");
    let shown = drives.shown(1);
    assert!(shown.is_off() && (shown.position - before).abs() <= 75_000, "{shown:?}");

    let mut stopped = tune(&["--real", "--duration", "30 s"]);
    let begin = Instant::now();
    let moves = |drives: &mut CanDrives| drives.shown(1).is_enabled() && drives.shown(1).velocity != 0;
    while !moves(&mut drives) {
        assert!(begin.elapsed() < Duration::from_secs(60), "{:?}; {}", drives.shown(1), stopped.log());
        thread::sleep(Duration::from_millis(20));
    }
    stopped.interrupt();
    assert_eq!(stopped.wait_exit(Duration::from_secs(30)).code(), Some(1), "{}", stopped.log());
    assert!(stopped.log().contains("v: it was stopped before its end"), "{}", stopped.log());
    assert!(drives.shown(1).is_off(), "{:?}", drives.shown(1));
}

//! Tests `~/probe_axis` on an active input, `~/touch_probe`, `~/abort_trigger`, and `~/set_position` of a moving axis
//! with a client on Cyclone DDS (`~/probe_axis` also with one on Fast DDS), and the replay of a recording.

use std::{fs, process::Command};

use crate::support::{domain::Domain, peer::Peer, program::Program};
use serde_json::{Value, json};

const PROBE_INPUT_ACTIVE: u32 = 10270;

/// A sensor detects marks along x, 2 mm long, that begin at 5 mm, 15 mm, 25 mm..
const CELL: &str = "
lineshaft: 1
cycle: 1 ms
backends: {plant: {type: sim}}
io:
  mark: {type: di, backend: plant, address: 0, latch: true, sim: {marks: {of: x, every: 10 mm, first: 5 mm, width: 2 mm}}}
  door: {type: di, backend: plant, address: 1}
axes:
  x: {type: linear, unit: mm, scale: {increments: 1000, per: 1 mm}, drive: {backend: plant, address: 0, interface: position},
      max_position: 1000 m, max_velocity: 100 mm/s, max_acceleration: 1 m/s^2, sim: {model: ideal}}
  y: {type: linear, unit: mm, scale: {increments: 1000, per: 1 mm}, drive: {backend: plant, address: 1, interface: position},
      max_velocity: 100 mm/s, max_acceleration: 1 m/s^2, sim: {model: ideal}}
";

struct Node {
    cyclone: Peer,
    program: Program,
    domain: Domain,
    folder: tempfile::TempDir,
}

impl Node {
    /// Starts the node with its axes enabled.
    fn start(args: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("cell.yaml"), CELL).expect("room for a file");
        let path = |arg: &str| arg.replace("BENCH", folder.path().to_str().expect("a path of text"));
        let all = ["run", "BENCH/cell.yaml", "--store", "none", "--flight-recorder", "0"].iter().chain(args);
        let all: Vec<String> = all.map(|arg| path(arg)).collect();
        let domain = Domain::take();
        let mut cyclone = Peer::cyclone(&domain);
        let program = Program::start(&all.iter().map(String::as_str).collect::<Vec<_>>(), &domain);
        cyclone.run("axis-states /lineshaft");
        cyclone.run("events /lineshaft");
        cyclone.run("axes /lineshaft enable");
        Self { cyclone, program, domain, folder }
    }

    fn axis(&mut self, axis: &str) -> Value {
        self.cyclone.run("axis-states /lineshaft")["axes"][axis].clone()
    }

    #[track_caller]
    fn moves(&mut self, to: f64) {
        self.cyclone.run(&format!("move /lineshaft --axis x --position {to} --wait"));
    }

    #[track_caller]
    fn refuses(&mut self, request: &str, sentence: &str) {
        let error = self.cyclone.fails(request);
        assert!(error.contains(sentence), "{request}: {error}");
    }

    /// Returns the events of a kind of x since the last call: exactly `count`, and no more within 0.3 s.
    #[track_caller]
    fn events(&mut self, kind: &str, count: usize) -> Vec<Value> {
        let mut found = Vec::new();
        for seconds in [0.3, 2.0, 20.0] {
            let seen = self.cyclone.run(&format!("events /lineshaft --seconds {seconds}"));
            let all = seen.all().iter().filter_map(|one| one.get("message"));
            found.extend(all.filter(|one| one["kind"] == kind && one["source"] == "x").cloned());
            if found.len() >= count {
                break;
            }
        }
        assert_eq!(found.len(), count, "{kind}: {found:?}");
        found
    }
}

/// Checks the positions of events (inc), with the rounding error of linear interpolation within a cycle.
#[track_caller]
fn are_at(events: &[Value], places: &[i64]) {
    let told: Vec<i64> = events.iter().map(|event| event["increments"].as_i64().expect("increments")).collect();
    let is_near = |(told, place): (&i64, &i64)| (told - place).abs() <= 1;
    assert!(told.len() == places.len() && told.iter().zip(places).all(is_near), "{told:?} instead of {places:?}");
}

#[test]
fn a_probe_of_an_active_input_is_refused_before_motion_and_may_be_allowed() {
    let mut node = Node::start(&[]);
    node.moves(0.006);
    let probe = "probe /lineshaft --axis x --event mark --position 0.05 --velocity 0.05";
    let seen = node.cyclone.run(&format!("{probe} --expect ABORTED"));
    let sentence = "x: probe input is already active: mark is 1, allowed 0 before a rising edge";
    assert_eq!(seen["result"]["code"], PROBE_INPUT_ACTIVE, "{seen:?}");
    assert!(seen["result"]["message"].as_str().expect("a sentence").starts_with(sentence), "{seen:?}");
    let x = node.axis("x");
    assert_eq!((&x["state"], &x["command_increments"]), (&json!("STANDSTILL"), &json!(6_000)), "{x}");
    // Searches for the next possible edge of the input: the mark ends at 7 mm.
    let seen = node.cyclone.run(&format!("{probe} --edge falling"));
    let probed = seen["result"]["probed_increments"].as_i64().expect("increments");
    assert!(seen["result"]["probed"] == true && (probed - 7_000).abs() <= 1, "{seen:?}");

    node.moves(0.006);
    node.cyclone.run("params /lineshaft set x.probe_active_input=allow");
    let seen = node.cyclone.run(probe);
    let probed = seen["result"]["probed_increments"].as_i64().expect("increments");
    assert!((probed - 15_000).abs() <= 1, "the next mark: {seen:?}");
}

/// A client on Fast DDS, the default of ROS 2, sends goals and gets feedback, results and refusals.
#[test]
fn probe_from_fast_dds_finds_its_mark_and_is_refused_on_an_active_input() {
    let node = Node::start(&[]);
    let mut fast = Peer::fastdds(&node.domain);
    let probe = "probe /lineshaft --axis x --event mark --position 0.05 --velocity 0.05";
    let near = |value: &Value, place: i64| (value.as_i64().expect("increments") - place).abs() <= 1;
    // The first mark begins at 5 mm; 1 mm further the input is active.
    let seen = fast.run(&format!("{probe} --distance 0.001"));
    let result = &seen["result"];
    assert_eq!(
        (&result["code"], &result["message"], &result["probed"]),
        (&json!(0), &json!(""), &json!(true)),
        "{seen:?}"
    );
    assert!(near(&result["probed_increments"], 5_000) && near(&result["position_increments"], 6_000), "{seen:?}");
    let [probed, position] = ["probed_position", "position"].map(|key| result[key].as_f64().expect("a position"));
    assert!((probed - 0.005).abs() < 2e-6 && (position - 0.006).abs() < 2e-6, "{seen:?}");
    let phases = seen["phases"].as_array().expect("a list");
    assert_eq!(phases.last(), Some(&json!(1)), "it reports that it has found it: {phases:?}");

    let seen = fast.run(&format!("{probe} --expect ABORTED"));
    let (result, sentence) = (&seen["result"], "x: probe input is already active: mark is 1, allowed 0");
    assert_eq!((&result["code"], &result["probed"]), (&json!(PROBE_INPUT_ACTIVE), &json!(false)), "{seen:?}");
    assert!(result["message"].as_str().expect("a sentence").starts_with(sentence), "{seen:?}");
    // The mark ends at 7 mm.
    let seen = fast.run(&format!("{probe} --edge falling"));
    assert!(near(&seen["result"]["probed_increments"], 7_000), "{seen:?}");
    assert_eq!(fast.fails(&probe.replace("--axis x", "--axis q")), "the goal was rejected");
}

#[test]
fn a_touch_probe_records_marks_while_the_axis_moves() {
    let mut node = Node::start(&[]);
    node.cyclone.run("touch-probe /lineshaft --axis x --event mark");
    node.cyclone.run("touch-probe /lineshaft --axis y --event mark --continuous");
    node.moves(0.04);
    let told = node.events("latch", 1);
    are_at(&told, &[5_000]);
    assert!(
        told[0]["text"].as_str().expect("a text").starts_with("x: touch probe: rising edge of mark at "),
        "{told:?}"
    );
    assert_eq!(told[0]["value"], 1.0);

    // In negative direction, within 10 to 31 mm: each mark begins where it ends in positive direction.
    let window = "--first-position 10 --last-position 31 --units axis_unit --window-only";
    node.cyclone.run(&format!("touch-probe /lineshaft --axis x --event mark --edge both --continuous {window}"));
    node.moves(0.0);
    let told = node.events("latch", 4);
    are_at(&told, &[27_000, 25_000, 17_000, 15_000]);
    assert_eq!(told.iter().map(|event| event["value"].clone()).collect::<Vec<_>>(), [1.0, 0.0, 1.0, 0.0]);
    node.cyclone.run("abort-trigger /lineshaft --axis x --event mark");
    let done = node.events("done", 1);
    assert_eq!(done[0]["code"], 10_103, "{done:?}");
    node.moves(0.04);
    node.events("latch", 0);

    node.refuses("abort-trigger /lineshaft --axis x --event mark", "x: no touch probe is armed for mark");
    node.refuses("touch-probe /lineshaft --axis q --event mark", "no axis is called `q`");
    node.refuses("touch-probe /lineshaft --axis x --event door", "`door` does not latch; mark, x, y can");
    node.refuses("touch-probe /lineshaft --axis x --event mark --edge 7", "edge is 7; 0 RISING, 1 FALLING");
    node.refuses("touch-probe /lineshaft --axis x --event mark --units 9", "units is 9");
    node.refuses("touch-probe /lineshaft --axis x --event mark --first-position nan --window-only", "first_position");
    node.refuses(
        "touch-probe /lineshaft --axis x --event mark --first-position 0.02 --last-position 0.01 --window-only",
        "x: first_position 20 mm exceeds last_position 10 mm",
    );
    node.refuses("touch-probe /lineshaft --axis x --event mark --last-position 0.01", "window_only is 0");
}

#[test]
fn an_axis_that_moves_gets_another_position_where_nothing_refers_to_the_old_one() {
    let mut node = Node::start(&[]);
    let goal = node.cyclone.run("move /lineshaft --axis x --mode velocity --velocity 0.02")["goal"].clone();
    node.cyclone.until_axis("x", "is at its velocity", |x| x["in_velocity"] == true);
    let place = |x: &Value| x["command_increments"].as_i64().expect("increments");
    node.cyclone.run("set-position /lineshaft --axis x --position 100");
    let x = node.cyclone.until_axis("x", "has its new position", |x| place(x) >= 100_000_000);
    assert_eq!((&x["state"], &x["command_velocity"]), (&json!("CONTINUOUS_MOTION"), &json!(0.02)), "{x}");
    node.cyclone.run("set-position /lineshaft --axis x --position -100 --relative");
    let x = node.cyclone.until_axis("x", "has its old position", |x| place(x) < 100_000_000);
    // 20 inc in each cycle from the first request on, for a minute at most.
    assert!((0..2_400_000).contains(&place(&x)) && x["following_error_increments"] == 0, "{x}");
    node.refuses("set-position /lineshaft --axis mark --position 1 --relative", "no axis is called `mark`");
    node.cyclone.run("touch-probe /lineshaft --axis x --event mark --continuous --last-position 1 --window-only");
    node.refuses(
        "set-position /lineshaft --axis x --position 0",
        "x: a touch probe with a window refers to the present coordinate of the axis; wait for its end, or end it first",
    );
    node.cyclone.run(&format!("cancel /lineshaft move_axis {}", goal.as_str().expect("an id")));
    node.cyclone.until_axis("x", "stands", |x| x["state"] == "STANDSTILL");
    node.cyclone.run("abort-trigger /lineshaft --axis x");
    node.cyclone.run("move /lineshaft --axis x --mode relative --position 1");
    node.refuses(
        "set-position /lineshaft --axis x --position 0",
        "x: a goal to a target refers to the present coordinate",
    );
}

#[test]
fn a_run_with_all_of_them_replays() {
    let mut node = Node::start(&["--record", "BENCH/run.mcap"]);
    node.cyclone.run("touch-probe /lineshaft --axis x --event mark --continuous --last-position 0.1 --window-only");
    node.moves(0.04);
    node.cyclone.run("abort-trigger /lineshaft --axis x");
    node.cyclone.run("move /lineshaft --axis x --mode velocity --velocity 0.02");
    node.cyclone.run("set-position /lineshaft --axis x --position 3");
    node.cyclone.run("set-position /lineshaft --axis x --position 0.5 --relative");
    node.cyclone.run("axes /lineshaft halt x");
    node.program.end();
    let bag = node.folder.path().join("run.mcap");
    let replay = Command::new(env!("CARGO_BIN_EXE_lineshaft")).arg("replay").arg(&bag).output().expect("it starts");
    let text = String::from_utf8_lossy(&replay.stdout).into_owned() + &String::from_utf8_lossy(&replay.stderr);
    assert_eq!(replay.status.code(), Some(0), "{text}");
}

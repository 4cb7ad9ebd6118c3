//! Tests couplings that begin at a position or mark, and their refusals, from a client on Cyclone DDS, with
//! launch-configs/shear.yaml.

use std::path::Path;

use crate::support::{domain::Domain, peer::Peer, program::Program};
use serde_json::{Value, json};

struct Web {
    cyclone: Peer,
    _program: Program,
}

impl Web {
    fn start() -> Self {
        let cell = Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs/shear.yaml");
        let cell = cell.to_str().expect("a path of text");
        let domain = Domain::take();
        let mut cyclone = Peer::cyclone(&domain);
        let program = Program::start(&["run", cell, "--store", "none", "--flight-recorder", "0"], &domain);
        cyclone.run("axis-states /lineshaft");
        cyclone.run("axes /lineshaft enable shear");
        Self { cyclone, _program: program }
    }

    /// Returns the state of the shear, and the commands of web and shear in one cycle.
    fn seen(&mut self) -> (Value, [i64; 2]) {
        let axes = self.cyclone.run("axis-states /lineshaft")["axes"].clone();
        let command = |axis: &str| axes[axis]["command_increments"].as_i64().expect("increments");
        (axes["shear"]["state"].clone(), ["web", "shear"].map(command))
    }
}

/// The cell has one digital input, which latches.
#[test]
fn marks_of_an_input_that_does_not_exist_are_refused_with_its_name() {
    let mut web = Web::start();
    web.cyclone.run("params /lineshaft set shear.syncmpulsm=10000 shear.syncmpulss=10000");
    let marker = "synchronize /lineshaft --axis shear --master web --mode marker --expect ABORTED";
    for (set, side, number) in [
        ("shear.syncmtypm=52 shear.syncmtyps=12", "syncmtypm", 5),
        ("shear.syncmtypm=12 shear.syncmtyps=72", "syncmtyps", 7),
    ] {
        web.cyclone.run(&format!("params /lineshaft set {set}"));
        let result = web.cyclone.run(marker)["result"].clone();
        let sentence = format!("{side} names digital input {number}, which the cell does not have");
        assert_eq!(result["code"], 10_037, "{result}");
        assert!(result["message"].as_str().expect("a sentence").contains(&sentence), "{result}");
        assert_eq!(web.seen(), (json!("STANDSTILL"), [0, 0]));
    }
}

/// The shear waits for the web, moves 5 mm while the web moves 10, and then follows the pair of positions: shear - 5000
/// = web - 40000.
#[test]
fn a_gear_meets_a_pair_of_places() {
    let mut web = Web::start();
    let gear = "synchronize /lineshaft --axis shear --master web --engage at_position --master-increments 40000 --slave-increments 5000";
    let said = web.cyclone.fails(&format!("{gear} --offset 0.001"));
    let log = web.cyclone.run("log --seconds 1");
    assert!(format!("{said}{log:?}").contains("offset"), "{said} {log:?}");
    assert_eq!(web.seen(), (json!("STANDSTILL"), [0, 0]));
    // 10 inc per cycle: 3 s until it begins, 1 s until it is in gear.
    web.cyclone.run("move /lineshaft --axis web --mode velocity --velocity 0.01");
    let seen = web.cyclone.run(&format!("{gear} --start-distance-increments 10000"));
    assert_eq!(seen["order"], json!([0, 1, 2]), "WAITING, CATCHING_UP, SYNCHRONIZED");
    assert_eq!(seen["feedback"]["sync_error_increments"], 0);
    for _ in 0..10 {
        let (state, [leader, shear]) = web.seen();
        assert!(state == "SYNCHRONIZED_MOTION" && leader >= 40_000, "{state} {leader}");
        assert_eq!(shear - 5_000, leader - 40_000);
    }
    for (place, shear) in [(60_000, 25_000), (45_000, 10_000)] {
        web.cyclone.run(&format!("move /lineshaft --axis web --units increments --position {place} --wait"));
        assert_eq!(web.seen(), (json!("SYNCHRONIZED_MOTION"), [place, shear]));
    }
}

/// The web moves 10 inc per cycle, the shear 5; it leaves its gear when the web is at 20000, stops or continues, and
/// its goal succeeds. With the option in the goal itself it leaves when the shear is at 30000. Invalid requests are
/// refused by name, and end nothing.
#[test]
fn a_gear_is_left_at_a_place() {
    let mut web = Web::start();
    let refused = |web: &mut Web, arguments: &str, sentence: &str| {
        let said = web.cyclone.fails(&format!("gear-out /lineshaft {arguments}"));
        assert!(said.contains(sentence), "{said}");
    };
    refused(&mut web, "--axis shear", "shear: no goal of synchronize couples the axis");
    refused(&mut web, "--axis shears --at now", "no axis is called `shears`");
    refused(&mut web, "--axis shear --at 3", "at is 3; 0 NOW, 1 MASTER_POSITION, 2 POSITION are allowed");
    refused(&mut web, "--axis shear --disengage 3", "disengage is 3; 0 STOP, 1 KEEP_VELOCITY, 2 AS_GOAL are allowed");
    refused(&mut web, "--axis shear --increments 5", "increments is 5; 0 is allowed with at NOW");
    let far = "--axis shear --at position --increments 4611686018427387904";
    refused(&mut web, far, "increments is 4611686018427387904; within +-2^62 is allowed");

    for (disengage, at, left_at, state) in [
        ("stop", "--at master_position --increments 20000 --disengage stop", 20_000, "STANDSTILL"),
        ("stop", "--at master_position --increments 60000 --disengage keep_velocity", 60_000, "CONTINUOUS_MOTION"),
        ("keep_velocity", "--at position --increments 20000 --disengage as_goal", 40_000, "CONTINUOUS_MOTION"),
    ] {
        web.cyclone.run("move /lineshaft --axis web --position 0 --wait");
        web.cyclone.run("move /lineshaft --axis shear --position 0 --wait");
        let gear = format!("synchronize /lineshaft --axis shear --master web --denominator 2 --disengage {disengage}");
        let goal = web.cyclone.run(&gear)["goal"].as_str().expect("an id").to_owned();
        web.cyclone.run("events /lineshaft");
        web.cyclone.run("move /lineshaft --axis web --mode velocity --velocity 0.02");
        web.cyclone.run(&format!("gear-out /lineshaft --axis shear {at}"));
        let ended = web.cyclone.run(&format!("result /lineshaft synchronize {goal}"));
        let result = &ended["result"];
        assert_eq!((&result["code"], ended["status"].as_str()), (&json!(0), Some("SUCCEEDED")), "{ended:?}");
        assert_eq!(result["message"], "shear: gear_out has uncoupled the axis");
        let place = result["position_increments"].as_i64().expect("increments");
        // Half the position, at most one cycle later, and the stopping distance from 10 inc per cycle at 10 m/s^2: 5
        // inc.
        assert!((left_at / 2..=left_at / 2 + 20).contains(&place), "{at}: {place}");
        let (seen, [leader, _]) = web.seen();
        assert!(seen == state && leader >= left_at, "{seen} {leader}");
        web.cyclone.run("axes /lineshaft halt");
    }
}

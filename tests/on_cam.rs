//! Tests an axis on a cam, commanded by a client on Cyclone DDS, with launch-configs/cams/02_carton.yaml.

use std::path::Path;

use crate::support::{domain::Domain, peer::Peer, program::Program};
use serde_json::Value;

struct Erector {
    cyclone: Peer,
    _program: Program,
}

impl Erector {
    fn start() -> Self {
        let cell = Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs/cams/02_carton.yaml");
        let cell = cell.to_str().expect("a path of text");
        let domain = Domain::take();
        let mut cyclone = Peer::cyclone(&domain);
        let program = Program::start(&["run", cell, "--store", "none", "--flight-recorder", "0"], &domain);
        cyclone.run("axis-states /lineshaft");
        cyclone.run("axes /lineshaft enable cups");
        Self { cyclone, _program: program }
    }

    fn cups(&mut self) -> Value {
        self.cyclone.run("axis-states /lineshaft")["axes"]["cups"].clone()
    }

    /// Returns the command position of the cups after the shaft has moved by some increments.
    fn after(&mut self, increments: i64) -> i64 {
        self.cyclone.run(&format!(
            "move /lineshaft --axis shaft --mode relative --units increments --position {increments} --wait"
        ));
        self.cups()["command_increments"].as_i64().expect("increments")
    }
}

/// 36000 inc of the shaft are one revolution: at 180 deg the cups are 120 mm deep, at 330 deg back; half the distance
/// with slave_scale 0.5.
#[test]
fn a_client_brings_the_cups_onto_their_cam_and_off_it() {
    let mut erector = Erector::start();
    let cam = "synchronize /lineshaft --axis cups --master shaft --mode cam";
    for (wrong, sentence) in [
        ("--table stork", "`stork`"),
        ("--table stroke --slave-scale nan", "slave_scale"),
        ("--table stroke --master-scale 2000000", "a scale must be within 0.000001 and 1000000"),
        ("--table stroke --master-offset inf", "master_offset"),
    ] {
        let said = erector.cyclone.fails(&format!("{cam} {wrong}"));
        let log = erector.cyclone.run("log --seconds 1");
        assert!(format!("{said}{log:?}").contains(sentence), "{wrong}: {said} {log:?}");
        assert_eq!(erector.cups()["state"], "STANDSTILL");
    }
    let seen = erector.cyclone.run(&format!("{cam} --table stroke"));
    let goal = seen["goal"].as_str().expect("its number").to_owned();
    assert_eq!(erector.cups()["reference"], 3, "CAM");
    assert_eq!([18_000, 15_000, 3_000, 18_000].map(|way| erector.after(way)), [120_000, 0, 0, 120_000]);
    erector.cyclone.run(&format!("cancel /lineshaft synchronize {goal}"));
    erector.cyclone.run(&format!("result /lineshaft synchronize {goal} --expect CANCELED"));
    assert_eq!(erector.after(18_000), 120_000, "the shaft no longer moves them");
    // The shaft is at 0 again: from the position of the cups, half as deep and back.
    erector.cyclone.run(&format!("{cam} --table stroke --cam-start relative --slave-scale -0.5"));
    assert_eq!([18_000, 18_000].map(|way| erector.after(way)), [60_000, 120_000]);
}

/// Half a revolution of the shaft lowers the cups by 120 mm, whatever the position of the shaft is; 5 mm are added to
/// the cam position.
#[test]
fn a_client_shifts_the_cups_against_their_shaft() {
    let mut erector = Erector::start();
    let phase = "phase /lineshaft --axis cups";
    let said = erector.cyclone.fails(&format!("{phase} --shift 0.001"));
    assert!(said.contains("not coupled by position"), "{said}");
    erector.cyclone.run("synchronize /lineshaft --axis cups --master shaft --mode cam --table stroke");
    let of_master = format!("{phase} --side master --velocity 3 --acceleration 10");
    let seen = erector.cyclone.run(&format!("{of_master} --shift 3.141592653589793"));
    assert_eq!(erector.cups()["command_increments"], 120_000);
    let remaining: Vec<f64> = serde_json::from_value(seen["remaining"].clone()).expect("radians");
    let falls = remaining.windows(2).all(|two| two[0] >= two[1]);
    assert!(falls && remaining.len() > 5 && remaining[0] <= std::f64::consts::PI, "{remaining:?}");
    erector.cyclone.run(&format!("{phase} --shift 0.005 --velocity 0.05 --acceleration 0.5"));
    assert_eq!(erector.cups()["command_increments"], 125_000);
    // Back by half a revolution, stopped half-way.
    erector.cyclone.run(&format!("{of_master} --shift -3.141592653589793 --cancel-after 0.5"));
    let half = erector.cups();
    let place = half["command_increments"].as_i64().expect("increments");
    assert!((5_000..125_000).contains(&place) && half["state"] == "SYNCHRONIZED_MOTION", "{half}");
    for (wrong, sentence) in [
        ("--shift nan", "shift"),
        ("--shift inf", "shift"),
        ("--side master --shift 1", "needs its velocity"),
        ("--shift 0.01 --velocity -1", "a finite number that is not negative is"),
    ] {
        let said = erector.cyclone.fails(&format!("{phase} {wrong}"));
        let log = erector.cyclone.run("log --seconds 1");
        assert!(format!("{said}{log:?}").contains(sentence), "{wrong}: {said} {log:?}");
        assert_eq!(erector.cups()["command_increments"], place, "{wrong}");
    }
}

/// 180 deg/s of the shaft: at the end of its revolution the half stroke becomes active, and at 90 deg the full one
/// again.
#[test]
fn a_client_waits_for_the_end_of_a_turn_and_for_a_place() {
    let mut erector = Erector::start();
    let cam = "synchronize /lineshaft --axis cups --master shaft --mode cam --table stroke";
    let first = erector.cyclone.run(cam)["goal"].as_str().expect("its number").to_owned();
    let said = erector.cyclone.fails("synchronize /lineshaft --axis cups --master shaft --engage at_end");
    let log = erector.cyclone.run("log --seconds 1");
    assert!(format!("{said}{log:?}").contains("it belongs to mode CAM"), "{said} {log:?}");
    erector.cyclone.run("move /lineshaft --axis shaft --mode velocity --velocity 3.141592653589793");
    let half = format!("{cam} --slave-scale 0.5 --cam-start relative");
    let seen = erector.cyclone.run(&format!("{half} --engage at_end"));
    let phases: Vec<u8> = serde_json::from_value(seen["phases"].clone()).expect("phases");
    assert_eq!((phases.first(), phases.last()), (Some(&0), Some(&2)), "WAITING, then SYNCHRONIZED");
    erector.cyclone.run(&format!("result /lineshaft synchronize {first} --expect SUCCEEDED"));
    let next = seen["goal"].as_str().expect("its number").to_owned();
    let back = erector.cyclone.run(&format!("{cam} --cam-start ramp_in --engage at_position --master-increments 9000"));
    let phases: Vec<u8> = serde_json::from_value(back["phases"].clone()).expect("phases");
    assert_eq!(phases.first(), Some(&0), "WAITING");
    erector.cyclone.run(&format!("result /lineshaft synchronize {next} --expect ABORTED"));
}

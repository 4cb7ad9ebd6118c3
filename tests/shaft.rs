//! Tests the topic `~/shaft`, which publishes the leaders (sources of position), with a client on Cyclone DDS.

use std::fs;

use crate::support::{
    domain::Domain,
    peer::{Observations, Peer},
    program::Program,
};
use serde_json::{Value, json};

/// Both have 1000 inc per mm.
const CELL: &str = "
lineshaft: 1
cycle: 1 ms
ros: {shaft_rate: RATE}
backends: {plant: {type: sim}}
memory: {cut: {type: bit}}
encoders:
  belt: {backend: plant, address: 0, bits: 32, type: linear, scale: {increments: 1000, per: 1 mm}}
machine: {pulsacc: -1}
masters: {lag: {add: [line], subtract: [belt]}}
axes:
  line: {type: linear, scale: {increments: 1000, per: 1 mm}, drive: virtual, max_velocity: 1 m/s, max_acceleration: 20 m/s^2}
";

/// The belt is at 7 k in cycle k, until its encoder signal is lost.
const SCENARIO: &str = "
scenario: a belt that is lost
for: 600 s
drive:
  - {signal: belt.count, at: 0, ramp: {from: 0, per_cycle: 7, until: 7000000}}
steps:
  - {when: {signal: cut, is: 1}, do: {inject: {encoder_cut: {axis: belt}}}}
";

struct Shaft {
    cyclone: Peer,
    _program: Program,
    _folder: tempfile::TempDir,
}

impl Shaft {
    fn start(rate: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name).to_str().expect("a path of text").to_owned();
        let (cell, scenario) = (path("cell.yaml"), path("s.yaml"));
        fs::write(&cell, CELL.replace("RATE", rate)).expect("room for a file");
        fs::write(&scenario, SCENARIO).expect("room for a file");
        let domain = Domain::take();
        let mut cyclone = Peer::cyclone(&domain);
        let args = ["run", &cell, "--sim", "--store", "none", "--flight-recorder", "0", "--scenario", &scenario];
        let program = Program::start(&args, &domain);
        cyclone.run("axis-states /lineshaft");
        Self { cyclone, _program: program, _folder: folder }
    }

    fn told(&mut self, count: u32) -> Observations {
        self.cyclone.run(&format!("shaft /lineshaft --count {count}"))
    }

    fn leader(&mut self, name: &str) -> Value {
        self.told(1)["leaders"][name].clone()
    }
}

fn whole(value: &Value) -> i128 {
    value.as_i64().expect("a whole number").into()
}

fn real(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// Returns the position in units of 2^-32 inc; in these units the fraction is a whole number. JSON may lose its last
/// digit.
fn raw(leader: &Value) -> i128 {
    let fraction = real(&leader["fraction"]) * 4_294_967_296.0;
    assert!((fraction - fraction.round()).abs() < 1e-3 && (0.0..4_294_967_296.0).contains(&fraction), "{leader}");
    (whole(&leader["position_increments"]) << 32) + fraction.round() as i128
}

/// line runs at 12.3457 mm/s, 12.3457 inc in each cycle, and the virtual master at 333 inc/s.
#[test]
fn a_client_reads_every_leader_of_each_cycle_of_the_rate() {
    let mut shaft = Shaft::start("50 Hz");
    shaft.cyclone.run("params /lineshaft set machine.setsys_15=333");
    shaft.cyclone.run("move /lineshaft --axis line --mode velocity --velocity 0.0123457");
    // Until it has reached that velocity.
    shaft.told(5);
    let seen = shaft.told(20);
    let mut before: Option<(i128, i128, i128)> = None;
    for told in seen.all() {
        assert_eq!(told["order"], json!(["belt", "line", "lag", "machine.vmaster"]));
        assert_eq!(told["same_stamp"], true);
        let cycle = whole(&told["cycle"]);
        assert_eq!(cycle % 20, 0, "50 in a second");
        let [belt, line, lag, pulses] = ["belt", "line", "lag", "machine.vmaster"].map(|name| &told["leaders"][name]);
        for (leader, has_scale) in [(belt, true), (line, true), (lag, true), (pulses, false)] {
            assert_eq!((&leader["valid"], &leader["has_scale"]), (&json!(true), &json!(has_scale)), "{leader}");
        }
        assert_eq!((raw(belt), real(&belt["velocity_increments"])), ((7 * cycle) << 32, 7_000.0));
        assert_eq!((real(&belt["position"]), real(&belt["velocity"])), ((7 * cycle) as f64 / 1e6, 0.007));
        // ~/axis_states of the same cycle shows the same command position.
        let axis = &told["axes"]["line"];
        assert_eq!(line["position_increments"], axis["command_increments"]);
        assert_eq!((&line["position"], &line["velocity"]), (&axis["command_position"], &axis["command_velocity"]));
        assert_eq!(raw(lag), raw(line) - raw(belt), "to the last unit");
        assert_eq!((real(&pulses["position"]), real(&pulses["velocity_increments"])), (0.0, 333.0));
        if let Some((last, way, count)) = before {
            let cycles = cycle - last;
            let run = (raw(line) - way) as f64 / 4_294_967_296.0;
            assert!((run - 12.3457 * cycles as f64).abs() < 1e-6, "{run} inc in {cycles} cycles");
            let exact = ((333 * cycles) << 32) as f64 / 1e3;
            assert!(((raw(pulses) - count) as f64 - exact).abs() <= 1.0, "rounded down to 2^-32 inc at both ends");
        }
        before = Some((cycle, raw(line), raw(pulses)));
    }
    assert!(seen.all().iter().any(|told| real(&told["leaders"]["line"]["fraction"]) > 0.0));
    shaft.cyclone.run("move /lineshaft --axis line --position 0.025 --velocity 0.5 --wait");
    let line = shaft.leader("line");
    assert_eq!((raw(&line), real(&line["position"]), real(&line["velocity"])), (25_000 << 32, 0.025, 0.0));
}

#[test]
fn a_lost_encoder_leads_no_more_and_keeps_its_place() {
    let mut shaft = Shaft::start("100 Hz");
    assert_eq!(shaft.leader("belt")["valid"], true);
    shaft.cyclone.run("set-memory /lineshaft cut=1");
    let lost = (0..100).map(|_| shaft.told(1)).find(|told| told["leaders"]["belt"]["valid"] == false);
    let lost = lost.expect("a lost belt within a second");
    assert_eq!((&lost["leaders"]["lag"]["valid"], &lost["leaders"]["line"]["valid"]), (&json!(false), &json!(true)));
    let place = raw(&lost["leaders"]["belt"]);
    assert!(place > 0);
    shaft.told(5);
    let belt = shaft.leader("belt");
    assert_eq!((raw(&belt), real(&belt["velocity"])), (place, 0.0));
}

#[test]
fn with_rate_0_there_is_no_such_topic() {
    let writes = |rate| {
        let graph = Shaft::start(rate).cyclone.run("graph /lineshaft");
        let writes = graph["writes"].as_array().expect("topics").iter().filter(|topic| **topic == "rt/lineshaft/shaft");
        writes.count()
    };
    assert_eq!((writes("0"), writes("1 Hz")), (0, 1));
}

//! Tests goals in motion on ROS 2: buffered and blended goals, superimposed goals, touch probes, and the verbs of other
//! controllers.

use std::fs;

use crate::support::{domain::Domain, peer::Peer, program::Program};
use serde_json::{Value, json};

/// A running program and its client.
struct Bench {
    cyclone: Peer,
    _program: Program,
    domain: Domain,
}

impl Bench {
    /// Starts it with x enabled.
    fn start(args: &[&str]) -> Self {
        let domain = Domain::take();
        let mut cyclone = Peer::cyclone(&domain);
        let program = Program::start(&[&["run"], args].concat(), &domain);
        cyclone.run("axes /lineshaft enable x");
        Self { cyclone, _program: program, domain }
    }

    fn command(&mut self, axis: &str) -> i64 {
        let seen = self.cyclone.run("axis-states /lineshaft");
        seen["axes"][axis]["command_increments"].as_i64().expect("a whole number")
    }
}

/// Sends a goal in increments to x; returns its ID.
fn go(peer: &mut Peer, options: &str) -> String {
    let seen = peer.run(&format!("move /lineshaft --axis x --units increments {options}"));
    seen["goal"].as_str().expect("an id").to_owned()
}

#[test]
fn two_goals_pass_into_each_other_in_every_buffer_mode() {
    let mut bench = Bench::start(&[]);
    let mut fastdds = Peer::fastdds(&bench.domain);
    // 20 000 000 inc are 190.7 mm; by default 0.6 m/s and 4 m/s^2.
    for (mode, name) in
        (0..).zip(["aborting", "buffered", "blending_low", "blending_previous", "blending_next", "blending_high"])
    {
        bench.cyclone.run("axis-states /lineshaft --all");
        let peer = if mode == 2 { &mut fastdds } else { &mut bench.cyclone };
        let first = go(peer, "--position 20000000");
        let second = go(peer, &format!("--position 40000000 --buffer-mode {mode}"));
        let ended = if mode == 0 { "ABORTED" } else { "SUCCEEDED" };
        let seen = peer.run(&format!("result /lineshaft move_axis {first} --expect {ended}"));
        let message = seen["result"]["message"].as_str().unwrap();
        assert_eq!(message.contains("a newer command took the axis over"), mode == 0, "{name}: {message}");
        peer.run(&format!("result /lineshaft move_axis {second}"));
        let seen = bench.cyclone.run("axis-states /lineshaft --all");
        let near = |x: &Value| (18_000_000..22_000_000).contains(&x["command_increments"].as_i64().unwrap());
        let speeds = seen.all().iter().map(|sample| &sample["axes"]["x"]).filter(|x| near(x));
        let slowest = speeds.map(|x| x["command_velocity"].as_f64().unwrap()).fold(f64::INFINITY, f64::min);
        // When it stops it is slower than 0.2 m/s for 50 ms.
        assert_eq!(slowest < 0.2, name == "buffered", "{name}: {slowest} m/s at the passage");
        assert_eq!(bench.command("x"), 40_000_000, "{name}");
        go(&mut bench.cyclone, "--position 0 --wait");
    }
}

#[test]
fn a_waiting_goal_ends_with_the_one_before_it() {
    let mut bench = Bench::start(&[]);
    let first = go(&mut bench.cyclone, "--position 40000000");
    let second = go(&mut bench.cyclone, "--position 50000000 --buffer-mode 1");
    bench.cyclone.run("axes /lineshaft halt x");
    for goal in [first, second] {
        let seen = bench.cyclone.run(&format!("result /lineshaft move_axis {goal} --expect ABORTED"));
        assert_eq!(seen["result"]["message"], "x: halt ended the goal");
    }
}

#[test]
fn a_superimposed_goal_is_added_to_the_one_under_way() {
    let mut bench = Bench::start(&[]);
    let base = go(&mut bench.cyclone, "--position 20000000 --velocity 20000000");
    let added = go(&mut bench.cyclone, "--position 1000000 --mode superimposed");
    for goal in [added, base] {
        bench.cyclone.run(&format!("result /lineshaft move_axis {goal}"));
    }
    assert_eq!(bench.command("x"), 21_000_000);
}

/// A cell with an input that latches, and a scenario with five latches per second.
fn probe_files() -> (String, String) {
    let folder = format!("{}/motion_{}", env!("CARGO_TARGET_TMPDIR"), std::process::id());
    fs::create_dir_all(&folder).expect("the folder of the tests is ours");
    let write = |name: &str, text: &str| {
        let path = format!("{folder}/{name}");
        fs::write(&path, text).expect("the folder of the tests is ours");
        path
    };
    let cell = write(
        "cell.yaml",
        "lineshaft: 1\n\
         cycle: 1 ms\n\
         backends: {plant: {type: sim}}\n\
         io:\n  mark: {type: di, backend: plant, address: 0, latch: true}\n  start: {type: di, backend: plant, address: 1}\n\
         axes:\n  x: {type: linear, unit: mm, scale: {increments: 1000, per: 1 mm}, max_position: 900 mm,\n\
         \x20     drive: {backend: plant, address: 0, interface: position}, max_velocity: 1 m/s, max_acceleration: 5 m/s^2,\n\
         \x20     max_following_error: 10 mm, error_reaction: 2, sim: {model: ideal}}\n",
    );
    let scenario = write(
        "marks.yaml",
        "scenario: marks\n\
         for: 600 s\n\
         steps:\n- {at: 0, every: 200 ms, do: {inject: {latch: {input: mark, age: 350 us}}}}\n",
    );
    (cell, scenario)
}

#[test]
fn a_probe_ends_at_its_distance_from_the_mark() {
    let (cell, scenario) = probe_files();
    let mut bench = Bench::start(&[&cell, "--scenario", &scenario]);
    for distance in [0.02, -0.01, 0.0] {
        let before = bench.command("x");
        let search = "probe /lineshaft --axis x --event mark --mode relative --position 0.5 --velocity 0.1";
        let seen = bench.cyclone.run(&format!("{search} --distance {distance}"));
        let result = &seen["result"];
        assert_eq!((&result["code"], &result["probed"]), (&json!(0), &json!(true)), "{result}");
        let (mark, end) = (result["probed_position"].as_f64().unwrap(), result["position"].as_f64().unwrap());
        // Half an increment of a micrometre, and the rounding of f64.
        assert!((end - mark - distance).abs() <= 0.501e-6, "{result}");
        let found = result["probed_increments"].as_i64().unwrap();
        assert!((before..=before + 30_000).contains(&found), "within 200 ms: {result}");
        assert_eq!(result["position_increments"], bench.command("x"), "{result}");
        assert_eq!(seen["phases"].as_array().unwrap().last(), Some(&json!(1)), "it tells that it has found it");
    }
    let beyond = "probe /lineshaft --axis x --event mark --mode relative --position 0.5 --velocity 0.1 --distance 5";
    let seen = bench.cyclone.run(&format!("{beyond} --expect ABORTED"));
    let (message, result) = (seen["result"]["message"].as_str().unwrap(), &seen["result"]);
    assert!(message.contains("exceeds max_position 900 mm") && result["probed"] == true, "{result}");
    let short = "probe /lineshaft --axis x --event x --mode relative --position 0.001 --expect ABORTED";
    let seen = bench.cyclone.run(short);
    assert_eq!((&seen["result"]["code"], &seen["result"]["probed"]), (&json!(10_107), &json!(false)));
    assert_eq!(seen["result"]["message"], "x: nothing latched until the end of the search");
    for wrong in ["--event start", "--event q", "--event mark --position nan", "--event mark --distance inf"] {
        let error = bench.cyclone.fails(&format!("probe /lineshaft --axis x {wrong}"));
        assert!(error.contains("rejected"), "{wrong}: {error}");
    }
}

#[test]
fn the_verbs_of_old_controllers_are_accepted_or_refused_with_their_place() {
    let mut bench = Bench::start(&[]);
    let mut fastdds = Peer::fastdds(&bench.domain);
    let set = "vocabulary /lineshaft x set_parameters";
    for (peer, velocity) in [(&mut bench.cyclone, 0.3), (&mut fastdds, 0.2)] {
        let seen = peer.run(&format!("{set} {{max_velocity: {velocity} m/s, error_reaction: 2}}"));
        assert_eq!((&seen["success"], &seen["message"]), (&json!(true), &json!("")));
        let too_fast =
            "move /lineshaft --axis x --mode relative --position 0.001 --velocity 0.5 --wait --expect ABORTED";
        let seen = peer.run(too_fast);
        let message = seen["result"]["message"].as_str().unwrap();
        assert!(message.contains(&format!("exceeds max_velocity {} mm/s", velocity * 1000.0)), "{message}");

        for (request, sentence) in [
            (format!("{set} {{max_velocity: 0}}"), "x: max_velocity is 0"),
            (format!("{set} {{max_speed: 1}}"), "arguments:1:13: no parameter is called `x.max_speed`"),
            (format!("{set} {{max_velocity: [1"), "arguments:"),
            (
                "vocabulary /lineshaft x saia {axis: y, commands: [axinit]}".to_owned(),
                "arguments:1:8: axis is `y`; `x` was given beside",
            ),
            ("vocabulary /lineshaft x wf {zzz: 1}".to_owned(), "arguments:1:2: unknown key `zzz` in wf"),
            (
                "vocabulary /lineshaft q saia {commands: [axinit]}".to_owned(),
                "no axis is called `q`; there are line, x, y, turret",
            ),
            ("vocabulary /lineshaft x halt {}".to_owned(), "verb is `halt`; saia, wf, set_parameters are allowed"),
        ] {
            let error = peer.fails(&request);
            assert!(error.starts_with(sentence), "{request}: {error}");
        }
    }
    bench.cyclone.run(&format!("{set} max_velocity: 1.0 m/s\\nerror_reaction: 3"));
    let error = bench.cyclone.fails(&format!("{set} {} --pad 10000000", "[".repeat(5000)));
    assert!(error.contains("bytes long; 65536 are allowed"), "{error}");
    let error = bench.cyclone.fails(&format!("{set} {}", "[".repeat(5000)));
    assert!(error.ends_with("nested deeper than 64 levels"), "{error}");
    bench.cyclone.run("move /lineshaft --axis x --mode relative --position 0.01 --wait");
}

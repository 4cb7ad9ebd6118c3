//! Tests a cell of 64 axes and measures its processor load. The figures are in docs/node.md.
//!
//! `cargo test --release --workspace --test end_to_end scale -- --nocapture` repeats them; `LINESHAFT_LONG=1` measures
//! for 60 s.

use std::{env, fmt::Write, fs, path::Path, thread, time::Duration};

use crate::support::{domain::Domain, peer::Peer, program::Program};

const AXES: usize = 64;

/// Returns a cell of linear axes, a quarter of them without a motor, at 100 states a second.
fn cell(cycle: &str) -> String {
    let mut cell = format!(
        "lineshaft: 1\ncycle: {cycle}\nros: {{joint_states_rate: 100, axis_states_rate: 100}}\n\
         backends:\n  plant: {{type: sim}}\naxes:\n"
    );
    for axis in 0..AXES {
        let drive = if axis % 4 == 0 {
            "virtual".to_owned()
        } else {
            format!("{{backend: plant, address: {axis}, interface: position}}")
        };
        writeln!(
            cell,
            "  axis_{axis}: {{type: linear, unit: mm, scale: {{increments: 1048576, per: 10 mm}}, drive: {drive}, \
             max_velocity: 1 m/s, max_acceleration: 8 m/s^2}}"
        )
        .expect("a String takes everything");
    }
    cell
}

fn start(folder: &Path, cycle: &str, domain: &Domain) -> Program {
    let path = folder.join("axes64.yaml");
    fs::write(&path, cell(cycle)).expect("a folder of this test");
    Program::start(&["run", path.to_str().expect("a name of this test")], domain)
}

/// Returns the processor load of the program during a time (% of one processor).
fn load(program: &Program, length: Duration) -> f64 {
    let before = program.figures().worked;
    thread::sleep(length);
    100.0 * (program.figures().worked - before) / length.as_secs_f64()
}

#[test]
fn sixty_four_axes_are_found_served_and_moved() {
    let long = env::var("LINESHAFT_LONG").is_ok_and(|value| value == "1");
    let length = Duration::from_secs(if long { 60 } else { 5 });
    let folder = tempfile::tempdir().expect("a folder");
    for cycle in ["1 ms", "10 ms"] {
        let domain = Domain::take();
        let mut peer = Peer::cyclone(&domain);
        let program = start(folder.path(), cycle, &domain);
        let seen = peer.run("axis-states /lineshaft");
        assert_eq!(seen["axes"].as_object().map(serde_json::Map::len), Some(AXES));

        let graph = peer.run("graph /lineshaft");
        let count = |name: &str| graph[name].as_array().map_or(0, Vec::len);
        let joined = peer.run("join /lineshaft --count 10 --axis axis_1");
        let times = |name: &str| -> Vec<f64> {
            joined[name].as_array().into_iter().flatten().filter_map(serde_json::Value::as_f64).collect()
        };
        let (sample, answer) = (times("first_sample_s"), times("first_answer_s"));
        let with_reader = load(&program, length);
        let idle_peer = peer;
        drop(idle_peer);
        let alone = load(&program, length);
        let memory = program.figures().memory;
        println!("cycle {cycle}: {} writers, {} readers", count("writes"), count("reads"));
        println!(
            "  new participant: first sample after {:.0} ms (median), {:.0} ms (worst)",
            ms(&sample, 5),
            ms(&sample, 9)
        );
        println!(
            "  new participant: first answer after {:.0} ms (median), {:.0} ms (worst)",
            ms(&answer, 5),
            ms(&answer, 9)
        );
        println!("  work: {with_reader:.1} % of a processor with a reader of axis_states, {alone:.1} % alone");
        println!("  memory: {memory:.1} MiB");

        let mut peer = Peer::cyclone(&domain);
        let enabled = peer.run("axes /lineshaft enable");
        assert_eq!(enabled["message"], format!("{AXES} axes enabled"));
        let moved = peer.run("move /lineshaft --axis axis_63 --units increments --position 123456 --wait");
        assert_eq!(moved["result"]["position_increments"], 123_456);
        assert!(sample.len() == 10 && alone < 100.0 && memory < 500.0, "{sample:?} s, {alone} %, {memory} MiB");
    }
}

/// Returns the element at index `place` of ascending times, in ms.
fn ms(times: &[f64], place: usize) -> f64 {
    1000.0 * times[place]
}

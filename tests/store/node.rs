//! Tests a node that saves parameters in its store thread.

use std::{
    fs,
    path::Path,
    process::{Child, Command, Output},
    thread,
    time::{Duration, Instant},
};

use super::{Bench, cell, lineshaft, read, said};
use crate::support::domain::Domain;

const SAVES: &str = "scenario: saves\nfor: 400 ms\nsteps:\n  - {at: 10, do: {set_parameters: {line.max_velocity: 400 mm/s}}}\n  \
                     - {at: 20, do: {save_parameters: {axes: [line]}}}\n";
const LOOKS: &str = "scenario: looks\nfor: 200 ms\nsteps:\n  - {at: 10, do: {move_axis: {axis: line, mode: velocity, \
                     velocity: 1 m/s}}, refused: max_velocity 400 mm/s}\n";

fn node(bench: &Bench, domain: &Domain, scenario: &Path, more: &[&str]) -> Command {
    let mut command = lineshaft();
    command.arg("run").arg(cell()).arg("--scenario").arg(scenario).args(["--flight-recorder", "0"]).args(more);
    command.env("ROS_HOME", bench.path("home")).env("ROS_DOMAIN_ID", domain.to_string());
    command.env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST").env_remove("CYCLONEDDS_URI");
    command
}

/// A running node, killed with the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        // Both fail if it has ended, which is fine.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[track_caller]
fn passes(output: &Output) -> String {
    let (code, text) = said(output);
    assert_eq!(code, Some(0), "{text}");
    text
}

/// Proves: MACS-STO-04, MACS-STO-06
#[test]
fn a_node_keeps_what_is_saved_in_its_folder_for_the_next_one() {
    let (bench, domain) = (Bench::new(), Domain::take());
    let saves = bench.write("saves.yaml", SAVES);
    let text = passes(&node(&bench, &domain, &saves, &[]).output().unwrap());
    let file = bench.path("home/lineshaft/lineshaft/parameters.parameters.yaml");
    assert!(text.contains("parameters.parameters.yaml: parameters are saved; generation 1"), "{text}");
    assert_eq!(read(&file).1.max_velocity, 400_000.0);
    let looks = bench.write("looks.yaml", LOOKS);
    passes(&node(&bench, &domain, &looks, &[]).output().unwrap());
    // With another store file, and with none, the values of the cell apply; without a store, saved values are not
    // written.
    let (code, _) = said(&node(&bench, &domain, &looks, &["--store", "none"]).output().unwrap());
    assert_eq!(code, Some(1), "the goal is taken");
    let fast = bench.write("fast.yaml", &SAVES.replace("400 mm/s", "500 mm/s"));
    passes(&node(&bench, &domain, &fast, &["--store", "none"]).output().unwrap());
    assert_eq!(read(&file).1.max_velocity, 400_000.0);
    let other = bench.path("other.yaml");
    passes(&node(&bench, &domain, &fast, &["--store", other.to_str().unwrap()]).output().unwrap());
    assert_eq!((read(&file).1.max_velocity, read(&other).1.max_velocity), (400_000.0, 500_000.0));
}

/// Two nodes with the same name and cell: the second one starts with the saved values, and reports that it does not
/// save.
#[test]
fn a_second_node_does_not_wait_for_the_first_and_does_not_write_its_store() {
    let (bench, domain) = (Bench::new(), Domain::take());
    let first = bench.write("first.yaml", &SAVES.replace("for: 400 ms", "for: 60 s"));
    let file = bench.path("home/lineshaft/lineshaft/parameters.parameters.yaml");
    let running = Running(node(&bench, &domain, &first, &[]).spawn().unwrap());
    let begin = Instant::now();
    while !file.exists() {
        assert!(begin.elapsed() < Duration::from_secs(30), "nothing is saved");
        thread::sleep(Duration::from_millis(10));
    }
    let steps = SAVES.rsplit_once("steps:\n").unwrap().1;
    let later = steps.replace("400", "300").replace("at: ", "at: 1");
    let second = bench.write("second.yaml", &format!("{LOOKS}{later}"));
    let text = passes(&node(&bench, &domain, &second, &[]).output().unwrap());
    drop(running);
    assert!(text.contains("it is read, but nothing will be saved there: another program"), "{text}");
    assert_eq!(text.matches("parameters are not kept there").count(), 1, "{text}");
    assert_eq!(read(&file).1.max_velocity, 400_000.0);
}

/// A disk that cannot be written: the machine continues, and one line reports the error.
#[test]
fn a_store_that_cannot_be_written_is_one_line_in_the_log() {
    let (bench, domain) = (Bench::new(), Domain::take());
    let steps: String = (0..20)
        .map(|n| {
            let at = 10 + 10 * n;
            format!(
                "  - {{at: {at}, do: [{{set_parameters: {{line.max_velocity: {} mm/s}}}}, {{save_parameters: {{axes: [line]}}}}]}}\n",
                300 + n
            )
        })
        .collect();
    let scenario = bench.write("many.yaml", &format!("scenario: many\nfor: 400 ms\nsteps:\n{steps}"));
    fs::create_dir(bench.path(".p.yaml.new")).unwrap();
    let store = bench.path("p.yaml");
    let text = passes(&node(&bench, &domain, &scenario, &["--store", store.to_str().unwrap()]).output().unwrap());
    assert_eq!(text.matches("parameters cannot be written").count(), 1, "{text}");
    assert!(!store.exists());
}

//! Runs several programs one after the other with the same store.

use std::fs;

use super::{Bench, cell, lineshaft, read, said};
use lineshaft::store::Store;

const SAVE: &str = "  - {at: 0, do: {set_parameters: {line.max_velocity: 400 mm/s, x.max_position: 500 mm, \
                    x.velocity_override: 10}}}\n  - {at: 1, do: {save_parameters: {axes: [line, x]}}}\n";
const TOO_FAST: &str = "  - {at: 10, do: {move_axis: {axis: line, mode: velocity, velocity: 1 m/s}}";

/// Proves: MACS-STO-02, MACS-STO-03, MACS-STO-04, MACS-STO-05, MACS-STO-06, AMC-PAR-10
#[test]
fn each_layer_at_the_start_of_the_next_program() {
    let bench = Bench::new();
    // Set and not saved: the next program does not get the value.
    bench.plays("p.yaml", "  - {at: 0, do: {set_parameters: {line.max_velocity: 100 mm/s}}}\n");
    assert!(!bench.path("p.yaml").exists());
    bench.plays("p.yaml", &format!("{TOO_FAST}}}\n"));

    // Saved, and set again afterwards.
    bench.plays("p.yaml", &format!("{SAVE}  - {{at: 20, do: {{set_parameters: {{line.max_velocity: 200 mm/s}}}}}}\n"));
    let text = bench.plays("p.yaml", &format!("{TOO_FAST}, refused: max_velocity 400 mm/s}}\n"));
    assert!(text.contains("p.yaml: 2 values of line, x take the place of what the cell says; generation 1"), "{text}");
    // Volatile: the value of the cell.
    assert_eq!(read(&bench.path("p.yaml")).2.velocity_override, 100.0);

    // The init layer is in force at once; at the next start the saved values are in force again.
    bench.plays(
        "p.yaml",
        &format!("  - {{at: 0, do: {{reset_parameters: {{axes: [line, x], layer: init}}}}}}\n{TOO_FAST}}}\n"),
    );
    bench.plays("p.yaml", &format!("{TOO_FAST}, refused: max_velocity 400 mm/s}}\n"));

    // Deleted, for the next program as well.
    bench.plays("p.yaml", &format!("  - {{at: 0, do: {{delete_parameters: {{axes: [line]}}}}}}\n{TOO_FAST}}}\n"));
    let text = bench.plays("p.yaml", &format!("{TOO_FAST}}}\n"));
    assert!(text.contains("p.yaml: 1 value of x takes the place of what the cell says; generation 2"), "{text}");
    let (generation, line, x) = read(&bench.path("p.yaml"));
    assert_eq!((generation, line.max_velocity, x.max_position), (2, 1e6, Some(500_000)));
}

#[test]
fn without_a_store_nothing_is_kept() {
    let bench = Bench::new();
    let scenario = bench.write("s.yaml", &format!("scenario: s\nfor: 100 ms\nsteps:\n{SAVE}"));
    for store in [&["--store", "none"][..], &[]] {
        let mut command = lineshaft();
        command.arg("sim").arg(cell()).arg("--scenario").arg(&scenario).args(store).current_dir(bench.path(""));
        let (code, text) = said(&command.output().unwrap());
        assert_eq!(code, Some(0), "{text}");
    }
    let names: Vec<_> = fs::read_dir(bench.path("")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(names, ["s.yaml"]);
}

/// Proves: MACS-STO-06
#[test]
fn a_damaged_store_is_named_and_the_generation_before_is_used() {
    let bench = Bench::new();
    bench.plays("p.yaml", SAVE);
    bench.plays(
        "p.yaml",
        &format!(
            "{SAVE}{}",
            SAVE.replace("400 mm/s", "300 mm/s").replace("at: 0", "at: 5").replace("at: 1,", "at: 6,")
        ),
    );
    assert_eq!(read(&bench.path("p.yaml")).1.max_velocity, 300_000.0);
    let whole = fs::read(bench.path("p.yaml")).unwrap();
    fs::write(bench.path("p.yaml"), &whole[..whole.len() / 2]).unwrap();
    let text = bench.plays("p.yaml", &format!("{TOO_FAST}, refused: max_velocity 400 mm/s}}\n"));
    for part in
        ["WARN", "p.yaml: it is damaged: it does not end with its checksum", "p.yaml.previous, is used: number 1"]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
    // Both files damaged: no program starts.
    fs::write(bench.path("p.yaml.previous"), "").unwrap();
    let (code, text) = bench.sim("p.yaml", SAVE);
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("p.yaml: it is damaged: ") && text.contains("p.yaml.previous, too: it is empty"), "{text}");
    assert!(!text.contains("PASSED"));
}

#[test]
fn a_store_that_does_not_fit_or_is_in_use_starts_nothing() {
    let bench = Bench::new();
    bench.plays("p.yaml", SAVE);
    let scenario = bench.write("s.yaml", "scenario: s\ncycles: 10\n");
    let other = bench.write("other.yaml", &fs::read_to_string(cell()).unwrap().replace("  x: {", "  y: {"));
    for command in ["sim", "run"] {
        let mut command = {
            let mut program = lineshaft();
            program.arg(command).arg(&other).arg("--scenario").arg(&scenario);
            program
        };
        command.arg("--store").arg(bench.path("p.yaml")).env("ROS_HOME", bench.path(""));
        let (code, text) = said(&command.output().unwrap());
        assert_eq!(code, Some(2), "{text}");
        assert!(text.contains("p.yaml:7:3: the cell has no axis `x`; its axes are line, y\n"), "{text}");
        assert!(text.contains("or delete this one: what was saved is lost then"), "{text}");
    }
    let held = Store::open(&bench.path("p.yaml")).unwrap();
    let (code, text) = bench.sim("p.yaml", SAVE);
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("p.yaml: another program keeps its parameters there"), "{text}");
    drop(held);
    bench.plays("p.yaml", SAVE);
}

#[test]
fn a_disk_that_takes_nothing_fails_the_run_and_keeps_the_old_set() {
    let bench = Bench::new();
    bench.plays("p.yaml", SAVE);
    fs::create_dir(bench.path(".p.yaml.new")).unwrap();
    let (code, text) = bench.sim("p.yaml", &SAVE.replace("400 mm/s", "300 mm/s"));
    assert_eq!(code, Some(1), "{text}");
    assert!(text.contains("p.yaml: parameters cannot be written: "), "{text}");
    assert_eq!(read(&bench.path("p.yaml")).1.max_velocity, 400_000.0);
}

/// A run that began with saved values replays without differences, from its first file and from each later file.
///
/// Proves: MACS-STO-04
#[test]
fn a_recording_of_a_machine_with_saved_values_replays() {
    let bench = Bench::new();
    bench.plays("p.yaml", SAVE);
    let steps = "\
scenario: all that can happen to layers
for: 4 s
steps:
  - {at: 0, do: {set_parameters: {x.max_position: 600 mm, line.velmax: 3000}}}
  - {at: 100, do: {move_axis: {axis: line, mode: velocity, velocity: 20 mm/s}}}
  - {at: 200, do: {halt: {axes: [line]}}}
  - {at: 300, do: {save_parameters: {axes: [line]}}}
  - {at: 500, do: {inject: {power_cycle: {}}}}
  - {at: 600, do: {move_axis: {axis: line, position: 20 mm}}}
  - {at: 1500, do: {reset_parameters: {axes: [line], layer: init}}}
  - {at: 1600, do: {move_axis: {axis: line, position: 100 mm}}}
  - {at: 2200, do: {delete_parameters: {axes: [x]}}}
  - {at: 2300, do: {inject: {power_cycle: {}}}}
  - {at: 2400, do: {move_axis: {axis: line, position: 10 mm}}}
  - {at: 3500, do: {inject: {power_cycle: {}}}}
  - {at: 3600, do: {move_axis: {axis: line, position: 5 mm}}}
";
    let scenario = bench.write("all.yaml", steps);
    let bag = bench.path("bag");
    let mut command = lineshaft();
    command.arg("sim").arg(cell()).arg("--scenario").arg(scenario).arg("--store").arg(bench.path("p.yaml"));
    command.arg("--record").arg(&bag).args(["--max-bag-duration", "1"]);
    let (code, text) = said(&command.output().unwrap());
    assert_eq!(code, Some(0), "{text}");
    let mut runs = vec![bag.clone()];
    let files = fs::read_dir(&bag).unwrap().map(|entry| entry.unwrap().path());
    runs.extend(files.filter(|path| path.extension().is_some_and(|extension| extension == "mcap")));
    assert_eq!(runs.len(), 5, "{runs:?}");
    for run in runs {
        let (code, text) = said(&lineshaft().arg("replay").arg(&run).output().unwrap());
        assert_eq!(code, Some(0), "{}: {text}", run.display());
    }
    // A machine that begins with the values of the cell behaves differently: so the replay has used the store.
    let (generation, line, x) = read(&bench.path("p.yaml"));
    assert_eq!((generation, x.max_position), (3, Some(1_000_000)));
    assert_eq!(line.macs.velmax, Some(3000.0));
}

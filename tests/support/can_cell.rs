//! Provides a cell of CANopen drives in its own folder, and the program that runs it.

use super::can::{CanDrives, behaviour};
use super::domain::Domain;
use super::program::Program;
use super::setup;
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

/// Timeout, much longer than any step takes.
pub(crate) const PATIENCE: Duration = Duration::from_secs(60);
/// Interval of polling.
const LOOK: Duration = Duration::from_millis(10);

/// Returns the keys of an axis of 10000 increments in 10 mm with the drive of a node; `drive` and `keys` are further
/// keys, each after a comma.
pub(crate) fn axis(name: &str, node: u8, drive: &str, keys: &str) -> String {
    format!(
        "  {name}: {{type: linear, scale: {{increments: 10000, per: 10 mm}}, drive: {{backend: bus0, node: {node}, eds: \
         cia402_sim.eds{drive}}}, max_velocity: 500 mm/s, max_acceleration: 5 m/s^2, max_following_error: 5 mm{keys}}}\n"
    )
}

/// Returns steps of a scenario and its expectations: an axis is moved at 10 mm/s; once it has that error and its drive
/// that state, the error is reset, the axis enabled, and moved by 5 mm. The axis has the error, and is disabled until
/// it is enabled.
pub(crate) fn recovery(at: usize, axis: &str, code: &str, state: &str) -> (String, String) {
    let steps = format!(
        "  - {{when: {{signal: {axis}.state, is: STANDSTILL}}, do: {{move_axis: {{axis: {axis}, mode: velocity, velocity: 10 mm/s}}}}}}
  - name: reset{at}
    when: {{all: [{{signal: {axis}.error, is: {code}}}, {{signal: {axis}.drive_state, is: {state}}}]}}
    after: 300 ms
    do: {{reset_errors: {{axes: [{axis}]}}}}
  - {{name: enable{at}, when: {{signal: {axis}.state, is: DISABLED}}, after: 300 ms, do: {{enable: {{axes: [{axis}]}}}}}}
  - {{name: move{at}, when: {{signal: {axis}.state, is: STANDSTILL}}, do: {{move_axis: {{axis: {axis}, mode: relative, position: 5 mm}}}}}}
"
    );
    let expect = format!(
        "  - {{signal: {axis}.enabled, since: reset{at}, from: -25, to: 25, is: 0}}
  - {{signal: {axis}.enabled, since: enable{at}, from: -25, to: 0, is: 0}}
  - {{signal: {axis}.command.velocity, since: move{at}, from: 0, to: 1 s, min: 9 mm/s, mode: eventually}}
  - {{event: {{kind: error, source: {axis}, code: {code}}}, mode: eventually}}
"
    );
    (steps, expect)
}

/// Returns the EDS of a device in which these objects cannot be mapped.
fn without_mapping(eds: &str, objects: &[&str]) -> String {
    let mut parts: Vec<_> = eds.split('[').map(str::to_owned).collect();
    for part in &mut parts {
        if objects.iter().any(|object| part.starts_with(&format!("{object}]"))) {
            assert!(part.contains("PDOMapping=0x1"), "{part}");
            *part = part.replace("PDOMapping=0x1", "PDOMapping=0");
        }
    }
    parts.join("[")
}

/// A folder with a cell and its scenarios.
pub(crate) struct CanCell {
    folder: tempfile::TempDir,
}

impl CanCell {
    /// Creates axes on one bus at this address, with this cycle.
    pub(crate) fn new(address: &str, cycle: &str, axes: &str) -> Self {
        Self::with_buses(&[address], cycle, axes)
    }

    /// Creates axes on several buses, named bus0 and so on.
    pub(crate) fn with_buses(addresses: &[&str], cycle: &str, axes: &str) -> Self {
        Self::of(addresses, cycle, "", axes)
    }

    /// Creates axes on one bus, with other sections before them.
    pub(crate) fn with_sections(address: &str, cycle: &str, sections: &str, axes: &str) -> Self {
        Self::of(&[address], cycle, sections, axes)
    }

    fn of(addresses: &[&str], cycle: &str, sections: &str, axes: &str) -> Self {
        let cell = Self { folder: tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("room within the build") };
        let mut buses = String::new();
        for (at, address) in addresses.iter().enumerate() {
            // Datagrams have no bit rate.
            let rate = if address.starts_with("udp") { "" } else { ", bitrate: 1000000" };
            writeln!(buses, "  bus{at}: {{type: can, transport: \"{address}\"{rate}}}").expect("room");
        }
        cell.write("cell.yaml", &format!("lineshaft: 1\ncycle: {cycle}\nbackends:\n{buses}{sections}axes:\n{axes}"));
        let eds = setup::sources().join("../../launch-configs/can/cia402_sim.eds");
        let eds = fs::read_to_string(eds).expect("the file of the simulated drive is there");
        let unmapped = without_mapping(&eds, &["6060", "6061"]);
        cell.write("unmapped.eds", &unmapped);
        let is_unmapped = behaviour().is_some_and(|habit| habit == "unmapped_mode");
        cell.write("cia402_sim.eds", if is_unmapped { &unmapped } else { &eds });
        cell
    }

    /// Returns the path of a file in the folder.
    pub(crate) fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().expect("a path of text").to_owned()
    }

    /// Writes a file in the folder; returns its path.
    pub(crate) fn write(&self, name: &str, text: &str) -> String {
        let path: &Path = &self.folder.path().join(name);
        fs::write(path, text).expect("room for a file");
        path.to_str().expect("a path of text").to_owned()
    }

    /// Starts `lineshaft run` with the cell and a scenario.
    pub(crate) fn run(&self, scenario: &str) -> CanRun {
        self.run_with(scenario, &[])
    }

    /// Does the same with more options.
    pub(crate) fn run_with(&self, scenario: &str, options: &[&str]) -> CanRun {
        self.run_in(&Domain::take(), scenario, options)
    }

    /// Does the same in a domain that has other participants.
    pub(crate) fn run_in(&self, domain: &Domain, scenario: &str, options: &[&str]) -> CanRun {
        let scenario = self.write("scenario.yaml", scenario);
        let cell = self.folder.path().join("cell.yaml");
        let cell = cell.to_str().expect("a path of text");
        let args = ["run", cell, "--scenario", &scenario, "--store", "none"];
        let flies = options.contains(&"--flight-folder");
        let flight: &[&str] = if flies { &[] } else { &["--flight-recorder", "0"] };
        CanRun { program: Program::start(&[&args, flight, options].concat(), domain) }
    }
}

/// The running program with such a cell.
pub(crate) struct CanRun {
    pub(crate) program: Program,
}

impl CanRun {
    /// Waits until the scenario has ended and passed; returns all output.
    #[track_caller]
    pub(crate) fn passes(mut self) -> String {
        let status = self.program.wait_exit(PATIENCE * 2);
        // The log is shown when the program is dropped.
        assert_eq!(status.code(), Some(0), "the scenario has failed");
        self.program.log()
    }

    /// Waits until it has ended with this code; returns all output.
    #[track_caller]
    pub(crate) fn ends_with(mut self, code: i32) -> String {
        let status = self.program.wait_exit(PATIENCE);
        assert_eq!(status.code(), Some(code), "the exit code");
        self.program.log()
    }

    /// Returns how often it has written this text.
    pub(crate) fn count_in_log(&self, text: &str) -> usize {
        self.program.log().matches(text).count()
    }

    /// Waits until it has written this text `times` times; returns the duration.
    #[track_caller]
    pub(crate) fn wait_for_log(&self, times: usize, text: &str) -> Duration {
        let begin = Instant::now();
        while self.count_in_log(text) < times {
            assert!(begin.elapsed() < PATIENCE, "`{text}` is not told {times} times; {}", self.program.log());
            thread::sleep(LOOK);
        }
        begin.elapsed()
    }

    /// Waits until the state of a drive satisfies a condition.
    #[track_caller]
    pub(crate) fn until(&self, drives: &mut CanDrives, node: u8, what: &str, holds: impl Fn(&Shown) -> bool) -> Shown {
        let begin = Instant::now();
        loop {
            let shown = drives.shown(node);
            if holds(&shown) {
                return shown;
            }
            assert!(begin.elapsed() < PATIENCE, "node {node}: {what}? {shown:?}; {}", self.program.log());
            thread::sleep(LOOK);
        }
    }
}

/// State of a simulated drive.
#[derive(Clone, Debug)]
pub(crate) struct Shown {
    pub(crate) nmt: u64,
    pub(crate) state: String,
    pub(crate) velocity: i64,
    /// Position counted by the drive (6064h).
    pub(crate) position: i64,
    /// Position of the mechanics, which no homing changes.
    pub(crate) machine: f64,
    pub(crate) fault: u64,
    counters: Value,
}

impl Shown {
    pub(crate) fn is_enabled(&self) -> bool {
        self.state == "OPERATION_ENABLED"
    }

    pub(crate) fn is_off(&self) -> bool {
        self.state == "SWITCH_ON_DISABLED"
    }

    pub(crate) fn counter(&self, name: &str) -> u64 {
        self.counters[name].as_u64().expect("the drive counts it")
    }
}

impl CanDrives {
    /// Returns the state of a drive.
    #[track_caller]
    pub(crate) fn shown(&mut self, node: u8) -> Shown {
        let told = self.tell(&format!("state {node}"));
        let whole = |key: &str| told[key].as_i64().unwrap_or_else(|| panic!("{told}: no {key}"));
        Shown {
            nmt: whole("nmt").unsigned_abs(),
            state: told["state"].as_str().expect("a name").to_owned(),
            velocity: whole("velocity"),
            position: whole("position"),
            machine: told["machine_position"].as_f64().expect("a number"),
            fault: whole("fault").unsigned_abs(),
            counters: told["counters"].clone(),
        }
    }
}

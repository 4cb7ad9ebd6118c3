//! Tests signals that end a command: its output is complete, and the exit code is that of the signal.

use crate::support::{domain::Domain, machine::share, program::Program};
use rustix::process::{Pid, Signal, kill_process};
use std::fs::{self, File, OpenOptions};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Much longer than any operation here.
const PATIENCE: Duration = Duration::from_secs(60);

/// It runs for hours; its expectation is never true.
const LONG: &str = "\
scenario: long
for: 100000 s
trace: [x.command.position]
steps:
  - {at: 0, do: {enable: {axes: [x]}}}
expect:
  - {signal: x.state, at: end, is: ERROR_STOP}
";

/// Number of cycles of that scenario with the demo, whose cycle is 1 ms.
const LONG_CYCLES: u64 = 100_000_000;

fn root(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

/// Waits until a condition is true.
#[track_caller]
fn until(what: &str, mut holds: impl FnMut() -> bool) {
    let end = Instant::now() + PATIENCE;
    while !holds() {
        assert!(Instant::now() < end, "{what} does not happen");
        sleep(Duration::from_millis(5));
    }
}

/// A folder with a cell and a scenario that takes hours.
struct Bench(tempfile::TempDir);

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        fs::copy(root("launch-configs/demo.yaml"), folder.path().join("demo.yaml")).expect("the demo");
        fs::write(folder.path().join("long.yaml"), LONG).expect("written");
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Starts the program by a wrapper: its first word is a program that finally executes Lineshaft.
    fn start(&self, wrapper: &[&str], line: &str) -> Child {
        let mut command = wrapped(wrapper);
        command.args(line.split(' ')).current_dir(&self.0).env("ROS_HOME", self.0.path());
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program starts")
    }

    /// Returns the output of a successful command.
    fn good(&self, line: &str) -> String {
        let mut command = Command::new(env!("CARGO_BIN_EXE_lineshaft"));
        let output = command.args(line.split(' ')).current_dir(&self.0).output().expect("the program starts");
        let said = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{line}: {said}");
        said
    }

    /// Waits until a file has this size.
    #[track_caller]
    fn until_size(&self, name: &str, bytes: u64) {
        let path = self.path(name);
        until(name, || fs::metadata(&path).is_ok_and(|about| about.len() >= bytes));
    }
}

/// Resets signals that the shell or `nohup` ignores for the tests.
const USUAL: &[&str] = &["env", "--default-signal=HUP,INT,QUIT,TERM"];

/// Returns the command of the program with its wrapper.
fn wrapped(wrapper: &[&str]) -> Command {
    let [first, rest @ ..] = wrapper else { panic!("a wrapper is a program") };
    let mut command = Command::new(first);
    command.args(rest).arg(env!("CARGO_BIN_EXE_lineshaft"));
    command
}

fn send(child: &Child, signal: Signal) {
    kill_process(Pid::from_child(child), signal).expect("it runs");
}

/// Returns the exit status of a process, and its standard error.
#[track_caller]
fn ended(mut child: Child) -> (ExitStatus, String) {
    until("the end of the program", || child.try_wait().expect("a child of ours").is_some());
    let output = child.wait_with_output().expect("a child of ours");
    (output.status, String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn interrupted_sim_completes_bag_and_csv_and_reports_how_far_it_came() {
    let _machine = share();
    for (signal, name, code) in [
        (Signal::INT, "SIGINT", 130),
        (Signal::TERM, "SIGTERM", 143),
        (Signal::HUP, "SIGHUP", 129),
        (Signal::QUIT, "SIGQUIT", 131),
    ] {
        let bench = Bench::new();
        let line = "sim demo.yaml --scenario long.yaml --record a.mcap --csv a.csv";
        let child = bench.start(USUAL, line);
        bench.until_size("a.csv", 50_000);
        send(&child, signal);
        let (status, said) = ended(child);
        assert_eq!(status.code(), Some(code), "{name}: {said}");
        let csv = fs::read_to_string(bench.path("a.csv")).expect("text");
        assert!(csv.ends_with('\n'), "{name}: the last line is whole");
        // The first line has the names.
        let ran = csv.lines().count() as u64 - 1;
        let seconds = |cycles: u64| format!("{}", cycles as f64 / 1000.0);
        let expected = format!(
            "error: interrupted by {name} after {ran} cycles ({} s) of {LONG_CYCLES} cycles (100000 s); no expectation was \
             judged\n",
            seconds(ran)
        );
        assert_eq!(said, expected);
        let info = bench.good("bag info a.mcap");
        let cycles = format!("0 to {}, 0 lost", ran - 1);
        assert!(info.contains(&cycles) && !info.contains("Cut:") && !info.contains("not finished"), "{name}: {info}");
        assert!(bench.good("replay a.mcap").contains("no difference"), "{name}");
    }
}

/// A full pipe blocks the simulation, so that the first signal cannot end it.
#[test]
fn second_signal_ends_sim_at_once() {
    /// O_NONBLOCK: opening a named pipe for reading does not wait for a writer.
    const NONBLOCK: i32 = 0o4000;
    let _machine = share();
    let bench = Bench::new();
    assert!(Command::new("mkfifo").arg(bench.path("pipe")).status().expect("mkfifo").success());
    let reader: File =
        OpenOptions::new().read(true).custom_flags(NONBLOCK).open(bench.path("pipe")).expect("a named pipe");
    let mut child = bench.start(USUAL, "sim demo.yaml --scenario long.yaml --csv pipe");
    let mut before = 0;
    until("the pipe is full", || {
        sleep(Duration::from_millis(300));
        let bytes = rustix::io::ioctl_fionread(&reader).expect("a pipe");
        let is_full = bytes > 0 && bytes == before;
        before = bytes;
        is_full
    });
    // Within 0.5 s they count as repetitions of the first one.
    until("the end of the program", || {
        send(&child, Signal::TERM);
        sleep(Duration::from_millis(100));
        child.try_wait().expect("a child of ours").is_some()
    });
    let (status, said) = ended(child);
    assert_eq!((status.code(), said.as_str()), (Some(143), ""));
}

#[test]
fn sim_under_nohup_ignores_the_end_of_its_terminal() {
    let _machine = share();
    let bench = Bench::new();
    let child = bench.start(&["nohup"], "sim demo.yaml --scenario long.yaml --csv a.csv");
    bench.until_size("a.csv", 50_000);
    send(&child, Signal::HUP);
    let now = fs::metadata(bench.path("a.csv")).expect("it is there").len();
    bench.until_size("a.csv", now + 200_000);
    send(&child, Signal::TERM);
    let (status, said) = ended(child);
    assert!(status.code() == Some(143) && said.contains("interrupted by SIGTERM"), "{status}: {said}");
}

/// Each of them stops the axes, switches them off and completes the recording. SIGQUIT would end a program that does
/// not handle it.
#[test]
fn run_stops_its_axes_for_every_signal_that_ends_it() {
    for (signal, name) in
        [(Signal::INT, "SIGINT"), (Signal::TERM, "SIGTERM"), (Signal::HUP, "SIGHUP"), (Signal::QUIT, "SIGQUIT")]
    {
        let (bench, domain) = (Bench::new(), Domain::take());
        let path = |name: &str| bench.path(name).to_str().expect("text").to_owned();
        let (cell, scenario, bag) = (path("demo.yaml"), path("long.yaml"), path("a.mcap"));
        let mut command = wrapped(USUAL);
        command.args(["run", &cell, "--scenario", &scenario, "--record", &bag, "--store", "none"]);
        let mut program = Program::start_by(command, &domain);
        program.wait_for_log("Ctrl-C ends it");
        // x is enabled by then: a bag is flushed every second.
        bench.until_size("a.mcap", 20_000);
        program.signal(signal);
        let status = program.wait_exit(PATIENCE);
        assert_eq!(status.code(), Some(0), "{name}: {}", program.log());
        assert!(program.log().contains("halting all axes"), "{name}: {}", program.log());
        let info = bench.good("bag info a.mcap");
        assert!(!info.contains("Cut:") && !info.contains("not finished"), "{name}: {info}");
    }
}

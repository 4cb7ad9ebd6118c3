//! Kills the program while it saves parameters.

use crate::support::machine::share;
use std::{
    env,
    fmt::Write,
    fs,
    io::{BufRead, BufReader},
    path::Path,
    process::{Child, Stdio},
    sync::mpsc::{Receiver, channel},
    thread::{self, JoinHandle},
    time::Duration,
};

use super::{Bench, cell, lineshaft, read};

/// Number of sets that one program saves, one in each cycle.
const SETS: u64 = 600;

/// Returns a scenario that in each cycle sets five values of two axes to the same number, one more than before, and
/// saves them.
fn scenario(from: u64) -> String {
    let mut text = format!("scenario: save and save again\ncycles: {}\nsteps:\n", SETS + 1);
    for cycle in 0..SETS {
        let n = from + cycle;
        let _ = writeln!(
            text,
            "  - {{at: {cycle}, do: [{{set_parameters: {{x.following_error_time: {n} us, x.in_position_window: {n} inc, \
             x.max_velocity: {x} inc/s, line.max_velocity: {line} inc/s, line.max_acceleration: {n}.5 inc/s^2}}}}, \
             {{save_parameters: {{axes: [line, x]}}}}]}}",
            x = 100_000 + n,
            line = 200_000 + n,
        );
    }
    text
}

/// A program that saves, and the generations that it has reported as written to the disk.
struct Saver {
    child: Child,
    told: Receiver<u64>,
    reader: JoinHandle<String>,
}

impl Saver {
    fn start(bench: &Bench, store: &Path, from: u64) -> Self {
        let scenario = bench.write("saves.yaml", &scenario(from));
        let mut command = lineshaft();
        command.arg("sim").arg(cell()).arg("--scenario").arg(scenario).arg("--store").arg(store);
        command.env("RUST_LOG", "lineshaft=debug").stdout(Stdio::null()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("the program starts");
        let stderr = child.stderr.take().expect("stderr is piped");
        let (send, told) = channel();
        let reader = thread::spawn(move || {
            let mut log = String::new();
            for line in BufReader::new(stderr).lines().map_while(Result::ok) {
                let generation =
                    line.strip_suffix(" is on the disk").and_then(|line| line.rsplit(' ').next()?.parse().ok());
                if let Some(generation) = generation {
                    // After the program was killed, the channel may have no receiver.
                    let _ = send.send(generation);
                } else {
                    log += &line;
                    log.push('\n');
                }
            }
            log
        });
        Self { child, told, reader }
    }

    /// Kills the program `moment` after the first reported generation; returns the last reported generation, and
    /// whether the program was still running.
    fn kill_after(mut self, moment: Duration) -> (u64, bool) {
        let first = self.told.recv_timeout(Duration::from_secs(30));
        thread::sleep(moment);
        self.child.kill().expect("our child");
        let status = self.child.wait().expect("our child");
        let log = self.reader.join().expect("a reader of lines does not panic");
        let first = first.unwrap_or_else(|_| panic!("nothing was saved: {log}"));
        assert!(!log.contains("panicked") && !log.contains("WARN") && !log.contains("ERROR"), "{log}");
        (self.told.try_iter().last().unwrap_or(first), status.code().is_none())
    }
}

/// Returns a pseudorandom delay below `range_us`, the same in every run of the test.
fn moment(number: u64, range_us: u64) -> Duration {
    let mixed = (number + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
    Duration::from_micros(mixed % range_us)
}

/// Returns the number that all values have; panics if they have different ones.
#[track_caller]
fn number(store: &Path) -> u64 {
    let (generation, line, x) = read(store);
    let n = x.in_position_window as f64;
    let carried = (x.following_error_time as f64, x.max_velocity, line.max_velocity, line.max_acceleration);
    assert_eq!(carried, (n * 1000.0, 100_000.0 + n, 200_000.0 + n, n + 0.5), "a mixture");
    // Each save had a different number, so each one is a generation.
    assert_eq!(generation, n as u64);
    generation
}

/// The file contains the old set or the new one, whenever the program is killed; each program starts with the set that
/// the previous one has left.
///
/// Proves: MACS-STO-04, MACS-STO-06
#[test]
fn a_program_that_is_killed_while_it_saves_leaves_the_old_set_or_the_new_one() {
    let _machine = share();
    let kills = if env::var("LINESHAFT_LONG").is_ok_and(|value| value == "1") { 1000 } else { 50 };
    let bench = Bench::new();
    let store = bench.path("p.yaml");
    let (mut last, mut killed, mut between) = (0, 0, 0);
    for kill in 0..kills {
        let (told, was_killed) = Saver::start(&bench, &store, last + 1).kill_after(moment(kill, 100_000));
        let found = number(&store);
        assert!(told > last, "kill {kill}: {told} after {last}");
        // A separate thread writes the log, and ends with the program: the last reported generation may be older than
        // the saved one.
        assert!(found >= told, "kill {kill}: {found} is on the disk, {told} was told");
        // The previous generation is complete, too: it is used if the present one is lost. The first generation has no
        // predecessor.
        if kill % 10 == 0 && found > 1 {
            let copy = bench.path("copy.yaml");
            fs::copy(bench.path("p.yaml.previous"), &copy).unwrap();
            let before = number(&copy);
            assert!(before == found || before + 1 == found, "kill {kill}: {before} before {found}");
        }
        killed += u64::from(was_killed);
        between += u64::from(found > told);
        last = found;
    }
    println!(
        "{killed} of {kills} programs were killed; {between} with a set on the disk that was not told yet; {last} sets"
    );
    assert!(killed * 2 > kills, "{killed} of {kills}: the others were at their end");
}

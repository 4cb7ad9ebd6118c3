//! Runs a child process whose output is captured and which is killed with its owner.

use std::{
    fs,
    io::{BufRead, BufReader, Read},
    panic,
    process::{Child, ChildStdin, Command, ExitStatus, Stdio},
    sync::mpsc::{self, Receiver, RecvTimeoutError},
    sync::{Arc, Mutex, Once, PoisonError},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use rustix::process::{Pid, Signal, kill_process, setpriority_process};
use tempfile::TempDir;

use super::domain::Domain;

/// Variables that would select another network, DDS configuration or RMW.
const FOREIGN: [&str; 8] = [
    "CYCLONEDDS_URI",
    "FASTDDS_DEFAULT_PROFILES_FILE",
    "FASTRTPS_DEFAULT_PROFILES_FILE",
    "FASTDDS_BUILTIN_TRANSPORTS",
    "RMW_IMPLEMENTATION",
    "ROS_DISCOVERY_SERVER",
    "ROS_LOCALHOST_ONLY",
    "ROS_STATIC_PEERS",
];

/// Lines of each process that a failed test shows: more would hide the reason of the failure.
const SHOWN: usize = 25;

/// Characters of each of these lines.
const WIDTH: usize = 300;

/// Messages of threads that panicked: a failed test repeats them below the logs, where they are not truncated.
static REASONS: Mutex<String> = Mutex::new(String::new());

/// Stores all panic messages from now on.
fn keep_reasons() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let usual = panic::take_hook();
        panic::set_hook(Box::new(move |panic| {
            let thread = thread::current();
            let line = format!("{}: {panic}\n", thread.name().unwrap_or("?"));
            REASONS.lock().unwrap_or_else(PoisonError::into_inner).push_str(&line);
            usual(panic);
        }));
    });
}

/// Returns why tests of this process have failed so far, the newest reason last.
fn reason() -> String {
    REASONS.lock().unwrap_or_else(PoisonError::into_inner).trim_end().chars().take(10 * WIDTH).collect()
}

/// A running process; killed by its process id when dropped.
pub(super) struct Captured {
    name: String,
    child: Child,
    lines: Receiver<String>,
    log: Arc<Mutex<String>>,
    readers: Vec<JoinHandle<()>>,
    /// ROS_HOME of a node: deleted with the process, so that no test finds files of another one.
    _home: Option<TempDir>,
    /// Reserved for this process until it has ended.
    _domain: Domain,
}

impl Captured {
    /// Starts `command` on loopback in `domain`.
    pub(super) fn start(name: &str, mut command: Command, domain: &Domain, stdin: Stdio) -> Self {
        keep_reasons();
        for variable in FOREIGN {
            command.env_remove(variable);
        }
        let has_home = command.get_envs().any(|(name, value)| name == "ROS_HOME" && value.is_some());
        let home =
            (!has_home).then(|| tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("room within the build"));
        if let Some(home) = &home {
            command.env("ROS_HOME", home.path());
        }
        let mut child = command
            .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
            .env("ROS_DOMAIN_ID", domain.to_string())
            .stdin(stdin)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap_or_else(|e| panic!("{name} does not start: {e}"));
        let log = Arc::new(Mutex::new(String::new()));
        let (send, lines) = mpsc::channel();
        let stdout = child.stdout.take().expect("stdout is piped");
        let stderr = child.stderr.take().expect("stderr is piped");
        let readers = vec![
            read(stdout, log.clone(), move |line| {
                // There may be no receiver for the lines of this process: they are in the log in any case.
                let _ = send.send(line);
            }),
            read(stderr, log.clone(), drop),
        ];
        Self { name: name.to_owned(), child, lines, log, readers, _home: home, _domain: domain.clone() }
    }

    pub(super) fn stdin(&mut self) -> ChildStdin {
        self.child.stdin.take().expect("stdin was asked for and is taken once")
    }

    /// Returns the next line of standard output, waiting at most `timeout`.
    #[track_caller]
    pub(super) fn line(&mut self, timeout: Duration) -> String {
        match self.lines.recv_timeout(timeout) {
            Ok(line) => line,
            Err(RecvTimeoutError::Timeout) => panic!("{} says nothing for {timeout:?}", self.name),
            Err(RecvTimeoutError::Disconnected) => panic!("{} has ended too early", self.name),
        }
    }

    #[track_caller]
    pub(super) fn signal(&self, signal: Signal) {
        let pid = Pid::from_child(&self.child);
        if let Err(e) = kill_process(pid, signal) {
            panic!("{} cannot be signalled: {e}", self.name);
        }
    }

    /// Raises its priority if that is permitted: a real device is not delayed by other programs either.
    pub(super) fn prefer(&self) {
        // Only root may do this: for other users the priority stays unchanged.
        let _ = setpriority_process(Some(Pid::from_child(&self.child)), -10);
    }

    /// Returns memory and processor time of the process and its children; `None` after it has ended.
    pub(super) fn figures(&self) -> Option<Figures> {
        let own = Figures::of(self.child.id())?;
        let children = self.children().into_iter().filter_map(|child| Figures::of(child.unsigned_abs()));
        Some(
            children.fold(own, |sum, child| Figures {
                memory: sum.memory + child.memory,
                worked: sum.worked + child.worked,
            }),
        )
    }

    /// Returns the ids of its child processes.
    pub(super) fn children(&self) -> Vec<i32> {
        let tasks = fs::read_dir(format!("/proc/{}/task", self.child.id())).into_iter().flatten().flatten();
        // The kernel lists each child under the thread that has started it.
        let children = tasks.filter_map(|task| fs::read_to_string(task.path().join("children")).ok());
        let children: Vec<String> = children.collect();
        children.iter().flat_map(|line| line.split_whitespace()).filter_map(|child| child.parse().ok()).collect()
    }

    /// Waits for the process to end by itself; returns its status.
    #[track_caller]
    pub(super) fn wait(&mut self, timeout: Duration) -> ExitStatus {
        let end = Instant::now() + timeout;
        loop {
            if let Some(status) = self.child.try_wait().expect("a child of ours can be waited for") {
                self.readers.drain(..).for_each(|r| r.join().expect("a reader of lines does not panic"));
                return status;
            }
            assert!(Instant::now() < end, "{} still runs after {timeout:?}", self.name);
            thread::sleep(Duration::from_millis(5));
        }
    }

    /// Returns all output so far.
    pub(super) fn log(&self) -> String {
        self.log.lock().expect("a reader of lines does not panic").clone()
    }
}

/// Unit of time in /proc (1/s), on every Linux.
const TICKS: f64 = 100.0;

/// Resources that a process uses.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Figures {
    /// Resident memory (MiB).
    pub(crate) memory: f64,
    /// Processor time of all threads (s).
    pub(crate) worked: f64,
}

impl Figures {
    pub(super) fn of(id: u32) -> Option<Self> {
        let read = |name: &str| fs::read_to_string(format!("/proc/{id}/{name}")).ok();
        let status = read("status")?;
        let memory = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
        let memory: f64 = memory.trim().strip_suffix(" kB")?.parse().ok()?;
        // proc(5): the fields after the name in parentheses; utime and stime are the 14th and 15th of all.
        let stat = read("stat")?;
        let ticks: Vec<f64> =
            stat.rsplit_once(')')?.1.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        let worked = ticks.get(10)? + ticks.get(11)?;
        Some(Self { memory: memory / 1024.0, worked: worked / TICKS })
    }
}

fn read(
    from: impl Read + Send + 'static,
    log: Arc<Mutex<String>>,
    each: impl Fn(String) + Send + 'static,
) -> JoinHandle<()> {
    thread::spawn(move || {
        let mut from = BufReader::new(from);
        let mut bytes = Vec::new();
        while from.read_until(b'\n', &mut bytes).is_ok_and(|n| n > 0) {
            let line = String::from_utf8_lossy(&bytes).trim_end().to_owned();
            bytes.clear();
            let mut log = log.lock().expect("a reader of lines does not panic");
            log.push_str(&line);
            log.push('\n');
            drop(log);
            each(line);
        }
    })
}

impl Drop for Captured {
    fn drop(&mut self) {
        // Both fail if it has ended, which is fine.
        let _ = self.child.kill();
        let _ = self.child.wait();
        if thread::panicking() {
            let log = self.log();
            let lines: Vec<_> = log.lines().collect();
            let shown = &lines[lines.len().saturating_sub(SHOWN)..];
            let shown: Vec<_> = shown.iter().map(|line| line.chars().take(WIDTH).collect::<String>()).collect();
            eprintln!(
                "--- the last {} of {} lines that {} wrote:\n{}\n--- {}",
                shown.len(),
                lines.len(),
                self.name,
                shown.join("\n"),
                reason()
            );
        }
    }
}

//! Starts a ROS side, and waits for its end.

use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::silence::Threads;

/// Thread or process in which a ROS side runs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// A thread of this process, for tests. A fault of the side is a fault of the process.
    #[default]
    Thread,
    /// A process of this program, which has the command `ros-side`.
    Process(PathBuf),
}

/// A side that was started.
pub(super) enum Started {
    Thread(JoinHandle<()>),
    Process(Child),
}

impl Side {
    /// Command that runs the program as a ROS side. Its standard input is the other end of the link.
    pub const COMMAND: &str = "ros-side";

    /// Returns a process of this same program, even if its file was replaced meanwhile.
    pub fn of_this_program() -> Self {
        Self::Process(PathBuf::from("/proc/self/exe"))
    }

    /// Starts a side. Returns the program's end of the link, and the side.
    pub(super) fn start(&self) -> io::Result<(UnixStream, Started)> {
        let (ours, theirs) = UnixStream::pair()?;
        let started = match self {
            Self::Thread => {
                let thread = std::thread::Builder::new().name("ros side".to_owned());
                Started::Thread(thread.spawn(move || crate::side::serve(theirs))?)
            }
            Self::Process(program) => {
                let mut command = Command::new(program);
                // A panic is reported in one line, without a backtrace.
                command.env("RUST_BACKTRACE", "0");
                command
                    .arg0("lineshaft")
                    .arg(Self::COMMAND)
                    .stdin(Stdio::from(OwnedFd::from(theirs)))
                    .stdout(Stdio::null());
                // Ctrl-Z and Ctrl-C of a terminal are only for the program. The DDS library never works again after it was
                // suspended, even for a moment. The program has to stop the axes before the side leaves the domain.
                command.process_group(0);
                Started::Process(command.spawn()?)
            }
        };
        Ok((ours, started))
    }
}

impl Started {
    /// Returns the threads that have to answer.
    pub(super) fn threads(&self) -> Threads {
        match self {
            // Its threads belong to the program; only tests run a side in this way.
            Self::Thread(_) => Threads::Process(std::process::id()),
            Self::Process(child) => Threads::Process(child.id()),
        }
    }

    /// Returns the resident memory of its process in bytes, if the system reports it.
    pub(super) fn memory(&self) -> Option<u64> {
        let statm = match self {
            Self::Thread(_) => "/proc/self/statm".to_owned(),
            Self::Process(child) => format!("/proc/{}/statm", child.id()),
        };
        let pages: u64 = std::fs::read_to_string(statm).ok()?.split(' ').nth(1)?.parse().ok()?;
        pages.checked_mul(rustix::param::page_size() as u64)
    }

    /// Waits for the end of the side, whose link has ended, and kills the process after `patience`. Returns the cause if it
    /// ended with an error and the cause is known.
    pub(super) fn end(self, patience: Duration) -> Option<String> {
        let mut child = match self {
            // A thread that hangs in the library is left running, because a thread cannot be killed.
            Self::Thread(thread) => {
                wait(patience, || thread.is_finished());
                return thread.is_finished().then(|| thread.join().err().map(|_| "it panicked".to_owned())).flatten();
            }
            Self::Process(child) => child,
        };
        if wait(patience, || !matches!(child.try_wait(), Ok(None))) {
            return match child.wait() {
                Ok(status) => (!status.success()).then(|| status.to_string()),
                Err(error) => Some(error.to_string()),
            };
        }
        // Fails if the process has just ended. A process that was killed ends at once.
        let _ = child.kill();
        child.wait().err().map(|error| error.to_string())
    }
}

/// Waits until `is_done` returns true; returns false after `patience`.
fn wait(patience: Duration, mut is_done: impl FnMut() -> bool) -> bool {
    let until = Instant::now() + patience;
    while !is_done() {
        if Instant::now() >= until {
            return false;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    true
}

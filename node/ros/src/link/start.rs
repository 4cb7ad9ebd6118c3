//! Starting a ROS side.

use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// What a ROS side runs in.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// A thread of this process: for tests. What harms it harms the process.
    #[default]
    Thread,
    /// A process of this program, which understands the command `ros-side`.
    Process(PathBuf),
}

/// A side that was started.
pub(super) enum Started {
    Thread(JoinHandle<()>),
    Process(Child),
}

impl Side {
    /// The command of the program that makes it a ROS side: its standard input is the other end of the link.
    pub const COMMAND: &str = "ros-side";

    /// A process of this very program, also where its file was replaced meanwhile.
    pub fn of_this_program() -> Self {
        Self::Process(PathBuf::from("/proc/self/exe"))
    }

    /// Starts a side; the program's end of the link.
    pub(super) fn start(&self) -> io::Result<(UnixStream, Started)> {
        let (ours, theirs) = UnixStream::pair()?;
        let started = match self {
            Self::Thread => {
                let thread = std::thread::Builder::new().name("ros side".to_owned());
                Started::Thread(thread.spawn(move || crate::side::serve(theirs))?)
            }
            Self::Process(program) => {
                let mut command = Command::new(program);
                // What it dies of is a line, not a page.
                command.env("RUST_BACKTRACE", "0");
                command
                    .arg0("lineshaft")
                    .arg(Self::COMMAND)
                    .stdin(Stdio::from(OwnedFd::from(theirs)))
                    .stdout(Stdio::null());
                // Ctrl-Z and Ctrl-C of a terminal are meant for the program: frozen even for a moment, the DDS library
                // would never work again, and before its good-bye the program has to stop the axes.
                command.process_group(0);
                Started::Process(command.spawn()?)
            }
        };
        Ok((ours, started))
    }
}

impl Started {
    /// Resident memory of its process (bytes), where the system tells.
    pub(super) fn memory(&self) -> Option<u64> {
        let statm = match self {
            Self::Thread(_) => "/proc/self/statm".to_owned(),
            Self::Process(child) => format!("/proc/{}/statm", child.id()),
        };
        let pages: u64 = std::fs::read_to_string(statm).ok()?.split(' ').nth(1)?.parse().ok()?;
        pages.checked_mul(rustix::param::page_size() as u64)
    }

    /// Waits for the side, whose link has ended; one that is late is killed. What it died of, where that can be told.
    pub(super) fn end(self, patience: Duration) -> Option<String> {
        let mut child = match self {
            // One that hangs in the library is left: nothing ends a thread.
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
        // One that has just ended cannot be killed; one that was killed ends at once.
        let _ = child.kill();
        child.wait().err().map(|error| error.to_string())
    }
}

/// Waits until something is done, or too late.
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

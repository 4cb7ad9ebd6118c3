//! Starts and controls the program under test.

use std::{
    process::{Command, ExitStatus, Stdio},
    thread,
    time::{Duration, Instant},
};

use rustix::process::{Pid, Signal, kill_process};

use super::{
    child::{Captured, Figures},
    domain::Domain,
};

/// Much longer than it needs to end.
const END: Duration = Duration::from_secs(30);

/// A running `lineshaft`.
pub(crate) struct Program(Captured);

impl Program {
    /// Starts the program with `args` on loopback in `domain`.
    pub(crate) fn start(args: &[&str], domain: &Domain) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_lineshaft"));
        command.args(args);
        Self::start_by(command, domain)
    }

    /// Starts it by a command that finally executes the program, such as a shell that sets limits first.
    pub(crate) fn start_by(command: Command, domain: &Domain) -> Self {
        Self(Captured::start("lineshaft", command, domain, Stdio::null()))
    }

    /// Sends a signal.
    #[track_caller]
    pub(crate) fn signal(&self, signal: Signal) {
        self.0.signal(signal);
    }

    /// Sends the signal of Ctrl-C.
    #[track_caller]
    pub(crate) fn interrupt(&self) {
        self.0.signal(Signal::INT);
    }

    /// Sends the signal of `systemctl stop`.
    #[track_caller]
    pub(crate) fn terminate(&self) {
        self.0.signal(Signal::TERM);
    }

    /// Kills it at once, like a power failure; it cannot react.
    #[track_caller]
    pub(crate) fn kill(&self) {
        self.0.signal(Signal::KILL);
    }

    /// Stops it, as Ctrl-Z or a debugger does.
    #[track_caller]
    pub(crate) fn freeze(&self) {
        self.0.signal(Signal::STOP);
    }

    /// Continues it.
    #[track_caller]
    pub(crate) fn thaw(&self) {
        self.0.signal(Signal::CONT);
    }

    /// Kills it and its ROS side at once, like a power failure: no process announces the end of the participant.
    #[track_caller]
    pub(crate) fn kill_both(&self) {
        let side = self.ros_side();
        // So that it does not detect the end of the program.
        kill_process(side, Signal::STOP).expect("a child of the program");
        self.kill();
        kill_process(side, Signal::KILL).expect("it is frozen");
    }

    /// Returns its ROS side; panics when there is none.
    #[track_caller]
    pub(crate) fn ros_side(&self) -> Pid {
        let children = self.0.children();
        match children.as_slice() {
            [side] => Pid::from_raw(*side).expect("the number of a process"),
            _ => panic!("one ROS side is expected, not {children:?}; {}", self.log()),
        }
    }

    /// Returns its ROS side as soon as it is another one than `before`, and `before` has ended; panics after half a
    /// minute.
    #[track_caller]
    pub(crate) fn ros_side_after(&self, before: Pid) -> Pid {
        let begun = Instant::now();
        let is_another = |children: &[i32]| matches!(children, [side] if *side != before.as_raw_nonzero().get());
        while !is_another(&self.0.children()) && begun.elapsed() < Duration::from_secs(30) {
            thread::sleep(Duration::from_millis(5));
        }
        let side = self.ros_side();
        assert_ne!(side, before, "{}", self.log());
        side
    }

    /// Returns the memory of its ROS side (MiB).
    #[track_caller]
    pub(crate) fn memory_of_ros_side(&self) -> f64 {
        let side = self.ros_side().as_raw_nonzero().get().unsigned_abs();
        Figures::of(side).expect("the ROS side lives").memory
    }

    /// Returns its present resource use, including its ROS side; panics when it has ended.
    #[track_caller]
    pub(crate) fn figures(&self) -> Figures {
        match self.0.figures() {
            Some(figures) => figures,
            None => panic!("lineshaft has ended too early"),
        }
    }

    /// Ends it with the signal of Ctrl-C; panics when it reports an error.
    #[track_caller]
    pub(crate) fn end(&mut self) {
        self.interrupt();
        let status = self.wait_exit(END);
        assert_eq!(status.code(), Some(0), "{}", self.log());
    }

    /// Waits until it ends by itself; panics after `timeout`.
    #[track_caller]
    pub(crate) fn wait_exit(&mut self, timeout: Duration) -> ExitStatus {
        self.0.wait(timeout)
    }

    /// Waits until it has written a text: lines may be written later than an answer over the network.
    #[track_caller]
    pub(crate) fn wait_for_log(&self, text: &str) {
        let end = Instant::now() + END;
        while !self.log().contains(text) {
            assert!(Instant::now() < end, "`{text}` is not written: {}", self.log());
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Returns its standard output and standard error so far.
    pub(crate) fn log(&self) -> String {
        self.0.log()
    }
}

//! Handles signals of the operating system that end a command in an orderly way.
//!
//! SIGINT (Ctrl-C), SIGTERM, SIGHUP (the terminal is closed) and SIGQUIT request an orderly end of the command. A
//! second one ends it immediately. A repetition within 0.5 s is the same request, which a terminal and a wrapper have
//! both forwarded. SIGHUP and SIGQUIT are still ignored if the program was started with them ignored (`nohup`).

use std::fmt;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicI32, Ordering};
use std::time::{Duration, Instant};
use tokio::signal::unix::{Signal as UnixSignal, SignalKind, signal};

/// Time within which another signal counts as a repetition of the first one.
pub(crate) const SAME_SIGNAL: Duration = Duration::from_millis(500);

/// A signal that ends a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EndSignal {
    /// SIGHUP: the terminal is closed.
    Hangup,
    /// SIGINT: Ctrl-C.
    Interrupt,
    /// SIGQUIT: Ctrl-\.
    Quit,
    /// SIGTERM: the usual signal of `kill` and of a service manager.
    Terminate,
}

impl EndSignal {
    const ALL: [Self; 4] = [Self::Hangup, Self::Interrupt, Self::Quit, Self::Terminate];

    fn kind(self) -> SignalKind {
        match self {
            Self::Hangup => SignalKind::hangup(),
            Self::Interrupt => SignalKind::interrupt(),
            Self::Quit => SignalKind::quit(),
            Self::Terminate => SignalKind::terminate(),
        }
    }

    /// Returns the exit code of a command that this signal ended before its result: 128 + the number of the signal, as
    /// in shells.
    pub fn exit_code(self) -> u8 {
        u8::try_from(128 + self.kind().as_raw_value()).unwrap_or(u8::MAX)
    }
}

impl fmt::Display for EndSignal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Hangup => "SIGHUP",
            Self::Interrupt => "SIGINT",
            Self::Quit => "SIGQUIT",
            Self::Terminate => "SIGTERM",
        })
    }
}

/// A request to end a long calculation; by default there is none. Clones share it.
#[derive(Clone, Debug, Default)]
pub struct Interrupt(Arc<AtomicI32>);

impl Interrupt {
    /// Waits for signals in a separate thread. The first one is the request, a second one ends the process immediately.
    ///
    /// # Errors
    /// Returns an error if the operating system delivers no signals or creates no thread.
    pub(crate) fn listen() -> io::Result<Self> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        // Signals are received from here on, not only once the thread runs.
        let inside = runtime.enter();
        let signals = Signals::new()?;
        drop(inside);
        let interrupt = Self::default();
        let by_signals = interrupt.clone();
        let thread = std::thread::Builder::new().name("signals".to_owned());
        thread.spawn(move || runtime.block_on(pass_on(signals, by_signals)))?;
        Ok(interrupt)
    }

    /// Sets the request, unless one was set before.
    pub fn request(&self, signal: EndSignal) {
        // An earlier request is kept.
        let _ = self.0.compare_exchange(0, signal.kind().as_raw_value(), Ordering::Relaxed, Ordering::Relaxed);
    }

    /// Returns the signal of the request, if there is one.
    pub fn requested(&self) -> Option<EndSignal> {
        let number = self.0.load(Ordering::Relaxed);
        EndSignal::ALL.into_iter().find(|signal| number != 0 && signal.kind().as_raw_value() == number)
    }
}

async fn pass_on(mut signals: Signals, interrupt: Interrupt) {
    let mut first = None;
    loop {
        let signal = signals.recv().await;
        let begun: Instant = *first.get_or_insert_with(Instant::now);
        if begun.elapsed() >= SAME_SIGNAL {
            std::process::exit(signal.exit_code().into());
        }
        interrupt.request(signal);
    }
}

/// Receiver of the signals that end the program, for a runtime.
pub(crate) struct Signals {
    interrupt: UnixSignal,
    terminate: UnixSignal,
    hangup: Option<UnixSignal>,
    quit: Option<UnixSignal>,
}

impl Signals {
    /// Receives signals from now on. A runtime must be entered.
    ///
    /// # Errors
    /// Returns an error if the operating system delivers no signals.
    pub(crate) fn new() -> io::Result<Self> {
        let ignored = std::fs::read_to_string("/proc/self/status").ok().and_then(|status| ignored(&status));
        let unless_ignored = |end: EndSignal| {
            let is_ignored = ignored.is_some_and(|mask| is_in(mask, end.kind()));
            (!is_ignored).then(|| signal(end.kind())).transpose()
        };
        Ok(Self {
            interrupt: signal(SignalKind::interrupt())?,
            terminate: signal(SignalKind::terminate())?,
            hangup: unless_ignored(EndSignal::Hangup)?,
            quit: unless_ignored(EndSignal::Quit)?,
        })
    }

    /// Waits for the next signal.
    pub(crate) async fn recv(&mut self) -> EndSignal {
        let Self { interrupt, terminate, hangup, quit } = self;
        tokio::select! {
            _ = interrupt.recv() => EndSignal::Interrupt,
            _ = terminate.recv() => EndSignal::Terminate,
            () = received(hangup) => EndSignal::Hangup,
            () = received(quit) => EndSignal::Quit,
        }
    }
}

/// Waits for a signal; forever if it is ignored.
async fn received(signal: &mut Option<UnixSignal>) {
    match signal {
        Some(signal) => {
            signal.recv().await;
        }
        None => std::future::pending().await,
    }
}

/// Returns the signals that a process ignores, from its /proc/PID/status: bit 0 is signal 1.
fn ignored(status: &str) -> Option<u64> {
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"))?;
    u64::from_str_radix(mask.trim(), 16).ok()
}

fn is_in(mask: u64, kind: SignalKind) -> bool {
    let bit = u32::try_from(kind.as_raw_value() - 1).ok().and_then(|place| 1_u64.checked_shl(place));
    bit.is_some_and(|bit| mask & bit != 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// signal(7): SIGHUP is 1, SIGINT 2, SIGQUIT 3, SIGTERM 15; a shell reports 128 more.
    #[test]
    fn exit_codes_are_those_of_a_shell() {
        let codes = EndSignal::ALL.map(|signal| (signal.to_string(), signal.exit_code()));
        let expected = [("SIGHUP", 129), ("SIGINT", 130), ("SIGQUIT", 131), ("SIGTERM", 143)];
        assert_eq!(codes, expected.map(|(name, code)| (name.to_owned(), code)));
    }

    #[test]
    fn first_request_counts() {
        let interrupt = Interrupt::default();
        assert_eq!(interrupt.requested(), None);
        interrupt.clone().request(EndSignal::Terminate);
        interrupt.request(EndSignal::Interrupt);
        assert_eq!(interrupt.requested(), Some(EndSignal::Terminate));
    }

    /// proc(5): masks are hexadecimal, the lowest bit is signal 1. `nohup` ignores SIGHUP; Rust ignores SIGPIPE (13).
    #[test]
    fn nohup_is_seen_in_the_status_of_the_process() {
        let mask = ignored("Name:\tlineshaft\nSigBlk:\t0000000000000000\nSigIgn:\t0000000000001001\n").unwrap();
        assert!(is_in(mask, SignalKind::hangup()));
        assert!(!is_in(mask, SignalKind::quit()) && !is_in(mask, SignalKind::terminate()));
        assert_eq!(ignored("Name:\tlineshaft\n"), None);
    }
}

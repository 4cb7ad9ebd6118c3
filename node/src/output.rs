//! Standard output and standard error of the program; all commands print through this module.
//!
//! A write error, for example of a full disk, is stored until the command ends: [`finish`] returns it, and the command
//! line reports it. A closed pipe (`lineshaft signals cell.yaml | head`) is no error. Errors of standard error are
//! ignored, because they cannot be reported; the macros of the standard library panic there.
#![expect(clippy::disallowed_methods, reason = "no other module writes to standard output")]

use rustix::termios::tcgetwinsize;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::sync::{Mutex, PoisonError};

macro_rules! eprint {
    ($($text:tt)*) => { $crate::output::complain(format_args!($($text)*)) };
}

macro_rules! eprintln {
    ($($text:tt)*) => { $crate::output::complain(format_args!("{}\n", format_args!($($text)*))) };
}

/// Prints to standard error, if possible.
pub(crate) fn complain(text: std::fmt::Arguments<'_>) {
    // This error could not be reported anywhere.
    let _ = io::stderr().write_fmt(text);
}

/// The first write error.
static FAILURE: Mutex<Option<io::Error>> = Mutex::new(None);

/// Prints a text; returns whether further output is useful.
pub(crate) fn print(text: &str) -> bool {
    StandardOutput.write_all(text.as_bytes()).is_ok()
}

/// Prints a text and a line feed; returns whether further output is useful.
pub(crate) fn print_line(text: &dyn std::fmt::Display) -> bool {
    print(&format!("{text}\n"))
}

/// Standard output as a writer. An error is stored for [`finish`]; the caller need not handle it.
#[derive(Debug)]
pub(crate) struct StandardOutput;

impl Write for StandardOutput {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        kept(io::stdout().write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        kept(io::stdout().flush())
    }
}

/// Stores the first write error for [`finish`], and returns the result.
pub(crate) fn kept<T>(written: io::Result<T>) -> io::Result<T> {
    if let Err(error) = &written
        && is_failure(error.kind())
    {
        let same = error.raw_os_error().map_or_else(|| error.kind().into(), io::Error::from_raw_os_error);
        FAILURE.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(same);
    }
    written
}

/// Returns false for a closed pipe, and for an interrupted call, which is repeated.
fn is_failure(kind: ErrorKind) -> bool {
    !matches!(kind, ErrorKind::BrokenPipe | ErrorKind::Interrupted)
}

/// Flushes standard output at the end of a command.
///
/// # Errors
/// Returns the first error of any write or flush since the start of the program.
pub(crate) fn finish() -> io::Result<()> {
    // An error of the flush is stored like any other.
    let _ = StandardOutput.flush();
    FAILURE.lock().unwrap_or_else(PoisonError::into_inner).take().map_or(Ok(()), Err)
}

/// Returns the width of the terminal at standard output, in columns; `None` if it is no terminal.
pub(crate) fn columns() -> Option<usize> {
    let out = io::stdout();
    let size = out.is_terminal().then(|| tcgetwinsize(&out).ok()).flatten();
    size.map(|size| usize::from(size.ws_col))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_pipe_is_no_failure_and_full_disk_is_one() {
        assert!(!is_failure(ErrorKind::BrokenPipe));
        assert!(!is_failure(ErrorKind::Interrupted));
        assert!(is_failure(ErrorKind::StorageFull));
        assert!(is_failure(ErrorKind::PermissionDenied));
    }
}

//! Serial line or pseudo terminal as a raw, non-blocking byte stream.
//!
//! Law      8 data bits, no parity, 1 stop bit, no handshake, no echo; bytes that were received before opening are dropped
//! Refuses  a path that is no terminal; a terminal that another program uses; a baud rate that the line does not support
//! Source   termios(3), tty_ioctl(4)

use super::OpenFailure;
use rustix::fs::{Mode, OFlags};
use rustix::io::Errno;
use rustix::termios::{ControlModes, OptionalActions, QueueSelector};
use rustix::{fs, termios};
use std::fs::{File, TryLockError};
use std::io::{self, Read, Write};
use std::path::Path;

/// Open line with exclusive access.
#[derive(Debug)]
pub(super) struct Tty(File);

impl Tty {
    /// Opens a line at `baud` (bit/s), which a pseudo terminal ignores.
    pub(super) fn open(path: &Path, baud: u32) -> Result<Self, OpenFailure> {
        // Without NONBLOCK, opening a line without carrier would block; with NOCTTY, a hang-up does not end this process.
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
        let file = File::from(fs::open(path, flags, Mode::empty()).map_err(obstacle)?);
        let mut settings = termios::tcgetattr(&file).map_err(obstacle)?;
        // The exclusive flag locks out other users; the lock also locks out programs of root that check it, as this one does.
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => return Err(OpenFailure::Busy),
            // Programs cannot use locks on a file system without them.
            Err(TryLockError::Error(_)) | Ok(()) => {}
        }
        termios::ioctl_tiocexcl(&file).map_err(obstacle)?;
        let tty = Self(file);
        settings.make_raw();
        settings.control_modes |= ControlModes::CLOCAL | ControlModes::CREAD;
        settings.control_modes -= ControlModes::CRTSCTS | ControlModes::CSTOPB;
        settings.set_speed(baud).map_err(|_| OpenFailure::Baud(baud))?;
        termios::tcsetattr(&tty.0, OptionalActions::Now, &settings).map_err(|error| match error {
            Errno::INVAL => OpenFailure::Baud(baud),
            error => obstacle(error),
        })?;
        termios::tcflush(&tty.0, QueueSelector::IOFlush).map_err(obstacle)?;
        Ok(tty)
    }
}

fn obstacle(error: Errno) -> OpenFailure {
    match error {
        Errno::NOENT | Errno::NODEV | Errno::NXIO => OpenFailure::NoDevice,
        Errno::ACCESS | Errno::PERM => OpenFailure::Denied,
        Errno::BUSY => OpenFailure::Busy,
        Errno::NOTTY | Errno::ISDIR => OpenFailure::NoLine,
        error => OpenFailure::System(error.into()),
    }
}

impl Drop for Tty {
    fn drop(&mut self) {
        // If another process has the line open too, the flag would stay after this program has closed it. The line may be gone.
        let _ = termios::ioctl_tiocnxcl(&self.0);
    }
}

impl Read for Tty {
    fn read(&mut self, room: &mut [u8]) -> io::Result<usize> {
        self.0.read(room)
    }
}

impl Write for Tty {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

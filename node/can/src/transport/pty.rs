//! Adapter side of slcan on a pseudo terminal: a CAN master opens the terminal like an adapter.
//!
//! Law      S sets the bit rate, O opens the channel, C closes it; frames pass only while it is open. The answer is CR for success, BEL for
//!          a refusal, `z` with CR for a frame
//! Refuses  a path that exists; unknown commands, and commands that are not allowed in the present state
//! Source   CANUSB manual (Lawicel), pty(7)

use super::piece::Piece;
use super::slcan::{BEL, CR, Line, bit_rates, frame_of};
use super::way::{Loss, TransportState};
use super::{Transport, TransportError};
use crate::Frame;
use lineshaft_core::drive::BusState;
use rustix::fs::{OFlags, fcntl_setfl};
use rustix::pty::{OpenptFlags, ioctl_tiocgptpeer, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, ioctl_tiocnxcl, tcgetattr, tcsetattr};
use std::collections::VecDeque;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read, Write};
use std::os::fd::OwnedFd;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};

/// Answers to a command: success and refusal.
const DONE: &[u8] = &[CR];
const REFUSED: &[u8] = &[BEL];
/// Maximum number of bytes that wait for the master: a few hundred frames.
const ROOM: usize = 8 * 1024;
/// Maximum length of a command line.
const LONGEST: usize = 64;

/// Reason why the pseudo terminal could not be opened.
#[derive(Debug, thiserror::Error)]
pub enum PtyError {
    /// The path exists.
    #[error("{0} exists already; remove it, or give another path")]
    Taken(PathBuf),
    /// The system refuses it.
    #[error("{0}: no pseudo terminal: {1}")]
    System(PathBuf, io::Error),
}

/// Opens a pseudo terminal and serves it as an adapter. `link` is a symbolic link to it that exists until the transport is dropped.
///
/// # Errors
/// The path exists, or the system has no pseudo terminal.
pub fn slcan_pty(link: &Path) -> Result<impl Transport + use<>, PtyError> {
    Pty::open(link).map(SlcanAdapter::new).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => PtyError::Taken(link.to_owned()),
        _ => PtyError::System(link.to_owned(), error),
    })
}

/// Byte stream to a master.
trait MasterStream: Read + Write {
    /// Called when the master has opened the channel.
    fn note_opened(&mut self) {}
}

/// Pseudo terminal.
#[derive(Debug)]
struct Pty {
    controller: File,
    /// Terminal end, which a master opens. While it is open here, the terminal stays after a master closes it.
    terminal: OwnedFd,
    path: PathBuf,
    link: PathBuf,
}

impl Pty {
    fn open(link: &Path) -> io::Result<Self> {
        let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
        let controller = openpt(flags)?;
        unlockpt(&controller)?;
        let terminal = ioctl_tiocgptpeer(&controller, flags)?;
        let mut settings = tcgetattr(&terminal)?;
        settings.make_raw();
        tcsetattr(&terminal, OptionalActions::Now, &settings)?;
        fcntl_setfl(&controller, OFlags::RDWR | OFlags::NONBLOCK)?;
        let path = PathBuf::from(OsStr::from_bytes(ptsname(&controller, Vec::<u8>::new())?.as_bytes()));
        symlink(&path, link)?;
        Ok(Self { controller: File::from(controller), terminal, path, link: link.to_owned() })
    }
}

impl MasterStream for Pty {
    fn note_opened(&mut self) {
        // The exclusive flag of a killed master would lock out the next one. It may be cleared already.
        let _ = ioctl_tiocnxcl(&self.terminal);
    }
}

impl Drop for Pty {
    fn drop(&mut self) {
        if fs::read_link(&self.link).is_ok_and(|path| path == self.path) {
            // The link may be removed already; errors cannot be handled here.
            let _ = fs::remove_file(&self.link);
        }
    }
}

impl Read for Pty {
    fn read(&mut self, room: &mut [u8]) -> io::Result<usize> {
        self.controller.read(room)
    }
}

impl Write for Pty {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.controller.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Adapter whose bus is this program.
#[derive(Debug)]
struct SlcanAdapter<S> {
    stream: S,
    way: TransportState,
    is_open: bool,
    /// Present input line, up to its CR.
    line: Vec<u8>,
    piece: Piece,
    /// Bytes for the master.
    waiting: VecDeque<u8>,
}

impl<S: MasterStream> SlcanAdapter<S> {
    fn new(stream: S) -> Self {
        Self {
            stream,
            way: TransportState::default(),
            is_open: false,
            line: Vec::with_capacity(LONGEST),
            piece: Piece::new(),
            waiting: VecDeque::with_capacity(ROOM),
        }
    }

    /// Decodes the rest of the present piece up to the end of a frame.
    fn next_frame(&mut self) -> Option<Frame> {
        while let Some(byte) = self.piece.next() {
            if byte != CR {
                // A line that is too long is not a command: its first bytes are kept and refused.
                if self.line.len() < LONGEST {
                    self.line.push(byte);
                }
                continue;
            }
            let frame = self.obey();
            self.line.clear();
            if frame.is_some() {
                return frame;
            }
        }
        None
    }

    /// Executes a command line. Returns the frame if it contains one.
    fn obey(&mut self) -> Option<Frame> {
        let digits = 0..bit_rates().count();
        let mut frame = None;
        let answer: &[u8] = match self.line.as_slice() {
            [] => return None,
            [b't' | b'r', ..] if self.is_open => {
                frame = frame_of(&self.line);
                if frame.is_some() { b"z\r".as_slice() } else { REFUSED }
            }
            [b'S', digit] if !self.is_open && digits.contains(&usize::from(digit.wrapping_sub(b'0'))) => DONE,
            [b'O'] if !self.is_open => {
                self.is_open = true;
                self.stream.note_opened();
                DONE
            }
            [b'C'] if self.is_open => {
                self.is_open = false;
                self.waiting.clear();
                DONE
            }
            [b'V'] => b"V0101\r",
            [b'N'] => b"N0001\r",
            [b'F'] if self.is_open => b"F00\r",
            _ => REFUSED,
        };
        if self.waiting.len() + answer.len() <= ROOM {
            self.waiting.extend(answer);
        }
        frame
    }
}

impl<S: MasterStream + Send> Transport for SlcanAdapter<S> {
    fn send(&mut self, frame: &Frame) -> Result<(), TransportError> {
        self.flush()?;
        // While the channel is closed, no master receives.
        if self.is_open {
            let line = Line::of(frame);
            if self.waiting.len() + line.bytes().len() > ROOM {
                return Err(TransportError::Full(self.waiting.iter().filter(|byte| **byte == CR).count()));
            }
            self.waiting.extend(line.bytes());
        }
        self.flush()
    }

    fn flush(&mut self) -> Result<(), TransportError> {
        self.way.check()?;
        while !self.waiting.is_empty() {
            match self.way.unless_would_block(self.stream.write(self.waiting.as_slices().0))? {
                Some(0) => return Err(self.way.mark_lost(Loss::Ended)),
                Some(count) => drop(self.waiting.drain(..count)),
                None => break,
            }
        }
        Ok(())
    }

    fn receive(&mut self) -> Result<Option<Frame>, TransportError> {
        loop {
            if let Some(frame) = self.next_frame() {
                return Ok(Some(frame));
            }
            self.flush()?;
            if !self.piece.read(&mut self.stream, &mut self.way)? {
                return Ok(None);
            }
        }
    }

    fn state(&self) -> BusState {
        self.way.state(BusState::Active)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Id;
    use crate::transport::{Address, Options, open};
    use std::thread;
    use std::time::{Duration, Instant};

    /// Input from and output to the master.
    #[derive(Debug, Default)]
    struct Wire {
        says: VecDeque<u8>,
        hears: Vec<u8>,
    }

    impl MasterStream for Wire {}

    impl Read for Wire {
        fn read(&mut self, room: &mut [u8]) -> io::Result<usize> {
            room[0] = self.says.pop_front().ok_or(ErrorKind::WouldBlock)?;
            Ok(1)
        }
    }

    impl Write for Wire {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.hears.extend_from_slice(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    fn frame(id: u16, bytes: &[u8]) -> Frame {
        Frame::data(Id::new(id).unwrap(), bytes).unwrap()
    }

    /// Returns the frames of an input, and the answers.
    fn told(adapter: &mut SlcanAdapter<Wire>, says: &[u8]) -> (Vec<Frame>, String) {
        adapter.stream.says.extend(says);
        let frames = std::iter::from_fn(|| adapter.receive().unwrap()).collect();
        adapter.flush().unwrap();
        let hears = String::from_utf8(std::mem::take(&mut adapter.stream.hears)).unwrap();
        (frames, hears.replace('\r', ";").replace('\x07', "!"))
    }

    /// Commands of the CANUSB manual; `;` means CR, `!` means BEL.
    #[test]
    fn commands_are_answered_as_an_adapter_does() {
        let mut adapter = SlcanAdapter::new(Wire::default());
        assert_eq!(told(&mut adapter, b"\rC\r"), (vec![], "!".to_owned()), "it is closed already");
        assert_eq!(told(&mut adapter, b"S8\rO\r"), (vec![], ";;".to_owned()));
        assert_eq!(told(&mut adapter, b"S8\rO\rS9\rX\r"), (vec![], "!!!!".to_owned()));
        let frames = vec![frame(0x123, &[0x11, 0xFF]), Frame::remote(Id::new(0x705).unwrap(), 1).unwrap()];
        assert_eq!(told(&mut adapter, b"t123211FF\rr7051\rt12\r"), (frames, "z;z;!".to_owned()));
        assert_eq!(told(&mut adapter, b"V\rN\rF\rC\r"), (vec![], "V0101;N0001;F00;;".to_owned()));
        assert_eq!(told(&mut adapter, b"S9\rt1230\r"), (vec![], "!!".to_owned()), "closed");
    }

    #[test]
    fn frames_are_sent_while_the_channel_is_open() {
        let mut adapter = SlcanAdapter::new(Wire::default());
        adapter.send(&frame(0x181, &[1])).unwrap();
        assert_eq!(told(&mut adapter, b"O\r").1, ";");
        adapter.send(&frame(0x181, &[0xAB])).unwrap();
        assert_eq!(told(&mut adapter, b"").1, "t1811AB;");
    }

    /// The transport of a master opens the terminal, and a frame is sent in each direction. The link is removed with the terminal.
    #[test]
    fn a_master_opens_the_terminal_by_its_link() {
        let link = std::env::temp_dir().join(format!("lineshaft-slcan-pty-{}", std::process::id()));
        let mut adapter = slcan_pty(&link).unwrap();
        let taken = slcan_pty(&link).err().map(|error| error.to_string());
        assert_eq!(taken, Some(format!("{} exists already; remove it, or give another path", link.display())));
        let served = thread::spawn(move || {
            let begin = Instant::now();
            let heard = loop {
                let heard = adapter.receive().unwrap();
                if heard.is_some() || begin.elapsed() > Duration::from_secs(20) {
                    break heard;
                }
                thread::sleep(Duration::from_millis(1));
            };
            adapter.send(&frame(0x581, &[2])).unwrap();
            (adapter, heard)
        });
        let mut master = open(&Address::Slcan(link.clone()), Options { bit_rate: 500_000, baud: None }).unwrap();
        master.send(&frame(0x601, &[1])).unwrap();
        let (adapter, heard) = served.join().unwrap();
        assert_eq!(heard, Some(frame(0x601, &[1])));
        let begin = Instant::now();
        let answer = loop {
            match master.receive().unwrap() {
                None if begin.elapsed() < Duration::from_secs(5) => thread::sleep(Duration::from_millis(1)),
                answer => break answer,
            }
        };
        assert_eq!(answer, Some(frame(0x581, &[2])));
        drop(adapter);
        assert!(link.symlink_metadata().is_err());
    }
}

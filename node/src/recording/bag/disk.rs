//! Buffered output of a bag file: bytes reach the disk in whole flushes, or not at all.

use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Destination of the bytes of a file.
pub(in crate::recording) trait Medium: Write + Send {
    /// Truncates it to `length` bytes, at most its current length, and continues writing there.
    fn cut(&mut self, length: u64) -> io::Result<()>;
}

impl Medium for File {
    fn cut(&mut self, length: u64) -> io::Result<()> {
        self.set_len(length)?;
        self.seek(SeekFrom::Start(length)).map(drop)
    }
}

/// A buffered medium. After the first error it accepts no more data, so that later writes cannot damage the flushed
/// data.
pub(super) struct Disk {
    medium: Box<dyn Medium>,
    pending: Vec<u8>,
    flushed: Arc<AtomicU64>,
    is_broken: bool,
}

impl Disk {
    /// Returns the disk, and the number of bytes of it that have been flushed.
    pub(super) fn new(medium: Box<dyn Medium>) -> (Self, Arc<AtomicU64>) {
        let flushed = Arc::new(AtomicU64::new(0));
        (Self { medium, pending: Vec::new(), flushed: Arc::clone(&flushed), is_broken: false }, flushed)
    }

    fn check(&self) -> io::Result<()> {
        if self.is_broken { Err(io::Error::other("nothing is written after an error")) } else { Ok(()) }
    }
}

impl Write for Disk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.check()?;
        self.pending.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.check()?;
        let length = self.flushed.load(Ordering::Relaxed);
        if let Err(error) = self.medium.write_all(&self.pending).and_then(|()| self.medium.flush()) {
            self.is_broken = true;
            self.pending = Vec::new();
            // If this fails too, the incomplete end stays; a reader stops before it.
            let _ = self.medium.cut(length);
            return Err(error);
        }
        self.flushed.store(length + self.pending.len() as u64, Ordering::Relaxed);
        self.pending.clear();
        Ok(())
    }
}

/// Returns the position; the MCAP writer requests nothing else.
impl Seek for Disk {
    fn seek(&mut self, place: SeekFrom) -> io::Result<u64> {
        let end = self.flushed.load(Ordering::Relaxed) + self.pending.len() as u64;
        if place == SeekFrom::Current(0) { Ok(end) } else { Err(io::ErrorKind::Unsupported.into()) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::full_disk::{Small, Space};
    use super::*;

    #[test]
    fn flush_is_complete_or_absent_and_nothing_is_written_after_an_error() {
        let space = Space::of(10);
        let (mut disk, flushed) = Disk::new(Box::new(Small::new(&space)));
        disk.write_all(b"12345").unwrap();
        assert_eq!(space.bytes(), b"");
        assert_eq!(disk.stream_position().unwrap(), 5);
        disk.flush().unwrap();
        disk.write_all(b"6789").unwrap();
        disk.flush().unwrap();
        disk.write_all(b"abc").unwrap();
        assert_eq!(disk.flush().unwrap_err().kind(), io::ErrorKind::StorageFull);
        assert_eq!((space.bytes(), flushed.load(Ordering::Relaxed)), (b"123456789".to_vec(), 9));
        assert!(disk.write_all(b"0").is_err() && disk.flush().is_err());
        assert_eq!(space.bytes(), b"123456789");
        assert!(disk.seek(SeekFrom::Start(0)).is_err());
    }
}

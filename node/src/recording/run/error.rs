//! Reasons why a run cannot be read, and descriptions of lost data.

use super::grouped;
use std::fmt;
use std::path::PathBuf;

/// Reason why a run cannot be opened or read further.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The path does not exist or is not readable.
    #[error("{}: {error}", .path.display())]
    Open {
        /// Given path.
        path: PathBuf,
        /// Error of the operating system.
        error: std::io::Error,
    },
    /// The path is neither a file nor a folder.
    #[error("{}: a file or a folder is expected", .path.display())]
    Special {
        /// Given path.
        path: PathBuf,
    },
    /// The folder has no recordings.
    #[error("{}: there is no .mcap file in this folder", .path.display())]
    Empty {
        /// Path of the folder.
        path: PathBuf,
    },
    /// The folder has files of several runs.
    #[error(
        "{}: {first} and {other} were not recorded with the same cell and are no parts of one run; name one of them",
        .path.display()
    )]
    Unrelated {
        /// Path of the folder.
        path: PathBuf,
        /// First file in the folder.
        first: String,
        /// File of another run.
        other: String,
    },
    /// The storage format is that of older recorders.
    #[error("{}: this is a bag in an sqlite3 database; `ros2 bag convert` makes an MCAP file of it", .path.display())]
    Database {
        /// Path of the database.
        path: PathBuf,
    },
    /// A file or its messages have an additional compression.
    #[error("{}: {what}, which is not read; {hint}", .path.display())]
    Compressed {
        /// Path of the file or of the metadata.yaml of the bag.
        path: PathBuf,
        /// Name of the compressed part.
        what: &'static str,
        /// How to get a readable bag.
        hint: &'static str,
    },
    /// The file has another format.
    #[error("{}: this is no MCAP file", .path.display())]
    NoMcap {
        /// Path of the file.
        path: PathBuf,
    },
    /// The metadata.yaml of a bag has errors.
    #[error("{0}")]
    Description(String),
    /// The bytes of a file cannot be read.
    #[error("{file}, byte {}: {error}", grouped(*.at))]
    Read {
        /// Name of the file.
        file: String,
        /// Offset in the file, in bytes.
        at: u64,
        /// Error of the operating system.
        error: std::io::Error,
    },
    /// The content of a file is damaged or not supported.
    #[error("{file}, byte {}: {damage}", grouped(*.at))]
    Damaged {
        /// Name of the file.
        file: String,
        /// Offset of the record, in bytes.
        at: u64,
        /// Kind of damage.
        damage: Damage,
    },
}

/// Damage of a record.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Damage {
    /// The fields do not fit the record.
    #[error("the fields of this record do not fit into it")]
    Record,
    /// A text is not UTF-8.
    #[error("a text of this record is no UTF-8")]
    Text,
    /// A length exceeds the rest of a finished file.
    #[error("this record claims {} bytes, {} are left in the file", grouped(*.claimed), grouped(*.left))]
    Length {
        /// Length given by the record, in bytes.
        claimed: u64,
        /// Remaining length of the file, in bytes.
        left: u64,
    },
    /// A length exceeds the maximum that is read into memory.
    #[error("{what} would take {} bytes, at most {} are read", grouped(*.bytes), grouped(*.most))]
    TooLong {
        /// Kind of record.
        what: &'static str,
        /// Length, in bytes.
        bytes: u64,
        /// Maximum length, in bytes.
        most: u64,
    },
    /// The kind of record is unknown.
    #[error("no record begins with {0:#04x}")]
    Opcode(u8),
    /// The first record is no header.
    #[error("a header is expected as first record")]
    NoHeader,
    /// The checksum of a chunk is wrong.
    #[error("the content of this chunk has the checksum {found:08x}, {written:08x} was written")]
    ChunkCrc {
        /// CRC of the content.
        found: u32,
        /// CRC in the file.
        written: u32,
    },
    /// The checksum of a file is wrong.
    #[error("the content up to here has the checksum {found:08x}, {written:08x} was written")]
    FileCrc {
        /// CRC of the content.
        found: u32,
        /// CRC in the file.
        written: u32,
    },
    /// The checksum of the index and the footer is wrong.
    #[error("the index from here on has the checksum {found:08x}, {written:08x} was written")]
    IndexCrc {
        /// CRC of the content.
        found: u32,
        /// CRC in the file.
        written: u32,
    },
    /// A data record is after the end of the data.
    #[error("{0} stands within the index")]
    InIndex(&'static str),
    /// The file does not end with the magic bytes of the format.
    #[error("the mark of the format is expected behind the footer")]
    NoMark,
    /// There are bytes after the end of the file format.
    #[error("{} bytes follow the end of the recording, they are not read", grouped(*.bytes))]
    TrailingBytes {
        /// Number of bytes.
        bytes: u64,
    },
    /// The checksum of an attachment is wrong.
    #[error("attachment {name} has the checksum {found:08x}, {written:08x} was written")]
    AttachmentCrc {
        /// Name of the attachment.
        name: String,
        /// CRC of the content.
        found: u32,
        /// CRC in the file.
        written: u32,
    },
    /// Compressed content cannot be unpacked.
    #[error("the content of this chunk does not decompress: {0}")]
    Decompression(String),
    /// The unpacked content has a wrong size.
    #[error("the content of this chunk is {} bytes, {} are announced", grouped(*.found), grouped(*.announced))]
    Size {
        /// Actual size, in bytes.
        found: u64,
        /// Size given by the chunk, in bytes.
        announced: u64,
    },
    /// The records in a chunk do not fit it.
    #[error("the records within this chunk do not fit into it")]
    ChunkRecords,
    /// The compression is not supported.
    #[error("this chunk is compressed with `{0}`; zstd, lz4 or none is read")]
    Compression(String),
    /// A message has no channel.
    #[error("a message is of channel {0}, which no record describes")]
    Channel(u16),
    /// A channel has no schema.
    #[error("topic {topic} is of schema {schema}, which no record describes")]
    Schema {
        /// Topic of the channel.
        topic: String,
        /// Number of the schema.
        schema: u16,
    },
    /// A number is used twice.
    #[error("{what} {id} is described twice, not in the same way")]
    Conflict {
        /// Channel or schema.
        what: &'static str,
        /// The number.
        id: u16,
    },
    /// The index begins before the end of the data.
    #[error("the index begins before a record of the data's end")]
    NoDataEnd,
}

/// Missing part at the end of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// The magic bytes at the start are incomplete.
    Start,
    /// The file ends within a record of this kind.
    Within(&'static str),
    /// The file ends between two records.
    NoEnd,
    /// The index after the data is incomplete; no message is missing.
    Index,
    /// The rest is zeros, as a file system leaves them after a power failure.
    Zeros,
}

/// A file that was cut off; it is read up to its last complete chunk or record.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cut {
    /// Name of the file.
    pub file: String,
    /// Number of bytes that are read.
    pub read_bytes: u64,
    /// Size of the file, in bytes.
    pub file_bytes: u64,
    /// Kind of the end.
    pub reason: Reason,
}

impl fmt::Display for Cut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, read_bytes, file_bytes, reason } = self;
        match reason {
            Reason::Start => write!(f, "{file}: the file ends before its first record")?,
            Reason::Within(what) => write!(f, "{file}: the file ends within {what}")?,
            Reason::NoEnd => write!(f, "{file}: the file ends without a record of its end")?,
            Reason::Index => write!(f, "{file}: the file ends within its index, behind all messages")?,
            Reason::Zeros => write!(f, "{file}: the file goes on with zeros")?,
        }
        write!(f, "; {} of {} bytes were read", grouped(*read_bytes), grouped(*file_bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sentences() {
        let cut = |reason| Cut { file: "run_0.mcap".to_owned(), read_bytes: 12_345, file_bytes: 20_000, reason };
        let sentence = "run_0.mcap: the file ends within a chunk; 12 345 of 20 000 bytes were read";
        assert_eq!(cut(Reason::Within("a chunk")).to_string(), sentence);
        assert!(cut(Reason::Zeros).to_string().starts_with("run_0.mcap: the file goes on with zeros; 12 345 of"));
        let damage = Damage::ChunkCrc { found: 1, written: 0xabc };
        assert_eq!(
            RunError::Damaged { file: "a.mcap".to_owned(), at: 1_000_000, damage }.to_string(),
            "a.mcap, byte 1 000 000: the content of this chunk has the checksum 00000001, 00000abc was written"
        );
    }
}

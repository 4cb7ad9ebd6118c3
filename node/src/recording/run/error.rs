//! Why a run cannot be read, and what of it is lost.

use super::grouped;
use std::fmt;
use std::path::PathBuf;

/// Why a run cannot be opened or read on.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// Nothing of that name, or it may not be read.
    #[error("{}: {error}", .path.display())]
    Open {
        /// What was asked for.
        path: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
    /// Neither a file nor a folder.
    #[error("{}: a file or a folder is expected", .path.display())]
    Special {
        /// What was asked for.
        path: PathBuf,
    },
    /// A folder without recordings.
    #[error("{}: there is no .mcap file in this folder", .path.display())]
    Empty {
        /// The folder.
        path: PathBuf,
    },
    /// A folder of several runs.
    #[error(
        "{}: {first} and {other} were not recorded with the same cell and are no parts of one run; name one of them",
        .path.display()
    )]
    Unrelated {
        /// The folder.
        path: PathBuf,
        /// The first file in it.
        first: String,
        /// One that does not belong to it.
        other: String,
    },
    /// The storage of older recorders.
    #[error("{}: this is a bag in an sqlite3 database; `ros2 bag convert` makes an MCAP file of it", .path.display())]
    Database {
        /// The database.
        path: PathBuf,
    },
    /// A file, or its messages, compressed from outside.
    #[error("{}: {what}, which is not read; {hint}", .path.display())]
    Compressed {
        /// The file or the bag's description.
        path: PathBuf,
        /// What is compressed.
        what: &'static str,
        /// How to come by a bag that is read.
        hint: &'static str,
    },
    /// Another format.
    #[error("{}: this is no MCAP file", .path.display())]
    NoMcap {
        /// The file.
        path: PathBuf,
    },
    /// The description of a bag has errors.
    #[error("{0}")]
    Description(String),
    /// The system does not give the bytes of a file.
    #[error("{file}, byte {}: {error}", grouped(*.at))]
    Read {
        /// Name of the file.
        file: String,
        /// Where in it (bytes).
        at: u64,
        /// What the system says.
        error: std::io::Error,
    },
    /// The content of a file is not what was written, or not what this program reads.
    #[error("{file}, byte {}: {damage}", grouped(*.at))]
    Damaged {
        /// Name of the file.
        file: String,
        /// Where the record starts (bytes).
        at: u64,
        /// What is wrong with it.
        damage: Damage,
    },
}

/// What is wrong with a record.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Damage {
    /// Fields that do not fit.
    #[error("the fields of this record do not fit into it")]
    Record,
    /// A text in another encoding.
    #[error("a text of this record is no UTF-8")]
    Text,
    /// A length beyond the end of a file that was finished.
    #[error("this record claims {} bytes, {} are left in the file", grouped(*.claimed), grouped(*.left))]
    Length {
        /// Bytes that it claims.
        claimed: u64,
        /// Bytes that are there.
        left: u64,
    },
    /// A length that no reader takes memory for.
    #[error("{what} would take {} bytes, at most {} are read", grouped(*.bytes), grouped(*.most))]
    TooLong {
        /// What.
        what: &'static str,
        /// How long it is.
        bytes: u64,
        /// How long it may be.
        most: u64,
    },
    /// No kind of record.
    #[error("no record begins with {0:#04x}")]
    Opcode(u8),
    /// The first record is another one.
    #[error("a header is expected as first record")]
    NoHeader,
    /// A chunk's content.
    #[error("the content of this chunk has the checksum {found:08x}, {written:08x} was written")]
    ChunkCrc {
        /// Of what is there.
        found: u32,
        /// As it was written.
        written: u32,
    },
    /// A file's content.
    #[error("the content up to here has the checksum {found:08x}, {written:08x} was written")]
    FileCrc {
        /// Of what is there.
        found: u32,
        /// As it was written.
        written: u32,
    },
    /// The index and the footer.
    #[error("the index from here on has the checksum {found:08x}, {written:08x} was written")]
    IndexCrc {
        /// Of what is there.
        found: u32,
        /// As it was written.
        written: u32,
    },
    /// A record of the data behind its end.
    #[error("{0} stands within the index")]
    InIndex(&'static str),
    /// Another end than the format's mark.
    #[error("the mark of the format is expected behind the footer")]
    NoMark,
    /// More than a file.
    #[error("{} bytes follow the end of the recording, they are not read", grouped(*.bytes))]
    Behind {
        /// How many.
        bytes: u64,
    },
    /// An attachment's content.
    #[error("attachment {name} has the checksum {found:08x}, {written:08x} was written")]
    AttachmentCrc {
        /// Its name.
        name: String,
        /// Of what is there.
        found: u32,
        /// As it was written.
        written: u32,
    },
    /// Compressed content that is none.
    #[error("the content of this chunk does not decompress: {0}")]
    Packed(String),
    /// Compressed content of another size.
    #[error("the content of this chunk is {} bytes, {} are announced", grouped(*.found), grouped(*.announced))]
    Size {
        /// Bytes that are there.
        found: u64,
        /// Bytes that the chunk announces.
        announced: u64,
    },
    /// Records in a chunk that do not fit.
    #[error("the records within this chunk do not fit into it")]
    Inside,
    /// A compression that is not read.
    #[error("this chunk is compressed with `{0}`; zstd, lz4 or none is read")]
    Compression(String),
    /// A message without a channel.
    #[error("a message is of channel {0}, which no record describes")]
    Channel(u16),
    /// A channel without its schema.
    #[error("topic {topic} is of schema {schema}, which no record describes")]
    Schema {
        /// Its topic.
        topic: String,
        /// The schema's number.
        schema: u16,
    },
    /// The same number twice.
    #[error("{what} {id} is described twice, not in the same way")]
    Conflict {
        /// A channel or a schema.
        what: &'static str,
        /// Its number.
        id: u16,
    },
    /// The index begins where the data has not ended.
    #[error("the index begins before a record of the data's end")]
    NoDataEnd,
}

/// What is missing at the end of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// Not even the format's mark is whole.
    Start,
    /// Within a record; which kind.
    Within(&'static str),
    /// Between two records.
    NoEnd,
    /// Behind the data: the index is not whole, no message is missing.
    Index,
    /// Zeros from there on, as a file system leaves them after a loss of power.
    Zeros,
}

/// A file that was cut off: it is read up to its last whole chunk or record.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cut {
    /// Name of the file.
    pub file: String,
    /// Bytes that are read.
    pub read_bytes: u64,
    /// Bytes of the file.
    pub file_bytes: u64,
    /// Where it ends.
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

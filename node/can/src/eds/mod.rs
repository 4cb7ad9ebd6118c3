//! EDS and DCF files of CANopen devices: objects of a device, their properties, and their configuration values.
//!
//! Law      a file is parsed to a dictionary, or to a list of all its errors. No content of a file causes a panic, a long delay, or memory
//!          use above the bounds
//! Refuses  other standards: XDD, and modules of CiA 306 (`[M1...]` sections are ignored)
//! Source   CiA 306-1, CiA 301, CiA 302-3

pub mod concise;
mod device;
mod dictionary;
mod entry;
mod ini;
mod node_id_sum;
mod notes;
mod object;
mod pdo;
mod problem;
mod read;
mod write;

pub use device::{Commissioning, DeviceInfo, FileInfo};
pub use dictionary::{ConfigureError, Dictionary, FindError};
pub use object::{Access, Entry, FileValue, IndexDescription, ObjectType};
pub use pdo::{CobId, PdoError, PdoMapping};
pub use problem::{EdsErrors, IgnoredKey, IgnoredKeyKind, Problem, Problems};
pub use read::parse;

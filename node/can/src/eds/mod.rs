//! Electronic data sheets and device configurations of CANopen devices (EDS and DCF files): what objects a device has, what they are, and
//! what a configuration gives them.
//!
//! Law      a file becomes a dictionary, or all that is wrong with it in sentences; nothing in a file makes this room fail, wait, or take
//!          more memory than its bounds
//! Refuses  files of other devices' standards: XDD, and the modules of CiA 306 (`[M1...]` sections are passed over)
//! Source   CiA 306-1, CiA 301, CiA 302-3

pub mod concise;
mod data_type;
mod device;
mod dictionary;
mod entry;
mod ini;
mod notes;
mod number;
mod object;
mod pdo;
mod problem;
mod read;
mod value;
mod write;

pub use data_type::DataType;
pub use device::{Commissioning, DeviceInfo, FileInfo};
pub use dictionary::{ConfigureError, Dictionary, FindError};
pub use object::{Access, Entry, Given, Head, ObjectType};
pub use pdo::{CobId, Direction, Mapped, PdoError, PdoMapping};
pub use problem::{EdsErrors, PassedKey, PassedOver, Problem, Problems};
pub use read::parse;
pub use value::{Value, ValueError};

//! Commissioning of a bus without a machine: scan, device information, object access, monitoring of frames.
//!
//! Law      calls block until they are finished. Frames are sent only as requested: no SYNC, no heartbeat, no NMT command is sent by itself
//! Refuses  access that a dictionary does not allow, before anything is sent; requests that a device refuses or does not answer, with a
//!          message
//! Source   CiA 301, CiA 402-2

mod allowed;
mod configure;
mod decode;
mod device;
mod exchange;
mod layer;
mod object;
mod pdos;
mod scan;
mod session;
pub mod words;

pub use allowed::{Refusal, check_readable, decoded, encoded, label, type_of, writable};
pub use configure::Configured;
pub use decode::{AssignedPdo, Decoder};
pub use device::{Device, Drive, ReportedState};
pub use object::{ObjectError, parse as object};
pub use pdos::PdoConfiguration;
pub use scan::{FoundNode, Scan};
pub use session::{CommissionError, LONGEST, Progress, Session};

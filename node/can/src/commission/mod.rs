//! Commissioning of a bus without a machine: who is there, what it is, its objects one by one, what goes over the bus.
//!
//! Law      whoever calls waits here; a frame goes out only for what was asked for: no SYNC, no heartbeat, no NMT of its own
//! Refuses  what a dictionary does not allow, before anything is sent; what a device refuses or does not answer, in a sentence
//! Source   CiA 301, CiA 402-2

mod allowed;
mod configure;
mod decode;
mod device;
mod exchange;
pub mod kind;
mod layer;
mod object;
mod pdos;
mod scan;
mod session;
pub mod words;

pub use allowed::{Refusal, decoded, encoded, label, readable, type_of, writable};
pub use configure::Configured;
pub use decode::{Carried, Decoder};
pub use device::{Device, Drive, Heard};
pub use object::{ObjectError, parse as object};
pub use pdos::PdoSeen;
pub use scan::{Found, Scan};
pub use session::{CommissionError, LONGEST, Progress, Session};

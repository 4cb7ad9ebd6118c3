//! CANopen master of a bus, with a cyclic half and a service half according to the backend contract.

mod asked;
mod backend;
mod bus;
mod capture;
mod configure;
mod device;
#[cfg(test)]
mod fixtures;
mod notes;
mod port;
mod service;
mod sync;
mod tally;
mod time;

pub use asked::{Access, LONGEST, MOST_WAITING, ObjectAccessError, RequestHandle, SdoRequestQueue};
pub use backend::CanBackend;
pub use capture::RecordedFrames;
pub use service::{CanService, bus};

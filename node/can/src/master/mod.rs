//! The CANopen master of a bus, in two halves behind the backend contract.

mod backend;
mod bus;
mod configure;
mod drive;
mod port;
mod service;
mod sync;

pub use backend::CanBackend;
pub use service::{CanService, bus};

//! Service data objects: reading and writing the objects of a device, beside its process data (CiA 301).
//!
//! Law      one transfer at a time; nothing here waits, has a clock or takes memory: whoever has the bus hands over frames and the
//!          time, and asks for what is to be sent
//! Refuses  what the device aborts, with its code in words; what answers wrongly or not at all
//! Source   CiA 301

mod abort;
mod client;
mod crc;

pub use abort::Abort;
pub use client::{Client, Object, SdoError, Transfer};

//! Service data objects (SDO): read and write access to the objects of a device, next to process data (CiA 301).
//!
//! Law      one transfer at a time. The client neither waits nor has a clock nor allocates memory: the caller passes received frames and
//!          the time, and fetches the frames to be sent
//! Refuses  transfers that the device aborts, with the meaning of the code; wrong or missing answers
//! Source   CiA 301

mod client;
mod crc;

pub use client::Client;

//! Ways to a bus, each behind the same words: frames go out, frames come in.

pub mod slcan;

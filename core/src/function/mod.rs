//! Function slots: small programs that run in each cycle between encoders and axes, in ascending order.
//!
//! Law      a slot reads values of this cycle from inputs, encoders and lower slots, also through memory, and values of
//!          the last cycle from axes, its own sink and higher slots
//! Reads    any signal as source, bits as E1 to E8, tables
//! Writes   one sink, bits as A1 to A8, a lead that axes follow
//! Refuses  invalid parameter sets and commands, each with the field, its value and its range; the cycle of a slot
//!          cannot fail
//! Source   spec/amkasyn-a.md to -c.md: AMKASYN fast functions; contract section 10

mod description;
mod field;
mod goal;
mod guest;
mod notice;
mod program;
mod reading;
mod sak;
mod shown;
mod slot;
mod time;
mod track;
#[cfg(test)]
mod trial;
mod types;
mod window;
mod wires;

pub use description::{AmkLimits, Description, MarkSource, Monitored, Quantity, Requirement};
pub use field::Field;
pub use program::{Drive, Fault, LINES, NO_DRIVES, WORDS};
pub use sak::{Origin, factor as sak_factor};
pub use shown::Shown;
pub(crate) use slot::Cycle;
pub use slot::{Order, Slot};
pub use types::{Kind, TYPES};
pub use wires::{Bit, Input, Mark, MemorySize, OnAxisError, Output, OutputCell, Sink, Source, Width, Wires, Word};

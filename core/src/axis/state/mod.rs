//! The parts of which the state of an axis consists: what a cycle changes.
//!
//! Law      each part has private fields and its own small methods, which need nothing but their arguments. One part
//!          alone writes the state, the source of the command, the command and the generator
//! Reads    nothing; the behaviour in the other folders of this room reads and changes the parts
//! Refuses  nothing
//! Source   docs/ARCHITECTURE.md

pub(in crate::axis) mod active_motion;
pub(in crate::axis) mod alarm_state;
pub(in crate::axis) mod command_state;
pub(in crate::axis) mod coupling_state;
pub(in crate::axis) mod cycle_state;
pub(in crate::axis) mod drive_data;
pub(in crate::axis) mod loops;
pub(in crate::axis) mod observed;
pub(in crate::axis) mod pending;
pub(in crate::axis) mod position_feedback;
pub(in crate::axis) mod sources;
pub(in crate::axis) mod status;
pub(in crate::axis) mod task;
pub(in crate::axis) mod travel;

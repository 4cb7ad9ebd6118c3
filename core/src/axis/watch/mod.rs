//! Supervision of an axis, and reactions to errors.

pub(super) mod reaction;
mod runaway;
mod safety;
mod supervision;

//! The actual position of an axis: its sources, its direction, its compensation, its switches.

mod compensation;
pub(super) mod direction;
mod position;
mod switches;
pub(super) mod velocity_encoder;

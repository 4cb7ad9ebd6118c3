//! The loops that are closed here.

mod effort;
pub(super) mod position;

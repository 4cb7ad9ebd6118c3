//! What the end-to-end tests share: the program under test, the peers that talk to it, and their set-up.
//!
//! Nothing here skips: what a test needs and cannot be had is a failure that says
//! in one sentence what to install.

pub(crate) mod bag_check;
pub(crate) mod can;
pub(crate) mod can_cell;
mod child;
pub(crate) mod domain;
pub(crate) mod machine;
pub(crate) mod namespace;
pub(crate) mod pages;
pub(crate) mod peer;
pub(crate) mod program;
pub(crate) mod proxy;
pub(crate) mod setup;

//! Shared parts of the end-to-end tests: the program under test, the peers that communicate with it, and their set-up.
//!
//! No test is skipped: if something that a test needs is not available, the test fails with a message that names the
//! package to install.

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

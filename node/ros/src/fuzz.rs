//! What must hold for anything that the network brings: tried with random bytes by the tests, and by the fuzzer in `fuzz/`,
//! for which alone the feature `fuzz` is there.

pub use crate::layer::any_request;
pub use crate::surface::any_goal;

/// Longest sentence about what a client has sent, in a small cell (bytes). It may not grow with what was sent.
pub(crate) const LONGEST_SENTENCE: usize = 600;

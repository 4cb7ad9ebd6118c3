//! Properties that must hold for any data from the network: tests check them with random bytes, and so does the fuzzer in `fuzz/`, for
//! which the feature `fuzz` exists.

pub use crate::side::any_request;
pub use crate::surface::any_goal;

/// Maximum size of a message about data of a client, in a small cell (bytes). It must not grow with that data.
pub(crate) const LONGEST_SENTENCE: usize = 600;

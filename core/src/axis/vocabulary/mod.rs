//! The vocabularies on an axis: their view of it, their steps, and the checks of their parameters.

mod order;
mod step;
mod verb;

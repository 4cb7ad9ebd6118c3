//! The Lineshaft program.

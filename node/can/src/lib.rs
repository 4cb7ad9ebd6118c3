//! CAN for Lineshaft.
#![forbid(unsafe_code)]

//! The command line of Lineshaft.
fn main() {}

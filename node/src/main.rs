//! Main program of Lineshaft.

use std::process::ExitCode;

fn main() -> ExitCode {
    lineshaft::cli::main(std::env::args())
}

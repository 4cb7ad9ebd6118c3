//! Generates the Rust types from the interface files, which are the only source.

mod files;
mod generate;
mod hash;
mod interface;
mod parse;
mod schema;

use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").ok_or("CARGO_MANIFEST_DIR is not set")?);
    let out = env::var_os("OUT_DIR").ok_or("OUT_DIR is not set")?;
    for watched in ["build", "msg", "srv", "action", files::FOREIGN] {
        println!("cargo::rerun-if-changed={watched}");
    }
    let interfaces = files::read_all(&root)?;
    let hashes = hash::hashes(&interfaces)?;
    fs::write(Path::new(&out).join("interfaces.rs"), generate::generate(&interfaces, &hashes))?;
    Ok(())
}

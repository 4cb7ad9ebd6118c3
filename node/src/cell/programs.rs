//! Reads section `programs`: modules of the user, in files next to the cell.
//!
//! Refuses  files that cannot be read, modules that no slot can run

use super::backends::Context;
use super::names::{Section, quote};
use super::tables::Files;
use crate::document::Value;
use lineshaft_core::config::ProgramConfig;
use lineshaft_program::Module;
use std::sync::Arc;

/// Reads all programs, in the order of the file.
pub(super) fn read(cx: &Context<'_>, files: &Files) -> Vec<Option<ProgramConfig>> {
    let entries = cx.names.section(Section::Programs);
    entries.iter().map(|entry| program(&entry.value, entry.name(), files)).collect()
}

fn program(value: &Value<'_>, name: &str, files: &Files) -> Option<ProgramConfig> {
    let mut map = value.map(format!("program {}", quote(name)))?;
    let wasm = map.required("wasm");
    map.finish();
    let wasm = wasm?;
    let file = wasm.text()?;
    let module = match files.module(file) {
        Ok(bytes) => Module::load(&bytes).map_err(|refused| format!("{}: {refused}", quote(file))),
        Err(sentence) => Err(format!("cannot read {}: {sentence}", quote(file))),
    };
    match module {
        Ok(module) => Some(ProgramConfig { name: name.to_owned(), module: Arc::new(module) }),
        Err(sentence) => {
            wasm.refuse(sentence, None);
            None
        }
    }
}

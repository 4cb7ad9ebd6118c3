//! Programs of the user as files and texts: modules next to a cell, modules in a recording, and files that
//! `lineshaft program` writes.

mod template;
mod trial;

pub(crate) use template::{Language, write as write_template};
pub(crate) use trial::{Trial, TrialError};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use lineshaft_program::MOST_BYTES;
use std::io::Read;
use std::path::Path;

/// Prefix of a module in a text.
const BEFORE: &str = "data:application/wasm;base64,";

/// Reads a file, at most one byte more than a module may have.
///
/// # Errors
/// Returns the reason why it cannot be read.
pub(crate) fn load(path: &Path) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let read = std::fs::File::open(path).and_then(|file| file.take(MOST_BYTES as u64 + 1).read_to_end(&mut bytes));
    match read {
        Err(error) => Err(error.to_string()),
        Ok(_) if path.is_dir() => Err("it is a folder".to_owned()),
        Ok(_) if bytes.len() > MOST_BYTES => Err(format!("it is longer than {MOST_BYTES} bytes")),
        Ok(_) => Ok(bytes),
    }
}

/// Encodes a module as text.
pub(crate) fn encode(module: &[u8]) -> String {
    format!("{BEFORE}{}", STANDARD.encode(module))
}

/// Decodes the module of a text; `None` if it has none.
pub(crate) fn decode(text: &str) -> Option<Vec<u8>> {
    STANDARD.decode(text.strip_prefix(BEFORE)?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_module_is_a_text_and_back() {
        let bytes: Vec<u8> = (0..=255).collect();
        assert_eq!(decode(&encode(&bytes)), Some(bytes));
        assert!(encode(b"\0asm").starts_with("data:application/wasm;base64,AGFzbQ"));
        assert_eq!([decode("AGFzbQ"), decode("data:application/wasm;base64,?")], [None, None]);
    }

    #[test]
    fn a_file_that_is_too_long_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("long.wasm");
        std::fs::write(&path, vec![0; MOST_BYTES + 1]).unwrap();
        assert_eq!(load(&path), Err("it is longer than 1048576 bytes".to_owned()));
        std::fs::write(&path, b"abc").unwrap();
        assert_eq!(load(&path), Ok(b"abc".to_vec()));
        assert!(load(&folder.path().join("none")).is_err() && load(folder.path()).is_err());
    }
}

//! Files that `lineshaft program new` writes: a Rust crate, or a C program with its header.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Languages of a new program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Language {
    /// A crate for wasm32-unknown-unknown, without the standard library.
    Rust,
    /// A file and a header for clang.
    C,
}

/// Returns the files of a new program, by their paths in its folder.
fn files(language: Language) -> &'static [(&'static str, &'static str)] {
    match language {
        Language::Rust => &[
            ("Cargo.toml", include_str!("template/rust/Cargo.toml.txt")),
            (".cargo/config.toml", include_str!("template/rust/config.toml")),
            ("src/lib.rs", include_str!("template/rust/src/lib.rs")),
            ("src/lineshaft.rs", include_str!("template/rust/src/lineshaft.rs")),
            ("inputs.csv", include_str!("template/inputs.csv")),
        ],
        Language::C => &[
            ("program.c", include_str!("template/c/program.c")),
            ("lineshaft.h", include_str!("template/c/lineshaft.h")),
            ("Makefile", include_str!("template/c/Makefile")),
            ("inputs.csv", include_str!("template/inputs.csv")),
        ],
    }
}

/// Writes a new program into a folder that does not exist yet; returns the files.
///
/// # Errors
/// Returns an error if the folder exists, if its name is invalid for a crate, or if the operating system fails.
pub(crate) fn write(folder: &Path, language: Language) -> io::Result<Vec<PathBuf>> {
    let refuse = |kind, sentence: String| Err(io::Error::new(kind, sentence));
    let name = folder.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let is_name = |name: &str| {
        let mut signs = name.chars();
        signs.next().is_some_and(|first| first.is_ascii_alphabetic())
            && signs.all(|sign| sign.is_ascii_alphanumeric() || matches!(sign, '_' | '-'))
    };
    if !is_name(name) {
        let sentence = format!("`{name}` is no name of a program: a letter, then letters, digits, - and _ are allowed");
        return refuse(io::ErrorKind::InvalidInput, sentence);
    }
    if folder.exists() {
        return refuse(io::ErrorKind::AlreadyExists, "it exists already; nothing was written".to_owned());
    }
    let mut written = Vec::new();
    for (path, text) in files(language) {
        let path = folder.join(path);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent)?;
        }
        fs::write(&path, text.replace("NAME", name))?;
        written.push(path);
    }
    Ok(written)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_program_has_its_name_and_all_files() {
        let folder = tempfile::tempdir().unwrap();
        let rust = folder.path().join("speed-ratio");
        assert_eq!(write(&rust, Language::Rust).unwrap().len(), 5);
        let manifest = fs::read_to_string(rust.join("Cargo.toml")).unwrap();
        assert!(manifest.contains("name = \"speed-ratio\"") && !manifest.contains("NAME"));
        assert!(fs::read_to_string(rust.join("src/lib.rs")).unwrap().contains("mod lineshaft;"));
        let c = folder.path().join("c");
        assert_eq!(write(&c, Language::C).unwrap().len(), 4);
        assert!(fs::read_to_string(c.join("Makefile")).unwrap().contains("c.wasm"));
    }

    #[test]
    fn what_exists_and_what_is_no_name_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let says = |path: &Path| write(path, Language::Rust).unwrap_err().to_string();
        assert_eq!(
            says(folder.path()),
            format!(
                "`{}` is no name of a program: a letter, then letters, digits, - and _ are allowed",
                folder.path().file_name().unwrap().to_str().unwrap()
            )
        );
        let there = folder.path().join("there");
        fs::create_dir(&there).unwrap();
        assert_eq!(says(&there), "it exists already; nothing was written");
        assert!(says(&folder.path().join("2nd")).starts_with("`2nd` is no name"));
    }
}

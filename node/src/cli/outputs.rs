//! Output files of commands, which replace existing files.
//!
//! Refuses  an existing file with the extension of another kind, so that no cell, table or bag is lost by mistake

use clap::builder::{PathBufValueParser, TypedValueParser};
use std::fs;
use std::path::PathBuf;

/// Extensions of files that users write or that runs record; no command replaces them by another kind of file.
const KEPT: [&str; 11] = ["yaml", "yml", "mcap", "db3", "csv", "eds", "dcf", "urdf", "xacro", "wasm", "md"];

/// Parses the path of a JUnit report.
pub(super) fn report() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| check(path, "report", ""))
}

/// Parses the path of a trace of signals.
pub(super) fn trace() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| check(path, "trace", "csv"))
}

/// Parses the path of the bytes of an object.
pub(super) fn bytes() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| check(path, "file of bytes", ""))
}

/// Returns the path, unless it is a file with content and with one of the protected extensions other than `own`.
fn check(path: PathBuf, what: &str, own: &str) -> Result<PathBuf, String> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase();
    let is_kept = ending != own && KEPT.contains(&ending.as_str());
    let has_content = || fs::metadata(&path).is_ok_and(|about| about.is_file() && about.len() > 0);
    if is_kept && has_content() {
        return Err(format!("it exists, and a {what} never replaces a .{ending} file; name another file"));
    }
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_of_another_kind_is_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for name in ["cell.yaml", "run.MCAP", "trace.csv", "report.xml", "plain", "empty.yaml"] {
            fs::write(path(name), if name.starts_with("empty") { "" } else { "text" }).unwrap();
        }
        let refused = |name: &str, own| check(path(name), "report", own).err();
        let sentence =
            |ending: &str| Some(format!("it exists, and a report never replaces a .{ending} file; name another file"));
        assert_eq!(refused("cell.yaml", "csv"), sentence("yaml"));
        assert_eq!(refused("run.MCAP", ""), sentence("mcap"));
        assert_eq!(refused("trace.csv", ""), sentence("csv"));
        for (name, own) in
            [("trace.csv", "csv"), ("report.xml", ""), ("plain", ""), ("empty.yaml", ""), ("new.yaml", "")]
        {
            assert_eq!(refused(name, own), None, "{name}");
        }
    }
}

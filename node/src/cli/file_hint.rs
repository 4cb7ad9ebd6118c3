//! Returns a hint for a command line with a file instead of a command, such as `lineshaft demo.yaml`.

use crate::recording::clean::clean;
use crate::scenario::cell_next_to;
use clap::error::{ContextKind, ContextValue};
use std::path::Path;

/// Returns the command for that file; `None` for any other error. `first` is the first argument of the program.
pub(super) fn file_hint(error: &clap::Error, first: Option<&str>) -> Option<String> {
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else { return None };
    // A later argument is a subcommand of `table` or `can`.
    if first != Some(word.as_str()) {
        return None;
    }
    let path = Path::new(word);
    let ends = |endings: &[&str]| {
        path.extension().is_some_and(|extension| endings.iter().any(|ending| extension.eq_ignore_ascii_case(ending)))
    };
    let file = clean(word);
    if ends(&["mcap"]) {
        return Some(format!("`lineshaft bag info {file}` describes a recording"));
    }
    if !ends(&["yaml", "yml"]) && !path.is_file() {
        return None;
    }
    if cell_next_to(path).is_some() {
        return Some(format!("`lineshaft sim {file}` plays a scenario"));
    }
    if is_scenario(path) {
        return Some(format!("`lineshaft sim CELL --scenario {file}` plays a scenario"));
    }
    Some(format!("`lineshaft run {file}` runs a cell"))
}

/// Returns true if a file has the name of a scenario, or the key that only scenarios have.
pub(super) fn is_scenario(path: &Path) -> bool {
    if cell_next_to(path).is_some() {
        return true;
    }
    // Reading a named pipe would block.
    let text = path.is_file().then(|| std::fs::read_to_string(path).ok()).flatten();
    text.is_some_and(|text| text.lines().any(|line| line.starts_with("scenario:")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::Line;
    use clap::Parser;

    fn hint(line: &[&str]) -> Option<String> {
        let error = Line::try_parse_from([&["lineshaft"], line].concat()).expect_err("no such command");
        file_hint(&error, line.first().copied())
    }

    #[test]
    fn file_instead_of_a_command_gives_a_hint() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).unwrap();
            path.to_str().unwrap().to_owned()
        };
        let (cell, scenario) = (write("cell", "lineshaft: 1\n"), write("s.yaml", "# first\nscenario: s\n"));
        assert_eq!(hint(&["demo.yaml"]).as_deref(), Some("`lineshaft run demo.yaml` runs a cell"));
        assert_eq!(hint(&["a/demo.YML"]).as_deref(), Some("`lineshaft run a/demo.YML` runs a cell"));
        assert_eq!(hint(&[&cell]), Some(format!("`lineshaft run {cell}` runs a cell")));
        assert_eq!(hint(&[&scenario]), Some(format!("`lineshaft sim CELL --scenario {scenario}` plays a scenario")));
        assert_eq!(hint(&["a.scenario.yaml"]).as_deref(), Some("`lineshaft sim a.scenario.yaml` plays a scenario"));
        assert_eq!(hint(&["run.mcap"]).as_deref(), Some("`lineshaft bag info run.mcap` describes a recording"));
        assert_eq!(hint(&["chekc"]), None);
        assert_eq!(hint(&["bag", "demo.yaml"]), None);
        assert_eq!(hint(&["check"]), None, "an argument is missing");
    }
}

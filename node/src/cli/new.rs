//! `lineshaft new` and `lineshaft demo`: writes a cell and a scenario to start from.

use super::{Exit, complain, say, say_all};
use crate::scenario::{did_you_mean, nearest};
use crate::starter::{KINDS, Starter, StarterKind, demo};
use clap::Args;
use std::path::{Path, PathBuf};

pub(super) const USAGE: &str = "lineshaft new [OPTIONS] [KIND] FILE\n       lineshaft new --list";

pub(super) const HELP: &str = "\
Writes the cell NAME.yaml, the scenario NAME.scenario.yaml, and the files that they name, next to each other.

Examples:
  lineshaft new machine.yaml
  lineshaft new gear machine.yaml
  lineshaft new --list

Exit codes: 0 good, 2 bad usage, or a file that exists or cannot be written.";

/// A new cell.
#[derive(Debug, Args)]
pub(super) struct NewArgs {
    /// What to start from, as `gear`; left out: demo. --list lists the kinds
    kind: Option<String>,
    /// The new cell, NAME.yaml
    file: Option<PathBuf>,
    /// List the kinds
    #[arg(long, conflicts_with_all = ["kind", "file", "force"])]
    list: bool,
    /// Replace files that exist
    #[arg(long)]
    force: bool,
}

/// The built-in demo.
#[derive(Debug, Args)]
pub(super) struct DemoArgs {
    /// Print the scenario of the demo instead of its cell
    #[arg(long)]
    scenario: bool,
}

pub(super) fn print_demo(args: &DemoArgs) -> Exit {
    say_all(demo(args.scenario));
    Exit::Good
}

pub(super) fn new(args: &NewArgs) -> Exit {
    if args.list {
        let width = KINDS.iter().map(|kind| kind.name.len()).max().unwrap_or(0);
        KINDS.iter().for_each(|kind| say(&format!("{:width$}  {}", kind.name, kind.help)));
        return Exit::Good;
    }
    match write(args) {
        Ok(text) => {
            say_all(&text);
            Exit::Good
        }
        Err(sentence) => {
            complain(&sentence);
            Exit::Usage
        }
    }
}

/// Writes the files; returns the report: the files, and the next commands.
fn write(args: &NewArgs) -> Result<String, String> {
    let (kind, file) = wanted(args)?;
    let starter = Starter::new(kind, file)?;
    starter.write(args.force)?;
    let mut text = String::new();
    starter.paths.iter().for_each(|path| text += &format!("wrote {}\n", path.display()));
    let (cell, scenario) = (quoted(file), quoted(&file.with_extension("scenario.yaml")));
    let rehearse = if kind.is_real { " --sim" } else { "" };
    text += &format!(
        "\nnext:\n  lineshaft check {cell}\n  lineshaft sim {cell} --scenario {scenario}\n  lineshaft run {cell}{rehearse}\n"
    );
    Ok(text)
}

/// Returns the kind and the file of the arguments; a single argument is the file.
fn wanted(args: &NewArgs) -> Result<(&'static StarterKind, &Path), String> {
    match (args.kind.as_deref(), args.file.as_deref()) {
        (Some(name), Some(file)) => Ok((StarterKind::find(name).ok_or_else(|| unknown(name, file))?, file)),
        (Some(name), None) => match StarterKind::find(name) {
            Some(kind) => Err(format!("the file is missing: `lineshaft new {0} {0}.yaml`", kind.name)),
            None => Ok((&KINDS[0], Path::new(name))),
        },
        (None, _) => {
            let commands = "`lineshaft new machine.yaml`, or with a kind `lineshaft new gear machine.yaml`";
            Err(format!("the file is missing: {commands}; `lineshaft new --list` lists the kinds"))
        }
    }
}

/// Returns the message for an unknown kind before a file.
fn unknown(name: &str, file: &Path) -> String {
    if let Some(kind) = file.to_str().and_then(StarterKind::find) {
        return format!("the kind is given before the file: `lineshaft new {} {}`", kind.name, quoted(Path::new(name)));
    }
    let names: Vec<_> = KINDS.iter().map(|kind| kind.name).collect();
    let meant =
        nearest(name, names.iter().copied()).map_or(String::new(), |meant| format!("; {}", did_you_mean(meant)));
    format!("kind `{name}` is unknown, allowed: {}{meant}", names.join(", "))
}

/// Quotes a path for a shell if necessary.
pub(super) fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let is_plain = |sign: char| sign.is_alphanumeric() || "_-./+,:@%=".contains(sign);
    if text.chars().all(is_plain) { text } else { format!("'{}'", text.replace('\'', r"'\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_quoted_where_a_shell_needs_it() {
        let cases =
            [("a/b-1.yaml", "a/b-1.yaml"), ("my cell.yaml", "'my cell.yaml'"), ("it's", r"'it'\''s'"), ("$x", "'$x'")];
        for (path, shown) in cases {
            assert_eq!(quoted(Path::new(path)), shown);
        }
    }

    #[test]
    fn unknown_kind_is_refused_with_a_list_of_known_ones() {
        let known = "demo, can, gantry, cam, gear, register, arm6, function, winder";
        let unknown = |name| unknown(name, Path::new("m.yaml"));
        assert_eq!(unknown("gaer"), format!("kind `gaer` is unknown, allowed: {known}; did you mean `gear`?"));
        assert_eq!(unknown("press"), format!("kind `press` is unknown, allowed: {known}"));
    }

    #[test]
    fn missing_file_and_kind_after_the_file_are_reported_with_a_command() {
        let refused = |kind: Option<&str>, file: Option<&str>| {
            let (kind, file) = (kind.map(str::to_owned), file.map(PathBuf::from));
            wanted(&NewArgs { kind, file, list: false, force: false }).err()
        };
        let missing = "the file is missing: `lineshaft new machine.yaml`, or with a kind `lineshaft new gear machine.yaml`; \
                       `lineshaft new --list` lists the kinds";
        assert_eq!(refused(None, None).as_deref(), Some(missing));
        let order = "the kind is given before the file: `lineshaft new gear foo.yaml`";
        assert_eq!(refused(Some("foo.yaml"), Some("gear")).as_deref(), Some(order));
        assert_eq!(refused(Some("gear"), Some("foo.yaml")), None);
    }
}

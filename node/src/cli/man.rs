//! `lineshaft man`.

use super::{Exit, Line, complain};
use clap::{Args, CommandFactory};
use std::path::{Path, PathBuf};
use std::{fs, io};

#[derive(Debug, Args)]
pub(super) struct ManArgs {
    /// Folder of the pages; it is created if it is missing, and pages that exist are replaced
    folder: PathBuf,
}

pub(super) fn man(args: &ManArgs) -> Exit {
    match write(&args.folder) {
        Ok(()) => Exit::Good,
        Err(error) => {
            complain(&format!("{}: the man pages cannot be written: {error}", args.folder.display()));
            Exit::Failed
        }
    }
}

/// Writes a page for each command: `lineshaft.1`, `lineshaft-sim.1`, `lineshaft-can-scan.1`.
///
/// # Errors
/// Returns an error if the folder cannot be written.
fn write(folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    clap_mangen::generate_to(Line::command(), folder)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Returns the names of the pages of a command and of all its subcommands.
    fn pages(command: &clap::Command, name: &str) -> BTreeSet<String> {
        let below =
            command.get_subcommands().flat_map(|command| pages(command, &format!("{name}-{}", command.get_name())));
        below.chain([format!("{name}.1")]).collect()
    }

    #[test]
    fn each_command_has_a_man_page() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().join("new").join("man1");
        write(&folder).unwrap();
        let written: BTreeSet<_> =
            fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        assert_eq!(written, pages(&Line::command(), "lineshaft"));
        assert!(written.contains("lineshaft-can-sdo-read.1"), "{written:?}");
        let run = fs::read_to_string(folder.join("lineshaft-run.1")).unwrap();
        // The hyphens of an option are `\-` in roff.
        assert!(run.contains(".TH lineshaft-run 1 ") && run.contains("\\-\\-cpu"), "{run}");
    }

    #[test]
    fn a_folder_that_cannot_be_written_ends_with_1() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "").unwrap();
        assert_eq!(man(&ManArgs { folder: file.join("man") }), Exit::Failed);
    }
}

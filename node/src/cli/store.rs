//! `--store`: file in which a machine stores its values.

use super::complain;
use crate::cell::Cell;
use crate::store::{Store, StoreError};
use clap::Args;
use lineshaft_ros::layer::NodeName;
use std::fs;
use std::path::{Path, PathBuf};

/// Value instead of a file: nothing is read or stored.
const NONE: &str = "none";

/// Where saved parameters are kept.
#[derive(Clone, Debug, Default, Args)]
pub(super) struct StoreArgs {
    /// Start with the parameters saved in this file, and keep there what is saved; `none`: keep nothing. Left out: `sim`,
    /// and `tune` of a simulated axis, keep nothing; `run`, and `tune` of a real axis, use
    /// `~/.ros/lineshaft/<node>/parameters.<cell>.yaml` (ROS_HOME counts)
    #[arg(long, value_name = "FILE|none")]
    store: Option<PathBuf>,
}

impl StoreArgs {
    /// Returns the given file; `None` if there is none, or for `none`.
    fn file(&self) -> Option<&Path> {
        self.store.as_deref().filter(|path| *path != Path::new(NONE))
    }
}

/// Opens the given store, and applies its values to the cell.
///
/// # Errors
/// Returns an error after it was printed.
pub(super) fn open(args: &StoreArgs, cell: &mut Cell) -> Result<Option<Store>, ()> {
    open_silently(args, cell).map_err(complain_of)
}

/// Does the same without printing.
///
/// # Errors
/// Returns the error.
pub(super) fn open_silently(args: &StoreArgs, cell: &mut Cell) -> Result<Option<Store>, StoreError> {
    load(args.file().map(Store::open).transpose(), cell)
}

/// Does the same for a node; without `--store`, it uses the store in the folder of the node. If another program uses
/// that one, or there is no folder, the machine starts anyway, with a warning, so that two nodes of one name do not
/// block each other.
///
/// # Errors
/// Returns an error after it was printed.
pub(super) fn open_for_node(
    args: &StoreArgs,
    cell: &mut Cell,
    name: &NodeName,
    file: Option<&Path>,
) -> Result<Option<Store>, ()> {
    if args.store.is_some() {
        return open(args, cell);
    }
    let Some(path) = node_folder(name).map(|folder| folder.join(usual_name(file))) else {
        tracing::warn!("nothing that is saved will be kept: HOME is not set; --store names a file");
        return Ok(None);
    };
    if let Some(Err(error)) = path.parent().map(fs::create_dir_all) {
        tracing::warn!("nothing that is saved will be kept: {}: {error}; --store names another file", path.display());
        return Ok(None);
    }
    load(Store::open_read_only_if_used(&path).map(Some), cell).map_err(complain_of)
}

fn load(opened: Result<Option<Store>, StoreError>, cell: &mut Cell) -> Result<Option<Store>, StoreError> {
    let store = opened?;
    store.as_ref().map_or(Ok(()), |store| store.load(&mut cell.machine))?;
    Ok(store)
}

fn complain_of(error: StoreError) {
    match error {
        // Each problem is a line that begins with its location, like those of a cell.
        StoreError::Unfit { .. } => eprintln!("{error}"),
        _ => complain(&error),
    }
}

/// Returns the file name for a cell in the folder of its node; it differs between cells, so that cells that one node
/// runs in turn do not share values.
fn usual_name(cell: Option<&Path>) -> String {
    let stem = cell.and_then(Path::file_stem);
    stem.map_or_else(|| "parameters.yaml".to_owned(), |stem| format!("parameters.{}.yaml", stem.to_string_lossy()))
}

/// Returns the folder for data of all nodes of this program, in the folder of ROS tools for data of the user:
/// `$ROS_HOME`, otherwise `~/.ros`.
fn folder() -> Option<PathBuf> {
    let given = |variable| std::env::var_os(variable).filter(|value| !value.is_empty()).map(PathBuf::from);
    let home = given("ROS_HOME").or_else(|| Some(given("HOME")?.join(".ros")))?;
    Some(home.join("lineshaft"))
}

/// Returns the folder for data of this node.
pub(super) fn node_folder(name: &NodeName) -> Option<PathBuf> {
    let node = name.to_string();
    Some(folder()?.join(node.trim_start_matches('/').replace('/', "_")))
}

/// Returns the folder with the list of live DDS participants. No node can have its name.
pub(super) fn participants_folder() -> Option<PathBuf> {
    Some(folder()?.join(".participants"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::Line;
    use clap::CommandFactory;

    #[test]
    fn help_names_the_default_of_each_command_with_a_store() {
        let line = Line::command();
        for command in ["run", "sim", "tune"] {
            let mut arguments = line.find_subcommand(command).unwrap().get_arguments();
            let store = arguments.find(|argument| argument.get_id().as_str() == "store").unwrap();
            let help = store.get_help().unwrap().to_string();
            assert!(["`run`", "`sim`", "`tune`"].iter().all(|name| help.contains(name)), "{command}: {help}");
        }
    }

    #[test]
    fn each_cell_of_a_node_has_a_file_of_its_own() {
        assert_eq!(usual_name(None), "parameters.yaml");
        assert_eq!(usual_name(Some(Path::new("/a/press.yaml"))), "parameters.press.yaml");
        assert_eq!(usual_name(Some(Path::new("cells/demo.v2.yaml"))), "parameters.demo.v2.yaml");
    }
}

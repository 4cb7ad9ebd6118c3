//! Finds the files of a run.

use super::error::RunError;
use super::outline::Outline;
use crate::document::{Document, Value};
use std::fs;
use std::path::{Component, Path, PathBuf};

/// File name of the description of a bag.
const DESCRIPTION: &str = "metadata.yaml";

/// Returns the files of a run in their order.
pub(super) fn outlines(path: &Path) -> Result<Vec<Outline>, RunError> {
    let open = |error| RunError::Open { path: path.to_owned(), error };
    let about = fs::metadata(path).map_err(open)?;
    if about.is_dir() {
        let description = path.join(DESCRIPTION);
        return if description.exists() { listed(&description) } else { found(path) };
    }
    if !about.is_file() {
        return Err(RunError::Special { path: path.to_owned() });
    }
    let is_description = path.extension().is_some_and(|extension| extension == "yaml" || extension == "yml");
    if is_description { listed(path) } else { Ok(vec![Outline::read(path)?]) }
}

/// Returns the files that a description lists.
fn listed(description: &Path) -> Result<Vec<Outline>, RunError> {
    let document = Document::read(description);
    let described = document.root("the description").and_then(|root| describe(&root));
    let Some(described) = described.filter(|_| document.problems().is_empty()) else {
        return Err(RunError::Description(document.into_problems().to_string().trim_end().to_owned()));
    };
    let compressed = |what, hint| RunError::Compressed { path: description.to_owned(), what, hint };
    match described.compression.as_str() {
        "file" => return Err(compressed("the files of this bag are compressed as a whole", UNPACK)),
        "message" => return Err(compressed("each message of this bag is compressed", UNPACK)),
        _ => {}
    }
    let folder = description.parent().unwrap_or(Path::new(""));
    described.files.iter().map(|file| Outline::read(&folder.join(file))).collect()
}

/// How to get a bag without additional compression.
const UNPACK: &str = "`ros2 bag convert` unpacks it";

struct Described {
    files: Vec<PathBuf>,
    /// Compression mode: `file`, `message`, or any other text for none.
    compression: String,
}

/// Reads the relevant fields of a description; each problem is recorded.
fn describe(root: &Value<'_>) -> Option<Described> {
    let mut map = root.map("the description of a bag")?;
    let bag = map.required("rosbag2_bagfile_information")?;
    map.rest();
    let mut bag = bag.map("rosbag2_bagfile_information")?;
    let compression = bag.optional("compression_mode").and_then(|mode| mode.peek().map(str::to_lowercase));
    let list = bag.required("relative_file_paths")?;
    bag.rest();
    let mut files: Vec<PathBuf> = Vec::new();
    for item in list.list()? {
        let written = PathBuf::from(item.text()?);
        let is_within = written.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
        // A file has many names: `./a` is `a`.
        let file: PathBuf = written.components().filter(|part| *part != Component::CurDir).collect();
        if !is_within || file.as_os_str().is_empty() {
            item.refuse(
                format!("{} is `{}`; a file within the folder is allowed", item.label(), written.display()),
                None,
            );
        }
        if files.contains(&file) {
            item.refuse(format!("{} is `{}`, which is listed before", item.label(), written.display()), None);
        }
        files.push(file);
    }
    if files.is_empty() {
        list.refuse("relative_file_paths is empty; at least one file is expected", None);
    }
    Some(Described { files, compression: compression.unwrap_or_default() })
}

/// Returns the files of a folder without a description, sorted by the times of their first messages.
fn found(folder: &Path) -> Result<Vec<Outline>, RunError> {
    let open = |error| RunError::Open { path: folder.to_owned(), error };
    let mut files = Vec::new();
    let (mut database, mut compressed) = (None, None);
    for entry in fs::read_dir(folder).map_err(open)? {
        let path = entry.map_err(open)?.path();
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("mcap") => files.push(path),
            Some("db3") => database = Some(path),
            Some("zstd") => compressed = Some(path),
            _ => {}
        }
    }
    match (files.is_empty(), database, compressed) {
        (true, Some(path), _) => return Err(RunError::Database { path }),
        (true, None, Some(path)) => {
            return Err(RunError::Compressed { path, what: "this file is compressed as a whole", hint: UNPACK });
        }
        (true, None, None) => return Err(RunError::Empty { path: folder.to_owned() }),
        (false, ..) => {}
    }
    // Files with the same time are sorted by name; a file without messages is the last one of a killed recorder.
    files.sort();
    let mut outlines = files.iter().map(|file| Outline::read(file)).collect::<Result<Vec<_>, _>>()?;
    outlines.sort_by_key(|outline| (outline.first_time.is_none(), outline.first_time));
    Ok(outlines)
}

/// Refuses a folder without a description whose files are of several runs.
pub(super) fn check_related(path: &Path, files: &[Outline]) -> Result<(), RunError> {
    let description = path.join(DESCRIPTION);
    match unrelated(files) {
        // With a description, the files were grouped on purpose.
        Some((first, other)) if path.is_dir() && !description.exists() => {
            Err(RunError::Unrelated { path: path.to_owned(), first: short(first), other: short(other) })
        }
        _ => Ok(()),
    }
}

/// Returns two files that were recorded with different cells; files without messages are ignored.
pub(super) fn unrelated(files: &[Outline]) -> Option<(&Outline, &Outline)> {
    let mut told = files.iter().filter(|file| file.first_time.is_some());
    let first = told.next()?;
    told.find(|file| cell_of(file) != cell_of(first)).map(|other| (first, other))
}

/// Returns the checksum of the cell; files of other recorders have none.
fn cell_of(file: &Outline) -> Option<&str> {
    let (_, lineshaft) = file.metadata.iter().find(|(name, _)| name == "lineshaft")?;
    lineshaft.get("cell_sha256").map(String::as_str)
}

/// Returns the name of a file within its folder.
fn short(file: &Outline) -> String {
    file.path.file_name().unwrap_or(file.path.as_os_str()).to_string_lossy().into_owned()
}

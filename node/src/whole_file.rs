//! Writes files that replace older ones completely, or not at all.
//!
//! Law      written next to the old one and synchronized, then renamed to it: after a power failure the name refers to
//!          no file without its content
//! Writes   one file; none if it is dropped before

use std::ffi::OsString;
use std::fs::{self, File, Permissions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A complete new file without its final name; it is deleted when dropped.
#[derive(Debug)]
pub(crate) struct WholeFile {
    temporary: PathBuf,
    path: PathBuf,
}

impl WholeFile {
    /// Writes `bytes` for the file at `path`, with these permissions, or those of the operating system.
    ///
    /// # Errors
    /// Returns the error of the operating system; no file remains.
    pub(crate) fn write(path: &Path, bytes: &[u8], permissions: Option<Permissions>) -> io::Result<Self> {
        let mut name = OsString::from(".");
        name.push(path.file_name().unwrap_or_default());
        name.push(format!(".{}.part", std::process::id()));
        let new = Self { temporary: path.with_file_name(name), path: path.to_owned() };
        // A file that a killed program has left, with the same number.
        let _ = fs::remove_file(&new.temporary);
        let mut file = File::create_new(&new.temporary)?;
        if let Some(permissions) = permissions {
            file.set_permissions(permissions)?;
        }
        file.write_all(bytes)?;
        file.sync_all()?;
        Ok(new)
    }

    /// Replaces the existing file.
    ///
    /// # Errors
    /// Returns the error of the operating system; the old file is unchanged, and no other file remains.
    pub(crate) fn replace(self) -> io::Result<()> {
        fs::rename(&self.temporary, &self.path)
    }
}

impl Drop for WholeFile {
    fn drop(&mut self) {
        // It has its final name now, or may never have existed.
        let _ = fs::remove_file(&self.temporary);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;

    #[test]
    fn a_file_is_replaced_whole_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.yaml");
        let names = || fs::read_dir(folder.path()).unwrap().count();
        fs::write(&path, "old").unwrap();
        drop(WholeFile::write(&path, b"dropped", None).unwrap());
        assert_eq!((fs::read_to_string(&path).unwrap().as_str(), names()), ("old", 1));
        let new = WholeFile::write(&path, b"new", Some(Permissions::from_mode(0o640))).unwrap();
        assert_eq!((fs::read_to_string(&path).unwrap().as_str(), names()), ("old", 2));
        new.replace().unwrap();
        assert_eq!((fs::read_to_string(&path).unwrap().as_str(), names()), ("new", 1));
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
        // A folder with that name exists.
        let taken = folder.path().join("taken");
        fs::create_dir_all(taken.join("full")).unwrap();
        assert!(WholeFile::write(&taken, b"new", None).unwrap().replace().is_err());
        assert!(WholeFile::write(&folder.path().join("none/b.yaml"), b"new", None).is_err());
        assert_eq!(names(), 2);
    }
}

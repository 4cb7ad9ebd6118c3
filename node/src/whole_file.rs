//! Files that take the place of older ones whole, or not at all.
//!
//! Law      written beside the old one and synchronized, then renamed onto it: after a loss of power the name shows no file without its content
//! Writes   one file; none where it is dropped before

use std::ffi::OsString;
use std::fs::{self, File, Permissions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A new file that is complete, and has not its name yet; dropped it is gone.
#[derive(Debug)]
pub(crate) struct WholeFile {
    beside: PathBuf,
    path: PathBuf,
}

impl WholeFile {
    /// Writes `bytes` for the file at `path`, with these permissions, or those that the system gives.
    ///
    /// # Errors
    /// What the system says; nothing is left.
    pub(crate) fn write(path: &Path, bytes: &[u8], permissions: Option<Permissions>) -> io::Result<Self> {
        let mut name = OsString::from(".");
        name.push(path.file_name().unwrap_or_default());
        name.push(format!(".{}.part", std::process::id()));
        let new = Self { beside: path.with_file_name(name), path: path.to_owned() };
        // What a program that was killed has left, with the same number.
        let _ = fs::remove_file(&new.beside);
        let mut file = File::create_new(&new.beside)?;
        if let Some(permissions) = permissions {
            file.set_permissions(permissions)?;
        }
        file.write_all(bytes)?;
        file.sync_all()?;
        Ok(new)
    }

    /// Takes the place of what stands there.
    ///
    /// # Errors
    /// What the system says; the old one stays, and nothing else is left.
    pub(crate) fn take_place(self) -> io::Result<()> {
        fs::rename(&self.beside, &self.path)
    }
}

impl Drop for WholeFile {
    fn drop(&mut self) {
        // It has its name now, or may never have existed.
        let _ = fs::remove_file(&self.beside);
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
        new.take_place().unwrap();
        assert_eq!((fs::read_to_string(&path).unwrap().as_str(), names()), ("new", 1));
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
        // A folder stands in the way.
        let taken = folder.path().join("taken");
        fs::create_dir_all(taken.join("full")).unwrap();
        assert!(WholeFile::write(&taken, b"new", None).unwrap().take_place().is_err());
        assert!(WholeFile::write(&folder.path().join("none/b.yaml"), b"new", None).is_err());
        assert_eq!(names(), 2);
    }
}

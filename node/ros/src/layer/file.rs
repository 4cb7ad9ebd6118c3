//! Opens files that the user names.
//!
//! Refuses  paths that are no regular files: opening a named pipe without a writer blocks forever, and opening a device may have side
//!          effects

use std::fs::{self, File, FileType};
use std::io;
use std::os::unix::fs::FileTypeExt;
use std::path::Path;

/// Opens a file for reading; links are followed.
///
/// # Errors
/// The path is not a regular file, with a message; otherwise the error of the system.
pub fn open_file(path: &Path) -> io::Result<File> {
    let kind = fs::metadata(path)?.file_type();
    match other_kind(kind) {
        Some(other) => {
            let sentence = format!("it is {other}; a regular file is expected");
            Err(io::Error::new(io::ErrorKind::InvalidInput, sentence))
        }
        None => File::open(path),
    }
}

/// Returns the kind of a path that is not a regular file.
fn other_kind(kind: FileType) -> Option<&'static str> {
    match kind {
        _ if kind.is_file() => None,
        _ if kind.is_dir() => Some("a folder"),
        _ if kind.is_fifo() => Some("a named pipe"),
        _ if kind.is_socket() => Some("a socket"),
        _ => Some("a device"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;
    use std::os::unix::fs::symlink;
    use std::os::unix::net::UnixListener;
    use std::path::PathBuf;
    use std::process::Command;

    /// Temporary folder of this process, which is removed when dropped.
    struct Folder(PathBuf);

    impl Folder {
        fn new() -> Self {
            let path = std::env::temp_dir().join(format!("lineshaft-files-{}", std::process::id()));
            let _ = fs::remove_dir_all(&path);
            fs::create_dir(&path).expect("a new folder");
            Self(path)
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn only_a_regular_file_is_opened() {
        let folder = Folder::new();
        let at = |name: &str| folder.0.join(name);
        let said = |path: &Path| open_file(path).map(|_| ()).map_err(|error| error.to_string());
        fs::write(at("file"), "text").unwrap();
        symlink(at("file"), at("link")).unwrap();
        for name in ["file", "link"] {
            let mut text = String::new();
            open_file(&at(name)).unwrap().read_to_string(&mut text).unwrap();
            assert_eq!(text, "text", "{name}");
        }
        assert!(Command::new("mkfifo").arg(at("pipe")).status().unwrap().success());
        symlink(at("pipe"), at("to_pipe")).unwrap();
        let _socket = UnixListener::bind(at("socket")).unwrap();
        let wrong = |what: &str| Err(format!("it is {what}; a regular file is expected"));
        assert_eq!(said(&at("pipe")), wrong("a named pipe"));
        assert_eq!(said(&at("to_pipe")), wrong("a named pipe"));
        assert_eq!(said(&at("socket")), wrong("a socket"));
        assert_eq!(said(&folder.0), wrong("a folder"));
        assert_eq!(said(Path::new("/dev/null")), wrong("a device"));
        assert_eq!(open_file(&at("none")).unwrap_err().kind(), io::ErrorKind::NotFound);
    }
}

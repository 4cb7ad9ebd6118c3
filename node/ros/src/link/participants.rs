//! Records the participants of this program in files, one for each, which is locked while the participant is running. A file without
//! a lock belongs to a participant that ended without being disposed.
//!
//! Clients keep the samples that they sent to a dead participant until its lease expires (50 s), and rmw_cyclonedds gives them to the
//! readers of the next participant. So the next participant disposes the dead one.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Write};
use std::net::Ipv4Addr;
use std::path::{Path, PathBuf};

use super::protocol::{Departed, ParticipantId};

/// Maximum number of files that are read. If the folder has more, another program has filled it.
const MOST: usize = 64;
/// Maximum length of a file in bytes.
const LONGEST: u64 = 4096;

/// File of a running participant.
pub(super) struct Entry {
    path: PathBuf,
    /// Holds the lock.
    _file: File,
}

impl Entry {
    /// Writes and locks the file of a participant that is running now.
    pub(super) fn write(folder: &Path, who: &Departed) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        let path = folder.join(who.participant.to_string());
        let mut file = OpenOptions::new().write(true).create(true).truncate(true).open(&path)?;
        file.lock()?;
        file.write_all(text(who).as_bytes())?;
        Ok(Self { path, _file: file })
    }

    /// Removes the file, after the participant was disposed.
    pub(super) fn remove(self) {
        // If this fails, the next node disposes the participant once more, which does no harm.
        let _ = fs::remove_file(&self.path);
    }
}

/// Returns the participants whose files are not locked, with these files.
pub(super) fn dead(folder: &Path) -> Vec<(Departed, PathBuf)> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<_> = entries.filter_map(|entry| Some(entry.ok()?.path())).take(MOST).collect();
    paths.sort();
    paths.into_iter().filter_map(|path| Some((read(&path)?, path))).collect()
}

fn read(path: &Path) -> Option<Departed> {
    if !fs::symlink_metadata(path).ok()?.is_file() {
        return None;
    }
    let file = File::open(path).ok()?;
    // Fails for a participant of another program that is running.
    file.try_lock().ok()?;
    let mut text = String::new();
    file.take(LONGEST).read_to_string(&mut text).ok()?;
    parse(&text)
}

fn text(who: &Departed) -> String {
    let networks = who
        .networks
        .as_ref()
        .map_or("all".to_owned(), |addresses| addresses.iter().map(ToString::to_string).collect::<Vec<_>>().join(" "));
    format!("{} {} {networks}\n", who.participant, who.domain)
}

fn parse(text: &str) -> Option<Departed> {
    let mut words = text.strip_suffix('\n')?.split(' ');
    let (participant, domain) = (ParticipantId::parse(words.next()?)?, words.next()?.parse().ok()?);
    let rest: Vec<&str> = words.collect();
    let networks: Option<Vec<Ipv4Addr>> = match rest.as_slice() {
        ["all"] => None,
        addresses => Some(addresses.iter().map(|address| address.parse().ok()).collect::<Option<_>>()?),
    };
    Some(Departed { participant, domain, networks })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn departed(id: u8, networks: Option<Vec<Ipv4Addr>>) -> Departed {
        Departed { participant: ParticipantId([id; 12]), domain: 7, networks }
    }

    #[test]
    fn only_unlocked_participants_are_dead() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().join("participants");
        assert!(dead(&folder).is_empty(), "without a folder");
        let networks = [None, Some(vec![Ipv4Addr::LOCALHOST, Ipv4Addr::new(10, 0, 0, 7)]), Some(vec![])];
        let all: Vec<_> = (1..).zip(networks).map(|(n, networks)| departed(n, networks)).collect();
        let mut entries: Vec<_> = all.iter().map(|who| Entry::write(&folder, who).unwrap()).collect();
        assert!(dead(&folder).is_empty(), "all live");
        drop(entries.remove(1));
        drop(entries.remove(0));
        let found: Vec<_> = dead(&folder).into_iter().map(|(who, _)| who).collect();
        assert_eq!(found, all[..2]);
        entries.remove(0).remove();
        assert_eq!(dead(&folder).len(), 2);
    }

    #[test]
    fn other_files_in_folder_are_ignored() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        write("a", "");
        write("b", "0102 7 all\n");
        write("c", &format!("{} 70000 all\n", ParticipantId([1; 12])));
        write("d", &format!("{} 7 all", ParticipantId([1; 12])));
        write("e", &format!("{} 7 10.0.0.x\n", ParticipantId([1; 12])));
        fs::create_dir(folder.path().join("f")).unwrap();
        assert_eq!(dead(folder.path()), []);
    }
}

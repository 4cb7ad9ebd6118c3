//! Tests bags on a disk that becomes full at any byte.

use super::full_disk::{Small, Space};
use super::*;
use std::process::Command;

const SECOND: usize = 1000;

/// Writes until the first error, then finishes. Returns the errors, in order.
fn write_on(space: &Space, options: &BagOptions, cycles: &[Encoded]) -> Vec<BagError> {
    let disk = space.clone();
    let open: Open = Box::new(move |_, path| {
        // A file on the real disk shows which files are deleted again.
        fs::write(path, "")?;
        Ok(Box::new(Small::new(&disk)))
    });
    let mut errors = Vec::new();
    match Bag::create_on(options, subject(), open) {
        Err(error) => errors.push(error),
        Ok(mut bag) => {
            errors.extend(cycles.iter().filter_map(|encoded| bag.write(encoded).err()));
            errors.extend(bag.finish().err());
        }
    }
    errors
}

/// The first error is reported; data flushed before it is complete; metadata.yaml is complete too and lists that data.
#[test]
fn a_disk_that_is_full_at_any_byte_leaves_whole_files() {
    let folder = tempfile::tempdir().unwrap();
    let cycles = &run().encoded[..2 * SECOND + 300];
    let path = folder.path().join("whole");
    let room = write(&BagOptions { max_duration_ns: Some(1), ..at(path) }, cycles).size as usize;
    // Each of the last bytes, and some before.
    let sizes = (0..room).step_by(room / 199).chain([1, 8, 9, 60, 61]).chain(room - 20..room);
    let sizes: std::collections::BTreeSet<usize> = sizes.collect();
    let mut readable = 0;
    for size in sizes {
        let path = folder.path().join(size.to_string());
        let options = BagOptions { max_duration_ns: Some(1), ..at(path.clone()) };
        let space = Space::of(size);
        let errors = write_on(&space, &options, cycles);
        let Some((BagError::Write { path: file, error }, rest)) = errors.split_first() else {
            panic!("{size}: {errors:?}");
        };
        assert_eq!(error.kind(), io::ErrorKind::StorageFull, "{size}");
        assert!(file.starts_with(&path), "{size}");
        assert!(rest.iter().all(|error| matches!(error, BagError::Ended(_))), "{size}: {rest:?}");
        assert_eq!(space.writes_after(), 0, "{size}: written after the disk was full");

        let files = space.files();
        let mut read = Vec::new();
        for bytes in files.iter().filter(|bytes| bytes.len() > 60) {
            read.extend(whole_messages(bytes));
        }
        assert_eq!(read, messages(cycles)[..read.len()], "{size}");
        if read.is_empty() {
            assert!(!path.exists(), "{size}: nothing of it may stay");
            continue;
        }
        readable += 1;
        let text = fs::read_to_string(path.join(FILE_NAME)).unwrap();
        assert!(text.ends_with("  ros_distro: jazzy\n"));
        assert!(
            text.contains(&format!("  message_count: {}\n  topics", read.len())),
            "{size}: {} in {text}",
            read.len()
        );
        assert!(text.contains("replayable: \"false\""));
        let listed = text.matches("- path: ").count();
        assert_eq!(fs::read_dir(&path).unwrap().count(), listed + 1, "{size}: files beside those that are told of");
    }
    assert!(readable > 200, "{readable}");
    assert!(
        write_on(&Space::of(room), &BagOptions { max_duration_ns: Some(1), ..at(folder.path().join("fits")) }, cycles)
            .is_empty()
    );
}

/// Set for the process that runs with a limit of the operating system.
const CHILD: &str = "LINESHAFT_TEST_FULL_DISK";

/// The same test with real files and the file size limit of the operating system (RLIMIT_FSIZE).
#[test]
fn a_limit_of_the_system_leaves_whole_files() {
    if let Some(path) = std::env::var_os(CHILD) {
        return write_below_the_limit(Path::new(&path));
    }
    let folder = tempfile::tempdir().unwrap();
    let program = std::env::current_exe().unwrap();
    // In units of 512 bytes. A limit of 2 is too small even for metadata.yaml.
    for (blocks, has_metadata) in [(2, false), (60, true), (200, true)] {
        let path = folder.path().join(blocks.to_string());
        let (_, module) = module_path!().split_once("::").unwrap();
        let name = format!("{module}::a_limit_of_the_system_leaves_whole_files");
        let script =
            format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" --exact {name} --nocapture --test-threads 1");
        let output = Command::new("sh").args(["-c", &script]).arg(&program).env(CHILD, &path).output().unwrap();
        let said = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && said.contains("1 passed"), "{said}");
        let file = path.join(format!("{blocks}_0.mcap"));
        if !has_metadata {
            assert!(!path.exists(), "{said}");
            continue;
        }
        let messages = whole_messages(&fs::read(&file).unwrap());
        assert_eq!(messages, super::messages(&run().encoded)[..messages.len()]);
        assert!(!messages.is_empty());
        let text = fs::read_to_string(path.join(FILE_NAME)).unwrap();
        assert!(text.contains(&format!("  message_count: {}\n  topics", messages.len())), "{text}");
        assert_eq!(fs::read_dir(&path).unwrap().count(), 2);
    }
}

fn write_below_the_limit(path: &Path) {
    let mut errors = Vec::new();
    match Bag::create(&at(path.to_owned()), subject()) {
        Err(error) => errors.push(error),
        Ok(mut bag) => errors.extend(run().encoded.iter().filter_map(|encoded| bag.write(encoded).err())),
    }
    let sentence = errors[0].to_string();
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    let file = path.join(format!("{name}_0.mcap"));
    assert_eq!(sentence, format!("cannot write {}: File too large (os error 27)", file.display()));
}

//! Tests which files belong to a run.

use super::super::Run;
use super::{read, refused, text};
use crate::recording::test_bags::TestBag;
use lineshaft_msgs::foreign::std_msgs::msg::String as Text;
use std::path::Path;
use tempfile::{TempDir, tempdir};

fn bag(times: &[u64]) -> Vec<u8> {
    let mut bag = TestBag::new();
    for time in times {
        bag.message("/a", *time, &text("x"));
    }
    bag.finish()
}

fn folder(files: &[(&str, &[u8])]) -> TempDir {
    let folder = tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    folder
}

fn times(path: &Path) -> Vec<u64> {
    let (messages, error) = read(path);
    assert!(error.is_none(), "{error:?}");
    messages.into_iter().map(|(_, time, _)| time).collect()
}

fn description(files: &str, more: &str) -> String {
    format!(
        "rosbag2_bagfile_information:\n  version: 9\n  storage_identifier: mcap\n  relative_file_paths:\n{files}  custom_data: ~\n{more}"
    )
}

#[test]
fn metadata_gives_the_files_and_their_order() {
    let listed = description("    - run_1.mcap\n    - run_0.mcap\n", "");
    let (first, second, other) = (bag(&[1, 2]), bag(&[3, 4]), bag(&[9]));
    let files: [(&str, &[u8]); 4] =
        [("metadata.yaml", listed.as_bytes()), ("run_0.mcap", &first), ("run_1.mcap", &second), ("other.mcap", &other)];
    let folder = folder(&files);
    assert_eq!(times(folder.path()), [3, 4, 1, 2]);
    assert_eq!(times(&folder.path().join("metadata.yaml")), [3, 4, 1, 2]);
    assert_eq!(times(&folder.path().join("run_0.mcap")), [1, 2]);
}

#[test]
fn without_a_description_the_first_messages_say_the_order() {
    let (first, second, third) = (bag(&[1, 2]), bag(&[3]), bag(&[]));
    let files: [(&str, &[u8]); 4] = [("z.mcap", &first), ("m.mcap", &second), ("a.mcap", &third), ("notes.txt", b"")];
    let folder = folder(&files);
    assert_eq!(times(folder.path()), [1, 2, 3]);
    let run = Run::open(folder.path()).unwrap();
    let names: Vec<_> = run.files().iter().map(|file| file.path.file_name().unwrap().to_owned()).collect();
    assert_eq!(names, ["z.mcap", "m.mcap", "a.mcap"]);
}

#[test]
fn what_is_no_run_is_refused_with_a_sentence() {
    let nothing = tempdir().unwrap();
    let missing = nothing.path().join("run.mcap");
    assert_eq!(refused(&missing), "run.mcap: No such file or directory (os error 2)");
    let empty = refused(nothing.path());
    assert!(empty.ends_with(": there is no .mcap file in this folder"), "{empty}");
    let database = folder(&[("run_0.db3", b"SQLite format 3\0....")]);
    let sentence = "run_0.db3: this is a bag in an sqlite3 database; `ros2 bag convert` makes an MCAP file of it";
    assert!(refused(database.path()).ends_with(sentence));
    assert_eq!(refused(&database.path().join("run_0.db3")), sentence);
    let packed = folder(&[("run_0.mcap.zstd", &[0x28, 0xb5, 0x2f, 0xfd, 0])]);
    let sentence = "run_0.mcap.zstd: this file is compressed as a whole, which is not read; ";
    assert!(refused(packed.path()).contains(sentence));
    assert_eq!(refused(&packed.path().join("run_0.mcap.zstd")), format!("{sentence}`zstd -d` unpacks it"));
    let other = folder(&[("run.mcap", b"#!/bin/sh")]);
    assert_eq!(refused(&other.path().join("run.mcap")), "run.mcap: this is no MCAP file");
    let device = refused(Path::new("/dev/zero"));
    assert!(device.ends_with("zero: a file or a folder is expected"), "{device}");
}

#[test]
fn a_bad_description_is_refused_with_its_place() {
    let refused = |text: &str| {
        let folder = folder(&[("metadata.yaml", text.as_bytes()), ("run_0.mcap", &bag(&[1]))]);
        refused(&folder.path().join("metadata.yaml"))
    };
    let said = refused(&description("    - ../run_0.mcap\n", ""));
    assert_eq!(
        said,
        "metadata.yaml:5:7: relative_file_paths[0] is `../run_0.mcap`; a file within the folder is allowed"
    );
    let said = refused(&description("    - run_0.mcap\n    - run_0.mcap\n", ""));
    assert_eq!(said, "metadata.yaml:6:7: relative_file_paths[1] is `run_0.mcap`, which is listed before");
    let said = refused(&description("    - run_0.mcap\n    - ./run_0.mcap\n", ""));
    assert_eq!(said, "metadata.yaml:6:7: relative_file_paths[1] is `./run_0.mcap`, which is listed before");
    let said = refused(&description("    - ./.\n", ""));
    assert_eq!(said, "metadata.yaml:5:7: relative_file_paths[0] is `./.`; a file within the folder is allowed");
    assert_eq!(refused(&description("    - run_7.mcap\n", "")), "run_7.mcap: No such file or directory (os error 2)");
    let said = refused("rosbag2_bagfile_information: {version: 9}\n");
    assert!(said.contains("missing key `relative_file_paths`"), "{said}");
    let said = refused("a: [\n");
    assert!(said.starts_with("metadata.yaml:"), "{said}");
    for (mode, what) in [("FILE", "the files of this bag are compressed as a whole"), ("message", "each message")] {
        let said = refused(&description("    - run_0.mcap\n", &format!("  compression_mode: {mode}\n")));
        assert!(said.contains(what) && said.contains("`ros2 bag convert` unpacks it"), "{said}");
    }
    let plain = description("    - run_0.mcap\n", "  compression_mode: \"\"\n");
    let folder = folder(&[("metadata.yaml", plain.as_bytes()), ("run_0.mcap", &bag(&[1]))]);
    assert_eq!(times(folder.path()), [1]);
}

#[test]
fn other_encodings_are_given_out_as_they_stand() {
    let mut bag = TestBag::new();
    bag.raw("/json", "", "json", 0, b"{}");
    bag.message("/a", 1, &text("x"));
    let folder = folder(&[("run.mcap", &bag.finish())]);
    let mut run = Run::open(&folder.path().join("run.mcap")).unwrap();
    let message = run.next_message().unwrap().unwrap();
    assert_eq!((message.topic, message.encoding, message.data), ("/json", "json", &b"{}"[..]));
    assert_eq!(message.decode::<Text>(), Err("it is encoded as `json`; only cdr is read".to_owned()));
    let message = run.next_message().unwrap().unwrap();
    assert!(message.is_cdr());
    assert_eq!(message.decode::<Text>(), Ok(text("x")));
}

#[test]
fn a_folder_of_several_runs_is_refused() {
    let of = |cell: Option<&str>, times: &[u64]| {
        let mut bag = TestBag::new();
        if let Some(cell) = cell {
            bag.metadata("lineshaft", &[("cell_sha256", cell)]);
        }
        for time in times {
            bag.message("/a", *time, &text("x"));
        }
        bag.finish()
    };
    let opened = |files: &[(&str, Vec<u8>)]| {
        let files: Vec<(&str, &[u8])> = files.iter().map(|(name, bytes)| (*name, bytes.as_slice())).collect();
        let folder = folder(&files);
        Run::open(folder.path()).map(|run| run.files().len()).map_err(|error| error.to_string())
    };
    let (one, more, other) = (of(Some("1"), &[1]), of(Some("1"), &[2]), of(Some("2"), &[3]));
    assert_eq!(opened(&[("a.mcap", one.clone()), ("b.mcap", more.clone())]), Ok(2));
    let said = opened(&[("a.mcap", one.clone()), ("b.mcap", more), ("c.mcap", other.clone())]).unwrap_err();
    let sentence =
        ": a.mcap and c.mcap were not recorded with the same cell and are no parts of one run; name one of them";
    assert!(said.ends_with(sentence), "{said}");
    let foreign = of(None, &[4]);
    assert!(opened(&[("a.mcap", one.clone()), ("b.mcap", foreign.clone())]).is_err());
    assert_eq!(opened(&[("a.mcap", foreign), ("b.mcap", of(None, &[5]))]), Ok(2));
    // A file without messages, from a recorder that was killed at the start, does not count.
    assert_eq!(opened(&[("a.mcap", one.clone()), ("b.mcap", of(None, &[]))]), Ok(2));
    // The files of a description were grouped on purpose.
    let listed = description("    - a.mcap\n    - c.mcap\n", "").into_bytes();
    assert_eq!(opened(&[("metadata.yaml", listed), ("a.mcap", one), ("c.mcap", other)]), Ok(2));
}

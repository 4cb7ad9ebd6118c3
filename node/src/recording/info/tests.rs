use super::*;
use crate::recording::test_bags::{TestBag, joints};
use std::path::Path;
use tempfile::{TempDir, tempdir};

fn told(files: &[(&str, &[u8])]) -> (String, Option<String>) {
    let folder: TempDir = tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    let path = if files.len() == 1 { folder.path().join(files[0].0) } else { folder.path().to_owned() };
    let info = Info::of(&mut Run::open(Path::new(&path)).unwrap());
    let short = |text: String| text.replace(&format!("{}/", folder.path().display()), "");
    (short(info.to_string()), info.error().map(|error| short(error.to_string())))
}

/// Returns a recording of Lineshaft with these cycles.
fn recording(cycles: std::ops::Range<u64>, attached: &[(&str, &[u8])], end: Option<(&str, &str)>) -> Vec<u8> {
    let mut bag = TestBag::new();
    bag.metadata("lineshaft", &[("version", "1.2.3"), ("cycle_ns", "1000000")]);
    for (name, data) in attached {
        bag.attach(name, data);
    }
    for cycle in cycles {
        let time = 1_785_414_896_000_000_000 + cycle * 1_000_000;
        bag.message("/ls/inputs", time, &CycleInputs { cycle, ..CycleInputs::default() });
        if cycle % 2 == 0 {
            bag.message("/joint_states", time, &joints(time, &[("x", 0.0)]));
            bag.end_chunk();
        }
    }
    if let Some((replayable, lost)) = end {
        bag.metadata("lineshaft_end", &[("replayable", replayable), ("lost", lost)]);
    }
    bag.finish()
}

const CELL: (&str, &[u8]) = ("cell.yaml", &[b'#'; 1600]);

#[test]
fn a_recording_of_ours() {
    let bytes = recording(0..5, &[CELL], Some(("true", "0")));
    let (text, error) = told(&[("run.mcap", &bytes)]);
    assert_eq!(error, None);
    let size = super::size(bytes.len() as u64);
    let expected = format!(
        "Files:             run.mcap
Bag size:          {size}
Storage id:        mcap, profile ros2
Duration:          0.004 s
Start:             2026-07-30T12:34:56.000Z
End:               2026-07-30T12:34:56.004Z
Messages:          8
Topic information: Topic: /joint_states | Type: sensor_msgs/msg/JointState | Count: 3 | Serialization Format: cdr
                   Topic: /ls/inputs | Type: lineshaft_msgs/msg/CycleInputs | Count: 5 | Serialization Format: cdr
Lineshaft:         cycle_ns: 1000000
                   version: 1.2.3
Attachments:       cell.yaml, 1.6 KiB
Cycles:            0 to 4, 0 lost
Replayable:        yes
"
    );
    assert_eq!(text, expected);
}

#[test]
fn why_a_run_cannot_be_replayed() {
    let line = |files: &[(&str, &[u8])]| {
        let (text, _) = told(files);
        text.lines().find(|line| line.starts_with("Replayable:")).unwrap().replace("Replayable:        ", "")
    };
    let one = |bytes: Vec<u8>| line(&[("run.mcap", &bytes)]);
    let end = Some(("true", "0"));
    assert_eq!(one(recording(0..5, &[], end)), "no, no cell is attached");
    assert_eq!(one(recording(0..0, &[CELL], end)), "no, it holds no inputs");
    let early = "no, it begins with cycle 3, and the machine's state there is not attached";
    assert_eq!(one(recording(3..5, &[CELL], end)), early);
    assert_eq!(one(recording(3..5, &[CELL, ("machine_state", b"x")], end)), "yes");
    assert_eq!(one(recording(0..5, &[CELL], Some(("false", "1234")))), "no, 1 234 cycles are lost");
    assert_eq!(one(recording(0..5, &[CELL], Some(("false", "0")))), "no, its recorder says so");
    assert_eq!(one(recording(0..5, &[CELL], None)), "yes, but its recording was not finished");
    let mut foreign = TestBag::new();
    foreign.message("/joint_states", 0, &joints(0, &[("x", 0.0)]));
    assert_eq!(one(foreign.finish()), "no, it was not recorded by lineshaft");
    let (first, second) = (recording(0..5, &[CELL], end), recording(7..9, &[CELL], end));
    assert_eq!(line(&[("a.mcap", &first), ("b.mcap", &second)]), "no, 2 cycles are lost");
    assert_eq!(line(&[("a.mcap", &first), ("b.mcap", &first)]), "no, its cycles do not follow one another");
}

#[test]
fn what_is_lost_and_what_is_damaged() {
    let bytes = recording(0..9, &[CELL], Some(("true", "0")));
    // Cut within the last chunk.
    let chunk = mcap::Summary::read(&bytes).unwrap().unwrap().chunk_indexes.last().unwrap().chunk_start_offset;
    let (text, error) = told(&[("run.mcap", &bytes[..chunk as usize + 20])]);
    assert_eq!(error, None);
    let cut = text.lines().find(|line| line.starts_with("Cut:")).unwrap();
    assert!(
        cut.contains("run.mcap: the file ends within a chunk; ") && cut.ends_with("; the last cycle is 6"),
        "{cut}"
    );
    let mut damaged = bytes;
    damaged[chunk as usize + 60] ^= 0xff;
    let (text, error) = told(&[("run.mcap", &damaged)]);
    assert!(error.unwrap().starts_with("run.mcap, byte "), "{text}");
    assert!(text.contains("Cycles:            0 to 6, 0 lost\nReplayable:        no, it is damaged\n"), "{text}");
}

#[test]
fn attachments_of_the_same_name_are_one_line() {
    let (first, second) = (recording(0..5, &[CELL], None), recording(5..9, &[CELL, ("machine_state", b"x")], None));
    let third = recording(9..10, &[CELL, ("machine_state", b"longer")], None);
    let (text, _) = told(&[("a.mcap", &first), ("b.mcap", &second), ("c.mcap", &third)]);
    let lines =
        "Attachments:       cell.yaml, 1.6 KiB, 3 times\n                   machine_state, 1 B to 6 B, 2 times\n";
    assert!(text.contains(lines), "{text}");
    let mut many = TestBag::new();
    (0..103).for_each(|place| many.attach(&format!("a{place}"), b""));
    let (text, _) = told(&[("run.mcap", &many.finish())]);
    assert!(text.contains("a99, 0 B\n                   and 3 more\n"), "{text}");
}

#[test]
fn other_encodings_are_counted() {
    let mut bag = TestBag::new();
    bag.raw("/json", "foxglove.Pose", "json", 1, b"{}");
    bag.raw("/inputs", CycleInputs::NAME, "json", 2, b"{}");
    bag.message("/joint_states", 3, &joints(3, &[("x", 0.0)]));
    let (text, error) = told(&[("run.mcap", &bag.finish())]);
    assert_eq!(error, None);
    assert!(text.contains("Messages:          3\n"), "{text}");
    assert!(text.contains("Topic: /json | Type: foxglove.Pose | Count: 1 | Serialization Format: json\n"), "{text}");
}

#[test]
fn names_do_not_steer_the_terminal() {
    let mut bag = TestBag::new();
    bag.metadata("lineshaft", &[("version\u{1b}", "1\r2")]);
    bag.attach("a\u{7}", b"");
    bag.raw("/a\u{1b}[2J\nReplayable: yes", "b\u{9b}", "c\r", 1, b"");
    let (text, _) = told(&[("run.mcap", &bag.finish())]);
    assert!(text.chars().all(|letter| !letter.is_control() || letter == '\n'), "{text}");
    assert!(text.contains("Topic: /a\\u{1b}[2J\\nReplayable: yes | Type: b\\u{9b} | Count: 1"), "{text}");
    assert!(text.contains("version\\u{1b}: 1\\r2\n") && text.contains("a\\u{7}, 0 B\n"), "{text}");
}

#[test]
fn files_of_several_runs_are_described() {
    let file = |cell: &str, time: u64| {
        let mut bag = TestBag::new();
        bag.metadata("lineshaft", &[("cell_sha256", cell)]);
        bag.message("/joint_states", time, &joints(time, &[("x", 0.0)]));
        bag.finish()
    };
    let folder = tempdir().unwrap();
    for (name, cell) in [("a.mcap", "11"), ("b.mcap", "22")] {
        std::fs::write(folder.path().join(name), file(cell, 5)).unwrap();
    }
    assert!(Run::open(folder.path()).is_err());
    let text = Info::of(&mut Run::open_any(folder.path()).unwrap()).to_string();
    assert!(text.contains("Messages:          2\n"), "{text}");
    assert!(text.contains("Replayable:        no, its files were not recorded with the same cell\n"), "{text}");
}

#[test]
fn times_and_sizes() {
    let times = [
        (0, "1970-01-01T00:00:00.000Z"),
        (951_782_399_999_999_999, "2000-02-28T23:59:59.999999999Z"),
        (951_782_400_000_000_000, "2000-02-29T00:00:00.000Z"),
        (951_868_800_123_000_000, "2000-03-01T00:00:00.123Z"),
        (1_767_225_599_000_100_000, "2025-12-31T23:59:59.0001Z"),
        (u64::MAX, "2554-07-21T23:34:33.709551615Z"),
    ];
    for (time, text) in times {
        assert_eq!(utc(time), text);
    }
    let sizes = [(0, "0 B"), (1023, "1023 B"), (1024, "1.0 KiB"), (5 << 20, "5.0 MiB"), (u64::MAX, "16777216.0 TiB")];
    for (bytes, text) in sizes {
        assert_eq!(size(bytes), text);
    }
}

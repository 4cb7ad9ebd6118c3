//! Tests the commands that read recordings, on the command line.

use crate::support::machine::share;
use lineshaft_msgs::foreign::builtin_interfaces::msg::Time;
use lineshaft_msgs::foreign::sensor_msgs::msg::JointState;
use lineshaft_msgs::foreign::std_msgs::msg::Header;
use lineshaft_msgs::{Message, cdr};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::process::{Command, Output};

/// Writes joint_states of a joint that moves at 0.5 m/s, `late` (in m) behind the expected position.
fn write(path: &Path, start_s: i32, late: f64) -> mcap::McapResult<()> {
    let options = mcap::WriteOptions::new().profile("ros2");
    let mut writer = options.create(BufWriter::new(File::create(path)?))?;
    let schema = writer.add_schema(JointState::NAME, "ros2msg", JointState::SCHEMA.as_bytes())?;
    let channel = writer.add_channel(schema, "/joint_states", "cdr", &BTreeMap::new())?;
    for sample in 0..200_u32 {
        let (sec, nanosec) = (start_s + (sample / 100) as i32, sample % 100 * 10_000_000);
        let message = JointState {
            header: Header { stamp: Time { sec, nanosec }, frame_id: String::new() },
            name: vec!["x".to_owned()],
            position: vec![f64::from(sample) * 0.005 - late],
            ..JointState::default()
        };
        let time = u64::from(sec.cast_unsigned()) * 1_000_000_000 + u64::from(nanosec);
        let head =
            mcap::records::MessageHeader { channel_id: channel, sequence: sample, log_time: time, publish_time: time };
        writer.write_to_known_channel(&head, &cdr::encode_with_header(&message))?;
    }
    writer.finish()?;
    Ok(())
}

#[track_caller]
fn lineshaft(folder: &Path, arguments: &[&str], code: i32) -> (String, String) {
    let _machine = share();
    let program = Command::new(env!("CARGO_BIN_EXE_lineshaft")).args(arguments).current_dir(folder).output();
    let Output { status, stdout, stderr } = program.expect("the program starts");
    let text = |bytes| String::from_utf8(bytes).expect("text");
    let (out, err) = (text(stdout), text(stderr));
    assert_eq!(status.code(), Some(code), "{arguments:?}: {out}{err}");
    (out, err)
}

#[test]
fn validate_ends_with_0_1_or_2() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(&folder.join("run.mcap"), 1_700_000_000, 5e-6).unwrap();
    write(&folder.join("expected.mcap"), 10, 0.0).unwrap();
    let validate = |more: &[&str], code| {
        lineshaft(folder, &[&["validate", "run.mcap", "--against", "expected.mcap"], more].concat(), code)
    };
    let (report, _) = validate(&[], 1);
    assert!(
        report.contains("FAIL: deviates")
            && report.ends_with("FAILED: 1 of 1 signals is not as expected: x.actual.position\n"),
        "{report}"
    );
    let (report, _) = validate(&["--tolerance", "x.position=10 um"], 0);
    assert!(report.ends_with("PASSED: the signal agrees\n"), "{report}");
    validate(&["--tolerance", "*=10 um", "--tolerance", "x.*=1 um"], 1);
    validate(&["--tolerance", "*.position=0.00001", "--align", "motion"], 0);
    let (_, error) = validate(&["--tolerance", "y.position=1 mm"], 2);
    assert!(error.contains("no signal matches `y.position`") && error.contains("x.actual.position"), "{error}");
    let (_, error) = validate(&["--tolerance", "x.position=1mm"], 2);
    assert!(error.contains("`1mm` has no blank between number and unit, write `1 mm`"), "{error}");
    let (_, error) = lineshaft(folder, &["validate", "none.mcap", "--against", "expected.mcap"], 2);
    assert_eq!(error, "error: none.mcap: No such file or directory (os error 2)\n");
    let (help, _) = lineshaft(folder, &["validate", "--help"], 0);
    for said in ["10 um", "rad/s", "--align", "Examples:", "'time=50 ms'", "Exit codes"] {
        assert!(help.contains(said), "{said}: {help}");
    }
}

#[test]
fn help_explains_runs_and_exit_codes() {
    let folder = tempfile::tempdir().unwrap();
    for command in [&["validate"][..], &["replay"], &["plot"], &["bag", "info"]] {
        let (help, _) = lineshaft(folder.path(), &[command, &["--help"]].concat(), 0);
        assert!(help.contains("The run: an .mcap file, a folder, or a metadata.yaml"), "{command:?}: {help}");
    }
    let (help, _) = lineshaft(folder.path(), &["bag", "info", "--help"], 0);
    assert!(help.contains("Exit codes: 0"), "{help}");
}

#[test]
fn a_folder_of_several_runs_is_only_described() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::create_dir(folder.join("all")).unwrap();
    write(&folder.join("all/a.mcap"), 5, 0.0).unwrap();
    let mut writer = mcap::WriteOptions::new().create(File::create(folder.join("all/b.mcap")).unwrap()).unwrap();
    let metadata = [("cell_sha256".to_owned(), "12".to_owned())].into();
    writer.write_metadata(&mcap::records::Metadata { name: "lineshaft".to_owned(), metadata }).unwrap();
    let channel = writer.add_channel(0, "/\u{1b}[2Jjson", "json", &BTreeMap::new()).unwrap();
    let head = mcap::records::MessageHeader { channel_id: channel, sequence: 0, log_time: 1, publish_time: 1 };
    writer.write_to_known_channel(&head, b"{}").unwrap();
    writer.finish().unwrap();
    let (_, error) = lineshaft(folder, &["validate", "all", "--against", "all"], 2);
    assert!(error.contains("all: b.mcap and a.mcap were not recorded with the same cell"), "{error}");
    let (info, error) = lineshaft(folder, &["bag", "info", "all"], 0);
    assert!(info.contains("Topic: /\\u{1b}[2Jjson | Type:  | Count: 1 | Serialization Format: json"), "{info}");
    assert!(error.is_empty() && info.contains("no, its files were not recorded with the same cell"), "{info}");
}

#[test]
fn bag_info_shows_the_contents_of_a_truncated_file() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(&folder.join("run.mcap"), 0, 0.0).unwrap();
    let (info, _) = lineshaft(folder, &["bag", "info", "run.mcap"], 0);
    let topic = "Topic: /joint_states | Type: sensor_msgs/msg/JointState | Count: 200 | Serialization Format: cdr";
    assert!(info.contains(topic) && info.contains("Duration:          1.990 s\n") && !info.contains("Cut:"), "{info}");
    let bytes = std::fs::read(folder.join("run.mcap")).unwrap();
    std::fs::write(folder.join("run.mcap"), &bytes[..bytes.len() - 20]).unwrap();
    let (info, _) = lineshaft(folder, &["bag", "info", "run.mcap"], 0);
    assert!(
        info.contains(topic) && info.contains("Cut:               run.mcap: the file ends within its index"),
        "{info}"
    );
    let (_, error) = lineshaft(folder, &["bag", "info", "."], 0);
    assert_eq!(error, "");
    std::fs::write(folder.join("run.mcap"), b"nothing").unwrap();
    let (_, error) = lineshaft(folder, &["bag", "info", "run.mcap"], 2);
    assert_eq!(error, "error: run.mcap: this is no MCAP file\n");
}

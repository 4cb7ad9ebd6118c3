//! Tests bags with the reader of the crate `mcap`, and on full disks.

mod full;
pub(super) mod full_disk;
mod published;
mod splits;

use super::super::Topic;
use super::super::metadata::FILE_NAME;
use super::super::rig::{self, MOVING, Recorded};
use super::*;
use crate::cell::Cell;
use crate::parameters::parameters_text;
use lineshaft_msgs::cdr::decode_with_header;
use lineshaft_msgs::foreign::sensor_msgs::msg::JointState;
use lineshaft_msgs::msg::{AppliedCommand, AxisStates, CycleInputs, Event, Signals};
use mcap::records::Record;
use mcap::{MessageStream, read};
use std::fs;
use std::os::unix::ffi::OsStringExt;
use std::sync::OnceLock;

fn subject() -> Subject {
    let cell = Cell::demo();
    let parameters: Vec<_> = cell.machine.axes.iter().map(|axis| axis.parameters).collect();
    Subject {
        parameters: parameters_text(&cell.machine, &cell.machine.global.power_on(), &parameters),
        store: None,
        files: None,
        programs: Vec::new(),
        cell: cell.text,
        node: NodeName::new("/", "lineshaft").unwrap(),
        cycle_ns: 1_000_000,
        version: "0.1.0".to_owned(),
        scenario: None,
        buses: Vec::new(),
        published: Vec::new(),
    }
}

/// 3.5 s of the demo, recorded once for all tests.
fn run() -> &'static Recorded {
    static RUN: OnceLock<Recorded> = OnceLock::new();
    RUN.get_or_init(|| rig::record(&Cell::demo(), MOVING, 3500, 1_000_000_000_000))
}

fn write(options: &BagOptions, cycles: &[Encoded]) -> Summary {
    let mut bag = Bag::create(options, subject()).unwrap();
    cycles.iter().for_each(|encoded| bag.write(encoded).unwrap());
    bag.finish().unwrap()
}

fn at(path: PathBuf) -> BagOptions {
    BagOptions { path, ..BagOptions::default() }
}

/// Content of a finished file, read with the crate `mcap`.
struct Found {
    attachments: BTreeMap<String, Vec<u8>>,
    records: BTreeMap<String, BTreeMap<String, String>>,
    /// Topic, time, message.
    messages: Vec<(String, u64, Vec<u8>)>,
}

fn find(bytes: &[u8]) -> Found {
    let summary = read::Summary::read(bytes).unwrap().unwrap();
    assert_eq!(summary.channels.len(), Topic::ALL.len());
    for channel in summary.channels.values() {
        assert_eq!(channel.message_encoding, "cdr");
        assert!(channel.metadata["offered_qos_profiles"].starts_with("- history: keep_last\n  depth: 1"));
        assert_eq!(channel.schema.as_ref().unwrap().encoding, "ros2msg");
    }
    let has_messages = summary.stats.as_ref().is_some_and(|statistics| statistics.message_count > 0);
    for chunk in summary.chunk_indexes.iter().filter(|_| has_messages) {
        assert!(chunk.message_index_length > 0, "rosbag2 reads by the indexes behind each chunk: {chunk:?}");
    }
    let attachment = |index| read::attachment(bytes, index).unwrap();
    let attachments = summary.attachment_indexes.iter().map(|index| {
        let attachment = attachment(index);
        (attachment.name, attachment.data.into_owned())
    });
    let records = summary.metadata_indexes.iter().map(|index| read::metadata(bytes, index).unwrap());
    let messages = MessageStream::new(bytes).unwrap().map(|message| {
        let message = message.unwrap();
        assert_eq!(message.log_time, message.publish_time);
        (message.channel.topic.clone(), message.log_time, message.data.into_owned())
    });
    Found {
        attachments: attachments.collect(),
        records: records.map(|record| (record.name, record.metadata)).collect(),
        messages: messages.collect(),
    }
}

/// Decodes a message by its topic; returns the number of its cycle if it has one.
fn decode(topic: &str, bytes: &[u8]) -> Option<u64> {
    match topic {
        "/lineshaft/commands" => Some(decode_with_header::<AppliedCommand>(bytes).unwrap().cycle),
        "/lineshaft/inputs" => Some(decode_with_header::<CycleInputs>(bytes).unwrap().cycle),
        "/lineshaft/events" => Some(decode_with_header::<Event>(bytes).unwrap().cycle),
        "/lineshaft/signals" => Some(decode_with_header::<Signals>(bytes).unwrap().cycle),
        "/lineshaft/axis_states" => Some(decode_with_header::<AxisStates>(bytes).unwrap().cycle),
        "/joint_states" => {
            assert_eq!(decode_with_header::<JointState>(bytes).unwrap().name.len(), 3);
            None
        }
        other => panic!("{other}"),
    }
}

/// Returns the messages expected in a file of these cycles.
fn messages(cycles: &[Encoded]) -> Vec<(String, u64, Vec<u8>)> {
    let node = subject().node;
    let of = |encoded: &Encoded| {
        let each = |(topic, bytes): (Topic, &[u8])| {
            (topic.name(&node).unwrap().to_string(), encoded.time.log_ns, bytes.to_vec())
        };
        encoded.messages().map(each).collect::<Vec<_>>()
    };
    cycles.iter().flat_map(of).collect()
}

#[test]
fn a_bag_of_one_file_holds_every_message_and_what_a_replay_needs() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let summary = write(&at(path.clone()), &run().encoded);
    let bytes = fs::read(&path).unwrap();
    assert_eq!(
        summary,
        Summary {
            path: path.clone(),
            files: vec![path.clone()],
            cycles: 3500,
            size: bytes.len() as u64,
            lost: 0,
            replayable: true
        }
    );
    let found = find(&bytes);
    assert_eq!(found.messages, messages(&run().encoded));
    for (topic, time, message) in &found.messages {
        if let Some(cycle) = decode(topic, message) {
            assert_eq!(*time, 1_000_000_000_000 + cycle * 1_000_000);
        }
    }
    assert_eq!(found.attachments.keys().collect::<Vec<_>>(), ["cell.yaml", "parameters.yaml"]);
    assert_eq!(found.attachments["cell.yaml"], Cell::demo().text.into_bytes());
    assert!(
        String::from_utf8_lossy(&found.attachments["parameters.yaml"]).contains("x.max_velocity: 125829120 inc/s\n")
    );
    let record = &found.records["lineshaft"];
    assert_eq!((&*record["version"], &*record["cycle_ns"], &*record["node"]), ("0.1.0", "1000000", "/lineshaft"));
    assert_eq!(record["cell_sha256"].len(), 64);
    let end = &found.records["lineshaft_end"];
    assert_eq!((&*end["replayable"], &*end["lost"]), ("true", "0"));
    let text = fs::read_to_string(folder.path().join(FILE_NAME)).unwrap();
    let count = found.messages.len();
    assert!(text.contains(&format!("  - path: \"run.mcap\"\n      duration:\n        nanoseconds: 3499000000\n      starting_time:\n        nanoseconds_since_epoch: 1000000000000\n      message_count: {count}\n")), "{text}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}

/// FIPS 180-2, appendix B.1.
#[test]
fn the_hash_of_the_cell_is_sha_256() {
    let folder = tempfile::tempdir().unwrap();
    let subject = Subject { cell: "abc".to_owned(), ..subject() };
    let bag = Bag::create(&at(folder.path().join("a")), subject).unwrap();
    assert_eq!(bag.cell_sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

#[test]
fn equal_runs_give_equal_bytes() {
    let record = || {
        let folder = tempfile::tempdir().unwrap();
        let options = BagOptions { max_duration_ns: Some(1), ..at(folder.path().join("run")) };
        let summary = write(&options, &rig::record(&Cell::demo(), MOVING, 2500, 0).encoded);
        assert_eq!(summary.files.len(), 3);
        let mut all: Vec<_> = fs::read_dir(&options.path).unwrap().map(|entry| entry.unwrap().path()).collect();
        all.sort();
        all.iter().map(|path| (path.file_name().unwrap().to_owned(), fs::read(path).unwrap())).collect::<Vec<_>>()
    };
    assert_eq!(record(), record());
}

/// The file of a killed process has all data that was flushed: at most about one second is missing.
#[test]
fn what_a_killed_process_leaves_lacks_a_second_at_most() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut bag = Bag::create(&at(path.clone()), subject()).unwrap();
    for (number, encoded) in run().encoded.iter().enumerate() {
        bag.write(encoded).unwrap();
        if number % 97 == 0 {
            let bytes = fs::read(&path).unwrap();
            let whole = whole_messages(&bytes);
            assert_eq!(whole, messages(&run().encoded)[..whole.len()]);
            let last = whole.last().unwrap().1;
            assert!(encoded.time.log_ns - last <= 1_000_000_000, "cycle {number}");
            assert_eq!(bag.summary().cycles, (last - 1_000_000_000_000) / 1_000_000 + 1);
            assert_eq!(bag.summary().size, bytes.len() as u64);
        }
    }
}

/// Returns the messages of a file without an end. Every record of it must be complete.
fn whole_messages(bytes: &[u8]) -> Vec<(String, u64, Vec<u8>)> {
    let records = read::LinearReader::new_with_options(bytes, read::Options::IgnoreEndMagic.into()).unwrap();
    assert!(records.map(|record| record.unwrap()).any(|record| matches!(record, Record::Metadata(_))));
    let stream = MessageStream::new_with_options(bytes, read::Options::IgnoreEndMagic.into()).unwrap();
    stream
        .map(|message| message.unwrap())
        .map(|message| (message.channel.topic.clone(), message.log_time, message.data.into_owned()))
        .collect()
}

#[test]
fn a_bag_without_a_cycle_is_whole_and_cannot_be_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    // These cycles contain no key cycle.
    let summary = write(&at(path.clone()), &run().encoded[1..900]);
    assert_eq!((summary.cycles, summary.replayable), (0, false));
    let found = find(&fs::read(&path).unwrap());
    assert_eq!((found.messages.len(), found.attachments.len()), (0, 2));
    assert_eq!(found.records["lineshaft_end"]["replayable"], "false");
}

#[test]
fn a_bag_that_begins_later_begins_at_a_key_cycle_with_the_state_of_the_machine() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let summary = write(&at(path.clone()), &run().encoded[700..]);
    assert_eq!((summary.cycles, summary.lost, summary.replayable), (2500, 0, true));
    let found = find(&fs::read(&path).unwrap());
    assert_eq!(found.messages, messages(&run().encoded[1000..]));
    assert_eq!(found.attachments["machine_state"], b"state before 1000");

    // Without a state, replay has no cycle to start from.
    let mut cycles = run().encoded[1000..].to_vec();
    cycles[0].state = None;
    let path = folder.path().join("again.mcap");
    assert!(!write(&at(path.clone()), &cycles).replayable);
    let found = find(&fs::read(&path).unwrap());
    assert_eq!((found.attachments.len(), &*found.records["lineshaft_end"]["replayable"]), (2, "false"));
}

#[test]
fn missing_cycles_are_counted_by_number_or_by_report() {
    let folder = tempfile::tempdir().unwrap();
    for (told, expected) in [(0, 3), (3, 3), (5, 5)] {
        let path = folder.path().join(format!("{told}.mcap"));
        let mut bag = Bag::create(&at(path.clone()), subject()).unwrap();
        let is_there = |encoded: &&Encoded| !(500..502).contains(&encoded.cycle) && encoded.cycle != 1700;
        run().encoded.iter().filter(is_there).for_each(|encoded| bag.write(encoded).unwrap());
        bag.note_lost(told);
        let summary = bag.finish().unwrap();
        assert_eq!((summary.cycles, summary.lost, summary.replayable), (3497, expected, false));
        let end = &find(&fs::read(&path).unwrap()).records["lineshaft_end"];
        assert_eq!((end["replayable"].clone(), end["lost"].clone()), ("false".to_owned(), expected.to_string()));
        let text = fs::read_to_string(folder.path().join(FILE_NAME)).unwrap();
        assert!(text.contains(&format!("    replayable: \"false\"\n    lost: \"{expected}\"\n")), "{text}");
    }
}

#[test]
fn existing_path_is_refused_and_unchanged() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |path: &Path| match Bag::create(&at(path.to_owned()), subject()) {
        Err(BagError::Refused(sentence)) => sentence.replace(&*folder.path().display().to_string(), "runs"),
        Err(error) => panic!("{error}"),
        Ok(_) => panic!("{} is taken, and is taken again", path.display()),
    };
    let (file, old) = (folder.path().join("a.mcap"), folder.path().join("old"));
    fs::write(&file, "something").unwrap();
    fs::create_dir(&old).unwrap();
    let never = "already; a bag never replaces anything";
    assert_eq!(refused(&file), format!("runs/a.mcap exists and is not empty {never}"));
    assert_eq!(refused(&old), format!("runs/old exists {never}"));
    assert_eq!(refused(&old.join("")), format!("runs/old/ exists {never}"));
    fs::rename(&old, folder.path().join("old.mcap")).unwrap();
    assert_eq!(refused(&folder.path().join("old.mcap")), format!("runs/old.mcap is a folder {never}"));
    assert_eq!(fs::read_to_string(&file).unwrap(), "something");
    assert_eq!(refused(&folder.path().join("..")), "runs/..: a bag needs a name of its own");
    assert_eq!(refused(Path::new("")), ": a bag needs a name of its own");
    let no_text = folder.path().join(std::ffi::OsString::from_vec(vec![b'a', 0xFF]));
    assert!(refused(&no_text).ends_with("the name of a bag must be UTF-8 text"));

    // An empty file, as created by mktemp, is allowed.
    fs::write(&file, "").unwrap();
    assert_eq!(write(&at(file), &run().encoded[..10]).cycles, 10);
}

#[test]
fn bags_of_one_file_share_a_folder_and_leave_the_description_of_other_bags_alone() {
    let folder = tempfile::tempdir().unwrap();
    let description = || fs::read_to_string(folder.path().join("metadata.yaml")).unwrap();
    for name in ["a.mcap", "b.mcap"] {
        write(&at(folder.path().join(name)), &run().encoded[..10]);
        assert!(description().contains(&format!("    - \"{name}\"\n")), "{}", description());
    }
    // The description of a deleted bag is replaced.
    fs::remove_file(folder.path().join("b.mcap")).unwrap();
    write(&at(folder.path().join("d.mcap")), &run().encoded[..10]);
    assert!(description().contains("    - \"d.mcap\"\n") && !folder.path().join("b.metadata.yaml").exists());
    write(&at(folder.path().join("bag")), &run().encoded[..10]);
    let inside = folder.path().join("bag");
    let before = fs::read(inside.join("metadata.yaml")).unwrap();
    let refused = |folder: &Path| {
        let sentence = Bag::create(&at(folder.join("c.mcap")), subject()).err().unwrap().to_string();
        assert!(!folder.join("c.mcap").exists());
        assert!(sentence.ends_with("metadata.yaml describes another bag; name a folder of its own"), "{sentence}");
    };
    refused(&inside);
    assert_eq!(fs::read(inside.join("metadata.yaml")).unwrap(), before);
    fs::write(folder.path().join("metadata.yaml"), "rosbag2_bagfile_information: {version: 5}\n").unwrap();
    refused(folder.path());
    fs::write(folder.path().join("metadata.yaml"), [0xff_u8]).unwrap();
    let unread = Bag::create(&at(folder.path().join("c.mcap")), subject()).err().unwrap().to_string();
    assert!(unread.contains("metadata.yaml cannot be read: "), "{unread}");
    assert_eq!(fs::read(folder.path().join("metadata.yaml")).unwrap(), [0xff_u8]);
}

/// `--record a.mcap`, then `--record b.mcap`.
#[test]
fn metadata_of_an_older_bag_in_the_folder_is_kept_under_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    write(&at(path("a.mcap")), &run().encoded[..10]);
    let first = fs::read_to_string(path("metadata.yaml")).unwrap();
    write(&at(path("b.mcap")), &run().encoded[..20]);
    assert_eq!(fs::read_to_string(path("a.metadata.yaml")).unwrap(), first);
    let second = fs::read_to_string(path("metadata.yaml")).unwrap();
    assert!(second.contains("    - \"b.mcap\"\n"), "{second}");
    // It can be opened as the bag that it describes.
    let files = crate::recording::run::Run::open(&path("a.metadata.yaml")).unwrap();
    assert_eq!(files.files().len(), 1);
    // A file of that name that is not the description of such a bag is not changed.
    fs::write(path("b.metadata.yaml"), "mine").unwrap();
    write(&at(path("c.mcap")), &run().encoded[..10]);
    assert_eq!(fs::read_to_string(path("b.metadata.yaml")).unwrap(), "mine");
    assert_eq!(fs::read_to_string(path("b.2.metadata.yaml")).unwrap(), second);
    assert_eq!(fs::read_to_string(path("a.metadata.yaml")).unwrap(), first);
}

/// A bag in its own folder was begun while this one was written.
#[test]
fn metadata_of_another_recorder_that_came_meanwhile_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let mut bag = Bag::create(&at(path("a.mcap")), subject()).unwrap();
    run().encoded[..10].iter().for_each(|encoded| bag.write(encoded).unwrap());
    let other = "rosbag2_bagfile_information: {version: 5}\n";
    fs::write(path("metadata.yaml"), other).unwrap();
    bag.finish().unwrap();
    assert_eq!(fs::read_to_string(path("metadata.yaml")).unwrap(), other);
    assert!(fs::read_to_string(path("a.metadata.yaml")).unwrap().contains("    - \"a.mcap\"\n"));
}

#[test]
fn path_that_cannot_be_created_is_reported_with_the_system_error() {
    for name in ["missing/run", "missing/run.mcap"] {
        let error = Bag::create(&at(PathBuf::from(name)), subject()).err().unwrap();
        assert_eq!(error.to_string(), format!("cannot write {name}: No such file or directory (os error 2)"));
    }
}

#[test]
fn a_bag_of_one_file_has_no_limits() {
    let sentence = "a.mcap is one file and is never split; leave the largest size and duration out, or name a folder";
    for options in [
        BagOptions { max_size: Some(5), ..at("a.mcap".into()) },
        BagOptions { max_duration_ns: Some(5), ..at("a.mcap".into()) },
    ] {
        assert_eq!(Bag::create(&options, subject()).err().unwrap().to_string(), sentence);
    }
}

#[test]
fn a_bag_may_live_in_another_thread() {
    fn can_be_sent<T: Send>(_: &T) {}
    let folder = tempfile::tempdir().unwrap();
    can_be_sent(&Bag::create(&at(folder.path().join("a")), subject()).unwrap());
}

/// Frames follow the other messages of their cycle. Their log time is that of the cycle, their stamp is their own time.
/// In a bag without buses the same cycles give the same bytes as without frames.
#[test]
fn frames_of_buses_have_topics_of_their_own() {
    use super::super::FrameDirection;
    use super::super::run::Run;
    use lineshaft_can::{CAPTURE, Frame as CanFrame, Id};
    use lineshaft_msgs::foreign::can_msgs::msg::Frame;
    let folder = tempfile::tempdir().unwrap();
    let bare = &run().encoded[..20];
    let mut cycles = bare.to_vec();
    let data = CanFrame::data(Id::new(0x183).unwrap(), &[1, 2, 3]).unwrap().to_capture();
    let remote = CanFrame::remote(Id::new(0x703).unwrap(), 1).unwrap().to_capture();
    cycles[3].add_frame(1, FrameDirection::Received, -250, (CAPTURE, &data));
    cycles[3].add_frame(0, FrameDirection::Sent, 70, (CAPTURE, &remote));
    let buses = vec!["bus0".to_owned(), "bus1".to_owned()];
    let path = folder.path().join("kept");
    let mut bag = Bag::create(&at(path.clone()), Subject { buses, ..subject() }).unwrap();
    cycles.iter().for_each(|cycle| bag.write(cycle).unwrap());
    bag.finish().unwrap();
    let mut found = Vec::new();
    let mut bag = Run::open(&path).unwrap();
    while let Some(message) = bag.next_message().unwrap() {
        if message.kind == "can_msgs/msg/Frame" {
            let told: Frame = message.decode().unwrap();
            assert_eq!(message.log_time, cycles[3].time.log_ns);
            let late = i64::from(told.header.stamp.nanosec) - (cycles[3].time.log_ns % 1_000_000_000) as i64;
            found.push((message.topic.to_owned(), late, told.id, told.is_rtr, told.dlc, told.data));
        }
    }
    let kept =
        |topic: &str, late, id, is_rtr, dlc, data| (format!("/lineshaft/can/{topic}"), late, id, is_rtr, dlc, data);
    let expected = [
        kept("bus1/received", -250, 0x183, false, 3, [1, 2, 3, 0, 0, 0, 0, 0]),
        kept("bus0/sent", 70, 0x703, true, 1, [0; 8]),
    ];
    assert_eq!(found, expected);
    let metadata = fs::read_to_string(path.join(FILE_NAME)).unwrap();
    assert_eq!(metadata.matches("type: can_msgs/msg/Frame").count(), 4);
    let bytes = |name: &str, cycles: &[Encoded]| {
        let path = folder.path().join(name);
        write(&at(path.clone()), cycles);
        fs::read(path).unwrap()
    };
    assert!(bytes("a.mcap", bare) == bytes("b.mcap", &cycles));
}

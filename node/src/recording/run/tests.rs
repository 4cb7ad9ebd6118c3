//! Tests complete, cut and damaged files, and folders of them.

mod cuts;
mod flips;
mod folders;
mod hostile;

use super::{Run, RunError};
use crate::recording::test_bags::TestBag;
use lineshaft_msgs::foreign::std_msgs::msg::String as Text;
use mcap::WriteOptions;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Topic, time and data of a message.
type Read = (String, u64, Vec<u8>);

/// A folder with one file.
struct Disk {
    _folder: TempDir,
    path: PathBuf,
}

fn disk(bytes: &[u8]) -> Disk {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    std::fs::write(&path, bytes).unwrap();
    Disk { _folder: folder, path }
}

/// Returns all messages before an error, and the error.
fn read(path: &Path) -> (Vec<Read>, Option<RunError>) {
    match Run::open(path) {
        Ok(run) => read_all(run),
        Err(error) => (Vec::new(), Some(error)),
    }
}

fn read_all(mut run: Run) -> (Vec<Read>, Option<RunError>) {
    let mut messages = Vec::new();
    loop {
        match run.next_message() {
            Ok(Some(message)) => messages.push((message.topic.to_owned(), message.log_time, message.data.to_vec())),
            Ok(None) => return (messages, None),
            Err(error) => {
                assert!(run.next_message().unwrap().is_none(), "nothing is read behind an error");
                return (messages, Some(error));
            }
        }
    }
}

#[track_caller]
fn refused(path: &Path) -> String {
    let (_, error) = read(path);
    let folder = path.parent().unwrap().display().to_string();
    error.expect("an error").to_string().replace(&format!("{folder}/"), "")
}

#[test]
fn progress_is_reported_every_256_messages_and_grows_to_the_size_of_the_file() {
    let mut bag = TestBag::new();
    for sample in 0..1000 {
        bag.message("/t", sample, &text("some"));
        if sample % 100 == 0 {
            bag.end_chunk();
        }
    }
    let bytes = bag.finish();
    let disk = disk(&bytes);
    let mut run = Run::open(&disk.path).unwrap();
    let (sender, calls) = std::sync::mpsc::channel();
    run.set_progress(move |done, of| sender.send((done, of)).unwrap());
    while run.next_message().unwrap().is_some() {}
    run.end_progress();
    run.rewind();
    while run.next_message().unwrap().is_some() {}
    let calls: Vec<(u64, u64)> = calls.into_iter().collect();
    assert_eq!(calls.len(), 3, "of 1000 messages, and none after the end");
    let size = bytes.len() as u64;
    assert!(calls.is_sorted() && calls.iter().all(|(done, of)| *done > 0 && *done <= size && *of == size), "{calls:?}");
}

fn text(text: &str) -> Text {
    Text { data: text.to_owned() }
}

/// Returns a small bag with all kinds of content: two topics, several chunks, attachments, metadata.
fn small(options: WriteOptions) -> Vec<u8> {
    let mut bag = TestBag::with(options);
    bag.metadata("lineshaft", &[("version", "1.2.3"), ("cycle_ns", "1000000")]);
    bag.attach("cell.yaml", b"lineshaft: 1\n");
    for time in 0..12_u64 {
        let topic = if time % 3 == 0 { "/a" } else { "/b/c" };
        bag.message(topic, time * 1000, &text(&format!("message {time} {}", "x".repeat(time as usize))));
        if time % 4 == 3 {
            bag.end_chunk();
        }
    }
    bag.attach("late.txt", b"at the end");
    bag.metadata("lineshaft_end", &[("lost", "0")]);
    bag.finish()
}

/// Options with and without chunks, with and without compression.
fn every_form() -> [WriteOptions; 3] {
    use crate::recording::test_bags::options;
    [options(), options().compression(None), options().use_chunks(false)]
}

#[test]
fn messages_come_in_file_order_with_topic_type_and_time() {
    for options in every_form() {
        let disk = disk(&small(options));
        let mut run = Run::open(&disk.path).unwrap();
        let message = run.next_message().unwrap().unwrap();
        assert_eq!((message.topic, message.kind, message.log_time), ("/a", "std_msgs/msg/String", 0));
        assert_eq!(lineshaft_msgs::cdr::decode_with_header(message.data), Ok(text("message 0 ")));
        run.rewind();
        let file = &run.files()[0];
        assert_eq!((file.profile.as_str(), file.library.as_str(), file.first_time), ("ros2", "test", Some(0)));
        assert_eq!(run.cuts().count(), 0);
        let (messages, error) = read_all(run);
        assert!(error.is_none(), "{error:?}");
        let times: Vec<u64> = messages.iter().map(|(_, time, _)| *time).collect();
        assert_eq!(times, (0..12).map(|time| time * 1000).collect::<Vec<_>>());
        assert!(messages.iter().all(|(topic, time, _)| (topic == "/a") == (time / 1000 % 3 == 0)));
    }
}

#[test]
fn attachments_and_metadata_are_found_wherever_they_stand() {
    for options in every_form() {
        let disk = disk(&small(options));
        let run = Run::open(&disk.path).unwrap();
        assert_eq!(run.attachment("cell.yaml").unwrap().unwrap(), b"lineshaft: 1\n");
        assert_eq!(run.attachment("late.txt").unwrap().unwrap(), b"at the end");
        assert_eq!(run.attachment("nothing").unwrap(), None);
        assert_eq!(run.attachment_of(1, "cell.yaml").unwrap(), None);
        let sizes: Vec<_> = run.files()[0].attachments.iter().map(|a| (a.name.as_str(), a.bytes)).collect();
        assert_eq!(sizes, [("cell.yaml", 13), ("late.txt", 10)]);
        assert_eq!(run.metadata("lineshaft").unwrap()["version"], "1.2.3");
        assert_eq!(run.metadata("lineshaft_end").unwrap()["lost"], "0");
        assert!(run.metadata("nothing").is_none());
    }
}

#[test]
fn numbers_are_grouped_by_thousands() {
    let groups = [0, 7, 123, 1234, 123_456, 1_234_567].map(super::grouped);
    assert_eq!(groups, ["0", "7", "123", "1 234", "123 456", "1 234 567"]);
}

//! Tests topics that the node publishes in addition to those of the cycles.

use super::super::super::replay::replay;
use super::super::super::run::Run;
use super::super::super::series;
use super::*;
use lineshaft_msgs::Message as _;
use lineshaft_msgs::cdr::encode_with_header;
use lineshaft_msgs::foreign::std_msgs::msg::String as Text;
use lineshaft_ros::layer::{Qos, TappedMessage, TappedTopic};

/// robot_description, ~/errors and /rosout, in this order.
fn with_published() -> Subject {
    let subject = subject();
    let topic = |name: &str, schema, qos| TappedTopic { name: subject.node.expand(name).unwrap(), schema, qos };
    let published = vec![
        topic("robot_description", (Text::NAME, Text::SCHEMA), Qos::STATUS),
        topic("~/errors", (Event::NAME, Event::SCHEMA), Qos::HISTORY),
        topic("/rosout", (Text::NAME, Text::SCHEMA), Qos::ROSOUT),
    ];
    Subject { published, ..subject }
}

fn text(data: &str) -> Vec<u8> {
    encode_with_header(&Text { data: data.to_owned() })
}

/// Returns the cycles of [`run`]; the first one has the description, the 500th an error and a log line.
fn cycles() -> Vec<Encoded> {
    let mut cycles = run().encoded.clone();
    cycles[0].add_published(0, &text("<robot/>"));
    cycles[500].add_published(1, &encode_with_header(&Event { text: "x: an error".to_owned(), ..Event::default() }));
    cycles[500].add_published(2, &text("a line"));
    // A topic that was opened after the bag was created.
    cycles[500].add_published(3, &text("lost"));
    cycles
}

/// Returns topic and log time of the messages that belong to no cycle.
fn published(path: &Path) -> Vec<(String, u64)> {
    let mut found = Vec::new();
    let mut bag = Run::open(path).unwrap();
    while let Some(message) = bag.next_message().unwrap() {
        if ["/robot_description", "/lineshaft/errors", "/rosout"].contains(&message.topic) {
            found.push((message.topic.to_owned(), message.log_time));
        }
    }
    found
}

fn write_published(options: &BagOptions) -> Summary {
    let mut bag = Bag::create(options, with_published()).unwrap();
    cycles().iter().for_each(|encoded| bag.write(encoded).unwrap());
    bag.finish().unwrap()
}

#[test]
fn published_topics_are_in_the_bag_and_latched_ones_begin_each_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bag");
    let summary = write_published(&BagOptions { max_duration_ns: Some(1_500_000_000), ..at(path.clone()) });
    let time = |cycle: usize| run().encoded[cycle].time.log_ns;
    let of = |topic: &str, cycle| (topic.to_owned(), time(cycle));
    assert_eq!(
        published(&summary.files[0]),
        [of("/robot_description", 0), of("/lineshaft/errors", 500), of("/rosout", 500)]
    );
    // The new file begins in cycle 2000. Log lines have a lifespan, so they are not repeated.
    assert_eq!(published(&summary.files[1]), [of("/robot_description", 2000), of("/lineshaft/errors", 2000)]);
    let metadata = fs::read_to_string(path.join(FILE_NAME)).unwrap();
    let description = metadata.split("topic_metadata").find(|part| part.contains("/robot_description")).unwrap();
    assert!(description.contains("durability: transient_local") && description.contains("depth: 1"), "{description}");
    assert!(
        description.contains("type: std_msgs/msg/String") && description.contains("message_count: 2"),
        "{description}"
    );
}

/// ~/errors has the type of ~/events and repeats its messages.
#[test]
fn published_topics_change_neither_replay_nor_events_of_a_plot() {
    let folder = tempfile::tempdir().unwrap();
    let (bare, full) = (folder.path().join("bare.mcap"), folder.path().join("full.mcap"));
    write(&at(bare.clone()), &run().encoded);
    write_published(&at(full.clone()));
    let replayed = |path: &Path| {
        let report = replay(&mut Run::open(path).unwrap()).unwrap();
        (report.verdict, report.first, report.cycles, report.values, report.messages)
    };
    assert_eq!(replayed(&bare), replayed(&full));
    assert_eq!(replayed(&full).2, 3500);
    let events =
        |path: &Path| series::load(&mut Run::open(path).unwrap(), &["x.state".to_owned()]).unwrap().marks.len();
    assert_eq!(events(&bare), events(&full));
}

fn late(topic: usize, published_ns: u64, data: &str) -> TappedMessage {
    TappedMessage { topic, published_ns, data: text(data) }
}

#[test]
fn messages_after_the_last_cycle_are_written_with_its_log_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("late.mcap");
    let mut bag = Bag::create(&at(path.clone()), with_published()).unwrap();
    let cycles = &run().encoded[..700];
    cycles.iter().for_each(|encoded| bag.write(encoded).unwrap());
    bag.add_late(vec![late(2, 5, "the last line"), late(0, u64::MAX, "<robot/>")]);
    let summary = bag.finish().unwrap();
    assert_eq!((summary.cycles, summary.replayable), (700, true));
    let last = cycles[699].time.log_ns;
    assert_eq!(published(&path), [("/rosout".to_owned(), last), ("/robot_description".to_owned(), last)]);
    let metadata = fs::read_to_string(folder.path().join(FILE_NAME)).unwrap();
    // 0.699 s from the first cycle to the last one.
    assert!(metadata.contains("\n  duration:\n    nanoseconds: 699000000\n"), "{metadata}");
    let report = replay(&mut Run::open(&path).unwrap()).unwrap();
    assert_eq!(report.cycles, 700);
}

/// An unconfigured node runs no cycle but reports the reason.
#[test]
fn bag_without_a_cycle_has_the_messages_by_their_system_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bag");
    let mut bag = Bag::create(&at(path.clone()), with_published()).unwrap();
    bag.add_late(vec![late(2, 1_700_000_000_000_000_000, "why"), late(2, 1_700_000_000_500_000_000, "again")]);
    let summary = bag.finish().unwrap();
    assert_eq!((summary.cycles, summary.replayable), (0, false));
    let line = |ns| ("/rosout".to_owned(), ns);
    assert_eq!(published(&summary.files[0]), [line(1_700_000_000_000_000_000), line(1_700_000_000_500_000_000)]);
    let metadata = fs::read_to_string(path.join(FILE_NAME)).unwrap();
    assert!(metadata.contains("\n  duration:\n    nanoseconds: 500000000\n"), "{metadata}");
}

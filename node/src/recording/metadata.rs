//! metadata.yaml of a bag, as rosbag2 of ROS 2 Jazzy writes it (its version 9).

use crate::whole_file::WholeFile;
use lineshaft_ros::layer::Qos;
use std::fmt::Write as _;
use std::io;
use std::path::Path;

/// Its file name.
pub const FILE_NAME: &str = "metadata.yaml";
/// Version of the format.
const VERSION: u32 = 9;
/// Infinite duration as rosbag2 writes it.
const WITHOUT_END: (u64, u64) = (9_223_372_036, 854_775_807);

/// Content of metadata.yaml.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Metadata {
    /// Files in the order of their cycles.
    pub files: Vec<FileInformation>,
    /// Topics in the order of the bag.
    pub topics: Vec<TopicInformation>,
    /// Custom names and values.
    pub custom: Vec<(&'static str, String)>,
}

/// A file of a bag.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FileInformation {
    /// File name, without folder.
    pub name: String,
    /// First and last time, in ns; `None` without messages.
    pub span: Option<(u64, u64)>,
    /// Number of messages.
    pub messages: u64,
}

/// A topic of a bag.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TopicInformation {
    /// Full name.
    pub name: String,
    /// Message type, such as `lineshaft_msgs/msg/Event`.
    pub type_name: &'static str,
    /// QoS of the publisher.
    pub qos: Qos,
    /// Number of messages.
    pub messages: u64,
}

impl Metadata {
    /// Returns the text of the file.
    pub fn text(&self) -> String {
        let mut text = format!(
            "rosbag2_bagfile_information:\n  version: {VERSION}\n  storage_identifier: mcap\n{}  message_count: {}\n",
            span_text(self.span(), 2),
            self.topics.iter().map(|topic| topic.messages).sum::<u64>(),
        );
        text += "  topics_with_message_count:\n";
        for topic in &self.topics {
            text += &topic.text();
        }
        text += "  compression_format: \"\"\n  compression_mode: \"\"\n  relative_file_paths:\n";
        for file in &self.files {
            let _ = writeln!(text, "    - {}", quoted(&file.name));
        }
        text += "  files:\n";
        for file in &self.files {
            let (path, span) = (quoted(&file.name), span_text(file.span, 6));
            let _ = write!(text, "    - path: {path}\n{span}      message_count: {}\n", file.messages);
        }
        text += "  custom_data:\n";
        for (name, value) in &self.custom {
            let _ = writeln!(text, "    {name}: {}", quoted(value));
        }
        text += "  ros_distro: jazzy\n";
        text
    }

    fn span(&self) -> Option<(u64, u64)> {
        let spans = || self.files.iter().filter_map(|file| file.span);
        Some((spans().map(|(first, _)| first).min()?, spans().map(|(_, last)| last).max()?))
    }

    /// Writes the file at a path, whole or not at all. An existing file is replaced.
    ///
    /// # Errors
    /// Returns the error of the operating system; no partial file remains.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        WholeFile::write(path, self.text().as_bytes(), None).and_then(WholeFile::replace)
    }
}

fn span_text(span: Option<(u64, u64)>, indent: usize) -> String {
    let (first, last) = span.unwrap_or((0, 0));
    format!(
        "{0:indent$}duration:\n{0:indent$}  nanoseconds: {1}\n{0:indent$}starting_time:\n{0:indent$}  \
         nanoseconds_since_epoch: {first}\n",
        "",
        last - first,
    )
}

impl TopicInformation {
    fn text(&self) -> String {
        format!(
            "    - topic_metadata:\n        name: {}\n        type: {}\n        serialization_format: cdr\n        \
             offered_qos_profiles:\n{}        type_description_hash: \"\"\n      message_count: {}\n",
            quoted(&self.name),
            self.type_name,
            qos_text(self.qos, 10),
            self.messages,
        )
    }
}

/// Returns a list of one QoS profile, as in metadata.yaml and in the channels of a file.
pub(super) fn qos_text(qos: Qos, indent: usize) -> String {
    let time = |name: &str, (sec, nsec): (u64, u64)| format!("  {name}:\n    sec: {sec}\n    nsec: {nsec}\n");
    let lifespan = qos.lifespan.map_or(WITHOUT_END, |age| (age.as_secs(), age.subsec_nanos().into()));
    let text = format!(
        "- history: keep_last\n  depth: {}\n  reliability: {}\n  durability: {}\n{}{}  liveliness: automatic\n{}  \
         avoid_ros_namespace_conventions: false\n",
        qos.depth,
        if qos.reliable { "reliable" } else { "best_effort" },
        if qos.latched { "transient_local" } else { "volatile" },
        time("deadline", WITHOUT_END),
        time("lifespan", lifespan),
        time("liveliness_lease_duration", WITHOUT_END),
    );
    text.lines().map(|line| format!("{:indent$}{line}\n", "")).collect()
}

/// Returns a text in double quotes, with special characters escaped.
pub(super) fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            // YAML does not allow Unicode line ends and the byte order mark in a plain text.
            '\u{2028}' | '\u{2029}' | '\u{feff}' => {
                let _ = write!(out, "\\u{:04x}", u32::from(c));
            }
            c if c.is_control() => {
                let _ = write!(out, "\\x{:02x}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use saphyr_parser::{Event, Parser};
    use std::fs;

    fn metadata(names: &[&str]) -> Metadata {
        let file = |name: &&str| FileInformation { name: (*name).to_owned(), span: Some((5, 12)), messages: 7 };
        let topic = TopicInformation {
            name: "/lineshaft/events".to_owned(),
            type_name: "lineshaft_msgs/msg/Event",
            qos: Qos::EVENTS,
            messages: 7,
        };
        Metadata {
            files: names.iter().map(file).collect(),
            topics: vec![topic],
            custom: vec![("replayable", "true".to_owned())],
        }
    }

    /// Returns every scalar of a YAML text.
    fn scalars(text: &str) -> Vec<String> {
        let events = Parser::new_from_str(text).map(|event| event.unwrap_or_else(|error| panic!("{error} in\n{text}")));
        events
            .filter_map(|(event, _)| match event {
                Event::Scalar(value, ..) => Some(value.into_owned()),
                _ => None,
            })
            .collect()
    }

    #[test]
    fn the_text_is_that_of_rosbag2() {
        let expected = "\
rosbag2_bagfile_information:
  version: 9
  storage_identifier: mcap
  duration:
    nanoseconds: 7
  starting_time:
    nanoseconds_since_epoch: 5
  message_count: 7
  topics_with_message_count:
    - topic_metadata:
        name: \"/lineshaft/events\"
        type: lineshaft_msgs/msg/Event
        serialization_format: cdr
        offered_qos_profiles:
          - history: keep_last
            depth: 1000
            reliability: reliable
            durability: volatile
            deadline:
              sec: 9223372036
              nsec: 854775807
            lifespan:
              sec: 9223372036
              nsec: 854775807
            liveliness: automatic
            liveliness_lease_duration:
              sec: 9223372036
              nsec: 854775807
            avoid_ros_namespace_conventions: false
        type_description_hash: \"\"
      message_count: 7
  compression_format: \"\"
  compression_mode: \"\"
  relative_file_paths:
    - \"a b: c_0.mcap\"
  files:
    - path: \"a b: c_0.mcap\"
      duration:
        nanoseconds: 7
      starting_time:
        nanoseconds_since_epoch: 5
      message_count: 7
  custom_data:
    replayable: \"true\"
  ros_distro: jazzy
";
        assert_eq!(metadata(&["a b: c_0.mcap"]).text(), expected);
    }

    #[test]
    fn the_span_is_that_of_all_files_and_zero_without_messages() {
        let mut two = metadata(&["a", "b"]);
        two.files[1].span = Some((20, 50));
        assert!(
            two.text()
                .contains("\n  duration:\n    nanoseconds: 45\n  starting_time:\n    nanoseconds_since_epoch: 5\n")
        );
        two.files.iter_mut().for_each(|file| file.span = None);
        assert!(two.text().contains("\n  duration:\n    nanoseconds: 0\n"));
    }

    proptest! {
        #[test]
        fn any_file_name_reads_back(name in "\\PC*|[\\x00-\\x7f]*|[\"\\\\\n: #-]*|.*") {
            prop_assert_eq!(scalars(&quoted(&name)), [name.clone()]);
            let found = scalars(&metadata(&[&name]).text());
            prop_assert_eq!(found.iter().filter(|scalar| **scalar == name).count() >= 2, true, "{:?}", name);
        }
    }

    #[test]
    fn a_file_is_replaced_whole_and_nothing_is_left_of_one_that_fails() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(FILE_NAME), "old").unwrap();
        let path = folder.path().join(FILE_NAME);
        metadata(&["a"]).write(&path).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), metadata(&["a"]).text());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);

        // A folder of that name cannot be replaced by a file.
        fs::remove_file(&path).unwrap();
        fs::create_dir_all(path.join("in the way")).unwrap();
        metadata(&["a"]).write(&path).unwrap_err();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}

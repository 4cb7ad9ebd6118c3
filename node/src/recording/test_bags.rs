//! Creates bags for tests with the crate `mcap`.

use lineshaft_msgs::foreign::builtin_interfaces::msg::Time;
use lineshaft_msgs::foreign::sensor_msgs::msg::JointState;
use lineshaft_msgs::foreign::std_msgs::msg::Header;
use lineshaft_msgs::msg::{AxisState, AxisStates};
use lineshaft_msgs::{Message, cdr};
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions, Writer};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Cursor;

/// A bag in memory.
pub(crate) struct TestBag {
    writer: Writer<Cursor<Vec<u8>>>,
    channels: BTreeMap<String, u16>,
    sequence: u32,
}

/// Returns the options of a ROS 2 recorder: in chunks, compressed.
pub(crate) fn options() -> WriteOptions {
    WriteOptions::new().profile("ros2").library("test").compression(Some(Compression::Zstd)).chunk_size(None)
}

impl TestBag {
    /// Creates a bag in which only [`TestBag::end_chunk`] ends a chunk.
    pub(crate) fn new() -> Self {
        Self::with(options())
    }

    pub(crate) fn with(options: WriteOptions) -> Self {
        let writer = options.compression_threads(0).create(Cursor::new(Vec::new())).unwrap();
        Self { writer, channels: BTreeMap::new(), sequence: 0 }
    }

    /// Adds a message of any type and encoding.
    pub(crate) fn raw(&mut self, topic: &str, kind: &str, encoding: &str, log_time: u64, data: &[u8]) {
        let channel = match self.channels.get(topic) {
            Some(channel) => *channel,
            None => {
                let schema = self.writer.add_schema(kind, "ros2msg", b"# none").unwrap();
                let channel = self.writer.add_channel(schema, topic, encoding, &BTreeMap::new()).unwrap();
                self.channels.insert(topic.to_owned(), channel);
                channel
            }
        };
        self.sequence += 1;
        let head = MessageHeader { channel_id: channel, sequence: self.sequence, log_time, publish_time: log_time };
        self.writer.write_to_known_channel(&head, data).unwrap();
    }

    pub(crate) fn message<M: Message>(&mut self, topic: &str, log_time: u64, message: &M) {
        self.raw(topic, M::NAME, "cdr", log_time, &cdr::encode_with_header(message));
    }

    pub(crate) fn attach(&mut self, name: &str, data: &[u8]) {
        let attachment = mcap::Attachment {
            log_time: 1,
            create_time: 2,
            name: name.to_owned(),
            media_type: "text/plain".to_owned(),
            data: Cow::Borrowed(data),
        };
        self.writer.attach(&attachment).unwrap();
    }

    pub(crate) fn metadata(&mut self, name: &str, pairs: &[(&str, &str)]) {
        let metadata = pairs.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        self.writer.write_metadata(&mcap::records::Metadata { name: name.to_owned(), metadata }).unwrap();
    }

    pub(crate) fn end_chunk(&mut self) {
        self.writer.flush().unwrap();
    }

    pub(crate) fn finish(mut self) -> Vec<u8> {
        self.writer.finish().unwrap();
        self.writer.into_inner().into_inner()
    }
}

pub(crate) fn header(stamp_ns: u64) -> Header {
    let sec = i32::try_from(stamp_ns / 1_000_000_000).unwrap();
    Header { stamp: Time { sec, nanosec: (stamp_ns % 1_000_000_000) as u32 }, frame_id: String::new() }
}

pub(crate) fn joints(stamp_ns: u64, joints: &[(&str, f64)]) -> JointState {
    JointState {
        header: header(stamp_ns),
        name: joints.iter().map(|(name, _)| (*name).to_owned()).collect(),
        position: joints.iter().map(|(_, position)| *position).collect(),
        velocity: Vec::new(),
        effort: Vec::new(),
    }
}

pub(crate) fn axes(stamp_ns: u64, axes: Vec<AxisState>) -> AxisStates {
    AxisStates { header: header(stamp_ns), cycle: stamp_ns / 1_000_000, axes }
}

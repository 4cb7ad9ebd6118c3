//! Severity of the log messages of the DDS library, and the filter for them.
//!
//! The library logs ordinary events as errors, for example a client that leaves while it is being discovered, as every call of `ros2` does.
//! [`RULES`] lists such messages of version 0.15.1 by their target and first words. A message without a rule keeps its severity, and no
//! rule raises one. `RUST_LOG=rustdds=debug` shows all of them.

use super::dds::NOISE;
use crate::link::protocol::Line;

/// Returns directives for a log filter (`EnvFilter` of `tracing-subscriber`): `level` for all, but only warnings of the DDS library,
/// without those that it repeats although nothing is wrong.
pub fn log_filter(level: &str) -> String {
    let noise = NOISE.iter().map(|(target, level)| format!(",{target}={level}"));
    format!("{level},rustdds=warn{}", noise.collect::<String>())
}

/// Severity of messages with a certain beginning.
struct Rule {
    /// Module of the library.
    target: &'static str,
    /// First words.
    begins: &'static str,
    severity: u8,
}

/// The event is ordinary and has no effect on the node or its clients.
const fn harmless(target: &'static str, begins: &'static str) -> Rule {
    Rule { target, begins, severity: Line::DEBUG }
}

/// Another participant sent data that the library discards: a warning, but no error of the node.
const fn discarded(target: &'static str, begins: &'static str) -> Rule {
    Rule { target, begins, severity: Line::WARN }
}

const RULES: &[Rule] = &[
    // A client leaves between two steps of its discovery.
    harmless("rustdds::rtps::dp_event_loop", "Participant was updated, but DB does not have it."),
    // A reader requests a sample that was written for another reader (side/keeper.rs). It receives a GAP over it.
    harmless("rustdds::rtps::writer", "We were asked to send data meant for the reader"),
    harmless("rustdds::rtps::writer", "We were asked to send datafrags meant for the reader"),
    // The only reader of the sample has left.
    harmless("rustdds::rtps::writer", "Data is meant for the single reader"),
    // A reader acknowledges or requests more than was written, as after a restart of the node. The library ignores the surplus, and the
    // next acknowledgement counts.
    harmless("rustdds::rtps::rtps_reader_proxy", "Ignoring ACKNACK: base"),
    harmless("rustdds::rtps::rtps_reader_proxy", "ReaderProxy "),
    // A writer leaves while its message is being read.
    harmless("rustdds::rtps::reader", "Writer proxy "),
    // The queue was emptied by the previous event.
    harmless("rustdds::rtps::reader", "There was no command. Spurious command event"),
    // An endpoint was closed before it was announced.
    harmless("rustdds::discovery::discovery", "Did not find a local writer"),
    harmless("rustdds::discovery::discovery", "Did not find a local reader"),
    // Topics are not disposed in ROS 2; another program may do so.
    harmless("rustdds::discovery::discovery", "not implemented - Topic was disposed"),
    // The participant is closed, at the end of the process or for a handover.
    harmless("rustdds::discovery::discovery", "DomainParticipant doesn't exist anymore, exiting Discovery"),
    harmless("rustdds::dds::participant", "DomainParticipant status channel disconnected"),
    harmless("rustdds::dds::participant", "dp_event_loop not responding to"),
    harmless("rustdds::dds::participant", "Failed to send stop signal to Discovery"),
    harmless("rustdds::dds::statusevents", "StatusReceiver channel disconnected"),
    // ROS 2 has no ownership.
    harmless("rustdds::dds::qos", "QosPolicies deserializer: Received "),
    // Datagrams and announcements that are damaged, forged, or of another program.
    discarded("rustdds::rtps::message_receiver", ""),
    discarded("rustdds::rtps::fragment_assembler", ""),
    discarded("rustdds::rtps::reader", "Deserializing "),
    discarded("rustdds::rtps::rtps_writer_proxy", "irrelevant_changes_range: negative range"),
    discarded("rustdds::serialization::speedy_pl_cdr_helpers", ""),
    discarded("rustdds::discovery::discovery", " !!! spdp_receive:"),
    discarded("rustdds::discovery::discovery", "sedp_receive_subscription:"),
    discarded("rustdds::discovery::discovery", "sedp_receive_publication:"),
    discarded("rustdds::discovery::discovery", "sedp_receive_topic_data:"),
    discarded("rustdds::discovery::discovery", "receive_participant_message:"),
    discarded("rustdds::discovery::discovery_db", "Discovered participant GUID entity_id is not for participant"),
    discarded("rustdds::discovery::discovery_db", "Inconsistent topic update"),
];

/// Returns the severity of a message that was logged with `severity`.
pub(super) fn severity(target: &str, text: &str, severity: u8) -> u8 {
    let rule = RULES.iter().find(|rule| rule.target == target && text.starts_with(rule.begins));
    // Errors have the lowest number.
    rule.map_or(severity, |rule| rule.severity.max(severity))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_filter_is_understood_and_keeps_the_level() {
        let filter: tracing_subscriber::EnvFilter = log_filter("debug").parse().unwrap();
        let text = filter.to_string();
        for directive in ["debug", "rustdds=warn", "rustdds::rtps::writer=error", "rustdds::network=error"] {
            assert!(text.split(',').any(|part| part == directive), "{directive} in {text}");
        }
    }

    /// Messages as rustdds 0.15.1 writes them; the first three appear at calls of `ros2`. Each reports an ordinary event.
    const HARMLESS: [(&str, &str, u8); 16] = [
        (
            "rustdds::rtps::writer",
            "We were asked to send data meant for the reader GUID {0112} to a different reader GUID {0110}. Not gonna happen.",
            Line::ERROR,
        ),
        ("rustdds::rtps::dp_event_loop", "Participant was updated, but DB does not have it. Strange.", Line::ERROR),
        (
            "rustdds::rtps::rtps_reader_proxy",
            "Ignoring ACKNACK: base SequenceNumber(3) implies ack through unsent data (last sent seq=SequenceNumber(1), max \
             plausible all-acked-before SequenceNumber(2)) reader=GUID {0110}",
            Line::WARN,
        ),
        (
            "rustdds::rtps::writer",
            "We were asked to send datafrags meant for the reader GUID {0112} to a different reader GUID {0110}. Not gonna \
             happen.",
            Line::ERROR,
        ),
        (
            "rustdds::rtps::writer",
            "Data is meant for the single reader GUID {0112} but a proxy for this reader was not provided. Not sending anything.",
            Line::ERROR,
        ),
        (
            "rustdds::rtps::rtps_reader_proxy",
            "ReaderProxy GUID {0110} asks for {SequenceNumber(9)} but I have only up to SequenceNumber(8). Truncating request. \
             ACKNACK = AckNack",
            Line::WARN,
        ),
        ("rustdds::rtps::reader", "Writer proxy GUID {0110} not found", Line::ERROR),
        ("rustdds::rtps::reader", "There was no command. Spurious command event??", Line::WARN),
        ("rustdds::discovery::discovery", "Did not find a local writer GUID {0110}", Line::WARN),
        ("rustdds::discovery::discovery", "Did not find a local reader GUID {0110}", Line::WARN),
        ("rustdds::discovery::discovery", "not implemented - Topic was disposed: GUID {0110}", Line::WARN),
        ("rustdds::discovery::discovery", "DomainParticipant doesn't exist anymore, exiting Discovery.", Line::ERROR),
        ("rustdds::dds::participant", "DomainParticipant status channel disconnected", Line::ERROR),
        ("rustdds::dds::participant", "dp_event_loop not responding to stop discovery_command", Line::ERROR),
        ("rustdds::dds::statusevents", "StatusReceiver channel disconnected", Line::WARN),
        (
            "rustdds::dds::qos",
            "QosPolicies deserializer: Received OwnershipKind::Shared and a strength value.",
            Line::WARN,
        ),
    ];

    #[test]
    fn ordinary_events_are_debug_lines() {
        for (target, text, logged) in HARMLESS {
            assert_eq!(severity(target, text, logged), Line::DEBUG, "{target}: {text}");
        }
    }

    #[test]
    fn data_of_others_that_is_discarded_is_a_warning_and_no_error() {
        for (target, text) in [
            (
                "rustdds::rtps::message_receiver",
                "Custom { kind: Other, error: \"Invalid DataFrag. serializedData length=9 should be less than or equal to \
                 (fragments_in_submessage=1) x (fragment_size=8)\" }",
            ),
            ("rustdds::rtps::fragment_assembler", "Cannot create AssemblyBuffer: zero fragment count"),
            ("rustdds::serialization::speedy_pl_cdr_helpers", "PL_CDR Deserializing Topic name"),
            ("rustdds::discovery::discovery", "sedp_receive_publication: Serialization { reason: \"..\" }"),
            (
                "rustdds::discovery::discovery_db",
                "Inconsistent topic update from GUID {0110}: type was: \"a\" new type: \"b\"",
            ),
        ] {
            assert_eq!(severity(target, text, Line::ERROR), Line::WARN, "{target}: {text}");
        }
    }

    #[test]
    fn other_lines_keep_their_severity_and_none_is_raised() {
        for (target, text, logged) in [
            ("rustdds::rtps::dp_event_loop", "dp_event_loop poll failed: Os { code: 4 }", Line::ERROR),
            ("rustdds::rtps::dp_event_loop", "Cannot report participant status: Full", Line::ERROR),
            ("rustdds::rtps::writer", "Failed to serialize RTPS message for send: ..", Line::ERROR),
            ("rustdds::rtps::reader", "update_writer_proxy - QoS mismatch Reliability", Line::WARN),
            ("rustdds::rtps::message_receiver", "RTPS deserialize error ..", Line::WARN),
            ("rustdds::rtps::message_receiver", "submessage", Line::DEBUG),
            // The same words of another module are another event.
            ("lineshaft_ros::side::dds", "Writer proxy ", Line::ERROR),
        ] {
            assert_eq!(severity(target, text, logged), logged, "{target}: {text}");
        }
    }
}

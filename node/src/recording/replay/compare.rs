//! Compares the recorded data of a cycle with its replay.

use super::ReplayError;
use super::group::Group;
use crate::recording::{Encoded, Topic};
use lineshaft_core::signal::{Board, Directory, Signal, Type};
use lineshaft_msgs::cdr;
use lineshaft_msgs::foreign::sensor_msgs::msg::JointState;
use lineshaft_msgs::msg::{AxisStates, Event, Signals};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value as Json;

/// First difference between recording and replay.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Cycle number k.
    pub cycle: u64,
    /// Name of a signal, or a topic and a field.
    pub what: String,
    /// Recorded value.
    pub recorded: String,
    /// Replayed value.
    pub replayed: String,
}

/// Numbers of compared values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Counts {
    /// Number of signal values.
    pub values: u64,
    /// Number of messages of the other topics.
    pub messages: u64,
}

/// Compares one cycle after the other.
pub(super) struct Comparison {
    signals: Vec<(Signal, String, Type)>,
    /// Recorded signal values; `None` until a message has had all of them.
    words: Option<Vec<u64>>,
    /// Whether this program made the recording: it then has all topics and begins with all signals.
    is_ours: bool,
    /// Topics of which a recording of another program has messages.
    seen: Vec<Topic>,
    pub counts: Counts,
}

impl Comparison {
    pub(super) fn new(directory: &Directory, is_ours: bool) -> Self {
        let signals = directory.iter().map(|(signal, entry)| (signal, entry.name.clone(), entry.kind)).collect();
        Self { signals, words: None, is_ours, seen: Vec::new(), counts: Counts::default() }
    }

    /// Returns the first difference of a cycle. If `is_whole` is false, messages of the cycle may be missing.
    pub(super) fn compare(
        &mut self,
        group: &Group,
        inputs_crc: u32,
        replayed: &Encoded,
        board: &Board,
        is_whole: bool,
    ) -> Result<Option<Difference>, ReplayError> {
        let cycle = replayed.cycle;
        let difference = |(what, recorded, replayed): Other| Difference { cycle, what, recorded, replayed };
        for data in group.of(Topic::Signals) {
            let message: Signals = decode(group, Topic::Signals, data)?;
            self.apply(&message, replayed.cycle).map_err(|reason| group.bad("Signals", reason))?;
            if let Some(other) = self.first_other_signal(board) {
                return Ok(Some(difference(other)));
            }
            if message.inputs_crc != inputs_crc {
                let crc = |crc: u32| format!("CRC-32 {crc:08x}");
                return Ok(Some(difference(("inputs".to_owned(), crc(message.inputs_crc), crc(inputs_crc)))));
            }
        }
        for topic in [Topic::Signals, Topic::Events, Topic::AxisStates, Topic::JointStates] {
            let recorded: Vec<&[u8]> = group.of(topic).collect();
            let of_replay = replayed.messages().filter(|(of, _)| *of == topic);
            let of_replay: Vec<&[u8]> = of_replay.map(|(_, data)| data).collect();
            if !recorded.is_empty() && !self.seen.contains(&topic) {
                self.seen.push(topic);
            }
            // Otherwise the topic was not recorded, or belongs to the part of a cycle that was cut off.
            let is_expected = is_whole && (self.is_ours || self.seen.contains(&topic));
            if recorded.len() < of_replay.len() && !is_expected {
                continue;
            }
            if let Some(other) = first_other_message(group, topic, &recorded, &of_replay)? {
                return Ok(Some(difference(other)));
            }
            self.counts.messages += recorded.len() as u64;
        }
        Ok(None)
    }

    /// Applies the changes of the recorded signals.
    fn apply(&mut self, message: &Signals, cycle: u64) -> Result<(), String> {
        let (places, words, all) = (message.index.len(), message.word.len(), self.signals.len());
        if message.cycle != cycle {
            return Err(format!("it is of cycle {} and stands among the messages of cycle {cycle}", message.cycle));
        }
        if places != words {
            return Err(format!("index has {places} elements, word {words}; as many are needed"));
        }
        if let Some(place) = message.index.iter().find(|&&place| place as usize >= all) {
            return Err(format!("index holds {place}; the cell has signals 0 to {}", all.saturating_sub(1)));
        }
        if self.is_ours && self.words.is_none() && places != all {
            return Err(format!("it is the first one and holds {places} of {all} signals; all of them are needed"));
        }
        if places == all {
            self.words = Some(vec![0; all]);
        }
        if let Some(known) = &mut self.words {
            std::iter::zip(&message.index, &message.word).for_each(|(&place, &word)| known[place as usize] = word);
        }
        Ok(())
    }

    /// Returns name, recorded and replayed value of the first signal that differs.
    fn first_other_signal(&mut self, board: &Board) -> Option<Other> {
        let words = self.words.as_ref()?;
        self.counts.values += words.len() as u64;
        let mut signals = std::iter::zip(&self.signals, words);
        let ((signal, name, kind), &recorded) = signals.find(|((signal, ..), word)| board.word(*signal) != **word)?;
        Some((name.clone(), value_text(*kind, recorded), value_text(*kind, board.word(*signal))))
    }
}

/// Name of a difference, recorded value and replayed value.
type Other = (String, String, String);

/// Formats a signal value.
fn value_text(kind: Type, word: u64) -> String {
    match kind {
        Type::Real => format!("{:?}", f64::from_bits(word)),
        Type::Word => format!("{word:#x}"),
        Type::Enum(names) => match usize::try_from(word).ok().and_then(|place| names.get(place)) {
            Some(name) => format!("{word} {name}"),
            None => word.to_string(),
        },
        Type::Int | Type::Bit => word.cast_signed().to_string(),
    }
}

fn decode<T: DeserializeOwned>(group: &Group, topic: Topic, data: &[u8]) -> Result<T, ReplayError> {
    cdr::decode_with_header(data).map_err(|error| group.bad(topic.schema().0, error.to_string()))
}

fn first_other_message(
    group: &Group,
    topic: Topic,
    recorded: &[&[u8]],
    replayed: &[&[u8]],
) -> Result<Option<Other>, ReplayError> {
    // Signals were compared one by one; only their presence is compared here.
    let is_other = |place: usize| {
        let (mine, other) = (recorded.get(place), replayed.get(place));
        topic != Topic::Signals
            && mine != other
            && !(topic == Topic::Events && is_reworded(mine.copied(), other.copied()))
    };
    let most = recorded.len().max(replayed.len());
    let Some(place) = (0..most).find(|&place| recorded.len() != replayed.len() || is_other(place)) else {
        return Ok(None);
    };
    let place = (0..most).find(|&place| is_other(place)).unwrap_or(place.max(recorded.len().min(replayed.len())));
    let name = topic.schema().0;
    let (Some(mine), Some(other)) = (recorded.get(place), replayed.get(place)) else {
        let text = |messages: &[&[u8]]| match messages.len() {
            1 => "1 message".to_owned(),
            count => format!("{count} messages"),
        };
        return Ok(Some((name.to_owned(), text(recorded), text(replayed))));
    };
    let both = match topic {
        Topic::Events => (json::<Event>(group, topic, mine)?, json::<Event>(group, topic, other)?),
        Topic::AxisStates => (json::<AxisStates>(group, topic, mine)?, json::<AxisStates>(group, topic, other)?),
        _ => (json::<JointState>(group, topic, mine)?, json::<JointState>(group, topic, other)?),
    };
    let (path, mine, other) = first_other_field(&both.0, &both.1).unwrap_or_default();
    Ok(Some((format!("{name}{path}"), mine, other)))
}

/// Whether two events differ only in their text, which may differ between versions.
fn is_reworded(mine: Option<&[u8]>, other: Option<&[u8]>) -> bool {
    let without_text = |data: &[u8]| -> Option<Vec<u8>> {
        let event: Event = cdr::decode_with_header(data).ok()?;
        Some(cdr::encode_with_header(&Event { text: String::new(), ..event }))
    };
    let mine = mine.and_then(without_text);
    mine.is_some() && mine == other.and_then(without_text)
}

/// Returns a message as a tree of fields.
fn json<T: Serialize + DeserializeOwned>(group: &Group, topic: Topic, data: &[u8]) -> Result<Json, ReplayError> {
    let message: T = decode(group, topic, data)?;
    serde_json::to_value(message).map_err(|error| group.bad(topic.schema().0, error.to_string()))
}

/// Returns path and both values of the first field that differs.
fn first_other_field(mine: &Json, other: &Json) -> Option<Other> {
    let under = |step: String, (path, a, b): Other| (format!("{step}{path}"), a, b);
    match (mine, other) {
        (Json::Object(mine), Json::Object(other)) => mine.iter().find_map(|(key, value)| {
            let found = first_other_field(value, other.get(key).unwrap_or(&Json::Null))?;
            Some(under(format!(".{key}"), found))
        }),
        (Json::Array(mine), Json::Array(other)) if mine.len() == other.len() => std::iter::zip(mine, other)
            .enumerate()
            .find_map(|(place, (mine, other))| Some(under(format!("[{place}]"), first_other_field(mine, other)?))),
        (mine, other) if mine == other => None,
        (mine, other) => Some((String::new(), mine.to_string(), other.to_string())),
    }
}

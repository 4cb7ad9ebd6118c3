//! Type hashes of ROS 2 (RIHS01; REP 2016, which was a part of REP 2011).
//!
//! Law      hash = `RIHS01_` and the SHA-256, in hex digits, of the JSON text of a type description: the fields of the
//!          type, and the descriptions of all types that it refers to, ordered by name. Constants and comments are not
//!          included
//! Reads    the interface files; a service and an action are described as structs of their parts
//! Refuses  a type that refers to a type without a file

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use sha2::{Digest, Sha256};

use crate::interface::{DUMMY_FIELD, Element, Field, Interface, Kind, Section, Shape};

/// Constants of type_description_interfaces/msg/FieldType.
const NESTED_TYPE: u8 = 1;
const BOOL: u8 = 15;
const INT8: u8 = 2;
const UINT8: u8 = 3;
const STRING: u8 = 17;
const BOUNDED_STRING: u8 = 21;
/// Added to the constant of the element.
const ARRAY: u8 = 48;
const BOUNDED_SEQUENCE: u8 = 96;
const UNBOUNDED_SEQUENCE: u8 = 144;

/// Hashes of all types by their name in ROS 2, including those of the parts and events of services and actions.
pub(crate) type Hashes = BTreeMap<String, String>;

/// Returns the hashes of all types of these interfaces.
pub(crate) fn hashes(interfaces: &[Interface]) -> Result<Hashes, String> {
    let mut types = Types::default();
    for interface in interfaces {
        types.add_interface(interface);
    }
    types.0.keys().map(|name| Ok((name.clone(), types.hash(name)?))).collect()
}

/// Type of a field in a type description.
struct FieldType {
    id: u8,
    /// Length of an array, or maximum length of a bounded sequence.
    capacity: usize,
    /// Maximum length of a bounded string.
    string_capacity: usize,
    /// Name of the message; empty for other types.
    nested: String,
}

impl FieldType {
    fn plain(id: u8) -> Self {
        Self { id, capacity: 0, string_capacity: 0, nested: String::new() }
    }

    fn nested(name: impl Into<String>) -> Self {
        Self { nested: name.into(), ..Self::plain(NESTED_TYPE) }
    }

    fn of(field: &Field) -> Self {
        let element = match &field.element {
            Element::Primitive(primitive) => Self::plain(primitive.description_id),
            Element::Text(None) => Self::plain(STRING),
            Element::Text(Some(bound)) => Self { string_capacity: *bound, ..Self::plain(BOUNDED_STRING) },
            Element::Message { package, name } => Self::nested(format!("{package}/msg/{name}")),
        };
        let (shape, capacity) = match field.shape {
            Shape::One => (0, 0),
            Shape::Array(length) => (ARRAY, length),
            Shape::Bounded(bound) => (BOUNDED_SEQUENCE, bound),
            Shape::Sequence => (UNBOUNDED_SEQUENCE, 0),
        };
        Self { id: element.id + shape, capacity, ..element }
    }
}

/// Names and types of the fields of a struct.
type Fields = Vec<(String, FieldType)>;

fn fields(section: &Section) -> Fields {
    if section.fields.is_empty() {
        return vec![(DUMMY_FIELD.to_owned(), FieldType::plain(UINT8))];
    }
    section.fields.iter().map(|field| (field.name.clone(), FieldType::of(field))).collect()
}

fn field(name: &str, kind: FieldType) -> (String, FieldType) {
    (name.to_owned(), kind)
}

/// Descriptions of all types by name, each without those of the types that it refers to.
#[derive(Default)]
struct Types(BTreeMap<String, Fields>);

impl Types {
    fn add_interface(&mut self, interface: &Interface) {
        let Interface { package, kind, name, sections } = interface;
        let name = format!("{package}/{}/{name}", kind.name());
        match (kind, sections.as_slice()) {
            (Kind::Msg, [whole]) => self.add(&name, fields(whole)),
            (Kind::Srv, [request, response]) => self.add_service(&name, fields(request), fields(response)),
            (Kind::Action, [goal, result, feedback]) => {
                self.add_action(&name, fields(goal), fields(result), fields(feedback));
            }
            // The parser checks the number of sections.
            _ => {}
        }
    }

    fn add(&mut self, name: &str, fields: Fields) {
        self.0.insert(name.to_owned(), fields);
    }

    fn add_service(&mut self, name: &str, request: Fields, response: Fields) {
        let [of_request, of_response, of_event] = ["Request", "Response", "Event"].map(|part| format!("{name}_{part}"));
        let at_most_one =
            |part: &str| FieldType { id: NESTED_TYPE + BOUNDED_SEQUENCE, capacity: 1, ..FieldType::nested(part) };
        let event = vec![
            field("info", FieldType::nested("service_msgs/msg/ServiceEventInfo")),
            field("request", at_most_one(&of_request)),
            field("response", at_most_one(&of_response)),
        ];
        self.add(&of_request, request);
        self.add(&of_response, response);
        self.add(&of_event, event);
        let whole = vec![
            field("request_message", FieldType::nested(of_request)),
            field("response_message", FieldType::nested(of_response)),
            field("event_message", FieldType::nested(of_event)),
        ];
        self.add(name, whole);
    }

    fn add_action(&mut self, name: &str, goal: Fields, result: Fields, feedback: Fields) {
        let part = |field_name: &str, part: &str| field(field_name, FieldType::nested(format!("{name}_{part}")));
        let goal_id = || field("goal_id", FieldType::nested("unique_identifier_msgs/msg/UUID"));
        self.add(&format!("{name}_Goal"), goal);
        self.add(&format!("{name}_Result"), result);
        self.add(&format!("{name}_Feedback"), feedback);
        let accepted = vec![
            field("accepted", FieldType::plain(BOOL)),
            field("stamp", FieldType::nested("builtin_interfaces/msg/Time")),
        ];
        self.add_service(&format!("{name}_SendGoal"), vec![goal_id(), part("goal", "Goal")], accepted);
        let ended = vec![field("status", FieldType::plain(INT8)), part("result", "Result")];
        self.add_service(&format!("{name}_GetResult"), vec![goal_id()], ended);
        self.add(&format!("{name}_FeedbackMessage"), vec![goal_id(), part("feedback", "Feedback")]);
        let whole = vec![
            part("goal", "Goal"),
            part("result", "Result"),
            part("feedback", "Feedback"),
            part("send_goal_service", "SendGoal"),
            part("get_result_service", "GetResult"),
            part("feedback_message", "FeedbackMessage"),
        ];
        self.add(name, whole);
    }

    fn fields(&self, name: &str) -> Result<&Fields, String> {
        self.0.get(name).ok_or_else(|| format!("the type hashes need {name}, which has no file"))
    }

    fn hash(&self, name: &str) -> Result<String, String> {
        let mut referenced = BTreeSet::new();
        let mut open = vec![name];
        while let Some(next) = open.pop() {
            for (_, kind) in self.fields(next)? {
                if !kind.nested.is_empty() && referenced.insert(kind.nested.as_str()) {
                    open.push(&kind.nested);
                }
            }
        }
        let referenced: Result<Vec<String>, String> = referenced.into_iter().map(|name| self.json(name)).collect();
        let json = format!(
            "{{\"type_description\": {}, \"referenced_type_descriptions\": [{}]}}",
            self.json(name)?,
            referenced?.join(", ")
        );
        Ok(Sha256::digest(json.as_bytes()).iter().fold("RIHS01_".to_owned(), |mut hash, byte| {
            let _ = write!(hash, "{byte:02x}");
            hash
        }))
    }

    /// Returns the description of one type. The hash covers every byte of it, including blanks.
    fn json(&self, name: &str) -> Result<String, String> {
        let fields: Vec<String> = (self.fields(name)?.iter())
            .map(|(field, FieldType { id, capacity, string_capacity, nested })| {
                format!(
                    "{{\"name\": \"{field}\", \"type\": {{\"type_id\": {id}, \"capacity\": {capacity}, \
                     \"string_capacity\": {string_capacity}, \"nested_type_name\": \"{nested}\"}}}}"
                )
            })
            .collect();
        Ok(format!("{{\"type_name\": \"{name}\", \"fields\": [{}]}}", fields.join(", ")))
    }
}

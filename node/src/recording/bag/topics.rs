//! Topics of a bag: names, message types and QoS.

use super::super::{FrameDirection, Topic};
use super::Subject;
use lineshaft_msgs::Message;
use lineshaft_msgs::foreign::can_msgs::msg::Frame;
use lineshaft_msgs::foreign::sensor_msgs::msg::JointState;
use lineshaft_msgs::msg::{AppliedCommand, AxisStates, CycleInputs, Event, Signals};
use lineshaft_ros::layer::{FullName, NameError, NodeName, Qos, TappedTopic};

/// A topic of a bag.
#[derive(Debug)]
pub(super) struct Offered {
    pub name: FullName,
    /// Message type, and its definition for the schema encoding `ros2msg`.
    pub schema: (&'static str, &'static str),
    pub qos: Qos,
}

impl Offered {
    /// Returns all topics of a bag: those of [`Topic::ALL`], two for each bus, and those that the node publishes.
    pub(super) fn all(subject: &Subject) -> Result<Vec<Self>, NameError> {
        let of = |topic: Topic| Ok(Self { name: topic.name(&subject.node)?, schema: topic.schema(), qos: topic.qos() });
        let frames = |(bus, way): (&String, FrameDirection)| {
            let name = subject.node.expand(&format!("~/can/{bus}/{}", way.name()))?;
            Ok(Self { name, schema: schema::<Frame>(), qos: Qos::STREAM })
        };
        let buses = subject.buses.iter().flat_map(|bus| FrameDirection::ALL.map(|way| (bus, way)));
        let published =
            |topic: &TappedTopic| Ok(Self { name: topic.name.clone(), schema: topic.schema, qos: topic.qos });
        let published = subject.published.iter().map(published);
        Topic::ALL.into_iter().map(of).chain(buses.map(frames)).chain(published).collect()
    }
}

fn schema<M: Message>() -> (&'static str, &'static str) {
    (M::NAME, M::SCHEMA)
}

/// Whether a topic is `~/errors` of a node, which repeats events of `~/events`.
pub(crate) fn repeats_events(topic: &str) -> bool {
    topic.ends_with("/errors")
}

impl Topic {
    /// All topics, in the order of the enum.
    pub const ALL: [Topic; 6] =
        [Topic::Commands, Topic::Inputs, Topic::Events, Topic::Signals, Topic::AxisStates, Topic::JointStates];

    /// Returns the topic of a message type.
    pub fn of_type(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|topic| topic.schema().0 == name)
    }

    /// Returns the topic of a message by its type and topic name. `~/errors` has the type of events and repeats them.
    pub fn of_message(topic: &str, type_name: &str) -> Option<Self> {
        Self::of_type(type_name).filter(|found| *found != Topic::Events || !repeats_events(topic))
    }

    /// Whether the topic that the node calls `name` is one of those written in each cycle.
    pub fn is_of_cycles(name: &str) -> bool {
        Self::ALL.iter().any(|topic| topic.relative_name() == name)
    }

    /// Returns the name relative to the node.
    fn relative_name(self) -> &'static str {
        match self {
            Topic::Commands => "~/commands",
            Topic::Inputs => "~/inputs",
            Topic::Events => "~/events",
            Topic::Signals => "~/signals",
            Topic::AxisStates => "~/axis_states",
            Topic::JointStates => "joint_states",
        }
    }

    /// Returns the full name for a node.
    ///
    /// # Errors
    /// Returns an error if the name is longer than ROS allows.
    pub fn name(self, node: &NodeName) -> Result<FullName, NameError> {
        node.expand(self.relative_name())
    }

    /// Returns the message type, such as `lineshaft_msgs/msg/Event`, and its definition for the schema encoding
    /// `ros2msg`.
    pub fn schema(self) -> (&'static str, &'static str) {
        match self {
            Topic::Commands => schema::<AppliedCommand>(),
            Topic::Inputs => schema::<CycleInputs>(),
            Topic::Events => schema::<Event>(),
            Topic::Signals => schema::<Signals>(),
            Topic::AxisStates => schema::<AxisStates>(),
            Topic::JointStates => schema::<JointState>(),
        }
    }

    /// Returns the QoS of the topic.
    pub fn qos(self) -> Qos {
        match self {
            Topic::Commands | Topic::Events => Qos::EVENTS,
            _ => Qos::STREAM,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_a_node_are_no_events_of_a_cycle() {
        let event = "lineshaft_msgs/msg/Event";
        assert_eq!(Topic::of_message("/cell/press/events", event), Some(Topic::Events));
        assert_eq!(Topic::of_message("/cell/press/errors", event), None);
        assert_eq!(Topic::of_message("/errors/signals", "lineshaft_msgs/msg/Signals"), Some(Topic::Signals));
        assert!(Topic::is_of_cycles("joint_states") && Topic::is_of_cycles("~/events"));
        assert!(!Topic::is_of_cycles("~/errors") && !Topic::is_of_cycles("/rosout"));
    }

    #[test]
    fn topics_of_cycles_are_those_that_a_cell_cannot_choose() {
        assert_eq!(Topic::ALL.map(Topic::relative_name), crate::cell::RecordTopics::ALWAYS);
    }

    #[test]
    fn topics_stand_in_their_order_and_below_their_node() {
        assert!(Topic::ALL.iter().enumerate().all(|(place, topic)| *topic as usize == place));
        let node = NodeName::new("/cell", "press").unwrap();
        let names: Vec<_> = Topic::ALL.iter().map(|topic| topic.name(&node).unwrap().to_string()).collect();
        assert_eq!(
            names,
            [
                "/cell/press/commands",
                "/cell/press/inputs",
                "/cell/press/events",
                "/cell/press/signals",
                "/cell/press/axis_states",
                "/cell/joint_states"
            ]
        );
    }
}

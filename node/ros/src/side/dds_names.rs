//! DDS topics and types of ROS endpoints (ROS 2 design, "Topic and Service name mapping to DDS").

use lineshaft_msgs::Message;
use lineshaft_msgs::foreign::rmw_dds_common::msg::ParticipantEntitiesInfo;

use crate::link::protocol::{EndpointKind, Spec};

/// A topic in DDS.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct DdsTopic {
    pub(super) name: String,
    pub(super) type_name: String,
    /// Type hash (RIHS01).
    pub(super) hash: String,
}

/// Returns the topics that an endpoint reads and writes.
pub(super) fn topics(Spec { kind, name, wire, .. }: &Spec) -> (Option<DdsTopic>, Option<DdsTopic>) {
    let dds = |name, part, hash: &String| DdsTopic { name, type_name: type_name(&wire.name, part), hash: hash.clone() };
    let topic = || dds(format!("rt{name}"), "", &wire.hash);
    let requests = || dds(format!("rq{name}Request"), "_Request", &wire.hash);
    let replies = || dds(format!("rr{name}Reply"), "_Response", &wire.response_hash);
    match kind {
        EndpointKind::Publisher => (None, Some(topic())),
        EndpointKind::Subscription => (Some(topic()), None),
        EndpointKind::Server => (Some(requests()), Some(replies())),
        EndpointKind::Client => (Some(replies()), Some(requests())),
        EndpointKind::Nodes => (Some(nodes()), None),
    }
}

/// Returns the topic on which each participant publishes its nodes, the only one of ROS without a prefix.
pub(super) fn nodes() -> DdsTopic {
    let (name, hash) = ("ros_discovery_info".to_owned(), ParticipantEntitiesInfo::HASH.to_owned());
    DdsTopic { name, type_name: type_name(ParticipantEntitiesInfo::NAME, ""), hash }
}

/// Returns the DDS type of a part of an interface, `package/kind/Name`.
fn type_name(interface: &str, part: &str) -> String {
    let (module, name) = interface.rsplit_once('/').unwrap_or(("", interface));
    format!("{}::dds_::{name}{part}_", module.replace('/', "::"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::protocol::WireType;
    use crate::link::qos::Qos;

    /// Returns name, type and hash of the topics that an endpoint reads and writes.
    fn of(kind: EndpointKind, name: &str, type_name: &str) -> [Option<[String; 3]>; 2] {
        let wire = WireType { name: type_name.to_owned(), hash: "1".to_owned(), response_hash: "2".to_owned() };
        let (read, written) = topics(&Spec { kind, name: name.to_owned(), wire, qos: Qos::STREAM, credit: 0 });
        [read, written].map(|topic| topic.map(|topic| [topic.name, topic.type_name, topic.hash]))
    }

    #[test]
    fn endpoints_have_the_topics_and_types_of_rmw() {
        let topic = |words: [&str; 3]| Some(words.map(str::to_owned));
        let joints = topic(["rt/cell/joint_states", "sensor_msgs::msg::dds_::JointState_", "1"]);
        let (name, joint_state) = ("/cell/joint_states", "sensor_msgs/msg/JointState");
        assert_eq!(of(EndpointKind::Publisher, name, joint_state), [None, joints.clone()]);
        assert_eq!(of(EndpointKind::Subscription, name, joint_state), [joints, None]);

        let move_to = "a_msgs::action::dds_::MoveTo_SendGoal";
        let requests = topic(["rq/n/b/_action/send_goalRequest", &format!("{move_to}_Request_"), "1"]);
        let replies = topic(["rr/n/b/_action/send_goalReply", &format!("{move_to}_Response_"), "2"]);
        let (name, send_goal) = ("/n/b/_action/send_goal", "a_msgs/action/MoveTo_SendGoal");
        assert_eq!(of(EndpointKind::Server, name, send_goal), [requests.clone(), replies.clone()]);
        assert_eq!(of(EndpointKind::Client, name, send_goal), [replies, requests]);

        let [nodes, written] =
            of(EndpointKind::Nodes, "", "").map(|topic| topic.map(|[name, type_name, _]| [name, type_name]));
        let info = ["ros_discovery_info", "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"].map(str::to_owned);
        assert_eq!((nodes, written), (Some(info), None));
    }
}

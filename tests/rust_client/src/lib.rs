//! Client of Lineshaft in Rust, based on crate `ros2-client`: it enables an axis, moves it with feedback, and reads the
//! position of its joint.
//!
//! docs/rust_client.md explains it; `cargo run -p rust_client -- /lineshaft x 0.05` runs it.

use futures::{StreamExt, pin_mut};
use lineshaft_msgs::action::{MoveAxisFeedback, MoveAxisGoal, MoveAxisResult};
use lineshaft_msgs::foreign::sensor_msgs::msg::JointState;
use lineshaft_msgs::srv::{AxesCommandRequest, AxesCommandResponse};
use ros2_client::action::{ActionClientQosPolicies, GoalStatusEnum};
use ros2_client::qos::{Durability, History, WhenFull};
use ros2_client::{
    ActionClient, ActionTypeName, Client, Context, Message, MessageTypeName, Name, Node, NodeName, NodeOptions,
    QosProfile, ServiceMapping, ServiceTypeName, Subscription,
};
use serde::{Deserialize, Serialize};
use std::fmt::Debug;
use std::net::{IpAddr, Ipv4Addr};
use std::time::Duration;

/// Timeout of discovery and of each answer.
const PATIENCE: Duration = Duration::from_secs(10);
/// Timeout of the motion.
const MOTION: Duration = Duration::from_secs(60);

/// Adapts a type of `lineshaft_msgs` to the trait `Message` of `ros2-client`: trait and type belong to other crates, so
/// this crate needs a wrapper type. The wrapper does not change the serialized form.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Ros<T>(pub T);

impl<T: Serialize + serde::de::DeserializeOwned> Message for Ros<T> {}

/// Observations of a motion.
#[derive(Clone, Debug)]
pub struct Moved {
    /// Feedback messages, in their order.
    pub feedback: Vec<MoveAxisFeedback>,
    /// Final status of the goal.
    pub status: GoalStatusEnum,
    /// Result that the machine reports.
    pub result: MoveAxisResult,
    /// Actual position of the joint after the motion (m or rad).
    pub joint: f64,
}

/// A node with the clients and subscriptions for one Lineshaft node.
pub struct Lineshaft {
    node: Node,
    enable: Client<Ros<AxesCommandRequest>, Ros<AxesCommandResponse>>,
    moves: ActionClient<Ros<MoveAxisGoal>, Ros<MoveAxisResult>, Ros<MoveAxisFeedback>>,
    joints: Subscription<Ros<JointState>>,
}

/// Returns the QoS of services and actions in ROS 2, and of `joint_states`.
fn reliable(depth: usize) -> QosProfile {
    QosProfile::subscription_default().reliability_reliable(WhenFull::Fail).history(History::KeepLast { depth })
}

fn text(error: impl Debug) -> String {
    format!("{error:?}")
}

impl Lineshaft {
    /// Opens a node with the name `rust_client` in a DDS domain, for the node `lineshaft` (`/lineshaft`,
    /// `/press/lineshaft`);
    /// `loopback`: this host only, like ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST, which ros2-client does not read.
    ///
    /// # Errors
    /// An invalid name, or no network.
    pub fn open(domain: u16, loopback: bool, lineshaft: &str) -> Result<Self, String> {
        let mut participant = rustdds::DomainParticipantBuilder::new(domain);
        if loopback {
            participant = participant.with_only_networks([IpAddr::V4(Ipv4Addr::LOCALHOST)]);
        }
        let context = Context::from_domain_participant(participant.build().map_err(text)?).map_err(text)?;
        let name = NodeName::new("/", "rust_client").map_err(text)?;
        let mut node = context.new_node(name, NodeOptions::new()).map_err(text)?;
        // It processes discovery data, which waiting for a service requires.
        tokio::spawn(node.spinner().map_err(text)?.spin());

        // A server of Lineshaft answers in the mapping of the client.
        let mapping = ServiceMapping::Enhanced;
        let enable = node
            .create_client(
                mapping,
                &Name::new(lineshaft, "enable").map_err(text)?,
                &ServiceTypeName::new("lineshaft_msgs", "AxesCommand"),
                reliable(10),
                reliable(10),
            )
            .map_err(text)?;
        let qos = ActionClientQosPolicies {
            goal_service: reliable(10),
            result_service: reliable(10),
            cancel_service: reliable(10),
            feedback_subscription: reliable(10),
            status_subscription: reliable(1).durability(Durability::TransientLocal),
        };
        let moves = node
            .create_action_client(
                mapping,
                &Name::new(lineshaft, "move_axis").map_err(text)?,
                &ActionTypeName::new("lineshaft_msgs", "MoveAxis"),
                qos,
            )
            .map_err(text)?;
        // The topic joint_states belongs to the namespace, not to the node.
        let namespace = lineshaft.rsplit_once('/').map_or("/", |(namespace, _)| namespace);
        let namespace = if namespace.is_empty() { "/" } else { namespace };
        let name = Name::new(namespace, "joint_states").map_err(text)?;
        let topic = node.create_topic(&name, MessageTypeName::new("sensor_msgs", "JointState"), &reliable(10));
        let joints = node.create_subscription(&topic.map_err(text)?, None).map_err(text)?;
        Ok(Self { node, enable, moves, joints })
    }

    /// Waits until the node is discovered.
    ///
    /// # Errors
    /// It is not discovered within the timeout.
    pub async fn wait(&self) -> Result<(), String> {
        let there = async {
            self.enable.wait_for_service(&self.node).await;
            self.moves.goal_client().wait_for_service(&self.node).await;
            self.moves.result_client().wait_for_service(&self.node).await;
            self.joints.wait_for_publisher(&self.node).await;
            Ok(())
        };
        in_time(PATIENCE, "the node is not there", there).await
    }

    /// Switches axes on.
    ///
    /// # Errors
    /// The message of the machine.
    pub async fn enable(&self, axes: &[&str]) -> Result<(), String> {
        let axes = axes.iter().map(|axis| (*axis).to_owned()).collect();
        let call = async { self.enable.async_call_service(Ros(AxesCommandRequest { axes })).await.map_err(text) };
        let Ros(answer) = in_time(PATIENCE, "enable is not answered", call).await?;
        if answer.success { Ok(()) } else { Err(answer.message) }
    }

    /// Moves an axis to a position (m or rad) and returns the observations.
    ///
    /// # Errors
    /// The goal was rejected, or there was no answer.
    pub async fn move_to(&self, axis: &str, position: f64) -> Result<Moved, String> {
        // All other fields are 0: absolute, in SI units, with the defaults of the axis.
        let goal = MoveAxisGoal { axis: axis.to_owned(), position, ..MoveAxisGoal::default() };
        let send = async { self.moves.async_send_goal(Ros(goal)).await.map_err(text) };
        let (id, answer) = in_time(PATIENCE, "the goal is not answered", send).await?;
        if !answer.accepted {
            return Err("the goal was rejected; /rosout says why".to_owned());
        }
        let (mut feedback, messages) = (Vec::new(), self.moves.feedback_stream(id));
        pin_mut!(messages);
        let result = async { self.moves.async_request_result(id).await.map_err(text) };
        let ended = in_time(MOTION, "the goal does not end", result);
        pin_mut!(ended);
        let (status, Ros(result)) = loop {
            tokio::select! {
                ended = &mut ended => break ended?,
                Some(message) = messages.next() => feedback.push(message.map_err(text)?.0),
            }
        };
        Ok(Moved { feedback, status, result, joint: self.joint(axis).await? })
    }

    /// Returns the present position of a joint (m or rad) from the next message; messages that were received before are
    /// discarded.
    ///
    /// # Errors
    /// No message is received, or it does not contain the joint.
    pub async fn joint(&self, name: &str) -> Result<f64, String> {
        while self.joints.take().map_err(text)?.is_some() {}
        let take = async { self.joints.async_take().await.map_err(text) };
        let (Ros(state), _) = in_time(PATIENCE, "joint_states has stopped", take).await?;
        let place = state.name.iter().position(|joint| joint == name);
        let position = place.and_then(|place| state.position.get(place).copied());
        position.ok_or_else(|| format!("joint_states has no {name}"))
    }
}

async fn in_time<T>(
    patience: Duration,
    complaint: &str,
    what: impl Future<Output = Result<T, String>>,
) -> Result<T, String> {
    tokio::time::timeout(patience, what).await.unwrap_or_else(|_| Err(format!("{complaint} within {patience:?}")))
}

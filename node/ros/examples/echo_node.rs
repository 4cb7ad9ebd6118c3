//! A minimal node with a service and an action: `/echo/home` answers at once, `/echo/move_to` runs for the duration of its goal.
//!
//!     ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST cargo run -p lineshaft-ros --example echo_node
//!     ros2 service call /echo/home std_srvs/srv/Trigger

use std::error::Error;
use std::time::Duration;

use lineshaft_msgs::foreign::sensor_msgs::msg::JointState;
use lineshaft_msgs::foreign::std_msgs::msg::Header;
use lineshaft_msgs::foreign::std_srvs::srv::{Trigger, TriggerResponse};
use lineshaft_msgs::{Action, Message};
use lineshaft_ros::layer::{
    ActionEvent, ActionOptions, ActionServer, Environment, GoalHandle, Node, NodeOptions, PublishError, Publisher, Qos,
    RosArguments, ServiceServer, Severity, Source, log_filter, now,
};
use serde::{Deserialize, Serialize};
use tokio::time::interval;

#[tokio::main(flavor = "multi_thread", worker_threads = 2)]
async fn main() -> Result<(), Box<dyn Error>> {
    tracing_subscriber::fmt().with_env_filter(log_filter("info")).with_writer(std::io::stderr).init();
    let (arguments, rest) = RosArguments::take(std::env::args().skip(1))?;
    if let Some(unknown) = rest.first() {
        return Err(format!("{unknown:?} is not understood, only --ros-args is").into());
    }
    let name = arguments.node_name("echo", "/")?;
    let (names, overrides) = (arguments.names(&name)?, arguments.overrides(&name));
    let options = NodeOptions { names, overrides, rosout: arguments.rosout_logs, ..NodeOptions::plain(name) };
    let node = Node::with(options, &Environment::read()?)?;

    let rosout = node.rosout()?;
    tokio::spawn(publish(node.publisher("joint_states", Qos::STREAM)?));
    tokio::spawn(home(node.service::<Trigger>("~/home", Qos::SERVICE)?));
    tokio::spawn(move_to(node.action("~/move_to", ActionOptions::default())?));
    rosout.log(Severity::Info, format!("{} is there", node.name()), Source::default());
    tokio::signal::ctrl_c().await?;
    Ok(())
}

async fn publish(joint_states: Publisher<JointState>) {
    let mut tick = interval(Duration::from_millis(10));
    for cycle in 0u32.. {
        tick.tick().await;
        let position = (f64::from(cycle) * 0.01).sin();
        let header = Header { stamp: now(), frame_id: String::new() };
        let message =
            JointState { header, name: vec!["x".to_owned()], position: vec![position], ..JointState::default() };
        match joint_states.publish(&message) {
            Ok(()) => {}
            Err(PublishError::Closed { .. }) => return,
            Err(error) => tracing::warn!("{error}"),
        }
    }
}

async fn home(mut server: ServiceServer<Trigger>) {
    let mut calls = 0;
    while let Some(request) = server.next().await {
        calls += 1;
        let response = TriggerResponse { success: true, message: format!("call {calls}") };
        // Each answer is sent by a separate task, so that a client that is discovered late does not delay others.
        tokio::spawn(async move {
            if let Err(error) = request.reply.send(response).await {
                tracing::debug!("{error}");
            }
        });
    }
}

async fn move_to(mut server: ActionServer<MoveTo>) {
    while let Some(event) = server.next().await {
        match event {
            ActionEvent::Goal(request) if request.goal().positions.is_empty() => request.reject(),
            ActionEvent::Goal(request) => drop(tokio::spawn(pursue(request.accept()))),
            ActionEvent::Cancel(request) => request.accept(),
        }
    }
}

/// Simulates a motion for the duration of the goal.
async fn pursue(goal: GoalHandle<MoveTo>) {
    goal.execute();
    let MoveToGoal { positions, duration } = goal.goal().clone();
    let steps = (duration / 0.02).max(1.0);
    let mut tick = interval(Duration::from_millis(20));
    let mut step = 0.0;
    while step < steps {
        tokio::select! {
            _ = tick.tick() => {
                step += 1.0;
                let feedback = MoveToFeedback { progress: step / steps, positions: positions.clone() };
                if let Err(error) = goal.feedback(&feedback) {
                    tracing::warn!("{error}");
                }
            }
            () = goal.cancel_requested() => {
                return goal.canceled(MoveToResult { error_code: -1, error_string: "canceled".to_owned() });
            }
        }
    }
    goal.succeed(MoveToResult::default());
}

/// An action that is not in `lineshaft_msgs`: hand-written equivalent of the generated code.
enum MoveTo {}

impl Action for MoveTo {
    type Goal = MoveToGoal;
    type Result = MoveToResult;
    type Feedback = MoveToFeedback;
    const NAME: &'static str = "spike_msgs/action/MoveTo";
    const HASH: &'static str = "RIHS01_80da44f073c58534414c684b6d886b39299628afaf5c5fd6268e0a67e4ed5b67";
    const SEND_GOAL_NAME: &'static str = "spike_msgs/action/MoveTo_SendGoal";
    const SEND_GOAL_HASH: &'static str = "RIHS01_093af0d2433829262fa570c85a55143fd00fd385732962da8f0d538a6b8fc2c3";
    const SEND_GOAL_REQUEST_HASH: &'static str =
        "RIHS01_6318b4f9c17aea3f3eaa6976ac7fb4d2eb014fe695dd95877858ee9a25f56c26";
    const SEND_GOAL_RESPONSE_HASH: &'static str =
        "RIHS01_45e4a034568e4f152943f10d05600b6f254658cffc055095ee49d4bedc1d9c11";
    const GET_RESULT_NAME: &'static str = "spike_msgs/action/MoveTo_GetResult";
    const GET_RESULT_HASH: &'static str = "RIHS01_61a1ddedb90c0d9fdcc491360f213ef007a32d18316f7308101f55d6aa273104";
    const GET_RESULT_REQUEST_HASH: &'static str =
        "RIHS01_8e88ee5864eff847a4acf9abca11327190ae400effcf5c5bb95dfc4c1d61538f";
    const GET_RESULT_RESPONSE_HASH: &'static str =
        "RIHS01_0cf0b0ccbe8f2b6bc187041ea62abb0393a80acfb444ff3fc940627d44861e77";
    const FEEDBACK_MESSAGE_HASH: &'static str =
        "RIHS01_9e28d8cd4a159fe8d7224390804343e7243a84fcc3e162dcfc2d2439ccd53ce8";
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct MoveToGoal {
    positions: Vec<f64>,
    /// Duration, in s.
    duration: f64,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct MoveToResult {
    error_code: i32,
    error_string: String,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct MoveToFeedback {
    /// Progress, 0 to 1.
    progress: f64,
    positions: Vec<f64>,
}

impl Message for MoveToGoal {
    const NAME: &'static str = "spike_msgs/action/MoveTo_Goal";
    const HASH: &'static str = "RIHS01_083af3c3ba4c05ddcc02f66875ce44eef94a52bb87de0d0f55acdcfab6455b2f";
    const SCHEMA: &'static str = "float64[] positions\nfloat64 duration\n";
}

impl Message for MoveToResult {
    const NAME: &'static str = "spike_msgs/action/MoveTo_Result";
    const HASH: &'static str = "RIHS01_e3f7e2916fff63933091bf15302865ac3d620a3b0a95f77e6f8928ec49853c88";
    const SCHEMA: &'static str = "int32 error_code\nstring error_string\n";
}

impl Message for MoveToFeedback {
    const NAME: &'static str = "spike_msgs/action/MoveTo_Feedback";
    const HASH: &'static str = "RIHS01_25995951e5e934908ebb2b1186dc3a4d4f6efeac4bc037dfaa31ed55dee935cb";
    const SCHEMA: &'static str = "float64 progress\nfloat64[] positions\n";
}

//! Compares the table with the endpoints that a surface creates.

use super::host::{GateState, Host, ParameterSelection, Snapshot, Statistics, SubmitError};
use super::parameters::fake;
use super::table::{Kind, PARAMETERS, ROWS, Row};
use super::{GripperSettings, Group, JointNames, Surface, TrajectorySettings, states};
use crate::layer::{Environment, Networks, Node, NodeName, NodeOptions, Qos, RosArguments};
use crate::link::protocol::EndpointKind;
use lineshaft_core::command::{Action, Setpoints};
use lineshaft_core::config::{MachineConfig, SlotConfig};
use lineshaft_core::function::Kind as FunctionKind;
use lineshaft_core::machine::Machine;
use lineshaft_core::object::AxisSet;
use lineshaft_core::parameter::ParameterImage;
use lineshaft_core::signal::Directory;
use lineshaft_msgs::srv::{RecordRequest, RecordResponse};
use std::collections::BTreeSet;
use std::sync::Arc;
use tokio::sync::mpsc::unbounded_channel;
use tokio::sync::oneshot;

const URDF: &str = "<robot name='r'><link name='base'/></robot>";

/// A machine at rest with all objects that lead to endpoints.
struct Still {
    config: MachineConfig,
    joint_names: JointNames,
    directory: Directory,
    controller_manager: Option<&'static str>,
}

impl Still {
    fn new(controller_manager: Option<&'static str>) -> Self {
        // A function without source and sink.
        let slots = vec![SlotConfig::new("cams".to_owned(), 0, FunctionKind::Cam)];
        let config = MachineConfig { slots, ..fake::config() };
        let directory = Machine::new(config.clone()).expect("a sound machine").directory().clone();
        Self { joint_names: JointNames::of_objects(&config), config, directory, controller_manager }
    }
}

impl Host for Still {
    fn config(&self) -> &MachineConfig {
        &self.config
    }

    fn joint_names(&self) -> &JointNames {
        &self.joint_names
    }

    fn directory(&self) -> &Directory {
        &self.directory
    }

    fn submit(&self, _: Action) -> Result<u64, SubmitError> {
        Err(SubmitError::Full)
    }

    fn read_vocabulary(&self, _: &str, _: &str, _: &str) -> Result<Action, String> {
        Err("it stands still".to_owned())
    }

    fn read_parameters(&self, _: &str) -> Result<Action, String> {
        Err("it stands still".to_owned())
    }

    fn write_parameters(&self, _: AxisSet, _: ParameterSelection) -> String {
        String::new()
    }

    fn store_parameters(&self, _: oneshot::Sender<Result<(), String>>) {}

    fn record(&self, _: RecordRequest, _: oneshot::Sender<RecordResponse>) {}

    fn robot_description(&self) -> Option<&str> {
        Some(URDF)
    }

    fn controller_manager(&self) -> Option<&str> {
        self.controller_manager
    }

    fn stream(&self, _: &Setpoints) -> Result<(), SubmitError> {
        Err(SubmitError::Full)
    }

    fn is_active_at_start(&self) -> bool {
        true
    }

    fn open(&self) {}

    fn resume_commands(&self) {}

    fn close(&self) {}

    fn gate(&self) -> GateState {
        GateState::Open
    }

    fn statistics(&self) -> Statistics {
        Statistics::default()
    }

    fn hardware(&self, _: u16) -> Option<&str> {
        None
    }

    fn snapshot(&self) -> Arc<Snapshot> {
        Arc::default()
    }

    fn parameters(&self) -> Arc<ParameterImage> {
        Arc::new(fake::image(&self.config))
    }
}

/// Kind, full name, type and QoS.
type Endpoint = (EndpointKind, String, String, Qos);

/// Returns the endpoints of a row for node /cell/shaft.
fn endpoints(row: &Row) -> Vec<Endpoint> {
    let name = match row.name.strip_prefix("~/") {
        Some(rest) => format!("/cell/shaft/{rest}"),
        None if row.name.starts_with('/') => row.name.to_owned(),
        None => format!("/cell/{}", row.name),
    };
    let one = |kind| vec![(kind, name.clone(), row.interface.to_owned(), row.qos)];
    match row.kind {
        Kind::Publisher => one(EndpointKind::Publisher),
        Kind::Subscription => one(EndpointKind::Subscription),
        Kind::Service => one(EndpointKind::Server),
        Kind::Action => {
            let part = |kind, part: &str, interface: &str, qos| {
                (kind, format!("{name}/_action/{part}"), interface.to_owned(), qos)
            };
            let derived = |suffix: &str| format!("{}_{suffix}", row.interface);
            vec![
                part(EndpointKind::Server, "send_goal", &derived("SendGoal"), row.qos),
                part(EndpointKind::Server, "get_result", &derived("GetResult"), row.qos),
                part(EndpointKind::Server, "cancel_goal", "action_msgs/srv/CancelGoal", row.qos),
                part(EndpointKind::Publisher, "feedback", &derived("FeedbackMessage"), Qos::STREAM),
                part(EndpointKind::Publisher, "status", "action_msgs/msg/GoalStatusArray", Qos::STATUS),
            ]
        }
    }
}

/// Returns a surface of node /cell/shaft, and the endpoints that it has created.
fn surface(controller_manager: Option<&'static str>, groups: &[Group]) -> (Surface, Vec<Endpoint>) {
    // As in the tests of the layer: domains that tests with other peers do not use.
    let domain = 201 + u16::try_from(std::process::id() % 32).unwrap();
    let environment = Environment { domain, networks: Networks::Loopback };
    let name = NodeName::new("/cell", "shaft").unwrap();
    // Required for the subscription of /clock.
    let (given, _) = RosArguments::take(["--ros-args", "-p", "use_sim_time:=true"].map(str::to_owned)).unwrap();
    let options = NodeOptions { overrides: given.overrides(&name), ..NodeOptions::plain(name) };
    let node = Node::with(options, &environment).unwrap();
    let opened = node.opened();
    let (_events, events) = unbounded_channel();
    let (_states, states) = states(true);
    let still = Still::new(controller_manager);
    let surface = Surface::start(node, Arc::new(still), events, states, groups).unwrap();
    let opened = opened.lock().unwrap().clone();
    (surface, opened)
}

/// docs/interfaces.md is generated from the table: a row without an endpoint, or an endpoint without a row, would make it wrong.
#[tokio::test]
async fn surface_creates_exactly_endpoints_of_table() {
    let (surface, opened) = surface(Some("/controller_manager"), &[]);
    // Gripper actions exist only for groups.
    let rows = ROWS.iter().filter(|row| !row.name.ends_with("gripper_cmd"));
    let wanted: Vec<Endpoint> = rows.flat_map(endpoints).collect();
    for (kind, name, interface, qos) in &wanted {
        let found: Vec<_> = opened.iter().filter(|known| known.0 == *kind && known.1 == *name).collect();
        assert!(!found.is_empty(), "the table promises {name}, which is not opened");
        for (_, _, known, known_qos) in found {
            assert_eq!(known, interface, "the type of {name}");
            assert_eq!(known_qos, qos, "the QoS of {name}");
        }
    }
    let known: BTreeSet<_> = wanted.iter().map(|(kind, name, ..)| (*kind, name.as_str())).collect();
    let others = opened.iter().map(|(kind, name, ..)| (*kind, name.as_str())).filter(|one| !known.contains(one));
    assert_eq!(others.collect::<Vec<_>>(), [], "opened, but not in the table");

    let mut declared = surface.hub.own.names();
    declared.retain(|name| !name.starts_with("qos_overrides."));
    let joints = fake::config().axes.into_iter().filter(|axis| axis.drive.is_some()).map(|axis| axis.name);
    let joints: Vec<_> = joints.collect();
    // QoS parameters are derived from the topics.
    let rows = PARAMETERS.iter().map(|row| row.name).filter(|name| !name.starts_with("qos_overrides."));
    let names = rows.flat_map(|name| match name.contains("<joint>") {
        true => joints.iter().map(|joint| name.replace("<joint>", joint)).collect(),
        false => vec![name.to_owned()],
    });
    assert_eq!(declared, names.collect::<BTreeSet<_>>().into_iter().collect::<Vec<_>>());
}

#[tokio::test]
async fn controller_manager_has_the_name_that_the_cell_gives_or_does_not_exist() {
    let of_manager = |opened: &[Endpoint]| {
        let of_type = opened.iter().filter(|(_, _, interface, _)| interface.starts_with("controller_manager_msgs/"));
        of_type.map(|(_, name, ..)| name.clone()).collect::<BTreeSet<_>>()
    };
    let (without, opened) = surface(None, &[]);
    assert_eq!(of_manager(&opened), BTreeSet::new());
    drop(without);
    let (_with, opened) = surface(Some("/cell/shaft/controller_manager"), &[]);
    let services =
        ["list_controllers", "list_controller_types", "list_hardware_components", "list_hardware_interfaces"];
    let refused = ["load_controller", "unload_controller", "reload_controller_libraries"];
    let services = services.into_iter().chain(refused).chain(["switch_controller"]);
    let names = services.map(|service| format!("/cell/shaft/controller_manager/{service}"));
    assert_eq!(of_manager(&opened), names.collect());
}

#[tokio::test]
async fn a_gripper_has_two_actions_below_the_name_of_its_group() {
    let group = |name: &str, gripper| Group {
        name: name.to_owned(),
        axes: vec![1],
        trajectories: TrajectorySettings::default(),
        gripper,
    };
    let groups = [group("hand", Some(GripperSettings::default())), group("arm", None)];
    let (_surface, opened) = surface(None, &groups);
    let of_grippers = opened.iter().map(|(_, name, ..)| name.as_str()).filter(|name| name.contains("gripper"));
    let goals: BTreeSet<_> = of_grippers.filter(|name| name.ends_with("send_goal")).collect();
    let named = ["gripper_cmd", "parallel_gripper_cmd"];
    let expected = named.map(|name| format!("/cell/shaft/hand/{name}/_action/send_goal"));
    assert_eq!(goals, expected.iter().map(String::as_str).collect());
}

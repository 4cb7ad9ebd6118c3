//! Table of the complete ROS 2 interface of the node: the surface creates its endpoints from it, and docs/interfaces.md is generated from
//! it.

use super::refusing::RefusalResponse;
use crate::layer::{
    ActionOptions, ActionServer, CreateError, NodeHandle, Publisher, Qos, RequestPolicy, ServiceServer, Subscription,
    TimeSource,
};
use lineshaft_msgs::action::{HomeAxis, MoveAxis, Phase, ProbeAxis, RunFunction, Synchronize, Tune};
use lineshaft_msgs::foreign::control_msgs::action::{FollowJointTrajectory, GripperCommand, ParallelGripperCommand};
use lineshaft_msgs::foreign::control_msgs::msg::{JointJog, JointTrajectoryControllerState};
use lineshaft_msgs::foreign::control_msgs::srv::QueryTrajectoryState;
use lineshaft_msgs::foreign::controller_manager_msgs::srv::{
    ListControllerTypes, ListControllers, ListHardwareComponents, ListHardwareInterfaces, LoadController,
    ReloadControllerLibraries, SwitchController, UnloadController,
};
use lineshaft_msgs::foreign::diagnostic_msgs::msg::DiagnosticArray;
use lineshaft_msgs::foreign::lifecycle_msgs::msg::TransitionEvent;
use lineshaft_msgs::foreign::lifecycle_msgs::srv::{
    ChangeState, GetAvailableStates, GetAvailableTransitions, GetState,
};
use lineshaft_msgs::foreign::rcl_interfaces::msg::{Log, ParameterEvent};
use lineshaft_msgs::foreign::rcl_interfaces::srv::{
    DescribeParameters, GetLoggerLevels, GetParameterTypes, GetParameters, ListParameters, SetLoggerLevels,
    SetParameters, SetParametersAtomically,
};
use lineshaft_msgs::foreign::rosgraph_msgs::msg::Clock;
use lineshaft_msgs::foreign::sensor_msgs::msg::JointState;
use lineshaft_msgs::foreign::std_msgs::msg::String as Text;
use lineshaft_msgs::foreign::std_srvs::srv::Trigger;
use lineshaft_msgs::foreign::trajectory_msgs::msg::JointTrajectory;
use lineshaft_msgs::msg::{AxisStates, CycleStatistics, Event, FunctionStates, Setpoints, ShaftStates};
use lineshaft_msgs::srv::{
    AbortTrigger, AxesCommand, CommandFunction, ExportParameters, GearOut, GetTable, ImportParameters, LoadProgram,
    LoadTable, Record, ResetParameters, SdoRead, SdoWrite, SetMemory, SetOutput, SetPosition, TouchProbe, Vocabulary,
};
use lineshaft_msgs::{Action, Message, Service};
use std::marker::PhantomData;

/// Kind of an endpoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A topic that the node publishes.
    Publisher,
    /// A topic that the node reads.
    Subscription,
    /// A service.
    Service,
    /// An action.
    Action,
}

/// Row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Kind of the endpoint.
    pub kind: Kind,
    /// Name before expansion and remapping.
    pub name: &'static str,
    /// Interface type.
    pub interface: &'static str,
    /// QoS; of an action, that of its services.
    pub qos: Qos,
    /// Description, in Markdown.
    pub text: &'static str,
}

/// Parameter of the node itself, as in the documentation.
#[derive(Clone, Copy, Debug)]
pub struct ParameterRow {
    /// Name; `<axis>` and `<group>` are placeholders for names of the cell.
    pub name: &'static str,
    /// ROS 2 type.
    pub kind: &'static str,
    /// Default value, in Markdown.
    pub default: &'static str,
    /// Whether the parameter cannot be set while the node runs.
    pub read_only: bool,
    /// Description, with unit and range.
    pub text: &'static str,
}

/// Topic of type `M`.
pub struct TopicRow<M>(pub Row, PhantomData<fn(M)>);
/// Service of type `S`, with the kinds of requests that are refused before they are handled.
pub struct ServiceRow<S: Service>(pub Row, RequestPolicy<S>);
/// Action of type `A`.
pub struct ActionRow<A>(pub Row, PhantomData<fn(A)>);

impl<M: Message> TopicRow<M> {
    const fn new(kind: Kind, name: &'static str, qos: Qos, text: &'static str) -> Self {
        Self(Row { kind, name, interface: M::NAME, qos, text }, PhantomData)
    }

    const fn published(name: &'static str, qos: Qos, text: &'static str) -> Self {
        Self::new(Kind::Publisher, name, qos, text)
    }

    const fn subscribed(name: &'static str, qos: Qos, text: &'static str) -> Self {
        Self::new(Kind::Subscription, name, qos, text)
    }

    pub(super) fn publisher(&self, node: &NodeHandle) -> Result<Publisher<M>, CreateError> {
        self.publisher_as(node, self.0.name)
    }

    /// Creates the publisher with another name than that of the row.
    pub(super) fn publisher_as(&self, node: &NodeHandle, name: &str) -> Result<Publisher<M>, CreateError> {
        node.publisher(name, self.0.qos)
    }

    pub(super) fn subscription(&self, node: &NodeHandle) -> Result<Subscription<M>, CreateError> {
        self.subscription_as(node, self.0.name)
    }

    /// Creates the subscription for a group of axes.
    pub(super) fn subscription_as(&self, node: &NodeHandle, name: &str) -> Result<Subscription<M>, CreateError> {
        node.subscription(name, self.0.qos)
    }
}

impl TopicRow<Clock> {
    pub(super) fn time_source(&self, node: &NodeHandle) -> Result<TimeSource, CreateError> {
        node.time_source(self.0.name, self.0.qos)
    }
}

impl<S: Service> ServiceRow<S> {
    const fn new(name: &'static str, qos: Qos, text: &'static str) -> Self {
        Self(Row { kind: Kind::Service, name, interface: S::NAME, qos, text }, RequestPolicy::Asks)
    }

    /// Returns the service with requests that are commands.
    const fn for_commands(self) -> Self
    where
        S::Response: RefusalResponse<S::Request>,
    {
        Self(self.0, RequestPolicy::Commands(<S::Response as RefusalResponse<S::Request>>::refusing))
    }

    /// Returns the service with requests that are stops.
    const fn for_stops(self) -> Self
    where
        S::Response: RefusalResponse<S::Request>,
    {
        Self(self.0, RequestPolicy::Stops(<S::Response as RefusalResponse<S::Request>>::refusing))
    }

    pub(super) fn server(&self, node: &NodeHandle) -> Result<ServiceServer<S>, CreateError> {
        self.server_as(node, self.0.name)
    }

    /// Creates the server for a group of axes.
    pub(super) fn server_as(&self, node: &NodeHandle, name: &str) -> Result<ServiceServer<S>, CreateError> {
        Ok(node.service(name, self.0.qos)?.with_policy(self.1))
    }
}

/// Prefix of the names of controller_manager in the table.
const CONTROLLER_MANAGER: &str = "/controller_manager";

impl<S: Service> ServiceRow<S> {
    /// Creates a service of the controller manager with this absolute name.
    pub(super) fn server_below(&self, node: &NodeHandle, manager: &str) -> Result<ServiceServer<S>, CreateError> {
        let name = self.0.name.strip_prefix(CONTROLLER_MANAGER).unwrap_or(self.0.name);
        Ok(node.service(&format!("{manager}{name}"), self.0.qos)?.with_policy(self.1))
    }
}

impl<A: Action> ActionRow<A> {
    const fn new(name: &'static str, text: &'static str) -> Self {
        Self(Row { kind: Kind::Action, name, interface: A::NAME, qos: Qos::SERVICE, text }, PhantomData)
    }

    pub(super) fn server(&self, node: &NodeHandle) -> Result<ActionServer<A>, CreateError> {
        self.server_as(node, self.0.name)
    }

    /// Creates the action server for a group of axes.
    pub(super) fn server_as(&self, node: &NodeHandle, name: &str) -> Result<ActionServer<A>, CreateError> {
        node.action(name, ActionOptions::default())
    }
}

pub(super) const JOINT_STATES: TopicRow<JointState> = TopicRow::published(
    "joint_states",
    Qos::STREAM,
    "actual position, velocity, effort of all axes but virtual ones, by their joint names; position unwrapped; each cycle of `joint_states_rate`",
);
pub(super) const AXIS_STATES: TopicRow<AxisStates> =
    TopicRow::published("~/axis_states", Qos::STREAM, "all axes in file order; each cycle of `axis_states_rate`");
pub(super) const SHAFT: TopicRow<ShaftStates> = TopicRow::published(
    "~/shaft",
    Qos::STREAM,
    "what leads: encoders, commands of virtual axes, masters of several, machine.vmaster; each cycle of `shaft_rate`, only where that is not 0; see [shaft.md](shaft.md#leader-states)",
);
pub(super) const FUNCTIONS: TopicRow<FunctionStates> = TopicRow::published(
    "~/functions",
    Qos::STREAM,
    "all function slots: ten times a second, and when one starts, ends, is refused or has another input or output, at most 50 times a second; only where the cell has functions",
);
pub(super) const EVENTS: TopicRow<Event> =
    TopicRow::published("~/events", Qos::EVENTS, "every event, with a sequence number without gaps");
pub(super) const ERRORS: TopicRow<Event> = TopicRow::published(
    "~/errors",
    Qos::HISTORY,
    "the last 32 errors and resets, with how the axis stood and the remedy, also for who comes later; see [errors.md](errors.md)",
);
pub(super) const PARAMETER_EVENTS: TopicRow<ParameterEvent> = TopicRow::published(
    "/parameter_events",
    Qos::PARAMETERS,
    "every change of a parameter, from any source; see below",
);
pub(super) const ROSOUT: TopicRow<Log> = TopicRow::published("/rosout", Qos::ROSOUT, "errors, refusals, limits");
pub(super) const ROBOT_DESCRIPTION: TopicRow<Text> = TopicRow::published(
    "robot_description",
    Qos::STATUS,
    "the URDF that the cell names with `ros: {robot_description: FILE}`; only then; see below",
);
pub(super) const CLOCK: TopicRow<Clock> = TopicRow::subscribed(
    "/clock",
    Qos::CLOCK,
    "the time of a simulation, only while `use_sim_time` is true; see below",
);
pub(super) const TRANSITION_EVENT: TopicRow<TransitionEvent> =
    TopicRow::published("~/transition_event", Qos::STREAM, "every step of the life cycle; see [Lifecycle](#lifecycle)");
pub(super) const DIAGNOSTICS: TopicRow<DiagnosticArray> = TopicRow::published(
    "/diagnostics",
    Qos::STREAM,
    "how cycle, drives, buses and recorder do: once a second, and at once when a level changes; see [Diagnostics](#diagnostics)",
);
pub(super) const CYCLE_STATISTICS: TopicRow<CycleStatistics> =
    TopicRow::published("~/cycle_statistics", Qos::STREAM, "how well the cycle keeps its time, once a second");
pub(super) const CHANGE_STATE: ServiceRow<ChangeState> =
    ServiceRow::new("~/change_state", Qos::SERVICE, "makes a transition of the life cycle; answers when it is made")
        .for_commands();
pub(super) const GET_STATE: ServiceRow<GetState> =
    ServiceRow::new("~/get_state", Qos::SERVICE, "the present state of the life cycle");
pub(super) const GET_AVAILABLE_STATES: ServiceRow<GetAvailableStates> =
    ServiceRow::new("~/get_available_states", Qos::SERVICE, "all states of the life cycle");
pub(super) const GET_AVAILABLE_TRANSITIONS: ServiceRow<GetAvailableTransitions> =
    ServiceRow::new("~/get_available_transitions", Qos::SERVICE, "the transitions from the present state");
pub(super) const GET_TRANSITION_GRAPH: ServiceRow<GetAvailableTransitions> =
    ServiceRow::new("~/get_transition_graph", Qos::SERVICE, "all transitions of the life cycle");
pub(super) const JOG: TopicRow<JointJog> = TopicRow::subscribed(
    "~/jog",
    Qos::STREAM,
    "moves axes at velocities, by hand, until it stops coming; names joints; see below",
);
pub(super) const SETPOINTS: TopicRow<Setpoints> = TopicRow::subscribed(
    "~/setpoints",
    Qos::STREAM,
    "velocities for axes, from a machine, until they stop coming; see below",
);
pub(super) const ENABLE: ServiceRow<AxesCommand> = axes("~/enable", "switches axes on").for_commands();
pub(super) const DISABLE: ServiceRow<AxesCommand> = axes("~/disable", "stops axes, then switches them off").for_stops();
pub(super) const HALT: ServiceRow<AxesCommand> =
    axes("~/halt", "stops axes; a new goal may follow at once").for_stops();
pub(super) const QUICK_STOP: ServiceRow<AxesCommand> =
    axes("~/quick_stop", "stops axes as fast as they can and locks them until `~/reset_errors`").for_stops();
pub(super) const RESET_ERRORS: ServiceRow<AxesCommand> =
    axes("~/reset_errors", "clears errors and locks").for_commands();
pub(super) const HOME: ServiceRow<AxesCommand> = ServiceRow::new(
    "~/home",
    Qos::SERVICE,
    "starts homing of axes, an empty list: of all that have a method; answers at once, when each has accepted or refused; see [homing.md](homing.md)",
).for_commands();
pub(super) const SET_POSITION: ServiceRow<SetPosition> = ServiceRow::new(
    "~/set_position",
    Qos::SERVICE,
    "the present position of an axis gets a new value, or that of an encoder, or of a master (`x.master`); nothing moves, and a motion that refers to no place goes on; see [homing.md](homing.md#a-new-position) and [encoders.md](encoders.md)",
).for_commands();
pub(super) const SET_POSITION_RELATIVE: ServiceRow<SetPosition> = ServiceRow::new(
    "~/set_position_relative",
    Qos::SERVICE,
    "the same of an axis by a distance: all of its positions are `position` more from then on (MC_SetPosition with Relative)",
)
.for_commands();
pub(super) const GEAR_OUT: ServiceRow<GearOut> = ServiceRow::new(
    "~/gear_out",
    Qos::SERVICE,
    "ends the coupling of an axis now, or where its leader or it comes to a place; its goal of `~/synchronize` succeeds; see [shaft.md](shaft.md#gear-out)",
)
.for_commands();
pub(super) const TOUCH_PROBE: ServiceRow<TouchProbe> = ServiceRow::new(
    "~/touch_probe",
    Qos::SERVICE,
    "records where an axis is when an input, an encoder or a drive latches, once or until it is aborted, within a window if that is asked for; moves nothing; each record is an event `latch` of the axis; see [motion.md](motion.md#touch-probe-without-a-motion)",
)
.for_commands();
pub(super) const ABORT_TRIGGER: ServiceRow<AbortTrigger> =
    ServiceRow::new("~/abort_trigger", Qos::SERVICE, "ends touch probes of an axis, those of one trigger or all")
        .for_commands();
pub(super) const SET_OUTPUT: ServiceRow<SetOutput> = ServiceRow::new(
    "~/set_output",
    Qos::SERVICE,
    "sets digital outputs (0, 1) and analog ones (V) permanently, all of a request in one cycle, or none; see [io.md](io.md)",
).for_commands();
pub(super) const SET_MEMORY: ServiceRow<SetMemory> = ServiceRow::new(
    "~/set_memory",
    Qos::SERVICE,
    "sets memory cells, which functions read, all of a request in one cycle, or none; see [functions.md](functions.md)",
)
.for_commands();
pub(super) const COMMAND_FUNCTION: ServiceRow<CommandFunction> = ServiceRow::new(
    "~/command_function",
    Qos::SERVICE,
    "stages values of a function's fields and commands it in the same cycle (RESET, START, VALUE_NEW, READ_VALUE), or changes nothing; answers with the set in force; see below",
)
.for_commands();
pub(super) const LOAD_PROGRAM: ServiceRow<LoadProgram> = ServiceRow::new(
    "~/load_program",
    Qos::SERVICE,
    "another module for a program, in the functions that run it, which go on with their state or begin again; refused where it is no program, or its state is not as long",
)
.for_commands();
pub(super) const LOAD_TABLE: ServiceRow<LoadTable> = ServiceRow::new(
    "~/load_table",
    Qos::SERVICE,
    "new numbers for a table, of the form that it has; refused while a started function reads it, but by types that take them while they run",
)
.for_commands();
pub(super) const GET_TABLE: ServiceRow<GetTable> =
    ServiceRow::new("~/get_table", Qos::SERVICE, "the numbers of a table in force");
pub(super) const SDO_READ: ServiceRow<SdoRead> = ServiceRow::new(
    "~/sdo_read",
    Qos::SERVICE,
    "an object of a device on CAN, by its name in the EDS or its index, while the cycles run; see [can.md](can.md#objects-by-ros)",
)
.for_commands();
pub(super) const SDO_WRITE: ServiceRow<SdoWrite> = ServiceRow::new(
    "~/sdo_write",
    Qos::SERVICE,
    "the same the other way; refused for what the master writes, and for mapped objects of a drive under power",
)
.for_commands();
pub(super) const ABORT: ServiceRow<Trigger> = ServiceRow::new(
    "~/abort",
    Qos::SERVICE,
    "the Esc of MACS: stops all axes as fast as they can, closes brakes, sets outputs as `esccond` says, and locks the axes until `~/reset_errors`; answers when all stand; see [io.md](io.md)",
).for_stops();
pub(super) const RECORD: ServiceRow<Record> = ServiceRow::new(
    "~/record",
    Qos::SERVICE,
    "STATUS, START a bag, STOP it, SAVE what the flight recorder holds; see [recording.md](recording.md)",
)
.for_commands();
pub(super) const VOCABULARY: ServiceRow<Vocabulary> = ServiceRow::new(
    "~/vocabulary",
    Qos::SERVICE,
    "a verb of an old controller for one axis; answers when the machine has accepted or refused it; see below",
)
.for_commands();
pub(super) const GET_PARAMETERS: ServiceRow<GetParameters> = parameters("~/get_parameters", "values of parameters");
pub(super) const GET_PARAMETER_TYPES: ServiceRow<GetParameterTypes> =
    parameters("~/get_parameter_types", "their types");
pub(super) const SET_PARAMETERS: ServiceRow<SetParameters> =
    parameters("~/set_parameters", "sets each by itself").for_commands();
pub(super) const SET_PARAMETERS_ATOMICALLY: ServiceRow<SetParametersAtomically> =
    parameters("~/set_parameters_atomically", "sets all of them, or none").for_commands();
pub(super) const LIST_PARAMETERS: ServiceRow<ListParameters> = parameters("~/list_parameters", "their names");
pub(super) const DESCRIBE_PARAMETERS: ServiceRow<DescribeParameters> =
    parameters("~/describe_parameters", "their descriptions, units and ranges");
pub(super) const GET_LOGGER_LEVELS: ServiceRow<GetLoggerLevels> =
    ServiceRow::new("~/get_logger_levels", Qos::SERVICE, "levels of loggers; see below");
pub(super) const SET_LOGGER_LEVELS: ServiceRow<SetLoggerLevels> =
    ServiceRow::new("~/set_logger_levels", Qos::SERVICE, "sets them, in force at once");
pub(super) const SAVE_PARAMETERS: ServiceRow<AxesCommand> =
    axes("~/save_parameters", "keeps what is in force beyond the power; answers when it is stored").for_commands();
pub(super) const DELETE_PARAMETERS: ServiceRow<AxesCommand> =
    axes("~/delete_parameters", "forgets what was kept; answers when that is stored").for_commands();
pub(super) const RESET_PARAMETERS: ServiceRow<ResetParameters> = ServiceRow::new(
    "~/reset_parameters",
    Qos::SERVICE,
    "brings layer USER (what was saved) or INIT (the cell) back into force",
)
.for_commands();
pub(super) const EXPORT_PARAMETERS: ServiceRow<ExportParameters> =
    ServiceRow::new("~/export_parameters", Qos::SERVICE, "parameters in force as text");
pub(super) const IMPORT_PARAMETERS: ServiceRow<ImportParameters> =
    ServiceRow::new("~/import_parameters", Qos::SERVICE, "parameters from text, all or none; at most 1 MiB")
        .for_commands();
pub(super) const MOVE_AXIS: ActionRow<MoveAxis> =
    ActionRow::new("~/move_axis", "positioning; mode VELOCITY stays open until it is cancelled, halted or replaced");
pub(super) const PROBE_AXIS: ActionRow<ProbeAxis> =
    ActionRow::new("~/probe_axis", "touch probe to position; see below");
pub(super) const HOME_AXIS: ActionRow<HomeAxis> = ActionRow::new(
    "~/home_axis",
    "homing of one axis, by its method or another one; cancel stops it; see [homing.md](homing.md)",
);
pub(super) const SYNCHRONIZE: ActionRow<Synchronize> =
    ActionRow::new("~/synchronize", "open while coupled; cancel and `~/gear_out` uncouple, a dead client does not");
pub(super) const PHASE: ActionRow<Phase> =
    ActionRow::new("~/phase", "a shift of an axis against its leader in motion; see [cams.md](cams.md#phase)");
pub(super) const RUN_FUNCTION: ActionRow<RunFunction> = ActionRow::new(
    "~/run_function",
    "an order of a function that ends (epos), with values of its fields; cancel stops it; see [functions.md](functions.md#as-a-goal)",
);
pub(super) const TUNE: ActionRow<Tune> = ActionRow::new(
    "~/tune",
    "finds gains for the loops of an axis that are closed here: enables it, shakes it within bounds, disables it; cancel stops it; a real drive needs `real`; see [loops.md](loops.md#tuning-by-ros)",
);
pub(super) const FOLLOW_JOINT_TRAJECTORY: ActionRow<FollowJointTrajectory> = ActionRow::new(
    "~/follow_joint_trajectory",
    "a trajectory of all axes with a drive; with `groups:` one for each, `~/<group>/follow_joint_trajectory`; see below",
);
pub(super) const GRIPPER_CMD: ActionRow<GripperCommand> = ActionRow::new(
    "~/gripper_cmd",
    "opens or closes a gripper, a group of one axis with `gripper:`: `~/<group>/gripper_cmd`; see [Grippers](#grippers)",
);
pub(super) const PARALLEL_GRIPPER_CMD: ActionRow<ParallelGripperCommand> =
    ActionRow::new("~/parallel_gripper_cmd", "the same with the newer type, `~/<group>/parallel_gripper_cmd`");
pub(super) const JOINT_TRAJECTORY: TopicRow<JointTrajectory> = TopicRow::subscribed(
    "~/joint_trajectory",
    Qos::STREAM,
    "the same without an answer; with `groups:` one for each, `~/<group>/joint_trajectory`; without points: stop",
);
pub(super) const CONTROLLER_STATE: TopicRow<JointTrajectoryControllerState> = TopicRow::published(
    "~/controller_state",
    Qos::STREAM,
    "what these joints are asked for and where they are, `controller_state_rate` times a second; with `groups:` one for each, `~/<group>/controller_state`; see below",
);
pub(super) const QUERY_STATE: ServiceRow<QueryTrajectoryState> = ServiceRow::new(
    "~/query_state",
    Qos::SERVICE,
    "what the trajectory of these joints asks of them at a time; with `groups:` one for each, `~/<group>/query_state`; see below",
);
pub(super) const LIST_CONTROLLERS: ServiceRow<ListControllers> = ServiceRow::new(
    "/controller_manager/list_controllers",
    Qos::SERVICE,
    "groups as controllers; only with `ros: {controller_manager: /controller_manager}`, as the next seven; see [Controller manager](#controller-manager)",
);
pub(super) const LIST_CONTROLLER_TYPES: ServiceRow<ListControllerTypes> =
    ServiceRow::new("/controller_manager/list_controller_types", Qos::SERVICE, "the type of all controllers");
pub(super) const LIST_HARDWARE_COMPONENTS: ServiceRow<ListHardwareComponents> = ServiceRow::new(
    "/controller_manager/list_hardware_components",
    Qos::SERVICE,
    "all axes with a drive as one component",
);
pub(super) const LIST_HARDWARE_INTERFACES: ServiceRow<ListHardwareInterfaces> = ServiceRow::new(
    "/controller_manager/list_hardware_interfaces",
    Qos::SERVICE,
    "its command interfaces and state interfaces",
);
pub(super) const LOAD_CONTROLLER: ServiceRow<LoadController> = ServiceRow::new(
    "/controller_manager/load_controller",
    Qos::SERVICE,
    "refused, as the next two: groups of the cell are the controllers",
);
pub(super) const UNLOAD_CONTROLLER: ServiceRow<UnloadController> =
    ServiceRow::new("/controller_manager/unload_controller", Qos::SERVICE, "refused");
pub(super) const RELOAD_CONTROLLER_LIBRARIES: ServiceRow<ReloadControllerLibraries> =
    ServiceRow::new("/controller_manager/reload_controller_libraries", Qos::SERVICE, "refused");
// Deactivation is a stop, and activation moves nothing: neither is ever too late.
pub(super) const SWITCH_CONTROLLER: ServiceRow<SwitchController> = ServiceRow::new(
    "/controller_manager/switch_controller",
    Qos::SERVICE,
    "activates and deactivates controllers; an inactive one takes no trajectory; deactivation halts its axes",
)
.for_stops();

/// URDF as a parameter, for tools that read it from there.
pub(super) const ROBOT_DESCRIPTION_PARAMETER: ParameterRow = ParameterRow {
    name: "robot_description",
    kind: "string",
    default: "the file of the cell's `ros: {robot_description: FILE}`; without it there is no such parameter",
    read_only: true,
    text: "the URDF that the topic `robot_description` brings",
};

/// Parameters of the node itself, in the order of the documentation.
pub const PARAMETERS: &[ParameterRow] = &[
    own("use_sim_time", "bool", "false", "stamps and starts of trajectories follow `/clock`; see [Time](#time)"),
    ROBOT_DESCRIPTION_PARAMETER,
    own(
        "qos_overrides.<topic>.<publisher or subscription>.<policy>",
        "string or integer",
        "what the topic has",
        "given at the start, then read-only; see [ROS arguments](#ros-arguments)",
    ),
    own("allow_partial_joints_goal", "bool", "false", "trajectories may name some of the joints only"),
    own(
        "allow_integration_in_goal_trajectories",
        "bool",
        "false",
        "points may have velocities alone: positions are integrated from the command when the goal comes",
    ),
    own(
        "allow_nonzero_velocity_at_trajectory_end",
        "bool",
        "false",
        "the last point of a trajectory may have velocities, with which the joints begin to stop",
    ),
    ParameterRow {
        read_only: true,
        ..own(
            "action_monitor_rate",
            "double",
            "20.0",
            "feedback of trajectories per second, 0.1 to 1000; given at the start",
        )
    },
    own(
        "constraints.goal_time",
        "double",
        "0.0",
        "s after the last point within which the goal tolerances must be met; 0: for ever",
    ),
    own(
        "constraints.stopped_velocity_tolerance",
        "double",
        "0.01",
        "velocity error at the end of a trajectory, m/s or rad/s; 0: without limit",
    ),
    own(
        "constraints.<joint>.trajectory",
        "double",
        "0.0",
        "m or rad that a joint may be off on its way; 0: without limit; `<joint>` is a joint name",
    ),
    own("constraints.<joint>.goal", "double", "0.0", "m or rad that a joint may be off at the end; 0: without limit"),
    own(
        "constraints.<joint>.start",
        "double",
        "0.0",
        "m or rad that a first point at time 0 may be from the command of a joint; 0: without limit",
    ),
    own(
        "trajectory_limits.margin",
        "double",
        "0.001",
        "share by which a trajectory may exceed velocities and accelerations of its axes, 0 to 0.1; of a group \
         `<group>.trajectory_limits.margin`, as the next two",
    ),
    own(
        "trajectory_limits.on_excess",
        "string",
        "scale",
        "what is done beyond the margin: `scale` stretches the time of the trajectory, `refuse` refuses it",
    ),
    own(
        "trajectory_limits.max_stretch",
        "double",
        "1.44",
        "largest factor by which the time is stretched, 1 to 10; beyond it the trajectory is refused",
    ),
    own(
        "angle_wraparound",
        "bool",
        "false",
        "points of joints with `modulo` are moved by whole turns until the first one is nearest to the joint; of a group \
         `<group>.angle_wraparound`",
    ),
    own(
        "max_duration",
        "double",
        "0.0",
        "longest time of a trajectory from its start to its end in s, up to 86400; 0: without limit; of a group `<group>.max_duration`",
    ),
    own(
        "controller_state_rate",
        "double",
        "50.0",
        "messages of `~/controller_state` per second, up to 1000; 0: none; of a group `<group>.controller_state_rate`",
    ),
];

const fn own(name: &'static str, kind: &'static str, default: &'static str, text: &'static str) -> ParameterRow {
    ParameterRow { name, kind, default, read_only: false, text }
}

/// Creates the row of a service for a list of axes; an empty list means all axes.
const fn axes(name: &'static str, text: &'static str) -> ServiceRow<AxesCommand> {
    ServiceRow::new(name, Qos::SERVICE, text)
}

const fn parameters<S: Service>(name: &'static str, text: &'static str) -> ServiceRow<S> {
    ServiceRow::new(name, Qos::PARAMETERS, text)
}

/// All rows, in the order of the documentation.
pub const ROWS: &[Row] = &[
    JOINT_STATES.0,
    AXIS_STATES.0,
    SHAFT.0,
    FUNCTIONS.0,
    EVENTS.0,
    ERRORS.0,
    PARAMETER_EVENTS.0,
    ROSOUT.0,
    ROBOT_DESCRIPTION.0,
    CLOCK.0,
    TRANSITION_EVENT.0,
    DIAGNOSTICS.0,
    CYCLE_STATISTICS.0,
    CHANGE_STATE.0,
    GET_STATE.0,
    GET_AVAILABLE_STATES.0,
    GET_AVAILABLE_TRANSITIONS.0,
    GET_TRANSITION_GRAPH.0,
    JOG.0,
    SETPOINTS.0,
    ENABLE.0,
    DISABLE.0,
    HALT.0,
    QUICK_STOP.0,
    ABORT.0,
    RESET_ERRORS.0,
    HOME.0,
    SET_POSITION.0,
    SET_POSITION_RELATIVE.0,
    GEAR_OUT.0,
    TOUCH_PROBE.0,
    ABORT_TRIGGER.0,
    SET_OUTPUT.0,
    SET_MEMORY.0,
    COMMAND_FUNCTION.0,
    LOAD_PROGRAM.0,
    LOAD_TABLE.0,
    GET_TABLE.0,
    SDO_READ.0,
    SDO_WRITE.0,
    RECORD.0,
    VOCABULARY.0,
    GET_PARAMETERS.0,
    GET_PARAMETER_TYPES.0,
    SET_PARAMETERS.0,
    SET_PARAMETERS_ATOMICALLY.0,
    LIST_PARAMETERS.0,
    DESCRIBE_PARAMETERS.0,
    GET_LOGGER_LEVELS.0,
    SET_LOGGER_LEVELS.0,
    SAVE_PARAMETERS.0,
    DELETE_PARAMETERS.0,
    RESET_PARAMETERS.0,
    EXPORT_PARAMETERS.0,
    IMPORT_PARAMETERS.0,
    MOVE_AXIS.0,
    PROBE_AXIS.0,
    HOME_AXIS.0,
    SYNCHRONIZE.0,
    PHASE.0,
    RUN_FUNCTION.0,
    TUNE.0,
    FOLLOW_JOINT_TRAJECTORY.0,
    GRIPPER_CMD.0,
    PARALLEL_GRIPPER_CMD.0,
    JOINT_TRAJECTORY.0,
    CONTROLLER_STATE.0,
    QUERY_STATE.0,
    LIST_CONTROLLERS.0,
    LIST_CONTROLLER_TYPES.0,
    LIST_HARDWARE_COMPONENTS.0,
    LIST_HARDWARE_INTERFACES.0,
    LOAD_CONTROLLER.0,
    UNLOAD_CONTROLLER.0,
    RELOAD_CONTROLLER_LIBRARIES.0,
    SWITCH_CONTROLLER.0,
];

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn names_are_unique_and_rows_have_descriptions() {
        let names: BTreeSet<_> = ROWS.iter().map(|row| row.name).collect();
        assert_eq!(names.len(), ROWS.len());
        let names: BTreeSet<_> = PARAMETERS.iter().map(|row| row.name).collect();
        assert_eq!(names.len(), PARAMETERS.len());
        for row in ROWS {
            assert!(!row.text.is_empty() && row.interface.contains('/'), "{row:?}");
        }
    }
}

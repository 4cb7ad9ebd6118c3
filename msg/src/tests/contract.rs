//! The interface files against the contract: names, order, types and constants, listed here a second time.

use std::path::Path;

use crate::action::{HomeAxisFeedback, HomeAxisGoal, MoveAxisGoal, ProbeAxisFeedback, ProbeAxisGoal};
use crate::action::{SynchronizeFeedback, SynchronizeGoal};
use crate::files::{OWN, read_all};
use crate::foreign::action_msgs::msg::GoalStatus;
use crate::foreign::action_msgs::srv::CancelGoalResponse;
use crate::foreign::controller_manager_msgs::srv::SwitchControllerRequest;
use crate::foreign::rcl_interfaces::msg::{Log, ParameterType};
use crate::foreign::rcl_interfaces::srv::ListParametersRequest;
use crate::interface::{Field, Interface, Section};
use crate::msg::{AxisState, CycleInputs, Event};
use crate::srv::{CommandFunctionRequest, ExportParametersRequest, ResetParametersRequest};

/// Types with their names, as in section 7 of the contract; `---` between the parts.
const OWN_INTERFACES: [(&str, &str); 37] = [
    (
        "msg/AxisState",
        "uint8 DISABLED=0 STANDSTILL=1 DISCRETE_MOTION=2 CONTINUOUS_MOTION=3 HOMING=4
        uint8 SYNCHRONIZED_MOTION=5 STOPPING=6 ERROR_STOP=7
        string name
        uint8 state drive_state reference
        int8 mode_of_operation
        bool enabled homed in_position in_velocity in_sync warning positive_limit negative_limit
        uint32 error_code
        float64 command_position command_velocity command_acceleration
        float64 position velocity effort following_error sync_error
        int64 command_increments position_increments following_error_increments sync_error_increments",
    ),
    (
        "msg/AxisStates",
        "std_msgs/Header header
        uint64 cycle
        lineshaft_msgs/AxisState[] axes",
    ),
    (
        "msg/Event",
        "uint8 INFO=0 WARN=1 ERROR=2
        std_msgs/Header header
        uint64 sequence cycle
        uint32 age_ns
        uint8 severity
        string kind source
        uint32 code
        int64 increments
        float64 fraction value
        string text",
    ),
    (
        "msg/AppliedCommand",
        "uint64 cycle sequence
        string source command",
    ),
    (
        "msg/CycleStatistics",
        "std_msgs/Header header
        uint64 cycle
        uint32 cycle_ns
        uint64 cycles missed period_cycles period_missed
        float64 lateness_mean
        uint64 lateness_max lateness_worst
        float64 duration_mean
        uint64 duration_max duration_worst events_lost
        uint64 lateness_p50 lateness_p99 lateness_p999 duration_p50 duration_p99 duration_p999
        uint64 lateness_p50_since_start lateness_p99_since_start lateness_p999_since_start
        uint64 duration_p50_since_start duration_p99_since_start duration_p999_since_start",
    ),
    (
        "msg/CycleInputs",
        "uint8 FALLING=0 RISING=1 ACTIVE=0 PASSIVE=1 OFF=2
        uint64 cycle
        uint32 missed
        uint64[] digital
        float64[] analog
        int64[] encoder_count
        uint32[] encoder_epoch
        bool[] encoder_valid encoder_has_index
        int64[] encoder_index
        int64[] drive_count
        uint32[] drive_epoch
        float64[] drive_velocity drive_effort
        uint16[] drive_status
        int8[] drive_mode
        uint16[] drive_fault
        bool[] drive_online drive_fresh
        uint32[] drive_inputs
        bool[] drive_has_index
        int64[] drive_index
        string[] latch_object
        uint8[] latch_edge
        bool[] latch_has_age
        uint32[] latch_age_ns
        bool[] latch_has_position
        int64[] latch_position
        uint32 latches_lost
        uint8[] drive_bus
        bool[] drive_has_emergency
        uint64[] drive_emergency
        bool[] drive_unacknowledged",
    ),
    (
        "action/MoveAxis",
        "uint8 ABSOLUTE=0 RELATIVE=1 ADDITIVE=2 VELOCITY=3 SUPERIMPOSED=4
        uint8 SI=0 AXIS_UNIT=1 INCREMENTS=2
        uint8 ABORTING=0 BUFFERED=1 BLENDING_LOW=2 BLENDING_PREVIOUS=3 BLENDING_NEXT=4 BLENDING_HIGH=5
        uint8 SHORTEST=0 POSITIVE=1 NEGATIVE=2 CURRENT=3
        string axis
        uint8 mode units
        float64 position velocity acceleration deceleration jerk
        uint8 buffer_mode direction
        ---
        uint32 code
        string message
        float64 position
        int64 position_increments
        ---
        float64 position velocity distance_to_go
        int64 position_increments",
    ),
    (
        "action/ProbeAxis",
        "uint8 ABSOLUTE=0 RELATIVE=1
        uint8 SI=0 AXIS_UNIT=1 INCREMENTS=2
        uint8 RISING=0 FALLING=1 BOTH=2 INDEX=3
        string axis
        uint8 mode units
        float64 position velocity acceleration deceleration jerk
        string event
        uint8 edge
        float64 distance
        ---
        uint32 code
        string message
        bool probed
        float64 probed_position
        int64 probed_increments
        float64 position
        int64 position_increments
        ---
        uint8 SEARCHING=0 PROBED=1
        uint8 phase
        float64 position velocity distance_to_go",
    ),
    (
        "action/Tune",
        "uint8 SI=0 AXIS_UNIT=1 INCREMENTS=2
        string axis
        uint8 units
        float64 travel velocity effort duration inertia_ratio
        bool real apply
        ---
        uint32 code
        string message report
        rcl_interfaces/Parameter[] parameters
        bool applied
        ---
        uint8 ENABLING=1 EXCITING=2 DISABLING=3 DESIGNING=4
        uint8 phase
        float64 progress position velocity",
    ),
    (
        "action/RunFunction",
        "string function
        rcl_interfaces/Parameter[] parameters
        ---
        uint32 code
        string message
        int64 sink
        ---
        int64 sink
        uint8 inputs outputs",
    ),
    (
        "action/HomeAxis",
        "uint8 CONFIGURED=0 CIA402=1 MACS=2
        string axis
        uint8 scheme
        int8 method
        ---
        uint32 code
        string message
        int64 shift_increments
        ---
        uint8 SEARCH_SWITCH=1 LEAVE_SWITCH=2 SEARCH_INDEX=3 MOVE_TO_OFFSET=4 IN_DRIVE=5
        uint8 phase
        float64 position",
    ),
    (
        "action/Phase",
        "uint8 SLAVE=0 MASTER=1
        string axis
        uint8 side
        float64 shift velocity acceleration
        ---
        uint32 code
        string message
        ---
        float64 remaining",
    ),
    (
        "action/Synchronize",
        "uint8 VELOCITY=0 POSITION=1 MARKER=2 CAM=3 CAM_MASTER_MARKER=4 CAM_SLAVE_MARKER=5
        uint8 IMMEDIATELY=0 AT_POSITION=1 ON_EVENT=2 AT_END=3
        uint8 STOP=0 KEEP_VELOCITY=1
        uint8 ABSOLUTE=0 RELATIVE=1 RAMP_IN=2
        string axis master event
        uint8 mode engage disengage
        int64 numerator denominator
        int64 master_increments slave_increments start_distance_increments
        float64 offset velocity acceleration
        string table
        uint8 cam_start
        float64 master_scale slave_scale master_offset slave_offset
        ---
        uint32 code
        string message
        int64 position_increments
        ---
        uint8 WAITING=0 CATCHING_UP=1 SYNCHRONIZED=2
        uint8 phase
        int64 sync_error_increments
        float64 sync_error marker_error correction",
    ),
    (
        "srv/AxesCommand",
        "string[] axes
        ---
        bool success
        string message",
    ),
    (
        "msg/Setpoints",
        "std_msgs/Header header
        string[] axes
        float64[] velocities",
    ),
    (
        "msg/LeaderState",
        "string name
        bool valid has_scale
        float64 position velocity
        int64 position_increments
        float64 fraction velocity_increments",
    ),
    (
        "msg/ShaftStates",
        "std_msgs/Header header
        uint64 cycle
        lineshaft_msgs/LeaderState[] leaders",
    ),
    (
        "msg/Signals",
        "uint64 cycle
        uint32 inputs_crc
        uint32[] index
        uint64[] word",
    ),
    (
        "srv/Record",
        "uint8 STATUS=0 START=1 STOP=2 SAVE=3
        uint8 command
        string path
        uint64 max_bag_size
        float64 max_bag_duration
        ---
        bool success
        string message
        bool recording
        string path
        uint64 cycles size lost
        bool replayable",
    ),
    (
        "srv/ResetParameters",
        "uint8 USER=0 INIT=1
        string[] axes
        uint8 layer
        ---
        bool success
        string message",
    ),
    (
        "srv/ExportParameters",
        "uint8 ALL=0 NOT_DEFAULT=1 NOT_CELL=2 NOT_SAVED=3
        string[] axes
        uint8 which
        ---
        bool success
        string message text",
    ),
    (
        "srv/ImportParameters",
        "string text
        ---
        bool success
        string message",
    ),
    (
        "srv/SdoRead",
        "string axis backend
        uint8 node
        string object type
        ---
        bool success
        string message
        uint8[] data
        string value type",
    ),
    (
        "srv/SdoWrite",
        "string axis backend
        uint8 node
        string object type value
        ---
        bool success
        string message",
    ),
    (
        "srv/GearOut",
        "uint8 NOW=0 MASTER_POSITION=1 POSITION=2
        uint8 STOP=0 KEEP_VELOCITY=1 AS_GOAL=2
        string axis
        uint8 at
        int64 increments
        uint8 disengage
        ---
        bool success
        string message",
    ),
    (
        "srv/TouchProbe",
        "uint8 RISING=0 FALLING=1 BOTH=2 INDEX=3
        uint8 SI=0 AXIS_UNIT=1 INCREMENTS=2
        string axis event
        uint8 edge
        bool continuous
        uint8 units
        bool window_only
        float64 first_position last_position
        ---
        bool success
        string message",
    ),
    (
        "srv/AbortTrigger",
        "string axis event
        ---
        bool success
        string message",
    ),
    (
        "srv/SetMemory",
        "string[] cells
        float64[] values
        ---
        bool success
        string message",
    ),
    (
        "srv/SetOutput",
        "string[] outputs
        float64[] values
        ---
        bool success
        string message",
    ),
    (
        "srv/SetPosition",
        "string axis
        float64 position
        uint8 units
        ---
        bool success
        string message",
    ),
    (
        "srv/Vocabulary",
        "string axis verb arguments
        ---
        bool success
        string message",
    ),
    (
        "srv/CommandFunction",
        "uint8 RESET=0 START=1 VALUE_NEW=5 READ_VALUE=6
        string function
        uint8 command
        rcl_interfaces/Parameter[] parameters
        ---
        bool success
        string message
        rcl_interfaces/Parameter[] active",
    ),
    (
        "srv/LoadProgram",
        "string program
        uint8[] module
        bool keep_state
        ---
        bool success
        string message",
    ),
    (
        "srv/LoadTable",
        "string table
        int64[] x y
        ---
        bool success
        string message",
    ),
    (
        "srv/GetTable",
        "string table
        ---
        bool success
        string message form
        int64[] x y",
    ),
    (
        "msg/FunctionState",
        "string name type
        uint16 slot
        bool active
        uint32 error_code
        int64 sink
        uint8 inputs outputs
        int64 sak_share",
    ),
    (
        "msg/FunctionStates",
        "std_msgs/Header header
        uint64 cycle
        lineshaft_msgs/FunctionState[] functions",
    ),
];

/// Layouts of other packages in which errors are likely, in the same form.
const FOREIGN_INTERFACES: [(&str, &str, &str); 30] = [
    (
        "control_msgs",
        "msg/JointTrajectoryControllerState",
        "std_msgs/Header header
        string[] joint_names
        trajectory_msgs/JointTrajectoryPoint reference feedback error output
        string[] multi_dof_joint_names
        trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_reference multi_dof_feedback multi_dof_error multi_dof_output
        float64 speed_scaling_factor",
    ),
    ("control_msgs", "msg/GripperCommand", "float64 position max_effort"),
    (
        "control_msgs",
        "action/GripperCommand",
        "control_msgs/GripperCommand command
        ---
        float64 position effort
        bool stalled reached_goal
        ---
        float64 position effort
        bool stalled reached_goal",
    ),
    (
        "control_msgs",
        "action/ParallelGripperCommand",
        "sensor_msgs/JointState command
        ---
        sensor_msgs/JointState state
        bool stalled reached_goal
        ---
        sensor_msgs/JointState state",
    ),
    (
        "control_msgs",
        "srv/QueryTrajectoryState",
        "builtin_interfaces/Time time
        ---
        bool success
        string message
        string[] name
        float64[] position velocity acceleration",
    ),
    ("controller_manager_msgs", "srv/LoadController", "string name\n---\nbool ok"),
    ("controller_manager_msgs", "srv/UnloadController", "string name\n---\nbool ok"),
    ("controller_manager_msgs", "srv/ReloadControllerLibraries", "bool force_kill\n---\nbool ok"),
    ("builtin_interfaces", "msg/Time", "int32 sec\nuint32 nanosec"),
    ("std_msgs", "msg/Header", "builtin_interfaces/Time stamp\nstring frame_id"),
    ("std_srvs", "srv/Trigger", "---\nbool success\nstring message"),
    (
        "rcl_interfaces",
        "msg/Log",
        "byte DEBUG=10 INFO=20 WARN=30 ERROR=40 FATAL=50
        builtin_interfaces/Time stamp
        uint8 level
        string name msg file function
        uint32 line",
    ),
    (
        "rcl_interfaces",
        "msg/ParameterDescriptor",
        "string name
        uint8 type
        string description additional_constraints
        bool read_only dynamic_typing
        rcl_interfaces/FloatingPointRange[<=1] floating_point_range
        rcl_interfaces/IntegerRange[<=1] integer_range",
    ),
    (
        "rcl_interfaces",
        "msg/ParameterValue",
        "uint8 type
        bool bool_value
        int64 integer_value
        float64 double_value
        string string_value
        byte[] byte_array_value
        bool[] bool_array_value
        int64[] integer_array_value
        float64[] double_array_value
        string[] string_array_value",
    ),
    (
        "rcl_interfaces",
        "msg/ParameterEvent",
        "builtin_interfaces/Time stamp
        string node
        rcl_interfaces/Parameter[] new_parameters changed_parameters deleted_parameters",
    ),
    (
        "rcl_interfaces",
        "srv/ListParameters",
        "uint64 DEPTH_RECURSIVE=0
        string[] prefixes
        uint64 depth
        ---
        rcl_interfaces/ListParametersResult result",
    ),
    ("rmw_dds_common", "msg/Gid", "uint8[16] data"),
    (
        "rmw_dds_common",
        "msg/NodeEntitiesInfo",
        "string<=256 node_namespace node_name\nrmw_dds_common/Gid[] reader_gid_seq writer_gid_seq",
    ),
    ("unique_identifier_msgs", "msg/UUID", "uint8[16] uuid"),
    (
        "can_msgs",
        "msg/Frame",
        "std_msgs/Header header
        uint32 id
        bool is_rtr is_extended is_error
        uint8 dlc
        uint8[8] data",
    ),
    (
        "controller_manager_msgs",
        "msg/ChainConnection",
        "string name
        string[] reference_interfaces",
    ),
    (
        "controller_manager_msgs",
        "msg/ControllerState",
        "string name state type
        bool is_async
        uint16 update_rate
        string[] claimed_interfaces required_command_interfaces required_state_interfaces
        bool is_chainable is_chained
        string[] exported_state_interfaces reference_interfaces
        controller_manager_msgs/ChainConnection[] chain_connections",
    ),
    (
        "controller_manager_msgs",
        "msg/HardwareInterface",
        "string name data_type
        bool is_available is_claimed",
    ),
    (
        "controller_manager_msgs",
        "msg/HardwareComponentState",
        "string name type
        bool is_async
        uint16 rw_rate
        string class_type plugin_name
        lifecycle_msgs/State state
        controller_manager_msgs/HardwareInterface[] command_interfaces state_interfaces",
    ),
    (
        "controller_manager_msgs",
        "srv/ListControllers",
        "---
        controller_manager_msgs/ControllerState[] controller",
    ),
    (
        "controller_manager_msgs",
        "srv/ListControllerTypes",
        "---
        string[] types base_classes",
    ),
    (
        "controller_manager_msgs",
        "srv/ListHardwareComponents",
        "---
        controller_manager_msgs/HardwareComponentState[] component",
    ),
    (
        "controller_manager_msgs",
        "srv/ListHardwareInterfaces",
        "---
        controller_manager_msgs/HardwareInterface[] command_interfaces state_interfaces",
    ),
    (
        "controller_manager_msgs",
        "srv/SwitchController",
        "int32 BEST_EFFORT=1 STRICT=2 AUTO=3 FORCE_AUTO=4
        string[] activate_controllers deactivate_controllers
        int32 strictness
        bool activate_asap
        builtin_interfaces/Duration timeout
        ---
        bool ok
        string message",
    ),
    ("sensor_msgs", "msg/JointState", "std_msgs/Header header\nstring[] name\nfloat64[] position velocity effort"),
];

fn interfaces() -> Vec<Interface> {
    read_all(Path::new(env!("CARGO_MANIFEST_DIR"))).expect("every file parses")
}

/// Returns `type name` or `type NAME=value`, constants first, one list per part.
fn declared(interface: &Interface) -> Vec<Vec<String>> {
    let part = |section: &Section| {
        let constants = section.constants.iter().map(|c| format!("{} {}={}", c.primitive.name, c.name, c.value));
        let fields = section.fields.iter().map(|field: &Field| format!("{} {}", field.type_text(), field.name));
        constants.chain(fields).collect()
    };
    interface.sections.iter().map(part).collect()
}

fn expected(packed: &str) -> Vec<Vec<String>> {
    let mut parts = vec![Vec::new()];
    for line in packed.lines().map(str::trim) {
        match line.split_once(' ') {
            None => parts.push(Vec::new()),
            Some((kind, names)) => {
                let last = parts.last_mut().expect("there is a first part");
                last.extend(names.split(' ').map(|name| format!("{kind} {name}")));
            }
        }
    }
    parts
}

#[test]
fn own_files_are_those_of_the_contract_to_the_letter() {
    let interfaces = interfaces();
    let own: Vec<&Interface> = interfaces.iter().filter(|interface| interface.package == OWN).collect();
    for (path, packed) in OWN_INTERFACES {
        let found = own.iter().find(|i| format!("{}/{}", i.kind.name(), i.name) == path);
        assert_eq!(declared(found.expect(path)), expected(packed), "{path}");
    }
    assert_eq!(own.len(), OWN_INTERFACES.len(), "an interface that the contract does not have");
}

#[test]
fn foreign_files_have_the_layout_that_the_wire_needs() {
    let interfaces = interfaces();
    for (package, path, packed) in FOREIGN_INTERFACES {
        let found = interfaces.iter().find(|i| i.package == package && format!("{}/{}", i.kind.name(), i.name) == path);
        assert_eq!(declared(found.expect(path)), expected(packed), "{package}/{path}");
    }
}

#[test]
fn a_goal_of_move_axis_has_its_fields_in_order() {
    let interfaces = interfaces();
    let move_axis = interfaces.iter().find(|interface| interface.name == "MoveAxis").unwrap();
    let fields: Vec<String> =
        move_axis.sections[0].fields.iter().map(|field| format!("{} {}", field.type_text(), field.name)).collect();
    let written = [
        "string axis",
        "uint8 mode",
        "uint8 units",
        "float64 position",
        "float64 velocity",
        "float64 acceleration",
        "float64 deceleration",
        "float64 jerk",
        "uint8 buffer_mode",
        "uint8 direction",
    ];
    assert_eq!(fields, written);
}

macro_rules! constants {
    ($number:ty: $($of:ident { $($name:ident = $value:literal),* })*) => {
        $($(assert_eq!(<$of>::$name, $value as $number, "{}", stringify!($of::$name));)*)*
    };
}

#[test]
fn every_constant_has_its_value() {
    constants! { u8:
        AxisState {
            DISABLED = 0, STANDSTILL = 1, DISCRETE_MOTION = 2, CONTINUOUS_MOTION = 3, HOMING = 4,
            SYNCHRONIZED_MOTION = 5, STOPPING = 6, ERROR_STOP = 7
        }
        Event { INFO = 0, WARN = 1, ERROR = 2 }
        CycleInputs { FALLING = 0, RISING = 1, ACTIVE = 0, PASSIVE = 1, OFF = 2 }
        MoveAxisGoal {
            ABSOLUTE = 0, RELATIVE = 1, ADDITIVE = 2, VELOCITY = 3, SUPERIMPOSED = 4, SI = 0, AXIS_UNIT = 1,
            INCREMENTS = 2, ABORTING = 0, BUFFERED = 1, BLENDING_LOW = 2, BLENDING_PREVIOUS = 3, BLENDING_NEXT = 4,
            BLENDING_HIGH = 5, SHORTEST = 0, POSITIVE = 1, NEGATIVE = 2, CURRENT = 3
        }
        ProbeAxisGoal {
            ABSOLUTE = 0, RELATIVE = 1, SI = 0, AXIS_UNIT = 1, INCREMENTS = 2, RISING = 0, FALLING = 1, BOTH = 2
        }
        ProbeAxisFeedback { SEARCHING = 0, PROBED = 1 }
        HomeAxisGoal { CONFIGURED = 0, CIA402 = 1, MACS = 2 }
        HomeAxisFeedback {
            SEARCH_SWITCH = 1, LEAVE_SWITCH = 2, SEARCH_INDEX = 3, MOVE_TO_OFFSET = 4, IN_DRIVE = 5
        }
        SynchronizeGoal {
            VELOCITY = 0, POSITION = 1, MARKER = 2, CAM = 3, CAM_MASTER_MARKER = 4, CAM_SLAVE_MARKER = 5,
            IMMEDIATELY = 0, AT_POSITION = 1, ON_EVENT = 2, STOP = 0, KEEP_VELOCITY = 1, ABSOLUTE = 0, RELATIVE = 1, RAMP_IN = 2
        }
        SynchronizeFeedback { WAITING = 0, CATCHING_UP = 1, SYNCHRONIZED = 2 }
        CommandFunctionRequest { RESET = 0, START = 1, VALUE_NEW = 5, READ_VALUE = 6 }
        ResetParametersRequest { USER = 0, INIT = 1 }
        ExportParametersRequest { ALL = 0, NOT_DEFAULT = 1, NOT_CELL = 2, NOT_SAVED = 3 }
        Log { DEBUG = 10, INFO = 20, WARN = 30, ERROR = 40, FATAL = 50 }
        ParameterType {
            PARAMETER_NOT_SET = 0, PARAMETER_BOOL = 1, PARAMETER_INTEGER = 2, PARAMETER_DOUBLE = 3,
            PARAMETER_STRING = 4, PARAMETER_BYTE_ARRAY = 5, PARAMETER_BOOL_ARRAY = 6, PARAMETER_INTEGER_ARRAY = 7,
            PARAMETER_DOUBLE_ARRAY = 8, PARAMETER_STRING_ARRAY = 9
        }
    }
    constants! { i8:
        GoalStatus {
            STATUS_UNKNOWN = 0, STATUS_ACCEPTED = 1, STATUS_EXECUTING = 2, STATUS_CANCELING = 3, STATUS_SUCCEEDED = 4,
            STATUS_CANCELED = 5, STATUS_ABORTED = 6
        }
        CancelGoalResponse {
            ERROR_NONE = 0, ERROR_REJECTED = 1, ERROR_UNKNOWN_GOAL_ID = 2, ERROR_GOAL_TERMINATED = 3
        }
    }
    constants! { i32: SwitchControllerRequest { BEST_EFFORT = 1, STRICT = 2, AUTO = 3, FORCE_AUTO = 4 } }
    constants! { u64: ListParametersRequest { DEPTH_RECURSIVE = 0 } }
}

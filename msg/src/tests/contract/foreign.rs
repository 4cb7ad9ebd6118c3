//! Interfaces of other packages.

/// Layouts of other packages in which errors are likely, in the form of `OWN_INTERFACES`.
pub(super) const FOREIGN_INTERFACES: [(&str, &str, &str); 30] = [
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

//! Interfaces of Lineshaft as in the contract.

/// Types with their names, as in section 7 of the contract; `---` between the parts.
pub(super) const OWN_INTERFACES: [(&str, &str); 37] = [
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

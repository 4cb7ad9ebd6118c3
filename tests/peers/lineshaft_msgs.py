"""The interfaces of the package lineshaft_msgs, from docs/contract.md, section 7, not from the node's own types."""
from dataclasses import dataclass, field

from cyclonedds.idl import IdlStruct, types as t

from ros2wire import Header, Parameter

AXIS_STATES = ("DISABLED", "STANDSTILL", "DISCRETE_MOTION", "CONTINUOUS_MOTION", "HOMING", "SYNCHRONIZED_MOTION",
               "STOPPING", "ERROR_STOP")
MOVE_MODES = ("absolute", "relative", "additive", "velocity", "superimposed")
UNITS = ("si", "axis_unit", "increments")
SIDES = ("slave", "master")
ENGAGES = ("immediately", "at_position", "on_event", "at_end")
SYNC_MODES = ("velocity", "position", "marker", "cam", "cam_master_marker", "cam_slave_marker")
LEAVE_AT = ("now", "master_position", "position")
DISENGAGES = ("stop", "keep_velocity", "as_goal")
CAM_STARTS = ("absolute", "relative", "ramp_in")
EDGES = ("rising", "falling", "both", "index")
LAYERS = ("user", "init")
EXPORTS = ("all", "not_default", "not_cell", "not_saved")
RECORD_COMMANDS = ("status", "start", "stop", "save")


@dataclass
class AxisState(IdlStruct, typename="lineshaft_msgs::msg::dds_::AxisState_"):
    name: str = ""
    state: t.uint8 = 0
    drive_state: t.uint8 = 0
    reference: t.uint8 = 0
    mode_of_operation: t.int8 = 0
    enabled: bool = False
    homed: bool = False
    in_position: bool = False
    in_velocity: bool = False
    in_sync: bool = False
    warning: bool = False
    positive_limit: bool = False
    negative_limit: bool = False
    error_code: t.uint32 = 0
    command_position: t.float64 = 0.0
    command_velocity: t.float64 = 0.0
    command_acceleration: t.float64 = 0.0
    position: t.float64 = 0.0
    velocity: t.float64 = 0.0
    effort: t.float64 = 0.0
    following_error: t.float64 = 0.0
    sync_error: t.float64 = 0.0
    command_increments: t.int64 = 0
    position_increments: t.int64 = 0
    following_error_increments: t.int64 = 0
    sync_error_increments: t.int64 = 0


@dataclass
class AxisStates(IdlStruct, typename="lineshaft_msgs::msg::dds_::AxisStates_"):
    header: Header = field(default_factory=Header)
    cycle: t.uint64 = 0
    axes: t.sequence[AxisState] = field(default_factory=list)


@dataclass
class Event(IdlStruct, typename="lineshaft_msgs::msg::dds_::Event_"):
    header: Header = field(default_factory=Header)
    sequence: t.uint64 = 0
    cycle: t.uint64 = 0
    age_ns: t.uint32 = 0
    severity: t.uint8 = 0
    kind: str = ""
    source: str = ""
    code: t.uint32 = 0
    increments: t.int64 = 0
    fraction: t.float64 = 0.0
    value: t.float64 = 0.0
    text: str = ""


@dataclass
class Answer(IdlStruct, typename="Answer"):
    """The response of every service that answers with no more than that."""
    success: bool = False
    message: str = ""


@dataclass
class AxesRequest(IdlStruct, typename="AxesRequest"):
    axes: t.sequence[str] = field(default_factory=list)


@dataclass
class ResetRequest(IdlStruct, typename="ResetRequest"):
    axes: t.sequence[str] = field(default_factory=list)
    layer: t.uint8 = 0


@dataclass
class ExportRequest(IdlStruct, typename="ExportRequest"):
    axes: t.sequence[str] = field(default_factory=list)
    which: t.uint8 = 0


@dataclass
class ExportResponse(IdlStruct, typename="ExportResponse"):
    success: bool = False
    message: str = ""
    text: str = ""


@dataclass
class ImportRequest(IdlStruct, typename="ImportRequest"):
    text: str = ""


@dataclass
class MoveGoal(IdlStruct, typename="MoveGoal"):
    axis: str = ""
    mode: t.uint8 = 0
    units: t.uint8 = 0
    position: t.float64 = 0.0
    velocity: t.float64 = 0.0
    acceleration: t.float64 = 0.0
    deceleration: t.float64 = 0.0
    jerk: t.float64 = 0.0
    buffer_mode: t.uint8 = 0
    direction: t.uint8 = 0


@dataclass
class MoveResult(IdlStruct, typename="MoveResult"):
    code: t.uint32 = 0
    message: str = ""
    position: t.float64 = 0.0
    position_increments: t.int64 = 0


@dataclass
class MoveFeedback(IdlStruct, typename="MoveFeedback"):
    position: t.float64 = 0.0
    velocity: t.float64 = 0.0
    distance_to_go: t.float64 = 0.0
    position_increments: t.int64 = 0


@dataclass
class SyncGoal(IdlStruct, typename="SyncGoal"):
    axis: str = ""
    master: str = ""
    event: str = ""
    mode: t.uint8 = 0
    engage: t.uint8 = 0
    disengage: t.uint8 = 0
    numerator: t.int64 = 0
    denominator: t.int64 = 0
    master_increments: t.int64 = 0
    slave_increments: t.int64 = 0
    start_distance_increments: t.int64 = 0
    offset: t.float64 = 0.0
    velocity: t.float64 = 0.0
    acceleration: t.float64 = 0.0
    table: str = ""
    cam_start: t.uint8 = 0
    master_scale: t.float64 = 0.0
    slave_scale: t.float64 = 0.0
    master_offset: t.float64 = 0.0
    slave_offset: t.float64 = 0.0


@dataclass
class SyncResult(IdlStruct, typename="SyncResult"):
    code: t.uint32 = 0
    message: str = ""
    position_increments: t.int64 = 0


@dataclass
class SyncFeedback(IdlStruct, typename="SyncFeedback"):
    phase: t.uint8 = 0
    sync_error_increments: t.int64 = 0
    sync_error: t.float64 = 0.0
    marker_error: t.float64 = 0.0
    correction: t.float64 = 0.0


@dataclass
class PhaseGoal(IdlStruct, typename="PhaseGoal"):
    axis: str = ""
    side: t.uint8 = 0
    shift: t.float64 = 0.0
    velocity: t.float64 = 0.0
    acceleration: t.float64 = 0.0


@dataclass
class PhaseResult(IdlStruct, typename="PhaseResult"):
    code: t.uint32 = 0
    message: str = ""


@dataclass
class PhaseFeedback(IdlStruct, typename="PhaseFeedback"):
    remaining: t.float64 = 0.0


@dataclass
class RunGoal(IdlStruct, typename="RunFunctionGoal"):
    function: str = ""
    parameters: t.sequence[Parameter] = field(default_factory=list)


@dataclass
class RunResult(IdlStruct, typename="RunFunctionResult"):
    code: t.uint32 = 0
    message: str = ""
    sink: t.int64 = 0


@dataclass
class RunFeedback(IdlStruct, typename="RunFunctionFeedback"):
    sink: t.int64 = 0
    inputs: t.uint8 = 0
    outputs: t.uint8 = 0


@dataclass
class ProbeGoal(IdlStruct, typename="ProbeGoal"):
    axis: str = ""
    mode: t.uint8 = 0
    units: t.uint8 = 0
    position: t.float64 = 0.0
    velocity: t.float64 = 0.0
    acceleration: t.float64 = 0.0
    deceleration: t.float64 = 0.0
    jerk: t.float64 = 0.0
    event: str = ""
    edge: t.uint8 = 0
    distance: t.float64 = 0.0


@dataclass
class ProbeResult(IdlStruct, typename="ProbeResult"):
    code: t.uint32 = 0
    message: str = ""
    probed: bool = False
    probed_position: t.float64 = 0.0
    probed_increments: t.int64 = 0
    position: t.float64 = 0.0
    position_increments: t.int64 = 0


@dataclass
class ProbeFeedback(IdlStruct, typename="ProbeFeedback"):
    phase: t.uint8 = 0
    position: t.float64 = 0.0
    velocity: t.float64 = 0.0
    distance_to_go: t.float64 = 0.0


@dataclass
class VocabularyRequest(IdlStruct, typename="VocabularyRequest"):
    axis: str = ""
    verb: str = ""
    arguments: str = ""


@dataclass
class GearOutRequest(IdlStruct, typename="GearOutRequest"):
    axis: str = ""
    at: t.uint8 = 0
    increments: t.int64 = 0
    disengage: t.uint8 = 0


@dataclass
class TouchProbeRequest(IdlStruct, typename="TouchProbeRequest"):
    axis: str = ""
    event: str = ""
    edge: t.uint8 = 0
    continuous: bool = False
    units: t.uint8 = 0
    window_only: bool = False
    first_position: t.float64 = 0.0
    last_position: t.float64 = 0.0


@dataclass
class AbortTriggerRequest(IdlStruct, typename="AbortTriggerRequest"):
    axis: str = ""
    event: str = ""


@dataclass
class RecordRequest(IdlStruct, typename="RecordRequest"):
    command: t.uint8 = 0
    path: str = ""
    max_bag_size: t.uint64 = 0
    max_bag_duration: t.float64 = 0.0


@dataclass
class RecordResponse(IdlStruct, typename="RecordResponse"):
    success: bool = False
    message: str = ""
    recording: bool = False
    path: str = ""
    cycles: t.uint64 = 0
    size: t.uint64 = 0
    lost: t.uint64 = 0
    replayable: bool = False


# Action name: its type and the bodies of goal, result and feedback.
ACTIONS = {
    "move_axis": ("lineshaft_msgs/MoveAxis", MoveGoal, MoveResult, MoveFeedback),
    "probe_axis": ("lineshaft_msgs/ProbeAxis", ProbeGoal, ProbeResult, ProbeFeedback),
    "run_function": ("lineshaft_msgs/RunFunction", RunGoal, RunResult, RunFeedback),
    "phase": ("lineshaft_msgs/Phase", PhaseGoal, PhaseResult, PhaseFeedback),
    "synchronize": ("lineshaft_msgs/Synchronize", SyncGoal, SyncResult, SyncFeedback),
}

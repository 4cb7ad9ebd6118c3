"""ROS 2 on the wire with Eclipse Cyclone DDS, without a ROS installation.

Speaks topics, services, parameters and actions with the DDS names and types that rmw_cyclonedds_cpp puts on the wire,
so that a node can be checked against a DDS implementation that is not its own. A request and its reply carry
rmw_cyclonedds' 16 byte header {uint64 client, int64 sequence} in the payload.
"""
import json
import os
import time
import uuid
from dataclasses import dataclass, field

LO_CONFIG = """<CycloneDDS><Domain Id="any">
<General><Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces>
<AllowMulticast>false</AllowMulticast></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>30</MaxAutoParticipantIndex>
<Peers><Peer address="127.0.0.1"/></Peers></Discovery></Domain></CycloneDDS>"""
os.environ.setdefault("CYCLONEDDS_URI", LO_CONFIG)  # loopback only, unicast discovery

from cyclonedds.core import Policy, Qos  # noqa: E402
from cyclonedds.domain import DomainParticipant  # noqa: E402
from cyclonedds.idl import IdlStruct, types as t  # noqa: E402
from cyclonedds.pub import DataWriter  # noqa: E402
from cyclonedds.sub import DataReader  # noqa: E402
from cyclonedds.topic import Topic  # noqa: E402
from cyclonedds.util import duration  # noqa: E402


def qos(reliable=True, transient_local=False, depth=10):
    return Qos(
        Policy.Reliability.Reliable(duration(seconds=1)) if reliable else Policy.Reliability.BestEffort,
        Policy.Durability.TransientLocal if transient_local else Policy.Durability.Volatile,
        Policy.History.KeepLast(depth),
        Policy.DataRepresentation(use_cdrv0_representation=True),  # ROS 2 is XCDR1
    )


SERVICE_QOS = qos(depth=10)  # rmw_qos_profile_services_default
PARAMETER_QOS = qos(depth=1000)  # rmw_qos_profile_parameters
ROSOUT_QOS = qos(transient_local=True, depth=1000)
ERRORS_QOS = qos(transient_local=True, depth=32)
STATUS_QOS = qos(transient_local=True, depth=1)  # rcl_action_qos_profile_status_default
DISCOVERY_QOS = qos(transient_local=True, depth=1)


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: t.int32 = 0
    nanosec: t.uint32 = 0


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time = field(default_factory=Time)
    frame_id: str = ""


@dataclass
class Text(IdlStruct, typename="std_msgs::msg::dds_::String_"):
    data: str = ""


@dataclass
class JointState(IdlStruct, typename="sensor_msgs::msg::dds_::JointState_"):
    header: Header = field(default_factory=Header)
    name: t.sequence[str] = field(default_factory=list)
    position: t.sequence[t.float64] = field(default_factory=list)
    velocity: t.sequence[t.float64] = field(default_factory=list)
    effort: t.sequence[t.float64] = field(default_factory=list)


@dataclass
class Log(IdlStruct, typename="rcl_interfaces::msg::dds_::Log_"):
    stamp: Time = field(default_factory=Time)
    level: t.uint8 = 0
    name: str = ""
    msg: str = ""
    file: str = ""
    function: str = ""
    line: t.uint32 = 0


# ros_discovery_info (rmw_dds_common). Gid is 16 bytes since Iron, 24 before.
@dataclass
class Gid(IdlStruct, typename="rmw_dds_common::msg::dds_::Gid_"):
    data: t.array[t.uint8, 16] = field(default_factory=lambda: [0] * 16)


@dataclass
class NodeEntitiesInfo(IdlStruct, typename="rmw_dds_common::msg::dds_::NodeEntitiesInfo_"):
    node_namespace: str = ""
    node_name: str = ""
    reader_gid_seq: t.sequence[Gid] = field(default_factory=list)
    writer_gid_seq: t.sequence[Gid] = field(default_factory=list)


@dataclass
class ParticipantEntitiesInfo(IdlStruct, typename="rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"):
    gid: Gid = field(default_factory=Gid)
    node_entities_info_seq: t.sequence[NodeEntitiesInfo] = field(default_factory=list)


# Parameters (rcl_interfaces).
@dataclass
class ParameterValue(IdlStruct, typename="rcl_interfaces::msg::dds_::ParameterValue_"):
    type: t.uint8 = 0
    bool_value: bool = False
    integer_value: t.int64 = 0
    double_value: t.float64 = 0.0
    string_value: str = ""
    byte_array_value: t.sequence[t.uint8] = field(default_factory=list)
    bool_array_value: t.sequence[bool] = field(default_factory=list)
    integer_array_value: t.sequence[t.int64] = field(default_factory=list)
    double_array_value: t.sequence[t.float64] = field(default_factory=list)
    string_array_value: t.sequence[str] = field(default_factory=list)

    FIELDS = (None, "bool_value", "integer_value", "double_value", "string_value", "byte_array_value",
              "bool_array_value", "integer_array_value", "double_array_value", "string_array_value")

    def get(self):
        name = ParameterValue.FIELDS[self.type]
        return None if name is None else getattr(self, name)

    @staticmethod
    def of(v):
        if v is None:
            return ParameterValue()
        if isinstance(v, bool):
            kind = 1
        elif isinstance(v, int):
            kind = 2
        elif isinstance(v, float):
            kind = 3
        elif isinstance(v, str):
            kind = 4
        elif isinstance(v, (bytes, bytearray)):
            kind, v = 5, list(v)
        elif all(isinstance(x, bool) for x in v):
            kind = 6
        elif all(isinstance(x, int) for x in v):
            kind = 7
        elif all(isinstance(x, float) for x in v):
            kind = 8
        else:
            kind = 9
        p = ParameterValue(type=kind)
        setattr(p, ParameterValue.FIELDS[kind], v)
        return p


@dataclass
class Parameter(IdlStruct, typename="rcl_interfaces::msg::dds_::Parameter_"):
    name: str = ""
    value: ParameterValue = field(default_factory=ParameterValue)


@dataclass
class ParameterEvent(IdlStruct, typename="rcl_interfaces::msg::dds_::ParameterEvent_"):
    stamp: Time = field(default_factory=Time)
    node: str = ""
    new_parameters: t.sequence[Parameter] = field(default_factory=list)
    changed_parameters: t.sequence[Parameter] = field(default_factory=list)
    deleted_parameters: t.sequence[Parameter] = field(default_factory=list)


@dataclass
class SetParametersResult(IdlStruct, typename="rcl_interfaces::msg::dds_::SetParametersResult_"):
    successful: bool = False
    reason: str = ""


@dataclass
class FloatRange(IdlStruct, typename="rcl_interfaces::msg::dds_::FloatingPointRange_"):
    from_value: t.float64 = 0.0
    to_value: t.float64 = 0.0
    step: t.float64 = 0.0


@dataclass
class IntRange(IdlStruct, typename="rcl_interfaces::msg::dds_::IntegerRange_"):
    from_value: t.int64 = 0
    to_value: t.int64 = 0
    step: t.uint64 = 0


@dataclass
class ParameterDescriptor(IdlStruct, typename="rcl_interfaces::msg::dds_::ParameterDescriptor_"):
    name: str = ""
    type: t.uint8 = 0
    description: str = ""
    additional_constraints: str = ""
    read_only: bool = False
    dynamic_typing: bool = False
    floating_point_range: t.sequence[FloatRange] = field(default_factory=list)
    integer_range: t.sequence[IntRange] = field(default_factory=list)


@dataclass
class ListParametersResult(IdlStruct, typename="rcl_interfaces::msg::dds_::ListParametersResult_"):
    names: t.sequence[str] = field(default_factory=list)
    prefixes: t.sequence[str] = field(default_factory=list)


@dataclass
class NamesRequest(IdlStruct, typename="NamesRequest"):
    names: t.sequence[str] = field(default_factory=list)


@dataclass
class ListRequest(IdlStruct, typename="ListRequest"):
    prefixes: t.sequence[str] = field(default_factory=list)
    depth: t.uint64 = 0


@dataclass
class ParametersRequest(IdlStruct, typename="ParametersRequest"):
    parameters: t.sequence[Parameter] = field(default_factory=list)


@dataclass
class GetResponse(IdlStruct, typename="GetResponse"):
    values: t.sequence[ParameterValue] = field(default_factory=list)


@dataclass
class TypesResponse(IdlStruct, typename="TypesResponse"):
    types: t.sequence[t.uint8] = field(default_factory=list)


@dataclass
class SetResponse(IdlStruct, typename="SetResponse"):
    results: t.sequence[SetParametersResult] = field(default_factory=list)


@dataclass
class SetAtomicallyResponse(IdlStruct, typename="SetAtomicallyResponse"):
    result: SetParametersResult = field(default_factory=SetParametersResult)


@dataclass
class ListResponse(IdlStruct, typename="ListResponse"):
    result: ListParametersResult = field(default_factory=ListParametersResult)


@dataclass
class DescribeResponse(IdlStruct, typename="DescribeResponse"):
    descriptors: t.sequence[ParameterDescriptor] = field(default_factory=list)


# Actions (action_msgs, unique_identifier_msgs).
@dataclass
class UUID(IdlStruct, typename="unique_identifier_msgs::msg::dds_::UUID_"):
    uuid: t.array[t.uint8, 16] = field(default_factory=lambda: [0] * 16)

    @staticmethod
    def random():
        return UUID(list(uuid.uuid4().bytes))

    @staticmethod
    def of_hex(text):
        return UUID(list(bytes.fromhex(text)))

    def hex(self):
        return bytes(self.uuid).hex()


@dataclass
class GoalInfo(IdlStruct, typename="action_msgs::msg::dds_::GoalInfo_"):
    goal_id: UUID = field(default_factory=UUID)
    stamp: Time = field(default_factory=Time)


@dataclass
class GoalStatus(IdlStruct, typename="action_msgs::msg::dds_::GoalStatus_"):
    goal_info: GoalInfo = field(default_factory=GoalInfo)
    status: t.int8 = 0


@dataclass
class GoalStatusArray(IdlStruct, typename="action_msgs::msg::dds_::GoalStatusArray_"):
    status_list: t.sequence[GoalStatus] = field(default_factory=list)


@dataclass
class SendGoalResponse(IdlStruct, typename="SendGoalResponse"):
    accepted: bool = False
    stamp: Time = field(default_factory=Time)


@dataclass
class CancelGoalRequest(IdlStruct, typename="CancelGoalRequest"):
    goal_info: GoalInfo = field(default_factory=GoalInfo)


@dataclass
class CancelGoalResponse(IdlStruct, typename="CancelGoalResponse"):
    return_code: t.int8 = 0  # 0 none, 1 rejected, 2 unknown goal, 3 already terminated
    goals_canceling: t.sequence[GoalInfo] = field(default_factory=list)


@dataclass
class GetResultRequest(IdlStruct, typename="GetResultRequest"):
    goal_id: UUID = field(default_factory=UUID)


STATUS = {0: "UNKNOWN", 1: "ACCEPTED", 2: "EXECUTING", 3: "CANCELING", 4: "SUCCEEDED", 5: "CANCELED", 6: "ABORTED"}


def with_header(body, typename):
    @dataclass
    class Wrapped(IdlStruct, typename=typename):
        client: t.uint64
        seq: t.int64
        data: body
    return Wrapped


def parsed(text):
    """A parameter value from JSON; what is not JSON is a string."""
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        return text


def dds_type(kind, full, suffix=""):
    pkg, name = full.split("/")
    return f"{pkg}::{kind}::dds_::{name}{suffix}_"


MATCH_S = 20.0  # seconds; generous, because the tests share two cores with a compiler
REPLY_S = 10.0


def wait_until(cond, timeout, what="condition"):
    end = time.monotonic() + timeout
    while not cond():
        if time.monotonic() > end:
            raise TimeoutError(what)
        time.sleep(0.001)


class Subscription:
    def __init__(self, dp, topic, cls, q, prefix="rt"):
        name = prefix + topic
        self.name = topic
        self.reader = DataReader(dp, Topic(dp, name, cls, qos=q), qos=q)

    def wait(self, timeout=MATCH_S):
        wait_until(self.reader.get_matched_publications, timeout, f"nobody publishes {self.name}")
        return self

    def take(self):
        # A sample without valid data says that a writer has gone.
        return [s for s in self.reader.take(1000) if s.sample_info.valid_data]


def publisher(dp, topic, cls, q):
    return DataWriter(dp, Topic(dp, "rt" + topic, cls, qos=q), qos=q)


class ServiceClient:
    """`name` like /node/enable, `srv` like lineshaft_msgs/AxesCommand; `kind` is srv or action; `own` is another QoS of this
    client than that of the topic."""

    def __init__(self, dp, name, srv, req, resp, kind="srv", q=SERVICE_QOS, own=None):
        self.name = name
        self.Req = with_header(req, dds_type(kind, srv, "_Request"))
        self.Resp = with_header(resp, dds_type(kind, srv, "_Response"))
        # As rmw_cyclonedds marks the two ends of a client: a participant may have two of one service.
        ends = Qos(Policy.Userdata(f"clientid={uuid.uuid4().hex};".encode()), base=own or q)
        self.w = DataWriter(dp, Topic(dp, f"rq{name}Request", self.Req, qos=q), qos=ends)
        self.r = DataReader(dp, Topic(dp, f"rr{name}Reply", self.Resp, qos=q), qos=ends)
        self.client = int.from_bytes(self.w.guid.bytes[8:16], "little")
        self.seq = 0
        self.replies = {}

    def wait(self, timeout=MATCH_S):
        wait_until(lambda: self.w.get_matched_subscriptions() and self.r.get_matched_publications(), timeout,
                   f"nobody serves {self.name}")
        return self

    def send(self, data):
        self.seq += 1
        self.w.write(self.Req(self.client, self.seq, data))
        return self.seq

    def receive(self, seq, timeout=REPLY_S):
        def arrived():
            for m in self.r.take(100):
                if m.sample_info.valid_data and m.client == self.client:
                    self.replies[m.seq] = m.data
            return seq in self.replies
        wait_until(arrived, timeout, f"no reply from {self.name}")
        return self.replies.pop(seq)

    def call(self, data, timeout=REPLY_S):
        return self.receive(self.send(data), timeout)


class ParameterClient:
    def __init__(self, dp, node):
        def c(name, srv, req, resp):
            return ServiceClient(dp, f"{node}/{name}", f"rcl_interfaces/{srv}", req, resp, q=PARAMETER_QOS)
        self.c_list = c("list_parameters", "ListParameters", ListRequest, ListResponse)
        self.c_get = c("get_parameters", "GetParameters", NamesRequest, GetResponse)
        self.c_types = c("get_parameter_types", "GetParameterTypes", NamesRequest, TypesResponse)
        self.c_set = c("set_parameters", "SetParameters", ParametersRequest, SetResponse)
        self.c_atomic = c("set_parameters_atomically", "SetParametersAtomically", ParametersRequest,
                          SetAtomicallyResponse)
        self.c_describe = c("describe_parameters", "DescribeParameters", NamesRequest, DescribeResponse)

    def wait(self):
        for c in (self.c_list, self.c_get, self.c_types, self.c_set, self.c_atomic, self.c_describe):
            c.wait()
        return self

    def list(self, prefixes=(), depth=0):
        return self.c_list.call(ListRequest(list(prefixes), depth)).result

    def get(self, *names):
        return [v.get() for v in self.c_get.call(NamesRequest(list(names))).values]

    def types(self, *names):
        return list(self.c_types.call(NamesRequest(list(names))).types)

    def set(self, kv):
        return self.c_set.call(self._req(kv)).results

    def set_atomically(self, kv):
        return self.c_atomic.call(self._req(kv)).result

    def describe(self, *names):
        return self.c_describe.call(NamesRequest(list(names))).descriptors

    @staticmethod
    def _req(kv):
        return ParametersRequest([Parameter(k, ParameterValue.of(v)) for k, v in kv.items()])


class ActionClient:
    """`action` like lineshaft_msgs/MoveAxis; the bodies are the fields of goal, result and feedback."""

    def __init__(self, dp, name, action, goal_t, result_t, feedback_t):
        @dataclass
        class SendGoalRequest(IdlStruct, typename="SendGoalRequest"):
            goal_id: UUID
            goal: goal_t

        @dataclass
        class GetResultResponse(IdlStruct, typename="GetResultResponse"):
            status: t.int8
            result: result_t

        @dataclass
        class FeedbackMessage(IdlStruct, typename=dds_type("action", action, "_FeedbackMessage")):
            goal_id: UUID
            feedback: feedback_t

        self.SendGoalRequest = SendGoalRequest
        base = f"{name}/_action"
        self.c_goal = ServiceClient(dp, f"{base}/send_goal", f"{action}_SendGoal", SendGoalRequest, SendGoalResponse,
                                    kind="action")
        self.c_result = ServiceClient(dp, f"{base}/get_result", f"{action}_GetResult", GetResultRequest,
                                      GetResultResponse, kind="action")
        self.c_cancel = ServiceClient(dp, f"{base}/cancel_goal", "action_msgs/CancelGoal", CancelGoalRequest,
                                      CancelGoalResponse)
        self.s_feedback = Subscription(dp, f"{base}/feedback", FeedbackMessage, qos(depth=10_000))
        self.s_status = Subscription(dp, f"{base}/status", GoalStatusArray, STATUS_QOS)
        self.seen = {}  # goal id in hex: its feedback messages, oldest first
        self.arrays = []  # what statuses() gives next
        self.told = {}  # goal id in hex: the last status that the topic told

    def wait(self):
        for part in (self.c_goal, self.c_result, self.c_cancel, self.s_feedback, self.s_status):
            part.wait()
        return self

    def send_goal(self, goal, goal_id=None):
        gid = goal_id or UUID.random()
        return gid, self.c_goal.call(self.SendGoalRequest(gid, goal))

    def get_result(self, gid, timeout=60.0):
        return self.c_result.call(GetResultRequest(gid), timeout)

    def cancel(self, gid=None, stamp=None):
        return self.c_cancel.call(CancelGoalRequest(GoalInfo(gid or UUID(), stamp or Time())))

    def feedback(self, gid):
        """All feedback of one goal so far."""
        for m in self.s_feedback.take():
            self.seen.setdefault(m.goal_id.hex(), []).append(m.feedback)
        return self.seen.get(gid.hex(), [])

    def take_statuses(self):
        for array in self.s_status.take():
            self.arrays.append({s.goal_info.goal_id.hex(): STATUS[s.status] for s in array.status_list})
            self.told.update(self.arrays[-1])

    def statuses(self):
        """The status arrays that arrived since the last call, each as {goal id: status}."""
        self.take_statuses()
        arrays, self.arrays = self.arrays, []
        return arrays

    def finish(self, gid, timeout=60.0):
        """The result, once the other topics have told the end too: feedback and status may arrive after the result."""
        r = self.get_result(gid, timeout)

        def told():
            self.take_statuses()
            return self.told.get(gid.hex()) == STATUS[r.status]
        if r.status:
            wait_until(told, REPLY_S, f"the status of goal {gid.hex()} does not become {STATUS[r.status]}")
        time.sleep(0.05)  # feedback has no end that can be waited for
        return r


def participant():
    return DomainParticipant(int(os.environ.get("ROS_DOMAIN_ID", "0")))

"""The life cycle of the node, its diagnostics and the statistics of its cycle, as every ROS 2 tool sees them."""
import time
from dataclasses import dataclass, field

from cyclonedds.idl import IdlStruct, types as t

import ros2wire as rw
from report import Failure, show


@dataclass
class State(IdlStruct, typename="lifecycle_msgs::msg::dds_::State_"):
    id: t.uint8 = 0
    label: str = ""


@dataclass
class Transition(IdlStruct, typename="lifecycle_msgs::msg::dds_::Transition_"):
    id: t.uint8 = 0
    label: str = ""


@dataclass
class TransitionDescription(IdlStruct, typename="lifecycle_msgs::msg::dds_::TransitionDescription_"):
    transition: Transition = field(default_factory=Transition)
    start_state: State = field(default_factory=State)
    goal_state: State = field(default_factory=State)


@dataclass
class TransitionEvent(IdlStruct, typename="lifecycle_msgs::msg::dds_::TransitionEvent_"):
    timestamp: t.uint64 = 0
    transition: Transition = field(default_factory=Transition)
    start_state: State = field(default_factory=State)
    goal_state: State = field(default_factory=State)


@dataclass
class Empty(IdlStruct, typename="LifecycleRequest"):
    structure_needs_at_least_one_member: t.uint8 = 0


@dataclass
class ChangeStateRequest(IdlStruct, typename="ChangeStateRequest"):
    transition: Transition = field(default_factory=Transition)


@dataclass
class ChangeStateResponse(IdlStruct, typename="ChangeStateResponse"):
    success: bool = False


@dataclass
class GetStateResponse(IdlStruct, typename="GetStateResponse"):
    current_state: State = field(default_factory=State)


@dataclass
class GetAvailableStatesResponse(IdlStruct, typename="GetAvailableStatesResponse"):
    available_states: t.sequence[State] = field(default_factory=list)


@dataclass
class GetAvailableTransitionsResponse(IdlStruct, typename="GetAvailableTransitionsResponse"):
    available_transitions: t.sequence[TransitionDescription] = field(default_factory=list)


@dataclass
class KeyValue(IdlStruct, typename="diagnostic_msgs::msg::dds_::KeyValue_"):
    key: str = ""
    value: str = ""


@dataclass
class DiagnosticStatus(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticStatus_"):
    level: t.byte = 0
    name: str = ""
    message: str = ""
    hardware_id: str = ""
    values: t.sequence[KeyValue] = field(default_factory=list)


@dataclass
class DiagnosticArray(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticArray_"):
    header: rw.Header = field(default_factory=rw.Header)
    status: t.sequence[DiagnosticStatus] = field(default_factory=list)


@dataclass
class CycleStatistics(IdlStruct, typename="lineshaft_msgs::msg::dds_::CycleStatistics_"):
    header: rw.Header = field(default_factory=rw.Header)
    cycle: t.uint64 = 0
    cycle_ns: t.uint32 = 0
    cycles: t.uint64 = 0
    missed: t.uint64 = 0
    period_cycles: t.uint64 = 0
    period_missed: t.uint64 = 0
    lateness_mean: t.float64 = 0.0
    lateness_max: t.uint64 = 0
    lateness_worst: t.uint64 = 0
    duration_mean: t.float64 = 0.0
    duration_max: t.uint64 = 0
    duration_worst: t.uint64 = 0
    events_lost: t.uint64 = 0
    lateness_p50: t.uint64 = 0
    lateness_p99: t.uint64 = 0
    lateness_p999: t.uint64 = 0
    duration_p50: t.uint64 = 0
    duration_p99: t.uint64 = 0
    duration_p999: t.uint64 = 0
    lateness_p50_since_start: t.uint64 = 0
    lateness_p99_since_start: t.uint64 = 0
    lateness_p999_since_start: t.uint64 = 0
    duration_p50_since_start: t.uint64 = 0
    duration_p99_since_start: t.uint64 = 0
    duration_p999_since_start: t.uint64 = 0


ASKED = {"state": ("get_state", "GetState", GetStateResponse, "current_state"),
         "states": ("get_available_states", "GetAvailableStates", GetAvailableStatesResponse, "available_states"),
         "transitions": ("get_available_transitions", "GetAvailableTransitions", GetAvailableTransitionsResponse,
                         "available_transitions"),
         "graph": ("get_transition_graph", "GetAvailableTransitions", GetAvailableTransitionsResponse,
                   "available_transitions")}


def ask(peer, a):
    name, srv, response, what = ASKED[a.what]
    full = f"{a.node}/{name}"
    client = peer.once(full, lambda: rw.ServiceClient(peer.dp, full, f"lifecycle_msgs/{srv}", Empty, response))
    seen = getattr(client.call(Empty()), what)
    if what == "available_transitions":
        seen = [[d.transition.id, d.transition.label, d.start_state.label, d.goal_state.label] for d in seen]
    if what == "available_states":
        seen = [[s.id, s.label] for s in seen]
    show(**{a.what: seen})


def change(peer, a):
    """Asks for each of the transitions, given by id or label, without waiting for the one before."""
    name = f"{a.node}/change_state"
    client = peer.once(name, lambda: rw.ServiceClient(peer.dp, name, "lifecycle_msgs/ChangeState", ChangeStateRequest,
                                                      ChangeStateResponse))
    asked = []
    for word in a.transitions:
        t = Transition(id=int(word)) if word.isdigit() else Transition(label=word)
        asked.append(client.send(ChangeStateRequest(t)))
    show(success=[client.receive(seq, a.timeout).success for seq in asked])


def transition_events(peer, a):
    """All since the last call, the last of which comes to the state `--until`."""
    name = f"{a.node}/transition_event"
    s = peer.once(name, lambda: rw.Subscription(peer.dp, name, TransitionEvent, rw.qos(depth=1000)))
    seen = []

    def arrived():
        seen.extend(s.take())
        return not a.until or any(e.goal_state.label == a.until for e in seen)
    rw.wait_until(arrived, rw.REPLY_S, f"no transition to {a.until}")
    show(events=[[e.transition.id, e.transition.label, e.start_state.label, e.goal_state.label] for e in seen],
         stamped=all(e.timestamp > 1_700_000_000 * 10 ** 9 for e in seen))


def diagnostics(peer, a):
    """What comes within the time; ends with the first array in which `--until NAME=LEVEL` holds."""
    s = peer.once("/diagnostics", lambda: rw.Subscription(peer.dp, "/diagnostics", DiagnosticArray, rw.qos(depth=1000)))
    s.take()
    begin, arrays, times = time.monotonic(), [], []
    name, _, level = a.until.partition("=")
    while time.monotonic() - begin < a.seconds:
        for m in s.take():
            arrays.append(m)
            times.append(time.monotonic() - begin)
            if a.until and any(x.name.endswith(f": {name}") and x.level == int(level) for x in m.status):
                return show_diagnostics(arrays, times)
        time.sleep(0.002)
    if a.until:
        show_diagnostics(arrays, times)
        raise Failure(f"{a.until} has not come within {a.seconds} s")
    show_diagnostics(arrays, times)


def show_diagnostics(arrays, times):
    if not arrays:
        raise Failure("no diagnostics")
    last = {x.name: {"level": x.level, "message": x.message, "hardware_id": x.hardware_id,
                     "values": {v.key: v.value for v in x.values}} for x in arrays[-1].status}
    show(count=len(arrays), times=times, names=[x.name for x in arrays[-1].status], last=last)


def cycle_statistics(peer, a):
    name = f"{a.node}/cycle_statistics"
    s = peer.once(name, lambda: rw.Subscription(peer.dp, name, CycleStatistics, rw.qos(depth=1000)))
    s.take()
    seen = []
    rw.wait_until(lambda: seen.extend(s.take()) or len(seen) >= a.count, a.count * 2 + rw.REPLY_S,
                  f"{len(seen)} statistics, {a.count} wanted")
    show(statistics=seen)


def add_commands(command):
    p = command("lifecycle", ask)
    p.add_argument("what", choices=ASKED)
    p = command("change-state", change, timeout=80.0)
    p.add_argument("transitions", nargs="+", help="ids or labels")
    command("transition-events", transition_events, until="")
    command("diagnostics", diagnostics, seconds=10.0, until="")
    command("cycle-statistics", cycle_statistics, count=1)

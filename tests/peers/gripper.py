"""The actions of grippers."""
from dataclasses import dataclass, field

from cyclonedds.idl import IdlStruct, types as t

import ros2wire as rw
from report import Failure, show


@dataclass
class Command(IdlStruct, typename="control_msgs::msg::dds_::GripperCommand_"):
    position: t.float64 = 0.0
    max_effort: t.float64 = 0.0


@dataclass
class GripperGoal(IdlStruct, typename="GripperGoal"):
    command: Command = field(default_factory=Command)


@dataclass
class GripperState(IdlStruct, typename="GripperState"):
    position: t.float64 = 0.0
    effort: t.float64 = 0.0
    stalled: bool = False
    reached_goal: bool = False


@dataclass
class ParallelGoal(IdlStruct, typename="ParallelGoal"):
    command: rw.JointState = field(default_factory=rw.JointState)


@dataclass
class ParallelResult(IdlStruct, typename="ParallelResult"):
    state: rw.JointState = field(default_factory=rw.JointState)
    stalled: bool = False
    reached_goal: bool = False


@dataclass
class ParallelFeedback(IdlStruct, typename="ParallelFeedback"):
    state: rw.JointState = field(default_factory=rw.JointState)


def gripper(peer, a):
    """Sends a goal, and waits for its end."""
    if a.parallel:
        name, types = "parallel_gripper_cmd", ("control_msgs/ParallelGripperCommand", ParallelGoal, ParallelResult, ParallelFeedback)
        goal = ParallelGoal(rw.JointState(name=a.joint, position=[a.position], velocity=a.velocity,
                                          effort=[a.effort] if a.effort else []))
    else:
        name, types = "gripper_cmd", ("control_msgs/GripperCommand", GripperGoal, GripperState, GripperState)
        goal = GripperGoal(Command(a.position, a.effort))
    full = f"{a.node}/{a.group}/{name}"
    client = peer.once(full, lambda: rw.ActionClient(peer.dp, full, *types))
    gid, r = client.send_goal(goal)
    if not r.accepted:
        raise Failure("the goal was rejected")
    r = client.finish(gid)
    show(status=rw.STATUS[r.status], result=r.result, feedback=len(client.feedback(gid)))


def add_commands(command):
    p = command("gripper", gripper, position=0.0, effort=0.0)
    p.add_argument("--group", required=True)
    p.add_argument("--parallel", action="store_true")
    p.add_argument("--joint", action="append", default=[])
    p.add_argument("--velocity", action="append", default=[], type=float)

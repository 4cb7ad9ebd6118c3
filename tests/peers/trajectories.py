"""Trajectories of joints: control_msgs/FollowJointTrajectory and trajectory_msgs/JointTrajectory as ROS 2 Jazzy has them."""
import time
from dataclasses import dataclass, field

from cyclonedds.idl import IdlStruct, types as t

import ros2wire as rw
from report import Failure, plain, show

ERRORS = {0: "SUCCESSFUL", -1: "INVALID_GOAL", -2: "INVALID_JOINTS", -3: "OLD_HEADER_TIMESTAMP",
          -4: "PATH_TOLERANCE_VIOLATED", -5: "GOAL_TOLERANCE_VIOLATED"}
TOPIC_QOS = rw.qos(depth=10)


@dataclass
class Duration(IdlStruct, typename="builtin_interfaces::msg::dds_::Duration_"):
    sec: t.int32 = 0
    nanosec: t.uint32 = 0

    @staticmethod
    def of(seconds):
        ns = round(seconds * 1e9)
        return Duration(ns // 1_000_000_000, ns % 1_000_000_000)


@dataclass
class Point(IdlStruct, typename="trajectory_msgs::msg::dds_::JointTrajectoryPoint_"):
    positions: t.sequence[t.float64] = field(default_factory=list)
    velocities: t.sequence[t.float64] = field(default_factory=list)
    accelerations: t.sequence[t.float64] = field(default_factory=list)
    effort: t.sequence[t.float64] = field(default_factory=list)
    time_from_start: Duration = field(default_factory=Duration)


@dataclass
class JointTrajectory(IdlStruct, typename="trajectory_msgs::msg::dds_::JointTrajectory_"):
    header: rw.Header = field(default_factory=rw.Header)
    joint_names: t.sequence[str] = field(default_factory=list)
    points: t.sequence[Point] = field(default_factory=list)


@dataclass
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: t.float64 = 0.0
    y: t.float64 = 0.0
    z: t.float64 = 0.0


@dataclass
class Quaternion(IdlStruct, typename="geometry_msgs::msg::dds_::Quaternion_"):
    x: t.float64 = 0.0
    y: t.float64 = 0.0
    z: t.float64 = 0.0
    w: t.float64 = 1.0


@dataclass
class Transform(IdlStruct, typename="geometry_msgs::msg::dds_::Transform_"):
    translation: Vector3 = field(default_factory=Vector3)
    rotation: Quaternion = field(default_factory=Quaternion)


@dataclass
class Twist(IdlStruct, typename="geometry_msgs::msg::dds_::Twist_"):
    linear: Vector3 = field(default_factory=Vector3)
    angular: Vector3 = field(default_factory=Vector3)


@dataclass
class MultiDOFPoint(IdlStruct, typename="trajectory_msgs::msg::dds_::MultiDOFJointTrajectoryPoint_"):
    transforms: t.sequence[Transform] = field(default_factory=list)
    velocities: t.sequence[Twist] = field(default_factory=list)
    accelerations: t.sequence[Twist] = field(default_factory=list)
    time_from_start: Duration = field(default_factory=Duration)


@dataclass
class MultiDOFTrajectory(IdlStruct, typename="trajectory_msgs::msg::dds_::MultiDOFJointTrajectory_"):
    header: rw.Header = field(default_factory=rw.Header)
    joint_names: t.sequence[str] = field(default_factory=list)
    points: t.sequence[MultiDOFPoint] = field(default_factory=list)


@dataclass
class JointTolerance(IdlStruct, typename="control_msgs::msg::dds_::JointTolerance_"):
    name: str = ""
    position: t.float64 = 0.0
    velocity: t.float64 = 0.0
    acceleration: t.float64 = 0.0


@dataclass
class ComponentTolerance(IdlStruct, typename="control_msgs::msg::dds_::JointComponentTolerance_"):
    joint_name: str = ""
    component: t.uint16 = 0
    position: t.float64 = 0.0
    velocity: t.float64 = 0.0
    acceleration: t.float64 = 0.0


@dataclass
class FollowGoal(IdlStruct, typename="FollowGoal"):
    trajectory: JointTrajectory = field(default_factory=JointTrajectory)
    multi_dof_trajectory: MultiDOFTrajectory = field(default_factory=MultiDOFTrajectory)
    path_tolerance: t.sequence[JointTolerance] = field(default_factory=list)
    component_path_tolerance: t.sequence[ComponentTolerance] = field(default_factory=list)
    goal_tolerance: t.sequence[JointTolerance] = field(default_factory=list)
    component_goal_tolerance: t.sequence[ComponentTolerance] = field(default_factory=list)
    goal_time_tolerance: Duration = field(default_factory=Duration)


@dataclass
class FollowResult(IdlStruct, typename="FollowResult"):
    error_code: t.int32 = 0
    error_string: str = ""


@dataclass
class FollowFeedback(IdlStruct, typename="FollowFeedback"):
    header: rw.Header = field(default_factory=rw.Header)
    joint_names: t.sequence[str] = field(default_factory=list)
    desired: Point = field(default_factory=Point)
    actual: Point = field(default_factory=Point)
    error: Point = field(default_factory=Point)
    multi_dof_joint_names: t.sequence[str] = field(default_factory=list)
    multi_dof_desired: MultiDOFPoint = field(default_factory=MultiDOFPoint)
    multi_dof_actual: MultiDOFPoint = field(default_factory=MultiDOFPoint)
    multi_dof_error: MultiDOFPoint = field(default_factory=MultiDOFPoint)


@dataclass
class ControllerState(IdlStruct, typename="control_msgs::msg::dds_::JointTrajectoryControllerState_"):
    header: rw.Header = field(default_factory=rw.Header)
    joint_names: t.sequence[str] = field(default_factory=list)
    reference: Point = field(default_factory=Point)
    feedback: Point = field(default_factory=Point)
    error: Point = field(default_factory=Point)
    output: Point = field(default_factory=Point)
    multi_dof_joint_names: t.sequence[str] = field(default_factory=list)
    multi_dof_reference: MultiDOFPoint = field(default_factory=MultiDOFPoint)
    multi_dof_feedback: MultiDOFPoint = field(default_factory=MultiDOFPoint)
    multi_dof_error: MultiDOFPoint = field(default_factory=MultiDOFPoint)
    multi_dof_output: MultiDOFPoint = field(default_factory=MultiDOFPoint)
    speed_scaling_factor: t.float64 = 0.0


@dataclass
class QueryStateRequest(IdlStruct, typename="QueryStateRequest"):
    time: rw.Time = field(default_factory=rw.Time)


@dataclass
class QueryStateResponse(IdlStruct, typename="QueryStateResponse"):
    success: bool = False
    message: str = ""
    name: t.sequence[str] = field(default_factory=list)
    position: t.sequence[t.float64] = field(default_factory=list)
    velocity: t.sequence[t.float64] = field(default_factory=list)
    acceleration: t.sequence[t.float64] = field(default_factory=list)


def name_of(a, name):
    return f"{a.node}/{a.group}/{name}" if a.group else f"{a.node}/{name}"


def client_of(peer, a):
    name = name_of(a, "follow_joint_trajectory")
    return peer.once(name, lambda: rw.ActionClient(peer.dp, name, "control_msgs/FollowJointTrajectory", FollowGoal,
                                                   FollowResult, FollowFeedback))


def numbers(text):
    return [float(word) for word in text.split(",") if word]


def point_of(text):
    """SECONDS:POSITIONS[:VELOCITIES[:ACCELERATIONS]], numbers between commas."""
    seconds, *lists = text.split(":")
    lists = [numbers(one) for one in lists] + [[], [], []]
    return Point(lists[0], lists[1], lists[2], [], Duration.of(float(seconds)))


def tolerance_of(text):
    """NAME:POSITION[,VELOCITY[,ACCELERATION]]"""
    name, values = text.split(":")
    return JointTolerance(name, *(numbers(values) + [0.0, 0.0])[:3])


def trajectory_of(a):
    points = [point_of(text) for text in a.point]
    if a.fill:
        # Many points on the spot of the last one, a millisecond apart.
        last, end = points[-1], a.fill_from
        points += [Point(last.positions, [0.0] * len(a.joint), [], [], Duration.of(end + i / 1000))
                   for i in range(1, a.fill + 1)]
    stamp = rw.Time()
    if a.start is not None:
        ns = time.time_ns() + round(a.start * 1e9)
        stamp = rw.Time(ns // 1_000_000_000, ns % 1_000_000_000)
    return JointTrajectory(rw.Header(stamp, ""), a.joint, points)


def send(peer, a):
    goal = FollowGoal(trajectory_of(a), path_tolerance=[tolerance_of(one) for one in a.path],
                      goal_tolerance=[tolerance_of(one) for one in a.goal],
                      goal_time_tolerance=Duration.of(a.goal_time))
    if a.multi_dof:
        goal.multi_dof_trajectory.joint_names = ["floating"]
    gid, r = client_of(peer, a).send_goal(goal)
    show(goal=gid.hex(), accepted=r.accepted, stamp=goal.trajectory.header.stamp)
    if not r.accepted:
        raise Failure("the goal was rejected")
    return gid


def finish(peer, a, gid, expected):
    client = client_of(peer, a)
    r = client.finish(gid)
    feedback = client.feedback(gid)
    show(status=rw.STATUS[r.status], error=ERRORS.get(r.result.error_code, r.result.error_code),
         text=r.result.error_string, feedback=feedback)
    if rw.STATUS[r.status] != expected:
        raise Failure(f"the goal ended {rw.STATUS[r.status]}, not {expected}: {r.result.error_string}")


def follow(peer, a):
    gid = send(peer, a)
    if a.cancel_after is not None:
        time.sleep(a.cancel_after)
        r = client_of(peer, a).cancel(gid)
        show(cancel=r.return_code, canceling=[g.goal_id.hex() for g in r.goals_canceling])
    if not a.leave:
        finish(peer, a, gid, a.expect or ("SUCCEEDED" if a.cancel_after is None else "CANCELED"))


def followed(peer, a):
    finish(peer, a, rw.UUID.of_hex(a.id), a.expect)


def publish(peer, a):
    name = name_of(a, "joint_trajectory")
    if name not in peer.made:
        peer.made[name] = rw.publisher(peer.dp, name, JointTrajectory, TOPIC_QOS)
        rw.wait_until(peer.made[name].get_matched_subscriptions, rw.MATCH_S, f"nobody reads {name}")
        # The reader may know the writer a little later than the writer knows the reader.
        time.sleep(0.5)
    peer.made[name].write(trajectory_of(a))
    show(published=name)


def controller_state(peer, a):
    """All messages of some seconds, and all since the call before."""
    stream = peer.stream(name_of(a, "controller_state"), ControllerState)
    end = time.monotonic() + a.seconds
    while True:
        for m in stream.take():
            show(state=m)
        if time.monotonic() > end:
            break
        time.sleep(0.001)


def query_state(peer, a):
    name = name_of(a, "query_state")
    client = peer.once(name, lambda: rw.ServiceClient(peer.dp, name, "control_msgs/QueryTrajectoryState",
                                                      QueryStateRequest, QueryStateResponse))
    ns = a.ns + round(a.plus * 1e9)
    r = client.call(QueryStateRequest(rw.Time(ns // 1_000_000_000, ns % 1_000_000_000)))
    show(**plain(r))
    if not r.success:
        raise Failure(r.message)


def add_commands(command):
    command("controller-state", controller_state, group="", seconds=0.0)
    p = command("query-state", query_state, group="", plus=0.0)
    p.add_argument("ns", type=int, help="nanoseconds since the epoch")

    def joints(p):
        p.add_argument("--group", default="")
        p.add_argument("--joint", action="append", default=[])
        p.add_argument("--point", action="append", default=[], help=point_of.__doc__)
        p.add_argument("--start", type=float, help="seconds from now; left out: a stamp of zero")
        p.add_argument("--fill", type=int, default=0, help="so many points more, on the spot of the last one")
        p.add_argument("--fill-from", type=float, default=0.0, help="time of the last one")
    p = command("follow", follow, goal_time=0.0)
    joints(p)
    p.add_argument("--path", action="append", default=[], help=tolerance_of.__doc__)
    p.add_argument("--goal", action="append", default=[], help=tolerance_of.__doc__)
    p.add_argument("--multi-dof", action="store_true")
    p.add_argument("--cancel-after", type=float)
    p.add_argument("--leave", action="store_true", help="do not wait for the end")
    p.add_argument("--expect", choices=rw.STATUS.values())
    p = command("followed", followed, expect="SUCCEEDED", group="")
    p.add_argument("id", help="as printed by follow --leave")
    joints(command("publish-trajectory", publish))

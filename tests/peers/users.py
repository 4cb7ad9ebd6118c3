"""Clients of the joints of a group as their sources of ROS 2 Jazzy send: MoveIt, MoveIt Servo and rqt_joint_trajectory_controller.

All three find the controller of the group with `list_controllers`, and the limits of its joints in /robot_description.
"""
import math
import random
import time
import xml.etree.ElementTree as ElementTree
from collections import deque
from dataclasses import dataclass
from pathlib import Path

import yaml

import controllers
import ros2wire as rw
from lineshaft_msgs import AXIS_STATES, AxisStates, Event
from report import Failure, plain, show
from trajectories import ERRORS, ControllerState, Duration, FollowFeedback, FollowGoal, FollowResult, JointTrajectory, Point

JOINT_LIMITS = Path(__file__).resolve().parents[2] / "launch-configs/arm6/joint_limits.yaml"
TYPE = "joint_trajectory_controller/JointTrajectoryController"
TOLERANCE = 0.01  # rad; MoveIt's allowed_start_tolerance
PROGRESS = 10  # goals between two lines of output
CONTROLLERS_S = 1.0  # MoveIt and rqt call list_controllers once a second
REST_S = 10.0  # time in which all axes must come to rest
LAST_VALUE = rw.qos(depth=1)  # topics of MoveIt Servo and rqt


def nanoseconds(stamp):
    return stamp.sec * 1_000_000_000 + stamp.nanosec


def stamp_of(ns):
    return rw.Time(ns // 1_000_000_000, ns % 1_000_000_000)


@dataclass
class Limits:
    """Limits of a joint in rad, rad/s and rad/s^2."""
    lower: float
    upper: float
    velocity: float
    acceleration: float = math.inf


class Node:
    """The node as its clients see it: controllers, limits of the joints, joint states, refusals, states of the axes."""

    def __init__(self, peer, a):
        self.peer, self.a = peer, a
        self.manager, self.since, self.listed = f"{a.node}/controller_manager", time.time_ns(), -math.inf
        self.state_stream, self.axis_stream = peer.joint_states(), peer.stream(f"{a.node}/axis_states", AxisStates)
        self.log = peer.once("/rosout", lambda: rw.Subscription(peer.dp, "/rosout", rw.Log, rw.ROSOUT_QOS))
        self.events = peer.stream(f"{a.node}/events", Event)
        self.events.take()
        self.refused, self.states = [], deque(maxlen=10_000)

    def controller(self):
        """The controller of the group, which must be active; its state is requested again after a second."""
        if time.monotonic() - self.listed < CONTROLLERS_S:
            return self.group
        self.listed = time.monotonic()
        srv, response = controllers.LISTS["list_controllers"]
        client = controllers.client(self.peer, self.manager, "list_controllers", srv, controllers.Empty, response)
        found = [c for c in client.call(controllers.Empty()).controller if c.name == self.a.group]
        if [(c.type, c.state) for c in found] != [(TYPE, "active")]:
            raise Failure(f"controller {self.a.group} must be active and of type {TYPE}: {plain(found)}")
        self.group = found[0]
        return self.group

    def limits(self, file=None):
        """Positions and velocities from the URDF; accelerations from `joint_limits.yaml`, where MoveIt reads them."""
        stream = self.peer.once("/robot_description", lambda: rw.Subscription(
            self.peer.dp, "/robot_description", rw.Text, rw.STATUS_QOS))
        texts = self.peer.made.setdefault("description", [])
        rw.wait_until(lambda: texts.extend(stream.take()) or texts, rw.REPLY_S, "no robot description")
        limits = {}
        for joint in ElementTree.fromstring(texts[-1].data).findall("joint"):
            limit = joint.find("limit")
            if joint.get("type") != "fixed":
                limits[joint.get("name")] = Limits(*(float(limit.get(key)) for key in ("lower", "upper", "velocity")))
        if file:
            for name, values in yaml.safe_load(Path(file).read_text())["joint_limits"].items():
                limits[name].acceleration = values["max_acceleration"]
        return limits

    def take_states(self):
        taken = [(nanoseconds(m.header.stamp), dict(zip(m.name, m.position))) for m in self.state_stream.take()]
        self.states.extend(taken)
        return taken

    def positions(self, names):
        """Measured positions of the first joint state that is stamped from now on."""
        now, found = time.time_ns(), []
        rw.wait_until(lambda: found.extend(s for stamp, s in self.take_states() if stamp >= now) or found,
                      rw.REPLY_S, "no joint state")
        return [found[0][name] for name in names]

    def refusals(self):
        """Texts of all refusals since the client started: events, and lines of /rosout without an event."""
        lines = [m.msg for m in self.log.take() if nanoseconds(m.stamp) >= self.since]
        self.refused += [m.text for m in self.events.take() if m.kind == "refused"]
        self.refused += [line for line in lines if ("refused" in line or "rejected" in line) and line not in self.refused]
        return self.refused

    def wait_for_rest(self):
        """Waits until all axes are enabled and at rest without an error."""
        seen = []

        def rested():
            seen.extend(self.axis_stream.take())
            return seen and all(AXIS_STATES[axis.state] == "STANDSTILL" for axis in seen[-1].axes)
        self.axis_stream.take()
        try:
            rw.wait_until(rested, REST_S, "")
        except TimeoutError:
            states = [(axis.name, AXIS_STATES[axis.state]) for axis in seen[-1].axes] if seen else "axis_states stopped"
            raise Failure(f"not all axes are at rest after {REST_S} s: {states}")
        errors = [(axis.name, axis.error_code) for axis in seen[-1].axes if axis.error_code]
        if errors:
            raise Failure(f"axes with errors: {errors}")

    def publisher(self):
        """The publisher of the topic of the group, with the history that MoveIt Servo and rqt have."""
        name = f"{self.a.node}/{self.a.group}/joint_trajectory"
        if name not in self.peer.made:
            writer = self.peer.made[name] = rw.publisher(self.peer.dp, name, JointTrajectory, LAST_VALUE)
            rw.wait_until(writer.get_matched_subscriptions, rw.MATCH_S, f"no subscription to {name}")
            time.sleep(0.5)  # the subscription may know the publisher later
        return self.peer.made[name]

    def finish_stream(self, names, target, **figures):
        """Checks of a client that publishes: no refusal, all axes at rest at the last target."""
        self.wait_for_rest()
        error = largest_difference(self.positions(names), target)
        time.sleep(0.2)  # lines of /rosout may arrive later than joint states
        refusals = self.refusals()
        show(**figures, refusals=len(refusals), first_refusals=refusals[:3], final_error=error)
        if refusals:
            raise Failure(f"{len(refusals)} messages were refused; the first: {refusals[0]}")
        if error > TOLERANCE:
            raise Failure(f"the joints end {error} rad from the last target")


def largest_difference(a, b):
    return max(abs(x - y) for x, y in zip(a, b))


# MoveIt: trajectory_execution_manager, Ros2ControlManager, time_optimal_trajectory_generation.

SCALING, MARGIN_S = 1.2, 0.5  # allowed_execution_duration_scaling, allowed_goal_duration_margin
RESAMPLE_S = 0.1  # resample_dt
STOP_S = 1.0  # wait_time of waitForRobotToStop
REACHED = "Goal successfully reached!"  # and no more, if the node has not stretched the trajectory


def target_from(start, limits, rng):
    """A random target that is reached in 0.2 s to 0.6 s with half of the accelerations."""
    duration, weights = rng.uniform(0.2, 0.6), [rng.uniform(-1.0, 1.0) for _ in start]
    largest, target = max(map(abs, weights)), []
    for position, weight, joint in zip(start, weights, limits):
        distance = weight / largest * 0.5 * joint.acceleration * duration * duration / 4
        is_inside = joint.lower + 0.1 < position + distance < joint.upper - 0.1
        target.append(position + distance if is_inside else position - distance)
    return target


def plan(start, target, limits, velocity_scaling, acceleration_scaling=0.5, with_accelerations=True):
    """A straight line in joint space with trapezoidal velocity, sampled every 0.1 s and at its end; and its duration.

    As MoveIt's time parameterization does, one point at time 0 is the plan of a line without length."""
    distances = [b - a for a, b in zip(start, target)]
    if max(map(abs, distances)) < 0.001:  # min_angle_change
        return [Point(list(start), [0.0] * len(start), [0.0] * len(start), [], Duration.of(0))], 0.0
    moved = [(abs(d), joint) for d, joint in zip(distances, limits) if d]
    velocity = min(velocity_scaling * joint.velocity / d for d, joint in moved)
    acceleration = min(acceleration_scaling * joint.acceleration / d for d, joint in moved)
    velocity = min(velocity, math.sqrt(acceleration))
    ramp = velocity / acceleration
    duration = ramp + 1.0 / velocity
    points = []
    for sample in range(math.ceil(duration / RESAMPLE_S) + 1):
        at = min(duration, sample * RESAMPLE_S)
        left = duration - at
        if at < ramp:
            s, v, acc = acceleration * at * at / 2, acceleration * at, acceleration
        elif left > ramp:
            s, v, acc = velocity * (at - ramp / 2), velocity, 0.0
        else:
            s, v, acc = 1.0 - acceleration * left * left / 2, acceleration * left, -acceleration
        points.append(Point([a + d * s for a, d in zip(start, distances)], [d * v for d in distances],
                            [d * acc for d in distances] if with_accelerations else [], [], Duration.of(at)))
    return points, duration


def wait_for_stop(node, names):
    """Three joint states in a row without motion, as MoveIt waits after each goal."""
    end, before, count = time.monotonic() + STOP_S, node.positions(names), 0
    while count < 3:
        if time.monotonic() > end:
            raise Failure(f"the joints move for {STOP_S} s after the goal has succeeded")
        now = node.positions(names)
        count = count + 1 if largest_difference(before, now) <= TOLERANCE else 0
        before = now


def execute(client, goal, duration):
    """Sends a goal as MoveIt does; returns status with error code, text, and how long it took after its acceptance."""
    gid, reply = client.send_goal(goal)
    if not reply.accepted:
        return "REJECTED", "", 0.0
    start, limit = time.monotonic(), SCALING * duration + MARGIN_S
    try:
        r = client.get_result(gid, limit)
        words = f"{rw.STATUS[r.status]} {ERRORS.get(r.result.error_code, r.result.error_code)}"
    except TimeoutError:
        client.cancel(gid)
        r = client.get_result(gid)
        words = f"TIMED_OUT after {limit} s, then {rw.STATUS[r.status]}"
    took = time.monotonic() - start
    client.feedback(gid)
    client.seen.clear()
    return words, r.result.error_string, took


def as_moveit(peer, a):
    node, rng = Node(peer, a), random.Random(a.seed)
    limits = node.limits(a.limits)
    names = [one.split("/")[0] for one in node.controller().required_command_interfaces]
    limits = [limits[name] for name in names]
    action = f"{a.node}/{node.controller().name}/follow_joint_trajectory"
    client = peer.once(action, lambda: rw.ActionClient(peer.dp, action, "control_msgs/FollowJointTrajectory", FollowGoal,
                                                       FollowResult, FollowFeedback))
    unexpected, stretched, latenesses, errors, slack = 0, 0, [], [], []
    for i in range(a.goals):
        node.controller()
        start = node.positions(names)
        # Every tenth plan has no length; every second one is without accelerations.
        target = start if i % 10 == 3 else target_from(start, limits, rng)
        points, duration = plan(start, target, limits, rng.uniform(0.25, 0.5), with_accelerations=i % 2 == 0)
        goal = FollowGoal(JointTrajectory(rw.Header(rw.Time(), "base_link"), names, points))
        result, text, took = execute(client, goal, duration)
        is_good = result == "SUCCEEDED SUCCESSFUL"
        if is_good:
            stretched += text != REACHED
            latenesses.append(took - duration)
            slack.append(SCALING * duration + MARGIN_S - took)
            wait_for_stop(node, names)
            errors.append(largest_difference(node.positions(names), target))
            is_good = errors[-1] <= TOLERANCE
        if not is_good:
            unexpected += 1
            show(goal=i, unexpected=result, text=text, took=took, planned=duration, trajectory=goal.trajectory,
                 refusals=node.refusals(), error=errors[-1] if errors else None)
            node.wait_for_rest()
        if (i + 1) % PROGRESS == 0:
            show(sent=i + 1)
    node.wait_for_rest()
    show(goals=a.goals, unexpected=unexpected, stretched=stretched, largest_lateness=max(latenesses, default=None),
         smallest_slack=min(slack, default=None), largest_error=max(errors, default=None), refusals=node.refusals())
    if unexpected:
        raise Failure(f"{unexpected} of {a.goals} goals did not end as expected")


# MoveIt Servo: the loop of servo_node with its default smoothing.

PERIOD_S = 0.02  # publish_period of docs/moveit.md
LATENCY_NS = 100_000_000  # max_expected_latency
STALE_CYCLES = 5  # incoming_command_timeout, 0.1 s
IDLE_CYCLES = 12  # fill the window before the first command
MIN_POINTS = 3  # MIN_POINTS_FOR_TRAJ_MSG
STOPPED = 1e-4  # rad/s; STOPPED_VELOCITY_EPS


class Smoothing:
    """ButterworthFilterPlugin with its default coefficient 1.5."""

    def __init__(self, positions):
        self.inputs, self.output = list(positions), list(positions)

    def filter(self, positions):
        self.output = [(x + before + 0.5 * y) / 2.5 for x, before, y in zip(positions, self.inputs, self.output)]
        self.inputs = list(positions)
        return self.output


@dataclass
class State:
    stamp: int  # ns
    positions: list
    velocities: list


class Window:
    """The commands from 0.1 s ago to 0.1 s ahead, which each message repeats without the newest one."""

    def __init__(self):
        self.states = deque()

    def add(self, now, positions, velocities):
        state = State(now + LATENCY_NS, list(positions), list(velocities))
        while self.states and self.states[0].stamp < now - LATENCY_NS:
            self.states.popleft()
        if len(self.states) >= 2:
            before, last = self.states[-2], self.states[-1]
            for i, position in enumerate(state.positions):
                to, since = position - last.positions[i], last.positions[i] - before.positions[i]
                slopes = to / (state.stamp - last.stamp) * 1e9, since / (last.stamp - before.stamp) * 1e9
                is_turn = to * since < 0 or to == since == 0
                last.velocities[i] = state.velocities[i] = 0.0 if is_turn else min(slopes, key=abs)
        self.states.append(state)
        return state

    def message(self, names, with_velocities, is_single):
        if is_single:
            last = self.states[-1]
            point = Point(last.positions, last.velocities if with_velocities else [], [], [], Duration.of(PERIOD_S))
            return JointTrajectory(rw.Header(), names, [point])
        if len(self.states) < MIN_POINTS:
            return None
        first = self.states[0].stamp
        points = [Point(s.positions, s.velocities if with_velocities else [], [], [], Duration.of((s.stamp - first) / 1e9))
                  for s in list(self.states)[:-1]]
        return JointTrajectory(rw.Header(stamp_of(first), ""), names, points)


def jog(goals, limits):
    """Velocities of `goals` cycles: half a sine within half of velocity and acceleration of the joint."""
    duration = goals * PERIOD_S
    peak = min(0.5 * limits.velocity, 0.5 * limits.acceleration * duration / math.pi)
    return [peak * math.sin(math.pi * (i + 0.5) / goals) for i in range(goals)]


def as_servo(peer, a):
    node = Node(peer, a)
    limits = node.limits(a.limits)
    names = [one.split("/")[0] for one in node.controller().required_command_interfaces]
    moved = names.index(a.joint or names[0])
    velocities = jog(a.goals, limits[names[moved]])
    if node.positions(names)[moved] > 0:
        velocities = [-v for v in velocities]
    velocities += [velocities[-1]] * STALE_CYCLES
    writer, window, idle = node.publisher(), Window(), [0.0] * len(names)
    asked, published, target, last = {}, 0, None, None
    smoothing, cycle, next_cycle, largest_gap, before = None, -IDLE_CYCLES, time.monotonic(), 0.0, None
    while True:
        node.take_states()
        now = time.time_ns()
        largest_gap, before = max(largest_gap, (now - before) / 1e9 if before else 0.0), now
        measured = [node.states[-1][1][name] for name in names]
        is_ahead = window.states and window.states[-1].stamp > now
        if not is_ahead:
            window.states.clear()
        current = window.states[-1].positions if is_ahead else measured
        commanded = None
        if 0 <= cycle < len(velocities):
            commanded = list(current)
            commanded[moved] += velocities[cycle] * PERIOD_S
        elif cycle >= 0:
            if all(abs(v) < STOPPED for v in last.velocities):
                break
            commanded = last.positions
        if commanded:
            commanded = smoothing.filter(commanded)
            speeds = [(p - c) / PERIOD_S for p, c in zip(commanded, current)] if cycle < len(velocities) else idle
            last = window.add(now, commanded, speeds)
            message = window.message(names, a.velocities, a.single_point)
            if message:
                writer.write(message)
                published += 1
                begin = nanoseconds(message.header.stamp) or now
                asked.update((begin + nanoseconds(p.time_from_start), p.positions[moved]) for p in message.points)
                target = message.points[-1].positions
        else:
            window.add(now, measured, idle)
            smoothing = Smoothing(measured)
        cycle += 1
        next_cycle += PERIOD_S
        time.sleep(max(0.0, next_cycle - time.monotonic()))
    node.wait_for_rest()
    node.take_states()
    travel = max(asked.values()) - min(asked.values())
    node.finish_stream(names, target, published=published, largest_gap=largest_gap, travel=travel,
                       largest_deviation=largest_deviation(node.states, asked, names[moved]))


def largest_deviation(states, asked, joint):
    """The largest difference between measured positions and the straight lines between the positions asked for."""
    stamps, largest = sorted(asked), 0.0
    for (t0, t1) in zip(stamps, stamps[1:]):
        for stamp, positions in states:
            if t0 <= stamp < t1:
                wanted = asked[t0] + (asked[t1] - asked[t0]) * (stamp - t0) / (t1 - t0)
                largest = max(largest, abs(positions[joint] - wanted))
    return largest


# rqt_joint_trajectory_controller.

COMMAND_S, MIN_DURATION_S = 0.1, 0.5  # 1 / _cmd_pub_freq, _min_traj_dur
SPEED_SCALE = 0.5  # speed scaling starts at 50 %
DECIMALS = 6  # of a spin box


def as_rqt(peer, a):
    node = Node(peer, a)
    # A namespace with these services is a controller manager; load, unload and reload are never called.
    for service, (srv, request) in controllers.LOADS.items():
        controllers.client(peer, node.manager, service, srv, request, controllers.Done)
    controllers.client(peer, node.manager, "list_controller_types", "ListControllerTypes", controllers.Empty,
                       controllers.ListControllerTypesResponse)
    controllers.client(peer, node.manager, "switch_controller", "SwitchController", controllers.SwitchControllerRequest,
                       controllers.SwitchControllerResponse)
    limits = node.limits()
    names = [one.rsplit("/", 1)[0] for one in node.controller().required_state_interfaces if one.endswith("/position")]
    name = f"{a.node}/{a.group}/controller_state"
    stream = peer.once(name + " of rqt", lambda: rw.Subscription(peer.dp, name, ControllerState, LAST_VALUE))
    writer, states = node.publisher(), []
    rw.wait_until(lambda: states.extend(stream.take()) or states, rw.REPLY_S, f"no message of {name}")
    position = dict(zip(states[-1].joint_names, states[-1].feedback.positions))
    # Until the user enables it, the widgets show the measured positions.
    command = {joint: round(position[joint], DECIMALS) for joint in names}
    joint = a.joint or names[0]
    limit = limits[joint]
    step, received, longest = (limit.upper - limit.lower) / 100, 0, 0.0
    slider = round((command[joint] - limit.lower) / step)
    up = 1 if slider < 100 else -1
    next_command = time.monotonic()
    for i in range(a.goals):
        node.controller()
        taken = stream.take()
        if taken:
            position = dict(zip(taken[-1].joint_names, taken[-1].feedback.positions))
            received += len(taken)
        # The user moves the slider to the end of the joint and back.
        slider += up
        up = -1 if slider >= 100 else up
        command[joint] = limit.lower + step * slider
        if a.spin_box:
            command[joint] = round(command[joint], DECIMALS)
        durations = [max(abs(command[n] - position[n]) / limits[n].velocity, MIN_DURATION_S) for n in names]
        duration = max(durations) / SPEED_SCALE
        longest = max(longest, duration)
        target = [command[n] for n in names]
        writer.write(JointTrajectory(rw.Header(), names, [Point(target, [], [], [], Duration.of(duration))]))
        if (i + 1) % PROGRESS == 0:
            show(sent=i + 1)
        next_command += COMMAND_S
        time.sleep(max(0.0, next_command - time.monotonic()))
    if not received:
        raise Failure(f"no message of {name} while the client publishes")
    time.sleep(duration - COMMAND_S)
    node.finish_stream(names, target, published=a.goals, controller_states=received, longest_duration=longest)


def add_commands(command):
    def client(name, run, **options):
        return command(name, run, goals=100, group="arm", **options)
    client("as-moveit", as_moveit, seed=1, limits=str(JOINT_LIMITS))
    p = client("as-servo", as_servo, joint="", limits=str(JOINT_LIMITS))
    p.add_argument("--single-point", action="store_true", help="one point without a stamp, as MoveIt Servo of Humble")
    p.add_argument("--velocities", action="store_true", help="publish_joint_velocities, which docs/moveit.md switches off")
    p = client("as-rqt", as_rqt, joint="")
    p.add_argument("--spin-box", action="store_true", help="the user changes the spin box, whose values have 6 decimals")

#!/usr/bin/env python3
"""A ROS 2 peer on Cyclone DDS for the end-to-end tests: one JSON line per observation, exit 1 on failure.

    pip install -r requirements.txt
    export ROS_DOMAIN_ID=77  # CYCLONEDDS_URI defaults to loopback only, unicast discovery
    lineshaft_peer.py move /lineshaft --axis x --units increments --position 12345

`serve` keeps one participant and reads such command lines from standard input, words between blanks. It answers each
with the same JSON lines and a last one {"done": command, "ok": bool, "error": sentence}.
"""
import argparse
import sys
import time

import checks
import clock
import conformance
import controllers
import functions
import goals
import gripper
import hammer
import homing
import hostile
import lifecycle
import node_services
import objects
import outputs
import parameters
import ros2wire as rw
import rtps_check
import shaft
import streams
import trajectories
import tune
import users
import watch
from lineshaft_msgs import (ACTIONS, AbortTriggerRequest, AXIS_STATES, CAM_STARTS, EDGES, MOVE_MODES, ENGAGES, RECORD_COMMANDS, SIDES, SYNC_MODES, UNITS, Answer,
                            AxesRequest, AxisStates, DISENGAGES, Event, GearOutRequest, ImportRequest, LEAVE_AT, MoveGoal, PhaseGoal, ProbeGoal, RecordRequest, RunGoal,
                            RecordResponse, ResetRequest, SyncGoal, TouchProbeRequest, VocabularyRequest)
from report import Failure, plain, show, told

STREAM = rw.qos(depth=10_000)  # nothing is lost while a command waits for something else
AXES_VERBS = ("enable", "disable", "halt", "quick_stop", "reset_errors")


class Peer:
    """One participant with its endpoints, each made at first use and kept."""

    def __init__(self):
        self.dp = rw.participant()
        self.made = {}

    def once(self, key, make):
        if key not in self.made:
            self.made[key] = make().wait()
        return self.made[key]

    def stream(self, topic, cls):
        return self.once(topic, lambda: rw.Subscription(self.dp, topic, cls, STREAM))

    def joint_states(self):
        return self.stream("/joint_states", rw.JointState)

    def axis_states(self, node):
        return self.stream(f"{node}/axis_states", AxisStates)

    def axes(self, node, verb):
        return self.once(f"{node}/{verb}", lambda: self.axes_on(self.dp, node, verb))

    @staticmethod
    def axes_on(dp, node, verb):
        return rw.ServiceClient(dp, f"{node}/{verb}", "lineshaft_msgs/AxesCommand", AxesRequest, Answer)

    def service(self, node, name, srv, request, response):
        full = f"{node}/{name}"
        return self.once(full, lambda: rw.ServiceClient(self.dp, full, f"lineshaft_msgs/{srv}", request, response))

    def record(self, node):
        return self.service(node, "record", "Record", RecordRequest, RecordResponse)

    def vocabulary(self, node):
        return self.service(node, "vocabulary", "Vocabulary", VocabularyRequest, Answer)

    def import_parameters(self, node):
        return self.service(node, "import_parameters", "ImportParameters", ImportRequest, Answer)

    def reset_parameters(self, node):
        return self.service(node, "reset_parameters", "ResetParameters", ResetRequest, Answer)

    def action(self, node, action):
        return self.once(f"{node}/{action}", lambda: rw.ActionClient(self.dp, f"{node}/{action}", *ACTIONS[action]))

    def latest_axes(self, node):
        """The first axis_states that arrives from now on."""
        s = self.axis_states(node)
        while s.take():
            pass
        return first(s, "axis_states stopped")


def first(subscription, complaint):
    got = []
    rw.wait_until(lambda: got.extend(subscription.take()) or got, rw.REPLY_S, complaint)
    return got[-1]


def shown_axes(m):
    axes = {a.name: {k: v for k, v in plain(a).items() if k != "name"} for a in m.axes}
    for a in axes.values():
        a["state"] = AXIS_STATES[a["state"]]
    return {"stamp": plain(m.header.stamp), "cycle": m.cycle, "axes": axes}


def joint_states(peer, a):
    s = peer.joint_states()
    s.take()
    start, times, last = time.monotonic(), [], None
    while len(times) < a.count and time.monotonic() - start < a.seconds:
        for m in s.take():
            times.append(time.monotonic() - start)
            last = m
        time.sleep(0.001)
    if not times:
        raise Failure("no joint states")
    span = times[-1] - times[0]
    show(received=len(times), first_s=times[0], rate=(len(times) - 1) / span if span else 0.0, last=last)
    if len(times) < a.count and a.count != NO_LIMIT:
        raise Failure(f"{len(times)} joint states in {a.seconds} s, {a.count} wanted")


def axis_states(peer, a):
    if not a.all:
        show(**shown_axes(peer.latest_axes(a.node)))
        return
    for m in peer.axis_states(a.node).take():
        show(**shown_axes(m))


def echo(subscription, seconds, until=None):
    end = time.monotonic() + seconds
    while True:
        for m in subscription.take():
            show(message=m)
            if until and m.kind == until:
                return
        if time.monotonic() > end:
            break
        time.sleep(0.002)
    if until:
        raise Failure(f"no event of kind {until} within {seconds} s")


def events(peer, a):
    echo(peer.stream(f"{a.node}/events", Event), a.seconds, a.until)


def errors(peer, a):
    """The history, as somebody sees it who comes now."""
    echo(rw.Subscription(peer.dp, f"{a.node}/errors", Event, rw.ERRORS_QOS).wait(), a.seconds)


def log(peer, a):
    echo(peer.once("/rosout", lambda: rw.Subscription(peer.dp, "/rosout", rw.Log, rw.ROSOUT_QOS)), a.seconds)


def latched_text(peer, a):
    s = rw.Subscription(peer.dp, a.node, rw.Text, rw.STATUS_QOS).wait()
    show(text=first(s, f"no text on {a.node}").data)


def axes(peer, a):
    told(peer.axes(a.node, a.verb).call(AxesRequest(a.axes), a.timeout), verb=a.verb)


def record(peer, a):
    r = peer.record(a.node).call(RecordRequest(RECORD_COMMANDS.index(a.what), a.path, a.max_bag_size, a.max_bag_duration))
    show(**plain(r))
    if not r.success:
        raise Failure(r.message)


def vocabulary(peer, a):
    arguments = " ".join(a.arguments).replace("\\n", "\n") + "#" * a.pad
    told(peer.vocabulary(a.node).call(VocabularyRequest(a.axis, a.verb, arguments)))


def send(client, goal):
    gid, r = client.send_goal(goal)
    show(goal=gid.hex(), accepted=r.accepted)
    if not r.accepted:
        raise Failure("the goal was rejected")
    return gid


def finish(client, gid, expected):
    r = client.finish(gid)
    feedback = client.feedback(gid)
    show(status=rw.STATUS[r.status], result=r.result, statuses=[s.get(gid.hex()) for s in client.statuses()],
         feedback={"count": len(feedback), "last": feedback[-1] if feedback else None})
    if rw.STATUS[r.status] != expected:
        raise Failure(f"the goal ended {rw.STATUS[r.status]}, not {expected}: {r.result.message}")


def cancel_goal(client, gid):
    r = client.cancel(gid)
    show(cancel=r.return_code, canceling=[g.goal_id.hex() for g in r.goals_canceling])
    if r.return_code:
        raise Failure(f"cancel was answered with code {r.return_code}")


def move(peer, a):
    client = peer.action(a.node, "move_axis")
    gid = send(client, MoveGoal(a.axis, MOVE_MODES.index(a.mode), UNITS.index(a.units), a.position, a.velocity,
                                a.acceleration, a.deceleration, a.jerk, a.buffer_mode, a.direction))
    if a.cancel_after is not None:
        time.sleep(a.cancel_after)
        cancel_goal(client, gid)
    if a.wait or a.cancel_after is not None:
        finish(client, gid, a.expect or ("SUCCEEDED" if a.cancel_after is None else "CANCELED"))


def probe(peer, a):
    client = peer.action(a.node, "probe_axis")
    gid = send(client, ProbeGoal(a.axis, ("absolute", "relative").index(a.mode), UNITS.index(a.units), a.position,
                                 a.velocity, a.acceleration, a.deceleration, a.jerk, a.event, EDGES.index(a.edge),
                                 a.distance))
    finish(client, gid, a.expect)
    show(phases=sorted({f.phase for f in client.feedback(gid)}))


def synchronize(peer, a):
    client = peer.action(a.node, "synchronize")
    ratio = (0, 0) if a.mode == "cam" else (a.numerator, a.denominator)
    gid = send(client, SyncGoal(axis=a.axis, master=a.master, mode=SYNC_MODES.index(a.mode), numerator=ratio[0],
                                engage=ENGAGES.index(a.engage), master_increments=a.master_increments, event=a.event,
                                slave_increments=a.slave_increments,
                                start_distance_increments=a.start_distance_increments, offset=a.offset,
                                denominator=ratio[1], table=a.table, cam_start=CAM_STARTS.index(a.cam_start),
                                master_scale=a.master_scale, slave_scale=a.slave_scale,
                                disengage=DISENGAGES.index(a.disengage),
                                master_offset=a.master_offset, slave_offset=a.slave_offset))

    if a.expect:
        finish(client, gid, a.expect)
        return

    def coupled():
        f = client.feedback(gid)
        return f and f[-1].phase == 2
    rw.wait_until(coupled, rw.REPLY_S, "the axis is not synchronized")
    phases = [f.phase for f in client.feedback(gid)]
    show(phase=2, feedback=client.feedback(gid)[-1], phases=sorted(set(phases)),
         order=[now for before, now in zip([None] + phases, phases) if now != before])
    if a.seconds is not None:
        time.sleep(a.seconds)
        cancel_goal(client, gid)
        finish(client, gid, "CANCELED")


def gear_out(peer, a):
    client = peer.service(a.node, "gear_out", "GearOut", GearOutRequest, Answer)
    number = lambda given, names: names.index(given) if given in names else int(given)
    told(client.call(GearOutRequest(a.axis, number(a.at, LEAVE_AT), a.increments, number(a.disengage, DISENGAGES))))


def touch_probe(peer, a):
    client = peer.service(a.node, "touch_probe", "TouchProbe", TouchProbeRequest, Answer)
    number = lambda given, names: names.index(given) if given in names else int(given)
    told(client.call(TouchProbeRequest(a.axis, a.event, number(a.edge, EDGES), a.continuous, number(a.units, UNITS),
                                       a.window_only, a.first_position, a.last_position)))


def abort_trigger(peer, a):
    client = peer.service(a.node, "abort_trigger", "AbortTrigger", AbortTriggerRequest, Answer)
    told(client.call(AbortTriggerRequest(a.axis, a.event)))


def phase(peer, a):
    client = peer.action(a.node, "phase")
    gid = send(client, PhaseGoal(a.axis, SIDES.index(a.side), a.shift, a.velocity, a.acceleration))
    if a.cancel_after is not None:
        time.sleep(a.cancel_after)
        cancel_goal(client, gid)
    finish(client, gid, a.expect or ("SUCCEEDED" if a.cancel_after is None else "CANCELED"))
    show(remaining=[f.remaining for f in client.feedback(gid)])


def run_function(peer, a):
    client = peer.action(a.node, "run_function")
    pairs = [given.split("=", 1) for given in a.values]
    gid = send(client, RunGoal(a.function, [rw.Parameter(name, rw.ParameterValue.of(rw.parsed(value))) for name, value in pairs]))
    if a.cancel_after is not None:
        time.sleep(a.cancel_after)
        cancel_goal(client, gid)
    if a.expect:
        finish(client, gid, a.expect)


def result(peer, a):
    finish(peer.action(a.node, a.action), rw.UUID.of_hex(a.goal), a.expect)


def cancel(peer, a):
    cancel_goal(peer.action(a.node, a.action), rw.UUID.of_hex(a.goal))


def talk(peer, a):
    """A stream of joint states of one joint, so that the peers can be tested against each other."""
    w = rw.publisher(peer.dp, "/joint_states", rw.JointState, rw.qos())
    show(talking=a.seconds)
    end = time.monotonic() + a.seconds
    while time.monotonic() < end:
        w.write(rw.JointState(name=["peer"], position=[1.5], velocity=[0.0], effort=[0.0]))
        time.sleep(0.01)


NO_LIMIT = 1_000_000_000


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise Failure(message)


def parser():
    top = Parser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    sub = top.add_subparsers(dest="command", required=True)

    def command(name, run, node=True, **options):
        p = sub.add_parser(name)
        p.set_defaults(run=run)
        if node:
            p.add_argument("node", help="full name, such as /lineshaft")
        for option, default in options.items():
            p.add_argument(f"--{option.replace('_', '-')}", type=type(default), default=default)
        return p
    command("joint-states", joint_states, node=False, seconds=3.0, count=NO_LIMIT)
    p = command("axis-states", axis_states)
    p.add_argument("--all", action="store_true", help="all since the last call, instead of the next one")
    p = command("events", events, seconds=0.0)
    p.add_argument("--until", help="stop after the first event of this kind; none is a failure")
    command("errors", errors, seconds=0.5)
    command("log", log, node=False, seconds=1.0)
    p = command("latched-text", latched_text)
    p = command("axes", axes, timeout=rw.REPLY_S)
    p.add_argument("verb", choices=AXES_VERBS)
    p.add_argument("axes", nargs="*")
    p = command("record", record, path="", max_bag_size=0, max_bag_duration=0.0)
    p.add_argument("what", choices=RECORD_COMMANDS)
    p = command("move", move, position=0.0, velocity=0.0, acceleration=0.0, deceleration=0.0, jerk=0.0, buffer_mode=0,
                direction=0)
    p.add_argument("--axis", required=True)
    p.add_argument("--mode", choices=MOVE_MODES, default="absolute")
    p.add_argument("--units", choices=UNITS, default="si")
    p.add_argument("--cancel-after", type=float)
    p.add_argument("--wait", action="store_true")
    p.add_argument("--expect", choices=rw.STATUS.values())
    p = command("vocabulary", vocabulary, pad=0)
    p.add_argument("axis")
    p.add_argument("verb")
    p.add_argument("arguments", nargs="*", help="YAML; a \\n in it breaks the line")
    p = command("probe", probe, position=0.0, velocity=0.0, acceleration=0.0, deceleration=0.0, jerk=0.0, distance=0.0,
                expect="SUCCEEDED")
    p.add_argument("--axis", required=True)
    p.add_argument("--event", required=True)
    p.add_argument("--mode", choices=("absolute", "relative"), default="absolute")
    p.add_argument("--units", choices=UNITS, default="si")
    p.add_argument("--edge", choices=EDGES, default="rising")
    p = command("synchronize", synchronize, numerator=1, denominator=1, master_scale=0.0, slave_scale=0.0,
                master_offset=0.0, slave_offset=0.0, table="", master_increments=0,
                slave_increments=0, start_distance_increments=0, event="", offset=0.0)
    p.add_argument("--engage", choices=ENGAGES, default="immediately")
    p.add_argument("--disengage", choices=DISENGAGES[:2], default="stop")
    p.add_argument("--cam-start", choices=CAM_STARTS, default="absolute")
    p.add_argument("--axis", required=True)
    p.add_argument("--master", required=True)
    p.add_argument("--mode", choices=SYNC_MODES, default="position")
    p.add_argument("--seconds", type=float, help="cancel after this time; left out: stay coupled")
    p.add_argument("--expect", choices=rw.STATUS.values(), help="how the goal ends, instead of waiting for the coupling")
    p = command("gear-out", gear_out, at="now", increments=0, disengage="stop")
    p.add_argument("--axis", required=True)
    p = command("touch-probe", touch_probe, edge="rising", units="si", first_position=0.0, last_position=0.0)
    p.add_argument("--axis", required=True)
    p.add_argument("--event", required=True)
    p.add_argument("--continuous", action="store_true")
    p.add_argument("--window-only", action="store_true")
    p = command("abort-trigger", abort_trigger, event="")
    p.add_argument("--axis", required=True)
    p = command("phase", phase, shift=0.0, velocity=0.0, acceleration=0.0, expect="")
    p.add_argument("--axis", required=True)
    p.add_argument("--side", choices=SIDES, default="slave")
    p.add_argument("--cancel-after", type=float)
    p = command("run-function", run_function, expect="")
    p.add_argument("function")
    p.add_argument("values", nargs="*", metavar="FIELD=VALUE")
    p.add_argument("--cancel-after", type=float)
    p = command("result", result, expect="SUCCEEDED")
    p.add_argument("action", choices=ACTIONS)
    p.add_argument("goal", help="as printed by move and synchronize")
    p = command("cancel", cancel)
    p.add_argument("action", choices=ACTIONS)
    p.add_argument("goal")
    lifecycle.add_commands(command)
    parameters.add_commands(command)
    node_services.add_commands(command)
    homing.add_commands(command)
    objects.add_commands(command)
    outputs.add_commands(command)
    functions.add_commands(command)
    shaft.add_commands(command)
    streams.add_commands(command)
    gripper.add_commands(command)
    trajectories.add_commands(command)
    rtps_check.add_commands(command)
    tune.add_commands(command)
    clock.add_commands(command)
    controllers.add_commands(command)
    users.add_commands(command)
    command("action-conformance", conformance.action_conformance, axis="x", distance=0.005, velocity=0.02)
    command("hammer", hammer.hammer, axis="x", seconds=10.0, seed=1, rate=0.0)
    p = command("burst", hammer.burst, count=200)
    p.add_argument("--axis", action="append", required=True)
    command("watch", watch.watch, seconds=5.0)
    command("listen", watch.listen)
    command("join", watch.join, count=10, axis="x", depth=10)
    command("everything-read", hostile.everything_read, axis="x", megabytes=10, least=20)
    command("many-requests", hostile.many_requests, count=2000)
    command("forge", hostile.forge, axis="x", kind="heartbeat")
    command("answered", hostile.answered, axis="x", seconds=5.0)
    command("long-strings", hostile.long_strings, axis="x", megabytes=10)
    command("bad-requests", checks.bad_requests, axis="x", other="turret")
    p = command("random-goals", goals.random_goals, seconds=5.0, seed=1)
    p.add_argument("--axis", action="append", required=True, metavar="NAME=LOW:HIGH", help="range of targets in SI")
    p.add_argument("--master", help="couple an axis to this one now and then")
    command("first-replies", checks.first_replies, clients=20, axis="x")
    command("newcomer", checks.newcomer, axis="x", seconds=10.0)
    p = command("twins", checks.twins, axis="x")
    p.add_argument("--apart", action="store_true", help="each on a participant of its own")
    command("graph", checks.graph)
    command("type-hashes", checks.type_hashes)
    command("talk", talk, node=False, seconds=3.0)
    return top


def serve(peer, commands):
    for line in sys.stdin:
        words = line.split()
        done = {"done": words[0] if words else "", "ok": True}
        try:
            a = commands.parse_args(words)
            a.run(peer, a)
        except (Failure, TimeoutError) as e:
            done.update(ok=False, error=str(e))
        show(**done)


def main():
    commands = parser()
    if sys.argv[1:] == ["serve"]:
        return serve(Peer(), commands)
    try:
        a = commands.parse_args()
        a.run(Peer(), a)
    except (Failure, TimeoutError) as e:
        show(error=str(e))
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())

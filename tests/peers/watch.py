"""What a patient subscriber sees, and those who disturb it: nobody may lose a sample because of another."""
import time

import ros2wire as rw
from lineshaft_msgs import AxesRequest, AxisStates, Event
from report import Failure, show

CYCLES = 2 ** 64


# Nothing is lost while Python reads slower than a node is hammered.
WATCHED = rw.qos(depth=1_000_000)


def watch(peer, a):
    """Reads ~/events and ~/axis_states: events without a gap in their numbers, states in the order of their cycles."""
    states, topic = peer.axis_states(a.node), f"{a.node}/events"
    events = peer.once(topic, lambda: rw.Subscription(peer.dp, topic, Event, WATCHED))
    states.take(), events.take()
    cycles, numbers, times, kinds = [], [], [], {}
    end = time.monotonic() + a.seconds
    while time.monotonic() < end:
        now = time.monotonic()
        for m in states.take():
            cycles.append(m.cycle)
            times.append(now)
        for m in events.take():
            numbers.append(m.sequence)
            kinds[m.kind] = kinds.get(m.kind, 0) + 1
        time.sleep(0.002)
    missing = [(x, y) for x, y in zip(numbers, numbers[1:]) if y != x + 1]
    back = sum(y <= x for x, y in zip(cycles, cycles[1:]))
    pause = max((y - x for x, y in zip(times, times[1:])), default=a.seconds)
    # All of the stream, so that it can be compared with what somebody else saw of it.
    show(states=len(cycles), first=cycles[0] if cycles else 0, last=cycles[-1] if cycles else 0,
         sum=sum(cycles) % CYCLES, longest_pause_s=pause, events=len(numbers), kinds=kinds,
         cycles=compressed(cycles))
    if missing or back or not cycles:
        raise Failure(f"{len(cycles)} states, {back} of them out of order; events are missing between {missing[:5]}")


def compressed(cycles):
    """Runs of equal steps as [first, step, count], which keeps a line short."""
    runs = []
    for cycle in cycles:
        if runs and cycle == runs[-1][0] + runs[-1][1] * runs[-1][2]:
            runs[-1][2] += 1
        elif runs and runs[-1][2] == 1:
            runs[-1][1:] = [cycle - runs[-1][0], 2]
        else:
            runs.append([cycle, 0, 1])
    return runs


def listen(peer, a):
    """Subscribes to everything that the node publishes, and reads none of it: this process may be frozen then."""
    peer.stream("/joint_states", rw.JointState), peer.axis_states(a.node)
    peer.stream(f"{a.node}/events", Event)
    peer.once("/rosout", lambda: rw.Subscription(peer.dp, "/rosout", rw.Log, rw.ROSOUT_QOS))
    peer.once("/parameter_events", lambda: rw.Subscription(peer.dp, "/parameter_events", rw.ParameterEvent,
                                                           rw.PARAMETER_QOS))
    show(listening=True)


def join(peer, a):
    """New participants, one after the other: how long until the first sample of ~/axis_states, and until the node's
    first answer."""
    first, answered = [], []
    for _ in range(a.count):
        start = time.monotonic()
        dp = rw.participant()
        s = rw.Subscription(dp, f"{a.node}/axis_states", AxisStates, rw.qos(depth=a.depth))
        got = []
        rw.wait_until(lambda: got.extend(s.take()) or got, rw.MATCH_S, "no axis_states")
        first.append(time.monotonic() - start)
        c = peer.axes_on(dp, a.node, "reset_errors").wait()
        c.call(AxesRequest([a.axis]))
        answered.append(time.monotonic() - start)
    show(first_sample_s=sorted(first), first_answer_s=sorted(answered))

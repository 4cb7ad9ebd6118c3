"""What subscribers see where the system clock of the node is set."""
import os
import time

import ros2wire as rw
from lifecycle import CycleStatistics, DiagnosticArray
from lineshaft_msgs import AxesRequest, AxisStates, Event
from report import Failure, show

READ = rw.qos(depth=10_000)
CLOCK_STEPPED = 10372
# libfaketime may set the clock of this process, too, from its start on; it leaves the monotonic one alone.
REAL = time.time() - time.monotonic()


def real_time():
    return REAL + time.monotonic()


def seconds(stamp):
    return stamp.sec + stamp.nanosec * 1e-9


class Watched:
    """A topic: its stamps, as far as they are ahead of the real time."""

    def __init__(self, peer, topic, cls, q=READ):
        self.subscription = peer.once(f"clock {topic}", lambda: rw.Subscription(peer.dp, topic, cls, q))
        self.topic, self.last, self.ahead, self.back = topic, None, 0.0, 0.0

    def take(self):
        samples = self.subscription.take()
        for m in samples:
            stamp = seconds(m.stamp if isinstance(m, rw.Log) else m.header.stamp)
            self.back = min(self.back, stamp - self.last if self.last is not None else 0.0)
            self.last, self.ahead = stamp, stamp - real_time()
        return samples


def set_clock(path, ahead):
    """libfaketime reads the file for each reading of the system clock."""
    with open(path + ".new", "w") as f:
        f.write(f"{ahead:+.3f}\n")
    os.rename(path + ".new", path)


def one_step(a, topics, events, lines, before, step):
    """Sets the clock once. What was seen: when the event came and when each topic showed the step, in s after it."""
    for w in topics:
        w.back = 0.0
    set_clock(a.file, before + step)
    start, reported, shown, told = time.monotonic(), [], {}, 0

    def take_events():
        for m in events.take():
            if m.code == CLOCK_STEPPED:
                reported.append((time.monotonic() - start, m.text, m.severity, m.kind, events.ahead))

    while len(shown) < len(topics):
        take_events()
        told += sum("system clock was set" in m.msg for m in lines.take())
        for w in topics:
            w.take()
            if w.topic not in shown and w.last is not None and abs(w.ahead - before - step) < abs(step) / 2:
                shown[w.topic] = time.monotonic() - start
                # It may have come while this process was busy with the others.
                take_events()
                if not reported:
                    raise Failure(f"{w.topic} shows the step before its event")
        if time.monotonic() - start > 15:
            raise Failure(f"the step of {step} s is shown by {shown} alone; reported {reported}")
        time.sleep(0.001)
    if len(reported) != 1 or told != 1:
        raise Failure(f"the step of {step} s was reported {len(reported)} times, by {told} lines on /rosout: {reported}")
    at, text, severity, kind, ahead = reported[0]
    if abs(ahead - before) > abs(step) / 2:
        raise Failure(f"the event shows the step already: {ahead} s ahead")
    # But for the step itself no stamp goes back.
    back = {w.topic: w.back for w in topics if w.back < min(step, 0.0) - 1e-3}
    if back:
        raise Failure(f"stamps go back by {back}")
    show(step=step, event_s=at, text=text, severity=severity, kind=kind, shown_s=shown)


def steps(peer, a):
    topics = [Watched(peer, "/joint_states", rw.JointState), Watched(peer, f"{a.node}/axis_states", AxisStates),
              Watched(peer, "/diagnostics", DiagnosticArray),
              Watched(peer, f"{a.node}/cycle_statistics", CycleStatistics)]
    events = Watched(peer, f"{a.node}/events", Event)
    lines = Watched(peer, "/rosout", rw.Log, rw.ROSOUT_QOS)
    for w in [*topics, events, lines]:
        w.subscription.wait()
    rw.wait_until(lambda: [w.take() for w in topics] and all(w.last for w in topics), rw.REPLY_S, "no samples")
    refused = peer.axes(a.node, "enable")
    before = a.ahead
    for step in a.steps:
        one_step(a, topics, events, lines, before, step)
        before += step
        # What is answered and logged from now on shows it, too.
        events.take(), lines.take()
        refused.call(AxesRequest(["no_such_axis"]))
        seen = []
        rw.wait_until(lambda: seen.extend([*events.take(), *lines.take()]) or len(seen) > 1, rw.REPLY_S, "no refusal")
        for w in (events, lines):
            if abs(w.ahead - before) > abs(step) / 2:
                raise Failure(f"{w.topic} is {w.ahead} s ahead after the step to {before}")
    show(ahead=before)


def add_commands(command):
    p = command("clock-steps", steps, ahead=0.0)
    p.add_argument("file", help="FAKETIME_TIMESTAMP_FILE of the node")
    p.add_argument("steps", nargs="+", type=float, metavar="SECONDS")

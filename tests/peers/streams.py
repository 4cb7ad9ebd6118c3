"""Streams of velocities: ~/jog and ~/setpoints."""
import time
from dataclasses import dataclass, field

from cyclonedds.idl import IdlStruct, types as t

import ros2wire as rw
from report import show


@dataclass
class JointJog(IdlStruct, typename="control_msgs::msg::dds_::JointJog_"):
    header: rw.Header = field(default_factory=rw.Header)
    joint_names: t.sequence[str] = field(default_factory=list)
    displacements: t.sequence[t.float64] = field(default_factory=list)
    velocities: t.sequence[t.float64] = field(default_factory=list)
    duration: t.float64 = 0.0


@dataclass
class Setpoints(IdlStruct, typename="lineshaft_msgs::msg::dds_::Setpoints_"):
    header: rw.Header = field(default_factory=rw.Header)
    axes: t.sequence[str] = field(default_factory=list)
    velocities: t.sequence[t.float64] = field(default_factory=list)


class Writer:
    def __init__(self, dp, topic, cls):
        self.topic, self.writer = topic, rw.publisher(dp, topic, cls, rw.qos())

    def wait(self):
        rw.wait_until(self.writer.get_matched_subscriptions, rw.MATCH_S, f"nobody reads {self.topic}")
        return self.writer


def header(age):
    """A stamp of that many seconds ago; none without an age."""
    if age is None:
        return rw.Header()
    ns = time.time_ns() - int(age * 1e9)
    return rw.Header(stamp=rw.Time(ns // 1_000_000_000, ns % 1_000_000_000))


def stream(peer, a):
    cls, topic = (JointJog, f"{a.node}/jog") if a.topic == "jog" else (Setpoints, f"{a.node}/setpoints")
    writer = peer.once(f"write {topic}", lambda: Writer(peer.dp, topic, cls))
    pairs = [axis.split("=") for axis in a.axis]
    names, velocities = [name for name, _ in pairs], [float(velocity) for _, velocity in pairs]
    end, sent = time.monotonic() + a.seconds, 0
    while sent == 0 or time.monotonic() < end:
        if a.topic == "jog":
            writer.write(JointJog(header(a.age), names, [0.0] * a.displacements, velocities, a.duration))
        else:
            writer.write(Setpoints(header(a.age), names, velocities))
        sent += 1
        time.sleep(1.0 / a.rate)
    show(sent=sent)


def add_commands(command):
    p = command("stream", stream, seconds=0.0, rate=50.0, duration=0.0, displacements=0)
    p.add_argument("topic", choices=("jog", "setpoints"))
    p.add_argument("--axis", action="append", default=[], metavar="NAME=VELOCITY")
    p.add_argument("--age", type=float, help="seconds since the stamp; left out: no stamp")

"""What leads, from docs/contract.md, section 7."""
from dataclasses import dataclass, field

from cyclonedds.idl import IdlStruct, types as t

import ros2wire as rw
from report import show


@dataclass
class LeaderState(IdlStruct, typename="lineshaft_msgs::msg::dds_::LeaderState_"):
    name: str = ""
    valid: bool = False
    has_scale: bool = False
    position: t.float64 = 0.0
    velocity: t.float64 = 0.0
    position_increments: t.int64 = 0
    fraction: t.float64 = 0.0
    velocity_increments: t.float64 = 0.0


@dataclass
class ShaftStates(IdlStruct, typename="lineshaft_msgs::msg::dds_::ShaftStates_"):
    header: rw.Header = field(default_factory=rw.Header)
    cycle: t.uint64 = 0
    leaders: t.sequence[LeaderState] = field(default_factory=list)


def shaft(peer, a):
    """The next messages of ~/shaft, each with the axes of its cycle."""
    leaders, axes = peer.stream(f"{a.node}/shaft", ShaftStates), peer.axis_states(a.node)
    seen = ({}, {})

    def paired():
        return sorted(seen[0].keys() & seen[1].keys())

    def arrived():
        for s, by_cycle in zip((leaders, axes), seen):
            by_cycle.update((m.cycle, m) for m in s.take())
        return len(paired()) >= a.count
    for s in (leaders, axes):
        s.take()
    rw.wait_until(arrived, rw.REPLY_S, f"{a.count} messages of ~/shaft did not come")
    for cycle in paired():
        told, beside = (by_cycle[cycle] for by_cycle in seen)
        show(cycle=cycle, order=[of.name for of in told.leaders], leaders={of.name: of for of in told.leaders},
             axes={axis.name: axis for axis in beside.axes}, same_stamp=told.header.stamp == beside.header.stamp)


def add_commands(command):
    command("shaft", shaft, count=1)

"""~/tune, from docs/contract.md, section 7."""
from dataclasses import dataclass, field

from cyclonedds.idl import IdlStruct, types as t

import ros2wire as rw
from lineshaft_msgs import UNITS
from report import Failure, show

PHASES = ("", "enabling", "exciting", "disabling", "designing")


@dataclass
class TuneGoal(IdlStruct, typename="TuneGoal"):
    axis: str = ""
    units: t.uint8 = 0
    travel: t.float64 = 0.0
    velocity: t.float64 = 0.0
    effort: t.float64 = 0.0
    duration: t.float64 = 0.0
    inertia_ratio: t.float64 = 0.0
    real: bool = False
    apply: bool = False


@dataclass
class TuneResult(IdlStruct, typename="TuneResult"):
    code: t.uint32 = 0
    message: str = ""
    report: str = ""
    parameters: t.sequence[rw.Parameter] = field(default_factory=list)
    applied: bool = False


@dataclass
class TuneFeedback(IdlStruct, typename="TuneFeedback"):
    phase: t.uint8 = 0
    progress: t.float64 = 0.0
    position: t.float64 = 0.0
    velocity: t.float64 = 0.0


def tune(peer, a):
    name = f"{a.node}/tune"
    parts = ("lineshaft_msgs/Tune", TuneGoal, TuneResult, TuneFeedback)
    client = peer.once(name, lambda: rw.ActionClient(peer.dp, name, *parts))
    units = int(a.units) if a.units.isdigit() else UNITS.index(a.units)
    goal = TuneGoal(a.axis, units, a.travel, a.velocity, a.effort, a.duration, a.inertia_ratio, a.real, a.apply)
    gid, r = client.send_goal(goal)
    show(goal=gid.hex(), accepted=r.accepted)
    if not r.accepted:
        raise Failure("the goal was rejected")
    if a.until:
        phase = PHASES.index(a.until)

        def reached():
            seen = client.feedback(gid)
            return seen and seen[-1].phase == phase and seen[-1].progress >= a.progress
        rw.wait_until(reached, a.timeout, f"no feedback of phase {a.until}")
    if a.leave:
        return
    if a.cancel:
        show(cancel=client.cancel(gid).return_code)
    r = client.finish(gid, a.timeout)
    seen = client.feedback(gid)
    # Each phase once, in the order of their coming.
    phases = [PHASES[f.phase] for place, f in enumerate(seen) if place == 0 or seen[place - 1].phase != f.phase]
    result = r.result
    show(status=rw.STATUS[r.status], code=result.code, message=result.message, report=result.report,
         applied=result.applied, parameters={p.name: p.value.get() for p in result.parameters}, phases=phases,
         progress=[f.progress for f in seen], positions=[f.position for f in seen], velocities=[f.velocity for f in seen])
    if rw.STATUS[r.status] != a.expect:
        raise Failure(f"the goal ended {rw.STATUS[r.status]}, not {a.expect}: {result.message}")


def add_commands(command):
    p = command("tune", tune, units="si", travel=0.0, velocity=0.0, effort=0.0, duration=0.0, inertia_ratio=0.0,
                timeout=90.0,
                expect="SUCCEEDED", until="", progress=0.0)
    p.add_argument("--axis", required=True)
    p.add_argument("--real", action="store_true")
    p.add_argument("--apply", action="store_true")
    p.add_argument("--cancel", action="store_true", help="cancel it once it is there")
    p.add_argument("--leave", action="store_true", help="do not wait for the end")

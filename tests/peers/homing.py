"""~/home, ~/home_axis and ~/set_position, from docs/contract.md, section 7."""
import time
from dataclasses import dataclass

from cyclonedds.idl import IdlStruct, types as t

import ros2wire as rw
from lineshaft_msgs import UNITS, Answer, AxesRequest
from report import Failure, show, told

SCHEMES = ("configured", "cia402", "macs")


@dataclass
class HomeGoal(IdlStruct, typename="HomeGoal"):
    axis: str = ""
    scheme: t.uint8 = 0
    method: t.int8 = 0


@dataclass
class HomeResult(IdlStruct, typename="HomeResult"):
    code: t.uint32 = 0
    message: str = ""
    shift_increments: t.int64 = 0


@dataclass
class HomeFeedback(IdlStruct, typename="HomeFeedback"):
    phase: t.uint8 = 0
    position: t.float64 = 0.0


@dataclass
class SetPositionRequest(IdlStruct, typename="SetPositionRequest"):
    axis: str = ""
    position: t.float64 = 0.0
    units: t.uint8 = 0


def client_of(peer, a):
    name = f"{a.node}/home_axis"
    parts = ("lineshaft_msgs/HomeAxis", HomeGoal, HomeResult, HomeFeedback)
    return peer.once(name, lambda: rw.ActionClient(peer.dp, name, *parts))


def home(peer, a):
    start = time.monotonic()
    r = peer.axes(a.node, "home").call(AxesRequest(a.axes))
    told(r, seconds=time.monotonic() - start)


def home_axis(peer, a):
    client = client_of(peer, a)
    scheme = int(a.scheme) if a.scheme.isdigit() else SCHEMES.index(a.scheme)
    gid, r = client.send_goal(HomeGoal(a.axis, scheme, a.method))
    show(goal=gid.hex(), accepted=r.accepted)
    if not r.accepted:
        raise Failure("the goal was rejected")
    if a.cancel_in_phase:
        def reached():
            f = client.feedback(gid)
            return f and f[-1].phase == a.cancel_in_phase
        rw.wait_until(reached, rw.REPLY_S, f"no feedback of phase {a.cancel_in_phase}")
        show(cancel=client.cancel(gid).return_code)
    if a.leave:
        return
    r = client.finish(gid)
    feedback = client.feedback(gid)
    # Each phase once, in the order of their coming.
    phases = [f.phase for place, f in enumerate(feedback) if place == 0 or feedback[place - 1].phase != f.phase]
    show(status=rw.STATUS[r.status], result=r.result, phases=phases, positions=[f.position for f in feedback])
    if rw.STATUS[r.status] != a.expect:
        raise Failure(f"the goal ended {rw.STATUS[r.status]}, not {a.expect}: {r.result.message}")


def set_position(peer, a):
    name = "set_position_relative" if a.relative else "set_position"
    client = peer.service(a.node, name, "SetPosition", SetPositionRequest, Answer)
    units = int(a.units) if a.units.isdigit() else UNITS.index(a.units)
    told(client.call(SetPositionRequest(a.axis, a.position, units)))


def add_commands(command):
    p = command("home", home)
    p.add_argument("axes", nargs="*")
    p = command("home-axis", home_axis, scheme="configured", method=0, expect="SUCCEEDED", cancel_in_phase=0)
    p.add_argument("--axis", required=True)
    p.add_argument("--leave", action="store_true", help="do not wait for the end")
    p = command("set-position", set_position, position=0.0, units="si")
    p.add_argument("--axis", required=True)
    p.add_argument("--relative", action="store_true")

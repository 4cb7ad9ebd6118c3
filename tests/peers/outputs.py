"""~/set_output, ~/set_memory and ~/abort, from docs/contract.md, section 7."""
from dataclasses import dataclass, field

from cyclonedds.idl import IdlStruct, types as t

import ros2wire as rw
from lineshaft_msgs import Answer
from report import told


@dataclass
class SetOutputRequest(IdlStruct, typename="SetOutputRequest"):
    outputs: t.sequence[str] = field(default_factory=list)
    values: t.sequence[t.float64] = field(default_factory=list)


@dataclass
class SetMemoryRequest(IdlStruct, typename="SetMemoryRequest"):
    cells: t.sequence[str] = field(default_factory=list)
    values: t.sequence[t.float64] = field(default_factory=list)


@dataclass
class TriggerRequest(IdlStruct, typename="TriggerRequest"):
    structure_needs_at_least_one_member: t.uint8 = 0


def set_values(name, kind, request):
    def run(peer, a):
        client = peer.service(a.node, name, kind, request, Answer)
        pairs = [given.split("=") for given in a.given]
        told(client.call(request([name for name, *_ in pairs], [float(v) for _, *vs in pairs for v in vs])))

    return run


def abort(peer, a):
    name = f"{a.node}/abort"
    make = lambda: rw.ServiceClient(peer.dp, name, "std_srvs/Trigger", TriggerRequest, Answer)
    told(peer.once(name, make).call(TriggerRequest()))


def add_commands(command):
    for name, run in [
        ("set-output", set_values("set_output", "SetOutput", SetOutputRequest)),
        ("set-memory", set_values("set_memory", "SetMemory", SetMemoryRequest)),
    ]:
        command(name, run).add_argument("given", nargs="*", metavar="NAME=VALUE")
    command("abort", abort)

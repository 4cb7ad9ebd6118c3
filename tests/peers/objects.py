"""~/sdo_read and ~/sdo_write, from docs/contract.md, section 7."""
from dataclasses import dataclass, field

from cyclonedds.idl import IdlStruct, types as t

from lineshaft_msgs import Answer
from report import told


@dataclass
class SdoReadRequest(IdlStruct, typename="SdoReadRequest"):
    axis: str = ""
    backend: str = ""
    node: t.uint8 = 0
    object: str = ""
    type: str = ""


@dataclass
class SdoReadResponse(IdlStruct, typename="SdoReadResponse"):
    success: bool = False
    message: str = ""
    data: t.sequence[t.uint8] = field(default_factory=list)
    value: str = ""
    type: str = ""


@dataclass
class SdoWriteRequest(IdlStruct, typename="SdoWriteRequest"):
    axis: str = ""
    backend: str = ""
    node: t.uint8 = 0
    object: str = ""
    type: str = ""
    value: str = ""


def sdo_read(peer, a):
    client = peer.service(a.node, "sdo_read", "SdoRead", SdoReadRequest, SdoReadResponse)
    r = client.call(SdoReadRequest(a.axis, a.backend, a.device, " ".join(a.object), a.type))
    told(r, data=bytes(r.data).hex(), value=r.value, type=r.type)


def sdo_write(peer, a):
    client = peer.service(a.node, "sdo_write", "SdoWrite", SdoWriteRequest, Answer)
    told(client.call(SdoWriteRequest(a.axis, a.backend, a.device, " ".join(a.object), a.type, " ".join(a.value))))


def add_commands(command):
    for name, run in (("sdo-read", sdo_read), ("sdo-write", sdo_write)):
        p = command(name, run, axis="", backend="", device=0, type="")
        p.add_argument("--object", nargs="*", default=[])
        if run is sdo_write:
            p.add_argument("--value", nargs="*", default=[])

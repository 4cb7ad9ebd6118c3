"""Function slots and tables, from docs/contract.md, sections 7 and 10."""
from dataclasses import dataclass, field

from cyclonedds.idl import IdlStruct, types as t

import ros2wire as rw
from lineshaft_msgs import Answer
from report import Failure, show, told

COMMANDS = {"reset": 0, "start": 1, "value_new": 5, "read_value": 6}


@dataclass
class FunctionState(IdlStruct, typename="lineshaft_msgs::msg::dds_::FunctionState_"):
    name: str = ""
    type: str = ""
    slot: t.uint16 = 0
    active: bool = False
    error_code: t.uint32 = 0
    sink: t.int64 = 0
    inputs: t.uint8 = 0
    outputs: t.uint8 = 0
    sak_share: t.int64 = 0


@dataclass
class FunctionStates(IdlStruct, typename="lineshaft_msgs::msg::dds_::FunctionStates_"):
    header: rw.Header = field(default_factory=rw.Header)
    cycle: t.uint64 = 0
    functions: t.sequence[FunctionState] = field(default_factory=list)


@dataclass
class CommandRequest(IdlStruct, typename="CommandFunctionRequest"):
    function: str = ""
    command: t.uint8 = 0
    parameters: t.sequence[rw.Parameter] = field(default_factory=list)


@dataclass
class CommandResponse(IdlStruct, typename="CommandFunctionResponse"):
    success: bool = False
    message: str = ""
    active: t.sequence[rw.Parameter] = field(default_factory=list)


@dataclass
class LoadRequest(IdlStruct, typename="LoadTableRequest"):
    table: str = ""
    x: t.sequence[t.int64] = field(default_factory=list)
    y: t.sequence[t.int64] = field(default_factory=list)


@dataclass
class ProgramRequest(IdlStruct, typename="LoadProgramRequest"):
    program: str = ""
    module: t.sequence[t.uint8] = field(default_factory=list)
    keep_state: bool = False


@dataclass
class GetRequest(IdlStruct, typename="GetTableRequest"):
    table: str = ""


@dataclass
class GetResponse(IdlStruct, typename="GetTableResponse"):
    success: bool = False
    message: str = ""
    form: str = ""
    x: t.sequence[t.int64] = field(default_factory=list)
    y: t.sequence[t.int64] = field(default_factory=list)


def function(peer, a):
    """A refusal shows the set in force, too."""
    client = peer.service(a.node, "command_function", "CommandFunction", CommandRequest, CommandResponse)
    number = COMMANDS[a.what] if a.what in COMMANDS else int(a.what)
    pairs = [given.split("=", 1) for given in a.values]
    parameters = [rw.Parameter(name, rw.ParameterValue.of(rw.parsed(value))) for name, value in pairs]
    r = client.call(CommandRequest(a.function, number, parameters))
    told(r, active={p.name: p.value.get() for p in r.active})


def load(peer, a):
    numbers = lambda text: [int(number) for number in text.split(",") if number]
    client = peer.service(a.node, "load_table", "LoadTable", LoadRequest, Answer)
    told(client.call(LoadRequest(a.table, numbers(a.x), numbers(a.y))))


def load_program(peer, a):
    client = peer.service(a.node, "load_program", "LoadProgram", ProgramRequest, Answer)
    with open(a.wasm, "rb") as file:
        module = list(file.read())
    told(client.call(ProgramRequest(a.program, module, a.keep == "keep")))


def load_long(peer, a):
    """So many values that neither request nor answer fits a few datagrams."""
    client = peer.service(a.node, "load_table", "LoadTable", LoadRequest, Answer)
    told(client.call(LoadRequest(a.table, [], [k % 65536 for k in range(a.count)])))
    r = got(peer, a)
    if list(r.y) != [k % 65536 for k in range(a.count)]:
        raise Failure(f"{len(r.y)} values came back, or others")
    show(count=len(r.y))


def got(peer, a):
    return peer.service(a.node, "get_table", "GetTable", GetRequest, GetResponse).call(GetRequest(a.table))


def get(peer, a):
    r = got(peer, a)
    told(r, form=r.form, x=r.x, y=r.y)


def states(peer, a):
    """The messages of some time: how many, and the last one."""
    s = peer.stream(f"{a.node}/functions", FunctionStates)
    s.take()
    messages = []

    def arrived():
        messages.extend(s.take())
        return len(messages) >= a.count
    rw.wait_until(arrived, rw.REPLY_S, "~/functions stopped")
    stamps = [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for m in messages]
    steps = [(b - a) / 1e9 for a, b in zip(stamps, stamps[1:])]
    show(cycle=messages[-1].cycle, functions={f.name: f for f in messages[-1].functions}, steps=steps,
         order=[f.name for f in messages[-1].functions])


def add_commands(command):
    p = command("function", function)
    p.add_argument("function")
    p.add_argument("what", help="reset, start, value_new, read_value, or a number")
    p.add_argument("values", nargs="*", metavar="FIELD=VALUE")
    p = command("load-table", load, x="", y="")
    p.add_argument("table")
    p = command("load-program", load_program)
    p.add_argument("program")
    p.add_argument("wasm")
    p.add_argument("keep", choices=["keep", "reset"])
    p = command("load-long-table", load_long, count=65536)
    p.add_argument("table")
    p = command("get-table", get)
    p.add_argument("table")
    command("functions", states, count=1)

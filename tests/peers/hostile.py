"""Samples that no ROS 2 program would send, to everything that a node reads."""
import os
import socket
import struct
import time

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsSubscription

import ros2wire as rw
from checks import RawWriter, node_info
from lineshaft_msgs import (AxesRequest, Event, ImportRequest, MoveGoal, RecordRequest, ResetRequest,
                            VocabularyRequest)
from report import Checklist, Failure, show

LITTLE, BIG = b"\x00\x01\x00\x00", b"\x00\x00\x00\x00"
HEADER = struct.pack("<Qq", 0x1122334455667788, 1)
SHORT = 2_000  # longest sentence (bytes) that is a sentence: names may be long, and all axes may be named


def shapes(megabytes, turn):
    """By name, of the long ones the one whose turn it is: the library keeps samples that were taken. None of them is a good request to any of the services, or one that does nothing."""
    many = megabytes * 1_000_000
    long = [
        (f"{megabytes} MB of zeros", LITTLE + HEADER + bytes(many)),
        (f"{megabytes} MB of ones", LITTLE + HEADER + b"\xff" * many),
        (f"a string of {megabytes} MB", LITTLE + HEADER + struct.pack("<I", many + 1) + b"x" * many + b"\0"),
    ]
    return {
        "an unknown encapsulation": b"\x00\x99\x00\x00" + bytes(40),
        "half a header": LITTLE + HEADER[:8],
        "a header alone": LITTLE + HEADER,
        "a header and ones": LITTLE + HEADER + b"\xff" * 400,
        "ones": LITTLE + b"\xff" * 400,
        "big endian ones": BIG + b"\xff" * 400,
        "a length of 4 GiB": LITTLE + HEADER + b"\xff\xff\xff\xff" + bytes(40),
        "a length of 4 GiB behind a goal id": LITTLE + HEADER + bytes(16) + b"\xff\xff\xff\xff" + bytes(40),
        "many empty strings": LITTLE + HEADER + struct.pack("<I", 4000) + struct.pack("<II", 1, 0) * 4000,
        **dict([long[turn % len(long)]]),
    }


def targets(peer, node):
    """Topic and type of everything that the node reads of others."""
    readers = {bytes(g.data) for g in node_info(peer, node).reader_gid_seq}
    known = BuiltinDataReader(peer.dp, BuiltinTopicDcpsSubscription)
    rw.wait_until(lambda: readers <= {e.key.bytes for e in known.read(10_000) if e.sample_info.valid_data}, rw.MATCH_S,
                  "readers of the node that discovery does not know")
    found = {(e.topic_name, e.type_name) for e in known.read(10_000)
             if e.sample_info.valid_data and e.key.bytes in readers}
    return sorted(found)


def everything_read(peer, a):
    """All shapes to all topics that the node reads. It must stay as it is, and answer others meanwhile."""
    states = peer.axis_states(a.node)
    client = peer.axes(a.node, "reset_errors")
    before = peer.latest_axes(a.node)
    found = targets(peer, a.node)
    slowest = 0.0
    for turn, (topic, type_name) in enumerate(found):
        writer = RawWriter(topic, type_name)
        for name, payload in shapes(a.megabytes, turn).items():
            writer.write(payload)
            time.sleep(0.002)
        start = time.monotonic()
        client.call(AxesRequest([a.axis]))
        slowest = max(slowest, time.monotonic() - start)
    time.sleep(0.5)
    want = {x.name: (x.command_increments, x.enabled, x.state) for x in before.axes}
    changed = sorted({x.name for m in states.take() for x in m.axes
                      if (x.command_increments, x.enabled, x.state) != want[x.name]})
    show(topics=len(found), shapes=len(shapes(1, 0)), slowest_answer_s=slowest, changed=changed)
    if changed:
        raise Failure(f"{changed} did something")
    if len(found) < a.least:
        raise Failure(f"only {len(found)} topics that the node reads were found: {found}")


def long_strings(peer, a):
    """Good requests with a text of many MB wherever a text may stand: each is answered, with a sentence that is short."""
    checks, long = Checklist(), "x" * (a.megabytes * 1_000_000)
    events = peer.stream(f"{a.node}/events", Event)
    log = peer.once("/rosout", lambda: rw.Subscription(peer.dp, "/rosout", rw.Log, rw.ROSOUT_QOS))
    events.take(), log.take()
    p = rw.ParameterClient(peer.dp, a.node).wait()
    value = rw.ParameterValue.of

    def refused(name, call):
        def told():
            success, message = call()
            return success, len(message.encode()), message[:60]
        checks.check(name, told, lambda t: not t[0] and t[1] < SHORT)

    def axes(verb, *names):
        r = peer.axes(a.node, verb).call(AxesRequest(list(names)))
        return r.success, r.message
    for verb in ("enable", "disable", "halt", "quick_stop", "reset_errors", "home"):
        refused(f"{verb} of a long name", lambda: axes(verb, long))
    refused("enable of a long name after a good one", lambda: axes("enable", a.axis, long))

    def set_one(name, v):
        r = p.c_set.call(rw.ParametersRequest([rw.Parameter(name, value(v))])).results[0]
        return r.successful, r.reason

    def set_all(name, v):
        r = p.c_atomic.call(rw.ParametersRequest([rw.Parameter(name, value(v))])).result
        return r.successful, r.reason
    for door in (set_one, set_all):
        refused("a set of a long name", lambda: door(long, 1.0))
        refused("a set of a long name of an axis", lambda: door(f"{a.axis}.{long}", 1.0))
        refused("a long text for a name", lambda: door(f"{a.axis}.profile", long))
        refused("a long text for a number", lambda: door(f"{a.axis}.max_velocity", long))
    for name, client in (("get", p.c_get), ("types", p.c_types), ("describe", p.c_describe)):
        checks.check(f"{name} of a long name is answered with nothing", lambda: [
            len(v) for v in vars(client.call(rw.NamesRequest([f"{a.axis}.max_velocity", long]))).values()], [0])
        many = [f"{a.axis}.max_velocity"] * 100_000
        checks.check(f"{name} of one name a hundred thousand times too", lambda: [
            len(v) for v in vars(client.call(rw.NamesRequest(many))).values()], [0])
    many = rw.ParametersRequest([rw.Parameter(f"{a.axis}.max_velocity", value(1.0))] * 20_000)
    refused("a set of one name 20,000 times", lambda: (lambda r: (r[0].successful, r[0].reason))(
        p.c_set.call(many).results))
    refused("and at the other door", lambda: (lambda r: (r.successful, r.reason))(p.c_atomic.call(many).result))
    checks.check("list of a long prefix", lambda: p.list([long]).names, [])

    def told(r):
        return r.success, r.message
    refused("a vocabulary of a long axis", lambda: told(peer.vocabulary(a.node).call(VocabularyRequest(long, "wf", ""))))
    refused("a long verb", lambda: told(peer.vocabulary(a.node).call(VocabularyRequest(a.axis, long, ""))))
    refused("long arguments", lambda: told(peer.vocabulary(a.node).call(VocabularyRequest(a.axis, "wf", long))))
    refused("a long path", lambda: told(peer.record(a.node).call(RecordRequest(1, long, 0, 0.0))))
    refused("a long import", lambda: told(peer.import_parameters(a.node).call(ImportRequest(long))))
    refused("a reset of a long name", lambda: told(peer.reset_parameters(a.node).call(ResetRequest([long], 0))))
    action = peer.action(a.node, "move_axis")
    checks.check("a goal of a long axis", lambda: action.send_goal(MoveGoal(long))[1].accepted, False)
    time.sleep(0.5)
    longest = max([len(m.text) for m in events.take()] + [0])
    lines = [len(m.msg) for m in log.take()]
    show(longest_event=longest, longest_line=max(lines + [0]), lines=len(lines))
    checks.check("events are short", lambda: longest, lambda n: 0 < n < SHORT)
    checks.check("lines of the log are short", lambda: max(lines + [0]), lambda n: n < SHORT)
    checks.close()


def many_requests(peer, a):
    """Good requests of 50 kB each, one after the other."""
    c = rw.ParameterClient(peer.dp, a.node).wait().c_get
    names = ["x" * 1000] * 50
    start = time.monotonic()
    for _ in range(a.count):
        c.call(rw.NamesRequest(names))
    show(requests=a.count, seconds=time.monotonic() - start)


def forge(peer, a):
    """Datagrams in the name of a writer of ours that the node has matched, which claim what no writer has."""
    client = peer.axes(a.node, "reset_errors")
    client.call(AxesRequest([a.axis]))
    known = BuiltinDataReader(peer.dp, BuiltinTopicDcpsSubscription)
    topic = f"rq{a.node}/reset_errorsRequest"
    readers = [e.key.bytes for e in known.read(10_000) if e.sample_info.valid_data and e.topic_name == topic]
    port = 7400 + 250 * int(os.environ["ROS_DOMAIN_ID"]) + 11
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
        for reader in readers:
            datagram = forged(a.kind, client.w.guid.bytes, reader)
            for program in range(32):
                out.sendto(datagram, ("127.0.0.1", port + 2 * program))
    show(kind=a.kind, readers=len(readers))


def forged(kind, writer, reader):
    ends = reader[12:] + writer[12:]
    number = lambda n: struct.pack("<iI", n >> 32, n & 0xffffffff)  # noqa: E731
    sub, body = {
        "heartbeat": (0x07, ends + number(1) + number(2 ** 62) + struct.pack("<I", 1 << 20)),
        "gap": (0x08, ends + number(1) + number(2 ** 62) + struct.pack("<I", 0)),
        "fragment": (0x16, struct.pack("<HH", 0, 28) + ends + number(77) + struct.pack("<IHHI", 1, 1, 0xffff, 0xffffffff)
                     + bytes(64)),
    }[kind]
    to = b"\x0e\x01\x0c\x00" + reader[:12]
    return b"RTPS\x02\x01\x01\x10" + writer[:12] + to + struct.pack("<BBH", sub, 1, len(body)) + body


def answered(peer, a):
    """How long it takes until the node answers, whatever has become of its participant."""
    client, start = peer.axes(a.node, "reset_errors"), time.monotonic()
    while time.monotonic() - start < a.seconds:
        try:
            client.call(AxesRequest([a.axis]), 0.3)
        except TimeoutError:
            continue
        return show(answered_s=time.monotonic() - start)
    raise Failure(f"no answer within {a.seconds} s")

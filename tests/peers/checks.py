"""Checks of a running node that need more than one request: malformed requests, new clients, the graph."""
import math
import struct
import time
from dataclasses import dataclass

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication, BuiltinTopicDcpsSubscription
from cyclonedds.core import Policy
from cyclonedds.idl import IdlStruct, types as t
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic

import ros2wire as rw
from lineshaft_msgs import Answer, AxesRequest, MoveGoal
from report import Failure, show

RELATIVE, SI = 1, 0


class RawWriter:
    """Writes given bytes, encapsulation header included, to a topic, on a participant of its own."""

    def __init__(self, topic, type_name, dp=None):
        @dataclass
        class Raw(IdlStruct, typename=type_name):
            unused: t.uint8 = 0

            def serialize(self, **_):
                return self.payload
        self.Raw = Raw
        self.dp, q = dp or rw.participant(), rw.SERVICE_QOS
        self.w = DataWriter(self.dp, Topic(self.dp, topic, Raw, qos=q), qos=q)
        rw.wait_until(self.w.get_matched_subscriptions, rw.MATCH_S, f"nobody reads {topic}")

    def write(self, payload):
        sample = self.Raw()
        sample.payload = payload
        self.w.write(sample)


class RawClient(RawWriter):
    """A client of `service` that writes given bytes."""

    def __init__(self, service, request_type):
        super().__init__(f"rq{service.name}Request", request_type)
        self.name, q = service.name, rw.SERVICE_QOS
        self.r = DataReader(self.dp, Topic(self.dp, f"rr{service.name}Reply", service.Resp, qos=q), qos=q)
        self.client = int.from_bytes(self.w.guid.bytes[8:16], "little")

    def wait(self):
        rw.wait_until(lambda: self.w.get_matched_subscriptions() and self.r.get_matched_publications(), rw.MATCH_S,
                      f"nobody serves {self.name}")
        return self

    def deliver(self, shapes, accepted, must_answer):
        """Sends each of the named shapes under a number of its own; returns the names that were answered with yes, and
        those of `must_answer` that were not answered at all."""
        names, answered, yes = list(shapes), set(), []

        def take():
            for m in self.r.take(100):
                if m.sample_info.valid_data and m.client == self.client:
                    name = names[m.seq] if 0 <= m.seq < len(names) else f"number {m.seq}"
                    answered.add(name)
                    if accepted(m.data):
                        yes.append(name)
        for number, name in enumerate(names):
            payload = shapes[name]
            numbered = len(payload) >= HEADER.stop and "header" not in name
            if numbered:
                payload = payload[:SEQUENCE.start] + struct.pack("<q", number) + payload[SEQUENCE.stop:]
            self.write(payload)
            # Slowly, because both ends keep no more than ten samples.
            for _ in range(5):
                time.sleep(0.004)
                take()
        time.sleep(0.5)
        take()
        silent = sorted(must_answer - answered)
        show(to=self.name, sent=len(shapes), answered=len(answered), accepted=yes, silent=silent)
        return yes + silent


HEADER = slice(4, 20)  # rmw_cyclonedds' header, after the four bytes of encapsulation
SEQUENCE = slice(12, 20)


def malformed(good, length_at):
    """Named wrong forms of one good request; `length_at` is where its first string or sequence length stands."""
    padded = good.ljust(-(-len(good) // 4) * 4, b"\0")
    shapes = {
        "4 bytes too many": padded + bytes(4),
        "8 bytes too many": padded + bytes(8),
        "1000 bytes too many": padded + bytes(1000),
        "no header, the form of another RMW": good[:4] + good[HEADER.stop:],
        "the header twice": good[:HEADER.stop] + good[HEADER] + good[HEADER.stop:],
        "unknown encapsulation": b"\x00\xff\x00\x00" + good[4:],
        "a length of 4 GiB": good[:length_at] + b"\xff\xff\xff\xff" + good[length_at + 4:],
        "a length beyond the end": good[:length_at] + struct.pack("<I", len(good)) + good[length_at + 4:],
    }
    shapes.update({f"cut after {n} bytes": padded[:n] for n in range(8, len(padded), 4)})
    return shapes


def bad_requests(peer, a):
    """Sends requests that must not do anything, and compares the machine before, meanwhile and after.

    `a.axis` should be enabled, so that it could move, and `a.other` disabled, so that it could be enabled.
    """
    states, joints = peer.axis_states(a.node), peer.joint_states()
    before = peer.latest_axes(a.node)
    joints.take()

    bad = bad_goals(peer, a) + bad_enables(peer, a)
    time.sleep(0.5)
    want = {x.name: (x.command_increments, x.enabled, x.state) for x in before.axes}
    changed = sorted({x.name for m in states.take() for x in m.axes
                      if (x.command_increments, x.enabled, x.state) != want[x.name]})
    positions = [dict(zip(m.name, m.position)) for m in joints.take()]
    moved = sorted({n for p in positions for n, v in p.items() if abs(v - positions[0][n]) > 1e-6})
    show(changed=changed, moved=moved, joint_states=len(positions))
    if bad or changed or moved:
        raise Failure(f"accepted or not answered: {bad}, axis_states changed: {changed}, joint_states moved: {moved}")
    r = peer.axes(a.node, "reset_errors").call(AxesRequest([a.axis]))
    show(still_answers=True, success=r.success, message=r.message)


def bad_goals(peer, a):
    client = peer.action(a.node, "move_axis")
    raw = RawClient(client.c_goal, "lineshaft_msgs::action::dds_::MoveAxis_SendGoal_Request_").wait()

    def sample(**fields):
        g = MoveGoal(**{"axis": a.axis, "mode": RELATIVE, "units": SI, "position": 0.01, **fields})
        request = client.c_goal.Req(raw.client, 0, client.SendGoalRequest(rw.UUID.random(), g))
        return request.serialize(use_version_2=False)

    broken = malformed(sample(), length_at=36)  # 4 encapsulation, 16 header, 16 goal id
    broken["an axis name that is not UTF-8"] = sample().replace(a.axis.encode() + b"\0", b"\xff" * len(a.axis) + b"\0")
    wrong = {"an axis name of 1 MB": sample(axis="x" * 1_000_000)}
    for field in ("position", "velocity", "acceleration", "deceleration", "jerk"):
        for value in (math.nan, math.inf, -math.inf):
            wrong[f"{value} as {field}"] = sample(**{field: value})
    return raw.deliver({**broken, **wrong}, lambda r: r.accepted, set(wrong))


def bad_enables(peer, a):
    client = peer.axes(a.node, "enable")
    raw = RawClient(client, "lineshaft_msgs::srv::dds_::AxesCommand_Request_").wait()

    def sample(*axes):
        return client.Req(raw.client, 0, AxesRequest(list(axes))).serialize(use_version_2=False)

    broken = malformed(sample(a.other), length_at=20)
    wrong = {
        "an axis name of 1 MB": sample("x" * 1_000_000),
        "an unknown axis after a good one": sample(a.other, "no_such_axis"),
        "an empty axis name": sample(""),
    }
    return raw.deliver({**broken, **wrong}, lambda r: r.success, set(wrong))


def first_replies(peer, a):
    """New clients, each on a participant of its own, call as soon as they see the server: no reply may be lost."""
    lost, slowest = 0, 0.0
    for _ in range(a.clients):
        c = rw.ServiceClient(rw.participant(), f"{a.node}/reset_errors", "lineshaft_msgs/AxesCommand", AxesRequest,
                             Answer).wait()
        start = time.monotonic()
        try:
            c.call(AxesRequest([a.axis]), 3.0)
            slowest = max(slowest, time.monotonic() - start)
        except TimeoutError:
            lost += 1
    show(clients=a.clients, lost=lost, slowest_s=slowest)
    if lost:
        raise Failure(f"{lost} of {a.clients} new clients lost their first reply")


def twins(peer, a):
    """Two clients of one service in one process, on one participant or `--apart`: every answer comes, and none twice. (Cyclone DDS shows
    each client what is for another one of its participant, too.)"""
    participants = [peer.dp, rw.participant() if a.apart else peer.dp]
    both = [rw.ServiceClient(dp, f"{a.node}/reset_errors", "lineshaft_msgs/AxesCommand", AxesRequest, Answer,
                             own=rw.qos(depth=100)).wait() for dp in participants]
    asked = {(c.client, c.send(AxesRequest([a.axis]))) for _ in range(10) for c in both}
    seen = [[], []]
    its = [{one for one in asked if one[0] == c.client} for c in both]
    rw.wait_until(lambda: all([take(c, got) >= own for c, got, own in zip(both, seen, its)]), rw.REPLY_S, "an answer is missing")
    time.sleep(0.5)
    for c, got in zip(both, seen):
        take(c, got)
    show(answers=[len(got) for got in seen])
    if any(len(got) != len(set(got)) for got in seen):
        raise Failure(f"answers came twice: {[len(got) for got in seen]} of {len(asked)}")


def take(client, got):
    got += [(m.client, m.seq) for m in client.r.take(100) if m.sample_info.valid_data]
    return set(got)


def newcomer(peer, a):
    """How long a new participant needs until a node that it has never heard of has answered it."""
    start = time.monotonic()
    c = rw.ServiceClient(rw.participant(), f"{a.node}/reset_errors", "lineshaft_msgs/AxesCommand", AxesRequest,
                         Answer).wait(a.seconds)
    found = time.monotonic() - start
    c.call(AxesRequest([a.axis]), a.seconds)
    show(found_s=found, answered_s=time.monotonic() - start)


def node_info(peer, node):
    """What ros_discovery_info says of a node now."""
    s = peer.once("graph", lambda: rw.Subscription(peer.dp, "ros_discovery_info", rw.ParticipantEntitiesInfo,
                                                   rw.DISCOVERY_QOS, prefix=""))
    nodes = peer.made.setdefault("graph nodes", {})

    def announced():
        for m in s.take():
            for n in m.node_entities_info_seq:
                nodes[n.node_namespace.rstrip("/") + "/" + n.node_name] = n
        return node in nodes
    rw.wait_until(announced, rw.MATCH_S, f"{node} is not in ros_discovery_info")
    time.sleep(0.5)
    announced()
    return nodes[node]


def graph(peer, a):
    """The node's endpoints as ros_discovery_info announces them, with the topics that DDS discovery knows for them."""
    node = node_info(peer, a.node)
    readers = {kind: BuiltinDataReader(peer.dp, kind) for kind in
               (BuiltinTopicDcpsPublication, BuiltinTopicDcpsSubscription)}
    time.sleep(0.5)

    def topics(kind, gids):
        known = {e.key.bytes: e.topic_name for e in readers[kind].read(10_000) if e.sample_info.valid_data}
        found = [known.get(bytes(g.data)) for g in gids]
        return sorted(x for x in found if x), found.count(None)
    writes, strange_w = topics(BuiltinTopicDcpsPublication, node.writer_gid_seq)
    reads, strange_r = topics(BuiltinTopicDcpsSubscription, node.reader_gid_seq)
    show(node=a.node, writes=writes, reads=reads, unknown=strange_w + strange_r)
    if strange_w + strange_r:
        raise Failure(f"{strange_w + strange_r} announced endpoints do not exist")


def type_hashes(peer, a):
    """USER_DATA of the node's endpoints in discovery, which has the type hashes of ROS 2; and the endpoints without it."""
    node = node_info(peer, a.node)
    hashes = {}
    for verb, kind, gids in (("writes", BuiltinTopicDcpsPublication, node.writer_gid_seq),
                             ("reads", BuiltinTopicDcpsSubscription, node.reader_gid_seq)):
        reader, own = BuiltinDataReader(peer.dp, kind), {bytes(g.data) for g in gids}
        time.sleep(0.5)
        for e in reader.read(10_000):
            if e.sample_info.valid_data and e.key.bytes in own:
                data = [bytes(policy.data) for policy in e.qos if isinstance(policy, Policy.Userdata)]
                hashes[f"{verb} {e.topic_name}"] = b"".join(data).decode()
    show(node=a.node, hashes=hashes, missing=sorted(endpoint for endpoint, data in hashes.items() if not data))

"""Checks what a node sends for what other DDS implementations cannot bear.

gap        A GAP covers a sample of which some, but not all, fragments went to that reader. A reader of Fast DDS (2.6 to 2.14) then
           loops for ever with its lock held.
heartbeat  The count of a writer's HEARTBEATs to one reader and address does not rise: receivers ignore that HEARTBEAT.
acknack    The same of ACKNACKs.
announced  Two announcements of an endpoint have the same sequence number, and differ in more than USER_DATA.
late       A HEARTBEAT to a reader of the node that announces samples is answered by no ACKNACK within some time.
"""
import os
import struct
import time

from report import Failure, show
from rtps import ACKNACK, DATA, DATA_FRAG, GAP, HEARTBEAT, INFO_DST, Sniffer, fragments, number, numbers, submessages

RUSTDDS = b"\x01\x12"  # how GUIDs of the node begin
ANNOUNCERS = (b"\0\0\3\xc2", b"\0\0\4\xc2")  # built-in writers that announce endpoints
USER_DATA, SENTINEL = 0x2C, 0x01
LATE_S = 0.3
SHOWN = 10


class Check:
    def __init__(self):
        self.sent, self.whole, self.counts, self.asked = {}, {}, {}, {}
        self.found = {"gap": [], "heartbeat": [], "acknack": [], "announced": []}
        self.announced, self.with_hash = {}, set()
        self.seen, self.latest, self.late = set(), 0.0, 0

    def take(self, at, address, payload):
        for kind, flags, order, body, source, to in submessages(payload):
            self.seen.add(source)
            ours = source.startswith(RUSTDDS)
            if ours and kind == DATA_FRAG:
                sample, first, count, whole = fragments(order, body)
                key = (address, to, source + body[8:12], sample)
                self.sent.setdefault(key, set()).update(range(first, first + count))
                self.whole[key] = whole
            elif ours and kind == DATA and body[8:12] in ANNOUNCERS and not flags & 0b1010:
                self.announcement(source + body[8:20], *user_data(body[20:]))
            elif ours and kind == GAP:
                self.gap(address, to, source + body[4:8], number(order, body[8:16]), *numbers(order, body[16:]))
            elif kind in (HEARTBEAT, ACKNACK) and ours and not to.startswith(RUSTDDS):
                self.count(kind, order, body, source, to, address, at)
            elif kind == HEARTBEAT and not ours and to.startswith(RUSTDDS) and not flags & 2:
                if number(order, body[16:24]) >= number(order, body[8:16]):
                    self.asked.setdefault((to, source, body[4:8]), at)

    def gap(self, address, to, writer, first, base, members):
        for key, have in self.sent.items():
            covered = first <= key[3] < base or key[3] in members
            if key[:3] == (address, to, writer) and covered and len(have) < self.whole[key]:
                self.found["gap"].append(f"sample {key[3]} of {writer.hex()} to {to.hex()} at {address}: "
                                         f"{len(have)} of {self.whole[key]} fragments were sent")

    def announcement(self, sample, rest, data):
        """`sample`: participant, writer and sequence number."""
        if self.announced.setdefault(sample, rest) != rest:
            self.found["announced"].append(f"{sample.hex()}: {rest.hex()} and {self.announced[sample].hex()}")
        if b"typehash=RIHS01_" in data:
            self.with_hash.add(sample)

    def count(self, kind, order, body, source, to, address, at):
        reader, writer = body[:4], body[4:8]
        count = struct.unpack(order + "I", body[-4:] if kind == ACKNACK else body[24:28])[0]
        key = (kind, source, to, reader, writer, address)
        before = self.counts.get(key, -1)
        if count <= before:
            self.found["heartbeat" if kind == HEARTBEAT else "acknack"].append(
                f"count {count} after {before} to {to.hex()}, reader {reader.hex()}, writer {writer.hex()}, at {address}")
        self.counts[key] = max(count, before)
        since = self.asked.pop((source, to, writer), None) if kind == ACKNACK else None
        if since is not None:
            self.latest = max(self.latest, at - since)
            self.late += at - since > LATE_S


def user_data(payload):
    """The parameter list without USER_DATA, and USER_DATA."""
    order, rest, data, i = "<" if payload[1:2] == b"\3" else ">", payload[:4], b"", 4
    while i + 4 <= len(payload):
        kind, length = struct.unpack(order + "HH", payload[i:i + 4])
        if kind == USER_DATA:
            data += payload[i + 4:i + 4 + length]
        else:
            rest += payload[i:i + 4 + length]
        if kind == SENTINEL:
            break
        i += 4 + length
    return rest, data


def message(*parts):
    """An RTPS message of the node with these submessages: (kind, body)."""
    header = b"RTPS" + bytes(4) + RUSTDDS + bytes(10)
    return header + b"".join(struct.pack("<BBH", kind, 1, len(body)) + body for kind, body in parts)


def prove_itself():
    """The check finds what it is for, and nothing in traffic without it."""
    writer, to = bytes(8), (INFO_DST, b"\x01\x0f" + bytes(10))

    def fragment(first, count):
        return DATA_FRAG, bytes(4) + writer + struct.pack("<iIIHHI", 0, 7, first, count, 1000, 3000)

    def gap(first, base):
        return GAP, writer + struct.pack("<iIiII", 0, first, 0, base, 0)

    def heartbeat(count):
        return HEARTBEAT, writer + struct.pack("<iIiIi", 0, 1, 0, 7, count)

    def acknack(count):
        return ACKNACK, writer + struct.pack("<iIIi", 0, 1, 0, count)

    def announced(*parameters):
        head = bytes([0, 0, 16, 0]) + bytes(4) + ANNOUNCERS[0] + struct.pack("<iI", 0, 7) + bytes([0, 3, 0, 0])
        return DATA, head + b"".join(struct.pack("<HH4s", kind, 4, text) for kind, text in parameters) + b"\1\0\0\0"

    topic, other, data = (0x05, b"rt/x"), (0x05, b"rt/y"), (USER_DATA, b"abc;")
    for parts, kind in [([fragment(1, 2), gap(5, 8)], "gap"), ([fragment(1, 2), gap(5, 7)], None),
                        ([fragment(1, 2), fragment(3, 1), gap(5, 8)], None), ([heartbeat(2), heartbeat(2)], "heartbeat"),
                        ([heartbeat(2), heartbeat(3)], None), ([acknack(3), acknack(1)], "acknack"),
                        ([acknack(1), acknack(3)], None), ([announced(topic, data), announced(topic)], None),
                        ([announced(topic), announced(other)], "announced")]:
        check = Check()
        for part in parts:
            check.take(0.0, ("127.0.0.1", 7411), message(to, part))
        found = [one for one, all in check.found.items() if all]
        if found != ([kind] if kind else []):
            raise Failure(f"the check of {parts} finds {found}")


def rtps_watch(peer, a):
    """Watches the traffic of this domain, for rtps-check."""
    prove_itself()
    peer.sniffer = Sniffer(int(os.environ["ROS_DOMAIN_ID"]))


def rtps_check(peer, a):
    """Checks the traffic since rtps-watch."""
    check = Check()
    for datagram in peer.sniffer.stop():
        check.take(*datagram)
    nodes = sum(prefix.startswith(RUSTDDS) for prefix in check.seen)
    show(nodes=nodes, others=len(check.seen) - nodes, late=check.late, latest_s=check.latest,
         with_hash=len(check.with_hash), fragmented=len({key[2:] for key in check.sent}), **{kind: all[:SHOWN] for kind, all in check.found.items()})
    if any(check.found.values()):
        raise Failure(f"found {({kind: len(all) for kind, all in check.found.items()})}")


def add_commands(command):
    command("rtps-watch", rtps_watch, node=False)
    command("rtps-check", rtps_check, node=False)

#!/usr/bin/env python3
"""Mutated datagrams to the ROS side of a node, as many as are asked for, while its axes turn and its clients work.

    cargo build --release && cargo test --workspace --test end_to_end peers_setup
    tests/soak/mutate.py --count 200000 --out target/mutate

Two clients work at a node in a network namespace that this script makes (root is needed). What they send is caught, changed and
sent again to where it went: bits, words, lengths, pieces of others, and HEARTBEAT, HEARTBEAT_FRAG, GAP, DATA_FRAG, ACKNACK and
NACK_FRAG of any range in the name of who sent it (in every second batch: they cost the node its ROS side). After each batch a new client must be answered within 5 s, one axis turns on or has
halted as `ros: {on_loss}` says, two that nobody calls have not moved, and at the end no kind of line stands more than ten times
a minute in the log. Standard output gets what happens; OUT gets report.json, datagrams that a loss followed, and the log.
"""
import argparse
import json
import math
import os
import random
import re
import socket
import struct
import subprocess
import sys
import threading
import time
from collections import Counter, deque
from pathlib import Path

import soak
from soak import HERE, ROOT, Client, Node

HOST = soak.NODE_HOST = "lineshaft-mutate"
NAME = "/lineshaft"
AGAIN_S = 5.0
VELOCITY = 0.5  # rad/s, of the axis that turns
KEPT = 4000  # datagrams that were caught last
WORDS = (0, 1, 2, 0x7f, 0xff, 0x7fff, 0xffff, 0x7fffffff, 0x80000000, 0xfffffffe, 0xffffffff)
DATA, DATA_FRAG, HEARTBEAT, ACKNACK, GAP, NACK_FRAG, HEARTBEAT_FRAG, INFO_DST = 0x15, 0x16, 0x07, 0x06, 0x08, 0x12, 0x13, 0x0e


class Caught:
    """What others send to the node, caught on the loopback."""

    def __init__(self, node):
        self.node, self.ring, self.ours, self.lock = node, deque(maxlen=KEPT), None, threading.Lock()
        self.socket = socket.socket(socket.AF_PACKET, socket.SOCK_DGRAM, socket.htons(0x0800))
        self.ports, self.looked = set(), 0.0
        threading.Thread(target=self.listen, daemon=True).start()

    def listen(self):
        while True:
            packet, (_, _, kind, _, _) = self.socket.recvfrom(65536)
            if kind != socket.PACKET_HOST or len(packet) < 28 or packet[9] != socket.IPPROTO_UDP:
                continue
            head = 4 * (packet[0] & 15)
            source, port = struct.unpack_from(">HH", packet, head)
            datagram = packet[head + 8:]
            # What turns the axis must not be said again.
            if source != self.ours and port in self.ports and datagram[:4] == b"RTPS" and b"move_axis" not in datagram:
                with self.lock:
                    self.ring.append((port, datagram))

    def look(self):
        """Where the side hears, now."""
        side = self.node.side()
        inodes = {os.readlink(f)[8:-1] for f in Path(f"/proc/{side}/fd").iterdir() if os.path.islink(f)
                  and os.readlink(f).startswith("socket:")}
        lines = [line.split() for line in Path("/proc/net/udp").read_text().splitlines()[1:]]
        ports = {int(words[1].split(":")[1], 16) for words in lines if words[9] in inodes}
        if ports != self.ports:
            with self.lock:
                self.ports = ports
                self.ring.clear()

    def all(self):
        with self.lock:
            return list(self.ring)


def submessages(datagram):
    """Place, id, body of each."""
    at = 20
    while at + 4 <= len(datagram):
        kind, flags = datagram[at], datagram[at + 1]
        length = struct.unpack_from("<H" if flags & 1 else ">H", datagram, at + 2)[0]
        if length == 0:
            length = len(datagram) - at - 4
        yield at, kind, datagram[at + 4:at + 4 + length]
        at += 4 + length


class Mutator:
    def __init__(self, seed):
        self.dice = random.Random(seed)
        self.kinds = [(25, self.bits), (20, self.words), (10, self.shorter), (5, self.longer), (10, self.spliced),
                      (30, self.ranges), (5, self.noise)]
        self.made = Counter()

    def one(self, caught, with_ranges):
        port, datagram = self.dice.choice(caught)
        kinds = [(weight, mutate) for weight, mutate in self.kinds if with_ranges or mutate != self.ranges]
        mutate = self.dice.choices([m for _, m in kinds], [w for w, _ in kinds])[0]
        self.made[mutate.__name__] += 1
        return port, mutate(bytearray(datagram), caught)

    def bits(self, d, _):
        for _ in range(self.dice.randint(1, 8)):
            d[self.dice.randrange(4, len(d))] ^= 1 << self.dice.randrange(8)
        return d

    def words(self, d, _):
        for _ in range(self.dice.randint(1, 3)):
            size = self.dice.choice((2, 4, 4, 8))
            if len(d) >= 20 + size:
                at = self.dice.randrange(20, len(d) - size + 1) & ~1
                d[at:at + size] = (self.number() & (1 << 8 * size) - 1).to_bytes(size, "little")
        return d

    def number(self):
        return self.dice.choice((self.dice.choice(WORDS), self.dice.getrandbits(8), self.dice.getrandbits(32), self.dice.getrandbits(64)))

    def shorter(self, d, _):
        return d[:self.dice.randrange(len(d))]

    def longer(self, d, _):
        return d + self.dice.choice((self.dice.randbytes(self.dice.randint(1, 400)), d[20:], bytes(self.dice.randint(1, 60_000))))

    def spliced(self, d, caught):
        other = self.dice.choice(caught)[1]
        cut = [at for at, _, _ in submessages(d)] or [20]
        cut_other = [at for at, _, _ in submessages(other)] or [20]
        return d[:self.dice.choice(cut)] + other[self.dice.choice(cut_other):]

    def noise(self, d, _):
        return self.dice.choice((b"", b"RTPS", bytes(d[:20]))) + self.dice.randbytes(self.dice.randint(0, 1400))

    def ranges(self, d, _):
        """What no writer has, in the name of one that is known to the node."""
        ends, to = None, b""
        for _, kind, body in submessages(d):
            if kind == INFO_DST:
                to = b"\x0e\x01\x0c\x00" + bytes(body[:12])
            elif kind in (DATA, DATA_FRAG) and len(body) >= 12:
                ends = bytes(body[4:12])
            elif kind in (HEARTBEAT, GAP, ACKNACK, NACK_FRAG, HEARTBEAT_FRAG) and len(body) >= 8:
                ends = bytes(body[:8])
        if ends is None:
            return self.noise(d, _)
        sn = lambda: struct.pack("<iI", *self.sequence_number())  # noqa: E731
        u32 = lambda: struct.pack("<I", self.number() & 0xffffffff)  # noqa: E731
        bitmap = lambda: u32() + self.dice.randbytes(self.dice.choice((0, 4, 32, 64)))  # noqa: E731
        kind, body = self.dice.choice((
            (HEARTBEAT, lambda: ends + sn() + sn() + u32()),
            (HEARTBEAT, lambda: ends + struct.pack("<iI", 0, 1) + sn() + u32()),
            (GAP, lambda: ends + sn() + sn() + bitmap()),
            (GAP, lambda: ends + struct.pack("<iI", 0, 1) + sn() + u32() * 2),
            (DATA_FRAG, lambda: struct.pack("<HH", 0, 28) + ends + sn() + u32()
             + struct.pack("<HH", self.number() & 0xffff, self.number() & 0xffff) + u32() + self.dice.randbytes(64)),
            (HEARTBEAT_FRAG, lambda: ends + sn() + u32() + u32()),
            (ACKNACK, lambda: ends + sn() + bitmap() + u32()),
            (NACK_FRAG, lambda: ends + sn() + u32() + bitmap() + u32()),
        ))
        body = body()
        return bytes(d[:20]) + to + struct.pack("<BBH", kind, 1 | self.dice.choice((0, 2)), len(body)) + body

    def sequence_number(self):
        high = self.dice.choice((0, 0, 0, -1, 1, 1 << 30, 0x7fffffff, -0x80000000))
        return high, self.number() & 0xffffffff


class Show:
    """What soak's parts want to know, and the run itself."""

    def __init__(self, a):
        self.program, self.peers, self.out = a.program.resolve(), a.peers.resolve(), a.out
        self.on_loss, self.count, self.batch, self.rate = a.on_loss, a.count, a.batch, a.rate
        self.mutator, self.dice = Mutator(a.seed), random.Random(a.seed)
        self.begun = time.monotonic()
        self.report = {"datagrams": 0, "slowest_s": 0.0, "losses": 0, "clients made anew": 0,
                       "worked": 0, "did not work": 0, "largest side, MiB": 0, "faults": []}
        self.over = False

    def words(self, rmw, _):
        return {"cyclone": ["ip", "netns", "exec", HOST, str(self.peers / "venv/bin/python"), "-B", str(soak.PEERS / "lineshaft_peer.py")],
                "fastdds": ["ip", "netns", "exec", HOST, str(self.peers / "fastdds/fastdds_peer")]}[rmw]

    def say(self, *words):
        print(f"{time.monotonic() - self.begun:8.1f}", *words, flush=True)

    def fault(self, text):
        self.say("FAULT", text)
        self.report["faults"].append(f"{time.monotonic() - self.begun:.1f} s: {text}"[:500])

    def work(self, rmw, axis):
        """A client whose datagrams are caught; one that is not heard any more is made anew."""
        client, seed = Client(self, rmw, "LOCALHOST"), 0
        while not self.over:
            seed += 1
            _, error = client.do(f"hammer {NAME} --axis {axis} --seconds 4 --rate 60 --seed {seed}")
            self.report["did not work" if error else "worked"] += 1
            if not error and rmw == "cyclone":
                client.do(f"many-requests {NAME} --count 5")
            if error:
                client.process.kill()
                self.report["clients made anew"] += 1
                client = Client(self, rmw, "LOCALHOST")
        client.process.kill()

    def answered(self):
        """How long a new client waits for its answer."""
        judge = Client(self, "cyclone", "LOCALHOST")
        try:
            seen, error = judge.do(f"answered {NAME} --axis spare --seconds {4 * AGAIN_S}")
            if error:
                self.fault(f"a new client: {error}")
                return None
            seconds = seen[-1]["answered_s"]
            if seconds > AGAIN_S:
                self.fault(f"a new client was answered after {seconds:.1f} s")
            seen, error = judge.do(f"axis-states {NAME}")
            if error:
                self.fault(f"a new client: {error}")
                return None
            return seconds, seen[-1]["axes"]
        finally:
            judge.process.kill()

    def turn(self):
        judge = Client(self, "cyclone", "LOCALHOST")
        for command in (f"axes {NAME} enable c", f"move {NAME} --axis c --mode velocity --velocity {VELOCITY}"):
            _, error = judge.do(command)
            if error:
                self.fault(f"{command}: {error}")
        judge.process.kill()

    def node_log(self):
        return Path(self.node.log.name).read_text(errors="replace")

    def judge(self):
        found = self.answered()
        if not found:
            return True
        seconds, axes = found
        self.report["slowest_s"] = max(self.report["slowest_s"], seconds)
        side = self.node.side()
        lost, self.side = side != self.side, side
        self.report["losses"] += lost
        for name in "ab":
            if axes[name]["state"] != "DISABLED" or axes[name]["position_increments"] != 0:
                self.fault(f"{name}, which nobody calls: {axes[name]}")
        c = axes["c"]
        turns = c["state"] == "CONTINUOUS_MOTION" and math.isclose(c["command_velocity"], VELOCITY, rel_tol=1e-6)
        halts = c["state"] == "STANDSTILL" and c["command_velocity"] == 0.0
        if not (halts if lost and self.on_loss == "halt" else turns):
            self.fault(f"c, the side was {'lost' if lost else 'not lost'}: {c}")
        if not turns:
            self.turn()
        if side:
            resident = int(Path(f"/proc/{side}/statm").read_text().split()[1]) * 4096 // 2 ** 20
            self.report["largest side, MiB"] = max(self.report["largest side, MiB"], resident)
        if lost:
            self.say(f"{self.report['datagrams']} datagrams: the side was lost, answered after {seconds:.2f} s")
        return lost

    def go(self):
        cell = self.out / "cell.yaml"
        cell.write_text((HERE / "cell.yaml").read_text().replace("ros: {", f"ros: {{on_loss: {self.on_loss}, "))
        self.node = Node(self, NAME, "LOCALHOST", cell)
        self.node.log.truncate(0)
        self.node.start()
        time.sleep(2)
        self.turn()
        self.side = self.node.side()
        caught = Caught(self.node)
        works = [threading.Thread(target=self.work, args=work) for work in (("cyclone", "spare"), ("fastdds", "d"))]
        for work in works:
            work.start()
        out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        out.bind(("127.0.0.1", 0))
        caught.ours = out.getsockname()[1]
        with_ranges = True
        while self.report["datagrams"] < self.count:
            if self.node.process.poll() is not None:
                self.fault(f"the node has ended with {self.node.process.returncode}")
                break
            caught.look()
            ring = caught.all()
            if len(ring) < 50:
                time.sleep(0.1)
                continue
            sent, with_ranges = deque(maxlen=self.batch), not with_ranges
            for _ in range(self.batch):
                port, datagram = self.mutator.one(ring, with_ranges)
                datagram = bytes(datagram[:65_000])
                sent.append((port, datagram))
                out.sendto(datagram, ("127.0.0.1", port))
                self.report["datagrams"] += 1
                time.sleep(1 / self.rate)
            if self.judge() and not with_ranges:
                (self.out / f"before-loss-{self.report['datagrams']}.hex").write_text(
                    "".join(f"{port} {datagram.hex()}\n" for port, datagram in sent))
            self.write()
        self.over = True
        for work in works:
            work.join()
        self.judge()
        self.report["the node ended with"] = self.node.end()
        self.lines()
        self.write()
        self.say(json.dumps(self.report, indent=1))
        return not self.report["faults"]

    def lines(self):
        """How often a kind of line stands in a minute of the log, at most."""
        most, minutes = Counter(), {}
        for line in self.node_log().splitlines():
            m = re.match(r"\d{4}-\d\d-\d\dT(\d\d):(\d\d):(\d\d)\S*\s+(.*)", re.sub(r"\x1b\[[0-9;]*m", "", line))
            if not m:
                continue
            second = int(m[1]) * 3600 + int(m[2]) * 60 + int(m[3])
            kind = re.sub(r"\b[0-9a-f]{8,}\b|\d+", "N", m[4])
            window = minutes.setdefault(kind, deque())
            window.append(second)
            while second - window[0] >= 60:
                window.popleft()
            most[kind] = max(most[kind], len(window))
        self.report["bytes of log"] = len(self.node_log())
        self.report["most lines of a kind in a minute"] = most.most_common(5)
        for kind, count in most.items():
            if count > 10:
                self.fault(f"{count} lines in a minute: {kind}")

    def write(self):
        self.report["made"] = dict(self.mutator.made)
        self.report["seconds"] = round(time.monotonic() - self.begun)
        (self.out / "report.json").write_text(json.dumps(self.report, indent=1) + "\n")


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--count", type=int, default=200_000)
    p.add_argument("--batch", type=int, default=2000, help="datagrams between two looks at the node")
    p.add_argument("--rate", type=float, default=2000.0, help="datagrams a second, at most")
    p.add_argument("--on-loss", choices=("halt", "none"), default="halt")
    p.add_argument("--out", type=Path, default=ROOT / "target/mutate")
    p.add_argument("--program", type=Path, default=ROOT / "target/release/lineshaft")
    p.add_argument("--peers", type=Path, default=ROOT / "target/peers")
    p.add_argument("--seed", type=int, default=1)
    a = p.parse_args()
    soak.needs(a)
    if os.environ.get("LINESHAFT_MUTATE") != HOST:
        subprocess.run(["ip", "netns", "del", HOST], stderr=subprocess.DEVNULL)
        soak.run("ip", "netns", "add", HOST)
        soak.run("ip", "-n", HOST, "link", "set", "lo", "up")
        words = ["ip", "netns", "exec", HOST, sys.executable, *sys.argv]
        try:
            return subprocess.run(words, env=os.environ | {"LINESHAFT_MUTATE": HOST}).returncode
        finally:
            subprocess.run(["ip", "netns", "del", HOST])
    a.out.mkdir(parents=True, exist_ok=True)
    return 0 if Show(a).go() else 1


if __name__ == "__main__":
    sys.exit(main())

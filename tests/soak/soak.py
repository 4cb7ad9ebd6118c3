#!/usr/bin/env python3
"""A production day in short: clients, newcomers, dead clients, frozen and killed nodes, for as long as is asked for.

    cargo build --release && cargo test --workspace --test end_to_end peers_setup
    tests/soak/soak.py --seconds 7200 --out target/soak

A node that lasts, on the discovery range SUBNET with its clients on another host: two network namespaces that this script makes
(root is needed). Four clients of both RMWs ask it for everything; every second somebody new comes, asks once and goes; every
minute a client is killed and the node or, every fifth time, its ROS side is frozen. Two more nodes, on SUBNET and on LOCALHOST,
are killed and started again every ten minutes, while their clients live; nobody may find anything done there that was asked of
a node that is dead. Standard output gets what happens; OUT gets figures.csv, newcomers.csv, report.json and the logs.
"""
import argparse
import csv
import json
import os
import queue
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
HERE, PEERS = ROOT / "tests/soak", ROOT / "tests/peers"
NODE_HOST, CLIENT_HOST = "lineshaft-soak-a", "lineshaft-soak-b"
LASTING, DOOMED = "/lasting", "/doomed"
DOMAIN = {"SUBNET": 5, "LOCALHOST": 6}
RATE = 12.5  # requests a second of each of the four
SEGMENT_S = 60
POOL = 4  # processes of newcomers of each RMW
MOST_WAITING = 30  # a machine that has no time for more has none for the node either
LATE_S = 10.0  # a newcomer who has no answer by then goes without
NEWCOMER = f"newcomer {LASTING} --axis spare"


def run(*words):
    subprocess.run(words, check=True)


class Hosts:
    """Two hosts with a cable between them."""

    def __enter__(self):
        self.__exit__()
        for host in (NODE_HOST, CLIENT_HOST):
            run("ip", "netns", "add", host)
            run("ip", "-n", host, "link", "set", "lo", "up")
        run("ip", "link", "add", "soak-a", "netns", NODE_HOST, "type", "veth", "peer", "name", "soak-b", "netns", CLIENT_HOST)
        for number, (host, cable) in enumerate(((NODE_HOST, "soak-a"), (CLIENT_HOST, "soak-b")), 1):
            run("ip", "-n", host, "addr", "add", f"10.77.0.{number}/24", "dev", cable)
            run("ip", "-n", host, "link", "set", cable, "up")
            run("ip", "-n", host, "route", "add", "224.0.0.0/4", "dev", cable)
        return self

    def __exit__(self, *_):
        for host in (NODE_HOST, CLIENT_HOST):
            subprocess.run(["ip", "netns", "del", host], stderr=subprocess.DEVNULL)


def environment(reach, **more):
    e = {k: v for k, v in os.environ.items() if not k.startswith(("ROS_", "RMW_", "CYCLONEDDS", "FASTDDS", "FASTRTPS"))}
    e.update(ROS_AUTOMATIC_DISCOVERY_RANGE=reach, ROS_DOMAIN_ID=str(DOMAIN[reach]), **more)
    if reach == "SUBNET":
        e["CYCLONEDDS_URI"] = "<CycloneDDS></CycloneDDS>"
    return e


class Node:
    def __init__(self, soak, name, reach, cell):
        self.soak, self.name, self.reach, self.cell = soak, name, reach, str(cell)
        self.log = open(soak.out / f"node{name.replace('/', '-')}-{reach}.log", "ab")
        self.home = tempfile.mkdtemp(prefix="lineshaft-soak-")
        self.process = None

    def start(self):
        words = [str(self.soak.program), "run", self.cell, "--ros-args", "-r", f"__node:={self.name[1:]}"]
        self.process = subprocess.Popen(["ip", "netns", "exec", NODE_HOST, *words], stdin=subprocess.DEVNULL, stdout=self.log,
                                        stderr=self.log, env=environment(self.reach, ROS_HOME=self.home))

    @property
    def pid(self):
        return self.process.pid

    def side(self):
        for task in Path(f"/proc/{self.pid}/task").iterdir():
            children = (task / "children").read_text().split()
            if children:
                return int(children[0])
        return None

    def kill(self, both):
        side = self.side()
        if both and side:
            os.kill(side, signal.SIGSTOP)  # it does not notice then that the program is gone
        self.process.kill()
        if both and side:
            os.kill(side, signal.SIGKILL)
        self.process.wait()

    def end(self):
        if self.process and self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
            try:
                return self.process.wait(30)
            except subprocess.TimeoutExpired:
                self.process.kill()
                return "killed"
        return "gone before"


class Client:
    """A peer that is told what to do by lines."""

    def __init__(self, soak, rmw, reach):
        self.rmw = rmw
        words = soak.words(rmw, reach) + ["serve"]
        self.process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1,
                                        stderr=subprocess.DEVNULL, env=environment(reach))

    def tell(self, command):
        self.process.stdin.write(command + "\n")
        self.process.stdin.flush()

    def answer(self):
        seen = []
        for line in self.process.stdout:
            o = json.loads(line)
            if "done" in o:
                return seen, None if o["ok"] else o.get("error", "?")
            seen.append(o)
        return seen, "the client has ended"

    def do(self, command):
        self.tell(command)
        return self.answer()


class Soak:
    def __init__(self, a):
        self.program, self.peers, self.out = a.program.resolve(), a.peers.resolve(), a.out
        self.seconds, self.every_kill = a.seconds, a.kill_every
        self.dice = random.Random(a.seed)
        self.begun = time.monotonic()
        self.losses = []  # when the ROS side was frozen, and until when that may be felt
        self.frozen = []  # when the program was frozen, and until when
        self.report = {"seconds": a.seconds, "segments": 0, "answered": 0, "goals": 0, "lost": 0, "doubled": 0, "strange": 0,
                       "wrong": 0, "unanswered when the side was lost": 0, "faults": [], "freezes": 0, "sides lost": 0,
                       "clients killed": 0, "lives": 0, "done for the dead": 0, "doomed answered after s": []}
        self.lock = threading.Lock()
        self.newcomers, self.waiting, self.pool = [], 0, {rmw: queue.Queue() for rmw in ("cyclone", "fastdds")}

    def now(self):
        return time.monotonic() - self.begun

    def left(self):
        return self.seconds - self.now()

    def end(self):
        self.say("ends within a minute")
        self.seconds = 0

    def say(self, *words):
        print(f"{self.now():8.1f}", *words, flush=True)

    def fault(self, text):
        self.say("FAULT", text)
        with self.lock:
            self.report["faults"].append(f"{self.now():.1f} s: {text}"[:400])

    def words(self, rmw, reach):
        host = CLIENT_HOST if reach == "SUBNET" else NODE_HOST
        peer = {"cyclone": [str(self.peers / "venv/bin/python"), "-B", str(PEERS / "lineshaft_peer.py")],
                "fastdds": [str(self.peers / "fastdds/fastdds_peer")]}[rmw]
        return ["ip", "netns", "exec", host, *peer]

    def touched(self, windows, start, end):
        return any(start < until and since < end for since, until in windows)

    # ---- what goes on

    def load(self, rmw, axis, seed):
        client = Client(self, rmw, "SUBNET")
        segment = 0
        while self.left() > SEGMENT_S / 2:
            start = self.now()
            seconds = min(SEGMENT_S, self.left())
            seen, error = client.do(f"hammer {LASTING} --axis {axis} --seconds {seconds:.0f} --rate {RATE} --seed {seed + segment}")
            segment += 1
            total = next((o for o in reversed(seen) if "answered" in o), None)
            lossy = self.touched(self.losses, start, self.now())
            with self.lock:
                r = self.report
                r["segments"] += 1
                if total:
                    each, lost = total["each"], total["lost"]
                    goals = each["goal"] if isinstance(each, dict) else each[4]
                    lost = sum(lost.values()) if isinstance(lost, dict) else lost
                    r["answered"] += total["answered"]
                    r["goals"] += goals
                    r["doubled"] += total["twice"]
                    r["strange"] += total["strange"]
                    r["unanswered when the side was lost" if lossy else "lost"] += lost
                    r["wrong"] += total["wrong"] if not lossy else 0
            if error:
                (self.say if lossy else self.fault)(f"{rmw} on {axis}: {error}" + (" (the side was lost meanwhile)" if lossy else ""))
            if client.process.poll() is not None:
                self.fault(f"{rmw} on {axis} has ended")
                client = Client(self, rmw, "SUBNET")
        client.process.stdin.close()

    def newcomer(self, rmw, number):
        """A participant that was never there before, timed from when it is made. Few processes make them, as to start one for each
        takes most of a core; every tenth starts one."""
        start = self.now()
        took = self.of_its_own(rmw) if number % 10 < 2 else self.of_the_pool(rmw)
        if took is not None and took > LATE_S:
            took = None
        lossy = self.touched(self.losses, start, self.now())
        frozen = lossy or self.touched(self.frozen, start, self.now())
        with self.lock:
            self.newcomers.append((start, rmw, took, frozen))
            self.waiting -= 1
        if took is None:
            (self.say if lossy else self.fault)(f"a newcomer ({rmw}) had no answer" + (" (the side was lost)" if lossy else ""))

    def of_the_pool(self, rmw):
        client = self.pool[rmw].get()
        seen, error = client.do(NEWCOMER)
        if client.process.poll() is not None:
            client = Client(self, rmw, "SUBNET")
        self.pool[rmw].put(client)
        return None if error else answered(seen)

    def of_its_own(self, rmw):
        try:
            p = subprocess.run(self.words(rmw, "SUBNET") + NEWCOMER.split(), env=environment("SUBNET"), capture_output=True, text=True,
                               timeout=4 * LATE_S)
        except subprocess.TimeoutExpired:
            return None
        return answered([json.loads(line) for line in p.stdout.splitlines()]) if p.returncode == 0 else None

    def come(self):
        for rmw, clients in self.pool.items():
            for _ in range(POOL):
                clients.put(Client(self, rmw, "SUBNET"))
        number = 0
        while self.left() > LATE_S:
            with self.lock:
                self.waiting += 1
                piled = self.waiting > MOST_WAITING
                self.waiting -= piled
            if piled:
                self.fault(f"{MOST_WAITING} newcomers wait for an answer: this one stays away")
            else:
                threading.Thread(target=self.newcomer, args=(("cyclone", "fastdds")[number % 2], number)).start()
            number += 1
            time.sleep(max(0.0, number - self.now() + self.first))

    def die(self):
        while self.left() > 60:
            client = Client(self, self.dice.choice(("cyclone", "fastdds")), "SUBNET")
            client.tell(f"hammer {LASTING} --axis spare --seconds 30 --rate 50")
            time.sleep(8)
            client.process.kill()
            self.report["clients killed"] += 1
            time.sleep(52)

    def freeze(self):
        number = 0
        while self.left() > 90:
            time.sleep(max(0.0, number * 60 + self.dice.uniform(20, 40) - self.now()))  # once in each minute
            number += 1
            lasts = self.dice.choice((0.001, 0.1, 0.5, 1.5))
            pid = self.lasting.side() if number % 5 == 0 else self.lasting.pid
            start = self.now()
            if number % 5 == 0:
                lasts = 1.5
                self.losses.append((start, start + 12))  # those who ask meanwhile wait 10 s before they give up
                self.report["sides lost"] += 1
            else:
                self.frozen.append((start, start + lasts + 0.5))
            self.say("freezes the", "side" if number % 5 == 0 else "program", f"for {lasts} s")
            os.kill(pid, signal.SIGSTOP)
            time.sleep(lasts)
            try:
                os.kill(pid, signal.SIGCONT)
            except ProcessLookupError:
                pass  # it was replaced meanwhile
            self.report["freezes"] += 1

    def doom(self, reach, first):
        name = f"{DOOMED}_{reach.lower()}"
        node = Node(self, name, reach, ROOT / "launch-configs/demo.yaml")
        clients = [Client(self, rmw, reach) for rmw in ("cyclone", "fastdds")]
        watcher = Client(self, "cyclone", reach)
        life, until = 0, self.now() + first
        while self.left() > 60:
            if life % 3 == 2:  # a predecessor of whom no client has learnt
                node.start()
                time.sleep(self.dice.uniform(0.5, 4))
                node.kill(True)
            node.start()
            self.report["lives"] += 1
            start = time.monotonic()
            self.look(watcher, name)
            for client in clients:
                client.do(f"params {name} get x.max_velocity" if client.rmw == "fastdds" else f"axes {name} reset_errors y")
            self.report["doomed answered after s"].append(round(time.monotonic() - start - 5.0, 2))
            turn = 0
            while self.now() < until and self.left() > 30:
                client = clients[turn % 2]
                turn += 1
                for what in (f"axes {name} enable x", f"move {name} --axis x --mode relative --position {(-1) ** turn * 0.01} --wait"):
                    _, error = client.do(what)
                    if error:
                        self.fault(f"{client.rmw} at {name}: {what}: {error}")
                time.sleep(1)
            if self.left() < 60:
                break
            for client in clients:
                client.tell(f"axes {name} enable x")
                client.answer()
                client.tell(f"move {name} --axis x --mode relative --position 0.01")
            both = life % 2 == 0
            node.kill(both)
            self.say(f"killed {name}", "and its side" if both else "alone")
            for client in clients:
                client.answer()
                client.tell(f"axes {name} enable x")  # nobody is there
            time.sleep(self.dice.choice((0.2, 1.0, 5.0)))
            for client in clients:
                client.answer()
            life, until = life + 1, self.now() + self.every_kill
        self.say(name, "ends with", node.end())

    def look(self, watcher, name):
        end, looked = time.monotonic() + 5, 0
        while time.monotonic() < end:
            seen, error = watcher.do(f"axis-states {name}")
            if error:
                continue
            looked += 1
            axis = seen[-1]["axes"]["x"]
            if axis["state"] != "DISABLED" or axis["position_increments"] != 0:
                with self.lock:
                    self.report["done for the dead"] += 1
                return self.fault(f"{name} did what its predecessor was asked for: cycle {seen[-1]['cycle']}: {axis}")
            time.sleep(0.2)
        if not looked:
            self.fault(f"{name} showed no states within 5 s")

    def sample(self):
        with open(self.out / "figures.csv", "w", newline="") as file:
            table = csv.writer(file)
            table.writerow(["s", "program_rss_mib", "program_fds", "side_rss_mib", "side_fds", "side", "log_bytes"])
            while self.left() > 0:
                try:
                    row = [f"{self.now():.0f}"]
                    side = self.lasting.side()
                    for pid in (self.lasting.pid, side):
                        if pid is None:
                            row += ["", ""]
                            continue
                        resident = int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * 4096 / 2 ** 20
                        row += [f"{resident:.1f}", len(list(Path(f"/proc/{pid}/fd").iterdir()))]
                    table.writerow(row + [side or "", os.path.getsize(self.lasting.log.name)])
                    file.flush()
                except OSError:
                    pass  # it is being replaced
                self.write()
                time.sleep(5)

    def write(self):
        with self.lock:
            newcomers, report = list(self.newcomers), dict(self.report)
        slots = {}
        for start, _, took, frozen in newcomers:
            slots.setdefault(int(start // 600), []).append((took, frozen))
        report["newcomers of each 10 min"] = [
            {"from_s": slot * 600, "came": len(all), "unanswered": sum(t is None for t, _ in all),
             **quantiles([LATE_S if t is None else t for t, _ in all]),
             "p99_s without freezes": quantiles([LATE_S if t is None else t for t, f in all if not f]).get("p99_s")}
            for slot, all in sorted(slots.items())]
        for kind in ("cyclone", "fastdds"):
            report[f"newcomers {kind}"] = quantiles([LATE_S if t is None else t for _, k, t, _ in newcomers if k == kind])
        (self.out / "report.json").write_text(json.dumps(report, indent=1) + "\n")
        with open(self.out / "newcomers.csv", "w", newline="") as file:
            table = csv.writer(file)
            table.writerow(["s", "rmw", "answered_after_s", "while_frozen"])
            table.writerows((f"{s:.1f}", k, "" if t is None else f"{t:.3f}", int(f)) for s, k, t, f in newcomers)

    def go(self):
        self.lasting = Node(self, LASTING, "SUBNET", HERE / "cell.yaml")
        self.lasting.start()
        time.sleep(2)
        self.first = self.now()
        works = [(self.load, "cyclone", "a", 1000), (self.load, "cyclone", "b", 2000), (self.load, "fastdds", "c", 3000),
                 (self.load, "fastdds", "d", 4000), (self.come,), (self.die,), (self.freeze,), (self.sample,),
                 (self.doom, "SUBNET", self.every_kill), (self.doom, "LOCALHOST", self.every_kill / 2)]
        threads = [threading.Thread(target=self.guarded, args=work) for work in works]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.report["the lasting node ended with"] = self.lasting.end()
        self.write()
        self.say(json.dumps(self.report))
        r = self.report
        return not (r["faults"] or r["lost"] or r["doubled"] or r["strange"] or r["wrong"] or r["done for the dead"])

    def guarded(self, work, *words):
        try:
            work(*words)
        except Exception as e:  # one of them must not end silently
            self.fault(f"{work.__name__} ended: {e!r}")


def answered(seen):
    return next((o["answered_s"] for o in seen if "answered_s" in o), None)


def quantiles(times):
    times = sorted(times)
    if not times:
        return {}
    at = lambda share: round(times[min(len(times) - 1, int(share * len(times)))], 3)  # noqa: E731
    return {"p50_s": at(0.5), "p99_s": at(0.99), "max_s": round(times[-1], 3)}


def needs(a):
    """Says what is missing."""
    if os.geteuid() != 0 or not shutil.which("ip"):
        sys.exit("It makes network namespaces: it needs root and `ip` (Debian: apt-get install iproute2)")
    for needed, how in ((a.program, "cargo build --release"), (a.peers / "venv", "cargo test --workspace --test end_to_end peers_setup")):
        if not needed.exists():
            sys.exit(f"{needed} is missing: {how}")


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--seconds", type=float, default=7200.0)
    p.add_argument("--kill-every", type=float, default=600.0, help="seconds of a life of the nodes that are killed")
    p.add_argument("--out", type=Path, default=ROOT / "target/soak")
    p.add_argument("--program", type=Path, default=ROOT / "target/release/lineshaft")
    p.add_argument("--peers", type=Path, default=ROOT / "target/peers")
    p.add_argument("--seed", type=int, default=1)
    a = p.parse_args()
    needs(a)
    a.out.mkdir(parents=True, exist_ok=True)
    with Hosts():
        soak = Soak(a)
        signal.signal(signal.SIGINT, lambda *_: soak.end())
        return 0 if soak.go() else 1


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Simulated CANopen drives of another make at real cycles: what is lost, how fast they answer, how long they take to start.

    cargo build --release && cargo test --workspace --test end_to_end can_transports    # the second makes the environment of the drives
    tests/soak/can_peers.py [--seconds 12] [--drives 2,8] [--hz 250,1000]

For each number of drives, behind an adapter that speaks slcan over TCP: the program starts them cold, gears them to the first one
at each cycle, and starts them again (warm). Missed: cycles for which the machine was too late; late: SYNCs whose answers came behind the next one,
because it was late. Unanswered: answers that have never come, by the frames that the program has recorded; rpdos_missed: cycles of drives without
an RPDO. Mismatched: drives that do not stand at the increment that the gear asks for. Then the time from a SYNC to the last answer, by this program's way to a bus and by a loop with python-can, one
after the other. Standard output gets one line of JSON for each; exit 1 where a frame was lost at 250 Hz or a drive mismatches.
"""
import argparse
import json
import os
import re
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
PROGRAM, PYTHON = TARGET / "release/lineshaft", TARGET / "peers/can-venv/bin/python"
SYNCS = 2000
PATIENCE_S = 0.1

# What python-can does with a bus, in the interpreter that has it: one SYNC, then all answers.
LOOP = """
import json, sys, time, can
address, count, *nodes = sys.argv[1:]
want = {0x180 + int(node) for node in nodes}
bus = can.Bus(interface="slcan", channel="socket://" + address, bitrate=1000000, sleep_after_open=0.1)
send = lambda cob, data=b"": bus.send(can.Message(arbitration_id=cob, data=data, is_extended_id=False))
send(0, [1, 0])
time.sleep(%(patience)s)
times, lost = [], 0
for _ in range(int(count)):
    while bus.recv(0) is not None:
        pass
    begin, left = time.perf_counter(), set(want)
    send(0x80)
    while left and time.perf_counter() - begin < %(patience)s:
        message = bus.recv(%(patience)s)
        if message is not None:
            left.discard(message.arbitration_id)
    if left:
        lost += 1
    else:
        times.append((time.perf_counter() - begin) * 1e6)
send(0, [0x80, 0])
time.sleep(%(patience)s)
bus.shutdown()
times.sort()
at = lambda share: round(times[int(len(times) * share)]) if times else None
print(json.dumps({"count": len(times), "lost": lost, "p50_us": at(0.5), "p99_us": at(0.99)}))
""" % {"patience": PATIENCE_S}


class Drives:
    """The process of the simulated drives."""

    def __init__(self, count):
        words = [PYTHON, ROOT / "tests/peers/can/cia402_sim.py", "--bus", "slcan-tcp:127.0.0.1:0", "--control", "127.0.0.1:0",
                 "--exit-with-parent", "--nodes", f"1-{count}"]
        self.process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
        ready = json.loads(self.process.stdout.readline())
        host, port = ready["control"].rsplit(":", 1)
        self.address, self.control = ready["bus"], socket.create_connection((host, int(port)))
        self.answers = self.control.makefile()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()

    def state(self, node):
        self.control.sendall(f"state {node}\n".encode())
        return json.loads(self.answers.readline())


def cell(address, count, hz):
    axes = "".join(
        f"  x{node}: {{type: linear, scale: {{increments: 10000, per: 10 mm}}, drive: {{backend: bus0, node: {node}, eds: cia402_sim.eds}}, "
        "max_velocity: 500 mm/s, max_acceleration: 5 m/s^2, max_following_error: 20 mm}\n" for node in range(1, count + 1))
    return (f"lineshaft: 1\ncycle: {1000 // hz} ms\nbackends:\n"
            f"  bus0: {{type: can, transport: \"slcan-tcp:{address}\", bitrate: 1000000}}\naxes:\n{axes}")


def scenario(count, seconds):
    nodes = range(1, count + 1)
    every = lambda signal, value: "{all: [" + ", ".join(f"{{signal: x{n}.{signal}, is: {value}}}" for n in nodes) + "]}"
    gears = "".join(f"      - {{synchronize: {{axis: x{n}, master: x1, mode: position, numerator: 1, denominator: {n}}}}}\n"
                    for n in nodes if n > 1)
    way = (seconds - 4) * 10
    return (f"scenario: gear\nfor: {seconds} s\nsteps:\n  - {{when: {every('drive_state', 'SWITCH_ON_DISABLED')}, do: {{enable: {{}}}}}}\n"
            f"  - when: {every('state', 'STANDSTILL')}\n    do:\n{gears}"
            f"      - {{move_axis: {{axis: x1, position: {way}.001 mm, velocity: 10 mm/s}}}}\n")


def stamp(log, text):
    """When a line of the log was written (s of its minute); the first one with this text."""
    found = re.search(r"T\d+:(\d+):([\d.]+)Z +INFO [^\n]*" + text, log)
    return int(found[1]) * 60 + float(found[2])


def run(folder, words):
    words = [PROGRAM, "run", folder / "cell.yaml", "--store", "none", "--flight-recorder", "0", *words]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def started(log):
    ready = [(int(ms), int(objects)) for ms, objects in re.findall(r"ready after (\d+) ms, (\d+) objects", log)]
    return {"all_ms": round((stamp(log, "the node is inactive") - stamp(log, "the node is configuring")) % 3600 * 1000),
            "each_ms": [ms for ms, _ in ready], "objects": sum(objects for _, objects in ready)}


def answered(folder, count):
    """SYNCs, those that not every drive has answered before the next one, and answers that never came; once all have answered one."""
    dump = subprocess.run([PROGRAM, "can", "dump", folder / "bag", "--cell", folder / "cell.yaml"], capture_output=True, text=True, check=True)
    want = {f"{0x180 + node:03X}" for node in range(1, count + 1)}
    heard, syncs, late, answers = [], 0, 0, 0
    for line in dump.stdout.splitlines():
        _, _, way, cob = line.split()[:4]
        if way == "received" and cob in want:
            heard.append(cob)
        elif cob == "080":
            if syncs or want <= set(heard):
                # Those before this SYNC answer the one before it.
                syncs, late, answers = syncs + 1, late + (not want <= set(heard)), answers + len(heard)
            heard = []
    return syncs, late, max(0, syncs * count - answers)


def measure(drives, count, hz, seconds, folder):
    (folder / "cell.yaml").write_text(cell(drives.address, count, hz))
    (folder / "gear.yaml").write_text(scenario(count, seconds))
    (folder / "cia402_sim.eds").write_bytes((ROOT / "launch-configs/can/cia402_sim.eds").read_bytes())
    before = [drives.state(node)["counters"] for node in range(1, count + 1)]
    code, log = run(folder, ["--scenario", folder / "gear.yaml", "--record", folder / "bag", "--record-frames"])
    if code == 2:
        return {"drives": count, "hz": hz, "refused": log.strip()}
    cycles, missed, late, longest = map(int, re.search(r"(\d+) cycles, (\d+) missed; lateness .* max (\d+) us; duration .* max (\d+) us", log).groups())
    states = [drives.state(node) for node in range(1, count + 1)]
    syncs, behind, silent = answered(folder, count)
    first = states[0]["position"]
    wrong = [state["node"] for state in states if state["position"] != first // state["node"]]
    rpdos = sum(state["counters"]["rpdo_missed"] - then["rpdo_missed"] for state, then in zip(states, before))
    return {"drives": count, "hz": hz, "cycles": cycles, "missed": missed, "latest_us": late, "longest_us": longest, "syncs": syncs,
            "late": behind, "unanswered": silent, "rpdos_missed": rpdos, "mismatched": len(wrong), "position": first, "passed": code == 0, "start": started(log)}


def latencies(address, count):
    nodes = [str(node) for node in range(1, count + 1)]
    words = ["cargo", "bench", "--quiet", "--locked", "-p", "lineshaft-can", "--bench", "latency", "--", f"slcan-tcp:{address}", str(SYNCS), *nodes]
    ours = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    time.sleep(0.5)
    theirs = subprocess.run([PYTHON, "-c", LOOP, address, str(SYNCS), *nodes], capture_output=True, text=True, check=True).stdout
    last = lambda text: json.loads(text.strip().splitlines()[-1])
    return {"drives": count, "sync_to_last_answer": {"lineshaft": last(ours), "python_can": last(theirs)}}


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    numbers = lambda text: [int(word) for word in text.split(",")]
    p.add_argument("--seconds", type=int, default=12, help="of each run, 6 and more")
    p.add_argument("--drives", type=numbers, default=[2, 8])
    p.add_argument("--hz", type=numbers, default=[250, 1000])
    a = p.parse_args()
    show = lambda told: print(json.dumps(told), flush=True)
    is_good = True
    for count in a.drives:
        for hz in a.hz:
            # Cold: drives that nobody has configured.
            with Drives(count) as drives, tempfile.TemporaryDirectory() as folder:
                folder = Path(folder)
                told = measure(drives, count, hz, a.seconds, folder)
                show(told)
                if "refused" in told:
                    continue
                lost = told["unanswered"] + told["rpdos_missed"]
                is_good &= told["passed"] and not told["mismatched"] and (hz > 250 or not lost)
                (folder / "stand.yaml").write_text("scenario: stand\nfor: 1 s\n")
                _, log = run(folder, ["--scenario", folder / "stand.yaml"])
                show({"drives": count, "hz": hz, "warm_start": started(log)})
                if hz == a.hz[0]:
                    time.sleep(0.5)
                    show(latencies(drives.address, count))
    return 0 if is_good else 1


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""What a whole node costs: processor time of each thread, and memory.

    cargo build --release && cargo test --test peers_setup
    tests/soak/cost.py --axes 1 6 64 256 --readers 0 1 5 --seconds 20 --out target/cost.json
    tests/soak/cost.py --compare target/before.json --out target/after.json

For each number of axes a node runs N rotary axes (`sim: {model: ideal}`, cycle 1 ms, joint_states and axis_states 100 times a second),
first at rest, then all of them in one trajectory. Readers are processes of their own that read joint_states with Cyclone DDS. Percent are
processor seconds (schedstat of /proc) per second of one processor; memory is the most that was resident (VmHWM), of the program and of
its ROS side. The table goes to standard output, all figures by thread to OUT. A busy machine shows other figures: compare runs of the
same hour.
"""
import argparse
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PEER = ROOT / "tests/peers/lineshaft_peer.py"
ENABLE_S = 1.0


def cell(axes):
    lines = ["lineshaft: 1", "cycle: 1 ms", "backends: {plant: {type: sim}}",
             "ros: {joint_states_rate: 100, axis_states_rate: 100}", "axes:"]
    for number in range(axes):
        drive = f"drive: {{backend: plant, address: {number + 1}, interface: position}}"
        lines.append(f"  a{number}: {{type: rotary, scale: {{increments: 65536, per: 1 rev}}, {drive}, max_velocity: 2 rev/s, "
                     f"max_acceleration: 10 rev/s^2, sim: {{model: ideal}}}}")
    return "\n".join(lines) + "\n"


class Peer:
    """A client that takes one command a line."""

    def __init__(self, python):
        self.process = subprocess.Popen([python, "-B", PEER, "serve"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def send(self, command):
        print(command, file=self.process.stdin, flush=True)

    def wait(self):
        for line in self.process.stdout:
            answer = json.loads(line)
            if "done" in answer:
                if not answer["ok"]:
                    sys.exit(f"a peer failed: {answer.get('error')}")
                return
        sys.exit("a peer has ended")

    def run(self, command):
        self.send(command)
        self.wait()

    def end(self):
        self.process.stdin.close()
        self.process.kill()
        self.process.wait()


def processes(program):
    """The program and its ROS side."""
    # A child belongs to the thread that started it.
    children = [child for task in Path(f"/proc/{program}/task").iterdir() for child in (task / "children").read_text().split()]
    return {"program": program} | {"side": int(child) for child in children}


def times(program):
    """Processor seconds of each thread, by process and name."""
    seen = {}
    for process, pid in processes(program).items():
        for task in Path(f"/proc/{pid}/task").iterdir():
            name = f"{process} {(task / 'comm').read_text().strip()}"
            seen[name] = seen.get(name, 0.0) + int((task / "schedstat").read_text().split()[0]) / 1e9
    return seen


def memory(program):
    """Most resident MiB of each process."""
    most = {}
    for process, pid in processes(program).items():
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
        most[process] = next(int(line.split()[1]) / 1024 for line in lines if line.startswith("VmHWM"))
    return most


def measured(program, seconds):
    before, begun = times(program), time.monotonic()
    time.sleep(seconds)
    after, took = times(program), time.monotonic() - begun
    threads = {name: round(100 * (after[name] - before.get(name, 0.0)) / took, 2) for name in after}
    return {"percent": round(sum(threads.values()), 2), "threads": dict(sorted(threads.items(), key=lambda one: -one[1]))}


def trajectory(axes, seconds):
    names = " ".join(f"--joint a{number}" for number in range(axes))
    points = " ".join(f"--point {time}:{','.join(str(position) for _ in range(axes))}"
                      for time, position in [(1 + second, 0.5 * (second % 2)) for second in range(seconds)])
    return f"follow /lineshaft {names} {points} --leave"


def case(a, axes, readers, folder):
    file = folder / f"cost_{axes}.yaml"
    file.write_text(cell(axes))
    log = (folder / f"node_{axes}_{readers}.log").open("w")
    program = subprocess.Popen([a.binary, "run", str(file)], stdout=log, stderr=log)
    peers = []
    try:
        client = Peer(a.python)
        peers.append(client)
        client.run("axes /lineshaft enable")
        seconds = int(2 * a.seconds + 30)
        for _ in range(readers):
            peers.append(Peer(a.python))
            peers[-1].send(f"joint-states --seconds {seconds}")
        time.sleep(ENABLE_S + 2)
        result = {"rest": measured(program.pid, a.seconds)}
        client.run(trajectory(axes, int(a.seconds) + 8))
        time.sleep(2)
        result["motion"] = measured(program.pid, a.seconds)
        # After the motion: what the flight recorder keeps of it counts.
        result["memory"] = {name: round(most, 1) for name, most in memory(program.pid).items()}
        return result
    finally:
        for peer in peers:
            peer.end()
        program.send_signal(signal.SIGINT)
        program.wait()


def line(axes, readers, one, old):
    threads = ", ".join(f"{name} {percent}" for name, percent in list(one["motion"]["threads"].items())[:6])
    ratio = f" | {one['motion']['percent'] / old['motion']['percent']:.2f} of before" if old else ""
    total = sum(one["memory"].values())
    return (f"| {axes} | {readers} | {one['rest']['percent']} | {one['motion']['percent']} | {total:.0f} "
            f"({one['memory'].get('side', 0):.0f}) | {threads}{ratio} |")


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--axes", type=int, nargs="+", default=[1, 6, 64, 256])
    p.add_argument("--readers", type=int, nargs="+", default=[0, 1, 5])
    p.add_argument("--seconds", type=float, default=20.0, help="of each measurement")
    p.add_argument("--binary", default=str(ROOT / "target/release/lineshaft"))
    p.add_argument("--python", default=str(ROOT / "target/peers/venv/bin/python"))
    p.add_argument("--out", type=Path, help="file for all figures")
    p.add_argument("--compare", type=Path, help="figures of an earlier run")
    a = p.parse_args()
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    old = json.loads(a.compare.read_text()) if a.compare else {}
    figures = {}
    print("| axes | readers | at rest (%) | in motion (%) | memory (its ROS side) (MiB) | threads in motion (%) |\n|-|-|-|-|-|-|")
    with tempfile.TemporaryDirectory() as folder:
        for axes in a.axes:
            for readers in a.readers:
                key = f"{axes} axes, {readers} readers"
                figures[key] = case(a, axes, readers, Path(folder))
                print(line(axes, readers, figures[key], old.get(key)), flush=True)
    if a.out:
        a.out.write_text(json.dumps(figures, indent=1) + "\n")


if __name__ == "__main__":
    main()

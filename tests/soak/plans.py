#!/usr/bin/env python3
"""Plays trajectories of time parameterizers that plan with the limits of the axes, and prints what becomes of them.

    python3 -m venv VENV && VENV/bin/pip install ruckig==0.19.4 toppra==0.6.10
    VENV/bin/python tests/soak/plans.py --program target/release/lineshaft --plans 900

Three planners: ruckig (jerk-limited, point to point), toppra (time-optimal along a spline through four points) and a trapezoidal
profile that is written here (time-optimal, point to point). Six axes with 400 to 2^24 increments per revolution, rotary and linear.
Each plan is sampled every 10, 50 or 100 ms up to its own end, so that its last interval is another one, and is sent as positions
(p), with velocities (pv), or with accelerations as well (pva).
"""

import argparse
import collections
import csv
import math
import pathlib
import random
import re
import subprocess
import sys

import numpy
import ruckig
import toppra

NAMES = ["j1", "j2", "j3", "lift", "slide", "wrist"]
RESOLUTIONS = [400, 4096, 10_000, 65_536, 1 << 20, 1 << 24]
IS_LINEAR = [False, False, False, True, True, False]
# rad/s, rad/s^2, rad/s^3; m/s, m/s^2, m/s^3
VELOCITIES = [2.0, 2.5, 3.14, 0.5, 0.8, 4.0]
ACCELERATIONS = [4.0, 6.0, 8.0, 2.0, 3.0, 12.0]
JERKS = [40.0, 60.0, 80.0, 20.0, 30.0, 200.0]
RANGES = [2.0, 1.5, 2.5, 0.6, 0.8, 3.0]


def per_unit(place):
    """Increments per m or rad."""
    return RESOLUTIONS[place] / (0.01 if IS_LINEAR[place] else 2.0 * math.pi)


def cell():
    lines = ["lineshaft: 1", "cycle: 1 ms", "backends: {plant: {type: sim}}", "axes:"]
    for place, name in enumerate(NAMES):
        kind = "linear" if IS_LINEAR[place] else "rotary"
        per = "10 mm" if IS_LINEAR[place] else "1 rev"
        unit = "m" if IS_LINEAR[place] else "rad"
        lines.append(
            f"  {name}: {{type: {kind}, drive: {{backend: plant, address: {place}}}, unit: {unit}, "
            f"scale: {{increments: {RESOLUTIONS[place]}, per: {per}}}, max_velocity: {VELOCITIES[place]}, "
            f"max_acceleration: {ACCELERATIONS[place]}, sim: {{model: ideal}}}}"
        )
    return "\n".join(lines) + "\n"


def by_ruckig(rng, scaling):
    """Jerk-limited, all joints synchronized in time."""
    generator = ruckig.Ruckig(len(NAMES))
    request = ruckig.InputParameter(len(NAMES))
    request.current_position = [0.0] * len(NAMES)
    request.target_position = [rng.uniform(-1, 1) * reach for reach in RANGES]
    request.max_velocity = [scaling * value for value in VELOCITIES]
    request.max_acceleration = [scaling * value for value in ACCELERATIONS]
    request.max_jerk = JERKS
    trajectory = ruckig.Trajectory(len(NAMES))
    generator.calculate(request, trajectory)
    return trajectory.duration, lambda time: trajectory.at_time(time)[:3]


def by_toppra(rng, scaling):
    """Time-optimal along a cubic spline through four points."""
    toppra.setup_logging("ERROR")
    points = numpy.array([[0.0] * len(NAMES)] + [[rng.uniform(-1, 1) * reach for reach in RANGES] for _ in range(3)])
    path = toppra.SplineInterpolator(numpy.linspace(0, 1, 4), points)
    velocity = scaling * numpy.array(VELOCITIES)
    acceleration = scaling * numpy.array(ACCELERATIONS)
    constraints = [
        toppra.constraint.JointVelocityConstraint(numpy.stack([-velocity, velocity], 1)),
        toppra.constraint.JointAccelerationConstraint(numpy.stack([-acceleration, acceleration], 1)),
    ]
    planner = toppra.algorithm.TOPPRA(constraints, path, parametrizer="ParametrizeConstAccel")
    trajectory = planner.compute_trajectory()
    if trajectory is None:
        return by_toppra(rng, scaling)
    at = lambda time: (trajectory(time), trajectory(time, 1), trajectory(time, 2))
    return trajectory.duration, at


def by_trapezoid(rng, scaling):
    """Full acceleration, cruise, full deceleration along a straight line in joint space."""
    target = [rng.uniform(-1, 1) * reach for reach in RANGES]
    ways = [abs(way) for way in target]
    velocity = min(scaling * v / way for v, way in zip(VELOCITIES, ways))
    acceleration = min(scaling * a / way for a, way in zip(ACCELERATIONS, ways))
    if velocity * velocity >= acceleration:
        velocity = math.sqrt(acceleration)
    ramp = velocity / acceleration
    duration = 1.0 / velocity + ramp

    def share(time):
        if time < ramp:
            return acceleration * time * time / 2, acceleration * time, acceleration
        if time < duration - ramp:
            return velocity * (time - ramp / 2), velocity, 0.0
        left = duration - time
        return 1.0 - acceleration * left * left / 2, acceleration * left, -acceleration

    return duration, lambda time: tuple([part * way for way in target] for part in share(min(time, duration)))


PLANNERS = {"ruckig": by_ruckig, "toppra": by_toppra, "trapezoid": by_trapezoid}


def points(duration, at, step, form):
    count = max(1, math.ceil(duration / step - 1e-9))
    times = [place * step for place in range(count)] + [duration]
    if times[-1] - times[-2] < 1e-6:
        times.pop(-2)
    text = []
    for place, time in enumerate(times):
        position, velocity, acceleration = at(time)
        if place == len(times) - 1:
            velocity, acceleration = [0.0] * len(NAMES), acceleration
        parts = {"positions": position}
        if "v" in form:
            parts["velocities"] = velocity
        if "a" in form:
            parts["accelerations"] = acceleration
        lists = ", ".join(f"{key}: [{', '.join(repr(float(v)) for v in values)}]" for key, values in parts.items())
        text.append(f"          - {{time: {round(time * 1e9)} ns, {lists}}}")
    return text


def scenario(duration, lines):
    joints = ", ".join(NAMES)
    return "\n".join(
        [
            "scenario: a plan",
            f"for: {1.0 + 2.0 * duration:.3f} s",
            'trace: ["*.command.velocity", "*.command.acceleration"]',
            "steps:",
            f"  - {{at: 0, do: {{enable: {{axes: [{joints}]}}}}}}",
            "  - at: 500 ms",
            "    do:",
            "      follow_joint_trajectory:",
            "        units: si",
            f"        joints: [{joints}]",
            "        points:",
            *lines,
        ]
    )


def play(program, folder, text):
    (folder / "scenario.yaml").write_text(text)
    command = [program, "sim", folder / "cell.yaml", "--scenario", folder / "scenario.yaml"]
    command += ["--csv", folder / "trace.csv", "--events"]
    said = subprocess.run(command, capture_output=True, text=True)
    said = said.stdout + said.stderr
    stretch = re.search(r"takes ([0-9.]+) times the planned time", said)
    refused = re.search(r"refused.*", said)
    done = re.search(r"\bdone\b.*machine: done|machine: done", said)
    shares = [0.0, 0.0]
    with open(folder / "trace.csv") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        before = None
        for row in rows:
            for place, name in enumerate(NAMES):
                column = next(key for key in row if key.startswith(f"{name}.command.velocity"))
                velocity = float(row[column]) / per_unit(place)
                shares[0] = max(shares[0], abs(velocity) / VELOCITIES[place])
                if before:
                    change = (velocity - float(before[column]) / per_unit(place)) / 0.001
                    shares[1] = max(shares[1], abs(change) / ACCELERATIONS[place])
            before = row
    return (refused.group(0) if refused else None), bool(done), float(stretch.group(1)) if stretch else 1.0, shares


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, help="the program lineshaft")
    parser.add_argument("--plans", type=int, default=900, help="how many plans")
    parser.add_argument("--folder", default="target/plans", help="folder for what is written")
    parser.add_argument("--seed", type=int, default=1, help="seed of the plans")
    args = parser.parse_args()
    folder = pathlib.Path(args.folder)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "cell.yaml").write_text(cell())
    cases = [
        (planner, scaling, step, form)
        for planner in PLANNERS
        for scaling in (1.0, 0.5)
        for step in (0.01, 0.05, 0.1)
        for form in ("p", "pv", "pva")
    ]
    seen = collections.defaultdict(list)
    for number in range(args.plans):
        case = cases[number % len(cases)]
        planner, scaling, step, form = case
        rng = random.Random(args.seed * 1_000_003 + number)
        duration, at = PLANNERS[planner](rng, scaling)
        text = scenario(duration, points(duration, at, step, form))
        refused, done, stretch, shares = play(args.program, folder, text)
        seen[case].append((refused, done, stretch, shares))
        if refused or not done:
            print(f"plan {number} {case}: {refused or 'does not end'}", file=sys.stderr)
            (folder / f"plan_{number}.yaml").write_text(text)
    print("planner    scaling step   form plans refused unfinished stretched largest_stretch velocity acceleration")
    for (planner, scaling, step, form), plans in seen.items():
        refused = sum(1 for plan in plans if plan[0])
        unfinished = sum(1 for plan in plans if not plan[0] and not plan[1])
        stretched = [plan[2] for plan in plans if plan[2] > 1.0]
        velocity, acceleration = (max(plan[3][place] for plan in plans) for place in (0, 1))
        print(
            f"{planner:<10} {scaling:<7} {step:<6} {form:<4} {len(plans):>5} {refused:>7} {unfinished:>10} {len(stretched):>9} "
            f"{max(stretched, default=1.0):>15.4f} {velocity:>8.5f} {acceleration:>12.5f}"
        )


if __name__ == "__main__":
    main()

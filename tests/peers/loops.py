#!/usr/bin/env python3
"""Loops that are closed in the core, computed beside it: a question in JSON on stdin, the answer in JSON on stdout.

The question has the command of each cycle (position, velocity and acceleration), the gains and the plant. The answer has what the axis
counts and what its drive is asked for, cycle by cycle, of a loop that sees nothing but its own plant. The plant is discretised by
scipy; the laws are written from docs/loops.md and docs/spec/macs.md.
"""
import json
import math
import sys

import numpy as np
from scipy.signal import cont2discrete

K_OUT = 60_000.0


def clamp(value, most):
    return max(-most, min(most, value))


class Plant:
    """x' = A x + B u with a held u, and whole counts of one of its states."""

    def __init__(self, plant, cycle):
        if plant["kind"] == "motor":
            inertia, viscous = plant["inertia"], plant["viscous"]
            a = [[0.0, 1.0], [0.0, -viscous / inertia]]
            b = [[0.0], [1.0 / inertia]]
            self.counts = plant["counts_per_turn"] / (2 * math.pi)
        elif plant["kind"] == "lag":
            # A drive that has its velocity after a lag; its state is in increments.
            a = [[0.0, 1.0], [0.0, -1.0 / plant["time_constant"]]]
            b = [[0.0], [1.0 / plant["time_constant"]]]
            self.counts = 1.0
        else:
            raise ValueError(plant["kind"])
        self.a, self.b, *_ = cont2discrete((np.array(a), np.array(b), np.eye(2), np.zeros((2, 1))), cycle, "zoh")
        self.x = np.zeros((2, 1))

    def step(self, u):
        self.x = self.a @ self.x + self.b * u

    def count(self):
        return math.floor(self.x[0, 0] * self.counts)


class Pid:
    def __init__(self, gains, period):
        self.g, self.period = gains, period
        self.sum, self.before, self.wait, self.output = 0.0, None, 0, 0.0

    def step(self, error, velocity, acceleration):
        if self.wait > 0:
            self.wait -= 1
            return self.output
        self.wait = self.period - 1
        g = self.g
        self.sum = clamp(self.sum + error, g["kilim"])
        change = 0.0 if self.before is None else error - self.before
        self.before = error
        u = clamp((g["kprop"] * error + g["kder"] * change + g["kint"] * self.sum) / K_OUT, g["bandwidth"] / 1000)
        forward = g["ffvel"] / 1000 * velocity + g["ffacc"] / 1000 * acceleration
        self.output = clamp(u + forward, 1.0)
        return self.output


class VelocityLoop:
    """Output (P e + I sum e) / 100; growth of the sum that the output has no room for is left out."""

    def __init__(self, gains, cycle):
        self.p, self.i = gains["velkprop"] / 100, gains["velkint"] / 100
        self.most, self.ms, self.sum = gains["velkilim"] / 50, cycle * 1000, 0.0

    def step(self, error):
        law = self.p * error + self.i * self.sum
        wanted = clamp(self.sum + error * self.ms, self.most)
        part = self.i * (wanted - self.sum)
        part = clamp_to(part, -max(1.0 + law, 0.0), max(1.0 - law, 0.0))
        self.sum = self.sum + part / self.i if self.i else wanted
        return clamp(self.p * error + self.i * self.sum, 1.0)


def clamp_to(value, low, high):
    return max(low, min(high, value))


def run(question):
    cycle, gains = question["cycle"], question["gains"]
    plant = Plant(question["plant"], cycle)
    pid = Pid(gains, question["period"])
    inner = VelocityLoop(gains, cycle) if question["plant"]["kind"] == "motor" else None
    most, last = question["max_velocity"], None
    counts, outputs = [], []
    for position, velocity, acceleration in question["command"]:
        count = plant.count()
        u = pid.step(position - count, velocity / most, acceleration / question["max_acceleration"])
        if inner:
            seen = 0.0 if last is None else (count - last) / cycle
            output = inner.step(u - seen / most) * question["max_effort"]
            torque = output / 1000 * question["plant"]["rated_torque"]
            plant.step(clamp(torque, question["plant"]["max_torque"]))
        else:
            output = u * most
            plant.step(output)
        last = count
        counts.append(count)
        outputs.append(output)
    return {"counts": counts, "outputs": outputs}


if __name__ == "__main__":
    json.dump(run(json.load(sys.stdin)), sys.stdout)

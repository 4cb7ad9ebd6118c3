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
        elif plant["kind"] == "winding":
            # L i' = u - R i - ke w, J w' = kt i - d w; u in V.
            inertia, inductance = plant["inertia"], plant["inductance"]
            a = [[0.0, 1.0, 0.0],
                 [0.0, -plant["viscous"] / inertia, plant["torque_constant"] / inertia],
                 [0.0, -plant["back_emf"] / inductance, -plant["resistance"] / inductance]]
            b = [[0.0], [0.0], [1.0 / inductance]]
            self.counts = plant["counts_per_turn"] / (2 * math.pi)
        elif plant["kind"] == "lag":
            # A drive that has its velocity after a lag; its state is in increments.
            a = [[0.0, 1.0], [0.0, -1.0 / plant["time_constant"]]]
            b = [[0.0], [1.0 / plant["time_constant"]]]
            self.counts = 1.0
        else:
            raise ValueError(plant["kind"])
        order = len(a)
        system = (np.array(a), np.array(b), np.eye(order), np.zeros((order, 1)))
        self.a, self.b, *_ = cont2discrete(system, cycle, "zoh")
        self.x = np.zeros((order, 1))

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

    def step(self, error, most=1.0):
        law = self.p * error + self.i * self.sum
        wanted = clamp(self.sum + error * self.ms, self.most)
        part = self.i * (wanted - self.sum)
        part = clamp_to(part, -max(most + law, 0.0), max(most - law, 0.0))
        self.sum = self.sum + part / self.i if self.i else wanted
        return clamp(self.p * error + self.i * self.sum, most)


class CurrentLoop:
    """Parts of the voltage, (P e / I + 4 Q sum e / I) / 4096 with I the full current (32768 / I / 2^27 = 1 / 4096 / I)."""

    def __init__(self, gains, full):
        self.p, self.i = gains["curkprop"] / 4096 / full, 4 * gains["curkint"] / 4096 / full
        self.most, self.sum = gains["curkilim"], 0.0

    def step(self, error):
        law = self.p * error + self.i * self.sum
        wanted = clamp(self.sum + error, self.most)
        part = clamp_to(self.i * (wanted - self.sum), -max(1.0 + law, 0.0), max(1.0 - law, 0.0))
        self.sum = self.sum + part / self.i if self.i else wanted
        return clamp(self.p * error + self.i * self.sum, 1.0)


def clamp_to(value, low, high):
    return max(low, min(high, value))


def run(question):
    cycle, gains = question["cycle"], question["gains"]
    plant = Plant(question["plant"], cycle)
    pid = Pid(gains, question["period"])
    kind, mode = question["plant"]["kind"], question.get("ampmode", 0)
    inner = VelocityLoop(gains, cycle) if kind == "motor" or kind == "winding" and mode in (0, 1) else None
    current = CurrentLoop(gains, question["full_current"]) if kind == "winding" and mode in (0, 2) else None
    most, last = question["max_velocity"], None
    counts, outputs = [], []
    for position, velocity, acceleration in question["command"]:
        count = plant.count()
        u = pid.step(position - count, velocity / most, acceleration / question["max_acceleration"])
        seen = 0.0 if last is None else (count - last) / cycle
        if kind == "winding":
            # AMPMAXCUR bounds what the loop above the current asks for, and nothing where there is no current loop.
            cap = question["ampmaxcur"] / 1000 / question["full_current"] if current else 1.0
            above = inner.step(u - seen / most, cap) if inner else clamp(u, cap)
            told = float(plant.x[2, 0])
            share = current.step(above * question["full_current"] - told) if current else above
            output = share * question["max_effort"]
            plant.step(output / 1000 * question["plant"]["voltage"])
        elif inner:
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

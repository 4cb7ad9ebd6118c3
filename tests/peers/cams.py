#!/usr/bin/env python3
"""Laws of motion, plans and splines as scipy has them: a question in JSON on stdin, the answers in JSON on stdout.

Nothing here is the closed form of a law: sines and trapezoids are integrated from the shape of their acceleration and
scaled so that the way is 1; polynomials come from the derivatives at their ends; peaks from the roots of derivatives.
"""
import json
import sys
from math import cos, pi, sin

import numpy as np
from scipy.interpolate import BPoly, CubicSpline, PPoly, make_interp_spline

# Exact to the last digits for a wave of a quarter.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)

# Acceleration of VDI 2143, as pieces up to z.
SHAPES = {
    "simple_sine": [(0.5, lambda z: cos(pi * z)), (1.0, lambda z: cos(pi * z))],
    "modified_sine": [
        (1 / 8, lambda z: sin(4 * pi * z)),
        (1 / 2, lambda z: cos(4 * pi / 3 * (z - 1 / 8))),
        (7 / 8, lambda z: -cos(4 * pi / 3 * (7 / 8 - z))),
        (1.0, lambda z: -sin(4 * pi * (1 - z))),
    ],
    "modified_trapezoid": [
        (1 / 8, lambda z: sin(4 * pi * z)),
        (3 / 8, lambda z: 1.0),
        (5 / 8, lambda z: cos(4 * pi * (z - 3 / 8))),
        (7 / 8, lambda z: -1.0),
        (1.0, lambda z: -sin(4 * pi * (1 - z))),
    ],
}


def integral(pieces, z, weight):
    """Of weight(t) times the acceleration, from 0 to z."""
    parts, begin = [], 0.0
    for end, shape in pieces:
        end = min(end, z)
        if end > begin:
            half = (end - begin) / 2
            parts += [half * w * weight(begin + half * (1 + x)) * shape(begin + half * (1 + x)) for x, w in zip(NODES, WEIGHTS)]
        begin = max(begin, end)
    return float(np.sum(np.sort(parts))) if parts else 0.0


class Integrated:
    """A law of sines, from 0 to 1."""

    def __init__(self, name):
        self.pieces = SHAPES[name]
        self.scale = 1 / integral(self.pieces, 1.0, lambda t: 1.0 - t)

    def at(self, z):
        shape = next(shape for end, shape in self.pieces if z <= end)
        way = self.scale * integral(self.pieces, z, lambda t: z - t)
        return [way, self.scale * integral(self.pieces, z, lambda t: 1.0), self.scale * shape(z)]

    def peaks(self):
        """Velocity, where the acceleration changes its sign, and acceleration: no shape is beyond 1."""
        return [self.at(0.5)[1], self.scale]


class Polynomial:
    """From derivatives at both ends."""

    def __init__(self, length, first, last):
        self.pieces = PPoly.from_bernstein_basis(BPoly.from_derivatives([0.0, length], [first, last]))
        self.length = length

    def at(self, x):
        return [float(self.pieces(x, order)) for order in range(4)]

    def peaks(self):
        def largest(order):
            roots = self.pieces.derivative(order + 1).roots(extrapolate=False)
            places = [0.0, self.length, *(root for root in roots if 0 <= root <= self.length)]
            return max(abs(float(self.pieces(place, order))) for place in places)

        return [largest(order) for order in (1, 2, 3)]


def law(question):
    name = question["law"]
    if name == "straight":
        return {"at": [[z, 1.0, 0.0, 0.0] for z in question["at"]], "peaks": [1.0, 0.0, 0.0]}
    if name.startswith("polynomial"):
        still = [0.0] * (2 if name == "polynomial_5" else 3)
        one = Polynomial(1.0, [0.0, *still], [1.0, *still])
    else:
        one = Integrated(name)
    return {"at": [one.at(z) for z in question["at"]], "peaks": one.peaks()}


def plan(question):
    """Straight lines and polynomials alone, each polynomial with the velocities of the lines beside it."""
    segments, answers, peaks = question["segments"], {}, []
    begins = [0.0, *(to for to, _, _ in segments)]
    ways = np.concatenate([[0.0], np.cumsum([travel for _, travel, _ in segments])])

    def slope(number):
        if question["is_cyclic"]:
            number %= len(segments)
        if not 0 <= number < len(segments) or segments[number][2] != "straight":
            return 0.0
        return segments[number][1] / (begins[number + 1] - begins[number])

    pieces = []
    for number, (to, travel, name) in enumerate(segments):
        length = to - begins[number]
        if name == "straight":
            piece = Polynomial(length, [0.0, travel / length], [travel, travel / length])
        else:
            still = [0.0] * (1 if name == "polynomial_5" else 2)
            piece = Polynomial(length, [0.0, slope(number - 1), *still], [travel, slope(number + 1), *still])
        pieces.append(piece)
        peaks.append(piece.peaks())
    for x in question["at"]:
        number = next(number for number in range(len(segments)) if x < begins[number + 1])
        way, *rates = pieces[number].at(x - begins[number])
        answers[x] = [ways[number] + way, *rates]
    return {"at": [answers[x] for x in question["at"]], "peaks": list(np.max(peaks, axis=0))}


def spline(question):
    x, y = np.array(question["x"]), np.array(question["y"])
    ends, degree = question["ends"], question["degree"]
    slope = 0.0
    if ends == "periodic":
        # scipy wants the same value at both ends: the way of a period is a line beside it.
        slope = (y[-1] - y[0]) / (x[-1] - x[0])
        y = y - slope * (x - x[0])
        y[-1] = y[0]
    if degree == 3:
        first, last = [(order, question[end][0]) for order, end in ((1, "first"), (1, "last"))]
        through = CubicSpline(x, y, bc_type={"natural": "natural", "periodic": "periodic", "clamped": (first, last)}[ends])
    elif ends == "periodic":
        through = make_interp_spline(x, y, k=5, bc_type="periodic")
    elif ends == "natural":
        through = make_interp_spline(x, y, k=5, bc_type=([(3, 0.0), (4, 0.0)], [(3, 0.0), (4, 0.0)]))
    else:
        first, last = [list(zip((1, 2), question[end])) for end in ("first", "last")]
        through = make_interp_spline(x, y, k=5, bc_type=(first, last))
    line = lambda place: [slope * (place - x[0]), slope, 0.0, 0.0]
    rates = lambda place: [float(through(place, order)) + added for order, added in enumerate(line(place))]
    return {"at": [rates(place) for place in question["at"]]}


def main():
    asked = json.load(sys.stdin)
    kinds = {"laws": law, "plans": plan, "splines": spline}
    json.dump({kind: [kinds[kind](question) for question in questions] for kind, questions in asked.items()}, sys.stdout)


if __name__ == "__main__":
    main()

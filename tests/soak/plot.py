#!/usr/bin/env python3
"""Draws what soak.py has measured: memory, descriptors, and how soon newcomers were answered.

    tests/soak/plot.py target/soak docs/images/soak.svg
"""
import csv
import sys
from pathlib import Path

WIDE, HIGH, LEFT, GAP = 640, 130, 56, 44
PROGRAM, SIDE, GREY = "#1f5fa8", "#c05a1a", "#8a8a8a"
WINDOW_S = 300


def rows(path):
    with open(path, newline="") as file:
        return [{key: float(value) for key, value in row.items() if is_number(value)} | row_text(row) for row in csv.DictReader(file)]


def is_number(text):
    try:
        return float(text) is not None
    except ValueError:
        return False


def row_text(row):
    return {"rmw": row.get("rmw", "")}


def share(values, part):
    values = sorted(values)
    return values[min(len(values) - 1, int(part * len(values)))]


class Panel:
    """A title, an axis from 0 to the next round number above the greatest value, and lines."""

    def __init__(self, number, title, unit, end_s, lines):
        self.top = 24 + number * (HIGH + GAP)
        self.end_s = end_s
        most = max(value for _, _, points in lines for _, value in points)
        step = next(s for s in (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200) if most <= 5 * s)
        self.most = step * (int(most / step) + 1)
        self.parts = [text(LEFT, self.top - 8, f"{title} ({unit})", weight="bold")]
        for tick in range(int(round(self.most / step)) + 1):
            y = self.y(tick * step)
            self.parts.append(f'<line x1="{LEFT}" y1="{y:.1f}" x2="{LEFT + WIDE}" y2="{y:.1f}" stroke="#ddd"/>')
            self.parts.append(text(LEFT - 6, y + 4, f"{tick * step:g}", anchor="end"))
        for place, (name, colour, points) in enumerate(lines):
            path = " ".join(f"{self.x(s):.1f},{self.y(value):.1f}" for s, value in points)
            self.parts.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="1.4"/>')
            self.parts.append(text(LEFT + 230 + 160 * place, self.top - 8, name, colour=colour))

    def x(self, s):
        return LEFT + WIDE * s / self.end_s

    def y(self, value):
        return self.top + HIGH - HIGH * value / self.most


def text(x, y, words, anchor="start", colour="#333", weight="normal"):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{colour}" font-weight="{weight}">{words}</text>'


def newcomers(path, end_s):
    windows = {}
    for row in rows(path):
        if "answered_after_s" in row:
            for who in (row["rmw"], "all"):
                windows.setdefault((who, int(row["s"] // WINDOW_S)), []).append(row["answered_after_s"])
    of = lambda rmw, part: [((w + 0.5) * WINDOW_S, share(v, part)) for (r, w), v in sorted(windows.items()) if r == rmw and (w + 1) * WINDOW_S <= end_s]
    return [("rmw_cyclonedds, 99 %", PROGRAM, of("cyclone", 0.99)), ("rmw_fastrtps, 99 %", SIDE, of("fastdds", 0.99)),
            ("half of all", GREY, of("all", 0.5))]


def main(folder, drawing):
    figures = [row for row in rows(folder / "figures.csv") if "program_rss_mib" in row]
    end_s = figures[-1]["s"]
    line = lambda key: [(row["s"], row[key]) for row in figures if key in row]
    panels = [
        Panel(0, "Memory", "MiB resident", end_s, [("program", PROGRAM, line("program_rss_mib")), ("ROS side", SIDE, line("side_rss_mib"))]),
        Panel(1, "File descriptors", "open", end_s, [("program", PROGRAM, line("program_fds")), ("ROS side", SIDE, line("side_fds"))]),
        Panel(2, "First answer to a newcomer", "s", end_s, newcomers(folder / "newcomers.csv", end_s)),
    ]
    foot = panels[-1].top + HIGH
    parts = [part for panel in panels for part in panel.parts]
    parts += [text(panels[0].x(minute * 60), foot + 18, f"{minute} min", anchor="middle") for minute in range(0, int(end_s // 60) + 1, 20)]
    size = f'width="{LEFT + WIDE + 24}" height="{foot + 30}"'
    drawing.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="sans-serif" font-size="12">\n'
                       f'<rect width="100%" height="100%" fill="white"/>\n' + "\n".join(parts) + "\n</svg>\n")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(Path(sys.argv[1]), Path(sys.argv[2]))

#!/usr/bin/env python3
"""Draws docs/images/crates.svg: the crates of the workspace and which of them depend on which.

    tests/drawing/crates.py            writes docs/images/crates.svg

Crates and dependencies are read from the Cargo.toml files. PLACES has the place of each box and its text. Arrows are
vertical; a dependency without room for a straight arrow is an error, as is a crate without a place.
core/tests/architecture.rs compares the picture with the Cargo.toml files.
"""

import html
import pathlib
import sys
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]
PICTURE = ROOT / "docs/images/crates.svg"

WIDTH, HEIGHT = 800, 710
BOX = 88
ROWS = (76, 206, 336, 466, 596)
"""Upper edges of the rows of boxes."""

# Crate: row, left edge, right edge, colour, lines of text.
PLACES = {
    "lineshaft": (0, 24, 776, "node", ["command line · cells · scenarios · cycle thread · bags"]),
    "lineshaft-tune": (1, 84, 238, "tune", ["identification,", "design of loops"]),
    "lineshaft-can": (1, 258, 412, "can", ["CAN buses,", "CANopen master"]),
    "lineshaft-ros": (1, 450, 640, "ros", ["ROS 2 interfaces,", "process of the DDS library"]),
    "lineshaft-cia402": (2, 286, 450, "can", ["CiA 402 drives", "on any bus"]),
    "lineshaft-core": (3, 84, 552, "core", ["one cycle of the machine: deterministic, no I/O, no clock, no ROS"]),
    "rust_client": (3, 664, 776, "test", ["a client,", "for the tests"]),
    "lineshaft-program": (4, 24, 582, "program", ["programs of users: WebAssembly, checked and translated"]),
    "lineshaft_msgs": (4, 602, 776, "msgs", ["ROS 2 messages and", "their Rust types"]),
}

LIGHT = {
    "paper": "#ffffff", "ink": "#1f2933", "quiet": "#52606d", "arrow": "#52606d", "dashed": "#9aa5b1",
    "node": "#e4e7eb", "tune": "#e3f8f1", "can": "#fff1d6", "ros": "#e6e8ff", "core": "#d9ecff",
    "test": "#f5f7fa", "program": "#fde7ef", "msgs": "#f1e6ff",
    "node-edge": "#7b8794", "tune-edge": "#2a9d7c", "can-edge": "#c98a1b", "ros-edge": "#5a63d8",
    "core-edge": "#2b7fd0", "test-edge": "#9aa5b1", "program-edge": "#cf4a7d", "msgs-edge": "#8b50d0",
}
DARK = {
    "paper": "#161b22", "ink": "#e6edf3", "quiet": "#a9b4c0", "arrow": "#a9b4c0", "dashed": "#6e7a87",
    "node": "#2b323b", "tune": "#123a30", "can": "#40300f", "ros": "#262b5c", "core": "#11365a",
    "test": "#1f252d", "program": "#4a1a2e", "msgs": "#371f56",
    "node-edge": "#8b97a5", "tune-edge": "#3fbf9a", "can-edge": "#e0a63c", "ros-edge": "#8d95f5",
    "core-edge": "#58a6f0", "test-edge": "#6e7a87", "program-edge": "#f07aa6", "msgs-edge": "#b98af0",
}


def crates():
    """Returns the crates by name: folder, crates that they need, crates that only their tests need."""
    members = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["members"]
    tables = {member: tomllib.loads((ROOT / member / "Cargo.toml").read_text()) for member in members}
    names = {table["package"]["name"] for table in tables.values()}
    of = lambda table, section: sorted(names & set(table.get(section, {})))
    return {
        table["package"]["name"]: (member, of(table, "dependencies"), of(table, "dev-dependencies"))
        for member, table in tables.items()
    }


def free(start, end, taken):
    """Returns the parts of the range between start and end that no range in taken covers."""
    parts, at = [], start
    for low, high in sorted(taken):
        if low > at:
            parts.append((at, min(low, end)))
        at = max(at, high)
    parts.append((at, end))
    return [(low, high) for low, high in parts if high > low]


def arrows(found):
    """Returns x of each arrow: between the edges of both crates, and beside the boxes in between."""
    margin, distance = 9, 15
    wanted = [(name, to, False) for name, (_, needs, _) in found.items() for to in needs]
    wanted += [(name, to, True) for name, (_, needs, tests) in found.items() for to in tests if to not in needs]
    rooms = {}
    for name, to, _ in wanted:
        (upper, left, right, *_), (lower, to_left, to_right, *_) = PLACES[name], PLACES[to]
        if upper >= lower:
            sys.exit(f"{name} needs {to}, which is not below it: change PLACES")
        between = [place for place in PLACES.values() if upper < place[0] < lower]
        taken = [(low - margin, high + margin) for _, low, high, *_ in between]
        rooms[name, to] = free(max(left, to_left) + margin, min(right, to_right) - margin, taken)
    drawn = {}
    # Those with the least room first.
    for name, to, is_test in sorted(wanted, key=lambda one: (sum(high - low for low, high in rooms[one[:2]]), one)):
        spans = rooms[name, to]
        rows = lambda upper, lower: set(range(PLACES[upper][0], PLACES[lower][0]))
        for x in [x for other, (x, _) in drawn.items() if rows(*other) & rows(name, to)]:
            spans = [part for low, high in spans for part in free(low, high, [(x - distance, x + distance)])]
        if not spans:
            sys.exit(f"there is no straight way from {name} to {to}: change PLACES")
        (upper, left, right, *_), (lower, to_left, to_right, *_) = PLACES[name], PLACES[to]
        if lower == upper + 1:
            # As near to the middle of both boxes as the others let it.
            wish = (max(left, to_left) + min(right, to_right)) / 2
            x = min((min(max(wish, low), high) for low, high in spans), key=lambda x: abs(x - wish))
        else:
            x = sum(max(spans, key=lambda span: span[1] - span[0])) / 2
        drawn[name, to] = (x, is_test)
    return drawn


def style():
    rules = lambda colours: "".join(
        [f".paper{{fill:{colours['paper']}}}"]
        + [f"text{{fill:{colours['ink']}}}.quiet{{fill:{colours['quiet']}}}"]
        + [f".arrow{{stroke:{colours['arrow']}}}.head{{fill:{colours['arrow']}}}"]
        + [f".dashed{{stroke:{colours['dashed']}}}.dashed-head{{fill:{colours['dashed']}}}"]
        + [
            f".{kind}{{fill:{colours[kind]};stroke:{colours[kind + '-edge']}}}"
            for kind in ("node", "tune", "can", "ros", "core", "test", "program", "msgs")
        ]
    )
    return f"<style>{rules(LIGHT)}@media(prefers-color-scheme:dark){{{rules(DARK)}}}</style>"


def box(name, folder):
    row, left, right, kind, lines = PLACES[name]
    top, middle = ROWS[row], (left + right) / 2
    # Lines of a narrow box are below its name, the line of a wide one too.
    first = top + (30 if len(lines) == 1 else 24)
    # A letter of the folder is 0.61 of its size wide.
    size = min(11.5, (right - left - 8) / (0.61 * (len(folder) + 1)))
    smaller = "" if size == 11.5 else f' style="font-size:{size:.1f}px"'
    text = [
        f'<text x="{middle:g}" y="{first}" class="name">{html.escape(name)}</text>',
        f'<text x="{middle:g}" y="{first + 17}" class="folder quiet"{smaller}>{html.escape(folder)}/</text>',
    ]
    text += [
        f'<text x="{middle:g}" y="{first + 37 + 16 * at}" class="line">{html.escape(line)}</text>'
        for at, line in enumerate(lines)
    ]
    return "\n".join(
        [
            f'<g data-crate="{html.escape(name)}" data-folder="{html.escape(folder)}">',
            f'<rect x="{left}" y="{top}" width="{right - left}" height="{BOX}" rx="8" class="{kind}"/>',
            *text,
            "</g>",
        ]
    )


def arrow(name, to, x, is_test):
    top, bottom = ROWS[PLACES[name][0]] + BOX, ROWS[PLACES[to][0]]
    kind = "dashed" if is_test else "arrow"
    return (
        f'<g data-from="{name}" data-to="{to}" data-kind="{"dev" if is_test else "normal"}">'
        f'<path d="M{x:.1f} {top + 1}V{bottom - 8}" class="{kind}"/>'
        f'<path d="M{x - 4.5:.1f} {bottom - 10}L{x + 4.5:.1f} {bottom - 10}L{x:.1f} {bottom - 1.5}z"'
        f' class="{"dashed-head" if is_test else "head"}"/></g>'
    )


def legend():
    y = 44
    return "\n".join(
        [
            f'<text x="24" y="{y}" class="title">Crates of Lineshaft</text>',
            f'<path d="M452 {y - 4}h34" class="arrow"/><path d="M485 {y - 8.5}v9l8.5 -4.5z" class="head"/>',
            f'<text x="500" y="{y}" class="note quiet">depends on</text>',
            f'<path d="M594 {y - 4}h34" class="dashed"/><path d="M627 {y - 8.5}v9l8.5 -4.5z" class="dashed-head"/>',
            f'<text x="642" y="{y}" class="note quiet">in its tests only</text>',
        ]
    )


def picture():
    found = crates()
    missing = sorted(set(found) ^ set(PLACES))
    if missing:
        sys.exit(f"PLACES and the workspace differ in {', '.join(missing)}")
    sizes = (
        "text{font-family:Inter,'Segoe UI',Roboto,Helvetica,Arial,'DejaVu Sans',sans-serif;text-anchor:middle}"
        ".title{font-size:19px;font-weight:600;text-anchor:start}.name{font-size:16px;font-weight:600}"
        ".folder{font-family:ui-monospace,Consolas,'DejaVu Sans Mono',monospace;font-size:11.5px}"
        ".line{font-size:13px}.note{font-size:12.5px;text-anchor:start}"
        ".arrow,.dashed{fill:none;stroke-width:1.6}.dashed{stroke-dasharray:5 4}rect{stroke-width:1.4}"
    )
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}">',
        "<title>The crates of Lineshaft and their dependencies</title>",
        "<!-- tests/drawing/crates.py draws this from the Cargo.toml files. -->",
        f"<style>{sizes}</style>",
        style(),
        f'<rect width="{WIDTH}" height="{HEIGHT}" rx="10" class="paper"/>',
        legend(),
        *(arrow(name, to, x, is_test) for (name, to), (x, is_test) in sorted(arrows(found).items())),
        *(box(name, found[name][0]) for name in PLACES),
        "</svg>",
    ]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    PICTURE.write_text(picture())

"""Layouts of Foxglove and PlotJuggler against a bag: every path in them leads to something that is there.

Foxglove writes `/topic.field[0].field`. PlotJuggler makes one series of each number, named `/topic/field[0]/field`;
those of a JointState it names by their joints, `/joint_states/x/position`.
"""
import json
import re
from array import array
from types import SimpleNamespace
from xml.etree import ElementTree

import bags
from report import Failure, show

PATH = re.compile(r"(/[\w/]+)((?:\.\w+|\[\d+\]|\[:\])*)")
STEP = re.compile(r"\.(\w+)|\[(\d+|:)\]")
PLOTTED = (int, float, bool)


def layout(a):
    """Every path of a layout against the messages of a bag."""
    first = {}
    for item in bags.items(a.bag):
        first.setdefault(item.topic, item)
    check = plotjuggler if str(a.layout).endswith(".xml") else foxglove
    paths, wrong, more = check(a.layout, first)
    show(paths=len(paths), wrong=wrong, **more)
    if wrong or not paths:
        raise Failure(f"{len(wrong)} of {len(paths)} paths lead nowhere: {wrong}")


def foxglove(name, first):
    with open(name, encoding="utf-8") as f:
        document = json.load(f)
    panels, shown = document["configById"], set(leaves(document["layout"]))
    if shown != set(panels):
        raise Failure(f"panels that are not both configured and shown: {sorted(shown ^ set(panels))}")
    paths = [(panel, path) for panel, config in panels.items() for path in strings(config) if path.startswith("/")]
    wrong, unlabelled = [], []
    for panel, path in paths:
        kind = panel.split("!")[0]
        values = followed(path, first)
        if not values or kind == "Plot" and not all(isinstance(v, PLOTTED) for v in values):
            wrong.append(f"{panel}: {path}")
        elif kind == "StateTransitions" and type(values[0]) is int and not labels(path, first):
            unlabelled.append(path)
    kinds = sorted({panel.split("!")[0] for panel in panels})
    return paths, wrong, {"panels": kinds, "unlabelled": unlabelled}


def leaves(node):
    """The panels of a tree of splits."""
    return [node] if isinstance(node, str) else leaves(node["first"]) + leaves(node["second"])


def strings(node):
    if isinstance(node, str):
        return [node]
    children = node.values() if isinstance(node, dict) else node if isinstance(node, list) else ()
    return [s for child in children for s in strings(child)]


def followed(path, first):
    """What a Foxglove path leads to in the first message of its topic; nothing when it leads nowhere."""
    match = PATH.fullmatch(path)
    if not match or match[1] not in first:
        return []
    values = [first[match[1]].ros]
    for name, index in STEP.findall(match[2]):
        try:
            if name:
                values = [getattr(v, name) for v in values]
            elif index == ":":
                values = [x for v in values for x in v]
            else:
                values = [v[int(index)] for v in values]
        except (AttributeError, IndexError, TypeError):
            return []
    return values


def labels(path, first):
    """The names that Foxglove shows instead of the numbers of a field: constants of its type right before it."""
    match = PATH.fullmatch(path)
    field, constants = STEP.findall(match[2])[-1][0], []
    for line in first[match[1]].schema.splitlines():
        words = line.split("#")[0].split()
        if len(words) < 2:
            continue
        name, is_constant, _ = words[1].partition("=")
        if constants and constants[-1][0] != words[0]:
            constants = []
        if is_constant:
            constants.append((words[0], name))
        elif name == field and constants:
            return [name for _, name in constants]
        else:
            constants = []
    return []


def plotjuggler(name, first):
    root = ElementTree.parse(name).getroot()
    for splitter in root.iter("DockSplitter"):
        sizes = [float(size) for size in splitter.get("sizes").split(";")]
        if not int(splitter.get("count")) == len(sizes) == len(splitter) or abs(sum(sizes) - 1) > 1e-3:
            raise Failure(f"a splitter of {len(splitter)} parts has count {splitter.get('count')} and sizes {sizes}")
    known = {series for topic, item in first.items() for series in series_of(topic, item)}
    curves = [curve.get("name") for curve in root.iter("curve")]
    tabs = [tab.get("tab_name") for tab in root.iter("Tab")]
    return curves, [curve for curve in curves if curve not in known], {"series": len(known), "tabs": tabs}


def series_of(topic, item):
    """The names that PlotJuggler gives to the numbers of a message."""
    m = item.ros
    if item.type == bags.JOINT_STATE:
        return [f"{topic}/{joint}/{field}" for joint in m.name for field in ("position", "velocity", "effort")]
    return flat(topic, m)


def flat(prefix, value):
    if isinstance(value, PLOTTED):
        return [prefix]
    if isinstance(value, SimpleNamespace):
        return [s for name in type(value).__slots__ for s in flat(f"{prefix}/{name}", getattr(value, name))]
    if isinstance(value, (list, tuple, array)):
        return [s for i, one in enumerate(value) for s in flat(f"{prefix}[{i}]", one)]
    return []

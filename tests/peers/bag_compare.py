"""Values of a bag against the CSV of the same simulated run, which has a column for every signal."""
import csv
import math
import struct
import zlib
from collections import Counter
from fractions import Fraction

import bags
from report import Failure, show

# Field of AxisState: signal of the axis.
INCREMENTS = {
    "command_increments": "command.position", "position_increments": "actual.position",
    "following_error_increments": "following_error", "sync_error_increments": "sync.error",
}
NUMBERS = {
    "state": "state", "drive_state": "drive_state", "reference": "reference", "mode_of_operation": "mode_of_operation",
    "enabled": "enabled", "homed": "homed", "in_position": "in_position", "in_velocity": "in_velocity",
    "in_sync": "in_sync", "warning": "warning", "error_code": "error", "effort": "actual.effort",
}
LIMITS = {
    "positive_limit": ("limit.positive", "limit.software_positive"),
    "negative_limit": ("limit.negative", "limit.software_negative"),
}
POSITIONS = {
    "command_position": "command.position", "position": "actual.position", "following_error": "following_error",
    "sync_error": "sync.error",
}
RATES = {
    "command_velocity": "command.velocity", "command_acceleration": "command.acceleration",
    "velocity": "actual.velocity",
}
ULPS = 4  # a product of three rounded factors


class Difference(Failure):
    pass


def against_csv(a):
    """Every value of every message against the row of its cycle."""
    check = Comparison(a)
    try:
        for item in bags.items(a.bag):
            check.item(item)
        check.end()
    except Difference as e:
        check.first = str(e)
    show(compared=check.values, messages=check.messages, rows=len(check.rows), first_difference=check.first)
    if check.first:
        raise Failure(f"the bag differs from the CSV: {check.first}")


def scale(text):
    """`x=1/104857600` or `turret=2pi/36000`: an axis and its m or rad per increment, exactly but for pi."""
    name, _, value = text.partition("=")
    numerator, _, denominator = value.partition("/")
    factor = Fraction(math.pi) if numerator.endswith("pi") else 1
    return name, Fraction(numerator.removesuffix("pi") or 1) * factor / Fraction(denominator or 1)


def number(text):
    return int(text) if text.lstrip("-").isdigit() else float(text)


def word(text):
    """A value of the CSV as a word of ~/signals."""
    value = number(text)
    return value & 0xFFFF_FFFF_FFFF_FFFF if isinstance(value, int) else struct.unpack("<Q", struct.pack("<d", value))[0]


def is_near(value, exact):
    return abs(Fraction(value) - exact) <= ULPS * Fraction(math.ulp(float(exact)))


class Comparison:
    def __init__(self, a):
        with open(a.csv, encoding="utf-8", newline="") as f:
            table = csv.reader(f)
            self.names = next(table)[2:]
            self.rows = {int(row[0]): row[2:] for row in table}
        self.place = {name: i for i, name in enumerate(self.names)}
        self.cycle_ns = bags.cycle_ns(a.bag)
        self.scales = dict(scale(text) for text in a.scale)
        self.inputs = {"encoder": a.encoder, "digital": a.digital, "analog": a.analog}
        self.drives = None  # names of the axes that have one; joint_states tells them
        self.file = None
        self.words = [None] * len(self.names)
        self.sequence, self.crc = None, {}
        self.values, self.messages, self.first = Counter(), Counter(), None
        self.waiting = []  # messages that need to know the drives
        self.known = {bags.AXIS_STATES: self.axis_states, bags.JOINT_STATE: self.joint_states,
                      bags.SIGNALS: self.signals, bags.INPUTS: self.cycle_inputs, bags.EVENT: self.event,
                      bags.COMMAND: self.command}

    def item(self, item):
        kind = item.type.rsplit("/", 1)[1]
        self.kind, self.messages[kind] = kind, self.messages[kind] + 1
        if item.type not in self.known:
            raise Difference(f"nobody knows the type {item.type}")
        if item.type == bags.JOINT_STATE:
            # The only message without its cycle.
            cycle, rest = divmod(bags.nanoseconds(item.ros.header.stamp), self.cycle_ns)
            self.equal("stamp within its cycle", cycle, rest, 0)
        else:
            cycle = item.ros.cycle
        if cycle not in self.rows:
            raise Difference(f"{kind} of cycle {cycle}, which the CSV does not have")
        self.equal("log_time", cycle, item.log_time, cycle * self.cycle_ns)
        self.equal("publish_time", cycle, item.publish_time, cycle * self.cycle_ns)
        self.known[item.type](cycle, item)

    def signal(self, cycle, name):
        try:
            return number(self.rows[cycle][self.place[name]])
        except KeyError:
            raise Difference(f"the CSV has no column {name}") from None

    def equal(self, what, cycle, value, want):
        self.values[self.kind] += 1
        if value != want and not (value != value and want != want):
            raise Difference(f"{self.kind} of cycle {cycle}: {what} is {value!r}, the CSV has {want!r}")

    def near(self, what, cycle, value, exact):
        self.values[self.kind] += 1
        if not is_near(value, exact):
            raise Difference(f"{self.kind} of cycle {cycle}: {what} is {value!r}, the CSV has {float(exact)!r}")

    def in_a_row(self, cycle):
        """Each cycle has this message, once."""
        self.equal("cycle", cycle, cycle, self.messages[self.kind] - 1)

    def scale_of(self, axis):
        if axis not in self.scales:
            raise Failure(f"--scale of axis {axis} is missing")
        return self.scales[axis]

    def axis_states(self, cycle, item):
        self.equal("stamp", cycle, bags.nanoseconds(item.ros.header.stamp), cycle * self.cycle_ns)
        for axis in item.ros.axes:
            def of(signal):
                return self.signal(cycle, f"{axis.name}.{signal}")
            unit = self.scale_of(axis.name)
            for field, signal in (INCREMENTS | NUMBERS).items():
                self.equal(f"{axis.name}.{field}", cycle, getattr(axis, field), of(signal))
            for field, (switch, software) in LIMITS.items():
                self.equal(f"{axis.name}.{field}", cycle, getattr(axis, field), bool(of(switch) or of(software)))
            for field, signal in POSITIONS.items():
                fraction = Fraction(of("command.fraction")) if field == "command_position" else 0
                self.near(f"{axis.name}.{field}", cycle, getattr(axis, field), (of(signal) + fraction) * unit)
            for field, signal in RATES.items():
                self.near(f"{axis.name}.{field}", cycle, getattr(axis, field), Fraction(of(signal)) * unit)

    def joint_states(self, cycle, item):
        m = item.ros
        self.drives = m.name
        for i, axis in enumerate(m.name):
            unit = self.scale_of(axis)
            self.near(f"{axis} position", cycle, m.position[i], self.signal(cycle, f"{axis}.actual.position") * unit)
            self.near(f"{axis} velocity", cycle, m.velocity[i],
                      Fraction(self.signal(cycle, f"{axis}.actual.velocity")) * unit)
            self.equal(f"{axis} effort", cycle, m.effort[i], self.signal(cycle, f"{axis}.actual.effort"))

    def signals(self, cycle, item):
        """Exactly those signals that changed stand in a message, and with them the words are those of the row."""
        m, row = item.ros, self.rows[cycle]
        self.in_a_row(cycle)
        places = list(m.index)
        if item.file != self.file:
            self.file = item.file
            self.equal("indices in the first message of a file", cycle, places, list(range(len(row))))
        self.equal("count of words", cycle, len(m.word), len(places))
        want = [word(text) for text in row]
        if len(places) < len(row):
            changed = [i for i, (old, new) in enumerate(zip(self.words, want, strict=True)) if old != new]
            self.equal("indices of changed signals", cycle, places, changed)
        for i, value in zip(places, m.word, strict=True):
            self.equal(self.names[i], cycle, value, want[i])
        self.words = want
        self.values[self.kind] += len(row) - len(places)  # those that did not change are compared by not being there
        self.equal("inputs_crc", cycle, m.inputs_crc, self.crc.pop(cycle, "no inputs before it"))

    def cycle_inputs(self, cycle, item):
        m = item.ros
        self.in_a_row(cycle)
        self.crc[cycle] = zlib.crc32(item.data)
        self.equal("missed", cycle, m.missed, 0)
        self.waiting.append((cycle, list(m.drive_count)))
        for name, value in zip(self.inputs["encoder"], m.encoder_count, strict=True):
            self.equal(name, cycle, value, self.signal(cycle, f"{name}.count"))
        for i, name in enumerate(self.inputs["digital"]):
            self.equal(name, cycle, m.digital[i // 64] >> i % 64 & 1, self.signal(cycle, name))
        for name, value in zip(self.inputs["analog"], m.analog, strict=True):
            self.equal(name, cycle, value, self.signal(cycle, name))
        if self.drives is not None:
            self.counts()

    def counts(self):
        """Counts of the drives, as soon as it is known which axes have one."""
        for cycle, counts in self.waiting:
            for name, value in zip(self.drives, counts, strict=True):
                self.equal(f"{name}.actual.count", cycle, value, self.signal(cycle, f"{name}.actual.count"))
        self.waiting.clear()

    def event(self, cycle, item):
        m = item.ros
        self.equal("stamp", cycle, bags.nanoseconds(m.header.stamp), cycle * self.cycle_ns - m.age_ns)
        if self.sequence is not None:
            self.equal("sequence", cycle, m.sequence, self.sequence + 1)
        self.sequence = m.sequence

    def command(self, cycle, item):
        self.equal("source", cycle, item.ros.source, "scenario")

    def end(self):
        """Nothing is missing at the end: each row has its inputs and signals."""
        if self.drives is None:
            raise Difference("no joint_states")
        self.counts()
        for kind in ("CycleInputs", "Signals"):
            self.kind = kind
            self.equal("messages", "any", self.messages[kind], len(self.rows))

"""JSON lines for a test harness."""
import dataclasses
import json
import math


class Failure(Exception):
    """What was observed is not what was asked for; the text says what is wrong."""


def plain(o):
    """`o` as JSON can carry it: dataclasses become objects, numbers that are not finite become text."""
    if dataclasses.is_dataclass(o):
        return {f.name: plain(getattr(o, f.name)) for f in dataclasses.fields(o)}
    if isinstance(o, dict):
        return {k: plain(v) for k, v in o.items()}
    if isinstance(o, (list, tuple)):
        return [plain(v) for v in o]
    if isinstance(o, float) and not math.isfinite(o):
        return str(o)
    return o


def show(**observation):
    print(json.dumps(plain(observation), default=str, allow_nan=False), flush=True)


def told(r, **more):
    """Shows the answer of a service; one without success is a failure."""
    show(success=r.success, message=r.message, **more)
    if not r.success:
        raise Failure(r.message)


class Checklist:
    """Runs named checks, shows each, and fails with the names of those that did not hold."""

    def __init__(self):
        self.failed = []

    def check(self, name, got, want):
        """`got` is called; `want` is a value, or a predicate on what it returned."""
        try:
            value = got()
        except TimeoutError as e:
            value, ok = str(e), False
        else:
            ok = bool(want(value)) if callable(want) else value == want
        show(check=name, ok=ok, got=value)
        if not ok:
            self.failed.append(f"{name} (got {value})")

    def check_quietly(self, name, got, want, more=""):
        """As `check`, for what is checked so often that only what fails is shown."""
        value = got()
        if value != want:
            show(check=name, ok=False, got=value, more=more)
            self.failed.append(f"{name} (got {value} {more})")

    def close(self):
        if self.failed:
            raise Failure("; ".join(self.failed))

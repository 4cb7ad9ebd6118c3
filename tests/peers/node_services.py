"""What every ROS 2 node has beside its parameters: the time of a simulation, and the levels of its loggers."""
import time
from dataclasses import dataclass, field

import ros2wire as rw
from cyclonedds.idl import IdlStruct, types as t
from report import Failure, show


@dataclass
class Clock(IdlStruct, typename="rosgraph_msgs::msg::dds_::Clock_"):
    clock: rw.Time = field(default_factory=rw.Time)


@dataclass
class LoggerLevel(IdlStruct, typename="rcl_interfaces::msg::dds_::LoggerLevel_"):
    name: str = ""
    level: t.uint32 = 0


@dataclass
class SetLoggerLevelsResult(IdlStruct, typename="rcl_interfaces::msg::dds_::SetLoggerLevelsResult_"):
    successful: bool = False
    reason: str = ""


@dataclass
class LevelsMessage(IdlStruct, typename="LevelsMessage"):
    levels: t.sequence[LoggerLevel] = field(default_factory=list)


@dataclass
class SetLevelsResponse(IdlStruct, typename="SetLevelsResponse"):
    results: t.sequence[SetLoggerLevelsResult] = field(default_factory=list)


def clock(peer, a):
    """Says a time on /clock for a while, as best effort may be lost at first; or waits until nobody listens to it."""
    q = rw.qos(reliable=a.reliable, depth=1)
    w = peer.made.setdefault("/clock", None) or rw.publisher(peer.dp, "/clock", Clock, q)
    peer.made["/clock"] = w
    if a.nobody:
        rw.wait_until(lambda: not w.get_matched_subscriptions(), rw.MATCH_S, "somebody still listens to /clock")
        return show(listeners=0)
    rw.wait_until(w.get_matched_subscriptions, rw.MATCH_S, "nobody listens to /clock")
    for _ in range(15):
        w.write(Clock(rw.Time(a.sec, a.nanosec)))
        time.sleep(0.02)
    show(listeners=len(w.get_matched_subscriptions()))


def logger_levels(peer, a):
    """Sets `name=level` one by one, then tells the level of each name."""
    def client(verb, srv, request, response):
        name = f"{a.node}/{verb}"
        return peer.once(name, lambda: rw.ServiceClient(peer.dp, name, f"rcl_interfaces/{srv}", request, response))
    pairs = [x.partition("=") for x in a.levels]
    new = [LoggerLevel(n, int(level)) for n, _, level in pairs if level]
    if new:
        c = client("set_logger_levels", "SetLoggerLevels", LevelsMessage, SetLevelsResponse)
        show(results=c.call(LevelsMessage(new)).results)
    c = client("get_logger_levels", "GetLoggerLevels", rw.NamesRequest, LevelsMessage)
    seen = c.call(rw.NamesRequest([n for n, _, _ in pairs])).levels
    show(levels={x.name: x.level for x in seen})


def stamps(peer, a):
    """Waits until the stamps of a topic with a header are at `sec`; or, with `--system`, near the system's time."""
    q = rw.qos(reliable=not a.best_effort, transient_local=a.transient_local, depth=10)
    key = f"{a.topic} {a.best_effort} {a.transient_local}"
    s = peer.once(key, lambda: rw.Subscription(peer.dp, a.topic, rw.JointState, q))
    s.take()
    seen = []

    def is_there():
        seen.extend(m.header.stamp for m in s.take())
        return seen and (abs(seen[-1].sec - time.time()) < 60 if a.system else (seen[-1].sec, seen[-1].nanosec) ==
                         (a.sec, a.nanosec))
    try:
        rw.wait_until(is_there, rw.REPLY_S)
    except TimeoutError:
        raise Failure(f"the last stamp is {seen[-1] if seen else 'none'}") from None
    show(stamp=seen[-1])


def late(peer, a):
    """What a reader that comes late is sent of old samples at once."""
    q = rw.qos(transient_local=True, depth=1000)
    s = rw.Subscription(peer.dp, a.topic, rw.JointState, q).wait()
    got = []
    rw.wait_until(lambda: got.extend(s.take()) or got, rw.REPLY_S, "no sample")
    oldest = got[0].header.stamp
    show(oldest_age=time.time() - oldest.sec - oldest.nanosec * 1e-9)


def rosout(peer, a):
    """The lines of /rosout, until one has `text` in it; with `--none`, fails if one comes within the seconds."""
    s = peer.once("/rosout", lambda: rw.Subscription(peer.dp, "/rosout", rw.Log, rw.ROSOUT_QOS))
    seen = []

    def is_there():
        seen.extend(s.take())
        return any(a.text.replace("_", " ") in m.msg for m in seen)
    end = time.monotonic() + a.seconds
    while not is_there() and time.monotonic() < end:
        time.sleep(0.005)
    hits = [m for m in seen if a.text.replace("_", " ") in m.msg]
    show(lines=hits)
    if bool(hits) == a.none:
        raise Failure(f"{len(hits)} lines with {a.text!r} among {[m.msg for m in seen]}")


def add_commands(command):
    p = command("clock", clock, node=False, sec=0, nanosec=0)
    p.add_argument("--nobody", action="store_true")
    p.add_argument("--reliable", action="store_true")
    p = command("logger-levels", logger_levels)
    p.add_argument("levels", nargs="+", help="name, or name=level")
    p = command("stamps", stamps, node=False, topic="/joint_states", sec=0, nanosec=0)
    for flag in ("--system", "--best-effort", "--transient-local"):
        p.add_argument(flag, action="store_true")
    command("late", late, node=False, topic="/joint_states")
    p = command("rosout", rosout, node=False, text="", seconds=10.0)
    p.add_argument("--none", action="store_true")

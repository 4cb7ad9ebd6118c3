"""A client that asks a node for everything at once, and knows what each answer has to say."""
import random
import time

import ros2wire as rw
from lineshaft_msgs import MOVE_MODES, Answer, AxesRequest, MoveGoal
from report import Failure, show

RELATIVE, VELOCITY = MOVE_MODES.index("relative"), MOVE_MODES.index("velocity")
OPEN = 4  # requests to one service at a time: the writer keeps ten
ENDED = (4, 5, 6)
SUCCEEDED = 4
SOON_S = 0.02


class Line:
    """Requests to one service that wait for their answers."""

    def __init__(self, client):
        self.client, self.open, self.seen = client, {}, set()
        self.answered = self.twice = self.strange = 0
        self.wrong = []

    def is_full(self):
        return len(self.open) >= OPEN

    def ask(self, request, check):
        self.open[self.client.send(request)] = (check, request)

    def take(self):
        for m in self.client.r.take(100):
            if not m.sample_info.valid_data or m.client != self.client.client:
                continue
            if m.seq in self.seen:
                self.twice += 1
            elif m.seq not in self.open:
                self.strange += 1
            else:
                self.seen.add(m.seq)
                check, request = self.open.pop(m.seq)
                self.answered += 1
                if not check(m.data):
                    self.wrong.append(f"{request} was answered with {m.data}"[:500])


class Hammer:
    def __init__(self, peer, a):
        self.dice, self.axis = random.Random(a.seed), a.axis
        node = a.node
        p = peer.once(f"{node}/parameters", lambda: rw.ParameterClient(peer.dp, node))
        names = [n for n in p.list([a.axis]).names]
        self.values = {n: v for i in range(0, len(names), 100)
                       for n, v in zip(names[i:i + 100], p.get(*names[i:i + 100]))}
        # Each client has an axis of its own: its parameters change only where it changes them.
        self.own, self.own_value = f"{a.axis}.velocity_override", None
        self.values.pop(self.own)
        self.names = list(self.values)
        action = peer.action(node, "move_axis")
        self.action = action
        lines = {"enable": peer.axes(node, "enable"), "halt": peer.axes(node, "halt"), "get": p.c_get, "set": p.c_set,
                 "goal": action.c_goal, "cancel": action.c_cancel, "result": action.c_result}
        self.lines = {name: Line(client) for name, client in lines.items()}
        self.goals = []  # accepted, and not asked for yet, each with the time of its answer

    def name(self):
        return f"none_{self.dice.randrange(10 ** 9)}"

    def ask(self, what):
        line = self.lines[what]
        if not line.is_full():
            getattr(self, what)(line)

    def enable(self, line):
        if self.dice.random() < 0.5:
            # Halting ends unsuccessfully where a goal of the same client takes the axis over.
            line.ask(AxesRequest([self.axis]), lambda r: r.success or r.message.startswith(f"{self.axis}: "))
        else:
            wrong = self.name()
            line.ask(AxesRequest([self.axis, wrong]), lambda r: not r.success and wrong in r.message)

    halt = enable

    def get(self, line):
        names = self.dice.choices(self.names, k=self.dice.randint(1, 8))
        want = [self.values[n] for n in names]
        line.ask(rw.NamesRequest(names), lambda r: [v.get() for v in r.values] == want)

    def set(self, line):
        good = [self.dice.random() < 0.5 for _ in range(self.dice.randint(1, 4))]
        wrong = [self.name() for _ in good]
        parameters = [rw.Parameter(self.own if ok else f"{self.axis}.{w}", rw.ParameterValue.of(self.dice.uniform(10, 100)))
                      for ok, w in zip(good, wrong)]

        def check(r):
            return [x.successful for x in r.results] == good and all(
                ok or w in x.reason for ok, w, x in zip(good, wrong, r.results))
        line.ask(rw.ParametersRequest(parameters), check)

    def goal(self, line):
        gid, good = rw.UUID.random(), self.dice.random() < 0.7
        goal = MoveGoal(self.axis if good else self.name(), RELATIVE, position=self.dice.uniform(-0.002, 0.002))

        def check(r):
            if r.accepted:
                self.goals.append((time.monotonic(), gid))
                del self.goals[:-100]
            return r.accepted == good
        line.ask(self.action.SendGoalRequest(gid, goal), check)

    def cancel(self, line):
        if self.goals and self.dice.random() < 0.5:
            # The goal may end meanwhile; a goal that ended long ago may be forgotten.
            _, gid = self.dice.choice(self.goals)
            line.ask(rw.CancelGoalRequest(rw.GoalInfo(gid)), lambda r: (r.return_code, [
                g.goal_id.hex() for g in r.goals_canceling]) in ((0, [gid.hex()]), (3, []), (2, [])))
        else:
            line.ask(rw.CancelGoalRequest(rw.GoalInfo(rw.UUID.random())),
                     lambda r: r.return_code == 2 and not r.goals_canceling)

    def result(self, line):
        if self.goals and self.dice.random() < 0.7:
            since, gid = self.goals.pop()
            # Of all clients 256 results are kept: one who asks late may be too late.
            late = time.monotonic() - since > SOON_S
            line.ask(rw.GetResultRequest(gid), lambda r: r.status in ENDED or late and r.status == 0)
        else:
            line.ask(rw.GetResultRequest(rw.UUID.random()), lambda r: r.status == 0)

    def take(self):
        for line in self.lines.values():
            line.take()

    def open(self):
        return {name: len(line.open) for name, line in self.lines.items() if line.open}


def hammer(peer, a):
    """As fast as this process can for some seconds, or `--rate` a second; then every request must have been answered once, and rightly."""
    peer.axes(a.node, "enable").call(AxesRequest([a.axis]))
    h = Hammer(peer, a)
    what = list(h.lines)
    start, asked = time.monotonic(), 0
    while (passed := time.monotonic() - start) < a.seconds:
        if not a.rate or asked < passed * a.rate:
            h.ask(h.dice.choice(what))
            asked += 1
        else:
            time.sleep(0.002)
        h.take()
    last = time.monotonic() + rw.REPLY_S
    while h.open() and time.monotonic() < last:
        h.take()
        time.sleep(0.001)
    time.sleep(0.3)
    h.take()
    total = {k: sum(getattr(line, k) for line in h.lines.values()) for k in ("answered", "twice", "strange")}
    wrong = [w for line in h.lines.values() for w in line.wrong]
    show(**total, lost=h.open(), wrong=len(wrong), each={name: line.answered for name, line in h.lines.items()})
    if total["twice"] or total["strange"] or h.open() or wrong:
        raise Failure(f"{total}, not answered: {h.open()}, wrong: {wrong[:3]}")


class Burst:
    """Requests of one client to one service, written without waiting for any answer, once it has had one."""

    def __init__(self, peer, a, verb):
        self.client = rw.ServiceClient(peer.dp, f"{a.node}/{verb}", "lineshaft_msgs/AxesCommand", AxesRequest,
                                       Answer, own=rw.qos(depth=a.count)).wait()
        self.client.call(AxesRequest(a.axis))

    def ask(self, requests):
        return [self.client.send(request) for request in requests]

    def answers(self, asked):
        got = [self.client.receive(seq) for seq in asked]
        failed = [r.message for r in got if not r.success]
        if failed:
            raise Failure(f"{len(failed)} of {len(asked)} requests to {self.client.name}: {failed[0]}")


def burst(peer, a):
    """So many requests at once, of each kind; each must be done. Of goals for one axis the last one must count."""
    axes = [a.axis[i % len(a.axis)] for i in range(a.count)]
    requests = [AxesRequest([axis]) for axis in axes]
    verbs = {verb: Burst(peer, a, verb) for verb in ("disable", "halt", "reset_errors", "enable")}
    times = {}
    for verb in ("enable", "halt", "reset_errors"):
        start = time.monotonic()
        verbs[verb].answers(verbs[verb].ask(requests))
        times[verb] = time.monotonic() - start
    action = peer.action(a.node, "move_axis")
    goals = rw.ServiceClient(peer.dp, f"{a.node}/move_axis/_action/send_goal", "lineshaft_msgs/MoveAxis_SendGoal",
                             action.SendGoalRequest, rw.SendGoalResponse, kind="action", own=rw.qos(depth=a.count)).wait()
    goals.call(action.SendGoalRequest(rw.UUID.random(), MoveGoal(a.axis[0], RELATIVE)))
    ids = [rw.UUID.random() for _ in axes]
    start = time.monotonic()
    asked = [goals.send(action.SendGoalRequest(gid, MoveGoal(axis, RELATIVE, position=0.002)))
             for gid, axis in zip(ids, axes)]
    rejected = sum(not goals.receive(seq).accepted for seq in asked)
    last = {axis: action.get_result(gid).status for axis, gid in dict(zip(axes, ids)).items()}
    times["goals"] = time.monotonic() - start
    wrong = {axis: status for axis, status in last.items() if status != SUCCEEDED}
    # All axes move, with everything under way; the stops are asked for behind all else.
    for axis in a.axis:
        action.send_goal(MoveGoal(axis, VELOCITY, velocity=0.001))
    resets = verbs["reset_errors"].ask(requests)
    start = time.monotonic()
    verbs["halt"].answers(verbs["halt"].ask([AxesRequest(a.axis)]))
    times["one halt behind them"] = time.monotonic() - start
    verbs["reset_errors"].answers(resets)
    verbs["disable"].answers(verbs["disable"].ask(requests))
    show(requests=a.count, rejected=rejected, wrong=wrong, seconds=times)
    if rejected or wrong:
        raise Failure(f"{rejected} goals rejected; last goals that did not succeed: {wrong}")

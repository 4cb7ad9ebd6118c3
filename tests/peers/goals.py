"""Random goals: what an operator who cannot make up his mind would ask of a machine."""
import random
import time
from collections import Counter

from lineshaft_msgs import MOVE_MODES, AxesRequest, MoveGoal, SyncGoal
from report import Failure, show

ABSOLUTE, RELATIVE, VELOCITY = (MOVE_MODES.index(m) for m in ("absolute", "relative", "velocity"))


def random_goals(peer, a):
    """Sends goals, cancels, halts, couplings and other commands for a while; it does not wait for any end.

    The same seed asks for the same things; when they arrive is up to the wire.
    """
    dice, done = random.Random(a.seed), Counter()
    ranges = {name: tuple(map(float, span.split(":"))) for name, span in (axis.split("=") for axis in a.axis)}
    names = list(ranges)
    for service in ("enable", "halt", "disable", "quick_stop", "reset_errors"):
        peer.axes(a.node, service)
    moves, couplings = peer.action(a.node, "move_axis"), peer.action(a.node, "synchronize")
    peer.axes(a.node, "enable").call(AxesRequest(names))
    sent = []

    def move(axis):
        low, high = ranges[axis]
        span, mode = high - low, dice.choice((ABSOLUTE, ABSOLUTE, RELATIVE, VELOCITY))
        position = {ABSOLUTE: dice.uniform(low, high), RELATIVE: dice.uniform(-span, span) / 4}.get(mode, 0.0)
        velocity = dice.uniform(-span, span) / 4 if mode == VELOCITY else dice.choice((0.0, dice.uniform(0, span) / 2))
        gid, r = moves.send_goal(MoveGoal(axis, mode, position=position, velocity=velocity))
        sent.append((moves, gid))
        return "accepted" if r.accepted else "rejected"

    def couple(axis):
        if not a.master:
            return move(axis)
        goal = SyncGoal(axis=axis, master=a.master, mode=dice.randrange(2), numerator=dice.randint(-400, 400) or 1,
                        denominator=dice.randint(1, 400))
        gid, r = couplings.send_goal(goal)
        sent.append((couplings, gid))
        moves.send_goal(MoveGoal(a.master, VELOCITY, velocity=dice.uniform(-0.01, 0.01)))
        return "coupled" if r.accepted else "rejected"

    def cancel(_):
        client, gid = sent.pop(dice.randrange(len(sent)))
        client.cancel(gid)
        return "canceled"

    def switch(axis):
        verb = dice.choice(("halt", "disable", "quick_stop"))
        peer.axes(a.node, verb).call(AxesRequest([axis]))
        for service in ("reset_errors", "enable"):
            peer.axes(a.node, service).call(AxesRequest([axis]))
        return verb

    end = time.monotonic() + a.seconds
    while time.monotonic() < end:
        what = dice.choices((move, couple, cancel, switch), (12, 2, 3, 1))[0]
        if what is cancel and not sent:
            continue
        done[what(dice.choice(names))] += 1
        del sent[:-20]
        time.sleep(dice.uniform(0, 0.25))
    peer.axes(a.node, "halt").call(AxesRequest(names))
    show(sent=done.total(), **done)
    if not done["accepted"]:
        raise Failure("no goal was accepted")

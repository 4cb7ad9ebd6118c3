"""What the server of an action does for its clients in ROS 2 (rcl_action), held against ~/move_axis."""
import math
import time

import ros2wire as rw
from lineshaft_msgs import ACTIONS, MoveGoal
from report import Checklist

RELATIVE, SI = 1, 0
ABORTING, BUFFERED = 0, 1
ACCEPTED, UNKNOWN_GOAL, TERMINATED = 0, 2, 3
UNKNOWN, SUCCEEDED, CANCELED, ABORTED = 0, 4, 5, 6
KEPT_S = 10.0  # for which a result is kept after the end of its goal


def action_conformance(peer, a):
    """The axis must be enabled, and free for 200 distances upward."""
    Conformance(peer, a).run()


class Conformance:
    def __init__(self, peer, a):
        self.node, self.a = a.node, a
        self.c, self.checks = self.client(peer.dp), Checklist()

    def client(self, dp):
        return rw.ActionClient(dp, f"{self.node}/move_axis", *ACTIONS["move_axis"]).wait()

    def goal(self, times=1.0, **fields):
        return MoveGoal(**{"axis": self.a.axis, "mode": RELATIVE, "units": SI, "position": self.a.distance * times,
                           "velocity": self.a.velocity, **fields})

    def start(self, times=1.0, **fields):
        """A goal that is accepted, and when it was."""
        gid, r = self.c.send_goal(self.goal(times, **fields))
        self.checks.check("the goal is accepted", lambda: r.accepted, True)
        return gid, r.stamp

    def status(self, name, gid, want):
        """Of the result, at the first question or at any later one."""
        wanted = want if isinstance(want, tuple) else (want,)
        self.checks.check(name, lambda: self.c.get_result(gid, rw.REPLY_S).status, lambda s: s in wanted)

    def cancels(self, name, gid, want_code, want_goals=(), stamp=None):
        def codes():
            r = self.c.cancel(gid, stamp)
            return r.return_code, sorted(g.goal_id.hex() for g in r.goals_canceling)
        self.checks.check(name, codes, (want_code, sorted(g.hex() for g in want_goals)))

    def run(self):
        self.rejections()
        first, ended = self.one_goal()
        self.cancel_one()
        self.cancel_several()
        self.askers()
        self.another_order()
        self.late_joiner()
        self.expiry(first, ended)
        self.checks.close()

    def rejections(self):
        wrong = {
            "NaN as position": {"position": math.nan},
            "an infinite position": {"position": math.inf},
            "NaN as velocity": {"velocity": math.nan},
            "an unknown axis": {"axis": "no_such_axis"},
            "an empty axis name": {"axis": ""},
            "an unknown mode": {"mode": 200},
            "an unknown unit": {"units": 200},
            "an unknown buffer mode": {"buffer_mode": 200},
        }
        for name, fields in wrong.items():
            gid, r = self.c.send_goal(self.goal(**fields))
            self.checks.check(f"{name} is rejected", lambda r=r: r.accepted, False)
        self.status("get_result of a rejected goal is UNKNOWN", gid, UNKNOWN)
        self.status("get_result of a goal that nobody sent is UNKNOWN", rw.UUID.random(), UNKNOWN)

    def one_goal(self):
        gid, _ = self.start()
        self.checks.check("it ends SUCCEEDED", lambda: self.c.get_result(gid).status, SUCCEEDED)
        ended = time.monotonic()
        self.status("a second get_result is served from the cache", gid, SUCCEEDED)
        self.checks.check("the status topic tells the end too", lambda: self.c.finish(gid).status, SUCCEEDED)
        self.checks.check("feedback was seen", lambda: len(self.c.feedback(gid)), lambda n: n > 0)
        seen = [s[gid.hex()] for s in self.c.statuses() if gid.hex() in s]
        order = ["ACCEPTED", "EXECUTING", "SUCCEEDED"]
        self.checks.check("its status went forward and ends with SUCCEEDED", lambda: seen,
                          lambda s: s[-1:] == order[-1:] and [x for x in order if x in s] == list(dict.fromkeys(s)))
        self.checks.check("a goal id cannot be used twice", lambda: self.c.send_goal(self.goal(), gid)[1].accepted,
                          False)
        return gid, ended

    def cancel_one(self):
        gid, _ = self.start(100.0)
        time.sleep(0.1)
        self.cancels("a running goal is canceled", gid, ACCEPTED, [gid])
        self.checks.check("it ends CANCELED", lambda: self.c.get_result(gid).status, CANCELED)
        self.status("a second get_result says so too", gid, CANCELED)
        self.cancels("cancel of a finished goal says so", gid, TERMINATED)
        self.cancels("cancel of an unknown goal says so", rw.UUID.random(), UNKNOWN_GOAL)

    def cancel_several(self):
        """Three goals are open: the first moves, the others wait for it."""
        def three():
            return [self.start(40.0, buffer_mode=m) for m in (ABORTING, BUFFERED, BUFFERED)]

        def end(goals):
            for gid, _ in goals:
                self.status("it ends, because it or the goal before it was canceled", gid, (CANCELED, ABORTED))
        goals = three()
        (a, _), (b, stamp), (last, _) = goals
        self.cancels("cancel by time means the goals that were accepted by then", None, ACCEPTED, [a, b], stamp)
        self.status("the first ends CANCELED", a, CANCELED)
        self.status("the last one, which nobody canceled, ends ABORTED", last, ABORTED)
        end(goals)
        goals = three()
        (a, stamp), (b, _), (last, _) = goals
        self.cancels("cancel by id and time means that goal and the older ones", last, ACCEPTED, [a, last], stamp)
        self.status("the first ends CANCELED", a, CANCELED)
        end(goals)
        goals = three()
        self.cancels("cancel without id or time means all goals", None, ACCEPTED, [gid for gid, _ in goals])
        end(goals)
        self.cancels("without an open goal it is answered too, with none", None, ACCEPTED)

    def askers(self):
        gid, _ = self.start()
        b = self.client(rw.participant())
        sent = [(x, x.c_result.send(rw.GetResultRequest(gid))) for x in (self.c, b)]
        for i, (x, seq) in enumerate(sent):
            self.checks.check(f"asker {i + 1} of 2 gets the result", lambda: x.c_result.receive(seq).status, SUCCEEDED)

    def another_order(self):
        goals = [self.start(times, buffer_mode=BUFFERED)[0] for times in (1.0, -1.0, 1.0, -1.0)]
        last = goals[-1].hex()
        rw.wait_until(lambda: any(s.get(last) == "SUCCEEDED" for s in self.c.statuses()), rw.REPLY_S,
                      "the last of four goals does not end")
        for i in (2, 0, 3, 1):
            self.status(f"goal {i + 1} of four has its result after all have ended", goals[i], SUCCEEDED)

    def late_joiner(self):
        """All goals have ended, so a newer array is the current one without the goals whose results have expired. The same array may come
        twice: the participants of a process with Cyclone DDS share what they know of a writer."""
        current = dict(self.c.told)
        late = self.client(rw.participant())
        seen = []

        def arrived():
            seen.extend(late.statuses())
            return seen
        rw.wait_until(arrived, rw.REPLY_S, "a late joiner gets no status array")
        time.sleep(0.5)  # for older arrays, which must not come
        newest = list(current)[-1]
        self.checks.check("a late joiner gets no status array from before",
                          lambda: [s for s in arrived() if newest not in s or not s.items() <= current.items()], [])

    def expiry(self, gid, ended):
        if time.monotonic() < ended + KEPT_S - 1.0:  # on a slow machine it may be gone by now
            self.status("its result is kept", gid, SUCCEEDED)
        time.sleep(max(0.0, ended + KEPT_S + 0.2 - time.monotonic()))
        self.status("after its time the result is gone", gid, UNKNOWN)
        self.cancels("and the goal is not known", gid, UNKNOWN_GOAL)

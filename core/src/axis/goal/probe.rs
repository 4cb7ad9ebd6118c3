//! Touch probe with positioning: a goal that searches for a latch and ends at a distance from it (MC_TouchProbe, then a
//! move).
//!
//! Law      latched = position of the axis at the first latch after the start of the goal. target = latched + distance,
//!          rounded once to a whole increment and planned from the motion of that cycle with the limits of the goal
//! Reads    the latches of the cycle, its index pulse, the actual position
//! Refuses  at the latch: an end beyond a limit, or a path that cannot stop before one; the goal then fails and the
//!          axis stops. More than `homing.index_distance` without an index pulse is an error
//! Source   PLCopen part 1 (MC_TouchProbe), contract section 7; MACS-CMD-02, MACS-HOME-05 (INDEX)

use crate::axis::state::probe_search::Search;
use crate::axis::state::{Aim, Axis, Context, Failure};
use crate::code::Code;
use crate::command::{Probe, ProbeEdge};
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::object::Object;
use crate::position::Position;
use crate::profile::Limits;
use crate::vocabulary::LatchView;

/// Returns true if the latch is an edge of that source with that polarity.
pub(super) fn is_awaited(latch: &LatchView, source: Object, edge: ProbeEdge) -> bool {
    let is_edge = match edge {
        ProbeEdge::Rising => latch.rising,
        ProbeEdge::Falling => !latch.rising,
        ProbeEdge::Both => true,
        ProbeEdge::Index => false,
    };
    latch.object == source && is_edge
}

/// Returns the first matching latch of the cycle: the oldest.
pub(in crate::axis) fn first_latch(latches: &[LatchView], source: Object, edge: ProbeEdge) -> Option<&LatchView> {
    let awaited = latches.iter().filter(|latch| is_awaited(latch, source, edge));
    awaited.reduce(|first, next| if next.age_ns > first.age_ns { next } else { first })
}

impl Axis {
    /// Starts a move that searches.
    pub(in crate::axis) fn start_probe(
        &mut self,
        cx: &mut Context<'_>,
        sequence: u64,
        request: &Probe,
    ) -> Result<(), Refusal> {
        if request.edge == ProbeEdge::Index {
            // An absolute encoder has none (MACS-ENC-10).
            self.check_zero_moves()?;
        }
        self.start_move(cx, sequence, &request.search())?;
        let (limits, from) = (self.active_limits(), self.feedback.position());
        if let Some(goal) = self.task.goal_mut() {
            let (source, edge, distance) = (request.source, request.edge, request.distance.exact());
            goal.search = Some(Search { source, edge, distance, limits, from, is_over: false });
        }
        Ok(())
    }

    /// Whether the active goal searches, or has searched.
    pub(in crate::axis) fn probes(&self) -> bool {
        self.task.goal().as_ref().is_some_and(|goal| goal.search.is_some())
    }

    /// Whether the active goal still searches.
    pub(in crate::axis) fn searches(&self) -> bool {
        let search =
            self.task.goal().as_ref().filter(|goal| goal.ending.is_none()).and_then(|goal| goal.search.as_ref());
        search.is_some_and(Search::is_on)
    }

    /// Uses the latch for which the active goal searches: from now on the goal moves to its end. Called before the
    /// commands of the cycle, so that a goal never uses a latch that was there before it.
    pub(in crate::axis) fn use_latch(&mut self, cx: &mut Context<'_>) {
        if !self.searches() {
            return;
        }
        let Some((goal, search)) = self.task.goal().and_then(|goal| Some((goal, goal.search?))) else { return };
        let mark = match search.edge {
            ProbeEdge::Index => self.index_of_cycle().map(|place| (place, self.age_of(place), true)),
            _ => first_latch(cx.latches, search.source, search.edge)
                .map(|latch| (self.position_at(latch), latch.age_ns, latch.rising)),
        };
        let Some((latched, age_ns, rising)) = mark else { return self.miss_index(cx, &search) };
        let event = Event::new(Severity::Info, Kind::Mark, self.object(), Code::NONE).of_command(goal.sequence);
        let edge = Number::Count(i64::from(rising));
        cx.events.push(Event { age_ns, position: latched, ..event.with(edge, Number::None) });
        if let Some(search) = self.task.goal_mut().and_then(|goal| goal.search.as_mut()) {
            search.is_over = true;
        }
        if let Err(refusal) = self.turn_to(cx.cycle, latched + search.distance, search.limits) {
            self.fail_goal(cx, refusal, search.limits);
        }
    }

    /// Raises an error if the index pulse has not come within its distance, as in homing.
    fn miss_index(&mut self, cx: &mut Context<'_>, search: &Search) {
        let gone = (self.feedback.position() - search.from).nearest().saturating_abs();
        let most = self.parameters.homing_index_distance();
        if search.edge != ProbeEdge::Index || gone <= most {
            return;
        }
        let missed = Failure::of(Code::HOMING_INDEX_MISSED);
        self.raise(cx, missed.with(Number::Position(gone), Number::Position(most)));
    }

    /// Returns the time before this cycle at which the encoder was at `place` (ns), linear within the change of the
    /// cycle.
    pub(super) fn age_of(&self, place: Position) -> u32 {
        let change = self.feedback.change().to_f64();
        let share = if change == 0.0 { 0.0 } else { (self.feedback.position() - place).to_f64() / change };
        // The cast saturates; an age is below a cycle.
        ((share.clamp(0.0, 1.0) * self.setup.cycle_ns as f64) as u32).min(self.setup.cycle_ns.saturating_sub(1) as u32)
    }

    /// Returns the position of the axis at a latch: captured by its own device, otherwise linear within the change of
    /// this cycle.
    pub(in crate::axis) fn position_at(&self, latch: &LatchView) -> Position {
        if let Some(position) = latch.captured.filter(|_| latch.object == self.object()) {
            // In the coordinate before this cycle.
            return position + self.observed.moved();
        }
        let (now, change) = if self.is_virtual() {
            // Its actual position is the command of the cycle before until this cycle ends.
            (self.command.position(), self.command.position() - self.feedback.position())
        } else {
            (self.feedback.position(), self.feedback.change())
        };
        let share = f64::from(latch.age_ns) / self.setup.cycle_ns as f64;
        now - Position::from_f64(change.to_f64() * share)
    }

    /// Plans the active goal to `target` from the present motion.
    fn turn_to(&mut self, cycle: u64, target: Position, limits: Limits) -> Result<(), Refusal> {
        self.check_target(target, &self.parameters)?;
        // The superimposed motion continues as planned.
        let from = self.underlying();
        let course = self.course(cycle, from, Aim::Target(Position::whole(target.nearest())), limits);
        self.check_course(&course, from, limits)?;
        self.motion.plan(course);
        if let Some(goal) = self.task.goal_mut() {
            goal.target = Some(target);
        }
        self.check_overlay()
    }

    /// Ends the active goal and all related motions with a refusal: the axis stops.
    fn fail_goal(&mut self, cx: &mut Context<'_>, refusal: Refusal, limits: Limits) {
        if let Some(goal) = self.task.take_goal() {
            let event = Event::done(self.object(), goal.sequence, refusal.code, self.command.position());
            cx.events.push(event.with(refusal.asked, refusal.limit));
        }
        self.end_all_motion(cx, Code::NOT_REACHED);
        self.brake_to_rest(cx, &limits);
    }
}

//! Touch probe to position: a goal that searches for a mark and ends at a distance from it (MC_TouchProbe, then a move).
//!
//! Law      latched = position of the axis at the first latch after the goal began; target = latched + distance, rounded once
//!          to a whole increment and planned from the motion of that cycle with the limits of the goal
//! Reads    the latches of the cycle, its index pulse, the actual position
//! Refuses  at the latch: an end beyond a limit, a way that cannot stop before it; the goal fails then and the axis stops. More than
//!          `homing.index_distance` without an index pulse is an error
//! Source   PLCopen part 1 (MC_TouchProbe), contract section 7; MACS-CMD-02, MACS-HOME-05 (INDEX)

use super::course::Aim;
use super::reaction::Failure;
use super::{Axis, Context, Generator};
use crate::code::Code;
use crate::command::{Probe, ProbeEdge};
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::object::Object;
use crate::position::Position;
use crate::profile::{Limits, Shape};
use crate::vocabulary::Latched;
use serde::{Deserialize, Serialize};

/// What a goal searches for, and where it ends then.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Search {
    source: Object,
    edge: ProbeEdge,
    /// From the latched position.
    distance: Position,
    limits: Limits,
    /// Where it began.
    from: Position,
    /// The first latch has come.
    is_over: bool,
}

impl Search {
    /// Still without its latch?
    pub(super) fn is_on(&self) -> bool {
        !self.is_over
    }

    /// Limits that a profile can be made with?
    pub(super) fn is_sound(&self) -> bool {
        let Limits { velocity, acceleration, deceleration, shape } = self.limits;
        let jerks = match shape {
            Shape::Jerk(jerks) => [jerks.rise, jerks.fall, jerks.brake_rise, jerks.brake_fall],
            _ => [1.0; 4],
        };
        [velocity, acceleration, deceleration].into_iter().chain(jerks).all(|rate| rate > 0.0 && rate.is_finite())
    }
}

/// Returns true if the latch is an edge of that source that is waited for.
pub(super) fn is_awaited(latch: &Latched, source: Object, edge: ProbeEdge) -> bool {
    let is_edge = match edge {
        ProbeEdge::Rising => latch.rising,
        ProbeEdge::Falling => !latch.rising,
        ProbeEdge::Both => true,
        ProbeEdge::Index => false,
    };
    latch.object == source && is_edge
}

/// The first latch of the cycle that somebody waits for: the oldest.
pub(super) fn first_latch(latches: &[Latched], source: Object, edge: ProbeEdge) -> Option<&Latched> {
    let awaited = latches.iter().filter(|latch| is_awaited(latch, source, edge));
    awaited.reduce(|first, next| if next.age_ns > first.age_ns { next } else { first })
}

impl Axis {
    /// Starts a move that searches.
    pub(super) fn start_probe(&mut self, cx: &mut Context<'_>, sequence: u64, request: &Probe) -> Result<(), Refusal> {
        if request.edge == ProbeEdge::Index {
            // Of an absolute encoder there is none (MACS-ENC-10).
            self.check_zero_moves()?;
        }
        self.start_move(cx, sequence, &request.search())?;
        let (limits, from) = (self.active_limits(), self.actual.position);
        if let Some(goal) = &mut self.goal {
            let (source, edge, distance) = (request.source, request.edge, request.distance.exact());
            goal.search = Some(Search { source, edge, distance, limits, from, is_over: false });
        }
        Ok(())
    }

    /// Does the active goal search, or has it searched?
    pub(super) fn probes(&self) -> bool {
        self.goal.as_ref().is_some_and(|goal| goal.search.is_some())
    }

    /// Does the active goal still search?
    pub(super) fn searches(&self) -> bool {
        let search = self.goal.as_ref().filter(|goal| goal.ending.is_none()).and_then(|goal| goal.search.as_ref());
        search.is_some_and(Search::is_on)
    }

    /// Takes the latch that the active goal searches for: from now on it goes to its end. Before the commands of the cycle,
    /// so that a goal never takes a latch that was there before it.
    pub(super) fn take_mark(&mut self, cx: &mut Context<'_>) {
        if !self.searches() {
            return;
        }
        let Some((goal, search)) = self.goal.and_then(|goal| Some((goal, goal.search?))) else { return };
        let mark = match search.edge {
            ProbeEdge::Index => self.index_of_cycle().map(|place| (place, self.age_of(place), true)),
            _ => first_latch(cx.latches, search.source, search.edge)
                .map(|latch| (self.position_at(latch), latch.age_ns, latch.rising)),
        };
        let Some((latched, age_ns, rising)) = mark else { return self.miss_index(cx, &search) };
        let event = Event::new(Severity::Info, Kind::Mark, self.object(), Code::NONE).of_command(goal.sequence);
        let edge = Number::Count(i64::from(rising));
        cx.events.push(Event { age_ns, position: latched, ..event.with(edge, Number::None) });
        if let Some(search) = self.goal.as_mut().and_then(|goal| goal.search.as_mut()) {
            search.is_over = true;
        }
        if let Err(refusal) = self.turn_to(cx.cycle, latched + search.distance, search.limits) {
            self.fail_goal(cx, refusal, search.limits);
        }
    }

    /// An index that has not come within its way is an error, as in homing.
    fn miss_index(&mut self, cx: &mut Context<'_>, search: &Search) {
        let gone = (self.actual.position - search.from).nearest().saturating_abs();
        let most = self.parameters.homing_index_distance();
        if search.edge != ProbeEdge::Index || gone <= most {
            return;
        }
        let missed = Failure::of(Code::HOMING_INDEX_MISSED);
        self.raise(cx, missed.with(Number::Position(gone), Number::Position(most)));
    }

    /// How long before this cycle its encoder was there (ns), on the straight line of the change of the cycle.
    pub(super) fn age_of(&self, place: Position) -> u32 {
        let change = self.actual.change.to_f64();
        let share = if change == 0.0 { 0.0 } else { (self.actual.position - place).to_f64() / change };
        // The cast saturates; an age is below a cycle.
        ((share.clamp(0.0, 1.0) * self.setup.cycle_ns as f64) as u32).min(self.setup.cycle_ns.saturating_sub(1) as u32)
    }

    /// Where the axis was when something latched: as its own device caught it, else on the straight line of this cycle's change.
    pub(super) fn position_at(&self, latch: &Latched) -> Position {
        if let Some(position) = latch.captured.filter(|_| latch.object == self.object()) {
            // In the coordinate from before this cycle.
            return position + self.moved;
        }
        let (now, change) = if self.is_virtual() {
            // Its actual position is the command of the cycle before until this one ends.
            (self.command.position, self.command.position - self.actual.position)
        } else {
            (self.actual.position, self.actual.change)
        };
        let share = f64::from(latch.age_ns) / self.setup.cycle_ns as f64;
        now - Position::from_f64(change.to_f64() * share)
    }

    /// The active goal ends at `target` from now on, with a plan from the present motion.
    fn turn_to(&mut self, cycle: u64, target: Position, limits: Limits) -> Result<(), Refusal> {
        self.check_target(target, &self.parameters)?;
        // What is superimposed goes on as it was planned.
        let from = self.underlying();
        let course = self.course(cycle, from, Aim::Target(Position::whole(target.nearest())), limits);
        self.check_course(&course, from, limits)?;
        self.generator = Generator::Plan(course);
        if let Some(goal) = &mut self.goal {
            goal.target = Some(target);
        }
        self.check_overlay()
    }

    /// Ends the active goal, and all that goes with it, by a refusal: the axis stops.
    fn fail_goal(&mut self, cx: &mut Context<'_>, refusal: Refusal, limits: Limits) {
        if let Some(goal) = self.goal.take() {
            let event = Event::done(self.object(), goal.sequence, refusal.code, self.command.position);
            cx.events.push(event.with(refusal.asked, refusal.limit));
        }
        self.abandon(cx, Code::NOT_REACHED);
        self.brake_to_rest(cx, &limits);
    }
}

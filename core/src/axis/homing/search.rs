//! Executes the legs of homing until the reference is found.

use crate::axis::state::homing::Run;
use crate::axis::state::homing::methods::{Until, is_travel};
use crate::axis::state::homing::search::Search;
use crate::axis::state::{Aim, Axis, Context, Leg, Stage, Switch};
use crate::code::Code;
use crate::event::Number;
use crate::object::Object;
use crate::position::Position;
use crate::profile::Limits;

impl Axis {
    /// Begins the present leg. If its switch is already active at the start of homing, the leg is skipped.
    pub(in crate::axis) fn begin_leg(&mut self, cx: &mut Context<'_>) {
        let Some((mut run, mut search)) = self.searching() else { return };
        Self::begin_leg_of_both(cx);
        if let Some(Leg { until: Until::On(switch), .. }) = search.leg(run.method)
            && search.leg == 0
            && self.is_actuated(*switch)
        {
            search.leg = 1;
        }
        let Some(leg) = search.leg(run.method) else { return };
        // The axis is on the limit switch that would reverse it.
        search.turned = search.leg == 0 && leg.turns && self.meets_limit(leg, direction_of_leg(&run, leg, false));
        search.from = self.feedback.position();
        search.was_on = self.watched(leg).is_some_and(|switch| self.is_actuated(switch));
        run.stage = Stage::Search(search);
        self.homing.continue_run(run);
        self.move_along_leg(cx, &run, leg, search.turned, run.limits);
    }

    fn searching(&self) -> Option<(Run, Search)> {
        let run = self.homing.run()?;
        match run.stage {
            Stage::Search(search) => Some((run, search)),
            _ => None,
        }
    }

    /// Returns the signed velocity of the active leg (inc/s); 0 without search.
    pub(in crate::axis) fn search_speed(&self) -> f64 {
        let Some((run, search)) = self.searching() else { return 0.0 };
        search.leg(run.method).map_or(0.0, |leg| run.speed(leg) * f64::from(direction_of_leg(&run, leg, search.turned)))
    }

    /// Moves from the present motion in the direction of a leg.
    fn move_along_leg(&mut self, cx: &mut Context<'_>, run: &Run, leg: &Leg, turned: bool, limits: Limits) {
        let velocity = run.speed(leg);
        let signed = velocity * f64::from(direction_of_leg(run, leg, turned));
        if self.is_open_loop() {
            self.motion.run_open(signed);
            self.command.run_at(signed);
            return;
        }
        let aim = Aim::velocity(signed);
        let course = self.course(cx.cycle, self.present_motion(), aim, Limits { velocity, ..limits });
        self.motion.plan(course);
    }

    /// Checks whether the active leg has reached its end, or an error.
    pub(in crate::axis) fn search(&mut self, cx: &mut Context<'_>) {
        let Some((mut run, mut search)) = self.searching() else { return };
        let Some(leg) = search.leg(run.method) else { return };
        let way = direction_of_leg(&run, leg, search.turned);
        // While the axis still reverses, edges belong to the leg before.
        let goes = self.command.velocity() * f64::from(way) > 0.0;
        let change = along(self.feedback.change(), way);
        // An edge that the encoder passes against the direction of the leg does count: an axis at rest next to an edge
        // may jitter across it, and there would be no other edge.
        let trembles = change < Position::ZERO && self.gantry().is_none();
        // An edge of two drives is often that of the second one, which the encoder of the first one does not show.
        let passes = goes && !trembles || change > Position::ZERO && self.gantry().is_none();
        let is_on = self.watched(leg).is_some_and(|switch| self.is_actuated(switch));
        let was_on = std::mem::replace(&mut search.was_on, is_on);
        run.stage = Stage::Search(search);
        self.homing.continue_run(run);
        if let Some((gone, most)) =
            self.distance_with_one_switch(cx).filter(|_| self.watched(leg) == Some(Switch::Home))
        {
            return self.fail_homing(cx, Code::NOT_SQUARE, Number::Position(gone), Number::Position(most));
        }
        if matches!(leg.until, Until::On(Switch::Home)) && !is_on && self.has_passed_switch(cx) {
            return self.fail_homing(cx, Code::NOT_SQUARE, Number::None, Number::None);
        }
        if passes {
            match leg.until {
                Until::On(switch) if !was_on && is_on => return self.pass_edge(cx, switch, true),
                Until::Off(switch) if was_on && !is_on => return self.pass_edge(cx, switch, false),
                Until::Index if goes => {
                    if let Some(place) = self.index_ahead(&search, way) {
                        return self.find(cx, place);
                    }
                }
                _ => {}
            }
        }
        if goes && self.meets_limit(leg, way) {
            if leg.turns && !search.turned {
                search.turned = true;
                search.from = self.feedback.position();
                run.stage = Stage::Search(search);
                self.homing.continue_run(run);
                // There is little distance after a limit switch.
                let limits = Limits { deceleration: self.parameters.deceleration_limit(), ..run.limits };
                return self.move_along_leg(cx, &run, leg, true, limits);
            }
            return self.fail_homing(cx, Code::HOMING_AT_LIMIT, Number::None, Number::None);
        }
        self.check_distance(cx, run.method, leg, &search);
    }

    /// Raises an error if a leg exceeds its longest distance.
    fn check_distance(&mut self, cx: &mut Context<'_>, method: i64, leg: &Leg, search: &Search) {
        let gone = (self.feedback.position() - search.from).nearest().saturating_abs();
        let (most, code) = match leg.until {
            Until::Index => (Some(self.longest_to_index()), missed_index(method)),
            _ => (self.longest_search(), Code::HOMING_SWITCH_MISSED),
        };
        if let Some(most) = most.filter(|most| gone > *most) {
            self.fail_homing(cx, code, Number::Position(gone), Number::Position(most));
        }
    }

    /// Returns the longest travel of a search for a switch (inc): as given, or twice the modulo. None: unknown.
    pub(super) fn longest_search(&self) -> Option<i64> {
        let turns = || self.setup.modulo.map(|modulo| modulo.length().saturating_mul(2));
        self.parameters.homing_max_distance().or_else(turns)
    }

    /// Handles the edge of a leg: the next leg begins, or the edge is the reference.
    fn pass_edge(&mut self, cx: &mut Context<'_>, switch: Switch, rising: bool) {
        let Some((mut run, search)) = self.searching() else { return };
        let mut place = self.edge_position(cx, switch, rising);
        let next = Search { leg: search.leg.saturating_add(1), turned: false, ..search };
        if next.leg(run.method).is_none_or(|leg| leg.until == Until::Index) {
            match self.square(cx) {
                Ok(edge) => place = edge.unwrap_or(place),
                Err((way, most)) => {
                    return self.fail_homing(cx, Code::NOT_SQUARE, way, most);
                }
            }
        }
        if next.leg(run.method).is_none() {
            return self.find(cx, place);
        }
        run.stage = Stage::Search(next);
        self.homing.continue_run(run);
        self.begin_leg(cx);
        // A pulse of the same cycle counts if the sample shows that it is beyond the edge.
        if let Some((run, search)) = self.searching()
            && let Some(leg @ Leg { until: Until::Index, .. }) = search.leg(run.method)
            && let Some(index) = self.index_ahead(&search, direction_of_leg(&run, leg, false))
        {
            self.find(cx, index);
        }
    }

    /// Returns the outermost position at which the switch is active, as far as it is known.
    fn edge_position(&self, cx: &Context<'_>, switch: Switch, rising: bool) -> Position {
        if let Some(place) = self.latched_edge(cx, switch, rising) {
            return place;
        }
        if rising { self.feedback.position() } else { self.feedback.position() - self.feedback.change() }
    }

    /// Returns the position at which the input of a switch latched in this cycle: the first edge with that level.
    fn latched_edge(&self, cx: &Context<'_>, switch: Switch, rising: bool) -> Option<Position> {
        let assigned = &self.parameters.assigned;
        let number = match switch {
            Switch::Home if self.asks_for_cam() => 0,
            Switch::Home => assigned.refswitch,
            Switch::Positive => assigned.poslimitsw,
            Switch::Negative => assigned.neglimitsw,
        };
        let place = usize::try_from(number.unsigned_abs().checked_sub(1)?).ok()?;
        let object = Object::Io(*cx.digital_inputs.get(place)?);
        let wanted = rising != (number < 0);
        let of_switch = cx.latches.iter().filter(|latch| latch.object == object && latch.rising == wanted);
        let oldest = of_switch.max_by_key(|latch| latch.age_ns)?;
        Some(Position::whole(self.position_at(oldest).nearest()))
    }

    /// Returns the index pulse of this cycle if it is in the direction of the leg and not too far.
    fn index_ahead(&self, search: &Search, way: i8) -> Option<Position> {
        let place = self.index_of_cycle()?;
        let gone = along(place - search.from, way).nearest();
        let most = self.longest_to_index();
        (0..=most).contains(&gone).then_some(place)
    }

    /// Returns the longest travel to an index pulse (inc). In reference travel MD34 gives the length of a revolution,
    /// if set.
    fn longest_to_index(&self) -> i64 {
        let p = &self.parameters;
        let is_travel = self.homing.run().is_some_and(|run| is_travel(run.method));
        let revolution =
            (is_travel && p.encoder.pulses_or_step > 0).then(|| p.encoder.pulses_or_step.saturating_mul(4));
        p.homing.index_distance.or(revolution).unwrap_or_else(|| p.homing_index_distance())
    }

    /// Ends the search with the reference.
    pub(in crate::axis) fn find(&mut self, cx: &mut Context<'_>, place: Position) {
        let Some(mut run) = self.homing.run() else { return };
        let zero = place + Position::whole(run.offset);
        if !zero.is_legal() {
            let asked = Number::Position(zero.nearest());
            return self.fail_homing(cx, Code::POSITION_OUT_OF_RANGE, asked, Number::None);
        }
        let target = run.goes.map(|way| place + Position::whole(way));
        if let Some(beyond) = target.filter(|target| !target.is_legal()) {
            let asked = Number::Position(beyond.nearest());
            return self.fail_homing(cx, Code::POSITION_OUT_OF_RANGE, asked, Number::None);
        }
        run.stage = Stage::Found { zero, goes: target.is_some() };
        self.homing.continue_run(run);
        if self.is_open_loop() {
            return self.switch_speed_off(cx);
        }
        let aim = target.map_or(Aim::Stop, Aim::Target);
        let course = self.course(cx.cycle, self.present_motion(), aim, run.limits);
        self.motion.plan(course);
    }

    /// Whether the axis moves into a limit switch that is not the switch of the leg.
    fn meets_limit(&self, leg: &Leg, way: i8) -> bool {
        let ahead = self.switch_at_end(way);
        self.watched(leg) != Some(ahead) && self.is_actuated(ahead)
    }

    /// Returns the limit switch at the end of a direction in the coordinate of the axis.
    fn switch_at_end(&self, way: i8) -> Switch {
        let rises = (way > 0) != self.direction().units;
        if rises { Switch::Positive } else { Switch::Negative }
    }

    /// Ends homing with an error if a limit switch becomes active on the way from the reference to the zero.
    pub(super) fn supervise_return(&mut self, cx: &mut Context<'_>) {
        let velocity = self.command.velocity();
        let way = if velocity < 0.0 { -1 } else { 1 };
        if velocity != 0.0 && self.is_actuated(self.switch_at_end(way)) {
            self.fail_homing(cx, Code::HOMING_AT_LIMIT, Number::None, Number::None);
        }
    }

    fn watched(&self, leg: &Leg) -> Option<Switch> {
        match leg.until {
            Until::On(switch) | Until::Off(switch) => Some(switch),
            Until::Index => None,
        }
    }

    /// Whether the cam of the active reference travel comes from the commands of the vocabulary (MD15).
    fn asks_for_cam(&self) -> bool {
        self.parameters.homing.cam_source == 0 && self.homing.run().is_some_and(|run| is_travel(run.method))
    }

    fn is_actuated(&self, switch: Switch) -> bool {
        match switch {
            Switch::Home if self.asks_for_cam() => self.vocabularies.cam(),
            Switch::Home => self.observed.switches().home,
            Switch::Positive => self.observed.switches().positive,
            Switch::Negative => self.observed.switches().negative,
        }
    }
}

/// Returns the error for a missing index pulse.
fn missed_index(method: i64) -> Code {
    if is_travel(method) { Code::WF_NO_ZERO_MARK } else { Code::HOMING_INDEX_MISSED }
}

/// Returns the direction of a leg in the coordinate of the axis.
fn direction_of_leg(run: &Run, leg: &Leg, turned: bool) -> i8 {
    let way = leg.way * run.sense;
    if turned { -way } else { way }
}

/// Returns a distance in a direction.
fn along(distance: Position, way: i8) -> Position {
    if way < 0 { -distance } else { distance }
}

//! Steps of the vocabularies on an axis, their view of it, and the checks of their parameters.

use crate::axis::state::{Aim, Axis, Context, Generator, Power};
use crate::event::{Event, Kind, Refusal, Severity};
use crate::parameter::{AxisParameters, ROWS};
use crate::position::Position;
use crate::profile::Limits;
use crate::regulator::Law;
use crate::signal::Board;
use crate::signal::axis::AxisSignal;
use crate::state::AxisState;
use crate::sync::Leads;
use crate::table::Table;
use crate::vocabulary::{LatchView, Order, Owner, ParameterChange, Problem, View, Vocabulary, check};
use std::sync::Arc;

impl Axis {
    pub(super) fn view<'a>(&'a self, cycle: u64, owner: Owner, leads: &'a Leads, latches: &'a [LatchView]) -> View<'a> {
        let p = &self.parameters;
        let position = self.command.position().floor();
        View {
            object: self.object(),
            cycle,
            cycle_ns: self.setup.cycle_ns,
            owns: self.status.owner() == owner,
            owned: self.alarm.has_lost(cycle, owner),
            free: self.check_ready().is_ok(),
            // False until its brake is open, and again while it closes.
            on: matches!(self.status.power(), Power::On | Power::SwitchingOff),
            closing: matches!(self.status.power(), Power::Closing { .. }),
            locked: self.is_locked(),
            in_error: self.status.state() == AxisState::ErrorStop,
            error: self.alarm.code(),
            contact: self.alarm.open_contact(),
            homing: self.homing.is_running(),
            search_speed: self.search_speed(),
            homed: self.is_referenced(),
            command: self.command.motion(),
            present: self.present_motion(),
            rests: self.rests(),
            idle: self.is_idle_at_rest(),
            has_end: self.course_end().is_some(),
            target: match self.motion.generator() {
                Generator::Follow(coupling) => coupling.follower.target(),
                _ => self.course_end().unwrap_or(self.command.position()),
            },
            actual: self.feedback.lead(),
            following_error: self.supervision.following_error(),
            at_limit: p.max_position.is_some_and(|limit| position >= limit)
                || p.min_position.is_some_and(|limit| position <= limit),
            modulo: self.setup.modulo,
            unit: self.setup.unit,
            interface: self.setup.drive.map(|_| self.setup.interface),
            closes_loop: self.closes_loop_here() && self.setup.law == Law::Integer,
            wiring: self.setup.vocabularies,
            parameters: p,
            leads,
            latches,
            index: self.index_of_cycle(),
        }
    }

    /// Whether an error or a quick stop locks it, or a contact is open while it is on.
    fn is_locked(&self) -> bool {
        matches!(self.status.state(), AxisState::ErrorStop | AxisState::Stopping)
            || self.status.power() == Power::On && !self.alarm.open_contact().is_none()
    }

    /// Steps each vocabulary that has been used, in their order.
    pub(in crate::axis) fn step_vocabularies(&mut self, cx: &mut Context<'_>) {
        for owner in Owner::VOCABULARIES {
            if self.vocabularies.is_step_due(owner, &self.parameters)
                && let Some(mut tried) = self.vocabularies.copy(owner)
            {
                self.step_vocabulary(cx, owner, &mut tried);
                self.vocabularies.keep(&tried);
            }
        }
    }

    fn step_vocabulary(&mut self, cx: &mut Context<'_>, owner: Owner, tried: &mut Vocabulary) {
        let asked = tried.step(&self.view(cx.cycle, owner, cx.leads, cx.latches));
        if let Some(problem) = asked.problem {
            let event = Event::new(Severity::Warn, Kind::Warning, self.object(), problem.code);
            cx.events.push(Event { parameter: Some(problem.row), ..event.with(problem.asked, problem.limit) });
        }
        // Only a vocabulary that selects by itself returns to its state before.
        let before = asked.writes.and_then(|_| self.vocabularies.copy(owner));
        let mut writes = asked.writes;
        if let Some(refusal) = self.try_order(cx, owner, asked.order) {
            let view = self.view(cx.cycle, owner, cx.leads, cx.latches);
            let (then, order) = tried.order_failed(before.as_ref(), &asked, &view, refusal);
            self.try_order(cx, owner, order);
            writes = then;
        }
        if let Some(writes) = writes {
            // The target as set by the order.
            tried.follow(&self.view(cx.cycle, owner, cx.leads, cx.latches));
            if self.status.owner() == owner {
                self.status.refer_to(writes.reference);
            }
            self.write_selection(cx, writes);
        }
    }

    /// Shows the new state of a vocabulary in the very cycle in which its homing ends, or the axis is locked.
    pub(in crate::axis) fn settle_vocabularies(&mut self, cx: &mut Context<'_>) {
        if !self.vocabularies.needs_cycle_end() {
            return;
        }
        if self.is_locked() {
            let writes = self.vocabularies.deselect();
            return self.write_selection(cx, writes);
        }
        if self.homing.is_running() || self.status.state() != AxisState::Standstill {
            return;
        }
        let owner = self.status.owner();
        let Some(mut tried) = self.vocabularies.homing_owner(owner) else { return };
        let (order, writes) = tried.end_homing(&self.view(cx.cycle, owner, cx.leads, cx.latches));
        self.try_order(cx, owner, order);
        self.vocabularies.keep(&tried);
        if let Some(writes) = writes {
            self.write_selection(cx, writes);
        }
    }

    /// Writes the selection of a vocabulary, which is a parameter, and reports a change.
    fn write_selection(&mut self, cx: &mut Context<'_>, writes: ParameterChange) {
        let is_new = ROWS.get(usize::from(writes.row)).is_some_and(|row| row.value(&self.parameters) != writes.value);
        if is_new {
            self.write_own(cx, None, [(writes.row, writes.value)].into_iter());
        }
    }

    /// Checks whether the vocabularies may have these parameters, as far as this is known before the cycle.
    ///
    /// # Errors
    /// The reason why not.
    pub fn admits_vocabularies(
        &self,
        candidate: &AxisParameters,
        cycle: u64,
        (leads, tables): (&Leads, &[Arc<Table>]),
    ) -> Result<(), Refusal> {
        let refuse = |problem: Problem| problem.refusal(self.object());
        check(candidate, &self.setup.setting()).map_err(refuse)?;
        let (now, then) = (&self.parameters.vocabularies, &candidate.vocabularies);
        if then.commands_as(now) {
            return Ok(());
        }
        let (owner, before) = self.vocabularies.by_parameters();
        let view = View { parameters: candidate, ..self.view(cycle, owner, leads, &[]) };
        if view.locked && then.selects(now) {
            return self.check_free();
        }
        let mut tried = before;
        let asked = tried.step(&view);
        if let Some(problem) = asked.problem {
            return Err(refuse(problem));
        }
        match asked.order {
            Some(Order::Home) => self.check_configured_homing(cycle, candidate, false),
            Some(_) if tried.waits() => self.check_configured_homing(cycle, candidate, true),
            Some(Order::Position { target, .. }) if tried.keeps_speed(&before) => {
                self.check_selectable(owner)?;
                self.check_target(target, candidate)
            }
            Some(Order::Position { target, limits, .. }) => {
                self.check_selectable(owner)?;
                self.check_target(target, candidate)?;
                self.check_selected_way(cycle, Aim::Target(Position::whole(target.nearest())), limits)
            }
            // A velocity that remains selected is limited, not refused (AMC-SEL-09).
            Some(Order::Velocity { .. }) if tried.keeps_speed(&before) => self.check_selectable(owner),
            Some(Order::Velocity { velocity, limits }) => {
                self.check_selectable(owner)?;
                self.check_selected_way(cycle, Aim::velocity(velocity), limits)
            }
            Some(order @ (Order::Gear { .. } | Order::Cam { .. })) => {
                self.check_selectable(owner)?;
                self.coupling_to_master(leads, tables, (candidate, order)).map(|_| ())
            }
            _ => Ok(()),
        }
    }

    /// Checks whether a selected reference may move this way. Its target and the software limits are checked
    /// separately.
    fn check_selected_way(&self, cycle: u64, aim: Aim, limits: Limits) -> Result<(), Refusal> {
        let course = self.course(cycle, self.present_motion(), aim, limits);
        self.check_course_forward(&course, self.present_motion())?;
        match aim {
            Aim::Velocity(velocity) => self.check_velocity_switches(velocity),
            _ => self.check_course_switches(&course, self.present_motion()),
        }
    }

    /// Checks whether the selector may move the axis. It may during its own homing, which any other reference ends.
    fn check_selectable(&self, owner: Owner) -> Result<(), Refusal> {
        if self.homes_for(owner) { self.check_zero() } else { self.check_free() }
    }

    /// Whether the active homing belongs to this vocabulary.
    pub(super) fn homes_for(&self, owner: Owner) -> bool {
        self.status.owner() == owner && self.homing.is_running()
    }

    /// Executes an order for which no command waits, and reports a refusal of the axis.
    fn try_order(&mut self, cx: &mut Context<'_>, owner: Owner, order: Option<Order>) -> Option<Refusal> {
        let refusal = self.execute(cx, owner, order?).err()?;
        self.warn_of(cx, refusal);
        Some(refusal)
    }

    pub(in crate::axis) fn warn_of(&self, cx: &mut Context<'_>, refusal: Refusal) {
        let event = Event::new(Severity::Warn, Kind::Warning, self.object(), refusal.code);
        cx.events.push(Event { position: self.command.position(), ..event.with(refusal.asked, refusal.limit) });
    }

    /// Writes the signals of the vocabularies, in the order of the directory, after those of the axis.
    pub(in crate::axis) fn publish_vocabularies(&mut self, board: &mut Board, leads: &Leads) {
        let Some(shown) = self.vocabularies.begin_publishing() else { return };
        let view = self.view(0, Owner::VOCABULARIES[0], leads, &[]);
        let first = self.cycle.signals().plus(AxisSignal::COUNT);
        self.vocabularies.publish(shown, self.status.owner(), &view, |asked| self.allowed(asked), first, board);
    }
}

//! The vocabularies on an axis: their verbs and steps, and what their orders do.

mod saia;

use super::course::{Aim, Course};
use super::power::Power;
use super::reaction::Failure;
use super::{Axis, AxisState, Context, Generator, Reference};
use crate::code::Code;
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::parameter::{AxisParameters, Row};
use crate::position::Position;
use crate::profile::{Limits, Motion};
use crate::signal::Board;
use crate::signal::axis::AxisSignal;
use crate::sync::follower::{Bounds, Follower};
use crate::sync::gear::{Gear, Ratio};
use crate::sync::{Disengage, Leads, SyncMode};
use crate::vocabulary::amc::{self, Amc, AmcSignal};
use crate::vocabulary::saia::SaiaSignal;
use crate::vocabulary::wf::{self, WfSignal};
use crate::vocabulary::{Latched, Order, Owner, View};
use serde::{Deserialize, Serialize};

/// Which vocabularies have been asked for anything: the others take no time, and their signals stand as they began.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Awake {
    amc: bool,
    saia: bool,
    wf: bool,
    /// The signals have been written once.
    shown: bool,
}

impl Awake {
    /// Has any of them been?
    pub(super) fn is_any(self) -> bool {
        self.amc || self.saia || self.wf
    }
}

impl Axis {
    fn view<'a>(&'a self, cycle: u64, owner: Owner, leads: &'a Leads, latches: &'a [Latched]) -> View<'a> {
        let p = &self.parameters;
        let position = self.command.position.floor();
        View {
            object: self.object(),
            cycle,
            cycle_ns: self.setup.cycle_ns,
            owns: self.owner == owner,
            owned: self.lost == Some((cycle, owner)),
            free: self.check_ready().is_ok(),
            // Not before its brake is open, and no more once that closes.
            on: matches!(self.power, Power::On | Power::SwitchingOff),
            closing: matches!(self.power, Power::Closing { .. }),
            locked: self.is_locked(),
            in_error: self.state == AxisState::ErrorStop,
            error: self.error,
            contact: self.open_contact,
            homing: self.homing.is_running(),
            search_speed: self.search_speed(),
            homed: self.knows_zero(),
            command: self.command,
            present: self.present(),
            rests: self.rests(),
            idle: self.stands_idle(),
            has_end: self.course_end().is_some(),
            target: match &self.generator {
                Generator::Follow(follower) => follower.target(),
                _ => self.course_end().unwrap_or(self.command.position),
            },
            actual: self.actual,
            following_error: self.judge.following_error,
            at_limit: p.max_position.is_some_and(|limit| position >= limit)
                || p.min_position.is_some_and(|limit| position <= limit),
            modulo: self.setup.modulo,
            unit: self.setup.unit,
            interface: self.setup.drive.map(|_| self.setup.interface),
            selector: self.setup.amc,
            parameters: p,
            leads,
            latches,
            index: self.index_of_cycle(),
        }
    }

    /// An error or a quick stop holds it, or an open contact while it is on.
    fn is_locked(&self) -> bool {
        matches!(self.state, AxisState::ErrorStop | AxisState::Stopping)
            || self.power == Power::On && !self.open_contact.is_none()
    }

    pub(super) fn run_wf(&mut self, cx: &mut Context<'_>, sequence: u64, request: &wf::Request) -> Result<(), Refusal> {
        self.awake.wf = true;
        let mut wf = self.wf;
        let asked = wf.run(request, &self.view(cx.cycle, Owner::Wf, cx.leads, cx.latches));
        let done = asked.and_then(|order| order.map_or(Ok(()), |order| self.obey(cx, Owner::Wf, order)));
        if let Err(refusal) = done {
            // What cannot begin keeps nothing running that was let go (WF-SET-02).
            wf = self.wf;
            let Some(stop) = wf.release(request, &self.view(cx.cycle, Owner::Wf, cx.leads, cx.latches)) else {
                return Err(refusal);
            };
            self.obey(cx, Owner::Wf, stop)?;
            self.warn_of(cx, refusal);
        }
        self.wf = wf;
        self.accepted(cx, sequence);
        Ok(())
    }

    /// An alarm of the positioning modules that supervision has raised.
    pub(super) fn note_alarm(&mut self, alarm: u8) {
        self.awake.wf = true;
        self.wf.note_alarm(alarm);
    }

    /// The axis has a new zero by another word than those of the positioning modules: they show it.
    pub(super) fn note_zero(&mut self) {
        self.awake.wf = true;
        self.wf.take_zero();
    }

    /// The step of each vocabulary that has been used, in their order.
    pub(super) fn step_vocabularies(&mut self, cx: &mut Context<'_>) {
        self.awake.amc |= self.amc.wakes(&self.parameters.vocabularies.amc);
        if self.awake.amc {
            let mut amc = self.amc;
            self.step_selector(cx, &mut amc);
            self.amc = amc;
        }
        if self.awake.saia {
            let mut saia = self.saia;
            let order = saia.step(&self.view(cx.cycle, Owner::Saia, cx.leads, cx.latches));
            if let Some(refusal) = self.try_order(cx, Owner::Saia, order) {
                saia.order_failed(refusal);
            }
            self.saia = saia;
        }
        self.awake.wf |= self.wf.wakes(&self.parameters.vocabularies.wf);
        if self.awake.wf {
            let mut wf = self.wf;
            let order = wf.step(&self.view(cx.cycle, Owner::Wf, cx.leads, cx.latches));
            if let Some(refusal) = self.try_order(cx, Owner::Wf, order) {
                wf.order_failed(refusal);
            }
            self.wf = wf;
        }
    }

    /// The step of the reference selector, which may change a parameter of its own.
    fn step_selector(&mut self, cx: &mut Context<'_>, amc: &mut Amc) {
        let before = *amc;
        let step = amc.step(&self.view(cx.cycle, Owner::Amc, cx.leads, cx.latches));
        if let Some(problem) = step.problem {
            let event = Event::new(Severity::Warn, Kind::Warning, self.object(), problem.code);
            let parameter = Row::find(problem.key).map(|(row, _)| row);
            cx.events.push(Event { parameter, ..event.with(problem.asked, problem.limit) });
        }
        let failed = self.try_order(cx, Owner::Amc, step.order);
        let select = match step.order {
            Some(Order::Home) if failed.is_some() && before.waits() => amc.give_up(),
            _ => match failed {
                Some(refusal) => {
                    let view = self.view(cx.cycle, Owner::Amc, cx.leads, cx.latches);
                    let (select, stop) = amc.order_failed(&before, &view, refusal.code);
                    self.try_order(cx, Owner::Amc, stop);
                    select
                }
                None => step.select,
            },
        };
        // What the order made of the target.
        amc.follow_input(&self.view(cx.cycle, Owner::Amc, cx.leads, cx.latches));
        if self.owner == Owner::Amc {
            self.reference = Reference::selected(select);
        }
        self.write_selection(cx, select);
    }

    /// Once its homing is done, the selector shows what it stands at now in that very cycle; so it does once the axis is locked.
    pub(super) fn settle_selector(&mut self, cx: &mut Context<'_>) {
        if !self.awake.amc {
            return;
        }
        if self.is_locked() {
            let select = self.amc.give_up();
            return self.write_selection(cx, select);
        }
        let has_homed = self.amc.homes() && !self.homing.is_running();
        if !has_homed || self.owner != Owner::Amc || self.state != AxisState::Standstill {
            return;
        }
        let mut amc = self.amc;
        let order = amc.end_homing(&self.view(cx.cycle, Owner::Amc, cx.leads, cx.latches));
        self.try_order(cx, Owner::Amc, Some(order));
        self.amc = amc;
        self.write_selection(cx, 0);
    }

    /// 34.007 as it is from now on.
    fn write_selection(&mut self, cx: &mut Context<'_>, select: i64) {
        if self.parameters.vocabularies.amc.reference_select != select {
            self.parameters.change(|values| values.vocabularies.amc.reference_select = select);
            let event = Event::new(Severity::Info, Kind::Parameter, self.object(), Code::NONE);
            let parameter = Row::find("amc.reference_select").map(|(row, _)| row);
            cx.events.push(Event { parameter, ..event.with(Number::Count(select), Number::None) });
        }
    }

    /// May the reference selector have these parameters, as far as can be seen before the cycle?
    ///
    /// # Errors
    /// Why not.
    pub fn admits_selector(&self, candidate: &AxisParameters, cycle: u64, leads: &Leads) -> Result<(), Refusal> {
        let refuse = |problem: amc::Problem| Refusal {
            parameter: Row::find(problem.key).map(|(row, _)| row),
            ..Refusal::new(problem.code, self.object()).with(problem.asked, problem.limit)
        };
        amc::check(candidate, &self.setup.selector()).map_err(refuse)?;
        let (now, then) = (&self.parameters.vocabularies.amc, &candidate.vocabularies.amc);
        if now == then {
            return Ok(());
        }
        let selects = |now: i64, then: i64| now != then && then != 0;
        let view = View { parameters: candidate, ..self.view(cycle, Owner::Amc, leads, &[]) };
        if view.locked
            && (selects(now.reference_select, then.reference_select)
                || selects(now.reference_select_trigger, then.reference_select_trigger))
        {
            return self.check_free();
        }
        let mut amc = self.amc;
        let step = amc.step(&view);
        if let Some(problem) = step.problem {
            return Err(refuse(problem));
        }
        match step.order {
            Some(Order::Home) => self.check_configured_homing(cycle, candidate, false),
            Some(_) if amc.waits() => self.check_configured_homing(cycle, candidate, true),
            Some(Order::Position { target, .. }) if amc.keeps_speed(&self.amc) => {
                self.check_selectable()?;
                self.check_target(target, candidate)
            }
            Some(Order::Position { target, limits, .. }) => {
                self.check_selectable()?;
                self.check_target(target, candidate)?;
                self.check_selected_way(cycle, Aim::Target(Position::whole(target.nearest())), limits)
            }
            // One that stays selected is overridden, not refused (AMC-SEL-09).
            Some(Order::Velocity { .. }) if amc.keeps_speed(&self.amc) => self.check_selectable(),
            Some(Order::Velocity { velocity, limits }) => {
                self.check_selectable()?;
                self.check_selected_way(cycle, Aim::velocity(velocity), limits)
            }
            Some(Order::Gear { .. }) => {
                self.check_selectable()?;
                self.gear_of_selector(leads).map(|_| ())
            }
            _ => Ok(()),
        }
    }

    /// May a reference that is selected lead this way? Its target and the software limits are checked by themselves.
    fn check_selected_way(&self, cycle: u64, aim: Aim, limits: Limits) -> Result<(), Refusal> {
        let course = self.course(cycle, self.present(), aim, limits);
        self.check_course_forward(&course, self.present())?;
        match aim {
            Aim::Velocity(velocity) => self.check_velocity_switches(velocity),
            _ => self.check_course_switches(&course, self.present()),
        }
    }

    /// May the selector move the axis? Its own homing, which any other reference ends, does not keep it from that.
    fn check_selectable(&self) -> Result<(), Refusal> {
        if self.homes_for(Owner::Amc) { self.check_zero() } else { self.check_free() }
    }

    /// Is it the homing of this vocabulary that is under way?
    fn homes_for(&self, owner: Owner) -> bool {
        self.owner == owner && self.homing.is_running()
    }

    /// The coupling that reference 4 begins.
    fn gear_of_selector(&self, leads: &Leads) -> Result<Follower, Refusal> {
        let refuse = |code| Refusal::new(code, self.object());
        let p = &self.parameters;
        let leader = self.setup.amc.master.ok_or_else(|| refuse(Code::LEADER_LOST))?;
        let numbers = (Number::Count(p.sync_slave), Number::Count(p.sync_master));
        let ratio = Ratio::new(p.sync_slave, p.sync_master)
            .ok_or_else(|| refuse(Code::BAD_RATIO).with(numbers.0, numbers.1))?;
        if !leads.get(leader).valid {
            return Err(refuse(Code::LEADER_LOST));
        }
        let bounds = Bounds {
            velocity: p.max_velocity,
            acceleration: p.usual_acceleration().min(p.usual_deceleration()),
            max_velocity: p.max_velocity,
            max_acceleration: p.max_acceleration,
            max_deceleration: p.deceleration_limit(),
        };
        // Displacement counts from here on (AMC-EVT-04): nothing of an earlier coupling passes on.
        let (gear, mode) = (Gear::new(ratio), SyncMode::Position);
        let follower = Follower::new(leader, gear, mode, Disengage::Stop, self.command, Position::ZERO, bounds);
        Ok(follower.with_accuracy(p.sync_accuracy))
    }

    /// Does an order that no command waits for; what the axis refuses is told.
    fn try_order(&mut self, cx: &mut Context<'_>, owner: Owner, order: Option<Order>) -> Option<Refusal> {
        let refusal = self.obey(cx, owner, order?).err()?;
        self.warn_of(cx, refusal);
        Some(refusal)
    }

    fn warn_of(&self, cx: &mut Context<'_>, refusal: Refusal) {
        let event = Event::new(Severity::Warn, Kind::Warning, self.object(), refusal.code);
        cx.events.push(Event { position: self.command.position, ..event.with(refusal.asked, refusal.limit) });
    }

    /// Nothing lets the axis go on in the cycle of a stop that locks.
    fn check_stop_of(&self, cycle: u64) -> Result<(), Refusal> {
        self.locked_in(cycle).map_or(Ok(()), |code| Err(Refusal::new(code, self.object())))
    }

    /// Switches the axis off: at once, but one that stands leaves its load to its brake first.
    pub(super) fn let_go(&mut self, cx: &mut Context<'_>) {
        if matches!(self.power, Power::Closing { .. }) {
            return;
        }
        if self.own_brake().is_some() && self.is_on() && self.rests() {
            self.power = Power::SwitchingOff;
        } else {
            self.switch_off(cx);
        }
    }

    /// Does what a vocabulary asks.
    ///
    /// # Errors
    /// What limits or state forbid; nothing is changed then.
    pub(crate) fn obey(&mut self, cx: &mut Context<'_>, owner: Owner, order: Order) -> Result<(), Refusal> {
        if owner != Owner::Amc || !self.homes_for(owner) {
            return self.carry_out(cx, owner, order);
        }
        // Another reference ends homing (AMC-FSM-01..07): limits hold for it as they do beside homing.
        let homing = self.homing;
        if matches!(order, Order::Position { .. } | Order::Velocity { .. } | Order::Gear { .. }) {
            self.homing.leave();
        }
        let result = self.carry_out(cx, owner, order);
        if result.is_ok() {
            let left = Event::new(Severity::Warn, Kind::Warning, self.object(), Code::HOMING_LEFT);
            cx.events.push(Event { position: self.command.position, ..left });
        } else {
            self.homing = homing;
        }
        result
    }

    /// The course of a vocabulary to a target that the axis may go to.
    fn admit_position(&self, cycle: u64, from: Motion, target: Position, limits: Limits) -> Result<Course, Refusal> {
        self.check_target(target, &self.parameters)?;
        let course = self.course(cycle, from, Aim::Target(Position::whole(target.nearest())), limits);
        self.check_course(&course, from, limits).map(|()| course)
    }

    /// The same at a velocity, without end.
    fn admit_velocity(&self, cycle: u64, from: Motion, velocity: f64, limits: Limits) -> Result<Course, Refusal> {
        self.check_velocity(velocity)?;
        let course = self.course(cycle, from, Aim::velocity(velocity), limits);
        self.check_course(&course, from, limits).map(|()| course)
    }

    fn carry_out(&mut self, cx: &mut Context<'_>, owner: Owner, order: Order) -> Result<(), Refusal> {
        match order {
            Order::SwitchOn => {
                if !self.active {
                    return Err(Refusal::new(Code::NOT_ACTIVE, self.object()));
                }
                self.check_contacts()?;
                if self.power == Power::Off && !self.is_virtual() {
                    self.check_lock()?;
                    self.power = Power::SwitchingOn { since: cx.cycle };
                }
            }
            Order::SwitchOff => {
                self.abandon(cx, Code::REPLACED);
                // Also one that is on its way to being on.
                let runs = self.is_on() || matches!(self.power, Power::SwitchingOn { .. });
                if !self.is_virtual() && runs {
                    self.let_go(cx);
                }
            }
            Order::FailOff { refusal } => {
                self.raise(cx, Failure::of_refusal(refusal));
            }
            Order::Position { target, limits, reference } => {
                self.check_closed_loop()?;
                self.check_free()?;
                let course = self.admit_position(cx.cycle, self.present(), target, limits)?;
                self.abandon(cx, Code::REPLACED);
                self.judge.rested_at = None;
                self.reference = reference;
                self.generator = Generator::Plan(course);
                self.set_state(cx, AxisState::DiscreteMotion);
            }
            Order::Velocity { velocity, limits } => {
                self.check_closed_loop()?;
                self.check_free()?;
                let course = self.admit_velocity(cx.cycle, self.present(), velocity, limits)?;
                self.abandon(cx, Code::REPLACED);
                self.judge.rested_at = None;
                self.reference = Reference::Speed;
                self.generator = Generator::Plan(course);
                let state = if velocity == 0.0 { AxisState::DiscreteMotion } else { AxisState::ContinuousMotion };
                self.set_state(cx, state);
            }
            Order::Stop { limits } => {
                self.abandon(cx, Code::REPLACED);
                // What a quick stop or an error stops already is not to stop more softly.
                let stops = matches!(self.state, AxisState::Stopping | AxisState::ErrorStop);
                if self.power == Power::On && !stops {
                    self.brake_to_rest(cx, &limits);
                }
            }
            Order::StandOnActual if self.is_open_loop() => {
                self.abandon(cx, Code::REPLACED);
                self.switch_speed_off(cx);
            }
            Order::StandOnActual => {
                self.abandon(cx, Code::REPLACED);
                self.reference = Reference::Stop;
                self.generator = Generator::Rest;
                use AxisState::{ContinuousMotion, Homing, SynchronizedMotion};
                if matches!(self.state, ContinuousMotion | SynchronizedMotion | Homing) {
                    self.set_state(cx, AxisState::DiscreteMotion);
                }
                self.command = Motion::at_rest(Position::whole(self.actual.position.floor()));
            }
            Order::Gear { past } => {
                self.check_closed_loop()?;
                self.check_free()?;
                let follower = self.gear_of_selector(cx.leads)?.with_past(past);
                self.abandon(cx, Code::REPLACED);
                self.judge.rested_at = None;
                self.reference = Reference::Gear;
                self.generator = Generator::Follow(follower);
                self.set_state(cx, AxisState::SynchronizedMotion);
            }
            Order::Home => self.home_as_configured(cx)?,
            Order::ReferenceTravel(travel) => self.start_reference_travel(cx, &travel)?,
            Order::Speed { velocity } => self.set_speed(cx, velocity)?,
            Order::Fail { code, found, allowed } => {
                if self.is_open_loop() {
                    self.switch_speed_off(cx);
                }
                self.raise(cx, Failure::of(code).with(found, allowed));
                self.owner = Owner::Native;
                return Ok(());
            }
            Order::Reset => {
                if self.error.is_alarm() {
                    self.check_stop_of(cx.cycle)?;
                    if !self.rests() {
                        return Err(self.not_at_standstill());
                    }
                    // WF-MON-06: after its cause is removed. The others last only as long as what they stop.
                    if self.error == Code::WF_ENCODER_CABLE && self.source_failure().is_some() {
                        return Err(Refusal::new(Code::WF_ENCODER_CABLE, self.object()));
                    }
                    self.clear_error(cx);
                }
                return Ok(());
            }
        }
        self.owner = owner;
        Ok(())
    }

    /// The signals of the vocabularies, in the order in which the directory has them behind those of the axis.
    pub(super) fn publish_vocabularies(&mut self, board: &mut Board, leads: &Leads) {
        let all = !std::mem::replace(&mut self.awake.shown, true);
        let Awake { amc, saia, wf, .. } = self.awake;
        if !(all || amc || saia || wf) {
            return;
        }
        let first = self.signals.plus(AxisSignal::COUNT);
        let view = self.view(0, Owner::Amc, leads, &[]);
        if all || amc {
            self.amc.publish(&view, board.block(first, AmcSignal::COUNT));
        }
        let first = first.plus(AmcSignal::COUNT);
        if all || saia {
            let view = View { owns: self.owner == Owner::Saia, ..view };
            self.saia.publish(&view, board.block(first, SaiaSignal::COUNT));
        }
        let first = first.plus(SaiaSignal::COUNT);
        if all || wf {
            let view = View { owns: self.owner == Owner::Wf, ..view };
            let switching = self.allowed(self.wf.switching());
            self.wf.publish(&view, switching, board.block(first, WfSignal::COUNT));
        }
    }
}

//! Execution of the orders of a vocabulary on its axis.

use crate::axis::state::{Aim, Axis, Context, Coupling, Failure, Generator, PlannedMotion, Power};
use crate::code::Code;
use crate::event::{Event, Kind, Refusal, Severity};
use crate::parameter::AxisParameters;
use crate::position::Position;
use crate::profile::{Limits, Motion};
use crate::state::{AxisState, Reference};
use crate::sync::follower::{Bounds, Follower};
use crate::sync::gear::Gear;
use crate::sync::{Disengage, Leads, SyncMode, Transmission};
use crate::table::Table;
use crate::vocabulary::{Order, Owner};
use std::sync::Arc;

impl Axis {
    /// Returns the coupling to the master that the cell defines.
    pub(super) fn coupling_to_master(
        &self,
        leads: &Leads,
        tables: &[Arc<Table>],
        (p, order): (&AxisParameters, Order),
    ) -> Result<Coupling, Refusal> {
        let refuse = |code| Refusal::new(code, self.object());
        let leader = self.master().ok_or_else(|| refuse(Code::LEADER_LOST))?;
        let lead = leads.get(leader);
        if !lead.valid {
            return Err(refuse(Code::LEADER_LOST));
        }
        let bounds = Bounds {
            velocity: p.max_velocity,
            acceleration: p.default_goal_acceleration().min(p.default_goal_deceleration()),
            max_velocity: p.max_velocity,
            max_acceleration: p.max_acceleration,
            max_deceleration: p.deceleration_limit(),
        };
        // Displacement counts from here on (AMC-EVT-04): the remainder of an earlier coupling is not taken over.
        let (transmission, past) = match order {
            Order::Cam { from, past } => (Transmission::Cam(self.ordered_cam(tables, from)?), past),
            Order::Gear { past } => (Transmission::Gear(Gear::new(self.ratio_of_parameters(p)?)), past),
            _ => return Err(refuse(Code::BAD_REQUEST)),
        };
        let mode = SyncMode::Position;
        let follower = Follower::new(lead.uneven, transmission, mode, self.command.motion(), Position::ZERO, bounds);
        let follower = follower.with_past(past, tables);
        let (disengage, accuracy) = (Disengage::Stop, p.sync_accuracy);
        Ok(Coupling { leader, disengage, accuracy, at_places: false, follower })
    }

    /// Returns an error in the cycle of a stop that locks.
    pub(super) fn check_stop_of(&self, cycle: u64) -> Result<(), Refusal> {
        self.locked_in(cycle).map_or(Ok(()), |code| Err(Refusal::new(code, self.object())))
    }

    /// Switches the axis off: at once, or after its brake has closed if the axis is at rest.
    pub(in crate::axis) fn switch_off_with_brake(&mut self, cx: &mut Context<'_>) {
        if matches!(self.status.power(), Power::Closing { .. }) {
            return;
        }
        if self.own_brake().is_some() && self.is_on() && self.rests() {
            self.status.set_power(Power::SwitchingOff);
        } else {
            self.switch_off(cx);
        }
    }

    /// Executes an order of a vocabulary.
    ///
    /// # Errors
    /// The limits or the state do not allow it; nothing is changed then.
    pub(crate) fn execute(&mut self, cx: &mut Context<'_>, owner: Owner, order: Order) -> Result<(), Refusal> {
        if !owner.order_ends_homing() || !self.homes_for(owner) {
            return self.carry_out(cx, owner, order);
        }
        // Another reference ends homing (AMC-FSM-01..07): limits apply to it as without homing.
        let homing = self.homing;
        if matches!(order, Order::Position { .. } | Order::Velocity { .. } | Order::Gear { .. } | Order::Cam { .. }) {
            self.homing.cancel_homing();
        }
        let result = self.carry_out(cx, owner, order);
        if result.is_ok() {
            let left = Event::new(Severity::Warn, Kind::Warning, self.object(), Code::HOMING_LEFT);
            cx.events.push(Event { position: self.command.position(), ..left });
        } else {
            self.homing = homing;
        }
        result
    }

    /// Returns the course of a vocabulary to a target within the limits.
    pub(super) fn admit_position(
        &self,
        cycle: u64,
        from: Motion,
        target: Position,
        limits: Limits,
    ) -> Result<PlannedMotion, Refusal> {
        self.check_target(target, &self.parameters)?;
        let course = self.course(cycle, from, Aim::Target(Position::whole(target.nearest())), limits);
        self.check_course(&course, from, limits).map(|()| course)
    }

    /// Returns the course of a vocabulary at a velocity, without end.
    pub(super) fn admit_velocity(
        &self,
        cycle: u64,
        from: Motion,
        velocity: f64,
        limits: Limits,
    ) -> Result<PlannedMotion, Refusal> {
        self.check_velocity(velocity)?;
        let course = self.course(cycle, from, Aim::velocity(velocity), limits);
        self.check_course(&course, from, limits).map(|()| course)
    }

    fn carry_out(&mut self, cx: &mut Context<'_>, owner: Owner, order: Order) -> Result<(), Refusal> {
        match order {
            Order::SwitchOn => self.order_power_on(cx)?,
            Order::SwitchOff => {
                self.end_all_motion(cx, Code::REPLACED);
                // Also an axis that is being switched on.
                let runs = self.is_on() || matches!(self.status.power(), Power::SwitchingOn { .. });
                if !self.is_virtual() && runs {
                    self.switch_off_with_brake(cx);
                }
            }
            Order::FailOff { refusal } => {
                self.raise(cx, Failure::of_refusal(refusal));
            }
            Order::Position { target, limits, reference } => {
                self.check_closed_loop()?;
                self.check_free()?;
                let course = self.admit_position(cx.cycle, self.present_motion(), target, limits)?;
                self.order_motion(cx, AxisState::DiscreteMotion, reference, Generator::Plan(course));
            }
            Order::Velocity { velocity, limits } => {
                self.check_closed_loop()?;
                self.check_free()?;
                let course = self.admit_velocity(cx.cycle, self.present_motion(), velocity, limits)?;
                let state = if velocity == 0.0 { AxisState::DiscreteMotion } else { AxisState::ContinuousMotion };
                self.order_motion(cx, state, Reference::Speed, Generator::Plan(course));
            }
            Order::Stop { limits } => {
                self.end_all_motion(cx, Code::REPLACED);
                // A stop by a quick stop or an error must not become softer.
                let stops = matches!(self.status.state(), AxisState::Stopping | AxisState::ErrorStop);
                if self.status.power() == Power::On && !stops {
                    self.brake_to_rest(cx, &limits);
                }
            }
            Order::HoldActualPosition => self.hold_actual_position(cx),
            Order::Gear { .. } | Order::Cam { .. } => {
                self.check_closed_loop()?;
                self.check_free()?;
                let coupling = self.coupling_to_master(cx.leads, cx.tables, (&self.parameters, order))?;
                let is_cam = matches!(order, Order::Cam { .. });
                let reference = if is_cam { Reference::Cam } else { Reference::Gear };
                self.order_motion(cx, AxisState::SynchronizedMotion, reference, Generator::Follow(coupling));
            }
            Order::Home => self.home_as_configured(cx)?,
            Order::ReferenceTravel(travel) => self.start_reference_travel(cx, &travel)?,
            Order::Speed { velocity } => self.set_speed(cx, velocity)?,
            Order::Fail { code, found, allowed } => {
                if self.is_open_loop() {
                    self.switch_speed_off(cx);
                }
                self.raise(cx, Failure::of(code).with(found, allowed));
                self.status.set_owner(Owner::Native);
                return Ok(());
            }
            Order::Reset => return self.reset_alarm(cx),
        }
        self.status.set_owner(owner);
        Ok(())
    }

    /// Switches the axis on.
    fn order_power_on(&mut self, cx: &mut Context<'_>) -> Result<(), Refusal> {
        if !self.observed.is_active() {
            return Err(Refusal::new(Code::NOT_ACTIVE, self.object()));
        }
        self.check_contacts()?;
        if self.status.power() == Power::Off && !self.is_virtual() {
            self.check_lock()?;
            cx.gantry.as_deref().map_or(Ok(()), |gantry| self.admits_skew(gantry))?;
            self.status.set_power(Power::SwitchingOn { since: cx.cycle });
        }
        Ok(())
    }

    /// Begins an admitted motion of a vocabulary instead of the present one.
    fn order_motion(&mut self, cx: &mut Context<'_>, state: AxisState, reference: Reference, generator: Generator) {
        self.end_all_motion(cx, Code::REPLACED);
        self.supervision.forget_rest();
        self.begin_motion(cx, state, reference, generator);
    }

    /// Holds the axis at its actual position, as far as a loop can hold it.
    fn hold_actual_position(&mut self, cx: &mut Context<'_>) {
        self.end_all_motion(cx, Code::REPLACED);
        if self.is_open_loop() {
            return self.switch_speed_off(cx);
        }
        // Where no loop holds the axis, it cannot stay at the actual position.
        if self.out_an().is_some() {
            return self.let_drive_stop(cx);
        }
        self.status.end_reference();
        self.motion.rest();
        use AxisState::{ContinuousMotion, Homing, SynchronizedMotion};
        if matches!(self.status.state(), ContinuousMotion | SynchronizedMotion | Homing) {
            self.set_state(cx, AxisState::DiscreteMotion);
        }
        self.command.rest_at(Position::whole(self.feedback.position().floor()));
    }

    /// Clears an alarm of a vocabulary; other errors remain.
    fn reset_alarm(&mut self, cx: &mut Context<'_>) -> Result<(), Refusal> {
        if !self.alarm.code().is_alarm() {
            return Ok(());
        }
        self.check_stop_of(cx.cycle)?;
        if !self.rests() || !self.has_stopped_by_itself(cx.cycle) {
            return Err(self.not_at_standstill());
        }
        // WF-MON-06: only after its cause is removed. Other alarms last only as long as the motion that they stop.
        if self.alarm.code() == Code::WF_ENCODER_CABLE && self.source_failure().is_some() {
            return Err(Refusal::new(Code::WF_ENCODER_CABLE, self.object()));
        }
        self.clear_error(cx);
        Ok(())
    }
}

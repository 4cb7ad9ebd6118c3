//! An axis on a cam of `~/synchronize`: start and end of the cam.
//!
//! Law      absolute: master and slave are at the positions of the table from the first cycle on; the slave must
//!          already be there, within SYNCACCURACY. Relative: the table begins at the present positions. Ramp-in: as
//!          absolute, but the slave catches up like a coupling. A cam that is not cyclic ends its goal at its end,
//!          where the slave rests, or continues if the goal requires that
//! Reads    the tables, the lead
//! Refuses  a table that is no cam, a master beyond its end, absolute if the slave is elsewhere
//! Source   contract section 10, PLCopen (MC_CamIn, MC_CamOut)

use crate::axis::state::{Aim, Axis, Context, Coupling, Generator};
use crate::code::Code;
use crate::command::CamIn;
use crate::encoder::Lead;
use crate::event::{Number, Refusal};
use crate::modulo::Direction;
use crate::object::Object;
use crate::position::Position;
use crate::state::{AxisState, Reference};
use crate::sync::cam::Cam;
use crate::sync::follower::Phase;
use crate::sync::gear::Ratio;
use crate::sync::{CamStart, Disengage};
use crate::table::{CamError, Table};
use crate::vocabulary::CamPoint;
use std::sync::Arc;

/// Returns the refusal for a table that is no cam.
pub fn no_cam(table: u16, error: CamError) -> Refusal {
    let count = |number: usize| Number::Count(number as i64);
    let (code, asked, limit) = match error {
        CamError::Words => (Code::CAM_FORM, Number::None, Number::None),
        CamError::Few { count: points, fewest } => (Code::CAM_POINTS, count(points), count(fewest)),
        CamError::SplineOvershoot(point) => (Code::CAM_UNEVEN, count(point), Number::None),
        CamError::NoLength => (Code::CAM_NO_LENGTH, Number::None, Number::None),
        CamError::Length(length) => (Code::CAM_LENGTH, Number::Count(length), Number::None),
        CamError::Place { place, x } => (Code::CAM_PLACE, count(place), Number::Count(x)),
        CamError::Value { place, y } => (Code::CAM_VALUE, count(place), Number::Count(y)),
    };
    Refusal::new(code, Object::Table(table)).with(asked, limit)
}

impl Axis {
    /// Returns the table of the active cam.
    pub fn cam_table(&self) -> Option<u16> {
        self.coupling()?.follower.transmission().cam().map(Cam::table)
    }

    /// Returns the cam of a request, and the distance of the slave from `stands` to the cam.
    pub(super) fn cam_of(
        &self,
        tables: &[Arc<Table>],
        lead: Lead,
        (request, disengage): (&CamIn, Disengage),
        stands: Position,
    ) -> Result<(Cam, Position), Refusal> {
        let unknown = || Refusal::new(Code::BAD_REQUEST, Object::Machine);
        let table = tables.get(usize::from(request.table)).ok_or_else(unknown)?;
        let shape = table.cam().map_err(|error| no_cam(request.table, error))?;
        let (offset, scales) = (request.master_offset.exact(), (request.master_scale, request.slave_scale));
        let place = match request.start {
            CamStart::Relative => offset,
            CamStart::Absolute | CamStart::RampIn => Cam::place_of(lead.position, scales.0, offset, shape),
        };
        let passed = |place: Position| {
            let (asked, limit) = (Number::Count(place.floor()), Number::Count(shape.length));
            Refusal::new(Code::CAM_PASSED, Object::Table(request.table)).with(asked, limit)
        };
        if !place.is_legal() {
            return Err(passed(place));
        }
        let cam = Cam::new(request.table, scales, place, tables).ok_or_else(unknown)?;
        if cam.has_ended(tables) {
            return Err(passed(place));
        }
        let cam = if disengage == Disengage::KeepVelocity { cam.continuing_at_end() } else { cam };
        let offset = request.slave_offset.exact();
        if request.start == CamStart::Relative {
            return Ok((cam, offset));
        }
        let way = self.shortest(cam.scaled() + offset, stands);
        let most = self.parameters.sync_accuracy.saturating_abs();
        if request.start == CamStart::Absolute && (way > Position::whole(most) || -way > Position::whole(most)) {
            let (asked, limit) = (Number::Position(way.nearest()), Number::Position(most));
            return Err(self.refuse(Code::CAM_AWAY).with(asked, limit));
        }
        Ok((cam, way))
    }

    /// Returns the cam that an order starts (AMC-SEL-03).
    pub(in crate::axis) fn ordered_cam(&self, tables: &[Arc<Table>], from: CamPoint) -> Result<Cam, Refusal> {
        let unknown = || self.refuse(Code::BAD_REQUEST);
        let table = tables.get(usize::from(from.table)).ok_or_else(unknown)?;
        let shape = table.cam().map_err(|error| no_cam(from.table, error))?;
        let place = shape.place(table, from.point, from.behind);
        if place >= Position::whole(shape.length) {
            let (asked, limit) = (Number::Count(place.floor()), Number::Count(shape.length));
            return Err(Refusal::new(Code::CAM_START, Object::Table(from.table)).with(asked, limit));
        }
        Cam::new(from.table, (Ratio::ONE, Ratio::ONE), place, tables).ok_or_else(unknown)
    }

    /// Returns the distance from `now` to `place`; the shorter one for an axis with modulo.
    fn shortest(&self, place: Position, now: Position) -> Position {
        let target = |modulo: crate::modulo::Modulo| modulo.target(place, now, now, Direction::Shortest, 0.0);
        self.setup.modulo.map_or(place, target) - now
    }

    /// Ends the goal of a cam at the end of the table, once the slave is there and rests, or continues from there.
    pub(in crate::axis) fn end_cam(&mut self, cx: &mut Context<'_>) {
        let Generator::Follow(Coupling { disengage, follower, leader, .. }) = self.motion.generator() else { return };
        let Some(cam) = follower.transmission().cam() else { return };
        // A cam started by the selector holds its slave there.
        if !cam.has_ended(cx.tables) || self.task.goal().is_none() {
            return;
        }
        let limits = self.parameters.default_goal_limits();
        let is_there = follower.phase() == Phase::Synchronized;
        let is_barred = follower.error(self.command.position()) < Position::ZERO && !self.reverses_alone();
        if *disengage == Disengage::KeepVelocity && is_there {
            let lead = cx.leads.get(*leader);
            let led = if lead.uneven == 0.0 { lead.velocity } else { cam.mean() / self.cycle_s() };
            let velocity = led * cam.slope();
            let velocity = if self.reverses_alone() { velocity } else { velocity.max(0.0) };
            let most = self.parameters.max_velocity;
            self.end_goal(cx, Code::NONE);
            let course = self.course(cx.cycle, self.base(), Aim::velocity(velocity.clamp(-most, most)), limits);
            self.begin_motion(cx, AxisState::ContinuousMotion, Reference::Speed, Generator::Plan(course));
        } else if self.command.velocity() == 0.0 && (is_there || is_barred) {
            if let Some(goal) = self.task.goal_mut().filter(|_| !is_there) {
                // It must not move backwards to the end.
                goal.ending = Some(Code::REVERSE_FORBIDDEN);
            }
            self.brake_to_rest(cx, &limits);
        }
    }
}

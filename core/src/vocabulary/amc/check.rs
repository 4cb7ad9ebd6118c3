//! Checks of the parameters of the selector against the other parameters of the axis.

use super::parameters::{CAM, CAM_ON_FREEZE, GEAR, GEAR_ON_FREEZE, HOME};
use super::rotary::{Circle, Mode};
use crate::code::Code;
use crate::event::{Number, Refusal};
use crate::modulo::Modulo;
use crate::object::Object;
use crate::parameter::amc::Parameters;
use crate::parameter::{AxisParameters, ROWS, Row};
use crate::position::Position;
use crate::vocabulary::Wiring;

/// Fixed properties of the axis of a selector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Length of a turn (31.010).
    pub modulo: Option<Modulo>,
    /// Increments per user unit.
    pub unit: f64,
    /// Sample time (ns) (31.013).
    pub cycle_ns: u64,
    /// Connections of the selector.
    pub wiring: Wiring,
    /// Whether it is virtual: homing is impossible without switches and index.
    pub is_virtual: bool,
}

/// A parameter value that conflicts with the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Problem {
    /// Index of its row.
    pub row: u16,
    /// Error code.
    pub code: Code,
    /// Its value.
    pub asked: Number,
    /// Allowed value.
    pub limit: Number,
}

impl Problem {
    /// Returns the key of the parameter.
    pub fn key(&self) -> &'static str {
        ROWS.get(usize::from(self.row)).map_or("", |row| row.key)
    }

    /// Returns the problem as a refusal.
    pub fn refusal(&self, object: Object) -> Refusal {
        Refusal { parameter: Some(self.row), ..Refusal::new(self.code, object).with(self.asked, self.limit) }
    }
}

pub(super) const POSITION_REFERENCE: u16 = Row::place("amc.position_reference");
pub(super) const ACTION_ON_EVENT: u16 = Row::place("amc.action_on_event");
const SPEED_REFERENCE: u16 = Row::place("amc.speed_reference");
const SELECT: u16 = Row::place("amc.reference_select");
const TRIGGER: u16 = Row::place("amc.reference_select_trigger");

/// Checks that the parameters of the selector agree with the axis.
///
/// # Errors
/// The first conflict.
pub fn check(parameters: &AxisParameters, setting: &Setting) -> Result<(), Problem> {
    let p = &parameters.vocabularies.amc;
    check_select(SELECT, p.reference_select, parameters.homing.method, setting)?;
    check_select(TRIGGER, p.reference_select_trigger, parameters.homing.method, setting)?;
    check_event(p.action_on_event, setting)?;
    check_reference(p, setting)?;
    if p.speed_reference.abs() > parameters.max_velocity {
        return Err(Problem {
            row: SPEED_REFERENCE,
            code: Code::VELOCITY_TOO_HIGH,
            asked: Number::Velocity(p.speed_reference.abs()),
            limit: Number::Velocity(parameters.max_velocity),
        });
    }
    Ok(())
}

fn check_select(row: u16, select: i64, method: i64, setting: &Setting) -> Result<(), Problem> {
    let refuse = |code| Err(Problem { row, code, asked: Number::Count(select), limit: Number::None });
    match select {
        HOME if method == 0 && setting.is_virtual => refuse(Code::HOMING_NEEDS_DRIVE),
        HOME if method == 0 => refuse(Code::HOMING_NO_METHOD),
        CAM | GEAR if setting.wiring.amc.master.is_none() => refuse(Code::AMC_NO_MASTER),
        CAM if setting.wiring.amc.cam.is_none() => refuse(Code::AMC_NO_CAM),
        _ => Ok(()),
    }
}

fn check_event(action: i64, setting: &Setting) -> Result<(), Problem> {
    let asked = Number::Count(action);
    let refuse = |code| Err(Problem { row: ACTION_ON_EVENT, code, asked, limit: Number::None });
    match action {
        CAM_ON_FREEZE | GEAR_ON_FREEZE if setting.wiring.amc.freeze.is_none() => refuse(Code::AMC_NO_FREEZE),
        CAM_ON_FREEZE | GEAR_ON_FREEZE if setting.wiring.amc.master.is_none() => refuse(Code::AMC_NO_MASTER),
        CAM_ON_FREEZE if setting.wiring.amc.cam.is_none() => refuse(Code::AMC_NO_CAM),
        _ => Ok(()),
    }
}

/// M01: the reference must be within a turn in the modes of a single turn, otherwise within the range of the
/// integrators.
fn check_reference(p: &Parameters, setting: &Setting) -> Result<(), Problem> {
    let circle = Circle::new(setting.modulo);
    let reference = circle.exact(Position::whole(p.position_reference));
    let asked = Number::Position(p.position_reference);
    let refuse = |code, limit| Err(Problem { row: POSITION_REFERENCE, code, asked, limit });
    let (Some(last), Some(capacity)) = (circle.last(), circle.capacity(setting.unit)) else { return Ok(()) };
    if Mode::new(p.rotary_mode, setting.modulo, setting.cycle_ns).is_within_turn() {
        if p.position_reference.saturating_abs() > last {
            return refuse(Code::AMC_OUTSIDE_TURN, Number::Position(last));
        }
    } else if circle.exceeds(reference, capacity) {
        return refuse(Code::AMC_TURN_CAPACITY, Number::Count(capacity));
    }
    Ok(())
}

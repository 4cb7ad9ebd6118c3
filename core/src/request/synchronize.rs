//! Conversion of couplings: gears and cams.
//!
//! Law      a scale is the decimal that was written, to 18 decimal places, or to 18 digits: a coupling never drifts
//! Reads    the names of the cell; the scales of axis and leader
//! Refuses  modes that do not exist yet, fields without effect in the mode, scales beyond [`MAX_SCALE`]
//! Source   contract section 7, 10

use super::choice::{chosen, names, number_of, unknown};
use super::meaning::unused_length_error;
use super::{Amount, NAMELESS, Named, Presence, RequestError, UnitOf, Units, Verb, VerbFields, bad_value};
use crate::command::{Action, CamIn, Engage, Synchronize};
use crate::config::MachineConfig;
use crate::object::{Leader, Object, VIRTUAL_MASTER};
use crate::position::{Length, Position};
use crate::sync::gear::{Gear, Ratio};
use crate::sync::{CamStart, Disengage, SyncMode};
use crate::unit::{Fraction, Scale, excerpt, fraction_from_f64, fraction_to_text, round};

const MODES: [(&str, SyncMode); 6] = [
    ("velocity", SyncMode::Velocity),
    ("position", SyncMode::Position),
    ("marker", SyncMode::Marker),
    ("cam", SyncMode::Position),
    ("cam_master_marker", SyncMode::MasterMarker),
    ("cam_slave_marker", SyncMode::SlaveMarker),
];
/// Numbers of `mode`.
const POSITION: u8 = 1;
const MARKER: u8 = 2;
/// Mode CAM, the first mode of cams.
const CAM: u8 = 3;
/// Modes CAM_MASTER_MARKER and CAM_SLAVE_MARKER.
const CAM_MASTER_MARKER: u8 = 4;
const CAM_SLAVE_MARKER: u8 = 5;

/// Returns true for a mode of cams.
fn is_cam(mode: u8) -> bool {
    matches!(mode, CAM | CAM_MASTER_MARKER | CAM_SLAVE_MARKER)
}

const ENGAGES: [&str; 4] = ["immediately", "at_position", "on_event", "at_end"];
/// Numbers of `engage`.
const AT_POSITION: u8 = 1;
const ON_EVENT: u8 = 2;
const AT_END: u8 = 3;
const DISENGAGES: [(&str, Disengage); 2] = [("stop", Disengage::Stop), ("keep_velocity", Disengage::KeepVelocity)];
/// Maximum scale of a cam; the minimum is its inverse.
const MAX_SCALE: i128 = 1_000_000;
/// Maximum decimal places of a scale.
const PLACES: u32 = 18;

/// A coupling with names and units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SynchronizeRequest {
    /// Name of the following axis.
    pub axis: String,
    /// Name of the leader; empty: the leader of parameter `mencodertype` of the axis.
    pub master: String,
    /// Latch of engage ON_EVENT.
    pub event: String,
    /// 0 velocity, 1 position, 2 marker, 3 cam.
    pub mode: u8,
    /// 0 immediately, 1 at position, 2 on event, 3 at the end of the present cam.
    pub engage: u8,
    /// 0 stop, 1 keep velocity.
    pub disengage: u8,
    /// Slave increments.
    pub numerator: i64,
    /// Master increments.
    pub denominator: i64,
    /// Position of the leader for engage AT_POSITION (inc).
    pub master_increments: i64,
    /// Position of the slave for engage AT_POSITION (inc), only with mode POSITION.
    pub slave_increments: i64,
    /// Distance of the leader before that position in which the slave synchronizes (inc), only with engage AT_POSITION
    /// and mode POSITION.
    pub start_distance_increments: i64,
    /// Shift of the slave.
    pub offset: Amount,
    /// Velocity; 0: the default.
    pub velocity: Amount,
    /// Acceleration; 0: the default.
    pub acceleration: Amount,
    /// Additional fields of mode CAM.
    pub cam: CamRequest,
}

/// Additional fields of mode CAM.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CamRequest {
    /// Name of the table.
    pub table: String,
    /// 0 absolute, 1 relative, 2 ramp-in.
    pub start: u8,
    /// Increments of the table per increment of the leader; 0: 1.
    pub master_scale: Fraction,
    /// Increments of the slave per increment of the table; 0: 1.
    pub slave_scale: Fraction,
    /// Shift of the leader, in its unit.
    pub master_offset: Amount,
    /// Shift of the slave.
    pub slave_offset: Amount,
}

impl SynchronizeRequest {
    /// Returns the request of a command, in increments.
    pub(super) fn of(command: &Synchronize, config: &MachineConfig) -> Self {
        let (engage, [master_increments, slave_increments, start_distance_increments], event) = match command.engage {
            Engage::Immediately => (0, [0; 3], None),
            Engage::AtPosition { position, .. } => (AT_POSITION, [position, 0, 0], None),
            Engage::InPosition { position, slave, distance, .. } => (AT_POSITION, [position, slave, distance], None),
            Engage::OnEvent(source) => (ON_EVENT, [0; 3], Some(source)),
            Engage::AtEnd => (AT_END, [0; 3], None),
        };
        let is_gear = command.cam.is_none();
        Self {
            axis: config.name_or_nameless(Object::Axis(command.axis)),
            master: command.leader.map(|leader| config.name_of_leader(leader)).unwrap_or_default(),
            event: event.map(|source| config.name_or_nameless(source)).unwrap_or_default(),
            mode: match command.mode {
                SyncMode::Velocity | SyncMode::Position | SyncMode::Marker if !is_gear => CAM,
                mode => number_of(&MODES, &mode),
            },
            engage,
            disengage: number_of(&DISENGAGES, &command.disengage),
            numerator: command.numerator,
            denominator: command.denominator,
            master_increments,
            slave_increments,
            start_distance_increments,
            offset: Amount::Increments(command.offset),
            velocity: Amount::IncrementsPerTime(command.velocity),
            acceleration: Amount::IncrementsPerTime(command.acceleration),
            cam: command.cam.as_ref().map(|cam| CamRequest::of(cam, config)).unwrap_or_default(),
        }
    }
}

impl CamRequest {
    fn of(cam: &CamIn, config: &MachineConfig) -> Self {
        let scale = |ratio: Ratio| match ratio {
            Ratio::ONE => Fraction::default(),
            ratio => Fraction::new(ratio.numerator().into(), ratio.denominator().into()),
        };
        Self {
            table: config.name(Object::Table(cam.table)).to_owned(),
            start: number_of(&CamStart::NAMES, &cam.start),
            master_scale: scale(cam.master_scale),
            slave_scale: scale(cam.slave_scale),
            master_offset: Amount::Increments(cam.master_offset),
            slave_offset: Amount::Increments(cam.slave_offset),
        }
    }
}

impl Verb for SynchronizeRequest {
    fn fields(&mut self, fields: &mut dyn VerbFields) {
        fields.id();
        fields.name("axis", Named::Axis, Presence::Required, &mut self.axis);
        fields.name("master", Named::Leader, Presence::Optional, &mut self.master);
        fields.choice("mode", &names(&MODES), Presence::Written, &mut self.mode);
        fields.choice("engage", &ENGAGES, Presence::Optional, &mut self.engage);
        fields.name("event", Named::Other, Presence::Optional, &mut self.event);
        fields.belongs("event", self.event.is_empty() || self.engage == ON_EVENT, "engage: on_event");
        let places = [
            ("master_increments", UnitOf::Leader, &mut self.master_increments),
            ("slave_increments", UnitOf::Axis, &mut self.slave_increments),
            ("start_distance_increments", UnitOf::Leader, &mut self.start_distance_increments),
        ];
        for (key, of, value) in places {
            fields.increments(key, of, value);
            fields.belongs(key, self.engage == AT_POSITION, "engage: at_position");
        }
        fields.choice("disengage", &names(&DISENGAGES), Presence::Optional, &mut self.disengage);
        // A gear with only one part of the ratio lacks the other: 9 : 0 is no gear.
        let is_half = fields.has("numerator") != fields.has("denominator");
        let part = if is_half && self.mode < CAM { Presence::Expected } else { Presence::Optional };
        fields.whole("numerator", i64::MIN..=i64::MAX, part, &mut self.numerator);
        fields.whole("denominator", i64::MIN..=i64::MAX, part, &mut self.denominator);
        fields.amount("offset", 0, UnitOf::Axis, Presence::Optional, &mut self.offset);
        fields.amount("velocity", 1, UnitOf::Axis, Presence::Optional, &mut self.velocity);
        fields.amount("acceleration", 2, UnitOf::Axis, Presence::Optional, &mut self.acceleration);
        let CamRequest { table, start, master_scale, slave_scale, master_offset, slave_offset } = &mut self.cam;
        fields.name("table", Named::Other, Presence::Optional, table);
        let presence = if is_cam(self.mode) { Presence::Written } else { Presence::Optional };
        fields.choice("cam_start", &names(&CamStart::NAMES), presence, start);
        fields.fraction("master_scale", master_scale);
        fields.fraction("slave_scale", slave_scale);
        fields.amount("master_offset", 0, UnitOf::Leader, Presence::Optional, master_offset);
        fields.amount("slave_offset", 0, UnitOf::Axis, Presence::Optional, slave_offset);
    }

    fn resolve(&self, config: &MachineConfig, recorded: bool) -> Result<Action, RequestError> {
        let resolved =
            if recorded { config.resolve_recorded_synchronize(self) } else { config.resolve_synchronize(self) };
        resolved.map(Action::Synchronize)
    }
}

/// Converts a scale of ROS 2 to the decimal that was written.
///
/// # Errors
/// The number is not finite.
pub fn factor(field: &str, value: f64) -> Result<Fraction, RequestError> {
    fraction_from_f64(value).map_err(|error| bad_value(field, error))
}

impl MachineConfig {
    /// Converts a coupling to a command.
    ///
    /// # Errors
    /// An error in the request itself.
    pub fn resolve_synchronize(&self, request: &SynchronizeRequest) -> Result<Synchronize, RequestError> {
        let resolved = self.resolve_recorded_synchronize(request)?;
        check_engage(request)?;
        let (_, axis) = self.find_axis(&request.axis)?;
        if resolved.mode == SyncMode::Velocity && resolved.offset != Length::whole(0) {
            let allowed = "0 is allowed with mode VELOCITY, which keeps no position";
            return Err(unused_length_error("offset", request.offset, Units::Si, &axis.scale, allowed));
        }
        if resolved.mode == SyncMode::Marker && resolved.offset != Length::whole(0) {
            let allowed =
                "0 is allowed with mode MARKER, where parameter syncposoffs shifts the axis against the marks";
            return Err(unused_length_error("offset", request.offset, Units::Si, &axis.scale, allowed));
        }
        Ok(resolved)
    }

    /// Converts a recorded coupling like [`MachineConfig::resolve_synchronize`]: older programs accepted fields without
    /// effect.
    ///
    /// # Errors
    /// An error in the request itself.
    pub fn resolve_recorded_synchronize(&self, request: &SynchronizeRequest) -> Result<Synchronize, RequestError> {
        let (index, axis) = self.find_axis(&request.axis)?;
        let mode = chosen("mode", request.mode, &MODES)?;
        let disengage = chosen("disengage", request.disengage, &DISENGAGES)?;
        let (units, scale) = (Units::Si, &axis.scale);
        let length =
            |field, amount: Amount, scale| amount.length(units, scale).map_err(|error| bad_value(field, error));
        let rate =
            |field, amount: Amount, order| amount.rate(units, scale, order).map_err(|error| bad_value(field, error));
        let leader = Some(&request.master).filter(|name| !name.is_empty()).map(|name| self.find_leader(name));
        let leader = leader.transpose()?;
        let engage = self.resolve_engage(request, leader)?;
        let offset = length("offset", request.offset, scale)?;
        let cam = if is_cam(request.mode) {
            let numbers = [("numerator", request.numerator), ("denominator", request.denominator)];
            if let Some((field, value)) = numbers.into_iter().find(|(_, value)| *value != 0) {
                return Err(choice_of_cam(field, value));
            }
            if offset != Length::whole(0) {
                let allowed = "0 is allowed with mode CAM, which has slave_offset";
                return Err(unused_length_error("offset", request.offset, units, scale, allowed));
            }
            Some(self.resolve_cam(&request.cam, leader, scale)?)
        } else {
            check_no_cam(&request.cam)?;
            if matches!(engage, Engage::InPosition { .. }) && offset != Length::whole(0) {
                let allowed = "0 is allowed with engage AT_POSITION, whose slave_increments say where the slave is";
                return Err(unused_length_error("offset", request.offset, units, scale, allowed));
            }
            None
        };
        Ok(Synchronize {
            axis: index,
            leader,
            mode,
            engage,
            disengage,
            numerator: request.numerator,
            denominator: request.denominator,
            offset,
            velocity: rate("velocity", request.velocity, 1)?,
            acceleration: rate("acceleration", request.acceleration, 2)?,
            cam,
        })
    }

    fn resolve_engage(&self, request: &SynchronizeRequest, leader: Option<Leader>) -> Result<Engage, RequestError> {
        match (request.engage, request.mode, leader) {
            (0, ..) => Ok(Engage::Immediately),
            (AT_POSITION | ON_EVENT, MARKER, _) => {
                Err(RequestError::NotBuilt("engage AT_POSITION or ON_EVENT in mode MARKER".into()))
            }
            (AT_POSITION | ON_EVENT | AT_END, CAM_MASTER_MARKER | CAM_SLAVE_MARKER, _) => {
                let what = "engage AT_POSITION, ON_EVENT or AT_END in modes CAM_MASTER_MARKER and CAM_SLAVE_MARKER";
                Err(RequestError::NotBuilt(what.into()))
            }
            (AT_POSITION, _, None) => Err(RequestError::NoMeaning {
                field: "engage",
                value: "AT_POSITION".to_owned(),
                allowed: "it needs the name of its master, whose position it is",
            }),
            (AT_POSITION, mode, Some(leader)) => self.resolve_position(request, mode, leader),
            (ON_EVENT, ..) => Ok(Engage::OnEvent(self.find_latch(&request.event)?)),
            (AT_END, CAM, _) => Ok(Engage::AtEnd),
            (AT_END, ..) => Err(RequestError::NoMeaning {
                field: "engage",
                value: "AT_END".to_owned(),
                allowed: "it belongs to mode CAM; IMMEDIATELY is allowed",
            }),
            (other, ..) => Err(unknown("engage", other, &ENGAGES)),
        }
    }

    /// Converts the positions of AT_POSITION.
    fn resolve_position(&self, request: &SynchronizeRequest, mode: u8, leader: Leader) -> Result<Engage, RequestError> {
        let position = checked_position("master_increments", request.master_increments)?;
        let turn = self.turn_of(leader);
        if mode == POSITION {
            let slave = checked_position("slave_increments", request.slave_increments)?;
            let distance = request.start_distance_increments;
            if !(0..=Gear::MAX_CHANGE).contains(&distance) {
                let (field, allowed) = ("start_distance_increments", "0 to 2147483648 is allowed");
                return Err(RequestError::BadChoice { field, value: distance, allowed });
            }
            return Ok(Engage::InPosition { position, turn, slave, distance });
        }
        let of_gear = [
            ("slave_increments", request.slave_increments),
            ("start_distance_increments", request.start_distance_increments),
        ];
        if let Some((field, value)) = of_gear.into_iter().find(|(_, value)| *value != 0) {
            let allowed = if mode == CAM {
                "0 is allowed with mode CAM, whose table says where the slave is"
            } else {
                "0 is allowed with mode VELOCITY, which keeps no position"
            };
            return Err(RequestError::BadChoice { field, value, allowed });
        }
        Ok(Engage::AtPosition { position, turn })
    }

    fn name_of_leader(&self, leader: Leader) -> String {
        match leader {
            // No command contains it by name; the axis refers to it.
            Leader::Simulated(_) => NAMELESS.to_owned(),
            Leader::Virtual => VIRTUAL_MASTER.to_owned(),
            Leader::AxisCommand(index) => self.name_or_nameless(Object::Axis(index)),
            Leader::Sink(index) => format!("{}.sink", self.name(Object::Function(index))),
            Leader::AxisActual(index) => format!("{}.actual", self.name_or_nameless(Object::Axis(index))),
            Leader::Sum(index) => {
                self.masters.get(usize::from(index)).map_or(NAMELESS, |master| &master.name).to_owned()
            }
            Leader::Encoder(index) => self.name_or_nameless(Object::Encoder(index)),
        }
    }

    fn resolve_cam(&self, request: &CamRequest, leader: Option<Leader>, slave: &Scale) -> Result<CamIn, RequestError> {
        let table = self.find_table(&request.table)?;
        let start = chosen("cam_start", request.start, &CamStart::NAMES)?;
        let master = match leader {
            Some(leader) => self.scale_of(leader),
            None if request.master_offset.is_zero() => Scale::increments(),
            None => {
                return Err(RequestError::NoMeaning {
                    field: "master_offset",
                    value: "given".to_owned(),
                    allowed: "0 is allowed without a master, which has its unit",
                });
            }
        };
        let length =
            |field, amount: Amount, scale| amount.length(Units::Si, scale).map_err(|error| bad_value(field, error));
        Ok(CamIn {
            table,
            start,
            master_scale: ratio("master_scale", request.master_scale)?,
            slave_scale: ratio("slave_scale", request.slave_scale)?,
            master_offset: length("master_offset", request.master_offset, &master)?,
            slave_offset: length("slave_offset", request.slave_offset, slave)?,
        })
    }
}

/// Returns a position, or an error beyond the range of positions.
pub(super) fn checked_position(field: &'static str, value: i64) -> Result<i64, RequestError> {
    if value.unsigned_abs() < Position::LIMIT.unsigned_abs() {
        return Ok(value);
    }
    Err(RequestError::BadChoice { field, value, allowed: "within +-2^62 is allowed" })
}

/// Checks that no field of another `engage` is set.
fn check_engage(request: &SynchronizeRequest) -> Result<(), RequestError> {
    let places = [
        ("master_increments", request.master_increments),
        ("slave_increments", request.slave_increments),
        ("start_distance_increments", request.start_distance_increments),
    ];
    if let Some((field, value)) = places.into_iter().find(|(_, value)| *value != 0 && request.engage != AT_POSITION) {
        let allowed = "it belongs to engage AT_POSITION; leave it out, or at 0";
        return Err(RequestError::BadChoice { field, value, allowed });
    }
    if !request.event.is_empty() && request.engage != ON_EVENT {
        let value = format!("`{}`", excerpt(&request.event));
        return Err(RequestError::NoMeaning {
            field: "event",
            value,
            allowed: "it belongs to engage ON_EVENT; leave it out",
        });
    }
    Ok(())
}

fn choice_of_cam(field: &'static str, value: i64) -> RequestError {
    RequestError::BadChoice {
        field,
        value,
        allowed: "0 is allowed with mode CAM, which has master_scale and slave_scale",
    }
}

/// Checks that no field of a cam is set.
fn check_no_cam(request: &CamRequest) -> Result<(), RequestError> {
    let CamRequest { table, start, master_scale, slave_scale, master_offset, slave_offset } = request;
    let zero = Fraction::default();
    let scale = |scale: &Fraction| (*scale != zero).then(|| fraction_to_text(scale));
    let amount = |amount: &Amount| (!amount.is_zero()).then(|| "given".to_owned());
    let given = [
        ("table", (!table.is_empty()).then(|| format!("`{}`", excerpt(table)))),
        ("cam_start", (*start != 0).then(|| start.to_string())),
        ("master_scale", scale(master_scale)),
        ("slave_scale", scale(slave_scale)),
        ("master_offset", amount(master_offset)),
        ("slave_offset", amount(slave_offset)),
    ];
    let found = given.into_iter().find_map(|(field, value)| value.map(|value| (field, value)));
    found.map_or(Ok(()), |(field, value)| {
        let allowed = "it belongs to mode CAM; leave it out, or at 0";
        Err(RequestError::NoMeaning { field, value, allowed })
    })
}

/// Converts a scale to a ratio.
fn ratio(field: &'static str, given: Fraction) -> Result<Ratio, RequestError> {
    let allowed = "a scale must be within 0.000001 and 1000000, of either sign; 0 stands for 1";
    let refused = || RequestError::NoMeaning { field, value: fraction_to_text(&given), allowed };
    if given == Fraction::default() {
        return Ok(Ratio::ONE);
    }
    let (numerator, denominator) = (given.numer().unsigned_abs(), given.denom().unsigned_abs());
    let most = MAX_SCALE.unsigned_abs();
    let is_within = numerator / denominator.max(1) < most || (numerator, denominator) == (most, 1);
    if !is_within || denominator / numerator.max(1) > most {
        return Err(refused());
    }
    let parts = |numerator: i128, denominator: i128| {
        Ratio::new(i64::try_from(numerator).ok()?, i64::try_from(denominator).ok()?)
    };
    let exact = parts(*given.numer(), *given.denom());
    // As many decimal places as fit.
    let rounded = (0..=PLACES).rev().find_map(|places| {
        let unit = 10_i128.pow(places);
        let whole = round(&Fraction::new(given.numer().checked_mul(unit)?, *given.denom()))?;
        parts(whole.into(), unit)
    });
    exact.or(rounded).ok_or_else(refused)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scale_is_the_decimal_that_it_means() {
        let of = |value: f64| ratio("master_scale", factor("master_scale", value).expect("finite"));
        assert_eq!(of(0.0), Ok(Ratio::ONE));
        assert_eq!(of(0.05).ok(), Ratio::new(1, 20));
        assert_eq!(of(-1.5).ok(), Ratio::new(-3, 2));
        assert_eq!(of(1e6).ok(), Ratio::new(1_000_000, 1));
        assert_eq!(of(1e-6).ok(), Ratio::new(1, 1_000_000));
        // 2^-15 has 15 decimals.
        assert_eq!(of(1.0 / 32_768.0).ok(), Ratio::new(1, 32_768));
        // 22 decimals are rounded to 18: 1234567890123.456789 units of 10^-18.
        assert_eq!(of(1.234_567_890_123_456_7e-6).ok(), Ratio::new(1_234_567_890_123, 1_000_000_000_000_000_000));
        let refused = |value: f64| of(value).expect_err("beyond").to_string();
        assert_eq!(
            refused(1_000_000.5),
            "master_scale is 1000000.5; a scale must be within 0.000001 and 1000000, of either sign; 0 stands for 1"
        );
        // 62 bits hold 17 decimal places of 12, and no more.
        let fine = Fraction::new(123_456_789_012_345_678_901, 10_000_000_000_000_000_000);
        let rounded = ratio("master_scale", fine).ok();
        assert_eq!(rounded, Ratio::new(1_234_567_890_123_456_789, 100_000_000_000_000_000));
        assert!(refused(9.9e-7).contains("a scale must be within"), "{}", refused(9.9e-7));
        assert!(factor("slave_scale", f64::NAN).expect_err("NaN").to_string().starts_with("slave_scale: "));
    }
}

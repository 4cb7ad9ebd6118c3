//! Conversion of requests, in names and units, to commands.
//!
//! Errors of a request itself (an unknown name, an invalid number) are reported here with a message and never reach the
//! machine. The machine refuses motion that limits or states do not allow.

mod choice;
mod error;
mod function;
mod gear_out;
mod homing;
mod meaning;
mod memory;
mod out_an;
mod outputs;
mod phase;
mod rates;
mod saia;
mod setpoints;
mod synchronize;
mod touch_probe;
mod trajectory;
mod verb;

pub use error::RequestError;
pub use function::{FieldValue, FunctionRequest};
pub use gear_out::GearOutRequest;
pub use homing::{HomeRequest, SetPositionRequest};
pub use out_an::OutAnRequest;
pub use phase::PhaseRequest;
pub use rates::Rates;
pub use setpoints::SetpointRequest;
pub use synchronize::{CamRequest, SynchronizeRequest, factor};
pub use touch_probe::{AbortTriggerRequest, TouchProbeRequest};
pub use trajectory::{MAX_START_NS, PointRequest, ToleranceRequest, TrajectoryRequest, ZERO_VELOCITY_TOLERANCE};
pub use verb::{NAMELESS, Named, NewVerb, Presence, UnitOf, Verb, VerbFields};

use self::choice::{chosen, names, number_of};
use crate::command::{Action, BufferMode, Move, MoveMode, Probe, ProbeEdge};
use crate::config::{AxisConfig, IoKind, MachineConfig, max_of_row};
use crate::modulo::Direction;
use crate::object::{AxisSet, Leader, Object, VIRTUAL_MASTER};
use crate::parameter::{self, Applies, Change, ConvertError, MACHINE, ParameterInput, Row, Word};
use crate::text::{allowed_text, expected_text};
pub use crate::unit::{Amount, Units};
use crate::unit::{Scale, UnitError};

/// Modes of a positioning goal.
const MODES: [(&str, MoveMode); 5] = [
    ("absolute", MoveMode::Absolute),
    ("relative", MoveMode::Relative),
    ("additive", MoveMode::Additive),
    ("velocity", MoveMode::Velocity),
    ("superimposed", MoveMode::Superimposed),
];
const BUFFER_MODES: [(&str, BufferMode); 6] = [
    ("aborting", BufferMode::Aborting),
    ("buffered", BufferMode::Buffered),
    ("blending_low", BufferMode::BlendingLow),
    ("blending_previous", BufferMode::BlendingPrevious),
    ("blending_next", BufferMode::BlendingNext),
    ("blending_high", BufferMode::BlendingHigh),
];
const DIRECTIONS: [(&str, Direction); 4] = [
    ("shortest", Direction::Shortest),
    ("positive", Direction::Positive),
    ("negative", Direction::Negative),
    ("current", Direction::Current),
];
const EDGES: [(&str, ProbeEdge); 4] = [
    ("rising", ProbeEdge::Rising),
    ("falling", ProbeEdge::Falling),
    ("both", ProbeEdge::Both),
    ("index", ProbeEdge::Index),
];

impl Units {
    /// All units by name; the place is the number in the interface.
    pub const ALL: [(&'static str, Self); 3] =
        [("si", Self::Si), ("axis_unit", Self::AxisUnit), ("increments", Self::Increments)];

    /// Converts the numbers of the interface.
    ///
    /// # Errors
    /// A number without a meaning.
    pub fn from_number(number: u8) -> Result<Self, RequestError> {
        chosen("units", number, &Self::ALL)
    }
}

/// The requests that are verbs by name, each with its defaults.
pub const REQUESTS: [(&str, NewVerb); 10] = [
    ("move_axis", new::<MoveRequest>),
    ("probe_axis", new::<ProbeRequest>),
    ("touch_probe", new::<TouchProbeRequest>),
    ("abort_trigger", new::<AbortTriggerRequest>),
    ("home_axis", new::<HomeRequest>),
    ("set_position", new::<SetPositionRequest>),
    ("synchronize", new::<SynchronizeRequest>),
    ("phase", new::<PhaseRequest>),
    ("gear_out", new::<GearOutRequest>),
    ("out_an", new::<OutAnRequest>),
];

fn new<V: Verb + Default + 'static>() -> Box<dyn Verb> {
    Box::<V>::default()
}

/// A positioning goal with names and units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MoveRequest {
    /// Name of the axis.
    pub axis: String,
    /// 0 absolute, 1 relative, 2 additive, 3 velocity, 4 superimposed.
    pub mode: u8,
    /// Units of numbers without a unit.
    pub units: Units,
    /// Target or distance.
    pub position: Amount,
    /// Velocity, acceleration, deceleration and jerk.
    pub rates: Rates,
    /// 0 aborting, 1 buffered, 2 to 5 blending.
    pub buffer_mode: u8,
    /// 0 shortest, 1 positive, 2 negative, 3 current.
    pub direction: u8,
}

/// A touch probe to position, with names and units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProbeRequest {
    /// The search motion as a positioning goal, absolute or relative; its buffer mode and direction are not used.
    pub search: MoveRequest,
    /// Name of the latch.
    pub event: String,
    /// 0 rising, 1 falling, 2 both, 3 the index of the axis itself.
    pub edge: u8,
    /// End of the motion, relative to the latched position.
    pub distance: Amount,
}

impl MoveRequest {
    /// Returns the request of a command, in increments.
    fn of(command: &Move, config: &MachineConfig) -> Self {
        let Move { velocity, acceleration, deceleration, jerk, .. } = *command;
        Self {
            axis: config.name_or_nameless(Object::Axis(command.axis)),
            mode: number_of(&MODES, &command.mode),
            units: Units::default(),
            position: Amount::Increments(command.target),
            rates: Rates::in_increments([velocity, acceleration, deceleration, jerk]),
            buffer_mode: number_of(&BUFFER_MODES, &command.buffer_mode),
            direction: number_of(&DIRECTIONS, &command.direction),
        }
    }

    /// Lists the fields of the motion itself, with its possible modes.
    fn motion_fields(&mut self, modes: &[&'static str], fields: &mut dyn VerbFields) {
        fields.id();
        fields.name("axis", Named::Axis, Presence::Required, &mut self.axis);
        fields.choice("mode", modes, Presence::Written, &mut self.mode);
        fields.units(&mut self.units);
        // Only mode velocity has no position; otherwise a forgotten position would be 0.
        let (position, velocity) = match MODES.get(usize::from(self.mode)) {
            Some((_, MoveMode::Velocity)) => (Presence::Optional, Presence::Written),
            Some(_) => (Presence::Expected, Presence::Optional),
            None => (Presence::Optional, Presence::Optional),
        };
        fields.amount("position", 0, UnitOf::Axis, position, &mut self.position);
        let Rates { velocity: v, acceleration, deceleration, jerk } = &mut self.rates;
        let presences = [velocity, Presence::Optional, Presence::Optional, Presence::Optional];
        for (((key, order), presence), rate) in
            Rates::FIELDS.into_iter().zip(presences).zip([v, acceleration, deceleration, jerk])
        {
            fields.amount(key, order, UnitOf::Axis, presence, rate);
        }
    }
}

impl Verb for MoveRequest {
    fn fields(&mut self, fields: &mut dyn VerbFields) {
        self.motion_fields(&names(&MODES), fields);
        fields.choice("direction", &names(&DIRECTIONS), Presence::Optional, &mut self.direction);
        fields.choice("buffer_mode", &names(&BUFFER_MODES), Presence::Optional, &mut self.buffer_mode);
    }

    fn resolve(&self, config: &MachineConfig, recorded: bool) -> Result<Action, RequestError> {
        let resolved = if recorded { config.resolve_recorded_move(self) } else { config.resolve_move(self) };
        resolved.map(Action::Move)
    }
}

impl ProbeRequest {
    /// Returns the request of a command, in increments.
    fn of(command: &Probe, config: &MachineConfig) -> Self {
        Self {
            search: MoveRequest::of(&command.search(), config),
            event: config.name_or_nameless(command.source),
            edge: number_of(&EDGES, &command.edge),
            distance: Amount::Increments(command.distance),
        }
    }
}

impl Verb for ProbeRequest {
    fn fields(&mut self, fields: &mut dyn VerbFields) {
        self.search.motion_fields(&names(&MODES[..2]), fields);
        fields.name("event", Named::Other, Presence::Required, &mut self.event);
        fields.choice("edge", &names(&EDGES), Presence::Optional, &mut self.edge);
        fields.amount("distance", 0, UnitOf::Axis, Presence::Written, &mut self.distance);
    }

    fn resolve(&self, config: &MachineConfig, _recorded: bool) -> Result<Action, RequestError> {
        config.resolve_probe(self).map(Action::Probe)
    }
}

impl MachineConfig {
    /// Returns the verb of a command and its request, with numbers in increments; `None` for the verbs that are not in
    /// [`REQUESTS`].
    pub fn describe(&self, action: &Action) -> Option<(&'static str, Box<dyn Verb>)> {
        Some(match action {
            Action::Move(command) => ("move_axis", Box::new(MoveRequest::of(command, self))),
            Action::Probe(command) => ("probe_axis", Box::new(ProbeRequest::of(command, self))),
            Action::TouchProbe(command) => ("touch_probe", Box::new(TouchProbeRequest::of(command, self))),
            Action::AbortTrigger(command) => ("abort_trigger", Box::new(AbortTriggerRequest::of(command, self))),
            Action::HomeAxis(command) => ("home_axis", Box::new(HomeRequest::of(command, self))),
            Action::SetPosition(_)
            | Action::ShiftPosition(_)
            | Action::SetEncoderPosition(_)
            | Action::SetMasterPosition(_) => ("set_position", Box::new(SetPositionRequest::of(action, self)?)),
            Action::Synchronize(command) => ("synchronize", Box::new(SynchronizeRequest::of(command, self))),
            Action::Phase(command) => ("phase", Box::new(PhaseRequest::of(command, self))),
            Action::GearOut(command) => ("gear_out", Box::new(GearOutRequest::of(command, self))),
            Action::OutAn(command) => ("out_an", Box::new(OutAnRequest::of(command, self))),
            Action::Enable(_)
            | Action::Disable(_)
            | Action::Halt(_)
            | Action::QuickStop(_)
            | Action::Abort
            | Action::ResetErrors(_)
            | Action::Activate
            | Action::Deactivate
            | Action::Trajectory(_)
            | Action::QueryTrajectory(_)
            | Action::Vocabulary(_)
            | Action::Cancel { .. }
            | Action::SetParameters(_)
            | Action::SaveParameters(_)
            | Action::ResetParameters { .. }
            | Action::DeleteParameters(_)
            | Action::PowerCycle
            | Action::SetMemory(_)
            | Action::CommandFunction(_)
            | Action::RunFunction(_)
            | Action::LoadTable { .. }
            | Action::LoadProgram { .. }
            | Action::SetOutputs(_)
            | Action::Refuse(_)
            | Action::Note { .. } => return None,
        })
    }

    /// Returns the axis of that name.
    ///
    /// # Errors
    /// No axis has that name.
    pub fn find_axis(&self, name: &str) -> Result<(u16, &AxisConfig), RequestError> {
        let found = self.axes.iter().enumerate().find(|(_, axis)| axis.name == name);
        found.map(|(index, axis)| (index as u16, axis)).ok_or_else(|| RequestError::UnknownAxis {
            name: crate::unit::excerpt(name),
            known: list(self.axes.iter().map(|axis| axis.name.clone())),
        })
    }

    /// Returns a set of axes by name; all of them for no name.
    ///
    /// # Errors
    /// A name that no axis has.
    pub fn find_axes<S: AsRef<str>>(&self, names: &[S]) -> Result<AxisSet, RequestError> {
        if names.is_empty() {
            return Ok(AxisSet::first(self.axes.len()));
        }
        names.iter().map(|name| self.find_axis(name.as_ref()).map(|(index, _)| index)).collect()
    }

    /// Returns a leader by its name: an axis (its command), `axis.command`, `axis.actual`, an encoder, `function.sink`,
    /// a master that combines several leaders, the virtual master.
    ///
    /// # Errors
    /// No leader has that name.
    pub fn find_leader(&self, name: &str) -> Result<Leader, RequestError> {
        let (object, part) = name.split_once('.').unwrap_or((name, "command"));
        let axis = self.find_axis(object).ok().map(|(index, _)| index);
        let encoder = self.encoders.iter().position(|encoder| encoder.name == name);
        match (axis, part, encoder) {
            (Some(axis), "command", _) => Ok(Leader::AxisCommand(axis)),
            (Some(axis), "actual", _) => Ok(Leader::AxisActual(axis)),
            (_, _, Some(encoder)) => Ok(Leader::Encoder(encoder as u16)),
            (None, "sink", None) if let Ok((slot, _)) = self.find_function(object) => Ok(Leader::Sink(slot)),
            (None, _, None) if let Some(master) = self.masters.iter().position(|master| master.name == name) => {
                Ok(Leader::Sum(master as u16))
            }
            _ if name == VIRTUAL_MASTER => Ok(Leader::Virtual),
            _ => Err(RequestError::UnknownLeader { name: crate::unit::excerpt(name), known: self.leaders() }),
        }
    }

    fn leaders(&self) -> String {
        let axes = self.axes.iter().flat_map(|axis| [axis.name.clone(), format!("{}.actual", axis.name)]);
        let sinks = self.slots.iter().map(|slot| format!("{}.sink", slot.name));
        let encoders = self.encoders.iter().map(|encoder| encoder.name.clone());
        let masters = self.masters.iter().map(|master| master.name.clone());
        list(axes.chain(encoders).chain(sinks).chain(masters).chain([VIRTUAL_MASTER.to_owned()]))
    }

    /// Converts a positioning goal to a command.
    ///
    /// # Errors
    /// An error in the request itself.
    pub fn resolve_move(&self, request: &MoveRequest) -> Result<Move, RequestError> {
        let resolved = self.resolve_recorded_move(request)?;
        let (_, axis) = self.find_axis(&request.axis)?;
        meaning::check_move(request, &resolved, axis).map(|()| resolved)
    }

    /// Converts a recorded goal like [`MachineConfig::resolve_move`]: older programs accepted fields without a meaning.
    ///
    /// # Errors
    /// An error in the request itself.
    pub fn resolve_recorded_move(&self, request: &MoveRequest) -> Result<Move, RequestError> {
        let (index, axis) = self.find_axis(&request.axis)?;
        let (units, scale) = (request.units, &axis.scale);
        // The first one of several errors is reported, in the order of the fields.
        let mode = chosen("mode", request.mode, &MODES)?;
        let target = request.position.length(units, scale).map_err(|error| bad_value("position", error))?;
        let [velocity, acceleration, deceleration, jerk] = request.rates.resolve(units, scale)?;
        Ok(Move {
            axis: index,
            mode,
            target,
            velocity,
            acceleration,
            deceleration,
            jerk,
            direction: chosen("direction", request.direction, &DIRECTIONS)?,
            buffer_mode: buffer_mode(request.buffer_mode)?,
        })
    }

    /// Returns a latch by its name: an input with `latch: true`, an encoder, an axis with a drive.
    ///
    /// # Errors
    /// No latch has that name.
    pub fn find_latch(&self, name: &str) -> Result<Object, RequestError> {
        let found = self.latches().find(|(known, _)| *known == name).map(|(_, object)| object);
        found.ok_or_else(|| RequestError::UnknownLatch {
            name: crate::unit::excerpt(name),
            known: list(self.latches().map(|(name, _)| name.to_owned())),
        })
    }

    fn latches(&self) -> impl Iterator<Item = (&str, Object)> {
        let io = self.io.iter().zip(0..).filter(|(io, _)| io.kind == IoKind::DigitalInput && io.latch);
        let encoders = self.encoders.iter().zip(0..);
        let axes = self.axes.iter().zip(0..).filter(|(axis, _)| axis.drive.is_some());
        io.map(|(io, index)| (io.name.as_str(), Object::Io(index)))
            .chain(encoders.map(|(encoder, index)| (encoder.name.as_str(), Object::Encoder(index))))
            .chain(axes.map(|(axis, index)| (axis.name.as_str(), Object::Axis(index))))
    }

    /// Converts a touch probe to position to a command.
    ///
    /// # Errors
    /// An error in the request itself.
    pub fn resolve_probe(&self, request: &ProbeRequest) -> Result<Probe, RequestError> {
        let search =
            self.resolve_recorded_move(&MoveRequest { buffer_mode: 0, direction: 0, ..request.search.clone() })?;
        let relative = match search.mode {
            MoveMode::Absolute => false,
            MoveMode::Relative => true,
            _ => {
                let allowed = "0 ABSOLUTE, 1 RELATIVE are allowed";
                return Err(RequestError::BadChoice { field: "mode", value: request.search.mode.into(), allowed });
            }
        };
        let source = self.find_latch(&request.event)?;
        let edge = self.probe_edge(request.edge, search.axis, source)?;
        let (_, axis) = self.find_axis(&request.search.axis)?;
        Ok(Probe {
            axis: search.axis,
            relative,
            target: search.target,
            velocity: search.velocity,
            acceleration: search.acceleration,
            deceleration: search.deceleration,
            jerk: search.jerk,
            source,
            edge,
            distance: request
                .distance
                .length(request.search.units, &axis.scale)
                .map_err(|error| bad_value("distance", error))?,
        })
    }

    /// Returns the edge of that number, for a latch of an axis.
    fn probe_edge(&self, edge: u8, axis: u16, source: Object) -> Result<ProbeEdge, RequestError> {
        match chosen("edge", edge, &EDGES)? {
            ProbeEdge::Index if source != Object::Axis(axis) => {
                let allowed = "INDEX is that of the axis itself, which event has to name";
                Err(RequestError::BadChoice { field: "edge", value: edge.into(), allowed })
            }
            edge => Ok(edge),
        }
    }

    /// Converts a parameter `axis.key` and a value to a change.
    ///
    /// # Errors
    /// A name that no parameter has, a value of the wrong type or unit; the machine checks ranges.
    pub fn resolve_parameter(&self, name: &str, input: &ParameterInput) -> Result<Change, RequestError> {
        let (axis, row, entry, scale) = self.find_parameter(name)?;
        let value = parameter::convert(entry, &scale, input).map_err(|error| match error {
            // The range of the row is more specific than the common range of all rates.
            ConvertError::Unit(UnitError::RateTooHigh { given, .. }) => RequestError::BadParameter {
                name: name.to_owned(),
                value: given.to_string(),
                allowed: allowed_text(entry, &scale, max_of_row(entry, self.cycle_ns)),
            },
            error => error.named(name, entry, &scale),
        })?;
        Ok(Change { axis, row, value })
    }

    /// Returns the parameter of that name, `axis.key`: its axis or [`MACHINE`], its row with its index, and the scale
    /// of the axis.
    ///
    /// # Errors
    /// A name that no parameter has.
    pub fn find_parameter(&self, name: &str) -> Result<(u16, u16, &'static Row, Scale), RequestError> {
        let unknown = |hint: String| RequestError::UnknownParameter { name: crate::unit::excerpt(name), hint };
        let (object, key) = name.split_once('.').ok_or_else(|| unknown("; parameters are written axis.key".into()))?;
        let is_machine = object == "machine";
        let axis = if is_machine { None } else { Some(self.find_axis(object)?) };
        let meant = || Word::find(key).map_or(String::new(), |word| format!("; {}", word.text(Some(object))));
        let (row, entry) = Row::find(key).ok_or_else(|| unknown(meant()))?;
        let applies = axis.map_or(entry.applies == Applies::Machine, |(_, axis)| entry.applies.to(axis));
        if !applies {
            return Err(RequestError::NotApplicable { name: name.to_owned(), allowed: entry.applies.text() });
        }
        let scale = axis.map_or(Scale::increments(), |(_, axis)| axis.scale);
        Ok((axis.map_or(MACHINE, |(index, _)| index), row, entry, scale))
    }
}

impl ConvertError {
    fn named(self, name: &str, row: &Row, scale: &Scale) -> RequestError {
        match self {
            Self::Unit(error) => RequestError::BadValue { field: name.to_owned(), error: Box::new(error) },
            Self::Type(value) => {
                RequestError::BadParameter { name: name.to_owned(), value, allowed: expected_text(row, scale) }
            }
        }
    }
}

fn bad_value(field: &str, error: UnitError) -> RequestError {
    RequestError::BadValue { field: field.to_owned(), error: Box::new(error) }
}

fn buffer_mode(mode: u8) -> Result<BufferMode, RequestError> {
    chosen("buffer_mode", mode, &BUFFER_MODES).map_err(|_| RequestError::BadChoice {
        field: "buffer_mode",
        value: mode.into(),
        allowed: "0 ABORTING, 1 BUFFERED, 2 to 5 BLENDING are allowed",
    })
}

fn list(names: impl Iterator<Item = String>) -> String {
    let names: Vec<String> = names.collect();
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

#[cfg(test)]
mod tests;

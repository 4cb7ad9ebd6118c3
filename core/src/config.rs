//! Configuration of a machine, in units of the core.

mod drives;
mod error;
mod functions;
mod masters;
mod numbers;
mod outputs;
mod slots;
mod switches;

pub use error::{AnalogProblem, ConfigError, GantryProblem, PitchProblem};
pub use functions::{Function, OutputOwner, OutputShared};
pub use masters::{MAX_MASTERS, MAX_MEMBERS, SumConfig, SumProblem, sums};
pub use numbers::{IoCounts, NoSuchIo, missing_io_text};
pub use slots::{
    FUEL, Line, MAX_FACTOR, MAX_FUEL, MAX_SLOTS, MAX_WINDOW, ProgramConfig, SinkConfig, SlotConfig, SlotProblem,
    SourceConfig, TableConfig,
};

use crate::axis::{
    AxisSetup, BrakeConfig, ENABLE_TIMEOUT_NS, MISSED_CYCLES, Safety, Wired, may_be_analog, may_carry, may_close_loop,
    may_find_velocity, may_name, may_output_sign, may_read, may_turn_loop,
};
use crate::code::Code;
use crate::drive::{AnalogWiring, Capabilities, Interface, SpeedOutputs};
use crate::encoder::{Form, PulseCheck};
use crate::modulo::Modulo;
use crate::object::{MAX_AXES, Object};
use crate::parameter::{Applies, AxisParameters, Contradiction, MachineParameters, Row};
use crate::regulator::Law;
use crate::table::{PitchError, Table};
use crate::unit::{Fraction, Scale, fraction_to_f64};
use crate::vocabulary::{self, Setting, Wiring};
use drives::{check_drive, check_gantry};

/// Maximum increments that an axis may move in one cycle.
const MOST_PER_CYCLE: f64 = (1_u64 << 31) as f64;

/// Returns the maximum velocity for that cycle time (inc/s).
pub fn max_velocity_of_cycle(cycle_ns: u64) -> f64 {
    MOST_PER_CYCLE * 1e9 / cycle_ns as f64
}

/// Returns the upper limit of a parameter row for that cycle time (inc/s); `None` for rows that are no limit of a
/// velocity.
pub fn max_of_row(row: &Row, cycle_ns: u64) -> Option<f64> {
    row.is_bound_by_cycle().then(|| max_velocity_of_cycle(cycle_ns))
}

/// Kind of an input or output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IoKind {
    /// Digital input.
    DigitalInput,
    /// Digital output.
    DigitalOutput,
    /// Analog input (V).
    AnalogInput,
    /// Analog output (V).
    AnalogOutput,
}

/// An entry of `io`.
#[derive(Clone, Debug, PartialEq)]
pub struct IoConfig {
    /// Name.
    pub name: String,
    /// Kind of the entry.
    pub kind: IoKind,
    /// Whether its edges are latched.
    pub latch: bool,
}

/// Type of a memory cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MemoryKind {
    /// 16-bit signed.
    I16,
    /// 32-bit signed.
    I32,
    /// 64-bit signed.
    I64,
    /// Real.
    F64,
    /// 0 or 1.
    Bit,
}

/// An entry of `memory`.
#[derive(Clone, Debug, PartialEq)]
pub struct MemoryConfig {
    /// Name.
    pub name: String,
    /// Type of the cell.
    pub kind: MemoryKind,
    /// Initial value.
    pub initial: f64,
}

/// An entry of `encoders`.
#[derive(Clone, Debug, PartialEq)]
pub struct EncoderConfig {
    /// Name.
    pub name: String,
    /// Form of its process data.
    pub form: Form,
    /// Supervision of its pulses by the index pulse.
    pub check: Option<PulseCheck>,
    /// Conversion of increments to units.
    pub scale: Scale,
}

/// An entry of `axes`.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisConfig {
    /// Name.
    pub name: String,
    /// Conversion of increments to units.
    pub scale: Scale,
    /// Length of a turn.
    pub modulo: Option<Modulo>,
    /// Capabilities of its drive, as reported by the backend; `None` for a virtual axis.
    pub drive: Option<Capabilities>,
    /// Capabilities of its second drive; `None` for an axis with one drive.
    pub second: Option<Capabilities>,
    /// Command interface of its drive.
    pub interface: Interface,
    /// Control law of the position loop, if it is closed in this program.
    pub law: Law,
    /// Tolerated number of cycles without new data from its drive.
    pub missed_cycles: u32,
    /// Maximum time for its drive to reach operation enabled and report its mode of operation (ns).
    pub enable_timeout_ns: u64,
    /// Mode of operation (6060h) that replaces the cyclic mode of its interface; `None`: the cyclic mode.
    pub drive_mode: Option<i8>,
    /// Connections of its vocabularies.
    pub vocabularies: Wiring,
    /// Outputs of an open-loop axis.
    pub open_loop: SpeedOutputs,
    /// Wiring of a drive without a bus.
    pub analog: Option<AnalogWiring>,
    /// Source of its position.
    pub wired: Wired,
    /// Brake that the axis controls.
    pub brake: Option<BrakeConfig>,
    /// Index of its pitch error table in `tables`.
    pub pitch_error: Option<u16>,
    /// Parameters of the cell: layer Init.
    pub parameters: AxisParameters,
    /// Layer User at the start, if parameters were saved.
    pub saved: Option<AxisParameters>,
}

impl AxisConfig {
    /// Returns an axis in closed loop without further connections.
    pub fn new(name: String, scale: Scale, drive: Option<Capabilities>, parameters: AxisParameters) -> Self {
        Self {
            name,
            scale,
            modulo: None,
            drive,
            second: None,
            interface: Interface::Position,
            law: Law::default(),
            missed_cycles: MISSED_CYCLES,
            enable_timeout_ns: ENABLE_TIMEOUT_NS,
            drive_mode: None,
            vocabularies: Wiring::default(),
            open_loop: SpeedOutputs::default(),
            analog: None,
            wired: Wired::default(),
            brake: None,
            pitch_error: None,
            parameters,
            saved: None,
        }
    }

    /// Returns the outputs that the axis controls directly, by their indices in section `io`.
    fn own_outputs(&self) -> [Option<u16>; 7] {
        let SpeedOutputs { forward, backward, output, dac } = self.open_loop;
        let (reference, enable) = self.analog.map(|analog| (analog.reference, analog.enable)).unzip();
        [forward, backward, output, dac, self.brake.map(|brake| brake.output), reference, enable]
    }

    /// Checks whether a table can be the pitch error of the axis.
    ///
    /// # Errors
    /// The problem of the table.
    pub fn check_pitch_error(&self, table: &Table) -> Result<(), PitchError> {
        table.check_pitch(self.modulo.map(Modulo::length))
    }

    /// Returns the parameters that are active at the start.
    pub fn power_on(&self) -> AxisParameters {
        self.saved.unwrap_or(self.parameters)
    }

    /// Returns the increments per axis unit, rounded to f64.
    pub fn increments_per_unit(&self) -> f64 {
        let one = self.scale.unit().times(Fraction::from_integer(1));
        one.and_then(|one| self.scale.exact(&one)).map_or(1.0, |exact| fraction_to_f64(&exact))
    }
}

impl Applies {
    /// Returns true if it applies to that axis.
    pub fn to(self, axis: &AxisConfig) -> bool {
        self.to_interface(axis.drive.map(|_| axis.interface), axis.law, axis.second.is_some())
    }
}

/// Time for which a digital input must keep a level before it is accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilterConfig {
    /// Index among the digital inputs.
    pub input: usize,
    /// Filter time (ns).
    pub time_ns: u64,
}

/// A digital input without a terminal: it reads an output of the machine, as the previous cycle left it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VirtualInput {
    /// Index among the digital inputs.
    pub input: usize,
    /// Index of the output in section `io`.
    pub output: u16,
}

/// Full scale of an analog input or output; 10 V without an entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FullScale {
    /// Index of the input or output in section `io`.
    pub entry: u16,
    /// Full scale (V), above 0, in both directions.
    pub volts: f64,
}

/// Configuration that belongs to no axis.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct GlobalConfig {
    /// Parameters of the cell: layer Init.
    pub parameters: MachineParameters,
    /// Layer User at the start, if parameters were saved.
    pub saved: Option<MachineParameters>,
    /// Filtered digital inputs.
    pub filters: Vec<FilterConfig>,
    /// Digital inputs that read an output.
    pub virtual_inputs: Vec<VirtualInput>,
    /// Full scales of the cell.
    pub full_scales: Vec<FullScale>,
    /// Entries of section `encoders`, and axes for the encoders of their drives, without index pulses.
    pub without_index: Vec<Object>,
    /// Axes whose drives report no digital inputs (60FDh): switches at these drives are not read.
    pub without_inputs: Vec<Object>,
    /// Indices of the tables that the cell declares as cams (key `cam`): numbers that form no cam are rejected.
    pub cams: Vec<u16>,
}

impl GlobalConfig {
    /// Returns the parameters that are active at the start.
    pub fn power_on(&self) -> MachineParameters {
        self.saved.unwrap_or(self.parameters)
    }
}

/// Configuration of a machine.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct MachineConfig {
    /// Cycle time (ns), 125 000 to 20 000 000.
    pub cycle_ns: u64,
    /// Inputs and outputs.
    pub io: Vec<IoConfig>,
    /// Memory cells.
    pub memory: Vec<MemoryConfig>,
    /// Encoders.
    pub encoders: Vec<EncoderConfig>,
    /// Tables.
    pub tables: Vec<TableConfig>,
    /// User programs.
    pub programs: Vec<ProgramConfig>,
    /// Function slots, ordered by number.
    pub slots: Vec<SlotConfig>,
    /// Masters that combine several leaders.
    pub masters: Vec<SumConfig>,
    /// Axes.
    pub axes: Vec<AxisConfig>,
    /// Contacts that must be closed, by their indices among the digital inputs.
    pub safety: Safety,
    /// Configuration that belongs to no axis.
    pub global: GlobalConfig,
}

impl MachineConfig {
    /// Checks the rules that apply to every machine.
    ///
    /// # Errors
    /// The first violation.
    pub fn check(&self) -> Result<(), ConfigError> {
        if !(125_000..=20_000_000).contains(&self.cycle_ns) {
            return Err(ConfigError::Cycle(self.cycle_ns));
        }
        self.check_numbers()?;
        self.check_outputs_once()?;
        let most = usize::from(u16::MAX);
        let counts = [
            ("axes", self.axes.len(), MAX_AXES),
            ("io", self.io.len(), most),
            ("memory cells", self.memory.len(), most),
            ("encoders", self.encoders.len(), most),
            ("tables", self.tables.len(), most),
            ("programs", self.programs.len(), MAX_SLOTS),
            ("functions", self.slots.len(), MAX_SLOTS),
            ("masters", self.masters.len(), MAX_MASTERS),
        ];
        for (what, count, most) in counts {
            if count > most {
                return Err(ConfigError::TooMany { what, count, most });
            }
        }
        for (place, axis) in self.axes.iter().enumerate() {
            let name = || axis.name.clone();
            if let Some(offers) = axis.drive {
                check_drive(axis, &offers)?;
            }
            if let Some(offers) = axis.second {
                check_drive(axis, &offers)?;
                check_gantry(axis, &offers)?;
            }
            self.check_outputs(axis)?;
            self.check_pitch_error(axis)?;
            for parameters in [Some(axis.parameters), axis.saved].into_iter().flatten() {
                parameters.check().map_err(|contradiction| match contradiction {
                    Contradiction::Above(low, high) => ConfigError::Contradiction { axis: name(), low, high },
                    Contradiction::OutOfRange(key) => ConfigError::Derived { axis: name(), key },
                    Contradiction::NotBuilt(key, code) => ConfigError::NotImplemented { axis: name(), key, code },
                })?;
                may_read(axis.wired, self.encoders.len(), axis.drive.map(|_| axis.interface), &parameters)
                    .and_then(|()| {
                        let interface = axis.drive.map(|_| axis.interface);
                        may_close_loop(interface, axis.law, &parameters, self.cycle_ns)?;
                        let sources = (axis.wired, self.encoders.len());
                        may_be_analog(axis.analog.as_ref(), axis.interface, sources, &parameters)?;
                        may_find_velocity(place, interface, sources, axis.second.is_some(), &parameters)
                    })
                    .and_then(|()| may_name(place, self.axes.len(), self.encoders.len(), &parameters))
                    .map_err(|(key, code)| ConfigError::NotImplemented { axis: name(), key, code })?;
                if !may_turn_loop(axis.drive.map(|_| axis.interface), &parameters) {
                    return Err(ConfigError::NotImplemented {
                        axis: name(),
                        key: "posdrct",
                        code: Code::LOOP_IN_DRIVE,
                    });
                }
                if !may_output_sign(axis.drive.map(|_| axis.interface), &parameters) {
                    let code = Code::REVERSING_BY_POSITION;
                    return Err(ConfigError::NotImplemented { axis: name(), key: "revers", code });
                }
                if axis.second.is_some() {
                    may_carry(axis.wired, &parameters).map_err(|(key, code)| ConfigError::NotImplemented {
                        axis: name(),
                        key,
                        code,
                    })?;
                }
                vocabulary::check(&parameters, &self.setting(axis))
                    .map_err(|problem| ConfigError::Selector { axis: name(), key: problem.key() })?;
            }
        }
        self.check_inputs()?;
        self.check_slots()?;
        self.check_sums()?;
        self.check_masters()
    }

    /// Sets in the parameters of each axis which of its sources are absolute.
    pub(crate) fn set_absolute_sources(&mut self) {
        for axis in &mut self.axes {
            let entry = |place| self.encoders.get(usize::from(place)).map(|encoder: &EncoderConfig| encoder.form);
            let sources = axis.wired.absolute_sources(entry);
            axis.parameters = axis.parameters.with_sources(sources);
            axis.saved = axis.saved.map(|saved| saved.with_sources(sources));
        }
    }

    /// Checks the contacts of section safety, and the inputs that read an output.
    fn check_inputs(&self) -> Result<(), ConfigError> {
        let count = self.count_io(IoKind::DigitalInput);
        for &VirtualInput { input, output } in &self.global.virtual_inputs {
            let read = self.io.get(usize::from(output)).map(|io| io.kind);
            if input >= count || read != Some(IoKind::DigitalOutput) {
                return Err(ConfigError::VirtualInput { input: input.saturating_add(1), count, output });
            }
        }
        for (key, place) in [("estop", self.safety.estop), ("interlock", self.safety.interlock)] {
            let Some(place) = place else { continue };
            if place as usize >= count {
                return Err(ConfigError::Contact { key, place });
            }
            if self.is_virtual_input(place as usize) {
                return Err(ConfigError::VirtualContact { key, place });
            }
        }
        Ok(())
    }

    /// Returns true if a digital input, by its index, reads an output.
    pub fn is_virtual_input(&self, place: usize) -> bool {
        self.global.virtual_inputs.iter().any(|read| read.input == place)
    }

    /// Returns the properties of an axis that its vocabularies need.
    pub fn setting(&self, axis: &AxisConfig) -> Setting {
        let unit = axis.increments_per_unit();
        let is_virtual = axis.drive.is_none();
        Setting { modulo: axis.modulo, unit, cycle_ns: self.cycle_ns, wiring: axis.vocabularies, is_virtual }
    }

    /// Checks that the table of an axis holds pitch errors, and that its drive has a position loop for them.
    fn check_pitch_error(&self, axis: &AxisConfig) -> Result<(), ConfigError> {
        let Some(place) = axis.pitch_error else { return Ok(()) };
        let refuse = |problem| Err(ConfigError::Pitch { axis: axis.name.clone(), problem });
        if !Applies::Positioned.to(axis) {
            return refuse(PitchProblem::Interface);
        }
        let Some(table) = self.tables.get(usize::from(place)) else { return refuse(PitchProblem::Table(place)) };
        axis.check_pitch_error(&table.table).or_else(|error| refuse(PitchProblem::Points(error)))
    }

    /// Checks that every input and output exists that parameters name by number.
    fn check_numbers(&self) -> Result<(), ConfigError> {
        let counts = IoCounts::of(self);
        for parameters in [Some(self.global.parameters), self.global.saved].into_iter().flatten() {
            if let Err(missing) = counts.check_machine(&parameters) {
                return Err(missing.of(None));
            }
            parameters.check_virtual_begin(self.axes.len()).map_err(ConfigError::VirtualMaster)?;
        }
        for axis in &self.axes {
            for parameters in [Some(axis.parameters), axis.saved].into_iter().flatten() {
                if let Err(missing) = counts.check_axis(&parameters) {
                    return Err(missing.of(Some(axis.name.clone())));
                }
            }
        }
        Ok(())
    }

    /// Returns the name of an object.
    pub fn name(&self, object: Object) -> &str {
        let name = match object {
            Object::Machine => None,
            Object::Io(index) => self.io.get(usize::from(index)).map(|entry| &entry.name),
            Object::Memory(index) => self.memory.get(usize::from(index)).map(|entry| &entry.name),
            Object::Encoder(index) => self.encoders.get(usize::from(index)).map(|entry| &entry.name),
            Object::Axis(index) => self.axes.get(usize::from(index)).map(|entry| &entry.name),
            Object::Function(index) => self.slots.get(usize::from(index)).map(|entry| &entry.name),
            Object::Table(index) => self.tables.get(usize::from(index)).map(|entry| &entry.name),
            Object::Program(index) => self.programs.get(usize::from(index)).map(|entry| &entry.name),
        };
        name.map_or("machine", String::as_str)
    }

    /// Returns the number of entries of `io` of that kind.
    pub fn count_io(&self, kind: IoKind) -> usize {
        self.io.iter().filter(|entry| entry.kind == kind).count()
    }

    /// Returns the entries of `io` that are digital inputs: input n of parameters such as i_refswitch is the n-th of
    /// them, from 1.
    pub fn digital_inputs(&self) -> impl Iterator<Item = u16> {
        let is_input = |(_, entry): &(u16, &IoConfig)| entry.kind == IoKind::DigitalInput;
        (0_u16..).zip(&self.io).filter(is_input).map(|(place, _)| place)
    }

    /// Returns the index of an entry of `io` among those of its kind: its bit or its index in the arrays of a backend.
    pub fn io_place(&self, index: usize) -> usize {
        let kind = self.io.get(index).map(|entry| entry.kind);
        self.io[..index.min(self.io.len())].iter().filter(|entry| Some(entry.kind) == kind).count()
    }

    /// Returns the axes whose homing searches for a switch without any limit of time or distance.
    pub fn unlimited_searches(&self) -> impl Iterator<Item = &AxisConfig> {
        self.axes.iter().filter(|axis| {
            let p = &axis.parameters;
            let seeks = crate::axis::homing_methods::seeks_switch(p.homing.method);
            seeks && axis.modulo.is_none() && p.homing_max_distance().is_none() && p.homing.max_time == 0
        })
    }

    /// Returns the setups of the axes, in file order.
    pub(crate) fn setups(&self) -> Vec<AxisSetup> {
        let mut drives = 0..;
        let drive_count = self.count_driven() as u32;
        let mut gantries = 0..;
        self.axes
            .iter()
            .enumerate()
            .map(|(index, axis)| AxisSetup {
                index: index as u16,
                drive: axis.drive.and_then(|offers| drives.next().map(|place| (place, offers))),
                gantry: axis.second.and_then(|_| gantries.next()),
                modulo: axis.modulo,
                interface: axis.interface,
                law: axis.law,
                missed_cycles: axis.missed_cycles,
                enable_timeout_ns: axis.enable_timeout_ns,
                unit: axis.increments_per_unit(),
                vocabularies: axis.vocabularies,
                open_loop: axis.open_loop,
                analog: axis.analog,
                safety: self.safety,
                round: (self.axes[..index].iter().filter(|axis| axis.drive.is_some()).count() as u32, drive_count),
                wired: axis.wired,
                encoders: self.encoders.len(),
                brake: axis.brake,
                pitch_error: axis.pitch_error,
                cycle_ns: self.cycle_ns,
            })
            .collect()
    }
}

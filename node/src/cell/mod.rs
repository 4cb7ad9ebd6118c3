//! Reads a cell, the description of a machine, from YAML (contract section 3).
//!
//! A cell is read completely and all its errors are reported at once. Names are resolved to units and handles of the
//! core here; the core uses neither units nor names.
//!
//! ```
//! use lineshaft::cell::Cell;
//!
//! let text = "lineshaft: 1\ncycle: 1 ms\naxes:\n  line: {type: linear, drive: virtual, scale: {increments: 1000, per: 1 mm},\n    \
//!             max_velocity: 3 m/s, max_acceleration: 5 m/s}\n";
//! assert_eq!(
//!     Cell::parse("cell.yaml", text).unwrap_err().to_string(),
//!     "cell.yaml:5:44: max_acceleration: `5 m/s` is a velocity; an acceleration such as `5 m/s^2` is expected\n"
//! );
//! let cell = Cell::parse("cell.yaml", text.replace("5 m/s}", "5 m/s^2}")).unwrap();
//! assert_eq!(cell.machine.axes[0].parameters.max_velocity, 3e6);
//! ```

mod amc;
mod analog;
mod axes;
mod backends;
mod brake;
mod buses;
mod can;
mod compensation;
mod devices;
mod drives;
mod encoders;
mod fixtures;
mod functions;
mod groups;
mod joints;
mod loops;
mod machine;
mod marks;
mod masters;
mod models;
mod names;
mod parameters;
mod preset;
mod programs;
mod record_topics;
mod regulator;
mod robot;
mod ros;
mod row;
mod safety;
mod scale;
mod tables;
mod terminals;
mod times;
mod wiring;

#[cfg(test)]
use crate::document::Observer;
use crate::document::{Document, Problems, Value};
pub(crate) use backends::WITH_OBJECTS;
use backends::{Backend, Context};
pub use backends::{BackendKind, CellBackend, DriveKeys, Hardware};
pub use buses::{CanBuses, DeviceFindings};
pub(crate) use buses::{device_file, left_out_of, mode_by_sdo_of, passed_over};
pub(crate) use can::owner;
pub use can::{CellBus, CellDrive};
pub(crate) use groups::trajectory_limits;
use lineshaft_core::axis::Safety;
use lineshaft_core::config::{AxisConfig, GlobalConfig, MachineConfig, ProgramConfig};
use lineshaft_core::drive::{BackendObject, Objects};
use lineshaft_core::object::Object;
use lineshaft_core::sim::{Mechanics, Model, Plant};
use lineshaft_ros::surface::{Group, JointNames};
pub(crate) use machine::{refuse_missing, refuse_virtual_master};
pub use marks::CellMarks;
use names::{Names, Section, quote};
pub(crate) use parameters::{contradictions, double_views, inverted_limits, refuse_senses};
pub use preset::Preset;
pub use record_topics::RecordTopics;
pub use robot::Robot;
pub use ros::{OnLoss, RosOptions};
use std::collections::BTreeMap;
use std::path::Path;
#[cfg(test)]
use std::sync::Arc;
pub(crate) use tables::{Files, listed, table};
pub use terminals::CellTerminal;

/// Format version that this program reads.
const FORMAT: &str = "1";
/// Cell that is used without a file.
const DEMO: &str = include_str!("../../../launch-configs/demo.yaml");
/// Robot description of that cell.
const DEMO_ROBOT: &str = include_str!("../../../launch-configs/demo.urdf");

/// A cell without errors.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Configuration of the core.
    pub machine: MachineConfig,
    /// Simulation models of the drives, in their order.
    pub models: Vec<Model>,
    /// Simulated mechanics of the drives, in their order.
    pub mechanics: Vec<Mechanics>,
    /// Printed marks that digital inputs detect in the simulation.
    pub marks: Vec<CellMarks>,
    /// Joint names of the axes.
    pub joint_names: JointNames,
    /// Location of the drive of each axis, in the order of the file; `None` for a virtual axis.
    pub hardware: Vec<Option<Hardware>>,
    /// Location of the second drive of each axis, in the order of the file; `None` for an axis with one drive.
    pub second_hardware: Vec<Option<Hardware>>,
    /// Keys of the drives that only their backends have, in the order of the drives; `None` for a drive without.
    pub drive_keys: Vec<Option<DriveKeys>>,
    /// Inputs, outputs and encoders at devices.
    pub terminals: Vec<CellTerminal>,
    /// Options of the ROS 2 node.
    pub ros: RosOptions,
    /// Groups of axes, in the order of the file.
    pub groups: Vec<Group>,
    /// Backends, in the order of the file.
    pub backends: Vec<CellBackend>,
    /// Text of the file.
    pub text: String,
    /// CSV files of the tables and modules of the programs, by their names in the cell; a module as text.
    pub files: BTreeMap<String, String>,
    /// Robot description that `ros` names; `None` if the cell was read from a text, which has no files next to it.
    pub robot: Option<Robot>,
    /// Warnings about numbers without a unit in axes that people read in another unit than SI, with their locations.
    pub bare_numbers: Vec<String>,
}

impl Cell {
    /// Reads a file, and the robot description that it names.
    ///
    /// # Errors
    /// Returns all errors of the file, at least one problem.
    pub fn load(path: &Path) -> Result<Self, Problems> {
        Self::load_within(path, None)
    }

    /// Does the same as [`Cell::load`], within the limits of a preset if one is given.
    ///
    /// # Errors
    /// Returns all errors of the file, at least one problem; those of the preset only if there are no others.
    pub fn load_within(path: &Path, preset: Option<Preset>) -> Result<Self, Problems> {
        let files = Files::in_folder_of(path);
        let mut cell = Self::of(Document::read(path), &files, preset)?;
        cell.files = files.into_read();
        let folder = path.parent().unwrap_or(Path::new(""));
        let robot = cell.ros.robot_description.as_ref().map(|file| Robot::load(&folder.join(file)));
        cell.robot = robot.transpose()?;
        Ok(cell)
    }

    /// Reads a text; `name` is the file name in problems.
    ///
    /// # Errors
    /// Returns all errors of the text, at least one problem.
    pub fn parse(name: &str, text: impl Into<String>) -> Result<Self, Problems> {
        Self::of(Document::parse(name, text), &Files::None, None)
    }

    /// Reads a text as if it were that file, with the tables and programs next to it, and without its robot
    /// description.
    ///
    /// # Errors
    /// Returns all errors of the text, at least one problem.
    pub(crate) fn parse_in_folder(path: &Path, text: &str) -> Result<Self, Problems> {
        Self::of(Document::parse(&path.display().to_string(), text), &Files::in_folder_of(path), None)
    }

    /// Reads the text of a recording, with the attached files of its tables.
    ///
    /// # Errors
    /// Returns all errors of the text, at least one problem.
    pub fn parse_recorded(name: &str, text: impl Into<String>, files: Option<&str>) -> Result<Self, Problems> {
        let files = files.map_or(Ok(Files::None), tables::files_of)?;
        let mut cell = Self::of(Document::parse(name, text), &files, None)?;
        cell.files = files.into_read();
        Ok(cell)
    }

    /// Returns the names of its programs, with the SHA-256 of each module.
    pub fn programs(&self) -> Vec<(String, String)> {
        let hash = |program: &ProgramConfig| (program.name.clone(), crate::recording::sha256(program.module.bytes()));
        self.machine.programs.iter().map(hash).collect()
    }

    /// Returns the files of its tables and programs as one text, for attachment to a recording; `None` without files.
    pub fn files_text(&self) -> Option<String> {
        (!self.files.is_empty()).then(|| tables::files_text(&self.files))
    }

    /// Returns the built-in cell: launch-configs/demo.yaml, with demo.urdf next to it.
    pub fn demo() -> Self {
        let cell = Self::parse("demo.yaml", DEMO).expect("the text is fixed, and a test reads it");
        let robot = Robot::parse("demo.urdf", DEMO_ROBOT.to_owned()).expect("the text is fixed, and a test reads it");
        Self { robot: Some(robot), ..cell }
    }

    /// Returns a simulation of the whole machine, whatever its backends are.
    pub fn plant(&self) -> Plant {
        self.plant_of(|_| true)
    }

    /// Returns a simulation of the objects at some of its backends.
    pub fn plant_of(&self, is_simulated: impl Fn(&CellBackend) -> bool) -> Plant {
        let is_at_simulated = |at: Hardware| self.backends.get(at.backend).is_some_and(&is_simulated);
        let models = self.drives().zip(&self.models);
        let models: Vec<_> = models.map(|(at, model)| is_at_simulated(at).then_some(*model)).collect();
        // Drives that are on no bus: modules of the bus give them their voltage reference.
        let analog = || {
            self.drives().zip(self.machine.drives()).enumerate().filter(|(_, (_, (_, axis, _)))| axis.analog.is_some())
        };
        let objects = |(place, backend): (usize, &CellBackend)| {
            if !is_simulated(backend) {
                return Objects::default();
            }
            let mut objects = backend.objects.clone();
            let here = analog().filter(|(_, (at, _))| at.backend == place && !backend.is_simulated());
            objects.drives.extend(here.map(|(place, (at, _))| BackendObject { place, address: at.address }));
            objects
        };
        let buses = self.backends.iter().enumerate().map(objects).collect();
        let mut plant = Plant::with_buses(&self.machine, &models, buses);
        for (place, mechanics) in self.mechanics.iter().enumerate() {
            plant.attach_mechanics(place, mechanics);
        }
        for CellMarks { input, carrier, marks } in &self.marks {
            plant.print(*input, *carrier, *marks);
        }
        plant
    }

    /// Returns the locations of the drives in their order: first the first drives of all axes, then the second ones.
    pub fn drives(&self) -> impl Iterator<Item = Hardware> {
        self.hardware.iter().chain(&self.second_hardware).flatten().copied()
    }

    /// Returns the name of the drive of each axis: `backend:address`; `backend:address, backend:address` for two
    /// drives; the ao for a drive with voltage reference; `None` for a virtual axis.
    pub fn hardware_names(&self) -> Vec<Option<String>> {
        let name = |at: Hardware| {
            format!("{}:{}", self.backends.get(at.backend).map_or("", |found| &found.name), at.address.device)
        };
        let reference = |axis: &AxisConfig| {
            let entry = axis.analog.map(|analog| self.machine.name(Object::Io(analog.reference)));
            entry.map(str::to_owned)
        };
        let names = |((first, second), axis): ((&Option<Hardware>, &Option<Hardware>), &AxisConfig)| {
            let drives: Vec<_> = [*first, *second].into_iter().flatten().map(name).collect();
            (!drives.is_empty()).then(|| reference(axis).unwrap_or_else(|| drives.join(", ")))
        };
        self.hardware.iter().zip(&self.second_hardware).zip(&self.machine.axes).map(names).collect()
    }

    /// Returns for each axis, in the order of the file, whether it has a drive that is not simulated.
    pub fn real_axes(&self) -> Vec<bool> {
        let is_real = |at: &Hardware| self.backends.get(at.backend).is_some_and(|backend| !backend.is_simulated());
        let of = |(first, second): (&Option<Hardware>, &Option<Hardware>)| first.iter().chain(second).any(is_real);
        self.hardware.iter().zip(&self.second_hardware).map(of).collect()
    }

    /// Returns remarks and warnings about the devices at its backends. `file` is the path of the cell; the files of
    /// devices are relative to it.
    ///
    /// # Errors
    /// Returns all errors of the files and of the devices, and an error if homing needs inputs that are not read.
    pub fn device_findings(&self, file: Option<&Path>) -> Result<DeviceFindings, Problems> {
        self.on_can().findings(file)
    }

    /// Returns its CAN buses.
    pub fn on_can(&self) -> CanBuses<'_> {
        let Self { machine, drive_keys, terminals, backends, .. } = self;
        CanBuses { machine, hardware: self.drives().collect(), drive_keys, terminals, backends }
    }

    /// Does the same as [`Cell::parse_in_folder`]; also returns the values that were read.
    #[cfg(test)]
    pub(crate) fn parse_observed(path: &Path, text: &str) -> (Result<Self, Problems>, Arc<Observer>) {
        let mut document = Document::parse(&path.display().to_string(), text);
        let observer = document.observe();
        (Self::of(document, &Files::in_folder_of(path), None), observer)
    }

    fn of(document: Document, files: &Files, preset: Option<Preset>) -> Result<Self, Problems> {
        let cell = document.root("the cell").and_then(|root| read(&root, document.text(), files, preset));
        match cell {
            Some(cell) if document.problems().is_empty() => Ok(cell),
            _ => Err(document.into_problems()),
        }
    }
}

/// Returns the cell as far as it could be read; it is valid only if no problem was recorded.
fn read(root: &Value<'_>, text: &str, files: &Files, preset: Option<Preset>) -> Option<Cell> {
    let mut map = root.map("the cell")?;
    if ["scenario", "steps", "expect"].iter().any(|key| map.has(key))
        && !["lineshaft", "cycle", "axes"].iter().any(|key| map.has(key))
    {
        let hint = "check it with `lineshaft check CELL --scenario FILE`";
        map.refuse("this looks like a scenario; a cell is expected", Some(hint.to_owned()));
        return None;
    }
    map.required("lineshaft").iter().for_each(check_format);
    let cycle_at = map.required("cycle");
    let cycle_ns = cycle_at.as_ref().and_then(cycle);
    let ros = map.optional("ros").map_or(Some(RosOptions::default()), |value| ros::read(&value));
    let contacts = map.optional("safety");
    let names = Names::read(&mut map);

    let (backends, buses) = backends::read(names.section(Section::Backends));
    let cx = Context { names, backends, cycle_ns };
    let of_io = devices::io(&cx);
    let io = &of_io.entries;
    let mut named = machine::Functions::new();
    let parameters = machine::read(&mut map, io, &mut named, cx.names.section(Section::Axes).len());
    map.finish();
    let memory = devices::memory(&cx);
    let (encoders, encoders_at, encoders_at_devices) = devices::encoders(&cx);
    let mut outputs = names::UsedOnce::new();
    let tables = tables::read(&cx, files);
    let programs = programs::read(&cx, files);
    let masters::Read { sums: mut masters, reads } = masters::read(&cx);
    let objects = functions::Objects { io, memory: &memory, tables: &tables };
    let slots = functions::read(&cx, objects, &mut outputs, reads);
    masters::settle(&mut masters, &slots.slots, &cx);
    let entries = axes::Entries { io: &of_io, encoders: &encoders, encoders_at: &encoders_at, tables: &tables };
    let axes = axes::read(&cx, entries, named, outputs, &slots.chains);
    let safety = contacts.map_or(Some(Safety::default()), |value| safety::read(&value, &cx, io));
    let groups = groups::read(&cx);
    let devices::Io { entries: io, terminals, mut at_devices, filters, virtual_inputs, full_scales, marks } = of_io;
    at_devices.extend(encoders_at_devices);

    let axes: Vec<_> = axes.into_iter().collect::<Option<_>>()?;
    let (mut configs, mut joints) = (Vec::new(), Vec::new());
    let (mut firsts, mut seconds) = (Vec::new(), Vec::new());
    let (mut without_index, mut without_inputs) = (Vec::new(), Vec::new());
    let mut bare_numbers = Vec::new();
    for (place, axes::Axis { config, joint, first, second, bare_numbers: of_axis }) in axes.into_iter().enumerate() {
        if first.as_ref().is_none_or(|drive| !drive.has_index()) {
            without_index.extend(u16::try_from(place).map(Object::Axis));
        }
        if first.as_ref().is_some_and(|drive| drive.has_unread_inputs(&at_devices)) {
            without_inputs.extend(u16::try_from(place).map(Object::Axis));
        }
        configs.push(config);
        joints.push(joint);
        firsts.push(first);
        seconds.push(second);
        // A value with an anchor is read at every alias.
        for warning in of_axis {
            if !bare_numbers.contains(&warning) {
                bare_numbers.push(warning);
            }
        }
    }
    let places =
        |drives: &[Option<axes::Driven>]| drives.iter().map(|drive| drive.as_ref().map(|drive| drive.at)).collect();
    let (hardware, second_hardware): (Vec<_>, Vec<_>) = (places(&firsts), places(&seconds));
    let drives: Vec<axes::Driven> = firsts.into_iter().chain(seconds).flatten().collect();
    for (place, encoder) in encoders.iter().enumerate() {
        if encoder.as_ref().is_some_and(|encoder| encoder.check.is_none()) {
            without_index.extend(u16::try_from(place).map(Object::Encoder));
        }
    }
    let machine = MachineConfig {
        cycle_ns: cycle_ns?,
        io: io.into_iter().collect::<Option<_>>()?,
        memory: memory.into_iter().collect::<Option<_>>()?,
        encoders: encoders.into_iter().collect::<Option<_>>()?,
        tables: tables.into_iter().collect::<Option<_>>()?,
        programs: programs.into_iter().collect::<Option<_>>()?,
        slots: slots.slots.into_iter().collect::<Option<_>>()?,
        masters: masters.into_iter().collect::<Option<_>>()?,
        axes: configs,
        safety: safety?,
        global: GlobalConfig {
            parameters,
            saved: None,
            filters,
            virtual_inputs,
            full_scales,
            without_index,
            without_inputs,
            cams: tables::cams(&cx),
        },
    };
    functions::check_signals(&slots.open, &machine.directory());
    functions::check_axes(&cx, &machine);
    functions::check_quantities(&cx, &machine);
    if let Some((preset, cycle)) = preset.zip(cycle_at) {
        preset::hold(preset, &cx, &machine, &terminals, &cycle);
    }
    let at: Vec<_> = drives.iter().map(|drive| (!drive.is_off_bus).then_some(drive.at)).collect();
    let objects = backends::objects(cx.backends.len(), (&machine.io, &terminals), &encoders_at, &at);
    let kinds: Vec<_> = cx.backends.iter().map(|backend| backend.map(Backend::kind)).collect::<Option<_>>()?;
    let backends = cx.names.section(Section::Backends).iter().zip(kinds).zip(objects).zip(buses);
    let backends = backends
        .map(|(((entry, kind), objects), bus)| CellBackend { name: entry.name().to_owned(), kind, objects, bus })
        .collect();
    let (models, mechanics): (_, Vec<_>) = drives.iter().map(|drive| drive.simulated).unzip();
    let drive_keys = drives.into_iter().map(|drive| drive.keys).collect();
    let hung = marks::Locations { axes: &hardware, encoders: &encoders_at, mechanics: &mechanics };
    let marks = marks::read(&marks, &cx, &machine, &hung);
    Some(Cell {
        machine,
        models,
        mechanics,
        marks,
        joint_names: JointNames::new(joints),
        hardware,
        second_hardware,
        drive_keys,
        terminals: at_devices,
        ros: ros?,
        groups,
        backends,
        text: text.to_owned(),
        files: BTreeMap::new(),
        robot: None,
        bare_numbers,
    })
}

fn check_format(value: &Value<'_>) {
    if let Some(format) = value.text().filter(|format| *format != FORMAT) {
        value.refuse(format!("lineshaft is {}; format version {FORMAT} is allowed", quote(format)), None);
    }
}

fn cycle(value: &Value<'_>) -> Option<u64> {
    times::time_within(value, 125_000..=20_000_000, "125 us..20 ms")
}

#[cfg(test)]
mod tests;

//! Creates bus configurations from the cell and the files of its devices.
//!
//! Law      the cell overrides the values of a device file; the cyclic frames must fit in the cycle
//! Reads    EDS and DCF files next to the cell; commands and setpoints in them are left out ([`acts`])
//! Refuses  files with problems, values for objects that the master writes, PDOs that do not fit in the cycle at the
//!          bit rate
//! Source   CiA 301, CiA 306-1

mod nodes;
mod unread;

use super::backends::{CellBackend, DriveKeys, Hardware};
use super::can::{CellBus, CellDrive, CellNode, owner};
use super::names::quote;
use super::terminals::CellTerminal;
use crate::document::{Place, Problems};
use lineshaft_can::NodeId;
use lineshaft_can::acts::{self, LeftOut};
use lineshaft_can::config::{BusConfig, DeviceConfig, Role};
use lineshaft_can::eds::{self, Dictionary, IgnoredKeyKind, Problem};
use lineshaft_can::layout::Layout;
use lineshaft_can::load::Load;
use lineshaft_can::sheet::{self, Findings, Requirements};
use lineshaft_cia402::config::{DriveConfig, Identity, MissingDataBehaviour, Terminals, Write, interpolation_period};
use lineshaft_cia402::mapping::Extras;
use lineshaft_cia402::object::Object;
use lineshaft_core::config::{AxisConfig, MachineConfig};
use lineshaft_core::drive::{Capabilities, Interface};
use lineshaft_ros::layer::open_file;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::Read;
use std::ops::RangeInclusive;
use std::path::Path;
use unread::Unread;

/// Maximum size of a device file, in bytes.
const MAX_BYTES: usize = 8 << 20;
/// Indices of manufacturer-specific objects (CiA 301).
const MANUFACTURER: RangeInclusive<u16> = 0x2000..=0x5FFF;

/// The parts of a cell that define its CAN buses.
pub struct CanBuses<'a> {
    pub(super) machine: &'a MachineConfig,
    /// Locations of the drives, in their order.
    pub(super) hardware: Vec<Hardware>,
    pub(super) drive_keys: &'a [Option<DriveKeys>],
    pub(super) terminals: &'a [CellTerminal],
    pub(super) backends: &'a [CellBackend],
}

impl CanBuses<'_> {
    /// Returns the keys of the drives on CAN, in the order of the drives; `None` for a drive that is not on CAN.
    fn drives(&self) -> impl Iterator<Item = Option<&CellDrive>> {
        self.drive_keys.iter().map(|keys| keys.as_ref().and_then(DriveKeys::can))
    }

    /// Returns the buses in the order of the backends. `file` is the path of the cell; the files of devices are relative
    /// to it.
    ///
    /// # Errors
    /// Returns all errors of the files and of the bus configurations.
    pub fn buses(&self, file: Option<&Path>) -> Result<Vec<BusConfig>, Problems> {
        self.buses_and_warnings(file).map(|(buses, _)| buses)
    }

    /// Returns the same, and the warnings about the files.
    ///
    /// # Errors
    /// Same errors as [`Self::buses`].
    pub fn buses_and_warnings(&self, file: Option<&Path>) -> Result<(Vec<BusConfig>, Vec<String>), Problems> {
        let warnings: RefCell<Vec<String>> = RefCell::default();
        let problems = Problems::new(&file.map_or("the cell".to_owned(), |file| file.display().to_string()));
        let folder = file.and_then(Path::parent).unwrap_or(Path::new(""));
        let axes: Vec<_> = self.machine.drives().collect();
        let described: Vec<_> = self.drives().collect();
        let of = |(at, backend): (usize, &CellBackend)| {
            let bus = backend.bus.as_ref()?;
            let places = self.hardware.iter().enumerate().filter(|(_, hardware)| hardware.backend == at);
            let drives: Vec<_> =
                places.filter_map(|(place, _)| Some((place, *axes.get(place)?, (*described.get(place)?)?))).collect();
            let is_drive = |node| drives.iter().any(|(.., drive)| drive.device.node == node);
            if bus.master.is_none() {
                let here = |(place, (_, axis, _)): (usize, &Driven<'_>)| {
                    let is_here = self.hardware.get(place).is_some_and(|hardware| hardware.backend == at);
                    axis.analog.filter(|_| is_here).map(|_| quote(&axis.name))
                };
                if let Some(axis) = axes.iter().enumerate().find_map(here) {
                    let sentence = format!(
                        "master is none, and the reference of axis {axis} is at a module here, which would not hear that this program is gone"
                    );
                    problems.push(bus.place, sentence, None);
                }
            }
            let mut terminals = nodes::by_node(self.terminals, at, is_drive, &problems);
            let maker = Maker { folder, bit_rate: bus.bit_rate, problems: &problems, warnings: &warnings };
            let of_drive = |(place, axis, described): &(usize, Driven<'_>, &CellDrive)| {
                maker.drive(*place, *axis, described, terminals.remove(&described.device.node).unwrap_or_default())
            };
            let mut devices: Vec<_> = drives.iter().filter_map(of_drive).collect();
            for node in &bus.nodes {
                let number = node.node;
                if let Some((_, (_, axis, _), _)) = drives.iter().find(|(.., drive)| drive.device.node == number) {
                    let axis = quote(&axis.name);
                    let sentence =
                        format!("{number} of nodes is the drive of axis {axis}; what is said of it stands there");
                    problems.push(node.place, sentence, None);
                } else if !terminals.contains_key(&number) {
                    problems.push(node.place, format!("{number} of nodes: no entry of io or encoders is there"), None);
                }
            }
            devices.extend(terminals.into_iter().filter_map(|(number, terminals)| {
                let said = bus.nodes.iter().find(|node| node.node == number).cloned();
                maker.module(&said.unwrap_or_else(|| CellNode::with_defaults(number, bus.place)), terminals)
            }));
            let config = BusConfig {
                name: backend.name.clone(),
                transport: bus.transport.clone(),
                bit_rate: bus.bit_rate,
                serial_baudrate: bus.serial_baudrate,
                cycle_ns: self.machine.cycle_ns,
                sync_overflow: bus.sync_overflow,
                sdo_timeout_ns: bus.sdo_timeout_ns,
                time_ns: bus.time_ns,
                master: bus.master,
                devices,
            };
            check(&config, bus, &problems);
            Some(config)
        };
        let buses: Vec<_> = self.backends.iter().enumerate().filter_map(of).collect();
        if problems.is_empty() { Ok((buses, warnings.into_inner())) } else { Err(problems) }
    }

    /// Returns warnings about limit switches that do not stop the axis because the master does not read them. The buses
    /// must be those of the cell.
    ///
    /// # Errors
    /// Returns an error if homing needs switches or index pulses that are not read.
    pub fn unread(&self, buses: &[BusConfig], file: Option<&Path>) -> Result<Vec<String>, Problems> {
        let name = file.map_or("the cell".to_owned(), |file| file.display().to_string());
        let (problems, mut warnings) = (Problems::new(&name), Vec::new());
        let drives = self.hardware.iter().zip(self.machine.drives()).zip(self.drives()).enumerate();
        for (place, ((hardware, (object, axis, _)), described)) in drives {
            let backend = self.backends.get(hardware.backend).map(|backend| &backend.name);
            let bus = buses.iter().find(|bus| Some(&bus.name) == backend);
            let Some((bus, described)) = bus.zip(described) else { continue };
            let Some(device) = bus.devices.iter().find(|device| device.node == described.device.node) else { continue };
            let is_second = self.machine.second_drive(object) == Some(place);
            let drive = Unread { axis, is_second, encoders: self.machine.encoders.len(), described, device };
            let at = described.device.place;
            for sentence in drive.of_homing() {
                problems.push(at, sentence, None);
            }
            let place_of = |sentence: String| format!("{name}:{}:{}: {sentence}", at.line, at.col);
            warnings.extend(drive.limit_switches().map(place_of));
        }
        if problems.is_empty() { Ok(warnings) } else { Err(problems) }
    }

    /// Returns remarks and warnings about the buses, their devices and the files of these.
    ///
    /// # Errors
    /// Same errors as [`Self::buses`] and [`Self::unread`].
    pub(super) fn findings(&self, file: Option<&Path>) -> Result<DeviceFindings, Problems> {
        let (buses, mut warnings) = self.buses_and_warnings(file)?;
        warnings.extend(self.unread(&buses, file)?);
        let of_devices = buses.iter().flat_map(left_out_of).chain(buses.iter().flat_map(mode_by_sdo_of));
        Ok(DeviceFindings { remarks: buses.iter().filter_map(load_of).chain(of_devices).collect(), warnings })
    }

    /// Returns the object dictionaries from the files of the devices at one backend, by node.
    ///
    /// # Errors
    /// Returns an error for the first file with a problem.
    pub fn dictionaries(&self, backend: &str, file: &Path) -> Result<BTreeMap<NodeId, Dictionary>, String> {
        let folder = file.parent().unwrap_or(Path::new(""));
        let is_at = |at: usize| self.backends.get(at).is_some_and(|known| known.name == backend);
        let drives = self.hardware.iter().zip(self.drives()).filter(|(hardware, _)| is_at(hardware.backend));
        let drives = drives.filter_map(|(_, drive)| drive.map(|drive| &drive.device));
        let buses = self.backends.iter().filter(|known| known.name == backend).filter_map(|known| known.bus.as_ref());
        let devices = drives.chain(buses.flat_map(|bus| &bus.nodes));
        let named = devices.filter_map(|device| Some((device.node, &device.eds.as_ref()?.0)));
        named.map(|(node, name)| Ok((node, device_file("eds", &folder.join(name), node)?))).collect()
    }
}

/// What a cell and the files of its devices show about the devices.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DeviceFindings {
    /// Remarks: load of the buses, values that are left out of configurations.
    pub remarks: Vec<String>,
    /// Warnings.
    pub warnings: Vec<String>,
}

/// Axis of a drive, and the capabilities of the drive.
type Driven<'a> = (u16, &'a AxisConfig, Capabilities);

/// Creates devices from the cell and their files.
struct Maker<'a> {
    folder: &'a Path,
    /// Bit rate, in bit/s.
    bit_rate: Option<u32>,
    problems: &'a Problems,
    /// Messages that are no errors.
    warnings: &'a RefCell<Vec<String>>,
}

impl Maker<'_> {
    /// Adds warnings, each once, because many devices may share a file.
    fn warn(&self, sentences: impl IntoIterator<Item = String>) {
        let mut warnings = self.warnings.borrow_mut();
        for sentence in sentences {
            if !warnings.contains(&sentence) {
                warnings.push(sentence);
            }
        }
    }

    fn drive(
        &self,
        place: usize,
        (object, axis, offers): Driven<'_>,
        drive: &CellDrive,
        terminals: Terminals,
    ) -> Option<DeviceConfig> {
        let CellDrive { mode, drive_type, probes, .. } = *drive;
        let node = drive.device.node;
        let effort = axis.parameters.amplifier.max_effort.unwrap_or_default();
        if mode.interface() == Interface::Torque && effort > f64::from(i16::MAX) {
            let name = quote(&axis.name);
            let sentence = format!(
                "max_effort of axis {name} is {effort}; a drive on CAN takes up to {} per mille of its rated torque (6071h)",
                i16::MAX
            );
            self.problems.push(drive.device.place, sentence, None);
            return None;
        }
        let extras = Extras { probes, torque: drive.rated_effort.is_some() };
        let is_bare =
            extras == Extras::default() && terminals.digital_inputs.is_empty() && terminals.digital_outputs.is_empty();
        let plan = |dictionary: Option<&Dictionary>| {
            let of_axis = |problem: &dyn std::fmt::Display| format!("drive of axis {}: {problem}", quote(&axis.name));
            match drive_type {
                None => Layout::plan(node, mode, extras, &terminals, dictionary),
                Some(_) if !is_bare => {
                    return Err(of_axis(&"probes, rated_effort and io are not for a drive with drivetype"));
                }
                Some(of_type) => Layout::of_drive_type(node, of_type),
            }
            .map_err(|error| of_axis(&error))
        };
        let role = Role::Drive(DriveConfig {
            place,
            axis: axis.name.clone(),
            object,
            probes,
            mode,
            drive_type,
            offers,
            counts_per_shaft_revolution: drive.per_revolution,
            velocity: drive.velocity,
            missed: MissingDataBehaviour { cycles: axis.missed_cycles, extrapolates: drive.extrapolates },
            rated_effort: drive.rated_effort,
        });
        let needs = Requirements { bit_rate: self.bit_rate, homes: axis.parameters.homing.in_drive };
        let device = self.device(&drive.device, role, needs, plan)?;
        Some(DeviceConfig { terminals, ..device })
    }

    /// Returns the configuration of a module or an encoder.
    fn module(&self, node: &CellNode, terminals: Terminals) -> Option<DeviceConfig> {
        let number = node.node;
        let role = if terminals.encoders.is_empty() { Role::Module } else { Role::Encoder };
        let layout = match role {
            Role::Encoder => Layout::encoder(number),
            _ => Layout::module(number, &terminals),
        };
        let needs = Requirements { bit_rate: self.bit_rate, homes: false };
        let device = self.device(node, role, needs, |_| layout.map_err(|error| format!("{number}: {error}")))?;
        Some(DeviceConfig { terminals, ..device })
    }

    fn device(
        &self,
        node: &CellNode,
        role: Role,
        needs: Requirements,
        plan: impl FnOnce(Option<&Dictionary>) -> Result<Layout, String>,
    ) -> Option<DeviceConfig> {
        let identity = node.identity;
        let dictionary = match &node.eds {
            Some((name, at)) => {
                let path = self.folder.join(name);
                let file = device_file("eds", &path, node.node);
                let dictionary = file.map_err(|sentence| self.problems.push(*at, sentence, None)).ok()?;
                self.warn(passed_over("eds", &path, &dictionary, &node.startup));
                Some(dictionary)
            }
            None => None,
        };
        let at = node.eds.as_ref().map_or(node.place, |(_, at)| *at);
        let refuse = |sentence: String| self.problems.push(at, sentence, None);
        let layout = plan(dictionary.as_ref()).map_err(refuse).ok()?;
        let nothing = (Vec::new(), LeftOut::default());
        let configured = dictionary.as_ref().map_or(Ok(nothing), |dictionary| configured(dictionary, &role));
        let (mut startup, mut left_out) = configured.map_err(refuse).ok()?;
        // Values of the cell are written last and override those of the file.
        let is_of_file = |object: Object| node.startup.iter().all(|given| given.object != object);
        startup.retain(|write| is_of_file(write.object));
        left_out.0.retain(|(object, _)| is_of_file(*object));
        startup.extend(node.startup.iter().cloned());
        let device = dictionary.as_ref().map(|dictionary| &dictionary.device);
        let known = |number: Option<u32>| number.filter(|number| *number != 0);
        let made = DeviceConfig {
            node: node.node,
            watching: node.watching,
            layout,
            identity: Identity {
                vendor: identity.vendor.or(device.and_then(|device| known(device.vendor_number))),
                product: identity.product.or(device.and_then(|device| known(device.product_number))),
                ..identity
            },
            startup,
            left_out,
            terminals: Terminals::default(),
            role,
        };
        if let Some(dictionary) = &dictionary {
            self.compare(node, &made, needs, dictionary);
        }
        Some(made)
    }

    /// Compares a device with its file.
    fn compare(&self, node: &CellNode, device: &DeviceConfig, needs: Requirements, dictionary: &Dictionary) {
        let Some((name, at)) = &node.eds else { return };
        let file = quote(&self.folder.join(name).display().to_string());
        let of_file = |sentence: String| format!("eds {file}: {sentence}");
        let Findings { errors, warnings } = sheet::compare(device, needs, dictionary);
        for sentence in errors {
            self.problems.push(*at, of_file(sentence), None);
        }
        self.warn(warnings.into_iter().map(of_file));
    }
}

/// Returns the object dictionary of a device, from its file; `what` is the object that names the file, for messages.
///
/// # Errors
/// Returns a message if the file cannot be read, has errors, or belongs to another node.
pub(crate) fn device_file(what: &str, path: &Path, node: NodeId) -> Result<Dictionary, String> {
    let name = quote(&path.display().to_string());
    let mut bytes = Vec::new();
    match open_file(path).and_then(|file| file.take(MAX_BYTES as u64 + 1).read_to_end(&mut bytes)) {
        Err(error) => return Err(format!("{what} {name} cannot be read: {error}")),
        Ok(_) if bytes.len() > MAX_BYTES => return Err(format!("{what} {name} is longer than {MAX_BYTES} bytes")),
        Ok(_) => {}
    }
    let dictionary = eds::parse(&bytes, Some(node.get())).map_err(|errors| format!("{what} {name}: {errors}"))?;
    let own = dictionary.commissioning.as_ref().and_then(|own| own.node_id);
    match own.filter(|own| *own != u32::from(node.get())) {
        Some(own) => Err(format!("{what} {name} is the configuration of node {own}, not of {node}")),
        None => Ok(dictionary),
    }
}

/// Returns the warnings about a device file, as messages; `what` is the object that names the file. Values and limits
/// of manufacturer-specific objects that `startup` does not write are counted, one line for each kind.
pub(crate) fn passed_over(what: &str, path: &Path, dictionary: &Dictionary, startup: &[Write]) -> Vec<String> {
    let name = quote(&path.display().to_string());
    let (problems, dropped) = (dictionary.warnings().kept(), dictionary.warnings().dropped());
    let is_unused =
        |index: u16| MANUFACTURER.contains(&index) && startup.iter().all(|write| write.object.index != index);
    let counted_as = |problem: &Problem| {
        let passed_over = problem.passed_over.filter(|passed_over| is_unused(passed_over.index))?;
        Some(passed_over.key)
    };
    let single = problems.iter().filter(|problem| counted_as(problem).is_none()).map(Problem::to_string);
    let counted =
        [(IgnoredKeyKind::Value, "values"), (IgnoredKeyKind::Limit, "limits")].into_iter().filter_map(|(key, word)| {
            let of_key: Vec<_> = problems.iter().filter(|problem| counted_as(problem) == Some(key)).collect();
            let first = of_key.first()?.to_string();
            if of_key.len() == 1 {
                return Some(first);
            }
            let (count, first) = (of_key.len(), first.trim_end_matches("; passed over"));
            Some(format!("{count} {word} of objects of the manufacturer passed over, the first in {first}"))
        });
    let more = (dropped > 0).then(|| format!("and {dropped} more"));
    single.chain(counted).chain(more).map(|sentence| format!("{what} {name}: {sentence}")).collect()
}

/// Returns the values that the configuration in a file sets, except those that the master writes, and the values that
/// are left out.
fn configured(dictionary: &Dictionary, role: &Role) -> Result<(Vec<Write>, LeftOut), String> {
    let (mut writes, mut left_out) = (Vec::new(), LeftOut::default());
    let first = acts::profile_number(role.profile().0);
    for (object, data) in dictionary.configured_values().map_err(|error| error.to_string())? {
        if let Some(reason) = acts::reason(object, acts::profile_of(dictionary, object.index, first)) {
            left_out.0.push((object, reason));
        } else if owner(object.index).is_none() {
            writes.push(Write { object, data });
        }
    }
    Ok((writes, left_out))
}

fn check(bus: &BusConfig, from: &CellBus, problems: &Problems) {
    let name = &bus.name;
    let refuse = |place: Place, sentence: String| problems.push(place, sentence, None);
    if interpolation_period(bus.cycle_ns).is_none() {
        let us = bus.cycle_ns as f64 / 1000.0;
        refuse(
            from.place,
            format!(
                "backend {name}: a cycle of {us} us cannot be told to drives (60C2h); 1 to 255 times 1, 10, 100 us or 1 ms is allowed"
            ),
        );
    }
    if let Some(master) = bus.master
        && let Some(device) = bus.devices.iter().find(|device| device.node == master.node)
    {
        refuse(from.place, format!("backend {name}: {device} has the node id of the master"));
    }
    let Some(load) = Load::of(bus).filter(|load| load.share() > 1.0) else { return };
    let Load { frames, bits, rate, .. } = load;
    let fits_ms = (load.time_us() / 1000.0 * 10.0).ceil() / 10.0;
    refuse(
        from.place,
        format!(
            "backend {name}: what each cycle carries does not fit: {frames} frames of {bits} bits take {:.0} us at {rate} bit/s, the cycle \
             is {} us; a cycle of {fits_ms} ms fits, or fewer devices on this bus",
            load.time_us(),
            load.cycle_us
        ),
    );
}

/// Returns one line per device of a bus with the values that are left out of its configuration.
pub(crate) fn left_out_of(bus: &BusConfig) -> Vec<String> {
    let devices = bus.devices.iter().filter(|device| !device.left_out.is_empty());
    let line = |device: &DeviceConfig| {
        let (name, left_out) = (&bus.name, &device.left_out);
        format!("backend {name}: {device}: left out of its DCF, {left_out}")
    };
    devices.map(line).collect()
}

/// Returns one line per drive of a bus whose mode of operation is written by SDO.
pub(crate) fn mode_by_sdo_of(bus: &BusConfig) -> Vec<String> {
    let line = |device: &DeviceConfig| {
        let sentence = device.layout.mode_by_sdo.sentence()?;
        Some(format!("backend {}: {device}: {sentence}", bus.name))
    };
    bus.devices.iter().filter_map(line).collect()
}

/// Returns the bus load as text; `None` without a bit rate.
fn load_of(bus: &BusConfig) -> Option<String> {
    let load = Load::of(bus)?;
    let (name, percent) = (&bus.name, load.share() * 100.0);
    let Load { frames, bits, rate, cycle_us } = load;
    Some(format!(
        "backend {name}: {frames} frames of {bits} bits at most in each cycle of {cycle_us} us: {percent:.0} % of {rate} bit/s"
    ))
}

#[cfg(test)]
mod tests;

//! Signals and objects of a cell that a scenario may name.

use crate::cell::CellBackend;
use crate::document::Value;
use lineshaft_core::config::{IoKind, MachineConfig};
use lineshaft_core::object::Object;
use lineshaft_core::parameter::{Applies, ROWS, Row, Word};
use lineshaft_core::request::RequestError;
use lineshaft_core::signal::{Directory, Signal, Type};
use lineshaft_core::unit::{Scale, excerpt};
use lineshaft_ros::surface::{Group, JointNames};
use std::path::Path;

/// Names of a cell.
pub(super) struct Names<'c> {
    pub config: &'c MachineConfig,
    /// Joint names of its axes; `None` for recorded commands, which have object names.
    pub joints: Option<&'c JointNames>,
    /// Backends that can be named, in the order of the cell.
    pub backends: &'c [CellBackend],
    pub directory: &'c Directory,
    /// Groups of its axes, with settings for trajectories; empty for recorded commands, which contain the settings.
    pub groups: &'c [Group],
    /// Folder to which file names are relative; `None` for recorded commands.
    pub folder: Option<&'c Path>,
}

impl Names<'_> {
    /// Returns the signal that a value names.
    pub(super) fn signal(&self, value: &Value<'_>) -> Option<Signal> {
        let text = value.text()?;
        let found = self.directory.find(text);
        if found.is_none() {
            let hint = nearest(text, self.directory.iter().map(|(_, entry)| entry.name.as_str()));
            let hint = hint.map_or("`lineshaft signals CELL` lists them".to_owned(), did_you_mean);
            value.refuse(format!("no signal is called `{}`", excerpt(text)), Some(hint));
        }
        found
    }

    /// Returns the object name of the axis with this joint name or object name; any other name is unchanged.
    pub(super) fn axis_of_joint(&self, name: &str) -> String {
        let axis = self.joints.and_then(|joints| joints.find(name));
        axis.map_or(name, |axis| self.config.name(Object::Axis(axis))).to_owned()
    }

    /// Returns the object that a value names, including `machine`.
    pub(super) fn object(&self, value: &Value<'_>) -> Option<Object> {
        let text = value.text()?;
        let found = if text == "machine" { Some(Object::Machine) } else { self.find(text) };
        if found.is_none() {
            let hint = nearest(text, self.objects().map(|(name, _)| name)).map(did_you_mean);
            value.refuse(format!("nothing is called `{}` in the cell", excerpt(text)), hint);
        }
        found
    }

    /// Returns the object of that name; the machine has none.
    pub(super) fn find(&self, name: &str) -> Option<Object> {
        self.objects().find(|(known, _)| *known == name).map(|(_, object)| object)
    }

    /// Returns the parameter of that name: axis or machine, index of its row, the row, and the scale of the axis.
    pub(super) fn parameter(&self, name: &str, value: &Value<'_>) -> Option<(u16, u16, &'static Row, Scale)> {
        let found = self.config.find_parameter(name);
        found
            .map_err(|error| {
                let is_unknown = matches!(error, RequestError::UnknownParameter { .. });
                value.refuse(error.to_string(), is_unknown.then(|| meant_parameter(name, self.config)).flatten());
            })
            .ok()
    }

    fn objects(&self) -> impl Iterator<Item = (&str, Object)> {
        let config = self.config;
        let io = config.io.iter().zip(0..).map(|(entry, index)| (entry.name.as_str(), Object::Io(index)));
        let memory = config.memory.iter().zip(0..).map(|(entry, index)| (entry.name.as_str(), Object::Memory(index)));
        let encoders =
            config.encoders.iter().zip(0..).map(|(entry, index)| (entry.name.as_str(), Object::Encoder(index)));
        let axes = config.axes.iter().zip(0..).map(|(entry, index)| (entry.name.as_str(), Object::Axis(index)));
        let tables = config.tables.iter().zip(0..).map(|(entry, index)| (entry.name.as_str(), Object::Table(index)));
        let slots = config.slots.iter().zip(0..).map(|(entry, index)| (entry.name.as_str(), Object::Function(index)));
        io.chain(memory).chain(encoders).chain(axes).chain(tables).chain(slots)
    }

    /// Whether a signal is a memory cell with a number, which has no unit.
    pub(super) fn is_number_in_memory(&self, signal: Signal) -> bool {
        let entry = self.directory.entry(signal);
        entry.kind != Type::Bit && matches!(self.find(&entry.name), Some(Object::Memory(_)))
    }

    /// Returns the scale of the axis or encoder of a signal.
    pub(super) fn scale_of(&self, signal: &str) -> Option<Scale> {
        let object = signal.split_once('.')?.0;
        let axis = self.config.axes.iter().find(|axis| axis.name == object).map(|axis| axis.scale);
        axis.or_else(|| self.config.encoders.iter().find(|encoder| encoder.name == object).map(|encoder| encoder.scale))
    }

    /// Returns the index of the drive of an axis; `None` for a virtual axis.
    pub(super) fn drive_of(&self, axis: u16) -> Option<usize> {
        let axes = self.config.axes.get(..=usize::from(axis))?;
        axes.last()?.drive?;
        Some(axes.iter().filter(|axis| axis.drive.is_some()).count() - 1)
    }

    /// Whether an entry of `io` reads an output of the machine.
    pub(super) fn reads_output(&self, index: u16) -> bool {
        let place = self.io(index).filter(|(kind, _)| *kind == IoKind::DigitalInput).map(|(_, place)| place);
        place.is_some_and(|place| self.config.is_virtual_input(place))
    }

    /// Returns the kind of an entry of `io`, and its index among that kind.
    pub(super) fn io(&self, index: u16) -> Option<(IoKind, usize)> {
        let entry = self.config.io.get(usize::from(index))?;
        Some((entry.kind, self.config.io_place(usize::from(index))))
    }
}

/// Returns a hint with the most similar parameter.
pub(super) fn meant_parameter(name: &str, config: &MachineConfig) -> Option<String> {
    let (object, key) = name.split_once('.')?;
    if key.starts_with(object) && key[object.len()..].starts_with('.') {
        return Some(format!("`{}` stands twice", excerpt(object)));
    }
    // The message itself names the key of a word of another controller.
    let axis = config.axes.iter().find(|axis| axis.name == object);
    // A parameter for axes with two drives is not suggested for other axes.
    let has = |row: &&Row| row.applies != Applies::Gantry || axis.is_some_and(|axis| row.applies.to(axis));
    let near = nearest(key, ROWS.iter().filter(has).map(|row| row.key));
    let meant = near.filter(|_| Word::find(key).is_none())?;
    Some(did_you_mean(&format!("{}.{meant}", excerpt(object))))
}

/// Formats a hint.
pub(crate) fn did_you_mean(name: &str) -> String {
    format!("did you mean `{name}`?")
}

/// Returns the name that is most similar to `text`, if any: up to a third of its letters may differ; case is ignored.
pub(crate) fn nearest<'n>(text: &str, names: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    /// A longer text is no misspelled name, and the time for the distance is the product of the lengths.
    const LONGEST: usize = 64;
    if text.len() > LONGEST {
        return None;
    }
    let text = text.to_lowercase();
    let near = names.map(|name| (strsim::damerau_levenshtein(&text, &name.to_lowercase()), name));
    near.filter(|(far, name)| far * 3 <= text.len().max(name.len())).min_by_key(|(far, _)| *far).map(|(_, name)| name)
}

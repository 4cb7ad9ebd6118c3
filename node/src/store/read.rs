//! Reads a store and checks it with the cell that is to start with it.

use super::text::{FORMAT, scale_text};
use crate::document::{Document, Problems, Value};
use lineshaft_core::code::Code;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::event::{Number, Refusal};
use lineshaft_core::parameter::{AxisParameters, Change, Contradiction, MachineParameters, Refused, Row, Storage};
use lineshaft_core::signal::Directory;
use lineshaft_core::text::message;
use lineshaft_core::unit::excerpt;
use lineshaft_core::vocabulary;

/// Prefix of the scale of an axis whose positions count opposite to its encoder.
const AGAINST: char = '-';

/// Content of a store for a cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Stored {
    /// Number of the set.
    pub generation: u64,
    /// Number of values.
    pub values: usize,
    /// Layer User of each axis, if it has saved values.
    pub sets: Vec<Option<AxisParameters>>,
    /// Layer User of the machine, if it has saved values.
    pub machine: Option<MachineParameters>,
}

impl Stored {
    /// Applies it as layer User at the start of the machine.
    pub fn put_into(self, config: &mut MachineConfig) {
        for (axis, set) in config.axes.iter_mut().zip(self.sets) {
            axis.saved = set;
        }
        config.global.saved = self.machine;
    }
}

/// Reads the text of a store for a cell. `label` is its name in problems.
///
/// # Errors
/// Returns all errors with line and column.
pub fn read_store(label: &str, text: &str, config: &MachineConfig) -> Result<Stored, Problems> {
    let document = Document::parse(label, text);
    let stored = document.root("the store").and_then(|root| read(&root, config));
    match stored {
        Some(stored) if document.problems().is_empty() => Ok(stored),
        _ => Err(document.into_problems()),
    }
}

fn read(root: &Value<'_>, config: &MachineConfig) -> Option<Stored> {
    let mut map = root.map("the store")?;
    let version = map.required("lineshaft_store")?;
    let format = version.text()?;
    if format != FORMAT {
        let given = excerpt(format);
        version.refuse(format!("lineshaft_store is `{given}`; format version {FORMAT} is allowed"), None);
        // Another format has other keys.
        map.rest();
        return None;
    }
    let generation = map.required("generation").and_then(|value| value.integer(0..=u64::MAX));
    map.allow(&["sha256"]);
    let axes = map.required("axes").and_then(|value| value.entries()).unwrap_or_default();
    let fits = check_axes(&axes, config);
    let values = map.required("parameters");
    map.finish();
    // If increments have another meaning, no value is checked.
    let values = values.filter(|_| fits)?;
    let nothing = || (0, vec![None; config.axes.len()], None);
    let (values, sets, machine) = if values.is_null() { nothing() } else { sets(&values, config)? };
    check_senses(&axes, &sets, config);
    Some(Stored { generation: generation?, values, sets, machine })
}

/// Checks that the increments of the store have the meaning of those of the cell.
fn check_axes(axes: &[(Value<'_>, Value<'_>)], config: &MachineConfig) -> bool {
    let mut fits = true;
    for (name, scale) in axes {
        let Some(name_text) = name.text() else { continue };
        let Some(axis) = config.axes.iter().find(|axis| axis.name == name_text) else {
            let all: Vec<_> = config.axes.iter().map(|axis| axis.name.as_str()).collect();
            let sentence = format!("the cell has no axis `{}`; its axes are {}", excerpt(name_text), all.join(", "));
            name.refuse(sentence, None);
            fits = false;
            continue;
        };
        let (Some(given), expected) = (scale.text(), scale_text(&axis.scale)) else { continue };
        if given.strip_prefix(AGAINST).unwrap_or(given) != expected {
            let sentence = format!(
                "{name_text} was saved with a scale of {}, and has {expected} in the cell: its increments mean something else",
                excerpt(given)
            );
            scale.refuse(sentence, None);
            fits = false;
        }
    }
    fits
}

/// Checks that the positions of the store count in the direction in which they will be read. If the cell reversed the
/// direction of rotation, saved limits would apply to other positions.
fn check_senses(axes: &[(Value<'_>, Value<'_>)], sets: &[Option<AxisParameters>], config: &MachineConfig) {
    for (name, scale) in axes {
        let found = std::iter::zip(&config.axes, sets).find(|(axis, _)| name.peek() == Some(axis.name.as_str()));
        let (Some((axis, set)), Some(given)) = (found, scale.peek()) else { continue };
        let posdrct = set.as_ref().unwrap_or(&axis.parameters).macs.posdrct;
        if given.starts_with(AGAINST) != (posdrct < 0) {
            let saved = if posdrct < 0 { "above" } else { "below" };
            let sentence = format!(
                "{} was saved with posdrct {saved} 0, and the cell has posdrct {posdrct}: its positions count the other way",
                axis.name
            );
            scale.refuse(sentence, None);
        }
    }
}

/// Number of values, and the sets of the axes and of the machine.
type Sets = (usize, Vec<Option<AxisParameters>>, Option<MachineParameters>);

/// Returns the sets that result if the values replace those of the cell, and the number of values.
fn sets(values: &Value<'_>, config: &MachineConfig) -> Option<Sets> {
    let entries = values.entries()?;
    let changes = crate::parameters::changes(values, config, &Directory::default())?;
    let mut sets: Vec<Option<AxisParameters>> = vec![None; config.axes.len()];
    let mut machine = None;
    let mut is_good = true;
    for ((key, value), change) in entries.iter().zip(&changes) {
        let Some(row) = change.row() else { continue };
        let place = usize::from(change.axis);
        let (Some(axis), Some(set)) = (config.axes.get(place), sets.get_mut(place)) else {
            if row.storage == Storage::Volatile {
                refuse_volatile("machine", key, row);
                is_good = false;
            }
            let set = machine.get_or_insert(config.global.parameters);
            if let Err(refused) = row.assign_to_machine(set, change.value) {
                value.refuse(told(code_of(refused), change, change.number(), Number::None, config), None);
                is_good = false;
            }
            continue;
        };
        if row.storage == Storage::Volatile {
            refuse_volatile(&axis.name, key, row);
            is_good = false;
        }
        let set = set.get_or_insert(axis.parameters);
        if let Err(refused) = row.change(set, change.value) {
            value.refuse(told(code_of(refused), change, change.number(), Number::None, config), None);
            is_good = false;
        }
    }
    if is_good {
        for (place, set) in sets.iter().enumerate() {
            if let Some((key, sentence)) = set.as_ref().and_then(|set| contradiction(place, set, config)) {
                let of_axis =
                    || std::iter::zip(&entries, &changes).filter(|(_, change)| usize::from(change.axis) == place);
                let root = |change: &Change| change.row().map_or("", Row::root);
                let guilty = of_axis().find(|(_, change)| root(change) == key).or_else(|| of_axis().next());
                guilty
                    .map_or_else(|| values.refuse(&*sentence, None), |((_, value), _)| value.refuse(&*sentence, None));
                is_good = false;
            }
        }
    }
    is_good.then_some((changes.len(), sets, machine))
}

fn refuse_volatile(object: &str, key: &Value<'_>, row: &Row) {
    key.refuse(format!("{object}: {} begins anew with each start and is never saved", row.key), None);
}

fn code_of(refused: Refused) -> Code {
    match refused {
        Refused::NotBuilt => Code::NOT_BUILT,
        Refused::ReadOnly => Code::READ_ONLY,
        Refused::OutOfRange | Refused::WrongType => Code::PARAMETER_OUT_OF_RANGE,
    }
}

/// Returns a key whose value contradicts the others of an axis, with the reason.
fn contradiction(place: usize, set: &AxisParameters, config: &MachineConfig) -> Option<(&'static str, String)> {
    let axis = config.axes.get(place)?;
    let change = |key: &'static str| {
        let (row, entry) = Row::find(key)?;
        Some(Change { axis: u16::try_from(place).ok()?, row, value: entry.value(set) })
    };
    match set.check() {
        Err(Contradiction::Above(low, high)) => {
            let (low_change, high_change) = (change(low)?, change(high)?);
            let code = Code::PARAMETERS_CONTRADICT;
            // The saved value is reported; the other one is in the cell, which the user may have changed.
            let is_cells =
                |change: &Change| change.row().is_some_and(|row| row.value(&axis.parameters) == change.value);
            let (guilty, other) =
                if is_cells(&low_change) { (high_change, low_change) } else { (low_change, high_change) };
            let key = if is_cells(&low_change) { high } else { low };
            return Some((key, told(code, &guilty, guilty.number(), other.number(), config)));
        }
        Err(Contradiction::OutOfRange(key)) => {
            return Some((key, format!("{}: {key}, which follows from others, leaves its range", axis.name)));
        }
        Err(Contradiction::NotBuilt(key, code)) => {
            let change = change(key)?;
            return Some((key, told(code, &change, change.number(), Number::None, config)));
        }
        Ok(()) => {}
    }
    let problem = vocabulary::check(set, &config.setting(axis)).err()?;
    Some((problem.key(), told(problem.code, &change(problem.key())?, problem.asked, problem.limit, config)))
}

/// Returns the message of a refusal.
fn told(code: Code, change: &Change, asked: Number, limit: Number, config: &MachineConfig) -> String {
    let refusal = Refusal::new(code, change.object()).with(asked, limit);
    message(&Refusal { parameter: Some(change.row), ..refusal }.event(0), config)
}

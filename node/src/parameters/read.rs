//! Reads changes from a text with lines `x.max_velocity: 0.8 m/s`, as it is exported, imported and stored.
//!
//! All problems of a text are reported at once, with line and column: names, units, ranges, two views of one value.
//! Older files are accepted too: names in the spelling of MACS (`x.VELMAX`), also as misprinted in its manual, and
//! PROFTIME in us.

mod names;

use crate::cell::{
    contradictions, double_views, inverted_limits, refuse_missing, refuse_senses, refuse_virtual_master,
};
use crate::document::{Document, Problems, Value};
use crate::scenario::parameter_change;
use lineshaft_core::axis::may_output_sign;
use lineshaft_core::config::{IoCounts, MachineConfig, OutputOwner, max_of_row};
use lineshaft_core::parameter::{self, AxisParameters, Change, MACHINE, MachineParameters, Row, in_order};
use lineshaft_core::signal::Directory;
use lineshaft_core::text::refused_text;
use lineshaft_core::unit::{Scale, excerpt};

/// PROFTIME in us, the unit of some firmware.
const PROFTIME_US: std::ops::RangeInclusive<i64> = 1000..=5000;

/// Returns the changes of a text, in its order. `label` is the name of the text in problems.
///
/// # Errors
/// Returns all errors with line and column. The machine checks for contradictions to the values in force.
pub fn read_changes(
    label: &str,
    text: &str,
    config: &MachineConfig,
    directory: &Directory,
) -> Result<Box<[Change]>, Problems> {
    let document = Document::parse(label, text);
    let lines = Lines::read(&document, config, directory);
    let changes = lines.0.iter().map(|line| line.change).collect();
    if document.problems().is_empty() { Ok(changes) } else { Err(document.into_problems()) }
}

/// Effect of a file of parameters on a machine that has just started.
#[derive(Debug)]
pub struct Import {
    /// Changes of the file.
    pub changes: Box<[Change]>,
    /// Parameters of each axis after the import.
    pub parameters: Vec<AxisParameters>,
    /// Parameters of the machine after the import.
    pub machine: MachineParameters,
}

/// Checks a file of parameters with a cell, without a machine.
///
/// # Errors
/// Returns all errors with line and column, including contradictions to the cell.
pub fn check_import(document: Document, config: &MachineConfig, directory: &Directory) -> Result<Import, Problems> {
    let lines = Lines::read(&document, config, directory);
    let mut parameters: Vec<AxisParameters> = config.axes.iter().map(|axis| axis.power_on()).collect();
    for (index, axis) in config.axes.iter().enumerate() {
        let Some(after) = parameters.get_mut(index) else { continue };
        let changes: Vec<Change> = lines.of(index).map(|line| line.change).collect();
        for change in in_order(&changes) {
            // A refusal by the row was reported before.
            let _ = change.row().map(|row| row.change(after, change.value));
        }
        let set = lines.of(index).filter_map(|line| Some((line.change.row()?, line.change.value, &line.value)));
        inverted_limits(after, set);
        contradictions(after, &lines.given(index), &axis.scale, Some(config.cycle_ns));
    }
    let machine = lines.machine(config);
    for (index, (axis, after)) in std::iter::zip(&config.axes, &parameters).enumerate() {
        let (interface, given) = (axis.drive.map(|_| axis.interface), lines.given(index));
        refuse_senses(interface, after, &given);
        // Outputs that the axis cannot use are refused separately.
        let missing = IoCounts::of(config).check_axis(after).err();
        refuse_missing(missing.filter(|missing| missing.key != "revers" || may_output_sign(interface, after)), &given);
    }
    lines.refuse_shared(config, &machine, &parameters);
    let changes = lines.0.iter().map(|line| line.change).collect();
    if document.problems().is_empty() {
        Ok(Import { changes, parameters, machine })
    } else {
        Err(document.into_problems())
    }
}

/// A line of the text.
struct Line<'d> {
    change: Change,
    value: Value<'d>,
}

/// Lines that are changes.
struct Lines<'d>(Vec<Line<'d>>);

impl<'d> Lines<'d> {
    fn read(document: &'d Document, config: &MachineConfig, directory: &Directory) -> Self {
        let mut lines = Self(Vec::new());
        let Some(root) = document.root("the file of parameters") else { return lines };
        let entries = root.entries().unwrap_or_default();
        if entries.is_empty() && (root.is_map() || root.is_null()) {
            root.refuse("no parameter stands there; lines `axis.key: value` are expected", None);
        }
        for (key, value) in entries {
            if let Some(change) =
                change(&key, &value, config, directory).filter(|change| starts_nothing(change, &value))
            {
                lines.push(Line { change, value }, &key);
            }
        }
        for index in 0..config.axes.len() {
            double_views(&lines.given(index), |view| lines.is_off(index, view));
        }
        lines
    }

    fn push(&mut self, line: Line<'d>, key: &Value<'d>) {
        let is_same = |other: &&Line<'_>| (other.change.axis, other.change.row) == (line.change.axis, line.change.row);
        match (self.0.iter().find(is_same), line.change.row()) {
            (Some(first), Some(row)) => {
                let place = first.value.place();
                let sentence = format!("{} is at {}:{} already", row.key, place.line, place.col);
                key.refuse(sentence, Some("write it once".to_owned()));
            }
            _ => self.0.push(line),
        }
    }

    fn of(&self, axis: usize) -> impl Iterator<Item = &Line<'d>> {
        self.0.iter().filter(move |line| usize::from(line.change.axis) == axis)
    }

    /// Returns the parameters of the machine after the import; an input or output that the cell lacks is a problem.
    fn machine(&self, config: &MachineConfig) -> MachineParameters {
        let mut after = config.global.power_on();
        for line in self.of(usize::from(MACHINE)) {
            // A refusal by the row was reported before.
            let _ = line.change.row().map(|row| row.assign_to_machine(&mut after, line.change.value));
        }
        let given = self.given(usize::from(MACHINE));
        refuse_missing(IoCounts::of(config).check_machine(&after).err(), &given);
        refuse_virtual_master(after.check_virtual_source(config.axes.len()), &given);
        after
    }

    /// Refuses a line that would give an output a second function.
    fn refuse_shared(&self, config: &MachineConfig, machine: &MachineParameters, parameters: &[AxisParameters]) {
        let functions = |index: usize| parameters.get(index).map(AxisParameters::output_functions).unwrap_or_default();
        let is_new = |index: usize| self.of(index).next().is_some();
        let Err(shared) = config.check_functions(machine.o_error, functions, is_new) else { return };
        let other = match shared.other {
            OutputOwner::Parameter(axis, (key, _)) => Some((axis, key)),
            OutputOwner::Axis(_) | OutputOwner::Slot(_) => None,
        };
        for (axis, key) in [Some((shared.axis, shared.function.0)), other].into_iter().flatten() {
            if let Some((_, value)) = self.given(usize::from(axis)).into_iter().find(|(known, _)| *known == key) {
                let number = shared.function.1.unsigned_abs();
                return value.refuse(format!("{key} names output {number}, which has another function already"), None);
            }
        }
    }

    /// Returns the keys of an axis, with their values.
    fn given(&self, axis: usize) -> Vec<(&'static str, Value<'d>)> {
        self.of(axis).filter_map(|line| Some((line.change.row()?.key, line.value.clone()))).collect()
    }

    /// Whether the limit is off whose position the view stores; an export then has both. In inverted units it is the
    /// opposite limit; the text need not contain the direction of rotation.
    fn is_off(&self, axis: usize, view: &Row) -> bool {
        let is_off = |line: &Line<'_>| {
            let is_limit = line.change.row().is_some_and(|row| !row.is_view() && row.key.ends_with("_position"));
            is_limit && line.change.value == parameter::Value::Unset
        };
        matches!(view.key, "neglimit" | "poslimit") && self.of(axis).any(is_off)
    }
}

/// Returns the change of a line; a value that its row refuses is a problem.
fn change(key: &Value<'_>, value: &Value<'_>, config: &MachineConfig, directory: &Directory) -> Option<Change> {
    let name = names::canonical(key.text()?);
    let change = parameter_change(&name, key, value, config, directory)?;
    let row = change.row()?;
    let change = Change { value: of_old_days(row, change.value, value)?, ..change };
    let axis = config.axes.get(usize::from(change.axis)).filter(|_| change.axis != MACHINE);
    let scale = axis.map_or(Scale::increments(), |axis| axis.scale);
    let mut copy = axis.map_or(AxisParameters::new(1.0, 1.0), |axis| axis.parameters);
    let taken = if axis.is_some() { row.change(&mut copy, change.value) } else { row.check(change.value) };
    let highest = max_of_row(row, config.cycle_ns);
    taken.map_err(|why| value.refuse(refused_text(row, why, change.value, &scale, highest), None)).ok()?;
    Some(change)
}

/// Whether it is a change that starts no motion. The velocity of the virtual master may only be 0, which starts no
/// motion either and is ignored; any other value is a problem.
fn starts_nothing(change: &Change, value: &Value<'_>) -> bool {
    let Some(row) = change.row().filter(|row| row.moves_virtual_master()) else { return true };
    if let parameter::Value::Int(number @ (..=-1 | 1..)) = change.value {
        let sentence =
            format!("{} is {number}; 0 is allowed in a text of parameters, as reading one starts no motion", row.key);
        value.refuse(sentence, Some("set it while the machine runs".to_owned()));
    }
    false
}

/// Converts PROFTIME to ms if it is given in us; a value that is no integer in ms is a problem.
fn of_old_days(row: &Row, given: parameter::Value, value: &Value<'_>) -> Option<parameter::Value> {
    match given {
        parameter::Value::Int(us) if row.key == "proftime" && PROFTIME_US.contains(&us) => {
            if us % 1000 != 0 {
                let written = excerpt(value.peek().unwrap_or_default());
                let sentence = format!("proftime is `{written}`; 1 to 5 (ms), or 1000, 2000 .. 5000 (us), is allowed");
                value.refuse(sentence, None);
                return None;
            }
            Some(parameter::Value::Int(us / 1000))
        }
        other => Some(other),
    }
}

/// Returns the changes of a mapping, one for each entry. Reports a problem if it returns `None`.
pub(crate) fn changes(value: &Value<'_>, config: &MachineConfig, directory: &Directory) -> Option<Box<[Change]>> {
    let entries = value.entries()?;
    let change = |(key, value): &(Value<'_>, Value<'_>)| parameter_change(key.text()?, key, value, config, directory);
    // All entries are read, so that every problem is reported.
    let changes: Vec<Option<Change>> = entries.iter().map(change).collect();
    changes.into_iter().collect()
}

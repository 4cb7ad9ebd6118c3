//! Reads section `machine`, the parameters of the machine. Checks that the inputs and outputs that parameters name by
//! number exist and have one function each.

use super::names::quote;
use super::parameters::Given;
use super::row::{refuse_range, whole};
use super::wiring;
use crate::document::{Map, Value};
use lineshaft_core::config::{Function, IoConfig, IoCounts, IoKind, NoSuchIo, missing_io_text};
use lineshaft_core::parameter::{
    self, Applies, AxisParameters, MachineParameters, ROWS, Refused, VirtualMasterProblem,
};
use lineshaft_core::text::refused_text;
use lineshaft_core::unit::Scale;

/// Functions that parameters give to digital outputs, in the order of the file.
pub(super) type Functions<'d> = Vec<(Function, Value<'d>)>;

/// Reads the section; a value with a problem is replaced by its default.
pub(super) fn read<'d>(
    cell: &mut Map<'d>,
    io: &[Option<IoConfig>],
    functions: &mut Functions<'d>,
    axes: usize,
) -> MachineParameters {
    let mut parameters = MachineParameters::default();
    let Some(mut map) = cell.optional("machine").and_then(|value| value.map("machine")) else { return parameters };
    let mut given = Given::new();
    for row in ROWS.iter().filter(|row| row.applies == Applies::Machine) {
        let Some(value) = map.optional(row.key) else { continue };
        let scale = Scale::increments();
        let Some(number) = whole(row, &value, &scale) else { continue };
        let number = parameter::Value::Int(number);
        match row.assign_to_machine(&mut parameters, number) {
            Ok(()) => given.push((row.key, value)),
            Err(Refused::OutOfRange) => refuse_range(row, &value, &scale, None),
            Err(why) => value.refuse(refused_text(row, why, number, &scale, None), Some("leave it out".to_owned())),
        }
    }
    map.finish();
    refuse_missing(counts(io).and_then(|counts| counts.check_machine(&parameters).err()), &given);
    refuse_virtual_master(parameters.check_virtual_begin(axes), &given);
    note_functions(functions, &[("o_error", parameters.o_error)], &given);
    parameters
}

/// Adds the outputs that keys of the file name.
pub(super) fn note_functions<'d>(functions: &mut Functions<'d>, named: &[Function], given: &Given<'d>) {
    for function in named.iter().filter(|(_, number)| *number != 0) {
        let value = given.iter().find(|(key, _)| *key == function.0);
        functions.extend(value.map(|(_, value)| (*function, value.clone())));
    }
}

/// Refuses a second function of an output (like [`lineshaft_core::config::MachineConfig::check_functions`]), at the
/// locations of both.
pub(super) fn refuse_shared(functions: &Functions<'_>, io: &[Option<IoConfig>], taken: &wiring::Taken) {
    let outputs: Vec<_> = (io.iter().enumerate())
        .filter(|(_, entry)| entry.as_ref().is_none_or(|entry| entry.kind == IoKind::DigitalOutput))
        .map(|(place, entry)| (place, entry.as_ref().map_or("", |entry| entry.name.as_str())))
        .collect();
    for (index, (function, value)) in functions.iter().enumerate() {
        let (key, number) = *function;
        let output = usize::try_from(number.unsigned_abs()).ok().and_then(|number| outputs.get(number.checked_sub(1)?));
        let Some(&(place, name)) = output else { continue };
        let other = functions[..index].iter().find(|((_, other), _)| other.unsigned_abs() == number.unsigned_abs());
        let other = other.filter(|(other, _)| other != function || key == "revers").map(|(_, value)| value.place());
        let own = u16::try_from(place).ok().and_then(|place| taken.place(&place));
        if let Some(at) = own.or(other) {
            let number = number.unsigned_abs();
            let sentence = format!("{key} names output {number}, {}, which has another function, at", quote(name));
            value.refuse(format!("{sentence} {}:{}", at.line, at.col), Some("give it an output of its own".to_owned()));
        }
    }
}

/// Returns the numbers of inputs and outputs if all of them could be read.
fn counts(io: &[Option<IoConfig>]) -> Option<IoCounts> {
    let count = |kind| io.iter().flatten().filter(|entry| entry.kind == kind).count();
    let all_read = io.iter().all(Option::is_some);
    all_read.then(|| IoCounts::new(count(IoKind::DigitalInput), count(IoKind::DigitalOutput)))
}

/// Refuses inputs and outputs that an axis names and the cell lacks.
pub(super) fn check_axis(parameters: &AxisParameters, given: &Given<'_>, io: &[Option<IoConfig>], may_tell_sign: bool) {
    let missing = counts(io).and_then(|counts| counts.check_axis(parameters).err());
    // Outputs that the axis cannot use are refused separately.
    refuse_missing(missing.filter(|missing| missing.key != "revers" || may_tell_sign), given);
}

/// Refuses a configuration of the virtual master at the key that names it.
pub(crate) fn refuse_virtual_master(checked: Result<(), VirtualMasterProblem>, given: &[(&'static str, Value<'_>)]) {
    let Err(problem) = checked else { return };
    if let Some((_, value)) = given.iter().find(|(known, _)| *known == problem.key) {
        value.refuse(problem.to_string(), None);
    }
}

/// Refuses an input or output that the cell lacks, at the key that names it.
pub(crate) fn refuse_missing(missing: Option<NoSuchIo>, given: &[(&'static str, Value<'_>)]) {
    let Some(NoSuchIo { key, number, is_output, count }) = missing else { return };
    if let Some((_, value)) = given.iter().find(|(known, _)| *known == key) {
        value.refuse(missing_io_text(key, &number.to_string(), is_output, &count.to_string()), None);
    }
}

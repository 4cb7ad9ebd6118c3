//! Section `machine`: the parameters of the machine; and whether the inputs and outputs are there that parameters name by number.

use super::parameters::{Given, refuse_range, whole};
use crate::document::{Map, Value};
use lineshaft_core::config::{IoConfig, IoCounts, IoKind, NoSuchIo};
use lineshaft_core::parameter::{self, Applies, AxisParameters, MachineParameters, ROWS, Refused};
use lineshaft_core::text::{cell_has, refused_text};
use lineshaft_core::unit::Scale;

/// Reads the section; where a value has a problem, its default stands.
pub(super) fn read(cell: &mut Map<'_>, io: &[Option<IoConfig>]) -> MachineParameters {
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
            Err(Refused::OutOfRange) => refuse_range(row, &value, &scale, f64::INFINITY),
            Err(why) => value.refuse(refused_text(row, why, number, &scale), Some("leave it out".to_owned())),
        }
    }
    map.finish();
    refuse_missing(counts(io).and_then(|counts| counts.check_machine(&parameters).err()), &given);
    parameters
}

/// How many inputs and outputs there are, where all of them could be read.
fn counts(io: &[Option<IoConfig>]) -> Option<IoCounts> {
    let count = |kind| io.iter().flatten().filter(|entry| entry.kind == kind).count();
    let all_read = io.iter().all(Option::is_some);
    all_read.then(|| IoCounts::new(count(IoKind::DigitalInput), count(IoKind::DigitalOutput)))
}

/// Refuses what an axis names and the cell has not.
pub(super) fn check_axis(parameters: &AxisParameters, given: &Given<'_>, io: &[Option<IoConfig>], may_tell_sign: bool) {
    let missing = counts(io).and_then(|counts| counts.check_axis(parameters).err());
    // Outputs that the axis has no use for are refused as such.
    refuse_missing(missing.filter(|missing| missing.key != "revers" || may_tell_sign), given);
}

/// Refuses an input or output that the cell has not where a key names it.
pub(crate) fn refuse_missing(missing: Option<NoSuchIo>, given: &[(&'static str, Value<'_>)]) {
    let Some(NoSuchIo { key, number, is_output, count }) = missing else { return };
    if let Some((_, value)) = given.iter().find(|(known, _)| *known == key) {
        // The output that revers needs stands in its tens.
        let is = if key == "revers" { "needs output" } else { "is" };
        value.refuse(format!("{key} {is} {number}; {}", cell_has(is_output, &count.to_string())), None);
    }
}

//! Reads key `compensation.pitch_error` of an axis: the table of motor position minus load position. The other keys are
//! parameters.

use super::backends::Context;
use super::names::{Section, quote};
use super::parameters::Sections;
use crate::document::{Map, Value};
use lineshaft_core::config::{AxisConfig, TableConfig};
use lineshaft_core::parameter::Applies;

/// Index of a table and location of the key; `None` if it has a problem.
pub(super) type Named<'d> = Option<(u16, Value<'d>)>;

/// Reads the key.
pub(super) fn pitch_error<'d>(map: &mut Map<'d>, sections: &mut Sections<'d>, cx: &Context<'d>) -> Option<Named<'d>> {
    let Some(value) = sections.value(map, "compensation.pitch_error") else { return Some(None) };
    let (_, place) = cx.names.find(&value, value.text()?, &[Section::Tables])?;
    Some(Some((u16::try_from(place).ok()?, value)))
}

/// Refuses a table that is not valid as pitch error of that axis.
pub(super) fn check(axis: &AxisConfig, named: &Named<'_>, tables: &[Option<TableConfig>]) {
    let Some((place, value)) = named else { return };
    if !Applies::Positioned.to(axis) {
        let sentence = format!("pitch_error is for {}", Applies::Positioned.text());
        value.refuse(sentence, Some("leave it out".to_owned()));
        return;
    }
    // A table that could not be read has its own problem.
    let Some(table) = tables.get(usize::from(*place)).and_then(Option::as_ref) else { return };
    if let Err(error) = axis.check_pitch_error(&table.table) {
        value.refuse(format!("pitch_error is {}: {error}", quote(&table.name)), None);
    }
}

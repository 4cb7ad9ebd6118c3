//! Limits of fields that depend on the cell: its axes, and the full scale of an analog output.

use crate::code::Code;
use crate::function::description::Description;
use crate::function::field::CellBound;
use crate::function::program::{Fault, LINES};
use crate::function::wires::{Sink, Wires};

/// Returns an error if a value of a whole set exceeds a limit of the cell.
pub(super) fn check_set_in_cell(wires: &Wires, values: &[i64]) -> Result<(), Fault> {
    let row = wires.kind.description();
    let mode = row.find("mode").and_then(|(_, place)| values.get(place)).copied();
    for field in row.fields.iter().filter(|field| field.bound.is_some()) {
        if let Some((_, place)) = row.find(field.name)
            && let Some(value) = values.get(place)
        {
            check_in_cell(wires, row, (place as u16, *value), mode)?;
        }
    }
    Ok(())
}

/// Returns an error if a value exceeds a limit of the cell. Without the `mode` of its set it is unknown whether the set
/// uses the value, so a voltage is accepted.
pub(super) fn check_in_cell(
    wires: &Wires,
    row: &Description,
    (place, value): (u16, i64),
    mode: Option<i64>,
) -> Result<(), Fault> {
    let Some((number, field, _)) = row.field_of(place.into()) else { return Ok(()) };
    let Some(limit) = field.bound else { return Ok(()) };
    let beyond = |bound: i64| Fault::new(Code::AMK_BEYOND).of(number).with(value, bound);
    match limit {
        CellBound::AxisMask if (wires.axes..LINES).any(|bit| value >> bit & 1 == 1) => {
            Err(Fault::new(Code::AMK_NO_AXIS).of(number).with(value, wires.axes as i64))
        }
        CellBound::AxisNumber if value > wires.axes as i64 => Err(beyond(wires.axes as i64)),
        CellBound::FullScale(bit)
            if matches!(wires.sink, Sink::Analog(..))
                && mode.is_some_and(|mode| mode & bit != 0)
                && value.saturating_abs() > wires.full_scale =>
        {
            Err(beyond(wires.full_scale * value.signum()))
        }
        _ => Ok(()),
    }
}

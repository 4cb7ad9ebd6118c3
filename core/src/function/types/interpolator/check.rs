//! Checks of the parameter set of an interpolator and of its tables.

use super::register::Marks;
use super::setup::Setup;
use crate::code::Code;
use crate::function::program::{Fault, LINES, Setting};
use crate::function::time::HALF_MS;
use crate::table::{CurveError, Form, Table};

/// Maximum duration of a table in parts of its unit, so that values of 2^30 times 2^31 do not overflow.
const LONGEST: i64 = 1 << 32;
/// Scaled values stay below this limit (AMK-FIPW-04).
const MAX_SCALED_VALUE: i128 = (1 << 31) - 1;

/// Returns the error of a value that the other fields do not allow.
pub(super) fn out_of_range(field: u16, asked: i64, limit: i64) -> Fault {
    Fault::new(Code::AMK_BEYOND).of(field).with(asked, limit)
}

/// Returns an error for a value that the mode does not use.
pub(super) fn needs(field: u16, asked: i64, value: i64, mode: i64) -> Result<(), Fault> {
    if asked == value { Ok(()) } else { Err(Fault::new(Code::AMK_MODE_FIELD).of(field).with(asked, mode)) }
}

/// Returns an error for a value outside `least` to `most`.
pub(super) fn within(field: u16, asked: i64, (least, most): (i64, i64)) -> Result<(), Fault> {
    match asked {
        _ if asked < least => Err(out_of_range(field, asked, least)),
        _ if asked > most => Err(out_of_range(field, asked, most)),
        _ => Ok(()),
    }
}

/// Returns an error for a mode by travel without a source.
pub(super) fn check_source(setting: &Setting<'_>, mode: i64, field: u16) -> Result<(), Fault> {
    if setting.has_source { Ok(()) } else { Err(Fault::new(Code::AMK_NO_SOURCE).of(field).with(mode, 0)) }
}

/// Returns an error for waiting for the zero pulse of a source that has none.
pub(super) fn check_zero_pulse(setting: &Setting<'_>, function: i64, field: u16) -> Result<(), Fault> {
    if setting.has_mark { Ok(()) } else { Err(Fault::new(Code::AMK_NO_ZERO_PULSE).of(field).with(function, 0)) }
}

/// Checks the fields of printing mark control against each other: `fields` are their numbers, in their order.
pub(super) fn check_marks(marks: &Marks, fields: [u16; 8], length: i64) -> Result<(), Fault> {
    let [format, _, shift, range, start, wide, weight, _] = fields;
    within(format, marks.format, (1, 32_767))?;
    within(shift, marks.shift, (0, marks.format - 1))?;
    within(range, marks.range, (0, marks.format / 2))?;
    within(start, marks.window.0, (0, length))?;
    within(wide, marks.window.1, (0, length - marks.window.0))?;
    match marks.weight {
        33..=127 => Err(out_of_range(weight, marks.weight, 32)),
        160.. => Err(out_of_range(weight, marks.weight, 159)),
        _ => Ok(()),
    }
}

/// Returns the time base of x: parts of half a millisecond, and parts of a call.
pub(super) fn time(call_ns: u64) -> (i64, i64) {
    let call = i64::try_from(call_ns).unwrap_or(i64::MAX).max(1);
    let (mut a, mut b) = (call, HALF_MS);
    while b != 0 {
        (a, b) = (b, a % b);
    }
    (HALF_MS / a, call / a)
}

/// Returns the maximum time of a table, in half milliseconds.
pub(super) fn longest(call_ns: u64) -> i64 {
    LONGEST / time(call_ns).0
}

/// Returns an error for a time that is too long for the time base of the calls.
pub(super) fn check_time(field: u16, half_ms: i64, call_ns: u64) -> Result<(), Fault> {
    let most = longest(call_ns);
    if half_ms <= most { Ok(()) } else { Err(out_of_range(field, half_ms, most)) }
}

/// Tables that a type accepts.
pub(super) struct AllowedTables {
    /// Maximum points of a table at equal distances.
    pub y: usize,
    /// Maximum points of a table with positions; 0 if the type has none.
    pub xy: usize,
    /// Minimum and maximum last position.
    pub length: (i64, i64),
}

/// Returns an error for tables that are missing or that are no curves of a type.
pub(super) fn check_tables(
    setting: &Setting<'_>,
    count: usize,
    takes: &AllowedTables,
    setup: &Setup,
) -> Result<(), Fault> {
    let there = count_tables(setting);
    if there < count {
        return Err(Fault::new(Code::AMK_TABLES_FEW).with(count as i64, there as i64));
    }
    let mut tables = setting.tables.iter().take(count).flatten().enumerate();
    tables.try_for_each(|(place, table)| {
        check_table(table, takes, setup).map_err(|(code, limit)| Fault::new(code).with(place as i64, limit))
    })
}

/// Returns the number of tables before the first missing one.
pub(super) fn count_tables(setting: &Setting<'_>) -> usize {
    setting.tables.iter().take(LINES).take_while(|table| table.is_some()).count()
}

fn check_table(table: &Table, takes: &AllowedTables, setup: &Setup) -> Result<(), (Code, i64)> {
    let most = if table.form() == Form::Xy { takes.xy } else { takes.y };
    if table.form() == Form::Words || most == 0 {
        return Err((Code::AMK_CURVE_FORM, takes.xy as i64));
    }
    // Tables are shorter than 2^17.
    let shape = table.shape().map_err(|error| match error {
        CurveError::Words => (Code::AMK_CURVE_FORM, takes.xy as i64),
        CurveError::Few(count) => (Code::AMK_CURVE_POINTS, count as i64),
        CurveError::First(value) => (Code::AMK_CURVE_FIRST, value),
        CurveError::Order(place) => (Code::AMK_CURVE_ORDER, place as i64),
        CurveError::Step(place) => (Code::AMK_CURVE_STEP, place as i64),
    })?;
    if table.len() > most {
        return Err((Code::AMK_CURVE_POINTS, table.len() as i64));
    }
    if let Some(last) = table.x().last().filter(|last| !(takes.length.0..=takes.length.1).contains(last)) {
        return Err((Code::AMK_CURVE_LENGTH, *last));
    }
    let scaled = (i128::from(shape.max_magnitude) * i128::from(setup.scale.mult.unsigned_abs())) >> setup.scale.div_exp;
    if scaled >= MAX_SCALED_VALUE {
        return Err((Code::AMK_CURVE_SCALED, i64::try_from(scaled).unwrap_or(i64::MAX)));
    }
    Ok(())
}

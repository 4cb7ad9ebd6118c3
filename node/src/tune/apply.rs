//! Writes gains into the cell file, like [`cell_file`] sets parameters; [`by_hand`] returns the lines
//! for manual editing.

use super::findings::Gain;
use crate::cell_file::{self, EditError, Setting};
use lineshaft_core::parameter::{Range, Row, Value};
use std::path::Path;

/// Returns lines to be pasted below an axis.
pub fn by_hand(gains: &[Gain]) -> String {
    gains.iter().map(|gain| format!("    {}: {}\n", gain.key, gain.written())).collect()
}

/// Writes gains of an axis into the cell file, whose text was `read` before the trial; returns those that changed. If
/// none changes, the file is not written.
///
/// # Errors
/// Returns an [`EditError`]; the file is then unchanged.
pub fn apply(path: &Path, read: &str, axis: &str, gains: &[Gain]) -> Result<Vec<Gain>, EditError> {
    let edited = cell_file::apply(path, read, &settings(axis, gains)?)?;
    let is_written = |gain: &&Gain| edited.written.iter().any(|setting| setting.key == gain.key);
    Ok(gains.iter().filter(is_written).copied().collect())
}

/// Converts gains to parameters of an axis.
///
/// # Errors
/// Returns an error if there is no such gain, or if its value is not permitted.
pub fn settings(axis: &str, gains: &[Gain]) -> Result<Vec<Setting>, EditError> {
    let setting = |gain: &Gain| {
        let refuse = || EditError::Value { key: gain.key.to_owned(), value: gain.written() };
        let (_, row) = Row::find(gain.key).ok_or_else(refuse)?;
        let value = match row.range {
            Range::Int(..) | Range::Among(_) if gain.new.fract() != 0.0 => return Err(refuse()),
            Range::Int(..) | Range::Among(_) => Value::Int(gain.new as i64),
            Range::Real(..) | Range::PositiveUpTo(_) => Value::Real(gain.new),
        };
        Ok(Setting { axis: axis.to_owned(), key: row.key, value, written: gain.written() })
    };
    gains.iter().map(setting).collect()
}

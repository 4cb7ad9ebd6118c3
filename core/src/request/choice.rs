//! Named values of a field.
//!
//! Law      a table has a value for each name; the place of a name is its number in ROS 2
//! Refuses  numbers beyond the table

use super::RequestError;

/// Returns the names of a table.
pub(super) fn names<T>(table: &[(&'static str, T)]) -> Vec<&'static str> {
    table.iter().map(|(name, _)| *name).collect()
}

/// Returns the value with that number.
pub(super) fn chosen<T: Copy>(field: &'static str, number: u8, table: &[(&'static str, T)]) -> Result<T, RequestError> {
    let found = table.get(usize::from(number)).map(|(_, value)| *value);
    found.ok_or_else(|| unknown(field, number, &names(table)))
}

/// Returns the number of the first name with that value; a number beyond the table if there is none.
pub(super) fn number_of<T: PartialEq>(table: &[(&'static str, T)], value: &T) -> u8 {
    (0..u8::MAX).zip(table).find(|(_, (_, known))| known == value).map_or(u8::MAX, |(number, _)| number)
}

/// Returns the error of a number beyond the names of a field.
pub(super) fn unknown(field: &'static str, number: u8, names: &[&str]) -> RequestError {
    let known: Vec<_> =
        names.iter().enumerate().map(|(place, name)| format!("{place} {}", name.to_uppercase())).collect();
    RequestError::UnknownChoice { field, value: number, known: known.join(", ") }
}

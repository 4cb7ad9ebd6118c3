//! Names of data types for the command line.

use super::DataType;

/// Name and data type.
const KINDS: [(&str, DataType); 14] = [
    ("bool", DataType::Boolean),
    ("u8", DataType::Unsigned8),
    ("u16", DataType::Unsigned16),
    ("u32", DataType::Unsigned32),
    ("u64", DataType::Unsigned64),
    ("i8", DataType::Integer8),
    ("i16", DataType::Integer16),
    ("i32", DataType::Integer32),
    ("i64", DataType::Integer64),
    ("f32", DataType::Real32),
    ("f64", DataType::Real64),
    ("string", DataType::VisibleString),
    ("bytes", DataType::OctetString),
    ("domain", DataType::Domain),
];

/// Returns the names of all types that can be given.
pub fn names() -> impl Iterator<Item = &'static str> + Clone {
    KINDS.iter().map(|row| row.0)
}

/// Returns the data type with a name.
pub fn named(name: &str) -> Option<DataType> {
    KINDS.iter().find(|row| row.0 == name).map(|row| row.1)
}

/// Returns the name of a data type: the one for the command line, otherwise that of the standard.
pub fn name(data_type: DataType) -> String {
    let known = KINDS.iter().find(|row| row.1 == data_type);
    known.map_or_else(|| data_type.to_string(), |row| row.0.to_owned())
}

/// Returns the names of all types that can be given, separated by commas.
pub fn list() -> String {
    names().collect::<Vec<_>>().join(", ")
}

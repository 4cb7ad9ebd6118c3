//! Properties of one object of a dictionary.

use lineshaft_cia402::dictionary::{DataType, Value};
use std::cmp::Ordering;

/// Object type of an index (CiA 301, table 42).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObjectType {
    /// An index without an object.
    Null,
    /// A large amount of data.
    Domain,
    /// Definition of a simple type.
    DefType,
    /// Definition of a record.
    DefStruct,
    /// A single value.
    Var,
    /// Values of the same type.
    Array,
    /// Values of different types.
    Record,
}

impl ObjectType {
    const ALL: [(u32, Self); 7] = [
        (0, Self::Null),
        (2, Self::Domain),
        (5, Self::DefType),
        (6, Self::DefStruct),
        (7, Self::Var),
        (8, Self::Array),
        (9, Self::Record),
    ];

    /// Returns the type with a number.
    pub(super) fn of(number: u32) -> Option<Self> {
        Self::ALL.iter().find(|row| row.0 == number).map(|row| row.1)
    }

    /// Returns the number of the type.
    pub(super) fn number(self) -> u32 {
        Self::ALL.iter().find(|row| row.1 == self).map_or(0, |row| row.0)
    }

    /// Returns true if the index itself has a value, at subindex 0.
    pub fn is_single(self) -> bool {
        matches!(self, Self::Domain | Self::DefType | Self::Var)
    }
}

/// Access type of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Read only.
    Ro,
    /// Write only.
    Wo,
    /// Read and write.
    Rw,
    /// Read and write; in a PDO it can only be sent.
    Rwr,
    /// Read and write; in a PDO it can only be received.
    Rww,
    /// Read only, with a constant value.
    Const,
}

impl Access {
    const ALL: [(&'static str, Self); 6] = [
        ("ro", Self::Ro),
        ("wo", Self::Wo),
        ("rw", Self::Rw),
        ("rwr", Self::Rwr),
        ("rww", Self::Rww),
        ("const", Self::Const),
    ];

    /// Returns the access type with a name. Upper and lower case are not distinguished.
    pub(super) fn of(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|row| row.0.eq_ignore_ascii_case(name)).map(|row| row.1)
    }

    /// Returns the name.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|row| row.1 == self).map_or("", |row| row.0)
    }

    /// Returns true if the object can be written.
    pub fn is_writable(self) -> bool {
        !matches!(self, Self::Ro | Self::Const)
    }

    /// Returns true if the object can be read.
    pub fn is_readable(self) -> bool {
        self != Self::Wo
    }
}

/// Value as the file gives it.
#[derive(Clone, Debug, PartialEq)]
pub enum FileValue {
    /// A fixed value.
    Value(Value),
    /// `$NODEID` plus a number; fits the data type for every node ID.
    NodeId {
        /// Number that is added.
        plus: u64,
    },
}

impl FileValue {
    /// Returns the value for a node; `None` if it depends on the node and the node is unknown.
    pub fn resolved(&self, data_type: DataType, node_id: Option<u8>) -> Option<Value> {
        match self {
            Self::Value(value) => Some(value.clone()),
            Self::NodeId { plus } => Value::of_number(data_type, i128::from(*plus) + i128::from(node_id?)).ok(),
        }
    }
}

/// Description of an index.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IndexDescription {
    /// Name of the index.
    pub name: String,
    /// Object type.
    pub object_type: ObjectType,
}

/// Object with a value: index and subindex.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Name, without that of the index.
    pub name: String,
    /// Data type.
    pub data_type: DataType,
    /// Access type.
    pub access: Access,
    /// Whether the object can be mapped to a PDO.
    pub is_mappable: bool,
    /// `ObjFlags`: bit 0, tools must not write the object with a configuration; bit 1, tools must not read it with a scan.
    pub flags: u32,
    /// Minimum value.
    pub low: Option<FileValue>,
    /// Maximum value.
    pub high: Option<FileValue>,
    /// Default value, before any write.
    pub default: Option<FileValue>,
    /// Value of the device configuration.
    pub parameter: Option<FileValue>,
}

impl Entry {
    /// Returns true if a configuration writes the object.
    pub fn is_configurable(&self) -> bool {
        self.access.is_writable() && self.flags & 1 == 0
    }

    /// Returns true if the minimum value exceeds the maximum value.
    pub(super) fn has_inverted_limits(&self) -> bool {
        let (Some(FileValue::Value(low)), Some(FileValue::Value(high))) = (&self.low, &self.high) else { return false };
        let order = match (low, high) {
            (Value::Real32(low), Value::Real32(high)) => low.partial_cmp(high),
            (Value::Real64(low), Value::Real64(high)) => low.partial_cmp(high),
            _ => low.number().zip(high.number()).map(|(low, high)| low.cmp(&high)),
        };
        order == Some(Ordering::Greater)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_numbers_are_those_of_the_standard() {
        for number in 0..20 {
            assert!(ObjectType::of(number).is_none_or(|object_type| object_type.number() == number));
        }
        assert_eq!(ObjectType::of(9), Some(ObjectType::Record));
        assert_eq!(ObjectType::of(1), None);
        assert_eq!(Access::of("RWW"), Some(Access::Rww));
        assert_eq!(Access::of("r"), None);
        assert!(!Access::of("Const").unwrap().is_writable());
    }

    #[test]
    fn value_with_node_id_needs_node() {
        let given = FileValue::NodeId { plus: 0x180 };
        assert_eq!(given.resolved(DataType::Unsigned32, None), None);
        assert_eq!(given.resolved(DataType::Unsigned32, Some(5)), Some(Value::Unsigned(0x185)));
    }
}

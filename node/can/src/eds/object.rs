//! What a dictionary says of one object.

use super::data_type::DataType;
use super::value::Value;
use std::cmp::Ordering;

/// What an index is (CiA 301, table 42).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObjectType {
    /// An index that exists without an object.
    Null,
    /// A large amount of data.
    Domain,
    /// The definition of a simple type.
    DefType,
    /// The definition of a record.
    DefStruct,
    /// One value.
    Var,
    /// Values of one type.
    Array,
    /// Values of several types.
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

    /// The type with a number.
    pub(super) fn of(number: u32) -> Option<Self> {
        Self::ALL.iter().find(|row| row.0 == number).map(|row| row.1)
    }

    /// Its number.
    pub(super) fn number(self) -> u32 {
        Self::ALL.iter().find(|row| row.1 == self).map_or(0, |row| row.0)
    }

    /// Does the index itself have a value, at subindex 0?
    pub fn is_single(self) -> bool {
        matches!(self, Self::Domain | Self::DefType | Self::Var)
    }
}

/// Who may do what with an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Read only.
    Ro,
    /// Write only.
    Wo,
    /// Read and write.
    Rw,
    /// Read and write; in a PDO only sent.
    Rwr,
    /// Read and write; in a PDO only received.
    Rww,
    /// Read only, and the value never changes.
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

    /// The access with a name, in large or small letters.
    pub(super) fn of(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|row| row.0.eq_ignore_ascii_case(name)).map(|row| row.1)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|row| row.1 == self).map_or("", |row| row.0)
    }

    /// May the object be written?
    pub fn is_writable(self) -> bool {
        !matches!(self, Self::Ro | Self::Const)
    }

    /// May the object be read?
    pub fn is_readable(self) -> bool {
        self != Self::Wo
    }
}

/// A value as the file gives it.
#[derive(Clone, Debug, PartialEq)]
pub enum Given {
    /// The value.
    Value(Value),
    /// `$NODEID` and what is added to it; fits its type for every node id.
    NodeId {
        /// What is added.
        plus: u64,
    },
}

impl Given {
    /// The value for a node; none where the node is not known.
    pub fn resolved(&self, data_type: DataType, node_id: Option<u8>) -> Option<Value> {
        match self {
            Self::Value(value) => Some(value.clone()),
            Self::NodeId { plus } => Value::of_number(data_type, i128::from(*plus) + i128::from(node_id?)).ok(),
        }
    }
}

/// An index.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Head {
    /// Its name.
    pub name: String,
    /// What it is.
    pub object_type: ObjectType,
}

/// An object with a value: index and subindex.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Its name, without that of the index.
    pub name: String,
    /// What its bytes are.
    pub data_type: DataType,
    /// Who may do what with it.
    pub access: Access,
    /// May a PDO carry it?
    pub is_mappable: bool,
    /// `ObjFlags`: bit 0, tools shall not write it with a configuration; bit 1, tools shall not read it with a scan.
    pub flags: u32,
    /// The least value.
    pub low: Option<Given>,
    /// The greatest value.
    pub high: Option<Given>,
    /// The value that the device has before anybody writes it.
    pub default: Option<Given>,
    /// The value that a device configuration gives it.
    pub parameter: Option<Given>,
}

impl Entry {
    /// Does a configuration write it?
    pub fn is_configurable(&self) -> bool {
        self.access.is_writable() && self.flags & 1 == 0
    }

    /// Is the least value above the greatest one?
    pub(super) fn has_no_room(&self) -> bool {
        let (Some(Given::Value(low)), Some(Given::Value(high))) = (&self.low, &self.high) else { return false };
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
    fn a_value_of_the_node_needs_the_node() {
        let given = Given::NodeId { plus: 0x180 };
        assert_eq!(given.resolved(DataType::Unsigned32, None), None);
        assert_eq!(given.resolved(DataType::Unsigned32, Some(5)), Some(Value::Unsigned(0x185)));
    }
}

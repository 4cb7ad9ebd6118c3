//! The object dictionary of a device, as its file says it.
//!
//! Law      a value of the configuration goes before the default; `$NODEID` is the node that the file was read for
//! Refuses  names that stand for no object or for several; values that the type or the access of an object does not allow
//! Source   CiA 306-1, CiA 301

use super::device::{Commissioning, DeviceInfo, FileInfo};
use super::object::{Entry, Given, Head};
use super::problem::{Problems, quoted};
use super::value::{Value, ValueError};
use crate::sdo::Object;
use std::collections::{BTreeMap, BTreeSet};

/// Bytes of a value as a text; a line has room for it and its key.
const LONGEST_VALUE: usize = 60_000;

/// A dictionary.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dictionary {
    /// What the file says of itself.
    pub file: FileInfo,
    /// What it says of the device.
    pub device: DeviceInfo,
    /// The place of the device on the bus, in a device configuration.
    pub commissioning: Option<Commissioning>,
    /// Remarks.
    pub comments: Vec<String>,
    /// Numbers of the data types that can fill a PDO.
    pub dummies: BTreeSet<u16>,
    pub(super) node_id: Option<u8>,
    pub(super) heads: BTreeMap<u16, Head>,
    pub(super) entries: BTreeMap<Object, Entry>,
    pub(super) warnings: Problems,
}

/// Why a name is not that of one object.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FindError {
    /// No object has it.
    #[error("no object has the name {}", quoted(.0))]
    None(String),
    /// Several objects have it.
    #[error("the name {} is that of {first} and of {second}: write the index", quoted(.name))]
    Several {
        /// The name.
        name: String,
        /// One of them.
        first: Object,
        /// Another one.
        second: Object,
    },
}

/// Why an object has no value in the configuration.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ConfigureError {
    /// The dictionary does not have it.
    #[error("{0} does not exist in the dictionary")]
    Missing(Object),
    /// It cannot be written.
    #[error("{0} cannot be written: its access is {1}")]
    Access(Object, &'static str),
    /// The value is not of its type.
    #[error("{0}: {1}")]
    Value(Object, ValueError),
    /// A value that a line of a file cannot say.
    #[error(
        "{0}: the value cannot stand in a file: it is empty, longer than a line, not finite, or has blanks around it or control characters"
    )]
    Line(Object),
    /// Its value is that of a node, and the node is not known.
    #[error("{0}: the value is $NODEID and a number, and the node id is not known")]
    NodeId(Object),
}

impl Dictionary {
    /// The node that `$NODEID` stands for.
    pub fn node_id(&self) -> Option<u8> {
        self.node_id
    }

    /// What was passed over in the file.
    pub fn warnings(&self) -> &Problems {
        &self.warnings
    }

    /// What was passed over; the dictionary forgets it.
    pub fn take_warnings(&mut self) -> Problems {
        std::mem::take(&mut self.warnings)
    }

    /// An index.
    pub fn head(&self, index: u16) -> Option<&Head> {
        self.heads.get(&index)
    }

    /// All of them, in order.
    pub fn heads(&self) -> impl Iterator<Item = (u16, &Head)> {
        self.heads.iter().map(|(index, head)| (*index, head))
    }

    /// An object.
    pub fn entry(&self, object: Object) -> Option<&Entry> {
        self.entries.get(&object)
    }

    /// All objects with a value, in order.
    pub fn entries(&self) -> impl Iterator<Item = (Object, &Entry)> {
        self.entries.iter().map(|(object, entry)| (*object, entry))
    }

    /// The objects of one index, in order.
    pub fn entries_of(&self, index: u16) -> impl Iterator<Item = (Object, &Entry)> {
        let all = Object { index, sub: 0 }..=Object { index, sub: u8::MAX };
        self.entries.range(all).map(|(object, entry)| (*object, entry))
    }

    /// The name of an object: that of its index, and behind a point that of its subindex.
    pub fn name(&self, object: Object) -> Option<String> {
        let (head, entry) = (self.heads.get(&object.index)?, self.entries.get(&object)?);
        Some(if head.object_type.is_single() { head.name.clone() } else { format!("{}.{}", head.name, entry.name) })
    }

    /// The object with a name, in large or small letters.
    ///
    /// # Errors
    /// A name of no object, or of several.
    pub fn find(&self, name: &str) -> Result<Object, FindError> {
        let wanted = name.trim().to_lowercase();
        let is_it = |object: &Object| self.name(*object).is_some_and(|name| name.to_lowercase() == wanted);
        let mut found = self.entries.keys().copied().filter(is_it);
        let first = found.next().ok_or_else(|| FindError::None(name.to_owned()))?;
        match found.next() {
            None => Ok(first),
            Some(second) => Err(FindError::Several { name: name.to_owned(), first, second }),
        }
    }

    fn resolved(&self, object: Object, which: fn(&Entry) -> Option<&Given>) -> Option<Value> {
        let entry = self.entries.get(&object)?;
        which(entry)?.resolved(entry.data_type, self.node_id)
    }

    /// The value that the device has by itself.
    pub fn default_value(&self, object: Object) -> Option<Value> {
        self.resolved(object, |entry| entry.default.as_ref())
    }

    /// The value that the configuration gives it.
    pub fn parameter_value(&self, object: Object) -> Option<Value> {
        self.resolved(object, |entry| entry.parameter.as_ref())
    }

    /// The value that holds: that of the configuration, or else the default.
    pub fn value(&self, object: Object) -> Option<Value> {
        self.resolved(object, |entry| entry.parameter.as_ref().or(entry.default.as_ref()))
    }

    /// The least value.
    pub fn low_limit(&self, object: Object) -> Option<Value> {
        self.resolved(object, |entry| entry.low.as_ref())
    }

    /// The greatest value.
    pub fn high_limit(&self, object: Object) -> Option<Value> {
        self.resolved(object, |entry| entry.high.as_ref())
    }

    /// Gives an object a value in the configuration, or takes it away.
    ///
    /// # Errors
    /// An object that does not exist or cannot be written, a value that is not of its type or no line of a file.
    pub fn set_parameter(&mut self, object: Object, value: Option<Value>) -> Result<(), ConfigureError> {
        let entry = self.entries.get_mut(&object).ok_or(ConfigureError::Missing(object))?;
        let Some(value) = value else {
            entry.parameter = None;
            return Ok(());
        };
        if !entry.access.is_writable() {
            return Err(ConfigureError::Access(object, entry.access.name()));
        }
        value.to_bytes(entry.data_type).map_err(|error| ConfigureError::Value(object, error))?;
        let text = value.to_string();
        // An empty value says nothing in a file.
        let is_line = !text.is_empty() && text.len() < LONGEST_VALUE && !text.chars().any(char::is_control);
        if !is_line || Value::parse(entry.data_type, &text).as_ref() != Ok(&value) {
            return Err(ConfigureError::Line(object));
        }
        entry.parameter = Some(Given::Value(value));
        Ok(())
    }

    /// What the configuration writes, in the order of the objects; objects that cannot be written and those whose `ObjFlags` keep tools
    /// from it are left out. The order is not that in which a PDO is mapped: who writes this disables the PDOs first.
    ///
    /// # Errors
    /// A value that needs a node id, where none is known.
    pub fn written(&self) -> Result<Vec<(Object, Vec<u8>)>, ConfigureError> {
        let mut written = Vec::new();
        for (object, entry) in self.entries().filter(|(_, entry)| entry.is_configurable()) {
            let Some(parameter) = &entry.parameter else { continue };
            let value = parameter.resolved(entry.data_type, self.node_id).ok_or(ConfigureError::NodeId(object))?;
            written
                .push((object, value.to_bytes(entry.data_type).map_err(|error| ConfigureError::Value(object, error))?));
        }
        Ok(written)
    }
}

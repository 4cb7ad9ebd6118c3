//! Object dictionary of a device, as its file describes it.
//!
//! Law      a configuration value has precedence over the default value; `$NODEID` is the node for which the file was read
//! Refuses  names that match no object or several; values that the type or the access of an object does not allow
//! Source   CiA 306-1, CiA 301

use super::device::{Commissioning, DeviceInfo, FileInfo};
use super::object::{Entry, FileValue, IndexDescription};
use super::problem::Problems;
use lineshaft_cia402::dictionary::{Value, ValueError, quoted};
use lineshaft_cia402::object::Object;
use std::collections::{BTreeMap, BTreeSet};

/// Maximum size of a value as text, in bytes. A line has room for it and its key.
const LONGEST_VALUE: usize = 60_000;

/// Object dictionary.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dictionary {
    /// Information about the file.
    pub file: FileInfo,
    /// Information about the device.
    pub device: DeviceInfo,
    /// Commissioning data of a device configuration.
    pub commissioning: Option<Commissioning>,
    /// Comment lines of the file.
    pub comments: Vec<String>,
    /// Numbers of the data types that can be mapped as dummy entries.
    pub dummies: BTreeSet<u16>,
    pub(super) node_id: Option<u8>,
    pub(super) heads: BTreeMap<u16, IndexDescription>,
    pub(super) entries: BTreeMap<Object, Entry>,
    pub(super) warnings: Problems,
}

/// Reason why a name does not identify an object.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FindError {
    /// No object has the name.
    #[error("no object has the name {}", quoted(.0))]
    None(String),
    /// Several objects have the name.
    #[error("the name {} is that of {first} and of {second}: write the index", quoted(.name))]
    Ambiguous {
        /// Name.
        name: String,
        /// First object with the name.
        first: Object,
        /// Second object with the name.
        second: Object,
    },
}

/// Reason why an object cannot have a configuration value.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ConfigureError {
    /// The dictionary lacks the object.
    #[error("{0} does not exist in the dictionary")]
    Missing(Object),
    /// The object is not writable.
    #[error("{0} cannot be written: its access is {1}")]
    Access(Object, &'static str),
    /// The value is not of the data type of the object.
    #[error("{0}: {1}")]
    Value(Object, ValueError),
    /// A line of a file cannot represent the value.
    #[error(
        "{0}: the value cannot stand in a file: it is empty, longer than a line, not finite, or has blanks around it or control characters"
    )]
    Line(Object),
    /// The value depends on the node ID, which is unknown.
    #[error("{0}: the value is $NODEID and a number, and the node id is not known")]
    NodeId(Object),
}

impl Dictionary {
    /// Returns the node ID that replaces `$NODEID`.
    pub fn node_id(&self) -> Option<u8> {
        self.node_id
    }

    /// Returns the warnings about ignored content of the file.
    pub fn warnings(&self) -> &Problems {
        &self.warnings
    }

    /// Returns the warnings about ignored content and removes them from the dictionary.
    pub fn take_warnings(&mut self) -> Problems {
        std::mem::take(&mut self.warnings)
    }

    /// Returns the description of an index.
    pub fn index_description(&self, index: u16) -> Option<&IndexDescription> {
        self.heads.get(&index)
    }

    /// Returns all indices with their descriptions, in ascending order.
    pub fn heads(&self) -> impl Iterator<Item = (u16, &IndexDescription)> {
        self.heads.iter().map(|(index, head)| (*index, head))
    }

    /// Returns an object.
    pub fn entry(&self, object: Object) -> Option<&Entry> {
        self.entries.get(&object)
    }

    /// Returns all objects with a value, in ascending order.
    pub fn entries(&self) -> impl Iterator<Item = (Object, &Entry)> {
        self.entries.iter().map(|(object, entry)| (*object, entry))
    }

    /// Returns the objects of one index, in ascending order.
    pub fn entries_of(&self, index: u16) -> impl Iterator<Item = (Object, &Entry)> {
        let all = Object { index, sub: 0 }..=Object { index, sub: u8::MAX };
        self.entries.range(all).map(|(object, entry)| (*object, entry))
    }

    /// Returns the name of an object: that of its index, and for a subindex a point and its name.
    pub fn name(&self, object: Object) -> Option<String> {
        let (head, entry) = (self.heads.get(&object.index)?, self.entries.get(&object)?);
        Some(if head.object_type.is_single() { head.name.clone() } else { format!("{}.{}", head.name, entry.name) })
    }

    /// Returns the object with a name. Upper and lower case are not distinguished.
    ///
    /// # Errors
    /// No object has the name, or several have it.
    pub fn find(&self, name: &str) -> Result<Object, FindError> {
        let wanted = name.trim().to_lowercase();
        let is_it = |object: &Object| self.name(*object).is_some_and(|name| name.to_lowercase() == wanted);
        let mut found = self.entries.keys().copied().filter(is_it);
        let first = found.next().ok_or_else(|| FindError::None(name.to_owned()))?;
        match found.next() {
            None => Ok(first),
            Some(second) => Err(FindError::Ambiguous { name: name.to_owned(), first, second }),
        }
    }

    fn resolved(&self, object: Object, which: fn(&Entry) -> Option<&FileValue>) -> Option<Value> {
        let entry = self.entries.get(&object)?;
        which(entry)?.resolved(entry.data_type, self.node_id)
    }

    /// Returns the default value.
    pub fn default_value(&self, object: Object) -> Option<Value> {
        self.resolved(object, |entry| entry.default.as_ref())
    }

    /// Returns the configuration value.
    pub fn parameter_value(&self, object: Object) -> Option<Value> {
        self.resolved(object, |entry| entry.parameter.as_ref())
    }

    /// Returns the effective value: that of the configuration, otherwise the default.
    pub fn value(&self, object: Object) -> Option<Value> {
        self.resolved(object, |entry| entry.parameter.as_ref().or(entry.default.as_ref()))
    }

    /// Returns the minimum value.
    pub fn low_limit(&self, object: Object) -> Option<Value> {
        self.resolved(object, |entry| entry.low.as_ref())
    }

    /// Returns the maximum value.
    pub fn high_limit(&self, object: Object) -> Option<Value> {
        self.resolved(object, |entry| entry.high.as_ref())
    }

    /// Sets or removes the configuration value of an object.
    ///
    /// # Errors
    /// The object does not exist or is not writable; the value is not of its type, or a line of a file cannot represent it.
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
        // An empty value means a missing value in a file.
        let is_line = !text.is_empty() && text.len() < LONGEST_VALUE && !text.chars().any(char::is_control);
        if !is_line || Value::parse(entry.data_type, &text).as_ref() != Ok(&value) {
            return Err(ConfigureError::Line(object));
        }
        entry.parameter = Some(FileValue::Value(value));
        Ok(())
    }

    /// Returns the objects that the configuration writes, in ascending order. Objects that are not writable and objects that `ObjFlags`
    /// excludes from configuration are left out. PDOs cannot be mapped in this order: the caller must disable them first.
    ///
    /// # Errors
    /// A value needs a node ID, which is unknown.
    pub fn configured_values(&self) -> Result<Vec<(Object, Vec<u8>)>, ConfigureError> {
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

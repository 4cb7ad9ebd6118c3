//! Requests of the vocabulary.

use super::{Commands, Register};
use crate::parameter::Value;

/// One request for one axis: registers are set, then the command flags run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// The axis.
    pub axis: u16,
    /// New values of registers, by offset.
    pub set: [Option<Value>; Register::COUNT],
    /// Command flags.
    pub commands: Commands,
}

impl Request {
    /// Returns the request with one more register.
    pub fn with(mut self, register: Register, value: Value) -> Self {
        if let Some(place) = self.set.get_mut(register as usize) {
            *place = Some(value);
        }
        self
    }

    /// Returns true if it has neither registers nor flags.
    pub fn asks_nothing(&self) -> bool {
        self.commands.is_empty() && self.set.iter().all(Option::is_none)
    }

    /// Returns the registers to set, with their values.
    pub fn registers(&self) -> impl Iterator<Item = (Register, Value)> + Clone + '_ {
        std::iter::zip(Register::ALL, &self.set).filter_map(|((register, _), value)| Some((register, (*value)?)))
    }
}

//! What a verb of the vocabulary asks for, and how names become it.

use super::{Command, Commands, Register};
use crate::config::MachineConfig;
use crate::parameter::{self, Measure, ParameterInput, Range, Value};
use crate::request::RequestError;
use crate::unit::excerpt;

/// One verb for one axis: registers are set, then the command flags run.
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
    /// The same with one more register.
    pub fn with(mut self, register: Register, value: Value) -> Self {
        if let Some(place) = self.set.get_mut(register as usize) {
            *place = Some(value);
        }
        self
    }

    /// Neither registers nor flags?
    pub fn asks_nothing(&self) -> bool {
        self.commands.is_empty() && self.set.iter().all(Option::is_none)
    }

    /// The registers that are set, with their values.
    pub fn registers(&self) -> impl Iterator<Item = (Register, Value)> + '_ {
        std::iter::zip(Register::ALL, &self.set).filter_map(|((register, _), value)| Some((register, (*value)?)))
    }
}

impl MachineConfig {
    /// A register by its name, and its new value.
    ///
    /// # Errors
    /// An unknown name, a value that the register cannot hold.
    pub fn resolve_saia_register(&self, name: &str, input: &ParameterInput) -> Result<(Register, Value), RequestError> {
        let known = || Register::ALL.map(|(register, _)| register.name()).join(", ");
        let unknown = || RequestError::UnknownWord { what: "register", name: excerpt(name), known: known() };
        let register = Register::find(name).ok_or_else(unknown)?;
        let (_, row) = register.row().ok_or_else(unknown)?;
        let bad = |value: String| {
            let allowed = match (row.measure, row.range) {
                (Measure::Integer, Range::Int(low, high)) => format!("a whole number {low}..{high}"),
                (_, Range::Real(low, high)) => format!("a number {low}..{high:e}"),
                _ => row.measure.expected(),
            };
            RequestError::BadParameter { name: name.to_owned(), value, allowed }
        };
        let value = match (row.measure, input) {
            (Measure::Integer, ParameterInput::Integer(value)) => Value::Int(*value),
            (Measure::Number, ParameterInput::Integer(value)) => Value::Real(*value as f64),
            // There is one zero.
            (Measure::Number, ParameterInput::Number(value)) => Value::Real(*value + 0.0),
            (_, ParameterInput::Integer(value)) => return Err(bad(value.to_string())),
            (_, ParameterInput::Number(value)) => return Err(bad(value.to_string())),
            (_, ParameterInput::Text(text)) => return Err(bad(excerpt(text))),
            (_, ParameterInput::Quantity(quantity)) => return Err(bad(quantity.to_string())),
            (_, ParameterInput::Unset) => return Err(bad("null".to_owned())),
        };
        let mut scratch = parameter::AxisParameters::new(1.0, 1.0);
        let shown = match value {
            Value::Int(value) => value.to_string(),
            Value::Real(value) => value.to_string(),
            Value::Unset => String::new(),
        };
        row.assign(&mut scratch, value).map_err(|_| bad(shown))?;
        Ok((register, value))
    }

    /// A command flag by its name.
    ///
    /// # Errors
    /// An unknown name.
    pub fn resolve_saia_command(&self, name: &str) -> Result<Command, RequestError> {
        Command::find(name).ok_or_else(|| {
            let known: Vec<&str> = Command::ALL.iter().map(|(_, name)| *name).collect();
            RequestError::UnknownWord { what: "command", name: excerpt(name), known: known.join(", ") }
        })
    }
}

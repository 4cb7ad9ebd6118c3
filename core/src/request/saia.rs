//! Conversion of registers and command flags of the servo module from their names.

use super::RequestError;
use crate::config::MachineConfig;
use crate::parameter::{self, Measure, ParameterInput, Range, Value};
use crate::unit::excerpt;
use crate::vocabulary::saia::{Command, Register};

impl MachineConfig {
    /// Returns a register by its name, and its new value.
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
            // Removes the sign of -0.
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

    /// Returns a command flag by its name.
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

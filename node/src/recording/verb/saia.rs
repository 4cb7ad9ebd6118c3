//! Writes a verb `saia` as text.

use super::write::{Entries, Scalar};
use lineshaft_core::parameter::Value;
use lineshaft_core::vocabulary::saia::{Command, Request};
use serde::Serialize;

/// Arguments of the verb.
#[derive(Serialize)]
pub(super) struct Saia<'a> {
    axis: &'a str,
    #[serde(skip_serializing_if = "Entries::is_empty")]
    set: Entries,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    commands: Vec<&'static str>,
}

/// Returns the arguments of the verb; default values are left out.
pub(super) fn saia<'a>(request: &Request, axis: &'a str) -> Saia<'a> {
    let registers = request.registers().map(|(register, value)| {
        let value = match value {
            Value::Int(value) => Scalar::Whole(value.into()),
            Value::Real(value) => Scalar::Real(value),
            Value::Unset => Scalar::Nothing,
        };
        (register.name().to_owned(), value)
    });
    Saia { axis, set: Entries(registers.collect()), commands: request.commands.iter().map(Command::name).collect() }
}

//! Writes a verb `saia` as text.

use super::write::{Entries, Scalar};
use lineshaft_core::parameter::Value;
use lineshaft_core::vocabulary::saia::Request;

/// Returns the arguments of the verb; default values are left out.
pub(super) fn saia(request: &Request, axis: &str) -> Entries {
    let registers = request.registers().map(|(register, value)| {
        let value = match value {
            Value::Int(value) => Scalar::Whole(value.into()),
            Value::Real(value) => Scalar::Real(value),
            Value::Unset => Scalar::Nothing,
        };
        (register.name().to_owned(), value)
    });
    let commands: Vec<Scalar> = request.commands.iter().map(|command| command.name().into()).collect();
    Entries::some([
        ("axis", Some(axis.into())),
        ("set", Entries(registers.collect()).unless_empty()),
        ("commands", (!commands.is_empty()).then_some(Scalar::List(commands))),
    ])
}

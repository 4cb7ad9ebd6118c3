//! Verb `saia` (contract section 9): registers are set, then the command flags are executed.

use super::amount::parameter_input;
use super::{Effect, Reader};
use crate::document::Value;
use lineshaft_core::command::Action;
use lineshaft_core::parameter::ParameterInput;
use lineshaft_core::request::RequestError;
use lineshaft_core::vocabulary::saia::Request;

impl Reader<'_> {
    pub(super) fn saia(&self, value: &Value<'_>) -> Option<Effect> {
        let mut map = value.map("saia")?;
        let (axis, set, commands) = (map.required("axis"), map.optional("set"), map.optional("commands"));
        map.finish();
        let axis = axis?;
        let mut request = Request::default();
        // All arguments are read, so that all problems are reported.
        let found = self.note(&axis, self.names.config.find_axis(axis.text()?).map(|(index, _)| index));
        let mut refused = found.as_ref().err().cloned();
        let mut is_good = refused.as_ref().is_none_or(Option::is_some);
        if let Ok(index) = found {
            request.axis = index;
        }
        let mut take = |result: Result<(), Option<Box<Effect>>>| {
            if let Err(deed) = result {
                is_good &= deed.is_some();
                refused = refused.take().or(Some(deed));
            }
        };
        let registers = set.as_ref().map_or(Some(Vec::new()), Value::entries)?;
        for (key, input) in &registers {
            take(self.saia_register(key, input, &mut request));
        }
        let flags = commands.as_ref().map_or(Some(Vec::new()), Value::list)?;
        for flag in &flags {
            take(self.saia_command(flag, &mut request));
        }
        let is_empty = is_good && refused.is_none() && request.asks_nothing();
        if !is_good || is_empty && self.refuse_nothing(value, "saia", &["axis", "set", "commands"]) {
            return None;
        }
        refused.map_or_else(|| Some(Effect::Command(Action::vocabulary(request))), |deed| deed.map(|deed| *deed))
    }

    fn saia_register(
        &self,
        key: &Value<'_>,
        input: &Value<'_>,
        request: &mut Request,
    ) -> Result<(), Option<Box<Effect>>> {
        let name = key.text().ok_or(None)?;
        let given = match input.peek().and_then(hexadecimal) {
            Some(number) => ParameterInput::Integer(number),
            None => parameter_input(input, None).ok_or(None)?,
        };
        let resolved = self.names.config.resolve_saia_register(name, &given);
        let place = if matches!(resolved, Err(RequestError::UnknownWord { .. })) { key } else { input };
        let (register, value) = self.note(place, resolved)?;
        *request = std::mem::take(request).with(register, value);
        Ok(())
    }

    fn saia_command(&self, flag: &Value<'_>, request: &mut Request) -> Result<(), Option<Box<Effect>>> {
        let name = flag.text().ok_or(None)?;
        let command = self.note(flag, self.names.config.resolve_saia_command(name))?;
        if !request.commands.insert(command) {
            flag.refuse(format!("{name} stands twice; a flag is set once"), None);
            return Err(None);
        }
        Ok(())
    }

    /// Returns the error of a part of the request: a refusal that the step expects, or `None` after a problem was
    /// reported.
    fn note<T>(&self, value: &Value<'_>, result: Result<T, RequestError>) -> Result<T, Option<Box<Effect>>> {
        result.map_err(|error| self.to_command(value, Err(error)).map(Box::new))
    }
}

/// Parses a number in the format of the manual: `41BH`.
fn hexadecimal(text: &str) -> Option<i64> {
    let digits = text.strip_suffix(['H', 'h'])?;
    let is_number = digits.starts_with(|c: char| c.is_ascii_digit()) && digits.chars().all(|c| c.is_ascii_hexdigit());
    is_number.then(|| u32::from_str_radix(digits, 16).ok())?.map(|bits| i64::from(bits.cast_signed()))
}

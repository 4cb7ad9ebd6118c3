//! Parameters of the node itself, in addition to those of the machine: they have no object, and do not affect motion directly.

use super::catalogue::power_of_ten;
use crate::layer::{CreateError, NodeHandle, OverrideValue, Overrides};
use lineshaft_core::unit::{excerpt, number_to_text};
use lineshaft_msgs::foreign::rcl_interfaces::msg::{ParameterDescriptor, ParameterType, ParameterValue};
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use tokio::sync::watch;

/// Parameters of the node, by name.
#[derive(Debug)]
pub(in crate::surface) struct OwnParameters {
    state: Mutex<State>,
    /// Version, which is incremented with every change.
    version: watch::Sender<u64>,
}

#[derive(Debug)]
struct State {
    declared: BTreeMap<String, OwnParameter>,
    /// Names that clients may confuse with parameter names, and the intended parameters.
    misleading_names: BTreeMap<String, String>,
    /// Overrides of parameters that are not declared yet.
    overrides: Overrides,
    /// Refused overrides, one message each.
    refused: Vec<String>,
}

impl State {
    /// Returns the message that a name is refused because it is not the intended parameter name.
    fn rename(&self, name: &str) -> Option<String> {
        let meant = self.misleading_names.get(name)?;
        Some(format!("parameter `{name}` has not been declared; by the joint name it is `{meant}`"))
    }
}

/// Parameter of the node itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::surface) struct OwnParameter {
    /// Descriptor: name, type, range, description.
    pub descriptor: ParameterDescriptor,
    /// Value.
    pub value: ParameterValue,
    /// Allowed strings; empty: any string.
    pub words: &'static [&'static str],
}

/// Values of all parameters at one moment.
pub(in crate::surface) struct Values<'s>(&'s BTreeMap<String, OwnParameter>);

impl Values<'_> {
    /// Returns a number; 0 if the parameter is missing.
    pub(in crate::surface) fn real(&self, name: &str) -> f64 {
        match self.0.get(name) {
            Some(own) if own.value.r#type == ParameterType::PARAMETER_DOUBLE => own.value.double_value,
            _ => 0.0,
        }
    }

    /// Returns a string; empty if the parameter is missing.
    pub(in crate::surface) fn string(&self, name: &str) -> &str {
        self.0.get(name).map(|own| own.value.string_value.as_str()).unwrap_or_default()
    }

    /// Returns a switch; false if the parameter is missing.
    pub(in crate::surface) fn switch(&self, name: &str) -> bool {
        self.0.get(name).is_some_and(|own| own.value.bool_value)
    }
}

impl Default for OwnParameters {
    fn default() -> Self {
        Self::new(Overrides::default())
    }
}

impl OwnParameters {
    /// Creates an empty set; each declared parameter gets its override.
    pub(crate) fn new(overrides: Overrides) -> Self {
        let state =
            State { declared: BTreeMap::new(), misleading_names: BTreeMap::new(), overrides, refused: Vec::new() };
        Self { state: Mutex::new(state), version: watch::Sender::new(0) }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Declares a parameter; one with the same name is replaced. An override replaces its default value, even if the parameter is read-only
    /// later. [`OwnParameters::check`] reports an invalid override.
    pub(crate) fn declare(&self, own: OwnParameter) {
        let mut state = self.state();
        let OwnParameter { descriptor, mut value, words } = own;
        if let Some(OverrideValue { value: given, place, .. }) = state.overrides.take(&descriptor.name) {
            match fitting(&descriptor, words, given) {
                Ok(given) => value = given,
                Err(sentence) => state.refused.push(format!("{place}: {sentence}")),
            }
        }
        state.declared.insert(descriptor.name.clone(), OwnParameter { descriptor, value, words });
        drop(state);
        self.version.send_modify(|version| *version += 1);
    }

    /// Refuses values for `name` with a message that names `meant`, the intended parameter.
    pub(crate) fn rename(&self, name: String, meant: String) {
        self.state().misleading_names.insert(name, meant);
    }

    /// Declares a switch that is off by default.
    pub(crate) fn declare_switch(&self, name: &str, description: &str) {
        let (name, description) = (name.to_owned(), description.to_owned());
        let r#type = ParameterType::PARAMETER_BOOL;
        let descriptor = ParameterDescriptor { name, r#type, description, ..ParameterDescriptor::default() };
        self.declare(OwnParameter {
            descriptor,
            value: ParameterValue { r#type, ..ParameterValue::default() },
            ..OwnParameter::default()
        });
    }

    /// Reports invalid overrides, once all parameters are declared.
    ///
    /// # Errors
    /// All overrides that are refused or match no parameter, in one message.
    pub(crate) fn check(&self) -> Result<(), CreateError> {
        let state = self.state();
        let strict = state.overrides.iter().filter(|(_, given)| given.is_for_this_node_only);
        let renamed = strict.filter_map(|(name, given)| Some(format!("{}: {}", given.place, state.rename(name)?)));
        let refused: Vec<String> = state.refused.iter().cloned().chain(renamed).collect();
        if !refused.is_empty() {
            return Err(CreateError::Given(refused.join("; ")));
        }
        for warning in state.overrides.check_unused().map_err(CreateError::Given)? {
            tracing::warn!("{warning}; it was given to all nodes");
        }
        Ok(())
    }

    /// Returns the parameter with this name.
    pub(crate) fn get(&self, name: &str) -> Option<OwnParameter> {
        self.state().declared.get(name).cloned()
    }

    /// Returns all parameters, ascending by name.
    pub(crate) fn all(&self) -> BTreeMap<String, OwnParameter> {
        self.state().declared.clone()
    }

    /// Returns a receiver that is notified when a parameter is changed or declared.
    pub(crate) fn changes(&self) -> watch::Receiver<u64> {
        self.version.subscribe()
    }

    /// Returns the names of all parameters.
    #[cfg(test)]
    pub(crate) fn names(&self) -> Vec<String> {
        self.all().keys().cloned().collect()
    }

    /// Reads several values at once: either all or none of the values of an atomic set.
    pub(in crate::surface) fn read<T>(&self, read: impl FnOnce(&Values<'_>) -> T) -> T {
        read(&Values(&self.state().declared))
    }

    /// Returns a number; 0 if the parameter is missing.
    pub(crate) fn real(&self, name: &str) -> f64 {
        self.read(|values| values.real(name))
    }

    /// Returns a switch; false if the parameter is missing.
    pub(crate) fn switch(&self, name: &str) -> bool {
        self.read(|values| values.switch(name))
    }

    /// Returns the value of a client as it will be shown; `None` if no parameter has the name.
    ///
    /// # Errors
    /// The value cannot be set.
    pub(crate) fn fitting(&self, name: &str, value: &ParameterValue) -> Option<Result<ParameterValue, String>> {
        let Some(own) = self.get(name) else { return self.state().rename(name).map(Err) };
        let fitting = fitting(&own.descriptor, own.words, value.clone());
        Some(match own.descriptor.read_only && fitting.as_ref() != Ok(&own.value) {
            true => Err(format!("{name} is read-only: it is given at the start, with -p or --params-file")),
            false => fitting,
        })
    }

    /// Sets values that were checked by [`Self::fitting`].
    pub(crate) fn set(&self, values: impl IntoIterator<Item = (String, ParameterValue)>) {
        let mut state = self.state();
        for (name, value) in values {
            if let Some(own) = state.declared.get_mut(&name) {
                own.value = value;
            }
        }
        drop(state);
        self.version.send_modify(|version| *version += 1);
    }
}

/// Declares the QoS of the created topics, with their overrides.
///
/// # Errors
/// A QoS override matches no topic of the node.
pub(super) fn declare_qos(own: &OwnParameters, node: &NodeHandle) -> Result<(), CreateError> {
    for warning in node.unused_qos().check_unused().map_err(CreateError::Given)? {
        tracing::warn!("{warning}; it was given to all nodes");
    }
    for (name, value) in node.qos_parameters() {
        let (policy, topic) = match name.rsplit('.').collect::<Vec<_>>()[..] {
            [policy, end, topic, ..] => (policy, format!("{end} {topic}")),
            _ => continue,
        };
        let description = format!("QoS policy {policy} of {topic}.");
        let r#type = value.r#type;
        let descriptor = ParameterDescriptor { name, r#type, description, read_only: true, ..Default::default() };
        own.declare(OwnParameter { descriptor, value, ..OwnParameter::default() });
    }
    Ok(())
}

/// Returns the value as the parameter accepts it.
///
/// # Errors
/// Another type, a number outside the range, or a string that is not allowed.
fn fitting(
    descriptor: &ParameterDescriptor,
    words: &[&str],
    mut value: ParameterValue,
) -> Result<ParameterValue, String> {
    let name = &descriptor.name;
    match (value.r#type, descriptor.r#type) {
        (given, declared) if given == declared => {}
        (_, _) if descriptor.dynamic_typing => {}
        (ParameterType::PARAMETER_STRING, ParameterType::PARAMETER_DOUBLE)
            if let Some(double_value) = power_of_ten(&value.string_value) =>
        {
            value = ParameterValue { r#type: descriptor.r#type, double_value, ..ParameterValue::default() };
        }
        // As for parameters of the machine, an integer is accepted for a double.
        (ParameterType::PARAMETER_INTEGER, ParameterType::PARAMETER_DOUBLE) => {
            let double_value = value.integer_value as f64;
            value = ParameterValue { r#type: descriptor.r#type, double_value, ..ParameterValue::default() };
        }
        (ParameterType::PARAMETER_INTEGER_ARRAY, ParameterType::PARAMETER_DOUBLE_ARRAY) => {
            let double_array_value = value.integer_array_value.iter().map(|&number| number as f64).collect();
            value = ParameterValue { r#type: descriptor.r#type, double_array_value, ..ParameterValue::default() };
        }
        // An empty list is accepted for any list type.
        (
            ParameterType::PARAMETER_BYTE_ARRAY,
            ParameterType::PARAMETER_BOOL_ARRAY..=ParameterType::PARAMETER_STRING_ARRAY,
        ) if value.byte_array_value.is_empty() => {
            value.r#type = descriptor.r#type;
        }
        (given, declared) => {
            return Err(format!("{name} cannot be {}; {} is needed", type_name(given), type_name(declared)));
        }
    }
    let integers = match value.r#type {
        ParameterType::PARAMETER_INTEGER => std::slice::from_ref(&value.integer_value),
        _ => &value.integer_array_value[..],
    };
    if let Some(range) = descriptor.integer_range.first()
        && let Some(bad) =
            integers.iter().find(|&&number| !is_whole_step(number, range.from_value, range.to_value, range.step))
    {
        let step = if range.step > 1 { format!(" in steps of {}", range.step) } else { String::new() };
        return Err(format!("{name} is {bad}; {} to {}{step} is allowed", range.from_value, range.to_value));
    }
    let reals = match value.r#type {
        ParameterType::PARAMETER_DOUBLE => std::slice::from_ref(&value.double_value),
        _ => &value.double_array_value[..],
    };
    if let Some(bad) = reals.iter().find(|number| !number.is_finite()) {
        return Err(format!("{name} is {}; a finite number is needed", number_to_text(*bad)));
    }
    if let Some(range) = descriptor.floating_point_range.first()
        && let Some(bad) = reals.iter().find(|&&number| !(range.from_value..=range.to_value).contains(&number))
    {
        let [bad, from, to] = [*bad, range.from_value, range.to_value].map(number_to_text);
        return Err(format!("{name} is {bad}; {from} to {to} is allowed"));
    }
    if value.r#type == ParameterType::PARAMETER_STRING
        && !words.is_empty()
        && !words.contains(&value.string_value.as_str())
    {
        let bad = excerpt(&value.string_value);
        return Err(format!("{name} is `{bad}`; {} is allowed", words.join(" or ")));
    }
    Ok(value)
}

/// Returns true if a number is in a range, and on one of its steps or at its end.
fn is_whole_step(number: i64, from: i64, to: i64, step: u64) -> bool {
    let steps = i128::from(number) - i128::from(from);
    (from..=to).contains(&number) && (step == 0 || number == to || steps % i128::from(step) == 0)
}

/// Returns the name of a type.
pub(in crate::surface) fn type_name(number: u8) -> &'static str {
    match number {
        ParameterType::PARAMETER_NOT_SET => "without a value",
        ParameterType::PARAMETER_BOOL => "a bool",
        ParameterType::PARAMETER_INTEGER => "an integer",
        ParameterType::PARAMETER_DOUBLE => "a double",
        ParameterType::PARAMETER_STRING => "a string",
        // The element type of an empty list is unknown; it arrives as a list of bytes.
        ParameterType::PARAMETER_BYTE_ARRAY => "a list",
        ParameterType::PARAMETER_BOOL_ARRAY => "a list of bools",
        ParameterType::PARAMETER_INTEGER_ARRAY => "a list of integers",
        ParameterType::PARAMETER_DOUBLE_ARRAY => "a list of doubles",
        ParameterType::PARAMETER_STRING_ARRAY => "a list of strings",
        _ => "of an unknown type",
    }
}

#[cfg(test)]
mod tests;

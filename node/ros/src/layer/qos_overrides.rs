//! QoS overrides at the start: `qos_overrides.<full topic>.publisher.depth` and others, as in rclcpp.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use lineshaft_msgs::foreign::rcl_interfaces::msg::{ParameterType, ParameterValue};

use super::arguments::{OverrideValue, Overrides};
use super::name::FullName;
use crate::link::qos::Qos;

const PREFIX: &str = "qos_overrides.";

/// QoS overrides for topics, and the resulting QoS.
#[derive(Debug, Default)]
pub(super) struct QosOverrides {
    given: Mutex<Overrides>,
    /// QoS of the topics so far, as parameters.
    shown: Mutex<BTreeMap<String, ParameterValue>>,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl QosOverrides {
    /// Removes the QoS overrides from all overrides.
    pub(super) fn new(all: &mut Overrides) -> Self {
        let given = all.take_matching(|name| name.starts_with(PREFIX));
        Self { given: Mutex::new(given), shown: Mutex::default() }
    }

    /// Returns the QoS of a topic with this default; `end` is `publisher` or `subscription`.
    ///
    /// # Errors
    /// The override is invalid, as a message.
    pub(super) fn apply(&self, topic: &FullName, end: &str, default: Qos) -> Result<Qos, String> {
        let name = |policy: &str| format!("{PREFIX}{topic}.{end}.{policy}");
        let mut given = locked(&self.given);
        let mut shown = locked(&self.shown);
        // A topic that is opened again has the same QoS as before.
        let mut taken = |policy: &str| {
            let name = name(policy);
            let before = || {
                Some(OverrideValue {
                    value: shown.get(&name)?.clone(),
                    place: name.clone(),
                    is_of_file: false,
                    is_for_this_node_only: true,
                })
            };
            given.take(&name).or_else(before)
        };
        let mut qos = default;
        word(taken("history"), &["keep_last"])?;
        if let Some(given) = taken("depth") {
            qos.depth = depth(&given)?;
        }
        if let Some(index) = word(taken("reliability"), &["best_effort", "reliable"])? {
            qos.reliable = index == 1;
        }
        if let Some(index) = word(taken("durability"), &["volatile", "transient_local"])? {
            qos.latched = index == 1;
        }
        for (policy, word) in [
            ("history", "keep_last"),
            ("reliability", if qos.reliable { "reliable" } else { "best_effort" }),
            ("durability", if qos.latched { "transient_local" } else { "volatile" }),
        ] {
            let r#type = ParameterType::PARAMETER_STRING;
            let value = ParameterValue { r#type, string_value: word.to_owned(), ..ParameterValue::default() };
            shown.insert(name(policy), value);
        }
        let (r#type, integer_value) = (ParameterType::PARAMETER_INTEGER, i64::from(qos.depth));
        shown.insert(name("depth"), ParameterValue { r#type, integer_value, ..ParameterValue::default() });
        Ok(qos)
    }

    /// Returns the QoS of all topics so far, as parameters.
    pub(super) fn shown(&self) -> Vec<(String, ParameterValue)> {
        locked(&self.shown).iter().map(|(name, value)| (name.clone(), value.clone())).collect()
    }

    /// Returns overrides that match no topic.
    pub(super) fn unused_overrides(&self) -> Overrides {
        locked(&self.given).clone()
    }
}

/// Returns the index of a given word among the allowed ones.
fn word(given: Option<OverrideValue>, allowed: &[&str]) -> Result<Option<usize>, String> {
    let Some(given) = given else { return Ok(None) };
    let is_text = given.value.r#type == ParameterType::PARAMETER_STRING;
    let index = allowed.iter().position(|word| is_text && *word == given.value.string_value);
    let sentence = || {
        let said = if is_text { format!("`{}`", given.value.string_value) } else { "no string".to_owned() };
        format!("{}: the value is {said}; {} is allowed", given.place, allowed.join(" or "))
    };
    index.map(Some).ok_or_else(sentence)
}

fn depth(given: &OverrideValue) -> Result<u16, String> {
    let value = &given.value;
    let depth = Some(value.integer_value).filter(|_| value.r#type == ParameterType::PARAMETER_INTEGER);
    let depth = depth.and_then(|depth| u16::try_from(depth).ok()).filter(|depth| *depth > 0);
    depth.ok_or_else(|| {
        let said = match value.r#type {
            ParameterType::PARAMETER_INTEGER => value.integer_value.to_string(),
            _ => "no integer".to_owned(),
        };
        format!("{}: the value is {said}; 1 to 65535 is allowed", given.place)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layer::{NodeName, RosArguments};

    fn given(line: &str) -> (QosOverrides, Overrides) {
        let words = line.split_whitespace().flat_map(|word| ["-p".to_owned(), word.to_owned()]);
        let (arguments, _) = RosArguments::take(std::iter::once("--ros-args".to_owned()).chain(words)).unwrap();
        let mut all = arguments.overrides(&NodeName::new("/", "n").unwrap());
        (QosOverrides::new(&mut all), all)
    }

    fn topic() -> FullName {
        NodeName::new("/", "n").unwrap().expand("/a").unwrap()
    }

    #[test]
    fn what_was_given_for_a_topic_and_its_end_is_applied() {
        let (overrides, others) = given(
            "qos_overrides./a.publisher.depth:=3 qos_overrides./a.publisher.reliability:=best_effort \
             qos_overrides./a.publisher.durability:=transient_local qos_overrides./a.publisher.history:=keep_last other:=1",
        );
        assert_eq!(others.iter().count(), 1);
        let expected = Qos { depth: 3, reliable: false, latched: true, ..Qos::STREAM };
        assert_eq!(overrides.apply(&topic(), "publisher", Qos::STREAM), Ok(expected));
        assert!(overrides.unused_overrides().is_empty());
        assert_eq!(overrides.apply(&topic(), "subscription", Qos::CLOCK), Ok(Qos::CLOCK));
        assert_eq!(overrides.apply(&topic(), "publisher", Qos::STREAM), Ok(expected), "opened again");
        let shown = overrides.shown();
        assert_eq!(shown.len(), 8);
        assert_eq!(shown[0].0, "qos_overrides./a.publisher.depth");
        assert_eq!(shown[0].1.integer_value, 3);
        assert_eq!(shown[7].1.string_value, "best_effort");
    }

    #[test]
    fn invalid_qos_is_refused_with_allowed_values() {
        for (line, sentence) in [
            ("publisher.depth:=0", "the value is 0; 1 to 65535 is allowed"),
            ("publisher.depth:=65536", "the value is 65536; 1 to 65535 is allowed"),
            ("publisher.depth:=1.0", "the value is no integer; 1 to 65535 is allowed"),
            ("publisher.reliability:=true", "the value is no string; best_effort or reliable is allowed"),
            ("publisher.reliability:=best", "the value is `best`; best_effort or reliable is allowed"),
            ("publisher.durability:=persistent", "the value is `persistent`; volatile or transient_local is allowed"),
            ("publisher.history:=keep_all", "the value is `keep_all`; keep_last is allowed"),
        ] {
            let (overrides, _) = given(&format!("qos_overrides./a.{line}"));
            let error = overrides.apply(&topic(), "publisher", Qos::STREAM).unwrap_err();
            assert_eq!(error, format!("-p qos_overrides./a.{}: {sentence}", line.split(":=").next().unwrap()));
        }
        let (overrides, _) = given("qos_overrides./b.publisher.depth:=1");
        overrides.apply(&topic(), "publisher", Qos::STREAM).unwrap();
        assert!(overrides.unused_overrides().check_unused().is_err());
    }
}

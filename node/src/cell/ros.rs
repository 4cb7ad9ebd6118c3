//! Reads section `ros`.

use super::names::quote;
use super::record_topics::{self, RecordTopics};
use crate::document::{Value, unit_of_bare};
use lineshaft_core::unit::Dimension;
use lineshaft_ros::layer::NodeName;
use std::ops::RangeInclusive;
use std::time::Duration;

/// Maximum length of the node name and of the namespace.
const LONGEST: usize = 245;

/// Maximum length of the name of a controller manager: its longest service name has 247 characters, the maximum of ROS.
const LONGEST_MANAGER: usize = 247 - "/list_hardware_components".len();

/// Section `ros`.
#[derive(Clone, Debug, PartialEq)]
pub struct RosOptions {
    /// Node name.
    pub name: String,
    /// Namespace, which begins with `/`.
    pub namespace: String,
    /// Rate of joint_states, 1 Hz to 1000 Hz.
    pub joint_states_rate: f64,
    /// Rate of ~/axis_states, 1 Hz to 1000 Hz.
    pub axis_states_rate: f64,
    /// Rate of ~/shaft, 1 Hz to 1000 Hz; `None`: the topic does not exist.
    pub shaft_rate: Option<f64>,
    /// Whether the node activates itself.
    pub autostart: bool,
    /// URDF file, relative to the folder of the cell; `None`: there is no robot description.
    pub robot_description: Option<String>,
    /// Absolute name of the controller manager whose services are offered; `None`: they are not offered.
    pub controller_manager: Option<String>,
    /// Network interfaces by name or address; empty: those of the environment.
    pub interfaces: Vec<String>,
    /// Reaction of the machine to a loss of its ROS side.
    pub on_loss: OnLoss,
    /// Time without an answer after which the ROS side or the surface counts as lost, 0.5 s to 5 s.
    pub loss_timeout: Duration,
    /// Maximum age of a request that is executed, 0.1 s to 1 h.
    pub request_timeout: Duration,
    /// Topics that bags of `run` record, apart from those of their cycles.
    pub record_topics: RecordTopics,
}

/// Reaction of the machine when it can no longer be reached through ROS.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnLoss {
    /// The machine halts all axes.
    Halt,
    /// The machine continues.
    None,
}

impl Default for RosOptions {
    fn default() -> Self {
        Self {
            name: "lineshaft".to_owned(),
            namespace: "/".to_owned(),
            joint_states_rate: 100.0,
            axis_states_rate: 100.0,
            shaft_rate: Some(100.0),
            autostart: true,
            robot_description: None,
            controller_manager: None,
            interfaces: Vec::new(),
            on_loss: OnLoss::Halt,
            loss_timeout: Duration::from_secs(2),
            request_timeout: Duration::from_secs(2),
            record_topics: RecordTopics::All,
        }
    }
}

impl RosOptions {
    /// Returns the full name of the node.
    pub fn node_name(&self) -> NodeName {
        NodeName::new(&self.namespace, &self.name).expect("both were checked by the same rules when the cell was read")
    }
}

pub(super) fn read(value: &Value<'_>) -> Option<RosOptions> {
    let usual = RosOptions::default();
    let mut map = value.map("ros")?;
    let name = map.optional("name").map(|value| node_name(&value));
    let namespace = map.optional("namespace").map(|value| namespace(&value));
    let joint_states_rate = map.optional("joint_states_rate").map(|value| rate(&value));
    let axis_states_rate = map.optional("axis_states_rate").map(|value| rate(&value));
    let shaft_rate = map.optional("shaft_rate").map(|value| rate_or_off(&value));
    let autostart = map.optional("autostart").map(|value| value.boolean());
    let robot_description = map.optional("robot_description").map(|value| file_name(&value));
    let controller_manager = map.optional("controller_manager").map(|value| controller_manager(&value));
    let interfaces = map.optional("interfaces").map(|value| interfaces(&value));
    let on_loss = map.optional("on_loss").map(|value| on_loss(&value));
    let loss_timeout = map.optional("loss_timeout").map(|value| time(&value, 0.5..=5.0));
    let request_timeout = map.optional("request_timeout").map(|value| time(&value, 0.1..=3600.0));
    let record_topics = map.optional("record_topics").map(|value| record_topics::read(&value));
    map.finish();
    Some(RosOptions {
        name: name.unwrap_or(Some(usual.name))?,
        namespace: namespace.unwrap_or(Some(usual.namespace))?,
        joint_states_rate: joint_states_rate.unwrap_or(Some(usual.joint_states_rate))?,
        axis_states_rate: axis_states_rate.unwrap_or(Some(usual.axis_states_rate))?,
        shaft_rate: shaft_rate.unwrap_or(Some(usual.shaft_rate))?,
        autostart: autostart.unwrap_or(Some(usual.autostart))?,
        robot_description: robot_description.map_or(Some(None), |file| file.map(Some))?,
        controller_manager: controller_manager.map_or(Some(None), |name| name.map(Some))?,
        interfaces: interfaces.unwrap_or(Some(usual.interfaces))?,
        on_loss: on_loss.unwrap_or(Some(usual.on_loss))?,
        loss_timeout: loss_timeout.unwrap_or(Some(usual.loss_timeout))?,
        request_timeout: request_timeout.unwrap_or(Some(usual.request_timeout))?,
        record_topics: record_topics.unwrap_or(Some(usual.record_topics))?,
    })
}

fn on_loss(value: &Value<'_>) -> Option<OnLoss> {
    match value.text()? {
        "halt" => Some(OnLoss::Halt),
        "none" => Some(OnLoss::None),
        text => {
            value.refuse(format!("on_loss is {}; halt or none is allowed", quote(text)), None);
            None
        }
    }
}

/// Reads a time within a range, in s.
fn time(value: &Value<'_>, allowed: RangeInclusive<f64>) -> Option<Duration> {
    let time = value.quantity(&[Dimension::Time], &crate::document::Allowed::Any)?;
    if allowed.contains(&time.si()) {
        return Some(Duration::from_secs_f64(time.si()));
    }
    let (given, least, most) = (value.peek().unwrap_or_default(), allowed.start(), allowed.end());
    let hint = unit_of_bare(given, time.unit());
    value.refuse(format!("{} is {}; {least} s..{most} s is allowed", value.label(), quote(given)), hint);
    None
}

fn node_name(value: &Value<'_>) -> Option<String> {
    let text = value.text()?;
    if is_token(text) && text.len() <= LONGEST {
        return Some(text.to_owned());
    }
    let allowed = "a letter or _, then letters, digits and _, is allowed";
    value.refuse(format!("name is {}; {allowed}", quote(text)), None);
    None
}

fn namespace(value: &Value<'_>) -> Option<String> {
    let text = value.text()?;
    if text == "/" || is_absolute(text) && text.len() <= LONGEST {
        return Some(text.to_owned());
    }
    let hint = absolute_hint(text);
    let allowed = "/ or names that each follow a /, such as /cell_1/press, is allowed";
    value.refuse(format!("namespace is {}; {allowed}", quote(text)), hint);
    None
}

/// Reads the absolute name of a controller manager.
fn controller_manager(value: &Value<'_>) -> Option<String> {
    let text = value.text()?;
    if is_absolute(text) && text.len() <= LONGEST_MANAGER {
        return Some(text.to_owned());
    }
    let allowed = format!(
        "an absolute name of at most {LONGEST_MANAGER} characters, such as /controller_manager or \
         /lineshaft/controller_manager, is allowed"
    );
    let hint = if text == "true" { Some("write `/controller_manager`".to_owned()) } else { absolute_hint(text) };
    value.refuse(format!("controller_manager is {}; {allowed}", quote(text)), hint);
    None
}

/// Whether a text is a sequence of names, each after a `/`.
fn is_absolute(text: &str) -> bool {
    text.strip_prefix('/').is_some_and(|tokens| tokens.split('/').all(is_token))
}

/// Returns a hint with a leading and no trailing `/`, if that is an absolute name.
fn absolute_hint(text: &str) -> Option<String> {
    let with_slash = format!("/{}", text.trim_matches('/'));
    (with_slash != text && is_absolute(&with_slash)).then(|| format!("write {}", quote(&with_slash)))
}

/// Reads a file name relative to the folder of the cell.
fn file_name(value: &Value<'_>) -> Option<String> {
    let text = value.text()?;
    if !text.is_empty() && !text.contains(|c: char| c.is_control()) {
        return Some(text.to_owned());
    }
    value.refuse(format!("{} is {}; the name of a URDF file is expected", value.label(), quote(text)), None);
    None
}

fn is_token(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && text.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
}

/// Reads a rate.
fn rate(value: &Value<'_>) -> Option<f64> {
    let rate = value.quantity(&[Dimension::Frequency], &crate::document::Allowed::Any)?.si();
    if is_rate(rate) { Some(rate) } else { refuse_rate(value, "1 Hz..1000 Hz") }
}

/// Reads the rate of an optional topic: 0 means that it does not exist.
fn rate_or_off(value: &Value<'_>) -> Option<Option<f64>> {
    let rate = value.quantity(&[Dimension::Frequency], &crate::document::Allowed::Any)?.si();
    match rate {
        0.0 => Some(None),
        _ if is_rate(rate) => Some(Some(rate)),
        _ => refuse_rate(value, "0, or 1 Hz..1000 Hz,"),
    }
}

fn is_rate(rate: f64) -> bool {
    (1.0..=1000.0).contains(&rate)
}

fn refuse_rate<T>(value: &Value<'_>, allowed: &str) -> Option<T> {
    let given = quote(value.peek().unwrap_or_default());
    value.refuse(format!("{} is {given}; {allowed} is allowed", value.label()), None);
    None
}

fn interfaces(value: &Value<'_>) -> Option<Vec<String>> {
    let mut all = Vec::new();
    let values = value.list()?;
    for value in &values {
        let Some(text) = value.text() else { continue };
        if text.is_empty() || text.contains(|c: char| c.is_whitespace() || c.is_control()) {
            let sentence =
                format!("{} is {}; a network interface such as eth0 or its address", value.label(), quote(text));
            value.refuse(format!("{sentence} is allowed"), None);
        } else {
            all.push(text.to_owned());
        }
    }
    (all.len() == values.len()).then_some(all)
}

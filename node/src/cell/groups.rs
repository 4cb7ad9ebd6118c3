//! Reads section `groups`.

use super::backends::Context;
use super::names::{Entry, Section, UsedOnce, is_virtual, quote};
use super::times::time_up_to;
use crate::document::Value;
use lineshaft_core::trajectory::{OnExcess, TrajectoryLimits};
use lineshaft_ros::surface::{GripperSettings, Group, TrajectorySettings};

/// Reads the groups.
pub(super) fn read(cx: &Context<'_>) -> Vec<Group> {
    cx.names.section(Section::Groups).iter().map(|entry| group(entry, cx)).collect()
}

/// Reads a group: a list of its axes, or a map with the list under `axes`.
fn group<'d>(entry: &Entry<'d>, cx: &Context<'d>) -> Group {
    let named = |axes, trajectories, gripper| Group { name: entry.name().to_owned(), axes, trajectories, gripper };
    let usual = TrajectorySettings::default();
    if !entry.value.is_map() {
        return named(axes(&entry.value, entry, cx), usual, None);
    }
    let Some(mut map) = entry.value.map(format!("group {}", entry.quoted())) else {
        return named(Vec::new(), usual, None);
    };
    let axes = map.required("axes").map_or_else(Vec::new, |value| axes(&value, entry, cx));
    let limits = map.optional("trajectory_limits").and_then(|value| trajectory_limits(&value));
    let wraps = map.optional("angle_wraparound").and_then(|value| value.boolean());
    let max_duration = map.optional("max_duration").and_then(|value| time_up_to(&value, TrajectorySettings::LONGEST));
    let (slowest, fastest) = TrajectorySettings::STATE_RATES;
    let rate = map.optional("controller_state_rate").and_then(|value| value.number(slowest..=fastest));
    let gripper = map.optional("gripper").and_then(|value| gripper(&value, entry, axes.len()));
    map.finish();
    let trajectories = TrajectorySettings {
        limits: limits.unwrap_or_default(),
        angle_wraparound: wraps.unwrap_or(usual.angle_wraparound),
        max_duration: max_duration.map_or(usual.max_duration, |ns| ns as f64 / 1e9),
        state_rate: rate.unwrap_or(usual.state_rate),
    };
    named(axes, trajectories, gripper)
}

/// Reads the keys that make a group of one axis a gripper.
fn gripper(value: &Value<'_>, entry: &Entry<'_>, axes: usize) -> Option<GripperSettings> {
    let mut map = value.map("gripper")?;
    let allow_stalling = map.optional("allow_stalling").map_or(Some(false), |value| value.boolean());
    map.finish();
    if axes != 1 {
        value.refuse(format!("group {} has {axes} axes; a gripper has one", entry.quoted()), None);
        return None;
    }
    Some(GripperSettings { allow_stalling: allow_stalling? })
}

fn axes<'d>(value: &Value<'d>, entry: &Entry<'d>, cx: &Context<'d>) -> Vec<u16> {
    let Some(values) = value.list() else { return Vec::new() };
    if values.is_empty() {
        let sentence = format!("group {} is empty; the names of one axis or more are expected", entry.quoted());
        value.refuse(sentence, None);
    }
    let mut once = UsedOnce::new();
    values.iter().filter_map(|value| axis(value, cx, &mut once)).collect()
}

fn axis<'d>(value: &Value<'d>, cx: &Context<'d>, once: &mut UsedOnce<usize>) -> Option<u16> {
    let name = value.text()?;
    let (_, place) = cx.names.find(value, name, &[Section::Axes])?;
    once.take(place, value, || format!("axis {}", quote(name)));
    if cx.names.section(Section::Axes).get(place).is_some_and(is_virtual) {
        value.refuse(format!("axis {} is virtual; a group has axes with a drive", quote(name)), None);
    }
    u16::try_from(place).ok()
}

/// Reads `trajectory_limits`, of a group or of a trajectory in a scenario. Returns `None` if a value is not allowed.
pub(crate) fn trajectory_limits(value: &Value<'_>) -> Option<TrajectoryLimits> {
    let mut map = value.map("trajectory_limits")?;
    let usual = TrajectoryLimits::default();
    let mut number = |key: &str, usual: f64, (low, high): (f64, f64)| {
        map.optional(key).map_or(Some(usual), |value| value.number(low..=high))
    };
    let margin = number("margin", usual.margin, TrajectoryLimits::MARGINS);
    let max_stretch = number("max_stretch", usual.max_stretch, TrajectoryLimits::STRETCHES);
    let names = OnExcess::ALL.map(|(on_excess, name)| (name, on_excess));
    let on_excess = map.optional("on_excess").map_or(Some(usual.on_excess), |value| value.choice(&names));
    map.finish();
    Some(TrajectoryLimits { margin: margin?, on_excess: on_excess?, max_stretch: max_stretch? })
}

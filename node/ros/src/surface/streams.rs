//! `~/jog` and `~/setpoints`: streamed velocities.
//!
//! Law      a message is accepted as a whole, or refused without any effect. If messages arrive faster than cycles, the newest one of each
//!          axis takes effect
//! Refuses  unknown and repeated axes, numbers that are not finite, velocities beyond `max_velocity`, lists of different lengths, stamps
//!          older than `setpoint_timeout`; reported once per second for each topic

use super::host::Host;
use super::hub::Hub;
use super::joint_names::JointNames;
use super::table;
use crate::layer::{CreateError, Node, Subscription};
use lineshaft_core::command::{Setpoints, Source};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::event::Number;
use lineshaft_core::parameter::ParameterImage;
use lineshaft_core::request::{Amount, SetpointRequest, Units};
use lineshaft_core::text;
use lineshaft_core::unit::number_to_text;
use lineshaft_msgs::Message;
use lineshaft_msgs::foreign::builtin_interfaces::msg::Time;
use lineshaft_msgs::foreign::control_msgs::msg::JointJog;
use lineshaft_msgs::msg;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::task::JoinSet;

/// Minimum time between two refusal messages of one topic: a wrong stream is wrong many times per second.
const REFUSAL_PERIOD: Duration = Duration::from_secs(1);
/// Excess over max_velocity that is limited instead of refused (m/s, rad/s): clients round limits to six decimals.
const ROUNDING: f64 = 1e-6;
/// Numbers from here on are not accepted by the core.
const LARGEST: f64 = 1e38;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let joints = hub.host.joint_names().clone();
    let objects = JointNames::of_objects(hub.host.config());
    tasks.spawn(follow(table::JOG.subscription(node)?, Arc::clone(hub), ("jog", joints), jog));
    tasks.spawn(follow(table::SETPOINTS.subscription(node)?, Arc::clone(hub), ("setpoints", objects), setpoints));
    Ok(())
}

/// Stamp of a message, and the request for each axis.
type Asked = (Time, Vec<SetpointRequest>);

/// Handles the messages of a topic. `shown` are the names that its messages give to axes.
async fn follow<M: Message>(
    mut topic: Subscription<M>,
    hub: Arc<Hub>,
    (name, shown): (&'static str, JointNames),
    read: impl Fn(M, &JointNames, &MachineConfig) -> Result<Asked, String> + Send,
) {
    let mut refusals = RefusalLimit::default();
    while let Some(message) = topic.next().await {
        let asked = read(message, hub.host.joint_names(), hub.host.config());
        let set = asked.and_then(|asked| resolve(&asked, &*hub.host, &shown, hub.clock.request_time()));
        let taken = set.and_then(|set| hub.host.stream(&set).map_err(|busy| busy.to_string()));
        if let Err(sentence) = taken
            && let Some(more) = refusals.say(Instant::now())
        {
            hub.refuse(format!("{name}: {sentence}{more}"));
        }
    }
}

/// Passes one refusal per period and counts the others.
#[derive(Debug, Default)]
struct RefusalLimit {
    last: Option<Instant>,
    held: u64,
}

impl RefusalLimit {
    /// Returns the note about the number of skipped refusals if this one may be reported.
    fn say(&mut self, now: Instant) -> Option<String> {
        if self.last.is_some_and(|last| now.duration_since(last) < REFUSAL_PERIOD) {
            self.held += 1;
            return None;
        }
        self.last = Some(now);
        let held = std::mem::take(&mut self.held);
        Some(if held > 0 { format!(" ({held} messages before it were refused too)") } else { String::new() })
    }
}

fn jog(message: JointJog, joints: &JointNames, config: &MachineConfig) -> Result<Asked, String> {
    let JointJog { header, mut joint_names, displacements, velocities, duration } = message;
    if !displacements.is_empty() {
        return Err(format!(
            "displacements has {} entries; none is allowed, give velocities, or a goal of ~/move_axis in mode RELATIVE",
            displacements.len()
        ));
    }
    if !(duration.is_finite() && duration >= 0.0) {
        return Err(format!(
            "duration is {} s; 0 (until the next message) or more is allowed",
            number_to_text(duration)
        ));
    }
    // The conversion saturates at 584 years. A duration below one nanosecond becomes one nanosecond, because 0 means unlimited.
    let ns = ((duration * 1e9).round() as u64).max(1);
    let duration = (duration > 0.0).then_some(ns);
    let pairs = joint_names.iter().zip(&velocities);
    for (name, velocity) in pairs.clone() {
        joints.object_name_of(name, "joint_names", config)?;
        if !velocity.is_finite() || velocity.abs() >= LARGEST {
            return Err(format!("velocity of `{name}` is {velocity:?}; a finite number within +-1e38 is expected"));
        }
    }
    // All names are known joints, so a repeated one is found after few comparisons.
    let twice =
        |(place, (name, _)): &(usize, (&String, &f64))| joint_names.iter().take(*place).any(|before| before == *name);
    if let Some((_, (name, _))) = pairs.enumerate().find(twice) {
        return Err(format!("joint_names has the joint `{name}` twice; once is expected"));
    }
    for name in &mut joint_names {
        *name = joints.object_name_of(name, "joint_names", config)?.to_owned();
    }
    Ok((header.stamp, pair("joint_names", joint_names, velocities, duration)?))
}

fn setpoints(message: msg::Setpoints, _: &JointNames, _: &MachineConfig) -> Result<Asked, String> {
    let msg::Setpoints { header, axes, velocities } = message;
    Ok((header.stamp, pair("axes", axes, velocities, None)?))
}

fn pair(
    field: &str,
    names: Vec<String>,
    velocities: Vec<f64>,
    duration: Option<u64>,
) -> Result<Vec<SetpointRequest>, String> {
    if names.len() != velocities.len() {
        let (names, velocities) = (names.len(), velocities.len());
        return Err(format!("velocities has {velocities} entries; {names} are expected, one for each of {field}"));
    }
    let pairs = names.into_iter().zip(velocities);
    Ok(pairs.map(|(axis, v)| SetpointRequest { axis, velocity: Amount::Number(v), duration }).collect())
}

fn resolve(asked: &Asked, host: &dyn Host, shown: &JointNames, now: Time) -> Result<Setpoints, String> {
    let (stamp, requests) = asked;
    let (config, image) = (host.config(), host.parameters());
    let mut set = config.resolve_setpoints(Source::Ros, Units::Si, requests).map_err(|error| error.to_string())?;
    limit(&mut set, config, &image);
    check(&set, config, shown, &image, age_ns(stamp, &now))?;
    Ok(set)
}

/// Limits velocities that exceed max_velocity by at most [`ROUNDING`].
fn limit(set: &mut Setpoints, config: &MachineConfig, image: &ParameterImage) {
    for ((axis, parameters), setpoint) in config.axes.iter().zip(&image.effective).zip(&mut set.axes) {
        let Some(setpoint) = setpoint else { continue };
        let excess = setpoint.velocity.abs() - parameters.max_velocity;
        if excess > 0.0 && axis.scale.rate_to_si(excess).abs() <= ROUNDING {
            setpoint.velocity = parameters.max_velocity.copysign(setpoint.velocity);
        }
    }
}

/// Checks limits and age of the setpoints. Velocities are sent in SI units, so the message gives these first.
fn check(
    set: &Setpoints,
    config: &MachineConfig,
    shown: &JointNames,
    image: &ParameterImage,
    age_ns: i128,
) -> Result<(), String> {
    let axes = config.axes.iter().zip(shown.iter()).zip(&image.effective).zip(&set.axes);
    for (((axis, name), parameters), setpoint) in axes {
        let Some(setpoint) = setpoint else { continue };
        let most = parameters.max_velocity;
        if setpoint.velocity.abs() > most {
            let (given, most) = (Number::Velocity(setpoint.velocity), Number::Velocity(most));
            let (given, most) = text::pair_in_si(given, most, &axis.scale);
            return Err(format!("velocity {given} of {name} exceeds max_velocity {most}"));
        }
        if age_ns > i128::from(parameters.setpoint_timeout) {
            return Err(format!(
                "the message is {} ms old by its stamp; setpoint_timeout {} ms of {name} is allowed, or a stamp of 0",
                age_ns / 1_000_000,
                parameters.setpoint_timeout as f64 / 1e6
            ));
        }
    }
    Ok(())
}

/// Returns the age of a stamp, in ns; 0 for a stamp of 0. A stamp from the future, of a clock that is ahead, has a negative age.
fn age_ns(stamp: &Time, now: &Time) -> i128 {
    let ns = |time: &Time| i128::from(time.sec) * 1_000_000_000 + i128::from(time.nanosec);
    if ns(stamp) == 0 { 0 } else { ns(now) - ns(stamp) }
}

#[cfg(test)]
mod tests;

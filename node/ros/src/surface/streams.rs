//! `~/jog` and `~/setpoints`: velocities that come again and again.
//!
//! Law      a message is taken as a whole, or refused and changes nothing; of messages that come faster than cycles the newest counts,
//!          for each axis by itself
//! Refuses  unknown and repeated axes, numbers that are none, velocities beyond `max_velocity`, lengths that do not fit, stamps
//!          older than `setpoint_timeout`; told once in a second for each topic

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

/// Least time between two refusals of one topic: a stream that is wrong is wrong many times a second.
const PAUSE: Duration = Duration::from_secs(1);
/// How far beyond max_velocity a velocity is still that (m/s, rad/s): clients round limits to six decimals.
const ROUNDING: f64 = 1e-6;
/// From here on a number is none that the core takes.
const LARGEST: f64 = 1e38;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let joints = hub.host.joint_names().clone();
    let objects = JointNames::of_objects(hub.host.config());
    tasks.spawn(follow(table::JOG.subscription(node)?, Arc::clone(hub), ("jog", joints), jog));
    tasks.spawn(follow(table::SETPOINTS.subscription(node)?, Arc::clone(hub), ("setpoints", objects), setpoints));
    Ok(())
}

/// What a message asks for: its stamp, and for each axis what it is to do.
type Asked = (Time, Vec<SetpointRequest>);

/// Follows a topic. `shown` are the names that its messages give to axes.
async fn follow<M: Message>(
    mut topic: Subscription<M>,
    hub: Arc<Hub>,
    (name, shown): (&'static str, JointNames),
    read: impl Fn(M, &JointNames, &MachineConfig) -> Result<Asked, String> + Send,
) {
    let mut refusals = Refusals::default();
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

/// Lets one refusal pass in a while, and counts the others.
#[derive(Debug, Default)]
struct Refusals {
    last: Option<Instant>,
    held: u64,
}

impl Refusals {
    /// May one be told? Then with a note of those that were not.
    fn say(&mut self, now: Instant) -> Option<String> {
        if self.last.is_some_and(|last| now.duration_since(last) < PAUSE) {
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
    // The cast saturates: 584 years. What is less than a nanosecond is one, not for ever.
    let ns = ((duration * 1e9).round() as u64).max(1);
    let duration = (duration > 0.0).then_some(ns);
    let pairs = joint_names.iter().zip(&velocities);
    for (name, velocity) in pairs.clone() {
        joints.object(name, "joint_names", config)?;
        if !velocity.is_finite() || velocity.abs() >= LARGEST {
            return Err(format!("velocity of `{name}` is {velocity:?}; a finite number within +-1e38 is expected"));
        }
    }
    // All of these are joints, so one of them is found twice before there are many.
    let twice =
        |(place, (name, _)): &(usize, (&String, &f64))| joint_names.iter().take(*place).any(|before| before == *name);
    if let Some((_, (name, _))) = pairs.enumerate().find(twice) {
        return Err(format!("joint_names has the joint `{name}` twice; once is expected"));
    }
    for name in &mut joint_names {
        *name = joints.object(name, "joint_names", config)?.to_owned();
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

/// Limits velocities to max_velocity that exceed it by [`ROUNDING`] at most.
fn limit(set: &mut Setpoints, config: &MachineConfig, image: &ParameterImage) {
    for ((axis, parameters), setpoint) in config.axes.iter().zip(&image.effective).zip(&mut set.axes) {
        let Some(setpoint) = setpoint else { continue };
        let excess = setpoint.velocity.abs() - parameters.max_velocity;
        if excess > 0.0 && axis.scale.rate_to_si(excess).abs() <= ROUNDING {
            setpoint.velocity = parameters.max_velocity.copysign(setpoint.velocity);
        }
    }
}

/// Is it what its axes may do, and as new as it has to be? Velocities are sent in SI units, so these come first in an answer.
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

/// Age of a stamp (ns); one of 0 is not judged, and one from the future, of a clock that goes before, is new.
fn age_ns(stamp: &Time, now: &Time) -> i128 {
    let ns = |time: &Time| i128::from(time.sec) * 1_000_000_000 + i128::from(time.nanosec);
    if ns(stamp) == 0 { 0 } else { ns(now) - ns(stamp) }
}

#[cfg(test)]
mod tests;

//! Messages of a cycle, identical on topics and in recordings.

pub use super::signals::AxisView;

use super::joint_names::JointNames;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::event::{Event as CoreEvent, Number};
use lineshaft_core::object::Object;
use lineshaft_core::signal::Board;
use lineshaft_core::signal::axis::AxisSignal;
use lineshaft_msgs::foreign::builtin_interfaces::msg::Time;
use lineshaft_msgs::foreign::sensor_msgs::msg::JointState;
use lineshaft_msgs::foreign::std_msgs::msg::Header;
use lineshaft_msgs::msg::{AxisStates, Event};

fn time(stamp_ns: u64) -> Time {
    // Seconds since 1970 fit until 2038, as in ROS 2.
    let sec = i32::try_from(stamp_ns / 1_000_000_000).unwrap_or(i32::MAX);
    Time { sec, nanosec: (stamp_ns % 1_000_000_000) as u32 }
}

/// Returns a header with this time (ns).
pub fn header(stamp_ns: u64) -> Header {
    Header { stamp: time(stamp_ns), frame_id: String::new() }
}

/// Returns the message of joint_states: all axes except virtual ones, with their joint names. `stamp_ns` is t_k, in ns.
pub fn joint_states(views: &[AxisView], names: &JointNames, board: &Board, stamp_ns: u64) -> JointState {
    let joints = || views.iter().zip(names.iter()).filter(|(view, _)| !view.is_virtual);
    let each = |value: &dyn Fn(&AxisView) -> f64| joints().map(|(view, _)| value(view)).collect::<Vec<_>>();
    JointState {
        header: header(stamp_ns),
        name: joints().map(|(_, name)| name.to_owned()).collect(),
        position: each(&|joint| joint.si(joint.int(board, AxisSignal::ActualPosition), 0.0)),
        velocity: each(&|joint| joint.rate(board, AxisSignal::ActualVelocity)),
        effort: each(&|joint| joint.effort(board)),
    }
}

/// Returns the message of `~/axis_states`: all axes. `stamp_ns` is t_k, in ns.
pub fn axis_states(views: &[AxisView], board: &Board, cycle: u64, stamp_ns: u64) -> AxisStates {
    AxisStates { header: header(stamp_ns), cycle, axes: views.iter().map(|view| view.state(board)).collect() }
}

/// Returns the message of `~/events`: `text` is the message of the event, `stamp_ns` is t_k of its cycle, in ns.
pub fn event(event: &CoreEvent, stamp_ns: u64, config: &MachineConfig, text: String) -> Event {
    Event {
        header: header(stamp_ns.saturating_sub(event.age_ns.into())),
        sequence: event.sequence,
        cycle: event.cycle,
        age_ns: event.age_ns,
        severity: event.severity as u8,
        kind: event.kind.name().to_owned(),
        source: config.name(event.source).to_owned(),
        code: event.code.0,
        increments: event.position.floor(),
        fraction: event.position.fraction(),
        value: value(event, config),
        text,
    }
}

/// Returns the requested or found value, in SI units.
fn value(event: &CoreEvent, config: &MachineConfig) -> f64 {
    let scale = match event.source {
        Object::Axis(index) => config.axes.get(usize::from(index)).map(|axis| axis.scale),
        Object::Encoder(index) => config.encoders.get(usize::from(index)).map(|encoder| encoder.scale),
        _ => None,
    };
    let rate = |value: f64| scale.map_or(value, |scale| scale.rate_to_si(value));
    match event.asked {
        Number::None => 0.0,
        Number::Position(value) => scale.map_or(value as f64, |scale| scale.position_to_si(value, 0.0)),
        Number::Count(value) => value as f64,
        Number::Time(value) => value as f64 / 1e9,
        Number::Velocity(value) | Number::Acceleration(value) | Number::Jerk(value) => rate(value),
        Number::Real(value) => value,
    }
}

//! Messages of trajectories: clients plan in SI units, so these come first, with the units of the axis in brackets.

use super::scale_of;
use super::set::key;
use crate::code::Code;
use crate::config::MachineConfig;
use crate::event::{Event, Kind, Number, TrajectoryPlace};
use crate::unit::{Scale, number_to_text};

/// Returns true if the numbers of a code answer a trajectory, and it is not one of [`reason`].
pub(super) fn is_in_si(code: Code) -> bool {
    matches!(
        code,
        Code::TRAJECTORY_PATH_TOLERANCE
            | Code::TRAJECTORY_GOAL_TOLERANCE
            | Code::TRAJECTORY_WITHOUT_TIME
            | Code::TRAJECTORY_IN_THE_PAST
            | Code::TRAJECTORY_START
            | Code::TRAJECTORY_TOO_LONG
            | Code::TRAJECTORY_STOP_BEYOND_LIMIT
            | Code::TRAJECTORY_OTHER_TIME
    )
}

/// Returns why a trajectory was refused or stretched, or the demand on its axes, at one of its points.
pub(super) fn reason(event: &Event, place: &TrajectoryPlace, config: &MachineConfig) -> Option<String> {
    let scale = scale_of(event.source, config);
    let (asked, limit) = pair_in_si(event.asked, event.limit, &scale);
    let point = format!("point {} ({} s)", place.point, number_to_text(place.time_ns as f64 / 1e9));
    let says = match event.code {
        Code::ABOVE_MAX_POSITION | Code::TRAJECTORY_ABOVE_MAX_POSITION => {
            format!("position {asked} exceeds max_position {limit}")
        }
        Code::BELOW_MIN_POSITION | Code::TRAJECTORY_BELOW_MIN_POSITION => {
            format!("position {asked} is below min_position {limit}")
        }
        Code::VELOCITY_TOO_HIGH
        | Code::ACCELERATION_TOO_HIGH
        | Code::DECELERATION_TOO_HIGH
        | Code::TRAJECTORY_STRETCHED => {
            let limited = key(event);
            format!("{} {asked} exceeds {limited} {limit}", limited.trim_start_matches("max_"))
        }
        Code::TRAJECTORY_STEP => {
            return Some(format!(
                "velocity steps by {asked} at {point}, the axis can do {limit} in a cycle; give velocities in the points"
            ));
        }
        Code::TRAJECTORY_LAG => {
            let late = match event.limit {
                Number::Time(late_ns) if late_ns > 0 => format!(", and the trajectory end {limit} late"),
                _ => String::new(),
            };
            return Some(format!(
                "straight segments make the axis lag up to {asked} behind before {point}{late}; give velocities in the points"
            ));
        }
        _ => return None,
    };
    let says = match event.code {
        Code::ABOVE_MAX_POSITION | Code::BELOW_MIN_POSITION => format!("{says} at {point}"),
        _ => format!("{says} before {point}"),
    };
    let stretch = number_to_text(rounded_up(place.stretch));
    Some(match place {
        _ if event.kind == Kind::Warning => format!("the trajectory takes {stretch} times the planned time: {says}"),
        TrajectoryPlace { stretch: needed, .. } if *needed <= 1.0 => says,
        TrajectoryPlace { max_stretch, .. } if *max_stretch <= 1.0 => {
            format!("{says}; trajectory_limits.on_excess is refuse, scale would stretch the time by {stretch}")
        }
        TrajectoryPlace { stretch: needed, .. } if needed.is_infinite() => {
            format!("{says}; no longer time of the trajectory helps")
        }
        TrajectoryPlace { max_stretch, .. } => {
            let most = number_to_text(*max_stretch);
            format!(
                "{says}; within all limits it takes {stretch} times the planned time, trajectory_limits.max_stretch is {most}"
            )
        }
    })
}

/// Rounds up to four decimals.
fn rounded_up(factor: f64) -> f64 {
    (factor * 1e4).ceil() / 1e4
}

/// Returns both values in SI units with the units of the axis in brackets, with enough digits to differ.
pub fn pair_in_si(asked: Number, limit: Number, scale: &Scale) -> (String, String) {
    let both = |digits: bool| {
        let text = |number| in_both_units(number, scale, digits);
        (text(asked), text(limit))
    };
    let usual = both(false);
    if usual.0 != usual.1 || asked == limit { usual } else { both(true) }
}

fn in_both_units(number: Number, scale: &Scale, is_precise: bool) -> String {
    let of = |scale: &Scale| match number {
        Number::Position(value) => scale.format_increments(value),
        Number::Velocity(rate) => rate_text(scale, rate, 1, is_precise),
        Number::Acceleration(rate) => rate_text(scale, rate, 2, is_precise),
        number => super::plain(number),
    };
    if let Number::Time(time_ns) = number {
        return format!("{} s", number_to_text(time_ns as f64 / 1e9));
    }
    scale.text_in_si(of)
}

fn rate_text(scale: &Scale, rate: f64, order: u8, is_precise: bool) -> String {
    if is_precise { scale.format_rate_precisely(rate, order) } else { scale.format_rate(rate, order) }
}

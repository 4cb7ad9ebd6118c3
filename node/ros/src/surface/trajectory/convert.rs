//! Converts a goal message to a request, and checks the message itself.
//!
//! Law      the request has the joints in the order of the message; fields that a point lacks stay empty
//! Reads    the goal, the parameters of trajectories, the time
//! Refuses  [`GoalError`]
//! Source   validate_trajectory_msg and get_segment_tolerances of joint_trajectory_controller (Jazzy), which accept a goal with an unknown
//!          joint or an illegal number in its tolerances and then ignore all tolerances: here such a goal is refused

use super::joints::Joints;
use super::settings::Settings;
use crate::surface::joint_names::object_name_refusal;
use lineshaft_core::request::{
    MAX_START_NS, PointRequest, ToleranceRequest, TrajectoryRequest, Units, ZERO_VELOCITY_TOLERANCE,
};
use lineshaft_core::unit::excerpt;
use lineshaft_msgs::foreign::builtin_interfaces::msg::{Duration, Time};
use lineshaft_msgs::foreign::control_msgs::action::FollowJointTrajectoryGoal as Goal;
use lineshaft_msgs::foreign::control_msgs::msg::JointTolerance;
use lineshaft_msgs::foreign::trajectory_msgs::msg::JointTrajectoryPoint as Point;

/// Value that removes a tolerance of the parameters.
const NO_TOLERANCE: f64 = -1.0;
/// Value that removes the goal time tolerance, in ns.
const NO_GOAL_TIME_NS: i64 = -1_000_000_000;
/// Numbers from here on are not accepted by the core.
const LARGEST: f64 = 1e38;

/// Reason why a goal is rejected.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum GoalError {
    #[error("multi_dof_trajectory is not empty; only trajectory is followed")]
    MultiDof,
    #[error("{0} is not empty; only tolerances of joints are kept")]
    Component(&'static str),
    #[error("joint_names has {given} of {known}; all are expected, or some with allow_partial_joints_goal")]
    Count { given: usize, known: String },
    #[error("joint_names is empty; one or more of {known} are expected")]
    NoJoints { known: String },
    #[error("{field} has the joint `{name}`; there are {known}")]
    UnknownJoint { field: &'static str, name: String, known: String },
    #[error("{}", object_name_refusal(.field, .axis, .joint))]
    ObjectName { field: &'static str, axis: String, joint: String },
    #[error("{field} has the joint `{name}` twice; once is expected")]
    Twice { field: &'static str, name: String },
    #[error("{field} has the joint `{name}`; joints of joint_names are expected")]
    NotMoved { field: &'static str, name: String },
    #[error("points is empty; one point or more is expected")]
    NoPoints,
    #[error("points have velocities alone, and header.stamp is not 0; give positions, or a stamp of 0")]
    IntegrationLater,
    #[error("points have velocities alone; give positions, or set allow_integration_in_goal_trajectories")]
    Integration,
    #[error("points[{point}].effort is not empty; positions, velocities and accelerations are followed")]
    Effort { point: usize },
    #[error("points[{point}].time_from_start is {} s; {expected}", seconds(*.time_ns))]
    Time { point: usize, time_ns: i64, expected: String },
    #[error("the trajectory ends {} s before now; it may have begun before, but must end later", seconds(*.ago_ns))]
    Past { ago_ns: i64 },
    #[error(
        "the stamp is {} s, {} s after now, {} s; at most {} s is allowed",
        seconds(*.stamp_ns),
        seconds(*.stamp_ns - *.now_ns),
        seconds(*.now_ns),
        seconds(MAX_START_NS)
    )]
    Ahead { stamp_ns: i64, now_ns: i64 },
    #[error("the stamp is {} s, and /clock has not said any time yet; a stamp of 0 starts at once", seconds(*.stamp_ns))]
    NoTime { stamp_ns: i64 },
    #[error(
        "{field} of `{name}` is {value:?}; a positive number, 0 for the parameter's or -1 for no limit is expected"
    )]
    Tolerance { field: String, name: String, value: f64 },
    #[error("goal_time_tolerance is {} s; 0 or more, or -1 s for no limit, is expected", seconds(*.time_ns))]
    GoalTime { time_ns: i64 },
}

pub(super) fn seconds(time_ns: i64) -> f64 {
    time_ns as f64 / 1e9
}

/// Returns nanoseconds since the Unix epoch; `None` for a stamp of zero, which means now.
pub(super) fn stamp_ns(stamp: &Time) -> Option<i64> {
    // |sec| < 2^31 and nanosec < 2^32: the sum is below 2.2e18 + 4.3e9, which fits.
    let stamp = i64::from(stamp.sec) * 1_000_000_000 + i64::from(stamp.nanosec);
    (stamp != 0).then_some(stamp)
}

fn duration_ns(duration: &Duration) -> i64 {
    i64::from(duration.sec) * 1_000_000_000 + i64::from(duration.nanosec)
}

/// Returns the indices of named joints.
pub(super) fn places(joints: &Joints, names: &[String]) -> Result<Vec<usize>, GoalError> {
    let mut places = Vec::with_capacity(names.len().min(joints.names.len()));
    for name in names {
        places.push(place(joints, "joint_names", name, &places)?);
    }
    Ok(places)
}

fn place(joints: &Joints, field: &'static str, name: &str, taken: &[usize]) -> Result<usize, GoalError> {
    let unknown = || match joints.joint_name_of(name) {
        Some(joint) => GoalError::ObjectName { field, axis: name.to_owned(), joint: joint.to_owned() },
        None => GoalError::UnknownJoint { field, name: excerpt(name), known: joints.names.join(", ") },
    };
    let place = joints.place(name).ok_or_else(unknown)?;
    if taken.contains(&place) { Err(GoalError::Twice { field, name: name.to_owned() }) } else { Ok(place) }
}

/// Returns the request of a goal that arrives at `now_ns` (since the Unix epoch).
pub(super) fn request(
    joints: &Joints,
    settings: &Settings,
    goal: &Goal,
    now_ns: i64,
) -> Result<TrajectoryRequest, GoalError> {
    let trajectory = &goal.trajectory;
    let multi_dof = &goal.multi_dof_trajectory;
    if !multi_dof.joint_names.is_empty() || !multi_dof.points.is_empty() {
        return Err(GoalError::MultiDof);
    }
    let known = || joints.names.join(", ");
    let given = trajectory.joint_names.len();
    if given == 0 {
        return Err(GoalError::NoJoints { known: known() });
    }
    let places = places(joints, &trajectory.joint_names)?;
    if !settings.partial && given != joints.names.len() {
        return Err(GoalError::Count { given, known: known() });
    }
    let points = points(&trajectory.points)?;
    let stamp = stamp_ns(&trajectory.header.stamp);
    if let Some(stamp_ns) = stamp.filter(|_| now_ns == 0) {
        return Err(GoalError::NoTime { stamp_ns });
    }
    if let Some(stamp_ns) = stamp.filter(|stamp| stamp.saturating_sub(now_ns) > MAX_START_NS) {
        return Err(GoalError::Ahead { stamp_ns, now_ns });
    }
    if let (Some(stamp), Some(last)) = (stamp, trajectory.points.last()) {
        let ago_ns = now_ns.saturating_sub(stamp.saturating_add(duration_ns(&last.time_from_start)));
        if ago_ns > 0 {
            return Err(GoalError::Past { ago_ns });
        }
    }
    for (field, tolerances) in [
        ("component_path_tolerance", &goal.component_path_tolerance),
        ("component_goal_tolerance", &goal.component_goal_tolerance),
    ] {
        if !tolerances.is_empty() {
            return Err(GoalError::Component(field));
        }
    }
    // The default velocity tolerance is for joints at rest. It applies to no joint then, because measured velocities are coarse.
    let ends_in_motion = points
        .last()
        .is_some_and(|last| last.velocities.iter().any(|velocity| velocity.abs() > ZERO_VELOCITY_TOLERANCE));
    let usual = |place: usize| settings.joints.get(place).copied().unwrap_or_default();
    let path = |place: usize| ToleranceRequest { position: positive(usual(place)[0]), ..ToleranceRequest::default() };
    let end = |place: usize| ToleranceRequest {
        position: positive(usual(place)[1]),
        velocity: positive(settings.stopped).filter(|_| !ends_in_motion),
        acceleration: None,
    };
    let start = |place: usize| ToleranceRequest { position: positive(usual(place)[2]), ..ToleranceRequest::default() };
    Ok(TrajectoryRequest {
        axes: places.iter().filter_map(|&place| joints.objects.get(place).cloned()).collect(),
        joints: trajectory.joint_names.clone(),
        units: Units::Si,
        start_ns: stamp.map_or(0, |stamp| stamp.saturating_sub(now_ns)),
        points,
        path: tolerances(joints, &places, "path_tolerance", &goal.path_tolerance, path)?,
        goal: tolerances(joints, &places, "goal_tolerance", &goal.goal_tolerance, end)?,
        goal_time_ns: goal_time(settings, duration_ns(&goal.goal_time_tolerance))?,
        start: places.iter().map(|&place| start(place)).collect(),
        limits: settings.group.limits,
        angle_wraparound: settings.group.angle_wraparound,
        max_duration_ns: settings.group.max_duration_ns(),
        may_end_in_motion: settings.may_end_in_motion,
    })
}

/// Returns the points. The core checks the lengths of lists and their numbers.
fn points(points: &[Point]) -> Result<Vec<PointRequest>, GoalError> {
    if points.is_empty() {
        return Err(GoalError::NoPoints);
    }
    let mut before = None;
    let mut all = Vec::with_capacity(points.len());
    for (point, given) in points.iter().enumerate() {
        let time_ns = duration_ns(&given.time_from_start);
        all.push(PointRequest {
            time_ns: time(point, time_ns, before)?,
            positions: given.positions.clone(),
            velocities: given.velocities.clone(),
            accelerations: given.accelerations.clone(),
        });
        if !given.effort.is_empty() {
            return Err(GoalError::Effort { point });
        }
        before = Some(time_ns);
    }
    Ok(all)
}

fn time(point: usize, time_ns: i64, before: Option<i64>) -> Result<u64, GoalError> {
    let wrong = |expected: String| GoalError::Time { point, time_ns, expected };
    if let Some(before) = before.filter(|before| time_ns <= *before) {
        return Err(wrong(format!("more than {} s, the time of the point before it, is expected", seconds(before))));
    }
    u64::try_from(time_ns).map_err(|_| wrong("0 s or more is expected".to_owned()))
}

/// Returns a tolerance of a parameter; 0, infinity, and numbers that the core does not accept mean none.
fn positive(value: f64) -> Option<f64> {
    Some(value).filter(|value| *value > 0.0 && *value < LARGEST)
}

/// Returns the tolerances of the joints at `places`: the default ones, unless the goal overrides them.
fn tolerances(
    joints: &Joints,
    places: &[usize],
    field: &'static str,
    given: &[JointTolerance],
    usual: impl Fn(usize) -> ToleranceRequest,
) -> Result<Vec<ToleranceRequest>, GoalError> {
    let mut all: Vec<ToleranceRequest> = places.iter().map(|&place| usual(place)).collect();
    let mut taken = Vec::new();
    for tolerance in given {
        let place = place(joints, field, &tolerance.name, &taken)?;
        taken.push(place);
        let moved = places.iter().position(|moved| *moved == place).and_then(|index| all.get_mut(index));
        let merged = moved.ok_or_else(|| GoalError::NotMoved { field, name: tolerance.name.clone() })?;
        let merge = |what: &str, usual: Option<f64>, value: f64| {
            let wrong =
                || GoalError::Tolerance { field: format!("{field} ({what})"), name: tolerance.name.clone(), value };
            merged_value(usual, value).ok_or_else(wrong)
        };
        merged.position = merge("position", merged.position, tolerance.position)?;
        merged.velocity = merge("velocity", merged.velocity, tolerance.velocity)?;
        merged.acceleration = merge("acceleration", merged.acceleration, tolerance.acceleration)?;
    }
    Ok(all)
}

/// Returns the tolerance after a number of the goal is applied to the default; `None` for an invalid number.
fn merged_value(usual: Option<f64>, value: f64) -> Option<Option<f64>> {
    if value == 0.0 {
        Some(usual)
    } else if (value - NO_TOLERANCE).abs() < f64::EPSILON {
        Some(None)
    } else if value > 0.0 {
        Some(positive(value))
    } else {
        None
    }
}

/// Returns how long to wait for the goal tolerances; `None`: unlimited.
fn goal_time(settings: &Settings, time_ns: i64) -> Result<Option<u64>, GoalError> {
    match time_ns {
        // Rounded to a nanosecond, at most 292 years.
        0 => Ok(positive(settings.goal_time).map(|seconds| ((seconds * 1e9).round() as u64).min(i64::MAX as u64))),
        NO_GOAL_TIME_NS => Ok(None),
        time_ns => u64::try_from(time_ns).map(Some).map_err(|_| GoalError::GoalTime { time_ns }),
    }
}

#[cfg(test)]
mod tests;

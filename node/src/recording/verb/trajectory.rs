//! Writes a verb `follow_joint_trajectory` as text.

use super::write::{axis, length, rate};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::position::{Length, Position};
use lineshaft_core::trajectory::{Knot, Tolerance, Track, Trajectory, TrajectoryLimits};
use serde::{Serialize, Serializer};

/// Arguments of the verb.
#[derive(Serialize)]
pub(super) struct FollowJointTrajectory<'a> {
    id: String,
    joints: Vec<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    start: Option<String>,
    points: Vec<Point>,
    #[serde(skip_serializing_if = "Tolerances::is_empty")]
    path_tolerance: Tolerances<'a>,
    #[serde(skip_serializing_if = "Tolerances::is_empty")]
    goal_tolerance: Tolerances<'a>,
    #[serde(skip_serializing_if = "Option::is_none")]
    goal_time: Option<String>,
    #[serde(skip_serializing_if = "Tolerances::is_empty")]
    start_tolerance: Tolerances<'a>,
    #[serde(skip_serializing_if = "Option::is_none")]
    trajectory_limits: Option<ExcessLimits>,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    angle_wraparound: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    max_duration: Option<String>,
    #[serde(rename = "allow_nonzero_velocity_at_trajectory_end", skip_serializing_if = "std::ops::Not::not")]
    ends_in_motion: bool,
}

#[derive(Serialize)]
struct ExcessLimits {
    margin: f64,
    on_excess: &'static str,
    max_stretch: f64,
}

#[derive(Serialize)]
struct Point {
    time: String,
    positions: Vec<String>,
    /// Velocities of all axes, or none. A trajectory that no interface creates is written with gaps, which are refused.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    velocities: Vec<Option<String>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    accelerations: Vec<Option<String>>,
}

/// Tolerances by axis, without axes that have none.
struct Tolerances<'a>(Vec<(&'a str, Limits)>);

impl Tolerances<'_> {
    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl Serialize for Tolerances<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, limits)| (name, limits)))
    }
}

#[derive(Serialize)]
struct Limits {
    #[serde(skip_serializing_if = "Option::is_none")]
    position: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    velocity: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    acceleration: Option<String>,
}

/// Returns the arguments of the verb; default values are left out.
pub(super) fn follow<'a>(id: String, run: &Trajectory, config: &'a MachineConfig) -> FollowJointTrajectory<'a> {
    let tracks = run.tracks();
    let tolerances = |of: fn(&Track) -> Tolerance| {
        let given = tracks.iter().filter(|track| !of(track).is_none());
        Tolerances(given.map(|track| (axis(track.axis, config), limits(&of(track)))).collect())
    };
    let knots = |place: usize| tracks.iter().filter_map(move |track| track.knots.get(place));
    let points = run.times_ns().iter().enumerate().map(|(place, time)| Point {
        time: format!("{time} ns"),
        positions: knots(place).map(|knot| position(knot.position)).collect(),
        velocities: rates(knots(place), |knot| knot.velocity, 1),
        accelerations: rates(knots(place), |knot| knot.acceleration, 2),
    });
    FollowJointTrajectory {
        id,
        joints: tracks.iter().map(|track| axis(track.axis, config)).collect(),
        start: Some(run.start_ns()).filter(|start| *start != 0).map(|start| format!("{start} ns")),
        points: points.collect(),
        path_tolerance: tolerances(|track| track.path),
        goal_tolerance: tolerances(|track| track.goal),
        start_tolerance: tolerances(|track| Tolerance { position: track.start, ..Tolerance::default() }),
        angle_wraparound: tracks.iter().any(|track| track.wraps),
        max_duration: run.max_duration_ns().map(|time| format!("{time} ns")),
        ends_in_motion: run.ends_in_motion(),
        goal_time: run.goal_time_ns().map(|time| format!("{time} ns")),
        trajectory_limits: Some(run.limits()).filter(|limits| *limits != TrajectoryLimits::default()).map(|limits| {
            let TrajectoryLimits { margin, on_excess, max_stretch } = limits;
            ExcessLimits { margin, on_excess: on_excess.name(), max_stretch }
        }),
    }
}

fn position(position: Position) -> String {
    length(Length { nearest: 0, rest: position })
}

fn rates<'k>(knots: impl Iterator<Item = &'k Knot>, of: fn(&Knot) -> Option<f64>, order: u8) -> Vec<Option<String>> {
    let rates: Vec<_> = knots.map(|knot| of(knot).map(|value| rate(value, order))).collect();
    if rates.iter().all(Option::is_none) { Vec::new() } else { rates }
}

fn limits(tolerance: &Tolerance) -> Limits {
    Limits {
        position: tolerance.position.map(|value| rate(value, 0)),
        velocity: tolerance.velocity.map(|value| rate(value, 1)),
        acceleration: tolerance.acceleration.map(|value| rate(value, 2)),
    }
}

//! Writes a verb `follow_joint_trajectory` as text.

use super::write::{Entries, Scalar, axis, length, rate, time};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::position::{Length, Position};
use lineshaft_core::trajectory::{Knot, Tolerance, Track, Trajectory, TrajectoryLimits};

/// Returns the arguments of the verb; default values are left out.
pub(super) fn follow(id: String, run: &Trajectory, config: &MachineConfig) -> Entries {
    let tracks = run.tracks();
    let tolerances = |of: fn(&Track) -> Tolerance| {
        let given = tracks.iter().filter(|track| !of(track).is_none());
        let named = given.map(|track| (axis(track.axis, config).to_owned(), Scalar::Entries(limits(&of(track)))));
        Entries(named.collect()).unless_empty()
    };
    let knots = |place: usize| tracks.iter().filter_map(move |track| track.knots.get(place));
    let points = run.times_ns().iter().enumerate().map(|(place, ns)| {
        let positions = knots(place).map(|knot| position(knot.position)).collect();
        Scalar::Entries(Entries::some([
            ("time", Some(time(*ns))),
            ("positions", Some(Scalar::List(positions))),
            ("velocities", rates(knots(place), |knot| knot.velocity, 1)),
            ("accelerations", rates(knots(place), |knot| knot.acceleration, 2)),
        ]))
    });
    let limits = Some(run.limits()).filter(|limits| *limits != TrajectoryLimits::default());
    let limits = limits.map(|TrajectoryLimits { margin, on_excess, max_stretch }| {
        let (margin, max_stretch) = (Scalar::Real(margin), Scalar::Real(max_stretch));
        let limits = [("margin", margin), ("on_excess", on_excess.name().into()), ("max_stretch", max_stretch)];
        Scalar::Entries(Entries::of(limits))
    });
    let yes = |holds: bool| holds.then_some(Scalar::Truth(true));
    Entries::some([
        ("id", Some(Scalar::Text(id))),
        ("joints", Some(Scalar::List(tracks.iter().map(|track| axis(track.axis, config).into()).collect()))),
        ("start", Some(run.start_ns()).filter(|start| *start != 0).map(|start| Scalar::Text(format!("{start} ns")))),
        ("points", Some(Scalar::List(points.collect()))),
        ("path_tolerance", tolerances(|track| track.path)),
        ("goal_tolerance", tolerances(|track| track.goal)),
        ("goal_time", run.goal_time_ns().map(time)),
        ("start_tolerance", tolerances(|track| Tolerance { position: track.start, ..Tolerance::default() })),
        ("trajectory_limits", limits),
        ("angle_wraparound", yes(tracks.iter().any(|track| track.wraps))),
        ("max_duration", run.max_duration_ns().map(time)),
        ("allow_nonzero_velocity_at_trajectory_end", yes(run.ends_in_motion())),
    ])
}

fn position(position: Position) -> Scalar {
    Scalar::Text(length(Length { nearest: 0, rest: position }))
}

/// Returns the rates of all axes, or none. A trajectory that no interface creates is written with gaps, which are
/// refused.
fn rates<'k>(knots: impl Iterator<Item = &'k Knot>, of: fn(&Knot) -> Option<f64>, order: u8) -> Option<Scalar> {
    let rates: Vec<_> = knots.map(of).collect();
    let text = |value: Option<f64>| value.map_or(Scalar::Nothing, |value| Scalar::Text(rate(value, order)));
    let is_given = rates.iter().any(Option::is_some);
    is_given.then(|| Scalar::List(rates.into_iter().map(text).collect()))
}

fn limits(tolerance: &Tolerance) -> Entries {
    let limit = |value: Option<f64>, order| value.map(|value| Scalar::Text(rate(value, order)));
    Entries::some([
        ("position", limit(tolerance.position, 0)),
        ("velocity", limit(tolerance.velocity, 1)),
        ("acceleration", limit(tolerance.acceleration, 2)),
    ])
}

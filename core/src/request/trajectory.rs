//! Conversion of trajectories.

use super::{Amount, RequestError, Units};
use crate::command::QueryTrajectory;
use crate::config::{AxisConfig, MachineConfig};
use crate::drive::Interface;
use crate::position::Position;
use crate::trajectory::{Knot, MAX_KNOTS, MAX_POINTS, Tolerance, Track, Trajectory, TrajectoryLimits};
use crate::unit::UnitError;

/// Velocity that counts as zero at the end of a trajectory (m/s, rad/s), as in joint_trajectory_controller.
pub const ZERO_VELOCITY_TOLERANCE: f64 = f32::EPSILON as f64;

/// Distance beyond a position limit at which a point still counts as at the limit (m, rad): clients round the positions
/// that they send to six decimals.
const POSITION_LIMIT_TOLERANCE: f64 = 1e-6;

/// Maximum time from a request to its start (ns): 10 min. A longer time indicates a wrong clock.
pub const MAX_START_NS: i64 = 600_000_000_000;

/// A point of a trajectory. Its lists are as long as the list of axes, in its order; unused lists are empty.
#[derive(Clone, Debug, PartialEq)]
pub struct PointRequest<N = f64> {
    /// Time from the start of the trajectory (ns).
    pub time_ns: u64,
    /// Positions, in m, rad, or the units of the request.
    pub positions: Vec<N>,
    /// Velocities, per s.
    pub velocities: Vec<N>,
    /// Accelerations, per s^2.
    pub accelerations: Vec<N>,
}

impl<N> Default for PointRequest<N> {
    fn default() -> Self {
        Self { time_ns: 0, positions: Vec::new(), velocities: Vec::new(), accelerations: Vec::new() }
    }
}

/// Tolerances of an axis; `None`: unlimited.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToleranceRequest<N = f64> {
    /// Position tolerance, in m, rad, or the units of the request.
    pub position: Option<N>,
    /// Velocity tolerance, per s.
    pub velocity: Option<N>,
    /// Acceleration tolerance, per s^2.
    pub acceleration: Option<N>,
}

impl<N> Default for ToleranceRequest<N> {
    fn default() -> Self {
        Self { position: None, velocity: None, acceleration: None }
    }
}

/// A trajectory. Its numbers are in its units, or are amounts with units of their own.
#[derive(Clone, Debug, PartialEq)]
pub struct TrajectoryRequest<N = f64> {
    /// Names of the axes; each once.
    pub axes: Vec<String>,
    /// Names of the axes in errors, such as joint names: one for each axis, or empty for the names of the axes.
    pub joints: Vec<String>,
    /// Units of the numbers.
    pub units: Units,
    /// Time from the cycle of the command to time 0 (ns); negative: it has already begun.
    pub start_ns: i64,
    /// Points, by ascending time.
    pub points: Vec<PointRequest<N>>,
    /// Path tolerances: one for each axis, or empty.
    pub path: Vec<ToleranceRequest<N>>,
    /// Goal tolerances: one for each axis, or empty.
    pub goal: Vec<ToleranceRequest<N>>,
    /// Time after the last point in which the axes must come within their goal tolerances (ns); `None`: unlimited.
    pub goal_time_ns: Option<u64>,
    /// Tolerances of the commands to first points at time 0: one for each axis, or empty. Positions only; 0: unlimited.
    pub start: Vec<ToleranceRequest<N>>,
    /// Reaction to a trajectory that exceeds limits of its axes.
    pub limits: TrajectoryLimits,
    /// Whether tracks of modulo axes are shifted by whole turns to be nearest to their axes.
    pub angle_wraparound: bool,
    /// Maximum time from its start to its end (ns); `None`: unlimited.
    pub max_duration_ns: Option<u64>,
    /// Whether its last point may have velocities, from which its axes then stop.
    pub may_end_in_motion: bool,
}

impl<N> Default for TrajectoryRequest<N> {
    fn default() -> Self {
        Self {
            axes: Vec::new(),
            joints: Vec::new(),
            units: Units::default(),
            start_ns: 0,
            points: Vec::new(),
            path: Vec::new(),
            goal: Vec::new(),
            goal_time_ns: None,
            start: Vec::new(),
            limits: TrajectoryLimits::default(),
            angle_wraparound: false,
            max_duration_ns: None,
            may_end_in_motion: false,
        }
    }
}

impl From<f64> for Amount {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl MachineConfig {
    /// Converts a trajectory exactly as it is given: only the final position is rounded to whole increments.
    ///
    /// # Errors
    /// An error in the request itself; the machine checks limits.
    pub fn resolve_trajectory<N>(&self, request: &TrajectoryRequest<N>) -> Result<Trajectory, RequestError>
    where
        N: Copy + Into<Amount>,
    {
        let axes = self.axes_of(&request.axes, &request.joints)?;
        let times = times(&request.points)?;
        let knots = request.points.len().saturating_mul(axes.len());
        if knots > MAX_KNOTS {
            let value = format!("has {} entries for {} joints", request.points.len(), axes.len());
            return Err(bad(
                "points",
                value,
                format!("points times joints may be at most {MAX_KNOTS}, and are {knots}"),
            ));
        }
        if request.start_ns > MAX_START_NS {
            let value = format!("is {} s", seconds(request.start_ns.unsigned_abs()));
            return Err(bad("start", value, format!("at most {} s is allowed", MAX_START_NS / 1_000_000_000)));
        }
        if let Some(time) = request.goal_time_ns.filter(|time| i64::try_from(*time).is_err()) {
            return Err(bad("goal_time", format!("is {} s", seconds(time)), max_time_text()));
        }
        for (place, point) in request.points.iter().enumerate() {
            check_lists(place, point, axes.len())?;
        }
        let tolerances =
            [("path_tolerance", &request.path), ("goal_tolerance", &request.goal), ("start_tolerance", &request.start)];
        for (name, list) in tolerances {
            if !list.is_empty() && list.len() != axes.len() {
                let value = format!("has {}", counted(list.len(), "entry", "entries"));
                return Err(bad(name, value, allowed_length_text(axes.len(), true)));
            }
        }
        let tracks: Result<Box<[Track]>, RequestError> = axes
            .iter()
            .enumerate()
            .map(|(place, &(index, axis))| {
                let name = request.joints.get(place).map_or(axis.name.as_str(), String::as_str);
                let field = Field { axis, name, units: request.units };
                let tolerance = |name: &str, list: &[ToleranceRequest<N>]| match list.get(place) {
                    Some(asked) => field.tolerance(name, asked),
                    None => Ok(Tolerance::default()),
                };
                Ok(Track {
                    axis: index,
                    knots: field.knots(place, &request.points, request.may_end_in_motion)?,
                    path: tolerance("path_tolerance", &request.path)?,
                    goal: tolerance("goal_tolerance", &request.goal)?,
                    start: field.start(tolerance("start_tolerance", &request.start)?)?,
                    wraps: request.angle_wraparound && axis.modulo.is_some(),
                })
            })
            .collect();
        let trajectory = Trajectory::new(request.start_ns, times, tracks?, request.goal_time_ns)
            .map(|trajectory| trajectory.within(request.limits).ended_after(request.max_duration_ns))
            .filter(Trajectory::is_sound);
        trajectory
            .ok_or_else(|| bad("the trajectory", "is not sound".to_owned(), "finite numbers are expected".to_owned()))
    }

    /// Converts a query for the setpoint of the trajectory of an axis to a command; `at_ns` is the number of a cycle
    /// times the cycle time.
    ///
    /// # Errors
    /// An unknown axis.
    pub fn resolve_query_trajectory(&self, axis: &str, at_ns: u64) -> Result<QueryTrajectory, RequestError> {
        self.find_axis(axis).map(|(axis, _)| QueryTrajectory { axis, at_ns })
    }

    /// Returns the axes of a trajectory with their indices. `joints` are their names in errors, or empty.
    fn axes_of(&self, names: &[String], joints: &[String]) -> Result<Vec<(u16, &AxisConfig)>, RequestError> {
        if names.is_empty() {
            return Err(bad("joints", "is empty".to_owned(), "one or more are expected".to_owned()));
        }
        let mut axes: Vec<(u16, &AxisConfig)> = Vec::with_capacity(names.len().min(self.axes.len()));
        for (place, name) in names.iter().enumerate() {
            let (index, axis) = self.find_axis(name)?;
            let joint = joints.get(place).unwrap_or(name);
            if axes.iter().any(|(known, _)| *known == index) {
                return Err(bad("joints", format!("has the joint `{joint}` twice"), "once is expected".to_owned()));
            }
            if axis.drive.is_some() && axis.interface == Interface::OpenLoop {
                let allowed = "an axis with a closed position loop, or a virtual one, is expected".to_owned();
                return Err(bad("joints", format!("has the joint `{joint}`, which runs in open loop"), allowed));
            }
            axes.push((index, axis));
        }
        Ok(axes)
    }
}

fn bad(name: impl Into<String>, value: String, allowed: String) -> RequestError {
    RequestError::BadTrajectory { name: name.into(), value, allowed }
}

/// Returns the error of an amount that cannot be converted.
fn bad_value(field: String, error: UnitError) -> RequestError {
    match error {
        UnitError::NotFinite { value } => {
            bad(field, format!("is {value:?}"), "a finite number within +-1e38 is expected".to_owned())
        }
        error => RequestError::BadValue { field, error: Box::new(error) },
    }
}

fn times<N>(points: &[PointRequest<N>]) -> Result<Box<[u64]>, RequestError> {
    if points.is_empty() {
        return Err(bad("points", "is empty".to_owned(), "one point or more is expected".to_owned()));
    }
    if points.len() > MAX_POINTS {
        let value = format!("has {} entries", points.len());
        return Err(bad("points", value, format!("at most {MAX_POINTS} are allowed")));
    }
    let is = |time_ns: u64| format!("is {} s", seconds(time_ns));
    for (place, pair) in points.windows(2).enumerate() {
        if pair[1].time_ns <= pair[0].time_ns {
            let allowed =
                format!("more than {} s, the time of the point before it, is expected", seconds(pair[0].time_ns));
            return Err(bad(format!("points[{}].time", place + 1), is(pair[1].time_ns), allowed));
        }
    }
    let last = points.last().map_or(0, |last| last.time_ns);
    if i64::try_from(last).is_err() {
        return Err(bad(format!("points[{}].time", points.len() - 1), is(last), max_time_text()));
    }
    Ok(points.iter().map(|point| point.time_ns).collect())
}

fn check_lists<N>(place: usize, point: &PointRequest<N>, axes: usize) -> Result<(), RequestError> {
    let lists = [
        ("positions", point.positions.len(), false),
        ("velocities", point.velocities.len(), true),
        ("accelerations", point.accelerations.len(), true),
    ];
    for (name, count, may_lack) in lists {
        if count != axes && !(may_lack && count == 0) {
            let value = format!("has {}", counted(count, "number", "numbers"));
            return Err(bad(format!("points[{place}].{name}"), value, allowed_length_text(axes, may_lack)));
        }
    }
    Ok(())
}

/// Returns seconds with all digits of the nanoseconds.
fn seconds(time_ns: u64) -> String {
    let (whole, rest) = (time_ns / 1_000_000_000, time_ns % 1_000_000_000);
    let digits = format!("{rest:09}");
    let digits = digits.trim_end_matches('0');
    if digits.is_empty() { whole.to_string() } else { format!("{whole}.{digits}") }
}

/// The allowed range of a time, as text.
fn max_time_text() -> String {
    format!("at most {} s is allowed", seconds(i64::MAX.unsigned_abs()))
}

fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// Returns the allowed length of a list of a trajectory with that number of joints, as text.
fn allowed_length_text(joints: usize, may_lack: bool) -> String {
    let none = if may_lack { ", or none," } else { "" };
    format!("one for each joint ({joints}){none} is expected")
}

/// Values of one axis.
struct Field<'a> {
    axis: &'a AxisConfig,
    /// Its name in errors.
    name: &'a str,
    units: Units,
}

impl Field<'_> {
    /// Returns the name of a list of a point, for this axis.
    fn at_point(&self, point: usize, list: &str) -> String {
        format!("points[{point}].{list} of `{}`", self.name)
    }

    fn rate<N: Into<Amount>>(&self, field: impl Fn() -> String, asked: N, order: u8) -> Result<f64, RequestError> {
        asked.into().rate(self.units, &self.axis.scale, order).map_err(|error| bad_value(field(), error))
    }

    fn knots<N: Copy + Into<Amount>>(
        &self,
        place: usize,
        points: &[PointRequest<N>],
        may_end_in_motion: bool,
    ) -> Result<Box<[Knot]>, RequestError> {
        let last = points.len() - 1;
        let knot = |(number, point): (usize, &PointRequest<N>)| {
            let position = match point.positions.get(place) {
                Some(&asked) => self.position(number, asked.into())?,
                None => Position::ZERO,
            };
            let velocity = |&asked: &N| self.rate(|| self.at_point(number, "velocities"), asked, 1);
            let velocity = point.velocities.get(place).map(velocity).transpose()?;
            let velocity = if number == last { self.end_velocity(velocity, may_end_in_motion)? } else { velocity };
            let acceleration = |&asked: &N| self.rate(|| self.at_point(number, "accelerations"), asked, 2);
            let acceleration = point.accelerations.get(place).map(acceleration);
            Ok(Knot { position, velocity, acceleration: acceleration.transpose()? })
        };
        points.iter().enumerate().map(knot).collect()
    }

    /// Returns the velocity of the last point. Up to [`ZERO_VELOCITY_TOLERANCE`] it becomes 0.
    fn end_velocity(&self, velocity: Option<f64>, may_move: bool) -> Result<Option<f64>, RequestError> {
        let moves = |velocity: &f64| self.axis.scale.rate_to_si(*velocity).abs() > ZERO_VELOCITY_TOLERANCE;
        match velocity.filter(moves) {
            Some(velocity) if may_move => Ok(Some(velocity)),
            Some(velocity) => {
                let value = self.axis.scale.text_in_si(|scale| scale.format_rate(velocity, 1));
                let allowed = "0 is expected, or set allow_nonzero_velocity_at_trajectory_end".to_owned();
                Err(bad(format!("the velocity of `{}` in the last point", self.name), format!("is {value}"), allowed))
            }
            None => Ok(velocity.map(|_| 0.0)),
        }
    }

    fn position(&self, point: usize, asked: Amount) -> Result<Position, RequestError> {
        let length = asked.length(self.units, &self.axis.scale);
        let length = length.map_err(|error| bad_value(self.at_point(point, "positions"), error))?;
        let position = length.exact();
        if !position.is_legal() {
            let value = format!("is {} inc", length.nearest);
            return Err(bad(self.at_point(point, "positions"), value, "within +-2^62 inc is expected".to_owned()));
        }
        Ok(self.on_limit(position))
    }

    /// Returns the limit of the cell that a position exceeds by at most [`POSITION_LIMIT_TOLERANCE`], or the position.
    fn on_limit(&self, position: Position) -> Position {
        let p = &self.axis.parameters;
        let near = Position::from_f64(POSITION_LIMIT_TOLERANCE / self.axis.scale.rate_to_si(1.0).abs());
        let (low, high) = (p.min_position.map(Position::whole), p.max_position.map(Position::whole));
        let over = high.filter(|high| position > *high && position <= *high + near);
        let under = low.filter(|low| position < *low && position >= *low - near);
        over.or(under).unwrap_or(position)
    }

    /// Returns a start tolerance; 0 means none.
    fn start(&self, tolerance: Tolerance) -> Result<Option<f64>, RequestError> {
        if tolerance.velocity.or(tolerance.acceleration).is_some() {
            let (name, value) = (format!("start_tolerance of `{}`", self.name), "has a velocity or an acceleration");
            return Err(bad(name, value.to_owned(), "a position is expected".to_owned()));
        }
        Ok(tolerance.position.filter(|most| *most > 0.0))
    }

    fn tolerance<N: Copy + Into<Amount>>(
        &self,
        name: &str,
        asked: &ToleranceRequest<N>,
    ) -> Result<Tolerance, RequestError> {
        let of = |asked: Option<N>, order: u8| {
            let Some(asked) = asked else { return Ok(None) };
            let what = ["position", "velocity", "acceleration"].get(usize::from(order)).unwrap_or(&"position");
            let field = || format!("{name} ({what}) of `{}`", self.name);
            let value = self.rate(field, asked, order)?;
            if value < 0.0 {
                let value = self.axis.scale.text_in_si(|scale| scale.format_rate(value, order));
                return Err(bad(field(), format!("is {value}"), "0 or more is expected".to_owned()));
            }
            Ok(Some(value))
        };
        Ok(Tolerance {
            position: of(asked.position, 0)?,
            velocity: of(asked.velocity, 1)?,
            acceleration: of(asked.acceleration, 2)?,
        })
    }
}

#[cfg(test)]
mod tests;

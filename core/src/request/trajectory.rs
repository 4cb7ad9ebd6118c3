//! Trajectories, in names and units.

use super::{Amount, RequestError, Units};
use crate::command::QueryTrajectory;
use crate::config::{AxisConfig, MachineConfig};
use crate::drive::Interface;
use crate::position::Position;
use crate::trajectory::{Knot, MAX_KNOTS, MAX_POINTS, Tolerance, Track, Trajectory, TrajectoryLimits};

/// A velocity that counts as none at the end of a trajectory (m/s, rad/s), as in joint_trajectory_controller.
pub const NO_VELOCITY: f64 = f32::EPSILON as f64;

/// How far beyond a position limit a point is still on it (m, rad): clients round the positions that they show, to six decimals.
const NO_DISTANCE: f64 = 1e-6;

/// Longest time from a request to the start that it asks for (ns): 10 min. More is a wrong clock rather than a wish.
pub const MAX_START_NS: i64 = 600_000_000_000;

/// A point of a trajectory. Its lists are as long as the list of axes, in its order; what it does not carry is empty.
#[derive(Clone, Debug, PartialEq)]
pub struct PointRequest<N = f64> {
    /// From time 0 (ns).
    pub time_ns: u64,
    /// m, rad, or what the units say.
    pub positions: Vec<N>,
    /// Per s.
    pub velocities: Vec<N>,
    /// Per s^2.
    pub accelerations: Vec<N>,
}

impl<N> Default for PointRequest<N> {
    fn default() -> Self {
        Self { time_ns: 0, positions: Vec::new(), velocities: Vec::new(), accelerations: Vec::new() }
    }
}

/// How far an axis may be off; none: without limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToleranceRequest<N = f64> {
    /// m, rad, or what the units say.
    pub position: Option<N>,
    /// Per s.
    pub velocity: Option<N>,
    /// Per s^2.
    pub acceleration: Option<N>,
}

impl<N> Default for ToleranceRequest<N> {
    fn default() -> Self {
        Self { position: None, velocity: None, acceleration: None }
    }
}

/// A trajectory. Its numbers are bare ones in its units, or amounts with units of their own.
#[derive(Clone, Debug, PartialEq)]
pub struct TrajectoryRequest<N = f64> {
    /// Names of the axes; each once.
    pub axes: Vec<String>,
    /// What the numbers mean.
    pub units: Units,
    /// From the cycle in which the command applies to time 0 (ns); negative: it has begun before.
    pub start_ns: i64,
    /// Its points, by ascending time.
    pub points: Vec<PointRequest<N>>,
    /// On the way: one for each axis, or empty.
    pub path: Vec<ToleranceRequest<N>>,
    /// At the end: one for each axis, or empty.
    pub goal: Vec<ToleranceRequest<N>>,
    /// How long after the last point the axes may take to come within their goal tolerances (ns); none: for ever.
    pub goal_time_ns: Option<u64>,
    /// How far the commands may be from first points at time 0: one for each axis, or empty. Positions only; 0: without limit.
    pub start: Vec<ToleranceRequest<N>>,
    /// What happens where it exceeds limits of its axes.
    pub limits: TrajectoryLimits,
    /// Whether tracks of modulo axes are moved by whole turns until they are nearest to their axes.
    pub angle_wraparound: bool,
    /// Longest time from its start to its end (ns); none: without limit.
    pub max_duration_ns: Option<u64>,
    /// Whether its last point may have velocities, with which its axes begin to stop.
    pub may_end_in_motion: bool,
}

impl<N> Default for TrajectoryRequest<N> {
    fn default() -> Self {
        Self {
            axes: Vec::new(),
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
    /// The trajectory that a request asks for, exactly as it is given: only where its axes rest at last is a whole increment.
    ///
    /// # Errors
    /// What is wrong with it in itself; what limits forbid, the machine refuses.
    pub fn resolve_trajectory<N>(&self, request: &TrajectoryRequest<N>) -> Result<Trajectory, RequestError>
    where
        N: Copy + Into<Amount>,
    {
        let axes = self.axes_of(&request.axes)?;
        let times = times(&request.points)?;
        let knots = request.points.len().saturating_mul(axes.len());
        if knots > MAX_KNOTS {
            let value = format!("{} for {} axes", request.points.len(), axes.len());
            return Err(bad("points", value, format!("points times axes may be {MAX_KNOTS}, and are {knots}")));
        }
        if request.start_ns > MAX_START_NS {
            let value = format!("{} s ahead", request.start_ns as f64 / 1e9);
            return Err(bad("start", value, format!("at most {} s is allowed", MAX_START_NS / 1_000_000_000)));
        }
        if let Some(time) = request.goal_time_ns.filter(|time| i64::try_from(*time).is_err()) {
            return Err(bad("goal time", format!("{time} ns"), format!("at most {} ns is allowed", i64::MAX)));
        }
        for (place, point) in request.points.iter().enumerate() {
            check_lists(place, point, axes.len())?;
        }
        let tolerances = [
            ("path tolerances", &request.path),
            ("goal tolerances", &request.goal),
            ("start tolerances", &request.start),
        ];
        for (name, list) in tolerances {
            if !list.is_empty() && list.len() != axes.len() {
                return Err(bad(name, format!("{} values", list.len()), format!("none or {} are allowed", axes.len())));
            }
        }
        let tracks: Result<Box<[Track]>, RequestError> = axes
            .iter()
            .enumerate()
            .map(|(place, &(index, axis))| {
                let field = Field { axis, units: request.units };
                let tolerance = |name: &str, list: &[ToleranceRequest<N>]| match list.get(place) {
                    Some(asked) => field.tolerance(name, asked),
                    None => Ok(Tolerance::default()),
                };
                Ok(Track {
                    axis: index,
                    knots: field.knots(place, &request.points, request.may_end_in_motion)?,
                    path: tolerance("path tolerance", &request.path)?,
                    goal: tolerance("goal tolerance", &request.goal)?,
                    start: field.start(tolerance("start tolerance", &request.start)?)?,
                    wraps: request.angle_wraparound && axis.modulo.is_some(),
                })
            })
            .collect();
        let trajectory = Trajectory::new(request.start_ns, times, tracks?, request.goal_time_ns)
            .map(|trajectory| trajectory.within(request.limits).ended_after(request.max_duration_ns))
            .filter(Trajectory::is_sound);
        trajectory
            .ok_or_else(|| bad("the trajectory", "not sound".to_owned(), "finite numbers are expected".to_owned()))
    }

    /// A question for what the trajectory of an axis asks of it as a command's content; `at_ns` is the number of a cycle times its length.
    ///
    /// # Errors
    /// No axis is called so.
    pub fn resolve_query_trajectory(&self, axis: &str, at_ns: u64) -> Result<QueryTrajectory, RequestError> {
        self.find_axis(axis).map(|(axis, _)| QueryTrajectory { axis, at_ns })
    }

    /// The axes of a trajectory, with their places.
    fn axes_of(&self, names: &[String]) -> Result<Vec<(u16, &AxisConfig)>, RequestError> {
        if names.is_empty() {
            return Err(bad("axes", "empty".to_owned(), format!("1 to {} names are expected", self.axes.len())));
        }
        let mut axes: Vec<(u16, &AxisConfig)> = Vec::with_capacity(names.len().min(self.axes.len()));
        for name in names {
            let (index, axis) = self.find_axis(name)?;
            if axes.iter().any(|(known, _)| *known == index) {
                return Err(bad("axes", format!("{name} twice"), "each axis may stand once".to_owned()));
            }
            if axis.drive.is_some() && axis.interface == Interface::OpenLoop {
                let allowed = "an axis with a closed position loop, or a virtual one, is expected".to_owned();
                return Err(bad("axes", format!("{name}, which runs in open loop"), allowed));
            }
            axes.push((index, axis));
        }
        Ok(axes)
    }
}

fn bad(name: impl Into<String>, value: String, allowed: String) -> RequestError {
    RequestError::BadTrajectory { name: name.into(), value, allowed }
}

fn times<N>(points: &[PointRequest<N>]) -> Result<Box<[u64]>, RequestError> {
    if !(1..=MAX_POINTS).contains(&points.len()) {
        return Err(bad("points", format!("a list of {}", points.len()), format!("1 to {MAX_POINTS} are allowed")));
    }
    for (place, pair) in points.windows(2).enumerate() {
        if pair[1].time_ns <= pair[0].time_ns {
            let (name, value) = (format!("time of point {}", place + 1), format!("{} ns", pair[1].time_ns));
            return Err(bad(
                name,
                value,
                format!("more than {} ns, that of the point before, is expected", pair[0].time_ns),
            ));
        }
    }
    let last = points.last().map_or(0, |last| last.time_ns);
    if i64::try_from(last).is_err() {
        let name = format!("time of point {}", points.len() - 1);
        return Err(bad(name, format!("{last} ns"), format!("at most {} ns is allowed", i64::MAX)));
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
            let allowed =
                if may_lack { format!("none or {axes} are expected") } else { format!("{axes} are expected") };
            return Err(bad(format!("{name} of point {place}"), format!("a list of {count}"), allowed));
        }
    }
    Ok(())
}

/// Values of one axis.
struct Field<'a> {
    axis: &'a AxisConfig,
    units: Units,
}

impl Field<'_> {
    fn named(&self, name: &str, point: Option<usize>) -> String {
        match point {
            Some(point) => format!("{name} of {} at point {point}", self.axis.name),
            None => format!("{name} of {}", self.axis.name),
        }
    }

    fn rate<N: Into<Amount>>(
        &self,
        name: &str,
        point: Option<usize>,
        asked: N,
        order: u8,
    ) -> Result<f64, RequestError> {
        asked
            .into()
            .rate(self.units, &self.axis.scale, order)
            .map_err(|error| RequestError::BadValue { field: self.named(name, point), error: Box::new(error) })
    }

    fn knots<N: Copy + Into<Amount>>(
        &self,
        place: usize,
        points: &[PointRequest<N>],
        may_end_in_motion: bool,
    ) -> Result<Box<[Knot]>, RequestError> {
        let last = points.len() - 1;
        let knot = |(number, point): (usize, &PointRequest<N>)| {
            let at = Some(number);
            let position = match point.positions.get(place) {
                Some(&asked) => self.position(number, asked.into())?,
                None => Position::ZERO,
            };
            let velocity = point.velocities.get(place).map(|&asked| self.rate("velocity", at, asked, 1)).transpose()?;
            let velocity = if number == last { self.end(number, velocity, may_end_in_motion)? } else { velocity };
            let acceleration = point.accelerations.get(place).map(|&asked| self.rate("acceleration", at, asked, 2));
            Ok(Knot { position, velocity, acceleration: acceleration.transpose()? })
        };
        points.iter().enumerate().map(knot).collect()
    }

    /// The velocity of the last point. Up to [`NO_VELOCITY`] it becomes 0.
    fn end(&self, point: usize, velocity: Option<f64>, may_move: bool) -> Result<Option<f64>, RequestError> {
        let moves = |velocity: &f64| self.axis.scale.rate_to_si(*velocity).abs() > NO_VELOCITY;
        match velocity.filter(moves) {
            Some(velocity) if may_move => Ok(Some(velocity)),
            Some(velocity) => {
                let value = self.axis.scale.format_rate(velocity, 1);
                Err(bad(self.named("velocity", Some(point)), value, "0 is expected at the last point".to_owned()))
            }
            None => Ok(velocity.map(|_| 0.0)),
        }
    }

    fn position(&self, point: usize, asked: Amount) -> Result<Position, RequestError> {
        let length = asked.length(self.units, &self.axis.scale).map_err(|error| RequestError::BadValue {
            field: self.named("position", Some(point)),
            error: Box::new(error),
        })?;
        let position = length.exact();
        if !position.is_legal() {
            let value = format!("{} inc", length.nearest);
            return Err(bad(self.named("position", Some(point)), value, "within +-2^62 inc is expected".to_owned()));
        }
        Ok(self.on_limit(position))
    }

    /// The limit of the cell that a position exceeds by [`NO_DISTANCE`] at most, or the position.
    fn on_limit(&self, position: Position) -> Position {
        let p = &self.axis.parameters;
        let near = Position::from_f64(NO_DISTANCE / self.axis.scale.rate_to_si(1.0).abs());
        let (low, high) = (p.min_position.map(Position::whole), p.max_position.map(Position::whole));
        let over = high.filter(|high| position > *high && position <= *high + near);
        let under = low.filter(|low| position < *low && position >= *low - near);
        over.or(under).unwrap_or(position)
    }

    /// A start tolerance; 0 is none.
    fn start(&self, tolerance: Tolerance) -> Result<Option<f64>, RequestError> {
        if tolerance.velocity.or(tolerance.acceleration).is_some() {
            let value = "a velocity or an acceleration".to_owned();
            return Err(bad(self.named("start tolerance", None), value, "a position is expected".to_owned()));
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
            let value = self.rate(name, None, asked, order)?;
            if value < 0.0 {
                let units = ["inc", "inc/s", "inc/s^2"];
                let value = format!(
                    "{} {}",
                    crate::unit::number_to_text(value),
                    units.get(usize::from(order)).unwrap_or(&"inc")
                );
                return Err(bad(self.named(name, None), value, "0 or more is expected".to_owned()));
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

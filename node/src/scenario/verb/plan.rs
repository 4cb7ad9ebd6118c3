//! Reads a planned trajectory from a file: trajectory_msgs/JointTrajectory as `ros2 topic echo` prints it, in YAML or
//! JSON.
//!
//! Reads    the message, or a moveit_msgs/RobotTrajectory or moveit_msgs/DisplayTrajectory that contains it; numbers
//!          are in m, rad and s
//! Refuses  messages that the action refuses as invalid; lists that `ros2 topic echo` has truncated
//! Source   message_to_yaml of rosidl_runtime_py; trajectory_msgs (Jazzy). The stamp of the header is ignored: the step
//!          defines the time

use crate::document::{Map, Value};
use lineshaft_core::request::{Amount, PointRequest, RequestError};

/// Last item of a truncated list.
const CUT_OFF: &str = "...";
const SECOND_NS: i64 = 1_000_000_000;

/// A message that was read.
pub(super) struct Plan<'d> {
    /// `joint_names`.
    pub joints: Value<'d>,
    points: Vec<Value<'d>>,
}

impl<'d> Plan<'d> {
    /// Reads the message. Reports a problem if it returns `None`.
    pub(super) fn read(root: &Value<'d>) -> Option<Self> {
        let mut map = message(root.map("the trajectory")?)?;
        map.allow(&["header"]);
        let (joints, points) = (map.required("joint_names"), map.required("points"));
        map.finish();
        let (joints, points) = (joints?, list(&points?)?);
        list(&joints)?;
        Some(Self { joints, points })
    }

    /// Reads the points. Reports a problem if it returns `None`.
    pub(super) fn points(&self) -> Option<Vec<PointRequest<Amount>>> {
        // All points are read, so that every problem is reported.
        let points: Vec<_> = self.points.iter().map(point).collect();
        points.into_iter().collect()
    }

    /// Replaces the names of fields in an error by those of the message, which differ from those of the verb.
    pub(super) fn by_its_fields(error: RequestError) -> RequestError {
        match error {
            RequestError::BadTrajectory { name, value, allowed } => {
                let name = match name.strip_suffix("].time") {
                    Some(point) => format!("{point}].time_from_start"),
                    None if name == "joints" => "joint_names".to_owned(),
                    None => name,
                };
                RequestError::BadTrajectory { name, value, allowed }
            }
            error => error,
        }
    }

    /// Returns the location of an error message: the point that it names by number or as the last one, otherwise the
    /// joints.
    pub(super) fn place_of(&self, sentence: &str) -> &Value<'d> {
        let number = |rest: &str| rest.split(']').next()?.parse::<usize>().ok();
        let named = sentence.split("points[").skip(1).find_map(number).and_then(|number| self.points.get(number));
        let last = self.points.last().filter(|_| sentence.contains(" in the last point "));
        named.or(last).unwrap_or(&self.joints)
    }
}

/// Returns the message contained in one of MoveIt.
fn message(mut map: Map<'_>) -> Option<Map<'_>> {
    if let Some(trajectories) = map.optional("trajectory") {
        map.allow(&["model_id", "trajectory_start"]);
        map.finish();
        let all = list(&trajectories)?;
        let [one] = all.as_slice() else {
            trajectories.refuse(format!("trajectory is a list of {}; one trajectory is expected", all.len()), None);
            return None;
        };
        map = one.map("a RobotTrajectory")?;
    }
    if let Some(inner) = map.optional("joint_trajectory") {
        map.optional("multi_dof_joint_trajectory").map_or(Some(()), |other| without_points(&other))?;
        map.finish();
        map = inner.map("joint_trajectory")?;
    }
    Some(map)
}

/// Refuses a multi-DOF trajectory with points, because no axis is such a joint.
fn without_points(value: &Value<'_>) -> Option<()> {
    let mut map = value.map("multi_dof_joint_trajectory")?;
    map.allow(&["header", "joint_names"]);
    let points = map.optional("points");
    map.finish();
    match points {
        Some(points) if !list(&points)?.is_empty() => {
            points.refuse("multi_dof_joint_trajectory has points; only joint_trajectory is followed", None);
            None
        }
        _ => Some(()),
    }
}

fn point(value: &Value<'_>) -> Option<PointRequest<Amount>> {
    let label = value.label().to_owned();
    let mut map = value.map(&*label)?;
    let time =
        map.required("time_from_start").and_then(|time| time_ns(&time.called(format!("{label}.time_from_start"))));
    let [positions, velocities, accelerations] = ["positions", "velocities", "accelerations"].map(|key| {
        let given = map.optional(key).map(|given| given.called(format!("{label}.{key}")));
        given.map_or(Some(Vec::new()), |given| numbers(&given))
    });
    let effort = map.optional("effort");
    map.finish();
    if let Some(effort) = effort.filter(|effort| effort.list().is_some_and(|list| !list.is_empty())) {
        effort
            .refuse(format!("{label}.effort is not empty; positions, velocities and accelerations are followed"), None);
        return None;
    }
    Some(PointRequest { time_ns: time?, positions: positions?, velocities: velocities?, accelerations: accelerations? })
}

/// Reads `sec` and `nanosec` of a duration.
fn time_ns(value: &Value<'_>) -> Option<u64> {
    let mut map = value.map(value.label())?;
    let (sec, nanosec) = (map.required("sec"), map.optional("nanosec"));
    map.finish();
    let sec = sec?.integer(i32::MIN..=i32::MAX)?;
    let nanosec = nanosec.map_or(Some(0), |nanosec| nanosec.integer(0..=u32::MAX))?;
    // |sec| < 2^31 and nanosec < 2^32: below 2.2e18 + 4.3e9, which fits in i64.
    let ns = i64::from(sec) * SECOND_NS + i64::from(nanosec);
    let time = u64::try_from(ns);
    if time.is_err() {
        value.refuse(format!("{} is {} s; 0 s or more is expected", value.label(), ns as f64 / 1e9), None);
    }
    time.ok()
}

fn numbers(value: &Value<'_>) -> Option<Vec<Amount>> {
    let numbers = list(value)?;
    let numbers: Vec<_> = numbers.iter().map(|item| item.number(f64::NEG_INFINITY..=f64::INFINITY)).collect();
    numbers.into_iter().map(|number| number.map(Amount::Number)).collect()
}

/// Returns the items of a list that is not truncated.
fn list<'d>(value: &Value<'d>) -> Option<Vec<Value<'d>>> {
    let items = value.list()?;
    if items.last().and_then(Value::peek) == Some(CUT_OFF) {
        let sentence = format!("{} was cut off after {} items", value.label(), items.len() - 1);
        value.refuse(sentence, Some("print it with `ros2 topic echo --full-length`".to_owned()));
        return None;
    }
    Some(items)
}

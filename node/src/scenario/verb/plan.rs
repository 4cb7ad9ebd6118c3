//! A planned trajectory in a file: trajectory_msgs/JointTrajectory as `ros2 topic echo` prints it, in YAML or JSON.
//!
//! Reads    the message, or moveit_msgs/RobotTrajectory or moveit_msgs/DisplayTrajectory around it; numbers are in m, rad and s
//! Refuses  what the action refuses of a message in itself; lists that `ros2 topic echo` has cut off
//! Source   message_to_yaml of rosidl_runtime_py; trajectory_msgs (Jazzy). The stamp of the header has no meaning here: the step says when

use crate::document::{Map, Value};
use lineshaft_core::request::{Amount, PointRequest, RequestError};

/// What stands at the end of a list that was cut off.
const CUT_OFF: &str = "...";
const SECOND_NS: i64 = 1_000_000_000;

/// A message that was read.
pub(super) struct Plan<'d> {
    /// `joint_names`.
    pub joints: Value<'d>,
    points: Vec<Value<'d>>,
}

impl<'d> Plan<'d> {
    /// Reads the message. Notes a problem where it returns `None`.
    pub(super) fn read(root: &Value<'d>) -> Option<Self> {
        let mut map = message(root.map("the trajectory")?)?;
        map.allow(&["header"]);
        let (joints, points) = (map.required("joint_names"), map.required("points"));
        map.finish();
        let (joints, points) = (joints?, list(&points?)?);
        list(&joints)?;
        Some(Self { joints, points })
    }

    /// Its points. Notes a problem where it returns `None`.
    pub(super) fn points(&self) -> Option<Vec<PointRequest<Amount>>> {
        // All of them, so that every problem is noted.
        let points: Vec<_> = self.points.iter().map(point).collect();
        points.into_iter().collect()
    }

    /// An error by the fields of the message: they have other names than those of the verb.
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

    /// Where a sentence belongs: to the point that it names by its number or as the last one, else to the joints.
    pub(super) fn place_of(&self, sentence: &str) -> &Value<'d> {
        let number = |rest: &str| rest.split(']').next()?.parse::<usize>().ok();
        let named = sentence.split("points[").skip(1).find_map(number).and_then(|number| self.points.get(number));
        let last = self.points.last().filter(|_| sentence.contains(" in the last point "));
        named.or(last).unwrap_or(&self.joints)
    }
}

/// The message, out of those of MoveIt around it.
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

/// Refuses a trajectory of joints that no axis is.
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

/// `sec` and `nanosec` of a duration.
fn time_ns(value: &Value<'_>) -> Option<u64> {
    let mut map = value.map(value.label())?;
    let (sec, nanosec) = (map.required("sec"), map.optional("nanosec"));
    map.finish();
    let sec = sec?.integer(i32::MIN..=i32::MAX)?;
    let nanosec = nanosec.map_or(Some(0), |nanosec| nanosec.integer(0..=u32::MAX))?;
    // |sec| < 2^31 and nanosec < 2^32: below 2.2e18 + 4.3e9, which fits.
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

/// The items of a list that is whole.
fn list<'d>(value: &Value<'d>) -> Option<Vec<Value<'d>>> {
    let items = value.list()?;
    if items.last().and_then(Value::peek) == Some(CUT_OFF) {
        let sentence = format!("{} was cut off after {} items", value.label(), items.len() - 1);
        value.refuse(sentence, Some("print it with `ros2 topic echo --full-length`".to_owned()));
        return None;
    }
    Some(items)
}

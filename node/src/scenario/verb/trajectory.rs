//! Verb `follow_joint_trajectory` (contract section 7, by the fields of control_msgs).

use super::amount::amount;
use super::plan::Plan;
use super::{Effect, EffectOfGoal, Reader, units};
use crate::cell::trajectory_limits;
use crate::document::{Allowed, Document, Map, Value};
use crate::scenario::{moment, names::Names};
use lineshaft_core::command::Action;
use lineshaft_core::object::Object;
use lineshaft_core::request::{Amount, PointRequest, RequestError, ToleranceRequest, TrajectoryRequest, Units};
use lineshaft_core::trajectory::TrajectoryLimits;
use lineshaft_core::unit::{Dimension, Scale, excerpt};
use lineshaft_ros::surface::{Group, TrajectorySettings};
use std::sync::Arc;

/// A joint of the verb: its name as written, the object name, and the scale if it is an axis.
struct Joint<'d> {
    name: &'d str,
    axis: String,
    scale: Option<Scale>,
}

/// Data for reading its numbers.
struct Numbers<'j, 'd> {
    names: &'j Names<'j>,
    joints: &'j [Joint<'d>],
    in_increments: bool,
}

/// Joints, units and points; points are `None` if one of them is wrong, which is reported.
struct Given<'d> {
    joints: Vec<Joint<'d>>,
    units: u8,
    points: Option<Vec<PointRequest<Amount>>>,
}

/// The other keys, `None` if one is wrong: their values are read once the joints are known. The defaults of the last
/// three are those of the group.
struct OtherKeys<'d> {
    start: Option<i64>,
    goal_time: Option<Option<u64>>,
    /// Tolerances of the path, the goal and the start.
    tolerances: [Option<Value<'d>>; 3],
    limits: Option<Option<TrajectoryLimits>>,
    wraps: Option<Option<bool>>,
    max_duration: Option<Option<u64>>,
    may_end_in_motion: Option<bool>,
}

impl Reader<'_> {
    pub(super) fn query_trajectory(&self, value: &Value<'_>) -> Option<Effect> {
        let mut map = value.map("query_trajectory")?;
        let (axis, time) = (map.required("axis"), map.required("time"));
        map.finish();
        let (axis, at_ns) = (axis?.text()?.to_owned(), moment::nanoseconds(&time?)?);
        self.to_command(value, self.names.config.resolve_query_trajectory(&axis, at_ns).map(Action::QueryTrajectory))
    }

    pub(super) fn follow_joint_trajectory(&mut self, value: &Value<'_>) -> EffectOfGoal {
        let Some(mut map) = value.map("follow_joint_trajectory") else { return (None, None) };
        let id = map.optional("id").map(|id| self.ids.carry(&id));
        let file = map.optional("file");
        let given = if let Some(file) = &file { refuse_keys_of_file(file, &mut map) } else { self.given(&mut map) };
        let partial = file.as_ref().and_then(|_| map.optional("allow_partial_joints_goal"));
        let may_lack_joints = partial.map_or(Some(false), |value| value.boolean());
        let others = OtherKeys::read(&mut map);
        map.finish();
        let deed = match &file {
            None => given.and_then(|given| self.trajectory(given, others, |error| error, |_| value)),
            Some(file) => may_lack_joints.and_then(|may_lack_joints| self.plan(file, others, may_lack_joints)),
        };
        (deed, id.flatten())
    }

    /// Reads a trajectory with points in a file.
    fn plan(&self, file: &Value<'_>, others: OtherKeys<'_>, may_lack_joints: bool) -> Option<Effect> {
        let Some(folder) = self.names.folder else {
            file.refuse("file is for scenarios; points are expected here", None);
            return None;
        };
        let document = Document::read_long(&folder.join(file.text()?));
        let deed = document.root("the trajectory").and_then(|root| {
            let plan = Plan::read(&root)?;
            let given = Given { joints: self.joints(&plan.joints)?, units: 0, points: plan.points() };
            if let Some(joint) = given.joints.iter().find(|joint| joint.scale.is_none()) {
                return self.to_command(&plan.joints, Err(self.unknown_joint(joint)));
            }
            if !may_lack_joints {
                self.check_joints(&given.joints, &plan.joints);
            }
            self.trajectory(given, others, Plan::by_its_fields, |sentence| plan.place_of(sentence))
        });
        let is_good = document.problems().is_empty();
        file.add_problems(document.into_problems());
        deed.filter(|_| is_good)
    }

    /// Returns the error for a joint of a plan that is no axis, with the text of the action.
    fn unknown_joint(&self, joint: &Joint<'_>) -> RequestError {
        let joints = self.names.joints;
        let driven = (0..).zip(&self.names.config.axes).filter(|(_, axis)| axis.drive.is_some());
        let known: Vec<&str> =
            driven.map(|(place, axis)| joints.map_or(axis.name.as_str(), |joints| joints.get(place))).collect();
        RequestError::BadTrajectory {
            name: "joint_names".to_owned(),
            value: format!("has the joint `{}`", excerpt(joint.name)),
            allowed: format!("there are {}", known.join(", ")),
        }
    }

    /// Refuses a plan with only some of the joints of a group, as the action does.
    fn check_joints(&self, joints: &[Joint<'_>], place: &Value<'_>) {
        let config = self.names.config;
        let driven = (0..).zip(&config.axes).filter(|(_, axis)| axis.drive.is_some()).map(|(place, _)| place);
        let groups = match self.names.groups {
            [] => vec![driven.collect()],
            groups => groups.iter().map(|group| group.axes.clone()).collect(),
        };
        let has =
            |axes: &[u16], joint: &Joint<'_>| axes.iter().any(|axis| config.name(Object::Axis(*axis)) == joint.axis);
        // Of several groups, the one with the fewest joints is meant. Joints without a group are refused elsewhere.
        let around = groups.iter().filter(|axes| joints.iter().all(|joint| has(axes, joint)));
        let Some(group) = around.min_by_key(|axes| axes.len()).filter(|axes| axes.len() > joints.len()) else { return };
        let joint_of =
            |&axis: &u16| self.names.joints.map_or(config.name(Object::Axis(axis)), |joints| joints.get(axis));
        let known: Vec<_> = group.iter().map(joint_of).collect();
        let sentence = format!("joint_names has {} of {}", joints.len(), known.join(", "));
        place.refuse(format!("{sentence}; all are expected, or some with allow_partial_joints_goal: true"), None);
    }

    /// Reads joints, units and points in the verb.
    fn given<'d>(&self, map: &mut Map<'d>) -> Option<Given<'d>> {
        let joints = map.required("joints").and_then(|joints| self.joints(&joints));
        let units = units(map);
        let points = map.required("points");
        let (joints, units) = (joints?, units?);
        let numbers = Numbers { names: self.names, joints: &joints, in_increments: units == 2 };
        let points = points?.list()?.iter().map(|point| numbers.point(point)).collect::<Vec<_>>();
        let points = points.into_iter().collect();
        Some(Given { joints, units, points })
    }

    /// Creates the command. Errors of the request are changed by `shown` and reported at the location that `place`
    /// returns for their message.
    fn trajectory<'v, 'd: 'v>(
        &self,
        given: Given<'_>,
        others: OtherKeys<'_>,
        shown: fn(RequestError) -> RequestError,
        place: impl Fn(&str) -> &'v Value<'d>,
    ) -> Option<Effect> {
        let Given { joints, units, points } = given;
        let numbers = Numbers { names: self.names, joints: &joints, in_increments: units == 2 };
        let units = match Units::from_number(units) {
            Ok(units) => units,
            Err(error) => return self.to_command(place(""), Err(error)),
        };
        // Checked first, because tolerances of an unknown joint would fail as well.
        if let Some(error) = joints.iter().find_map(|joint| self.names.config.find_axis(&joint.axis).err()) {
            return self.to_command(place(&error.to_string()), Err(error));
        }
        let usual = self.settings(&joints);
        let [path, goal, start_tolerance] = others.tolerances.map(|value| numbers.tolerances(value.as_ref()));
        let request = TrajectoryRequest {
            axes: joints.iter().map(|joint| joint.axis.clone()).collect(),
            joints: joints.iter().map(|joint| joint.name.to_owned()).collect(),
            units,
            start_ns: others.start?,
            points: points?,
            path: path?,
            goal: goal?,
            goal_time_ns: others.goal_time?,
            start: start_tolerance?,
            limits: others.limits?.unwrap_or(usual.limits),
            angle_wraparound: others.wraps?.unwrap_or(usual.angle_wraparound),
            // 0 means no limit.
            max_duration_ns: others.max_duration?.or(usual.max_duration_ns()).filter(|ns| *ns > 0),
            may_end_in_motion: others.may_end_in_motion?,
        };
        let trajectory = self.names.config.resolve_trajectory(&request).map_err(shown);
        let at = trajectory.as_ref().err().map_or_else(|| place(""), |error| place(&error.to_string()));
        self.to_command(at, trajectory.map(|trajectory| Action::Trajectory(Arc::new(trajectory))))
    }

    /// Returns the settings of the group of these joints.
    fn settings(&self, joints: &[Joint<'_>]) -> TrajectorySettings {
        let is_of = |group: &&Group| {
            let mut names = group.axes.iter().filter_map(|axis| self.names.config.axes.get(usize::from(*axis)));
            group.axes.len() == joints.len() && names.all(|axis| joints.iter().any(|joint| joint.axis == axis.name))
        };
        self.names.groups.iter().find(is_of).map(|group| group.trajectories).unwrap_or_default()
    }

    fn joints<'d>(&self, value: &Value<'d>) -> Option<Vec<Joint<'d>>> {
        let items = value.list()?;
        let names: Vec<_> = items.iter().map(Value::text).collect();
        let names = names.into_iter().collect::<Option<Vec<&'d str>>>()?;
        let joint = |name: &'d str| {
            let axis = self.names.axis_of_joint(name);
            let scale = self.names.config.find_axis(&axis).ok().map(|(_, axis)| axis.scale);
            Joint { name, axis, scale }
        };
        Some(names.into_iter().map(joint).collect())
    }
}

impl<'d> OtherKeys<'d> {
    fn read(map: &mut Map<'d>) -> Self {
        Self {
            start: map.optional("start").map_or(Some(0), |start| nanoseconds(&start, &Allowed::Any)),
            goal_time: optional_time(map, "goal_time"),
            tolerances: ["path_tolerance", "goal_tolerance", "start_tolerance"].map(|key| map.optional(key)),
            limits: map.optional("trajectory_limits").map_or(Some(None), |value| trajectory_limits(&value).map(Some)),
            wraps: map.optional("angle_wraparound").map_or(Some(None), |value| value.boolean().map(Some)),
            max_duration: optional_time(map, "max_duration"),
            may_end_in_motion: map
                .optional("allow_nonzero_velocity_at_trajectory_end")
                .map_or(Some(false), |value| value.boolean()),
        }
    }
}

impl Numbers<'_, '_> {
    fn amount(&self, value: &Value<'_>, order: u8, joint: Option<&Joint<'_>>) -> Option<Amount> {
        amount(value, order, joint.and_then(|joint| joint.scale.as_ref()), self.in_increments)
    }

    fn point(&self, value: &Value<'_>) -> Option<PointRequest<Amount>> {
        let mut map = value.map("a point")?;
        let time = map.required("time").map(|time| nanoseconds(&time, &Allowed::NotNegative));
        let [positions, velocities, accelerations] =
            [("positions", 0), ("velocities", 1), ("accelerations", 2)].map(|(key, order)| {
                let list = if order == 0 { map.required(key) } else { map.optional(key) };
                list.map_or(Some(Vec::new()), |list| self.amounts(&list, order))
            });
        map.finish();
        let time_ns = u64::try_from(time??).ok()?;
        Some(PointRequest { time_ns, positions: positions?, velocities: velocities?, accelerations: accelerations? })
    }

    fn amounts(&self, value: &Value<'_>, order: u8) -> Option<Vec<Amount>> {
        let items = value.list()?;
        let amounts: Vec<_> =
            items.iter().enumerate().map(|(place, item)| self.amount(item, order, self.joints.get(place))).collect();
        amounts.into_iter().collect()
    }

    /// Reads the tolerances by joint: a position, or `position`, `velocity` and `acceleration`.
    fn tolerances(&self, value: Option<&Value<'_>>) -> Option<Vec<ToleranceRequest<Amount>>> {
        let Some(value) = value else { return Some(Vec::new()) };
        let mut tolerances = vec![None; self.joints.len()];
        let mut is_good = true;
        for (key, value) in value.entries()? {
            let name = key.text()?;
            let axis = self.names.axis_of_joint(name);
            let Some(place) = self.joints.iter().position(|joint| joint.axis == axis) else {
                let joints: Vec<&str> = self.joints.iter().map(|joint| joint.name).collect();
                let known = format!("joints are {}", joints.join(", "));
                key.refuse(format!("`{}` is no joint of this trajectory", excerpt(name)), Some(known));
                is_good = false;
                continue;
            };
            let tolerance = self.tolerance(&value, self.joints.get(place));
            is_good &= tolerance.is_some();
            if tolerances[place].replace(tolerance.unwrap_or_default()).is_some() {
                key.refuse(format!("axis {axis} has a tolerance already, by its other name"), None);
                is_good = false;
            }
        }
        is_good.then(|| tolerances.into_iter().map(Option::unwrap_or_default).collect())
    }

    fn tolerance(&self, value: &Value<'_>, joint: Option<&Joint<'_>>) -> Option<ToleranceRequest<Amount>> {
        if !value.is_map() {
            let position = Some(self.amount(value, 0, joint)?);
            return Some(ToleranceRequest { position, ..ToleranceRequest::default() });
        }
        let mut map = value.map("a tolerance")?;
        let [position, velocity, acceleration] =
            [("position", 0), ("velocity", 1), ("acceleration", 2)].map(|(key, order)| match map.optional(key) {
                Some(value) => self.amount(&value, order, joint).map(Some),
                None => Some(None),
            });
        map.finish();
        Some(ToleranceRequest { position: position?, velocity: velocity?, acceleration: acceleration? })
    }
}

/// Refuses keys that are in the file.
fn refuse_keys_of_file<'d>(file: &Value<'d>, map: &mut Map<'d>) -> Option<Given<'d>> {
    for key in ["joints", "units", "points"] {
        if let Some(value) = map.optional(key) {
            let file = excerpt(file.peek().unwrap_or_default());
            value.refuse(format!("{key} conflicts with file `{file}`, which has it"), Some("leave it out".to_owned()));
        }
    }
    None
}

/// Reads an optional time.
fn optional_time(map: &mut Map<'_>, key: &str) -> Option<Option<u64>> {
    let Some(value) = map.optional(key) else { return Some(None) };
    let time = nanoseconds(&value, &Allowed::NotNegative)?;
    u64::try_from(time).ok().map(Some)
}

/// Reads a time in integer nanoseconds; a number without unit is in seconds.
fn nanoseconds(value: &Value<'_>, allowed: &Allowed) -> Option<i64> {
    match value.quantity(&[Dimension::Time], allowed)?.nanoseconds() {
        Ok(ns) => Some(ns),
        Err(error) => {
            value.refuse(format!("{}: {error}", value.label()), error.hint());
            None
        }
    }
}

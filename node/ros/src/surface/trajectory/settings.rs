//! Parameters of trajectories, with the names of joint_trajectory_controller. Axes may belong to several groups: parameters of joints, and
//! general ones, apply to all groups.

use super::joints::Joints;
use crate::surface::group::TrajectorySettings;
use crate::surface::joint_names::JointNames;
use crate::surface::parameters::own::{OwnParameter, OwnParameters, Values};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::trajectory::{OnExcess, TrajectoryLimits};
use lineshaft_msgs::foreign::rcl_interfaces::msg::{
    FloatingPointRange, ParameterDescriptor, ParameterType, ParameterValue,
};
use std::time::Duration;

const PARTIAL: &str = "allow_partial_joints_goal";
const INTEGRATION: &str = "allow_integration_in_goal_trajectories";
const MOVING_END: &str = "allow_nonzero_velocity_at_trajectory_end";
const MONITOR_RATE: &str = "action_monitor_rate";
const GOAL_TIME: &str = "constraints.goal_time";
const STOPPED: &str = "constraints.stopped_velocity_tolerance";
/// Parameter of each group.
const MARGIN: &str = "trajectory_limits.margin";
const ON_EXCESS: &str = "trajectory_limits.on_excess";
const MAX_STRETCH: &str = "trajectory_limits.max_stretch";
const WRAPAROUND: &str = "angle_wraparound";
const MAX_DURATION: &str = "max_duration";
const STATE_RATE: &str = "controller_state_rate";

/// Allowed values of ON_EXCESS.
const WORDS: &[&str] = &["scale", "refuse"];

/// Default feedback rate, and its allowed range, in messages per second.
const USUAL_RATE: f64 = 20.0;
const RATES: (f64, f64) = (0.1, 1000.0);

/// Values of the parameters when a goal arrives.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Settings {
    /// Whether a goal may name only some of the joints.
    pub partial: bool,
    /// Whether points may have only velocities.
    pub integration: bool,
    /// Whether the last point may have velocities.
    pub may_end_in_motion: bool,
    /// Time after the last point within which the goal tolerances must be met, in s; 0: unlimited.
    pub goal_time: f64,
    /// Velocity below which a joint counts as at rest, in m/s or rad/s; 0: not checked.
    pub stopped: f64,
    /// Tolerances for each joint during the motion, at the end and at the start, in m or rad; 0: unlimited.
    pub joints: Vec<[f64; 3]>,
    /// Trajectory settings of the group.
    pub group: TrajectorySettings,
}

fn of_joint(name: &str) -> [String; 3] {
    ["trajectory", "goal", "start"].map(|what| format!("constraints.{name}.{what}"))
}

/// Declares the parameters, with those of each group.
pub(super) fn declare<'a>(
    own: &OwnParameters,
    config: &MachineConfig,
    names: &JointNames,
    groups: impl IntoIterator<Item = &'a Joints>,
) {
    for joints in groups {
        declare_of_group(own, joints);
    }
    own.declare(switch(PARTIAL, "Goals may name some of the joints only."));
    own.declare(switch(INTEGRATION, "Points may have velocities alone: positions are integrated from the command."));
    let text = "The last point of a trajectory may have velocities, with which the joints begin to stop; otherwise such a trajectory is refused.";
    own.declare(switch(MOVING_END, text));
    let mut rate = real(MONITOR_RATE, USUAL_RATE, RATES, "Feedback of follow_joint_trajectory per second [Hz].");
    rate.descriptor.read_only = true;
    own.declare(rate);
    let tolerance = |name: &str, usual, text: &str| own.declare(real(name, usual, (0.0, f64::MAX), text));
    tolerance(
        GOAL_TIME,
        0.0,
        "Time after the last point within which the goal tolerances must be met [s]; 0: for ever.",
    );
    tolerance(STOPPED, 0.01, "Velocity error of a joint at the end of a trajectory [m/s or rad/s]; 0: without limit.");
    for (axis, joint) in config.axes.iter().zip(names.iter()).filter(|(axis, _)| axis.drive.is_some()) {
        let [path, goal, start] = of_joint(joint);
        tolerance(&path, 0.0, "How far the joint may be off on its way [m or rad]; 0: without limit.");
        tolerance(&goal, 0.0, "How far the joint may be off at the end [m or rad]; 0: without limit.");
        let text = "How far a first point at time 0 may be from the command of the joint [m or rad]; 0: without limit.";
        tolerance(&start, 0.0, text);
        if axis.name != joint {
            of_joint(&axis.name).into_iter().zip(of_joint(joint)).for_each(|(name, meant)| own.rename(name, meant));
        }
    }
}

fn declare_of_group(own: &OwnParameters, joints: &Joints) {
    let TrajectorySettings { limits, angle_wraparound, max_duration, state_rate } = joints.usual;
    let TrajectoryLimits { margin, on_excess, max_stretch } = limits;
    let text = "Points of joints with modulo are moved by whole turns until the first one is nearest to the joint.";
    let mut wraps = switch(&joints.parameter(WRAPAROUND), text);
    wraps.value.bool_value = angle_wraparound;
    own.declare(wraps);
    let text = "Longest time of a trajectory from its start to its end [s]; 0: without limit.";
    own.declare(real(&joints.parameter(MAX_DURATION), max_duration, (0.0, TrajectorySettings::LONGEST.into()), text));
    let text = "Messages of controller_state per second; 0: none.";
    own.declare(real(&joints.parameter(STATE_RATE), state_rate, TrajectorySettings::STATE_RATES, text));
    let share = "Share by which a trajectory may exceed max_velocity, max_acceleration and max_deceleration.";
    own.declare(real(&joints.parameter(MARGIN), margin, TrajectoryLimits::MARGINS, share));
    let most = "Largest factor by which the time of a trajectory is stretched; beyond it the trajectory is refused.";
    own.declare(real(&joints.parameter(MAX_STRETCH), max_stretch, TrajectoryLimits::STRETCHES, most));
    let text = "What is done with a trajectory that exceeds a limit by more than the margin: scale (stretch its time) or refuse.";
    let mut word = switch(&joints.parameter(ON_EXCESS), text);
    word.descriptor.r#type = ParameterType::PARAMETER_STRING;
    word.descriptor.additional_constraints = WORDS.join(" or ");
    word.value = ParameterValue {
        r#type: ParameterType::PARAMETER_STRING,
        string_value: on_excess.name().to_owned(),
        ..ParameterValue::default()
    };
    own.declare(OwnParameter { words: WORDS, ..word });
}

fn switch(name: &str, text: &str) -> OwnParameter {
    let r#type = ParameterType::PARAMETER_BOOL;
    OwnParameter {
        descriptor: ParameterDescriptor {
            name: name.to_owned(),
            r#type,
            description: text.to_owned(),
            ..ParameterDescriptor::default()
        },
        value: ParameterValue { r#type, ..ParameterValue::default() },
        ..OwnParameter::default()
    }
}

fn real(name: &str, usual: f64, (from_value, to_value): (f64, f64), text: &str) -> OwnParameter {
    let mut own = switch(name, text);
    let range = FloatingPointRange { from_value, to_value, step: 0.0 };
    own.descriptor.r#type = ParameterType::PARAMETER_DOUBLE;
    own.descriptor.floating_point_range = Some(range).into();
    own.value =
        ParameterValue { r#type: ParameterType::PARAMETER_DOUBLE, double_value: usual, ..ParameterValue::default() };
    own
}

impl Settings {
    /// Reads the settings for goals of these joints.
    pub(super) fn read(own: &OwnParameters, joints: &Joints) -> Self {
        own.read(|own| Self::of(own, joints))
    }

    fn of(own: &Values<'_>, joints: &Joints) -> Self {
        let constraints = |name: &String| of_joint(name).map(|name| own.real(&name));
        Self {
            partial: own.switch(PARTIAL),
            integration: own.switch(INTEGRATION),
            may_end_in_motion: own.switch(MOVING_END),
            goal_time: own.real(GOAL_TIME),
            stopped: own.real(STOPPED),
            joints: joints.names.iter().map(constraints).collect(),
            group: TrajectorySettings {
                limits: limits(own, joints),
                angle_wraparound: own.switch(&joints.parameter(WRAPAROUND)),
                max_duration: own.real(&joints.parameter(MAX_DURATION)),
                state_rate: own.real(&joints.parameter(STATE_RATE)),
            },
        }
    }
}

fn limits(own: &Values<'_>, joints: &Joints) -> TrajectoryLimits {
    let word = own.string(&joints.parameter(ON_EXCESS));
    let known = OnExcess::ALL.iter().find(|(_, name)| *name == word);
    TrajectoryLimits {
        margin: own.real(&joints.parameter(MARGIN)),
        on_excess: known.map_or(joints.usual.limits.on_excess, |(on_excess, _)| *on_excess),
        max_stretch: own.real(&joints.parameter(MAX_STRETCH)),
    }
}

/// Returns the time between two messages of `~/controller_state`; `None` if they are disabled.
pub(super) fn state_period(own: &OwnParameters, joints: &Joints) -> Option<Duration> {
    let rate = own.real(&joints.parameter(STATE_RATE));
    (rate > 0.0).then(|| Duration::try_from_secs_f64(1.0 / rate).unwrap_or(Duration::MAX))
}

/// Returns the time between two feedback messages.
pub(super) fn feedback_period(own: &OwnParameters) -> Duration {
    let rate = own.real(MONITOR_RATE);
    // A rate outside its range cannot be declared or set.
    let rate = if rate >= RATES.0 && rate <= RATES.1 { rate } else { USUAL_RATE };
    Duration::from_secs_f64(1.0 / rate)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{config, joint_names, joints, joints_called};
    use super::*;

    fn declared() -> OwnParameters {
        let own = OwnParameters::default();
        declare(&own, &config(), &joint_names(), &[joints()]);
        own
    }

    #[test]
    fn defaults_are_those_of_joint_trajectory_controller() {
        // joint_trajectory_controller_parameters.yaml, Jazzy
        let own = declared();
        let usual = Settings {
            partial: false,
            integration: false,
            may_end_in_motion: false,
            goal_time: 0.0,
            stopped: 0.01,
            joints: vec![[0.0; 3]; 2],
            group: TrajectorySettings::default(),
        };
        assert_eq!(Settings::read(&own, &joints()), usual);
        assert_eq!(feedback_period(&own), Duration::from_millis(50));
        assert!(own.get("action_monitor_rate").is_some_and(|own| own.descriptor.read_only));
    }

    #[test]
    fn each_joint_with_a_drive_has_its_own_tolerances() {
        let own = declared();
        let mut goal = own.get("constraints.y.goal").expect("declared");
        goal.value.double_value = 0.5;
        own.declare(goal);
        assert_eq!(Settings::read(&own, &joints()).joints, [[0.0; 3], [0.0, 0.5, 0.0]]);
        assert!(own.get("constraints.line.goal").is_none(), "a virtual axis follows no trajectory");
    }

    #[test]
    fn settings_of_a_group_are_parameters_with_its_name() {
        let own = OwnParameters::default();
        let limits = TrajectoryLimits { margin: 0.01, on_excess: OnExcess::Refuse, max_stretch: 2.0 };
        let usual = TrajectorySettings { limits, angle_wraparound: true, max_duration: 30.0, state_rate: 20.0 };
        let arm = joints().of_group("arm", usual);
        declare(&own, &config(), &joint_names(), std::slice::from_ref(&arm));
        assert_eq!(Settings::read(&own, &arm).group, usual);
        let names = own.names();
        for name in
            ["arm.trajectory_limits.margin", "arm.trajectory_limits.on_excess", "arm.trajectory_limits.max_stretch"]
        {
            assert!(names.iter().any(|known| known == name), "{name}");
        }
        let words: Vec<_> = OnExcess::ALL.iter().map(|(_, name)| *name).collect();
        assert_eq!(words, WORDS);
        let mut word = own.get("arm.trajectory_limits.on_excess").expect("declared");
        word.value.string_value = "ignore".to_owned();
        let refused = own.fitting("arm.trajectory_limits.on_excess", &word.value);
        assert_eq!(
            refused,
            Some(Err("arm.trajectory_limits.on_excess is `ignore`; scale or refuse is allowed".to_owned()))
        );
    }

    #[test]
    fn tolerances_have_the_joint_name_and_the_object_name_is_refused_with_it() {
        let own = OwnParameters::default();
        let names = JointNames::new(["line", "left/arm_1", "y"].map(str::to_owned).to_vec());
        let joints = joints_called(&names);
        declare(&own, &config(), &names, std::slice::from_ref(&joints));
        for (name, is_there) in [("constraints.left/arm_1", true), ("constraints.x", false), ("constraints.y", true)] {
            for of in ["trajectory", "goal", "start"] {
                assert_eq!(own.get(&format!("{name}.{of}")).is_some(), is_there, "{name}.{of}");
            }
        }
        let mut goal = own.get("constraints.left/arm_1.goal").expect("declared");
        goal.value.double_value = 0.5;
        own.declare(goal.clone());
        assert_eq!(Settings::read(&own, &joints).joints, [[0.0, 0.5, 0.0], [0.0; 3]]);
        let sentence = "parameter `constraints.x.goal` has not been declared; by the joint name it is `constraints.left/arm_1.goal`";
        assert_eq!(own.fitting("constraints.x.goal", &goal.value), Some(Err(sentence.to_owned())));
        assert_eq!(own.fitting("constraints.line.goal", &goal.value), None, "a virtual axis follows no trajectory");
    }

    #[test]
    fn a_number_has_a_range() {
        let own = declared().get("constraints.goal_time").expect("declared").descriptor;
        assert_eq!(own.r#type, ParameterType::PARAMETER_DOUBLE);
        assert_eq!(own.floating_point_range.first().map(|range| range.from_value), Some(0.0));
    }
}

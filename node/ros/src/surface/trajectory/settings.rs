//! The parameters of trajectories, with the names of joint_trajectory_controller. Axes may stand in several groups: what is said
//! of a joint, and of trajectories as such, counts for all of them.

use crate::surface::parameters::own::{Own, OwnParameters};
use lineshaft_core::config::MachineConfig;
use lineshaft_msgs::foreign::rcl_interfaces::msg::{
    FloatingPointRange, ParameterDescriptor, ParameterType, ParameterValue,
};
use std::time::Duration;

const PARTIAL: &str = "allow_partial_joints_goal";
const MOVING_END: &str = "allow_nonzero_velocity_at_trajectory_end";
const MONITOR_RATE: &str = "action_monitor_rate";
const GOAL_TIME: &str = "constraints.goal_time";
const STOPPED: &str = "constraints.stopped_velocity_tolerance";

/// Feedback per second, and what may be set.
const USUAL_RATE: f64 = 20.0;
const RATES: (f64, f64) = (0.1, 1000.0);

/// What they are worth when a goal comes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Settings {
    /// A goal may name some of the joints only.
    pub partial: bool,
    /// How long after its last point its goal tolerances may be met (s); 0: for ever.
    pub goal_time: f64,
    /// Velocity of a joint that stands (m/s, rad/s); 0: none is asked for.
    pub stopped: f64,
    /// For each joint: how far it may be off on the way, and at the end (m, rad); 0: as far as it likes.
    pub joints: Vec<(f64, f64)>,
}

fn of_joint(name: &str) -> [String; 2] {
    [format!("constraints.{name}.trajectory"), format!("constraints.{name}.goal")]
}

/// Declares them.
pub(super) fn declare(own: &OwnParameters, config: &MachineConfig) {
    own.declare(switch(PARTIAL, "Goals may name some of the joints only."));
    let mut moving_end =
        switch(MOVING_END, "A trajectory may end in motion; else a last point with a velocity is refused.");
    moving_end.descriptor.read_only = true;
    moving_end.descriptor.additional_constraints = "does not exist yet: always false".to_owned();
    own.declare(moving_end);
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
    for axis in config.axes.iter().filter(|axis| axis.drive.is_some()) {
        let [path, goal] = of_joint(&axis.name);
        tolerance(&path, 0.0, "How far the joint may be off on its way [m or rad]; 0: without limit.");
        tolerance(&goal, 0.0, "How far the joint may be off at the end [m or rad]; 0: without limit.");
    }
}

fn switch(name: &str, text: &str) -> Own {
    let r#type = ParameterType::PARAMETER_BOOL;
    Own {
        descriptor: ParameterDescriptor {
            name: name.to_owned(),
            r#type,
            description: text.to_owned(),
            ..ParameterDescriptor::default()
        },
        value: ParameterValue { r#type, ..ParameterValue::default() },
    }
}

fn real(name: &str, usual: f64, (from_value, to_value): (f64, f64), text: &str) -> Own {
    let mut own = switch(name, text);
    let range = FloatingPointRange { from_value, to_value, step: 0.0 };
    own.descriptor.r#type = ParameterType::PARAMETER_DOUBLE;
    own.descriptor.floating_point_range = Some(range).into();
    own.value =
        ParameterValue { r#type: ParameterType::PARAMETER_DOUBLE, double_value: usual, ..ParameterValue::default() };
    own
}

impl Settings {
    /// For goals of these joints.
    pub(super) fn read(own: &OwnParameters, joints: &[String]) -> Self {
        let constraints = |name: &String| {
            let [path, goal] = of_joint(name);
            (own.real(&path), own.real(&goal))
        };
        Self {
            partial: own.switch(PARTIAL),
            goal_time: own.real(GOAL_TIME),
            stopped: own.real(STOPPED),
            joints: joints.iter().map(constraints).collect(),
        }
    }
}

/// Time between two feedback messages.
pub(super) fn feedback_period(own: &OwnParameters) -> Duration {
    let rate = own.real(MONITOR_RATE);
    // A rate outside its range cannot be declared or set.
    let rate = if rate >= RATES.0 && rate <= RATES.1 { rate } else { USUAL_RATE };
    Duration::from_secs_f64(1.0 / rate)
}

#[cfg(test)]
mod tests {
    use super::super::tests::config;
    use super::*;

    fn declared() -> OwnParameters {
        let own = OwnParameters::default();
        declare(&own, &config());
        own
    }

    #[test]
    fn defaults_are_those_of_joint_trajectory_controller() {
        // joint_trajectory_controller_parameters.yaml, Jazzy
        let own = declared();
        let joints = ["x".to_owned(), "y".to_owned()];
        let usual = Settings { partial: false, goal_time: 0.0, stopped: 0.01, joints: vec![(0.0, 0.0), (0.0, 0.0)] };
        assert_eq!(Settings::read(&own, &joints), usual);
        assert_eq!(feedback_period(&own), Duration::from_millis(50));
        assert!(own.get("action_monitor_rate").is_some_and(|own| own.descriptor.read_only));
    }

    #[test]
    fn each_joint_with_a_drive_has_its_own_tolerances() {
        let own = declared();
        let mut goal = own.get("constraints.y.goal").expect("declared");
        goal.value.double_value = 0.5;
        own.declare(goal);
        assert_eq!(Settings::read(&own, &["y".to_owned()]).joints, [(0.0, 0.5)]);
        assert!(own.get("constraints.line.goal").is_none(), "a virtual axis follows no trajectory");
    }

    #[test]
    fn a_number_has_a_range() {
        let own = declared().get("constraints.goal_time").expect("declared").descriptor;
        assert_eq!(own.r#type, ParameterType::PARAMETER_DOUBLE);
        assert_eq!(own.floating_point_range.first().map(|range| range.from_value), Some(0.0));
    }
}

//! `lineshaft move`: sends a goal of `~/move_axis`.

use super::amount::{AxisKind, Given, GoalUnits};
use super::goals::{Ended, Goals};
use super::info::AxisInfos;
use super::output::{Progress, position_text, print, with_commands};
use super::session::Session;
use super::{Failure, Options};
use lineshaft_core::code::Code;
use lineshaft_msgs::action::{MoveAxis, MoveAxisFeedback, MoveAxisGoal, MoveAxisResult};
use lineshaft_msgs::foreign::action_msgs::msg::GoalStatus;

/// Parameters of a motion.
#[derive(Clone, Debug)]
pub(crate) struct Motion {
    pub(crate) axis: String,
    pub(crate) position: Given,
    /// Whether `position` is a distance.
    pub(crate) is_relative: bool,
    pub(crate) velocity: Option<Given>,
    pub(crate) acceleration: Option<Given>,
    pub(crate) deceleration: Option<Given>,
}

/// Moves an axis, waits for the end, and prints its position.
///
/// # Errors
/// Returns an error if the node refuses or aborts the motion or does not answer, or if a signal ended it.
pub(crate) async fn move_axis(options: &Options, motion: &Motion) -> Result<(), Failure> {
    let units = units(motion)?;
    let session = Session::open(options).await?;
    let (kind, unit) = AxisInfos::open(&session)?.of(&session, &motion.axis).await?;
    let goal = goal(motion, units, (kind, unit))?;
    let mut goals = Goals::<MoveAxis>::open(&session, "move_axis").await?;
    let (progress, axis) = (Progress::new(), &motion.axis);
    let at = |position| position_text(position, Some(kind), unit);
    let show = |_: usize, feedback: MoveAxisFeedback| {
        progress.show(&format!("{axis}: {}, {} to go", at(feedback.position), at(feedback.distance_to_go)));
    };
    let ends = goals.run(vec![goal], show).await?;
    drop(progress);
    match ends.into_iter().next() {
        Some(Ended::Over { status: GoalStatus::STATUS_SUCCEEDED, result }) => {
            let MoveAxisResult { position, position_increments, .. } = result;
            print(&format!("{axis}: {}, {position_increments} inc", at(position)));
            Ok(())
        }
        Some(Ended::Over { result, .. }) => {
            Err(Failure::Failed(unfinished(axis, session.target(), &result, &at(result.position))))
        }
        Some(Ended::Rejected(reason)) => Err(Failure::Failed(with_commands(&reason, &[axis], session.target()))),
        None => Err(Failure::Failed(format!("{axis}: the goal has no end"))),
    }
}

/// Returns the message for a motion that has not reached its position.
fn unfinished(axis: &str, node: &str, result: &MoveAxisResult, position: &str) -> String {
    let message = with_commands(&result.message, &[axis], node);
    // A machine without cycles has no position.
    if result.code == Code::NOT_ACTIVE.0 { message } else { format!("{message}; command position {position}") }
}

fn units(motion: &Motion) -> Result<GoalUnits, Failure> {
    let rates = [&motion.velocity, &motion.acceleration, &motion.deceleration].into_iter().flatten();
    GoalUnits::of(&[&motion.position].into_iter().chain(rates).collect::<Vec<_>>())
}

fn goal(motion: &Motion, units: GoalUnits, kind: AxisKind) -> Result<MoveAxisGoal, Failure> {
    // 0 is the default of the axis.
    let rate = |given: &Option<Given>| given.as_ref().map_or(Ok(0.0), |given| given.rate(units, kind));
    Ok(MoveAxisGoal {
        axis: motion.axis.clone(),
        mode: if motion.is_relative { MoveAxisGoal::RELATIVE } else { MoveAxisGoal::ABSOLUTE },
        units: match units {
            GoalUnits::Si => MoveAxisGoal::SI,
            GoalUnits::Increments => MoveAxisGoal::INCREMENTS,
        },
        position: motion.position.in_units(units, kind)?,
        velocity: rate(&motion.velocity)?,
        acceleration: rate(&motion.acceleration)?,
        deceleration: rate(&motion.deceleration)?,
        ..MoveAxisGoal::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_core::unit::{ScaleKind, Unit};

    fn motion(position: &str) -> Motion {
        Motion {
            axis: "x".to_owned(),
            position: Given::read("POSITION", position, 0).unwrap(),
            is_relative: false,
            velocity: None,
            acceleration: None,
            deceleration: None,
        }
    }

    fn of(motion: &Motion, kind: ScaleKind) -> Result<MoveAxisGoal, Failure> {
        goal(motion, units(motion)?, (kind, None))
    }

    /// MoveAxis.action: mode ABSOLUTE is 0, RELATIVE 1; units SI is 0, INCREMENTS 2; a quantity of 0 is the default.
    #[test]
    fn goal_has_mode_units_and_quantities_of_the_interface() {
        let goal = of(&motion("10 mm"), ScaleKind::Linear).unwrap();
        assert_eq!((goal.axis.as_str(), goal.mode, goal.units, goal.position), ("x", 0, 0, 0.01));
        assert_eq!((goal.velocity, goal.acceleration, goal.deceleration, goal.jerk), (0.0, 0.0, 0.0, 0.0));
        assert_eq!((goal.buffer_mode, goal.direction), (0, 0));

        let rate = |text, order| Some(Given::read("rate", text, order).unwrap());
        let all = Motion {
            is_relative: true,
            velocity: rate("30 rpm", 1),
            acceleration: rate("180 deg/s^2", 2),
            deceleration: rate("2 rad/s^2", 2),
            ..motion("-90 deg")
        };
        let goal = of(&all, ScaleKind::Rotary).unwrap();
        let pi = std::f64::consts::PI;
        assert_eq!((goal.mode, goal.units, goal.position), (1, 0, -pi / 2.0));
        assert_eq!((goal.velocity, goal.acceleration, goal.deceleration), (pi, pi, 2.0));

        let goal = of(&motion("1048576 inc"), ScaleKind::Linear).unwrap();
        assert_eq!((goal.units, goal.position), (2, 1_048_576.0));
    }

    #[test]
    fn unfinished_motion_has_a_position_if_the_machine_runs() {
        let result = |code: Code, message: &str| MoveAxisResult {
            code: code.0,
            message: message.to_owned(),
            ..MoveAxisResult::default()
        };
        let in_error = result(Code::IN_ERROR, "x: the axis stands in ERROR_STOP; reset_errors first");
        assert_eq!(
            unfinished("x", "/second", &in_error, "0.05 m"),
            "x: the axis stands in ERROR_STOP; `lineshaft reset x --node /second` first; command position 0.05 m"
        );
        let unconfigured = result(Code::NOT_ACTIVE, "the node is unconfigured and no cycle runs");
        assert_eq!(unfinished("x", "/lineshaft", &unconfigured, "0 m"), "the node is unconfigured and no cycle runs");
    }

    #[test]
    fn goal_with_a_unit_of_another_kind_than_the_axis_is_not_sent() {
        assert!(matches!(of(&motion("90 deg"), ScaleKind::Linear), Err(Failure::Usage(_))));
    }

    #[test]
    fn goal_with_a_number_without_a_unit_is_not_sent() {
        let axis = (ScaleKind::Linear, Some(Unit::MILLIMETRE));
        let refused = |motion: &Motion| goal(motion, units(motion)?, axis);
        let usage = |sentence: &str| -> Result<MoveAxisGoal, Failure> { Err(Failure::Usage(sentence.to_owned())) };
        assert_eq!(refused(&motion("50")), usage("POSITION: `50` has no unit; did you mean `50 mm`?"));
        let fast = Motion { velocity: Some(Given::read("--velocity", "5", 1).unwrap()), ..motion("50 mm") };
        assert_eq!(refused(&fast), usage("--velocity: `5` has no unit; did you mean `5 mm/s`?"));
        assert_eq!(refused(&motion("0")).map(|goal| goal.position), Ok(0.0));
    }
}

//! End of a goal of `~/follow_joint_trajectory`.

use lineshaft_core::code::Code;
use lineshaft_msgs::foreign::control_msgs::action::FollowJointTrajectoryResult as Result;

/// Final state of a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FinalState {
    Succeeded,
    Canceled,
    Aborted,
}

/// Returns the final state and the result of a goal that ended with `code` and message `sentence` of the machine. `is_cancelled`: a client
/// has cancelled it; `has_run`: the machine had accepted it.
///
/// Each text starts as in joint_trajectory_controller; details of the machine follow.
pub(super) fn end(code: Code, sentence: &str, is_cancelled: bool, has_run: bool) -> (FinalState, Result) {
    let (last, error_code, error_string) = match code {
        Code::NONE => (FinalState::Succeeded, Result::SUCCESSFUL, "Goal successfully reached!".to_owned()),
        // The controller leaves the result of a cancelled goal at its default, because there is no error.
        Code::CANCELLED if is_cancelled => (FinalState::Canceled, Result::SUCCESSFUL, String::new()),
        Code::TRAJECTORY_PATH_TOLERANCE => {
            let text = format!("Aborted due to path tolerance violation: {sentence}");
            (FinalState::Aborted, Result::PATH_TOLERANCE_VIOLATED, text)
        }
        Code::TRAJECTORY_GOAL_TOLERANCE => {
            let text = format!("Aborted due to goal_time_tolerance exceeding: {sentence}");
            (FinalState::Aborted, Result::GOAL_TOLERANCE_VIOLATED, text)
        }
        // Tolerances of the axis and of the group with other names.
        Code::FOLLOWING_ERROR if has_run => (FinalState::Aborted, Result::PATH_TOLERANCE_VIOLATED, sentence.to_owned()),
        Code::TRAJECTORY_TOO_LONG if has_run => {
            (FinalState::Aborted, Result::GOAL_TOLERANCE_VIOLATED, sentence.to_owned())
        }
        Code::TRAJECTORY_IN_THE_PAST => (FinalState::Aborted, Result::OLD_HEADER_TIMESTAMP, sentence.to_owned()),
        Code::REPLACED => {
            let text = format!("Current goal cancelled due to new incoming action. {sentence}");
            (FinalState::Aborted, Result::INVALID_GOAL, text)
        }
        _ => (FinalState::Aborted, Result::INVALID_GOAL, sentence.to_owned()),
    };
    (last, Result { error_code, error_string })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_end_has_the_code_and_text_of_the_controller() {
        // control_msgs/action/FollowJointTrajectory: 0, -1 invalid goal, -3 old stamp, -4 path, -5 goal tolerance
        let cases = [
            (Code::NONE, false, FinalState::Succeeded, 0, "Goal successfully reached!"),
            // A cancel request that arrives too late does not change a reached goal.
            (Code::NONE, true, FinalState::Succeeded, 0, "Goal successfully reached!"),
            (Code::CANCELLED, true, FinalState::Canceled, 0, ""),
            (
                Code::TRAJECTORY_PATH_TOLERANCE,
                false,
                FinalState::Aborted,
                -4,
                "Aborted due to path tolerance violation: why",
            ),
            (
                Code::TRAJECTORY_PATH_TOLERANCE,
                true,
                FinalState::Aborted,
                -4,
                "Aborted due to path tolerance violation: why",
            ),
            (
                Code::TRAJECTORY_GOAL_TOLERANCE,
                false,
                FinalState::Aborted,
                -5,
                "Aborted due to goal_time_tolerance exceeding: why",
            ),
            (Code::REPLACED, false, FinalState::Aborted, -1, "Current goal cancelled due to new incoming action. why"),
            (Code::TRAJECTORY_IN_THE_PAST, false, FinalState::Aborted, -3, "why"),
            (Code::HALTED, false, FinalState::Aborted, -1, "why"),
            (Code::NOT_ENABLED, false, FinalState::Aborted, -1, "why"),
            (Code::VELOCITY_TOO_HIGH, true, FinalState::Aborted, -1, "why"),
            (Code::FOLLOWING_ERROR, false, FinalState::Aborted, -4, "why"),
            (Code::TRAJECTORY_TOO_LONG, false, FinalState::Aborted, -5, "why"),
            // No client of this goal has cancelled it.
            (Code::CANCELLED, false, FinalState::Aborted, -1, "why"),
        ];
        for (code, is_cancelled, last, error_code, text) in cases {
            let result = Result { error_code, error_string: text.to_owned() };
            assert_eq!(end(code, "why", is_cancelled, true), (last, result), "{code:?}");
        }
        // A trajectory that is too long is refused before it runs, without motion.
        let refused = Result { error_code: -1, error_string: "why".to_owned() };
        assert_eq!(end(Code::TRAJECTORY_TOO_LONG, "why", false, false), (FinalState::Aborted, refused));
    }
}

//! `lineshaft home`: goals of `~/home_axis`.

use super::goals::{Ended, Goals};
use super::info::{AxisInfos, no_axis};
use super::output::{Progress, print, with_commands};
use super::session::{Session, axis_states};
use super::{Failure, Options};
use lineshaft_core::code::Code;
use lineshaft_msgs::action::{HomeAxis, HomeAxisFeedback, HomeAxisGoal};
use lineshaft_msgs::foreign::action_msgs::msg::GoalStatus;
use lineshaft_msgs::foreign::rcl_interfaces::srv::{GetParameters, GetParametersRequest};
use lineshaft_ros::layer::Qos;
use std::collections::HashSet;

/// Homes these axes, or all with a homing method if none is named, and waits for their ends.
///
/// # Errors
/// Returns an error if an axis was not homed: the node refused or aborted it or did not answer, or a signal ended it.
pub(crate) async fn home(options: &Options, axes: &[String]) -> Result<(), Failure> {
    let session = Session::open(options).await?;
    let axes = if axes.is_empty() { with_a_method(&session).await? } else { known(&session, axes).await? };
    let mut goals = Goals::<HomeAxis>::open(&session, "home_axis").await?;
    let progress = Progress::new();
    let mut phases = vec![0; axes.len()];
    let show = |index: usize, feedback: HomeAxisFeedback| {
        if let Some(phase) = phases.get_mut(index) {
            *phase = feedback.phase;
        }
        let all: Vec<_> =
            axes.iter().zip(&phases).map(|(axis, phase)| format!("{axis} {}", phase_text(*phase))).collect();
        progress.show(&all.join(", "));
    };
    let asked = axes.iter().map(|axis| HomeAxisGoal { axis: axis.clone(), ..HomeAxisGoal::default() }).collect();
    let ends = goals.run(asked, show).await?;
    drop(progress);
    let mut failures = Vec::new();
    for (axis, end) in axes.iter().zip(ends) {
        match end {
            // This command takes no method, which the message of the node suggests.
            Ended::Over { result, .. } if result.code == Code::HOMING_NO_METHOD.0 => {
                failures.push(format!("{axis}: homing.method is 0: give the axis a method in its cell"));
            }
            Ended::Over { status: GoalStatus::STATUS_SUCCEEDED, .. } => {
                print(&format!("{axis}: homed"));
            }
            Ended::Over { result, .. } => failures.push(with_commands(&result.message, &[axis], session.target())),
            Ended::Rejected(reason) => {
                failures.push(format!("{axis}: {}", with_commands(&reason, &[axis], session.target())));
            }
        }
    }
    if failures.is_empty() { Ok(()) } else { Err(Failure::Failed(failures.join("; "))) }
}

/// Returns the text of a phase of HomeAxis.action.
fn phase_text(phase: u8) -> &'static str {
    match phase {
        HomeAxisFeedback::SEARCH_SWITCH => "moves to the switch",
        HomeAxisFeedback::LEAVE_SWITCH => "moves off the switch",
        HomeAxisFeedback::SEARCH_INDEX => "moves to the index pulse",
        HomeAxisFeedback::MOVE_TO_OFFSET => "moves to the offset",
        HomeAxisFeedback::IN_DRIVE => "is homed by its drive",
        _ => "waits",
    }
}

/// Returns the named axes; nothing moves if the node lacks one of them.
async fn known(session: &Session, axes: &[String]) -> Result<Vec<String>, Failure> {
    let mut infos = AxisInfos::open(session)?;
    for axis in axes {
        if infos.find(session, axis).await?.is_none() {
            return Err(no_axis(session, axis));
        }
    }
    // An axis that is named twice is homed once.
    let mut seen = HashSet::new();
    Ok(axes.iter().filter(|axis| seen.insert(axis.as_str())).cloned().collect())
}

/// Returns all axes that have a homing method.
async fn with_a_method(session: &Session) -> Result<Vec<String>, Failure> {
    let mut states = axis_states(session)?;
    let all = session.first_states(&mut states).await?.axes;
    drop(states);
    let mut client = session.service::<GetParameters>("get_parameters", Qos::PARAMETERS)?;
    let mut axes = Vec::new();
    for axis in all {
        let request = GetParametersRequest { names: vec![format!("{}.homing.method", axis.name)] };
        let response = session.ask(&mut client, &request).await?;
        // A virtual axis has no such parameter.
        if response.values.first().is_some_and(|value| value.integer_value != 0) {
            axes.push(axis.name);
        }
    }
    if axes.is_empty() { Err(Failure::Failed("no axis has a homing method".to_owned())) } else { Ok(axes) }
}

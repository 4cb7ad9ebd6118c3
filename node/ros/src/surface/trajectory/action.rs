//! `~/follow_joint_trajectory`: executes a goal until its end.

use super::ending::{FinalState, end};
use super::joints::Joints;
use super::points::Points;
use super::{TrajectoryReceiver, settings};
use crate::layer::{ActionEvent, ActionServer, GoalHandle};
use crate::surface::host::Snapshot;
use crate::surface::hub::CommandEvents;
use crate::surface::messages;
use lineshaft_core::code::Code;
use lineshaft_core::command::Action;
use lineshaft_core::event::Kind;
use lineshaft_msgs::foreign::control_msgs::action::{FollowJointTrajectory, FollowJointTrajectoryFeedback};
use std::time::Duration;
use tokio::task::{JoinSet, spawn_blocking};
use tokio::time::MissedTickBehavior;

type Handle = GoalHandle<FollowJointTrajectory>;

pub(super) async fn serve(mut server: ActionServer<FollowJointTrajectory>, taker: TrajectoryReceiver) {
    let name = server.name().to_string();
    let period = settings::feedback_period(&taker.hub.own);
    // Running goals end with the action.
    let mut open = JoinSet::new();
    while let Some(event) = server.next().await {
        while open.try_join_next().is_some() {}
        let ActionEvent::Goal(request) = event else { continue };
        let reader = taker.clone();
        // A long goal takes time and is read in a separate thread; in sequence, so that the newest goal takes effect.
        let reading = spawn_blocking(move || {
            let read = reader.read(request.goal());
            (request, read)
        });
        // A goal that was dropped here has rejected itself.
        let Ok((request, read)) = reading.await else { continue };
        match read.and_then(|started| taker.hand_over(started, None)) {
            Ok(Ok(answers)) => {
                open.spawn(run(taker.clone(), request.accept(), answers, period));
            }
            Ok(Err(busy)) => finish(request.accept(), (Code::TOO_MANY_WAITING, false), &busy.to_string(), &[]),
            Err(sentence) => {
                taker.hub.refuse(format!("{name}: goal rejected: {sentence}"));
                request.reject();
            }
        }
    }
}

/// Ends a goal with a code and whether it has run. `notes` are earlier messages of the machine about it.
fn finish(handle: Handle, (code, has_run): (Code, bool), sentence: &str, notes: &[String]) {
    let (last, mut result) = end(code, sentence, handle.is_cancel_requested(), has_run);
    for note in notes {
        result.error_string += if result.error_string.is_empty() { "" } else { " " };
        result.error_string += note;
    }
    match last {
        FinalState::Succeeded => handle.succeed(result),
        FinalState::Canceled => handle.canceled(result),
        FinalState::Aborted => handle.abort(result),
    }
}

/// Executes an accepted goal until it ends.
async fn run(taker: TrajectoryReceiver, handle: Handle, mut answers: CommandEvents, period: Duration) {
    let TrajectoryReceiver { hub, controllers, place, joints } = taker;
    let mut ticks = tokio::time::interval(period);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Skip);
    let goal = answers.sequence;
    let (mut accepted, mut cancelled) = (false, false);
    let mut notes = Vec::new();
    loop {
        tokio::select! {
            answer = answers.next() => match answer.map(|answer| answer.event) {
                Some(event) => match event.kind {
                    Kind::Accepted => {
                        accepted = true;
                        controllers.record_read(place, goal);
                        handle.execute();
                    }
                    Kind::Refused | Kind::Done => {
                        controllers.record_read(place, goal);
                        let sentence = joints.sentence(&event, hub.host.config());
                        return finish(handle, (event.code, event.kind == Kind::Done), &sentence, &notes);
                    }
                    Kind::Warning => notes.push(joints.sentence(&event, hub.host.config())),
                    _ => {}
                },
                None => {
                    controllers.record_read(place, goal);
                    return finish(handle, (Code::DISABLED, accepted), "the machine has stopped", &notes);
                }
            },
            () = handle.cancel_requested(), if !cancelled => {
                cancelled = hub.submit_without_answer(Action::Cancel { goal }).is_ok();
                if !cancelled {
                    // The command queue is full; tried again a little later.
                    tokio::time::sleep(Duration::from_millis(50)).await;
                }
            }
            // Before that, the signals do not belong to this goal yet.
            _ = ticks.tick(), if accepted => {
                let snapshot = hub.host.snapshot();
                // Feedback that a client does not read is dropped.
                let _ = handle.feedback(&feedback(&joints, &snapshot, hub.clock.stamp(snapshot.stamp_ns)));
            }
        }
    }
}

/// Returns desired positions, actual positions and their difference at the end of a cycle with stamp `stamp_ns`.
pub(super) fn feedback(joints: &Joints, snapshot: &Snapshot, stamp_ns: u64) -> FollowJointTrajectoryFeedback {
    let points = Points::of(joints, &snapshot.board);
    FollowJointTrajectoryFeedback {
        header: messages::header(stamp_ns),
        joint_names: joints.names.clone(),
        desired: points.reference,
        actual: points.actual,
        error: points.error,
        ..FollowJointTrajectoryFeedback::default()
    }
}

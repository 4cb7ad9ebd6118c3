//! Runs goals of an action, from their requests to their ends.
//!
//! Law      the goals are sent one after the other and run in parallel. There is no timeout for their results, because
//!          a motion may take long. A signal cancels all of them, and their ends are still awaited; a second signal
//!          ends the command
//! Refuses  to continue when the node has ended, because the state of its axes is then unknown

use super::Failure;
use super::node_log::NodeLog;
use super::output::node_option;
use super::session::Session;
use super::stop::Stop;
use lineshaft_msgs::Action;
use lineshaft_msgs::foreign::action_msgs::msg::GoalStatus;
use lineshaft_ros::layer::{ActionClient, GoalId, Progress, RequestNumber};
use std::time::Duration;
use tokio::time::{Instant, sleep_until, timeout};

/// Maximum time until the log has the reason why a goal was rejected.
const REASON: Duration = Duration::from_millis(500);
/// Maximum time from a cancel request to the end of its goal.
const STOPPING: Duration = Duration::from_secs(60);

/// Additional time for the answer to a goal, after which it is canceled.
const LATE: Duration = Duration::from_secs(3);
/// Time without feedback after which the result is requested again.
const QUIET: Duration = Duration::from_secs(5);

/// End of a goal.
pub(super) enum Ended<R> {
    /// It was rejected, with the reason.
    Rejected(String),
    /// It was accepted and has ended, with its status, a constant of `GoalStatus`.
    Over { status: i8, result: R },
}

/// Goals of one action.
pub(super) struct Goals<'a, A: Action> {
    session: &'a Session,
    client: ActionClient<A>,
    log: NodeLog,
    stop: Stop,
    /// Name of the action, relative to the node.
    action: &'static str,
    /// Accepted goals.
    accepted: Vec<GoalId>,
    /// Time until which the canceled goals must have ended; `None` if they are not canceled.
    stopping: Option<Instant>,
}

/// An accepted goal.
struct Running {
    index: usize,
    id: GoalId,
    result: RequestNumber,
}

impl<'a, A: Action> Goals<'a, A> {
    /// Waits for the action.
    ///
    /// # Errors
    /// Returns an error if the node has no such action.
    pub(super) async fn open(session: &'a Session, action: &'static str) -> Result<Self, Failure> {
        Self::with_stop(session, action, Stop::listen()?).await
    }

    async fn with_stop(session: &'a Session, action: &'static str, stop: Stop) -> Result<Self, Failure> {
        let client = session.action::<A>(action)?;
        let log = NodeLog::open(session)?;
        session.matched(&client.name().to_string(), || servers(client.servers())).await?;
        Ok(Self { session, client, log, stop, action, accepted: Vec::new(), stopping: None })
    }

    /// Runs the goals to their ends, which are returned in the same order. `show` gets the index of a goal and its
    /// feedback.
    ///
    /// # Errors
    /// Returns an error if the node does not answer or has ended.
    pub(super) async fn run(
        &mut self,
        goals: Vec<A::Goal>,
        mut show: impl FnMut(usize, A::Feedback),
    ) -> Result<Vec<Ended<A::Result>>, Failure> {
        self.log.skip().await;
        let mut running = Vec::new();
        let mut ends: Vec<_> = goals.iter().map(|_| None).collect();
        for (index, goal) in goals.into_iter().enumerate() {
            match self.begin(index, goal).await {
                Ok(Ok(goal)) => running.push(goal),
                Ok(Err(reason)) => ends[index] = Some(Ended::Rejected(reason)),
                Err(failure) => {
                    self.abandon(&running, &mut show).await;
                    return Err(failure);
                }
            }
        }
        for goal in &running {
            let (status, result) = self.end(goal, &running, &mut show).await?;
            ends[goal.index] = Some(Ended::Over { status, result });
        }
        // Each goal was rejected, or has ended.
        Ok(ends.into_iter().flatten().collect())
    }

    /// Cancels the running goals, and waits for their ends.
    async fn abandon(&mut self, running: &[Running], show: &mut impl FnMut(usize, A::Feedback)) {
        if self.stopping.is_none() && self.request_stop().is_err() {
            return;
        }
        for goal in running {
            // The first failure is reported.
            let _ = self.end(goal, running, show).await;
        }
    }

    /// Sends a goal. Returns it if it was accepted, otherwise the reason for the rejection.
    async fn begin(&mut self, index: usize, goal: A::Goal) -> Result<Result<Running, String>, Failure> {
        // After an earlier signal the goal is not sent.
        if self.stopping.is_none() && timeout(Duration::ZERO, self.stop.requested()).await.is_ok() {
            self.request_stop()?;
        }
        if self.stopping.is_some() {
            return Ok(Err("it was not begun, because the command ends".to_owned()));
        }
        let (id, number) = self.client.send_goal(goal).map_err(Failure::failed)?;
        let mut deadline = Instant::now() + self.session.timeout();
        let mut is_late = false;
        let accepted = loop {
            tokio::select! {
                accepted = self.client.accepted(number) => break accepted.map_err(Failure::failed)?,
                // An accepted goal is canceled as soon as that is known.
                () = self.stop.requested() => self.request_stop()?,
                failure = self.session.gone() => return Err(failure),
                () = sleep_until(deadline) => {
                    if is_late {
                        return Err(self.unanswered(id));
                    }
                    // The node may receive the cancel request before the goal; if it accepts the goal later, the goal
                    // is canceled again.
                    self.client.cancel(id).map_err(Failure::failed)?;
                    (is_late, deadline) = (true, deadline + LATE);
                    // The running goals are canceled, too, because the command ends.
                    if self.stopping.is_none() {
                        self.request_stop()?;
                    }
                }
            }
        };
        if !accepted {
            let prefix = format!("{}: goal rejected: ", self.action);
            let reason = self.log.sentence(&prefix, REASON).await;
            let unknown = || "the node rejected the goal; its log shows the reason".to_owned();
            return Ok(Err(reason.unwrap_or_else(unknown)));
        }
        self.accepted.push(id);
        let result = self.client.request_result(id).map_err(Failure::failed)?;
        if self.stopping.is_some() {
            self.client.cancel(id).map_err(Failure::failed)?;
        }
        Ok(Ok(Running { index, id, result }))
    }

    /// Handles a missing answer: cancels the goal, which the node may still receive.
    fn unanswered(&mut self, id: GoalId) -> Failure {
        // If that fails, the message below is still valid.
        let _ = self.client.cancel(id);
        Failure::Failed(format!(
            "{}: no answer within {} s; a cancel was sent, and it is not known whether the goal runs; `lineshaft halt{}` stops all axes",
            self.client.name(),
            (self.session.timeout() + LATE).as_secs_f64(),
            node_option(self.session.target())
        ))
    }

    /// Waits for the end of a goal.
    async fn end(
        &mut self,
        goal: &Running,
        all: &[Running],
        show: &mut impl FnMut(usize, A::Feedback),
    ) -> Result<(i8, A::Result), Failure> {
        let (mut request, mut heard) = (goal.result, Instant::now());
        loop {
            let limit = self.stopping;
            tokio::select! {
                progress = self.client.result_or_feedback(request) => match progress.map_err(Failure::failed)? {
                    Progress::Ended { status: GoalStatus::STATUS_UNKNOWN, .. } => return Err(Failure::Failed(format!(
                        "{}: the node does not know the goal any more: it was started again",
                        self.client.name()
                    ))),
                    Progress::Ended { status, result } => return Ok((status, result)),
                    Progress::Feedback { id, feedback } => {
                        heard = Instant::now();
                        // The topic has feedback of goals of other clients as well.
                        if let Some(goal) = all.iter().find(|goal| goal.id == id) {
                            show(goal.index, feedback);
                        }
                    }
                },
                () = self.stop.requested() => self.request_stop()?,
                failure = self.session.gone() => return Err(failure),
                // The node may have been restarted or have lost the request, so the result is requested again.
                () = sleep_until(heard + QUIET) => {
                    request = self.client.request_result(goal.id).map_err(Failure::failed)?;
                    heard = Instant::now();
                }
                () = until(limit) => return Err(Failure::Failed(format!(
                    "{}: the goal was canceled, but its end is not reported; `lineshaft state` shows what the axis does",
                    self.client.name()
                ))),
            }
        }
    }

    /// Handles a signal: the first one cancels the goals.
    ///
    /// # Errors
    /// Returns an error for the second signal.
    fn request_stop(&mut self) -> Result<(), Failure> {
        if self.stopping.is_some() {
            return Err(Failure::Failed(
                "ended by a second signal; the goals were canceled, but their ends are not known".to_owned(),
            ));
        }
        self.stopping = Some(Instant::now() + STOPPING);
        for id in &self.accepted {
            self.client.cancel(*id).map_err(Failure::failed)?;
        }
        Ok(())
    }
}

/// Returns the number of servers of an action, each with three services.
fn servers(services: [usize; 3]) -> usize {
    match services {
        [goals, results, cancels] if goals == results && results == cancels => goals,
        // Not all of them are matched yet.
        _ => 0,
    }
}

/// Waits until a time; forever if it is `None`.
async fn until(limit: Option<Instant>) {
    match limit {
        Some(limit) => sleep_until(limit).await,
        None => std::future::pending().await,
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_node::{LONG, TestNode};
    use super::*;
    use lineshaft_msgs::action::{HomeAxis, HomeAxisGoal, HomeAxisResult};
    use lineshaft_ros::layer::{ActionEvent, ActionOptions, ActionServer, GoalRequest};

    async fn next(server: &mut ActionServer<HomeAxis>) -> GoalRequest<HomeAxis> {
        match timeout(LONG, server.next()).await.expect("a goal in time") {
            Some(ActionEvent::Goal(request)) => request,
            _ => panic!("no goal"),
        }
    }

    fn goals() -> Vec<HomeAxisGoal> {
        ["x", "y", "z"].map(|axis| HomeAxisGoal { axis: axis.to_owned(), ..HomeAxisGoal::default() }).into()
    }

    /// `home x y z`: y is answered later than the timeout.
    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn late_answer_to_a_goal_cancels_all_goals_of_the_command() {
        let served = TestNode::start("late_goal");
        let mut server = served.node.action::<HomeAxis>("~/home_axis", ActionOptions::default()).unwrap();
        let session = served.session().await;
        let (_signals, stop) = Stop::made();
        let mut command = Goals::<HomeAxis>::with_stop(&session, "home_axis", stop).await.unwrap();
        let node = async {
            let first = next(&mut server).await.accept();
            let second = next(&mut server).await;
            timeout(LONG, first.cancel_requested()).await.expect("the goal that runs is canceled");
            first.canceled(HomeAxisResult::default());
            // The late answer.
            let second = second.accept();
            timeout(LONG, second.cancel_requested()).await.expect("the late goal is canceled");
            second.canceled(HomeAxisResult::default());
        };
        let (ends, ()) = tokio::join!(command.run(goals(), |_, _| {}), node);
        let ends: Vec<_> = ends
            .unwrap()
            .into_iter()
            .map(|end| match end {
                Ended::Over { status, .. } => format!("status {status}"),
                Ended::Rejected(reason) => reason,
            })
            .collect();
        // GoalStatus.msg: STATUS_CANCELED is 5.
        assert_eq!(ends, ["status 5", "status 5", "it was not begun, because the command ends"]);
    }

    /// The node gets a cancel request for each running goal, and no further goal is sent.
    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn signal_cancels_all_goals_and_begins_no_further_one() {
        let served = TestNode::start("signal_goals");
        let mut server = served.node.action::<HomeAxis>("~/home_axis", ActionOptions::default()).unwrap();
        let session = served.session().await;
        let (signals, stop) = Stop::made();
        let mut command = Goals::<HomeAxis>::with_stop(&session, "home_axis", stop).await.unwrap();
        let node = async {
            let first = next(&mut server).await.accept();
            let second = next(&mut server).await;
            signals.send(()).unwrap();
            timeout(LONG, first.cancel_requested()).await.expect("the goal that runs is canceled");
            first.canceled(HomeAxisResult::default());
            let second = second.accept();
            timeout(LONG, second.cancel_requested()).await.expect("the goal that was sent is canceled");
            second.canceled(HomeAxisResult::default());
        };
        let (ends, ()) = tokio::join!(command.run(goals(), |_, _| {}), node);
        let rejected = ends.unwrap().iter().filter(|end| matches!(end, Ended::Rejected(_))).count();
        assert_eq!(rejected, 1);
    }

    #[test]
    fn action_is_there_when_all_of_its_services_are() {
        assert_eq!([[1, 1, 1], [1, 0, 1], [0, 0, 0], [2, 2, 2]].map(servers), [1, 0, 0, 2]);
    }
}

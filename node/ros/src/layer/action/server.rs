//! Action server: one task answers its three services, independently of the application.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use lineshaft_msgs::foreign::action_msgs::msg::{GoalInfo, GoalStatus, GoalStatusArray};
use lineshaft_msgs::foreign::action_msgs::srv::{CancelGoal, CancelGoalResponse};
use lineshaft_msgs::foreign::unique_identifier_msgs::msg::UUID;
use lineshaft_msgs::{Action, FeedbackMessage, GetResult, GetResultResponse, SendGoal, SendGoalResponse, cdr};
use tokio::sync::mpsc::{self, Receiver, Sender};
use tokio::task::JoinHandle;

use super::goals::{End, GoalId, GoalStatusEntry, Goals, ResultAnswer, Stamp};
use super::requests::{CancelRequest, GoalRequest};
use crate::layer::clock::Clock;
use crate::layer::endpoint::Context;
use crate::layer::name::FullName;
use crate::layer::publisher::{PublishError, UntypedPublisher};
use crate::layer::service::{Reply, Request, ServiceServer};
use crate::line_limit::MessageRateLimit;
use crate::link::Writer;
use crate::link::protocol::{EndpointKind, WireType};
use crate::link::qos::Qos;

/// Maximum number of events that wait for the application; above that, goals and cancel requests are rejected.
const WAITING: usize = 256;
/// Time between two checks for expired results.
const TIDY: Duration = Duration::from_secs(1);

/// Decision about cancel requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CancelPolicy {
    /// Each request is accepted at once, and the handle of the goal reports it.
    Accept,
    /// The application decides, with [`ActionEvent::Cancel`].
    Ask,
}

/// Time for which a cancel request waits for goals that its client has sent before it, because the services of an action are read
/// independently. Known goals are canceled at once.
const CANCEL_GRACE_TIME: Duration = Duration::from_millis(20);

/// Options of an action server.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ActionOptions {
    /// Time for which results are kept after the end of their goals. Default 10 s, as in rcl_action.
    pub result_timeout: Duration,
    /// Maximum number of ended goals that are kept; above that, the goal that ended first is removed. Default 256.
    pub kept_goals: usize,
    /// Decision about cancel requests. Default: accept each.
    pub cancels: CancelPolicy,
}

impl Default for ActionOptions {
    fn default() -> Self {
        Self { result_timeout: Duration::from_secs(10), kept_goals: 256, cancels: CancelPolicy::Accept }
    }
}

/// Event for the application of an action server.
pub enum ActionEvent<A: Action> {
    /// Goal of a client.
    Goal(GoalRequest<A>),
    /// Cancel request of a client; only with [`CancelPolicy::Ask`].
    Cancel(CancelRequest<A>),
}

/// Action server; dropping it removes the action from the node. Goals that have not ended remain with their handles.
pub struct ActionServer<A: Action> {
    events: Receiver<ActionEvent<A>>,
    shared: Arc<Shared<A>>,
    task: JoinHandle<()>,
}

impl<A: Action> ActionServer<A> {
    pub(in crate::layer) fn new(context: &Context, name: FullName, options: ActionOptions) -> Self {
        let service = |part: &str| context.names.remapped_service(name.action_part(part));
        let services = Services {
            goals: ServiceServer::new(context, service("send_goal"), Qos::SERVICE),
            results: ServiceServer::new(context, service("get_result"), Qos::SERVICE),
            cancels: ServiceServer::new(context, service("cancel_goal"), Qos::SERVICE),
        };
        let feedback = context.names.remapped_topic(name.action_part("feedback"));
        let feedback = UntypedPublisher::new(context, feedback, WireType::feedback::<A>(), Qos::STREAM);
        let status = context.names.remapped_topic(name.action_part("status"));
        let wire = WireType::message::<GoalStatusArray>();
        let (status, _) = context.open(EndpointKind::Publisher, &status, wire, Qos::STATUS);
        let goals = Mutex::new(Goals::new(options.result_timeout, options.kept_goals));
        let shared = Arc::new(Shared { goals, status, feedback, name, clock: context.clock.clone() });
        let (sender, events) = mpsc::channel(WAITING);
        let request_timeout = context.request_timeout;
        let dispatch = Dispatch {
            shared: shared.clone(),
            events: sender,
            cancels: options.cancels,
            request_timeout,
            refusals: MessageRateLimit::default(),
        };
        let task = context.runtime.spawn(dispatch.run(services));
        Self { events, shared, task }
    }

    /// Returns the full name of the action.
    pub fn name(&self) -> &FullName {
        &self.shared.name
    }

    /// Returns the next event; `None` once the node has ended.
    pub async fn next(&mut self) -> Option<ActionEvent<A>> {
        self.events.recv().await
    }
}

impl<A: Action> Drop for ActionServer<A> {
    fn drop(&mut self) {
        self.task.abort();
    }
}

/// Waiting result request.
type ResultReply<A> = Reply<GetResultResponse<<A as Action>::Result>>;

/// State that the task of the server and the handles of its goals share.
pub(super) struct Shared<A: Action> {
    goals: Mutex<Goals<A::Result, ResultReply<A>>>,
    status: Writer,
    feedback: UntypedPublisher,
    pub(super) name: FullName,
    pub(super) clock: Clock,
}

impl<A: Action> Shared<A> {
    /// A panic in another thread leaves the goals consistent, because each change is one call.
    pub(super) fn goals(&self) -> MutexGuard<'_, Goals<A::Result, ResultReply<A>>> {
        self.goals.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Publishes the status of all goals. They are locked, so that the messages are published in the order of the changes.
    pub(super) fn show(&self, goals: &Goals<A::Result, ResultReply<A>>) {
        let status = |shown: GoalStatusEntry| GoalStatus { goal_info: goal_info(shown), status: shown.status as i8 };
        let status = GoalStatusArray { status_list: goals.shown().map(status).collect() };
        // A latched message is refused only after the node has ended.
        let _ = self.status.write(cdr::encode(&status));
    }

    /// Ends a goal and answers all waiting result requests.
    pub(super) fn end(&self, id: GoalId, end: End, result: A::Result) {
        let mut goals = self.goals();
        let Some((status, waiting)) = goals.end(id, end, result.clone(), Instant::now()) else { return };
        self.show(&goals);
        drop(goals);
        for asker in waiting {
            asker.send_soon(GetResultResponse { status: status as i8, result: result.clone() });
        }
    }

    pub(super) fn feedback(&self, id: GoalId, feedback: &A::Feedback) -> Result<(), PublishError> {
        self.feedback.publish(&FeedbackMessage { goal_id: UUID { uuid: id.0 }, feedback: feedback.clone() })
    }
}

pub(super) fn goal_info(shown: GoalStatusEntry) -> GoalInfo {
    GoalInfo { goal_id: UUID { uuid: shown.id.0 }, stamp: shown.stamp.into() }
}

struct Services<A: Action> {
    goals: ServiceServer<SendGoal<A>>,
    results: ServiceServer<GetResult<A>>,
    cancels: ServiceServer<CancelGoal>,
}

/// Cancel request that waits for goals which its client has sent before it.
struct WaitingCancel {
    due: Instant,
    request: Request<CancelGoal>,
    /// Goals that it has canceled already.
    canceled_early: Vec<GoalStatusEntry>,
}

/// Completes at this time; never for `None`.
async fn until(due: Option<Instant>) {
    match due {
        Some(due) => tokio::time::sleep_until(due.into()).await,
        None => std::future::pending().await,
    }
}

/// Answers requests that do not need the application, and passes on the others. Never waits for the application.
struct Dispatch<A: Action> {
    shared: Arc<Shared<A>>,
    events: Sender<ActionEvent<A>>,
    cancels: CancelPolicy,
    request_timeout: Duration,
    refusals: MessageRateLimit<()>,
}

impl<A: Action> Dispatch<A> {
    async fn run(self, mut services: Services<A>) {
        let mut tidy = tokio::time::interval(TIDY);
        // Cancel requests that may apply to goals which have not arrived yet.
        let mut held: VecDeque<WaitingCancel> = VecDeque::new();
        loop {
            let due = held.front().map(|held| held.due);
            tokio::select! {
                request = services.cancels.next() => match request {
                    Some(request) => {
                        if self.may_be_early(&request.message.goal_info) {
                            self.handle_waiting_goals(&mut services.goals);
                        }
                        if held.len() < WAITING && self.may_be_early(&request.message.goal_info) {
                            let begun = self.begin_cancel(&request);
                            held.push_back(WaitingCancel { due: Instant::now() + CANCEL_GRACE_TIME, request, canceled_early: begun });
                        } else {
                            self.cancel(request, Vec::new());
                        }
                    }
                    None => return,
                },
                () = until(due) => {
                    self.handle_waiting_goals(&mut services.goals);
                    if let Some(WaitingCancel { request, canceled_early: begun, .. }) = held.pop_front() {
                        self.cancel(request, begun);
                    }
                }
                request = services.goals.next() => match request {
                    Some(request) => self.goal(request),
                    None => return,
                },
                request = services.results.next() => match request {
                    Some(Request { message, reply }) => {
                        self.handle_waiting_goals(&mut services.goals);
                        self.result(GoalId(message.goal_id.uuid), reply);
                    }
                    None => return,
                },
                _ = tidy.tick() => self.shared.goals().expire(Instant::now()),
            }
        }
    }

    /// Handles waiting goal requests, because another request may apply to one of them. Limited to one queue length, so that clients with
    /// endless goals cannot delay all other requests.
    fn handle_waiting_goals(&self, goals: &mut ServiceServer<SendGoal<A>>) {
        for _ in 0..WAITING {
            let Some(request) = goals.waiting() else { return };
            self.goal(request);
        }
    }

    /// Returns true if a cancel request may apply to a goal that was sent before it but arrives after it.
    fn may_be_early(&self, GoalInfo { goal_id, stamp }: &GoalInfo) -> bool {
        let id = GoalId(goal_id.uuid);
        if id == GoalId::default() { Stamp::from(stamp) == Stamp::default() } else { !self.shared.goals().knows(id) }
    }

    fn goal(&self, Request { message, reply }: Request<SendGoal<A>>) {
        let id = GoalId(message.goal_id.uuid);
        if let Some(sentence) = reply.origin().refused(Some(self.request_timeout)) {
            self.log_refusal(&format!("goal {id} was rejected: {sentence}"));
            return reply.send_soon(SendGoalResponse::default());
        }
        if !self.shared.goals().offer(id, reply.origin(), Instant::now()) {
            self.log_refusal(&format!("goal {id} was rejected: its id is in use"));
            return reply.send_soon(SendGoalResponse::default());
        }
        self.pass_on(ActionEvent::Goal(GoalRequest::new(self.shared.clone(), id, message.goal, reply)));
    }

    fn result(&self, id: GoalId, asker: ResultReply<A>) {
        match self.shared.goals().request_result(id, asker, Instant::now()) {
            ResultAnswer::Waits => {}
            // Status 0 is "unknown", which is also the default.
            ResultAnswer::Unknown(asker) => asker.send_soon(GetResultResponse::default()),
            ResultAnswer::Ended(asker, status, result) => {
                asker.send_soon(GetResultResponse { status: status as i8, result });
            }
        }
    }

    /// Cancels the known goals at once and returns them, so that a motion does not continue until the request is answered. If the
    /// application decides about cancel requests, it gets one event, later.
    fn begin_cancel(&self, Request { message, reply }: &Request<CancelGoal>) -> Vec<GoalStatusEntry> {
        let origin = reply.origin();
        if self.cancels == CancelPolicy::Ask || origin.refused(None).is_some() {
            return Vec::new();
        }
        let GoalInfo { goal_id, stamp } = &message.goal_info;
        let mut goals = self.shared.goals();
        let selection = goals.select(GoalId(goal_id.uuid), Stamp::from(stamp), origin, Instant::now());
        let canceling = goals.cancel(&selection.open);
        if !canceling.is_empty() {
            self.shared.show(&goals);
        }
        canceling
    }

    /// Executes a cancel request. `begun` are goals that it has canceled already.
    fn cancel(&self, Request { message, reply }: Request<CancelGoal>, begun: Vec<GoalStatusEntry>) {
        // A cancel of all goals is valid only for a limited time.
        if let Some(sentence) = reply.origin().refused(None) {
            self.log_refusal(&format!("a cancel request was refused: {sentence}"));
            return reply.send_soon(CancelGoalResponse {
                return_code: CancelGoalResponse::ERROR_REJECTED,
                ..Default::default()
            });
        }
        let GoalInfo { goal_id, stamp } = message.goal_info;
        let (id, stamp, origin) = (GoalId(goal_id.uuid), Stamp::from(&stamp), reply.origin());
        let selection = self.shared.goals().select(id, stamp, origin, Instant::now());
        if selection.code != CancelGoalResponse::ERROR_NONE {
            return reply.send_soon(CancelGoalResponse { return_code: selection.code, ..Default::default() });
        }
        let request = CancelRequest::new(self.shared.clone(), selection, begun, reply);
        match self.cancels {
            CancelPolicy::Ask if !request.goals().is_empty() => self.pass_on(ActionEvent::Cancel(request)),
            CancelPolicy::Ask | CancelPolicy::Accept => request.accept(),
        }
    }

    fn log_refusal(&self, refusal: &str) {
        self.refusals.log((), |more| tracing::warn!("{}: {refusal}{more}", self.shared.name));
    }

    /// A dropped event rejects its request and reports that.
    fn pass_on(&self, event: ActionEvent<A>) {
        if self.events.try_send(event).is_err() {
            tracing::error!("{}: the application does not take requests any more", self.shared.name);
        }
    }
}

//! Lifecycle state of the node, and the actions of each transition.
//!
//! configure    the backends start and cycles run; the machine is inactive in the first one
//! activate     the machine accepts `activate`
//! deactivate   the machine stops and disables all axes, and reports that every drive is off
//! cleanup      cycles end and the backends stop; the machine keeps its state
//! shutdown     deactivate and cleanup, as far as necessary
//! an error     deactivates and cleans up as far as possible: unconfigured if all drives are off, otherwise finalized

use super::states::{self, Outcome, State, Transition};
use crate::layer::{Publisher, SENT_TO_ROSOUT, Severity};
use crate::surface::host::{GateState, SubmitError};
use crate::surface::hub::Hub;
use lineshaft_core::command::Action;
use lineshaft_core::event::Kind;
use lineshaft_core::text;
use lineshaft_msgs::foreign::lifecycle_msgs::msg::{self, TransitionEvent};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::time::{Instant, sleep, timeout_at};

/// Longer than backends take to start and to stop, and the machine to accept a command.
const PATIENCE: Duration = Duration::from_secs(10);
/// Longer than any axis takes to stop.
const STOP_PATIENCE: Duration = Duration::from_secs(60);
/// Time between two checks of the gate.
const LOOK: Duration = Duration::from_millis(2);
/// Longer than events take from the last cycle to their receivers.
const EVENT_LATENCY: Duration = Duration::from_millis(50);

/// Lifecycle of one node.
pub(in crate::surface) struct NodeLifecycle {
    hub: Arc<Hub>,
    /// Full name of the node, for remedies.
    node: String,
    publisher: Publisher<TransitionEvent>,
    state: Mutex<State>,
    /// Locked during a transition.
    turn: Arc<tokio::sync::Mutex<()>>,
}

/// Transition in progress.
pub(super) struct StartedTransition {
    transition: Transition,
    _turn: tokio::sync::OwnedMutexGuard<()>,
}

impl NodeLifecycle {
    pub(super) fn new(hub: Arc<Hub>, node: String, publisher: Publisher<TransitionEvent>) -> Self {
        let state = Mutex::new(states::UNCONFIGURED);
        Self { hub, node, publisher, state, turn: Arc::default() }
    }

    pub(super) fn state(&self) -> State {
        *self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the present state as a message.
    pub(in crate::surface) fn message(&self) -> msg::State {
        self.state().message()
    }

    /// Returns the name of the present state.
    pub(in crate::surface) fn label(&self) -> &'static str {
        self.state().label
    }

    /// Executes configure and activate at the start: cycles already run, with an active machine.
    pub(super) async fn begin(self: Arc<Self>) {
        let _turn = self.turn.lock().await;
        for (label, work) in [("configure", true), ("activate", false)] {
            let wanted = msg::Transition { id: 0, label: label.to_owned() };
            let Some(transition) = self.state().requested_transition(&wanted) else { return };
            self.step(transition);
            let result = if work { self.wait_for(&GateState::Open).await } else { Ok(()) };
            if result.is_err() {
                self.hub.host.close();
            }
            if self.finish(result.map_err(|sentence| (Outcome::Failure, sentence))).await != Outcome::Success {
                return;
            }
        }
    }

    /// Starts a transition if it is possible and no other one is in progress.
    pub(super) fn begin_change(&self, wanted: &msg::Transition) -> Option<StartedTransition> {
        let Ok(turn) = Arc::clone(&self.turn).try_lock_owned() else {
            self.refuse(wanted, &format!("the node is {}; one transition at a time", self.label()));
            return None;
        };
        let state = self.state();
        let Some(transition) = state.requested_transition(wanted) else {
            let known: Vec<String> = state.transitions().map(|known| format!("{} {}", known.id, known.label)).collect();
            let known = if known.is_empty() { "no transition".to_owned() } else { known.join(", ") };
            self.refuse(wanted, &format!("the node is {}; {known} is possible", state.label));
            return None;
        };
        self.step(transition);
        Some(StartedTransition { transition, _turn: turn })
    }

    /// Executes a transition to its end. Returns true if it succeeded.
    pub(super) async fn end_change(&self, begun: StartedTransition) -> bool {
        let result = match begun.transition.goal {
            states::CONFIGURING => self.configure().await,
            states::ACTIVATING => self.activate().await,
            states::DEACTIVATING => self.deactivate(STOP_PATIENCE).await,
            states::CLEANING_UP => self.clean_up().await,
            _ => self.shut_down(begun.transition.start).await,
        };
        self.finish(result).await == Outcome::Success
    }

    fn refuse(&self, wanted: &msg::Transition, why: &str) {
        let name = if wanted.label.is_empty() { wanted.id.to_string() } else { safe_label(&wanted.label) };
        self.hub.refuse(format!("change_state: transition {name} is refused: {why}"));
    }

    /// Ends a step with its result, and processes an error.
    async fn finish(&self, result: Result<(), (Outcome, String)>) -> Outcome {
        let outcome = self.tell(result);
        if outcome == Outcome::Error {
            self.tell(self.recover().await);
        }
        outcome
    }

    fn tell(&self, result: Result<(), (Outcome, String)>) -> Outcome {
        let state = self.state();
        let outcome = match result {
            Ok(()) => Outcome::Success,
            Err((outcome, sentence)) => {
                let advice = state.after(outcome).and_then(|end| remedy(end.goal, &self.node));
                let line = format!("{}: {sentence}{}", state.label, advice.unwrap_or_default());
                tracing::error!(target: SENT_TO_ROSOUT, "{line}");
                self.hub.say(Severity::Error, &line);
                outcome
            }
        };
        if let Some(end) = state.after(outcome) {
            self.step(end);
        }
        outcome
    }

    fn step(&self, transition: Transition) {
        *self.state.lock().unwrap_or_else(PoisonError::into_inner) = transition.goal;
        let event = TransitionEvent {
            timestamp: self.hub.clock.now_ns(),
            transition: transition.message(),
            start_state: transition.start.message(),
            goal_state: transition.goal.message(),
        };
        tracing::info!("the node is {}", transition.goal.label);
        if let Err(error) = self.publisher.publish(&event) {
            tracing::warn!("{error}");
        }
    }

    async fn configure(&self) -> Result<(), (Outcome, String)> {
        self.hub.host.open();
        let opened = self.wait_for(&GateState::Open).await;
        match opened {
            Ok(()) => self.hub.host.resume_commands(),
            Err(_) => self.hub.host.close(),
        }
        opened.map_err(|sentence| (Outcome::Failure, sentence))
    }

    async fn activate(&self) -> Result<(), (Outcome, String)> {
        let end = Instant::now() + PATIENCE;
        let accepted = self.command(Action::Activate, Kind::Accepted, end).await;
        accepted.map_err(|sentence| (Outcome::Failure, sentence))
    }

    async fn deactivate(&self, patience: Duration) -> Result<(), (Outcome, String)> {
        let end = Instant::now() + patience;
        let done = self.command(Action::Deactivate, Kind::Done, end).await;
        done.map_err(|sentence| (Outcome::Error, format!("not every drive is off: {sentence}")))
    }

    async fn clean_up(&self) -> Result<(), (Outcome, String)> {
        self.hub.host.close();
        let closed = self.wait_for(&GateState::Closed).await;
        sleep(EVENT_LATENCY).await;
        self.hub.end_waiting();
        closed.map_err(|sentence| (Outcome::Error, sentence))
    }

    async fn shut_down(&self, from: State) -> Result<(), (Outcome, String)> {
        if from == states::ACTIVE {
            self.deactivate(STOP_PATIENCE).await?;
        }
        if from == states::UNCONFIGURED { Ok(()) } else { self.clean_up().await }
    }

    async fn recover(&self) -> Result<(), (Outcome, String)> {
        let off = if self.hub.host.gate() == GateState::Open { self.deactivate(PATIENCE).await } else { Ok(()) };
        let closed = self.clean_up().await;
        off.and(closed).map_err(|(_, sentence)| (Outcome::Failure, sentence))
    }

    /// Waits until the gate is in a state.
    async fn wait_for(&self, wanted: &GateState) -> Result<(), String> {
        let begin = Instant::now();
        loop {
            match self.hub.host.gate() {
                state if state == *wanted => return Ok(()),
                GateState::Failed(_) if *wanted == GateState::Closed => return Ok(()),
                GateState::Failed(why) => return Err(why),
                _ if begin.elapsed() > PATIENCE => {
                    let what = if *wanted == GateState::Open { "start" } else { "stop" };
                    return Err(format!("the backends did not {what} within {} s", PATIENCE.as_secs()));
                }
                _ => sleep(LOOK).await,
            }
        }
    }

    /// Submits a command and waits for its answer of a kind.
    async fn command(&self, action: Action, kind: Kind, end: Instant) -> Result<(), String> {
        let late = || "the machine has not answered in time".to_owned();
        let mut answers = loop {
            match self.hub.submit(action.clone()) {
                Ok(answers) => break answers,
                // A full queue empties within a few cycles.
                Err(SubmitError::Full) if Instant::now() < end => sleep(LOOK).await,
                Err(busy) => return Err(busy.to_string()),
            }
        };
        loop {
            let answer = timeout_at(end, answers.next()).await.map_err(|_| late())?;
            let event = answer.ok_or_else(|| "the machine has stopped".to_owned())?.event;
            if event.kind == Kind::Refused || (event.kind == kind && !event.code.is_none()) {
                return Err(text::message(&event, self.hub.host.config()));
            }
            if event.kind == kind {
                return Ok(());
            }
        }
    }
}

/// Returns how to try again after a failed transition that has ended in this state.
fn remedy(end: State, node: &str) -> Option<String> {
    match end {
        states::UNCONFIGURED => Some(format!(
            "; remove the cause, then `lineshaft activate --node {node}`, or `ros2 lifecycle set {node} configure` and \
             `ros2 lifecycle set {node} activate`"
        )),
        states::INACTIVE => Some(format!(
            "; remove the cause, then `lineshaft activate --node {node}`, or `ros2 lifecycle set {node} activate`"
        )),
        states::FINALIZED => Some("; remove the cause, then end the program and start it again".to_owned()),
        _ => None,
    }
}

/// Returns a label from a client in a form that is safe in a message.
fn safe_label(label: &str) -> String {
    format!("`{}`", lineshaft_core::unit::excerpt(label))
}

#[cfg(test)]
mod tests;

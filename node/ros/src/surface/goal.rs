//! Common part of all actions of the machine: from the request to the end of its goal.

use super::host::{Snapshot, SubmitError};
use super::hub::{CommandEvents, Hub};
use super::signals::AxisView;
use super::table::ActionRow;
use crate::layer::{ActionEvent, ActionServer, CreateError, GoalHandle, Node};
use lineshaft_core::code::Code;
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::event::{Event, Kind, Number};
use lineshaft_core::position::Position;
use lineshaft_core::request::RequestError;
use lineshaft_core::signal::axis::AxisSignal;
use lineshaft_core::signal::{Board, Directory};
use lineshaft_core::text;
use std::sync::Arc;
use std::time::Duration;
use tokio::task::JoinSet;
use tokio::time::{Interval, MissedTickBehavior};

/// Time between two feedback messages.
const FEEDBACK: Duration = Duration::from_millis(50);

/// Returns the timer for feedback.
pub(super) fn feedback_ticks() -> Interval {
    let mut ticks = tokio::time::interval(FEEDBACK);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Skip);
    ticks
}

/// Progress of a goal.
#[derive(Clone, Copy)]
pub(super) struct Progress {
    /// Number of its command.
    pub sequence: u64,
    /// Position of the axis at the mark that the goal searched for, if one was found.
    pub mark: Option<Position>,
}

/// End of a goal.
pub(super) struct Ending {
    pub code: Code,
    /// Reason if it did not succeed; otherwise the condition that ended it.
    pub message: String,
    /// Command position at the end.
    pub position: Position,
    /// Position of the axis at the mark that the goal searched for, if one was found.
    pub mark: Option<Position>,
    /// New zero in the old coordinate system, in increments, if the goal has set one.
    pub shift: Option<i64>,
}

/// Signals of a goal's object on the board.
pub(super) trait View: Clone + Send + Sync + 'static {
    /// Returns the views of all objects of this kind, by index.
    fn all(config: &MachineConfig, directory: &Directory) -> Vec<Self>;

    /// Returns the command position.
    fn position(&self, board: &Board) -> Position;
}

impl View for AxisView {
    fn all(config: &MachineConfig, directory: &Directory) -> Vec<Self> {
        Self::all(config, directory)
    }

    fn position(&self, board: &Board) -> Position {
        Position::whole(self.int(board, AxisSignal::CommandPosition))
    }
}

/// Action of the interface for one object, with its specific functions.
pub(super) trait GoalAction: lineshaft_msgs::Action + Sized {
    /// View of the object.
    type View: View;

    /// Row of the interface table.
    const SERVED_AS: ActionRow<Self>;

    /// Returns the index of the object, and the command for a goal.
    fn resolve(config: &MachineConfig, goal: &Self::Goal) -> Result<(u16, Action), RequestError>;

    /// Returns feedback from the signals, if there is any.
    fn feedback(
        view: &Self::View,
        snapshot: &Snapshot,
        goal: &Self::Goal,
        progress: Progress,
    ) -> Option<Self::Feedback>;

    /// Returns the result of a goal.
    fn result(view: &Self::View, ending: Ending) -> Self::Result;
}

/// Starts the server of one action.
pub(super) fn start<A: GoalAction>(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let server = A::SERVED_AS.server(node)?;
    tasks.spawn(serve(server, Arc::clone(hub)));
    Ok(())
}

async fn serve<A: GoalAction>(mut server: ActionServer<A>, hub: Arc<Hub>) {
    let views = A::View::all(hub.host.config(), hub.host.directory());
    // Running goals end with the action.
    let mut open = JoinSet::new();
    while let Some(event) = server.next().await {
        while open.try_join_next().is_some() {}
        let ActionEvent::Goal(request) = event else { continue };
        match A::resolve(hub.host.config(), request.goal()) {
            Ok((place, command)) => {
                // Every resolved object has a view; without one the goal could not be monitored, and is not started.
                let Some(view) = views.get(usize::from(place)) else { continue };
                // Submitted here in sequence, so that of two goals for one object the later one is executed later.
                let handle = request.accept();
                let given = hub.submit(command);
                open.spawn(run(Arc::clone(&hub), handle, given, view.clone()));
            }
            Err(error) => {
                hub.refuse(format!("{}: goal rejected: {error}", A::SERVED_AS.0.name.trim_start_matches("~/")));
                request.reject();
            }
        }
    }
}

/// Executes an accepted goal until it ends.
async fn run<A: GoalAction>(
    hub: Arc<Hub>,
    handle: GoalHandle<A>,
    given: Result<CommandEvents, SubmitError>,
    view: A::View,
) {
    let ending = match given {
        Ok(answers) => follow(&hub, &handle, answers, &view).await,
        Err(busy) => ending_without_answer(&view, &hub.host.snapshot(), busy.code(), busy.to_string()),
    };
    let code = ending.code;
    let result = A::result(&view, ending);
    match code {
        code if code.succeeds() => handle.succeed(result),
        Code::CANCELLED if handle.is_cancel_requested() => handle.canceled(result),
        _ => handle.abort(result),
    }
}

async fn follow<A: GoalAction>(
    hub: &Arc<Hub>,
    handle: &GoalHandle<A>,
    mut answers: CommandEvents,
    view: &A::View,
) -> Ending {
    let mut ticks = feedback_ticks();
    let goal = answers.sequence;
    let (mut accepted, mut cancelled) = (false, false);
    let mut mark = None;
    loop {
        tokio::select! {
            answer = answers.next() => match answer {
                Some(answer) => match answer.event.kind {
                    Kind::Accepted => {
                        accepted = true;
                        handle.execute();
                    }
                    Kind::Mark => mark = Some(answer.event.position),
                    Kind::Refused | Kind::Done => return Ending { mark, ..ending(hub, &answer.event) },
                    _ => {}
                },
                None => {
                    let message = "the machine has stopped".to_owned();
                    return ending_without_answer(view, &hub.host.snapshot(), Code::DISABLED, message);
                }
            },
            () = handle.cancel_requested(), if !cancelled => {
                cancelled = hub.submit_without_answer(Action::Cancel { goal }).is_ok();
                if !cancelled {
                    // The command queue is full; tried again a little later.
                    ticks.tick().await;
                }
            }
            // Before that, the signals do not belong to this goal yet.
            _ = ticks.tick(), if accepted => {
                if let Some(feedback) = A::feedback(view, &hub.host.snapshot(), handle.goal(), Progress { sequence: goal, mark }) {
                    // Feedback that a client does not read is dropped.
                    let _ = handle.feedback(&feedback);
                }
            }
        }
    }
}

/// Returns the new zero in the old coordinate system, which the end of homing reports.
fn new_zero(event: &Event) -> Option<i64> {
    match event.asked {
        Number::Position(shift) if event.kind == Kind::Done && event.code.is_none() => Some(shift),
        _ => None,
    }
}

fn ending(hub: &Hub, event: &Event) -> Ending {
    let message = if event.code.is_none() { String::new() } else { text::message(event, hub.host.config()) };
    Ending { code: event.code, message, position: event.position, mark: None, shift: new_zero(event) }
}

/// Returns the end of a goal without an answer of the machine, with the present position of its object.
fn ending_without_answer(view: &impl View, snapshot: &Snapshot, code: Code, message: String) -> Ending {
    Ending { code, message, position: view.position(&snapshot.board), mark: None, shift: None }
}

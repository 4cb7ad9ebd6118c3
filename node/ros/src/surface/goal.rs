//! What all actions of the machine have in common: from the request to the end of its goal.

use super::host::{Busy, Snapshot};
use super::hub::{Answers, Hub};
use super::signals::AxisView;
use super::table::Acted;
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

/// Between two feedback messages.
const FEEDBACK: Duration = Duration::from_millis(50);

/// The moments of feedback.
pub(super) fn feedback_ticks() -> Interval {
    let mut ticks = tokio::time::interval(FEEDBACK);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Skip);
    ticks
}

/// How far a goal has come.
#[derive(Clone, Copy)]
pub(super) struct Progress {
    /// Number of its command.
    pub sequence: u64,
    /// Position of the axis at the mark that the goal searched for, where it found one.
    pub mark: Option<Position>,
}

/// How a goal ended.
pub(super) struct Ending {
    pub code: Code,
    /// Why, where it did not succeed, or by what it was ended that has.
    pub message: String,
    /// Command position at the end.
    pub position: Position,
    /// Position of the axis at the mark that the goal searched for, where it found one.
    pub mark: Option<Position>,
    /// The new zero in the old coordinate (inc), where the goal gave the axis one.
    pub shift: Option<i64>,
}

/// Where what a goal is about stands on the board.
pub(super) trait View: Clone + Send + Sync + 'static {
    /// Those of all objects of its kind, by their places.
    fn all(config: &MachineConfig, directory: &Directory) -> Vec<Self>;

    /// Where it is commanded to be.
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

/// An action of the interface that is about one object, with what is its own.
pub(super) trait GoalAction: lineshaft_msgs::Action + Sized {
    /// How it sees its object.
    type View: View;

    /// Its row of the table.
    const SERVED_AS: Acted<Self>;

    /// The place of the object, and the command that a goal asks for.
    fn resolve(config: &MachineConfig, goal: &Self::Goal) -> Result<(u16, Action), RequestError>;

    /// Feedback from its signals, where there is something to tell.
    fn feedback(
        view: &Self::View,
        snapshot: &Snapshot,
        goal: &Self::Goal,
        progress: Progress,
    ) -> Option<Self::Feedback>;

    /// The result of a goal.
    fn result(view: &Self::View, ending: Ending) -> Self::Result;
}

/// Serves one action.
pub(super) fn start<A: GoalAction>(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let server = A::SERVED_AS.server(node)?;
    tasks.spawn(serve(server, Arc::clone(hub)));
    Ok(())
}

async fn serve<A: GoalAction>(mut server: ActionServer<A>, hub: Arc<Hub>) {
    let views = A::View::all(hub.host.config(), hub.host.directory());
    // Goals that run end with the action.
    let mut open = JoinSet::new();
    while let Some(event) = server.next().await {
        while open.try_join_next().is_some() {}
        let ActionEvent::Goal(request) = event else { continue };
        match A::resolve(hub.host.config(), request.goal()) {
            Ok((place, command)) => {
                // Every object that resolves has a view; without one the goal could not be watched, and is not begun.
                let Some(view) = views.get(usize::from(place)) else { continue };
                // Handed over here, one after the other: of two goals for one object the later one is the later one.
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

/// Works on an accepted goal until it ends.
async fn run<A: GoalAction>(hub: Arc<Hub>, handle: GoalHandle<A>, given: Result<Answers, Busy>, view: A::View) {
    let ending = match given {
        Ok(answers) => follow(&hub, &handle, answers, &view).await,
        Err(busy) => stands(&view, &hub.host.snapshot(), busy.code(), busy.to_string()),
    };
    let code = ending.code;
    let result = A::result(&view, ending);
    match code {
        code if code.succeeds() => handle.succeed(result),
        Code::CANCELLED if handle.is_cancel_requested() => handle.canceled(result),
        _ => handle.abort(result),
    }
}

async fn follow<A: GoalAction>(hub: &Arc<Hub>, handle: &GoalHandle<A>, mut answers: Answers, view: &A::View) -> Ending {
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
                    return stands(view, &hub.host.snapshot(), Code::DISABLED, message);
                }
            },
            () = handle.cancel_requested(), if !cancelled => {
                cancelled = hub.submit_unheard(Action::Cancel { goal }).is_ok();
                if !cancelled {
                    // The lane is full: again a little later.
                    ticks.tick().await;
                }
            }
            // Before that the signals are not yet of this goal.
            _ = ticks.tick(), if accepted => {
                if let Some(feedback) = A::feedback(view, &hub.host.snapshot(), handle.goal(), Progress { sequence: goal, mark }) {
                    // A client that does not read feedback is its own matter.
                    let _ = handle.feedback(&feedback);
                }
            }
        }
    }
}

/// The new zero in the old coordinate, which the end of homing tells.
fn new_zero(event: &Event) -> Option<i64> {
    match event.asked {
        Number::Position(shift) if event.kind == Kind::Done && event.code.is_none() => Some(shift),
        _ => None,
    }
}

fn ending(hub: &Hub, event: &Event) -> Ending {
    let message = if event.code.is_none() { String::new() } else { text::sentence(event, hub.host.config()) };
    Ending { code: event.code, message, position: event.position, mark: None, shift: new_zero(event) }
}

/// The end of a goal that the machine has not answered: where its object stands now.
fn stands(view: &impl View, snapshot: &Snapshot, code: Code, message: String) -> Ending {
    Ending { code, message, position: view.position(&snapshot.board), mark: None, shift: None }
}

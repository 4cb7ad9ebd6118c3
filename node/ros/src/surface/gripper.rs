//! `~/<group>/gripper_cmd` and `~/<group>/parallel_gripper_cmd`, for groups with one axis that are grippers.
//!
//! Law      a goal is an absolute move of the axis. If the gripper has been commanded to its target and does not move for [`STALL_TIMEOUT`]
//!          without reaching it, it has stalled: the goal ends, and the axis continues to hold its target
//! Refuses  all goals of an inactive group; a maximum effort, because axes cannot limit it; another joint, lists with other than one
//!          number, numbers that are not finite
//! Source   gripper_action_controller and parallel_gripper_controller of ros2_controllers (Jazzy)

use super::controllers::Controllers;
use super::group::Group;
use super::hub::{CommandEvents, Hub};
use super::joint_names::with_joint;
use super::signals::AxisView;
use super::table::{self, ActionRow};
use crate::layer::{ActionEvent, ActionServer, CreateError, GoalHandle, Node};
use lineshaft_core::code::Code;
use lineshaft_core::command::{Action, Move, MoveMode};
use lineshaft_core::config::AxisConfig;
use lineshaft_core::event::Kind;
use lineshaft_core::object::Object;
use lineshaft_core::parameter::AxisParameters;
use lineshaft_core::position::Length;
use lineshaft_core::request::{Amount, MoveRequest, Rates, Units};
use lineshaft_core::signal::Board;
use lineshaft_core::signal::axis::AxisSignal;
use lineshaft_core::text;
use lineshaft_msgs::foreign::control_msgs::action::{
    GripperCommand, GripperCommandFeedback, GripperCommandGoal, GripperCommandResult, ParallelGripperCommand,
    ParallelGripperCommandFeedback, ParallelGripperCommandGoal, ParallelGripperCommandResult,
};
use lineshaft_msgs::foreign::sensor_msgs::msg::JointState;
use std::sync::Arc;
use std::time::Duration;
use tokio::task::JoinSet;
use tokio::time::{Instant, Interval, MissedTickBehavior};

/// Distance to the target (m, rad) at which the gripper has reached it, regardless of in_position_window. With a window of 0 the command
/// position alone would count, which reaches the target even if the gripper holds an object.
const GOAL_TOLERANCE: f64 = 0.001;
/// Velocity below which a gripper counts as at rest (m/s, rad/s), and time after which it has stalled: values of the ROS controllers.
const STALL_VELOCITY: f64 = 0.001;
const STALL_TIMEOUT: Duration = Duration::from_secs(1);
/// Distance by which a target may exceed a position limit (m, rad): clients round limits to six decimals.
const ROUNDING: f64 = 1e-6;
/// Time between two checks, and between two feedback messages.
const PERIOD: Duration = Duration::from_millis(50);

/// Axis of a gripper.
#[derive(Clone)]
struct Gripper {
    /// Object name of the axis, and its joint name.
    axis: String,
    joint: String,
    view: AxisView,
    /// Whether a goal that ends because the gripper has stalled has succeeded.
    allows_stalling: bool,
    controllers: Arc<Controllers>,
    /// Index of its group among the controllers.
    place: usize,
}

/// Target of a goal (m or rad, and per s); velocity 0 means the default.
#[derive(Clone, Copy, Debug, PartialEq)]
struct GripperTarget {
    position: f64,
    velocity: f64,
    effort: f64,
}

/// State of a gripper.
struct GripperState {
    position: f64,
    velocity: f64,
    effort: f64,
    stalled: bool,
    reached: bool,
}

/// One of the two action types.
trait GripperAction: lineshaft_msgs::Action + Sized {
    const SERVED_AS: ActionRow<Self>;

    /// Returns the target of a goal.
    ///
    /// # Errors
    /// The goal is invalid; with a message.
    fn wish(joint: &str, goal: &Self::Goal) -> Result<GripperTarget, String>;

    fn result(joint: &str, found: &GripperState) -> Self::Result;

    fn feedback(joint: &str, found: &GripperState) -> Self::Feedback;
}

impl GripperAction for GripperCommand {
    const SERVED_AS: ActionRow<Self> = table::GRIPPER_CMD;

    fn wish(_joint: &str, goal: &GripperCommandGoal) -> Result<GripperTarget, String> {
        Ok(GripperTarget { position: goal.command.position, velocity: 0.0, effort: goal.command.max_effort })
    }

    fn result(_joint: &str, found: &GripperState) -> GripperCommandResult {
        let GripperState { position, effort, stalled, reached, .. } = *found;
        GripperCommandResult { position, effort, stalled, reached_goal: reached }
    }

    fn feedback(_joint: &str, found: &GripperState) -> GripperCommandFeedback {
        let GripperState { position, effort, stalled, reached, .. } = *found;
        GripperCommandFeedback { position, effort, stalled, reached_goal: reached }
    }
}

impl GripperAction for ParallelGripperCommand {
    const SERVED_AS: ActionRow<Self> = table::PARALLEL_GRIPPER_CMD;

    fn wish(joint: &str, goal: &ParallelGripperCommandGoal) -> Result<GripperTarget, String> {
        let JointState { name, position, velocity, effort, .. } = &goal.command;
        if !name.is_empty() && *name != [joint] {
            return Err(format!("command.name is {name:?}; `{joint}` or none is expected"));
        }
        let one = |field: &str, list: &[f64], is_optional: bool| match list {
            [number] => Ok(*number),
            [] if is_optional => Ok(0.0),
            list => {
                let or_none = if is_optional { " or none" } else { "" };
                Err(format!("command.{field} has {} numbers; one{or_none} is expected", list.len()))
            }
        };
        Ok(GripperTarget {
            position: one("position", position, false)?,
            velocity: one("velocity", velocity, true)?,
            effort: one("effort", effort, true)?,
        })
    }

    fn result(joint: &str, found: &GripperState) -> ParallelGripperCommandResult {
        let GripperState { stalled, reached, .. } = *found;
        ParallelGripperCommandResult { state: state(joint, found), stalled, reached_goal: reached }
    }

    fn feedback(joint: &str, found: &GripperState) -> ParallelGripperCommandFeedback {
        ParallelGripperCommandFeedback { state: state(joint, found) }
    }
}

fn state(joint: &str, found: &GripperState) -> JointState {
    JointState {
        name: vec![joint.to_owned()],
        position: vec![found.position],
        velocity: vec![found.velocity],
        effort: vec![found.effort],
        ..JointState::default()
    }
}

impl Gripper {
    /// Returns the state for a goal to `target` (m, rad).
    fn state_for(&self, board: &Board, target: f64, stalled: bool) -> GripperState {
        let view = &self.view;
        let position = view.si(view.int(board, AxisSignal::ActualPosition), 0.0);
        GripperState {
            position,
            velocity: view.rate(board, AxisSignal::ActualVelocity),
            effort: view.effort(board),
            stalled,
            reached: (position - target).abs() <= GOAL_TOLERANCE,
        }
    }

    /// Returns the command for a goal.
    fn command(&self, hub: &Hub, wish: &GripperTarget) -> Result<Action, String> {
        self.controllers.check(self.place)?;
        if wish.effort != 0.0 {
            return Err(format!(
                "the largest effort is {}; 0 is expected, as the axis has no limit of effort",
                wish.effort
            ));
        }
        let request = MoveRequest {
            axis: self.axis.clone(),
            mode: MoveMode::Absolute as u8,
            units: Units::Si,
            position: Amount::Number(wish.position),
            rates: Rates::numbers([wish.velocity, 0.0, 0.0, 0.0]),
            buffer_mode: 0,
            direction: 0,
        };
        let config = hub.host.config();
        let command = config.resolve_move(&request).map_err(|error| error.to_string())?;
        let (place, image) = (usize::from(command.axis), hub.host.parameters());
        Ok(Action::Move(match config.axes.get(place).zip(image.effective.get(place)) {
            Some((axis, parameters)) => snapped_to_limit(command, axis, parameters),
            None => command,
        }))
    }
}

/// Returns the move with its target on the position limit if it exceeds the limit by at most [`ROUNDING`].
fn snapped_to_limit(command: Move, axis: &AxisConfig, parameters: &AxisParameters) -> Move {
    let per_increment = axis.scale.rate_to_si(1.0).abs();
    let is_near = |beyond: i64| beyond > 0 && beyond as f64 * per_increment <= ROUNDING;
    let target = command.target.nearest;
    let high = parameters.max_position.filter(|high| is_near(target.saturating_sub(*high)));
    let low = parameters.min_position.filter(|low| is_near(low.saturating_sub(target)));
    high.or(low).map_or(command, |limit| Move { target: Length::whole(limit), ..command })
}

/// Creates both actions for each group that is a gripper.
pub(super) fn start(
    node: &Node,
    hub: &Arc<Hub>,
    groups: &[Group],
    controllers: &Arc<Controllers>,
    tasks: &mut JoinSet<()>,
) -> Result<(), CreateError> {
    let views = AxisView::all(hub.host.config(), hub.host.directory());
    for (place, group) in groups.iter().enumerate() {
        let (Some(settings), &[axis]) = (group.gripper, group.axes.as_slice()) else { continue };
        let Some(view) = views.get(usize::from(axis)) else { continue };
        let gripper = Gripper {
            axis: hub.host.config().name(Object::Axis(axis)).to_owned(),
            joint: hub.host.joint_names().get(axis).to_owned(),
            view: view.clone(),
            allows_stalling: settings.allow_stalling,
            controllers: Arc::clone(controllers),
            place,
        };
        open::<GripperCommand>(node, hub, &group.name, &gripper, tasks)?;
        open::<ParallelGripperCommand>(node, hub, &group.name, &gripper, tasks)?;
    }
    Ok(())
}

fn open<A: GripperAction>(
    node: &Node,
    hub: &Arc<Hub>,
    group: &str,
    gripper: &Gripper,
    tasks: &mut JoinSet<()>,
) -> Result<(), CreateError> {
    let server = A::SERVED_AS.server_as(node, &A::SERVED_AS.0.name.replacen("~/", &format!("~/{group}/"), 1))?;
    tasks.spawn(serve(server, Arc::clone(hub), gripper.clone()));
    Ok(())
}

async fn serve<A: GripperAction>(mut server: ActionServer<A>, hub: Arc<Hub>, gripper: Gripper) {
    let name = server.name().to_string();
    // Running goals end with the action.
    let mut open = JoinSet::new();
    while let Some(event) = server.next().await {
        while open.try_join_next().is_some() {}
        let ActionEvent::Goal(request) = event else { continue };
        let wish = A::wish(&gripper.joint, request.goal());
        let read = wish.and_then(|wish| Ok((wish.position, gripper.command(&hub, &wish)?)));
        match read {
            Ok((target, command)) => {
                let handle = request.accept();
                match hub.submit(command) {
                    Ok(answers) => {
                        open.spawn(run(Arc::clone(&hub), handle, answers, gripper.clone(), (name.clone(), target)));
                    }
                    Err(busy) => {
                        hub.refuse(format!("{name}: {busy}"));
                        let found = gripper.state_for(&hub.host.snapshot().board, target, false);
                        handle.abort(A::result(&gripper.joint, &found));
                    }
                }
            }
            Err(sentence) => {
                hub.refuse(format!("{name}: goal rejected: {sentence}"));
                request.reject();
            }
        }
    }
}

/// Executes an accepted goal of the action with this name until it ends. The result has no field for a message: the reason of the end is on
/// `/rosout` and in `~/events`.
async fn run<A: GripperAction>(
    hub: Arc<Hub>,
    handle: GoalHandle<A>,
    mut answers: CommandEvents,
    gripper: Gripper,
    (name, target): (String, f64),
) {
    let mut ticks = tokio::time::interval(PERIOD);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Skip);
    let goal = answers.sequence;
    // Whether the machine has accepted the move, and whether it has ended it successfully, with the command position at the target.
    let (mut accepted, mut arrived, mut cancelled) = (false, false, false);
    let (mut still_since, mut stalled) = (None::<Instant>, false);
    let code = loop {
        tokio::select! {
            answer = answers.next(), if !arrived => match answer.map(|answer| answer.event) {
                Some(event) if event.kind == Kind::Accepted => {
                    accepted = true;
                    handle.execute();
                }
                Some(event) if event.kind == Kind::Done && event.code.is_none() => arrived = true,
                Some(event) if matches!(event.kind, Kind::Refused | Kind::Done) => {
                    let is_wanted = stalled || event.code == Code::CANCELLED && handle.is_cancel_requested();
                    if !is_wanted {
                        let sentence = text::message(&event, hub.host.config());
                        let sentence = with_joint(sentence, &gripper.axis, &gripper.joint);
                        hub.refuse(format!("{name}: goal aborted: {sentence}"));
                    }
                    break event.code;
                }
                Some(_) => {}
                None => break Code::DISABLED,
            },
            () = handle.cancel_requested(), if !cancelled => {
                if arrived {
                    break Code::CANCELLED;
                }
                cancelled = cancel(&hub, goal, &mut ticks).await;
            }
            // Before that, the signals do not belong to this goal yet.
            _ = ticks.tick(), if accepted => {
                let snapshot = hub.host.snapshot();
                let found = gripper.state_for(&snapshot.board, target, stalled);
                // Feedback that a client does not read is dropped.
                let _ = handle.feedback(&A::feedback(&gripper.joint, &found));
                if arrived && found.reached {
                    break Code::NONE;
                }
                let at_target = gripper.view.to_go(&snapshot.board) == 0;
                let is_still = at_target && !found.reached && found.velocity.abs() < STALL_VELOCITY;
                still_since = if is_still { still_since.or(Some(Instant::now())) } else { None };
                if !stalled && still_since.is_some_and(|since| since.elapsed() >= STALL_TIMEOUT) {
                    stalled = arrived || cancel(&hub, goal, &mut ticks).await;
                }
                if stalled && arrived {
                    break Code::CANCELLED;
                }
            }
        }
    };
    let result = A::result(&gripper.joint, &gripper.state_for(&hub.host.snapshot().board, target, stalled));
    match code {
        code if code.succeeds() => handle.succeed(result),
        Code::CANCELLED if handle.is_cancel_requested() => handle.canceled(result),
        Code::CANCELLED if stalled && gripper.allows_stalling => handle.succeed(result),
        _ => handle.abort(result),
    }
}

/// Cancels a goal of the machine; returns false if the command queue is full, after a short pause.
async fn cancel(hub: &Hub, goal: u64, ticks: &mut Interval) -> bool {
    let is_given = hub.submit_without_answer(Action::Cancel { goal }).is_ok();
    if !is_given {
        ticks.tick().await;
    }
    is_given
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_core::config::MachineConfig;
    use lineshaft_core::unit::{Fraction, Quantity, Scale, Unit};
    use lineshaft_msgs::foreign::control_msgs::msg;

    /// 10,000,000 inc/m: 1e-6 m are 10 inc. Limits at 0 and 0.05 m.
    #[test]
    fn a_target_that_was_rounded_beyond_a_limit_is_on_it() {
        let per = Quantity::new(Fraction::from_integer(1), Unit::MILLIMETRE);
        let scale = Scale::new(Fraction::from_integer(10_000), per).expect("a sound scale");
        let mut parameters = AxisParameters::new(1e6, 1e7);
        (parameters.min_position, parameters.max_position) = (Some(0), Some(500_000));
        let config = MachineConfig {
            cycle_ns: 1_000_000,
            axes: vec![AxisConfig::new("finger".to_owned(), scale, None, parameters)],
            ..MachineConfig::default()
        };
        for (position, target) in
            [(0.050_000_9, 500_000), (0.050_001_1, 500_011), (-0.000_000_9, 0), (-0.000_001_1, -11), (0.03, 300_000)]
        {
            let request = MoveRequest {
                axis: "finger".to_owned(),
                mode: MoveMode::Absolute as u8,
                position: Amount::Number(position),
                ..MoveRequest::default()
            };
            let command = config.resolve_move(&request).expect("a sound request");
            assert_eq!(snapped_to_limit(command, &config.axes[0], &parameters).target.nearest, target, "{position}");
        }
    }

    #[test]
    fn goals_of_both_types_ask_for_a_position() {
        let goal = GripperCommandGoal { command: msg::GripperCommand { position: 0.02, max_effort: 5.0 } };
        assert_eq!(
            GripperCommand::wish("finger", &goal),
            Ok(GripperTarget { position: 0.02, velocity: 0.0, effort: 5.0 })
        );
        let of = |name: &[&str], position: &[f64], velocity: &[f64], effort: &[f64]| {
            let command = JointState {
                name: name.iter().map(|name| (*name).to_owned()).collect(),
                position: position.to_vec(),
                velocity: velocity.to_vec(),
                effort: effort.to_vec(),
                ..JointState::default()
            };
            ParallelGripperCommand::wish("finger", &ParallelGripperCommandGoal { command })
        };
        assert_eq!(of(&[], &[0.02], &[], &[]), Ok(GripperTarget { position: 0.02, velocity: 0.0, effort: 0.0 }));
        assert_eq!(
            of(&["finger"], &[0.02], &[0.1], &[3.0]),
            Ok(GripperTarget { position: 0.02, velocity: 0.1, effort: 3.0 })
        );
        let refused = |wish: Result<GripperTarget, String>, sentence: &str| assert_eq!(wish.unwrap_err(), sentence);
        refused(of(&["thumb"], &[0.02], &[], &[]), "command.name is [\"thumb\"]; `finger` or none is expected");
        refused(of(&[], &[], &[], &[]), "command.position has 0 numbers; one is expected");
        refused(of(&[], &[0.0], &[0.1, 0.2], &[]), "command.velocity has 2 numbers; one or none is expected");
    }
}

//! `~/move_axis`: moves one axis.

use super::goal::{Ending, GoalAction, Progress};
use super::host::Snapshot;
use super::signals::AxisView;
use super::table::{self, ActionRow};
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::request::{Amount, MoveRequest, Rates, RequestError, Units};
use lineshaft_core::signal::axis::AxisSignal;
use lineshaft_msgs::action::{MoveAxis, MoveAxisFeedback, MoveAxisGoal, MoveAxisResult};

impl GoalAction for MoveAxis {
    type View = AxisView;

    const SERVED_AS: ActionRow<Self> = table::MOVE_AXIS;

    fn resolve(config: &MachineConfig, goal: &MoveAxisGoal) -> Result<(u16, Action), RequestError> {
        let request = config.resolve_move(&MoveRequest {
            axis: goal.axis.clone(),
            mode: goal.mode,
            units: Units::from_number(goal.units)?,
            position: Amount::Number(goal.position),
            rates: Rates::numbers([goal.velocity, goal.acceleration, goal.deceleration, goal.jerk]),
            buffer_mode: goal.buffer_mode,
            direction: goal.direction,
        })?;
        Ok((request.axis, Action::Move(request)))
    }

    fn feedback(
        view: &AxisView,
        snapshot: &Snapshot,
        _goal: &MoveAxisGoal,
        _progress: Progress,
    ) -> Option<MoveAxisFeedback> {
        let position = view.int(&snapshot.board, AxisSignal::ActualPosition);
        Some(MoveAxisFeedback {
            position: view.si(position, 0.0),
            velocity: view.rate(&snapshot.board, AxisSignal::ActualVelocity),
            distance_to_go: view.si(view.to_go(&snapshot.board), 0.0),
            position_increments: position,
        })
    }

    fn result(view: &AxisView, ending: Ending) -> MoveAxisResult {
        let Ending { code, message, position, .. } = ending;
        let increments = position.floor();
        let si = view.si(increments, position.fraction());
        MoveAxisResult { code: code.0, message, position: si, position_increments: increments }
    }
}

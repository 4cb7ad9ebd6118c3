//! `~/probe_axis`: moves an axis to a touch probe edge.

use super::goal::{Ending, GoalAction, Progress};
use super::host::Snapshot;
use super::signals::AxisView;
use super::table::{self, ActionRow};
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::position::Position;
use lineshaft_core::request::{Amount, MoveRequest, ProbeRequest, Rates, RequestError, Units};
use lineshaft_core::signal::axis::AxisSignal;
use lineshaft_msgs::action::{ProbeAxis, ProbeAxisFeedback, ProbeAxisGoal, ProbeAxisResult};

impl GoalAction for ProbeAxis {
    type View = AxisView;

    const SERVED_AS: ActionRow<Self> = table::PROBE_AXIS;

    fn resolve(config: &MachineConfig, goal: &ProbeAxisGoal) -> Result<(u16, Action), RequestError> {
        let request = config.resolve_probe(&ProbeRequest {
            search: MoveRequest {
                axis: goal.axis.clone(),
                mode: goal.mode,
                units: Units::from_number(goal.units)?,
                position: Amount::Number(goal.position),
                rates: Rates::numbers([goal.velocity, goal.acceleration, goal.deceleration, goal.jerk]),
                ..MoveRequest::default()
            },
            event: goal.event.clone(),
            edge: goal.edge,
            distance: Amount::Number(goal.distance),
        })?;
        Ok((request.axis, Action::Probe(request)))
    }

    fn feedback(
        view: &AxisView,
        snapshot: &Snapshot,
        _goal: &ProbeAxisGoal,
        progress: Progress,
    ) -> Option<ProbeAxisFeedback> {
        Some(ProbeAxisFeedback {
            phase: if progress.mark.is_some() { ProbeAxisFeedback::PROBED } else { ProbeAxisFeedback::SEARCHING },
            position: view.si(view.int(&snapshot.board, AxisSignal::ActualPosition), 0.0),
            velocity: view.rate(&snapshot.board, AxisSignal::ActualVelocity),
            distance_to_go: view.si(view.to_go(&snapshot.board), 0.0),
        })
    }

    fn result(view: &AxisView, ending: Ending) -> ProbeAxisResult {
        let Ending { code, message, position, mark, .. } = ending;
        let si = |position: Position| view.si(position.floor(), position.fraction());
        ProbeAxisResult {
            code: code.0,
            message,
            probed: mark.is_some(),
            probed_position: mark.map_or(0.0, si),
            probed_increments: mark.map_or(0, Position::floor),
            position: si(position),
            position_increments: position.floor(),
        }
    }
}

//! `~/phase`: shifts the phase of an axis against its master.

use super::goal::{Ending, GoalAction, Progress};
use super::host::Snapshot;
use super::signals::AxisView;
use super::table::{self, ActionRow};
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::request::{Amount, PhaseRequest, RequestError};
use lineshaft_core::signal::axis::AxisSignal;
use lineshaft_msgs::action::{Phase, PhaseFeedback, PhaseGoal, PhaseResult};

impl GoalAction for Phase {
    type View = AxisView;

    const SERVED_AS: ActionRow<Self> = table::PHASE;

    fn resolve(config: &MachineConfig, goal: &PhaseGoal) -> Result<(u16, Action), RequestError> {
        let request = config.resolve_phase(&PhaseRequest {
            axis: goal.axis.clone(),
            side: goal.side,
            shift: Amount::Number(goal.shift),
            velocity: Amount::Number(goal.velocity),
            acceleration: Amount::Number(goal.acceleration),
        })?;
        Ok((request.axis, Action::Phase(request)))
    }

    fn feedback(view: &AxisView, snapshot: &Snapshot, goal: &PhaseGoal, _progress: Progress) -> Option<PhaseFeedback> {
        let side = if goal.side == PhaseGoal::MASTER { AxisSignal::PhaseMaster } else { AxisSignal::PhaseSlave };
        Some(PhaseFeedback { remaining: goal.shift * view.real(&snapshot.board, side) })
    }

    fn result(_view: &AxisView, ending: Ending) -> PhaseResult {
        PhaseResult { code: ending.code.0, message: ending.message }
    }
}

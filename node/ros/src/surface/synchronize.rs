//! `~/synchronize`: couples an axis; the goal is active while the axis is coupled.

use super::goal::{Ending, GoalAction, Progress};
use super::host::Snapshot;
use super::signals::AxisView;
use super::table::{self, ActionRow};
use lineshaft_core::code::Code;
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::request::{Amount, CamRequest, RequestError, SynchronizeRequest, factor};
use lineshaft_core::signal::axis::AxisSignal;
use lineshaft_msgs::action::{Synchronize, SynchronizeFeedback, SynchronizeGoal, SynchronizeResult};

impl GoalAction for Synchronize {
    type View = AxisView;

    const SERVED_AS: ActionRow<Self> = table::SYNCHRONIZE;

    fn resolve(config: &MachineConfig, goal: &SynchronizeGoal) -> Result<(u16, Action), RequestError> {
        let request = config.resolve_synchronize(&SynchronizeRequest {
            axis: goal.axis.clone(),
            master: goal.master.clone(),
            event: goal.event.clone(),
            mode: goal.mode,
            engage: goal.engage,
            master_increments: goal.master_increments,
            slave_increments: goal.slave_increments,
            start_distance_increments: goal.start_distance_increments,
            disengage: goal.disengage,
            numerator: goal.numerator,
            denominator: goal.denominator,
            offset: Amount::Number(goal.offset),
            velocity: Amount::Number(goal.velocity),
            acceleration: Amount::Number(goal.acceleration),
            cam: CamRequest {
                table: goal.table.clone(),
                start: goal.cam_start,
                master_scale: factor("master_scale", goal.master_scale)?,
                slave_scale: factor("slave_scale", goal.slave_scale)?,
                master_offset: Amount::Number(goal.master_offset),
                slave_offset: Amount::Number(goal.slave_offset),
            },
        })?;
        Ok((request.axis, Action::Synchronize(request)))
    }

    fn feedback(
        view: &AxisView,
        snapshot: &Snapshot,
        goal: &SynchronizeGoal,
        progress: Progress,
    ) -> Option<SynchronizeFeedback> {
        let coupled = view.bit(&snapshot.board, AxisSignal::InSync);
        let waits = view.int(&snapshot.board, AxisSignal::SyncWaiting) == progress.sequence.cast_signed();
        let error = view.int(&snapshot.board, AxisSignal::SyncError);
        let of_marks = |signal| {
            // Marks of the master of a cam are counted in the increments of the master.
            if goal.mode == SynchronizeGoal::CAM_MASTER_MARKER {
                return 0.0;
            }
            let increments = view.real(&snapshot.board, signal);
            // The conversion saturates.
            let whole = increments.floor();
            view.si(whole as i64, increments - whole)
        };
        Some(SynchronizeFeedback {
            phase: match () {
                () if waits => SynchronizeFeedback::WAITING,
                () if coupled => SynchronizeFeedback::SYNCHRONIZED,
                () => SynchronizeFeedback::CATCHING_UP,
            },
            sync_error_increments: error,
            sync_error: view.si(error, 0.0),
            marker_error: of_marks(AxisSignal::MarkerError),
            correction: of_marks(AxisSignal::MarkerCorrection),
        })
    }

    fn result(_view: &AxisView, ending: Ending) -> SynchronizeResult {
        let Ending { code, message, position, .. } = ending;
        // A goal whose coupling was ended on request has succeeded; the message gives the reason.
        let code = if code.succeeds() { Code::NONE } else { code };
        SynchronizeResult { code: code.0, message, position_increments: position.floor() }
    }
}

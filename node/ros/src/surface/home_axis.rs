//! `~/home_axis`: homing of one axis, with its phases.

use super::goal::{Ending, GoalAction, Progress};
use super::host::Snapshot;
use super::signals::AxisView;
use super::table::{self, ActionRow};
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::request::{HomeRequest, RequestError};
use lineshaft_core::signal::axis::AxisSignal;
use lineshaft_msgs::action::{HomeAxis, HomeAxisFeedback, HomeAxisGoal, HomeAxisResult};

impl GoalAction for HomeAxis {
    type View = AxisView;

    const SERVED_AS: ActionRow<Self> = table::HOME_AXIS;

    fn resolve(config: &MachineConfig, goal: &HomeAxisGoal) -> Result<(u16, Action), RequestError> {
        let HomeAxisGoal { axis, scheme, method } = goal;
        let request = config.resolve_home(&HomeRequest { axis: axis.clone(), scheme: *scheme, method: *method })?;
        Ok((request.axis, Action::HomeAxis(request)))
    }

    /// Returns `None` before the first phase and after the last one.
    fn feedback(
        view: &AxisView,
        snapshot: &Snapshot,
        _goal: &HomeAxisGoal,
        _progress: Progress,
    ) -> Option<HomeAxisFeedback> {
        let phase = view.small(&snapshot.board, AxisSignal::HomingPhase);
        let position = view.si(view.int(&snapshot.board, AxisSignal::ActualPosition), 0.0);
        (phase != 0).then_some(HomeAxisFeedback { phase, position })
    }

    fn result(_view: &AxisView, ending: Ending) -> HomeAxisResult {
        let Ending { code, message, shift, .. } = ending;
        HomeAxisResult { code: code.0, message, shift_increments: shift.unwrap_or(0) }
    }
}

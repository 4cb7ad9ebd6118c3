//! `~/tune`: determines gains for the loops of one axis.
//!
//! Law      rejected | the axis is enabled, excited and disabled | gains, which are set on request. One goal at a time
//! Reads    the goal, the result of the host
//! Writes   feedback, result, the command that sets the gains
//! Refuses  an invalid goal, a real drive without `real`, an axis that cannot be tuned

use super::goal::feedback_ticks;
use super::host::{TuneOrder, Tuning, TuningFailure, TuningPhase, TuningResult};
use super::hub::Hub;
use super::signals::AxisView;
use super::table;
use crate::layer::{ActionEvent, ActionServer, CreateError, GoalHandle, Node};
use lineshaft_core::code::Code;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::parameter::{AxisParameters, Range, Row};
use lineshaft_core::request::{Amount, RequestError, Units};
use lineshaft_core::signal::axis::AxisSignal;
use lineshaft_core::unit::UnitError;
use lineshaft_msgs::action::{Tune, TuneFeedback, TuneGoal, TuneResult};
use lineshaft_msgs::foreign::rcl_interfaces::msg::{Parameter, ParameterType, ParameterValue};
use std::sync::Arc;
use tokio::task::JoinSet;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let server = table::TUNE.server(node)?;
    tasks.spawn(serve(server, Arc::clone(hub)));
    Ok(())
}

async fn serve(mut server: ActionServer<Tune>, hub: Arc<Hub>) {
    let views = AxisView::all(hub.host.config(), hub.host.directory());
    // Running goals end with the action.
    let mut open = JoinSet::new();
    while let Some(event) = server.next().await {
        while open.try_join_next().is_some() {}
        let ActionEvent::Goal(request) = event else { continue };
        let order = tune_order(hub.host.config(), request.goal()).map_err(|error| error.to_string());
        let before = hub.host.parameters();
        let begun = order.and_then(|order| Ok((order, hub.host.tune(&order)?)));
        match begun {
            Ok((order, tuning)) => {
                // Every resolved axis has a view and parameters.
                let place = usize::from(order.axis);
                let (Some(view), Some(before)) = (views.get(place), before.effective.get(place)) else { continue };
                let tried = TunedAxis { place, parameters: *before, view: view.clone() };
                open.spawn(run(Arc::clone(&hub), request.accept(), tuning, tried));
            }
            Err(sentence) => {
                hub.refuse(format!("tune: goal rejected: {sentence}"));
                request.reject();
            }
        }
    }
}

/// Returns the settings of a goal, in increments.
pub(super) fn tune_order(config: &MachineConfig, goal: &TuneGoal) -> Result<TuneOrder, RequestError> {
    let (axis, found) = config.find_axis(&goal.axis)?;
    let (units, scale) = (Units::from_number(goal.units)?, &found.scale);
    let bad =
        |field: &str, error: UnitError| RequestError::BadValue { field: field.to_owned(), error: Box::new(error) };
    let given = |value: f64| (value != 0.0).then_some(value);
    let amount = |field: &str, value: f64, order: u8| {
        let rate = |value| Amount::Number(value).rate(units, scale, order).map_err(|error| bad(field, error));
        given(value).map(rate).transpose()
    };
    Ok(TuneOrder {
        axis,
        travel: amount("travel", goal.travel, 0)?,
        velocity: amount("velocity", goal.velocity, 1)?,
        effort: given(goal.effort),
        duration: given(goal.duration),
        inertia_ratio: given(goal.inertia_ratio),
        real: goal.real,
    })
}

/// Axis that is tuned.
struct TunedAxis {
    place: usize,
    /// Parameters at the start: the result belongs to them.
    parameters: AxisParameters,
    view: AxisView,
}

/// Executes an accepted goal until it ends.
async fn run(hub: Arc<Hub>, handle: GoalHandle<Tune>, tuning: Tuning, tried: TunedAxis) {
    handle.execute();
    let found = follow(&hub, &handle, tuning, &tried.view).await;
    let (is_cancelled, axis) = (handle.is_cancel_requested(), handle.goal().axis.clone());
    let mut result = match found {
        Ok(TuningResult { report, gains }) => {
            let parameters: Vec<_> = gains.iter().map(|gain| parameter(&axis, gain)).collect();
            let code = if parameters.is_empty() { Code::NOT_TUNED } else { Code::NONE };
            let message = if parameters.is_empty() { "no gains were found; the report says why" } else { "" };
            TuneResult { code: code.0, message: message.to_owned(), report, parameters, applied: false }
        }
        Err(TuningFailure { code, message }) => TuneResult { code: code.0, message, ..TuneResult::default() },
    };
    if is_cancelled {
        // Also if the cancel request arrived while the gains were calculated.
        result.code = Code::CANCELLED.0;
        return handle.canceled(result);
    }
    if handle.goal().apply && !result.parameters.is_empty() {
        match apply(&hub, &axis, &tried, &result.parameters).await {
            Ok(()) => result.applied = true,
            Err((code, message)) => (result.code, result.message) = (code.0, message),
        }
    }
    if result.code == Code::NONE.0 { handle.succeed(result) } else { handle.abort(result) }
}

async fn follow(
    hub: &Arc<Hub>,
    handle: &GoalHandle<Tune>,
    tuning: Tuning,
    view: &AxisView,
) -> Result<TuningResult, TuningFailure> {
    let Tuning { watch, mut found } = tuning;
    let mut ticks = feedback_ticks();
    let mut is_cancelled = false;
    loop {
        tokio::select! {
            found = &mut found => return found,
            () = handle.cancel_requested(), if !is_cancelled => {
                is_cancelled = true;
                watch.cancel();
            }
            _ = ticks.tick() => {
                let (phase, progress) = watch.progress();
                // Feedback that a client does not read is dropped.
                let _ = handle.feedback(&feedback(hub, view, phase, progress));
            }
        }
    }
}

fn feedback(hub: &Hub, view: &AxisView, phase: TuningPhase, progress: f64) -> TuneFeedback {
    let snapshot = hub.host.snapshot();
    TuneFeedback {
        phase: phase as u8,
        progress,
        position: view.si(view.int(&snapshot.board, AxisSignal::ActualPosition), 0.0),
        velocity: view.rate(&snapshot.board, AxisSignal::ActualVelocity),
    }
}

/// Returns a gain as a parameter of the node, with its type.
fn parameter(axis: &str, &(key, value): &(&'static str, f64)) -> Parameter {
    let is_real = Row::find(key).is_some_and(|(_, row)| matches!(row.range, Range::Real(..)));
    let value = if is_real {
        ParameterValue { r#type: ParameterType::PARAMETER_DOUBLE, double_value: value, ..ParameterValue::default() }
    } else {
        ParameterValue {
            r#type: ParameterType::PARAMETER_INTEGER,
            integer_value: value as i64,
            ..ParameterValue::default()
        }
    };
    Parameter { name: format!("{axis}.{key}"), value }
}

/// Sets the gains, all of them or none.
async fn apply(hub: &Arc<Hub>, axis: &str, tried: &TunedAxis, parameters: &[Parameter]) -> Result<(), (Code, String)> {
    let line = |Parameter { name, value }: &Parameter| match value.r#type {
        ParameterType::PARAMETER_DOUBLE => format!("{name}: {}\n", value.double_value),
        _ => format!("{name}: {}\n", value.integer_value),
    };
    let text: String = parameters.iter().map(line).collect();
    let failed = |sentence: String| (Code::NOT_TUNED, format!("{axis}: the gains are not set: {sentence}"));
    if hub.host.parameters().effective.get(tried.place) != Some(&tried.parameters) {
        return Err(failed("its parameters were changed meanwhile".to_owned()));
    }
    let command = hub.host.read_parameters(&text).map_err(failed)?;
    let answers = hub.submit(command).map_err(|busy| (busy.code(), busy.to_string()))?;
    answers.accepted().await.map_err(failed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_core::config::AxisConfig;
    use lineshaft_core::unit::Scale;

    fn resolve(goal: &TuneGoal) -> Result<TuneOrder, String> {
        let axis = AxisConfig::new("x".to_owned(), Scale::increments(), None, AxisParameters::new(1e5, 1e6));
        let config = MachineConfig { axes: vec![axis], ..MachineConfig::default() };
        tune_order(&config, goal).map_err(|error| error.to_string())
    }

    #[test]
    fn a_goal_becomes_an_order_in_increments_and_0_is_what_the_axis_has() {
        let goal = TuneGoal { axis: "x".to_owned(), units: TuneGoal::INCREMENTS, ..TuneGoal::default() };
        assert_eq!(resolve(&goal), Ok(TuneOrder::default()));
        let bounded = TuneGoal {
            travel: 4000.0,
            velocity: 2500.5,
            effort: 0.25,
            duration: 4.0,
            inertia_ratio: 5.0,
            real: true,
            ..goal.clone()
        };
        let order = TuneOrder {
            axis: 0,
            travel: Some(4000.0),
            velocity: Some(2500.5),
            effort: Some(0.25),
            duration: Some(4.0),
            inertia_ratio: Some(5.0),
            real: true,
        };
        assert_eq!(resolve(&bounded), Ok(order));
        let sentence = |goal: TuneGoal| resolve(&goal).expect_err("refused");
        assert!(sentence(TuneGoal { axis: "y".to_owned(), ..goal.clone() }).contains("no axis is called `y`"));
        assert!(sentence(TuneGoal { units: 3, ..goal.clone() }).contains("units"));
        for travel in [f64::NAN, f64::INFINITY] {
            assert!(sentence(TuneGoal { travel, ..goal.clone() }).contains("travel"), "{travel}");
        }
        assert!(sentence(TuneGoal { velocity: f64::NAN, ..goal.clone() }).contains("velocity"));
        // The value is checked later with the axis; NaN must not be treated as a missing value.
        let order = resolve(&TuneGoal { inertia_ratio: f64::NAN, ..goal }).expect("an order");
        assert!(order.inertia_ratio.is_some_and(f64::is_nan));
    }

    #[test]
    fn a_gain_has_the_type_of_its_parameter() {
        let kv = parameter("x", &("position_loop.kv", 91.24));
        assert_eq!((kv.name.as_str(), kv.value.r#type, kv.value.double_value), ("x.position_loop.kv", 3, 91.24));
        let kprop = parameter("x", &("kprop", 131.0));
        assert_eq!((kprop.name.as_str(), kprop.value.r#type, kprop.value.integer_value), ("x.kprop", 2, 131));
    }
}

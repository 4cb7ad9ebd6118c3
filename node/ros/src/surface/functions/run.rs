//! `~/run_function`: runs a function command until it ends.

use super::fields;
use super::states::View;
use crate::surface::goal::{self, Ending, GoalAction, Progress};
use crate::surface::host::Snapshot;
use crate::surface::table::{self, ActionRow};
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::position::Position;
use lineshaft_core::request::{FieldValue, RequestError};
use lineshaft_core::signal::{Board, Directory};
use lineshaft_msgs::action::{RunFunction, RunFunctionFeedback, RunFunctionGoal, RunFunctionResult};
use lineshaft_msgs::foreign::rcl_interfaces::msg::Parameter;

impl goal::View for View {
    fn all(config: &MachineConfig, directory: &Directory) -> Vec<Self> {
        Self::all(config, directory)
    }

    fn position(&self, board: &Board) -> Position {
        Position::whole(self.sink(board))
    }
}

impl GoalAction for RunFunction {
    type View = View;

    const SERVED_AS: ActionRow<Self> = table::RUN_FUNCTION;

    fn resolve(config: &MachineConfig, goal: &RunFunctionGoal) -> Result<(u16, Action), RequestError> {
        let RunFunctionGoal { function, parameters } = goal;
        // An unknown function is reported before errors in the fields.
        let (place, _) = config.find_function(function)?;
        let value = |Parameter { name, value }: &Parameter| match fields::field_value(name, value) {
            Ok(given) => Ok((name.clone(), given)),
            Err(sentence) => Err(RequestError::FieldForm { function: function.clone(), sentence }),
        };
        let values = parameters.iter().map(value).collect::<Result<Vec<(String, FieldValue)>, _>>()?;
        Ok((place, config.resolve_run(function, &values)?))
    }

    fn feedback(
        view: &View,
        snapshot: &Snapshot,
        _goal: &RunFunctionGoal,
        _progress: Progress,
    ) -> Option<RunFunctionFeedback> {
        let state = view.state(&snapshot.board);
        Some(RunFunctionFeedback { sink: state.sink, inputs: state.inputs, outputs: state.outputs })
    }

    fn result(_view: &View, ending: Ending) -> RunFunctionResult {
        RunFunctionResult { code: ending.code.0, message: ending.message, sink: ending.position.floor() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_core::command::RunFunction as Run;
    use lineshaft_core::config::SlotConfig;
    use lineshaft_core::function::Kind;
    use lineshaft_msgs::foreign::rcl_interfaces::msg::{ParameterType, ParameterValue};

    fn resolve(function: &str, value: ParameterValue) -> Result<(u16, Action), String> {
        let slot = |name: &str, number| SlotConfig::new(name.to_owned(), number, Kind::Epos);
        let config = MachineConfig { slots: vec![slot("other", 0), slot("index", 3)], ..MachineConfig::default() };
        let parameters = vec![Parameter { name: "travel".to_owned(), value }];
        let goal = RunFunctionGoal { function: function.to_owned(), parameters };
        RunFunction::resolve(&config, &goal).map_err(|error| error.to_string())
    }

    #[test]
    fn a_goal_becomes_one_command() {
        let integer = |integer_value| ParameterValue {
            r#type: ParameterType::PARAMETER_INTEGER,
            integer_value,
            ..ParameterValue::default()
        };
        let travel = Kind::Epos.description().find("travel").expect("a field").1 as u16;
        let run = Run { slot: 1, values: [(travel, -20_000)].into() };
        assert_eq!(resolve("index", integer(-20_000)), Ok((1, Action::RunFunction(run))));
        let unknown = "no function is called `dial`; other, index are known";
        assert_eq!(resolve("dial", integer(1)), Err(unknown.to_owned()));
        let text = ParameterValue { r#type: ParameterType::PARAMETER_STRING, ..ParameterValue::default() };
        let sentence = "index: travel cannot be a string; an integer or a list of integers is needed";
        assert_eq!(resolve("index", text), Err(sentence.to_owned()));
    }
}

//! `~/command_function`: stages values and commands one function in the same cycle; the answer contains the active parameter set after
//! that.

use super::fields;
use crate::layer::{CreateError, Node};
use crate::surface::hub::Hub;
use crate::surface::{one_command, table};
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::function::Order;
use lineshaft_core::request::FunctionRequest;
use lineshaft_msgs::foreign::rcl_interfaces::msg::Parameter;
use lineshaft_msgs::srv::{CommandFunctionRequest as Asked, CommandFunctionResponse};
use std::sync::Arc;
use tokio::task::JoinSet;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let server = table::COMMAND_FUNCTION.server(node)?;
    tasks.spawn(one_command::serve_with(server, Arc::clone(hub), resolve, response));
    Ok(())
}

/// Returns the index of the requested function, if it exists, and its command.
fn resolve(config: &MachineConfig, asked: Asked) -> (Option<u16>, Result<Action, String>) {
    let place = config.find_function(&asked.function).ok().map(|(place, _)| place);
    (place, command(config, asked))
}

fn command(config: &MachineConfig, Asked { function, command, parameters }: Asked) -> Result<Action, String> {
    let order = match command {
        Asked::RESET => Order::Reset,
        Asked::START => Order::Start,
        Asked::VALUE_NEW => Order::ValueNew,
        Asked::READ_VALUE => Order::ReadValue,
        other => {
            return Err(format!(
                "command is {other}; 0 (RESET), 1 (START), 5 (VALUE_NEW) or 6 (READ_VALUE) is expected"
            ));
        }
    };
    // An unknown function is reported before errors in the fields.
    config.find_function(&function).map_err(|error| error.to_string())?;
    let value = |Parameter { name, value }| {
        let given = fields::field_value(&name, &value).map_err(|sentence| format!("{function}: {sentence}"))?;
        Ok((name, given))
    };
    let values = parameters.into_iter().map(value).collect::<Result<_, String>>()?;
    config.resolve_function(&FunctionRequest { function, order, values }).map_err(|error| error.to_string())
}

/// The answer of the machine comes after its parameters are published: the values read here are at least as new.
fn response(hub: &Hub, function: Option<u16>, outcome: Result<(), String>) -> CommandFunctionResponse {
    let (success, message) = (outcome.is_ok(), outcome.err().unwrap_or_default());
    CommandFunctionResponse { success, message, active: function.map_or_else(Vec::new, |place| active(hub, place)) }
}

fn active(hub: &Hub, function: u16) -> Vec<Parameter> {
    let (image, place) = (hub.host.parameters(), usize::from(function));
    match (hub.host.config().slots.get(place), image.functions.get(place)) {
        (Some(slot), Some(sets)) => fields::all(slot, &sets.active),
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_core::command::CommandFunction;
    use lineshaft_core::config::SlotConfig;
    use lineshaft_core::function::Kind;
    use lineshaft_msgs::foreign::rcl_interfaces::msg::{ParameterType, ParameterValue};

    fn config() -> MachineConfig {
        let slot = |name: &str, number| SlotConfig::new(name.to_owned(), number, Kind::Varsync);
        MachineConfig { slots: vec![slot("other", 0), slot("ratio", 3)], ..MachineConfig::default() }
    }

    fn ask(function: &str, command: u8, values: &[(&str, i64)]) -> (Option<u16>, Result<Action, String>) {
        let value = |&(name, integer_value): &(&str, i64)| Parameter {
            name: name.to_owned(),
            value: ParameterValue { r#type: ParameterType::PARAMETER_INTEGER, integer_value, ..Default::default() },
        };
        let parameters = values.iter().map(value).collect();
        resolve(&config(), Asked { function: function.to_owned(), command, parameters })
    }

    #[test]
    fn a_request_becomes_one_command() {
        let values: &[(u16, i64)] = &[(3, 5_000), (0, 2)];
        for (number, order) in [(0, Order::Reset), (1, Order::Start), (5, Order::ValueNew), (6, Order::ReadValue)] {
            let (place, command) = ask("ratio", number, &[("m1", 5_000), ("mode", 2)]);
            assert_eq!(place, Some(1));
            let expected = CommandFunction { slot: 1, order, values: values.into() };
            assert_eq!(command, Ok(Action::CommandFunction(expected)));
        }
    }

    #[test]
    fn what_is_wrong_is_told_with_its_name_and_what_would_be_right() {
        // Scenarios stage with 255.
        for command in [2, 3, 4, 7, 255] {
            let sentence =
                format!("command is {command}; 0 (RESET), 1 (START), 5 (VALUE_NEW) or 6 (READ_VALUE) is expected");
            assert_eq!(ask("ratio", command, &[]), (Some(1), Err(sentence)));
        }
        let (place, error) = ask("gear", 1, &[("m1", 1)]);
        assert_eq!((place, error), (None, Err("no function is called `gear`; other, ratio are known".to_owned())));
        let (_, error) = ask("ratio", 1, &[("m9", 1)]);
        assert!(
            error.is_err_and(|error| error.starts_with("ratio: type varsync has no field `m9`; it has mode, sak,"))
        );
        let text = ParameterValue { r#type: ParameterType::PARAMETER_STRING, ..ParameterValue::default() };
        let asked = Asked {
            function: "ratio".to_owned(),
            command: 1,
            parameters: vec![Parameter { name: "m1".to_owned(), value: text }],
        };
        let sentence = "ratio: m1 cannot be a string; an integer or a list of integers is needed";
        assert_eq!(command(&config(), asked), Err(sentence.to_owned()));
    }
}

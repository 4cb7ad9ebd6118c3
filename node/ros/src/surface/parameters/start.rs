//! Values of the machine's parameters that are given to the node at its start.

use super::catalogue::Catalogue;
use super::set::change;
use crate::layer::Overrides;
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_msgs::foreign::rcl_interfaces::msg::Parameter;

/// Takes what is for the machine from the parameters that were given to a node, as one command that sets them all, by the rules of
/// `~/set_parameters`; nothing where none is. Names begin with an axis or `machine`.
///
/// # Errors
/// All that is wrong, in one sentence. An unknown name that was given to many nodes is only warned of.
pub fn start_command(config: &MachineConfig, given: &mut Overrides) -> Result<Option<Action>, String> {
    let is_object = |word: &str| word == "machine" || config.axes.iter().any(|axis| axis.name == word);
    let given = given.take_where(|name| name.split_once('.').is_some_and(|(object, _)| is_object(object)));
    let catalogue = Catalogue::new(config);
    let (mut changes, mut wrong) = (Vec::new(), Vec::new());
    for (name, given) in given.iter() {
        let parameter = Parameter { name: name.clone(), value: given.value.clone() };
        match change(&catalogue, config, &parameter) {
            Ok(change) => changes.push(change),
            Err(sentence) if !given.is_strict && catalogue.find(name).is_none() => {
                tracing::warn!("{}: {sentence}; it was given to all nodes", given.place);
            }
            Err(sentence) => wrong.push(format!("{}: {sentence}", given.place)),
        }
    }
    match (wrong.is_empty(), changes.is_empty()) {
        (false, _) => Err(format!("{}; `lineshaft params CELL` names the parameters of a cell", wrong.join("; "))),
        (true, true) => Ok(None),
        (true, false) => Ok(Some(Action::SetParameters(changes.into()))),
    }
}

#[cfg(test)]
mod tests {
    use super::super::fake;
    use super::*;
    use crate::layer::{NodeName, RosArguments};
    use lineshaft_core::parameter::Value;

    fn given(line: &str) -> Overrides {
        let words = line.split_whitespace().flat_map(|word| ["-p".to_owned(), word.to_owned()]);
        let (arguments, _) = RosArguments::take(std::iter::once("--ros-args".to_owned()).chain(words)).unwrap();
        arguments.overrides(&NodeName::new("/", "n").unwrap())
    }

    #[test]
    fn what_is_for_the_machine_becomes_one_command() {
        let config = fake::config();
        let mut all = given("x.max_velocity:=1 x.min_position:=-0.05 x.profile:=jerk use_sim_time:=true arm.goal:=1");
        let Ok(Some(Action::SetParameters(changes))) = start_command(&config, &mut all) else { panic!("a command") };
        let mut values: Vec<Value> = changes.iter().map(|change| change.value).collect();
        values.sort_by_key(|value| format!("{value:?}"));
        assert_eq!(values, [Value::Int(-50_000), Value::Int(2), Value::Real(1_000_000.0)]);
        let left: Vec<&String> = all.iter().map(|(name, _)| name).collect();
        assert_eq!(left, ["arm.goal", "use_sim_time"]);
        assert_eq!(start_command(&config, &mut all), Ok(None));
    }

    #[test]
    fn all_that_is_wrong_is_told_at_once() {
        let config = fake::config();
        let error =
            start_command(&config, &mut given("x.max_speed:=1 x.profile:=1 x.posfact_z:=2 x.rampmin:=20")).unwrap_err();
        let expected = "-p x.max_speed: parameter `x.max_speed` has not been declared; \
                        -p x.posfact_z: x.posfact_z is read-only: part of the cell: changes with the file and a new start; \
                        -p x.profile: x.profile cannot be an integer; a string is needed; `lineshaft params CELL` names";
        assert!(error.starts_with(expected), "{error}");
        let empty = start_command(&config, &mut given("x.min_position:=[]")).unwrap_err();
        assert!(empty.starts_with("-p x.min_position: x.min_position cannot be a list;"), "{empty}");
    }
}

//! Overrides of the machine's parameters at the start of the node.

use super::catalogue::{Catalogue, DeclaredParameter};
use super::functions::{self, Staged};
use super::set::change;
use crate::layer::{OverrideValue, Overrides};
use lineshaft_core::command::{Action, Command, Commands, Source};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::machine::Machine;
use lineshaft_core::parameter::{Change, ParameterImage, Storage, Value};
use lineshaft_msgs::foreign::rcl_interfaces::msg::Parameter;
use std::collections::{BTreeMap, HashSet};

/// Removes the overrides for the machine from those of a node, with the rules of `~/set_parameters`. Returns one command that sets all
/// parameters of axes and machine, and one for each function. Names start with an axis, a function or `machine`. A value that is calculated
/// from others is left out, with a warning if it will be different.
///
/// # Errors
/// All errors, in one message. An unknown name that was given to several nodes causes only a warning.
pub fn start_commands(config: &MachineConfig, given: &mut Overrides) -> Result<Vec<Action>, String> {
    let of_functions = |word: &str| config.slots.iter().any(|slot| slot.name == word);
    let is_object =
        |word: &str| word == "machine" || config.axes.iter().any(|axis| axis.name == word) || of_functions(word);
    let given = given.take_matching(|name| name.split_once('.').is_some_and(|(object, _)| is_object(object)));
    let catalogue = Catalogue::new(config);
    let (mut changes, mut wrong, mut shown) = (Vec::new(), BTreeMap::new(), Vec::new());
    let (mut staged, cell) = (BTreeMap::<u16, Vec<Staged>>::new(), functions::of_cell(config));
    let names: HashSet<&str> = given.iter().map(|(name, _)| name.as_str()).collect();
    for (name, given) in given.iter() {
        let parameter = Parameter { name: name.clone(), value: given.value.clone() };
        if let Some(known) = catalogue.function(name) {
            match known.staged(&parameter.value, &cell) {
                Ok(Some(one)) => staged.entry(one.place).or_default().push(one),
                Ok(None) => {}
                Err(sentence) => drop(wrong.insert(name, format!("{}: {sentence}", given.place))),
            }
            continue;
        }
        let declared = catalogue.find(name);
        // The start of the program must not move the virtual master: a 0 of a dump is ignored.
        if let Some(declared) = declared.filter(|known| known.row.moves_virtual_master()) {
            match change(&catalogue, config, &parameter, &ParameterImage::default()) {
                Ok(change) if change.iter().all(|change| change.value == Value::Int(0)) => {}
                Ok(_) => drop(wrong.insert(name, format!("{}: {}", given.place, moves(&declared.name)))),
                Err(sentence) => drop(wrong.insert(name, format!("{}: {sentence}", given.place))),
            }
            continue;
        }
        let is_shown =
            |known: &&DeclaredParameter| known.is_view_of(&names) || known.is_not_settable(config, &parameter.value);
        if let Some(declared) = declared.filter(is_shown) {
            shown.push((declared, parameter, given));
            continue;
        }
        match change(&catalogue, config, &parameter, &ParameterImage::default()) {
            Ok(change) => changes.extend(change),
            Err(sentence) if !given.is_for_this_node_only && declared.is_none() => {
                tracing::warn!("{}: {sentence}; it was given to all nodes", given.place);
            }
            Err(sentence) => drop(wrong.insert(name, format!("{}: {sentence}", given.place))),
        }
    }
    // Values that cannot be set, or that are views of others, are left out if the other values lead to them.
    let image = if shown.is_empty() { ParameterImage::default() } else { image_after(config, changes.clone())? };
    // The same number may have been converted to two units and rounded twice.
    let differs = |(declared, parameter, _): &&(&DeclaredParameter, Parameter, &OverrideValue)| {
        let is_same = declared.has_value(&parameter.value, &image);
        !(is_same || declared.is_view_of(&names) && declared.nearly_has_value(&parameter.value, &image))
    };
    for (declared, parameter, given) in shown.iter().filter(differs) {
        if declared.row.storage == Storage::Derived && given.is_of_file {
            tracing::warn!("{}: {} is left out: it is computed from other parameters", given.place, declared.name);
            continue;
        }
        match change(&catalogue, config, parameter, &image) {
            Ok(change) => changes.extend(change),
            Err(sentence) => drop(wrong.insert(&declared.name, format!("{}: {sentence}", given.place))),
        }
    }
    if !wrong.is_empty() {
        let wrong: Vec<_> = wrong.into_values().collect();
        return Err(format!("{}; `lineshaft params CELL` names the parameters of a cell", wrong.join("; ")));
    }
    let of_axes = (!changes.is_empty()).then(|| Ok(Action::SetParameters(changes.into())));
    let stage = staged.into_iter().map(|(place, staged)| functions::command(config, place, staged));
    of_axes.into_iter().chain(stage).collect()
}

fn moves(name: &str) -> String {
    format!("{name} moves the virtual master; 0 is allowed at the start, as no machine begins with one that runs")
}

/// Returns the parameters of a machine that starts with these changes; those of the cell if the machine refuses them.
fn image_after(config: &MachineConfig, changes: Vec<Change>) -> Result<ParameterImage, String> {
    let mut machine = Machine::new(config.clone()).map_err(|error| error.to_string())?;
    let (inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let command = Command { sequence: 1, source: Source::Cli, action: Action::SetParameters(changes.into()) };
    machine.cycle(&inputs, Commands::queue(&[command]), &mut outputs);
    let of_axes: Vec<_> = config.axes.iter().map(|axis| axis.parameters).collect();
    let mut image = ParameterImage { effective: of_axes.clone(), user: of_axes, ..ParameterImage::default() };
    machine.copy_parameters(&mut image);
    Ok(image)
}

#[cfg(test)]
mod tests {
    use super::super::fake;
    use super::*;
    use crate::layer::{NodeName, RosArguments};
    use lineshaft_core::command::CommandFunction;
    use lineshaft_core::config::SlotConfig;
    use lineshaft_core::function::{Kind, Order};

    fn given(line: &str) -> Overrides {
        let words = line.split_whitespace().flat_map(|word| ["-p".to_owned(), word.to_owned()]);
        let (arguments, _) = RosArguments::take(std::iter::once("--ros-args".to_owned()).chain(words)).unwrap();
        arguments.overrides(&NodeName::new("/", "n").unwrap())
    }

    #[test]
    fn what_is_for_the_machine_becomes_one_command() {
        let config = fake::config();
        let mut all = given("x.max_velocity:=1 x.min_position:=-0.05 x.profile:=jerk use_sim_time:=true arm.goal:=1");
        let commands = start_commands(&config, &mut all).unwrap();
        let [Action::SetParameters(changes)] = commands.as_slice() else { panic!("a command") };
        let mut values: Vec<Value> = changes.iter().map(|change| change.value).collect();
        values.sort_by_key(|value| format!("{value:?}"));
        assert_eq!(values, [Value::Int(-50_000), Value::Int(2), Value::Real(1_000_000.0)]);
        let left: Vec<&String> = all.iter().map(|(name, _)| name).collect();
        assert_eq!(left, ["arm.goal", "use_sim_time"]);
        assert_eq!(start_commands(&config, &mut all), Ok(vec![]));
    }

    #[test]
    fn all_errors_are_reported_in_one_message() {
        let config = fake::config();
        let error = start_commands(&config, &mut given("x.max_speed:=1 x.profile:=1 x.posfact_z:=2 x.rampmin:=20"))
            .unwrap_err();
        let expected = "-p x.max_speed: parameter `x.max_speed` has not been declared; \
                        -p x.posfact_z: x.posfact_z is read-only: part of the cell: changes with the file and a new start; \
                        -p x.profile: x.profile cannot be an integer; a string is needed; `lineshaft params CELL` names";
        assert!(error.starts_with(expected), "{error}");
        let empty = start_commands(&config, &mut given("x.min_position:=[]")).unwrap_err();
        assert!(empty.starts_with("-p x.min_position: x.min_position cannot be a list;"), "{empty}");
    }

    /// Proves: MACS-VM-02, MACS-VM-04
    #[test]
    fn start_does_not_move_virtual_master() {
        let config = fake::config();
        let mut all = given("machine.pulsvel:=0 machine.setsys_15:=0 machine.pulsacc:=7");
        let commands = start_commands(&config, &mut all).unwrap();
        let [Action::SetParameters(changes)] = commands.as_slice() else { panic!("a command") };
        assert_eq!(changes.iter().map(|change| change.value).collect::<Vec<_>>(), [Value::Int(7)]);
        assert_eq!(start_commands(&config, &mut given("machine.pulsvel:=0")), Ok(vec![]));
        for name in ["machine.pulsvel", "machine.setsys_15"] {
            let error = start_commands(&config, &mut given(&format!("{name}:=-5 machine.pulsacc:=7"))).unwrap_err();
            let expected =
                format!("-p {name}: {name} moves the virtual master; 0 is allowed at the start, as no machine");
            assert!(error.starts_with(&expected), "{error}");
        }
        let error = start_commands(&config, &mut given("machine.pulsvel:=1.5")).unwrap_err();
        assert!(error.starts_with("-p machine.pulsvel: machine.pulsvel cannot be a double"), "{error}");
    }

    #[test]
    fn what_is_for_functions_is_staged_by_a_command_for_each() {
        let mut config = fake::config();
        config.slots =
            vec![SlotConfig::new("cams".to_owned(), 0, Kind::Cam), SlotConfig::new("more".to_owned(), 1, Kind::Cam)];
        let mut all = given("more.ba:=1 x.max_velocity:=1.0 cams.cams:=[1,2] cams.modulo:=5 cams.type:=cam");
        let commands = start_commands(&config, &mut all).unwrap();
        let stage = |slot, values: &[(u16, i64)]| {
            Action::CommandFunction(CommandFunction { slot, order: Order::Stage, values: values.into() })
        };
        assert!(matches!(commands[0], Action::SetParameters(_)));
        assert_eq!(commands[1..], [stage(0, &[(3, 1), (4, 2), (19, 5)]), stage(1, &[(0, 1)])]);
        let error = start_commands(&config, &mut given("cams.type:=ecopy cams.speed:=1")).unwrap_err();
        let expected = "-p cams.speed: parameter `cams.speed` has not been declared; \
                        -p cams.type: cams.type is read-only: part of the cell";
        assert!(error.starts_with(expected), "{error}");
    }

    /// Values of a dump: a part of the cell with the value of the cell, and values that follow from others.
    #[test]
    fn read_only_values_may_be_repeated() {
        let config = fake::config();
        let image = image_after(&config, Vec::new()).unwrap();
        let catalogue = Catalogue::new(&config);
        let computed = catalogue.find("x.velmaxqc").expect("declared").message(&image).integer_value;
        let command = |line: String| start_commands(&config, &mut given(&line));
        assert_eq!(
            command(format!("x.posfact_z:=null x.velmaxqc:={computed} x.max_jerk:=null")).map(|commands| {
                let [Action::SetParameters(changes)] = commands.as_slice() else { panic!("a command") };
                changes.iter().map(|change| change.value).collect::<Vec<_>>()
            }),
            Ok(vec![Value::Unset])
        );
        let error = command(format!("x.velmaxqc:={}", computed + 1)).unwrap_err();
        assert!(error.contains("x.velmaxqc is read-only: computed from other parameters"), "{error}");
        let error = command("x.posfact_z:=7".to_owned()).unwrap_err();
        assert!(error.contains("x.posfact_z is read-only: part of the cell"), "{error}");
    }
}

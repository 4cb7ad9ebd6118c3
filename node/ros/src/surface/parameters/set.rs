//! set_parameters and set_parameters_atomically: each set is one command to the machine, whose answer is the result.

use super::catalogue::Catalogue;
use super::functions::{self, Staged};
use super::give;
use crate::layer::{CreateError, Node, Request, ServiceServer};
use crate::surface::hub::{CommandEvents, Hub};
use crate::surface::table;
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::parameter::{Change, ParameterImage, ParameterInput};
use lineshaft_core::request::RequestError;
use lineshaft_core::unit::excerpt;
use lineshaft_msgs::foreign::rcl_interfaces::msg::{Parameter, ParameterValue, SetParametersResult};
use lineshaft_msgs::foreign::rcl_interfaces::srv::{
    SetParameters, SetParametersAtomically, SetParametersAtomicallyResponse, SetParametersResponse,
};
use std::collections::{HashSet, VecDeque};
use std::sync::Arc;
use tokio::task::JoinSet;

/// Maximum number of sets of one request in progress: a fraction of the command queue, to leave room for others.
const MAX_PENDING_SETS: usize = 32;

pub(super) fn start(
    node: &Node,
    hub: &Arc<Hub>,
    catalogue: &Arc<Catalogue>,
    tasks: &mut JoinSet<()>,
) -> Result<(), CreateError> {
    let server = table::SET_PARAMETERS.server(node)?;
    tasks.spawn(serve_each(server, Arc::clone(hub), Arc::clone(catalogue)));
    let server = table::SET_PARAMETERS_ATOMICALLY.server(node)?;
    tasks.spawn(serve_together(server, Arc::clone(hub), Arc::clone(catalogue)));
    Ok(())
}

async fn serve_each(mut server: ServiceServer<SetParameters>, hub: Arc<Hub>, catalogue: Arc<Catalogue>) {
    let service = server.name().to_string();
    // Requests are handled in sequence, in the order of the clients.
    while let Some(Request { message, reply }) = server.next().await {
        let results = set_each(&hub, &catalogue, &service, &message.parameters).await;
        reply.send_soon(SetParametersResponse { results });
    }
}

async fn serve_together(mut server: ServiceServer<SetParametersAtomically>, hub: Arc<Hub>, catalogue: Arc<Catalogue>) {
    let service = server.name().to_string();
    while let Some(Request { message, reply }) = server.next().await {
        let result = set_together(&hub, &catalogue, &service, &message.parameters).await;
        reply.send_soon(SetParametersAtomicallyResponse { result });
    }
}

/// Sets each parameter separately, in their order; views of other parameters in the request are handled last.
async fn set_each(
    hub: &Arc<Hub>,
    catalogue: &Catalogue,
    service: &str,
    parameters: &[Parameter],
) -> Vec<SetParametersResult> {
    if let Err(sentence) = check_count(hub, catalogue, parameters) {
        hub.refuse(format!("{service}: {sentence}"));
        return vec![SetParametersResult { successful: false, reason: sentence }];
    }
    let names: HashSet<&str> = parameters.iter().map(|parameter| parameter.name.as_str()).collect();
    let repeats =
        |place: &usize| catalogue.find(&parameters[*place].name).is_some_and(|known| known.is_view_of(&names));
    // Views of other parameters in the request are checked once those are set.
    let (later, first): (Vec<usize>, Vec<usize>) = (0..parameters.len()).partition(repeats);
    let mut results = vec![SetParametersResult::default(); parameters.len()];
    let mut under_way = VecDeque::new();
    let mut wrong = RefusalLog::default();
    let mut refused = |sentence: String| {
        wrong.note(&sentence);
        Given::Waits(Err(sentence))
    };
    for place in first.into_iter().chain(later) {
        let parameter = &parameters[place];
        let known = catalogue.find(&parameter.name);
        let is_shown = known.is_some_and(|known| {
            known.is_view_of(&names) || known.is_not_settable(hub.host.config(), &parameter.value)
        });
        if is_shown {
            // Whether it has that value is known only after the previous parameters are set.
            while let Some((place, given)) = under_way.pop_front() {
                results[place] = result(given).await;
            }
        }
        let given = match asked(hub, catalogue, parameter) {
            Ok(Asked::Nothing) => Given::Done,
            Ok(_)
                if is_shown && known.is_some_and(|known| known.has_value(&parameter.value, &hub.host.parameters())) =>
            {
                Given::Done
            }
            Ok(Asked::Own(value)) => {
                hub.own.set([(parameter.name.clone(), value)]);
                Given::Done
            }
            Ok(Asked::Machine(change)) => Given::Waits(give(hub, Action::SetParameters([change].into()))),
            Ok(Asked::Function(staged)) => match functions::command(hub.host.config(), staged.place, vec![staged]) {
                Ok(command) => Given::Waits(give(hub, command)),
                Err(sentence) => refused(sentence),
            },
            Err(sentence) => refused(sentence),
        };
        under_way.push_back((place, given));
        if under_way.len() >= MAX_PENDING_SETS
            && let Some((place, given)) = under_way.pop_front()
        {
            results[place] = result(given).await;
        }
    }
    while let Some((place, given)) = under_way.pop_front() {
        results[place] = result(given).await;
    }
    wrong.report(hub, service);
    results
}

/// Sets all parameters, or none.
async fn set_together(
    hub: &Arc<Hub>,
    catalogue: &Catalogue,
    service: &str,
    parameters: &[Parameter],
) -> SetParametersResult {
    let refused = |reason: &str| SetParametersResult { successful: false, reason: reason.to_owned() };
    if parameters.is_empty() {
        return refused("the list of parameters is empty; at least one is needed");
    }
    if let Err(sentence) = check_count(hub, catalogue, parameters) {
        hub.refuse(format!("{service}: {sentence}"));
        return refused(&sentence);
    }
    let mut own = Vec::new();
    let command = match together(hub, catalogue, parameters, &mut own) {
        Ok(command) => command,
        Err(sentence) => {
            hub.refuse(format!("{service}: {sentence}"));
            return refused(&sentence);
        }
    };
    // The machine may refuse its parameters; the checked parameters of the node are set only if it does not.
    let given = match command {
        None => Given::Done,
        Some(command) => Given::Waits(give(hub, command)),
    };
    let result = result(given).await;
    if result.successful && !own.is_empty() {
        hub.own.set(own);
    }
    result
}

/// Returns the command of an atomic set, and the node's own parameters; `None` if the machine has nothing to do.
fn together(
    hub: &Hub,
    catalogue: &Catalogue,
    parameters: &[Parameter],
    own: &mut Vec<(String, ParameterValue)>,
) -> Result<Option<Action>, String> {
    let (mut changes, mut staged) = (Vec::new(), Vec::<Staged>::new());
    // First parameter that becomes a command, and the function that it belongs to.
    let mut first: Option<(&str, Option<u16>)> = None;
    for parameter in parameters {
        let of = match asked(hub, catalogue, parameter)? {
            Asked::Nothing => continue,
            Asked::Own(value) => {
                own.push((parameter.name.clone(), value));
                continue;
            }
            Asked::Machine(change) => {
                changes.push(change);
                None
            }
            Asked::Function(one) => {
                let place = one.place;
                staged.push(one);
                Some(place)
            }
        };
        let (name, known) = *first.get_or_insert((&parameter.name, of));
        if known != of {
            return Err(format!(
                "{name} and {} cannot be set together; a function's values are a set of their own",
                parameter.name
            ));
        }
    }
    match first {
        None => Ok(None),
        Some((_, None)) => Ok(Some(Action::SetParameters(changes.into()))),
        Some((_, Some(place))) => functions::command(hub.host.config(), place, staged).map(Some),
    }
}

/// State of a set.
enum Given {
    Done,
    /// The answer of the machine is pending, or the command was refused before.
    Waits(Result<CommandEvents, String>),
}

/// Target of a set.
enum Asked {
    /// The parameter cannot be set, but already has this value.
    Nothing,
    Machine(Change),
    Function(Staged),
    /// Accepted value of a parameter of the node itself.
    Own(ParameterValue),
}

fn asked(hub: &Hub, catalogue: &Catalogue, parameter: &Parameter) -> Result<Asked, String> {
    match hub.own.fitting(&parameter.name, &parameter.value) {
        Some(fitting) => fitting.map(Asked::Own),
        None if let Some(known) = catalogue.function(&parameter.name) => {
            let staged = known.staged(&parameter.value, &hub.host.parameters())?;
            Ok(staged.map_or(Asked::Nothing, Asked::Function))
        }
        None => match change(catalogue, hub.host.config(), parameter, &hub.host.parameters()) {
            Ok(change) => Ok(change.map_or(Asked::Nothing, Asked::Machine)),
            Err(sentence) => Err(sentence),
        },
    }
}

/// Checks the number of parameters: a request may name each one once, because a million sets of one parameter would delay all other
/// clients.
fn check_count(hub: &Hub, catalogue: &Catalogue, parameters: &[Parameter]) -> Result<(), String> {
    let (given, most) = (parameters.len(), catalogue.len() + hub.own.all().len());
    if given > most {
        return Err(format!("{given} parameters in one request; there are {most}, each of which may be named once"));
    }
    Ok(())
}

async fn result(given: Given) -> SetParametersResult {
    let outcome = match given {
        Given::Done => Ok(()),
        Given::Waits(Ok(answers)) => answers.accepted().await,
        Given::Waits(Err(sentence)) => Err(sentence),
    };
    SetParametersResult { successful: outcome.is_ok(), reason: outcome.err().unwrap_or_default() }
}

/// Returns the requested change; `None` if the parameter cannot be set, but already has this value in `image`.
pub(super) fn change(
    catalogue: &Catalogue,
    config: &MachineConfig,
    parameter: &Parameter,
    image: &ParameterImage,
) -> Result<Option<Change>, String> {
    let Some(declared) = catalogue.find(&parameter.name) else {
        let sentence = format!("parameter `{}` has not been declared", excerpt(&parameter.name));
        // The reason, if the name is known elsewhere.
        return Err(match config.resolve_parameter(&parameter.name, &ParameterInput::Unset) {
            Err(error @ RequestError::NotApplicable { .. }) => format!("{sentence}: {error}"),
            _ => sentence,
        });
    };
    if declared.is_not_settable(config, &parameter.value) && declared.has_value(&parameter.value, image) {
        return Ok(None);
    }
    if declared.row.is_read_only() {
        let why = declared.descriptor().additional_constraints;
        return Err(format!("{} is read-only: {why}", declared.name));
    }
    let input = declared.input(&parameter.value)?;
    config.resolve_parameter(&parameter.name, &input).map(Some).map_err(|error| error.to_string())
}

/// Errors of requests that never became commands, reported once for each call.
#[derive(Default)]
struct RefusalLog {
    first: Option<String>,
    more: usize,
}

impl RefusalLog {
    fn note(&mut self, sentence: &str) {
        match self.first {
            Some(_) => self.more += 1,
            None => self.first = Some(sentence.to_owned()),
        }
    }

    fn report(self, hub: &Hub, service: &str) {
        let Some(sentence) = self.first else { return };
        let more = if self.more > 0 { format!(" ({} more in this request)", self.more) } else { String::new() };
        hub.refuse(format!("{service}: {sentence}{more}"));
    }
}

#[cfg(test)]
mod tests {
    use super::super::fake;
    use super::*;
    use lineshaft_core::parameter::Value;
    use lineshaft_msgs::foreign::rcl_interfaces::msg::ParameterType;

    fn ask(name: &str, value: ParameterValue) -> Result<Change, String> {
        let config = fake::config();
        let parameter = Parameter { name: name.to_owned(), value };
        let asked = change(&Catalogue::new(&config), &config, &parameter, &fake::image(&config));
        asked.map(|change| change.expect("a change"))
    }

    fn double(double_value: f64) -> ParameterValue {
        ParameterValue { r#type: ParameterType::PARAMETER_DOUBLE, double_value, ..ParameterValue::default() }
    }

    fn integer(integer_value: i64) -> ParameterValue {
        ParameterValue { r#type: ParameterType::PARAMETER_INTEGER, integer_value, ..ParameterValue::default() }
    }

    fn string(text: &str) -> ParameterValue {
        let string_value = text.to_owned();
        ParameterValue { r#type: ParameterType::PARAMETER_STRING, string_value, ..ParameterValue::default() }
    }

    #[test]
    fn numbers_are_in_the_unit_of_the_row() {
        let value = |name, given| ask(name, given).unwrap().value;
        // 1000 increments are one millimetre, which is the unit of the axis.
        assert_eq!(value("x.max_velocity", double(0.25)), Value::Real(250_000.0));
        assert_eq!(value("x.max_velocity", integer(1)), Value::Real(1_000_000.0));
        assert_eq!(value("x.min_position", double(-0.05)), Value::Int(-50_000));
        assert_eq!(value("x.min_position", ParameterValue::default()), Value::Unset);
        assert_eq!(value("x.amc.position_reference", double(60.0)), Value::Int(60_000));
        assert_eq!(value("x.amc.speed_reference", double(0.5)), Value::Real(500_000.0));
        assert_eq!(value("x.rampmin", integer(20)), Value::Int(20_000_000));
        assert_eq!(value("x.profile", string("jerk")), Value::Int(2));
    }

    #[test]
    fn what_is_wrong_is_told_with_its_name_and_what_would_be_right() {
        for (name, given, sentence) in [
            ("x.max_speed", double(1.0), "parameter `x.max_speed` has not been declared"),
            ("", double(1.0), "parameter `` has not been declared"),
            (
                "line.encoderclock",
                integer(1),
                "parameter `line.encoderclock` has not been declared: line.encoderclock is not there; it is for axes with a drive",
            ),
            ("x.max_velocity", string("fast"), "x.max_velocity cannot be a string; a number is needed"),
            (
                "x.max_velocity",
                ParameterValue::default(),
                "x.max_velocity cannot be without a value; a number is needed",
            ),
            ("x.error_reaction", double(2.0), "x.error_reaction cannot be a double; an integer is needed"),
            ("x.profile", string("round"), "x.profile is `round`; one of trapezoid, s_ramp, jerk is expected"),
            ("x.velmaxqc", integer(1), "x.velmaxqc is read-only: computed from other parameters"),
            (
                "x.posfact_z",
                integer(1),
                "x.posfact_z is read-only: part of the cell: changes with the file and a new start",
            ),
        ] {
            assert_eq!(ask(name, given).unwrap_err(), sentence);
        }
        for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for name in ["x.max_velocity", "x.velocity_override", "x.min_position", "x.rampmin"] {
                let sentence = ask(name, double(number)).unwrap_err();
                assert!(sentence.starts_with(name), "{sentence}");
            }
        }
    }
}

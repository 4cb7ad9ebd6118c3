//! /parameter_events: differences of successive images, regardless of the origin of a change, and changes of the node's own parameters.

use super::catalogue::{Catalogue, DeclaredParameter};
use super::functions::FunctionParameter;
use super::own::OwnParameter;
use crate::layer::{NodeHandle, Publisher};
use crate::surface::hub::Hub;
use lineshaft_core::parameter::ParameterImage;
use lineshaft_msgs::foreign::rcl_interfaces::msg::{Parameter, ParameterEvent, ParameterType};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;
use tokio::task::JoinSet;
use tokio::time::MissedTickBehavior;

/// Period of the comparison of images.
const PERIOD: Duration = Duration::from_millis(10);

pub(super) fn start(
    node: &NodeHandle,
    publisher: Publisher<ParameterEvent>,
    hub: &Arc<Hub>,
    catalogue: &Arc<Catalogue>,
    tasks: &mut JoinSet<()>,
) {
    let name = node.name().to_string();
    tasks.spawn(publish(publisher, name, Arc::clone(hub), Arc::clone(catalogue)));
}

async fn publish(publisher: Publisher<ParameterEvent>, node: String, hub: Arc<Hub>, catalogue: Arc<Catalogue>) {
    let (host, clock) = (Arc::clone(&hub.host), hub.clock.clone());
    let mut failed = 0_u64;
    let mut say = |event: ParameterEvent| {
        if let Err(error) = publisher.publish(&ParameterEvent { stamp: clock.now(), node: node.clone(), ..event }) {
            failed += 1;
            if failed.is_power_of_two() {
                tracing::warn!("{error} ({failed} so far)");
            }
        }
    };
    let mut last = host.parameters();
    let (mut own_changes, mut last_own) = (hub.own.changes(), hub.own.all());
    declarations(&catalogue, &last).into_iter().for_each(&mut say);
    say(ParameterEvent { new_parameters: own_parameters(last_own.iter()), ..ParameterEvent::default() });
    let mut ticks = tokio::time::interval(PERIOD);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Skip);
    loop {
        ticks.tick().await;
        let newest = host.parameters();
        let mut event = ParameterEvent::default();
        if newest.version != last.version {
            event.changed_parameters = changes(&catalogue, &last, &newest);
            last = newest;
        }
        // If the sender has ended, nothing has changed.
        if own_changes.has_changed().unwrap_or(false) {
            own_changes.mark_unchanged();
            let newest = hub.own.all();
            let (changed, new) = own_difference(&last_own, &newest);
            event.changed_parameters.extend(changed);
            event.new_parameters = new;
            last_own = newest;
        }
        if !(event.changed_parameters.is_empty() && event.new_parameters.is_empty()) {
            say(event);
        }
    }
}

fn own_parameters<'a>(own: impl Iterator<Item = (&'a String, &'a OwnParameter)>) -> Vec<Parameter> {
    own.map(|(name, own)| Parameter { name: name.clone(), value: own.value.clone() }).collect()
}

/// Returns the node's own parameters whose value has changed, and the new ones.
fn own_difference(
    last: &BTreeMap<String, OwnParameter>,
    newest: &BTreeMap<String, OwnParameter>,
) -> (Vec<Parameter>, Vec<Parameter>) {
    let is_new = |name: &str| !last.contains_key(name);
    let differs = |name: &str, own: &OwnParameter| last.get(name).is_some_and(|before| before.value != own.value);
    let changed = own_parameters(newest.iter().filter(|(name, own)| differs(name, own)));
    (changed, own_parameters(newest.iter().filter(|(name, _)| is_new(name))))
}

/// Returns the parameters that have a value at the start, one event for each object.
fn declarations(catalogue: &Catalogue, image: &ParameterImage) -> Vec<ParameterEvent> {
    let object = |name: &str| name.split('.').next().unwrap_or_default().to_owned();
    let of_object = |declared: &[DeclaredParameter]| {
        let parameters = declared.iter().map(|declared| declared.parameter(image));
        let with_value = |parameter: &Parameter| parameter.value.r#type != ParameterType::PARAMETER_NOT_SET;
        ParameterEvent { new_parameters: parameters.filter(with_value).collect(), ..ParameterEvent::default() }
    };
    let of_axes = catalogue.all().chunk_by(|a, b| object(&a.name) == object(&b.name)).map(of_object);
    let of_function = |known: &[FunctionParameter]| {
        let new_parameters = known.iter().map(|known| known.parameter(image)).collect();
        ParameterEvent { new_parameters, ..ParameterEvent::default() }
    };
    let functions = catalogue.functions().chunk_by(|a, b| object(&a.name) == object(&b.name));
    of_axes.chain(functions.map(of_function)).collect()
}

/// Returns the changed parameters; one that was removed has no value.
fn changes(catalogue: &Catalogue, last: &ParameterImage, newest: &ParameterImage) -> Vec<Parameter> {
    let differs = |declared: &&DeclaredParameter| declared.value(last) != declared.value(newest);
    let of_axes = catalogue.all().iter().filter(differs).map(|declared| declared.parameter(newest));
    let of_functions = catalogue.functions().iter().filter(|known| !known.is_same(last, newest));
    of_axes.chain(of_functions.map(|known| known.parameter(newest))).collect()
}

#[cfg(test)]
mod tests {
    use super::super::fake;
    use super::super::own::OwnParameters;
    use super::*;
    use lineshaft_core::parameter::{Row, Value};
    use lineshaft_msgs::foreign::rcl_interfaces::msg::ParameterValue;

    #[test]
    fn a_change_shows_in_every_view_of_it() {
        let config = fake::config();
        let (catalogue, first) = (Catalogue::new(&config), fake::image(&config));
        assert!(changes(&catalogue, &first, &first).is_empty());
        let mut second = first.clone();
        let (_, velocity) = Row::find("max_velocity").unwrap();
        velocity.change(&mut second.effective[1], Value::Real(500_000.0)).unwrap();
        let changed = changes(&catalogue, &first, &second);
        let names: Vec<&str> = changed.iter().map(|parameter| parameter.name.as_str()).collect();
        // The ramp takes half of the time to half of the velocity; goals without rates use fractions of it.
        assert_eq!(names, ["x.max_velocity", "x.rampmin", "x.velmax", "x.velmaxqc"]);
        assert_eq!(changed[0].value.double_value, 0.5);
        assert_eq!(changed[1].value.double_value, 100.0);

        let (_, low) = Row::find("min_position").unwrap();
        low.change(&mut second.effective[1], Value::Int(-1000)).unwrap();
        let mut third = second.clone();
        low.change(&mut third.effective[1], Value::Unset).unwrap();
        let off = changes(&catalogue, &second, &third);
        let low = off.iter().find(|parameter| parameter.name == "x.min_position").unwrap();
        assert_eq!(low.value.r#type, ParameterType::PARAMETER_NOT_SET, "left out, not deleted");
    }

    #[test]
    fn own_parameters_are_new_once_and_then_change() {
        let own = OwnParameters::default();
        own.declare_switch("a", "");
        let first = own.all();
        assert_eq!(own_difference(&first, &first), (vec![], vec![]));
        own.declare_switch("b", "");
        own.set([("a".to_owned(), ParameterValue { r#type: 1, bool_value: true, ..Default::default() })]);
        let (changed, new) = own_difference(&first, &own.all());
        assert_eq!((changed[0].name.as_str(), changed[0].value.bool_value, changed.len()), ("a", true, 1));
        assert_eq!((new[0].name.as_str(), new.len()), ("b", 1));
    }

    #[test]
    fn what_has_a_value_is_declared_at_the_start() {
        let config = fake::config();
        let (catalogue, image) = (Catalogue::new(&config), fake::image(&config));
        let events = declarations(&catalogue, &image);
        assert_eq!(events.len(), 3, "line, machine, x");
        let names: Vec<&String> =
            events.iter().flat_map(|event| &event.new_parameters).map(|parameter| &parameter.name).collect();
        assert!(names.contains(&&"x.max_velocity".to_owned()) && !names.contains(&&"x.max_jerk".to_owned()));
        let without = catalogue.all().iter().filter(|declared| declared.message(&image).r#type == 0).count();
        assert_eq!(names.len() + without, catalogue.all().len());
    }
}

//! Read-only services: get_parameters, get_parameter_types, list_parameters, describe_parameters.

use super::catalogue::Catalogue;
use super::view::View;
use crate::layer::{CreateError, Node, Request};
use crate::surface::hub::Hub;
use crate::surface::table;
use lineshaft_msgs::Service;
use lineshaft_msgs::foreign::rcl_interfaces::srv::{
    DescribeParametersRequest, DescribeParametersResponse, GetParameterTypesRequest, GetParameterTypesResponse,
    GetParametersRequest, GetParametersResponse, ListParametersRequest, ListParametersResponse,
};
use std::sync::Arc;
use tokio::task::JoinSet;

pub(super) fn start(
    node: &Node,
    hub: &Arc<Hub>,
    catalogue: &Arc<Catalogue>,
    tasks: &mut JoinSet<()>,
) -> Result<(), CreateError> {
    let mut one = Services { node, hub, catalogue, tasks };
    one.serve(&table::GET_PARAMETERS, get)?;
    one.serve(&table::GET_PARAMETER_TYPES, types)?;
    one.serve(&table::LIST_PARAMETERS, list)?;
    one.serve(&table::DESCRIBE_PARAMETERS, describe)
}

struct Services<'a> {
    node: &'a Node,
    hub: &'a Arc<Hub>,
    catalogue: &'a Arc<Catalogue>,
    tasks: &'a mut JoinSet<()>,
}

type Answer<S> = fn(&View<'_>, <S as Service>::Request) -> <S as Service>::Response;

impl Services<'_> {
    /// Serves a service from the newest values.
    fn serve<S: Service + 'static>(
        &mut self,
        served: &table::ServiceRow<S>,
        answer: Answer<S>,
    ) -> Result<(), CreateError>
    where
        S::Request: Send,
        S::Response: Send,
    {
        let mut server = served.server(self.node)?;
        let (hub, catalogue) = (Arc::clone(self.hub), Arc::clone(self.catalogue));
        self.tasks.spawn(async move {
            while let Some(Request { message, reply }) = server.next().await {
                let (image, own) = (hub.host.parameters(), hub.own.all());
                reply.send_soon(answer(&View { catalogue: &catalogue, image: &image, own: &own }, message));
            }
        });
        Ok(())
    }
}

/// Returns no values if one of the names is not declared, as rclcpp does.
fn get(view: &View<'_>, request: GetParametersRequest) -> GetParametersResponse {
    let found = view.find_all(&request.names).unwrap_or_default();
    GetParametersResponse { values: found.into_iter().map(|known| known.value(view.image)).collect() }
}

/// Returns the present types; a parameter without a value has no type.
fn types(view: &View<'_>, request: GetParameterTypesRequest) -> GetParameterTypesResponse {
    let found = view.find_all(&request.names).unwrap_or_default();
    GetParameterTypesResponse { types: found.into_iter().map(|known| known.value(view.image).r#type).collect() }
}

fn list(view: &View<'_>, request: ListParametersRequest) -> ListParametersResponse {
    ListParametersResponse { result: view.list(&request) }
}

fn describe(view: &View<'_>, request: DescribeParametersRequest) -> DescribeParametersResponse {
    let found = view.find_all(&request.names).unwrap_or_default();
    DescribeParametersResponse { descriptors: found.into_iter().map(|known| known.descriptor()).collect() }
}

#[cfg(test)]
mod tests {
    use super::super::fake;
    use super::super::own::OwnParameters;
    use super::*;

    #[test]
    fn one_unknown_name_leaves_the_whole_answer_empty() {
        let config = fake::config();
        let (catalogue, image) = (Catalogue::new(&config), fake::image(&config));
        let own = OwnParameters::default();
        own.declare_switch("use_sim_time", "a switch of the node");
        let own = own.all();
        let view = View { catalogue: &catalogue, image: &image, own: &own };
        let names = |names: &[&str]| -> Vec<String> { names.iter().map(|name| (*name).to_owned()).collect() };
        let good = names(&["x.max_velocity", "x.max_jerk", "x.profile", "use_sim_time"]);
        let bad = names(&["x.max_velocity", "x.max_speed"]);
        let values = |names| get(&view, GetParametersRequest { names }).values;
        let shown = values(good.clone());
        assert_eq!((shown[0].double_value, shown[2].string_value.as_str()), (1.0, "trapezoid"));
        assert_eq!((shown.len(), shown[1].r#type), (4, 0), "what is left out has no value");
        assert!(values(bad.clone()).is_empty());
        let listed = list(&view, ListParametersRequest::default()).result.names;
        assert!(listed.is_sorted() && listed.contains(&"use_sim_time".to_owned()), "among those of the machine");
        let top = list(&view, ListParametersRequest { depth: 1, ..Default::default() }).result;
        assert_eq!((top.names.as_slice(), top.prefixes.len()), (&["use_sim_time".to_owned()][..], 0));
        let types_of = |names| types(&view, GetParameterTypesRequest { names }).types;
        assert_eq!((types_of(good.clone()), types_of(bad.clone())), (vec![3, 0, 4, 1], vec![]));
        let described = |names| describe(&view, DescribeParametersRequest { names }).descriptors;
        assert_eq!((described(good).len(), described(bad).len()), (4, 0));
        let often = |times: usize| names(&vec!["x.max_velocity"; times]);
        assert_eq!(values(often(50)).len(), 50);
        assert!(values(often(listed.len() + 1)).is_empty(), "more names than there are");
    }
}

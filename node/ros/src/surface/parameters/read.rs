//! The services that only read: get_parameters, get_parameter_types, list_parameters, describe_parameters.

use super::catalogue::Catalogue;
use crate::layer::{CreateError, Node, Qos, Request, ServiceServer};
use crate::surface::hub::Hub;
use lineshaft_core::parameter::ParameterImage;
use lineshaft_msgs::Service;
use lineshaft_msgs::foreign::rcl_interfaces::srv::{
    DescribeParameters, DescribeParametersRequest, DescribeParametersResponse, GetParameterTypes,
    GetParameterTypesRequest, GetParameterTypesResponse, GetParameters, GetParametersRequest, GetParametersResponse,
    ListParameters, ListParametersRequest, ListParametersResponse,
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
    one.serve::<GetParameters>("~/get_parameters", get)?;
    one.serve::<GetParameterTypes>("~/get_parameter_types", types)?;
    one.serve::<ListParameters>("~/list_parameters", list)?;
    one.serve::<DescribeParameters>("~/describe_parameters", describe)
}

struct Services<'a> {
    node: &'a Node,
    hub: &'a Arc<Hub>,
    catalogue: &'a Arc<Catalogue>,
    tasks: &'a mut JoinSet<()>,
}

type Answer<S> = fn(&Catalogue, &ParameterImage, <S as Service>::Request) -> <S as Service>::Response;

impl Services<'_> {
    /// Answers a service from the newest image.
    fn serve<S: Service + 'static>(&mut self, name: &str, answer: Answer<S>) -> Result<(), CreateError>
    where
        S::Request: Send,
        S::Response: Send,
    {
        let mut server: ServiceServer<S> = self.node.service(name, Qos::PARAMETERS)?;
        let (hub, catalogue) = (Arc::clone(self.hub), Arc::clone(self.catalogue));
        self.tasks.spawn(async move {
            while let Some(Request { message, reply }) = server.next().await {
                reply.send_soon(answer(&catalogue, &hub.host.parameters(), message));
            }
        });
        Ok(())
    }
}

/// Nothing at all when one of the names is not declared, as rclcpp answers.
fn get(catalogue: &Catalogue, image: &ParameterImage, request: GetParametersRequest) -> GetParametersResponse {
    let found = catalogue.find_all(&request.names).unwrap_or_default();
    GetParametersResponse { values: found.into_iter().map(|declared| declared.message(image)).collect() }
}

/// The types of the values now: a parameter that is left out has none.
fn types(
    catalogue: &Catalogue,
    image: &ParameterImage,
    request: GetParameterTypesRequest,
) -> GetParameterTypesResponse {
    let found = catalogue.find_all(&request.names).unwrap_or_default();
    GetParameterTypesResponse { types: found.into_iter().map(|declared| declared.message(image).r#type).collect() }
}

fn list(catalogue: &Catalogue, _: &ParameterImage, request: ListParametersRequest) -> ListParametersResponse {
    ListParametersResponse { result: catalogue.list(&request) }
}

fn describe(
    catalogue: &Catalogue,
    _: &ParameterImage,
    request: DescribeParametersRequest,
) -> DescribeParametersResponse {
    let found = catalogue.find_all(&request.names).unwrap_or_default();
    DescribeParametersResponse { descriptors: found.into_iter().map(|declared| declared.descriptor()).collect() }
}

#[cfg(test)]
mod tests {
    use super::super::fake;
    use super::*;

    #[test]
    fn one_unknown_name_leaves_the_whole_answer_empty() {
        let config = fake::config();
        let (catalogue, image) = (Catalogue::new(&config), fake::image(&config));
        let names = |names: &[&str]| -> Vec<String> { names.iter().map(|name| (*name).to_owned()).collect() };
        let good = names(&["x.max_velocity", "x.max_jerk", "x.profile"]);
        let bad = names(&["x.max_velocity", "x.max_speed"]);
        let values = |names| get(&catalogue, &image, GetParametersRequest { names }).values;
        let shown = values(good.clone());
        assert_eq!((shown[0].double_value, shown[2].string_value.as_str()), (1.0, "trapezoid"));
        assert_eq!((shown.len(), shown[1].r#type), (3, 0), "what is left out has no value");
        assert!(values(bad.clone()).is_empty());
        let types_of = |names| types(&catalogue, &image, GetParameterTypesRequest { names }).types;
        assert_eq!((types_of(good.clone()), types_of(bad.clone())), (vec![3, 0, 4], vec![]));
        let described = |names| describe(&catalogue, &image, DescribeParametersRequest { names }).descriptors;
        assert_eq!((described(good).len(), described(bad).len()), (3, 0));
    }
}

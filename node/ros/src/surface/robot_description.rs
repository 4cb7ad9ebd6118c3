//! `robot_description`: URDF of the cell, for RViz and other tools that display the robot.

use super::hub::Hub;
use super::parameters::own::OwnParameter;
use super::table::{ROBOT_DESCRIPTION, ROBOT_DESCRIPTION_PARAMETER};
use super::urdf::published;
use crate::layer::{CreateError, Node};
use lineshaft_msgs::foreign::rcl_interfaces::msg::{ParameterDescriptor, ParameterType, ParameterValue};
use lineshaft_msgs::foreign::std_msgs::msg::String as Text;
use std::future::pending;
use std::sync::Arc;
use tokio::task::JoinSet;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let Some(urdf) = hub.host.robot_description() else { return Ok(()) };
    hub.own.declare(parameter(urdf));
    // A launch file may have set an override.
    let given = hub.own.get(ROBOT_DESCRIPTION_PARAMETER.name).map(|own| own.value.string_value);
    let text = published(given.as_deref().unwrap_or(urdf));
    hub.own.declare(parameter(&text));
    let publisher = ROBOT_DESCRIPTION.publisher(node)?;
    // This is the only sample of the publisher; readers that join later get it from the publisher.
    if let Err(error) = publisher.publish(&Text { data: text }) {
        tracing::error!("{error}");
    }
    tasks.spawn(async move {
        let _kept = publisher;
        pending::<()>().await;
    });
    Ok(())
}

fn parameter(urdf: &str) -> OwnParameter {
    let row = ROBOT_DESCRIPTION_PARAMETER;
    OwnParameter {
        descriptor: ParameterDescriptor {
            name: row.name.to_owned(),
            r#type: ParameterType::PARAMETER_STRING,
            description: row.text.to_owned(),
            read_only: row.read_only,
            ..ParameterDescriptor::default()
        },
        value: ParameterValue {
            r#type: ParameterType::PARAMETER_STRING,
            string_value: urdf.to_owned(),
            ..ParameterValue::default()
        },
        ..OwnParameter::default()
    }
}

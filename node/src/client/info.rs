//! Finds the kind of an axis (linear or rotary), and its displayed unit.
//!
//! Source   descriptions of parameters, which end in `Unit: mm.`: `max_velocity` is in SI, `amc.position_reference` in the unit of
//!          the axis

use super::Failure;
use super::session::Session;
use lineshaft_core::unit::{Dimension, ScaleKind, Unit};
use lineshaft_msgs::foreign::rcl_interfaces::srv::{DescribeParameters, DescribeParametersRequest};
use lineshaft_ros::layer::{Qos, ServiceClient};

/// Parameters whose descriptions have the units. Every axis has both.
const IN_SI: &str = "max_velocity";
const IN_AXIS_UNIT: &str = "amc.position_reference";

/// Kind and unit of an axis, if known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct AxisInfo {
    /// Linear or rotary.
    pub(super) kind: Option<ScaleKind>,
    /// Displayed unit.
    pub(super) unit: Option<Unit>,
}

/// Client that reads the kinds and units of axes.
pub(super) struct AxisInfos(ServiceClient<DescribeParameters>);

impl AxisInfos {
    pub(super) fn open(session: &Session) -> Result<Self, Failure> {
        session.service("describe_parameters", Qos::PARAMETERS).map(Self)
    }

    /// Returns kind and unit of an axis, or `None` if the node has no axis of this name.
    ///
    /// # Errors
    /// Returns an error if there is no answer.
    pub(super) async fn find(&mut self, session: &Session, axis: &str) -> Result<Option<AxisInfo>, Failure> {
        let names = Vec::from([IN_SI, IN_AXIS_UNIT].map(|key| format!("{axis}.{key}")));
        let request = DescribeParametersRequest { names };
        let response = session.ask(&mut self.0, &request).await?;
        // Unless there is an answer for each of them, none is declared, as in rclcpp.
        let [in_si, in_axis_unit] = response.descriptors.as_slice() else { return Ok(None) };
        Ok(Some(AxisInfo { kind: unit(&in_si.description).and_then(kind), unit: unit(&in_axis_unit.description) }))
    }

    /// Returns kind and unit of an axis.
    ///
    /// # Errors
    /// Returns an error if there is no answer or no such axis, or if its kind is unknown.
    pub(super) async fn of(&mut self, session: &Session, axis: &str) -> Result<(ScaleKind, Option<Unit>), Failure> {
        let Some(AxisInfo { kind, unit }) = self.find(session, axis).await? else { return Err(no_axis(session, axis)) };
        let unknown = || Failure::Failed(format!("{axis}: the node does not report whether it is linear or rotary"));
        Ok((kind.ok_or_else(unknown)?, unit))
    }
}

/// Returns the error for an axis that the node does not have.
pub(super) fn no_axis(session: &Session, axis: &str) -> Failure {
    Failure::Failed(format!("node {} has no axis `{axis}`; `lineshaft state` lists its axes", session.target()))
}

/// Returns the unit in a description.
fn unit(description: &str) -> Option<Unit> {
    let (_, rest) = description.split_once("Unit: ")?;
    Unit::parse(rest.split_once('.')?.0)
}

/// Returns the kind of axis whose velocity has this unit.
fn kind(of_velocity: Unit) -> Option<ScaleKind> {
    match of_velocity.dimension() {
        Dimension::Length(1) => Some(ScaleKind::Linear),
        Dimension::Angle(1) => Some(ScaleKind::Rotary),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_descriptions_show_kind_and_unit_of_the_axis() {
        let velocity = "Highest velocity; a goal that asks for more is refused. Unit: m/s. Takes effect at once.";
        assert_eq!(unit(velocity).and_then(kind), Some(ScaleKind::Linear));
        assert_eq!(unit("x Unit: rad/s. y").and_then(kind), Some(ScaleKind::Rotary));
        assert_eq!(unit("x Unit: mm. y"), Some(Unit::MILLIMETRE));
        assert_eq!(unit("x Unit: mm. y").and_then(kind), None);
        // A fraction as the unit of an axis is none of the known units.
        assert_eq!(unit("x Unit: 9000 * 0.1 mm. y"), None);
        assert_eq!(unit("no unit"), None);
    }
}

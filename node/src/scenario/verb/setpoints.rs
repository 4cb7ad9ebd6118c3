//! Verb `setpoints`: streamed setpoints of one cycle. `{axes: {x: 10 mm/s}}` is valid until the next one,
//! `{axes: {x: {velocity: 10 mm/s, duration: 50 ms}}}` for a time. A `duration` next to `axes` is the default of axes
//! without their own.

use super::{Effect, Ids, Reader, units};
use crate::document::Value;
use crate::scenario::moment::nanoseconds;
use crate::scenario::names::Names;
use crate::scenario::verb::amount::amount;
use lineshaft_core::command::{Setpoints, Source};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::request::{SetpointRequest, Units};
use lineshaft_core::signal::Directory;

/// Reads the arguments of `setpoints` in the format of a recording. Reports a problem if it returns `None`.
pub(crate) fn recorded_setpoints(
    arguments: &Value<'_>,
    source: Source,
    config: &MachineConfig,
    directory: &Directory,
) -> Option<Setpoints> {
    let reader = Reader {
        names: &Names { config, joints: None, backends: &[], directory, groups: &[], folder: None },
        ids: &mut Ids::default(),
        refused: None,
        recorded: false,
    };
    match reader.setpoints(arguments, source)? {
        Effect::Stream(setpoints) => Some(setpoints),
        // Without an expectation a refused request is a problem, which has been reported.
        _ => None,
    }
}

impl Reader<'_> {
    pub(super) fn setpoints(&self, value: &Value<'_>, source: Source) -> Option<Effect> {
        let mut map = value.map("setpoints")?;
        let axes = map.required("axes");
        let units = units(&mut map);
        let duration = map.optional("duration").map(|duration| nanoseconds(&duration));
        map.finish();
        let axes = axes?.entries()?;
        let requests: Vec<_> = axes.iter().map(|(axis, given)| self.setpoint(axis, given, units == Some(2))).collect();
        let (units, duration) = (units?, duration.map_or(Some(None), |ns| ns.map(Some))?);
        let requests: Vec<_> = requests.into_iter().collect::<Option<_>>()?;
        let requests = requests.into_iter().map(|r| SetpointRequest { duration: r.duration.or(duration), ..r });
        let set = Units::from_number(units)
            .and_then(|units| self.names.config.resolve_setpoints(source, units, &requests.collect::<Vec<_>>()));
        self.settle_as(value, set.map(Effect::Stream))
    }

    fn setpoint(&self, axis: &Value<'_>, given: &Value<'_>, in_increments: bool) -> Option<SetpointRequest> {
        let scale = self.scale(Some(axis));
        let axis = axis.text()?.to_owned();
        if !given.is_map() {
            let velocity = amount(given, 1, scale.as_ref(), in_increments)?;
            return Some(SetpointRequest { axis, velocity, duration: None });
        }
        let mut map = given.map("a setpoint")?;
        let (velocity, duration) = (map.required("velocity"), map.optional("duration"));
        map.finish();
        let duration = duration.map_or(Some(None), |duration| nanoseconds(&duration).map(Some));
        Some(SetpointRequest {
            axis,
            velocity: amount(&velocity?, 1, scale.as_ref(), in_increments)?,
            duration: duration?,
        })
    }
}

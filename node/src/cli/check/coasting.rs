//! Finds axes that coast after an error, as with the default of `error_reaction`.
//!
//! Source   MACS (ERRCOND 0 and 1)

use lineshaft_core::config::{AxisConfig, MachineConfig};

/// Maximum number of axes that are named; the others are counted.
const NAMED: usize = 8;

/// Returns one note about all axes that coast after an error, or `None`. An axis with a brake has its own warning.
pub(super) fn note(machine: &MachineConfig) -> Option<String> {
    let coasts = |axis: &&AxisConfig| {
        axis.drive.is_some() && axis.brake.is_none() && matches!(axis.parameters.error_reaction, 0 | 1)
    };
    let names: Vec<&str> = machine.axes.iter().filter(coasts).map(|axis| axis.name.as_str()).collect();
    let more = names.len().saturating_sub(NAMED);
    let and_more = if more > 0 { format!(" and {more} more") } else { String::new() };
    let verb = if names.len() == 1 { "coasts" } else { "coast" };
    let named: Vec<&str> = names.iter().copied().take(NAMED).collect();
    (!names.is_empty()).then(|| {
        format!(
            "on an error {}{and_more} {verb} without power (error_reaction 0, the default, or 1); error_reaction 2 stops with max_deceleration and \
             holds",
            named.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::Cell;

    fn noted(axes: &[String]) -> Option<String> {
        let text = format!(
            "lineshaft: 1\ncycle: 1 ms\nbackends: {{plant: {{type: sim}}}}\nio: {{b: {{type: do, backend: plant, address: 0}}}}\naxes:\n{}",
            axes.concat()
        );
        let cell = Cell::parse("c.yaml", text).unwrap_or_else(|problems| panic!("{problems}"));
        note(&cell.machine)
    }

    fn axis(name: &str, address: usize, keys: &str) -> String {
        format!(
            "  {name}: {{type: linear, scale: {{increments: 1000, per: 1 mm}}, drive: {{backend: plant, address: {address}}}, max_velocity: 1 m/s, \
             max_acceleration: 1 m/s^2, sim: {{model: ideal}}{keys}}}\n"
        )
    }

    /// ERRCOND 0 and 1 remove the power, 2 to 5 do not do so immediately. A virtual axis has no power.
    #[test]
    fn axes_that_coast_on_an_error_are_one_note() {
        let end = "without power (error_reaction 0, the default, or 1); error_reaction 2 stops with max_deceleration and holds";
        let virtual_axis =
            "  v: {type: linear, scale: {increments: 1000, per: 1 mm}, drive: virtual, max_velocity: 1 m/s, \
                            max_acceleration: 1 m/s^2}\n"
                .to_owned();
        let axes = [
            axis("x", 0, ""),
            axis("y", 1, ", error_reaction: 1"),
            axis("z", 2, ", error_reaction: 2"),
            axis("lift", 3, ", brake: {output: b}"),
            virtual_axis,
        ];
        assert_eq!(noted(&axes), Some(format!("on an error x, y coast {end}")));
        assert_eq!(noted(&axes[..1]), Some(format!("on an error x coasts {end}")));
        assert_eq!(noted(&axes[2..]), None);
        let many: Vec<String> = (0..10).map(|at| axis(&format!("a{at}"), at, "")).collect();
        assert_eq!(noted(&many), Some(format!("on an error a0, a1, a2, a3, a4, a5, a6, a7 and 2 more coast {end}")));
    }
}

//! `lineshaft check`.

use super::{CheckArgs, Exit, say};
use crate::cell::Cell;
use crate::scenario::Scenario;
use lineshaft_core::config::AxisConfig;

pub(super) fn check(args: &CheckArgs) -> Exit {
    let cell = match Cell::load(&args.cell) {
        Ok(cell) => cell,
        Err(problems) => {
            eprint!("{problems}");
            return Exit::Usage;
        }
    };
    say(&format_args!("{}: good: {}", args.cell.display(), summary(&cell)));
    for warning in warnings(&cell) {
        eprintln!("warning: {warning}");
    }
    let Some(path) = &args.scenario else { return Exit::Good };
    match Scenario::load(path, &cell) {
        Ok(scenario) => {
            say(&format_args!("{}: good: {}, {} cycles", path.display(), scenario.name(), scenario.cycles()));
            Exit::Good
        }
        Err(problems) => {
            eprint!("{problems}");
            Exit::Usage
        }
    }
}

/// What is no error and yet may not be what was meant.
pub(super) fn warnings(cell: &Cell) -> Vec<String> {
    let mut warnings = cell.robot.as_ref().map_or(Vec::new(), |robot| robot.warnings(&cell.machine));
    warnings.extend(cell.machine.endless_searches().map(|axis| {
        let name = &axis.name;
        format!(
            "{name}: without its switch homing goes on for ever; \
             give homing.max_distance, or min_position and max_position"
        )
    }));
    let coasts = |axis: &&AxisConfig| axis.brake.is_some() && matches!(axis.parameters.error_reaction, 0 | 1);
    warnings.extend(cell.machine.axes.iter().filter(coasts).map(|axis| {
        let (name, reaction) = (&axis.name, axis.parameters.error_reaction);
        format!(
            "{name}: error_reaction {reaction} takes the power before the brake has closed, and a hanging load drops; \
             2 and 3 stop and hold first"
        )
    }));
    warnings
}

/// What a cell is made of, in a few words.
pub(super) fn summary(cell: &Cell) -> String {
    let machine = &cell.machine;
    let counts = [
        (machine.axes.len(), "axis", "axes"),
        (machine.encoders.len(), "encoder", "encoders"),
        (machine.io.len(), "input or output", "inputs and outputs"),
        (machine.memory.len(), "memory cell", "memory cells"),
    ];
    let counts = counts.iter().filter(|(count, ..)| *count > 0);
    let counts: Vec<String> =
        counts.map(|(count, one, many)| format!("{count} {}", if *count == 1 { one } else { many })).collect();
    let counts = if counts.is_empty() { vec!["no axes".to_owned()] } else { counts };
    format!("{}; cycle {} ms", counts.join(", "), machine.cycle_ns as f64 / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn warned(keys: &str) -> Vec<String> {
        let text = format!(
            "lineshaft: 1\ncycle: 1 ms\nbackends: {{plant: {{type: sim}}}}\nio: {{b: {{type: do, backend: plant, address: 0}}}}\n\
             axes: {{x: {{drive: {{backend: plant, address: 0, interface: position}}, max_velocity: 1 m/s, \
             max_acceleration: 1 m/s^2, sim: {{model: ideal}}, {keys}}}}}\n"
        );
        warnings(&Cell::parse("c.yaml", text).unwrap())
    }

    const MM: &str = "type: linear, scale: {increments: 1000, per: 1 mm}";

    #[test]
    fn a_search_without_an_end_is_warned_of() {
        let expected = "x: without its switch homing goes on for ever; \
                        give homing.max_distance, or min_position and max_position";
        for keys in ["homing: {method: 7}", "homing: {method: 1}, max_position: 1 m", "homing: {home_type: 0}"] {
            assert_eq!(warned(&format!("{MM}, {keys}")), [expected], "{keys}");
        }
        for keys in [
            "homing: {method: 33}",
            "homing: {method: 35}",
            "homing: {method: 7, max_distance: 1 m}",
            "homing: {method: 7}, min_position: 0 m, max_position: 1 m",
            "unit: mm",
        ] {
            assert_eq!(warned(&format!("{MM}, {keys}")), [""; 0], "{keys}");
        }
    }

    #[test]
    fn a_brake_that_closes_too_late_is_warned_of() {
        for (reaction, count) in [(0, 1), (1, 1), (2, 0), (3, 0), (4, 0), (5, 0)] {
            let told = warned(&format!("{MM}, brake: {{output: b}}, error_reaction: {reaction}"));
            assert_eq!(told.len(), count, "{reaction}");
            let begin = format!("x: error_reaction {reaction} takes the power before the brake has closed");
            assert!(told.iter().all(|told| told.starts_with(&begin)), "{told:?}");
        }
        assert_eq!(warned(&format!("{MM}, error_reaction: 0")), [""; 0]);
    }
}

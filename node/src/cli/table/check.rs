//! `lineshaft table check`.

use super::args::CheckArgs;
use super::{Exit, Failure, motion};
use crate::cell::Cell;
use crate::cli::{complain, say};
use crate::table::limits::{Demand, binding, demands};
use crate::table::motion::{Extremes, Motion, Points};
use lineshaft_core::config::AxisConfig;
use lineshaft_core::law::Peak;
use lineshaft_core::unit::Scale;
use std::path::Path;

/// Derivatives in the order in which they are told, with their units.
const RATES: [(&str, &str, u8); 3] =
    [("velocity", "inc/inc", 1), ("acceleration", "inc/inc^2", 2), ("jerk", "inc/inc^3", 3)];

pub(super) fn check(args: &CheckArgs) -> Result<Exit, Failure> {
    let motion = motion(&args.source)?;
    let axis = match (&args.cell, &args.axis) {
        (Some(cell), Some(axis)) => Some((cell, find(cell, axis)?)),
        _ => None,
    };
    let extremes = motion.extremes();
    say(&format_args!("{}: {}", args.source.file.display(), summary(&motion)));
    derivatives(&extremes, args.master_speed).iter().for_each(|line| say(line));
    jumps(&extremes).iter().for_each(|line| say(line));
    if let Motion::Points(points) = &motion {
        between(points).iter().for_each(|line| say(line));
    }
    let Some((cell, axis)) = axis else { return Ok(Exit::Good) };
    let demands = demands(&extremes, &axis.parameters);
    let at = args.master_speed.map_or(String::new(), |speed| format!(" at a master speed of {} inc/s", digits(speed)));
    say(&format_args!("axis {} of {}{at}", axis.name, cell.display()));
    let mut exceeded = Vec::new();
    for demand in &demands {
        let verdict = args.master_speed.map(|speed| (speed, demand.is_met(speed)));
        say(&line(demand, verdict, &axis.scale));
        exceeded.extend(verdict.filter(|(_, is_met)| !is_met).map(|_| demand.key));
    }
    if axis.parameters.max_jerk.is_none() {
        say(&"  max_jerk          not given: any jerk is permitted");
    }
    say(&fastest(&demands));
    if exceeded.is_empty() {
        return Ok(Exit::Good);
    }
    complain(&format!("the table exceeds {} of axis {}", exceeded.join(", "), axis.name));
    Ok(Exit::Usage)
}

/// What lies between points, and what that leaves open.
fn between(points: &Points) -> Vec<String> {
    let mut lines = if points.table.spline().is_some() {
        vec![
            "  of the spline through the points, as an axis on that cam follows it; the values are whole increments"
                .to_owned(),
        ]
    } else {
        let (acceleration, jerk) = points.rounding();
        let (acceleration, jerk) = (digits(acceleration), digits(jerk));
        vec![
            "  velocity is that of the straight lines, acceleration and jerk are divided differences of the points"
                .to_owned(),
            format!("  of which whole increments alone may make {acceleration} inc/inc^2 and {jerk} inc/inc^3"),
        ]
    };
    lines.extend(points.refused_by_functions().map(|why| format!("  function interpolators do not take it: {why}")));
    lines
}

fn find(path: &Path, wanted: &str) -> Result<AxisConfig, Failure> {
    let cell = Cell::load(path).map_err(|problems| Failure::Problems(problems.to_string()))?;
    let found = cell.machine.find_axis(wanted).map(|(_, axis)| axis.clone());
    found.map_err(|error| Failure::Sentence(format!("{}: {error}", path.display())))
}

fn summary(motion: &Motion) -> String {
    let what = match motion {
        Motion::Planned(description) => {
            let (count, form) = (description.segments.len(), description.form.name());
            format!(
                "{count} segment{}, {} points of form {form}",
                if count == 1 { "" } else { "s" },
                description.points
            )
        }
        Motion::Points(points) => format!("{} points of form {}", points.table.len(), points.table.form().name()),
    };
    let round = if motion.is_cyclic() { "cyclic" } else { "once" };
    format!("{what}, {round}; period {} inc of the master, way {} inc", motion.length(), motion.end())
}

/// The largest of each, and what that is at a speed of the master.
fn derivatives(extremes: &Extremes, speed: Option<f64>) -> Vec<String> {
    let bend = if extremes.deceleration.value > extremes.acceleration.value {
        extremes.deceleration
    } else {
        extremes.acceleration
    };
    let tell = |((name, unit, order), Peak { value, at }): ((&str, &str, u8), Peak)| {
        let rate =
            |speed: f64| format!(": {}", Scale::increments().format_rate(value * speed.powi(order.into()), order));
        let found = format!("{} {unit}", digits(value));
        format!("  largest {name:<13} {found:<24} at {}{}", place(at), speed.map_or(String::new(), rate))
    };
    RATES.into_iter().zip([extremes.velocity, bend, extremes.jerk]).map(tell).collect()
}

fn jumps(extremes: &Extremes) -> Vec<String> {
    let jump = |jump: &lineshaft_core::law::Jump| {
        let name = if jump.derivative == 1 { "velocity" } else { "acceleration" };
        format!("  {name} jumps at {} from {} to {}", place(jump.at), digits(jump.before), digits(jump.after))
    };
    extremes.jumps.iter().map(jump).collect()
}

/// A limit, what is asked of it at a speed, and where.
fn line(demand: &Demand, verdict: Option<(f64, bool)>, scale: &Scale) -> String {
    let rate = |rate: f64| scale.format_rate(rate, demand.order);
    let limit = if scale.is_in_increments() {
        rate(demand.limit)
    } else {
        format!("{} ({})", rate(demand.limit), Scale::increments().format_rate(demand.limit, demand.order))
    };
    let head = format!("  {:<17} {limit}", demand.key);
    let Some((speed, is_met)) = verdict else { return head };
    let verdict = if is_met { "ok" } else { "exceeded" };
    let at = place(demand.peak.at);
    match demand.at(speed) {
        needed if needed.is_infinite() => format!("{head}: {verdict}, a jump at {at}"),
        needed => format!("{head}: {verdict}, {} at {at}", rate(needed)),
    }
}

fn fastest(demands: &[Demand]) -> String {
    let head = "  fastest master speed";
    match binding(demands).map(|bound| (bound.fastest(), bound)) {
        Some((0.0, bound)) => {
            format!("{head}: none, {} permits no jump, which there is at {}", bound.key, place(bound.peak.at))
        }
        Some((speed, bound)) if speed.is_finite() => {
            format!("{head}: {} inc/s, then {} binds at {}", digits(speed), bound.key, place(bound.peak.at))
        }
        _ => format!("{head}: any, nothing moves"),
    }
}

/// Six digits of a value that was computed.
fn digits(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if !(1e-4..1e12).contains(&size) => {
            let text = format!("{value:.5e}");
            match text.split_once('e') {
                Some((front, power)) => format!("{}e{power}", trimmed(front)),
                None => text,
            }
        }
        size => {
            let behind = (5 - size.log10().floor() as i32).clamp(0, 9) as usize;
            trimmed(&format!("{value:.behind$}")).to_owned()
        }
    }
}

/// A place of the master, to a thousandth of an increment.
fn place(at: f64) -> String {
    trimmed(&format!("{at:.3}")).to_owned()
}

/// A decimal without zeros at its end.
fn trimmed(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_six_digits_and_places_three_behind_the_point() {
        assert_eq!(digits(0.0), "0");
        assert_eq!(digits(2.010_93), "2.01093");
        assert_eq!(digits(-1_234.567_89), "-1234.57");
        assert_eq!(digits(0.000_9), "0.0009");
        assert_eq!(digits(6.0e-10), "6e-10");
        assert_eq!(digits(40_000.0), "40000");
        assert_eq!(digits(1_234_567.8), "1234568");
        assert_eq!((place(8500.0), place(1_690.598_92)), ("8500".to_owned(), "1690.599".to_owned()));
    }
}

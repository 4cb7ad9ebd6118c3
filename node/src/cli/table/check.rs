//! `lineshaft table check`.

mod machine;
mod speed;

use self::machine::{Machine, Master};
use self::speed::master_speed;
use super::args::CheckArgs;
use super::{Exit, Failure, motion};
use crate::cli::{complain, say};
use crate::table::limits::{Demand, binding, demands};
use crate::table::motion::{Extremes, Motion, Points};
use lineshaft_core::law::Peak;
use lineshaft_core::unit::Scale;

/// Derivatives in the order in which they are printed, with their units.
const RATES: [(&str, &str, u8); 3] =
    [("velocity", "inc/inc", 1), ("acceleration", "inc/inc^2", 2), ("jerk", "inc/inc^3", 3)];

pub(super) fn check(args: &CheckArgs) -> Result<Exit, Failure> {
    let motion = motion(&args.source)?;
    let machine = args.cell.as_deref().map(Machine::load).transpose()?;
    let of = |name: &Option<String>| machine.as_ref().zip(name.clone());
    let axis = of(&args.axis).map(|(machine, name)| machine.axis(&name).map(|axis| (machine, axis))).transpose()?;
    let leader = of(&args.leader).map(|(machine, name)| machine.leader(&name)).transpose()?;
    let leader = leader.as_ref();
    let speed = master_speed(args.master_speed.as_deref(), leader).map_err(Failure::Sentence)?;
    let extremes = motion.extremes();
    say(&format_args!("{}: {}", args.source.file.display(), summary(&motion)));
    derivatives(&extremes, speed).iter().for_each(|line| say(line));
    jumps(&extremes).iter().for_each(|line| say(line));
    match &motion {
        Motion::Points(points) => between(points).iter().for_each(|line| say(line)),
        Motion::Planned(description) => {
            let line = machine.as_ref().and_then(|machine| machine.tables_with(description, &args.source.file));
            line.iter().for_each(|line| say(line));
        }
    }
    let Some((machine, axis)) = axis else { return Ok(Exit::Good) };
    let demands = demands(&extremes, &axis.parameters);
    let at = speed.map_or(String::new(), |speed| at(speed, leader, args.master_speed.is_none()));
    say(&format_args!("axis {} of {}{at}", axis.name, machine.file()));
    let mut exceeded = Vec::new();
    for demand in &demands {
        let verdict = speed.map(|speed| (speed, demand.is_met(speed)));
        say(&line(demand, verdict, &axis.scale));
        exceeded.extend(verdict.filter(|(_, is_met)| !is_met).map(|_| demand.key));
    }
    if axis.parameters.max_jerk.is_none() {
        say(&"  max_jerk          not given: any jerk is permitted");
    }
    say(&fastest(&demands, leader));
    if let (Some(leader), None) = (leader, speed) {
        say(&format_args!(
            "  {} has no max_velocity: --master-speed gives a speed for which the limits are checked",
            leader.name
        ));
    }
    if exceeded.is_empty() {
        return Ok(Exit::Good);
    }
    complain(&format!("the table exceeds {} of axis {}", exceeded.join(", "), axis.name));
    Ok(Exit::Usage)
}

/// Returns the speed of the master for which the limits are checked, as text.
fn at(speed: f64, leader: Option<&Master>, is_of_leader: bool) -> String {
    let from = match leader {
        Some(leader) if is_of_leader => format!(", max_velocity of {}", leader.name),
        _ => String::new(),
    };
    format!(" at a master speed of {}{from}", in_both_units(speed, leader))
}

/// Formats a speed of the master in increments, and in the unit of the leader, if it has one.
fn in_both_units(speed: f64, leader: Option<&Master>) -> String {
    let own = leader.and_then(|leader| leader.scale).filter(|scale| !scale.is_in_increments());
    let own = own.map_or(String::new(), |scale| format!(" ({})", scale.format_rate(speed, 1)));
    format!("{} inc/s{own}", digits(speed))
}

/// Returns lines about the curve between points, and about values that cannot be determined from it.
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

/// Returns the maximum of each derivative, and its value at a speed of the master.
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

/// Returns a line with a limit, the required value at a speed, and its position.
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

fn fastest(demands: &[Demand], leader: Option<&Master>) -> String {
    let head = "  fastest master speed";
    match binding(demands).map(|bound| (bound.fastest(), bound)) {
        Some((0.0, bound)) => {
            format!("{head}: none, {} permits no jump, which there is at {}", bound.key, place(bound.peak.at))
        }
        Some((speed, bound)) if speed.is_finite() => {
            format!("{head}: {}, then {} binds at {}", in_both_units(speed, leader), bound.key, place(bound.peak.at))
        }
        _ => format!("{head}: any, nothing moves"),
    }
}

/// Formats a calculated value with six digits.
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

/// Formats a position of the master, to a thousandth of an increment.
fn place(at: f64) -> String {
    trimmed(&format!("{at:.3}")).to_owned()
}

/// Removes trailing zeros of a decimal.
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

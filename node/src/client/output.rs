//! Prints the output of a command.

use crate::output;
use crate::recording::clean::clean;
use indicatif::ProgressBar;
use lineshaft_core::unit::{Fraction, Quantity, ScaleKind, Unit};
use std::io::IsTerminal;

/// Name of the node of the built-in demo, and of cells that give no other name.
pub(super) const DEFAULT: &str = "/lineshaft";

/// Prints a line to standard output. Returns false if its reader has ended, or if it cannot be written, which the command line reports.
pub(super) fn print(text: &str) -> bool {
    output::print_line(&text)
}

/// Whether standard output is a terminal that can move its cursor.
pub(super) fn is_screen() -> bool {
    output::columns().is_some() && std::env::var_os("TERM").is_none_or(|term| term != "dumb")
}

/// A line with the progress, on a terminal only.
pub(super) struct Progress(Option<ProgressBar>);

impl Progress {
    pub(super) fn new() -> Self {
        let is_terminal = std::io::stderr().is_terminal() && std::env::var_os("TERM").is_none_or(|term| term != "dumb");
        Self(is_terminal.then(ProgressBar::new_spinner))
    }

    pub(super) fn show(&self, text: &str) {
        if let Some(bar) = &self.0 {
            bar.set_message(clean(text).into_owned());
            bar.tick();
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}

/// Replaces the service that resets errors in a message of the node of this full name by the command that does it. A part of the message
/// that begins with the name of one of the axes, such as `x: `, is about that axis.
pub(super) fn with_commands(message: &str, axes: &[impl AsRef<str>], node: &str) -> String {
    let node = node_option(node);
    let mut axis = match axes {
        [axis] => axis.as_ref(),
        _ => "AXIS",
    };
    let mut parts = Vec::new();
    for part in message.split("; ") {
        let is_named = |axis: &&str| part.strip_prefix(*axis).is_some_and(|rest| rest.starts_with(": "));
        axis = axes.iter().map(AsRef::as_ref).find(is_named).unwrap_or(axis);
        let part = part.replace("reset_errors of all", &format!("`lineshaft reset --all{node}`"));
        let reset = format!("`lineshaft reset {axis}{node}`");
        parts.push(part.replace("~/reset_errors", &reset).replace("reset_errors", &reset));
    }
    parts.join("; ")
}

/// Returns the option that selects the node of this full name, with a blank before it; empty for the default node.
pub(super) fn node_option(node: &str) -> String {
    if node == DEFAULT { String::new() } else { format!(" --node {node}") }
}

/// Returns the SI unit of the derivative of this order (0 position, 1 velocity) of an axis; empty if its kind is
/// unknown.
pub(super) fn si_unit(kind: Option<ScaleKind>, order: u8) -> String {
    kind.map(|kind| kind.dimension(order).si_unit().to_string()).unwrap_or_default()
}

/// Formats a position in SI, and in the unit of the axis if it differs: `0.05 m (50 mm)`.
pub(super) fn position_text(value: f64, kind: Option<ScaleKind>, unit: Option<Unit>) -> String {
    let text = format!("{} {}", short(value), si_unit(kind, 0)).trim_end().to_owned();
    match in_unit(value, kind, unit) {
        Some(own) => format!("{text} ({own})"),
        None => text,
    }
}

/// Formats a position in the unit of the axis, if that is known and is not the SI unit.
pub(super) fn in_unit(value: f64, kind: Option<ScaleKind>, unit: Option<Unit>) -> Option<String> {
    let (dimension, unit) = (kind?.dimension(0), unit?);
    if unit.dimension() != dimension || unit == dimension.si_unit() {
        return None;
    }
    let one = Quantity::new(Fraction::from(1), unit).si();
    Some(format!("{} {unit}", short(value / one)))
}

/// Formats a number with at most nine decimals, without trailing zeros.
pub(super) fn short(value: f64) -> String {
    let text = format!("{value:.9}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text.as_str() };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_shown_in_si_and_in_the_unit_of_the_axis() {
        let linear = Some(ScaleKind::Linear);
        assert_eq!(position_text(0.05, linear, Some(Unit::MILLIMETRE)), "0.05 m (50 mm)");
        assert_eq!(position_text(0.05, linear, Some(Unit::METRE)), "0.05 m");
        assert_eq!(position_text(0.05, linear, None), "0.05 m");
        let quarter = std::f64::consts::FRAC_PI_2;
        assert_eq!(position_text(quarter, Some(ScaleKind::Rotary), Some(Unit::DEGREE)), "1.570796327 rad (90 deg)");
        assert_eq!(position_text(0.05, None, None), "0.05");
        // A unit of another kind contradicts the kind of the axis and is not shown.
        assert_eq!(position_text(0.05, linear, Some(Unit::DEGREE)), "0.05 m");
    }

    #[test]
    fn message_of_the_node_names_the_command_that_resets_errors() {
        let refused = "x: the axis stands in ERROR_STOP; reset_errors first";
        let named = "x: the axis stands in ERROR_STOP; `lineshaft reset x` first";
        assert_eq!(with_commands(refused, &["x"], DEFAULT), named);
        assert_eq!(with_commands("then reset_errors of all.", &["x"], DEFAULT), "then `lineshaft reset --all`.");
        assert_eq!(with_commands("x: target 900 mm", &["x"], DEFAULT), "x: target 900 mm");
    }

    #[test]
    fn command_that_resets_errors_names_the_axis_of_the_message() {
        let commands = |message| with_commands(message, &["x", "y", "x2"], DEFAULT);
        assert_eq!(commands("locked; ~/reset_errors unlocks"), "locked; `lineshaft reset AXIS` unlocks");
        assert_eq!(commands("z: reset_errors first"), "z: `lineshaft reset AXIS` first");
        assert_eq!(
            commands("x2: locked; reset_errors first; y: reset_errors first"),
            "x2: locked; `lineshaft reset x2` first; y: `lineshaft reset y` first"
        );
    }

    #[test]
    fn command_that_resets_errors_names_the_node_unless_it_is_the_default_one() {
        let commands = |message| with_commands(message, &["x"], "/second");
        assert_eq!(commands("x: reset_errors first"), "x: `lineshaft reset x --node /second` first");
        assert_eq!(commands("then reset_errors of all."), "then `lineshaft reset --all --node /second`.");
    }

    #[test]
    fn numbers_have_no_trailing_zeros_and_no_negative_zero() {
        assert_eq!([0.0, -0.0, 1.0, -1e-12, 0.125, 100.0].map(short), ["0", "0", "1", "0", "0.125", "100"]);
        assert_eq!(short(f64::NAN), "NaN");
    }
}

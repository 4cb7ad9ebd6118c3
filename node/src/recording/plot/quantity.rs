//! Physical quantities of signals, and the units in which panels show them. Signals of one quantity and unit share a
//! panel.

/// Quantities, in the order of their panels.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum SignalQuantity {
    Position,
    Velocity,
    Acceleration,
    Jerk,
    /// Difference of positions, much smaller than the positions.
    Error,
    Effort,
    /// Raw counts, with their own origin.
    Count,
    Fraction,
    Voltage,
    Other(String),
}

impl SignalQuantity {
    /// Returns the quantity of a signal by its name and unit.
    pub(super) fn of(name: &str, unit: &str) -> Self {
        let mut parts = name.rsplit(['.', '/']);
        let (last, before) = (parts.next().unwrap_or_default(), parts.next().unwrap_or_default());
        let ending = last.rsplit('_').next().unwrap_or_default();
        match (before, last) {
            // The command of a drive is in counts of the drive.
            ("output", "position") => Self::Count,
            (_, "count") if before != "latch" => Self::Count,
            ("phase", "master") => Self::Other("phase shift left".to_owned()),
            ("regulator", "output") => Self::Other("controller output".to_owned()),
            (_, "position" | "positions" | "master") => Self::Position,
            (_, "velocity" | "velocities") => Self::Velocity,
            (_, "acceleration") => Self::Acceleration,
            (_, "jerk") => Self::Jerk,
            (_, "effort") => Self::Effort,
            (_, "fraction") => Self::Fraction,
            (_, "correction") => Self::Error,
            ("sync" | "regulator" | "marker", "error") => Self::Error,
            _ if last.contains("error") && !unit.is_empty() => Self::Error,
            _ => match (ending, unit) {
                ("position", _) => Self::Position,
                ("velocity", _) => Self::Velocity,
                ("acceleration", _) => Self::Acceleration,
                ("error", _) if last != "error" => Self::Error,
                (_, "V" | "mV") => Self::Voltage,
                (_, unit) if unit.ends_with("/s") => Self::Velocity,
                (_, unit) if unit.ends_with("/s^2") => Self::Acceleration,
                (_, unit) if unit.ends_with("/s^3") => Self::Jerk,
                // Memory cells have names without a dot or slash; they share one panel per unit.
                _ if !name.contains(['.', '/']) => Self::Other("value".to_owned()),
                _ => Self::Other(last.to_owned()),
            },
        }
    }

    /// Returns the label of the panel.
    pub(super) fn label(&self) -> &str {
        match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
            Self::Error => "error",
            Self::Effort => "effort",
            Self::Count => "count",
            Self::Fraction => "fraction",
            Self::Voltage => "voltage",
            Self::Other(name) => name,
        }
    }
}

/// Unit in which a panel is shown, with the factor from the unit of its signals.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ShownUnit {
    pub(super) factor: f64,
    /// Text on the axis; `1` if there is no unit.
    pub(super) text: String,
}

/// Unit symbols that may have a prefix, with their minimum and maximum power of ten.
const WITH_PREFIX: [(&str, i32, i32); 9] = [
    ("m", -9, 3),
    ("rad", -6, 0),
    ("s", -9, 0),
    ("V", -6, 3),
    ("A", -6, 3),
    ("N", -6, 6),
    ("Nm", -6, 6),
    ("W", -6, 6),
    ("Hz", -3, 9),
];
const PREFIXES: [(i32, &str); 7] = [(-9, "n"), (-6, "\u{b5}"), (-3, "m"), (0, ""), (3, "k"), (6, "M"), (9, "G")];
/// Units of length and angle that a cell may use, as multiples of a metre and of a radian.
const LENGTHS: [(&str, f64); 5] = [("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("um", 1e-6), ("in", 0.0254)];
const ANGLES: [(&str, f64); 4] =
    [("rad", 1.0), ("mrad", 1e-3), ("deg", std::f64::consts::PI / 180.0), ("rev", 2.0 * std::f64::consts::PI)];

/// Splits a unit into symbol and rest: `mm/s` into `mm` and `/s`.
fn parts(unit: &str) -> (&str, &str) {
    unit.find(['/', '*', '^']).map_or((unit, ""), |place| unit.split_at(place))
}

/// Returns the units of length or of angle, if the unit is one of them.
fn family(unit: &str) -> Option<&'static [(&'static str, f64)]> {
    let symbol = parts(unit).0;
    [&LENGTHS[..], &ANGLES[..]].into_iter().find(|family| family.iter().any(|(known, _)| *known == symbol))
}

/// Returns the unit in which to show values in `unit`, with their factor. If `unit` is in m or rad only because the
/// cell does not name a unit, it is the unit of an axis with the same dimension, so that a figure does not mix rad/s
/// with rev/s.
pub(super) fn unified(unit: &str, all: &[&str]) -> (f64, String) {
    let (symbol, rest) = parts(unit);
    let kept = (1.0, unit.to_owned());
    let Some(family) = family(unit).filter(|_| ["m", "rad"].contains(&symbol)) else { return kept };
    let scale = |symbol: &str| family.iter().find(|(known, _)| *known == symbol).map(|(_, scale)| *scale);
    let other = all.iter().map(|unit| parts(unit).0).find(|other| *other != symbol && scale(other).is_some());
    match other.and_then(|other| Some((other, scale(other)?))) {
        Some((other, scale)) => (1.0 / scale, format!("{other}{rest}")),
        None => kept,
    }
}

/// Returns the unit with the prefix, or the power of ten, that makes values up to `largest` easy to read.
pub(super) fn with_prefix(unit: &str, largest: f64) -> ShownUnit {
    let written = |unit: &str| match unit {
        "" => "1".to_owned(),
        unit => unit.replace("^2", "\u{b2}").replace("^3", "\u{b3}").replace('*', "\u{b7}"),
    };
    if largest == 0.0 || (1e-2..1e5).contains(&largest) {
        return ShownUnit { factor: 1.0, text: written(unit) };
    }
    let (symbol, rest) = parts(unit);
    let known = WITH_PREFIX.iter().find_map(|&(base, least, most)| {
        let prefix = symbol.strip_suffix(base)?.replace('u', "\u{b5}");
        let power = PREFIXES.iter().find(|(_, known)| *known == prefix)?.0;
        Some((base, power, least, most))
    });
    let thousands = |value: f64| (value.log10() / 3.0 + 1e-9).floor() as i32 * 3;
    if let Some((base, power, least, most)) = known.filter(|_| !rest.starts_with('^')) {
        let wanted = (thousands(largest) + power).clamp(least, most);
        let factor = 10_f64.powi(power - wanted);
        let prefix = PREFIXES.iter().find(|(known, _)| *known == wanted).map_or("", |(_, prefix)| prefix);
        if (1e-2..1e5).contains(&(largest * factor)) {
            return ShownUnit { factor, text: written(&format!("{prefix}{base}{rest}")) };
        }
    }
    let power = thousands(largest);
    let text = if unit.is_empty() { power_of_ten(power) } else { format!("{} {}", power_of_ten(power), written(unit)) };
    ShownUnit { factor: 10_f64.powi(-power), text }
}

/// Returns `10^n` with superscript digits.
fn power_of_ten(exponent: i32) -> String {
    let digits: Vec<char> =
        "\u{2070}\u{b9}\u{b2}\u{b3}\u{2074}\u{2075}\u{2076}\u{2077}\u{2078}\u{2079}".chars().collect();
    let raised = |letter: char| letter.to_digit(10).map_or('\u{207b}', |digit| digits[digit as usize]);
    format!("10{}", exponent.to_string().chars().map(raised).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_no_positions_and_codes_are_no_errors() {
        for name in ["x.following_error", "x.sync.error", "x.regulator.error", "x.marker.error", "x.marker.correction"]
        {
            assert_eq!(SignalQuantity::of(name, "mm"), SignalQuantity::Error, "{name}");
        }
        assert_eq!(SignalQuantity::of("x.error", ""), SignalQuantity::Other("error".to_owned()));
    }

    #[test]
    fn commanded_and_actual_values_are_one_quantity() {
        for (name, quantity) in [
            ("x.command.position", SignalQuantity::Position),
            ("x.actual.position", SignalQuantity::Position),
            ("x.sync.master", SignalQuantity::Position),
            ("joint_states/x.position", SignalQuantity::Position),
            ("x.command_velocity", SignalQuantity::Velocity),
            ("x.output.velocity", SignalQuantity::Velocity),
            ("x.command.jerk", SignalQuantity::Jerk),
            ("x.actual.count", SignalQuantity::Count),
            ("x.output.position", SignalQuantity::Count),
            ("x.actual.effort", SignalQuantity::Effort),
        ] {
            assert_eq!(SignalQuantity::of(name, ""), quantity, "{name}");
        }
    }

    #[test]
    fn bare_names_go_by_their_unit_and_a_part_of_a_shift_is_no_position() {
        assert_eq!(SignalQuantity::of("pressure", "V"), SignalQuantity::Voltage);
        assert_eq!(SignalQuantity::of("feed", "").label(), "value");
        assert_eq!(SignalQuantity::of("x.turns", "").label(), "turns");
        assert_eq!(SignalQuantity::of("slide", "mm/s"), SignalQuantity::Velocity);
        assert_eq!(SignalQuantity::of("x.phase.master", "").label(), "phase shift left");
    }

    fn shown(unit: &str, largest: f64) -> (f64, String) {
        let ShownUnit { factor, text } = with_prefix(unit, largest);
        (factor, text)
    }

    #[test]
    fn small_and_large_values_get_a_prefix() {
        assert_eq!(shown("m", 0.004), (1e3, "mm".to_owned()));
        assert_eq!(shown("m/s", 0.003), (1e3, "mm/s".to_owned()));
        assert_eq!(shown("mm/s^2", 4e6), (1e-6, "km/s\u{b2}".to_owned()));
        assert_eq!(shown("mm", 0.001), (1e3, "\u{b5}m".to_owned()));
        assert_eq!(shown("mm", 120.0), (1.0, "mm".to_owned()));
    }

    #[test]
    fn units_without_prefix_get_a_power_of_ten_and_no_unit_is_1() {
        assert_eq!(shown("inc/s", 4.2e7).1, "10\u{2076} inc/s");
        assert_eq!(shown("inc/inc^3", 2e-6).1, "10\u{207b}\u{2076} inc/inc\u{b3}");
        assert_eq!(shown("", 0.7), (1.0, "1".to_owned()));
        assert_eq!(shown("", 3e6), (1e-6, "10\u{2076}".to_owned()));
        assert_eq!(shown("rev/s", 3.0).1, "rev/s");
    }

    #[test]
    fn rad_becomes_the_unit_of_the_axes_of_the_figure() {
        let (factor, unit) = unified("rad/s", &["rad/s", "rev/s", "1"]);
        assert!((factor - 0.5 / std::f64::consts::PI).abs() < 1e-15);
        assert_eq!(unit, "rev/s");
        assert_eq!(unified("m", &["mm/s"]), (1000.0, "mm".to_owned()));
        assert_eq!(unified("m", &["deg"]), (1.0, "m".to_owned()));
        assert_eq!(unified("deg", &["rev/s"]), (1.0, "deg".to_owned()));
    }
}

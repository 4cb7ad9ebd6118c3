//! What a signal means, judged by its name and unit: signals of one meaning share a panel.

/// The meanings in the order of their panels.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Meaning {
    Position,
    Velocity,
    Acceleration,
    Jerk,
    /// Differences of positions: much smaller than what they are differences of.
    Error,
    Effort,
    /// Raw counts, which have an origin of their own.
    Count,
    Fraction,
    Voltage,
    Other(String),
}

impl Meaning {
    pub(super) fn of(name: &str, unit: &str) -> Self {
        let mut parts = name.rsplit(['.', '/']);
        let (last, before) = (parts.next().unwrap_or_default(), parts.next().unwrap_or_default());
        match last {
            // What a drive is asked for is in its counts.
            "position" if before == "output" => Self::Count,
            "position" | "positions" | "master" => Self::Position,
            "velocity" | "velocities" => Self::Velocity,
            "acceleration" => Self::Acceleration,
            "jerk" => Self::Jerk,
            "effort" => Self::Effort,
            "fraction" => Self::Fraction,
            "count" if before != "latch" => Self::Count,
            "correction" => Self::Error,
            "error" if ["sync", "regulator", "marker"].contains(&before) => Self::Error,
            _ if last.contains("error") && !unit.is_empty() => Self::Error,
            _ => Self::of_field(last, unit),
        }
    }

    /// Fields as `command_velocity` of a message.
    fn of_field(last: &str, unit: &str) -> Self {
        let ending = last.rsplit('_').next().unwrap_or_default();
        match (ending, unit) {
            ("position", _) => Self::Position,
            ("velocity", _) => Self::Velocity,
            ("acceleration", _) => Self::Acceleration,
            ("error", _) if last != "error" => Self::Error,
            (_, "V" | "mV") => Self::Voltage,
            (_, unit) if unit.ends_with("/s") => Self::Velocity,
            (_, unit) if unit.ends_with("/s^2") => Self::Acceleration,
            (_, unit) if unit.ends_with("/s^3") => Self::Jerk,
            _ => Self::Other(last.to_owned()),
        }
    }

    /// The label of its panel.
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

    /// Names without a meaning of their own, as those of memory cells, share one panel for each unit.
    pub(super) fn shared(self, name: &str) -> Self {
        match self {
            Self::Other(_) if !name.contains(['.', '/']) => Self::Other("value".to_owned()),
            meaning => meaning,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_no_positions_and_codes_are_no_errors() {
        let of = |name: &str, unit: &str| Meaning::of(name, unit).shared(name);
        for name in ["x.following_error", "x.sync.error", "x.regulator.error", "x.marker.error", "x.marker.correction"]
        {
            assert_eq!(of(name, "mm"), Meaning::Error, "{name}");
        }
        assert_eq!(of("x.error", ""), Meaning::Other("error".to_owned()));
        assert_eq!(of("machine.error", ""), Meaning::Other("error".to_owned()));
    }

    #[test]
    fn commanded_and_actual_values_mean_the_same() {
        for (name, meaning) in [
            ("x.command.position", Meaning::Position),
            ("x.actual.position", Meaning::Position),
            ("x.sync.master", Meaning::Position),
            ("joint_states/x.position", Meaning::Position),
            ("x.command_velocity", Meaning::Velocity),
            ("x.output.velocity", Meaning::Velocity),
            ("x.command.jerk", Meaning::Jerk),
            ("x.actual.count", Meaning::Count),
            ("x.output.position", Meaning::Count),
            ("x.actual.effort", Meaning::Effort),
        ] {
            assert_eq!(Meaning::of(name, ""), meaning, "{name}");
        }
    }

    #[test]
    fn bare_names_go_by_their_unit() {
        assert_eq!(Meaning::of("pressure", "V").shared("pressure"), Meaning::Voltage);
        assert_eq!(Meaning::of("feed", "").shared("feed"), Meaning::Other("value".to_owned()));
        assert_eq!(Meaning::of("x.turns", "").shared("x.turns"), Meaning::Other("turns".to_owned()));
        assert_eq!(Meaning::of("slide", "mm/s").shared("slide"), Meaning::Velocity);
    }
}

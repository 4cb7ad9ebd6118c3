//! Tolerances of signals.
//!
//! Law      a pattern is compared with the names of signals and their aliases. If several match, the last one applies.
//!          Its unit must be that of the axis, if the attached cell defines the unit
//! Refuses  negative values, values outside of the range of the signals, and a length together with an angle if the
//!          cell does not define which of them the signal is

use super::units::Units;
use crate::recording::clean::clean;
use crate::recording::series::topics::{Measure, names_measure};
use crate::recording::series::{SelectError, alias, no_match, pattern};
use globset::GlobMatcher;
use lineshaft_core::unit::{Dimension, Quantity, ScaleKind, excerpt, fraction_to_f64, parse_decimal};
use std::str::FromStr;

/// Name for the tolerance of times instead of a signal.
const TIME: &str = "time";
/// Maximum number of names in a message.
const MAX_LISTED: usize = 40;

/// Permitted dimensions of a tolerance.
const DIMENSIONS: [Dimension; 8] = [
    Dimension::Length(0),
    Dimension::Length(1),
    Dimension::Length(2),
    Dimension::Angle(0),
    Dimension::Angle(1),
    Dimension::Angle(2),
    Dimension::Force,
    Dimension::Torque,
];

/// A tolerance `SIGNAL=VALUE`.
#[derive(Clone, Debug)]
pub struct Tolerance {
    /// Text as given.
    text: String,
    pattern: String,
    /// `None` for times.
    matcher: Option<GlobMatcher>,
    /// Value in SI.
    value: f64,
    /// `None` for a number without unit, which fits every signal.
    dimension: Option<Dimension>,
}

impl FromStr for Tolerance {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Some((pattern, value)) = text.rsplit_once('=') else {
            return Err("SIGNAL=VALUE is expected, such as `x.position=10 um`".to_owned());
        };
        let (pattern, value) = (pattern.trim(), value.trim());
        let matcher =
            if pattern == TIME { None } else { Some(self::pattern(pattern).map_err(|error| error.to_string())?) };
        let dimensions = if matcher.is_none() { &[Dimension::Time][..] } else { &DIMENSIONS };
        let (number, dimension) = match parse_decimal(value) {
            Ok(number) => (fraction_to_f64(&number), None),
            Err(_) => {
                let quantity = Quantity::parse(value, dimensions)
                    .map_err(|error| error.hint().map_or(error.to_string(), |hint| format!("{error}, {hint}")))?;
                (quantity.si(), Some(quantity.unit().dimension()))
            }
        };
        if number < 0.0 {
            return Err(format!("the tolerance is `{}`; 0 and above is allowed", excerpt(value)));
        }
        Ok(Self { text: text.to_owned(), pattern: pattern.to_owned(), matcher, value: number, dimension })
    }
}

impl Tolerance {
    fn matches(&self, name: &str) -> bool {
        let Some(matcher) = &self.matcher else { return false };
        matcher.is_match(name) || alias(name).is_some_and(|alias| matcher.is_match(alias))
    }

    /// Whether the signal has values of this dimension. `kind` is that of its axis, if known.
    fn fits(&self, name: &str, kind: Option<ScaleKind>) -> bool {
        match (self.dimension, names_measure(name)) {
            (_, Measure::Steps) => false,
            (None, _) => true,
            (Some(Dimension::Length(given)), Measure::Order(order)) => {
                given == order && kind != Some(ScaleKind::Rotary)
            }
            (Some(Dimension::Angle(given)), Measure::Order(order)) => given == order && kind != Some(ScaleKind::Linear),
            // A drive reports the force of its axis or the torque of its motor; the cell does not define which.
            (Some(Dimension::Force | Dimension::Torque), Measure::Effort) => true,
            _ => false,
        }
    }

    /// Whether it names exactly this signal, without a pattern.
    fn is_exact(&self, name: &str) -> bool {
        self.pattern == name || alias(name).is_some_and(|alias| alias == self.pattern)
    }

    /// Returns the kind of axis that its unit belongs to.
    fn kind(&self) -> Option<ScaleKind> {
        match self.dimension {
            Some(Dimension::Length(_)) => Some(ScaleKind::Linear),
            Some(Dimension::Angle(_)) => Some(ScaleKind::Rotary),
            _ => None,
        }
    }
}

/// Reason why tolerances do not fit the signals.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ToleranceError {
    /// No signal matches.
    #[error("--tolerance {text}: {error}; there are {names}")]
    NoSignal {
        /// Text as given.
        text: String,
        /// Error with the suggested name.
        error: SelectError,
        /// Names of the signals.
        names: String,
    },
    /// The signals have another dimension.
    #[error("--tolerance {text}: none of the signals that it names has values of this kind; {first} is {is}")]
    Kind {
        /// Text as given.
        text: String,
        /// First of these signals.
        first: String,
        /// Dimension of that signal.
        is: &'static str,
    },
    /// A length and an angle are given for one signal.
    #[error(
        "--tolerance {one} and --tolerance {other} are of different kinds, and no attached cell tells which of both {name} is; \
         give {name} one of its own, behind them"
    )]
    Either {
        /// Text of the first tolerance.
        one: String,
        /// Text of the second tolerance.
        other: String,
        /// Name of the signal.
        name: String,
    },
}

/// All tolerances of a comparison.
#[derive(Clone, Debug)]
pub(super) struct Tolerances<'t> {
    list: &'t [Tolerance],
    units: &'t Units,
}

impl<'t> Tolerances<'t> {
    /// Refuses tolerances that fit no signal, and two of different dimensions for one signal.
    pub(super) fn new(list: &'t [Tolerance], names: &[&str], units: &'t Units) -> Result<Self, ToleranceError> {
        for tolerance in list.iter().filter(|tolerance| tolerance.matcher.is_some()) {
            let matched: Vec<&str> = names.iter().copied().filter(|name| tolerance.matches(name)).collect();
            let text = excerpt(&tolerance.text);
            let Some(first) = matched.first() else {
                let known =
                    names.iter().map(|name| (*name).to_owned()).chain(names.iter().filter_map(|name| alias(name)));
                let known: Vec<String> = known.map(|name| clean(&name).into_owned()).collect();
                let error = no_match(&tolerance.pattern, known.iter().map(String::as_str));
                return Err(ToleranceError::NoSignal { text, error, names: listed(names) });
            };
            if !matched.iter().any(|name| tolerance.fits(name, units.kind(name))) {
                let is = match names_measure(first) {
                    Measure::Order(order) if let Some(kind) = units.kind(first) => kind.dimension(order).article(),
                    Measure::Order(0) => "a position",
                    Measure::Order(1) => "a velocity",
                    Measure::Order(_) => "an acceleration",
                    Measure::Effort => "a force or a torque",
                    Measure::Steps => "compared value by value",
                };
                return Err(ToleranceError::Kind { text, first: clean(first).into_owned(), is });
            }
        }
        let tolerances = Self { list, units };
        names.iter().try_for_each(|name| tolerances.check_kind(name))?;
        Ok(tolerances)
    }

    /// Refuses a length together with an angle if the cell does not define which of them the signal is.
    fn check_kind(&self, name: &str) -> Result<(), ToleranceError> {
        let mut last: Option<&Tolerance> = None;
        for tolerance in self.fitting(name) {
            let kind = tolerance.kind();
            if let Some(last) = last.filter(|last| kind.is_some() && last.kind() != kind) {
                let [one, other] = [tolerance, last].map(|tolerance| excerpt(&tolerance.text));
                return Err(ToleranceError::Either { one, other, name: clean(name).into_owned() });
            }
            if kind.is_none() || tolerance.is_exact(name) {
                break;
            }
            last = Some(tolerance);
        }
        Ok(())
    }

    /// Returns the tolerances of a signal, the last one first.
    fn fitting<'s>(&'s self, name: &'s str) -> impl Iterator<Item = &'t Tolerance> + 's {
        let kind = self.units.kind(name);
        self.list.iter().rev().filter(move |tolerance| tolerance.matches(name) && tolerance.fits(name, kind))
    }

    /// Returns the tolerance of a signal, in SI.
    pub(super) fn of(&self, name: &str) -> f64 {
        self.fitting(name).next().map_or(0.0, |tolerance| tolerance.value)
    }

    /// Returns the tolerance of times, in ns.
    pub(super) fn time_ns(&self) -> u64 {
        let last = self.list.iter().rev().find(|tolerance| tolerance.matcher.is_none());
        // The cast saturates; the rounding error is far below a sample.
        last.map_or(0, |tolerance| (tolerance.value * 1e9).round() as u64)
    }
}

fn listed(names: &[&str]) -> String {
    let more = names.len().saturating_sub(MAX_LISTED);
    let list = names.iter().take(MAX_LISTED).map(|name| clean(name)).collect::<Vec<_>>().join(", ");
    if more > 0 { format!("{list} and {more} more") } else { list }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAMES: [&str; 7] = [
        "x.state",
        "x.error",
        "x.command.position",
        "x.actual.position",
        "x.actual.velocity",
        "x.actual.effort",
        "x.sync.error",
    ];

    fn tolerances(texts: &[&str]) -> Vec<Tolerance> {
        texts.iter().map(|text| text.parse().unwrap()).collect()
    }

    fn values(texts: &[&str]) -> [f64; 7] {
        let list = tolerances(texts);
        let units = Units::default();
        let tolerances = Tolerances::new(&list, &NAMES, &units).unwrap();
        NAMES.map(|name| tolerances.of(name))
    }

    #[track_caller]
    fn refused(text: &str) -> String {
        Tolerances::new(&tolerances(&[text]), &NAMES, &Units::default()).unwrap_err().to_string()
    }

    #[test]
    fn names_patterns_and_aliases_choose_signals_that_have_such_values() {
        assert_eq!(values(&[]), [0.0; 7]);
        assert_eq!(values(&["x.actual.position=0.5"]), [0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0]);
        assert_eq!(values(&["x.position=10 um"]), [0.0, 0.0, 0.0, 1e-5, 0.0, 0.0, 0.0]);
        assert_eq!(values(&["x.command_position=10 um"]), [0.0, 0.0, 1e-5, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(values(&["x.sync_error=1 mm"]), [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1e-3]);
        assert_eq!(values(&["*=1 mm", "*=5 mm/s", "*=2 N"]), [0.0, 0.0, 1e-3, 1e-3, 5e-3, 2.0, 1e-3]);
        assert_eq!(
            values(&["*=1", "x.position=2", "x.*velocity=180 deg/s"]),
            [0.0, 0.0, 1.0, 2.0, std::f64::consts::PI, 1.0, 1.0]
        );
    }

    #[test]
    fn the_last_one_holds() {
        assert_eq!(values(&["x.position=2", "*=1"])[3], 1.0);
        let list = tolerances(&["time=1", "time=50 ms", "*=3"]);
        assert_eq!(Tolerances::new(&list, &NAMES, &Units::default()).unwrap().time_ns(), 50_000_000);
    }

    /// Returns the tolerances of a linear and a rotary axis.
    fn of_both(texts: &[&str], units: &Units) -> Result<[f64; 4], ToleranceError> {
        let names = ["x.actual.position", "x.following_error", "t.actual.position", "t.actual.velocity"];
        let list = tolerances(texts);
        let tolerances = Tolerances::new(&list, &names, units)?;
        Ok(names.map(|name| tolerances.of(name)))
    }

    #[test]
    fn a_unit_is_for_axes_of_its_kind() {
        let units = Units::from([("x", ScaleKind::Linear), ("t", ScaleKind::Rotary)]);
        let degree = std::f64::consts::PI / 180.0;
        for both in [["*.position=10 um", "*.position=1 deg"], ["*.position=1 deg", "*.position=10 um"]] {
            assert_eq!(of_both(&both, &units), Ok([1e-5, 0.0, degree, 0.0]));
        }
        assert_eq!(of_both(&["*=1 mm", "*=180 deg/s"], &units), Ok([1e-3, 1e-3, 0.0, std::f64::consts::PI]));
        let said = of_both(&["x.*=1 deg"], &units).unwrap_err().to_string();
        assert!(
            said.ends_with("none of the signals that it names has values of this kind; x.actual.position is a length")
        );
        let said = of_both(&["t.position=1 mm"], &units).unwrap_err().to_string();
        assert!(said.ends_with("; t.actual.position is an angle"), "{said}");
    }

    #[test]
    fn without_a_cell_length_and_angle_together_are_refused() {
        let none = Units::default();
        let said = of_both(&["*.position=10 um", "*.position=1 deg"], &none).unwrap_err().to_string();
        assert_eq!(
            said,
            "--tolerance *.position=10 um and --tolerance *.position=1 deg are of different kinds, and no attached cell tells \
             which of both x.actual.position is; give x.actual.position one of its own, behind them"
        );
        let degree = std::f64::consts::PI / 180.0;
        let values = of_both(&["*.position=10 um", "t.position=1 deg"], &none);
        assert_eq!(values, Ok([1e-5, 0.0, degree, 0.0]));
        assert!(of_both(&["t.position=1 deg", "*.position=10 um"], &none).is_err());
        assert_eq!(of_both(&["*.position=10 um", "*.position=1 deg", "*.position=2"], &none), Ok([2.0, 0.0, 2.0, 0.0]));
        assert_eq!(of_both(&["*=1 mm", "*=1 deg/s"], &none), Ok([1e-3, 1e-3, 1e-3, degree]));
    }

    #[test]
    fn what_fits_no_signal_is_refused() {
        let said = refused("x.positon=1");
        assert_eq!(
            said,
            "--tolerance x.positon=1: no signal matches `x.positon`, did you mean `x.position`?; there are x.state, x.error, \
             x.command.position, x.actual.position, x.actual.velocity, x.actual.effort, x.sync.error"
        );
        assert_eq!(
            refused("x.position=1 mm/s"),
            "--tolerance x.position=1 mm/s: none of the signals that it names has values of this kind; x.actual.position \
             is a position"
        );
        assert!(refused("x.state=1").ends_with("x.state is compared value by value"));
    }

    #[test]
    fn what_is_no_tolerance_is_refused() {
        let refused = |text: &str| text.parse::<Tolerance>().unwrap_err();
        assert_eq!(refused("x.position"), "SIGNAL=VALUE is expected, such as `x.position=10 um`");
        assert_eq!(refused("x.position=-1 mm"), "the tolerance is `-1 mm`; 0 and above is allowed");
        assert_eq!(refused("x.position=10um"), "`10um` has no blank between number and unit, write `10 um`");
        assert_eq!(refused("x.position=NaN"), "`NaN` is not a number");
        assert_eq!(refused("time=5 mm"), "`5 mm` is a length; a time such as `5 s` is expected");
        assert_eq!(
            refused("x.position=5 inc"),
            "`5 inc` is a number of increments; a length such as `5 mm` is expected"
        );
        assert!(refused("x.[=1").starts_with("`x.[` is no pattern: "));
    }
}

//! Conditions on signals and parameters, for `when` and `expect`.
//!
//! Law      is: equal, or |value - given| <= within | not: unequal | min <= value <= max | all, any: of several
//!          value = signal, signal AND mask, or signal + plus - minus, exact for integers
//! Reads    the board and the parameters in force at the end of a cycle
//! Source   contract section 5

use super::names::Names;
use super::ruler::{self, ValueFormat};
use crate::document::{Map, Value};
use lineshaft_core::machine::Machine;
use lineshaft_core::parameter::Storage;
use lineshaft_core::signal::{Measure, Signal, Type, Value as Number};
use lineshaft_core::unit::excerpt;
use std::slice::Iter;

/// A signal, masked bits of a signal, a sum of signals, or a parameter.
#[derive(Clone, Debug)]
pub(super) struct Probe {
    name: String,
    source: Source,
    pub ruler: ValueFormat,
}

#[derive(Clone, Copy, Debug)]
enum Source {
    Signal(Signal, Type),
    /// Masked bits of a signal.
    Masked(Signal, Type, i64),
    /// The first signal + the second one - the third one.
    Sum((Signal, Type), Option<(Signal, Type)>, Option<(Signal, Type)>),
    /// Axis or machine, and index of the row.
    Parameter(u16, u16),
}

impl Probe {
    /// Reads keys `signal` with `plus`, `minus` and `mask`, or `parameter`.
    pub(super) fn read(map: &mut Map<'_>, names: &Names<'_>) -> Option<Self> {
        if let Some(parameter) = map.optional("parameter") {
            let others = ["signal", "plus", "minus", "mask"].map(|key| map.optional(key));
            if let Some(other) = others.into_iter().flatten().next() {
                let sentence = format!("parameter and {} stand side by side; one of them is expected", other.label());
                other.refuse(sentence, None);
                return None;
            }
            return Self::of_parameter(&parameter, names);
        }
        let signal = map.required("signal");
        let [plus, minus, mask] = ["plus", "minus", "mask"].map(|key| map.optional(key));
        let signal = signal.and_then(|value| names.signal(&value));
        let others = [plus, minus].map(|value| value.map(|value| (names.signal(&value), value)));
        let mask = mask.map(|value| (value.integer(1..=i64::MAX), value));
        let signal = signal?;
        let entry = names.directory.entry(signal);
        let ruler = ValueFormat::of(names, signal);
        let probe = Self { name: entry.name.clone(), source: Source::Signal(signal, entry.kind), ruler };
        match (mask, others) {
            (None, [None, None]) => Some(probe),
            (None, others) => probe.sum(others, names),
            (Some((mask, value)), [None, None]) => probe.masked(mask?, &value),
            (Some((_, value)), _) => {
                let sentence = "mask stands together with plus or minus; one of them is expected";
                value.refuse(sentence, None);
                None
            }
        }
    }

    fn of_parameter(value: &Value<'_>, names: &Names<'_>) -> Option<Self> {
        let name = value.text()?;
        let (axis, place, row, scale) = names.parameter(name, value)?;
        if let Storage::Signal(signal) = row.storage {
            let object = name.split_once('.').map_or("", |(object, _)| object);
            let sentence = format!("{} is shown by a signal", excerpt(name));
            value.refuse(sentence, Some(format!("write `signal: {object}.{signal}`")));
            return None;
        }
        let ruler = ValueFormat::of_parameter(row, scale);
        Some(Self { name: name.to_owned(), source: Source::Parameter(axis, place), ruler })
    }

    /// Applies a mask, permitted for an integer without unit.
    fn masked(self, mask: i64, value: &Value<'_>) -> Option<Self> {
        let Source::Signal(signal, kind) = self.source else { return None };
        if !matches!(kind, Type::Int | Type::Word) || self.ruler.measure != Measure::None || self.ruler.is_code {
            let sentence = format!("mask is for words and whole numbers without a unit; {} is none", self.name);
            value.refuse(sentence, None);
            return None;
        }
        let name = format!("{} & {mask:#x}", self.name);
        let ruler = ValueFormat { mask: Some(mask), ..self.ruler };
        Some(Self { name, source: Source::Masked(signal, kind, mask), ruler })
    }

    /// Adds `plus` and subtracts `minus`, signals in the same unit.
    fn sum(self, others: [Option<(Option<Signal>, Value<'_>)>; 2], names: &Names<'_>) -> Option<Self> {
        let Source::Signal(signal, kind) = self.source else { return None };
        let mut sum = self;
        let mut has_no_unit = names.is_number_in_memory(signal);
        let mut terms = [None, None];
        for ((term, word), other) in terms.iter_mut().zip(["plus", "minus"]).zip(others) {
            let Some((other, value)) = other else { continue };
            let other = other?;
            let theirs = names.directory.entry(other);
            sum.ruler = sum.common_ruler(other, &value, names, has_no_unit)?;
            has_no_unit &= names.is_number_in_memory(other);
            sum.name = format!("{} {word} {}", sum.name, theirs.name);
            *term = Some((other, theirs.kind));
        }
        let [plus, minus] = terms;
        Some(Self { source: Source::Sum((signal, kind), plus, minus), ..sum })
    }

    /// Returns the ruler of the sum with another signal. A memory cell has no unit: its number is in the unit of the
    /// signal to which it is added. `has_no_unit`: all terms so far are memory cells.
    fn common_ruler(
        &self,
        other: Signal,
        value: &Value<'_>,
        names: &Names<'_>,
        has_no_unit: bool,
    ) -> Option<ValueFormat> {
        let (mine, theirs) = (&self.ruler, ValueFormat::of(names, other));
        let entry = names.directory.entry(other);
        let is_real = mine.kind == Type::Real || entry.kind == Type::Real;
        let kind = if is_real { Type::Real } else { Type::Int };
        let plain = ValueFormat {
            kind,
            measure: mine.measure,
            scale: mine.scale,
            is_code: false,
            mask: None,
            row: None,
            range: ruler::ALL_WHOLE,
            in_f64: false,
        };
        if theirs.measure != mine.measure {
            if has_no_unit {
                return Some(ValueFormat { measure: theirs.measure, scale: theirs.scale, ..plain });
            }
            if names.is_number_in_memory(other) {
                return Some(plain);
            }
            let unit = |ruler: &ValueFormat| match ruler.measure.unit() {
                "" => "no unit",
                unit => unit,
            };
            let (mine, theirs) = (unit(mine), unit(&theirs));
            let sentence = format!("{} has {mine} and {} has {theirs}", self.name, entry.name);
            let what = if value.label() == "plus" { "sum" } else { "difference" };
            value.refuse(format!("{sentence}; a {what} needs the same unit"), None);
            return None;
        }
        // A length has no meaning for a sum of two scales, so that only increments remain.
        Some(ValueFormat { scale: mine.scale.filter(|_| mine.scale == theirs.scale), ..plain })
    }

    /// Reads key `within`; refuses it for values without an order.
    pub(super) fn read_tolerance(&self, within: &Value<'_>) -> Option<Number> {
        if self.is_ordered(within) { self.ruler.read_tolerance(within) } else { None }
    }

    /// Whether the values have an order; otherwise the key that needs one is a problem.
    fn is_ordered(&self, key: &Value<'_>) -> bool {
        let is_ordered = self.ruler.is_ordered();
        if !is_ordered {
            let what = if self.ruler.mask.is_some() { "bits of a mask" } else { "a bit or an enum" };
            key.refuse(format!("{} has no meaning for {what}; is and not have", key.label()), None);
        }
        is_ordered
    }

    /// Returns the name for a report.
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// Returns the current value.
    pub(super) fn value(&self, machine: &Machine) -> Number {
        let value = |(signal, kind)| machine.board().value(signal, kind);
        match self.source {
            Source::Signal(signal, kind) => value((signal, kind)),
            Source::Masked(signal, kind, mask) => match value((signal, kind)) {
                Number::Int(word) => Number::Int(word & mask),
                real => real,
            },
            Source::Sum(first, plus, minus) => sum(value(first), plus.map(value), minus.map(value)),
            Source::Parameter(axis, row) => ruler::number(machine.parameter(axis, row)),
        }
    }
}

/// Calculates first + plus - minus: exact for integers, and saturated once at the end.
fn sum(first: Number, plus: Option<Number>, minus: Option<Number>) -> Number {
    let (plus, minus) = (plus.unwrap_or(Number::Int(0)), minus.unwrap_or(Number::Int(0)));
    match (first, plus, minus) {
        (Number::Int(first), Number::Int(plus), Number::Int(minus)) => {
            let sum = i128::from(first) + i128::from(plus) - i128::from(minus);
            Number::Int(sum.clamp(i64::MIN.into(), i64::MAX.into()) as i64)
        }
        _ => Number::Real(first.to_f64() + plus.to_f64() - minus.to_f64()),
    }
}

/// Check of a value.
#[derive(Clone, Copy, Debug)]
pub(super) enum Check {
    Is { value: Number, within: Option<Number> },
    Not(Number),
    Range { min: Option<Number>, max: Option<Number> },
}

impl Check {
    /// Reads `is` with `within`, `not`, `min` and `max`.
    fn read(map: &mut Map<'_>, probe: Option<&Probe>) -> Option<Self> {
        let [is, within, not, min, max] = ["is", "within", "not", "min", "max"].map(|key| map.optional(key));
        let ordered = [&within, &min, &max].into_iter().flatten().next();
        let probe = probe?;
        let ruler = &probe.ruler;
        // The problem names the value that is checked: "x.state is `STANDSTIL`".
        let [is, not] = [is, not].map(|value| value.map(|value| value.called(probe.name.clone())));
        if ordered.is_some_and(|key| !probe.is_ordered(key)) {
            return None;
        }
        let read = |value: Value<'_>| ruler.read(&value);
        let check = match (is, not, min, max) {
            (Some(is), None, None, None) => {
                let tolerance = within.as_ref().map(|within| ruler.read_tolerance(within));
                let value = read(is)?;
                return Some(Self::Is { value, within: tolerance.map_or(Some(None), |read| read.map(Some))? });
            }
            (None, Some(not), None, None) => read(not).map(Self::Not),
            (None, None, None, None) => {
                map.refuse(format!("nothing is asked of {}; is, not, min or max is expected", probe.name), None);
                None
            }
            (None, None, min, max) => {
                let (low, high) = (min.as_ref().map(|min| ruler.read(min)), max.map(read));
                let (low, high) = (low.map_or(Some(None), |n| n.map(Some))?, high.map_or(Some(None), |n| n.map(Some))?);
                if let (Some(low), Some(high), Some(min)) = (low, high, min)
                    && low.to_f64() > high.to_f64()
                {
                    min.refuse(format!("min {} exceeds max {}", ruler.text(low), ruler.text(high)), None);
                    return None;
                }
                Some(Self::Range { min: low, max: high })
            }
            _ => {
                map.refuse("one of is, not, or min with max is expected, not several", None);
                return None;
            }
        };
        if let Some(within) = within {
            within.refuse("within belongs to is", None);
            return None;
        }
        check
    }

    /// Whether a value passes the check.
    pub(super) fn holds(&self, number: Number) -> bool {
        match *self {
            Self::Is { value, within: None } => same(number, value),
            Self::Is { value, within: Some(within) } => same(number, value) || at_most(distance(number, value), within),
            Self::Not(value) => !same(number, value),
            Self::Range { min, max } => {
                min.is_none_or(|min| at_most(min, number)) && max.is_none_or(|max| at_most(number, max))
            }
        }
    }

    /// Returns the distance of a value from passing, to find the closest one; `None` if distance has no meaning.
    pub(super) fn miss(&self, number: Number) -> Option<f64> {
        let far = match *self {
            Self::Is { value, .. } => distance(number, value).to_f64(),
            Self::Not(_) => return None,
            Self::Range { min, max } => {
                let below = min.map_or(0.0, |min| min.to_f64() - number.to_f64());
                let above = max.map_or(0.0, |max| number.to_f64() - max.to_f64());
                below.max(above)
            }
        };
        Some(far).filter(|far| !far.is_nan())
    }

    /// Returns the check as text.
    pub(super) fn text(&self, ruler: &ValueFormat) -> String {
        let text = |number: &Number| ruler.text(*number);
        match self {
            Self::Is { value, within: None } => text(value),
            Self::Is { value, within: Some(within) } => format!("{} within {}", text(value), text(within)),
            Self::Not(value) => format!("anything but {}", text(value)),
            Self::Range { min: Some(min), max: Some(max) } => format!("{} to {}", text(min), text(max)),
            Self::Range { min: Some(min), .. } => format!("at least {}", text(min)),
            Self::Range { max, .. } => format!("at most {}", max.as_ref().map_or_else(String::new, text)),
        }
    }
}

/// Whether two values are equal; two unset values are equal.
fn same(value: Number, other: Number) -> bool {
    value == other || value.to_f64().is_nan() && other.to_f64().is_nan()
}

/// Whether `value` is at most `other`; false if one of them is NaN.
fn at_most(value: Number, other: Number) -> bool {
    match (value, other) {
        (Number::Int(value), Number::Int(other)) => value <= other,
        _ => value.to_f64() <= other.to_f64(),
    }
}

fn distance(value: Number, other: Number) -> Number {
    match (value, other) {
        (Number::Int(value), Number::Int(other)) => Number::Int(value.saturating_sub(other).saturating_abs()),
        _ => Number::Real((value.to_f64() - other.to_f64()).abs()),
    }
}

/// A condition.
#[derive(Clone, Debug)]
pub(super) enum Predicate {
    Test { probe: Box<Probe>, check: Check },
    All(Vec<Predicate>),
    Any(Vec<Predicate>),
}

impl Predicate {
    /// Reads the keys of a condition from a mapping that may have other keys.
    pub(super) fn read(map: &mut Map<'_>, names: &Names<'_>) -> Option<Self> {
        let (all, any) = (map.optional("all"), map.optional("any"));
        match (all, any) {
            (None, None) => {
                let probe = Probe::read(map, names);
                let check = Check::read(map, probe.as_ref());
                Some(Self::Test { probe: Box::new(probe?), check: check? })
            }
            (Some(all), None) => read_several(&all, names).map(Self::All),
            (None, Some(any)) => read_several(&any, names).map(Self::Any),
            (Some(_), Some(any)) => {
                any.refuse("all and any stand side by side; put one into the other", None);
                None
            }
        }
    }

    /// Adds the value of each of its tests, in their order.
    pub(super) fn look(&self, machine: &Machine, values: &mut Vec<Number>) {
        match self {
            Self::Test { probe, .. } => values.push(probe.value(machine)),
            Self::All(parts) | Self::Any(parts) => parts.iter().for_each(|part| part.look(machine, values)),
        }
    }

    /// Whether the condition is true for the values of [`Predicate::look`].
    pub(super) fn holds(&self, values: &[Number]) -> bool {
        self.holds_next(&mut values.iter())
    }

    /// Each part takes its values, even if earlier parts have determined the result.
    fn holds_next(&self, values: &mut Iter<'_, Number>) -> bool {
        match self {
            Self::Test { check, .. } => values.next().is_some_and(|value| check.holds(*value)),
            Self::All(parts) => parts.iter().filter(|part| !part.holds_next(values)).count() == 0,
            Self::Any(parts) => parts.iter().filter(|part| part.holds_next(values)).count() > 0,
        }
    }

    /// Formats the values of [`Predicate::look`]: `x.state is DISABLED`.
    pub(super) fn found(&self, values: &[Number]) -> String {
        let mut tests = Vec::new();
        self.tests(&mut tests);
        let text = |(probe, value): (&Probe, &Number)| format!("{} is {}", probe.name, probe.ruler.text(*value));
        tests.into_iter().zip(values).map(text).collect::<Vec<_>>().join(", ")
    }

    fn tests<'p>(&'p self, tests: &mut Vec<&'p Probe>) {
        match self {
            Self::Test { probe, .. } => tests.push(probe),
            Self::All(parts) | Self::Any(parts) => parts.iter().for_each(|part| part.tests(tests)),
        }
    }

    /// Formats the expected value alone, or each part with its signal.
    pub(super) fn expected(&self) -> String {
        match self {
            Self::Test { probe, check } => check.text(&probe.ruler),
            Self::All(parts) => format!("all of ({})", list(parts)),
            Self::Any(parts) => format!("any of ({})", list(parts)),
        }
    }

    /// Formats the condition with the signal: `x.state STANDSTILL`.
    pub(super) fn text(&self) -> String {
        match self {
            Self::Test { probe, .. } => format!("{} {}", probe.name, self.expected()),
            Self::All(_) | Self::Any(_) => self.expected(),
        }
    }
}

fn list(parts: &[Predicate]) -> String {
    parts.iter().map(Predicate::text).collect::<Vec<_>>().join("; ")
}

fn read_several(value: &Value<'_>, names: &Names<'_>) -> Option<Vec<Predicate>> {
    let items = value.list()?;
    if items.is_empty() {
        value.refuse(format!("{} has no conditions; one or more are expected", value.label()), None);
        return None;
    }
    let parts: Vec<_> = items
        .iter()
        .map(|item| {
            let mut map = item.map("a condition")?;
            let part = Predicate::read(&mut map, names);
            map.finish();
            part
        })
        .collect();
    // Collected after all parts were read, so that all problems are reported.
    parts.into_iter().collect()
}

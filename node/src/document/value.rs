//! Reads one value with a type.

use super::bare::BareNumber;
#[cfg(test)]
use super::observer::{ExpectedKind, Note};
use super::problem::quote;
use super::{Kind, Map, Node, Place, Problems};
use lineshaft_core::unit::{Dimension, Fraction, Quantity, Unit, UnitError, excerpt, parse_decimal, parse_fraction};
use num_rational::Ratio;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// Names that no object may have.
const RESERVED: [&str; 3] = ["machine", "end", "ros"];
/// Maximum length of the name of an object.
const MAX_NAME: usize = 32;

/// Permitted quantities of a key.
#[derive(Clone, Copy, Debug)]
pub enum Allowed {
    /// Any quantity.
    Any,
    /// Greater than 0.
    Positive,
    /// 0 or greater.
    NotNegative,
    /// From the first to the second, inclusive; quantities of another dimension are not compared.
    Between(Quantity, Quantity),
}

/// A value of a document. Each reader reports a problem if it returns `None`.
#[derive(Clone, Debug)]
pub struct Value<'d> {
    node: &'d Node,
    label: String,
    problems: &'d Problems,
}

impl<'d> Value<'d> {
    pub(super) fn new(node: &'d Node, label: String, problems: &'d Problems) -> Self {
        Self { node, label, problems }
    }

    pub(super) fn entry(key: &'d Node, value: &'d Node, problems: &'d Problems) -> (Self, Self) {
        let label = excerpt(key.text());
        (Self::new(key, "the key".to_owned(), problems), Self::new(value, label, problems))
    }

    /// Returns the location of the value.
    pub fn place(&self) -> Place {
        self.node.place
    }

    /// Returns the name for problems: the key, with the index in a list, `inputs[1]`.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// Returns the same value with another name for problems.
    pub fn called(self, label: impl Into<String>) -> Self {
        Self { label: label.into(), ..self }
    }

    /// Reports a problem at the value.
    pub fn refuse(&self, sentence: impl Into<String>, hint: Option<String>) {
        self.problems.push(self.node.place, sentence, hint);
    }

    /// Adds the problems of a file that the value names.
    pub fn add_problems(&self, problems: Problems) {
        self.problems.append(problems);
    }

    /// Whether the value is empty, `~` or `null`.
    pub fn is_null(&self) -> bool {
        self.node.is_null()
    }

    /// Whether it is a list.
    pub fn is_list(&self) -> bool {
        matches!(self.node.kind, Kind::List(_))
    }

    /// Whether it is a mapping.
    pub fn is_map(&self) -> bool {
        matches!(self.node.kind, Kind::Map(_))
    }

    /// Returns the text as written if it is a scalar with a value; reports no problem.
    pub fn peek(&self) -> Option<&'d str> {
        Some(self.node.text()).filter(|_| matches!(self.node.kind, Kind::Scalar { .. }) && !self.is_null())
    }

    /// Whether it is an integer; reports no problem.
    pub fn is_integer(&self) -> bool {
        self.plain().is_some_and(|text| whole_number(text).is_ok())
    }

    /// Returns the boolean that a text without quotes probably stands for, such as `yes`; reports no problem.
    pub(crate) fn meant_boolean(&self) -> Option<bool> {
        match self.plain()?.to_lowercase().as_str() {
            "true" | "yes" | "on" => Some(true),
            "false" | "no" | "off" => Some(false),
            _ => None,
        }
    }

    /// Reads any scalar, as written.
    pub fn text(&self) -> Option<&'d str> {
        #[cfg(test)]
        self.record_expected(ExpectedKind::Text);
        self.scalar("a text")
    }

    /// Reads `true` or `false`.
    pub fn boolean(&self) -> Option<bool> {
        #[cfg(test)]
        self.record_expected(ExpectedKind::Boolean);
        let text = self.scalar("true or false")?;
        match self.plain().unwrap_or_default() {
            "true" => return Some(true),
            "false" => return Some(false),
            _ => {}
        }
        let hint = match text.to_lowercase().as_str() {
            "true" | "false" if text.to_lowercase() == text => Some("write it without quotes".to_owned()),
            "yes" | "on" | "y" | "1" | "true" => Some("write `true`".to_owned()),
            "no" | "off" | "n" | "0" | "false" => Some("write `false`".to_owned()),
            _ => None,
        };
        self.refuse(format!("{} is {}; true or false is allowed", self.label, quote(text)), hint);
        None
    }

    /// Reads an integer within `range`: decimal (also `1e6`), `0x1F` or `0o17`.
    pub fn integer<T>(&self, range: RangeInclusive<T>) -> Option<T>
    where
        T: Copy + TryInto<i128> + TryFrom<i128>,
    {
        let text = self.scalar("a whole number")?;
        // The bounds of every integer type except u128 fit; those of u128 are not needed.
        let (low, high) = ((*range.start()).try_into().ok()?, (*range.end()).try_into().ok()?);
        #[cfg(test)]
        self.record_expected(ExpectedKind::Integer(low, high));
        match self.plain().map_or(Err(NotWhole::Other), whole_number) {
            Ok(value) if (low..=high).contains(&value) => return T::try_from(value).ok(),
            Ok(value) => self.refuse(format!("{} is {value}; {low}..{high} is allowed", self.label), None),
            Err(NotWhole::TooLarge) => {
                self.refuse(format!("{} is {}; {low}..{high} is allowed", self.label, quote(text)), None);
            }
            Err(NotWhole::Other) => {
                let sentence = format!("{} is {}; a whole number {low}..{high} is allowed", self.label, quote(text));
                let hint = self.quotes_hint(|text| whole_number(text).is_ok()).or_else(|| without_unit(text));
                self.refuse(sentence, hint);
            }
        }
        None
    }

    /// Reads a finite number within `range`; an infinite bound means no limit.
    pub fn number(&self, range: RangeInclusive<f64>) -> Option<f64> {
        #[cfg(test)]
        self.record_expected(ExpectedKind::Number);
        let text = self.scalar("a number")?;
        match self.plain().and_then(finite) {
            Some(value) if range.contains(&value) => return Some(value),
            Some(_) => {
                let (low, high) = range.into_inner();
                let allowed = match (low.is_finite(), high.is_finite()) {
                    (true, true) => format!("{low}..{high}"),
                    (true, false) => format!("{low} and above"),
                    (false, _) => format!("{high} and below"),
                };
                self.refuse(format!("{} is {text}; {allowed} is allowed", self.label), None);
            }
            None => {
                let sentence = format!("{} is {}; a finite number is expected", self.label, quote(text));
                let comma = finite(&text.replacen(',', ".", 1)).filter(|_| text.contains(','));
                let comma = comma.map(|_| "write a decimal point, not a comma".to_owned());
                self.refuse(sentence, comma.or_else(|| self.quotes_hint(|text| finite(text).is_some())));
            }
        }
        None
    }

    /// Reads an exact number: a decimal or a fraction such as `1/3`.
    pub fn fraction(&self) -> Option<Fraction> {
        #[cfg(test)]
        self.record_expected(ExpectedKind::Number);
        let text = self.scalar("a number")?;
        self.unit_result(parse_fraction(text))
    }

    /// Reads a quantity `NUMBER UNIT` of one of the dimensions; a number without unit is in SI of the first dimension.
    pub fn quantity(&self, dimensions: &[Dimension], allowed: &Allowed) -> Option<Quantity> {
        self.quantity_in(None, dimensions, allowed)
    }

    /// Does the same; examples in problems are in this unit, which is that of the axis.
    pub fn quantity_in(&self, unit: Option<Unit>, dimensions: &[Dimension], allowed: &Allowed) -> Option<Quantity> {
        #[cfg(test)]
        self.record_expected(ExpectedKind::Quantity);
        let expected = dimensions.first().map_or("a quantity", |dimension| dimension.article());
        let text = self.scalar(expected)?;
        let quantity = Quantity::parse(text, dimensions).map_err(|error| match unit {
            Some(unit) => error.in_unit(unit),
            None => error,
        });
        let quantity = quantity.map_err(|error| self.refuse_quantity(&error, dimensions, unit)).ok()?;
        self.note_bare_number(text, quantity);
        let zero = Ratio::from(0);
        let (good, range) = match allowed {
            Allowed::Any => return Some(quantity),
            Allowed::Positive => (quantity.value() > zero, "a value above 0".to_owned()),
            Allowed::NotNegative => (quantity.value() >= zero, "0 and above".to_owned()),
            // Without an order there is no limit: `500 inc` is neither less nor greater than `1 m`.
            Allowed::Between(low, high) => {
                let below = quantity.partial_cmp(low).is_some_and(|order| order.is_lt());
                let above = quantity.partial_cmp(high).is_some_and(|order| order.is_gt());
                (!below && !above, format!("{low}..{high}"))
            }
        };
        if !good {
            let hint = unit_of_bare(text, quantity.unit());
            self.refuse(format!("{} is {}; {range} is allowed", self.label, quote(text)), hint);
        }
        good.then_some(quantity)
    }

    /// Starts recording the lengths and angles, and their derivatives, that are read from numbers without a unit.
    pub(crate) fn record_bare_numbers(&self) {
        *self.problems.bare.borrow_mut() = Some(Vec::new());
    }

    /// Ends the record and returns it, in the order of the file; 0 is not in it.
    pub(crate) fn take_bare_numbers(&self) -> Vec<BareNumber> {
        let mut numbers = self.problems.bare.take().unwrap_or_default();
        numbers.sort_by_key(|number| number.place);
        numbers.dedup_by_key(|number| number.place);
        numbers
    }

    fn note_bare_number(&self, text: &str, quantity: Quantity) {
        let mut record = self.problems.bare.borrow_mut();
        let Some(numbers) = record.as_mut() else { return };
        let is_travel = matches!(quantity.unit().dimension(), Dimension::Length(_) | Dimension::Angle(_));
        let text = text.trim();
        if is_travel && quantity.value() != Ratio::from(0) && parse_decimal(text).is_ok() {
            let (file, label) = (Arc::clone(&self.problems.file), self.label.clone());
            numbers.push(BareNumber { file, place: self.node.place, label, text: excerpt(text), quantity });
        }
    }

    /// Reads one of several names.
    pub fn choice<T: Copy>(&self, names: &[(&str, T)]) -> Option<T> {
        #[cfg(test)]
        self.record_expected(ExpectedKind::Choice(names.iter().map(|(name, _)| (*name).to_owned()).collect()));
        let text = self.scalar("a name")?;
        if let Some((_, value)) = names.iter().find(|(name, _)| *name == text) {
            return Some(*value);
        }
        let all: Vec<_> = names.iter().map(|(name, _)| *name).collect();
        let meant = suggest(text, all.iter().copied()).or_else(|| part(text, &all));
        let hint = meant.map(|meant| format!("did you mean `{meant}`?"));
        let one_of = if all.len() == 1 { "" } else { "one of " };
        self.refuse(format!("{} is {}; {one_of}{} is allowed", self.label, quote(text), all.join(", ")), hint);
        None
    }

    /// Reads the name of an object of a cell: `[a-z][a-z0-9_]*`, at most 32 characters, not machine, end or ros.
    pub fn name(&self) -> Option<&'d str> {
        let text = self.scalar("a name")?;
        if RESERVED.contains(&text) {
            self.refuse(format!("{} is taken; machine, end and ros name no object", quote(text)), None);
            return None;
        }
        if is_name(text) {
            return Some(text);
        }
        let given = if text.len() > MAX_NAME && text.is_ascii() {
            format!(" has {} characters and", text.len())
        } else {
            String::new()
        };
        let plain = text.to_lowercase().replace(['-', ' ', '.', '/'], "_");
        let hint = (plain != text && is_name(&plain)).then(|| format!("write `{plain}`"));
        let sentence = "is no name; a letter a..z, then a..z, 0..9 and _, at most 32 characters, is allowed";
        self.refuse(format!("{}{given} {sentence}", quote(text)), hint);
        None
    }

    /// Reads the values of a list; an empty value is an empty list.
    pub fn list(&self) -> Option<Vec<Value<'d>>> {
        #[cfg(test)]
        self.record_expected(ExpectedKind::List);
        let items = match &self.node.kind {
            Kind::List(items) => items.as_slice(),
            _ if self.is_null() => &[],
            _ => return self.wrong_kind("a list"),
        };
        let label = |index| format!("{}[{index}]", self.label);
        Some(items.iter().enumerate().map(|(index, node)| Value::new(node, label(index), self.problems)).collect())
    }

    /// Reads a mapping key by key, called `what` in problems (axis `x`); an empty value is an empty mapping.
    pub fn map(&self, what: impl Into<String>) -> Option<Map<'d>> {
        Some(Map::new(what.into(), self.node, self.pairs()?, self.problems))
    }

    /// Reads the keys and values of a mapping in the order of the file, for a section with names as keys; an empty
    /// value has none.
    pub fn entries(&self) -> Option<Vec<(Value<'d>, Value<'d>)>> {
        Some(self.pairs()?.iter().map(|(key, value)| Value::entry(key, value, self.problems)).collect())
    }

    fn pairs(&self) -> Option<&'d [(Node, Node)]> {
        #[cfg(test)]
        self.record_expected(ExpectedKind::Map);
        match &self.node.kind {
            Kind::Map(entries) => Some(entries),
            _ if self.is_null() => Some(&[]),
            _ => self.wrong_kind("a mapping"),
        }
    }

    /// Records for a test the expected kind of the value.
    #[cfg(test)]
    fn record_expected(&self, asked: ExpectedKind) {
        if let Some(observer) = &self.problems.observer {
            observer.note(self.node, Note::Value(asked));
        }
    }

    fn scalar(&self, expected: &str) -> Option<&'d str> {
        self.peek().or_else(|| self.wrong_kind(expected))
    }

    fn wrong_kind<T>(&self, expected: &str) -> Option<T> {
        let given = match &self.node.kind {
            _ if self.is_null() => "has no value".to_owned(),
            Kind::Scalar { text, .. } => format!("is {}", quote(text)),
            Kind::List(_) => "is a list".to_owned(),
            Kind::Map(_) => "is a mapping".to_owned(),
        };
        self.refuse(format!("{} {given}; {expected} is expected", self.label), None);
        None
    }

    /// Returns the text of a scalar without quotes.
    fn plain(&self) -> Option<&'d str> {
        match &self.node.kind {
            Kind::Scalar { text, quoted: false } => Some(text),
            _ => None,
        }
    }

    fn quotes_hint(&self, would_do: impl Fn(&str) -> bool) -> Option<String> {
        (self.plain().is_none() && would_do(self.node.text())).then(|| "write it without quotes".to_owned())
    }

    /// Reports why it is no quantity, with an example if the intended value is unknown.
    fn refuse_quantity(&self, error: &UnitError, dimensions: &[Dimension], unit: Option<Unit>) {
        let example = || match (error, dimensions.first()) {
            (UnitError::NotANumber { .. }, Some(first)) => Some(format!("{} is expected", first.such_as(unit))),
            _ => None,
        };
        self.refuse(format!("{}: {error}", self.label), error.hint().or_else(example));
    }

    fn unit_result<T>(&self, result: Result<T, UnitError>) -> Option<T> {
        result.map_err(|error| self.refuse(format!("{}: {error}", self.label), error.hint())).ok()
    }
}

/// Returns a hint with the unit in which a positive number without unit was read, because another unit was probably
/// intended.
pub(crate) fn unit_of_bare(text: &str, unit: Unit) -> Option<String> {
    let is_bare = parse_decimal(text.trim()).is_ok_and(|number| number > Ratio::from(0));
    (is_bare && unit != Dimension::Ratio.si_unit()).then(|| format!("a number without a unit is in {unit}"))
}

/// Returns a hint for an integer that was given with a unit.
fn without_unit(text: &str) -> Option<String> {
    let (number, unit) = text.split_once(' ')?;
    let is_quantity = whole_number(number).is_ok() && Unit::parse(unit.trim()).is_some();
    is_quantity.then(|| "a unit is not allowed here".to_owned())
}

enum NotWhole {
    TooLarge,
    Other,
}

fn whole_number(text: &str) -> Result<i128, NotWhole> {
    for (prefix, radix) in [("0x", 16), ("0o", 8)] {
        if let Some(digits) = text.strip_prefix(prefix).filter(|digits| !digits.starts_with(['+', '-'])) {
            return i128::from_str_radix(digits, radix).map_err(|error| match error.kind() {
                std::num::IntErrorKind::PosOverflow => NotWhole::TooLarge,
                _ => NotWhole::Other,
            });
        }
    }
    match parse_decimal(text) {
        Ok(value) if value.is_integer() => Ok(value.to_integer()),
        Err(UnitError::TooManyDigits { .. }) => Err(NotWhole::TooLarge),
        _ => Err(NotWhole::Other),
    }
}

/// Parses a decimal number as f64, without `inf` and `nan`, which Rust accepts.
fn finite(text: &str) -> Option<f64> {
    let plain = text.bytes().all(|byte| byte.is_ascii_digit() || b"+-.eE".contains(&byte));
    text.parse().ok().filter(|value: &f64| plain && value.is_finite())
}

fn is_name(text: &str) -> bool {
    let tail = |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'_';
    text.len() <= MAX_NAME && text.starts_with(|c: char| c.is_ascii_lowercase()) && text.bytes().all(tail)
}

/// Returns the only name that begins or ends with `text`, or with which `text` begins or ends: `simulation` gives
/// `sim`, `cyclic_position` gives `position`.
fn part<'n>(text: &str, names: &[&'n str]) -> Option<&'n str> {
    /// Two letters are part of too many words.
    const SHORTEST: usize = 3;
    let is_part =
        |short: &str, long: &str| short.len() >= SHORTEST && (long.starts_with(short) || long.ends_with(short));
    let mut found = names.iter().copied().filter(|name| is_part(name, text) || is_part(text, name));
    found.next().filter(|_| found.next().is_none())
}

/// Returns the name that is most similar to `text`, if any: up to a third of its letters may differ.
pub(super) fn suggest<'n>(text: &str, names: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    /// A longer text is no misspelled key, and the time for the distance is the product of the lengths.
    const LONGEST: usize = 64;
    if text.len() > LONGEST {
        return None;
    }
    let distance = |name: &str| strsim::damerau_levenshtein(&text.to_lowercase(), &name.to_lowercase());
    let near = names.map(|name| (distance(name), name)).filter(|(far, name)| *far * 3 <= text.len().max(name.len()));
    near.min_by_key(|(far, _)| *far).map(|(_, name)| name)
}

//! The keys of an axis that the catalogue of parameters knows.

use super::names::quote;
use super::scale::Travel;
use crate::document::{Map, Value};
use lineshaft_core::parameter::{
    self, AxisParameters, Bare, ConvertError, Measure, ParameterInput, ROWS, Range, Refused, Row,
};
use lineshaft_core::unit::{Scale, UnitError, parse_decimal};

/// Increments that an axis may move in one cycle.
const MOST_PER_CYCLE: f64 = (1_u64 << 31) as f64;

/// Vocabularies whose keys stand in a map of their own: `amc: {stop_mode: 1}` is `amc.stop_mode: 1`.
const PREFIXES: [&str; 3] = ["amc", "saia", "wf"];

/// The keys that stand in the file, with their values.
pub(super) type Given<'d> = Vec<(&'static str, Value<'d>)>;

/// The maps of the vocabularies, where they stand.
pub(super) struct Sections<'d>([Option<Map<'d>>; 3]);

impl<'d> Sections<'d> {
    pub(super) fn open(map: &mut Map<'d>) -> Self {
        Self(PREFIXES.map(|prefix| map.optional(prefix).and_then(|value| value.map(prefix))))
    }

    /// The map of a vocabulary.
    pub(super) fn of(&mut self, prefix: &str) -> Option<&mut Map<'d>> {
        let place = PREFIXES.iter().position(|known| *known == prefix)?;
        self.0[place].as_mut()
    }

    pub(super) fn finish(self) {
        self.0.into_iter().flatten().for_each(Map::finish);
    }

    /// The value of a key, from its section or by its whole name.
    pub(super) fn value(&mut self, map: &mut Map<'d>, whole_key: &str) -> Option<Value<'d>> {
        let whole = map.optional(whole_key);
        let Some((prefix, key)) = whole_key.split_once('.') else { return whole };
        let nested = self.of(prefix).and_then(|section| section.optional(key));
        if let (Some(whole), Some(_)) = (&whole, &nested) {
            whole.refuse(format!("{whole_key} stands in section {prefix} too"), None);
        }
        nested.or(whole)
    }
}

/// Reads all parameters of an axis; where one has a problem, its default stands.
pub(super) fn read<'d>(
    map: &mut Map<'d>,
    sections: &mut Sections<'d>,
    travel: &Travel,
    cycle_ns: Option<u64>,
) -> (AxisParameters, Given<'d>) {
    // With no limit given, nothing else must seem to lie above it.
    let mut parameters = AxisParameters::new(f64::MAX, f64::MAX);
    let mut given = Given::new();
    for row in ROWS {
        let is_other_view = refuse_mnemonic(map, row);
        let value = if row.required && !is_other_view { map.required(row.key) } else { sections.value(map, row.key) };
        let Some(value) = value else { continue };
        let reader = Reader { row, value: &value, travel, cycle_ns };
        if reader.assign(&mut parameters).is_some() {
            given.push((row.key, value));
        }
    }
    if let Some(scale) = &travel.scale {
        check(&mut parameters, &given, scale);
    }
    (parameters, given)
}

/// The source's name for a value that has one of its own here; true if it stands.
fn refuse_mnemonic(map: &mut Map<'_>, row: &Row) -> bool {
    let mnemonic = row.mnemonic.to_lowercase();
    let stands = mnemonic != row.key && map.has(&mnemonic);
    if stands && let Some(value) = map.optional(&mnemonic) {
        value.refuse(format!("parameter {mnemonic} does not exist yet"), Some(format!("write `{}`", row.key)));
    }
    stands
}

/// Refuses what contradicts, every pair once.
fn check(parameters: &mut AxisParameters, given: &[(&str, Value<'_>)], scale: &Scale) {
    let mut checked = *parameters;
    while let Err((low, high)) = checked.check() {
        let (Some((_, low_row)), Some((_, high_row))) = (Row::find(low), Row::find(high)) else { return };
        let (low_value, high_value) = ((low_row.get)(&checked), (high_row.get)(&checked));
        let (low_text, high_text) = (text(low_row, scale, low_value), text(high_row, scale, high_value));
        let sentence = if low_value == high_value {
            format!("{low} {low_text} lies at {high} {high_text}; below is allowed")
        } else {
            format!("{low} {low_text} lies above {high} {high_text}")
        };
        if let Some((_, value)) = given.iter().find(|(key, _)| *key == low) {
            value.refuse(sentence, None);
        }
        // The next look must not find the same pair.
        if low_row.assign(&mut checked, parameter::Value::Unset).is_err() {
            return;
        }
    }
}

/// A value in the axis unit.
fn text(row: &Row, scale: &Scale, value: parameter::Value) -> String {
    let order = order(row.measure);
    match value {
        parameter::Value::Int(value) if order == 0 => scale.format_increments(value),
        parameter::Value::Int(value) => value.to_string(),
        parameter::Value::Real(value) => scale.format_rate(value, order),
        parameter::Value::Unset => row.default_text.to_owned(),
    }
}

fn order(measure: Measure) -> u8 {
    match measure {
        Measure::Velocity => 1,
        Measure::Acceleration => 2,
        Measure::Jerk => 3,
        _ => 0,
    }
}

/// A value of the file for one parameter.
struct Reader<'r, 'd> {
    row: &'static Row,
    value: &'r Value<'d>,
    travel: &'r Travel,
    cycle_ns: Option<u64>,
}

impl Reader<'_, '_> {
    fn assign(&self, parameters: &mut AxisParameters) -> Option<()> {
        let input = self.input()?;
        // Without a scale the unit has been checked, and there is no more to say about a length.
        let scale = if self.is_scaled() { &self.travel.scale? } else { &self.travel.any_scale()? };
        let value = parameter::convert(self.row, scale, &input).map_err(|error| self.refuse_type(error)).ok()?;
        if self.is_too_fast(value) {
            self.refuse_range(scale);
            return None;
        }
        match self.row.assign(parameters, value) {
            Ok(()) => return Some(()),
            Err(Refused::OutOfRange) => self.refuse_range(scale),
            Err(Refused::NotBuilt) => self.refuse_choice(),
            Err(Refused::WrongType) => self.refuse_type(ConvertError::Type(self.written().to_owned())),
        }
        None
    }

    /// Does the value depend on the scale?
    fn is_scaled(&self) -> bool {
        !matches!(self.row.measure, Measure::Time | Measure::Integer | Measure::Number | Measure::Choice(_))
    }

    fn written(&self) -> &str {
        self.value.peek().unwrap_or_default()
    }

    /// The value as the catalogue takes it; the dimension of a quantity is right then.
    fn input(&self) -> Option<ParameterInput> {
        match (self.row.measure, self.row.range) {
            (Measure::Integer, Range::Int(low, high)) => self.value.integer(low..=high).map(ParameterInput::Integer),
            (Measure::Number, _) => self.value.number(f64::NEG_INFINITY..=f64::INFINITY).map(ParameterInput::Number),
            (Measure::Choice(names), _) => {
                let names: Vec<_> = names.iter().map(|name| (*name, *name)).collect();
                self.value.choice(&names).map(|name| ParameterInput::Text(name.to_owned()))
            }
            (measure, _) => {
                // A length fits only an axis that is known to be linear.
                if self.is_scaled() && self.travel.kind.is_none() {
                    return None;
                }
                if self.row.bare != Bare::Si && parse_decimal(self.written()).is_ok() {
                    return self.value.number(f64::NEG_INFINITY..=f64::INFINITY).map(ParameterInput::Number);
                }
                let dimensions = measure.dimensions(&self.travel.any_scale()?)?;
                let quantity = self.value.quantity(&dimensions, &crate::document::Allowed::Any);
                quantity.map(ParameterInput::Quantity)
            }
        }
    }

    /// Highest velocity (inc/s) of the axis, where the cycle is known.
    fn highest_velocity(&self) -> Option<f64> {
        self.cycle_ns.map(|cycle_ns| MOST_PER_CYCLE * 1e9 / cycle_ns as f64)
    }

    fn is_too_fast(&self, value: parameter::Value) -> bool {
        match value {
            parameter::Value::Real(velocity) if self.row.measure == Measure::Velocity => {
                self.highest_velocity().is_some_and(|highest| velocity > highest)
            }
            _ => false,
        }
    }

    fn refuse_type(&self, error: ConvertError) {
        let key = self.row.key;
        match error {
            ConvertError::Unit(error) => self.refuse_unit(&error),
            ConvertError::Type(value) => {
                let sentence = format!("{key} is {}; {} is expected", quote(&value), self.row.measure.expected());
                self.value.refuse(sentence, None);
            }
        }
    }

    fn refuse_unit(&self, error: &UnitError) {
        self.value.refuse(format!("{}: {error}", self.row.key), error.hint());
    }

    fn refuse_range(&self, scale: &Scale) {
        let sentence = format!("{} is {}; {} is allowed", self.row.key, quote(self.written()), self.permitted(scale));
        self.value.refuse(sentence, None);
    }

    fn refuse_choice(&self) {
        let built = match (self.row.measure, self.row.built) {
            (Measure::Choice(names), Some(built)) => names.get(..=built as usize).unwrap_or_default(),
            _ => &[],
        };
        let hint = (!built.is_empty()).then(|| format!("write `{}`", built.join("` or `")));
        self.value.refuse(format!("{} {} does not exist yet", self.row.key, self.written()), hint);
    }

    /// The range of the row in the axis unit.
    fn permitted(&self, scale: &Scale) -> String {
        let milliseconds = |nanoseconds: i64| format!("{} ms", nanoseconds as f64 / 1e6);
        match (self.row.range, self.row.measure) {
            // What lies above is no position at all and was refused as such.
            (Range::Int(0, _), Measure::Distance) => format!("{} and above", scale.format_increments(0)),
            (Range::Int(low, _), Measure::Distance) => {
                format!("{} ({low} inc) and above", scale.format_increments(low))
            }
            (Range::Int(low, high), Measure::Position) => {
                format!("{}..{}", scale.format_increments(low), scale.format_increments(high))
            }
            (Range::Int(low, high), Measure::Time) => format!("{}..{}", milliseconds(low), milliseconds(high)),
            (Range::Int(low, high), _) => format!("{low}..{high}"),
            (Range::Real(low, high), Measure::Number) => format!("{low}..{high}"),
            (Range::Real(low, high), measure) => {
                let text = |rate| scale.format_rate(rate, order(measure));
                format!("{}..{}", text(low), text(high))
            }
            (Range::PositiveUpTo(high), measure) => {
                let high = self.highest_velocity().filter(|_| measure == Measure::Velocity).unwrap_or(high).min(high);
                let text = |rate| scale.format_rate(rate, order(measure));
                format!("more than {} up to {}", text(0.0), text(high))
            }
        }
    }
}

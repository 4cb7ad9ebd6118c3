//! Reads the keys of an axis that are in the catalogue of parameters.

mod agree;

use super::row::{refuse_range, refuse_type, whole};
use super::scale::Travel;
use crate::document::{Allowed, Map, Value};
pub(crate) use agree::{contradictions, double_views, inverted_limits};
use lineshaft_core::axis::{may_output_sign, may_turn_loop};
use lineshaft_core::code::{Code, not_built_here};
use lineshaft_core::config::max_of_row;
use lineshaft_core::drive::Interface;
use lineshaft_core::encoder::source::AbsoluteSources;
use lineshaft_core::parameter::{
    self, Applies, AxisParameters, Bare, ConvertError, Group, Measure, ParameterInput, ROWS, Refused, Row, Storage,
    Word,
};
use lineshaft_core::regulator::Law;
use lineshaft_core::text::refused_text;
use lineshaft_core::unit::{Scale, UnitError, parse_decimal};

/// Maximum velocity and acceleration of a parameter.
const MOST: f64 = 1e15;

/// Prefixes of keys that may be in a map: `amc: {stop_mode: 1}` is `amc.stop_mode: 1`.
const PREFIXES: [&str; 7] = ["amc", "saia", "wf", "homing", "position_loop", "velocity_loop", "compensation"];

/// Given keys, with their values.
pub(super) type Given<'d> = Vec<(&'static str, Value<'d>)>;

/// Returns the corresponding key for a word of another controller.
pub(super) fn word_of_source(key: &str) -> Option<String> {
    Word::find(key).map(|word| word.text(None))
}

/// Maps of the prefixes, if given.
pub(super) struct Sections<'d>([Option<Map<'d>>; PREFIXES.len()]);

impl<'d> Sections<'d> {
    pub(super) fn open(map: &mut Map<'d>) -> Self {
        Self(PREFIXES.map(|prefix| {
            let mut section = map.optional(prefix).and_then(|value| value.map(prefix))?;
            section.explain_by(word_of_source);
            Some(section)
        }))
    }

    /// Returns the map of a prefix.
    pub(super) fn of(&mut self, prefix: &str) -> Option<&mut Map<'d>> {
        let place = PREFIXES.iter().position(|known| *known == prefix)?;
        self.0[place].as_mut()
    }

    pub(super) fn finish(self) {
        self.0.into_iter().flatten().for_each(Map::finish);
    }

    /// Returns the value of a key, from its map or by its full name.
    pub(super) fn value(&mut self, map: &mut Map<'d>, whole_key: &str) -> Option<Value<'d>> {
        let whole = map.optional(whole_key);
        let is_homing = |row: &&Row| row.key == whole_key && row.group == Group::Homing;
        let (prefix, key) = match whole_key.split_once('.') {
            Some(parts) => parts,
            // Words of MACS may also be in section homing.
            None if ROWS.iter().any(|row| is_homing(&row)) => ("homing", whole_key),
            None => return whole,
        };
        let nested = self.of(prefix).and_then(|section| section.optional(key));
        if let (Some(whole), Some(_)) = (&whole, &nested) {
            whole.refuse(format!("{whole_key} stands in section {prefix} too"), None);
        }
        nested.or(whole)
    }
}

/// Properties of an axis that are known before its parameters are read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    /// Interface; `Some(None)` for a virtual axis, `None` if unknown.
    pub who: Option<Option<Interface>>,
    /// Control law of its position loop, if this program closes it.
    pub law: Law,
    /// Whether it has two drives.
    pub has_two: bool,
    pub absolute: AbsoluteSources,
    pub cycle_ns: Option<u64>,
}

/// Reads all parameters of an axis; a parameter with a problem has its default.
pub(super) fn read<'d>(
    map: &mut Map<'d>,
    sections: &mut Sections<'d>,
    travel: &Travel,
    Axis { who, law, has_two, absolute, cycle_ns }: Axis,
) -> (AxisParameters, Given<'d>) {
    // Without a given limit, no other value must seem to exceed it.
    let mut parameters = AxisParameters::new(MOST, MOST).with_sources(absolute);
    let mut given = Given::new();
    let mut set = Vec::new();
    for row in ROWS.iter().filter(|row| row.storage != Storage::Cell) {
        let needs = row.required && !ROWS.iter().any(|view| view.view_of == row.key && map.has(view.key));
        let value = if needs { map.required(row.key) } else { sections.value(map, row.key) };
        let Some(value) = value else { continue };
        let is_there =
            row.applies != Applies::Machine && who.is_none_or(|who| row.applies.to_interface(who, law, has_two));
        if !is_there {
            let sentence = format!("{} is for {}", row.key, row.applies.text());
            value.refuse(sentence, Some("leave it out".to_owned()));
            continue;
        }
        let reader = Reader { row, value: &value, travel, cycle_ns };
        if reader.assign(&mut parameters).is_some() {
            given.push((row.key, value));
            set.push((row, row.value(&parameters)));
        }
    }
    double_views(&given, |_| false);
    inverted_limits(&parameters, given.iter().zip(&set).map(|((_, value), (row, number))| (*row, *number, value)));
    if let Some(who) = who {
        refuse_senses(who, &parameters, &given);
    }
    if let Some(scale) = &travel.scale {
        contradictions(&parameters, &given, scale, cycle_ns);
    }
    (parameters, given)
}

/// Refuses a direction of rotation, and outputs for the sign of a reference, that the interface of the axis does not
/// support.
pub(crate) fn refuse_senses(
    interface: Option<Interface>,
    parameters: &AxisParameters,
    given: &[(&'static str, Value<'_>)],
) {
    let refuse = |key: &str, number: i64, code: Code| {
        if let Some((_, value)) = given.iter().find(|(known, _)| *known == key) {
            value.refuse(format!("{key} {number} {}", not_built_here(code)), None);
        }
    };
    if !may_turn_loop(interface, parameters) {
        refuse("posdrct", parameters.macs.posdrct, Code::LOOP_IN_DRIVE);
    }
    if !may_output_sign(interface, parameters) {
        refuse("revers", parameters.macs.revers, Code::REVERSING_BY_POSITION);
    }
}

/// Value of one parameter in the file.
struct Reader<'r, 'd> {
    row: &'static Row,
    value: &'r Value<'d>,
    travel: &'r Travel,
    cycle_ns: Option<u64>,
}

impl Reader<'_, '_> {
    fn assign(&self, parameters: &mut AxisParameters) -> Option<()> {
        let input = self.input()?;
        // Without a scale, only the unit of a length can be checked, which has been done.
        let scale = if self.is_scaled() { &self.travel.scale? } else { &self.travel.any_scale()? };
        let value = parameter::convert(self.row, scale, &input).map_err(|error| self.refuse_type(error, scale)).ok()?;
        if self.is_too_fast(value) {
            self.refuse_range(scale);
            return None;
        }
        match self.row.assign(parameters, value) {
            Ok(()) => return Some(()),
            Err(Refused::OutOfRange) => self.refuse_range(scale),
            Err(Refused::WrongType) => self.refuse_type(ConvertError::Type(self.written().to_owned()), scale),
            Err(why) => {
                let sentence = refused_text(self.row, why, value, scale, self.highest_velocity());
                self.value.refuse(sentence, Some("leave it out".to_owned()));
            }
        }
        None
    }

    /// Whether the value depends on the scale.
    fn is_scaled(&self) -> bool {
        !matches!(self.row.measure, Measure::Time | Measure::Integer | Measure::Number | Measure::Choice(_))
    }

    fn written(&self) -> &str {
        self.value.peek().unwrap_or_default()
    }

    /// Whether the text is a number followed by more text.
    fn is_quantity(&self) -> bool {
        let text = self.written();
        let is_number = self.value.is_integer() || text.parse::<f64>().is_ok();
        !is_number && text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c))
    }

    /// Returns the input for the catalogue, with a quantity of the right dimension.
    fn input(&self) -> Option<ParameterInput> {
        if let Some(unit) = self.row.own_unit().filter(|_| self.is_quantity()) {
            return self.value.quantity(&[unit.dimension()], &Allowed::Any).map(ParameterInput::Quantity);
        }
        match self.row.measure {
            Measure::Integer => whole(self.row, self.value, &self.travel.any_scale()?).map(ParameterInput::Integer),
            Measure::Number => self.value.number(f64::NEG_INFINITY..=f64::INFINITY).map(ParameterInput::Number),
            Measure::Choice(_) if self.value.is_integer() => {
                self.value.integer(i64::MIN..=i64::MAX).map(ParameterInput::Integer)
            }
            Measure::Choice(names) => {
                let names: Vec<_> = names.iter().map(|name| (*name, *name)).collect();
                self.value.choice(&names).map(|name| ParameterInput::Text(name.to_owned()))
            }
            measure => {
                // A length is valid only if the axis is known to be linear.
                if self.is_scaled() && self.travel.kind.is_none() {
                    return None;
                }
                if self.row.bare != Bare::Si && parse_decimal(self.written()).is_ok() {
                    return self.value.number(f64::NEG_INFINITY..=f64::INFINITY).map(ParameterInput::Number);
                }
                let scale = self.travel.any_scale()?;
                let dimensions = measure.dimensions(&scale)?;
                let unit = self.travel.scale.map(|scale| scale.unit().unit());
                let quantity = self.value.quantity_in(unit, &dimensions, &Allowed::Any);
                quantity.map(ParameterInput::Quantity)
            }
        }
    }

    /// Returns the maximum velocity of the row, in inc/s, if the cycle limits it.
    fn highest_velocity(&self) -> Option<f64> {
        self.cycle_ns.and_then(|cycle_ns| max_of_row(self.row, cycle_ns))
    }

    fn is_too_fast(&self, value: parameter::Value) -> bool {
        match value {
            parameter::Value::Real(velocity) => self.highest_velocity().is_some_and(|highest| velocity > highest),
            _ => false,
        }
    }

    fn refuse_type(&self, error: ConvertError, scale: &Scale) {
        match error {
            ConvertError::Unit(UnitError::RateTooHigh { .. }) => self.refuse_range(scale),
            ConvertError::Unit(error) => self.refuse_unit(&error),
            ConvertError::Type(value) => refuse_type(self.row, self.value, &value, scale, None),
        }
    }

    fn refuse_unit(&self, error: &UnitError) {
        self.value.refuse(format!("{}: {error}", self.row.key), error.hint());
    }

    fn refuse_range(&self, scale: &Scale) {
        refuse_range(self.row, self.value, scale, self.highest_velocity());
    }
}

//! Reads the fields of a request from the arguments of its verb.

use super::amount::amount;
use super::{Effect, EffectOfGoal, Ids, Reader};
use crate::document::{Allowed, Map, Value};
use crate::scenario::moment::bare;
use crate::scenario::names::Names;
use lineshaft_core::request::{Amount, Named, Presence, RequestError, UnitOf, Units, Verb, VerbFields};
use lineshaft_core::unit::{Dimension, Fraction, Scale};
use std::ops::RangeInclusive;

/// Reader of the fields of one request.
struct FieldReader<'r, 'd> {
    names: &'r Names<'r>,
    ids: &'r mut Ids,
    recorded: bool,
    map: Map<'d>,
    id: Option<usize>,
    /// Values that were read without a problem.
    read: Vec<(&'static str, Value<'d>)>,
    scale: Option<Scale>,
    /// Scale of the leader; `None` if nothing with its name can lead, or if it has increments only.
    leader_scale: Option<Scale>,
    in_increments: bool,
    units_error: Option<RequestError>,
    /// Whether no problem was reported.
    is_good: bool,
}

impl Reader<'_> {
    /// Reads a request, and its ID if it has one.
    pub(super) fn request(&mut self, verb: &str, mut request: Box<dyn Verb>, value: &Value<'_>) -> EffectOfGoal {
        let Some(map) = value.map(verb) else { return (None, None) };
        let mut fields = FieldReader {
            names: self.names,
            ids: self.ids,
            recorded: self.recorded,
            map,
            id: None,
            read: Vec::new(),
            scale: None,
            leader_scale: None,
            in_increments: false,
            units_error: None,
            is_good: true,
        };
        request.fields(&mut fields);
        let FieldReader { map, id, read, units_error, is_good, .. } = fields;
        map.finish();
        let deed = match units_error {
            Some(error) => self.to_command(value, Err(error)),
            None if is_good => self.resolve(value, request.as_ref(), &read),
            None => None,
        };
        (deed, id)
    }

    fn resolve(&self, value: &Value<'_>, request: &dyn Verb, read: &[(&str, Value<'_>)]) -> Option<Effect> {
        let result = request.resolve(self.names.config, self.recorded);
        let Err(error) = &result else { return self.to_command(value, result) };
        if let Some(hint) = request.hint(error).filter(|_| self.refused.is_none()) {
            value.refuse(error.to_string(), Some(hint.to_owned()));
            return None;
        }
        let place = request.place(error).and_then(|place| read.iter().find(|(key, _)| *key == place));
        self.to_command(place.map_or(value, |(_, value)| value), result)
    }
}

impl<'d> FieldReader<'_, 'd> {
    fn value(&mut self, key: &str, presence: Presence) -> Option<Value<'d>> {
        let is_required = match presence {
            Presence::Required => true,
            Presence::Expected => !self.recorded,
            Presence::Written | Presence::Optional => false,
        };
        let value = if is_required { self.map.required(key) } else { self.map.optional(key) };
        self.is_good &= value.is_some() || !is_required;
        value
    }

    fn read<T>(
        &mut self,
        key: &'static str,
        presence: Presence,
        target: &mut T,
        read: impl FnOnce(&Value<'d>) -> Option<T>,
    ) {
        let Some(value) = self.value(key, presence) else { return };
        match read(&value) {
            Some(found) => {
                *target = found;
                self.read.push((key, value));
            }
            None => self.is_good = false,
        }
    }

    /// Returns the number of a choice, 0 if it is absent, `None` if it is invalid.
    fn number(&mut self, key: &str, names: &[&'static str], presence: Presence) -> Option<u8> {
        let Some(value) = self.value(key, presence) else { return Some(0) };
        let number = choice_number(&value, names);
        self.is_good &= number.is_some();
        number
    }

    fn scale_of(&self, of: UnitOf) -> Option<Scale> {
        match of {
            UnitOf::Axis => self.scale,
            UnitOf::Leader => self.leader_scale,
        }
    }

    /// Returns the scale of an object whose position can be set.
    fn zero_scale(&self, name: &str) -> Option<Scale> {
        let config = self.names.config;
        let encoder = config.encoders.iter().find(|encoder| encoder.name == name).map(|encoder| encoder.scale);
        let master = name.ends_with(".master").then(Scale::increments);
        encoder.or(master).or_else(|| config.find_axis(name).ok().map(|(_, axis)| axis.scale))
    }
}

impl VerbFields for FieldReader<'_, '_> {
    fn has(&self, key: &str) -> bool {
        self.map.has(key)
    }

    fn list_in_order(&mut self, keys: &[&'static str]) {
        self.map.list_in_order(keys);
    }

    fn id(&mut self) {
        self.id = self.map.optional("id").and_then(|id| self.ids.carry(&id));
    }

    fn name(&mut self, key: &'static str, of: Named, presence: Presence, value: &mut String) {
        self.read(key, presence, value, |given| given.text().map(str::to_owned));
        let config = self.names.config;
        match of {
            Named::Axis => self.scale = config.find_axis(value).ok().map(|(_, axis)| axis.scale),
            Named::Position => self.scale = self.zero_scale(value),
            Named::Leader => {
                let leader = config.find_leader(value).ok();
                self.leader_scale = leader.and_then(|leader| config.known_scale_of(leader));
            }
            Named::Other => {}
        }
    }

    fn choice(&mut self, key: &'static str, names: &[&'static str], presence: Presence, number: &mut u8) {
        *number = self.number(key, names, presence).unwrap_or(u8::MAX);
    }

    fn word(&mut self, key: &'static str, names: &[&'static str], number: &mut u8) {
        self.read(key, Presence::Optional, number, |given| given.choice(&numbered(names)));
    }

    fn units(&mut self, units: &mut Units) {
        let Some(number) = self.number("units", &Units::ALL.map(|(name, _)| name), Presence::Optional) else { return };
        match Units::from_number(number) {
            Ok(given) => *units = given,
            Err(error) => self.units_error = Some(error),
        }
        self.in_increments = *units == Units::Increments;
    }

    fn amount(&mut self, key: &'static str, order: u8, of: UnitOf, presence: Presence, value: &mut Amount) {
        // The unit of a leader may change until the command is executed.
        let scale = self.scale.filter(|_| of == UnitOf::Axis);
        let in_increments = self.in_increments;
        self.read(key, presence, value, |given| amount(given, order, scale.as_ref(), in_increments));
    }

    fn increments(&mut self, key: &'static str, of: UnitOf, value: &mut i64) {
        let scale = self.scale_of(of);
        self.read(key, Presence::Optional, value, |given| increments(given, scale));
    }

    fn whole(&mut self, key: &'static str, range: RangeInclusive<i64>, presence: Presence, value: &mut i64) {
        self.read(key, presence, value, |given| given.integer(range));
    }

    fn real(&mut self, key: &'static str, range: RangeInclusive<f64>, value: &mut f64) {
        self.read(key, Presence::Required, value, |given| given.number(range));
    }

    fn boolean(&mut self, key: &'static str, default: bool, value: &mut bool) {
        *value = default;
        self.read(key, Presence::Optional, value, |given| given.boolean());
    }

    fn fraction(&mut self, key: &'static str, value: &mut Fraction) {
        self.read(key, Presence::Optional, value, |given| given.fraction());
    }

    fn belongs(&mut self, key: &'static str, holds: bool, to: &'static str) {
        let given = self.read.iter().find(|(known, _)| *known == key).filter(|_| !holds);
        if let Some((_, value)) = given {
            value.refuse(format!("{key} belongs to `{to}`"), None);
            self.is_good = false;
        }
    }
}

/// Reads a choice by name or number.
pub(super) fn choice_number(value: &Value<'_>, names: &[&'static str]) -> Option<u8> {
    if value.is_integer() { value.integer(0..=u8::MAX) } else { value.choice(&numbered(names)) }
}

fn numbered(names: &[&'static str]) -> Vec<(&'static str, u8)> {
    names.iter().copied().zip(0..).collect()
}

/// Reads a position in increments, or with a unit.
fn increments(value: &Value<'_>, scale: Option<Scale>) -> Option<i64> {
    let scale = scale.filter(|_| !value.is_integer() && bare(value).is_none());
    let Some(scale) = scale else { return value.integer(i64::MIN..=i64::MAX) };
    let dimensions = [scale.kind().dimension(0), Dimension::Increments(0)];
    let quantity = value.quantity_in(Some(scale.unit().unit()), &dimensions, &Allowed::Any)?;
    scale.position(&quantity).map_err(|error| value.refuse(format!("{}: {error}", value.label()), error.hint())).ok()
}

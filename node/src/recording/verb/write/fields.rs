//! Writes the fields of a request.

use super::numbers::{length, rate};
use super::values::{Entries, Scalar};
use lineshaft_core::position::Length;
use lineshaft_core::request::{Amount, NAMELESS, Named, Presence, UnitOf, Units, VerbFields};
use lineshaft_core::unit::{Fraction, fraction_to_digits};
use std::ops::RangeInclusive;

/// Writer of the fields of one request; default values are left out.
pub(super) struct FieldWriter {
    pub(super) id: u64,
    pub(super) entries: Entries,
}

impl FieldWriter {
    fn write(&mut self, key: &str, presence: Presence, is_default: bool, value: impl FnOnce() -> Scalar) {
        if presence != Presence::Optional || !is_default {
            self.entries.0.push((key.to_owned(), value()));
        }
    }
}

impl VerbFields for FieldWriter {
    fn has(&self, key: &str) -> bool {
        self.entries.0.iter().any(|(known, _)| known == key)
    }

    fn list_in_order(&mut self, _: &[&'static str]) {}

    fn id(&mut self) {
        self.entries.0.push(("id".to_owned(), Scalar::Text(self.id.to_string())));
    }

    fn name(&mut self, key: &'static str, _: Named, presence: Presence, value: &mut String) {
        self.write(key, presence, value.is_empty(), || Scalar::Text(value.clone()));
    }

    fn choice(&mut self, key: &'static str, names: &[&'static str], presence: Presence, number: &mut u8) {
        let name = || names.get(usize::from(*number)).copied().unwrap_or(NAMELESS);
        self.write(key, presence, *number == 0, || Scalar::Text(name().to_owned()));
    }

    fn word(&mut self, key: &'static str, names: &[&'static str], number: &mut u8) {
        self.choice(key, names, Presence::Optional, number);
    }

    fn units(&mut self, units: &mut Units) {
        let name = Units::ALL.iter().find(|(_, known)| known == units).map_or(NAMELESS, |(name, _)| name);
        self.write("units", Presence::Optional, *units == Units::default(), || Scalar::Text(name.to_owned()));
    }

    fn amount(&mut self, key: &'static str, order: u8, _: UnitOf, presence: Presence, value: &mut Amount) {
        let (is_default, scalar) = match *value {
            Amount::Number(number) => (number == 0.0, Scalar::Real(number)),
            Amount::Quantity(given) => {
                (false, Scalar::Text(format!("{} {}", fraction_to_digits(&given.value()), given.unit())))
            }
            Amount::Increments(given) => (given == Length::default(), Scalar::Text(length(given))),
            Amount::IncrementsPerTime(given) => (given.to_bits() == 0, Scalar::Text(rate(given, order))),
        };
        self.write(key, presence, is_default, || scalar);
    }

    fn increments(&mut self, key: &'static str, _: UnitOf, value: &mut i64) {
        self.whole(key, i64::MIN..=i64::MAX, Presence::Optional, value);
    }

    fn whole(&mut self, key: &'static str, _: RangeInclusive<i64>, presence: Presence, value: &mut i64) {
        self.write(key, presence, *value == 0, || Scalar::Whole((*value).into()));
    }

    fn real(&mut self, key: &'static str, _: RangeInclusive<f64>, value: &mut f64) {
        self.write(key, Presence::Required, false, || Scalar::Real(*value));
    }

    fn boolean(&mut self, key: &'static str, default: bool, value: &mut bool) {
        self.write(key, Presence::Optional, *value == default, || Scalar::Truth(*value));
    }

    fn fraction(&mut self, key: &'static str, value: &mut Fraction) {
        let text = || Scalar::Text(format!("{}/{}", value.numer(), value.denom()));
        self.write(key, Presence::Optional, *value == Fraction::default(), text);
    }

    fn belongs(&mut self, _: &'static str, _: bool, _: &'static str) {}
}

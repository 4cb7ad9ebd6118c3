//! Verbs: requests that scenarios and recordings contain as text.
//!
//! Law      each request lists its fields once, in the order in which a recording has them. A reader of text fills them
//!          ([`Verb::resolve`] then converts names and units), a writer takes them from a command
//!          ([`MachineConfig::describe`]). The request of a command becomes the same command again
//! Source   contract sections 6, 7

use super::{Amount, RequestError, Units};
use crate::command::Action;
use crate::config::MachineConfig;
use crate::object::Object;
use crate::unit::Fraction;
use std::ops::RangeInclusive;

/// Name in a text for an object that does not exist. No object can have this name, so a reader refuses it.
pub const NAMELESS: &str = "?";

/// Presence of a field in a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Presence {
    /// A reader requires it, and it is always written.
    Required,
    /// As `Required`, but a recording may lack it: older programs left it out.
    Expected,
    /// A reader does not require it, but it is always written.
    Written,
    /// It is left out if it has its default value.
    Optional,
}

/// Object that a field names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Named {
    /// The axis of the request; amounts are in its unit.
    Axis,
    /// An axis, an encoder or a master, whose position is set; amounts are in its unit.
    Position,
    /// The leader of the axis.
    Leader,
    /// Another object.
    Other,
}

/// Object whose unit an amount has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnitOf {
    /// The axis of the request.
    Axis,
    /// Its leader.
    Leader,
}

/// Fields of a request: a reader changes the values, a writer writes them.
pub trait VerbFields {
    /// Returns true if the text has the field.
    fn has(&self, key: &str) -> bool;

    /// Sets the order of the fields in messages, if it differs from that of recordings.
    fn list_in_order(&mut self, keys: &[&'static str]);

    /// The ID of a goal, by which a cancel names it, field `id`.
    fn id(&mut self);

    /// A name; empty: none.
    fn name(&mut self, key: &'static str, of: Named, presence: Presence, value: &mut String);

    /// A choice by name or number; a reader sets 255 if it is invalid.
    fn choice(&mut self, key: &'static str, names: &[&'static str], presence: Presence, number: &mut u8);

    /// A choice by name only.
    fn word(&mut self, key: &'static str, names: &[&'static str], number: &mut u8);

    /// The units of numbers without a unit, field `units`. Amounts are listed after it.
    fn units(&mut self, units: &mut Units);

    /// A position (order 0) or one of its time derivatives.
    fn amount(&mut self, key: &'static str, order: u8, of: UnitOf, presence: Presence, value: &mut Amount);

    /// A position in whole increments, or with a unit; optional.
    fn increments(&mut self, key: &'static str, of: UnitOf, value: &mut i64);

    /// A whole number.
    fn whole(&mut self, key: &'static str, range: RangeInclusive<i64>, presence: Presence, value: &mut i64);

    /// A required real number.
    fn real(&mut self, key: &'static str, range: RangeInclusive<f64>, value: &mut f64);

    /// A truth value with a default.
    fn boolean(&mut self, key: &'static str, default: bool, value: &mut bool);

    /// An exact number, optional; 0 is the default.
    fn fraction(&mut self, key: &'static str, value: &mut Fraction);

    /// Refuses the field, if the text has it, unless `holds`: it belongs to another value, `to`.
    fn belongs(&mut self, key: &'static str, holds: bool, to: &'static str);
}

/// Returns a verb with its defaults.
pub type NewVerb = fn() -> Box<dyn Verb>;

/// A request with names and units that is a verb.
pub trait Verb {
    /// Lists all fields.
    fn fields(&mut self, fields: &mut dyn VerbFields);

    /// Converts the request to a command; a `recorded` one as older programs accepted it.
    ///
    /// # Errors
    /// An error in the request itself.
    fn resolve(&self, config: &MachineConfig, recorded: bool) -> Result<Action, RequestError>;

    /// Returns the field at which an error is reported; `None`: at the verb.
    fn place(&self, _error: &RequestError) -> Option<&'static str> {
        None
    }

    /// Returns advice on an error in a text.
    fn hint(&self, _error: &RequestError) -> Option<&'static str> {
        None
    }
}

impl MachineConfig {
    /// Returns the name of an object, or [`NAMELESS`].
    pub(super) fn name_or_nameless(&self, object: Object) -> String {
        let is_known = match object {
            Object::Axis(index) => usize::from(index) < self.axes.len(),
            Object::Encoder(index) => usize::from(index) < self.encoders.len(),
            Object::Io(index) => usize::from(index) < self.io.len(),
            Object::Machine | Object::Memory(_) | Object::Function(_) | Object::Table(_) | Object::Program(_) => false,
        };
        if is_known { self.name(object).to_owned() } else { NAMELESS.to_owned() }
    }
}

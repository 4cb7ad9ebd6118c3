//! An error on its way to the reaction of an axis.

use crate::code::{Class, Code};
use crate::event::{Number, Refusal};

/// Whether the brake is finally closed with this value of error_reaction (MACS-IO-04).
pub(in crate::axis) fn closes_brake(reaction: i64) -> bool {
    matches!(reaction, 1 | 3)
}

/// Time of an error within the cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::axis) enum Moment {
    /// The command of this cycle is known: a stop begins with it.
    Behind,
    /// The command is not known yet: a stop begins with the last one, a cycle ago.
    Before,
    /// The axis stops at a software limit, with its own plan.
    AtLimit,
    /// A refused command switches the drive off (SAIA-ERR-04), whatever the class of its code.
    Refused,
}

/// An error, as passed to `Axis::raise`.
#[derive(Clone, Copy, Debug)]
pub(in crate::axis) struct Failure {
    pub(in crate::axis) code: Code,
    /// Found value and allowed value.
    pub(in crate::axis) numbers: (Number, Number),
    pub(in crate::axis) moment: Moment,
    /// Whether its cause existed in the cycle before: in addition to another error it is not reported again.
    pub(in crate::axis) lasts: bool,
    /// Whether it removes the power, whatever its reaction is.
    pub(in crate::axis) takes_power: bool,
}

impl Failure {
    /// Returns an error that occurs after the motion of its cycle.
    pub(in crate::axis) fn of(code: Code) -> Self {
        Self { code, numbers: (Number::None, Number::None), moment: Moment::Behind, lasts: false, takes_power: false }
    }

    /// Adds the found value and the allowed value.
    pub(in crate::axis) fn with(self, found: Number, allowed: Number) -> Self {
        Self { numbers: (found, allowed), ..self }
    }

    /// Makes it an error that occurs before the motion of its cycle.
    pub(in crate::axis) fn before_motion(self) -> Self {
        Self { moment: Moment::Before, ..self }
    }

    /// Makes it the error of a stop at a software limit.
    pub(in crate::axis) fn at_limit(self) -> Self {
        Self { moment: Moment::AtLimit, ..self }
    }

    /// Returns the refusal of a command that switches the drive off.
    pub(in crate::axis) fn of_refusal(refusal: Refusal) -> Self {
        Self { moment: Moment::Refused, ..Self::of(refusal.code).with(refusal.asked, refusal.limit) }
    }

    /// Sets whether its cause existed in the cycle before.
    pub(in crate::axis) fn lasting(self, lasts: bool) -> Self {
        Self { lasts, ..self }
    }

    /// Makes it remove the power, whatever its reaction is.
    pub(in crate::axis) fn taking_power(self) -> Self {
        Self { takes_power: true, ..self }
    }

    pub(in crate::axis) fn class(&self) -> Class {
        match self.moment {
            Moment::Refused => Class::Command,
            _ => self.code.class().unwrap_or(Class::Parameter),
        }
    }
}

//! Error of an axis, and what else prevents its motion.

use super::alarm::{ActiveError, ErrorSnapshot, Numbers};
use crate::code::Code;
use crate::vocabulary::Owner;
use serde::{Deserialize, Serialize};

/// Error of an axis, open contact, and effect on other axes.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) struct AlarmState {
    error: ActiveError,
    /// The code of the open contact that prevents motion.
    open_contact: Code,
    /// Whether an error of this cycle stops the other axes, too.
    stops_others: bool,
    /// The cycle in which an error has ended the motion of a vocabulary, and that vocabulary.
    #[serde(skip)]
    lost: Option<(u64, Owner)>,
}

impl Default for AlarmState {
    fn default() -> Self {
        Self { error: ActiveError::default(), open_contact: Code::NONE, stops_others: false, lost: None }
    }
}

impl AlarmState {
    /// Returns the code of the active error.
    #[inline]
    pub(in crate::axis) fn code(&self) -> Code {
        self.error.code()
    }

    /// Whether no error is active.
    #[inline]
    pub(in crate::axis) fn is_none(&self) -> bool {
        self.error.is_none()
    }

    /// Returns the numbers of the last error.
    #[inline]
    pub(in crate::axis) fn numbers(&self) -> Numbers {
        self.error.numbers()
    }

    /// Returns the snapshot of the axis at the last error.
    #[inline]
    pub(in crate::axis) fn fault(&self) -> &ErrorSnapshot {
        self.error.fault()
    }

    /// Sets an error.
    #[inline]
    pub(in crate::axis) fn set(&mut self, numbers: Numbers, fault: ErrorSnapshot) {
        self.error.set(numbers, fault);
    }

    /// Clears the error and returns its code.
    #[inline]
    pub(in crate::axis) fn clear(&mut self) -> Code {
        self.error.clear()
    }

    /// Returns the code of the open contact that prevents motion.
    #[inline]
    pub(in crate::axis) fn open_contact(&self) -> Code {
        self.open_contact
    }

    /// Sets the code of the open contact, and returns that of the cycle before.
    #[inline]
    pub(in crate::axis) fn replace_contact(&mut self, code: Code) -> Code {
        std::mem::replace(&mut self.open_contact, code)
    }

    /// Whether an error of this cycle stops the other axes, too.
    #[inline]
    pub(in crate::axis) fn stops_others(&self) -> bool {
        self.stops_others
    }

    /// Lets an error of this cycle stop the other axes if `stops`.
    #[inline]
    pub(in crate::axis) fn stop_others(&mut self, stops: bool) {
        self.stops_others |= stops;
    }

    /// Lets the other axes continue.
    #[inline]
    pub(in crate::axis) fn let_others_continue(&mut self) {
        self.stops_others = false;
    }

    /// Whether an error of that cycle has ended the motion of that vocabulary.
    #[inline]
    pub(in crate::axis) fn has_lost(&self, cycle: u64, owner: Owner) -> bool {
        self.lost == Some((cycle, owner))
    }

    /// Notes that an error of that cycle ends the motion of its owner, if that is a vocabulary.
    pub(in crate::axis) fn note_lost(&mut self, cycle: u64, owner: Owner) {
        if owner != Owner::Native {
            self.lost = Some((cycle, owner));
        }
    }
}

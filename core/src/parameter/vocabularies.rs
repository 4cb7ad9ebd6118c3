//! Parameters of the vocabularies of an axis.

use super::{AxisParameters, Row, amc, saia, wf};
use serde::{Deserialize, Serialize};

/// Key of the parameter that declares the encoder of a drive as absolute.
pub const ENCODER_KIND: &str = "wf.md4";
/// Key of the side of the cam, or of the omitted bits of absolute words.
pub const SIDE_OR_OMITTED: &str = "wf.md7";
/// Key of the reference point, or of the parity of absolute words.
pub const REFERENCE_OR_PARITY: &str = "wf.md16";

/// Key of the gain of the position loop in (mm/min)/um.
pub(super) const SERVO_GAIN: &str = "wf.md22";

/// Parameters of each vocabulary that no other part of the axis uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Vocabularies {
    /// Parameters of the reference selector.
    pub amc: amc::Parameters,
    /// Parameters of the command flags.
    pub saia: saia::Parameters,
    /// Parameters of the positioning modules.
    pub wf: wf::Parameters,
}

impl Vocabularies {
    /// Checks that they agree with those of the axis, and with each other.
    ///
    /// # Errors
    /// The keys of two parameters: the value of the first exceeds that of the second.
    pub(super) fn check(&self, axis: &AxisParameters) -> Result<(), (&'static str, &'static str)> {
        self.wf.check(axis)
    }

    /// Returns true if these parameters command the same as `before`.
    pub fn commands_as(&self, before: &Self) -> bool {
        self.amc == before.amc
    }

    /// Returns true if they select a reference that `before` did not select.
    pub fn selects(&self, before: &Self) -> bool {
        let is_selected = |now: i64, before: i64| now != before && now != 0;
        is_selected(self.amc.reference_select, before.amc.reference_select)
            || is_selected(self.amc.reference_select_trigger, before.amc.reference_select_trigger)
    }

    /// Returns the index of the parameter that starts a motion when these parameters replace `before`.
    pub fn starts_motion(&self, before: &Self) -> Option<u16> {
        let select = self.amc.reference_select;
        (select != 0 && select != before.amc.reference_select).then_some(const { Row::place("amc.reference_select") })
    }
}

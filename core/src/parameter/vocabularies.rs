//! The parameters of the vocabularies of an axis.

use super::{AxisParameters, Row, amc, saia, wf};
use serde::{Deserialize, Serialize};

/// Key of the parameter that makes the encoder of a drive an absolute one.
pub const ENCODER_KIND: &str = "wf.md4";
/// Key of the side of the cam, or of what is left out of absolute words.
pub const SIDE_OR_OMITTED: &str = "wf.md7";
/// Key of the reference point, or of the parity of absolute words.
pub const REFERENCE_OR_PARITY: &str = "wf.md16";

/// Key of the gain of the position loop in (mm/min)/um.
pub(super) const SERVO_GAIN: &str = "wf.md22";

/// Of each vocabulary, what no other part of the axis has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Vocabularies {
    /// Of the reference selector.
    pub amc: amc::Parameters,
    /// Of the command flags.
    pub saia: saia::Parameters,
    /// Of the positioning modules.
    pub wf: wf::Parameters,
}

impl Vocabularies {
    /// Do they agree with those of the axis, and with each other?
    ///
    /// # Errors
    /// The first one's key: its value is above that of the second, which it must not be.
    pub(super) fn check(&self, axis: &AxisParameters) -> Result<(), (&'static str, &'static str)> {
        self.wf.check(axis)
    }

    /// Do these ask the same of the axis as those, which only change by being asked anew?
    pub fn commands_as(&self, before: &Self) -> bool {
        self.amc == before.amc
    }

    /// Do they select anything that those did not?
    pub fn selects(&self, before: &Self) -> bool {
        let is_selected = |now: i64, before: i64| now != before && now != 0;
        is_selected(self.amc.reference_select, before.amc.reference_select)
            || is_selected(self.amc.reference_select_trigger, before.amc.reference_select_trigger)
    }

    /// The place of the parameter that begins a motion by itself where these are in force after those.
    pub fn starts_motion(&self, before: &Self) -> Option<u16> {
        let select = self.amc.reference_select;
        (select != 0 && select != before.amc.reference_select).then_some(const { Row::place("amc.reference_select") })
    }
}

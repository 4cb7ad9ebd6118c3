//! Parameters of a gantry.

use serde::{Deserialize, Serialize};

/// How the two drives of an axis are held together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GantryParameters {
    /// Most that it may be from square (inc); given wherever an axis has two drives.
    pub max_skew: Option<i64>,
    /// What being further from square does: a number of error_reaction.
    pub skew_reaction: i64,
    /// Most that homing may find it from square (inc); left out: ten times `max_skew`.
    pub squaring_distance: Option<i64>,
    /// Counts of the second drive minus counts of the first where it is square, where that is known (inc).
    pub square_offset: Option<i64>,
    /// Input that is the reference switch of the second drive: n, -n inverted, 0 none.
    pub second_refswitch: i64,
}

impl GantryParameters {
    /// Most that it may be from square (inc).
    pub fn skew_limit(&self) -> i64 {
        self.max_skew.unwrap_or(0)
    }

    /// Most that homing may find it from square (inc).
    pub fn squaring_limit(&self) -> i64 {
        self.squaring_distance.unwrap_or(self.skew_limit().saturating_mul(10))
    }
}

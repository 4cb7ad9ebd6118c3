//! Parameters of a gantry.

use serde::{Deserialize, Serialize};

/// Coupling of the two drives of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GantryParameters {
    /// Maximum skew (inc); required for an axis with two drives.
    pub max_skew: Option<i64>,
    /// Reaction to a larger skew: a number of error_reaction.
    pub skew_reaction: i64,
    /// Maximum skew that homing may correct (inc); `None`: ten times `max_skew`.
    pub squaring_distance: Option<i64>,
    /// Counts of the second drive minus counts of the first without skew, if known (inc).
    pub square_offset: Option<i64>,
    /// Input of the reference switch of the second drive: n, -n inverted, 0 none.
    pub second_refswitch: i64,
}

impl GantryParameters {
    /// Returns the maximum skew (inc).
    pub fn skew_limit(&self) -> i64 {
        self.max_skew.unwrap_or(0)
    }

    /// Returns the maximum skew that homing may correct (inc).
    pub fn squaring_limit(&self) -> i64 {
        self.squaring_distance.unwrap_or(self.skew_limit().saturating_mul(10))
    }
}

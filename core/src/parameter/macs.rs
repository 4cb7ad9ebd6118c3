//! Values that MACS gives relative to others: a velocity in RPM at the encoder, accelerations and jerks as times,
//! defaults as fractions of VELRES. A relative value stays relative: after a new VELMAX, RAMPMIN is the same time, and
//! the acceleration changes. A value that is given by its native name is absolute, and stays absolute. The result
//! therefore does not depend on the order of sets.

use super::{AxisParameters, Row, Value};
use crate::encoder::source::AbsoluteSources;
use crate::position::Position;
use crate::unit::{MLONG, MacsFactors};
use serde::{Deserialize, Serialize};

/// Largest position (inc).
const LARGEST: i64 = Position::LIMIT - 1;

/// Values of MACS in addition to the native values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Macs {
    /// VELMAX as given (rpm); `None` if max_velocity was given.
    pub velmax: Option<f64>,
    /// RAMPMIN as given (ns).
    pub rampmin: Option<i64>,
    /// JERKMIN as given (ns); 0: no limit.
    pub jerkmin: Option<i64>,
    /// DFLTVEL as given (1/VELRES).
    pub dfltvel: Option<i64>,
    /// DFLTACC as given (1/VELRES).
    pub dfltacc: Option<i64>,
    /// NEGLIMIT (inc), kept while the limit is off.
    pub neglimit: i64,
    /// POSLIMIT (inc), kept while the limit is off.
    pub poslimit: i64,
    /// ENCODER (counts/rev).
    pub encoder: i64,
    /// VELRES
    pub velres: i64,
    /// PROFTIME (ms)
    pub proftime: i64,
    /// POSDRCT: direction of rotation.
    pub posdrct: i64,
    /// REVERS: condition for backward motion.
    pub revers: i64,
    /// MENCODER (counts/rev); negative: signals of the master are scaled.
    pub mencoder: i64,
    /// Scale as given by the cell, or as a ratio; `None` if its numbers are too large for that.
    pub scale: Option<MacsFactors>,
}

impl Default for Macs {
    /// Returns the defaults of MACS.
    fn default() -> Self {
        Self {
            velmax: None,
            rampmin: None,
            jerkmin: None,
            dfltvel: None,
            dfltacc: None,
            neglimit: -500_000,
            poslimit: 500_000,
            encoder: 500,
            velres: 100,
            proftime: 1,
            posdrct: 1,
            revers: 0,
            mencoder: 500,
            scale: None,
        }
    }
}

impl AxisParameters {
    /// Returns a revolution of the encoder (inc): four counts per line, or values of an absolute encoder 1:1
    /// (MACS-ENC-01).
    pub fn revolution(&self) -> i64 {
        if self.encoder.is_absolute() { self.macs.encoder } else { self.macs.encoder.saturating_mul(4) }
    }

    /// Returns the parameters for a cell with these sources.
    #[must_use]
    pub fn with_sources(mut self, sources: AbsoluteSources) -> Self {
        self.encoder.absolute = sources;
        self.derive();
        self
    }

    /// Computes the values that derive from those of MACS.
    pub(super) fn derive(&mut self) {
        let revolution = self.revolution() as f64;
        let macs = &self.macs;
        if let Some(rpm) = macs.velmax {
            self.max_velocity = rpm * revolution / 60.0;
        }
        if let Some(time) = macs.rampmin {
            self.max_acceleration = self.max_velocity / seconds(time);
        }
        if let Some(time) = macs.jerkmin {
            self.max_jerk = (time > 0).then(|| self.max_acceleration / seconds(time));
        }
        let share = |part: i64| part as f64 / macs.velres as f64;
        if let Some(part) = macs.dfltvel {
            self.default_velocity = Some(share(part) * self.max_velocity);
        }
        if let Some(part) = macs.dfltacc {
            self.default_acceleration = Some(share(part) * self.max_acceleration);
        }
        self.derive_homing();
        self.position_loop.derive();
    }

    /// Returns VELMAX (rpm) (MACS-PROF-01).
    pub fn velmax(&self) -> f64 {
        self.macs.velmax.unwrap_or(self.max_velocity * 60.0 / self.revolution() as f64)
    }

    /// Returns RAMPMIN (ns), rounded to the nearest (MACS-PROF-03).
    pub fn rampmin(&self) -> i64 {
        self.macs.rampmin.unwrap_or_else(|| nanoseconds(self.max_velocity / self.max_acceleration))
    }

    /// Returns JERKMIN (ns), rounded to the nearest; 0 without a limit (MACS-PROF-10).
    pub fn jerkmin(&self) -> i64 {
        let of_jerk = || self.max_jerk.map_or(0, |jerk| nanoseconds(self.max_acceleration / jerk));
        self.macs.jerkmin.unwrap_or_else(of_jerk)
    }

    /// Returns DFLTVEL (1/VELRES), rounded to the nearest (MACS-PROF-04, MACS-PROF-06).
    pub fn dfltvel(&self) -> i64 {
        let share = || self.default_goal_velocity() / self.max_velocity;
        self.macs.dfltvel.unwrap_or_else(|| (share() * self.macs.velres as f64).round() as i64)
    }

    /// Returns DFLTACC (1/VELRES), rounded to the nearest (MACS-PROF-04, MACS-PROF-06).
    pub fn dfltacc(&self) -> i64 {
        let share = || self.default_goal_acceleration() / self.max_acceleration;
        self.macs.dfltacc.unwrap_or_else(|| (share() * self.macs.velres as f64).round() as i64)
    }

    /// Returns the active NEGLIMIT (inc): the limit of decreasing counts, which is the upper one in inverted units
    ///
    pub fn active_neglimit(&self) -> Option<i64> {
        if self.is_inverted() { self.max_position.map(i64::saturating_neg) } else { self.min_position }
    }

    /// Returns the active POSLIMIT (inc): the limit of increasing counts.
    pub fn active_poslimit(&self) -> Option<i64> {
        if self.is_inverted() { self.min_position.map(i64::saturating_neg) } else { self.max_position }
    }

    pub(super) fn set_falling(&mut self, limit: Option<i64>) {
        let inverted = limit.map(i64::saturating_neg);
        if self.is_inverted() {
            self.max_position = inverted
        } else {
            self.min_position = limit
        }
        self.keep_limits();
    }

    pub(super) fn set_rising(&mut self, limit: Option<i64>) {
        let inverted = limit.map(i64::saturating_neg);
        if self.is_inverted() {
            self.min_position = inverted
        } else {
            self.max_position = limit
        }
        self.keep_limits();
    }

    /// Shifts the limits by `by` (inc), so that they keep their physical places after a shift of the coordinate
    /// (MACS-LIM-01).
    pub fn shift_limits(&mut self, by: i64) {
        let moved = |limit: Option<i64>| limit.map(|limit| limit.saturating_add(by));
        (self.min_position, self.max_position) = (moved(self.min_position), moved(self.max_position));
        // Limits that are off are shifted, too; none is limited to the range of MACS, which would move its place.
        let by = if self.is_inverted() { by.saturating_neg() } else { by };
        self.macs.neglimit = self.macs.neglimit.saturating_add(by).clamp(-LARGEST, LARGEST);
        self.macs.poslimit = self.macs.poslimit.saturating_add(by).clamp(-LARGEST, LARGEST);
        self.keep_limits();
    }

    /// Sets NEGLIMIT and POSLIMIT for the time when they are off: the nearest number of MACS to the active limits.
    pub(super) fn keep_limits(&mut self) {
        let of_macs = |limit: Option<i64>, kept: i64| match limit {
            // A new coordinate has shifted the limit.
            Some(limit) if limit != kept => limit.clamp(-MLONG, MLONG),
            _ => kept,
        };
        self.macs.neglimit = of_macs(self.active_neglimit(), self.macs.neglimit);
        self.macs.poslimit = of_macs(self.active_poslimit(), self.macs.poslimit);
    }

    /// Changes POSDRCT: if its sign changes, the limits keep their physical places.
    pub(super) fn set_posdrct(&mut self, posdrct: i64) {
        let was_inverted = self.is_inverted();
        self.macs.posdrct = posdrct;
        if self.is_inverted() != was_inverted {
            let mirror = |limit: Option<i64>| limit.map(i64::saturating_neg);
            (self.min_position, self.max_position) = (mirror(self.max_position), mirror(self.min_position));
            self.homing.offset = self.homing.offset.saturating_neg();
        }
        self.keep_limits();
    }

    /// Returns the parameters in the direction of rotation of other ones: the base for changes of further rows (the row
    /// of the direction is applied first).
    pub fn with_direction_of(mut self, other: &Self) -> Self {
        self.set_posdrct(other.macs.posdrct);
        self
    }

    fn is_inverted(&self) -> bool {
        self.macs.posdrct < 0
    }

    /// Returns VELMAXQC (inc/ms/65536), truncated (MACS-PROF-02).
    pub fn velmaxqc(&self) -> i64 {
        (self.max_velocity / 1000.0 * 65536.0) as i64
    }

    /// Returns ACCMAXQC (inc/ms^2/65536), truncated (MACS-PROF-03).
    pub fn accmaxqc(&self) -> i64 {
        (self.max_acceleration / 1e6 * 65536.0) as i64
    }

    /// Returns true if the value was given by this row. Writing only these rows, and reading them, gives the same
    /// parameters.
    pub fn is_given_by(&self, row: &Row) -> bool {
        let by_view = self.is_by_view(row.root()).unwrap_or(false);
        match row.key {
            // The value of a limit that is off; an active limit is the native value.
            "neglimit" => self.active_neglimit().is_none(),
            "poslimit" => self.active_poslimit().is_none(),
            _ if row.is_view() => by_view,
            _ => row.is_stored() && !by_view,
        }
    }

    /// Returns true if the value of this root was given by its view; `None` if that makes no difference.
    fn is_by_view(&self, root: &str) -> Option<bool> {
        let macs = &self.macs;
        match root {
            "max_velocity" => Some(macs.velmax.is_some()),
            "max_acceleration" => Some(macs.rampmin.is_some()),
            "max_jerk" => Some(macs.jerkmin.is_some()),
            "default_velocity" => Some(macs.dfltvel.is_some()),
            "default_acceleration" => Some(macs.dfltacc.is_some()),
            "homing.velocity" => Some(self.homing.parts.velocity.is_some()),
            "homing.index_velocity" => Some(self.homing.parts.index_velocity.is_some()),
            "homing.acceleration" => Some(self.homing.parts.acceleration.is_some()),
            "position_loop.kv" => Some(self.position_loop.given.is_some()),
            // 0 and 1 are the same by both names.
            "homing.required" => self.homing.told_done.then_some(true),
            _ => None,
        }
    }

    /// Returns true if the row has this value, as if nothing else had been set after it.
    pub fn has_value(&self, row: &Row, value: Value) -> bool {
        row.value(self) == value && self.is_by_view(row.root()).is_none_or(|by_view| by_view == row.is_view())
    }

    /// Returns true if all derived values are consistent.
    pub(super) fn is_derived(&self) -> bool {
        let mut copy = *self;
        copy.derive();
        copy == *self
    }
}

fn seconds(nanoseconds: i64) -> f64 {
    nanoseconds as f64 / 1e9
}

/// Converts seconds to nanoseconds; the cast saturates.
fn nanoseconds(seconds: f64) -> i64 {
    (seconds * 1e9).round() as i64
}

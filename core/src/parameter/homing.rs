//! Parameters of homing, and the inputs and outputs that are assigned to an axis.

use super::AxisParameters;
use serde::{Deserialize, Serialize};

/// Homing of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Homing {
    /// Homing method: 0 none; a method of CiA 402; -1 - HOME_TYPE of MACS.
    pub method: i64,
    /// Whether the drive homes by itself.
    pub in_drive: bool,
    /// Whether motion requires homing.
    pub required: bool,
    /// Whether that was given as HOME_FORCE 255, required and done: it is shown as such, and acts like 1.
    pub told_done: bool,
    /// Velocity to the switch (inc/s); its sign is the direction of the MACS sequences. `None`: a tenth of
    /// `max_velocity`.
    pub velocity: Option<f64>,
    /// Velocity of the last approach and to the index (inc/s), at most `velocity`. `None`: a tenth of `max_velocity`.
    pub index_velocity: Option<f64>,
    /// Acceleration (inc/s^2), at most the default acceleration. `None`: a tenth of `max_acceleration`.
    pub acceleration: Option<f64>,
    /// Position of the zero, relative to the switch or the index (inc).
    pub offset: i64,
    /// Source of the deceleration cam of reference travel: 0 the vocabulary, 1 the reference switch.
    pub cam_source: i64,
    /// Maximum distance to an index pulse (inc); `None`: one revolution of the encoder.
    pub index_distance: Option<i64>,
    /// Maximum distance of each search for a switch (inc); `None`: twice the distance between the software limits, or
    /// twice the modulo.
    pub max_distance: Option<i64>,
    /// Maximum time of homing, from its start to the zero (ns); 0: no limit.
    pub max_time: i64,
    /// Values that MACS gives as fractions of others.
    pub parts: HomingParts,
}

/// HOME_VEL, HOMEZEROVEL and HOME_RAMP as given (1/VELRES); `None` if the native value was given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HomingParts {
    /// HOME_VEL
    pub velocity: Option<i64>,
    /// HOMEZEROVEL
    pub index_velocity: Option<i64>,
    /// HOME_RAMP
    pub acceleration: Option<i64>,
}

/// HOME_FORCE of a controller on which homing is required and was done.
const TOLD_DONE: i64 = 255;
/// Relative difference up to which two values of one rate, given by different names, are equal.
const SAME: f64 = 1e-12;
/// Fraction of the maxima for homing without given values (defaults of HOME_VEL, HOMEZEROVEL and HOME_RAMP: 10 of 100).
const USUAL_SHARE: f64 = 0.1;

impl AxisParameters {
    /// Returns the velocity to the switch, signed (inc/s) (MACS-HOME-01).
    pub fn homing_velocity(&self) -> f64 {
        self.homing.velocity.unwrap_or(self.max_velocity * USUAL_SHARE)
    }

    /// Returns the velocity of the last approach and to the index (inc/s).
    pub fn homing_index_velocity(&self) -> f64 {
        self.homing_slow().min(self.homing_velocity().abs())
    }

    /// Returns the velocity to the index before it is limited.
    fn homing_slow(&self) -> f64 {
        self.homing.index_velocity.unwrap_or(self.max_velocity * USUAL_SHARE)
    }

    /// Returns the acceleration of homing (inc/s^2) (MACS-HOME-02).
    pub fn homing_acceleration(&self) -> f64 {
        self.homing_ramp().min(self.default_goal_acceleration())
    }

    fn homing_ramp(&self) -> f64 {
        self.homing.acceleration.unwrap_or(self.max_acceleration * USUAL_SHARE)
    }

    /// Returns the maximum distance to an index pulse (inc) (MACS-HOME-05).
    pub fn homing_index_distance(&self) -> i64 {
        self.homing.index_distance.unwrap_or_else(|| self.revolution())
    }

    /// Returns the maximum distance of each search for a switch, as given or from the software limits (inc); `None`
    /// without them.
    pub fn homing_max_distance(&self) -> Option<i64> {
        let between = || Some(self.max_position?.saturating_sub(self.min_position?).saturating_mul(2));
        self.homing.max_distance.or_else(between)
    }

    /// Computes the values that derive from fractions of MACS.
    pub(super) fn derive_homing(&mut self) {
        let velres = self.macs.velres as f64;
        let share = |part: i64| part as f64 / velres;
        let parts = self.homing.parts;
        if let Some(part) = parts.velocity {
            self.homing.velocity = Some(share(part) * self.max_velocity);
        }
        // HOMEZEROVEL is limited to HOME_VEL, which is within VELMAX.
        if let Some(part) = parts.index_velocity {
            self.homing.index_velocity = Some(share(part).min(1.0) * self.max_velocity);
        }
        if let Some(part) = parts.acceleration {
            self.homing.acceleration = Some(share(part) * self.max_acceleration);
        }
    }

    /// Returns HOME_VEL (1/VELRES), rounded to the nearest.
    pub fn home_vel(&self) -> i64 {
        self.homing.parts.velocity.unwrap_or_else(|| self.part(self.homing_velocity() / self.max_velocity))
    }

    /// Returns HOMEZEROVEL (1/VELRES), rounded to the nearest.
    pub fn homezerovel(&self) -> i64 {
        self.homing.parts.index_velocity.unwrap_or_else(|| self.part(self.homing_slow() / self.max_velocity))
    }

    /// Returns HOME_RAMP (1/VELRES), rounded to the nearest.
    pub fn home_ramp(&self) -> i64 {
        self.homing.parts.acceleration.unwrap_or_else(|| self.part(self.homing_ramp() / self.max_acceleration))
    }

    fn part(&self, share: f64) -> i64 {
        (share * self.macs.velres as f64).round() as i64
    }

    /// Returns HOME_FORCE as it was given.
    pub fn home_force(&self) -> i64 {
        if self.homing.told_done { TOLD_DONE } else { self.homing.required.into() }
    }

    pub(super) fn set_home_force(&mut self, force: i64) {
        (self.homing.required, self.homing.told_done) = (force != 0, force == TOLD_DONE);
    }

    /// Returns HOME_OFFSET, which is in the direction of the counts, while `homing.offset` is in that of the
    /// axis.
    pub fn home_offset(&self) -> i64 {
        if self.macs.posdrct < 0 { self.homing.offset.saturating_neg() } else { self.homing.offset }
    }

    pub(super) fn set_home_offset(&mut self, offset: i64) {
        self.homing.offset = if self.macs.posdrct < 0 { offset.saturating_neg() } else { offset };
    }

    /// Returns true if a change invalidates the present zero: encoder, its type, direction of rotation, homing.
    /// A soft change of the type keeps the position, and so the zero (MACS-ENC-11).
    pub fn invalidates_zero(&self, new: &Self) -> bool {
        // A rate that is given by another name may be equal.
        let rest = |p: &Self| Homing {
            velocity: None,
            index_velocity: None,
            acceleration: None,
            parts: HomingParts::default(),
            told_done: false,
            max_time: 0,
            ..p.homing
        };
        let rates = |p: &Self| {
            let (parts, own) = (p.homing.parts, p.homing);
            [
                (parts.velocity, own.velocity, p.homing_velocity()),
                (parts.index_velocity, own.index_velocity, p.homing_slow()),
                (parts.acceleration, own.acceleration, p.homing_ramp()),
            ]
        };
        let changes_rate = std::iter::zip(rates(self), rates(new)).any(|(before, after)| {
            let is_given_so = match (before.0, after.0) {
                (None, None) => before.1 == after.1,
                (before, after) => before == after,
            };
            !is_given_so && (before.2 - after.2).abs() > before.2.abs() * SAME
        });
        let changes_type = self.encoder.encodertype != new.encoder.encodertype && new.encoder.enccontrol & 1 == 0;
        rest(self) != rest(new)
            || changes_rate
            || self.macs.encoder != new.macs.encoder
            || self.sense() != new.sense()
            || changes_type
    }
}

/// Inputs by number: n, -n inverted, 0 none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Assigned {
    /// I_REFSWITCH
    pub refswitch: i64,
    /// I_POSLIMITSW
    pub poslimitsw: i64,
    /// I_NEGLIMITSW
    pub neglimitsw: i64,
}

/// Outputs by number: n, -n inverted, 0 none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AssignedOutputs {
    /// O_BRAKE
    pub brake: i64,
    /// O_AXMOVE
    pub axmove: i64,
}

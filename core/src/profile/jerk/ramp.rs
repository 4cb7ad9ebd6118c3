//! A ramp: a change of velocity in one direction, whose acceleration rises, holds and falls to zero.

use super::super::plan::Draft;

/// Acceleration limits in one direction, with derived values.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    /// Largest acceleration (inc/s^2).
    pub(super) limit: f64,
    /// Jerks of the rise and of the fall (inc/s^3).
    pub(super) rise: f64,
    pub(super) fall: f64,
    /// 1 / rise and 1 / fall (s^3/inc)
    per_rise: f64,
    per_fall: f64,
    /// 1 / rise + 1 / fall (s^3/inc)
    pub(super) per_jerk: f64,
    /// Inverse of `per_jerk` (inc/s^3).
    peak_growth: f64,
    pub(super) per_limit: f64,
}

impl Side {
    pub(super) fn new(limit: f64, rise: f64, fall: f64) -> Self {
        let (per_rise, per_fall) = (1.0 / rise, 1.0 / fall);
        let per_jerk = per_rise + per_fall;
        Self {
            limit,
            rise,
            fall,
            per_rise,
            per_fall,
            per_jerk,
            peak_growth: rise * fall / (rise + fall),
            per_limit: 1.0 / limit,
        }
    }

    /// Returns the change of velocity while an acceleration falls to zero (inc/s).
    pub(super) fn fall_off(&self, acceleration: f64) -> f64 {
        0.5 * acceleration * acceleration * self.per_fall
    }

    /// Returns the excess (inc/s) from which on a ramp that begins with `acceleration` reaches its limit.
    pub(super) fn excess_to_hold(&self, acceleration: f64) -> f64 {
        0.5 * (self.limit - acceleration) * (self.limit + acceleration) * self.per_jerk
    }
}

/// A phase in which an acceleration is reduced to zero, or towards it, with the jerk of its fall.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ease {
    velocity: f64,
    from: f64,
    /// Jerk against the acceleration (inc/s^3).
    jerk: f64,
    time: f64,
    pub(super) way: f64,
}

impl Ease {
    pub(super) fn none() -> Self {
        Self { velocity: 0.0, from: 0.0, jerk: 0.0, time: 0.0, way: 0.0 }
    }

    /// Returns the phase from acceleration `from` to `to`, which is not larger and has the same sign or is 0.
    pub(super) fn new(velocity: f64, from: f64, to: f64, side: &Side) -> Self {
        let jerk = -side.fall.copysign(from);
        let time = (from - to).abs() * side.per_fall;
        let way = time * (velocity + time * (0.5 * from + jerk * time * (1.0 / 6.0)));
        Self { velocity, from, jerk, time, way }
    }

    /// Returns the change of velocity (inc/s).
    pub(super) fn change(&self) -> f64 {
        self.time * (self.from + 0.5 * self.jerk * self.time)
    }

    pub(super) fn add(&self, draft: &mut Draft<'_>, sign: f64) {
        draft.forward(self.time, sign * self.velocity, sign * self.from, sign * self.jerk);
    }
}

/// A ramp upwards or downwards.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ramp<'a> {
    side: &'a Side,
    /// 1 upwards, -1 downwards.
    sign: f64,
    from: f64,
    to: f64,
    /// Initial acceleration, in the direction of the ramp.
    begin: f64,
    pub(super) peak: f64,
    rise_time: f64,
    hold_time: f64,
    fall_time: f64,
}

impl<'a> Ramp<'a> {
    /// Returns a ramp from velocity `from` with acceleration `begin` in its direction to velocity `to`. `excess` is the
    /// distance of `to` beyond the velocity after the fall of `begin` to zero; it is a separate argument because a
    /// difference of velocities would lose digits.
    #[inline]
    pub(super) fn new(side: &'a Side, sign: f64, from: f64, begin: f64, excess: f64, to: f64) -> Self {
        let excess = excess.max(0.0);
        let beyond = excess - side.excess_to_hold(begin);
        let (peak, rise, hold_time) = if beyond >= 0.0 {
            (side.limit, side.limit - begin, beyond * side.per_limit)
        } else {
            let (square, gain) = (begin * begin, 2.0 * excess * side.peak_growth);
            let peak = (square + gain).sqrt();
            // Both expressions are equal: the difference is faster, the quotient is more accurate.
            (peak, if gain >= square { peak - begin } else { gain / (peak + begin) }, 0.0)
        };
        let (rise_time, fall_time) = (rise.max(0.0) * side.per_rise, peak * side.per_fall);
        Self { side, sign, from, to, begin, peak, rise_time, hold_time, fall_time }
    }

    /// Returns the velocities at the end of the rise and of the hold.
    fn middle(&self) -> (f64, f64) {
        let risen = self.from + self.sign * 0.5 * (self.begin + self.peak) * self.rise_time;
        (risen, self.to - self.sign * 0.5 * self.peak * self.fall_time)
    }

    #[inline]
    pub(super) fn distance(&self) -> f64 {
        let (t1, t2, t3) = (self.rise_time, self.hold_time, self.fall_time);
        let (risen, held) = self.middle();
        let rise = t1 * (self.from + self.sign * t1 * (2.0 * self.begin + self.peak) * (1.0 / 6.0));
        let fall = t3 * (held + self.sign * t3 * self.peak * (1.0 / 3.0));
        rise + 0.5 * t2 * (risen + held) + fall
    }

    /// Returns first and second derivative of the distance of a ramp upwards by its end velocity, or of a ramp
    /// downwards by its start velocity, at the end without acceleration (s, s^2/inc).
    #[inline]
    pub(super) fn slopes(&self) -> (f64, f64) {
        let (velocity, per_jerk) =
            if self.sign > 0.0 { (self.to, self.side.per_fall) } else { (self.from, self.side.per_rise) };
        self.slopes_by(velocity, per_jerk)
    }

    /// Returns the decrease of the distance of a ramp downwards with its end velocity (s).
    pub(super) fn slope_back(&self) -> f64 {
        self.slopes_by(self.to, -self.side.per_fall).0
    }

    #[inline]
    fn slopes_by(&self, velocity: f64, per_jerk: f64) -> (f64, f64) {
        let per_peak = 1.0 / self.peak;
        let slope = velocity * per_peak + 0.5 * self.peak * per_jerk;
        // If the limit is held, more velocity takes more time at it; otherwise a higher peak.
        let growth = if self.hold_time > 0.0 { 0.0 } else { per_peak * self.side.peak_growth };
        (slope, per_peak + growth * (0.5 * per_jerk - velocity * per_peak * per_peak))
    }

    pub(super) fn add_forward(&self, draft: &mut Draft<'_>, sign: f64) {
        let (risen, held) = self.middle();
        let sign_of_ramp = sign * self.sign;
        let peak = sign_of_ramp * self.peak;
        draft.forward(self.rise_time, sign * self.from, sign_of_ramp * self.begin, sign_of_ramp * self.side.rise);
        draft.forward(self.hold_time, sign * risen, peak, 0.0);
        draft.forward(self.fall_time, sign * held, peak, -sign_of_ramp * self.side.fall);
    }

    pub(super) fn add_backward(&self, draft: &mut Draft<'_>, sign: f64) {
        let (risen, held) = self.middle();
        let sign_of_ramp = sign * self.sign;
        let peak = sign_of_ramp * self.peak;
        draft.backward(self.fall_time, sign * self.to, 0.0, -sign_of_ramp * self.side.fall);
        draft.backward(self.hold_time, sign * held, peak, 0.0);
        draft.backward(self.rise_time, sign * risen, peak, sign_of_ramp * self.side.rise);
    }
}

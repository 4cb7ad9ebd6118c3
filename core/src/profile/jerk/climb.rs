//! The search for the ramps that lead to a target.
//!
//! From the direct ramp to the end velocity on, every moment more that a plan takes can be spent so that it gets as far up
//! as possible: a braking at the start is relieved for a while (a dip) until it vanishes, then the velocity between the
//! two ramps goes up to its limit, then the plan cruises there. What is reached is a continuous function of that moment;
//! the first place where it meets the target is the fastest plan.

use super::super::plan::Draft;
use super::ramp::{Ease, Ramp, Side};

/// Newton's steps with bisection: each halves the bracket or the miss, so this is far more than f64 has digits for.
const MAX_STEPS: usize = 200;
/// Way that no position resolves (inc).
const NEGLIGIBLE: f64 = 2e-11;
/// A step of Newton's that is so small is the last: the error after it goes by its square, after Halley's by its cube.
const LAST_NEWTON: f64 = 1e-8;
const LAST_HALLEY: f64 = 1e-5;
/// 0.045 of the bits of a fraction.
const LOGARITHM_BIAS: i64 = 202_661_983_231_672;

/// How a target is reached.
#[derive(Clone, Copy, Debug)]
pub(super) enum Choice {
    /// Straight to the end velocity.
    Direct,
    /// Relieving the braking at the start by so much (inc/s^2).
    Dip(f64),
    /// Over a velocity so much above the higher one of what is left and the end velocity (inc/s), cruising there for a
    /// time (s).
    Over(f64, f64),
    /// From beyond the top over a velocity so much below what is left (inc/s), cruising there for a time (s).
    Below(f64, f64),
}

/// The task: upwards, further than the direct ramp. Velocities of one sign only, or the same limits for both.
#[derive(Clone, Copy, Debug)]
pub(super) struct Climb<'a> {
    velocity: f64,
    /// Within its limit.
    acceleration: f64,
    end_velocity: f64,
    /// Limit of velocity; no less than the end velocity.
    top: f64,
    /// Limits of acceleration above and below zero.
    up: &'a Side,
    down: &'a Side,
    /// Velocity that is left when the acceleration at the start has run out.
    run_out: f64,
}

/// Where a ramp begins, and what comes before it.
#[derive(Clone, Copy, Debug)]
struct Begin {
    ease: Ease,
    velocity: f64,
    /// In the direction of the ramp.
    acceleration: f64,
}

/// By how much a course misses the target.
#[derive(Clone, Copy, Debug)]
struct Reach {
    miss: f64,
    /// Size of what the miss is the difference of: its rounding.
    scale: f64,
    /// First and second derivative of the miss by what is searched; the second may be unknown, NaN.
    slope: f64,
    bend: f64,
}

impl Reach {
    fn hits(&self) -> bool {
        self.miss.abs() <= NEGLIGIBLE + 4e-16 * self.scale
    }

    /// The same, searched by the root of what it was searched by.
    #[inline]
    fn by_root(self, root: f64) -> Self {
        let slope = 2.0 * root * self.slope;
        Self { slope, bend: 2.0 * self.slope + 4.0 * root * root * self.bend, ..self }
    }
}

impl<'a> Climb<'a> {
    /// The task from a velocity and an acceleration that is within its limit.
    pub(super) fn new(
        (velocity, acceleration): (f64, f64),
        end_velocity: f64,
        top: f64,
        (up, down): (&'a Side, &'a Side),
    ) -> Self {
        let top = top.max(end_velocity);
        let side = if acceleration >= 0.0 { up } else { down };
        let change = side.fall_off(acceleration).copysign(acceleration);
        let left = velocity + change;
        // The time of a ramp goes by the root of its velocity: last digits must not become one.
        let rounding = 1e-14 * (velocity.abs() + change.abs());
        let run_out = if (left - end_velocity).abs() <= rounding {
            end_velocity
        } else if (left - top).abs() <= rounding {
            top
        } else {
            left
        };
        Self { velocity, acceleration, end_velocity, top, up, down, run_out }
    }

    fn ease_to(&self, acceleration: f64) -> Ease {
        let side = if self.acceleration >= 0.0 { self.up } else { self.down };
        Ease::new(self.velocity, self.acceleration, acceleration, side)
    }

    /// How a ramp upwards begins: with the acceleration at the start, or when that has run out.
    fn upwards(&self) -> Begin {
        if self.acceleration > 0.0 {
            Begin { ease: Ease::none(), velocity: self.velocity, acceleration: self.acceleration }
        } else {
            Begin { ease: self.ease_to(0.0), velocity: self.run_out, acceleration: 0.0 }
        }
    }

    fn downwards(&self) -> Begin {
        if self.acceleration < 0.0 {
            Begin { ease: Ease::none(), velocity: self.velocity, acceleration: -self.acceleration }
        } else {
            Begin { ease: self.ease_to(0.0), velocity: self.run_out, acceleration: 0.0 }
        }
    }

    /// Straight to the end velocity.
    fn direct(&self) -> (Begin, Ramp<'a>) {
        let (run_out, end) = (self.run_out, self.end_velocity);
        let (begin, side, sign) =
            if end >= run_out { (self.upwards(), self.up, 1.0) } else { (self.downwards(), self.down, -1.0) };
        (begin, Ramp::new(side, sign, begin.velocity, begin.acceleration, sign * (end - run_out), end))
    }

    pub(super) fn direct_way(&self) -> f64 {
        let (begin, ramp) = self.direct();
        begin.ease.way + ramp.way()
    }

    /// What gets `distance` far, which is more than the `direct` way does; none where it would have to go beyond a top of
    /// zero.
    pub(super) fn solve(&self, distance: f64, direct: f64) -> Option<Choice> {
        let end = self.end_velocity;
        if self.run_out > self.top {
            return Some(self.solve_beyond(distance));
        }
        let mut ahead = distance - direct;
        if self.acceleration < 0.0 && end < self.run_out {
            if let Some(relief) = self.dip(distance) {
                return Some(Choice::Dip(relief));
            }
            ahead = -self.reach_with_dip(distance, -self.acceleration).miss;
        }
        self.solve_over(distance, ahead)
    }

    /// Beyond the top the way back to it comes first: a dip would only keep the velocity there longer.
    fn solve_beyond(&self, distance: f64) -> Choice {
        let begin = self.downwards();
        let most = self.run_out - self.top;
        let at_top = self.reach_below(&begin, distance, most);
        if at_top.miss <= 0.0 && self.top > 0.0 {
            return Choice::Below(most, -at_top.miss / self.top);
        }
        if self.acceleration < 0.0
            && self.end_velocity < self.run_out
            && let Some(relief) = self.dip(distance)
        {
            return Choice::Dip(relief);
        }
        let high = most.sqrt();
        let root = search(0.0, high, high, |root| self.reach_below(&begin, distance, root * root).by_root(root));
        Choice::Below(root * root, 0.0)
    }

    /// Over a velocity above that of the start and the end, which lacks `ahead` of the target.
    fn solve_over(&self, distance: f64, ahead: f64) -> Option<Choice> {
        let low = self.low();
        let begin = self.upwards();
        let top = self.top - low;
        let hold = (self.up.excess_to_hold(begin.acceleration) - (low - self.run_out))
            .max(self.down.excess_to_hold(0.0) - (low - self.end_velocity))
            .max(0.0);
        let most = top.min(hold);
        let reach = self.reach_above(&begin, distance, low, most);
        if reach.miss > 0.0 {
            // Steps go by the root of the velocity, in which the way has a slope even at 0.
            let high = most.sqrt();
            let reach = reach.by_root(high);
            let guess = high * power(ahead / (ahead + reach.miss), (ahead + reach.miss) / (high * reach.slope));
            let root =
                search(0.0, high, guess, |root| self.reach_above(&begin, distance, low, root * root).by_root(root));
            return Some(Choice::Over(root * root, 0.0));
        }
        if hold < top {
            // From here on both ramps hold their limits: the way is a polynomial of second degree.
            let curve = self.up.per_limit + self.down.per_limit;
            let root = (reach.slope * reach.slope - 2.0 * curve * reach.miss).max(0.0).sqrt();
            let more = hold - 2.0 * reach.miss / (reach.slope + root);
            if more < top {
                return Some(Choice::Over(more, 0.0));
            }
        }
        let miss = if hold < top { self.reach_above(&begin, distance, low, top).miss } else { reach.miss };
        (self.top > 0.0).then(|| Choice::Over(top, (-miss / self.top).max(0.0)))
    }

    /// What a velocity between the ramps is no less than.
    fn low(&self) -> f64 {
        self.run_out.max(self.end_velocity)
    }

    /// The ramps over a velocity `more` above `low`.
    #[inline]
    fn ramps_above(&self, begin: &Begin, low: f64, more: f64) -> [Ramp<'a>; 2] {
        let (velocity, end) = ((low + more).min(self.top), self.end_velocity);
        let excess = (low - self.run_out) + more;
        [
            Ramp::new(self.up, 1.0, begin.velocity, begin.acceleration, excess, velocity),
            Ramp::new(self.down, -1.0, velocity, 0.0, (low - end) + more, end),
        ]
    }

    #[inline(always)]
    fn reach_above(&self, begin: &Begin, distance: f64, low: f64, more: f64) -> Reach {
        let [first, second] = self.ramps_above(begin, low, more);
        let ((slope, bend), (more_slope, more_bend)) = (first.slopes(), second.slopes());
        reach(distance, [begin.ease.way, first.way(), second.way()], slope + more_slope, bend + more_bend)
    }

    /// The ramps over a velocity `less` than what is left, down to the top.
    fn ramps_below(&self, begin: &Begin, less: f64) -> [Ramp<'a>; 2] {
        let (velocity, end) = ((self.run_out - less).max(self.top), self.end_velocity);
        [
            Ramp::new(self.down, -1.0, begin.velocity, begin.acceleration, less, velocity),
            Ramp::new(self.down, -1.0, velocity, 0.0, velocity - end, end),
        ]
    }

    fn reach_below(&self, begin: &Begin, distance: f64, less: f64) -> Reach {
        let [first, second] = self.ramps_below(begin, less);
        let slope = first.slope_back() - second.slopes().0;
        reach(distance, [begin.ease.way, first.way(), second.way()], slope, f64::NAN)
    }

    /// By how much to relieve the braking at the start to get `distance` far; none where more than all of it is needed.
    fn dip(&self, distance: f64) -> Option<f64> {
        let all = -self.acceleration;
        let mut from = 0.0;
        for to in self.places().into_iter().chain([all]) {
            if to > from && self.reach_with_dip(distance, to).miss >= 0.0 {
                return Some(search(from, to, from, |relief| self.reach_with_dip(distance, relief)));
            }
            from = to.max(from);
        }
        None
    }

    /// Reliefs, ascending, between which the way of a dip goes only up or only down: where the velocity may be on both
    /// sides of zero, it need not go up all the time.
    fn places(&self) -> [f64; 4] {
        let mut places = [0.0; 4];
        if self.end_velocity >= 0.0 {
            return places;
        }
        let Side { limit, rise, per_jerk, .. } = *self.down;
        let all = -self.acceleration;
        // The way goes up while v > b (p - b) / (2 rise), with v = run_out + b^2 per_jerk / 2 - b^2 / (2 rise) at
        // deceleration b, and its peak p: the limit, or sqrt(b^2 + gain).
        let run_out = self.run_out;
        let gain = 2.0 * (run_out - self.end_velocity) / per_jerk;
        let held = roots(0.5 * per_jerk, -0.5 * limit / rise, run_out);
        let square = 0.25 / (rise * rise);
        let squares = roots(0.25 * per_jerk * per_jerk - square, run_out * per_jerk - gain * square, run_out * run_out);
        let decelerations = [held[0], held[1], squares[0].max(0.0).sqrt(), squares[1].max(0.0).sqrt()];
        for (place, deceleration) in places.iter_mut().zip(decelerations) {
            let relief = all - deceleration;
            // NaN fails the comparison.
            *place = if relief > 0.0 && relief < all { relief } else { 0.0 };
        }
        places.sort_by(f64::total_cmp);
        places
    }

    fn ramp_with_dip(&self, relief: f64) -> (Ease, Ramp<'a>) {
        let end = self.end_velocity;
        let begin = (-self.acceleration - relief).max(0.0);
        let ease = self.ease_to(-begin);
        (ease, Ramp::new(self.down, -1.0, self.velocity + ease.change(), begin, self.run_out - end, end))
    }

    fn reach_with_dip(&self, distance: f64, relief: f64) -> Reach {
        let (ease, ramp) = self.ramp_with_dip(relief);
        let begin = (-self.acceleration - relief).max(0.0);
        let from = self.velocity + ease.change();
        let gain = self.down.per_jerk * (ramp.peak - begin) / ramp.peak;
        let slope = gain * (from - 0.5 * begin * (ramp.peak - begin) / self.down.rise);
        reach(distance, [ease.way, ramp.way(), 0.0], slope, f64::NAN)
    }

    /// Writes what was chosen, turned by `sign`; its last ramp counts from the end.
    pub(super) fn add(&self, draft: &mut Draft<'_>, sign: f64, choice: Choice) {
        let (begin, [first, second], cruise) = match choice {
            Choice::Direct => {
                let (begin, ramp) = self.direct();
                begin.ease.add(draft, sign);
                return ramp.add_backward(draft, sign);
            }
            Choice::Dip(relief) => {
                let (ease, ramp) = self.ramp_with_dip(relief);
                ease.add(draft, sign);
                return ramp.add_backward(draft, sign);
            }
            Choice::Over(more, cruise) => {
                let begin = self.upwards();
                (begin, self.ramps_above(&begin, self.low(), more), cruise)
            }
            Choice::Below(less, cruise) => {
                let begin = self.downwards();
                (begin, self.ramps_below(&begin, less), cruise)
            }
        };
        begin.ease.add(draft, sign);
        first.add_forward(draft, sign);
        second.add_backward(draft, sign);
        draft.cruise(cruise, sign * self.top);
    }

    /// Writes the direct ramp, counted from the start.
    pub(super) fn add_direct(&self, draft: &mut Draft<'_>, sign: f64) {
        let (begin, ramp) = self.direct();
        begin.ease.add(draft, sign);
        ramp.add_forward(draft, sign);
    }
}

#[inline]
fn reach(distance: f64, ways: [f64; 3], slope: f64, bend: f64) -> Reach {
    let scale = ways[0].abs() + ways[1].abs() + ways[2].abs() + distance.abs();
    Reach { miss: ways[0] + ways[1] + ways[2] - distance, scale, slope, bend }
}

/// Finds where `reach` does not miss; at `low` it falls short, at `high` it goes too far. Steps are Halley's, or Newton's
/// where there is no second derivative, and bisect where those do not get on.
#[inline]
fn search(mut low: f64, mut high: f64, guess: f64, reach: impl Fn(f64) -> Reach) -> f64 {
    let mut place = if guess >= low && guess <= high { guess } else { high };
    let mut last_miss = f64::MAX;
    for _ in 0..MAX_STEPS {
        let now = reach(place);
        if now.hits() || high - low <= 1e-16 * high {
            break;
        }
        if now.miss > 0.0 {
            high = place;
        } else {
            low = place;
        }
        let (step, last_step) = if now.bend.is_nan() {
            (now.miss / now.slope, LAST_NEWTON)
        } else {
            (now.miss * now.slope / (now.slope * now.slope - 0.5 * now.miss * now.bend), LAST_HALLEY)
        };
        let next = place - step;
        let is_slow = now.miss.abs() > 0.5 * last_miss;
        last_miss = now.miss.abs();
        let is_inside = next > low && next < high;
        if step.abs() <= last_step * place {
            return next.max(low).min(high);
        }
        place = if is_inside && !is_slow { next } else { 0.5 * (low + high) };
    }
    place
}

/// Real roots of a x^2 + b x + c; NaN where there are none.
fn roots(a: f64, b: f64, c: f64) -> [f64; 2] {
    let sum = -0.5 * (b + (b * b - 4.0 * a * c).sqrt().copysign(b));
    [sum / a, c / sum]
}

/// About x^exponent of a positive x, to a hundredth or two: the bits of a number are about its logarithm.
fn power(x: f64, exponent: f64) -> f64 {
    // The bits of 1, less what a line lies below the logarithm on average.
    let one = 1.0_f64.to_bits() as i64 - LOGARITHM_BIAS;
    let logarithm = (x.to_bits() as i64).wrapping_sub(one) as f64;
    // The cast saturates, and what is no number leads to a place that the search does not take.
    f64::from_bits(((logarithm * exponent) as i64).wrapping_add(one) as u64)
}

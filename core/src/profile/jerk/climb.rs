//! The search for the ramps that lead to a target.
//!
//! Starting from the direct ramp to the end velocity, a longer plan can reach further: first the initial braking is
//! reduced for some time (a dip) until it vanishes, then the velocity between the two ramps is increased up to its
//! limit, then it is kept there. The position reached is a continuous function of the duration; the first duration with
//! which it is the target gives the fastest plan.

use super::super::plan::Draft;
use super::ramp::{Ease, Ramp, Side};

/// Largest number of Newton steps with bisection: each halves the bracket or the miss, so this exceeds the digits of
/// f64 by far.
const MAX_STEPS: usize = 200;
/// Distance below the resolution of positions (inc).
const NEGLIGIBLE: f64 = 2e-11;
/// Relative size of a Newton step that is the last one: the error after it is its square, after Halley's step its cube.
const LAST_NEWTON: f64 = 1e-8;
const LAST_HALLEY: f64 = 1e-5;
/// 0.045 of the bits of a fraction.
const LOGARITHM_BIAS: i64 = 202_661_983_231_672;

/// Selected way to reach a target.
#[derive(Clone, Copy, Debug)]
pub(super) enum Choice {
    /// Directly to the end velocity.
    Direct,
    /// By reducing the initial braking by this amount (inc/s^2).
    Dip(f64),
    /// Over a velocity this much above the higher one of the run-out velocity and the end velocity (inc/s), which is
    /// kept for a time (s).
    Over(f64, f64),
    /// From a start above the velocity limit over a velocity this much below the run-out velocity (inc/s), which is
    /// kept for a time (s).
    Below(f64, f64),
}

/// The task: upwards, further than the direct ramp. The velocities have one sign, or the limits are equal for both
/// signs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Climb<'a> {
    velocity: f64,
    /// Initial acceleration, within its limit.
    acceleration: f64,
    end_velocity: f64,
    /// Velocity limit; not below the end velocity.
    top: f64,
    /// Acceleration limits above and below zero.
    up: &'a Side,
    down: &'a Side,
    /// Velocity after the initial acceleration has run out.
    run_out: f64,
}

/// The start of a ramp, and the phase before it.
#[derive(Clone, Copy, Debug)]
struct Begin {
    ease: Ease,
    velocity: f64,
    /// Acceleration in the direction of the ramp.
    acceleration: f64,
}

/// Distance by which a plan misses the target.
#[derive(Clone, Copy, Debug)]
struct Reach {
    miss: f64,
    /// Magnitude of the terms of the miss, for its rounding error.
    scale: f64,
    /// First and second derivative of the miss by the searched quantity; the second one may be unknown, NaN.
    slope: f64,
    bend: f64,
}

impl Reach {
    fn hits(&self) -> bool {
        self.miss.abs() <= NEGLIGIBLE + 4e-16 * self.scale
    }

    /// Returns the derivatives for a search by the square root of the searched quantity.
    #[inline]
    fn by_root(self, root: f64) -> Self {
        let slope = 2.0 * root * self.slope;
        Self { slope, bend: 2.0 * self.slope + 4.0 * root * root * self.bend, ..self }
    }
}

impl<'a> Climb<'a> {
    /// Returns the task from a velocity and an acceleration within its limit.
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
        // The time of a ramp is proportional to the root of its velocity: rounding errors must not become a ramp.
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

    /// Returns the start of a ramp upwards: with the initial acceleration, or after it has run out.
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

    /// Returns the direct ramp to the end velocity.
    fn direct(&self) -> (Begin, Ramp<'a>) {
        let (run_out, end) = (self.run_out, self.end_velocity);
        let (begin, side, sign) =
            if end >= run_out { (self.upwards(), self.up, 1.0) } else { (self.downwards(), self.down, -1.0) };
        (begin, Ramp::new(side, sign, begin.velocity, begin.acceleration, sign * (end - run_out), end))
    }

    pub(super) fn direct_way(&self) -> f64 {
        let (begin, ramp) = self.direct();
        begin.ease.way + ramp.distance()
    }

    /// Returns the choice that reaches `distance`, which exceeds the `direct` one; none if it would exceed a velocity
    /// limit of zero.
    pub(super) fn solve(&self, distance: f64, direct: f64) -> Option<Choice> {
        let end = self.end_velocity;
        if self.run_out > self.top {
            return Some(self.solve_beyond(distance));
        }
        let mut ahead = distance - direct;
        if self.acceleration < 0.0 && end < self.run_out {
            if let Some(relief) = self.braking_reduction(distance) {
                return Some(Choice::Dip(relief));
            }
            ahead = -self.reach_with_dip(distance, -self.acceleration).miss;
        }
        self.solve_over(distance, ahead)
    }

    /// Solves a start above the velocity limit. The return to the limit comes first: a dip would only keep the velocity
    /// there longer.
    fn solve_beyond(&self, distance: f64) -> Choice {
        let begin = self.downwards();
        let most = self.run_out - self.top;
        let at_top = self.reach_below(&begin, distance, most);
        if at_top.miss <= 0.0 && self.top > 0.0 {
            return Choice::Below(most, -at_top.miss / self.top);
        }
        if self.acceleration < 0.0
            && self.end_velocity < self.run_out
            && let Some(relief) = self.braking_reduction(distance)
        {
            return Choice::Dip(relief);
        }
        let high = most.sqrt();
        let root = search(0.0, high, high, |root| self.reach_below(&begin, distance, root * root).by_root(root));
        Choice::Below(root * root, 0.0)
    }

    /// Solves with a velocity above those of the start and the end; the target is `ahead` beyond the lowest such
    /// velocity.
    fn solve_over(&self, distance: f64, ahead: f64) -> Option<Choice> {
        let low = self.lower_velocity();
        let begin = self.upwards();
        let top = self.top - low;
        let hold = (self.up.excess_to_hold(begin.acceleration) - (low - self.run_out))
            .max(self.down.excess_to_hold(0.0) - (low - self.end_velocity))
            .max(0.0);
        let most = top.min(hold);
        let reach = self.reach_above(&begin, distance, low, most);
        if reach.miss > 0.0 {
            // The search uses the root of the velocity, by which the distance has a slope even at 0.
            let high = most.sqrt();
            let reach = reach.by_root(high);
            let guess = high * power(ahead / (ahead + reach.miss), (ahead + reach.miss) / (high * reach.slope));
            let root =
                search(0.0, high, guess, |root| self.reach_above(&begin, distance, low, root * root).by_root(root));
            return Some(Choice::Over(root * root, 0.0));
        }
        if hold < top {
            // From here on both ramps reach their acceleration limits: the distance is a polynomial of second degree.
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

    /// Returns the lower bound of the velocity between the ramps.
    fn lower_velocity(&self) -> f64 {
        self.run_out.max(self.end_velocity)
    }

    /// Returns the ramps over a velocity `more` above `low`.
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
        reach(distance, [begin.ease.way, first.distance(), second.distance()], slope + more_slope, bend + more_bend)
    }

    /// Returns the ramps over a velocity `less` below the run-out velocity, down to the velocity limit.
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
        reach(distance, [begin.ease.way, first.distance(), second.distance()], slope, f64::NAN)
    }

    /// Returns the reduction of the initial braking with which the plan reaches `distance`; none if the whole braking
    /// does not suffice.
    fn braking_reduction(&self, distance: f64) -> Option<f64> {
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

    /// Returns reductions, ascending, between which the distance of a dip is monotonic. If the velocity can have both
    /// signs, the distance need not increase throughout.
    fn places(&self) -> [f64; 4] {
        let mut places = [0.0; 4];
        if self.end_velocity >= 0.0 {
            return places;
        }
        let Side { limit, rise, per_jerk, .. } = *self.down;
        let all = -self.acceleration;
        // The distance increases while v > b (p - b) / (2 rise), with v = run_out + b^2 per_jerk / 2 - b^2 / (2 rise)
        // at deceleration b, and its peak p: the limit, or sqrt(b^2 + gain).
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
        reach(distance, [ease.way, ramp.distance(), 0.0], slope, f64::NAN)
    }

    /// Adds the choice to a draft, with signs multiplied by `sign`; its last ramp is evaluated from the end.
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
                (begin, self.ramps_above(&begin, self.lower_velocity(), more), cruise)
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

    /// Adds the direct ramp, evaluated from the start.
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

/// Finds the zero of `reach`, which falls short at `low` and goes too far at `high`. Steps are those of Halley, or of
/// Newton without second derivative, with bisection if they converge slowly.
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

/// Returns the real roots of a x^2 + b x + c; NaN if there are none.
fn roots(a: f64, b: f64, c: f64) -> [f64; 2] {
    let sum = -0.5 * (b + (b * b - 4.0 * a * c).sqrt().copysign(b));
    [sum / a, c / sum]
}

/// Returns x^exponent of a positive x, accurate to one or two percent: the bits of a float are approximately its
/// logarithm.
fn power(x: f64, exponent: f64) -> f64 {
    // The bits of 1, less the mean difference between a line and the logarithm.
    let one = 1.0_f64.to_bits() as i64 - LOGARITHM_BIAS;
    let logarithm = (x.to_bits() as i64).wrapping_sub(one) as f64;
    // The cast saturates, and the search ignores a result that is no number.
    f64::from_bits(((logarithm * exponent) as i64).wrapping_add(one) as u64)
}

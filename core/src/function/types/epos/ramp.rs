//! Velocities per call that come to rest exactly at an end.
//!
//! Law      a ramp from v takes v + (v - a) + (v - 2a) + .. as long as that is above 0. `fastest` is the largest v
//!          whose ramp ends within the distance to go; so each next velocity is at most a below the previous one, the
//!          last one equals the remaining distance, and there is no creeping. If a ramp by a is too long for the
//!          distance, `steepest` is the smallest a that fits
//! Source   AMK-EPOS-09 to -11, A-37, A-48

/// Bits of the fraction of an increment.
pub(super) const BITS: u32 = 48;
/// One increment.
pub(super) const INC: i128 = 1 << BITS;
/// Maximum velocity: no encoder travels 2^40 inc in a call.
pub(super) const MAX_VELOCITY: i128 = INC << 40;
/// Maximum distance to go.
pub(super) const MAX_DISTANCE: i128 = INC << 62;

/// Upper bound of the time between calls (ns), far above any cycle.
const CALL_BOUND: u64 = 1 << 40;
/// Duration of a turn at 0.0001 rpm (ns).
const TURN: i128 = 600_000_000_000_000;
/// One turn at 0.001 turns/s^2 (ns^2).
const TURN_SQUARED: i128 = 1_000_000_000_000_000_000_000;

/// Returns the travel per call at a speed (0.0001 rpm), rounded down.
pub(super) fn velocity(speed: i64, resolution: i64, call_ns: u64) -> i128 {
    let turns = i128::from(speed.unsigned_abs()) * i128::from(resolution);
    quotient_in_parts(turns.saturating_mul(call(call_ns)), TURN)
}

/// Returns the change of velocity per call at a rate (0.001 turns/s^2), rounded down; at least 1.
pub(super) fn change(rate: i64, resolution: i64, call_ns: u64) -> i128 {
    let turns = i128::from(rate) * i128::from(resolution);
    quotient_in_parts(turns.saturating_mul(call(call_ns) * call(call_ns)), TURN_SQUARED).max(1)
}

/// Returns a quotient in parts of an increment, at most `FASTEST`; the divisor is below 2^70.
pub(super) fn quotient_in_parts(dividend: i128, divisor: i128) -> i128 {
    // The scaled dividend would exceed 128 bits: quotient and remainder are scaled separately.
    let (whole, rest) = (dividend / divisor.max(1), dividend % divisor.max(1));
    whole.saturating_mul(INC).saturating_add(rest * INC / divisor.max(1)).clamp(0, MAX_VELOCITY)
}

fn call(call_ns: u64) -> i128 {
    i128::from(call_ns.clamp(1, CALL_BOUND))
}

/// Returns the next velocity towards a target velocity.
#[inline]
pub(super) fn approach(v: i128, wanted: i128, a: i128) -> i128 {
    wanted.max(v - a).min(v + a).max(0)
}

/// Returns the next velocity towards a target velocity that leaves enough distance for the ramp down.
#[inline]
pub(super) fn approach_end(v: i128, wanted: i128, left: i128, a: i128) -> i128 {
    let next = approach(v, wanted, a);
    if is_clearly_long_enough(next, left, a) {
        return next;
    }
    let most = fastest(left, a);
    if most >= v - a { next.min(most) } else { v - steepest(v, left) }
}

/// Returns true if the distance is long enough for the ramp from a velocity.
#[inline]
pub(super) fn is_long_enough(v: i128, left: i128, a: i128) -> bool {
    v <= 0 || is_clearly_long_enough(v, left, a) || fastest(left, a) >= v
}

/// Returns true if an estimate shows that the distance is long enough: v + (v - a) + .. never exceeds (v + a)^2 / 2a.
#[inline]
fn is_clearly_long_enough(v: i128, left: i128, a: i128) -> bool {
    let square = |x: i128| x.checked_mul(x);
    square(v + a).zip(left.checked_mul(2 * a)).is_some_and(|(needed, there)| needed <= there)
}

/// Returns the largest velocity whose ramp ends within the distance to go; `a` is above 0.
fn fastest(left: i128, a: i128) -> i128 {
    // k whole steps above the last one: a k (k + 1) / 2 <= left, and k (k + 1) / 2 is whole.
    let steps = left.max(0).unsigned_abs() / a.unsigned_abs().max(1);
    // The distance is below 2^111: nothing wraps.
    let k = ((8 * steps + 1).isqrt() as i128 - 1) / 2;
    (left.max(0) + a * (k * (k + 1) / 2)) / (k + 1)
}

/// Returns the length of the ramp from a velocity, including the call at that velocity; at most `FARTHEST`.
pub(super) fn length(v: i128, a: i128) -> i128 {
    let k = v / a.max(1);
    let way = (k + 1).checked_mul(v).zip(a.checked_mul(k).and_then(|way| way.checked_mul(k + 1)));
    way.map_or(MAX_DISTANCE, |(way, less)| way - less / 2).min(MAX_DISTANCE)
}

/// Returns the smallest `a` whose ramp after a call at v ends within the distance to go, at most v itself. Only used if
/// the current ramp is too long: then v^2 is above the distance times a step.
fn steepest(v: i128, left: i128) -> i128 {
    // For a ramp of k steps, a is 2 (k v - left) / k (k + 1). The result is the largest of these values; it is at one
    // of three k.
    let least = (left.saturating_mul(2) / v.max(1)).max(1);
    let of = |k: i128| {
        let (way, steps) = (2 * (k * v - left), k * (k + 1));
        if way > 0 { (way - 1) / steps + 1 } else { 0 }
    };
    (least..least + 3).map(of).fold(0, i128::max).min(v)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Returns the length of the ramp, call by call.
    fn way(v: i128, a: i128) -> i128 {
        let (mut v, mut sum) = (v, 0);
        while v > 0 {
            (sum, v) = (sum + v, v - a);
        }
        sum
    }

    /// 100 rpm, 200 and 800 rev/s^2 at 20000 inc per turn in 1 ms: 33.333, 4 and 16 inc.
    ///
    /// Proves: AMK-EPOS-09, AMK-EPOS-10, AMK-EPOS-O1
    #[test]
    fn rates_are_those_of_the_formulas() {
        assert_eq!(velocity(1_000_000, 20_000, 1_000_000), INC * 100 / 3);
        assert_eq!(velocity(-1_000_000, 20_000, 1_000_000), INC * 100 / 3);
        assert_eq!([200_000, 800_000].map(|rate| change(rate, 20_000, 1_000_000)), [4 * INC, 16 * INC]);
        // Twice the call time: v doubles, a becomes four times as large.
        assert_eq!(velocity(1_000_000, 20_000, 2_000_000), INC * 200 / 3);
        assert_eq!(change(200_000, 20_000, 2_000_000), 16 * INC);
        // The smallest change is 10^-9 inc, the largest is limited.
        assert_eq!(change(1, 1, 1_000_000), INC / 1_000_000_000);
        assert_eq!(change(1, 1, 1), 1);
        let max = i64::from(i32::MAX);
        assert_eq!([velocity(max, max, u64::MAX), change(100_000_000, max, u64::MAX)], [MAX_VELOCITY; 2]);
        assert_eq!(velocity(i32::MIN.into(), max, 1_000_000) / INC, 7_686_143_360);
    }

    #[test]
    fn a_ramp_that_is_too_long_is_steeper_and_no_steeper_than_it_must_be() {
        // 10 + 5 + 0: from 15, a distance of 15 allows 5 per call.
        assert_eq!(steepest(15, 15), 5);
        assert_eq!((steepest(15, 0), steepest(15, 14), steepest(15, 7)), (15, 6, 8));
        assert_eq!(approach_end(15, 15, 15, 1), 10);
        assert_eq!(approach_end(10, 15, 5, 1), 5);
        assert_eq!(approach_end(5, 15, 0, 1), 0);
    }

    proptest! {
        #[test]
        fn the_fastest_ends_within_and_one_more_does_not(left in 0_i128..100_000, a in 1_i128..500) {
            let v = fastest(left, a);
            prop_assert!(way(v, a) <= left && way(v + 1, a) > left);
            prop_assert!(is_long_enough(v, left, a) && !is_long_enough(v + 1, left, a));
            prop_assert_eq!(length(v, a), way(v, a));
        }

        #[test]
        fn estimate_of_long_distance_is_never_wrong(v in 0_i128..5000, left in 0_i128..100_000, a in 1_i128..500) {
            prop_assert!(!is_clearly_long_enough(v, left, a) || way(v, a) <= left);
        }

        #[test]
        fn the_steepest_is_the_least_that_is_enough(v in 1_i128..3000, left in 0_i128..20_000, a in 1_i128..100) {
            let behind = |a: i128| way((v - a).max(0), a);
            prop_assume!(behind(a) > left);
            let steepest = steepest(v, left);
            prop_assert!(steepest > a && behind(steepest) <= left && behind(steepest - 1) > left, "{}", steepest);
        }

        /// From any velocity, with any changes of target and distance: the motion ends exactly at the end, by at most
        /// its ramp where that is possible.
        #[test]
        fn an_end_is_reached_exactly(
            start in (0_i128..200_000, 0_i128..10_000_000, 100_i128..5000),
            changes in proptest::collection::vec((0_usize..200, 1000_i128..200_000, 100_i128..5000), 0..5),
        ) {
            let (mut v, mut left, mut a) = start;
            let mut wanted = 50_000;
            for call in 0..100_000 {
                for (_, new, slope) in changes.iter().filter(|(at, ..)| *at == call) {
                    (wanted, a) = (*new, *slope);
                }
                let next = approach_end(v, wanted, left, a);
                let is_enough = way((v - a).max(0), a) <= left;
                prop_assert!(next - v <= a && (v - next <= a || !is_enough));
                (v, left) = (next, left - next);
                prop_assert!(v >= 0 && left >= 0);
                if left == 0 && v == 0 {
                    return Ok(());
                }
            }
            prop_assert!(false, "{left} are left");
        }

        /// Nothing wraps at the limits.
        #[test]
        fn extremes_have_room(v in 0_i128..=MAX_VELOCITY, left in 0_i128..=MAX_DISTANCE, a in 1_i128..=MAX_VELOCITY, bits in 0_u32..88) {
            let a = (a >> bits).max(1);
            let next = approach_end(v, MAX_VELOCITY, left, a);
            prop_assert!((0..=MAX_VELOCITY + a).contains(&next) && next <= left);
            prop_assert!((0..=MAX_DISTANCE).contains(&length(v, a)));
        }
    }
}

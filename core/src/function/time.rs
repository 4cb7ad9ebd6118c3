//! Times in half milliseconds, as in the sources, converted to calls.
//!
//! Law      calls = ceil(time * 0.5 ms / call), lead = mean travel per call * time * 0.5 ms / call, both exact
//! Refuses  a cycle time that differs from that of the slot, a cycle outside the limits of a mode, a mean over more
//!          calls than there is room for
//! Source   AMK-BINEA-29, AMK-BINEA-31, AMK-CAM-10, AMK-EPOS-50, AMK-CTX-03, C8

use super::program::{Fault, Setting};
use super::window::Window;
use crate::code::Code;
use crate::event::Number;

/// Unit of the times (ns).
pub(super) const HALF_MS: i64 = 500_000;

/// Returns an error for a cycle time that is neither 0 (that of the slot) nor the time between two calls.
pub(super) fn check_cycle(half_ms: i64, field: u16, setting: &Setting<'_>) -> Result<(), Fault> {
    // The range of the field is small: nothing saturates, and a call of 292 years matches no cycle time.
    let (asked, call) = (half_ms.saturating_mul(HALF_MS), i64::try_from(setting.call_ns).unwrap_or(i64::MAX));
    if half_ms == 0 || asked == call {
        return Ok(());
    }
    let fault = Fault::new(Code::AMK_CYCLE_MISMATCH).of(field);
    Err(Fault { asked: Number::Count(half_ms), limit: Number::Time(call), ..fault })
}

/// Returns an error for a cycle outside the limits of a mode (0.5 ms). The error names the field of the cycle if the
/// set gives it, otherwise the field that selects the mode: no value of the cycle could match both the slot and the
/// limits.
pub(super) fn check_cycle_bounds(
    half_ms: i64,
    (low, high): (i64, i64),
    (cycle, mode): (u16, u16),
    setting: &Setting<'_>,
) -> Result<(), Fault> {
    let call = i64::try_from(setting.call_ns).unwrap_or(i64::MAX);
    let is_named = half_ms != 0;
    let (asked, unit) = if is_named { (half_ms, 1) } else { (call, HALF_MS) };
    let (low, high) = (low.saturating_mul(unit), high.saturating_mul(unit));
    if (low..=high).contains(&asked) {
        return Ok(());
    }
    let number = |value| if is_named { Number::Count(value) } else { Number::Time(value) };
    let limit = number(if asked < low { low } else { high });
    let field = if is_named { cycle } else { mode };
    Err(Fault { asked: number(asked), limit, ..Fault::new(Code::AMK_BEYOND).of(field) })
}

/// Returns the number of calls in a time.
pub(super) fn calls_in_time(time: u16, call_ns: u64) -> u64 {
    (u64::from(time) * HALF_MS.unsigned_abs()).div_ceil(call_ns.max(1))
}

/// Returns the lead of a mean travel per call in a dead time, rounded down.
pub(super) fn lead(mean: (i128, i128), dead_time: i64, call_ns: u64) -> i64 {
    let (sum, count) = mean;
    // Only an impossible velocity saturates. A count is below 2^33: its product fits.
    floor_ratio(sum.saturating_mul(i128::from(dead_time) * i128::from(HALF_MS)), count * i128::from(call_ns))
}

/// Calls of a mean if the set gives none.
const MEAN: i64 = 20;

fn mean_calls(asked: i64) -> i64 {
    if asked == 0 { MEAN } else { asked }
}

/// Returns an error for a mean over more calls than the window has room for; 0 means 20.
pub(super) fn check_mean(window: &Window, asked: i64, field: u16) -> Result<(), Fault> {
    // It holds fewer than 2^32 values.
    let limit = window.capacity() as i64;
    if mean_calls(asked) > limit {
        return Err(Fault::new(Code::AMK_MEAN_LONG).of(field).with(mean_calls(asked), limit));
    }
    Ok(())
}

/// Starts a mean over that number of calls; 0 means 20.
pub(super) fn restart(window: &mut Window, asked: i64) {
    window.restart(usize::try_from(mean_calls(asked)).unwrap_or(1));
}

/// Returns a quotient, rounded down and saturated; the divisor is above 0.
pub(super) fn floor_ratio(dividend: i128, divisor: i128) -> i64 {
    match (i64::try_from(dividend), i64::try_from(divisor)) {
        // A division of 64 bits takes a fraction of the time.
        (Ok(dividend), Ok(divisor)) if divisor > 0 => dividend.div_euclid(divisor),
        _ => {
            let quotient = dividend.div_euclid(divisor.max(1));
            i64::try_from(quotient).unwrap_or(if quotient < 0 { i64::MIN } else { i64::MAX })
        }
    }
}

/// Returns a position within a turn; `turn` is above 0.
#[inline]
pub(super) fn wrapped(x: i64, turn: i64) -> i64 {
    if (0..turn).contains(&x) { x } else { x.rem_euclid(turn.max(1)) }
}

#[cfg(test)]
mod tests {
    use super::super::trial::setting;
    use super::*;
    use crate::event::Number;

    /// Proves: AMK-CTX-03
    #[test]
    fn a_cycle_time_is_the_one_of_the_slot_or_none() {
        let of_call = |call_ns| setting(call_ns, [None; 8]);
        assert_eq!(check_cycle(0, 3, &of_call(750_000)), Ok(()));
        assert_eq!(check_cycle(3, 3, &of_call(1_500_000)), Ok(()));
        let fault = check_cycle(2, 3, &of_call(750_000)).unwrap_err();
        assert_eq!((fault.code, fault.field), (Code::AMK_CYCLE_MISMATCH, Some(3)));
        assert_eq!((fault.asked, fault.limit), (Number::Count(2), Number::Time(750_000)));
    }

    /// Proves: AMK-EPOS-50
    #[test]
    fn cycle_bounds_hold_for_the_cycle_of_the_slot_where_the_set_names_none() {
        let fault = |half_ms, call_ns| {
            let bounded = check_cycle_bounds(half_ms, (2, 18), (3, 1), &setting(call_ns, [None; 8]));
            bounded.err().map(|fault| (fault.code, fault.field, fault.asked, fault.limit))
        };
        let of = |asked, limit| {
            let field = if matches!(asked, Number::Time(_)) { 1 } else { 3 };
            Some((Code::AMK_BEYOND, Some(field), asked, limit))
        };
        for call_ns in [1_000_000, 1_023_998, 9_000_000] {
            assert_eq!(fault(0, call_ns), None, "{call_ns}");
        }
        let (low, high) = (Number::Time(1_000_000), Number::Time(9_000_000));
        assert_eq!(fault(0, 999_999), of(Number::Time(999_999), low));
        assert_eq!(fault(0, 9_000_001), of(Number::Time(9_000_001), high));
        assert_eq!(fault(0, u64::MAX), of(Number::Time(i64::MAX), high));
        assert_eq!((fault(2, 1), fault(18, 1)), (None, None), "the set names it");
        assert_eq!(fault(1, 500_000), of(Number::Count(1), Number::Count(2)));
        assert_eq!(fault(19, 9_500_000), of(Number::Count(19), Number::Count(18)));
    }

    #[test]
    fn a_time_lasts_the_calls_that_begin_in_it() {
        // 0.75 ms per call: 1.5 ms are 2 calls, 2 ms are 3.
        assert_eq!([0, 1, 3, 4].map(|time| calls_in_time(time, 750_000)), [0, 1, 2, 3]);
    }

    #[test]
    fn a_lead_is_exact_and_rounded_down() {
        // 100 inc per 0.75 ms over 2 ms: 266.67 inc; in negative direction -267.
        assert_eq!(lead((100, 1), 4, 750_000), 266);
        assert_eq!(lead((-100, 1), 4, 750_000), -267);
        assert_eq!(lead((-300, 4), 2, 500_000), -150);
        assert_eq!(lead((i128::MAX, 1), 32_000, 1), i64::MAX);
        assert_eq!(lead((i128::MIN, 1), 32_000, 1), i64::MIN);
    }

    #[test]
    fn a_place_within_a_turn_is_never_negative() {
        assert_eq!([-1, 0, 9, 10, 25, i64::MIN].map(|x| wrapped(x, 10)), [9, 0, 9, 0, 5, 2]);
    }
}

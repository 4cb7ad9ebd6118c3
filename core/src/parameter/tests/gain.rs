//! Gain of the position loop, in 1/s and in (mm/min)/um.

use super::super::*;
use super::parameters;
use crate::regulator::KV;
use proptest::prelude::*;

fn row(key: &str) -> &'static Row {
    Row::find(key).map(|(_, row)| row).unwrap_or_else(|| panic!("{key}"))
}

/// Returns both values, in 1/s and in (mm/min)/um.
fn gains(p: &AxisParameters) -> [Value; 2] {
    ["position_loop.kv", "wf.md22"].map(|key| row(key).value(p))
}

proptest! {
    /// Any servo gain of a positioning module reads as it was given, and the loop uses it times 1000/60 1/s, bit for
    /// bit; the same holds for a gain in 1/s by its own name.
    ///
    /// Proves: WF-MD-14
    #[test]
    fn a_gain_reads_as_it_was_given(hundredths in 1_u32..=10_000, any in 0.01_f64..=100.0) {
        for gain in [f64::from(hundredths) / 100.0, any] {
            let mut p = parameters();
            row("wf.md22").change(&mut p, Value::Real(gain)).unwrap();
            prop_assert_eq!(gains(&p), [Value::Real(gain * KV), Value::Real(gain)]);
            prop_assert!(p.is_sound() && p.is_given_by(row("wf.md22")) && !p.is_given_by(row("position_loop.kv")));
            row("position_loop.kv").change(&mut p, Value::Real(gain * KV)).unwrap();
            prop_assert_eq!(row("position_loop.kv").value(&p), Value::Real(gain * KV));
            prop_assert!(p.is_sound() && p.is_given_by(row("position_loop.kv")) && !p.is_given_by(row("wf.md22")));
        }
    }
}

/// Limits and default of both rows are the same gains.
#[test]
fn ends_and_default_are_the_same_by_either_name() {
    let [kv, md22] = ["position_loop.kv", "wf.md22"].map(row);
    assert_eq!(gains(&parameters()), [kv.default, md22.default]);
    let (Range::Real(low, high), Range::Real(least, most)) = (kv.range, md22.range) else { panic!("no reals") };
    for (native, view) in [(low, least), (high, most)] {
        let mut p = parameters();
        kv.change(&mut p, Value::Real(native)).unwrap();
        assert_eq!(gains(&p), [Value::Real(native), Value::Real(view)]);
    }
    let mut p = parameters();
    for (row, value) in [(kv, low * 0.999), (kv, high * 1.001), (md22, least * 0.999), (md22, most * 1.001)] {
        assert_eq!(row.change(&mut p, Value::Real(value)), Err(Refused::OutOfRange), "{} {value}", row.key);
    }
    assert_eq!(p, parameters());
}

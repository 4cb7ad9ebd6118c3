use super::*;
use proptest::prelude::*;

/// Supervision with 1000 ms and 5000, at 1 ms.
const SECOND: I2tSettings = I2tSettings { time: 1000, limit: 5000, shown_time: 0, cycle: 1.0 };

fn near(actual: f64, expected: f64, relative: f64) {
    assert!((actual - expected).abs() <= relative * expected.abs(), "{actual}, not {expected}");
}

/// Returns the first sample, from 1 on, with that result.
fn first(settings: I2tSettings, current: f64, looked_for: Heat) -> Option<u32> {
    let (law, mut filter) = (I2t::new(settings), HeatFilter::default());
    (1..=100_000).find(|_| filter.step(&law, current) == looked_for)
}

/// Each ms as printed in the source: y + (x - y) / tau with x = I^2 / 1000.
///
/// Proves: MACS-I2T-02
#[test]
fn each_ms_is_one_step_of_the_printed_filter() {
    let law = I2t::new(I2tSettings { time: 20, limit: 1_000_000, ..SECOND });
    let (mut filter, mut value) = (HeatFilter::default(), 0.0);
    for current in [3000.0, -1000.0, 0.0, 500.0, 60_000.0, -60_000.0] {
        filter.step(&law, current);
        value += (current * current / 1000.0 - value) / 20.0;
        near(filter.value(), value, 1e-14);
    }
    // A twentieth of the 9000 for 3 A; then a twentieth of the difference to 1000.
    let mut filter = HeatFilter::default();
    filter.step(&law, 3000.0);
    near(filter.value(), 450.0, 1e-14);
    filter.step(&law, -1000.0);
    near(filter.value(), 477.5, 1e-14);
}

/// The value of the source, and 95 % of it after three times the filter time.
///
/// Proves: MACS-O-30
#[test]
fn two_and_a_half_amperes_come_to_6250() {
    let law = I2t::new(SECOND);
    let mut filter = HeatFilter::default();
    (0..3000).for_each(|_| _ = filter.step(&law, 2500.0));
    near(filter.value(), 6250.0, 0.05);
    (0..30_000).for_each(|_| _ = filter.step(&law, 2500.0));
    near(filter.value(), 6250.0, 1e-9);
}

/// 6250 (1 - 0.999^n) passes 5000 between n = 1608 and 1609, 4500 between 1272 and 1273.
///
/// Proves: MACS-I2T-03, MACS-O-32
#[test]
fn the_limit_is_passed_at_sample_1609() {
    assert_eq!(first(SECOND, 2500.0, Heat::TooMuch), Some(1609));
    assert_eq!(first(SECOND, -2500.0, Heat::TooMuch), Some(1609));
    assert_eq!(first(SECOND, 2500.0, Heat::Warning), Some(1273));
    assert_eq!(Heat::TooMuch.code().0, 99);
    assert_eq!([Heat::Fine, Heat::Warning].map(Heat::code), [Code::NONE; 2]);
    // A value that only reaches the limit is not above it.
    assert_eq!(first(I2tSettings { limit: 6250, ..SECOND }, 2500.0, Heat::TooMuch), None);
}

/// 2500 mA give 6250: the limit is exceeded if I2TFTIME is above 0, and not if it is 0.
///
/// Proves: MACS-I2T-01
#[test]
fn a_filter_time_of_0_supervises_nothing() {
    let off = I2tSettings { time: 0, ..SECOND };
    assert_eq!(first(off, 60_000.0, Heat::TooMuch), None);
    assert_eq!(first(off, 60_000.0, Heat::Warning), None);
    assert_eq!(first(I2tSettings { time: 1, ..SECOND }, 2500.0, Heat::TooMuch), Some(1));
    let (on, mut filter) = (I2t::new(SECOND), HeatFilter::default());
    filter.step(&on, 60_000.0);
    assert!(filter.value() > 0.0);
    filter.step(&I2t::new(off), 60_000.0);
    assert_eq!(filter.value(), 0.0, "what was off begins anew");
}

#[test]
fn a_limit_of_0_is_passed_by_any_current() {
    let none = I2tSettings { limit: 0, ..SECOND };
    assert_eq!(first(none, 1.0, Heat::TooMuch), Some(1));
    assert_eq!(first(none, 0.0, Heat::TooMuch), None);
    assert_eq!(first(none, 0.0, Heat::Warning), None);
}

#[test]
fn falling_heat_becomes_fine_again() {
    let (law, mut filter) = (I2t::new(SECOND), HeatFilter::default());
    while filter.step(&law, 2500.0) != Heat::TooMuch {}
    assert_eq!(filter.step(&law, 0.0), Heat::Warning);
    (0..1000).for_each(|_| _ = filter.step(&law, 0.0));
    assert_eq!(filter.step(&law, 0.0), Heat::Fine);
}

/// ln(0.2) / ln(0.999) = 1608.633 ms: the first cycle that ends after it.
#[test]
fn the_time_course_does_not_depend_on_the_cycle() {
    for (cycle, sample) in [(0.125, 12_870), (0.25, 6435), (0.5, 3218), (2.0, 805), (4.0, 403), (10.0, 161)] {
        assert_eq!(first(I2tSettings { cycle, ..SECOND }, 2500.0, Heat::TooMuch), Some(sample), "{cycle} ms");
    }
}

/// 8 ms: an eighth of the difference each ms.
#[test]
fn curftime_filters_the_current_that_is_shown_and_squared() {
    let law = I2t::new(I2tSettings { time: 1, limit: 1_000_000, shown_time: 8, cycle: 1.0 });
    let mut filter = HeatFilter::default();
    filter.step(&law, 800.0);
    assert_eq!((filter.current(), filter.value()), (100.0, 10.0));
    filter.step(&law, -700.0);
    assert_eq!((filter.current(), filter.value()), (0.0, 0.0));
    for shown_time in [0, 1] {
        let law = I2t::new(I2tSettings { shown_time, ..SECOND });
        filter.step(&law, -1234.0);
        assert_eq!(filter.current(), -1234.0);
    }
    filter.step(&I2t::new(I2tSettings { time: 0, shown_time: 8, ..SECOND }), 0.0);
    assert_eq!(filter.current(), -1234.0 * 7.0 / 8.0, "shown without supervision, too");
}

#[test]
fn no_measurement_poisons_the_filter() {
    let (law, mut filter) = (I2t::new(SECOND), HeatFilter::default());
    filter.step(&law, 500.0);
    filter.step(&law, f64::NAN);
    assert_eq!(filter.current(), 500.0);
    for current in [f64::INFINITY, f64::NEG_INFINITY, f64::MAX] {
        filter.step(&law, current);
        assert!(filter.is_sound(), "{filter:?}");
    }
}

#[test]
fn unreachable_state_is_not_sound() {
    let bad = [
        I2tSettings { time: -1, ..SECOND },
        I2tSettings { limit: MLONG + 1, ..SECOND },
        I2tSettings { shown_time: -1, ..SECOND },
        I2tSettings { cycle: 0.0, ..SECOND },
        I2tSettings { cycle: f64::NAN, ..SECOND },
    ];
    for settings in bad {
        assert!(!settings.is_sound() && !I2t::new(settings).is_sound(), "{settings:?}");
    }
    let law = I2t::new(SECOND);
    assert!(law.is_sound() && law.settings() == SECOND);
    assert!(!I2t { share: 0.5, ..law }.is_sound() && !I2t { shown_share: f64::NAN, ..law }.is_sound());
    for value in [f64::NAN, f64::INFINITY, -1.0] {
        assert!(!HeatFilter { value, current: 0.0 }.is_sound(), "{value}");
    }
    assert!(!HeatFilter { value: 0.0, current: f64::NAN }.is_sound());
}

/// The power function differs in the last bit at some times: 3, 4, 32, 64, 256 ms.
#[test]
fn a_ms_goes_the_printed_share_to_the_last_bit() {
    for time in (1..=5000).chain([MLONG]) {
        assert_eq!(share(time, 1.0), 1.0 / f64::from(time), "{time} ms");
    }
}

proptest! {
    /// At constant current the cycles of a ms are equal to one step of a ms, and the ms of a cycle are equal to one
    /// cycle.
    #[test]
    fn cycles_of_any_length_add_up(
        time in 1..=MLONG, currents in prop::collection::vec(-60_000.0..60_000.0_f64, 1..20), parts in 2_u32..=10,
    ) {
        let settings = I2tSettings { time, limit: 0, shown_time: 0, cycle: 1.0 };
        let law = I2t::new(settings);
        let fine = I2t::new(I2tSettings { cycle: 1.0 / f64::from(parts), ..settings });
        let coarse = I2t::new(I2tSettings { cycle: f64::from(parts), ..settings });
        let (mut one, mut many) = (HeatFilter::default(), HeatFilter::default());
        let (mut long, mut short) = (HeatFilter::default(), HeatFilter::default());
        for current in currents {
            one.step(&law, current);
            long.step(&coarse, current);
            for _ in 0..parts {
                many.step(&fine, current);
                short.step(&law, current);
            }
            prop_assert!((one.value() - many.value()).abs() <= 1e-9 * one.value());
            prop_assert!((long.value() - short.value()).abs() <= 1e-9 * long.value());
        }
    }

    #[test]
    fn the_state_stays_sound(
        time in 0..=MLONG, shown_time in 0..=MLONG, cycle in 0.01..20.0_f64,
        currents in prop::collection::vec(prop::num::f64::ANY, 1..50),
    ) {
        let law = I2t::new(I2tSettings { time, limit: 5000, shown_time, cycle });
        prop_assert!(law.is_sound());
        let mut filter = HeatFilter::default();
        for current in currents {
            filter.step(&law, current);
            prop_assert!(filter.is_sound(), "{filter:?}");
        }
    }
}

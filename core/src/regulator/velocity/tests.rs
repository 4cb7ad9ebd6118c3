use super::*;
use proptest::prelude::*;

/// Defaults of the rows, at 1 ms.
const DEFAULT: VelocityGains = VelocityGains { proportional: 200, integral: 5, limit: 1000, cycle: 1.0 };

fn near(actual: f64, expected: f64) {
    assert!((actual - expected).abs() < 1e-12, "{actual}, not {expected}");
}

fn last(regulator: &mut VelocityLoop, gains: &VelocityGains, error: f64, samples: usize) -> f64 {
    (0..samples).fold(0.0, |_, _| regulator.step(gains, error))
}

/// 200/100 of the error and 5/100 of its sum, calculated by hand: 0.2 + 0.005, then -0.4 - 0.005.
#[test]
fn the_gains_weigh_the_error_and_its_sum() {
    let mut regulator = VelocityLoop::default();
    near(regulator.step(&DEFAULT, 0.1), 0.205);
    near(regulator.step(&DEFAULT, -0.2), -0.405);
    near(regulator.step(&DEFAULT, 0.0), -0.005);
    regulator.clear();
    near(regulator.step(&DEFAULT, 0.0), 0.0);
}

#[test]
fn the_integral_part_equals_the_proportional_one_after_40_ms() {
    let mut regulator = VelocityLoop::default();
    near(last(&mut regulator, &DEFAULT, 0.01, 40), 0.02 + 0.02);
}

/// VELKILIM 10 is a sum of 0.2, which gives 0.01 with VELKINT 5; 1000 gives the whole output.
///
/// Proves: MACS-AMP-05
#[test]
fn the_sum_ends_at_velkilim_either_way() {
    let gains = VelocityGains { proportional: 0, limit: 10, ..DEFAULT };
    let mut regulator = VelocityLoop::default();
    near(last(&mut regulator, &gains, 0.03, 6), 0.009);
    near(last(&mut regulator, &gains, 0.03, 1), 0.01);
    near(last(&mut regulator, &gains, 0.03, 1000), 0.01);
    near(last(&mut regulator, &gains, -0.03, 1000), -0.01);
    near(last(&mut regulator, &gains, 0.03, 1), -0.01 + 0.0015);
    let none = VelocityGains { limit: 0, ..gains };
    near(last(&mut VelocityLoop::default(), &none, 0.03, 1000), 0.0);
    let whole = VelocityGains { limit: 1000, ..gains };
    near(last(&mut VelocityLoop::default(), &whole, 0.01, 3000), 1.0);
    let half = VelocityGains { limit: 500, ..gains };
    near(last(&mut VelocityLoop::default(), &half, 0.01, 3000), 0.5);
}

#[test]
fn the_sum_does_not_grow_at_the_limit_of_the_output() {
    let mut regulator = VelocityLoop::default();
    near(last(&mut regulator, &DEFAULT, 1.0, 5000), 1.0);
    near(regulator.step(&DEFAULT, -0.1), -0.205);
    regulator.clear();
    near(last(&mut regulator, &DEFAULT, -1.0, 5000), -1.0);
    near(regulator.step(&DEFAULT, 0.1), 0.205);
}

/// An error of 0.3 gives 0.6 and leaves 0.4 for the sum: 8 ms. The last growth is cut at the limit.
#[test]
fn the_sum_brings_the_output_to_its_limit_and_no_further() {
    let mut regulator = VelocityLoop::default();
    assert!(last(&mut regulator, &DEFAULT, 0.3, 26) < 1.0);
    near(last(&mut regulator, &DEFAULT, 0.3, 1), 1.0);
    near(last(&mut regulator, &DEFAULT, 0.3, 1000), 1.0);
    near(regulator.step(&DEFAULT, 0.2), 0.4 + 0.05 * 8.2);
}

#[test]
fn negative_gains_are_used_unchanged() {
    let gains = VelocityGains { proportional: -200, integral: -5, ..DEFAULT };
    let mut regulator = VelocityLoop::default();
    near(regulator.step(&gains, 0.1), -0.205);
    near(last(&mut regulator, &gains, 1.0, 5000), -1.0);
    // The sum before the limit was reached, and this sample.
    near(regulator.step(&gains, -0.1), 0.2 - 0.05 * (0.1 - 0.1));
}

#[test]
fn eight_samples_of_an_eighth_sum_what_one_of_a_ms_does() {
    let fine = VelocityGains { cycle: 0.125, ..DEFAULT };
    let (mut one, mut eight) = (VelocityLoop::default(), VelocityLoop::default());
    for k in 0..200 {
        let error = f64::from(k % 7 - 3) * 0.01;
        near(last(&mut eight, &fine, error, 8), one.step(&DEFAULT, error));
    }
}

/// 0.4 with VELKPROP 200, 0.2 with 100: half of the difference after half of the time.
#[test]
fn the_offset_of_a_change_falls_to_nothing_in_its_time() {
    let before = VelocityGains { integral: 0, ..DEFAULT };
    let after = VelocityGains { proportional: 100, ..before };
    let mut regulator = VelocityLoop::default();
    near(regulator.step(&before, 0.2), 0.4);
    near(regulator.step(&after, 0.2), 0.4);
    near(last(&mut regulator, &after, 0.2, 50), 0.3);
    near(last(&mut regulator, &after, 0.2, 50), 0.2);
    near(last(&mut regulator, &after, 0.2, 50), 0.2);
    let fine = VelocityGains { cycle: 0.125, ..before };
    near(last(&mut regulator, &fine, 0.2, 1), 0.2);
    near(last(&mut regulator, &fine, 0.2, 400), 0.3);
    near(last(&mut regulator, &fine, 0.2, 400), 0.4);
}

#[test]
fn a_load_that_is_held_stays_held_when_velkint_changes() {
    let mut regulator = VelocityLoop::default();
    last(&mut regulator, &DEFAULT, 0.1, 100);
    let held = regulator.step(&DEFAULT, 0.0);
    near(held, 0.5);
    let after = VelocityGains { integral: 20, ..DEFAULT };
    for _ in 0..200 {
        near(regulator.step(&after, 0.0), held);
    }
    // The bound of the sum now gives 0.2: the rest decreases slowly.
    let bounded = VelocityGains { limit: 50, ..after };
    near(regulator.step(&bounded, 0.0), held);
    near(last(&mut regulator, &bounded, 0.0, 200), 0.2);
}

/// A law of 1.2 or more with an offset of -0.9 would be below the limit: the sum must not treat that as room.
#[test]
fn an_offset_hides_no_saturation_from_the_sum() {
    let before = VelocityGains { proportional: 25, integral: 0, ..DEFAULT };
    let mut regulator = VelocityLoop::default();
    near(regulator.step(&before, 0.4), 0.1);
    let after = VelocityGains { proportional: 300, integral: 5, ..DEFAULT };
    near(regulator.step(&after, 0.4), 0.1);
    near(last(&mut regulator, &after, 0.4, 100), 1.0);
    near(regulator.step(&after, 0.0), 0.0);
}

/// A mass that full current accelerates to full speed in 40 ms, with a load of 30 %.
#[test]
fn a_drive_reaches_its_speed_without_an_error_that_stays() {
    let (mut regulator, mut speed) = (VelocityLoop::default(), 0.0);
    let mut most = 0.0_f64;
    for _ in 0..1000 {
        let output = regulator.step(&DEFAULT, 0.5 - speed);
        speed += (output - 0.3) / 40.0;
        most = most.max(speed);
    }
    assert!((speed - 0.5).abs() < 1e-6, "{speed}");
    assert!(most < 0.65, "{most}");
}

#[test]
fn no_measurement_poisons_the_loop() {
    let mut regulator = VelocityLoop::default();
    for error in [f64::NAN, f64::INFINITY, 0.1, f64::NEG_INFINITY, f64::MAX, f64::NAN, f64::MIN_POSITIVE] {
        let output = regulator.step(&DEFAULT, error);
        assert!(output.abs() <= 1.0 && regulator.is_sound(), "{error}: {output}");
    }
    near(VelocityLoop::default().step(&DEFAULT, f64::NAN), 0.0);
}

#[test]
fn a_state_beyond_what_the_loop_reaches_is_not_sound() {
    let sound = VelocityLoop { gains: Some(DEFAULT), ..VelocityLoop::default() };
    assert!(sound.is_sound());
    for bad in [f64::NAN, f64::INFINITY, 656.0, -656.0] {
        assert!(!VelocityLoop { sum: bad, ..sound }.is_sound(), "{bad}");
        assert!(!VelocityLoop { offset: bad, ..sound }.is_sound(), "{bad}");
        assert!(!VelocityLoop { fall: bad, ..sound }.is_sound(), "{bad}");
    }
    let gains = [
        VelocityGains { proportional: 32_768, ..DEFAULT },
        VelocityGains { integral: -32_768, ..DEFAULT },
        VelocityGains { limit: -1, ..DEFAULT },
        VelocityGains { cycle: 0.0, ..DEFAULT },
        VelocityGains { cycle: f64::NAN, ..DEFAULT },
    ];
    for bad in gains {
        assert!(!VelocityLoop { gains: Some(bad), ..sound }.is_sound(), "{bad:?}");
    }
}

fn gains() -> impl Strategy<Value = VelocityGains> {
    let cycle = prop::sample::select(vec![0.125, 0.25, 1.0, 2.0, 10.0]);
    (-32_767..=32_767, -32_767..=32_767, 0..=32_767, cycle)
        .prop_map(|(proportional, integral, limit, cycle)| VelocityGains { proportional, integral, limit, cycle })
}

fn mild() -> impl Strategy<Value = VelocityGains> {
    (-400..=400, -20..=20, 0..=2000).prop_map(|(proportional, integral, limit)| VelocityGains {
        proportional,
        integral,
        limit,
        cycle: 1.0,
    })
}

proptest! {
    /// A loop whose gains change has the same output in that sample as one whose gains stay.
    #[test]
    fn a_change_of_gains_moves_nothing(
        first in prop_oneof![gains(), mild()], second in prop_oneof![gains(), mild()], third in prop_oneof![gains(), mild()],
        errors in prop::collection::vec(-0.5..0.5_f64, 1..40), more in prop::collection::vec(-0.5..0.5_f64, 0..40),
        at in -1.0..1.0_f64,
    ) {
        let second = VelocityGains { cycle: first.cycle, ..second };
        let third = VelocityGains { cycle: first.cycle, ..third };
        let mut regulator = VelocityLoop::default();
        for error in &errors {
            regulator.step(&first, *error);
        }
        let (mut kept, mut changed) = (regulator, regulator);
        prop_assert!((kept.step(&first, at) - changed.step(&second, at)).abs() < 1e-9);
        for error in &more {
            changed.step(&second, *error);
        }
        kept = changed;
        prop_assert!((kept.step(&second, at) - changed.step(&third, at)).abs() < 1e-9, "while the offset falls");
        prop_assert!(changed.is_sound());
    }

    #[test]
    fn the_output_and_the_state_stay_in_their_bounds(
        steps in prop::collection::vec((prop_oneof![gains(), mild()], prop::num::f64::ANY), 1..60),
    ) {
        let mut regulator = VelocityLoop::default();
        for (gains, error) in steps {
            let output = regulator.step(&gains, error);
            prop_assert!(output.abs() <= 1.0, "{output}");
            prop_assert!(regulator.is_sound(), "{regulator:?}");
            prop_assert!(regulator.sum.abs() <= f64::from(gains.limit) * VELOCITY_SUM);
        }
    }

    /// At its limit the output holds the sum, with any signs of the gains.
    #[test]
    fn a_saturated_output_stops_the_sum(
        gains in mild(), errors in prop::collection::vec(-2.0..2.0_f64, 1..60),
    ) {
        let mut regulator = VelocityLoop::default();
        for error in errors {
            let before = regulator.sum;
            let law = regulator.law(&gains, error);
            regulator.step(&gains, error);
            let part = gains.output_per_ms() * (regulator.sum - before);
            let bound = before.abs() > gains.sum_bound();
            prop_assert!(bound || law < 1.0 || part <= 1e-12, "{law} {part}");
            prop_assert!(bound || law > -1.0 || part >= -1e-12, "{law} {part}");
        }
    }
}

/// With a smaller limit the sum stops when the output reaches that limit: 2 e gives 0.4, and the sum the remaining 0.1
/// up to 0.5. With the first error of the opposite sign the output leaves the limit.
#[test]
fn smaller_limit_causes_no_windup() {
    let gains = VelocityGains { proportional: 200, integral: 5, limit: 1000, cycle: 1.0 };
    let mut law = VelocityLoop::default();
    let outputs: Vec<_> = (0..100).map(|_| law.step_within(&gains, 0.2, 0.5)).collect();
    assert!(outputs.iter().all(|output| *output <= 0.5) && outputs[99] == 0.5, "{:?}", outputs[99]);
    let back = law.step_within(&gains, -0.01, 0.5);
    // -0.02 of the error, 0.1 of the sum less one sample.
    assert!((back - (0.1 - 0.02 - 0.0005)).abs() < 1e-12, "{back}");
    assert_eq!(VelocityLoop::default().step_within(&gains, 1.0, 0.0), 0.0);
    assert_eq!(VelocityLoop::default().step_within(&gains, 1.0, f64::NAN), 0.0);
}

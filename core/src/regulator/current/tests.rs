use super::*;
use proptest::prelude::*;

/// A winding of 1 mH and 1 ohm on a DC6 at 24 V.
const DC6_24: Winding =
    Winding { beta: 0.2, sample: CURRENT_SAMPLE, voltage: 24.0, scale: DC6, inductance: 1e-3, resistance: 1.0 };
/// A winding of 0.5 mH and 0.4 ohm on a DC3 at 48 V.
const DC3_48: Winding =
    Winding { beta: 0.1, sample: CURRENT_SAMPLE, voltage: 48.0, scale: DC3, inductance: 0.5e-3, resistance: 0.4 };

/// One unit of gain gives 1/16 V per A, so that 2 V/A and 1 V per A and sample can be calculated by hand.
const UNIT: CurrentGains =
    CurrentGains { proportional: 32.0, integral: 4.0, limit: 100.0, voltage: 16.0, scale: (1_u32 << 19) as f64 };

fn near(actual: f64, expected: f64, tolerance: f64) {
    assert!((actual - expected).abs() <= tolerance, "{actual}, not {expected}");
}

fn last(regulator: &mut CurrentLoop, gains: &CurrentGains, error: f64, samples: usize) -> f64 {
    (0..samples).fold(0.0, |_, _| regulator.step(gains, error))
}

/// Proves: MACS-O-28
#[test]
fn the_design_of_a_dc6_at_24_v() {
    let design = DC6_24.design().unwrap();
    near(design.bandwidth, 2513.274, 0.0005);
    near(design.proportional, 3435.78, 0.005);
    near(design.integral, 168.43, 0.005);
}

/// Proves: MACS-O-29
#[test]
fn the_design_of_a_dc3_at_48_v() {
    let design = DC3_48.design().unwrap();
    near(design.bandwidth, 1256.637, 0.0005);
    near(design.proportional, 685.36, 0.005);
    near(design.integral, 19.74, 0.005);
}

/// The exact discretization of L di/dt + R i = voltage, held over a sample.
struct Plant {
    winding: Winding,
    decay: f64,
    current: f64,
}

impl Plant {
    fn new(winding: Winding, sample: f64) -> Self {
        let decay = libm::exp(-sample * winding.resistance / winding.inductance);
        Self { winding, decay, current: 0.0 }
    }

    fn step(&mut self, voltage: f64) {
        let rest = voltage / self.winding.resistance;
        self.current = rest + (self.current - rest) * self.decay;
    }
}

/// Returns the gains of the design, and those of the same loop sampled `finer` times as often: CURKINT is proportional
/// to Ts.
fn designed(winding: Winding, finer: f64) -> (f64, CurrentGains) {
    let design = winding.design().unwrap();
    let gains = CurrentGains {
        proportional: design.proportional,
        integral: design.integral / finer,
        limit: MOST,
        voltage: winding.voltage,
        scale: winding.scale,
    };
    (design.bandwidth, gains)
}

/// Factor for finer sampling, with which the error of the continuous model is below 1/1000 of the step.
const FINE: f64 = 256.0;

/// The double pole alone: a setpoint through a lag that cancels the zero of the loop gives 1 - (1 + w t) e^(-w t).
///
/// Proves: MACS-AMP-07
#[test]
fn the_loop_has_a_double_pole_at_the_bandwidth() {
    for winding in [DC6_24, DC3_48] {
        let (w, gains) = designed(winding, FINE);
        let sample = winding.sample / FINE;
        // The coefficients of the loop: K = 2 w L - R, its integral w^2 L.
        let zero = (2.0 * w * winding.inductance - winding.resistance) / (w * w * winding.inductance);
        let lag = libm::exp(-sample / zero);
        let (mut regulator, mut plant, mut setpoint) = (CurrentLoop::default(), Plant::new(winding, sample), 1.0);
        let mut worst = 0.0_f64;
        for k in 1..=20_000 {
            setpoint *= lag;
            let voltage = regulator.step(&gains, 1.0 - setpoint - plant.current);
            plant.step(voltage);
            let time = w * f64::from(k) * sample;
            worst = worst.max((plant.current - (1.0 - (1.0 + time) * libm::exp(-time))).abs());
        }
        assert!(worst < 1e-3, "{worst}");
    }
}

/// The response to a step of the setpoint is 1 - (1 + (R/L - w) t) e^(-w t); a disturbance voltage moves the current by
/// t e^(-w t) / L.
#[test]
fn the_loop_answers_steps_as_its_poles_and_zero_say() {
    for winding in [DC6_24, DC3_48] {
        let (w, gains) = designed(winding, FINE);
        let (sample, own) = (winding.sample / FINE, winding.resistance / winding.inductance);
        let (mut regulator, mut plant) = (CurrentLoop::default(), Plant::new(winding, sample));
        let (mut against, mut pushed) = (CurrentLoop::default(), Plant::new(winding, sample));
        for k in 1..=20_000 {
            plant.step(regulator.step(&gains, 1.0 - plant.current));
            pushed.step(against.step(&gains, -pushed.current) + 1.0);
            let time = f64::from(k) * sample;
            let fading = libm::exp(-w * time);
            near(plant.current, 1.0 - (1.0 + (own - w) * time) * fading, 4e-3);
            near(pushed.current * winding.inductance * w, w * time * fading, 1e-3);
        }
    }
}

/// At the sampling rate of the source the loop differs from the continuous one; it settles without remaining error.
#[test]
fn the_loop_settles_at_the_rate_of_the_source() {
    for winding in [DC6_24, DC3_48, Winding { beta: 0.3, ..DC6_24 }] {
        let (_, gains) = designed(winding, 1.0);
        let (mut regulator, mut plant) = (CurrentLoop::default(), Plant::new(winding, winding.sample));
        let mut most = 0.0_f64;
        for _ in 0..400 {
            plant.step(regulator.step(&gains, 1.0 - plant.current) - 3.0);
            most = most.max(plant.current);
        }
        near(plant.current, 1.0, 1e-9);
        assert!(most < 1.3, "{most}");
    }
}

/// 2 V/A of the error and 4 times 1/4 V of its sum, calculated by hand.
#[test]
fn the_gains_weigh_the_error_and_four_times_its_sum() {
    let mut regulator = CurrentLoop::default();
    assert!(UNIT.is_sound());
    near(regulator.step(&UNIT, 1.0), 3.0, 1e-12);
    near(regulator.step(&UNIT, -2.0), -5.0, 1e-12);
    near(regulator.step(&UNIT, 0.0), -1.0, 1e-12);
    regulator.clear();
    near(regulator.step(&UNIT, 0.0), 0.0, 0.0);
}

/// Proves: MACS-AMP-05
#[test]
fn the_sum_ends_at_curkilim_either_way() {
    let gains = CurrentGains { proportional: 0.0, limit: 5.0, ..UNIT };
    let mut regulator = CurrentLoop::default();
    near(last(&mut regulator, &gains, 2.0, 2), 4.0, 1e-12);
    near(last(&mut regulator, &gains, 2.0, 1), 5.0, 1e-12);
    near(last(&mut regulator, &gains, 2.0, 1000), 5.0, 1e-12);
    near(last(&mut regulator, &gains, -2.0, 1000), -5.0, 1e-12);
    near(last(&mut regulator, &CurrentGains { limit: 0.0, ..gains }, 2.0, 1000), 0.0, 1e-12);
}

#[test]
fn the_sum_does_not_grow_at_the_limit_of_the_voltage() {
    let mut regulator = CurrentLoop::default();
    near(last(&mut regulator, &UNIT, 50.0, 1000), 16.0, 1e-12);
    near(regulator.step(&UNIT, -1.0), -3.0, 1e-12);
    regulator.clear();
    // 6 of the error leave 10 for the sum.
    near(last(&mut regulator, &UNIT, 3.0, 1000), 16.0, 1e-12);
    near(regulator.step(&UNIT, -1.0), -2.0 + 9.0, 1e-12);
}

/// The sum of 10 becomes 5 with the bound; -20 of the error and 5 leave 1 V for the sum.
#[test]
fn a_bound_that_falls_counts_before_the_room_is_measured() {
    let bounded = CurrentGains { limit: 5.0, ..UNIT };
    let mut regulator = CurrentLoop { sum: 10.0, gains: Some(bounded), ..CurrentLoop::default() };
    near(regulator.step(&bounded, -10.0), -16.0, 1e-12);
    near(regulator.step(&bounded, 0.0), 4.0, 1e-12);
}

#[test]
fn a_setpoint_is_capped_either_way() {
    assert_eq!(
        [1999.5, 2000.5, -1999.5, -9e9].map(|current| capped(current, 2000.0)),
        [1999.5, 2000.0, -1999.5, -2000.0]
    );
    assert_eq!(
        [f64::NAN, f64::INFINITY, f64::NEG_INFINITY].map(|current| capped(current, 2000.0)),
        [0.0, 2000.0, -2000.0]
    );
    assert_eq!(capped(5.0, 0.0), 0.0);
    assert_eq!(capped(5.0, -1.0), 0.0);
}

#[test]
fn a_design_beyond_its_ranges_is_refused() {
    let bad = [
        Winding { beta: 0.09, ..DC6_24 },
        Winding { beta: 0.31, ..DC6_24 },
        Winding { beta: f64::NAN, ..DC6_24 },
        Winding { sample: 0.0, ..DC6_24 },
        Winding { voltage: 11.9, ..DC6_24 },
        Winding { voltage: 48.1, ..DC6_24 },
        Winding { scale: 0.0, ..DC6_24 },
        Winding { inductance: -1e-3, ..DC6_24 },
        Winding { inductance: 0.0, ..DC6_24 },
        Winding { resistance: -1.0, ..DC6_24 },
        Winding { resistance: f64::INFINITY, ..DC6_24 },
    ];
    for winding in bad {
        assert!(matches!(winding.design(), Err(DesignError::Range { .. })), "{winding:?}");
    }
    let sentence = |winding: Winding| winding.design().unwrap_err().to_string();
    assert_eq!(sentence(Winding { voltage: 60.0, ..DC6_24 }), "U is 60 V; 12 to 48 V is permitted");
    assert_eq!(sentence(Winding { beta: 0.5, ..DC6_24 }), "Beta is 0.5; 0.1 to 0.3 is permitted");
    let slow = sentence(Winding { inductance: 1.0, resistance: 0.0, ..DC6_24 });
    assert!(slow.starts_with("the design needs CURKPROP 4289"), "{slow}");
    assert!(slow.ends_with("; -32767 to 32767 is permitted"), "{slow}");
}

#[test]
fn a_winding_that_is_faster_by_itself_gets_a_negative_gain() {
    let design = Winding { resistance: 10.0, ..DC6_24 }.design().unwrap();
    assert!(design.proportional < 0.0 && design.integral > 0.0);
}

#[test]
fn a_state_beyond_what_the_loop_reaches_is_not_sound() {
    assert!(CurrentLoop { sum: -32_767.0, ..CurrentLoop::default() }.is_sound());
    for sum in [f64::NAN, f64::INFINITY, 32_768.0] {
        assert!(!CurrentLoop { sum, ..CurrentLoop::default() }.is_sound(), "{sum}");
    }
    let (_, sound) = designed(DC6_24, 1.0);
    assert!(sound.is_sound());
    let bad = [
        CurrentGains { proportional: f64::NAN, ..sound },
        CurrentGains { integral: 32_768.0, ..sound },
        CurrentGains { limit: -1.0, ..sound },
        CurrentGains { voltage: 0.0, ..sound },
        CurrentGains { scale: f64::INFINITY, ..sound },
    ];
    for gains in bad {
        assert!(!gains.is_sound(), "{gains:?}");
        assert!(!CurrentLoop { gains: Some(gains), ..CurrentLoop::default() }.is_sound(), "{gains:?}");
    }
}

/// With 2 V/A and 1 V per unit of the sum: an error of 1 A, and a sum of 4, give 6 V. With doubled CURKINT the integral
/// part remains with half the sum; doubled CURKPROP would add 2 V, which are compensated and fade within 64 samples.
/// Each error is followed by the opposite one, so that the sum does not change.
#[test]
fn other_gains_do_not_step_the_voltage() {
    let mut regulator = CurrentLoop::default();
    near(last(&mut regulator, &UNIT, 1.0, 4), 6.0, 1e-12);
    // In its sample the gains before give the voltage: 2 + 5.
    let twice = CurrentGains { integral: 8.0, ..UNIT };
    near(regulator.step(&twice, 1.0), 7.0, 1e-12);
    near(regulator.sum, 2.5, 1e-12);
    near(regulator.step(&twice, 0.0), 5.0, 1e-12);
    let stiff = CurrentGains { proportional: 64.0, ..twice };
    // 2 + 5 + 2 with the gains before; 4 + 7 with the new ones.
    near(regulator.step(&stiff, 1.0), 9.0, 1e-12);
    for sample in 0..64 {
        let rest = -2.0 * (1.0 - f64::from(sample) / 64.0);
        near(regulator.step(&stiff, 0.0), 7.0 + rest, 1e-9);
        assert!(regulator.is_sound());
    }
    near(regulator.step(&stiff, 0.0), 7.0, 1e-12);
    // Without integral part all of it fades.
    near(regulator.step(&CurrentGains { integral: 0.0, ..stiff }, 0.0), 7.0, 1e-12);
    near(last(&mut regulator, &CurrentGains { integral: 0.0, ..stiff }, 0.0, 65), 0.0, 1e-12);
}

proptest! {
    /// With any gains before: the voltage of the sample in which gains change is that of the gains before.
    #[test]
    fn change_of_gains_causes_no_step(
        before in prop::array::uniform3(-32_767.0..32_767.0_f64), behind in prop::array::uniform3(-32_767.0..32_767.0_f64),
        errors in prop::collection::vec(-20.0..20.0_f64, 1..60), error in -20.0..20.0_f64,
    ) {
        let gains = |[proportional, integral, limit]: [f64; 3]| {
            CurrentGains { proportional, integral, limit: limit.abs(), voltage: 24.0, scale: DC6 }
        };
        let (before, behind) = (gains(before), gains(behind));
        let mut regulator = CurrentLoop::default();
        for error in errors {
            regulator.step(&before, error);
        }
        let mut other = regulator;
        let (kept, changed) = (regulator.step(&before, error), other.step(&behind, error));
        prop_assert!((kept - changed).abs() <= 1e-9, "{kept} V becomes {changed} V");
        prop_assert!(other.is_sound());
    }


    #[test]
    fn the_voltage_and_the_sum_stay_in_their_bounds(
        proportional in -32_767.0..32_767.0_f64, integral in -32_767.0..32_767.0_f64, limit in 0.0..32_767.0_f64,
        errors in prop::collection::vec(prop_oneof![prop::num::f64::ANY, -20.0..20.0_f64], 1..60),
    ) {
        let gains = CurrentGains { proportional, integral, limit, voltage: 24.0, scale: DC6 };
        let mut regulator = CurrentLoop::default();
        for error in errors {
            let voltage = regulator.step(&gains, error);
            prop_assert!(voltage.abs() <= 24.0, "{voltage}");
            prop_assert!(regulator.is_sound() && regulator.sum.abs() <= limit);
        }
    }
}

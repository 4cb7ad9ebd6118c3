//! Margins and poles of loops, compared with closed forms and with polynomials that are derived here by hand.

use lineshaft_core::regulator::{K_OUT, VELOCITY_GAIN, VelocityMethod};
use lineshaft_tune::{
    Design, DesignError, DesignSpec, Dynamics, Inner, Law, Loops, Margins, Model, PositionLaw, Resonance, Targets,
    bode, design, velocity_bode,
};
use nalgebra::{Complex, DMatrix};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

const CYCLE: f64 = 1e-3;

/// Coefficients, the lowest power first.
type Polynomial = Vec<f64>;

fn times(a: &[f64], b: &[f64]) -> Polynomial {
    let mut product = vec![0.0; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            product[i + j] += x * y;
        }
    }
    product
}

fn plus(a: &[f64], b: &[f64]) -> Polynomial {
    let at = |p: &[f64], i: usize| p.get(i).copied().unwrap_or(0.0);
    (0..a.len().max(b.len())).map(|i| at(a, i) + at(b, i)).collect()
}

fn power_of_z(n: usize) -> Polynomial {
    let mut power = vec![0.0; n];
    power.push(1.0);
    power
}

/// Returns the largest magnitude of a root: eigenvalues of the companion matrix.
fn radius(polynomial: &[f64]) -> f64 {
    let degree = polynomial.len() - 1;
    let leading = polynomial[degree];
    let companion = DMatrix::from_fn(degree, degree, |i, j| {
        if j == degree - 1 {
            -polynomial[i] / leading
        } else if i == j + 1 {
            1.0
        } else {
            0.0
        }
    });
    companion.complex_eigenvalues().iter().fold(0.0, |most, root| most.max(norm(*root)))
}

fn norm(x: Complex<f64>) -> f64 {
    x.re.hypot(x.im)
}

fn value(polynomial: &[f64], z: Complex<f64>) -> Complex<f64> {
    polynomial.iter().rev().fold(Complex::new(0.0, 0.0), |sum, x| sum * z + x)
}

/// An open loop: numerator and denominator.
struct Open(Polynomial, Polynomial);

impl Open {
    fn at(&self, omega: f64) -> Complex<f64> {
        let z = Complex::new(omega.cos(), omega.sin());
        value(&self.0, z) / value(&self.1, z)
    }

    fn closed(&self) -> f64 {
        radius(&plus(&self.0, &self.1))
    }

    /// Returns phase margin (degrees) and gain margin (dB), evaluated on the unit circle in 40000 steps.
    fn margins(&self) -> (f64, f64) {
        let (mut phase, mut gain) = (180.0_f64, f64::INFINITY);
        let mut before = self.at(PI * 1e-6);
        for k in 2..=40_000 {
            let omega = PI * libm::exp10(-6.0 * (1.0 - f64::from(k) / 40_000.0));
            let now = self.at(omega);
            if (norm(before) > 1.0) != (norm(now) > 1.0) {
                phase = phase.min(now.im.atan2(-now.re).abs().to_degrees());
            }
            if now.re < 0.0 && (before.im < 0.0) != (now.im < 0.0) && norm(now) < 1.0 {
                gain = gain.min(-20.0 * norm(now).log10());
            }
            before = now;
        }
        let last = self.at(PI);
        if last.re < 0.0 && norm(last) < 1.0 {
            gain = gain.min(-20.0 * norm(last).log10());
        }
        (phase, gain)
    }
}

/// Returns gain / (s (time s + 1)) with a hold of `period` and `late` samples of delay.
fn axis(gain: f64, time: f64, period: f64, late: usize) -> Open {
    let p = (-period / time).exp();
    let near = gain * (period - time * (1.0 - p));
    let far = gain * (time * (1.0 - p) - p * period);
    Open(vec![far, near], times(&power_of_z(late), &times(&[-1.0, 1.0], &[-p, 1.0])))
}

fn chain(law: &Open, axis: &Open) -> Open {
    Open(times(&law.0, &axis.0), times(&law.1, &axis.1))
}

/// Returns the law of KPROP, KDER, KINT.
fn pid(loops: &Loops) -> Open {
    let PositionLaw::Pid { gains, .. } = loops.position else { panic!("{loops:?}") };
    let [p, d, i] = [gains.proportional, gains.derivative, gains.integral].map(|gain| gain as f64 / K_OUT);
    if i == 0.0 {
        return Open(vec![-d, p + d], vec![0.0, 1.0]);
    }
    // (p z (z - 1) + d (z - 1)^2 + i z^2) / (z (z - 1))
    Open(vec![d, -p - 2.0 * d, p + d + i], vec![0.0, -1.0, 1.0])
}

/// Returns the law of VELKPROP, VELKINT.
fn pi(inner: &Inner) -> Open {
    let p = f64::from(inner.gains.proportional) * VELOCITY_GAIN;
    let i = f64::from(inner.gains.integral) * VELOCITY_GAIN * 1000.0 * CYCLE;
    if i == 0.0 { Open(vec![p], vec![1.0]) } else { Open(vec![-p, p + i], vec![-1.0, 1.0]) }
}

fn wish(law: Law, velocity: Option<VelocityMethod>, max_velocity: f64) -> DesignSpec {
    let (max_acceleration, targets) = (10.0 * max_velocity, Targets::default());
    DesignSpec { law, velocity, max_velocity, max_acceleration, inertia_ratio: 0.0, targets }
}

fn agree(margins: &Margins, open: &Open) -> Result<(), TestCaseError> {
    let closed = open.closed();
    prop_assert!(closed < 1.0, "{closed}");
    prop_assert!((closed - margins.radius).abs() < 1e-4, "{closed} {}", margins.radius);
    let (phase, gain) = open.margins();
    prop_assert!((phase - margins.phase).abs() < 0.3, "{phase} {}", margins.phase);
    prop_assert!(phase >= 59.7, "{phase}");
    prop_assert!(gain >= 5.9, "{gain}");
    let same = gain.is_infinite() && margins.gain.is_infinite();
    prop_assert!(same || (gain - margins.gain).abs() < 0.1, "{gain} {}", margins.gain);
    Ok(())
}

/// An integrator with a delay of whole cycles: 2 sin(w/2) = kv T at the crossover, and each sample of delay, with half
/// a sample of the hold, shifts the phase by w.
#[test]
fn an_integrator_with_a_delay_has_the_margins_of_its_closed_form() {
    for late in 0..6 {
        let delay = late as f64 * CYCLE;
        let model =
            Model { cycle: CYCLE, delay, dynamics: Dynamics::Velocity { gain: 1e5, time_constant: 0.0, offset: 0.0 } };
        for kv in [1.0, 10.0, 60.0, 110.0] {
            let loops = Loops {
                position: PositionLaw::Proportional { kv },
                velocity: None,
                max_velocity: 1e5,
                max_acceleration: 1e6,
            };
            let margins = bode(&model, &loops).unwrap().margins;
            let crossover = 2.0 * (kv * CYCLE / 2.0).asin();
            let lag = late as f64 + 0.5;
            let phase = 90.0 - (crossover * lag).to_degrees();
            assert!((margins.phase - phase).abs() < 0.01, "{late} {kv}: {} {phase}", margins.phase);
            assert!((margins.crossover - crossover / TAU / CYCLE).abs() < 1e-3 * margins.crossover, "{margins:?}");
            let critical = PI / 2.0 / lag;
            let gain = 20.0 * (2.0 * (critical / 2.0).sin() / (kv * CYCLE)).log10();
            assert!((margins.gain - gain).abs() < 0.01, "{late} {kv}: {} {gain}", margins.gain);
            // In continuous time, if the crossover is slow relative to the cycle: 90 deg - w T.
            let continuous = 90.0 - (kv * (delay + CYCLE / 2.0)).to_degrees();
            assert!(kv > 20.0 || (margins.phase - continuous).abs() < 0.1, "{late} {kv}: {continuous}");
        }
    }
}

/// A fraction of a cycle shifts the phase by that fraction.
#[test]
fn a_delay_of_a_part_of_a_cycle_turns_the_phase_by_that_part() {
    for part in [0.0, 0.1, 0.25, 0.5, 0.9, 1.3, 2.75] {
        let dynamics = Dynamics::Velocity { gain: 1e5, time_constant: 0.02, offset: 0.0 };
        let model = Model { cycle: CYCLE, delay: part * CYCLE, dynamics };
        let loops = Loops {
            position: PositionLaw::Proportional { kv: 15.0 },
            velocity: None,
            max_velocity: 1e5,
            max_acceleration: 1e6,
        };
        let margins = bode(&model, &loops).unwrap().margins;
        let omega = TAU * margins.crossover;
        let expected = 90.0 - (omega * 0.02).atan().to_degrees() - (omega * (part + 0.5) * CYCLE).to_degrees();
        assert!((margins.phase - expected).abs() < 0.1, "{part}: {} {expected}", margins.phase);
    }
}

/// The frequency of the oscillation with a free motor is the peak of the response, that with a held motor is the dip.
#[test]
fn a_resonance_peaks_where_it_is() {
    let resonance = Some(Resonance { frequency: 60.0, damping: 0.02, inertia_ratio: 3.0 });
    let dynamics = Dynamics::Effort { acceleration: 1e6, viscous: 0.0, coulomb: 0.0, load: 0.0, resonance };
    let model = Model { cycle: CYCLE, delay: 0.0, dynamics };
    let found = design(&model, &wish(Law::Pid { timer: 1 }, None, 1e5)).unwrap();
    let points = bode(&model, &found.loops).unwrap().points;
    let near = |from: f64, to: f64| points.iter().filter(move |p| (from..to).contains(&p.frequency));
    let peak = near(45.0, 90.0).max_by(|a, b| a.open_gain.total_cmp(&b.open_gain)).unwrap();
    let dip = near(20.0, 40.0).min_by(|a, b| a.open_gain.total_cmp(&b.open_gain)).unwrap();
    assert!((peak.frequency - 60.0).abs() < 0.6, "{}", peak.frequency);
    assert!((dip.frequency - 30.0).abs() < 0.3, "{}", dip.frequency);
}

/// The same model with slower or faster sampling, and with given targets.
#[test]
fn targets_are_met_as_they_are_given() {
    let dynamics = Dynamics::Velocity { gain: 1e5, time_constant: 0.01, offset: 0.0 };
    for cycle in [1.25e-4, 1e-3, 4e-3] {
        let model = Model { cycle, delay: 0.0013, dynamics };
        let mut stiffest = f64::INFINITY;
        for phase_margin in [30.0, 45.0, 60.0, 75.0] {
            let targets = Targets { phase_margin, gain_margin: 10.0, ..Targets::default() };
            let found = design(&model, &DesignSpec { targets, ..wish(Law::Proportional, None, 1e5) }).unwrap();
            let PositionLaw::Proportional { kv } = found.loops.position else { panic!() };
            assert!(found.position.phase >= phase_margin && found.position.gain >= 10.0, "{found:?}");
            assert!(kv < stiffest, "more margin is less gain: {kv} {stiffest}");
            // Not more than necessary: one of both is near its target.
            assert!(found.position.phase < phase_margin + 3.0 || found.position.gain < 10.5, "{found:?}");
            stiffest = kv;
        }
    }
}

#[test]
fn impossible_design_is_refused() {
    let velocity = Dynamics::Velocity { gain: 1e5, time_constant: 0.01, offset: 0.0 };
    let effort = Dynamics::Effort { acceleration: 1e6, viscous: 0.0, coulomb: 0.0, load: 0.0, resonance: None };
    let model = |dynamics| Model { cycle: CYCLE, delay: 0.0, dynamics };
    let said = |model: Model, wish: DesignSpec| design(&model, &wish).unwrap_err().to_string();
    assert_eq!(
        said(model(velocity), wish(Law::Proportional, Some(VelocityMethod::Difference), 1e5)),
        "the drive takes velocities; a velocity loop suits one that takes efforts"
    );
    assert_eq!(
        said(model(effort), wish(Law::Proportional, None, 1e5)),
        "the drive takes efforts; a proportional position loop suits one that takes velocities, or a velocity loop below it"
    );
    let slow = Model { cycle: 4e-3, ..model(velocity) };
    assert_eq!(
        said(slow, wish(Law::Pid { timer: 6 }, None, 1e5)),
        "timer is 6 ms; a whole number of cycles of 4 ms, up to 1000 ms, is permitted"
    );
    assert_eq!(
        said(Model { delay: -1.0, ..model(velocity) }, wish(Law::Proportional, None, 1e5)),
        "delay is -1 s; 0 to 0.05 s is permitted"
    );
    let targets = Targets { phase_margin: f64::NAN, ..Targets::default() };
    let none = DesignSpec { targets, ..wish(Law::Proportional, None, 1e5) };
    assert_eq!(said(model(velocity), none), "phase_margin is NaN deg; 20 to 85 deg is permitted");
    for (ratio, told) in [(-1.0, "-1"), (f64::NAN, "NaN"), (1001.0, "1001"), (f64::INFINITY, "inf")] {
        let wish = DesignSpec { inertia_ratio: ratio, ..wish(Law::Pid { timer: 1 }, None, 1e5) };
        let expected = format!("inertia_ratio is {told} times the motor's; 0 to 1000 times the motor's is permitted");
        assert_eq!(said(model(effort), wish), expected);
    }
    let wish_of_load = DesignSpec { inertia_ratio: 5.0, ..wish(Law::Proportional, None, 1e5) };
    assert_eq!(
        said(model(velocity), wish_of_load),
        "inertia_ratio is 5 times the motor's; 0 to 0 times the motor's is permitted"
    );
    // A KPROP of 1 is already too large.
    let wild = Dynamics::Velocity { gain: 1e9, time_constant: 0.01, offset: 0.0 };
    assert!(matches!(
        design(&model(wild), &wish(Law::Pid { timer: 1 }, None, 1e9)),
        Err(DesignError::Unreachable { which: "position", .. })
    ));
}

fn designed(model: &Model, wish: &DesignSpec) -> Option<Design> {
    match design(model, wish) {
        Ok(found) => Some(found),
        // Integer gains do not suit every axis.
        Err(DesignError::Unreachable { .. }) => None,
        Err(error) => panic!("{error}"),
    }
}

/// Returns the open velocity loop and the open position loop with kv around it; the velocity is the difference of two
/// samples.
fn cascade(loops: &Loops, acceleration: f64, viscous: f64, late: usize) -> (Open, Open) {
    let (most, inner) = (loops.max_velocity, loops.velocity.expect("a velocity loop"));
    let PositionLaw::Proportional { kv } = loops.position else { panic!("{loops:?}") };
    let p = (-CYCLE * viscous).exp();
    let axis = axis(acceleration / viscous, 1.0 / viscous, CYCLE, late);
    // Position to velocity: (z - 1) / (z T), whose zero is the integrator of the axis.
    let seen = times(&power_of_z(late + 1), &[-p, 1.0]);
    let scale = 1.0 / (CYCLE * most);
    let law = pi(&inner);
    let numerator: Polynomial = times(&law.0, &axis.0).iter().map(|x| x * scale).collect();
    let inner_loop = Open(numerator, times(&law.1, &seen));
    // Closed, to the position: law axis / (1 + law axis (z - 1) / (z T most)), without common factors.
    let closed = plus(&inner_loop.0, &inner_loop.1);
    let forward = times(&times(&law.0, &axis.0), &[0.0, 1.0]);
    let scaled: Polynomial = forward.iter().map(|x| x * kv / most).collect();
    (inner_loop, Open(scaled, times(&closed, &[-1.0, 1.0])))
}

/// Values between two limits, with a uniform logarithm.
fn spread(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (libm::log(low)..libm::log(high)).prop_map(libm::exp)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_proportional_loop_is_stable_with_the_margins_that_it_tells(
        gain in spread(1e3, 1e7), time in spread(5e-4, 0.3), late in 0_usize..8,
    ) {
        let dynamics = Dynamics::Velocity { gain, time_constant: time, offset: 0.0 };
        let model = Model { cycle: CYCLE, delay: late as f64 * CYCLE, dynamics };
        let found = design(&model, &wish(Law::Proportional, None, gain)).unwrap();
        let PositionLaw::Proportional { kv } = found.loops.position else { panic!() };
        agree(&found.position, &chain(&Open(vec![kv / gain], vec![1.0]), &axis(gain, time, CYCLE, late)))?;
    }

    #[test]
    fn a_pid_above_a_velocity_is_stable_with_the_margins_that_it_tells(
        gain in spread(1e3, 1e6), time in spread(5e-4, 0.1), late in 0_usize..8, timer in 1_u32..6,
    ) {
        let period = f64::from(timer) * CYCLE;
        let dynamics = Dynamics::Velocity { gain, time_constant: time, offset: 0.0 };
        // Whole periods, so that the polynomial is short.
        let model = Model { cycle: CYCLE, delay: late as f64 * period, dynamics };
        if let Some(found) = designed(&model, &wish(Law::Pid { timer }, None, gain)) {
            agree(&found.position, &chain(&pid(&found.loops), &axis(gain, time, period, late)))?;
        }
    }

    #[test]
    fn a_pid_above_an_effort_is_stable_with_the_margins_that_it_tells(
        acceleration in spread(1e4, 1e8), viscous in spread(0.1, 50.0), late in 0_usize..4, timer in 1_u32..4,
    ) {
        let period = f64::from(timer) * CYCLE;
        let dynamics = Dynamics::Effort { acceleration, viscous, coulomb: 0.0, load: 0.0, resonance: None };
        let model = Model { cycle: CYCLE, delay: late as f64 * period, dynamics };
        if let Some(found) = designed(&model, &wish(Law::Pid { timer }, None, 0.1 * acceleration)) {
            let axis = axis(acceleration / viscous, 1.0 / viscous, period, late);
            agree(&found.position, &chain(&pid(&found.loops), &axis))?;
            prop_assert!(found.position.reduction >= 6.0);
        }
    }

    #[test]
    fn a_cascade_is_stable_with_the_margins_that_it_tells(
        acceleration in spread(1e5, 1e8), viscous in spread(0.1, 50.0), late in 0_usize..4,
    ) {
        let most = 0.05 * acceleration;
        let dynamics = Dynamics::Effort { acceleration, viscous, coulomb: 0.0, load: 0.0, resonance: None };
        let model = Model { cycle: CYCLE, delay: late as f64 * CYCLE, dynamics };
        let wish = wish(Law::Proportional, Some(VelocityMethod::Difference), most);
        if let Some(found) = designed(&model, &wish) {
            let (inner_loop, outer_loop) = cascade(&found.loops, acceleration, viscous, late);
            agree(&found.velocity.unwrap(), &inner_loop)?;
            let told = velocity_bode(&model, &found.loops).unwrap().unwrap().margins;
            prop_assert!((told.phase - found.velocity.unwrap().phase).abs() < 1e-6);
            agree(&found.position, &outer_loop)?;
        }
    }
    /// With the ratio of inertias each regime keeps them: the whole inertia, and the motor alone with none and with all
    /// of the friction. A coupling that oscillates with a damping of 0.02 or more stays stable at any stiffness.
    #[test]
    fn a_cascade_with_a_ratio_keeps_its_margins_in_each_regime(
        acceleration in spread(1e6, 1e8), viscous in spread(0.1, 10.0), late in 0_usize..3, ratio in spread(0.5, 30.0),
    ) {
        let dynamics = Dynamics::Effort { acceleration, viscous, coulomb: 0.0, load: 0.0, resonance: None };
        let model = Model { cycle: CYCLE, delay: late as f64 * CYCLE, dynamics };
        // One unit of VELKPROP is a small part of the permitted gain of the motor alone.
        let most = acceleration * (1.0 + ratio) * 0.05;
        let wish = DesignSpec { inertia_ratio: ratio, ..wish(Law::Proportional, Some(VelocityMethod::Difference), most) };
        if let Some(found) = designed(&model, &wish) {
            let times = 1.0 + ratio;
            let (mut phases, mut gains) = ([180.0_f64; 2], [f64::INFINITY; 2]);
            for (by, friction) in [(1.0, viscous), (times, 1e-4), (times, times * viscous)] {
                let loops = cascade(&found.loops, by * acceleration, friction, late);
                for (i, open) in [loops.0, loops.1].iter().enumerate() {
                    let (phase, gain) = open.margins();
                    prop_assert!(open.closed() < 1.0 && phase >= 59.7 && gain >= 5.9, "{by} {friction}: {phase} {gain}");
                    (phases[i], gains[i]) = (phases[i].min(phase), gains[i].min(gain));
                }
            }
            for (i, told) in [found.velocity.unwrap(), found.position].iter().enumerate() {
                prop_assert!((told.phase - phases[i]).abs() < 0.5, "{} {}", told.phase, phases[i]);
                prop_assert!((told.gain - gains[i]).abs() < 0.2, "{} {}", told.gain, gains[i]);
            }
            for k in 0..40 {
                let frequency = 5.0 * libm::exp2(f64::from(k) / 6.1);
                let damping = 0.02 + viscous * ratio / (2.0 * TAU * frequency);
                let resonance = Some(Resonance { frequency, damping: damping.min(1.0), inertia_ratio: ratio });
                let dynamics = Dynamics::Effort { acceleration, viscous, coulomb: 0.0, load: 0.0, resonance };
                let bode = velocity_bode(&Model { dynamics, ..model }, &found.loops).unwrap().unwrap();
                prop_assert!(bode.margins.is_stable(), "{frequency} Hz: {}", bode.margins.radius);
            }
        }
    }
}

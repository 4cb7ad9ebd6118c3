//! A motor with backlash before its load: 0.5 deg, 11 inc of its encoder.

use super::catalogue::{all, with_play};
use super::simulator::{Mechanics, excite, figures, permitted, run};
use lineshaft_core::regulator::VelocityMethod;
use lineshaft_tune::{DesignSpec, Law, Refusal, Targets, check_fit, design, identify};

#[test]
fn play_is_refused_whatever_the_load_is() {
    for ratio in [1.0, 2.0, 3.0, 5.0, 10.0] {
        let axis = with_play(ratio);
        let record = excite(axis, permitted(&axis), |_| 0.0).record;
        let found = identify(&record).expect("a model");
        let refused = check_fit(&found.model, &record).expect_err("play");
        println!("1:{ratio}: {:.2} % explained, {refused}", found.explained);
        assert!(found.explained > 99.0, "{ratio}: {}", found.explained);
        let Refusal::Misfit { left, most } = refused else { panic!("{refused}") };
        assert!(left < 11.4 && most < 2.5, "{ratio}: {left} {most}");
    }
}

#[test]
fn without_play_all_axes_fit() {
    for named in all() {
        let record = excite(named.axis, permitted(&named.axis), |_| 0.0).record;
        assert_eq!(check_fit(&identify(&record).unwrap().model, &record), Ok(()), "{}", named.name);
    }
    // The same coupling without backlash as well.
    let mut axis = with_play(3.0);
    let Mechanics::Torque { play, .. } = &mut axis.mechanics else { panic!() };
    *play = 0.0;
    let record = excite(axis, permitted(&axis), |_| 0.0).record;
    assert_eq!(check_fit(&identify(&record).unwrap().model, &record), Ok(()));
}

/// The reason for the refusal: the gains of the whole inertia cause a lasting oscillation of a motor that turns alone
/// within its backlash.
#[test]
fn gains_of_a_model_without_play_would_swing() {
    let axis = with_play(3.0);
    let record = excite(axis, permitted(&axis), |_| 0.0).record;
    let wish = DesignSpec {
        law: Law::Proportional,
        velocity: Some(VelocityMethod::Filtered { time: 0.001 }),
        max_velocity: 45.0 * axis.encoder,
        max_acceleration: 100.0 * axis.encoder,
        inertia_ratio: 0.0,
        targets: Targets::default(),
    };
    let loops = design(&identify(&record).unwrap().model, &wish).unwrap().loops;
    let size = 0.02 * axis.encoder;
    let way = run(axis, &loops, 3.0, |time| if time < 0.1 { (0.0, 0.0, 0.0) } else { (size, 0.0, 0.0) });
    let late = way.iter().skip(2000).map(|(_, place)| *place);
    let (low, high) = late.fold((f64::MAX, f64::MIN), |(low, high), place| (low.min(place), high.max(place)));
    assert!(high - low > 20.0, "{low} {high}");
    assert!(figures(&way, size, 0.1, 16.0, axis.cycle).0 > 30.0);
}

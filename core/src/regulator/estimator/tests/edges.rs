//! Far positions, other coordinates, settings and states beyond their range.

use super::*;

fn method() -> impl Strategy<Value = VelocityMethod> {
    let decades = |low: f64, high: f64| (low..high).prop_map(libm::exp10);
    prop_oneof![
        Just(VelocityMethod::Difference),
        (0.0..1e3_f64).prop_map(|time| VelocityMethod::Filtered { time }),
        decades(-7.0, 3.0).prop_map(|time| VelocityMethod::Filtered { time }),
        decades(-3.0, 6.0).prop_map(|bandwidth| VelocityMethod::AlphaBeta { bandwidth }),
        decades(-4.5, 8.4)
            .prop_map(|acceleration| VelocityMethod::Kalman { model: MotionModel::ConstantVelocity { acceleration } }),
        decades(-1.5, 11.4)
            .prop_map(|jerk| VelocityMethod::Kalman { model: MotionModel::ConstantAcceleration { jerk } }),
    ]
}

proptest! {
    /// Identical bits, at any start of the coordinate.
    #[test]
    fn a_motion_is_the_same_everywhere(
        method in method(), from in -(1_i64 << 61)..1 << 61, far in any::<bool>(),
        changes in prop::collection::vec(-5000_i64..5000, 1..60),
    ) {
        let (mut here, mut there) = (estimator(method), estimator(method));
        let from = if far { Position::LIMIT - 1 } else { from };
        let (mut position, side) = (0, if far { -1 } else { 1 });
        for change in changes {
            // From the last legal position only backward.
            position += if far { change.abs() * side } else { change };
            prop_assert_eq!(here.step(position), there.step(from + position));
        }
    }

    #[test]
    fn a_shift_of_the_coordinate_moves_nothing(
        method in method(), by in -(1_i64 << 61)..1 << 61,
        before in prop::collection::vec(-5000_i64..5000, 0..30), behind in prop::collection::vec(-5000_i64..5000, 1..30),
    ) {
        let mut kept = estimator(method);
        before.iter().for_each(|position| _ = kept.step(*position));
        let mut shifted = kept;
        shifted.shift(by);
        prop_assert_eq!(kept.velocity(), shifted.velocity());
        for position in behind {
            prop_assert_eq!(kept.step(position), shifted.step(position + by));
        }
    }

    #[test]
    fn no_position_poisons_the_state(
        method in method(), positions in prop::collection::vec(prop_oneof![
            any::<i64>(), Just(i64::MIN), Just(i64::MAX), -10_i64..10,
        ], 1..80),
    ) {
        let mut estimator = estimator(method);
        prop_assert!(estimator.is_sound());
        for position in positions {
            prop_assert!(estimator.step(position).is_finite() && estimator.acceleration().is_finite());
            prop_assert!(estimator.is_sound(), "{estimator:?}");
        }
        let bytes = postcard::to_stdvec(&estimator).unwrap();
        prop_assert_eq!(postcard::from_bytes::<VelocityEstimator>(&bytes).unwrap(), estimator);
    }
}

/// The worst case of 64 bits for a filter with a pole near -1.
#[test]
fn ends_of_the_range_in_turn_stay_sound() {
    let most = VelocityMethod::Kalman { model: MotionModel::ConstantVelocity { acceleration: 2.88e8 } };
    for method in METHODS.into_iter().chain([most]) {
        let mut estimator = estimator(method);
        for k in 0..100_000 {
            estimator.step(if k % 2 == 0 { i64::MIN } else { i64::MAX });
        }
        assert!(estimator.is_sound(), "{estimator:?}");
    }
}

/// The largest difference of legal positions is 2^63 - 2; a difference beyond 64 bits keeps its sign.
#[test]
fn the_longest_way_keeps_its_sign() {
    let mut estimator = estimator(VelocityMethod::Difference);
    let far = Position::LIMIT - 1;
    estimator.step(-far);
    near(estimator.step(far) / 9.223_372_036_854_776e21, 1.0, 1e-15);
    estimator.step(i64::MIN);
    assert!(estimator.velocity() < 0.0 && estimator.step(i64::MAX) > 0.0);
}

#[test]
fn an_estimator_begins_at_rest_wherever_it_is() {
    for method in METHODS {
        let mut estimator = estimator(method);
        estimator.shift(50);
        assert_eq!((estimator.velocity(), estimator.step(1 << 61), estimator.step(1 << 61)), (0.0, 0.0, 0.0));
        estimator.step((1 << 61) + 500);
        assert!(estimator.velocity() > 0.0);
        estimator.restart();
        assert_eq!((estimator.velocity(), estimator.step(-7)), (0.0, 0.0));
        estimator.step(-9);
        assert!(estimator.velocity() < 0.0);
    }
}

/// Indices of 1000 inc and 1e-10 inc are 1000/(sqrt(12) 1e-6) and 1e-10/(sqrt(12) 1e-6) inc/s^2 at 1 ms.
#[test]
fn settings_beyond_their_range_are_refused() {
    let velocity = |acceleration| VelocityMethod::Kalman { model: MotionModel::ConstantVelocity { acceleration } };
    let acceleration = |jerk| VelocityMethod::Kalman { model: MotionModel::ConstantAcceleration { jerk } };
    let refused = [
        VelocityMethod::Filtered { time: -1e-9 },
        VelocityMethod::Filtered { time: 1001.0 },
        VelocityMethod::Filtered { time: f64::NAN },
        VelocityMethod::AlphaBeta { bandwidth: 0.0 },
        VelocityMethod::AlphaBeta { bandwidth: 1.1e6 },
        VelocityMethod::AlphaBeta { bandwidth: f64::INFINITY },
        velocity(0.0),
        velocity(2.8e-5),
        velocity(2.9e8),
        velocity(f64::NAN),
        acceleration(0.0),
        acceleration(2.8e-2),
        acceleration(2.9e11),
    ];
    for method in refused {
        let error = VelocityEstimator::new(method, MS).unwrap_err();
        assert!(matches!(error, EstimatorError::Range { .. }), "{method:?}: {error}");
    }
    for method in [velocity(2.9e-5), velocity(2.88e8), acceleration(2.9e-2), acceleration(2.88e11)] {
        assert!(VelocityEstimator::new(method, MS).is_ok(), "{method:?}");
    }
    for cycle in [0.0, -1e-3, 1.1, f64::NAN] {
        assert!(VelocityEstimator::new(VelocityMethod::Difference, cycle).is_err(), "{cycle}");
    }
    let error = VelocityEstimator::new(VelocityMethod::AlphaBeta { bandwidth: -4.0 }, MS).unwrap_err();
    assert_eq!(error.to_string(), "bandwidth is -4 rad/s; 0.001 to 1000000 rad/s is permitted");
}

#[test]
fn a_state_that_no_cycle_leaves_is_not_sound() {
    let sound = estimator(FILTERED);
    let bad = [
        Law::Difference(Difference { velocity: f64::NAN }),
        Law::Difference(Difference { velocity: f64::INFINITY }),
        Law::Filtered(Filtered { share: 0.0, velocity: 0.0 }),
        Law::Filtered(Filtered { share: 1.5, velocity: 0.0 }),
        Law::Filtered(Filtered { share: 0.5, velocity: -1e30 }),
    ];
    for law in bad {
        assert!(!VelocityEstimator { law, ..sound }.is_sound(), "{law:?}");
    }
    for (place, velocity, acceleration) in
        [(0.0, 0.1, 0.0), (1.1, 0.1, 0.0), (0.5, 3.1, 0.0), (0.5, 0.0, 0.0), (0.5, 0.1, 0.1), (0.5, f64::NAN, 0.0)]
    {
        let gains = Gains { place, velocity, acceleration };
        assert!(!VelocityEstimator { law: Law::Observer(gains, Track::default()), ..sound }.is_sound(), "{gains:?}");
    }
    let track = Track { velocity: f64::NAN, ..Track::default() };
    let gains = Gains { place: 0.5, velocity: 0.1, acceleration: 0.01 };
    assert!(VelocityEstimator { law: Law::Observer(gains, Track::default()), ..sound }.is_sound());
    assert!(!VelocityEstimator { law: Law::Observer(gains, track), ..sound }.is_sound());
    assert!(!VelocityEstimator { cycle: 0.0, ..sound }.is_sound());
}

use super::*;
use proptest::prelude::*;

fn limits(velocity: f64, acceleration: f64, deceleration: f64) -> Limits {
    Limits { velocity, acceleration, deceleration, shape: Shape::Trapezoid }
}

/// The defaults of the manual: VELMAX 1000 rpm, 2000 qc per turn, RAMPMIN 1000 ms, DFLTVEL 50, DFLTACC 50.
///
/// Proves: MACS-PROF-08, MACS-O-14
#[test]
fn posr_50000_takes_4000_ms_with_ramps_of_1000_ms() {
    let velocity = 1000.0 * 2000.0 / 60.0 * 0.5;
    let acceleration = 1000.0 * 2000.0 / 60.0 * 0.5;
    let plan = to_rest(Motion::default(), Position::whole(50_000), &limits(velocity, acceleration, acceleration), MS);
    assert_eq!(plan.cycles(), 4000);
    assert_eq!(plan.at(4000), Motion::at_rest(Position::whole(50_000)));
    assert_ne!(plan.at(3999).position, Position::whole(50_000));
    let cruise = plan.at(2000);
    assert!((cruise.velocity - 16_666.666_667).abs() < 1e-3);
    assert_eq!(cruise.acceleration, 0.0);
    assert!((plan.at(500).velocity - 8_333.333_333).abs() < 1e-3);
    assert!((plan.at(1000).position.to_f64() - 8_333.333_333).abs() < 1e-3);
}

/// Proves: MACS-PROF-08
#[test]
fn a_short_move_is_a_triangle() {
    // a = 1000: 250 inc up, 250 down: peak 707.1, 1.414 s.
    let plan = to_rest(Motion::default(), Position::whole(500), &limits(1e6, 1000.0, 1000.0), MS);
    assert!((plan.duration() - 2.0_f64.sqrt()).abs() < 1e-9);
    assert_eq!(plan.cycles(), 1415);
    let highest = (0..1415).map(|k| plan.at(k).velocity).fold(0.0, f64::max);
    assert!(highest < 707.2 && highest > 706.0);
}

#[test]
fn different_rates_up_and_down_meet() {
    // 100 inc/s in 0.1 s (5 inc), 90 inc at constant velocity in 0.9 s, down in 0.2 s over 10 inc.
    let plan = to_rest(Motion::default(), Position::whole(105), &limits(100.0, 1000.0, 500.0), MS);
    assert_eq!(plan.cycles(), 1200);
    assert_eq!(plan.at(1050).acceleration, -500.0);
}

#[test]
fn a_target_behind_the_stopping_point_is_passed_and_met_from_the_other_side() {
    // At 100 inc/s with 1000 inc/s^2 it stops after 5 inc.
    let plan = to_rest(moving(0.0, 100.0), Position::whole(2), &limits(100.0, 1000.0, 1000.0), MS);
    let (_, high) = plan.extent();
    assert_eq!(high, Position::whole(5));
    assert_eq!(plan.at(plan.cycles()), Motion::at_rest(Position::whole(2)));
}

#[test]
fn excess_start_velocity_decreases_to_the_limit_first() {
    let plan = to_rest(moving(0.0, 300.0), Position::whole(1000), &limits(100.0, 1000.0, 1000.0), MS);
    let mut last = 300.0;
    for k in 1..=plan.cycles() {
        let velocity = plan.at(k).velocity;
        assert!(velocity <= last + 1e-9, "cycle {k}");
        last = velocity;
    }
    assert_eq!(plan.at(plan.cycles()), Motion::at_rest(Position::whole(1000)));
}

#[test]
fn zero_distance_takes_no_time() {
    let plan = to_rest(moving(7.0, 0.0), Position::whole(7), &limits(1.0, 1.0, 1.0), MS);
    assert_eq!(plan.cycles(), 0);
    assert_eq!(plan.at(0), Motion::at_rest(Position::whole(7)));
}

#[test]
fn the_longest_way_lands_exactly() {
    let (start, end) = (-(1_i64 << 61), (1_i64 << 61) + 1);
    let plan = to_rest(Motion::at_rest(Position::whole(start)), Position::whole(end), &limits(1e12, 1e9, 1e9), MS);
    assert_eq!(plan.at(plan.cycles()).position, Position::whole(end));
    let before = plan.at(plan.cycles() - 1).position;
    assert!(before <= Position::whole(end) && Position::whole(end) - before < Position::whole(1000));
}

#[test]
fn a_velocity_change_of_sign_slows_down_with_the_deceleration() {
    let plan = to_velocity(moving(0.0, -100.0), 50.0, &limits(100.0, 500.0, 1000.0), MS);
    assert_eq!(plan.cycles(), 200);
    assert_eq!((plan.at(50).acceleration, plan.at(150).acceleration), (1000.0, 500.0));
    assert_eq!(plan.at(300).velocity, 50.0);
    assert_eq!(plan.at(300).position, plan.at(200).position + Position::whole(5));
}

#[test]
fn a_stop_takes_its_deceleration_and_ends_where_that_ends() {
    let plan = stop(moving(0.25, 100.0), &limits(1.0, 1.0, 1000.0), MS);
    assert_eq!((plan.end(), plan.cycles()), (Position::from_f64(5.25), 100));
    let back = stop(moving(0.25, -100.0), &limits(1.0, 1.0, 1000.0), MS);
    assert_eq!(back.end(), Position::from_f64(-4.75));
    assert_eq!(stop(moving(0.25, 0.0), &limits(1.0, 1.0, 1000.0), MS).cycles(), 0);
}

#[test]
fn a_stop_at_a_place_takes_the_deceleration_that_it_needs() {
    // 100 inc/s over 4 inc: 1250 inc/s^2, 80 ms.
    let plan = stop_at(moving(1.0, 100.0), Position::whole(5), MS);
    assert_eq!((plan.end(), plan.cycles()), (Position::whole(5), 80));
    assert!((plan.at(40).acceleration + 1250.0).abs() < 1e-6);
}

/// S/V + V/2a (1 + a/b): 1000 mm at 200 mm/s, 100 mm/s^2 up and 200 down: 2 s, 3.5 s, 1 s.
///
/// Proves: WF-TIM-02, WF-ORA-12
#[test]
fn the_positioning_time_is_that_of_its_formula() {
    let plan = to_rest(Motion::default(), Position::whole(1000), &limits(200.0, 100.0, 200.0), MS);
    assert_eq!(plan.cycles(), 6500);
    assert_eq!((plan.at(1999).acceleration, plan.at(3000).acceleration), (100.0, 0.0));
    assert_eq!((plan.at(5499).acceleration, plan.at(5501).acceleration), (0.0, -200.0));
}

/// sqrt(2 S/a (1 + a/b)) with a peak of sqrt(2 S a b / (a + b)): 150 mm, 100 and 200 mm/s^2: 2.1213 s, 141.42 mm/s.
///
/// Proves: WF-TIM-03
#[test]
fn short_distance_takes_the_time_of_its_formula() {
    let plan = to_rest(Motion::default(), Position::whole(150), &limits(200.0, 100.0, 200.0), MS);
    assert!((plan.duration() - 4.5_f64.sqrt()).abs() < 1e-9, "{}", plan.duration());
    let peak = (0..plan.cycles()).map(|k| plan.at(k).velocity).fold(0.0, f64::max);
    assert!((peak - 20_000.0_f64.sqrt()).abs() < 0.2, "{peak}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// In any state: the target is reached exactly, the limits are kept (or a velocity beyond them decreases), and the
    /// position changes by at most the velocity limit.
    ///
    /// Proves: MACS-PROF-08
    #[test]
    fn every_plan_keeps_its_limits_and_lands(
        start in -1e6..1e6_f64,
        velocity in prop_oneof![Just(0.0), -2e5..2e5_f64],
        target in -1_000_000_i64..1_000_000,
        top in 1e3..1e5_f64,
        up in 1e4..1e7_f64,
        down in 1e4..1e7_f64,
    ) {
        let plan = to_rest(moving(start, velocity), Position::whole(target), &limits(top, up, down), MS);
        prop_assert_eq!(plan.at(plan.cycles()), Motion::at_rest(Position::whole(target)));
        let mut before = plan.at(0);
        prop_assert_eq!(before.position, Position::from_f64(start));
        let step = plan.cycles() / 500 + 1;
        for k in (0..=plan.cycles()).step_by(step as usize) {
            let now = plan.at(k);
            let allowed = top.max(before.velocity.abs()) * (1.0 + 1e-12);
            prop_assert!(now.velocity.abs() <= allowed, "cycle {}: {} beyond {}", k, now.velocity, allowed);
            prop_assert!(now.acceleration.abs() <= up.max(down) * (1.0 + 1e-6));
            let way = (now.position - before.position).to_f64().abs();
            prop_assert!(way <= allowed * step as f64 * 1e-3 + 1e-3, "cycle {}: jump of {}", k, way);
            before = now;
        }
    }

    #[test]
    fn every_stop_decelerates_monotonically(start in -1e6..1e6_f64, velocity in -1e6..1e6_f64, down in 1e3..1e7_f64) {
        let plan = stop(moving(start, velocity), &limits(1.0, 1.0, down), MS);
        prop_assert_eq!(plan.at(plan.cycles()), Motion::at_rest(plan.end()));
        let mut last = velocity.abs();
        for k in 0..=plan.cycles().min(2000) {
            let now = plan.at(k);
            prop_assert!(now.velocity.abs() <= last * (1.0 + 1e-12), "cycle {}", k);
            prop_assert!(now.acceleration.abs() <= down * (1.0 + 1e-9));
            last = now.velocity.abs();
        }
    }
}

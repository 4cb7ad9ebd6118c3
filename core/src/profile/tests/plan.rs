use super::*;

fn trapezoid() -> Limits {
    Limits { velocity: 100.0, acceleration: 1000.0, deceleration: 1000.0, shape: Shape::Trapezoid }
}

/// 0.1 s to 100 inc/s over 5 inc; then 15 inc in 0.15 s.
#[test]
fn a_pass_goes_on_at_its_end_velocity() {
    let plan = to_pass(Motion::default(), Position::whole(20), 100.0, &trapezoid(), MS);
    assert_eq!((plan.cycles(), plan.end_velocity(), plan.end()), (250, 100.0, Position::whole(20)));
    let after = plan.at(350);
    assert_eq!((after.velocity, after.acceleration), (100.0, 0.0));
    assert!((after.position.to_f64() - 30.0).abs() < 1e-6);
}

/// 100 inc/s, then down to 50 inc/s in 0.05 s over 3.75 inc; 11.25 inc at constant velocity between them.
#[test]
fn a_pass_slows_down_before_its_target() {
    let plan = to_pass(Motion::default(), Position::whole(20), 50.0, &trapezoid(), MS);
    assert!((plan.duration() - 0.2625).abs() < 1e-9, "{}", plan.duration());
    assert_eq!(plan.at(240).acceleration, -1000.0);
    // It ended half a cycle before cycle 263: 0.025 inc.
    let end = plan.at(263);
    assert!((end.position.to_f64() - 20.025).abs() < 1e-6 && end.velocity == 50.0, "{end:?}");
    assert!((plan.overshoot(263) - 0.5e-3).abs() < 1e-9);
    assert_eq!(plan.overshoot(262), 0.0);
}

#[test]
fn a_pass_in_the_other_direction_comes_back() {
    // Over 20 inc to a stop at 25 inc, and back with a run-up of 5 inc.
    let plan = to_pass(Motion::default(), Position::whole(20), -100.0, &trapezoid(), MS);
    let (_, high) = plan.extent();
    assert_eq!(high, Position::whole(25));
    let end = plan.at(plan.cycles());
    assert_eq!(end.velocity, -100.0);
    assert!((end.position.to_f64() - (20.0 - 100.0 * plan.overshoot(plan.cycles()))).abs() < 1e-6);
}

/// A plan that began a third of a cycle earlier is evaluated a third of a cycle later.
#[test]
fn lead_shifts_the_sample() {
    let limits = jerk_limits(1000.0, 5000.0, 50_000.0);
    let plan = to_rest(Motion::default(), Position::whole(1000), &limits, MS);
    let finer = to_rest(Motion::default(), Position::whole(1000), &limits, MS / 4);
    let led = plan.with_lead(0.25e-3);
    for k in [0, 1, 50, 300, 900] {
        let (now, expected) = (led.at(k), finer.at(4 * k + 1));
        assert!(distance(now.position, expected.position).abs() < 1e-6, "cycle {k}: {now:?} {expected:?}");
        assert!((now.velocity - expected.velocity).abs() < 1e-6, "cycle {k}");
    }
    assert!((led.overshoot(2000) - plan.overshoot(2000) - 0.25e-3).abs() < 1e-12);
    assert_eq!(led.at(led.cycles()), Motion::at_rest(Position::whole(1000)));
    let exact = (plan.duration() - 0.25e-3) / 1e-3;
    assert_eq!(led.cycles(), exact.ceil() as u64);
}

#[test]
fn a_long_way_begins_and_ends_smoothly() {
    let target = Position::whole((1 << 62) - 1);
    for limits in [trapezoid(), jerk_limits(100.0, 1000.0, 1e4), Limits { shape: Shape::SRamp, ..trapezoid() }] {
        let plan = to_rest(Motion::default(), target, &limits, MS);
        let mut before = plan.at(0);
        for k in 1..2000 {
            let now = plan.at(k);
            let error = distance(before.position, now.position) - 0.5 * (before.velocity + now.velocity) * 1e-3;
            assert!(error.abs() < 1e-3, "cycle {k}: {error}");
            before = now;
        }
        assert_eq!(plan.at(plan.cycles()), Motion::at_rest(target));
    }
}

/// A plan from outside may contain any values.
#[test]
fn invalid_plan_does_not_panic() {
    let plan = to_rest(moving(0.0, -50.0), Position::whole(100), &jerk_limits(100.0, 400.0, 4000.0), MS);
    let bytes = postcard::to_stdvec(&plan).expect("a plan can be written");
    let same: Plan = postcard::from_bytes(&bytes).expect("a plan can be read");
    assert!((0..plan.cycles()).all(|k| same.at(k) == plan.at(k)) && same.is_sound());
    let mut refused = 0;
    for place in 0..bytes.len() {
        for value in [0, 1, 0x7F, 0x80, 0xF8, 0xFF] {
            let mut bad = bytes.clone();
            bad[place] = value;
            let Ok(plan) = postcard::from_bytes::<Plan>(&bad) else { continue };
            refused += usize::from(!plan.is_sound());
            for elapsed in [0, 1, 100, plan.cycles(), u64::MAX] {
                let now = plan.at(elapsed).position;
                let _ = (plan.overshoot(elapsed), plan.extent_from(now), plan.with_lead(f64::NAN).at(elapsed));
            }
        }
    }
    assert!(refused > 0);
}

/// A plan that is already at its target, turns back and passes it: a reversal behind its start is still ahead.
#[test]
fn extent_covers_the_rest_of_a_plan_that_turns_twice() {
    let jerks = Jerks { rise: 1e6, fall: 1e6, brake_rise: 1e7, brake_fall: 1e6 };
    let limits = Limits { velocity: 1e5, acceleration: 1e6, deceleration: 5e5, shape: Shape::Jerk(jerks) };
    let start = Motion { velocity: 17_825.55, acceleration: -188_815.0, ..Motion::default() };
    let plan = to_pass(start, Position::whole(1122), 5_000.0, &limits, MS);
    let velocities: Vec<f64> = (0..plan.cycles()).map(|k| plan.at(k).velocity).collect();
    let turns = velocities.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count();
    assert_eq!(turns, 2, "it should turn twice");
    let lowest_of_turns = (300..plan.cycles()).map(|k| plan.at(k).position).min().expect("a cycle");
    assert!(lowest_of_turns > Position::ZERO, "it turns above its start: {lowest_of_turns:?}");
    let (mut low, mut high) = (plan.end(), plan.end());
    let rounding = Position::from_f64(1e-6);
    for k in (0..plan.cycles()).rev() {
        let now = plan.at(k).position;
        (low, high) = (low.min(now), high.max(now));
        let (least, most) = plan.extent_from(now);
        assert!(
            least <= low + rounding && most >= high - rounding,
            "cycle {k}: {low:?} {high:?} of {least:?} {most:?}"
        );
    }
}

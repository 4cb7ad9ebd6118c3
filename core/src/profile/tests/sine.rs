use super::*;
use std::f64::consts::PI;

fn limits(velocity: f64, acceleration: f64, deceleration: f64) -> Limits {
    Limits { velocity, acceleration, deceleration, shape: Shape::SRamp }
}

/// VELMAX 1000 rpm, 2000 qc per turn, RAMPMIN 1000 ms: 0 to 33.3333 qc/ms in 1570.80 ms over 26179.9 qc.
///
/// Proves: MACS-PROF-09, MACS-O-16
#[test]
fn an_s_ramp_takes_half_of_pi_times_the_time_of_the_trapezoid() {
    let top = 1000.0 * 2000.0 / 60.0;
    let plan = to_velocity(Motion::default(), top, &limits(top, top, top), MS);
    assert!((plan.duration() * 1e3 - 1570.80).abs() < 0.01, "{}", plan.duration());
    assert!((plan.end().to_f64() - 26_179.9).abs() < 0.1, "{:?}", plan.end());
    assert_eq!(plan.cycles(), 1571);
    let end = PI / 2.0;
    for k in [1, 400, 785, 1200, 1570] {
        let (now, time) = (plan.at(k), k as f64 * 1e-3);
        let velocity = top * (1.0 - libm::cos(PI * time / end)) / 2.0;
        assert!((now.velocity - velocity).abs() < 1e-6, "cycle {k}: {now:?}");
        assert!((now.acceleration - top * libm::sin(PI * time / end)).abs() < 1e-6, "cycle {k}: {now:?}");
    }
}

/// 100 inc/s with 50 pi inc/s^2 up and 25 pi down: 1 s over 50 inc, 2 s over 100 inc; 50 inc at constant velocity in
/// 0.5 s.
#[test]
fn a_move_has_two_s_ramps_and_a_cruise() {
    let plan = to_rest(Motion::default(), Position::whole(200), &limits(100.0, 50.0 * PI, 25.0 * PI), MS);
    assert_eq!(plan.cycles(), 3500);
    assert_eq!(plan.at(3500), Motion::at_rest(Position::whole(200)));
    assert!((plan.at(1000).position.to_f64() - 50.0).abs() < 1e-6);
    assert!((plan.at(1500).position.to_f64() - 100.0).abs() < 1e-6);
    assert!((plan.at(500).acceleration - 50.0 * PI).abs() < 1e-6);
    assert!((plan.at(2500).acceleration + 25.0 * PI).abs() < 1e-6);
}

/// w = 2 A / V = 2/s: the acceleration of 50 inc/s^2 adds 25 inc/s.
#[test]
fn an_acceleration_at_the_start_ends_along_a_quarter_of_a_wave() {
    let start = Motion { velocity: 20.0, acceleration: 50.0, ..Motion::default() };
    let plan = to_velocity(start, 45.0, &limits(100.0, 100.0, 100.0), MS);
    assert!((plan.duration() - PI / 4.0).abs() < 1e-9, "{}", plan.duration());
    let at = |k: u64| plan.at(k).acceleration - 50.0 * libm::cos(2.0 * k as f64 * 1e-3);
    assert!([0, 1, 300, 700].iter().all(|k| at(*k).abs() < 1e-6));
    assert!((plan.at(785).velocity - 45.0).abs() < 1e-3);
}

#[test]
fn an_s_ramp_that_brakes_does_not_pass_zero_because_it_is_relieved() {
    let start = Motion { velocity: 1.0, acceleration: -50.0, ..Motion::default() };
    let plan = stop(start, &limits(100.0, 100.0, 100.0), MS);
    let mut last = 1.0;
    for k in 0..=plan.cycles() {
        let velocity = plan.at(k).velocity;
        assert!((0.0..=last).contains(&velocity), "cycle {k}: {velocity}");
        last = velocity;
    }
}

use super::*;

/// VELMAX 3000 rpm, 2000 qc per turn, RAMPMIN 500 ms, JERKMIN 200 ms: 100 qc/ms, 0.2 qc/ms^2, 0.001 qc/ms^3
/// (MACS-O-10).
fn manual() -> Limits {
    jerk_limits(100e3, 0.2e6, 0.001e9)
}

/// 200 ms of rise, 300 ms of hold, 200 ms of fall.
///
/// Proves: MACS-PROF-10, MACS-PROF-12, MACS-O-11
#[test]
fn a_full_jerk_ramp_takes_700_ms_and_35000_qc() {
    let plan = to_velocity(Motion::default(), 100e3, &manual(), MS);
    assert_eq!(plan.cycles(), 700);
    assert_eq!(plan.end(), Position::whole(35_000));
    let acceleration = |k| plan.at(k).acceleration;
    assert!((acceleration(100) - 0.1e6).abs() < 1e-6 && (acceleration(600) - 0.1e6).abs() < 1e-6);
    assert_eq!((acceleration(201), acceleration(499)), (0.2e6, 0.2e6));
    assert_eq!((plan.at(100).jerk, plan.at(300).jerk, plan.at(600).jerk), (1e6, 0.0, -1e6));
}

/// Proves: MACS-PROF-12, MACS-O-13
#[test]
fn a_short_jerk_step_peaks_at_half_the_acceleration() {
    let plan = to_velocity(Motion::default(), 10e3, &manual(), MS);
    assert_eq!(plan.cycles(), 200);
    assert_eq!(plan.end(), Position::whole(1000));
    assert!((plan.at(100).acceleration - 0.1e6).abs() < 1e-6);
}

/// Returns the time of a move from rest to rest (s).
fn time(way: i64, velocity: f64, acceleration: f64, jerk: f64) -> f64 {
    to_rest(Motion::default(), Position::whole(way), &jerk_limits(velocity, acceleration, jerk), MS).duration()
}

/// S/V + V/a + a/r: 1000/100 + 100/200 + 200/1000.
///
/// Proves: WF-TIM-04
#[test]
fn a_long_move_reaches_speed_and_acceleration() {
    assert!((time(1000, 100.0, 200.0, 1000.0) - 10.7).abs() < 1e-9);
}

/// a/r + sqrt(a^2/r^2 + 4 S/a): 0.1 + sqrt(0.01 + 0.2).
///
/// Proves: WF-TIM-05
#[test]
fn a_move_reaches_its_acceleration_but_not_its_speed() {
    assert!((time(10, 1e4, 200.0, 2000.0) - 0.558_257_569_495_584).abs() < 1e-9);
}

/// cbrt(32 S/r): S = 2, r = 1000 gives 0.4 s. At S = 2 a^3/r^2 both formulas are equal: a = 100 here.
///
/// Proves: WF-TIM-06, WF-TIM-07
#[test]
fn a_short_move_is_pure_jerk() {
    assert!((time(2, 1e4, 200.0, 1000.0) - 0.4).abs() < 1e-9);
    assert!((time(2, 1e4, 100.0, 1000.0) - 0.4).abs() < 1e-9);
    assert!(time(2, 1e4, 99.0, 1000.0) > 0.4 + 1e-6);
}

/// V < a^2/r: S/V + 2 sqrt(V/r): 100/10 + 2 sqrt(10/1000).
///
/// Proves: WF-TIM-07
#[test]
fn a_slow_move_reaches_its_speed_but_not_its_acceleration() {
    assert!((time(100, 10.0, 200.0, 1000.0) - 10.2).abs() < 1e-9);
}

/// 0.2 s of acceleration (rise 0.1 s, fall 0.1 s) and 0.2 s of deceleration, each over 10 inc/s * 0.1 s.
#[test]
fn at_double_jerk_a_fall_takes_half_its_time() {
    let jerks = Jerks { rise: 1000.0, fall: 2000.0, brake_rise: 500.0, brake_fall: 1000.0 };
    let limits = Limits { velocity: 15.0, acceleration: 100.0, deceleration: 50.0, shape: Shape::Jerk(jerks) };
    let plan = to_velocity(Motion::default(), 15.0, &limits, MS);
    // Rise to 100 in 0.1 s (5 inc/s), hold 0.075 s (7.5 inc/s), fall in 0.05 s (2.5 inc/s).
    assert_eq!(plan.cycles(), 225);
    assert_eq!((plan.at(50).jerk, plan.at(120).jerk, plan.at(200).jerk), (1000.0, 0.0, -2000.0));
    // Rise to 50 in 0.1 s (2.5 inc/s), hold 0.225 s (11.25 inc/s), fall in 0.05 s (1.25 inc/s).
    let stop = stop(moving(0.0, 15.0), &limits, MS);
    assert_eq!(stop.cycles(), 375);
    assert_eq!((stop.at(50).jerk, stop.at(200).jerk, stop.at(350).jerk), (-500.0, 0.0, 1000.0));
}

#[test]
fn with_other_rates_for_braking_a_plan_turns_at_rest() {
    let jerks = Jerks { rise: 1000.0, fall: 1000.0, brake_rise: 4000.0, brake_fall: 4000.0 };
    let limits = Limits { velocity: 100.0, acceleration: 100.0, deceleration: 400.0, shape: Shape::Jerk(jerks) };
    let plan = to_rest(moving(0.0, -50.0), Position::whole(100), &limits, MS);
    let turn = (0..plan.cycles()).find(|k| plan.at(*k).velocity >= 0.0).expect("a turn");
    assert!(plan.at(turn).acceleration.abs() <= 4.0, "{:?}", plan.at(turn));
    // A deceleration of 400 inc/s^2 stops within 50^2 / 800 inc plus a small distance for the jerk.
    let (low, high) = plan.extent();
    assert!(low > Position::whole(-6) && low < Position::whole(-3), "{low:?}");
    assert_eq!(high, Position::whole(100));
}

#[test]
fn with_even_rates_a_plan_turns_without_a_stop() {
    let limits = jerk_limits(100.0, 400.0, 4000.0);
    let plan = to_rest(moving(0.0, -50.0), Position::whole(100), &limits, MS);
    let turn = (0..plan.cycles()).find(|k| plan.at(*k).velocity >= 0.0).expect("a turn");
    assert_eq!(plan.at(turn).acceleration, 400.0);
    let lowest = (0..plan.cycles()).map(|k| plan.at(k).position).min().expect("a cycle");
    let (low, _) = plan.extent();
    assert!(low <= lowest && lowest - low < Position::from_f64(1e-3), "{low:?} {lowest:?}");
}

/// From above, the velocity decreases to a reduced limit, and not below it.
#[test]
fn velocity_above_a_lowered_limit_decreases_to_it() {
    let start = Motion { velocity: 200.0, acceleration: -10.0, ..Motion::default() };
    let plan = to_rest(start, Position::whole(10_000), &jerk_limits(100.0, 400.0, 4000.0), MS);
    let mut last = 200.0;
    for k in 1..=1000 {
        let velocity = plan.at(k).velocity;
        assert!(velocity <= last && velocity >= 100.0 - 1e-9, "cycle {k}: {velocity}");
        last = velocity;
    }
    assert!((last - 100.0).abs() < 1e-9);
}

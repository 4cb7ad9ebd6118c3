use super::*;
use proptest::prelude::*;

const S: u64 = 1_000_000_000;

fn knot(position: i64, velocity: Option<f64>, acceleration: Option<f64>) -> Knot {
    Knot { position: Position::whole(position), velocity, acceleration }
}

fn at(ns: u64) -> Moment {
    Moment { ns, fraction: 0.0 }
}

fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-9 * (1.0 + expected.abs()), "{found} instead of {expected}");
}

/// 1000 inc in 2 s: 500 inc/s.
#[test]
fn positions_alone_make_a_straight_line() {
    let spline = Spline::new(&knot(100, None, Some(3.0)), &knot(1100, Some(7.0), Some(1.0)), 2 * S);
    let motion = spline.at(0.5e9);
    assert_eq!((motion.position, motion.velocity, motion.acceleration), (Position::whole(350), 500.0, 0.0));
    let reach = spline.reach();
    assert_eq!((reach.low, reach.high), (Position::whole(100), Position::whole(1100)));
    close(reach.fastest, 500.0);
    assert_eq!((reach.slowest, reach.acceleration, reach.deceleration), (0.0, 0.0, 0.0));
}

/// From rest to rest over L in T: x = L (3 u^2 - 2 u^3), at most 1.5 L / T and 6 L / T^2.
#[test]
fn velocities_make_a_cubic() {
    let spline = Spline::new(&knot(0, Some(0.0), None), &knot(1000, Some(0.0), Some(5.0)), 2 * S);
    let quarter = spline.at(0.5e9);
    close(quarter.position.to_f64(), 1000.0 * (3.0 / 16.0 - 2.0 / 64.0));
    close(quarter.velocity, 1000.0 / 2.0 * (6.0 / 4.0 - 6.0 / 16.0));
    close(quarter.acceleration, 1000.0 / 4.0 * (6.0 - 3.0));
    let reach = spline.reach();
    close(reach.fastest, 750.0);
    close(reach.acceleration, 1500.0);
    close(reach.deceleration, 1500.0);
    assert_eq!(spline.at(2e9), Motion::at_rest(Position::whole(1000)));
}

/// From rest to rest over L in T: x = L (10 u^3 - 15 u^4 + 6 u^5), at most 1.875 L / T and 10 / sqrt(3) L / T^2.
#[test]
fn accelerations_make_a_quintic() {
    let spline = Spline::new(&knot(0, Some(0.0), Some(0.0)), &knot(-1000, Some(0.0), Some(0.0)), S);
    close(spline.at(0.5e9).position.to_f64(), -500.0);
    let reach = spline.reach();
    close(reach.slowest, -1875.0);
    close(reach.fastest, 0.0);
    close(reach.acceleration, 10_000.0 / 3_f64.sqrt());
    close(reach.deceleration, 10_000.0 / 3_f64.sqrt());
    assert_eq!((reach.low, reach.high), (Position::whole(-1000), Position::ZERO));
}

/// Back to the same position from 400 inc/s to -400 inc/s in 1 s: x = 400 (u - u^2), 100 inc away at half time.
#[test]
fn a_turn_between_two_knots_counts() {
    let spline = Spline::new(&knot(0, Some(400.0), None), &knot(0, Some(-400.0), None), S);
    let reach = spline.reach();
    close(reach.high.to_f64(), 100.0);
    assert_eq!(reach.low, Position::ZERO);
    close(reach.deceleration, 800.0);
    close(reach.acceleration, 800.0);
}

/// 2^-32 inc in 1 us: 6 L / T^2 = 1397 inc/s^2, and all of it may be the rounding of a position.
#[test]
fn what_rounding_to_a_fraction_may_add_is_no_acceleration() {
    let from = knot(0, Some(0.0), Some(0.0));
    for acceleration in [None, Some(0.0)] {
        let to = Knot { position: Position::from_raw(1), velocity: Some(0.0), acceleration };
        let reach = Spline::new(&from, &to, 1_000).reach();
        assert_eq!((reach.fastest, reach.acceleration, reach.deceleration), (0.0, 0.0, 0.0), "{acceleration:?}");
    }
    // Ten times this distance is a motion.
    let to = Knot { position: Position::from_raw(10), ..from };
    close(
        Spline::new(&knot(0, Some(0.0), None), &to, 1_000).reach().acceleration,
        9.0 * 6.0 / (1_u64 << 32) as f64 * 1e12,
    );
}

/// A constant velocity whose coefficients in f64 do not add up to zero.
#[test]
fn rounding_of_f64_is_no_acceleration() {
    for (velocity, ms) in [(1e9 / 3.0, 700), (-1e9 / 7.0, 1_100), (1e9 / 11.0, 130)] {
        let end = Position::from_f64(velocity * ms as f64 / 1e3);
        for acceleration in [None, Some(0.0)] {
            let at = |position| Knot { position, velocity: Some(velocity), acceleration };
            let reach = Spline::new(&at(Position::ZERO), &at(end), ms * 1_000_000).reach();
            assert_eq!((reach.acceleration, reach.deceleration), (0.0, 0.0), "{velocity} {ms} {acceleration:?}");
        }
    }
}

fn track(knots: Vec<Knot>) -> Track {
    Track { knots: knots.into(), ..Track::default() }
}

fn trajectory(times: &[u64], knots: Vec<Knot>) -> Option<Trajectory> {
    Trajectory::new(0, times.into(), Box::new([track(knots)]), None)
}

#[test]
fn invalid_points_are_no_trajectory() {
    let one = || knot(1, None, None);
    assert!(trajectory(&[0, 1], vec![one(), one()]).is_some());
    assert!(trajectory(&[], vec![]).is_none());
    assert!(trajectory(&[1, 1], vec![one(), one()]).is_none());
    assert!(trajectory(&[1, 2], vec![one()]).is_none());
    assert!(trajectory(&[1], vec![knot(1 << 62, None, None)]).is_none());
    assert!(trajectory(&[1, 2], vec![knot(1, Some(f64::NAN), None), one()]).is_none());
    assert!(trajectory(&[u64::MAX], vec![one()]).is_none());
    let tracks = [track(vec![one()]), track(vec![one()])];
    assert!(Trajectory::new(0, Box::new([1]), tracks.into(), None).is_none(), "an axis twice");
}

#[test]
fn points_that_are_past_are_passed_over() {
    let knots = vec![knot(1000, None, None), knot(2000, None, None), knot(4000, None, None)];
    let all = trajectory(&[S, 2 * S, 3 * S], knots).unwrap();
    let begin = Begin { motion: Motion::at_rest(Position::whole(3000)), time_ns: 2 * S, shift: Position::ZERO };
    // From 3000 at 2 s to 4000 at 3 s.
    assert_eq!(all.sample(0, &begin, at(2 * S)).position, Position::whole(3000));
    assert_eq!(all.sample(0, &begin, at(5 * S / 2)).position, Position::whole(3500));
    assert_eq!(all.sample(0, &begin, at(7 * S)), Motion::at_rest(Position::whole(4000)));
    let early = Begin { motion: Motion::at_rest(Position::ZERO), time_ns: 0, shift: Position::ZERO };
    assert_eq!(all.sample(0, &early, at(S / 2)).position, Position::whole(500));
    assert_eq!(all.sample(0, &early, at(3 * S / 2)).position, Position::whole(1500));
    assert_eq!(all.end(0, Position::ZERO), Some(Position::whole(4000)));
}

/// It began 1.5 s ago: point 0 is in the past, only point 1 is in the future.
#[test]
fn peaks_of_a_trajectory_that_began_in_the_past_are_ahead() {
    let knots = vec![knot(9000, None, None), knot(2000, None, None)];
    let all = trajectory(&[S, 2 * S], knots).unwrap().starting(-1_500_000_000);
    assert_eq!(all.demand(0).map(|demand| (demand.highest, demand.peaks)), Some((Position::whole(2000), Peaks::at(1))));
}

fn rate() -> impl Strategy<Value = Option<f64>> {
    prop::option::of(-5e4..5e4_f64)
}

fn any_knot() -> impl Strategy<Value = Knot> {
    (-100_000_i64..100_000, rate(), rate())
        .prop_map(|(position, velocity, acceleration)| knot(position, velocity, acceleration))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    /// Both ends have their values, if both have the same ones, and no value in between is outside the range.
    #[test]
    fn a_spline_meets_its_ends_and_keeps_its_reach(from in any_knot(), to in any_knot(), ms in 1_u64..5000) {
        let duration = ms * 1_000_000;
        let (spline, s) = (Spline::new(&from, &to, duration), ms as f64 / 1e3);
        let way = (to.position - from.position).to_f64().abs();
        let size = way + from.velocity.unwrap_or(0.0).abs() * s + from.acceleration.unwrap_or(0.0).abs() * s * s
            + to.velocity.unwrap_or(0.0).abs() * s + to.acceleration.unwrap_or(0.0).abs() * s * s;
        let near = |found: f64, expected: f64, scale: f64| (found - expected).abs() <= 1e-6 * (1.0 + size) / scale;
        let (first, last) = (spline.at(0.0), spline.at((duration - 1) as f64));
        prop_assert_eq!(first.position, from.position);
        prop_assert!(near((last.position - to.position).to_f64(), 0.0, s.min(1.0)));
        if let (Some(v0), Some(v1)) = (from.velocity, to.velocity) {
            prop_assert!(near(first.velocity, v0, s));
            prop_assert!(near(last.velocity, v1, s * s * s.min(1.0)));
            if let (Some(a0), Some(a1)) = (from.acceleration, to.acceleration) {
                prop_assert!(near(first.acceleration, a0, s * s));
                prop_assert!(near(last.acceleration, a1, s * s * s * s.min(1.0)));
            }
        }
        let reach = spline.reach();
        for step in 0..200 {
            let motion = spline.at((duration / 200 * step) as f64);
            let grid = Position::from_f64(1e-9 * (1.0 + size));
            prop_assert!(motion.position >= reach.low - grid && motion.position <= reach.high + grid);
            let slack = 1e-9 * (1.0 + size) / s;
            prop_assert!(motion.velocity >= reach.slowest - slack && motion.velocity <= reach.fastest + slack);
            let most = if motion.velocity * motion.acceleration >= 0.0 { reach.acceleration } else { reach.deceleration };
            let at_rest = motion.velocity.abs() <= 1e-6 * (1.0 + size) / s;
            let most = if at_rest { reach.acceleration.max(reach.deceleration) } else { most };
            prop_assert!(motion.acceleration.abs() <= most + 1e-9 * (1.0 + size) / (s * s));
        }
    }
}

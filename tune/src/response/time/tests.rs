use super::*;
use crate::loops::Inner;
use lineshaft_core::regulator::{PidGains, VelocityGains, VelocityMethod};

fn pid(proportional: i64, derivative: i64) -> Loops {
    let gains = PidGains { proportional, derivative, bandwidth: 1000, period_ms: 1, ..PidGains::default() };
    let position = PositionLaw::Pid { gains, cycles: 1 };
    Loops { position, velocity: None, max_velocity: 1e5, max_acceleration: 1e6 }
}

fn effort(coulomb: f64, load: f64) -> Model {
    let dynamics = Dynamics::Effort { acceleration: 1e6, viscous: 2.0, coulomb, load, resonance: None };
    Model { cycle: 1e-3, delay: 0.0, dynamics }
}

#[test]
fn a_trapezoid_is_the_integral_of_its_velocity() {
    for (distance, velocity) in [(1000.0, 2000.0), (-1000.0, 2000.0), (100.0, 2000.0)] {
        let to = Move::Trapezoid { distance, velocity, acceleration: 10_000.0 };
        let (mut place, h) = (0.0, 1e-5);
        let steps = (to.duration() / h) as u32 + 10;
        for k in 0..steps {
            let time = f64::from(k) * h;
            let (command, now, _) = to.at(time);
            assert!((command - place).abs() < 0.2, "{time}: {command} {place}");
            assert!(now.abs() <= velocity * (1.0 + 1e-9));
            place += 0.5 * h * (now + to.at(time + h).1);
        }
        assert_eq!(to.at(to.duration() + 1.0), (distance, 0.0, 0.0));
    }
}

/// 1000 inc at 1000 inc/s and 10000 inc/s^2 take 0.1 s of acceleration, 0.9 s at speed and 0.1 s of deceleration.
#[test]
fn a_trapezoid_takes_its_time() {
    let to = Move::Trapezoid { distance: 1000.0, velocity: 1000.0, acceleration: 10_000.0 };
    assert!((to.duration() - 1.1).abs() < 1e-12);
    let short = Move::Trapezoid { distance: 100.0, velocity: 2000.0, acceleration: 10_000.0 };
    assert!((short.duration() - 0.2).abs() < 1e-12, "{}", short.duration());
}

/// A velocity drive with kv: the error of a step decreases by the factor 1 - kv T in each cycle.
#[test]
fn an_integrator_closes_its_error_as_the_power_of_its_pole() {
    let model =
        Model { cycle: 1e-3, delay: 0.0, dynamics: Dynamics::Velocity { gain: 1e6, time_constant: 0.0, offset: 0.0 } };
    let position = PositionLaw::Proportional { kv: 20.0 };
    let loops = Loops { position, velocity: None, max_velocity: 1e6, max_acceleration: 1e6 };
    let trace = simulate(&model, &loops, &Move::Step { distance: 20_000.0 }, 0.2, 500.0).unwrap();
    let mut left = 20_000.0;
    for sample in &trace.samples {
        // Positions are counted in whole increments.
        assert!((20_000.0 - sample.position - left).abs() < 1.0, "{}: {}", sample.time, sample.position);
        left *= 0.98;
    }
    assert_eq!(trace.figures.overshoot, 0.0);
    // 10 % and 90 % are left after ln 0.9 / ln 0.98 = 5.2 and ln 0.1 / ln 0.98 = 113.97 cycles; 500 inc after 182.6.
    assert!((trace.figures.rise.unwrap() - 0.108).abs() < 1e-9, "{:?}", trace.figures);
    assert!((trace.figures.settling.unwrap() - 0.183).abs() < 1e-9, "{:?}", trace.figures);
    assert_eq!(trace.figures.following_error, 20_000.0);
}

#[test]
fn axis_held_by_friction_rests() {
    // An output of 30 * 100 / 60000 = 0.05 is 50000 inc/s^2.
    let still = simulate(&effort(60_000.0, 0.0), &pid(30, 0), &Move::Step { distance: 100.0 }, 1.0, 1.0).unwrap();
    assert!(still.samples.iter().all(|sample| sample.position == 0.0));
    assert_eq!((still.figures.rise, still.figures.settling), (None, None));
    let moves = simulate(&effort(40_000.0, 0.0), &pid(30, 0), &Move::Step { distance: 100.0 }, 1.0, 1.0).unwrap();
    assert!(moves.samples.iter().any(|sample| sample.position > 1.0));
}

/// Without friction a load sinks until the loop holds it: 10000 / 1e6 of the output are 600/30 inc.
#[test]
fn a_load_sinks_by_what_holds_it() {
    let trace = simulate(&effort(0.0, 10_000.0), &pid(30, 3000), &Move::Step { distance: 1e-3 }, 5.0, 1.0).unwrap();
    let last = trace.samples[trace.samples.len() - 1].position;
    assert!((last + 20.0).abs() < 1.0, "{last}");
}

/// A move in the opposite direction is the mirror image, apart from the last half increment of its counts.
#[test]
fn a_move_back_mirrors_the_move() {
    let gains = VelocityGains { proportional: 500, integral: 10, limit: 1000, cycle: 1.0 };
    let velocity = Some(Inner { gains, method: VelocityMethod::Difference });
    let position = PositionLaw::Proportional { kv: 10.0 };
    let loops = Loops { position, velocity, max_velocity: 1e5, max_acceleration: 1e6 };
    let to = |distance| Move::Trapezoid { distance, velocity: 5e4, acceleration: 2e5 };
    let run = |distance| simulate(&effort(20_000.0, 0.0), &loops, &to(distance), 1.0, 5.0).unwrap();
    let (there, back) = (run(10_000.0), run(-10_000.0));
    for (a, b) in there.samples.iter().zip(&back.samples) {
        assert!((a.position + b.position).abs() < 1e-6, "{}", a.time);
    }
    assert!((there.figures.following_error - back.figures.following_error).abs() < 1e-6);
}

#[test]
fn invalid_moves_are_refused() {
    let said = |to: Move, duration, window| {
        simulate(&effort(0.0, 0.0), &pid(30, 0), &to, duration, window).unwrap_err().to_string()
    };
    let step = Move::Step { distance: 1.0 };
    assert!(said(Move::Step { distance: 0.0 }, 1.0, 1.0).starts_with("distance is 0 inc; "));
    assert!(said(step, f64::NAN, 1.0).starts_with("duration is NaN s; "));
    assert!(said(step, 1.0, -1.0).starts_with("window is -1 inc; "));
    let slow = Move::Trapezoid { distance: 1.0, velocity: 0.0, acceleration: 1.0 };
    assert!(said(slow, 1.0, 1.0).starts_with("velocity is 0 inc/s; "));
}

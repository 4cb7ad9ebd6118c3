use super::*;

mod jerk;
mod laws;
mod plan;
mod ruckig;
mod sine;
mod trapezoid;

/// Cycle time of one millisecond (ns).
const MS: u64 = 1_000_000;

fn moving(position: f64, velocity: f64) -> Motion {
    Motion { position: Position::from_f64(position), velocity, ..Motion::default() }
}

fn jerk_limits(velocity: f64, acceleration: f64, jerk: f64) -> Limits {
    let jerks = Jerks { rise: jerk, fall: jerk, brake_rise: jerk, brake_fall: jerk };
    Limits { velocity, acceleration, deceleration: acceleration, shape: Shape::Jerk(jerks) }
}

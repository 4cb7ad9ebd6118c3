//! Axes with known properties, for tests.

use super::Subject;
use lineshaft_core::regulator::{PidGains, VelocityGains, VelocityMethod};
use lineshaft_tune::{
    DesignSpec, Excitation, ExcitationOutput, Inner, Law, Loops, Permitted, PositionLaw, Record, Takes, Targets,
};

/// Increments per revolution.
const TURN: f64 = 2000.0;

pub(super) fn subject() -> Subject {
    Subject {
        axis: "x".to_owned(),
        unit: "rev".to_owned(),
        increments: TURN,
        window: 4.0,
        velocity: 10.0 * TURN,
        acceleration: 200.0 * TURN,
    }
}

/// Returns the requirements of a PID controller at 1 ms.
pub(super) fn wish() -> DesignSpec {
    DesignSpec {
        law: Law::Pid { timer: 1 },
        velocity: None,
        max_velocity: 95_493.0,
        max_acceleration: 400.0 * TURN,
        inertia_ratio: 0.0,
        targets: Targets::default(),
    }
}

/// Returns the gains of a new controller.
pub(super) fn before() -> Loops {
    let gains = PidGains { proportional: 30, limit: 1000, bandwidth: 1000, period_ms: 1, ..PidGains::default() };
    let position = PositionLaw::Pid { gains, cycles: 1 };
    Loops { position, velocity: None, max_velocity: 95_493.0, max_acceleration: 400.0 * TURN }
}

/// Returns kv and a velocity loop, for a drive with effort interface.
pub(super) fn cascade() -> (DesignSpec, Loops) {
    let method = VelocityMethod::Filtered { time: 0.001 };
    let wish = DesignSpec { law: Law::Proportional, velocity: Some(method), max_velocity: 45.0 * TURN, ..wish() };
    let gains = VelocityGains { proportional: 200, integral: 5, limit: 1000, cycle: 1.0 };
    let position = PositionLaw::Proportional { kv: 1000.0 / 60.0 };
    let loops =
        Loops { position, velocity: Some(Inner { gains, method }), max_velocity: wish.max_velocity, ..before() };
    (wish, loops)
}

fn permitted(takes: Takes) -> Permitted {
    Permitted {
        cycle: 1e-3,
        takes,
        travel: 2.0 * TURN,
        margin: TURN,
        velocity: 5.0 * TURN,
        command: 0.5,
        ramp: 1.0,
        duration: 4.0,
        seed: 1,
    }
}

/// Excites a plant that `step` advances by a part of a cycle: position and velocity (in inc, inc/s), command, time of
/// the part (in s).
fn record(takes: Takes, mut step: impl FnMut(&mut (f64, f64), f64, f64)) -> Record {
    const PARTS: usize = 20;
    let permitted = permitted(takes);
    let mut excitation = Excitation::new(permitted).unwrap();
    let mut record = Record::with_capacity(permitted.cycle, takes, 10_000);
    let (mut state, mut smooth, mut last) = ((0.0, 0.0), 0.0, 0.0);
    loop {
        let place = f64::floor(state.0);
        smooth += 0.3 * ((place - last) / permitted.cycle - smooth);
        last = place;
        let ExcitationOutput::Command(command) = excitation.next(place, smooth) else { return record };
        record.push(command, place as i64);
        for _ in 0..PARTS {
            step(&mut state, command, permitted.cycle / PARTS as f64);
        }
    }
}

/// Returns the record of a drive of 300 rad/s with a lag of 6 ms.
pub(super) fn velocity_record() -> Record {
    let full = 300.0 / std::f64::consts::TAU * TURN;
    record(Takes::Velocity, |state, command, h| {
        state.1 += h * (full * command - state.1) / 0.006;
        state.0 += h * state.1;
    })
}

/// Returns the record of a drive with 500 rev/s^2 at full effort, 1.5 1/s of viscous and 15 rev/s^2 of dry friction.
pub(super) fn effort_record() -> Record {
    record(Takes::Effort, |state, command, h| {
        let pull = 500.0 * TURN * command - 1.5 * state.1;
        let rub = 15.0 * TURN * h;
        let free = state.1 + h * pull;
        state.1 = if free.abs() <= rub { 0.0 } else { free - rub * free.signum() };
        state.0 += h * state.1;
    })
}

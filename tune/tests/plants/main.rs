//! Axes from data sheets: excited, identified, tuned, and moved with the resulting gains.
//!
//! With `--nocapture` the tests print their tables.

mod catalogue;
mod coupled;
mod play;
mod refusals;
mod simulator;

use catalogue::{LoopCase, TestAxis, all};
use lineshaft_core::regulator::{PidGains, VelocityGains};
use lineshaft_tune::{
    Abort, Design, DesignSpec, Dynamics, ExcitationOutput, Identified, Loops, PositionLaw, Resonance, Targets, design,
    identify,
};
use simulator::{Axis, Mechanics, excite, figures, permitted, run, trapezoid};

fn found(axis: Axis) -> Identified {
    let excited = excite(axis, permitted(&axis), |_| 0.0);
    assert!(matches!(excited.end, ExcitationOutput::Done(_)), "{:?}", excited.end);
    identify(&excited.record).expect("a model")
}

/// Checks that `value` is the true one, with a relative tolerance `part` and an absolute one `least`.
fn near(name: &str, what: &str, value: f64, truth: f64, part: f64, least: f64) {
    let most = (part * truth.abs()).max(least);
    assert!((value - truth).abs() <= most, "{name}: {what} is {value}, {truth} is true, {most} is permitted");
}

fn resonances_agree(name: &str, found: Resonance, truth: Resonance) {
    near(name, "frequency", found.frequency, truth.frequency, 0.01, 0.0);
    near(name, "damping", found.damping, truth.damping, 0.1, 0.0);
    near(name, "inertia ratio", found.inertia_ratio, truth.inertia_ratio, 0.02, 0.0);
}

#[test]
fn identified_model_is_true_model() {
    for TestAxis { name, axis, .. } in all() {
        let (found, truth) = (found(axis), axis.truth());
        println!("{name}: {:.3} % explained\n  found {:?}\n  true  {:?}\n", found.explained, found.model, truth);
        assert!(found.explained > 99.5, "{name}: {}", found.explained);
        near(name, "delay", found.model.delay, truth.delay, 0.0, 5e-5);
        match (found.model.dynamics, truth.dynamics) {
            (
                Dynamics::Velocity { gain, time_constant, offset },
                Dynamics::Velocity { gain: true_gain, time_constant: true_time, .. },
            ) => {
                near(name, "gain", gain, true_gain, 0.002, 0.0);
                near(name, "time constant", time_constant, true_time, 0.01, 0.0);
                near(name, "offset", offset, 0.0, 0.0, 1e-4 * true_gain);
            }
            (
                Dynamics::Effort { acceleration, viscous, coulomb, load, resonance },
                Dynamics::Effort {
                    acceleration: true_acceleration,
                    viscous: true_viscous,
                    coulomb: true_coulomb,
                    load: true_load,
                    resonance: true_resonance,
                },
            ) => {
                near(name, "acceleration", acceleration, true_acceleration, 0.005, 0.0);
                near(name, "viscous friction", viscous, true_viscous, 0.02, 0.0);
                near(name, "Coulomb friction", coulomb, true_coulomb, 0.01, 0.0);
                near(name, "load", load, true_load, 0.005, 2e-4 * true_acceleration);
                assert_eq!(resonance.is_some(), true_resonance.is_some(), "{name}: {resonance:?}");
                if let (Some(found), Some(truth)) = (resonance, true_resonance) {
                    resonances_agree(name, found, truth);
                }
            }
            other => panic!("{name}: {other:?}"),
        }
    }
}

/// The stated deviation of an estimate covers its error: four standard deviations, and if the model itself is no more
/// accurate (friction within a cycle, counts that are rounded down) one part in a thousand, or 30 us.
#[test]
fn deviations_cover_the_errors() {
    for TestAxis { name, axis, .. } in all() {
        let (found, truth) = (found(axis), axis.truth());
        let (value, expected) = match (found.model.dynamics, truth.dynamics) {
            (Dynamics::Velocity { gain, .. }, Dynamics::Velocity { gain: truth, .. }) => (gain, truth),
            (Dynamics::Effort { acceleration, .. }, Dynamics::Effort { acceleration: truth, .. }) => {
                (acceleration, truth)
            }
            other => panic!("{name}: {other:?}"),
        };
        assert!(found.deviation.gain > 0.0 && found.deviation.gain < 0.01 * expected, "{name}");
        near(name, "gain", value, expected, 0.001, 4.0 * found.deviation.gain);
        assert!(found.deviation.delay > 0.0 && found.deviation.delay < 2e-4, "{name}: {}", found.deviation.delay);
        near(name, "delay", found.model.delay, truth.delay, 0.0, 3e-5 + 4.0 * found.deviation.delay);
    }
}

#[test]
fn an_excitation_keeps_its_bounds_and_comes_back() {
    for TestAxis { name, axis, .. } in all() {
        for seed in 1..4 {
            let permitted = lineshaft_tune::Permitted { seed, ..permitted(&axis) };
            let excited = excite(axis, permitted, |_| 0.0);
            assert!(matches!(excited.end, ExcitationOutput::Done(_)), "{name}: {:?}", excited.end);
            assert!(excited.farthest <= permitted.travel, "{name}: {}", excited.farthest);
            assert!(excited.fastest <= 1.1 * permitted.velocity, "{name}: {}", excited.fastest);
            assert!(excited.last.abs() <= 0.1 * permitted.travel, "{name}: {}", excited.last);
        }
    }
}

/// A push that no command can brake ends the excitation with 0.
#[test]
fn excitation_ends_when_axis_is_pushed_out_of_travel() {
    let axis = all().remove(0).axis;
    let excited = excite(axis, permitted(&axis), |k| if k > 2000 { 1.8 } else { 0.0 });
    let ExcitationOutput::Aborted(Abort::Travel { position, most }) = excited.end else { panic!("{:?}", excited.end) };
    assert_eq!(most, 2.5 * 8192.0);
    assert!(position > most && position < 1.2 * most, "{position}");
}

/// The same axis in faster and slower cycles.
#[test]
fn the_cycle_changes_nothing_but_the_grid() {
    let rigid = all().into_iter().find(|named| named.name == "1:5").unwrap().axis;
    for cycle in [2.5e-4, 2e-3] {
        let axis = Axis { cycle, ..rigid };
        let permitted = lineshaft_tune::Permitted { duration: 2.0, ..permitted(&axis) };
        let found = identify(&excite(axis, permitted, |_| 0.0).record).unwrap();
        let (Dynamics::Effort { acceleration, coulomb, .. }, Dynamics::Effort { acceleration: a, coulomb: c, .. }) =
            (found.model.dynamics, axis.truth().dynamics)
        else {
            panic!("{found:?}");
        };
        near("1:5", "acceleration", acceleration, a, 0.005, 0.0);
        near("1:5", "Coulomb friction", coulomb, c, 0.02, 0.0);
        near("1:5", "delay", found.model.delay, axis.delay, 0.0, 5e-5);
    }
}

/// Reported efforts replace the commands: what was commanded, and when, has no effect.
#[test]
fn reported_efforts_replace_commands() {
    let axis = all().into_iter().find(|named| named.name == "1:5").unwrap().axis;
    let mut record = excite(axis, permitted(&axis), |_| 0.0).record;
    record.efforts = record.commands.iter().map(|command| 3.0 * command).collect();
    let Dynamics::Effort { acceleration, .. } = identify(&record).unwrap().model.dynamics else { panic!() };
    let Dynamics::Effort { acceleration: truth, .. } = axis.truth().dynamics else { panic!() };
    near("1:5", "acceleration", acceleration, truth / 3.0, 0.005, 0.0);
}

fn tuned(axis: &Axis, model: &lineshaft_tune::Model, tried: &LoopCase) -> Design {
    let wish = DesignSpec {
        law: tried.law,
        velocity: tried.velocity,
        max_velocity: full_velocity(axis),
        max_acceleration: 100.0 * axis.encoder,
        inertia_ratio: 0.0,
        targets: Targets::default(),
    };
    design(model, &wish).expect("gains")
}

/// Returns the velocity of a move of three turns with that acceleration, with a phase of constant velocity (turns, s).
fn fastest(acceleration: f64) -> f64 {
    (0.8 * (3.0 * acceleration).sqrt()).min(10.0)
}

/// Returns 45 turns/s, or the full velocity of the drive (inc/s).
fn full_velocity(axis: &Axis) -> f64 {
    match axis.mechanics {
        Mechanics::Velocity { full, .. } => full / std::f64::consts::TAU * axis.encoder,
        Mechanics::Torque { .. } => 45.0 * axis.encoder,
    }
}

/// Returns loops of the same structure with the default parameters.
fn before(loops: &Loops) -> Loops {
    let pid = PidGains { proportional: 30, limit: 1000, bandwidth: 1000, period_ms: 1, ..PidGains::default() };
    let position = match loops.position {
        PositionLaw::Proportional { .. } => PositionLaw::Proportional { kv: 1000.0 / 60.0 },
        PositionLaw::Pid { .. } => PositionLaw::Pid { gains: pid, cycles: 1 },
    };
    let gains = VelocityGains { proportional: 200, integral: 5, limit: 1000, cycle: 1.0 };
    let velocity = loops.velocity.map(|inner| lineshaft_tune::Inner { gains, ..inner });
    Loops { position, velocity, ..*loops }
}

#[test]
fn gains_that_are_found_move_the_true_axis() {
    for TestAxis { name, axis, loops, acceleration } in all() {
        let model = found(axis).model;
        let inc = axis.encoder;
        for tried in &loops {
            let found = tuned(&axis, &model, tried);
            assert!(found.position.is_stable() && found.position.phase >= 60.0 && found.position.gain >= 6.0, "{name}");
            let window = (0.002 * inc).max(3.0);
            // A step for which no limit of the output is active.
            let size = (0.02 * inc).max(20.0);
            let command = |time: f64| if time < 0.1 { (0.0, 0.0, 0.0) } else { (size, 0.0, 0.0) };
            let step = figures(&run(axis, &found.loops, 3.0, command), size, 0.1, window, axis.cycle);
            let (way, fastest, rate) = (3.0 * inc, fastest(acceleration) * inc, acceleration * inc);
            let to = || trapezoid(way, fastest, rate);
            let end = 0.1 + fastest / rate + way / fastest;
            let moved = figures(&run(axis, &found.loops, end + 2.0, to()), way, end, window, axis.cycle);
            let untuned = figures(&run(axis, &before(&found.loops), end + 2.0, to()), way, end, window, axis.cycle);
            println!("{name}: {:?} {:?}", found.loops.position, found.loops.velocity.map(|inner| inner.gains));
            println!("  {:?}\n  velocity {:?}", found.position, found.velocity);
            println!("  step {step:.3?}\n  move {moved:.3?}\n  before {untuned:.3?}");
            assert!(step.0 <= tried.overshoot, "{name}: overshoot {} %", step.0);
            for settled in [step.1, moved.1] {
                assert!(settled.is_some_and(|time| time <= tried.settling), "{name}: settled {settled:?}");
            }
            assert!(moved.2 < untuned.2, "{name}: {} and {} before", moved.2, untuned.2);
        }
    }
}

/// The simulation of the crate on the identified model, compared with the simulator on the true axis.
#[test]
fn a_model_moves_as_its_axis_does() {
    use lineshaft_tune::{Move, simulate};
    for TestAxis { name, axis, loops, acceleration } in all() {
        let model = found(axis).model;
        let inc = axis.encoder;
        for tried in &loops {
            let loops = tuned(&axis, &model, tried).loops;
            let (distance, velocity, acceleration) = (3.0 * inc, fastest(acceleration) * inc, acceleration * inc);
            let end = 0.1 + velocity / acceleration + distance / velocity;
            let truth = run(axis, &loops, end + 0.3, trapezoid(distance, velocity, acceleration));
            let (_, _, error) = figures(&truth, distance, end, 3.0, axis.cycle);
            let to = Move::Trapezoid { distance, velocity, acceleration };
            let own = simulate(&model, &loops, &to, end + 0.2, 3.0).unwrap();
            println!("{name}: {:.2} inc, {error:.2} inc", own.figures.following_error);
            // The difference of rounding down or to the nearest, and the motion of the axis in the tenth of a second
            // before.
            near(name, "following error", own.figures.following_error, error, 0.1, 6.0 + 0.0015 * inc);
        }
    }
}

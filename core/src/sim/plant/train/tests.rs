use super::*;
use crate::sim::plant::{Amplifier, Coupling, Load, Motor, Reading, Stage};
use libm::{exp, log, sin};
use proptest::prelude::*;

const MS: u64 = 1_000_000;
/// The shortest cycle (ns).
const SHORT: u64 = 125_000;

/// 2.5 kg cm^2, without friction.
fn rotor() -> MotorData {
    MotorData {
        inertia: 2.5e-4,
        friction: Friction::default(),
        load: Load::default(),
        coupling: None,
        amplifier: Amplifier { stage: Stage::Torque { rated: 1.0, lag_ns: 0 }, limit: 3.0, dead_time_ns: 0 },
        reading: Reading { counts_per_turn: 65_536.0, noise: 0.0, seed: 0, at_load: false },
    }
}

/// With a load of three times that on a shaft of 400 Nm/rad.
fn elastic(damping: f64, backlash: f64) -> MotorData {
    let load = Load { inertia: 7.5e-4, ..Load::default() };
    MotorData { load, coupling: Some(Coupling { stiffness: 400.0, damping, backlash }), ..rotor() }
}

fn train(data: &MotorData, cycle_ns: u64) -> (Train, State) {
    Motor::new(*data).unwrap();
    let train = Train::new(data, 0, cycle_ns);
    let state = train.rest();
    (train, state)
}

fn near(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance * expected.abs().max(1.0), "{value}, not {expected}");
}

/// Returns kinetic energy and that of the spring (J).
fn energy(data: &MotorData, train: &Train, state: &State) -> f64 {
    let load = if data.coupling.is_some() { data.load.inertia } else { 0.0 };
    let stiffness = data.coupling.map_or(0.0, |coupling| coupling.stiffness);
    let pressed = (train.twist(state).abs() - train.equations.half_gap).max(0.0);
    let [motor, other] = [state.values[MOTOR], state.values[LOAD]];
    (train.inertia() * motor * motor + load * other * other + stiffness * pressed * pressed) / 2.0
}

/// w = a t, angle = a t^2 / 2.
#[test]
fn a_free_rotor_gains_velocity_evenly() {
    let (train, mut state) = train(&rotor(), MS);
    let angle: f64 = (0..1000).map(|_| train.cycle(&mut state, [0.0, 50.0], false)).sum();
    near(train.velocity(&state), 50.0, 1e-12);
    near(angle, 25.0, 1e-12);
}

/// With a lag T: w = a (t - T (1 - e^(-t/T))), angle = a (t^2 / 2 - T t + T^2 (1 - e^(-t/T))).
#[test]
fn a_lag_of_the_torque_is_exact() {
    let mut data = rotor();
    data.amplifier.stage = Stage::Torque { rated: 1.0, lag_ns: 700_000 };
    let (train, mut state) = train(&data, MS);
    let (time, lag) = (5e-3, 7e-4);
    let angle: f64 = (0..5).map(|_| train.cycle(&mut state, [0.0, 1e4], false)).sum();
    let rest = 1.0 - exp(-time / lag);
    near(train.drive(&state, 1e4), 1e4 * rest, 1e-12);
    near(train.velocity(&state), 1e4 * (time - lag * rest), 1e-12);
    near(angle, 1e4 * (time * time / 2.0 - lag * time + lag * lag * rest), 1e-12);
}

/// J w' = -b w - f ends at t = J/b ln(1 + b w0 / f), and J w0 = b angle + f t.
#[test]
fn friction_brings_a_rotor_to_rest_at_its_moment_and_holds_it() {
    let friction = Friction { viscous: 1e-3, coulomb: 0.02, holding: 0.03 };
    let data = MotorData { friction, ..rotor() };
    for cycle_ns in [SHORT, MS, 20 * MS] {
        let (train, mut state) = train(&data, cycle_ns);
        (state.values[MOTOR], state.grips[0]) = (100.0, FrictionState::Forwards);
        let stop = 2.5e-4 / 1e-3 * log(1.0 + 1e-3 * 100.0 / 0.02);
        let expected = (2.5e-4 * 100.0 - 0.02 * stop) / 1e-3;
        let (mut angle, mut time, mut before) = (0.0, 0.0, 0.0);
        while train.velocity(&state) > 0.0 {
            angle += train.cycle(&mut state, [0.0; 2], false);
            before = time;
            time += cycle_ns as f64 / 1e9;
        }
        assert!(before < stop && stop <= time, "{before} {stop} {time}");
        near(angle, expected, 1e-9);
        assert_eq!((train.velocity(&state), state.grips[0]), (0.0, FrictionState::Sticks));
        assert_eq!(train.cycle(&mut state, [0.0; 2], false), 0.0);
    }
}

/// A torque up to static friction is held; a body that slides needs less torque to continue.
#[test]
fn stiction_holds_up_to_its_torque() {
    let friction = Friction { viscous: 0.0, coulomb: 0.02, holding: 0.03 };
    let (train, mut state) = train(&MotorData { friction, ..rotor() }, MS);
    let over = |torque: f64| [torque / 2.5e-4; 2];
    for torque in [0.029, -0.029, 0.0] {
        (0..100).for_each(|_| assert_eq!(train.cycle(&mut state, over(torque), false), 0.0, "{torque}"));
    }
    assert!(train.cycle(&mut state, over(-0.031), false) < 0.0);
    near(train.velocity(&state), -(0.031 - 0.02) / 2.5e-4 * 1e-3, 1e-9);
    let velocity = train.velocity(&state);
    train.cycle(&mut state, over(-0.025), false);
    near(train.velocity(&state), velocity - 0.005 / 2.5e-4 * 1e-3, 1e-9);
}

/// Against a torque above static friction a body reverses without a stop: both parts of its motion are parabolas.
#[test]
fn a_body_that_is_pulled_harder_than_stiction_turns_round_at_once() {
    let friction = Friction { viscous: 0.0, coulomb: 0.02, holding: 0.03 };
    let (train, mut state) = train(&MotorData { friction, ..rotor() }, 10 * MS);
    (state.values[MOTOR], state.grips[0]) = (0.5, FrictionState::Forwards);
    // Decelerated by 0.1 + 0.02 Nm to 0, then accelerated back by 0.1 - 0.02 Nm.
    let angle = train.cycle(&mut state, [-0.1 / 2.5e-4; 2], false);
    let (slows, turns) = (0.12 / 2.5e-4, 0.08 / 2.5e-4);
    let left = 0.01 - 0.5 / slows;
    near(train.velocity(&state), -turns * left, 1e-9);
    near(angle, 0.25 / slows / 2.0 - turns * left * left / 2.0, 1e-9);
}

/// Two masses oscillate with sqrt(k (1/J + 1/j)), counted over 100 periods.
#[test]
fn two_masses_swing_at_their_resonance() {
    for (ratio, stiffness) in [(1.0, 400.0), (3.0, 400.0), (30.0, 50.0), (0.1, 5e3)] {
        let mut data = elastic(0.0, 0.0);
        data.load.inertia = 2.5e-4 * ratio;
        data.coupling = Some(Coupling { stiffness, damping: 0.0, backlash: 0.0 });
        let (train, mut state) = train(&data, SHORT);
        state.values[TWIST] = 0.01 * train.equations.pace;
        let (mut cycles, mut passed, mut first, mut last) = (0.0, 0, 0.0, 0.0);
        while passed < 101 {
            let before = train.twist(&state);
            train.cycle(&mut state, [0.0; 2], false);
            let after = train.twist(&state);
            if before < 0.0 && after >= 0.0 {
                last = cycles + before / (before - after);
                first = if passed == 0 { last } else { first };
                passed += 1;
            }
            cycles += 1.0;
        }
        let measured = 100.0 / ((last - first) * SHORT as f64 / 1e9);
        let analytic = (stiffness * (1.0 / 2.5e-4 + 1.0 / (2.5e-4 * ratio))).sqrt() / std::f64::consts::TAU;
        near(measured / analytic, 1.0, 1e-3);
    }
}

/// With a held shaft only the load oscillates, with sqrt(k / j), around the twist of its weight.
#[test]
fn a_held_shaft_lets_the_load_swing() {
    let mut data = elastic(0.0, 0.0);
    data.load.torque = -2.0;
    let (train, mut state) = train(&data, MS);
    near(train.twist(&state), 2.0 / 400.0, 1e-15);
    assert_eq!(train.cycle(&mut state, [1e4; 2], true), 0.0);
    near(train.twist(&state), 2.0 / 400.0, 1e-12);
    state.values[LOAD] = 1.0;
    train.cycle(&mut state, [0.0; 2], true);
    let swing = (400.0_f64 / 7.5e-4).sqrt();
    near(train.twist(&state), 2.0 / 400.0 - sin(swing * 1e-3) / swing, 1e-12);
    assert_eq!(train.velocity(&state), 0.0);
}

/// Only the motor moves through the gap: b / 2 = a t^2 / 2 from its middle.
#[test]
fn within_the_gap_the_load_does_not_move() {
    let (train, mut state) = train(&elastic(0.05, 0.02), SHORT);
    let reached = (0.02_f64 / 100.0).sqrt();
    let mut time = SHORT as f64 / 1e9;
    while time < reached {
        train.cycle(&mut state, [100.0; 2], false);
        assert_eq!((state.values[LOAD], state.contact), (0.0, Contact::Open), "{time}");
        time += SHORT as f64 / 1e9;
    }
    train.cycle(&mut state, [100.0; 2], false);
    assert!(state.values[LOAD] > 0.0 && state.contact == Contact::Ahead);
}

/// Without damping and friction the energy of the plant between two flanks is constant, for any cycle time.
#[test]
fn flanks_without_damping_keep_the_energy() {
    let data = elastic(0.0, 0.02);
    for cycle_ns in [SHORT, MS, 10 * MS] {
        let (train, mut state) = train(&data, cycle_ns);
        state.values[MOTOR] = 10.0;
        let all = energy(&data, &train, &state);
        (0..2_000_000_000 / cycle_ns).for_each(|_| {
            train.cycle(&mut state, [0.0; 2], false);
        });
        near(energy(&data, &train, &state) / all, 1.0, 1e-6);
    }
}

/// Returns the derivatives by the equations as they are written, with the present flank and sign of friction.
fn slopes(data: &MotorData, [w, d, v]: [f64; 3], torque: f64) -> [f64; 3] {
    let coupling = data.coupling.unwrap();
    let beyond = d - d.clamp(-coupling.backlash / 2.0, coupling.backlash / 2.0);
    let shaft = if beyond == 0.0 { 0.0 } else { coupling.stiffness * beyond + coupling.damping * (w - v) };
    let dry = |velocity: f64, friction: Friction| friction.viscous * velocity + friction.dry(velocity);
    [
        (torque - shaft - dry(w, data.friction)) / data.inertia,
        w - v,
        (shaft - dry(v, data.load.friction)) / data.load.inertia,
    ]
}

trait Dry {
    fn dry(&self, velocity: f64) -> f64;
}

impl Dry for Friction {
    fn dry(&self, velocity: f64) -> f64 {
        if velocity == 0.0 { 0.0 } else { self.coulomb.copysign(velocity) }
    }
}

/// Independent computation: Runge-Kutta of fourth order in steps of 0.1 us, over moves that pass the gap and reverse
/// the friction.
#[test]
fn a_gap_and_friction_agree_with_small_steps() {
    let mut data = elastic(0.05, 0.004);
    data.friction = Friction { viscous: 2e-4, coulomb: 0.01, holding: 0.01 };
    data.load.friction = Friction { viscous: 1e-3, coulomb: 0.02, holding: 0.02 };
    let (train, mut state) = train(&data, MS);
    let (mut values, step) = ([0.0; 3], 1e-7);
    for cycle in 0..60 {
        let torque: f64 = if cycle < 25 { 1.0 } else { -1.3 };
        train.cycle(&mut state, [torque / data.inertia; 2], false);
        for _ in 0..10_000 {
            let along = |rate: [f64; 3], time: f64| {
                let [a, b, c] = values;
                [a + rate[0] * time, b + rate[1] * time, c + rate[2] * time]
            };
            let one = slopes(&data, values, torque);
            let two = slopes(&data, along(one, step / 2.0), torque);
            let three = slopes(&data, along(two, step / 2.0), torque);
            let four = slopes(&data, along(three, step), torque);
            let mean = |place: usize| (one[place] + 2.0 * (two[place] + three[place]) + four[place]) / 6.0;
            values = along([mean(0), mean(1), mean(2)], step);
        }
        near(state.values[MOTOR], values[0], 2e-4);
        near(train.twist(&state), values[1], 1e-6);
        near(state.values[LOAD], values[2], 2e-4);
    }
}

/// No setpoint leads to a state of NaN.
#[test]
fn setpoint_of_nan_is_zero_torque() {
    let data = MotorData { friction: Friction { viscous: 1e-3, coulomb: 0.02, holding: 0.03 }, ..elastic(0.05, 0.02) };
    let (train, mut state) = train(&data, MS);
    for asked in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(train.cycle(&mut state, [asked; 2], false), 0.0);
        assert_eq!(state, train.rest());
    }
}

fn any_friction() -> impl Strategy<Value = Friction> {
    let torque = prop_oneof![Just(0.0), 1e-3..0.5_f64];
    (prop_oneof![Just(0.0), 1e-5..1e-1_f64], torque, 1.0..2.0_f64).prop_map(|(viscous, coulomb, ratio)| Friction {
        viscous,
        coulomb,
        holding: coulomb * ratio,
    })
}

fn any_plant() -> impl Strategy<Value = MotorData> {
    let gap = prop_oneof![Just(0.0), 1e-4..0.1_f64];
    let damping = prop_oneof![Just(0.0), 1e-4..10.0_f64];
    let coupling = (1.0..1e5_f64, damping, gap);
    let coupling = coupling.prop_map(|(stiffness, damping, backlash)| Some(Coupling { stiffness, damping, backlash }));
    let coupling = prop_oneof![Just(None), coupling];
    let bodies = (1e-5..1e-1_f64, 1e-5..1e-1_f64, any_friction(), any_friction());
    (bodies, coupling, any::<bool>()).prop_map(|((motor, load, own, its), coupling, winds)| {
        let mut data = MotorData { inertia: motor, friction: own, coupling, ..rotor() };
        data.load = Load { inertia: load, friction: its, torque: 0.0 };
        if winds {
            let (resistance, torque_constant, back_emf) = (1.5, 0.5, 0.5);
            data.amplifier.stage =
                Stage::Winding { voltage: 48.0, resistance, inductance: 0.0, torque_constant, back_emf };
        }
        data
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, max_shrink_iters: 20, ..ProptestConfig::default() })]

    /// Without input no plant gains energy, for any data and any cycle time.
    #[test]
    fn energy_never_grows_without_input(
        data in any_plant(), velocities in prop::array::uniform2(-300.0..300.0_f64),
        cycle_ns in prop_oneof![Just(SHORT), Just(MS), Just(10 * MS)],
    ) {
        let (train, mut state) = train(&data, cycle_ns);
        let slides = |grip: FrictionState, velocity: f64| match grip {
            FrictionState::Free => FrictionState::Free,
            _ if velocity < 0.0 => FrictionState::Backwards,
            _ => FrictionState::Forwards,
        };
        state.values[MOTOR] = velocities[0];
        state.grips[0] = slides(state.grips[0], velocities[0]);
        if data.coupling.is_some() {
            state.values[LOAD] = velocities[1];
            state.grips[1] = slides(state.grips[1], velocities[1]);
        }
        let first = energy(&data, &train, &state);
        let mut before = first;
        for _ in 0..200 {
            train.cycle(&mut state, [0.0; 2], false);
            let now = energy(&data, &train, &state);
            prop_assert!(now <= before + 1e-9 * first, "{before} J, then {now} J of {first} J");
            before = now;
        }
    }

    /// A linear plant does not depend on the cycle time: 1 ms is 8 times 125 us to 1e-9.
    #[test]
    fn cycles_of_any_length_agree_where_all_is_linear(
        data in any_plant(), setpoints in prop::collection::vec(-100.0..100.0_f64, 20), lag_ns in 0..2_000_000_i64,
    ) {
        let mut data = data;
        for friction in [&mut data.friction, &mut data.load.friction] {
            (friction.coulomb, friction.holding) = (0.0, 0.0);
        }
        if let Some(coupling) = &mut data.coupling {
            coupling.backlash = 0.0;
        }
        if let Stage::Torque { lag_ns: lag, .. } = &mut data.amplifier.stage {
            *lag = lag_ns;
        }
        let ((long, mut one), (short, mut other)) = (train(&data, MS), train(&data, SHORT));
        let (mut travel, mut size) = (0.0, 1.0_f64);
        for setpoint in setpoints {
            travel += long.cycle(&mut one, [setpoint; 2], false);
            (0..8).for_each(|_| travel -= short.cycle(&mut other, [setpoint; 2], false));
            size = size.max(one.values.amax());
            let (mut one, mut other) = (one.values, other.values);
            (one[TRAVEL], other[TRAVEL]) = (0.0, 0.0);
            prop_assert!((one - other).amax() < 1e-9 * size && travel.abs() < 1e-9 * size, "{one} {other} {travel}");
        }
    }
}

/// With friction and a gap, the times of events are rounded to 2^-30 of a cycle: a second of moves agrees to 1e-6 of
/// its velocities.
#[test]
fn cycles_of_any_length_agree_within_the_rounding_of_events() {
    let mut data = elastic(0.2, 0.004);
    data.friction = Friction { viscous: 2e-4, coulomb: 0.01, holding: 0.015 };
    data.load.friction = Friction { viscous: 1e-3, coulomb: 0.02, holding: 0.03 };
    let ((long, mut one), (short, mut other)) = (train(&data, MS), train(&data, SHORT));
    let (mut travel, mut most) = (0.0, 0.0_f64);
    for cycle in 0..1000 {
        let asked = [0.5 * sin(f64::from(cycle) * 0.02) / data.inertia; 2];
        travel += long.cycle(&mut one, asked, false);
        (0..8).for_each(|_| travel -= short.cycle(&mut other, asked, false));
        most = most.max(one.values[MOTOR].abs());
        near(one.values[MOTOR], other.values[MOTOR], 1e-6);
        near(one.values[LOAD], other.values[LOAD], 1e-6);
        assert!(travel.abs() < 1e-6, "{travel}");
    }
    assert!(most > 10.0, "{most}");
}

/// Thousands of flank contacts in a cycle of 20 ms are not computed to the end: the train does not move in the rest,
/// and no energy is added.
#[test]
fn train_stops_for_rest_of_cycle_after_too_many_events() {
    let mut data = elastic(0.0, 1e-6);
    data.coupling = Some(Coupling { stiffness: 1e6, damping: 0.0, backlash: 1e-6 });
    let (train, mut state) = train(&data, 20 * MS);
    state.values[MOTOR] = 100.0;
    let all = energy(&data, &train, &state);
    // The centre of mass would move with 25 rad/s for 20 ms.
    let angle = train.cycle(&mut state, [0.0; 2], false);
    assert!(angle > 0.0 && angle < 0.25, "{angle}");
    near(energy(&data, &train, &state) / all, 1.0, 1e-6);
    let again = train.cycle(&mut state, [0.0; 2], false);
    assert!(again > 0.0 && again < 0.25, "{again}");
}

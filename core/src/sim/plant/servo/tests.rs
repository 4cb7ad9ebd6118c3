use super::*;
use crate::sim::plant::{Amplifier, Coupling, Friction, Load, Stage};
use libm::exp;
use proptest::prelude::*;

const MS: u64 = 1_000_000;

fn motor() -> MotorData {
    MotorData {
        inertia: 2.5e-4,
        friction: Friction::default(),
        load: Load { inertia: 2.5e-4, ..Load::default() },
        coupling: None,
        amplifier: Amplifier { stage: Stage::Torque { rated: 1.0, lag_ns: 0 }, limit: 3.0, dead_time_ns: 0 },
        reading: Reading { counts_per_turn: 65_536.0, noise: 0.0, seed: 7, at_load: false },
    }
}

fn servo(data: MotorData) -> Servo {
    Servo::new(Motor::new(data).unwrap(), MS)
}

/// Half the rated torque on 5e-4 kg m^2 is 1000 rad/s^2; after 0.1 s it has turned by 5 rad, 52151.89 counts of 65536 in a turn.
#[test]
fn counts_are_the_floor_of_the_angle() {
    let mut servo = servo(motor());
    let counts: i64 = (0..100).map(|_| servo.step(0.5, false)).sum();
    assert_eq!((counts, servo.effort()), (52_151, 500.0));
    let back: i64 = (0..400).map(|_| servo.step(-0.5, false)).sum();
    // 0.1 s to rest at 10 rad, then 0.3 s back: 10 - 45 = -35 rad are -365063.23 counts.
    assert_eq!(counts + back, -365_064);
}

/// Values beyond the limit are limited: 3 times 2000 rad/s^2.
#[test]
fn the_torque_is_limited() {
    for (setpoint, expected) in [(3.0, 3.0), (4.0, 3.0), (-1e300, -3.0), (f64::INFINITY, 0.0), (f64::NAN, 0.0)] {
        let mut servo = servo(motor());
        servo.step(setpoint, false);
        assert_eq!(servo.effort(), 1000.0 * expected);
        assert!((servo.train.velocity(&servo.state) - expected * 2.0).abs() < 1e-12, "{setpoint}");
    }
}

/// A torque of 2000 rad/s^2 that acts 1.25 ms late leaves 2000 (t - 1.25 ms).
#[test]
fn a_dead_time_need_not_be_whole_cycles() {
    for (dead_ns, cycle_ns) in [(0, MS), (1_250_000, MS), (3_000_000, MS), (300_000, 250_000), (999_999_999, MS)] {
        let mut data = motor();
        data.amplifier.dead_time_ns = dead_ns;
        let mut servo = Servo::new(Motor::new(data).unwrap(), cycle_ns);
        for k in 1..=1100_u32 {
            servo.step(1.0, false);
            let after = f64::from(k) * cycle_ns as f64 / 1e9 - dead_ns as f64 / 1e9;
            let velocity = servo.train.velocity(&servo.state);
            assert!((velocity - 2000.0 * after.max(0.0)).abs() < 1e-8, "{dead_ns} {k}: {velocity}");
        }
    }
}

/// With a held shaft i = u / R (1 - e^(-t R / L)); a free one accelerates to u / ke.
#[test]
fn a_winding_takes_its_current_and_its_speed() {
    let mut data = motor();
    let (voltage, resistance, inductance, torque_constant) = (48.0, 1.2, 3e-3, 0.4);
    let stage = Stage::Winding { voltage, resistance, inductance, torque_constant, back_emf: 0.5 };
    data.amplifier = Amplifier { stage, limit: 1.0, dead_time_ns: 0 };
    let mut servo = servo(data);
    for k in 1..=10 {
        assert_eq!(servo.step(0.5, true), 0);
        let expected = 500.0 * (1.0 - exp(-f64::from(k) * 1e-3 * 1.2 / 3e-3));
        assert!((servo.effort() - expected).abs() < 1e-9, "{k}: {}", servo.effort());
    }
    (0..1000).for_each(|_| {
        servo.step(0.5, false);
    });
    assert!((servo.train.velocity(&servo.state) - 24.0 / 0.5).abs() < 1e-9);
}

/// Without an inductance w = u / ke (1 - e^(-t kt ke / (R J))).
#[test]
fn a_winding_without_an_inductance_brakes_with_its_voltage() {
    let mut data = motor();
    let (voltage, resistance, torque_constant, back_emf) = (48.0, 1.2, 0.4, 0.5);
    let stage = Stage::Winding { voltage, resistance, inductance: 0.0, torque_constant, back_emf };
    data.amplifier = Amplifier { stage, limit: 1.0, dead_time_ns: 0 };
    let mut servo = servo(data);
    for k in 1..=10 {
        servo.step(1.0, false);
        let left = exp(-f64::from(k) * 1e-3 * 0.4 * 0.5 / (1.2 * 5e-4));
        let velocity = servo.train.velocity(&servo.state);
        assert!((velocity - 96.0 * (1.0 - left)).abs() < 1e-10, "{k}: {velocity}");
        assert!((servo.effort() - 1000.0 * left).abs() < 1e-9, "{k}: {}", servo.effort());
    }
}

#[test]
fn noise_is_the_same_for_the_same_seed() {
    let noisy = |seed: u64| {
        let mut data = motor();
        data.reading = Reading { noise: 3.0, seed, ..data.reading };
        let mut servo = servo(data);
        (0..4000).map(|_| servo.read()).collect::<Vec<_>>()
    };
    assert_eq!(noisy(1), noisy(1));
    assert_ne!(noisy(1), noisy(2));
    let readings = noisy(1);
    // Floored at fraction 0: half a count below the mean of 0, and 1/12 more of variance.
    let mean = readings.iter().sum::<i64>() as f64 / 4000.0;
    let square = readings.iter().map(|read| (*read as f64 - mean) * (*read as f64 - mean)).sum::<f64>() / 4000.0;
    assert!((mean + 0.5).abs() < 0.15, "{mean}");
    assert!((square - 9.0 - 1.0 / 12.0).abs() < 0.6, "{square}");
    assert!(readings.iter().all(|read| (-11..=10).contains(read)));
    let mut quiet = servo(motor());
    assert!((0..100).all(|_| quiet.read() == 0));
}

/// The loop of the drive reaches its velocity, with static friction, with a weight, and with an elastic shaft, and
/// stays within 0.1 %.
#[test]
fn a_velocity_is_closed_without_an_error_that_stays() {
    let friction = Friction { viscous: 1e-3, coulomb: 0.05, holding: 0.08 };
    let rigid = MotorData { friction, ..motor() };
    let mut hanging = rigid;
    hanging.load.torque = -0.4;
    let mut elastic = motor();
    elastic.load.inertia = 2.5e-3;
    elastic.coupling = Some(Coupling { stiffness: 300.0, damping: 0.05, backlash: 0.0 });
    for data in [rigid, hanging, elastic] {
        let mut servo = servo(data);
        let asked = 200_000.0;
        let run = |servo: &mut Servo, cycles: usize| -> i64 {
            (0..cycles)
                .map(|_| {
                    let setpoint = servo.velocity_setpoint(asked);
                    servo.step(setpoint, false)
                })
                .sum()
        };
        run(&mut servo, 3000);
        let counts = run(&mut servo, 1000);
        assert!((counts - 200_000).abs() < 200, "{counts}");
    }
}

/// The load lags by the twist of the shaft: 0.4 Nm at 100 Nm/rad are 4 mrad, 41.7 counts.
#[test]
fn an_encoder_at_the_load_reads_the_twist() {
    let mut data = motor();
    data.coupling = Some(Coupling { stiffness: 100.0, damping: 0.05, backlash: 0.0 });
    data.load.torque = -0.4;
    let mut servo = servo(data);
    assert_eq!(servo.load(), -42);
    assert_eq!(servo.step(0.0, true), 0);
    assert_eq!(servo.load(), -42);
}

/// A weight makes the train fall with 1000 rad/s^2, whatever other torque there is.
#[test]
fn attached_weight_falls_with_given_acceleration() {
    let mut servo = servo(motor());
    // A previous weight has no effect.
    servo.attach_weight(5.0);
    servo.attach_weight(-1000.0 * 65_536.0 / TAU);
    let counts: i64 = (0..100).map(|_| servo.step(0.0, false)).sum();
    assert_eq!(counts, -52_152);
    servo.rest();
    assert_eq!(servo.step(0.5, false), 0);
}

#[test]
fn data_outside_their_ranges_are_refused_by_name() {
    let refused = |change: fn(&mut MotorData)| {
        let mut data = motor();
        change(&mut data);
        Motor::new(data).unwrap_err().to_string()
    };
    assert_eq!(
        refused(|data| data.inertia = 0.0),
        "inertia is 0 kg*m^2; 0.000000001 kg*m^2 to 1000000 kg*m^2 is allowed"
    );
    assert_eq!(refused(|data| data.friction.coulomb = 0.5), "static_friction is 0 Nm; 0.5 Nm to 1000000 Nm is allowed");
    assert_eq!(
        refused(|data| data.amplifier.dead_time_ns = -1),
        "dead_time is -0.000001 ms; 0 ms to 1000 ms is allowed"
    );
    assert!(refused(|data| data.load.torque = f64::NAN).starts_with("load_torque is NaN Nm"));
    assert!(refused(|data| data.reading.counts_per_turn = f64::INFINITY).starts_with("counts_per_turn is inf inc"));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    /// For any setpoint, the motor has a finite angle and velocity, and a torque within its limit.
    #[test]
    fn any_setpoint_keeps_state_finite(asked in prop::collection::vec((any::<f64>(), any::<bool>(), any::<bool>()), 1..40)) {
        let friction = Friction { viscous: 1e-3, coulomb: 0.05, holding: 0.08 };
        let mut data = MotorData { friction, ..motor() };
        data.coupling = Some(Coupling { stiffness: 300.0, damping: 0.05, backlash: 0.01 });
        data.amplifier.dead_time_ns = 300_000;
        data.reading.noise = 2.0;
        let mut servo = servo(data);
        for (asked, closes, held) in asked {
            let setpoint = if closes { servo.velocity_setpoint(asked) } else { asked };
            servo.step(setpoint, held);
            servo.read();
            let velocity = servo.train.velocity(&servo.state);
            prop_assert!(servo.sum.is_finite() && velocity.is_finite() && servo.encoder.part.is_finite());
            prop_assert!(servo.train.twist(&servo.state).is_finite() && servo.effort().abs() <= 3000.0);
            prop_assert!((0.0..=1.0).contains(&servo.encoder.part));
        }
    }
}

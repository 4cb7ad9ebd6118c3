//! Position of the load: behind a screw of this test, and behind the coupling of a simulated motor.

use super::*;
use crate::sim::{Amplifier, Coupling, Fixtures, Friction, Load, Motor, MotorData, Reading, Stage};

/// A nut with play on a screw with errors: it stands still until a flank moves it.
struct Screw {
    /// Travel of the motor before the nut follows it back (inc).
    play: i64,
    nut: i64,
}

impl Screw {
    fn follow(&mut self, motor: i64) {
        self.nut = self.nut.clamp(motor, motor + self.play);
    }
}

/// Returns the linear interpolation of the points as a real number.
fn error_at(points: &[(i64, i64)], place: i64) -> f64 {
    let pair = points.windows(2).find(|pair| (pair[0].0..=pair[1].0).contains(&place));
    let Some(&[(x, y), (to_x, to_y)]) = pair else { return 0.0 };
    y as f64 + (to_y - y) as f64 * (place - x) as f64 / (to_x - x) as f64
}

/// Homes by the switch, then moves to positions from both sides. Returns the deviations of the load there (inc), behind
/// a screw with these errors.
fn off(config: MachineConfig, method: i8) -> Vec<f64> {
    let mut rig = Rig::with(config, [Model::Ideal, Model::Ideal]);
    let home = Some((-500, 500));
    rig.plant.drive(0).unwrap().install_fixtures(Fixtures { start: -8_000, home, ..Fixtures::default() });
    let mut screw = Screw { play: BACKLASH, nut: 0 };
    rig.enable();
    let goal = rig.give(Action::HomeAxis(HomeAxis { axis: X, method: HomingMethod::Cia402(method) }));
    let mut run = |rig: &mut Rig, goal: u64| {
        for _ in 0..60_000 {
            if rig.done(goal).len() == 1 {
                break;
            }
            rig.run(1);
            screw.follow(rig.int("x.actual.count"));
        }
        for _ in 0..60 {
            rig.run(1);
            screw.follow(rig.int("x.actual.count"));
        }
        assert_eq!((rig.done(goal).len(), rig.done(goal)[0].code, rig.int("x.error")), (1, Code::NONE, 0));
        screw.nut
    };
    run(&mut rig, goal);
    assert_eq!(rig.int("x.homed"), 1);
    // Motor position at the reference; approached downwards, the nut was on its other flank.
    let zero = rig.int("x.actual.count") - compensation(&rig) - rig.int("x.actual.position");
    let goes_down = method == 19;
    let zero = if goes_down { zero + BACKLASH } else { zero };
    let targets = [10_000, 20_000, 15_000, 35_000, 20_000, 10_000, 60_000, 50_000, 0, 5_000];
    let off = |target: i64| {
        let goal = rig.give(Action::Move(to(X, target)));
        let place = run(&mut rig, goal) - zero;
        place as f64 - target as f64 - error_at(&PITCH, target)
    };
    targets.map(off).into()
}

/// Reference found upwards (20) and downwards (19), with delays: the load is at the command, within the rounding of its
/// increments.
///
/// Proves: WF-INC-04
#[test]
fn load_reaches_command_from_either_side() {
    for (method, delay) in [(20, 0), (19, 0), (20, 3), (19, 3)] {
        let off = off(cell(delay, BACKLASH, Some(&PITCH)), method);
        assert!(off.iter().all(|off| off.abs() <= 1.0), "method {method}: {off:?}");
    }
}

/// Without compensation the load deviates by the pitch error and, from the other side, by the backlash.
#[test]
fn without_compensation_the_load_is_off() {
    let off = off(cell(0, 0, None), 20);
    let expected = [-30.0, -60.0, -45.0 + 40.0, -30.0, -60.0 + 40.0, -30.0 + 40.0, 12.5, 40.0, 40.0, -15.0];
    assert_eq!(off, expected);
}

/// 0.04 rad are 400 inc at 10000 inc per radian. The load has friction, so it stays where a flank has moved it.
fn motor(at_load: bool) -> Model {
    Model::Motor(
        Motor::new(MotorData {
            inertia: 2.5e-4,
            friction: Friction { viscous: 1e-3, ..Friction::default() },
            load: Load {
                inertia: 2.5e-4,
                friction: Friction { viscous: 0.0, coulomb: 0.1, holding: 0.1 },
                torque: 0.0,
            },
            coupling: Some(Coupling { stiffness: 4_000.0, damping: 0.5, backlash: 0.04 }),
            amplifier: Amplifier { stage: Stage::Torque { rated: 1.0, lag_ns: 0 }, limit: 3.0, dead_time_ns: 0 },
            reading: Reading { counts_per_turn: 62_831.853_071_795_86, noise: 0.0, seed: 1, at_load },
        })
        .unwrap(),
    )
}

/// Returns the deviations of the load at positions that are approached from both sides; the encoder is on the motor.
fn off_behind_motor(interface: Interface, backlash: i64, is_turned: bool) -> Vec<i64> {
    let mut config = cell(0, backlash, None);
    let axis = &mut config.axes[1];
    axis.interface = interface;
    axis.parameters.max_following_error = 20_000;
    axis.parameters.compensation.velocity = Some(4_000.0);
    axis.parameters.default_acceleration = Some(200_000.0);
    axis.parameters.in_position_window = 5;
    axis.parameters.in_position_time = 100_000_000;
    if interface == Interface::Torque {
        axis.law = crate::regulator::Law::Pid;
        axis.parameters.amplifier.max_effort = Some(1000.0);
        axis.parameters.pid.velocity = 1000;
    }
    if is_turned {
        axis.parameters.macs.posdrct = -1;
    }
    let mut rig = Rig::with(config, [motor(false), Model::Ideal]);
    rig.enable();
    let reach = |rig: &mut Rig, target: i64| {
        let goal = rig.give(Action::Move(to(X, target)));
        rig.run(2_500);
        assert_eq!((rig.done(goal).len(), rig.int("x.error")), (1, 0), "{target}");
        rig.plant.drive(0).unwrap().load_place()
    };
    // The zero is set against a flank.
    let zero = reach(&mut rig, 3_000);
    home(&mut rig, 35);
    rig.mirror();
    let sign = if is_turned { -1 } else { 1 };
    [10_000, 20_000, 12_000, 5_000, 12_000, 0].map(|target| sign * (reach(&mut rig, target) - zero) - target).into()
}

/// Within 2 inc with compensation; without it 400 inc off from the other side. With interface torque the loops of the
/// core compensate their setpoints.
///
/// Proves: WF-INC-04
#[test]
fn load_after_backlash_reaches_command() {
    for (interface, is_turned) in
        [(Interface::Velocity, false), (Interface::Velocity, true), (Interface::Torque, false)]
    {
        let off = off_behind_motor(interface, 400, is_turned);
        assert!(off.iter().all(|off| off.abs() <= 2), "{interface:?}: {off:?}");
        let off = off_behind_motor(interface, 0, is_turned);
        for (off, expected) in off.iter().zip([0, 0, 400, 400, 0, 400]) {
            assert!((off - expected).abs() <= 2, "{interface:?}: {off}, {expected}");
        }
    }
}

/// With the encoder on the load the backlash is inside the loop: nothing has to be compensated, and the axis is at its
/// command.
///
/// Proves: WF-INC-04
#[test]
fn with_its_encoder_on_the_load_the_gap_is_inside_the_loop() {
    let mut config = cell(0, 0, None);
    let axis = &mut config.axes[1];
    (axis.interface, axis.wired) = (Interface::Velocity, Wired::Encoder(0));
    axis.parameters.max_following_error = 20_000;
    axis.parameters.default_acceleration = Some(200_000.0);
    let mut rig = Rig::with(config, [motor(true), Model::Ideal]);
    rig.enable();
    let mut motors = Vec::new();
    for target in [10_000, 20_000, 12_000, 5_000, 12_000] {
        rig.give(Action::Move(to(X, target)));
        rig.run(6_000);
        let load = rig.plant.drive(0).unwrap().load_place();
        assert!((load - target).abs() <= 2 && (rig.int("x.actual.position") - target).abs() <= 2, "{target}: {load}");
        motors.push(rig.inputs().drive[0].count - load);
    }
    // From one flank to the other.
    assert!((motors[1] - motors[2] - 400).abs() <= 4 && (motors[4] - motors[3] - 400).abs() <= 4, "{motors:?}");
}

//! Tests of masters against properties that hold for each machine.

use super::*;
use crate::surface::parameters::fake;
use lineshaft_core::command::{Action, Command, Commands, Source};
use lineshaft_core::config::{EncoderConfig, SumConfig};
use lineshaft_core::encoder::Form;
use lineshaft_core::machine::Machine;
use lineshaft_core::parameter::{Change, MACHINE, Row, Value};
use lineshaft_core::unit::{Fraction, Quantity, Scale, Unit};
use lineshaft_msgs::action::{MoveAxis, MoveAxisGoal};
use proptest::prelude::*;

use crate::surface::goal::GoalAction;

/// 1000 inc/mm.
const PER_MM: i128 = 1_000;
/// One increment, in units of 2^-32 inc.
const ONE: i128 = 1 << 32;

/// Returns a machine with a belt in the scale of virtual axis line, and a wheel of 4096 inc per turn.
fn config() -> MachineConfig {
    let turn = Quantity::new(Fraction::from_integer(1), Unit::REVOLUTION);
    let wheel = Scale::new(Fraction::from_integer(4096), turn).expect("a sound scale");
    let config = fake::config();
    let belt = config.axes[0].scale;
    let encoder =
        |name: &str, scale| EncoderConfig { name: name.to_owned(), form: Form::Incremental(64), check: None, scale };
    let master = |name: &str, add, subtract| SumConfig { name: name.to_owned(), add, subtract };
    let [belt_of, wheel_of, line] = [Leader::Encoder(0), Leader::Encoder(1), Leader::AxisCommand(0)];
    MachineConfig {
        encoders: vec![encoder("belt", belt), encoder("wheel", wheel)],
        masters: vec![master("both", vec![belt_of], vec![line]), master("mixed", vec![wheel_of, line], vec![])],
        ..config
    }
}

/// A machine with commands in its first cycle, and its views.
struct Shaft {
    machine: Machine,
    views: Vec<LeaderView>,
    cycle: u64,
}

impl Shaft {
    fn new() -> Self {
        let machine = Machine::new(config()).expect("a sound machine");
        let views = LeaderView::all(machine.config(), machine.directory());
        Self { machine, views, cycle: 0 }
    }

    /// Runs one more cycle with these counts. Returns the masters after it.
    fn cycle(&mut self, counts: [Option<i64>; 2], actions: Vec<Action>) -> ShaftStates {
        let (mut inputs, mut outputs) = (self.machine.inputs(), self.machine.outputs());
        inputs.cycle = self.cycle;
        for (input, count) in inputs.encoder.iter_mut().zip(counts) {
            (input.count, input.valid) = (count.unwrap_or(0), count.is_some());
        }
        let commands: Vec<_> =
            (1..).zip(actions).map(|(sequence, action)| Command { sequence, source: Source::Ros, action }).collect();
        self.machine.cycle(&inputs, Commands::queue(&commands), &mut outputs);
        self.cycle += 1;
        shaft_states(&self.views, self.machine.board(), self.cycle - 1, 1_000_000 * (self.cycle - 1))
    }
}

/// Returns commands that move line at a velocity in mm/s, and the virtual master at a velocity in inc/s.
fn run(velocity: f64, pulses: i64) -> Vec<Action> {
    let goal = MoveAxisGoal {
        axis: "line".to_owned(),
        mode: MoveAxisGoal::VELOCITY,
        velocity: velocity / 1e3,
        ..MoveAxisGoal::default()
    };
    let (_, moves) = MoveAxis::resolve(&config(), &goal).expect("a goal of the cell");
    let change = |(key, value)| {
        let (row, _) = Row::find(key).expect("a row");
        Change { axis: MACHINE, row, value: Value::Int(value) }
    };
    vec![moves, Action::SetParameters([("pulsacc", -1), ("setsys_15", pulses)].map(change).into())]
}

/// Returns the position in units of 2^-32 inc.
fn raw(state: &LeaderState) -> i128 {
    i128::from(state.position_increments) * ONE + (state.fraction * ONE as f64) as i128
}

#[test]
fn all_masters_are_published_in_order() {
    let mut shaft = Shaft::new();
    let told = shaft.cycle([Some(5), Some(7)], vec![]);
    let names: Vec<_> = told.leaders.iter().map(|leader| (leader.name.as_str(), leader.has_scale)).collect();
    // x has a drive and is not published. A sum of different scales has no scale, nor has the virtual master.
    let expected =
        [("belt", true), ("wheel", true), ("line", true), ("both", true), ("mixed", false), ("machine.vmaster", false)];
    assert_eq!(names, expected);
    let told = shaft.cycle([Some(5), Some(7)], vec![]);
    assert_eq!((told.cycle, told.header.stamp.nanosec, told.header.frame_id.as_str()), (1, 1_000_000, ""));
}

/// 333 inc/s are 0.333 inc per cycle. The belt moves 3 inc per cycle, which is 3000 inc/s and 3 m/s. The wheel makes one turn per second,
/// which is 2 pi rad/s.
#[test]
fn each_leader_has_its_units() {
    let mut shaft = Shaft::new();
    let _ = shaft.cycle([Some(0), Some(0)], run(0.0, 333));
    for k in 1..=9 {
        let told = shaft.cycle([Some(3 * k), Some(4 * k)], vec![]);
        let [belt, wheel, line, both, mixed, virtual_master] = &told.leaders[..] else { panic!("{told:?}") };
        assert!(told.leaders.iter().all(|leader| leader.valid));
        assert_eq!((belt.position_increments, belt.fraction, belt.velocity_increments), (3 * k, 0.0, 3_000.0));
        assert_eq!((belt.position, belt.velocity), ((3 * k) as f64 / 1e6, 3e-3), "in m");
        assert_eq!(wheel.velocity, 4_000.0 / 4_096.0 * std::f64::consts::TAU);
        assert_eq!((raw(line), line.velocity), (0, 0.0));
        assert_eq!((both.position, both.velocity), (belt.position, belt.velocity));
        assert_eq!((mixed.position, mixed.velocity, mixed.velocity_increments), (0.0, 0.0, 4_000.0));
        assert_eq!(mixed.position_increments, 4 * k);
        // Counted from cycle 0, rounded down.
        assert_eq!(raw(virtual_master), i128::from(k + 1) * 333 * ONE / 1_000);
        assert_eq!((virtual_master.position, virtual_master.velocity_increments), (0.0, 333.0));
    }
}

/// The position stays, and all sums that depend on the encoder become invalid.
#[test]
fn lost_encoder_invalidates_sums() {
    let mut shaft = Shaft::new();
    let _ = shaft.cycle([Some(0), Some(0)], vec![]);
    let _ = shaft.cycle([Some(9), Some(0)], vec![]);
    let told = shaft.cycle([None, Some(0)], vec![]);
    let valid: Vec<_> = told.leaders.iter().map(|leader| leader.valid).collect();
    assert_eq!(valid, [false, true, true, false, true, true]);
    assert_eq!((told.leaders[0].position_increments, told.leaders[0].velocity), (9, 0.0));
    let back = shaft.cycle([Some(9), Some(0)], vec![]);
    assert!(back.leaders[0].valid && back.leaders[3].valid);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// Sums equal those of their members to the last unit, and m equals increments divided by the scale, in each cycle.
    #[test]
    fn increments_are_exact(
        ways in prop::collection::vec((-30_i64..30, -30_i64..30), 1..60),
        velocity in -900.0..900.0_f64,
        pulses in -1_000_000_i64..1_000_000,
    ) {
        let mut shaft = Shaft::new();
        let (mut counts, mut actions) = ([0, 0], run(velocity, pulses));
        for (k, (belt, wheel)) in (1..).zip(ways) {
            (counts[0], counts[1]) = (counts[0] + belt, counts[1] + wheel);
            let told = shaft.cycle(counts.map(Some), std::mem::take(&mut actions));
            let [belt, wheel, line, both, mixed, virtual_master] = &told.leaders[..] else { panic!("{told:?}") };
            prop_assert_eq!([belt, wheel].map(|of| of.position_increments), counts);
            prop_assert_eq!(raw(both), raw(belt) - raw(line));
            prop_assert_eq!(raw(mixed), raw(wheel) + raw(line));
            prop_assert_eq!(raw(virtual_master), (i128::from(pulses) * k * ONE).div_euclid(1_000));
            for leader in &told.leaders {
                prop_assert!((0.0..1.0).contains(&leader.fraction), "{:?}", leader);
            }
            let metres = raw(line) as f64 / ONE as f64 / (PER_MM * 1_000) as f64;
            prop_assert!((line.position - metres).abs() <= 1e-15, "{} {metres}", line.position);
        }
    }
}

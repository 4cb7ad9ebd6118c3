//! Properties that must hold for any goal: it is refused with a short message, or the motion stays within the limits.

use lineshaft_core::command::{Action, Command, Commands, Source};
use lineshaft_core::config::{AxisConfig, IoConfig, IoKind, MachineConfig, SinkConfig, SlotConfig};
use lineshaft_core::event::Kind as EventKind;
use lineshaft_core::function::Kind;
use lineshaft_core::machine::Machine;
use lineshaft_core::parameter::AxisParameters;
use lineshaft_core::unit::{Fraction, Quantity, Scale, Unit};
use lineshaft_msgs::action::{
    HomeAxis, MoveAxis, Phase, ProbeAxis, RunFunction, Synchronize, SynchronizeGoal, TuneGoal,
};
use lineshaft_msgs::cdr::{Endian, decode};

use super::goal::GoalAction;
use crate::fuzz::LONGEST_SENTENCE;

/// Limits of both axes, in inc/s and inc/s^2.
const VELOCITY: f64 = 1_000_000.0;
const ACCELERATION: f64 = 5_000_000.0;

/// Returns a machine with two axes without a motor, which are always enabled and execute all commands.
fn config() -> MachineConfig {
    let per = Quantity::new(Fraction::from_integer(1), Unit::MILLIMETRE);
    let scale = Scale::new(Fraction::from_integer(1000), per).and_then(|scale| scale.with_unit(Unit::MILLIMETRE));
    let scale = scale.expect("a sound scale");
    let parameters = AxisParameters::new(VELOCITY, ACCELERATION);
    let axis = |name: &str| AxisConfig::new(name.to_owned(), scale, None, parameters);
    MachineConfig {
        cycle_ns: 1_000_000,
        io: vec![IoConfig { name: "mark".to_owned(), kind: IoKind::DigitalInput, latch: true }],
        axes: vec![axis("line"), axis("x")],
        slots: vec![indexer()],
        ..MachineConfig::default()
    }
}

/// Returns a function slot that moves x by commands.
fn indexer() -> SlotConfig {
    let mut slot = SlotConfig::new("index".to_owned(), 0, Kind::Epos);
    slot.sink = SinkConfig::Axis(1);
    let values = [("travel", 900), ("velocity", 1_000_000), ("acceleration", 20_000), ("stop_decel", 20_000)];
    for (name, value) in values.into_iter().chain([("drive_resolution", 20_000)]) {
        let place = slot.kind.description().find(name).map(|(_, place)| place);
        if let Some(field) = place.and_then(|place| slot.values.get_mut(place)) {
            *field = value;
        }
    }
    slot
}

/// Checks the properties. The first byte selects the action; the others are the serialized goal.
///
/// # Panics
/// A property does not hold.
pub fn any_goal(bytes: &[u8]) {
    let [kind, bytes @ ..] = bytes else { return };
    match kind % 7 {
        0 => law::<MoveAxis>(bytes),
        1 => law::<ProbeAxis>(bytes),
        2 => law::<Synchronize>(bytes),
        3 => law::<Phase>(bytes),
        4 => law::<RunFunction>(bytes),
        5 => tune_law(bytes),
        _ => law::<HomeAxis>(bytes),
    }
}

/// A tuning goal is refused, or its settings are finite numbers.
fn tune_law(bytes: &[u8]) {
    let goal = match decode::<TuneGoal>(bytes, Endian::Little) {
        Ok(goal) => goal,
        Err(error) => return assert!(error.to_string().len() < LONGEST_SENTENCE, "{error}"),
    };
    match super::tune::tune_order(&config(), &goal) {
        Err(error) => assert!(error.to_string().len() < LONGEST_SENTENCE, "{error}"),
        Ok(order) => {
            assert!(order.axis < 2 && [order.travel, order.velocity].iter().flatten().all(|value| value.is_finite()));
        }
    }
}

fn law<A: GoalAction>(bytes: &[u8]) {
    let goal = match decode::<A::Goal>(bytes, Endian::Little) {
        Ok(goal) => goal,
        Err(error) => return assert!(error.to_string().len() < LONGEST_SENTENCE, "{error}"),
    };
    match A::resolve(&config(), &goal) {
        Err(error) => assert!(error.to_string().len() < LONGEST_SENTENCE, "{error}"),
        Ok((_, action)) => moved(action),
    }
}

/// Checks that the machine refuses the command and stays at rest, or moves within its limits.
fn moved(action: Action) {
    let mut machine = Machine::new(config()).expect("a sound machine");
    let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
    // Without a master there is no phase to be shifted.
    let coupled = SynchronizeGoal {
        axis: "x".to_owned(),
        master: "line".to_owned(),
        mode: SynchronizeGoal::POSITION,
        numerator: 1,
        denominator: 1,
        ..SynchronizeGoal::default()
    };
    let coupling = matches!(action, Action::Phase(_)).then(|| Synchronize::resolve(machine.config(), &coupled));
    let coupling = coupling.map(|resolved| resolved.expect("a coupling of the cell").1);
    let actions = coupling.into_iter().chain([action]);
    let queue: Vec<_> =
        (1..).zip(actions).map(|(sequence, action)| Command { sequence, source: Source::Ros, action }).collect();
    let (mut refused, mut commands) = (false, Commands::queue(&queue));
    for cycle in 0..60 {
        inputs.cycle = cycle;
        machine.cycle(&inputs, commands, &mut outputs);
        commands = Commands::default();
        refused |= machine.events().iter().any(|event| event.kind == EventKind::Refused);
        for axis in ["line", "x"] {
            let find =
                |name| machine.directory().find(&format!("{axis}.command.{name}")).expect("a signal of every axis");
            let position = machine.board().int(find("position"));
            let velocity = machine.board().real(find("velocity"));
            assert!(position.unsigned_abs() < 1 << 62, "{position}");
            assert!(velocity.abs() <= VELOCITY * (1.0 + 1e-9), "{velocity}");
            assert!(!refused || (position == 0 && velocity == 0.0), "refused, and yet it moves");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_msgs::action::{MoveAxisGoal, PhaseGoal, ProbeAxisGoal};
    use lineshaft_msgs::cdr::encode;
    use proptest::prelude::*;

    /// Generates numbers that clients send by mistake, and valid ones.
    fn number() -> impl Strategy<Value = f64> {
        let special = vec![
            0.0,
            -0.0,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MAX,
            f64::MIN,
            f64::MIN_POSITIVE,
            1e-300,
            1e15,
            4.7e15,
            -4.7e15,
            9.3e15,
        ];
        prop_oneof![2 => prop::sample::select(special), 3 => -2.0..2.0_f64, 1 => any::<f64>()]
    }

    fn axis() -> impl Strategy<Value = String> {
        prop_oneof![6 => Just("x".to_owned()), 2 => Just("line".to_owned()), 1 => "[a-z.]{0,40}", 1 => Just("x".repeat(10_000))]
    }

    fn choice() -> impl Strategy<Value = u8> {
        prop_oneof![8 => 0..6_u8, 1 => any::<u8>()]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1500))]

        #[test]
        fn any_bytes_are_no_harm(bytes in prop::collection::vec(any::<u8>(), 0..150)) {
            any_goal(&bytes);
        }

        #[test]
        fn any_positioning_is_refused_or_within_the_limits(
            axis in axis(), mode in choice(), units in 0..4_u8, buffer_mode in choice(), direction in choice(),
            numbers in prop::array::uniform5(number()),
        ) {
            let [position, velocity, acceleration, deceleration, jerk] = numbers;
            let goal = MoveAxisGoal {
                axis, mode, units, position, velocity, acceleration, deceleration, jerk, buffer_mode, direction,
            };
            any_goal(&[&[0], encode(&goal).as_slice()].concat());
            let MoveAxisGoal { axis, .. } = goal;
            let probe = ProbeAxisGoal {
                axis, mode, units, position, velocity, acceleration, deceleration, jerk, event: "mark".to_owned(), edge: direction,
                distance: position,
            };
            any_goal(&[&[1], encode(&probe).as_slice()].concat());
            let ProbeAxisGoal { axis, .. } = probe;
            let (travel, effort, duration) = (position, acceleration, deceleration);
            let tune = TuneGoal { axis, units, travel, velocity, effort, duration, inertia_ratio: effort, real: false, apply: false };
            any_goal(&[&[5], encode(&tune).as_slice()].concat());
        }

        #[test]
        fn any_phase_is_refused_or_within_the_limits(
            axis in axis(), side in 0..3_u8, numbers in prop::array::uniform3(number()),
        ) {
            let [shift, velocity, acceleration] = numbers;
            let goal = PhaseGoal { axis, side, shift, velocity, acceleration };
            any_goal(&[&[3], encode(&goal).as_slice()].concat());
        }

        #[test]
        fn any_coupling_is_refused_or_within_the_limits(
            axis in axis(), master in axis(), mode in 0..4_u8, disengage in 0..3_u8, numerator: i64, denominator: i64,
            small in prop::option::of((-9..9_i64, -9..9_i64)), numbers in prop::array::uniform3(number()),
            engage in 0..4_u8, places in prop::array::uniform3(-9_000..9_000_i64), has_offset: bool,
        ) {
            let (numerator, denominator) = small.unwrap_or((numerator, denominator));
            let [offset, velocity, acceleration] = numbers;
            let [master_increments, slave_increments, start_distance_increments] =
                if engage == 1 { places } else { [0; 3] };
            let (offset, event) = (if has_offset { offset } else { 0.0 }, String::from(if engage == 2 { "x" } else { "" }));
            let goal = SynchronizeGoal {
                axis, master, event, mode, engage, disengage, numerator, denominator, offset, velocity, acceleration,
                master_increments, slave_increments, start_distance_increments,
                ..SynchronizeGoal::default()
            };
            any_goal(&[&[2], encode(&goal).as_slice()].concat());
        }
    }
}

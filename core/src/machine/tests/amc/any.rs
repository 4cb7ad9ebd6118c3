//! Random writes, goals, stops and events in any order.

use super::{MARK, Rig, X, Y, changes, latch, wired};
use crate::command::{Action, Move, MoveMode};
use crate::event::Kind;
use crate::machine::tests::rig::{LINE, at, couple, to};
use crate::modulo::Modulo;
use crate::object::{AxisSet, Leader};
use crate::text::message;
use proptest::prelude::*;

#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "a test has few of them")]
enum RandomEvent {
    Set(u16, Vec<(&'static str, i64)>),
    Goal(Action),
    Latch(u32),
    Belt(i64),
    Slip(usize, i64),
    Fault(usize),
    Mirror,
    Cycles(u64),
}

fn value() -> impl Strategy<Value = (&'static str, i64)> {
    let reference = prop_oneof![-359_i64..360, -60_000_i64..60_000, Just(1 << 40), Just(-(1 << 61))];
    prop_oneof![
        4 => (0_i64..9).prop_map(|select| ("reference_select", select)),
        1 => (0_i64..9).prop_map(|select| ("reference_select_trigger", select)),
        4 => reference.prop_map(|reference| ("position_reference", reference)),
        2 => (-1_i64..8).prop_map(|mode| ("rotary_mode", mode)),
        2 => (-110_000_i64..110_000).prop_map(|speed| ("speed_reference", speed)),
        1 => prop::sample::select(&[0_i64, 2][..]).prop_map(|mode| ("stop_mode", mode)),
        1 => (0_i64..3).prop_map(|action| ("action_on_event", action)),
        1 => (0_i64..5).prop_map(|point| ("cam_start_index", point)),
        1 => (0_i64..250).prop_map(|behind| ("cam_start_position", behind)),
        1 => (0_i64..100).prop_map(|window| ("following_error_window", window)),
    ]
}

fn goal() -> impl Strategy<Value = Action> {
    let axis = || prop::sample::select(&[LINE, X, Y][..]);
    let set = || axis().prop_map(AxisSet::one);
    prop_oneof![
        2 => (axis(), -15_000_i64..45_000).prop_map(|(axis, target)| {
            Action::Move(Move { mode: MoveMode::Absolute, ..to(axis, target) })
        }),
        2 => (axis(), -60_000.0..60_000.0_f64).prop_map(|(axis, velocity)| Action::Move(at(axis, velocity))),
        1 => (axis(), axis()).prop_map(|(axis, leader)| {
            Action::Synchronize(couple(axis, Leader::AxisCommand(leader), 1, 1))
        }),
        1 => set().prop_map(Action::Halt),
        1 => set().prop_map(Action::QuickStop),
        2 => set().prop_map(Action::ResetErrors),
        1 => set().prop_map(Action::Disable),
        3 => set().prop_map(Action::Enable),
    ]
}

fn random_event() -> impl Strategy<Value = RandomEvent> {
    let set = (prop::sample::select(&[X, Y][..]), prop::collection::vec(value(), 1..4));
    prop_oneof![
        10 => set.prop_map(|(axis, values)| RandomEvent::Set(axis, values)),
        3 => goal().prop_map(RandomEvent::Goal),
        1 => (0_u32..1_000_000).prop_map(RandomEvent::Latch),
        1 => (-40_i64..40).prop_map(RandomEvent::Belt),
        1 => (0_usize..2, -60_i64..60).prop_map(|(drive, by)| RandomEvent::Slip(drive, by)),
        1 => (0_usize..2).prop_map(RandomEvent::Fault),
        1 => Just(RandomEvent::Mirror),
        10 => (0_u64..60).prop_map(RandomEvent::Cycles),
    ]
}

/// Returns position and velocity of an axis that is switched on and not coupled.
fn motion(rig: &Rig, name: &str) -> Option<(f64, f64)> {
    let free = rig.int(&format!("{name}.enabled")) == 1 && rig.state(name) != "SYNCHRONIZED_MOTION";
    let whole = rig.int(&format!("{name}.command.position")) as f64;
    let position = whole + rig.real(&format!("{name}.command.fraction"));
    free.then(|| (position, rig.real(&format!("{name}.command.velocity"))))
}

fn check(rig: &Rig, before: &[Option<(f64, f64)>; 2]) -> Result<(), TestCaseError> {
    for ((axis, name), before) in [(X, "x"), (Y, "y")].into_iter().zip(before) {
        let int = |signal: &str| rig.int(&format!("{name}.{signal}"));
        let (select, active) = (int("amc.select"), int("amc.active"));
        prop_assert!(select == 0 || active == 1, "{} refers to {} and is not active", name, select);
        prop_assert!(int("enabled") == 1 || select == 0);
        let written = rig.machine.parameters(axis).unwrap().vocabularies.amc.reference_select;
        prop_assert!(written != 5, "{}", written);
        if int("enabled") == 1 && rig.state(name) != "STOPPING" && select != 0 {
            prop_assert_eq!(select, written);
        }
        let is_moving_by_itself = select != 0 && active == 1;
        prop_assert!(!is_moving_by_itself || !["ERROR_STOP", "STOPPING"].contains(&rig.state(name)));
        let (Some(now), Some(before)) = (motion(rig, name), *before) else { continue };
        // 1e6 inc/s^2 in a cycle; a stop may end between two increments.
        let change = (now.1 - before.1).abs();
        // A coupled axis that reaches a software limit stops in whole steps, which is an error.
        prop_assert!(
            change <= 1_001.0 || rig.state(name) == "ERROR_STOP",
            "{} changes its velocity by {}",
            name,
            change
        );
        let way = (now.0 - before.0) - 0.5 * (now.1 + before.1) * 0.001;
        prop_assert!(way.abs() <= 1.6, "{} jumps by {}", name, way);
        prop_assert!(now.1.abs() <= 100_001.0, "{} runs at {}", name, now.1);
    }
    let shown = rig.int("x.amc.profile_input_position");
    prop_assert!((0..361).contains(&shown) && (0..361).contains(&rig.int("x.amc.stop_reference")), "{}", shown);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Proves: AMC-POS-01, AMC-SEL-09
    #[test]
    fn selector_makes_no_velocity_step_and_ends_at_rest(
        is_fraction in any::<bool>(), happenings in prop::collection::vec(random_event(), 1..60),
    ) {
        let mut config = wired();
        if is_fraction {
            config.axes[usize::from(X)].modulo = Modulo::new(1081, 3);
        }
        let mut rig = Rig::of(config);
        rig.enable();
        let mut before = [None; 2];
        for happening in happenings {
            match happening {
                RandomEvent::Set(axis, values) => drop(rig.give(changes(axis, &values))),
                RandomEvent::Goal(action) => drop(rig.give(action)),
                RandomEvent::Latch(age) => drop(rig.plant.add_latch(latch(MARK, age, None))),
                RandomEvent::Belt(by) => rig.plant.jump_encoder(0, by),
                RandomEvent::Slip(drive, by) => rig.plant.drive(drive).unwrap().jump(by),
                RandomEvent::Fault(drive) => rig.plant.drive(drive).unwrap().inject_fault(0x8611),
                RandomEvent::Mirror => rig.mirror(),
                RandomEvent::Cycles(count) => {
                    for _ in 0..count {
                        rig.run(1);
                        check(&rig, &before)?;
                        before = [motion(&rig, "x"), motion(&rig, "y")];
                    }
                }
            }
            check(&rig, &[None; 2])?;
            before = [motion(&rig, "x"), motion(&rig, "y")];
        }
        for axis in [X, Y] {
            rig.give(changes(axis, &[("reference_select", 0), ("action_on_event", 0)]));
        }
        rig.give(Action::Halt(AxisSet::first(3)));
        rig.run(500);
        for name in ["x", "y"] {
            prop_assert_eq!(rig.int(&format!("{name}.amc.select")), 0);
            prop_assert_eq!(rig.real(&format!("{name}.command.velocity")), 0.0, "{} moves without a goal", name);
            if rig.state(name) == "STANDSTILL" {
                prop_assert_eq!(rig.real(&format!("{name}.command.fraction")), 0.0);
            }
        }
        let end = rig.int("y.command.position");
        let was_coupled = rig.events.iter().any(|event| event.kind == Kind::Error);
        prop_assert!(was_coupled || (-20_000..=50_000).contains(&end), "{}", end);
        for event in &rig.events {
            prop_assert!(!message(event, rig.machine.config()).contains("code "));
        }
    }
}

//! Layers Init, User and Program: which values are in force at which time.

use super::rig::{LINE, Rig, X, Y, cases, config, parameters, to};
use crate::command::{Action, Command, Commands, Move, Source};
use crate::drive::Backend;
use crate::event::Kind;
use crate::machine::Machine;
use crate::object::AxisSet;
use crate::parameter::{AxisParameters, Change, Layer, Row, Value};
use crate::sim::{Model, Plant};
use proptest::prelude::*;

fn change(axis: u16, key: &str, value: Value) -> Change {
    Change { axis, row: Row::find(key).expect("the key of a row").0, value }
}

fn set(rig: &mut Rig, key: &str, value: Value) -> u64 {
    rig.give(Action::SetParameters([change(X, key, value)].into()))
}

fn all() -> AxisSet {
    AxisSet::first(3)
}

fn velocity(rig: &Rig) -> f64 {
    rig.machine.parameters(X).expect("x").max_velocity
}

/// Proves: MACS-STO-02, MACS-STO-04, MACS-STO-05, MACS-STO-06
#[test]
fn what_is_set_is_lost_with_the_power_and_what_is_saved_is_in_force_from_then_on() {
    let mut rig = Rig::new();
    set(&mut rig, "max_velocity", Value::Real(50_000.0));
    assert_eq!(velocity(&rig), 50_000.0);
    rig.give(Action::PowerCycle);
    assert_eq!(velocity(&rig), 100_000.0);
    set(&mut rig, "max_velocity", Value::Real(60_000.0));
    let saved = rig.give(Action::SaveParameters(all()));
    assert!(rig.was_accepted(saved));
    set(&mut rig, "max_velocity", Value::Real(70_000.0));
    rig.give(Action::PowerCycle);
    assert_eq!(velocity(&rig), 60_000.0);
}

/// Values in parts of VELRES are reported together with VELRES.
#[test]
fn share_above_velres_is_refused_with_velres() {
    let mut rig = Rig::new();
    for (key, part) in [("dfltvel", 100), ("dfltacc", 10_000)] {
        let lines = [change(X, key, Value::Int(part)), change(X, "velres", Value::Int(99))];
        let refused = rig.give(Action::SetParameters(lines.into()));
        assert_eq!(rig.refusal(refused), format!("x: {key} {part} must not exceed velres 99"));
    }
    set(&mut rig, "dfltvel", Value::Int(50));
    let refused = set(&mut rig, "velres", Value::Int(5));
    assert_eq!(rig.refusal(refused), "x: velres 5 must not be below dfltvel, dfltacc, home_vel or home_ramp 50");
}

/// A limit in terms of MACS is reported together with the other limit of MACS: in inverted units it is not a view of
/// its native limit.
#[test]
fn limits_of_macs_that_contradict_are_told_in_its_words() {
    for posdrct in [1, -1] {
        let mut rig = Rig::new();
        set(&mut rig, "posdrct", Value::Int(posdrct));
        let on =
            [("poslimit", 10), ("swneglimact", 1), ("swposlimact", 1)].map(|(key, n)| change(X, key, Value::Int(n)));
        let lines: Vec<Change> = std::iter::once(change(X, "neglimit", Value::Int(20))).chain(on).collect();
        let refused = rig.give(Action::SetParameters(lines.into()));
        let told = rig.refusal(refused);
        let expected = ["x: neglimit 20 must be below poslimit 10", "x: poslimit 10 must be above neglimit 20"];
        assert!(expected.contains(&told.as_str()), "posdrct {posdrct}: {told}");
    }
}

/// Two views of one value in a set: the result would depend on the order.
#[test]
fn a_set_that_gives_one_value_twice_is_refused_in_either_order() {
    let pairs = [
        (("velmax", Value::Real(3000.0)), ("max_velocity", Value::Real(50_000.0))),
        // The same number, but one remains constant when ENCODER changes and the other does not.
        (("velmax", Value::Real(3000.0)), ("max_velocity", Value::Real(100_000.0))),
        (("rampmin", Value::Int(500_000_000)), ("max_acceleration", Value::Real(300_000.0))),
        (("jerkmin", Value::Int(0)), ("max_jerk", Value::Real(1e6))),
        (("dfltvel", Value::Int(10)), ("default_velocity", Value::Unset)),
        (("swposlimact", Value::Int(0)), ("max_position", Value::Int(500))),
        (("poslimit", Value::Int(400)), ("max_position", Value::Int(500))),
        (("testwin", Value::Int(5)), ("in_position_window", Value::Int(6))),
        (("errcond", Value::Int(5)), ("errcond", Value::Int(4))),
    ];
    for (one, other) in pairs {
        for [first, second] in [[one, other], [other, one]] {
            let mut rig = Rig::new();
            let before = *rig.machine.parameters(X).expect("x");
            let lines = [change(X, first.0, first.1), change(X, second.0, second.1)];
            let refused = rig.give(Action::SetParameters(lines.into()));
            assert!(rig.refusal(refused).contains(" stands twice in the set: "), "{}", rig.refusal(refused));
            assert_eq!(rig.machine.parameters(X), Some(&before), "{first:?} {second:?}");
        }
    }
    // If both views give the same value, it makes no difference.
    let mut rig = Rig::new();
    let lines = [change(X, "testwin", Value::Int(5)), change(X, "in_position_window", Value::Int(5))];
    let taken = rig.give(Action::SetParameters(lines.into()));
    assert!(rig.was_accepted(taken));
}

/// Proves: MACS-STO-03, MACS-STO-05
#[test]
fn a_reset_drops_what_was_set_or_also_what_was_saved_which_stays_stored() {
    let mut rig = Rig::new();
    set(&mut rig, "max_velocity", Value::Real(60_000.0));
    rig.give(Action::SaveParameters(all()));
    set(&mut rig, "max_velocity", Value::Real(70_000.0));
    let user = rig.give(Action::ResetParameters { axes: all(), layer: Layer::User });
    assert_eq!(velocity(&rig), 60_000.0);
    let told: Vec<_> =
        rig.events.iter().filter(|event| event.command == user && event.kind == Kind::Parameter).collect();
    assert_eq!(told.len(), 1, "one value is another");
    assert_eq!(
        crate::text::message(told[0], rig.machine.config()),
        "x: max_velocity is 60 mm/s, effective with the next motion command"
    );
    rig.give(Action::ResetParameters { axes: all(), layer: Layer::Init });
    assert_eq!(velocity(&rig), 100_000.0);
    rig.give(Action::PowerCycle);
    assert_eq!(velocity(&rig), 60_000.0, "it was still saved");
    rig.give(Action::DeleteParameters(all()));
    assert_eq!(velocity(&rig), 100_000.0);
    rig.give(Action::PowerCycle);
    assert_eq!(velocity(&rig), 100_000.0, "nothing is saved");
}

#[test]
fn layers_are_those_of_the_axes_that_are_named() {
    let mut rig = Rig::new();
    let both = [X, Y].map(|axis| change(axis, "error_reaction", Value::Int(5)));
    rig.give(Action::SetParameters(both.into()));
    rig.give(Action::SaveParameters(AxisSet::one(Y)));
    rig.give(Action::ResetParameters { axes: AxisSet::one(X), layer: Layer::User });
    let reaction = |rig: &Rig, axis| rig.machine.parameters(axis).expect("an axis").error_reaction;
    assert_eq!((reaction(&rig, X), reaction(&rig, Y)), (2, 5));
    rig.give(Action::PowerCycle);
    assert_eq!((reaction(&rig, X), reaction(&rig, Y)), (2, 5));
    let unknown = rig.give(Action::SaveParameters(AxisSet::one(7)));
    assert!(!rig.refusal(unknown).is_empty());
}

/// Proves: AMC-PAR-10
#[test]
fn volatile_values_begin_anew_also_when_they_were_saved() {
    let mut rig = Rig::new();
    set(&mut rig, "velocity_override", Value::Real(30.0));
    set(&mut rig, "amc.reference_select_trigger", Value::Int(2));
    set(&mut rig, "amc.position_reference", Value::Int(77));
    rig.give(Action::SaveParameters(all()));
    rig.give(Action::PowerCycle);
    let now = rig.machine.parameters(X).expect("x");
    assert_eq!((now.velocity_override, now.vocabularies.amc.reference_select_trigger), (100.0, 0));
    assert_eq!(now.vocabularies.amc.position_reference, 77);
}

/// Proves: MACS-STO-04
#[test]
fn a_machine_begins_with_what_was_saved() {
    let mut config = config(0);
    config.axes[1].saved = Some(AxisParameters { max_velocity: 33_000.0, ..parameters() });
    let mut rig = Rig::of(config);
    assert_eq!(velocity(&rig), 33_000.0);
    rig.give(Action::DeleteParameters(all()));
    assert_eq!(velocity(&rig), 100_000.0);
}

#[test]
fn contradictory_saved_set_is_refused() {
    let mut config = config(0);
    config.axes[1].saved = Some(AxisParameters { default_velocity: Some(2e5), ..parameters() });
    assert_eq!(Machine::new(config).unwrap_err().to_string(), "x: default_velocity exceeds max_velocity");
}

#[test]
fn a_reset_waits_for_no_motion_and_leaves_the_one_under_way_alone() {
    let mut rig = Rig::enabled();
    set(&mut rig, "max_position", Value::Int(50_000));
    rig.give(Action::SaveParameters(all()));
    set(&mut rig, "max_position", Value::Unset);
    rig.give(Action::Move(Move { velocity: 80_000.0, ..to(X, 60_000) }));
    rig.run(50);
    let refused = rig.give(Action::ResetParameters { axes: all(), layer: Layer::User });
    assert_eq!(rig.refusal(refused), "x: max_position 50 mm would leave out 60 mm, which the motion under way reaches");
    assert_eq!(rig.machine.parameters(X).expect("x").max_position, None, "nothing was changed");
    set(&mut rig, "max_velocity", Value::Real(90_000.0));
    let init = rig.give(Action::ResetParameters { axes: all(), layer: Layer::Init });
    assert!(rig.was_accepted(init));
    rig.run(3_000);
    assert_eq!(rig.int("x.command.position"), 60_000);
}

/// A saved selection would move the axis: it becomes active after a power cycle, but not by a reset while the axis is
/// on (AMC-SEL).
#[test]
fn a_reset_never_selects_a_reference_of_an_axis_that_is_on() {
    let mut rig = Rig::enabled();
    set(&mut rig, "amc.reference_select", Value::Int(1));
    rig.give(Action::SaveParameters(all()));
    rig.run(20);
    set(&mut rig, "amc.reference_select", Value::Int(0));
    let refused = rig.give(Action::ResetParameters { axes: all(), layer: Layer::User });
    assert_eq!(rig.refusal(refused), "x: amc.reference_select becomes 1 only while x is disabled");
}

#[test]
fn power_cycle_is_refused_while_an_axis_is_on() {
    let mut rig = Rig::enabled();
    let refused = rig.give(Action::PowerCycle);
    assert_eq!(
        rig.refusal(refused),
        "x: x is not disabled; the power goes only where all axes are disabled and virtual ones stand"
    );
    rig.give(Action::Disable(AxisSet::first(3)));
    rig.run(50);
    rig.give(Action::Move(to(LINE, 5_000)));
    rig.run(3);
    let refused = rig.give(Action::PowerCycle);
    assert!(rig.refusal(refused).starts_with("line: line is not disabled"));
}

/// The image shows the values in force, and its version changes with them.
#[test]
fn the_image_follows_every_change() {
    let mut rig = Rig::new();
    let mut image = rig.machine.parameter_image();
    let mut version = image.version;
    for action in [
        Action::SetParameters([change(X, "error_reaction", Value::Int(4))].into()),
        Action::SaveParameters(all()),
        Action::ResetParameters { axes: all(), layer: Layer::Init },
        Action::DeleteParameters(all()),
        Action::PowerCycle,
    ] {
        rig.give(action);
        rig.machine.copy_parameters(&mut image);
        assert_ne!(image.version, version);
        version = image.version;
        assert_eq!(image, rig.machine.parameter_image());
        assert_eq!(Some(&image.effective[1]), rig.machine.parameters(X));
    }
    rig.run(5);
    assert_eq!(rig.machine.parameter_version(), version);
}

fn some_changes() -> impl Strategy<Value = Vec<(u16, Change)>> {
    let change = prop_oneof![
        (1e4..2e5_f64).prop_map(|v| ("max_velocity", Value::Real(v))),
        (0_i64..6).prop_map(|v| ("error_reaction", Value::Int(v))),
        (1_i64..2000).prop_map(|v| ("encoder", Value::Int(v))),
        (100.0..5000.0_f64).prop_map(|v| ("velmax", Value::Real(v))),
        (1_000_000_i64..2_000_000_000).prop_map(|v| ("rampmin", Value::Int(v))),
        (1_i64..100).prop_map(|v| ("dfltvel", Value::Int(v))),
        (-9000_i64..0).prop_map(|v| ("neglimit", Value::Int(v))),
        (0_i64..2).prop_map(|v| ("swneglimact", Value::Int(v))),
        (0.0..100.0_f64).prop_map(|v| ("velocity_override", Value::Real(v))),
    ];
    let change = (0_u16..3, change);
    prop::collection::vec(
        (0_u16..5, change).prop_map(|(what, (axis, (key, value)))| (what, self::change(axis, key, value))),
        0..12,
    )
}

proptest! {
    #![proptest_config(cases(60))]

    /// After a power cycle a machine gives the same results as a new one with the same saved values.
    #[test]
    fn a_machine_after_a_power_cycle_is_a_new_one(changes in some_changes(), target in 1_i64..40_000) {
        let mut rig = Rig::new();
        for (what, change) in changes {
            rig.give(match what {
                0 => Action::SaveParameters(AxisSet::one(change.axis)),
                1 => Action::ResetParameters { axes: AxisSet::one(change.axis), layer: Layer::Init },
                _ => Action::SetParameters([change].into()),
            });
        }
        rig.give(Action::Move(to(LINE, 1_000)));
        rig.run(2);
        rig.run_until("line.state", 1);
        let gone = rig.give(Action::PowerCycle);
        prop_assert!(rig.was_accepted(gone));
        let mut config = rig.machine.config().clone();
        let user = rig.machine.parameter_image().user;
        for (axis, user) in config.axes.iter_mut().zip(user) {
            axis.saved = Some(user);
        }
        let mut fresh = Machine::new(config.clone()).expect("what was saved is sound");
        prop_assert_eq!(fresh.parameter_image().effective, rig.machine.parameter_image().effective);
        let mut plants = [0, 1].map(|_| Plant::new(&config, &[Some(Model::Ideal); 2]));
        let (mut inputs, mut outputs) = (fresh.inputs(), fresh.outputs());
        let mut others = (fresh.inputs(), fresh.outputs());
        // The cycle of the power-on counts no time.
        others.0.begin(0, 0);
        plants[1].read(&mut others.0);
        rig.machine.cycle(&others.0, Commands::default(), &mut others.1);
        inputs.begin(0, 0);
        plants[0].read(&mut inputs);
        fresh.cycle(&inputs, Commands::default(), &mut outputs);
        for cycle in 0_u64..600 {
            let action = match cycle {
                1 => Action::Enable(all()),
                100 => Action::Move(to(X, target)),
                110 => Action::Move(to(LINE, target)),
                _ => Action::Cancel { goal: 0 },
            };
            let commands = [Command { sequence: 1_000 + cycle, source: Source::Scenario, action }];
            let commands = Commands::queue(if matches!(commands[0].action, Action::Cancel { .. }) { &[] } else { &commands });
            inputs.begin(0, 0);
            plants[0].read(&mut inputs);
            fresh.cycle(&inputs, commands, &mut outputs);
            plants[0].write(&outputs);
            others.0.begin(0, 0);
            plants[1].read(&mut others.0);
            rig.machine.cycle(&others.0, commands, &mut others.1);
            plants[1].write(&others.1);
            prop_assert_eq!(&outputs, &others.1, "in cycle {}", cycle);
            for name in ["line", "x", "y"] {
                let of = |machine: &Machine| {
                    let signal = machine.directory().find(&format!("{name}.command.position")).expect("a signal");
                    machine.board().value(signal, machine.directory().entry(signal).kind)
                };
                prop_assert_eq!(of(&fresh), of(&rig.machine), "{} in cycle {}", name, cycle);
            }
        }
    }
}

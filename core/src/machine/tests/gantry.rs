//! Axes with two drives: switched on and off together, held together, supervised.

mod homing;

use super::rig::{Rig, X, at, cases, config, saia_verb, to};
use crate::axis::Wired;
use crate::code::Code;
use crate::command::{Action, HomeAxis, HomingMethod, SetPosition};
use crate::config::{ConfigError, GantryProblem, MachineConfig};
use crate::drive::{BusState, Capabilities, DriveInput, DriveState, Inputs, Interface, control, inputs};
use crate::encoder::{Absolute, Form};
use crate::event::Kind;
use crate::object::AxisSet;
use crate::parameter::Value;
use crate::position::Length;
use crate::sim::{Model, SecondOrder};
use crate::vocabulary::saia::Command;
use proptest::prelude::*;

/// Indices of the drives of x.
const FIRST: usize = 0;
const SECOND: usize = 2;
/// 0.2 mm.
const MAX_SKEW: i64 = 200;

/// Returns a cell in which x has two drives.
fn cell() -> MachineConfig {
    let mut config = config(0);
    let x = &mut config.axes[usize::from(X)];
    x.second = Some(Capabilities::all(0));
    x.parameters.gantry.max_skew = Some(MAX_SKEW);
    x.parameters.homing.index_velocity = Some(1_000.0);
    config
}

/// Returns a rig whose second drive has this many counts more at the first inputs.
fn with_count_difference(by: i64) -> Rig {
    let mut rig = Rig::of(cell());
    rig.plant.drive(SECOND).expect("it is simulated").jump(by);
    rig.run(2);
    rig
}

fn enabled(by: i64) -> Rig {
    let mut rig = with_count_difference(by);
    rig.enable();
    rig
}

fn controls(rig: &Rig) -> [u16; 2] {
    [FIRST, SECOND].map(|place| rig.outputs().drive[place].control)
}

fn setpoints(rig: &Rig) -> [i64; 2] {
    [FIRST, SECOND].map(|place| rig.outputs().drive[place].position)
}

fn errors(rig: &Rig) -> Vec<Code> {
    rig.events.iter().filter(|event| event.kind == Kind::Error).map(|event| event.code).collect()
}

/// In each cycle both drives get the same control word, and the axis is on once both drives are.
#[test]
fn axis_is_on_once_both_drives_are_on() {
    let mut rig = with_count_difference(0);
    // The second drive is slow: for 30 cycles it reports only switched on.
    rig.modify_inputs = |inputs: &mut Inputs| {
        if inputs.cycle < 30 && DriveState::from_status(inputs.drive[SECOND].status) == DriveState::Enabled {
            inputs.drive[SECOND].status = DriveState::SwitchedOn.status();
        }
    };
    rig.give(Action::Enable(AxisSet::one(X)));
    while rig.machine.next_cycle() < 30 {
        rig.run(1);
        let [first, second] = controls(&rig);
        assert_eq!((first, rig.int("x.enabled")), (second, 0));
    }
    assert_eq!(controls(&rig), [control::ENABLE; 2]);
    rig.run(1);
    assert_eq!((rig.state("x"), rig.int("x.second.drive_state")), ("STANDSTILL", DriveState::Enabled as i64));
    rig.give(Action::Disable(AxisSet::one(X)));
    assert_eq!(controls(&rig), [control::DISABLE_VOLTAGE; 2]);
}

/// A drive that is never enabled keeps the axis off, with the error of a single drive.
#[test]
fn a_drive_that_does_not_come_on_switches_both_off() {
    let mut rig = with_count_difference(0);
    rig.modify_inputs = |inputs: &mut Inputs| inputs.drive[SECOND].status = DriveState::SwitchedOn.status();
    rig.give(Action::Enable(AxisSet::one(X)));
    rig.run(5_010);
    assert_eq!((errors(&rig), controls(&rig)), (vec![Code::ENABLE_TIMEOUT], [control::DISABLE_VOLTAGE; 2]));
}

/// Different initial counts of the drives are no skew: the second drive gets setpoints with this difference.
#[test]
fn initial_positions_are_square_by_default() {
    for by in [0, 7, -150, 1_000_000, i64::from(i32::MIN)] {
        let mut rig = enabled(by);
        assert_eq!((rig.int("x.skew"), rig.int("x.second.count")), (0, by));
        rig.give(Action::Move(to(X, 20_000)));
        rig.run(1_000);
        assert_eq!((rig.int("x.actual.position"), rig.int("x.second.count")), (20_000, 20_000 + by));
        assert_eq!((rig.int("x.second.position"), rig.int("x.skew")), (20_000, 0));
    }
}

/// `square_offset` defines the square position. The remaining difference is skew, which the axis keeps up to max_skew;
/// above it the axis is not switched on.
#[test]
fn it_keeps_a_skew_within_the_limit_and_is_not_switched_on_beyond_it() {
    for by in [-201, -200, -1, 0, 200, 201] {
        let mut config = cell();
        config.axes[usize::from(X)].parameters.gantry.square_offset = Some(5_000);
        let mut rig = Rig::of(config);
        rig.plant.drive(SECOND).unwrap().jump(5_000 + by);
        rig.run(2);
        assert_eq!(rig.int("x.skew"), by);
        let sequence = rig.give(Action::Enable(AxisSet::one(X)));
        rig.run(20);
        if by.abs() > MAX_SKEW {
            let sign = if by < 0 { "-" } else { "" };
            assert_eq!(
                rig.refusal(sequence),
                format!("x: the two drives are {sign}0.201 mm from square; max_skew 0.2 mm is allowed")
            );
            assert_eq!((rig.state("x"), controls(&rig)), ("DISABLED", [control::DISABLE_VOLTAGE; 2]));
            continue;
        }
        rig.give(Action::Move(to(X, -3_000)));
        rig.run(1_000);
        assert_eq!((rig.int("x.actual.position"), rig.int("x.skew")), (-3_000, by));
        assert_eq!(rig.int("x.second.count"), -3_000 + 5_000 + by);
    }
}

/// One side is held while the axis moves: in the cycle in which the skew exceeds 200 inc, both drives are switched off.
#[test]
fn skew_above_limit_removes_power_of_both_drives_in_its_cycle() {
    for jammed in [FIRST, SECOND] {
        let mut rig = enabled(40);
        // No other error must stop the axis first.
        rig.set("max_following_error", Value::Int(1_000_000));
        rig.give(Action::Move(at(X, 10_000.0)));
        rig.run(100);
        rig.plant.drive(jammed).unwrap().jam(true);
        let mut before = 0;
        while rig.int("x.error") == 0 {
            before = rig.int("x.skew").abs();
            assert_eq!((before <= MAX_SKEW, controls(&rig)), (true, [control::ENABLE; 2]));
            rig.run(1);
        }
        // 10 inc per cycle.
        assert_eq!((before, rig.int("x.skew").abs()), (200, 210));
        assert_eq!(controls(&rig), [control::DISABLE_VOLTAGE; 2]);
        assert_eq!((errors(&rig), rig.state("x")), (vec![Code::SKEW], "ERROR_STOP"));
        // The state remains: a reset is possible, but the axis cannot be switched on.
        rig.run(5);
        rig.give(Action::ResetErrors(AxisSet::one(X)));
        rig.run(20);
        let sequence = rig.give(Action::Enable(AxisSet::one(X)));
        assert!(rig.refusal(sequence).contains("max_skew 0.2 mm"), "{}", rig.refusal(sequence));
    }
}

/// A new limit applies in its cycle.
#[test]
fn a_new_limit_counts_at_once() {
    let mut rig = enabled(0);
    rig.set("max_following_error", Value::Int(1_000_000));
    rig.give(Action::Move(at(X, 10_000.0)));
    rig.run(100);
    rig.plant.drive(SECOND).unwrap().jam(true);
    while rig.int("x.skew").abs() < 100 {
        rig.run(1);
    }
    rig.set("max_skew", Value::Int(99));
    assert_eq!((rig.int("x.error"), controls(&rig)), (i64::from(Code::SKEW.0), [control::DISABLE_VOLTAGE; 2]));
}

/// The reaction to a skew is selected by its own parameter.
#[test]
fn the_skew_has_a_reaction_of_its_own() {
    for (reaction, expected) in
        [(0, control::DISABLE_VOLTAGE), (1, control::DISABLE_VOLTAGE), (2, control::ENABLE), (4, control::QUICK_STOP)]
    {
        let mut rig = enabled(0);
        rig.set("skew_reaction", Value::Int(reaction));
        rig.set("max_following_error", Value::Int(1_000_000));
        rig.give(Action::Move(at(X, 10_000.0)));
        rig.run(100);
        rig.plant.drive(SECOND).unwrap().jam(true);
        while rig.int("x.error") == 0 {
            rig.run(1);
        }
        assert_eq!((controls(&rig), rig.int("x.error")), ([expected; 2], i64::from(Code::SKEW.0)), "{reaction}");
        assert_eq!(rig.int("x.brake"), i64::from(reaction == 1), "{reaction}");
    }
}

/// A skew that grows during a stop, or while another error stops the axis, also removes the power of both drives.
#[test]
fn the_skew_is_supervised_in_stops_too() {
    for stop in [Action::Halt(AxisSet::one(X)), Action::QuickStop(AxisSet::one(X)), Action::Disable(AxisSet::one(X))] {
        let mut rig = enabled(0);
        rig.set("max_following_error", Value::Int(1_000_000));
        rig.set("max_deceleration", Value::Real(20_000.0));
        rig.give(Action::Move(at(X, 10_000.0)));
        rig.run(100);
        rig.plant.drive(SECOND).unwrap().jam(true);
        rig.give(stop);
        rig.run(25);
        assert_eq!((errors(&rig), controls(&rig)), (vec![Code::SKEW], [control::DISABLE_VOLTAGE; 2]));
    }
    let mut rig = enabled(0);
    rig.set("max_deceleration", Value::Real(20_000.0));
    rig.set("max_following_error", Value::Int(50));
    rig.give(Action::Move(at(X, 10_000.0)));
    rig.run(100);
    rig.plant.drive(FIRST).unwrap().jam(true);
    rig.run(30);
    assert_eq!(
        (errors(&rig), controls(&rig)),
        (vec![Code::FOLLOWING_ERROR, Code::SKEW], [control::DISABLE_VOLTAGE; 2])
    );
}

/// Moves at 10 inc per cycle with one drive held, until the error.
fn skewed(reaction: i64) -> Rig {
    let mut rig = enabled(0);
    rig.set("skew_reaction", Value::Int(reaction));
    rig.set("max_following_error", Value::Int(1_000_000));
    // It stops within 50 cycles and 250 inc.
    rig.set("max_deceleration", Value::Real(200_000.0));
    rig.give(Action::Move(at(X, 10_000.0)));
    rig.run(100);
    rig.plant.drive(SECOND).unwrap().jam(true);
    while rig.int("x.error") == 0 {
        rig.run(1);
    }
    rig
}

/// Above twice max_skew both drives are switched off with any reaction: during its own stop, and if it only reports.
#[test]
fn skew_above_twice_the_limit_removes_power_with_any_reaction() {
    for reaction in [2, 3, 5] {
        let mut rig = skewed(reaction);
        assert_eq!(controls(&rig), [control::ENABLE; 2]);
        while rig.int("x.skew").abs() <= 2 * MAX_SKEW {
            assert_eq!(controls(&rig), [control::ENABLE; 2], "{reaction}");
            rig.run(1);
        }
        assert_eq!((controls(&rig), rig.state("x")), ([control::DISABLE_VOLTAGE; 2], "ERROR_STOP"), "{reaction}");
        assert_eq!((errors(&rig), rig.int("x.brake")), (vec![Code::SKEW; 2], i64::from(reaction == 3)), "{reaction}");
    }
}

/// While another error stops the axis, a skew without a further reaction is reported once; so is a skew with reaction
/// report only.
#[test]
fn skew_during_another_error_is_reported_once() {
    for reaction in [2, 3, 4, 5] {
        let mut rig = enabled(0);
        rig.set("skew_reaction", Value::Int(reaction));
        rig.plant.drive(FIRST).unwrap().set_stuck_inputs(inputs::POSITIVE_LIMIT, inputs::POSITIVE_LIMIT);
        rig.run(5);
        assert_eq!(rig.state("x"), "ERROR_STOP");
        rig.plant.drive(SECOND).unwrap().jump(-300);
        rig.plant.drive(SECOND).unwrap().jam(true);
        rig.run(100);
        assert_eq!(rig.int("x.skew"), -300);
        let expected = [Code::HARDWARE_LIMIT_POSITIVE, Code::SKEW];
        assert_eq!((errors(&rig), controls(&rig)), (expected.to_vec(), [control::ENABLE; 2]), "{reaction}");
    }
    // Together with an error that is only reported, and a skew that is only reported, too.
    let mut rig = enabled(0);
    rig.set("skew_reaction", Value::Int(5));
    rig.set("error_reaction", Value::Int(5));
    rig.set("max_following_error", Value::Int(50));
    rig.plant.drive(FIRST).unwrap().jam(true);
    rig.plant.drive(SECOND).unwrap().jam(true);
    rig.give(Action::Move(to(X, 100)));
    rig.run(200);
    assert_eq!(errors(&rig), [Code::FOLLOWING_ERROR]);
    for _ in 0..2 {
        rig.plant.drive(SECOND).unwrap().jump(300);
        rig.run(100);
        rig.plant.drive(SECOND).unwrap().jump(-300);
        rig.run(100);
    }
    let skews = errors(&rig).iter().filter(|code| **code == Code::SKEW).count();
    assert_eq!((skews, controls(&rig)), (2, [control::ENABLE; 2]));
}

/// Reaction 4: while the second drive still runs, the axis has not stopped, even if the first drive stands still.
#[test]
fn a_drive_that_still_runs_has_not_stopped_by_itself() {
    for runs in [false, true] {
        let mut rig = skewed(4);
        assert_eq!(controls(&rig), [control::QUICK_STOP; 2]);
        rig.plant.drive(FIRST).unwrap().jam(true);
        rig.modify_inputs =
            if runs { |all: &mut Inputs| all.drive[SECOND].count += all.cycle as i64 % 100 } else { |_| {} };
        // Both drives report quick stop, at any velocity.
        rig.run(20);
        rig.give(Action::Disable(AxisSet::one(X)));
        rig.run(30);
        assert_eq!(controls(&rig) == [control::QUICK_STOP; 2], runs);
    }
}

/// A vocabulary cannot switch the axis on either, and changes during the switch-on count, too.
#[test]
fn nothing_switches_it_on_beyond_the_limit() {
    let mut rig = with_count_difference(0);
    rig.plant.drive(SECOND).unwrap().jump(MAX_SKEW + 1);
    rig.run(2);
    let commands = [
        Command::Initialise,
        Command::LoadDestination,
        Command::LoadVelocity,
        Command::LoadAcceleration,
        Command::Start,
    ];
    rig.give(saia_verb(&commands));
    for _ in 0..20 {
        rig.run(1);
        // The switch-on is not even commanded.
        assert_eq!(controls(&rig), [control::DISABLE_VOLTAGE; 2]);
    }
    rig.plant.drive(SECOND).unwrap().jump(-1);
    rig.run(2);
    rig.give(saia_verb(&commands));
    rig.run(20);
    assert_eq!(rig.int("x.enabled"), 1);
    for reaction in [0, 2, 5] {
        let mut rig = with_count_difference(0);
        rig.set("skew_reaction", Value::Int(reaction));
        rig.give(Action::Enable(AxisSet::one(X)));
        rig.run(1);
        rig.plant.drive(SECOND).unwrap().jump(MAX_SKEW + 1);
        for _ in 0..30 {
            rig.run(1);
            assert_eq!(rig.int("x.enabled"), 0, "{reaction}");
        }
        assert_eq!((errors(&rig), controls(&rig)), (vec![Code::SKEW], [control::DISABLE_VOLTAGE; 2]), "{reaction}");
    }
}

/// A second drive without a valid position is not switched on.
#[test]
fn a_second_drive_without_a_place_is_not_switched_on() {
    let mut config = cell();
    config.axes[usize::from(X)].wired = Wired::Drive(Form::Absolute(Absolute::single_turn(40_000)));
    let mut rig = Rig::of(config);
    rig.run(2);
    rig.plant.drive(SECOND).unwrap().cut_encoder();
    rig.run(2);
    let sequence = rig.give(Action::Enable(AxisSet::one(X)));
    assert_eq!(rig.refusal(sequence), "x: the second drive tells no position");
}

/// The square position and the held position are taken from inputs of the same cycle.
#[test]
fn held_position_is_taken_from_new_inputs() {
    let mut rig = Rig::of(cell());
    // Before its first report the drive repeats an old word, and again while it is switched on.
    rig.modify_inputs = |all: &mut Inputs| match all.cycle {
        0..3 => (all.drive[SECOND].fresh, all.drive[SECOND].count) = (false, -500),
        5..14 => all.drive[SECOND].fresh = false,
        _ => {}
    };
    rig.run(4);
    assert_eq!((rig.int("x.second.count"), rig.int("x.skew")), (0, 0));
    rig.give(Action::Enable(AxisSet::one(X)));
    while rig.machine.next_cycle() < 14 {
        rig.run(1);
        assert_eq!(rig.int("x.enabled"), 0);
    }
    rig.run(10);
    let [first, second] = setpoints(&rig);
    assert_eq!((second - first, rig.int("x.skew"), rig.int("x.enabled"), errors(&rig)), (0, 0, 1, vec![]));
}

/// Absolute encoders show the skew again once either encoder restarts its count; for others it is reported as unknown.
#[test]
fn a_new_coordinate_of_absolute_encoders_shows_the_skew() {
    let moved: OfEither = [
        |all| (all.drive[FIRST].epoch, all.drive[FIRST].count) = (1, all.drive[FIRST].count + 150),
        |all| (all.drive[SECOND].epoch, all.drive[SECOND].count) = (1, all.drive[SECOND].count + 150),
    ];
    for (moved, skew) in moved.into_iter().zip([-150, 150]) {
        for is_known in [true, false] {
            let mut config = cell();
            let x = &mut config.axes[usize::from(X)];
            x.wired = Wired::Drive(Form::Absolute(Absolute { overflow: true, ..Absolute::single_turn(40_000) }));
            x.parameters.gantry.square_offset = is_known.then_some(0);
            let mut rig = Rig::of(config);
            rig.run(5);
            rig.modify_inputs = moved;
            rig.run(3);
            let told = rig.events.iter().filter(|event| event.code == Code::SQUARE_ASSUMED).count();
            let expected = if is_known { (skew, 0) } else { (0, 1) };
            assert_eq!((rig.int("x.skew"), told), expected);
        }
    }
}

/// A modification of the inputs of the first drive, and the same of the second one.
type OfEither = [fn(&mut Inputs); 2];

fn absent(drive: &mut DriveInput) {
    drive.online = false;
}

fn without_bus(drive: &mut DriveInput) {
    drive.bus = BusState::Off;
}

fn not_enabled(drive: &mut DriveInput) {
    drive.status = DriveState::Ready.status();
}

fn in_fault(drive: &mut DriveInput) {
    (drive.status, drive.fault) = (DriveState::Fault.status(), 0x2310);
}

/// An absence, a loss of the bus, a drive that switches itself off, a fault: for either drive, both are switched off in
/// that cycle.
#[test]
fn what_fails_of_either_drive_stops_both_in_its_cycle() {
    let harms: [(OfEither, Code); 4] = [
        ([|all| absent(&mut all.drive[FIRST]), |all| absent(&mut all.drive[SECOND])], Code::DRIVE_LOST),
        ([|all| without_bus(&mut all.drive[FIRST]), |all| without_bus(&mut all.drive[SECOND])], Code::BUS_ERROR),
        ([|all| not_enabled(&mut all.drive[FIRST]), |all| not_enabled(&mut all.drive[SECOND])], Code::DRIVE_DISABLED),
        ([|all| in_fault(&mut all.drive[FIRST]), |all| in_fault(&mut all.drive[SECOND])], Code::drive_fault(0x2310)),
    ];
    for (harms, code) in harms {
        for harm in harms {
            let mut rig = enabled(0);
            rig.give(Action::Move(at(X, 10_000.0)));
            rig.run(100);
            rig.modify_inputs = harm;
            rig.run(1);
            let found = (rig.int("x.error"), controls(&rig));
            assert_eq!(found, (i64::from(code.0), [control::DISABLE_VOLTAGE; 2]));
            // The third drive belongs to another axis.
            assert_eq!(rig.outputs().drive[1].control, control::ENABLE);
        }
    }
}

/// No new data from either drive for longer than missed_cycles.
#[test]
fn missing_data_of_either_drive_is_supervised() {
    let silences: [fn(&mut Inputs); 2] = [|all| all.drive[FIRST].fresh = false, |all| all.drive[SECOND].fresh = false];
    for silence in silences {
        let mut rig = enabled(0);
        rig.modify_inputs = silence;
        rig.run(10);
        assert_eq!((rig.int("x.error"), controls(&rig)), (0, [control::ENABLE; 2]));
        rig.run(1);
        let expected = (i64::from(Code::DRIVE_STALE.0), [control::DISABLE_VOLTAGE; 2]);
        assert_eq!((rig.int("x.error"), controls(&rig)), expected);
    }
}

/// During a wait for new data the last word belongs to an earlier cycle, so it is no skew.
#[test]
fn missing_words_are_no_skew() {
    let stale: [fn(&mut Inputs); 2] = [
        |all| (all.drive[FIRST].fresh, all.drive[FIRST].count) = (false, all.drive[FIRST].count - 500),
        |all| (all.drive[SECOND].fresh, all.drive[SECOND].count) = (false, all.drive[SECOND].count - 500),
    ];
    for stale in stale {
        let mut rig = enabled(0);
        rig.give(Action::Move(at(X, 100_000.0)));
        rig.run(300);
        rig.modify_inputs = stale;
        rig.run(9);
        rig.modify_inputs = |_| {};
        rig.run(3);
        assert_eq!((errors(&rig), rig.int("x.skew"), controls(&rig)), (vec![], 0, [control::ENABLE; 2]));
    }
}

/// A fault of either drive is reset at both.
#[test]
fn a_fault_of_the_second_drive_is_reset() {
    let mut rig = enabled(0);
    rig.plant.drive(SECOND).unwrap().inject_fault(0x7121);
    rig.run(5);
    assert_eq!(errors(&rig), [Code::drive_fault(0x7121)]);
    let sequence = rig.give(Action::ResetErrors(AxisSet::one(X)));
    rig.run(10);
    assert_eq!((rig.done(sequence)[0].code, rig.state("x")), (Code::NONE, "DISABLED"));
    rig.enable();
    assert_eq!(rig.state("x"), "STANDSTILL");
}

/// A coordinate of the second drive that starts again, as after its power-on, is neither a motion nor a skew. But it is
/// unknown whether the drive was moved in between, so the zero is lost.
#[test]
fn a_new_coordinate_of_the_second_drive_is_no_motion() {
    let mut rig = enabled(0);
    rig.give(Action::Move(to(X, 20_000)));
    rig.run(600);
    rig.give(Action::HomeAxis(HomeAxis { axis: X, method: HomingMethod::Cia402(35) }));
    rig.run(2);
    assert_eq!((rig.int("x.homed"), rig.int("x.actual.position")), (1, 0));
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(20);
    rig.plant.drive(SECOND).unwrap().restart_counts();
    rig.run(1);
    assert_eq!((rig.int("x.second.count"), rig.int("x.skew"), rig.int("x.homed")), (0, 0, 0));
    assert_eq!((rig.int("x.second.position"), rig.int("x.actual.count")), (0, 20_000));
    rig.enable();
    rig.give(Action::Move(to(X, 5_000)));
    rig.run(600);
    assert_eq!((rig.int("x.actual.count"), rig.int("x.second.count"), rig.int("x.skew")), (25_000, 5_000, 0));
}

/// Absolute encoders give the square position, wherever their words start again; one that no longer reports a position
/// switches both drives off.
#[test]
fn absolute_encoders_keep_the_square_position() {
    for (by, skew) in [(300, 0), (300 - 40_000, 0), (300 + 80_000, 0), (340, 40), (260 - 40_000, -40)] {
        let mut config = cell();
        let x = &mut config.axes[usize::from(X)];
        x.wired = Wired::Drive(Form::Absolute(Absolute { overflow: true, ..Absolute::single_turn(40_000) }));
        x.parameters.gantry.square_offset = Some(300);
        let mut rig = Rig::of(config);
        rig.plant.drive(FIRST).unwrap().jump(39_900);
        rig.plant.drive(SECOND).unwrap().jump(39_900 + by);
        rig.run(2);
        assert_eq!(rig.int("x.skew"), skew, "{by}");
        rig.enable();
        rig.give(Action::Move(to(X, 150_000)));
        rig.run(2_500);
        assert_eq!((rig.int("x.actual.position"), rig.int("x.second.position")), (150_000, 150_000 + skew), "{by}");
        assert_eq!((rig.int("x.skew"), errors(&rig)), (skew, vec![]));
        rig.plant.drive(SECOND).unwrap().cut_encoder();
        rig.run(1);
        assert_eq!((errors(&rig), controls(&rig)), (vec![Code::SECOND_UNREAD], [control::DISABLE_VOLTAGE; 2]));
    }
}

/// The limit switch of either drive stops the axis.
#[test]
fn the_limit_switch_of_either_drive_stops_it() {
    for place in [FIRST, SECOND] {
        let mut rig = enabled(0);
        rig.give(Action::Move(at(X, 10_000.0)));
        rig.run(100);
        rig.plant.drive(place).unwrap().set_stuck_inputs(inputs::POSITIVE_LIMIT, inputs::POSITIVE_LIMIT);
        rig.run(1);
        assert_eq!((rig.int("x.limit.positive"), errors(&rig)), (1, vec![Code::HARDWARE_LIMIT_POSITIVE]), "{place}");
    }
}

/// Parameter values that are refused.
#[test]
fn unsupported_parameters_with_two_drives_are_refused_by_name() {
    let mut rig = with_count_difference(0);
    for (key, value, expected) in [
        ("max_skew", Value::Unset, "max_skew is missing; a distance above 0 is expected"),
        ("homing.method", Value::Int(33), "homing.method 33 does not square an axis with two drives"),
        ("homing.method", Value::Int(17), "homing.method 17 does not square an axis with two drives"),
        ("homing.in_drive", Value::Int(1), "homing.in_drive 1 would let each of two drives"),
        ("encodertype", Value::Int(9), "encodertype 9 names another source than the two drives"),
    ] {
        let sequence = rig.set(key, value);
        assert!(rig.refusal(sequence).contains(expected), "{key}: {}", rig.refusal(sequence));
    }
    let sequence = rig.set("homing.method", Value::Int(23));
    assert!(rig.was_accepted(sequence));
}

#[test]
fn config_with_unsuitable_second_drive_is_refused() {
    let problem = |change: fn(&mut crate::config::AxisConfig)| {
        let mut config = cell();
        change(&mut config.axes[usize::from(X)]);
        match config.check() {
            Err(ConfigError::Gantry { problem, .. }) => Some(problem),
            _ => None,
        }
    };
    assert_eq!(problem(|_| ()), None);
    assert_eq!(problem(|x| x.drive = None), Some(GantryProblem::NoFirst));
    assert_eq!(problem(|x| x.interface = Interface::Velocity), Some(GantryProblem::Interface(Interface::Velocity)));
    assert_eq!(problem(|x| x.second = Some(Capabilities::all(1))), Some(GantryProblem::Delays(0, 1)));
    let mut config = cell();
    config.axes[usize::from(X)].parameters.gantry.max_skew = None;
    let sentence = config.check().map_err(|error| error.to_string());
    let expected = "x: max_skew is missing for an axis with two drives; a distance above 0 is expected";
    assert_eq!(sentence, Err(expected.to_owned()));
}

/// Returns a random action on x for one cycle.
fn action() -> impl Strategy<Value = Option<Action>> {
    let x = AxisSet::one(X);
    prop_oneof![
        8 => Just(None),
        3 => (-60_000_i64..60_000).prop_map(|target| Some(Action::Move(to(X, target)))),
        2 => (-90_000.0..90_000.0_f64).prop_map(|velocity| Some(Action::Move(at(X, velocity)))),
        1 => Just(Some(Action::Halt(x))),
        1 => Just(Some(Action::QuickStop(x))),
        1 => Just(Some(Action::ResetErrors(x))),
        1 => Just(Some(Action::Disable(x))),
        2 => Just(Some(Action::Enable(x))),
        1 => (-9_000_i64..9_000).prop_map(|place| Some(Action::SetPosition(SetPosition { axis: X, position: Length::whole(place) }))),
    ]
}

proptest! {
    #![proptest_config(cases(40))]

    /// With any commands both drives have the same control word, and the setpoints differ by the initial difference of
    /// the positions at switch-on. A machine restored in between gives the same results.
    #[test]
    fn both_drives_get_the_same_setpoint(
        by in -1_000_000_i64..1_000_000,
        actions in prop::collection::vec((action(), 1_u64..80), 1..25),
        lag: bool,
    ) {
        let model = if lag { Model::SecondOrder(SecondOrder::new(60.0, 0.8, 1_000_000).unwrap()) } else { Model::Ideal };
        let mut rig = Rig::with(cell(), [model, Model::Ideal, model]);
        rig.plant.drive(SECOND).unwrap().jump(by);
        rig.run(2);
        rig.enable();
        for (place, (action, cycles)) in actions.into_iter().enumerate() {
            if place == 7 {
                rig.mirror();
            }
            if let Some(action) = action {
                rig.give(action);
            }
            for _ in 0..cycles {
                rig.run(1);
                let [first, second] = controls(&rig);
                prop_assert_eq!(first, second);
                if rig.int("x.enabled") == 1 {
                    let [first, second] = setpoints(&rig);
                    prop_assert_eq!(second - first, by);
                }
                prop_assert_eq!(rig.int("x.skew"), 0);
            }
        }
    }
}

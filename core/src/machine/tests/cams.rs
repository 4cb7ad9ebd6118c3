//! Cams of `~/synchronize` on a machine: their start, their response to changes, and their end.

use super::rig::{LINE, Rig, X, at, cam, config, couple, to};
use crate::code::Code;
use crate::command::{Action, CamIn, Commands, Move, Synchronize};
use crate::config::TableConfig;
use crate::event::Kind;
use crate::object::Leader;
use crate::position::{Length, Position};
use crate::sync::gear::Ratio;
use crate::sync::{CamStart, Disengage};
use crate::table::{CamSetting, Form, Table};
use std::sync::Arc;

/// Indices of the tables.
const KNIFE: u16 = 0;
const ONCE: u16 = 1;
const WORDS: u16 = 2;
const EVEN: u16 = 3;

fn xy(points: &[(i64, i64)]) -> Table {
    let (x, y): (Vec<_>, Vec<_>) = points.iter().copied().unzip();
    Table::new(Form::Xy, &x, &y).expect("points")
}

/// Slopes of 0.5 and 1.5 over 20000 increments, out and back.
fn knife() -> Table {
    xy(&[(0, 0), (8000, 4000), (16_000, 4000), (18_000, 1000), (20_000, 0)])
}

fn rig() -> Rig {
    rig_with(0)
}

fn rig_with(revers: i64) -> Rig {
    let once = CamSetting { is_cyclic: false, ..CamSetting::default() };
    let tables = [
        ("knife", knife()),
        ("once", xy(&[(0, 100), (1000, 1100), (2000, 3100)]).with_cam(once)),
        ("words", Table::new(Form::Words, &[], &[1, 2]).expect("words")),
        ("even", Table::new(Form::Y, &[], &[0, 10]).expect("points")),
    ];
    let mut config = config(0);
    config.tables = tables.map(|(name, table)| TableConfig { name: name.into(), table: Arc::new(table) }).into();
    for axis in &mut config.axes {
        axis.parameters.sync_accuracy = 10;
        axis.parameters.macs.revers = revers;
    }
    let mut rig = Rig::of(config);
    rig.enable();
    rig
}

fn on(cam: CamIn) -> Action {
    Action::Synchronize(Synchronize { cam: Some(cam), ..couple(X, Leader::AxisCommand(LINE), 0, 0) })
}

fn slave(rig: &Rig) -> Position {
    rig.machine.state.leads.get(Leader::AxisCommand(X)).position
}

fn master(rig: &Rig) -> Position {
    rig.machine.state.leads.get(Leader::AxisCommand(LINE)).position
}

/// Returns y of the knife cam, rounded down to 2^-32: the equation of the contract.
fn of_knife(x: Position) -> i128 {
    let x = x.raw().rem_euclid(20_000 << 32);
    match x >> 32 {
        0..8000 => x >> 1,
        8000..16_000 => 4000 << 32,
        16_000..18_000 => (4000 << 32) + (-3 * (x - (16_000 << 32))).div_euclid(2),
        _ => (1000 << 32) + (-(x - (18_000 << 32))).div_euclid(2),
    }
}

#[test]
fn absolute_cam_follows_table_over_periods_and_back() {
    let mut rig = rig();
    rig.give(on(cam(KNIFE, CamStart::Absolute)));
    rig.run(1);
    assert_eq!((rig.state("x"), rig.int("x.in_sync"), rig.int("x.reference")), ("SYNCHRONIZED_MOTION", 1, 3));
    for (goal, cycles) in [(45_000, 2_000), (-7_000, 2_000)] {
        let mut exact = 0;
        rig.give(Action::Move(Move { velocity: 40_000.0, acceleration: 2e5, deceleration: 2e5, ..to(LINE, goal) }));
        for _ in 0..cycles {
            rig.run(1);
            // Slopes change by 1.5 at 40 inc per cycle: 60000 inc/s in 1 ms exceed 1e6 inc/s^2, so the slave lags.
            if rig.int("x.in_sync") == 1 {
                assert_eq!(slave(&rig).raw(), of_knife(master(&rig)));
                exact += 1;
            }
        }
        assert!(exact > cycles / 2, "{exact} of {cycles}");
        rig.run_until("line.state", 1);
        rig.run(200);
        assert_eq!((rig.int("x.in_sync"), rig.int("x.sync.error")), (1, 0));
        assert_eq!(slave(&rig).raw(), of_knife(master(&rig)));
    }
}

#[test]
fn absolute_is_refused_where_the_slave_is_elsewhere_and_ramp_in_leads_there() {
    let mut rig = rig();
    rig.give(Action::Move(Move { velocity: 50_000.0, ..to(LINE, 4_000) }));
    rig.run_until("line.state", 1);
    let refused = rig.give(on(cam(KNIFE, CamStart::Absolute)));
    rig.run(1);
    assert_eq!(rig.answer(refused).unwrap_err().code, Code::CAM_AWAY);
    assert_eq!(
        rig.refusal(refused),
        "x: the cam asks for a place that is 2 mm away; ABSOLUTE begins within syncaccuracy, 0.01 mm, RAMP_IN leads there"
    );
    assert_eq!((rig.state("x"), slave(&rig)), ("STANDSTILL", Position::ZERO));
    let near = CamIn { slave_offset: Length::whole(-1_991), ..cam(KNIFE, CamStart::Absolute) };
    let taken = rig.give(on(near));
    rig.run(1);
    assert!(rig.was_accepted(taken));
    rig.give(Action::Cancel { goal: taken });
    rig.run_until("x.state", 1);
    let gentle = Synchronize {
        velocity: 1000.0,
        acceleration: 10_000.0,
        cam: Some(cam(KNIFE, CamStart::RampIn)),
        ..couple(X, Leader::AxisCommand(LINE), 0, 0)
    };
    rig.give(Action::Synchronize(gentle));
    let mut before = slave(&rig);
    for _ in 0..3000 {
        rig.run(1);
        assert!((slave(&rig) - before).to_f64().abs() <= 1.000_001, "1000 inc/s at most");
        before = slave(&rig);
    }
    assert_eq!((rig.int("x.in_sync"), slave(&rig)), (1, Position::whole(2000)));
}

#[test]
fn a_relative_cam_begins_where_both_are() {
    let mut rig = rig();
    rig.give(Action::Move(to(X, 700)));
    rig.give(Action::Move(Move { velocity: 50_000.0, ..to(LINE, 3_333) }));
    rig.run_until("line.state", 1);
    rig.run_until("x.state", 1);
    let half = Ratio::new(1, 2).unwrap();
    let request =
        CamIn { master_scale: half, slave_scale: Ratio::new(-3, 1).unwrap(), ..cam(KNIFE, CamStart::Relative) };
    rig.give(on(request));
    rig.run(1);
    assert_eq!((rig.int("x.in_sync"), slave(&rig)), (1, Position::whole(700)));
    // 6000 inc of the master are 3000 inc of the table: from 1500 there, -4500 inc of the slave.
    rig.give(Action::Move(Move { velocity: 20_000.0, acceleration: 1e5, deceleration: 1e5, ..to(LINE, 9_333) }));
    rig.run_until("line.state", 1);
    assert_eq!(slave(&rig), Position::whole(700 - 4500));
}

#[test]
fn offsets_shift_master_and_slave() {
    let mut rig = rig();
    let request = CamIn {
        master_offset: Length::whole(17_000),
        slave_offset: Length::whole(-2_500),
        ..cam(KNIFE, CamStart::Absolute)
    };
    // At 17000 the cam is at 2500.
    rig.give(on(request));
    rig.run(1);
    assert_eq!((rig.int("x.in_sync"), slave(&rig)), (1, Position::ZERO));
    rig.give(Action::Move(Move { velocity: 5_000.0, ..to(LINE, 2_000) }));
    rig.run_until("line.state", 1);
    assert_eq!(slave(&rig), Position::whole(500 - 2_500));
}

#[test]
fn a_cam_with_an_end_ends_its_goal_there_and_rests() {
    let mut rig = rig();
    let goal = rig.give(on(cam(ONCE, CamStart::Relative)));
    rig.give(Action::Move(at(LINE, 10_000.0)));
    for _ in 0..1000 {
        rig.run(1);
        let place = slave(&rig);
        assert!(place <= Position::whole(3000), "it never passes its end: {place:?}");
    }
    let done = rig.done(goal);
    assert_eq!((done.len(), done[0].code), (1, Code::NONE));
    assert_eq!((rig.state("x"), slave(&rig)), ("STANDSTILL", Position::whole(3000)));
    let passed = rig.give(on(cam(ONCE, CamStart::RampIn)));
    rig.run(1);
    assert_eq!(rig.answer(passed).unwrap_err().code, Code::CAM_PASSED);
    assert!(rig.refusal(passed).contains("of the cam, which runs from 0 to 2000"), "{}", rig.refusal(passed));
}

fn ends(rig: &mut Rig, table: &[(i64, i64)], speed: f64, cycles: u64) -> Vec<f64> {
    let once = CamSetting { is_cyclic: false, ..CamSetting::default() };
    let numbers = Action::LoadTable { index: ONCE, table: Arc::new(xy(table).with_cam(once)) };
    rig.give(numbers);
    rig.give(on(cam(ONCE, CamStart::Relative)));
    rig.give(Action::Move(Move { acceleration: 50_000.0, ..at(LINE, speed) }));
    let place = |rig: &mut Rig| {
        rig.run(1);
        slave(rig).to_f64()
    };
    (0..cycles).map(|_| place(rig)).collect()
}

/// The cam crosses its end value in the middle of the table, which is not its end.
#[test]
fn a_cam_is_not_slowed_down_where_it_passes_its_last_value_before_the_end() {
    let mut rig = rig();
    // 5 inc per cycle: 50 inc of the slave, and corners of 100 inc.
    ends(&mut rig, &[(0, 0), (1000, 10_000), (2000, 10_000), (3000, 5000)], 5000.0, 200);
    assert_eq!(rig.int("x.in_sync"), 1, "before 5000 and behind it");
    assert!((rig.real("x.command.velocity") - 50_000.0).abs() < 1e-3, "{}", rig.real("x.command.velocity"));
    rig.run(900);
    assert_eq!((rig.state("x"), slave(&rig)), ("STANDSTILL", Position::whole(5000)));
}

/// 40 inc per cycle up to a dwell of one increment: 800 inc are needed to stop from there.
#[test]
fn a_short_dwell_at_the_end_is_not_passed() {
    let mut rig = rig();
    let places = ends(&mut rig, &[(0, 0), (1999, 3998), (2000, 3998)], 20_000.0, 1000);
    assert!(places.iter().all(|place| *place <= 3998.0 + 1e-6), "{:?}", places.iter().copied().fold(0.0, f64::max));
    assert_eq!((rig.state("x"), slave(&rig)), ("STANDSTILL", Position::whole(3998)));
}

#[test]
fn new_numbers_of_another_length_are_refused_while_an_axis_follows() {
    let mut rig = rig();
    rig.give(on(cam(KNIFE, CamStart::Absolute)));
    let refused = rig.give(Action::LoadTable { index: KNIFE, table: Arc::new(xy(&[(0, 0), (10_000, 20_000)])) });
    rig.run(1);
    assert_eq!(
        rig.refusal(refused),
        "knife: the new numbers are 10000 inc of the master long; an axis follows it over 20000, and keeps its place in it"
    );
}

/// The slave must not move backwards, so it cannot reach the end: the goal ends with this reason and does not remain
/// active.
#[test]
fn a_slave_that_may_not_go_back_to_the_end_ends_its_goal_with_that() {
    let mut rig = rig_with(2);
    ends(&mut rig, &[(0, 0), (1000, 3000), (2000, 2000)], 5000.0, 1000);
    assert_eq!(rig.state("x"), "STANDSTILL");
    let codes: Vec<_> = rig.events.iter().filter(|event| event.kind == Kind::Done).map(|event| event.code).collect();
    assert!(codes.contains(&Code::REVERSE_FORBIDDEN), "{codes:?}");
}

/// Released in a dwell, the axis stands still, whatever it did before.
#[test]
fn axis_released_in_dwell_stands_still() {
    let mut rig = rig();
    let request = Synchronize {
        disengage: Disengage::KeepVelocity,
        cam: Some(cam(KNIFE, CamStart::Relative)),
        ..couple(X, Leader::Encoder(0), 0, 0)
    };
    let goal = rig.give(Action::Synchronize(request));
    for _ in 0..410 {
        rig.plant.jump_encoder(0, 20);
        rig.run(1);
    }
    rig.give(Action::Cancel { goal });
    rig.run(200);
    assert_eq!(rig.real("x.command.velocity"), 0.0);
}

/// The last slope is 2: the axis continues with twice the velocity of the master.
#[test]
fn a_cam_with_an_end_may_leave_its_slave_running() {
    let mut rig = rig();
    let request = Synchronize {
        disengage: Disengage::KeepVelocity,
        cam: Some(cam(ONCE, CamStart::Relative)),
        ..couple(X, Leader::AxisCommand(LINE), 0, 0)
    };
    let goal = rig.give(Action::Synchronize(request));
    rig.give(Action::Move(at(LINE, 10_000.0)));
    let mut before = 0.0;
    for _ in 0..500 {
        rig.run(1);
        let velocity = rig.real("x.command.velocity");
        // After the corner it catches up with a higher velocity.
        let least = f64::min(before, 20_000.0);
        assert!(velocity >= least - 1e-6, "{velocity} behind {before}");
        before = velocity;
    }
    assert_eq!(rig.done(goal)[0].code, Code::NONE);
    assert_eq!((rig.state("x"), rig.real("x.command.velocity")), ("CONTINUOUS_MOTION", 20_000.0));
}

#[test]
fn invalid_cam_is_refused_with_its_table() {
    let mut rig = rig();
    for (table, sentence) in [
        (WORDS, "words: words of a data block are no cam; form y and form xy are"),
        (EVEN, "even: it has form y and no length; a cam needs one, in increments of its master"),
    ] {
        let refused = rig.give(on(cam(table, CamStart::Relative)));
        rig.run(1);
        assert_eq!(rig.refusal(refused), sentence);
        assert_eq!(rig.state("x"), "STANDSTILL");
    }
}

/// At 4000 the tables differ by 1000: the slave reaches the new one within its limits, and follows it exactly.
#[test]
fn new_table_values_apply_at_once_without_a_step() {
    let mut rig = rig();
    rig.give(on(cam(KNIFE, CamStart::Absolute)));
    rig.give(Action::Move(Move { velocity: 10_000.0, ..to(LINE, 4_000) }));
    rig.run_until("line.state", 1);
    assert_eq!(slave(&rig), Position::whole(2_000));
    let load = |points: &[(i64, i64)]| Action::LoadTable { index: KNIFE, table: Arc::new(xy(points)) };
    let refused = rig.give(load(&[(0, 0), (5, 1), (5, 2)]));
    rig.run(1);
    assert_eq!(rig.refusal(refused), "knife: point 3 is at 5; the first is at 0, and each is after the one before it");
    assert_eq!(slave(&rig), Position::whole(2_000));
    rig.give(load(&[(0, 0), (8_000, 6_000), (20_000, 0)]));
    let mut before = (slave(&rig), 0.0);
    for _ in 0..200 {
        rig.run(1);
        let step = (slave(&rig) - before.0).to_f64();
        // 1e6 inc/s^2 is 1 inc per cycle^2.
        assert!((step - before.1).abs() <= 1.000_001, "{step} behind {}", before.1);
        before = (slave(&rig), step);
    }
    assert_eq!((rig.int("x.in_sync"), slave(&rig)), (1, Position::whole(3_000)));
}

/// A period of 20000 inc in one cycle is allowed, 20001 inc is not.
#[test]
fn a_master_that_runs_more_than_a_period_in_a_cycle_ends_it_with_an_error() {
    let mut rig = rig();
    let request = CamIn { master_scale: Ratio::new(1000, 1).unwrap(), ..cam(KNIFE, CamStart::Relative) };
    let belt = Synchronize { cam: Some(request), ..couple(X, Leader::Encoder(0), 0, 0) };
    let goal = rig.give(Action::Synchronize(belt));
    rig.run(2);
    rig.plant.jump_encoder(0, 20);
    rig.run(1);
    assert_eq!(rig.state("x"), "SYNCHRONIZED_MOTION");
    rig.plant.jump_encoder(0, 21);
    rig.run(1);
    assert_eq!(rig.done(goal)[0].code, Code::CAM_MASTER_TOO_FAST);
    assert_eq!(rig.state("x"), "ERROR_STOP");
}

/// Only the memory shows such an error: a state saved with an active cam continues bit for bit.
#[test]
fn a_state_goes_on_in_the_middle_of_a_period() {
    let mut rig = rig();
    rig.give(on(CamIn { slave_scale: Ratio::new(7, 3).unwrap(), ..cam(KNIFE, CamStart::Absolute) }));
    rig.give(Action::Move(at(LINE, 3_000.0)));
    rig.run(777);
    let mut twin = rig.restored_machine();
    let (mut mine, mut others) = (rig.machine.outputs(), twin.outputs());
    for _ in 0..2_000 {
        let inputs = rig.inputs().clone();
        rig.machine.cycle(&inputs, Commands::default(), &mut mine);
        twin.cycle(&inputs, Commands::default(), &mut others);
        assert_eq!(mine, others);
    }
    assert_eq!(rig.machine.state.leads, twin.state.leads);
}

//! Time at which a new value takes effect: the machine acts as each parameter row states.
//!
//! Two machines run the same motions, and in one of them a parameter is set in between.

use super::rig::{LINE, Rig, X, at, config, couple, to};
use crate::command::{Action, Move, Synchronize};
use crate::config::MachineConfig;
use crate::object::{AxisSet, Leader};
use crate::parameter::{AxisParameters, Change, Effect, ROWS, Row, System, Value};
use crate::position::{Length, Position};
use crate::sim::{Model, SecondOrder};
use crate::vocabulary::wf::{Block, Blocks, Jog, Mode, Request, Speed};

const MS: i64 = 1_000_000;

fn change(key: &str, value: Value) -> Change {
    let (row, _) = Row::find(key).unwrap_or_else(|| panic!("no row {key}"));
    Change { axis: X, row, value }
}

fn set(rig: &mut Rig, changes: &[(&str, Value)]) {
    let changes: Box<[Change]> = changes.iter().map(|(key, value)| change(key, *value)).collect();
    let sequence = rig.give(Action::SetParameters(changes));
    assert!(rig.was_accepted(sequence));
}

/// 3000 rpm at 500 lines are 100000 inc/s; all rates are relative, as in MACS, and the profile shape uses all of them.
fn relative() -> MachineConfig {
    let mut config = config(0);
    let p = &mut config.axes[usize::from(X)].parameters;
    for (key, value) in [
        ("velmax", Value::Real(3000.0)),
        ("rampmin", Value::Int(100 * MS)),
        ("jerkmin", Value::Int(50 * MS)),
        ("dfltvel", Value::Int(50)),
        ("dfltacc", Value::Int(50)),
        ("profile", Value::Int(2)),
        ("wf.fixed_speed_1", Value::Real(20.0)),
    ] {
        assert_eq!(Row::find(key).map(|(_, row)| row.assign(p, value)), Some(Ok(())), "{key}");
    }
    config
}

/// Returns the bits of the command of x.
fn command(rig: &Rig) -> [u64; 4] {
    let real = |name| rig.real(name).to_bits();
    let position = rig.int("x.command.position").cast_unsigned();
    [position, real("x.command.fraction"), real("x.command.velocity"), real("x.command.acceleration")]
}

fn step(one: &mut Rig, other: &mut Rig) {
    one.run(1);
    other.run(1);
}

/// Returns the commands of x until it is at rest.
fn commands_to_rest(rig: &mut Rig) -> Vec<[u64; 4]> {
    let mut course = Vec::new();
    while rig.state("x") != "STANDSTILL" || course.is_empty() {
        rig.run(1);
        course.push(command(rig));
        assert!(course.len() < 20_000, "it never stands: {}", rig.state("x"));
    }
    course
}

/// Returns values for the rows with effect on the next motion, so that the next motion differs. Those of the modules
/// apply to a block.
fn next_motion() -> Vec<(&'static str, Value)> {
    vec![
        ("max_velocity", Value::Real(60_000.0)),
        ("max_acceleration", Value::Real(600_000.0)),
        ("max_deceleration", Value::Real(600_000.0)),
        ("max_jerk", Value::Real(9e6)),
        ("profile", Value::Int(0)),
        ("default_velocity", Value::Real(30_000.0)),
        ("default_acceleration", Value::Real(200_000.0)),
        ("velmax", Value::Real(2000.0)),
        ("velres", Value::Int(200)),
        ("rampmin", Value::Int(200 * MS)),
        ("ramptype", Value::Int(1)),
        ("dfltvel", Value::Int(30)),
        ("dfltacc", Value::Int(30)),
        ("jerkmin", Value::Int(120 * MS)),
        ("jerkmin2", Value::Int(120 * MS)),
        ("jerkmin3", Value::Int(120 * MS)),
        ("jerkmin4", Value::Int(120 * MS)),
        ("encoder", Value::Int(250)),
    ]
}

/// Returns the same for the positioning modules.
fn next_block() -> Vec<(&'static str, Value)> {
    vec![
        ("wf.md1", Value::Real(200_000.0)),
        ("wf.md2", Value::Real(200_000.0)),
        ("wf.zero_offset", Value::Int(777)),
        ("wf.tool_length", Value::Int(-777)),
    ]
}

fn next_jog() -> Vec<(&'static str, Value)> {
    vec![
        ("wf.fixed_speed_1", Value::Real(10.0)),
        ("wf.fixed_speed_2", Value::Real(10.0)),
        ("wf.fixed_speed_3", Value::Real(10.0)),
    ]
}

/// Gives both machines the same goal and sets the row in one of them after `wait` cycles: the motion is unchanged, and
/// the next one differs.
fn assert_keeps_until_the_next(name: &str, value: Value, wait: u64, [first, second]: [Action; 2]) {
    let [mut plain, mut changed] = [Rig::of(relative()), Rig::of(relative())];
    plain.enable();
    changed.enable();
    for rig in [&mut plain, &mut changed] {
        rig.give(first.clone());
        rig.run(wait);
        assert_ne!(rig.real("x.command.velocity"), 0.0, "{name}: in motion");
    }
    set(&mut changed, &[(name, value)]);
    plain.run(1);
    assert_eq!(command(&changed), command(&plain), "{name}");
    for _ in 0..50 {
        step(&mut plain, &mut changed);
        assert_eq!(command(&changed), command(&plain), "{name}");
    }
    assert_eq!(commands_to_rest(&mut changed), commands_to_rest(&mut plain), "{name}: the motion under way");
    for rig in [&mut plain, &mut changed] {
        rig.run(20);
        let again = rig.give(second.clone());
        assert!(rig.was_accepted(again), "{name}");
    }
    assert_ne!(commands_to_rest(&mut changed), commands_to_rest(&mut plain), "{name}: the next motion");
}

fn is_set_in_motion(row: &Row) -> bool {
    row.missing.is_empty() && !row.is_read_only() && row.effect == Effect::NextMotion
}

#[test]
fn every_row_of_next_motion_is_tried_here() {
    let tried: Vec<_> = next_motion().into_iter().chain(next_block()).chain(next_jog()).map(|(key, _)| key).collect();
    for row in ROWS.iter().filter(|row| is_set_in_motion(row)) {
        assert!(tried.contains(&row.key), "{}", row.key);
    }
    for key in tried {
        assert!(Row::find(key).is_some_and(|(_, row)| is_set_in_motion(row)), "{key}");
    }
}

/// Proves: MACS-STO-09, MACS-UNIT-06
#[test]
fn a_running_motion_keeps_what_it_began_with_and_the_next_one_differs() {
    for (key, value) in next_motion() {
        for wait in [20, 200, 900] {
            // 60000 inc at 50000 inc/s: during acceleration, at constant velocity, during deceleration.
            assert_keeps_until_the_next(key, value, wait, [to(X, 60_000), to(X, 0)].map(Action::Move));
        }
    }
}

#[test]
fn a_running_block_keeps_what_it_began_with_and_the_next_one_differs() {
    let block = |position: i64| {
        let block = Block { position: Position::whole(position), speed: Speed::Value(40.0), absolute: true };
        let request = Request {
            axis: X,
            mode: Some(Mode::Mdi),
            blocks: Blocks::new(&[block]),
            start: true,
            ..Request::default()
        };
        Action::vocabulary(request)
    };
    for (key, value) in next_block() {
        assert_keeps_until_the_next(key, value, 100, [block(60_000), block(20_000)]);
    }
}

#[test]
fn a_running_jog_keeps_its_speed_and_the_next_one_differs() {
    let jog = |choice, jog| {
        let request =
            Request { axis: X, mode: Some(Mode::Jog), fixed_speed: choice, jog: Some(jog), ..Request::default() };
        Action::vocabulary(request)
    };
    let (plus, off) = (jog(Some(1), Jog::Plus), jog(None, Jog::None));
    let speed = |rig: &Rig| rig.real("x.command.velocity");
    let [mut plain, mut changed] = [Rig::of(relative()), Rig::of(relative())];
    for rig in [&mut plain, &mut changed] {
        rig.enable();
        rig.give(plus.clone());
        rig.run(300);
        assert_eq!(speed(rig), 20_000.0);
    }
    set(&mut changed, &next_jog());
    changed.run(300);
    assert_eq!(speed(&changed), 20_000.0);
    changed.give(off);
    commands_to_rest(&mut changed);
    for choice in 1..=3 {
        changed.give(jog(Some(choice), Jog::Plus));
        changed.run(300);
        assert_eq!(speed(&changed), 10_000.0, "fixed speed {choice}");
    }
}

/// MACS-PROF-05: the profile runs in every cycle, with any period.
/// Proves: MACS-PROF-05, MACS-STO-09
#[test]
fn the_period_of_the_profile_changes_no_motion() {
    let [mut plain, mut changed] = [Rig::of(relative()), Rig::of(relative())];
    for rig in [&mut plain, &mut changed] {
        rig.enable();
        rig.give(Action::Move(to(X, 60_000)));
        rig.run(100);
    }
    for period in [5, 3, 1, 2] {
        set(&mut changed, &[("proftime", Value::Int(period))]);
        plain.run(1);
        assert_eq!(command(&changed), command(&plain));
    }
    assert_eq!(commands_to_rest(&mut changed), commands_to_rest(&mut plain));
    plain.give(Action::Move(to(X, 0)));
    changed.give(Action::Move(to(X, 0)));
    assert_eq!(commands_to_rest(&mut changed), commands_to_rest(&mut plain));
    let proftime = |period| changed.give(Action::SetParameters([change("proftime", Value::Int(period))].into()));
    let refused = [0, 6].map(proftime);
    assert_eq!(changed.refusal(refused[0]), "x: proftime is 0; 1 to 5 is allowed");
    assert_eq!(changed.refusal(refused[1]), "x: proftime is 6; 1 to 5 is allowed");
}

/// VEL 500, ACC 500 and DEC 250 of VELRES 1000 are fields of a goal, in units. A goal without them uses DFLTVEL 250 and
/// DFLTACC 125, independent of the previous goal, before and after a change of PROFTIME.
///
/// Proves: MACS-CMD-08
#[test]
fn the_rates_of_a_goal_are_its_own_or_parts_of_velres() {
    let mut config = config(0);
    let p = &mut config.axes[usize::from(X)].parameters;
    // 3000 rpm at 500 lines are 100000 inc/s, reached in 500 ms: 200000 inc/s^2.
    for (key, value) in [
        ("encoder", Value::Int(500)),
        ("velmax", Value::Real(3000.0)),
        ("rampmin", Value::Int(500 * MS)),
        ("velres", Value::Int(1000)),
        ("dfltvel", Value::Int(250)),
        ("dfltacc", Value::Int(125)),
    ] {
        assert_eq!(Row::find(key).map(|(_, row)| row.assign(p, value)), Some(Ok(())), "{key}");
    }
    let mut rig = Rig::of(config);
    rig.enable();
    // From 0 to VELMAX in 500 ms * 1000 / 125, so that 25000 inc/s take 1 s and 12500 inc.
    let usual = [(500, 12_500.0), (1_000, 25_000.0), (2_000, 25_000.0), (2_500, 12_500.0), (3_000, 0.0)];
    let given = Move { velocity: 50_000.0, acceleration: 100_000.0, deceleration: 50_000.0, ..to(X, 150_000) };
    // 500 ms of acceleration, 1000 ms of deceleration, and 62500 inc between them.
    let own = [(250, 25_000.0), (500, 50_000.0), (1_750, 50_000.0), (2_000, 37_500.0), (2_750, 0.0)];
    for (goal, proftime, course) in
        [(to(X, 50_000), 1, usual), (given, 2, own), (to(X, 200_000), 5, usual), (to(X, 250_000), 3, usual)]
    {
        set(&mut rig, &[("proftime", Value::Int(proftime))]);
        let sequence = rig.give(Action::Move(goal));
        let mut passed = 0;
        for (ms, velocity) in course {
            rig.run(ms - passed);
            passed = ms;
            assert!((rig.real("x.command.velocity") - velocity).abs() < 0.001, "{goal:?} after {ms} ms");
            if ms < 1_000 {
                // In motion, too: it does not change the motion.
                set(&mut rig, &[("proftime", Value::Int(proftime % 5 + 1))]);
                passed += 1;
            }
        }
        assert_eq!(rig.int("x.command.position"), goal.target.nearest);
        rig.run(5);
        assert_eq!(rig.done(sequence).len(), 1);
    }
}

/// Proves: MACS-STO-09, MACS-SYNC-16
#[test]
fn a_coupling_keeps_what_it_began_with_and_the_next_one_differs() {
    let all: Vec<_> =
        ROWS.iter().filter(|row| row.missing.is_empty() && row.effect == Effect::NextSynchronize).collect();
    assert_eq!(
        all.iter().map(|row| row.key).collect::<Vec<_>>(),
        ["syncfactm", "syncfacts", "syncaccuracy", "synctype", "syncmtypm", "syncmtyps", "syncmstart"]
    );
    let shown = |rig: &Rig| (command(rig), rig.int("x.sync.error"), rig.int("x.sync.status"));
    // The smallest window, with the sign of the error.
    // For the rows of marks see tests/marks.rs.
    for (key, value) in [("syncfactm", -3), ("syncfacts", 5), ("syncaccuracy", -1), ("synctype", 4)] {
        let [mut plain, mut changed] = [Rig::enabled(), Rig::enabled()];
        for rig in [&mut plain, &mut changed] {
            rig.give(Action::Move(at(LINE, -20_000.0)));
            rig.run(300);
            rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 0, 0)));
            rig.run(10);
        }
        set(&mut changed, &[(key, Value::Int(value))]);
        plain.run(1);
        for _ in 0..500 {
            assert_eq!(shown(&changed), shown(&plain), "{key}");
            step(&mut plain, &mut changed);
        }
        let mut differs = false;
        for rig in [&mut plain, &mut changed] {
            // An offset is an error that is reduced gradually.
            let offset = Length::whole(2_000);
            let again = Synchronize { offset, ..couple(X, Leader::AxisCommand(LINE), 0, 0) };
            rig.give(Action::Synchronize(again));
        }
        for _ in 0..500 {
            differs |= shown(&changed) != shown(&plain);
            step(&mut plain, &mut changed);
        }
        assert!(differs, "{key}");
    }
}

/// Rows that act at once, with the tests that show it; those of vocabularies are in their own tests.
const AT_ONCE: &[&str] = &[
    "min_position",
    "max_position",
    "neglimit",
    "poslimit",
    "swneglimact",
    "swposlimact",
    "velocity_override",
    "max_following_error",
    "poserr",
    "following_error_time",
    "poserrtime",
    "in_position_window",
    "testwin",
    "in_position_time",
    "testtim",
    "error_reaction",
    "errcond",
    "setpoint_timeout",
    // tests/probe.rs
    "probe_active_input",
    "mencoder",
    // machine/tests/homing.rs
    "homing.required",
    "homing.max_time",
    "home_force",
    "i_refswitch",
    "i_poslimitsw",
    "i_neglimitsw",
    // tests/feedback.rs
    "max_encoder_jump",
    "max_skew",
    "skew_reaction",
    "i_refswitch_second",
    "enccontrol",
    "menccontrol",
    // tests/master.rs
    "master_simulation_velocity",
    // tests/conditioning.rs
    "syncofftime",
    "syncposoffs",
    "syncmpulsm",
    "syncvftime",
    "syncvelrel",
    "syncffvel",
    "syncvflimit",
    // tests/marks.rs, sync/marker
    "syncmmaxcorr",
    "syncmfpar",
    "syncmftime",
    "syncmarkm",
    "syncmarks",
    "syncready",
    "syncfault",
    "syncmpulss",
    "syncmwinm",
    "syncmwins",
    "syncsftime",
    // Stored, without effect.
    "proftime",
    // Read in each cycle by the position loop: closed_loop.yaml.
    "position_loop.kv",
    "wf.md22",
    // tests/loops/pid.rs
    "kprop",
    "kder",
    "kint",
    "kilim",
    "kilimtime",
    "bandwidth",
    "ffvel",
    "ffacc",
    "regwmin",
    "regwmax",
    // tests/compensation.rs
    "compensation.backlash",
    "compensation.velocity",
    // tests/loops/torque.rs
    "velkprop",
    "velkint",
    "velkilim",
    "ampmaxcur",
    "i2tftime",
    "i2tlimit",
    "curftime",
    // tests/loops/voltage.rs
    "curkprop",
    "curkint",
    "curkilim",
    // tests/panel.rs
    "i_break",
    "i_continue",
    "i_errclr",
    "o_error",
    "ainftime",
    // tests/virtual_master.rs
    "pulsvel",
    "pulsacc",
    "setsys_15",
    "vmencres",
    "vmencmtyp",
    "o_brake",
    "o_axmove",
    // tests/panel/abort.rs
    "esccond",
    // tests/limits/streamed.rs
    "jog_at_limit",
];

/// The same, in limit_switches.rs and reactions.rs.
const WATCHING: &[&str] = &[
    "testval",
    "endswmod",
    "following_error_check",
    "following_error_stops_all",
    "in_position_timeout",
    "i_refswitch",
    "i_poslimitsw",
    "i_neglimitsw",
];

#[test]
fn every_row_that_acts_at_once_is_tried_here_or_by_its_vocabulary() {
    let acts = |row: &&Row| row.missing.is_empty() && !row.is_read_only() && row.effect == Effect::AtOnce;
    for row in ROWS.iter().filter(acts) {
        let is_own = matches!(row.system, System::Amc | System::Saia | System::Wf);
        let is_tried = AT_ONCE.contains(&row.key) || WATCHING.contains(&row.key);
        assert!(is_own || is_tried, "{}", row.key);
    }
    for key in AT_ONCE.iter().chain(WATCHING) {
        assert!(Row::find(key).is_some_and(|(_, row)| acts(&row)), "{key}");
    }
}

/// Proves: MACS-UNIT-09
#[test]
fn the_master_is_shown_in_its_units_from_the_cycle_on_in_which_mencoder_is_negative() {
    let mut rig = Rig::enabled();
    set(&mut rig, &[("syncfactm", Value::Int(2048)), ("syncfacts", Value::Int(55))]);
    rig.give(Action::Move(to(LINE, 2_048)));
    rig.run(3_000);
    rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 0, 0)));
    rig.run(2);
    assert_eq!(rig.real("x.master.position"), 2_048.0);
    set(&mut rig, &[("mencoder", Value::Int(-500))]);
    assert_eq!(rig.real("x.master.position"), 55.0);
}

/// Proves: MACS-LIM-02
#[test]
fn a_limit_is_in_force_in_the_cycle_in_which_it_is_set() {
    for (changes, signal) in [
        (&[("min_position", Value::Int(0))][..], "x.limit.software_negative"),
        (&[("max_position", Value::Int(0))], "x.limit.software_positive"),
        (&[("swneglimact", Value::Int(1)), ("neglimit", Value::Int(0))], "x.limit.software_negative"),
        (&[("poslimit", Value::Int(0)), ("swposlimact", Value::Int(1))], "x.limit.software_positive"),
    ] {
        let mut rig = Rig::enabled();
        assert_eq!(rig.int(signal), 0);
        set(&mut rig, changes);
        assert_eq!(rig.int(signal), 1, "{changes:?}");
        let switch = if signal.ends_with("negative") { "swneglimact" } else { "swposlimact" };
        set(&mut rig, &[(switch, Value::Int(0))]);
        assert_eq!(rig.int(signal), 0, "{switch}");
    }
    // In a motion without an end: it stops at the limit.
    for key in ["max_position", "poslimit"] {
        let mut config = config(0);
        config.axes[usize::from(X)].parameters.max_position = Some(500_000);
        let mut rig = Rig::of(config);
        rig.enable();
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(300);
        set(&mut rig, &[(key, Value::Int(30_000))]);
        rig.run(2_000);
        assert_eq!((rig.int("x.command.position"), rig.state("x")), (30_000, "ERROR_STOP"), "{key}");
    }
}

#[test]
fn an_override_bends_the_motion_of_the_next_cycle() {
    let [mut plain, mut changed] = [Rig::enabled(), Rig::enabled()];
    for rig in [&mut plain, &mut changed] {
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(300);
    }
    set(&mut changed, &[("velocity_override", Value::Real(25.0))]);
    plain.run(1);
    assert_eq!(command(&changed)[..3], command(&plain)[..3]);
    changed.run(1);
    assert!(changed.real("x.command.velocity") < 50_000.0);
}

/// Returns a rig in which x has a soft drive.
fn soft(bandwidth: f64) -> Rig {
    let mut config = config(0);
    config.axes[usize::from(X)].parameters =
        AxisParameters { max_following_error: 100_000, ..config.axes[usize::from(X)].parameters };
    let model = Model::SecondOrder(SecondOrder::new(bandwidth, 1.0, MS as u64).expect("a drive"));
    let mut rig = Rig::with(config, [model, Model::Ideal]);
    rig.enable();
    rig
}

/// Proves: MACS-ERR-06
#[test]
fn a_following_error_is_judged_by_the_new_tolerance_at_once() {
    for key in ["max_following_error", "poserr"] {
        let mut rig = soft(10.0);
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(300);
        let error = rig.int("x.following_error");
        assert!(error > 500, "{error}");
        set(&mut rig, &[(key, Value::Int(error + 100))]);
        assert_eq!(rig.state("x"), "CONTINUOUS_MOTION");
        set(&mut rig, &[(key, Value::Int(error - 100))]);
        assert_eq!(rig.state("x"), "ERROR_STOP", "{key}");
    }
    for key in ["following_error_time", "poserrtime"] {
        let mut rig = soft(10.0);
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(300);
        set(&mut rig, &[(key, Value::Int(10_000 * MS)), ("max_following_error", Value::Int(10))]);
        rig.run(100);
        assert_eq!(rig.state("x"), "CONTINUOUS_MOTION");
        set(&mut rig, &[(key, Value::Int(0))]);
        assert_eq!(rig.state("x"), "ERROR_STOP", "{key}");
    }
}

/// Proves: MACS-ERR-02
#[test]
fn an_error_has_the_reaction_that_is_set_in_its_cycle() {
    for key in ["error_reaction", "errcond"] {
        for (reaction, enabled, brake, state) in
            [(0, 0, 0, "ERROR_STOP"), (1, 0, 1, "ERROR_STOP"), (2, 1, 0, "ERROR_STOP"), (5, 1, 0, "CONTINUOUS_MOTION")]
        {
            let mut rig = soft(10.0);
            rig.give(Action::Move(at(X, 50_000.0)));
            rig.run(300);
            set(&mut rig, &[(key, Value::Int(reaction)), ("max_following_error", Value::Int(10))]);
            let shown = (rig.int("x.enabled"), rig.int("x.brake"), rig.state("x"));
            assert_eq!(shown, (enabled, brake, state), "{key} {reaction}");
        }
    }
}

/// Proves: MACS-TGT-02, MACS-TGT-04
#[test]
fn a_target_window_is_judged_anew_at_once() {
    for key in ["in_position_window", "testwin"] {
        let mut rig = soft(2.0);
        set(&mut rig, &[(key, Value::Int(1))]);
        rig.give(Action::Move(to(X, 20_000)));
        rig.run_until("x.command.position", 20_000);
        rig.run(1);
        let away = 20_000 - rig.int("x.actual.position");
        assert!(away > 100 && away < 10_000, "{away}");
        assert_eq!(rig.int("x.in_position"), 0);
        set(&mut rig, &[(key, Value::Int(away))]);
        assert_eq!(rig.int("x.in_position"), 1, "{key}");
    }
    for key in ["in_position_time", "testtim"] {
        let mut rig = Rig::enabled();
        set(&mut rig, &[("in_position_window", Value::Int(10)), (key, Value::Int(10 * MS))]);
        rig.give(Action::Move(to(X, 20_000)));
        rig.run_until("x.command.position", 20_000);
        rig.run(5);
        assert_eq!(rig.int("x.in_position"), 0);
        set(&mut rig, &[(key, Value::Int(0))]);
        assert_eq!(rig.int("x.in_position"), 1, "{key}");
    }
}

#[test]
fn a_setpoint_holds_as_long_as_its_time_says_now() {
    let mut rig = Rig::enabled();
    rig.stream(X, 20_000.0);
    rig.run(50);
    assert_eq!(rig.real("x.command.velocity"), 20_000.0);
    set(&mut rig, &[("setpoint_timeout", Value::Int(20 * MS))]);
    rig.run(1);
    assert!(rig.real("x.command.velocity") < 20_000.0);
    rig.give(Action::Disable(AxisSet::first(3)));
}

/// Proves: MACS-STO-08
#[test]
fn derived_values_update_in_the_cycle_of_the_set() {
    let mut rig = Rig::of(relative());
    let shown = |rig: &Rig, key: &str| {
        let (_, row) = Row::find(key).unwrap_or_else(|| panic!("{key}"));
        row.value(rig.machine.parameters(X).expect("x"))
    };
    // 100 inc/ms and 1 inc/ms^2, in parts of 65536.
    assert_eq!((shown(&rig, "velmaxqc"), shown(&rig, "accmaxqc")), (Value::Int(6_553_600), Value::Int(65_536)));
    set(&mut rig, &[("velmax", Value::Real(1500.0))]);
    assert_eq!((shown(&rig, "velmaxqc"), shown(&rig, "accmaxqc")), (Value::Int(3_276_800), Value::Int(32_768)));
    let refused = rig.give(Action::SetParameters([change("velmaxqc", Value::Int(1))].into()));
    assert!(rig.refusal(refused).contains("velmaxqc"));
    assert_eq!(shown(&rig, "velmaxqc"), Value::Int(3_276_800));
}

/// A jerk limit that comes into force during a ramp without jerk limit, and that would need hours to reverse that ramp,
/// does not apply to the stop: it would move the axis beyond all limits.
#[test]
fn a_motion_without_limit_of_jerk_stops_without_one() {
    for shape in [0, 1] {
        let mut rig = Rig::enabled();
        set(&mut rig, &[("profile", Value::Int(shape))]);
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(20);
        let before = rig.real("x.command.velocity");
        assert!(before > 0.0 && rig.real("x.command.acceleration") > 0.0);
        set(&mut rig, &[("profile", Value::Int(2)), ("max_jerk", Value::Real(1.0))]);
        rig.give(Action::QuickStop(AxisSet::one(X)));
        for _ in 0..2_000 {
            rig.run(1);
            let velocity = rig.real("x.command.velocity");
            assert!((0.0..=50_000.0).contains(&velocity), "profile {shape}: {velocity} inc/s");
        }
        assert_eq!(rig.real("x.command.velocity"), 0.0, "profile {shape}");
    }
}

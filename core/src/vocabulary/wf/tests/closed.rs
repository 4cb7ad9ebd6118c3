//! The closed-loop axis on a machine: profile, chains, alarms, setup.

use super::bench::{by, reset, start, to};
use super::rig::{Rig, config};
use crate::code::Code;
use crate::command::{Action, SetPosition};
use crate::object::AxisSet;
use crate::position::Length;
use crate::vocabulary::wf::{Block, Jog, Mode, Request, Speed};

/// Returns a block to a position (mm) at a velocity (mm/s).
fn at(position: i64, velocity: f64) -> Block {
    Block { speed: Speed::Velocity(velocity * 1000.0), ..to(position, 1.0) }
}

fn mm(rig: &Rig) -> f64 {
    (rig.int("x.command.position") as f64 + rig.real("x.command.fraction")) / 1000.0
}

/// Returns the magnitude of the command velocity (mm/s).
fn speed(rig: &Rig) -> f64 {
    rig.real("x.command.velocity").abs() / 1000.0
}

/// 2 s up, 200 mm; 3.5 s at 200 mm/s, 700 mm; 1 s down, 100 mm.
///
/// Proves: WF-ORA-12, WF-CLC-01, WF-TIM-02, WF-MD-01, WF-MD-02
#[test]
fn a_block_is_a_trapezoid_of_md1_and_md2() {
    let mut rig = Rig::wf();
    assert_eq!(rig.wf_verb(&start(Mode::Mdi, &[at(1000, 200.0)])), None);
    assert_eq!((rig.wf_state(), rig.int("x.wf.active"), rig.int("x.wf.enable")), ("RUN", 1, 1));
    rig.run(2000);
    assert!((mm(&rig) - 200.0).abs() < 1e-3 && (speed(&rig) - 200.0).abs() < 1e-9);
    rig.run(3500);
    assert!((mm(&rig) - 900.0).abs() < 1e-3 && (speed(&rig) - 200.0).abs() < 1e-6);
    rig.run(999);
    assert_ne!(rig.int("x.command.position"), 1_000_000);
    rig.run(1);
    assert_eq!((rig.int("x.command.position"), speed(&rig)), (1_000_000, 0.0));
    // The ideal drive is there one cycle later.
    rig.run(1);
    assert_eq!((rig.wf_state(), rig.int("x.wf.peh"), rig.int("x.wf.distance_to_go")), ("DONE", 1, 0));
}

/// 120 mm at up to 200 mm/s: a peak of sqrt(2 120 100 200 / 300) = 126.49 mm/s after 1.2649 s.
///
/// Proves: WF-CLC-02, WF-TIM-03
#[test]
fn a_short_block_turns_from_speeding_up_to_slowing_down() {
    let mut rig = Rig::wf();
    rig.wf_verb(&start(Mode::Mdi, &[at(120, 200.0)]));
    let mut peak = 0.0_f64;
    for cycle in 1..=1898 {
        rig.run(1);
        peak = peak.max(speed(&rig));
        // sqrt(2 120 / 100 (1 + 1/2)) = 1.8974 s.
        assert_eq!(rig.int("x.command.position") == 120_000, cycle == 1898);
    }
    assert!((126.4..126.5).contains(&peak), "{peak}");
}

/// Runs a chain. Returns block, position, velocity of each cycle.
fn trace(rig: &mut Rig) -> Vec<(i64, f64, f64)> {
    let mut all = Vec::new();
    while !["DONE", "ALARM", "IDLE"].contains(&rig.wf_state()) {
        rig.run(1);
        all.push((rig.int("x.wf.block"), mm(rig), speed(rig)));
        assert!(all.len() < 60_000, "it does not end");
    }
    all
}

/// Proves: WF-MOD-01, WF-SET-03
#[test]
fn blocks_of_one_direction_run_on_with_the_lower_speed_through_each_end() {
    let mut rig = Rig::wf();
    let velocities = [200.0, 100.0, 250.0];
    let blocks = [at(500, 200.0), at(700, 100.0), at(1500, 250.0)];
    assert_eq!(rig.wf_verb(&start(Mode::Continuous, &blocks)), None);
    let trace = trace(&mut rig);
    assert_eq!((rig.wf_state(), rig.int("x.command.position")), ("DONE", 1_500_000));
    for &(block, position, speed) in &trace {
        let expected = if position < 500.0 { 1 } else { 2 + i64::from(position >= 700.0) };
        assert_eq!(block, expected, "at {position}");
        assert!(speed <= velocities[block as usize - 1] + 1e-6, "{speed} at {position}");
    }
    let slowest = |from: f64, to: f64| {
        let inside = trace.iter().filter(|(_, position, _)| (from..to).contains(position));
        inside.map(|(_, _, speed)| *speed).fold(f64::MAX, f64::min)
    };
    let fastest = |from: f64, to: f64| {
        let inside = trace.iter().filter(|(_, position, _)| (from..to).contains(position));
        inside.map(|(_, _, speed)| *speed).fold(0.0, f64::max)
    };
    // From 200 to 100 mm/s takes 75 mm at 200 mm/s^2: the slow block begins at its own speed, not before.
    assert!((slowest(200.0, 424.0) - 200.0).abs() < 1e-6);
    assert!((slowest(425.0, 700.0) - 100.0).abs() < 1e-6 && (fastest(500.0, 700.0) - 100.0).abs() < 1e-6);
    assert!((fastest(700.0, 1500.0) - 250.0).abs() < 1e-6, "the fast one speeds up behind its begin");
}

/// 20 mm at 250 mm/s, 10 mm at 200, then 30: the deceleration for the third block begins in the first.
#[test]
fn a_slow_block_behind_short_ones_is_slowed_down_for_in_time() {
    let mut rig = Rig::wf();
    rig.wf_verb(&start(Mode::Continuous, &[at(300, 250.0), at(305, 200.0), at(400, 30.0)]));
    for (block, position, speed) in trace(&mut rig) {
        let most = [250.0, 200.0, 30.0][block as usize - 1];
        assert!(speed <= most + 1e-6, "{speed} at {position}");
    }
    assert_eq!(rig.int("x.command.position"), 400_000);
}

/// Proves: WF-CLC-06
#[test]
fn no_block_exceeds_its_speed_with_any_profile() {
    for profile in 0..=2 {
        let mut config = config();
        config.axes[0].parameters.profile = profile;
        config.axes[0].parameters.max_jerk = Some(400_000.0);
        let mut rig = Rig::wf_of(config);
        let velocities = [250.0, 80.0, 250.0, 240.0, 20.0];
        let blocks = [at(600, 250.0), at(700, 80.0), at(720, 250.0), at(1100, 240.0), at(1200, 20.0)];
        assert_eq!(rig.wf_verb(&start(Mode::Continuous, &blocks)), None);
        let mut fastest = [0.0_f64; 5];
        for (block, position, speed) in trace(&mut rig) {
            let place = block as usize - 1;
            assert!(speed <= velocities[place] * (1.0 + 1e-9), "profile {profile}: {speed} at {position}");
            fastest[place] = fastest[place].max(speed);
        }
        assert_eq!((rig.wf_state(), rig.int("x.command.position")), ("DONE", 1_200_000));
        assert!(fastest[0] > 240.0 && fastest[1] > 79.0 && fastest[4] > 19.0, "{fastest:?}");
    }
}

#[test]
fn a_block_that_turns_back_stops_with_its_position_reached() {
    let mut rig = Rig::wf();
    rig.wf_verb(&start(Mode::Continuous, &[at(300, 100.0), at(100, 100.0), by(-50, 20.0)]));
    rig.run_until("x.wf.state", 6);
    assert_eq!((rig.int("x.wf.block"), rig.int("x.command.position")), (1, 300_000));
    rig.run(1);
    assert_eq!((rig.wf_state(), rig.int("x.wf.block"), rig.int("x.wf.peh")), ("RUN", 2, 0));
    trace(&mut rig);
    assert_eq!((rig.int("x.wf.block"), rig.int("x.command.position")), (3, 50_000));
}

/// Proves: WF-MON-04
#[test]
fn alarm_10_comes_in_travel_and_alarm_11_at_standstill() {
    let mut config = config();
    config.axes[0].parameters.vocabularies.wf.max_following_error = Some(500);
    config.axes[0].parameters.max_following_error = 100_000;
    let mut rig = Rig::wf_of(config);
    rig.wf_verb(&start(Mode::Mdi, &[at(100, 50.0)]));
    rig.run(1000);
    rig.plant.drive(0).unwrap().jump(-600);
    rig.run(2);
    assert_eq!((rig.wf_state(), rig.int("x.wf.alarm"), rig.int("x.wf.enable")), ("ALARM", 10, 0));
    assert_eq!((rig.errors(), rig.int("x.error")), (vec![Code::WF_FOLLOWING_ERROR_IN_TRAVEL], 1010));
    assert_eq!(rig.wf_verb(&reset()), Some(Code::NOT_AT_STANDSTILL));
    rig.run(500);
    assert_eq!((rig.int("x.state"), rig.int("x.wf.active"), speed(&rig)), (7, 0, 0.0));
    assert_eq!(rig.wf_verb(&reset()), None);
    assert_eq!((rig.wf_state(), rig.int("x.wf.alarm"), rig.int("x.error"), rig.int("x.state")), ("IDLE", 0, 0, 1));

    rig.wf_verb(&start(Mode::Mdi, &[at(100, 50.0)]));
    trace(&mut rig);
    assert_eq!(rig.wf_state(), "DONE");
    rig.plant.drive(0).unwrap().jump(600);
    rig.run(2);
    assert_eq!((rig.int("x.wf.alarm"), rig.int("x.error")), (11, 1011));
    rig.act(Action::ResetErrors(AxisSet::first(1)));
    assert_eq!((rig.wf_state(), rig.int("x.wf.alarm"), rig.int("x.error")), ("IDLE", 0, 0), "in one cycle");
    assert_eq!(rig.wf_verb(&start(Mode::Mdi, &[at(50, 50.0)])), None);
}

/// With error_reaction 5 an alarm does not stop the axis. A reset of the error also acknowledges the alarm in that
/// cycle, and the next alarm is reported again.
///
/// Proves: WF-MON-04, WF-MON-06
#[test]
fn an_alarm_that_stops_nothing_is_acknowledged_with_its_error() {
    let mut config = config();
    config.axes[0].parameters.vocabularies.wf.max_following_error = Some(500);
    config.axes[0].parameters.max_following_error = 100_000;
    config.axes[0].parameters.error_reaction = 5;
    let mut rig = Rig::wf_of(config);
    for acknowledge in [Action::ResetErrors(AxisSet::first(1)), Action::vocabulary(reset())] {
        let told = rig.errors().len();
        rig.plant.drive(0).unwrap().jump(-600);
        rig.run(2);
        assert_eq!((rig.int("x.wf.alarm"), rig.int("x.error"), rig.int("x.state")), (11, 1011, 1));
        assert_eq!(rig.errors().len(), told + 1);
        assert_eq!(rig.wf_verb(&start(Mode::Mdi, &[at(100, 50.0)])), Some(Code::WF_ALARM_WAITS));
        assert_eq!(rig.act(acknowledge.clone()), None);
        assert_eq!((rig.wf_state(), rig.int("x.wf.alarm"), rig.int("x.error")), ("IDLE", 0, 0));
        assert_eq!(rig.wf_verb(&start(Mode::Mdi, &[at(if told == 0 { 100 } else { 0 }, 50.0)])), None);
        rig.run(1000);
        rig.plant.drive(0).unwrap().jump(-600);
        rig.run(2);
        assert_eq!((rig.int("x.wf.alarm"), rig.int("x.error"), rig.errors().len()), (10, 1010, told + 2));
        rig.run_until("x.state", 1);
        assert_eq!(rig.act(acknowledge), None);
        assert_eq!((rig.wf_state(), rig.int("x.wf.alarm"), rig.int("x.error")), ("IDLE", 0, 0));
    }
}

fn watched(allowed: Option<i64>) -> Rig {
    let mut config = config();
    config.axes[0].parameters.vocabularies.wf.max_following_error = allowed;
    config.axes[0].parameters.max_following_error = 100_000;
    Rig::wf_of(config)
}

fn velocity(velocity: f64) -> Action {
    Action::Move(crate::machine::rig::at(0, velocity))
}

/// Without any request, at rest and moved by a goal, in each cycle in which the axis is on; an axis without the limit
/// is not monitored, and neither is one that is off.
///
/// Proves: WF-MON-04, WF-MON-06
#[test]
fn the_following_error_is_watched_without_a_verb() {
    for allowed in [None, Some(600), Some(599)] {
        let mut rig = watched(allowed);
        rig.run(10);
        rig.plant.drive(0).unwrap().jump(600);
        rig.run(1);
        let alarm = if allowed == Some(599) { 11 } else { 0 };
        assert_eq!(rig.int("x.wf.alarm"), alarm, "{allowed:?}");
        assert_eq!(rig.int("x.error"), if alarm == 0 { 0 } else { 1011 });
    }
    // A goal of the axis at 50 mm/s lags by 50 inc, because of the cycle of its drive.
    for (allowed, alarm) in [(None, 0), (Some(650), 0), (Some(649), 10)] {
        let mut rig = watched(allowed);
        rig.act(velocity(50_000.0));
        rig.run(1_000);
        rig.mirror();
        rig.plant.drive(0).unwrap().jump(-600);
        rig.run(1);
        assert_eq!(
            (rig.int("x.wf.alarm"), rig.int("x.error")),
            (alarm, if alarm == 0 { 0 } else { 1010 }),
            "{allowed:?}"
        );
    }
    let mut rig = watched(Some(500));
    rig.act(Action::Disable(AxisSet::first(1)));
    rig.run(5);
    rig.plant.drive(0).unwrap().jump(60_000);
    rig.run(5);
    rig.act(Action::Enable(AxisSet::first(1)));
    rig.run(40);
    assert_eq!((rig.int("x.state"), rig.int("x.wf.alarm"), rig.errors()), (1, 0, vec![]));
    // A new zero is no error.
    rig.act(Action::SetPosition(SetPosition { axis: 0, position: Length::whole(5_000_000) }));
    rig.run(5);
    assert_eq!((rig.int("x.actual.position"), rig.int("x.wf.alarm")), (5_000_000, 0));
    // A quick stop does not end it; acknowledged while the cause exists, the alarm is raised again.
    rig.act(Action::QuickStop(AxisSet::first(1)));
    for acknowledge in [Action::ResetErrors(AxisSet::first(1)), Action::vocabulary(reset())] {
        rig.plant.drive(0).unwrap().jump(600);
        rig.run(1);
        assert_eq!((rig.int("x.state"), rig.int("x.wf.alarm"), rig.int("x.wf.enable")), (7, 11, 0));
        rig.run(1);
        rig.act(acknowledge);
        rig.run(2);
        assert_eq!((rig.int("x.state"), rig.int("x.wf.alarm"), rig.int("x.wf.enable")), (1, 0, 1));
    }
    for _ in 0..2 {
        rig.plant.drive(0).unwrap().jump(600);
        rig.run(1);
        rig.plant.drive(0).unwrap().jump(600);
        rig.act(Action::vocabulary(reset()));
        rig.plant.drive(0).unwrap().jump(600);
        rig.run(1);
        assert_eq!((rig.int("x.state"), rig.int("x.wf.alarm")), (7, 11));
    }
}

/// Proves: WF-IF-02, WF-IF-03
#[test]
fn another_error_is_not_acknowledged_by_the_reset_bit() {
    let mut rig = Rig::wf();
    rig.wf_verb(&start(Mode::Mdi, &[at(100, 50.0)]));
    rig.run(100);
    rig.plant.drive(0).unwrap().inject_fault(0x8611);
    rig.run(5);
    assert_eq!((rig.wf_state(), rig.int("x.wf.ready"), rig.int("x.wf.enable")), ("IDLE", 0, 0));
    assert_eq!(rig.wf_verb(&reset()), None);
    assert_eq!(rig.int("x.error"), 0x1_8611);
    assert_eq!(rig.wf_verb(&start(Mode::Mdi, &[at(100, 50.0)])), Some(Code::IN_ERROR));
}

/// Proves: WF-IF-01, WF-IF-04
#[test]
fn start_and_jog_need_the_axis_on_and_the_request() {
    let mut rig = Rig::wf();
    rig.act(Action::Disable(AxisSet::first(1)));
    rig.run(5);
    let jog = Request { mode: Some(Mode::Jog), jog: Some(Jog::Plus), ..Request::default() };
    let mut config = config();
    config.axes[0].parameters.vocabularies.wf.fixed_speed_1 = 10.0;
    assert_eq!(rig.wf_verb(&start(Mode::Mdi, &[at(100, 50.0)])), Some(Code::NOT_ENABLED));
    let mut rig = Rig::wf_of(config);
    assert_eq!(rig.wf_verb(&Request { enable: Some(false), ..Request::default() }), None);
    assert_eq!(rig.int("x.wf.enable"), 0);
    assert_eq!(rig.wf_verb(&start(Mode::Mdi, &[at(100, 50.0)])), Some(Code::WF_NO_REQUEST));
    assert_eq!(rig.wf_verb(&jog), Some(Code::WF_NO_REQUEST));
    assert_eq!(rig.wf_verb(&Request { enable: Some(true), ..jog }), None);
    rig.run(10);
    assert!(speed(&rig) > 0.0);
}

/// 10 % of 500 mm/s with 100 mm/s^2: 500 ms up; 200 mm/s^2: 250 ms down.
///
/// Proves: WF-SET-03
#[test]
fn setup_runs_up_and_down_its_ramps() {
    let mut config = config();
    config.axes[0].parameters.vocabularies.wf.fixed_speed_1 = 10.0;
    let mut rig = Rig::wf_of(config);
    let jog = |jog| Request { mode: Some(Mode::Jog), jog: Some(jog), ..Request::default() };
    assert_eq!(rig.wf_verb(&jog(Jog::Minus)), None);
    rig.run(500);
    assert_eq!((rig.real("x.command.velocity"), rig.wf_state()), (-50_000.0, "RUN"));
    rig.wf_verb(&jog(Jog::None));
    rig.run(249);
    assert!(speed(&rig) > 0.0 && rig.wf_state() == "RUN");
    rig.run(1);
    assert_eq!((speed(&rig), rig.wf_state()), (0.0, "IDLE"));
}

#[test]
fn vocabulary_yields_to_halt() {
    let mut rig = Rig::wf();
    rig.wf_verb(&start(Mode::Continuous, &[at(500, 200.0), at(600, 50.0)]));
    rig.run(500);
    assert_eq!(rig.act(Action::Halt(AxisSet::first(1))), None);
    rig.run(1);
    assert_eq!((rig.wf_state(), rig.int("x.wf.active"), rig.int("x.wf.block")), ("IDLE", 0, 0));
    rig.run(1000);
    assert!(mm(&rig) < 50.0 && speed(&rig) == 0.0, "12.5 mm up, and as steep down");
    assert_eq!(rig.wf_verb(&Request { start: true, ..Request::default() }), None, "from its first block on");
    assert_eq!((rig.wf_state(), rig.int("x.wf.block")), ("RUN", 1));
}

/// Absolute ends in thirds of an increment do not accumulate rounding errors.
#[test]
fn distances_of_parts_of_an_increment_do_not_drift() {
    use crate::position::Position;
    let mut rig = Rig::wf();
    let third = Block { position: Position::from_f64(1000.0 / 3.0), ..by(0, 50.0) };
    rig.wf_verb(&start(Mode::Automatic, &[third]));
    for round in 1..=9_i64 {
        rig.run(200);
        assert_eq!((rig.wf_state(), rig.int("x.command.position")), ("DONE", (round * 2000 + 3) / 6), "round {round}");
        rig.wf_verb(&Request { start: true, ..Request::default() });
    }
}

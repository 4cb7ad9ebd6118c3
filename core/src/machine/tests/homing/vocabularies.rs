//! Homing with the commands of the source systems: reference 5 of the AMC, reference travel of the positioning modules.

use super::super::rig::{Rig, X};
use super::{FAR, assign, cell, place, rig_with, travel_range, zero};
use crate::code::Code;
use crate::command::{Action, HomeAxis, HomingMethod};
use crate::config::MachineConfig;
use crate::drive::Interface;
use crate::object::AxisSet;
use crate::parameter::{Change, Row, Value};
use crate::sim::{Fixtures, Model, VelocityLag};
use crate::vocabulary::wf::{Jog, Mode, Request};

pub(super) const START: i64 = -12_000;

fn amc() -> Rig {
    let mut config = cell(0);
    assign(&mut config.axes[usize::from(X)].parameters, "homing.method", Value::Int(3));
    rig_with(config, Model::Ideal, travel_range(START, (5_000, FAR)))
}

/// Proves: AMC-SEL-05, AMC-FSM-08
#[test]
fn reference_5_homes_and_then_is_0() {
    let mut rig = amc();
    let sequence = rig.set("amc.reference_select", Value::Int(5));
    assert!(rig.was_accepted(sequence));
    assert_eq!((rig.state("x"), rig.int("x.reference"), rig.int("x.amc.select")), ("HOMING", 5, 5));
    rig.run_until("x.amc.select", 0);
    assert_eq!((rig.state("x"), rig.int("x.homed"), rig.int("x.amc.active")), ("STANDSTILL", 1, 1));
    assert_eq!((zero(&rig, START), rig.int("x.error")), (4_300, 0));
    let p = rig.machine.parameters(X).copied().unwrap();
    assert_eq!(p.vocabularies.amc.reference_select, 0);
    // The next reference counts from the new zero.
    rig.set("amc.position_reference", Value::Int(150));
    rig.set("amc.reference_select", Value::Int(1));
    rig.run(3_000);
    assert_eq!((rig.int("x.command.position"), place(&rig, START)), (150, 4_450));
}

/// Proves: AMC-FSM-08
#[test]
fn an_end_before_its_time_is_0_too() {
    for action in [Action::Halt(AxisSet::one(X)), Action::QuickStop(AxisSet::one(X))] {
        let mut rig = amc();
        rig.set("amc.reference_select", Value::Int(5));
        rig.run(200);
        rig.give(action);
        rig.run(1);
        assert_eq!((rig.int("x.amc.select"), rig.int("x.homed")), (0, 0));
    }
    let mut rig = amc();
    rig.set("amc.reference_select", Value::Int(5));
    rig.run(200);
    rig.set("amc.reference_select", Value::Int(0));
    rig.run(400);
    assert_eq!((rig.state("x"), rig.int("x.homed"), rig.int("x.homing.phase")), ("STANDSTILL", 0, 0));
}

#[test]
fn reference_5_without_a_method_is_refused() {
    let mut rig = rig_with(cell(0), Model::Ideal, travel_range(START, (5_000, FAR)));
    let sequence = rig.set("amc.reference_select", Value::Int(5));
    let sentence = "x: homing.method is 0: give the axis a method, or name one in the command";
    assert_eq!(rig.refusal(sequence), sentence);
    // A virtual axis lacks the inputs that most methods search for.
    let (row, _) = Row::find("amc.reference_select").unwrap();
    let change = Change { axis: 0, row, value: Value::Int(5) };
    let select = rig.give(Action::SetParameters(Box::new([change])));
    let home = rig.give(Action::HomeAxis(HomeAxis { axis: 0, method: HomingMethod::Configured }));
    let refusals = [select, home].map(|sequence| rig.refusal(sequence));
    for refusal in refusals {
        assert!(refusal.starts_with("line: the axis is virtual, without switches and index"), "{refusal}");
        assert!(refusal.contains("35") && refusal.contains("37"), "{refusal}");
    }
}

/// Cam from 5000 to 7000, zero marks at 300 + 2000 n: after it to the right 8300, to the left 4300.
pub(super) fn wf(start: i64, change: impl FnOnce(&mut MachineConfig)) -> Rig {
    let mut config = cell(0);
    let p = &mut config.axes[usize::from(X)].parameters;
    for (key, value) in [
        ("wf.reference_rapid", Value::Real(10.0)),
        ("wf.reference_reduced", Value::Real(4.0)),
        ("wf.reference_creep", Value::Real(1.0)),
        ("wf.md16", Value::Int(50_000)),
        ("wf.md17", Value::Int(-120)),
    ] {
        assign(p, key, value);
    }
    change(&mut config);
    let is_open = config.axes[usize::from(X)].interface == Interface::OpenLoop;
    let lag = VelocityLag::new(2_000_000, 1_000_000).unwrap();
    rig_with(config, if is_open { Model::Velocity(lag) } else { Model::Ideal }, travel_range(start, (5_000, 7_000)))
}

pub(super) fn jog(rig: &mut Rig, jog: Jog) -> u64 {
    let request = Request { axis: X, mode: Some(Mode::Reference), jog: Some(jog), ..Request::default() };
    rig.give(Action::vocabulary(request))
}

/// Proves: WF-REF-01, WF-REF-03, WF-REF-05, WF-REF-06, WF-REF-07, WF-REF-08, WF-REF-09, WF-REF-11
#[test]
fn reference_travel_leads_across_the_cam_to_the_zero_mark_and_on_by_md17() {
    let mut rig = wf(START, |_| ());
    let sequence = jog(&mut rig, Jog::Plus);
    assert!(rig.was_accepted(sequence));
    assert_eq!((rig.state("x"), rig.int("x.wf.active"), rig.int("x.wf.synchronized")), ("HOMING", 1, 0));
    let mut speeds = Vec::new();
    while rig.state("x") == "HOMING" {
        rig.run(1);
        let shown = (rig.int("x.homing.phase"), rig.real("x.command.velocity"));
        if rig.real("x.command.acceleration") == 0.0 && shown.1 > 0.0 && speeds.last() != Some(&shown) {
            speeds.push(shown);
        }
    }
    // 10, 4 and 1 hundredths of 100000 inc/s.
    let expected = [(1, 1e4), (2, 1e4), (2, 4e3), (3, 4e3), (3, 1e3), (4, 1e3)];
    assert_eq!(speeds, expected, "each phase begins with the speed of the one before");
    rig.run(2);
    // The mark at 8300, shifted by MD17; there the position is MD16.
    assert_eq!((place(&rig, START), rig.int("x.actual.position")), (8_180, 50_000));
    assert_eq!((rig.int("x.wf.synchronized"), rig.int("x.homed"), rig.int("x.wf.state")), (1, 1, 0));
}

/// Coarse by the cam, fine by the zero mark: from any start, and with a switch that acts some increments early or late,
/// the zero is the same to the increment.
///
/// Proves: WF-INC-03
#[test]
fn the_zero_mark_decides_and_not_the_edge_of_the_cam() {
    for (start, end) in
        [(START, 7_000), (START + 1, 7_000), (-7_777, 6_500), (5_500, 7_900), (START, 6_310), (START, 8_280)]
    {
        let mut rig = wf(start, |_| ());
        let cam = Fixtures { home: Some((5_000, end)), ..travel_range(start, (0, 0)) };
        rig.plant.drive(0).unwrap().install_fixtures(cam);
        jog(&mut rig, Jog::Plus);
        rig.run_until("x.homed", 1);
        assert_eq!((zero(&rig, start), place(&rig, start)), (8_180 - 50_000, 8_180), "from {start}, cam to {end}");
    }
}

/// The cam is from 5000 to 7000: its plus side has the mark 8300, its minus side 4300.
///
/// Proves: WF-MD-05, WF-REF-02
#[test]
fn md7_chooses_the_side_of_the_cam() {
    for interface in [Interface::Position, Interface::OpenLoop] {
        for (direction, start) in [(Jog::Plus, START), (Jog::Minus, 12_000), (Jog::Plus, 6_000), (Jog::Minus, 6_000)] {
            let sides = if direction == Jog::Plus { [8_300, 8_300, 4_300] } else { [4_300, 8_300, 4_300] };
            for (side, mark) in (0..).zip(sides) {
                let mut rig = wf(start, |cell| {
                    let axis = &mut cell.axes[usize::from(X)];
                    axis.interface = interface;
                    assign(&mut axis.parameters, "wf.md7", Value::Int(side));
                });
                let sequence = jog(&mut rig, direction);
                assert!(rig.was_accepted(sequence));
                rig.run_until("x.homed", 1);
                let shift = if interface == Interface::OpenLoop { 0 } else { -120 };
                assert_eq!(zero(&rig, start), mark + shift - 50_000, "{interface:?}, {direction:?}, side {side}");
            }
        }
    }
}

/// Proves: WF-MD-05
#[test]
fn a_side_of_the_cam_that_there_is_not_is_refused() {
    let mut rig = wf(START, |_| ());
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(50);
    let sequence = rig.set("wf.md7", Value::Int(3));
    let sentence = "x: wf.md7 3 is no side of the cam; with an incremental encoder 0 (the one that JOG leads to), 1 (plus) and 2 \
                    (minus) are allowed";
    assert_eq!(rig.refusal(sequence), sentence);
}

#[test]
fn an_axis_that_may_not_go_back_does_not_turn_round_on_the_cam() {
    let cases = [
        (0, 0, Jog::Plus, None),
        (1, 0, Jog::Plus, None),
        // At the speed of the backward motion: 4 and 10 hundredths of 100 mm/s.
        (2, 0, Jog::Plus, Some("-4")),
        (0, 0, Jog::Minus, Some("-10")),
        // The reference point is after the mark.
        (0, -120, Jog::Plus, Some("-10")),
        (0, 120, Jog::Plus, None),
    ];
    for (side, shift, direction, refused) in cases {
        let mut rig = wf(START, |cell| {
            let p = &mut cell.axes[usize::from(X)].parameters;
            assign(p, "wf.md7", Value::Int(side));
            assign(p, "wf.md17", Value::Int(shift));
            assign(p, "revers", Value::Int(2));
        });
        let sequence = jog(&mut rig, direction);
        match refused {
            None => assert!(rig.was_accepted(sequence), "side {side}, md17 {shift}"),
            Some(speed) => {
                let sentence =
                    format!("x: velocity {speed} mm/s leads backwards, which revers forbids; 0 or more is allowed");
                assert_eq!(rig.refusal(sequence), sentence, "side {side}, md17 {shift}");
            }
        }
    }
}

fn set_cam(rig: &mut Rig, cam: bool) {
    let request = Request { axis: X, cam: Some(cam), ..Request::default() };
    let sequence = rig.give(Action::vocabulary(request));
    rig.run(1);
    assert!(rig.was_accepted(sequence));
}

/// With MD15 set to interface, the reference switch on the travel range has no effect, and the cam of the verbs has.
///
/// Proves: WF-MD-08, WF-REF-04, WF-MD-09, WF-MD-10
#[test]
fn md15_chooses_where_the_cam_comes_from() {
    let mut rig = wf(START, |cell| assign(&mut cell.axes[usize::from(X)].parameters, "wf.md15", Value::Int(0)));
    jog(&mut rig, Jog::Plus);
    let until = |rig: &mut Rig, end: i64| {
        while place(rig, START) < end {
            rig.run(1);
        }
    };
    until(&mut rig, 9_000);
    assert_eq!((rig.int("x.homing.phase"), rig.real("x.command.velocity")), (1, 1e4), "behind the switch");
    set_cam(&mut rig, true);
    rig.run(200);
    assert_eq!((rig.int("x.homing.phase"), rig.real("x.command.velocity")), (2, 4e3));
    until(&mut rig, 10_500);
    set_cam(&mut rig, false);
    rig.run_until("x.homed", 1);
    rig.run(1);
    // The mark after 10500 is 12300.
    assert_eq!((place(&rig, START), rig.int("x.actual.position"), rig.int("x.wf.synchronized")), (12_180, 50_000, 1));
}

/// MD34 defines a revolution: 250 pulses are 1000 increments, and the mark is 1300 after the cam.
///
/// Proves: WF-REF-04, WF-REF-10
#[test]
fn the_mark_has_to_come_within_the_revolution_of_md34() {
    for (pulses, alarm) in [(250, 9), (500, 0)] {
        let mut rig =
            wf(START, |cell| assign(&mut cell.axes[usize::from(X)].parameters, "wf.md34", Value::Int(pulses)));
        jog(&mut rig, Jog::Plus);
        rig.run(6_000);
        assert_eq!((rig.int("x.wf.alarm"), rig.int("x.homed")), (alarm, i64::from(alarm == 0)), "{pulses} pulses");
    }
}

/// Machine data without a number have their own names.
///
/// Proves: WF-MD-22, WF-MD-13
#[test]
fn machine_data_without_number_have_names() {
    let mut rig = wf(START, |_| ());
    for (key, value) in [
        ("wf.max_following_error", Value::Int(300)),
        ("wf.peh_window", Value::Int(5)),
        ("wf.reference_rapid", Value::Real(12.0)),
        ("wf.reference_reduced", Value::Real(5.0)),
        ("wf.reference_creep", Value::Real(2.0)),
        ("wf.fixed_speed_1", Value::Real(3.0)),
        ("profile", Value::Int(2)),
        ("max_jerk", Value::Real(1e7)),
        ("wf.md21", Value::Int(4)),
    ] {
        let sequence = rig.set(key, value);
        rig.run(1);
        assert!(rig.was_accepted(sequence), "{key}");
        assert_eq!(Row::find(key).unwrap().1.value(rig.machine.parameters(X).unwrap()), value, "{key}");
    }
    let sequence = rig.set("wf.md21", Value::Int(2));
    assert!(rig.refusal(sequence).contains("md21"), "the drive counts all edges");
    // The jerk limit and the new speeds apply: 3 hundredths of 100000 inc/s in setup, with a jerk of 10^7 inc/s^3 on
    // its ramp.
    let setup = Request { axis: X, mode: Some(Mode::Jog), jog: Some(Jog::Plus), ..Request::default() };
    rig.give(Action::vocabulary(setup));
    let (mut top, mut steepest) = (0.0_f64, 0.0_f64);
    for _ in 0..300 {
        let before = rig.real("x.command.acceleration");
        rig.run(1);
        steepest = steepest.max((rig.real("x.command.acceleration") - before).abs());
        top = top.max(rig.real("x.command.velocity"));
    }
    assert_eq!(top, 3e3);
    assert!(steepest > 5e3 && steepest <= 10_000.001, "{steepest} inc/s^2 in a cycle of 1 ms");
}

/// Proves: WF-REF-12
#[test]
fn released_axis_stops_without_a_zero() {
    for (cycles, phase) in [(500, 1), (1_800, 2)] {
        let mut rig = wf(START, |_| ());
        jog(&mut rig, Jog::Plus);
        rig.run(cycles);
        assert_eq!(rig.int("x.homing.phase"), phase, "at {}", place(&rig, START));
        jog(&mut rig, Jog::None);
        rig.run_until("x.state", 1);
        assert_eq!((rig.int("x.wf.synchronized"), rig.int("x.homed"), rig.int("x.error")), (0, 0, 0));
        rig.run(2);
        let sequence = jog(&mut rig, Jog::Plus);
        assert!(rig.was_accepted(sequence));
    }
}

/// Proves: WF-REF-10, WF-MON-03
#[test]
fn without_a_zero_mark_in_a_revolution_comes_alarm_9() {
    let mut rig = wf(START, |_| ());
    rig.plant.drive(0).unwrap().lose_index();
    jog(&mut rig, Jog::Plus);
    rig.run_until("x.wf.alarm", 9);
    assert_eq!((rig.int("x.error"), rig.state("x")), (i64::from(Code::WF_NO_ZERO_MARK.0), "ERROR_STOP"));
    // From the sample after the cam, which is up to one cycle of 4 increments after it.
    let gone = place(&rig, START) - 7_001;
    assert!((2_001..=2_005).contains(&gone), "{gone}");
    rig.run(20);
    let reset = Request { axis: X, reset: true, ..Request::default() };
    rig.give(Action::vocabulary(reset));
    rig.run(2);
    assert_eq!((rig.int("x.wf.alarm"), rig.int("x.error"), rig.int("x.wf.synchronized")), (0, 0, 0));
}

/// Proves: WF-REF-02
#[test]
fn in_open_loop_the_mark_switches_the_speed_off_and_md17_counts_for_nothing() {
    for (direction, mark) in [(Jog::Plus, 8_300), (Jog::Minus, 4_300)] {
        let start = if direction == Jog::Minus { 12_000 } else { START };
        let mut rig = wf(start, |cell| cell.axes[usize::from(X)].interface = Interface::OpenLoop);
        let sequence = jog(&mut rig, direction);
        assert!(rig.was_accepted(sequence));
        let mut runs = true;
        while rig.state("x") == "HOMING" {
            rig.run(1);
            runs = rig.real("x.output.velocity") != 0.0;
        }
        assert!(!runs);
        // The axis coasts on, but the position of the mark is known.
        rig.run(100);
        assert_eq!(zero(&rig, start), mark - 50_000, "{direction:?}");
        assert_eq!((rig.int("x.wf.synchronized"), rig.int("x.homed")), (1, 1));
        let gone = (place(&rig, start) - mark).abs();
        assert!(gone < 20, "{gone}");
    }
}

/// A stop ends reference travel in open loop like any other motion: the axis coasts to rest.
#[test]
fn in_open_loop_whatever_ends_it_leaves_an_axis_that_stands() {
    for action in [Some(Action::Halt(AxisSet::one(X))), None] {
        let mut rig = wf(START, |cell| cell.axes[usize::from(X)].interface = Interface::OpenLoop);
        jog(&mut rig, Jog::Plus);
        rig.run(500);
        assert_eq!(rig.state("x"), "HOMING");
        match action {
            Some(action) => rig.give(action),
            None => jog(&mut rig, Jog::None),
        };
        assert_eq!(rig.state("x"), "DISCRETE_MOTION", "it coasts");
        rig.run(100);
        assert_eq!((rig.state("x"), rig.int("x.homed"), rig.int("x.error")), ("STANDSTILL", 0, 0));
    }
}

/// Stop mode 1 stops at once at the actual position: homing has ended, and so has its state.
#[test]
fn reference_0_with_a_stop_on_the_actual_position_ends_homing() {
    let mut rig = amc();
    rig.set("amc.stop_mode", Value::Int(1));
    rig.set("amc.reference_select", Value::Int(5));
    rig.run(200);
    rig.set("amc.reference_select", Value::Int(0));
    rig.run(50);
    assert_eq!((rig.state("x"), rig.int("x.homed"), rig.int("x.homing.phase")), ("STANDSTILL", 0, 0));
}

/// The drive moves the axis, whose own generator is idle: the axis does not count as at rest.
#[test]
fn a_zero_is_not_set_while_the_drive_homes_for_a_vocabulary() {
    let mut config = cell(0);
    let p = &mut config.axes[usize::from(X)].parameters;
    assign(p, "homing.method", Value::Int(3));
    assign(p, "homing.in_drive", Value::Int(1));
    let mut rig = rig_with(config, Model::Ideal, travel_range(START, (5_000, FAR)));
    rig.set("amc.reference_select", Value::Int(5));
    rig.run(100);
    let zero = crate::command::SetPosition { axis: X, position: crate::position::Length::whole(1_000) };
    let refused = rig.give(Action::SetPosition(zero));
    assert_eq!(
        (rig.refusal(refused), rig.state("x")),
        ("x: the axis is homing; wait for its end, or halt it first".to_owned(), "HOMING")
    );
}

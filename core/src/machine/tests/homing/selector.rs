//! Reference 5 of the selector: its start, its end, and its effects after the end.

use super::super::rig::{LINE, Rig, X, at, to};
use super::{FAR, assign, cell, home, place, rig_with, run_to_end, travel_range, zero};
use crate::code::Code;
use crate::command::{Action, SetPosition};
use crate::config::MachineConfig;
use crate::drive::{Edge, Latch};
use crate::event::Kind;
use crate::object::{AxisSet, Leader, Object};
use crate::parameter::{Change, Row, Value};
use crate::position::Length;
use crate::sim::Model;
use crate::text::message;
use crate::vocabulary::amc::Wiring;

const START: i64 = -12_000;

fn amc_with(method: i64, change: impl FnOnce(&mut MachineConfig)) -> Rig {
    let mut config = cell(0);
    let axis = &mut config.axes[usize::from(X)];
    assign(&mut axis.parameters, "homing.method", Value::Int(method));
    axis.vocabularies.amc = Wiring { master: Some(Leader::AxisCommand(LINE)), freeze: Some(Object::Io(0)), cam: None };
    change(&mut config);
    rig_with(config, Model::Ideal, travel_range(START, (5_000, FAR)))
}

fn amc() -> Rig {
    amc_with(3, |_| ())
}

fn select(rig: &mut Rig, values: &[(&str, Value)]) -> u64 {
    let change = |&(key, value): &(&str, Value)| {
        let (row, _) = Row::find(&format!("amc.{key}")).expect("a key of the catalogue");
        Change { axis: X, row, value }
    };
    rig.give(Action::SetParameters(values.iter().map(change).collect()))
}

fn reference(rig: &mut Rig, number: i64) -> u64 {
    select(rig, &[("reference_select", Value::Int(number))])
}

/// Returns a rig in which reference 5 is in force, and the axis has searched for its switch for a while.
fn homing(mut rig: Rig) -> Rig {
    let sequence = reference(&mut rig, 5);
    assert!(rig.was_accepted(sequence));
    rig.run(200);
    assert_eq!((rig.state("x"), rig.real("x.command.velocity")), ("HOMING", 10_000.0));
    rig
}

/// Returns 34.007 as written, as in force, and the reference that commands the axis.
fn shown(rig: &Rig) -> (i64, i64, i64) {
    let written = rig.machine.parameters(X).unwrap().vocabularies.amc.reference_select;
    (written, rig.int("x.amc.select"), rig.int("x.reference"))
}

fn warnings(rig: &Rig) -> Vec<String> {
    let told = rig.events.iter().filter(|event| event.kind == Kind::Warning);
    told.map(|event| message(event, rig.machine.config())).collect()
}

const LEFT: &str = "x: another reference was selected, and that ended homing: the axis has no new zero";
const BUSY: &str = "x: the axis is homing; wait for its end, or cancel it";

/// A selection replaces homing in the same sample: written or triggered.
///
/// Proves: AMC-FSM-02, AMC-FSM-03, AMC-FSM-06, AMC-FSM-07, AMC-SEL-09, AMC-TRG-01
#[test]
fn another_reference_ends_homing_and_is_reported() {
    let speed = ("speed_reference", Value::Real(500.0));
    let place = ("position_reference", Value::Int(3));
    for key in ["reference_select", "reference_select_trigger"] {
        for (number, state) in [
            (1, "DISCRETE_MOTION"),
            (2, "CONTINUOUS_MOTION"),
            (4, "SYNCHRONIZED_MOTION"),
            (6, "DISCRETE_MOTION"),
            (7, "DISCRETE_MOTION"),
        ] {
            let mut rig = homing(amc());
            let before = rig.int("x.command.position");
            let sequence = select(&mut rig, &[(key, Value::Int(number)), speed, place]);
            assert!(rig.was_accepted(sequence), "{key} {number}");
            assert_eq!((rig.state("x"), shown(&rig)), (state, (number, number, number)), "{key}");
            assert_eq!((rig.int("x.homing.phase"), warnings(&rig)), (0, vec![LEFT.to_owned()]));
            rig.run(300);
            assert_eq!((shown(&rig), rig.int("x.homed")), ((number, number, number), 0));
            let now = rig.int("x.command.position");
            match number {
                1 => assert_eq!((now, rig.state("x")), (3, "STANDSTILL")),
                2 => assert_eq!(rig.real("x.command.velocity"), 500.0),
                4 => assert_eq!((rig.real("x.command.velocity"), rig.int("x.in_sync")), (0.0, 1)),
                // The profile was there in the sample of the selection: one cycle of travel further, and 3 with 6.
                6 => assert_eq!(now, before + 10 + 3),
                _ => assert_eq!(now, before + 10),
            }
        }
    }
}

/// Reference 0 ends it like the others: written, triggered, or selected by a following error. The axis stops.
///
/// Proves: AMC-FSM-01, AMC-STP-06
#[test]
fn reference_0_ends_homing_and_is_reported() {
    for (key, number) in [("reference_select", 0), ("reference_select_trigger", 0), ("following_error_window", 1)] {
        for stop_mode in 0..4 {
            let trigger = i64::from(key == "reference_select_trigger") * 5;
            let mut rig =
                amc_with(3, |cell| cell.axes[usize::from(X)].parameters.vocabularies.amc.stop_mode = stop_mode);
            select(&mut rig, &[("reference_select_trigger", Value::Int(trigger)), ("reference_select", Value::Int(5))]);
            rig.run(200);
            assert_eq!((rig.state("x"), warnings(&rig).len()), ("HOMING", 0));
            select(&mut rig, &[(key, Value::Int(number))]);
            let jumps = key == "following_error_window";
            if jumps {
                rig.modify_inputs = |inputs| inputs.drive.iter_mut().for_each(|drive| drive.count -= 5);
            }
            rig.run(3);
            if jumps && stop_mode < 2 {
                assert_eq!((rig.state("x"), warnings(&rig).len()), ("HOMING", 0), "stop mode {stop_mode}");
                continue;
            }
            assert_eq!(warnings(&rig), [LEFT], "{key}, stop mode {stop_mode}");
            rig.run(100);
            assert_eq!((shown(&rig), rig.int("x.homed"), rig.real("x.command.velocity")), ((0, 0, 0), 0, 0.0));
        }
    }
}

/// No other motion may start while a goal homes the axis: it is refused immediately, and nothing is changed.
#[test]
fn a_selection_waits_for_the_homing_of_a_goal() {
    let mut rig = amc();
    let goal = home(&mut rig, 3);
    rig.run(200);
    let parameters = *rig.machine.parameters(X).unwrap();
    for number in [1, 2, 4, 5, 6, 7] {
        for key in ["reference_select", "reference_select_trigger"] {
            let sequence = select(&mut rig, &[(key, Value::Int(number)), ("position_reference", Value::Int(3))]);
            assert_eq!(rig.refusal(sequence), BUSY, "{key} {number}");
            assert_eq!((rig.state("x"), rig.machine.parameters(X)), ("HOMING", Some(&parameters)));
        }
    }
    assert_eq!(run_to_end(&mut rig, goal).code, Code::NONE);
    assert_eq!((zero(&rig, START), rig.int("x.homed"), warnings(&rig).len()), (4_300, 1, 0));
}

/// A freeze event cannot be refused in advance: it is reported, with a message that does not refer to a setpoint.
#[test]
fn an_event_waits_for_the_homing_of_a_goal_and_ends_that_of_the_selector() {
    let latch = Latch { object: Object::Io(0), edge: Edge::Rising, age_ns: Some(0), position: None };
    let mut rig = amc();
    select(&mut rig, &[("action_on_event", Value::Int(2))]);
    let goal = home(&mut rig, 3);
    rig.run(200);
    rig.plant.add_latch(latch);
    rig.run(1);
    assert_eq!((rig.state("x"), warnings(&rig), shown(&rig)), ("HOMING", vec![BUSY.to_owned()], (0, 0, 5)));
    assert_eq!(run_to_end(&mut rig, goal).code, Code::NONE);
    let mut rig = homing(amc());
    select(&mut rig, &[("action_on_event", Value::Int(2))]);
    rig.plant.add_latch(latch);
    rig.run(1);
    assert_eq!((rig.state("x"), warnings(&rig)), ("SYNCHRONIZED_MOTION", vec![LEFT.to_owned()]));
    assert_eq!(shown(&rig), (4, 4, 4));
}

#[test]
fn where_homing_is_required_no_reference_ends_the_first_one() {
    let mut rig = homing(amc_with(3, |cell| cell.axes[usize::from(X)].parameters.homing.required = true));
    let sequence = reference(&mut rig, 1);
    assert!(rig.events.iter().any(|event| event.command == sequence && event.code == Code::HOMING_REQUIRED));
    assert_eq!((rig.state("x"), shown(&rig)), ("HOMING", (5, 5, 5)));
    rig.run_until("x.homed", 1);
    let sequence = reference(&mut rig, 1);
    assert!(rig.was_accepted(sequence));
    // Its zero is known, so homing may be aborted now.
    let again = reference(&mut rig, 5);
    assert!(rig.was_accepted(again));
    rig.run(300);
    assert_eq!(rig.state("x"), "HOMING");
    reference(&mut rig, 1);
    assert_eq!((shown(&rig), rig.int("x.homed")), ((1, 1, 1), 1));
}

/// On the limit switch that was searched, the axis is not moved further: the switch applies to any other motion.
#[test]
fn a_reference_that_limits_forbid_leaves_homing_as_it_is() {
    let mut rig = amc_with(17, |_| ());
    reference(&mut rig, 5);
    rig.run_until("x.limit.negative", 1);
    let sequence =
        select(&mut rig, &[("reference_select", Value::Int(1)), ("position_reference", Value::Int(-30_000))]);
    assert!(rig.was_accepted(sequence), "the way is judged in the cycle");
    assert_eq!((rig.state("x"), shown(&rig), rig.int("x.error")), ("HOMING", (5, 5, 5), 0));
    assert!(warnings(&rig).iter().all(|told| !told.contains("setpoints") && told != LEFT), "{:?}", warnings(&rig));
    rig.run_until("x.homed", 1);
    assert_eq!((zero(&rig, START), rig.int("x.error")), (-20_000, 0));
}

/// 20 inc per cycle, 1 inc/cycle^2: 20 cycles to rest, then homing.
///
/// Proves: AMC-FSM-08, AMC-SEL-05
#[test]
fn from_any_motion_reference_5_stops_the_axis_and_homes_it() {
    let speed = ("speed_reference", Value::Real(20_000.0));
    let by_selector = |rig: &mut Rig| select(rig, &[("reference_select", Value::Int(2)), speed]);
    let by_goal = |rig: &mut Rig| rig.give(Action::Move(at(X, 20_000.0)));
    for (begin, is_goal) in [(&by_selector as &dyn Fn(&mut Rig) -> u64, false), (&by_goal, true)] {
        let mut rig = amc();
        let before = begin(&mut rig);
        rig.run(60);
        assert_eq!(rig.real("x.command.velocity"), 20_000.0);
        let sequence = reference(&mut rig, 5);
        assert!(rig.was_accepted(sequence));
        assert_eq!((rig.state("x"), shown(&rig)), ("DISCRETE_MOTION", (5, 5, 5)));
        let ended: Vec<Code> = rig.done(before).iter().map(|done| done.code).collect();
        assert_eq!(ended, if is_goal { vec![Code::REPLACED] } else { vec![] });
        let braked = (0..).find(|_| {
            rig.run(1);
            rig.state("x") == "HOMING"
        });
        assert!(braked.is_some_and(|cycles| (19..=23).contains(&cycles)), "{braked:?}");
        assert_eq!(shown(&rig), (5, 5, 5));
        rig.run_until("x.homed", 1);
        assert_eq!((zero(&rig, START), shown(&rig), warnings(&rig).len()), (4_300, (0, 0, 0), 0));
    }
}

/// While the axis brakes for homing, every takeover of the axis and every other reference prevents homing.
///
/// Proves: AMC-FSM-08, AMC-FSM-01
#[test]
fn homing_that_waits_for_rest_may_be_given_up() {
    let braking = || {
        let mut rig = amc();
        rig.give(Action::Move(at(X, 20_000.0)));
        rig.run(60);
        reference(&mut rig, 5);
        rig.run(5);
        assert_eq!((rig.state("x"), shown(&rig)), ("DISCRETE_MOTION", (5, 5, 5)));
        rig
    };
    for action in [
        Action::Halt(AxisSet::one(X)),
        Action::Disable(AxisSet::one(X)),
        Action::QuickStop(AxisSet::one(X)),
        Action::Move(to(X, 100)),
    ] {
        let mut rig = braking();
        rig.give(action.clone());
        rig.run(300);
        assert!(rig.state("x") != "HOMING" && rig.int("x.homed") == 0, "{action:?}");
        let (written, in_force, _) = shown(&rig);
        assert_eq!((written, in_force), (0, 0), "{action:?}");
    }
    for (number, state) in [(0, "STANDSTILL"), (1, "STANDSTILL"), (2, "CONTINUOUS_MOTION")] {
        let mut rig = braking();
        let speed = ("speed_reference", Value::Real(500.0));
        select(&mut rig, &[("reference_select", Value::Int(number)), speed]);
        rig.run(300);
        assert_eq!((rig.state("x"), shown(&rig), rig.int("x.homed")), (state, (number, number, number), 0));
        assert_eq!(warnings(&rig).len(), 0, "no homing has ended");
    }
}

/// Zero, coordinate, reference and selection change together.
///
/// Proves: AMC-SEL-08, AMC-FSM-08
#[test]
fn homing_end_changes_zero_and_selection_in_one_cycle() {
    // Method 35 is done at once; its zero is the present position of the axis.
    for (method, stop_mode) in [(3, 0), (3, 1), (35, 0), (35, 1)] {
        let mut rig =
            amc_with(method, |cell| cell.axes[usize::from(X)].parameters.vocabularies.amc.stop_mode = stop_mode);
        select(&mut rig, &[("reference_select", Value::Int(6)), ("position_reference", Value::Int(700))]);
        rig.run(300);
        let version = rig.machine.parameter_version();
        reference(&mut rig, 5);
        while rig.int("x.homed") == 0 {
            assert_eq!(shown(&rig), (5, 5, 5));
            rig.run(1);
        }
        let told = |rig: &Rig| {
            let places = ["command.position", "actual.position", "amc.stop_reference", "amc.profile_input_position"];
            (rig.state("x"), shown(rig), places.map(|name| rig.int(&format!("x.{name}"))))
        };
        let now = place(&rig, START) - if method == 3 { 4_300 } else { START + 700 };
        assert_eq!(told(&rig), ("STANDSTILL", (0, 0, 0), [now; 4]), "method {method}, stop mode {stop_mode}");
        assert!(rig.machine.parameter_version() > version);
        rig.run(1);
        assert_eq!(told(&rig), ("STANDSTILL", (0, 0, 0), [now; 4]));
        assert_eq!(rig.int("x.amc.active"), 1);
    }
}

/// An axis does not home by itself after its homing was ended by disable (M14); other references do resume (M08).
///
/// Proves: AMC-SEL-08
#[test]
fn after_disable_homing_does_not_begin_by_itself() {
    let mut rig = homing(amc());
    rig.give(Action::Disable(AxisSet::one(X)));
    assert_eq!(shown(&rig).0, 0);
    rig.run(100);
    assert_eq!((rig.state("x"), shown(&rig).0), ("DISABLED", 0));
    rig.enable();
    rig.run(100);
    assert_eq!((rig.state("x"), shown(&rig), rig.real("x.command.velocity")), ("STANDSTILL", (0, 0, 0), 0.0));
    // A selection while the axis is off is intended.
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(50);
    reference(&mut rig, 5);
    rig.enable();
    assert_eq!((rig.state("x"), shown(&rig)), ("HOMING", (5, 5, 5)));
}

/// The state of the selector refers to the previous coordinate.
#[test]
fn after_set_position_no_reference_is_shown_any_more() {
    for number in [1, 6, 7] {
        let mut rig = amc();
        select(&mut rig, &[("reference_select", Value::Int(1)), ("position_reference", Value::Int(150))]);
        rig.run(200);
        reference(&mut rig, number);
        rig.run(200);
        let stands = rig.int("x.command.position");
        assert_eq!((shown(&rig), rig.int("x.amc.stop_reference")), ((number, number, number), stands));
        rig.give(Action::SetPosition(SetPosition { axis: X, position: Length::whole(5_000) }));
        assert_eq!((shown(&rig), rig.int("x.amc.active")), ((0, 0, 0), 0));
        let places = ["command.position", "amc.stop_reference", "amc.profile_input_position"];
        assert_eq!(places.map(|name| rig.int(&format!("x.{name}"))), [5_000; 3]);
    }
}

//! A start is checked when it is requested, even if the drive has to switch on first: a refused start neither moves nor
//! switches anything.

use super::rig::{FAST, Rig, X, config};
use crate::code::Code;
use crate::command::{Action, HomeAxis, HomingMethod};
use crate::config::{IoConfig, IoKind, MachineConfig};
use crate::drive::Interface;
use crate::event::Kind;
use crate::object::AxisSet;
use crate::parameter::{AxisParameters, Value};
use crate::sim::Fixtures;
use crate::state::AXIS_STATES;

/// From the present state, and with the motor switched off first.
const STARTS: [&str; 4] = ["fldda fstart", "fldda fldva fstart", "fldda fldva fldaa fstart", "axinit fldda fstart"];

const UP: &[(&str, f64)] = &[("destp", 10.0), ("accel", 500_000.0)];
const DOWN: &[(&str, f64)] = &[("destp", -10.0), ("accel", 500_000.0)];

/// x with 100 mm/s, 1 m/s^2 and these changes, and an input.
fn cell(change: impl Fn(&mut AxisParameters)) -> MachineConfig {
    let mut config = config();
    config.io.push(IoConfig { name: "break".into(), kind: IoKind::DigitalInput, latch: false });
    config.global.parameters.i_break = 1;
    let p = &mut config.axes[usize::from(X)].parameters;
    (p.max_velocity, p.max_acceleration) = (100_000.0, 1e6);
    change(p);
    config
}

/// Initialised, and off.
fn rig_of(config: MachineConfig) -> Rig {
    let mut rig = Rig::of(config);
    rig.run(5);
    rig.does(FAST, "axinit");
    rig
}

/// At 50 000 counts/s.
fn moving() -> Rig {
    let mut rig = rig_of(cell(|_| ()));
    rig.does(&[("destp", 100_000.0)], "fldda fstart");
    rig.run_to("x.command.velocity", 49_999.9);
    rig
}

fn state(rig: &Rig) -> &'static str {
    AXIS_STATES[rig.int("x.state") as usize]
}

fn warnings(rig: &Rig) -> Vec<String> {
    let warnings = rig.events.iter().filter(|event| event.kind == Kind::Warning);
    warnings.map(|event| crate::text::message(event, rig.machine.config())).collect()
}

/// Each request is refused with that message, and the machine continues as without it.
#[track_caller]
fn refuses_all(rig: &mut Rig, set: &[(&str, f64)], verbs: &[&str], part: &str) {
    for verb in verbs {
        rig.refuses(set, verb, part);
        let request = rig.request(X, set, verb);
        rig.give_or_nothing(request);
    }
    assert!(warnings(rig).is_empty());
}

/// 50 000 counts/s at 1e6 counts/s^2 take 50 cycles to stop: the requests come within them, and none makes the axis
/// coast.
///
/// Proves: SAIA-ERR-01
#[test]
fn no_start_leads_out_of_a_stop_that_locks() {
    type Stop = fn(&mut Rig);
    let stops: [(Stop, &str); 3] = [
        (|rig| rig.ask([Action::QuickStop(AxisSet::one(X))]).unwrap(), "quick_stop has locked the axis"),
        (|rig| rig.ask([Action::Abort]).unwrap(), "abort has stopped the axis"),
        (|rig| rig.plant.set_digital(0, true), "i_break has stopped the axis"),
    ];
    for (stop, part) in stops {
        let mut rig = moving();
        stop(&mut rig);
        rig.run(3);
        let verbs = [&STARTS[..], &["fmotoff fforw", "fldva fldaa fforw"]].concat();
        refuses_all(&mut rig, UP, &verbs, part);
        let velocity = rig.real("x.command.velocity");
        assert!((20_000.0..40_000.0).contains(&velocity), "{part}: it stops on, at {velocity}");
        rig.run(60);
        assert_eq!((rig.int("x.enabled"), rig.real("x.command.velocity")), (1, 0.0));
        rig.ask([Action::ResetErrors(AxisSet::one(X))]).unwrap();
        assert_eq!(state(&rig), "STANDSTILL");
        rig.does(UP, "fldda fstart");
    }
}

/// Proves: SAIA-ERR-01, SAIA-DET-04
#[test]
fn no_start_ends_homing() {
    let mut rig = rig_of(cell(|x| (x.homing.method, x.homing.velocity) = (17, Some(5_000.0))));
    rig.on();
    rig.ask([Action::HomeAxis(HomeAxis { axis: X, method: HomingMethod::Configured })]).unwrap();
    rig.run(20);
    let verbs = [&STARTS[..], &["fmotoff fforw", "fldva fldaa fforw"]].concat();
    refuses_all(&mut rig, UP, &verbs, "x: the axis is homing");
    assert_eq!(state(&rig), "HOMING");
    // A new acceleration alone switches the motor off.
    rig.does(UP, "fldaa");
    assert_eq!((rig.saia_state(), state(&rig)), ("OFF", "DISABLED"));
}

/// On or off, to a destination, by a jog or at a velocity.
///
/// Proves: SAIA-ERR-01
#[test]
fn start_that_axis_cannot_execute_is_refused_before_enabling() {
    let verbs = [&STARTS[..], &["fmotoff fsstepb", "fldaa fbackw"]].concat();
    for is_on in [false, true] {
        let make = |config, switches: Fixtures| {
            let mut rig = rig_of(config);
            rig.plant.drive(0).unwrap().install_fixtures(switches);
            rig.run(2);
            if is_on {
                rig.on();
            }
            rig
        };
        let required = cell(|x| (x.homing.method, x.homing.required) = (35, true));
        let mut rig = make(required, Fixtures::default());
        refuses_all(&mut rig, UP, &verbs, "x: homing is required and has not been done");
        rig.run(20);
        assert_eq!(rig.int("x.enabled"), i64::from(is_on));

        let upper = Fixtures { positive: Some(0), ..Fixtures::default() };
        let mut rig = make(cell(|x| x.supervision.endswmod = 1), upper);
        let upwards = ["fldda fstart", "fldda fldaa fstart", "fmotoff fsstepf", "fldva fldaa fforw"];
        refuses_all(&mut rig, UP, &upwards, "x: the positive limit switch is actuated; only the way back is open");
        let by_velocity = [("mcw", 0x1C1B as f64), ("accel", 500_000.0)];
        refuses_all(&mut rig, &by_velocity, &["fselom fldaa fstart"], "x: the positive limit switch is actuated");
        rig.does(DOWN, "fldda fldaa fstart");
        rig.run_until("x.saia.profile_done", 1);
        assert_eq!(rig.int("x.command.position"), -10);

        let mut rig = make(cell(|x| x.macs.revers = 2), Fixtures::default());
        refuses_all(&mut rig, DOWN, &verbs, "leads backwards, which revers forbids");
        rig.does(UP, "fldda fldaa fstart");
        rig.run_until("x.saia.profile_done", 1);
        assert_eq!(rig.int("x.command.position"), 10);
    }
}

#[test]
fn an_open_loop_refuses_a_start_before_it_is_on() {
    let mut config = cell(|_| ());
    config.axes[usize::from(X)].interface = Interface::OpenLoop;
    let mut rig = rig_of(config);
    let verbs = ["fldda fstart", "fldda fldaa fstart", "fforw"];
    refuses_all(&mut rig, UP, &verbs, "x: the axis runs in open loop; only commands of `wf` move it");
    assert_eq!((rig.saia_state(), rig.int("x.enabled")), ("OFF", 0));
}

/// The other commands run: the load switches the motor off by SAIA-DET-04, and only the start after it fails.
///
/// Proves: SAIA-ERR-03, SAIA-ERR-04
#[test]
fn as_a_command_error_only_the_start_fails() {
    for policy in [1, 2] {
        let mut rig = moving();
        rig.parameter("saia.command_error", Value::Int(policy));
        rig.ask([Action::QuickStop(AxisSet::one(X))]).unwrap();
        rig.run(3);
        rig.verb(X, UP, "fldda fldaa fstart").unwrap();
        assert_eq!((rig.int("x.saia.command_errors"), rig.int("x.saia.tries")), (1, 3));
        assert_eq!((rig.saia_state(), rig.int("x.saia.destination"), rig.int("x.enabled")), ("OFF", 100_000, 0));
        assert_eq!(warnings(&rig), ["x: quick_stop has locked the axis; reset_errors first"]);
        rig.run(20);
        assert_eq!((rig.saia_state(), rig.int("x.enabled")), ("OFF", 0));
    }
}

/// A change after the request is detected once the drive is on, and reported with its reason.
#[test]
fn change_between_request_and_start_is_reported() {
    let mut rig = rig_of(cell(|_| ()));
    rig.does(DOWN, "fldda fldaa fstart");
    rig.parameter("revers", Value::Int(2));
    rig.run(20);
    assert_eq!((rig.saia_state(), rig.int("x.saia.ondest"), rig.int("x.enabled")), ("HOLD", 1, 1));
    assert_eq!(rig.int("x.saia.error"), i64::from(Code::REVERSE_FORBIDDEN.0));
    rig.does(UP, "fldda fldaa fstart");
    rig.run(2);
    rig.plant.drive(0).unwrap().install_fixtures(Fixtures { positive: Some(0), ..Fixtures::default() });
    rig.run(20);
    let said = warnings(&rig);
    assert_eq!(said[0], "x: the way to -0.01 mm leads backwards, which revers forbids");
    assert_eq!(said[1..], ["x: motion towards an actuated limit switch"]);
}

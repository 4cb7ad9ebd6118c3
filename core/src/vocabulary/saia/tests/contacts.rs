//! An open contact of the cell: nothing is switched on, and nothing starts.

use super::rig::{FAST, Rig, config};
use crate::axis::Safety;
use crate::code::Code;
use crate::config::{IoConfig, IoKind};
use crate::parameter::Value;

const STARTS: [&str; 5] = ["fstart", "fsstepf", "fsstepb", "fforw", "fbackw"];

/// Estop and interlock; both open.
fn guarded() -> Rig {
    let mut config = config();
    for name in ["estop", "door"] {
        config.io.push(IoConfig { name: name.into(), kind: IoKind::DigitalInput, latch: false });
    }
    config.safety = Safety { estop: Some(0), interlock: Some(1) };
    let mut rig = Rig::of(config);
    rig.run(5);
    rig
}

fn close(rig: &mut Rig) {
    rig.plant.set_digital(0, true);
    rig.plant.set_digital(1, true);
    rig.run(1);
}

/// Proves: SAIA-ERR-01
#[test]
fn every_start_is_refused_at_once() {
    for name in STARTS {
        let mut rig = guarded();
        rig.refuses(FAST, &format!("axinit {name}"), "x: the emergency stop is open");
        rig.does(FAST, "axinit");
        rig.plant.set_digital(0, true);
        rig.run(1);
        let before = rig.picture();
        rig.refuses(&[("destp", 10.0)], &format!("fldda {name}"), "x: the interlock is open");
        // Also if the drive would be off for a cycle before the start.
        rig.refuses(&[("destp", 10.0)], &format!("fldaa fldda {name}"), "x: the interlock is open");
        assert_eq!(rig.picture(), before);
        rig.run(20);
        assert_eq!((rig.saia_state(), rig.int("x.enabled"), rig.int("x.error")), ("OFF", 0, 0), "{name}");
        close(&mut rig);
        rig.run(20);
        assert_eq!(rig.int("x.enabled"), 0, "closing it starts nothing");
        rig.does(&[("destp", 10.0)], &format!("fldda {name}"));
        rig.run_until("x.enabled", 1);
    }
}

/// Proves: SAIA-ERR-03, SAIA-ERR-04
#[test]
fn as_a_command_error_it_is_told_once_and_the_drive_stays_off() {
    let mut rig = guarded();
    rig.parameter("saia.command_error", Value::Int(1));
    rig.does(FAST, "axinit");
    rig.verb(super::rig::X, &[("destp", 10.0)], "fldda fstart").unwrap();
    assert_eq!((rig.int("x.saia.tries"), rig.int("x.saia.command_errors")), (3, 1));
    assert_eq!(rig.int("x.saia.error"), i64::from(Code::EMERGENCY_STOP.0));
    rig.run(20);
    assert_eq!((rig.saia_state(), rig.int("x.enabled"), rig.int("x.error")), ("OFF", 0, 0));
    rig.parameter("saia.command_error", Value::Int(2));
    rig.verb(super::rig::X, &[], "fstart").unwrap();
    rig.run(20);
    assert_eq!((rig.saia_state(), rig.int("x.enabled")), ("OFF", 0));
    assert_eq!(rig.int("x.error"), i64::from(Code::EMERGENCY_STOP.0));
}

/// The contact opens in the cycle in which the drive is off before a start.
#[test]
fn a_start_that_waits_is_not_switched_on_either() {
    let mut rig = guarded();
    close(&mut rig);
    rig.does(FAST, "axinit");
    rig.does(&[("destp", 10.0)], "fldaa fldda fstart");
    assert_eq!((rig.saia_state(), rig.int("x.enabled")), ("POS", 0));
    rig.plant.set_digital(0, false);
    rig.run(20);
    assert_eq!((rig.saia_state(), rig.int("x.enabled"), rig.int("x.error")), ("OFF", 0, 0));
    assert_eq!((rig.int("x.saia.command_errors"), rig.int("x.saia.ondest")), (1, 1));
    assert_eq!(rig.int("x.saia.error"), i64::from(Code::EMERGENCY_STOP.0));
}

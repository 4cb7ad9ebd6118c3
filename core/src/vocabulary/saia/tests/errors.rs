//! Command errors: three tries, and the three reactions to them.

use super::rig::{FAST, Rig, X};
use crate::code::Code;
use crate::event::Kind;
use crate::parameter::Value;
use crate::parameter::saia::COMMAND_ERRORS;
use crate::vocabulary::saia::Register;

/// Proves: SAIA-ERR-01, SAIA-ERR-02, SAIA-ERR-04
#[test]
fn by_default_a_command_error_refuses_the_verb_and_nothing_of_it_changes() {
    let mut rig = Rig::moving();
    assert_eq!(COMMAND_ERRORS[0], "refuse");
    for (set, commands, part) in [
        (&[("veloc", -100.0), ("destp", 7.0)][..], "fldda fldva fstart", "saia.veloc with saia.mcfac makes -2237"),
        (&[("kprop", 40_000.0), ("destp", 7.0)], "fldrp fldda fupdrp fstart", "saia.kprop is 40000; 0 to 32767"),
        (&[("mcw", 0x31B as f64)], "fmotoff fstop", "saia.mcw has 011 in bits 10 to 8; fstop needs exactly one"),
        (&[("mcw", 0x41C as f64)], "fsetzp fsetpe", "saia.mcw has 1CH in bits 0 to 7; 1BH (flag) or 1AH"),
    ] {
        let before = rig.picture();
        rig.refuses(set, commands, part);
        assert_eq!(rig.picture(), before, "{commands}");
        assert!((rig.real("x.command.velocity") - 50_000.0).abs() < 0.03);
    }
}

/// Proves: SAIA-MCW-08, SAIA-MCW-02, SAIA-MCW-03, SAIA-MCW-04
#[test]
fn fstop_takes_exactly_one_of_three_bits() {
    for bits in 0..8 {
        let mut rig = Rig::moving();
        let result = rig.verb(X, &[("mcw", f64::from(0x1B | bits << 8))], "fstop");
        let state = match bits {
            1 => "OFF",
            2 => "HOLD",
            4 => "RAMP",
            _ => "POS",
        };
        assert_eq!((result.is_ok(), rig.saia_state()), (state != "POS", state), "{bits:03b}");
    }
}

/// Proves: SAIA-MCW-07, SAIA-MCW-01
#[test]
fn fsetpe_takes_two_bytes_and_no_command_minds_bits_13_to_31() {
    for byte in 0..=255 {
        let mut rig = Rig::ready(FAST);
        let result = rig.verb(X, &[("mcw", f64::from(0x400 | byte))], "fsetpe");
        assert_eq!(result.is_ok(), byte == 0x1A || byte == 0x1B, "{byte:02X}H");
    }
    let mut rig = Rig::ready(FAST);
    rig.does(&[("mcw", f64::from(-0x2000 | 0x41B))], "fselom fsetpe fstop");
    assert_eq!(rig.signals() >> 11 & 3, 0);
}

/// Proves: SAIA-ORA-15, SAIA-ERR-03, SAIA-ERR-05
#[test]
fn failed_command_is_tried_three_times_reported_once_and_skipped() {
    let mut rig = Rig::logging(FAST);
    rig.verb(X, &[("destp", 1000.0)], "fldda fstart").unwrap();
    rig.run_until("x.saia.ondest", 1);
    rig.verb(X, &[("veloc", -100.0), ("destp", 3000.0)], "fldda fldva fstart").unwrap();
    assert_eq!((rig.int("x.saia.tries"), rig.int("x.saia.command_errors")), (3, 1));
    assert_eq!(rig.int("x.saia.error"), i64::from(Code::SAIA_VELOCITY_OUT_OF_RANGE.0));
    let warnings: Vec<_> = rig.machine.events().iter().filter(|event| event.kind == Kind::Warning).collect();
    assert_eq!(warnings.len(), 1);
    let sentence = crate::text::message(warnings[0], rig.machine.config());
    assert!(sentence.contains("makes -2237 in the velocity register"), "{sentence}");
    // The commands before and after the failed one are executed; register and buffer keep their values; the flag is
    // cleared.
    assert_eq!((rig.saia_state(), rig.int("x.saia.destination")), ("POS", 3000));
    assert_eq!(rig.int("x.saia.velocity_register"), 1_118_481);
    assert_eq!(rig.register(Register::Veloc), Value::Int(-100));
    rig.run_until("x.saia.ondest", 1);
    assert_eq!((rig.int("x.saia.tries"), rig.warnings()), (3, 1));
}

/// Proves: SAIA-ORA-20, SAIA-CMD-09, SAIA-CMD-10, SAIA-EXT-09
#[test]
fn a_regulator_load_out_of_range_leaves_the_old_parameters_in_force() {
    let mut rig = Rig::logging(&[("veloc", 50_000.0), ("accel", 1e6), ("kprop", 3.0)]);
    rig.verb(X, &[("destp", 1000.0)], "fldda fstart").unwrap();
    rig.run_until("x.saia.ondest", 1);
    rig.verb(X, &[("kprop", 40_000.0)], "fldrp").unwrap();
    rig.verb(X, &[], "fupdrp").unwrap();
    assert_eq!((rig.int("x.saia.tries"), rig.int("x.saia.command_errors")), (3, 1));
    let output = |rig: &mut Rig| {
        // An error of 320 counts for one cycle.
        rig.plant.drive(0).unwrap().jump(-320);
        rig.run(1);
        rig.int("x.saia.output")
    };
    assert_eq!(output(&mut rig), (3 * 320) >> 4);
    // A valid load waits in its buffer for fupdrp.
    rig.run(2);
    rig.verb(X, &[("kprop", 5.0)], "fldrp").unwrap();
    assert_eq!(output(&mut rig), (3 * 320) >> 4);
    rig.run(2);
    rig.verb(X, &[], "fupdrp").unwrap();
    assert_eq!(output(&mut rig), (5 * 320) >> 4);
}

/// Proves: SAIA-ERR-04
#[test]
fn with_motor_off_an_error_also_stops_the_axis() {
    let mut rig = Rig::moving();
    rig.parameter("saia.command_error", Value::Int(2));
    rig.verb(X, &[("veloc", -100.0), ("destp", 55.0)], "fldva fldda fstart").unwrap();
    assert_eq!((rig.saia_state(), rig.int("x.enabled"), rig.int("x.saia.ondest")), ("OFF", 0, 1));
    assert_eq!(crate::state::AXIS_STATES[rig.int("x.state") as usize], "ERROR_STOP");
    assert_eq!(rig.int("x.error"), i64::from(Code::SAIA_VELOCITY_OUT_OF_RANGE.0));
    assert_eq!(rig.int("x.saia.destination"), 55, "the next command was done");
    rig.run(5);
    assert_eq!((rig.saia_state(), rig.real("x.command.velocity")), ("OFF", 0.0));
}

/// A start that the axis refuses fails as a command; the other commands are executed.
#[test]
fn refusal_by_axis_is_command_error() {
    let mut rig = Rig::logging(FAST);
    rig.verb(X, &[("destp", 15_000.0)], "fldda fstart").unwrap();
    rig.run_to("x.command.velocity", 49_999.9);
    // The stop would end 1250 counts ahead at best, beyond this limit: the axis cannot reverse before it.
    let limit = rig.int("x.command.position") + 2000;
    rig.run_until("x.saia.ondest", 1);
    rig.verb(X, &[("destp", 0.0)], "fldda fstart").unwrap();
    rig.run_until("x.saia.ondest", 1);
    rig.verb(X, &[("destp", limit as f64)], "fldda fstart").unwrap();
    rig.run_until("x.saia.ondest", 1);
    rig.parameter("max_position", Value::Int(limit));
    let velocity = rig.int("x.saia.velocity_register");
    rig.verb(X, &[], "fforw fldbpa").unwrap();
    assert_eq!((rig.int("x.saia.command_errors"), rig.int("x.saia.tries")), (1, 3));
    assert_eq!(rig.int("x.saia.error"), i64::from(Code::LIMIT_VIOLATION.0));
    assert_eq!(
        (rig.saia_state(), rig.int("x.saia.ondest"), rig.int("x.saia.velocity_register")),
        ("HOLD", 1, velocity)
    );
    assert_eq!(rig.int("x.saia.destination"), limit);
    let before = rig.picture();
    rig.parameter("saia.command_error", Value::Int(0));
    rig.refuses(&[], "fforw", "leads further into the limit");
    assert_eq!(rig.picture().0, before.0);
}

/// SAIA-EXT-03 as a message.
///
/// Proves: SAIA-EXT-03
#[test]
fn an_acceleration_above_the_velocity_cannot_be_started() {
    let mut rig = Rig::ready(&[("veloc", 100.0), ("accel", 1e6)]);
    let sentence = "the acceleration register is 7635; 1 to the velocity register, 2237, is allowed";
    rig.refuses(&[("destp", 10.0)], "fldda fstart", sentence);
    assert_eq!(rig.saia_state(), "OFF");
    let still = "the velocity register is 0; fldva has to load one first";
    let level = "the acceleration register is 0; 1 to the velocity register, 22370, is allowed";
    for (veloc, accel, sentence) in [(0.0, 0.0, still), (0.0, 1000.0, still), (1000.0, 0.0, level)] {
        let mut rig = Rig::ready(&[("veloc", veloc), ("accel", accel)]);
        rig.refuses(&[("destp", 10.0)], "fldda fstart", sentence);
    }
}

/// Without accel the default is 10 m/s^2 of the axis: half of it is 5e6 counts/s^2, 38 177 in the register; 1000
/// counts/s are 22 370.
///
/// Proves: SAIA-EXT-03, SAIA-PRF-03
#[test]
fn an_acceleration_that_nobody_gave_is_cut_to_the_velocity() {
    let registers = |rig: &Rig| (rig.int("x.saia.velocity_register"), rig.int("x.saia.acceleration_register"));
    let mut config = super::rig::config();
    config.axes[usize::from(X)].parameters.max_acceleration = 1e7;
    let mut rig = Rig::of(config);
    rig.run(5);
    rig.does(&[("veloc", 1000.0)], "axinit");
    rig.does(&[("destp", 2000.0)], "fldda fstart");
    assert_eq!(registers(&rig), (22_370, 22_370));
    rig.run_to("x.command.velocity", 999.9);
    // A motion keeps its acceleration; the next one takes the allowed one.
    rig.does(&[("veloc", 5000.0)], "fldva fstart");
    assert_eq!(registers(&rig), (111_848, 22_370));
    rig.run_until("x.saia.ondest", 1);
    rig.does(&[("destp", 0.0)], "fldda fstart");
    assert_eq!(registers(&rig), (111_848, 38_177));
    rig.run_until("x.saia.ondest", 1);
    // The same value in a register is refused, and so is 0.
    let sentence = "the acceleration register is 38177; 1 to the velocity register, 22370, is allowed";
    rig.refuses(&[("accel", 5e6), ("veloc", 1000.0)], "fldaa fldva fstart", sentence);
    rig.refuses(&[("accel", 0.0)], "fldaa fstart", "the acceleration register is 0");
}

/// Proves: SAIA-HND-02, SAIA-HND-06
#[test]
fn a_verb_is_acknowledged_in_its_cycle_and_an_empty_one_does_nothing() {
    let mut rig = Rig::holding();
    let before = rig.picture();
    rig.does(&[], "");
    assert_eq!(rig.picture(), before);
    let accepted = rig.machine.events().iter().filter(|event| event.kind == Kind::Accepted).count();
    assert_eq!(accepted, 1);
}

#[test]
fn names_and_values_are_checked_at_the_border() {
    use crate::parameter::ParameterInput::{Integer, Number, Text};
    let config = super::rig::config();
    let sentence = |name: &str, input| config.resolve_saia_register(name, &input).unwrap_err().to_string();
    assert!(sentence("destq", Integer(1)).starts_with("no register is called `destq`; there are kprop, kint, kder"));
    assert!(sentence("destp", Number(1.5)).contains("destp is `1.5`; a whole number -2147483648..2147483647"));
    assert!(sentence("destp", Integer(1 << 31)).contains("destp is `2147483648`; a whole number"));
    assert!(sentence("mcfac", Number(f64::NAN)).contains("mcfac is `NaN`; a number 0..9.223371e18"));
    assert!(sentence("mcfac", Number(-1.0)).contains("mcfac is `-1`; a number"));
    assert!(sentence("veloc", Text("fast".into())).contains("veloc is `fast`; a whole number"));
    let sentence = config.resolve_saia_command("fgo").unwrap_err().to_string();
    assert!(sentence.starts_with("no command is called `fgo`; there are axinit, fselom"), "{sentence}");
}

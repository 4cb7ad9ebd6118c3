//! Buffers, the commands that activate them, and the bases of relative loads.

use super::super::{Command, Register};
use super::rig::{FAST, Rig, X, flag};
use crate::command::Action;
use crate::parameter::Value;

/// Names are those of the manual; the 29 commands, and the function block before them.
///
/// Proves: SAIA-FLG-06, SAIA-REG-00..12
#[test]
fn registers_and_commands_have_the_manuals_names() {
    let registers = Register::ALL.map(|(register, _)| register.name());
    let names = [
        "kprop", "kint", "kder", "intl", "sampi", "mcfac", "poser", "destp", "brkp", "veloc", "accel", "stafrr", "mcw",
    ];
    assert_eq!(registers, names);
    let commands: Vec<&str> = Command::ALL.iter().map(|(_, name)| *name).collect();
    assert_eq!(commands.len(), 30);
    for name in "flddr fldda fldvr fldva fldar fldaa fldrp fupdrp fstart fstop fmotoff fsstepf fsstepb fforw fbackw frdap frdsp \
                 frdav frdsv frdits frdip frdsr fressf fldbpa fldbpr fsetip fsetzp fselom fsetpe axinit"
        .split_whitespace()
    {
        assert_eq!(flag(name).name(), name);
    }
    assert_eq!(Register::find("kpropp"), None);
}

/// Integers of 32 bits; the command that reads a register checks its range.
///
/// Proves: SAIA-REG-00, SAIA-REG-01, SAIA-REG-02, SAIA-REG-03, SAIA-REG-04, SAIA-REG-06, SAIA-DET-02
#[test]
fn a_register_out_of_range_is_refused_by_its_command() {
    for (register, flags, low, high) in [
        ("kprop", "fldrp", 0, 32_767),
        ("kint", "fldrp", 0, 32_767),
        ("kder", "fldrp", 0, 32_767),
        ("intl", "fldrp", 0, 32_767),
        ("sampi", "fldrp", 0, 255),
        ("poser", "fsetpe", 0, 32_767),
    ] {
        let mut rig = Rig::ready(FAST);
        rig.does(&[(register, f64::from(low))], flags);
        rig.does(&[(register, f64::from(high))], flags);
        for bad in [low - 1, high + 1] {
            let before = rig.picture();
            rig.refuses(
                &[(register, f64::from(bad))],
                flags,
                &format!("saia.{register} is {bad}; {low} to {high} is allowed"),
            );
            assert_eq!(rig.picture(), before, "{register}");
        }
    }
}

/// Proves: SAIA-ORA-04, SAIA-DET-16, SAIA-ORA-06, SAIA-MCW-01, SAIA-MCW-04, SAIA-MCW-05, SAIA-MCW-06, SAIA-REG-12
#[test]
fn the_control_word_of_the_examples_means_ramp_stop_position_and_flag_only() {
    // 500 encoder pulses are 4 * 500 counts.
    let mut rig = Rig::ready(&[("mcw", f64::from(0x41B)), ("poser", 2000.0), ("veloc", 50_000.0), ("accel", 1e6)]);
    assert_eq!(rig.signals() >> 9 & 1, 0);
    rig.does(&[("destp", 100_000.0)], "fldda fstart");
    assert_eq!((rig.saia_state(), rig.int("x.saia.velocity_mode")), ("POS", 0));
    rig.run(200);
    rig.does(&[], "fstop");
    assert_eq!(rig.saia_state(), "RAMP");
}

/// Proves: SAIA-CMD-03, SAIA-CMD-05, SAIA-DET-01, SAIA-PRF-01, SAIA-HND-04
#[test]
fn loads_change_nothing_until_a_start() {
    let mut rig = Rig::moving();
    rig.does(&[("destp", 5.0), ("veloc", 1000.0), ("mcw", f64::from(0x1C1B))], "fldda fldva fselom");
    for _ in 0..50 {
        rig.run(1);
        assert!((rig.real("x.command.velocity") - 50_000.0).abs() < 0.03);
    }
    assert_eq!((rig.int("x.saia.destination"), rig.int("x.saia.velocity_mode")), (100_000, 0));
    // Nor does a register alone, with or without a load.
    rig.parameter("saia.destp", Value::Int(77));
    rig.does(&[("mcw", f64::from(0x41B))], "fselom fldva");
    rig.does(&[], "fstart");
    assert_eq!(rig.int("x.saia.destination"), 5);
    rig.run_until("x.saia.ondest", 1);
    assert_eq!(rig.int("x.command.position"), 5);
}

/// Proves: SAIA-ORA-03, SAIA-CMD-04
#[test]
fn a_relative_destination_counts_from_the_one_started_last() {
    let mut rig = Rig::ready(&[("mcfac", 1.33333), ("veloc", 50_000.0), ("accel", 1e6)]);
    rig.does(&[("destp", 60_000.0)], "fldda fstart");
    assert_eq!(rig.int("x.saia.destination"), 80_000);
    rig.does(&[("destp", -60_000.0)], "flddr");
    // Two loads without a start do not add up (A19).
    rig.does(&[], "flddr");
    rig.does(&[], "fstart");
    assert_eq!(rig.int("x.saia.destination"), 0);
    rig.does(&[], "flddr fstart");
    assert_eq!(rig.int("x.saia.destination"), -80_000);
}

/// Proves: SAIA-CMD-06, SAIA-CAP-08
#[test]
fn a_relative_velocity_counts_from_the_working_one_and_may_not_become_negative() {
    let mut rig = Rig::moving();
    assert_eq!(rig.int("x.saia.velocity_register"), 1_118_481);
    rig.does(&[("veloc", -10_000.0)], "fldvr");
    rig.does(&[], "fldvr fstart");
    // 10 000 counts/s are 223 696 steps.
    assert_eq!(rig.int("x.saia.velocity_register"), 1_118_481 - 223_696);
    rig.run(50);
    assert!((rig.real("x.command.velocity") - 40_000.0).abs() < 0.05);
    rig.refuses(&[("veloc", -50_000.0)], "fldvr", "makes -223696 in the velocity register; 0 to");
}

/// Proves: SAIA-CMD-07, SAIA-CMD-08, SAIA-DET-04, SAIA-SIG-10
#[test]
fn a_new_acceleration_switches_the_motor_off_and_waits_for_a_start_at_rest() {
    let mut rig = Rig::moving();
    rig.does(&[("accel", 2_000_000.0)], "fldaa");
    assert_eq!((rig.saia_state(), rig.int("x.saia.ondest"), rig.int("x.saia.acceleration_pending")), ("OFF", 1, 1));
    assert_eq!(rig.int("x.enabled"), 0);
    assert_eq!(rig.int("x.saia.acceleration_register"), 7635);
    assert_eq!(rig.signals() >> 14 & 1, 1);
    rig.does(&[("destp", 200_000.0)], "fldda fstart");
    assert_eq!((rig.saia_state(), rig.int("x.saia.acceleration_pending")), ("POS", 0));
    assert_eq!(rig.int("x.saia.acceleration_register"), 15_271);
    rig.run_until("x.enabled", 1);
    rig.run_until("x.saia.ondest", 1);
    assert_eq!(rig.int("x.command.position"), 200_000);
    rig.does(&[("accel", -500_000.0)], "fldar fstart");
    // 500 000 counts/s^2 are 3818 steps.
    assert_eq!(rig.int("x.saia.acceleration_register"), 15_271 - 3818);
    rig.refuses(&[("accel", -3_000_000.0)], "fldar", "in the acceleration register; 0 to");
    assert_eq!(rig.saia_state(), "POS", "a load that is refused switches nothing off");
}

/// Proves: SAIA-DET-03, SAIA-INI-10, SAIA-ERR-02
#[test]
fn relative_loads_are_refused_before_the_first_start() {
    for (flag, register) in [("flddr", "destp"), ("fldvr", "veloc"), ("fldar", "accel"), ("fldbpr", "brkp")] {
        let mut rig = Rig::ready(FAST);
        let sentence = format!("saia.{register} cannot be loaded relatively before the first fstart after axinit");
        rig.refuses(&[(register, 1.0)], flag, &sentence);
        rig.does(&[("destp", 0.0), ("accel", 1e6), ("veloc", 50_000.0)], "fldda fstart");
        rig.run(20);
        rig.does(&[(register, 1.0)], flag);
        rig.does(&[("accel", 1e6), ("veloc", 50_000.0)], "axinit");
        rig.refuses(&[(register, 1.0)], flag, &sentence);
    }
}

/// Proves: SAIA-CMD-26, SAIA-CMD-27, SAIA-EXT-08
#[test]
fn a_relative_break_position_counts_from_the_destination_and_keeps_within_the_range() {
    let mut rig = Rig::holding();
    rig.does(&[("destp", 5000.0), ("brkp", -3000.0)], "fldda fstart fldbpr");
    // The load comes first: it is relative to the previous destination.
    rig.run_until("x.saia.ondest", 1);
    assert_eq!(rig.int("x.saia.brkpos"), 0);
    rig.does(&[("destp", 0.0)], "fldda fldbpr fstart");
    rig.run_until("x.saia.brkpos", 1);
    assert!(rig.int("x.saia.position") <= 2000 && rig.int("x.saia.position") > 1900);
    rig.run_until("x.saia.ondest", 1);
    rig.does(&[("destp", 1_073_741_000.0)], "fldda fstart");
    rig.refuses(&[("brkp", 1000.0)], "fldbpr", "saia.brkp with saia.mcfac makes 1073742000 counts");
}

/// Several flags in one step: loads before `fressf`, `fressf` before `fstart`, whatever their order in the request.
///
/// Proves: SAIA-HND-05, SAIA-HND-01
#[test]
fn flags_set_together_run_in_fixed_order() {
    let mut rig = Rig::holding();
    let request = rig.request(X, &[("destp", 9000.0), ("veloc", 20_000.0)], "fstart fressf fldva fldda");
    let order: Vec<Command> = request.commands.iter().collect();
    assert_eq!(order, [flag("fldda"), flag("fldva"), flag("fressf"), flag("fstart")]);
    rig.ask([Action::vocabulary(request)]).unwrap();
    assert_eq!((rig.int("x.saia.destination"), rig.int("x.saia.ondest")), (9000, 0));
    rig.run_until("x.saia.ondest", 1);
    assert_eq!(rig.int("x.command.position"), 9000);
}

/// `set:` writes the parameter, which is the register: there is one value, and the change is reported.
#[test]
fn a_register_is_the_parameter_of_its_name() {
    let mut rig = Rig::ready(FAST);
    rig.does(&[("destp", 42.0), ("mcfac", 2.5)], "");
    assert_eq!(rig.register(Register::DestP), Value::Int(42));
    assert_eq!(rig.register(Register::McFac), Value::Real(2.5));
    let told: Vec<_> = rig.machine.events().iter().filter_map(|event| event.parameter).collect();
    assert_eq!(told, [Register::McFac.row().unwrap().0, Register::DestP.row().unwrap().0]);
    rig.parameter("saia.destp", Value::Int(40));
    rig.does(&[], "fldda fstart");
    assert_eq!(rig.int("x.saia.destination"), 100);
}

/// Proves: SAIA-INI-02, SAIA-INI-03, SAIA-INI-04, SAIA-INI-05, SAIA-INI-06, SAIA-INI-07, SAIA-INI-08, SAIA-INI-09
#[test]
fn axinit_resets_and_loads_from_the_registers() {
    let mut rig = Rig::moving();
    rig.parameter("saia.imode", Value::Int(5));
    let set = [("mcw", f64::from(0x1A1A)), ("poser", 123.0), ("kprop", 9.0), ("veloc", 70_000.0), ("accel", 3e6)];
    rig.does(&set, "axinit");
    assert_eq!((rig.saia_state(), rig.int("x.enabled")), ("OFF", 0));
    assert_eq!(rig.int("x.saia.position"), 0, "the position becomes 0 though the axis moves");
    assert_eq!((rig.int("x.saia.destination"), rig.int("x.saia.velocity_register")), (0, 0));
    // OnDest, controller off, PWM, off reaction, new acceleration; mode and direction wait for the start.
    assert_eq!(rig.signals(), 1 << 2 | 1 << 7 | 1 << 8 | 1 << 9 | 1 << 14);
    rig.does(&[], "fstart");
    assert_eq!((rig.saia_state(), rig.int("x.saia.velocity_register")), ("VEL", 1_565_873));
    assert_eq!(rig.int("x.saia.acceleration_register"), 22_906);
}

/// Step 1: no loaded or started value is left, neither active nor in a buffer.
///
/// Proves: SAIA-INI-01
#[test]
fn axinit_resets_the_controller() {
    let gains = [("kprop", 7.0), ("kint", 3.0), ("kder", 5.0), ("intl", 30_000.0), ("sampi", 2.0)];
    let mut rig = Rig::ready(&[FAST, &gains].concat());
    rig.does(&[("destp", 100_000.0), ("brkp", 60_000.0)], "fldda fldbpa fstart");
    rig.run_to("x.command.velocity", 49_999.99);
    rig.plant.drive(0).unwrap().jump(-100);
    rig.run(1);
    let names = ["destination", "velocity_register", "acceleration_register", "position", "output", "integral"];
    let seen = |rig: &Rig| names.map(|name| rig.int(&format!("x.saia.{name}")));
    assert!(seen(&rig).iter().all(|value| *value != 0), "{:?}", seen(&rig));
    rig.does(&gains.map(|(name, _)| (name, 0.0)), "axinit");
    assert_eq!(seen(&rig), [0; 6]);
    // No destination waits for a start.
    rig.does(&[], "fstart");
    assert_eq!(rig.int("x.saia.destination"), 0);
    rig.run_until("x.saia.ondest", 1);
    // The break position is passed in the old coordinate and in the new one without effect, and no gain turns an error
    // into U.
    rig.does(&[("destp", 70_000.0)], "fldda fstart");
    rig.run_to("x.command.velocity", 49_999.99);
    rig.plant.drive(0).unwrap().jump(-100);
    rig.run(1);
    assert!(rig.int("x.following_error") >= 100);
    assert_eq!((rig.int("x.saia.output"), rig.int("x.saia.integral")), (0, 0));
    rig.run_until("x.saia.ondest", 1);
    rig.run(2);
    assert_eq!((rig.int("x.saia.position"), rig.int("x.saia.brkpos")), (70_000, 0));
}

/// A block that fails initialises nothing.
#[test]
fn axinit_is_done_whole_or_not_at_all() {
    for (register, value) in [("kprop", -1.0), ("poser", 40_000.0), ("veloc", -1.0), ("accel", -1000.0), ("mcw", 0.0)] {
        let mut rig = Rig::moving();
        let before = rig.picture();
        rig.refuses(&[(register, value)], "axinit", &format!("saia.{register}"));
        assert_eq!(rig.picture(), before);
        assert_eq!(rig.int("x.enabled"), 1);
    }
}

//! The table of section 12, one row each, and the effects of starts.

use super::super::{Phase, Saia};
use super::rig::{FAST, Rig, V, X};
use crate::command::Action;

const OFF_STOP: (&str, f64) = ("mcw", 0x11B as f64);
const HARD_STOP: (&str, f64) = ("mcw", 0x21B as f64);
const RAMP_STOP: (&str, f64) = ("mcw", 0x41B as f64);
/// Velocity control in positive direction, with a ramp stop.
const SPEED_UP: (&str, f64) = ("mcw", 0x1C1B as f64);
const SPEED_DOWN: (&str, f64) = ("mcw", 0xC1B as f64);

/// Running at 50 000 counts/s in state VEL.
fn running() -> Rig {
    let mut rig = Rig::ready(FAST);
    rig.does(&[SPEED_UP], "fselom fstart");
    rig.run_to("x.command.velocity", 49_999.9);
    rig
}

/// In state RAMP, from POS.
fn ramping() -> Rig {
    let mut rig = Rig::moving();
    rig.does(&[RAMP_STOP], "fstop");
    rig
}

/// Proves: SAIA-FSM-01, SAIA-SIG-03
#[test]
fn axinit_leads_from_any_state_to_off() {
    for mut rig in [Rig::saia(), Rig::ready(FAST), Rig::holding(), Rig::moving(), running(), ramping()] {
        rig.does(FAST, "axinit");
        assert_eq!((rig.saia_state(), rig.int("x.saia.ondest"), rig.int("x.saia.stop_latch")), ("OFF", 1, 0));
        assert_eq!(rig.int("x.saia.acceleration_pending"), 1);
        assert_eq!((rig.int("x.saia.regulator_off"), rig.int("x.enabled")), (1, 0));
        rig.refuses(&[("destp", 1.0)], "flddr", "before the first fstart");
    }
}

/// Proves: SAIA-FSM-02
#[test]
fn before_axinit_every_command_is_refused() {
    for (command, name) in super::super::Command::ALL.iter().skip(1) {
        let mut rig = Rig::saia();
        rig.refuses(FAST, name, "axinit has not run and the axis is off; axinit or enable must come first");
        assert_eq!((rig.saia_state(), command.name()), ("PWR", *name));
    }
    // In one request `axinit` runs first.
    let mut rig = Rig::saia();
    rig.run(5);
    rig.does(&[("destp", 10.0), ("veloc", 50_000.0), ("accel", 1e6)], "fstart fldda axinit");
    assert_eq!(rig.saia_state(), "POS");
}

/// Proves: SAIA-FSM-02, SAIA-INI-09
#[test]
fn enable_replaces_axinit_and_axis_stays_on() {
    let mut rig = Rig::saia();
    rig.on();
    assert_eq!(rig.saia_state(), "PWR");
    // Without accel: the default of the axis, half of its maximum, limited to the velocity.
    rig.does(&[("destp", 1000.0), ("veloc", 500.0)], "fldda fldva fstart");
    assert_eq!((rig.saia_state(), rig.int("x.saia.ondest"), rig.int("x.enabled")), ("POS", 0, 1));
    assert_eq!((rig.int("x.saia.velocity_register"), rig.int("x.saia.acceleration_register")), (11_185, 11_185));
    rig.does(&[("destp", -1.0)], "flddr");
    // In motion the acceleration does not change.
    let sentence = "the acceleration register is 11185; 1 to the velocity register, 22, is allowed";
    rig.refuses(&[("veloc", 1.0)], "fldva fstart", sentence);
    rig.does(&[("veloc", 5_000.0), ("destp", 1000.0)], "fldda fldva fstart");
    rig.run_until("x.saia.ondest", 1);
    assert_eq!((rig.int("x.command.position"), rig.saia_state()), (1000, "HOLD"));
    // axinit uses the registers that the request sets.
    let mut rig = Rig::saia();
    rig.on();
    rig.does(&[("destp", 10.0), ("veloc", 500.0), ("mcfac", 100.0)], "fldda fstart");
    assert_eq!(rig.int("x.saia.destination"), 1000);
    // Relative loads are not allowed, as after axinit, and a refused request initialises nothing.
    let mut rig = Rig::saia();
    rig.on();
    rig.refuses(&[("destp", 1.0)], "flddr", "before the first fstart");
    rig.refuses(&[("destp", 1.0)], "fldda fstart", "the velocity register is 0; fldva has to load one first");
    assert_eq!(rig.saia_state(), "PWR");
}

/// Proves: SAIA-FSM-03, SAIA-CMD-11, SAIA-DET-06, SAIA-SIG-06
#[test]
fn a_start_from_off_switches_the_drive_on_and_then_moves() {
    let mut rig = Rig::ready(FAST);
    assert_eq!(rig.int("x.enabled"), 0);
    rig.does(&[("destp", 1000.0)], "fldda fstart");
    assert_eq!((rig.saia_state(), rig.int("x.saia.ondest"), rig.int("x.saia.acceleration_pending")), ("POS", 0, 0));
    assert_eq!(rig.signals() & (1 << 7 | 1 << 10 | 1 << 14), 0);
    rig.run_until("x.enabled", 1);
    assert_eq!((rig.int("x.command.position"), rig.int("x.saia.ondest")), (0, 0));
    rig.run_until("x.saia.ondest", 1);
    assert_eq!((rig.saia_state(), rig.int("x.command.position")), ("HOLD", 1000));
    // From HOLD it moves in the next cycle.
    rig.does(&[("destp", 3000.0)], "flddr fstart");
    assert_eq!(rig.int("x.command.position"), 1000);
    rig.run(3);
    assert!(rig.int("x.command.position") > 1000);
    rig.run_until("x.saia.ondest", 1);
    assert_eq!(rig.int("x.command.position"), 4000);
}

/// Proves: SAIA-FSM-04, SAIA-PRF-04, SAIA-MCW-05, SAIA-MCW-06, SAIA-SIG-07, SAIA-SIG-08
#[test]
fn velocity_control_runs_until_a_stop_in_the_direction_of_bit_12() {
    for (mode, sign) in [(SPEED_UP, 1.0), (SPEED_DOWN, -1.0)] {
        let mut rig = Rig::ready(FAST);
        rig.does(&[mode], "fselom");
        assert_eq!(rig.int("x.saia.velocity_mode"), 0, "changes only with a start");
        rig.does(&[], "fstart");
        assert_eq!(rig.saia_state(), "VEL");
        assert_eq!(rig.signals() >> 11 & 3, if sign > 0.0 { 3 } else { 1 });
        rig.run(3000);
        let velocity = rig.real("x.command.velocity");
        assert!((velocity - sign * 50_000.0).abs() < 0.03, "{velocity}");
        // The velocity may change in motion.
        rig.does(&[("veloc", 20_000.0)], "fldva fstart");
        rig.run(100);
        assert!((rig.real("x.command.velocity") - sign * 20_000.0).abs() < 0.03);
        assert_eq!((rig.saia_state(), rig.int("x.saia.ondest")), ("VEL", 0));
    }
}

/// Only bits 11 and 12 of MCW select, also in motion, and only by `fselom` and a start.
///
/// Proves: SAIA-CMD-01
#[test]
fn a_mode_and_a_direction_wait_for_the_next_start() {
    const POSITION: (i64, &str, f64) = (0, "POS", 0.0);
    const UP: (i64, &str, f64) = (3, "VEL", 50_000.0);
    const DOWN: (i64, &str, f64) = (1, "VEL", -50_000.0);
    // All other bits of the word are 0 or 1.
    let word = |bits: i64, others: i32| ("mcw", f64::from((others & !0x1800) | (bits as i32) << 11));
    let shown = |rig: &Rig| (rig.saia_state(), rig.int("x.saia.velocity_mode"), rig.int("x.saia.forward"));
    for (others, from) in [(0, POSITION), (-1, POSITION), (0, UP), (-1, UP), (0, DOWN), (-1, DOWN)] {
        for (bits, state, velocity) in [POSITION, (2, "POS", 0.0), UP, DOWN] {
            let mut rig = Rig::ready(FAST);
            rig.does(&[("destp", 100_000.0), word(from.0, 0)], "fldda fselom fstart");
            rig.run(100);
            let (before, speed) = (shown(&rig), rig.real("x.command.velocity"));
            assert_eq!((before.0, speed.abs().round()), (from.1, 50_000.0));
            rig.does(&[word(bits, others)], "fselom");
            for _ in 0..20 {
                rig.run(1);
                assert_eq!((shown(&rig), rig.real("x.command.velocity")), (before, speed), "{from:?} {bits}");
            }
            // A word that no command reads selects nothing.
            rig.does(&[word(bits ^ 3, others)], "");
            rig.does(&[], "fstart");
            assert_eq!((rig.saia_state(), rig.int("x.saia.velocity_mode")), (state, bits & 1), "{from:?} {bits}");
            if state == "POS" {
                rig.run_until("x.saia.ondest", 1);
                assert_eq!(rig.int("x.command.position"), 100_000, "{from:?} {bits}");
            } else {
                rig.run(3_000);
                assert_eq!((rig.int("x.saia.forward"), rig.saia_state()), (bits >> 1, "VEL"), "{from:?} {bits}");
                assert_eq!(rig.real("x.command.velocity").round(), velocity, "{from:?} {bits}");
            }
        }
    }
}

/// No request leads to a pending acceleration in motion, because a load switches off. The check exists for restored
/// states.
///
/// Proves: SAIA-FSM-05, SAIA-DET-05
#[test]
fn a_start_in_motion_is_refused_while_an_acceleration_waits() {
    use crate::vocabulary::saia::Commands;
    let rig = Rig::moving();
    let bench = super::takeover::Bench::of(&rig);
    for phase in [Phase::Position, Phase::Velocity, Phase::Ramp] {
        let mut saia = Saia { phase, acceleration_pending: true, ..bench.moving_state() };
        let before = saia;
        let request =
            super::super::Request { commands: Commands::from_iter([super::rig::flag("fstart")]), ..Default::default() };
        let refusal = saia.run(&request, &bench.view(), None).unwrap_err();
        assert_eq!(refusal.code, crate::code::Code::SAIA_ACCELERATION_PENDING);
        let kept = Saia { errors: before.errors, ..saia };
        assert_eq!(kept, before);
    }
}

/// Proves: SAIA-FSM-06, SAIA-PRF-03, SAIA-PRF-08
#[test]
fn a_start_in_motion_takes_the_new_destination_velocity_and_mode_over_on_the_fly() {
    let mut rig = Rig::moving();
    // The destination is behind the stopping point: slow down to zero, reverse, approach.
    rig.does(&[("destp", 500.0)], "fldda fstart");
    let mut lowest = f64::MAX;
    while rig.int("x.saia.ondest") == 0 {
        let before = rig.real("x.command.velocity");
        rig.run(1);
        let change = (rig.real("x.command.velocity") - before).abs();
        assert!(change <= 1001.0, "{change}");
        lowest = lowest.min(rig.real("x.command.velocity"));
    }
    assert!(lowest < -10_000.0);
    assert_eq!(rig.int("x.command.position"), 500);

    // To velocity control in negative direction while moving, through zero with the acceleration, and back.
    let mut rig = Rig::moving();
    rig.does(&[SPEED_DOWN], "fselom fstart");
    assert_eq!(rig.saia_state(), "VEL");
    for _ in 0..150 {
        let before = rig.real("x.command.velocity");
        rig.run(1);
        assert!((rig.real("x.command.velocity") - before).abs() <= 1001.0);
    }
    assert!((rig.real("x.command.velocity") + 50_000.0).abs() < 0.03);
    rig.does(&[RAMP_STOP, ("destp", 0.0)], "fselom fldda fstart");
    assert_eq!(rig.saia_state(), "POS");
    rig.run_until("x.saia.ondest", 1);
    assert_eq!(rig.int("x.command.position"), 0);
    // In RAMP, with a load that releases the latch.
    let mut rig = ramping();
    rig.does(&[("destp", 120_000.0)], "fldda fstart");
    assert_eq!(rig.saia_state(), "POS");
    rig.run_until("x.saia.ondest", 1);
    assert_eq!(rig.int("x.command.position"), 120_000);
}

/// Proves: SAIA-FSM-07, SAIA-DET-07
#[test]
fn a_start_after_a_stop_without_a_load_moves_nothing_and_is_no_error() {
    for (stop, state) in [(OFF_STOP, "OFF"), (HARD_STOP, "HOLD"), (RAMP_STOP, "HOLD")] {
        let mut rig = Rig::moving();
        rig.does(&[stop], "fstop");
        rig.run(100);
        assert_eq!((rig.saia_state(), rig.int("x.saia.stop_latch")), (state, 1));
        let place = rig.int("x.command.position");
        rig.does(&[("stafrr", 0.0)], "fressf");
        assert_eq!(rig.int("x.saia.ondest"), 0);
        rig.does(&[], "fstart");
        assert_eq!(rig.int("x.saia.ondest"), 1);
        rig.run(50);
        assert_eq!((rig.saia_state(), rig.int("x.command.position")), (state, place));
    }
}

/// The destination is kept through the stop: a new mode or velocity is enough to continue.
///
/// Proves: SAIA-FSM-16, SAIA-DET-07
#[test]
fn a_load_or_a_mode_frees_the_stop_latch() {
    for free in ["fselom", "fldda", "flddr", "fldva", "fldvr", "fldaa", "fldar"] {
        let mut rig = Rig::moving();
        rig.does(&[RAMP_STOP], "fstop");
        rig.run(100);
        assert_eq!(rig.int("x.saia.stop_latch"), 1);
        let zero = [("destp", 0.0), ("veloc", 0.0), ("accel", 0.0)];
        let set = if free.ends_with('r') { &zero[..] } else { &[] };
        rig.does(set, free);
        assert_eq!(rig.int("x.saia.stop_latch"), 0, "{free}");
        rig.does(&[], "fstart");
        rig.run_until("x.saia.ondest", 1);
        assert_eq!(rig.int("x.command.position"), 100_000, "{free}");
    }
    for (free, position) in [("fforw", 1.0), ("fbackw", -1.0)] {
        let mut rig = Rig::moving();
        rig.does(&[RAMP_STOP], "fstop");
        rig.run(100);
        rig.does(&[], free);
        rig.run(100);
        assert_eq!((rig.saia_state(), rig.int("x.saia.stop_latch")), ("POS", 0));
        assert!((rig.real("x.command.velocity") - position * 50_000.0).abs() < 0.03, "{free}");
    }
}

/// Proves: SAIA-FSM-08, SAIA-STA-01, SAIA-EXT-02, SAIA-PRF-06
#[test]
fn the_end_of_a_profile_is_hold_with_ondest_and_bit_10() {
    let mut rig = Rig::moving();
    assert_eq!(rig.signals() & (1 << 2 | 1 << 10), 0);
    rig.run_until("x.saia.ondest", 1);
    assert_eq!((rig.saia_state(), rig.int("x.command.position")), ("HOLD", 100_000));
    assert_eq!(rig.signals() & (1 << 2 | 1 << 7 | 1 << 10), 1 << 2 | 1 << 10);
    // The destination is held.
    rig.run(100);
    assert_eq!((rig.int("x.enabled"), rig.int("x.command.position")), (1, 100_000));
}

/// 50 000 counts/s at 7635 steps, 999 936 counts/s^2: 50.003 ms and 1250.1 counts.
///
/// Proves: SAIA-FSM-09, SAIA-FSM-10, SAIA-MCW-04, SAIA-CMD-12
#[test]
fn a_ramp_stop_slows_down_with_the_acceleration_and_then_sets_ondest() {
    for mut rig in [Rig::moving(), running()] {
        let start = rig.int("x.command.position");
        rig.does(&[RAMP_STOP], "fstop");
        assert_eq!((rig.saia_state(), rig.int("x.saia.ondest"), rig.int("x.saia.stop_latch")), ("RAMP", 0, 1));
        let mut cycles = 0;
        while rig.int("x.saia.ondest") == 0 {
            rig.run(1);
            cycles += 1;
        }
        assert_eq!((rig.saia_state(), cycles), ("HOLD", 51));
        assert_eq!(rig.signals() >> 10 & 1, 1);
        let way = rig.int("x.command.position") - start;
        assert!((1299..=1302).contains(&way), "{way}: 50 counts in the cycle of the command, 1250 to stop");
    }
    // A second stop on the ramp: the ramp does not change.
    let mut rig = ramping();
    rig.run(10);
    rig.does(&[RAMP_STOP], "fstop");
    assert_eq!(rig.saia_state(), "RAMP");
}

/// Proves: SAIA-FSM-11, SAIA-MCW-03, SAIA-DET-08
#[test]
fn a_hard_stop_stands_on_the_actual_position_at_once() {
    for mut rig in [Rig::moving(), running(), ramping()] {
        rig.does(&[HARD_STOP], "fstop");
        assert_eq!((rig.saia_state(), rig.int("x.saia.ondest"), rig.int("x.saia.stop_latch")), ("HOLD", 1, 1));
        assert_eq!(rig.int("x.command.position"), rig.int("x.actual.position"));
        assert_eq!((rig.real("x.command.velocity"), rig.int("x.enabled")), (0.0, 1));
        assert_eq!(rig.signals() >> 10 & 1, 1);
    }
}

/// Proves: SAIA-FSM-12, SAIA-MCW-02, SAIA-CMD-13, SAIA-DET-08, SAIA-STA-01
#[test]
fn the_motor_goes_off_from_every_state() {
    let rigs = || [Rig::moving(), running(), ramping(), Rig::holding(), Rig::ready(FAST)];
    for (flags, set) in [("fstop", vec![OFF_STOP]), ("fmotoff", vec![])] {
        for mut rig in rigs() {
            rig.does(&[("stafrr", 0.0)], "fressf");
            rig.does(&set, flags);
            assert_eq!((rig.saia_state(), rig.int("x.saia.ondest"), rig.int("x.saia.stop_latch")), ("OFF", 1, 1));
            assert_eq!((rig.int("x.enabled"), rig.int("x.saia.output")), (0, 0));
            assert_eq!(rig.signals() >> 7 & 1, 1);
        }
    }
    for mut rig in rigs() {
        rig.does(&[("accel", 1e6)], "fldaa");
        assert_eq!((rig.saia_state(), rig.int("x.saia.stop_latch"), rig.int("x.enabled")), ("OFF", 0, 0));
        assert_eq!(rig.int("x.saia.acceleration_pending"), 1);
    }
}

/// Proves: SAIA-FSM-13
#[test]
fn a_stop_at_rest_sets_the_latch_and_ondest() {
    for stop in [HARD_STOP, RAMP_STOP] {
        for (mut rig, state) in [(Rig::holding(), "HOLD"), (Rig::ready(FAST), "OFF")] {
            rig.does(&[("stafrr", 0.0)], "fressf");
            rig.does(&[stop], "fstop");
            assert_eq!((rig.saia_state(), rig.int("x.saia.ondest"), rig.int("x.saia.stop_latch")), (state, 1, 1));
        }
    }
    // In HOLD a hard stop makes the actual position the setpoint.
    let mut rig = Rig::holding();
    rig.plant.drive(0).unwrap().jump(7);
    rig.run(1);
    rig.plant.drive(0).unwrap().jump(0);
    let actual = rig.int("x.actual.position");
    rig.does(&[HARD_STOP], "fstop");
    assert_eq!(rig.int("x.command.position"), rig.int("x.actual.position"));
    assert!((actual - 1000).abs() <= 7);
}

/// Proves: SAIA-CMD-14, SAIA-CMD-15, SAIA-DET-09
#[test]
fn a_single_step_is_one_count_and_only_at_rest() {
    let mut rig = Rig::holding();
    for (flag, position) in [("fsstepf", 1001), ("fsstepf", 1002), ("fsstepb", 1001)] {
        rig.does(&[], flag);
        assert_eq!((rig.saia_state(), rig.int("x.saia.ondest")), ("POS", 0));
        rig.run_until("x.saia.ondest", 1);
        assert_eq!((rig.int("x.command.position"), rig.int("x.saia.destination")), (position, position));
    }
    for mut rig in [Rig::moving(), running(), ramping()] {
        for flag in ["fsstepf", "fsstepb"] {
            let before = (rig.saia_state(), rig.int("x.saia.destination"));
            rig.refuses(&[], flag, "fsstepf and fsstepb need an axis at rest");
            assert_eq!((rig.saia_state(), rig.int("x.saia.destination")), before);
        }
    }
    for (jog, step, end) in [("fforw", "fsstepf", 1_073_741_823_i64), ("fbackw", "fsstepb", -1_073_741_824)] {
        let mut rig = Rig::holding();
        rig.does(&[], jog);
        rig.run(10);
        rig.does(&[RAMP_STOP], "fstop");
        rig.run_until("x.saia.ondest", 1);
        rig.refuses(&[], step, &format!("the destination is {end} counts, the end of its range"));
    }
}

/// Proves: SAIA-CMD-16, SAIA-CMD-17, SAIA-DET-10, SAIA-ORA-18
#[test]
fn a_jog_goes_to_the_end_of_the_range_and_only_a_stop_ends_it() {
    let mut rig = Rig::holding();
    rig.does(&[], "fforw");
    assert_eq!((rig.saia_state(), rig.int("x.saia.destination")), ("POS", 1_073_741_823));
    rig.run(5000);
    assert!((rig.real("x.command.velocity") - 50_000.0).abs() < 0.03);
    rig.does(&[RAMP_STOP], "fstop");
    rig.run_until("x.saia.ondest", 1);
    let place = rig.int("x.command.position");
    rig.refuses(&[("destp", 1.0)], "flddr", "saia.destp with saia.mcfac makes 1073741824 counts");
    // The opposite direction is in range: a very remote target.
    rig.does(&[("destp", -1.0)], "flddr");
    rig.does(&[("destp", 0.0)], "fldda fstart");
    rig.run_until("x.saia.ondest", 1);
    assert_eq!(rig.int("x.command.position"), 0);
    rig.does(&[], "fbackw");
    assert_eq!(rig.int("x.saia.destination"), -1_073_741_824);
    rig.run(1000);
    assert!((rig.real("x.command.velocity") + 50_000.0).abs() < 0.03 && place > 0);
}

/// A jog and a step are position moves by construction; the buffered mode waits for the next `fstart` (A23).
#[test]
fn a_jog_in_velocity_mode_keeps_the_buffered_mode() {
    let mut rig = running();
    rig.does(&[], "fbackw");
    assert_eq!((rig.saia_state(), rig.int("x.saia.velocity_mode")), ("POS", 0));
    rig.run(200);
    assert!((rig.real("x.command.velocity") + 50_000.0).abs() < 0.03);
    rig.does(&[], "fstart");
    assert_eq!(rig.saia_state(), "VEL");
    rig.run(200);
    assert!((rig.real("x.command.velocity") - 50_000.0).abs() < 0.03);
}

/// Proves: SAIA-PRF-02, SAIA-PRF-06
#[test]
fn a_short_move_is_a_triangle_and_a_long_one_a_trapezoid() {
    let mut rig = Rig::holding();
    // a = 7635 steps: the peak velocity of 900 counts is sqrt(a 900) = 29 999; for 100 000 counts it is the programmed
    // velocity.
    for (way, peak) in [(900.0, 29_999.0), (100_000.0, 50_000.0)] {
        rig.does(&[("destp", way)], "flddr fstart");
        let mut most = 0.0_f64;
        while rig.int("x.saia.ondest") == 0 {
            rig.run(1);
            most = most.max(rig.real("x.command.velocity"));
        }
        assert!((most - peak).abs() < 500.0, "{most}");
    }
}

/// Proves: SAIA-ORA-16
#[test]
fn without_a_load_the_first_start_goes_to_0() {
    let mut rig = Rig::logging(FAST);
    rig.verb(X, &[("destp", 500.0)], "flddr fstart").unwrap();
    assert_eq!((rig.int("x.saia.command_errors"), rig.warnings()), (1, 1));
    assert_eq!((rig.saia_state(), rig.int("x.saia.destination")), ("POS", 0));
    rig.run_until("x.saia.ondest", 1);
    assert_eq!(rig.int("x.command.position"), 0);
}

/// One step with several requests: the same cycle for all.
///
/// Proves: SAIA-SW-04, SAIA-CAP-01
#[test]
fn several_axes_start_in_the_same_cycle() {
    let mut rig = Rig::holding();
    rig.verb(V, FAST, "axinit").unwrap();
    rig.run(5);
    let verbs = [(X, 5000.0), (V, 4000.0)];
    let actions = verbs.map(|(axis, way)| {
        Action::vocabulary(rig.request(
            axis,
            &[("destp", way)],
            if axis == X { "flddr fstart" } else { "fldda fstart" },
        ))
    });
    rig.ask(actions).unwrap();
    assert_eq!((rig.int("x.command.position"), rig.int("v.command.position")), (1000, 0));
    for _ in 0..60 {
        rig.run(1);
        let ways = (rig.int("x.command.position") - 1000, rig.int("v.command.position"));
        assert!(ways.0 == ways.1 && ways.0 >= 0, "{ways:?}");
    }
    rig.run_until("v.saia.ondest", 1);
    assert_eq!(rig.int("v.command.position"), 4000);
    rig.run_until("x.saia.ondest", 1);
    assert_eq!(rig.int("x.command.position"), 6000);
}

/// A virtual axis is always on; off is a state of the vocabulary, and instead of coasting the axis stops with its
/// maximum deceleration.
#[test]
fn a_virtual_axis_does_the_same() {
    let mut rig = Rig::saia();
    rig.verb(V, FAST, "axinit").unwrap();
    rig.verb(V, &[("destp", 100_000.0)], "fldda fstart").unwrap();
    rig.run(200);
    assert!((rig.real("v.command.velocity") - 50_000.0).abs() < 0.03);
    rig.verb(V, &[], "fmotoff").unwrap();
    assert_eq!((rig.int("v.saia.state"), rig.int("v.saia.regulator_off")), (1, 1));
    rig.run(3);
    assert_eq!((rig.real("v.command.velocity"), rig.int("v.saia.state")), (0.0, 1));
    rig.verb(V, &[], "fldva fstart").unwrap();
    rig.run_until("v.saia.ondest", 1);
    assert_eq!((rig.int("v.command.position"), rig.int("v.saia.position")), (100_000, 100_000));
}

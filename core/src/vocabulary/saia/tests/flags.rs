//! Status flags, signal register, break positions, index, zero and position error.

use super::rig::{FAST, Rig, X};
use super::takeover::Bench;
use crate::code::Code;
use crate::command::{Action, Move, MoveMode};
use crate::machine::rig::to;
use crate::object::Object;
use crate::parameter::Value;
use crate::position::Position;
use crate::sim::{Fixtures, Index};
use crate::vocabulary::{LatchView, Order};

const FLAG_ONLY: (&str, f64) = ("mcw", 0x41B as f64);
const FLAG_AND_OFF: (&str, f64) = ("mcw", 0x41A as f64);

/// Proves: SAIA-FLG-00, SAIA-FLG-01, SAIA-FLG-02, SAIA-FLG-03, SAIA-FLG-04, SAIA-HND-03
#[test]
fn the_five_status_flags_are_signals() {
    let rig = Rig::ready(FAST);
    assert_eq!(rig.flags(), [1, 0, 0, 0, 0]);
    // After the call that executed `fstart`, OnDest is 0 already.
    let mut rig = Rig::holding();
    rig.does(&[("destp", 10.0)], "flddr fstart");
    assert_eq!(rig.flags(), [0, 0, 0, 0, 0]);
}

/// Proves: SAIA-CMD-25, SAIA-STA-06, SAIA-REG-11
#[test]
fn fressf_clears_what_its_mask_has_as_0() {
    let all = |saia: &super::super::Saia| {
        let f = saia.flags;
        [f.on_dest, f.index, f.wrapped, f.error, f.passed]
    };
    let mut bench = Bench::new();
    let mut saia = bench.moving_state();
    for place in 0..5 {
        saia.flags = super::super::Flags { on_dest: true, index: true, wrapped: true, error: true, passed: true };
        bench.parameters.vocabularies.saia.stafrr = !(1 << (place + 2));
        bench.run(&mut saia, "fressf");
        let expected: Vec<bool> = (0..5).map(|flag| flag != place).collect();
        assert_eq!(all(&saia).to_vec(), expected);
    }
    saia.flags = super::super::Flags { on_dest: true, index: true, wrapped: true, error: true, passed: true };
    bench.parameters.vocabularies.saia.stafrr = 0;
    bench.run(&mut saia, "fressf");
    assert_eq!(all(&saia), [false; 5]);
    // Flags are set by events, not by states: OnDest stays 0 (A28).
    let mut rig = Rig::holding();
    rig.does(&[("stafrr", 0.0)], "fressf");
    rig.run(20);
    assert_eq!((rig.saia_state(), rig.int("x.saia.ondest")), ("HOLD", 0));
}

/// Proves: SAIA-SIG-00, SAIA-SIG-01, SAIA-SIG-02, SAIA-SIG-03, SAIA-SIG-04, SAIA-SIG-09, SAIA-CMD-24, SAIA-REG-19
#[test]
fn the_signal_register_is_read_by_its_command() {
    let mut rig = Rig::ready(FAST);
    assert_eq!(rig.int("x.saia.rsigb"), 0, "until it is read");
    // After axinit: OnDest, controller off, new acceleration.
    assert_eq!(rig.signals(), 1 << 2 | 1 << 7 | 1 << 14);
    rig.does(&[("destp", 1000.0)], "fldda fsetip fstart");
    assert_eq!(rig.int("x.saia.rsigb"), 1 << 2 | 1 << 7 | 1 << 14, "until it is read again");
    assert_eq!(rig.signals(), 1);
    rig.run_until("x.saia.ondest", 1);
    assert_eq!(rig.signals(), 1 | 1 << 2 | 1 << 10);
    // Power-up: controller off, and bit 8.
    let power_up = super::super::Saia::default();
    assert_eq!(power_up.signal_register(), 1 << 7 | 1 << 8);
}

/// Proves: SAIA-CMD-18, SAIA-CMD-19, SAIA-REG-13, SAIA-REG-14
#[test]
fn positions_are_read_in_units() {
    let mut rig = Rig::moving();
    rig.does(&[("mcfac", 10.0)], "frdap frdsp");
    // The actual position is that of the command of the previous cycle.
    let (actual, command) = (rig.int("x.saia.position"), rig.int("x.command.position"));
    let tenth = |counts: i64| (counts as f64 / 10.0).round() as i64;
    assert_eq!((rig.int("x.saia.ractp"), rig.int("x.saia.rsetp")), (tenth(actual), tenth(command)));
    assert!(command > actual);
    // With the controller off the setpoint is the actual position (A09).
    rig.does(&[], "fmotoff");
    rig.plant.drive(0).unwrap().jump(500);
    rig.run(2);
    rig.does(&[], "frdap frdsp frdsv");
    assert_eq!(rig.int("x.saia.rsetp"), rig.int("x.saia.ractp"));
    assert_eq!(rig.int("x.saia.rsetv"), 0);
    let before = rig.int("x.saia.ractp");
    rig.does(&[("destp", 200_000.0)], "fldda fstart");
    rig.run_until("x.enabled", 1);
    assert_eq!(tenth(rig.int("x.command.position")), before, "no jump at the next start");
}

/// Proves: SAIA-STA-05, SAIA-DET-14, SAIA-REG-08
#[test]
fn a_break_position_is_passed_by_the_actual_position_once() {
    let mut rig = Rig::ready(FAST);
    rig.does(&[("destp", 10_000.0), ("brkp", 7000.0)], "fldda fldbpa fressf fstart");
    while rig.int("x.saia.brkpos") == 0 {
        assert!(rig.int("x.saia.position") < 7000);
        rig.run(1);
    }
    assert!(rig.int("x.saia.position") >= 7000 && rig.int("x.command.position") > rig.int("x.saia.position"));
    rig.run_until("x.saia.ondest", 1);
    // Only once: on the way back nothing happens until it is loaded again.
    rig.does(&[("destp", 0.0)], "fldda fressf fstart");
    rig.run_until("x.saia.ondest", 1);
    assert_eq!(rig.int("x.saia.brkpos"), 0);
    rig.does(&[("destp", 10_000.0)], "fldda fldbpa fstart");
    rig.run_until("x.saia.ondest", 1);
    assert_eq!(rig.int("x.saia.brkpos"), 1);
    rig.does(&[("destp", 0.0)], "fldda fldbpa fressf fstart");
    rig.run_until("x.saia.brkpos", 1);
    assert!(rig.int("x.saia.position") <= 7000, "on the way back too");
}

/// A21: a difference of 0 is enough; if the axis is already there, the position is passed at once, after `fressf`.
#[test]
fn a_break_position_at_the_actual_position_is_passed() {
    let mut rig = Rig::holding();
    rig.does(&[("brkp", 1000.0)], "fldbpa fressf");
    assert_eq!(rig.int("x.saia.brkpos"), 1);
    rig.does(&[("brkp", 2000.0), ("destp", 2000.0)], "fressf fldbpa fldda fstart");
    rig.run_until("x.saia.ondest", 1);
    rig.run(2);
    assert_eq!(rig.int("x.saia.brkpos"), 1);
}

/// Every 4000 inc from 1500. A latch of the axis belongs to its touch probe and is no index.
///
/// Proves: SAIA-CMD-28, SAIA-DET-12, SAIA-STA-02, SAIA-CMD-23, SAIA-REG-17, SAIA-SIG-00
#[test]
fn one_index_is_caught_after_fsetip() {
    let mut rig = Rig::ready(FAST);
    let index = Some(Index { every: 4000, at: 1500 });
    rig.plant.drive(0).unwrap().install_fixtures(Fixtures { index, ..Fixtures::default() });
    rig.does(&[("destp", 100_000.0)], "fldda fstart");
    rig.run_until("x.index.count", 1);
    assert_eq!(rig.int("x.saia.ipuls"), 0, "nobody waits");
    rig.does(&[], "fsetip");
    rig.latch(500_000);
    rig.run(3);
    assert_eq!((rig.int("x.saia.ipuls"), rig.int("x.saia.index_armed")), (0, 1));
    rig.run_until("x.index.count", 2);
    assert_eq!((rig.int("x.saia.ipuls"), rig.int("x.saia.index_armed")), (1, 0));
    assert!(rig.int("x.saia.position") > 5500);
    rig.run_until("x.index.count", 3);
    rig.does(&[("mcfac", 1.0)], "frdip");
    assert_eq!(rig.int("x.saia.rindp"), 5500);
    // Relative to the zero at that time, and unchanged when the zero moves.
    rig.does(&[], "fsetip fsetzp");
    let zero = rig.int("x.actual.position");
    rig.run_until("x.index.count", 4);
    rig.does(&[], "fsetzp frdip");
    assert_eq!(rig.int("x.saia.rindp"), 13_500 - zero);
}

#[test]
fn a_latch_or_an_index_from_before_the_command_does_not_count() {
    let mut bench = Bench::new();
    let mut saia = bench.moving_state();
    bench.run(&mut saia, "fsetip");
    bench.index = Some(Position::whole(9));
    saia.step(&bench.view());
    assert!(saia.armed.is_some(), "it came before t_k");
    bench.index = None;
    for rising in [true, false] {
        let (object, position) = (Object::Axis(X), Position::whole(9));
        bench.latches = vec![LatchView { object, rising, age_ns: 0, captured: None, position }];
        bench.step(&mut saia);
        assert!(saia.armed.is_some());
    }
    bench.index = Some(Position::whole(9));
    bench.step(&mut saia);
    assert_eq!((saia.armed, saia.index, saia.flags.index), (None, 9, true));
}

/// Proves: SAIA-CMD-29, SAIA-DET-13
#[test]
fn a_new_zero_moves_nothing_and_the_running_move_ends_where_it_would() {
    let mut rig = Rig::moving();
    let place = rig.int("x.actual.position");
    rig.does(&[("destp", 300.0)], "fsetzp fldda");
    let zero = rig.int("x.actual.position");
    assert!(zero >= place && rig.int("x.saia.position") == 0);
    assert!((rig.real("x.command.velocity") - 50_000.0).abs() < 0.03);
    rig.run_until("x.saia.ondest", 1);
    rig.run(2);
    assert_eq!(rig.int("x.command.position"), 100_000);
    assert_eq!(rig.int("x.saia.position"), 100_000 - zero);
    // The buffered destination counts from the new zero.
    rig.does(&[], "fstart");
    rig.run_until("x.saia.ondest", 1);
    rig.run(2);
    assert_eq!((rig.int("x.saia.position"), rig.int("x.command.position")), (300, zero + 300));
}

/// Proves: SAIA-CMD-02, SAIA-FSM-15, SAIA-STA-04, SAIA-STA-07, SAIA-SIG-05, SAIA-EXT-01, SAIA-EXT-07, SAIA-PRF-05
#[test]
fn a_position_error_beyond_its_limit_sets_the_flag_and_motion_goes_on() {
    let mut rig = Rig::moving();
    rig.does(&[("poser", 500.0), FLAG_ONLY], "fsetpe");
    assert_eq!(rig.signals() >> 9 & 1, 0);
    for (slip, expected) in [(500, 0), (-500, 0), (501, 1)] {
        rig.plant.drive(0).unwrap().jump(slip);
        rig.run(1);
        assert_eq!(rig.int("x.following_error"), -slip);
        rig.run(1);
        assert_eq!((rig.int("x.saia.excper"), rig.saia_state()), (expected, "POS"));
    }
    // Latched until the reset.
    rig.run(10);
    assert_eq!(rig.int("x.saia.excper"), 1);
    rig.does(&[("stafrr", 0.0)], "fressf");
    rig.run(1);
    assert_eq!(rig.int("x.saia.excper"), 0);
    rig.run_until("x.saia.ondest", 1);
    assert_eq!(rig.int("x.command.position"), 100_000);
}

/// Proves: SAIA-FSM-14, SAIA-STA-07, SAIA-MCW-01, SAIA-ERR-06
#[test]
fn with_the_other_reaction_the_regulator_goes_off_and_a_start_brings_it_back() {
    for mut rig in [Rig::moving(), Rig::holding()] {
        rig.does(&[("poser", 500.0), FLAG_AND_OFF], "fsetpe");
        assert_eq!(rig.signals() >> 9 & 1, 1);
        rig.plant.drive(0).unwrap().jump(501);
        rig.run(2);
        assert_eq!((rig.saia_state(), rig.int("x.enabled"), rig.int("x.error")), ("OFF", 0, 0));
        assert_eq!((rig.int("x.saia.excper"), rig.int("x.saia.ondest"), rig.int("x.saia.output")), (1, 1, 0));
        rig.does(&[], "fstart");
        rig.run_until("x.saia.ondest", 1);
        assert_eq!(rig.int("x.command.position"), rig.int("x.saia.destination"));
    }
    // While the drive is off there is no supervision.
    let mut rig = Rig::ready(&[("poser", 5.0), FLAG_AND_OFF]);
    rig.plant.drive(0).unwrap().jump(1000);
    rig.run(3);
    assert_eq!(rig.int("x.saia.excper"), 0);
}

/// PosEr and max_following_error are both 500 counts: 500 is allowed, 501 is an error of the axis and of the module in
/// the same cycle, for any reaction of the axis, and a request to the module in that cycle does not clear it.
///
/// Proves: SAIA-STA-04, SAIA-FSM-15
#[test]
fn a_position_error_that_is_an_error_of_the_axis_sets_the_flag_in_its_cycle() {
    for reaction in 0..=5 {
        for (begin, mode) in [
            (Rig::moving as fn() -> Rig, FLAG_ONLY),
            (Rig::moving, FLAG_AND_OFF),
            (Rig::holding, FLAG_ONLY),
            (Rig::holding, FLAG_AND_OFF),
        ] {
            let mut rig = begin();
            rig.parameter("error_reaction", Value::Int(reaction));
            rig.parameter("max_following_error", Value::Int(500));
            rig.does(&[("poser", 500.0), mode], "fsetpe");
            rig.plant.drive(0).unwrap().jump(-500);
            rig.run(1);
            assert_eq!((rig.int("x.following_error"), rig.int("x.saia.excper"), rig.int("x.error")), (500, 0, 0));
            rig.run(1);
            rig.plant.drive(0).unwrap().jump(-501);
            rig.does(&[("stafrr", 0.0)], "fressf");
            let text = format!("error_reaction {reaction}, {mode:?}");
            let error = i64::from(Code::FOLLOWING_ERROR.0);
            assert_eq!((rig.int("x.error"), rig.int("x.saia.excper")), (error, 1), "{text}");
            // Only once: the controller is off.
            if reaction != 5 {
                rig.does(&[("stafrr", 0.0)], "fressf");
                rig.run(200);
                assert_eq!(rig.int("x.saia.excper"), 0, "{text}");
            }
        }
    }
}

/// A motion of a goal that took over the axis does not belong to the module, and neither does its error.
#[test]
fn a_position_error_of_a_goal_sets_no_flag() {
    let mut rig = Rig::holding();
    rig.parameter("max_following_error", Value::Int(500));
    rig.does(&[("poser", 500.0), FLAG_ONLY], "fsetpe");
    let goal = Move { mode: MoveMode::Relative, ..to(X, 10_000) };
    rig.ask([Action::Move(goal)]).unwrap();
    rig.run(5);
    rig.plant.drive(0).unwrap().jump(-501);
    rig.run(1);
    assert_eq!(rig.int("x.error"), i64::from(Code::FOLLOWING_ERROR.0));
    assert_eq!(rig.int("x.saia.excper"), 0);
}

/// The reaction in each state with the controller on.
#[test]
fn the_position_error_is_supervised_in_each_state_with_the_regulator_on() {
    use super::super::Phase::{Hold, Off, Position, Ramp, Velocity};
    for phase in [Position, Velocity, Ramp, Hold] {
        let mut bench = Bench::new();
        bench.parameters.vocabularies.saia.mcw = 0x1A;
        let mut saia = bench.moving_state();
        (saia.phase, bench.rests) = (phase, phase == Hold);
        bench.following_error = -30_000;
        assert_eq!((bench.step(&mut saia), saia.phase), (None, phase), "at the limit");
        bench.following_error = -30_001;
        assert_eq!(bench.step(&mut saia), Some(Order::SwitchOff));
        assert_eq!((saia.phase, saia.flags.error, saia.stop_latch), (Off, true, false));
        bench.on = false;
        assert_eq!(bench.step(&mut saia), None);
    }
}

/// Beyond 2^30 - 1 in velocity mode the position continues at -2^30, and so does the motion.
///
/// Proves: SAIA-PRF-07, SAIA-STA-03
#[test]
fn the_position_wraps_in_velocity_mode_and_sets_its_flag() {
    for (mode, edge, beyond) in
        [(0x1C1B, 1_073_741_823_i64, -1_073_741_824_i64), (0xC1B, -1_073_741_824, 1_073_741_823)]
    {
        let mut bench = Bench::new();
        let mut saia = bench.moving_state();
        bench.parameters.vocabularies.saia.mcw = mode;
        bench.run(&mut saia, "fselom fstart");
        bench.actual = edge;
        bench.step(&mut saia);
        assert_eq!((saia.position(&bench.view()), saia.flags.wrapped), (edge, false));
        bench.actual += edge.signum();
        assert_eq!(bench.step(&mut saia), None, "motion goes on");
        assert_eq!((saia.position(&bench.view()), saia.flags.wrapped), (beyond, true));
        // The wrap does not pass a break position.
        bench.parameters.vocabularies.saia.brkp = 0;
        saia.breaks = None;
        assert!(saia.is_sound());
    }
    // In position mode only an external force can move it there, and that sets no flag.
    let mut bench = Bench::new();
    let mut saia = bench.moving_state();
    bench.actual = 5 * (1 << 31) + 17;
    bench.step(&mut saia);
    assert_eq!((saia.position(&bench.view()), saia.flags.wrapped), (17, false));
}

#[test]
fn a_wrap_passes_no_break_position() {
    let mut bench = Bench::new();
    bench.parameters.vocabularies.saia.mcw = 0x1C1B;
    bench.actual = 1_073_741_800;
    let mut saia = super::super::Saia::default();
    bench.run(&mut saia, "axinit");
    saia.zero = 0;
    bench.parameters.vocabularies.saia.brkp = 5000;
    bench.run(&mut saia, "fselom fldbpa fstart");
    bench.actual += 100;
    bench.step(&mut saia);
    assert!(saia.flags.wrapped && !saia.flags.passed && saia.breaks.is_some());
    bench.actual += (1 << 30) + 4900;
    bench.step(&mut saia);
    assert!(!saia.flags.passed);
    bench.actual += 100;
    bench.step(&mut saia);
    assert!(saia.flags.passed);
}

/// Software limits apply; a jog towards a limit is a motion without end, which the limit stops like any motion.
#[test]
fn software_limits_hold_for_starts_and_jogs() {
    let mut rig = Rig::ready(FAST);
    rig.parameter("max_position", Value::Int(20_000));
    rig.parameter("min_position", Value::Int(-20_000));
    let before = rig.picture();
    rig.refuses(&[("destp", 20_001.0)], "fldda fstart", "exceeds max_position 20 mm");
    rig.refuses(&[("destp", -20_001.0)], "fldda fstart", "is below min_position -20 mm");
    assert_eq!(rig.picture(), before);
    rig.does(&[("destp", 20_000.0)], "fldda fstart");
    rig.run_until("x.saia.ondest", 1);
    rig.does(&[], "fbackw");
    rig.run_until("x.saia.ondest", 1);
    rig.run(100);
    assert_eq!((rig.int("x.command.position"), rig.saia_state()), (-20_000, "HOLD"));
    assert_eq!(crate::state::AXIS_STATES[rig.int("x.state") as usize], "ERROR_STOP");
    rig.refuses(&[], "fforw", "reset_errors first");
}

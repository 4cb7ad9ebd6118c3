//! The open-loop axis: state table, boundaries, position reached, interface bits.

use super::bench::{Bench, MM, again, reset, start, to};
use crate::code::Code;
use crate::vocabulary::Order;
use crate::vocabulary::wf::{Jog, Mode, Request, WfSignal};

/// Moving to 500 mm with 80.
fn running() -> Bench {
    let mut bench = Bench::new();
    bench.start(Mode::Mdi, &[to(500, 80.0)]);
    bench
}

/// Switched off in its window, with its position reached.
fn done() -> Bench {
    let mut bench = running();
    bench.at(450 * MM).at(470 * MM).at(492 * MM).at(499 * MM + 1).at(500 * MM);
    assert_eq!(bench.state(), "DONE");
    bench
}

/// Proves: WF-OST-01, WF-OLC-01, WF-OLC-05, WF-OLC-11, WF-IF-06
#[test]
fn start_puts_the_programmed_speed_out_at_once() {
    let bench = running();
    assert_eq!(bench.now(), ("RUN", 80.0, 1, 1));
    assert_eq!(bench.velocity, 80_000.0);
    assert_eq!(bench.direction(), (1, 0));
    let mut back = Bench::new();
    back.start(Mode::Mdi, &[to(-500, 80.0)]);
    assert_eq!((back.velocity, back.direction()), (-80_000.0, (0, 1)));
}

/// Every boundary from both sides, and in both directions.
///
/// Proves: WF-OST-02, WF-OST-03, WF-OST-04, WF-OST-05, WF-OLC-02, WF-OLC-03, WF-OLC-07, WF-OLC-09, WF-MD-19, WF-MD-20
#[test]
fn each_step_begins_at_its_distance() {
    for sign in [1, -1] {
        let mut bench = Bench::new();
        bench.start(Mode::Mdi, &[to(sign * 500, 80.0)]);
        let mut at = |left: i64| {
            bench.at(sign * (500 * MM - left));
            bench.now()
        };
        assert_eq!(at(100 * MM + 1), ("RUN", 80.0, 1, 1));
        assert_eq!(at(100 * MM), ("STEP1", 40.0, 1, 1), "MD45 itself belongs to it (W06)");
        assert_eq!(at(35 * MM), ("STEP1", 40.0, 1, 1), "MD46 itself does not");
        assert_eq!(at(35 * MM - 1), ("STEP2", 20.0, 1, 1));
        assert_eq!(at(10 * MM), ("STEP2", 20.0, 1, 1));
        assert_eq!(at(10 * MM - 1), ("STEP3", 5.0, 1, 1));
        assert_eq!(at(MM), ("STEP3", 5.0, 1, 1));
        assert_eq!(at(MM - 1), ("SETTLE", 0.0, 0, 0));
        assert_eq!((bench.velocity, bench.real(WfSignal::Dac), bench.int(WfSignal::G)), (0.0, 0.0, 0));
    }
}

/// Proves: WF-OST-03, WF-OST-04, WF-OLC-08
#[test]
fn steps_that_are_passed_within_a_cycle_are_left_out() {
    let mut bench = running();
    assert_eq!(bench.at(495 * MM).now(), ("STEP3", 5.0, 1, 1));
    let mut bench = running();
    assert_eq!(bench.at(640 * MM).now(), ("SETTLE", 0.0, 0, 0), "past the target it is off, however far");
}

/// Proves: WF-ORA-08, WF-OLC-06
#[test]
fn start_within_a_distance_begins_with_its_step_unless_it_is_slower_itself() {
    let begin = |speed| {
        let mut bench = Bench::new();
        bench.start(Mode::Mdi, &[to(30, speed)]);
        bench
    };
    assert_eq!(begin(80.0).now(), ("STEP2", 20.0, 1, 1));
    let mut slow = begin(10.0);
    assert_eq!(slow.now(), ("RUN", 10.0, 1, 1));
    assert_eq!(slow.at(20 * MM).now(), ("RUN", 10.0, 1, 1), "10 mm before the target");
    assert_eq!(slow.at(20 * MM + 1).now(), ("STEP3", 5.0, 1, 1));
    let mut near = Bench::new();
    near.actual = 30 * MM - 400;
    near.start(Mode::Mdi, &[to(30, 80.0)]);
    assert_eq!(near.now(), ("DONE", 0.0, 0, 0), "within MD48, and within the window");
}

/// Proves: WF-OST-06, WF-PEH-03, WF-IF-11
#[test]
fn inside_the_window_the_position_is_reached() {
    let mut bench = running();
    bench.at(499 * MM + 1);
    assert_eq!((bench.state(), bench.int(WfSignal::Peh)), ("SETTLE", 0));
    bench.at(499 * MM + 499);
    assert_eq!((bench.state(), bench.int(WfSignal::Peh)), ("SETTLE", 0));
    bench.at(499 * MM + 500);
    assert_eq!((bench.state(), bench.int(WfSignal::Peh)), ("DONE", 1));
    bench.at(500 * MM + 500);
    assert_eq!((bench.state(), bench.int(WfSignal::Peh)), ("DONE", 1));
}

/// MD30 is 100 ms; the switch-off is in cycle 101.
///
/// Proves: WF-OST-07, WF-PEH-01, WF-PEH-02, WF-MON-05, WF-MD-15
#[test]
fn outside_the_window_when_md30_has_elapsed_is_alarm_22() {
    let mut bench = running();
    bench.at(499 * MM + 1).wait(99);
    assert_eq!((bench.state(), bench.int(WfSignal::Alarm)), ("SETTLE", 0));
    bench.wait(1);
    assert_eq!((bench.state(), bench.int(WfSignal::Alarm), bench.int(WfSignal::Enable)), ("ALARM", 22, 0));
    let [Order::Fail { code: Code::WF_POSITION_NOT_REACHED, .. }] = bench.orders[..] else {
        panic!("{:?}", bench.orders)
    };
    let mut late = running();
    late.at(499 * MM + 1).wait(99).at(500 * MM);
    assert_eq!(late.state(), "DONE", "inside in the last moment is in time");
}

/// Proves: WF-OST-08, WF-PEH-03
#[test]
fn leaving_the_window_without_a_new_start_is_alarm_22() {
    let mut bench = done();
    bench.wait(500).at(500 * MM + 501);
    assert_eq!((bench.state(), bench.int(WfSignal::Alarm), bench.int(WfSignal::Peh)), ("ALARM", 22, 0));
    let mut other = done();
    other.give(&start(Mode::Mdi, &[to(600, 80.0)])).unwrap();
    assert_eq!(other.at(501 * MM).now(), ("STEP1", 40.0, 1, 1), "a new START may leave it");
}

/// Proves: WF-PEH-01
#[test]
fn the_time_may_begin_with_start() {
    let mut bench = Bench::new();
    bench.parameters.vocabularies.wf.peh_from_start = 1;
    bench.start(Mode::Mdi, &[to(500, 80.0)]);
    bench.wait(99);
    assert_eq!(bench.now(), ("RUN", 80.0, 1, 1));
    bench.wait(1);
    assert_eq!((bench.now(), bench.int(WfSignal::Alarm)), (("ALARM", 0.0, 0, 0), 22));
}

/// Proves: WF-OST-10, WF-MON-06, WF-IF-10
#[test]
fn reset_disable_and_takeover_end_motion() {
    let mut bench = running();
    bench.give(&reset()).unwrap();
    assert_eq!(bench.now(), ("IDLE", 0.0, 0, 0));

    let mut bench = running();
    bench.give(&Request { enable: Some(false), ..Request::default() }).unwrap();
    assert_eq!(bench.now(), ("IDLE", 0.0, 0, 0));
    assert_eq!(bench.give(&again()).unwrap_err().code, Code::WF_NO_REQUEST);
    bench.give(&Request { enable: Some(true), ..Request::default() }).unwrap();
    bench.give(&again()).unwrap();
    assert_eq!(bench.state(), "RUN");

    for lose in [|bench: &mut Bench| bench.owns = false, |bench: &mut Bench| bench.on = false] {
        let mut bench = running();
        lose(&mut bench);
        bench.velocity = 0.0;
        bench.wait(1);
        assert_eq!((bench.now(), bench.orders.len()), (("IDLE", 0.0, 0, 0), 0), "it does not fight");
    }
}

/// Proves: WF-MON-06, WF-IF-03
#[test]
fn reset_acknowledges_the_alarm_and_so_does_reset_errors() {
    let mut bench = done();
    bench.at(510 * MM);
    assert_eq!(bench.give(&again()).unwrap_err().code, Code::WF_ALARM_WAITS);
    bench.give(&reset()).unwrap();
    assert_eq!((bench.state(), bench.int(WfSignal::Alarm), bench.orders.last()), ("IDLE", 0, Some(&Order::Reset)));
    bench.give(&again()).unwrap();
    assert_eq!(bench.state(), "STEP2", "10 mm before it");

    let mut bench = done();
    bench.at(510 * MM).wait(3);
    bench.in_error = false;
    bench.wf.take_reset();
    bench.wait(1);
    assert_eq!((bench.state(), bench.int(WfSignal::Alarm)), ("IDLE", 0));
}

/// Proves: WF-OLC-10
#[test]
fn after_switch_off_f_and_b_show_direction_to_target() {
    let mut bench = running();
    bench.at(499 * MM + 200);
    assert_eq!((bench.state(), bench.direction()), ("SETTLE", (1, 0)));
    bench.at(500 * MM);
    assert_eq!(bench.direction(), (0, 0));
    bench.at(500 * MM + 300);
    assert_eq!((bench.state(), bench.direction()), ("DONE", (0, 1)), "it ran too far");
    assert_eq!(bench.int(WfSignal::FollowingError), -300);
}

/// Three module cycles of 4 ms are 12 ms for any cycle time of the axis.
///
/// Proves: WF-ORA-16, WF-IF-07, WF-IF-08, WF-CAP-07, WF-DAC-01, WF-DAC-02
#[test]
fn the_speed_value_may_be_read_12_ms_after_start() {
    for (cycle_ns, cycles) in [(1_000_000, 12), (4_000_000, 3), (125_000, 96), (5_000_000, 3)] {
        let mut bench = Bench::new();
        bench.cycle_ns = cycle_ns;
        bench.wait(50);
        assert_eq!((bench.real(WfSignal::Dac), bench.int(WfSignal::Q)), (0.0, 0));
        bench.start(Mode::Mdi, &[to(500, 45.0)]);
        assert_eq!((bench.int(WfSignal::Q), bench.int(WfSignal::Enable), bench.int(WfSignal::G)), (1, 1, 0));
        bench.wait(cycles - 1);
        assert_eq!(bench.int(WfSignal::G), 0);
        bench.wait(1);
        assert_eq!((bench.int(WfSignal::G), bench.real(WfSignal::Speed)), (1, 45.0));
        assert_eq!(bench.real(WfSignal::Dac), 4.5);
        bench.at(450 * MM);
        assert_eq!((bench.int(WfSignal::G), bench.real(WfSignal::Speed)), (1, 40.0), "WF-IF-09: G stays");
        bench.at(500 * MM);
        assert_eq!((bench.int(WfSignal::G), bench.real(WfSignal::Dac)), (0, 0.0));
    }
}

/// Each of the 99 voltages is the number that a scenario contains for it.
///
/// Proves: WF-DAC-02
#[test]
fn the_voltage_is_the_speed_value_in_tenths_with_the_sign_of_the_direction() {
    for speed in 1..=99_i64 {
        for (sign, position) in [("", 500), ("-", -500)] {
            let mut bench = Bench::new();
            bench.start(Mode::Mdi, &[to(position, speed as f64)]);
            let written: f64 = format!("{sign}{}.{}", speed / 10, speed % 10).parse().unwrap();
            assert_eq!(bench.real(WfSignal::Dac), written);
        }
    }
}

/// Proves: WF-IF-09
#[test]
fn a_speed_that_changes_does_not_begin_the_12_ms_again() {
    let mut bench = running();
    bench.wait(5).at(450 * MM).wait(5);
    assert_eq!(bench.int(WfSignal::G), 0);
    bench.wait(1);
    assert_eq!((bench.int(WfSignal::G), bench.real(WfSignal::Speed)), (1, 40.0));
}

fn jog(jog: Jog, fixed_speed: u8) -> Request {
    Request { mode: Some(Mode::Jog), jog: Some(jog), fixed_speed: Some(fixed_speed), ..Request::default() }
}

/// Proves: WF-SET-01, WF-SET-02, WF-IF-05
#[test]
fn setup_runs_at_a_fixed_speed_as_long_as_the_input_is_set() {
    let mut bench = Bench::new();
    bench.give(&jog(Jog::Plus, 2)).unwrap();
    assert_eq!(bench.now(), ("RUN", 50.0, 1, 1));
    bench.at(900 * MM);
    assert_eq!((bench.now(), bench.int(WfSignal::FollowingError)), (("RUN", 50.0, 1, 1), 0));
    bench.give(&Request { fixed_speed: Some(1), ..Request::default() }).unwrap();
    assert_eq!((bench.now(), bench.direction()), (("RUN", 10.0, 1, 1), (1, 0)));
    bench.give(&jog(Jog::Minus, 3)).unwrap();
    assert_eq!((bench.now(), bench.direction()), (("RUN", 80.0, 1, 1), (0, 1)));
    bench.give(&jog(Jog::None, 3)).unwrap();
    assert_eq!((bench.now(), bench.direction()), (("IDLE", 0.0, 0, 0), (0, 0)));
    bench.at(0).wait(1000);
    assert_eq!(bench.state(), "IDLE", "nobody asks for a position");
    bench.give(&jog(Jog::Both, 3)).unwrap();
    assert_eq!(bench.now(), ("IDLE", 0.0, 0, 0));
}

/// With 50 the first slower step is MD42: from max_position - 100 mm on. With 10 it is MD44: from 10 mm before it on.
///
/// Proves: WF-LIM-02, WF-LIM-03
#[test]
fn setup_slows_down_before_a_software_limit_and_ends_there() {
    for (fixed_speed, free, first) in [(2, 100 * MM + 1, ("STEP1", 40.0)), (1, 10 * MM, ("STEP3", 5.0))] {
        for (sign, input) in [(1, Jog::Plus), (-1, Jog::Minus)] {
            let mut bench = Bench::new();
            (bench.parameters.min_position, bench.parameters.max_position) = (Some(-800 * MM), Some(800 * MM));
            bench.give(&jog(input, fixed_speed)).unwrap();
            bench.at(sign * (800 * MM - free));
            assert_eq!(bench.state(), "RUN");
            bench.at(sign * (800 * MM - free + 1));
            let (state, speed, ..) = bench.now();
            assert_eq!((state, speed), first);
            assert_eq!(bench.int(WfSignal::FollowingError), sign * (free - 1), "the limit is the set position");
            bench.at(sign * (800 * MM - MM + 1));
            assert_eq!(bench.now(), ("IDLE", 0.0, 0, 0));
            assert_eq!(bench.give(&jog(input, 1)).unwrap_err().code, Code::LIMIT_VIOLATION);
        }
    }
}

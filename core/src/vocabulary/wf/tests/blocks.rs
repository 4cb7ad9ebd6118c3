//! Modes, ends of blocks, change on the fly, distance to go, turns.

use super::bench::{Bench, MM, again, by, load, start, to};
use crate::modulo::Modulo;
use crate::position::{Length, Position};
use crate::vocabulary::wf::{Block, Jog, Mode, Request, Speed, WfSignal};

fn going(blocks: &[Block]) -> Bench {
    let mut bench = Bench::new();
    bench.start(Mode::Continuous, blocks);
    bench
}

/// Returns block, state, speed value.
fn block(bench: &Bench) -> (i64, &'static str, f64) {
    let (state, speed, ..) = bench.now();
    (bench.int(WfSignal::Block), state, speed)
}

/// Proves: WF-ORA-10, WF-BCF-01, WF-BCF-02, WF-BCF-03, WF-OST-09, WF-OLC-04
#[test]
fn a_block_is_adopted_at_the_first_deceleration_point_unless_the_step_is_not_slower() {
    for (second, speed) in [(60.0, 60.0), (90.0, 90.0), (80.0, 80.0)] {
        let mut bench = going(&[to(500, 80.0), to(2000, second)]);
        assert_eq!(block(bench.at(400 * MM - 1)), (1, "RUN", 80.0));
        assert_eq!(block(bench.at(400 * MM)), (2, "RUN", speed));
        assert_eq!(bench.int(WfSignal::FollowingError), 1600 * MM);
    }
}

/// 30 is slower than 80: step 1 (40) is applied; step 2 (20) is slower than 30, and there 30 is adopted.
///
/// Proves: WF-BCF-02, WF-BCF-04
#[test]
fn a_slower_block_is_adopted_where_the_next_step_would_be_slower_still() {
    let mut bench = going(&[to(500, 80.0), to(2000, 30.0)]);
    bench.at(399 * MM);
    assert_eq!(bench.int(WfSignal::DistanceToGo), 101 * MM);
    assert_eq!(block(bench.at(400 * MM)), (1, "STEP1", 40.0));
    assert_eq!(bench.int(WfSignal::FollowingError), 100 * MM, "to the end of the old block");
    assert_eq!(bench.int(WfSignal::DistanceToGo), 1600 * MM, "to that of the new one");
    assert_eq!(block(bench.at(465 * MM)), (1, "STEP1", 40.0));
    assert_eq!(block(bench.at(465 * MM + 1)), (2, "RUN", 30.0));
    assert_eq!(bench.int(WfSignal::FollowingError), 1535 * MM - 1);
}

/// A step of the same speed is not slower: 20 waits for step 3.
///
/// Proves: WF-BCF-02, WF-BCF-05
#[test]
fn the_switch_off_is_the_last_place_where_a_block_is_adopted() {
    let mut bench = going(&[to(500, 80.0), to(2000, 20.0)]);
    assert_eq!(block(bench.at(470 * MM)), (1, "STEP2", 20.0));
    assert_eq!(block(bench.at(491 * MM)), (2, "RUN", 20.0));
    let mut bench = going(&[to(500, 80.0), to(2000, 3.0)]);
    assert_eq!(block(bench.at(490 * MM + 1)), (1, "STEP3", 5.0));
    assert_eq!(block(bench.at(499 * MM)), (1, "STEP3", 5.0));
    assert_eq!(block(bench.at(499 * MM + 1)), (2, "RUN", 3.0), "never off between");
}

#[test]
fn a_short_block_that_is_adopted_begins_with_the_step_that_it_reaches() {
    let mut bench = going(&[to(500, 80.0), to(520, 90.0), to(2000, 70.0)]);
    assert_eq!(block(bench.at(400 * MM)), (2, "RUN", 90.0), "120 mm are more than MD45");
    assert_eq!(block(bench.at(420 * MM)), (3, "RUN", 70.0));
    let mut bench = going(&[to(500, 5.0), to(520, 90.0), to(2000, 70.0)]);
    assert_eq!(block(bench.at(499 * MM + 1)), (2, "STEP2", 20.0), "21 mm are within MD46");
    assert_eq!(block(bench.at(509 * MM)), (2, "STEP2", 20.0));
    assert_eq!(block(bench.at(510 * MM + 1)), (3, "RUN", 70.0));
}

/// W09: the old block ends with its position reached, then the new one begins.
#[test]
fn a_block_that_turns_back_waits_for_the_position() {
    let mut bench = going(&[to(500, 80.0), to(100, 60.0)]);
    assert_eq!(block(bench.at(400 * MM)), (1, "STEP1", 40.0));
    assert_eq!(bench.int(WfSignal::DistanceToGo), 100 * MM, "it is not considered");
    assert_eq!(block(bench.at(499 * MM + 300)), (1, "SETTLE", 0.0));
    assert_eq!(block(bench.at(500 * MM + 20)), (1, "DONE", 0.0));
    assert_eq!(block(bench.wait(1)), (2, "RUN", 60.0));
    assert_eq!((bench.direction(), bench.int(WfSignal::FollowingError)), ((0, 1), -400 * MM - 20));
    bench.wait(11);
    assert_eq!(bench.int(WfSignal::G), 0);
    bench.wait(1);
    assert_eq!(bench.int(WfSignal::G), 1, "12 ms after its own start");
}

fn reach(bench: &mut Bench, position: i64) -> (i64, &'static str) {
    bench.at(position * MM);
    let (block, state, _) = block(bench);
    (block, state)
}

/// Proves: WF-MOD-01
#[test]
fn each_mode_runs_its_blocks() {
    let program = [to(200, 80.0), to(400, 80.0), to(600, 80.0)];

    let mut single = Bench::new();
    single.give(&Request { block: Some(2), ..start(Mode::Single, &program) }).unwrap();
    assert_eq!((reach(&mut single, 400), reach(&mut single, 400)), ((2, "SETTLE"), (2, "DONE")));
    single.give(&again()).unwrap();
    assert_eq!(block(&single).0, 2, "the selected block again");

    let mut automatic = Bench::new();
    automatic.start(Mode::Automatic, &program);
    for (number, end) in [(1, 200), (2, 400), (3, 600)] {
        assert_eq!(reach(&mut automatic, end - 101), (number, "RUN"));
        reach(&mut automatic, end);
        assert_eq!(reach(&mut automatic, end), (number, "DONE"));
        automatic.wait(10);
        assert_eq!(automatic.state(), "DONE", "it waits for START");
        automatic.give(&again()).unwrap();
    }
    assert_eq!(block(&automatic).0, 1, "then from the first one on");

    let mut all = Bench::new();
    all.start(Mode::Continuous, &program);
    assert_eq!(reach(&mut all, 150), (2, "RUN"));
    assert_eq!(reach(&mut all, 350), (3, "RUN"));
    reach(&mut all, 600);
    assert_eq!(reach(&mut all, 600), (3, "DONE"));

    let mut manual = Bench::new();
    manual.start(Mode::Mdi, &[by(200, 80.0)]);
    reach(&mut manual, 200);
    assert_eq!(reach(&mut manual, 200), (1, "DONE"));
}

/// Distances count from the previous end, not from the actual position of the axis.
#[test]
fn repeated_distances_do_not_accumulate_position_error() {
    let mut bench = Bench::new();
    bench.start(Mode::Mdi, &[by(200, 80.0)]);
    for round in 1..=3 {
        bench.at(200 * MM * round + 300).at(200 * MM * round + 300);
        assert_eq!((bench.state(), bench.int(WfSignal::FollowingError)), ("DONE", -300));
        bench.give(&again()).unwrap();
        assert_eq!(bench.int(WfSignal::FollowingError), 200 * MM - 300);
    }
}

/// P 100 -> 250, NV 10 -> 20, WK 5 -> 5, and with the pending change after G91.
///
/// Proves: WF-ORA-15, WF-CRD-02, WF-CRD-03
#[test]
fn offsets_count_with_absolute_blocks_only() {
    let at_100 = || {
        let mut bench = Bench::new();
        (bench.parameters.vocabularies.wf.zero_offset, bench.parameters.vocabularies.wf.tool_length) =
            (10 * MM, 5 * MM);
        bench.start(Mode::Mdi, &[to(100, 80.0)]);
        bench.at(115 * MM).at(115 * MM);
        assert_eq!(bench.state(), "DONE");
        bench.parameters.vocabularies.wf.zero_offset = 20 * MM;
        bench.wait(100);
        assert_eq!(bench.state(), "DONE", "an offset alone moves nothing");
        bench
    };
    let mut absolute = at_100();
    absolute.give(&start(Mode::Mdi, &[to(250, 80.0)])).unwrap();
    assert_eq!(absolute.int(WfSignal::DistanceToGo), 160 * MM);
    let mut incremental = at_100();
    incremental.give(&start(Mode::Mdi, &[by(150, 80.0)])).unwrap();
    assert_eq!(incremental.int(WfSignal::DistanceToGo), 150 * MM);
    incremental.at(265 * MM).at(265 * MM);
    incremental.give(&start(Mode::Mdi, &[to(350, 80.0)])).unwrap();
    assert_eq!(incremental.int(WfSignal::DistanceToGo), 110 * MM, "100 and the change of NV that was left (W16)");
}

/// Proves: WF-CRD-01, WF-IF-11
#[test]
fn an_actual_value_that_is_preset_moves_the_zero_of_absolute_blocks() {
    let mut bench = Bench::new();
    bench.at(70 * MM);
    assert_eq!(bench.int(WfSignal::Synchronized), 0);
    let value = Some(Length::whole(1000 * MM));
    bench.give(&Request { mode: Some(Mode::ActualValue), value, ..Request::default() }).unwrap();
    assert_eq!(bench.int(WfSignal::Synchronized), 1);
    bench.start(Mode::Mdi, &[to(1200, 80.0)]);
    assert_eq!(bench.int(WfSignal::FollowingError), 200 * MM);
}

fn turntable(position: i64) -> Bench {
    let mut bench = Bench::new();
    bench.modulo = Modulo::new(200 * MM, 1);
    bench.at(position * MM);
    bench
}

/// MD18 200, at 190: the shortest distance to 10 is +20, with JOG- it is -180; +450 is three turns and ends at 40.
///
/// Proves: WF-ORA-05, WF-ROT-03, WF-ROT-04
#[test]
fn a_rotary_axis_goes_the_shortest_way_or_that_of_the_jog_inputs() {
    let way = |from: i64, jog: Jog, block: Block| {
        let mut bench = turntable(from);
        bench.give(&Request { jog: Some(jog), ..start(Mode::Mdi, &[block]) }).unwrap();
        bench.int(WfSignal::FollowingError) / MM
    };
    assert_eq!(way(190, Jog::None, to(10, 80.0)), 20);
    assert_eq!(way(190, Jog::Both, to(10, 80.0)), 20);
    assert_eq!(way(190, Jog::Plus, to(10, 80.0)), 20);
    assert_eq!(way(190, Jog::Minus, to(10, 80.0)), -180);
    assert_eq!(way(190, Jog::Minus, by(450, 80.0)), 450, "the sign is the direction");
    assert_eq!((190 + way(190, Jog::None, by(450, 80.0))) % 200, 40);
    assert_eq!((190 + way(190, Jog::None, by(450, 80.0))) / 200, 3);
    assert_eq!(way(190, Jog::None, to(90, 80.0)), 100, "half a turn: plus (W15)");
    assert_eq!(way(790, Jog::Minus, to(10, 80.0)), -180);
}

/// A turn of 333 1/3 inc: half of it is 166 2/3 inc, which is reached at 167, and still counts as half a turn.
#[test]
fn half_a_turn_of_fractional_increments_is_positive() {
    for (asked, way) in [(500, 167), (501, -166), (499, 166)] {
        let mut bench = turntable(0);
        bench.modulo = Modulo::new(1_000, 3);
        // Thirds of an increment, rounded as in the conversion of requests.
        let position = Position::from_raw(((i128::from(asked) << 33) + 3).div_euclid(6));
        let block = Block { position, speed: Speed::Value(10.0), absolute: true };
        bench.give(&start(Mode::Mdi, &[block])).unwrap();
        assert_eq!(bench.int(WfSignal::FollowingError), way, "{asked}/3");
    }
}

/// The JOG inputs end with their mode: an old input must not start the axis.
#[test]
fn jog_inputs_end_with_the_mode() {
    let mut bench = turntable(190);
    bench.give(&Request { jog: Some(Jog::Minus), ..load(Mode::Mdi, &[to(10, 80.0)]) }).unwrap();
    bench.give(&Request { mode: Some(Mode::Jog), ..Request::default() }).unwrap();
    assert_eq!(bench.wait(5).now(), ("IDLE", 0.0, 0, 0));
}

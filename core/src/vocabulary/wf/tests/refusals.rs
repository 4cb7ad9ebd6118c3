//! Refused requests, which change nothing.

use super::bench::{Bench, MAX_VELOCITY, MM, again, by, load, start, to};
use crate::code::Code;
use crate::drive::Interface;
use crate::position::{Length, Position};
use crate::vocabulary::wf::{Block, Blocks, Jog, Mode, Request, Speed};

#[track_caller]
fn refuses(bench: &mut Bench, request: &Request, code: Code) {
    let before = (bench.wf, bench.velocity);
    assert_eq!(bench.give(request).map_err(|refusal| refusal.code), Err(code));
    assert_eq!((bench.wf, bench.velocity), before);
}

fn at_speed(speed: Speed) -> Block {
    Block { speed, ..to(500, 1.0) }
}

/// Invalid numbers of blocks and speeds: no block, too many blocks, speed zero.
#[test]
fn blocks_without_end() {
    let mut bench = Bench::new();
    refuses(&mut bench, &again(), Code::WF_NO_BLOCKS);
    refuses(&mut bench, &load(Mode::Continuous, &[]), Code::WF_NO_BLOCKS);
    assert_eq!(Blocks::new(&[to(1, 1.0); 17]), None);
    refuses(&mut bench, &start(Mode::Mdi, &[to(1, 1.0), to(2, 1.0)]), Code::WF_ONE_BLOCK);
    for speed in [0.0, -1.0, 0.4, 99.5, 100.0, f64::NAN, f64::INFINITY] {
        refuses(&mut bench, &load(Mode::Single, &[to(1, 1.0), at_speed(Speed::Value(speed))]), Code::WF_BAD_SPEED);
    }
    refuses(&mut bench, &load(Mode::Mdi, &[at_speed(Speed::Velocity(0.0))]), Code::WF_BAD_SPEED);
    for velocity in [MAX_VELOCITY * 1.001, f64::INFINITY, f64::NAN] {
        refuses(&mut bench, &load(Mode::Mdi, &[at_speed(Speed::Velocity(velocity))]), Code::VELOCITY_TOO_HIGH);
    }
    bench.interface = Interface::Position;
    for speed in [0.0, 100.1] {
        refuses(&mut bench, &load(Mode::Mdi, &[at_speed(Speed::Value(speed))]), Code::WF_BAD_SPEED);
    }
    refuses(&mut bench, &load(Mode::Mdi, &[at_speed(Speed::Value(1e-12))]), Code::RATE_TOO_LOW);
    bench.give(&load(Mode::Mdi, &[at_speed(Speed::Value(100.0))])).unwrap();
}

#[test]
fn ends_that_no_axis_reaches() {
    let mut bench = Bench::new();
    (bench.parameters.min_position, bench.parameters.max_position) = (Some(-10 * MM), Some(800 * MM));
    refuses(&mut bench, &start(Mode::Mdi, &[to(801, 1.0)]), Code::ABOVE_MAX_POSITION);
    refuses(&mut bench, &start(Mode::Mdi, &[to(-11, 1.0)]), Code::BELOW_MIN_POSITION);
    let steps = [by(500, 1.0), by(200, 1.0), by(200, 1.0)];
    refuses(&mut bench, &start(Mode::Continuous, &steps), Code::ABOVE_MAX_POSITION);
    bench.give(&start(Mode::Automatic, &steps)).unwrap();
    let mut free = Bench::new();
    let far = Block { position: Position::whole(Position::LIMIT - 1), ..by(0, 1.0) };
    refuses(&mut free, &start(Mode::Continuous, &[far, far]), Code::POSITION_OUT_OF_RANGE);
}

#[test]
fn changes_in_motion_and_keys_of_other_modes() {
    let mut bench = Bench::new();
    bench.start(Mode::Single, &[to(500, 80.0)]);
    refuses(&mut bench, &again(), Code::WF_IN_MOTION);
    refuses(&mut bench, &load(Mode::Single, &[to(400, 80.0)]), Code::WF_IN_MOTION);
    refuses(&mut bench, &Request { mode: Some(Mode::Jog), ..Request::default() }, Code::WF_IN_MOTION);
    refuses(&mut bench, &Request { block: Some(1), ..Request::default() }, Code::WF_IN_MOTION);
    bench.at(499 * MM + 100);
    refuses(&mut bench, &again(), Code::WF_IN_MOTION);
    bench.at(500 * MM);
    refuses(&mut bench, &Request { block: Some(0), ..Request::default() }, Code::WF_NO_SUCH_BLOCK);
    refuses(&mut bench, &Request { block: Some(2), ..Request::default() }, Code::WF_NO_SUCH_BLOCK);
    let value = Some(Length::whole(1));
    refuses(&mut bench, &Request { value, ..Request::default() }, Code::WF_NOT_IN_THIS_MODE);
    for mode in [Mode::Jog, Mode::ActualValue] {
        refuses(
            &mut bench,
            &Request { mode: Some(mode), start: true, ..Request::default() },
            Code::WF_NOT_IN_THIS_MODE,
        );
    }
    bench.parameters.vocabularies.wf.fixed_speed_1 = 0.0;
    let jog = Request { mode: Some(Mode::Jog), jog: Some(Jog::Plus), ..Request::default() };
    refuses(&mut bench, &jog, Code::WF_BAD_SPEED);
}

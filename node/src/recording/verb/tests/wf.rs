//! Tests verb `wf`: exact texts, refusals, and the round trip of all of its keys.

use super::*;
use lineshaft_core::vocabulary::wf::{Block, Blocks, Jog, Mode, Request, Speed};
use proptest::prelude::*;
use std::sync::LazyLock;

static DESK: LazyLock<Desk> = LazyLock::new(Desk::new);

fn wf(request: Request) -> Action {
    Action::vocabulary(request)
}

fn millimetres(value: i64) -> Position {
    Position::whole(value * 1000)
}

/// Keys that are not given are not written.
#[test]
fn a_verb_is_written_in_increments_and_read_in_the_units_of_the_axis() {
    let block = |position, speed, absolute| Block { position, speed, absolute };
    let blocks = [
        block(millimetres(500), Speed::Value(80.0), true),
        block(Position::from_f64(-0.25), Speed::Velocity(100_000.0), false),
    ];
    let request =
        Request { mode: Some(Mode::Continuous), blocks: Blocks::new(&blocks), start: true, ..Request::default() };
    DESK.is(
        &wf(request.clone()),
        r#"{"wf":{"axis":"x","mode":"continuous","blocks":[{"position":"500000 inc","velocity":80.0},{"position":"-0.25 inc","velocity":"100000 inc/s","absolute":false}],"start":true}}"#,
    );
    let text = "wf: {axis: x, mode: continuous, start: true, blocks: [{position: 500, velocity: 80}, \
                {position: -250 nm, velocity: 100 mm/s, absolute: false}]}";
    assert_eq!(DESK.read(text), Ok(wf(request)));
    DESK.is(&wf(Request::default()), r#"{"wf":{"axis":"x"}}"#);
    let reset = Request { axis: 1, reset: true, ..Request::default() };
    DESK.is(&wf(reset), r#"{"wf":{"axis":"turret","reset":true}}"#);
    let rest = Request {
        jog: Some(Jog::Both),
        block: Some(3),
        cam: Some(true),
        fixed_speed: Some(2),
        enable: Some(false),
        value: Some(Length::whole(-7)),
        ..Request::default()
    };
    DESK.is(
        &wf(rest),
        r#"{"wf":{"axis":"x","block":3,"jog":"both","cam":true,"fixed_speed":2,"enable":false,"value":"-7 inc"}}"#,
    );
    let travel = Request { mode: Some(Mode::Reference), jog: Some(Jog::Plus), ..Request::default() };
    DESK.is(&wf(travel), r#"{"wf":{"axis":"x","mode":"reference","jog":"plus"}}"#);
    let single = Request { mode: Some(Mode::Automatic), ..Request::default() };
    assert_eq!(DESK.read("wf: {axis: x, mode: automatic_single}"), Ok(wf(single)), "another name");
}

#[test]
fn what_is_no_verb_is_refused_with_a_sentence() {
    let refuses = |arguments: &str, part: &str| {
        let sentence = DESK.read(&format!("wf: {arguments}")).unwrap_err();
        assert!(sentence.contains(part), "{arguments}: {sentence}");
    };
    refuses("{mode: mdi}", "missing key `axis` in wf");
    refuses("{axis: q}", "no axis is called `q`");
    refuses("{axis: q, blocks: [{position: 1, velocity: 1}]}", "no axis is called `q`");
    refuses("{axis: x, mode: fast}", "mode is `fast`; one of mdi, single");
    refuses("{axis: x, blocks: []}", "number of blocks is 0; 1 to 16 blocks are allowed");
    refuses("{axis: x, blocks: [{velocity: 1}]}", "missing key `position`");
    refuses("{axis: x, blocks: [{position: 1}]}", "missing key `velocity`");
    refuses("{axis: x, blocks: [{position: 1, velocity: 1, speed: 1}]}", "unknown key `speed`");
    refuses("{axis: x, blocks: [{position: 1 deg, velocity: 1}]}", "`1 deg` is an angle");
    refuses("{axis: x, blocks: [{position: 1, velocity: 1 mm}]}", "`1 mm` is a length");
    refuses("{axis: x, blocks: {position: 1}}", "a list is expected");
    refuses("{axis: x, fixed_speed: 4}", "fixed_speed is 4; 1..3 is allowed");
    refuses("{axis: x, jog: left}", "jog is `left`");
    refuses("{axis: x, reset: true, start: true}", "reset stands with other keys");
    refuses("{axis: x, start: 1}", "true or false is allowed");
    let many = vec!["{position: 1, velocity: 1}"; 17].join(", ");
    refuses(&format!("{{axis: x, blocks: [{many}]}}"), "number of blocks is 17; 1 to 16 blocks are allowed");
}

fn block() -> impl Strategy<Value = Block> {
    let position = (-(1_i64 << 40)..1 << 40, 0..u32::MAX);
    let position = position.prop_map(|(whole, rest)| Position::from_raw((i128::from(whole) << 32) + i128::from(rest)));
    let speed = prop_oneof![
        (0..=100_i32).prop_map(|value| Speed::Value(value.into())),
        (0.0..1e6_f64).prop_map(Speed::Value),
        (1e-6..1e9_f64).prop_map(Speed::Velocity),
    ];
    (position, speed, any::<bool>()).prop_map(|(position, speed, absolute)| Block { position, speed, absolute })
}

fn request() -> impl Strategy<Value = Request> {
    use prop::option::of;
    let modes = vec![Mode::Mdi, Mode::Single, Mode::Automatic, Mode::Continuous, Mode::Jog, Mode::ActualValue];
    let jogs = vec![Jog::None, Jog::Plus, Jog::Minus, Jog::Both];
    let blocks = prop::collection::vec(block(), 1..=16).prop_map(|blocks| Blocks::new(&blocks).expect("they fit"));
    let inputs = (of(prop::sample::select(jogs)), of(any::<bool>()), of(1..=3_u8), of(any::<bool>()));
    let parts = (0..3_u16, of(prop::sample::select(modes)), of(blocks), of(any::<u8>()), any::<bool>(), inputs);
    (parts, of(any::<i32>())).prop_map(
        |((axis, mode, blocks, block, start, (jog, cam, fixed_speed, enable)), value)| {
            let value = value.map(|value| Length::whole(value.into()));
            Request { axis, mode, blocks, block, start, jog, cam, fixed_speed, enable, reset: false, value }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn every_verb_round_trips(request in request()) {
        let action = wf(request);
        let json = DESK.write(&action);
        let read = DESK.read(&json);
        prop_assert_eq!(read.as_ref(), Ok(&action), "{}", json);
    }
}

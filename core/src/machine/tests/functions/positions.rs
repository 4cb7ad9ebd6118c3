//! A positioning that moves an axis, and the zero pulse of its drive.

use super::*;
use crate::sim::{Fixtures, Index};

/// Bits of e1 and e2.
pub(super) const E1: u64 = 1;
pub(super) const E2: u64 = 2;

/// Moves x by 33.333 inc per cycle, with ramps of 4 and 16; A1 is the lamp, A2 a bit.
pub(super) fn indexer(values: &[(&str, i64)]) -> SlotConfig {
    let mut slot = slot("pos", 0, Type::Epos);
    slot.sink = SinkConfig::Axis(X);
    let line = |object| Some(Line { object, inverted: false });
    (slot.inputs[0], slot.inputs[1]) = (line(Object::Io(0)), line(Object::Io(3)));
    (slot.outputs[0], slot.outputs[1]) = (line(Object::Io(1)), line(Object::Memory(4)));
    let example = [
        ("sf_cycle", 2),
        ("travel", 20_000),
        ("velocity", 1_000_000),
        ("acceleration", 200_000),
        ("stop_decel", 800_000),
        ("drive_resolution", 20_000),
    ];
    for (name, value) in example.iter().chain(values) {
        slot.values[usize::from(field(Type::Epos, name))] = *value;
    }
    slot
}

pub(super) fn input(bits: u64) -> fn(&mut crate::drive::Inputs) {
    match bits {
        E1 => |inputs| inputs.digital[0] = E1,
        E2 => |inputs| inputs.digital[0] = E2,
        _ => |inputs| inputs.digital[0] = 0,
    }
}

/// Proves: AMK-EPOS-01, AMK-EPOS-02, AMK-EPOS-08, AMK-EPOS-25, AMK-EPOS-26, AMK-EPOS-38, AMK-EPOS-61, AMK-EPOS-O1, AMK-CTX-05, AMK-CTX-21
#[test]
fn an_axis_goes_by_orders_and_holds_what_reset_leaves() {
    let mut rig = Rig::of(cell(vec![indexer(&[])]));
    rig.enable();
    rig.give(Action::Move(to(X, 500)));
    rig.run(400);
    let started = rig.give(order(0, Order::Start));
    assert!(rig.was_accepted(started), "{:?}", rig.answer(started));
    assert_eq!((rig.int("pos.sink"), rig.int("lamp"), rig.int("x.reference")), (500, 1, 8));
    rig.modify_inputs = input(E1);
    rig.run(1);
    assert_eq!((rig.int("pos.sink"), rig.int("x.command.position"), rig.int("lamp")), (504, 504, 0));
    assert_eq!(rig.int("pos.remaining"), 19_996);
    rig.run(99);
    // A machine restored from here gives the same results.
    rig.mirror();
    rig.run(507);
    assert_eq!(rig.int("lamp"), 0);
    rig.run(1);
    assert_eq!((rig.int("x.command.position"), rig.int("lamp"), rig.int("pos.remaining")), (20_500, 1, 0));
    // Back, stopped in motion: from 33.333 down by 16.
    let taken = rig.give(with(0, Order::ValueNew, &[(field(Type::Epos, "travel"), -20_000)]));
    assert!(rig.was_accepted(taken), "{:?}", rig.answer(taken));
    rig.modify_inputs = input(0);
    rig.run(1);
    rig.modify_inputs = input(E1);
    rig.run(100);
    rig.modify_inputs = input(E2);
    rig.run(3);
    let here = rig.int("x.command.position");
    assert_eq!((rig.int("lamp"), rig.int("pos.remaining")), (1, 500 - here));
    rig.modify_inputs = input(E1);
    rig.run(50);
    let here = rig.int("pos.sink");
    rig.give(order(0, Order::Reset));
    assert_eq!((rig.int("pos.sink"), rig.int("lamp"), rig.int("pos.remaining"), rig.int("bit")), (here, 1, 0, 0));
    rig.run(30);
    assert_eq!((rig.int("x.command.position"), rig.state("x")), (here, "STANDSTILL"));
}

/// The drive shows the command five cycles late, 166.7 inc at full speed; its index is at 300. The position of the
/// pulse counts, not that of the command.
///
/// Proves: AMK-EPOS-04, AMK-EPOS-37, AMK-EPOS-40, AMK-EPOS-44, AMK-EPOS-45, AMK-EPOS-46, AMK-CTX-15
#[test]
fn the_zero_pulse_of_the_drive_is_the_zero_of_the_end() {
    let copied = copy("c", 1, SourceConfig::Lead(Leader::Sink(0)), SinkConfig::Memory(1));
    let geared = SlotConfig { inputs: [None; 8], ..gear("g", 2, Leader::Sink(0), Y) };
    let mut config = cell(vec![indexer(&[("ba", 6), ("travel", 100)]), copied, geared]);
    config.axes[usize::from(X)].drive = Some(Capabilities::all(5));
    let mut rig = Rig::of(config);
    let index = Some(Index { every: 20_000, at: 300 });
    rig.plant.drive(0).expect("the drive of x").install_fixtures(Fixtures { index, ..Fixtures::default() });
    rig.enable();
    let coupled = rig.give(Action::Synchronize(couple(DISC, Leader::Sink(0), 1, 1)));
    assert!(rig.was_accepted(coupled));
    rig.give_all((0..3).map(|slot| order(slot, Order::Start)).collect());
    rig.modify_inputs = input(E1);
    let mut peak = 0;
    for _ in 0..200 {
        rig.run(1);
        peak = peak.max(rig.int("x.command.position"));
        let (command, other) = (rig.int("x.command.position"), rig.int("y.command.position"));
        assert_eq!(command, other, "a new coordinate is no way");
        if rig.int("pos.remaining") != 0 {
            assert_eq!(command - rig.int("pos.sink"), 300, "the sink counts from the reference");
            assert_eq!(rig.int("d"), rig.int("pos.sink"));
        }
    }
    // The command was 166.7 to 200 beyond the pulse, and needed 122.7 more to stop.
    assert!((300 + 289..300 + 324).contains(&peak), "{peak}");
    assert_eq!((rig.int("x.command.position"), rig.int("x.actual.position")), (400, 400));
    assert_eq!((rig.int("pos.sink"), rig.int("lamp"), rig.int("disc.sync.master")), (100, 1, 100));
    rig.mirror();
    rig.run(5);
}

/// Proves: AMK-EPOS-44, AMK-EPOS-61
#[test]
fn without_a_drive_there_is_no_reference() {
    for (sink, place) in [(SinkConfig::Memory(1), 0), (SinkConfig::Axis(LINE), 0), (SinkConfig::None, 0)] {
        let slot = SlotConfig { sink, ..indexer(&[("ba", 2)]) };
        let mut rig = Rig::of(cell(vec![slot]));
        let refused = rig.give(order(place, Order::Start));
        assert_eq!(rig.answer(refused).expect_err("no zero pulse").code, Code::AMK_NO_REFERENCE);
        assert!(rig.refusal(refused).ends_with("the sink is no axis with a drive, which alone has one"));
        let started = rig.give(with(place, Order::Start, &[(field(Type::Epos, "ba"), 0)]));
        assert!(rig.was_accepted(started), "{:?}", rig.answer(started));
        rig.modify_inputs = input(E1);
        rig.run(700);
        assert_eq!(rig.int("pos.sink"), 20_000, "relative is any sink's");
    }
}

/// The end is at a multiple, repeated as long as an input is set; A2 is a bit.
///
/// Proves: AMK-EPOS-03, AMK-EPOS-13, AMK-EPOS-22, AMK-BCOM-35, AMK-BCOM-36
#[test]
fn positioning_repeats_while_its_input_is_set() {
    let mut slot = indexer(&[("ba", 16), ("travel", 1000)]);
    slot.words[0] = Some("w".into());
    let mut rig = Rig::of(cell(vec![slot]));
    rig.enable();
    rig.give(Action::set_memory(0, 512.0));
    rig.give(order(0, Order::Start));
    let refused = rig.give(with(0, Order::ValueNew, &[(field(Type::Epos, "travel"), 0)]));
    assert!(
        rig.refusal(refused)
            .ends_with("0 is no travel with ba 16: a reference is left behind, and a multiple has a length")
    );
    rig.modify_inputs = input(E1);
    rig.run(5);
    // 4, 8, 12, 16, 16.667.
    assert_eq!((rig.int("pos.sink"), rig.int("bit"), rig.int("lamp")), (56, 1, 0));
    rig.run(295);
    let from = rig.int("pos.sink");
    assert_eq!(from, 40 + 296 * 50 / 3);
    rig.modify_inputs = input(0);
    rig.run(100);
    assert_eq!((rig.int("x.command.position"), rig.int("bit"), rig.int("lamp")), (5000, 0, 1));
}

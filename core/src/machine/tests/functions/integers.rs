//! Conversion of whole numbers to a sink: which bits are carried, truncated or wrapped.

use super::{Line, Order, SinkConfig, SlotConfig, SourceConfig, Type, cell, field, order, slot};
use crate::command::Action;
use crate::machine::tests::rig::Rig;
use crate::object::{Leader, Object};

/// Returns a rig with a started ratio from the 64-bit word into a memory cell.
fn geared(ratio: i64, sak: i64, memory: u16) -> Rig {
    let source = SourceConfig::Signal("l".into());
    let mut gear = SlotConfig { source, sink: SinkConfig::Memory(memory), ..slot("g", 0, Type::Varsync) };
    for (name, value) in [("m1", ratio), ("sak", sak)] {
        gear.values[usize::from(field(Type::Varsync, name))] = value;
    }
    let mut rig = Rig::of(cell(vec![gear]));
    rig.give(order(0, Order::Start));
    rig
}

fn set(rig: &mut Rig, word: i64) {
    rig.give(Action::set_memory(2, word as f64));
}

/// Proves: AMK-BCOM-41
#[test]
fn a_position_wraps_at_the_width_of_its_sink_and_carries_its_fraction() {
    let mut rig = geared(-7777, 0, 0);
    let (mut total, mut wraps) = (0_i64, 0);
    for step in [3, 50_000, -7, 1_000_000, 1, 1, 1, -12_345, 4_000_000_000, -3_999_999_999] {
        total += step;
        set(&mut rig, total);
        let exact = (-7777 * total).div_euclid(10_000);
        assert_eq!(rig.int("w"), i64::from(exact as i16), "{total}");
        wraps += u8::from(i16::try_from(exact).is_err());
    }
    assert!(wraps > 4);
}

/// Proves: AMK-BCOM-41
#[test]
fn a_share_is_cut_towards_zero_and_computed_in_64_bits() {
    let mut rig = geared(10_000, 100, 3);
    let mut share = |word| {
        set(&mut rig, word);
        rig.int("g.sak_share")
    };
    // 100 / 128 of 3, -3, 2^40, -2^40.
    let far = 3 + (1 << 40);
    assert_eq!([3, 0, 3, far, 3].map(&mut share), [2, -2, 2, 100 << 33, -(100 << 33)]);
}

/// A measured value of a function is no counter, but is still truncated to the width of its sink (I7).
///
/// Proves: AMK-BCOM-41
#[test]
fn a_measured_distance_keeps_its_low_bits_where_its_sink_is_narrow() {
    let mut imes = SlotConfig {
        source: SourceConfig::Lead(Leader::Encoder(0)),
        sink: SinkConfig::Memory(0),
        ..slot("m", 0, Type::Imes)
    };
    imes.inputs[0] = Some(Line { object: Object::Io(0), inverted: false });
    imes.values[usize::from(field(Type::Imes, "ba"))] = 1;
    let mut rig = Rig::of(cell(vec![imes]));
    rig.give(order(0, Order::Start));
    let mut pulse = |way: [i64; 3]| {
        for by in way {
            rig.plant.slip_encoder(0, by);
            rig.plant.set_digital(0, false);
            rig.run(1);
        }
        rig.plant.set_digital(0, true);
        rig.run(2);
        (rig.int("w"), rig.int("m.sink"))
    };
    pulse([0, 0, 0]);
    assert_eq!(pulse([10_000, 10_000, 10_000]), (30_000, 30_000));
    assert_eq!(pulse([20_000, 20_000, 20_000]), (60_000 - 65_536, 60_000));
}

//! Mark corrections that are spread over a time, or over a distance of the master, with further pairs of marks during
//! the correction.

use super::marks::BeltAndRoll;

/// Returns a world whose labels are in register, and in which all products are then moved by `by` inc (of the belt);
/// runs up to the cycle in which a pair detects this.
fn shifted(changes: &[(&str, i64)], by: f64) -> BeltAndRoll {
    let mut world = BeltAndRoll::new(500.0, &[&[("syncmstart", 6)], changes].concat());
    world.couple();
    world.run(6_001, 10);
    assert!(world.rig.int("x.sync.error").abs() <= 2, "{}", world.rig.int("x.sync.error"));
    for product in &mut world.products {
        *product += by;
    }
    for _ in 0..300 {
        if world.rig.int("x.sync.error").abs() > 10 {
            return world;
        }
        world.cycle(10);
    }
    panic!("no pair has found it");
}

/// SYNCVFTIME -100000 is a correction within a second. A pair of marks occurs every 100 ms: if each restarted the
/// correction, 59 % would remain after half a second, and 35 % after the full second.
/// Proves: MACS-SYNC-10, MACS-MARK-13
#[test]
fn a_correction_over_a_time_ends_in_it() {
    let mut world = shifted(&[("syncvftime", -100_000)], 60.0);
    let first = world.rig.int("x.sync.error").abs();
    assert!((115..=125).contains(&first), "{first}");
    world.run(499, 10);
    let half = world.rig.int("x.sync.error").abs();
    assert!((57..=63).contains(&half), "{half}");
    world.run(501, 10);
    assert!(world.rig.int("x.sync.error").abs() <= 2, "{}", world.rig.int("x.sync.error"));
}

/// SYNCMFTIME spreads over one distance of the belt, 100 cycles. Products that are 200 inc early cause the next pair 80
/// cycles later, when a fifth remains.
/// Proves: MACS-MARK-12, MACS-MARK-13
#[test]
fn a_correction_over_a_distance_ends_with_it() {
    let mut world = shifted(&[("syncmftime", 1_000), ("syncmfpar", 16)], -200.0);
    let first = world.rig.int("x.sync.error").abs();
    assert!((390..=402).contains(&first), "{first}");
    world.run(49, 10);
    let half = world.rig.int("x.sync.error").abs();
    // The distance that the axis catches up at its start, within a few cycles, is added.
    assert!((195..=215).contains(&half), "{half}");
    world.run(65, 10);
    // The drive, one cycle behind, lags by 4 inc more while it catches up, which that pair corrects, too; a restarted
    // correction would leave 57 here.
    assert!(world.rig.int("x.sync.error").abs() <= 6, "{}", world.rig.int("x.sync.error"));
}

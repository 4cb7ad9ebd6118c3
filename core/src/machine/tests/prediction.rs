//! A gear with a coarse master with count noise and oscillation, on a drive with a delay: effect of filter and
//! prediction on the error.
//!
//! The master moves 5 counts per ms on average. Its velocity oscillates by 20 % with 2 Hz, and its counts jitter by up
//! to 1 in either direction. The slave moves 40 increments per count, 4 cycles behind its command. `LINESHAFT_LONG=1`
//! and `--nocapture` print a table.

use super::direction::set;
use super::rig::{Rig, X, config, couple};
use crate::command::Action;
use crate::object::Leader;
use crate::parameter::AxisParameters;

const RATIO: f64 = 40.0;
/// Delay of the bus (cycles); any drive adds one more.
const DELAY: u32 = 3;
const SPEED: f64 = 5.0;

/// Error of a slave over 8 s, starting from the second one (inc).
#[derive(Debug)]
struct Errors {
    mean: f64,
    /// Deviation from the mean.
    rms: f64,
    peak: f64,
    /// Change of the command velocity per cycle, rms.
    rough: f64,
}

/// Returns the real shaft position of the master (counts).
fn shaft(ms: f64) -> f64 {
    let omega = 2.0 * std::f64::consts::TAU / 1e3;
    SPEED * ms + 0.2 * SPEED / omega * (1.0 - libm::cos(omega * ms))
}

fn errors(changes: &[(&str, i64)]) -> Errors {
    let mut config = config(DELAY);
    config.axes[usize::from(X)].parameters = AxisParameters::new(2e6, 2e9);
    let mut rig = Rig::of(config);
    rig.enable();
    let given = set(&mut rig, changes);
    assert!(rig.was_accepted(given), "{}", rig.refusal(given));
    let start = rig.int("x.actual.position") as f64;
    rig.give(Action::Synchronize(couple(X, Leader::Encoder(0), 40, 1)));
    let (mut seed, mut counted, mut before) = (7_u64, 0, 0.0);
    let (mut sum, mut squares, mut peak, mut rough, mut count) = (0.0, 0.0, 0.0_f64, 0.0, 0.0);
    for ms in 1..9_000 {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let tremble = (seed >> 40) as f64 / f64::from(1 << 23) - 1.0;
        let seen = (shaft(f64::from(ms)) + tremble).floor() as i64;
        rig.plant.jump_encoder(0, seen - counted);
        counted = seen;
        rig.run(1);
        let error = RATIO * shaft(f64::from(ms)) - (rig.int("x.actual.position") as f64 - start);
        let velocity = rig.real("x.command.velocity") / 1e3;
        if ms > 1_000 {
            sum += error;
            squares += error * error;
            peak = peak.max(error.abs());
            rough += (velocity - before) * (velocity - before);
            count += 1.0;
        }
        before = velocity;
    }
    assert_eq!(rig.int("x.in_sync"), 1);
    let mean = sum / count;
    Errors { mean, rms: (squares / count - mean * mean).sqrt(), peak, rough: (rough / count).sqrt() }
}

/// Four cycles of delay at 200 inc per cycle are 800 inc. A prediction over 4 ms removes this lag, but amplifies the
/// count noise. A filter smooths it, at the cost of the oscillation above its bandwidth: the shorter filter is the
/// better one here.
/// Proves: MACS-SYNC-15, MACS-SYNC-09
#[test]
fn a_prediction_over_the_delay_takes_the_lag_away() {
    let of = |filter: i64, ahead: i64| errors(&[("syncvftime", filter), ("syncffvel", ahead)]);
    let all = [(0, 0), (0, 4_000), (-5_000, 0), (-5_000, 4_000), (-20_000, 0), (-20_000, 4_000)];
    let [plain, ahead, _, both, _, slow] = all.map(|(filter, prediction)| {
        let errors = of(filter, prediction);
        let Errors { mean, rms, peak, rough } = errors;
        println!(
            "{filter} {prediction}: mean {mean:.0}, around it {rms:.0}, peak {peak:.0}, velocity by {rough:.0} a cycle"
        );
        errors
    });
    // A count is rounded down: half a count, 20 inc, is missing on average.
    assert!((plain.mean - 820.0).abs() < 8.0, "{plain:?}");
    for predicted in [&ahead, &both, &slow] {
        assert!((predicted.mean - 20.0).abs() < 8.0, "{predicted:?}");
    }
    // 20 % of oscillation are 160 inc in either direction: 113 rms.
    assert!((plain.rms - 113.0).abs() < 12.0, "{plain:?}");
    assert!(both.peak < plain.peak / 2.0 && both.peak < ahead.peak && both.peak < slow.peak, "{both:?}");
    assert!(ahead.rough > 3.0 * plain.rough && both.rough < ahead.rough / 5.0, "{both:?}");
}

//! Index pulses: of the encoder that the axis reads, and simulated ones.

use super::super::rig::{Rig, X, at, config, to};
use super::{change, error, off, set, velocity_config, zero};
use crate::axis::Wired;
use crate::code::Code;
use crate::command::{Action, HomeAxis, HomingMethod};
use crate::config::MachineConfig;
use crate::encoder::PulseCheck;
use crate::sim::{Fixtures, Index};

/// The drive has an index, too, but the loop is not closed with its encoder: its pulses occur in other cycles and at
/// other positions.
///
/// Proves: MACS-ENC-12
#[test]
fn the_index_is_that_of_the_encoder_that_the_axis_reads() {
    let mut config = velocity_config();
    config.encoders[0].check = Some(PulseCheck { every: 1_000, tolerance: 8 });
    config.axes[1].wired = Wired::Encoder(0);
    let mut rig = Rig::of(config);
    rig.plant
        .drive(0)
        .unwrap()
        .install_fixtures(Fixtures { index: Some(Index { every: 300, at: 150 }), ..Fixtures::default() });
    rig.enable();
    rig.give(Action::Move(at(X, 20_000.0)));
    let mut seen = Vec::new();
    while rig.int("x.actual.position") < 4_500 {
        let before = rig.int("x.index.count");
        rig.run(1);
        if rig.int("x.index.count") != before {
            assert_eq!(rig.int("x.index.count"), before + 1);
            assert!((rig.int("x.actual.position") - rig.int("x.index.position")).abs() <= 20, "in its cycle");
            seen.push(rig.int("x.index.position"));
        }
    }
    assert_eq!((seen, error(&rig)), (vec![1_000, 2_000, 3_000, 4_000], 0));
    // Homing to the index also finds that of the encoder.
    let mut rig = Rig::of({
        let mut config = velocity_config();
        config.encoders[0].check = Some(PulseCheck { every: 1_000, tolerance: 8 });
        config.axes[1].wired = Wired::Encoder(0);
        config
    });
    rig.plant
        .drive(0)
        .unwrap()
        .install_fixtures(Fixtures { index: Some(Index { every: 300, at: 150 }), ..Fixtures::default() });
    rig.enable();
    rig.give(Action::Move(to(X, 400)));
    rig.run(300);
    let home = rig.give(Action::HomeAxis(HomeAxis { axis: X, method: HomingMethod::Cia402(34) }));
    rig.run(3_000);
    assert_eq!(rig.done(home)[0].code, Code::NONE, "{}", rig.state("x"));
    assert_eq!(rig.int("belt.count") - rig.int("x.actual.position"), 1_000, "the pulse at 1000, not that at 450");
}

/// ENCODERTYPE 9 with a mark every 500 increments.
fn simulated(every: i64) -> MachineConfig {
    let mut config = config(0);
    let p = &mut config.axes[1].parameters.encoder;
    (p.encodertype, p.encoderfreq) = (9, every);
    config
}

/// Proves: MACS-ENC-13
#[test]
fn simulated_marks_lie_at_each_multiple_of_encoderfreq() {
    let mut rig = Rig::of(simulated(500));
    rig.enable();
    rig.mirror();
    let mut seen = Vec::new();
    for target in [1_600, -700] {
        rig.give(Action::Move(to(X, target)));
        for _ in 0..1_000 {
            let before = rig.int("x.index.count");
            rig.run(1);
            if rig.int("x.index.count") > before {
                seen.push(rig.int("x.index.position"));
            }
        }
    }
    assert_eq!(seen, [500, 1_000, 1_500, 1_500, 1_000, 500, 0, -500]);
    // A new zero is not a motion: it passes no mark, and marks are at multiples of the new coordinate.
    rig.give(zero(X, 4_999));
    rig.run(5);
    assert_eq!(rig.int("x.index.count"), 8);
    rig.give(Action::Move(to(X, 5_000)));
    rig.run(100);
    assert_eq!((rig.int("x.index.count"), rig.int("x.index.position")), (9, 5_000));
    // If the axis is off, the drive shows its position, and there are no marks.
    off(&mut rig, X);
    rig.plant.drive(0).unwrap().jump(5_000);
    rig.run(10);
    assert_eq!(rig.int("x.index.count"), 9);
}

/// As a mark distance any number above 0 is allowed, as a clock rate only the existing rates.
///
/// Proves: MACS-ENC-13
#[test]
fn encoderfreq_is_a_rate_or_a_distance() {
    let mut rig = Rig::of(config(0));
    rig.run(2);
    let sentence =
        "is no clock rate; 39000 to 5000000 Hz are allowed, or with encodertype 9 any distance of marks above 0";
    for value in [38_999, 5_000_001, 500] {
        let refused = set(&mut rig, &[("encoderfreq", value)]);
        assert_eq!(rig.refusal(refused), format!("x: encoderfreq {value} {sentence}"));
    }
    for value in [39_000, 5_000_000] {
        let good = set(&mut rig, &[("encoderfreq", value)]);
        assert!(rig.was_accepted(good));
    }
    let good = rig.give(Action::SetParameters(Box::new([change(X, "encodertype", 9), change(X, "encoderfreq", 500)])));
    assert!(rig.was_accepted(good));
    let refused = set(&mut rig, &[("encodertype", 0)]);
    assert_eq!(rig.refusal(refused), format!("x: encoderfreq 500 {sentence}"));
}

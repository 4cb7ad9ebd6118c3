//! Wrong encoder words, cut lines, position jumps.

use super::super::rig::{Rig, X, at, config, couple};
use super::{corrected, error, gray, shared_config, velocity_config};
use crate::axis::Wired;
use crate::code::Code;
use crate::command::Action;
use crate::encoder::{Absolute, Form};
use crate::event::Kind;
use crate::object::Leader;
use crate::sim::Model;

/// While the axis moves, bits of its encoder words are wrong for a hundred cycles: only a warning is reported. The next
/// wrong word is used unmodified and causes a position error.
///
/// Proves: MACS-ENC-08, MACS-SYS-01
#[test]
fn a_hundred_bad_words_are_replaced_and_the_next_one_is_a_position_error() {
    for (words, ends_in) in [(100, Code::NONE), (101, Code::FOLLOWING_ERROR)] {
        let mut rig = corrected();
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(2_000);
        let behind = rig.int("x.following_error");
        // The highest bit of the word inverts its sign.
        rig.plant.drive(0).unwrap().invert_bits(1 << 24, words);
        for _ in 0..100 {
            rig.run(1);
            assert_eq!(error(&rig), 0);
            assert!((rig.int("x.following_error") - behind).abs() <= 1, "it goes on with its velocity");
        }
        assert_eq!(rig.int("x.encoder.errors"), 100);
        rig.run(1);
        assert_eq!(error(&rig), i64::from(ends_in.0), "{words}");
        let warned: Vec<_> = rig.events.iter().filter(|event| event.code == Code::ENCODER_SUBSTITUTED).collect();
        assert_eq!(warned.len(), 1, "told once");
        let sentence = crate::text::message(warned[0], rig.machine.config());
        assert_eq!(sentence, "x: a bad word of the encoder was replaced by an extrapolated one; 1 so far");
    }
}

/// A cut line delivers no word: first the same substitution, then no value, so the axis is switched off.
///
/// Proves: MACS-ENC-08
#[test]
fn a_cut_line_ends_in_an_error_when_nothing_is_replaced_any_more() {
    let mut rig = corrected();
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(400);
    rig.plant.drive(0).unwrap().cut_encoder();
    rig.run(100);
    assert_eq!(error(&rig), 0);
    rig.run(1);
    assert_eq!((error(&rig), rig.state("x")), (i64::from(Code::ENCODER_INVALID.0), "ERROR_STOP"));
    assert_eq!((rig.real("x.output.velocity"), rig.int("x.output.control")), (0.0, 0));
    assert_eq!((rig.int("x.encoder.errors"), rig.int("x.enabled")), (101, 0));
}

/// Without correction it is an error in its cycle; with monitoring of the modules it is alarm 7.
///
/// Proves: WF-MON-01, WF-MON-06, WF-MD-18
#[test]
fn a_cut_line_stops_the_axis_in_its_cycle() {
    for (monitored, code) in [(0, Code::ENCODER_INVALID), (1, Code::WF_ENCODER_CABLE)] {
        let mut config = velocity_config();
        config.axes[1].wired = Wired::Drive(Form::Absolute(gray(8192, 4096)));
        config.axes[1].parameters.encoder.monitored = monitored;
        let mut rig = Rig::of(config);
        rig.enable();
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(100);
        rig.plant.drive(0).unwrap().cut_encoder();
        rig.run(1);
        assert_eq!((error(&rig), rig.state("x")), (i64::from(code.0), "ERROR_STOP"));
        assert_eq!(rig.int("x.output.control"), 0, "the controller enable drops");
        let mut config = shared_config();
        config.axes[1].parameters.encoder.monitored = monitored;
        let mut rig = Rig::of(config);
        rig.enable();
        rig.run(100);
        rig.plant.cut_encoder(0);
        rig.run(1);
        assert_eq!((error(&rig), rig.int("belt.error")), (i64::from(code.0), i64::from(Code::ENCODER_INVALID.0)));
        assert_eq!(rig.state("y"), "ERROR_STOP", "so does whoever else reads it");
    }
}

/// With any following error time, a jump is an error in its cycle; if the axis is off, it is reported.
#[test]
fn a_jump_is_an_error_in_its_cycle() {
    for (by, expected) in [(300, Code::NONE), (301, Code::ENCODER_JUMP), (-301, Code::ENCODER_JUMP)] {
        let mut config = config(0);
        let p = &mut config.axes[1].parameters;
        p.following_error_time = 10_000_000_000;
        p.encoder.max_jump = Some(300);
        let mut rig = Rig::of(config);
        rig.enable();
        rig.plant.drive(0).unwrap().jump(by);
        let cycle = rig.machine.next_cycle();
        rig.run(1);
        assert_eq!(error(&rig), i64::from(expected.0), "{by}");
        if let Some(event) = rig.events.iter().find(|event| event.code == Code::ENCODER_JUMP) {
            assert_eq!(event.cycle, cycle);
            let text =
                format!("x: the encoder jumped by {} mm in one cycle; its axis moves 0.3 mm at most", by as f64 / 1e3);
            assert_eq!(crate::text::message(event, rig.machine.config()), text);
        }
    }
    let mut config = config(0);
    config.axes[1].parameters.encoder.max_jump = Some(300);
    let mut rig = Rig::of(config);
    rig.run(2);
    rig.plant.drive(0).unwrap().jump(10_000);
    rig.run(1);
    let warned = rig.events.iter().filter(|event| event.code == Code::ENCODER_JUMP && event.kind == Kind::Warning);
    assert_eq!((warned.count(), error(&rig)), (1, 0));
}

/// Disturbed words of an encoder in section `encoders`: corrected, or reported and without a value.
///
/// Proves: MACS-ENC-08, MACS-ENC-12
#[test]
fn a_disturbed_leading_encoder_is_corrected_or_lost() {
    for (corrects, expected) in [(true, 0), (false, i64::from(Code::LEADER_LOST.0))] {
        let mut config = config(0);
        let encoder = Absolute { corrects, max_step: Some(100), ..gray(4096, 1) };
        config.encoders[0].form = Form::Absolute(encoder);
        let mut rig = Rig::with(config, [Model::Ideal; 2]);
        rig.enable();
        rig.give(Action::Synchronize(couple(X, Leader::Encoder(0), 1, 1)));
        for _ in 0..300 {
            rig.plant.jump_encoder(0, 7);
            rig.run(1);
        }
        rig.plant.disturb_encoder(0, 1 << 10, 3);
        for _ in 0..10 {
            rig.plant.jump_encoder(0, 7);
            rig.run(1);
        }
        assert_eq!((error(&rig), rig.int("belt.errors") > 0), (expected, true), "corrects {corrects}");
        assert_eq!((rig.int("belt.position"), rig.int("belt.error")), (310 * 7, 0));
    }
}

//! Sources that an axis may read, and the conversion of the words of each source.

use super::super::rig::{Rig, X, Y, at, config, to};
use super::{change, corrected, error, gray, off, set, shared_config, velocity_config};
use crate::axis::Wired;
use crate::code::Code;
use crate::command::{Action, Move, MoveMode};
use crate::config::{ConfigError, EncoderConfig};
use crate::drive::Interface;
use crate::encoder::{Absolute, Form};
use crate::object::AxisSet;
use crate::parameter::{Row, Value};

/// A word with 13 bits for the position in a revolution and 12 bits for revolutions, in Gray code: 1:1, and without
/// effects at the word boundary.
///
/// Proves: MACS-ENC-01, WF-ABS-01
#[test]
fn an_axis_runs_on_an_absolute_encoder_and_over_its_seam() {
    let mut config = velocity_config();
    // The word range is 400 revolutions of 100.
    config.axes[1].wired = Wired::Drive(Form::Absolute(gray(100, 400)));
    let mut rig = Rig::of(config);
    rig.enable();
    rig.mirror();
    for target in [90_000, -90_000, 0] {
        let goal = rig.give(Action::Move(to(X, target)));
        rig.run(6_000);
        assert_eq!(rig.done(goal).len(), 1, "{target}");
        assert_eq!((rig.int("x.actual.position"), error(&rig)), (target, 0));
    }
    assert_eq!(rig.int("x.actual.count"), 0, "where it began");
    rig.give(Action::Move(to(X, -1)));
    rig.run(200);
    assert_eq!(rig.int("x.actual.count"), 39_999 ^ 39_999 >> 1);
}

/// Each number of the table reads the named source: the counts of the drive, its words of one revolution, a terminal,
/// or the command. The clock of a serial encoder is decoded, and has no effect here; the decoding test shows the source
/// of a bus number.
///
/// Proves: MACS-ENC-04
#[test]
fn each_encodertype_reads_what_it_names() {
    /// Result of a drive that moves 7 up and 8 down, over the boundary of a word, and of terminals that move 100, 200,
    /// 300 up.
    #[derive(Debug, PartialEq)]
    struct Seen {
        up: i64,
        down: i64,
        count: i64,
        errors: i64,
    }
    let counted = |up, down, count| Seen { up, down, count, errors: 0 };
    // From 0 to 4095 is the longer distance within a revolution: an overflow, or for a source without overflows, a bad
    // word.
    let (counts, overflows) = (counted(7, -1, -1), counted(7, -1, 4_095));
    let corrected = Seen { errors: 1, ..counted(7, 7, 4_095) };
    let seen = |kind: i64| {
        let mut config = velocity_config();
        let belt = config.encoders[0].clone();
        config.encoders =
            ["belt", "second", "third"].map(|name| EncoderConfig { name: name.into(), ..belt.clone() }).into();
        let p = &mut config.axes[1].parameters;
        (p.encoder.encodertype, p.macs.encoder) = (kind, 4_096);
        let mut rig = Rig::of(config);
        rig.run(5);
        assert_eq!((rig.int("x.actual.position"), rig.int("x.encoder.errors")), (0, 0));
        rig.plant.drive(0).unwrap().jump(7);
        (0..3).for_each(|place| rig.plant.jump_encoder(place, 100 * (place as i64 + 1)));
        rig.run(2);
        let up = rig.int("x.actual.position");
        rig.plant.drive(0).unwrap().jump(-8);
        rig.run(1);
        let down = rig.int("x.actual.position");
        let seen = Seen { up, down, count: rig.int("x.actual.count"), errors: rig.int("x.encoder.errors") };
        // Switched on and pushed: only the simulated encoder shows the command.
        rig.give(Action::Enable(AxisSet::one(X)));
        rig.run(20);
        let command = rig.int("x.command.position");
        rig.plant.drive(0).unwrap().jump(50);
        rig.plant.jump_encoder(0, 50);
        rig.run(1);
        let stays = rig.int("x.actual.position") == command;
        (seen, stays)
    };
    for (kind, expected) in [
        (0, &counts),
        (1, &overflows),
        (2, &overflows),
        (3, &corrected),
        (4, &corrected),
        (5, &counts),
        (9, &counts),
        (10, &counted(100, 100, 100)),
        (20, &counted(200, 200, 200)),
        (30, &counted(300, 300, 300)),
    ] {
        let (found, stays) = seen(kind);
        assert_eq!(&found, expected, "encodertype {kind}");
        assert_eq!(stays, [9, 20, 30].contains(&kind), "encodertype {kind}");
    }
}

/// VELMAX 600 rpm with 4096 steps is 40960 inc/s, with any way to declare the encoder absolute; with lines it is four
/// times that.
///
/// Proves: MACS-ENC-01, MACS-PROF-02
#[test]
fn an_axis_on_an_absolute_encoder_keeps_velmax() {
    let absolute = Form::Absolute(Absolute { turns: 4096, ..Absolute::single_turn(4096) });
    let lines = Form::Incremental(64);
    let runs = |rig: &mut Rig, fastest: f64, what: &str| {
        rig.enable();
        let too_fast = rig.give(Action::Move(Move { velocity: fastest + 1.0, ..to(X, 0) }));
        assert!(rig.refusal(too_fast).contains("velocity"), "{what}: {}", rig.refusal(too_fast));
        rig.give(Action::Move(Move { velocity: fastest, mode: MoveMode::Velocity, ..to(X, 0) }));
        rig.run(2_000);
        assert_eq!((rig.real("x.command.velocity"), error(rig)), (fastest, 0), "{what}");
        rig.give(Action::Halt(AxisSet::one(X)));
        rig.run(2_000);
    };
    for (wired, belt, kind, fastest) in [
        (Wired::Drive(lines), lines, 0, 163_840.0),
        (Wired::Drive(lines), lines, 1, 40_960.0),
        (Wired::Drive(lines), lines, 10, 163_840.0),
        (Wired::Drive(lines), absolute, 10, 40_960.0),
        (Wired::Drive(absolute), lines, 0, 40_960.0),
        (Wired::Drive(absolute), absolute, 3, 40_960.0),
        (Wired::Encoder(0), lines, 0, 163_840.0),
        (Wired::Encoder(0), absolute, 0, 40_960.0),
    ] {
        let mut config = velocity_config();
        config.encoders[0].form = belt;
        config.axes[1].wired = wired;
        let p = &mut config.axes[1].parameters;
        let given =
            [("encoder", Value::Int(4096)), ("velmax", Value::Real(600.0)), ("rampmin", Value::Int(500_000_000))];
        for (key, value) in given.into_iter().chain([("encodertype", Value::Int(kind))]) {
            assert_eq!(Row::find(key).unwrap().1.assign(p, value), Ok(()), "{key}");
        }
        let mut rig = Rig::of(config);
        runs(&mut rig, fastest, &format!("{wired:?} {belt:?} {kind}"));
        if (kind, belt) == (1, lines) {
            off(&mut rig, X);
            set(&mut rig, &[("encodertype", 0)]);
            assert_eq!(rig.machine.parameters(X).unwrap().max_velocity, 163_840.0, "counts from now on");
        }
    }
}

/// A drive with 16 bits that closes its own loop: the setpoint wraps around with it.
///
/// Proves: MACS-ENC-07
#[test]
fn a_drive_of_few_bits_is_commanded_over_its_seam() {
    for form in [Form::Incremental(16), Form::Absolute(Absolute::single_turn(40_000))] {
        let mut config = config(2);
        config.axes[1].wired = Wired::Drive(form);
        let mut rig = Rig::of(config);
        rig.enable();
        for target in [300_000, -300_000] {
            rig.give(Action::Move(to(X, target)));
            for _ in 0..13_000 {
                rig.run(1);
                assert_eq!((rig.int("x.following_error"), error(&rig)), (0, 0), "{form:?}");
            }
            assert_eq!((rig.int("x.actual.position"), rig.state("x")), (target, "STANDSTILL"));
        }
    }
}

/// The words of MD5 steps in Gray code that the axis reads with MD4 absolute, with the first MD7 of them omitted; a
/// step above MD34 is invalid.
///
/// Proves: WF-MD-03, WF-MD-04, WF-MD-05, WF-MD-16, WF-ABS-01, WF-ABS-04
#[test]
fn the_module_reads_an_absolute_encoder_by_its_machine_data() {
    for omitted in [0, 76] {
        let mut config = velocity_config();
        let p = &mut config.axes[1].parameters.encoder;
        (p.kind, p.steps, p.side_or_omitted, p.pulses_or_step) = (1, 16_384, omitted, 300);
        let mut rig = Rig::of(config);
        rig.enable();
        rig.give(Action::Move(to(X, 50_000)));
        rig.run(2_500);
        assert_eq!((rig.int("x.actual.position"), error(&rig)), (50_000, 0));
        let value = 50_000 % 16_384 + omitted;
        assert_eq!(rig.int("x.actual.count"), value ^ value >> 1);
        rig.plant.drive(0).unwrap().jump(301);
        rig.run(1);
        assert_eq!(error(&rig), i64::from(Code::ENCODER_INVALID.0));
    }
}

/// The command is the position, independent of the drive; if the axis is off, it is the position of the drive.
///
/// Proves: MACS-ENC-13
#[test]
fn a_simulated_encoder_shows_the_command() {
    for interface in [Interface::Position, Interface::Velocity] {
        let mut config = velocity_config();
        config.axes[1].interface = interface;
        config.axes[1].parameters.encoder.encodertype = 9;
        let mut rig = Rig::of(config);
        rig.enable();
        rig.give(Action::Move(to(X, 40_000)));
        for _ in 0..1_500 {
            rig.run(1);
            assert_eq!(rig.int("x.actual.position"), rig.int("x.command.position"));
            assert_eq!((rig.int("x.following_error"), error(&rig)), (0, 0));
        }
        rig.plant.drive(0).unwrap().jump(-30_000);
        rig.run(5);
        assert_eq!((rig.int("x.actual.position"), error(&rig)), (40_000, 0));
        off(&mut rig, X);
        let stands = rig.int("x.actual.position");
        rig.give(Action::Enable(AxisSet::one(X)));
        rig.run(40);
        assert_eq!(rig.int("x.command.position"), stands, "it begins where the drive stands");
    }
}

/// Missing sources are refused, and nothing changes.
///
/// Proves: MACS-ENC-05, MACS-ENC-06
#[test]
fn sources_that_are_not_there_are_refused() {
    let mut rig = Rig::of(velocity_config());
    rig.run(2);
    let bus = "which an entry of encoders does (key feedback of the axis reads it); the types 0 to 5, 9, 10, 20, 30 exist, for \
               a master 0, 1, 2, 5, 6, 10, 20, 30 and -1 to -999";
    for (value, sentence) in [
        (102_005, format!("x: encodertype 102005 names a node of a bus, {bus}")),
        (251_105, format!("x: encodertype 251105 names a node of a bus, {bus}")),
        (7, "x: encodertype 7 is no type of encoder".to_owned()),
        (-1, "x: encodertype -1 is no type of encoder".to_owned()),
        (
            20,
            "x: encodertype 20 names an entry of section encoders that the cell does not have: 10 is the first one"
                .to_owned(),
        ),
    ] {
        let refused = set(&mut rig, &[("encodertype", value)]);
        assert_eq!(rig.refusal(refused), sentence);
        assert_eq!(rig.machine.parameters(X).unwrap().encoder.encodertype, 0);
    }
    let in_drive = rig.give(Action::SetParameters(Box::new([change(Y, "encodertype", 10)])));
    let sentence = "y: encodertype 10 names an encoder that a drive with interface position does not close its loop with; 0, 1, 2, \
                    5 and 9 are allowed";
    assert_eq!(rig.refusal(in_drive), sentence);
    let mut config = shared_config();
    config.axes[1].parameters.encoder.encodertype = 1;
    let wrong = |code| Err(ConfigError::NotImplemented { axis: "x".to_owned(), key: "encodertype", code });
    assert_eq!(config.check(), wrong(Code::ENCODER_CHOSEN_TWICE));
    config.axes[1].parameters.encoder.encodertype = 30;
    assert_eq!(config.check(), wrong(Code::ENCODER_NO_TERMINAL));
}

/// A machine restored from its state continues with all of these sources.
#[test]
fn a_restored_machine_reads_on() {
    let mut rig = corrected();
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(300);
    rig.plant.drive(0).unwrap().invert_bits(1 << 24, 60);
    rig.run(20);
    rig.mirror();
    rig.run(300);
    assert_eq!((error(&rig), rig.int("x.encoder.errors")), (0, 60));
}

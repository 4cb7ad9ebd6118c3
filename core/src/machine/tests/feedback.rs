//! Where positions come from: encoders that are absolute, shared, changed, disturbed or cut.

use super::rig::{Rig, X, Y, at, config, couple, to};
use crate::axis::Wired;
use crate::code::Code;
use crate::command::{Action, HomeAxis, HomingMethod, Move, MoveMode, SetPosition};
use crate::config::{ConfigError, EncoderConfig, MachineConfig};
use crate::drive::Interface;
use crate::encoder::{Absolute, Form, PulseCheck, WordCode};
use crate::event::Kind;
use crate::object::{AxisSet, Leader};
use crate::parameter::{Change, Row, Value};
use crate::position::Length;
use crate::sim::{Fixtures, Index, Model};
use crate::vocabulary::wf::Request;

/// x closes its loop here.
fn velocity_config() -> MachineConfig {
    let mut config = config(0);
    config.axes[1].interface = Interface::Velocity;
    config.axes[1].parameters.max_following_error = 20_000;
    config
}

/// x and y close their loops here, and both use the belt's encoder; x is the one that turns it.
fn shared_config() -> MachineConfig {
    let mut config = velocity_config();
    config.axes[2].interface = Interface::Velocity;
    config.axes[2].parameters.max_following_error = 1 << 40;
    for axis in [1, 2] {
        config.axes[axis].wired = Wired::Encoder(0);
    }
    config
}

fn gray(steps: u32, turns: u32) -> Absolute {
    Absolute { turns, code: WordCode::Gray, ..Absolute::single_turn(steps) }
}

/// x with an absolute encoder that MACS corrects.
fn corrected() -> Rig {
    let mut config = velocity_config();
    config.axes[1].wired = Wired::Drive(Form::Absolute(Absolute { turns: 4096, ..gray(8192, 1) }));
    config.axes[1].parameters.encoder.encodertype = 3;
    let mut rig = Rig::of(config);
    rig.enable();
    rig
}

fn change(axis: u16, key: &str, value: i64) -> Change {
    Change { axis, row: Row::find(key).unwrap_or_else(|| panic!("no row {key}")).0, value: Value::Int(value) }
}

fn set(rig: &mut Rig, changes: &[(&str, i64)]) -> u64 {
    let changes = changes.iter().map(|(key, value)| change(X, key, *value)).collect();
    rig.give(Action::SetParameters(changes))
}

fn off(rig: &mut Rig, axis: u16) {
    rig.give(Action::Disable(AxisSet::one(axis)));
    rig.run(5);
}

fn zero(axis: u16, position: i64) -> Action {
    Action::SetPosition(SetPosition { axis, position: Length::whole(position) })
}

fn error(rig: &Rig) -> i64 {
    rig.int("x.error")
}

/// A word of 13 bits for a turn and 12 for turns in Gray code: 1:1, and over the seam without a trace.
///
/// Proves: MACS-ENC-01, WF-ABS-01
#[test]
fn an_axis_runs_on_an_absolute_encoder_and_over_its_seam() {
    let mut config = velocity_config();
    // 400 turns of 100 are one round of its words.
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

/// Each number of the table reads what it names: the drive's counts, its words of a turn, a terminal, or the command. Which clock
/// a serial encoder has is decoded, and matters to nobody here; what a number of a bus names, its decoding shows.
///
/// Proves: MACS-ENC-04
#[test]
fn each_encodertype_reads_what_it_names() {
    /// What comes of a drive that goes 7 up and 8 down, over the seam of a word, and of terminals that go 100, 200, 300 up.
    #[derive(Debug, PartialEq)]
    struct Seen {
        up: i64,
        down: i64,
        count: i64,
        errors: i64,
    }
    let counted = |up, down, count| Seen { up, down, count, errors: 0 };
    // From 0 to 4095 is the longer way within a turn: an overflow, or where there is none, a bad word.
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
        // On, and pushed: only the simulated encoder shows the command.
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

/// VELMAX 600 rpm of 4096 steps are 40960 inc/s, whichever way the cell says that the encoder is absolute; of lines it
/// is four times that.
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

/// A drive of 16 bits that closes its own loop: the setpoint goes over the seam with it.
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

/// The words of MD5 steps in Gray code that the axis reads with MD4 absolute, the first MD7 of them left out; a step beyond MD34 is
/// no value.
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

/// While the axis moves bits of its words are wrong, a hundred cycles long: nobody sees more than a warning. One more, and the
/// word is taken as it stands: a position error.
///
/// Proves: MACS-ENC-08, MACS-SYS-01
#[test]
fn a_hundred_bad_words_are_replaced_and_the_next_one_is_a_position_error() {
    for (words, ends_in) in [(100, Code::NONE), (101, Code::FOLLOWING_ERROR)] {
        let mut rig = corrected();
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(2_000);
        let behind = rig.int("x.following_error");
        // The highest bit of the word turns its number over.
        rig.plant.drive(0).unwrap().disturb(1 << 24, words);
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
        let sentence = crate::text::sentence(warned[0], rig.machine.config());
        assert_eq!(sentence, "x: a bad word of the encoder was replaced by an extrapolated one; 1 so far");
    }
}

/// A line that is cut leaves no word: the same way, and then there is no value, so that the axis is switched off.
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

/// Without correction it is an error in its cycle; with monitoring of the modules it is their alarm 7.
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

/// Two users at 25000; a soft zero is one of the first alone, a hard one is the encoder's.
///
/// Proves: MACS-O-59, MACS-ENC-11, MACS-ENC-12
#[test]
fn a_soft_zero_is_of_one_user_and_a_hard_one_of_all() {
    for (control, others) in [(2, 25_000), (0, 0)] {
        let mut rig = Rig::of(shared_config());
        rig.run(2);
        rig.give(Action::SetParameters(Box::new([change(X, "enccontrol", control)])));
        rig.give(Action::Enable(AxisSet::one(X)));
        rig.run(40);
        rig.give(Action::Move(to(X, 25_000)));
        rig.run(2_000);
        let seen = |rig: &Rig| ["x.actual.position", "y.actual.position", "belt.position"].map(|name| rig.int(name));
        assert_eq!(seen(&rig), [25_000; 3]);
        rig.give(zero(X, 0));
        assert_eq!(rig.int("x.actual.position"), 0, "at once");
        rig.run(1);
        assert_eq!(seen(&rig), [0, others, others], "enccontrol {control}");
        // Nothing has moved, and all go on from there.
        rig.run(50);
        assert_eq!((seen(&rig), error(&rig)), ([0, others, others], 0));
        rig.give(Action::Move(to(X, 1_000)));
        rig.run(1_000);
        assert_eq!(seen(&rig), [1_000, others + 1_000, others + 1_000]);
        assert_eq!(rig.int("belt.count"), 26_000, "what it reads is what it reads");
    }
}

/// A zero of the encoder would move the place under another user that is on its way: refused, and nothing changes.
///
/// Proves: MACS-ENC-11
#[test]
fn a_hard_zero_waits_for_the_other_users() {
    let mut rig = Rig::of(shared_config());
    rig.enable();
    rig.give(Action::Move(at(Y, 1_000.0)));
    rig.run(10);
    let refused = rig.give(zero(X, 5));
    assert_eq!(rig.refusal(refused), "y: the axis runs at a velocity (CONTINUOUS_MOTION); halt it first");
    let before = rig.int("x.actual.position");
    // In one cycle with the start of the other: only the axis itself has the new zero, and that is told.
    let mut rig = Rig::of(shared_config());
    rig.enable();
    rig.give_all(vec![zero(X, 500), Action::Move(at(Y, 1_000.0))]);
    assert_eq!((before, rig.int("x.actual.position")), (0, 500));
    rig.run(1);
    assert_eq!(rig.int("belt.position"), 0);
    let told = rig.events.iter().find(|event| event.code == Code::ENCODER_NOT_SHARED).unwrap();
    let sentence = "x: y, which reads the same encoder, began to move, so that only this axis has its new zero";
    assert_eq!(crate::text::sentence(told, rig.machine.config()), sentence);
}

/// Who follows a shared encoder does not follow its new zero.
#[test]
fn a_hard_zero_moves_nobody_who_follows() {
    let mut config = velocity_config();
    config.axes[1].wired = Wired::Encoder(0);
    let mut rig = Rig::of(config);
    rig.enable();
    rig.give(Action::Synchronize(couple(Y, Leader::Encoder(0), 1, 1)));
    rig.run(50);
    rig.give(zero(X, 5_000));
    rig.run(20);
    assert_eq!((rig.int("belt.position"), rig.int("y.command.position"), rig.int("y.error")), (5_000, 0, 0));
    rig.give(Action::Move(to(X, 6_000)));
    rig.run(1_000);
    assert_eq!((rig.int("belt.position"), rig.int("y.command.position")), (6_000, 1_000));
}

/// The source changes while the axis is off: soft, its position stays; hard, it is that of the new source.
///
/// Proves: MACS-ENC-11
#[test]
fn a_soft_change_of_the_source_keeps_the_position() {
    for (control, after) in [(1, 700), (0, 40)] {
        let mut config = velocity_config();
        config.axes[1].parameters.encoder.enccontrol = control;
        let mut rig = Rig::of(config);
        rig.plant.jump_encoder(0, 40);
        rig.enable();
        rig.give(Action::Move(to(X, 700)));
        rig.run(500);
        let on = set(&mut rig, &[("encodertype", 10)]);
        assert_eq!(rig.refusal(on), "x: encodertype becomes 10 only while x is disabled");
        off(&mut rig, X);
        rig.give(Action::Synchronize(couple(Y, Leader::AxisCommand(X), 1, 1)));
        rig.run(10);
        let y = rig.int("y.command.position");
        let changed = set(&mut rig, &[("encodertype", 10)]);
        assert!(rig.was_accepted(changed));
        rig.run(1);
        assert_eq!(rig.int("x.actual.position"), after, "enccontrol {control}");
        rig.run(20);
        assert_eq!(rig.int("y.command.position"), y, "that is no motion");
        rig.plant.jump_encoder(0, 3);
        rig.run(1);
        assert_eq!((rig.int("x.actual.position"), rig.int("x.actual.count")), (after + 3, 43));
    }
}

/// Another type cancels homing, also of the same source; a soft change keeps the position, and so its zero.
///
/// Proves: MACS-HOME-09, MACS-ENC-11
#[test]
fn another_type_of_encoder_cancels_homing() {
    for (control, homed) in [(0, 0), (1, 1)] {
        let mut config = velocity_config();
        config.axes[1].parameters.encoder.enccontrol = control;
        let mut rig = Rig::of(config);
        rig.enable();
        let method = crate::command::HomingMethod::Cia402(37);
        rig.give(Action::HomeAxis(crate::command::HomeAxis { axis: X, method }));
        rig.run(3);
        assert_eq!(rig.int("x.homed"), 1);
        off(&mut rig, X);
        set(&mut rig, &[("encodertype", 5)]);
        rig.run(2);
        assert_eq!(rig.int("x.homed"), homed, "enccontrol {control}");
        let warned = rig.events.iter().filter(|event| event.code == Code::HOMING_LOST).count();
        assert_eq!(warned as i64, 1 - homed, "enccontrol {control}");
    }
}

/// The command is the position, whatever the drive does; off, it is where the drive stands.
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

/// Proves: MACS-ENC-10, MACS-HOME-08
#[test]
fn the_zero_of_an_absolute_encoder_stands() {
    let mut rig = corrected();
    assert_eq!(rig.int("x.homed"), 1, "it knows where it is");
    let set = rig.give(zero(X, 5));
    let text = "x: encodertype 3 says that its encoder is absolute, so that its zero stands; no homing, no index and no set_position";
    assert_eq!(rig.refusal(set), text);
    let method = crate::command::HomingMethod::Cia402(37);
    let home = rig.give(Action::HomeAxis(crate::command::HomeAxis { axis: X, method }));
    assert_eq!(rig.refusal(home), text);
    assert_eq!(rig.int("x.actual.position"), 0);
}

/// What is not there is refused, and nothing changes.
///
/// Proves: MACS-ENC-05, MACS-ENC-06
#[test]
fn sources_that_are_not_there_are_refused() {
    let mut rig = Rig::of(velocity_config());
    rig.run(2);
    let bus = "which does not exist yet; the types 0 to 5, 9, 10, 20, 30 exist, for a master 0, 1, 2, 5, 6, 10, 20, 30 and -1 \
               to -999";
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
    let wrong = |code| Err(ConfigError::NotBuilt { axis: "x".to_owned(), key: "encodertype", code });
    assert_eq!(config.check(), wrong(Code::ENCODER_CHOSEN_TWICE));
    config.axes[1].parameters.encoder.encodertype = 30;
    assert_eq!(config.check(), wrong(Code::ENCODER_NO_TERMINAL));
}

/// 4 x 25 increments from mark to mark; counts of 1 ms at the highest speed and 4 may be wrong.
fn monitored() -> Rig {
    let mut config = velocity_config();
    let p = &mut config.axes[1].parameters;
    (p.encoder.monitored, p.encoder.pulses_or_step, p.max_velocity) = (1, 250, 20_000.0);
    let mut rig = Rig::of(config);
    rig.plant.drive(0).unwrap().fit(Fixtures { index: Some(Index { every: 1_000, at: 100 }), ..Fixtures::default() });
    rig.enable();
    rig.give(Action::Move(at(X, 10_000.0)));
    rig.run(500);
    rig
}

/// Homed by its index it rests on a mark. From there it goes off by less than a turn and comes back, from either side:
/// nothing is missing. Then pulses are, and it is told.
///
/// Proves: WF-MON-02
#[test]
fn an_axis_that_rests_on_its_mark_goes_back_and_forth() {
    let mut config = velocity_config();
    let p = &mut config.axes[1].parameters;
    (p.encoder.monitored, p.encoder.pulses_or_step, p.max_velocity) = (1, 250, 20_000.0);
    let mut rig = Rig::of(config);
    rig.plant.drive(0).unwrap().fit(Fixtures { index: Some(Index { every: 1_000, at: 100 }), ..Fixtures::default() });
    rig.enable();
    let home = rig.give(Action::HomeAxis(HomeAxis { axis: X, method: HomingMethod::Cia402(34) }));
    rig.run(3_000);
    assert_eq!((rig.done(home)[0].code, rig.int("x.homed")), (Code::NONE, 1));
    rig.mirror();
    for target in
        [-400, 0, 400, 0, -1, 0, 1, 0, -1, 1, 0, -2_500, 1_000, 999, 1_000, 1_001, 999, -1_000, -1_500, -1_000, 0]
    {
        rig.give(Action::Move(to(X, target)));
        rig.run(1_200);
        assert_eq!((rig.int("x.actual.position"), error(&rig)), (target, 0));
    }
    rig.plant.drive(0).unwrap().jump(-25);
    rig.run(100);
    rig.give(Action::Move(to(X, -400)));
    rig.run(300);
    rig.give(Action::Move(to(X, 400)));
    rig.run(300);
    assert_eq!(error(&rig), i64::from(Code::WF_PULSES.0));
}

/// Proves: WF-MON-02, WF-MON-06, WF-MON-07, WF-MD-16, WF-MD-18
#[test]
fn pulses_that_are_too_many_or_missing_are_alarm_8_at_the_next_mark() {
    for (slips, alarm) in [([24, -24], false), ([25, 0], true), ([-25, 0], true), ([13, 12], true)] {
        let mut rig = monitored();
        for slip in slips {
            rig.plant.drive(0).unwrap().jump(slip);
            rig.run(250);
        }
        let code = if alarm { i64::from(Code::WF_PULSES.0) } else { 0 };
        assert_eq!(error(&rig), code, "{slips:?}");
        if alarm {
            assert_eq!((rig.state("x"), rig.int("x.enabled"), rig.int("x.wf.alarm")), ("ERROR_STOP", 0, 8));
            let event = rig.events.iter().find(|event| event.kind == Kind::Error).expect("an error");
            let sentence = crate::text::sentence(event, rig.machine.config());
            assert!(sentence.starts_with("x: alarm 8: pulses of the encoder are missing or too many: "), "{sentence}");
            assert!(sentence.ends_with(" since the index, beyond 0.024 mm"), "{sentence}");
            // The reset bit acknowledges it, and the supervision begins anew.
            let axis = X;
            rig.give(Action::vocabulary(Request { axis, reset: true, ..Request::default() }));
            rig.run(2);
            assert_eq!((error(&rig), rig.int("x.wf.alarm"), rig.state("x")), (0, 0, "DISABLED"));
        }
    }
}

/// Proves: WF-MON-02
#[test]
fn a_mark_that_stays_away_is_alarm_8_as_soon_as_it_is_overdue() {
    let mut rig = monitored();
    let mark = rig.int("x.index.position");
    rig.plant.drive(0).unwrap().lose_index();
    while error(&rig) == 0 {
        rig.run(1);
        assert!(rig.int("x.actual.position") < mark + 1_000 + 24 + 20, "overdue");
    }
    assert_eq!(error(&rig), i64::from(Code::WF_PULSES.0));
    // Not selected, nobody looks.
    let mut rig = monitored();
    set(&mut rig, &[("wf.md41", 0)]);
    rig.plant.drive(0).unwrap().lose_index();
    rig.run(1_000);
    assert_eq!(error(&rig), 0);
}

/// The same of an entry of section `encoders`: its followers stop, and so does an axis that reads it.
///
/// Proves: WF-MON-02
#[test]
fn pulses_of_a_leading_encoder_are_monitored() {
    let mut config = velocity_config();
    config.encoders[0].check = Some(PulseCheck { every: 1_000, tolerance: 8 });
    config.axes[1].wired = Wired::Encoder(0);
    let mut rig = Rig::of(config);
    rig.enable();
    rig.give(Action::Synchronize(couple(Y, Leader::Encoder(0), 1, 1)));
    rig.give(Action::Move(at(X, 10_000.0)));
    rig.run(500);
    rig.plant.slip_encoder(0, 8);
    rig.run(200);
    assert_eq!((error(&rig), rig.int("belt.error")), (0, 0));
    rig.plant.slip_encoder(0, 1);
    rig.run(100);
    let told = rig.events.iter().filter(|event| event.code == Code::WF_PULSES).count();
    assert_eq!((told, error(&rig)), (1, i64::from(Code::ENCODER_INVALID.0)));
    assert_eq!(rig.int("y.error"), i64::from(Code::LEADER_LOST.0));
}

/// Whatever time a following error may take: a jump is an error in its cycle, and off, it is told.
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
            assert_eq!(crate::text::sentence(event, rig.machine.config()), text);
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

/// Words of an encoder in section `encoders`, disturbed: corrected, or told and no value.
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

/// A machine goes on from its state in the middle of all that.
#[test]
fn a_restored_machine_reads_on() {
    let mut rig = corrected();
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(300);
    rig.plant.drive(0).unwrap().disturb(1 << 24, 60);
    rig.run(20);
    rig.mirror();
    rig.run(300);
    assert_eq!((error(&rig), rig.int("x.encoder.errors")), (0, 60));
}

mod cable;
mod kept;
mod marks;
mod words;
mod zeros;

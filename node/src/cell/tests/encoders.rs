//! Tests formats of encoders, and the axes that read them.

use super::{HEAD, assert_said, good};
use lineshaft_core::axis::Wired;
use lineshaft_core::encoder::{Absolute, Form, Parity, PulseCheck, WordCode};

const SCALE: &str = "type: linear, scale: {increments: 4000, per: 100 mm}";
const REST: &str = "max_velocity: 1 m/s, max_acceleration: 1";

/// Returns a cell with these keys of an encoder `e`.
fn encoder(keys: &str) -> String {
    format!("{HEAD}encoders:\n  e: {{backend: plant, address: 0, {SCALE}, {keys}}}\n")
}

/// Returns a cell with an encoder `belt` and these keys of an axis `x` of that interface.
fn axis(interface: &str, keys: &str) -> String {
    let drive = format!("drive: {{backend: plant, address: 0, interface: {interface}}}");
    format!(
        "{HEAD}encoders: {{belt: {{backend: plant, address: 0, {SCALE}}}}}\naxes:\n  x: {{{SCALE}, {drive}, {REST}, {keys}}}\n"
    )
}

#[test]
fn words_of_an_encoder() {
    let read = |keys: &str| good(&encoder(keys)).machine.encoders[0].clone();
    assert_eq!(read("bits: 16").form, Form::Incremental(16));
    let check = read("index: {every: 100 mm, tolerance: 8 inc}").check;
    assert_eq!(check, Some(PulseCheck { every: 4000, tolerance: 8 }));
    assert_eq!(read("steps: 4096").form, Form::Absolute(Absolute::single_turn(4096)));
    let all = "steps: 360, turns: 3, code: gray, parity: odd, omitted: 76, overflow: false, error_correction: true, max_step: 0.25 mm";
    let expected = Absolute {
        steps: 360,
        turns: 3,
        code: WordCode::Gray,
        parity: Some(Parity::Odd),
        omitted: 76,
        overflow: false,
        corrects: true,
        max_step: Some(10),
    };
    assert_eq!(read(all).form, Form::Absolute(expected));
}

#[test]
fn keys_that_do_not_belong_together() {
    for (keys, sentence) in [
        ("turns: ^5", "turns is for an absolute encoder, which has steps"),
        ("bits: ^16, steps: 100", "bits is for an incremental encoder; this one has steps, leave it out"),
        (
            "steps: 100, index: ^{every: 1 mm, tolerance: 1 inc}",
            "index is for an incremental encoder; this one has steps, leave it out",
        ),
        ("parity: ^even", "parity is for an absolute encoder, which has steps"),
        ("steps: ^1", "steps is 1; 2..2147483647 is allowed"),
        ("steps: 8, code: ^grey", "code is `grey`; one of binary, gray is allowed, did you mean `gray`?"),
        ("index: ^{every: 1 mm}", "missing key `tolerance` in index"),
        ("index: {every: ^0 mm, tolerance: 1 inc}", "every is `0 mm`; a value above 0 is allowed"),
        ("steps: 8, max_step: ^0.001 mm", "max_step is `0.001 mm`, less than half an increment"),
    ] {
        assert_said(&encoder(keys), sentence);
    }
}

#[test]
fn what_an_axis_reads() {
    let read = |interface: &str, keys: &str| good(&axis(interface, keys)).machine.axes[0].wired;
    assert_eq!(read("position", "min_position: 0 mm"), Wired::Drive(Form::Incremental(64)));
    assert_eq!(read("position", "feedback: {bits: 32}"), Wired::Drive(Form::Incremental(32)));
    assert_eq!(read("velocity", "feedback: {encoder: belt}"), Wired::Encoder(0));
    let single = Wired::Drive(Form::Absolute(Absolute::single_turn(8192)));
    assert_eq!(read("position", "feedback: {steps: 8192}"), single);
    assert_eq!(good(&axis("velocity", "encodertype: 10")).machine.axes[0].parameters.encoder.encodertype, 10);
}

/// Homing needs the index of the encoder that the axis reads; another one would never be found.
#[test]
fn an_index_belongs_to_what_the_axis_reads() {
    let sim = "sim: {model: velocity, index: ^{every: 2.5 mm, at: 0.3 mm}}";
    assert_said(
        &axis("velocity", &format!("feedback: {{encoder: belt}}, {sim}")),
        "index belongs to entry `belt` of encoders, which the axis reads, give it there",
    );
    let own = sim.replace('^', "");
    good(&axis("velocity", &own));
    good(&axis("velocity", &format!("feedback: {{bits: 32}}, {own}")));
    // A drive that homes by itself uses its own index.
    good(&axis("velocity", &format!("feedback: {{encoder: belt}}, homing: {{in_drive: true}}, {own}")));
}

#[test]
fn sources_that_an_axis_cannot_read() {
    let own = "an encoder that a drive with interface position does not close its loop with";
    for (interface, keys, sentence) in [
        ("position", "encodertype: ^10", format!("encodertype 10 names {own}; 0, 1, 2, 5 and 9 are allowed")),
        ("position", "encodertype: ^3", format!("encodertype 3 names {own}; 0, 1, 2, 5 and 9 are allowed")),
        (
            "velocity",
            "encodertype: ^20",
            "encodertype 20 names an entry of section encoders that the cell does not have: 10 is the first one".to_owned(),
        ),
        ("position", "feedback: ^{encoder: belt}", format!("feedback of axis `x` names {own}")),
        ("velocity", "encodertype: ^7", "encodertype 7 is no type of encoder".to_owned()),
        (
            "velocity",
            "encodertype: ^102005",
            "encodertype 102005 names a node of a bus, which an entry of encoders does (key feedback of the axis reads it); the types 0 to 5, 9, 10, 20, 30 exist, for a \
             master 0, 1, 2, 5, 6, 10, 20, 30 and -1 to -999"
                .to_owned(),
        ),
        (
            "velocity",
            "feedback: {encoder: ^bellt}",
            "encoder is `bellt`; no encoder has that name, did you mean `belt`?".to_owned(),
        ),
        (
            "velocity",
            "feedback: {encoder: belt}, encodertype: ^1",
            "encodertype 1 names another encoder than key feedback of the axis or its wf.md4 does; one of them may choose"
                .to_owned(),
        ),
    ] {
        assert_said(&axis(interface, keys), &sentence);
    }
    let text = format!("{HEAD}axes:\n  v: {{{SCALE}, drive: virtual, {REST}, feedback: ^{{bits: 8}}}}\n");
    assert_said(&text, "feedback is for axes with a drive; axis v is virtual, leave it out");
}

/// Proves: MACS-ENC-14
#[test]
fn a_master_that_the_cell_has_not_or_that_is_the_axis_itself() {
    let axes = |keys: &str| {
        let virtual_axis = |name: &str| format!("  {name}: {{{SCALE}, drive: virtual, {REST}}}\n");
        let drive = "drive: {backend: plant, address: 0, interface: position}";
        let belt = format!("encoders: {{belt: {{backend: plant, address: 0, {SCALE}}}}}\n");
        let y = format!("  y: {{{SCALE}, {drive}, {REST}, mencodertype: {keys}}}\n");
        format!("{HEAD}{belt}axes:\n{}{y}{}", virtual_axis("x"), virtual_axis("z"))
    };
    for number in [0, 1, 2, 5, 6, -1, -3, 10] {
        assert_eq!(good(&axes(&number.to_string())).machine.axes[1].parameters.encoder.mencodertype, number);
    }
    let allowed = "0, 1, 2, 5, 6, -1, -3, 10 are allowed";
    for (number, wrong) in [
        (-2, "is the axis itself"),
        (-4, "is axis 4, and the cell has 3"),
        (20, "is entry 2 of encoders, and the cell has 1"),
    ] {
        assert_said(&axes(&format!("^{number}")), &format!("mencodertype {number} {wrong}; {allowed}"));
    }
}

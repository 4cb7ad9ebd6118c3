//! Tests the refusals of `--preset amkasyn` in cells without other problems.

use super::{HEAD, unmark};
use crate::cell::tables::Files;
use crate::cell::{Cell, Preset};
use crate::document::Document;

/// Nine axes, five encoders, ten inputs, eight outputs, five analog outputs, memory and tables; then the functions.
fn cell(functions: &str) -> String {
    let scale = "type: linear, scale: {increments: 1, per: 1 mm}";
    let axis = |n| format!("x{n}: {{{scale}, drive: virtual, max_velocity: 1, max_acceleration: 1}}");
    let encoder = |n| format!("e{n}: {{{scale}, backend: plant, address: {n}}}");
    let io = |letter: &'static str, kind: &'static str, count| {
        (0..count).map(move |n| format!("{letter}{n}: {{type: {kind}, backend: plant, address: {n}}}"))
    };
    let list = |entries: Vec<String>| entries.join(", ");
    let words = |count| vec!["0"; count].join(", ");
    format!(
        "{HEAD}axes: {{{}}}\nencoders: {{{}}}\nio: {{{}, v: {{type: di, output: q0}}}}\n\
         memory: {{w: {{type: i16}}, d: {{type: i32}}, l: {{type: i64}}, r: {{type: f64}}, b: {{type: bit}}, {}}}\n\
         tables: {{t48: {{form: words, words: [{}]}}, t49: {{form: words, words: [{}]}}, t256: {{form: words, words: [{}]}}, \
         t257: {{form: words, words: [{}]}}}}\nfunctions:\n{functions}",
        list((1..=9).map(axis).collect()),
        list((1..=5).map(encoder).collect()),
        list(io("d", "di", 10).chain(io("q", "do", 8)).chain(io("a", "ao", 5)).collect()),
        list((0..32).map(|n| format!("m{n}: {{type: i32}}")).collect()),
        words(48),
        words(49),
        words(256),
        words(257),
    )
}

/// Returns the problems with the preset, one per line, without the file name; the cell itself has none.
fn held(text: &str) -> String {
    let problems = |preset| Cell::of(Document::parse("c", text), &Files::None, preset).err();
    assert!(problems(None).is_none(), "{:?}", problems(None));
    let problems = problems(Some(Preset::Amkasyn)).map_or_else(String::new, |problems| problems.to_string());
    problems.lines().map(|line| line.strip_prefix("c:").unwrap_or(line)).collect::<Vec<_>>().join("\n")
}

#[track_caller]
fn assert_held(marked: &str, sentence: &str) {
    let (text, place) = unmark(&cell(marked));
    assert_eq!(held(&text), format!("{place}{sentence}"));
}

/// Proves: AMK-GEN-04, AMK-BCOM-02, AMK-CTX-01, AMK-INIT-02, AMK-SRC-04, AMK-SRC-05, AMK-SNK-01, AMK-SNK-02, AMK-SNK-03,
/// AMK-SNK-04, AMK-SNK-05, AMK-CAM-33, AMK-CAM-48, AMK-IMES-01, AMK-DIGDREH-04
#[test]
fn objects_without_address_in_the_source_are_refused_at_their_places() {
    for (text, sentence) in [
        ("{slot: ^16, type: dcopy, source: x1, sink: none}", "slot is 16; preset amkasyn allows 0..15"),
        (
            "{slot: 0, type: dcopy, source: ^x9.actual, sink: none}",
            "source is `x9.actual`, axis 9 of the cell; preset amkasyn allows axes 1..8",
        ),
        (
            "{slot: 0, type: dcopy, source: ^x9.command.velocity, sink: none}",
            "source is `x9.command.velocity`, axis 9 of the cell; preset amkasyn allows axes 1..8",
        ),
        (
            "{slot: 0, type: dcopy, source: ^machine.vmaster, sink: none}",
            "source is `machine.vmaster`, the virtual master; preset amkasyn allows an axis, an encoder or a sink",
        ),
        (
            "{slot: 0, type: dcopy, source: e1, sink: ^x9}",
            "sink is `x9`, axis 9 of the cell; preset amkasyn allows axes 1..8",
        ),
        (
            "{slot: 0, type: varsync, source: e1, sink: ^a0}",
            "sink is `a0`, an ao, for type varsync; preset amkasyn allows it for types dcopy and ecopy",
        ),
        ("{slot: 0, type: dcopy, source: ^r, sink: d}", "source is `r`, of type f64; preset amkasyn allows i16, i32"),
        ("{slot: 0, type: dcopy, source: d, sink: ^l}", "sink is `l`, of type i64; preset amkasyn allows i16, i32"),
        ("{slot: 0, type: digdreh, sink: ^w}", "sink is `w`, of type i16; preset amkasyn allows i32"),
        ("{slot: 0, type: cam, source: e1, sink: ^w}", "sink is `w`, of type i16; preset amkasyn allows i32"),
        ("{slot: 0, type: imes, source: e1, sink: ^d}", "sink is `d`, of type i32; preset amkasyn allows i16"),
        (
            "{slot: 0, type: imes, source: e1, inputs: ^[d0]}",
            "inputs has an entry; preset amkasyn allows none for type imes",
        ),
        (
            "{slot: 0, type: varsync, source: e1, word_addr: ^d}",
            "word_addr is `d`, of type i32; preset amkasyn allows i16",
        ),
        (
            "{slot: 0, type: varsync, source: e1, word_addr: ^x1.command.position}",
            "word_addr is `x1.command.position`; preset amkasyn allows a memory cell of type i16",
        ),
        (
            "{slot: 0, type: fgen, override_addr: ^d, cycle_increments: 1, accel: 1}",
            "override_addr is `d`, of type i32; preset amkasyn allows i16",
        ),
        (
            "{slot: 0, type: regl, source: w, gain_v: 1, src2_addr: ^w}",
            "src2_addr is `w`, of type i16; preset amkasyn allows i32",
        ),
        (
            "{slot: 0, type: regl, source: w, gain_v: 1, sink: ^w}",
            "sink is `w`, of type i16; preset amkasyn allows i32",
        ),
        (
            "{slot: 0, type: fgen, cycle_increments: 1, accel: 1, cycle_factor: ^66}",
            "cycle_factor is 66; preset amkasyn allows 1..65 for type fgen",
        ),
        (
            "{slot: 0, type: epos, velocity: 1, acceleration: 1, stop_decel: 1, drive_resolution: 1, cycle_factor: ^66}",
            "cycle_factor is 66; preset amkasyn allows 1..65 for type epos",
        ),
        (
            "{slot: 0, type: epos, acceleration: 1, stop_decel: 1, drive_resolution: 1, acc_override_mw: ^d}",
            "acc_override_mw is `d`, of type i32; preset amkasyn allows i16",
        ),
        (
            "{slot: 0, type: varsync, source: e1, sink: x1, on_axis_error: ^reset}",
            "on_axis_error is `reset`; preset amkasyn allows run",
        ),
        (
            "{slot: 0, type: cam, source: e1, cycle_factor: ^66}",
            "cycle_factor is 66; preset amkasyn allows 1..65 for type cam",
        ),
        ("{slot: 0, type: cam, source: e1, cams: [0, ^57]}", "cams[1] is 57; preset amkasyn allows 0..56"),
        ("{slot: 0, type: cam, source: e1, cams: ^[50, 7]}", "cams has 57 in all tracks; preset amkasyn allows 56"),
        (
            "{slot: 0, type: sidiff, tables: [^t49]}",
            "tables[0] is `t49`, which has 49 words; preset amkasyn allows 1..48",
        ),
        (
            "{slot: 0, type: binea, tracks: 1, tables: [^t257]}",
            "tables[0] is `t257`, which has 257 words; preset amkasyn allows 1..256",
        ),
    ] {
        assert_held(&format!("  f: {text}\n"), sentence);
    }
}

/// Proves: AMK-GEN-08, AMK-INIT-03, AMK-INIT-07, AMK-INIT-08, AMK-BCOM-05, AMK-BCOM-10, AMK-CTX-06
#[test]
fn lines_that_do_not_stand_side_by_side_in_a_byte_are_refused() {
    for (lines, sentence) in [
        (
            "[d0, ^d2]",
            "inputs[1] is at address 2 of `plant`; preset amkasyn allows address 1 of `plant` beside inputs[0]",
        ),
        (
            "[d1, none, ^d2]",
            "inputs[2] is at address 2 of `plant`; preset amkasyn allows address 3 of `plant` beside inputs[0]",
        ),
        (
            "[d7, ^d8]",
            "inputs[1] is at address 8 of `plant`; preset amkasyn allows none: the byte of inputs[0] ends before it",
        ),
        ("[none, ^d8]", "inputs[1] is at address 8 of `plant`, bit 0 of its byte; preset amkasyn allows bits 1..7"),
        ("[d0, ^b]", "inputs[1] is a memory cell; preset amkasyn allows a di, as inputs[0] is one"),
        ("[b, ^d1]", "inputs[1] is a di; preset amkasyn allows a memory cell, as inputs[0] is one"),
        ("[d0, ^{name: d1, inverted: true}]", "inputs[1].inverted is true; preset amkasyn allows false"),
    ] {
        assert_held(&format!("  f: {{slot: 0, type: varsync, source: e1, inputs: {lines}}}\n"), sentence);
    }
    let outputs = "  f: {slot: 0, type: imes, source: e1, outputs: [q1, ^b]}\n";
    assert_held(outputs, "outputs[1] is a memory cell; preset amkasyn allows a do, as outputs[0] is one");
    for lines in ["[d1, none, d3]", "[none, d9]", "[b, b]", "[v, d5, d6]", "[none, none]"] {
        let inputs = cell(&format!("  f: {{slot: 0, type: varsync, source: e1, inputs: {lines}}}\n"));
        assert_eq!(held(&inputs), "", "{lines}");
    }
}

/// Proves: AMK-SRC-02, AMK-SRC-03, AMK-SRC-06, AMK-SRC-07, AMK-SNK-03
#[test]
fn more_than_the_source_has_of_something_is_refused_at_the_first_one_too_many() {
    let all = |functions: Vec<String>| {
        let line = |(slot, function): (usize, &String)| format!("  f{slot}: {{slot: {slot}, {function}}}\n");
        functions.iter().enumerate().map(line).collect::<String>()
    };
    let encoders = |last: &str| {
        let read = ["e1", "e2.velocity", "e3", "e4", "e1", last];
        all(read.map(|source| format!("type: dcopy, source: {source}, sink: none")).to_vec())
    };
    assert_eq!(held(&cell(&encoders("e2"))), "");
    assert_held(&encoders("^e5"), "source is `e5`, encoder 5 of those that functions use; preset amkasyn allows 4");
    let outputs = |last: &str| {
        all(["a0", "a1", "a2", "a3", last].map(|sink| format!("type: ecopy, source: e1, sink: {sink}")).to_vec())
    };
    assert_held(&outputs("^a4"), "sink is `a4`, ao 5 of those that functions use; preset amkasyn allows 4");
    assert_eq!(held(&cell(&outputs("none"))), "");
    // 32 double words use all flags.
    let words = |word: &str| {
        let copy = |n| format!("type: varsync, source: m{n}, sink: m{}", n + 16);
        let mut functions: Vec<_> = (0..16).map(copy).collect();
        functions[15] += word;
        all(functions)
    };
    assert_eq!(held(&cell(&words(""))), "");
    let sentence = "word_addr is `w`, with which functions use 130 bytes of memory; preset amkasyn allows 128";
    assert_held(&words(", mode: 3, word_addr: ^w"), sentence);
}

/// Proves: AMK-GEN-01
#[test]
fn a_cycle_off_the_grid_is_refused() {
    let text = |cycle: &str| HEAD.replace("1 ms", cycle) + "axes: {}\n";
    for cycle in ["0.5 ms", "1.5 ms", "20 ms"] {
        assert_eq!(held(&text(cycle)), "", "{cycle}");
    }
    assert_eq!(held(&text("750 us")), "2:8: cycle is `750 us`; preset amkasyn allows multiples of 0.5 ms");
}

/// Proves: AMK-EPOS-44, AMK-EPOS-50
#[test]
fn search_of_an_epos_needs_a_cycle_of_1_to_9_ms() {
    let text = |ba: i64, cycle: &str, factor: u32| {
        let function = format!(
            "  f: {{slot: 0, type: epos, sink: x1, ba: {ba}, travel: 1, velocity: 1, acceleration: 1, stop_decel: 1, \
             drive_resolution: 1, cycle_factor: {factor}}}\n"
        );
        cell(&function).replace("cycle: 1 ms", cycle)
    };
    for (cycle, factor, time) in [("cycle: 0.5 ms", 1, "0.5"), ("cycle: 0.5 ms", 19, "9.5"), ("cycle: 10 ms", 1, "10")]
    {
        for ba in [2, 6] {
            let problems = held(&text(ba, cycle, factor));
            let sentence = format!(
                "ba is `{ba}`, substitutional, with {time} ms between two calls; preset amkasyn allows 1 ms to 9 ms"
            );
            assert!(problems.ends_with(&sentence) && problems.lines().count() == 1, "{problems}");
        }
        assert_eq!(held(&text(0, cycle, factor)), "", "relative");
    }
    for (cycle, factor) in [("cycle: 1 ms", 1), ("cycle: 0.5 ms", 2), ("cycle: 0.5 ms", 18), ("cycle: 9 ms", 1)] {
        assert_eq!(held(&text(2, cycle, factor)), "", "{cycle}");
    }
}

#[test]
fn all_excesses_of_the_preset_are_reported_at_once_for_a_valid_cell() {
    let text = cell("  f: {slot: 20, type: cam, source: x9, cams: [60, 61], tables: [t257], outputs: [q0, q0]}\n");
    let problems = Cell::of(Document::parse("c", text.clone()), &Files::None, Some(Preset::Amkasyn)).unwrap_err();
    assert_eq!(problems.to_string().lines().count(), 1, "{problems}");
    assert_eq!(held(&text.replace("[q0, q0]", "[q0, q1]")).lines().count(), 5);
    let at_bounds = "  f: {slot: 15, type: cam, source: x8, sink: d, cams: [28, 28], tables: [t256], outputs: [q0, q1], cycle_factor: 65}\n  \
                     g: {slot: 0, type: sidiff, sink: w, tables: [t48]}\n  \
                     h: {slot: 1, type: dcopy, source: x8.actual, sink: x7}\n";
    assert_eq!(held(&cell(at_bounds)), "");
}

/// A source reads one leader there, also for the signals of a master.
#[test]
fn a_master_of_several_is_none_of_the_source() {
    for source in ["sum", "sum.velocity"] {
        let function = format!("  f: {{slot: 0, type: dcopy, source: ^{source}, sink: none}}\n");
        assert_held(
            &format!("{function}masters: {{sum: {{add: [e1]}}}}\n"),
            &format!("source is `{source}`, a master of several; preset amkasyn allows an axis, an encoder or a sink"),
        );
    }
}

//! Tests sections `functions` and `tables`.

use super::sections::three_axes;
use super::{HEAD, assert_said, good, said};
use lineshaft_core::config::{Line, SinkConfig, SourceConfig};
use lineshaft_core::function::{Kind, OnAxisError, Width};
use lineshaft_core::object::{Leader, Object};

/// Objects before the functions: two outputs, an input, memory, a table. The functions begin in line 14.
const OBJECTS: &str = "io: {lamp: {type: do, backend: plant, address: 0}, aa: {type: ao, backend: plant, address: 0}, \
                       go: {type: di, backend: plant, address: 0}}\n\
                       memory: {feed: {type: i16}, flag: {type: bit}}\n\
                       tables: {t: {form: words, words: [2, 0, 0, 0, 100, 0, 0, 0]}}\nfunctions:\n";

fn cell(functions: &str) -> String {
    three_axes(&format!("{OBJECTS}{functions}"))
}

/// Proves: AMK-GEN-07, AMK-GEN-08, AMK-INIT-01, AMK-INIT-02, AMK-INIT-05, AMK-INIT-06, AMK-INIT-07, AMK-INIT-08, AMK-BCOM-05, AMK-BCOM-09, AMK-BCOM-12, AMK-BCOM-13,
/// AMK-BCOM-14, AMK-BCOM-15, AMK-CTX-06, AMK-VARSYNC-07, AMK-VARSYNC-08
#[test]
fn a_slot_knows_what_it_is_wired_to() {
    let cell = good(&cell(
        "  late: {slot: 9, type: dcopy, source: early.sink, sink: feed, source_bits: 16, cycle_factor: 4}\n  \
         early: {slot: 2, type: varsync, source: x.actual, sink: turret, inputs: [go, none, {name: flag, inverted: true}], \
         outputs: [lamp], mode: 1, m8: -3, word_addr: feed, on_axis_error: reset}\n",
    ));
    let [early, late] = cell.machine.slots.as_slice() else { panic!("two slots") };
    assert_eq!((early.name.as_str(), early.number, early.kind), ("early", 2, Kind::Varsync));
    assert_eq!((&early.source, early.sink), (&SourceConfig::Lead(Leader::AxisActual(1)), SinkConfig::Axis(2)));
    let line = |object, inverted| Some(Line { object, inverted });
    assert_eq!(early.inputs[..4], [line(Object::Io(2), false), None, line(Object::Memory(1), true), None]);
    assert_eq!((early.outputs[0], early.words[0].as_deref()), (line(Object::Io(0), false), Some("feed")));
    assert_eq!((early.on_axis_error, &early.values[..]), (OnAxisError::Reset, &[1, 0, 0, 0, 0, 0, 0, 0, 0, 0, -3][..]));
    // The sink that it reads has an index in the order of the slots.
    assert_eq!((late.number, &late.source), (9, &SourceConfig::Lead(Leader::Sink(0))));
    assert_eq!((late.source_width, late.sink_width, late.factor), (Width::W16, Width::W64, 4));
    assert_eq!(late.call_ns(cell.machine.cycle_ns), 4_000_000);
}

/// Proves: AMK-FGEN-12, AMK-FGEN-14, AMK-REGL-18, AMK-REGL-19, AMK-EPOS-57, AMK-EPOS-58
#[test]
fn a_slot_knows_the_words_that_it_reads() {
    let cell = good(&cell(
        "  made: {slot: 1, type: fgen, override_addr: feed, cycle_increments: 9, accel: 1, pos_limit: [7, 8]}\n  \
         held: {slot: 2, type: regl, source: x.actual, gain_v: 1, src2_addr: made.sink}\n  \
         moved: {slot: 3, type: epos, acceleration: 1, stop_decel: 1, drive_resolution: 1, acc_override_mw: feed}\n",
    ));
    let [made, held, moved] = cell.machine.slots.as_slice() else { panic!("three slots") };
    assert_eq!(made.words, [Some("feed".into()), None]);
    assert_eq!(held.words, [None, Some("made.sink".into())]);
    assert_eq!(moved.words, [None, Some("feed".into())]);
    assert_eq!(made.values[7..], [7, 8, 0, 0, 0, 0, 0, 0]);
}

#[test]
fn field_with_a_physical_unit_takes_a_quantity() {
    let cell = good(&cell("  fan: {slot: 1, type: digdreh, sink: none, speed: 1000 rpm}\n"));
    assert_eq!(cell.machine.slots[0].values[..], [10_000_000, 0]);
}

/// Proves: AMK-VARSYNC-09, AMK-BINEA-06, AMK-BINEA-09, AMK-CAM-28, AMK-CAM-30, AMK-CAM-47
#[test]
fn invalid_functions_are_refused_at_their_places() {
    for (text, sentence) in [
        ("{slot: ^256, type: dcopy, source: x, sink: none}", "slot is 256; 0..255 is allowed"),
        ("^{type: dcopy, source: x, sink: none}", "missing key `slot` in function `f`"),
        ("^{slot: 1}", "missing key `type` in function `f`"),
        (
            "{slot: 1, type: ^camm}",
            "type is `camm`; dcopy, ecopy, sidiff, varsync, digdreh, imes, binea, cam, fipw, fipz, xfipw, dfkt, fgen, regl, epos, apsf is allowed, did you mean `cam`?",
        ),
        ("^{slot: 1, type: dcopy, sink: none}", "function `f` has no source; type dcopy reads one"),
        (
            "^{slot: 1, type: dcopy, source: x}",
            "function `f` has no sink; type dcopy writes one, `sink: none` keeps the value for other functions",
        ),
        ("{slot: 1, type: digdreh, source: ^x}", "type digdreh reads no source"),
        (
            "{slot: 1, type: cam, sf_cycle: ^100 ms}",
            "sf_cycle is `100 ms`; a multiple of 0.5 ms is allowed, 0..131 times",
        ),
        (
            "{slot: 1, type: cam, sf_cycle: ^1.2 ms}",
            "sf_cycle is `1.2 ms`; a multiple of 0.5 ms is allowed, 0..131 times",
        ),
        (
            "{slot: 1, type: cam, sf_cycle: ^3 rpm}",
            "sf_cycle is `3 rpm`; a multiple of 0.5 ms is allowed, 0..131 times",
        ),
        ("{slot: 1, type: binea, sink: ^feed}", "type binea writes no sink"),
        ("{slot: 1, type: imes, source: ^x}", "type imes measures on an encoder; source is something else"),
        ("{slot: 1, type: cam, sink: ^x}", "type cam moves no axis"),
        (
            "{slot: 1, type: dcopy, source: ^feeed, sink: none}",
            "source is `feeed`; no axis, encoder, input or output, memory cell, function, master has that name, did you mean `feed`?",
        ),
        (
            "{slot: 1, type: dcopy, source: ^x.comand, sink: none}",
            "source is `x.comand`; no signal has that name, `lineshaft signals CELL` lists them",
        ),
        ("{slot: 1, type: dcopy, source: ^f, sink: none}", "source is `f`, a function; its sink is read, `f.sink`"),
        (
            "{slot: 1, type: dcopy, source: x, sink: ^lamp}",
            "sink is `lamp`, which is no ao; an axis, a memory cell of numbers, an ao or none is allowed",
        ),
        (
            "{slot: 1, type: dcopy, source: x, sink: ^flag}",
            "sink is `flag`, which is a bit; an axis, a memory cell of numbers, an ao or none is allowed",
        ),
        ("{slot: 1, type: dcopy, source: x, sink: none, source_bits: ^24}", "source_bits is 24; 16, 32, 64 is allowed"),
        ("{slot: 1, type: dcopy, source: x, sink: none, source_bits: ^8}", "source_bits is 8; 16, 32, 64 is allowed"),
        ("{slot: 1, type: dcopy, source: x, sink: none, sink_bits: ^-1}", "sink_bits is -1; 16, 32, 64 is allowed"),
        ("{slot: 1, type: dcopy, source: x, sink: none, sink_bits: ^128}", "sink_bits is 128; 16, 32, 64 is allowed"),
        ("{slot: 1, type: dcopy, source: x, sink: none, sink_bits: ^all}", "sink_bits is all; 16, 32, 64 is allowed"),
        ("{slot: 1, type: dcopy, source: x, sink: none, ^mult: 3}", "unknown key `mult` in function `f`"),
        ("{slot: 1, type: dcopy, source: x, sink: none, mode: ^2}", "mode is 2; 0..1 is allowed"),
        ("{slot: 1, type: ecopy, sink: none, inputs: ^[go, flag]}", "inputs has 2 entries; type ecopy has E1"),
        ("{slot: 1, type: ecopy, sink: none, inputs: [^lamp]}", "`lamp` is no di and no memory cell of type bit"),
        ("{slot: 1, type: ecopy, sink: none, outputs: [^feed]}", "`feed` is no do and no memory cell of type bit"),
        ("{slot: 1, type: ecopy, sink: none, cycle_factor: ^0}", "cycle_factor is 0; 1..255 is allowed"),
        ("{slot: 1, type: binea, tables: [^tt]}", "tables[0] is `tt`; no table has that name, there is t"),
        ("{slot: 1, type: binea, tables: ^[t, t]}", "tables has 2 entries; at most 1 are possible"),
        ("{slot: 1, type: binea, ba: ^3}", "ba is 3; 0..2 is allowed"),
        ("{slot: 1, type: cam, ba: ^-1}", "ba is -1; 0..2 is allowed"),
        ("{slot: 1, type: cam, ^fct: 0}", "unknown key `fct` in function `f`"),
        ("{slot: 1, type: binea, mode: ^[0, 0, 0, 0, 0, 0, 0, 0, 0]}", "mode has 9 entries; at most 8 are possible"),
    ] {
        assert_said(&cell(&format!("  f: {text}\n")), sentence);
    }
    assert_said(
        &cell("  ^f: {slot: 1, type: digdreh, sink: x}\n"),
        "type digdreh gives a speed in rpm; its sink `x` is no rotary axis",
    );
}

/// Proves: AMK-GEN-09
#[test]
fn what_two_would_write_is_refused_with_both_places() {
    for (second, sentence) in [
        ("{slot: ^1, type: dcopy, source: x, sink: none}", "slot 1 is taken already, at 14:13"),
        ("{slot: 2, type: dcopy, source: x, sink: ^feed}", "what writes `feed` is taken already, at 14:57"),
        ("{slot: 2, type: ecopy, sink: none, outputs: [^lamp]}", "output `lamp` is taken already, at 14:73"),
    ] {
        let first = "  f: {slot: 1, type: ecopy, source: x,            sink: feed, outputs: [lamp]}\n";
        let text = cell(&format!("{first}  g: {second}\n"));
        assert_said(&text, sentence);
    }
    // A parameter that names the output by its number counts as well.
    let text = cell("  f: {slot: 1, type: ecopy, sink: none, outputs: [lamp]}\n");
    assert_said(
        &format!("{text}machine: {{o_error: ^1}}\n"),
        "o_error names output 1, `lamp`, which has another function, at 14:51, give it an output of its own",
    );
}

/// Proves: AMK-INIT-09, AMK-BCOM-16
#[test]
fn tables_have_numbers_of_their_form() {
    let table = |text: &str| format!("{HEAD}tables: {{t: {text}}}\n");
    let tables = |text: &str| good(&table(text)).machine.tables;
    assert_eq!(tables("{form: y, points: [0, 1000, 4000]}")[0].table.y(), [0, 1000, 4000]);
    let knife = tables("{form: xy, points: [[0, 0], [5000, 1200]]}");
    assert_eq!((knife[0].table.x(), knife[0].table.y()), (&[0, 5000][..], &[0, 1200][..]));
    for (text, sentence) in [
        ("^{form: y}", "table `t` has no numbers; points or csv is expected"),
        ("{form: ^z, points: [0]}", "form is `z`; one of y, xy, words is allowed"),
        ("{form: words, words: ^[0, 65536]}", "word 1 is 65536; -32768 to 65535 is possible"),
        ("{form: xy, points: [^[0, 0, 0]]}", "a point of form xy has 3 numbers; [master, slave] is expected"),
        ("{form: xy, points: [[0, 0], [5, 1], ^[5, 2]]}", "place 5 is not after 5, the one before it; places rise"),
        ("{form: y, points: [0, ^1.5]}", "points[1] is `1.5`; a whole number -2147483648..2147483647 is allowed"),
        ("{form: y, csv: ^long.csv}", "cannot read `long.csv`: a cell without a file has no files beside it"),
        ("{form: y, points: [0], csv: ^a.csv}", "csv stands beside points; one of them is expected"),
    ] {
        assert_said(&table(text), sentence);
    }
}

#[test]
fn table_file_in_the_folder_of_the_cell_is_read_and_errors_have_its_lines() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cell.yaml");
    std::fs::write(&path, format!("{HEAD}tables: {{long: {{form: y, csv: long.csv}}}}\n")).unwrap();
    std::fs::write(folder.path().join("long.csv"), "0\n1000\n4000\n").unwrap();
    let read = crate::cell::Cell::load(&path).unwrap();
    assert_eq!(read.machine.tables[0].table.y(), [0, 1000, 4000]);
    // The recording contains the file.
    let again =
        crate::cell::Cell::parse_recorded("cell.yaml", read.text.clone(), read.files_text().as_deref()).unwrap();
    assert_eq!(again.machine.tables, read.machine.tables);
    std::fs::write(folder.path().join("long.csv"), "0\nten\n").unwrap();
    let problems = crate::cell::Cell::load(&path).unwrap_err().to_string();
    assert!(problems.contains("long.csv, line 2, column 1: `ten` is no whole number of 32 bits"), "{problems}");
}

/// Returns the problems of functions in slots 0, 1, ... from source to sink; they begin in line 14.
fn links(links: &[(&str, &str)]) -> String {
    let line = |(slot, (source, sink)): (usize, &(&str, &str))| {
        format!("  f{slot}: {{slot: {slot}, type: varsync, source: {source}, sink: {sink}}}\n")
    };
    let text = cell(&links.iter().enumerate().map(line).collect::<String>());
    crate::cell::Cell::parse("cell.yaml", &*text).map_or_else(|_| said(&text), |_| String::new())
}

#[test]
fn axes_that_follow_each_other_in_a_loop_are_named() {
    let hint = |name: &str| format!(", follow `{name}.actual`");
    let says = "axes follow each other's commands in a loop:";
    assert_eq!(links(&[("line", "x"), ("x.command.position", "turret")]), "");
    assert_eq!(
        links(&[("x.command", "turret"), ("turret.command.position", "x")]),
        format!("15:3: {says} x -> turret -> x{}", hint("turret"))
    );
    assert_eq!(links(&[("x.turns", "x")]), format!("14:3: {says} x -> x{}", hint("x")));
    assert_eq!(
        links(&[("line", "x"), ("x", "turret"), ("turret.target.position", "line")]),
        format!("16:3: {says} line -> x -> turret -> line{}", hint("turret"))
    );
    // Through the outputs of other functions, also of those further down.
    assert_eq!(
        links(&[("f2.sink", "x"), ("x", "turret"), ("turret", "none")]),
        format!("15:3: {says} turret -> x -> turret{}", hint("x"))
    );
}

#[test]
fn an_input_makes_no_loop() {
    assert_eq!(links(&[("x.actual", "turret"), ("turret", "x")]), "");
    assert_eq!(links(&[("x.actual.position", "x")]), "");
    assert_eq!(links(&[("f1.sink", "none"), ("f0.sink", "x")]), "");
}

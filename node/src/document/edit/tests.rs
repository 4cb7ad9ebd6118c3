//! Tests edits of layouts that users write.

use super::*;
use crate::document::Document;
use proptest::prelude::*;

const PATH: [&str; 2] = ["axes", "x"];

fn set(text: &str, entries: &[(&str, &str)]) -> Result<String, Fixed> {
    let neighbours: Vec<&str> = entries.iter().map(|(key, _)| *key).collect();
    Source::parse(text)?.set(&PATH, entries, &neighbours)
}

#[track_caller]
fn edits(text: &str, entries: &[(&str, &str)], expected: &str) {
    assert_eq!(set(text, entries).as_deref(), Ok(expected));
}

#[track_caller]
fn refused(text: &str, entries: &[(&str, &str)], sentence: &str) {
    assert_eq!(set(text, entries).unwrap_err().to_string(), sentence);
}

const BLOCK: &str = "\
# A cell
axes:
  # of the line
  x:
    type: rotary
    kprop: 30    # stiff enough
    drive: {a: 1,
            b: 2} # two lines

    sim:
      model: motor
  y:
    kprop: 30
";

#[test]
fn value_is_replaced_in_place() {
    edits(BLOCK, &[("kprop", "131")], &BLOCK.replacen("30    #", "131    #", 1));
}

#[test]
fn entries_that_are_missing_stand_behind_their_neighbour() {
    let expected = BLOCK.replacen("30    # stiff enough\n", "30    # stiff enough\n    kder: 5\n    kint: 2\n", 1);
    edits(BLOCK, &[("kprop", "30"), ("kder", "5"), ("kint", "2")], &expected);
}

#[test]
fn without_a_neighbour_they_stand_behind_the_last_plain_value() {
    let text = "axes:\n  x:\n    type: rotary\n    sim: {model: ideal}\n  y: {}\n";
    edits(text, &[("kder", "5")], &text.replacen("rotary\n", "rotary\n    kder: 5\n", 1));
    // Without a plain value, it is inserted after a mapping in braces.
    let text = "axes:\n  x:\n    sim: {model: ideal}\n    loop:\n      a: 1\n";
    edits(text, &[("kder", "5")], &text.replacen("ideal}\n", "ideal}\n    kder: 5\n", 1));
}

#[test]
fn a_section_takes_its_entries() {
    let text = "axes:\n  x:\n    type: a\n    position_loop:\n      kv: 16.667 # 1/s\n";
    edits(text, &[("position_loop.kv", "72.4")], &text.replace("16.667", "72.4"));
    let text = "axes:\n  x:\n    position_loop: {kv: 16.667}\n";
    edits(text, &[("position_loop.kv", "72.4")], &text.replace("16.667", "72.4"));
    let text = "axes:\n  x:\n    position_loop.kv: 16.667\n";
    edits(text, &[("position_loop.kv", "72.4")], &text.replace("16.667", "72.4"));
    let text = "axes:\n  x:\n    position_loop: {}\n";
    edits(text, &[("position_loop.kv", "72.4")], "axes:\n  x:\n    position_loop: {kv: 72.4}\n");
    let text = "axes:\n  x:\n    velocity_loop:\n      bandwidth: 3\n    type: a\n";
    edits(text, &[("velocity_loop.a", "1")], &text.replace("3\n", "3\n      a: 1\n"));
    edits(text, &[("position_loop.kv", "72.4")], &text.replace("a\n", "a\n    position_loop.kv: 72.4\n"));
}

#[test]
fn braces_take_entries_behind_a_comma() {
    edits(
        "axes: {x: {type: rotary, kprop: 30}, y: {}}\n",
        &[("kprop", "131"), ("kder", "5"), ("kint", "2")],
        "axes: {x: {type: rotary, kprop: 131, kder: 5, kint: 2}, y: {}}\n",
    );
    let text = "axes:\n  x:\n    {type: rotary, # of a kind\n     unit: deg, # the last one\n    }\n";
    edits(text, &[("kder", "5")], &text.replace("deg,", "deg, kder: 5,"));
}

#[test]
fn ends_of_lines_are_kept() {
    let text = BLOCK.replace('\n', "\r\n");
    let expected = text.replacen("30    # stiff enough\r\n", "131    # stiff enough\r\n    kder: 5\r\n", 1);
    edits(&text, &[("kprop", "131"), ("kder", "5")], &expected);
    edits("axes:\r\n  x:\r\n    a: 1", &[("b", "2")], "axes:\r\n  x:\r\n    a: 1\r\n    b: 2");
    edits("axes:\n  x:\n    a: 1 # last", &[("b", "2")], "axes:\n  x:\n    a: 1 # last\n    b: 2");
}

#[test]
fn letters_of_several_bytes_and_a_byte_order_mark_count_as_one() {
    let text =
        "\u{feff}# \u{e4}\u{20ac}\u{1f600}\naxes:\n  x:\n    name: \"\u{e4}\" # \u{20ac}\n    kprop: 30 # \u{e4}\n";
    edits(text, &[("kprop", "7"), ("kder", "5")], &text.replace("30 # \u{e4}\n", "7 # \u{e4}\n    kder: 5\n"));
}

#[test]
fn quotes_and_odd_spaces_are_no_hindrance() {
    edits("axes:\n  x:\n    'kprop' :   \"30\"   # q\n", &[("kprop", "7")], "axes:\n  x:\n    'kprop' :   7   # q\n");
    edits(
        "axes:\n  x:\n    n: 'it''s # \"'   # q\n",
        &[("k", "7")],
        "axes:\n  x:\n    n: 'it''s # \"'   # q\n    k: 7\n",
    );
    edits(
        "axes:\n  x: {n: \"a \\\" b\" # q }\n   }\n",
        &[("k", "7")],
        "axes:\n  x: {n: \"a \\\" b\", k: 7 # q }\n   }\n",
    );
    edits(
        "axes:\n  x:\n    s: {a: 1} # c }\n\n  y: 1\n",
        &[("k", "7")],
        "axes:\n  x:\n    s: {a: 1} # c }\n    k: 7\n\n  y: 1\n",
    );
    edits("axes:\n  x:\n    kprop:\n      30\n", &[("kprop", "7")], "axes:\n  x:\n    kprop:\n      7\n");
    edits(
        "---\naxes: # a\n\n\n x:  # b\n\n  a: 1\n...\n",
        &[("b", "2")],
        "---\naxes: # a\n\n\n x:  # b\n\n  a: 1\n  b: 2\n...\n",
    );
}

#[test]
fn what_an_anchor_carries_elsewhere_is_refused_with_its_line() {
    let elsewhere = "what stands here has an anchor and is repeated elsewhere, where it would change, too";
    let text = "axes:\n  x: &m\n    kprop: 30\n  y: *m\n";
    refused(text, &[("kprop", "7")], &format!("line 2: {elsewhere}"));
    let text = "axes:\n  y: &m\n    kprop: 30\n  x: *m\n";
    refused(text, &[("kprop", "7")], "line 4: an alias stands here; what it repeats belongs to other places, too");
    let text = "axes:\n  x:\n    kprop: &k 30\n  y: {kprop: *k}\n";
    refused(text, &[("kprop", "7")], &format!("line 3: {elsewhere}"));
    let text = "gain: &k 30\naxes:\n  x: {kprop: *k}\n";
    refused(text, &[("kprop", "7")], "line 3: an alias stands here; what it repeats belongs to other places, too");
    // An anchor without references is harmless.
    edits("axes:\n  x: &m {a: 1} # c }\n", &[("b", "7")], "axes:\n  x: &m {a: 1, b: 7} # c }\n");
    edits("axes:\n  x:\n    l: &m {} # c }\n", &[("l.b", "7")], "axes:\n  x:\n    l: &m {b: 7} # c }\n");
    edits("axes:\n  x: &m\n    kprop: &k 30\n", &[("kprop", "7")], "axes:\n  x: &m\n    kprop: &k 7\n");
}

#[test]
fn what_has_no_place_is_refused_with_its_line() {
    refused("axes:\n  y: {a: 1}\n", &[("kprop", "7")], "line 2: there is no entry `x`");
    refused("axes:\n  x:\n", &[("kprop", "7")], "line 2: a mapping is expected here");
    refused("axes:\n  x:\n    kprop: |\n      30\n", &[("kprop", "7")], "line 3: the value does not stand on its line");
    refused("axes:\n  x:\n    kprop:\n", &[("kprop", "7")], "line 3: the value does not stand on its line");
    refused(
        "axes:\n  x:\n    kprop: [30]\n",
        &[("kprop", "7")],
        "line 3: a list or a mapping stands here, where a value is to be set",
    );
    refused("axes:\n  x: {a: 1, b}\n", &[("kprop", "7")], "line 2: the last entry in these braces has no value");
    refused(
        "axes:\n  x:\n    a:\n      b: 1\n",
        &[("kprop", "7")],
        "line 3: no entry of this mapping ends on its line, so that another one could go behind it",
    );
    refused("axes:\n  x:\n    ? a\n    : 1\n", &[("kprop", "7")], "line 3: the entry does not begin its line");
}

#[test]
fn the_line_of_an_entry_is_found() {
    let source = Source::parse("axes:\n  x:\n    wf: {md22: 1}\n    wf.md5: 2\n").unwrap();
    assert_eq!(source.line_of(&PATH, "wf.md22"), Some(3));
    assert_eq!(source.line_of(&PATH, "wf.md5"), Some(4));
    assert_eq!(source.line_of(&PATH, "wf.md1"), None);
}

/// An axis in one of many layouts, with its values.
fn layout() -> impl Strategy<Value = (String, Vec<(String, String)>)> {
    let entry = ("[a-d]", 0_u32..1000, prop::sample::select(vec!["", " # c: {", "  # \u{e4}"]));
    let entries = prop::collection::vec(entry, 1..5);
    let style = (any::<bool>(), prop::sample::select(vec!["\n", "\r\n"]), 1_usize..6, any::<bool>(), any::<bool>());
    (entries, style).prop_map(|(entries, (braces, end, indentation, last, gap))| {
        let mut seen = BTreeSet::new();
        let entries: Vec<_> = entries.into_iter().filter(|entry| seen.insert(entry.0.clone())).collect();
        let pad = " ".repeat(indentation);
        let mut text = format!("axes:{end}{pad}w: 1{end}{pad}x:");
        if braces {
            text += &format!(" {{{end}");
            entries.iter().for_each(|(key, value, note)| text += &format!("{pad}{pad}{key}: {value} ,{note}{end}"));
            text += &format!("{pad}{pad}}}");
        } else {
            for (key, value, note) in &entries {
                text += &format!("{end}{pad}{pad}{key}: {value}{note}");
                text += if gap { end } else { "" };
            }
        }
        text += &if last { format!("{end}{pad}z: 3{end}") } else { String::new() };
        (text, entries.into_iter().map(|(key, value, _)| (key, value.to_string())).collect())
    })
}

/// Returns the values of the axis, and the rest of a document.
fn read(text: &str) -> (Vec<(String, String)>, Vec<String>) {
    let document = Document::parse("t", text);
    let root = document.root("t").unwrap();
    let axes = root.entries().unwrap().remove(0).1.entries().unwrap();
    let (mut own, mut others) = (Vec::new(), Vec::new());
    for (key, value) in axes {
        if key.peek() != Some("x") {
            others.push(format!("{:?} {:?}", key.peek(), value.peek()));
            continue;
        }
        own = value
            .entries()
            .unwrap()
            .iter()
            .map(|(k, v)| (k.peek().unwrap().to_owned(), v.peek().unwrap().to_owned()))
            .collect();
    }
    assert!(document.problems().is_empty(), "{}", document.problems());
    (own, others)
}

proptest! {
    /// The axis has its old values except those that were set; comments and all other lines stay.
    #[test]
    fn only_what_is_set_changes(
        (text, values) in layout(),
        wanted in prop::collection::btree_map("[a-h]", 0_u32..1000, 1..5),
    ) {
        let wanted: Vec<(String, String)> = wanted.into_iter().map(|(k, v)| (k, v.to_string())).collect();
        let entries: Vec<(&str, &str)> = wanted.iter().map(|(k, v)| (k.as_str(), v.as_str())).collect();
        let new = set(&text, &entries).unwrap();
        let (own, others) = read(&new);
        prop_assert_eq!(others, read(&text).1);
        for (key, value) in &own {
            let expected = wanted.iter().chain(&values).find(|(known, _)| known == key).map(|(_, value)| value);
            prop_assert_eq!(Some(value), expected, "{}", key);
        }
        for (key, _) in wanted.iter().chain(&values) {
            prop_assert!(own.iter().any(|(known, _)| known == key), "{} is not in {}", key, new);
        }
        prop_assert_eq!(new.matches('#').count(), text.matches('#').count());
        prop_assert_eq!(new.matches('\r').count() == new.matches('\n').count(), text.contains('\r'));
        // Setting the same values again changes nothing.
        prop_assert_eq!(set(&new, &entries).unwrap(), new);
    }
}

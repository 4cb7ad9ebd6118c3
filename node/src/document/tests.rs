//! Tests the exact texts of problems, and malicious documents.

use super::*;
use lineshaft_core::unit::{Dimension, Fraction, Quantity, Unit};
use proptest::prelude::*;

/// Reads `text` with `read` and returns the problems.
fn problems(text: &str, read: impl FnOnce(Value<'_>)) -> String {
    let document = Document::parse("t.yaml", text);
    if let Some(root) = document.root("the file") {
        read(root);
    }
    document.into_problems().to_string()
}

/// Returns the problems of reading the key `k` of a mapping.
fn problem_of(text: &str, read: impl FnOnce(Value<'_>)) -> String {
    problems(text, |root| {
        let mut map = root.map("the file").unwrap();
        read(map.required("k").unwrap());
        map.finish();
    })
}

fn good<T>(text: &str, read: impl Fn(Value<'_>) -> Option<T>) -> T {
    let mut result = None;
    assert_eq!(problem_of(&format!("k: {text}"), |value| result = read(value)), "", "{text}");
    result.unwrap_or_else(|| panic!("{text}"))
}

fn bad<T>(text: &str, read: impl Fn(Value<'_>) -> Option<T>) -> String {
    let mut none = false;
    let said = problem_of(&format!("k: {text}"), |value| none = read(value).is_none());
    assert!(none, "{text} was read");
    said.strip_prefix("t.yaml:1:")
        .and_then(|said| said.strip_suffix('\n'))
        .unwrap_or_else(|| panic!("{said}"))
        .to_owned()
}

fn time(text: &str) -> Quantity {
    Quantity::parse(text, &[Dimension::Time]).unwrap()
}

#[test]
fn scalars_stay_as_written() {
    for text in ["1 ms", "1e3", "0x10", "yes", "'quoted text'", "\"a\\tb\"", "socketcan:can0"] {
        let expected = text.trim_matches(['\'', '"']).replace("\\t", "\t");
        assert_eq!(good(text, |value| value.text().map(str::to_owned)), expected);
    }
}

#[test]
fn nothing_has_three_spellings() {
    for text in ["", "~", "null", "# a comment"] {
        assert!(good(text, |value| Some(value.is_null())), "{text}");
        assert!(good(text, |value| value.list().map(|list| list.is_empty())));
    }
    assert!(!good("''", |value| Some(value.is_null())));
    assert_eq!(bad("", |value| value.text().map(drop)), "2: k has no value; a text is expected");
    assert_eq!(
        bad("~", |value| value.quantity(&[Dimension::Time], &Allowed::Any)),
        "4: k has no value; a time is expected"
    );
}

#[test]
fn booleans_are_true_and_false() {
    assert!(good("true", |value| value.boolean()));
    assert!(!good("false", |value| value.boolean()));
    let said = |text| bad(text, |value| value.boolean());
    assert_eq!(said("yes"), "4: k is `yes`; true or false is allowed, write `true`");
    assert_eq!(said("Off"), "4: k is `Off`; true or false is allowed, write `false`");
    assert_eq!(said("'true'"), "4: k is `true`; true or false is allowed, write it without quotes");
    assert_eq!(said("maybe"), "4: k is `maybe`; true or false is allowed");
    assert_eq!(said("[true]"), "4: k is a list; true or false is expected");
}

#[test]
fn integers_are_whole_and_in_range() {
    for (text, value) in [("64", 64), ("-5", -5), ("+7", 7), ("1e6", 1_000_000), ("5.0", 5), ("0x1F", 31), ("0o17", 15)]
    {
        assert_eq!(good(text, |v| v.integer(i64::MIN..=i64::MAX)), value, "{text}");
    }
    assert_eq!(good("18446744073709551615", |value| value.integer(0..=u64::MAX)), u64::MAX);
    let said = |text| bad(text, |value| value.integer(1..=64_u8));
    assert_eq!(said("70"), "4: k is 70; 1..64 is allowed");
    assert_eq!(said("-1"), "4: k is -1; 1..64 is allowed");
    assert_eq!(said("1e99"), "4: k is `1e99`; 1..64 is allowed");
    assert_eq!(said("1.5"), "4: k is `1.5`; a whole number 1..64 is allowed");
    assert_eq!(said("'16'"), "4: k is `16`; a whole number 1..64 is allowed, write it without quotes");
    assert_eq!(said("16 mm"), "4: k is `16 mm`; a whole number 1..64 is allowed, a unit is not allowed here");
    assert_eq!(said("16 apples"), "4: k is `16 apples`; a whole number 1..64 is allowed");
    assert_eq!(said("0x-1"), "4: k is `0x-1`; a whole number 1..64 is allowed");
    assert_eq!(said("{a: 1}"), "4: k is a mapping; a whole number is expected");
}

#[test]
fn numbers_are_finite() {
    assert_eq!(good("-1.5e-300", |value| value.number(f64::NEG_INFINITY..=f64::INFINITY)), -1.5e-300);
    let said = |text| bad(text, |value| value.number(0.0..=1.5));
    assert_eq!(said("1.6"), "4: k is 1.6; 0..1.5 is allowed");
    assert_eq!(said(".nan"), "4: k is `.nan`; a finite number is expected");
    assert_eq!(said("inf"), "4: k is `inf`; a finite number is expected");
    assert_eq!(said("1e999"), "4: k is `1e999`; a finite number is expected");
    assert_eq!(said("0,8"), "4: k is `0,8`; a finite number is expected, write a decimal point, not a comma");
    assert_eq!(bad("-1", |value| value.number(0.0..=f64::INFINITY)), "4: k is -1; 0 and above is allowed");
    assert_eq!(bad("1", |value| value.number(f64::NEG_INFINITY..=0.5)), "4: k is 1; 0.5 and below is allowed");
}

#[test]
fn fractions_and_quantities_are_exact() {
    assert_eq!(good("1/3", |value| value.fraction()), Fraction::new(1, 3));
    assert_eq!(bad("1/0", |value| value.fraction()), "4: k: `1/0` is not a number");
    let cycle = |value: Value<'_>| value.quantity(&[Dimension::Time], &Allowed::Between(time("125 us"), time("20 ms")));
    assert_eq!(good("20 ms", cycle).nanoseconds(), Ok(20_000_000));
    assert_eq!(good("'125 us'", cycle).nanoseconds(), Ok(125_000));
    assert_eq!(bad("50 ms", cycle), "4: k is `50 ms`; 125 us..20 ms is allowed");
    assert_eq!(bad("1", cycle), "4: k is `1`; 125 us..20 ms is allowed, a number without a unit is in s");
    assert_eq!(bad("1ms", cycle), "4: k: `1ms` has no blank between number and unit, write `1 ms`");
    assert_eq!(
        bad("1 msec", cycle),
        "4: k: `msec` in `1 msec` is not a unit; a time has ns, us, ms, s, min, did you mean `ms`?"
    );
    // The intended value is unknown, so the message has an example, in the unit of the axis if known.
    assert_eq!(bad("soon", cycle), "4: k: `soon` is not a number, a time such as `1 s` is expected");
    let velocity = [Dimension::Angle(1), Dimension::Increments(1)];
    let of = |text, unit| bad(text, |value| value.quantity_in(unit, &velocity, &Allowed::Positive));
    assert_eq!(of("fast", None), "4: k: `fast` is not a number, an angular velocity such as `1 deg/s` is expected");
    let turn = Some(Unit::REVOLUTION);
    assert_eq!(of("fast", turn), "4: k: `fast` is not a number, an angular velocity such as `1 rev/s` is expected");
    assert_eq!(of("5 mm/s", turn), "4: k: `5 mm/s` is a velocity; an angular velocity such as `5 rev/s` is expected");
    assert_eq!(of("1,5 deg/s", turn), "4: k: `1,5` is not a number, write a decimal point, not a comma");
    let acceleration = [Dimension::Length(2), Dimension::Increments(2)];
    let said = |text| bad(text, |value| value.quantity(&acceleration, &Allowed::Positive));
    assert_eq!(said("8 m/s"), "4: k: `8 m/s` is a velocity; an acceleration such as `8 m/s^2` is expected");
    assert_eq!(said("-8 m/s^2"), "4: k is `-8 m/s^2`; a value above 0 is allowed");
    assert_eq!(said("0 inc/s^2"), "4: k is `0 inc/s^2`; a value above 0 is allowed");
    let not_negative = |value: Value<'_>| value.quantity(&[Dimension::Length(0)], &Allowed::NotNegative);
    assert_eq!(bad("-1 um", not_negative), "4: k is `-1 um`; 0 and above is allowed");
    assert_eq!(good("0 um", not_negative).to_string(), "0 um");
}

#[test]
fn choices_suggest_what_is_alike() {
    let kind = |value: Value<'_>| value.choice(&[("linear", 1), ("rotary", 2)]);
    assert_eq!(good("rotary", kind), 2);
    assert_eq!(bad("lineer", kind), "4: k is `lineer`; one of linear, rotary is allowed, did you mean `linear`?");
    assert_eq!(bad("Rotary", kind), "4: k is `Rotary`; one of linear, rotary is allowed, did you mean `rotary`?");
    assert_eq!(bad("x", kind), "4: k is `x`; one of linear, rotary is allowed");
    // A part of a single name, or a text that contains a single name.
    let part = "one of linear, rotary is allowed, did you mean `linear`?";
    assert_eq!(bad("lin", kind), format!("4: k is `lin`; {part}"));
    assert_eq!(bad("my_linear", kind), format!("4: k is `my_linear`; {part}"));
    assert_eq!(bad("ar", kind), "4: k is `ar`; one of linear, rotary is allowed");
}

#[test]
fn names_of_objects() {
    for text in ["x", "axis_2", "a23456789_123456789_123456789_12"] {
        assert_eq!(good(text, |value| value.name().map(str::to_owned)), text);
    }
    let said = |text| bad(text, |value| value.name().map(str::to_owned));
    let rule = "is no name; a letter a..z, then a..z, 0..9 and _, at most 32 characters, is allowed";
    assert_eq!(said("end"), "4: `end` is taken; machine, end and ros name no object");
    assert_eq!(said("Turret-1"), format!("4: `Turret-1` {rule}, write `turret_1`"));
    assert_eq!(said("2x"), format!("4: `2x` {rule}"));
    assert_eq!(said("größe"), format!("4: `größe` {rule}"));
    let long = "a".repeat(33);
    assert_eq!(said(&long), format!("4: `{long}` has 33 characters and {rule}"));
}

#[test]
fn lists_name_their_items() {
    let text = "k:\n  - 1\n  - two\n  - [3]\n";
    let said = problem_of(text, |value| value.list().unwrap().iter().for_each(|item| _ = item.integer(0..=9)));
    assert_eq!(
        said,
        "t.yaml:3:5: k[1] is `two`; a whole number 0..9 is allowed\nt.yaml:4:5: k[2] is a list; a whole number is expected\n"
    );
    assert_eq!(bad("5", |value| value.list().map(drop)), "4: k is `5`; a list is expected");
    assert_eq!(bad("[5]", |value| value.entries().map(drop)), "4: k is a list; a mapping is expected");
}

#[test]
fn mappings_keep_the_order_of_the_file() {
    let text = "k: {zeta: 1, alpha: 2, mid: 3}";
    let mut names = Vec::new();
    problem_of(text, |value| {
        names = value.entries().unwrap().iter().map(|(key, _)| key.text().unwrap().to_owned()).collect()
    });
    assert_eq!(names, ["zeta", "alpha", "mid"]);
}

/// A cell with one error of every kind: all are reported, each with its location.
#[test]
fn all_mistakes_of_a_cell_at_once() {
    let text = "\
lineshaft: 1
cycle: 1ms
axes:
  x:
    type: lineer
    max_velocty: 1.2 m/s
    bits: 70
  Y: {type: rotary, max_velocity: 1 m/s, required: yes}
  z:
    type: linear
    type: rotary
furniture: 3
";
    let axis = |name: Value<'_>, value: Value<'_>| {
        name.name();
        let mut map = value.map(format!("axis `{}`", name.text().unwrap())).unwrap();
        map.required("type").map(|v| v.choice(&[("linear", 0), ("rotary", 1)]));
        map.required("max_velocity").map(|v| v.quantity(&[Dimension::Length(1)], &Allowed::Positive));
        map.optional("bits").map(|v| v.integer(1..=64));
        map.optional("required").map(|v| v.boolean());
        map.finish();
    };
    let said = problems(text, |root| {
        let mut cell = root.map("the cell").unwrap();
        cell.required("lineshaft").map(|v| v.integer(1..=1));
        cell.required("cycle").map(|v| v.quantity(&[Dimension::Time], &Allowed::Positive));
        cell.required("backends");
        for (name, value) in cell.optional("axes").and_then(|axes| axes.entries()).unwrap() {
            axis(name, value);
        }
        cell.finish();
    });
    let expected = [
        "1:1: missing key `backends` in the cell",
        "2:8: cycle: `1ms` has no blank between number and unit, write `1 ms`",
        "5:11: type is `lineer`; one of linear, rotary is allowed, did you mean `linear`?",
        "6:5: unknown key `max_velocty` in axis `x`, did you mean `max_velocity`?",
        "7:11: bits is 70; 1..64 is allowed",
        "8:3: `Y` is no name; a letter a..z, then a..z, 0..9 and _, at most 32 characters, is allowed, write `y`",
        "8:52: required is `yes`; true or false is allowed, write `true`",
        "10:5: missing key `max_velocity` in axis `z`",
        "11:5: duplicate key `type`; it is first at 10:5",
        "12:1: unknown key `furniture` in the cell, known are lineshaft, cycle, backends, axes",
    ];
    assert_eq!(said, expected.map(|line| format!("t.yaml:{line}\n")).concat());
}

#[test]
fn a_key_in_braces_without_its_colon_is_not_missing_as_well() {
    let read = |root: Value<'_>| {
        let mut map = root.map("a step").unwrap();
        map.required("at");
        map.optional("do");
        map.finish();
    };
    for (text, key) in
        [("{at 0, do: 1}", "at 0"), ("{at:0, do: 1}", "at:0"), ("{at = 0, do: 1}", "at = 0"), ("{at=0, do: 1}", "at=0")]
    {
        assert_eq!(problems(text, read), format!("t.yaml:1:2: unknown key `{key}` in a step, write `at: 0`\n"));
    }
}

#[test]
fn a_reader_that_gives_up_still_reports_missing_keys() {
    let said = problems("a: 1", |root| drop(root.map("the file").unwrap().required("b")));
    assert_eq!(said, "t.yaml:1:1: missing key `b` in the file\n");
}

#[test]
fn remaining_keys_count_as_read() {
    let said = problems("a: 1\nkprop: x\n", |root| {
        let mut map = root.map("the file").unwrap();
        map.optional("a");
        let rest = map.rest();
        assert_eq!(rest.len(), 1);
        assert_eq!((rest[0].0.text(), rest[0].1.integer(0..=1)), (Some("kprop"), None));
        map.finish();
    });
    assert_eq!(said, "t.yaml:2:8: kprop is `x`; a whole number 0..1 is allowed\n");
}

#[test]
fn anchors_and_aliases() {
    let text = "a: &v {k: 70}\nb: *v\nc: [&n 5, *n]\n";
    let said = problems(text, |root| {
        let mut map = root.map("the file").unwrap();
        for key in ["a", "b"] {
            map.required(key).unwrap().map(key).unwrap().required("k").unwrap().integer(1..=64);
        }
        let numbers: Vec<_> = map.required("c").unwrap().list().unwrap().iter().map(|v| v.integer(0..=9)).collect();
        assert_eq!(numbers, [Some(5), Some(5)]);
        map.finish();
    });
    // The location is that of the value after the anchor; two readers of it give one problem.
    assert_eq!(said, "t.yaml:1:11: k is 70; 1..64 is allowed\n");
}

#[test]
fn what_yaml_has_and_we_do_not_read() {
    let merge = problems("<<: {a: 1}", |root| root.map("the file").unwrap().finish());
    assert_eq!(merge, "t.yaml:1:1: unknown key `<<` in the file, merge keys are not read; write the keys out\n");
    let nothing = |_: Value<'_>| {};
    assert_eq!(problems("a: !!str 5", nothing), "t.yaml:1:4: tag `!!str` is not read, leave it out\n");
    assert_eq!(problems("a: 1\n---\nb: 2\n", nothing), "t.yaml:2:1: a second document starts here; a file holds one\n");
    assert_eq!(problems("[a]: 1", nothing), "t.yaml:1:1: a key is a text; lists, mappings and nothing are not\n");
    assert_eq!(problems("a: &x [*x]", nothing), "t.yaml:1:8: this alias stands inside of the value that it repeats\n");
}

#[test]
fn syntax_errors_have_a_place() {
    for (text, line, col) in
        [("a: 1\nb: [1, 2\n", 2, 4), ("a: 1\n  b: 2\n", 2, 4), ("a: *nowhere", 1, 4), ("a:\n\tb: 1", 2, 2)]
    {
        let document = Document::parse("t.yaml", text);
        assert!(document.root("the file").is_none(), "{text:?}");
        let said = document.problems().to_string();
        assert!(said.starts_with(&format!("t.yaml:{line}:{col}: this is not YAML: ")), "{text}: {said}");
    }
}

#[test]
fn key_with_brackets_in_braces_has_a_hint_to_quote_it() {
    let said = |text: &str| {
        let document = Document::parse("t.yaml", text);
        assert!(document.root("the file").is_none(), "{text:?}");
        document.problems().to_string()
    };
    let hint = |key: &str| format!(", quote a key with brackets: `\"{key}\"`\n");
    let text = said("\u{feff}größe: 1\nk: {m2: 3, mode[1]: 16}\n");
    assert!(text.starts_with("t.yaml:2:16: this is not YAML: ") && text.ends_with(&hint("mode[1]")), "{text}");
    let text = said("{parameter[15] : 1}");
    assert!(text.ends_with(&hint("parameter[15]")), "{text}");
    for other in ["{a [1, 2]}", "{a: 1, b[x]: 2}", "{a: 1 [1]: 2", "{a: \"b\"[1]: 2}"] {
        assert!(!said(other).contains("quote a key"), "{other}: {}", said(other));
    }
    let quoted = problem_of("k: {m2: 3, \"mode[1]\": 16}", |value| {
        let mut map = value.map("k").unwrap();
        assert_eq!(map.required("mode[1]").and_then(|value| value.integer(0..=63_i64)), Some(16));
        map.rest();
    });
    assert_eq!(quoted, "");
}

#[test]
fn an_empty_file_is_an_empty_mapping() {
    for text in ["", "\n", "# nothing\n", "---\n", "\u{feff}"] {
        assert_eq!(problems(text, |root| root.map("the file").unwrap().finish()), "", "{text:?}");
    }
}

#[test]
fn columns_count_characters_and_lines_end_as_they_like() {
    let said = problem_of("\u{feff}größe: 1\r\nk: {ä: ü}\r\n", |value| {
        value.map("k").unwrap().required("ä").unwrap().boolean();
    });
    assert_eq!(
        said,
        "t.yaml:1:1: unknown key `größe` in the file, known are k\nt.yaml:2:8: ä is `ü`; true or false is allowed\n"
    );
}

#[test]
fn quoted_pieces_are_short_and_on_one_line() {
    let said = bad(&format!("\"a\\n{}\"", "b".repeat(100)), |value| value.boolean());
    assert_eq!(said, format!("4: k is `a\\n{}..`; true or false is allowed", "b".repeat(58)));
}

#[test]
fn problems_of_several_files_stand_together() {
    let (a, b) = (Problems::new("b.yaml"), Problems::new("a.yaml"));
    a.push(Place { line: 2, col: 1 }, "second", None);
    a.push(Place { line: 1, col: 9 }, "first", Some("hint".to_owned()));
    b.push(Place::START, "other file", None);
    a.append(b);
    assert_eq!(a.to_string(), "a.yaml:1:1: other file\nb.yaml:1:9: first, hint\nb.yaml:2:1: second\n");
    assert_eq!((a.count(), a.is_empty()), (3, false));
}

#[test]
fn files_that_cannot_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cell.yaml");
    let said = || Document::read(&path).into_problems().to_string().replace(&path.display().to_string(), "F");
    assert!(said().starts_with("F:1:1: cannot read the file: "), "{}", said());
    std::fs::write(&path, b"a: 1\nb: \xff\n").unwrap();
    assert_eq!(said(), "F:2:4: the file is not UTF-8 text\n");
    std::fs::write(&path, vec![b' '; 10_000_000]).unwrap();
    assert_eq!(said(), "F:1:1: the file is longer than 4194304 bytes\n");
    std::fs::write(&path, [b"a: ".as_slice(), "ü".repeat(2_500_000).as_bytes()].concat()).unwrap();
    assert_eq!(said(), "F:1:1: the file is longer than 4194304 bytes\n");
    std::fs::write(&path, "a: 1\n").unwrap();
    assert_eq!((said().as_str(), Document::read(&path).text()), ("", "a: 1\n"));
}

/// Documents near the limits that would block or crash a reader without limits.
#[test]
fn documents_made_to_hurt() {
    let limit = MAX_BYTES - 1000;
    let lines = |line: &dyn Fn(usize) -> String| {
        let mut text = String::new();
        (0..)
            .map(line)
            .take_while(|line| {
                text.push_str(line);
                text.len() < limit
            })
            .for_each(drop);
        text
    };
    let laughs: String = (1..40).map(|n| format!("a{n}: &a{n} [*a{0}, *a{0}, *a{0}]\n", n - 1)).collect();
    let deep_block: String = (0..2500).map(|n| format!("{}a:\n", " ".repeat(n))).collect();
    for (name, text, said) in [
        ("10 MB", "a: 1\n".repeat(2_000_000), "t.yaml:1:1: the file is longer than 4194304 bytes\n"),
        ("flow", "[".repeat(10_000), "t.yaml:1:256: lists and mappings are nested deeper than 64 levels\n"),
        ("flow maps", "{a: ".repeat(10_000), "t.yaml:1:1021: lists and mappings are nested deeper than 64 levels\n"),
        ("block", "- ".repeat(10_000), "t.yaml:1:129: lists and mappings are nested deeper than 64 levels\n"),
        ("block maps", deep_block, "t.yaml:65:65: lists and mappings are nested deeper than 64 levels\n"),
        ("laughs", format!("a0: &a0 x\n{laughs}"), ""),
        ("long laughs", format!("a0: &a0 {}\nb: [{}]\n", "x".repeat(100_000), "*a0, ".repeat(100_000)), ""),
        ("values", lines(&|_| "- 1\n".to_owned()), ""),
        ("flow values", format!("[{}]", "1,".repeat(limit / 2)), ""),
        ("keys", lines(&|n| format!("k{n}: 1\n")), ""),
        ("one key", lines(&|_| "key: 1\n".to_owned()), ""),
        ("one line", format!("k: {}", "x ".repeat(limit / 2)), ""),
        ("open quote", format!("k: \"{}", "x\n".repeat(limit / 2)), ""),
        ("anchors", lines(&|n| format!("- &a{n} x\n")), ""),
        ("comment", format!("k: #{}", "#".repeat(limit)), ""),
        ("blanks", format!("k:{}1", " ".repeat(limit)), ""),
    ] {
        let problems = problems(&text, |root| _ = root.map("the file").map(Map::finish));
        assert!(said.is_empty() || problems == said, "{name}: {problems:.300}");
        assert!(problems.len() < 200_000, "{name}: {} bytes of problems", problems.len());
    }
}

fn read_everything(value: &Value<'_>) {
    for allowed in [Allowed::Any, Allowed::Positive, Allowed::Between(time("1 ms"), time("1 s"))] {
        value.quantity(&[Dimension::Time], &allowed);
    }
    value.integer(0..=9_u64);
    value.number(-1.0..=1.0);
    value.fraction();
    value.boolean();
    value.name();
    value.choice(&[("linear", 0)]);
    value.list().iter().flatten().for_each(read_everything);
    if let Some(mut map) = value.map(format!("axis `{}`", value.peek().unwrap_or(value.label()))) {
        map.required("key").map(|v| v.map(v.label()).map(Map::finish));
        map.finish();
    }
    value.entries().iter().flatten().for_each(|(key, value)| {
        key.name();
        read_everything(value);
    });
}

fn never_panics(text: &str) {
    let document = Document::parse("t.yaml", text);
    if let Some(root) = document.root("the file") {
        read_everything(&root);
    }
    let lines = text.split(['\n', '\r']).count();
    for problem in document.problems().sorted() {
        assert!(problem.place.line <= lines + 1, "{problem} in {lines} lines");
        assert!(!problem.sentence.contains('\n'), "{problem}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn arbitrary_text_never_panics(text in any::<String>()) {
        never_panics(&text);
    }

    #[test]
    fn yaml_like_text_never_panics(parts in prop::collection::vec(
        prop::sample::select(vec![
            "a", "b: ", ": ", "- ", "? ", "\n", "\n  ", "\n    ", "[", "]", "{", "}", ",", "&x ", "*x", "!!str ", "!", "|", ">",
            "|-\n", "'", "\"", "#", "%TAG ! x", "%YAML 1.2\n", "---", "...", "\t", " ", "1 ms", "1e3", "~", "\\", "\u{feff}",
            "\r\n", "ü", "\u{0}", "<<", "@", "`", "key", "null", "\u{2028}", "\u{85}", ">2-",
        ]), 0..40)
    ) {
        never_panics(&parts.concat());
    }
}

#[test]
fn additional_values_are_read_like_values_of_the_text() {
    let read = |text: &str| {
        let mut document = Document::parse("t.yaml", text);
        document.put("k", "12");
        let value = document.root("the file").and_then(|root| {
            let mut map = root.map("the file")?;
            let value = map.required("k").and_then(|value| value.text().map(str::to_owned));
            map.rest();
            value
        });
        (value, document.into_problems().to_string())
    };
    for good in ["", "a: 1", "{k: 12}", "{k: '12'}", "# nothing\n"] {
        assert_eq!(read(good), (Some("12".to_owned()), String::new()), "{good}");
    }
    for (text, problem) in [
        ("{a: 1, k: 13}", "t.yaml:1:11: k is `13`; `12` was given beside, leave it out\n"),
        ("k:", "t.yaml:1:2: k has no value; a text is expected\n"),
        ("k: [12]", "t.yaml:1:4: k is a list; a text is expected\n"),
        ("[k, 12]", "t.yaml:1:1: the file is a list; a mapping is expected\n"),
    ] {
        assert_eq!(read(text).1, problem, "{text}");
    }
    let mut document = Document::parse("t.yaml", "{a.b: 1, c: ~}");
    document.put_before_keys("x.");
    let entries = document.root("the file").and_then(|root| root.entries()).unwrap();
    let keys: Vec<_> =
        entries.iter().map(|(key, value)| (key.text().unwrap(), key.place().col, value.label())).collect();
    assert_eq!(keys, [("x.a.b", 2, "x.a.b"), ("x.c", 10, "x.c")]);
}

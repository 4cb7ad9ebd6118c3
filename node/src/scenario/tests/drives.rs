//! Tests section `drive`.

use super::*;

fn driven(signal: &str, cycles: u64, how: &str) -> Vec<String> {
    values(signal, cycles, &format!("drive: [{{signal: {signal}, {how}}}]"))
}

#[test]
fn every_kind_of_input_and_memory_is_driven_from_its_cycle_on() {
    assert_eq!(driven("start", 5, "at: 2, values: [1, 0, 1]"), ["0", "0", "1", "0", "1"]);
    assert_eq!(driven("level", 3, "at: 1, values: [2.5, 1500 mV]"), ["0.0", "2.5", "1.5"]);
    assert_eq!(driven("feed", 5, "at: 2, values: [-3, 32767, -32768]"), ["7", "7", "-3", "32767", "-32768"]);
    assert_eq!(driven("gain", 3, "at: 1, values: [0.1, 0.2]"), ["0.5", "0.1", "0.2"]);
    assert_eq!(driven("flag", 2, "values: [1, 0]"), ["1", "0"]);
    assert_eq!(driven("belt.count", 3, "at: 1 ms, values: [65535, 2]"), ["0", "65535", "2"]);
    assert_eq!(driven("x.actual.count", 3, "at: 1, values: [500, 1 mm]"), ["0", "500", "1000"]);
    let position = values("belt.position", 4, "drive: [{signal: belt.count, values: [65530, 65535, 4, 9]}]");
    assert_eq!(position, ["65530", "65535", "65540", "65545"], "16 bits wrap");
}

#[test]
fn then_holds_repeats_or_releases() {
    let then = |then: &str| driven("start", 7, &format!("at: 1, values: [1, 0, 1]{then}")).concat();
    assert_eq!(then(""), "0101111");
    assert_eq!(then(", then: hold"), "0101111");
    assert_eq!(then(", then: repeat"), "0101101");
    assert_eq!(then(", then: release"), "0101000");
    // Holds the last value for two more cycles; a time is converted to cycles as elsewhere.
    assert_eq!(then(", then: {hold: 2}"), "0101110");
    assert_eq!(then(", then: {hold: 1 ms}"), "0101100");
    assert_eq!(then(", then: {hold: 99}"), "0101111");
}

#[test]
fn a_later_start_takes_over_for_good_and_release_gives_the_signal_back_to_the_simulation() {
    let drives = "drive: [{signal: feed, at: 4, values: [20, 21], then: release}, {signal: feed, values: [1, 2, 3], then: repeat}]";
    assert_eq!(values("feed", 8, drives).join(" "), "1 2 3 1 20 21 21 21");
    // The contact of the plant is open; an earlier `hold` does not close it again.
    let released =
        "drive: [{signal: start, values: [1], then: hold}, {signal: start, at: 3, values: [0, 1], then: release}]";
    assert_eq!(values("start", 8, released).concat(), "11101000");
    // In any order in the file, and also if the later entry is a hold for some cycles.
    let three = "drive: [{signal: start, at: 4, values: [1], then: {hold: 2}}, {signal: start, at: 2, values: [0]}, \
                 {signal: start, values: [1], then: repeat}]";
    assert_eq!(values("start", 9, three).concat(), "110011100");
    let twice = "drive: [{signal: feed, values: [1]}, {signal: feed, at: 0 s, values: [2]}]";
    assert_eq!(
        problems(&format!("scenario: s\ncycles: 9\n{twice}")),
        "3:38: feed is driven twice from cycle 0 (0 s) on\n"
    );
}

#[test]
fn driven_memory_cell_has_priority_over_a_step_and_is_recorded_only_on_change() {
    let text = "drive: [{signal: feed, values: [1, 1, 2]}]\nsteps: [{at: 4, do: {set_memory: {feed: 9}}}]";
    assert_eq!(values("feed", 6, text).join(" "), "1 1 2 2 2 2");
    // 1, 2, then the 9 of the step and the restored value.
    passes(&format!("scenario: s\ncycles: 6\n{text}\nexpect: [{{event: {{kind: accepted, source: feed}}, count: 4}}]"));
}

#[test]
fn a_ramp_is_an_exact_fraction_and_shows_its_floor() {
    assert_eq!(driven("feed", 8, "ramp: {from: 0, per_cycle: 1/3}").join(" "), "0 0 0 1 1 1 2 2");
    assert_eq!(driven("feed", 8, "ramp: {from: 0, per_cycle: -1/3}").join(" "), "0 -1 -1 -1 -2 -2 -2 -3");
    assert_eq!(driven("feed", 5, "ramp: {from: 5, per_cycle: 2.5}").join(" "), "5 7 10 12 15");
    assert_eq!(driven("gain", 4, "ramp: {from: 0.5, per_cycle: 0.1}").join(" "), "0.5 0.6 0.7 0.8");
    // After 30000 cycles of a third it is exactly on an increment: there is no drift.
    let last = driven("belt.count", 30_001, "ramp: {per_cycle: 1/3}").pop();
    assert_eq!(last.as_deref(), Some("10000"));
}

#[test]
fn a_ramp_ends_exactly_where_it_is_to_end() {
    let ramp =
        |then: &str| driven("feed", 8, &format!("at: 1, ramp: {{from: 1, per_cycle: 2, until: 6}}{then}")).join(" ");
    assert_eq!(ramp(""), "7 1 3 5 6 6 6 6");
    assert_eq!(ramp(", then: repeat"), "7 1 3 5 6 1 3 5");
    assert_eq!(ramp(", then: release"), "7 1 3 5 6 6 6 6", "memory keeps what it was given last");
    assert_eq!(driven("belt.count", 4, "ramp: {from: 0, per_cycle: 40, until: 2 mm}").join(" "), "0 40 80 80");
    assert_eq!(driven("feed", 3, "ramp: {from: 3, per_cycle: 1, until: 3}").join(" "), "3 3 3");
}

#[test]
fn ramp_with_wrap_counts_on_as_a_counter_of_that_many_bits() {
    // In two's complement: 33000 - 2^16, 32536 = -33000 + 2^16, 130 - 2^8.
    let ramp = |ramp: &str| driven("feed", 5, &format!("ramp: {{{ramp}}}")).join(" ");
    assert_eq!(ramp("from: 32000, per_cycle: 500, wrap: 16"), "32000 32500 -32536 -32036 -31536");
    assert_eq!(ramp("from: -32000, per_cycle: -500, wrap: 16"), "-32000 -32500 32536 32036 31536");
    assert_eq!(ramp("from: 32767, per_cycle: 1/3, wrap: 16"), "32767 32767 32767 -32768 -32768");
    assert_eq!(ramp("from: 120, per_cycle: 10, wrap: 8"), "120 -126 -116 -106 -96");
    // The sum ends at 70000, which is 4464 in 16 bits; it begins at 65536 + 10.
    assert_eq!(ramp("from: 0, per_cycle: 30000, until: 70000, wrap: 16"), "0 30000 -5536 4464 4464");
    assert_eq!(ramp("from: 65546, per_cycle: 1, wrap: 16"), "10 11 12 13 14");
    assert_eq!(driven("belt.count", 3, "ramp: {from: 7, per_cycle: 1, wrap: 4}"), ["7", "-8", "-7"]);
}

#[test]
fn a_value_that_a_memory_cell_cannot_hold_is_refused() {
    let bad = |entry: &str| problem("drive", entry);
    let range = "-32768..32767 is allowed";
    assert_eq!(bad("{signal: feed, values: [1, ^40000]}"), format!("values[1] is 40000; {range}"));
    assert_eq!(bad("{signal: feed, values: [1, ^-32769]}"), format!("values[1] is -32769; {range}"));
    assert_eq!(bad("{signal: feed, ramp: {from: ^40000, per_cycle: 0}}"), format!("from is 40000; {range}"));
    assert_eq!(bad("{signal: feed, ramp: {per_cycle: 1, until: ^40000}}"), format!("until is 40000; {range}"));
    assert_eq!(
        bad("{signal: feed, sine: ^{mean: 32000, amplitude: -1000, period: 1 s}}"),
        format!("the sine runs from 31000 to 33000; {range}")
    );
    // 32700 + 68 is the first value above 32767, floor(-32768 - 1/7) the first one below -32768.
    let hint = "`wrap: 16` makes the ramp a counter that wraps";
    assert_eq!(
        bad("^{signal: feed, ramp: {from: 32700, per_cycle: 1}}"),
        format!("feed gets to 32768 in cycle 68 (0.068 s); {range}, {hint}")
    );
    assert_eq!(
        bad("^{signal: feed, at: 10, ramp: {from: -32768, per_cycle: -1/7}}"),
        format!("feed gets to -32769 in cycle 11 (0.011 s); {range}, {hint}")
    );
    // It is within its range while it drives the cell.
    scenario("scenario: s\ncycles: 68\ndrive: [{signal: feed, ramp: {from: 32700, per_cycle: 1}}]");
    scenario(
        "scenario: s\ncycles: 100\n\
         drive: [{signal: feed, ramp: {from: 32700, per_cycle: 1}}, {signal: feed, at: 68, values: [0]}]",
    );
    assert_eq!(bad("{signal: feed, ramp: {per_cycle: 1, wrap: ^17}}"), "wrap is 17; 2..16 is allowed");
    assert_eq!(bad("{signal: feed, ramp: {per_cycle: 1, wrap: ^1}}"), "wrap is 1; 2..16 is allowed");
    assert_eq!(bad("{signal: belt.count, ramp: {per_cycle: 1, wrap: ^65}}"), "wrap is 65; 2..64 is allowed");
    assert_eq!(
        bad("{signal: gain, ramp: {per_cycle: 1, wrap: ^16}}"),
        "wrap is for whole numbers; the signal is a real one"
    );
}

/// An f64 has 53 bits: beyond 2^53 it represents only even numbers, beyond 2^54 only multiples of 4.
#[test]
fn i64_cell_is_driven_by_what_an_f64_holds() {
    let cell = CELL.replace("\nencoders:", "\n  big: {type: i64, initial: 0}\nencoders:");
    let cell = Cell::parse("cell.yaml", cell).unwrap_or_else(|problems| panic!("{problems}"));
    let read = |drive: &str, expect: &str| {
        let text = format!("scenario: s\ncycles: 5\ndrive: [{{signal: big, {drive}}}]\nexpect: [{expect}]");
        Scenario::parse("s.yaml", &text, &cell).map_err(|problems| problems.to_string())
    };
    let big = 1_i64 << 60;
    for (drive, values) in [
        (format!("values: [{big}, {}]", -big), [big, -big, -big]),
        (format!("ramp: {{from: {big}, per_cycle: 1024}}"), [big, big + 1024, big + 2048]),
        (format!("ramp: {{per_cycle: {}, until: {big}}}", big / 2), [0, big / 2, big]),
    ] {
        let is = values.iter().enumerate();
        let is: Vec<_> = is.map(|(at, value)| format!("{{signal: big, at: {at}, is: {value}}}")).collect();
        let scenario = read(&drive, &is.join(", ")).unwrap_or_else(|problems| panic!("{drive}: {problems}"));
        let report = simulate(&cell, &scenario, &Options::default()).unwrap();
        assert!(report.passed(), "{drive}: {report}");
    }
    for (drive, said) in [
        (
            "values: [9007199254740993]",
            "values[0] is 9007199254740993; beyond +-2^53 only what an f64 holds can be set, the nearest is 9007199254740992",
        ),
        ("ramp: {from: 9007199254740993, per_cycle: 0}", "from is 9007199254740993; beyond +-2^53 only what"),
        ("ramp: {per_cycle: 1, until: 9007199254740993}", "until is 9007199254740993; beyond +-2^53 only what"),
        (
            "ramp: {from: 9007199254740991, per_cycle: 1, until: 9007199254740994}",
            "big gets to 9007199254740993 in cycle 2 (0.002 s); -9007199254740992..9007199254740992 is allowed",
        ),
        ("ramp: {from: 1152921504606846976, per_cycle: 1}", "big gets to 1152921504606846976 in cycle 0 (0 s); -9007"),
        ("ramp: {per_cycle: 1, wrap: 55}", "wrap is 55; 2..54 is allowed"),
        ("sine: {mean: 9007199254740992, amplitude: 1, period: 1 s}", "the sine runs from 9007199254740991 to"),
        ("sine: {mean: 9007199254740994, amplitude: 1, period: 1 s}", "mean is 9007199254740994; -9007199254740992.."),
    ] {
        let problems = read(drive, "").expect_err(drive);
        assert!(problems.contains(said), "{drive}: {problems}");
    }
}

#[test]
fn a_ramp_on_a_count_beyond_64_bits_is_refused() {
    let said = problem("drive", "^{signal: belt.count, ramp: {from: 9223372036854775800, per_cycle: 1}}");
    assert_eq!(
        said,
        "belt.count gets to 9223372036854775808 in cycle 8 (0.008 s); -9223372036854775808..9223372036854775807 is \
         allowed, `wrap: 64` makes the ramp a counter that wraps"
    );
    let wrapping = "ramp: {from: 9223372036854775806, per_cycle: 1, wrap: 64}";
    assert_eq!(
        driven("belt.count", 3, wrapping),
        ["9223372036854775806", "9223372036854775807", "-9223372036854775808"]
    );
}

#[test]
fn a_sine_meets_its_zeros_and_peaks_and_never_drifts() {
    let sine = driven("feed", 9, "sine: {mean: 100, amplitude: 50, period: 8 ms}");
    // 50 sin 45 deg is 35.36.
    assert_eq!(sine.join(" "), "100 135 150 135 100 65 50 65 100");
    let real = driven("level", 5, "sine: {mean: 1, amplitude: 2.5 V, period: 4}");
    assert_eq!(real.join(" "), "1.0 3.5 1.0 -1.5 1.0");
    // Seven cycles in two periods: after 7000 cycles it is at its mean, exact to the last bit.
    let long = driven("gain", 7001, "sine: {amplitude: 1, period: 3.5 ms}");
    assert_eq!((long[0].as_str(), long[7].as_str(), long[7000].as_str()), ("0.0", "0.0", "0.0"));
}

#[test]
fn a_column_of_a_file_drives_a_signal() {
    let folder = tempfile::tempdir().unwrap();
    let write = |text: &str| std::fs::write(folder.path().join("in.csv"), text).unwrap();
    let name = folder.path().join("s.yaml");
    let load = |column: &str| {
        let entry = format!("{{signal: start, at: 1, csv: {{file: in.csv, column: {column}}}, then: release}}");
        let text = format!("scenario: s\ncycles: 6\ntrace: [start]\ndrive: [{entry}]");
        let parsed = Scenario::parse(&name.display().to_string(), &text, &cell());
        parsed.map_err(|problems| problems.to_string().replace(&format!("{}/", folder.path().display()), ""))
    };
    write("\u{feff}cycle, \"start\"\r\n0,1\r\n1, 0\r\n2,\"1\"\r\n\r\n");
    let csv = folder.path().join("out.csv");
    let options = Options { csv: Some(csv.clone()), ..Options::default() };
    simulate(&cell(), &load("start").unwrap(), &options).unwrap();
    let rows = std::fs::read_to_string(csv).unwrap();
    let column: String = rows.lines().skip(1).map(|row| row.split(',').nth(2).unwrap()).collect();
    assert_eq!(column, "010100");

    write("cycle,start\n0,1\n1,2\n2\n3,x\n");
    assert_eq!(
        load("start").unwrap_err(),
        "in.csv:3:3: `2` is no value here; 0 or 1 is expected\n\
         in.csv:4:3: the row has no column 2\n\
         in.csv:5:3: `x` is no value here; 0 or 1 is expected\n"
    );
    let feed = "scenario: s\ncycles: 6\ndrive: [{signal: feed, csv: {file: in.csv, column: start}}]".to_owned();
    write("cycle,start\n0,32767\n1,40000\n2,1.5\n");
    let parsed = Scenario::parse(&name.display().to_string(), &feed, &cell()).unwrap_err().to_string();
    assert_eq!(
        parsed.replace(&format!("{}/", folder.path().display()), ""),
        "in.csv:3:3: `40000` is no value here; a whole number -32768..32767 is expected\n\
         in.csv:4:3: `1.5` is no value here; a whole number -32768..32767 is expected\n"
    );
    write("cycle,start\n0,1\n1,2\n2\n3,x\n");
    assert_eq!(load("stat").unwrap_err(), "s.yaml:4:60: in.csv has no column `stat`; it has cycle, start\n");
    write("start\n");
    assert_eq!(load("start").unwrap_err(), "s.yaml:4:44: in.csv has no rows below its head\n");
    std::fs::remove_file(folder.path().join("in.csv")).unwrap();
    assert!(load("start").unwrap_err().starts_with("s.yaml:4:44: cannot read in.csv: "));
}

#[test]
fn what_cannot_be_driven_is_refused() {
    let bad = |entry: &str| problem("drive", entry);
    let rule = "inputs, memory cells, ENCODER.count, and of axes with a drive AXIS.actual.count and its switches can";
    for signal in ["lamp", "x.state", "belt.position", "machine.error", "line.actual.count"] {
        let said = bad(&format!("{{values: [1], signal: ^{signal}}}"));
        assert_eq!(said, format!("{signal} cannot be driven; {rule}"));
    }
    assert_eq!(bad("{signal: ^strat, values: [1]}"), "no signal is called `strat`, did you mean `start`?");
    assert_eq!(
        bad("{signal: ^qqqqqq, values: [1]}"),
        "no signal is called `qqqqqq`, `lineshaft signals CELL` lists them"
    );
    assert_eq!(bad("^{signal: start}"), "one of values, csv, ramp, sine is expected");
    assert_eq!(bad("^{signal: feed, values: [1], ramp: {per_cycle: 1}}"), "one of values, csv, ramp, sine is expected");
    assert_eq!(bad("{signal: start, values: [^2]}"), "values[0] is 2; 0..1 is allowed");
    assert_eq!(bad("{signal: start, values: ^[]}"), "values is empty; one value or more is expected");
    assert_eq!(bad("{signal: feed, values: [^1.5]}"), "values[0] is `1.5`; a whole number -32768..32767 is allowed");
    assert_eq!(bad("{signal: start, ramp: ^{per_cycle: 1}}"), "a bit has no ramp; values and csv are possible");
    assert_eq!(
        bad("{signal: feed, values: [1], at: ^100}"),
        "at is cycle 100 (0.1 s); the scenario ends with cycle 99 (0.099 s)"
    );
    assert_eq!(
        bad("{signal: feed, values: [1], then: ^stop}"),
        "then is `stop`; one of hold, repeat, release is allowed"
    );
    assert_eq!(bad("{signal: feed, values: [1], then: {hold: ^0}}"), "hold is 0; 1..1000000000000 is allowed");
    assert_eq!(bad("{signal: feed, values: [1], then: {hold: ^-1}}"), "hold is -1; 1..1000000000000 is allowed");
    assert_eq!(bad("{signal: feed, values: [1], then: ^{}}"), "missing key `hold` in then");
    assert_eq!(
        bad("{signal: feed, values: [1], then: {hold: ^0.5}}"),
        "hold is 0.5; a whole number of cycles, or a time with its unit is allowed, write `0.5 s`"
    );
    assert_eq!(
        bad("{signal: feed, then: ^hold, sine: {amplitude: 1, period: 1 s}}"),
        "a sine has no end, so nothing comes then"
    );
    assert_eq!(
        bad("{signal: feed, then: ^hold, ramp: {per_cycle: 1}}"),
        "a ramp without until has no end, so nothing comes then"
    );
    assert_eq!(
        bad("{signal: feed, ramp: {from: 3, per_cycle: -1/2, until: ^8}}"),
        "a ramp from 3 by -1/2 per cycle never gets to 8"
    );
    assert_eq!(
        bad("{signal: feed, ramp: {from: 3, per_cycle: 0, until: ^8}}"),
        "a ramp from 3 by 0 per cycle never gets to 8"
    );
    assert_eq!(
        bad("{signal: feed, ramp: ^{per_cycle: 9e37/7}}"),
        "per_cycle and from have too many digits for an exact ramp of this length"
    );
    assert_eq!(
        bad("{signal: feed, sine: {amplitude: 1, period: ^0 s}}"),
        "period is none; more than 0 up to 292 years is allowed"
    );
    assert_eq!(
        bad("{signal: gain, sine: ^{mean: 1e308, amplitude: -1e308, period: 1 s}}"),
        "mean and amplitude together exceed what f64 holds, 1.8e308"
    );
    assert_eq!(
        problems("{scenario: s, cycles: 9, drive: [{signal: feed, valeus: [1]}]}"),
        "1:34: one of values, csv, ramp, sine is expected\n\
         1:49: unknown key `valeus` in an entry of drive, did you mean `values`?\n"
    );
}

//! Tests valid cells, and the exact text of every problem of invalid ones.

mod amc;
mod analog;
mod axes;
mod compensation;
mod copies;
mod encoders;
mod fixtures;
mod functions;
mod gantry;
mod interfaces;
mod joints;
mod marks;
mod masters;
mod maxima;
mod motor;
mod preset;
mod programs;
mod scale;
mod sections;

use super::*;
use lineshaft_core::machine::Machine;
use lineshaft_core::sim::SecondOrder;
use lineshaft_ros::surface::TrajectorySettings;
use proptest::prelude::*;

/// First five lines of a valid cell.
const HEAD: &str =
    "lineshaft: 1\ncycle: 1 ms\nbackends:\n  plant: {type: sim}\n  bus0: {type: can, transport: 'socketcan:can0'}\n";

/// Returns the problems of a text, one per line, without the file name.
fn said(text: &str) -> String {
    let problems = Cell::parse("c", text).expect_err(text);
    assert!(!problems.is_empty(), "refused for no reason: {text}");
    problems.to_string().lines().map(|line| line.strip_prefix("c:").unwrap_or(line)).collect::<Vec<_>>().join("\n")
}

/// Returns the problems of a text after [`HEAD`], which begins in line 6.
fn said_of(sections: &str) -> String {
    said(&format!("{HEAD}{sections}"))
}

fn good(text: &str) -> Cell {
    Cell::parse("c", text).unwrap_or_else(|problems| panic!("{problems}in\n{text}"))
}

/// Removes the `^` from a text; returns the text and the location of the mark in the format of problems.
fn unmark(text: &str) -> (String, String) {
    let (before, behind) = text.split_once('^').unwrap();
    let last = before.rsplit('\n').next().unwrap();
    let place = format!("{}:{}: ", before.matches('\n').count() + 1, last.chars().count() + 1);
    (format!("{before}{behind}"), place)
}

/// Checks that the text is refused with this message at the `^`.
fn assert_said(marked: &str, sentence: &str) {
    let (text, place) = unmark(marked);
    assert_eq!(said(&text), format!("{place}{sentence}"));
}

/// Returns the example in docs/contract.md.
fn contract_example() -> String {
    let contract = include_str!("../../../docs/contract.md");
    let (_, behind) = contract.split_once("```yaml\n").unwrap();
    behind.split_once("```").unwrap().0.to_owned()
}

#[test]
fn the_example_of_the_contract_is_good() {
    let text = contract_example();
    let cell = good(&text);
    assert_eq!(cell.machine.slots.iter().map(|slot| slot.name.as_str()).collect::<Vec<_>>(), ["ratio"]);
    let MachineConfig { cycle_ns, io, memory, encoders, axes, .. } = &cell.machine;
    assert_eq!((*cycle_ns, io.len(), memory.len(), encoders.len(), axes.len()), (1_000_000, 3, 1, 1, 3));
    assert_eq!(
        (encoders[0].form, encoders[0].scale.format_increments(40)),
        (lineshaft_core::encoder::Form::Incremental(16), "0.001 m".to_owned())
    );
    assert!(io[1].latch && !io[0].latch);
    assert_eq!(
        axes.iter().map(|axis| axis.drive.map(|offers| offers.delay)).collect::<Vec<_>>(),
        [None, Some(0), Some(0)]
    );
    assert_eq!(axes.iter().map(|axis| axis.parameters.homing.method).collect::<Vec<_>>(), [0, 35, 0]);
    assert_eq!(
        cell.groups,
        [Group {
            name: "arm".to_owned(),
            axes: vec![1, 2],
            trajectories: TrajectorySettings::default(),
            gripper: None
        }]
    );
    assert!(cell.backends.iter().all(|backend| backend.is_simulated()));
    assert_eq!(cell.models, [Model::SecondOrder(SecondOrder::new(60.0, 0.8, 1_000_000).unwrap()), Model::Ideal]);
    assert_eq!(cell.text, text);
    // The default is 1000 inc; a given value is converted to increments.
    let x = &axes[1].parameters;
    assert_eq!((x.max_following_error, axes[2].parameters.max_following_error), (1_048_576, 1000));
    assert_eq!((x.min_position, x.max_position), (Some(-5_242_880), Some(89_128_960)));
    assert_eq!((x.max_velocity, x.max_jerk), (125_829_120.0, Some(20_971_520_000.0)));
    assert_eq!(axes[2].modulo, lineshaft_core::modulo::Modulo::new(36_000, 1));
}

#[test]
fn the_demo_is_a_machine() {
    let cell = Cell::demo();
    let names: Vec<_> = cell.machine.axes.iter().map(|axis| axis.name.as_str()).collect();
    assert_eq!(names, ["line", "x", "y", "turret"]);
    assert_eq!((cell.machine.count_drives(), cell.models.len()), (3, 3));
    assert_eq!(cell.ros, RosOptions::default());
    assert_eq!(cell.machine.check(), Ok(()));
    // The positions of x in the end-to-end tests are within its limits.
    let x = &cell.machine.axes[1].parameters;
    assert!(x.max_position > Some(12_345_679) && x.min_position < Some(-1_234_567));
    assert!(Machine::new(cell.machine).is_ok());
}

#[test]
fn all_problems_are_reported_at_once() {
    let text = "\
lineshaft: 2
cylce: 1 ms
ros: {name: my-node, joint_states_rate: 0}
backends:
  plant: {type: sim, delay: 33}
axes:
  x:
    type: linear
    unit: mn
    scale: {increments: 0, per: 10 mm}
    drive: {backend: plnat, address: 0}
    max_velocity: 1.2 mm
    max_acceleration: 8 m/s^2
    error_reaction: 6
    max_pos: 3 mm
  X2: {type: liner, drive: virtual}
functions:
  f: {slot: 256, type: apsff}
groups: {arm: [x, y]}
";
    assert_eq!(
        said(text),
        "1:12: lineshaft is `2`; format version 1 is allowed\n\
         2:1: unknown key `cylce` in the cell, did you mean `cycle`?\n\
         3:13: name is `my-node`; a letter or _, then letters, digits and _, is allowed\n\
         3:41: joint_states_rate is `0`; 1 Hz..1000 Hz is allowed\n\
         5:29: delay is 33; 0..32 is allowed\n\
         9:11: unit is `mn`; one of nm, um, mm, cm, m, inc is allowed\n\
         10:25: increments is `0`; a number above 0 is allowed\n\
         11:22: backend is `plnat`; no backend has that name, did you mean `plant`?\n\
         12:19: max_velocity: `1.2 mm` is a length; a velocity such as `1.2 mm/s` is expected\n\
         14:21: error_reaction is `6`; 0 to 5 is allowed\n\
         15:5: unknown key `max_pos` in axis `x`\n\
         16:3: `X2` is no name; a letter a..z, then a..z, 0..9 and _, at most 32 characters, is allowed, write `x2`\n\
         16:7: missing key `max_acceleration` in axis `X2`\n\
         16:7: missing key `max_velocity` in axis `X2`\n\
         16:7: missing key `scale` in axis `X2`\n\
         16:14: type is `liner`; one of linear, rotary is allowed, did you mean `linear`?\n\
         18:13: slot is 256; 0..255 is allowed\n\
         18:24: type is `apsff`; dcopy, ecopy, sidiff, varsync, digdreh, imes, binea, cam, fipw, fipz, xfipw, dfkt, fgen, regl, epos, apsf is allowed, did you mean `apsf`?\n\
         19:19: arm[1] is `y`; no axis has that name, there are x, X2"
    );
}

#[test]
fn a_file_is_called_by_its_path() {
    let path = tempfile::tempdir().unwrap().path().join("none.yaml");
    let problems = Cell::load(&path).unwrap_err();
    assert!(problems.to_string().starts_with(&format!("{}:1:1: cannot read the file: ", path.display())));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cell.yaml");
    std::fs::write(&path, "lineshaft: 1\ncycle: 2 s\n").unwrap();
    let expected = format!("{}:2:8: cycle is `2 s`; 125 us..20 ms is allowed\n", path.display());
    assert_eq!(Cell::load(&path).unwrap_err().to_string(), expected);
    std::fs::write(&path, "lineshaft: 1\ncycle: 125 us\n").unwrap();
    assert_eq!(Cell::load(&path).unwrap().machine.cycle_ns, 125_000);
}

#[test]
fn file_that_is_no_cell_is_refused_with_the_missing_key() {
    let missing = "1:1: missing key `cycle` in the cell\n1:1: missing key `lineshaft` in the cell";
    assert_eq!(said(""), missing);
    assert_eq!(said("{}"), missing);
    assert_eq!(said("[1, 2]"), "1:1: the cell is a list; a mapping is expected");
    assert!(said("a: [").contains("this is not YAML"));
}

/// Any text gives either a machine that the core accepts, or a problem with a location.
fn is_a_machine_or_has_problems(text: &str) {
    match Cell::parse("c", text) {
        Ok(cell) => {
            assert_eq!(cell.machine.count_drives(), cell.models.len(), "{text}");
            assert!(
                cell.groups
                    .iter()
                    .flat_map(|group| &group.axes)
                    .all(|axis| usize::from(*axis) < cell.machine.axes.len())
            );
            assert!(Machine::new(cell.machine).is_ok(), "{text}");
        }
        Err(problems) => {
            assert!(!problems.is_empty(), "{text}");
            let lines = text.split(['\n', '\r']).count();
            for problem in problems.sorted() {
                assert!(problem.place.line <= lines + 1 && !problem.to_string().contains('\n'), "{problem}");
            }
        }
    }
}

/// Words from which random cells are made.
const WORDS: [&str; 40] = [
    "1",
    "0",
    "-5",
    "1e30",
    "1/3",
    "-0.5 mm",
    "1 ms",
    "10 mm/s",
    "3 rad",
    "360 deg",
    "1 inc",
    "1e300 m",
    "nan",
    "~",
    "[]",
    "{}",
    "[x, turret]",
    "virtual",
    "{backend: plant, address: 1}",
    "{backend: plant}",
    "sim",
    "can",
    "di",
    "ao",
    "i64",
    "bit",
    "linear",
    "rotary",
    "x",
    "x.actual",
    "line",
    "true",
    "jerk",
    "ratio.sink",
    "{model: ideal}",
    "'quoted'",
    "ü",
    "- a",
    "*a",
    "&a b",
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn no_text_panics(text in any::<String>()) {
        is_a_machine_or_has_problems(&text);
        is_a_machine_or_has_problems(&format!("{HEAD}{text}"));
    }

    #[test]
    fn no_change_of_a_good_cell_panics(
        demo in any::<bool>(), from in any::<prop::sample::Index>(), length in 0..12_usize, word in prop::sample::select(&WORDS[..]),
    ) {
        let text = if demo { DEMO.to_owned() } else { contract_example() };
        let characters: Vec<char> = text.chars().collect();
        let from = from.index(characters.len());
        let rest = &characters[(from + length).min(characters.len())..];
        let changed: String = characters[..from].iter().copied().chain(word.chars()).chain(rest.iter().copied()).collect();
        is_a_machine_or_has_problems(&changed);
    }

    #[test]
    fn no_other_value_panics(
        place in any::<prop::sample::Index>(), word in prop::sample::select(&WORDS[..]), demo in any::<bool>(),
    ) {
        let text = if demo { DEMO.to_owned() } else { contract_example() };
        let places: Vec<_> = text.match_indices(": ").map(|(at, _)| at + 2).collect();
        let from = places[place.index(places.len())];
        let end = text[from..].find([',', '}', '\n', '#']).map_or(text.len(), |length| from + length);
        is_a_machine_or_has_problems(&format!("{}{word}{}", &text[..from], &text[end..]));
    }
}

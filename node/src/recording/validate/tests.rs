use super::*;
use crate::recording::test_bags::{TestBag, axes, joints};
use lineshaft_msgs::msg::AxisState;
use proptest::prelude::*;
use tempfile::{TempDir, tempdir};

mod holes;

const MS: u64 = 1_000_000;

struct Bags {
    _folder: TempDir,
    run: Run,
    expected: Run,
}

fn open(run: TestBag, expected: TestBag) -> Bags {
    let folder = tempdir().unwrap();
    let open = |name: &str, bag: TestBag| {
        let path = folder.path().join(name);
        std::fs::write(&path, bag.finish()).unwrap();
        Run::open(&path).unwrap()
    };
    let (run, expected) = (open("run.mcap", run), open("expected.mcap", expected));
    Bags { _folder: folder, run, expected }
}

fn compared(run: TestBag, expected: TestBag, tolerances: &[&str], align: Align) -> Result<Report, ValidateError> {
    let tolerances: Vec<Tolerance> = tolerances.iter().map(|text| text.parse().unwrap()).collect();
    let mut bags = open(run, expected);
    validate(&mut bags.run, &mut bags.expected, &tolerances, align)
}

#[track_caller]
fn report(run: TestBag, expected: TestBag, tolerances: &[&str]) -> Report {
    compared(run, expected, tolerances, Align::Start).unwrap()
}

/// Returns the error messages of a signal.
#[track_caller]
fn failures<'r>(report: &'r Report, name: &str) -> &'r [String] {
    report.lines.iter().find(|line| line.name == name).unwrap_or_else(|| panic!("{name}: {report}")).failures()
}

/// Returns joint_states of one joint: `position` at `start`, and then every `period` (in ms).
fn moving(start: u64, period: u64, count: u64, position: impl Fn(f64) -> f64) -> TestBag {
    let mut bag = TestBag::new();
    for sample in 0..count {
        let time = start + sample * period * MS;
        bag.message("/joint_states", time + 77, &joints(time, &[("x", position((sample * period) as f64 / 1e3))]));
    }
    bag
}

/// Returns axis_states with the given states.
fn states(start: u64, period: u64, states: &[u8]) -> TestBag {
    let mut bag = TestBag::new();
    for (sample, state) in (0..).zip(states) {
        let time = start + sample * period * MS;
        let axis = AxisState { name: "x".to_owned(), state: *state, ..AxisState::default() };
        bag.message("/ls/axis_states", time, &axes(time, vec![axis]));
    }
    bag
}

#[test]
fn equal_runs_pass_at_any_time_of_day() {
    let wave = |t: f64| (t * 3.0).sin() / 3.0;
    let report = report(moving(5_000 * MS, 10, 200, wave), moving(1_700_000_000_000 * MS, 10, 200, wave), &[]);
    assert!(report.passed(), "{report}");
    assert_eq!(report.lines[0].deviation(), Some(0.0));
    let text = report.to_string();
    assert!(text.ends_with("PASSED: the signal agrees"), "{text}");
    assert!(
        text.contains("run.mcap against ") && text.contains("; values in SI, times from the first sample of each\n")
    );
}

#[test]
fn largest_deviation_is_reported_with_time_and_values() {
    let expected = moving(0, 10, 100, |t| 2.0 * t);
    let run = moving(900 * MS, 10, 100, |t| if t == 0.35 { 0.7125 } else { 2.0 * t });
    let report = report(run, expected, &["x.position=10 mm"]);
    assert_eq!(failures(&report, "x.actual.position"), ["deviates"]);
    let text = report.to_string();
    let line: Vec<&str> = text.lines().nth(2).unwrap().split_whitespace().collect();
    let cells =
        ["x.actual.position", "/joint_states", "0.0125", "0.35", "s", "0.7125", "0.7", "0.01", "FAIL:", "deviates"];
    assert_eq!(line, cells);
    assert!(text.ends_with("\nFAILED: 1 of 1 signals is not as expected: x.actual.position"), "{text}");
}

#[test]
fn between_samples_both_are_read_on_straight_lines() {
    let line = |t: f64| 0.25 * t;
    // Every third sample of one run has the time of a sample of the other; on a line all times match.
    let good = report(moving(0, 6, 100, line), moving(0, 4, 150, line), &["x.position=1e-12"]);
    assert!(good.passed(), "{good}");
    // The interpolation cuts a corner between the samples of the run by 2 ms * 0.5 / 2.
    let corner = |t: f64| 0.5 * (t - 0.05).max(0.0);
    let tight = report(moving(0, 4, 50, |t| corner(t - 0.002)), moving(0, 4, 50, corner), &["x.position=1.001 mm"]);
    assert!(tight.passed(), "{tight}");
    let worst = tight.lines[0].deviation().unwrap();
    assert!((worst - 0.001).abs() < 1e-12, "{worst}");
}

proptest! {
    /// The worst deviation of two polygons with different sample times is at one of their corners.
    #[test]
    fn the_worst_deviation_is_that_of_all_times(
        given in prop::collection::vec(-5..5_i32, 2..30),
        wanted in prop::collection::vec(-5..5_i32, 2..30),
        period in 1..7_u64,
    ) {
        let value = |values: &[i32], period: u64, time: f64| {
            let place = (time / period as f64).min(values.len() as f64 - 1.0);
            let before = values[place as usize];
            let after = values[(place as usize + 1).min(values.len() - 1)];
            f64::from(before) + f64::from(after - before) * place.fract()
        };
        let bag = |values: &[i32], period: u64| {
            let values: Vec<f64> = values.iter().map(|value| f64::from(*value)).collect();
            moving(0, period, values.len() as u64, move |t| values[(t * 1e3 / period as f64).round() as usize])
        };
        let report = report(bag(&given, period), bag(&wanted, 4), &["time=1 s"]);
        let end = ((given.len() as u64 - 1) * period).min((wanted.len() as u64 - 1) * 4);
        // All corners are at integer milliseconds.
        let all = (0..=end).map(|ms| (value(&given, period, ms as f64) - value(&wanted, 4, ms as f64)).abs());
        let worst = all.fold(0.0, f64::max);
        let found = report.lines[0].deviation().unwrap();
        prop_assert!((found - worst).abs() < 1e-9, "{found} {worst}");
        prop_assert_eq!(report.passed(), found == 0.0);
    }
}

#[test]
fn ends_may_differ_by_two_samples_and_by_what_time_allows() {
    let wave = |t: f64| t * t;
    let (report_of, tolerance) = (
        |count, more: &[&str]| {
            let all: Vec<&str> = ["x.position=1"].iter().chain(more).copied().collect();
            report(moving(0, 10, count, wave), moving(0, 10, 100, wave), &all)
        },
        "time=50 ms",
    );
    assert!(report_of(98, &[]).passed() && report_of(102, &[]).passed());
    let short = report_of(97, &[]);
    assert_eq!(failures(&short, "x.actual.position"), ["ends 0.03 s earlier than expected; 0.02 s is allowed"]);
    let long = report_of(104, &[]);
    assert_eq!(failures(&long, "x.actual.position"), ["ends 0.04 s later than expected; 0.02 s is allowed"]);
    assert!(report_of(95, &[tolerance]).passed() && report_of(105, &[tolerance]).passed());
    assert!(!report_of(94, &[tolerance]).passed());
}

#[test]
fn a_signal_that_begins_late_is_a_failure() {
    let two = |late: u64| {
        let mut bag = moving(0, 10, 100, |_| 1.0);
        for sample in late..100 {
            bag.message(
                "/ls/axis_states",
                0,
                &axes(sample * 10 * MS, vec![AxisState { name: "y".to_owned(), ..AxisState::default() }]),
            );
        }
        bag
    };
    let report = report(two(30), two(0), &[]);
    assert_eq!(failures(&report, "y.state"), ["begins 0.3 s later than expected; 0.02 s is allowed"]);
    assert!(failures(&report, "x.actual.position").is_empty());
}

#[test]
fn motion_aligns_runs_that_wait_for_different_times() {
    let ramp = |wait: f64| move |t: f64| 0.2 + 0.5 * (t - wait).max(0.0);
    let bags = || (moving(0, 10, 250, ramp(1.5)), moving(0, 10, 150, ramp(0.5)));
    let (run, expected) = bags();
    assert!(!compared(run, expected, &["*=1 um"], Align::Start).unwrap().passed());
    let (run, expected) = bags();
    let report = compared(run, expected, &["*=1 um"], Align::Motion).unwrap();
    assert!(report.passed(), "{report}");
    assert!(report.to_string().contains("times from the first motion of each"));
    let still = compared(moving(0, 10, 9, |_| 1.0), moving(0, 10, 9, ramp(0.0)), &[], Align::Motion).unwrap_err();
    let said = still.to_string();
    assert!(
        said.ends_with(
            "run.mcap: no position that both runs have moves further than its tolerance; there is no motion to align"
        ),
        "{said}"
    );
}

#[test]
fn noise_is_no_motion() {
    let noisy = |wait: f64| {
        move |t: f64| 0.2 + 0.5 * (t - wait).max(0.0) + if t < wait { 1e-6 * (t * 77.0).sin() } else { 0.0 }
    };
    let bags =
        |more: &[&str]| compared(moving(0, 10, 250, noisy(1.5)), moving(0, 10, 150, noisy(0.5)), more, Align::Motion);
    let report = bags(&["x.position=0.1 mm"]).unwrap();
    assert!(report.passed(), "{report}");
    // Without a tolerance every deviation is reported.
    assert!(!bags(&[]).unwrap().passed());
    let said = bags(&["x.position=9 m"]).unwrap_err().to_string();
    assert!(said.ends_with("moves further than its tolerance; there is no motion to align"), "{said}");
}

#[test]
fn attached_cell_determines_which_axes_are_linear() {
    let bag = |cell: Option<&str>, x: f64, turret: f64| {
        let mut bag = TestBag::new();
        if let Some(cell) = cell {
            bag.attach("cell.yaml", cell.as_bytes());
        }
        for sample in 0..10 {
            bag.message("/joint_states", 0, &joints(sample * 10 * MS, &[("x", x), ("turret", turret)]));
        }
        bag
    };
    let demo = crate::cell::Cell::demo().text;
    let both = ["*.position=10 um", "*.position=0.1 deg"];
    let off = 0.001;
    for (run, expected) in [(Some(demo.as_str()), None), (None, Some(demo.as_str()))] {
        let report = report(bag(run, off, off), bag(expected, 0.0, 0.0), &both);
        assert_eq!(failures(&report, "x.actual.position"), ["deviates"]);
        assert!(failures(&report, "turret.actual.position").is_empty(), "{report}");
    }
    let refused = |cell, tolerances: &[&str]| {
        compared(bag(cell, 0.0, 0.0), bag(None, 0.0, 0.0), tolerances, Align::Start).unwrap_err().to_string()
    };
    let said = refused(None, &both);
    assert!(said.contains("no attached cell tells which of both x.actual.position is"), "{said}");
    let said = refused(Some(demo.as_str()), &["turret.position=1 mm"]);
    assert!(said.ends_with("; turret.actual.position is an angle"), "{said}");
    let report = report(bag(Some("x: ["), 0.0, 0.0), bag(None, 0.0, 0.0), &[]);
    assert!(report.notes[0].ends_with("run.mcap: the attached cell has errors and tells no units of axes"), "{report}");
}

#[test]
fn failures_are_listed_last_with_their_names() {
    let bag = |values: [f64; 3]| {
        let mut bag = TestBag::new();
        for sample in 0..10 {
            let names = ["a", "b", "c"];
            let all: Vec<(&str, f64)> = std::iter::zip(names, values).collect();
            bag.message("/joint_states", 0, &joints(sample * 10 * MS, &all));
        }
        bag
    };
    let text = report(bag([2.0, 1.0, 2.0]), bag([1.0, 1.0, 1.0]), &[]).to_string();
    let first: Vec<&str> = text.lines().skip(1).filter_map(|line| line.split_whitespace().next()).collect();
    assert_eq!(first, ["signal", "b.actual.position", "a.actual.position", "c.actual.position", "FAILED:"]);
    let last = text.lines().last();
    assert_eq!(last, Some("FAILED: 2 of 3 signals are not as expected: a.actual.position, c.actual.position"));
}

#[test]
fn duplicate_joint_or_axis_is_refused() {
    let mut bag = TestBag::new();
    bag.message("/joint_states", 7, &joints(0, &[("x", 1.0), ("y", 1.0), ("x", 2.0)]));
    let said = compared(bag, moving(0, 1, 5, |_| 0.0), &[], Align::Start).unwrap_err().to_string();
    assert!(said.ends_with("run.mcap: message on /joint_states at 0.000000007 s: joint x stands twice"), "{said}");
    let mut bag = TestBag::new();
    let axis = AxisState { name: "x".to_owned(), ..AxisState::default() };
    bag.message("/ls/axis_states", 7, &axes(0, vec![axis.clone(), axis]));
    let said = compared(bag, moving(0, 1, 5, |_| 0.0), &[], Align::Start).unwrap_err().to_string();
    assert!(said.ends_with(": axis x stands twice"), "{said}");
}

#[test]
fn other_encodings_are_left_out_or_refused() {
    let json = |kind: &str| {
        let mut bag = moving(0, 10, 20, |_| 1.0);
        bag.raw("/other", kind, "json", 5, b"{}");
        bag
    };
    assert!(report(json("std_msgs/msg/String"), moving(0, 10, 20, |_| 1.0), &[]).passed());
    let said = compared(json("sensor_msgs/msg/JointState"), moving(0, 10, 20, |_| 1.0), &[], Align::Start);
    let said = said.unwrap_err().to_string();
    assert!(said.ends_with("message on /other at 0.000000005 s: it is encoded as `json`; only cdr is read"), "{said}");
}

#[test]
fn names_do_not_steer_the_terminal() {
    let name = "x\u{1b}[2J\u{7}\r\nPASSED";
    let bag = |name: &str, value: f64| {
        let mut bag = TestBag::new();
        for sample in 0..10 {
            bag.message("/a\u{9b}1m/joint_states", 0, &joints(sample * 10 * MS, &[(name, value), ("y", 1.0)]));
        }
        bag
    };
    let is_clean = |text: &str| text.chars().all(|letter| !letter.is_control() || letter == '\n');
    let text = report(bag(name, 1.0), bag(name, 2.0), &[]).to_string();
    assert!(is_clean(&text) && text.contains("x\\u{1b}[2J\\u{7}\\r\\nPASSED.actual.position"), "{text}");
    assert!(text.lines().all(|line| !line.starts_with("PASSED")), "{text}");
    // The note about additional signals.
    let text = report(bag(name, 1.0), bag("z", 1.0), &[]).to_string();
    assert!(is_clean(&text) && text.contains("\nnote: the run has more signals: x\\u{1b}"), "{text}");
    for tolerance in ["z=1", "x*=1 rad/s"] {
        let said = compared(bag(name, 1.0), bag(name, 1.0), &[tolerance], Align::Start).unwrap_err().to_string();
        assert!(is_clean(&said) && !said.contains('\n'), "{said}");
    }
}

#[test]
fn steps_are_compared_in_their_order_where_samples_fall_differently() {
    let expected = || states(0, 10, &[0, 1, 1, 2, 2, 2, 1, 1, 1, 1]);
    // At another rate, and with a time offset.
    let run = states(0, 7, &[0, 1, 1, 1, 2, 2, 2, 2, 2, 1, 1, 1, 1]);
    assert!(report(run, expected(), &[]).passed());
    let other = report(states(0, 7, &[0, 1, 1, 1, 2, 2, 2, 7, 7, 1, 1, 1, 1]), expected(), &[]);
    assert_eq!(failures(&other, "x.state"), ["differs from value 4 on (5 values in the run, 4 expected)"]);
    let line = other.to_string().lines().find(|line| line.starts_with("x.state")).unwrap().to_owned();
    let cells: Vec<&str> = line.split_whitespace().take(7).collect();
    assert_eq!(cells, ["x.state", "/ls/axis_states", "-", "0.049", "s", "ERROR_STOP", "STANDSTILL"]);
    let lacking = report(states(0, 7, &[0, 1, 1, 1, 2, 2, 2, 2, 2, 2, 2, 2, 2]), expected(), &[]);
    assert_eq!(failures(&lacking, "x.state"), ["differs from value 4 on (3 values in the run, 4 expected)"]);
}

#[test]
fn steps_at_equal_samples_come_at_equal_times() {
    let expected = || states(0, 10, &[0, 1, 1, 2, 2, 2, 1, 1]);
    let late = || states(500 * MS, 10, &[0, 1, 1, 1, 2, 2, 1, 1]);
    assert!(report(states(500 * MS, 10, &[0, 1, 1, 2, 2, 2, 1, 1]), expected(), &[]).passed());
    let report_1 = report(late(), expected(), &[]);
    assert_eq!(failures(&report_1, "x.state"), ["changes 0.01 s later than expected"]);
    assert!(report(late(), expected(), &["time=10 ms"]).passed());
}

#[test]
fn what_is_missing_or_nan_is_a_failure_and_what_is_more_is_a_note() {
    let one = |name: &str, value: f64| {
        let mut bag = TestBag::new();
        for sample in 0..10 {
            let last = if sample == 9 { value } else { 1.0 };
            bag.message("/joint_states", 0, &joints(sample * 10 * MS, &[(name, last), ("y", 1.0)]));
        }
        bag
    };
    let missing = report(one("z", 1.0), one("x", 1.0), &[]);
    assert_eq!(failures(&missing, "x.actual.position"), ["missing in the run"]);
    assert_eq!(missing.notes, ["the run has more signals: z.actual.position"]);
    assert!(missing.to_string().contains("\nnote: the run has more signals: z.actual.position\n"));
    let nan = report(one("x", f64::NAN), one("x", 1.0), &["*=1e30"]);
    assert_eq!(failures(&nan, "x.actual.position"), ["the value in the run is NaN"]);
    assert!(failures(&nan, "y.actual.position").is_empty());
    // A value that a joint does not measure cannot be expected.
    let never = |value: f64| moving(0, 10, 20, move |_| value);
    let unmeasured = |bag: TestBag| {
        let mut bag = bag;
        for sample in 0..20 {
            bag.message("/other/joint_states", 0, &joints(sample * 10 * MS, &[("e", f64::NAN)]));
        }
        bag
    };
    let report = report(unmeasured(never(1.0)), unmeasured(never(1.0)), &[]);
    assert!(report.passed() && report.lines.len() == 1);
    assert!(report.notes[0].starts_with("e.actual.position on /other/joint_states is NaN throughout"), "{report}");
}

#[test]
fn topics_belong_together_by_name_or_as_the_only_one_of_their_type() {
    let on = |topics: &[&str]| {
        let mut bag = TestBag::new();
        for sample in 0..10 {
            for topic in topics {
                bag.message(topic, 0, &joints(sample * 10 * MS, &[("x", 1.0)]));
            }
        }
        bag
    };
    assert!(report(on(&["/cell/joint_states"]), on(&["/joint_states"]), &[]).passed());
    let ambiguous = report(on(&["/a/joint_states", "/b/joint_states"]), on(&["/joint_states"]), &[]);
    assert_eq!(failures(&ambiguous, "x.actual.position"), ["missing in the run"]);
    let both = report(on(&["/a/joint_states", "/b/joint_states"]), on(&["/b/joint_states"]), &[]);
    assert!(both.passed(), "{both}");
}

#[test]
fn stamps_that_stand_still_or_go_back_are_failures() {
    let at = |times: &[u64]| {
        let mut bag = TestBag::new();
        for time in times {
            bag.message("/joint_states", 0, &joints(time * MS, &[("x", 1.0)]));
        }
        bag
    };
    let good = [0, 10, 20, 30, 40];
    let back = report(at(&[0, 10, 5, 20, 30, 40]), at(&good), &[]);
    assert_eq!(failures(&back, "x.actual.position"), ["stamps go back once"]);
    let still = report(at(&[0, 0, 0, 0, 0]), at(&good), &["time=1 s"]);
    assert_eq!(failures(&still, "x.actual.position"), ["in the run all 5 samples have one stamp"]);
}

#[test]
fn nothing_to_compare_is_refused() {
    let said = compared(moving(0, 1, 5, |_| 0.0), TestBag::new(), &[], Align::Start).unwrap_err().to_string();
    assert!(
        said.ends_with("expected.mcap: there is nothing to compare, neither joint_states nor axis_states"),
        "{said}"
    );
    let empty = report(TestBag::new(), moving(0, 1, 5, |_| 0.0), &[]);
    assert_eq!(failures(&empty, "x.actual.position"), ["missing in the run"]);
    let wrong = compared(moving(0, 1, 5, |_| 0.0), moving(0, 1, 5, |_| 0.0), &["y.position=1"], Align::Start);
    let said = wrong.unwrap_err().to_string();
    assert!(said.starts_with("--tolerance y.position=1: no signal matches `y.position`"), "{said}");
    assert!(said.ends_with("; there are x.actual.position"), "{said}");
}

#[test]
fn numbers_have_at_most_nine_digits() {
    let cases = [
        (0.0, "0"),
        (0.1 + 0.2, "0.3"),
        (1.0 / 3.0, "0.333333333"),
        (1.25e-7, "1.25e-7"),
        (-2.5e12, "-2.5e12"),
        (f64::NAN, "NaN"),
        (f64::INFINITY, "inf"),
    ];
    for (value, text) in cases {
        assert_eq!(compare::number(value), text);
    }
}

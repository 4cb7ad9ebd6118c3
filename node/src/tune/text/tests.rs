//! Tests the text of the report.

use super::*;
use crate::tune::test_axes::{before, cascade, effort_record, subject, wish};
use lineshaft_tune::{DesignSpec, Deviation, Identified, Model, PositionLaw, Resonance, Targets, design};

/// Returns a drive of 95493 inc/s with a lag of 6 ms and a delay of 1.5 ms.
fn of_velocities() -> Identified {
    let dynamics = Dynamics::Velocity { gain: 95_493.0, time_constant: 0.006, offset: -12.5 };
    let deviation = Deviation { gain: 31.4, time_constant: 2e-5, offset: 3.0, delay: 1e-5, ..Deviation::default() };
    let model = Model { cycle: 1e-3, delay: 1.5e-3, dynamics };
    Identified { model, deviation, explained: 99.9987, nrmse: 0.004 }
}

fn of_efforts() -> Identified {
    let resonance = Some(Resonance { frequency: 60.0, damping: 0.03, inertia_ratio: 3.0 });
    let dynamics = Dynamics::Effort { acceleration: 1e6, viscous: 1.5, coulomb: 3e4, load: -2e4, resonance };
    let deviation = Deviation { gain: 330.0, viscous: 0.004, coulomb: 42.0, frequency: 0.2, ..Deviation::default() };
    let model = Model { cycle: 1e-3, delay: 0.25e-3, dynamics };
    Identified { model, deviation, explained: 98.7654, nrmse: 0.01 }
}

fn found(identified: Identified) -> Findings {
    Findings::of(subject(), identified, &wish(), &before(), design(&identified.model, &wish()))
}

#[test]
fn model_is_shown_in_increments_and_in_the_axis_unit() {
    let text = found(of_velocities()).text();
    let expected = "\
axis x, 2000 inc in 1 rev

model of a drive of velocities, which explains more than 99.99 % of the motion:
    velocity at full command  95493 inc/s  +-31 inc/s     47.75 rev/s
    velocity at no command    -12.5 inc/s   +-3 inc/s  -0.00625 rev/s
    time constant                    6 ms   +-0.02 ms
    delay                          1.5 ms   +-0.01 ms

loops:
";
    assert!(text.starts_with(expected), "{text}");
}

/// The report in docs/loops.md is that of the axis whose plot is below it.
#[test]
fn the_report_of_the_docs_is_written_by_the_program() {
    let (wish, loops) = cascade();
    let text = Findings::find(subject(), &effort_record(), &wish, &loops).unwrap().text();
    let page = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/loops.md");
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains(&format!("```\n{text}```\n")), "put it there:\n{text}");
}

#[test]
fn a_drive_of_efforts_has_frictions_and_a_resonance() {
    let (wish, loops) = cascade();
    let identified = of_efforts();
    let text = Findings::of(subject(), identified, &wish, &loops, design(&identified.model, &wish)).text();
    for line in [
        "model of a drive of efforts, which explains 98.77 % of the motion:",
        "    acceleration at full command        1000000 inc/s^2  +-330 inc/s^2  500 rev/s^2",
        "    viscous friction                            1.5 1/s    +-0.004 1/s",
        "    Coulomb friction                      30000 inc/s^2   +-42 inc/s^2   15 rev/s^2",
        "    load                                 -20000 inc/s^2    +-0 inc/s^2  -10 rev/s^2",
        "    resonance                                     60 Hz       +-0.2 Hz",
        "    its damping                                    0.03            +-0",
        "    inertia of the load by the motor's                3            +-0",
        "  velocity loop",
    ] {
        assert!(text.lines().any(|known| known == line), "`{line}` is not in\n{text}");
    }
}

#[test]
fn an_axis_in_increments_has_no_second_column() {
    let subject = Subject { unit: "inc".to_owned(), increments: 1.0, ..subject() };
    let identified = of_velocities();
    let text = Findings::of(subject, identified, &wish(), &before(), design(&identified.model, &wish())).text();
    assert!(text.starts_with("axis x\n\nmodel"), "{text}");
    assert!(!text.contains("rev"), "{text}");
}

#[test]
fn a_share_of_a_unit_is_a_factor() {
    let subject = Subject { unit: "0.1 mm".to_owned(), increments: 100.0, ..subject() };
    assert_eq!(subject.in_unit(9000.0, 1), "90 * 0.1 mm/s");
    assert_eq!(subject.place(999.0), "999 inc");
}

#[test]
fn gains_stand_before_and_after_with_their_units() {
    let text = found(of_velocities()).text();
    let gains: Vec<&str> = text.lines().skip_while(|line| *line != "gains:").skip(1).collect();
    let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(words(gains[0]), ["before", "after"]);
    assert_eq!(words(gains[1])[..2], ["kprop", "30"]);
    assert_eq!(words(gains[7]), ["timer", "1", "ms", "1", "ms", "as", "it", "is"]);
    assert_eq!(gains.len(), 8);
    let changed: Vec<usize> = gains[1..5].iter().map(|line| line.len()).collect();
    assert!(changed.iter().all(|end| *end == changed[0]), "{text}");
}

#[test]
fn what_is_good_needs_no_sentence() {
    assert_eq!(found(of_velocities()).warnings(), [""; 0]);
    assert_eq!(found(of_efforts()).warnings().len(), 0);
}

#[test]
fn weak_model_is_reported() {
    let found = found(Identified { explained: 88.2, ..of_velocities() });
    assert_eq!(
        found.warnings(),
        ["The model explains 88 % of the motion; below 95 % gains that follow from it are doubtful."]
    );
    assert!(found.text().ends_with(&format!("\n{}\n", found.warnings()[0])));
}

#[test]
fn uncertain_value_is_reported_if_it_matters() {
    let good = of_velocities();
    let deviation = Deviation { time_constant: 0.9e-3, ..good.deviation };
    assert_eq!(
        found(Identified { deviation, ..good }).warnings(),
        ["The time constant is known to 15 % only; a longer excitation, or one with more way, tells it better."]
    );
    // As large as the offset itself, but less than the resolution of a loop; the same for a tenth of a cycle of delay.
    let deviation = Deviation { offset: 12.0, time_constant: 0.9e-4, ..good.deviation };
    assert_eq!(found(Identified { deviation, ..good }).warnings(), [""; 0]);
    let deviation = Deviation { gain: 10_000.0, ..good.deviation };
    assert!(
        found(Identified { deviation, ..good }).warnings()[0]
            .starts_with("The velocity at full command is known to 10 %")
    );
}

#[test]
fn unstable_loops_and_refused_designs_are_reported() {
    let mut loops = before();
    let PositionLaw::Pid { gains, .. } = &mut loops.position else { panic!() };
    gains.proportional = 20_000;
    let wish = DesignSpec { targets: Targets { phase_margin: 90.0, ..Targets::default() }, ..wish() };
    let identified = of_velocities();
    let found = Findings::of(subject(), identified, &wish, &loops, design(&identified.model, &wish));
    assert_eq!(
        found.warnings(),
        [
            "With the gains that are set the model is unstable.",
            "There are no gains: phase_margin is 90 deg; 20 to 85 deg is permitted."
        ]
    );
    let text = found.text();
    assert!(
        text.lines().any(|line| line.split_whitespace().collect::<Vec<_>>() == ["crossover", "unstable", "-"]),
        "{text}"
    );
    assert!(!text.contains("gains:\n"), "{text}");
}

#[test]
fn unsuitable_loops_are_reported() {
    let (_, loops) = cascade();
    let identified = of_velocities();
    let found = Findings::of(subject(), identified, &wish(), &loops, design(&identified.model, &wish()));
    assert_eq!(
        found.warnings(),
        [
            "The loops that are set cannot be shown: the drive takes velocities; a velocity loop suits one that takes efforts."
        ]
    );
}

#[test]
fn no_line_is_longer_than_a_terminal_of_120() {
    for text in [found(of_velocities()).text(), found(of_efforts()).text()] {
        assert!(text.is_ascii() && text.ends_with('\n'));
        for line in text.lines() {
            assert!(line.len() <= 120 && line.trim_end() == line, "{line}");
        }
    }
}

#[test]
fn numbers_have_their_digits() {
    let four = |value: f64| rounded(value, 4);
    assert_eq!(four(0.0), "0");
    assert_eq!(four(1_234_567.0), "1234567");
    assert_eq!(four(12.3456), "12.35");
    assert_eq!(four(-0.012_345), "-0.01235");
    assert_eq!(four(99.999_99), "100");
    assert_eq!(four(1e-7), "1.000e-7");
    assert_eq!(four(f64::INFINITY), "inf");
    assert_eq!([frequency(0.0), decibel(f64::INFINITY), decibel(12.34)], ["none", "without end", "12.3 dB"]);
    assert_eq!([share(99.995), share(99.98), share(80.0)], ["more than 99.99", "99.98", "80"]);
}

//! Tests the content of the picture.

use super::*;
use crate::tune::test_axes::{before, cascade, effort_record, subject, velocity_record, wish};
use lineshaft_tune::{DesignSpec, Loops, PositionLaw, Targets};

fn svg(found: &Findings, record: &Record) -> String {
    String::from_utf8(draw_plot(found, record, Target::Svg).unwrap()).unwrap()
}

fn of_velocities(wish: &DesignSpec, loops: &Loops) -> String {
    let record = velocity_record();
    svg(&Findings::find(subject(), &record, wish, loops).unwrap(), &record)
}

/// docs/images/tune_torque.svg is the report of such an axis. `LINESHAFT_RENEW=1 cargo test -p lineshaft --lib tune`
/// draws it again.
#[test]
fn the_figure_of_the_docs_is_drawn_by_the_program() {
    let (wish, loops) = cascade();
    let record = effort_record();
    let made = svg(&Findings::find(subject(), &record, &wish, &loops).unwrap(), &record);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/images/tune_torque.svg");
    if std::env::var_os("LINESHAFT_RENEW").is_some() {
        std::fs::write(&path, &made).unwrap();
    }
    let there = std::fs::read_to_string(&path).unwrap();
    assert!(there == made, "draw it anew: LINESHAFT_RENEW=1 cargo test -p lineshaft --lib tune");
}

#[test]
fn panels_have_labels_with_units_and_both_sides() {
    let svg = of_velocities(&wish(), &before());
    for text in [
        "axis x: loops before and after",
        "frequency (Hz)",
        "open loop (dB)",
        "phase (deg)",
        "time (ms)",
        "step (inc)",
        "target",
        "record (rev)",
        "measured",
        "modelled",
        "residual (inc)",
        "time (s)",
        "before: phase margin ",
        "after: phase margin 60 deg",
    ] {
        assert!(svg.contains(text), "`{text}` is not in it");
    }
    // The legends of the response and of the step.
    assert_eq!((svg.matches("\nbefore\n").count(), svg.matches("\nafter\n").count()), (2, 2));
}

/// A mark has the values of the table: crossover and both margins, once in the panel and once next to it.
#[test]
fn crossover_and_margins_are_marked() {
    let record = velocity_record();
    let found = Findings::find(subject(), &record, &wish(), &before()).unwrap();
    let margins = found.after.as_ref().unwrap().position.margins;
    let svg = svg(&found, &record);
    for text in [frequency(margins.crossover), decibel(margins.gain), format!("{:.0} deg", margins.phase)] {
        assert_eq!(svg.matches(&format!("\n{text}\n")).count(), 1, "{text}");
    }
}

/// The phase of the margin is relative to -180 degrees, whatever the number of full turns is.
#[test]
fn phases_are_shown_around_the_margin() {
    let found = Findings::find(subject(), &velocity_record(), &wish(), &before()).unwrap();
    let bode = found.after.unwrap().position;
    let expected = bode.margins.phase - 180.0;
    for turns in [-720.0, -360.0, 0.0, 360.0, 720.0] {
        let mut gone_on = bode.clone();
        gone_on.points.iter_mut().for_each(|point| point.open_phase += turns);
        let at = turned(&gone_on)(&gone_on.at_phase_margin().unwrap());
        assert!((at.open_phase - expected).abs() < 0.1, "{turns}: {} {expected}", at.open_phase);
    }
}

#[test]
fn unstable_loops_are_named_and_have_no_margins() {
    let mut loops = before();
    let PositionLaw::Pid { gains, .. } = &mut loops.position else { panic!() };
    gains.proportional = 20_000;
    let svg = of_velocities(&wish(), &loops);
    assert!(svg.contains("before: unstable") && !svg.contains("before: phase margin"));
    assert!(svg.contains("before: not within 4 inc") && svg.contains("after: phase margin"));
}

#[test]
fn without_gains_the_loops_that_are_set_are_shown_with_their_margins() {
    let refused = DesignSpec { targets: Targets { phase_margin: 90.0, ..Targets::default() }, ..wish() };
    let svg = of_velocities(&refused, &before());
    assert!(svg.contains("before: phase margin") && !svg.contains("\nafter\n"));
}

#[test]
fn without_any_loops_the_record_is_left() {
    let (_, loops) = cascade();
    let refused = DesignSpec { targets: Targets { phase_margin: 90.0, ..Targets::default() }, ..wish() };
    let svg = of_velocities(&refused, &loops);
    assert!(svg.contains("record (rev)") && !svg.contains("frequency (Hz)"));
}

#[test]
fn a_file_is_written_by_its_ending() {
    let folder = tempfile::tempdir().unwrap();
    let record = velocity_record();
    let found = Findings::find(subject(), &record, &wish(), &before()).unwrap();
    for (name, begins) in [("a.svg", &b"<svg"[..]), ("a.PNG", &b"\x89PNG"[..])] {
        let path = folder.path().join(name);
        write_plot(&found, &record, &path).unwrap();
        assert!(std::fs::read(&path).unwrap().starts_with(begins), "{name}");
    }
    let refused = write_plot(&found, &record, &folder.path().join("a.pdf")).unwrap_err();
    assert!(matches!(refused, Problem::Ending { .. }));
}

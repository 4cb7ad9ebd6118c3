//! Tests the content of figures.

use super::{figure, mark, sampled, series, states, svg, texts};
use crate::recording::plot::{Figure, Target, draw, write};
use crate::recording::series::{EventMark, Kind, Series};
use std::fs;

fn run() -> Vec<Series> {
    vec![
        sampled("x.command.position", "mm", Kind::Int, 2000, |time| 60.0 * time),
        sampled("x.actual.position", "mm", Kind::Int, 2000, |time| 60.0 * time - 0.1),
        sampled("x.command.acceleration", "mm/s^2", Kind::Real, 2000, |time| (9.0 * time).sin() * 4e6),
        sampled("x.following_error", "mm", Kind::Int, 2000, |time| 0.1 * time.sin()),
        sampled("x.state", "", states(), 2000, |time| if time < 1.0 { 1.0 } else { 2.0 }),
        sampled("x.in_position", "", Kind::Bit, 2000, |time| if time < 1.0 { 1.0 } else { 0.0 }),
        sampled("x.homed", "", Kind::Bit, 2000, |_| 1.0),
        sampled("x.target.position", "mm", Kind::Int, 2000, |_| 120.0),
    ]
}

fn events() -> Vec<EventMark> {
    vec![
        mark(0.5, 1, "refused", "target 900 mm exceeds max_position 850 mm"),
        mark(1.0, 0, "accepted", "move_axis accepted"),
        mark(1.5, 2, "error", "following error <12 mm & more>"),
    ]
}

#[test]
fn panels_have_their_names_units_legends_lanes_and_events() {
    let (signals, marks) = (run(), events());
    let svg = svg(&figure(&signals, &marks));
    let texts = texts(&svg);
    for text in [
        "A run",
        "position (mm)",
        "acceleration (km/s\u{b2})",
        "error (mm)",
        "x.command.position",
        "x.actual.position",
        "x.command.acceleration",
        "x.following_error",
        "x.state",
        "STANDSTILL",
        "DISCRETE_MOTION",
        "x.in_position",
        "time (s)",
        "0.500 s  x: target 900 mm exceeds max_position 850 mm",
        "1.500 s  x: following error &lt;12 mm &amp; more&gt;",
        "events not listed: 1 accepted",
        "constant: x.homed 1, x.target.position 120 mm",
    ] {
        assert!(texts.contains(&text), "`{text}` is not in {texts:?}");
    }
    assert!(!texts.iter().any(|text| text.contains("move_axis accepted")));
}

#[test]
fn every_axis_has_a_unit_and_prefixes_are_the_usual_ones() {
    let signals = vec![
        sampled("line.command.position", "m", Kind::Int, 1000, |time| time * 4e-3),
        sampled("x.phase.master", "", Kind::Real, 1000, |time| 1.0 - time),
        sampled("roll.command.velocity", "rev/s", Kind::Real, 1000, |time| time * 2.0),
        sampled("wheel.velocity", "rad/s", Kind::Real, 1000, |time| time * 6.0),
        sampled("lag", "", Kind::Real, 1000, |time| time * 9.0),
    ];
    let svg = svg(&figure(&signals, &[]));
    let texts = texts(&svg);
    for text in ["position (mm)", "phase shift left (1)", "velocity (rev/s)", "value (1)", "time (s)"] {
        assert!(texts.contains(&text), "`{text}` is not in {texts:?}");
    }
    assert!(!svg.contains("rad/s"), "rad/s and rev/s are in one figure");
}

/// Returns the attribute `name` of a tag as a number.
fn numbers(tag: &str, name: &str) -> f64 {
    let text = tag.split(&format!("{name}=\"")).nth(1).and_then(|rest| rest.split('"').next());
    text.and_then(|text| text.parse().ok()).unwrap_or_default()
}

#[test]
fn nothing_is_cut_off_in_narrow_figures() {
    let signals: Vec<Series> = ["a.command.position", "the_second_roller.command.position", "b.actual.position"]
        .iter()
        .map(|name| sampled(name, "mm", Kind::Int, 20_001, |time| time))
        .chain([sampled("the_second_roller.in_position", "", Kind::Bit, 20_001, |time| f64::from(time > 0.5))])
        .collect();
    let marks =
        [mark(0.5, 2, "error", "a sentence of many words that needs more than one line in a narrow figure, and more")];
    for width in [500, 700, 900] {
        let title = "Two rollers, of which the second one is five per cent faster while the web is tight".to_owned();
        let svg = svg(&Figure { title: title.clone(), width, ..figure(&signals, &marks) });
        let edge = f64::from(width) * 10.0;
        for tag in svg.split("<text").skip(1) {
            let text = tag.split_once(">\n").and_then(|(_, rest)| rest.split_once("\n</text>")).unwrap().0;
            let (x, size) = (numbers(tag, "x"), numbers(tag, "font-size"));
            let length = crate::recording::plot::text::width(text, size);
            let (left, right) = match tag {
                tag if tag.contains("rotate") => continue,
                tag if tag.contains("\"end\"") => (x - length, x),
                tag if tag.contains("\"middle\"") => (x - length / 2.0, x + length / 2.0),
                _ => (x, x + length),
            };
            assert!(left >= 0.0 && right <= edge, "{width}: `{text}` from {left} to {right}");
        }
        let all = texts(&svg).join(" ");
        assert!(all.contains(&title), "{all}");
        assert!(all.contains("the_second_roller.command.position"), "{all}");
        assert!(all.contains("in a narrow figure, and more"), "{all}");
    }
}

#[test]
fn a_split_figure_has_a_panel_for_each_curve() {
    let signals = run();
    let panels = |split| svg(&Figure { split, ..figure(&signals[..2], &[]) }).matches("\nposition (mm)\n").count();
    assert_eq!((panels(false), panels(true)), (1, 2));
}

#[test]
fn the_legend_is_outside_of_the_plot() {
    let signals = run();
    let svg = svg(&figure(&signals[..2], &[]));
    let legend = svg.split("<text").find(|tag| tag.contains("\nx.actual.position\n")).unwrap();
    let curve = svg.split("<polyline").filter(|tag| tag.contains("stroke-width=\"26\"")).nth(1).unwrap();
    let points = curve.split("points=\"").nth(1).unwrap().split('"').next().unwrap();
    let highest =
        points.split_whitespace().filter_map(|xy| xy.split_once(',')?.1.parse::<f64>().ok()).fold(1e9, f64::min);
    assert!(numbers(legend, "y") + 80.0 < highest);
}

#[test]
fn a_signal_that_never_changes_is_drawn_where_it_is_named() {
    let signals = run();
    let mut figure = figure(&signals, &[]);
    figure.signals[6].by_name = true;
    let svg = svg(&figure);
    let texts = texts(&svg);
    assert!(texts.contains(&"x.homed"));
    assert!(texts.contains(&"constant: x.target.position 120 mm"));
}

#[test]
fn only_constant_signals_are_reported_as_text() {
    let signals = vec![sampled("x.homed", "", Kind::Bit, 2000, |_| 1.0)];
    let problem = draw(&figure(&signals, &[]), Target::Svg).unwrap_err();
    assert_eq!(
        problem.to_string(),
        "none of the 1 chosen signals changes from 0 s to 1.999 s; one that is named in full is drawn all the same"
    );
}

#[test]
fn only_the_requested_time_is_drawn() {
    let (signals, marks) = (run(), events());
    let svg = svg(&Figure { from: Some(0.9), to: Some(1.2), ..figure(&signals, &marks) });
    let texts = texts(&svg);
    assert!(texts.contains(&"0.90") && texts.contains(&"1.20"), "{texts:?}");
    assert!(!texts.iter().any(|text| text.contains("900 mm")));
    let problem =
        |from, to| draw(&Figure { from, to, ..figure(&signals, &marks) }, Target::Svg).unwrap_err().to_string();
    assert_eq!(problem(Some(3.0), Some(1.0)), "the figure would end at 1 s, before its start at 3 s");
    assert_eq!(
        problem(Some(3.0), None),
        "no chosen signal has a value from 3 s on; they have values from 0 s to 1.999 s"
    );
    let said = "no chosen signal has a value from 3 s to 4 s; they have values from 0 s to 1.999 s";
    assert_eq!(problem(Some(3.0), Some(4.0)), said);
    assert_eq!(
        problem(None, Some(-1.0)),
        "no chosen signal has a value up to -1 s; they have values from 0 s to 1.999 s"
    );
}

#[test]
fn what_is_not_drawn_is_named_below() {
    let line = |name: &str, odd: f64| sampled(name, "mm", Kind::Real, 1000, |t| if t == 0.5 { odd } else { t });
    let mut signals = vec![
        line("x.actual.position", f64::NAN),
        line("y.actual.position", 1e200),
        line("z.actual.position", 0.5),
        sampled("x.command.fraction", "", Kind::Real, 1000, |time| (time * 1e5).fract()),
    ];
    signals[2].gaps = vec![(0.1, 0.2), (0.7, 0.8)];
    let svg = svg(&figure(&signals, &[]));
    let texts = texts(&svg);
    for text in [
        "NaN or infinite: x.actual.position once",
        "beyond \u{b1}1e150, not drawn: y.actual.position once",
        "values missing: z.actual.position 2 times, first from 0.1 s to 0.2 s",
        "drawn only if named in full: x.command.fraction",
    ] {
        assert!(texts.contains(&text), "`{text}` is not in {texts:?}");
    }
    assert!(!texts.contains(&"fraction (1)"));
}

#[test]
fn a_fraction_is_drawn_where_it_is_named_or_nothing_else_is() {
    let fraction = || sampled("x.command.fraction", "", Kind::Real, 1000, |time| (time * 7.0).fract());
    let signals = vec![fraction(), sampled("x.actual.position", "mm", Kind::Int, 1000, |time| time)];
    assert!(texts(&svg(&figure(&signals[..1], &[]))).contains(&"fraction (1)"));
    let mut figure = figure(&signals, &[]);
    figure.signals[0].by_name = true;
    assert!(texts(&svg(&figure)).contains(&"fraction (1)"));
}

#[test]
fn signals_with_equal_names_are_distinguished_by_topic() {
    let mut signals: Vec<Series> = ["/left/joint_states", "/right/joint_states"]
        .map(|topic| Series {
            topic: topic.to_owned(),
            ..sampled("x.actual.position", "SI", Kind::Real, 1000, |time| time)
        })
        .to_vec();
    signals.push(sampled("y.actual.position", "SI", Kind::Real, 1000, |time| time));
    let svg = svg(&Figure { width: 2000, ..figure(&signals, &[]) });
    let names: Vec<&str> = texts(&svg).into_iter().filter(|text| text.contains("actual.p")).collect();
    assert_eq!(names.len(), 3, "{names:?}");
    assert!(
        names[0] != names[1] && names[0].ends_with("joint_states") && names[1].ends_with("joint_states"),
        "{names:?}"
    );
    assert_eq!(names[2], "y.actual.position");
}

#[test]
fn many_expected_events_make_no_fence() {
    let signals = run();
    let marks: Vec<EventMark> = (0..300).map(|n| mark(f64::from(n) * 6e-3, 0, "done", "done")).collect();
    // Horizontal positions of the vertical lines of events.
    let tall = |svg: &str| {
        let upright = svg.split("<polyline").filter(|line| line.contains(r##"stroke="#787878""##));
        let places = upright.filter_map(|line| {
            let points = line.split("points=\"").nth(1)?.split('"').next()?;
            let points: Vec<(i32, i32)> = points
                .split_whitespace()
                .filter_map(|xy| xy.split_once(','))
                .filter_map(|(x, y)| Some((x.parse().ok()?, y.parse().ok()?)))
                .collect();
            let [from, to] = points[..] else { return None };
            (from.0 == to.0 && from.1.abs_diff(to.1) > 1000).then_some(from.0)
        });
        places.collect::<std::collections::BTreeSet<_>>().len()
    };
    assert_eq!(tall(&svg(&figure(&signals, &marks[..12]))), 12);
    assert_eq!(tall(&svg(&figure(&signals, &marks))), 12);
}

#[test]
fn what_changes_too_fast_is_in_the_legend() {
    let fast = sampled("x.state", "", states(), 60_000, |time| f64::from((time * 1e3) as u32 % 2 + 1));
    let slow = run().swap_remove(4);
    let busy = |signals: &[Series]| texts(&svg(&figure(signals, &[]))).contains(&"changes too fast to show");
    assert!(busy(&[fast]));
    assert!(!busy(&[slow]));
}

#[test]
fn codes_have_their_names() {
    let code = sampled("x.error", "", Kind::Code, 1000, |time| if time < 0.5 { 0.0 } else { 10_201.0 });
    let svg = svg(&figure(&[code], &[]));
    let texts = texts(&svg);
    assert!(texts.contains(&"NONE") && texts.contains(&"FOLLOWING_ERROR"), "{texts:?}");
}

#[test]
fn the_legend_of_64_axes_names_them_all() {
    let signals: Vec<Series> = (0..64)
        .map(|place| {
            sampled(&format!("axis_of_the_long_conveyor_{place}.actual.position"), "mm", Kind::Int, 100, |t| t)
        })
        .collect();
    let svg = svg(&figure(&signals, &[]));
    let mut names: Vec<&str> =
        texts(&svg).into_iter().filter(|text| text.contains("position") && *text != "position (mm)").collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), 64, "{names:?}");
}

#[test]
fn a_figure_of_nothing_is_refused() {
    assert_eq!(draw(&figure(&[], &[]), Target::Svg).unwrap_err().to_string(), "no signal is chosen");
    let empty = [series("x.homed", "", Kind::Bit, Vec::new())];
    let problem = draw(&figure(&empty, &[]), Target::Svg).unwrap_err();
    assert_eq!(problem.to_string(), "no chosen signal has a value");
}

#[test]
fn the_same_figure_makes_the_same_bytes() {
    let (signals, marks) = (run(), events());
    for target in [Target::Svg, Target::Png] {
        let figure = figure(&signals, &marks);
        assert_eq!(draw(&figure, target).unwrap(), draw(&figure.clone(), target).unwrap());
    }
}

#[test]
fn png_has_the_requested_size() {
    let signals = run();
    let file = draw(&Figure { width: 900, height: Some(700), ..figure(&signals, &[]) }, Target::Png).unwrap();
    let reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
    assert_eq!((reader.info().width, reader.info().height), (900, 700));
}

/// 10 min of noise and of fast bits at 1 kHz is the worst case: four points per pixel column, whatever the length of
/// the run.
#[test]
fn figures_of_long_runs_stay_small() {
    let noise = |time: f64| (time * 12_345.678).sin();
    let mut signals: Vec<Series> = (0..6)
        .map(|place| sampled(&format!("x{place}.command.velocity"), "mm/s", Kind::Real, 600_000, noise))
        .collect();
    signals.push(sampled("x.in_position", "", Kind::Bit, 600_000, |time| f64::from(noise(time) > 0.0)));
    let marks: Vec<EventMark> = (0..100_000).map(|n| mark(f64::from(n) * 6e-3, 0, "latch", "latch of mark")).collect();
    let svg = svg(&figure(&signals, &marks));
    let points = svg.split("points=\"").skip(1).filter_map(|rest| rest.split('"').next());
    let points: usize = points.map(|points| points.split_whitespace().count()).sum();
    assert!(points < 7 * 4 * 1200 + 2000, "{points} points");
    assert!(svg.len() < 3_000_000, "{} bytes", svg.len());
    draw(&figure(&signals, &marks), Target::Png).unwrap();
}

#[test]
fn a_file_is_replaced_in_one_step_and_a_failure_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (signals, path) = (run(), folder.path().join("run.SVG"));
    fs::write(&path, "old").unwrap();
    write(&figure(&signals, &[]), &path).unwrap();
    assert!(fs::read_to_string(&path).unwrap().starts_with("<svg "));
    assert!(write(&figure(&[], &[]), &path).is_err());
    assert!(fs::read_to_string(&path).unwrap().starts_with("<svg "), "the old file stays");
    // A folder in place of the file.
    let taken = folder.path().join("taken.png");
    fs::create_dir(&taken).unwrap();
    let problem = write(&figure(&signals, &[]), &taken).unwrap_err().to_string();
    assert!(problem.starts_with(&format!("cannot write {}: ", taken.display())), "{problem}");
    let mut names: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["run.SVG", "taken.png"]);
}

#[test]
fn other_endings_are_refused() {
    for name in ["run.pdf", "run", ".svg"] {
        let problem = write(&figure(&[], &[]), name.as_ref()).unwrap_err();
        assert_eq!(problem.to_string(), format!("{name} ends with neither .svg nor .png"));
    }
}

#[test]
fn sizes_that_hold_no_figure_are_refused_with_the_needed_size() {
    let signals = run();
    let problem = |width, height| draw(&Figure { width, height, ..figure(&signals, &[]) }, Target::Svg).unwrap_err();
    let low = problem(1200, Some(300)).to_string();
    assert!(
        low.starts_with("3 panels and 2 lanes need a height of ") && low.ends_with(" px or more, not 300 px"),
        "{low}"
    );
    assert_eq!(problem(1200, Some(90)).to_string(), "height 90 px is outside 200 to 20000 px");
    assert_eq!(problem(100, None).to_string(), "width 100 px is outside 500 to 8000 px");
    let lanes: Vec<Series> =
        (0..1000).map(|n| sampled(&format!("b{n}"), "", Kind::Bit, 10, |time| f64::from(time > 0.005))).collect();
    let high = draw(&figure(&lanes, &[]), Target::Svg).unwrap_err().to_string();
    assert!(high.starts_with("0 panels and 1000 lanes would need a height of 26"), "{high}");
}

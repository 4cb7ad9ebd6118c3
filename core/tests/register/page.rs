//! The part of docs/cams.md about these runs: a table, and errors over marks with a panel for each run.

use crate::press::{Pass, Run, Taken};
use crate::svg::Svg;
use crate::web::MARKS;
use std::fmt::Write;
use std::path::Path;

const RENEW: &str = "write it anew: LINESHAFT_RENEW=1 cargo test -p lineshaft-core --test register";
/// Lines before and after the table.
const BEGIN: &str = "<!-- begin register: LINESHAFT_RENEW=1 cargo test -p lineshaft-core --test register -->\n";
const END: &str = "<!-- end register -->";
/// Increments in a millimetre.
const MM: f64 = 200.0;

/// Compares table and drawing with those of these runs.
#[track_caller]
pub(crate) fn check(runs: &[(&str, Run)]) {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let page = std::fs::read_to_string(docs.join("cams.md")).expect("a page");
    let (head, rest) = page.split_once(BEGIN).expect("a begin");
    let (_, foot) = rest.split_once(END).expect("an end");
    same(&docs.join("cams.md"), &format!("{head}{BEGIN}\n{}\n{END}{foot}", table(runs)));
    same(&docs.join("images/register_10000.svg"), &drawing(runs));
}

#[track_caller]
fn same(file: &Path, made: &str) {
    if std::env::var_os("LINESHAFT_RENEW").is_some() {
        return std::fs::write(file, made).expect("docs can be written");
    }
    let there = std::fs::read_to_string(file).unwrap_or_default();
    let different = there.lines().zip(made.lines()).find(|(there, made)| there != made);
    assert_eq!(different, None, "{RENEW}");
    assert!(there == made, "{RENEW}");
}

/// Returns the table of register errors (mm), and of the results of the marks.
fn table(runs: &[(&str, Run)]) -> String {
    let mut table = String::from(
        "| register error (mm) | mean | standard deviation | peak | corrected | of them false | refused outside W | second in their turn | turns without a valid mark |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    for (name, run) in runs {
        let errors: Vec<f64> = run.passes.iter().map(|pass| pass.error as f64 / MM).collect();
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        let variance = errors.iter().map(|error| (error - mean) * (error - mean)).sum::<f64>() / errors.len() as f64;
        let peak = errors.iter().fold(0.0_f64, |peak, error| peak.max(error.abs()));
        write!(table, "| {name} | {mean:.2} | {:.2} | {peak:.2} | ", variance.sqrt()).expect("a text takes every line");
        if run.passes.iter().all(|pass| pass.correction == 0) {
            table.push_str("| | | | |\n");
            continue;
        }
        let count = run.count;
        let nothing = run.passes.iter().filter(|pass| pass.taken == Taken::Nothing).count();
        writeln!(
            table,
            "{} | {} | {} | {} | {nothing} |",
            count.printed + count.wrong,
            count.wrong,
            count.outside,
            count.second
        )
        .expect("a text takes every line");
    }
    table
}

const WIDTH: f64 = 820.0;
/// Height of a panel, and of the curve within it.
const PANEL: f64 = 190.0;
const HEIGHT: f64 = 140.0;
const LEFT: f64 = 52.0;
const RIGHT: f64 = 806.0;
const TOP: f64 = 30.0;
/// Height below the panels.
const FOOT: f64 = 24.0;
const COLOURS: [&str; 3] = ["#c92a2a", "#e67700", "#1f77b4"];

fn drawing(runs: &[(&str, Run)]) -> String {
    let mut svg = Svg::new(WIDTH, PANEL * runs.len() as f64 + FOOT);
    for (place, ((name, run), colour)) in runs.iter().zip(COLOURS).enumerate() {
        panel(&mut svg, name, &run.passes, PANEL * place as f64, colour);
    }
    let foot = PANEL * runs.len() as f64 + FOOT - 8.0;
    svg.text(((LEFT + RIGHT) / 2.0, foot), "marks", "middle", "#333");
    svg.finish()
}

/// Distances between the lines of a scale (mm); the first one with at most six lines is used.
const STEPS: [f64; 12] = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0];

/// Draws the errors of a run (mm), each at its mark.
fn panel(svg: &mut Svg, name: &str, passes: &[Pass], top: f64, colour: &str) {
    let errors: Vec<f64> = passes.iter().map(|pass| pass.error as f64 / MM).collect();
    let (least, most) = errors.iter().fold((0.0_f64, 0.0_f64), |(low, high), mm| (low.min(*mm), high.max(*mm)));
    let step = STEPS.into_iter().find(|step| 6.0 * step >= most - least).expect("errors of 3 m at most");
    let (low, high) = ((least / step).floor() * step, (most / step).ceil() * step);
    let floor = top + TOP + HEIGHT;
    let across = |n: usize| LEFT + n as f64 / MARKS as f64 * (RIGHT - LEFT);
    let up = |mm: f64| floor - (mm - low) / (high - low) * HEIGHT;
    svg.text((LEFT, top + TOP - 10.0), &format!("register error (mm), {name}"), "start", "#111");
    for line in 0..=((high - low) / step).round() as i32 {
        let mm = low + f64::from(line) * step;
        let strong = if mm.abs() < step / 2.0 { "#adb5bd" } else { "#e9ecef" };
        svg.line((LEFT, up(mm)), (RIGHT, up(mm)), strong, 1.0);
        let digits = if step < 1.0 { 1 } else { 0 };
        svg.text((LEFT - 6.0, up(mm) + 4.0), &format!("{mm:.digits$}"), "end", "#666");
    }
    for mark in (0..=MARKS).step_by(1000) {
        svg.line((across(mark), floor), (across(mark), floor + 4.0), "#adb5bd", 1.0);
        let anchor = if mark == MARKS { "end" } else { "middle" };
        svg.text(
            (across(mark) + if mark == MARKS { 8.0 } else { 0.0 }, floor + 16.0),
            &format!("{mark}"),
            anchor,
            "#666",
        );
    }
    svg.path(&shown(&errors).map(|n| (across(n), up(errors[n]))).collect::<Vec<_>>(), colour);
}

/// Returns the lowest and the highest mark of each column of the picture, in their order.
fn shown(errors: &[f64]) -> impl Iterator<Item = usize> {
    let wide = errors.len().div_ceil((RIGHT - LEFT) as usize);
    errors.chunks(wide).zip(0..).flat_map(move |(column, nth)| {
        let by = |a: &usize, b: &usize| column[*a].total_cmp(&column[*b]);
        let [low, high] = [(0..column.len()).min_by(by), (0..column.len()).max_by(by)].map(Option::unwrap_or_default);
        [low.min(high), low.max(high)].map(|place| wide * nth + place)
    })
}

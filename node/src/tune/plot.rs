//! Draws findings: the open position loop before and after, a step before and after, and the record with its model.
//!
//! Law      magnitude and phase over one logarithmic axis, with crossover and both margins of the proposed loop, or of
//!          the present one if there is no other; the record in sections, each from the point at which the model is
//!          closest to it
//! Reads    findings, and their record
//! Writes   an SVG or a PNG
//! Refuses  the same as figures ([`Problem`]); an invalid record has no panel

use super::findings::{Answer, Findings};
use super::text::{decibel, frequency, rounded, share};
use crate::recording::plot::{
    Axis, Chart, Curve, LineStyle, MeasureMark, Panel, Problem, Spacing, Target, draw_chart, replace,
};
use lineshaft_tune::{Bode, Point, Record, retrace};
use std::path::Path;

const WIDTH: u32 = 1000;

/// Heights of magnitude, phase, step, record, difference, in px.
const HEIGHTS: [f64; 5] = [210.0, 170.0, 210.0, 190.0, 90.0];

/// Frequency range, as multiples of the crossovers.
const AROUND: (f64, f64) = (0.03, 30.0);

/// Maximum magnitude, positive and negative, in dB.
const MOST_GAIN: f64 = 60.0;

/// Range of phases, in degrees.
const PHASES: (f64, f64) = (-405.0, 45.0);

/// Range of a step, as multiples of its size.
const STEP_SHOWN: (f64, f64) = (-0.3, 1.8);

/// Margin above and below curves, as a fraction of their range.
const AIR: f64 = 0.08;

/// Name, line style and behaviour of one set of loops.
type Side<'a> = (&'static str, LineStyle, &'a Answer);

/// Draws the findings of a record.
///
/// # Errors
/// Returns a [`Problem`].
pub fn draw_plot(findings: &Findings, record: &Record, target: Target) -> Result<Vec<u8>, Problem> {
    draw_chart(&chart(findings, record), target)
}

/// Draws them into a file in the format of its extension; an existing file is replaced.
///
/// # Errors
/// Returns a [`Problem`].
pub fn write_plot(findings: &Findings, record: &Record, path: &Path) -> Result<(), Problem> {
    replace(path, &draw_plot(findings, record, Target::of(path)?)?)
}

fn chart(findings: &Findings, record: &Record) -> Chart {
    let before = findings.before.as_ref().ok().map(|answer| ("before", LineStyle::Old, answer));
    let after = findings.after.as_ref().ok().map(|answer| ("after", LineStyle::New, answer));
    let sides: Vec<Side<'_>> = [before, after].into_iter().flatten().collect();
    let mut panels = Vec::new();
    if !sides.is_empty() {
        panels.extend(response(&sides));
        panels.push(step(findings, &sides));
    }
    panels.extend(fit(findings, record).into_iter().flatten());
    Chart { title: format!("axis {}: loops before and after", findings.subject.axis), panels, width: WIDTH }
}

fn axis(label: &str, low: f64, high: f64, spacing: Spacing) -> Axis {
    Axis { label: label.to_owned(), low, high, spacing }
}

/// Shifts phases by full turns, so that the phase of the margin is between -360 and 0 degrees.
fn turned(bode: &Bode) -> impl Fn(&Point) -> Point + use<> {
    let at = bode.at_phase_margin().or_else(|| bode.points.first().copied());
    let turns = at.map_or(0.0, |at| (at.open_phase / 360.0).ceil());
    move |point| Point { open_phase: point.open_phase - 360.0 * turns, ..*point }
}

/// Returns the panels of magnitude and phase.
fn response(sides: &[Side<'_>]) -> [Panel; 2] {
    let crossovers = || sides.iter().map(|side| side.2.position.margins.crossover).filter(|f| *f > 0.0);
    let ends = || sides.iter().filter_map(|side| side.2.position.points.last()).map(|point| point.frequency);
    let highest = ends().fold(0.0, f64::max);
    let low = crossovers().fold(highest / 100.0, f64::min) * AROUND.0;
    let high = (crossovers().fold(low, f64::max) * AROUND.1).min(highest);
    let is_shown = |point: &&Point| (low..=high).contains(&point.frequency);
    let curves = |of: &dyn Fn(&Point) -> f64| -> Vec<Curve> {
        let curve = |(name, look, answer): &Side<'_>| {
            let turned = turned(&answer.position);
            let points =
                answer.position.points.iter().filter(is_shown).map(|point| (point.frequency, of(&turned(point))));
            let is_stable = answer.position.margins.is_stable();
            let name = if is_stable { (*name).to_owned() } else { format!("{name}: unstable") };
            Curve { name, look: *look, points: points.collect() }
        };
        sides.iter().map(curve).collect()
    };
    let (gains, phases) = (curves(&|point| point.open_gain), curves(&|point| point.open_phase));
    let (gain_low, gain_high) = extent(&gains, (-MOST_GAIN, MOST_GAIN));
    let (phase_low, phase_high) = extent(&phases, PHASES);
    let across = || axis("frequency (Hz)", low, high, Spacing::Decades);
    let of_gain = |bode: &Bode| format!("crossover {}", frequency(bode.margins.crossover));
    let of_margin = |bode: &Bode| format!("gain margin {}", decibel(bode.margins.gain));
    let of_phase = |bode: &Bode| format!("phase margin {:.0} deg", bode.margins.phase);
    let said = |texts: &[&dyn Fn(&Bode) -> String]| -> Vec<String> {
        let stable = sides.iter().filter(|side| side.2.position.margins.is_stable());
        stable.flat_map(|side| texts.iter().map(|text| format!("{}: {}", side.0, text(&side.2.position)))).collect()
    };
    let marked = sides.last().map(|side| &side.2.position).filter(|bode| bode.margins.is_stable());
    let (gain_pins, phase_pins) = marked.map_or_else(Default::default, pins);
    [
        Panel {
            across: across(),
            up: axis("open loop (dB)", gain_low, gain_high, Spacing::Steps(20.0)),
            curves: gains,
            pins: gain_pins,
            level: Some(0.0),
            lines: said(&[&of_gain, &of_margin]),
            height: HEIGHTS[0],
            is_joined: true,
        },
        Panel {
            across: across(),
            up: axis("phase (deg)", phase_low, phase_high, Spacing::Steps(45.0)),
            curves: phases.into_iter().map(|curve| Curve { name: String::new(), ..curve }).collect(),
            pins: phase_pins,
            level: Some(-180.0),
            lines: said(&[&of_phase]),
            height: HEIGHTS[1],
            is_joined: false,
        },
    ]
}

/// Returns the marks of crossover and gain margin, and of phase margin.
fn pins(bode: &Bode) -> (Vec<MeasureMark>, Vec<MeasureMark>) {
    let turned = turned(bode);
    let at = bode.at_phase_margin().map(|point| turned(&point));
    let mut gains = Vec::new();
    if bode.margins.crossover > 0.0 {
        let place = (bode.margins.crossover, 0.0);
        gains.push(MeasureMark { from: place, to: place, text: frequency(bode.margins.crossover) });
    }
    gains.extend(bode.at_gain_margin().map(|point| MeasureMark {
        from: (point.frequency, 0.0),
        to: (point.frequency, point.open_gain),
        text: decibel(bode.margins.gain),
    }));
    let phases = at.map(|point| MeasureMark {
        from: (point.frequency, -180.0),
        to: (point.frequency, point.open_phase),
        text: format!("{:.0} deg", bode.margins.phase),
    });
    (gains, phases.into_iter().collect())
}

/// Returns the lowest and highest value of curves, within bounds, with margins; the bounds include 0 dB or -180
/// degrees, which must be visible.
fn extent(curves: &[Curve], (least, most): (f64, f64)) -> (f64, f64) {
    let values = || curves.iter().flat_map(|curve| &curve.points).map(|point| point.1).filter(|y| y.is_finite());
    let low = values().fold(f64::INFINITY, f64::min).clamp(least, most);
    let high = values().fold(f64::NEG_INFINITY, f64::max).clamp(least, most);
    let air = AIR * (high - low).max(1e-9);
    (low - air, high + air)
}

fn step(findings: &Findings, sides: &[Side<'_>]) -> Panel {
    let distance = findings.step.distance();
    let end = sides.iter().filter_map(|side| side.2.step.samples.last()).map(|sample| sample.time).fold(0.0, f64::max);
    let lead = -0.04 * end;
    let (scale, unit) = time_unit(end);
    let mut curves = vec![Curve {
        name: "target".to_owned(),
        look: LineStyle::Demanded,
        points: [(lead, 0.0), (0.0, 0.0), (0.0, distance), (end, distance)].map(|(t, y)| (t * scale, y)).to_vec(),
    }];
    curves.extend(sides.iter().map(|(name, look, answer)| {
        let moved = answer.step.samples.iter().map(|sample| (sample.time * scale, sample.position));
        let points = [(lead * scale, 0.0)].into_iter().chain(moved).collect();
        Curve { name: (*name).to_owned(), look: *look, points }
    }));
    let bounds = (STEP_SHOWN.0 * distance, STEP_SHOWN.1 * distance);
    let (low, high) = extent(&curves, bounds);
    let window = rounded(findings.subject.step_window(&findings.step), 3);
    let lines = sides.iter().flat_map(|(name, _, answer)| {
        let figures = &answer.step.figures;
        let settled = figures.settling.map_or_else(
            || format!("not within {window} inc"),
            |time| format!("within {window} inc after {} ms", rounded(1000.0 * time, 3)),
        );
        [format!("{name}: overshoot {:.0} %", figures.overshoot), format!("{name}: {settled}")]
    });
    Panel {
        across: axis(&format!("time ({unit})"), lead * scale, end * scale, Spacing::Even),
        up: axis("step (inc)", low, high, Spacing::Even),
        lines: lines.collect(),
        curves,
        pins: Vec::new(),
        level: None,
        height: HEIGHTS[2],
        is_joined: false,
    }
}

/// Returns the factor and the name of the unit of time.
fn time_unit(longest: f64) -> (f64, &'static str) {
    if longest < 1.0 { (1000.0, "ms") } else { (1.0, "s") }
}

/// Returns the measured values with the model, and the difference.
fn fit(findings: &Findings, record: &Record) -> Option<[Panel; 2]> {
    let modelled = retrace(&findings.identified.model, record).ok()?;
    let first = record.positions.first().copied()?;
    let measured = || record.positions.iter().map(|position| position.saturating_sub(first) as f64);
    let (end, subject) = (record.positions.len() as f64 * record.cycle, &findings.subject);
    let (scale, unit) = time_unit(end);
    let time = |k: usize| k as f64 * record.cycle * scale;
    // A travel of few increments, and one of an axis without a unit, is shown in increments.
    let farthest = measured().fold(0.0_f64, |most, way| most.max(way.abs()));
    let in_unit = subject.has_unit() && !subject.unit.starts_with(|c: char| c.is_ascii_digit());
    let (per, way_unit) =
        if in_unit && farthest >= 1000.0 { (1.0 / subject.increments, subject.unit.as_str()) } else { (1.0, "inc") };
    let curve = |name: &str, look, points: Vec<(f64, f64)>| Curve { name: name.to_owned(), look, points };
    let over_time = |values: &mut dyn Iterator<Item = f64>| values.enumerate().map(|(k, y)| (time(k), y)).collect();
    let ways = vec![
        curve("measured", LineStyle::New, over_time(&mut measured().map(|way| way * per))),
        curve("modelled", LineStyle::Other, over_time(&mut modelled.iter().map(|way| way * per))),
    ];
    let left = over_time(&mut measured().zip(&modelled).map(|(way, model)| way - model));
    let left = vec![curve("measured - modelled", LineStyle::Other, left)];
    let mean = left.iter().flat_map(|curve| &curve.points).map(|point| point.1 * point.1).sum::<f64>();
    let mean = (mean / record.positions.len() as f64).sqrt();
    let panel = |label: String, curves: Vec<Curve>, lines, height, is_joined| {
        let (low, high) = extent(&curves, (f64::MIN, f64::MAX));
        Panel {
            across: axis(&format!("time ({unit})"), 0.0, end * scale, Spacing::Even),
            up: axis(&label, low.min(high - 1e-6), high, Spacing::Even),
            curves,
            pins: Vec::new(),
            level: Some(0.0),
            lines,
            height,
            is_joined,
        }
    };
    let explained = format!("explained: {} %", share(findings.identified.explained));
    Some([
        panel(format!("record ({way_unit})"), ways, vec![explained], HEIGHTS[3], true),
        panel("residual (inc)".to_owned(), left, vec![format!("RMS: {} inc", rounded(mean, 2))], HEIGHTS[4], false),
    ])
}

#[cfg(test)]
mod six;
#[cfg(test)]
mod tests;

//! Draws position, velocity, acceleration and jerk over the master position, one panel each.

use super::description::Description;
use super::motion::{Motion, Points};
use crate::recording::plot::{Across, Chosen, Figure, Problem, write};
use crate::recording::series::{Kind, Series};
use lineshaft_core::law::Derivatives;
use std::path::Path;

/// Number of points of a curve within a segment.
const PARTS: u32 = 500;
/// Approximate number of points of a curve along a spline.
const MOST: usize = 20_000;
const PANELS: [(&str, &str); 4] =
    [("position", "inc"), ("velocity", "inc/inc"), ("acceleration", "inc/inc^2"), ("jerk", "inc/inc^3")];

type Curve = Vec<(f64, f64)>;

/// Size of a figure, in px, and its title.
#[derive(Clone, Debug)]
pub(crate) struct Sheet {
    pub(crate) title: String,
    pub(crate) width: u32,
    pub(crate) height: Option<u32>,
}

/// Draws a motion.
pub(crate) fn draw(motion: &Motion, sheet: Sheet, output: &Path) -> Result<(), Problem> {
    let curves = match motion {
        Motion::Planned(description) => planned(description),
        Motion::Points(points) => between(points),
    };
    let series: Vec<Series> =
        PANELS.iter().zip(curves).map(|((name, unit), points)| series(name, unit, points)).collect();
    let figure = Figure {
        title: sheet.title,
        signals: series.iter().map(|series| Chosen { series, by_name: true }).collect(),
        marks: &[],
        from: None,
        to: None,
        across: Across::Master,
        width: sheet.width,
        height: sheet.height,
        split: false,
    };
    write(&figure, output)
}

fn series(name: &str, unit: &str, points: Curve) -> Series {
    let (name, unit) = (name.to_owned(), unit.to_owned());
    Series { name, unit, kind: Kind::Real, topic: String::new(), points, gaps: Vec::new() }
}

/// Returns the curves of a plan, segment by segment: at a jump, a curve has two values at one position.
fn planned(description: &Description) -> [Curve; 4] {
    let mut curves: [Curve; 4] = Default::default();
    for (from, to) in description.spans() {
        for part in 0..=PARTS {
            let x = from + (to - from) * f64::from(part) / f64::from(PARTS);
            // The end of a segment is evaluated within the segment.
            let seen = if part == PARTS { to.next_down() } else { x };
            let Derivatives { s, v, a, j } = description.plan.at(seen);
            curves.iter_mut().zip([s, v, a, j]).for_each(|(curve, value)| curve.push((x, value)));
        }
    }
    curves
}

/// Returns the curves of points: a spline, or straight lines, a constant velocity along each, and divided differences.
fn between(points: &Points) -> [Curve; 4] {
    if let Some(spline) = points.table.spline() {
        let parts = (MOST / points.table.len().max(1)).clamp(1, PARTS as usize) as u32;
        let mut curves: [Curve; 4] = Default::default();
        for (x, Derivatives { s, v, a, j }) in points.along(spline, parts) {
            curves.iter_mut().zip([s, v, a, j]).for_each(|(curve, value)| curve.push((x, value)));
        }
        return curves;
    }
    let position = points.x.iter().copied().zip(points.table.y().iter().map(|y| *y as f64)).collect();
    let [slopes, acceleration, jerk] = points.derivatives();
    let ends = points.x.iter().skip(1);
    let velocity = slopes.into_iter().zip(ends).flat_map(|((from, slope), to)| [(from, slope), (*to, slope)]).collect();
    [position, velocity, acceleration, jerk]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Document;
    use lineshaft_core::table::{Form, Interpolation, Table};

    #[test]
    fn a_jump_has_two_values_at_one_place() {
        let text = "points: 5\nmaster: 1000\nsegments:\n  - {to: 500, travel: 100, law: simple_sine}\n  - {to: 1000, travel: 0, law: dwell}\n";
        let description = Description::read(&Document::parse("t", text)).expect("good");
        let [position, _, acceleration, _] = planned(&description);
        let at = |curve: &Curve, place: f64| -> Vec<f64> {
            curve.iter().filter(|(x, _)| *x == place).map(|(_, value)| *value).collect()
        };
        assert_eq!(at(&position, 500.0), [100.0, 100.0]);
        let peak = std::f64::consts::PI.powi(2) / 2.0 * 100.0 / 250_000.0;
        let [before, after] = at(&acceleration, 500.0)[..] else { panic!("two values") };
        assert!((before + peak).abs() < 1e-9 && after == 0.0, "{before} {after}");
    }

    #[test]
    fn points_have_four_panels_over_the_master() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("t.svg");
        let table = Table::new(Form::Xy, &[0, 10, 20, 40], &[0, 5, 30, 0]).expect("points");
        let motion = Motion::Points(Points::new(table, None, true, Interpolation::Linear).expect("a curve"));
        let sheet = Sheet { title: "t.csv".to_owned(), width: 900, height: None };
        draw(&motion, sheet, &path).expect("drawn");
        let svg = std::fs::read_to_string(&path).expect("a figure");
        assert!(!svg.contains("\nposition\n"), "the label of a panel is not repeated");
        for text in
            ["t.csv", "master (inc)", "position (inc)", "velocity (inc/inc)", "acceleration (inc/inc\u{b2})", "jerk ("]
        {
            assert!(svg.contains(text), "`{text}` is not in {svg}");
        }
    }
}

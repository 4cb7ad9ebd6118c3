//! Motion of a slave along a table: its position and three derivatives over the master position.
//!
//! Law      a plan, and the spline through points: their own derivatives. Points: the slopes of the straight lines
//!          between them; `a[i] = 2 y[x i-1, x i, x i+1], j[i] = 6 y[x i-1 .. x i+2]`, divided differences; in a cyclic
//!          table the end is adjacent to the start
//! Reads    a description, or points
//! Refuses  points that are no valid curve of a cam

use super::description::Description;
use lineshaft_core::law::{Derivatives, Jump, Peak, Plan, Spline};
use lineshaft_core::table::{CamSetting, CurveError, Form, Interpolation, Table};

/// Number of parts of a segment that are searched, each for its own maximum.
const PARTS: u32 = 256;
/// Number of parts of an interval of a spline, of which there may be a million.
const PARTS_OF_SPLINE: u32 = 16;

/// Replaces a maximum by a larger absolute value.
fn raise_to(peak: &mut Peak, value: f64, at: f64) {
    if value.abs() > peak.value {
        *peak = Peak { value: value.abs(), at };
    }
}

/// Demands of a table on its slave, per increment of the master.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Extremes {
    pub(crate) velocity: Peak,
    /// Maximum acceleration that makes the slave faster.
    pub(crate) acceleration: Peak,
    /// Maximum acceleration that makes the slave slower.
    pub(crate) deceleration: Peak,
    pub(crate) jerk: Peak,
    /// Jumps of derivatives, in addition to the maxima.
    pub(crate) jumps: Vec<Jump>,
}

/// A table as a motion.
#[derive(Clone, Debug)]
pub(crate) enum Motion {
    Planned(Description),
    Points(Points),
}

/// Points, and the curve between them.
#[derive(Clone, Debug)]
pub(crate) struct Points {
    pub(crate) table: Table,
    /// Positions of all points.
    pub(crate) x: Vec<f64>,
    pub(crate) is_cyclic: bool,
}

/// A derivative of points: position and value.
type Derivative = Vec<(f64, f64)>;

impl Points {
    /// Creates a motion from a table with positions, or over a period of its master.
    pub(crate) fn new(
        table: Table,
        master: Option<i64>,
        is_cyclic: bool,
        interpolation: Interpolation,
    ) -> Result<Self, String> {
        if let Some(sentence) = table.shape().err().filter(|error| !is_cam(&table, error)).map(why) {
            return Err(sentence);
        }
        let x = match (table.form(), master) {
            (Form::Xy, Some(_)) => {
                return Err("--master is for form y; a table of form xy has places of its own".to_owned());
            }
            (Form::Xy, None) => table.x().iter().map(|x| *x as f64).collect(),
            (_, None) => {
                return Err("a table of form y has no places; --master with its period (inc) is needed".to_owned());
            }
            (_, Some(master)) => {
                let spans = table.len() as f64 - 1.0;
                (0..table.len()).map(|i| i as f64 * master as f64 / spans).collect()
            }
        };
        let table = if interpolation == Interpolation::Linear {
            table
        } else {
            let table = table.with_cam(CamSetting { length: master, is_cyclic, interpolation });
            table.cam().map_err(|error| error.to_string())?;
            table
        };
        Ok(Self { table, x, is_cyclic })
    }

    /// Returns the reason why a function interpolator refuses the table, if it does.
    pub(crate) fn refused_by_functions(&self) -> Option<String> {
        self.table.shape().err().map(why)
    }

    fn length(&self) -> f64 {
        self.x.last().copied().unwrap_or(0.0)
    }

    /// Returns the lengths of the straight lines, and their slopes.
    fn lines(&self) -> (Vec<f64>, Vec<f64>) {
        let spans: Vec<f64> = self.x.windows(2).map(|pair| if let [a, b] = *pair { b - a } else { 1.0 }).collect();
        let rises = self.table.y().windows(2).map(|pair| if let [a, b] = *pair { (b - a) as f64 } else { 0.0 });
        let slopes = rises.zip(&spans).map(|(rise, span)| rise / span).collect();
        (spans, slopes)
    }

    /// Returns the velocity from the start of each line, the acceleration at points, and the jerk at the middle of
    /// lines.
    pub(crate) fn derivatives(&self) -> [Derivative; 3] {
        let (spans, slopes) = self.lines();
        let last = |list: &[f64]| list.last().copied().filter(|_| self.is_cyclic);
        let around = |list: &[f64]| list.first().copied().filter(|_| self.is_cyclic);
        let velocity: Derivative = self.x.iter().copied().zip(slopes.iter().copied()).collect();
        // With the spans before and after each point.
        let mut bends: Vec<(f64, f64, f64)> = Vec::with_capacity(slopes.len() + 1);
        let mut before = last(&spans).zip(last(&slopes));
        for ((x, span), slope) in self.x.iter().zip(&spans).zip(&slopes) {
            if let Some((width, rate)) = before {
                bends.push((*x, (slope - rate) / ((width + span) / 2.0), width));
            }
            before = Some((*span, *slope));
        }
        if let Some((first, span)) = bends.first().copied().zip(last(&spans)).filter(|_| self.is_cyclic) {
            bends.push((self.length(), first.1, span));
        }
        let mut jerk = Vec::with_capacity(bends.len());
        for (nth, pair) in bends.windows(2).enumerate() {
            if let [(x, a, wide), (to, b, span)] = *pair {
                let first = if self.is_cyclic { nth } else { nth + 1 };
                let behind = spans.get(first + 1).copied().or_else(|| around(&spans)).unwrap_or(span);
                jerk.push(((x + to) / 2.0, (b - a) / ((wide + span + behind) / 3.0)));
            }
        }
        [velocity, bends.into_iter().map(|(x, a, _)| (x, a)).collect(), jerk]
    }

    /// Returns the part of acceleration and jerk that may be due to rounding of the values to integer increments.
    pub(crate) fn rounding(&self) -> (f64, f64) {
        let (spans, _) = self.lines();
        let least = spans.iter().copied().fold(f64::INFINITY, f64::min);
        (2.0 / least / least, 4.0 / least / least / least)
    }

    fn extremes(&self) -> Extremes {
        self.table.spline().map_or_else(|| self.extremes_of_lines(), |spline| self.extremes_of(spline))
    }

    /// Returns positions in all intervals of a spline, with the derivatives there; each interval has this number of
    /// parts.
    pub(crate) fn along<'a>(&'a self, spline: &'a Spline, parts: u32) -> impl Iterator<Item = (f64, Derivatives)> + 'a {
        self.x
            .windows(2)
            .enumerate()
            .filter_map(|(i, pair)| if let [a, b] = *pair { Some((i, a, b - a)) } else { None })
            .flat_map(move |(i, from, span)| {
                (0..=parts).map(move |part| {
                    let u = f64::from(part) / f64::from(parts);
                    let y = self.table.y().get(i).map_or(0.0, |y| *y as f64);
                    let at = spline.at(i, u, span);
                    (from + u * span, Derivatives { s: y + at.s, ..at })
                })
            })
    }

    fn extremes_of(&self, spline: &Spline) -> Extremes {
        let peaks = spline.peaks(&self.x);
        let mut sides = [Peak::default(); 2];
        for (x, at) in self.along(spline, PARTS_OF_SPLINE) {
            let [faster, slower] = &mut sides;
            raise_to(if at.a * at.v >= 0.0 { faster } else { slower }, at.a, x);
        }
        let [acceleration, deceleration] = with_largest(sides, peaks.a);
        Extremes { velocity: peaks.v, acceleration, deceleration, jerk: peaks.j, jumps: Vec::new() }
    }

    fn extremes_of_lines(&self) -> Extremes {
        let [velocity, acceleration, jerk] = self.derivatives();
        let mut found = Extremes::default();
        let slopes: Vec<f64> = velocity.iter().map(|(_, slope)| *slope).collect();
        velocity.iter().for_each(|(x, v)| raise_to(&mut found.velocity, *v, *x));
        // In a cyclic table the first bend is before the first line, otherwise after it.
        let offset = usize::from(!self.is_cyclic);
        for (nth, (x, a)) in acceleration.iter().enumerate() {
            let line = |place: usize| slopes.get(place).or(slopes.first()).copied().unwrap_or(0.0);
            let behind = line(nth + offset);
            let before = (nth + offset).checked_sub(1).map_or_else(|| slopes.last().copied().unwrap_or(0.0), line);
            let side = if a * (before + behind) < 0.0 { &mut found.deceleration } else { &mut found.acceleration };
            raise_to(side, *a, *x);
        }
        jerk.iter().for_each(|(x, j)| raise_to(&mut found.jerk, *j, *x));
        found
    }
}

/// Whether an axis accepts as a cam a table that functions refuse: its steps may be longer, and its values may begin
/// anywhere.
fn is_cam(table: &Table, error: &CurveError) -> bool {
    matches!(error, CurveError::Step(_) | CurveError::First(_)) && table.x().first().is_none_or(|first| *first == 0)
}

/// Returns the reason why a table is no valid curve.
fn why(error: CurveError) -> String {
    match error {
        CurveError::Words => "words of a data block are no curve; form y or xy is needed".to_owned(),
        CurveError::Few(count) => format!("a curve of {count} points goes nowhere; 2 at least are needed"),
        CurveError::First(first) => format!("the curve begins at {first}; 0 is needed"),
        CurveError::Order(point) => format!("point {} is not after the one before it; places rise", point + 1),
        CurveError::Step(point) => {
            format!("point {} is 32768 inc or more from the one before it; less is needed, by more points", point + 1)
        }
    }
}

impl Motion {
    /// Returns the period of the master, in inc.
    pub(crate) fn length(&self) -> f64 {
        match self {
            Self::Planned(description) => description.plan.length(),
            Self::Points(points) => points.length(),
        }
    }

    /// Returns the travel within a period, in inc.
    pub(crate) fn end(&self) -> f64 {
        match self {
            Self::Planned(description) => description.plan.end(),
            Self::Points(points) => {
                let y = points.table.y();
                y.last().zip(y.first()).map_or(0.0, |(last, first)| (last - first) as f64)
            }
        }
    }

    pub(crate) fn is_cyclic(&self) -> bool {
        match self {
            Self::Planned(description) => description.plan.is_cyclic(),
            Self::Points(points) => points.is_cyclic,
        }
    }

    /// Returns the demands on the slave.
    pub(crate) fn extremes(&self) -> Extremes {
        match self {
            Self::Planned(description) => planned(description),
            Self::Points(points) => points.extremes(),
        }
    }
}

fn planned(description: &Description) -> Extremes {
    let plan = &description.plan;
    let peaks = plan.peaks();
    let (velocity, largest, jerk) = (peaks.v, peaks.a, peaks.j);
    let sides = [true, false].map(|is_faster| {
        let mut found = Peak::default();
        for span in description.spans() {
            let (value, at) = peak_within(span, |x| amount(plan, x, is_faster));
            raise_to(&mut found, value, at);
        }
        found
    });
    let [acceleration, deceleration] = with_largest(sides, largest);
    Extremes { velocity, acceleration, deceleration, jerk, jumps: plan.jumps() }
}

/// Replaces the larger one of acceleration and deceleration, which were found by search, by its value in closed form.
fn with_largest(mut sides: [Peak; 2], largest: Peak) -> [Peak; 2] {
    let [acceleration, deceleration] = &mut sides;
    let larger = if acceleration.value >= deceleration.value { acceleration } else { deceleration };
    if largest.value > larger.value * (1.0 - 1e-9) {
        larger.value = largest.value;
    }
    sides
}

/// Returns the absolute acceleration where it makes the slave faster, or slower; otherwise 0.
fn amount(plan: &Plan, x: f64, is_faster: bool) -> f64 {
    let at = plan.at(x);
    if (at.a * at.v >= 0.0) == is_faster { at.a.abs() } else { 0.0 }
}

/// Returns the largest value within a segment, with its ends evaluated from within.
fn peak_within((from, to): (f64, f64), value: impl Fn(f64) -> f64) -> (f64, f64) {
    let (low, high) = (from.next_up(), to.next_down());
    let place = |part: u32| low + (high - low) * f64::from(part) / f64::from(PARTS);
    let best = (0..=PARTS).max_by(|a, b| value(place(*a)).total_cmp(&value(place(*b)))).unwrap_or(0);
    let (mut left, mut right) = (place(best.saturating_sub(1)), place((best + 1).min(PARTS)));
    // Each step of the golden section search reduces the interval to about 2/3.
    const GOLDEN: f64 = 0.618_033_988_749_895;
    for _ in 0..80 {
        let (a, b) = (right - GOLDEN * (right - left), left + GOLDEN * (right - left));
        if value(a) < value(b) { left = a } else { right = b }
    }
    let inner = (value((left + right) / 2.0), (left + right) / 2.0);
    let edge = (value(place(best)), place(best));
    if inner.0 > edge.0 { inner } else { edge }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Document;

    fn points(x: &[i64], y: &[i64], is_cyclic: bool) -> Points {
        Points::new(Table::new(Form::Xy, x, y).expect("points"), None, is_cyclic, Interpolation::Linear)
            .expect("a curve")
    }

    fn near(found: f64, wanted: f64) -> bool {
        (found - wanted).abs() <= 1e-9 * wanted.abs().max(1e-12)
    }

    /// y = x^3 at unequal positions: second and third divided differences of a cubic are 6 times the mean of three
    /// positions, and 6.
    #[test]
    fn differences_of_a_cubic_are_its_derivatives() {
        let x = [0, 2, 3, 7, 8, 12];
        let y = x.map(|x| x * x * x);
        let [velocity, acceleration, jerk] = points(&x, &y, false).derivatives();
        assert_eq!(velocity.len(), 5);
        assert_eq!(velocity[1], (2.0, 19.0));
        let wanted: Vec<f64> = x.windows(3).map(|w| 2.0 * w.iter().sum::<i64>() as f64).collect();
        assert_eq!(acceleration.len(), wanted.len());
        for ((at, found), (place, wanted)) in acceleration.iter().zip(x[1..].iter().zip(wanted)) {
            assert!(*at == *place as f64 && near(*found, wanted), "{at}: {found} {wanted}");
        }
        assert_eq!(jerk.len(), 3);
        assert!(jerk.iter().all(|(_, found)| near(*found, 6.0)), "{jerk:?}");
        assert_eq!(jerk[0].0, 2.5);
    }

    #[test]
    fn a_table_that_goes_round_bends_at_its_ends_too() {
        // Up and down in four lines of 10: slopes 1, 3, -1, -3.
        let (x, y) = ([0, 10, 20, 30, 40], [0, 10, 40, 30, 0]);
        let [_, acceleration, jerk] = points(&x, &y, true).derivatives();
        let wanted = [(0.0, 0.4), (10.0, 0.2), (20.0, -0.4), (30.0, -0.2), (40.0, 0.4)];
        assert_eq!(acceleration, wanted);
        let wanted = [(5.0, -0.02), (15.0, -0.06), (25.0, 0.02), (35.0, 0.06)];
        assert!(
            jerk.iter().zip(wanted).all(|(found, wanted)| found.0 == wanted.0 && near(found.1, wanted.1)),
            "{jerk:?}"
        );
        assert_eq!(jerk.len(), 4);
        let once = points(&x, &y, false);
        let [_, acceleration, jerk] = once.derivatives();
        assert_eq!((acceleration.len(), jerk.len()), (3, 2));
        let found = Motion::Points(once).extremes();
        assert_eq!(found.velocity, Peak { value: 3.0, at: 10.0 });
        // At 10 it accelerates forward, at 20 the slope changes from 3 to -1: slower; at 30 it accelerates backward.
        assert_eq!(found.acceleration, Peak { value: 0.2, at: 10.0 });
        assert_eq!(found.deceleration, Peak { value: 0.4, at: 20.0 });
        // Cyclic: at 0 the slope changes from -3 to 1, slower.
        let round = Motion::Points(points(&x, &y, true)).extremes();
        assert_eq!((round.acceleration.value, round.deceleration), (0.2, Peak { value: 0.4, at: 0.0 }));
        assert!(near(round.jerk.value, 0.06) && round.jerk.at == 15.0);
    }

    /// A periodic spline through a sine has the derivatives of the sine.
    #[test]
    fn a_spline_has_its_own_derivatives() {
        let count = 100_i64;
        let x: Vec<i64> = (0..=count).map(|i| i * 100).collect();
        let turn = std::f64::consts::TAU / 10_000.0;
        let y: Vec<i64> = x.iter().map(|x| (1e7 * libm::sin(turn * *x as f64)).round() as i64).collect();
        let table = Table::new(Form::Xy, &x, &y).expect("points");
        let points = Points::new(table, None, true, Interpolation::Quintic).expect("a cam");
        let found = Motion::Points(points).extremes();
        let wanted = [1e7 * turn, 1e7 * turn.powi(2), 1e7 * turn.powi(2), 1e7 * turn.powi(3)];
        let peaks = [found.velocity, found.acceleration, found.deceleration, found.jerk].map(|peak| peak.value);
        for (found, wanted) in peaks.into_iter().zip(wanted) {
            assert!((found / wanted - 1.0).abs() < 1e-4, "{found} {wanted}");
        }
        // It is fastest at 0 and half-way, and reverses a quarter of the period after each.
        assert!((found.deceleration.at % 5_000.0 - 2_500.0).abs() < 100.0, "{found:?}");
        assert!(found.jumps.is_empty());
    }

    #[test]
    fn what_is_no_spline_is_told() {
        let table = || Table::new(Form::Y, &[], &[0, 5]).expect("numbers");
        let said = Points::new(table(), Some(100), true, Interpolation::Cubic).expect_err("refused");
        assert_eq!(said, "a cam has 2 points; 3 or more are needed");
        assert!(Points::new(table(), Some(100), true, Interpolation::Linear).is_ok());
    }

    #[test]
    fn rounding_is_bounded_by_the_shortest_line() {
        assert_eq!(points(&[0, 10, 15], &[0, 1, 2], true).rounding(), (2.0 / 25.0, 4.0 / 125.0));
    }

    #[test]
    fn what_is_no_curve_of_a_cam_is_told() {
        let said = |form, x: &[i64], y: &[i64], master| {
            Points::new(Table::new(form, x, y).expect("numbers"), master, true, Interpolation::Linear)
                .expect_err("refused")
        };
        assert_eq!(
            said(Form::Y, &[], &[0, 1], None),
            "a table of form y has no places; --master with its period (inc) is needed"
        );
        assert!(said(Form::Xy, &[0, 1], &[0, 1], Some(5)).starts_with("--master is for form y"));
        assert!(said(Form::Words, &[], &[0, 1], Some(5)).starts_with("words of a data block"));
        assert_eq!(said(Form::Y, &[], &[0], Some(5)), "a curve of 1 points goes nowhere; 2 at least are needed");
        assert_eq!(said(Form::Xy, &[3, 5], &[0, 1], None), "the curve begins at 3; 0 is needed");
        assert_eq!(said(Form::Xy, &[0, 5, 5], &[0, 1, 2], None), "point 3 is not after the one before it; places rise");
        // An axis accepts these as a cam.
        for (y, sentence) in [
            ([3, 1], "the curve begins at 3; 0 is needed"),
            ([0, 32_768], "point 2 is 32768 inc or more from the one before it;"),
        ] {
            let points =
                Points::new(Table::new(Form::Y, &[], &y).expect("numbers"), Some(5), true, Interpolation::Linear)
                    .expect("a cam");
            assert!(points.refused_by_functions().is_some_and(|said| said.starts_with(sentence)));
            assert_eq!(Motion::Points(points).end(), (y[1] - y[0]) as f64);
        }
        assert_eq!(points(&[0, 5], &[0, 1], true).refused_by_functions(), None);
    }

    /// A rise to the speed of a straight line and a shorter distance back to standstill: the deceleration is larger
    /// than the acceleration.
    #[test]
    fn getting_slower_is_told_from_getting_faster() {
        let text = "points: 5\nmaster: 6000\ncyclic: false\nsegments:\n  - {to: 2000, travel: 1000, law: polynomial_5}\n  \
                    - {to: 5000, travel: 3000, law: straight}\n  - {to: 6000, travel: 500, law: polynomial_5}\n";
        let description = Description::read(&Document::parse("t", text)).expect("good");
        let found = Motion::Planned(description).extremes();
        // From standstill to v = 1 over h with travel h / 2 and no acceleration at the ends, the acceleration is 6 z (1
        // - z) v / h: at most 1.5 v / h.
        assert!(
            near(found.acceleration.value, 1.5 / 2000.0) && (found.acceleration.at - 1000.0).abs() < 1e-3,
            "{found:?}"
        );
        assert!(
            near(found.deceleration.value, 1.5 / 1000.0) && (found.deceleration.at - 5500.0).abs() < 1e-3,
            "{found:?}"
        );
        assert_eq!(found.jumps, []);
    }

    #[test]
    fn the_end_of_a_sine_brakes_as_hard_as_its_start_speeds_up() {
        let text = "points: 5\nmaster: 1000\nsegments:\n  - {to: 500, travel: 100, law: simple_sine}\n  - {to: 1000, travel: 0, law: dwell}\n";
        let description = Description::read(&Document::parse("t", text)).expect("good");
        let found = Motion::Planned(description).extremes();
        let peak = std::f64::consts::PI.powi(2) / 2.0 * 100.0 / 250_000.0;
        assert!(near(found.acceleration.value, peak) && near(found.deceleration.value, peak), "{found:?}");
        assert!(found.acceleration.at < 1e-6 && (found.deceleration.at - 500.0).abs() < 1e-6, "{found:?}");
        assert_eq!(
            found.jumps.iter().map(|jump| (jump.at, jump.derivative)).collect::<Vec<_>>(),
            [(0.0, 2), (500.0, 2)]
        );
    }
}

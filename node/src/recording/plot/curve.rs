//! Reduces curves to the points that are visible in a picture.
//!
//! Law      of the points in a column of one pixel, the first, the lowest, the highest and the last are kept, in their
//!          order. The picture is the same as with all points, and its size depends only on its width.

use crate::recording::series::Series;

/// Largest value that is drawn. Larger ones are gaps like NaN, because their differences would overflow.
pub(super) const LARGEST: f64 = 1e150;

pub(super) fn is_drawable(value: f64) -> bool {
    value.abs() <= LARGEST
}

/// The points of a series within the time shown, and their neighbours.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window<'a> {
    points: &'a [(f64, f64)],
    /// Start and end of each gap, in s.
    gaps: &'a [(f64, f64)],
    first: usize,
    end: usize,
    /// Start, in s.
    pub(super) from: f64,
    /// End, in s.
    pub(super) to: f64,
}

impl<'a> Window<'a> {
    pub(super) fn new(series: &'a Series, from: f64, to: f64) -> Self {
        let points = &series.points[..];
        let first = points.partition_point(|point| point.0 < from);
        let end = points.partition_point(|point| point.0 <= to).max(first);
        Self { points, gaps: &series.gaps, first, end, from, to }
    }

    /// Returns the points within the window.
    pub(super) fn inside(&self) -> &'a [(f64, f64)] {
        &self.points[self.first..self.end]
    }

    fn before(&self) -> Option<(f64, f64)> {
        self.first.checked_sub(1).map(|place| self.points[place])
    }

    /// Returns the gaps within the window.
    pub(super) fn gaps(&self) -> impl Iterator<Item = (f64, f64)> + use<'a> {
        let (from, to) = (self.from, self.to);
        self.gaps.iter().copied().filter(move |gap| gap.1 > from && gap.0 < to)
    }

    fn is_known(&self, time: f64) -> bool {
        !self.gaps.iter().any(|gap| gap.0 <= time && time < gap.1)
    }

    /// Returns the value that holds at the start, unless a point replaces it there.
    fn held(&self) -> impl Iterator<Item = (f64, f64)> + use<> {
        let from = self.from;
        let is_replaced = self.inside().first().is_some_and(|point| point.0 == from);
        let before = self.before().filter(|_| !is_replaced && self.is_known(from));
        before.map(|(_, value)| (from, value)).into_iter()
    }

    /// Returns the points within, each valid until the next one; the last point before the window is valid from the
    /// start.
    pub(super) fn steps(&self) -> impl Iterator<Item = (f64, f64)> + use<'a> {
        self.held().chain(self.inside().iter().copied())
    }

    /// Returns the value at an edge, interpolated between its two neighbours.
    fn crossing(&self, at: f64, right: usize) -> Option<(f64, f64)> {
        let (from, to) = (self.points.get(right.checked_sub(1)?)?, self.points.get(right)?);
        let part = (at - from.0) / (to.0 - from.0);
        (part > 0.0 && part < 1.0 && self.is_known(at)).then_some((at, from.1 + part * (to.1 - from.1)))
    }

    /// Returns the points within, and those where straight lines between points cross the edges.
    pub(super) fn lines(&self) -> impl Iterator<Item = (f64, f64)> + use<'a> {
        let (left, right) = (self.crossing(self.from, self.first), self.crossing(self.to, self.end));
        left.into_iter().chain(self.inside().iter().copied()).chain(right)
    }

    /// Returns `points`, with NaN where a gap begins.
    pub(super) fn broken(&self, points: impl Iterator<Item = (f64, f64)>) -> impl Iterator<Item = (f64, f64)> {
        let (mut points, mut gaps) = (points.peekable(), self.gaps().peekable());
        std::iter::from_fn(move || {
            // A gap begins at a point, which is kept before it.
            let is_due = |gap: &(f64, f64)| points.peek().is_none_or(|point| point.0 > gap.0);
            match gaps.next_if(is_due) {
                Some(gap) => Some((gap.0, f64::NAN)),
                None => points.next(),
            }
        })
    }

    /// Returns the number of changes of the value, counted up to `most`.
    pub(super) fn changes(&self, most: usize) -> usize {
        let mut before: Option<f64> = None;
        let is_same = |a: f64, b: f64| a == b || (a.is_nan() && b.is_nan());
        let differs = |(_, value): &(f64, f64)| before.replace(*value).is_some_and(|before| !is_same(before, *value));
        self.steps().filter(differs).take(most).count()
    }

    /// Returns how often the value becomes NaN or infinite, and how often too large to draw.
    pub(super) fn undrawn(&self) -> (usize, usize) {
        let count = |is_odd: fn(f64) -> bool| {
            let mut before = false;
            self.steps().filter(|&(_, value)| !std::mem::replace(&mut before, is_odd(value)) && before).count()
        };
        (count(|value| !value.is_finite()), count(|value| value.is_finite() && !is_drawable(value)))
    }

    /// Returns the lowest and the highest value, if there is any.
    pub(super) fn extent(&self) -> Option<(f64, f64)> {
        let values = self.steps().chain(self.lines()).map(|(_, value)| value).filter(|&value| is_drawable(value));
        values.fold(None, |extent: Option<(f64, f64)>, value| {
            Some(extent.map_or((value, value), |(low, high)| (low.min(value), high.max(value))))
        })
    }
}

/// Points (time or frequency, value) of a curve; NaN is a gap.
pub(super) type Points = Vec<(f64, f64)>;

/// Returns the curve of a signal for a plot with this number of pixel columns.
pub(super) fn curve(window: &Window<'_>, is_stepped: bool, columns: f64) -> Points {
    let clamped = |time: f64| time.clamp(window.from, window.to);
    let column = |time: f64| (time - window.from) / (window.to - window.from) * columns;
    let mut reducer = Reducer::default();
    let mut push = |time: f64, value: f64| reducer.push(column(time), (clamped(time), value));
    if is_stepped {
        let mut last = f64::NAN;
        for (time, value) in window.broken(window.steps()) {
            if is_drawable(last) {
                push(time, last);
            }
            push(time, value);
            last = value;
        }
        if is_drawable(last) {
            push(window.to, last);
        }
    } else {
        window.broken(window.lines()).for_each(|(time, value)| push(time, value));
    }
    reducer.finish()
}

/// Returns a curve without the points that are invisible in its pixel columns; `column` maps x to a column.
pub(super) fn reduced(points: &[(f64, f64)], column: impl Fn(f64) -> f64) -> Points {
    let mut reducer = Reducer::default();
    points.iter().for_each(|&point| reducer.push(column(point.0), point));
    reducer.finish()
}

/// A point with its index.
type Numbered = (usize, (f64, f64));

/// The points of one pixel column.
#[derive(Clone, Copy, Debug)]
struct Column {
    index: i64,
    first: Numbered,
    low: Numbered,
    high: Numbered,
    last: Numbered,
}

#[derive(Debug, Default)]
struct Reducer {
    done: Points,
    column: Option<Column>,
    count: usize,
}

impl Reducer {
    fn push(&mut self, column: f64, point: (f64, f64)) {
        if !is_drawable(point.1) {
            self.flush();
            if self.done.last().is_some_and(|last| last.1.is_finite()) {
                self.done.push((point.0, f64::NAN));
            }
            return;
        }
        self.count += 1;
        let (index, point) = (column.floor() as i64, (self.count, point));
        match &mut self.column {
            Some(column) if column.index == index => {
                column.last = point;
                if point.1.1 < column.low.1.1 {
                    column.low = point;
                }
                if point.1.1 > column.high.1.1 {
                    column.high = point;
                }
            }
            _ => {
                self.flush();
                self.column = Some(Column { index, first: point, low: point, high: point, last: point });
            }
        }
    }

    fn flush(&mut self) {
        if let Some(column) = self.column.take() {
            let mut kept = [column.first, column.low, column.high, column.last];
            kept.sort_by_key(|point| point.0);
            let mut before = 0;
            for (number, point) in kept {
                if number != before {
                    self.done.push(point);
                }
                before = number;
            }
        }
    }

    fn finish(mut self) -> Points {
        self.flush();
        self.done
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::series::Kind;
    use proptest::prelude::*;

    fn series(points: &[(f64, f64)], gaps: &[(f64, f64)]) -> Series {
        let (name, unit, topic) = (String::new(), String::new(), String::new());
        Series { name, unit, kind: Kind::Real, topic, points: points.to_vec(), gaps: gaps.to_vec() }
    }

    /// Returns the parts of the curve between gaps.
    fn parts(window: &Window<'_>, is_stepped: bool, columns: f64) -> Vec<Points> {
        let curve = curve(window, is_stepped, columns);
        let parts = curve.split(|point| point.1.is_nan()).map(<[(f64, f64)]>::to_vec);
        parts.filter(|part| !part.is_empty()).collect()
    }

    fn of(points: &[(f64, f64)], from: f64, to: f64, is_stepped: bool, columns: f64) -> Vec<Points> {
        parts(&Window::new(&series(points, &[]), from, to), is_stepped, columns)
    }

    #[test]
    fn a_peak_of_one_point_in_a_million_is_kept() {
        let mut points: Vec<(f64, f64)> = (0..1_000_000).map(|n| (f64::from(n) / 1e3, 0.0)).collect();
        points[123_456].1 = 7.0;
        points[654_321].1 = -3.0;
        let lines = of(&points, 0.0, 999.999, false, 500.0);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].len() <= 2004);
        let peak = lines[0].iter().find(|(_, value)| *value == 7.0).unwrap();
        assert!((peak.0 - 123.456).abs() < 1e-9);
        assert!(lines[0].iter().any(|(_, value)| *value == -3.0));
    }

    #[test]
    fn not_a_number_breaks_the_line() {
        let points = [(0.0, 1.0), (1.0, 2.0), (2.0, f64::NAN), (3.0, 4.0), (4.0, f64::INFINITY), (5.0, 6.0)];
        let of = |is_stepped| of(&points, 0.0, 5.0, is_stepped, 5.0);
        assert_eq!(of(false), [vec![(0.0, 1.0), (1.0, 2.0)], vec![(3.0, 4.0)], vec![(5.0, 6.0)]]);
        assert_eq!(of(true)[1], [(3.0, 4.0), (4.0, 4.0)]);
    }

    #[test]
    fn lines_are_cut_at_the_edges_of_the_time_shown() {
        let points = [(0.0, 0.0), (10.0, 100.0)];
        assert_eq!(of(&points, 2.0, 4.0, false, 20.0), [vec![(2.0, 20.0), (4.0, 40.0)]]);
    }

    #[test]
    fn steps_hold_from_before_the_start_to_the_end() {
        let points = [(0.0, 5.0), (3.0, 7.0)];
        let expected = vec![(2.0, 5.0), (3.0, 5.0), (3.0, 7.0), (4.0, 7.0)];
        assert_eq!(of(&points, 2.0, 4.0, true, 20.0), [expected]);
    }

    #[test]
    fn a_gap_breaks_the_line_and_is_no_change() {
        let series = series(&[(0.0, 1.0), (2.0, 1.0), (6.0, 1.0), (10.0, 1.0)], &[(2.0, 6.0)]);
        let of = |from: f64, to: f64, is_stepped| parts(&Window::new(&series, from, to), is_stepped, to - from);
        let whole = [vec![(0.0, 1.0), (2.0, 1.0)], vec![(6.0, 1.0), (10.0, 1.0)]];
        let ends =
            |lines: Vec<Points>| lines.iter().map(|line| (line[0].0, line[line.len() - 1].0)).collect::<Vec<_>>();
        assert_eq!(of(0.0, 10.0, false), whole);
        assert_eq!(ends(of(0.0, 10.0, true)), [(0.0, 2.0), (6.0, 10.0)]);
        // With an edge of the figure within the gap, no value is held or interpolated at that edge.
        for is_stepped in [false, true] {
            assert_eq!(ends(of(3.0, 10.0, is_stepped)), [(6.0, 10.0)]);
            assert_eq!(ends(of(0.0, 5.0, is_stepped)), [(0.0, 2.0)]);
            assert_eq!(ends(of(3.0, 5.0, is_stepped)), []);
        }
        assert_eq!(Window::new(&series, 0.0, 10.0).changes(9), 0);
    }

    #[test]
    fn values_that_are_not_drawn_are_counted_each_time_they_come() {
        let (nan, infinite) = (f64::NAN, f64::INFINITY);
        let values = [1.0, nan, infinite, 2.0, nan, 1e200, 1e150, -1e151];
        let points: Vec<(f64, f64)> = values.iter().enumerate().map(|(n, &value)| (n as f64, value)).collect();
        assert_eq!(Window::new(&series(&points, &[]), 0.0, 9.0).undrawn(), (2, 2));
        assert_eq!(Window::new(&series(&points, &[]), 2.5, 9.0).undrawn(), (2, 2), "the one that holds at the start");
        assert_eq!(Window::new(&series(&points, &[]), 3.0, 3.5).undrawn(), (0, 0));
    }

    proptest! {
        /// A picture shows the lowest and the highest value of a column, and the points where the curve enters and
        /// leaves it.
        #[test]
        fn each_column_keeps_its_extremes_and_ends(values in prop::collection::vec(-1e6..1e6, 2..400), width in 1_u8..60) {
            let points: Vec<(f64, f64)> = values.iter().enumerate().map(|(n, &value)| (n as f64, value)).collect();
            let width = f64::from(width);
            let to = (points.len() - 1) as f64;
            let reduced = of(&points, 0.0, to, false, width);
            prop_assert_eq!(reduced.len(), 1);
            for pixel in 0..=width as i64 {
                let is_here = |point: &&(f64, f64)| (point.0 / to * width).floor() as i64 == pixel;
                let column = |all: &Points| all.iter().filter(is_here).map(|point| point.1).collect::<Vec<f64>>();
                let (all, kept) = (column(&points), column(&reduced[0]));
                prop_assert!(kept.len() <= 4);
                prop_assert_eq!(all.first(), kept.first());
                prop_assert_eq!(all.last(), kept.last());
                let extremes = |values: &[f64]| values.iter().fold((f64::MAX, f64::MIN), |(a, b), &v| (a.min(v), b.max(v)));
                prop_assert_eq!(extremes(&all), extremes(&kept));
            }
        }
    }
}

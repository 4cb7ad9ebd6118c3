use super::*;
use proptest::prelude::*;

/// Number of points of the largest table.
const MOST: usize = 1_000_000;

/// Either degree, for laws of both.
#[derive(Clone, Copy, Debug)]
enum Degree {
    Cubic,
    Quintic,
}

#[derive(Clone, Copy, Debug)]
enum Kept {
    Natural,
    Clamped([f64; 4]),
    Periodic,
}

fn through(x: &[f64], y: &[f64], degree: Degree, ends: Kept) -> Spline {
    match degree {
        Degree::Cubic => Spline::cubic(
            x,
            y,
            &match ends {
                Kept::Natural => Ends::Natural,
                Kept::Clamped([m, _, n, _]) => Ends::Clamped { first: [m], last: [n] },
                Kept::Periodic => Ends::Periodic,
            },
        ),
        Degree::Quintic => Spline::quintic(
            x,
            y,
            &match ends {
                Kept::Natural => Ends::Natural,
                Kept::Clamped([m, k, n, l]) => Ends::Clamped { first: [m, k], last: [n, l] },
                Kept::Periodic => Ends::Periodic,
            },
        ),
    }
    .expect("a spline")
}

/// Returns value and five derivatives by x at u of an interval, from its coefficients.
fn all(spline: &Spline, i: usize, u: f64, length: f64) -> [f64; 6] {
    let [c1, c2, c3, c4, c5] = spline.coefficients()[i];
    let mut polynomial = vec![0.0, c1, c2, c3, c4, c5];
    let mut scale = 1.0;
    [0; 6].map(|_| {
        let value = polynomial.iter().rfold(0.0, |sum, coefficient| sum * u + coefficient) / scale;
        polynomial = polynomial.iter().enumerate().skip(1).map(|(k, coefficient)| k as f64 * coefficient).collect();
        scale *= length;
        value
    })
}

/// m = 1.5, 0, -1.5 solve 2 m0 + m1 = 3, m0 + 4 m1 + m2 = 0, m1 + 2 m2 = -3.
#[test]
fn a_natural_cubic_spline_by_hand() {
    let spline = Spline::cubic(&[0.0, 1.0, 2.0], &[0.0, 1.0, 0.0], &Ends::Natural).expect("a spline");
    let wanted = [[1.5, 0.0, -0.5, 0.0, 0.0], [0.0, -1.5, 0.5, 0.0, 0.0]];
    for (value, wanted) in spline.coefficients().as_flattened().iter().zip(wanted.as_flattened()) {
        assert!((value - wanted).abs() < 1e-15, "{spline:?}");
    }
    // 1.5 u - 0.5 u^3 at 1/2; a = -3 u.
    assert_eq!((spline.rise(0, 0.0), spline.rise(0, 0.5), spline.rise(9, 0.5)), (0.0, 0.6875, 0.0));
    let Peaks { v, a, j } = spline.peaks(&[0.0, 1.0, 2.0]);
    for (peak, value) in [(v, 1.5), (a, 3.0), (j, 3.0)] {
        assert!((peak.value - value).abs() < 1e-14, "{peak:?}");
    }
    assert!((a.at - 1.0).abs() < 1e-9, "{a:?}");
}

/// 0, 1, 0, -1 at equal distances, periodic: by symmetry y' = 0 at the crests and -+ 3/2 at the zeros (cubic).
#[test]
fn a_periodic_cubic_spline_by_hand() {
    let (x, y) = ([0.0, 1.0, 2.0, 3.0, 4.0], [0.0, 1.0, 0.0, -1.0, 0.0]);
    let spline = Spline::cubic(&x, &y, &Ends::Periodic).expect("a spline");
    let slopes: Vec<_> = spline.coefficients().iter().map(|interval| interval[0]).collect();
    for (slope, wanted) in slopes.iter().zip([1.5, 0.0, -1.5, 0.0]) {
        assert!((slope - wanted).abs() < 1e-15, "{slopes:?}");
    }
}

/// A straight line is its own spline, with any ends; a periodic one gains its travel with each period.
#[test]
fn a_line_stays_a_line() {
    let (x, y) = ([0.0, 1.0, 3.0, 3.5, 8.0], [1.0, 3.0, 7.0, 8.0, 17.0]);
    for degree in [Degree::Cubic, Degree::Quintic] {
        for ends in [Kept::Natural, Kept::Clamped([2.0, 0.0, 2.0, 0.0]), Kept::Periodic] {
            let spline = through(&x, &y, degree, ends);
            for (interval, x) in spline.coefficients().iter().zip(x.windows(2)) {
                let wanted = [2.0 * (x[1] - x[0]), 0.0, 0.0, 0.0, 0.0];
                assert!(
                    interval.iter().zip(wanted).all(|(value, wanted)| (value - wanted).abs() < 1e-11),
                    "{spline:?}"
                );
            }
        }
    }
}

#[test]
fn two_points_suffice_with_clamped_ends() {
    // 2 x^5 - x^2 from 0 to 1: y' = 0 and 8, y'' = -2 and 38.
    let spline = through(&[0.0, 1.0], &[0.0, 1.0], Degree::Quintic, Kept::Clamped([0.0, -2.0, 8.0, 38.0]));
    assert_eq!(spline.coefficients(), [[0.0, -1.0, 0.0, 0.0, 2.0]]);
    let line = through(&[0.0, 2.0], &[0.0, 6.0], Degree::Cubic, Kept::Natural);
    let wanted = [6.0, 0.0, 0.0, 0.0, 0.0];
    assert!(
        line.coefficients()[0].iter().zip(wanted).all(|(value, wanted)| (value - wanted).abs() < 1e-14),
        "{line:?}"
    );
}

#[test]
fn invalid_spline_is_refused_with_its_point() {
    let refused = |x: &[f64], y: &[f64]| Spline::cubic(x, y, &Ends::Natural).expect_err("no spline").to_string();
    assert_eq!(refused(&[0.0], &[0.0]), "a spline has 1 points; 2 at least are needed with its ends");
    assert_eq!(refused(&[0.0, 1.0], &[0.0]), "a spline has 2 places and 1 values; as many of both are needed");
    assert_eq!(refused(&[0.0, f64::NAN], &[0.0; 2]), "point 1: x is NaN; a finite number is needed");
    assert_eq!(refused(&[0.0, 1.0, 2.0], &[0.0, 1.0, f64::INFINITY]), "point 2: y is inf; a finite number is needed");
    let order = "point 2: x is 1; more than 1, where the point before it is, is needed";
    assert_eq!(refused(&[0.0, 1.0, 1.0, 2.0], &[0.0; 4]), order);
    assert!(refused(&[0.0, 3.0, 2.0], &[0.0; 3]).starts_with("point 2: x is 2; more than 3"));
    let size = "point 0: it is too near to, or too far from, its neighbours for double precision";
    assert!(refused(&[0.0, 1e-320, 1.0], &[0.0; 3]).ends_with(&size[8..]));
    assert_eq!(refused(&[0.0, 1.0], &[-1e308, 1e308]), size);
    let count = |count, fewest| Err(SplineError::Count { count, fewest });
    assert_eq!(Spline::cubic(&[0.0, 1.0], &[0.0; 2], &Ends::Periodic), count(2, 3));
    assert_eq!(Spline::quintic(&[0.0, 1.0], &[0.0; 2], &Ends::Natural), count(2, 3));
    let ends = Ends::Clamped { first: [0.0, 1.0], last: [0.0, f64::NAN] };
    let refused = Spline::quintic(&[0.0, 1.0], &[0.0; 2], &ends).expect_err("no spline").to_string();
    assert_eq!(refused, "derivative 2 at the last point is NaN; a finite number is needed");
}

/// The largest number of points, along 3 turns of a sine and a line: the error of a spline is proportional to the
/// fourth power of its distances.
#[test]
fn a_million_points() {
    let turn = 6.0 * std::f64::consts::PI / (MOST - 1) as f64;
    let curve = |place: f64| 1000.0 * libm::sin(turn * place) + 0.001 * place;
    let x: Vec<f64> = (0..MOST).map(|i| i as f64).collect();
    let y: Vec<f64> = x.iter().map(|place| curve(*place)).collect();
    let slope = 1000.0 * turn + 0.001;
    for degree in [Degree::Cubic, Degree::Quintic] {
        for ends in [Kept::Natural, Kept::Clamped([slope, 0.0, slope, 0.0]), Kept::Periodic] {
            let spline = through(&x, &y, degree, ends);
            assert_eq!(spline.coefficients().len(), MOST - 1);
            for i in (0..MOST - 1).step_by(997) {
                let value = y[i] + spline.rise(i, 0.5);
                assert!((value - curve(i as f64 + 0.5)).abs() < 1e-9, "{degree:?} {ends:?} {i}: {value}");
            }
            let peak = spline.peaks(&x).v.value;
            assert!((peak - slope).abs() < 1e-9 * slope, "{degree:?} {ends:?}: {peak}");
        }
    }
}

fn points() -> impl Strategy<Value = (Vec<f64>, Vec<f64>)> {
    proptest::collection::vec((0.05_f64..5.0, -100.0_f64..100.0), 3..40).prop_map(|steps| {
        let mut place = -10.0;
        let x = steps.iter().map(|(step, _)| {
            place += step;
            place
        });
        (x.collect(), steps.iter().map(|(_, y)| *y).collect())
    })
}

fn ends() -> impl Strategy<Value = Kept> {
    prop_oneof![
        Just(Kept::Natural),
        proptest::array::uniform4(-50.0_f64..50.0).prop_map(Kept::Clamped),
        Just(Kept::Periodic)
    ]
}

proptest! {
    #[test]
    fn polynomials_of_its_degree_are_their_own_splines(
        coefficients in proptest::array::uniform6(-2.0_f64..2.0),
        steps in proptest::collection::vec(0.05_f64..1.0, 1..30),
    ) {
        let mut x = vec![-1.0];
        // Within -1 to 1, so that the values are not much larger than their coefficients.
        let whole: f64 = steps.iter().sum();
        x.extend(steps.iter().scan(0.0, |sum, step| {
            *sum += step;
            Some(-1.0 + 2.0 * *sum / whole)
        }));
        for degree in [Degree::Cubic, Degree::Quintic] {
            let mut law = Polynomial([0.0; 8]);
            let count = if matches!(degree, Degree::Cubic) { 4 } else { 6 };
            law.0[..count].copy_from_slice(&coefficients[..count]);
            let y: Vec<_> = x.iter().map(|x| law.at(*x).s).collect();
            let (first, last) = (law.at(x[0]), law.at(x[x.len() - 1]));
            let spline = through(&x, &y, degree, Kept::Clamped([first.v, first.a, last.v, last.a]));
            for (i, x) in x.windows(2).enumerate() {
                for u in [0.0, 0.2, 0.5, 0.9] {
                    let wanted = law.at(x[0] + u * (x[1] - x[0])).s;
                    prop_assert!((y[i] + spline.rise(i, u) - wanted).abs() < 1e-12, "{:?} {} {}", degree, i, u);
                }
            }
        }
    }

    /// At each point the spline and all derivatives below its degree are continuous; its ends are as given.
    #[test]
    fn derivatives_go_on((x, y) in points(), ends in ends()) {
        for (degree, count) in [(Degree::Cubic, 3), (Degree::Quintic, 5)] {
            let spline = through(&x, &y, degree, ends);
            let lengths: Vec<_> = x.windows(2).map(|x| x[1] - x[0]).collect();
            let end = |i: usize| all(&spline, i, 1.0, lengths[i]);
            let start = |i: usize| all(&spline, i, 0.0, lengths[i]);
            let last = lengths.len() - 1;
            // Rounding error of a derivative over the shortest interval, from the largest rise.
            let rises = (0..=last).flat_map(|i| [0.5, 1.0].map(|u| spline.rise(i, u).abs()));
            let rise = rises.fold(100.0, f64::max);
            let shortest = lengths.iter().fold(5.0, |one: f64, other| one.min(*other));
            let digits: Vec<_> = (0..6).map(|k| 1e-11 * rise / libm::pow(shortest, k.into())).collect();
            let same = |one: f64, other: f64, k: usize| (one - other).abs() <= digits[k];
            for i in 1..=last {
                let (before, after) = (end(i - 1), start(i));
                prop_assert_eq!(spline.rise(i, 0.0), 0.0);
                prop_assert!((before[0] - (y[i] - y[i - 1])).abs() < 1e-13 * rise, "{:?} point {}", degree, i);
                for k in 1..count {
                    prop_assert!(same(before[k], after[k], k), "{:?} {:?} point {} derivative {}", degree, ends, i, k);
                }
            }
            let (first, end) = (start(0), end(last));
            match ends {
                Kept::Natural => for k in count / 2 + 1..count {
                    prop_assert!(same(first[k], 0.0, k) && same(end[k], 0.0, k), "{:?} derivative {}", degree, k);
                },
                Kept::Clamped(wanted) => for k in 1..count.div_ceil(2) {
                    prop_assert!(same(first[k], wanted[k - 1], k) && same(end[k], wanted[k + 1], k), "{:?} derivative {}", degree, k);
                },
                Kept::Periodic => for k in 1..count {
                    prop_assert!(same(first[k], end[k], k), "{:?} derivative {}: {} {}", degree, k, first[k], end[k]);
                },
            }
        }
    }

    /// Derivatives and peaks by the position of the master match its coefficients.
    #[test]
    fn derivatives_and_peaks_are_those_of_its_coefficients((x, y) in points(), ends in ends(), u in 0.0_f64..1.0) {
        for degree in [Degree::Cubic, Degree::Quintic] {
            let spline = through(&x, &y, degree, ends);
            let peaks = spline.peaks(&x);
            for (i, x) in x.windows(2).enumerate() {
                let now = spline.at(i, u, x[1] - x[0]);
                let wanted = all(&spline, i, u, x[1] - x[0]);
                for (value, wanted) in [now.s, now.v, now.a, now.j].iter().zip(wanted) {
                    prop_assert!((value - wanted).abs() <= 1e-9 * wanted.abs().max(1.0));
                }
                prop_assert!((now.s - spline.rise(i, u)).abs() < 1e-11 * now.s.abs().max(100.0));
                for (value, peak) in [(now.v, peaks.v), (now.a, peaks.a), (now.j, peaks.j)] {
                    prop_assert!(value.abs() <= peak.value * (1.0 + 1e-12), "{} beyond {:?}", value, peak);
                }
            }
        }
    }
}

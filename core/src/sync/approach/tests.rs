use super::*;
use crate::encoder::Lead;
use crate::machine::rig::cases;
use crate::sync::Transmission;
use proptest::prelude::*;

fn ratio(numerator: i64, denominator: i64) -> Ratio {
    Ratio::new(numerator, denominator).expect("a ratio")
}

/// From rest, `place` before the pair.
fn from_rest(ratio: Ratio, length: i64, place: i64) -> Approach {
    approach(ratio, length, Begin { place: Position::whole(place), slope: 0.0, bend: 0.0 })
}

fn approach(ratio: Ratio, length: i64, begin: Begin) -> Approach {
    Approach::new(ratio, length, begin).expect("an approach").0
}

/// The curve from its boundary values, each times its own polynomial of 5th order (Hermite).
fn hermite(ratio: f64, length: f64, begin: Begin, s: f64) -> f64 {
    let Begin { place, slope, bend } = begin;
    let s3 = s * s * s;
    let (s4, s5) = (s3 * s, s3 * s * s);
    place.to_f64() * (1.0 - 10.0 * s3 + 15.0 * s4 - 6.0 * s5)
        + slope * length * (s - 6.0 * s3 + 8.0 * s4 - 3.0 * s5)
        + bend * length * length * (s * s / 2.0 - 1.5 * s3 + 1.5 * s4 - 0.5 * s5)
        + ratio * length * (-4.0 * s3 + 7.0 * s4 - 3.0 * s5)
}

/// At half of a distance of 256 inc at 1 : 2 over 1024: 256 (10/8 - 15/16 + 6/32) - 512 * 5/32 = 128 - 80.
#[test]
fn the_middle_of_a_way_from_rest_is_where_the_polynomial_has_it() {
    for sign in [1, -1] {
        let mut of = from_rest(ratio(sign, 2), 1_024, -256 * sign);
        let (first, gear) = of.step(Position::whole(512));
        assert_eq!((first, gear.is_none()), (Position::whole(48 * sign), true));
        let (rest, gear) = of.step(Position::whole(512));
        assert_eq!((rest, gear.is_some()), (Position::whole((256 - 48) * sign), true));
    }
}

/// From rest to the velocity of the leader, v T / 2 before: s = v T (x^3 - x^4 / 2), at most 1.5 v / T and 6 v / T^2.
///
/// Proves: MACS-MARK-17
#[test]
fn half_the_way_of_its_leader_is_the_way_that_it_takes_by_itself() {
    let mut of = from_rest(ratio(2, 1), 1_024, -1_024);
    let shape = of.shape();
    let near = |value: f64, expected: f64| assert!((value / expected - 1.0).abs() < 1e-9, "{value} is not {expected}");
    near(shape.bend, 1.5 * 2.0 / 1_024.0);
    near(of.jerk(), 6.0 * 2.0 / 1_024.0 / 1_024.0);
    near(shape.most, 2.0);
    for (share, way) in [(0.25, 28.0), (0.5, 192.0), (0.75, 540.0), (1.0, 1_024.0)] {
        of = from_rest(ratio(2, 1), 1_024, -1_024);
        let (moved, _) = of.step(Position::from_f64(1_024.0 * share));
        near(moved.to_f64(), way);
    }
}

/// The same curve reversed: the leader comes from above.
#[test]
fn a_leader_from_above_goes_the_same_curve_the_other_way() {
    let mut down = from_rest(ratio(1, 2), -1_024, 256);
    assert_eq!(down.step(Position::whole(-512)).0, Position::whole(-48));
    assert!(down.keeps_sign(1.0) && !down.keeps_sign(-1.0));
    assert_eq!(down.step(Position::whole(-512)).0, Position::whole(-208));
}

/// It holds before its start, and continues from there; after the pair it stays a gear.
#[test]
fn before_its_start_it_holds_and_behind_the_pair_it_is_a_gear() {
    let mut of = Transmission::Approach(from_rest(ratio(1, 2), 1_024, -256));
    let mut step = |change: i64| {
        let moved = of.step(Lead { change: Position::whole(change), ..Lead::default() }, &[]);
        (moved, of.approaches())
    };
    assert_eq!(step(-700), (Position::ZERO, true));
    assert_eq!(step(700), (Position::ZERO, true));
    assert_eq!(step(512), (Position::whole(48), true));
    assert_eq!(step(-900), (Position::whole(-48), true));
    assert_eq!(step(388 + 1_024 + 100), (Position::whole(256 + 50), false));
    // Back before the pair: 300 inc at 1 : 2, no curve.
    assert_eq!(step(-300), (Position::whole(-150), false));
}

/// From rest to the slope r over L: the shape finds the extrema of the bend, which contains terms such as 60 d / L^2. A
/// distance d of r L / 2 has the least bend:
/// y'' = r / L (60 (s - 3 s^2 + 2 s^3) / 2 + (-24 s + 84 s^2 - 60 s^3)) = r / L (6 s - 6 s^2), at most 1.5 r / L at the
/// middle.
#[test]
fn even_approach_from_rest_has_its_largest_bend_in_the_middle() {
    let shape = from_rest(ratio(3, 1), 1_000, -1_500).shape();
    assert!((shape.bend - 1.5 * 3.0 / 1_000.0).abs() < 1e-12, "{shape:?}");
    assert!(shape.least.abs() < 1e-12 && (shape.most - 3.0).abs() < 1e-12, "{shape:?}");
    // Without a distance of the slave: it has to move back first.
    let back = from_rest(ratio(3, 1), 1_000, 0);
    assert!(back.shape().least < -0.5 && !back.keeps_sign(1.0) && !back.keeps_sign(-1.0), "{:?}", back.shape());
}

#[test]
fn a_length_that_is_enough_is_found() {
    // 10 * 2^17 = 1310720 is the first; of the lengths below, 983040 and then 1146880 do not fit.
    assert_eq!(sufficient_length(10, |length| length >= 1_234_567), Some(1_310_720));
    assert_eq!(sufficient_length(10, |length| length >= Gear::MAX_CHANGE), Some(Gear::MAX_CHANGE));
    assert_eq!(sufficient_length(10, |_| false), None);
    assert_eq!(sufficient_length(10, |length| length >= 11), Some(12));
    assert_eq!(sufficient_length(1, |length| length >= 3), Some(3));
}

#[test]
fn invalid_approach_is_none() {
    let begin = Begin { place: Position::whole(5), slope: 0.0, bend: 0.0 };
    let of = |length, begin| Approach::new(Ratio::ONE, length, begin).is_some();
    assert!(of(Gear::MAX_CHANGE, begin) && of(-Gear::MAX_CHANGE, begin));
    assert!(!of(0, begin) && !of(Gear::MAX_CHANGE + 1, begin) && !of(i64::MIN, begin));
    assert!(!of(1, Begin { slope: f64::NAN, ..begin }) && !of(1, Begin { bend: f64::INFINITY, ..begin }));
    assert!(!of(1, Begin { place: Position::whole(Position::LIMIT), ..begin }));
}

fn ratios() -> impl Strategy<Value = Ratio> {
    let prime = prop::sample::select(vec![1_i64, 2, 3, 7, 113, 355, 997, 7_919, 104_729]);
    (prime.clone(), prime, any::<bool>()).prop_map(|(numerator, denominator, turns)| {
        let numerator = if turns { -numerator } else { numerator };
        // Steeper ratios do not occur in machines.
        ratio(numerator, denominator.max(numerator.abs() / 1_000 + 1))
    })
}

/// Any start: a slave at rest, in motion or accelerating, on either side.
fn begins() -> impl Strategy<Value = Begin> {
    (-(1_i128 << 52)..1 << 52, -3.0..3.0_f64, -1e-3..1e-3_f64).prop_map(|(place, slope, bend)| Begin {
        place: Position::from_raw(place),
        slope,
        bend,
    })
}

proptest! {
    #![proptest_config(cases(300))]

    /// At most a quarter longer than the shortest one, with a number of tests that does not grow with it.
    #[test]
    fn an_answer_is_enough_and_no_quarter_too_long(asked in 1_i64..1 << 31, least in 1_i64..1 << 31) {
        let questions = std::cell::Cell::new(0);
        let found = sufficient_length(asked, |length| {
            questions.set(questions.get() + 1);
            length >= least
        });
        prop_assert!(questions.get() <= 34, "{}", questions.get());
        let shortest = asked.max(least).min(Gear::MAX_CHANGE);
        if least <= Gear::MAX_CHANGE {
            prop_assert!(found.is_some_and(|found| found >= shortest && (found - shortest) * 4 <= shortest), "{:?}", found);
        }
    }

    /// With any ratio and start, and any motion of the leader: after the pair the slave is at
    /// floor(ratio * (leader - pair)) in units of 2^-32 inc, without limit of distance.
    #[test]
    fn behind_the_pair_it_is_exact(
        ratio in ratios(),
        begin in begins(),
        (length, is_down) in (1_i64..2_000_000, any::<bool>()),
        changes in prop::collection::vec(-(1_i128 << 46)..1 << 48, 1..80),
    ) {
        let sign = if is_down { -1 } else { 1 };
        let mut of = Transmission::Approach(approach(ratio, sign * length, begin));
        let mut leader = -Position::whole(sign * length).raw();
        let mut slave = begin.place.raw();
        let mut has_passed = false;
        for change in changes.iter().map(|change| change * i128::from(sign)) {
            leader += change;
            slave += of.step(Lead { change: Position::from_raw(change), ..Lead::default() }, &[]).raw();
            has_passed |= leader * i128::from(sign) >= 0;
            prop_assert_eq!(of.approaches(), !has_passed);
            if has_passed {
                let exact = (leader * i128::from(ratio.numerator())).div_euclid(i128::from(ratio.denominator()));
                prop_assert_eq!(slave, exact);
            }
        }
    }

    /// The curve has its boundary values, and depends only on the position of the leader: motion back and forth before
    /// changes nothing but rounding.
    #[test]
    fn it_is_the_polynomial_of_its_boundary_values(
        ratio in ratios(),
        begin in begins(),
        (length, is_down) in (1_000_i64..2_000_000, any::<bool>()),
        shares in prop::collection::vec(0.001..0.999_f64, 1..20),
    ) {
        let length = if is_down { -length } else { length };
        let mut of = approach(ratio, length, begin);
        let (mut at, mut slave) = (Position::ZERO, begin.place);
        for share in shares {
            let next = Position::from_f64(share * length as f64);
            slave += of.step(next - at).0;
            at = next;
            let s = at.to_f64() / length as f64;
            let exact = hermite(ratio.to_f64(), length as f64, begin, s);
            let scale = begin.place.to_f64().abs() + length.unsigned_abs() as f64 * (4.0 + ratio.to_f64().abs()) + 4e9;
            prop_assert!((slave.to_f64() - exact).abs() <= scale * 1e-12, "{} {}", slave.to_f64(), exact);
            let h = 1e-5;
            let around = [s + h, s - h].map(|s| hermite(ratio.to_f64(), length as f64, begin, s));
            let slope = (around[0] - around[1]) / (2.0 * h) / length as f64;
            let bound = 1e-4 * (slope.abs() + scale / length.unsigned_abs() as f64);
            prop_assert!((of.slope() - slope).abs() <= bound, "{} {}", of.slope(), slope);
        }
    }

    /// No slope and no bend exceeds the shape, and each extremum is reached.
    #[test]
    fn shape_equals_extrema_of_the_curve(ratio in ratios(), begin in begins(), length in 1_000_i64..2_000_000) {
        let of = approach(ratio, length, begin);
        let shape = of.shape();
        let long = length as f64;
        let first = derivative(&of.curve());
        let second = derivative(&first);
        let grid = || (0..=2_000).map(|k| f64::from(k) / 2_000.0);
        let slopes: Vec<f64> = grid().map(|s| value(&first, s) / long).collect();
        let (low, high) = slopes.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
        let bend = grid().map(|s| (value(&second, s) / long / long).abs()).fold(0.0, f64::max);
        // Between two of 2000 positions a polynomial of 4th order differs by no more than this part of its range.
        let (room, fine) = ((high - low).max(1e-12), 1e-9);
        prop_assert!(shape.least <= low + fine * room && shape.least >= low - 1e-4 * room, "{} {}", shape.least, low);
        prop_assert!(shape.most >= high - fine * room && shape.most <= high + 1e-4 * room, "{} {}", shape.most, high);
        prop_assert!(shape.bend >= bend * (1.0 - fine) && shape.bend <= bend * (1.0 + 1e-3) + 1e-18, "{} {}", shape.bend, bend);
        // The boundary values are within.
        let ends = [begin.slope, ratio.to_f64()];
        prop_assert!(ends.iter().all(|end| shape.least <= end + 1e-9 && shape.most >= end - 1e-6 * (1.0 + end.abs())));
    }

    /// A curve that rises throughout never falls by rounding, in steps of any size.
    #[test]
    fn rising_curve_never_falls(
        ratio in ratios(),
        length in 1_000_i64..2_000_000_000,
        part in 0.42..0.58_f64,
        steps in prop::collection::vec(1_i128..1 << 34, 1..60),
        at in 0.0..1.0_f64,
    ) {
        let way = Position::from_f64(ratio.to_f64() * length as f64 * part);
        let mut of = approach(ratio, length, Begin { place: -way, slope: 0.0, bend: 0.0 });
        prop_assert!(of.keeps_sign(ratio.to_f64()), "{:?}", of.shape());
        let rises = ratio.numerator() > 0;
        of.step(Position::from_f64(at * length as f64));
        for step in steps {
            let (change, gear) = of.step(Position::from_raw(step));
            prop_assert!(change == Position::ZERO || (change > Position::ZERO) == rises, "{change:?}");
            if gear.is_some() {
                break;
            }
            let (back, _) = of.step(Position::from_raw(-step / 2));
            prop_assert!(back == Position::ZERO || (back < Position::ZERO) == rises, "{back:?}");
        }
    }
}

use super::super::transfer::Peak;
use super::*;
use proptest::prelude::*;

fn plan(is_cyclic: bool, segments: &[(f64, f64, Law)]) -> Result<Plan, PlanError> {
    let segments: Vec<_> = segments.iter().map(|&(to, travel, law)| Segment { to, travel, law }).collect();
    Plan::new(&segments, is_cyclic)
}

#[test]
fn segments_follow_each_other() {
    let plan =
        plan(true, &[(90.0, 0.0, Law::Dwell), (180.0, 40.0, Law::ModifiedSine), (360.0, -40.0, Law::Polynomial5)]);
    let plan = plan.expect("a plan");
    assert_eq!((plan.length(), plan.end(), plan.jumps()), (360.0, 0.0, vec![]));
    for (x, y) in
        [(0.0, 0.0), (45.0, 0.0), (90.0, 0.0), (135.0, 20.0), (180.0, 40.0), (270.0, 20.0), (360.0, 0.0), (400.0, 0.0)]
    {
        assert!((plan.at(x).s - y).abs() < 1e-12, "{x}: {:?}", plan.at(x));
    }
}

/// From rest over 20 to a line of slope 2 and back: the polynomial with velocities 0 and m at its ends and travel m h
/// / 2 has, by symmetry, degree 4: m h (u^3 - u^4 / 2).
#[test]
fn polynomial_takes_the_velocity_of_an_adjacent_line() {
    for law in [Law::Polynomial5, Law::Polynomial7] {
        let plan = plan(false, &[(20.0, 20.0, law), (50.0, 60.0, Law::Straight), (70.0, 20.0, law)]).expect("a plan");
        assert_eq!((plan.jumps(), plan.end()), (vec![], 100.0));
        let before = |x: f64| plan.at(x);
        for (x, v) in [(0.0, 0.0), (10.0, 1.0), (20.0 - 1e-12, 2.0), (20.0, 2.0), (50.0, 2.0), (60.0, 1.0), (70.0, 0.0)]
        {
            assert!((before(x).v - v).abs() < 1e-9, "{law:?} at {x}: {:?}", before(x));
        }
        if law == Law::Polynomial5 {
            let u: f64 = 0.3;
            assert!((plan.at(20.0 * u).s - 40.0 * (u * u * u - u * u * u * u / 2.0)).abs() < 1e-12);
        }
    }
}

/// The travel from velocity 0 to m over h is m h (u^3 - u^4 / 2): v = m (3 u^2 - 2 u^3), a = m / h (6 u - 6 u^2), j = m
/// / h^2 (6 - 12 u).
#[test]
fn peaks_of_a_solved_polynomial_are_exact() {
    let plan = plan(false, &[(20.0, 20.0, Law::Polynomial5), (50.0, 60.0, Law::Straight)]).expect("a plan");
    let Peaks { v, a, j } = plan.peaks();
    for (peak, value, at) in [(v, 2.0, 20.0), (a, 0.15, 10.0), (j, 0.03, 0.0)] {
        assert!((peak.value - value).abs() < 1e-14 && (peak.at - at).abs() < 1e-6, "{peak:?}");
    }
    assert_eq!(plan.jumps(), [Jump { at: 50.0, derivative: 1, before: 2.0, after: 0.0 }]);
}

/// Cv d / h, Ca d / h^2, Cj d / h^3 of the segment with the largest values.
#[test]
fn peaks_of_laws_are_scaled() {
    let plan = plan(
        true,
        &[(100.0, -30.0, Law::Polynomial7), (150.0, 0.0, Law::Dwell), (200.0, 30.0, Law::ModifiedTrapezoid)],
    );
    let Peaks { v, a, j } = plan.expect("a plan").peaks();
    let ca = 8.0 * std::f64::consts::PI / (2.0 + std::f64::consts::PI);
    let cj = 4.0 * std::f64::consts::PI * ca;
    for (peak, value, at) in [(v, 1.2, 175.0), (a, ca * 0.012, 156.25), (j, cj * 0.000_24, 150.0)] {
        assert!((peak.value - value).abs() < 1e-13 && (peak.at - at).abs() < 1e-9, "{peak:?}: {value} at {at}");
    }
}

#[test]
fn a_cyclic_plan_goes_round() {
    let plan = |is_cyclic| plan(is_cyclic, &[(100.0, 30.0, Law::Polynomial7), (300.0, 100.0, Law::Straight)]);
    let (round, once) = (plan(true).expect("a plan"), plan(false).expect("a plan"));
    assert!((round.at(0.0).v - 0.5).abs() < 1e-15 && once.at(0.0).v == 0.0);
    assert_eq!((round.jumps(), once.jumps().len(), round.end()), (vec![], 1, 130.0));
}

#[test]
fn acceleration_jumps_are_reported() {
    let a = std::f64::consts::PI * std::f64::consts::PI / 2.0 * 0.04;
    let up_and_down = [(10.0, 4.0, Law::SimpleSine), (20.0, -4.0, Law::SimpleSine)];
    // Up and down again: the acceleration at the end of one is that at the start of the other.
    assert_eq!(plan(true, &up_and_down).expect("a plan").jumps(), []);
    let told = plan(false, &up_and_down).expect("a plan").jumps();
    assert_eq!(told.iter().map(|jump| (jump.at, jump.derivative)).collect::<Vec<_>>(), [(0.0, 2), (20.0, 2)]);
    for (value, wanted) in told.iter().flat_map(|jump| [jump.before, jump.after]).zip([0.0, a, a, 0.0]) {
        assert!((value - wanted).abs() < 1e-15, "{told:?}");
    }
    let beside = [(10.0, 4.0, Law::SimpleSine), (20.0, -4.0, Law::Polynomial5)];
    let places: Vec<_> = plan(true, &beside).expect("a plan").jumps().iter().map(|jump| jump.at).collect();
    assert_eq!(places, [0.0, 10.0]);
}

#[test]
fn invalid_plan_is_refused_with_its_segment() {
    let (nan, far) = (f64::NAN, 1e200);
    let turn = (10.0, 0.0, Law::Dwell);
    for (segments, sentence) in [
        (&[][..], "a plan has 0 segments; 1 at least is needed"),
        (&[(nan, 1.0, Law::Straight)], "segment 1: to is NaN; a finite number is needed"),
        (&[turn, (20.0, f64::INFINITY, Law::Straight)], "segment 2: travel is inf; a finite number is needed"),
        (
            &[turn, (10.0, 1.0, Law::Polynomial5)],
            "segment 2: to is 10; more than 10, where the segment begins, is needed",
        ),
        (&[(-1.0, 1.0, Law::Polynomial5)], "segment 1: to is -1; more than 0, where the segment begins, is needed"),
        (&[(10.0, 1.0, Law::Dwell)], "segment 1: travel is 1; 0 is needed for law dwell"),
        (
            &[turn, (20.0, 0.0, Law::ModifiedSine)],
            "segment 2: travel is 0; another value is needed for law modified_sine, or law dwell",
        ),
        (
            &[(1e-200, far, Law::Polynomial5)],
            "segment 1: travel is 1e200 within 1e-200 of the master; that cannot be computed with",
        ),
        (
            &[(10.0, 20.0, Law::Straight), (20.0, 20.0, Law::ModifiedSine)],
            "segment 2 (modified_sine): it begins at 10 with velocity 0, segment 1 (straight) ends with 2; the same is needed: put polynomial_5 \
             or polynomial_7 between",
        ),
        (
            &[turn, (20.0, 20.0, Law::Straight), (30.0, 1.0, Law::Polynomial5)],
            "segment 2 (straight): it begins at 10 with velocity 2, segment 1 (dwell) ends with 0; the same is needed: put polynomial_5 or \
             polynomial_7 between",
        ),
        (
            &[(10.0, 5.0, Law::Straight), (20.0, 6.0, Law::Straight)],
            "segment 2 (straight): it begins at 10 with velocity 0.6, segment 1 (straight) ends with 0.5; the same is needed: put polynomial_5 or \
             polynomial_7 between",
        ),
    ] {
        let refused = plan(false, segments).expect_err("no plan").to_string();
        assert_eq!(refused, sentence);
    }
    let around = plan(true, &[(10.0, 5.0, Law::Straight), (20.0, 5.0, Law::Polynomial5), (30.0, 0.0, Law::Dwell)]);
    let refused = around.expect_err("no plan").to_string();
    assert!(
        refused.starts_with("segment 1 (straight): it begins at 0 with velocity 0.5, segment 3 (dwell) ends with 0;"),
        "{refused}"
    );
    // A slope is the same however it is divided.
    let parts = [(0.1, 0.1, Law::Straight), (0.3, 0.2, Law::Straight), (1.0, 0.7, Law::Straight)];
    assert!(plan(true, &parts).is_ok());
}

/// Any segments, with polynomials next to every line.
fn segments() -> impl Strategy<Value = Vec<Segment>> {
    let law = (0..Law::ALL.len()).prop_map(|i| Law::ALL[i].0);
    let segment = (law, 0.5_f64..50.0, prop_oneof![-80.0_f64..-0.1, 0.1_f64..80.0], any::<bool>());
    proptest::collection::vec(segment, 1..12).prop_map(|parts| {
        let mut segments = Vec::new();
        let mut to = 0.0;
        let mut push = |length: f64, travel, law| {
            to += length;
            segments.push(Segment { to, travel, law });
        };
        for (law, length, travel, is_high) in parts {
            let between = if is_high { Law::Polynomial7 } else { Law::Polynomial5 };
            if law == Law::Straight {
                push(length / 2.0, travel / 3.0, between);
            }
            push(length, if law == Law::Dwell { 0.0 } else { travel }, law);
            if law == Law::Straight {
                push(length / 3.0, -travel, between);
            }
        }
        segments
    })
}

proptest! {
    /// Travel, velocity and, without reported jump, acceleration are continuous between segments; between polynomials
    /// of degree 7 also the jerk.
    #[test]
    fn segments_meet_as_their_laws_promise(segments in segments(), is_cyclic: bool) {
        let plan = Plan::new(&segments, is_cyclic).expect("a plan");
        let peaks = plan.peaks();
        let told = plan.jumps();
        prop_assert_eq!(Some(plan.length()), segments.last().map(|last| last.to));
        prop_assert!(told.iter().all(|jump| jump.derivative == 2), "{:?}", told);
        let joints = plan.pieces.windows(2).map(|pair| (pair[0], pair[1], 0.0));
        let around = plan.pieces.last().zip(plan.pieces.first()).filter(|_| is_cyclic);
        let around = around.map(|(last, first)| (*last, *first, plan.end()));
        for (before, after, way) in joints.chain(around) {
            let (end, start) = (before.at(before.to), after.at(after.from));
            prop_assert!((end.s - start.s - way).abs() < 1e-11, "{:?} {:?}", before, after);
            prop_assert!((end.v - start.v).abs() <= 1e-12 * peaks.v.value);
            if !told.iter().any(|jump| jump.at == after.from) {
                prop_assert!((end.a - start.a).abs() <= 1e-12 * peaks.a.value);
            }
            if before.law == Law::Polynomial7 && after.law == Law::Polynomial7 {
                prop_assert!((end.j - start.j).abs() <= 1e-12 * peaks.j.value);
            }
        }
    }

    /// No value exceeds a peak, and each peak is reached at its position.
    #[test]
    fn peaks_hold(segments in segments(), is_cyclic: bool, places in proptest::collection::vec(0.0_f64..=1.0, 200)) {
        let plan = Plan::new(&segments, is_cyclic).expect("a plan");
        let Peaks { v, a, j } = plan.peaks();
        for x in places.iter().map(|place| place * plan.length()) {
            let now = plan.at(x);
            for (value, peak) in [(now.v, v), (now.a, a), (now.j, j)] {
                prop_assert!(value.abs() <= peak.value * (1.0 + 1e-12), "{} at {} beyond {:?}", value, x, peak);
            }
        }
        let reached = |peak: Peak, of: fn(Derivatives) -> f64| {
            let amounts = plan.pieces.iter().filter(|piece| (piece.from..=piece.to).contains(&peak.at));
            amounts.map(|piece| of(piece.at(peak.at)).abs()).any(|value| (value - peak.value).abs() <= 1e-9 * peak.value)
        };
        prop_assert!(reached(v, |now| now.v) && reached(a, |now| now.a) && reached(j, |now| now.j), "{:?}", plan.peaks());
    }
}

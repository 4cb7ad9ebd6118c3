//! Tests of each mode by its table rows and by its law.

use super::Mode::*;
use super::*;
use proptest::prelude::*;

/// A turn of 360 increments.
fn circle() -> Circle {
    Circle::new(Modulo::new(360, 1))
}

fn whole(increments: i64) -> Exact {
    circle().exact(Position::whole(increments))
}

/// Returns A for a change of `wanted` at `from` on a turn of 360.
fn added(mode: Mode, wanted: i64, from: i64) -> i64 {
    circle().position(circle().added(mode, whole(wanted), whole(from))).floor()
}

/// Returns A and the displayed end of an absolute move.
fn absolute(mode: Mode, from: i64, reference: i64) -> (i64, i64) {
    let wanted = whole(reference).minus(circle().shown(whole(from)));
    let a = circle().added(mode, wanted, whole(from));
    let end = circle().shown(whole(from).plus(a));
    (circle().position(a).floor(), circle().position(end).floor())
}

/// Proves: AMC-ORA-01, AMC-ORA-03, AMC-ORA-04, AMC-ROT-10, AMC-ROT-11, AMC-ROT-12
#[test]
fn the_oracles_of_modes_0_to_2() {
    assert_eq!(absolute(Shortest, 350, 10), (20, 10));
    assert_eq!(absolute(Forward, 100, 40), (300, 40));
    assert_eq!(absolute(Reverse, 40, 100), (-300, 100));
}

/// Proves: AMC-ORA-06, AMC-ROT-14, AMC-ROT-15, AMC-ROT-16, AMC-ROT-18
#[test]
fn the_oracles_of_modes_4_to_6() {
    assert_eq!(absolute(MultiTurnForward, 300, 800), (500, 80));
    assert_eq!(absolute(MultiTurnForward, 300, 100), (160, 100));
    assert_eq!(absolute(MultiTurnForward, 300, -100), (0, 300));
    // The mirror images: from 60, references 360 - x.
    assert_eq!(absolute(MultiTurnReverse, 60, -440), (-500, 280));
    assert_eq!(absolute(MultiTurnReverse, 60, 260), (-160, 260));
    assert_eq!(absolute(MultiTurnReverse, 60, 460), (0, 60));
    assert_eq!(absolute(MultiTurnDelta, 300, -100), (-400, 260));
}

/// Proves: AMC-ORA-08
#[test]
fn mode_6_crosses_three_times() {
    for (wanted, end, crossings) in [(1000, 220, 3), (-1000, 20, -2)] {
        assert_eq!(added(MultiTurnDelta, wanted, 300), wanted);
        assert_eq!((300 + wanted).rem_euclid(360), end);
        assert_eq!(circle().shown(whole(300 + wanted)), whole(end));
        assert_eq!((300_i64 + wanted).div_euclid(360), crossings);
    }
}

/// Proves: AMC-ROT-10, AMC-ROT-20
#[test]
fn half_a_turn_keeps_its_sign_and_whole_turns_are_none() {
    for (wanted, a) in
        [(180, 180), (-180, -180), (181, -179), (-181, 179), (360, 0), (-360, 0), (540, 180), (-900, -180)]
    {
        assert_eq!(added(Shortest, wanted, 0), a, "{wanted}");
    }
}

/// Half of 1001 inc is 500.5, of 333 1/3 it is 166 2/3, of 250 1/4 it is 125 1/8: as differences of references up to
/// 501, 167 and 126.
///
/// Proves: AMC-ROT-10
#[test]
fn half_a_turn_keeps_its_sign_where_it_is_no_whole_increment() {
    for (numerator, denominator, half) in [(1_001, 1, 501), (1_000, 3, 167), (1_001, 4, 126), (360, 1, 180)] {
        let circle = Circle::new(Modulo::new(numerator, denominator));
        let way = |increments| circle.exact(Position::whole(increments));
        let added = |wanted| circle.added(Shortest, wanted, way(0));
        for keeps in [half, half - 1, -half, 1 - half] {
            assert_eq!(added(way(keeps)), way(keeps), "{keeps} of {numerator}/{denominator}");
        }
        // One increment more takes the other direction, with the rest of the turn.
        for (beyond, sign) in [(half + 1, 1), (-half - 1, -1)] {
            let rest = Exact(way(beyond).0 - sign * circle.turn.unwrap());
            assert_eq!(added(way(beyond)), rest, "{beyond} of {numerator}/{denominator}");
        }
    }
}

/// Proves: AMC-ROT-11, AMC-ROT-12, AMC-ROT-14, AMC-ROT-15
#[test]
fn a_whole_turn_against_the_direction_moves_nothing() {
    for mode in [Forward, MultiTurnForward] {
        assert_eq!([-360, -1, 0, 359].map(|wanted| added(mode, wanted, 5)), [0, 359, 0, 359], "{mode:?}");
    }
    for mode in [Reverse, MultiTurnReverse] {
        assert_eq!([360, 1, 0, -359].map(|wanted| added(mode, wanted, 5)), [0, -359, 0, -359], "{mode:?}");
    }
    assert_eq!([added(Forward, 720, 5), added(MultiTurnForward, 720, 5)], [0, 720]);
}

/// Proves: AMC-ROT-13
#[test]
fn mode_3_goes_the_way_that_crosses_nothing() {
    assert_eq!(absolute(NoRollover, 350, 10), (-340, 10));
    assert_eq!(absolute(NoRollover, 10, 350), (340, 350));
    assert_eq!(added(NoRollover, 20, 350), -340);
    assert_eq!(added(NoRollover, -20, 10), 340);
    assert_eq!([added(NoRollover, 9, 350), added(NoRollover, 10, 350)], [9, -350], "359 is the last one");
}

/// Proves: AMC-ROT-01
#[test]
fn without_a_turn_and_in_fast_samples_a_change_is_added_as_it_is() {
    let modulo = Modulo::new(360, 1);
    assert_eq!(Mode::new(1, modulo, 500_000), Forward);
    assert_eq!(Mode::new(1, modulo, 499_999), Linear);
    assert_eq!(Mode::new(1, None, 1_000_000), Linear);
    assert_eq!(added(Linear, -500, 20), -500);
    let line = Circle::new(None);
    for wanted in [-500, 500] {
        let wanted = line.exact(Position::whole(wanted));
        assert_eq!(line.added(Shortest, wanted, line.exact(Position::ZERO)), wanted);
    }
}

/// Proves: AMC-ROT-04, AMC-ORA-10
#[test]
fn a_turn_of_a_million_units_leaves_2147_turns() {
    let turn = |numerator, denominator| Circle::new(Modulo::new(numerator, denominator));
    assert_eq!(turn(1_000_000, 1).capacity(1.0), Some(2147));
    assert_eq!(turn(36_000, 1).capacity(100.0), Some(5_965_232), "in user units: 360 of 100 inc");
    assert_eq!(turn(1 << 40, 1).capacity(1.0), Some(0));
    assert_eq!(Circle::new(None).capacity(1.0), None);
    let million = turn(1_000_000, 1);
    let way = |increments| million.exact(Position::whole(increments));
    assert!(!million.exceeds(way(2_147_000_000), 2147) && million.exceeds(way(-2_147_000_001), 2147));
}

#[test]
fn the_edges_of_all_positions_overflow_nothing() {
    let widest = [i64::MIN, i64::MAX, (1 << 62) - 1, 0];
    for modulo in [None, Modulo::new((1 << 61) - 1, (1 << 31) - 1), Modulo::new(1, 1)] {
        let circle = Circle::new(modulo);
        for (from, wanted) in widest.iter().flat_map(|from| widest.map(|wanted| (*from, wanted))) {
            let (from, wanted) = (circle.exact(Position::whole(from)), circle.exact(Position::whole(wanted)));
            for mode in [Shortest, Forward, Reverse, NoRollover, MultiTurnForward, MultiTurnReverse, MultiTurnDelta] {
                let sum = from.plus(circle.added(mode, wanted.minus(circle.shown(from)), from));
                circle.nearest(sum);
                circle.position(circle.shown(sum));
            }
            assert!(from.is_sound());
        }
    }
    assert!(!Exact(i128::MAX).is_sound());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Proves: AMC-ROT-02, AMC-ROT-03, AMC-ROT-10, AMC-ROT-11, AMC-ROT-12, AMC-ROT-13, AMC-ROT-14, AMC-ROT-15,
    /// AMC-ROT-16, AMC-ROT-18, AMC-ROT-20
    #[test]
    fn every_mode_ends_where_the_reference_says_and_goes_its_way(
        numerator in 2_i64..1 << 45, denominator in 1_i64..2000,
        turns in -70_i64..70, place in 0.0..1.0_f64, reference in -70.0..70.0_f64,
        number in 0_i64..7,
    ) {
        prop_assume!(numerator > denominator);
        let modulo = Modulo::new(numerator, denominator);
        let circle = Circle::new(modulo);
        let turn = circle.turn.unwrap();
        let scaled = |part: f64| (turn as f64 * part) as i128;
        // References are whole increments; the input is any position.
        let reference = circle.exact(Position::whole((scaled(reference) / (circle.denominator << 32)) as i64));
        let from = Exact(turn * i128::from(turns) + scaled(place));
        let shown = circle.shown(from);
        prop_assert!((0..turn).contains(&shown.0), "turns are left out");
        let mode = Mode::new(number, modulo, 1_000_000);
        let wanted = reference.minus(shown);
        let added = circle.added(mode, wanted, from);
        let end = from.plus(added);
        let ignored = matches!(mode, MultiTurnForward if wanted.0 <= -turn)
            || matches!(mode, MultiTurnReverse if wanted.0 >= turn);
        if ignored {
            prop_assert_eq!(added.0, 0);
        } else {
            prop_assert_eq!(circle.shown(end).0, reference.0.rem_euclid(turn), "{:?}", mode);
        }
        match mode {
            // Up to the whole increment to which half a turn is rounded for references.
            Shortest => {
                let beyond = added.0.abs() - turn / 2;
                prop_assert!(beyond <= turn % 2 || beyond < circle.denominator << 32);
            }
            Forward => prop_assert!((0..turn).contains(&added.0)),
            Reverse => prop_assert!((0..turn).contains(&-added.0)),
            NoRollover => prop_assert_eq!(end.0.div_euclid(turn), from.0.div_euclid(turn), "never crosses"),
            MultiTurnForward => prop_assert!(added.0 >= 0 && (wanted.0 < 0 || added == wanted)),
            MultiTurnReverse => prop_assert!(added.0 <= 0 && (wanted.0 > 0 || added == wanted)),
            MultiTurnDelta | Linear => prop_assert_eq!(added, wanted),
        }
        // A tracked target comes to rest: the remaining change causes no motion.
        if mode.is_within_turn() {
            let left = reference.minus(circle.shown(end));
            prop_assert_eq!(circle.added(mode, left, end).0, 0);
        }
    }
}

//! Two views of one value agree, in any order of sets.

use super::super::*;
use super::parameters;
use crate::unit::MLONG;
use proptest::prelude::*;

fn row(key: &str) -> &'static Row {
    Row::find(key).map(|(_, row)| row).unwrap_or_else(|| panic!("{key}"))
}

fn set(parameters: &mut AxisParameters, key: &str, value: Value) {
    assert_eq!(row(key).change(parameters, value), Ok(()), "{key}");
}

/// Returns a legal value.
fn pick(row: &Row, seed: u64) -> Value {
    let (choice, seed) = (seed % 8, seed / 8);
    match row.range {
        _ if choice == 0 && !row.required && !row.is_view() => row.default,
        Range::Int(low, high) => Value::Int(match choice {
            1 => low,
            2 => high,
            // Mostly usual numbers.
            3..6 => low.max(-1000) + (seed % 2000) as i64 % (high - low.max(-1000)).saturating_add(1),
            _ => low + (i128::from(seed) % (i128::from(high) - i128::from(low) + 1)) as i64,
        }),
        Range::Among(ranges) => Value::Int(ranges[seed as usize % ranges.len()].0),
        Range::PositiveUpTo(high) => {
            let power = [1e-3, 1.0, 1e3, 1e6][choice as usize % 4];
            Value::Real(((seed % 1_000_000 + 1) as f64 * power).min(high))
        }
        Range::Real(low, high) => Value::Real(low + (high - low) * ((seed % 1001) as f64 / 1000.0)),
    }
}

/// Returns true if both may be in one set. A limit and its switch are one value, each a part of it.
fn go_together(one: &Row, other: &Row) -> bool {
    let is_part = |row: &Row| row.key.ends_with("limit") || row.key.ends_with("limact");
    // In inverted units a limit of MACS is the other native one.
    let is_limit = |row: &Row| row.root().ends_with("_position");
    if is_limit(one) && is_limit(other) {
        return is_part(one) == is_part(other) && one.key != other.key;
    }
    one.root() != other.root()
}

type Set = Vec<(usize, u64)>;

/// Rows that may be set together, with values.
fn a_set() -> impl Strategy<Value = Set> {
    let all: Vec<usize> = (0..ROWS.len()).filter(|place| ROWS[*place].is_stored() || ROWS[*place].is_view()).collect();
    // Rows that depend on one another are chosen more often.
    let bound: Vec<usize> = all
        .iter()
        .copied()
        .filter(|place| {
            let row = &ROWS[*place];
            matches!(row.group, Group::Basic) || ["encoder", "min_position", "max_position"].contains(&row.root())
        })
        .collect();
    let some = |from: Vec<usize>, most: usize| proptest::sample::subsequence(from, 0..most);
    (some(bound, 12), some(all, 6)).prop_flat_map(|(mut places, others)| {
        places.extend(others);
        let mut chosen: Vec<usize> = Vec::new();
        for place in places {
            if chosen.iter().all(|other| go_together(&ROWS[*other], &ROWS[place])) {
                chosen.push(place);
            }
        }
        let count = chosen.len();
        (Just(chosen), proptest::collection::vec(any::<u64>(), count))
            .prop_map(|(places, seeds)| places.into_iter().zip(seeds).collect::<Set>())
            .prop_shuffle()
    })
}

/// Applies the changes as all interfaces do: the direction of rotation first.
fn apply(parameters: &mut AxisParameters, changes: &Set) {
    let is_first = |(place, _): &&(usize, u64)| *place == usize::from(rows::SENSE_ROW);
    for (place, seed) in changes.iter().filter(is_first).chain(changes.iter().filter(|change| !is_first(change))) {
        let row = &ROWS[*place];
        assert_eq!(row.change(parameters, pick(row, *seed)), Ok(()), "{} {:?}", row.key, pick(row, *seed));
    }
}

fn real(parameters: &AxisParameters, key: &str) -> f64 {
    match row(key).value(parameters) {
        Value::Real(value) => value,
        other => panic!("{key} is {other:?}"),
    }
}

fn int(parameters: &AxisParameters, key: &str) -> i64 {
    match row(key).value(parameters) {
        Value::Int(value) => value,
        other => panic!("{key} is {other:?}"),
    }
}

/// Returns true if the whole number is the nearest one, apart from rounding of the last bits.
fn is_nearest(whole: i64, exact: f64) -> bool {
    (whole as f64 - exact).abs() <= 0.5 + exact.abs() * 1e-9 || exact > i64::MAX as f64 && whole == i64::MAX
}

/// Compares the views with the formulas of the specification (sections 7 to 9 and 1.1).
fn agree(p: &AxisParameters) -> Result<(), TestCaseError> {
    let encoder = int(p, "encoder") as f64;
    // MACS-PROF-02: RPM at the encoder, 4 increments per line, or 1 for an absolute encoder.
    let is_absolute = (1..=4).contains(&int(p, "encodertype")) || int(p, "wf.md4") == 1;
    let velmax = p.max_velocity * 60.0 / (if is_absolute { 1.0 } else { 4.0 } * encoder);
    prop_assert!((real(p, "velmax") - velmax).abs() <= velmax * 1e-12, "VELMAX {} {velmax}", real(p, "velmax"));
    // MACS-PROF-03: RAMPMIN = VELMAX / maximum acceleration; MACS-PROF-10: JERKMIN = maximum acceleration / maximum
    // jerk.
    prop_assert!(is_nearest(int(p, "rampmin"), p.max_velocity / p.max_acceleration * 1e9));
    match p.max_jerk {
        Some(jerk) => prop_assert!(is_nearest(int(p, "jerkmin"), p.max_acceleration / jerk * 1e9)),
        None => prop_assert_eq!(int(p, "jerkmin"), 0),
    }
    // MACS-PROF-04, MACS-PROF-06; the default is half.
    let velres = int(p, "velres") as f64;
    let velocity = p.default_velocity.unwrap_or(p.max_velocity / 2.0);
    let acceleration = p.default_acceleration.unwrap_or(p.max_acceleration / 2.0);
    prop_assert!(is_nearest(int(p, "dfltvel"), velocity / p.max_velocity * velres));
    prop_assert!(is_nearest(int(p, "dfltacc"), acceleration / p.max_acceleration * velres));
    // MACS-PROF-02, MACS-PROF-03, MACS-STO-08: truncated, never out of date.
    prop_assert_eq!(int(p, "velmaxqc"), (p.max_velocity / 1000.0 * 65536.0).trunc() as i64);
    prop_assert_eq!(int(p, "accmaxqc"), (p.max_acceleration / 1e6 * 65536.0).trunc() as i64);
    // MACS-LIM-02; A-56: for either sign of POSDRCT.
    let (falling, rising) = if int(p, "posdrct") < 0 {
        (p.max_position.map(|high| -high), p.min_position.map(|low| -low))
    } else {
        (p.min_position, p.max_position)
    };
    for (limit, switch, native) in [("neglimit", "swneglimact", falling), ("poslimit", "swposlimact", rising)] {
        prop_assert_eq!(int(p, switch), i64::from(native.is_some()));
        prop_assert!(native.is_none_or(|native| native == int(p, limit)));
    }
    for (view, native) in [
        ("testwin", p.in_position_window),
        ("testtim", p.in_position_time),
        ("poserr", p.max_following_error),
        ("poserrtime", p.following_error_time),
        ("errcond", p.error_reaction),
        ("ramptype", p.profile),
    ] {
        prop_assert_eq!(int(p, view), native, "{}", view);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if std::env::var_os("LINESHAFT_LONG").is_some() { 200_000 } else { 2_000 }))]

    /// Proves: MACS-STO-08, MACS-PROF-02, MACS-PROF-03, MACS-PROF-04, MACS-UNIT-06, MACS-LIM-02
    #[test]
    fn views_agree_after_any_sets_and_no_order_matters(
        (first, second, shuffled) in (a_set(), a_set())
            .prop_flat_map(|(first, second)| (Just(first), Just(second.clone()), Just(second).prop_shuffle()))
    ) {
        let mut before = parameters();
        apply(&mut before, &first);
        agree(&before)?;
        let (mut one, mut other) = (before, before);
        apply(&mut one, &second);
        apply(&mut other, &shuffled);
        prop_assert_eq!(one, other);
        agree(&one)?;
        // Set values read back.
        for (place, seed) in &second {
            let row = &ROWS[*place];
            prop_assert_eq!(row.value(&one), pick(row, *seed), "{}", row.key);
        }
        // Written by the rows that give the values, and read in any order, they are the same.
        let given = || ROWS.iter().filter(|row| one.is_given_by(row));
        let (mut forth, mut back) = (parameters(), parameters());
        for row in given() {
            prop_assert_eq!(row.assign(&mut forth, row.value(&one)), Ok(()), "{} {:?}", row.key, row.value(&one));
        }
        let others = given().filter(|row| row.key != "posdrct").collect::<Vec<_>>().into_iter().rev();
        for row in given().filter(|row| row.key == "posdrct").chain(others) {
            prop_assert_eq!(row.assign(&mut back, row.value(&one)), Ok(()));
        }
        prop_assert_eq!(forth, one);
        prop_assert_eq!(back, one);
        // Exactly the consistent parameters are valid.
        prop_assert_eq!(one.is_sound(), one.check().is_ok());
    }
}

/// Proves: MACS-O-08, MACS-PROF-02, MACS-STO-08
#[test]
fn velmaxqc_of_the_defaults_is_that_of_the_manual() {
    let mut p = parameters();
    set(&mut p, "velmax", Value::Real(1000.0));
    set(&mut p, "rampmin", Value::Int(1_000_000_000));
    assert_eq!((int(&p, "encoder"), int(&p, "velmaxqc")), (500, 2_184_533));
    assert!((p.max_velocity / 1000.0 - 33.333_333_333_333).abs() < 1e-9);
    // 2184533.33 / 1000 ms
    assert_eq!(int(&p, "accmaxqc"), 2184);
    // It follows each of its sources, and cannot be set itself.
    set(&mut p, "encoder", Value::Int(1000));
    assert_eq!(int(&p, "velmaxqc"), 4_369_066);
    set(&mut p, "max_velocity", Value::Real(1000.0));
    assert_eq!(int(&p, "velmaxqc"), 65_536);
    assert_eq!(row("velmaxqc").change(&mut p, Value::Int(5)), Err(Refused::ReadOnly));
}

/// Values of an absolute encoder are used 1:1: ENCODER 4096 at 1000 rpm is 1000 * 4096 / 60 inc/s, or 4096000 / 60000 *
/// 65536 in VELMAXQC. It follows the source, in whatever order both are given.
///
/// Proves: MACS-ENC-01, MACS-PROF-02
#[test]
fn an_absolute_encoder_drops_the_factor_4() {
    const INCREMENTAL: i64 = 17_895_697;
    const ABSOLUTE: i64 = 4_473_924;
    let given = [("encoder", Value::Int(4096)), ("velmax", Value::Real(1000.0))];
    let mut p = parameters();
    given.iter().for_each(|(key, value)| set(&mut p, key, *value));
    for (kind, velmaxqc, revolution) in [
        (0, INCREMENTAL, 16_384),
        (1, ABSOLUTE, 4096),
        (2, ABSOLUTE, 4096),
        (3, ABSOLUTE, 4096),
        (4, ABSOLUTE, 4096),
        (5, INCREMENTAL, 16_384),
        (9, INCREMENTAL, 16_384),
        (10, INCREMENTAL, 16_384),
        // A CANopen encoder is absolute, a drive on the bus incremental (MACS-ENC-07).
        (50_012, ABSOLUTE, 4096),
        (-150_012, ABSOLUTE, 4096),
        (1_005, INCREMENTAL, 16_384),
    ] {
        set(&mut p, "encodertype", Value::Int(kind));
        assert_eq!((int(&p, "velmaxqc"), p.homing_index_distance()), (velmaxqc, revolution), "encodertype {kind}");
        assert_eq!(real(&p, "velmax"), 1000.0, "encodertype {kind}");
        let mut late = parameters();
        set(&mut late, "encodertype", Value::Int(kind));
        given.iter().rev().for_each(|(key, value)| set(&mut late, key, *value));
        assert_eq!(late, p, "encodertype {kind}");
    }
    // Gray words of a positioning module are absolute, too.
    set(&mut p, "encodertype", Value::Int(0));
    set(&mut p, "wf.md4", Value::Int(1));
    assert_eq!(int(&p, "velmaxqc"), ABSOLUTE);
    // A velocity in increments does not change; its value in rpm follows.
    set(&mut p, "max_velocity", Value::Real(68_266.0));
    assert_eq!(real(&p, "velmax"), 68_266.0 * 60.0 / 4096.0);
    set(&mut p, "wf.md4", Value::Int(0));
    assert_eq!((p.max_velocity, real(&p, "velmax")), (68_266.0, 68_266.0 * 60.0 / 16_384.0));
}

/// Proves: MACS-O-10, MACS-PROF-10
#[test]
fn jerk_values_are_those_of_the_manual() {
    let mut p = parameters();
    for (key, value) in
        [("jerkmin", Value::Int(200_000_000)), ("rampmin", Value::Int(500_000_000)), ("velmax", Value::Real(3000.0))]
    {
        set(&mut p, key, value);
    }
    // 100 qc/ms, 0.2 qc/ms^2, 0.001 qc/ms^3.
    assert_eq!((p.max_velocity, p.max_acceleration, p.max_jerk), (100e3, 0.2e6, Some(0.001e9)));
    // A ramp that is given as a time stays a time.
    set(&mut p, "velmax", Value::Real(1500.0));
    assert_eq!((p.max_acceleration, p.max_jerk), (0.1e6, Some(0.0005e9)));
    // An acceleration that is given directly stays constant.
    set(&mut p, "max_acceleration", Value::Real(0.3e6));
    set(&mut p, "velmax", Value::Real(3000.0));
    assert_eq!((p.max_acceleration, int(&p, "rampmin")), (0.3e6, 333_333_333));
}

/// Proves: MACS-PROF-05
#[test]
fn the_period_of_the_profile_is_kept_from_1_to_5_ms() {
    let mut p = parameters();
    for (value, result) in [(0, Err(Refused::OutOfRange)), (1, Ok(())), (5, Ok(())), (6, Err(Refused::OutOfRange))] {
        assert_eq!(row("proftime").change(&mut p, Value::Int(value)), result, "{value}");
    }
    assert_eq!(int(&p, "proftime"), 5);
    // No other value depends on it.
    assert_eq!(AxisParameters { macs: Macs { proftime: 1, ..p.macs }, ..p }, parameters());
}

#[test]
fn contradictory_set_is_reported() {
    let check = |changes: &[(&str, Value)]| {
        let mut p = parameters();
        changes.iter().for_each(|(key, value)| set(&mut p, key, *value));
        p.check()
    };
    let above = |low, high| Err(Contradiction::Above(low, high));
    // MACS: DFLTVEL 1 to VELRES.
    assert_eq!(check(&[("dfltvel", Value::Int(101))]), above("dfltvel", "velres"));
    assert_eq!(check(&[("dfltvel", Value::Int(101)), ("velres", Value::Int(1000))]), Ok(()));
    assert_eq!(check(&[("velres", Value::Int(40)), ("dfltacc", Value::Int(41))]), above("dfltacc", "velres"));
    assert_eq!(check(&[("dfltvel", Value::Int(100)), ("dfltacc", Value::Int(100))]), Ok(()));
    // A derived value leaves its range: 1e15 inc/s in 1 ms are 1e18 inc/s^2.
    let fast = [("max_velocity", Value::Real(1e15)), ("rampmin", Value::Int(1_000_000))];
    assert_eq!(check(&fast), Err(Contradiction::OutOfRange("max_acceleration")));
    let hard = [("max_acceleration", Value::Real(1e15)), ("jerkmin", Value::Int(1_000_000))];
    assert_eq!(check(&hard), Err(Contradiction::OutOfRange("max_jerk")));
    // MACS-LIM-02: limits that are off have no effect.
    let limits = [("neglimit", Value::Int(10)), ("poslimit", Value::Int(10))];
    let on = |key| (key, Value::Int(1));
    assert_eq!(check(&limits), Ok(()));
    assert_eq!(check(&[limits[0], limits[1], on("swneglimact")]), Ok(()));
    assert_eq!(check(&[limits[0], limits[1], on("swposlimact")]), Ok(()));
    let both = [on("swposlimact"), limits[0], on("swneglimact"), limits[1]];
    assert_eq!(check(&both), above("min_position", "max_position"));
}

/// POSLIMIT limits increasing counts, which are decreasing positions in inverted units, in any order of a set.
///
/// Proves: MACS-LIM-01
#[test]
fn limits_keep_physical_places_in_both_directions() {
    let mut p = parameters();
    for (key, value) in [("posdrct", -1), ("poslimit", 500_000), ("swposlimact", 1)] {
        set(&mut p, key, Value::Int(value));
    }
    assert_eq!((p.min_position, p.max_position), (Some(-500_000), None));
    assert_eq!((int(&p, "poslimit"), int(&p, "swposlimact"), int(&p, "swneglimact")), (500_000, 1, 0));
    set(&mut p, "posdrct", Value::Int(1));
    assert_eq!((p.min_position, p.max_position), (None, Some(500_000)));
    set(&mut p, "min_position", Value::Int(-7));
    set(&mut p, "posdrct", Value::Int(-11));
    assert_eq!((p.min_position, p.max_position), (Some(-500_000), Some(7)));
    assert_eq!((int(&p, "neglimit"), int(&p, "poslimit")), (-7, 500_000));
    set(&mut p, "swneglimact", Value::Int(0));
    assert_eq!((p.min_position, p.max_position, int(&p, "neglimit")), (Some(-500_000), None, -7));
    assert!(p.is_sound());
}

/// MACS keeps a limit that is off. A limit beyond the range of MACS becomes the nearest number.
#[test]
fn a_switched_off_limit_can_be_written_again() {
    let mut p = parameters();
    set(&mut p, "min_position", Value::Int(-(1 << 60)));
    // The limit is active already.
    set(&mut p, "swneglimact", Value::Int(1));
    assert_eq!(p.min_position, Some(-(1 << 60)));
    set(&mut p, "min_position", Value::Unset);
    assert_eq!(int(&p, "neglimit"), -MLONG);
    set(&mut p, "max_position", Value::Int(7));
    set(&mut p, "swposlimact", Value::Int(0));
    assert_eq!((int(&p, "poslimit"), p.max_position), (7, None));
    set(&mut p, "swposlimact", Value::Int(1));
    assert_eq!(p.max_position, Some(7));
}

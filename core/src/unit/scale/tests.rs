use super::*;
use proptest::prelude::*;

fn quantity(text: &str, dimension: Dimension) -> Quantity {
    Quantity::parse(text, &[dimension]).unwrap()
}

fn length(text: &str) -> Quantity {
    quantity(text, Dimension::Length(0))
}

fn angle(text: &str) -> Quantity {
    quantity(text, Dimension::Angle(0))
}

/// Axis x of the example cell of the contract: 1048576 inc per 10 mm.
fn x() -> Scale {
    Scale::new(Fraction::from(1_048_576), length("10 mm")).unwrap().with_unit(Unit::MILLIMETRE).unwrap()
}

/// Its turret: 36000 inc per turn.
fn turret() -> Scale {
    Scale::new(Fraction::from(36_000), angle("360 deg")).unwrap().with_unit(Unit::DEGREE).unwrap()
}

#[test]
fn positions_of_the_example_cell() {
    assert_eq!(x().position(&length("900 mm")), Ok(94_371_840));
    assert_eq!(x().position(&length("-50 mm")), Ok(-5_242_880));
    assert_eq!(x().position(&quantity("77 inc", Dimension::Increments(0))), Ok(77));
    assert_eq!(turret().position(&angle("-1.5 rev")), Ok(-54_000));
    assert_eq!(turret().position(&angle("3.141592653589793 rad")), Ok(18_000));
}

/// 1000 inc/mm in tenths of a millimetre, and 36000 inc/rev in tenths of a degree: 10 inc.
#[test]
fn an_axis_unit_may_be_a_share_of_a_unit() {
    let tenth = |one: Quantity| AxisUnit::new(one).unwrap();
    let x = Scale::new(Fraction::from(1000), length("1 mm")).unwrap().with_unit(tenth(length("0.1 mm"))).unwrap();
    assert_eq!(x.unit().to_string(), "0.1 mm");
    assert_eq!((x.position_from_unit(9000.0), x.position_from_unit(-0.5)), (Ok(900_000), Ok(-50)));
    assert_eq!((x.rate_from_unit(500.0, 1), x.rate_from_unit(7.0, 3)), (Ok(50_000.0), Ok(700.0)));
    assert_eq!((x.position_to_unit(900_000, 0.0), x.position_to_unit(-50, 0.5)), (9000.0, -0.495));
    assert_eq!((x.rate_to_unit(50_000.0), x.position_to_si(900_000, 0.0)), (500.0, 0.9));
    assert_eq!((&*x.format_increments(900_000), &*x.format_increments(-50)), ("9000 * 0.1 mm", "-0.5 * 0.1 mm"));
    assert_eq!(x.format_rate(50_000.0, 2), "500 * 0.1 mm/s^2");
    // A value with its own unit does not change.
    assert_eq!(x.position(&length("900 mm")), Ok(900_000));
    let turret = turret().with_unit(tenth(angle("0.1 deg"))).unwrap();
    assert_eq!((turret.position_from_unit(3600.0), turret.position_to_unit(-10, 0.0)), (Ok(36_000), -1.0));
    let radians = turret.with_unit(tenth(angle("0.5 rad"))).unwrap();
    assert!((radians.position_to_unit(36_000, 0.0) - 4.0 * std::f64::consts::PI).abs() < 1e-12);
    assert!(x.with_unit(tenth(angle("0.1 deg"))).is_err());
    for none in ["0 mm", "-0.1 mm"] {
        assert!(matches!(AxisUnit::new(length(none)), Err(UnitError::NotPositive { .. })), "{none}");
    }
    // A multiple of one is the unit itself.
    assert_eq!(x.with_unit(tenth(length("1 mm"))).unwrap().format_increments(5000), "5 mm");
}

#[test]
fn rates_are_the_exact_fraction_rounded_once() {
    assert_eq!(x().rate(&quantity("1.2 m/s", Dimension::Length(1)), 1), Ok(125_829_120.0));
    assert_eq!(x().rate(&quantity("72 m/min", Dimension::Length(1)), 1), Ok(125_829_120.0));
    assert_eq!(x().rate(&quantity("200 m/s^3", Dimension::Length(3)), 3), Ok(20_971_520_000.0));
    assert_eq!(turret().rate(&quantity("10 rpm", Dimension::Angle(1)), 1), Ok(6000.0));
    assert_eq!(turret().rate(&quantity("5 inc/s^2", Dimension::Increments(2)), 2), Ok(5.0));
    let third = Scale::new(Fraction::from(1), length("3 m")).unwrap();
    assert_eq!(third.rate(&quantity("1 m/s", Dimension::Length(1)), 1), Ok(1.0 / 3.0));
}

#[test]
fn a_rate_that_no_machine_can_have_is_refused() {
    let least = |text: &str| turret().rate(&quantity(text, Dimension::Increments(2)), 2);
    assert_eq!((least("1e-22 inc/s^2"), least("-1e-22 inc/s^2"), least("0 inc/s^2")), (Ok(1e-22), Ok(-1e-22), Ok(0.0)));
    for text in ["9.99e-23 inc/s^2", "-1e-30 inc/s^2"] {
        assert!(matches!(least(text), Err(UnitError::RateTooLow { .. })), "{text}");
    }
    let third = Scale::new(Fraction::from(1), length("3 m")).unwrap();
    assert_eq!(
        third.rate_from_si(-3e-23, 1).unwrap_err().to_string(),
        "`-3e-23 m/s` is -1e-23 inc/s; 0, or 1e-22 inc/s and more, is allowed"
    );
}

#[test]
fn a_derivative_of_the_wrong_order_or_kind_is_refused() {
    let sentence = |result: Result<f64, UnitError>| result.unwrap_err().to_string();
    assert_eq!(
        sentence(x().rate(&quantity("8 m/s", Dimension::Length(1)), 2)),
        "`8 m/s` is a velocity; an acceleration such as `8 m/s^2` is expected"
    );
    assert_eq!(
        x().position(&angle("90 deg")).unwrap_err().to_string(),
        "`90 deg` is an angle; a length such as `90 mm` is expected"
    );
    // The example is in the unit of the axis.
    let of = |unit: Unit| turret().with_unit(unit).unwrap().rate(&quantity("5 mm/s", Dimension::Length(1)), 1);
    for (unit, example) in [(Unit::DEGREE, "5 deg/s"), (Unit::REVOLUTION, "5 rev/s"), (Unit::INCREMENT, "5 deg/s")] {
        assert_eq!(
            sentence(of(unit)),
            format!("`5 mm/s` is a velocity; an angular velocity such as `{example}` is expected")
        );
    }
    assert!(turret().position(&quantity("90 deg/s", Dimension::Angle(1))).is_err());
    assert!(x().exact(&quantity("1 s", Dimension::Time)).is_err());
}

/// Proves: MACS-UNIT-05
#[test]
fn halves_round_away_from_zero() {
    let scale = Scale::new(Fraction::from(1), length("1 mm")).unwrap();
    for (text, increments) in [
        ("0.5 mm", 1),
        ("-0.5 mm", -1),
        ("1.5 mm", 2),
        ("-2.5 mm", -3),
        ("0.499999999999999999999 mm", 0),
        ("2499 um", 2),
    ] {
        assert_eq!(scale.position(&length(text)), Ok(increments), "{text}");
    }
}

#[test]
fn same_number_gives_same_increment_in_each_interface() {
    // 0.12 is below 12/100 as a binary fraction: used literally, the half would be rounded down.
    let scale = Scale::new(Fraction::from(125), length("30 m")).unwrap();
    assert_eq!(scale.position(&length("0.12 m")), Ok(1));
    assert_eq!(scale.position_from_si(0.12), Ok(1));
    assert_eq!(scale.with_unit(Unit::MILLIMETRE).unwrap().position_from_unit(120.0), Ok(1));
}

#[test]
fn positions_stay_below_two_to_the_62() {
    let scale = Scale::new(Fraction::from(1), length("1 m")).unwrap();
    assert_eq!(scale.position(&length("4611686018427387903 m")), Ok(4_611_686_018_427_387_903));
    assert_eq!(scale.position(&length("-4611686018427387903 m")), Ok(-4_611_686_018_427_387_903));
    for text in ["4611686018427387904 m", "4611686018427387903.5 m", "-4611686018427387904 m"] {
        assert!(matches!(scale.position(&length(text)), Err(UnitError::OutOfRange { .. })), "{text}");
    }
    assert_eq!(
        x().position_from_unit(1e14).unwrap_err().to_string(),
        "`100000000000000 mm` is 10485760000000000000 increments; \
         a position stays below 2^62 = 4611686018427387904 increments"
    );
    assert_eq!(
        x().position(&length("1e38 m")).unwrap_err().to_string(),
        "`1e38 m` is more than 2^127 increments; \
         a position stays below 2^62 = 4611686018427387904 increments"
    );
    assert!(matches!(x().position_from_si(f64::NAN), Err(UnitError::NotFinite { .. })));
    assert!(matches!(x().rate_from_si(f64::INFINITY, 1), Err(UnitError::NotFinite { .. })));
}

/// The end of a range, written in a file, reads back as itself, or as the next value on the permitted side.
#[test]
fn the_end_of_a_range_reads_as_a_permitted_rate() {
    let third = Scale::new(Fraction::from(1000), length("3 mm")).unwrap().with_unit(Unit::MILLIMETRE).unwrap();
    let radian = turret().with_unit(Unit::RADIAN).unwrap();
    for scale in [x(), turret(), third, radian] {
        for rate in [2_147_483_648_000.0, 1e15, 1e9, 7.0, 0.1] {
            for (is_high, rate) in [(true, rate), (false, -rate)] {
                let text = scale.format_bound(rate, 1, is_high);
                let read = scale.rate(&Quantity::parse(&text, &scale.dimensions(1)).unwrap(), 1).unwrap();
                assert!(if is_high { read <= rate } else { read >= rate }, "{text} is {read}, beyond {rate}");
                assert!((read / rate - 1.0).abs() < 1e-8, "{text} is {read}, far from {rate}");
            }
        }
    }
}

/// The error of a number that no exact fraction holds may be its size.
#[test]
fn rate_beyond_all_limits_is_too_high_not_inexact() {
    let fast = quantity("1e37 m/s", Dimension::Length(1));
    let error = x().rate(&fast, 1).unwrap_err().to_string();
    assert!(error.starts_with("`1e37 m/s` is 1.0"), "{error}");
    assert!(error.ends_with("e45 inc/s; less than 1e30 inc/s is allowed"), "{error}");
    let inexact = quantity("0.1234567890123456789012345678901234567 m/s", Dimension::Length(1));
    let small = Scale::new(Fraction::from(1), length("123456789 m")).unwrap();
    assert!(matches!(small.rate(&inexact, 1), Err(UnitError::Inexact { .. })));
}

#[test]
fn a_small_number_with_too_many_digits_is_inexact_not_out_of_range() {
    let scale = Scale::new(Fraction::from(1), length("123456789 m")).unwrap();
    let error = scale.position(&length("0.1234567890123456789012345678901234567 m")).unwrap_err();
    assert!(matches!(error, UnitError::Inexact { .. }), "{error}");
}

#[test]
fn a_scale_is_positive_and_per_length_or_angle() {
    let sentence = |increments, per| Scale::new(increments, per).unwrap_err().to_string();
    let one = Fraction::from(1);
    assert_eq!(sentence(Fraction::from(0), length("1 m")), "increments of the scale is 0; a value above 0 is allowed");
    assert_eq!(sentence(one, length("-2 mm")), "per of the scale is -2; a value above 0 is allowed");
    assert_eq!(
        sentence(one, quantity("3 inc", Dimension::Increments(0))),
        "`3 inc` is a number of increments; a length such as `3 mm` is expected"
    );
    assert!(Scale::new(one, length("1e38 m")).is_ok());
    assert!(matches!(Scale::new(Fraction::new(1, 10_i128.pow(30)), length("1e38 m")), Err(UnitError::Inexact { .. })));
    assert!(x().with_unit(Unit::DEGREE).is_err());
    assert!(turret().with_unit(Unit::SECOND).is_err());
}

#[test]
fn a_modulo_need_not_be_whole() {
    let scale = Scale::new(Fraction::from(1000), angle("7 rev")).unwrap();
    assert_eq!(scale.exact(&angle("360 deg")), Ok(Fraction::new(1000, 7)));
}

/// A MACS axis whose user unit is a tenth of a millimetre.
///
/// Proves: MACS-UNIT-02
#[test]
fn macs_factors_make_a_scale() {
    let factors = MacsFactors { posfact_z: 50375, posfact_n: 1000, ..MacsFactors::default() };
    let scale = Scale::from_macs(&factors, length("0.1 mm")).unwrap();
    assert_eq!(scale.position(&length("0.8 mm")), Ok(403));
    assert!(Scale::from_macs(&MacsFactors { posfact_n: 0, ..factors }, length("1 mm")).is_err());
}

#[test]
fn messages_speak_the_axis_unit() {
    assert_eq!(x().format_increments(94_371_840), "900 mm");
    assert_eq!(x().format_increments(-1), "-0.00000954 mm");
    assert_eq!(x().format_rate(52_428_800.0, 1), "500 mm/s");
    assert_eq!(x().with_unit(Unit::METRE).unwrap().format_rate(52_428_800.0, 1), "0.5 m/s");
    assert_eq!(x().with_unit(Unit::INCREMENT).unwrap().format_increments(17), "17 inc");
    assert_eq!(turret().format_increments(100), "1 deg");
    assert_eq!(turret().format_rate(9000.0, 2), "90 deg/s^2");
    assert_eq!(turret().with_unit(Unit::RADIAN).unwrap().format_increments(18_000), "3.1416 rad");
    assert_eq!(Scale::new(Fraction::from(3), length("1 m")).unwrap().format_increments(1), "0.333 m");
    assert_eq!(x().format_rate(f64::NAN, 1), "NaN mm/s");
}

/// 11 mm are 1153433.6 inc, 10 um 1048.576 inc: rounded, they are 11.0000038 mm and 0.0100040436 mm.
#[test]
fn position_is_shown_as_it_was_given() {
    for given in ["11 mm", "0.01 mm", "-54.3 mm", "33.3337 mm", "850 mm"] {
        let increments = x().position(&length(given)).unwrap();
        assert_eq!(x().format_increments(increments), given);
    }
    assert_eq!(x().format_with_increments(1_153_434), "11 mm (1153434 inc)");
    assert_eq!(x().format_with_increments(1049), "0.01 mm (1049 inc)");
    assert_eq!(x().format_with_increments(94_371_840), "900 mm");
    assert_eq!(x().format_with_increments(0), "0 mm");
    // A belt of 131072 inc in 20 mm: 328 inc are 0.050048828125 mm, and 50 um are 327.68 inc.
    let belt = Scale::new(Fraction::from(131_072), length("20 mm")).unwrap().with_unit(Unit::MILLIMETRE).unwrap();
    assert_eq!(belt.format_with_increments(328), "0.05 mm (328 inc)");
    // A few digits are exact.
    let eighth = Scale::new(Fraction::from(8), length("1 mm")).unwrap().with_unit(Unit::MILLIMETRE).unwrap();
    assert_eq!(eighth.format_with_increments(9), "1.125 mm");
    let turn = turret().with_unit(Unit::RADIAN).unwrap();
    assert_eq!(
        (&*turn.format_with_increments(8594), &*turn.format_with_increments(0)),
        ("1.5 rad (8594 inc)", "0 rad")
    );
    let largest = (1 << 62) - 1;
    assert_eq!(x().with_unit(Unit::INCREMENT).unwrap().format_with_increments(largest), format!("{largest} inc"));
}

/// For any scale the shown position reads back as its increments.
#[test]
fn shown_position_reads_as_its_increments() {
    for (increments, per) in [(1_048_576, "10 mm"), (131_072, "20 mm"), (3, "1 m"), (7, "3 mm"), (1, "1 um")] {
        let scale = Scale::new(Fraction::from(increments), length(per)).unwrap().with_unit(Unit::MILLIMETRE).unwrap();
        for value in (-3000..3000).map(|step| step * 977 + 1).chain([1_000_000_007, -123_456_789_012]) {
            let text = scale.format_increments(value);
            assert_eq!(scale.position(&length(&text)), Ok(value), "{increments} inc per {per}: {text}");
        }
    }
}

#[test]
fn si_and_axis_unit_as_f64() {
    assert_eq!(x().position_to_si(94_371_840, 0.0), 0.9);
    assert_eq!(x().position_to_unit(94_371_840, 0.0), 900.0);
    assert_eq!(x().position_to_unit(0, 0.5), 5.0 / 1_048_576.0);
    assert_eq!(x().rate_to_si(104_857_600.0), 1.0);
    assert_eq!(x().rate_from_unit(1000.0, 1), Ok(104_857_600.0));
    assert_eq!(turret().position_to_si(36_000, 0.0), TAU);
    assert_eq!(turret().rate_to_unit(100.0), 1.0);
    assert_eq!(turret().rate_from_si(TAU, 1), Ok(36_000.0));
}

fn any_scale() -> impl Strategy<Value = Scale> {
    (1_i128..1 << 40, 1_i128..1 << 20, any::<bool>()).prop_map(|(increments, thousandths, rotary)| {
        let unit = if rotary { Unit::DEGREE } else { Unit::MILLIMETRE };
        Scale::new(Fraction::from(increments), Quantity::new(Fraction::new(thousandths, 1000), unit))
            .unwrap()
            .with_unit(unit)
            .unwrap()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn increments_to_an_exact_unit_and_back_is_identity(scale in any_scale(), increments in -(1_i64 << 61)..1 << 61) {
        let value = Fraction::from(i128::from(increments)) / scale.exact_per(scale.unit()).unwrap();
        prop_assert_eq!(scale.position(&Quantity::new(value, scale.unit().unit())), Ok(increments));
    }

    /// An f64 has 53 bits: 2^48 inc leave room for the intermediate roundings, also those of pi.
    #[test]
    fn increments_to_f64_and_back_is_identity(scale in any_scale(), increments in -(1_i64 << 48)..1 << 48) {
        prop_assert_eq!(scale.position_from_si(scale.position_to_si(increments, 0.0)), Ok(increments));
        prop_assert_eq!(scale.position_from_unit(scale.position_to_unit(increments, 0.0)), Ok(increments));
    }

    #[test]
    fn halves_by_construction(scale in any_scale(), increments in 0_i64..1 << 60) {
        let half = Fraction::new(2 * i128::from(increments) + 1, 2) / scale.exact_per(scale.unit()).unwrap();
        prop_assert_eq!(scale.position(&Quantity::new(half, scale.unit().unit())), Ok(increments + 1));
        prop_assert_eq!(scale.position(&Quantity::new(-half, scale.unit().unit())), Ok(-increments - 1));
    }

    #[test]
    fn monotone(scale in any_scale(), a in -1e3_f64..1e3, b in -1e3_f64..1e3) {
        let (low, high) = if a <= b { (a, b) } else { (b, a) };
        prop_assert!(scale.position_from_unit(low).unwrap() <= scale.position_from_unit(high).unwrap());
        prop_assert!(scale.rate_from_unit(low, 1).unwrap() <= scale.rate_from_unit(high, 1).unwrap());
    }
}

//! A plain number may be written with the unit of its row.

use super::super::*;
use crate::unit::{Dimension, Quantity, Scale, Unit, UnitError};

fn quantity(text: &str) -> ParameterInput {
    let all = [
        Dimension::Length(0),
        Dimension::Angle(1),
        Dimension::Increments(0),
        Dimension::Time,
        Dimension::Ratio,
        Dimension::Frequency,
    ];
    ParameterInput::Quantity(Quantity::parse(text, &all).unwrap_or_else(|error| panic!("{text}: {error}")))
}

fn converted(key: &str, text: &str) -> Result<Value, ConvertError> {
    let row = Row::find(key).map(|(_, row)| row).unwrap_or_else(|| panic!("{key}"));
    convert(row, &Scale::increments(), &quantity(text))
}

/// Proves: MACS-UNIT-03
#[test]
fn a_number_takes_its_own_unit_and_others_of_its_kind() {
    for (key, text, value) in [
        ("velmax", "3000 rpm", Value::Real(3000.0)),
        ("velmax", "50 rev/s", Value::Real(3000.0)),
        ("velmax", "1000.5 rpm", Value::Real(1000.5)),
        ("poserr", "500 inc", Value::Int(500)),
        ("neglimit", "-7 inc", Value::Int(-7)),
        ("proftime", "1 ms", Value::Int(1)),
        ("proftime", "2000 us", Value::Int(2)),
        ("syncvelrel", "50 %", Value::Int(50)),
        ("velocity_override", "12.5 %", Value::Real(12.5)),
        ("wf.fixed_speed_1", "10 %", Value::Real(10.0)),
        ("amppwmfreq", "24 kHz", Value::Int(24_000)),
        // A time has always had a unit.
        ("rampmin", "500 ms", Value::Int(500_000_000)),
    ] {
        assert_eq!(converted(key, text), Ok(value), "{key}: {text}");
    }
}

/// Results of calculations with doubles, such as 0.1 + 0.2, are rarely a whole number of nanoseconds.
#[test]
fn a_time_without_a_unit_goes_to_the_nearest_nanosecond() {
    let of = |key, number| {
        let (_, row) = Row::find(key).expect("a row");
        convert(row, &Scale::increments(), &ParameterInput::Number(number))
    };
    for (number, nanoseconds) in
        [(0.1 + 0.2, 300_000_000), (0.0015, 1_500_000), (1.0 / 3.0, 333_333_333), (-1e-9, -1), (0.4e-9, 0)]
    {
        assert_eq!(of("following_error_time", number), Ok(Value::Int(nanoseconds)), "{number}");
        // In ms.
        assert_eq!(of("rampmin", number * 1000.0), Ok(Value::Int(nanoseconds)), "{number}");
    }
    for number in [f64::NAN, f64::INFINITY, 1e300] {
        assert!(of("following_error_time", number).is_err(), "{number}");
    }
}

#[test]
fn another_unit_or_a_part_of_a_whole_number_is_refused() {
    for (key, text) in [("velmax", "3000 mm"), ("poserr", "5 mm"), ("proftime", "1 inc"), ("syncvelrel", "5 Hz")] {
        let error = converted(key, text);
        assert!(matches!(error, Err(ConvertError::Unit(UnitError::WrongDimension { .. }))), "{key}: {error:?}");
    }
    assert_eq!(converted("proftime", "1500 us"), Err(ConvertError::Type("1500 us".to_owned())));
    assert_eq!(converted("poserr", "0.5 inc"), Err(ConvertError::Type("0.5 inc".to_owned())));
    // Rows without a unit, or with one that files do not support.
    for key in ["velres", "dfltvel", "bandwidth", "kprop", "error_reaction", "saia.destp"] {
        assert_eq!(converted(key, "5 inc"), Err(ConvertError::Type("5 inc".to_owned())), "{key}");
    }
}

#[test]
fn what_is_expected_names_the_unit() {
    let expected = |key| Row::find(key).map(|(_, row)| row.expected());
    assert_eq!(expected("poserr").as_deref(), Some("a whole number in inc"));
    assert_eq!(expected("velmax").as_deref(), Some("a number in rpm"));
    assert_eq!(expected("velres").as_deref(), Some("a whole number"));
}

/// Each plain number with a unit that files support accepts it, and reads back in it.
#[test]
fn one_of_its_unit_is_one() {
    let mut count = 0;
    for row in ROWS {
        let Some(unit) = row.own_unit() else { continue };
        let one = Quantity::new(crate::unit::Fraction::from_integer(1), unit);
        let value = convert(row, &Scale::increments(), &ParameterInput::Quantity(one));
        let expected = if row.measure == Measure::Number { Value::Real(1.0) } else { Value::Int(1) };
        assert_eq!(value, Ok(expected), "{}", row.key);
        count += 1;
    }
    assert!(count > 25, "{count}");
    assert_eq!(Row::find("poserr").and_then(|(_, row)| row.own_unit()), Some(Unit::INCREMENT));
}

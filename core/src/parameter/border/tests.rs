//! The shown value of each row converts back.

use super::*;
use crate::parameter::ROWS;
use crate::unit::{Fraction, Quantity, Unit};

/// Spindle, turntable, axis of MACS factors, increments of a thirteenth, without units.
fn scales() -> [Scale; 5] {
    let scale = |increments: i64, per: i64, unit: Unit| {
        let quantity = Quantity::new(Fraction::from(i128::from(per)), unit);
        Scale::new(Fraction::from(i128::from(increments)), quantity).unwrap()
    };
    [
        scale(1_048_576, 10, Unit::MILLIMETRE).with_unit(Unit::MILLIMETRE).unwrap(),
        scale(36_000, 360, Unit::DEGREE).with_unit(Unit::DEGREE).unwrap(),
        scale(4000, 3, Unit::REVOLUTION),
        scale(1, 13, Unit::MILLIMETRE).with_unit(Unit::INCREMENT).unwrap(),
        Scale::increments(),
    ]
}

fn row(key: &str) -> &'static Row {
    Row::find(key).unwrap().1
}

fn convert_back(row: &Row, scale: &Scale, shown: BorderValue) -> Result<Value, super::super::ConvertError> {
    convert(row, scale, &shown.into())
}

/// Values of the type of a row, small and large.
fn samples(row: &Row) -> Vec<Value> {
    let ints = [0, 1, -1, 7, 1000, 125_829_120, -987_654_321, 3_600_000_000_000, (1 << 50) + 1];
    let reals = [0.1 + 0.2, 1.0, 1e-3, 125_829_120.0, 33.333_333_333_333_336, 9.9e14, 123_456.789];
    let inside = |value: &Value| row.check(*value) != Err(Refused::OutOfRange);
    let all: Vec<Value> = match row.range {
        Range::Int(low, high) => ints.into_iter().chain([low, high]).map(Value::Int).collect(),
        Range::Among(ranges) => ranges.iter().flat_map(|(low, high)| [Value::Int(*low), Value::Int(*high)]).collect(),
        Range::PositiveUpTo(_) | Range::Real(..) => reals.into_iter().map(Value::Real).collect(),
    };
    all.into_iter().chain([row.default]).filter(inside).collect()
}

#[test]
fn shown_value_converts_back() {
    for scale in scales() {
        for row in ROWS {
            for value in samples(row) {
                let shown = row.to_border(&scale, value);
                let back = match (value, shown) {
                    (Value::Unset, shown) => {
                        assert_eq!(shown, BorderValue::Unset, "{}", row.key);
                        continue;
                    }
                    (_, shown) => convert_back(row, &scale, shown),
                };
                match (value, back) {
                    // Only 53 of 62 bits of increments fit a number.
                    (Value::Int(number), Ok(Value::Int(back))) if number.unsigned_abs() >= 1 << 53 => {
                        assert!(number.abs_diff(back) <= 1024, "{}: {number} is shown as {shown:?}", row.key);
                    }
                    (Value::Int(number), Err(_)) if number.unsigned_abs() >= 1 << 53 => {}
                    // If the factor allows no exact number, the nearest one is used; a unit reads at most 27 decimals.
                    (Value::Real(number), Ok(Value::Real(back))) => {
                        let most = if number.abs() < 1.0 { 1e-12 } else { 2.0 * f64::EPSILON };
                        let is_near = (number - back).abs() <= most * number.abs();
                        assert!(is_near, "{}: {number} is shown as {shown:?}, which is {back}", row.key);
                    }
                    (value, back) => assert_eq!(back, Ok(value), "{}: shown as {shown:?}", row.key),
                }
            }
        }
    }
}

#[test]
fn set_value_reads_as_written() {
    for scale in scales() {
        for row in ROWS.iter().filter(|row| row.border_type() == BorderType::Real) {
            for number in [0.1, 0.3, 0.7, 1.2, 2.5, 12.345, 90.0, 1.234_567_890_123_4] {
                let Ok(value) = convert(row, &scale, &ParameterInput::Number(number)) else { continue };
                let shown = row.to_border(&scale, value);
                match value {
                    Value::Real(_) => assert_eq!(shown, BorderValue::Real(number), "{}", row.key),
                    // The nearest increment.
                    _ => assert_eq!(convert_back(row, &scale, shown), Ok(value), "{}: {number}", row.key),
                }
            }
        }
    }
}

#[test]
fn every_end_of_a_range_is_taken_and_what_lies_beyond_is_not() {
    for scale in scales() {
        for row in ROWS {
            let Some(range) = row.shown_range(&scale) else { continue };
            let is_taken = |shown: BorderValue| {
                let value = convert_back(row, &scale, shown);
                value.is_ok_and(|value| row.check(value) != Err(Refused::OutOfRange))
            };
            match range {
                BorderRange::Integer { low, high, step } => {
                    assert!(is_taken(BorderValue::Integer(low)) && is_taken(BorderValue::Integer(high)), "{}", row.key);
                    assert_eq!(step, 1, "{}", row.key);
                    for beyond in [low - 1, high + 1] {
                        let is_default = row.default == Value::Int(beyond);
                        assert!(is_default || !is_taken(BorderValue::Integer(beyond)), "{} {beyond}", row.key);
                    }
                }
                BorderRange::Real { low, high, step } => {
                    let is_open = matches!(row.range, Range::PositiveUpTo(_));
                    assert_eq!(is_taken(BorderValue::Real(low)), !is_open, "{} from {low} on {scale:?}", row.key);
                    assert!(is_taken(BorderValue::Real(high)), "{} to {high} on {scale:?}", row.key);
                    assert_eq!(step > 0.0, row.step() > 0, "{}", row.key);
                    for beyond in [high * 1.001 + step, low - low.abs() / 1000.0 - step.max(1.0)] {
                        assert!(!is_taken(BorderValue::Real(beyond)), "{} {beyond} on {scale:?}", row.key);
                    }
                }
            }
        }
    }
}

#[test]
fn the_unit_of_a_bare_number_is_the_one_of_the_row() {
    let [spindle, turntable, ..] = scales();
    for (scale, key, value, number, unit) in [
        // 104 857 600 increments are a metre.
        (&spindle, "max_velocity", Value::Real(125_829_120.0), 1.2, "m/s"),
        (&spindle, "max_acceleration", Value::Real(838_860_800.0), 8.0, "m/s^2"),
        (&spindle, "min_position", Value::Int(-5_242_880), -0.05, "m"),
        (&spindle, "following_error_time", Value::Int(20_000_000), 0.02, "s"),
        (&spindle, "rampmin", Value::Int(1_000_000_000), 1000.0, "ms"),
        (&spindle, "amc.position_reference", Value::Int(6_291_456), 60.0, "mm"),
        (&spindle, "amc.speed_reference", Value::Real(104_857_600.0), 1.0, "mm/ms"),
        (&spindle, "velocity_override", Value::Real(50.0), 50.0, "%"),
        // 100 increments are a degree.
        (&turntable, "max_velocity", Value::Real(9000.0), std::f64::consts::FRAC_PI_2, "rad/s"),
        (&turntable, "amc.position_reference", Value::Int(9000), 90.0, "deg"),
    ] {
        let BorderValue::Real(shown) = row(key).to_border(scale, value) else { panic!("{key} is a number") };
        assert!((shown - number).abs() <= 1e-14, "{key}: {shown} for {number}");
        assert_eq!(row(key).border_unit(scale), unit, "{key}");
    }
    assert_eq!(row("profile").to_border(&spindle, Value::Int(2)), BorderValue::Name("jerk"));
    assert_eq!(row("saia.clamp_sum").to_border(&spindle, Value::Int(1)), BorderValue::Switch(true));
    assert_eq!(row("error_reaction").to_border(&spindle, Value::Int(5)), BorderValue::Integer(5));
    let range = row("error_reaction").shown_range(&spindle);
    assert_eq!(range, Some(BorderRange::Integer { low: 0, high: 5, step: 1 }));
    let BorderRange::Real { low, high, step } = row("following_error_time").shown_range(&spindle).unwrap() else {
        panic!("a time is a number")
    };
    assert_eq!((low, high, step), (0.0, 10.0, 1e-9));
}

#[test]
fn milliseconds_are_exact() {
    let [spindle, ..] = scales();
    let time = convert(row("rampmin"), &spindle, &ParameterInput::Number(1.234_567));
    assert_eq!(time, Ok(Value::Int(1_234_567)));
}

//! Values of function fields in ROS 2: an integer, or an array of integers for a list.

use crate::surface::parameters::type_name;
use lineshaft_core::config::SlotConfig;
use lineshaft_core::function::Field;
use lineshaft_core::request::FieldValue;
use lineshaft_core::unit::{excerpt, number_to_text};
use lineshaft_msgs::foreign::rcl_interfaces::msg::{Parameter, ParameterType, ParameterValue};

/// Returns the value of a field from a client: integers, also as doubles, and bools as 0 and 1.
///
/// # Errors
/// Another type, or a number that is not an integer; the message contains the name that the client gave.
pub(in crate::surface) fn field_value(name: &str, value: &ParameterValue) -> Result<FieldValue, String> {
    let one = |number: f64| as_integer(number).ok_or(number);
    let list = |numbers: &[f64]| numbers.iter().map(|&number| one(number)).collect::<Result<Vec<i64>, f64>>();
    let read = match value.r#type {
        ParameterType::PARAMETER_BOOL => Ok(FieldValue::One(value.bool_value.into())),
        ParameterType::PARAMETER_INTEGER => Ok(FieldValue::One(value.integer_value)),
        ParameterType::PARAMETER_DOUBLE => one(value.double_value).map(FieldValue::One),
        ParameterType::PARAMETER_BOOL_ARRAY => {
            Ok(FieldValue::List(value.bool_array_value.iter().map(|&bit| bit.into()).collect()))
        }
        ParameterType::PARAMETER_INTEGER_ARRAY => Ok(FieldValue::List(value.integer_array_value.clone())),
        ParameterType::PARAMETER_DOUBLE_ARRAY => list(&value.double_array_value).map(FieldValue::List),
        // The type of an empty list is unknown.
        ParameterType::PARAMETER_BYTE_ARRAY if value.byte_array_value.is_empty() => Ok(FieldValue::List(Vec::new())),
        other => {
            let (name, other) = (excerpt(name), type_name(other));
            return Err(format!("{name} cannot be {other}; an integer or a list of integers is needed"));
        }
    };
    read.map_err(|number| {
        format!("{} is {}; a whole number of 64 bits is needed", excerpt(name), number_to_text(number))
    })
}

/// Returns a double as i64 if it is an integer in its range.
fn as_integer(number: f64) -> Option<i64> {
    // The range includes -2^63, but not 2^63.
    let fits = (-9_223_372_036_854_775_808.0..9_223_372_036_854_775_808.0).contains(&number);
    (fits && number.fract() == 0.0).then_some(number as i64)
}

/// Returns the values of a field as a parameter value.
pub(in crate::surface) fn message(field: &Field, values: &[i64]) -> ParameterValue {
    let value = ParameterValue::default();
    match values {
        [integer_value] if field.count == 1 => {
            ParameterValue { r#type: ParameterType::PARAMETER_INTEGER, integer_value: *integer_value, ..value }
        }
        _ => {
            let integer_array_value = values.to_vec();
            ParameterValue { r#type: ParameterType::PARAMETER_INTEGER_ARRAY, integer_array_value, ..value }
        }
    }
}

/// Returns all fields of a function with the values of a set.
pub(super) fn all(slot: &SlotConfig, set: &[i64]) -> Vec<Parameter> {
    let mut rest = set;
    let mut take = |count: usize| {
        let (values, behind) = rest.split_at(count.min(rest.len()));
        rest = behind;
        values
    };
    let fields = slot.kind.description().fields.iter();
    fields.map(|field| Parameter { name: field.name.to_owned(), value: message(field, take(field.count)) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_core::function::Kind;

    fn double(double_value: f64) -> ParameterValue {
        ParameterValue { r#type: ParameterType::PARAMETER_DOUBLE, double_value, ..ParameterValue::default() }
    }

    fn text() -> ParameterValue {
        ParameterValue { r#type: ParameterType::PARAMETER_STRING, string_value: "3".to_owned(), ..Default::default() }
    }

    #[test]
    fn whole_numbers_are_taken_in_every_type_and_nothing_else() {
        let bit = ParameterValue { r#type: ParameterType::PARAMETER_BOOL, bool_value: true, ..Default::default() };
        let list = ParameterValue {
            r#type: ParameterType::PARAMETER_DOUBLE_ARRAY,
            double_array_value: vec![1.0, -2.0],
            ..Default::default()
        };
        assert_eq!(field_value("m1", &bit), Ok(FieldValue::One(1)));
        assert_eq!(field_value("m1", &list), Ok(FieldValue::List(vec![1, -2])));
        assert_eq!(field_value("m1", &double(-9_223_372_036_854_775_808.0)), Ok(FieldValue::One(i64::MIN)));
        for (value, sentence) in [
            (double(0.5), "m1 is 0.5; a whole number of 64 bits is needed"),
            (double(9_223_372_036_854_775_808.0), "m1 is 9223372036854776000; a whole number of 64 bits is needed"),
            (double(f64::NAN), "m1 is NaN; a whole number of 64 bits is needed"),
            (text(), "m1 cannot be a string; an integer or a list of integers is needed"),
            (ParameterValue::default(), "m1 cannot be without a value; an integer or a list of integers is needed"),
        ] {
            assert_eq!(field_value("m1", &value), Err(sentence.to_owned()));
        }
    }

    #[test]
    fn a_set_is_shown_field_by_field() {
        let slot = SlotConfig::new("cams".to_owned(), 0, Kind::Cam);
        let set: Vec<i64> = (0..).take(slot.values.len()).collect();
        let shown = all(&slot, &set);
        let value = |name: &str| &shown.iter().find(|parameter| parameter.name == name).expect("a field").value;
        assert_eq!(value("dead_time_mean"), &message(&slot.kind.description().fields[2], &[2]));
        assert_eq!((value("cams").r#type, value("cams").integer_array_value.as_slice()), (7, &set[3..11]));
        assert_eq!((value("modulo").r#type, value("modulo").integer_value), (2, 19));
        assert_eq!(value("hysteresis").integer_array_value, &set[20..]);
        // An image without sets has no values.
        assert_eq!(all(&slot, &[]).len(), shown.len());
    }
}

use super::*;
use crate::layer::{NodeName, RosArguments};
use lineshaft_msgs::foreign::rcl_interfaces::msg::{FloatingPointRange, IntegerRange};

fn given(line: &str) -> OwnParameters {
    let words = line.split(' ').filter(|word| !word.is_empty()).flat_map(|word| ["-p".to_owned(), word.to_owned()]);
    let (arguments, _) = RosArguments::take(std::iter::once("--ros-args".to_owned()).chain(words)).unwrap();
    OwnParameters::new(arguments.overrides(&NodeName::new("/", "n").unwrap()))
}

fn double(double_value: f64) -> ParameterValue {
    ParameterValue { r#type: ParameterType::PARAMETER_DOUBLE, double_value, ..ParameterValue::default() }
}

fn integer(integer_value: i64) -> ParameterValue {
    ParameterValue { r#type: ParameterType::PARAMETER_INTEGER, integer_value, ..ParameterValue::default() }
}

fn string(text: &str) -> ParameterValue {
    let string_value = text.to_owned();
    ParameterValue { r#type: ParameterType::PARAMETER_STRING, string_value, ..ParameterValue::default() }
}

/// Declares a number in 0 to 1, a count in 1 to 10 with step 3, a read-only list, and a string with two allowed values.
fn declare(own: &OwnParameters) {
    let descriptor = |name: &str, r#type| ParameterDescriptor { name: name.to_owned(), r#type, ..Default::default() };
    let range = FloatingPointRange { from_value: 0.0, to_value: 1.0, step: 0.0 };
    let share = descriptor("share", ParameterType::PARAMETER_DOUBLE);
    let descriptor_of_share = ParameterDescriptor { floating_point_range: Some(range).into(), ..share };
    own.declare(OwnParameter { descriptor: descriptor_of_share, value: double(0.5), ..OwnParameter::default() });
    let range = IntegerRange { from_value: 1, to_value: 10, step: 4 };
    let count = descriptor("count", ParameterType::PARAMETER_INTEGER);
    own.declare(OwnParameter {
        descriptor: ParameterDescriptor { integer_range: Some(range).into(), ..count },
        value: integer(5),
        ..OwnParameter::default()
    });
    let list = descriptor("list", ParameterType::PARAMETER_DOUBLE_ARRAY);
    let r#type = ParameterType::PARAMETER_DOUBLE_ARRAY;
    let value = ParameterValue { r#type, double_array_value: vec![1.0], ..ParameterValue::default() };
    own.declare(OwnParameter {
        descriptor: ParameterDescriptor { read_only: true, ..list },
        value,
        ..OwnParameter::default()
    });
    let word = descriptor("word", ParameterType::PARAMETER_STRING);
    own.declare(OwnParameter { descriptor: word, value: string("scale"), words: &["scale", "refuse"] });
    own.declare_switch("use_sim_time", "The time of /clock.");
}

fn value(own: &OwnParameters, name: &str) -> ParameterValue {
    own.get(name).unwrap().value
}

#[test]
fn override_replaces_default() {
    let own = given("share:=1 list:=[1,2] use_sim_time:=true");
    declare(&own);
    own.check().unwrap();
    assert_eq!(value(&own, "share"), double(1.0), "a double takes an integer");
    assert_eq!(value(&own, "count"), integer(5));
    assert_eq!(value(&own, "list").double_array_value, [1.0, 2.0], "also where it is read-only later");
    assert!(own.switch("use_sim_time"));
    let own = given("list:=[]");
    declare(&own);
    assert_eq!((value(&own, "list").r#type, value(&own, "list").double_array_value.len()), (8, 0));
}

#[test]
fn invalid_overrides_are_reported_after_all_declarations() {
    let refused = |line: &str| {
        let own = given(line);
        declare(&own);
        assert_eq!(value(&own, "share"), double(0.5));
        own.check().unwrap_err().to_string()
    };
    assert_eq!(refused("share:=2.0"), "-p share: share is 2; 0 to 1 is allowed");
    let both = "-p share: share cannot be a string; a double is needed; -p count: count is 4; 1 to 10 in steps of 4 is allowed";
    assert_eq!(refused("share:=fast count:=4"), both);
    assert_eq!(refused("share:=.nan"), "-p share: share is NaN; a finite number is needed");
    assert_eq!(refused("use_sim_time:=1"), "-p use_sim_time: use_sim_time cannot be an integer; a bool is needed");
    assert!(refused("shares:=1.0").starts_with("-p shares: no parameter is called `shares`; "));
}

#[test]
fn set_checks_type_range_and_read_only() {
    let own = OwnParameters::default();
    declare(&own);
    let ask = |name: &str, value: ParameterValue| own.fitting(name, &value);
    assert_eq!(ask("other", double(1.0)), None);
    assert_eq!(ask("share", integer(1)), Some(Ok(double(1.0))));
    assert!(ask("share", double(f64::INFINITY)).unwrap().is_err());
    assert!(ask("share", ParameterValue::default()).unwrap().is_err());
    assert!(ask("list", ParameterValue::default()).unwrap().unwrap_err().starts_with("list is read-only: "));
    for (count, is_taken) in [(0, false), (1, true), (2, false), (5, true), (9, true), (10, true), (11, false)] {
        assert_eq!(ask("count", integer(count)).unwrap().is_ok(), is_taken, "{count}");
    }
    let mut changes = own.changes();
    changes.mark_unchanged();
    own.set([("share".to_owned(), double(0.25))]);
    assert!(changes.has_changed().unwrap());
    assert_eq!(value(&own, "share"), double(0.25));
}

#[test]
fn misleading_name_is_refused_with_intended_name() {
    let sentence = "parameter `part` has not been declared; by the joint name it is `share`";
    let own = given("part:=0.25");
    declare(&own);
    own.rename("part".to_owned(), "share".to_owned());
    assert_eq!(own.check().unwrap_err().to_string(), format!("-p part: {sentence}"));
    assert_eq!(own.fitting("part", &double(0.25)), Some(Err(sentence.to_owned())));
    assert_eq!(own.fitting("share", &double(0.25)), Some(Ok(double(0.25))));
    assert!(own.get("part").is_none() && !own.names().contains(&"part".to_owned()), "it is no parameter");
    // There is no override for it.
    let own = given("share:=0.25");
    declare(&own);
    own.rename("part".to_owned(), "share".to_owned());
    own.check().unwrap();
}

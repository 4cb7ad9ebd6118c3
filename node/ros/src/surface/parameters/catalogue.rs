//! Parameters that the node declares, and their values.

use super::functions::{self, FunctionParameter};
use super::own::type_name;
use lineshaft_core::config::{MachineConfig, max_velocity_of_cycle};
use lineshaft_core::parameter::{
    Applies, BorderType, BorderValue, MACHINE, ParameterImage, ParameterInput, ROWS, Row, Storage, Value,
};
use lineshaft_core::unit::Scale;
use lineshaft_msgs::foreign::rcl_interfaces::msg::{Parameter, ParameterType, ParameterValue};
use std::collections::HashSet;

/// Parameter of one object.
#[derive(Clone, Debug)]
pub(super) struct DeclaredParameter {
    pub name: String,
    /// Index of the axis; [`MACHINE`] for the machine.
    axis: u16,
    pub row: &'static Row,
    pub scale: Scale,
    /// Maximum velocity that the cycle of the machine allows, in inc/s.
    pub highest_velocity: f64,
}

/// Reason why parameters of the cell cannot be set.
pub(super) const PART_OF_CELL: &str = "part of the cell: changes with the file and a new start";

/// All declared parameters, by name.
#[derive(Clone, Debug)]
pub(super) struct Catalogue {
    of_machine: Vec<DeclaredParameter>,
    of_functions: Vec<FunctionParameter>,
}

impl Catalogue {
    pub(super) fn new(config: &MachineConfig) -> Self {
        // Values that the source publishes in a register are signals here.
        let rows = || ROWS.iter().filter(|row| !matches!(row.storage, Storage::Signal(_)));
        let highest_velocity = max_velocity_of_cycle(config.cycle_ns);
        let of_machine = rows().filter(|row| row.applies == Applies::Machine).map(|row| DeclaredParameter {
            name: format!("machine.{}", row.key),
            axis: MACHINE,
            row,
            scale: Scale::increments(),
            highest_velocity,
        });
        let of_axes = config.axes.iter().zip(0..).flat_map(|(axis, index)| {
            rows().filter(|row| row.applies.to(axis)).map(move |row| DeclaredParameter {
                name: format!("{}.{}", axis.name, row.key),
                axis: index,
                row,
                scale: axis.scale,
                highest_velocity,
            })
        });
        let mut all: Vec<DeclaredParameter> = of_machine.chain(of_axes).collect();
        all.sort_by(|a, b| a.name.cmp(&b.name));
        let mut of_functions = functions::all(config);
        of_functions.sort_by(|a, b| a.name.cmp(&b.name));
        Self { of_machine: all, of_functions }
    }

    /// Returns all parameters of axes and of the machine, ascending by name.
    pub(super) fn all(&self) -> &[DeclaredParameter] {
        &self.of_machine
    }

    /// Returns all parameters of functions, ascending by name.
    pub(super) fn functions(&self) -> &[FunctionParameter] {
        &self.of_functions
    }

    /// Returns the number of parameters.
    pub(super) fn len(&self) -> usize {
        self.of_machine.len() + self.of_functions.len()
    }

    /// Returns the parameter of an axis or the machine with this name.
    pub(super) fn find(&self, name: &str) -> Option<&DeclaredParameter> {
        let place = self.of_machine.binary_search_by(|declared| declared.name.as_str().cmp(name)).ok()?;
        self.of_machine.get(place)
    }

    /// Returns the parameter of a function with this name.
    pub(super) fn function(&self, name: &str) -> Option<&FunctionParameter> {
        let place = self.of_functions.binary_search_by(|known| known.name.as_str().cmp(name)).ok()?;
        self.of_functions.get(place)
    }
}

impl DeclaredParameter {
    /// Returns the value in an image, in units of the core.
    pub(super) fn value(&self, image: &ParameterImage) -> Value {
        let of_machine = || self.row.machine_value(&image.machine[0]);
        image.effective.get(usize::from(self.axis)).map_or_else(of_machine, |axis| self.row.value(axis))
    }

    /// Returns the value in an image, as a message.
    pub(super) fn message(&self, image: &ParameterImage) -> ParameterValue {
        let value = ParameterValue::default();
        match self.row.to_border(&self.scale, self.value(image)) {
            BorderValue::Unset => value,
            BorderValue::Switch(bool_value) => {
                ParameterValue { r#type: ParameterType::PARAMETER_BOOL, bool_value, ..value }
            }
            BorderValue::Integer(integer_value) => {
                ParameterValue { r#type: ParameterType::PARAMETER_INTEGER, integer_value, ..value }
            }
            BorderValue::Real(double_value) => {
                ParameterValue { r#type: ParameterType::PARAMETER_DOUBLE, double_value, ..value }
            }
            BorderValue::Name(name) => {
                ParameterValue { r#type: ParameterType::PARAMETER_STRING, string_value: name.to_owned(), ..value }
            }
        }
    }

    /// Returns name and value in an image.
    pub(super) fn parameter(&self, image: &ParameterImage) -> Parameter {
        Parameter { name: self.name.clone(), value: self.message(image) }
    }

    /// Returns the number of the parameter type.
    pub(super) fn type_number(&self) -> u8 {
        match self.row.border_type() {
            BorderType::Switch => ParameterType::PARAMETER_BOOL,
            BorderType::Integer => ParameterType::PARAMETER_INTEGER,
            BorderType::Real => ParameterType::PARAMETER_DOUBLE,
            BorderType::Name => ParameterType::PARAMETER_STRING,
        }
    }

    /// Returns true if the parameter may be without a value.
    pub(super) fn may_be_unset(&self) -> bool {
        self.row.default == Value::Unset && !self.row.required && !self.row.is_read_only()
    }

    /// Converts the value of a client for the core.
    ///
    /// # Errors
    /// The type is not that of the parameter; the message gives the expected one.
    pub(super) fn input(&self, value: &ParameterValue) -> Result<ParameterInput, String> {
        match (self.interpret(value), self.row.border_type()) {
            (InterpretedValue::Nothing, _) if self.may_be_unset() => Ok(ParameterInput::Unset),
            (InterpretedValue::Switch(is_on), BorderType::Switch) => Ok(ParameterInput::Text(is_on.to_string())),
            (InterpretedValue::Integer(number), BorderType::Integer | BorderType::Real) => {
                Ok(ParameterInput::Integer(number))
            }
            (InterpretedValue::Real(number), BorderType::Real) => Ok(ParameterInput::Number(number)),
            (InterpretedValue::Name(name), BorderType::Name) => Ok(ParameterInput::Text(name.to_owned())),
            (said, expected) => {
                let given = type_name(said.type_number());
                let expected = match expected {
                    BorderType::Switch => "true or false",
                    BorderType::Integer => "an integer",
                    BorderType::Real => "a number",
                    BorderType::Name => "a string",
                };
                let kind = if self.may_be_unset() { ", or nothing," } else { "" };
                Err(format!("{} cannot be {given}; {expected}{kind} is needed", self.name))
            }
        }
    }

    /// Returns true if the parameter shows a value that cannot be set: a part of the cell, a calculated value, or a view beyond the range
    /// of its source (`velmax` of a fast axis). A dump contains such values.
    pub(super) fn is_not_settable(&self, config: &MachineConfig, value: &ParameterValue) -> bool {
        let given = || self.input(value).ok().and_then(|input| config.resolve_parameter(&self.name, &input).ok());
        self.row.is_read_only() || given().is_some_and(|change| self.row.check(change.value).is_err())
    }

    /// Returns true if the parameter is a view of one of `names`, as each value in a dump has: `x.dfltacc` next to
    /// `x.default_acceleration`.
    pub(super) fn is_view_of(&self, names: &HashSet<&str>) -> bool {
        let of_itself = || self.name.strip_suffix(self.row.key).map(|object| format!("{object}{}", self.row.root()));
        self.row.is_view() && of_itself().is_some_and(|name| names.contains(name.as_str()))
    }

    /// Returns true if the parameter has this value in an image.
    pub(super) fn has_value(&self, value: &ParameterValue, image: &ParameterImage) -> bool {
        match (self.interpret(value), self.row.to_border(&self.scale, self.value(image))) {
            (InterpretedValue::Nothing, BorderValue::Unset) => true,
            (InterpretedValue::Switch(given), BorderValue::Switch(shown)) => given == shown,
            (InterpretedValue::Integer(given), BorderValue::Integer(shown)) => given == shown,
            (InterpretedValue::Integer(given), BorderValue::Real(shown)) => given as f64 == shown,
            (InterpretedValue::Real(given), BorderValue::Real(shown)) => given == shown,
            (InterpretedValue::Name(given), BorderValue::Name(shown)) => given == shown,
            _ => false,
        }
    }

    /// Returns true if the parameter has this number in an image, apart from rounding.
    pub(super) fn nearly_has_value(&self, value: &ParameterValue, image: &ParameterImage) -> bool {
        match (self.interpret(value), self.row.to_border(&self.scale, self.value(image))) {
            (InterpretedValue::Real(given), BorderValue::Real(shown)) => (given - shown).abs() <= 1e-9 * shown.abs(),
            _ => false,
        }
    }

    /// Interprets a value for this parameter. `ros2 param load` guesses the types of texts again: it sends the null of a file as the string
    /// `None`, and 0.00001 as the string `1e-05`.
    fn interpret<'a>(&self, value: &'a ParameterValue) -> InterpretedValue<'a> {
        let text = value.string_value.as_str();
        match (value.r#type, self.row.border_type()) {
            (ParameterType::PARAMETER_NOT_SET, _) => InterpretedValue::Nothing,
            (ParameterType::PARAMETER_BOOL, _) => InterpretedValue::Switch(value.bool_value),
            (ParameterType::PARAMETER_INTEGER, _) => InterpretedValue::Integer(value.integer_value),
            (ParameterType::PARAMETER_DOUBLE, _) => InterpretedValue::Real(value.double_value),
            (ParameterType::PARAMETER_STRING, BorderType::Integer | BorderType::Real | BorderType::Switch)
                if text == "None" =>
            {
                InterpretedValue::Nothing
            }
            (ParameterType::PARAMETER_STRING, BorderType::Real) => {
                power_of_ten(text).map_or(InterpretedValue::Name(text), InterpretedValue::Real)
            }
            (ParameterType::PARAMETER_STRING, _) => InterpretedValue::Name(text),
            (other, _) => InterpretedValue::Other(other),
        }
    }
}

/// Value as a parameter of the machine interprets it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum InterpretedValue<'a> {
    Nothing,
    Switch(bool),
    Integer(i64),
    Real(f64),
    Name(&'a str),
    /// Type that no parameter of the machine has.
    Other(u8),
}

impl InterpretedValue<'_> {
    fn type_number(self) -> u8 {
        match self {
            Self::Nothing => ParameterType::PARAMETER_NOT_SET,
            Self::Switch(_) => ParameterType::PARAMETER_BOOL,
            Self::Integer(_) => ParameterType::PARAMETER_INTEGER,
            Self::Real(_) => ParameterType::PARAMETER_DOUBLE,
            Self::Name(_) => ParameterType::PARAMETER_STRING,
            Self::Other(number) => number,
        }
    }
}

/// Parses an integer with an exponent, such as `-1e-05`: YAML 1.1, which Python reads, treats it as a string.
pub(super) fn power_of_ten(text: &str) -> Option<f64> {
    let (digits, exponent) = text.strip_prefix('-').unwrap_or(text).split_once('e')?;
    let is_digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let is_one = is_digits(digits) && is_digits(exponent.strip_prefix(['+', '-']).unwrap_or(exponent));
    if is_one { text.parse().ok().filter(|number: &f64| number.is_finite()) } else { None }
}

#[cfg(test)]
mod tests {
    use super::super::fake;
    use super::*;

    #[test]
    fn every_row_that_applies_is_declared_once() {
        let config = fake::config();
        let catalogue = Catalogue::new(&config);
        let has = |name: &str| catalogue.find(name).is_some();
        assert!(has("x.max_velocity") && has("x.velmax") && has("x.saia.kprop") && has("machine.cannr"));
        assert!(has("line.max_velocity"));
        assert!(!has("line.kprop"), "a virtual axis has no position loop");
        assert!(!has("x.cannr") && !has("machine.max_velocity") && !has("x") && !has(""));
        let names: Vec<&str> = catalogue.all().iter().map(|declared| declared.name.as_str()).collect();
        assert!(names.is_sorted_by(|a, b| a < b), "ascending, each once");
        assert!(names.iter().all(|name| catalogue.find(name).is_some_and(|found| found.name == *name)));
    }

    #[test]
    fn shown_value_is_accepted_with_its_type_only() {
        let config = fake::config();
        let (catalogue, image) = (Catalogue::new(&config), fake::image(&config));
        for declared in catalogue.all() {
            let shown = declared.message(&image);
            let is_unset = shown.r#type == ParameterType::PARAMETER_NOT_SET;
            assert!(is_unset || shown.r#type == declared.type_number(), "{}", declared.name);
            if !declared.row.is_read_only() {
                let input = declared.input(&shown);
                let input = input.unwrap_or_else(|sentence| panic!("{sentence}"));
                let change = config.resolve_parameter(&declared.name, &input);
                assert_eq!(change.map(|change| change.value), Ok(declared.value(&image)), "{}", declared.name);
            }
            for number in 0..=10 {
                let is_own = number == declared.type_number();
                let is_whole = number == ParameterType::PARAMETER_INTEGER
                    && declared.type_number() == ParameterType::PARAMETER_DOUBLE;
                let is_nothing = number == 0 && declared.may_be_unset();
                let given = declared.input(&ParameterValue { r#type: number, ..ParameterValue::default() });
                assert_eq!(given.is_ok(), is_own || is_whole || is_nothing, "{} {number}: {given:?}", declared.name);
            }
        }
    }

    #[test]
    fn values_of_ros2_param_load_are_interpreted() {
        let config = fake::config();
        let catalogue = Catalogue::new(&config);
        let text = |text: &str| ParameterValue {
            r#type: ParameterType::PARAMETER_STRING,
            string_value: text.to_owned(),
            ..ParameterValue::default()
        };
        let input = |name: &str, given: &str| catalogue.find(name).expect("declared").input(&text(given));
        assert_eq!(input("x.max_jerk", "None"), Ok(ParameterInput::Unset));
        assert_eq!(input("x.max_velocity", "1e-05"), Ok(ParameterInput::Number(0.000_01)));
        assert_eq!(input("x.max_velocity", "-3e+16"), Ok(ParameterInput::Number(-3e16)));
        assert_eq!(
            input("x.max_velocity", "None").unwrap_err(),
            "x.max_velocity cannot be without a value; a number is needed"
        );
        for other in ["1", "1.0", "e5", "1e", "1e+", "1e5m", "inf", "1e999", "0x1e5", "", "null", "none"] {
            let error = input("x.max_velocity", other).unwrap_err();
            assert_eq!(error, "x.max_velocity cannot be a string; a number is needed", "{other}");
        }
        // A parameter of type string is not interpreted.
        assert_eq!(input("x.profile", "None"), Ok(ParameterInput::Text("None".to_owned())));
        assert!(input("x.error_reaction", "1e0").is_err());
    }

    #[test]
    fn a_view_repeats_the_value_that_is_named_beside_it() {
        let catalogue = Catalogue::new(&fake::config());
        let repeats = |name: &str, names: &[&str]| {
            catalogue.find(name).expect("declared").is_view_of(&names.iter().copied().collect())
        };
        assert!(repeats("x.velmax", &["x.velmax", "x.max_velocity"]));
        assert!(!repeats("x.velmax", &["x.velmax", "line.max_velocity", "x.max_acceleration"]));
        assert!(!repeats("x.max_velocity", &["x.velmax", "x.max_velocity"]));
    }

    #[test]
    fn a_value_is_the_same_whatever_type_it_came_in() {
        let config = fake::config();
        let (catalogue, image) = (Catalogue::new(&config), fake::image(&config));
        let find = |name: &str| catalogue.find(name).expect("declared");
        for declared in catalogue.all() {
            assert!(declared.has_value(&declared.message(&image), &image), "{}", declared.name);
        }
        let integer = |integer_value| ParameterValue {
            r#type: ParameterType::PARAMETER_INTEGER,
            integer_value,
            ..ParameterValue::default()
        };
        assert!(
            find("x.max_velocity").has_value(&integer(1), &image)
                && !find("x.max_velocity").has_value(&integer(2), &image)
        );
        assert!(!find("x.max_velocity").has_value(&ParameterValue::default(), &image));
        assert!(find("x.max_jerk").has_value(&ParameterValue::default(), &image));
        assert!(!find("x.max_jerk").has_value(&integer(0), &image));
    }
}

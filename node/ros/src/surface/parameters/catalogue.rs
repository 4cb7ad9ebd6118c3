//! Which parameters the node declares, and what each is worth.

use super::own::type_name;
use lineshaft_core::config::{MachineConfig, highest_velocity};
use lineshaft_core::parameter::{
    Applies, BorderType, BorderValue, MACHINE, ParameterImage, ParameterInput, ROWS, Row, Storage, Value,
};
use lineshaft_core::unit::Scale;
use lineshaft_msgs::foreign::rcl_interfaces::msg::{Parameter, ParameterType, ParameterValue};

/// One parameter of one object.
#[derive(Clone, Debug)]
pub(super) struct Declared {
    pub name: String,
    /// [`MACHINE`] for the machine.
    axis: u16,
    pub row: &'static Row,
    pub scale: Scale,
    /// What a cycle of the machine can do (inc/s).
    pub highest_velocity: f64,
}

/// All of them, by name.
#[derive(Clone, Debug)]
pub(super) struct Catalogue(Vec<Declared>);

impl Catalogue {
    pub(super) fn new(config: &MachineConfig) -> Self {
        // What the source shows in a register is a signal here.
        let rows = || ROWS.iter().filter(|row| !matches!(row.storage, Storage::Signal(_)));
        let highest_velocity = highest_velocity(config.cycle_ns);
        let of_machine = rows().filter(|row| row.applies == Applies::Machine).map(|row| Declared {
            name: format!("machine.{}", row.key),
            axis: MACHINE,
            row,
            scale: Scale::increments(),
            highest_velocity,
        });
        let of_axes = config.axes.iter().zip(0..).flat_map(|(axis, index)| {
            rows().filter(|row| row.applies.to(axis)).map(move |row| Declared {
                name: format!("{}.{}", axis.name, row.key),
                axis: index,
                row,
                scale: axis.scale,
                highest_velocity,
            })
        });
        let mut all: Vec<Declared> = of_machine.chain(of_axes).collect();
        all.sort_by(|a, b| a.name.cmp(&b.name));
        Self(all)
    }

    /// All, ascending by name.
    pub(super) fn all(&self) -> &[Declared] {
        &self.0
    }

    /// The parameter of that name.
    pub(super) fn find(&self, name: &str) -> Option<&Declared> {
        let place = self.0.binary_search_by(|declared| declared.name.as_str().cmp(name)).ok()?;
        self.0.get(place)
    }
}

impl Declared {
    /// Its value in an image, in the core's units.
    pub(super) fn value(&self, image: &ParameterImage) -> Value {
        let of_machine = || self.row.machine_value(&image.machine[0]);
        image.effective.get(usize::from(self.axis)).map_or_else(of_machine, |axis| self.row.value(axis))
    }

    /// Its value in an image, as a message.
    pub(super) fn message(&self, image: &ParameterImage) -> ParameterValue {
        let value = ParameterValue::default();
        match self.row.shown(&self.scale, self.value(image)) {
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

    /// Name and value in an image.
    pub(super) fn parameter(&self, image: &ParameterImage) -> Parameter {
        Parameter { name: self.name.clone(), value: self.message(image) }
    }

    /// Number of its type.
    pub(super) fn type_number(&self) -> u8 {
        match self.row.border_type() {
            BorderType::Switch => ParameterType::PARAMETER_BOOL,
            BorderType::Integer => ParameterType::PARAMETER_INTEGER,
            BorderType::Real => ParameterType::PARAMETER_DOUBLE,
            BorderType::Name => ParameterType::PARAMETER_STRING,
        }
    }

    /// May it be left out?
    pub(super) fn may_be_unset(&self) -> bool {
        self.row.default == Value::Unset && !self.row.required && !self.row.is_read_only()
    }

    /// What a client gives, for the core.
    ///
    /// # Errors
    /// Another type than the parameter has: which one it should be.
    pub(super) fn input(&self, value: &ParameterValue) -> Result<ParameterInput, String> {
        match (value.r#type, self.row.border_type()) {
            (ParameterType::PARAMETER_NOT_SET, _) if self.may_be_unset() => Ok(ParameterInput::Unset),
            (ParameterType::PARAMETER_BOOL, BorderType::Switch) => {
                Ok(ParameterInput::Text(value.bool_value.to_string()))
            }
            (ParameterType::PARAMETER_INTEGER, BorderType::Integer | BorderType::Real) => {
                Ok(ParameterInput::Integer(value.integer_value))
            }
            (ParameterType::PARAMETER_DOUBLE, BorderType::Real) => Ok(ParameterInput::Number(value.double_value)),
            (ParameterType::PARAMETER_STRING, BorderType::Name) => Ok(ParameterInput::Text(value.string_value.clone())),
            (given, expected) => {
                let given = type_name(given);
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
    fn what_is_shown_is_taken_as_it_is_of_no_other_type() {
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
}

//! Parameters of functions: `<function>.<field>` is the staged value for the next START or VALUE_NEW; in addition the read-only
//! configuration of the function from the cell.

use super::catalogue::PART_OF_CELL;
use crate::surface::functions::fields;
use lineshaft_core::command::Action;
use lineshaft_core::config::{MachineConfig, SinkConfig, SlotConfig, SourceConfig};
use lineshaft_core::function::{Field, Order};
use lineshaft_core::object::Object;
use lineshaft_core::parameter::{ParameterImage, Sets};
use lineshaft_core::request::{FieldValue, FunctionRequest};
use lineshaft_msgs::foreign::rcl_interfaces::msg::{
    IntegerRange, Parameter, ParameterDescriptor, ParameterType, ParameterValue,
};

/// Parameter of one function.
#[derive(Clone, Debug)]
pub(super) struct FunctionParameter {
    pub name: String,
    /// Index of the function among the slots.
    place: u16,
    what: FunctionParameterKind,
}

#[derive(Clone, Debug)]
enum FunctionParameterKind {
    /// Field of the parameter set, and the index of its first value in the set.
    Field(&'static Field, usize),
    /// Value from the cell, with its description.
    Structure(ParameterValue, &'static str),
}

/// Value of a field from a client.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Staged {
    /// Index of the function.
    pub place: u16,
    field: &'static str,
    value: FieldValue,
}

/// Returns the parameters of all functions.
pub(super) fn all(config: &MachineConfig) -> Vec<FunctionParameter> {
    let of_slot = |(slot, place): (&SlotConfig, u16)| {
        let mut first = 0;
        let fields = slot.kind.description().fields.iter().map(move |field| {
            let what = FunctionParameterKind::Field(field, first);
            first += field.count;
            (field.name, what)
        });
        let structure = structure(config, slot).into_iter();
        let structure = structure.map(|(key, value, help)| (key, FunctionParameterKind::Structure(value, help)));
        let named = |(key, what)| FunctionParameter { name: format!("{}.{key}", slot.name), place, what };
        fields.chain(structure).map(named).collect::<Vec<_>>()
    };
    config.slots.iter().zip(0..).flat_map(of_slot).collect()
}

fn structure(config: &MachineConfig, slot: &SlotConfig) -> [(&'static str, ParameterValue, &'static str); 5] {
    let none = || "none".to_owned();
    let source = match &slot.source {
        SourceConfig::None => none(),
        SourceConfig::Lead(leader) => config.signal_of(*leader).unwrap_or_else(none),
        SourceConfig::Signal(name) => name.clone(),
    };
    let sink = match slot.sink {
        SinkConfig::None => none(),
        SinkConfig::Axis(place) => config.name(Object::Axis(place)).to_owned(),
        SinkConfig::Memory(place) => config.name(Object::Memory(place)).to_owned(),
        SinkConfig::Output(place) => config.name(Object::Io(place)).to_owned(),
    };
    [
        ("slot", integer(slot.number.into()), "The slot of the function: lower ones come first in a cycle."),
        ("type", text(slot.kind.name().to_owned()), slot.kind.description().help),
        ("source", text(source), "The signal that the function reads."),
        ("sink", text(sink), "What the function writes."),
        ("cycle_factor", integer(slot.factor.into()), "The function is called in each n-th cycle."),
    ]
}

fn integer(integer_value: i64) -> ParameterValue {
    ParameterValue { r#type: ParameterType::PARAMETER_INTEGER, integer_value, ..ParameterValue::default() }
}

fn text(string_value: String) -> ParameterValue {
    ParameterValue { r#type: ParameterType::PARAMETER_STRING, string_value, ..ParameterValue::default() }
}

impl FunctionParameter {
    /// Returns the value in an image.
    pub(super) fn message(&self, image: &ParameterImage) -> ParameterValue {
        match &self.what {
            FunctionParameterKind::Structure(value, _) => value.clone(),
            FunctionParameterKind::Field(field, _) => {
                self.values(image).map_or_else(ParameterValue::default, |values| fields::message(field, values))
            }
        }
    }

    /// Returns name and value in an image.
    pub(super) fn parameter(&self, image: &ParameterImage) -> Parameter {
        Parameter { name: self.name.clone(), value: self.message(image) }
    }

    /// Returns true if both images have the same value.
    pub(super) fn is_same(&self, one: &ParameterImage, other: &ParameterImage) -> bool {
        self.values(one) == self.values(other)
    }

    /// Returns the staged values of a field.
    fn values<'a>(&self, image: &'a ParameterImage) -> Option<&'a [i64]> {
        let FunctionParameterKind::Field(field, first) = self.what else { return None };
        image.functions.get(usize::from(self.place))?.staged.get(first..first + field.count)
    }

    pub(super) fn descriptor(&self) -> ParameterDescriptor {
        let descriptor = ParameterDescriptor { name: self.name.clone(), ..ParameterDescriptor::default() };
        match &self.what {
            FunctionParameterKind::Structure(value, help) => ParameterDescriptor {
                r#type: value.r#type,
                description: (*help).to_owned(),
                additional_constraints: PART_OF_CELL.to_owned(),
                read_only: true,
                ..descriptor
            },
            FunctionParameterKind::Field(field, _) => {
                let is_list = field.count > 1;
                let unit = if field.unit.is_empty() { String::new() } else { format!(" Unit: {}.", field.unit) };
                let when = if field.live { "START or VALUE_NEW" } else { "START" };
                let (help, source) = (field.help, field.source);
                let range = IntegerRange { from_value: field.min, to_value: field.max, step: 1 };
                ParameterDescriptor {
                    r#type: match is_list {
                        true => ParameterType::PARAMETER_INTEGER_ARRAY,
                        false => ParameterType::PARAMETER_INTEGER,
                    },
                    description: format!("{help}.{unit} Takes effect with the next {when}. Source: {source}."),
                    additional_constraints: self.constraints(field),
                    integer_range: Some(range).into(),
                    ..descriptor
                }
            }
        }
    }

    /// Returns the constraints that the range does not express.
    fn constraints(&self, field: &Field) -> String {
        let mut parts = Vec::new();
        if field.count > 1 {
            parts.push(format!("1 to {} values, of which the others stay", field.count));
        }
        if !(field.min..=field.max).contains(&field.default) {
            parts.push("must be given before START".to_owned());
        }
        parts.join("; ")
    }

    /// Returns the requested change; `None` if the parameter cannot be set, but already has this value in `image`.
    ///
    /// # Errors
    /// The value cannot be set.
    pub(super) fn staged(&self, value: &ParameterValue, image: &ParameterImage) -> Result<Option<Staged>, String> {
        let name = &self.name;
        let field = match &self.what {
            FunctionParameterKind::Structure(known, _) if value == known => return Ok(None),
            FunctionParameterKind::Structure(..) => return Err(format!("{name} is read-only: {PART_OF_CELL}")),
            FunctionParameterKind::Field(field, _) => *field,
        };
        let value = match (fields::field_value(name, value)?, field.count) {
            (FieldValue::List(_), 1) => return Err(format!("{name} cannot be a list; an integer is needed")),
            (FieldValue::One(_), 2..) => {
                return Err(format!("{name} cannot be one number; a list of 1 to {} integers is needed", field.count));
            }
            (value, _) => value,
        };
        // A dump contains such values: fields that must be given before START, and were not.
        let given: &[i64] = match &value {
            FieldValue::One(value) => std::slice::from_ref(value),
            FieldValue::List(values) => values,
        };
        let is_beyond = given.iter().any(|value| !(field.min..=field.max).contains(value));
        if is_beyond && self.values(image) == Some(given) {
            return Ok(None);
        }
        Ok(Some(Staged { place: self.place, field: field.name, value }))
    }
}

/// Returns an image with the parameter sets of the cell.
pub(super) fn of_cell(config: &MachineConfig) -> ParameterImage {
    let sets = |slot: &SlotConfig| Sets { staged: slot.values.clone(), active: slot.values.clone() };
    ParameterImage { functions: config.slots.iter().map(sets).collect(), ..ParameterImage::default() }
}

/// Returns the command that stages values of one function, all of them or none.
///
/// # Errors
/// A value is invalid.
pub(super) fn command(config: &MachineConfig, place: u16, staged: Vec<Staged>) -> Result<Action, String> {
    let function = config.name(Object::Function(place)).to_owned();
    let values = staged.into_iter().map(|Staged { field, value, .. }| (field.to_owned(), value)).collect();
    let request = FunctionRequest { function, order: Order::Stage, values };
    config.resolve_function(&request).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::super::catalogue::Catalogue;
    use super::*;
    use lineshaft_core::command::{Command, CommandFunction, Commands, Source};
    use lineshaft_core::event::Kind as EventKind;
    use lineshaft_core::function::Kind;
    use lineshaft_core::machine::Machine;

    fn config() -> MachineConfig {
        let slot =
            |name: &str, number, kind| SlotConfig { factor: 4, ..SlotConfig::new(name.to_owned(), number, kind) };
        let mut choose = slot("choose", 7, Kind::Ecopy);
        choose.sink = SinkConfig::Memory(0);
        let memory = lineshaft_core::config::MemoryConfig {
            name: "speed".to_owned(),
            kind: lineshaft_core::config::MemoryKind::I32,
            initial: 0.0,
        };
        let slots = vec![slot("cams", 2, Kind::Cam), choose];
        MachineConfig { cycle_ns: 1_000_000, memory: vec![memory], slots, ..MachineConfig::default() }
    }

    fn list(integer_array_value: &[i64]) -> ParameterValue {
        let integer_array_value = integer_array_value.to_vec();
        ParameterValue { r#type: ParameterType::PARAMETER_INTEGER_ARRAY, integer_array_value, ..Default::default() }
    }

    fn ask(name: &str, value: &ParameterValue) -> Result<Option<Staged>, String> {
        let config = config();
        Catalogue::new(&config).function(name).expect("a parameter").staged(value, &of_cell(&config))
    }

    #[test]
    fn every_field_and_the_structure_are_parameters_once() {
        let config = config();
        let catalogue = Catalogue::new(&config);
        let names: Vec<&str> = catalogue.functions().iter().map(|known| known.name.as_str()).collect();
        assert!(names.is_sorted() && names.windows(2).all(|pair| pair[0] != pair[1]), "{names:?}");
        let fields = |kind: Kind| kind.description().fields.len();
        assert_eq!(names.len(), fields(Kind::Cam) + fields(Kind::Ecopy) + 2 * 5);
        let image = Machine::new(config.clone()).expect("a sound machine").parameter_image();
        let value = |name: &str| catalogue.function(name).expect("a parameter").message(&image);
        assert_eq!((value("choose.slot"), value("choose.cycle_factor")), (integer(7), integer(4)));
        assert_eq!((value("choose.sink"), value("choose.source")), (text("speed".into()), text("none".into())));
        assert_eq!((value("cams.type"), value("cams.cams")), (text("cam".into()), list(&[0; 8])));
        assert_eq!(value("choose.mode"), integer(0));
    }

    #[test]
    fn a_descriptor_has_the_range_of_the_field() {
        let catalogue = Catalogue::new(&config());
        let descriptor = |name: &str| catalogue.function(name).expect("a parameter").descriptor();
        let value = descriptor("choose.value_e1_0");
        let range = IntegerRange { from_value: i32::MIN.into(), to_value: i32::MAX.into(), step: 1 };
        assert_eq!((value.r#type, value.read_only, value.integer_range), (2, false, Some(range).into()));
        assert_eq!(
            value.description,
            "value while E1 = 0. Takes effect with the next START or VALUE_NEW. Source: AMK-ECOPY-02."
        );
        let cams = descriptor("cams.hysteresis");
        assert_eq!((cams.r#type, cams.integer_range[0].to_value), (7, 65_535));
        assert!(cams.description.contains("Unit: 100 inc. Takes effect with the next START."), "{}", cams.description);
        assert_eq!(cams.additional_constraints, "1 to 8 values, of which the others stay");
        let kind = descriptor("cams.type");
        assert!(kind.read_only && kind.additional_constraints.starts_with("part of the cell"));
    }

    #[test]
    fn what_is_wrong_is_told_with_its_name_and_what_would_be_right() {
        for (name, value, sentence) in [
            (
                "choose.slot",
                integer(8),
                "choose.slot is read-only: part of the cell: changes with the file and a new start",
            ),
            ("choose.mode", list(&[1]), "choose.mode cannot be a list; an integer is needed"),
            ("cams.cams", integer(1), "cams.cams cannot be one number; a list of 1 to 8 integers is needed"),
            (
                "choose.mode",
                text("1".into()),
                "choose.mode cannot be a string; an integer or a list of integers is needed",
            ),
        ] {
            assert_eq!(ask(name, &value), Err(sentence.to_owned()));
        }
        assert_eq!(ask("choose.slot", &integer(7)), Ok(None), "as a dump says it again");
        let staged = ask("cams.cams", &list(&[0; 9])).expect("a list").expect("a value");
        let sentence = "cams: 9 values for cams; 1 to 8 are possible";
        assert_eq!(command(&config(), 0, vec![staged]), Err(sentence.to_owned()));
    }

    #[test]
    fn values_are_staged_and_shown_from_then_on() {
        let config = config();
        let mut machine = Machine::new(config.clone()).expect("a sound machine");
        let before = machine.parameter_image();
        let catalogue = Catalogue::new(&config);
        let staged = |name: &str, value: &ParameterValue| ask(name, value).expect("right").expect("a value");
        let pair = vec![staged("choose.value_e1_0", &integer(-5)), staged("choose.mode", &integer(3))];
        let action = command(&config, 1, pair).expect("right");
        let expected = CommandFunction { slot: 1, order: Order::Stage, values: [(1, -5), (0, 3)].into() };
        assert_eq!(action, Action::CommandFunction(expected));
        let beyond = command(&config, 1, vec![staged("choose.mode", &integer(4))]).expect("ranges are the machine's");
        let commands =
            [(1, action), (2, beyond)].map(|(sequence, action)| Command { sequence, source: Source::Ros, action });
        let (inputs, mut outputs) = (machine.inputs(), machine.outputs());
        machine.cycle(&inputs, Commands::queue(&commands), &mut outputs);
        let refused = machine.events().iter().filter(|event| event.kind == EventKind::Refused).count();
        assert_eq!(refused, 1, "4 is no mode");
        let after = machine.parameter_image();
        let changed = catalogue.functions().iter().filter(|known| !known.is_same(&before, &after));
        let changed: Vec<_> = changed.map(|known| (known.name.as_str(), known.message(&after))).collect();
        assert_eq!(changed, [("choose.mode", integer(3)), ("choose.value_e1_0", integer(-5))]);
        assert_eq!(after.functions[1].active, before.functions[1].active, "nothing but staged");
    }
}

//! Parameter descriptors: description, type and ranges.

use super::catalogue::{DeclaredParameter, PART_OF_CELL};
use lineshaft_core::parameter::{BorderRange, BorderValue, Measure, Range, Row, Storage, System, Value};
use lineshaft_core::unit::Scale;
use lineshaft_msgs::foreign::rcl_interfaces::msg::{FloatingPointRange, IntegerRange, ParameterDescriptor};

impl DeclaredParameter {
    pub(super) fn descriptor(&self) -> ParameterDescriptor {
        let range = self.row.shown_range(&self.scale);
        let (mut floating_point_range, mut integer_range) = (None, None);
        match range {
            Some(BorderRange::Integer { low, high, step }) => {
                integer_range = Some(IntegerRange { from_value: low, to_value: high, step });
            }
            Some(BorderRange::Real { low, high, step }) => {
                let high = self.limit().map_or(high, |limit| high.min(limit));
                floating_point_range = Some(FloatingPointRange { from_value: low, to_value: high, step });
            }
            None => {}
        }
        ParameterDescriptor {
            name: self.name.clone(),
            r#type: self.type_number(),
            description: description(self.row, &self.scale),
            additional_constraints: constraints(self.row, &self.scale),
            read_only: self.row.is_read_only(),
            // The parameter may be without a value, which is a separate type.
            dynamic_typing: self.may_be_unset(),
            floating_point_range: floating_point_range.into(),
            integer_range: integer_range.into(),
        }
    }
}

impl DeclaredParameter {
    /// Returns the limit of the range that the cycle time determines.
    fn limit(&self) -> Option<f64> {
        match self.row.to_border(&self.scale, Value::Real(self.highest_velocity)) {
            BorderValue::Real(limit) if self.row.is_bound_by_cycle() => Some(limit),
            _ => None,
        }
    }
}

/// Returns description, unit, time when a change takes effect, and source.
fn description(row: &Row, scale: &Scale) -> String {
    let mut parts = vec![row.description.to_owned()];
    let unit = row.border_unit(scale);
    if !unit.is_empty() {
        parts.push(format!("Unit: {unit}."));
    }
    if !row.is_read_only() {
        parts.push(format!("Takes effect {}.", row.effect.text()));
    }
    if row.storage == Storage::Volatile {
        parts.push("Is not saved.".to_owned());
    }
    if row.system != System::Native {
        let name = [row.system.name(), row.mnemonic, row.number].into_iter().filter(|part| !part.is_empty());
        parts.push(format!("{}.", name.collect::<Vec<_>>().join(" ")));
    }
    if row.is_view() {
        parts.push(format!("Another view of {}.", row.view_of));
    }
    parts.push(format!("Source: {}.", row.source));
    if !row.note.is_empty() {
        parts.push(row.note.to_owned());
    }
    parts.join(" ")
}

/// Returns the constraints that ranges cannot express.
fn constraints(row: &Row, scale: &Scale) -> String {
    let text = |value: Value| value_text(row, scale, value);
    let mut parts = Vec::new();
    match (row.measure, row.range) {
        (Measure::Choice(names), _) => parts.push(format!("one of {}", names.join(", "))),
        (_, Range::Among(ranges)) => {
            let one = |&(low, high): &(i64, i64)| match low == high {
                true => text(Value::Int(low)),
                false => format!("{} to {}", text(Value::Int(low)), text(Value::Int(high))),
            };
            parts.push(ranges.iter().map(one).collect::<Vec<_>>().join(", "));
        }
        (_, Range::PositiveUpTo(_)) => parts.push("more than 0".to_owned()),
        _ => {}
    }
    if !row.is_read_only() && is_outside(row.default, row.range) {
        parts.push(format!("and its default, {}", text(row.default)));
    }
    if row.default == Value::Unset && !row.is_read_only() && !row.required {
        parts.push(format!("left out: {}", row.default_text));
    }
    match row.storage {
        Storage::Cell => parts.push(PART_OF_CELL.to_owned()),
        Storage::Derived => parts.push("computed from other parameters".to_owned()),
        _ if !row.missing.is_empty() => {
            parts.push(format!("only {}: {}", text(row.default), row.missing_text()));
        }
        _ => {}
    }
    parts.join("; ")
}

/// Returns true if the value is outside the range; some sources have such default values.
fn is_outside(value: Value, range: Range) -> bool {
    match (value, range) {
        (Value::Unset, _) => false,
        (Value::Int(value), Range::Int(low, high)) => !(low..=high).contains(&value),
        (Value::Int(value), Range::Among(ranges)) => ranges.iter().all(|(low, high)| !(*low..=*high).contains(&value)),
        (Value::Real(value), Range::PositiveUpTo(high)) => !(value > 0.0 && value <= high),
        (Value::Real(value), Range::Real(low, high)) => !(low..=high).contains(&value),
        _ => true,
    }
}

fn value_text(row: &Row, scale: &Scale, value: Value) -> String {
    match row.to_border(scale, value) {
        BorderValue::Unset => "nothing".to_owned(),
        BorderValue::Switch(is_on) => is_on.to_string(),
        BorderValue::Integer(number) => number.to_string(),
        BorderValue::Real(number) => number.to_string(),
        BorderValue::Name(name) => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::catalogue::Catalogue;
    use super::super::fake;
    use super::*;
    use lineshaft_core::drive::Interface;

    fn descriptor(name: &str) -> ParameterDescriptor {
        Catalogue::new(&fake::config()).find(name).expect("a declared parameter").descriptor()
    }

    #[test]
    fn a_descriptor_says_what_where_and_when() {
        let velocity = descriptor("x.max_velocity");
        assert_eq!((velocity.r#type, velocity.read_only, velocity.dynamic_typing), (3, false, false));
        assert_eq!(
            velocity.description,
            "Highest velocity; a goal that asks for more is refused. Unit: m/s. Takes effect with the next motion command. \
             Source: MACS-PROF-01."
        );
        assert_eq!(velocity.additional_constraints, "more than 0");
        let range = &velocity.floating_point_range[0];
        assert_eq!((range.from_value, range.step), (0.0, 0.0));
        // 2^31 increments per cycle of 1 ms at 1000 inc/mm.
        assert_eq!(range.to_value, 2_147_483.648);
        assert!(velocity.integer_range.is_empty());
    }

    #[test]
    fn constraints_describe_gaps_and_missing_values() {
        let low = descriptor("x.min_position");
        assert_eq!(low.additional_constraints, "left out: no limit");
        assert!(low.dynamic_typing, "it may be without a value");
        // One increment is one micrometre.
        assert_eq!(low.floating_point_range[0].step, 1e-6);
        let node_id = descriptor("machine.cannr");
        assert_eq!(
            node_id.additional_constraints,
            "0 to 127, 9999; only 0: a node id other than by key master of the bus in the cell does not exist yet"
        );
        assert_eq!(node_id.integer_range[0], IntegerRange { from_value: 0, to_value: 9999, step: 1 });
        let mut config = fake::config();
        config.axes.iter_mut().for_each(|axis| axis.interface = Interface::Torque);
        let amplifier = Catalogue::new(&config).find("x.ampencrpm").expect("a declared parameter").descriptor();
        let constraints = amplifier.additional_constraints;
        assert!(
            amplifier.integer_range[0].from_value > 0 && constraints.starts_with("and its default, 0"),
            "{constraints}"
        );
        assert_eq!(descriptor("x.profile").additional_constraints, "one of trapezoid, s_ramp, jerk");
        let computed = descriptor("x.velmaxqc");
        assert!(computed.read_only && computed.additional_constraints == "computed from other parameters");
        let view = descriptor("x.velmax");
        assert!(view.description.contains("Unit: rpm.") && view.description.contains("Another view of max_velocity."));
        assert!(view.description.contains("MACS VELMAX 1."));
    }
}

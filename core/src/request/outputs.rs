//! Conversion of requests that set outputs.

use super::{RequestError, list};
use crate::command::{Action, OutputValue};
use crate::config::{IoKind, MachineConfig};
use crate::unit::{excerpt, number_to_text};

impl MachineConfig {
    /// Converts values of outputs, by name, to a command: 0 or 1 for a digital output, otherwise V within the full
    /// scale.
    ///
    /// # Errors
    /// No name, an unknown or repeated name, a value that the output cannot have.
    pub fn resolve_set_output<S: AsRef<str>>(&self, given: &[(S, f64)]) -> Result<Action, RequestError> {
        if given.is_empty() {
            return Err(RequestError::SetsNothing("output"));
        }
        let mut values: Vec<OutputValue> = Vec::new();
        for (name, value) in given {
            let name = name.as_ref();
            let (index, kind) = self.find_output(name)?;
            if values.iter().any(|known| known.index == index) {
                return Err(RequestError::SetTwice { what: "output", name: name.to_owned() });
            }
            let full = self.full_scale(index);
            let (fits, allowed) = match kind {
                IoKind::AnalogOutput => (value.abs() <= full, format!("-{full} V to {full} V")),
                _ => (*value == 0.0 || *value == 1.0, "0 or 1".to_owned()),
            };
            if !fits {
                let (name, value) = (name.to_owned(), number_to_text(*value));
                return Err(RequestError::BadParameter { name, value, allowed });
            }
            // A digital output has no -0, which a recording would not keep.
            values.push(OutputValue { index, value: if kind == IoKind::AnalogOutput { *value } else { value.abs() } });
        }
        Ok(Action::SetOutputs(values.into()))
    }

    /// Returns index and kind of the output of that name.
    fn find_output(&self, name: &str) -> Result<(u16, IoKind), RequestError> {
        let is_output = |kind| matches!(kind, IoKind::DigitalOutput | IoKind::AnalogOutput);
        let outputs = || self.io.iter().enumerate().filter(|(_, io)| is_output(io.kind));
        let found = outputs().find(|(_, io)| io.name == name);
        found.and_then(|(index, io)| Some((u16::try_from(index).ok()?, io.kind))).ok_or_else(|| {
            RequestError::UnknownWord {
                what: "output",
                name: excerpt(name),
                known: list(outputs().map(|(_, io)| io.name.clone())),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{FullScale, GlobalConfig, IoConfig};

    #[test]
    fn outputs_are_found_by_name_and_have_values_that_they_can_have() {
        let entry = |name: &str, kind| IoConfig { name: name.to_owned(), kind, latch: false };
        let io = vec![
            entry("start", IoKind::DigitalInput),
            entry("speed", IoKind::AnalogOutput),
            entry("lamp", IoKind::DigitalOutput),
            entry("brake", IoKind::AnalogOutput),
        ];
        let global = GlobalConfig { full_scales: vec![FullScale { entry: 3, volts: 5.0 }], ..GlobalConfig::default() };
        let config = MachineConfig { io, global, ..MachineConfig::default() };
        let values = |given: &[(&str, f64)]| match config.resolve_set_output(given) {
            Ok(Action::SetOutputs(values)) => {
                Ok(values.iter().map(|value| (value.index, value.value.to_bits())).collect::<Vec<_>>())
            }
            Ok(other) => panic!("{other:?}"),
            Err(error) => Err(error.to_string()),
        };
        // A recording keeps -0 of a voltage, but not of a bit.
        assert_eq!(values(&[("lamp", -0.0), ("speed", -0.0)]), Ok(vec![(2, 0), (1, (-0.0_f64).to_bits())]));
        // The full scale itself is in the range.
        assert_eq!(values(&[("speed", -10.0), ("brake", 5.0)]).map(|values| values.len()), Ok(2));
        for (given, sentence) in [
            (&[("start", 1.0)][..], "no output is called `start`; there are speed, lamp, brake"),
            (&[("lamp", 0.5)], "lamp is `0.5`; 0 or 1 is expected"),
            (&[("lamp", f64::NAN)], "lamp is `NaN`; 0 or 1 is expected"),
            (&[("speed", f64::NEG_INFINITY)], "speed is `-inf`; -10 V to 10 V is expected"),
            (&[("speed", f64::NAN)], "speed is `NaN`; -10 V to 10 V is expected"),
            (&[("speed", 12.0)], "speed is `12`; -10 V to 10 V is expected"),
            (&[("speed", -10.5)], "speed is `-10.5`; -10 V to 10 V is expected"),
            (&[("brake", 5.5)], "brake is `5.5`; -5 V to 5 V is expected"),
            (&[("lamp", 1.0), ("speed", 1.0), ("lamp", 1.0)], "output `lamp` stands twice; once is allowed"),
            (&[], "no output is named; one or more, each with a value, are expected"),
        ] {
            assert_eq!(values(given), Err(sentence.to_owned()));
        }
        let none = MachineConfig::default().resolve_set_output(&[("lamp", 1.0)]).unwrap_err();
        assert_eq!(none.to_string(), "no output is called `lamp`; there are none");
    }
}

//! Conversion of requests that set memory cells.

use super::{RequestError, list};
use crate::command::{Action, MemoryValue};
use crate::config::{MachineConfig, MemoryKind};
use crate::unit::{excerpt, number_to_text};

impl MemoryKind {
    /// Returns the minimum and the maximum of a cell of whole numbers; `None` for a real one.
    pub fn whole_range(self) -> Option<(i64, i64)> {
        match self {
            Self::Bit => Some((0, 1)),
            Self::I16 => Some((i16::MIN.into(), i16::MAX.into())),
            Self::I32 => Some((i32::MIN.into(), i32::MAX.into())),
            Self::I64 => Some((i64::MIN, i64::MAX)),
            Self::F64 => None,
        }
    }
}

/// Returns true if a cell can hold that value exactly.
fn fits(kind: MemoryKind, value: f64) -> bool {
    match kind.whole_range() {
        // A value with a fraction fails; a saturated cast is beyond every range.
        Some((min, max)) => value.fract() == 0.0 && (i128::from(min)..=max.into()).contains(&(value as i128)),
        None => value.is_finite(),
    }
}

impl MachineConfig {
    /// Converts values of memory cells, by name, to a command.
    ///
    /// # Errors
    /// No name, an unknown or repeated name, a value that the cell cannot hold.
    pub fn resolve_set_memory<S: AsRef<str>>(&self, given: &[(S, f64)]) -> Result<Action, RequestError> {
        if given.is_empty() {
            return Err(RequestError::SetsNothing("memory cell"));
        }
        let mut values: Vec<MemoryValue> = Vec::new();
        for (name, value) in given {
            let name = name.as_ref();
            let found = (0_u16..).zip(&self.memory).find(|(_, entry)| entry.name == name);
            let (index, kind) = found.map(|(index, entry)| (index, entry.kind)).ok_or_else(|| {
                let known = list(self.memory.iter().map(|entry| entry.name.clone()));
                RequestError::UnknownWord { what: "memory cell", name: excerpt(name), known }
            })?;
            if values.iter().any(|known| known.index == index) {
                return Err(RequestError::SetTwice { what: "memory cell", name: name.to_owned() });
            }
            if !fits(kind, *value) {
                let allowed = match kind.whole_range() {
                    Some((min, max)) => format!("a whole number from {min} to {max}"),
                    None => "a finite number".to_owned(),
                };
                let (name, value) = (name.to_owned(), number_to_text(*value));
                return Err(RequestError::BadParameter { name, value, allowed });
            }
            // A whole number has no -0, which a recording would not keep.
            values.push(MemoryValue { index, value: if kind == MemoryKind::F64 { *value } else { *value + 0.0 } });
        }
        Ok(Action::SetMemory(values.into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::MemoryConfig;

    #[test]
    fn cells_are_found_by_name_and_have_values_that_they_can_have() {
        let entry = |name: &str, kind| MemoryConfig { name: name.to_owned(), kind, initial: 0.0 };
        let memory = vec![
            entry("w", MemoryKind::I16),
            entry("d", MemoryKind::I32),
            entry("l", MemoryKind::I64),
            entry("r", MemoryKind::F64),
            entry("b", MemoryKind::Bit),
        ];
        let config = MachineConfig { memory, ..MachineConfig::default() };
        let values = |given: &[(&str, f64)]| match config.resolve_set_memory(given) {
            Ok(Action::SetMemory(values)) => {
                Ok(values.iter().map(|value| (value.index, value.value.to_bits())).collect::<Vec<_>>())
            }
            Ok(other) => panic!("{other:?}"),
            Err(error) => Err(error.to_string()),
        };
        let bits = f64::to_bits;
        assert_eq!(values(&[("r", -0.0), ("w", -0.0), ("b", 1.0)]), Ok(vec![(3, bits(-0.0)), (0, 0), (4, bits(1.0))]));
        for (name, index, ends) in [
            ("w", 0, [-32_768.0, 32_767.0]),
            ("d", 1, [-2_147_483_648.0, 2_147_483_647.0]),
            ("l", 2, [-9_223_372_036_854_775_808.0, 9_223_372_036_854_774_784.0]),
        ] {
            for value in ends {
                assert_eq!(values(&[(name, value)]), Ok(vec![(index, bits(value))]));
            }
        }
        for (given, sentence) in [
            (&[("w", 32_768.0)][..], "w is `32768`; a whole number from -32768 to 32767 is expected"),
            (&[("w", -32_769.0)], "w is `-32769`; a whole number from -32768 to 32767 is expected"),
            (&[("d", 0.5)], "d is `0.5`; a whole number from -2147483648 to 2147483647 is expected"),
            (&[("d", f64::NAN)], "d is `NaN`; a whole number from -2147483648 to 2147483647 is expected"),
            (&[("b", 2.0)], "b is `2`; a whole number from 0 to 1 is expected"),
            (&[("b", -1.0)], "b is `-1`; a whole number from 0 to 1 is expected"),
            (&[("r", f64::INFINITY)], "r is `inf`; a finite number is expected"),
            (&[("w", 1.0), ("q", 1.0)], "no memory cell is called `q`; there are w, d, l, r, b"),
            (&[("w", 1.0), ("w", 1.0)], "memory cell `w` stands twice; once is allowed"),
            (&[], "no memory cell is named; one or more, each with a value, are expected"),
        ] {
            assert_eq!(values(given), Err(sentence.to_owned()));
        }
        for beyond in [9_223_372_036_854_775_808.0, -9_223_372_036_854_777_856.0, f64::INFINITY, f64::NEG_INFINITY] {
            let sentence = values(&[("l", beyond)]).expect_err("beyond the range");
            assert!(sentence.ends_with("a whole number from -9223372036854775808 to 9223372036854775807 is expected"));
        }
    }
}

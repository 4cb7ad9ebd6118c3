//! Parameters of the machine (GL), and the meaning of single numbers.

use super::rows::ROWS;
use super::{Applies, Row, Storage, Value};
use serde::{Deserialize, Serialize};

/// Parameters of the machine. Inputs and outputs by number: n, -n inverted, 0 none.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MachineParameters {
    /// I_BREAK
    pub i_break: i64,
    /// I_CONTINUE
    pub i_continue: i64,
    /// I_ERRCLR
    pub i_errclr: i64,
    /// O_ERROR
    pub o_error: i64,
    /// AINFTIME: number of readings at 1 ms; 0: no filter.
    pub ainftime: i64,
    /// VMENCTYP
    pub vmenctyp: i64,
    /// VMENCRES (inc)
    pub vmencres: i64,
    /// VMENCMTYP
    pub vmencmtyp: i64,
    /// PULSVEL (inc/s)
    pub pulsvel: i64,
    /// PULSACC (inc/s^2); 0: no virtual master, -1: `setsys_15` is its velocity.
    pub pulsacc: i64,
    /// SETSYS 15 (inc/s)
    pub setsys_15: i64,
}

impl Default for MachineParameters {
    fn default() -> Self {
        let mut parameters = Self {
            i_break: 0,
            i_continue: 0,
            i_errclr: 0,
            o_error: 0,
            ainftime: 0,
            vmenctyp: 0,
            vmencres: 0,
            vmencmtyp: 0,
            pulsvel: 0,
            pulsacc: 0,
            setsys_15: 0,
        };
        for row in ROWS.iter().filter(|row| row.is_kept_by_machine()) {
            (row.set_machine)(&mut parameters, row.default);
        }
        parameters
    }
}

impl MachineParameters {
    /// Returns the values to save: volatile values are those of `init`.
    pub fn saved(&self, init: &Self) -> Self {
        let mut saved = *self;
        for row in ROWS.iter().filter(|row| row.is_kept_by_machine() && row.storage != Storage::User) {
            (row.set_machine)(&mut saved, row.machine_value(init));
        }
        saved
    }

    /// Returns true if every value is within the range of its row.
    pub fn is_sound(&self) -> bool {
        ROWS.iter().filter(|row| row.is_kept_by_machine()).all(|row| row.check(row.machine_value(self)).is_ok())
    }
}

impl Row {
    /// Returns true if the machine has a value of the row that can be set.
    pub fn is_kept_by_machine(&self) -> bool {
        self.applies == Applies::Machine && self.missing.is_empty() && !self.is_read_only()
    }

    /// Returns the value of the machine.
    pub fn machine_value(&self, parameters: &MachineParameters) -> Value {
        if self.is_kept_by_machine() { (self.get_machine)(parameters) } else { self.default }
    }

    /// Checks a value of the machine and sets it.
    ///
    /// # Errors
    /// The reason; nothing is changed then.
    pub fn assign_to_machine(&self, parameters: &mut MachineParameters, value: Value) -> Result<(), super::Refused> {
        self.check(value)?;
        if self.is_kept_by_machine() {
            (self.set_machine)(parameters, value);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameter::Range;

    /// Every implemented row of the machine has a value of its own.
    #[test]
    fn each_row_of_the_machine_has_a_value_of_its_own() {
        let rows: Vec<_> = ROWS.iter().filter(|row| row.is_kept_by_machine()).collect();
        assert_eq!(rows.len(), 11);
        for row in &rows {
            let mut parameters = MachineParameters::default();
            assert_eq!(row.machine_value(&parameters), row.default, "{}", row.key);
            // The last value of its range.
            let value = match row.range {
                Range::Int(_, high) => Value::Int(high),
                Range::Among(ranges) => Value::Int(ranges.last().unwrap().1),
                _ => panic!("{} is no whole number", row.key),
            };
            row.assign_to_machine(&mut parameters, value).unwrap();
            for other in &rows {
                let expected = if other.key == row.key { value } else { other.default };
                assert_eq!(other.machine_value(&parameters), expected, "{} by {}", other.key, row.key);
            }
            assert!(parameters.is_sound());
        }
    }
    #[test]
    fn virtual_master_velocities_are_not_saved() {
        let init = MachineParameters { pulsacc: 500, ..MachineParameters::default() };
        let now = MachineParameters { pulsvel: 7, pulsacc: 8, setsys_15: 9, vmenctyp: 100, o_error: 1, ..init };
        assert_eq!(now.saved(&init), MachineParameters { vmenctyp: 100, o_error: 1, ..init });
    }
}

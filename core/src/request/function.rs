//! Conversion of requests to functions and tables: names to indices.

use super::{RequestError, list};
use crate::command::{Action, CommandFunction, RunFunction};
use crate::config::{MachineConfig, SlotConfig};
use crate::function::Order;
use crate::table::{CamSetting, Table, first_non_rising};
use crate::unit::excerpt;
use lineshaft_program::Module;
use std::sync::Arc;

/// Values of one field.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FieldValue {
    /// The value of a field with one value; the first value of a list.
    One(i64),
    /// The first values of a list.
    List(Vec<i64>),
}

/// A command to a function, with values that it stages first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FunctionRequest {
    /// Name of the function.
    pub function: String,
    /// The command.
    pub order: Order,
    /// Values by the names of their fields; `cams[2]` is a value of a list.
    pub values: Vec<(String, FieldValue)>,
}

impl MachineConfig {
    /// Returns the function of that name, and its index among the slots.
    ///
    /// # Errors
    /// No function has that name.
    pub fn find_function(&self, name: &str) -> Result<(u16, &SlotConfig), RequestError> {
        let found = (0..).zip(&self.slots).find(|(_, slot)| slot.name == name);
        found.ok_or_else(|| RequestError::UnknownFunction {
            name: excerpt(name),
            known: list(self.slots.iter().map(|slot| slot.name.clone())),
        })
    }

    /// Returns the index of the table of that name.
    ///
    /// # Errors
    /// No table has that name.
    pub fn find_table(&self, name: &str) -> Result<u16, RequestError> {
        let found = (0..).zip(&self.tables).find(|(_, table)| table.name == name).map(|(place, _)| place);
        found.ok_or_else(|| RequestError::UnknownTable {
            name: excerpt(name),
            known: list(self.tables.iter().map(|table| table.name.clone())),
        })
    }

    /// Returns the index of the program of that name.
    ///
    /// # Errors
    /// No program has that name.
    pub fn find_program(&self, name: &str) -> Result<u16, RequestError> {
        let found = (0..).zip(&self.programs).find(|(_, program)| program.name == name).map(|(place, _)| place);
        found.ok_or_else(|| RequestError::UnknownProgram {
            name: excerpt(name),
            known: list(self.programs.iter().map(|program| program.name.clone())),
        })
    }

    /// Converts a new module of a program to a command; its functions continue with their state if `keeps` is set.
    ///
    /// # Errors
    /// An error in the request itself.
    pub fn resolve_load_program(&self, name: &str, module: &[u8], keeps: bool) -> Result<Action, RequestError> {
        let index = self.find_program(name)?;
        let module = Module::load(module)
            .map_err(|refused| RequestError::BadProgram { name: excerpt(name), sentence: refused.to_string() })?;
        Ok(Action::LoadProgram { index, module: Arc::new(module), keeps })
    }

    /// Converts a command to a function.
    ///
    /// # Errors
    /// An error in the request itself. The machine checks ranges, and reports a violation as the error of the function.
    pub fn resolve_function(&self, request: &FunctionRequest) -> Result<Action, RequestError> {
        let (slot, config) = self.find_function(&request.function)?;
        let values = placed(config, &request.values)?;
        Ok(Action::CommandFunction(CommandFunction { slot, order: request.order, values }))
    }

    /// Converts a goal of a function to a command; its values are given as for [`FunctionRequest`].
    ///
    /// # Errors
    /// An error in the request itself.
    pub fn resolve_run(&self, function: &str, values: &[(String, FieldValue)]) -> Result<Action, RequestError> {
        let (slot, config) = self.find_function(function)?;
        Ok(Action::RunFunction(RunFunction { slot, values: placed(config, values)? }))
    }

    /// Converts new numbers of a table to a command; `x` is empty except for form xy.
    ///
    /// # Errors
    /// An error in the request itself.
    pub fn resolve_load_table(&self, name: &str, x: &[i64], y: &[i64]) -> Result<Action, RequestError> {
        let index = self.find_table(name)?;
        let present = self.tables.get(usize::from(index));
        let form = present.map(|present| present.table.form()).unwrap_or(crate::table::Form::Y);
        let setting = present.map(|present| present.table.cam_setting()).unwrap_or_default();
        let bad = |sentence: String| RequestError::BadTable { name: excerpt(name), sentence };
        // The same check and message as in the cell.
        if let Some((_, sentence)) = first_non_rising(x) {
            return Err(bad(sentence));
        }
        let table = Table::new(form, x, y).map_err(|error| bad(error.to_string()))?.with_cam(setting);
        // Key `cam` declares a cam. Without the key any curve is valid until an axis follows it.
        if self.global.cams.contains(&index) || setting != CamSetting::default() {
            table.cam().map_err(|error| bad(error.to_string()))?;
        }
        Ok(Action::LoadTable { index, table: Arc::new(table) })
    }
}

/// Returns the values with their indices in the set.
fn placed(config: &SlotConfig, given: &[(String, FieldValue)]) -> Result<Box<[(u16, i64)]>, RequestError> {
    let mut values: Vec<(u16, i64)> = Vec::new();
    for (name, value) in given {
        let (first, count) = place(config, name)?;
        let given: &[i64] = match value {
            FieldValue::One(value) => std::slice::from_ref(value),
            FieldValue::List(values) => values,
        };
        if given.is_empty() || given.len() > count {
            let (field, given) = (excerpt(name), given.len());
            return Err(RequestError::FieldCount { function: config.name.clone(), field, given, most: count });
        }
        for (place, value) in (first..).zip(given) {
            if values.iter().any(|(known, _)| *known == place) {
                return Err(RequestError::FieldTwice { function: config.name.clone(), field: excerpt(name) });
            }
            values.push((place, *value));
        }
    }
    Ok(values.into())
}

/// Returns the index of the first value of a field in the set, and the number of values from there on.
fn place(config: &SlotConfig, name: &str) -> Result<(u16, usize), RequestError> {
    let row = config.kind.description();
    let (field, nth) = match name.strip_suffix(']').and_then(|name| name.split_once('[')) {
        Some((field, nth)) => (field, nth.parse::<usize>().ok()),
        None => (name, Some(0)),
    };
    let found = row.find(field).zip(nth).filter(|((field, _), nth)| *nth < field.count);
    match found {
        Some(((field, first), nth)) => {
            let count = if name.ends_with(']') { 1 } else { field.count };
            Ok((u16::try_from(first + nth).unwrap_or(u16::MAX), count))
        }
        None => Err(RequestError::UnknownField {
            function: config.name.clone(),
            kind: row.name,
            field: excerpt(name),
            known: list(row.fields.iter().map(|field| match field.count {
                1 => field.name.to_owned(),
                count => format!("{}[0..{}]", field.name, count - 1),
            })),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{GlobalConfig, TableConfig};
    use crate::table::{Form, Interpolation};

    #[test]
    fn load_table_refuses_numbers_that_the_cell_refuses() {
        let table = |name: &str, setting| {
            let table = Table::new(Form::Xy, &[0, 10, 20], &[0, 5, 0]).unwrap().with_cam(setting);
            TableConfig { name: name.to_owned(), table: Arc::new(table) }
        };
        let cubic = CamSetting { interpolation: Interpolation::Cubic, ..CamSetting::default() };
        let tables = vec![table("curve", CamSetting::default()), table("cam", cubic)];
        let tables = [tables, vec![table("plain", CamSetting::default())]].concat();
        let global = GlobalConfig { cams: vec![2], ..GlobalConfig::default() };
        let config = MachineConfig { tables, global, ..MachineConfig::default() };
        let load = |name, x: &[i64], y: &[i64]| {
            config.resolve_load_table(name, x, y).map(|_| ()).map_err(|error| error.to_string())
        };
        let falls = load("curve", &[0, 9, 8], &[0, 1, 2]).unwrap_err();
        assert!(falls.ends_with("place 8 is not after 9, the one before it; places rise"), "{falls}");
        let stands = load("cam", &[0, 9, 9], &[0, 1, 2]).unwrap_err();
        assert!(stands.ends_with("place 9 is not after 9, the one before it; places rise"), "{stands}");
        // A periodic cubic spline needs three points. A curve needs only two.
        let few = load("cam", &[0, 10], &[0, 5]).unwrap_err();
        assert!(few.ends_with("a cam has 2 points; 3 or more are needed"), "{few}");
        assert_eq!(load("curve", &[0, 10], &[0, 5]), Ok(()));
        assert_eq!(load("cam", &[0, 10, 30], &[0, 5, 0]), Ok(()));
        // `cam: {}` declares a cam as well.
        let few = load("plain", &[0], &[0]).unwrap_err();
        assert!(few.ends_with("a cam has 1 points; 2 or more are needed"), "{few}");
        assert!(load("plain", &[5, 10], &[0, 10]).is_err(), "a cam begins at place 0");
        assert_eq!((load("curve", &[5, 10], &[0, 10]), load("plain", &[0, 10], &[0, 10])), (Ok(()), Ok(())));
    }
}

//! Runs a program without a machine: reads inputs from a CSV file, and returns a table of the results.
//!
//! Law      one call per row; sink, outputs and memory cells are kept from call to call as in a slot
//! Refuses  unknown columns, and values that are no numbers, with line and column

use crate::document::Place;
use lineshaft_core::unit::excerpt;
use lineshaft_program::{Command, Image, Instance, Module, PARAMETERS, Trap, WORDS};

/// A column of the inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Column {
    /// Values 0, 1 or 255.
    Command,
    /// E1 in bit 0 to E8 in bit 7.
    Inputs,
    Source,
    Travel,
    /// Index of a signal that is read.
    Read(usize),
    /// Index of a parameter.
    Parameter(usize),
}

/// Names of the columns that occur once.
const COLUMNS: [(&str, Column); 4] =
    [("command", Column::Command), ("inputs", Column::Inputs), ("source", Column::Source), ("travel", Column::Travel)];

impl Column {
    /// Returns the column with this name.
    fn find(name: &str) -> Option<Self> {
        let nth = |before: &str, most: usize| {
            let nth = name.strip_prefix(before)?.parse::<usize>().ok()?;
            (1..=most).contains(&nth).then_some(nth - 1)
        };
        let alone = COLUMNS.iter().find(|(known, _)| *known == name).map(|(_, column)| *column);
        alone
            .or_else(|| nth("read", WORDS).map(Self::Read))
            .or_else(|| nth("parameter", PARAMETERS).map(Self::Parameter))
    }
}

/// Error in the inputs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct TrialError {
    pub place: Place,
    pub sentence: String,
}

/// Parses a value: a signal may be a real, with a decimal point or an exponent.
fn value(column: Column, text: &str) -> Result<u64, String> {
    let whole = |least: i64, most: i64| match text.parse::<i64>() {
        Ok(number) if (least..=most).contains(&number) => Ok(number.cast_unsigned()),
        _ => Err(format!("`{}` is no whole number from {least} to {most}", excerpt(text))),
    };
    match column {
        Column::Command => match text {
            "0" | "1" | "255" => whole(0, 255),
            _ => Err(format!("`{}` is no command; 0 RESET, 1 START, 255 none are possible", excerpt(text))),
        },
        Column::Inputs => whole(0, 255),
        Column::Source | Column::Travel => whole(i64::MIN, i64::MAX),
        Column::Parameter(_) => whole(i32::MIN.into(), i32::MAX.into()),
        Column::Read(_) => match (text.parse::<i64>(), text.parse::<f64>()) {
            (Ok(number), _) => Ok(number.cast_unsigned()),
            (_, Ok(number)) if number.is_finite() => Ok(number.to_bits()),
            _ => Err(format!("`{}` is no number", excerpt(text))),
        },
    }
}

/// Result of a call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Row {
    pub line: usize,
    pub command: u8,
    pub sink: i64,
    pub outputs: u8,
    /// Values of the requested memory cells.
    pub writes: Vec<u64>,
    pub fuel: u32,
    /// Reason why the call did not finish.
    pub trap: Option<Trap>,
}

/// A program and its state.
pub(crate) struct Trial<'m> {
    module: &'m Module,
    instance: Instance,
    fuel: u32,
    columns: Vec<Column>,
    has_begun: bool,
}

impl<'m> Trial<'m> {
    /// Creates a trial with a maximum number of instructions per call.
    pub(crate) fn new(module: &'m Module, fuel: u32) -> Self {
        let instance = Instance::new(module, module.pages());
        Self { module, instance, fuel, columns: Vec::new(), has_begun: false }
    }

    /// Runs all rows of a text until a trap, and passes each to `tell`.
    pub(crate) fn run(&mut self, text: &str, call_ns: u64, mut tell: impl FnMut(&Row)) -> Result<(), TrialError> {
        for (number, line) in (1..).zip(text.lines()) {
            let data = line.split('#').next().unwrap_or_default();
            if data.trim().is_empty() {
                continue;
            }
            let parts = parts(data);
            let error = |col: usize, sentence| TrialError { place: Place { line: number, col }, sentence };
            if self.columns.is_empty() {
                for (col, name) in parts {
                    let column = Column::find(name).filter(|column| !self.columns.contains(column));
                    self.columns.push(column.ok_or_else(|| {
                        let sentence =
                            "command, inputs, source, travel, read1 to read16, parameter1 to parameter16, each once";
                        error(col, format!("`{}` is no column; {sentence} are possible", excerpt(name)))
                    })?);
                }
                continue;
            }
            if parts.len() != self.columns.len() {
                let sentence = format!("{} values stand in a row of {} columns", parts.len(), self.columns.len());
                return Err(error(1, sentence));
            }
            let mut values = Vec::new();
            for ((col, text), column) in parts.into_iter().zip(&self.columns) {
                values.push((*column, value(*column, text).map_err(|sentence| error(col, sentence))?));
            }
            let row = self.call(number, &values, call_ns);
            let is_over = row.trap.is_some();
            tell(&row);
            if is_over {
                break;
            }
        }
        Ok(())
    }

    fn call(&mut self, line: usize, values: &[(Column, u64)], call_ns: u64) -> Row {
        let given = values.iter().find(|(column, _)| *column == Column::Command).map(|(_, value)| *value);
        let command = match given {
            Some(0) => Command::Reset,
            Some(1) => Command::Start,
            None if !self.has_begun => Command::Start,
            _ => Command::None,
        };
        self.has_begun = true;
        let mut image = self.instance.image(self.module);
        image.set_command(command);
        image.set_call_ns(call_ns);
        give(&mut image, values);
        let (fuel, trap) = match self.instance.call(self.module, self.fuel) {
            Ok(fuel) => (fuel, None),
            Err((trap, fuel)) => (fuel, Some(trap)),
        };
        let image = self.instance.image(self.module);
        let writes = (0..WORDS).map(|place| image.write(place)).collect();
        Row { line, command: command as u8, sink: image.sink(), outputs: image.outputs(), writes, fuel, trap }
    }
}

/// Writes the values of a row into the image.
fn give(image: &mut Image<'_>, values: &[(Column, u64)]) {
    let find = |wanted| values.iter().find(|(column, _)| *column == wanted).map_or(0, |(_, value)| value.cast_signed());
    image.set_source(find(Column::Source), find(Column::Travel));
    // In range 0 to 255.
    image.set_inputs(find(Column::Inputs) as u8);
    for (column, value) in values {
        match column {
            Column::Read(place) => image.set_read(*place, *value),
            Column::Parameter(place) => image.set_parameter(*place, value.cast_signed()),
            _ => {}
        }
    }
}

/// Splits a line at commas; returns the parts with their columns, from 1.
fn parts(data: &str) -> Vec<(usize, &str)> {
    let mut parts = Vec::new();
    let mut from = 0;
    for part in data.split(',') {
        let before = data.get(..from).unwrap_or_default().chars().count();
        let blank = part.chars().take_while(|sign| sign.is_whitespace()).count();
        parts.push((before + blank + 1, part.trim()));
        from += part.len() + 1;
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    const FB10: &[u8] = include_bytes!("../../../launch-configs/functions/programs/fb10.wasm");

    fn run(text: &str) -> Result<Vec<(u8, i64)>, TrialError> {
        let module = Module::load(FB10).unwrap();
        let mut rows = Vec::new();
        Trial::new(&module, 1000).run(text, 2_000_000, |row| rows.push((row.command, row.sink)))?;
        Ok(rows)
    }

    /// Proves: AMK-APSF-46
    #[test]
    fn fb10_is_tried_against_rows_of_inputs() {
        let rows =
            run("# a foreign encoder\ninputs, source\n1, 100\n1,110 # ten on\n0,200\n1,210\n\n1,-32000\n").unwrap();
        assert_eq!(rows, [(1, 0), (255, 150_000), (255, 0), (255, 150_000), (255, -32_210 * 15_000)]);
        let rows = run("command,inputs,source\n1,1,5\n255,1,6\n0,1,7\n").unwrap();
        assert_eq!(rows, [(1, 0), (255, 15_000), (0, 0)]);
    }

    #[test]
    fn errors_are_reported_with_their_places() {
        let error = |text: &str| {
            let TrialError { place, sentence } = run(text).unwrap_err();
            (place.line, place.col, sentence)
        };
        assert_eq!(error("inputs,  sorce\n"), (1, 10, "`sorce` is no column; command, inputs, source, travel, read1 to read16, parameter1 to parameter16, each once are possible".to_owned()));
        assert_eq!(error("source,source\n").1, 8);
        assert_eq!(error("read17\n").1, 1);
        assert_eq!(error("inputs,source\n1\n"), (2, 1, "1 values stand in a row of 2 columns".to_owned()));
        assert_eq!(error("inputs\n\n256\n"), (3, 1, "`256` is no whole number from 0 to 255".to_owned()));
        assert_eq!(error("command\n7\n").2, "`7` is no command; 0 RESET, 1 START, 255 none are possible");
        assert_eq!(error("source, read1\n1, nan\n"), (2, 4, "`nan` is no number".to_owned()));
    }

    #[test]
    fn a_trap_ends_it() {
        let module = Module::load(FB10).unwrap();
        let mut rows = Vec::new();
        Trial::new(&module, 3).run("source\n1\n2\n", 1, |row| rows.push(row.clone())).unwrap();
        assert_eq!((rows.len(), rows[0].trap, rows[0].fuel), (1, Some(Trap::OutOfFuel), 3));
    }
}

//! Writes traced signals as CSV.
//!
//! Law      a header `cycle,time_s,<signal>..`, then a row per traced cycle with the values at its end: integers,
//!          enums, bits and words as integers, reals as the shortest decimal that is read back unchanged, the time as
//!          an exact decimal; LF
//! Source   contract section 5

use super::{Scenario, moment};
use lineshaft_core::signal::{Board, Directory, Signal, Type, Value as Number};
use std::fmt::Write as _;
use std::io::{self, Write};

/// Writes the traced signals of a scenario.
#[derive(Debug)]
pub struct Trace<W: Write> {
    writer: W,
    signals: Vec<(Signal, Type)>,
    every: u64,
    cycle_ns: u64,
    row: String,
}

impl<W: Write> Trace<W> {
    /// Writes the header. `directory` is that of the machine on which the scenario runs.
    ///
    /// # Errors
    /// Returns the error of the writer.
    pub fn new(mut writer: W, scenario: &Scenario, directory: &Directory) -> io::Result<Self> {
        let plan = &scenario.0;
        let signals: Vec<_> = plan.trace.iter().map(|&signal| (signal, directory.entry(signal).kind)).collect();
        let mut row = "cycle,time_s".to_owned();
        for &(signal, _) in &signals {
            row.push(',');
            row.push_str(&directory.entry(signal).name);
        }
        row.push('\n');
        writer.write_all(row.as_bytes())?;
        Ok(Self { writer, signals, every: plan.every, cycle_ns: plan.cycle_ns, row })
    }

    /// Writes a cycle, if it is traced.
    ///
    /// # Errors
    /// Returns the error of the writer.
    pub fn write(&mut self, cycle: u64, board: &Board) -> io::Result<()> {
        if !cycle.is_multiple_of(self.every) {
            return Ok(());
        }
        let row = &mut self.row;
        row.clear();
        // Writing to a string cannot fail.
        let _ = write!(row, "{cycle},");
        moment::push_seconds(row, cycle, self.cycle_ns);
        for &(signal, kind) in &self.signals {
            let _ = match board.value(signal, kind) {
                Number::Int(value) => write!(row, ",{value}"),
                Number::Real(value) => write!(row, ",{value:?}"),
            };
        }
        row.push('\n');
        self.writer.write_all(row.as_bytes())
    }

    /// Writes the remaining buffered data and returns the writer.
    ///
    /// # Errors
    /// Returns the error of the writer.
    pub fn finish(mut self) -> io::Result<W> {
        self.writer.flush()?;
        Ok(self.writer)
    }
}

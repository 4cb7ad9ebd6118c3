//! System variables of MACS by name and number, with the corresponding signals.
//!
//! Law      number = 4095 + subindex of object 0x2500 (MACS-SYS-02)
//! Reads    nothing
//! Writes   nothing: a table for users and tools that know the numbers
//! Refuses  nothing
//! Source   MACS-SYS-01..04, A-55

/// CANopen index of the numbers from 4096 on.
pub const OBJECT: u16 = 0x2500;

/// Number of a system variable of subindex 0 of [`OBJECT`].
const BASE: u16 = 4095;

/// Address of a variable in a program of the source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Address {
    /// SYSVAR of this number.
    Number(u16),
    /// An object of the controller by index and subindex.
    Object(u16, u8),
    /// Only a name: the text gives no number.
    Name,
}

impl Address {
    /// Returns index and subindex on the bus, if it has one (MACS-SYS-02).
    pub fn object(self) -> Option<(u16, u8)> {
        match self {
            Self::Number(number) => Some((OBJECT, number.checked_sub(BASE).and_then(|sub| u8::try_from(sub).ok())?)),
            Self::Object(index, subindex) => Some((index, subindex)),
            Self::Name => None,
        }
    }
}

/// Equivalent of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// Last part of the name of a signal of the axis.
    Signal(&'static str),
    /// Last part of the name of a signal of an entry of section `encoders`.
    Encoder(&'static str),
    /// No signal: the place of the value.
    Missing(&'static str),
}

/// A named system variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SystemVariable {
    /// Name in the source; empty if the source gives only a number.
    pub name: &'static str,
    /// Address in a program.
    pub address: Address,
    /// Meaning, with the unit of the source.
    pub meaning: &'static str,
    /// Equivalent.
    pub shown: Shown,
}

const fn variable(name: &'static str, address: Address, meaning: &'static str, shown: Shown) -> SystemVariable {
    SystemVariable { name, address, meaning, shown }
}

/// Every system variable of the text (MACS-SYS-01).
pub const SYSTEM_VARIABLES: &[SystemVariable] = &[
    variable("", Address::Number(16), "errors of an absolute encoder so far", Shown::Signal("encoder.errors")),
    variable("", Address::Number(42), "physical value of a shared encoder (qc)", Shown::Encoder("count")),
    variable("", Address::Number(4096), "commanded position (qc)", Shown::Signal("command.position")),
    variable("", Address::Number(4105), "master simulation (qc; written: qc/st)", Shown::Signal("master.position")),
    variable(
        "REG_NORMTRACKERR",
        Address::Number(4124),
        "tracking error (% of the command velocity in qc/st)",
        Shown::Signal("regulator.track_error"),
    ),
    variable("", Address::Number(4238), "filtered marker distance (qc)", Shown::Signal("marker.distance")),
    variable(
        "PFG_COMMANDPOS",
        Address::Number(4311),
        "command position, exact (qc)",
        Shown::Signal("command.position"),
    ),
    variable(
        "PFG_OLDCOMMANDPOS",
        Address::Number(4312),
        "command position of the cycle before (qc)",
        Shown::Missing("a recording has the command of the cycle before"),
    ),
    variable(
        "PFG_SYNCMNEGBUFFER",
        Address::Number(4315),
        "stored backward motion of the master (qc)",
        Shown::Signal("sync.buffer"),
    ),
    variable("PFG_MFILTERERROR", Address::Name, "error of the master filter (qc)", Shown::Signal("sync.filter_error")),
    variable("AMP_I2TVALUE", Address::Object(0x2700, 27), "i2t value", Shown::Signal("regulator.i2t")),
    variable("AMP_GETCUR", Address::Name, "filtered current (mA)", Shown::Signal("regulator.current")),
    variable("", Address::Name, "physical encoder, written 0x0122022A (qc)", Shown::Signal("actual.count")),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Directory;

    /// Proves: MACS-SYS-02
    #[test]
    fn numbers_are_subindices_of_2500() {
        assert_eq!(Address::Number(4315).object(), Some((0x2500, 220)));
        assert_eq!(Address::Number(4124).object(), Some((0x2500, 29)));
        assert_eq!(Address::Number(4096).object(), Some((0x2500, 1)));
        assert_eq!(Address::Object(0x2700, 27).object(), Some((0x2700, 27)));
        // Lower numbers, and numbers beyond the range of a subindex, have no object.
        for number in [16, 42, 4094, 4095 + 256] {
            assert_eq!(Address::Number(number).object(), None, "{number}");
        }
    }

    /// Every named variable has a line, and every signal of a line exists, on machines of all kinds.
    ///
    /// Proves: MACS-SYS-01
    #[test]
    fn every_signal_that_the_table_names_exists() {
        let mut directory = Directory::default();
        crate::signal::axis::AxisSignal::add_all(&mut directory, "x");
        for variable in SYSTEM_VARIABLES {
            match variable.shown {
                Shown::Signal(end) => assert!(directory.find(&format!("x.{end}")).is_some(), "{variable:?}"),
                Shown::Encoder(end) => assert!(["count", "position", "velocity", "error"].contains(&end)),
                Shown::Missing(what) => assert!(!what.is_empty(), "{variable:?}"),
            }
        }
        let numbers: Vec<u16> = SYSTEM_VARIABLES
            .iter()
            .filter_map(|variable| match variable.address {
                Address::Number(number) => Some(number),
                _ => None,
            })
            .collect();
        assert_eq!(numbers, [16, 42, 4096, 4105, 4124, 4238, 4311, 4312, 4315]);
        for name in
            ["REG_NORMTRACKERR", "PFG_COMMANDPOS", "PFG_OLDCOMMANDPOS", "PFG_SYNCMNEGBUFFER", "PFG_MFILTERERROR"]
        {
            assert_eq!(SYSTEM_VARIABLES.iter().filter(|variable| variable.name == name).count(), 1, "{name}");
        }
    }

    /// The table in docs/motion.md equals this one.
    #[test]
    fn the_book_has_every_line() {
        let book = include_str!("../../../docs/motion.md");
        for variable in SYSTEM_VARIABLES {
            let number = match variable.address {
                Address::Number(number) => number.to_string(),
                Address::Object(index, subindex) => format!("0x{index:04X}:{subindex}"),
                Address::Name => String::new(),
            };
            let shown = match variable.shown {
                Shown::Signal(end) => format!("`x.{end}`"),
                Shown::Encoder(end) => format!("`belt.{end}`"),
                Shown::Missing(what) => format!("no signal: {what}"),
            };
            let line = format!("| {number} | {} | {} | {shown} |", variable.name, variable.meaning);
            assert!(book.contains(&line), "{line}");
        }
    }
}

//! Codes of errors, refusals and ends of goals.
//!
//! Ranges (contract section 2): 0 none, MACS numbers as they are, 1000 + WF, 10000 + own, 0x10000 + drive (object 603Fh).

use serde::{Deserialize, Serialize};

/// Why something was refused, ended or failed. The numbers are part of the interface and never change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Code(pub u32);

mod class;
mod ended;
mod refused;
mod sources;

pub use class::Class;

/// All that is to be said of a code.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The code.
    pub code: Code,
    /// Its name.
    pub name: &'static str,
    /// What an error of it does to its axis.
    pub class: Class,
    /// The sentence, with places for what an event carries: `{asked}` and `{limit}` with their units, `{plain}` and `{bound}` the same
    /// without, `{what}` what `{asked}` measures, `{key}` the parameter. Empty where the event has to be looked at (`text`).
    pub says: &'static str,
    /// Where it comes from.
    pub cause: &'static str,
    /// What to do.
    pub remedy: &'static str,
    /// What is wrong with a refused value of a parameter, after the key and the value; empty where no value is refused with it.
    refusal: &'static str,
}

impl Row {
    /// Whether its only sentence is that of a refused value.
    pub(crate) fn refuses_a_value(&self) -> bool {
        self.says.is_empty() && !self.refusal.is_empty()
    }
}

/// Codes with their rows: `NAME = number, Class, "says", "cause" => "remedy";`, before the semicolon `, refusal: ".."` if there is one.
///
/// The cause is the doc comment of the code; a doc comment before the row is added to it.
macro_rules! codes {
    ($($(#[doc = $doc:literal])* $name:ident = $number:literal, $class:ident, $says:literal, $cause:literal => $remedy:literal
        $(, refusal: $refusal:literal)?;)*) => {
        impl super::Code {
            $(#[doc = $cause] $(#[doc = $doc])* pub const $name: super::Code = super::Code($number);)*
        }

        /// In their order.
        pub(super) const ROWS: &[super::Row] = &[$(super::Row {
            code: super::Code::$name,
            name: stringify!($name),
            class: super::Class::$class,
            says: $says,
            cause: $cause,
            remedy: $remedy,
            refusal: concat!($($refusal)?),
        }),*];
    };
}
use codes;

/// What a drive reports.
pub const DRIVE_FAULT: Row = Row {
    code: Code(Code::DRIVE_FAULT),
    name: "DRIVE_FAULT",
    class: Class::Drive,
    says: "",
    cause: "The drive reports a fault; the last four hexadecimal digits are its object 603Fh.",
    remedy: "Look the code up in the manual of the drive, remove the cause, then reset_errors, which resets the drive too.",
    refusal: "",
};

/// What is wrong with a value that is refused with that code, after its name.
pub fn not_built_here(code: Code) -> &'static str {
    match code.row() {
        Some(row) if !row.refusal.is_empty() => row.refusal,
        _ => "does not exist yet",
    }
}

impl Code {
    /// What the recorder has to say: cycles that are missing, the number of the system's error (0 where it is not known); what a backend
    /// has, of nodes of its bus: [`NodeNotice`](crate::drive::NodeNotice), [`ForeignEmergency`](crate::drive::ForeignEmergency); by how
    /// much the system clock was set (ns).
    pub const NOTES: [Code; 6] = [
        Code::RECORD_LOST,
        Code::RECORD_FAILED,
        Code::FLIGHT_FAILED,
        Code::NODE_CHANGED,
        Code::FOREIGN_EMERGENCY,
        Code::CLOCK_STEPPED,
    ];

    /// First code of drive faults: 0x10000 + object 603Fh.
    pub const DRIVE_FAULT: u32 = 0x1_0000;

    /// A drive's own fault code (603Fh).
    pub const fn drive_fault(fault: u16) -> Self {
        Self(Self::DRIVE_FAULT + fault as u32)
    }

    /// An alarm of a positioning module: 1000 + its number.
    pub const fn is_alarm(self) -> bool {
        self.0 > 1000 && self.0 < 1100
    }

    /// Every code of this program but those of drives.
    pub fn rows() -> impl Iterator<Item = &'static Row> {
        [sources::ROWS, refused::ROWS, ended::ROWS].into_iter().flatten()
    }

    /// What is to be said of it; none where it is not known.
    pub fn row(self) -> Option<&'static Row> {
        Self::rows().find(|row| row.code == self).or((self.0 >= Self::DRIVE_FAULT).then_some(&DRIVE_FAULT))
    }

    /// What an error of it does to its axis; none where it is never the error of one.
    pub fn class(self) -> Option<Class> {
        self.row().map(|row| row.class).filter(|class| *class != Class::NoError)
    }

    /// Is a goal that ends with it one that has succeeded?
    pub fn succeeds(self) -> bool {
        self.is_none() || self == Self::GEARED_OUT
    }

    /// True where nothing is wrong.
    pub const fn is_none(self) -> bool {
        self.0 == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_number_stands_twice() {
        let mut seen: Vec<_> = Code::rows().map(|row| row.code).collect();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), Code::rows().count());
    }

    #[test]
    fn every_code_has_a_cause_and_a_remedy() {
        for row in Code::rows().filter(|row| !row.code.is_none()).chain([&DRIVE_FAULT]) {
            assert!(row.cause.ends_with('.') && row.remedy.ends_with('.'), "{}", row.name);
            assert!(!row.cause.contains('|') && !row.remedy.contains('|'), "{}: the page has columns", row.name);
        }
        assert_eq!(Code::drive_fault(0x8611).row().map(|row| row.name), Some("DRIVE_FAULT"));
        assert!(Code(777).row().is_none());
    }

    #[test]
    fn faults_of_a_drive_take_its_voltage_and_refusals_do_nothing() {
        assert_eq!(Code::drive_fault(0x8611).class(), Some(Class::Drive));
        assert_eq!(Code::FOLLOWING_ERROR.class(), Some(Class::Parameter));
        let none = [Code::NONE, Code::CANCELLED, Code::HOMING_REQUIRED, Code::ABORTED];
        assert_eq!(none.map(Code::class), [None; 4]);
    }

    /// Proves: MACS-ERR-01
    #[test]
    fn the_numbers_of_macs_are_kept_as_they_are() {
        let codes = [Code::HOMING_REQUIRED, Code::DRIVE_LOST, Code::BUS_ERROR, Code::LIMIT_VIOLATION, Code::I2T_LIMIT];
        assert_eq!(codes.map(|code| code.0), [6, 88, 89, 98, 99]);
    }

    #[test]
    fn a_drive_fault_keeps_its_603f_code() {
        assert_eq!(Code::drive_fault(0x8611).0, 0x1_8611);
    }
}

//! Source and marker of the virtual master: VMENCTYP and VMENCMTYP, by number.
//!
//! Law      vmenctyp = 100 axis + encodertype (+ 100000); vmencmtyp = 10 input + kind
//! Refuses  axes that the cell does not have, an encodertype other than 0, a start without a ramp, a cell in which the
//!          master runs from the start
//! Source   MACS-VM-01, -02, -03, -05, -07, A-46

use super::{MachineParameters, Row};
use crate::code::Code;
use std::fmt;

/// Added to the number if the output is an internal node.
const INTERNAL: i64 = 100_000;

/// Events that the index of the virtual master counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// Its own pulses.
    Index,
    /// Edges of a digital input.
    Input {
        /// Index among the digital inputs.
        place: usize,
        /// Whether edges are rising; otherwise falling.
        rising: bool,
    },
}

/// Error in the parameters of the virtual master.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VirtualMasterProblem {
    /// Key of the invalid parameter.
    pub key: &'static str,
    /// Its value.
    pub value: i64,
    /// Reason.
    pub code: Code,
    /// Number of axes of the cell, or the conflicting value.
    pub limit: i64,
}

impl fmt::Display for VirtualMasterProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { key, value, code, limit } = self;
        match (*code, value % 100) {
            (Code::VIRTUAL_MASTER_SOURCE, encodertype @ (1 | 5)) => write!(
                f,
                "{key} {value} has an encoder of type {encodertype} in the place of the virtual master while that is off; encoders have names \
                 here, and 0 as the last two digits is allowed: it stands"
            ),
            (Code::VIRTUAL_MASTER_SOURCE, _) => {
                write!(
                    f,
                    "{key} {value} is not allowed; 100 n is, and 100000 more, with n 0 for pulsvel, 1 to {limit} for an axis"
                )
            }
            (Code::VIRTUAL_MASTER_NO_RAMP, _) => {
                write!(f, "{key} {value} starts the virtual master, and pulsacc is {limit}; above 0 is needed for that")
            }
            _ => write!(
                f,
                "{key} is {value}; 0 is allowed at the start, as no machine begins with a virtual master that runs"
            ),
        }
    }
}

impl Row {
    /// Returns true if setting it moves the virtual master. Such a parameter is not part of parameter files, because
    /// reading one must not start a motion.
    pub fn moves_virtual_master(&self) -> bool {
        matches!(self.key, "pulsvel" | "setsys_15")
    }
}

impl MachineParameters {
    /// Returns the axis whose velocity a start uses; `None` for pulsvel.
    pub fn virtual_source(&self) -> Option<u16> {
        u16::try_from(self.vmenctyp % INTERNAL / 100).ok()?.checked_sub(1)
    }

    /// Returns the events that the index counts.
    pub fn virtual_marker(&self) -> Marker {
        let place = usize::try_from(self.vmencmtyp / 10).ok().and_then(|number| number.checked_sub(1));
        match (self.vmencmtyp % 10, place) {
            (kind @ 2..=3, Some(place)) => Marker::Input { place, rising: kind == 2 },
            _ => Marker::Index,
        }
    }

    /// Checks that the source of the virtual master exists in a cell with that number of axes.
    ///
    /// # Errors
    /// It does not exist.
    pub fn check_virtual_source(&self, axes: usize) -> Result<(), VirtualMasterProblem> {
        let is_there = self.virtual_source().is_none_or(|axis| usize::from(axis) < axes);
        if is_there && self.vmenctyp % 100 == 0 && (0..2 * INTERNAL).contains(&self.vmenctyp) {
            return Ok(());
        }
        let (value, limit) = (self.vmenctyp, axes as i64);
        Err(VirtualMasterProblem { key: "vmenctyp", value, code: Code::VIRTUAL_MASTER_SOURCE, limit })
    }

    /// Checks that the virtual master is at rest before cycle 0, and that its source exists in a cell with that number
    /// of axes.
    ///
    /// # Errors
    /// It moves, or its source does not exist.
    pub fn check_virtual_begin(&self, axes: usize) -> Result<(), VirtualMasterProblem> {
        let velocities = [("pulsvel", self.pulsvel), ("setsys_15", self.setsys_15)];
        match velocities.into_iter().find(|(_, value)| *value != 0) {
            Some((key, value)) => {
                Err(VirtualMasterProblem { key, value, code: Code::PARAMETER_OUT_OF_RANGE, limit: 0 })
            }
            None => self.check_virtual_source(axes),
        }
    }

    /// Checks that pulsvel may start it. Without a ramp only pulsvel 0 is allowed, which starts nothing by itself; if
    /// an axis is its source, only if the set also contains pulsacc.
    ///
    /// # Errors
    /// It has no ramp.
    pub fn check_virtual_start(&self, names_ramp: bool) -> Result<(), VirtualMasterProblem> {
        let asks = self.pulsvel != 0 || self.virtual_source().is_some() && !names_ramp;
        if self.pulsacc > 0 || !asks {
            return Ok(());
        }
        let (value, limit) = (self.pulsvel, self.pulsacc);
        Err(VirtualMasterProblem { key: "pulsvel", value, code: Code::VIRTUAL_MASTER_NO_RAMP, limit })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(vmenctyp: i64) -> MachineParameters {
        MachineParameters { vmenctyp, ..MachineParameters::default() }
    }

    /// Proves: MACS-VM-01, MACS-VM-05
    #[test]
    fn hundreds_are_the_axis_and_the_node_changes_nothing() {
        for (number, axis) in [(0, None), (100, Some(0)), (300, Some(2)), (51_200, Some(511))] {
            for more in [0, INTERNAL] {
                let parameters = of(number + more);
                assert_eq!(parameters.virtual_source(), axis, "{number} + {more}");
                assert_eq!(parameters.check_virtual_source(512), Ok(()));
            }
        }
        for (number, axes) in [(1, 3), (5, 3), (99, 3), (-100, 3), (400, 3), (100, 0), (200_000, 3), (100_301, 3)] {
            assert!(of(number).check_virtual_source(axes).is_err(), "{number} of {axes}");
        }
    }

    #[test]
    fn sentences_name_what_is_allowed() {
        let sentence = |number| of(number).check_virtual_source(3).map_err(|problem| problem.to_string());
        assert_eq!(sentence(300), Ok(()));
        let allowed = "is not allowed; 100 n is, and 100000 more, with n 0 for pulsvel, 1 to 3 for an axis";
        assert_eq!(sentence(400), Err(format!("vmenctyp 400 {allowed}")));
        let encoder = "has an encoder of type 5 in the place of the virtual master while that is off; encoders have names here, and 0 as the last \
                       two digits is allowed: it stands";
        assert_eq!(sentence(205), Err(format!("vmenctyp 205 {encoder}")));
        let start = MachineParameters { pulsvel: 7, ..of(0) };
        let text = "pulsvel 7 starts the virtual master, and pulsacc is 0; above 0 is needed for that";
        assert_eq!(start.check_virtual_start(true).map_err(|problem| problem.to_string()), Err(text.to_owned()));
        let text = "pulsvel is 7; 0 is allowed at the start, as no machine begins with a virtual master that runs";
        assert_eq!(start.check_virtual_begin(3).map_err(|problem| problem.to_string()), Err(text.to_owned()));
        assert!(MachineParameters { setsys_15: -1, ..of(0) }.check_virtual_begin(3).is_err());
        assert!(of(400).check_virtual_begin(3).is_err());
        assert_eq!(MachineParameters { pulsacc: 9, ..of(300) }.check_virtual_begin(3), Ok(()));
    }

    /// Proves: MACS-VM-07
    #[test]
    fn the_tens_digit_is_the_input() {
        let marker = |vmencmtyp| MachineParameters { vmencmtyp, ..of(0) }.virtual_marker();
        assert_eq!([0, 1].map(marker), [Marker::Index; 2]);
        assert_eq!(marker(12), Marker::Input { place: 0, rising: true });
        assert_eq!(marker(93), Marker::Input { place: 8, rising: false });
    }

    /// Proves: MACS-VM-03
    #[test]
    fn a_start_needs_a_ramp() {
        let start = |pulsvel, pulsacc, vmenctyp, names_ramp| {
            MachineParameters { pulsvel, pulsacc, ..of(vmenctyp) }.check_virtual_start(names_ramp).is_ok()
        };
        for names_ramp in [false, true] {
            assert!(start(1, 1, 0, names_ramp) && start(0, 1, 100, names_ramp));
            assert!(start(0, 0, 0, names_ramp) && start(0, -1, 0, names_ramp));
            assert!(!start(1, 0, 0, names_ramp) && !start(-1, -1, 0, names_ramp) && !start(1, 0, 100, names_ramp));
            // A file of all parameters contains this for a master that is off.
            assert_eq!(start(0, 0, 100, names_ramp), names_ramp);
            assert_eq!(start(0, -1, 100_100, names_ramp), names_ramp);
        }
    }
}

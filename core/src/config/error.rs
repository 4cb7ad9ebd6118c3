//! Errors of the configuration of a machine.

use super::{SlotProblem, SumProblem, missing_io_text};
use crate::axis::MAX_DELAY;
use crate::code::{Code, not_built_here};
use crate::drive::Interface;
use crate::parameter::{Applies, VirtualMasterProblem};
use crate::table::PitchError;

/// Error of the configuration of a machine.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ConfigError {
    /// Cycle time out of range.
    #[error("cycle is {0} ns; 125000 ns to 20000000 ns is allowed")]
    Cycle(u64),
    /// Too many objects of a kind.
    #[error("{count} {what}; at most {most} are possible")]
    TooMany {
        /// Kind of object.
        what: &'static str,
        /// Number of objects.
        count: usize,
        /// Maximum number.
        most: usize,
    },
    /// Invalid parameters of the virtual master.
    #[error("machine: {0}")]
    VirtualMaster(VirtualMasterProblem),
    /// Invalid delay of a drive.
    #[error("drive of {axis}: delay is {delay} cycles; at most {MAX_DELAY} are possible")]
    Delay {
        /// Name of the axis.
        axis: String,
        /// The delay.
        delay: u32,
    },
    /// An interface that the backend of the drive does not offer.
    #[error("drive of {axis}: interface is {}, which its backend does not offer", interface.name())]
    NotOffered {
        /// Name of the axis.
        axis: String,
        /// Requested interface.
        interface: Interface,
    },
    /// Homing by a drive that does not offer it.
    #[error("drive of {axis}: homing.in_drive is true, and its backend offers no homing")]
    HomingNotOffered {
        /// Name of the axis.
        axis: String,
    },
    /// Two drives that cannot form a gantry.
    #[error("drives of {axis}: {problem}")]
    Gantry {
        /// Name of the axis.
        axis: String,
        /// Reason.
        problem: GantryProblem,
    },
    /// A drive without a backend.
    #[error("drive of {axis}: no backend serves it")]
    NoBackend {
        /// Name of the axis.
        axis: String,
    },
    /// A drive of two backends.
    #[error("drive of {axis}: two backends serve it")]
    TwoBackends {
        /// Name of the axis.
        axis: String,
    },
    /// A drive that differs from the description of the cell.
    #[error("drive of {axis}: its backend offers something else than the cell was read for")]
    DriveMismatch {
        /// Name of the axis.
        axis: String,
    },
    /// Invalid output of an open-loop axis.
    #[error("{axis}: {key} is wired to entry {entry} of io, which is no {kind}")]
    Output {
        /// Name of the axis.
        axis: String,
        /// Key of the output.
        key: &'static str,
        /// Index in section `io`.
        entry: u16,
        /// Required kind.
        kind: &'static str,
    },
    /// Invalid drive with voltage interface.
    #[error("drive of {axis}: {problem}")]
    Analog {
        /// Name of the axis.
        axis: String,
        /// Reason.
        problem: AnalogProblem,
    },
    /// Invalid contact of section safety.
    #[error("safety: {key} is digital input {place} (from 0), which does not exist")]
    Contact {
        /// Key of the contact.
        key: &'static str,
        /// Index of the input.
        place: u32,
    },
    /// A contact of section safety that reads an output of the machine.
    #[error("safety: {key} is digital input {place} (from 0), which reads an output of the machine itself")]
    VirtualContact {
        /// Key of the contact.
        key: &'static str,
        /// Index of the input.
        place: u32,
    },
    /// Invalid input that is to read an output.
    #[error("digital input {input} of {count} is to read entry {output} of io; one of them and a do are expected")]
    VirtualInput {
        /// Number of the input, from 1.
        input: usize,
        /// Number of digital inputs.
        count: usize,
        /// Index of the output to read.
        output: u16,
    },
    /// An output with two functions of the same axis.
    #[error("{axis}: {key} is wired to entry {entry} of io, which something else switches")]
    OutputTwice {
        /// Name of the axis.
        axis: String,
        /// Key of the second function.
        key: &'static str,
        /// Index in section `io`.
        entry: u16,
    },
    /// A number of an input or output that does not exist.
    #[error("{}{}", axis.as_ref().map_or("machine: ".to_owned(), |name| format!("{name}: ")), missing_io_text(key, &number.to_string(), *is_output, &count.to_string()))]
    NoSuchIo {
        /// Name of the axis; `None` for the machine.
        axis: Option<String>,
        /// Key of the parameter.
        key: &'static str,
        /// Its value.
        number: i64,
        /// Whether the number names an output.
        is_output: bool,
        /// Number of existing inputs or outputs.
        count: usize,
    },
    /// An output with two functions.
    #[error("{}{key} names output {number}, which has another function already", axis.as_ref().map_or("machine: ".to_owned(), |name| format!("{name}: ")))]
    OutputShared {
        /// Name of the axis; `None` for the machine.
        axis: Option<String>,
        /// Key of the parameter.
        key: &'static str,
        /// Number of the output.
        number: i64,
    },
    /// Invalid parameter of the reference selector.
    #[error("{axis}: {key} has a value that the rest of the axis does not allow")]
    Selector {
        /// Name of the axis.
        axis: String,
        /// Key of the parameter.
        key: &'static str,
    },
    /// A loop in the masters of reference selectors.
    #[error("{axis}: its reference selector would follow itself, directly or through others")]
    MasterLoop {
        /// Name of an axis in the loop.
        axis: String,
    },
    /// A parameter that is derived from others.
    #[error("{axis}: {key} follows from others and leaves its range")]
    Derived {
        /// Name of the axis.
        axis: String,
        /// Key of the parameter.
        key: &'static str,
    },
    /// A parameter that requires an object that does not exist.
    #[error("{axis}: {key} {}", not_built_here(*code))]
    NotImplemented {
        /// Name of the axis.
        axis: String,
        /// Key of the parameter.
        key: &'static str,
        /// Code of the missing object.
        code: Code,
    },
    /// Invalid pitch error of an axis.
    #[error("pitch_error of {axis}: {problem}")]
    Pitch {
        /// Name of the axis.
        axis: String,
        /// Reason.
        problem: PitchProblem,
    },
    /// Invalid function slot.
    #[error("{slot}: {problem}")]
    Slot {
        /// Name of the slot.
        slot: String,
        /// Reason.
        problem: SlotProblem,
    },
    /// Invalid master that combines several leaders.
    #[error("{master}: {problem}")]
    Master {
        /// Name of the master.
        master: String,
        /// Reason.
        problem: SumProblem,
    },
    /// Two parameters of an axis that contradict each other.
    #[error("{axis}: {low} exceeds {high}")]
    Contradiction {
        /// Name of the axis.
        axis: String,
        /// Parameter that must not exceed the other one.
        low: &'static str,
        /// The other parameter.
        high: &'static str,
    },
}

/// Reason why an axis cannot have a pitch error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PitchProblem {
    /// The axis has no drive that follows a position.
    #[error("it is for {}", Applies::Positioned.text())]
    Interface,
    /// The table does not exist.
    #[error("it is entry {0} of tables (from 0), which does not exist")]
    Table(u16),
    /// The points of the table are invalid.
    #[error("{0}")]
    Points(PitchError),
}

/// Reason why two drives cannot form a gantry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GantryProblem {
    /// There is a second drive but no first one.
    #[error("the second one has no first one")]
    NoFirst,
    /// Two drives cannot share this interface.
    #[error("interface is {}; two drives of one axis have interface position", .0.name())]
    Interface(Interface),
    /// The drives would execute a command at different times.
    #[error("the first one has a delay of {0} cycles, the second one of {1}; the same delay is expected")]
    Delays(u32, u32),
}

/// Reason why a drive cannot have a voltage interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AnalogProblem {
    /// The axis has no drive, or two.
    #[error("one drive alone is given a voltage; the axis has none, or two")]
    Drives,
    /// An interface for which no voltage is defined.
    #[error("interface is {}; a drive that is given a voltage has velocity or torque", .0.name())]
    Interface(Interface),
    /// Missing or invalid velocity or torque at 10 V.
    #[error("what it does at 10 V is no number above 0")]
    Full,
    /// Invalid time of its enable (ms).
    #[error("its enable takes {0} ms; 0 to 4000 ms are expected")]
    Time(u64),
    /// Ready input that reads an output of the machine.
    #[error("ready reads an output of the machine itself; an input with a terminal is expected")]
    Ready,
}

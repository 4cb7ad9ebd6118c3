//! Why a machine cannot be made.

use super::{SlotProblem, SumProblem, names_no_io};
use crate::axis::MAX_DELAY;
use crate::code::{Code, not_built_here};
use crate::drive::Interface;
use crate::parameter::{Applies, VirtualMasterProblem};
use crate::table::PitchError;

/// Why a machine cannot be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ConfigError {
    /// The cycle's length.
    #[error("cycle is {0} ns; 125000 ns to 20000000 ns is allowed")]
    Cycle(u64),
    /// Too many of something.
    #[error("{count} {what}; at most {most} are possible")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many are possible.
        most: usize,
    },
    /// Parameters of the virtual master.
    #[error("machine: {0}")]
    VirtualMaster(VirtualMasterProblem),
    /// A drive's delay.
    #[error("drive of {axis}: delay is {delay} cycles; at most {MAX_DELAY} are possible")]
    Delay {
        /// Whose.
        axis: String,
        /// How long.
        delay: u32,
    },
    /// A way to command a drive that its backend does not have.
    #[error("drive of {axis}: interface is {}, which its backend does not offer", interface.name())]
    NotOffered {
        /// Whose.
        axis: String,
        /// What is asked for.
        interface: Interface,
    },
    /// A drive that is to home by itself.
    #[error("drive of {axis}: homing.in_drive is true, and its backend offers no homing")]
    HomesNot {
        /// Whose.
        axis: String,
    },
    /// Two drives that cannot carry one axis.
    #[error("drives of {axis}: {problem}")]
    Gantry {
        /// Whose.
        axis: String,
        /// Why not.
        problem: GantryProblem,
    },
    /// A drive without a backend.
    #[error("drive of {axis}: no backend serves it")]
    NotServed {
        /// Whose.
        axis: String,
    },
    /// A drive of two backends.
    #[error("drive of {axis}: two backends serve it")]
    ServedTwice {
        /// Whose.
        axis: String,
    },
    /// A drive that is another one than its cell describes.
    #[error("drive of {axis}: its backend offers something else than the cell was read for")]
    OtherDrive {
        /// Whose.
        axis: String,
    },
    /// An output of an open-loop axis.
    #[error("{axis}: {key} is wired to entry {entry} of io, which is no {kind}")]
    Output {
        /// Whose.
        axis: String,
        /// Which one.
        key: &'static str,
        /// To what.
        entry: u16,
        /// What it must be.
        kind: &'static str,
    },
    /// A drive that is given a voltage.
    #[error("drive of {axis}: {problem}")]
    Analog {
        /// Whose.
        axis: String,
        /// What is wrong with it.
        problem: AnalogProblem,
    },
    /// A contact of section safety.
    #[error("safety: {key} is digital input {place} (from 0), which does not exist")]
    Contact {
        /// Which one.
        key: &'static str,
        /// To what.
        place: u32,
    },
    /// A contact of section safety that the machine itself would work.
    #[error("safety: {key} is digital input {place} (from 0), which reads an output of the machine itself")]
    VirtualContact {
        /// Which one.
        key: &'static str,
        /// To what.
        place: u32,
    },
    /// An input that is to read an output.
    #[error("digital input {input} of {count} is to read entry {output} of io; one of them and a do are expected")]
    VirtualInput {
        /// Which one, from 1.
        input: usize,
        /// How many there are.
        count: usize,
        /// What it is to read.
        output: u16,
    },
    /// An output that two of an axis' own would switch.
    #[error("{axis}: {key} is wired to entry {entry} of io, which something else switches")]
    OutputTwice {
        /// Whose.
        axis: String,
        /// What is wired to it.
        key: &'static str,
        /// Which one.
        entry: u16,
    },
    /// A number of an input or output that is not there.
    #[error("{}{}", axis.as_ref().map_or("machine: ".to_owned(), |name| format!("{name}: ")), names_no_io(key, &number.to_string(), *is_output, &count.to_string()))]
    NoSuchIo {
        /// Whose; none for the machine.
        axis: Option<String>,
        /// The parameter.
        key: &'static str,
        /// Its value.
        number: i64,
        /// Whether the number names an output.
        is_output: bool,
        /// How many there are.
        count: usize,
    },
    /// An output with two functions.
    #[error("{}{key} names output {number}, which has another function already", axis.as_ref().map_or("machine: ".to_owned(), |name| format!("{name}: ")))]
    OutputShared {
        /// Whose; none for the machine.
        axis: Option<String>,
        /// The parameter.
        key: &'static str,
        /// The output.
        number: i64,
    },
    /// A parameter of the reference selector.
    #[error("{axis}: {key} has a value that the rest of the axis does not allow")]
    Selector {
        /// Whose.
        axis: String,
        /// Which.
        key: &'static str,
    },
    /// Masters of reference selectors.
    #[error("{axis}: its reference selector would follow itself, directly or through others")]
    MasterLoop {
        /// One of the loop.
        axis: String,
    },
    /// A parameter that follows from others.
    #[error("{axis}: {key} follows from others and leaves its range")]
    Derived {
        /// Whose.
        axis: String,
        /// Which.
        key: &'static str,
    },
    /// A parameter that asks for something that does not exist.
    #[error("{axis}: {key} {}", not_built_here(*code))]
    NotBuilt {
        /// Whose.
        axis: String,
        /// Which.
        key: &'static str,
        /// What does not exist.
        code: Code,
    },
    /// The pitch error of an axis.
    #[error("pitch_error of {axis}: {problem}")]
    Pitch {
        /// Whose.
        axis: String,
        /// What is wrong with it.
        problem: PitchProblem,
    },
    /// A function slot.
    #[error("{slot}: {problem}")]
    Slot {
        /// Whose.
        slot: String,
        /// What is wrong with it.
        problem: SlotProblem,
    },
    /// A master of several.
    #[error("{master}: {problem}")]
    Master {
        /// Whose.
        master: String,
        /// What is wrong with it.
        problem: SumProblem,
    },
    /// Two parameters of an axis.
    #[error("{axis}: {low} exceeds {high}")]
    Contradiction {
        /// Whose.
        axis: String,
        /// The one that must not be above the other.
        low: &'static str,
        /// The other one.
        high: &'static str,
    },
}

/// Why an axis cannot have a pitch error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PitchProblem {
    /// No drive is led to its positions.
    #[error("it is for {}", Applies::Positioned.text())]
    Interface,
    /// There is no such table.
    #[error("it is entry {0} of tables (from 0), which does not exist")]
    Table(u16),
    /// The points of the table.
    #[error("{0}")]
    Points(PitchError),
}

/// Why two drives cannot carry one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GantryProblem {
    /// There is a second drive and no first one.
    #[error("the second one has no first one")]
    NoFirst,
    /// An interface that two drives do not share.
    #[error("interface is {}; two drives of one axis have interface position", .0.name())]
    Interface(Interface),
    /// They would be asked for the same at different times.
    #[error("the first one has a delay of {0} cycles, the second one of {1}; the same delay is expected")]
    Delays(u32, u32),
}

/// Why a drive cannot be given a voltage so.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AnalogProblem {
    /// None, or two.
    #[error("one drive alone is given a voltage; the axis has none, or two")]
    Drives,
    /// An interface that no voltage is for.
    #[error("interface is {}; a drive that is given a voltage has velocity or torque", .0.name())]
    Interface(Interface),
    /// What it does at 10 V.
    #[error("what it does at 10 V is no number above 0")]
    Full,
    /// Time of its enable (ms).
    #[error("its enable takes {0} ms; 0 to 4000 ms are expected")]
    Time(u64),
    /// An output of the machine.
    #[error("ready reads an output of the machine itself; an input with a terminal is expected")]
    Ready,
}

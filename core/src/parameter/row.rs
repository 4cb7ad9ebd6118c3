//! What one row of the catalogue says of its parameter.

use super::rows::ROWS;
use super::{AxisParameters, MachineParameters};
use crate::drive::Interface;
use crate::regulator::Law;

/// What a parameter measures, and so how it is kept and written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// A position (inc), whole, signed.
    Position,
    /// A distance (inc), whole, not negative.
    Distance,
    /// (inc/s)
    Velocity,
    /// (inc/s^2)
    Acceleration,
    /// (inc/s^3)
    Jerk,
    /// (ns)
    Time,
    /// A plain whole number, in the row's own unit.
    Integer,
    /// A plain number, in the row's own unit.
    Number,
    /// One of some names; the number is the place in the list.
    Choice(&'static [&'static str]),
}

/// A parameter's value in the core's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// Left out: what that means stands in the row.
    Unset,
    /// Whole numbers: positions, distances, times, integers, choices.
    Int(i64),
    /// Velocities and their derivatives.
    Real(f64),
}

/// When a new value takes effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// In the cycle in which it is set.
    AtOnce,
    /// With the next motion command; a running motion keeps what it started with.
    NextMotion,
    /// With the next synchronize.
    NextSynchronize,
    /// With the next homing.
    NextHoming,
    /// With the next start of the virtual master, PULSVEL of MACS.
    NextVirtualMaster,
    /// With the next SAIA command that reads it.
    NextSaiaCommand,
    /// At once, and only while the axis is disabled.
    Disabled,
    /// With the next start of the machine.
    Start,
}

impl Effect {
    /// In words.
    pub fn text(self) -> &'static str {
        match self {
            Effect::AtOnce => "at once",
            Effect::NextMotion => "with the next motion command",
            Effect::NextSynchronize => "with the next synchronize",
            Effect::NextHoming => "with the next homing",
            Effect::NextVirtualMaster => "with the next start of the virtual master",
            Effect::NextSaiaCommand => "with the next SAIA command that reads it",
            Effect::Disabled => "at once; the axis must be disabled",
            Effect::Start => "with the next start",
        }
    }
}

/// Permitted values, in the core's units; both ends belong to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// For whole numbers.
    Int(i64, i64),
    /// For whole numbers in any of several ranges, ascending.
    Among(&'static [(i64, i64)]),
    /// For reals: above 0 up to this.
    PositiveUpTo(f64),
    /// For reals: between these.
    Real(f64, f64),
}

/// What a bare number means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bare {
    /// m or rad, and their derivatives by s.
    Si,
    /// The axis unit, and its derivatives by s: the user unit of the sources.
    AxisUnit,
    /// The axis unit per ms.
    AxisUnitPerMs,
    /// For times: ms.
    Milliseconds,
}

/// Who gave a parameter its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum System {
    /// Lineshaft; names as in MoveIt and ros2_control.
    Native,
    /// zub MACS.
    Macs,
    /// Unidrive M advanced motion controller.
    Amc,
    /// SAIA PCD4.H3.
    Saia,
    /// Siemens WF 725 / 726.
    Wf,
}

impl System {
    /// As people call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Native => "Lineshaft",
            Self::Macs => "MACS",
            Self::Amc => "Unidrive AMC",
            Self::Saia => "SAIA PCD4.H3",
            Self::Wf => "Siemens WF 725",
        }
    }
}

/// What a parameter belongs to; the groups are those of MACS where it has one (MACS-STO-01).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    /// AXB: velocity, acceleration, ramps.
    Basic,
    /// AXE: encoders and units.
    Encoder,
    /// AXI: limits, windows, inputs, outputs, reactions.
    Inputs,
    /// AXH
    Homing,
    /// AXS: synchronization and markers.
    Synchronization,
    /// AXR
    Regulation,
    /// AXA
    Amplifier,
    /// GL: of the machine, not of an axis.
    Global,
    /// Menus of the AMC.
    Menu,
    /// Registers and options of the SAIA module.
    Registers,
    /// Machine data and options of the WF modules.
    MachineData,
}

impl Group {
    /// In words, with the letters of the source.
    pub fn text(self) -> &'static str {
        match self {
            Self::Basic => "basic (AXB)",
            Self::Encoder => "encoder (AXE)",
            Self::Inputs => "inputs, outputs, limits (AXI)",
            Self::Homing => "homing (AXH)",
            Self::Synchronization => "synchronization (AXS)",
            Self::Regulation => "regulation (AXR)",
            Self::Amplifier => "amplifier (AXA)",
            Self::Global => "global (GL)",
            Self::Menu => "menu",
            Self::Registers => "registers",
            Self::MachineData => "machine data",
        }
    }
}

/// Where a value lives, and whether it outlives the power (MACS-STO-02..08).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Storage {
    /// May be set at any time; `save_parameters` keeps it.
    User,
    /// May be set at any time; begins anew with each start.
    Volatile,
    /// Part of the structure: stands in the cell, read-only while the machine runs.
    Cell,
    /// Computed from others, read-only.
    Derived,
    /// Not a parameter here but a signal of this name behind the axis: what the source shows in a register.
    Signal(&'static str),
}

/// Which objects have a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Applies {
    /// Every axis.
    Any,
    /// Axes with a drive.
    Drive,
    /// Axes whose drive is led to positions: all with a drive but those in open loop.
    Positioned,
    /// Axes whose position loop is here and proportional.
    Proportional,
    /// Axes whose position loop is here and a PID.
    Pid,
    /// Axes that are given efforts: with interface torque or voltage.
    Torque,
    /// Axes with interface voltage.
    Voltage,
    /// Axes with interface open_loop.
    OpenLoop,
    /// Axes with two drives.
    Gantry,
    /// The machine.
    Machine,
}

impl Applies {
    /// Has an axis it whose drive, or both of whose drives, are commanded so, by that law where the loop is here; none for a virtual one?
    pub fn to_interface(self, interface: Option<Interface>, law: Law, has_two: bool) -> bool {
        let is_here = interface.is_some_and(Interface::closes_loop_here);
        match self {
            Self::Any => true,
            Self::Gantry => has_two,
            Self::Drive => interface.is_some(),
            Self::Positioned => interface.is_some_and(|interface| interface != Interface::OpenLoop),
            Self::Proportional => is_here && law == Law::Proportional,
            Self::Pid => is_here && law == Law::Pid,
            Self::Torque => interface.is_some_and(Interface::takes_effort),
            Self::Voltage => interface == Some(Interface::Voltage),
            Self::OpenLoop => interface == Some(Interface::OpenLoop),
            Self::Machine => false,
        }
    }

    /// What has it, in words.
    pub fn text(self) -> &'static str {
        match self {
            Self::Any => "every axis",
            Self::Drive => "axes with a drive",
            Self::Positioned => "axes with interface position, velocity, torque or voltage",
            Self::Proportional => "axes with interface velocity, torque or voltage and regulator proportional",
            Self::Pid => "axes with interface velocity, torque or voltage and regulator pid",
            Self::Torque => "axes with interface torque or voltage",
            Self::Voltage => "axes with interface voltage",
            Self::OpenLoop => "axes with interface open_loop",
            Self::Gantry => "axes with two drives",
            Self::Machine => "the machine",
        }
    }
}

/// One parameter.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The key in a cell and the end of the ROS parameter's name.
    pub key: &'static str,
    /// Who gave it that name.
    pub system: System,
    /// The source's own spelling; empty where it has none.
    pub mnemonic: &'static str,
    /// The source's number (of MACS: in the space of axes or, for the machine, the global one; MACS-STO-01); empty for none.
    pub number: &'static str,
    /// What it belongs to.
    pub group: Group,
    /// The native key of which this is another view; empty for none.
    pub view_of: &'static str,
    /// What it measures.
    pub measure: Measure,
    /// The unit of a plain number; empty for none.
    pub unit: &'static str,
    /// Permitted values; the default is allowed beside them (D02).
    pub range: Range,
    /// What a bare number means.
    pub bare: Bare,
    /// Value when the cell leaves it out; of a view: the source's own.
    pub default: Value,
    /// What the default means, where it is not a plain value.
    pub default_text: &'static str,
    /// Must a cell give it, by this name or by another view?
    pub required: bool,
    /// Where it lives.
    pub storage: Storage,
    /// When a new value takes effect.
    pub effect: Effect,
    /// Who has it.
    pub applies: Applies,
    /// Whether the axis, or a vocabulary on it, changes it by itself. Such a change counts in the version of the parameters.
    pub by_axis: bool,
    /// Returns true if the values are such that its function needs every cycle of the axis in full; none if it never does.
    pub(super) full_cycles: Option<fn(&AxisParameters) -> bool>,
    /// What does not exist yet, so that only the default is taken; empty where all of it works.
    pub missing: &'static str,
    /// What it is for.
    pub description: &'static str,
    /// Requirements.
    pub source: &'static str,
    /// Where statements of the source disagree: what was decided; empty for none.
    pub note: &'static str,
    /// Reads it.
    pub(super) get: fn(&AxisParameters) -> Value,
    /// Writes it; the value is of the row's type.
    pub(super) set: fn(&mut AxisParameters, Value),
    /// Of the machine: reads it.
    pub(super) get_machine: fn(&MachineParameters) -> Value,
    /// Of the machine: writes it.
    pub(super) set_machine: fn(&mut MachineParameters, Value),
}

/// Why a value is refused by its row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refused {
    /// Outside the range of the row, or not finite.
    OutOfRange,
    /// Not the default, where nothing else works yet.
    NotBuilt,
    /// A whole number for a real, or the other way round; or nothing where a value is needed.
    WrongType,
    /// Read-only.
    ReadOnly,
}

impl Row {
    /// What its function misses, in words: `program control does not exist yet`; empty where all of it works.
    pub fn missing_text(&self) -> String {
        let verb = if self.missing.ends_with("loops") { "do" } else { "does" };
        if self.missing.is_empty() { String::new() } else { format!("{} {verb} not exist yet", self.missing) }
    }

    /// Place in [`ROWS`] of the row of that key, for code that names one: a constant, and no search while the machine runs.
    ///
    /// # Panics
    /// No row has it; in a constant that does not compile.
    pub const fn place(key: &str) -> u16 {
        let mut place = 0;
        while place < ROWS.len() {
            if is_same(ROWS[place].key.as_bytes(), key.as_bytes()) {
                return place as u16;
            }
            place += 1;
        }
        panic!("no row has this key");
    }

    /// The row of that key.
    pub fn find(key: &str) -> Option<(u16, &'static Row)> {
        ROWS.iter().enumerate().find(|(_, row)| row.key == key).map(|(index, row)| (index as u16, row))
    }

    /// Its value.
    pub fn value(&self, parameters: &AxisParameters) -> Value {
        let is_of_axis = self.missing.is_empty() && self.applies != Applies::Machine;
        if is_of_axis { (self.get)(parameters) } else { self.default }
    }

    /// Is it another view of a value that a native row has?
    pub fn is_view(&self) -> bool {
        !self.view_of.is_empty()
    }

    /// Has an axis a value of its own that may be set: it is no view, works, and is not fixed by the cell?
    pub fn is_stored(&self) -> bool {
        let may_be_set = matches!(self.storage, Storage::User | Storage::Volatile) && self.applies != Applies::Machine;
        !self.is_view() && self.missing.is_empty() && may_be_set
    }

    /// The key of the value: of a view, that of its native row.
    pub fn root(&self) -> &'static str {
        if self.is_view() { self.view_of } else { self.key }
    }

    /// May nobody set it while the machine runs?
    pub fn is_read_only(&self) -> bool {
        matches!(self.storage, Storage::Cell | Storage::Derived | Storage::Signal(_))
    }

    /// Is it a limit of a velocity? Those end with what a cycle can do, below the end of their range.
    pub fn is_bound_by_cycle(&self) -> bool {
        self.measure == Measure::Velocity && matches!(self.range, Range::PositiveUpTo(_))
    }

    /// Smallest step between two values; 0 for reals.
    pub fn step(&self) -> u64 {
        u64::from(matches!(self.range, Range::Int(..) | Range::Among(_)))
    }

    /// Is the value one of its type, range and of what works?
    ///
    /// # Errors
    /// What of these fails.
    pub fn check(&self, value: Value) -> Result<(), Refused> {
        let is_inside = match (value, self.range) {
            // Inits outside their own range are legal (D02); where a value may be left out it is.
            (Value::Int(_) | Value::Real(_), _) if value == self.default => true,
            (Value::Int(number), Range::Int(low, high)) => (low..=high).contains(&number),
            (Value::Int(number), Range::Among(ranges)) => {
                ranges.iter().any(|(low, high)| (*low..=*high).contains(&number))
            }
            // NaN fails all comparisons.
            (Value::Real(number), Range::PositiveUpTo(high)) => number > 0.0 && number <= high,
            (Value::Real(number), Range::Real(low, high)) => (low..=high).contains(&number),
            (Value::Unset, _) if self.default == Value::Unset && !self.required => true,
            _ => return Err(Refused::WrongType),
        };
        match (is_inside, self.missing.is_empty() || value == self.default) {
            (false, _) => Err(Refused::OutOfRange),
            (true, false) => Err(Refused::NotBuilt),
            (true, true) => Ok(()),
        }
    }

    /// Checks a value and sets it, as a cell does.
    ///
    /// # Errors
    /// What is wrong with the value; nothing is changed then.
    pub fn assign(&self, parameters: &mut AxisParameters, value: Value) -> Result<(), Refused> {
        if matches!(self.storage, Storage::Derived | Storage::Signal(_)) {
            return Err(Refused::ReadOnly);
        }
        self.check(value)?;
        if self.missing.is_empty() {
            (self.set)(parameters, value);
            parameters.derive();
        }
        Ok(())
    }

    /// As [`Row::assign`], while the machine runs: the structure of the cell stands.
    ///
    /// # Errors
    /// Likewise.
    pub fn change(&self, parameters: &mut AxisParameters, value: Value) -> Result<(), Refused> {
        if self.is_read_only() { Err(Refused::ReadOnly) } else { self.assign(parameters, value) }
    }
}

const fn is_same(one: &[u8], other: &[u8]) -> bool {
    let mut place = 0;
    while place < one.len() && place < other.len() && one[place] == other[place] {
        place += 1;
    }
    place == one.len() && place == other.len()
}

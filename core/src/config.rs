//! What a machine is made of, in the core's units.

use crate::axis::{AxisSetup, MAX_DELAY, Modulo};
use crate::object::{MAX_AXES, Object};
use crate::parameter::AxisParameters;
use crate::unit::Scale;

/// Kind of an input or output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IoKind {
    /// Digital input.
    DigitalInput,
    /// Digital output.
    DigitalOutput,
    /// Analog input (V).
    AnalogInput,
    /// Analog output (V).
    AnalogOutput,
}

/// An entry of `io`.
#[derive(Clone, Debug, PartialEq)]
pub struct IoConfig {
    /// Name.
    pub name: String,
    /// What it is.
    pub kind: IoKind,
    /// Its edges are latched.
    pub latch: bool,
}

/// Type of a memory cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MemoryKind {
    /// 16-bit signed.
    I16,
    /// 32-bit signed.
    I32,
    /// 64-bit signed.
    I64,
    /// Real.
    F64,
    /// 0 or 1.
    Bit,
}

/// An entry of `memory`.
#[derive(Clone, Debug, PartialEq)]
pub struct MemoryConfig {
    /// Name.
    pub name: String,
    /// Its type.
    pub kind: MemoryKind,
    /// Value at the start.
    pub initial: f64,
}

/// An entry of `encoders`.
#[derive(Clone, Debug, PartialEq)]
pub struct EncoderConfig {
    /// Name.
    pub name: String,
    /// Width of its counts, 1 to 64.
    pub bits: u32,
    /// Increments to units.
    pub scale: Scale,
}

/// An entry of `axes`.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisConfig {
    /// Name.
    pub name: String,
    /// Increments to units.
    pub scale: Scale,
    /// Length of a turn.
    pub modulo: Option<Modulo>,
    /// Delay of its drive in cycles; none for a virtual axis.
    pub drive: Option<u32>,
    /// Parameters.
    pub parameters: AxisParameters,
}

/// A machine.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct MachineConfig {
    /// Length of a cycle (ns), 125 000 to 20 000 000.
    pub cycle_ns: u64,
    /// Inputs and outputs.
    pub io: Vec<IoConfig>,
    /// Memory cells.
    pub memory: Vec<MemoryConfig>,
    /// Encoders.
    pub encoders: Vec<EncoderConfig>,
    /// Axes.
    pub axes: Vec<AxisConfig>,
}

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
    /// A drive's delay.
    #[error("drive of {axis}: delay is {delay} cycles; at most {MAX_DELAY} are possible")]
    Delay {
        /// Whose.
        axis: String,
        /// How long.
        delay: u32,
    },
    /// Two parameters of an axis.
    #[error("{axis}: {low} lies above {high}")]
    Contradiction {
        /// Whose.
        axis: String,
        /// The one that must not be above the other.
        low: &'static str,
        /// The other one.
        high: &'static str,
    },
}

impl MachineConfig {
    /// Checks what holds for any machine.
    ///
    /// # Errors
    /// The first thing that does not.
    pub fn check(&self) -> Result<(), ConfigError> {
        if !(125_000..=20_000_000).contains(&self.cycle_ns) {
            return Err(ConfigError::Cycle(self.cycle_ns));
        }
        let most = usize::from(u16::MAX);
        let counts = [
            ("axes", self.axes.len(), MAX_AXES),
            ("io", self.io.len(), most),
            ("memory cells", self.memory.len(), most),
            ("encoders", self.encoders.len(), most),
        ];
        for (what, count, most) in counts {
            if count > most {
                return Err(ConfigError::TooMany { what, count, most });
            }
        }
        for axis in &self.axes {
            let name = || axis.name.clone();
            if let Some(delay) = axis.drive.filter(|&delay| delay > MAX_DELAY) {
                return Err(ConfigError::Delay { axis: name(), delay });
            }
            axis.parameters.check().map_err(|(low, high)| ConfigError::Contradiction { axis: name(), low, high })?;
        }
        Ok(())
    }

    /// The name of an object.
    pub fn name(&self, object: Object) -> &str {
        let name = match object {
            Object::Machine => None,
            Object::Io(index) => self.io.get(usize::from(index)).map(|entry| &entry.name),
            Object::Memory(index) => self.memory.get(usize::from(index)).map(|entry| &entry.name),
            Object::Encoder(index) => self.encoders.get(usize::from(index)).map(|entry| &entry.name),
            Object::Axis(index) => self.axes.get(usize::from(index)).map(|entry| &entry.name),
        };
        name.map_or("machine", String::as_str)
    }

    /// How many entries of `io` are of a kind.
    pub fn count_io(&self, kind: IoKind) -> usize {
        self.io.iter().filter(|entry| entry.kind == kind).count()
    }

    /// Place of an entry of `io` among those of its kind: its bit or its place in the arrays of a backend.
    pub fn io_place(&self, index: usize) -> usize {
        let kind = self.io.get(index).map(|entry| entry.kind);
        self.io[..index.min(self.io.len())].iter().filter(|entry| Some(entry.kind) == kind).count()
    }

    /// How many axes have a drive.
    pub fn count_drives(&self) -> usize {
        self.axes.iter().filter(|axis| axis.drive.is_some()).count()
    }

    /// The setups of the axes, in file order.
    pub(crate) fn setups(&self) -> Vec<AxisSetup> {
        let mut drives = 0..;
        self.axes
            .iter()
            .enumerate()
            .map(|(index, axis)| AxisSetup {
                index: index as u16,
                drive: axis.drive.and_then(|delay| drives.next().map(|place| (place, delay))),
                modulo: axis.modulo,
                cycle_ns: self.cycle_ns,
            })
            .collect()
    }
}

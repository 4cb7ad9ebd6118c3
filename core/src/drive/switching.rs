//! Outputs of an axis without a position loop, in addition to those of its drive.

use serde::{Deserialize, Serialize};

/// Wiring of the outputs, by their indices in section `io`; fixed by the cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SpeedOutputs {
    /// Output of positive direction (F).
    pub forward: Option<u16>,
    /// Output of negative direction (B).
    pub backward: Option<u16>,
    /// Axis output (Q).
    pub output: Option<u16>,
    /// Analog output of the speed (V).
    pub dac: Option<u16>,
}

/// Values of the outputs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Switching {
    /// F: positive direction.
    pub forward: bool,
    /// B: negative direction.
    pub backward: bool,
    /// Q: the axis output, on from the start until the speed is switched off.
    pub output: bool,
    /// Speed as a voltage, signed by direction (V).
    pub dac: f64,
}

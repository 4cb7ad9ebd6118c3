//! What an axis without a position loop switches beside its drive.

use serde::{Deserialize, Serialize};

/// The outputs that it is wired to, by their places in section `io`; fixed by the cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SpeedOutputs {
    /// Direction forwards (F).
    pub forward: Option<u16>,
    /// Direction backwards (B).
    pub backward: Option<u16>,
    /// Axis output (Q).
    pub output: Option<u16>,
    /// Speed as a voltage (V).
    pub dac: Option<u16>,
}

/// What they show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Switching {
    /// F: forwards.
    pub forward: bool,
    /// B: backwards.
    pub backward: bool,
    /// Q: the axis output, on from the start until the speed is switched off.
    pub output: bool,
    /// The speed as a voltage, signed by direction (V).
    pub dac: f64,
}

//! Registers and options of the servo module, in its own units (spec/saia-h3.md).

use serde::{Deserialize, Serialize};

/// Reaction to a command error (SAIA-ERR-04).
pub const COMMAND_ERRORS: &[&str] = &["refuse", "log_only", "motor_off"];
/// Index of `refuse` in [`COMMAND_ERRORS`].
pub(crate) const REFUSE: i64 = 0;
/// Index of `motor_off` in [`COMMAND_ERRORS`].
pub(crate) const MOTOR_OFF: i64 = 2;

/// Parameters of one axis: the input registers (SAIA-REG-00..12) and the options of this implementation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// Proportional factor.
    pub kprop: i32,
    /// Integral factor.
    pub kint: i32,
    /// Derivative factor.
    pub kder: i32,
    /// Integration limit.
    pub intl: i32,
    /// Derivative sampling code.
    pub sampi: i32,
    /// Counts per unit.
    pub mcfac: f64,
    /// Maximum position error (counts).
    pub poser: i32,
    /// Destination (units).
    pub destp: i32,
    /// Break position (units).
    pub brkp: i32,
    /// Velocity (units/s).
    pub veloc: i32,
    /// Acceleration (units/s^2); `None`: the default of the axis, limited to the allowed value of a start.
    pub accel: Option<i32>,
    /// Status flags that `fressf` keeps.
    pub stafrr: i32,
    /// Motion control word.
    pub mcw: i32,
    /// Output that `axinit` selects: 6 analogue, 5 PWM.
    pub imode: i64,
    /// Whether to convert with the printed factors 22.348 and 7.6206e-3.
    pub legacy_scaling: bool,
    /// Whether the sum of the integral term stops growing at its limit.
    pub clamp_sum: bool,
    /// Whether only the top 16 bits of the sum are used.
    pub chip_integral: bool,
    /// Gain after the controller.
    pub output_gain: f64,
    /// Index in [`COMMAND_ERRORS`].
    pub command_error: i64,
}

impl Parameters {
    /// Returns true if a command error refuses the whole request.
    pub fn refuses(&self) -> bool {
        self.command_error == REFUSE
    }
}

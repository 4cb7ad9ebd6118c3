//! Registers and options of the servo module, in its own units (spec/saia-h3.md).

use serde::{Deserialize, Serialize};

/// What a command error does (SAIA-ERR-04).
pub const COMMAND_ERRORS: &[&str] = &["refuse", "log_only", "motor_off"];
/// Place of `refuse` in [`COMMAND_ERRORS`].
pub(crate) const REFUSE: i64 = 0;
/// Place of `motor_off` in [`COMMAND_ERRORS`].
pub(crate) const MOTOR_OFF: i64 = 2;

/// Parameters of one axis: its input registers (SAIA-REG-00..12) and the options of this implementation.
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
    /// Largest position error (counts).
    pub poser: i32,
    /// Destination (units).
    pub destp: i32,
    /// Break position (units).
    pub brkp: i32,
    /// Velocity (units/s).
    pub veloc: i32,
    /// Acceleration (units/s^2); left out: the usual one of the axis, within what a start may take.
    pub accel: Option<i32>,
    /// Status flags that `fressf` keeps.
    pub stafrr: i32,
    /// Motion control word.
    pub mcw: i32,
    /// Output that `axinit` chooses: 6 analogue, 5 PWM.
    pub imode: i64,
    /// Convert with the printed 22.348 and 7.6206e-3.
    pub legacy_scaling: bool,
    /// The sum of the integral part stops growing at its limit.
    pub clamp_sum: bool,
    /// The sum counts by its top 16 bits only.
    pub chip_integral: bool,
    /// Factor behind the regulator.
    pub output_gain: f64,
    /// Place in [`COMMAND_ERRORS`].
    pub command_error: i64,
}

impl Parameters {
    /// Does a command error refuse the whole verb?
    pub fn refuses(&self) -> bool {
        self.command_error == REFUSE
    }
}

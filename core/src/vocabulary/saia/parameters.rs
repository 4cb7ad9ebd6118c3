//! Registers and options of the vocabulary, in the module's own units.

use crate::parameter::Row;
use serde::{Deserialize, Serialize};

/// What a command error does (SAIA-ERR-04).
pub const COMMAND_ERRORS: &[&str] = &["refuse", "log_only", "motor_off"];
/// Place of `refuse` in [`COMMAND_ERRORS`].
pub(super) const REFUSE: i64 = 0;
/// Place of `motor_off` in [`COMMAND_ERRORS`].
pub(super) const MOTOR_OFF: i64 = 2;

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

/// An input register, by its offset in the module's memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Register {
    /// KProp
    KProp,
    /// KInt
    KInt,
    /// KDer
    KDer,
    /// IntL
    IntL,
    /// SampI
    SampI,
    /// MCFac
    McFac,
    /// PosEr
    PosEr,
    /// DestP
    DestP,
    /// BrkP
    BrkP,
    /// Veloc
    Veloc,
    /// Accel
    Accel,
    /// StaFRR
    StaFrr,
    /// MCW
    Mcw,
}

impl Register {
    /// How many there are.
    pub const COUNT: usize = 13;

    /// All of them with their parameters, by offset.
    pub const ALL: [(Register, &'static str); Self::COUNT] = [
        (Register::KProp, "saia.kprop"),
        (Register::KInt, "saia.kint"),
        (Register::KDer, "saia.kder"),
        (Register::IntL, "saia.intl"),
        (Register::SampI, "saia.sampi"),
        (Register::McFac, "saia.mcfac"),
        (Register::PosEr, "saia.poser"),
        (Register::DestP, "saia.destp"),
        (Register::BrkP, "saia.brkp"),
        (Register::Veloc, "saia.veloc"),
        (Register::Accel, "saia.accel"),
        (Register::StaFrr, "saia.stafrr"),
        (Register::Mcw, "saia.mcw"),
    ];

    /// The manual's name in lower case.
    pub fn name(self) -> &'static str {
        self.key().strip_prefix("saia.").unwrap_or_default()
    }

    /// The register of that name.
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL.iter().map(|(register, _)| *register).find(|register| register.name() == name)
    }

    /// The parameter that it is.
    pub fn key(self) -> &'static str {
        Self::ALL.get(self as usize).map_or("", |(_, key)| key)
    }

    /// Place of that parameter in the catalogue, and its row.
    pub fn row(self) -> Option<(u16, &'static Row)> {
        Row::find(self.key())
    }

    /// Values that the commands take from it; none where they depend on the scaling (SAIA-REG-00..06).
    pub fn permitted(self) -> Option<(i64, i64)> {
        match self {
            Self::KProp | Self::KInt | Self::KDer | Self::IntL | Self::PosEr => Some((0, 32_767)),
            Self::SampI => Some((0, 255)),
            _ => None,
        }
    }
}

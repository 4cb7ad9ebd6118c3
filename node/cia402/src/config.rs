//! Configuration of a drive, and of the terminals of a device.

use crate::drive_type::DriveType;
use crate::mode::DriveMode;
use crate::object::Object;
use crate::probe::Probes;
use lineshaft_core::axis::MISSED_CYCLES;
use lineshaft_core::drive::{Capabilities, Terminal};
use lineshaft_core::sync::gear::gcd;

/// Inputs, outputs and encoders of the machine at a device.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Terminals {
    /// Digital inputs. Addresses are bit numbers, counted from 6000h:01, or from bit 0 of 60FDh of a drive.
    pub digital_inputs: Vec<Terminal>,
    /// Digital outputs. Addresses are bit numbers, counted from 6200h:01, or from bit 0 of 60FEh:01 of a drive.
    pub digital_outputs: Vec<Terminal>,
    /// Analog inputs (6401h).
    pub analog_inputs: Vec<AnalogTerminal>,
    /// Analog outputs (6411h).
    pub analog_outputs: Vec<AnalogTerminal>,
    /// Encoders of the machine that this device implements.
    pub encoders: Vec<Encoder>,
}

/// An analog terminal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnalogTerminal {
    /// Place in the machine, and channel from 0.
    pub terminal: Terminal,
    /// Voltage at 7FFFh, in V.
    pub volts_at_full_scale: f64,
}

/// An encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Encoder {
    /// Place among the encoders of the machine.
    pub place: usize,
    /// Whether the position remains valid after a power cycle.
    pub is_absolute: bool,
}

/// Configuration of a drive.
#[derive(Clone, Debug)]
pub struct DriveConfig {
    /// Place among the drives of the machine.
    pub place: usize,
    /// Name of the axis.
    pub axis: String,
    /// Object number of the axis.
    pub object: u16,
    /// Edges that the touch probes capture.
    pub probes: Probes,
    /// Mode of operation.
    pub mode: DriveMode,
    /// DRIVETYPE of MACS, if the cell selects the drive by it.
    pub drive_type: Option<DriveType>,
    /// Capabilities of the drive according to the cell.
    pub offers: Capabilities,
    /// Counts per shaft revolution according to the cell, as a fraction; `None`: unknown.
    pub counts_per_shaft_revolution: Option<(u64, u64)>,
    /// Velocity unit of the drive.
    pub velocity: VelocityFactor,
    /// Behaviour while process data of the drive is missing.
    pub missed: MissingDataBehaviour,
    /// Effort of the axis at the rated torque of the drive (6076h), in N or Nm; `None` if the cell does not give it.
    pub rated_effort: Option<f64>,
}

impl DriveConfig {
    /// Returns a drive in csp with default settings, for benchmarks and tests.
    pub fn plain(place: usize) -> Self {
        Self {
            place,
            axis: format!("x{place}"),
            object: 0,
            probes: [None; 2],
            mode: DriveMode::Csp,
            drive_type: None,
            offers: Capabilities { delay: 1, position: true, homes: true, ..Capabilities::default() },
            counts_per_shaft_revolution: None,
            velocity: VelocityFactor::default(),
            missed: MissingDataBehaviour::default(),
            rated_effort: None,
        }
    }
}

/// Behaviour while process data of a drive is missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MissingDataBehaviour {
    /// Number of cycles without process data that are tolerated.
    pub cycles: u32,
    /// Whether the position is extrapolated with the last velocity meanwhile; otherwise it stays.
    pub extrapolates: bool,
}

impl Default for MissingDataBehaviour {
    fn default() -> Self {
        Self { cycles: MISSED_CYCLES, extrapolates: false }
    }
}

/// Required identity of a device (1018h); `None` is not checked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Identity {
    /// Vendor ID.
    pub vendor: Option<u32>,
    /// Product code.
    pub product: Option<u32>,
    /// Revision number.
    pub revision: Option<u32>,
    /// Serial number.
    pub serial: Option<u32>,
}

/// Velocity unit of a drive: `numerator / denominator` units are one count per second (the inverse of 6096h).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityFactor {
    /// Velocity units of the drive.
    pub numerator: u32,
    /// Counts per second.
    pub denominator: u32,
}

impl Default for VelocityFactor {
    fn default() -> Self {
        Self { numerator: 1, denominator: 1 }
    }
}

impl VelocityFactor {
    /// Returns the factor for 1/1000 rpm of a shaft with `counts` counts in `turns` revolutions (MACS-CAN-12); `None` if it does not fit 32
    /// bits.
    pub fn for_millirpm(counts: u64, turns: u64) -> Option<Self> {
        let (numerator, denominator) = (turns.checked_mul(60_000)?, counts);
        let divisor = gcd(numerator, denominator);
        let part = |of: u64| u32::try_from(of.checked_div(divisor)?).ok().filter(|part| *part != 0);
        Some(Self { numerator: part(numerator)?, denominator: part(denominator)? })
    }

    /// Converts counts/s to the velocity unit of the drive; saturates.
    pub fn to_drive(self, counts_per_s: f64) -> i64 {
        (counts_per_s * f64::from(self.numerator) / f64::from(self.denominator)).round() as i64
    }
}

/// Write of an object.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Write {
    /// Object.
    pub object: Object,
    /// Bytes of the value.
    pub data: Vec<u8>,
}

/// Returns the interpolation time period (60C2h): value and power of ten, in seconds; `None` if 8 bits cannot represent the cycle.
pub fn interpolation_period(cycle_ns: u64) -> Option<(u8, i8)> {
    let (mut value, mut index) = (cycle_ns, -9_i8);
    while value != 0 && value.is_multiple_of(10) {
        (value, index) = (value / 10, index + 1);
    }
    // Drives support 10^-3 rather than 10^-2.
    while index > -3 && value <= u64::from(u8::MAX) / 10 {
        (value, index) = (value * 10, index - 1);
    }
    u8::try_from(value).ok().filter(|value| *value > 0).map(|value| (value, index))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolation_time_period_fits_8_bits() {
        let us = 1_000;
        assert_eq!(interpolation_period(1_000 * us), Some((1, -3)));
        assert_eq!(interpolation_period(4_000 * us), Some((4, -3)));
        assert_eq!(interpolation_period(20_000 * us), Some((20, -3)));
        assert_eq!(interpolation_period(125 * us), Some((125, -6)));
        assert_eq!(interpolation_period(2_500 * us), Some((25, -4)));
        assert_eq!(interpolation_period(1_001 * us), None);
    }

    #[test]
    fn velocities_are_converted_and_saturate() {
        // Revolutions per minute of a motor with 10,000 counts per revolution.
        let factor = VelocityFactor { numerator: 60, denominator: 10_000 };
        assert_eq!(factor.to_drive(-25_000.0), -150);
        assert_eq!(factor.to_drive(f64::INFINITY), i64::MAX);
    }

    /// 3000 rpm of a motor with 4096 counts per revolution are 204,800 counts/s, which is 3,000,000 in units of 1/1000 rpm.
    ///
    /// Proves: MACS-O-57
    #[test]
    fn akd_velocity_unit_is_thousandth_rpm() {
        let factor = VelocityFactor::for_millirpm(4096, 1).unwrap();
        assert_eq!(factor, VelocityFactor { numerator: 1875, denominator: 128 });
        assert_eq!([factor.to_drive(204_800.0), factor.to_drive(-102_400.0)], [3_000_000, -1_500_000]);
        assert_eq!(VelocityFactor::for_millirpm(20_000, 3), Some(VelocityFactor { numerator: 9, denominator: 1 }));
        assert_eq!([VelocityFactor::for_millirpm(0, 1), VelocityFactor::for_millirpm(1, u64::MAX)], [None, None]);
        assert_eq!(VelocityFactor::for_millirpm((1 << 40) + 1, 1), None, "two numbers of 32 bits do not say it");
    }
}

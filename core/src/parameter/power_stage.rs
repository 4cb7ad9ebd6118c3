//! Parameters of a power stage that takes voltages: the current loop in this program, and the motor.

use super::Amplifier;
use crate::code::Code;
use crate::regulator::CurrentGains;
use serde::{Deserialize, Serialize};

/// Counts of the full current: its measurement has 15 bits and a sign, like KU with 2^-15.
const FULL_COUNTS: f64 = 32_768.0;

/// Parameters of one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PowerStage {
    /// Current for output 1 of the loop above the current loop (A).
    pub full_current: Option<f64>,
    /// CURKPROP
    pub proportional: i64,
    /// CURKINT
    pub integral: i64,
    /// CURKILIM
    pub limit: i64,
    /// AMPCOMMTYPE
    pub commutation: i64,
}

impl PowerStage {
    /// Returns the gains of the current loop, with one sample per cycle; its voltage is a fraction of that of
    /// max_effort.
    pub fn gains(&self) -> CurrentGains {
        CurrentGains {
            proportional: self.proportional as f64,
            integral: self.integral as f64,
            limit: self.limit as f64,
            voltage: 1.0,
            scale: self.full_current.map_or(1.0, |full| FULL_COUNTS / full),
        }
    }

    /// Returns the setpoint of the current for an output of the loop above, -1 to 1 (A), limited to AMPMAXCUR.
    pub fn setpoint(&self, output: f64, amplifier: &Amplifier) -> f64 {
        crate::regulator::capped(output * self.full_current.unwrap_or_default(), self.most_current(amplifier))
    }

    /// Returns the maximum setpoint of the current (A).
    pub fn most_current(&self, amplifier: &Amplifier) -> f64 {
        self.full_current.unwrap_or_default().min(amplifier.max_current as f64 / 1000.0)
    }

    /// Returns the maximum output of the loop above, 0 to 1: AMPMAXCUR if there is a current loop; a voltage has no
    /// limit.
    pub fn most(&self, amplifier: &Amplifier) -> f64 {
        match self.full_current {
            Some(full) if amplifier.has_current_loop() => (self.most_current(amplifier) / full).clamp(0.0, 1.0),
            _ => 1.0,
        }
    }

    /// Checks that the loops of an axis with interface voltage can run with these parameters.
    ///
    /// # Errors
    /// The key of the invalid parameter, and the reason.
    pub fn check(&self, amplifier: &Amplifier, cycle_ns: u64) -> Result<(), (&'static str, Code)> {
        if !matches!(self.commutation, 0 | 1) {
            return Err(("ampcommtype", Code::COMMUTATION));
        }
        if amplifier.has_current_loop() {
            if amplifier.torque_constant == 0.0 {
                return Err(("torque_constant", Code::CURRENT_LOOP));
            }
            if self.full_current.is_none() {
                return Err(("full_current", Code::CURRENT_LOOP));
            }
        }
        amplifier.check_loops(cycle_ns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stage() -> PowerStage {
        PowerStage { full_current: Some(8.0), proportional: 512, integral: 256, limit: 100, commutation: 1 }
    }

    /// 8 A are 32768 counts: 4096 per A. 512/4096 of the voltage for the full current, and 256/1024 for each sample of
    /// it.
    ///
    /// Proves: MACS-AMP-07
    #[test]
    fn gains_are_parts_of_the_voltage_for_parts_of_the_full_current() {
        let gains = stage().gains();
        assert_eq!(gains.scale, 4096.0);
        assert!(gains.is_sound());
        let mut law = crate::regulator::CurrentLoop::default();
        assert_eq!(law.step(&gains, 1.0), (512.0 / 4096.0 + 256.0 / 1024.0) / 8.0);
        assert_eq!(law.step(&gains, 1.0), (512.0 / 4096.0 + 2.0 * 256.0 / 1024.0) / 8.0);
    }

    /// Proves: MACS-AMP-08
    #[test]
    fn ampmaxcur_caps_the_setpoint_where_there_is_a_current_loop() {
        for (mode, milliamperes, most, setpoint) in [
            (0, 2_000, 0.25, 2.0),
            (2, 2_000, 0.25, 2.0),
            (2, 60_000, 1.0, 8.0),
            (0, 0, 0.0, 0.0),
            (1, 2_000, 1.0, 2.0),
        ] {
            let amplifier = Amplifier { mode, max_current: milliamperes, ..Amplifier::default() };
            assert_eq!(stage().most(&amplifier), most, "{mode}, {milliamperes} mA");
            assert_eq!(stage().setpoint(1.0, &amplifier), setpoint, "{mode}, {milliamperes} mA");
            assert_eq!(stage().setpoint(-1.0, &amplifier), -setpoint, "{mode}, {milliamperes} mA");
        }
        assert_eq!(stage().setpoint(f64::NAN, &Amplifier { max_current: 2_000, ..Amplifier::default() }), 0.0);
    }
}

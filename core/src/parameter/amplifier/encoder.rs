//! Parameters of a separate encoder of the velocity loop.
//!
//! Law      AMPENCNO -1: the velocity loop uses the encoder of the position loop; n: the encoder in the drive of axis
//!          n, with AMPENCRES increments per turn and AMPENCRPM turns per minute at full velocity; AMPENCRPM 0: VELMAX
//! Refuses  another axis than its own, an axis with two drives, an encoder without a turn
//! Source   MACS-AMP-06, D01, D02

use super::super::AxisParameters;
use crate::code::Code;
use serde::{Deserialize, Serialize};

/// Values of AMPENCNO, AMPENCRES and AMPENCRPM.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct VelocityEncoder {
    /// AMPENCNO
    pub number: i64,
    /// AMPENCRES (inc/turn); -1: not set.
    pub resolution: i64,
    /// AMPENCRPM (1/min); 0: VELMAX.
    pub rpm: i64,
}

impl VelocityEncoder {
    /// Returns true if the velocity loop has a separate encoder.
    pub fn is_separate(self) -> bool {
        self.number >= 1
    }

    /// Checks that the axis of that number, from 1, can use it.
    ///
    /// # Errors
    /// The key of the invalid parameter, and the reason.
    pub fn check(self, own: usize, has_two_drives: bool) -> Result<(), (&'static str, Code)> {
        if !self.is_separate() {
            return Ok(());
        }
        if has_two_drives {
            return Err(("ampencno", Code::VELOCITY_ENCODER_TWO_DRIVES));
        }
        if usize::try_from(self.number) != Ok(own) {
            return Err(("ampencno", Code::VELOCITY_ENCODER_OTHER));
        }
        if self.resolution < 1 {
            return Err(("ampencres", Code::VELOCITY_ENCODER_TURN));
        }
        Ok(())
    }
}

impl AxisParameters {
    /// Returns true if its velocity loop uses another encoder than its position loop.
    #[inline]
    pub fn has_velocity_encoder(&self) -> bool {
        self.amplifier.encoder.is_separate() && self.amplifier.has_velocity_loop()
    }

    /// Returns true if both loops have different directions of counting.
    pub(crate) fn has_loop_directions(&self) -> bool {
        let sense = self.sense();
        sense.position != sense.velocity
    }

    /// Returns the full velocity of the encoder of the velocity loop, for the full velocity `full` of the axis (both in
    /// their own increments per second).
    pub(crate) fn full_of_velocity_encoder(&self, full: f64) -> f64 {
        let VelocityEncoder { resolution, rpm, .. } = self.amplifier.encoder;
        let turns = if rpm > 0 { rpm as f64 / 60.0 } else { full / self.revolution() as f64 };
        turns * resolution as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameters(resolution: i64, rpm: i64) -> AxisParameters {
        let mut p = AxisParameters::new(100_000.0, 1e6);
        p.amplifier.encoder = VelocityEncoder { number: 1, resolution, rpm };
        p
    }

    /// 3000 rpm are 50 turns per second, of 65536 inc each, independently of the axis.
    ///
    /// Proves: MACS-AMP-06
    #[test]
    fn the_full_velocity_is_that_of_ampencrpm_or_turn_for_turn_that_of_velmax() {
        assert_eq!(parameters(65_536, 3_000).full_of_velocity_encoder(100_000.0), 50.0 * 65_536.0);
        assert_eq!(parameters(65_536, 3_000).full_of_velocity_encoder(7.0), 50.0 * 65_536.0);
        // ENCODER 500 is 2000 inc per turn: 100000 inc/s are 50 turns per second, VELMAX 3000.
        assert_eq!(parameters(65_536, 0).full_of_velocity_encoder(100_000.0), 50.0 * 65_536.0);
        assert_eq!(parameters(65_536, 0).velmax(), 3_000.0);
        assert_eq!(parameters(1, 1).full_of_velocity_encoder(1.0), 1.0 / 60.0);
    }

    #[test]
    fn the_axis_itself_with_a_turn_is_all_that_is_taken() {
        let check = |number, resolution, two| VelocityEncoder { number, resolution, rpm: 0 }.check(2, two);
        assert_eq!(check(-1, -1, true), Ok(()));
        assert_eq!(check(2, 1, false), Ok(()));
        assert_eq!(check(2, -1, false), Err(("ampencres", Code::VELOCITY_ENCODER_TURN)));
        for number in [1, 3, 1 << 30, i64::MAX] {
            assert_eq!(check(number, 1, false), Err(("ampencno", Code::VELOCITY_ENCODER_OTHER)), "{number}");
        }
        assert_eq!(check(2, 1, true), Err(("ampencno", Code::VELOCITY_ENCODER_TWO_DRIVES)));
    }

    /// Proves: MACS-AMP-06
    #[test]
    fn without_a_velocity_loop_there_is_no_encoder_of_it() {
        let mut p = parameters(1, 0);
        assert!(p.has_velocity_encoder());
        p.amplifier.mode = 2;
        assert!(!p.has_velocity_encoder());
        assert!(!AxisParameters::new(1.0, 1.0).has_velocity_encoder());
    }
}

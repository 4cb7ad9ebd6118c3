//! Unit factors of MACS.
//!
//! Law      qc = UU * (FEEDREV * POSFACT_Z * POSENCQC) / (FEEDDIST * POSFACT_N * POSENCREV)
//! Refuses  a factor outside 1..MLONG; a position beyond +-MLONG qc
//! Source   MACS-UNIT-01, -02, -04, -05

use super::{Fraction, UnitError, round};
use num_traits::{CheckedDiv, CheckedMul, Signed};

/// 2^30 - 1: the largest position and the largest factor of MACS.
pub const MLONG: i64 = (1 << 30) - 1;

/// The six factors by their names in MACS, each 1..MLONG; the defaults are 1, except POSFACT_Z and POSFACT_N with 1000.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[expect(missing_docs, reason = "the names are the documentation: MACS-UNIT-01 defines them by one formula")]
pub struct MacsFactors {
    pub posfact_z: i64,
    pub posfact_n: i64,
    pub feeddist: i64,
    pub feedrev: i64,
    pub posencqc: i64,
    pub posencrev: i64,
}

impl Default for MacsFactors {
    fn default() -> Self {
        Self { posfact_z: 1000, posfact_n: 1000, feeddist: 1, feedrev: 1, posencqc: 1, posencrev: 1 }
    }
}

impl MacsFactors {
    /// Returns POSFACT_Z : POSFACT_N of a mechanism: `gear * counts * (4 if quadrature) / scaling`, reduced.
    ///
    /// `gear` motor revolutions per output revolution; `counts` of the encoder per motor revolution, multiplied by four
    /// unless the encoder is absolute; `scaling` user units per output revolution. All above 0.
    ///
    /// # Errors
    /// [`UnitError::NotPositive`]; [`UnitError::MacsFactor`] if the reduced fraction is outside 1..MLONG.
    pub fn of_mechanism(gear: Fraction, counts: i64, quadrature: bool, scaling: Fraction) -> Result<Self, UnitError> {
        let counts = Fraction::from(i128::from(counts));
        for (part, value) in [("gear", gear), ("counts", counts), ("scaling", scaling)] {
            if !value.is_positive() {
                return Err(UnitError::NotPositive { part, value });
            }
        }
        let factor =
            (counts * if quadrature { 4 } else { 1 }).checked_mul(&gear).and_then(|qc| qc.checked_div(&scaling));
        let too_large = |value| UnitError::MacsFactor { name: "POSFACT_Z", value };
        let factor = factor.ok_or(too_large(i128::MAX))?;
        let posfact_z = i64::try_from(*factor.numer()).map_err(|_| too_large(*factor.numer()))?;
        let posfact_n = i64::try_from(*factor.denom())
            .map_err(|_| UnitError::MacsFactor { name: "POSFACT_N", value: *factor.denom() })?;
        let factors = Self { posfact_z, posfact_n, ..Self::default() };
        factors.increments_per_user_unit().map(|_| factors)
    }

    /// Returns SYNCFACTM : SYNCFACTS of a master for cams: the increments of one master unit, calculated like those of
    /// a user unit (MACS-UNIT-07).
    ///
    /// # Errors
    /// As [`MacsFactors::of_mechanism`].
    pub fn of_cam_master(
        gear: Fraction,
        counts: i64,
        quadrature: bool,
        scaling: Fraction,
    ) -> Result<(i64, i64), UnitError> {
        Self::of_mechanism(gear, counts, quadrature, scaling).map(|factors| (factors.posfact_z, factors.posfact_n))
    }

    /// Returns a scale as POSFACT_Z : POSFACT_N; `None` if its numbers are outside 1..MLONG.
    pub fn of_ratio(per_unit: &Fraction) -> Option<Self> {
        let part = |number: &i128| i64::try_from(*number).ok().filter(|number| (1..=MLONG).contains(number));
        let (posfact_z, posfact_n) = (part(per_unit.numer())?, part(per_unit.denom())?);
        Some(Self { posfact_z, posfact_n, ..Self::default() })
    }

    /// Returns quadcounts per user unit, exact.
    ///
    /// # Errors
    /// [`UnitError::MacsFactor`] for the first factor outside 1..MLONG.
    pub fn increments_per_user_unit(&self) -> Result<Fraction, UnitError> {
        let above = [("FEEDREV", self.feedrev), ("POSFACT_Z", self.posfact_z), ("POSENCQC", self.posencqc)];
        let below = [("FEEDDIST", self.feeddist), ("POSFACT_N", self.posfact_n), ("POSENCREV", self.posencrev)];
        // Three factors below 2^30 each: no product reaches 2^90.
        Ok(Fraction::new(product(above)?, product(below)?))
    }

    /// Returns the quadcounts of a position in user units: nearest, half away from zero, within +-MLONG.
    ///
    /// # Errors
    /// [`UnitError::MacsPosition`]; [`UnitError::MacsFactor`].
    pub fn increments(&self, user_units: &Fraction) -> Result<i64, UnitError> {
        let exact = user_units.checked_mul(&self.increments_per_user_unit()?);
        exact
            .as_ref()
            .and_then(round)
            .filter(|whole| whole.abs() <= MLONG)
            .ok_or(UnitError::MacsPosition { user_units: *user_units, increments: exact })
    }
}

fn product(factors: [(&'static str, i64); 3]) -> Result<i128, UnitError> {
    factors.into_iter().try_fold(1, |product, (name, value)| match value {
        1..=MLONG => Ok(product * i128::from(value)),
        _ => Err(UnitError::MacsFactor { name, value: value.into() }),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle O-01: gear 25:1, 500 counts, 5 mm per revolution in 1/10 mm gives 1000 qc per user unit.
    ///
    /// Proves: MACS-UNIT-02, MACS-O-01
    #[test]
    fn a_spindle() {
        let spindle = MacsFactors::of_mechanism(Fraction::from(25), 500, true, Fraction::from(50)).unwrap();
        assert_eq!((spindle.posfact_z, spindle.posfact_n), (1000, 1));
        assert_eq!(spindle.increments(&Fraction::from(1)), Ok(1000));
    }

    /// A master of 512 counts, one turn of which is 360 MU: 256 qc are 45 MU, however the fraction was calculated.
    ///
    /// Proves: MACS-UNIT-07
    #[test]
    fn a_master_for_cams() {
        let master = MacsFactors::of_cam_master(Fraction::from(1), 512, true, Fraction::from(360));
        // 2048 / 360, reduced: SYNCFACTM : SYNCFACTS.
        assert_eq!(master, Ok((256, 45)));
        assert!(MacsFactors::of_cam_master(Fraction::from(1), 0, true, Fraction::from(360)).is_err());
    }

    /// The factor 4 does not apply to an absolute encoder, and the fraction stays exact.
    ///
    /// Proves: MACS-UNIT-02
    #[test]
    fn an_absolute_encoder_is_not_counted_fourfold() {
        let table = MacsFactors::of_mechanism(Fraction::new(7, 3), 4096, false, Fraction::from(360)).unwrap();
        assert_eq!(table.increments_per_user_unit(), Ok(Fraction::new(7 * 4096, 3 * 360)));
    }

    /// Oracle O-03: 50375 : 1000 gives 50.375 qc per user unit and 403 qc for 8.
    ///
    /// Proves: MACS-UNIT-02, MACS-O-03
    #[test]
    fn a_fraction() {
        let factors = MacsFactors { posfact_z: 50375, posfact_n: 1000, ..MacsFactors::default() };
        assert_eq!(factors.increments_per_user_unit(), Ok(Fraction::new(50375, 1000)));
        assert_eq!(factors.increments(&Fraction::from(8)), Ok(403));
    }

    /// Oracle O-04: FEEDREV 1, FEEDDIST 5000, Z:N 25:1, POSENCQC 2000, POSENCREV 1 gives 1230 qc for 123.
    ///
    /// Proves: MACS-UNIT-01, MACS-O-04
    #[test]
    fn all_six_factors() {
        let factors =
            MacsFactors { posfact_z: 25, posfact_n: 1, feeddist: 5000, feedrev: 1, posencqc: 2000, posencrev: 1 };
        assert_eq!(factors.increments(&Fraction::from(123)), Ok(1230));
    }

    /// Proves: MACS-UNIT-01
    #[test]
    fn the_canopen_factors_are_1_by_default() {
        let factors = MacsFactors { posfact_z: 7, posfact_n: 2, ..MacsFactors::default() };
        assert_eq!(factors.increments_per_user_unit(), Ok(Fraction::new(7, 2)));
    }

    /// Halves are rounded away from zero; eight single steps, each converted as an absolute end, arrive at the same
    /// position as one step of 8.
    ///
    /// Proves: MACS-UNIT-05
    #[test]
    fn steps_do_not_drift() {
        let factors = MacsFactors { posfact_z: 50375, posfact_n: 1000, ..MacsFactors::default() };
        let ends: Vec<_> = (1..=8).map(|uu| factors.increments(&Fraction::from(uu)).unwrap()).collect();
        assert_eq!(ends, [50, 101, 151, 202, 252, 302, 353, 403]);
        assert_eq!(factors.increments(&Fraction::from(-4)), Ok(-202));
    }

    /// The product may be large as long as the quadcounts are not.
    ///
    /// Proves: MACS-UNIT-04
    #[test]
    fn only_the_quadcounts_are_limited() {
        let large = MacsFactors {
            posfact_z: MLONG,
            posfact_n: MLONG,
            posencqc: MLONG,
            posencrev: MLONG,
            ..MacsFactors::default()
        };
        assert_eq!(large.increments(&Fraction::from(i128::from(MLONG))), Ok(MLONG));
        let error = large.increments(&Fraction::from(i128::from(-MLONG) - 1)).unwrap_err();
        assert_eq!(
            error.to_string(),
            "-1073741824 user units are -1073741824 qc; -1073741823..1073741823 qc is allowed"
        );
        assert!(MacsFactors { posfact_n: 1, ..large }.increments(&Fraction::from(i128::MAX)).is_err());
    }

    #[test]
    fn a_factor_out_of_range_is_named() {
        for (factors, sentence) in [
            (MacsFactors { posfact_n: 0, ..MacsFactors::default() }, "POSFACT_N is 0; 1..1073741823 is allowed"),
            (MacsFactors { feedrev: -1, ..MacsFactors::default() }, "FEEDREV is -1; 1..1073741823 is allowed"),
            (
                MacsFactors { posfact_z: i64::MAX, ..MacsFactors::default() },
                "POSFACT_Z is 9223372036854775807; 1..1073741823 is allowed",
            ),
        ] {
            assert_eq!(factors.increments(&Fraction::from(1)).unwrap_err().to_string(), sentence);
        }
        assert!(MacsFactors::of_mechanism(Fraction::from(25), 500, true, Fraction::from(0)).is_err());
        assert!(MacsFactors::of_mechanism(Fraction::new(1, 1 << 62), 1, false, Fraction::from(1)).is_err());
    }
}

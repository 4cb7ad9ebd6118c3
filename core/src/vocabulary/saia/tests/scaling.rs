//! Units, registers and read values.

use super::super::scale::{self, Scaling};
use super::super::{HIGHEST, Parameters};
use super::rig::{FAST, Rig, X};
use crate::parameter::Value;
use proptest::prelude::*;

fn scaling(mcfac: f64, legacy_scaling: bool) -> Scaling {
    Scaling::of(&Parameters { mcfac, legacy_scaling, ..Parameters::default() })
}

/// k = 4 In / s: 4 * 1000 pulses over 3000 um; 4 * 500 over 20 tenths of a millimetre.
///
/// Proves: SAIA-ORA-01, SAIA-SCL-01, SAIA-SCL-02, SAIA-SCL-03
#[test]
fn units_become_counts_rounded_half_away_from_zero() {
    assert_eq!(scaling(1.33333, false).counts(60_000), 80_000); // 79 999.8
    assert_eq!(scaling(4.0 * 1000.0 / 3000.0, false).counts(60_000), 20 * 4000);
    assert_eq!(scaling(4.0 * 500.0 / 20.0, false).counts(1000), 100_000);
    assert_eq!(scaling(0.5, false).counts(1), 1);
    assert_eq!(scaling(0.5, false).counts(-1), -1);
    assert_eq!(scaling(0.5, false).counts(-3), -2);
}

/// Proves: SAIA-ORA-07, SAIA-SCL-04, SAIA-SCL-05, SAIA-SW-02
#[test]
fn rates_become_registers_in_parts_of_a_sample() {
    let (exact, legacy) = (scaling(100.0, false), scaling(100.0, true));
    assert_eq!((exact.velocity(500), legacy.velocity(500)), (1_118_481, 1_117_400));
    assert_eq!((exact.acceleration(100), legacy.acceleration(100)), (76, 76));
    // 76.35 and 76.21: only ten times the value shows the difference.
    assert_eq!((exact.acceleration(1000), legacy.acceleration(1000)), (764, 762));
    // One step of the registers: 0.0447 counts/s and 131 counts/s^2.
    assert!((scale::velocity_of(1.0) - 0.0447).abs() < 5e-5);
    assert!((scale::acceleration_of(1.0) - 131.0).abs() < 0.05);
    // The actual velocity is the commanded one.
    assert!((scale::velocity_of(1_118_481.0) - 50_000.0).abs() < 0.0224);
}

/// Proves: SAIA-ORA-14, SAIA-CAP-08, SAIA-SCL-07
#[test]
fn the_velocity_register_ends_just_below_480_000_tenths_of_a_millimetre() {
    let exact = scaling(100.0, false);
    assert_eq!(exact.velocity(480_000), HIGHEST + 1);
    assert!(exact.velocity(479_999) <= HIGHEST);
    assert_eq!(HIGHEST, 1_073_741_823);
    let mut rig = Rig::ready(FAST);
    rig.does(&[("mcfac", 100.0), ("veloc", 479_999.0)], "fldva");
    let sentence = "saia.veloc with saia.mcfac makes 1073741824 in the velocity register; 0 to 1073741823 is allowed";
    rig.refuses(&[("veloc", 480_000.0)], "fldva", sentence);
    rig.refuses(&[("mcfac", 1.0), ("veloc", -1.0)], "fldva", "-22 in the velocity register; 0 to");
    // Also if it would be rounded to 0.
    rig.refuses(&[("mcfac", 0.01), ("veloc", -1.0)], "fldva", "saia.veloc with saia.mcfac makes -0.22");
    rig.refuses(&[("mcfac", 1.0), ("accel", -3.0)], "fldaa", "saia.accel with saia.mcfac makes -0.022");
}

/// Proves: SAIA-CAP-07, SAIA-REG-07
#[test]
fn destinations_end_at_two_to_the_30() {
    let mut rig = Rig::ready(FAST);
    rig.does(&[("destp", 1_073_741_823.0)], "fldda");
    rig.does(&[("destp", -1_073_741_824.0)], "fldda");
    let sentence = "saia.destp with saia.mcfac makes 1073741824 counts; -1073741824 to 1073741823 is allowed";
    rig.refuses(&[("destp", 1_073_741_824.0)], "fldda", sentence);
    rig.refuses(&[("destp", -1_073_741_825.0)], "fldda", "makes -1073741825 counts");
    rig.refuses(&[("mcfac", 2.0), ("destp", 536_870_912.0)], "fldda", "makes 1073741824 counts");
    rig.does(&[("destp", 0.0)], "fldda fstart");
    rig.run(5);
    rig.refuses(&[("destp", 1_073_741_824.0)], "flddr", "makes 1073741824 counts");
}

/// 1 / 7.6355e-3 counts/s^2 is one step; 2^30 of them are 140 625 000 000.
///
/// Proves: SAIA-CAP-09, SAIA-REG-10
#[test]
fn the_acceleration_register_ends_at_two_to_the_30() {
    let mut rig = Rig::ready(FAST);
    rig.does(&[("mcfac", 1000.0), ("accel", 140_624_999.0)], "fldaa");
    let sentence =
        "saia.accel with saia.mcfac makes 1073741824 in the acceleration register; 0 to 1073741823 is allowed";
    rig.refuses(&[("accel", 140_625_000.0)], "fldaa", sentence);
    rig.refuses(&[("accel", -1.0)], "fldaa", "in the acceleration register; 0 to");
}

/// Integer bits read as a float make MCFac tiny or huge.
///
/// Proves: SAIA-SCL-09, SAIA-REG-05, SAIA-ERR-02
#[test]
fn a_factor_of_the_wrong_format_makes_a_command_error() {
    let mut rig = Rig::ready(FAST);
    rig.refuses(&[("mcfac", 9.223_371e18), ("destp", 1.0)], "fldda", "counts; -1073741824 to");
    let tiny = f64::from(f32::from_bits(100));
    rig.does(&[("destp", 1000.0)], "fldda fstart");
    rig.run_until("x.saia.ondest", 1);
    rig.refuses(&[("mcfac", tiny)], "frdap", "does not fit its register of 32 bits");
    rig.refuses(&[("mcfac", 0.0)], "frdap", "with saia.mcfac 0 what is read does not fit");
    assert_eq!(rig.int("x.saia.ractp"), 0);
    rig.does(&[("mcfac", 1.0)], "frdap");
    assert_eq!(rig.int("x.saia.ractp"), 1000);
}

/// The original loses counts above 2^24; f64 does not.
///
/// Proves: SAIA-SCL-08
#[test]
fn no_count_is_lost_above_two_to_the_24() {
    let one = scaling(1.0, false);
    for count in [16_777_217, 16_777_219, 1_073_741_823] {
        assert_eq!((one.counts(count), one.units(count.into())), (count.into(), Some(count)));
    }
}

/// Proves: SAIA-ORA-12, SAIA-DET-11, SAIA-CMD-20, SAIA-REG-15, SAIA-SCL-06
#[test]
fn the_actual_velocity_is_read_in_whole_counts_a_sample() {
    let read = |velocity: f64| scaling(100.0, false).units_of_velocity(scale::counts_a_sample(velocity) * 65_536.0);
    assert_eq!(scale::counts_a_sample(50_000.0), 17.0);
    assert_eq!((read(50_000.0), read(10_000.0)), (Some(498), Some(88)));
    // One count per sample is 2929.7 counts/s.
    assert!((scale::velocity_of(65_536.0) - 2929.7).abs() < 0.05);
    assert_eq!(read(2929.0), Some(0));
    // Signed (A24): truncated bits give the lower value.
    assert_eq!(read(-10_000.0), Some(-117));

    let mut rig = Rig::moving();
    rig.does(&[("mcfac", 100.0)], "frdav frdsv");
    assert_eq!((rig.int("x.saia.ractv"), rig.int("x.saia.rsetv")), (498, 500));
}

/// Proves: SAIA-SCL-06, SAIA-CMD-21, SAIA-REG-16
#[test]
fn the_printed_constants_read_back_what_they_loaded() {
    let mut rig = Rig::saia();
    rig.run(5);
    rig.parameter("saia.legacy_scaling", Value::Int(1));
    rig.does(&[("mcfac", 100.0), ("veloc", 500.0), ("accel", 10_000.0), ("destp", 1000.0)], "axinit fldda fstart");
    assert_eq!(rig.int("x.saia.velocity_register"), 1_117_400);
    rig.run(200);
    // The register is quantized by the sample of the chip: 1 117 400 steps are 49 951.7 counts/s.
    assert!((rig.real("x.command.velocity") - 49_951.7).abs() < 0.05);
    rig.does(&[], "frdsv");
    assert_eq!(rig.int("x.saia.rsetv"), 500);
}

/// Registers are quantized, so a limit of the axis applies to half a step.
#[test]
fn a_rate_at_the_limit_of_the_axis_is_taken_and_never_exceeded() {
    let mut config = super::rig::config();
    config.axes[0].parameters.max_velocity = 49_999.99;
    config.axes[0].parameters.max_acceleration = 9_953.0;
    let mut rig = Rig::of(config);
    // 1 118 481 steps are 49 999.997 counts/s, 76 steps 9953.5 counts/s^2.
    rig.does(&[("mcfac", 100.0), ("veloc", 500.0), ("accel", 100.0), ("destp", 3000.0)], "axinit fldda fstart");
    for _ in 0..8_000 {
        rig.run(1);
        assert!(rig.real("x.command.velocity") <= 49_999.99);
        assert!(rig.real("x.command.acceleration") <= 9_953.0);
    }
    let refused = |rig: &mut Rig, register: &str, value: f64, flag: &str, part: &str| {
        let sentence = rig.verb(X, &[(register, value)], &format!("{flag} fstart")).unwrap_err();
        assert!(sentence.contains(part), "{sentence}");
    };
    refused(&mut rig, "veloc", 501.0, "fldva", "exceeds max_velocity 49.99999 mm/s");
    refused(&mut rig, "accel", 102.0, "fldaa", "exceeds max_acceleration");
}

proptest! {
    /// Proves: SAIA-SCL-06
    #[test]
    fn loaded_values_read_back(units in -1_000_000..1_000_000_i32, k in 1.0..1000.0_f64, legacy: bool) {
        let scaling = scaling(k, legacy);
        prop_assert_eq!(scaling.units(scaling.counts(units)), Some(units));
        prop_assert_eq!(scaling.units_of_velocity(scaling.velocity(units) as f64), Some(units));
    }

    #[test]
    fn no_value_makes_a_conversion_fail(units: i32, bits: u64, counts: i64) {
        let scaling = scaling(f64::from_bits(bits), bits & 1 == 1);
        let _ = (scaling.counts(units), scaling.velocity(units), scaling.acceleration(units));
        let _ = (scaling.units(counts), scaling.units_of_velocity(counts as f64));
    }
}

//! Tests unit factors of MACS instead of scale, and views of MACS instead of native keys.

use super::{HEAD, good, said};
use lineshaft_core::config::AxisConfig;

/// Returns an axis with these keys, from line 8, column 5, after its type and drive.
fn axis(keys: &[(&str, &str)]) -> String {
    let line = |(key, value): &(&str, &str)| format!("    {key}: {value}\n");
    let drive = "    type: linear\n    drive: {backend: plant, address: 0}\n";
    format!("{HEAD}axes:\n  x:\n{}{drive}", keys.iter().map(line).collect::<String>())
}

const RATES: [(&str, &str); 2] = [("max_velocity", "1000 inc/s"), ("max_acceleration", "5000 inc/s^2")];

fn with(keys: &[(&'static str, &'static str)]) -> String {
    axis(&[keys, &RATES].concat())
}

fn read(text: &str) -> AxisConfig {
    good(text).machine.axes.remove(0)
}

/// Oracle O-03: Z 50375, N 1000: 8 user units are 403 increments. The user unit is the axis unit.
///
/// Proves: MACS-UNIT-02, MACS-O-03
#[test]
fn fraction_replaces_scale() {
    let keys = |unit, max_position| {
        with(&[("unit", unit), ("posfact_z", "50375"), ("posfact_n", "1000"), ("max_position", max_position)])
    };
    for (max_position, increments) in [("8 mm", 403), ("1 mm", 50), ("-4 mm", -202)] {
        assert_eq!(read(&keys("mm", max_position)).parameters.max_position, Some(increments));
    }
    assert_eq!(read(&keys("cm", "8 cm")).parameters.max_position, Some(403));
    // Without a unit, the user unit is a metre.
    let text = with(&[("posfact_z", "50375"), ("posfact_n", "1000"), ("max_position", "8 m")]);
    assert_eq!(read(&text).parameters.max_position, Some(403));
    // The numbers are stored as given.
    let factors = read(&keys("mm", "8 mm")).parameters.macs.scale.unwrap();
    assert_eq!((factors.posfact_z, factors.posfact_n), (50_375, 1000));
}

/// Oracle O-04: FEEDREV 1, FEEDDIST 5000, Z : N 25 : 1, POSENCQC 2000, POSENCREV 1: 123 user units are 1230 increments.
///
/// Proves: MACS-UNIT-01, MACS-O-04
#[test]
fn the_factors_of_canopen_take_part() {
    let text = with(&[
        ("unit", "mm"),
        ("posfact_z", "25"),
        ("posfact_n", "1"),
        ("feedrev", "1"),
        ("feeddist", "5000"),
        ("posencqc", "2000"),
        ("posencrev", "1"),
        ("max_position", "123 mm"),
    ]);
    assert_eq!(read(&text).parameters.max_position, Some(1230));
    // The other factors have their defaults of MACS: 1000 / 1000, and 1.
    let text = with(&[("unit", "mm"), ("posencqc", "2000"), ("max_position", "3 mm")]);
    assert_eq!(read(&text).parameters.max_position, Some(6000));
}

/// A user unit of a tenth of a millimetre: each has 100 increments, and the position is as written.
#[test]
fn a_user_unit_may_be_a_share_of_a_unit() {
    let text = with(&[
        ("unit", "0.1 mm"),
        ("posfact_z", "100"),
        ("posfact_n", "1"),
        ("max_position", "8 mm"),
        ("poslimit", "80"),
    ]);
    let both = said(&text);
    assert!(both.contains("poslimit"), "one of them stands: {both}");
    for key in [("max_position", "8 mm"), ("max_position", "8000 inc")] {
        let text = with(&[("unit", "0.1 mm"), ("posfact_z", "100"), ("posfact_n", "1"), key]);
        assert_eq!(read(&text).parameters.max_position, Some(8000));
        assert_eq!(read(&text).scale.format_increments(8000), "80 * 0.1 mm");
    }
}

/// The largest factors of MACS, with positions beyond its 31 bits.
#[test]
fn large_factors_are_exact() {
    let text = with(&[("unit", "mm"), ("posfact_z", "1073741823"), ("posfact_n", "1"), ("max_position", "1 mm")]);
    assert_eq!(read(&text).parameters.max_position, Some(1_073_741_823));
    let text =
        with(&[("unit", "mm"), ("posfact_z", "1073741823"), ("posfact_n", "1073741822"), ("max_position", "1 m")]);
    assert_eq!(read(&text).parameters.max_position, Some(1000));
}

#[test]
fn what_is_wrong_with_factors_has_its_place() {
    for (keys, expected) in [
        (
            &[("scale", "{increments: 1, per: 1 mm}"), ("posfact_z", "5")][..],
            "8:12: scale stands beside the unit factors of MACS, which say the same, write one of them",
        ),
        (&[("posfact_z", "0")][..], "8:16: posfact_z is `0`; 1 to 1073741823 is allowed"),
        (&[("posfact_n", "1073741824")][..], "8:16: posfact_n is `1073741824`; 1 to 1073741823 is allowed"),
        (&[("feedrev", "1.5")][..], "8:14: feedrev is `1.5`; a whole number, 1 to 1073741823, is expected"),
        (&[("unit", "deg"), ("posfact_z", "5")][..], "8:11: unit is `deg`; one of nm, um, mm, cm, m, inc is allowed"),
        // The most similar name is that of an increment, which is never meant by it.
        (
            &[("unit", "inch"), ("posfact_z", "5")][..],
            "8:11: unit is `inch`; one of nm, um, mm, cm, m, inc is allowed, an inch is `25.4 mm`",
        ),
    ] {
        assert_eq!(said(&with(keys)), expected);
    }
}

/// The factors are increments per axis unit; a radian is no exact fraction of a revolution, but its position is
/// correct.
#[test]
fn rotary_axes_have_factors_too() {
    let rotary = |unit: &'static str, end: &'static str| {
        with(&[("unit", unit), ("posfact_z", "100"), ("posfact_n", "1"), ("max_position", end)])
            .replace("type: linear", "type: rotary")
    };
    for (unit, end, increments) in
        [("deg", "90 deg", 9000), ("rev", "1.5 rev", 150), ("rad", "1 rad", 100), ("rad", "1000000 rad", 100_000_000)]
    {
        assert_eq!(read(&rotary(unit, end)).parameters.max_position, Some(increments), "{unit}");
    }
    assert_eq!(
        said(&rotary("inc", "1 rad")),
        "8:11: unit is `inc`; beside the unit factors of MACS, increments per unit, a length or an angle is allowed"
    );
}

const SCALE: (&str, &str) = ("scale", "{increments: 1000, per: 1 mm}");

fn macs(keys: &[(&'static str, &'static str)]) -> String {
    axis(&[keys, &[("unit", "mm"), SCALE]].concat())
}

/// VELMAX and RAMPMIN replace the required keys: 1500 rpm, 500 lines: 50,000 inc/s, in 500 ms.
///
/// Proves: MACS-PROF-01, MACS-PROF-03
#[test]
fn views_stand_in_the_place_of_required_keys() {
    let p = read(&macs(&[("velmax", "1500"), ("rampmin", "500"), ("dfltvel", "100"), ("jerkmin", "20")])).parameters;
    assert_eq!((p.max_velocity, p.max_acceleration, p.max_jerk), (50_000.0, 100_000.0, Some(5e6)));
    assert_eq!(p.default_velocity, Some(50_000.0));
    // In any order, and with their units.
    let p = read(&macs(&[("rampmin", "0.5 s"), ("encoder", "1000"), ("velmax", "1500")])).parameters;
    assert_eq!((p.max_velocity, p.max_acceleration), (100_000.0, 200_000.0));
    assert_eq!(said(&macs(&[("velmax", "1500")])), "8:5: missing key `max_acceleration` in axis `x`");
}

#[test]
fn views_that_do_not_fit_name_what_was_written() {
    for (keys, expected) in [
        (
            &[("velmax", "1500"), ("max_velocity", "1 m/s"), ("rampmin", "500")][..],
            "8:13: velmax is another view of max_velocity, which is at 9:19, write one of them",
        ),
        (&[("velmax", "1500"), ("rampmin", "500"), ("dfltvel", "101")][..], "10:14: dfltvel 101 exceeds velres 100"),
        (
            &[("velmax", "1500"), ("rampmin", "500"), ("default_acceleration", "1 m/s^2")][..],
            "10:27: default_acceleration 1000 mm/s^2 exceeds max_acceleration 100 mm/s^2 (rampmin)",
        ),
        (
            &[("velmax", "60000"), ("encoder", "1073741823"), ("rampmin", "500")][..],
            "8:13: velmax `60000` makes max_velocity 4294967290 mm/s; up to 2147483648 mm/s is allowed\n",
        ),
        (&[("velmax", "0"), ("rampmin", "500")][..], "8:13: velmax is `0`; 1 to 65535 is allowed"),
        (&[("velmax", "fast"), ("rampmin", "500")][..], "8:13: velmax is `fast`; a finite number is expected"),
        (&[("velmax", "1500"), ("rampmin", "0.5 ms")][..], "9:14: rampmin is `0.5 ms`; 1 ms to 360000 ms is allowed"),
        (
            &[("velmax", "1500"), ("rampmin", "5 mm")][..],
            "9:14: rampmin: `5 mm` is a length; a time such as `5 s` is expected",
        ),
        (
            &[("velmax", "1500"), ("rampmin", "500"), ("velmaxqc", "5")][..],
            "10:15: velmaxqc is computed from other parameters, leave it out",
        ),
        (
            &[("velmax", "1500"), ("rampmin", "500"), ("cannr", "5")][..],
            "10:12: cannr is for the machine, leave it out",
        ),
        (
            &[("velmax", "1500"), ("rampmin", "500"), ("error_reaction", "\"2\"")][..],
            "10:21: error_reaction is `2`; a whole number, 0 to 5, is expected, write it without quotes",
        ),
        (
            &[("velmax", "1500"), ("rampmin", "500"), ("error_reaction", "99999999999999999999")][..],
            "10:21: error_reaction is `99999999999999999999`; 0 to 5 is allowed",
        ),
    ] {
        assert_eq!(said(&macs(keys)), expected.trim_end());
    }
}

/// Jerk follows from acceleration, which follows from velocity: a derived value outside of its range is reported at the
/// given value.
#[test]
fn a_value_that_follows_from_others_may_leave_its_range() {
    let text = macs(&[("max_velocity", "2 km/s"), ("max_acceleration", "1 m/s^2")]);
    assert!(said(&text).contains("km/s"), "{}", said(&text));
    // 2e9 inc/s in 1 ms are 2e12 inc/s^2, in 1 ms 2e15 inc/s^3.
    let text = macs(&[("max_velocity", "2000 m/s"), ("rampmin", "1"), ("jerkmin", "1")]);
    assert_eq!(
        said(&text),
        "10:14: jerkmin `1` makes max_jerk 2000000000000 mm/s^3; more than 0 up to 1000000000000 mm/s^3 is allowed"
    );
    let text = macs(&[("max_velocity", "0 m/s"), ("rampmin", "1"), ("jerkmin", "1")]);
    assert_eq!(said(&text), "8:19: max_velocity is `0 m/s`; more than 0 up to 2147483648 mm/s is allowed");
}

/// A number without a unit is in SI, whatever the unit of the axis is; 0 is the same in both.
#[test]
fn number_without_unit_in_axis_with_another_unit_is_warned_of() {
    let x = "  x:\n    type: linear\n    unit: mm\n    scale: {increments: 1000, per: 10}\n    drive: {backend: plant, address: 0}\n    \
             min_position: -50\n    max_position: 850\n    max_velocity: 1200\n    max_acceleration: 8\n    \
             homing: {method: 35, velocity: 0.1 m/s, offset: 0}\n    \
             sim: {model: ideal, negative_limit_switch: {at: -52}, index: {every: 1e-1}}\n";
    let turret = "  turret:\n    type: rotary\n    unit: deg\n    scale: {increments: 3600, per: 360 deg}\n    \
                  drive: {backend: plant, address: 1}\n    max_velocity: 90\n    max_acceleration: 360 deg/s^2\n";
    let text = format!("{HEAD}axes:\n{x}{turret}");
    assert_eq!(
        good(&text).bare_numbers,
        [
            "c:10:36: per: 10 is 10 m; write 10 mm if that is meant",
            "c:12:19: min_position: -50 is -50 m; write -50 mm if that is meant",
            "c:13:19: max_position: 850 is 850 m; write 850 mm if that is meant",
            "c:14:19: max_velocity: 1200 is 1200 m/s; write 1200 mm/s if that is meant",
            "c:15:23: max_acceleration: 8 is 8 m/s^2; write 8 mm/s^2 if that is meant",
            "c:17:53: at: -52 is -52 m; write -52 mm if that is meant",
            "c:17:74: every: 1e-1 is 0.1 m; write 1e-1 mm if that is meant",
            "c:23:19: max_velocity: 90 is 90 rad/s; write 90 deg/s if that is meant",
        ]
    );
    // People read these axes in SI.
    for (unit, si) in [("    unit: mm\n", ""), ("    unit: mm\n", "    unit: m\n")] {
        let text = format!("{HEAD}axes:\n{}", x.replace(unit, si));
        assert_eq!(good(&text).bare_numbers, [""; 0]);
    }
    let in_increments = good(&format!("{HEAD}axes:\n{}", x.replace("unit: mm", "unit: inc")));
    assert!(in_increments.bare_numbers[3].ends_with("1200 is 1200 m/s; write 1200 inc/s if that is meant"));
    // The user unit of MACS and WF is the axis unit.
    let of_sources = with(&[("unit", "mm"), ("posencqc", "2000"), ("amc.following_error_window", "3")]);
    assert_eq!(good(&of_sources).bare_numbers, [""; 0]);
}

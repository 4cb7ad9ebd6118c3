//! Tests each problem of axes.

use super::{HEAD, good, said};
use lineshaft_core::config::AxisConfig;
use lineshaft_core::modulo::Modulo;
use lineshaft_core::sim::{Model, SecondOrder};

const LINEAR: [(&str, &str); 6] = [
    ("type", "linear"),
    ("unit", "mm"),
    ("scale", "{increments: 1048576, per: 10 mm}"),
    ("drive", "{backend: plant, address: 0}"),
    ("max_velocity", "1.2 m/s"),
    ("max_acceleration", "8 m/s^2"),
];

/// Returns the axis `x` of [`LINEAR`] with changed or additional keys; these come first, from line 8, column 5.
pub(super) fn axis(keys: &[(&str, &str)]) -> String {
    let usual = LINEAR.iter().filter(|(key, _)| keys.iter().all(|(other, _)| other != key));
    let line = |(key, value): &(&str, &str)| format!("    {key}: {value}\n");
    format!("{HEAD}axes:\n  x:\n{}", keys.iter().chain(usual).map(line).collect::<String>())
}

/// Returns the same axis as a rotary one in degrees, with 100 inc per degree.
fn rotary<'k>(keys: &[(&'k str, &'k str)]) -> String {
    let rotary = [
        ("type", "rotary"),
        ("unit", "deg"),
        ("scale", "{increments: 36000, per: 360 deg}"),
        ("max_velocity", "90 deg/s"),
        ("max_acceleration", "360 deg/s^2"),
    ];
    let others = rotary.into_iter().filter(|(key, _)| keys.iter().all(|(other, _)| other != key));
    axis(&keys.iter().copied().chain(others).collect::<Vec<_>>())
}

fn read(text: &str) -> AxisConfig {
    good(text).machine.axes.remove(0)
}

#[test]
fn type_unit_and_scale_fit_each_other() {
    for (keys, expected) in [
        (&[("type", "lin")][..], "8:11: type is `lin`; one of linear, rotary is allowed, did you mean `linear`?"),
        (&[("unit", "deg")], "8:11: unit is `deg`; one of nm, um, mm, cm, m, inc is allowed"),
        (&[("unit", "MM")], "8:11: unit is `MM`; one of nm, um, mm, cm, m, inc is allowed, did you mean `mm`?"),
        (
            &[("scale", "{increments: 1000, per: 360 deg}")],
            "8:36: per: `360 deg` is an angle; a length such as `360 mm` is expected",
        ),
        (&[("scale", "{increments: 1000, per: 0 mm}")], "8:36: per is `0 mm`; a value above 0 is allowed"),
        (&[("scale", "{increments: -1, per: 1 mm}")], "8:25: increments is `-1`; a number above 0 is allowed"),
        (&[("scale", "{per: 1 mm}")], "8:12: missing key `increments` in scale"),
        (&[("scale", "1000")], "8:12: scale is `1000`; a mapping is expected"),
    ] {
        assert_eq!(said(&axis(keys)), expected);
    }
    for (unit, meant) in [("grad", "deg"), ("degrees", "deg"), ("turns", "rev")] {
        let expected = format!("8:11: unit is `{unit}`; one of deg, rad, rev, inc is allowed, did you mean `{meant}`?");
        assert_eq!(said(&rotary(&[("unit", unit)])), expected);
    }
    for (unit, expected) in [
        ("0 mm", "unit is `0 mm`; a value above 0 is allowed"),
        ("-0.1 mm", "unit is `-0.1 mm`; a value above 0 is allowed"),
        ("0.1", "unit is `0.1`; a unit, or a number above 0 with one, is allowed, write `0.1 mm`"),
        ("0.1mm", "unit: `0.1mm` has no blank between number and unit, write `0.1 mm`"),
        ("0.1 deg", "unit: `0.1 deg` is an angle; a length such as `0.1 mm` is expected"),
        ("0.1 inc", "unit: `0.1 inc` is a number of increments; a length such as `0.1 mm` is expected"),
        ("0.1 mm/s", "unit: `0.1 mm/s` is a velocity; a length such as `0.1 mm` is expected"),
        ("1/10 mm", "unit: `1/10` is not a number, a length such as `1 mm` is expected"),
    ] {
        assert_eq!(said(&axis(&[("unit", unit)])), format!("8:11: {expected}"));
    }
    let tenths = read(&axis(&[("unit", "0.1 mm")])).scale;
    assert_eq!(tenths.unit().to_string(), "0.1 mm");
    assert_eq!(tenths.format_increments(tenths.position_from_unit(50.0).unwrap()), "50 * 0.1 mm");
    // No machine has such a scale; values derived from it are not reported.
    for (scale, one) in [("{increments: 1, per: 1e30 mm}", "1e27"), ("{increments: 1e20, per: 1 m}", "1e-20")] {
        let sentence = format!("8:25: scale: one increment is {one} m; 1e-18 to 1e9 m is allowed");
        let keys = [("scale", scale), ("max_position", "850 mm"), ("max_following_error", "10 mm")];
        assert_eq!(said(&axis(&keys)), sentence);
    }
    assert_eq!(said(&rotary(&[("unit", "mm")])), "8:11: unit is `mm`; one of deg, rad, rev, inc is allowed");
    assert_eq!(read(&axis(&[("unit", "inc")])).scale.format_increments(5), "5 inc");
    let no_unit = axis(&[]).replace("    unit: mm\n", "");
    assert_eq!(read(&no_unit).scale.unit().to_string(), "m");
}

/// The cells of the oracles O-01 (25 : 1, 500 counts, 4 edges, 5 mm per revolution) and O-03 (50.375 qc per unit).
///
/// Proves: MACS-UNIT-02, MACS-UNIT-05
#[test]
fn increments_of_positions_are_exact_fractions_rounded_once() {
    let spindle = read(&axis(&[("scale", "{increments: 50000, per: 5 mm}"), ("max_position", "0.1 mm")]));
    assert_eq!(spindle.parameters.max_position, Some(1000));
    for (max_position, increments) in [("8 mm", 403), ("1 mm", 50), ("4 mm", 202), ("-4 mm", -202)] {
        let x = read(&axis(&[("scale", "{increments: 50375/1000, per: 1 mm}"), ("max_position", max_position)]));
        assert_eq!(x.parameters.max_position, Some(increments), "{max_position}");
    }
}

/// Software limits, target window and following error are stored in increments, whatever the axis unit is.
///
/// Proves: MACS-UNIT-03
#[test]
fn limits_and_windows_are_kept_in_increments() {
    let keys = |limit, window, error| {
        axis(&[("max_position", limit), ("in_position_window", window), ("max_following_error", error)])
    };
    let in_unit = read(&keys("850 mm", "10 um", "10 mm")).parameters;
    let in_increments = read(&keys("89128960 inc", "1049 inc", "1048576 inc")).parameters;
    assert_eq!(in_unit, in_increments);
    assert_eq!(in_unit.max_position, Some(89_128_960));
}

#[test]
fn parameter_ranges_are_shown_in_the_axis_unit() {
    for (key, value, expected) in [
        ("max_velocity", "0 m/s", "is `0 m/s`; more than 0 up to 20480000 mm/s is allowed"),
        ("max_velocity", "-1", "is `-1`; more than 0 up to 20480000 mm/s is allowed"),
        // 2^31 inc in a cycle of 1 ms, and one more.
        ("max_velocity", "2147483648001 inc/s", "is `2147483648001 inc/s`; more than 0 up to 20480000 mm/s is allowed"),
        ("max_velocity", "20480001 mm/s", "is `20480001 mm/s`; more than 0 up to 20480000 mm/s is allowed"),
        (
            "max_velocity",
            "1e37",
            "is `1e37`; more than 0 up to 20480000 mm/s is allowed, a number without a unit is in m/s",
        ),
        ("default_velocity", "1e9 m/s", "is `1e9 m/s`; more than 0 up to 20480000 mm/s is allowed"),
        ("max_acceleration", "-8 m/s^2", "is `-8 m/s^2`; more than 0 up to 9536743160 mm/s^2 is allowed"),
        ("max_jerk", "0", "is `0`; more than 0 up to 9536743160 mm/s^3 is allowed"),
        ("in_position_window", "-1 mm", "is `-1 mm`; 0 mm and above is allowed"),
        ("max_following_error", "0 mm", "is `0 mm`; 0.00000954 mm (1 inc) and above is allowed"),
        ("following_error_time", "11 s", "is `11 s`; 0 ms to 10000 ms is allowed"),
        ("setpoint_timeout", "1 us", "is `1 us`; 1 ms to 3600000 ms is allowed"),
        ("error_reaction", "-1", "is `-1`; 0 to 5 is allowed"),
        ("syncfacts", "0", "is `0`; 1 to 1073741823 is allowed"),
        ("error_reaction", "hold", "is `hold`; a whole number, 0 to 5, is expected"),
        ("max_jerk", "", "has no value; a jerk is expected"),
        ("profile", "round", "is `round`; one of trapezoid, s_ramp, jerk is allowed"),
    ] {
        // A missing value is reported at the colon.
        let place = 7 + key.len() - if value.is_empty() { 2 } else { 0 };
        assert_eq!(said(&axis(&[(key, value)])), format!("8:{place}: {key} {expected}"));
    }
    assert_eq!(read(&axis(&[("max_velocity", "2147483648000 inc/s")])).parameters.max_velocity, 2_147_483_648_000.0);
    assert_eq!(read(&axis(&[("max_velocity", "60 m/min")])).parameters.max_velocity, 104_857_600.0);
}

#[test]
fn value_without_a_suitable_unit_is_refused_with_the_reason() {
    for (key, value, expected) in [
        ("max_acceleration", "8 m/s", "`8 m/s` is a velocity; an acceleration such as `8 m/s^2` is expected"),
        ("min_position", "3 furlong", "`furlong` in `3 furlong` is not a unit; a length has nm, um, mm, cm, m"),
        ("max_position", "850mm", "`850mm` has no blank between number and unit, write `850 mm`"),
        (
            "max_position",
            "1e15 m",
            "`1000000000000000 m` is 1.048576e23 increments; a position stays below 2^62 = 4611686018427387904 increments",
        ),
        (
            "in_position_time",
            "0.1 ns",
            "`0.1 ns` is not a whole number of nanoseconds; times are whole nanoseconds up to 292 years",
        ),
    ] {
        assert_eq!(said(&axis(&[(key, value)])), format!("8:{}: {key}: {expected}", 7 + key.len()));
    }
}

/// ENCODER 500 is 2000 inc per revolution (MACS-PROF-01).
#[test]
fn view_may_replace_its_value_but_not_accompany_it() {
    let both = "8:13: velmax is another view of max_velocity, which is at 13:19, write one of them";
    assert_eq!(said(&axis(&[("velmax", "3000")])), both);
    let instead = axis(&[("velmax", "3000")]).replace("    max_velocity: 1.2 m/s\n", "");
    assert_eq!(read(&instead).parameters.max_velocity, 100_000.0);
}

#[test]
fn a_plain_number_takes_the_unit_of_its_row() {
    let read = |keys: &[(&str, &str)]| {
        let file = axis(keys).replace("    max_velocity: 1.2 m/s\n", "    velmax: 3000 rpm\n");
        read(&file).parameters
    };
    let p = read(&[("poserr", "500 inc"), ("testwin", "7"), ("velocity_override", "50 %"), ("proftime", "2000 us")]);
    // 3000 rpm with 500 lines of 4 increments.
    assert_eq!((p.max_velocity, p.max_following_error, p.in_position_window), (100_000.0, 500, 7));
    assert_eq!((p.velocity_override, p.macs.proftime), (50.0, 2));
    for (key, value, expected) in [
        ("poserr", "5 mm", ": `5 mm` is a length; a number of increments such as `5 inc` is expected"),
        ("poserr", "5 incs", ": `incs` in `5 incs` is not a unit; a number of increments has inc"),
        ("poserr", "0.5 inc", " is `0.5 inc`; a whole number in inc, 1 to 1073741823, is expected"),
        ("poserr", "0 inc", " is `0 inc`; 1 to 1073741823 is allowed"),
        ("proftime", "1ms", ": `1ms` has no blank between number and unit, write `1 ms`"),
        ("velocity_override", "101 %", " is `101 %`; 0 to 100 is allowed"),
        ("velres", "100 %", " is `100 %`; a whole number, 1 to 10000, is expected"),
    ] {
        assert_eq!(said(&axis(&[(key, value)])), format!("8:{}: {key}{expected}", 7 + key.len()));
    }
}

#[test]
fn what_does_not_exist_yet_is_refused_by_name() {
    let expected = "8:19: encoderclock is 0: a serial interface whose clock could be left to another one does not exist yet; only 1 is allowed, leave it out";
    assert_eq!(said(&axis(&[("encoderclock", "0")])), expected);
}

#[test]
fn homing_keys_are_nested_or_flat_and_may_have_macs_names() {
    let method = |keys: &[(&str, &str)]| good(&axis(keys)).machine.axes[0].parameters.homing.method;
    assert_eq!(method(&[]), 0);
    assert_eq!(method(&[("homing", "{method: 35, required: false}")]), 35);
    assert_eq!(method(&[("homing.method", "-4")]), -4);
    assert_eq!(method(&[("homing", "{home_type: 1}")]), -2);
    assert_eq!(method(&[("home_type", "3")]), -4);
    for (value, expected) in [
        ("{method: 400}", "method is `400`; -4 to 14, 17 to 30, 33 to 35, 37 is allowed"),
        ("{method: 15}", "method is `15`; -4 to 14, 17 to 30, 33 to 35, 37 is allowed"),
        ("{methods: 35}", "unknown key `methods` in homing, did you mean `method`?"),
        ("{home_type: 4}", "home_type is `4`; 0 to 3 is allowed"),
    ] {
        let said = said(&axis(&[("homing", value)]));
        assert!(said.contains(expected), "{value}: {said}");
    }
}

#[test]
fn keys_that_an_axis_must_have_or_does_not_know() {
    let without = |key: &str| {
        axis(&[])
            .lines()
            .filter(|line| !line.starts_with(&format!("    {key}:")))
            .map(|line| format!("{line}\n"))
            .collect::<String>()
    };
    for key in ["type", "scale", "drive", "max_velocity", "max_acceleration"] {
        assert_eq!(said(&without(key)), format!("8:5: missing key `{key}` in axis `x`"));
    }
    assert_eq!(said(&axis(&[("max_velosity", "1")])), "8:5: unknown key `max_velosity` in axis `x`");
    let misspelt = axis(&[]).replace("max_velocity", "max_velosity");
    for (word, here) in [
        ("md18: 1", "`md18` in axis `x`, MD18 of Siemens WF 725 is `modulo`"),
        ("MD1: 5", "`MD1` in axis `x`, MD1 of Siemens WF 725 is `wf.md1`"),
        ("wf: {md18: 1}", "`md18` in wf, MD18 of Siemens WF 725 is `modulo`"),
        ("wf.md19: 1", "`wf.md19` in axis `x`, MD19 of Siemens WF 725 is `scale`"),
        ("DestP: 1", "`DestP` in axis `x`, DestP of SAIA PCD4.H3 is `saia.destp`"),
        ("wf: {md33: 1}", "`md33` in wf, did you mean `md30`?"),
    ] {
        let text = axis(&[]) + &format!("    {word}\n");
        let told = said(&text);
        assert_eq!(told.split_once("unknown key ").map(|(_, rest)| rest), Some(here), "{told}");
    }
    assert_eq!(said(&misspelt), "12:5: unknown key `max_velosity` in axis `x`, did you mean `max_velocity`?");
    assert_eq!(said(&axis(&[("dirve", "virtual")])), "8:5: unknown key `dirve` in axis `x`");
}

/// A line that is refused is not compared with default values.
#[test]
fn steps_that_do_not_decrease_are_reported_with_the_cell_text() {
    let said = |steps: &str| -> Vec<String> {
        let drive = "drive: {backend: plant, address: 0, interface: open_loop}, wf";
        let rest = "max_velocity: 100 mm/s, max_acceleration: 1 m/s^2";
        let scale = "type: linear, unit: mm, scale: {increments: 1000, per: 1 mm}";
        let said = super::said_of(&format!("axes:\n  x: {{{scale}, {rest}, {drive}: {{{steps}}}}}\n"));
        said.lines().filter_map(|line| line.split_once(": ")).map(|(_, sentence)| sentence.to_owned()).collect()
    };
    assert_eq!(
        said("md42: 10, md43: 20, md44: 30, md45: 1, md46: 2, md47: 3, md48: 4"),
        [
            "wf.md43 20 exceeds wf.md42 10",
            "wf.md44 30 exceeds wf.md43 20",
            "wf.md46 2 mm exceeds wf.md45 1 mm",
            "wf.md47 3 mm exceeds wf.md46 2 mm",
            "wf.md48 4 mm exceeds wf.md47 3 mm",
        ]
    );
    assert_eq!(said("md42: 10, md43: 20, md44: 15"), ["wf.md43 20 exceeds wf.md42 10"]);
    assert_eq!(said("md42: 10, md43: 20, md44: 20"), ["wf.md43 20 exceeds wf.md42 10"]);
}

#[test]
fn contradictions_are_reported_at_the_key_that_is_too_high() {
    let keys = [
        ("min_position", "900 mm"),
        ("max_position", "850 mm"),
        ("default_velocity", "2 m/s"),
        ("default_acceleration", "8001 mm/s^2"),
    ];
    assert_eq!(
        said(&axis(&keys)),
        "8:19: min_position 900 mm exceeds max_position 850 mm\n\
         10:23: default_velocity 2000 mm/s exceeds max_velocity 1200 mm/s\n\
         11:27: default_acceleration 8001 mm/s^2 exceeds max_acceleration 8000 mm/s^2"
    );
    // Both have the same first nine digits.
    assert_eq!(
        said(&axis(&[("default_velocity", "1200.0000001 mm/s")])),
        "8:23: default_velocity 1200.0000001 mm/s exceeds max_velocity 1200 mm/s"
    );
    assert_eq!(
        said(&axis(&[("max_position", "850 mm"), ("min_position", "85 cm")])),
        "9:19: min_position 850 mm equals max_position 850 mm; below is allowed"
    );
    // A maximum with its own problem contradicts no other value.
    assert_eq!(
        said(&axis(&[("default_velocity", "2 m/s"), ("max_velocity", "1 m")])),
        "9:19: max_velocity: `1 m` is a length; a velocity such as `1 m/s` is expected"
    );
}

#[test]
fn drives() {
    for (drive, expected) in [
        (
            "virtuel",
            "8:12: drive is `virtuel`; virtual, {backend: .., address: ..} or {reference: .., enable: ..} is allowed",
        ),
        ("{backend: plant}", "8:12: missing key `address` in drive of axis `x`"),
        ("{address: 0}", "8:12: missing key `backend` in drive of axis `x`"),
        ("{backend: plants, address: 0}", "8:22: backend is `plants`; no backend has that name, did you mean `plant`?"),
        (
            "{backend: plant, address: 0, regulator: pid}",
            "8:52: regulator is for a drive whose position loop is closed here, with interface velocity, torque or voltage; this one has \
             position, leave it out",
        ),
        (
            "{backend: plant, address: 0, interface: openloop}",
            "8:52: interface is `openloop`; one of position, velocity, torque, voltage, open_loop is allowed, did you mean `open_loop`?",
        ),
        (
            "{backend: plant, address: 0, node: 3}",
            "8:41: unknown key `node` in drive of axis `x`, known are backend, interface, regulator, missed_cycles, enable_timeout, \
             address",
        ),
        (
            "{backend: plant, address: 0, enable_timeout: 99 ms}",
            "8:57: enable_timeout is `99 ms`; 100 ms to 600 s is allowed",
        ),
        (
            "{backend: plant, address: 0, enable_timeout: 601 s}",
            "8:57: enable_timeout is `601 s`; 100 ms to 600 s is allowed",
        ),
        ("{backend: bus0, eds: x.eds}", "8:12: missing key `node` in drive of axis `x`"),
        ("{backend: bus0, node: 128}", "8:34: node is 128; 1..127 is allowed"),
        ("{backend: bus0, node: 1, address: 0}", "8:37: unknown key `address` in drive of axis `x`"),
    ] {
        assert_eq!(said(&axis(&[("drive", drive)])), expected);
    }
    let delay = |text: &str| read(text).drive.map(|offers| offers.delay);
    assert_eq!(delay(&axis(&[("drive", "{backend: bus0, node: 3, eds: x.eds, interface: position}")])), Some(1));
    let slow = axis(&[("drive", "{backend: plant, address: 0}")]).replace("{type: sim}", "{type: sim, delay: 32}");
    assert_eq!(delay(&slow), Some(32));
    let enabling = |drive: &str| {
        let axis = read(&axis(&[("drive", drive)]));
        (axis.enable_timeout_ns, axis.drive_mode)
    };
    assert_eq!(enabling("{backend: plant, address: 0}"), (5_000_000_000, None));
    assert_eq!(enabling("{backend: plant, address: 0, enable_timeout: 100 ms}"), (100_000_000, None));
    assert_eq!(enabling("{backend: bus0, node: 3, mode: pp, enable_timeout: 600 s}"), (600_000_000_000, Some(1)));
}

#[test]
fn a_drive_moves_one_axis() {
    let second = |drive: &str| {
        let x = axis(&[("drive", drive)]);
        let (head, x) = x.split_once("  x:\n").unwrap();
        format!("{head}  x:\n{x}  y:\n{x}")
    };
    assert_eq!(
        said(&second("{backend: plant, address: 7}")),
        "15:38: drive address 7 of backend `plant` is taken already, at 8:38"
    );
    assert_eq!(
        said(&second("{backend: bus0, node: 7}")),
        "15:34: drive node 7 of backend `bus0` is taken already, at 8:34"
    );
    // An alias has the location of its anchor, and still counts as a second use.
    let aliased = second("&d {backend: plant, address: 7}").replacen("&d {backend: plant, address: 7}", "*d", 2);
    let aliased = aliased.replacen("*d", "&d {backend: plant, address: 7}", 1);
    assert_eq!(said(&aliased), "8:41: drive address 7 of backend `plant` is taken already, at 8:41");
}

#[test]
fn a_turn_is_an_exact_fraction_of_a_rotary_axis() {
    assert_eq!(read(&rotary(&[("modulo", "360 deg")])).modulo, Modulo::new(36_000, 1));
    assert_eq!(
        read(&rotary(&[("modulo", "1 rev"), ("scale", "{increments: 3001/3, per: 1 rev}")])).modulo,
        Modulo::new(3001, 3)
    );
    assert_eq!(read(&rotary(&[("modulo", "500 inc")])).modulo, Modulo::new(500, 1));
    for (keys, expected) in [
        (&[("modulo", "0 deg")][..], "8:13: modulo is `0 deg`; a value above 0 is allowed"),
        (&[("modulo", "10 mm")], "8:13: modulo: `10 mm` is a length; an angle such as `10 deg` is expected"),
        (
            &[("modulo", "0.001 deg")],
            "8:13: modulo is `0.001 deg`, 1/10 inc; 1 inc to 2^61 inc as a fraction with a denominator below 2^31 is allowed",
        ),
    ] {
        assert_eq!(said(&rotary(keys)), expected);
    }
    let radians = said(&rotary(&[("modulo", "3.1 rad")]));
    assert!(radians.ends_with("a denominator below 2^31 is allowed, write it in deg or rev"), "{radians}");
    assert_eq!(
        said(&axis(&[("modulo", "10 mm")])),
        "8:13: modulo is for rotary axes; this one is linear, leave it out"
    );
}

#[test]
fn models() {
    let model = |sim| good(&axis(&[("sim", sim)])).models.remove(0);
    let second_order =
        |bandwidth, damping| Model::SecondOrder(SecondOrder::new(bandwidth, damping, 1_000_000).unwrap());
    assert_eq!(good(&axis(&[])).models, [Model::Ideal]);
    assert_eq!(model("{model: ideal}"), Model::Ideal);
    assert_eq!(model("{model: second_order}"), second_order(60.0, 0.8));
    assert_eq!(model("{model: second_order, bandwidth: 0.1 kHz, damping: 1}"), second_order(100.0, 1.0));
    let coasting = SecondOrder::new(60.0, 0.8, 1_000_000).unwrap().coasting(200_000_000, 1_000_000).unwrap();
    assert_eq!(model("{model: second_order, coast: 200 ms}"), Model::SecondOrder(coasting));
    assert_eq!(model("{model: second_order, coast: 0 s}"), second_order(60.0, 0.8));
    for (sim, expected) in [
        ("{model: second_order, coast: 11 s}", "8:39: coast is 11000 ms; 0 ms to 10000 ms is allowed"),
        ("{}", "8:10: missing key `model` in sim"),
        (
            "{model: first_order}",
            "8:18: model is `first_order`; one of ideal, second_order, velocity, two_speed, valve, motor is allowed",
        ),
        (
            "{model: second_order, bandwidth: 0 Hz, damping: 0}",
            "8:43: bandwidth is 0 Hz; more than 0 Hz up to 100000 Hz is allowed\n8:58: damping is 0; 0.01 to 100 is allowed",
        ),
        ("{model: ideal, bandwidth: 60 Hz}", "8:36: bandwidth is for model second_order; this one is ideal"),
        ("{model: ideal, dampnig: 1}", "8:25: unknown key `dampnig` in sim, did you mean `damping`?"),
    ] {
        assert_eq!(said(&axis(&[("sim", sim)])), expected);
    }
}

#[test]
fn a_virtual_axis_has_no_drive_to_home_or_simulate() {
    let keys = [("drive", "virtual"), ("sim", "{model: ideal}"), ("homing", "{method: 35}")];
    assert_eq!(
        said(&axis(&keys)),
        "9:10: sim is for axes with a drive; axis `x` is virtual, leave it out\n\
         10:22: homing.method is for axes with a drive, leave it out"
    );
    let cell = good(&axis(&[("drive", "virtual")]));
    assert_eq!((cell.machine.axes[0].drive, cell.models.len()), (None, 0));
}

#[test]
fn there_is_room_for_512_axes() {
    let cell = |count: usize| {
        let axis = |n| {
            format!(
                "  a{n}: {{type: linear, drive: virtual, scale: {{increments: 1, per: 1 mm}}, max_velocity: 1, max_acceleration: 1}}\n"
            )
        };
        format!("{HEAD}axes:\n{}", (0..count).map(axis).collect::<String>())
    };
    assert_eq!(good(&cell(512)).machine.axes.len(), 512);
    assert_eq!(said(&cell(513)), "519:3: 513 entries exceed the maximum of this section, 512");
}

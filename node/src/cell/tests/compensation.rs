//! Tests the compensation between motor and load of an axis: backlash, and the table of its pitch error.

use super::{HEAD, assert_said, good};

const TABLES: &str = "tables:\n  screw: {form: xy, points: [[0, 0], [20000, 60], [50000, -25]]}\n  \
                      steep: {form: xy, points: [[0, 0], [100, 5], [150, 11]]}\n  \
                      words: {form: words, words: [1, 2]}\n";
const LINEAR: &str = "type: linear, scale: {increments: 1000, per: 1 mm}, max_velocity: 1 m/s, max_acceleration: 1";
const ROTARY: &str = "type: rotary, scale: {increments: 40000, per: 1 rev}, max_velocity: 1 rad/s, max_acceleration: 1";

/// Returns a cell with an axis `x` of that interface with these keys.
fn axis(kind: &str, interface: &str, keys: &str) -> String {
    let drive = match interface {
        "virtual" => "drive: virtual".to_owned(),
        interface => format!("drive: {{backend: plant, address: 0, interface: {interface}}}"),
    };
    format!("{HEAD}{TABLES}axes:\n  x: {{{kind}, {drive}, {keys}}}\n")
}

#[test]
fn a_screw_is_read_with_its_units_and_its_table() {
    for (keys, backlash, velocity, pitch_error) in [
        ("compensation: {backlash: 40 um, velocity: 5 mm/s, pitch_error: screw}", 40, Some(5_000.0), Some(0)),
        ("compensation.backlash: 0.04 mm, compensation.pitch_error: screw", 40, None, Some(0)),
        ("compensation: {backlash: 12 inc}", 12, None, None),
        ("error_reaction: 2", 0, None, None),
    ] {
        for interface in ["position", "velocity"] {
            let cell = good(&axis(LINEAR, interface, keys));
            let axis = &cell.machine.axes[0];
            let compensation = axis.parameters.compensation;
            assert_eq!((compensation.backlash, compensation.velocity), (backlash, velocity), "{keys}");
            assert_eq!(axis.pitch_error, pitch_error, "{keys}");
        }
    }
    assert_eq!(
        good(&axis(ROTARY, "position", "modulo: 2 rev, compensation: {pitch_error: screw}")).machine.tables.len(),
        3
    );
}

#[test]
fn invalid_compensation_is_refused_with_the_reason() {
    const ALL: &str = "is for axes with interface position, velocity, torque or voltage, leave it out";
    for (kind, interface, keys, sentence) in [
        (
            LINEAR,
            "position",
            "compensation: {pitch_error: ^scrw}",
            "pitch_error is `scrw`; no table has that name, did you mean `screw`?",
        ),
        (
            LINEAR,
            "position",
            "compensation: {pitch_error: ^x}",
            "pitch_error is `x`, which is an axis; table is allowed",
        ),
        (
            LINEAR,
            "position",
            "compensation: {pitch_error: ^steep}",
            "pitch_error is `steep`: up to point 3 a pitch error changes by 6 inc on 50 inc; a part of 10 of the way is \
             possible",
        ),
        (
            LINEAR,
            "position",
            "compensation: {pitch_error: ^words}",
            "pitch_error is `words`: a table of form words has no places; form xy is expected",
        ),
        (
            ROTARY,
            "position",
            "modulo: 1 rev, compensation: {pitch_error: ^screw}",
            "pitch_error is `screw`: point 3 of a pitch error is at 50000; the turn of its axis has 0 to 39999 inc",
        ),
        (LINEAR, "virtual", "compensation: {pitch_error: ^screw}", &format!("pitch_error {ALL}")),
        (LINEAR, "open_loop", "compensation: {pitch_error: ^screw}", &format!("pitch_error {ALL}")),
        (LINEAR, "virtual", "compensation: {backlash: ^1 mm}", &format!("compensation.backlash {ALL}")),
        (LINEAR, "open_loop", "compensation: {velocity: ^1 mm/s}", &format!("compensation.velocity {ALL}")),
        (
            LINEAR,
            "position",
            "compensation: {backlash: ^-1 mm}",
            "compensation.backlash is `-1 mm`; 0 m to 1073.741824 m is allowed",
        ),
        (
            LINEAR,
            "position",
            "compensation: {^backlsh: 1 mm}",
            "unknown key `backlsh` in compensation, did you mean `backlash`?",
        ),
    ] {
        assert_said(&axis(kind, interface, keys), sentence);
    }
}

//! Keys of descriptions of tables.

use super::Shape::{Boolean, Choice, Integer, List, Map};
use super::{File, Key, Shape};

const WIDEST: i128 = i32::MAX as i128;

const LAWS: &[&str] =
    &["dwell", "straight", "simple_sine", "modified_sine", "modified_trapezoid", "polynomial_5", "polynomial_7"];

const fn key(path: &'static str, shapes: &'static [Shape], texts: [&'static str; 4]) -> Key {
    Key::new(File::Table, path, shapes, texts)
}

/// All keys, in the order of the reference.
pub(super) const KEYS: &[&[Key]] = &[&[
    key(
        "form",
        &[Choice(&["y", "xy"])],
        ["", "y", "Form of the table: values at equal distances, or points with their place.", "form: xy"],
    ),
    key("points", &[Integer(2, 1_000_000)], ["", "required", "Points of the table.", "points: 1001"]).required(),
    key("cyclic", &[Boolean], ["", "true", "Whether the motion repeats.", "cyclic: false"]),
    key("master", &[Integer(1, WIDEST)], ["", "required", "Master increments of one period.", "master: 20000"])
        .required(),
    key(
        "segments",
        &[List],
        [
            "",
            "required",
            "Segments of the motion, in order.",
            "segments: [{to: 20000, travel: 8000, law: modified_sine}]",
        ],
    )
    .required(),
    key("segments[]", &[Map], ["", "", "One segment.", ""]),
    key(
        "segments[].to",
        &[Integer(1, WIDEST)],
        ["above that of the segment before", "required", "Master increment at which the segment ends.", "to: 5000"],
    )
    .required(),
    key(
        "segments[].travel",
        &[Integer(-WIDEST, WIDEST)],
        ["", "required", "Travel of the slave in the segment (inc).", "travel: 8000"],
    )
    .required(),
    key(
        "segments[].law",
        &[Choice(LAWS)],
        ["", "required", "Law of motion of the segment; docs/cams.md shows them.", "law: polynomial_5"],
    )
    .required(),
]];

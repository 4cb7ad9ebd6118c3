//! Writes and checks the text of a store.
//!
//! Comments, `lineshaft_store: 1`, the generation, then the body: the scale of the increments for each axis with saved
//! values, and the values; at the end a line with the SHA-256 of all bytes before it.

use crate::parameters::exact_text;
use lineshaft_core::config::{AxisConfig, MachineConfig};
use lineshaft_core::parameter::{AxisParameters, MachineParameters, ROWS, Row, Value};
use lineshaft_core::unit::{Fraction, Quantity, Scale, ScaleKind, Unit};
use sha2::{Digest, Sha256};
use std::fmt::Write;

/// Format version that this program writes and reads.
pub(super) const FORMAT: &str = "1";
/// Prefix of the last line.
const CHECKSUM: &str = "sha256: ";
/// Number of hexadecimal digits of the checksum.
const DIGITS: usize = 64;

const HEAD: &str = "\
# Lineshaft keeps here what save_parameters saved, in increments. It counts before what the cell says.
# The last line tells whether the text is whole: a change by hand is taken for damage. Without this file nothing is saved.
";

/// Returns layer User as the text for a recording; `None` if nothing was saved.
pub fn store_text(config: &MachineConfig) -> Option<String> {
    let is_saved = config.global.saved.is_some() || config.axes.iter().any(|axis| axis.saved.is_some());
    is_saved.then(|| {
        let sets: Vec<_> =
            config.axes.iter().map(|axis| (axis, axis.saved.as_ref().unwrap_or(&axis.parameters))).collect();
        whole(0, &body_with(&sets, (&config.global.parameters, &config.global.power_on())))
    })
}

/// Returns head, body and checksum.
pub(super) fn whole(generation: u64, body: &str) -> String {
    let text = format!("{HEAD}lineshaft_store: {FORMAT}\ngeneration: {generation}\n{body}");
    let checksum = checksum(&text);
    format!("{text}{CHECKSUM}{checksum}\n")
}

/// Returns the body for axes without the machine.
pub(super) fn body(sets: &[(&AxisConfig, &AxisParameters)]) -> String {
    let machine = MachineParameters::default();
    body_with(sets, (&machine, &machine))
}

/// Returns the saved values of each axis, by the rows with which they were set, unless the cell gives the same; and the
/// values of the machine that differ from the cell.
pub(super) fn body_with(
    sets: &[(&AxisConfig, &AxisParameters)],
    (init, machine): (&MachineParameters, &MachineParameters),
) -> String {
    let (mut axes, mut values) = (String::new(), String::new());
    for (axis, user) in sets {
        let before = values.len();
        for row in saved_rows(axis, user) {
            // Writing to a string cannot fail.
            let _ = writeln!(values, "  {}.{}: {}", axis.name, row.key, exact_text(row, user));
        }
        if values.len() > before {
            // If positions count opposite to the encoder, the increment has the opposite direction.
            let sign = if user.sense().units { "-" } else { "" };
            let _ = writeln!(axes, "  {}: {sign}{}", axis.name, scale_text(&axis.scale));
        }
    }
    for row in ROWS.iter().filter(|row| row.is_kept_by_machine()) {
        if let (Value::Int(value), true) =
            (row.machine_value(machine), row.machine_value(machine) != row.machine_value(init))
        {
            let _ = writeln!(values, "  machine.{}: {value}", row.key);
        }
    }
    format!("axes:\n{axes}parameters:\n{values}")
}

/// Returns the rows that must be stored.
fn saved_rows<'a>(axis: &'a AxisConfig, user: &'a AxisParameters) -> impl Iterator<Item = &'static Row> + 'a {
    // Reading begins with the cell in the saved direction of rotation.
    let turned = axis.parameters.with_direction_of(user);
    // The same value set by another row differs, because it depends on other values.
    let differs = move |row: &&Row| {
        let init = if row.key == "posdrct" { &axis.parameters } else { &turned };
        row.value(user) != row.value(init) || !init.is_given_by(row)
    };
    ROWS.iter().filter(|row| row.applies.to(axis) && user.is_given_by(row)).filter(differs)
}

/// Returns the exact meaning of an increment: increments per m, or per revolution.
pub(super) fn scale_text(scale: &Scale) -> String {
    let name = match scale.kind() {
        ScaleKind::Linear => "m",
        ScaleKind::Rotary => "rev",
    };
    let one = Unit::parse(name).map(|unit| Quantity::new(Fraction::from(1), unit));
    let exact = one.and_then(|one| scale.exact(&one).ok()).unwrap_or_default();
    format!("{exact} inc/{name}")
}

/// Returns a line for each value that replaces one of the cell.
pub(super) fn differences(config: &MachineConfig, sets: &[Option<AxisParameters>]) -> Vec<String> {
    let mut lines = Vec::new();
    for (axis, user) in std::iter::zip(&config.axes, sets).filter_map(|(axis, set)| Some((axis, set.as_ref()?))) {
        for row in saved_rows(axis, user) {
            let (saved, cell) = (exact_text(row, user), exact_text(row, &axis.parameters));
            lines.push(format!("{}.{} is {saved}; the cell says {cell}", axis.name, row.key));
        }
    }
    lines
}

/// Returns the text if it is complete.
///
/// # Errors
/// Returns a description of the defect.
pub(super) fn checked(bytes: Vec<u8>) -> Result<String, String> {
    if bytes.is_empty() {
        return Err("it is empty".to_owned());
    }
    let text = String::from_utf8(bytes).map_err(|_| "it is not UTF-8 text".to_owned())?;
    let end = text.len().checked_sub(CHECKSUM.len() + DIGITS + 1).filter(|&end| text.is_char_boundary(end));
    let parts = end.map(|end| text.split_at(end));
    let Some((before, digits)) = parts.and_then(|(before, line)| {
        Some((before, line.strip_prefix(CHECKSUM)?.strip_suffix('\n')?)).filter(|_| before.ends_with('\n'))
    }) else {
        return Err("it does not end with its checksum: it was cut off, or is no store".to_owned());
    };
    if digits != checksum(before) {
        return Err("its checksum is wrong: it was changed by hand, or by the disk".to_owned());
    }
    Ok(text)
}

/// Returns the body of a complete text.
pub(super) fn body_of(text: &str) -> &str {
    let start = text.find("\naxes:").map_or(0, |place| place + 1);
    let end = text.rfind(CHECKSUM).unwrap_or(text.len());
    text.get(start..end).unwrap_or_default()
}

/// Returns the generation of a complete text.
pub(super) fn generation_of(text: &str) -> Option<u64> {
    text.lines().find_map(|line| line.strip_prefix("generation: "))?.parse().ok()
}

fn checksum(text: &str) -> String {
    Sha256::digest(text).iter().fold(String::new(), |mut digits, byte| {
        let _ = write!(digits, "{byte:02x}");
        digits
    })
}

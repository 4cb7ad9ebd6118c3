//! The text of a store.
//!
//! Comments, `lineshaft_store: 1`, the generation, then the body: for each axis that has saved values the scale in which its
//! increments are meant, and the values; at the end a line with the SHA-256 of all bytes before it.

use crate::parameters::exact_text;
use lineshaft_core::config::{AxisConfig, MachineConfig};
use lineshaft_core::parameter::{AxisParameters, MachineParameters, ROWS, Row, Value};
use lineshaft_core::unit::{Fraction, Quantity, Scale, ScaleKind, Unit};
use sha2::{Digest, Sha256};
use std::fmt::Write;

/// The format that this program writes and reads.
pub(super) const FORMAT: &str = "1";
/// How the last line begins.
const CHECKSUM: &str = "sha256: ";
/// Hexadecimal digits of it.
const DIGITS: usize = 64;

const HEAD: &str = "\
# Lineshaft keeps here what save_parameters saved, in increments. It counts before what the cell says.
# The last line tells whether the text is whole: a change by hand is taken for damage. Without this file nothing is saved.
";

/// A set of layer User that goes with a recording; nothing where nothing was saved.
pub fn store_text(config: &MachineConfig) -> Option<String> {
    let is_saved = config.global.saved.is_some() || config.axes.iter().any(|axis| axis.saved.is_some());
    is_saved.then(|| {
        let sets: Vec<_> =
            config.axes.iter().map(|axis| (axis, axis.saved.as_ref().unwrap_or(&axis.parameters))).collect();
        whole(0, &body_with(&sets, (&config.global.parameters, &config.global.power_on())))
    })
}

/// Head, body and checksum.
pub(super) fn whole(generation: u64, body: &str) -> String {
    let text = format!("{HEAD}lineshaft_store: {FORMAT}\ngeneration: {generation}\n{body}");
    let checksum = checksum(&text);
    format!("{text}{CHECKSUM}{checksum}\n")
}

/// The body of axes alone.
pub(super) fn body(sets: &[(&AxisConfig, &AxisParameters)]) -> String {
    let machine = MachineParameters::default();
    body_with(sets, (&machine, &machine))
}

/// What is saved of each axis: the rows by which its values were given, as far as the cell does not give the same; and what of
/// the machine is another value than in the cell.
pub(super) fn body_with(
    sets: &[(&AxisConfig, &AxisParameters)],
    (init, machine): (&MachineParameters, &MachineParameters),
) -> String {
    let (mut axes, mut values) = (String::new(), String::new());
    for (axis, user) in sets {
        let before = values.len();
        for row in saved_rows(axis, user) {
            // Writing to a text cannot fail.
            let _ = writeln!(values, "  {}.{}: {}", axis.name, row.key, exact_text(row, user));
        }
        if values.len() > before {
            // Counted against the encoder, an increment is one the other way.
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

/// Rows that a store has to hold.
fn saved_rows<'a>(axis: &'a AxisConfig, user: &'a AxisParameters) -> impl Iterator<Item = &'static Row> + 'a {
    // Reading begins from the cell in the saved sense of rotation.
    let turned = axis.parameters.with_direction_of(user);
    // The same value given by another row is not the same: it follows from others.
    let differs = move |row: &&Row| {
        let init = if row.key == "posdrct" { &axis.parameters } else { &turned };
        row.value(user) != row.value(init) || !init.is_given_by(row)
    };
    ROWS.iter().filter(|row| row.applies.to(axis) && user.is_given_by(row)).filter(differs)
}

/// What one increment means, exactly: increments per m, or per revolution.
pub(super) fn scale_text(scale: &Scale) -> String {
    let name = match scale.kind() {
        ScaleKind::Linear => "m",
        ScaleKind::Rotary => "rev",
    };
    let one = Unit::parse(name).map(|unit| Quantity::new(Fraction::from(1), unit));
    let exact = one.and_then(|one| scale.exact(&one).ok()).unwrap_or_default();
    format!("{exact} inc/{name}")
}

/// A line for each value that takes the place of one of the cell.
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

/// The text where it is whole.
///
/// # Errors
/// What is wrong with it.
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

/// The body of a whole text.
pub(super) fn body_of(text: &str) -> &str {
    let start = text.find("\naxes:").map_or(0, |place| place + 1);
    let end = text.rfind(CHECKSUM).unwrap_or(text.len());
    text.get(start..end).unwrap_or_default()
}

/// The generation of a whole text.
pub(super) fn generation_of(text: &str) -> Option<u64> {
    text.lines().find_map(|line| line.strip_prefix("generation: "))?.parse().ok()
}

fn checksum(text: &str) -> String {
    Sha256::digest(text).iter().fold(String::new(), |mut digits, byte| {
        let _ = write!(digits, "{byte:02x}");
        digits
    })
}

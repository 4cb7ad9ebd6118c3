//! Texts for the numbers of the CiA standards.
//!
//! Source   CiA 301 (error register), CiA 402-2 (states, modes, inputs)

use lineshaft_core::drive::{DriveState, error_text, register_texts};
use std::ops::RangeInclusive;

/// Returns a little-endian number of 1 to 4 bytes.
pub fn number(bytes: &[u8]) -> Option<u32> {
    let is_it = (1..=4).contains(&bytes.len());
    is_it.then(|| bytes.iter().rev().fold(0, |number, byte| number << 8 | u32::from(*byte)))
}

/// Returns a text of a device, up to its first zero byte.
pub fn text(bytes: &[u8]) -> String {
    bytes.iter().take_while(|byte| **byte != 0).copied().map(char::from).collect::<String>().trim_end().to_owned()
}

/// Returns bytes as pairs of hexadecimal digits.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().join(" ")
}

/// Returns the text of a drive state (CiA 402-2).
pub fn drive_state(state: DriveState) -> &'static str {
    state.text()
}

/// Modes of operation: number, short name, name.
const MODES: [(i8, &str, &str); 10] = [
    (1, "pp", "profile position"),
    (2, "vl", "velocity"),
    (3, "pv", "profile velocity"),
    (4, "tq", "profile torque"),
    (6, "hm", "homing"),
    (7, "ip", "interpolated position"),
    (8, "csp", "cyclic synchronous position"),
    (9, "csv", "cyclic synchronous velocity"),
    (10, "cst", "cyclic synchronous torque"),
    (11, "cstca", "cyclic synchronous torque with commutation angle"),
];

/// Profile numbers of CiA. Numbers outside this range belong to no standard and are shown in hexadecimal.
const PROFILES: RangeInclusive<u32> = 401..=460;

/// Returns the text of a profile number (lower half of 1000h).
pub fn profile(number: u32) -> String {
    if PROFILES.contains(&number) { number.to_string() } else { format!("{number:04X}h") }
}

/// Returns the text of a mode of operation (6060h, 6061h).
pub fn mode(number: i8) -> String {
    match MODES.iter().find(|row| row.0 == number) {
        Some((_, short, name)) => format!("{short} ({name})"),
        None if number == 0 => "none".to_owned(),
        None if number < 0 => format!("{number} (of the vendor)"),
        None => format!("{number} (not known)"),
    }
}

/// Returns the text of the modes that a drive supports (6502h).
pub fn modes(offered: u32) -> String {
    let is_offered = |number: i8| offered >> (number - 1) & 1 == 1;
    let known = MODES.iter().filter(|row| is_offered(row.0)).map(|row| row.1.to_owned());
    let mut runs: Vec<(u32, u32)> = Vec::new();
    for bit in (16..32).filter(|bit| offered >> bit & 1 == 1) {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == bit => *last = bit,
            _ => runs.push((bit, bit)),
        }
    }
    let others = runs.into_iter().map(|(first, last)| {
        if first == last {
            format!("bit {first} of the vendor")
        } else {
            format!("bits {first} to {last} of the vendor")
        }
    });
    listed(known.chain(others))
}

/// Returns the text of the error register (1001h).
pub fn register(bits: u32) -> String {
    listed(register_texts(bits).map(str::to_owned))
}

/// Returns the text of the digital inputs (60FDh).
pub fn inputs(bits: u32) -> String {
    const BITS: [&str; 4] = ["negative limit", "positive limit", "home", "interlock"];
    let name = |bit: usize| BITS.get(bit).map_or_else(|| format!("bit {bit}"), |name| (*name).to_owned());
    listed((0..32).filter(|bit| bits >> bit & 1 == 1).map(name))
}

fn listed(names: impl Iterator<Item = String>) -> String {
    let names: Vec<_> = names.collect();
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

/// Returns the text of an error code (603Fh, emergency messages, 1003h).
pub fn error(code: u16) -> String {
    match error_text(code) {
        Some(text) => format!("{code:04X}h {text}"),
        None => format!("{code:04X}h"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_texts_of_standard() {
        assert_eq!(modes(0x1A5), "pp, pv, hm, csp, csv");
        assert_eq!(modes(0x0001_0000), "bit 16 of the vendor");
        assert_eq!(modes(0x001F_0080), "csp, bits 16 to 20 of the vendor");
        assert_eq!(modes(0xC005_0000), "bit 16 of the vendor, bit 18 of the vendor, bits 30 to 31 of the vendor");
        let profiles = [402, 401, 460, 400, 461, 0x811, 0].map(profile);
        assert_eq!(profiles, ["402", "401", "460", "0190h", "01CDh", "0811h", "0000h"]);
        assert_eq!((mode(8), mode(0)), ("csp (cyclic synchronous position)".to_owned(), "none".to_owned()));
        assert_eq!((mode(-3), mode(5)), ("-3 (of the vendor)".to_owned(), "5 (not known)".to_owned()));
        assert_eq!((register(0), register(0x21)), ("none".to_owned(), "generic, profile".to_owned()));
        assert_eq!(inputs(0x0001_0005), "negative limit, home, bit 16");
        assert_eq!(error(0x8611), "8611h following error");
        assert_eq!(number(&[0x92, 1, 2, 0]), Some(0x0002_0192));
        assert_eq!((number(&[]), number(&[0; 5])), (None, None));
        assert_eq!(text(b"drive 7 \0\xFF"), "drive 7");
    }
}

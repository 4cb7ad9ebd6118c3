//! Explains codes of errors, refusals, ends of goals and events, by number or name.

use super::{objects, section};
use crate::errors::part;
use lineshaft_core::axis::stops_all;
use lineshaft_core::code::{Class, Code, DRIVE_FAULT, Row};
use lineshaft_core::drive::error_text;

/// Last code of drives: 10000h + the maximum value of object 603Fh.
const LAST: u32 = Code::drive_fault(u16::MAX).0;

pub(super) fn sections(name: &str, width: usize) -> Vec<String> {
    let found = match number(name) {
        Some(number) => Code(number).row().map(|row| (Code(number), row)),
        None => {
            let named = |row: &&Row| row.name.eq_ignore_ascii_case(name);
            Code::rows().chain([&DRIVE_FAULT]).find(named).map(|row| (row.code, row))
        }
    };
    let found = found.or_else(|| fault(name).map(|code| (code, &DRIVE_FAULT)));
    found.map(|(code, row)| text(code, row, width)).into_iter().collect()
}

/// Returns the code of a drive fault by its object 603Fh, in the format of manuals: `8611h` or `0x8611`. An index of a
/// known object of a profile is none: `60FDh` means the digital inputs.
fn fault(name: &str) -> Option<Code> {
    let small = name.to_lowercase();
    let digits = small.strip_prefix("0x").or_else(|| small.strip_suffix('h'))?;
    let is_plain = (3..=4).contains(&digits.len()) && digits.chars().all(|digit| digit.is_ascii_hexdigit());
    let number = u16::from_str_radix(digits, 16).ok().filter(|number| is_plain && *number != 0)?;
    if objects::is_of_drive_profile(number) {
        return None;
    }
    error_text(number).map(|_| Code::drive_fault(number))
}

pub(super) fn names() -> Vec<String> {
    Code::rows().chain([&DRIVE_FAULT]).map(|row| row.name.to_owned()).collect()
}

/// Returns the number of a code in any of its formats: `10205`, `E10205`, `code 10205`, or `0x18611` of a drive.
fn number(name: &str) -> Option<u32> {
    let small = name.to_lowercase();
    let text = small.strip_prefix("code").map_or(small.as_str(), str::trim_start);
    let text = text.strip_prefix('e').unwrap_or(text);
    let (digits, radix) = text.strip_prefix("0x").map_or((text, 10), |digits| (digits, 16));
    // `from_str_radix` accepts a sign, which is not permitted here.
    let is_plain = digits.chars().all(|digit| digit.is_digit(radix));
    let number = u32::from_str_radix(digits, radix).ok().filter(|_| is_plain)?;
    (number <= LAST).then_some(number)
}

fn text(code: Code, row: &Row, width: usize) -> String {
    let kind = match row.class {
        Class::NoError if code.is_none() => "no error",
        Class::NoError => "a refusal, the end of a goal, a warning or a notice",
        _ => "an error of an axis",
    };
    let fault = code.0.checked_sub(Code::DRIVE_FAULT);
    let object = fault.map_or(String::new(), |fault| format!("603Fh is {fault:04X}h"));
    let standard = fault.and_then(|fault| error_text(u16::try_from(fault).ok()?)).unwrap_or_default();
    let mut reaction = row.class.text().to_owned();
    if stops_all(code) {
        reaction.push_str("; with following_error_stops_all all axes");
    }
    // Placeholders that an event replaces.
    let message = row.says.replace('{', "<").replace('}', ">");
    let facts: [(&str, &str); 8] = [
        ("message", message.as_str()),
        ("object", object.as_str()),
        ("CiA 402", standard),
        ("cause", row.cause),
        ("remedy", row.remedy),
        ("reaction", reaction.as_str()),
        ("source", part(code)),
        ("documented", "docs/errors.md"),
    ];
    section(&format!("code {} {}: {kind}", code.0, row.name), &facts, width)
}

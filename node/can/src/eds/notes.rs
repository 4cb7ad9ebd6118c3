//! Reads keys of a section as numbers, flags and values, and collects errors and warnings with line numbers.

use super::ini::{Item, Section};
use super::node_id_sum::plus_node_id;
use super::object::FileValue;
use super::problem::{IgnoredKey, IgnoredKeyKind, Problems, cut};
use lineshaft_cia402::dictionary::{DataType, Value, number::number};

/// End of the message about a key that is ignored.
const PASSED_OVER: &str = "; passed over";
/// Maximum node ID.
pub(super) const LAST_NODE: u8 = 127;

/// Errors and warnings of a file.
#[derive(Clone, Debug, Default)]
pub(super) struct Diagnostics {
    pub(super) errors: Problems,
    pub(super) warnings: Problems,
}

/// Returns `[section] key=value` as written in the file.
pub(super) fn section_text(section: &Section<'_>, item: Item<'_>) -> String {
    format!("[{}] {}={}", cut(section.name), cut(item.key), cut(item.value))
}

/// Returns the value without the comment that some files append. Numbers and hexadecimal digits contain no semicolon.
pub(super) fn without_remark(value: &str) -> &str {
    value.split(';').next().unwrap_or_default().trim()
}

/// Returns the value or limit that an ignored key gives an object; `None` for any other key.
fn passed_over(section: &Section<'_>, item: Item<'_>) -> Option<IgnoredKey> {
    let (digits, rest) = section.name.split_at_checked(4)?;
    let is_hex = digits.bytes().all(|digit| digit.is_ascii_hexdigit());
    let index = u16::from_str_radix(digits, 16).ok().filter(|_| is_hex)?;
    let key = match item.key.to_ascii_lowercase().as_str() {
        "defaultvalue" | "parametervalue" => IgnoredKeyKind::Value,
        "lowlimit" | "highlimit" => IgnoredKeyKind::Limit,
        _ if rest.eq_ignore_ascii_case("value") => IgnoredKeyKind::Value,
        _ => return None,
    };
    Some(IgnoredKey { index, key })
}

impl Diagnostics {
    pub(super) fn error(&mut self, section: &Section<'_>, item: Item<'_>, why: &str) {
        self.errors.add(Some(item.line), format!("{}: {why}", section_text(section, item)));
    }

    pub(super) fn warning(&mut self, section: &Section<'_>, item: Item<'_>, why: &str) {
        let text = format!("{}: {why}{PASSED_OVER}", section_text(section, item));
        self.warnings.add_of(Some(item.line), text, passed_over(section, item));
    }

    /// Returns a number within bounds, or the reason why it is invalid.
    pub(super) fn checked(item: Item<'_>, least: u32, most: u32) -> Result<u32, String> {
        let value = number(without_remark(item.value))?.value;
        let within = u32::try_from(value).ok().filter(|value| (least..=most).contains(value));
        within.ok_or_else(|| format!("{value} is not within {least} and {most}"))
    }

    /// Returns a number within bounds; `None` if the key is missing, and with a warning if it is invalid.
    pub(super) fn number(&mut self, section: &Section<'_>, key: &str, least: u32, most: u32) -> Option<u32> {
        let item = section.get(key)?;
        match Self::checked(item, least, most) {
            Ok(value) => Some(value),
            Err(why) => {
                self.warning(section, item, &why);
                None
            }
        }
    }

    /// Returns a flag, 0 or 1; `false` if the key is missing or invalid.
    pub(super) fn flag(&mut self, section: &Section<'_>, key: &str) -> bool {
        self.number(section, key, 0, 1) == Some(1)
    }

    /// Returns a value of a type; `None` if the key is missing, and with a warning if it is invalid.
    pub(super) fn given(&mut self, section: &Section<'_>, key: &str, data_type: DataType) -> Option<FileValue> {
        let item = section.get(key)?;
        match given(item.value, data_type) {
            Ok(given) => given,
            Err(why) => {
                self.warning(section, item, &why);
                None
            }
        }
    }
}

/// Parses a value; `None` if there is only a comment.
pub(super) fn given(text: &str, data_type: DataType) -> Result<Option<FileValue>, String> {
    let text = if data_type.is_text() { text } else { without_remark(text) };
    if text.is_empty() {
        return Ok(None);
    }
    if data_type.is_integer()
        && let Some(plus) = plus_node_id(text)
    {
        let plus = plus?;
        // A value that fits for the maximum node ID fits for all node IDs.
        Value::of_number(data_type, i128::from(plus) + i128::from(LAST_NODE)).map_err(|error| error.to_string())?;
        return Ok(Some(FileValue::NodeId { plus }));
    }
    Value::read(data_type, text).map(|value| Some(FileValue::Value(value))).map_err(|error| error.to_string())
}

//! Key `refused` of a step: the refusal that its commands must get.
//!
//! Law      a text must be part of the message, or the name of the parameter or of the code, ignoring case.
//!          `{code: 98}` is the code by number or name; with `text`, both must match. `any` matches every refusal
//! Refuses  true, false, yes and no, which do not describe the message, and a number, which is rarely part of it: a code
//!          was meant
//! Source   contract section 5

use super::ruler::read_code;
use crate::document::Value;
use lineshaft_core::code::Code;
use lineshaft_core::unit::excerpt;
use std::fmt;

/// Text that matches every refusal; for a part of a message it is written `{text: any}`.
const ANY: &str = "any";

/// Expected refusal; without code and text, any refusal matches.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Refusal {
    code: Option<u32>,
    text: Option<String>,
}

impl Refusal {
    /// Reads a text, `any`, or a mapping of `code` and `text`.
    pub(super) fn read(value: &Value<'_>) -> Option<Self> {
        if !value.is_map() {
            return Self::read_text(value);
        }
        let mut map = value.map("refused")?;
        let (code, text) = (map.optional("code"), map.optional("text"));
        if code.is_none() && text.is_none() {
            map.refuse("refused asks for nothing; code, text or both are expected", None);
        }
        let given = code.is_some() || text.is_some();
        let code = code.map(|value| read_code(&value));
        let text = text.map(|value| value.text().map(str::to_owned));
        map.finish();
        let code = code.map_or(Some(None), |code| code.map(Some))?;
        let text = text.map_or(Some(None), |text| text.map(Some))?;
        given.then_some(Self { code, text })
    }

    fn read_text(value: &Value<'_>) -> Option<Self> {
        let hint = match value.meant_boolean() {
            Some(true) => Some("write `refused: any`".to_owned()),
            Some(false) => Some("leave `refused` out".to_owned()),
            None if value.is_integer() => {
                Some(format!("write `refused: {{code: {}}}`", excerpt(value.peek().unwrap_or_default())))
            }
            None => None,
        };
        let text = value.text()?;
        if hint.is_some() {
            let text = excerpt(text);
            value.refuse(format!("refused is {text}; a part of the sentence, a code or `any` is expected"), hint);
            return None;
        }
        Some(Self { code: None, text: Some(text).filter(|text| *text != ANY).map(str::to_owned) })
    }

    /// Whether the code matches, and one of the messages or names matches the text.
    pub(super) fn fits(&self, code: Code, said: &[&str], names: &[&str]) -> bool {
        let is_said = |text: &String| {
            said.iter().any(|said| contains(said, text)) || names.iter().any(|name| name.eq_ignore_ascii_case(text))
        };
        self.code.is_none_or(|wanted| wanted == code.0) && self.text.as_ref().is_none_or(is_said)
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.code, &self.text) {
            (Some(code), Some(text)) => write!(f, "code {code} and `{}`", excerpt(text)),
            (Some(code), None) => write!(f, "code {code}"),
            (None, None) => f.write_str("any sentence"),
            // A number may be part of a message, but rarely is.
            (None, Some(text)) if text.parse::<u32>().is_ok() => {
                write!(f, "the text `{text}` (a code is written `{{code: {text}}}`)")
            }
            (None, Some(text)) => write!(f, "`{}`", excerpt(text)),
        }
    }
}

/// Whether the text contains the part, ignoring case.
pub(super) fn contains(text: &str, part: &str) -> bool {
    text.contains(part) || text.to_lowercase().contains(&part.to_lowercase())
}

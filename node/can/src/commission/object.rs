//! Parses objects as the user writes them.
//!
//! Law      `6064`, `0x6064`, `6064h:00`, `0x6099:1`: four hexadecimal digits, and one or two for the subindex, which is 0 if it is left
//!          out; or the name of one object of a dictionary. A name has precedence over an index of letters only
//! Refuses  any other text; the message gives the allowed forms
//! Source   CiA 301

use crate::eds::{Dictionary, FindError};
use lineshaft_cia402::object::Object;

/// Reason why a text is not an object.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ObjectError {
    /// The text is neither an index nor a name.
    #[error(
        "{0:?} is no object; allowed are an index like 6064 or 0x6064 (1000 to FFFF), index and subindex like 6099:01 (00 to FF), both \
         hexadecimal{names}", names = if *.1 { ", and a name of the EDS" } else { "; a name needs an EDS" }
    )]
    Form(String, bool),
    /// No object of the dictionary has the name, or several have it.
    #[error(transparent)]
    Find(#[from] FindError),
}

/// Parses an object.
///
/// # Errors
/// The text is not an object.
pub fn parse(text: &str, dictionary: Option<&Dictionary>) -> Result<Object, ObjectError> {
    let text = text.trim();
    let numbers = numbers(text);
    let looks_like_a_name = text.starts_with(|first: char| !first.is_ascii_digit());
    let Some(dictionary) = dictionary else {
        return numbers.ok_or_else(|| ObjectError::Form(text.to_owned(), false));
    };
    match (numbers, dictionary.find(text)) {
        (_, Ok(named)) if looks_like_a_name || numbers.is_none() => Ok(named),
        (Some(object), _) => Ok(object),
        (None, Err(error)) if looks_like_a_name => Err(error.into()),
        (None, _) => Err(ObjectError::Form(text.to_owned(), true)),
    }
}

fn numbers(text: &str) -> Option<Object> {
    let (index, sub) = text.split_once(':').unwrap_or((text, "0"));
    let index = hexadecimal(index, 4).filter(|index| *index >= 0x1000)?;
    Some(Object { index, sub: u8::try_from(hexadecimal(sub, 2)?).ok()? })
}

fn hexadecimal(text: &str, most: usize) -> Option<u16> {
    let text = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")).unwrap_or(text);
    let digits = text.strip_suffix(['h', 'H']).unwrap_or(text);
    let is_it = (1..=most).contains(&digits.len()) && digits.bytes().all(|digit| digit.is_ascii_hexdigit());
    is_it.then(|| u16::from_str_radix(digits, 16).ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eds;

    fn known() -> Dictionary {
        eds::parse(include_bytes!("../../../../launch-configs/can/cia402_sim.eds"), Some(3)).unwrap()
    }

    #[test]
    fn hexadecimal_index_is_parsed_with_and_without_prefix() {
        let read = |text: &str| parse(text, None).map(|object| (object.index, object.sub)).ok();
        for text in ["6064", "0x6064", "0X6064", "6064h", "6064:00", "6064h:00", "0x6064:0", " 6064 "] {
            assert_eq!(read(text), Some((0x6064, 0)), "{text}");
        }
        for text in ["6099:1", "0x6099:0x01", "6099h:01h"] {
            assert_eq!(read(text), Some((0x6099, 1)), "{text}");
        }
        assert_eq!(read("1f50:10"), Some((0x1F50, 0x10)));
        for text in ["", "606", "60640", "0064", "6064:", "6064:100", "6064:-1", "+6064", "6064:1:2", "Statusword"] {
            let error = parse(text, None).unwrap_err().to_string();
            assert!(error.ends_with("both hexadecimal; a name needs an EDS"), "{error}");
        }
    }

    #[test]
    fn name_of_dictionary_is_parsed() {
        let known = known();
        let read = |text: &str| parse(text, Some(&known)).map_err(|error| error.to_string());
        assert_eq!(read("position ACTUAL value"), Ok(Object { index: 0x6064, sub: 0 }));
        assert_eq!(read("Homing speeds.Speed during search for switch"), Ok(Object { index: 0x6099, sub: 1 }));
        assert_eq!(read("6099:2"), Ok(Object { index: 0x6099, sub: 2 }));
        assert_eq!(read("FFFF"), Ok(Object { index: 0xFFFF, sub: 0 }), "no name, so an index");
        assert_eq!(read("Homing speeds"), Err("no object has the name \"Homing speeds\"".to_owned()));
        assert!(read("60").unwrap_err().ends_with("both hexadecimal, and a name of the EDS"));
    }
}

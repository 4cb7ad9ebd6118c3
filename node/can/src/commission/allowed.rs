//! What a dictionary allows for an object: who may do what, which type its bytes are of, within which limits.
//!
//! Law      nothing is asked of a device that its dictionary forbids; an object that the dictionary does not have is bound by nothing
//! Refuses  reading what can only be written and the other way round, another type, values beyond the limits, a value without a type
//! Source   CiA 306-1

use super::kind;
use crate::eds::{DataType, Dictionary, Value, ValueError};
use crate::sdo::Object;
use std::cmp::Ordering;

/// Why something is not asked of a device.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// Its access forbids it.
    #[error("{label} cannot be {verb}: its access is {access} by the EDS")]
    Access {
        /// The object and its name.
        label: String,
        /// What cannot be done.
        verb: &'static str,
        /// Its access.
        access: &'static str,
    },
    /// Another type than was given.
    #[error("{label} is {known} by the EDS, not {given}; leave the type out")]
    Type {
        /// The object and its name.
        label: String,
        /// By the EDS.
        known: DataType,
        /// By whoever asks.
        given: DataType,
    },
    /// Nobody says what its bytes are.
    #[error("the type of {0} is not known: give it ({types}), or an EDS that has the object", types = kind::list())]
    NoType(String),
    /// The value is none of the type.
    #[error("{0}: {1}")]
    Value(String, ValueError),
    /// Beyond the limits.
    #[error("{label} cannot be {value}; {range} is allowed by the EDS")]
    Limit {
        /// The object and its name.
        label: String,
        /// The value.
        value: String,
        /// What is allowed.
        range: String,
    },
}

/// The object, and its name where the dictionary has it.
pub fn label(object: Object, dictionary: Option<&Dictionary>) -> String {
    match dictionary.and_then(|dictionary| dictionary.name(object)) {
        Some(name) => format!("{object} {name}"),
        None => object.to_string(),
    }
}

/// May it be read?
///
/// # Errors
/// It can only be written.
pub fn readable(object: Object, dictionary: Option<&Dictionary>) -> Result<(), Refusal> {
    let access = dictionary.and_then(|dictionary| dictionary.entry(object)).map(|entry| entry.access);
    match access.filter(|access| !access.is_readable()) {
        Some(access) => Err(Refusal::Access { label: label(object, dictionary), verb: "read", access: access.name() }),
        None => Ok(()),
    }
}

/// May it be written?
///
/// # Errors
/// It can only be read.
pub fn writable(object: Object, dictionary: Option<&Dictionary>) -> Result<(), Refusal> {
    let access = dictionary.and_then(|dictionary| dictionary.entry(object)).map(|entry| entry.access);
    match access.filter(|access| !access.is_writable()) {
        Some(access) => {
            Err(Refusal::Access { label: label(object, dictionary), verb: "written", access: access.name() })
        }
        None => Ok(()),
    }
}

/// What its bytes are: what the dictionary says, or else what was given.
///
/// # Errors
/// Both differ.
pub fn type_of(
    object: Object,
    given: Option<DataType>,
    dictionary: Option<&Dictionary>,
) -> Result<Option<DataType>, Refusal> {
    let known = dictionary.and_then(|dictionary| dictionary.entry(object)).map(|entry| entry.data_type);
    match (known, given) {
        // A type of the vendor, of which the file says nothing more.
        (Some(DataType::Other(_)), Some(given)) => Ok(Some(given)),
        (Some(known), Some(given)) if known != given => {
            Err(Refusal::Type { label: label(object, dictionary), known, given })
        }
        _ => Ok(known.or(given)),
    }
}

/// The bytes of a value that is to be written.
///
/// # Errors
/// What the access, the type or the limits do not allow.
pub fn encoded(
    object: Object,
    text: &str,
    given: Option<DataType>,
    dictionary: Option<&Dictionary>,
) -> Result<Vec<u8>, Refusal> {
    writable(object, dictionary)?;
    let data_type = type_of(object, given, dictionary)?.ok_or_else(|| Refusal::NoType(label(object, dictionary)))?;
    let refuse = |error| Refusal::Value(label(object, dictionary), error);
    let value = Value::parse(data_type, text).map_err(refuse)?;
    within(object, &value, dictionary)?;
    value.to_bytes(data_type).map_err(refuse)
}

/// Bytes of a device or of a file as a value.
///
/// # Errors
/// Bytes that are no value of the type, and values beyond the limits.
pub fn decoded(
    object: Object,
    bytes: &[u8],
    data_type: DataType,
    dictionary: Option<&Dictionary>,
) -> Result<Value, Refusal> {
    Value::from_bytes(data_type, bytes).map_err(|error| Refusal::Value(label(object, dictionary), error))
}

/// Is the value within the limits of its object?
fn within(object: Object, value: &Value, dictionary: Option<&Dictionary>) -> Result<(), Refusal> {
    let Some(known) = dictionary else { return Ok(()) };
    let (low, high) = (known.low_limit(object), known.high_limit(object));
    let is_low = low.as_ref().is_some_and(|low| order(value, low) == Some(Ordering::Less));
    let is_high = high.as_ref().is_some_and(|high| order(value, high) == Some(Ordering::Greater));
    if !is_low && !is_high {
        return Ok(());
    }
    let range = match (low, high) {
        (Some(low), Some(high)) => format!("{low} to {high}"),
        (Some(low), None) => format!("{low} and more"),
        (None, high) => format!("up to {}", high.map_or_else(String::new, |high| high.to_string())),
    };
    Err(Refusal::Limit { label: label(object, dictionary), value: value.to_string(), range })
}

fn order(value: &Value, limit: &Value) -> Option<Ordering> {
    match (value, limit) {
        (Value::Real32(value), Value::Real32(limit)) => value.partial_cmp(limit),
        (Value::Real64(value), Value::Real64(limit)) => value.partial_cmp(limit),
        _ => value.number().zip(limit.number()).map(|(value, limit)| value.cmp(&limit)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eds;

    /// The dictionary of the simulated drive, with limits for 607Fh.
    fn known() -> Dictionary {
        let text = String::from_utf8(include_bytes!("../../../../launch-configs/can/cia402_sim.eds").to_vec()).unwrap();
        let at = text.find("[607F]").unwrap();
        let (before, after) = text.split_at(at);
        let text = format!("{before}{}", after.replacen("[607F]", "[607F]\nLowLimit=10\nHighLimit=2000000", 1));
        eds::parse(text.as_bytes(), Some(3)).unwrap()
    }

    fn of(index: u16) -> Object {
        Object { index, sub: 0 }
    }

    fn refused(index: u16, text: &str, given: Option<DataType>) -> String {
        encoded(of(index), text, given, Some(&known())).unwrap_err().to_string()
    }

    #[test]
    fn what_the_dictionary_allows_becomes_bytes() {
        let known = known();
        assert_eq!(encoded(of(0x607A), "-2", None, Some(&known)), Ok(vec![0xFE, 0xFF, 0xFF, 0xFF]));
        assert_eq!(encoded(of(0x607F), "0x0A", None, Some(&known)), Ok(vec![10, 0, 0, 0]));
        assert_eq!(encoded(of(0x2001), "text", None, Some(&known)), Ok(b"text".to_vec()));
        assert_eq!(encoded(of(0x5000), "7", Some(DataType::Unsigned16), Some(&known)), Ok(vec![7, 0]));
        assert_eq!(encoded(of(0x5000), "0A ff", Some(DataType::OctetString), None), Ok(vec![10, 255]));
    }

    #[test]
    fn what_it_forbids_is_refused_with_name_value_and_range() {
        let by = "by the EDS";
        assert_eq!(refused(0x6041, "1", None), format!("6041h:00 Statusword cannot be written: its access is ro {by}"));
        assert_eq!(
            refused(0x607F, "2000001", None),
            format!("607Fh:00 Max profile velocity cannot be 2000001; 10 to 2000000 is allowed {by}")
        );
        assert!(refused(0x607F, "9", None).contains("cannot be 9; 10 to 2000000 is allowed"));
        assert_eq!(
            refused(0x6060, "200", None),
            "6060h:00 Modes of operation: 200 is not within -128 and 127, as INTEGER8 is"
        );
        assert_eq!(
            refused(0x6060, "1", Some(DataType::Unsigned8)),
            format!("6060h:00 Modes of operation is INTEGER8 {by}, not UNSIGNED8; leave the type out")
        );
        assert!(refused(0x5000, "1", None).starts_with("the type of 5000h:00 is not known: give it (bool, u8, "));
        assert!(refused(0x607A, "fast", None).contains("is no number"));
    }

    #[test]
    fn without_a_dictionary_nothing_is_forbidden() {
        assert_eq!((readable(of(0x6041), None), writable(of(0x6041), None)), (Ok(()), Ok(())));
        assert_eq!(type_of(of(0x6041), None, None), Ok(None));
        assert_eq!(readable(of(0x6041), Some(&known())), Ok(()));
        let value = decoded(of(0x6064), &[1, 0], DataType::Integer32, None).unwrap_err().to_string();
        assert_eq!(value, "6064h:00: INTEGER32 has 4 bytes, not 2");
    }
}

//! Checks of SDO access against an EDS: access type, data type and limits of an object.
//!
//! Law      access that the dictionary forbids is refused before anything is sent; an object that the dictionary lacks has no restrictions
//! Refuses  reading a write-only object, writing a read-only object, another data type, values beyond the limits, a value without a data
//!          type
//! Source   CiA 306-1

use crate::eds::Dictionary;
use lineshaft_cia402::dictionary::{DataType, Value, ValueError, type_name};
use lineshaft_cia402::object::Object;
use std::cmp::Ordering;

/// Reason why a request is not sent to a device.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// The access type of the object forbids it.
    #[error("{label} cannot be {verb}: its access is {access} by the EDS")]
    Access {
        /// Object and its name.
        label: String,
        /// Forbidden operation: "read" or "written".
        verb: &'static str,
        /// Access type of the object.
        access: &'static str,
    },
    /// The given data type conflicts with the EDS.
    #[error("{label} is {known} by the EDS, not {given}; leave the type out")]
    Type {
        /// Object and its name.
        label: String,
        /// Data type according to the EDS.
        known: DataType,
        /// Data type that the caller gave.
        given: DataType,
    },
    /// The data type of the object is unknown.
    #[error("the type of {0} is not known: give it ({types}), or an EDS that has the object", types = type_name::list())]
    NoType(String),
    /// The value does not fit the data type.
    #[error("{0}: {1}")]
    Value(String, ValueError),
    /// The value is beyond the limits of the object.
    #[error("{label} cannot be {value}; {range} is allowed by the EDS")]
    Limit {
        /// Object and its name.
        label: String,
        /// Refused value.
        value: String,
        /// Allowed range.
        range: String,
    },
}

/// Returns the object as text, with its name if the dictionary has it.
pub fn label(object: Object, dictionary: Option<&Dictionary>) -> String {
    match dictionary.and_then(|dictionary| dictionary.name(object)) {
        Some(name) => format!("{object} {name}"),
        None => object.to_string(),
    }
}

/// Checks that an object can be read.
///
/// # Errors
/// The object is write-only.
pub fn check_readable(object: Object, dictionary: Option<&Dictionary>) -> Result<(), Refusal> {
    let access = dictionary.and_then(|dictionary| dictionary.entry(object)).map(|entry| entry.access);
    match access.filter(|access| !access.is_readable()) {
        Some(access) => Err(Refusal::Access { label: label(object, dictionary), verb: "read", access: access.name() }),
        None => Ok(()),
    }
}

/// Checks that an object can be written.
///
/// # Errors
/// The object is read-only.
pub fn writable(object: Object, dictionary: Option<&Dictionary>) -> Result<(), Refusal> {
    let access = dictionary.and_then(|dictionary| dictionary.entry(object)).map(|entry| entry.access);
    match access.filter(|access| !access.is_writable()) {
        Some(access) => {
            Err(Refusal::Access { label: label(object, dictionary), verb: "written", access: access.name() })
        }
        None => Ok(()),
    }
}

/// Returns the data type of an object: from the dictionary, otherwise the given one.
///
/// # Errors
/// The two types differ.
pub fn type_of(
    object: Object,
    given: Option<DataType>,
    dictionary: Option<&Dictionary>,
) -> Result<Option<DataType>, Refusal> {
    let known = dictionary.and_then(|dictionary| dictionary.entry(object)).map(|entry| entry.data_type);
    match (known, given) {
        // A manufacturer type, which the file does not describe.
        (Some(DataType::Other(_)), Some(given)) => Ok(Some(given)),
        (Some(known), Some(given)) if known != given => {
            Err(Refusal::Type { label: label(object, dictionary), known, given })
        }
        _ => Ok(known.or(given)),
    }
}

/// Returns the bytes of a value that is to be written.
///
/// # Errors
/// The access type, the data type or the limits do not allow the value.
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

/// Decodes bytes from a device or a file.
///
/// # Errors
/// The bytes are not a value of the type, or the value is beyond the limits.
pub fn decoded(
    object: Object,
    bytes: &[u8],
    data_type: DataType,
    dictionary: Option<&Dictionary>,
) -> Result<Value, Refusal> {
    Value::from_bytes(data_type, bytes).map_err(|error| Refusal::Value(label(object, dictionary), error))
}

/// Checks that a value is within the limits of its object.
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

    /// Returns the dictionary of the simulated drive, with limits for 607Fh.
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
    fn allowed_value_is_encoded() {
        let known = known();
        assert_eq!(encoded(of(0x607A), "-2", None, Some(&known)), Ok(vec![0xFE, 0xFF, 0xFF, 0xFF]));
        assert_eq!(encoded(of(0x607F), "0x0A", None, Some(&known)), Ok(vec![10, 0, 0, 0]));
        assert_eq!(encoded(of(0x2001), "text", None, Some(&known)), Ok(b"text".to_vec()));
        assert_eq!(encoded(of(0x5000), "7", Some(DataType::Unsigned16), Some(&known)), Ok(vec![7, 0]));
        assert_eq!(encoded(of(0x5000), "0A ff", Some(DataType::OctetString), None), Ok(vec![10, 255]));
    }

    #[test]
    fn forbidden_value_is_refused_with_name_value_and_range() {
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
    fn object_without_dictionary_has_no_restrictions() {
        assert_eq!((check_readable(of(0x6041), None), writable(of(0x6041), None)), (Ok(()), Ok(())));
        assert_eq!(type_of(of(0x6041), None, None), Ok(None));
        assert_eq!(check_readable(of(0x6041), Some(&known())), Ok(()));
        let value = decoded(of(0x6064), &[1, 0], DataType::Integer32, None).unwrap_err().to_string();
        assert_eq!(value, "6064h:00: INTEGER32 has 4 bytes, not 2");
    }
}

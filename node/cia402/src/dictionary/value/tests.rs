use super::*;
use proptest::prelude::*;

fn bytes_of(data_type: DataType, text: &str) -> Vec<u8> {
    Value::parse(data_type, text).unwrap().to_bytes(data_type).unwrap()
}

#[test]
fn texts_become_little_endian_bytes_of_their_type() {
    let rows: [(DataType, &str, &[u8]); 27] = [
        (DataType::Boolean, "1", &[1]),
        (DataType::Boolean, "False", &[0]),
        (DataType::Integer8, "-5", &[0xFB]),
        (DataType::Integer8, "0x-80", &[0x80]),
        (DataType::Integer8, "0x80", &[0x80]),
        (DataType::Integer16, "0xFFFF", &[0xFF, 0xFF]),
        (DataType::Integer16, "0xFF", &[0xFF, 0x00]),
        (DataType::Integer24, "-1", &[0xFF, 0xFF, 0xFF]),
        (DataType::Integer32, "-2147483648", &[0, 0, 0, 0x80]),
        (DataType::Integer32, "0x80000000", &[0, 0, 0, 0x80]),
        (DataType::Integer40, "-40", &[0xD8, 0xFF, 0xFF, 0xFF, 0xFF]),
        (DataType::Integer48, "-48", &[0xD0, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF]),
        (DataType::Integer56, "-56", &[0xC8, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF]),
        (DataType::Integer64, "-64", &[0xC0, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF]),
        (DataType::Unsigned8, "0x10", &[16]),
        (DataType::Unsigned16, "8198", &[0x06, 0x20]),
        (DataType::Unsigned24, "24", &[24, 0, 0]),
        (DataType::Unsigned32, "0x60400010", &[0x10, 0x00, 0x40, 0x60]),
        (DataType::Unsigned40, "40", &[40, 0, 0, 0, 0]),
        (DataType::Unsigned64, "0xFFFFFFFFFFFFFFFF", &[0xFF; 8]),
        // 1.5 = 3FC00000h (IEEE 754).
        (DataType::Real32, "1.5", &[0x00, 0x00, 0xC0, 0x3F]),
        // -2 = C000000000000000h.
        (DataType::Real64, "-2", &[0, 0, 0, 0, 0, 0, 0, 0xC0]),
        (DataType::VisibleString, " EPOS4 ", b"EPOS4"),
        (DataType::UnicodeString, "a✓", &[0x61, 0x00, 0x13, 0x27]),
        (DataType::OctetString, "ABcd", &[0xAB, 0xCD]),
        (DataType::Domain, "00 01 ff", &[0x00, 0x01, 0xFF]),
        // One millisecond of day 256.
        (DataType::TimeOfDay, "010000000001", &[1, 0, 0, 0, 0, 1]),
    ];
    for (data_type, text, bytes) in rows {
        assert_eq!(bytes_of(data_type, text), bytes, "{data_type} {text}");
        assert_eq!(Value::from_bytes(data_type, bytes), Value::parse(data_type, text), "{data_type} {text}");
    }
}

#[test]
fn integer_bounds_are_exact() {
    let rows = [
        (DataType::Boolean, "0", "1", "-1", "2"),
        (DataType::Integer8, "-128", "127", "-129", "128"),
        (DataType::Integer16, "-32768", "32767", "-32769", "32768"),
        (DataType::Integer24, "-8388608", "8388607", "-8388609", "8388608"),
        (DataType::Integer32, "-2147483648", "2147483647", "-2147483649", "2147483648"),
        (
            DataType::Integer64,
            "-9223372036854775808",
            "9223372036854775807",
            "-9223372036854775809",
            "9223372036854775808",
        ),
        (DataType::Unsigned8, "0", "255", "-1", "256"),
        (DataType::Unsigned16, "0", "65535", "-1", "0x10000"),
        (DataType::Unsigned56, "0", "72057594037927935", "-1", "72057594037927936"),
    ];
    for (data_type, least, most, below, above) in rows {
        for text in [least, most] {
            assert_eq!(Value::parse(data_type, text).unwrap().to_string(), text, "{data_type}");
        }
        for text in [below, above] {
            assert!(matches!(Value::parse(data_type, text), Err(ValueError::Range { .. })), "{data_type} {text}");
        }
    }
    assert!(matches!(Value::parse(DataType::Unsigned64, "18446744073709551616"), Err(ValueError::Text(_))));
    // The bits of a negative number fill its type exactly.
    assert!(Value::parse(DataType::Integer8, "0x100").is_err());
}

#[test]
fn errors_contain_allowed_range() {
    let of = |data_type, text| Value::parse(data_type, text).unwrap_err().to_string();
    assert_eq!(of(DataType::Integer8, "200"), "200 is not within -128 and 127, as INTEGER8 is");
    assert_eq!(of(DataType::Unsigned8, "abc"), "\"abc\" is no number: decimal (12), hexadecimal (0x0C) or octal (014)");
    assert_eq!(of(DataType::Real32, "nan"), "\"nan\" is no finite number like 1.5 within REAL32");
    assert_eq!(of(DataType::Real32, "1e39"), "\"1e39\" is no finite number like 1.5 within REAL32");
    assert_eq!(
        of(DataType::Domain, "@ABCD"),
        "\"@ABCD\" is no value of DOMAIN: pairs of hexadecimal digits, like 0A FF"
    );
    assert_eq!(of(DataType::VisibleString, "a✓"), "the character '✓' does not exist in VISIBLE_STRING");
    assert_eq!(of(DataType::TimeOfDay, "01"), "TIME_OF_DAY has 6 bytes, not 1");
    assert_eq!(of(DataType::Other(0x40), "0x0"), "\"0x0\" cannot be read: values of data type 0040h are not known");
}

#[test]
fn leading_zeros_are_octal_in_file_and_refused_from_user() {
    assert_eq!(Value::read(DataType::Unsigned8, "010"), Ok(Value::Unsigned(8)));
    assert_eq!(Value::read(DataType::Integer8, "-010"), Ok(Value::Integer(-8)));
    for text in ["010", "-010", "00", "+08"] {
        let error = Value::parse(DataType::Integer8, text).unwrap_err().to_string();
        assert!(
            error.ends_with("begins with 0: write a decimal number without it, or 0x and a hexadecimal one"),
            "{text}"
        );
    }
    assert_eq!(Value::parse(DataType::Integer8, "0"), Ok(Value::Integer(0)));
    assert_eq!(Value::parse(DataType::Integer8, "-0x010"), Ok(Value::Integer(-16)));
    assert_eq!(Value::parse(DataType::Real32, "007.5"), Ok(Value::Real32(7.5)));
    assert_eq!(Value::parse(DataType::VisibleString, "007"), Ok(Value::Text("007".to_owned())));
}

#[test]
fn bytes_of_another_length_are_refused() {
    let of = |data_type, bytes: &[u8]| Value::from_bytes(data_type, bytes).unwrap_err().to_string();
    assert_eq!(of(DataType::Unsigned16, &[1]), "UNSIGNED16 has 2 bytes, not 1");
    assert_eq!(of(DataType::Integer24, &[0; 4]), "INTEGER24 has 3 bytes, not 4");
    assert_eq!(of(DataType::Real64, &[0; 4]), "REAL64 has 8 bytes, not 4");
    assert_eq!(of(DataType::UnicodeString, &[0; 3]), "UNICODE_STRING has an even number of bytes, not 3");
    assert_eq!(of(DataType::Boolean, &[2]), "2 is not within 0 and 1, as BOOLEAN is");
    assert_eq!(
        of(DataType::TimeOfDay, &[0, 0, 0, 0x10, 0, 0]),
        "268435456 is not within 0 and 268435455, as TIME_OF_DAY is"
    );
}

#[test]
fn a_value_of_another_kind_has_no_bytes() {
    let error = Value::Text("a".to_owned()).to_bytes(DataType::Unsigned8).unwrap_err();
    assert_eq!(error.to_string(), "\"a\" is no value of UNSIGNED8");
    assert!(Value::Integer(200).to_bytes(DataType::Integer8).is_err());
}

fn data_type() -> impl Strategy<Value = DataType> {
    (0_u16..0x30).prop_map(DataType::of)
}

proptest! {
    #[test]
    fn decoded_bytes_are_encoded_unchanged(data_type in data_type(), bytes in proptest::collection::vec(any::<u8>(), 0..9)) {
        if let Ok(value) = Value::from_bytes(data_type, &bytes) {
            prop_assert_eq!(value.to_bytes(data_type), Ok(bytes));
        }
    }

    #[test]
    fn parsed_texts_are_written_unchanged(data_type in data_type(), text in "[-+0-9a-fxX. ]{0,12}|.{0,12}") {
        if let Ok(value) = Value::read(data_type, &text) {
            prop_assert_eq!(Value::parse(data_type, &value.to_string()), Ok(value.clone()));
            let bytes = value.to_bytes(data_type).unwrap();
            prop_assert_eq!(Value::from_bytes(data_type, &bytes), Ok(value));
        }
    }

    #[test]
    fn reals_are_parsed_from_their_text(bits in any::<u32>(), wide in any::<u64>()) {
        let (single, double) = (f32::from_bits(bits), f64::from_bits(wide));
        if single.is_finite() {
            prop_assert_eq!(Value::parse(DataType::Real32, &Value::Real32(single).to_string()), Ok(Value::Real32(single)));
        }
        if double.is_finite() {
            prop_assert_eq!(Value::parse(DataType::Real64, &Value::Real64(double).to_string()), Ok(Value::Real64(double)));
        }
    }
}

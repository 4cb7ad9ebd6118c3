//! Strict CDR reader.
//!
//! Law      a number of n bytes starts at a multiple of n, counted from the first byte; a string is its length
//!          including the terminating zero (u32), its bytes, the zero; a sequence is its length (u32) and its elements;
//!          an array or a struct is only its elements or fields; a bool is one byte
//! Refuses  see [`decode`](super::decode)

use serde::de::{DeserializeSeed, Deserializer, SeqAccess, Visitor};

use super::{DecodeError, Endian, Problem};

/// Reads one value from bytes.
pub(super) struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    endian: Endian,
    type_name: Option<&'static str>,
}

impl<'a> Reader<'a> {
    pub(super) fn new(bytes: &'a [u8], endian: Endian) -> Self {
        Self { bytes, at: 0, endian, type_name: None }
    }

    /// Returns the number of bytes read.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    /// Returns the number of remaining bytes.
    pub(super) fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Returns the name of the outermost struct.
    pub(super) fn type_name(&self) -> &'static str {
        self.type_name.unwrap_or_default()
    }

    fn take(&mut self, alignment: usize, length: usize) -> Result<&'a [u8], DecodeError> {
        let padding = self.at.next_multiple_of(alignment) - self.at;
        let needed = padding.saturating_add(length);
        let left = self.left();
        if needed > left {
            return Err(DecodeError::new(Problem::TooShort { needed, left }));
        }
        let start = self.at + padding;
        self.at += needed;
        Ok(&self.bytes[start..self.at])
    }

    /// Reads a number of `N` bytes. Returns its bytes, least significant first.
    fn number<const N: usize>(&mut self) -> Result<[u8; N], DecodeError> {
        let mut number = [0; N];
        number.copy_from_slice(self.take(N, N)?);
        if self.endian == Endian::Big {
            number.reverse();
        }
        Ok(number)
    }

    fn length(&mut self) -> Result<u32, DecodeError> {
        Ok(u32::from_le_bytes(self.number()?))
    }

    fn text(&mut self) -> Result<&'a str, DecodeError> {
        // A length beyond usize cannot be available either.
        let length = usize::try_from(self.length()?).unwrap_or(usize::MAX);
        let bytes = self.take(1, length)?;
        match bytes.split_last() {
            None => Err(DecodeError::new(Problem::NoRoomForZero)),
            Some((0, text)) => std::str::from_utf8(text)
                .map_err(|error| DecodeError::new(Problem::Utf8 { valid: error.valid_up_to() })),
            Some((&last, _)) => Err(DecodeError::new(Problem::NoZero { last })),
        }
    }
}

/// The elements of a sequence, an array or a struct.
struct Elements<'r, 'a> {
    reader: &'r mut Reader<'a>,
    next: usize,
    end: usize,
    /// Field names; `None`: numbered elements.
    fields: Option<&'static [&'static str]>,
}

impl Elements<'_, '_> {
    /// Returns the name of the element before `next`, for an error.
    fn name(&self) -> String {
        let index = self.next - 1;
        match self.fields.and_then(|fields| fields.get(index)) {
            Some(field) => (*field).to_owned(),
            None => format!("[{index}]"),
        }
    }
}

impl<'de> SeqAccess<'de> for Elements<'_, '_> {
    type Error = DecodeError;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, DecodeError> {
        if self.next == self.end {
            return Ok(None);
        }
        self.next += 1;
        match seed.deserialize(&mut *self.reader) {
            Ok(value) => Ok(Some(value)),
            Err(error) => Err(error.within(&self.name())),
        }
    }

    /// At most the remaining bytes, because a longer sequence was rejected.
    fn size_hint(&self) -> Option<usize> {
        Some(self.end - self.next)
    }
}

macro_rules! numbers {
    ($($deserialize:ident $visit:ident $type:ty),*) => {
        $(fn $deserialize<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
            visitor.$visit(<$type>::from_le_bytes(self.number()?))
        })*
    };
}

macro_rules! unsupported {
    ($($deserialize:ident($($argument:ident: $type:ty),*) $what:literal),*) => {
        $(fn $deserialize<V: Visitor<'de>>(self, $($argument: $type,)* _visitor: V) -> Result<V::Value, DecodeError> {
            $(let _ = $argument;)*
            Err(DecodeError::new(Problem::Unsupported { what: $what }))
        })*
    };
}

impl<'de> Deserializer<'de> for &mut Reader<'_> {
    type Error = DecodeError;

    numbers! {
        deserialize_i8 visit_i8 i8, deserialize_u8 visit_u8 u8, deserialize_i16 visit_i16 i16,
        deserialize_u16 visit_u16 u16, deserialize_i32 visit_i32 i32, deserialize_u32 visit_u32 u32,
        deserialize_i64 visit_i64 i64, deserialize_u64 visit_u64 u64, deserialize_f32 visit_f32 f32,
        deserialize_f64 visit_f64 f64
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        match u8::from_le_bytes(self.number()?) {
            0 => visitor.visit_bool(false),
            1 => visitor.visit_bool(true),
            value => Err(DecodeError::new(Problem::Bool { value })),
        }
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        visitor.visit_str(self.text()?)
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        visitor.visit_str(self.text()?)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        let length = self.length()?;
        let left = self.left();
        // No element of a message is shorter than one byte.
        match usize::try_from(length) {
            Ok(end) if end <= left => visitor.visit_seq(Elements { reader: self, next: 0, end, fields: None }),
            _ => Err(DecodeError::new(Problem::SequenceLength { length, left })),
        }
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, DecodeError> {
        visitor.visit_seq(Elements { reader: self, next: 0, end: length, fields: None })
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, DecodeError> {
        self.type_name.get_or_insert(name);
        visitor.visit_seq(Elements { reader: self, next: 0, end: fields.len(), fields: Some(fields) })
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, DecodeError> {
        visitor.visit_newtype_struct(self)
    }

    unsupported! {
        deserialize_any() "a value without a type", deserialize_ignored_any() "a value without a type",
        deserialize_char() "a char", deserialize_bytes() "a byte slice", deserialize_byte_buf() "a byte buffer",
        deserialize_option() "an option", deserialize_unit() "a unit", deserialize_map() "a map",
        deserialize_identifier() "an identifier", deserialize_unit_struct(name: &'static str) "a unit struct",
        deserialize_tuple_struct(name: &'static str, length: usize) "a tuple struct",
        deserialize_enum(name: &'static str, variants: &'static [&'static str]) "an enum"
    }

    fn is_human_readable(&self) -> bool {
        false
    }
}

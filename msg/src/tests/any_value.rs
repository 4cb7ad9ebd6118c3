//! Any value of any message, made of bytes: a serde deserializer that accepts every input.

use serde::Deserialize;
use serde::de::value::Error;
use serde::de::{DeserializeSeed, Deserializer, Error as _, SeqAccess, Visitor};

/// Returns a value of `T` determined by the bytes; missing bytes count as zeros. A value that `T` rejects (too long for
/// its bound) becomes the default.
pub(super) fn any_value<T: for<'de> Deserialize<'de> + Default>(bytes: &[u8]) -> T {
    T::deserialize(&mut Dice(bytes.iter())).unwrap_or_default()
}

struct Dice<'a>(std::slice::Iter<'a, u8>);

impl Dice<'_> {
    fn byte(&mut self) -> u8 {
        self.0.next().copied().unwrap_or(0)
    }

    fn bytes<const N: usize>(&mut self) -> [u8; N] {
        std::array::from_fn(|_| self.byte())
    }

    /// Mostly 0 or 1, sometimes more, so that alignment varies and bounds are mostly kept.
    fn length(&mut self) -> usize {
        match self.byte() {
            low @ 0..=159 => usize::from(low & 1),
            high => usize::from(high % 6),
        }
    }
}

macro_rules! numbers {
    ($($deserialize:ident $visit:ident $type:ty),*) => {
        $(fn $deserialize<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
            visitor.$visit(<$type>::from_le_bytes(self.bytes()))
        })*
    };
}

impl<'de> Deserializer<'de> for &mut Dice<'_> {
    type Error = Error;

    numbers! {
        deserialize_i8 visit_i8 i8, deserialize_u8 visit_u8 u8, deserialize_i16 visit_i16 i16,
        deserialize_u16 visit_u16 u16, deserialize_i32 visit_i32 i32, deserialize_u32 visit_u32 u32,
        deserialize_i64 visit_i64 i64, deserialize_u64 visit_u64 u64
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        let value = f64::from_le_bytes(self.bytes());
        // NaN is not equal to itself, so a round trip could not be checked.
        visitor.visit_f64(if value.is_nan() { 0.0 } else { value })
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_bool(self.byte() & 1 == 1)
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        let length = self.length();
        visitor.visit_string((0..length).map(|_| char::from(self.byte())).collect())
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        let left = self.length();
        visitor.visit_seq(Elements { dice: self, left })
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, left: usize, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_seq(Elements { dice: self, left })
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        visitor.visit_seq(Elements { dice: self, left: fields.len() })
    }

    fn deserialize_any<V: Visitor<'de>>(self, _visitor: V) -> Result<V::Value, Error> {
        Err(Error::custom("no message holds this"))
    }

    serde::forward_to_deserialize_any! {
        i128 u128 f32 char str bytes byte_buf option unit unit_struct newtype_struct tuple_struct map enum identifier
        ignored_any
    }
}

struct Elements<'d, 'a> {
    dice: &'d mut Dice<'a>,
    left: usize,
}

impl<'de> SeqAccess<'de> for Elements<'_, '_> {
    type Error = Error;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Error> {
        if self.left == 0 {
            return Ok(None);
        }
        self.left -= 1;
        seed.deserialize(&mut *self.dice).map(Some)
    }
}

#[test]
fn the_bytes_decide_on_the_value() {
    use crate::srv::SetPositionRequest;
    let mut bytes = vec![1, b'x'];
    bytes.extend(2.5_f64.to_le_bytes());
    bytes.push(2);
    let expected = SetPositionRequest { axis: "x".to_owned(), position: 2.5, units: 2 };
    assert_eq!(any_value::<SetPositionRequest>(&bytes), expected);
}

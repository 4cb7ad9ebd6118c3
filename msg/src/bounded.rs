//! Strings and arrays with a maximum length, such as `string<=256` and `T[<=1]` in the files.

use std::ops::Deref;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

/// A value with a length that can be bounded.
pub trait Measured {
    /// Unit of the length, in the plural.
    const UNIT: &'static str;
    /// Returns the length: bytes of a string, elements of an array.
    fn measure(&self) -> usize;
}

impl Measured for String {
    const UNIT: &'static str = "bytes";
    fn measure(&self) -> usize {
        self.len()
    }
}

impl<T> Measured for Vec<T> {
    const UNIT: &'static str = "elements";
    fn measure(&self) -> usize {
        self.len()
    }
}

/// Error of a value that exceeds its bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{length} {unit}, at most {bound} are allowed")]
pub struct TooLong {
    /// Given length.
    pub length: usize,
    /// Maximum length.
    pub bound: usize,
    /// Unit of the length.
    pub unit: &'static str,
}

/// A `String` or `Vec` of at most `N` bytes or elements; dereferences to the value.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Bounded<V, const N: usize>(V);

impl<V: Measured, const N: usize> Bounded<V, N> {
    /// Creates a bounded value; returns [`TooLong`] if its length exceeds `N`.
    pub fn new(value: V) -> Result<Self, TooLong> {
        match value.measure() {
            length if length <= N => Ok(Self(value)),
            length => Err(TooLong { length, bound: N, unit: V::UNIT }),
        }
    }
}

impl<V, const N: usize> Bounded<V, N> {
    /// Returns the value.
    pub fn into_inner(self) -> V {
        self.0
    }
}

impl<V, const N: usize> Deref for Bounded<V, N> {
    type Target = V;
    fn deref(&self) -> &V {
        &self.0
    }
}

/// `None` is the empty array.
impl<T> From<Option<T>> for Bounded<Vec<T>, 1> {
    fn from(value: Option<T>) -> Self {
        Self(value.into_iter().collect())
    }
}

impl<V: Serialize, const N: usize> Serialize for Bounded<V, N> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.serialize(serializer)
    }
}

impl<'de, V: Deserialize<'de> + Measured, const N: usize> Deserialize<'de> for Bounded<V, N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::new(V::deserialize(deserializer)?).map_err(de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bound_itself_is_allowed_and_one_more_is_not() {
        let four = Bounded::<String, 4>::new("abcd".to_owned()).unwrap();
        assert_eq!((four.as_str(), four.len()), ("abcd", 4));
        // Two characters of three bytes: the bound counts bytes, as on the wire.
        let error = Bounded::<String, 4>::new("\u{20ac}\u{20ac}".to_owned()).unwrap_err();
        assert_eq!(error.to_string(), "6 bytes, at most 4 are allowed");
        let error = Bounded::<Vec<u8>, 1>::new(vec![1, 2]).unwrap_err();
        assert_eq!(error, TooLong { length: 2, bound: 1, unit: "elements" });
    }

    #[test]
    fn an_option_is_an_array_of_at_most_one() {
        assert_eq!(Bounded::<Vec<u8>, 1>::from(Some(7)).into_inner(), [7]);
        assert!(Bounded::<Vec<u8>, 1>::from(None).is_empty());
    }
}

//! Traps: reasons why a call ends early.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Error of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Error)]
pub enum Trap {
    /// The call did not end within its fuel.
    #[error("it used up its fuel")]
    OutOfFuel,
    /// Its calls or values exceed the stack.
    #[error("its calls go deeper than the stack")]
    StackOverflow,
    /// It reached code that is marked as unreachable: a panic of the program.
    #[error("it came to `unreachable`: a panic of its own")]
    Unreachable,
    /// It accessed an address outside its memory.
    #[error("it read or wrote beside its memory")]
    MemoryOutOfBounds,
    /// It called a function outside its table, or an empty entry.
    #[error("it called an entry of its table that holds no function")]
    NoFunction,
    /// It called a function with another signature.
    #[error("it called a function by another signature than its own")]
    SignatureMismatch,
    /// It divided a whole number by 0.
    #[error("it divided a whole number by 0")]
    DivisionByZero,
    /// A quotient or a converted float exceeds the range of whole numbers.
    #[error("a whole number overflowed: a quotient, or a float that was converted")]
    IntegerOverflow,
    /// It converted NaN to a whole number.
    #[error("it converted NaN to a whole number")]
    NotANumber,
    /// It changed the size of its image, which identifies the layout of the image.
    #[error("it wrote over the size of its image")]
    ImageOverwritten,
}

//! Why a call ends before its end.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// What a program did that it cannot do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Error)]
pub enum Trap {
    /// It did not come to its end in its fuel.
    #[error("it used up its fuel")]
    OutOfFuel,
    /// Its calls or values need more than the stack.
    #[error("its calls go deeper than the stack")]
    StackOverflow,
    /// It came to what it says is never reached: a panic of its own.
    #[error("it came to `unreachable`: a panic of its own")]
    Unreachable,
    /// It read or wrote beside its memory.
    #[error("it read or wrote beside its memory")]
    MemoryOutOfBounds,
    /// It called what is not in its table, or an entry without a function.
    #[error("it called an entry of its table that holds no function")]
    NoFunction,
    /// It called a function by another signature.
    #[error("it called a function by another signature than its own")]
    SignatureMismatch,
    /// It divided a whole number by 0.
    #[error("it divided a whole number by 0")]
    DivisionByZero,
    /// A quotient, or a float as a whole number, fits no whole number.
    #[error("a whole number overflowed: a quotient, or a float that was converted")]
    IntegerOverflow,
    /// NaN as a whole number.
    #[error("it converted NaN to a whole number")]
    NotANumber,
    /// It changed the size of its image, which says what image it was built for.
    #[error("it wrote over the size of its image")]
    ImageOverwritten,
}

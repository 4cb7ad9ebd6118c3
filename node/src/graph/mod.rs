//! Dependencies of the function slots of a cell, as links, loops and a figure.

mod figure;
mod links;
mod loops;
mod svg;

pub use figure::draw;
pub use loops::loops;

#[cfg(test)]
mod tests;

//! Tuning of an axis of a cell: what was found, as figures, text and plot, and its gains in the cell file.
//!
//! Law      `findings` compares the loops as they are with those that were designed, on the model of the axis; `text` and `plot` show that;
//!          `apply` writes the gains where the cell has its parameters, and nothing else
//! Reads    records, models, loops; the text of a cell
//! Writes   sentences, figures, the cell file
//! Refuses  with one sentence each
//!
//! It moves no axis, and knows no machine that runs.

mod apply;
mod findings;
mod plot;
#[cfg(test)]
mod test_axes;
mod text;

pub use apply::{ApplyError, apply, by_hand, edited};
pub use findings::{Answer, Findings, Gain, Subject};
pub use plot::{draw_plot, write_plot};

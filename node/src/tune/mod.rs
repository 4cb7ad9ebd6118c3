//! Tunes an axis of a cell: findings as figures, text and plot, and gains in the cell file.
//!
//! Law      `setting` has the permitted motion of the axis; `trial` enables, excites and disables it; `findings`
//!          compares the present loops with the designed ones, with the model of the axis; `text` and `plot` present
//!          the result; `apply` writes the gains at the parameters in the cell, and nothing else
//! Reads    records, models, loops; the text of a cell
//! Writes   messages, figures, the cell file
//! Refuses  with one message each
//!
//! Only `trial` moves an axis, by commands; other modules run the machine.

mod apply;
mod findings;
mod plot;
mod setting;
mod simulated;
#[cfg(test)]
mod test_axes;
mod text;
mod trial;

pub use apply::{apply, by_hand, settings};
pub use findings::{Answer, Findings, Gain, Subject};
pub use plot::{draw_plot, write_plot};
pub use setting::{Bounds, Setting, Unfit};
pub(crate) use simulated::try_until;
pub use simulated::{TrialError, try_simulated};
pub use trial::{Doing, Ended, Stop, Trial};

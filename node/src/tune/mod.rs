//! Tuning of an axis of a cell: what was found, as figures, text and plot, and its gains in the cell file.
//!
//! Law      `setting` says what may be done to the axis; `trial` enables, excites and disables it; `findings` compares the loops as they are with those that were designed, on the model of the axis; `text` and `plot` show that;
//!          `apply` writes the gains where the cell has its parameters, and nothing else
//! Reads    records, models, loops; the text of a cell
//! Writes   sentences, figures, the cell file
//! Refuses  with one sentence each
//!
//! `trial` alone moves an axis, by commands; what runs the machine stands elsewhere.

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

//! Signals of the vocabulary.

use crate::signal::Type::{Bit, Int};
use crate::signal::signal_block;

signal_block! {
    /// A signal of the vocabulary, by its index in the block.
    AmcSignal;

    Active "amc.active" Bit, None; "the vocabulary commands the axis"
    Select "amc.select" Int, None; "reference in force (34.007), 0 while the axis is off"
    StopReference "amc.stop_reference" Int, Position; "where a stop ends or ended (34.002), floor, within the turn"
    ProfileInputPosition "amc.profile_input_position" Int, Position; "target given to the profile (38.006), floor, within the turn"
    ProfileInputTurns "amc.profile_input_turns" Int, None; "turns of that target, which the source hides"
}

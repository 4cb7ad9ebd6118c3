//! Additional signals of an axis with two drives.

use super::Type::{Bit, Enum, Int};
use super::signal_block;
use crate::state::DRIVE_STATES;

signal_block! {
    /// A signal of a gantry, by its index in its block.
    GantrySignal;

    Skew "skew" Int, Position; "how far the second drive is ahead of square"
    SecondPosition "second.position" Int, Position; "actual position of the second drive, as it would be the axis'"
    SecondCount "second.count" Int, Position, drivable; "raw counts of the second drive"
    SecondState "second.drive_state" Enum(DRIVE_STATES), None; "CiA 402 state of the second drive"
    SecondSwitch "second.reference_switch" Bit, None, drivable; "reference switch of the second drive"
    SecondOutput "second.output.position" Int, Position; "position asked of the second drive, in its counts"
}

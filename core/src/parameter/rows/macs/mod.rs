//! The parameters of MACS (spec/macs.md, section 1): 106 of an axis, 14 of the machine. Where two statements of the manual
//! disagree (D01 to D23) a row says what was decided.

mod amplifier;
mod basic;
mod encoder;
mod global;
mod homing;
mod inputs;
mod regulation;
mod synchronization;

use super::Row;
pub(super) use encoder::SENSE;

/// Group by group.
pub(super) const PARTS: [&[Row]; 8] = [
    basic::ROWS,
    encoder::ROWS,
    inputs::ROWS,
    homing::ROWS,
    synchronization::ROWS,
    regulation::ROWS,
    amplifier::ROWS,
    global::ROWS,
];

//! Items of the slot that the file of a slot type needs.

pub(super) use super::description::{AmkLimits, Description, MarkSource, Monitored, Quantity, Requirement};
pub(super) use super::field::{CellBound, Field, Words, number, place};
pub(super) use super::program::{
    CallInputs, Drive, Fault, GoalRequest, LINES, Occasion, Outcome, Progress, Setting, SlotSetup, SlotType, WORDS,
};
pub(super) use super::shown::{OF_MARKS, OF_MARKS_AND_ANSWER, OF_SAK, Shown};
pub(super) use super::types::Kind;
pub(super) use super::wires::{OutputCell, Width};

//! The layers of a parameter (MACS-STO-02).
//!
//! Law      effective = Program where it was set, else User where it was saved, else Init
//!
//! Init is the row's default overlaid by the cell; it is what the machine was delivered with. User is what was saved; it is in
//! force from the start. Program is what was set since the start, and is lost with the power.

use super::{AxisParameters, MachineParameters, ROWS, Storage};
use crate::table::Table;
use std::sync::Arc;

/// A layer that can be brought back into force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// What was saved: drops what was set since the start.
    User,
    /// What the cell says: drops what was saved, too, but keeps it stored.
    Init,
}

impl Layer {
    /// Both, by the numbers of the interface.
    pub const NAMES: &[(&str, Layer)] = &[("user", Layer::User), ("init", Layer::Init)];
}

/// All parameters of a machine at the end of a cycle, for who shows and stores them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParameterImage {
    /// Grows with every change of anything in it.
    pub version: u64,
    /// In force, by axis.
    pub effective: Vec<AxisParameters>,
    /// Layer User, by axis.
    pub user: Vec<AxisParameters>,
    /// Of the machine: in force, and layer User.
    pub machine: [MachineParameters; 2],
    /// By function, in the order of the slots.
    pub functions: Vec<Sets>,
    /// In file order.
    pub tables: Vec<Arc<Table>>,
}

/// The sets of a function.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sets {
    /// For the next START or VALUE_NEW.
    pub staged: Box<[i64]>,
    /// In force; of a function at rest those of its last START.
    pub active: Box<[i64]>,
}

impl AxisParameters {
    /// What saving keeps of these: volatile values are those of `init`.
    pub fn saved(&self, init: &Self) -> Self {
        let mut saved = *self;
        for row in ROWS.iter().filter(|row| row.is_stored() && row.storage != Storage::User) {
            (row.set)(&mut saved, row.value(init));
        }
        saved.derive();
        saved
    }
}

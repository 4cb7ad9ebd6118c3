//! Layers of a parameter (MACS-STO-02).
//!
//! Law      effective = Program if it was set, else User if it was saved, else Init
//!
//! Init is the default of the row, overridden by the cell: the values at delivery. User is the saved value, which is
//! active from the start. Program is the value set since the start, which is lost at power-off.

use super::{AxisParameters, MachineParameters, ROWS, Storage};
use crate::table::Table;
use std::sync::Arc;

/// A layer that can be activated again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// The saved values: drops values set since the start.
    User,
    /// The values of the cell: drops saved values, too, but keeps them in the storage.
    Init,
}

impl Layer {
    /// Both layers, by the numbers of the interface.
    pub const NAMES: &[(&str, Layer)] = &[("user", Layer::User), ("init", Layer::Init)];
}

/// All parameters of a machine at the end of a cycle, for display and storage.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParameterImage {
    /// Version, which increases with every change.
    pub version: u64,
    /// Active parameters, by axis.
    pub effective: Vec<AxisParameters>,
    /// Layer User, by axis.
    pub user: Vec<AxisParameters>,
    /// Parameters of the machine: active ones, and layer User.
    pub machine: [MachineParameters; 2],
    /// Parameter sets by function, in the order of the slots.
    pub functions: Vec<Sets>,
    /// Tables, in file order.
    pub tables: Vec<Arc<Table>>,
}

/// Parameter sets of a function.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sets {
    /// Values for the next START or VALUE_NEW.
    pub staged: Box<[i64]>,
    /// Active values; those of the last START if the function is at rest.
    pub active: Box<[i64]>,
}

impl AxisParameters {
    /// Returns the values to save: volatile values are those of `init`.
    pub fn saved(&self, init: &Self) -> Self {
        let mut saved = *self;
        for row in ROWS.iter().filter(|row| row.is_stored() && row.storage != Storage::User) {
            (row.set)(&mut saved, row.value(init));
        }
        saved.derive();
        saved
    }
}

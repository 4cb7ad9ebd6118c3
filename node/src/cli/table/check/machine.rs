//! The cell with which a table is compared.

use super::Failure;
use crate::cell::Cell;
use crate::table::description::Description;
use lineshaft_core::config::{AxisConfig, MachineConfig};
use lineshaft_core::object::Leader;
use lineshaft_core::unit::Scale;
use std::path::{Path, PathBuf};

/// A cell and its path.
pub(super) struct Machine {
    path: PathBuf,
    config: MachineConfig,
}

/// The leader.
pub(super) struct Master {
    /// Name, as given.
    pub(super) name: String,
    /// Scale from increments to units; `None` if it has increments only.
    pub(super) scale: Option<Scale>,
    /// Maximum velocity in inc/s, if it is an axis.
    pub(super) max_velocity: Option<f64>,
}

impl Machine {
    /// Reads the cell.
    ///
    /// # Errors
    /// Returns all errors of the cell.
    pub(super) fn load(path: &Path) -> Result<Self, Failure> {
        let cell = Cell::load(path).map_err(|problems| Failure::Problems(problems.to_string()))?;
        Ok(Self { path: path.to_owned(), config: cell.machine })
    }

    /// Returns the path of the file, as given.
    pub(super) fn file(&self) -> String {
        self.path.display().to_string()
    }

    /// Returns the following axis.
    ///
    /// # Errors
    /// Returns an error if there is no axis with that name.
    pub(super) fn axis(&self, name: &str) -> Result<&AxisConfig, Failure> {
        self.config.find_axis(name).map(|(_, axis)| axis).map_err(|error| self.failure(error))
    }

    /// Returns the leader.
    ///
    /// # Errors
    /// Returns an error if nothing with that name can lead.
    pub(super) fn leader(&self, name: &str) -> Result<Master, Failure> {
        let leader = self.config.find_leader(name).map_err(|error| self.failure(error))?;
        let max_velocity = match leader {
            Leader::AxisCommand(axis) | Leader::AxisActual(axis) => {
                self.config.axes.get(usize::from(axis)).map(|axis| axis.parameters.max_velocity)
            }
            _ => None,
        };
        Ok(Master { name: name.to_owned(), scale: self.config.known_scale_of(leader), max_velocity })
    }

    /// Returns a message with the tables of the cell that have the points of a description, or that none has, because
    /// its CSV file may be older. `None` for a cell without tables.
    pub(super) fn tables_with(&self, description: &Description, file: &Path) -> Option<String> {
        let Ok(made) = description.table() else { return None };
        let cell = self.file();
        if self.config.tables.is_empty() {
            return None;
        }
        let is_same = |table: &&lineshaft_core::config::TableConfig| {
            let table = &table.table;
            table.form() == made.form() && table.x() == made.x() && table.y() == made.y()
        };
        let same: Vec<&str> = self.config.tables.iter().filter(is_same).map(|table| table.name.as_str()).collect();
        if !same.is_empty() {
            return Some(format!("  these are the points of table {} of {cell}", same.join(", ")));
        }
        let file = file.display();
        Some(format!(
            "  no table of {cell} has these points; `lineshaft table make {file} -o FILE.csv` writes them into its CSV file"
        ))
    }

    fn failure(&self, error: impl std::fmt::Display) -> Failure {
        Failure::Sentence(format!("{}: {error}", self.path.display()))
    }
}

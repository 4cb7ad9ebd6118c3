//! Finds which axes are linear and which are rotary, from the attached cell, because messages do not contain it.

use crate::cell::Cell;
use crate::recording::run::{Run, RunError};
use lineshaft_core::unit::ScaleKind;
use std::collections::HashMap;

/// Kinds of axes and encoders, by name.
#[derive(Clone, Debug, Default)]
pub(super) struct Units {
    kinds: HashMap<String, ScaleKind>,
    notes: Vec<String>,
}

impl Units {
    /// Reads the cells attached to the runs; the first one has priority.
    pub(super) fn of(runs: [&Run; 2]) -> Result<Self, RunError> {
        let mut units = Self::default();
        for run in runs {
            let Some(bytes) = run.attachment("cell.yaml")? else { continue };
            let files = crate::recording::attached_files(run)?;
            match Cell::parse_recorded("cell.yaml", String::from_utf8_lossy(&bytes), files.as_deref()) {
                Ok(cell) => units.add(&cell),
                // Another program may use the same attachment name for other content.
                Err(_) => {
                    let name = super::name(run);
                    units.notes.push(format!("{name}: the attached cell has errors and tells no units of axes"));
                }
            }
        }
        Ok(units)
    }

    fn add(&mut self, cell: &Cell) {
        let axes = cell.machine.axes.iter().map(|axis| (&axis.name, axis.scale));
        let encoders = cell.machine.encoders.iter().map(|encoder| (&encoder.name, encoder.scale));
        for (name, scale) in axes.chain(encoders) {
            self.kinds.entry(name.clone()).or_insert(scale.kind());
        }
    }

    /// Returns the kind of axis of a signal, if known.
    pub(super) fn kind(&self, signal: &str) -> Option<ScaleKind> {
        let mut ends = signal.rmatch_indices('.').map(|(end, _)| end);
        ends.find_map(|end| self.kinds.get(&signal[..end]).copied())
    }

    /// Returns notes for the user.
    pub(super) fn notes(&self) -> &[String] {
        &self.notes
    }
}

#[cfg(test)]
impl<const N: usize> From<[(&str, ScaleKind); N]> for Units {
    fn from(kinds: [(&str, ScaleKind); N]) -> Self {
        let kinds = kinds.into_iter().map(|(name, kind)| (name.to_owned(), kind)).collect();
        Self { kinds, notes: Vec::new() }
    }
}

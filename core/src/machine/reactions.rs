//! Error reactions that affect other axes.
//!
//! Law      in the cycle of a position error, every axis whose drive is switched on or being switched on stops with its
//!          own error_reaction
//! Source   MACS-ERR-05, A-44

use super::{CycleInputs, Machine};

impl Machine {
    /// Stops the other axes if an error of this cycle requires it.
    pub(super) fn stop_others(&mut self, told: CycleInputs<'_>) {
        let Some(cause) = self.state.axes.iter().position(|axis| axis.stops_others()) else { return };
        for index in (0..self.state.axes.len()).filter(|index| *index != cause) {
            self.act_on(index, told, |axis, cx| axis.stop_with_other(cx, cause as u16));
            self.state.axes[index].publish(&mut self.state.board, &self.state.leads);
        }
    }
}

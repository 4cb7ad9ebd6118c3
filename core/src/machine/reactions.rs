//! Errors of one axis that concern others.
//!
//! Law      in the cycle of a position error every axis with a drive that is on, or on its way to it, stops by its own
//!          error_reaction
//! Source   MACS-ERR-05, A-44

use super::{Machine, Told};

impl Machine {
    /// Stops the other axes, where an error of this cycle asks for that.
    pub(super) fn stop_others(&mut self, told: Told<'_>) {
        let Some(cause) = self.state.axes.iter().position(|axis| axis.stops_others()) else { return };
        for index in (0..self.state.axes.len()).filter(|index| *index != cause) {
            self.act_on(index, told, |axis, cx| axis.stop_with_other(cx, cause as u16));
            self.state.axes[index].publish(&mut self.state.board, &self.state.leads);
        }
    }
}

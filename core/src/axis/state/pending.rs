//! Commands whose end is pending: touch probes, goals in the buffer, commands that wait for a state.

use super::buffer::Buffer;
use super::touch_probes::TouchProbes;
use super::waiting::Waiting;
use serde::{Deserialize, Serialize};

/// Commands whose end is pending.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(in crate::axis) struct Pending {
    touch_probes: TouchProbes,
    buffer: Buffer,
    waiting: Waiting,
}

impl Pending {
    #[inline]
    pub(in crate::axis) fn touch_probes(&self) -> &TouchProbes {
        &self.touch_probes
    }

    #[inline]
    pub(in crate::axis) fn touch_probes_mut(&mut self) -> &mut TouchProbes {
        &mut self.touch_probes
    }

    /// Returns the waiting goals.
    #[inline]
    pub(in crate::axis) fn buffer(&self) -> &Buffer {
        &self.buffer
    }

    #[inline]
    pub(in crate::axis) fn buffer_mut(&mut self) -> &mut Buffer {
        &mut self.buffer
    }

    /// Returns the commands that wait for a state of the axis.
    #[inline]
    pub(in crate::axis) fn waiting(&self) -> &Waiting {
        &self.waiting
    }

    #[inline]
    pub(in crate::axis) fn waiting_mut(&mut self) -> &mut Waiting {
        &mut self.waiting
    }
}

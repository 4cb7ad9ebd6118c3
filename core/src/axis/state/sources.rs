//! Sources of positions: that of the axis, and its view of its master.

use super::master_view::MasterView;
use super::sensor::Sensor;
use serde::{Deserialize, Serialize};

/// Sources of positions of an axis.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) struct Sources {
    sensor: Sensor,
    master: MasterView,
}

impl Sources {
    pub(in crate::axis) fn new(sensor: Sensor) -> Self {
        Self { sensor, master: MasterView::default() }
    }

    /// Returns the source of the actual position.
    #[inline]
    pub(in crate::axis) fn sensor(&self) -> &Sensor {
        &self.sensor
    }

    #[inline]
    pub(in crate::axis) fn sensor_mut(&mut self) -> &mut Sensor {
        &mut self.sensor
    }

    /// Returns the displayed position of the master.
    #[inline]
    pub(in crate::axis) fn master(&self) -> &MasterView {
        &self.master
    }

    #[inline]
    pub(in crate::axis) fn master_mut(&mut self) -> &mut MasterView {
        &mut self.master
    }
}

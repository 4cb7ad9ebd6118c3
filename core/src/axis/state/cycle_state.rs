//! How much of a cycle an axis executes, and its place among the signals.

use super::pace::CyclePace;
use crate::signal::Signal;
use serde::{Deserialize, Serialize};

/// How much of a cycle an axis executes, and its place among the signals.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[repr(C)]
pub(in crate::axis) struct CycleState {
    #[serde(skip)]
    pace: CyclePace,
    /// First of its signals.
    signals: Signal,
}

impl CycleState {
    pub(in crate::axis) fn new(signals: Signal) -> Self {
        Self { pace: CyclePace::default(), signals }
    }

    #[inline]
    pub(in crate::axis) fn pace(&self) -> &CyclePace {
        &self.pace
    }

    #[inline]
    pub(in crate::axis) fn pace_mut(&mut self) -> &mut CyclePace {
        &mut self.pace
    }

    /// Returns the first of its signals.
    #[inline]
    pub(in crate::axis) fn signals(&self) -> Signal {
        self.signals
    }
}

//! Motions in addition to the active one, and couplings that wait to begin or to end.

use super::conditioning::Conditioning;
use super::engagement::Engagement;
use super::leaving::Leaving;
use super::overlay::Overlay;
use super::phasing::Phasing;
use serde::{Deserialize, Serialize};

/// Motions in addition to the active one, processing of the master motion, waiting couplings.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(in crate::axis) struct CouplingState {
    overlay: Option<Overlay>,
    phasing: Option<Phasing>,
    conditioning: Conditioning,
    engagement: Option<Engagement>,
    leaving: Option<Leaving>,
}

impl CouplingState {
    /// Returns the superimposed motion.
    #[inline]
    pub(in crate::axis) fn overlay(&self) -> &Option<Overlay> {
        &self.overlay
    }

    #[inline]
    pub(in crate::axis) fn overlay_mut(&mut self) -> Option<&mut Overlay> {
        self.overlay.as_mut()
    }

    #[inline]
    pub(in crate::axis) fn set_overlay(&mut self, overlay: Option<Overlay>) {
        self.overlay = overlay;
    }

    #[inline]
    pub(in crate::axis) fn take_overlay(&mut self) -> Option<Overlay> {
        self.overlay.take()
    }

    /// Returns the shift of the master.
    #[inline]
    pub(in crate::axis) fn phasing(&self) -> &Option<Phasing> {
        &self.phasing
    }

    #[inline]
    pub(in crate::axis) fn phasing_mut(&mut self) -> Option<&mut Phasing> {
        self.phasing.as_mut()
    }

    #[inline]
    pub(in crate::axis) fn set_phasing(&mut self, phasing: Option<Phasing>) {
        self.phasing = phasing;
    }

    #[inline]
    pub(in crate::axis) fn take_phasing(&mut self) -> Option<Phasing> {
        self.phasing.take()
    }

    /// Returns the processing of the master motion.
    #[inline]
    pub(in crate::axis) fn conditioning(&self) -> &Conditioning {
        &self.conditioning
    }

    #[inline]
    pub(in crate::axis) fn conditioning_mut(&mut self) -> &mut Conditioning {
        &mut self.conditioning
    }

    /// Returns the coupling that waits to engage.
    #[inline]
    pub(in crate::axis) fn engagement(&self) -> &Option<Engagement> {
        &self.engagement
    }

    #[inline]
    pub(in crate::axis) fn set_engagement(&mut self, engagement: Option<Engagement>) {
        self.engagement = engagement;
    }

    #[inline]
    pub(in crate::axis) fn take_engagement(&mut self) -> Option<Engagement> {
        self.engagement.take()
    }

    /// Returns the command that waits to leave the coupling.
    #[inline]
    pub(in crate::axis) fn leaving(&self) -> &Option<Leaving> {
        &self.leaving
    }

    #[inline]
    pub(in crate::axis) fn set_leaving(&mut self, leaving: Option<Leaving>) {
        self.leaving = leaving;
    }

    #[inline]
    pub(in crate::axis) fn take_leaving(&mut self) -> Option<Leaving> {
        self.leaving.take()
    }
}

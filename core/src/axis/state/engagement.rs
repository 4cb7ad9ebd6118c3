//! A coupling that waits to engage.

use super::pair::Pair;
use super::smooth::Smooth;
use crate::command::{Engage, Synchronize};
use crate::modulo::Modulo;
use crate::object::Leader;
use crate::position::Position;
use crate::sync::SyncMode;
use serde::{Deserialize, Serialize};

/// A coupling that waits to engage.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) struct Engagement {
    /// Number of its command.
    pub sequence: u64,
    pub leader: Leader,
    pub request: Synchronize,
    /// Position of its leader in the cycle before.
    pub(in crate::axis) seen: Position,
    /// Cycle of its command. Latches of that cycle came before the command.
    pub(in crate::axis) since: u64,
    /// Changes of its leader (inc) in the last cycles of waiting, the newest first, and their number.
    pub(in crate::axis) recent: [f64; RECENT],
    pub(in crate::axis) count: u8,
    /// State of a smooth start by marks, if it waits for one.
    pub smooth: Option<Smooth>,
}

/// Cycles from which the speed of a leader is calculated.
pub(in crate::axis) const RECENT: usize = 8;

impl Engagement {
    /// Returns it after one more cycle with that change of its leader (inc).
    pub(in crate::axis) fn note_change(mut self, change: f64) -> Self {
        self.recent.rotate_right(1);
        let [newest, ..] = &mut self.recent;
        *newest = change;
        Self { count: self.count.saturating_add(1).min(RECENT as u8), ..self }
    }

    /// Returns the mean change of its leader in a cycle (inc).
    pub(in crate::axis) fn mean(&self) -> f64 {
        self.recent.iter().take(self.count.into()).sum::<f64>() / f64::from(self.count.max(1))
    }

    pub(in crate::axis) fn is_sound(&self) -> bool {
        let Synchronize { velocity, acceleration, cam, engage, mode, .. } = self.request;
        let is_cam = cam.is_some();
        let can_wait = match engage {
            Engage::Immediately => mode == SyncMode::Marker && self.smooth.is_some_and(|smooth| smooth.is_sound()),
            Engage::AtPosition { turn, .. } => {
                turn.is_none_or(Modulo::is_sound) && !mode.has_marks() && (is_cam || mode == SyncMode::Velocity)
            }
            Engage::AtEnd => is_cam && !mode.has_marks(),
            Engage::InPosition { .. } => {
                !is_cam && mode == SyncMode::Position && Pair::of(engage).is_some_and(|pair| pair.is_sound())
            }
            Engage::OnEvent(_) => !mode.has_marks(),
        };
        can_wait
            && cam.is_none_or(|cam| cam.is_sound())
            && velocity.is_finite()
            && acceleration.is_finite()
            && self.recent.iter().all(|change| change.is_finite())
            && usize::from(self.count) <= RECENT
    }
}

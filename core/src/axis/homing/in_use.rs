//! Motions that refer to the coordinate of an axis, for which set_position has to wait.
//!
//! Law      motions without a position continue in a new coordinate: at a velocity, by setpoints, on a gear of
//!          velocities or of changes. Everything commanded with a position of the axis keeps its coordinate
//! Refuses  set_position, with the name of the first of these motions
//! Source   PLCopen part 1 (MC_SetPosition)

use crate::axis::state::{Axis, Generator};
use crate::code::Code;
use crate::command::Engage;
use crate::event::{Number, Refusal};
use crate::state::{AxisState, Reference};
use crate::sync::Transmission;
use crate::vocabulary::Owner;

/// Texts of a refusal, one for each [`Use`] of the coordinate of an axis.
pub(crate) const USES: [&str; 12] = {
    let mut texts = [""; 12];
    texts[Use::Target as usize] = "a goal to a target";
    texts[Use::Trajectory as usize] = "a trajectory";
    texts[Use::Waiting as usize] = "a goal that waits";
    texts[Use::Superimposed as usize] = "a superimposed motion or phase shift";
    texts[Use::Engaging as usize] = "a coupling that waits to engage";
    texts[Use::Leaving as usize] = "a gear_out that waits for a place of the axis";
    texts[Use::Cam as usize] = "a cam";
    texts[Use::Places as usize] = "a coupling at a pair of places";
    texts[Use::Marks as usize] = "a coupling by marks";
    texts[Use::Vocabulary as usize] = "the motion of a vocabulary";
    texts[Use::Function as usize] = "a function";
    texts[Use::Window as usize] = "a touch probe with a window";
    texts
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Use {
    Target,
    Trajectory,
    Waiting,
    Superimposed,
    Engaging,
    Leaving,
    Cam,
    Places,
    Marks,
    Vocabulary,
    Function,
    Window,
}

impl Axis {
    /// Returns an error if a motion refers to the present coordinate of the axis.
    pub(super) fn check_coordinate_free(&self) -> Result<(), Refusal> {
        let moves = self.is_on() && !self.is_idle_at_rest();
        let is_pair = |engage: Engage| matches!(engage, Engage::InPosition { .. });
        let waits_for_places = self.coupling.engagement().is_some_and(|waits| is_pair(waits.request.engage));
        let used = waits_for_places.then_some(Use::Engaging);
        let used = used.or(self.pending.touch_probes().have_window().then_some(Use::Window));
        let used = if moves { self.use_in_motion()?.or(used) } else { used };
        match used {
            None => Ok(()),
            Some(used) => Err(self.refuse(Code::COORDINATE_IN_USE).with(Number::Count(used as i64), Number::None)),
        }
    }

    /// Returns which part of the active or waiting motion refers to the coordinate.
    ///
    /// # Errors
    /// The axis stops, homes, or moves in another way that ends by itself.
    fn use_in_motion(&self) -> Result<Option<Use>, Refusal> {
        let goal = self.task.goal().as_ref().filter(|goal| goal.ending.is_none());
        let runs = matches!(self.status.state(), AxisState::ContinuousMotion | AxisState::SynchronizedMotion);
        Ok(Some(match self.motion.generator() {
            _ if goal.is_some_and(|goal| goal.track.is_some()) => Use::Trajectory,
            _ if self.homing.is_running() => return Err(self.not_at_standstill()),
            _ if !self.pending.buffer().is_empty() => Use::Waiting,
            _ if goal.is_some_and(|goal| goal.target.is_some()) => Use::Target,
            _ if self.status.owner() != Owner::Native => Use::Vocabulary,
            _ if !runs || self.is_open_loop() => return Err(self.not_at_standstill()),
            _ if self.status.reference() == Reference::Function => Use::Function,
            _ if self.coupling.overlay().is_some() => Use::Superimposed,
            _ if self.coupling.engagement().is_some() => Use::Engaging,
            _ if self.leaves_at_own_place() => Use::Leaving,
            Generator::Follow(coupling) if coupling.follower.mode().has_marks() => Use::Marks,
            Generator::Follow(coupling) if coupling.at_places => Use::Places,
            Generator::Follow(coupling) => match coupling.follower.transmission() {
                Transmission::Gear(_) => return Ok(None),
                Transmission::Approach(_) => Use::Places,
                Transmission::Cam(_) => Use::Cam,
            },
            Generator::Track(_) => Use::Trajectory,
            Generator::Rest | Generator::Plan(_) | Generator::OutAn { .. } => return Ok(None),
            Generator::Open { .. } | Generator::Coast { .. } => return Err(self.not_at_standstill()),
        }))
    }
}

//! All vocabularies of an axis behind one interface; other modules do not refer to a single one.
//!
//! Law      the owner steps each vocabulary in the order of [`Owner::VOCABULARIES`], after its first use: unused ones
//!          take no time, and their signals keep their initial values. A step or a request is tried on a copy, which
//!          replaces the state once the axis has accepted the order
//! Reads    a [`View`] of the axis, and notices of events of the axis
//! Writes   their signals
//! Refuses  errors of the vocabularies

use super::amc::{Amc, AmcSignal};
use super::saia::{Saia, SaiaSignal};
use super::wf::{Wf, WfSignal};
use super::{Outcome, Owner, Request, View, Vocabulary};
use crate::drive::Switching;
use crate::event::Refusal;
use crate::parameter::AxisParameters;
use crate::position::Position;
use crate::signal::{Board, Directory, Signal};
use serde::{Deserialize, Serialize};

/// Event of an axis that no vocabulary has caused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Notice {
    /// The axis itself has set another zero.
    ZeroSet,
    /// The zero is no longer valid.
    ZeroLost,
    /// All positions change by `by` (inc).
    Shifted {
        /// Change of the positions (inc).
        by: i64,
    },
    /// A new source continues at another position: the axis has moved by `by` (inc) in unchanged coordinates.
    Displaced {
        /// Distance (inc).
        by: i64,
    },
    /// The raw coordinate was set: the position has a new value.
    Jumped,
    /// The direction of counting of the axis was inverted at rest.
    Turned,
    /// The error of the axis was reset.
    Reset,
    /// Supervision raised that alarm; the drive is already off.
    Alarm(u8),
}

/// Vocabularies that have been used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct UsedVocabularies {
    amc: bool,
    saia: bool,
    wf: bool,
    /// Whether the signals have been written once.
    shown: bool,
}

/// Vocabularies whose signals are to be written.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shown {
    amc: bool,
    saia: bool,
    wf: bool,
}

/// The vocabularies of one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Vocabularies {
    amc: Amc,
    saia: Saia,
    wf: Wf,
    awake: UsedVocabularies,
}

impl Vocabularies {
    /// Returns true if any vocabulary has been used.
    pub(crate) fn any_used(&self) -> bool {
        self.awake.amc || self.awake.saia || self.awake.wf
    }

    /// Returns true if a step is due, because the vocabulary was used before or is used by these parameters.
    pub(crate) fn is_step_due(&mut self, owner: Owner, parameters: &AxisParameters) -> bool {
        match owner {
            Owner::Native => false,
            Owner::Amc => {
                self.awake.amc |= self.amc.wakes(&parameters.vocabularies.amc);
                self.awake.amc
            }
            Owner::Saia => self.awake.saia,
            Owner::Wf => {
                self.awake.wf |= self.wf.wakes(&parameters.vocabularies.wf);
                self.awake.wf
            }
        }
    }

    /// Returns a copy for a trial.
    pub(crate) fn copy(&self, owner: Owner) -> Option<Vocabulary> {
        match owner {
            Owner::Native => None,
            Owner::Amc => Some(Vocabulary::Amc(self.amc)),
            Owner::Saia => Some(Vocabulary::Saia(self.saia)),
            Owner::Wf => Some(Vocabulary::Wf(self.wf)),
        }
    }

    /// Replaces the state by a tried copy.
    pub(crate) fn keep(&mut self, tried: &Vocabulary) {
        match tried {
            Vocabulary::Amc(amc) => self.amc = *amc,
            Vocabulary::Saia(saia) => self.saia = *saia,
            Vocabulary::Wf(wf) => self.wf = *wf,
        }
    }

    /// Marks a vocabulary as used, whatever the result of the request.
    pub(crate) fn mark_used(&mut self, owner: Owner) {
        match owner {
            Owner::Native => {}
            Owner::Amc => self.awake.amc = true,
            Owner::Saia => self.awake.saia = true,
            Owner::Wf => self.awake.wf = true,
        }
    }

    /// Applies a request to a copy; the view contains the parameters that the request writes. `barred`: the reason why
    /// no motion may begin.
    ///
    /// # Errors
    /// An error of the vocabulary.
    pub(crate) fn try_request(
        &self,
        request: &Request,
        view: &View<'_>,
        barred: Option<Refusal>,
    ) -> Result<(Vocabulary, Outcome), Refusal> {
        match request {
            Request::Saia(request) => {
                let mut saia = self.saia;
                let outcome = saia.run(request, view, barred)?;
                Ok((Vocabulary::Saia(saia), outcome))
            }
            Request::Wf(asked) => {
                let mut wf = self.wf;
                match wf.run(asked, view) {
                    Ok(order) => Ok((Vocabulary::Wf(wf), Outcome::of(order))),
                    Err(refusal) => self.try_failed_request(request, view, refusal),
                }
            }
        }
    }

    /// Applies a request to a copy whose order was rejected.
    ///
    /// # Errors
    /// The same error, if the request as a whole fails.
    pub(crate) fn try_failed_request(
        &self,
        request: &Request,
        view: &View<'_>,
        refusal: Refusal,
    ) -> Result<(Vocabulary, Outcome), Refusal> {
        match request {
            Request::Saia(_) if view.parameters.vocabularies.saia.refuses() => Err(refusal),
            // The start fails; the other parts of the request take effect.
            Request::Saia(_) => self.try_request(request, view, Some(refusal)),
            // A request that cannot begin still stops a motion whose release it includes (WF-SET-02).
            Request::Wf(request) => {
                let mut wf = self.wf;
                let stop = wf.release(request, view).ok_or(refusal)?;
                Ok((Vocabulary::Wf(wf), Outcome { warning: Some(refusal), ..Outcome::of(Some(stop)) }))
            }
        }
    }

    /// Returns a copy of the vocabulary that parameters alone command.
    pub(crate) fn by_parameters(&self) -> (Owner, Vocabulary) {
        (Owner::Amc, Vocabulary::Amc(self.amc))
    }

    /// Returns true if a vocabulary needs the state at the end of the cycle.
    #[inline]
    pub(crate) fn needs_cycle_end(&self) -> bool {
        self.awake.amc
    }

    /// Deselects the reference because the axis is locked. Returns the parameter to write.
    pub(crate) fn deselect(&mut self) -> super::ParameterChange {
        Vocabulary::selection_change(self.amc.give_up())
    }

    /// Returns a copy of the owner if its homing runs.
    pub(crate) fn homing_owner(&self, owner: Owner) -> Option<Vocabulary> {
        (owner == Owner::Amc && self.amc.homes()).then_some(Vocabulary::Amc(self.amc))
    }

    /// Returns the deceleration cam, which requests set.
    pub(crate) fn cam(&self) -> bool {
        self.wf.cam()
    }

    /// Returns the commanded outputs of an axis without a position loop.
    pub(crate) fn switching(&self) -> Switching {
        self.wf.switching()
    }

    /// Executes one cycle of the integer PID that closes the loop of the axis, even if the vocabulary is unused.
    /// Returns the output, -1 to 1.
    pub(crate) fn close_loop(&mut self, parameters: &AxisParameters, cycle_ns: u64, error: i64) -> f64 {
        self.saia.close_loop(&parameters.vocabularies.saia, cycle_ns, error)
    }

    /// Resets output and state of the PID, because the axis is off.
    pub(crate) fn open_loop(&mut self) {
        self.saia.open_loop();
    }

    /// Continues the PID with its sum but without a change of the error, because it was not stepped while the axis was
    /// held.
    pub(crate) fn forget_loop_past(&mut self) {
        self.saia.skip_unsampled_time();
    }

    /// Passes a notice to all vocabularies that it concerns.
    pub(crate) fn notice(&mut self, notice: Notice) {
        match notice {
            Notice::ZeroSet => {
                self.awake.wf = true;
                self.wf.set_zero();
            }
            Notice::ZeroLost => self.wf.invalidate_zero(),
            Notice::Shifted { by } => {
                self.saia.shift_positions(by);
                self.amc.shift(Position::whole(by));
            }
            Notice::Displaced { by } => self.saia.shift_positions(by),
            Notice::Jumped => self.saia.handle_position_jump(),
            Notice::Turned => {
                self.amc.invert_direction();
                // As after power-on: their zeros and targets belonged to the other direction.
                (self.saia, self.wf) = (Saia::default(), Wf::default());
            }
            Notice::Reset => self.wf.take_reset(),
            Notice::Alarm(alarm) => {
                self.awake.wf = true;
                self.wf.note_alarm(alarm);
            }
        }
    }

    /// Returns true if restored states are valid.
    pub(crate) fn is_sound(&self) -> bool {
        self.amc.is_sound() && self.saia.is_sound() && self.wf.is_sound()
    }

    /// Returns the vocabularies whose signals are to be written in this cycle, if any.
    pub(crate) fn begin_publishing(&mut self) -> Option<Shown> {
        let all = !std::mem::replace(&mut self.awake.shown, true);
        let UsedVocabularies { amc, saia, wf, .. } = self.awake;
        (all || amc || saia || wf).then_some(Shown { amc: all || amc, saia: all || saia, wf: all || wf })
    }

    /// Writes signals, in the order of [`add_signals`]. `view` is that of the first vocabulary; `allow` are the
    /// commanded outputs that the axis allows.
    pub(crate) fn publish(
        &self,
        shown: Shown,
        owner: Owner,
        view: &View<'_>,
        allow: impl FnOnce(Switching) -> Switching,
        first: Signal,
        board: &mut Board,
    ) {
        if shown.amc {
            self.amc.publish(view, board.block(first, AmcSignal::COUNT));
        }
        let first = first.plus(AmcSignal::COUNT);
        if shown.saia {
            let view = View { owns: owner == Owner::Saia, ..*view };
            self.saia.publish(&view, board.block(first, SaiaSignal::COUNT));
        }
        let first = first.plus(SaiaSignal::COUNT);
        if shown.wf {
            let view = View { owns: owner == Owner::Wf, ..*view };
            self.wf.publish(&view, allow(self.wf.switching()), board.block(first, WfSignal::COUNT));
        }
    }
}

/// Adds the signals of all vocabularies to an axis, directly after its own.
pub(crate) fn add_signals(directory: &mut Directory, axis: &str) {
    AmcSignal::add_all(directory, axis);
    SaiaSignal::add_all(directory, axis);
    WfSignal::add_all(directory, axis);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Zeros, targets and alarms belonged to the other direction.
    #[test]
    fn inverted_axis_restarts_as_after_power_on() {
        let mut turned = Vocabularies::default();
        turned.notice(Notice::Alarm(7));
        turned.notice(Notice::ZeroSet);
        assert_ne!(turned.wf, Wf::default());
        turned.notice(Notice::Turned);
        assert_eq!((turned.saia, turned.wf), (Saia::default(), Wf::default()));
        assert!(turned.any_used(), "their signals are written on");
    }
}

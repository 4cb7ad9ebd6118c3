//! The vocabularies of an axis behind one door: nobody outside names one of them.
//!
//! Law      each is asked for its step by its owner, in the order of [`Owner::VOCABULARIES`], once anything has been asked of
//!          it: the others take no time, and their signals stand as they began. What a step or a request asks is tried on a
//!          copy, which is kept once the axis has judged it
//! Reads    a [`View`] of the axis, notices of what happens to it beside them
//! Writes   their signals
//! Refuses  what a vocabulary refuses

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

/// What happens to an axis without a vocabulary having asked for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Notice {
    /// The zero is another one, by a word of the axis itself.
    ZeroSet,
    /// What was known of the zero does not hold any more.
    ZeroLost,
    /// Every place is `by` (inc) more from now on.
    Shifted {
        /// (inc)
        by: i64,
    },
    /// A new source counts on from another position: the axis stands `by` (inc) further, its places are the same.
    Displaced {
        /// (inc)
        by: i64,
    },
    /// The raw coordinate was set anew: the position has another number.
    Jumped,
    /// The axis counts the other way from now on, and stands where it is.
    Turned,
    /// The error of the axis is cleared.
    Reset,
    /// Supervision has raised that alarm, and the drive is off already.
    Alarm(u8),
}

/// Which have been asked for anything.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Awake {
    amc: bool,
    saia: bool,
    wf: bool,
    /// The signals have been written once.
    shown: bool,
}

/// Whose signals are to be written.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shown {
    amc: bool,
    saia: bool,
    wf: bool,
}

/// The state machines of one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Vocabularies {
    amc: Amc,
    saia: Saia,
    wf: Wf,
    awake: Awake,
}

impl Vocabularies {
    /// Has any of them been asked for anything?
    pub(crate) fn are_awake(&self) -> bool {
        self.awake.amc || self.awake.saia || self.awake.wf
    }

    /// Is a step due, as something was asked of it before, or by these parameters now?
    pub(crate) fn wakes(&mut self, owner: Owner, parameters: &AxisParameters) -> bool {
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

    /// A copy, to be tried.
    pub(crate) fn copy(&self, owner: Owner) -> Option<Vocabulary> {
        match owner {
            Owner::Native => None,
            Owner::Amc => Some(Vocabulary::Amc(self.amc)),
            Owner::Saia => Some(Vocabulary::Saia(self.saia)),
            Owner::Wf => Some(Vocabulary::Wf(self.wf)),
        }
    }

    /// What was tried is so from now on.
    pub(crate) fn keep(&mut self, tried: &Vocabulary) {
        match tried {
            Vocabulary::Amc(amc) => self.amc = *amc,
            Vocabulary::Saia(saia) => self.saia = *saia,
            Vocabulary::Wf(wf) => self.wf = *wf,
        }
    }

    /// Something was asked of it, whatever comes of that.
    pub(crate) fn rouse(&mut self, owner: Owner) {
        match owner {
            Owner::Native => {}
            Owner::Amc => self.awake.amc = true,
            Owner::Saia => self.awake.saia = true,
            Owner::Wf => self.awake.wf = true,
        }
    }

    /// What a request does to a copy; the view has the parameters that it writes. `barred`: why nothing may begin.
    ///
    /// # Errors
    /// What the vocabulary refuses.
    pub(crate) fn ask(
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
                    Err(refusal) => self.ask_instead(request, view, refusal),
                }
            }
        }
    }

    /// What a request does to a copy where its order is not done.
    ///
    /// # Errors
    /// Nothing: it is refused for the same reason.
    pub(crate) fn ask_instead(
        &self,
        request: &Request,
        view: &View<'_>,
        refusal: Refusal,
    ) -> Result<(Vocabulary, Outcome), Refusal> {
        match request {
            Request::Saia(_) if view.parameters.vocabularies.saia.refuses() => Err(refusal),
            // The start fails, what stands beside it does not.
            Request::Saia(_) => self.ask(request, view, Some(refusal)),
            // What cannot begin keeps nothing running that was let go (WF-SET-02).
            Request::Wf(request) => {
                let mut wf = self.wf;
                let stop = wf.release(request, view).ok_or(refusal)?;
                Ok((Vocabulary::Wf(wf), Outcome { warning: Some(refusal), ..Outcome::of(Some(stop)) }))
            }
        }
    }

    /// The one that parameters alone command.
    pub(crate) fn by_parameters(&self) -> (Owner, Vocabulary) {
        (Owner::Amc, Vocabulary::Amc(self.amc))
    }

    /// Does any watch how the cycle ends?
    #[inline]
    pub(crate) fn watches_end(&self) -> bool {
        self.awake.amc
    }

    /// The axis is locked: what was selected is so no more. What is written by that.
    pub(crate) fn give_up(&mut self) -> super::Writes {
        Vocabulary::written(self.amc.give_up())
    }

    /// A copy of the owner, where homing is under way for its sake.
    pub(crate) fn homes(&self, owner: Owner) -> Option<Vocabulary> {
        (owner == Owner::Amc && self.amc.homes()).then_some(Vocabulary::Amc(self.amc))
    }

    /// The deceleration cam that requests tell of.
    pub(crate) fn cam(&self) -> bool {
        self.wf.cam()
    }

    /// What they ask of the outputs of an axis without a position loop.
    pub(crate) fn switching(&self) -> Switching {
        self.wf.switching()
    }

    /// One cycle of the integer PID that closes the loop of the axis, awake or not: its output, -1 to 1.
    pub(crate) fn close_loop(&mut self, parameters: &AxisParameters, cycle_ns: u64, error: i64) -> f64 {
        self.saia.close_loop(&parameters.vocabularies.saia, cycle_ns, error)
    }

    /// The axis is off: that PID has no output and no past.
    pub(crate) fn open_loop(&mut self) {
        self.saia.open_loop();
    }

    /// That PID was not stepped while the axis was held: it goes on with its sum, and no change of the error.
    pub(crate) fn forget_loop_past(&mut self) {
        self.saia.forget_loop_past();
    }

    /// Tells all whom it concerns.
    pub(crate) fn notice(&mut self, notice: Notice) {
        match notice {
            Notice::ZeroSet => {
                self.awake.wf = true;
                self.wf.take_zero();
            }
            Notice::ZeroLost => self.wf.lose_zero(),
            Notice::Shifted { by } => {
                self.saia.take_shift(by);
                self.amc.shift(Position::whole(by));
            }
            Notice::Displaced { by } => self.saia.take_shift(by),
            Notice::Jumped => self.saia.note_jump(),
            Notice::Turned => {
                self.amc.turn_over();
                // As after the power came on: their zeros and targets were those of the other sense.
                (self.saia, self.wf) = (Saia::default(), Wf::default());
            }
            Notice::Reset => self.wf.take_reset(),
            Notice::Alarm(alarm) => {
                self.awake.wf = true;
                self.wf.note_alarm(alarm);
            }
        }
    }

    /// Could their state have come about? One that was read from outside may hold anything.
    pub(crate) fn is_sound(&self) -> bool {
        self.amc.is_sound() && self.saia.is_sound() && self.wf.is_sound()
    }

    /// Whose signals are to be written in this cycle, if any.
    pub(crate) fn begin_publishing(&mut self) -> Option<Shown> {
        let all = !std::mem::replace(&mut self.awake.shown, true);
        let Awake { amc, saia, wf, .. } = self.awake;
        (all || amc || saia || wf).then_some(Shown { amc: all || amc, saia: all || saia, wf: all || wf })
    }

    /// Writes signals, in the order of [`add_signals`]. `view` is that of the first vocabulary; `allow`: what the axis lets
    /// through of what is asked of its outputs.
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

/// Adds the signals of all vocabularies on an axis, right behind its own.
pub(crate) fn add_signals(directory: &mut Directory, axis: &str) {
    AmcSignal::add_all(directory, axis);
    SaiaSignal::add_all(directory, axis);
    WfSignal::add_all(directory, axis);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Zeros, targets and alarms of before were those of the other sense.
    #[test]
    fn a_turned_axis_begins_as_after_its_power_came_on() {
        let mut turned = Vocabularies::default();
        turned.notice(Notice::Alarm(7));
        turned.notice(Notice::ZeroSet);
        assert_ne!(turned.wf, Wf::default());
        turned.notice(Notice::Turned);
        assert_eq!((turned.saia, turned.wf), (Saia::default(), Wf::default()));
        assert!(turned.are_awake(), "their signals are written on");
    }
}

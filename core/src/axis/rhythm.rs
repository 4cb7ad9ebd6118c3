//! How much of a cycle an axis needs.
//!
//! Law      Passed: the axis stands, and nothing waits for its time; a cycle changes nothing but what counts cycles.
//!          Calm: the axis moves, and nothing else goes on; a cycle moves and judges it, and leaves out the parts that sleep.
//!          Full: everything else.
//!          An axis is either of the first two once the end of two cycles in a row has found it so, and as long as nobody asks for
//!          anything, nothing beside its cycle acts on it, its inputs stay as they were (of a calm one but for count, velocity and
//!          effort), and nothing is told: what the last part of a cycle leaves to the first one of the next is done by then
//! Reads    the whole state after a full cycle; the inputs of its drive, bit by bit
//! Writes   nothing but the counts of cycles
//! Refuses  whoever may depend on what it does not look at: a loop closed here that goes on at rest, vocabularies in use,
//!          trajectories, homing, superimposed motions, goals
//!          that wait or search, errors, switches, sources with other users. That costs time and changes nothing

use super::power::Power;
use super::{Axis, AxisState, Generator, Reference};
use crate::drive::DriveInput;
use crate::encoder::Lead;
use crate::position::Position;
use crate::profile::Motion;

/// How much of the present cycle is done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pace {
    /// All of it.
    #[default]
    Full,
    /// What a motion needs.
    Calm,
    /// Nothing.
    Passed,
}

/// What the last cycles were like. No part of the state: a machine that was restored takes its first cycles in full.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rhythm {
    /// Of the present cycle.
    pace: Pace,
    /// Of the next one, if nothing comes between.
    next: Pace,
    /// As the end of the last full cycle found the axis.
    found: Pace,
    /// The present cycle begins as the last one has ended.
    goes_on: bool,
    /// It may switch outputs of the machine in a cycle that is not full.
    switches: bool,
    /// The loops that are closed here have their outputs of this cycle.
    has_stepped: bool,
    /// What is taken up in this cycle is known.
    has_compensated: bool,
    /// What its drive told then; a virtual axis has none.
    told: DriveInput,
}

impl Axis {
    /// How much of this cycle does it need? `is_quiet`: nothing that concerns all axes has changed, and nobody asks for anything.
    #[inline]
    pub fn begin_cycle(&mut self, is_quiet: bool, input: Option<&DriveInput>) -> Pace {
        let rhythm = &mut self.rhythm;
        (rhythm.has_stepped, rhythm.has_compensated) = (false, false);
        let told = &rhythm.told;
        rhythm.goes_on = is_quiet
            && match rhythm.found {
                Pace::Full => false,
                Pace::Calm => input.is_none_or(|input| is_alike(input, told)),
                Pace::Passed => input.is_none_or(|input| is_alike(input, told) && is_same_motion(input, told)),
            };
        rhythm.pace = if rhythm.goes_on { rhythm.next } else { Pace::Full };
        rhythm.pace
    }

    /// How much of this cycle is done.
    #[inline]
    pub fn pace(&self) -> Pace {
        self.rhythm.pace
    }

    /// May it switch outputs of the machine in this cycle?
    #[inline]
    pub fn switches_outputs(&self) -> bool {
        self.rhythm.pace == Pace::Full || self.rhythm.switches
    }

    /// Have the loops that are closed here been stepped in this cycle? From now on they have.
    pub(super) fn note_stepped(&mut self) -> bool {
        std::mem::replace(&mut self.rhythm.has_stepped, true)
    }

    /// Is it known what is taken up in this cycle? From now on it is.
    pub(super) fn note_compensated(&mut self) -> bool {
        std::mem::replace(&mut self.rhythm.has_compensated, true)
    }

    /// Something beside its own cycle acts on it, or it tells something.
    pub fn disturb(&mut self) {
        let Rhythm { told, has_stepped, has_compensated, .. } = self.rhythm;
        self.rhythm = Rhythm { told, has_stepped, has_compensated, ..Rhythm::default() };
    }

    /// The cycle of an axis that stands still.
    #[inline]
    pub fn pass_over(&mut self) {
        self.judge.pass();
        self.streamed.pass();
    }

    /// Notes after a full cycle what the next one may be; `shown` is what others see of its command.
    pub fn note_rhythm(&mut self, input: Option<&DriveInput>, shown: &Lead, axes: usize) {
        let found = match self.generator {
            // What moves is told first: that costs it next to nothing.
            Generator::Rest
                if self.compensation.is_settled()
                    && !self.regulates()
                    && self.is_well()
                    && self.rests_for_good(shown)
                    && !self.shows_a_master(axes) =>
            {
                Pace::Passed
            }
            Generator::Plan(_) | Generator::Follow(_) if self.moves_alone() => Pace::Calm,
            _ => Pace::Full,
        };
        let fails = |input| self.failure(input).is_some();
        let found = if found == Pace::Full || input.is_some_and(fails) || !self.sleeps() { Pace::Full } else { found };
        let switches = self.has_own_brake() || self.parameters.outputs.brake != 0 || self.wiring().is_some();
        let rhythm = &mut self.rhythm;
        rhythm.switches = switches;
        rhythm.next = if rhythm.goes_on && rhythm.found == found { found } else { Pace::Full };
        rhythm.found = found;
        // A calm axis may begin with any count.
        rhythm.goes_on = false;
        if let Some(input) = input.filter(|_| found != Pace::Full) {
            rhythm.told = *input;
        }
    }

    /// Does the axis stand, and has everything that goes on by itself come to its end?
    fn rests_for_good(&self, shown: &Lead) -> bool {
        let holds = match self.state {
            AxisState::Standstill => self.power == Power::On && self.judge.in_position,
            AxisState::Disabled => self.power == Power::Off,
            _ => false,
        };
        let at_rest = Motion::at_rest(self.command.position);
        holds
            && self.command == at_rest
            && (shown.position, shown.change, shown.velocity) == (at_rest.position, Position::ZERO, 0.0)
            && self.actual.change == Position::ZERO
            && self.judge.is_settled(self.asked(), self.parameters.max_following_error)
            && (self.is_virtual() || self.counter.is_settled())
            && self.goal.is_none()
            && self.at_limits.is_within()
            && !self.is_led
    }

    /// Is there nothing but a motion that nobody streams, and no goal that needs more than to be reached?
    fn moves_alone(&self) -> bool {
        use AxisState::{ContinuousMotion, DiscreteMotion, SynchronizedMotion};
        matches!(self.state, DiscreteMotion | ContinuousMotion | SynchronizedMotion)
            && self.power == Power::On
            && self.compensation.is_idle()
            && self.reference != Reference::Stream
            && !self.has_track()
            && !self.probes()
            && !self.judge.has_left_something()
            && self.judge.has_left_rest()
            // Outputs that tell the sign of a velocity follow it.
            && !self.tells_sign()
    }

    /// Do the parts sleep that a cycle which is not full leaves out?
    fn sleeps(&self) -> bool {
        let p = &self.parameters;
        let has_source = self.is_virtual() || self.actual.valid && self.shown.is_fresh() && self.counter.is_good();
        has_source
            && !p.needs_full_cycles()
            && !self.is_simulated()
            && !self.is_open_loop()
            && self.alarm.is_none()
            && self.open_contact.is_none()
            && self.switches == Default::default()
            && self.switches_before == Default::default()
            && self.overlay.is_none()
            && self.phasing.is_none()
            && !self.is_conditioned()
            && self.engagement.is_none()
            && self.leaving.is_none()
            && self.touch_probes.are_settled()
            && self.buffer.is_empty()
            && self.waiting.is_empty()
            && self.left.is_none()
            && self.at_limits.is_free()
            && self.moved == Position::ZERO
            && !self.stops_others
            && !self.vocabularies.are_awake()
            && self.override_seen == p.velocity_override
            && self.sensor.is_settled()
            && self.homing.is_settled()
            && self.holding.is_settled(self.is_on())
            && self.streamed.is_settled()
    }
}

/// Is it the same but for what a motion changes? An index pulse is never the same.
fn is_alike(one: &DriveInput, other: &DriveInput) -> bool {
    let DriveInput { epoch, status, mode, fault, online, fresh, inputs, index, bus, emergency, unacknowledged, .. } =
        *one;
    (epoch, inputs, status, fault) == (other.epoch, other.inputs, other.status, other.fault)
        && (mode, online, fresh, bus) == (other.mode, other.online, other.fresh, other.bus)
        && unacknowledged == other.unacknowledged
        && emergency.is_none()
        && other.emergency.is_none()
        && index.is_none()
        && other.index.is_none()
}

/// Is the rest the same, bit by bit?
fn is_same_motion(one: &DriveInput, other: &DriveInput) -> bool {
    one.count == other.count
        && one.velocity.to_bits() == other.velocity.to_bits()
        && one.effort.to_bits() == other.effort.to_bits()
}

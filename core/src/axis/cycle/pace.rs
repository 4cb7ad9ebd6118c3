//! Decides how much of a cycle an axis executes.
//!
//! Law      Passed: the axis is at rest, and no timer runs; a cycle changes nothing but the counts of cycles.
//!          Calm: the axis only moves; a cycle moves and supervises it, and omits the inactive parts.
//!          Full: everything else.
//!          The first two begin after two successive full cycles that found the axis in this state. They last while
//!          there is no command, no effect from outside its cycle, no event, and no change of its inputs (for Calm
//!          except count, velocity and effort). After two cycles everything that the end of a cycle leaves to the start
//!          of the next one is done
//! Reads    the whole state after a full cycle; the inputs of its drive, bit by bit
//! Writes   only the counts of cycles
//! Refuses  every function that may need the omitted parts: a loop closed here that is active at rest, vocabularies in
//!          use, trajectories, homing, superimposed motions, goals that wait or search, errors, switches, sources with
//!          other users. Their cycles are full, which costs time and changes nothing

use crate::axis::state::{Axis, CyclePace, Generator, Pace, Power};
use crate::drive::DriveInput;
use crate::encoder::Lead;
use crate::position::Position;
use crate::profile::Motion;
use crate::state::{AxisState, Reference};

impl Axis {
    /// Returns how much of this cycle is needed. `is_quiet`: no command, and no change that concerns all axes.
    #[inline]
    pub fn begin_cycle(&mut self, is_quiet: bool, input: Option<&DriveInput>) -> Pace {
        let rhythm = self.cycle.pace_mut();
        (rhythm.has_stepped, rhythm.has_compensated) = (false, false);
        let told = &rhythm.told;
        rhythm.goes_on = is_quiet
            && match rhythm.found {
                Pace::Full => false,
                Pace::Reduced => input.is_none_or(|input| equals_except_motion(input, told)),
                Pace::Skipped => {
                    input.is_none_or(|input| equals_except_motion(input, told) && is_same_motion(input, told))
                }
            };
        rhythm.pace = if rhythm.goes_on { rhythm.next } else { Pace::Full };
        rhythm.pace
    }

    /// Returns how much of this cycle is executed.
    #[inline]
    pub fn pace(&self) -> Pace {
        self.cycle.pace().pace
    }

    /// Whether it may switch outputs of the machine in this cycle.
    #[inline]
    pub fn switches_outputs(&self) -> bool {
        self.cycle.pace().pace == Pace::Full || self.cycle.pace().switches
    }

    /// Returns true if the loops that are closed here have been advanced in this cycle, and notes that they are now.
    pub(in crate::axis) fn note_stepped(&mut self) -> bool {
        std::mem::replace(&mut self.cycle.pace_mut().has_stepped, true)
    }

    /// Returns true if the compensation of this cycle has been calculated, and notes that it is now.
    pub(in crate::axis) fn note_compensated(&mut self) -> bool {
        std::mem::replace(&mut self.cycle.pace_mut().has_compensated, true)
    }

    /// Notes an effect from outside its cycle, or an event: the next cycles are full.
    pub fn require_full_cycle(&mut self) {
        let CyclePace { told, has_stepped, has_compensated, .. } = *self.cycle.pace();
        *self.cycle.pace_mut() = CyclePace { told, has_stepped, has_compensated, ..CyclePace::default() };
    }

    /// Executes the cycle of an axis at rest.
    #[inline]
    pub fn skip_cycle(&mut self) {
        self.supervision.pass();
        self.command.streamed_mut().pass();
    }

    /// Decides after a full cycle how much the next one needs; `shown` is its command as other axes see it.
    pub fn decide_pace(&mut self, input: Option<&DriveInput>, shown: &Lead, axes: usize) {
        let found = match *self.motion.generator() {
            // The inputs of a moving axis are compared first, which costs little.
            Generator::Rest
                if self.loops.compensation().is_settled()
                    && !self.regulates()
                    && self.is_inactive()
                    && self.rests_permanently(shown)
                    && !self.shows_a_master(axes) =>
            {
                Pace::Skipped
            }
            Generator::Plan(_) | Generator::Follow(_) if self.moves_alone() => Pace::Reduced,
            _ => Pace::Full,
        };
        let fails = |input| self.failure(input).is_some();
        let found =
            if found == Pace::Full || input.is_some_and(fails) || !self.is_reducible() { Pace::Full } else { found };
        let switches = self.has_own_brake() || self.parameters.outputs.brake != 0 || self.speed_outputs().is_some();
        let rhythm = self.cycle.pace_mut();
        rhythm.switches = switches;
        rhythm.next = if rhythm.goes_on && rhythm.found == found { found } else { Pace::Full };
        rhythm.found = found;
        // A reduced cycle with motion may begin with any count.
        rhythm.goes_on = false;
        if let Some(input) = input.filter(|_| found != Pace::Full) {
            rhythm.told = *input;
        }
    }

    /// Whether the axis is at rest, and nothing changes by itself any more.
    fn rests_permanently(&self, shown: &Lead) -> bool {
        let holds = match self.status.state() {
            AxisState::Standstill => self.status.power() == Power::On && self.supervision.is_in_position(),
            AxisState::Disabled => self.status.power() == Power::Off,
            _ => false,
        };
        let at_rest = Motion::at_rest(self.command.position());
        holds
            && self.command.motion() == at_rest
            && (shown.position, shown.change, shown.velocity) == (at_rest.position, Position::ZERO, 0.0)
            && self.feedback.change() == Position::ZERO
            && self.supervision.is_settled(self.commanded_increment(), self.parameters.max_following_error)
            && (self.is_virtual() || self.feedback.counter().is_settled())
            && self.task.goal().is_none()
            && self.travel.at_limits().is_within()
            && !self.status.is_led()
    }

    /// Whether there is only a motion: no stream, and no goal that needs more than to be reached.
    fn moves_alone(&self) -> bool {
        use AxisState::{ContinuousMotion, DiscreteMotion, SynchronizedMotion};
        matches!(self.status.state(), DiscreteMotion | ContinuousMotion | SynchronizedMotion)
            && self.status.power() == Power::On
            && self.loops.compensation().is_idle()
            && self.status.reference() != Reference::Stream
            && !self.has_track()
            && !self.probes()
            && !self.supervision.has_pending_reaction()
            && self.supervision.has_left_rest()
            // Outputs for the sign of a velocity follow it.
            && !self.outputs_sign()
    }

    /// Whether the parts that a reduced cycle omits are inactive.
    fn is_reducible(&self) -> bool {
        let p = &self.parameters;
        let has_source = self.is_virtual()
            || self.feedback.is_valid() && self.drive_data.shown().is_fresh() && self.feedback.counter().is_good();
        has_source
            && !p.needs_full_cycles()
            && !self.is_simulated()
            && !self.is_open_loop()
            && self.alarm.is_none()
            && self.alarm.open_contact().is_none()
            && self.observed.switches() == Default::default()
            && self.observed.switches_before() == Default::default()
            && self.coupling.overlay().is_none()
            && self.coupling.phasing().is_none()
            && !self.is_conditioned()
            && self.coupling.engagement().is_none()
            && self.coupling.leaving().is_none()
            && self.pending.touch_probes().are_settled()
            && self.pending.buffer().is_empty()
            && self.pending.waiting().is_empty()
            && self.task.left().is_none()
            && self.travel.at_limits().is_free()
            && self.observed.moved() == Position::ZERO
            && !self.alarm.stops_others()
            && !self.vocabularies.any_used()
            && self.observed.override_seen() == p.velocity_override
            && self.sources.sensor().is_settled()
            && self.homing.is_settled()
            && self.brake.is_settled(self.is_on())
            && self.command.streamed().is_settled()
    }
}

/// Whether two inputs are equal except for the values of motion. Inputs with an index pulse are never equal.
fn equals_except_motion(one: &DriveInput, other: &DriveInput) -> bool {
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

/// Whether the values of motion are equal, bit by bit.
fn is_same_motion(one: &DriveInput, other: &DriveInput) -> bool {
    one.count == other.count
        && one.velocity.to_bits() == other.velocity.to_bits()
        && one.effort.to_bits() == other.effort.to_bits()
}

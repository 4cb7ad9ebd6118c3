//! The virtual master of a machine: a leader whose velocity is made here.
//!
//! Law      v(k) = v(k-1) moved towards what is asked for by at most pulsacc T; position(k) = position(k-1) + v(k) T. What is asked for is pulsvel, or
//!          the change of an axis' command; with pulsacc -1 v(k) is setsys_15 at once. Off, it stands. Nothing is rounded but the position,
//!          down to 2^-32 inc, and what that leaves is kept: changes add up. An axis that no ramp holds back is followed exactly.
//!          The index counts each pulse that is come to, from either side, or what an input tells
//! Reads    the parameters of the machine, the command of the axis once it has moved
//! Refuses  nothing: a velocity beyond all that there are saturates
//! Source   MACS-VM-01..08, A-46

use crate::encoder::Lead;
use crate::parameter::{MachineParameters, Marker};
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Parts of 2^-32 inc in which a change is kept: velocities and accelerations are whole ones, whatever the cycle.
const PARTS: i128 = 1_000_000_000_000_000_000;
/// ns in a second.
const SECOND: i128 = 1_000_000_000;

/// Whose velocity the virtual master has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum VirtualSource {
    /// It is off, and stands.
    #[default]
    Off,
    /// Its own: pulsvel.
    Own,
    /// That of an axis' command.
    Axis(u16),
    /// setsys_15, without a ramp.
    Direct,
}

/// What moves the virtual master, and what it has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct VirtualMaster {
    source: VirtualSource,
    /// Change in a cycle (2^-32 inc / [`PARTS`]).
    rate: i128,
    /// What the position leaves out (2^-32 inc / [`PARTS`]).
    rest: i64,
    /// VMENCMTYP of the last cycle and the level of its input, where it was one that does not latch.
    level: Option<(i64, bool)>,
    /// Marks that its index has counted.
    pub count: i64,
    /// Where the last one was.
    pub mark: Position,
}

impl VirtualMaster {
    /// Before cycle 0.
    pub fn new(parameters: &MachineParameters) -> Self {
        Self { source: VirtualSource::Off.after(parameters, false), ..Self::default() }
    }

    /// Whose velocity it has.
    #[inline]
    pub fn source(&self) -> VirtualSource {
        self.source
    }

    /// The axis that it follows.
    #[inline]
    pub fn axis(&self) -> Option<u16> {
        match self.source {
            VirtualSource::Axis(axis) => Some(axis),
            _ => None,
        }
    }

    /// May a cycle have left it so, with these parameters and so many axes?
    pub fn is_sound(&self, parameters: &MachineParameters, axes: usize) -> bool {
        self.source.after(parameters, false) == self.source
            && self.axis().is_none_or(|axis| usize::from(axis) < axes)
            && (self.source != VirtualSource::Off || self.rate == 0)
            && (0..PARTS).contains(&self.rest.into())
    }

    /// Goes on with the velocity that it has; off, it stands in that moment.
    pub fn take(&mut self, source: VirtualSource, lead: &mut Lead) {
        self.source = source;
        if source == VirtualSource::Off {
            (self.rate, self.level) = (0, None);
            *lead = Lead { position: lead.position, valid: true, ..Lead::default() };
        }
    }

    /// One cycle of that many ns; `axis` is the change of the axis that it follows.
    pub fn step(&mut self, parameters: &MachineParameters, axis: Position, cycle_ns: u64, lead: &mut Lead) {
        let cycle = i128::from(cycle_ns);
        // Of one inc/s: each factor is a count of something, and the product stays below 2^117, as no velocity is beyond 2^30 inc/s.
        let one = (SECOND * cycle) << 32;
        let asked = match self.source {
            VirtualSource::Off => 0,
            VirtualSource::Own => one.saturating_mul(parameters.pulsvel.into()),
            VirtualSource::Axis(_) => axis.raw().saturating_mul(PARTS),
            VirtualSource::Direct => one.saturating_mul(parameters.setsys_15.into()),
        };
        let most = match self.source {
            VirtualSource::Direct => i128::MAX,
            _ => (cycle.saturating_mul(cycle) << 32).saturating_mul(parameters.pulsacc.max(0).into()),
        };
        self.rate = self.rate.saturating_add(asked.saturating_sub(self.rate).clamp(most.saturating_neg(), most));
        let all = self.rate.saturating_add(self.rest.into());
        self.rest = all.rem_euclid(PARTS) as i64;
        let change = Position::from_raw(all.div_euclid(PARTS));
        let velocity = self.rate as f64 / one as f64;
        *lead = Lead { position: lead.position + change, change, velocity, uneven: 0.0, valid: true };
    }

    /// Counts the index pulses of this cycle.
    pub fn count_pulses(&mut self, distance: i64, lead: &Lead) {
        self.level = None;
        let (before, after) = ((lead.position - lead.change).raw(), lead.position.raw());
        let whole = i128::from(distance) << 32;
        if whole <= 0 || before == after {
            return;
        }
        // The last pulse at or behind each place, as seen in the direction of the motion.
        let (from, to) = if after > before {
            (before.div_euclid(whole), after.div_euclid(whole))
        } else {
            (ceiling(before, whole), ceiling(after, whole))
        };
        if from != to {
            let place = Position::from_raw(to.saturating_mul(whole));
            self.note_marks(saturated((to - from).saturating_abs()), place);
        }
    }

    /// Counts an edge of the input of its marker, where that has this level at t_k: at the place of this cycle.
    pub fn count_level(&mut self, parameters: &MachineParameters, level: bool, lead: &Lead) {
        let Marker::Input { rising, .. } = parameters.virtual_marker() else { return };
        let before = self.level.replace((parameters.vmencmtyp, level));
        if level == rising && before == Some((parameters.vmencmtyp, !level)) {
            self.note_marks(1, lead.position);
        }
    }

    /// Counts what the input of its marker has latched, so long before t_k each; the newest is the last one, wherever it stands.
    pub fn count_latches(&mut self, ages_ns: impl Iterator<Item = u32>, cycle_ns: u64, lead: &Lead) {
        self.level = None;
        let (count, newest) = ages_ns.fold((0, u32::MAX), |(count, newest), age| (count + 1, newest.min(age)));
        if count > 0 {
            let age = i128::from(newest).min(cycle_ns.into());
            let back = lead.change.raw().saturating_mul(age).div_euclid(i128::from(cycle_ns.max(1)));
            self.note_marks(count, lead.position - Position::from_raw(back));
        }
    }

    fn note_marks(&mut self, count: i64, place: Position) {
        self.count = self.count.saturating_add(count);
        self.mark = place;
    }
}

impl VirtualSource {
    /// Whose velocity it has once these parameters are in force; `starts`: pulsvel is one of those that were set.
    #[must_use]
    pub fn after(self, parameters: &MachineParameters, starts: bool) -> Self {
        match (parameters.pulsacc, self) {
            (0, _) => Self::Off,
            (..0, _) => Self::Direct,
            _ if starts => parameters.virtual_source().map_or(Self::Own, Self::Axis),
            // The velocity that it had is obsolete, and nothing has started another one.
            (_, Self::Direct) => Self::Off,
            (_, other) => other,
        }
    }

    /// Whose velocity it has once a layer is in force: where it followed an axis its own, which is 0 then.
    #[must_use]
    pub fn after_reset(self, parameters: &MachineParameters) -> Self {
        match self.after(parameters, false) {
            Self::Axis(_) => Self::Own,
            other => other,
        }
    }
}

fn ceiling(value: i128, step: i128) -> i128 {
    value.div_euclid(step) + i128::from(value.rem_euclid(step) != 0)
}

fn saturated(value: i128) -> i64 {
    i64::try_from(value).unwrap_or(if value < 0 { i64::MIN } else { i64::MAX })
}

#[cfg(test)]
mod tests;

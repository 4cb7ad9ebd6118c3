//! The virtual master of a machine: a leader with a generated velocity.
//!
//! Law      v(k) = v(k-1) moved towards the setpoint by at most pulsacc T; position(k) = position(k-1) + v(k) T. The
//!          setpoint is pulsvel, or the change of the command of an axis; with pulsacc -1 v(k) is setsys_15 at once.
//!          Off, it is at rest. Only the position is rounded, down to 2^-32 inc, and the remainder is kept. An axis
//!          within the ramp is followed exactly.
//!          The index counts each pulse reached from either side, or the edges of an input
//! Reads    the parameters of the machine, the command of the axis after its motion
//! Refuses  nothing: velocities out of range saturate
//! Source   MACS-VM-01..08, A-46

use crate::encoder::Lead;
use crate::parameter::{MachineParameters, Marker};
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Fractions of 2^-32 inc in which a change is stored, so that velocities and accelerations are whole numbers with any
/// cycle time.
const PARTS: i128 = 1_000_000_000_000_000_000;
/// Nanoseconds in a second.
const SECOND: i128 = 1_000_000_000;

/// Source of the velocity of the virtual master.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum VirtualSource {
    /// It is off, and at rest.
    #[default]
    Off,
    /// Its own velocity: pulsvel.
    Own,
    /// Velocity of the command of an axis.
    Axis(u16),
    /// Velocity setsys_15, without ramp.
    Direct,
}

/// State of the virtual master.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct VirtualMaster {
    source: VirtualSource,
    /// Change in a cycle (2^-32 inc / [`PARTS`]).
    rate: i128,
    /// Remainder of the position (2^-32 inc / [`PARTS`]).
    rest: i64,
    /// VMENCMTYP of the last cycle and the level of its input, if that does not latch.
    level: Option<(i64, bool)>,
    /// Number of marks of its index.
    pub count: i64,
    /// Position of the last mark.
    pub mark: Position,
}

impl VirtualMaster {
    /// Returns the state before cycle 0.
    pub fn new(parameters: &MachineParameters) -> Self {
        Self { source: VirtualSource::Off.after(parameters, false), ..Self::default() }
    }

    /// Returns the source of its velocity.
    #[inline]
    pub fn source(&self) -> VirtualSource {
        self.source
    }

    /// Returns the axis that it follows.
    #[inline]
    pub fn axis(&self) -> Option<u16> {
        match self.source {
            VirtualSource::Axis(axis) => Some(axis),
            _ => None,
        }
    }

    /// Whether a cycle may have left this state with these parameters and this number of axes.
    pub fn is_sound(&self, parameters: &MachineParameters, axes: usize) -> bool {
        self.source.after(parameters, false) == self.source
            && self.axis().is_none_or(|axis| usize::from(axis) < axes)
            && (self.source != VirtualSource::Off || self.rate == 0)
            && (0..PARTS).contains(&self.rest.into())
    }

    /// Sets the source and keeps the velocity; off, it stops at once.
    pub fn take(&mut self, source: VirtualSource, lead: &mut Lead) {
        self.source = source;
        if source == VirtualSource::Off {
            (self.rate, self.level) = (0, None);
            *lead = Lead { position: lead.position, valid: true, ..Lead::default() };
        }
    }

    /// Advances by one cycle of `cycle_ns`; `axis` is the change of the axis that it follows.
    pub fn step(&mut self, parameters: &MachineParameters, axis: Position, cycle_ns: u64, lead: &mut Lead) {
        let cycle = i128::from(cycle_ns);
        // Units of 1 inc/s. The product stays below 2^117, as no velocity exceeds 2^30 inc/s.
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
        // The last pulse at or before each position, in the direction of motion.
        let (from, to) = if after > before {
            (before.div_euclid(whole), after.div_euclid(whole))
        } else {
            (rounded_up(before, whole), rounded_up(after, whole))
        };
        if from != to {
            let place = Position::from_raw(to.saturating_mul(whole));
            self.note_marks(saturated((to - from).saturating_abs()), place);
        }
    }

    /// Counts an edge of the input of its marker, given its level at t_k, at the position of this cycle.
    pub fn count_level(&mut self, parameters: &MachineParameters, level: bool, lead: &Lead) {
        let Marker::Input { rising, .. } = parameters.virtual_marker() else { return };
        let before = self.level.replace((parameters.vmencmtyp, level));
        if level == rising && before == Some((parameters.vmencmtyp, !level)) {
            self.note_marks(1, lead.position);
        }
    }

    /// Counts the latches of the input of its marker, each with its age at t_k. The newest one is the last mark,
    /// whatever their order.
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
    /// Returns the source of the velocity with these parameters; `starts`: pulsvel was set, too.
    #[must_use]
    pub fn after(self, parameters: &MachineParameters, starts: bool) -> Self {
        match (parameters.pulsacc, self) {
            (0, _) => Self::Off,
            (..0, _) => Self::Direct,
            _ if starts => parameters.virtual_source().map_or(Self::Own, Self::Axis),
            // The velocity of the mode without ramp no longer applies, and no other one was started.
            (_, Self::Direct) => Self::Off,
            (_, other) => other,
        }
    }

    /// Returns the source of the velocity after a layer was loaded. If it followed an axis, its own velocity replaces
    /// that, which is then 0.
    #[must_use]
    pub fn after_reset(self, parameters: &MachineParameters) -> Self {
        match self.after(parameters, false) {
            Self::Axis(_) => Self::Own,
            other => other,
        }
    }
}

fn rounded_up(value: i128, step: i128) -> i128 {
    value.div_euclid(step) + i128::from(value.rem_euclid(step) != 0)
}

fn saturated(value: i128) -> i64 {
    i64::try_from(value).unwrap_or(if value < 0 { i64::MIN } else { i64::MAX })
}

#[cfg(test)]
mod tests;

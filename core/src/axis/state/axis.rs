//! An axis: the parts of its state, and what every behaviour reads from it.

use super::active_motion::ActiveMotion;
use super::alarm::ErrorSnapshot;
use super::alarm_state::AlarmState;
use super::brake_state::BrakeState;
use super::command_state::CommandState;
use super::context::Context;
use super::coupling_state::CouplingState;
use super::cycle_state::CycleState;
use super::drive_data::DriveData;
use super::in_force::{Derived, InForce};
use super::loops::Loops;
use super::observed::Observed;
use super::pending::Pending;
use super::position_feedback::PositionFeedback;
use super::sensor::Sensor;
use super::setup::{AxisSetup, MAX_DELAY};
use super::sources::Sources;
use super::status::Status;
use super::supervision::Supervision;
use super::task::Task;
use super::travel::Travel;
use crate::axis::state::homing::Homing;
use crate::code::Code;
use crate::drive::DriveOutput;
use crate::encoder::Lead;
use crate::object::{Leader, Object};
use crate::parameter::AxisParameters;
use crate::profile::Motion;
use crate::signal::Signal;
use crate::state::AxisState;
use crate::vocabulary::Vocabularies;
use serde::{Deserialize, Serialize};

/// One axis. Parts that every cycle accesses come first in memory, up to `supervision` and the derived parameters. A
/// cycle accesses only some of the other parts, or none. The order of the fields in all parts is the format of stored
/// states.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[repr(C)]
pub struct Axis {
    pub(in crate::axis) cycle: CycleState,
    pub(in crate::axis) status: Status,
    pub(in crate::axis) command: CommandState,
    pub(in crate::axis) feedback: PositionFeedback,
    pub(in crate::axis) drive_data: DriveData,
    pub(in crate::axis) travel: Travel,
    pub(in crate::axis) supervision: Supervision,
    /// Active parameters: they act from the next command on, or at once if the row requires that.
    pub parameters: InForce,
    pub(in crate::axis) setup: AxisSetup,
    pub(in crate::axis) sources: Sources,
    /// State of its own brake, and requests of inputs of the machine.
    pub(in crate::axis) brake: BrakeState,
    pub(in crate::axis) motion: ActiveMotion,
    pub(in crate::axis) homing: Homing,
    pub(in crate::axis) task: Task,
    pub(in crate::axis) observed: Observed,
    pub(in crate::axis) alarm: AlarmState,
    pub(in crate::axis) vocabularies: Vocabularies,
    pub(in crate::axis) coupling: CouplingState,
    pub(in crate::axis) pending: Pending,
    pub(in crate::axis) loops: Loops,
}

/// Bytes of an axis that each cycle accesses: its present motion, its supervision and its limits.
pub const HOT_BYTES: usize = std::mem::offset_of!(Axis, supervision) + Supervision::HOT_BYTES + size_of::<Derived>();

const _: () = assert!(HOT_BYTES <= 1024, "a cycle of an axis touches more than 1 KiB");

impl Axis {
    /// Returns an axis at rest, switched off; a virtual axis is always on.
    pub fn new(setup: AxisSetup, parameters: AxisParameters, signals: Signal) -> Self {
        let is_virtual = setup.drive.is_none();
        let delay = setup.drive.map_or(0, |(_, offers)| offers.delay.min(MAX_DELAY));
        let sensor = Sensor::new(setup.wired, setup.encoders, &parameters);
        Self {
            cycle: CycleState::new(signals),
            status: Status::new(is_virtual),
            command: CommandState::default(),
            feedback: PositionFeedback::new(sensor.reader(), is_virtual),
            drive_data: DriveData::new(is_virtual),
            travel: Travel::default(),
            supervision: Supervision::new(delay),
            parameters: parameters.into(),
            setup,
            sources: Sources::new(sensor),
            brake: BrakeState::default(),
            motion: ActiveMotion::default(),
            homing: Homing::default(),
            task: Task::default(),
            observed: Observed::new(parameters.velocity_override),
            alarm: AlarmState::default(),
            vocabularies: Vocabularies::default(),
            coupling: CouplingState::default(),
            pending: Pending::default(),
            loops: Loops::new(delay),
        }
    }

    /// Whether it is the same axis of the same machine, in any state.
    pub fn is_set_up_as(&self, other: &Self) -> bool {
        let has_rings = self.supervision.has_ring_of(&other.supervision)
            && self.loops.compensation().has_ring_of(other.loops.compensation());
        self.setup == other.setup && self.cycle.signals() == other.cycle.signals() && has_rings
    }

    /// Returns the axis as an object.
    pub fn object(&self) -> Object {
        Object::Axis(self.setup.index)
    }

    /// Returns the index among the drives; none for a virtual axis.
    #[inline]
    pub fn drive(&self) -> Option<usize> {
        self.setup.drive.map(|(place, _)| place)
    }

    /// Returns its command position for followers: the motion of this cycle.
    #[inline]
    pub fn command(&self) -> Motion {
        self.command.motion()
    }

    /// Returns its actual position for followers.
    #[inline]
    pub fn actual(&self) -> Lead {
        self.feedback.lead()
    }

    /// Returns the command to the drive.
    #[inline]
    pub fn output(&self) -> DriveOutput {
        *self.drive_data.output()
    }

    /// Returns the active error.
    #[inline]
    pub fn error(&self) -> Code {
        self.alarm.code()
    }

    /// Returns the snapshot of the axis at its last error.
    pub fn fault(&self) -> &ErrorSnapshot {
        self.alarm.fault()
    }

    /// Returns the leader to which a vocabulary may couple it at any time.
    pub fn master(&self) -> Option<Leader> {
        self.setup.vocabularies.master()
    }

    /// Returns the length of a cycle (s).
    pub(in crate::axis) fn cycle_s(&self) -> f64 {
        self.setup.cycle_ns as f64 / 1e9
    }

    /// Changes the state and reports it. A state that a stop with lock replaces in the same cycle is not reported.
    pub(in crate::axis) fn set_state(&mut self, cx: &mut Context<'_>, state: AxisState) {
        let shown = (self.object(), self.command.position());
        self.status.enter(state, cx.events, shown);
    }
}

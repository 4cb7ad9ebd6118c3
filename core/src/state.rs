//! States of an axis, numbered as in the interface.

use serde::{Deserialize, Serialize};

/// State of an axis (PLCopen motion control, state diagram).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum AxisState {
    /// Switched off.
    #[default]
    Disabled = 0,
    /// On and at rest.
    Standstill = 1,
    /// Moving to a position, on a trajectory, or to rest after a halt.
    DiscreteMotion = 2,
    /// At a velocity, or accelerating to it: of a goal, a stream or a function slot.
    ContinuousMotion = 3,
    /// Homing.
    Homing = 4,
    /// Coupled to a leader, or to the positions of a function slot.
    SynchronizedMotion = 5,
    /// Stopped by quick_stop; locked until reset_errors.
    Stopping = 6,
    /// Stopped by an error; locked until reset_errors.
    ErrorStop = 7,
}

/// Names of [`AxisState`], by number.
pub const AXIS_STATES: &[&str] = &[
    "DISABLED",
    "STANDSTILL",
    "DISCRETE_MOTION",
    "CONTINUOUS_MOTION",
    "HOMING",
    "SYNCHRONIZED_MOTION",
    "STOPPING",
    "ERROR_STOP",
];

/// Names of [`DriveState`](crate::drive::DriveState), by number.
pub const DRIVE_STATES: &[&str] = &[
    "NOT_READY_TO_SWITCH_ON",
    "SWITCH_ON_DISABLED",
    "READY_TO_SWITCH_ON",
    "SWITCHED_ON",
    "OPERATION_ENABLED",
    "QUICK_STOP_ACTIVE",
    "FAULT_REACTION_ACTIVE",
    "FAULT",
];

/// Phase of homing, numbered as in the interface (`lineshaft_msgs/HomeAxis`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum HomingPhase {
    /// The axis does not home.
    #[default]
    None = 0,
    /// Searching for the switch.
    SearchSwitch = 1,
    /// Leaving the switch.
    LeaveSwitch = 2,
    /// Searching for the index pulse.
    SearchIndex = 3,
    /// Moving to the offset.
    MoveToOffset = 4,
    /// The drive homes by itself.
    InDrive = 5,
}

/// Names of [`HomingPhase`], by number.
pub const HOMING_PHASES: &[&str] =
    &["NONE", "SEARCH_SWITCH", "LEAVE_SWITCH", "SEARCH_INDEX", "MOVE_TO_OFFSET", "IN_DRIVE"];

/// Active reference of an axis: 0 to 7 as in AMC-SEL, further ones are additions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Reference {
    /// None, or a halt.
    #[default]
    Stop = 0,
    /// An absolute position.
    PositionAbsolute = 1,
    /// A velocity.
    Speed = 2,
    /// A cam.
    Cam = 3,
    /// A gear.
    Gear = 4,
    /// Homing.
    Home = 5,
    /// A relative position.
    PositionRelative = 6,
    /// The last target position, held.
    PositionProfile = 7,
    /// A function slot.
    Function = 8,
    /// Streamed setpoints.
    Stream = 9,
    /// A trajectory.
    Trajectory = 10,
}

impl Reference {
    /// Returns the reference of a number of AMC-SEL; invalid numbers are rejected before.
    pub fn selected(number: i64) -> Self {
        match number {
            1 => Self::PositionAbsolute,
            2 => Self::Speed,
            3 => Self::Cam,
            4 => Self::Gear,
            5 => Self::Home,
            6 => Self::PositionRelative,
            7 => Self::PositionProfile,
            _ => Self::Stop,
        }
    }
}

/// Names of [`Reference`], by number.
pub const REFERENCES: &[&str] = &[
    "STOP",
    "POSITION_ABSOLUTE",
    "SPEED",
    "CAM",
    "GEAR",
    "HOME",
    "POSITION_RELATIVE",
    "POSITION_PROFILE",
    "FUNCTION",
    "STREAM",
    "TRAJECTORY",
];

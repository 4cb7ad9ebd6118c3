//! The signals of an axis (contract section 4).

use super::Type::{Bit, Enum, Int, Real, Word};
use super::signal_block;
use crate::axis::{AXIS_STATES, DRIVE_STATES, REFERENCES};

signal_block! {
    /// A signal of an axis, by its place in the axis' block.
    AxisSignal;

    State "state" Enum(AXIS_STATES), None; "PLCopen state"
    DriveState "drive_state" Enum(DRIVE_STATES), None; "CiA 402 state"
    Reference "reference" Enum(REFERENCES), None; "which reference commands the axis"
    Enabled "enabled" Bit, None; "the axis can be moved"
    ModeOfOperation "mode_of_operation" Int, None; "mode that the drive shows (6061h)"
    Homed "homed" Bit, None; "the axis knows its zero"
    InPosition "in_position" Bit, None; "at rest at the target, within in_position_window"
    InVelocity "in_velocity" Bit, None; "the velocity goal is reached"
    InSync "in_sync" Bit, None; "coupled, and nothing left to catch up"
    Warning "warning" Bit, None; "the drive warns (CiA 402 status bit 7)"
    Brake "brake" Bit, None; "1 = closed"
    Error "error" Int, None; "code of the error that stopped the axis, 0 for none"
    CommandPosition "command.position" Int, Position; "command position, floor"
    CommandFraction "command.fraction" Real, None; "its fraction, 0 to 1"
    CommandVelocity "command.velocity" Real, Velocity; "command velocity"
    CommandAcceleration "command.acceleration" Real, Acceleration; "command acceleration"
    CommandJerk "command.jerk" Real, Jerk; "command jerk"
    TargetPosition "target.position" Int, Position; "where the present move ends"
    ActualCount "actual.count" Int, Position, drivable; "raw counts, before origin"
    ActualPosition "actual.position" Int, Position; "actual position"
    ActualVelocity "actual.velocity" Real, Velocity; "actual velocity"
    ActualEffort "actual.effort" Real, None; "torque or force in the drive's unit"
    FollowingError "following_error" Int, Position; "command of 1 + delay cycles ago minus actual position"
    RegulatorError "regulator.error" Int, Position; "command minus actual position of this cycle"
    RegulatorOutput "regulator.output" Real, None; "output of the position loop, -1 to 1"
    ModuloPosition "modulo.position" Int, Position; "command position within its turn"
    Turns "turns" Int, None; "whole turns of the command position"
    SyncMaster "sync.master" Int, Position; "position of the leader"
    SyncError "sync.error" Int, Position; "geared leader minus command position"
    SyncStatus "sync.status" Word, None; "bit 0 accurate, 1 ready, 2 fault, 3 master 4 slave marker missed"
    MarkerError "marker.error" Real, Position; "error between marks"
    MarkerCorrection "marker.correction" Real, Position; "correction for the marks"
    LimitPositive "limit.positive" Bit, None; "positive limit switch"
    LimitNegative "limit.negative" Bit, None; "negative limit switch"
    LimitSoftwarePositive "limit.software_positive" Bit, None; "the command stands at max_position or beyond"
    LimitSoftwareNegative "limit.software_negative" Bit, None; "the command stands at min_position or beyond"
    LatchPosition "latch.position" Int, Position; "last latched position, floor"
    LatchFraction "latch.fraction" Real, None; "its fraction, 0 to 1"
    LatchCount "latch.count" Int, None; "latches so far"
    OutputPosition "output.position" Int, Position; "position asked of the drive, in its counts"
    OutputVelocity "output.velocity" Real, Velocity; "velocity asked of the drive"
    OutputEffort "output.effort" Real, None; "effort asked of the drive"
    OutputControl "output.control" Word, None; "control word to the drive (6040h)"
    MasterPosition "master.position" Real, None; "position of the master (inc), of a negative mencoder in master units (MAPOS)"
    MasterVelocity "master.velocity" Real, None; "velocity of the master, the same per s (MAVEL)"
    TrackError "regulator.track_error" Real, None; "100 * (command - actual) / command velocity per ms (REG_NORMTRACKERR)"
}

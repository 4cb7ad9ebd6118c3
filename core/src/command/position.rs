//! Homing, and new values of positions.

use crate::position::Length;
use serde::{Deserialize, Serialize};

/// Numbering of a homing method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum HomingMethod {
    /// As set by parameter `homing.method`.
    #[default]
    Configured,
    /// A method of CiA 402.
    Cia402(i8),
    /// A HOME_TYPE of MACS.
    Macs(i8),
}

/// Homing of one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HomeAxis {
    /// Index of the axis.
    pub axis: u16,
    /// Homing method.
    pub method: HomingMethod,
}

/// A new value of a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SetPosition {
    /// Index of the axis.
    pub axis: u16,
    /// New value of its command position (inc).
    pub position: Length,
}

/// A distance that is added to every position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShiftPosition {
    /// Index of the axis.
    pub axis: u16,
    /// Change of its positions (inc), rounded to whole increments.
    pub distance: Length,
}

/// A new value of the position of an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SetEncoderPosition {
    /// Index in section `encoders`.
    pub encoder: u16,
    /// New value of its position (inc).
    pub position: Length,
}

/// A new value of the master position of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetMasterPosition {
    /// Index of the axis, whether or not it follows the master at present.
    pub axis: u16,
    /// New value of the position.
    pub position: MasterPosition,
}

/// A position of a master.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MasterPosition {
    /// In increments of the master.
    Increments(Length),
    /// In the unit of `x.master.position`: in master units if MENCODER is negative (MACS-UNIT-09), otherwise in
    /// increments.
    Shown(f64),
}

//! Homing: finds the reference of the axis and sets its zero.
//!
//! Law      zero = reference + homing.offset; the reference is the edge of a switch or an index pulse. The zero in the
//!          old coordinate is the shift; counts, command and limits keep their physical positions. An edge is the
//!          outermost position at which its switch is active: the latched position if its input latches, otherwise the
//!          sample on that side. The sample is exact if the last approach moves at most an increment per cycle,
//!          otherwise it is within the travel of one cycle. An index pulse is exact at any velocity: the encoder
//!          captured its count
//! Reads    the switches, index pulses, latches of the inputs assigned by i_refswitch, i_poslimitsw and i_neglimitsw
//! Refuses  homing without a method, a velocity, a switch; of an axis that moves or is off. During homing: every other
//!          motion
//! Source   MACS-HOME, CiA 402-2 methods, contract section 7

mod in_drive;
pub(super) mod in_use;
mod origin;
mod search;
mod start;

//! The plant of one axis: amplifier, motor, coupling, load and encoders, exactly over one cycle.
//!
//! Law      setpoint -> limit -> dead time -> torque, by a lag or by a winding -> [`train`] -> counts, floored
//! Reads    a setpoint in parts of the rated torque, or of the voltage of the winding; or a velocity for the drive's own loop
//! Writes   whole counts of the motor in a cycle, of its load, and what a noisy encoder reads beside them
//! Refuses  data outside their ranges
//! Source   contract section 3

mod data;
mod exponential;
mod regions;
mod servo;
mod train;

pub use data::{Amplifier, Coupling, Friction, Load, Motor, MotorData, Reading, Stage};
pub(super) use servo::Servo;

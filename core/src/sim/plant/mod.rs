//! Plant of one axis: amplifier, motor, coupling, load and encoders, solved exactly over one cycle.
//!
//! Law      setpoint -> limit -> dead time -> torque, by a lag or by a winding -> [`train`] -> counts, floored
//! Reads    a setpoint as a fraction of the rated torque, or of the voltage of the winding; or a velocity for the loop
//!          of the drive
//! Writes   whole counts of the motor per cycle, of its load, and the noise of the encoder reading
//! Refuses  data outside their ranges
//! Source   contract section 3

mod data;
mod exponential;
mod regions;
mod servo;
mod train;

pub use data::{Amplifier, Coupling, Friction, Load, Motor, MotorData, Reading, Stage};
pub(super) use servo::Servo;

//! One axis: from the inputs of its drive to the outputs of its drive, once per cycle.
//!
//! Law      read the drive (all axes first) | supervise | advance the generator to t_k | use the latch of a search |
//!          check following error and encoder | execute the commands of this cycle | step the vocabularies | check
//!          arrival | command the drive
//! Reads    the inputs of the drive, the leaders that are earlier in the order, the commands for the axis
//! Writes   its signals, the outputs of its drive, events
//! Refuses  each command with a code and the numbers of its message; a refused command changes nothing
//! Source   PLCopen state diagram, CiA 402 states, MACS-ERR-02, contract sections 1 and 7

mod coupling;
mod cycle;
mod drive;
mod feedback;
mod goal;
mod homing;
mod loops;
mod motion;
mod state;
mod vocabulary;
mod watch;

pub use coupling::cam::no_cam;
pub use coupling::master::may_name;
pub(crate) use coupling::smooth::Fallback;
pub use drive::analog::may_be_analog;
pub use drive::power::ENABLE_TIMEOUT_NS;
pub use feedback::direction::{may_output_sign, may_turn_loop};
pub use feedback::velocity_encoder::may_find_velocity;
pub(crate) use goal::stream::STREAM;
pub(crate) use goal::touch_probe::{INDEX, MOST_RECORDS};
pub use goal::track::Violation;
pub(crate) use homing::in_use::USES as COORDINATE_USES;
pub use loops::position::may_close_loop;
pub use state::alarm::ErrorSnapshot;
pub use state::axis::{Axis, HOT_BYTES};
pub use state::brake_state::{BrakeConfig, Edges};
pub use state::context::Context;
pub use state::drive_shown::MISSED_CYCLES;
pub(crate) use state::homing::methods as homing_methods;
pub use state::in_force::InForce;
pub use state::moved_by::MovedBy;
pub use state::pace::Pace;
pub use state::run::{Excess, LagEstimate, LargestLag, Run, place as trajectory_place};
pub use state::safety::Safety;
pub use state::sensor::Claim;
pub use state::setup::{AxisSetup, MAX_DELAY};
pub(crate) use state::smooth::fallback;
pub use state::source::{Source, Wired, may_carry, may_read};
pub use state::switches::Switches;
pub(crate) use state::switches::assigned_input;
pub use state::waiting::MAX_WAITING;
pub use watch::reaction::stops_all;

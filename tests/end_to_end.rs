//! End-to-end tests: the program as users start it, peers on other DDS implementations, and simulated CANopen drives.
//!
//! They are one target, so that shared code is compiled and linked once, and because they mostly wait: libtest runs
//! them in parallel (tests/runner.sh), each in its own ROS domain. `cargo test --workspace --test end_to_end motion`
//! runs those of tests/motion.rs. A test whose result depends on the processor time left by others begins with
//! `alone()` (tests/support/machine.rs).

mod drawing;
mod support;

mod arguments;
mod bags;
mod cams;
mod can;
mod can_cli;
mod can_drives;
mod can_faults;
mod can_frames;
mod can_habits;
mod can_modes;
mod can_objects;
mod can_recovery;
mod can_simulate;
mod can_terminals;
mod can_transports;
mod ci;
mod cli;
mod client_cli;
mod compat;
mod controller_manager;
mod couplings;
mod deployment;
mod docs;
mod explain;
mod function_types;
mod functions;
mod gripper;
mod homing;
mod homing_drawings;
mod interrupts;
mod joints;
mod lifecycle;
mod loops;
mod motion;
mod moveit;
mod new;
mod on_cam;
mod outputs;
mod packages;
mod parameters;
mod peers_setup;
mod programs;
mod recording;
mod robot;
mod robustness;
mod ros_axis;
mod ros_side;
mod rust_client;
mod scale;
mod shaft;
mod standard_output;
mod store;
mod streams;
mod system_clock;
mod table_cli;
mod touch_probe;
mod trajectory;
mod tune_cli;
mod tune_ros;
mod typos;
mod users;
mod vocabularies;
